//! The tool's direction: corrected with `--orientation full`, and given as vectors.

use std::fmt::Write as _;

use crate::common::{messages, run};

const PROFILE: &str = "tests/profiles/five_axis_vectors.toml";

/// X, Y, Z, A, C of the tip at the end of each block: far from the tool standing along C.
const PLACES: [[f64; 5]; 6] = [
    [20.0, 10.0, 40.0, -30.0, 20.0],
    [20.0, 10.0, 5.0, -30.0, 20.0],
    [30.0, 12.0, 5.0, -35.0, 42.0],
    [38.0, 5.0, 4.0, -42.0, 75.0],
    [30.0, -15.0, 4.5, -35.0, 110.0],
    [30.0, -15.0, 46.0, -35.0, 110.0],
];

/// How a program says where the tool points.
#[derive(Clone, Copy, PartialEq)]
enum Said {
    Angles,
    Vectors,
}

/// The cut in the words of a dialect.
fn program(dialect: &str, said: Said) -> String {
    let siemens = dialect == "sinumerik";
    let (on, off) = match (dialect, said) {
        ("fanuc", Said::Angles) => ("G43.4 H1", "G49"),
        ("fanuc", Said::Vectors) => ("G43.5 H1", "G49"),
        ("linuxcnc", _) => ("G43 H1\nM428", "M429\nG49"),
        _ => ("TRAORI", "TRAFOOF"),
    };
    let equals = if siemens { "=" } else { "" };
    let mut text = format!(
        "G17 G90 G94 G54 G{}\nG0 A{equals}-30.0 C{equals}20.0\n{on}\n",
        if siemens { 71 } else { 21 }
    );
    for (k, [x, y, z, a, c]) in PLACES.into_iter().enumerate() {
        let code = if k == 0 || k == 5 { "G0" } else { "G1" };
        write!(text, "{code} X{x:.3} Y{y:.3} Z{z:.3}").expect("a string takes all");
        // On this table: Rz(-C) Rx(-A) z.
        let ((sin_a, cos_a), (sin_c, cos_c)) =
            (units::math::sin_cos(a.to_radians()), units::math::sin_cos(c.to_radians()));
        let [i, j, l] = [sin_a * sin_c, sin_a * cos_c, cos_a];
        match (said, siemens) {
            (Said::Angles, _) => write!(text, " A{equals}{a:.3} C{equals}{c:.3}"),
            (Said::Vectors, true) => write!(text, " A3={i:.9} B3={j:.9} C3={l:.9}"),
            (Said::Vectors, false) => write!(text, " I{i:.9} J{j:.9} K{l:.9}"),
        }
        .expect("a string takes all");
        text += if k == 1 { " F600\n" } else { "\n" };
    }
    text + off + "\nM30\n"
}

struct Place(tempfile::TempDir);

impl Place {
    fn new(text: &str) -> Self {
        let place = Self(tempfile::tempdir().expect("a temporary folder"));
        std::fs::write(place.path("in.nc"), text).expect("writable");
        place
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }
}

fn json(path: &str) -> serde_json::Value {
    serde_json::from_slice(&std::fs::read(path).expect("readable")).expect("JSON")
}

/// Corrects a program and checks it; the summary and what the check says.
fn corrected(place: &Place, dialect: &str, orientation: &str) -> (serde_json::Value, serde_json::Value) {
    let [from, to, summary] = ["in.nc", "out.nc", "summary.json"].map(|name| place.path(name));
    let options = ["-m", PROFILE, "-d", dialect, "--orientation", orientation];
    let ran = run(&[&[from.as_str(), "-o", &to, "--summary", &summary], &options[..]].concat());
    assert!(ran.status.success(), "{dialect}: {}", messages(&ran));
    let check = run(&[&["check", from.as_str(), &to, "--json"], &options[..]].concat());
    let said: serde_json::Value = serde_json::from_slice(&check.stdout).expect("JSON");
    assert!(check.status.success(), "{dialect} {orientation}: {said}");
    (json(&summary), said)
}

