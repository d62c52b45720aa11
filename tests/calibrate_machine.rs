//! `vpost calibrate volumetric` and `ballbar`: samples of machines whose truth the generator knows.

mod common;

use std::path::Path;
use std::process::Output;

use common::{messages, run, vpost};

const TABLE_MACHINE: &str = "format = 1\nname = \"table machine\"\ncontrol = \"linuxcnc\"\nchain = \"[w C A X Y b Z t]\"\n[axis.X]\ntravel_mm = [0, 600]\n[axis.Y]\ntravel_mm = [0, 500]\n[axis.Z]\ntravel_mm = [-600, 0]\n[rotary.A]\ncentre_mm = [250, 150, -300]\n[rotary.C]\ncentre_mm = [250, 150, -300]\n";

fn text(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("text")
}

fn calibrate(arguments: &[&str], folder: &Path) -> Output {
    let known = ["--date", "2026-05-15", "--temperature", "20", "--instrument", "test"];
    let made = folder.join("made.toml");
    vpost()
        .arg("calibrate")
        .args(arguments)
        .args(known)
        .arg("-o")
        .arg(made)
        .output()
        .expect("the command starts")
}

/// The number behind a name at the start of a line.
fn figure(text: &str, name: &str) -> f64 {
    let line = text
        .lines()
        .find(|line| line.trim_start().starts_with(name))
        .unwrap_or_else(|| panic!("{name} in\n{text}"));
    let rest = line.trim_start().trim_start_matches(name);
    rest.split_whitespace()
        .next()
        .and_then(|word| word.parse().ok())
        .unwrap_or_else(|| panic!("a number in {line}"))
}

#[test]
fn the_sample_table_is_found_and_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let base = folder.path().join("base.toml");
    std::fs::write(&base, TABLE_MACHINE).expect("written");
    let base = base.to_str().expect("a plain name");
    let arguments = [
        "ballbar",
        "samples/calibration/ballbar_ac.csv",
        "-m",
        base,
        "--after",
        "samples/calibration/ballbar_ac_compensated.csv",
    ];
    let output = calibrate(&arguments, folder.path());
    assert!(output.status.success(), "{}", messages(&output));
    let report = text(&output);
    // The sample's truth: EX0C 203.5 µm, cup -40.3 and -76.5 µm; 0.3 µm of noise on 37 readings.
    for (name, truth) in [("EX0C", 203.5), ("eX", -40.3), ("eY", -76.5)] {
        assert!((figure(&report, name) - truth).abs() < 0.5, "{name} in\n{report}");
    }
    assert!(report.contains("largest position error 203.") && report.contains("-> 0."), "{report}");
    let made = folder.path().join("made.toml");
    let profile = std::fs::read_to_string(&made).expect("written");
    assert!(profile.contains("EX0C_um = 203.") && profile.contains("[rotary.A]"), "{profile}");
    // The profile says what the table does: half a turn of C moves a point by twice the offset, and the tilt with it.
    let points = folder.path().join("points.csv");
    std::fs::write(&points, "x_mm,y_mm,z_mm,a_deg,b_deg,c_deg\n250,150,-300,0,0,0\n250,150,-300,0,0,180\n")
        .expect("written");
    let predicted = run(&["predict", points.to_str().expect("plain"), "-m", made.to_str().expect("plain")]);
    assert!(predicted.status.success(), "{}", messages(&predicted));
    let predicted = text(&predicted);
    let dx = |row: usize| -> f64 {
        let line = predicted.lines().nth(row).expect("a row");
        line.split(',').nth(9).and_then(|v| v.parse().ok()).expect("dx_um")
    };
    assert!((dx(2) - dx(1) - 2.0 * 203.5).abs() < 1.0, "{predicted}");
}

#[test]
fn circles_are_found_and_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = calibrate(
        &["ballbar", "samples/calibration/ballbar_circles.csv", "-m", "machine-profiles/perfect.toml"],
        folder.path(),
    );
    assert!(output.status.success(), "{}", messages(&output));
    let report = text(&output);
    assert!(figure(&report, "closure").abs() < 4.0, "{report}");
    let profile = std::fs::read_to_string(folder.path().join("made.toml")).expect("written");
    let squareness = figure(&report, "EC0Y");
    assert!(profile.contains(&format!("EC0Y_urad = {squareness}")[..16]), "{profile}");
    assert_eq!(profile.matches("backlash_um").count(), 3, "{profile}");
}

