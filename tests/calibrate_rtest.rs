//! `vpost calibrate rtest`: from `predict`'s rows of a known machine back to that machine, and what is refused.

use std::fmt::Write;
use std::path::Path;

use crate::common::{messages, run};

/// Functions of an axis over its angle: waves of one to three a turn, no mean where the location has it.
fn table(axis: char, low: i32, high: i32, seed: f64) -> String {
    let mut text = format!(
        "position_deg,EX{axis}_um,EY{axis}_um,EZ{axis}_um,EA{axis}_urad,EB{axis}_urad,EC{axis}_urad\n"
    );
    for deg in low..=high {
        let angle = f64::from(deg).to_radians();
        let value = |f: usize| -> f64 {
            let part = |k: u32| {
                let phase = seed + f64::from(k) * 1.7 + f as f64 * 0.9;
                (if f < 3 { 2.5 } else { 9.0 }) / f64::from(k)
                    * units::math::sin(f64::from(k) * angle + phase)
            };
            (1..=3).map(part).sum()
        };
        let cells: Vec<String> = (0..6).map(|f| format!("{:.6}", value(f))).collect();
        let _ = writeln!(text, "{deg},{}", cells.join(","));
    }
    text
}

/// A table of B and C under three linear axes with errors of their own; `locations` are those of B and C.
fn profile(folder: &Path, name: &str, locations: Option<[&str; 2]>) -> String {
    let tables = folder.join(format!("{name}_tables"));
    std::fs::create_dir_all(&tables).expect("a new folder");
    let write = |file: &str, text: &str| std::fs::write(tables.join(file), text).expect("written");
    write("x.csv", "position_mm,EXX_um,EYX_um,ECX_urad\n-600,-4,2,5\n0,1,-1,0\n600,6,3,-8\n");
    let mut text = "format = 1\nname = \"table\"\nchain = \"[w C B b X Y Z t]\"\n".to_owned();
    for axis in ['X', 'Y', 'Z'] {
        let _ = writeln!(text, "[axis.{axis}]\ntravel_mm = [-600, 600]");
        if axis == 'X' {
            let _ = writeln!(text, "errors = \"{name}_tables/x.csv\"");
        }
    }
    text += "[squareness]\nEC0Y_urad = 20\n";
    for (k, (axis, centre, low, high)) in
        [('B', "[5, 0, -40]", -100, 40), ('C', "[0, 0, 0]", -360, 360)].into_iter().enumerate()
    {
        let _ = writeln!(
            text,
            "[rotary.{axis}]\ncentre_mm = {centre}\ntilt = \"body\"\ntravel_deg = [{low}, {high}]"
        );
        if let Some(own) = locations {
            let file = format!("{}.csv", axis.to_ascii_lowercase());
            write(&file, &table(axis, low, high, k as f64));
            let _ = writeln!(text, "{}\nerrors = \"{name}_tables/{file}\"", own[k]);
        }
    }
    let path = folder.join(format!("{name}.toml"));
    std::fs::write(&path, text).expect("written");
    path.to_str().expect("a plain name").to_owned()
}

const LOCATIONS: [&str; 2] = [
    "EX0B_um = 12\nEZ0B_um = -21\nEA0B_urad = 61\nEC0B_urad = -45",
    "EX0C_um = -14\nEY0C_um = 9\nEA0C_urad = 38\nEB0C_urad = 70",
];

