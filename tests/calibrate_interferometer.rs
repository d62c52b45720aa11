//! `vpost calibrate interferometer`: the files people have, and the questions that must be asked.

mod common;

use std::path::{Path, PathBuf};
use std::process::Output;

use common::{messages, run, vpost};

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
    fn calibrate(&self, arguments: &[&str]) -> Output {
        let known = ["--date", "2026-05-15", "--temperature", "20", "--instrument", "test"];
        vpost()
            .args(["calibrate", "interferometer", "-m", "machine-profiles/generic_vmc.toml"])
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
    let output = room.calibrate(&[&millimetres]);
    assert!(
        messages(&output).contains("VP1102") && messages(&output).contains("larger unit"),
        "{}",
        messages(&output)
    );
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
