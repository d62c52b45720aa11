//! Test pieces of made-up lathes: what is known of them is found, what they cannot show is not.

use calibration::CalibrationError;
use calibration::turning::{Change, Feature, Stretch, Term, TurnedReading, TurningBase, calibrate};
use machine_model::{
    Chain, Command, Description, Interpolation, LinearAxis, Range, RotaryAxis, Squareness, Vector,
};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use turning::{Bending, Clamping, Force, Spindle, Tailstock, Tip, Workpiece};

fn base() -> TurningBase {
    let axis = || LinearAxis::perfect(Range { low: -50.0, high: 500.0 });
    TurningBase {
        description: Description {
            chain: Chain::parse("[w b Z X Y t]").expect("a chain"),
            linear: [axis(), axis(), axis()],
            rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
            squareness: Squareness::default(),
        },
        interpolation: Interpolation::Linear,
        spindle: Spindle { centre_mm: Vector::new(0.0, 0.0, 60.0), ..Spindle::default() },
        bending: Bending::default(),
        tip: Tip::default(),
        stations: Vec::new(),
    }
}

const PLACES: [f64; 7] = [80.0, 120.0, 160.0, 200.0, 240.0, 280.0, 320.0];

fn reading(part: usize, feature: Feature, radius: f64, z: f64) -> TurnedReading {
    TurnedReading {
        part,
        tool: Some(0),
        feature,
        command: Command { linear_mm: Vector::new(radius, 0.0, z), ..Default::default() },
        deviation_mm: 0.0,
        by_effects_mm: 0.0,
        uncertainty_mm: None,
        time_s: None,
    }
}

/// So many cylinders of 40 mm, and a faced disc of each where asked.
fn pieces(parts: usize, with_faces: bool) -> Vec<TurnedReading> {
    let mut rows = Vec::new();
    for part in 0..parts {
        rows.extend(PLACES.map(|z| reading(part, Feature::Diameter, 20.0, z)));
        if with_faces {
            rows.extend([10.0, 20.0, 30.0, 40.0].map(|r| reading(part, Feature::Face, r, 330.0)));
        }
    }
    rows
}

fn names(rows: &[TurnedReading]) -> Vec<String> {
    (0..=rows.iter().map(|row| row.part).max().unwrap_or(0)).map(|k| format!("P{k}")).collect()
}

const STRETCH: Stretch = Stretch { low_mm: 80.0, high_mm: 320.0 };

/// What the changed lathe leaves, the tool too large by so much on the radius.
fn cut(rows: &mut [TurnedReading], base: &TurningBase, change: &Change, size_mm: f64) {
    let predicted = base.predicted_mm(change, STRETCH, rows).expect("a lathe");
    for (row, mm) in rows.iter_mut().zip(predicted) {
        // A face's zero is its own.
        let level = if row.feature == Feature::Face { 0.123 } else { 2.0 * size_mm };
        row.deviation_mm = mm + level;
    }
}

/// The sum of twelve even ones less six: normal enough for intervals of 95 %, variance 1.
fn normal(random: &mut ChaCha8Rng) -> f64 {
    (0..12).map(|_| random.random::<f64>()).sum::<f64>() - 6.0
}

fn value(found: &calibration::turning::TurningCalibration, term: Term) -> f64 {
    found.terms.iter().find(|found| found.term == term).unwrap_or_else(|| panic!("{term:?}: {found:?}")).value
}

fn pairs(not_told_apart: &[[diagnostic::Text; 2]]) -> Vec<[&str; 2]> {
    not_told_apart.iter().map(|pair| pair.each_ref().map(diagnostic::Text::english)).collect()
}

#[test]
fn a_machine_without_noise_is_found_to_a_millionth() {
    let change = Change { axis: 85e-6, eb0z_rad: -130e-6, bow_mm: [0.012, 0.0] };
    let mut rows = pieces(3, true);
    cut(&mut rows, &base(), &change, 0.007);
    let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
    // A millionth of a micrometre over 240 mm is 4e-12 rad.
    assert!((found.change.axis - change.axis).abs() < 4e-12, "{found:?}");
    assert!((found.change.eb0z_rad - change.eb0z_rad).abs() < 4e-12, "{found:?}");
    assert!((found.change.bow_mm[0] - 0.012).abs() < 1e-9, "{found:?}");
    assert!((found.offsets[0].radius_mm - 0.007).abs() < 1e-9, "{:?}", found.offsets);
    assert!(found.terms.iter().all(|found| found.is_significant == found.term.is_geometry()), "{found:?}");
}

