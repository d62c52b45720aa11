//! Tables as spreadsheets save them give the same answers as plain ones, in every command that reads tables.

use std::path::Path;

use units::math;

use crate::common::{messages, root, run};

/// Another spelling of a plain table.
type Spelling = fn(&str) -> Vec<u8>;

/// Semicolons, decimal commas, a byte order mark, line ends of Windows, free columns and rows behind.
fn excel(text: &str) -> Vec<u8> {
    let mut out = String::from("\u{feff}");
    for line in text.lines() {
        let cells = line.replace(',', ";").replace('.', ",");
        out += &if line.starts_with('#') { format!("{line};;;\r\n") } else { format!("{cells};;\r\n") };
    }
    (out + ";;;;\r\n").into_bytes()
}

/// Excel's "Unicode text": tabs, decimal commas, UTF-16.
fn unicode_text(text: &str) -> Vec<u8> {
    let body = text.lines().filter(|line| !line.starts_with('#'));
    let text: String = body.map(|line| line.replace(',', "\t").replace('.', ",") + "\r\n").collect();
    [0xFF, 0xFE].into_iter().chain(text.encode_utf16().flat_map(u16::to_le_bytes)).collect()
}

/// Windows-1251 with headers of the region; tables of points and of `diagnose`.
fn cyrillic(text: &str) -> Vec<u8> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header: Vec<String> = lines
        .next()
        .unwrap_or_default()
        .split(',')
        .map(|name| {
            let axis = |letter: &str| letter.to_uppercase().replace('X', "Х");
            match name.split('_').collect::<Vec<_>>()[..] {
                ["run"] => "Серия".to_owned(),
                [letter @ ("x" | "y" | "z"), "mm"] => format!("Задано {}, мм", axis(letter)),
                [letter, "deg"] => format!("Угол {}, град", axis(letter)),
                [d, "um"] if d.len() == 2 && d.starts_with('d') => {
                    format!("Отклонение {} (мкм)", axis(&d[1..]))
                }
                ["position", "mm"] => "Позиция [мм]".to_owned(),
                _ => name.to_owned(),
            }
        })
        .collect();
    let mut out = header.join(";") + "\r\n";
    lines.for_each(|line| out += &(line.replace(',', ";").replace('.', ",") + "\r\n"));
    let letters = out.chars().map(|letter| match letter {
        'А'..='я' => u8::try_from(letter as u32 - 'А' as u32 + 0xC0).expect("64 letters"),
        _ => u8::try_from(letter).expect("ASCII"),
    });
    letters.collect()
}

/// What a command prints of plain tables, and of the same in every spelling; `NAME` in an argument is a table's path.
fn same(tables: &[&str], arguments: &[&str]) {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |spelt: &dyn Fn(&str) -> Vec<u8>| {
        for table in tables {
            let text = std::fs::read_to_string(root().join(table)).expect("a sample");
            let name = Path::new(table).file_name().expect("a name");
            std::fs::write(folder.path().join(name), spelt(&text)).expect("written");
        }
        let place = format!("{}/", folder.path().display());
        let arguments: Vec<String> = arguments.iter().map(|a| a.replace("IN/", &place)).collect();
        let arguments: Vec<&str> = arguments.iter().map(String::as_str).collect();
        let output = run(&arguments);
        assert!(output.status.success(), "{arguments:?}\n{}", messages(&output));
        String::from_utf8(output.stdout).expect("text")
    };
    let plain = write(&|text| text.as_bytes().to_vec());
    for spelling in [excel as Spelling, unicode_text, cyrillic] {
        assert_eq!(write(&spelling), plain, "{arguments:?}");
    }
}

#[test]
fn points_and_measurements_are_read_as_spreadsheets_save_them() {
    same(
        &["samples/diagnosis/backlash.csv"],
        &["diagnose", "IN/backlash.csv", "-m", "samples/diagnosis/backlash.toml"],
    );
    let budget = ["budget", "-m", "samples/budget/ms300_like.toml", "--points", "IN/ball_points.csv"];
    same(&["samples/budget/ball_points.csv"], &budget);
}

#[test]
fn instruments_tables_are_read_as_spreadsheets_save_them() {
    let folder = "samples/calibration";
    let table = |name: &str| format!("{folder}/{name}");
    let interferometer = ["calibrate", "interferometer", "IN/iso230_2_psi_2021.csv"];
    same(&[&table("iso230_2_psi_2021.csv")], &interferometer);
    let ball_bar = ["calibrate", "ballbar", "IN/ballbar_circles.csv", "-m", "machine-profiles/perfect.toml"];
    same(&[&table("ballbar_circles.csv")], &ball_bar);
    let volume =
        ["calibrate", "volumetric", "IN/volume_points.csv", "--chain", "[w X Y b Z t]", "--nodes", "4"];
    same(&[&table("volume_points.csv")], &volume);
    let traverses = ["x", "y", "z"].map(|axis| format!("machine-profiles/stan_s500/tracker_48_{axis}.csv"));
    let names = ["IN/tracker_48_x.csv", "IN/tracker_48_y.csv", "IN/tracker_48_z.csv"];
    same(&traverses.each_ref().map(String::as_str), &[&["calibrate", "tracker"], &names[..]].concat());
}