#[test]
fn with_full_the_tool_points_where_the_program_says() {
    for dialect in ["fanuc", "linuxcnc", "sinumerik"] {
        let place = Place::new(&program(dialect, Said::Angles));
        let (tip_alone, said) = corrected(&place, dialect, "xyz");
        let left = |value: &serde_json::Value, key: &str| value[key].as_f64().expect("a number");
        assert!(left(&tip_alone, "tilt_urad") > 60.0, "{tip_alone}");
        assert!((left(&said, "tilt_after_urad") - left(&said, "tilt_before_urad")).abs() < 2.0, "{said}");
        let (summary, said) = corrected(&place, dialect, "full");
        assert_eq!(summary["orientation"], "full");
        assert!(
            left(&summary, "tilt_before_urad") > 60.0 && left(&summary, "tilt_urad") <= 50.0,
            "{summary}"
        );
        assert!(summary.get("directions_held").is_none(), "{summary}");
        assert!(left(&said, "tilt_before_urad") > 60.0 && left(&said, "tilt_after_urad") <= 50.0, "{said}");
        assert!(left(&said, "deviation_after_um") < 2.0, "{said}");
        // Seen as a correction of the tip alone its rotary axes stand elsewhere.
        let [from, to] = ["in.nc", "out.nc"].map(|name| place.path(name));
        let check = run(&["check", &from, &to, "-m", PROFILE, "-d", dialect]);
        assert_eq!(check.status.code(), Some(1), "{}", String::from_utf8_lossy(&check.stdout));
        // And a program that was not corrected does not pass for one that was.
        let check = run(&["check", &from, &from, "-m", PROFILE, "-d", dialect, "--orientation", "full"]);
        assert_eq!(check.status.code(), Some(1), "{}", String::from_utf8_lossy(&check.stdout));
    }
}

#[test]
fn a_damaged_direction_is_found() {
    let place = Place::new(&program("fanuc", Said::Angles));
    corrected(&place, "fanuc", "full");
    let made = std::fs::read_to_string(place.path("out.nc")).expect("readable");
    let damaged = |by: f64| {
        let line = made.lines().find(|line| line.contains("X38.")).expect("the block of X38");
        let at = line.find('C').expect("C") + 1;
        let end = line[at..].find(' ').map_or(line.len(), |end| at + end);
        let c: f64 = line[at..end].parse().expect("a number");
        let other = format!("{}{:.3}{}", &line[..at], c + by, &line[end..]);
        std::fs::write(place.path("damaged.nc"), made.replace(line, &other)).expect("writable");
        let check = run(&[
            "check",
            &place.path("in.nc"),
            &place.path("damaged.nc"),
            "-m",
            PROFILE,
            "--orientation",
            "full",
        ]);
        (check.status.code(), String::from_utf8_lossy(&check.stdout).into_owned())
    };
    for by in [0.02, 1.0, 360.0] {
        let (status, said) = damaged(by);
        assert_eq!(status, Some(1), "{by}: {said}");
    }
}

/// The end of a rapid is where the tool stands before it cuts, with rotary axes aside as without.
#[test]
fn a_damaged_rapid_is_found() {
    let led = program("fanuc", Said::Angles);
    let led = led.replace("G0 X30.000 Y-15.000 Z46.000 A-35.000 C110.000", "G0 Z46.");
    let led = led.replace("G49\n", "G49\nG0 Z200.\n");
    let axes = led.replace("G43.4 H1", "G43 H1");
    for text in [led, axes] {
        let place = Place::new(&text);
        corrected(&place, "fanuc", "full");
        let made = std::fs::read_to_string(place.path("out.nc")).expect("readable");
        let rapids: Vec<&str> =
            made.lines().filter(|line| line.starts_with("G0 ") && line.contains('Z')).collect();
        assert_eq!(rapids.len(), 3, "{made}");
        for (line, letter) in rapids.iter().flat_map(|line| ['X', 'Y', 'Z'].map(|letter| (*line, letter))) {
            let Some((before, behind)) = line.split_once(letter) else { continue };
            let (number, rest) = behind.split_at(behind.find(' ').unwrap_or(behind.len()));
            let mm: f64 = number.parse().expect("a number");
            for by in [0.1, -0.1] {
                let other = format!("{before}{letter}{:.3}{rest}", mm + by);
                std::fs::write(place.path("damaged.nc"), made.replacen(line, &other, 1)).expect("writable");
                let [from, to] = ["in.nc", "damaged.nc"].map(|name| place.path(name));
                let check = run(&["check", &from, &to, "-m", PROFILE, "--orientation", "full"]);
                assert_eq!(check.status.code(), Some(1), "{line}: {letter} {by}");
            }
        }
    }
}

