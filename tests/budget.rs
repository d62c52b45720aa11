//! `vpost budget` through the whole program: figures, points, syntheses, refusals.

use std::path::{Path, PathBuf};
use std::process::Output;

use crate::common::{messages, run, vpost};
use serde_json::Value;

const STAN: &str = "machine-profiles/stan_s500.toml";
const VMC: &str = "machine-profiles/generic_vmc.toml";

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("budget").join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

fn written(name: &str, text: &str) -> String {
    let file = folder("files").join(name);
    std::fs::write(&file, text).expect("writes");
    file.to_str().expect("UTF-8").to_owned()
}

struct Found {
    text: String,
    json: Value,
    messages: String,
}

fn budget(name: &str, arguments: &[&str]) -> Found {
    let json = folder(name).join("budget.json");
    let output = vpost().arg("budget").args(arguments).arg("--json").arg(&json).output().expect("starts");
    assert!(output.status.success(), "{}", messages(&output));
    let bytes = std::fs::read(&json).expect("was written");
    Found {
        text: String::from_utf8(output.stdout.clone()).expect("UTF-8"),
        json: serde_json::from_slice(&bytes).expect("JSON"),
        messages: messages(&output),
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn list(value: &Value) -> &Vec<Value> {
    value.as_array().unwrap_or_else(|| panic!("{value} is no list"))
}

fn deviation<'v>(json: &'v Value, name: &str) -> &'v Value {
    let all = list(&json["deviations"]);
    all.iter().find(|d| d["name"] == name).unwrap_or_else(|| panic!("no {name}"))
}

/// A profile with squareness between X and Y alone.
fn square(urad: f64) -> String {
    let axes = "[axis.X]\ntravel_mm = [-200, 200]\n[axis.Y]\ntravel_mm = [-200, 200]\n[axis.Z]\ntravel_mm = [0, 100]\n";
    format!(
        "format = 1\nname = \"square\"\nchain = \"[w X Y b Z t]\"\n{axes}[squareness]\nEC0Y_urad = {urad}\n"
    )
}

/// 100″ on a circle of 150 mm, as `vpost predict` and as the budget see it.
#[test]
fn squareness_alone_by_hand() {
    let profile = written("square.toml", &square(484.8137));
    let mut points = String::from("x_mm,y_mm,z_mm\n");
    for (x, y) in [(150.0, 0.0), (106.066, 106.066), (0.0, 150.0), (-106.066, 106.066)] {
        points += &format!("{x},{y},0\n");
    }
    let points = written("circle.csv", &points);
    let found = budget("square", &["-m", &profile, "--points", &points]);
    let only = deviation(&found.json, "EC0Y");
    assert_eq!(list(&found.json["deviations"]).len(), 1);
    assert_eq!(found.json["control_points"], 4);
    // 484.8137 µrad · 150 mm at the top of the circle, nothing at its right.
    assert_eq!(number(&found.json["measured"]["M_um"]), 72.7221);
    assert_eq!(number(&found.json["measured"]["A_um"]), 72.7221);
    assert_eq!(found.json["measured"]["at"]["linear_mm"], serde_json::json!([0.0, 150.0, 0.0]));
    assert_eq!(number(&only["dM_um"]["right"]), 72.7221);
    assert_eq!(number(&only["without"]["M_um"]), 0.0);
    assert_eq!(number(&found.json["signs_free"]["worst_case"]["um"]), 72.7221);
    // Radial error at 45° and 135°: ∓ 100″ · 75 mm.
    let output = run(&["predict", &points, "-m", &profile]);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let radial = |line: usize| {
        let row: Vec<f64> =
            text.lines().nth(line).expect("a row").split(',').map(|v| v.parse().expect("a number")).collect();
        (row[0] * row[6] + row[1] * row[7]) / 150.0
    };
    assert!(
        (radial(2) + 36.361).abs() < 1e-3 && (radial(4) - 36.361).abs() < 1e-3,
        "{} {}",
        radial(2),
        radial(4)
    );
}