#[test]
fn tables_of_a_profile_are_read_as_spreadsheets_save_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let profile = folder.path().join("mill.toml");
    let text = std::fs::read_to_string(root().join("machine-profiles/generic_vmc.toml")).expect("a profile");
    std::fs::write(&profile, text.replace("generic_vmc/", "")).expect("written");
    let points = folder.path().join("points.csv");
    std::fs::write(&points, "x_mm,y_mm,z_mm\n-100,-50,-100\n-300.5,-200,-50\n").expect("written");
    let predicted = |spelt: &dyn Fn(&str) -> Vec<u8>| {
        for axis in ["x", "y", "z"] {
            let name = format!("errors_{axis}.csv");
            let text = std::fs::read_to_string(root().join("machine-profiles/generic_vmc").join(&name));
            std::fs::write(folder.path().join(name), spelt(&text.expect("a table"))).expect("written");
        }
        let path = |path: &Path| path.to_str().expect("a plain path").to_owned();
        let output = run(&["predict", &path(&points), "-m", &path(&profile)]);
        assert!(output.status.success(), "{}", messages(&output));
        output.stdout
    };
    let plain = predicted(&|text| text.as_bytes().to_vec());
    assert!(plain == predicted(&excel) && plain == predicted(&unicode_text) && plain == predicted(&cyrillic));
}

/// The answer to points with decimal commas is a table that everything reads, under the usual names.
#[test]
fn answers_are_plain_whatever_came_in() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("written");
        path.to_str().expect("a plain path").to_owned()
    };
    let predicted = |path: &str| run(&["predict", path, "-m", "machine-profiles/stan_s500.toml"]);
    let plain = predicted(&file("plain.csv", "x_mm,y_mm,z_mm\n110.5,170,185\n"));
    let other = predicted(&file("other.csv", "X, м;Y, мм;Z, мм\n0,1105;170;185\n"));
    assert!(plain.status.success() && other.status.success(), "{}", messages(&other));
    assert_eq!(String::from_utf8_lossy(&other.stdout), String::from_utf8_lossy(&plain.stdout));
    let wrong = predicted(&file("wrong.csv", "x_mm;y_mm;z_mm\n110,500;170,250;185,125\n"));
    let said = messages(&wrong);
    assert!(wrong.status.code() == Some(1) && said.contains("wrong.csv:2:1"), "{said}");
    assert!(
        said.contains("`110,500` is 110.500 or 110500") && said.contains("write numbers with a point"),
        "{said}"
    );
}

/// The sample circles as angle and deviation, ISO 230-4 sense of angles; and the same with the balls where those angles put
/// them: the sample's own places are rounded.
fn polar_and_places(text: &str) -> [String; 2] {
    let mut polar =
        String::from("Серия;Плоскость;Радиус, мм;Угол, град;Отклонение, мкм;bx_mm;by_mm;bz_mm;dir\n");
    let mut places = text.lines().next().unwrap_or_default().to_owned() + "\n";
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |k: usize| cells[k].parse::<f64>().expect("a number");
        let from_centre = [0, 1, 2].map(|k| number(1 + k) - number(4 + k));
        let (plane, u, v) = [("YZ", 1, 2), ("ZX", 2, 0), ("XY", 0, 1)]
            .into_iter()
            .find(|(_, u, v)| from_centre[3 - u - v].abs() < 1e-9)
            .expect("a circle in a plane");
        let angle = math::atan2(from_centre[v], from_centre[u]);
        // Along the axis that moves faster.
        let (motion, told) = if from_centre[u].abs() > from_centre[v].abs() {
            (from_centre[u], number(7 + v))
        } else {
            (-from_centre[v], number(7 + u))
        };
        let deviation_um = (number(10) - 100.0) * 1e3;
        let numbers = format!("100;{:.9};{deviation_um:.2}", angle.to_degrees()).replace('.', ",");
        let centre = cells[4..7].join(";").replace('.', ",");
        polar += &format!("{};{plane};{numbers};{centre};{}\n", cells[0], motion.signum() * told);
        let mut ball = [4, 5, 6].map(number);
        ball[u] += 100.0 * math::cos(angle);
        ball[v] += 100.0 * math::sin(angle);
        let ball = ball.map(|v| format!("{v:.9}")).join(",");
        places += &format!("{},{ball},{}\n", cells[0], cells[4..].join(","));
    }
    [polar, places]
}

#[test]
fn ball_bars_as_angle_and_deviation_give_the_same() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = std::fs::read_to_string(root().join("samples/calibration/ballbar_circles.csv"));
    let [whole, places] = polar_and_places(&text.expect("a sample"));
    let file = folder.path().join("polar.csv");
    let path = file.to_str().expect("a plain path").to_owned();
    let answer = |command: &[&str], text: &str| {
        std::fs::write(&file, text).expect("written");
        run(&[command, &[&path, "-m", "machine-profiles/perfect.toml"]].concat())
    };
    for command in [&["calibrate", "ballbar"][..], &["diagnose"]] {
        let [polar, places] = [&whole, &places].map(|text| answer(command, text));
        assert!(polar.status.success(), "{command:?}\n{}", messages(&polar));
        assert_eq!(String::from_utf8_lossy(&polar.stdout), String::from_utf8_lossy(&places.stdout));
    }
    let refused = |text: &str, says: &[&str]| {
        for command in [&["calibrate", "ballbar"][..], &["diagnose"]] {
            let output = answer(command, text);
            let said = messages(&output);
            assert!(
                output.status.code() == Some(1) && says.iter().all(|s| said.contains(s)),
                "{command:?}\n{said}"
            );
        }
    };
    let half: Vec<&str> =
        whole.lines().enumerate().filter(|(k, _)| k % 60 < 31).map(|(_, line)| line).collect();
    refused(&(half.join("\n") + "\n"), &["VP1105", "degrees of its circle", "measure 220 degrees at least"]);
    refused(&whole.replace("XY", "XZ"), &["VP0912", "polar.csv:2:3", "`XZ` is no plane", "XY, YZ or ZX"]);
    refused(&whole.replace("Плоскость", "note"), &["VP0911", "column `plane` is missing"]);
    refused(
        &whole.replace("Отклонение, мкм", "Отклонение, град"),
        &["VP0911", "deviation is a length, deg is an angle"],
    );
}
