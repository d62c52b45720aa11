//! `vpost calibrate interferometer`: the files people have, and the questions that must be asked.

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::{messages, run, vpost};

struct Room {
    folder: tempfile::TempDir,
}

impl Room {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().expect("a folder") }
    }
    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }
    fn file(&self, name: &str, text: &str) -> String {
        std::fs::write(self.path(name), text).expect("written");
        self.path(name).to_str().expect("a plain name").to_owned()
    }
    /// A new machine.
    fn calibrate(&self, arguments: &[&str]) -> Output {
        self.with(&["--chain", "[w X Y b Z t]"], arguments)
    }
    /// The generic mill, measured again.
    fn mill(&self, arguments: &[&str]) -> Output {
        self.with(&["-m", "machine-profiles/generic_vmc.toml"], arguments)
    }
    fn with(&self, machine: &[&str], arguments: &[&str]) -> Output {
        let known = ["--date", "2026-05-15", "--temperature", "20", "--instrument", "test"];
        vpost()
            .args(["calibrate", "interferometer"])
            .args(machine)
            .args(arguments)
            .args(known)
            .arg("-o")
            .arg(self.path("made.toml"))
            .output()
            .expect("the command starts")
    }
    fn made(&self, name: &str) -> String {
        std::fs::read_to_string(self.path("made").join(name)).expect("a table was written")
    }
}

fn said(output: &Output, wanted: &[&str]) {
    let text = messages(output);
    assert!(!output.status.success() && wanted.iter().all(|w| text.contains(w)), "{wanted:?} in {text}");
}

fn good(output: &Output) {
    assert!(output.status.success(), "{}", messages(output));
}

/// Two runs up and two down over three targets, µm.
const RTL: &str = "HEADER::\nFile type: RTL\n\nTARGET DATA::\nFiletype: linear\nTarget-count: 3\nTargets :\n  -300.0000  -200.0000\n  -100.0000\nFlags: 0 0 2 0\n\nUSER-TEXT::\nMachine: mill\nDate: 2026-05-15\nAxis: X\n\nRUNS::\nRun-count: 4\n\nDEVIATIONS::\nRun Target Data:\n1 1 0.0\n1 2 2.0\n1 3 4.0\n2 3 7.0\n2 2 5.0\n2 1 3.0\n3 1 0.2\n3 2 2.2\n3 3 4.2\n4 3 7.2\n4 2 5.2\n4 1 3.2\n\nENVIRONMENT::\nAir temp: 20.1\n\nEOF::\n";

#[test]
fn an_rtl_file_becomes_two_tables() {
    let room = Room::new();
    let file = room.file("x.rtl", RTL);
    said(&room.calibrate(&[&file]), &["VP1106", "=EXX:um"]);
    said(&room.calibrate(&[&format!("{file}=EXX")]), &["VP1106", "unit"]);
    said(&room.calibrate(&[&format!("{file}=EYY:um")]), &["VP1101", "the file says axis X"]);
    let output = room.calibrate(&[&format!("{file}=EXX:um")]);
    good(&output);
    assert_eq!(room.made("x.csv"), "position_mm,EXX_um\n-300,0.1\n-200,2.1\n-100,4.1\n");
    assert_eq!(room.made("x_negative.csv"), "position_mm,EXX_um\n-300,3.1\n-200,5.1\n-100,7.1\n");
    let report = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(report.contains("2 runs up, 2 down") && report.contains("  B       3.000"), "{report}");
    // Two runs are not the standard's five.
    assert!(messages(&output).contains("VP1108"), "{}", messages(&output));
    let profile = std::fs::read_to_string(room.path("made.toml")).expect("written");
    assert!(profile.contains("errors_negative") && !profile.contains("backlash_um   = 6.0"), "{profile}");
    // Mean and reversal value instead: after coming from above the axis stands 3 µm further.
    good(&room.calibrate(&[&format!("{file}=EXX:um"), "--directions", "mean"]));
    assert_eq!(room.made("x.csv"), "position_mm,EXX_um\n-300,1.6\n-200,3.6\n-100,5.6\n");
    let profile = std::fs::read_to_string(room.path("made.toml")).expect("written");
    assert!(profile.contains("backlash_um = 3.0"), "{profile}");
}

