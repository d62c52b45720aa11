//! `vpost map` through the whole program: figures, zero points, exports, refusals.

use std::path::{Path, PathBuf};

use crate::common::{messages, run, vpost};
use serde_json::Value;

const STAN: &str = "machine-profiles/stan_s500.toml";
const KONDIA: &str = "samples/map/kondia_like.toml";
/// Teleshevsky 2013.
const PUBLISHED_GRID: &str = "40:880:40,30:450:20,5:505:25";

struct Mapped {
    text: String,
    json: Value,
    csv: String,
    vtk: String,
}

fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).expect("a folder");
    folder
}

/// Runs the command with all exports.
fn map(name: &str, arguments: &[&str]) -> Mapped {
    let folder = folder(name);
    let mut command = vpost();
    command.arg("map").args(arguments);
    for kind in ["json", "csv", "vtk"] {
        command.arg(format!("--{kind}")).arg(folder.join(kind));
    }
    let output = command.output().expect("starts");
    assert!(output.status.success(), "{}", messages(&output));
    let read = |kind: &str| std::fs::read_to_string(folder.join(kind)).expect("was written");
    Mapped {
        text: String::from_utf8(output.stdout).expect("UTF-8"),
        json: serde_json::from_str(&read("json")).expect("JSON"),
        csv: read("csv"),
        vtk: read("vtk"),
    }
}

/// Rows of the CSV: place and error, mm and µm.
fn rows(csv: &str) -> Vec<[f64; 7]> {
    let mut lines = csv.lines();
    assert_eq!(lines.next(), Some("x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,d_um"));
    let row = |line: &str| {
        let numbers: Vec<f64> = line.split(',').map(|v| v.parse().expect("a number")).collect();
        numbers.try_into().expect("seven columns")
    };
    lines.map(row).collect()
}

fn error(row: &[f64; 7]) -> [f64; 3] {
    [row[3], row[4], row[5]]
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn vector(value: &Value) -> [f64; 3] {
    [0, 1, 2].map(|i| number(&value[i]))
}

fn zero_point<'v>(part: &'v Value, kind: &str) -> &'v Value {
    let all = part["zero_points"].as_array().expect("a list");
    all.iter().find(|z| z["kind"] == kind).unwrap_or_else(|| panic!("no {kind}"))
}

/// 22×22×21 nodes, all pairs computed here: the published search, and its figures.
#[test]
fn the_published_grid_and_search() {
    let found = map("published", &["-m", KONDIA, "--grid", PUBLISHED_GRID]);
    let rows = rows(&found.csv);
    assert_eq!(rows.len(), 10_164);
    let errors: Vec<[f64; 3]> = rows.iter().map(error).collect();
    let sum = |k: usize| errors.iter().map(|d| distance(d, &errors[k])).sum::<f64>();
    let (best, least) =
        (0..errors.len()).map(|k| (k, sum(k))).min_by(|a, b| a.1.total_cmp(&b.1)).expect("there are nodes");
    let volume = &found.json["parts"][0];
    let node = zero_point(volume, "best node");
    assert_eq!(vector(&node["proof"]["node_mm"]), [rows[best][0], rows[best][1], rows[best][2]]);
    assert!((number(&node["proof"]["sum_um"]) / least - 1.0).abs() < 1e-6);
    assert!(number(&node["proof"]["sums_computed"]) < 500.0);

    // The figures, computed again from the CSV.
    let share = |shift: &[f64; 3]| {
        errors.iter().filter(|d| distance(d, shift) <= 20.0).count() as f64 / errors.len() as f64
    };
    let figures = &volume["figures"];
    assert!((number(&figures["share_within"]) - share(&[0.0; 3])).abs() < 1e-9);
    assert!((number(&node["figures"]["share_within"]) - share(&errors[best])).abs() < 1e-9);
    // The publication: from 7.6 % to more than 30 %.
    assert!((0.07..0.09).contains(&share(&[0.0; 3])), "{}", share(&[0.0; 3]));
    assert!(share(&errors[best]) > 0.29, "{}", share(&errors[best]));
    let mut lengths: Vec<f64> = rows.iter().map(|row| row[6]).collect();
    lengths.sort_by(f64::total_cmp);
    let rank = (lengths.len() * 95).div_ceil(100) - 1;
    assert!((number(&figures["p95_um"]) - lengths[rank]).abs() < 1e-3);
    assert!((number(&figures["max_um"]) - lengths[lengths.len() - 1]).abs() < 1e-3);
    let rms = (lengths.iter().map(|d| d * d).sum::<f64>() / lengths.len() as f64).sqrt();
    assert!((number(&figures["rms_um"]) - rms).abs() < 1e-3);
    for axis in 0..3 {
        let of = |fold: fn(f64, f64) -> f64, from: f64| errors.iter().map(|d| d[axis]).fold(from, fold);
        let range = of(f64::max, f64::MIN) - of(f64::min, f64::MAX);
        assert!((number(&figures["range_um"][axis]) - range).abs() < 1e-3);
    }

    // Each answer is the best in its own measure.
    let mean = |shift: &[f64; 3]| errors.iter().map(|d| distance(d, shift)).sum::<f64>();
    let most = |shift: &[f64; 3]| errors.iter().map(|d| distance(d, shift)).fold(0.0, f64::max);
    let shifts = ["best node", "geometric median", "minimax", "best share"]
        .map(|kind| vector(&zero_point(volume, kind)["shift_um"]));
    for other in &shifts {
        assert!(mean(&shifts[1]) <= mean(other) * (1.0 + 1e-9));
        assert!(most(&shifts[2]) <= most(other) + 1e-3);
        assert!(share(&shifts[3]) >= share(other) - 1e-3);
    }
    assert!(found.text.contains("geometric median"), "{}", found.text);
}

