//! Lengths and zeros as shops keep them: touched off, in tables, in files of the control.

use std::path::Path;

use crate::common::{messages, run};

const PROGRAM: &str = "G21 G17 G40 G49 G80 G90 G94 G54\nG0 X10. Y10.\nG43 H1 Z80.\nX30. Y20. Z3.\nG1 Z-2. F400.\nX140. Y90.\nG0 Z20.\nG43 H2 Z20.\nG1 X30. Z1.\nG0 Z80.\nM30\n";

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        let place = Self(tempfile::tempdir().expect("a temporary folder"));
        place.write("in.nc", PROGRAM);
        for axis in ["X", "Y", "Z"] {
            let rows: String = (0..=8)
                .map(|k| {
                    let at = f64::from(k);
                    format!("{},{},{},{}\n", at * 100.0, 3.0 * at, 2.0 * at - 0.2 * at * at, 4.0 - at)
                })
                .collect();
            place.write(
                &format!("{axis}.csv"),
                &format!("position_mm,E{axis}{axis}_um,EA{axis}_urad,EB{axis}_urad\n{rows}"),
            );
        }
        place
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }

    fn write(&self, name: &str, text: &str) {
        std::fs::write(Path::new(&self.path(name)), text).expect("writable");
    }

    /// A machine with errors of angle, and what is said of its tools.
    fn machine(&self, name: &str, tool: &str) -> String {
        let axis =
            |name: &str| format!("axis.{name} = {{ travel_mm = [0, 800], errors = \"{name}.csv\" }}\n");
        let [x, y, z] = ["X", "Y", "Z"].map(axis);
        self.write(
            name,
            &format!(
                "format = 1\nname = \"m\"\ncontrol = \"fanuc\"\nchain = \"[w X Y b Z t]\"\n{x}{y}{z}{tool}\n"
            ),
        );
        self.path(name)
    }

    /// The corrected program, or what is said.
    fn corrected(&self, machine: &str, more: &[&str]) -> Result<String, String> {
        let ran = run(&[&[self.path("in.nc").as_str(), "-m", machine], more].concat());
        if ran.status.success() {
            Ok(String::from_utf8_lossy(&ran.stdout).into_owned())
        } else {
            Err(messages(&ran))
        }
    }
}

#[test]
fn touched_off_lengths_give_the_program_of_true_ones() {
    let place = Place::new();
    let true_ones = place.machine(
        "true.toml",
        "work_offsets_mm = { G54 = [100, 80, 60] }\ntool = { lengths_mm = { H1 = 120, H2 = 95.5 } }",
    );
    let touched =
        "work_offsets_mm = { G54 = [100, 80, 530] }\ntool = { lengths_mm = { H1 = -350, H2 = -374.5 }";
    let unsaid = place.machine("unsaid.toml", &format!("{touched} }}"));
    let said = place.machine("said.toml", &format!("{touched}, spindle_nose_mm = -470 }}"));
    let of_true_ones = place.corrected(&true_ones, &[]).expect("corrected");
    assert!(
        of_true_ones.contains("vpost") || of_true_ones.contains("VPOST"),
        "nothing was corrected: {of_true_ones}"
    );
    assert_eq!(place.corrected(&said, &[]).expect("corrected"), of_true_ones);
    let refused = place.corrected(&unsaid, &[]).expect_err("how long the tools are is not said");
    assert!(refused.contains("VP0215") && refused.contains("spindle_nose_mm"), "{refused}");
    // A length does matter on this machine: what the refusal is for.
    let other = place.machine("other.toml", &format!("{touched}, spindle_nose_mm = -520 }}"));
    assert_ne!(place.corrected(&other, &[]).expect("corrected"), of_true_ones);
}
