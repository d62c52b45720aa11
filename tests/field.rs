//! Engine `field` through the whole command: vectors of a known machine to corrected programs.

use std::fmt::Write as _;
use std::path::PathBuf;

use crate::common::{messages, run, vpost};

/// The known machine; its tool vector is 150 mm.
const MACHINE: &str = "machine-profiles/generic_vmc.toml";
const BOX_MM: [[f64; 2]; 3] = [[-760.0, 0.0], [-420.0, 0.0], [-510.0, 0.0]];
const PROGRAM: &str = "%\nO1000\nG21 G17 G90 G54 G40 G80\nT1 M6\nG43 H2\nS3000 M3\nG0 X-200. Y-100. Z120.\nG1 Z20. F500.\nX250. F1500.\nY180.\nX-200.\nY-100.\nX100. Y50. Z60.\nG2 X200. Y50. I50. J0.\nG3 X100. Y50. I-50. J0.\nG1 X0. Y0. Z10.\nG2 X0. Y0. I80. J0.\nG0 Z120.\nG81 X50. Y50. Z0. R30. F200.\nX80.\nG80\nG0 Z120.\nM30\n%\n";

/// A folder with vectors and a profile that names them.
struct Shop(tempfile::TempDir);

impl Shop {
    fn new(vectors: &str, field: &str) -> Self {
        let shop = Self(tempfile::tempdir().expect("a temporary folder"));
        let axes: String = ["X", "Y", "Z"]
            .iter()
            .zip(BOX_MM)
            .map(|(axis, [low, high])| format!("[axis.{axis}]\ntravel_mm = [{low}, {high}]\n"))
            .collect();
        // A long program zero: lengths as the generic machine has them.
        let profile = format!(
            "format = 1\nname = \"FIELD\"\ncontrol = \"fanuc\"\nchain = \"[w X Y b Z t]\"\n{axes}[field]\nfile = \"vectors.csv\"\n{field}\n[tool]\ndefault_mm = [0, 0, -150]\nlengths_mm = {{ H1 = 120.0, H2 = 150.0 }}\n[work_offsets_mm]\nG54 = [-440, -250, -500]\n[correction]\nengine = \"field\"\n"
        );
        shop.write("vectors.csv", vectors);
        shop.write("field.toml", &profile);
        shop.write("posted.nc", PROGRAM);
        shop
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(self.0.path().join(name), text).expect("writable");
    }

    /// What `profile check` says against it; nothing where it is fine.
    fn refusal(&self) -> String {
        let ran = run(&["profile", "check", &self.path("field.toml")]);
        if ran.status.success() { String::new() } else { messages(&ran) }
    }
}

fn text(places: &[[f64; 3]]) -> String {
    let mut text = String::from("x_mm,y_mm,z_mm\n");
    for [x, y, z] in places {
        let _ = writeln!(text, "{x:.6},{y:.6},{z:.6}");
    }
    text
}

/// The errors of a profile at places, µm, as printed.
fn predicted(profile: &str, places: &[[f64; 3]]) -> Vec<[String; 3]> {
    use std::io::Write as _;
    use std::process::Stdio;
    let mut child = vpost()
        .args(["predict", "-", "-m", profile])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("starts");
    child.stdin.take().expect("piped").write_all(text(places).as_bytes()).expect("takes it");
    let output = child.wait_with_output().expect("ends");
    assert!(output.status.success(), "{}", messages(&output));
    let table = String::from_utf8(output.stdout).expect("UTF-8");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        [6, 7, 8].map(|at| cells[at].to_owned())
    };
    table.lines().skip(1).map(row).collect()
}

fn lattice(counts: [usize; 3]) -> Vec<[f64; 3]> {
    let along = |axis: usize, k: usize| {
        let [low, high] = BOX_MM[axis];
        low + (high - low) * k as f64 / (counts[axis] - 1) as f64
    };
    let mut places = Vec::new();
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                places.push([along(0, i), along(1, j), along(2, k)]);
            }
        }
    }
    places
}