/// The sign of what is to be entered: with the new offset the machine does go closer to where it should.
#[test]
fn the_offset_to_enter_does_what_is_said() {
    let found = map("enter", &["-m", STAN, "--grid", "9x8x7"]);
    let median = zero_point(&found.json["parts"][0], "geometric median");
    let add = vector(&median["add_to_work_offset_mm"]);
    let g54 = vector(&median["work_offsets_mm"]["G54"]);
    let rows = rows(&found.csv);
    // G54 was touched there: the machine's error is in it already, and half a step is rounded off.
    let mut points = String::from("x_mm,y_mm,z_mm\n140,100,20\n");
    for row in &rows {
        points += &format!("{},{},{}\n", row[0] + add[0], row[1] + add[1], row[2] + add[2]);
    }
    let file = folder("enter").join("moved.csv");
    std::fs::write(&file, points).expect("writes");
    let output = run(&["predict", file.to_str().expect("UTF-8"), "-m", STAN, "-q"]);
    assert!(output.status.success(), "{}", messages(&output));
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    let mut found_there = text
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|v| v.parse().expect("a number")).collect::<Vec<f64>>());
    let zero = found_there.next().expect("the zero first");
    assert!(distance(&g54, &[zero[3] + add[0], zero[4] + add[1], zero[5] + add[2]]) < 1.5e-3);
    let squares: f64 = found_there
        .zip(&rows)
        .map(|(numbers, row)| {
            distance(&[numbers[3], numbers[4], numbers[5]], &[row[0], row[1], row[2]]).powi(2)
        })
        .sum();
    let rms_um = (squares / rows.len() as f64).sqrt() * 1e3;
    // The error changes by a thousandth of the shift, and the offset is rounded to a micrometre.
    assert!((rms_um - number(&median["figures"]["rms_um"])).abs() < 1.0, "{rms_um}");
    assert!(rms_um < 0.5 * number(&found.json["parts"][0]["figures"]["rms_um"]));
}

/// What a VTK file holds.
struct Vtk {
    size: Vec<usize>,
    places: Vec<Vec<f64>>,
    arrays: Vec<(String, Vec<f64>)>,
}