#[test]
fn the_figures_of_the_stan_s500_belong_together() {
    let found = budget("stan", &["-m", STAN]);
    let json = &found.json;
    assert_eq!(json["schema"], "vpost.budget/1");
    // 3 axes with six tables each, three squareness errors.
    assert_eq!(list(&json["deviations"]).len(), 21);
    let m = number(&json["measured"]["M_um"]);
    // The same largest error as the map's.
    let mapped = folder("stan").join("map.json");
    let output = run(&["map", "-m", STAN, "--json", mapped.to_str().expect("UTF-8")]);
    assert!(output.status.success(), "{}", messages(&output));
    let map: Value = serde_json::from_slice(&std::fs::read(&mapped).expect("was written")).expect("JSON");
    assert_eq!(number(&map["parts"][0]["figures"]["max_um"]), m);
    assert_eq!(map["parts"][0]["figures"]["rms_um"], json["measured"]["rms_um"]);
    // Squareness between X and Y first, as every measurement of this machine says.
    assert_eq!(json["deviations"][0]["name"], "EC0Y");
    let brings: Vec<f64> = list(&json["deviations"]).iter().map(|d| number(&d["brings_um"])).collect();
    assert!(brings.is_sorted_by(|a, b| a >= b), "{brings:?}");
    for each in list(&json["deviations"]) {
        assert!((number(&each["without"]["M_um"]) + number(&each["brings_um"]) - m).abs() < 2e-4);
    }
    // Euler, with what products of errors leave; shares are of the whole.
    let second = number(&json["second_order"]["largest_um"]);
    assert!(second > 0.0 && second < 0.1, "{second}");
    let sum: f64 = list(&json["deviations"]).iter().map(|d| number(&d["dM_um"]["right"])).sum();
    assert!((sum - m).abs() < 2.0 * second + 21e-4, "{sum} {m}");
    let shares: f64 = list(&json["deviations"]).iter().map(|d| number(&d["share_of_rms"])).sum();
    assert!((shares - 1.0).abs() < 1e-3, "{shares}");
    // What is known less of is larger: as measured, signs free, sizes only; and no average is above a worst case.
    let figure = |of: &str, kind: &str| number(&json[of][kind]["um"]);
    let (free, sizes) = (figure("signs_free", "worst_case"), figure("sizes_only", "worst_case"));
    assert!(m <= free && free <= sizes, "{m} {free} {sizes}");
    for of in ["signs_free", "sizes_only"] {
        assert!(figure(of, "root_sum_of_squares") < figure(of, "worst_case"));
        for kind in ["worst_case", "root_sum_of_squares"] {
            let whole = number(&json[of][kind]["whole_model_um"]);
            assert!((whole - figure(of, kind)).abs() < 0.1, "{of} {kind}: {whole}");
        }
    }
    // The page has the figures of the file.
    for each in list(&json["deviations"]) {
        let name = each["name"].as_str().expect("a name");
        let line =
            found.text.lines().find(|line| line.split_whitespace().next() == Some(name)).expect("a line");
        let words: Vec<&str> = line.split_whitespace().collect();
        for (word, value) in [(1, &each["size"]), (3, &each["alone"]["M_um"]), (4, &each["without"]["M_um"])]
        {
            let printed: f64 = words[word].parse().expect("a number");
            assert!((printed - number(value)).abs() <= 0.005 + 1e-4, "{line} {value}");
        }
    }
    assert!(found.messages.is_empty(), "{}", found.messages);
}