/// By hand: an axis that leans by 100 µrad leaves a cone of 2·100e-6·240 mm on the diameter, thinner towards +Z; a face
/// goes along +Z by 100 µrad of its radius: its own plane falls so much towards +X, the tool does not.
#[test]
fn signs_are_those_of_the_formula() {
    let mut rows = pieces(2, false);
    for row in &mut rows {
        row.deviation_mm = -2.0 * 100e-6 * (row.command.linear_mm.z - 80.0);
    }
    let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
    assert!((found.change.axis - 100e-6).abs() < 1e-9, "{:?}", found.change);
    let mut rows = pieces(2, true);
    for row in rows.iter_mut().filter(|row| row.feature == Feature::Face) {
        row.deviation_mm = 100e-6 * row.command.linear_mm.x;
    }
    let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
    // The cylinder is straight: Z leans as the spindle does.
    assert!((found.change.axis - 100e-6).abs() < 1e-9, "{:?}", found.change);
    assert!((found.change.eb0z_rad - 100e-6).abs() < 1e-9, "{:?}", found.change);
}

#[test]
fn what_bears_the_workpiece_is_what_has_a_taper() {
    let mut base = base();
    base.spindle.tailstock = Some(Tailstock { at_mm: 300.0, offset_mm: [0.004, 0.0] });
    let mut rows = pieces(2, false);
    cut(&mut rows, &base, &Change { axis: 0.025, ..Change::default() }, 0.0);
    // 29 µm on the radius over 300 mm: 46.4 µm on the diameter over 240.
    let cone = rows[6].deviation_mm - rows[0].deviation_mm;
    assert!((cone - 0.0464).abs() < 1e-6, "{cone}");
    let found = calibrate(&rows, &base, &names(&rows)).expect("found");
    assert!((found.change.axis - 0.025).abs() < 1e-9, "{:?}", found.change);
}

/// The bar of the profile bends by its own: nothing of it is the machine's.
#[test]
fn known_bending_is_taken_off() {
    let bar = Workpiece {
        diameters_mm: vec![[0.0, 40.0], [300.0, 40.0]],
        youngs_modulus_n_mm2: 210_000.0,
        clamping: Clamping::Chuck,
        steady_rests_mm: Vec::new(),
    };
    let bending = Bending::new(&bar, Force::Radial { newton: 100.0 }).expect("a bar");
    let bent = TurningBase { bending, ..base() };
    let mut rows = pieces(2, false);
    let change = Change { axis: -40e-6, ..Change::default() };
    cut(&mut rows, &bent, &change, 0.0);
    let found = calibrate(&rows, &bent, &names(&rows)).expect("found");
    assert!((found.change.axis + 40e-6).abs() < 4e-12 && found.change.bow_mm == [0.0; 2], "{found:?}");
    // Of a lathe that does not know the bar the bending is no straight line, and more than its taper.
    let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
    assert!((found.change.axis + 40e-6).abs() > 20e-6, "{found:?}");
}

/// 200 machines with 1 µm of noise: the 95 % intervals of taper, squareness and bow hold in 95 % of them. Of 200 draws
/// at 0.95, 180 or fewer hold with a chance of 0.2 %, all 200 with one of 0.004 %.
#[test]
fn intervals_hold() {
    let mut random = ChaCha8Rng::seed_from_u64(20_261_124);
    let mut held = [0; 3];
    for _ in 0..200 {
        let mut even = |size: f64| size * (2.0 * random.random::<f64>() - 1.0);
        let change =
            Change { axis: even(150e-6), eb0z_rad: even(150e-6), bow_mm: [0.008 + even(0.004), 0.0] };
        let mut rows = pieces(3, true);
        cut(&mut rows, &base(), &change, 0.003);
        for row in &mut rows {
            let u = if row.feature == Feature::Face { 0.0003 } else { 0.001 };
            row.deviation_mm += u * normal(&mut random);
        }
        let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
        let truth =
            [(Term::Axis, change.axis), (Term::Squareness, change.eb0z_rad), (Term::Bow, change.bow_mm[0])];
        for (held, (term, truth)) in held.iter_mut().zip(truth) {
            let own = found.terms.iter().find(|found| found.term == term);
            let own = own.unwrap_or_else(|| panic!("{term:?}: {found:?}"));
            *held += usize::from((own.value - truth).abs() <= own.u.half_width_95());
        }
    }
    assert!(held.iter().all(|held| (181..=199).contains(held)), "{held:?}");
}

