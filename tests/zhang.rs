//! Zhang 2024, from the ball bar to the part: four tests of a crooked table, its eight location errors, an impeller that
//! is corrected with them. Simulated and judged with the publication's own matrices (`xtask/src/zhang.rs`).

use std::path::Path;
use std::process::Output;

use crate::common::{messages, root, run};
use crate::tip_program::{Place, places};
use crate::zhang_table::{
    NAMES, OF_THE_EXPERIMENT, OF_THE_SIMULATION, Table, Vector, distance, instrument, readings_csv,
};

/// LinuxCNC's five-axis demo as Debian's `linuxcnc-uspace` installs it. It is under the GPL, so the project has no copy.
const IMPELLER: &str = "/usr/share/doc/linuxcnc/examples/sample-configs/sim/axis/vismach/5axis/table-rotary-tilting/demos/impeller-7bl-xyzac.ngc";
/// One blade, by the project's own generator.
const BLADE: &str = "samples/five_axis/impeller_blade_linuxcnc_tcp.ngc";

const MACHINE: &str = r#"format = 1
name = "Trunnion with crossing axes"
control = "linuxcnc"
chain = "[w C A X Y b Z t]"
[axis.X]
travel_mm = [-400, 400]
[axis.Y]
travel_mm = [-400, 400]
[axis.Z]
travel_mm = [-400, 400]
[rotary.A]
centre_mm = [0, 0, 0]
travel_deg = [-120, 120]
[rotary.C]
centre_mm = [0, 0, 0]
[tool]
lengths_mm = { H1 = 120.0 }
[work_offsets_mm]
G54 = [0, 0, 0]
[kinematics]
straight = "tip"
centres_mm = { A = [0, 0, 0], C = [0, 0, 0] }
on = ["M428"]
off = ["M429"]
"#;

/// Where the tip is in the workpiece: the control turns the table of the drawing, the machine has this one.
fn real(table: &Table, tip_mm: Vector, a_deg: f64, c_deg: f64) -> Vector {
    let (a, c) = (a_deg.to_radians(), c_deg.to_radians());
    table.in_workpiece(Table::PERFECT.in_machine(tip_mm, a, c), a, c)
}

fn off_line(point: Vector, from: Vector, to: Vector) -> f64 {
    let dot = |a: Vector, b: Vector| (0..3).map(|i| a[i] * b[i]).sum::<f64>();
    let less = |a: Vector, b: Vector| [0, 1, 2].map(|i| a[i] - b[i]);
    let along = less(to, from);
    let share = if dot(along, along) > 0.0 { dot(less(point, from), along) / dot(along, along) } else { 0.0 };
    distance(point, [0, 1, 2].map(|i| from[i] + share.clamp(0.0, 1.0) * along[i]))
}

/// Largest distance of the real tip from a programmed line, mm, along one block of what the machine runs.
fn off_block(table: &Table, [from, to]: [&Place; 2], [start, end]: [Vector; 2]) -> f64 {
    let at = |k: u32| {
        let t = f64::from(k) / 16.0;
        let between = |a: f64, b: f64| a + t * (b - a);
        let tip = [0, 1, 2].map(|i| between(from.tip_mm[i], to.tip_mm[i]));
        real(table, tip, between(from.tilt_deg, to.tilt_deg), between(from.c_deg, to.c_deg))
    };
    (0..=16).map(|k| off_line(at(k), start, end)).fold(0.0, f64::max)
}