#[test]
fn a_broken_off_measurement_is_not_averaged() {
    let room = Room::new();
    let broken = room.file("x.rtl", &RTL.replace("4 3 7.2\n4 2 5.2\n4 1 3.2\n", "4 3 7.2\n4 2 5.2\n"));
    said(&room.calibrate(&[&format!("{broken}=EXX:um")]), &["VP1104", "-300"]);
    let missing = room.file("x.rtl", &RTL.replace("4 3 7.2\n4 2 5.2\n4 1 3.2\n", ""));
    said(&room.calibrate(&[&format!("{missing}=EXX:um")]), &["VP1104", "4 runs are announced and 3"]);
    let targets = room.file("x.rtl", &RTL.replace("Target-count: 3", "Target-count: 4"));
    said(&room.calibrate(&[&format!("{targets}=EXX:um")]), &["VP0910", "4 targets are announced and 3"]);
}

#[test]
fn columns_of_runs_and_own_csv_say_the_same() {
    let room = Room::new();
    let table = room.file("x.txt", "Target (mm)\tRun 1 + (um)\tRun 2 - (um)\tRun 3 +\tRun 4 -\n-300\t0.0\t3.0\t0.2\t3.2\n-200\t2.0\t5.0\t2.2\t5.2\n-100\t4.0\t7.0\t4.2\t7.2\n");
    good(&room.calibrate(&[&format!("{table}=EXX")]));
    let (up, down) = (room.made("x.csv"), room.made("x_negative.csv"));
    let csv = room.file("x.csv", "run,dir,position_mm,EXX_um\n1,1,-300,0\n1,1,-200,2\n1,1,-100,4\n1,-1,-100,7\n1,-1,-200,5\n1,-1,-300,3\n2,1,-300,0.2\n2,1,-200,2.2\n2,1,-100,4.2\n2,-1,-100,7.2\n2,-1,-200,5.2\n2,-1,-300,3.2\n");
    good(&room.calibrate(&[&csv]));
    assert_eq!((room.made("x.csv"), room.made("x_negative.csv")), (up, down));
}

#[test]
fn ways_of_runs_are_asked_where_no_title_says_them() {
    let room = Room::new();
    let rows = "-300\t0.0\t3.0\t0.2\t3.2\n-200\t2.0\t5.0\t2.2\t5.2\n-100\t4.0\t7.0\t4.2\t7.2\n";
    let table = |name: &str, runs: [&str; 4]| {
        format!("{}=EXX:um", room.file(name, &format!("Target\t{}\n{rows}", runs.join("\t"))))
    };
    let said_by = table("said.txt", ["Run 1 forward", "Run 2 reverse", "Run 3 (up)", "Run 4-"]);
    good(&room.calibrate(&[&said_by]));
    let both = (room.made("x.csv"), room.made("x_negative.csv"));
    // Numbers with a stroke, and no direction.
    let unsaid = table("unsaid.txt", ["Run-1", "Run-2", "Run-3", "Run-4"]);
    said(&room.calibrate(&[&unsaid]), &["VP1106", "`run-1`", "--runs alternating"]);
    good(&room.calibrate(&[&unsaid, "--runs", "alternating"]));
    assert_eq!((room.made("x.csv"), room.made("x_negative.csv")), both);
    good(&room.calibrate(&[&unsaid, "--runs", "up"]));
    assert_eq!(room.made("x.csv"), "position_mm,EXX_um\n-300,1.6\n-200,3.6\n-100,5.6\n");
}