/// Noise alone: at the level of 1 % a hundred machines have few false terms, and no profile changes else.
#[test]
fn nothing_is_found_where_nothing_is() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut changed = 0;
    for _ in 0..100 {
        let mut rows = pieces(3, false);
        for row in &mut rows {
            row.deviation_mm = 0.010 + 0.001 * normal(&mut random);
        }
        let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
        changed += usize::from(found.change != Change::default());
        assert!((found.offsets[0].radius_mm - 0.005).abs() < 0.001, "{:?}", found.offsets);
    }
    // Three tests each: 3 expected, more than 10 by a chance of 0.03 %.
    assert!(changed <= 10, "{changed}");
}

#[test]
fn growth_and_wear_are_named_only_where_they_can_be_told_apart() {
    let machine = |hours: &[f64], tools: &[usize]| {
        let mut rows = pieces(hours.len(), false);
        cut(&mut rows, &base(), &Change { axis: 60e-6, ..Change::default() }, 0.0);
        for row in &mut rows {
            let own = hours[row.part];
            row.tool = Some(tools[row.part]);
            row.time_s = Some(own * 3600.0 + row.command.linear_mm.z / 2.0);
            let order = tools[..row.part].iter().filter(|tool| **tool == tools[row.part]).count();
            let drift = 0.006 * row.time_s.expect("given") / 3600.0 - 0.002 * order as f64;
            row.deviation_mm += 2.0 * drift;
        }
        calibrate(&rows, &base(), &names(&rows)).expect("found")
    };
    // Parts one after the other, as they go: time and order are one.
    let together = machine(&[0.0, 1.0, 2.0, 3.0], &[0; 4]);
    assert_eq!(pairs(&together.not_told_apart), [["growth", "wear"]]);
    assert!(together.terms.iter().all(|found| !matches!(found.term, Term::Growth | Term::Wear)));
    // A second edge while the machine is warm tells them.
    let apart = machine(&[0.0, 1.0, 2.0, 3.0], &[0, 0, 1, 1]);
    assert!(apart.not_told_apart.is_empty() || pairs(&apart.not_told_apart) == [["growth", "wear"]]);
    let paused = machine(&[0.0, 0.2, 0.4, 3.0, 3.2], &[0; 5]);
    assert!(paused.not_told_apart.is_empty(), "{paused:?}");
    assert!((value(&paused, Term::Growth) - 0.006).abs() < 1e-9, "{paused:?}");
    assert!((value(&paused, Term::Wear) + 0.002).abs() < 1e-9, "{paused:?}");
    assert!((paused.change.axis - 60e-6).abs() < 1e-8, "{paused:?}");
    // What is taken off as one goes on within a part, 2 minutes of an hour's wear: 0.07 µm over 240 mm.
    assert!((together.change.axis - 60e-6).abs() < 0.5e-6, "{together:?}");
}

/// Sizes that change from part to part are wear only where neither growth nor an error that goes with the diameter may be it.
#[test]
fn what_may_be_something_else_is_not_called_wear() {
    let machine = |timed: bool, diameters_mm: [f64; 4]| {
        let mut rows = pieces(4, false);
        for row in &mut rows {
            row.tool = Some(0);
            // Warm before the first part: no growth, and pauses that tell it from the order.
            row.time_s = timed.then(|| 3600.0 * [9.0, 9.2, 9.4, 14.0][row.part]);
            row.command.linear_mm.x = 0.5 * diameters_mm[row.part];
        }
        cut(&mut rows, &base(), &Change { axis: 60e-6, ..Change::default() }, 0.0);
        for row in &mut rows {
            row.deviation_mm -= 2.0 * 0.002 * row.part as f64;
        }
        calibrate(&rows, &base(), &names(&rows)).expect("found")
    };
    let has_wear = |found: &calibration::turning::TurningCalibration| {
        found.terms.iter().any(|found| found.term == Term::Wear)
    };
    let told = machine(true, [60.0, 40.0, 40.0, 60.0]);
    assert!(has_wear(&told) && told.not_told_apart.is_empty(), "{told:?}");
    let untimed = machine(false, [60.0, 40.0, 40.0, 60.0]);
    assert_eq!(pairs(&untimed.not_told_apart), [["wear", "growth"]]);
    let sized = machine(true, [40.0, 44.0, 48.0, 52.0]);
    assert_eq!(pairs(&sized.not_told_apart), [["wear", "an error of X that goes with the diameter"]]);
    for found in [untimed, sized] {
        assert!(!has_wear(&found), "{found:?}");
        assert!((found.change.axis - 60e-6).abs() < 1e-9, "{found:?}");
    }
}

