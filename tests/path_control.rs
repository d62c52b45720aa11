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
    assert!(said.ends_with("the control adds up to 100.0 um at corners (line 4)\npassed\n"), "{said}");
    let strict = shop.0.refused(&program, &["-m", &profile, "--strict"]);
    assert!(strict.starts_with("error[VP0529]") && strict.contains("write G61 before it"), "{strict}");
}