#[test]
fn a_deviation_of_an_axis_is_that_of_the_axis_that_moved() {
    let room = Room::new();
    let rows = "1;1;0;0,0\n1;1;100;2,1\n1;-1;100;4,0\n1;-1;0;2,2\n";
    let russian = |name: &str, deviation: &str| {
        room.file(name, &format!("Проход;Направление;Позиция, мм;{deviation}, мкм\n{rows}"))
    };
    good(&room.calibrate(&[&russian("x.csv", "Отклонение X")]));
    assert_eq!(room.made("x.csv"), "position_mm,EXX_um\n0,0\n100,2.1\n");
    assert_eq!(room.made("x_negative.csv"), "position_mm,EXX_um\n0,2.2\n100,4\n");
    // Straightness, where the axis that moved is said.
    good(&room.calibrate(&[&format!("{}=EZX", russian("z.csv", "Отклонение Z"))]));
    assert!(room.made("x.csv").starts_with("position_mm,EZX_um\n"), "{}", room.made("x.csv"));
    let z = format!("{}=EYX", russian("z.csv", "Отклонение Z"));
    said(&room.calibrate(&[&z]), &["VP1101", "EYX", "EZX"]);
    let two = room.file("two.csv", "position_mm,dx_um,dy_um\n0,0,0\n100,2,1\n");
    said(&room.calibrate(&[&two]), &["VP1106", "which axis moved", "two.csv=EXX"]);
    good(&room.calibrate(&[&format!("{two}=EXX")]));
    let own = room.file("own.csv", "position_mm,EXX_um\n0,0\n100,2\n");
    said(&room.calibrate(&[&format!("{own}=EYY")]), &["VP1101", "EYY", "EXX"]);
}

#[test]
fn control_tables_are_asked_what_they_mean() {
    let room = Room::new();
    let positions =
        room.file("x.comp", "-300 -299.999 -299.996\n-200 -199.997 -199.994\n-100 -99.995 -99.992\n");
    said(&room.calibrate(&[&positions]), &["VP1106", "=EXX"]);
    said(&room.calibrate(&[&format!("{positions}=EXX")]), &["VP1106", "--values positions"]);
    good(&room.calibrate(&[&format!("{positions}=EXX"), "--values", "positions"]));
    let (up, down) = (room.made("x.csv"), room.made("x_negative.csv"));
    assert_eq!(up, "position_mm,EXX_um\n-300,1\n-200,3\n-100,5\n");
    // COMP_FILE_TYPE = 1: what is added.
    let trims = room.file("x.comp", "-300 -0.001 -0.004\n-200 -0.003 -0.006\n-100 -0.005 -0.008\n");
    good(&room.calibrate(&[&format!("{trims}=EXX"), "--values", "corrections"]));
    assert_eq!((room.made("x.csv"), room.made("x_negative.csv")), (up, down));
    let table = room.file("x.com", "NR AXISPOS BACKLASH X Z\n0 -300 -0.004 -0.001 0.002\n1 -200 -0.006 -0.003 0.002\n2 -100 -0.008 -0.005 0.001\n");
    said(&room.calibrate(&[&format!("{table}=EXX")]), &["VP1106", "--values errors"]);
    good(&room.calibrate(&[&format!("{table}=EXX"), "--values", "corrections"]));
    assert_eq!(room.made("x.csv"), "position_mm,EXX_um,EZX_um\n-300,1,-2\n-200,3,-2\n-100,5,-1\n");
}

#[test]
fn isg_tables_of_a_carriage_move_to_the_line() {
    let room = Room::new();
    let text = "// component errors of X\nX EXX EYX EZX EAX EBX ECX\n-300 0.001 0 0 0 0 0.00001\n-100 0.003 0 0 0 0.00002 0.00001\n";
    let file = room.file("x.isg", text);
    // X carries the table of the generic mill.
    said(&room.calibrate(&[&file]), &["VP1106", "--reference"]);
    good(&room.calibrate(&[&file, "--reference", "line"]));
    let line = room.made("x.csv");
    assert!(line.contains("-100,3,0,0,0,20,10"), "{line}");
    good(&room.calibrate(&[&file, "--reference", "carriage"]));
    // ε × q e_x = (0, ε_z q, -ε_y q): at -100 mm y -1 µm, z +2 µm.
    let carriage = room.made("x.csv");
    assert!(carriage.contains("-100,3,-1,2,0,20,10"), "{carriage}");
}

