//! Published numbers through the command: `vpost solve` and `vpost predict`.

use std::io::Write;
use std::process::Stdio;

use crate::common::{messages, vpost};

const STAN: [&str; 2] = ["-m", "machine-profiles/stan_s500.toml"];

fn table(arguments: &[&str], input: &str) -> Vec<Vec<String>> {
    let mut child = vpost()
        .args(arguments)
        .args(STAN)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    child.stdin.take().expect("piped").write_all(input.as_bytes()).expect("takes it");
    let output = child.wait_with_output().expect("ends");
    assert!(output.status.success(), "{}", messages(&output));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    text.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
}

fn solved(engine: &str, point: [f64; 3]) -> [f64; 3] {
    let input = format!("x_mm,y_mm,z_mm\n{},{},{}\n", point[0], point[1], point[2]);
    let rows = table(&["solve", "-", "--engine", engine], &input);
    assert_eq!(rows[0].join(","), "x_mm,y_mm,z_mm,qx_mm,qy_mm,qz_mm,iterations,residual_um");
    let residual: f64 = rows[1][7].parse().expect("a number");
    assert!(residual <= 1e-6, "{engine}: residual {residual} um");
    [3, 4, 5].map(|at| rows[1][at].parse().expect("a number"))
}

#[test]
fn tangential_methods_reproduce_the_publication() {
    let target = [130.0, 140.0, 106.0];
    for (engine, printed) in [
        ("tangential-static-published", [129.902, 139.929, 105.949]),
        ("tangential-interval-published", [129.768, 139.921, 105.927]),
        ("tangential-quasi-differential-published", [129.844, 139.890, 105.891]),
        // With the signs of the cosines, which the publication lost.
        ("tangential-quasi-differential", [129.930, 139.893, 105.924]),
    ] {
        let found = solved(engine, target);
        for axis in 0..3 {
            assert!(
                (found[axis] - printed[axis]).abs() <= 0.000_501,
                "{engine}: {found:?} against {printed:?}"
            );
        }
    }
}

/// Tables 4.3 and 4.4 of the publication, by its own K and l.
#[test]
fn the_astatic_law_takes_its_numbers() {
    let target = "x_mm,y_mm,z_mm\n130,140,106\n";
    for (gain, step, m, printed) in [
        ("1.5", "0.1", "17", [128.133, 138.759, 106.614]),
        ("1", "0.05", "52", [128.956, 139.645, 107.285]),
        ("1.5", "1", "4", [128.054, 138.668, 106.555]),
    ] {
        let options = ["solve", "-", "--engine", "kmtpp-published", "--gain", gain, "--step", step];
        let rows = table(&options, target);
        assert_eq!(rows[1][6], m, "K {gain}, l {step}");
        for (axis, printed) in printed.into_iter().enumerate() {
            let found: f64 = rows[1][3 + axis].parse().expect("a number");
            assert!((found - printed).abs() <= 0.000_501, "K {gain}, l {step}: {rows:?}");
        }
    }
    for (arguments, expected) in [
        (vec!["--gain", "1"], "is of the astatic law that `kmtpp-published` follows"),
        (vec!["--engine", "kmtpp", "--step", "1"], "add `--engine kmtpp-published`"),
        (vec!["--engine", "kmtpp-published", "--gain", "0"], "--gain"),
    ] {
        let mut command = vpost();
        command.args(["solve", "samples/points/tangential_targets.csv"]).args(STAN).args(&arguments);
        let ran = command.output().expect("starts");
        assert_eq!(ran.status.code(), Some(2), "{arguments:?}");
        assert!(messages(&ran).contains(expected), "{arguments:?}: {}", messages(&ran));
    }
}