/// A reader of legacy VTK that takes nothing but what the format says.
fn read_vtk(text: &str) -> Vtk {
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("# vtk DataFile Version 3.0"));
    assert!(lines.next().expect("a title").len() < 256);
    assert_eq!(lines.next(), Some("ASCII"));
    assert_eq!(lines.next(), Some("DATASET RECTILINEAR_GRID"));
    let mut words = lines.flat_map(str::split_ascii_whitespace).peekable();
    let expect = |words: &mut dyn Iterator<Item = &str>, wanted: &str| {
        assert_eq!(words.next(), Some(wanted));
    };
    expect(&mut words, "DIMENSIONS");
    let numbers = |words: &mut dyn Iterator<Item = &str>, count: usize| -> Vec<f64> {
        (0..count).map(|_| words.next().expect("a number").parse().expect("a number")).collect()
    };
    let size: Vec<usize> = numbers(&mut words, 3).into_iter().map(|n| n as usize).collect();
    let mut places = Vec::new();
    for (axis, count) in ["X", "Y", "Z"].iter().zip(&size) {
        expect(&mut words, &format!("{axis}_COORDINATES"));
        expect(&mut words, &count.to_string());
        expect(&mut words, "double");
        places.push(numbers(&mut words, *count));
    }
    let nodes: usize = size.iter().product();
    expect(&mut words, "POINT_DATA");
    expect(&mut words, &nodes.to_string());
    let mut arrays = Vec::new();
    while let Some(kind) = words.next() {
        let name = words.next().expect("a name").to_owned();
        expect(&mut words, "double");
        let components = match kind {
            "VECTORS" => 3,
            "SCALARS" => {
                expect(&mut words, "1");
                expect(&mut words, "LOOKUP_TABLE");
                expect(&mut words, "default");
                1
            }
            other => panic!("{other} is no array"),
        };
        arrays.push((name, numbers(&mut words, nodes * components)));
    }
    Vtk { size, places, arrays }
}

#[test]
fn the_vtk_file_is_read_back_as_the_map() {
    let found = map("vtk", &["-m", STAN, "--grid", "5x4x3"]);
    let rows = rows(&found.csv);
    let Vtk { size, places, arrays } = read_vtk(&found.vtk);
    assert_eq!(size, [5, 4, 3]);
    let names: Vec<&str> = arrays.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(names, ["error_um", "error_length_um", "error_after_shift_um", "error_after_shift_length_um"]);
    let shift = vector(&zero_point(&found.json["parts"][0], "geometric median")["shift_um"]);
    for (index, row) in rows.iter().enumerate() {
        // X fastest.
        let at = [index % 5, index / 5 % 4, index / 20];
        for axis in 0..3 {
            assert_eq!(places[axis][at[axis]], row[axis]);
            assert_eq!(arrays[0].1[3 * index + axis], row[3 + axis]);
            assert!((arrays[2].1[3 * index + axis] - (row[3 + axis] - shift[axis])).abs() < 1e-3);
        }
        assert_eq!(arrays[1].1[index], row[6]);
    }
}

#[test]
fn the_map_is_what_predict_says() {
    let found = map(
        "predict",
        &["-m", "machine-profiles/generic_vmc.toml", "--grid", "4x4x4", "--tool-vector", "H1"],
    );
    let rows = rows(&found.csv);
    let mut points = String::from("x_mm,y_mm,z_mm,tool_x_mm,tool_y_mm,tool_z_mm\n");
    for row in &rows {
        points += &format!("{},{},{},0,0,-120\n", row[0], row[1], row[2]);
    }
    let file = folder("predict").join("points.csv");
    std::fs::write(&file, points).expect("writes");
    let output = run(&["predict", file.to_str().expect("UTF-8"), "-m", "machine-profiles/generic_vmc.toml"]);
    let text = String::from_utf8(output.stdout).expect("UTF-8");
    for (line, row) in text.lines().skip(1).zip(&rows) {
        let numbers: Vec<f64> = line.split(',').map(|v| v.parse().expect("a number")).collect();
        for axis in 0..3 {
            assert!((numbers[9 + axis] - row[3 + axis]).abs() < 2e-6, "{line}");
        }
    }
}

