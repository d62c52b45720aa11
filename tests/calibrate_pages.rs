//! `vpost calibrate … --html --json --csv`: the page says what the command says, and no more than the readings do.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Output;

use serde_json::Value;

use crate::common::{messages, root, run, vpost};

/// A page with its JSON, its CSV and what the command printed.
struct Shown {
    folder: tempfile::TempDir,
    html: String,
    json: Value,
    csv: String,
    printed: String,
}

fn printed(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).expect("UTF-8")
}

/// Runs the command; files lie in a folder of its own.
fn shown(instrument: &str, files: &[&str], more: &[&str]) -> Shown {
    let folder = tempfile::tempdir().expect("a folder");
    let name = |name: &str| folder.path().join(name).to_str().expect("a plain path").to_owned();
    let (html, json, csv) = (name("p.html"), name("p.json"), name("p.csv"));
    let to = ["--html", &html, "--json", &json, "--csv", &csv];
    let output = run(&[&["calibrate", instrument], files, more, &to].concat());
    assert!(output.status.success(), "{files:?}: {}", messages(&output));
    let read = |path: &str| std::fs::read_to_string(path).expect("written");
    Shown {
        html: crate::common::page(&html),
        json: serde_json::from_str(&read(&json)).expect("JSON"),
        csv: read(&csv),
        printed: printed(&output),
        folder,
    }
}

/// A file in a folder.
fn file(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path.to_str().expect("a plain path").to_owned()
}

