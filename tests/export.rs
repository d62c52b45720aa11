//! `vpost profile export`: what is written comes back.

use std::path::Path;
use std::process::Output;

use crate::common::{messages, run};

const MILL: &str = "machine-profiles/generic_vmc.toml";

fn export(format: &str, folder: &Path, more: &[&str]) -> Output {
    let folder = folder.to_str().expect("a plain name");
    let mut arguments = vec!["profile", "export", MILL, "--format", format, "-O", folder];
    arguments.extend(more);
    let output = run(&arguments);
    assert!(output.status.success(), "{}", messages(&output));
    output
}

fn calibrate(arguments: &[&str], made: &Path) {
    let mut all = vec!["calibrate"];
    all.extend(arguments);
    all.extend(["-m", MILL, "--date", "2026-01-01", "--temperature", "20", "--instrument", "test", "-o"]);
    all.push(made.to_str().expect("plain"));
    let output = run(&all);
    assert!(output.status.success(), "{}", messages(&output));
}

/// Largest difference of two profiles' predictions at points in both directions, µm, and the largest error.
fn difference(a: &str, b: &Path, points: &str, folder: &Path) -> (f64, f64) {
    let file = folder.join("points.csv");
    std::fs::write(&file, points).expect("written");
    let file = file.to_str().expect("plain");
    let errors = |profile: &str| -> Vec<Vec<f64>> {
        let output = run(&["predict", file, "-m", profile]);
        assert!(output.status.success(), "{}", messages(&output));
        let text = String::from_utf8(output.stdout).expect("text");
        let columns = text.lines().next().expect("a header").split(',').count();
        let row = |line: &str| {
            line.split(',').skip(columns - 4).take(3).map(|v| v.parse().expect("a number")).collect()
        };
        text.lines().skip(1).map(row).collect()
    };
    let (first, second) = (errors(a), errors(b.to_str().expect("plain")));
    let mut worst = (0.0_f64, 0.0_f64);
    for (p, q) in first.iter().flatten().zip(second.iter().flatten()) {
        worst = (worst.0.max((p - q).abs()), worst.1.max(p.abs()));
    }
    worst
}

/// Points on the nodes of the generic mill's tables.
fn points() -> String {
    let mut text = String::from("x_mm,y_mm,z_mm,dir_x,dir_y,dir_z\n");
    for (k, x) in [-760, -600, -400, -200, -40, 0].into_iter().enumerate() {
        let sign = if k % 2 == 0 { 1 } else { -1 };
        text.push_str(&format!("{x},{},{},{sign},{sign},{}\n", -70 * k as i32, -90 * k as i32, -sign));
    }
    text
}

#[test]
fn own_tables_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    export("csv", folder.path(), &[]);
    let made = folder.path().join("made.toml");
    let files: Vec<String> =
        ["x", "y", "z"].map(|a| folder.path().join(format!("{a}.csv")).display().to_string()).to_vec();
    let mut arguments = vec!["interferometer"];
    arguments.extend(files.iter().map(String::as_str));
    arguments.extend(["--through", "-380,-210,-255", "--optics", "0,0,-150", "--interpolation", "monotone"]);
    calibrate(&arguments, &made);
    let (off, size) = difference(MILL, &made, &points(), folder.path());
    // Four decimals of a µm are written.
    assert!(off < 1e-3 && size > 5.0, "{off} of {size} um");
}