/// Name of a run, place of its ball, tool vector, B and C in degrees.
type Place = (&'static str, [f64; 3], [f64; 3], f64, f64);

const BALLS: [(&str, [f64; 3], [f64; 3]); 4] = [
    ("one", [120.0, 0.0, 50.0], [0.0, 0.0, -100.0]),
    ("two", [-60.0, 100.0, 80.0], [0.0, 0.0, -120.0]),
    ("three", [-50.0, -90.0, 20.0], [10.0, 0.0, -140.0]),
    ("four", [30.0, 40.0, 150.0], [0.0, 20.0, -160.0]),
];

/// Every ball at B from -90 to 30 by 10, and C by 20.
fn everywhere() -> Vec<Place> {
    let mut all = Vec::new();
    for (run, ball, tool) in BALLS {
        for b in 0..13 {
            for c in 0..18 {
                all.push((run, ball, tool, -90.0 + 10.0 * f64::from(b), 20.0 * f64::from(c)));
            }
        }
    }
    all
}

/// One ball, B at 0, C by 20.
fn around(ball: [f64; 3]) -> Vec<Place> {
    (0..18).map(|c| ("one", ball, [0.0, 0.0, -100.0], 0.0, 20.0 * f64::from(c))).collect()
}

/// Points at which the nest follows the ball of a nominal table.
fn points(places: &[Place]) -> String {
    let mut text = "x_mm,y_mm,z_mm,b_deg,c_deg,tool_x_mm,tool_y_mm,tool_z_mm\n".to_owned();
    for (_, [x, y, z], [i, j, k], b, c) in places {
        let ((sb, cb), (sc, cc)) = (units::math::sin_cos_deg(*b), units::math::sin_cos_deg(*c));
        let (x, y) = (x * cc - y * sc, x * sc + y * cc);
        // Centre of B, then the tool.
        let (x, z) = (x - 5.0, z + 40.0);
        let (x, z) = (x * cb + z * sb + 5.0, z * cb - x * sb - 40.0);
        let _ = writeln!(text, "{:.4},{:.4},{:.4},{b},{c},{i},{j},{k}", x - i, y - j, z - k);
    }
    text
}

/// What `predict` makes of the places, cells by name.
fn predicted(folder: &Path, places: &[Place], machine: &str) -> Vec<Vec<(String, String)>> {
    let path = folder.join("points.csv");
    std::fs::write(&path, points(places)).expect("written");
    let output = run(&["predict", path.to_str().expect("a plain name"), "-m", machine]);
    assert!(output.status.success(), "{}", messages(&output));
    let text = String::from_utf8(output.stdout).expect("ASCII");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let row = |line: &str| -> Vec<(String, String)> {
        header.iter().zip(line.split(',')).map(|(name, cell)| ((*name).to_owned(), cell.to_owned())).collect()
    };
    lines.map(row).collect()
}

fn cell<'r>(row: &'r [(String, String)], name: &str) -> &'r str {
    &row.iter().find(|(own, _)| own == name).expect("a column").1
}

const COLUMNS: [&str; 8] = ["x_mm", "y_mm", "z_mm", "b_deg", "c_deg", "tool_x_mm", "tool_y_mm", "tool_z_mm"];

/// Rows of an R-test: the deviations of `predict` with an offset of each run.
fn rows(folder: &Path, name: &str, places: &[Place], machine: &str) -> String {
    let mut text = format!("run,{},dx_um,dy_um,dz_um\n", COLUMNS.join(","));
    for ((run, ..), row) in places.iter().zip(predicted(folder, places, machine)) {
        let commands: Vec<&str> = COLUMNS.iter().map(|column| cell(&row, column)).collect();
        let offset = run.len() as f64 * 7.5 - 20.0;
        let _ = write!(text, "{run},{}", commands.join(","));
        for (k, column) in ["dx_um", "dy_um", "dz_um"].into_iter().enumerate() {
            let value: f64 = cell(&row, column).parse().expect("a number");
            let _ = write!(text, ",{:.6}", value + offset * (1.0 + k as f64));
        }
        text.push('\n');
    }
    file(folder, name, &text)
}

fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path.to_str().expect("a plain name").to_owned()
}

/// Largest difference of two machines at places, µm, each run about its own mean: the workpiece is where it was mounted.
fn apart_um(folder: &Path, places: &[Place], one: &str, other: &str) -> f64 {
    let (one, other) = (predicted(folder, places, one), predicted(folder, places, other));
    let mut largest: f64 = 0.0;
    for column in ["dx_um", "dy_um", "dz_um"] {
        let value = |row: &[(String, String)]| -> f64 { cell(row, column).parse().expect("a number") };
        for run in BALLS.map(|(run, ..)| run) {
            let own: Vec<f64> = (places.iter().zip(one.iter().zip(&other)))
                .filter(|((name, ..), _)| *name == run)
                .map(|(_, (a, b))| value(a) - value(b))
                .collect();
            let mean = own.iter().sum::<f64>() / own.len().max(1) as f64;
            largest = own.iter().map(|v| (v - mean).abs()).fold(largest, f64::max);
        }
    }
    largest
}

/// Other balls, other angles.
fn unseen() -> Vec<Place> {
    let place = |k: i32| {
        let ball = if k % 2 == 0 { [80.0, -70.0, 110.0] } else { [-110.0, 30.0, 5.0] };
        let run = if k % 2 == 0 { "one" } else { "two" };
        (run, ball, [5.0, 5.0, -130.0], -88.0 + 2.9 * f64::from(k), f64::from(k * 53 % 360) - 180.0)
    };
    (0..40).map(place).collect()
}

