//! The parts of the diagnosis on small measurements whose truth is written beside them.

use machine_model::effects::{Conditions, EffectGeometry, EffectKind, Shape};
use machine_model::{Command, Vector};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::equations::columns::Source;
use crate::equations::f_test::f_tail;
use crate::equations::gram::Gram;
use crate::equations::linear::Products;
use crate::equations::noise::{NoiseSource, estimate, outliers};
use crate::equations::observation::{Measurements, Reading, Row, Scalar};
use crate::equations::serial::Serial;
use crate::equations::set_up::Clamping;
use crate::equations::term::Term;
use crate::library::candidates::Library;
use crate::search::explain::explain;
use crate::search::space::{RHO_GRID, Space};
use crate::search::trial::LEVEL;
use crate::{Options, Verdict, diagnose};

mod areas;
mod doubts;

/// How the plan of these tests is measured.
#[derive(Clone, Copy)]
pub(crate) struct Plan {
    feeds: &'static [f64],
    tools_mm: &'static [f64],
    sigma_um: f64,
    run_sigma_um: f64,
    seed: u64,
}

pub(crate) const GOOD: Plan =
    Plan { feeds: &[500.0, 3000.0], tools_mm: &[-80.0, -200.0], sigma_um: 1.0, run_sigma_um: 0.4, seed: 1 };