#[test]
fn linuxcnc_files_come_back_with_both_directions() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = messages(&export("linuxcnc", folder.path(), &[]));
    assert!(said.contains("VP1112") && said.contains("squareness"), "{said}");
    let text = std::fs::read_to_string(folder.path().join("x.comp")).expect("written");
    assert!(
        text.lines().all(|line| line.split(' ').count() == 3),
        "three numbers a line, nothing else: {text}"
    );
    let made = folder.path().join("made.toml");
    let files: Vec<String> = ["x=EXX", "y=EYY", "z=EZZ"]
        .map(|a| format!("{}", folder.path().join(a.replace('=', ".comp=")).display()))
        .to_vec();
    let mut arguments = vec!["interferometer", "--values", "positions"];
    arguments.extend(files.iter().map(String::as_str));
    calibrate(&arguments, &made);
    // Only positioning is in it: compare each axis' own component along its own line, the others where their errors are
    // the same in both profiles.
    let made = std::fs::read_to_string(folder.path().join("made/x.csv")).expect("a table");
    let negative = std::fs::read_to_string(folder.path().join("made/x_negative.csv")).expect("a table");
    let source =
        std::fs::read_to_string(crate::common::root().join("machine-profiles/generic_vmc/errors_x.csv"))
            .expect("a table");
    let place =
        source.lines().next().expect("a header").split(',').position(|c| c == "EXX_um").expect("positioning");
    let number = |line: &str, k: usize| -> f64 {
        line.split(',').nth(k).and_then(|v| v.parse().ok()).expect("a number")
    };
    for ((up, down), line) in made.lines().skip(1).zip(negative.lines().skip(1)).zip(source.lines().skip(1)) {
        // Backlash of 6 µm: half of it less while going up, half of it more while going down.
        assert!((number(up, 1) - (number(line, place) - 3.0)).abs() < 1e-3, "{up} {line}");
        assert!((number(down, 1) - (number(line, place) + 3.0)).abs() < 1e-3, "{down} {line}");
    }
}

#[test]
fn isg_tables_come_back_with_the_angles() {
    let folder = tempfile::tempdir().expect("a folder");
    let said = messages(&export("isg", folder.path(), &[]));
    assert!(said.contains("direction of motion of X"), "{said}");
    let made = folder.path().join("made.toml");
    let file = folder.path().join("errors.isg").display().to_string();
    let asked = [
        "interferometer",
        file.as_str(),
        "--reference",
        "line",
        "--squareness-convention",
        "right-handed",
        "--straightness-slopes",
        "keep",
        "--interpolation",
        "monotone",
        "--through",
        "-380,-210,-255",
        "--optics",
        "0,0,-150",
    ];
    calibrate(&asked, &made);
    let mean = points().replace(",1", ",0").replace(",-1\n", ",0\n");
    let still: String = mean.lines().map(|l| if l.starts_with('x') { l.to_owned() } else { l.split(',').take(3).collect::<Vec<_>>().join(",") + ",0,0,0" } + "\n").collect();
    let (off, size) = difference(MILL, &made, &still, folder.path());
    assert!(off < 1e-3 && size > 5.0, "{off} of {size} um");
}

#[test]
fn a_lattice_comes_back_as_a_machine() {
    let folder = tempfile::tempdir().expect("a folder");
    export("lattice", folder.path(), &["--step", "95"]);
    let made = folder.path().join("made.toml");
    let file = folder.path().join("lattice.csv").display().to_string();
    calibrate(&["volumetric", &file, "--nodes", "9", "--holdout-every", "7"], &made);
    // The volumetric fit has a frame of its own: a shift is no error. Straight lines between nine nodes stand for the cubic.
    let still = "x_mm,y_mm,z_mm\n-760,-420,-510\n-380,-210,-255\n-190,-105,-128\n-570,-315,-380\n0,0,0\n-95,-400,-10\n";
    let shifted = difference(MILL, &made, still, folder.path());
    let single = difference(MILL, &made, "x_mm,y_mm,z_mm\n0,0,0\n", folder.path());
    assert!(shifted.0 < single.0 + 2.5, "{shifted:?} {single:?}");
    // Corrections are the same with the other sign.
    let errors = std::fs::read_to_string(folder.path().join("lattice.csv")).expect("written");
    export("lattice", folder.path(), &["--step", "95", "--lattice", "corrections"]);
    let corrections = std::fs::read_to_string(folder.path().join("lattice.csv")).expect("written");
    assert!(corrections.starts_with("run,x_mm") && corrections.contains("cx_um"));
    let last = |text: &str| -> f64 {
        text.lines().nth(5).and_then(|l| l.rsplit(',').next()?.parse().ok()).expect("a number")
    };
    assert!((last(&errors) + last(&corrections)).abs() < 1e-9 && last(&errors) != 0.0);
    // And come back as the same machine.
    let again = folder.path().join("again.toml");
    calibrate(&["volumetric", &file, "--nodes", "9", "--holdout-every", "7"], &again);
    for axis in ["x", "y", "z"] {
        let table = |profile: &str| {
            std::fs::read(folder.path().join(profile).join(format!("{axis}.csv"))).expect("a table")
        };
        assert_eq!(table("made"), table("again"), "{axis}");
    }
}

