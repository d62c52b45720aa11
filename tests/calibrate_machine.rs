//! `vpost calibrate volumetric` and `ballbar`: samples of machines whose truth the generator knows.

use std::path::Path;
use std::process::Output;

use crate::common::{messages, run, vpost};

const TABLE_MACHINE: &str = "format = 1\nname = \"table machine\"\ncontrol = \"linuxcnc\"\nchain = \"[w C A X Y b Z t]\"\n[axis.X]\ntravel_mm = [0, 600]\n[axis.Y]\ntravel_mm = [0, 500]\n[axis.Z]\ntravel_mm = [-600, 0]\n[rotary.A]\ncentre_mm = [250, 150, -300]\n[rotary.C]\ncentre_mm = [250, 150, -300]\n";

fn text_of(output: &Output) -> String {
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
    let report = text_of(&output);
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
    let predicted = text_of(&predicted);
    let dx = |row: usize| -> f64 {
        let line = predicted.lines().nth(row).expect("a row");
        line.split(',').nth(9).and_then(|v| v.parse().ok()).expect("dx_um")
    };
    assert!((dx(2) - dx(1) - 2.0 * 203.5).abs() < 1.0, "{predicted}");
    // The base's own uncertainty goes into that of the whole; that it has none is said.
    let uncertainty_um = |profile: &str| -> f64 {
        let stated =
            profile.split("uncertainty_um = ").nth(1).and_then(|rest| rest.split(&[',', ' ']).next());
        stated.and_then(|v| v.parse().ok()).expect("a number")
    };
    let unsaid = "counts as exact in uncertainty_um";
    assert!(messages(&output).contains(unsaid), "{}", messages(&output));
    let stated = format!("calibrated = {{ uncertainty_um = 3.0 }}\n{TABLE_MACHINE}");
    std::fs::write(base, stated).expect("written");
    let output = calibrate(&arguments, folder.path());
    assert!(output.status.success() && !messages(&output).contains(unsaid), "{}", messages(&output));
    let both = std::fs::read_to_string(&made).expect("written");
    let expected = (9.0 + uncertainty_um(&profile) * uncertainty_um(&profile)).sqrt();
    assert!((uncertainty_um(&both) - expected).abs() < 0.002, "{both}");
}

#[test]
fn circles_are_found_and_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = calibrate(
        &["ballbar", "samples/calibration/ballbar_circles.csv", "-m", "machine-profiles/perfect.toml"],
        folder.path(),
    );
    assert!(output.status.success(), "{}", messages(&output));
    let report = text_of(&output);
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
    let report = text_of(&output);
    let unseen = report.lines().find(|line| line.starts_with("unseen")).expect("a hold-out").to_owned();
    let numbers: Vec<f64> = unseen.split_whitespace().filter_map(|w| w.parse().ok()).collect();
    assert!(numbers[0] > 5.0 && numbers[1] < 1.3, "{unseen}");
    // Three runs, three set-ups: a profile holds one.
    let made = folder.path().join("made.toml");
    assert_eq!(report.lines().filter(|line| line.starts_with("set-up ")).count(), 3, "{report}");
    assert!(report.contains("[setup] of a profile is one: of these 3 none is written"), "{report}");
    assert!(!std::fs::read_to_string(&made).expect("written").contains("[setup]"));
    // Measured from the profile that they made, the points change nothing.
    let again = tempfile::tempdir().expect("a folder");
    let output = calibrate(
        &[
            "volumetric",
            "samples/calibration/volume_points.csv",
            "-m",
            made.to_str().expect("plain"),
            "--nodes",
            "4",
        ],
        again.path(),
    );
    let report = text_of(&output);
    assert!(output.status.success(), "{report}{}", messages(&output));
    let fitted = report.lines().find(|line| line.starts_with("fitted")).expect("a fit");
    let numbers: Vec<f64> = fitted.split_whitespace().filter_map(|w| w.parse().ok()).collect();
    assert!((numbers[0] - numbers[1]).abs() < 0.01 && numbers[0] < 1.1, "{fitted}");
}