#[test]
fn near_a_singularity_the_lines_are_named() {
    let text = "G21 G17 G90 G94 G54\nG0 A-30. C20.\nG43.4 H1\nG0 X20. Y10. Z40. A-30. C20.\nG1 Z5. F600.\nX25. A0.\nX30. A20.\nG0 Z50.\nG49\nM30\n";
    let place = Place::new(text);
    let tables = crate::common::root().join("tests/profiles");
    let profile = std::fs::read_to_string(crate::common::root().join(PROFILE)).expect("readable");
    let profile = profile.replace("\"wavy_", &format!("\"{}/wavy_", tables.display()));
    std::fs::write(place.path("machine.toml"), profile + "\n[correction]\norientation_urad = 20.0\n")
        .expect("writable");
    let [from, to, machine, summary] =
        ["in.nc", "out.nc", "machine.toml", "summary.json"].map(|name| place.path(name));
    let options = ["-m", machine.as_str(), "--orientation", "full"];
    let ran = run(&[&[from.as_str(), "-o", &to, "--summary", &summary], &options[..]].concat());
    let said = messages(&ran);
    assert!(ran.status.success() && said.contains("warning[VP0534]") && said.contains("lines 6-7"), "{said}");
    assert_eq!(json(&summary)["directions_held"]["lines"], serde_json::json!([[6, 7]]));
    let check = run(&[&["check", from.as_str(), &to], &options[..]].concat());
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
}

#[test]
fn vectors_are_cut_as_the_angles_are() {
    for (dialect, words) in [("fanuc", [" I", " J", " K"]), ("sinumerik", [" A3=", " B3=", " C3="])] {
        for orientation in ["xyz", "full"] {
            let [angles, vectors] =
                [Said::Angles, Said::Vectors].map(|said| Place::new(&program(dialect, said)));
            corrected(&angles, dialect, orientation);
            corrected(&vectors, dialect, orientation);
            let made = std::fs::read_to_string(vectors.path("out.nc")).expect("readable");
            let feeds: Vec<&str> = made
                .lines()
                .filter(|line| line.contains('X') && !line.starts_with(['G', ';', '(']))
                .collect();
            assert!(made.lines().count() > 12 && !feeds.is_empty(), "{made}");
            assert!(words.iter().all(|word| feeds.iter().any(|line| line.contains(word))), "{made}");
            // No angle is written where the program has none.
            assert!(
                !feeds
                    .iter()
                    .any(|line| line.contains(" A-") || line.contains(" C1") || line.contains(" A=")),
                "{made}"
            );
            // Twins of one part: each output cuts what the other program says. On Fanuc another code says so.
            for (from, to) in [(&angles, &vectors), (&vectors, &angles)] {
                let [from, to] = [from.path("in.nc"), to.path("out.nc")];
                let options = ["-m", PROFILE, "-d", dialect, "--orientation", orientation];
                let check = run(&[&["check", from.as_str(), &to], &options[..]].concat());
                let said = String::from_utf8_lossy(&check.stdout).into_owned();
                let other = |line: &&str| line.starts_with("- ") && !line.contains("G43.4");
                assert_eq!(said.lines().find(other), None, "{dialect} {orientation}: {said}");
                assert_eq!(check.status.success(), dialect == "sinumerik", "{said}");
            }
        }
    }
}

#[test]
fn a_perfect_machine_keeps_every_byte() {
    let profile = std::fs::read_to_string(crate::common::root().join(PROFILE)).expect("readable");
    let keeps = |line: &&str| {
        !line.contains("_um")
            && !line.contains("_urad")
            && !line.starts_with("errors")
            && !line.contains("centres_mm")
    };
    let mut perfect: Vec<&str> = profile.lines().filter(keeps).collect();
    perfect.push("centres_mm = { A = [5.0, 150.0, 120.0], C = [5.0, 150.0, 160.0] }");
    for (dialect, said) in [
        ("fanuc", Said::Angles),
        ("fanuc", Said::Vectors),
        ("linuxcnc", Said::Angles),
        ("sinumerik", Said::Angles),
        ("sinumerik", Said::Vectors),
    ] {
        for orientation in ["xyz", "full"] {
            let text = program(dialect, said);
            let place = Place::new(&text);
            std::fs::write(place.path("machine.toml"), perfect.join("\n")).expect("writable");
            let ran = run(&[
                &place.path("in.nc"),
                "-m",
                &place.path("machine.toml"),
                "-d",
                dialect,
                "--orientation",
                orientation,
            ]);
            assert!(ran.status.success(), "{}", messages(&ran));
            assert_eq!(String::from_utf8_lossy(&ran.stdout), text, "{dialect} {orientation}");
        }
    }
}