/// Which of the places that are run is the end of each programmed block.
///
/// # Errors
/// A place that is not reached, in order, with its own angles; or something run behind the last.
fn ends(table: &Table, programmed: &[Place], run: &[Place]) -> Result<Vec<usize>, String> {
    if programmed.len() == run.len() {
        let same =
            |(one, other): (&Place, &Place)| one.tilt_deg == other.tilt_deg && one.c_deg == other.c_deg;
        let turned = programmed.iter().zip(run).position(|pair| !same(pair));
        return turned.map_or(Ok((0..run.len()).collect()), |k| Err(format!("angles of place {k}")));
    }
    let mut found = Vec::new();
    let mut next = 0;
    for (k, wanted) in programmed.iter().enumerate() {
        // A block becomes a handful of pieces at most.
        let reaches = |place: &Place| {
            let off = distance(real(table, place.tip_mm, place.tilt_deg, place.c_deg), wanted.tip_mm);
            place.tilt_deg == wanted.tilt_deg
                && place.c_deg == wanted.c_deg
                && off < if wanted.names_tip { 0.02 } else { 0.5 }
        };
        let Some(j) = run[next..].iter().take(40).position(reaches) else {
            return Err(format!("place {k} is not reached: {:?}", wanted.tip_mm));
        };
        found.push(next + j);
        next += j + 1;
    }
    if next == run.len() { Ok(found) } else { Err("places behind the last".to_owned()) }
}

/// Largest distances of the real tip from the programmed path, um, at the ends of blocks and along feeds.
fn off_path_um(table: &Table, programmed: &[Place], run: &[Place]) -> Result<[f64; 2], String> {
    let mut worst = [0.0_f64; 2];
    let mut first = 0;
    for (k, (wanted, last)) in programmed.iter().zip(ends(table, programmed, run)?).enumerate() {
        let end = &run[last];
        let off = distance(real(table, end.tip_mm, end.tilt_deg, end.c_deg), wanted.tip_mm);
        if wanted.names_tip {
            worst[0] = worst[0].max(off * 1e3);
        }
        if wanted.feeds && k > 0 {
            let line = [programmed[k - 1].tip_mm, wanted.tip_mm];
            for piece in run[first.max(1) - 1..=last].windows(2) {
                worst[1] = worst[1].max(1e3 * off_block(table, [&piece[0], &piece[1]], line));
            }
        }
        first = last + 1;
    }
    Ok(worst)
}

fn figure(report: &str, name: &str, column: usize) -> f64 {
    let line = report.lines().find(|line| line.trim_start().starts_with(name)).expect("a line");
    line.replace('±', " ")
        .split_whitespace()
        .nth(column)
        .and_then(|word| word.parse().ok())
        .expect("a number")
}

/// Measures the table with a ball bar; the report.
fn calibrated(table: &Table, seed: u64, folder: &Path) -> Output {
    let [readings, base, made] = ["bar.csv", "base.toml", "made.toml"]
        .map(|name| folder.join(name).to_str().expect("plain").to_owned());
    std::fs::write(&readings, readings_csv(table, 2, instrument(seed))).expect("writable");
    std::fs::write(&base, MACHINE).expect("writable");
    let known = ["--date", "2026-11-25", "--temperature", "20", "--instrument", "simulated"];
    let output = run(&[&["calibrate", "ballbar", &readings, "-m", &base, "-o", &made], &known[..]].concat());
    assert!(output.status.success(), "{}", messages(&output));
    output
}

/// Every location error within its own 95 % interval widened by half: eight of them, on two tables.
#[test]
fn the_errors_come_back() {
    for (table, seed) in [(OF_THE_EXPERIMENT, 1), (OF_THE_SIMULATION, 2)] {
        let folder = tempfile::tempdir().expect("a folder");
        let output = calibrated(&table, seed, folder.path());
        let report = String::from_utf8_lossy(&output.stdout).into_owned();
        for ((_, name), truth) in NAMES.iter().zip(table.errors) {
            let is_length = !name[1..].starts_with(['A', 'B', 'C']);
            let truth = truth * if is_length { 1e3 } else { 1e6 };
            let [value, half] = [1, 2].map(|column| figure(&report, name, column));
            assert!((value - truth).abs() < 1.5 * half, "{name}: {truth}\n{report}");
            // Noise of 1 um, some 75 readings a test, levers of 100 mm.
            assert!(half < if is_length { 1.0 } else { 12.0 }, "{name}\n{report}");
        }
        for (name, truth) in [("eX", table.cup_mm[0]), ("eY", table.cup_mm[1])] {
            assert!((figure(&report, name, 1) - truth * 1e3).abs() < 1.0, "{name}\n{report}");
        }
        println!("{report}");
    }
}