#[test]
fn what_a_form_does_not_hold_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    for (format, words) in [
        ("linuxcnc", ["monotone interpolation", "straightness"]),
        ("isg", ["monotone interpolation", "where X was measured"]),
        ("csv", ["--interpolation monotone", "where Z was measured"]),
        ("lattice", ["monotone interpolation", "between the lattice's points"]),
    ] {
        let said = messages(&export(format, folder.path(), &[]));
        assert!(words.iter().all(|word| said.contains(word)), "{format}: {said}");
    }
    // Lost motion without a table is written, too.
    let profile = folder.path().join("play.toml");
    let axes = "[axis.X]\ntravel_mm = [0, 100]\nbacklash_um = 6.0\n[axis.Y]\ntravel_mm = [0, 100]\n[axis.Z]\ntravel_mm = [0, 100]\n";
    std::fs::write(&profile, format!("format = 1\nname = \"play\"\nchain = \"[w X Y b Z t]\"\n{axes}"))
        .expect("written");
    let out = folder.path().to_str().expect("plain");
    let output = run(&["profile", "export", profile.to_str().expect("plain"), "--format", "csv", "-O", out]);
    assert!(output.status.success(), "{}", messages(&output));
    let table = std::fs::read_to_string(folder.path().join("x.csv")).expect("written");
    assert_eq!(table, "run,dir,position_mm,EXX_um\n1,1,0,-3\n1,1,100,-3\n1,-1,0,3\n1,-1,100,3\n");
}

#[test]
fn another_temperature_than_that_of_the_calibration_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let program = folder.path().join("part.nc");
    std::fs::write(&program, "G21 G90 G54 G17\nG43 H1 Z100.\nG0 X10. Y10.\nG1 X20. F500.\nM30\n")
        .expect("written");
    let program = program.to_str().expect("plain");
    let warm = messages(&run(&[program, "-m", MILL, "--at", "temp_c=26"]));
    // 6 K, 11.5 µm/m/K, 760 mm.
    assert!(warm.contains("VP1111") && warm.contains("52.4 um"), "{warm}");
    let same = messages(&run(&[program, "-m", MILL, "--at", "temp_c=20.05"]));
    assert!(!same.contains("VP1111"), "{same}");
}

/// No form but the profile holds what a turning axis does; none of them says nothing about it.
#[test]
fn errors_of_rotary_axes_are_never_lost_without_a_word() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let profile = folder.path().join("trunnion.toml");
    let text = "format = 1\nname = \"trunnion\"\ncontrol = \"linuxcnc\"\nchain = \"[w C A X Y b Z t]\"\n\
         [axis.X]\ntravel_mm = [0, 100]\nresolution_mm = 0.001\n[axis.Y]\ntravel_mm = [0, 100]\nresolution_mm = 0.001\n\
         [axis.Z]\ntravel_mm = [0, 100]\nresolution_mm = 0.001\n\
         [rotary.A]\ncentre_mm = [0, 0, 0]\nEY0A_um = 12.0\n[rotary.C]\ncentre_mm = [0, 0, 0]\n";
    std::fs::write(&profile, text).expect("written");
    for (format, words) in [
        ("linuxcnc", "the errors of A"),
        ("isg", "the errors of A"),
        ("csv", "the errors of A"),
        ("lattice", "the errors of A at any angle but 0"),
    ] {
        let (profile, folder) = (profile.to_str().expect("plain"), folder.path().join(format));
        let output =
            run(&["profile", "export", profile, "--format", format, "-O", folder.to_str().expect("plain")]);
        assert!(output.status.success(), "{}", messages(&output));
        assert!(messages(&output).contains(words), "{format}: {}", messages(&output));
    }
}
