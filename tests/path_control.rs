//! What the control adds to the path: said by the program, by the profile, or by nobody.

use crate::common::{Place, messages, run};

const CORNER: &str = "G0 X10. Y10. Z5.\nG1 Z0 F200.\nX40.\nY30.\nM30\n";

struct Shop(Place);

impl Shop {
    fn new() -> Self {
        Self(Place::new())
    }

    fn profile(&self, control: &str) -> String {
        let axes = ["X", "Y", "Z"].map(|axis| format!("axis.{axis} = {{ travel_mm = [-500, 500] }}\n"));
        let zero = "work_offsets_mm = { G54 = { at = [0, 0, 0], zero = \"true\" } }\n";
        let skew = "squareness = { EC0Y_urad = 200 }\n";
        let text = format!(
            "format = 1\nname = \"m\"\nchain = \"[w X Y b Z t]\"\ncontrol = {control}\n{}{zero}{skew}",
            axes.concat()
        );
        self.0.write("machine.toml", &text)
    }

    /// What the summary says that the control adds, µm, and what is warned of.
    fn said(&self, control: &str, program: &str) -> (serde_json::Value, String) {
        let (profile, summary) = (self.profile(control), self.0.write("summary.json", ""));
        let (_, said) = self.0.corrected(program, &["-m", &profile, "--summary", &summary]);
        let summary = std::fs::read_to_string(&summary).expect("it was written");
        let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
        (summary["control_um"].clone(), said)
    }
}

/// By dialect and how the program begins; `None`: nobody says.
const CASES: &[(&str, &str, Option<f64>)] = &[
    ("linuxcnc", "G21 G90 G54", None),
    ("linuxcnc", "G21 G90 G54 G64", None),
    ("linuxcnc", "G21 G90 G54 G64 P0", None),
    // Corners within P, lines merged within Q, which is P where it is not written.
    ("linuxcnc", "G21 G90 G54 G64 P0.05", Some(100.0)),
    ("linuxcnc", "G21 G90 G54 G64 P0.05 Q0.001", Some(51.0)),
    ("linuxcnc", "G20 G90 G54 G64 P0.001\nG21", Some(50.8)),
    ("linuxcnc", "G21 G90 G54 G61", Some(0.0)),
    ("linuxcnc", "G21 G90 G54 G61\nG64", None),
    // A switch that nobody sees.
    ("linuxcnc", "G21 G90 G54 G64 P0.05\n/G61", Some(100.0)),
    ("grbl", "G21 G90 G54", Some(0.0)),
    ("fanuc", "G21 G90 G54", None),
    ("fanuc", "G21 G90 G54 G61", Some(0.0)),
    ("fanuc", "G21 G90 G54 G61\nG5.1 Q1", None),
    ("haas", "G21 G90 G54\nG187 P3 E0.01", Some(10.0)),
    ("haas", "G21 G90 G54\nG187 P3", None),
    ("sinumerik", "G71 G90 G54", None),
    ("sinumerik", "G71 G90 G54\nCYCLE832(0.01)", Some(10.0)),
    ("sinumerik", "G71 G90 G54\nG60", Some(0.0)),
    ("perspektiva", "G21 G90 G54 G60", Some(0.0)),
];

#[test]
fn the_program_says_how_near_the_control_keeps() {
    let shop = Shop::new();
    for (dialect, start, expected) in CASES {
        let (um, said) = shop.said(&format!("\"{dialect}\""), &format!("{start}\n{CORNER}"));
        assert_eq!(um.as_f64(), *expected, "{dialect}: {start}\n{said}");
        let beyond = expected.is_none_or(|um| um > 1.0);
        assert_eq!(said.contains("warning[VP0529]"), beyond, "{dialect}: {start}\n{said}");
    }
}