#[test]
fn squareness_needs_its_convention_and_what_becomes_of_slopes() {
    let room = Room::new();
    let file = room.file("y.csv", "position_mm,EYY_um,EXY_um\n-400,0,0\n-200,1,4\n0,2,8\n");
    let given = ["--squareness", "XY=24,ZX=-31,YZ=18"];
    said(&room.calibrate(&[&file, given[0], given[1]]), &["VP1106", "--squareness-convention"]);
    let with = [&file, given[0], given[1], "--squareness-convention", "larger-than90"];
    said(&room.calibrate(&with), &["VP1106", "EXY", "20.0 urad", "--straightness-slopes"]);
    let mut all = with.to_vec();
    all.extend(["--straightness-slopes", "remove"]);
    good(&room.calibrate(&all));
    assert_eq!(room.made("y.csv"), "position_mm,EXY_um,EYY_um\n-400,0,0\n-200,0,1\n0,0,2\n");
    let profile = std::fs::read_to_string(room.path("made.toml")).expect("written");
    assert!(profile.contains("EB0Z_urad = 31.0") && profile.contains("EC0Y_urad = 24.0"), "{profile}");
}

#[test]
fn wrong_units_are_noticed() {
    let room = Room::new();
    let millimetres = room.file("x.csv", "position_mm,EXX_um\n-400,0\n-300,0.002\n-200,0.004\n-100,0.006\n");
    said(&room.calibrate(&[&millimetres]), &["VP1102", "larger unit"]);
    let nanometres = room.file("x.csv", "position_mm,EXX_um\n-400,0\n-300,2000\n-200,4000\n-100,6000\n");
    let output = room.calibrate(&[&nanometres]);
    assert!(
        messages(&output).contains("VP1102") && messages(&output).contains("smaller unit"),
        "{}",
        messages(&output)
    );
}

#[test]
fn finer_tables_and_the_report_of_public_runs() {
    let room = Room::new();
    let file = room.file("x.csv", "position_mm,EXX_um\n-40,0\n-20,1\n0,-1\n");
    good(&room.calibrate(&[&file, "--refine", "10", "--interpolation", "linear"]));
    assert_eq!(room.made("x.csv"), "position_mm,EXX_um\n-40,0\n-30,0.5\n-20,1\n-10,0\n0,-1\n");
    let output = run(&["calibrate", "interferometer", "samples/calibration/iso230_2_psi_2021.csv"]);
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    for figure in ["A     230.373", "E      70.088", "M      35.997", "R     230.373", "B      46.486"] {
        assert!(text.contains(figure), "{figure} in\n{text}");
    }
    assert!(Path::new(&file).exists());
}

/// The generic mill with effects, its tables by their full names.
fn mill_with_effects(room: &Room) -> String {
    let text = std::fs::read_to_string(crate::common::root().join("machine-profiles/generic_vmc.toml"))
        .expect("a profile");
    let tables = crate::common::root().join("machine-profiles/generic_vmc/");
    let text = text.replace("generic_vmc/", &tables.display().to_string());
    let more = "\n[[effect]]\nid = \"scale.X\"\nscale_um_per_m = 50.0\n[[effect]]\nid = \"thermal.X\"\nexpansion_um_per_m_k = 11.5\n";
    room.file("mill.toml", &(text + more))
}

/// dx, dy, dz in µm of each row, at 24 °C.
fn predicted(profile: &str, points: &str, room: &Room) -> Vec<[f64; 3]> {
    let file = room.file("points.csv", points);
    let output = run(&["predict", &file, "-m", profile, "--at", "temp_c=24"]);
    good(&output);
    let text = String::from_utf8(output.stdout).expect("text");
    let place = text.lines().next().expect("a header").split(',').position(|c| c == "dx_um").expect("dx_um");
    let number =
        |line: &str, k: usize| line.split(',').nth(place + k).and_then(|v| v.parse().ok()).expect("a number");
    text.lines().skip(1).map(|line| [0, 1, 2].map(|k| number(line, k))).collect()
}