#[test]
fn refused_is_what_gives_no_machine() {
    let taper = Change { axis: 60e-6, ..Change::default() };
    let made = |rows: Vec<TurnedReading>, spoil: &dyn Fn(&mut Vec<TurnedReading>)| {
        let mut rows = rows;
        cut(&mut rows, &base(), &taper, 0.0);
        let mut random = ChaCha8Rng::seed_from_u64(3);
        for row in &mut rows {
            row.deviation_mm += 0.0005 * normal(&mut random);
        }
        spoil(&mut rows);
        calibrate(&rows, &base(), &names(&rows))
    };
    assert!(made(pieces(3, false), &|_| ()).is_ok());
    let message = |found: Result<_, CalibrationError>| found.map(|_| ()).expect_err("refused").to_string();
    let one = message(made(pieces(1, false), &|_| ()));
    assert!(one.contains("one part cannot tell its own bending"), "{one}");
    let collar = message(made(pieces(3, false), &|rows| {
        rows.retain(|row| row.part != 1 || row.command.linear_mm.z == 80.0);
    }));
    assert!(collar.contains("`P1` has one cross section"), "{collar}");
    let twice = made(pieces(3, false), &|rows| {
        let again = TurnedReading { deviation_mm: rows[0].deviation_mm + 0.02, ..rows[0].clone() };
        rows.push(again);
    });
    assert!(
        matches!(&twice, Err(CalibrationError::Outlier { point: 21, message }) if message.english().contains("six"))
    );
    let blunder = made(pieces(3, false), &|rows| rows[9].deviation_mm += 0.02);
    assert!(matches!(blunder, Err(CalibrationError::Outlier { point: 9, .. })), "{blunder:?}");
    let bent = message(made(pieces(3, false), &|rows| {
        for row in rows.iter_mut().filter(|row| row.part == 2) {
            row.deviation_mm += 1e-4 * (row.command.linear_mm.z - 200.0);
        }
    }));
    assert!(bent.contains("differ in their tapers"), "{bent}");
}

#[test]
fn held_out_parts_are_judged_at_their_own_size() {
    let change = Change { axis: 85e-6, eb0z_rad: 0.0, bow_mm: [0.012, 0.0] };
    let mut rows = pieces(3, false);
    cut(&mut rows, &base(), &change, 0.007);
    let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
    let mut others = pieces(1, false);
    cut(&mut others, &base(), &change, 0.055);
    let judged = found.held_out(&others, &base()).expect("judged");
    assert!(judged.rms_before_mm > 0.010 && judged.max_after_mm < 1e-8, "{judged:?}");
}

/// Four parts in an hour each; what the file lists in another order is the same file.
#[test]
fn parts_follow_one_another_in_time_not_in_the_file() {
    let mut random = ChaCha8Rng::seed_from_u64(12);
    let mut rows = pieces(6, false);
    cut(&mut rows, &base(), &Change { axis: 60e-6, ..Change::default() }, 0.0);
    for row in &mut rows {
        row.time_s = Some(3600.0 * [0.0, 0.2, 0.4, 3.0, 3.2, 3.4][row.part] + row.command.linear_mm.z / 2.0);
        // Wear alone.
        row.deviation_mm -= 2.0 * 0.003 * row.part as f64 + 0.0005 * normal(&mut random);
    }
    let listed = calibrate(&rows, &base(), &names(&rows)).expect("found");
    rows.sort_by_key(|row| [3, 0, 5, 1, 4, 2][row.part]);
    let other = calibrate(&rows, &base(), &names(&rows)).expect("found");
    for found in [&listed, &other] {
        let of = |term| found.terms.iter().find(|found| found.term == term).expect("told");
        let (growth, wear) = (of(Term::Growth), of(Term::Wear));
        assert!(wear.is_significant && (wear.value + 0.003).abs() <= wear.u.half_width_95(), "{wear:?}");
        assert!(!growth.is_significant && growth.value.abs() <= growth.u.half_width_95(), "{growth:?}");
    }
    let apart = value(&listed, Term::Wear) - value(&other, Term::Wear);
    assert!(apart.abs() < 1e-9, "{apart}");
}