/// Cells of the row of a page's tables that begins so.
fn row(page: &str, first: &str) -> Vec<String> {
    let start = page.find(&format!(">{first}</td>")).unwrap_or_else(|| panic!("no row {first}"));
    let row = page[start..].split("</tr>").next().expect("a row");
    let cell = |part: &str| part.split_once('>').map(|(_, text)| text.replace('\u{2212}', "-"));
    row.split("</td>").filter_map(cell).collect()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

/// The data that the page carries along.
fn carried(page: &str) -> Value {
    let data = page.split("type=\"application/json\">").nth(1).and_then(|t| t.split("</script>").next());
    serde_json::from_str(data.expect("a data block")).expect("JSON")
}

/// What docs/reproduction.md prints of our figures: symbol and value of one column of its table.
fn reproduced(column: usize) -> Vec<(String, String)> {
    let text = std::fs::read_to_string(root().join("docs/reproduction.md")).expect("there");
    let table = text.split("## ISO 230-2").nth(1).and_then(|t| t.split("\n\n").nth(2)).expect("a table");
    let row = |line: &str| {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        let ours = cells[2 + column].split(" / ").nth(1).expect("printed / ours");
        (cells[1].to_owned(), ours.split(' ').next().expect("a number").to_owned())
    };
    table.lines().skip(2).map(row).collect()
}

#[test]
fn public_runs_have_the_figures_of_the_command_and_of_the_documents() {
    for (column, name) in ["psi_2023", "psi_2021", "muts_2022"].into_iter().enumerate() {
        let sample = format!("samples/calibration/iso230_2_{name}.csv");
        let all = shown("interferometer", &[&sample], &[]);
        let found = &all.json["functions"][0];
        let iso = &found["iso230_2"];
        let expected = reproduced(column);
        assert_eq!(expected.len(), 12, "{expected:?}");
        for (symbol, ours) in expected {
            let digits = ours.split_once('.').map_or(0, |(_, d)| d.len());
            let key = symbol.replace('↑', "_up").replace('↓', "_down").replace("B\u{304}", "mean_B");
            let key = if key.starts_with('B') && key.len() > 1 { "mean_B".to_owned() } else { key };
            let value = if key == "mean_B" { number(&iso[&key]) } else { number(&iso[&key]["value"]) };
            assert_eq!(format!("{value:.digits$}"), ours, "{name} {symbol}");
            if key == "mean_B" {
                continue;
            }
            // The page has the digits of the command.
            let cells = row(&all.html, &symbol);
            let line = all.printed.lines().find(|l| l.trim_start().starts_with(&format!("{symbol} ")));
            let words: Vec<&str> = line.expect("printed").split_whitespace().collect();
            assert_eq!([cells[1].as_str(), cells[2].as_str()], [words[1], words[3]], "{name} {symbol}");
            assert_eq!(cells[1], format!("{value:.3}"));
        }
        assert_eq!(carried(&all.html), all.json, "the page carries its JSON along");
        // Ten runs, two bands, two means.
        for (class, count) in [("run s0", 5), ("run s1", 5), ("shade k", 2), ("mean s", 2)] {
            assert_eq!(all.html.matches(&format!("class=\"{class}")).count(), count, "{name} {class}");
        }
        // 5 targets: ten runs, and mean and limits of both directions.
        assert_eq!(all.csv.lines().count(), 1 + 5 * (10 + 6));
    }
}

#[test]
fn the_page_says_where_the_worst_lies_and_what_a_correction_leaves() {
    let all = shown("interferometer", &["samples/calibration/iso230_2_psi_2021.csv"], &[]);
    assert_eq!(row(&all.html, "R↓")[3], "15");
    assert_eq!(row(&all.html, "E↑")[3], "55.8 and 35.4");
    // One run of five lies apart: the others correct it the wrong way.
    assert!(all.html.contains(">SCATTER<") && all.html.contains("would make it worse"));
    let held = &all.json["functions"][0]["held_out"];
    assert!(number(&held["range_after"]) > number(&held["range_before"]), "{held}");
    // A curve that repeats is what a correction takes away.
    let mut text = String::from("run,dir,position_mm,EXX_um\n");
    for run in 1..=5 {
        for (target, curve) in [0.0, 8.0, 15.0, 21.0, 30.0].into_iter().enumerate() {
            for dir in [1, -1] {
                let noise = 0.1 * f64::from((run * 7 + dir * 3 + target as i32) % 5);
                let _ = writeln!(text, "{run},{dir},{},{}", 50 * target, curve + noise);
            }
        }
    }
    let folder = tempfile::tempdir().expect("a folder");
    let all = shown("interferometer", &[&file(folder.path(), "good.csv", &text)], &[]);
    assert!(all.html.contains(">REPEATABLE CURVE<") && all.html.contains("what a correction will bring"));
    let held = &all.json["functions"][0]["held_out"];
    assert!(number(&held["range_after"]) < 1.1 && number(&held["range_before"]) > 29.0, "{held}");
}

#[test]
fn what_was_not_run_is_said_and_not_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let sample = root().join("samples/calibration/iso230_2_psi_2021.csv");
    let text = std::fs::read_to_string(sample).expect("a sample");
    let only = |name: &str, keep: &dyn Fn(&[&str]) -> bool| {
        let rows = text.lines().filter(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            cells[0].starts_with("run") || (cells.len() == 4 && keep(&cells))
        });
        let text: Vec<&str> = rows.collect();
        shown("interferometer", &[&file(folder.path(), name, &(text.join("\n") + "\n"))], &[])
    };
    let once = only("once.csv", &|cells| cells[0] == "1");
    assert!(once.html.contains("NOT EVALUATED") && once.html.contains("Each direction was run once"));
    assert!(once.json["functions"][0]["iso230_2"].is_null() && !once.html.contains("class=\"shade"));
    assert_eq!(once.html.matches("class=\"run s").count(), 2);
    let up = only("up.csv", &|cells| cells[1] == "1");
    assert!(up.html.contains("Runs in one direction only"));
    let iso = &up.json["functions"][0]["iso230_2"];
    assert!(iso.get("B").is_none() && iso.get("A_down").is_none() && iso.get("A_up").is_some(), "{iso}");
    assert!(!up.html.contains(">B</td>") && !up.html.contains("class=\"run s1"));
    // Without a direction, and with the means alone.
    let unsaid = text.replace("run,dir,", "run,note,").replace(",-1,", ",9,");
    let rows: Vec<&str> = unsaid.lines().filter(|line| !line.contains(",9,")).collect();
    let unsaid = file(folder.path(), "unsaid.csv", &(rows.join("\n") + "\n"));
    let all = shown("interferometer", &[&unsaid], &["--ignore-column", "note"]);
    assert!(all.html.contains("does not say the direction"), "{}", all.printed);
}

/// A circle of 100 mm in XY, both ways: lengths by `deviation_um(angle, sense)`.
fn circles(
    folder: &Path,
    name: &str,
    run: &str,
    to_deg: u32,
    deviation_um: &dyn Fn(f64, f64) -> f64,
) -> String {
    let mut text = String::from("run,plane,radius_mm,bx_mm,by_mm,bz_mm,angle_deg,dir,deviation_um\n");
    for sense in [1_i32, -1] {
        // Where no axis turns round.
        for degrees in (2..to_deg).step_by(5) {
            let angle = f64::from(degrees).to_radians();
            let _ = writeln!(
                text,
                "{run},XY,100,200,200,0,{degrees},{sense},{:.6}",
                deviation_um(angle, f64::from(sense))
            );
        }
    }
    file(folder, name, &text)
}

/// Digits that no pattern has, so that something is left to adjust by.
fn noise(angle: f64, sense: f64) -> f64 {
    0.01 * units::math::sin(37.0 * angle + 11.0 * sense)
}