#[test]
fn parts_have_figures_of_their_own_nodes() {
    let found = map(
        "parts",
        &[
            "-m",
            STAN,
            "--grid",
            "11x8x5",
            "--region",
            "corner=0..80,0..40,0..50",
            "--plane",
            "XY=100",
            "--plane",
            "xz",
            "--part-box",
            "100..220,50..130,20..60",
            "--within",
            "50",
        ],
    );
    let parts = found.json["parts"].as_array().expect("a list");
    let names: Vec<&str> = parts.iter().map(|part| part["name"].as_str().expect("a name")).collect();
    assert_eq!(&names[..4], ["volume", "corner", "XY at Z 100", "XZ at Y 0"]);
    assert_eq!(names.len(), 1 + 1 + 1 + 8 + 1);
    assert_eq!(names.last(), Some(&"part box"));
    let rows = rows(&found.csv);
    for (part, inside) in [
        (&parts[1], (|r: &[f64; 7]| r[0] <= 80.0 && r[1] <= 40.0 && r[2] <= 50.0) as fn(&[f64; 7]) -> bool),
        (&parts[2], |r| r[2] == 100.0),
        (&parts[10], |r| r[1] == 280.0),
    ] {
        let lengths: Vec<f64> = rows.iter().filter(|r| inside(r)).map(|r| r[6]).collect();
        assert_eq!(number(&part["figures"]["nodes"]) as usize, lengths.len());
        let within = lengths.iter().filter(|d| **d <= 50.0).count();
        assert_eq!(number(&part["figures"]["within"]) as usize, within, "{}", part["name"]);
        for zero in part["zero_points"].as_array().expect("a list") {
            assert!(number(&zero["figures"]["within"]) >= 1.0);
        }
    }
    let own = &parts[11];
    assert_eq!(own["box_mm"], serde_json::json!([[100.0, 220.0], [50.0, 130.0], [20.0, 60.0]]));
    let median = number(&zero_point(own, "geometric median")["figures"]["rms_um"]);
    let of_volume = number(&zero_point(&parts[0], "geometric median")["figures"]["rms_um"]);
    assert!(median < of_volume, "a small box is better than the whole volume");
}

#[test]
fn where_to_clamp_beats_the_middle_of_the_volume() {
    let size = ["120,80,40", "140..260,100..180,80..120"];
    let found = map("clamp", &["-m", STAN, "--grid", "5x5x5", "--clamp", size[0], "--part-box", size[1]]);
    let places = found.json["places"].as_array().expect("a list");
    let after: Vec<f64> = places.iter().map(|place| number(&place["after"]["rms_um"])).collect();
    assert_eq!(after.len(), 3);
    // More freedom leaves less; the middle of the volume cannot be better than the best place.
    assert!(after[2] <= after[1] && after[1] <= after[0], "{after:?}");
    // The same box there and in the middle, both sampled by --part-box.
    let ranges = places[0]["box_mm"].as_array().expect("a list");
    let best: Vec<String> = ranges.iter().map(|r| format!("{}..{}", number(&r[0]), number(&r[1]))).collect();
    let there = map("clamped", &["-m", STAN, "--grid", "5x5x5", "--part-box", &best.join(",")]);
    let rms = |found: &Mapped| {
        number(&zero_point(&found.json["parts"][1], "geometric median")["figures"]["rms_um"])
    };
    assert!(rms(&there) < rms(&found), "{} {}", rms(&there), rms(&found));
    for place in places {
        for (range, most) in place["box_mm"].as_array().expect("a list").iter().zip([400.0, 280.0, 200.0]) {
            assert!(number(&range[0]) >= 0.0 && number(&range[1]) <= most + 1e-6, "{place}");
        }
    }
}

#[test]
fn second_order_is_far_below_a_micrometre_on_this_machine() {
    let found = map("second", &["-m", STAN, "--grid", "9x9x9", "--second-order"]);
    let second = &found.json["second_order"];
    assert_eq!(second["orders"], 1296);
    assert!(number(&second["chain_difference_um"]) < 0.1, "{second}");
    let scale = number(&second["angle_scale"]);
    assert!((10.0..100.0).contains(&scale), "{second}");
    let all = [&second["all_orders_um"][0], &second["all_orders_um"][1]].map(number);
    for pattern in ["all_plus_um", "all_minus_um"] {
        assert!((all[0]..=all[1]).contains(&number(&second[pattern])), "{second}");
    }
    assert!(found.text.contains("products of errors reach 1 um where all angles are k ="), "{}", found.text);
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let bytes = |threads: &str| {
        let folder = folder(&format!("threads{threads}"));
        let mut command = vpost();
        command.env("RAYON_NUM_THREADS", threads).args([
            "map",
            "-m",
            KONDIA,
            "--plane",
            "XZ",
            "--second-order",
        ]);
        for kind in ["json", "csv", "vtk"] {
            command.arg(format!("--{kind}")).arg(folder.join(kind));
        }
        let output = command.output().expect("starts");
        assert!(output.status.success(), "{}", messages(&output));
        let files = ["json", "csv", "vtk"].map(|kind| std::fs::read(folder.join(kind)).expect("was written"));
        (output.stdout, files)
    };
    assert!(bytes("1") == bytes("7"));
}