#[test]
fn the_known_machine_comes_back_from_its_own_rows_and_predicts_others() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let (real, base) = (profile(at, "real", Some(LOCATIONS)), profile(at, "base", None));
    let measured = rows(at, "rows.csv", &everywhere(), &real);
    let held = rows(at, "held.csv", &unseen(), &real);
    let made = at.join("made.toml").to_str().expect("a plain name").to_owned();
    let json = at.join("made.json").to_str().expect("a plain name").to_owned();
    let found = run(&[
        "calibrate",
        "rtest",
        &measured,
        "-m",
        &base,
        "-o",
        &made,
        "--holdout",
        &held,
        "--json",
        &json,
    ]);
    assert!(found.status.success(), "{}", messages(&found));
    assert!(!messages(&found).contains("VP1109"), "{}", messages(&found));
    assert!(apart_um(at, &unseen(), &real, &base) > 20.0);
    let left_um = apart_um(at, &unseen(), &real, &made);
    assert!(left_um < 0.1, "{left_um}");
    // From the made profile the same rows change nothing any more.
    let again = at.join("again.toml").to_str().expect("a plain name").to_owned();
    let twice = run(&["calibrate", "rtest", &measured, "-m", &made, "-o", &again]);
    assert!(twice.status.success(), "{}", messages(&twice));
    assert!(apart_um(at, &unseen(), &made, &again) < 0.02);
    let text = std::fs::read_to_string(&json).expect("written");
    let json: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!((&json["schema"], &json["not_told_apart"]), (&"vpost.rtest/1".into(), &serde_json::json!([])));
    let terms = json["terms"].as_array().expect("terms");
    assert_eq!(json["covariance"].as_array().map(Vec::len), Some(terms.len()));
    assert!(json["holdout"]["max_after_um"].as_f64().is_some_and(|um| um < 0.1), "{}", json["holdout"]);
    assert!(
        terms.iter().any(|t| t["name"] == "EB0C" && t["written"] == true && t["u95"].as_f64() < Some(0.1))
    );
    // Same input, same bytes.
    let before = std::fs::read(&made).expect("written");
    let repeated = run(&["calibrate", "rtest", &measured, "-m", &base, "-o", &made, "--holdout", &held]);
    assert_eq!(
        (repeated.stdout == found.stdout, std::fs::read(&made).expect("written") == before),
        (true, true)
    );
}

#[test]
fn an_axis_that_counts_the_other_way_is_found() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let (real, base) = (profile(at, "real", Some(LOCATIONS)), profile(at, "base", None));
    let measured = rows(at, "rows.csv", &everywhere(), &real);
    let text = std::fs::read_to_string(&base).expect("written");
    for letter in ['B', 'C'] {
        let section = format!("[rotary.{letter}]\n");
        let direction = if letter == 'B' { "[0, -1, 0]" } else { "[0, 0, -1]" };
        assert!(text.contains(&section), "{text}");
        let turned = text.replace(&section, &format!("{section}direction = {direction}\n"));
        let turned = file(at, "turned.toml", &turned);
        let found = run(&["calibrate", "rtest", &measured, "-m", &turned]);
        let said = messages(&found);
        assert!(!found.status.success() && said.contains("VP1101"), "{said}");
        let right = direction.replace("-1", "1");
        assert!(said.contains(&format!("[rotary.{letter}] direction = {right}")), "{said}");
        assert!(said.contains(&format!("plus {letter}: ")), "{said}");
    }
}