#[test]
fn points_of_a_volume_become_tables_that_unseen_points_confirm() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = calibrate(
        &[
            "volumetric",
            "samples/calibration/volume_points.csv",
            "--chain",
            "[w X Y b Z t]",
            "-d",
            "linuxcnc",
            "--nodes",
            "4",
        ],
        folder.path(),
    );
    assert!(output.status.success(), "{}", messages(&output));
    let report = text(&output);
    let unseen = report.lines().find(|line| line.starts_with("unseen")).expect("a hold-out").to_owned();
    let numbers: Vec<f64> = unseen.split_whitespace().filter_map(|w| w.parse().ok()).collect();
    assert!(numbers[0] > 5.0 && numbers[1] < 1.3, "{unseen}");
    // The profile predicts the points as measured, but for the runs' set-ups: RMS of differences within a run.
    let points = folder.path().join("points.csv");
    let measured = std::fs::read_to_string(common::root().join("samples/calibration/volume_points.csv"))
        .expect("a sample");
    let mut rows = vec!["x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm".to_owned()];
    rows.extend(
        measured.lines().skip(1).map(|line| line.split(',').skip(1).take(6).collect::<Vec<_>>().join(",")),
    );
    std::fs::write(&points, rows.join("\n") + "\n").expect("written");
    let made = folder.path().join("made.toml");
    let predicted =
        text(&run(&["predict", points.to_str().expect("plain"), "-m", made.to_str().expect("plain")]));
    let number = |line: &str, k: usize| -> f64 {
        line.split(',').nth(k).and_then(|v| v.parse().ok()).expect("a number")
    };
    for run in 0..3 {
        let left: Vec<f64> = measured
            .lines()
            .skip(1)
            .zip(predicted.lines().skip(1))
            .filter(|(m, _)| m.starts_with(&format!("{run},")))
            .map(|(m, p)| number(m, 7) - number(p, 9))
            .collect();
        let mean = left.iter().sum::<f64>() / left.len() as f64;
        let rms = (left.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / left.len() as f64).sqrt();
        assert!(rms < 1.3, "run {run}: {rms} um, of 1 um of noise");
    }
}

#[test]
fn one_tool_leaves_angles_open_and_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let all = std::fs::read_to_string(common::root().join("samples/calibration/volume_points.csv"))
        .expect("a sample");
    let one: Vec<&str> =
        all.lines().filter(|line| !line.starts_with("1,") && !line.starts_with("2,")).collect();
    let file = folder.path().join("one.csv");
    std::fs::write(&file, one.join("\n") + "\n").expect("written");
    let output = calibrate(
        &["volumetric", file.to_str().expect("plain"), "--chain", "[w X Y b Z t]", "--nodes", "4"],
        folder.path(),
    );
    let report = text(&output);
    assert!(
        report.contains("EAZ    open") && report.contains("other tool vectors"),
        "{report}{}",
        messages(&output)
    );
    // Too few points for so many nodes.
    let output = calibrate(
        &["volumetric", file.to_str().expect("plain"), "--chain", "[w X Y b Z t]", "--nodes", "40"],
        folder.path(),
    );
    assert!(messages(&output).contains("VP1105"), "{}", messages(&output));
}

#[test]
fn ball_bars_that_make_no_sense_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = |text: &str, more: &[&str], wanted: &[&str]| {
        let file = folder.path().join("bar.csv");
        std::fs::write(&file, text).expect("written");
        let mut arguments = vec!["calibrate", "ballbar", file.to_str().expect("plain")];
        arguments.extend(more);
        let output = run(&arguments);
        let all = messages(&output);
        assert!(!output.status.success() && wanted.iter().all(|w| all.contains(w)), "{wanted:?} in {all}");
    };
    let head = "run,x_mm,y_mm,z_mm,bx_mm,by_mm,bz_mm,a_deg,c_deg,length_mm\n";
    said(
        &format!("{head}1,0,0,0,0,-100,0,0,0,0.012\n1,0,0,0,0,-100,0,5,0,0.013\n"),
        &["--crossing", "0,0,0"],
        &["VP1102", "100.000 mm apart"],
    );
    said(
        &format!("{head}1,0,0,0,0,-100,0,0,0,100\n1,0,0,0,0,-100,0,5,5,100\n"),
        &["--crossing", "0,0,0"],
        &["VP1101", "two rotary"],
    );
    said(
        &format!("{head}1,0,0,0,0,-100,0,0,0,100\n1,0,0,0,0,-100,0,5,0,100\n"),
        &[],
        &["VP1106", "--crossing"],
    );
    // Without the spindle turn the cup offset cannot be told from the table's.
    let all =
        std::fs::read_to_string(common::root().join("samples/calibration/ballbar_ac.csv")).expect("a sample");
    let four: Vec<&str> = all.lines().filter(|line| !line.starts_with("spindle")).collect();
    said(&(four.join("\n") + "\n"), &["--crossing", "250,150,-300"], &["VP1105", "eX", "EX0C"]);
}