#[test]
fn solving_what_was_predicted_gives_the_command_back() {
    let commands = "x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm\n100,50,150,0,0,-120\n399,279,10,1,2,3\n20.5,30.25,199,0,0,0\n";
    let predicted = table(&["predict", "-"], commands);
    assert!(predicted[0].join(",").ends_with("px_mm,py_mm,pz_mm,dx_um,dy_um,dz_um,d_um"));
    let mut targets = String::from("x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm\n");
    for row in &predicted[1..] {
        let value = |at: usize| row[at].parse::<f64>().expect("a number");
        // The target of `solve` is a nominal command: the tip's place less the tool vector.
        let nominal = [0, 1, 2].map(|axis| value(6 + axis) - value(3 + axis));
        targets.push_str(&format!(
            "{},{},{},{},{},{}\n",
            nominal[0], nominal[1], nominal[2], row[3], row[4], row[5]
        ));
        assert!((value(12) - (value(9).powi(2) + value(10).powi(2) + value(11).powi(2)).sqrt()).abs() < 1e-5);
    }
    for (solved, original) in table(&["solve", "-"], &targets)[1..].iter().zip(&predicted[1..]) {
        for axis in 0..3 {
            let (q, x): (f64, f64) =
                (solved[6 + axis].parse().expect("a number"), original[axis].parse().expect("a number"));
            assert!((q - x).abs() <= 2e-9, "{q} {x}");
        }
    }
}

#[test]
fn point_files_are_checked() {
    for (input, says) in [
        ("x_mm,y_mm\n1,2\n", "column `z_mm` is missing"),
        ("x_mm,y_mm,z_mm,w\n1,2,3,4\n", "column `w` is unknown"),
        ("x_mm,y_mm,z_mm\n1,2\n", "the row has 2 cells, the header 3"),
        ("x_mm,y_mm,z_mm\n1,2,inf\n", "`inf` is not a number"),
        ("x_mm,y_mm,z_mm,a_deg\n1,2,3,0\n1,2,3,90\n", "the machine has no axis A"),
        ("", "the file is empty"),
    ] {
        let mut child = vpost()
            .args(["predict", "-"])
            .args(STAN)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("starts");
        child.stdin.take().expect("piped").write_all(input.as_bytes()).expect("takes it");
        let output = child.wait_with_output().expect("ends");
        assert_eq!(output.status.code(), Some(1), "{input}");
        assert!(
            output.stdout.is_empty() && messages(&output).contains(says),
            "{input}: {}",
            messages(&output)
        );
    }
}

#[test]
fn points_outside_the_volume_are_not_passed_over_in_silence() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let points = folder.path().join("points.csv");
    std::fs::write(&points, "x_mm,y_mm,z_mm\n10,10,10\n10,10,230\n").expect("writable");
    let points = points.to_str().expect("a plain path");
    let clamped = vpost().args(["predict", points]).args(STAN).output().expect("runs");
    assert!(clamped.status.success());
    assert!(messages(&clamped).contains("warning[VP0909]: 1 of 2 points"), "{}", messages(&clamped));
    let refused = vpost().args(["predict", points, "--outside", "refuse"]).args(STAN).output().expect("runs");
    assert_eq!(refused.status.code(), Some(1));
    assert!(
        refused.stdout.is_empty() && messages(&refused).contains("error[VP0909]"),
        "{}",
        messages(&refused)
    );
}

#[test]
fn predicting_with_another_engine_uses_its_model() {
    let input = "x_mm,y_mm,z_mm\n130,140,106\n";
    let rigid = table(&["predict", "-"], input);
    let tracker = table(&["predict", "-", "--engine", "tracker"], input);
    assert_ne!(rigid[1], tracker[1]);
    // Forward and inverse of one engine belong together.
    let target: Vec<f64> = (3..6).map(|at| tracker[1][at].parse().expect("a number")).collect();
    let back = solved("tracker", [target[0], target[1], target[2]]);
    for (found, command) in back.iter().zip([130.0, 140.0, 106.0]) {
        assert!((found - command).abs() < 5e-9, "{back:?}");
    }
}