#[test]
fn a_squareness_makes_what_geometry_says() {
    let folder = tempfile::tempdir().expect("a folder");
    // 40 µrad over 100 mm: an ellipse, 4 µm from its short to its long axis.
    let text =
        circles(folder.path(), "square.csv", "c", 360, &|a, s| 2.0 * units::math::sin(2.0 * a) + noise(a, s));
    let all = shown("ballbar", &[&text], &[]);
    let plane = &all.json["circles"]["planes"][0];
    assert!((number(&plane["G_both_um"]) - 4.0).abs() < 0.05, "{plane}");
    let first = &plane["causes"][0];
    assert_eq!(first["cause"], "squareness EC0Y");
    assert!((number(&first["range_um"]) - 4.0).abs() < 0.02 && number(&first["share"]) > 0.97, "{first}");
    let angle = number(&all.json["circles"]["squareness_urad"]["EC0Y"]["value"]);
    assert!((angle.abs() - 40.0).abs() < 0.1, "{angle}");
    assert!(number(&plane["corrected_um"]) < 0.05 && all.html.contains(">SQUARENESS<"));
    // Table, JSON and printed lines say the same.
    let cells = row(&all.html, "squareness EC0Y");
    assert_eq!(cells[1], format!("{:.2}", number(&first["range_um"])));
    assert_eq!(row(&all.html, "EC0Y")[1], format!("{angle:.2}"));
    assert!(all.printed.contains(&format!("{angle:.2}")), "{}", all.printed);
    assert_eq!(all.csv.lines().count(), 1 + 144 * (3 + plane["causes"].as_array().expect("causes").len()));
}

#[test]
fn circles_of_a_sample_have_figures_for_every_plane() {
    let all = shown("ballbar", &["samples/calibration/ballbar_circles.csv"], &["--date", "2026-11-01"]);
    let planes = all.json["circles"]["planes"].as_array().expect("planes");
    assert_eq!(planes.len(), 3);
    for plane in planes {
        let name = plane["plane"].as_str().expect("a name");
        let at = all.html.find(&format!("Circles in {name}</h2>")).expect("a section");
        let section = all.html[at..].split("</section>").next().expect("it ends");
        assert_eq!(row(section, "F\u{a0}max")[1], format!("{:.2}", number(&plane["F_max_um"])), "{name}");
        for cause in plane["causes"].as_array().expect("causes") {
            let cells = row(section, cause["cause"].as_str().expect("a name"));
            let keys = ["range_um", "u95_um", "without_um"].map(|key| format!("{:.2}", number(&cause[key])));
            assert_eq!([&cells[1], &cells[2], &cells[4]], keys.each_ref(), "{name}");
        }
        assert_eq!(section.matches("<svg").count(), 6, "the circle, four causes, the set-up");
    }
    // Play of Y, as it is printed: one way round it moves the ball by half of it, back by the other half.
    let play = number(&all.json["circles"]["backlash_um"]["Y"]["value"]);
    assert!((number(&planes[0]["causes"][0]["range_um"]) - play).abs() < 0.01 * play);
    for said in ["2026-11-01", "not stated (--instrument)", "BLAKE3", "vpost calibrate ballbar"] {
        assert!(all.html.contains(said), "{said}");
    }
}

#[test]
fn figures_of_both_directions_need_one_centre() {
    let folder = tempfile::tempdir().expect("a folder");
    // Back, the circle is 9 µm larger: a run of its own would call that another length of the bar.
    let text = circles(folder.path(), "one.csv", "c", 360, &|a, s| noise(a, s) - 4.5 * s);
    let one = shown("ballbar", &[&text], &[]);
    let plane = &one.json["circles"]["planes"][0];
    for (symbol, key) in [("G(b)", "G_both_um"), ("H", "H_um")] {
        assert!((number(&plane[key]) - 9.0).abs() < 0.05, "{plane}");
        assert_eq!(row(&one.html, symbol)[1], format!("{:.2}", number(&plane[key])));
    }
    let read = std::fs::read_to_string(&text).expect("written");
    let lines = read.lines().map(|l| if l.contains(",-1,") { l.replacen('c', "d", 1) } else { l.to_owned() });
    let apart = file(folder.path(), "two.csv", &(lines.collect::<Vec<_>>().join("\n") + "\n"));
    let apart = shown("ballbar", &[&apart], &[]);
    let plane = &apart.json["circles"]["planes"][0];
    assert!(plane["G_both_um"].is_null() && plane["H_um"].is_null(), "{plane}");
    for said in [&apart.html, &apart.printed] {
        assert!(said.contains("give both one run number"), "{said}");
    }
    assert!(!one.printed.contains("one run number"), "{}", one.printed);
}

