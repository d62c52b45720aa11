//! R-tests of made-up five-axis machines with all 41 deviations: what can be seen is found within its interval, what cannot is
//! named, and the changed machine predicts what nobody measured.

use calibration::rtest::{BallReading, Basis, RotaryTables, Term, calibrate};
use calibration::{Base, CalibrationError};
use machine_model::{
    Axis, AxisTables, Chain, Command, Description, Engine, Interpolation, LinearAxis, PathModel, Range,
    RigidBody, RotaryAxis, Squareness, Table, Vector,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

/// Machines of the test that counts intervals.
const MACHINES: u64 = 10;

const ARC: Range = Range { low: -0.5 * std::f64::consts::PI, high: std::f64::consts::PI / 6.0 };

/// The sum of twelve even ones less six: normal enough for intervals of 95 %, variance 1.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

/// Smooth functions of an axis between two places: a few waves and a slope, six of them.
fn smooth(random: &mut ChaCha8Rng, low: f64, high: f64, size: [f64; 2]) -> AxisTables {
    let nodes: Vec<f64> = (0..=40).map(|k| low + (high - low) * f64::from(k) / 40.0).collect();
    let function = |f: usize, random: &mut ChaCha8Rng| {
        let parts: Vec<(f64, f64, f64)> =
            (1..=3).map(|k| (f64::from(k) * 2.0, normal(random), normal(random))).collect();
        let scale = size[usize::from(f >= 3)] / 3.0;
        let value = |q: f64| -> f64 {
            let t = (q - low) / (high - low);
            parts
                .iter()
                .map(|(k, a, b)| scale * (a * units::math::cos(k * t) + b * units::math::sin(k * t)))
                .sum()
        };
        Table::new(nodes.clone(), nodes.iter().map(|q| value(*q)).collect(), Interpolation::Linear).ok()
    };
    let all: Vec<Option<Table>> = (0..6).map(|f| function(f, random)).collect();
    AxisTables::new(&all.try_into().expect("six functions")).expect("common nodes")
}

/// The chain of the MS-300 of Serkov 2017, its linear axes with their 21 deviations.
fn base(random: &mut ChaCha8Rng) -> Base {
    let linear = [(); 3].map(|()| {
        let mut axis = LinearAxis::perfect(Range { low: -500.0, high: 500.0 });
        axis.errors = Some(smooth(random, -500.0, 500.0, [0.008, 20e-6]));
        axis
    });
    let squareness = Squareness {
        ec0y_rad: 20e-6 * normal(random),
        eb0z_rad: 20e-6 * normal(random),
        ea0z_rad: 20e-6 * normal(random),
    };
    let mut rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
    rotary[1].travel_rad = Range { low: -1.8, high: 0.7 };
    rotary[1].centre_mm = Vector::new(5.0, 0.0, -40.0);
    let chain = Chain::parse("[w C B b X Y Z t]").expect("a chain");
    Base {
        description: Description { chain, linear, rotary, squareness },
        interpolation: Interpolation::Linear,
        is_known: true,
    }
}

/// A truth in terms: every function of B and C by coefficients of so many groups, mm and rad.
fn truth(random: &mut ChaCha8Rng, from_group: usize) -> Vec<(Term, f64)> {
    let mut all = Vec::new();
    for (axis, basis, groups) in [(Axis::C, Basis::Turn, 5), (Axis::B, Basis::Arc(ARC), 4)] {
        for group in from_group..groups {
            for function in 0..6 {
                for which in 0..basis.values(group, 0.0).len() {
                    let size = if function < 3 { 0.003 } else { 8e-6 };
                    let value = size * normal(random);
                    all.push((Term::Coefficient { axis, function, basis, group, which }, value));
                }
            }
        }
    }
    all
}

/// The base with location errors and these functions; tables at every degree.
fn real(base: &Base, random: &mut ChaCha8Rng, functions: &[(Term, f64)]) -> Description {
    let mut machine = base.description.clone();
    for axis in [1, 2] {
        let rotary = &mut machine.rotary[axis];
        for direction in (0..3).filter(|d| *d != axis) {
            rotary.shift_mm[direction] = 0.020 * normal(random);
            rotary.tilt_rad[direction] = 60e-6 * normal(random);
        }
        let (low, high) = if axis == 1 { (-90, 30) } else { (-360, 360) };
        let nodes: Vec<f64> = (4 * low..=4 * high).map(|q| (0.25 * f64::from(q)).to_radians()).collect();
        let value = |function: usize, angle: f64| -> f64 {
            let of = |(term, value): &(Term, f64)| match term {
                Term::Coefficient { axis: own, function: f, basis, group, which }
                    if own.direction() == axis && *f == function =>
                {
                    value * basis.values(*group, angle)[*which]
                }
                _ => 0.0,
            };
            functions.iter().map(of).sum()
        };
        let table = |function| {
            Table::new(
                nodes.clone(),
                nodes.iter().map(|a| value(function, *a)).collect(),
                Interpolation::Linear,
            )
            .ok()
        };
        rotary.errors = AxisTables::new(&std::array::from_fn(table));
    }
    machine
}

/// A ball at a place of the workpiece, read at angles of B and C, degrees.
fn read(
    machine: &Description,
    ball: usize,
    place_mm: Vector,
    tool_mm: Vector,
    angles: &[(f64, f64)],
    noise_mm: &mut dyn FnMut() -> f64,
) -> Vec<BallReading> {
    let model = RigidBody::new(machine.clone()).expect("a machine");
    let offset_mm = Vector::new(0.031, -0.017, 0.009) * (1.0 + ball as f64);
    angles
        .iter()
        .map(|(b, c)| {
            let rotary_rad = Vector::new(0.0, b.to_radians(), c.to_radians());
            let mut command = Command { rotary_rad, tool_mm, ..Default::default() };
            command.linear_mm = model.same_tip_mm(&(place_mm - tool_mm), &command, &Vector::zeros());
            assert!(model.volume().contains(&command.linear_mm), "{command:?}");
            let deviation = model.predict(&command).error_mm + offset_mm;
            BallReading {
                run: ball,
                command,
                turning: [0; 3],
                deviation_mm: [0, 1, 2].map(|i| Some(deviation[i] + noise_mm())),
                uncertainty_mm: None,
            }
        })
        .collect()
}

/// B from -90 to 30 by 10, C by 15, every other pair; four balls that lie in no plane, with tools of four lengths.
fn whole(machine: &Description, noise_mm: &mut dyn FnMut() -> f64) -> Vec<BallReading> {
    let mut angles = Vec::new();
    for b in 0..13 {
        for c in 0..24 {
            if (b + c) % 2 == 0 {
                angles.push((-90.0 + 10.0 * f64::from(b), 15.0 * f64::from(c)));
            }
        }
    }
    let balls = [(120.0, 0.0, 50.0), (-60.0, 100.0, 80.0), (-50.0, -90.0, 20.0), (30.0, 40.0, 150.0)];
    let each = balls.iter().enumerate().map(|(k, (x, y, z))| {
        let tool = Vector::new(0.0, 0.0, -100.0 - 20.0 * k as f64);
        read(machine, k, Vector::new(*x, *y, *z), tool, &angles, noise_mm)
    });
    each.flatten().collect()
}

fn names(count: usize) -> Vec<String> {
    (0..count).map(|k| format!("ball {k}")).collect()
}

fn found(rows: &[BallReading], base: &Base) -> Result<RotaryTables, CalibrationError> {
    let runs = rows.iter().map(|row| row.run + 1).max().unwrap_or(0);
    calibrate(rows, base, &names(runs))
}

fn silent() -> impl FnMut() -> f64 {
    || 0.0
}

#[test]
fn every_term_lies_in_its_interval_as_often_as_it_says_and_unseen_places_are_predicted() {
    let (mut inside, mut all) = (0, 0);
    let mut by_name: std::collections::BTreeMap<String, (u64, u64)> = Default::default();
    for seed in 0..MACHINES {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let base = base(&mut random);
        // Every other machine has means and once-per-turn parts too: then what rows without noise say is the truth of each owner.
        let has_all = seed % 2 == 1;
        let functions = truth(&mut random, if has_all { 0 } else { 2 });
        let machine = real(&base, &mut random, &functions);
        let mut noise = || 0.001 * normal(&mut random);
        let rows = whole(&machine, &mut noise);
        let unseen_angles: Vec<(f64, f64)> = (0..60)
            .map(|k| (-88.0 + 1.9 * f64::from(k), 41.0 * f64::from(k) - 350.0))
            .map(|(b, c)| (b, c % 360.0))
            .collect();
        let unseen = read(
            &machine,
            0,
            Vector::new(80.0, -70.0, 110.0),
            Vector::new(0.0, 0.0, -130.0),
            &unseen_angles,
            &mut silent(),
        );
        let exact = has_all.then(|| found(&whole(&machine, &mut silent()), &base).unwrap());
        let result = found(&rows, &base).unwrap();
        assert!(result.not_told_apart.is_empty() && result.unseen.is_empty(), "{:?}", result.not_told_apart);
        // Noise of 1 µm, of 3744 readings.
        assert!((result.estimate.sigma - 0.001).abs() < 6e-5, "{}", result.estimate.sigma);
        for term in &result.terms {
            let real = match (&exact, term.term) {
                (Some(exact), own) => {
                    exact.terms.iter().find(|t| t.term == own).map_or(0.0, |t| t.base + t.change)
                }
                (None, Term::Location(location)) => location.of(&machine),
                (None, other) => {
                    functions.iter().find(|(own, _)| *own == other).map_or(0.0, |(_, value)| *value)
                }
            };
            assert!(term.is_written);
            let is_in = (term.base + term.change - real).abs() <= term.half_width_95;
            all += 1;
            inside += u64::from(is_in);
            let own = by_name.entry(term.term.name()).or_default();
            *own = (own.0 + u64::from(is_in), own.1 + 1);
        }
        let held = result.held_out(&unseen, &base).unwrap();
        println!(
            "{seed} {:?} {held:?} field {}",
            result.axes.iter().map(|a| a.groups).collect::<Vec<_>>(),
            result.field_u95_mm
        );
        assert!(held.rms_before_mm > 0.004 && held.rms_after_mm < 0.0005, "{held:?}");
        assert!(held.max_after_mm < 2.5 * result.field_u95_mm, "{held:?} {}", result.field_u95_mm);
    }
    // Of the terms that every machine has; a finer group is chosen now and then.
    by_name.retain(|_, own| own.1 == MACHINES);
    let worst = by_name.iter().min_by_key(|(_, own)| own.0).expect("location errors are always found");
    println!("{inside} of {all}; worst of {} terms {worst:?}", by_name.len());
    let share = f64::from(inside as u32) / f64::from(all as u32);
    assert!((0.92..0.98).contains(&share), "{inside} of {all}");
}

/// A quiet machine with these functions, and its base.
fn machine(seed: u64, from_group: usize) -> (Base, Description) {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let base = base(&mut random);
    let functions = truth(&mut random, from_group);
    let machine = real(&base, &mut random, &functions);
    (base, machine)
}

/// B and C everywhere, C by 15 degrees.
fn table_angles() -> Vec<(f64, f64)> {
    (0..13).flat_map(|b| (0..24).map(move |c| (-90.0 + 10.0 * f64::from(b), 15.0 * f64::from(c)))).collect()
}

/// C alone, by 15 degrees.
fn around() -> Vec<(f64, f64)> {
    (0..24).map(|c| (0.0, 15.0 * f64::from(c))).collect()
}

const TOOL: Vector = Vector::new(0.0, 0.0, -120.0);

#[test]
fn means_and_once_per_turn_parts_go_to_their_owners_and_unseen_balls_are_predicted() {
    let (base, machine) = machine(11, 0);
    let result = found(&whole(&machine, &mut silent()), &base).unwrap();
    assert!(result.not_told_apart.is_empty() && result.counted_as.is_empty() && result.unseen.is_empty());
    // One owner each: these parts have none of their own.
    for owned in ["EXC.mean", "EYC.mean", "EZC.mean", "EAC.mean", "ECC.mean", "EYC.cos1", "EBC.sin1"] {
        assert!(result.terms.iter().all(|t| t.term.name() != owned), "{owned}");
    }
    for own in ["EXC.cos1", "EZC.cos1", "EAC.sin1", "ECC.cos1", "EX0C", "EB0B", "EAB.p3"] {
        assert_eq!(result.terms.iter().any(|t| t.term.name() == own), own != "EB0B", "{own}");
    }
    let angles: Vec<(f64, f64)> =
        (0..50).map(|k| (-90.0 + 2.4 * f64::from(k), (77.0 * f64::from(k)) % 360.0)).collect();
    let unseen = read(
        &machine,
        0,
        Vector::new(-90.0, 60.0, 10.0),
        Vector::new(20.0, 0.0, -90.0),
        &angles,
        &mut silent(),
    );
    let held = result.held_out(&unseen, &base).unwrap();
    // Interpolation of the written tables, and of the made-up truth.
    assert!(held.rms_before_mm > 0.01 && held.max_after_mm < 5e-5, "{held:?}");
}

#[test]
fn one_ball_shows_neither_all_functions_nor_what_its_height_hides() {
    let (base, machine) = machine(12, 2);
    let rows = read(&machine, 0, Vector::new(120.0, 0.0, 50.0), TOOL, &around(), &mut silent());
    let result = found(&rows, &base).unwrap();
    assert_eq!(result.still, [Axis::B]);
    // From one ball the tilts are seen by the wobble along Z; of six functions no three.
    let written: Vec<String> = result.terms.iter().filter(|t| t.is_written).map(|t| t.term.name()).collect();
    assert_eq!(written, ["EX0C", "EY0C", "EA0C", "EB0C"]);
    let open = result.not_told_apart.concat();
    for name in ["EXC", "EYC", "EZC", "EAC", "EBC", "ECC"] {
        assert!(open.contains(&name.to_owned()), "{name}: {open:?}");
    }
    assert!(result.tables.is_empty() && result.description.rotary[2].errors.is_none());
    assert!(
        result
            .counted_as
            .iter()
            .any(|(part, owners)| part == "EZC.cos1" && owners.contains(&"EB0C".to_owned()))
    );
}

#[test]
fn a_ball_on_the_axis_says_nothing_of_where_the_axis_is() {
    let (base, machine) = machine(13, 2);
    let rows = read(&machine, 0, Vector::new(0.0, 0.0, 50.0), TOOL, &around(), &mut silent());
    let error = found(&rows, &base).unwrap_err();
    assert!(
        matches!(error, CalibrationError::Unobservable(_)) && error.to_string().contains("lies on the axis"),
        "{error}"
    );
    // Readings across the axis alone, at one height: a shift and a tilt look alike.
    let mut rows = read(&machine, 0, Vector::new(120.0, 0.0, 50.0), TOOL, &around(), &mut silent());
    rows.iter_mut().for_each(|row| row.deviation_mm[2] = None);
    let error = found(&rows, &base).unwrap_err();
    assert!(error.to_string().contains("EB0C from EX0C"), "{error}");
}

#[test]
fn rows_of_two_machines_and_a_blunder_are_refused_by_what_they_are() {
    let (base, machine_a) = machine(14, 2);
    let mut random = ChaCha8Rng::seed_from_u64(99);
    let functions = truth(&mut random, 2);
    let machine_b = real(&base, &mut random, &functions);
    let mut noise = || 0.001 * normal(&mut random);
    let mut rows = whole(&machine_a, &mut noise);
    let other = whole(&machine_b, &mut noise);
    let good = rows.clone();
    for (row, from_other) in rows.iter_mut().zip(&other) {
        if row.run >= 2 {
            *row = *from_other;
        }
    }
    let error = found(&rows, &base).unwrap_err();
    assert!(
        matches!(error, CalibrationError::Contradicted(_))
            && error.to_string().contains("Rows of two machines"),
        "{error}"
    );
    let mut rows = good;
    rows[321].deviation_mm[1] = rows[321].deviation_mm[1].map(|mm| mm + 0.03);
    match found(&rows, &base).unwrap_err() {
        CalibrationError::Outlier { point, message } => {
            assert!(point == 321 && message.english().contains("this row's Y"), "{point} {message}");
        }
        error => panic!("{error}"),
    }
    // One row of twelve: they hide behind the scatter that they make.
    for row in rows.iter_mut().step_by(12) {
        row.deviation_mm[2] = row.deviation_mm[2].map(|mm| mm + 0.02 * (normal(&mut random) + 3.0));
    }
    let error = found(&rows, &base).unwrap_err();
    assert!(matches!(error, CalibrationError::Outlier { .. }), "{error}");
}

#[test]
fn what_turns_nothing_is_refused() {
    let (base, machine) = machine(15, 2);
    let still: Vec<BallReading> = (0..4)
        .flat_map(|run| {
            let angle = [(0.0, 30.0 * f64::from(run)); 5];
            read(&machine, run as usize, Vector::new(100.0, 0.0, 50.0), TOOL, &angle, &mut silent())
        })
        .collect();
    // Every mounting at an angle of its own: the offsets take all.
    let error = found(&still, &base).unwrap_err();
    assert!(matches!(error, CalibrationError::Axes(_)) && error.to_string().contains("one angle"), "{error}");
    let mut plain = base.clone();
    plain.description.chain = Chain::parse("[w b X Y Z t]").expect("a chain");
    let error = found(&still, &plain).unwrap_err();
    assert!(error.to_string().contains("no rotary axis"), "{error}");
    let few = [(0.0, 0.0), (0.0, 90.0)];
    let few = read(&machine, 0, Vector::new(100.0, 0.0, 50.0), TOOL, &few, &mut silent());
    assert!(matches!(found(&few, &base).unwrap_err(), CalibrationError::TooFew(_)));
}

#[test]
fn no_finer_function_is_chosen_than_there_is() {
    let mut random = ChaCha8Rng::seed_from_u64(16);
    let base = base(&mut random);
    let mut functions = truth(&mut random, 2);
    functions.retain(|(term, _)| matches!(term, Term::Coefficient { axis: Axis::C, group: 2, .. }));
    let machine = real(&base, &mut random, &functions);
    let mut noise = || 0.0005 * normal(&mut random);
    let result = found(&whole(&machine, &mut noise), &base).unwrap();
    let groups: Vec<(Axis, usize, usize)> =
        result.axes.iter().map(|a| (a.axis, a.groups, a.most_groups)).collect();
    assert_eq!(groups, [(Axis::C, 3, 6), (Axis::B, 0, 5)]);
}

/// The intervals of readings that repeat one another ten times are those of one, where places differ by more than repeats do.
#[test]
fn repeats_are_no_new_places() {
    let (base, machine) = machine(17, 2);
    let mut random = ChaCha8Rng::seed_from_u64(17);
    let mut noise = || 0.002 * normal(&mut random);
    let once = whole(&machine, &mut noise);
    let mut fine = || 0.0001 * normal(&mut random);
    let mut many = Vec::new();
    for row in &once {
        for _ in 0..4 {
            let mut row = *row;
            row.deviation_mm = row.deviation_mm.map(|mm| mm.map(|mm| mm + fine()));
            many.push(row);
        }
    }
    let (one, four) = (found(&once, &base).unwrap(), found(&many, &base).unwrap());
    let (repeats_mm, free) = four.repeats_mm.unwrap();
    assert!(one.repeats_mm.is_none() && (repeats_mm - 0.0001).abs() < 5e-6 && free == 3 * once.len() * 3);
    for (a, b) in one.terms.iter().zip(&four.terms) {
        assert_eq!(a.term, b.term);
        assert!(
            (b.half_width_95 / a.half_width_95 - 1.0).abs() < 0.05,
            "{} {} {}",
            a.term.name(),
            a.half_width_95,
            b.half_width_95
        );
    }
}

/// A table that carries C and a head that swivels about a leaning line; the tool ball at tools of three kinds.
#[test]
fn a_head_is_found_as_a_table_is() {
    let mut random = ChaCha8Rng::seed_from_u64(18);
    let mut base = base(&mut random);
    base.description.chain = Chain::parse("[w C b X Y Z B t]").expect("a chain");
    base.description.rotary[1] = RotaryAxis::perfect(Vector::new(0.0, 0.0, 30.0));
    base.description.rotary[1].direction = Some(Vector::new(0.0, 0.6, 0.8));
    let functions = truth(&mut random, 2);
    let machine = real(&base, &mut random, &functions);
    let angles = table_angles();
    let balls = [(120.0, 0.0, 50.0), (-60.0, 100.0, 80.0), (-50.0, -90.0, 20.0), (30.0, 40.0, 150.0)];
    let tools = [(0.0, 0.0, -100.0), (40.0, 10.0, -180.0), (-30.0, 40.0, -140.0), (10.0, -30.0, -60.0)];
    let mut rows = Vec::new();
    for (k, ((x, y, z), (i, j, l))) in balls.into_iter().zip(tools).enumerate() {
        rows.extend(read(&machine, k, Vector::new(x, y, z), Vector::new(i, j, l), &angles, &mut silent()));
    }
    let result = found(&rows, &base).unwrap();
    assert!(result.not_told_apart.is_empty(), "{:?}", result.not_told_apart);
    let other: Vec<(f64, f64)> =
        (0..40).map(|k| (-89.0 + 2.9 * f64::from(k), (53.0 * f64::from(k)) % 360.0)).collect();
    let unseen = read(
        &machine,
        0,
        Vector::new(60.0, -60.0, 90.0),
        Vector::new(10.0, 25.0, -90.0),
        &other,
        &mut silent(),
    );
    let held = result.held_out(&unseen, &base).unwrap();
    assert!(held.rms_before_mm > 0.01 && held.max_after_mm < 5e-5, "{held:?}");

    // Three lengths on the spindle's line cannot tell what the head does beside it.
    let mut axial = Vec::new();
    for (k, ((x, y, z), length)) in balls.into_iter().zip([-100.0, -180.0, -140.0, -60.0]).enumerate() {
        let tool = Vector::new(0.0, 0.0, length);
        axial.extend(read(&machine, k, Vector::new(x, y, z), tool, &angles, &mut silent()));
    }
    let error = found(&axial, &base).unwrap_err();
    assert!(
        matches!(&error, CalibrationError::Unobservable(why) if why.english().contains("beside one line")),
        "{error}"
    );
}

#[test]
fn a_reversal_about_the_axis_is_taken_off_and_said() {
    let (base, machine) = machine(19, 2);
    let mut rows = whole(&machine, &mut silent());
    let model = RigidBody::new(base.description.clone()).expect("a machine");
    for (k, row) in rows.iter_mut().enumerate() {
        let side = if k % 3 == 0 { -1 } else { 1 };
        row.turning[2] = side;
        // 30 µrad between the sides: the workpiece stands turned by half of it.
        let turned = |angle: f64| {
            let mut command = row.command;
            command.rotary_rad[2] += angle;
            let nominal = |c: &Command| model.predict(c).position_mm - model.predict(c).error_mm;
            nominal(&command)
        };
        let by = turned(-15e-6 * f64::from(side)) - turned(0.0);
        row.deviation_mm = [0, 1, 2].map(|i| row.deviation_mm[i].map(|mm| mm + by[i]));
    }
    let result = found(&rows, &base).unwrap();
    let reversal = result.terms.iter().find(|t| t.term == Term::Reversal(Axis::C)).unwrap();
    assert!((reversal.change - 30e-6).abs() < 1e-7 && !reversal.is_written, "{reversal:?}");
    let exact = found(&whole(&machine, &mut silent()), &base).unwrap();
    for term in exact.terms {
        let own = result.terms.iter().find(|t| t.term == term.term).unwrap();
        // Products of 15 µrad and the machine's own errors.
        assert!((own.change - term.change).abs() < 1e-6, "{}", term.term.name());
    }
}