#[test]
fn a_machine_measured_from_its_own_profile_gives_it_back() {
    let room = Room::new();
    let base = mill_with_effects(&room);
    // X alone, warm, along another line than that of the base, from the instrument's own zero and an askew straightedge.
    let mut places = String::from("x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm,dir_x\n");
    let targets: Vec<i32> = (0..20).map(|k| -760 + 40 * k).collect();
    for sign in [1, -1] {
        for x in &targets {
            places.push_str(&format!("{x},-100,-60,20,10,-80,{sign}\n"));
        }
    }
    let read = predicted(&base, &places, &room);
    let mut text = String::from("run,dir,position_mm,EXX_um,EYX_um,temp_c\n");
    for (k, [x, y, _]) in read.iter().enumerate() {
        let (q, sign) = (targets[k % 20], if k < 20 { 1 } else { -1 });
        text.push_str(&format!("1,{sign},{q},{},{},24\n", x - read[0][0], y + 0.03 * f64::from(q) + 5.0));
    }
    let file = room.file("x.csv", &text);
    let made = room.path("own.toml").display().to_string();
    let lines = ["--through", "-380,-100,-60", "--optics", "20,10,-80"];
    let output = run(&[
        "calibrate",
        "interferometer",
        &file,
        "-m",
        &base,
        lines[0],
        lines[1],
        lines[2],
        lines[3],
        "-o",
        &made,
    ]);
    good(&output);
    let mut grid = places.clone();
    for (x, y, z) in [(0, 0, 0), (-760, -420, -510), (-333, -17, -401), (-12, -300, -5)] {
        grid.push_str(&format!("{x},{y},{z},0,0,-150,1\n{x},{y},{z},50,-60,-20,-1\n"));
    }
    let (before, after) = (predicted(&base, &grid, &room), predicted(&made, &grid, &room));
    for (a, b) in before.iter().flatten().zip(after.iter().flatten()) {
        // Four decimals of a µm are written; before this rule the scale stood there twice, 38 µm.
        assert!((a - b).abs() < 2e-3, "{a} {b}");
    }
    let profile = std::fs::read_to_string(&made).expect("written");
    assert!(
        profile.contains("temperature_c = 20.0") && profile.contains("scale_um_per_m = 50.0"),
        "{profile}"
    );
    // Without a temperature the expansion cannot be taken off.
    let cold = room.file("x.csv", &text.replace(",temp_c\n", "\n").replace(",24\n", "\n"));
    let output = run(&["calibrate", "interferometer", &cold, "-m", &base, "-o", &made]);
    said(&output, &["VP0401", "temperature"]);
    good(&run(&["calibrate", "interferometer", &cold, "-m", &base, "-o", &made, "--temperature", "24"]));
}

#[test]
fn squareness_read_between_lines_is_that_of_the_lines() {
    let room = Room::new();
    // Angles zeroed at the first target, as instruments do; where the lines cross, at 100, Y is turned by 30 urad, and Z with it.
    let file = room.file("y.csv", "position_mm,EYY_um,EAY_urad\n0,0,0\n100,1,30\n200,2,60\n");
    let with = [
        "--squareness",
        "YZ=12",
        "--squareness-convention",
        "right-handed",
        "--straightness-slopes",
        "remove",
    ];
    let made = room.path("made.toml").display().to_string();
    let mut arguments = vec![
        "calibrate",
        "interferometer",
        &file,
        "--chain",
        "[w Y X b Z t]",
        "--through",
        "50,100,0",
        "-o",
        &made,
    ];
    arguments.extend(with);
    good(&run(&arguments));
    let profile = std::fs::read_to_string(&made).expect("written");
    // EA0Z + EAY(100): a positive rotation about X closes the angle between Y and Z.
    assert!(profile.contains("EA0Z_urad = -18.0"), "{profile}");
    assert!(!profile.contains("EB0Z"), "nobody read it: {profile}");
}