#[test]
fn a_probe_centred_on_a_sphere_says_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let (real, base) = (profile(at, "real", Some(LOCATIONS)), profile(at, "base", None));
    // Where the axes stand when the tip is at the sphere: the command that the real machine needs.
    let places = everywhere();
    let path = file(at, "points.csv", &points(&places));
    let solved = run(&["solve", &path, "-m", &real]);
    assert!(solved.status.success(), "{}", messages(&solved));
    let text = String::from_utf8(solved.stdout).expect("ASCII");
    let header: Vec<&str> = text.lines().next().expect("a header").split(',').collect();
    let column = |name: &str| header.iter().position(|own| *own == name).expect("a column");
    let mut sphere = format!("run,{}\n", COLUMNS.join(","));
    for ((run, ..), line) in places.iter().zip(text.lines().skip(1)) {
        let cells: Vec<&str> = line.split(',').collect();
        let at = |name: &str| cells[column(name)];
        let commands = COLUMNS.map(|name| match name {
            "x_mm" => at("qx_mm"),
            "y_mm" => at("qy_mm"),
            "z_mm" => at("qz_mm"),
            other => at(other),
        });
        let _ = writeln!(sphere, "{run},{}", commands.join(","));
    }
    let measured = file(at, "sphere.csv", &sphere);
    let made = at.join("made.toml").to_str().expect("a plain name").to_owned();
    let found = run(&["calibrate", "rtest", &measured, "--sphere", "-m", &base, "-o", &made]);
    assert!(found.status.success(), "{}", messages(&found));
    let left_um = apart_um(at, &unseen(), &real, &made);
    assert!(left_um < 0.1, "{left_um}");
    // One angle taken for another: no sphere is there.
    let wrong = file(at, "wrong.csv", &sphere.replacen(",-90,40,", ",-90,140,", 1));
    let refused = run(&["calibrate", "rtest", &wrong, "--sphere", "-m", &base]);
    assert!(messages(&refused).contains("mm from where run `one` has the sphere"), "{}", messages(&refused));
}

#[test]
fn each_bad_input_has_its_own_message() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let (real, base) = (profile(at, "real", Some(LOCATIONS)), profile(at, "base", None));
    let made = at.join("made.toml").to_str().expect("a plain name").to_owned();
    let good = rows(at, "rows.csv", &everywhere(), &real);
    let text = std::fs::read_to_string(&good).expect("written");
    let refused = |name: &str, text: &str, machine: &str, more: &[&str]| -> String {
        let path = file(at, name, text);
        let mut arguments = vec!["calibrate", "rtest", &path, "-m", machine, "-o", &made];
        arguments.extend(more);
        let output = run(&arguments);
        let said = messages(&output);
        assert!(!output.status.success() && !Path::new(&made).exists(), "{name}: {said}");
        said
    };
    let changed = |line: usize, column: usize, cell: &str| -> String {
        let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
        let mut cells: Vec<&str> = lines[line].split(',').collect();
        cells[column] = cell;
        lines[line] = cells.join(",");
        lines.join("\n")
    };
    let says =
        |said: &str, code: &str, words: &str| assert!(said.contains(code) && said.contains(words), "{said}");
    says(&refused("nan.csv", &changed(3, 9, "NaN"), &base, &[]), "VP0912", "`NaN` is not a number");
    says(&refused("empty.csv", &changed(3, 0, ""), &base, &[]), "VP0912", "says no run");
    says(&refused("mm.csv", &changed(3, 9, "9000"), &base, &[]), "VP1102", "none that an R-test reads");
    let said = refused("blunder.csv", &changed(100, 10, "151.5"), &base, &[]);
    says(&said, "VP1107", "this row's Y");
    assert!(said.contains("blunder.csv:101"), "{said}");
    says(
        &refused("outside.csv", &changed(5, 1, "700"), &base, &[]),
        "VP1101",
        "lies outside what the profile knows",
    );
    says(&refused("angle.csv", &changed(5, 4, "50"), &base, &[]), "VP1101", "axis B at 50");
    says(
        &refused("norun.csv", &text.replacen("run,", "note,", 1), &base, &[]),
        "VP0911",
        "column `run` is missing",
    );
    says(
        &refused("nod.csv", &text.replace(",dx_um,dy_um,dz_um", ",u_x_um,u_y_um,u_z_um"), &base, &[]),
        "VP1106",
        "--sphere",
    );
    says(&refused("sphere.csv", &text, &base, &["--sphere"]), "VP1101", "with `--sphere`");
    says(
        &refused("some.csv", &text.replacen("dz_um", "note", 1).replacen("dx_um", "u_um", 1), &base, &[]),
        "VP0912",
        "above zero",
    );
    // Chains: none of the axes, another one.
    let plain = file(
        at,
        "plain.toml",
        "format = 1\nname = \"m\"\nchain = \"[w b X Y Z t]\"\n[axis.X]\ntravel_mm = [-600, 600]\n[axis.Y]\ntravel_mm = [-600, 600]\n[axis.Z]\ntravel_mm = [-600, 600]\n",
    );
    says(&refused("plain.csv", &text, &plain, &[]), "VP1101", "has no rotary axis");
    let other = std::fs::read_to_string(&base)
        .expect("written")
        .replace("[w C B b", "[w C A b")
        .replace("rotary.B", "rotary.A");
    let other = file(at, "other.toml", &other);
    says(&refused("other.csv", &text, &other, &[]), "VP1101", "the machine has no axis B");
    // What shows nothing.
    let still = rows(at, "still.csv", &vec![around([120.0, 0.0, 50.0])[3]; 6], &real);
    let still = std::fs::read_to_string(still).expect("written");
    says(&refused("still.csv", &still, &base, &[]), "VP1101", "stands at one angle of");
    let on_axis = rows(at, "axis.csv", &around([0.0, 0.0, 50.0]), &real);
    let on_axis = std::fs::read_to_string(on_axis).expect("written");
    says(&refused("axis.csv", &on_axis, &base, &[]), "VP1105", "the ball lies on the axis in every run");
    // C the other way round, in half of the rows: the ball would not be in its nest.
    let turned: Vec<String> = text
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if let Ok(deg) = cells[5].parse::<f64>() {
                cells[5] = if k % 2 == 0 { deg } else { -deg }.to_string();
            }
            cells.join(",")
        })
        .collect();
    let turned = file(at, "turned.csv", &turned.join("\n"));
    let output = run(&["calibrate", "rtest", &turned, "-m", &base]);
    says(&messages(&output), "VP1109", "a ball stays in its nest");
    // Two machines.
    let swapped = profile(
        at,
        "second",
        Some([LOCATIONS[0], "EX0C_um = 30\nEY0C_um = -40\nEA0C_urad = -80\nEB0C_urad = 10"]),
    );
    let second = rows(at, "second.csv", &everywhere(), &swapped);
    let output = run(&["calibrate", "rtest", &good, &second, "-m", &base, "-o", &made]);
    says(&messages(&output), "VP1113", "the runs contradict one another");
    // Unseen rows of the second machine refute the first; nothing is written.
    let held = rows(at, "held.csv", &unseen(), &real);
    let wrong = std::fs::read_to_string(&held).expect("written");
    let wrong: Vec<String> = wrong
        .lines()
        .enumerate()
        .map(|(k, line)| {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            if k > 0 {
                for cell in &mut cells[9..] {
                    *cell = (-cell.parse::<f64>().expect("a number")).to_string();
                }
            }
            cells.join(",")
        })
        .collect();
    let wrong = file(at, "wrong.csv", &wrong.join("\n"));
    says(&refused("good.csv", &text, &base, &["--holdout", &wrong]), "VP1103", "held-out readings get worse");
    // A base that knows from which side its table came, which the rows do not say.
    let loose = profile(at, "loose", Some(LOCATIONS));
    let own = "errors = \"loose_tables/c.csv\"";
    let both = std::fs::read_to_string(&loose)
        .expect("written")
        .replace(own, &format!("{own}\nerrors_negative = \"loose_tables/c.csv\""));
    std::fs::write(&loose, both).expect("written");
    says(&refused("good.csv", &text, &loose, &[]), "VP1101", "`errors_negative`");
    // No profile.
    let output = run(&["calibrate", "rtest", &good, "-o", &made]);
    says(&messages(&output), "VP1106", "which machine?");
}