fn vectors(places: &[[f64; 3]], errors: &[[String; 3]]) -> String {
    let mut text = String::from("x_mm,y_mm,z_mm,dx_um,dy_um,dz_um\n");
    for ([x, y, z], [dx, dy, dz]) in places.iter().zip(errors) {
        let _ = writeln!(text, "{x:.6},{y:.6},{z:.6},{dx},{dy},{dz}");
    }
    text
}

/// Numbers between 0 and 1, always the same (Park and Miller 1988).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0 * 48_271 % 2_147_483_647;
        self.0 as f64 / 2_147_483_647.0
    }

    fn gauss(&mut self) -> f64 {
        (0..12).map(|_| self.next()).sum::<f64>() - 6.0
    }

    fn places(&mut self, count: usize) -> Vec<[f64; 3]> {
        (0..count).map(|_| BOX_MM.map(|[low, high]| low + (high - low) * self.next())).collect()
    }
}

/// 240 vectors of the known machine with a noise of 1 µm.
fn noisy() -> String {
    let mut random = Random(20_231);
    let places = random.places(240);
    let mut errors = predicted(MACHINE, &places);
    for value in errors.iter_mut().flatten() {
        *value = format!("{:.3}", value.parse::<f64>().expect("a number") + random.gauss());
    }
    vectors(&places, &errors)
}