#[test]
fn a_machine_comes_into_being_axis_by_axis() {
    let room = Room::new();
    let path = |name: &str| room.path(name).display().to_string();
    let first = room.file("x.csv", "position_mm,EXX_um,ECX_urad\n0,0,0\n200,3,5\n400,4,9\n");
    let second = room.file("y.csv", "position_mm,EYY_um\n-300,0\n0,2\n");
    let place = ["--through", "100,-50,20", "--chain", "[w X Y b Z t]"];
    let output = run(&[
        "calibrate",
        "interferometer",
        &first,
        place[0],
        place[1],
        place[2],
        place[3],
        "-o",
        &path("one.toml"),
    ]);
    good(&output);
    assert!(messages(&output).contains("how far Y and Z can go is not known"), "{}", messages(&output));
    let profile = std::fs::read_to_string(room.path("one.toml")).expect("written");
    assert!(profile.contains("travel_mm = [-50.0005, -49.9995]"), "{profile}");
    good(&run(&[
        "calibrate",
        "interferometer",
        &second,
        "-m",
        &path("one.toml"),
        place[0],
        place[1],
        "-o",
        &path("two.toml"),
    ]));
    let profile = std::fs::read_to_string(room.path("two.toml")).expect("written");
    assert!(!profile.contains("-50.0005") && profile.contains("19.9995"), "{profile}");
    // Squareness alone, tomorrow.
    let given = ["--squareness", "XY=25", "--squareness-convention", "right-handed"];
    good(&run(&[
        "calibrate",
        "interferometer",
        "-m",
        &path("two.toml"),
        given[0],
        given[1],
        given[2],
        given[3],
        place[0],
        place[1],
        "-o",
        &path("three.toml"),
    ]));
    let profile = std::fs::read_to_string(room.path("three.toml")).expect("written");
    // X turns what it carries by 2.5 urad where the lines cross, after 0 at its first target.
    assert!(profile.contains("EC0Y_urad = 22.5"), "{profile}");
    assert!(profile.contains("one/x.csv") || profile.contains("three/x.csv"), "{profile}");
}

#[test]
fn mistakes_that_the_readings_contradict_are_refused() {
    let room = Room::new();
    let rows = |sign: f64, scale: f64, wander: [f64; 3]| {
        let mut text = String::from("run,dir,position_mm,EXX_um\n");
        for run in 0..2 {
            for dir in [1.0, -1.0] {
                for (k, q) in [-300, -200, -100].into_iter().enumerate() {
                    let noise = wander[(k + run) % 3] * if run == 0 { 1.0 } else { -1.0 };
                    let value = scale * (4.0 * k as f64 - sign * dir * 3.0 + noise);
                    text.push_str(&format!("{run},{dir},{q},{value}\n"));
                }
            }
        }
        text
    };
    let good_rows = rows(1.0, 1.0, [0.1, 0.2, -0.1]);
    good(&room.mill(&[&room.file("x.csv", &good_rows)]));
    let says = |text: &str, more: &[&str], wanted: &[&str]| {
        let file = room.file("x.csv", text);
        let mut arguments = vec![file.as_str()];
        arguments.extend(more);
        said(&room.mill(&arguments), wanted);
    };
    says(&rows(-1.0, 1.0, [0.1, 0.2, -0.1]), &[], &["VP1101", "lost motion is the other way round"]);
    says(&rows(1.0, 1e-3, [0.1, 0.2, -0.1]), &[], &["VP1102", "larger unit"]);
    says(&good_rows.replace("00,", "00000,"), &[], &["VP1101", "the travel of X"]);
    says(
        &good_rows.replace("EXX", "EYY").replace("-300,", "-700,"),
        &[],
        &["VP1101", "EYY has a target at -700 mm"],
    );
    says(&good_rows, &["--through", "9000,9000,9000"], &["VP0002", "X does not go to 9000 mm"]);
    // One run, written twice: its noise differs from up to down and not from run to run.
    let one = "run,dir,position_mm,EXX_um\n1,1,-300,0.1\n1,1,-200,2.2\n1,1,-100,4.0\n1,-1,-300,3.0\n1,-1,-200,5.5\n1,-1,-100,7.3\n";
    let twice = one.to_owned() + &one.lines().skip(1).map(|l| format!("2{}\n", &l[1..])).collect::<String>();
    says(&twice, &[], &["VP1104", "the same to the last digit"]);
    good(&room.mill(&[&room.file("x.csv", one)]));
}

#[test]
fn a_controls_table_replaces_what_the_base_says_of_its_functions() {
    let room = Room::new();
    let positions =
        room.file("x.comp", "-300 -299.999 -299.996\n-200 -199.997 -199.994\n-100 -99.995 -99.992\n");
    good(&room.mill(&[&format!("{positions}=EXX"), "--values", "positions"]));
    let table = room.made("x.csv");
    assert!(table.starts_with("position_mm,EXX_um,EYX_um"), "{table}");
    for wanted in ["\n-300,1,", "\n-280,1.4,2.3,-5.27,", "\n-200,3,", "\n-100,5,"] {
        assert!(table.contains(wanted), "{wanted} in {table}");
    }
    assert_eq!(room.made("x.csv").lines().count(), room.made("x_negative.csv").lines().count());
}