#[test]
fn one_tool_leaves_angles_open_and_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let all = std::fs::read_to_string(crate::common::root().join("samples/calibration/volume_points.csv"))
        .expect("a sample");
    let one: Vec<&str> =
        all.lines().filter(|line| !line.starts_with("1,") && !line.starts_with("2,")).collect();
    let file = folder.path().join("one.csv");
    std::fs::write(&file, one.join("\n") + "\n").expect("written");
    let output = calibrate(
        &["volumetric", file.to_str().expect("plain"), "--chain", "[w X Y b Z t]", "--nodes", "4"],
        folder.path(),
    );
    let report = text_of(&output);
    assert!(
        report.contains("EAZ    open") && report.contains("other tool vectors"),
        "{report}{}",
        messages(&output)
    );
    assert!(!report.contains("[setup] of a profile is one"), "{report}");
    assert!(std::fs::read_to_string(folder.path().join("made.toml")).expect("written").contains("[setup]"));
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
    let one_turns = format!("{head}1,0,0,0,0,-100,0,0,0,100\n1,0,0,0,0,-100,0,5,0,100\n");
    said(&one_turns, &["--crossing", "0,0,0"], &["VP1106", "carries which", "--chain"]);
    let chain = ["--chain", "[w C A X Y b Z t]"];
    said(&one_turns, &chain, &["VP1106", "where is the axis of A", "--crossing"]);
    said(
        &one_turns,
        &["--chain", "[w X Y b Z C A t]", "--crossing", "0,0,0"],
        &["VP1101", "A turns the tool"],
    );
    // Without the spindle turn the cup offset cannot be told from the table's.
    let all = std::fs::read_to_string(crate::common::root().join("samples/calibration/ballbar_ac.csv"))
        .expect("a sample");
    let four: Vec<&str> = all.lines().filter(|line| !line.starts_with("spindle")).collect();
    let mut at_the_crossing = chain.to_vec();
    at_the_crossing.extend(["--crossing", "250,150,-300"]);
    said(&(four.join("\n") + "\n"), &at_the_crossing, &["VP1105", "eX", "EX0C", "the spindle's turn"]);
    // One reading a tenth of a millimetre off is pointed at.
    let spoilt = all.replacen(
        "A1,250,150,-300,250,50,-300,20,0,0,100.06229",
        "A1,250,150,-300,250,50,-300,20,0,0,100.16229",
        1,
    );
    assert_ne!(spoilt, all);
    said(&spoilt, &at_the_crossing, &["VP1107", "bar.csv:4:", "0.09", "longer than all other readings say"]);
    // Degrees are asked for.
    let radians: String = all
        .lines()
        .map(|line| {
            let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
            if let Ok(degrees) = fields[7].parse::<f64>() {
                fields[7] = degrees.to_radians().to_string();
            }
            fields.join(",") + "\n"
        })
        .collect();
    said(&radians, &at_the_crossing, &["VP1102", "a_deg goes over 6.2832", "degrees"]);
    // Another axis turned than the column says.
    let exchanged = all.replace("a_deg,c_deg", "c_deg,a_deg");
    said(&exchanged, &at_the_crossing, &["VP1113", "balls would be"]);
    // The profile knows where its axes are, and where they are not.
    let base = folder.path().join("base.toml");
    std::fs::write(&base, TABLE_MACHINE).expect("written");
    let base = base.to_str().expect("plain");
    said(&all, &["-m", base, "--crossing", "250,50,-300"], &["VP1101", "100.000 mm beside the axis of C"]);
    let elsewhere = TABLE_MACHINE.replace("travel_mm = [0, 600]", "travel_mm = [1000, 1600]");
    let other = folder.path().join("other.toml");
    std::fs::write(&other, elsewhere).expect("written");
    said(
        &all,
        &["-m", other.to_str().expect("plain")],
        &["VP1101", "X at 250.000 mm", "profile of this machine"],
    );
    let without = TABLE_MACHINE.replace("centre_mm = [250, 150, -300]\n", "");
    std::fs::write(&other, without).expect("written");
    said(&all, &["-m", other.to_str().expect("plain")], &["VP1106", "where is the axis of"]);
}