/// 200 machines whose parts differ in size by five times the noise of a reading: the intervals of the tool's size hold in 95 %
/// of them (bounds as in [`intervals_hold`]), and what parts differ by is told.
#[test]
fn what_a_part_has_in_common_is_in_the_interval_of_the_size() {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let (mut held, mut shared_mm) = (0, 0.0);
    for _ in 0..200 {
        let mut rows = pieces(5, false);
        cut(&mut rows, &base(), &Change { axis: 60e-6, ..Change::default() }, 0.003);
        let seats: Vec<f64> = (0..5).map(|_| 0.005 * normal(&mut random)).collect();
        for row in &mut rows {
            row.deviation_mm += seats[row.part] + 0.001 * normal(&mut random);
        }
        let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
        let size = found.offsets[0];
        let u = size.u.expect("five parts tell it");
        held += usize::from((size.radius_mm - 0.003).abs() <= u.half_width_95());
        shared_mm += found.shared_mm.expect("five parts tell it") / 200.0;
        // The form is known as well as ever.
        assert!(found.field_u95_mm < 0.0008, "{found:?}");
    }
    assert!((181..=199).contains(&held), "{held}");
    assert!((shared_mm - 0.005).abs() < 0.0006, "{shared_mm}");
}

/// A micrometer of 1 µm whose hand scatters less: what rounding does is no blunder.
#[test]
fn what_rounding_does_is_no_blunder() {
    let mut random = ChaCha8Rng::seed_from_u64(185);
    for _ in 0..300 {
        let mut rows = pieces(2, false);
        rows.retain(|row| row.command.linear_mm.z < 250.0);
        let axis = 1e-5 * normal(&mut random);
        cut(&mut rows, &base(), &Change { axis, ..Change::default() }, 0.003);
        for row in &mut rows {
            row.deviation_mm = 1e-3 * (1e3 * row.deviation_mm + 0.05 * normal(&mut random)).round();
        }
        if let Err(error) = calibrate(&rows, &base(), &names(&rows)) {
            panic!("{error}: {rows:?}");
        }
        rows[4].deviation_mm += 0.1;
        let found = calibrate(&rows, &base(), &names(&rows));
        match found {
            Ok(found) => assert!(found.unseen_blunder_mm > 0.1, "{found:?}"),
            Err(error) => assert!(
                matches!(error, CalibrationError::Outlier { .. } | CalibrationError::Contradicted(_)),
                "{error}"
            ),
        }
    }
}

/// Two parts of one tool: how parts differ is told by their difference alone, one of two tools by nothing.
#[test]
fn too_few_parts_say_so() {
    let mut random = ChaCha8Rng::seed_from_u64(2);
    let mut rows = pieces(2, false);
    cut(&mut rows, &base(), &Change { axis: 60e-6, ..Change::default() }, 0.003);
    for row in &mut rows {
        row.deviation_mm += 0.0005 * normal(&mut random) + 0.02 * row.part as f64;
    }
    let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
    let u = found.offsets[0].u.expect("two parts");
    // 10 µm apart on the radius, one degree of freedom: 5 µm times 12.7.
    assert!((u.half_width_95() - 0.0635).abs() < 0.002 && u.freedom < 1.01, "{u:?}");
    for row in &mut rows {
        row.tool = Some(row.part);
    }
    let found = calibrate(&rows, &base(), &names(&rows)).expect("found");
    assert!(found.offsets.iter().all(|offset| offset.u.is_none()) && found.shared_mm.is_none(), "{found:?}");
    assert!((value(&found, Term::Axis) - 60e-6).abs() < 1e-5);
}