#[test]
fn a_reversal_value_of_readings_without_direction_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("x.csv");
    let profile = folder.path().join("x.toml");
    let calibrated = |rows: &str, directions: &str| {
        std::fs::write(&file, rows).expect("writable");
        let _ = std::fs::remove_file(&profile);
        let name = |path: &std::path::Path| path.to_str().expect("a plain path").to_owned();
        let chain = ["--chain", "[w X Y b Z t]", "--directions", directions];
        let ran = run(
            &[&["calibrate", "interferometer", &name(&file), "-o", &name(&profile)], &chain[..]].concat()
        );
        (ran.status.code(), messages(&ran))
    };
    let silent = "position_mm,EXX_um\n0,1\n100,2\n200,4\n";
    let (code, said) = calibrated(silent, "mean");
    assert!(
        code == Some(2) && said.contains("from which side X came") && said.contains("column dir"),
        "{code:?} {said}"
    );
    assert!(!profile.exists());
    assert_eq!(calibrated(silent, "tables").0, Some(0));
    let both = "position_mm,EXX_um,dir\n0,1,1\n100,2,1\n200,4,1\n200,8,-1\n100,6,-1\n0,5,-1\n";
    assert_eq!(calibrated(both, "mean").0, Some(0));
}

/// Bad input that a metrologist meets first: two axes in one file, told by a column; targets read there and back, and
/// nothing says which was which. In both languages.
#[test]
fn two_axes_in_a_file_and_readings_without_a_direction_say_what_to_do() {
    let room = Room::new();
    let axes = room.file(
        "axes.csv",
        "axis,run,dir,position_mm,EXX_um\nX,1,1,0,0\nX,1,1,100,2\nY,1,1,0,0\nY,1,1,100,3\n",
    );
    let said = |arguments: &[&str]| {
        let output = room.calibrate(arguments);
        (output.status.code(), messages(&output))
    };
    let (status, english) = said(&[&axes]);
    assert_eq!(status, Some(1), "{english}");
    assert!(
        english.contains("a file holds the readings of one axis") && english.contains(":1:1"),
        "{english}"
    );
    assert!(
        english.contains("split the rows by this column") && !english.contains("ignore-column"),
        "{english}"
    );
    let (_, russian) = said(&["--lang", "ru", &axes]);
    assert!(
        russian.contains("разделите строки по этому столбцу") && !russian.contains("axis of"),
        "{russian}"
    );

    let rows = |text: &str| format!("run,position_mm,EXX_um\n{text}");
    let twice = room.file("twice.csv", &rows("1,0,0\n1,100,2\n2,0,9\n2,100,12\n"));
    let (_, english) = said(&[&twice]);
    assert!(english.contains("VP1108") && english.contains("nothing says from which side"), "{english}");
    assert!(english.contains("add a column `dir`"), "{english}");
    let (_, russian) = said(&["--lang", "ru", &twice]);
    assert!(
        russian.contains("не сказано, с какой стороны") && russian.contains("добавьте столбец `dir`"),
        "{russian}"
    );
    // There and back in one run: that cannot be guessed at all.
    let back = room.file("back.csv", &rows("1,0,0\n1,100,2\n1,100,11\n1,0,9\n"));
    let (status, english) = said(&[&back]);
    assert_eq!(status, Some(1), "{english}");
    assert!(english.contains("VP1104") && english.contains("a column `dir` would"), "{english}");
    // Once each: nothing to tell apart.
    let once = room.file("once.csv", &rows("1,0,0\n1,100,2\n"));
    let (_, english) = said(&[&once]);
    assert!(!english.contains("from which side"), "{english}");
    let large = room.file("large.csv", "run,dir,position_mm,EXX_um\n1,1,0,0\n1,1,100,2000\n1,1,200,3500\n");
    let (_, russian) = said(&["--lang", "ru", &large]);
    assert!(russian.contains("3500 мкм"), "{russian}");
}