#[test]
fn the_profile_says_what_the_control_does_where_the_program_does_not() {
    let shop = Shop::new();
    let control = |blending: &str| format!("{{ dialect = \"fanuc\", blending = {blending} }}");
    let program = format!("G21 G90 G54\n{CORNER}");
    for (blending, um) in [
        ("{ mode = \"exact-stop\" }", Some(0.0)),
        ("{ mode = \"tolerance\", tolerance_mm = 0.005 }", Some(5.0)),
        ("{ mode = \"unlimited\" }", None),
    ] {
        assert_eq!(shop.said(&control(blending), &program).0.as_f64(), um, "{blending}");
    }
    for wrong in [
        "{ mode = \"tolerance\" }",
        "{ mode = \"tolerance\", tolerance_mm = -1 }",
        "{ mode = \"exact-stop\", tolerance_mm = 0.01 }",
        "{ mode = \"tolerance\", tolerance = 0.01 }",
    ] {
        let ran = run(&["profile", "check", &shop.profile(&control(wrong))]);
        let said = messages(&ran);
        assert!(
            !ran.status.success() && said.contains("tolerance_mm") && said.contains("machine.toml:4:"),
            "{said}"
        );
    }
}

/// `check` names the control's part above its verdict; who wants certainty is refused.
#[test]
fn passed_is_of_the_machine() {
    let shop = Shop::new();
    let program = format!("G21 G90 G54 G64 P0.05\n{CORNER}");
    let profile = shop.profile("\"linuxcnc\"");
    let (corrected, _) = shop.0.corrected(&program, &["-m", &profile]);
    let [posted, corrected] =
        [("part.nc", &program), ("out.nc", &corrected)].map(|(name, text)| shop.0.write(name, text));
    let checked = run(&["check", &posted, &corrected, "-m", &profile]);
    let said = String::from_utf8_lossy(&checked.stdout).into_owned();
    assert!(
        said.ends_with("the control adds up to 100.0 um at corners (line 4)\npassed: the machine's part\n"),
        "{said}"
    );
    let strict = shop.0.refused(&program, &["-m", &profile, "--strict"]);
    assert!(
        strict.starts_with("error[VP0529]") && strict.contains("`--path-control exact` writes G61 before it"),
        "{strict}"
    );
}

const SWITCHED: &str =
    "G21 G90 G54 G64 P0.05\nG0 X10. Y10. Z5.\nG1 Z0 F200.\nX40.\nG64\nG2 X60. Y30. I0. J20.\nG0 Z5.\nM30\n";

/// Lines of a program that say how near the control keeps to the path.
fn modes(corrected: &str) -> Vec<&str> {
    corrected.lines().filter(|line| line.contains("G6")).collect()
}

/// Where asked for, what keeps the control to the path stands in front of the feeds that need it, and of no other.
#[test]
fn feeds_are_kept_to_the_path() {
    let shop = Shop::new();
    let profile = shop.profile("\"linuxcnc\"");
    for (how, wanted) in [
        ("keep", &["G21 G90 G54 G64 P0.05", "G64"][..]),
        ("exact", &["G21 G90 G54 G64 P0.05", "G61", "G64", "G61"]),
        // Half of 1 um is the control's: P and Q add up.
        ("tolerance", &["G21 G90 G54 G64 P0.05", "G64 P0.00025 Q0.00025", "G64", "G64 P0.00025 Q0.00025"]),
    ] {
        let asked = format!("--path-control={how}");
        let (corrected, said) = shop.0.corrected(SWITCHED, &["-m", &profile, &asked]);
        assert_eq!(modes(&corrected), wanted, "{corrected}");
        assert_eq!(said.contains("VP0529"), how == "keep", "{said}");
        let [posted, written] = [("posted.nc", SWITCHED), ("out.nc", &corrected)];
        let [posted, written] = [posted, written].map(|(name, text)| shop.0.write(name, text));
        let checked = run(&["check", &posted, &written, "-m", &profile, &asked]);
        let said = String::from_utf8_lossy(&checked.stdout);
        assert!(checked.status.success(), "{how}: {said}");
        assert_eq!(said.ends_with("\npassed\n"), how != "keep", "{how}: {said}");
    }
    // Inches, and what is near enough already.
    let inches = "G20 G90 G54 G64 P0.00001\nG0 X1. Y1. Z1.\nG1 Z0 F8.\nG21\nX40.\nM30\n";
    let (corrected, _) = shop.0.corrected(inches, &["-m", &profile, "--path-control=tolerance"]);
    assert_eq!(modes(&corrected), ["G20 G90 G54 G64 P0.00001", "G64 P0.000009 Q0.000009"]);
    let (corrected, _) =
        shop.0.corrected(inches, &["-m", &profile, "--path-control=tolerance", "--tolerance=2"]);
    assert_eq!(modes(&corrected), ["G20 G90 G54 G64 P0.00001"]);
}