#[test]
fn parts_of_circles_and_unsaid_directions_are_not_judged() {
    let folder = tempfile::tempdir().expect("a folder");
    let play = |a: f64, s: f64| {
        let (sin, cos) = (units::math::sin(a), units::math::cos(a));
        4.0 * s * cos * if sin > 0.0 { 1.0 } else { -1.0 } + noise(a, s)
    };
    let part = shown("ballbar", &[&circles(folder.path(), "part.csv", "c", 230, &play)], &[]);
    assert!(part.html.contains("PARTIAL CIRCLE") && part.html.contains("covers 225 degrees"));
    let half = circles(folder.path(), "half.csv", "c", 185, &play);
    let output = run(&["calibrate", "ballbar", &half, "--html", "/dev/null"]);
    assert!(!output.status.success() && messages(&output).contains("180 degrees of its circle"));
    let text = std::fs::read_to_string(circles(folder.path(), "all.csv", "c", 360, &play)).expect("written");
    let one: Vec<&str> = text.lines().filter(|line| !line.contains(",-1,")).collect();
    let one = shown("ballbar", &[&file(folder.path(), "one.csv", &(one.join("\n") + "\n"))], &[]);
    assert!(one.html.contains("Circles in one direction only") && !one.html.contains(">G(b)</td>"));
    assert!(one.json["circles"]["planes"][0]["H_um"].is_null());
    let unsaid = file(folder.path(), "unsaid.csv", &text.replace(",dir,", ",note,"));
    let unsaid = shown("ballbar", &[&unsaid], &["--ignore-column", "note"]);
    assert!(unsaid.html.contains("NO CAUSE") && unsaid.html.contains("No reading says which way round"));
    assert!(unsaid.json["circles"]["backlash_um"]["X"].is_null());
}

#[test]
fn names_are_shown_and_never_act() {
    let folder = tempfile::tempdir().expect("a folder");
    let act = "<script>document.documentElement.id='acted'</script>";
    let run = format!("\"{act}\"\"&amp;\"");
    let named = circles(folder.path(), "plain.csv", "RUN", 360, &noise);
    let text = std::fs::read_to_string(&named).expect("written");
    let back = |line: &str| line.contains(",-1,");
    let name = |line: &str| line.replace("RUN", if back(line) { "\"\u{202e}<img src=x>,\"" } else { &run });
    let text: String = text.lines().map(|line| name(line) + "\n").collect();
    let hostile = file(folder.path(), "<b onmouseover=x>'m&m.csv", &text);
    let all = shown("ballbar", &[&hostile], &["--instrument", act]);
    assert_eq!(all.html.matches("<script").count(), 1, "the data block is the only one");
    assert!(all.html.contains("&lt;script&gt;") && all.html.contains("&lt;img src=x&gt;"), "they are shown");
    assert!(!all.html.contains("<img") && !all.html.contains("<b on") && all.html.contains("U+202E"));
    assert_eq!(carried(&all.html), all.json);
    // In the CSV a name is one cell.
    assert!(all.csv.contains("XY,\"\u{202e}<img src=x>,\",clockwise,2.0000,"), "{}", &all.csv[..400]);
}

#[test]
fn the_same_bytes_for_any_number_of_threads() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| -> PathBuf { folder.path().join(name) };
    for (instrument, sample) in
        [("ballbar", "ballbar_circles.csv"), ("interferometer", "iso230_2_muts_2022.csv")]
    {
        let mut before: Option<[Vec<u8>; 3]> = None;
        for threads in ["1", "2", "7"] {
            let made = vpost()
                .env("RAYON_NUM_THREADS", threads)
                .args(["calibrate", instrument, &format!("samples/calibration/{sample}")])
                .args([Path::new("--html"), &path("a.html"), Path::new("--json"), &path("a.json")])
                .args([Path::new("--csv"), &path("a.csv")])
                .output()
                .expect("vpost starts");
            assert!(made.status.success(), "{}", messages(&made));
            let bytes = ["a.html", "a.json", "a.csv"].map(|name| std::fs::read(path(name)).expect("written"));
            assert!(before.as_ref().is_none_or(|before| *before == bytes), "{instrument}, {threads} threads");
            before = Some(bytes);
        }
    }
}