/// Corrects the program for a field and judges it: by the field, which must pass, and by the machine that was measured.
fn closed(shop: &Shop, tolerance: &str) -> f64 {
    let [posted, out, field] = ["posted.nc", "out.nc", "field.toml"].map(|name| shop.path(name));
    let ran = run(&[&posted, "-m", &field, "-o", &out, "--tolerance", tolerance, "-q"]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let own = run(&["check", &posted, &out, "-m", &field, "--tolerance", tolerance, "--json"]);
    assert!(own.status.success(), "{}", String::from_utf8_lossy(&own.stdout));
    let judged: serde_json::Value = serde_json::from_slice(&own.stdout).expect("JSON");
    assert!(judged["deviation_before_um"].as_f64().expect("a number") > 15.0, "{judged:#}");
    // Without the play of its axes, which a field has not.
    let known = std::fs::read_to_string(crate::common::root().join(MACHINE)).expect("reads");
    let known: String =
        known.lines().filter(|l| !l.starts_with("backlash")).map(|l| format!("{l}\n")).collect();
    let known = known.replace("G54 = [-440, -250, -350]", "G54 = [-440, -250, -500]");
    let known = known.replace(
        "generic_vmc/",
        &format!("{}/machine-profiles/generic_vmc/", crate::common::root().display()),
    );
    shop.write("known.toml", &known);
    let truth =
        run(&["check", &posted, &out, "-m", &shop.path("known.toml"), "--tolerance", tolerance, "--json"]);
    let judged: serde_json::Value = serde_json::from_slice(&truth.stdout).expect("JSON");
    judged["deviation_after_um"].as_f64().expect("a number")
}

#[test]
fn programs_corrected_for_a_lattice_hold_on_the_machine() {
    // Nodes where the tables have theirs: what lies between is all that a lattice cannot know.
    let places = lattice([20, 15, 18]);
    let errors = predicted(MACHINE, &places);
    let shop = Shop::new(&vectors(&places, &errors), "noise_um = 0");
    // At the nodes it says what the machine says, digit by digit.
    assert_eq!(predicted(&shop.path("field.toml"), &places), errors);
    let left_um = closed(&shop, "1");
    println!("lattice: {left_um} um off on the machine");
    assert!(left_um < 3.0, "{left_um}");
}

#[test]
fn programs_corrected_for_noisy_vectors_hold_as_far_as_the_noise_lets_them() {
    let shop = Shop::new(&noisy(), "noise_um = 1.0");
    let left_um = closed(&shop, "1");
    println!("noisy: {left_um} um off on the machine");
    // A micrometre of tolerance, half a micrometre of rounding, and what noise and tables between the vectors leave.
    assert!(left_um < 5.0, "{left_um}");
    let [posted, field, folder] = ["posted.nc", "field.toml", "outputs"].map(|name| shop.path(name));
    // The same bytes in a batch, and places that were not measured are refused.
    let ran = run(&["batch", &posted, "-m", &field, "-O", &folder, "--tolerance", "1", "-q"]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let written = PathBuf::from(&folder).join("posted.nc");
    assert_eq!(std::fs::read(written).expect("there"), std::fs::read(shop.path("out.nc")).expect("there"));
    shop.write("posted.nc", &PROGRAM.replace("X250. F1500.", "X450. F1500."));
    let ran = run(&[&posted, "-m", &field]);
    assert_eq!(ran.status.code(), Some(1));
    assert!(messages(&ran).starts_with("error[VP0501]"), "{}", messages(&ran));
    let ran = run(&[&posted, "-m", &field, "--outside", "clamp", "-q"]);
    assert!(ran.status.success(), "{}", messages(&ran));
    // The field as a lattice for a control is a field again.
    let ran = run(&["profile", "export", &field, "--format", "lattice", "-O", &folder, "--step", "100"]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let lattice = std::fs::read_to_string(PathBuf::from(&folder).join("lattice.csv")).expect("there");
    assert_eq!(Shop::new(&lattice, "noise_um = 0").refusal(), "");
    let ran = run(&["profile", "export", &field, "--format", "isg", "-O", &folder]);
    assert!(messages(&ran).contains("which are no functions of axes"), "{}", messages(&ran));
    // Another tool is refused by whoever is asked.
    shop.write("posted.nc", &PROGRAM.replace("G43 H2", "G43 H1"));
    shop.write("points.csv", "x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm\n-300,-200,-200,0,0,-120\n");
    let points = shop.path("points.csv");
    for arguments in [
        vec![posted.as_str()],
        vec!["check", &posted, &posted],
        vec!["predict", &points],
        vec!["solve", &points],
        vec!["map", "--tool-vector", "H1"],
    ] {
        let ran = run(&[&arguments[..], &["-m", &field]].concat());
        assert!(!ran.status.success(), "{arguments:?}");
        let told = format!("{}{}", messages(&ran), String::from_utf8_lossy(&ran.stdout));
        assert!(
            told.contains("0.000 0.000 -120.000 mm is not that of the measured vectors"),
            "{arguments:?}: {told}"
        );
    }
}

#[test]
fn the_map_of_a_field_says_stretch_shear_and_rotation() {
    // X is 20 µm/m too long and Y leans by 30 µrad: EC0Y > 0 opens the angle, so that it is sheared by minus that.
    let places = lattice([3, 3, 3]);
    let rows: Vec<[String; 3]> = places
        .iter()
        .map(|[x, y, _]| [format!("{:.6}", 20e-3 * x - 30e-3 * y), "0".to_owned(), "0".to_owned()])
        .collect();
    let shop = Shop::new(&vectors(&places, &rows), "noise_um = 0");
    let [field, csv, vtk, json, html] =
        ["field.toml", "map.csv", "map.vtk", "map.json", "map.html"].map(|name| shop.path(name));
    let ran = run(&[
        "map", "-m", &field, "--grid", "4x3x2", "--csv", &csv, "--vtk", &vtk, "--json", &json, "--html",
        &html,
    ]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let read = |path: &str| std::fs::read_to_string(path).expect("was written");
    let table = read(&csv);
    let mut lines = table.lines();
    assert!(lines.next().expect("a header").ends_with(
        "d_um,stretch_x_um_m,stretch_y_um_m,stretch_z_um_m,shear_xy_urad,shear_xz_urad,shear_yz_urad,rotation_a_urad,rotation_b_urad,rotation_c_urad"
    ));
    let cell: Vec<f64> =
        lines.next().expect("a row").split(',').skip(7).map(|v| v.parse().expect("a number")).collect();
    for (found, expected) in cell.iter().zip([20.0, 0.0, 0.0, -30.0, 0.0, 0.0, 0.0, 0.0, 15.0]) {
        assert!((found - expected).abs() < 1e-4, "{cell:?}");
    }
    assert!(table.lines().nth(4).expect("the last of X").ends_with(",,,,,,,,,"), "{table}");
    assert!(read(&vtk).contains("CELL_DATA 6\nVECTORS stretch_um_m double\n20.000000 0.000000 0.000000\n"));
    let found: serde_json::Value = serde_json::from_str(&read(&json)).expect("JSON");
    assert_eq!(found["deformation"]["cells"], 6);
    assert!(String::from_utf8_lossy(&ran.stdout).contains("shear X to Y, urad"), "{:?}", ran.stdout);
    assert!(read(&html).contains("Stretch, shear and rotation"));
}

#[test]
fn vectors_that_make_no_field_are_refused_by_name() {
    const HEADER: &str = "x_mm,y_mm,z_mm,dx_um,dy_um,dz_um\n";
    let small = |counts: [usize; 3]| {
        let places = lattice(counts);
        vectors(
            &places,
            &places.iter().map(|_| ["1".to_owned(), "2".to_owned(), "3".to_owned()]).collect::<Vec<_>>(),
        )
    };
    let cube = small([2, 2, 2]);
    // The cube with a further column: a value, and another in the last row.
    let with = |column: &str, value: &str, last: &str| {
        let rows = cube.lines().enumerate().map(|(k, line)| match k {
            0 => format!("{line},{column}\n"),
            8 => format!("{line},{last}\n"),
            _ => format!("{line},{value}\n"),
        });
        rows.collect::<String>()
    };
    let noisy = noisy();
    let two_runs = |offset: f64| {
        let mut text = format!("run,{HEADER}");
        for (k, line) in noisy.lines().skip(1).enumerate() {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            let dy: f64 = cells[4].parse().expect("a number");
            cells[4] = format!("{}", dy + if k % 2 == 1 { offset } else { 0.0 });
            let _ = writeln!(text, "{},{}", ["a", "b"][k % 2], cells.join(","));
        }
        text
    };
    let scaled = |by: f64| {
        let mut text = HEADER.to_owned();
        for line in noisy.lines().skip(1) {
            let cells: Vec<f64> = line.split(',').map(|v| v.parse().expect("a number")).collect();
            let _ = writeln!(
                text,
                "{},{},{},{},{},{}",
                cells[0],
                cells[1],
                cells[2],
                cells[3] * by,
                cells[4] * by,
                cells[5] * by
            );
        }
        text
    };
    let exact = "noise_um = 0";
    let noise = "noise_um = 1.0";
    for (what, vectors, field, expected) in [
        (
            "a place twice",
            cube.clone() + "0,0,0,9,2,3\n",
            exact,
            "two vectors of one place differ by 8.00 um in X",
        ),
        (
            "beyond the noise",
            noisy.clone()
                + &noisy
                    .lines()
                    .nth(1)
                    .map(|l| {
                        let cells: Vec<&str> = l.split(',').collect();
                        format!("{},{},{},99,{},{}\n", cells[0], cells[1], cells[2], cells[4], cells[5])
                    })
                    .expect("a row"),
            noise,
            "more than their uncertainty explains (7.07 um)",
        ),
        ("NaN", cube.replacen(",1,2,3", ",NaN,2,3", 1), exact, "`NaN` is not a number"),
        (
            "too few",
            cube.clone(),
            noise,
            "8 places with error vectors; a field with a stated noise needs at least 16",
        ),
        (
            "a plane",
            HEADER.to_owned()
                + &small([3, 3, 2]).lines().skip(1).take(9).map(|l| format!("{l}\n")).collect::<String>(),
            exact,
            "measured in one plane",
        ),
        (
            "a line",
            HEADER.to_owned()
                + &small([3, 2, 2]).lines().skip(1).take(3).map(|l| format!("{l}\n")).collect::<String>(),
            noise,
            "measured in one line",
        ),
        (
            "a hole",
            small([3, 3, 3])
                .lines()
                .enumerate()
                .filter(|(k, _)| *k != 5)
                .map(|(_, l)| format!("{l}\n"))
                .collect(),
            exact,
            "the lattice of 3 x 3 x 3 nodes lacks 1, the first at X -380 Y -210 Z -510",
        ),
        ("scattered and exact", noisy.clone(), exact, "the 240 places are no complete lattice"),
        (
            "magnitudes",
            "x_mm,y_mm,z_mm,d_um\n0,0,0,1\n".to_owned(),
            noise,
            "`d_um` is a magnitude and has no direction",
        ),
        (
            "bars",
            "x_mm,y_mm,z_mm,length_mm\n0,0,0,1\n".to_owned(),
            noise,
            "`length_mm` is a length and has no direction",
        ),
        ("two set-ups", two_runs(6.0), noise, "um beside the others: runs of different set-ups are no field"),
        ("millimetres", scaled(1e-3), noise, "and a noise of 1.000 um is stated"),
        ("nanometres", scaled(1e3), noise, "is larger than geometric errors get: wrong unit?"),
        ("two units", noisy.replace("dx_um", "dx_um (mm)"), noise, "says two units, um and mm"),
        ("no noise", noisy.clone(), "", "nothing says how certain this vector is"),
        ("no component", noisy.replace(",dz_um", ",z_um"), noise, "VP0306"),
        ("outside the travel", cube.clone() + "10,0,0,1,2,3\n", exact, "X at 10 mm lies outside its travel"),
        (
            "metres",
            scaled(1.0).lines().take(1).map(|l| format!("{l}\n")).collect::<String>()
                + "-0.1,-0.1,-0.1,1,1,1\n-0.2,-0.1,-0.3,1,1,1\n-0.3,-0.2,-0.1,1,1,1\n-0.5,-0.4,-0.2,1,1,1\n",
            noise,
            "are x_mm, y_mm, z_mm metres?",
        ),
        ("a turned axis", with("a_deg", "30", "30"), exact, "a vector with axis A turned"),
        ("two tools", with("tool_z_mm", "-150", "-151"), exact, "vectors of two tools are two fields"),
        ("no uncertainty", with("u_um", "0", "0"), exact, "an uncertainty of 0 um is not possible"),
        ("a negative noise", noisy.clone(), "noise_um = -1", "noise_um is -1"),
    ] {
        let refusal = Shop::new(&vectors, field).refusal();
        assert!(refusal.contains(expected), "{what}: {refusal}");
        assert!(refusal.contains("help: "), "{what}: {refusal}");
    }
    assert_eq!(Shop::new(&two_runs(0.0), noise).refusal(), "");
    assert_eq!(Shop::new(&cube, exact).refusal(), "");
    // Rotary axes, by name.
    let shop = Shop::new(&cube, exact);
    let profile = std::fs::read_to_string(shop.path("field.toml")).expect("reads");
    shop.write("field.toml", &profile.replace("[w X Y b Z t]", "[w C A Y X b Z t]"));
    let refusal = shop.refusal();
    assert!(refusal.contains("[field] on a machine with rotary axes, C, A"), "{refusal}");
    // A noise that the residuals contradict is said by every command that uses the field.
    let shop = Shop::new(&noisy, "noise_um = 1.4");
    shop.write("points.csv", "x_mm,y_mm,z_mm\n-300,-200,-200\n");
    let ran = run(&["predict", &shop.path("points.csv"), "-m", &shop.path("field.toml")]);
    assert!(ran.status.success());
    assert!(
        messages(&ran).contains("warning[VP0313]") && messages(&ran).contains("1.40 um are stated"),
        "{}",
        messages(&ran)
    );
}