#[test]
fn what_cannot_be_put_in_is_refused() {
    let shop = Shop::new();
    let exact = |control: &str, start: &str| {
        let profile = shop.profile(&format!("\"{control}\""));
        shop.0.refused(&format!("{start}\n{CORNER}"), &["-m", &profile, "--path-control=exact"])
    };
    let itself = exact("linuxcnc", "G21 G90 G54\nG0 X0 Y0 Z5.\nG64 G1 X5. F100.");
    assert!(itself.contains("error[VP0535]") && itself.contains("says otherwise itself"), "{itself}");
    let offset = exact("fanuc", "G21 G90 G54\nG0 X0 Y0 Z5.\nG41 D1");
    assert!(offset.contains("error[VP0535]") && offset.contains("write `G61` before G41"), "{offset}");
    for (control, how, said) in [
        ("heidenhain-iso", "exact", "no words by which it keeps to the path"),
        ("fanuc", "tolerance", "use `--path-control exact`"),
    ] {
        let (profile, program) =
            (shop.profile(&format!("\"{control}\"")), shop.0.write("wordless.nc", CORNER));
        let ran = run(&[&program, "-m", &profile, &format!("--path-control={how}")]);
        assert!(ran.status.code() == Some(2) && messages(&ran).contains(said), "{}", messages(&ran));
    }
}

/// What stops cost is said where the acceleration is known.
#[test]
fn stops_have_their_price() {
    let shop = Shop::new();
    let priced = |control: &str| {
        let (profile, summary) = (shop.profile(control), shop.0.write("summary.json", ""));
        let program = "G21 G90 G54\nG0 X10. Y10. Z5.\nG1 Z0 F6000.\nX40.\nX40.5\nM30\n";
        let asked = ["-m", &profile, "--path-control=exact", "--summary", &summary];
        shop.0.corrected(program, &asked);
        let summary = std::fs::read_to_string(&summary).expect("it was written");
        serde_json::from_str::<serde_json::Value>(&summary).expect("JSON")["stops"].clone()
    };
    let known = priced("{ dialect = \"linuxcnc\", acceleration_mm_s2 = 1000 }");
    // 100 mm/s by 1000 mm/s²: 10 mm to get there and as many to stop, 0.1 s more for 30 mm. 5 mm take 2 sqrt(5/1000) s
    // instead of 0.05 s, 0.5 mm 0.0447 instead of 0.005 s.
    assert_eq!(known["blocks"], 3);
    let seconds = known["seconds_at_most"].as_f64().expect("known");
    assert!((seconds - (0.1 + 0.141_42 - 0.05 + 0.044_72 - 0.005)).abs() < 1e-3, "{seconds}");
    assert!(priced("\"linuxcnc\"")["seconds_at_most"].is_null());
}

/// A control that cuts arcs as chords leaves them by what its rule makes of each.
#[test]
fn chords_of_arcs_are_the_controls_part() {
    let shop = Shop::new();
    // A half circle of radius 30: 94.2 mm.
    let program = "G21 G90 G54\nG0 X30. Y0. Z0.\nG3 X-30. Y0. I-30. J0. F500.\nM30\n";
    for (control, um) in [
        // 94 chords of 1.0026 mm, 188 of 0.501 mm.
        ("{ dialect = \"grbl\", arcs = { chord_mm = 1.0 } }", 4.189),
        ("{ dialect = \"grbl\", arcs = { chord_mm = 0.5 } }", 1.047),
        // 136.03 chords 2 um beside the arc, of which 136 are made.
        ("\"grbl\"", 2.001),
        ("{ dialect = \"grbl\", arcs = { tolerance_mm = 0.0005 } }", 0.5),
        ("{ dialect = \"linuxcnc\", blending = { mode = \"exact-stop\" } }", 0.0),
    ] {
        let (said_um, said) = shop.said(control, program);
        assert!((said_um.as_f64().expect("known") - um).abs() < 0.004 * um.max(0.1), "{control}: {said_um}");
        assert_eq!(said.contains("it cuts chords"), um > 1.0, "{said}");
    }
    for (wrong, expected) in [
        ("arcs = { chord_mm = 200 }", "chord_mm or tolerance_mm, above 0, up to 10"),
        ("arcs = {}", "chord_mm or tolerance_mm, above 0, up to 10"),
        ("arcs = { chord_mm = 1, tolerance_mm = 0.002 }", "chord_mm or tolerance_mm, above 0, up to 10"),
        ("acceleration_mm_s2 = 0", "acceleration_mm_s2 above 0"),
    ] {
        let ran = run(&["profile", "check", &shop.profile(&format!("{{ dialect = \"grbl\", {wrong} }}"))]);
        assert!(!ran.status.success() && messages(&ran).contains(expected), "{wrong}: {}", messages(&ran));
    }
}