#[test]
fn the_page_names_the_profile_that_was_written() {
    let folder = tempfile::tempdir().expect("a folder");
    let made = folder.path().join("made.toml");
    let made = made.to_str().expect("a plain path");
    let more = [
        "--chain",
        "[w X Y b Z t]",
        "-d",
        "linuxcnc",
        "-o",
        made,
        "--instrument",
        "QC20",
        "--temperature",
        "21.5",
    ];
    let all = shown("ballbar", &["samples/calibration/ballbar_circles.csv"], &more);
    let facts = &all.json["made"];
    assert_eq!((&facts["instrument"], number(&facts["temperature_c"])), (&Value::from("QC20"), 21.5));
    let hash = facts["profile"]["blake3"].as_str().expect("a hash");
    assert!(all.html.contains(hash) && all.html.contains("Written to"));
    // The hash is the one that every other page shows of this profile.
    let map = folder.path().join("map.html");
    let ran = run(&["map", "-m", made, "--grid", "3x3x3", "--html", map.to_str().expect("plain")]);
    assert!(ran.status.success(), "{}", messages(&ran));
    assert!(std::fs::read_to_string(map).expect("written").contains(hash));
    let text = std::fs::read_to_string(made).expect("a profile");
    let stated = text.split("uncertainty_um = ").nth(1).and_then(|t| t.split([',', ' ', '}']).next());
    assert_eq!(
        format!("{:.3}", number(&facts["uncertainty_um"])),
        format!("{:.3}", stated.expect("stated").parse::<f64>().expect("a number"))
    );
    assert!(all.folder.path().is_dir());
}

#[test]
fn curves_of_the_base_are_told_from_the_causes() {
    let folder = tempfile::tempdir().expect("a folder");
    // A screw that the base knows: 6 µm ahead at the circle's right and left, right in its middle.
    let table = "position_mm,EXX_um\n0,0\n100,6\n200,0\n300,6\n400,0\n";
    file(folder.path(), "x.csv", table);
    let profile = "format = 1\nname = \"m\"\ncontrol = \"linuxcnc\"\nchain = \"[w X Y b Z t]\"\n[axis.X]\ntravel_mm = [0, 400]\nresolution_mm = 0.001\nerrors = \"x.csv\"\n[axis.Y]\ntravel_mm = [0, 400]\nresolution_mm = 0.001\n[axis.Z]\ntravel_mm = [-10, 10]\nresolution_mm = 0.001\n";
    let profile = file(folder.path(), "m.toml", profile);
    let curve_um = |x: f64| 6.0 * (1.0 - ((x.abs() - 100.0).abs() / 100.0));
    let made = |a: f64, s: f64| {
        let cos = units::math::cos(a);
        curve_um(100.0 * cos) * cos + 2.0 * units::math::sin(2.0 * a) + noise(a, s)
    };
    let text = circles(folder.path(), "c.csv", "c", 360, &made);
    let all = shown("ballbar", &[&text], &["-m", &profile]);
    let plane = &all.json["circles"]["planes"][0];
    assert_eq!(plane["causes"][0]["cause"], "squareness EC0Y", "{plane}");
    assert!((number(&plane["causes"][0]["range_um"]) - 4.0).abs() < 0.05, "{plane}");
    // 6 |cos φ| cos φ about its own circle: 6 (4/3π)² to either side.
    assert!((number(&plane["curves_of_base_um"]) - 2.16).abs() < 0.03, "{plane}");
    assert!(number(&plane["left_um"]) < 0.1, "{plane}");
    assert!(number(&plane["corrected_um"]) < 0.1, "{plane}");
    assert!(
        all.html.contains("the base's own curves corrected")
            || all.html.contains("own curves and effects make")
    );
}

#[test]
fn standard_input_has_no_hash() {
    let folder = tempfile::tempdir().expect("a folder");
    let bars = std::fs::File::open(circles(folder.path(), "c.csv", "c", 360, &noise)).expect("there");
    let json = folder.path().join("p.json");
    let made = vpost()
        .args(["calibrate", "ballbar", "-", "--json"])
        .arg(&json)
        .stdin(bars)
        .output()
        .expect("vpost starts");
    assert!(made.status.success(), "{}", messages(&made));
    let text = std::fs::read_to_string(json).expect("written");
    let found: Value = serde_json::from_str(&text).expect("JSON");
    assert!(found["made"]["files"][0]["blake3"].is_null(), "{text}");
}

#[test]
fn a_page_never_replaces_what_it_is_made_of() {
    let folder = tempfile::tempdir().expect("a folder");
    let bars = circles(folder.path(), "bars.csv", "c", 360, &noise);
    let output = run(&["calibrate", "ballbar", &bars, "--html", &bars]);
    assert!(!output.status.success() && messages(&output).contains("VP0004"), "{}", messages(&output));
}