/// Four lines along every axis of a cube of 400 mm, both ways, every line twice, each line a run.
pub(crate) fn measured(plan: Plan, field_um: impl Fn(&Row) -> Vector) -> Measurements {
    let mut random = ChaCha8Rng::seed_from_u64(plan.seed);
    // The sum of twelve uniform numbers is normal enough up to three sigma.
    let mut normal = || (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
    let (mut rows, mut runs, mut time_s) = (Vec::new(), Vec::new(), 0.0);
    for line in 0..12 {
        let (axis, corner) = (line % 3, line / 3);
        let offset = Vector::new(normal(), normal(), normal()) * plan.run_sigma_um;
        for pass in 0..4 {
            for k in 0..17 {
                // Uneven steps: even ones cannot tell a period from a curve.
                let along = if pass % 2 == 0 { k } else { 16 - k };
                let place = 25.0 * f64::from(along) + 7.0 * (f64::from(along) * 0.618).fract();
                let mut at = Vector::new(40.0, 40.0, 40.0);
                at[(axis + 1) % 3] += 300.0 * (corner & 1) as f64;
                at[(axis + 2) % 3] += 300.0 * (corner >> 1) as f64;
                at[axis] = place;
                let mut direction = [0; 3];
                direction[axis] = if pass % 2 == 0 { 1 } else { -1 };
                time_s += 5.0;
                let command = Command {
                    linear_mm: at,
                    tool_mm: Vector::new(0.0, 0.0, plan.tools_mm[corner % plan.tools_mm.len()]),
                    direction,
                    ..Default::default()
                };
                let mut row = Row {
                    conditions: Conditions {
                        time_s: Some(time_s),
                        feed_mm_min: Some(plan.feeds[pass / 2 % plan.feeds.len()]),
                        ..Conditions::default()
                    },
                    line: rows.len() as u64 + 2,
                    ..Row::new(line, command, Reading::Magnitude(0.0))
                };
                let gap = field_um(&row) + offset + Vector::new(normal(), normal(), normal()) * plan.sigma_um;
                row.reading = Reading::Displacement([Some(gap.x), Some(gap.y), Some(gap.z)]);
                rows.push(row);
            }
        }
        runs.push(format!("r{line}"));
    }
    Measurements { runs, instruments: Vec::new(), rows, geometry: EffectGeometry::default() }
}

fn nothing(_: &Row) -> Vector {
    Vector::zeros()
}

fn backlash_um(row: &Row) -> Vector {
    Vector::new(-4.0 * f64::from(row.command.direction[0]), 0.0, 0.0)
}

fn names(answer: &crate::Diagnosis) -> Vec<&str> {
    answer.causes.iter().map(|c| c.effect.as_str()).collect()
}

#[test]
fn repeats_and_neighbours_find_the_noise_and_not_the_curve() {
    let plan = Plan { feeds: &[1000.0], ..GOOD };
    let curve = |row: &Row| Vector::new(0.0, 0.0, 1e-3 * (row.command.linear_mm.x - 200.0).powi(2));
    let data = measured(plan, curve);
    let scalars = data.scalars(None);
    let values: Vec<f64> = scalars.iter().map(|s| s.gap_um).collect();
    let noise = estimate(&data.rows, &scalars, &values, Serial::default()).unwrap();
    assert_eq!(noise.source, NoiseSource::Repeats);
    // 12 runs × 34 places × 3 components; the deviation of s is sigma / sqrt(2 · degrees), times 4.
    assert!((noise.degrees - 12.0 * 34.0 * 3.0).abs() < 0.5, "{}", noise.degrees);
    assert!((noise.variance.sqrt() - 1.0).abs() < 4.0 / (2.0 * noise.degrees).sqrt(), "{noise:?}");
    // Two feeds: no command is measured twice.
    let data = measured(GOOD, curve);
    let scalars = data.scalars(None);
    let values: Vec<f64> = scalars.iter().map(|s| s.gap_um).collect();
    let noise = estimate(&data.rows, &scalars, &values, Serial::default()).unwrap();
    assert_eq!(noise.source, NoiseSource::Neighbours);
    // The second difference of the curve over 25 mm adds 2e-3 · 25² / 2 = 0.6 µm to a third of the equations.
    assert!((0.85..1.3).contains(&noise.variance.sqrt()), "{noise:?}");
}

#[test]
fn one_wrong_row_is_an_outlier_and_three_together_are_not() {
    let mut data = measured(GOOD, nothing);
    let wrong = |row: &mut Row| {
        if let Reading::Displacement([x, ..]) = &mut row.reading {
            *x = x.map(|v| v + 12.0);
        }
    };
    wrong(&mut data.rows[30]);
    (100..103).for_each(|k| wrong(&mut data.rows[k]));
    let scalars = data.scalars(None);
    let values: Vec<f64> = scalars.iter().map(|s| s.gap_um).collect();
    assert_eq!(outliers(&data.rows, &scalars, &values), [30]);
}

#[test]
fn whitening_is_the_inverse_of_the_covariance() {
    let data = measured(GOOD, backlash_um);
    // Two runs suffice, and a matrix of 60 is soon inverted.
    let scalars: Vec<Scalar> =
        data.scalars(None).into_iter().filter(|s| data.rows[s.row].run < 2 && s.row % 7 == 0).collect();
    let data_source = Source { runs: 2, ..Source::new(&data, &scalars) };
    let terms = vec![
        Term::SetupShift(0),
        Term::SetupRotation(2),
        Term::Effect { kind: EffectKind::Backlash(0), index: 0, shape: Shape::default() },
    ];
    let rho = 0.7;
    let n = scalars.len();
    let covariance = DMatrix::from_fn(n, n, |i, j| {
        let (a, b) = (&scalars[i], &scalars[j]);
        let shared =
            if data.rows[a.row].run == data.rows[b.row].run { rho * a.along.dot(&b.along) } else { 0.0 };
        shared + if i == j { 1.0 } else { 0.0 }
    });
    let column = |k: usize| {
        DVector::from_fn(n, |i, _| {
            terms.get(k).map_or(scalars[i].gap_um, |t| {
                t.value(&scalars[i], &data.rows[scalars[i].row], &data.geometry)
            })
        })
    };
    let (found, log_determinant) = Gram::new(terms.clone(), &data_source).whitened(rho);
    let inverse = covariance.clone().try_inverse().unwrap();
    for i in 0..4 {
        for j in 0..4 {
            let expected = column(i).dot(&(&inverse * column(j)));
            assert!((found[(i, j)] - expected).abs() < 1e-9 * expected.abs().max(1.0), "{i} {j}");
        }
    }
    assert!((log_determinant - units::math::ln(covariance.determinant())).abs() < 1e-9);
}

#[test]
fn columns_added_later_give_the_same_space_as_columns_there_from_the_start() {
    let data = measured(GOOD, backlash_um);
    let scalars = data.scalars(None);
    let source = Source::new(&data, &scalars);
    let library = Library::new(&data, &[], Clamping::Shifted);
    let (early, late) = library.terms.split_at(library.terms.len() - 40);
    let mut gram = Gram::new(Vec::new(), &source);
    gram.extend(early.to_vec(), &source);
    let mut space = Space::new(gram.clone(), library.nuisances);
    gram.extend(late.to_vec(), &source);
    space.grow(gram);
    let whole = Space::new(Gram::new(library.terms.clone(), &source), library.nuisances);
    for level in 0..RHO_GRID.len() {
        let (a, b) = (space.products(level), whole.products(level));
        assert_eq!(a.count(), b.count());
        let scale = |i: usize, j: usize| (whole.reference()[i] * whole.reference()[j]).sqrt();
        for i in 0..a.count() {
            for j in 0..a.count() {
                assert!(
                    (a.product(i, j) - b.product(i, j)).abs() <= 1e-9 * scale(i, j).max(1e-9),
                    "{level} {i} {j}"
                );
            }
        }
    }
}

#[test]
fn a_step_is_found_at_its_time() {
    let step =
        |row: &Row| Vector::new(0.0, if row.conditions.time_s > Some(1503.0) { 3.0 } else { 0.0 }, 0.0);
    let answer = diagnose(&measured(Plan { run_sigma_um: 0.0, ..GOOD }, step), None, &Options::default());
    assert_eq!((answer.verdict, names(&answer)), (Verdict::Named, vec!["step.Y"]), "{}", answer.sentence);
    let value = |name: &str| answer.causes[0].parameters.iter().find(|p| p.name == name).unwrap();
    // Rows lie 5 s apart.
    assert!((value("time_s").value - 1503.0).abs() < 5.0, "{:?}", value("time_s"));
    assert!((value("shift_um").value - 3.0).abs() < value("shift_um").u95.unwrap() * 2.0);
}

/// Places 25 mm apart show a period of 40 mm as a slow curve: it is found, and because it could be any curve it is a rival
/// and never a name.
#[test]
fn a_period_is_found_and_not_named_where_places_are_too_far_apart() {
    let wave = |row: &Row| {
        Vector::new(3.0 * units::math::sin(std::f64::consts::TAU * row.command.linear_mm.x / 40.3), 0.0, 0.0)
    };
    let data = measured(GOOD, wave);
    let scalars = data.scalars(None);
    let values: Vec<f64> = scalars.iter().map(|s| s.gap_um).collect();
    let source = Source::new(&data, &scalars);
    let (found, asked, _) = crate::search::proposals::Pitches::new(&source, 0).best(&source, &values, 0);
    // 400 mm of travel resolve 40.3² / 400 = 4 mm between neighbours of equal power; a tenth of that is enough here.
    assert!((found[0] - 40.3).abs() < 0.5 && asked > 17, "{found:?} of {asked}");
    assert!(crate::library::sampling::Sampling::new(&data, 0).is_coarse(40.3));
    let answer = diagnose(&data, None, &Options::default());
    assert!(!names(&answer).contains(&"pitch.X") && answer.verdict != Verdict::Named, "{}", answer.sentence);
    assert!(answer.causes.iter().any(|c| c.cannot_be_told_from.iter().any(|r| r == "pitch.X")));
}

/// A frame that is turned moves the tip: with two tools of different length a set-up fitted to the axis commands would
/// leave micrometres, and name a cause for them.
#[test]
fn a_set_up_acts_on_the_tip() {
    let turned = |row: &Row| {
        let tip = row.command.linear_mm + row.command.tool_mm;
        Vector::new(30.0, -20.0, 12.0) + Vector::new(0.08, -0.05, 0.06).cross(&tip)
    };
    let answer = diagnose(&measured(GOOD, turned), None, &Options::default());
    assert_eq!(answer.verdict, Verdict::NoGap, "{}", answer.sentence);
    let (expected, setup) = ([80.0, -50.0, 60.0], answer.setup.expect("a frame"));
    let close = |(found, wanted): (&f64, &f64)| (found - wanted).abs() < 3.0;
    assert!(setup.rotation_urad.iter().zip(&expected).all(close), "{setup:?}");
}

#[test]
fn one_feed_cannot_tell_lag_from_backlash_and_two_can() {
    let two = diagnose(&measured(GOOD, backlash_um), None, &Options::default());
    assert_eq!((two.verdict, names(&two)), (Verdict::Named, vec!["backlash.X"]), "{}", two.sentence);
    let far = two.causes[0].nearest.iter().find(|n| n.effect == "servo-lag.X").unwrap();
    assert!(far.correlation < crate::judgement::rivals::ALIKE, "{far:?}");
    let one = diagnose(&measured(Plan { feeds: &[1000.0], ..GOOD }, backlash_um), None, &Options::default());
    assert_eq!(one.verdict, Verdict::Ambiguous, "{}", one.sentence);
    let cause = &one.causes[0];
    let set: Vec<&str> =
        std::iter::once(&cause.effect).chain(&cause.cannot_be_told_from).map(String::as_str).collect();
    assert!(set.contains(&"backlash.X") && set.contains(&"servo-lag.X"), "{set:?}");
    let alike =
        cause.nearest.iter().find(|n| n.effect.ends_with("lag.X") || n.effect == "backlash.X").unwrap();
    assert!(alike.correlation > 0.999, "{alike:?}");
}

/// With one tool, the angle of the axis that carries it moves the tip as a straightness does, whatever the order of the
/// curve: the answer is the set.
#[test]
fn one_tool_cannot_tell_a_curve_from_an_angle() {
    let plan = Plan { tools_mm: &[-100.0], feeds: &[1000.0], ..GOOD };
    let curve = |row: &Row| {
        let x = row.command.linear_mm.z / 200.0 - 1.0;
        // Legendre polynomials of the second and the fifth order, and a slope that is a squareness: with it the angle
        // fits better than the curve alone.
        let (two, five) = (1.5 * x * x - 0.5, (63.0 * x.powi(5) - 70.0 * x.powi(3) + 15.0 * x) / 8.0);
        Vector::new(0.6 * x + 4.0 * two + 6.0 * five, 0.0, 0.0)
    };
    let answer = diagnose(&measured(plan, curve), None, &Options::default());
    let cause = &answer.causes[0];
    let set: Vec<&str> =
        std::iter::once(&cause.effect).chain(&cause.cannot_be_told_from).map(String::as_str).collect();
    assert!(set.contains(&"straightness.EXZ") && set.contains(&"angular.EBZ"), "{set:?} {:?}", cause.nearest);
}

/// The same rows on a machine whose head turns from row to row; what arises along X, Y and Z is as it was.
fn with_a_turning_head(mut data: Measurements) -> Measurements {
    data.geometry =
        EffectGeometry::from_chain(&machine_model::Chain::parse("[w X b Y Z C A t]").expect("a chain"));
    for (k, row) in data.rows.iter_mut().enumerate() {
        let turn =
            |period: f64, most: f64| most * units::math::sin(std::f64::consts::TAU * k as f64 / period);
        row.command.rotary_rad = Vector::new(turn(7.3, 1.1), 0.0, turn(11.7, 2.6));
    }
    data
}

/// Where a head turns the tool, the frame cannot take the slope of a curve: it belongs to the curve, and no droop is made of it.
#[test]
fn a_slope_that_no_frame_takes_is_the_curves() {
    let plan = Plan { tools_mm: &[-150.0], ..GOOD };
    let curve = |x: f64| {
        let u = (x - 200.0) / 205.0;
        12.0 * (1.5 * u * u - 0.5) + 9.0 * (2.5 * u * u * u - 1.5 * u) + 8.0 * u
    };
    let bent = |row: &Row| Vector::new(0.0, 0.0, curve(row.command.linear_mm.x));
    let turned = diagnose(&with_a_turning_head(measured(plan, bent)), None, &Options::default());
    assert_eq!(names(&turned), ["straightness.EZX"], "{:?}", turned.verdict);
    let slope = turned.causes[0].parameters.iter().find(|p| p.name == "p1_um").expect("its slope");
    assert!((slope.value - 8.0).abs() < 1.5, "{slope:?}");
    // Of the positions of an axis it is the scale's, here as anywhere.
    let along = |row: &Row| Vector::new(curve(row.command.linear_mm.x), 0.0, 0.0);
    for data in [with_a_turning_head(measured(plan, along)), measured(plan, along)] {
        let answer = diagnose(&data, None, &Options::default());
        let mut found = names(&answer);
        found.sort_unstable();
        assert_eq!(found, ["positioning.EXX", "scale.X"], "{:?}", answer.verdict);
    }
}

/// A curve of the second and third order over more than is read has a slope and a constant there. Where a table turns both
/// show, each is little, and neither alone is better than a curve of high order with damage at its end.
#[test]
fn a_curve_has_its_slope_and_its_constant_at_once() {
    for (sizes_um, sigma_um) in [([-6.4, -5.9], 0.7), ([-15.2, -45.5], 0.7), ([-25.0, -20.0], 1.5)] {
        let mut data = measured(Plan { sigma_um, run_sigma_um: 0.0, tools_mm: &[-150.0], ..GOOD }, nothing);
        data.geometry =
            EffectGeometry::from_chain(&machine_model::Chain::parse("[w C A b X Y Z t]").expect("a chain"));
        for (k, row) in data.rows.iter_mut().enumerate() {
            let turn = |period: f64| units::math::sin(std::f64::consts::TAU * k as f64 / period);
            row.command.rotary_rad = Vector::new(0.8 * turn(7.3), 0.0, 2.9 * turn(11.7));
        }
        let shape = Shape { from_mm: -50.0, to_mm: 450.0, ..Shape::default() };
        let (geometry, kind) = (data.geometry.clone(), EffectKind::Positioning(0));
        let data = doubts::changed(data, |row| {
            let term = |index: usize| Term::Effect { kind, index, shape }.displacement_um(row, &geometry);
            term(0) * sizes_um[0] + term(1) * sizes_um[1]
        });
        let answer = diagnose(&data, None, &Options::default());
        let mut found = names(&answer);
        found.sort_unstable();
        assert_eq!(found, ["positioning.EXX", "rotary.EX0C", "scale.X"], "{sizes_um:?} {:?}", answer.verdict);
        // The slope of the third order over 400 of 500 mm.
        let share: f64 = 2.0 * 205.0 / 500.0;
        let slope_um_per_m = sizes_um[1] * 1.5 * (share * share - 1.0) / 0.25;
        let scale = answer.causes.iter().find(|cause| cause.effect == "scale.X").expect("its slope");
        let [scale] = &scale.parameters[..] else { panic!("{scale:?}") };
        assert!(
            (scale.value - slope_um_per_m).abs() < 3.0 + 0.05 * slope_um_per_m,
            "{slope_um_per_m} {scale:?}"
        );
    }
}

/// Weighted Bonferroni: the level is shared by the effects, and each effect's by its forms.
#[test]
fn every_question_costs_its_share_of_the_level() {
    let data = measured(GOOD, backlash_um);
    let library = Library::new(&data, &[], Clamping::Shifted);
    let spent: f64 = (0..library.candidates.len())
        .map(|c| library.candidates[c].asked() as f64 * LEVEL / library.questions(c))
        .sum();
    assert!((spent - LEVEL).abs() < 1e-12, "{spent}");
    let model = explain(&data, &data.scalars(None), &[]);
    assert_eq!(model.parts.len(), 1);
    // F(1, n) of t²: two-sided Student; 2.0² at 60 degrees is 0.0500.
    assert!((f_tail(4.0, 1.0, 60.0) - 0.0500).abs() < 1e-4);
    assert!((f_tail(0.0, 1.0, 60.0) - 1.0).abs() < 1e-12);
}

/// The level is that of all questions together: of 40 draws of noise 1.2 get a name, and more than four at that rate
/// once in two hundred times.
#[test]
fn noise_gets_a_name_no_more_often_than_the_level_says() {
    let named = |seed: &u64| {
        let answer = diagnose(&measured(Plan { seed: *seed, ..GOOD }, nothing), None, &Options::default());
        answer.verdict != Verdict::NoGap
    };
    let alarms: Vec<u64> = (10..50).filter(named).collect();
    assert!(alarms.len() <= 4, "{alarms:?}");
}

#[test]
fn the_same_rows_give_the_same_answer() {
    let data = measured(GOOD, backlash_um);
    let holdout = measured(Plan { seed: 2, ..GOOD }, backlash_um);
    let say = || format!("{:?}", diagnose(&data, Some(&holdout), &Options::default()));
    assert_eq!(say(), say());
}

/// Only the lengths of what `measured` gives.
fn lengths_only(mut data: Measurements) -> Measurements {
    for row in &mut data.rows {
        if let Reading::Displacement([Some(x), Some(y), Some(z)]) = row.reading {
            row.reading = Reading::Magnitude(Vector::new(x, y, z).norm());
        }
    }
    data
}

/// Turned everywhere by the same angle, a displacement has the same lengths: without a prediction `scale.Z` is
/// `squareness.XZ` turned by 90°, and the answer must hold both. The prediction of a model settles it.
#[test]
fn lengths_alone_do_not_tell_directions_and_a_prediction_does() {
    let plan = Plan { run_sigma_um: 0.0, ..GOOD };
    let stretched = |row: &Row| Vector::new(0.0, 0.0, 0.1 * row.command.linear_mm.z);
    let answer = diagnose(&lengths_only(measured(plan, stretched)), None, &Options::default());
    let (first, rivals) = (&answer.causes[0].effect, &answer.causes[0].cannot_be_told_from);
    let set: Vec<&str> = std::iter::once(first).chain(rivals).map(String::as_str).collect();
    assert_eq!(answer.verdict, Verdict::Ambiguous, "{set:?}");
    for name in ["scale.Z", "squareness.XZ", "squareness.YZ"] {
        assert!(set.contains(&name), "{name} in {set:?}");
    }
    // The model knows of a sine along every axis.
    let known_um = |row: &Row| row.command.linear_mm.map(|q| 20.0 * units::math::sin(q / 40.0));
    let mut data = measured(plan, |row| stretched(row) + known_um(row));
    data.rows.iter_mut().for_each(|row| row.predicted_mm = 1e-3 * known_um(row));
    let answer = diagnose(&lengths_only(data), None, &Options::default());
    assert_eq!(names(&answer), ["scale.Z"]);
    assert!(answer.causes[0].cannot_be_told_from.is_empty(), "{:?}", answer.causes[0].cannot_be_told_from);
}

#[test]
fn a_sample_has_rows_of_every_line_and_direction() {
    let data = measured(GOOD, nothing);
    let sample = data.sample(200);
    assert!((195..=205).contains(&sample.rows.len()), "{}", sample.rows.len());
    for run in 0..data.runs.len() {
        for side in [-1, 1] {
            let seen = |row: &&Row| row.run == run && row.command.direction.contains(&side);
            // A twelfth of 200, half of it: 8.
            assert!((6..=11).contains(&sample.rows.iter().filter(seen).count()), "run {run}, side {side}");
        }
    }
}

/// Predicted and achieved shrinkage on lines that were not fitted.
#[test]
fn the_forecast_holds_on_fresh_lines() {
    let data = measured(GOOD, backlash_um);
    let holdout = measured(Plan { seed: 2, ..GOOD }, backlash_um);
    let answer = diagnose(&data, Some(&holdout), &Options::default());
    let (promised, kept) = (answer.causes[0].shrink_predicted.unwrap(), answer.holdout.unwrap().shrink);
    assert!((promised.mid - kept).abs() < 0.05, "{promised:?} {kept}");
}

/// The pool's products are those of all columns at once, bit by bit: with the columns of a model, and within an effect.
#[test]
fn products_that_a_search_asks_for_are_those_of_all_columns() {
    let data = measured(Plan { feeds: &[1000.0], ..GOOD }, backlash_um);
    let scalars = data.scalars(None);
    let places = crate::equations::columns::Places::new(&data.rows);
    let source = Source { places: Some(&places), ..Source::new(&data, &scalars) };
    let library = Library::new(&data, &[], Clamping::Shifted);
    let whole = Gram::new(library.terms.clone(), &source);
    let (early, late) = library.terms.split_at(library.terms.len() - 40);
    let mut pool = crate::equations::pool::Pool::new(&source);
    let mut positions = pool.positions(early);
    let model = [library.nuisances + 3, library.nuisances + 17];
    assert!(pool.complete(&model));
    positions.extend(pool.positions(late));
    let last = positions.len() - 1;
    assert!(pool.complete(&[last]) && !pool.complete(&[last, model[0]]));
    let found = pool.select(&positions);
    let kind = |i: usize| match whole.terms.get(i) {
        Some(Term::Effect { kind, .. }) => Some(*kind),
        _ => None,
    };
    let core = |i: usize| i < library.nuisances || model.contains(&i) || i == last || i == last + 1;
    for i in 0..=last + 1 {
        for j in 0..=last + 1 {
            if core(i) || core(j) || kind(i) == kind(j) {
                assert_eq!(found.products[(i, j)], whole.products[(i, j)], "{i} {j}");
            }
        }
    }
    assert_eq!(found.run_products, whole.run_products);
}