#[test]
fn what_cannot_be_mapped_is_refused_with_what_to_type() {
    let refused = |arguments: &[&str], expected: &[&str]| {
        let output = run(&[&["map", "-m", STAN], arguments].concat());
        let text = messages(&output);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {text}");
        assert!(output.stdout.is_empty());
        for words in expected {
            assert!(text.contains(words), "{arguments:?}: {text}");
        }
    };
    refused(&["--grid", "22x22"], &["VP0002", "three whole numbers", "--grid 22x22x21"]);
    refused(&["--grid", "0x2x2"], &["VP0002", "one node at least"]);
    refused(&["--grid", "1000x1000x1000"], &["VP0002", "1000000000 nodes"]);
    refused(&["--grid", "0:100:30,0:100:10,0:100:10"], &["VP0002", "a step of 30 mm does not divide 100 mm"]);
    refused(
        &["--grid", "0:500:100,0:100:50,0:100:50"],
        &["VP0909", "X from 0 to 500 mm", "0 to 400 mm", "--outside clamp"],
    );
    refused(&["--part-box", "0..10,0..10,190..210"], &["VP0909", "Z from 190 to 210 mm"]);
    refused(&["--part-box", "10..0,0..10,0..10"], &["VP0002", "--part-box"]);
    refused(&["--region", "0..10,0..10,0..10"], &["VP0002", "--region table="]);
    refused(&["--region", "gap=1..2,1..2,1..2"], &["VP0002", "no node of the grid"]);
    refused(&["--plane", "XQ=10"], &["VP0002", "--plane XY=100"]);
    refused(&["--clamp", "500,10,10"], &["VP0002", "500 mm long in X, the calibrated volume 400 mm"]);
    refused(&["--within", "0"], &["VP0002", "--within 20"]);
    refused(&["--tool-vector", "H7"], &["VP0002", "--tool H7=120"]);
    refused(&["--rotary", "C=90"], &["VP0002", "no such axis"]);
    refused(&["--engine", "kmtpp-published"], &["VP0002", "without `-published`"]);
    // Outside with the nearest point's error: done, and said.
    let output = run(&["map", "-m", STAN, "--grid", "0:500:100,0:100:50,0:100:50", "--outside", "clamp"]);
    assert!(output.status.success());
    assert!(messages(&output).contains("warning[VP0909]"), "{}", messages(&output));
}

#[test]
fn effects_and_their_conditions_are_part_of_the_map() {
    let profile = std::fs::read_to_string(crate::common::root().join(KONDIA)).expect("reads")
        + "[[effect]]\nid = \"thermal.X\"\nexpansion_um_per_m_k = 11.5\n";
    let profile = profile.replace(
        "chain ",
        "calibrated = { date = \"2026-01-01\", temperature_c = 20.0, instrument = \"none\" }\nchain ",
    );
    let file = folder("effects").join("warm.toml");
    std::fs::write(&file, profile).expect("writes");
    let file = file.to_str().expect("UTF-8");
    let output = run(&["map", "-m", file]);
    assert!(messages(&output).contains("VP0401"), "{}", messages(&output));
    let warm = map("warm", &["-m", file, "--grid", "3x3x3", "--at", "temp_c=30"]);
    let cold = map("cold", &["-m", file, "--grid", "3x3x3", "--at", "temp_c=20"]);
    let (warm, cold) = (rows(&warm.csv), rows(&cold.csv));
    // 11.5 µm/m/K over 1 m and 10 K.
    let grown = (warm[2][3] - cold[2][3]) - (warm[0][3] - cold[0][3]);
    assert!((grown.abs() - 115.0).abs() < 1e-3, "{grown}");
}