#[test]
fn what_one_ball_cannot_tell_is_named_and_stays_as_the_profile_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let (real, base) = (profile(at, "real", Some(LOCATIONS)), profile(at, "base", None));
    let measured = rows(at, "one.csv", &around([120.0, 0.0, 50.0]), &real);
    let made = at.join("made.toml").to_str().expect("a plain name").to_owned();
    let found = run(&["calibrate", "rtest", &measured, "-m", &base, "-o", &made]);
    assert!(found.status.success(), "{}", messages(&found));
    let said = String::from_utf8(found.stdout).expect("UTF-8");
    assert!(said.contains("axis B: turns in no run, and stays as in the profile"), "{said}");
    assert!(
        said.contains("not told apart by these rows, not written: EAC, EBC, ECC, EXC, EYC, EZC"),
        "{said}"
    );
    assert!(said.contains("counted as"), "{said}");
    let written = std::fs::read_to_string(&made).expect("written");
    assert!(written.contains("EB0C_urad") && !written.contains("errors = \"made/c.csv\""), "{written}");
    let section =
        |text: &str| text.split("[rotary.B]").nth(1).and_then(|t| t.split('[').nth(1)).map(str::to_owned);
    let before = std::fs::read_to_string(&base).expect("written");
    assert_eq!(section(&written), section(&before));
}