/// Signs of the worst case put into a profile give it: the deviations are those of the profile.
#[test]
fn the_worst_signs_are_those_of_a_machine() {
    let found = budget("vmc", &["-m", VMC, "--grid", "5x5x5"]);
    // Lost motion: every node from all sides; X and Y have reversal values.
    assert_eq!(found.json["control_points"], 8 * 125);
    assert!(found.text.contains("from all 8 sides"), "{}", found.text);
    assert!(number(&deviation(&found.json, "B(X)")["alone"]["M_um"]) == 3.0, "half of 6 um to each side");
    // Points say where they are approached from, or it is said that they do not.
    let points = |name: &str, text: &str| {
        let file = written(name, text);
        budget("vmc_points", &["-m", VMC, "--points", &file])
    };
    let mean = points("mean.csv", "x_mm,y_mm,z_mm\n-100,-100,-100\n");
    assert!(mean.text.contains("the mean of both directions"), "{}", mean.text);
    assert_eq!(number(&deviation(&mean.json, "B(X)")["alone"]["M_um"]), 0.0);
    let said = points("said.csv", "x_mm,y_mm,z_mm,dir_x,dir_y,dir_z\n-100,-100,-100,1,-1,1\n");
    assert!(!said.text.contains("the mean of both directions"), "{}", said.text);
    assert_eq!(number(&deviation(&said.json, "B(X)")["alone"]["M_um"]), 3.0);
    let signs = &found.json["signs_free"]["worst_case"]["signs"];
    let sign = |name: &str| number(&signs[name]);
    let text = std::fs::read_to_string(crate::common::root().join(VMC)).expect("reads");
    let tables = crate::common::root().join("machine-profiles/generic_vmc");
    let folder = folder("signs");
    for axis in ["x", "y", "z"] {
        let table = std::fs::read_to_string(tables.join(format!("errors_{axis}.csv"))).expect("reads");
        let mut names: Vec<String> = Vec::new();
        let turned = table.lines().filter(|line| !line.starts_with('#')).map(|line| {
            if names.is_empty() {
                names = line.split(',').map(str::to_owned).collect();
                return line.to_owned();
            }
            let cell = |(name, cell): (&String, &str)| {
                let symbol = name.split('_').next().unwrap_or_default();
                let known = signs.get(symbol).is_some();
                let value: f64 = cell.trim().parse().expect("a number");
                format!("{}", if known { sign(symbol) * value } else { value })
            };
            names.iter().zip(line.split(',')).map(cell).collect::<Vec<_>>().join(",")
        });
        let turned: Vec<String> = turned.collect();
        std::fs::write(folder.join(format!("errors_{axis}.csv")), turned.join("\n")).expect("writes");
    }
    let mut profile = text.replace("generic_vmc/", "");
    for (key, name, value) in [
        ("EC0Y_urad = 24.0", "EC0Y", 24.0),
        ("EB0Z_urad = -31.0", "EB0Z", -31.0),
        ("EA0Z_urad = 18.0", "EA0Z", 18.0),
    ] {
        assert!(profile.contains(key));
        profile = profile.replace(key, &format!("{name}_urad = {}", sign(name) * value));
    }
    let file = folder.join("signs.toml");
    std::fs::write(&file, profile).expect("writes");
    let again = budget("signs_again", &["-m", file.to_str().expect("UTF-8"), "--grid", "5x5x5"]);
    let (expected, reached) =
        (number(&found.json["signs_free"]["worst_case"]["um"]), number(&again.json["measured"]["M_um"]));
    // Reversal values are approached from both sides anyway.
    assert!((expected - reached).abs() < 0.01, "{expected} {reached}");
}