/// Axes that lag cut corners and make arcs small, by what their loops make of F.
#[test]
fn axes_that_lag_are_the_controls_part() {
    let shop = Shop::new();
    let exact = "dialect = \"linuxcnc\", blending = { mode = \"exact-stop\" }";
    let program =
        |feed: &str| format!("G21 G90 G54\nG0 X30. Y0. Z0.\nG3 X-30. Y0. I-30. J0. {feed}\nG1 X-40.\nM30\n");
    let um = |loops: &str, feed: &str| {
        let (um, said) = shop.said(&format!("{{ {exact}, {loops} }}"), &program(feed));
        (um.as_f64(), said)
    };
    let near = |(um, said): (Option<f64>, String), expected: f64| {
        assert!(um.is_some_and(|um| (um - expected).abs() < 2e-3), "{um:?}, not {expected}: {said}");
        said
    };
    // 10 mm/s / (50 e) at a corner, 10²/(2 30 50²) on the arc; within 1 um at the corner with F8.15.
    let said = near(um("following = { gain_1_s = 50 }", "F600."), 73.576);
    assert!(said.contains("up to 73.6 um") && said.contains("F8 mm/min and slower"), "{said}");
    assert_eq!(said.matches("VP0529").count(), 1, "{said}");
    // Half the way of 20 mm/s² and 1/50²; where the control waits; the arc alone, with all fed forward but of Y.
    near(um("following = { gain_1_s = 50 }, acceleration_mm_s2 = 20", "F600."), 4.0);
    near(um("following = { gain_1_s = 50, in_position_mm = 0.002 }", "F600."), 2.0);
    let ahead = "following = { gain_1_s = [50, 50, 30], feed_forward = 1, in_position_mm = 0.00001 }";
    near(um(ahead, "F600."), 0.0);
    let said = near(um("following = { gain_1_s = 50, in_position_mm = 0.00001 }", "F1500."), 4.166);
    assert!(said.contains("F734 mm/min and slower"), "{said}");
    // F per turn says no speed; F in the middle of lines counts.
    let (unknown, said) = um("following = { gain_1_s = 50 }", "G95 F0.1 S1000 M3");
    assert!(unknown.is_none() && said.contains("is not known"), "{said}");
    let lines: String = (1..40).map(|k| format!("X{k}.5{}\n", if k == 20 { " F600." } else { "" })).collect();
    let lines = format!("G21 G90 G54\nG0 X0. Y0. Z0.\nG1 F60.\n{lines}X50. F60.\nM30\n");
    let slow = |program: &str| {
        let (um, said) = shop.said(&format!("{{ {exact}, following = {{ gain_1_s = 50 }} }}"), program);
        (um.as_f64(), said)
    };
    near(slow(&lines), 73.576);
    // An F that nothing is fed at does not.
    let unused = lines.replace("X20.5 F600.\n", "F600.\nX20.5 F60.\n");
    near(slow(&unused), 7.358);
    let (_, said) = um("following = { gain_1_s = 0.1 }", "F600.");
    assert!(said.contains("no F is known") && !said.contains("F0 mm/min"), "{said}");
    for (wrong, expected) in [
        ("{ gain_1_s = 0 }", "gain_1_s above 0, up to 1000"),
        ("{ gain_1_s = [50, 5000, 50] }", "gain_1_s above 0, up to 1000"),
        ("{ gain_1_s = 50, feed_forward = 1.5 }", "feed_forward from 0 to 1"),
        ("{ gain_1_s = 50, in_position_mm = 0 }", "in_position_mm above 0"),
    ] {
        let profile = shop.profile(&format!("{{ {exact}, following = {wrong} }}"));
        let ran = run(&["profile", "check", &profile]);
        assert!(!ran.status.success() && messages(&ran).contains(expected), "{wrong}: {}", messages(&ran));
    }
}