#[test]
fn circles_need_no_profile_and_keep_the_one_there_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let sample = "samples/calibration/ballbar_circles.csv";
    let output = calibrate(&["ballbar", sample, "--chain", "[w X Y b Z t]", "-d", "linuxcnc"], folder.path());
    assert!(output.status.success(), "{}", messages(&output));
    // A bar sees no common scale: what it cannot write it says.
    assert!(messages(&output).contains("scale X-Y of 37.6 um/m is not written"), "{}", messages(&output));
    let made = folder.path().join("made.toml");
    let first = std::fs::read_to_string(&made).expect("written");
    let stated = first.split("uncertainty_um = ").nth(1).and_then(|rest| rest.split(',').next());
    let uncertainty_um: f64 = stated.and_then(|v| v.parse().ok()).expect("a number");
    // Squareness of ± 1.5 µrad over 200 mm, but for the frame.
    assert!(uncertainty_um > 0.05 && uncertainty_um < 0.4, "{first}");
    // The same circles on the machine that they gave: nothing has changed.
    let again = folder.path().join("base.toml");
    std::fs::rename(&made, &again).expect("moved");
    let output = calibrate(&["ballbar", sample, "-m", again.to_str().expect("plain")], folder.path());
    assert!(output.status.success(), "{}", messages(&output));
    let second = std::fs::read_to_string(&made).expect("written");
    for key in ["EC0Y_urad", "EB0Z_urad", "EA0Z_urad"] {
        let value = |text: &str| figure(&text.replace('=', " "), key);
        assert!((value(&first) - value(&second)).abs() < 0.002, "{first}\n{second}");
    }
    // A plane says nothing of how far the third axis goes.
    let all = std::fs::read_to_string(crate::common::root().join(sample)).expect("a sample");
    let z = all.lines().nth(1).and_then(|line| line.split(',').nth(3)).expect("z_mm");
    let flat: Vec<&str> =
        all.lines().filter(|l| l.starts_with("run") || l.split(',').nth(3) == Some(z)).collect();
    let (plane, other) = (folder.path().join("plane.csv"), tempfile::tempdir().expect("a folder"));
    std::fs::write(&plane, flat.join("\n") + "\n").expect("written");
    let plane = ["ballbar", plane.to_str().expect("plain"), "--chain", "[w X Y b Z t]", "-d", "linuxcnc"];
    let output = calibrate(&plane, other.path());
    assert!(output.status.success(), "{}", messages(&output));
    assert!(messages(&output).contains("how far Z can go is not known"), "{}", messages(&output));
    // Tables of both directions hold the play between them.
    let (up, down) = ("position_mm,EXX_um\n-200,1\n200,3\n", "position_mm,EXX_um\n-200,5\n200,7\n");
    std::fs::write(folder.path().join("up.csv"), up).expect("written");
    std::fs::write(folder.path().join("down.csv"), down).expect("written");
    let axis_x = first.find("[axis.X]").expect("an axis");
    let two = first[axis_x..].lines().find(|line| line.starts_with("backlash_um")).expect("play of X");
    let text = first.replacen(two, "errors = \"up.csv\"\nerrors_negative = \"down.csv\"", 1);
    std::fs::write(&again, text).expect("written");
    let output = calibrate(&["ballbar", sample, "-m", again.to_str().expect("plain")], folder.path());
    assert!(output.status.success(), "{}", messages(&output));
    let report = text_of(&output);
    let table = |name: &str| std::fs::read_to_string(folder.path().join("made").join(name)).expect("a table");
    let first_of = |text: &str| -> f64 {
        text.lines().nth(1).and_then(|l| l.split(',').nth(1)).and_then(|v| v.parse().ok()).expect("EXX")
    };
    let (up, down) = (first_of(&table("x.csv")), first_of(&table("x_negative.csv")));
    assert!((down - up - figure(&report, "backlash X")).abs() < 0.01, "{report} {up} {down}");
    assert!((down + up - 6.0).abs() < 1e-3, "the mean of both stays: {up} {down}");
}