#[test]
fn what_has_no_direction_is_refused_by_name() {
    let start = "G21 G90 G94 G54 G0 A-20. C20.\n";
    let under = |middle: &str| {
        format!("{start}G43.5 H1\nG0 X0. Y0. Z50. I-0.117 J-0.321 K0.94\n{middle}\nG49\nM30\n")
    };
    let siemens = |middle: &str| format!("G71 G90 G94 G54\nG0 A=-20 C=20\n{middle}\nM30\n");
    for (dialect, text, code, says) in [
        ("fanuc", under("G1 X10. I0. J0. K0. F100."), "VP0262", "no length"),
        ("fanuc", under("G1 X10. A-10. F100."), "VP0260", "A under G43.5"),
        ("fanuc", under("G2 X10. I5. J0. F100."), "VP0260", "an arc under G43.5"),
        ("fanuc", under("G1 X10. I0. J0. K-1. F100."), "VP0263", "no angles within travel"),
        (
            "fanuc",
            format!(
                "{start}G43.5 H1\nG0 X0. Y0. Z50. I0. J0. K1.\nG1 X10. I0.3 J-0.2 K0.9 F100.\nG49\nM30\n"
            ),
            "VP0263",
            "the tool stands along C",
        ),
        (
            "sinumerik",
            siemens("G0 X0 Y0 Z50\nG1 X10 A3=0 B3=0 C3=1 F100"),
            "VP0260",
            "without tool centre point control",
        ),
        (
            "sinumerik",
            siemens("TRAORI\nG0 X0 Y0 Z50\nG1 X10 A3=0 B3=0.1 C3=1 A=5 F100"),
            "VP0260",
            "beside A",
        ),
        ("sinumerik", siemens("TRAORI\nG0 X0 Y0 Z50\nG1 X10 A3=NAN B3=0.1 C3=1 F100"), "VP0", "A3"),
        ("sinumerik", siemens("TRAORI\nORIVECT\nG0 X0 Y0 Z50\nG1 X10 F100"), "VP0", "ORIVECT"),
    ] {
        let place = Place::new(&text);
        let ran = run(&[&place.path("in.nc"), "-m", PROFILE, "-d", dialect]);
        assert_eq!(ran.status.code(), Some(1), "{text}: {}", messages(&ran));
        let said = messages(&ran);
        assert!(said.contains(code) && said.contains(says), "{text}: {said}");
    }
    // What the control does between two directions has to be said.
    let place = Place::new(&program("fanuc", Said::Vectors));
    let ran = run(&[&place.path("in.nc"), "-m", "tests/profiles/five_axis.toml"]);
    assert!(ran.status.code() == Some(1) && messages(&ran).contains("VP0261"), "{}", messages(&ran));
    // Directions are for two rotary axes, and for no plane.
    let three =
        run(&[&place.path("in.nc"), "-m", "machine-profiles/stan_s500.toml", "--orientation", "full"]);
    assert!(
        three.status.code() == Some(2) && messages(&three).contains("two rotary axes"),
        "{}",
        messages(&three)
    );
    let plane = Place::new(
        "G17 G21 G90 G94 G54\nG0 A-30. C0.\nG68.2 X20. Y10. Z5. I0. J30. K0.\nG0 X0. Y0.\nG43 H1 Z40.\nG1 Z2. F600.\nG69\nM30\n",
    );
    let ran = run(&[&plane.path("in.nc"), "-m", PROFILE, "--orientation", "full"]);
    assert!(ran.status.code() == Some(1) && messages(&ran).contains("VP0541"), "{}", messages(&ran));
}