/// From more than 200 um to less than 5, by the publication's matrices, along the whole path.
#[test]
fn impellers_are_corrected_with_what_the_bar_told() {
    let table = OF_THE_EXPERIMENT;
    let folder = tempfile::tempdir().expect("a folder");
    calibrated(&table, 1, folder.path());
    let made = std::fs::read_to_string(folder.path().join("made.toml")).expect("a profile");
    let mut parts = vec![(root().join(BLADE), made.clone(), 240)];
    if Path::new(IMPELLER).exists() {
        // The demo counts on a control whose kinematics are on.
        parts.push((
            IMPELLER.into(),
            made.replace("[kinematics]\n", "[kinematics]\nat_start = true\n"),
            4400,
        ));
    } else {
        println!("LinuxCNC's impeller is not installed: the project's own blade alone");
    }
    for (from, profile, at_least) in parts {
        let [machine, to] = ["with.toml", "out.ngc"].map(|name| folder.path().join(name));
        std::fs::write(&machine, profile).expect("writable");
        let [from, machine, to] = [&from, &machine, &to].map(|path| path.to_str().expect("a plain path"));
        let ran = run(&[from, "-m", machine, "--zero", "true", "-o", to]);
        assert!(ran.status.success(), "{}", messages(&ran));
        let [programmed, corrected] =
            [from, to].map(|path| places(&std::fs::read_to_string(path).expect("readable")));
        assert!(programmed.len() > at_least, "{from}: {} places", programmed.len());
        let before = off_path_um(&table, &programmed, &programmed).expect("the same places");
        let after =
            off_path_um(&table, &programmed, &corrected).unwrap_or_else(|why| panic!("{from}: {why}"));
        println!(
            "{from}: {} places; ends {:.1} -> {:.2} um, along feeds {:.1} -> {:.2} um",
            programmed.len(),
            before[0],
            after[0],
            before[1],
            after[1]
        );
        assert!(before[0] > 200.0 && before[1] > 200.0, "{from}: {before:?}");
        assert!(after[0] < 5.0 && after[1] < 5.0, "{from}: {after:?}");
        let check = run(&["check", from, to, "-m", machine, "--zero", "true"]);
        assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
    }
}

/// The judge finds what is wrong: a table off by 10 um, an angle, a block that is missing.
#[test]
fn the_judge_of_impellers_judges() {
    let text = std::fs::read_to_string(root().join(BLADE)).expect("readable");
    let programmed = places(&text);
    let judged = |table: &Table, run: &[Place]| off_path_um(table, &programmed, run);
    assert!(judged(&Table::PERFECT, &programmed).is_ok_and(|off| off.iter().all(|um| *um < 1e-6)));
    let mut displaced = Table::PERFECT;
    displaced.errors[4] = 10e-3;
    let off = judged(&displaced, &programmed).expect("the same places");
    // At an end by all of it; from a line only across.
    assert!((off[0] - 10.0).abs() < 1e-6 && off[1] > 9.0, "{off:?}");
    let damaged = |change: &dyn Fn(&mut Vec<Place>)| {
        let mut run = places(&text);
        change(&mut run);
        judged(&Table::PERFECT, &run)
    };
    assert!(damaged(&|run| run[100].c_deg += 0.002).is_err(), "an angle");
    assert!(damaged(&|run| run.retain(|place| place.c_deg != programmed[100].c_deg)).is_err(), "a block");
    assert!(damaged(&|run| run.truncate(200)).is_err(), "an end");
    let lifted = damaged(&|run| run[100].tip_mm[2] += 0.05).expect("the same angles");
    assert!(lifted[0] > 49.0 && lifted[1] > 20.0, "{lifted:?}");
}