#[test]
fn five_axes_by_points() {
    let axes = "[axis.X]\ntravel_mm = [-500, 500]\n[axis.Y]\ntravel_mm = [-500, 500]\n[axis.Z]\ntravel_mm = [-500, 500]\n";
    let rotary = "[rotary.A]\ncentre_mm = [0, 0, 0]\nEY0A_um = 20\ntravel_deg = [-120, 30]\n[rotary.C]\ncentre_mm = [0, 0, 0]\ntilt = \"body\"\nEX0C_um = 10\nEB0C_urad = 50\n";
    let profile = format!("format = 1\nname = \"five\"\nchain = \"[w C A X Y b Z t]\"\n{axes}{rotary}");
    let profile = written("five.toml", &profile);
    let mut points = String::from("x_mm,y_mm,z_mm,a_deg,c_deg\n");
    for a in [30, 0, -30, -60, -90] {
        for c in (0..360).step_by(30) {
            points += &format!("100,0,50,{a},{c}\n");
        }
    }
    let points = written("serkov_like.csv", &points);
    let found = budget("five", &["-m", &profile, "--points", &points, "--target", "15"]);
    assert_eq!(found.json["control_points"], 60);
    // A displaced axis displaces by as much at every angle.
    for (name, um) in [("EY0A", 20.0), ("EX0C", 10.0)] {
        let alone = &deviation(&found.json, name)["alone"];
        assert!((number(&alone["M_um"]) - um).abs() < 1e-3 && number(&alone["A_um"]) < 1e-3, "{alone}");
    }
    assert!(
        number(&deviation(&found.json, "EB0C")["alone"]["M_um"]) > 2.5,
        "50 µrad, an arm of 50 mm and more"
    );
    let steps = list(&found.json["target"]["mend"]["steps"]);
    assert_eq!(steps[0]["name"], "EY0A");
    assert!(found.text.contains(" A30.000"), "{}", found.text);
    // Where no rotary axis may stand.
    let beyond = written("beyond.csv", "x_mm,y_mm,z_mm,a_deg\n0,0,0,0\n0,0,0,45\n");
    let output = run(&["budget", "-m", &profile, "--points", &beyond]);
    assert_eq!(output.status.code(), Some(1));
    assert!(messages(&output).contains("error[VP0909]: point 2: axis A at 45"), "{}", messages(&output));
    let output = run(&["budget", "-m", &profile, "--rotary", "A=45"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(messages(&output).contains("axis A at 45"), "{}", messages(&output));
}

/// The 60 points and the chain of Serkov 2017: deviations act one to one, or by an arm that the points' file gives.
#[test]
fn deviations_act_one_to_one_or_by_an_arm() {
    let points = "samples/budget/ball_points.csv";
    let found = budget("arms", &["-m", "samples/budget/ms300_like.toml", "--points", points]);
    assert_eq!(found.json["control_points"], 60);
    let text = std::fs::read_to_string(crate::common::root().join(points)).expect("reads");
    let rows = text.lines().skip(1).map(|line| {
        let row: Vec<f64> = line.split(',').map(|v| v.parse().expect("a number")).collect();
        [row[0], row[1], row[2]]
    });
    let rows: Vec<[f64; 3]> = rows.collect();
    let most = |arm: fn(&[f64; 3]) -> f64| rows.iter().map(arm).fold(0.0, f64::max);
    let [x, y, z] = [most(|p| p[0].abs()), most(|p| p[1].abs()), most(|p| p[2].abs())];
    let about_z = most(|p| (p[0] * p[0] + p[1] * p[1]).sqrt());
    let about_x = most(|p| (p[1] * p[1] + p[2] * p[2]).sqrt());
    // The ball is 130 mm from where B and C meet.
    assert!(rows.iter().all(|p| (p.iter().map(|v| v * v).sum::<f64>().sqrt() - 130.0).abs() < 1e-5));
    for (name, um) in [
        ("EX0B", 12.0),
        ("EZ0B", 8.0),
        ("EX0C", 10.0),
        ("EY0C", 6.0),
        ("EC0B", 25e-3 * about_z),
        ("EA0B", 30e-3 * about_x),
        ("EC0Y", 20e-3 * y),
        ("EB0Z", 15e-3 * z),
        ("EA0Z", 10e-3 * z),
        ("scale.X", 30e-3 * x),
        ("scale.Y", 25e-3 * y),
        ("scale.Z", 35e-3 * z),
    ] {
        let alone = &deviation(&found.json, name)["alone"];
        // A tilt turns by an angle whose square, times the arm, is 1e-4 um.
        assert!((number(&alone["M_um"]) - um).abs() < 1e-3, "{name}: {alone}, {um}");
    }
}

/// `--ball` makes Serkov's 60 points; whichever axis leads, the figures of a machine without play are the same.
#[test]
fn a_ball_is_the_points_of_its_file() {
    let machine = ["-m", "samples/budget/ms300_like.toml"];
    let of = |name: &str, more: &[&str]| budget(name, &[&machine[..], more].concat()).json;
    let file = of("ball-file", &["--points", "samples/budget/ball_points.csv"]);
    for lead in ["R=120,H=50,lead=B", "R=120,H=50,lead=C"] {
        let ball = of("ball", &["--ball", lead]);
        assert_eq!(ball["control_points"], 60);
        for deviation in list(&file["deviations"]) {
            let name = deviation["name"].as_str().expect("a name");
            let there = self::deviation(&ball, name);
            for key in ["M_um", "rms_um"] {
                // The file has a nanometre's millionth of decimals.
                let [one, other] = [&deviation["alone"][key], &there["alone"][key]].map(number);
                assert!((one - other).abs() < 1e-4, "{lead}: {name} {key}: {one} and {other}");
            }
        }
    }
    for (ball, says) in
        [("R=120,H=500,lead=B", "outside the calibrated volume"), ("R=120,H=50,lead=A", "no rotary axis A")]
    {
        let output = run(&["budget", "-m", "samples/budget/ms300_like.toml", "--ball", ball]);
        assert_eq!(output.status.code(), Some(2));
        assert!(messages(&output).contains(says), "{}", messages(&output));
    }
    let output = run(&["budget", "-m", "samples/budget/ms300_like.toml", "--ball", "R=-1,H=50,lead=B"]);
    assert_eq!(output.status.code(), Some(2));
}

/// Play of a table acts at the arm of the ball, by half the reversal value on either side.
#[test]
fn play_of_a_rotary_axis_is_in_the_budget() {
    let text = std::fs::read_to_string(crate::common::root().join("samples/budget/ms300_like.toml"))
        .expect("readable");
    let place = tempfile::tempdir().expect("a temporary folder");
    let path = place.path().join("loose.toml");
    std::fs::write(&path, text.replace("EB0C_urad   = 20", "EB0C_urad   = 20\nbacklash_urad = 40"))
        .expect("writable");
    let path = path.to_str().expect("a plain path");
    let found = budget("loose", &["-m", path, "--ball", "R=120,H=50,lead=B"]);
    let alone = number(&deviation(&found.json, "B(C)")["alone"]["M_um"]);
    assert!((alone - 0.5 * 40e-3 * 120.0).abs() < 1e-3, "{alone}");
}

#[test]
fn what_it_takes_to_reach_a_target() {
    let found = budget("target", &["-m", STAN, "--target", "100"]);
    let target = &found.json["target"];
    assert_eq!(target["met_as_measured"], false);
    assert_eq!(target["mend"]["proven"], true);
    let steps = list(&target["mend"]["steps"]);
    let after: Vec<f64> = steps.iter().map(|step| number(&step["then_M_um"])).collect();
    assert!(
        after.len() > 1 && after[after.len() - 1] <= 100.0 && after[after.len() - 2] > 100.0,
        "{after:?}"
    );
    // The first step is the machine without that deviation.
    let first = deviation(&found.json, steps[0]["name"].as_str().expect("a name"));
    assert_eq!(number(&first["without"]["M_um"]), after[0]);
    // Tolerances of the worst case are smaller; both hold by the whole model.
    let [worst, statistical] = ["worst_case", "statistical"].map(|set| &target["tolerances"][set]);
    for set in [worst, statistical] {
        for figure in ["together_um", "whole_model_um"] {
            assert!((99.9..=100.0).contains(&number(&set[figure])), "{figure}: {set}");
        }
    }
    assert!(number(&statistical["worst_case_um"]) > 100.0);
    for (a, b) in list(&worst["each"]).iter().zip(list(&statistical["each"])) {
        assert_eq!(a["name"], b["name"]);
        let moved =
            number(&deviation(&found.json, a["name"].as_str().expect("a name"))["alone"]["M_um"]) > 0.0;
        assert_eq!(a["within"].is_number(), moved, "an angle without an arm may be anything: {a}");
        assert!(!moved || number(&a["within"]) < number(&b["within"]));
    }

    // What is kept stays, and the others get what is left.
    let kept = budget("kept", &["-m", STAN, "--target", "100", "--keep", "exx,EYX"]);
    let target = &kept.json["target"];
    assert_eq!(target["keep"], serde_json::json!(["EXX", "EYX"]));
    let steps = list(&target["mend"]["steps"]);
    assert!(steps.iter().all(|step| step["name"] != "EXX" && step["name"] != "EYX"), "{steps:?}");
    let less = &target["tolerances"]["worst_case"];
    assert!((99.9..=100.0).contains(&number(&less["whole_model_um"])), "{less}");
    assert!(number(&less["each_alone_um"]) < number(&worst["each_alone_um"]));
    assert_eq!(list(&less["each"]).len(), 19);
    let line = kept.text.lines().filter(|line| line.starts_with("  EXX ")).nth(1).expect("a line");
    assert_eq!(line.matches("as it is").count(), 2, "{line}");

    // 330 um of squareness alone: out of reach, whatever becomes of the others.
    let kept = budget("beyond", &["-m", STAN, "--target", "300", "--keep", "EC0Y"]);
    let target = &kept.json["target"];
    assert!(target["mend"]["steps"].is_null() && target["mend"]["proven"] == true, "{target}");
    assert!(target["tolerances"]["worst_case"].is_null());
    assert!(kept.messages.contains("warning[VP0918]: 300 um cannot be reached"), "{}", kept.messages);
    assert!(kept.text.contains("out of reach on this machine"), "{}", kept.text);
    assert!(kept.text.contains("worst case: none; what is kept leaves nothing"), "{}", kept.text);

    // Met, and said so; there are tolerances all the same.
    let met = budget("met", &["-m", STAN, "--target", "500"]);
    assert!(met.text.contains("met as measured: M is 473.57 um"), "{}", met.text);
    assert_eq!(met.json["target"]["met_as_measured"], true);
    assert!(met.messages.is_empty(), "{}", met.messages);
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let bytes = |threads: &str| {
        let json = folder(threads).join("budget.json");
        let output = vpost()
            .env("RAYON_NUM_THREADS", threads)
            .args(["budget", "-m", VMC, "--grid", "9x9x9", "--target", "20", "--json"])
            .arg(&json)
            .output()
            .expect("starts");
        assert!(output.status.success(), "{}", messages(&output));
        (output.stdout, std::fs::read(json).expect("was written"))
    };
    assert!(bytes("1") == bytes("7"));
}

#[test]
fn what_has_no_budget_is_refused_with_what_to_type() {
    let said = |status: i32, output: &Output, expected: &[&str]| {
        let text = messages(output);
        assert_eq!(output.status.code(), Some(status), "{text}");
        assert!(output.stdout.is_empty());
        for words in expected {
            assert!(text.contains(words), "{words}: {text}");
        }
    };
    let refused = |arguments: &[&str], expected: &[&str]| {
        said(2, &run(&[&["budget", "-m", STAN], arguments].concat()), expected);
    };
    refused(&["--target", "0"], &["VP0002", "--target 0", "--target 50"]);
    refused(&["--target", "-3"], &["VP0002", "--target -3"]);
    refused(&["--target", "nan"], &["VP0002", "--target NaN"]);
    refused(&["--keep", "EXX"], &["--target"]);
    for command in ["budget", "map"] {
        let turned = run(&[command, "-m", "samples/budget/ms300_like.toml", "--rotary", "B=200"]);
        said(2, &turned, &["VP0002", "axis B at 200.0000\u{b0} lies outside its range"]);
    }
    refused(&["--target", "50", "--keep", "EXQ"], &["VP0002", "no such deviation", "EXX, EYX"]);
    refused(&["--grid", "22x22"], &["VP0002", "--grid 22x22x21"]);
    refused(&["--grid", "100x100x100"], &["VP0002", "1000000 control points", "a coarser grid"]);
    refused(&["--grid", "0:500:100,0:100:50,0:100:50"], &["VP0909", "X from 0 to 500 mm", "--outside clamp"]);
    refused(&["--rotary", "C=90"], &["VP0002", "no such axis"]);
    refused(&["--tool-vector", "H7"], &["VP0002", "--tool H7=120"]);
    refused(&["--engine", "tracker"], &["VP0002", "engine `tracker`", "leave `--engine` out"]);
    refused(&["--engine", "newton"], &["VP0002", "there is no such engine"]);
    refused(&["--points", "p.csv", "--grid", "3x3x3"], &["--points", "--grid"]);
    said(2, &run(&["budget"]), &["VP0002", "-m PROFILE.toml"]);
    said(
        2,
        &run(&["budget", "-m", "machine-profiles/perfect.toml"]),
        &["VP0917", "no deviations", "[squareness]"],
    );
    let arm = written("square.toml", &square(100.0));
    let still = written("still.csv", "x_mm,y_mm,z_mm\n10,0,5\n");
    said(
        2,
        &run(&["budget", "-m", &arm, "--points", &still]),
        &["VP0917", "moves any of the control points"],
    );

    let points = |name: &str, text: &str, more: &[&str]| {
        let file = written(name, text);
        run(&[&["budget", "-m", STAN, "--points", &file], more].concat())
    };
    let outside = "x_mm,y_mm,z_mm\n10,20,30\n10,20,300\n";
    said(
        1,
        &points("outside.csv", outside, &[]),
        &["VP0909", "outside.csv", "point 2 at 10.000 20.000 300.000", "Z 0 to 200 mm", "--outside clamp"],
    );
    said(1, &points("bad.csv", "x_mm,y_mm\n1,2\n", &[]), &["VP0901", "`z_mm` is missing"]);
    said(1, &points("none.csv", "x_mm,y_mm,z_mm\n", &[]), &["VP0901", "no rows"]);
    said(
        1,
        &points("turned.csv", "x_mm,y_mm,z_mm,c_deg\n1,2,3,90\n", &[]),
        &["VP0901", "the machine has no axis C"],
    );
    // Outside with the nearest point's error: done, and said; -q says nothing.
    let output = points("outside.csv", outside, &["--outside", "clamp"]);
    assert!(output.status.success());
    assert!(messages(&output).contains("warning[VP0909]: 1 of 2 points"), "{}", messages(&output));
    assert!(messages(&points("outside.csv", outside, &["--outside", "clamp", "-q"])).is_empty());
}

#[test]
fn effects_are_deviations_and_need_their_conditions() {
    let profile = square(100.0)
        + "[[effect]]\nid = \"thermal.X\"\nexpansion_um_per_m_k = 11.5\n[[effect]]\nid = \"probe-lobing\"\npole_um = 3.0\n";
    let profile = profile.replace("name = ", "calibrated = { temperature_c = 20.0 }\nname = ");
    let file = written("warm.toml", &profile);
    let output = run(&["budget", "-m", &file]);
    assert_eq!(output.status.code(), Some(2));
    assert!(messages(&output).contains("VP0401"), "{}", messages(&output));
    let found = budget("warm", &["-m", &file, "--at", "temp_c=30"]);
    let names: Vec<&str> =
        list(&found.json["deviations"]).iter().filter_map(|d| d["name"].as_str()).collect();
    assert_eq!(names.len(), 2, "the probe is no part of the machine: {names:?}");
    let warm = deviation(&found.json, "thermal.X");
    assert_eq!(warm["unit"], "expansion_um_per_m_k");
    assert_eq!(number(&warm["size"]), 11.5);
    // 11.5 µm/m/K · 0.2 m · 10 K.
    assert!((number(&warm["alone"]["M_um"]) - 23.0).abs() < 1e-3, "{warm}");
}
