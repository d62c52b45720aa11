//! Heights over an area, as meshes of beds and plates: what one run shows, what levers tell, what the frame takes.

use super::*;

/// Heights of `side` by `side` places over a square of 360 mm, raster by raster, each raster a run; noise of 1 µm.
fn mesh(side: usize, runs: usize, field_um: impl Fn(&Row) -> f64) -> Measurements {
    let mut random = ChaCha8Rng::seed_from_u64(5);
    let mut normal = || (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
    let base = measured(GOOD, nothing);
    let runs: Vec<String> = (0..runs).map(|run| format!("mesh {run}")).collect();
    let rows = (0..runs.len() * side * side).map(|k| {
        let place = |nth: usize| 20.0 + 360.0 * nth as f64 / (side - 1) as f64;
        let mut row = base.rows[0];
        row.run = k / (side * side);
        row.command.linear_mm = Vector::new(place(k % side), place(k / side % side), 5.0);
        row.command.tool_mm = Vector::zeros();
        row.command.direction = [0; 3];
        row.conditions = Conditions::default();
        row
    });
    let mut data = Measurements { rows: rows.collect(), runs, ..base.clone() };
    data.follow();
    for row in &mut data.rows {
        row.reading = Reading::Displacement([None, None, Some(field_um(row) + normal())]);
    }
    data
}

/// From -1 to 1 along X.
fn along_x(row: &Row) -> f64 {
    (row.command.linear_mm.x - 200.0) / 180.0
}

/// Every line along X bends alike while the order of the rows goes on: that is no drift.
#[test]
fn one_run_over_an_area_shows_what_no_drift_does() {
    let answer = diagnose(&mesh(7, 1, |row| 40.0 * along_x(row).powi(2)), None, &Options::default());
    assert_eq!((answer.verdict, names(&answer)), (Verdict::Named, vec!["straightness.EZX"]));
    assert!(answer.corrects(), "{:?}", answer.withheld);
}

/// A droop and a bow of X differ by a turn of the measuring frame, which is nobody's fault: whichever it is, the correction
/// is written.
#[test]
fn what_the_frame_takes_forbids_no_correction() {
    let droop = |row: &Row| -30.0 * (0.5 + 0.5 * along_x(row)).powi(3);
    let answer = diagnose(&mesh(7, 3, droop), None, &Options::default());
    let mut told: Vec<&str> = answer.causes[0].cannot_be_told_from.iter().map(String::as_str).collect();
    told.extend(names(&answer));
    told.sort_unstable();
    assert_eq!(told, ["sag.X", "straightness.EZX"], "{}", answer.sentence);
    assert!(answer.corrects(), "{:?}", answer.withheld);
}

/// What creeps from row to row is a curve along the slow axis as well, and nothing is written for it.
#[test]
fn what_creeps_through_a_run_may_be_the_instruments() {
    let creep = |row: &Row| 30.0 * (1.0 - units::math::exp(-row.order[1] / 0.2));
    let answer = diagnose(&mesh(7, 1, creep), None, &Options::default());
    let mut told = answer.causes.iter().flat_map(|c| c.cannot_be_told_from.iter().chain([&c.effect]));
    assert!(told.any(|name| name == "instrument-drift"), "{} {:?}", answer.sentence, names(&answer));
    assert!(!answer.corrects());
}

/// Three lines beside each other in one run may each have been laid down anew.
#[test]
fn lines_beside_each_other_in_one_run_are_no_area() {
    let mut data = mesh(9, 1, |row| 40.0 * along_x(row).powi(2));
    data.rows.retain(|row| [20.0, 200.0, 380.0].contains(&row.command.linear_mm.y));
    let answer = diagnose(&data, None, &Options::default());
    assert_eq!(answer.verdict, Verdict::Underpowered, "{}", answer.sentence);
}

/// A form that no axis makes, in one run that nothing of comes back: its neighbours differ by what it shows, and that is
/// no all-clear.
#[test]
fn one_run_without_a_name_is_no_all_clear() {
    let waves = |row: &Row| {
        let at = row.command.linear_mm / 29.0;
        25.0 * units::math::sin(at.x + 1.7 * at.y) * units::math::cos(1.3 * at.x - at.y)
    };
    let answer = diagnose(&mesh(5, 1, waves), None, &Options::default());
    assert!(!answer.corrects());
    assert_ne!(answer.verdict, Verdict::NoGap, "{}", answer.sentence);
}

/// A curve of X with two numbers and its roll with three at nine places: through nine levers each has readings enough.
#[test]
fn a_curve_and_an_angle_of_one_carriage_are_told_by_levers() {
    let legendre = |n: usize, u: f64| machine_model::effects::legendre(n, u);
    let field = |row: &Row| {
        let u = along_x(row);
        let roll_urad = 150.0 * u + 100.0 * legendre(2, u) - 80.0 * legendre(3, u);
        30.0 * legendre(2, u) + 20.0 * legendre(3, u) + 1e-3 * roll_urad * row.command.linear_mm.y
    };
    let answer = diagnose(&mesh(9, 3, field), None, &Options::default());
    let mut found = names(&answer);
    found.sort_unstable();
    assert_eq!(found, ["angular.EAX", "straightness.EZX"], "{}", answer.sentence);
    assert!(answer.leftover.phi < 0.01 && answer.corrects(), "{:?} {:?}", answer.leftover, answer.withheld);
}
