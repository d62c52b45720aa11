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
        let ran = run(&[&[self.path("in.nc").as_str(), "-m", machine, "--zero", "true"], more].concat());
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
    let true_ones = place.machine("true.toml", TRUE_ONES);
    let touched =
        "work_offsets_mm = { G54 = [100, 80, 530] }\ntool = { lengths_mm = { H1 = -350, H2 = -374.5 }";
    let unsaid = place.machine("unsaid.toml", &format!("{touched} }}"));
    let said = place.machine("said.toml", &format!("{touched}, gauge_point_mm = -470 }}"));
    let of_true_ones = place.corrected(&true_ones, &[]).expect("corrected");
    assert!(
        of_true_ones.contains("vpost") || of_true_ones.contains("VPOST"),
        "nothing was corrected: {of_true_ones}"
    );
    assert_eq!(place.corrected(&said, &[]).expect("corrected"), of_true_ones);
    let refused = place.corrected(&unsaid, &[]).expect_err("how long the tools are is not said");
    assert!(refused.contains("VP0215") && refused.contains("gauge_point_mm"), "{refused}");
    // A length does matter on this machine: what the refusal is for.
    let other = place.machine("other.toml", &format!("{touched}, gauge_point_mm = -520 }}"));
    assert_ne!(place.corrected(&other, &[]).expect("corrected"), of_true_ones);
}

const TRUE_ONES: &str =
    "work_offsets_mm = { G54 = [100, 80, 60] }\ntool = { lengths_mm = { H1 = 120, H2 = 95.5 } }";
const OTHERS: &str =
    "work_offsets_mm = { G54 = [1, 2, 3] }\ntool = { lengths_mm = { H1 = 50, H2 = 60, H9 = 70 } }";

#[test]
fn a_table_stands_for_the_lengths_of_the_profile() {
    let place = Place::new();
    let wanted = place.corrected(&place.machine("true.toml", TRUE_ONES), &[]).expect("corrected");
    let machine = place.machine("others.toml", OTHERS);
    place.write("t.csv", "Инструмент;Длина, мм\nH1;120\nH2;95,5\n");
    place.write(
        "t.txt",
        "%\nO9000(OFFSETS)\nG21\nG10 L10 P1 R119.9\nG10 L11 P1 R0.1\nG10 L10 P2 R95.5\nM30\n%\n",
    );
    for name in ["t.csv", "t.txt"] {
        let table = format!("--tool-table={}", place.path(name));
        let of_table = place.corrected(&machine, &[&table, "--work-offset=G54=100,80,60"]);
        assert_eq!(of_table.expect("corrected"), wanted, "{name}");
    }
    // The command line goes before it; what it lacks the profile does not lend.
    place.write("t.csv", "tool,length_mm\n1,120\n2,1\n");
    let [table, zero] =
        [format!("--tool-table={}", place.path("t.csv")), "--work-offset=G54=100,80,60".to_owned()];
    assert_eq!(place.corrected(&machine, &[&table, &zero, "--tool=H2=95.5"]).expect("corrected"), wanted);
    place.write("in.nc", &PROGRAM.replace("H2", "H9"));
    let refused = place.corrected(&machine, &[&table, &zero]).expect_err("the table has no H9");
    assert!(refused.contains("tool length H9 is not given"), "{refused}");
}

#[test]
fn a_linuxcnc_machine_says_its_zeros_and_lengths() {
    let place = Place::new();
    let linuxcnc = ["-d", "linuxcnc"];
    let wanted = place.corrected(&place.machine("true.toml", TRUE_ONES), &linuxcnc).expect("corrected");
    let machine = place.machine("others.toml", OTHERS);
    std::fs::create_dir(place.path("config")).expect("writable");
    let ini = format!("--linuxcnc-ini={}", place.path("config/m.ini"));
    let with = [&linuxcnc[..], &[ini.as_str()]].concat();
    for (unit, mm) in [("inch", 25.4), ("mm", 1.0)] {
        place.write(
            "config/m.ini",
            &format!("[RS274NGC]\nPARAMETER_FILE = m.var\n[EMCIO]\nTOOL_TABLE = ../m.tbl\n[TRAJ]\nLINEAR_UNITS = {unit}\n"),
        );
        place.write("m.tbl", &format!("T1 P1 Z{:+.12} ;mill\nT2 P2 D6 Z{:.12}\n", 120.0 / mm, 95.5 / mm));
        let var =
            format!("5220 1\n5221 {:.12}\n5222 {:.12}\n5223 {:.12}\n", 100.0 / mm, 80.0 / mm, 60.0 / mm);
        place.write("config/m.var", &var);
        assert_eq!(place.corrected(&machine, &with).expect("corrected"), wanted, "{unit}");
    }
    // No zero of the profile's stands in for one that was never touched off.
    place.write("config/m.ini", "[EMCIO]\nTOOL_TABLE = ../m.tbl\n[TRAJ]\nLINEAR_UNITS = mm\n");
    let refused = place.corrected(&machine, &with).expect_err("no parameters");
    assert!(refused.contains("VP0214"), "{refused}");
    place.write("config/m.ini", "[TRAJ]\nLINEAR_UNITS = mm\n[RS274NGC]\nPARAMETER_FILE = n.var\n");
    let refused = place.corrected(&machine, &with).expect_err("no such file");
    assert!(refused.contains("n.var") && refused.contains("VP0001"), "{refused}");
    // Zeros of another machine, or in another unit.
    place.write(
        "config/m.ini",
        "[RS274NGC]\nPARAMETER_FILE = m.var\n[EMCIO]\nTOOL_TABLE = ../m.tbl\n[TRAJ]\nLINEAR_UNITS = inch\n",
    );
    place.write("m.tbl", "T1 P1 Z4.7\nT2 P2 Z3.7\n");
    place.write("config/m.var", "5220 1\n5221 100\n5222 3\n5223 2\n");
    let refused = place.corrected(&machine, &with).expect_err("a zero 2.5 m away");
    assert!(
        refused.contains("VP0501") && refused.contains("the program's zero is at X 2540.000 mm: is the"),
        "{refused}"
    );
    let russian = place.corrected(&machine, &[&with[..], &["--lang", "ru"]].concat()).expect_err("the same");
    assert!(
        russian.contains("нуль программы в X 2540.000 мм") && russian.contains("от этого станка"),
        "{russian}"
    );
    // Another control keeps no such files.
    let refused = place.corrected(&machine, &[&ini]).expect_err("a Fanuc");
    assert!(refused.contains("--linuxcnc-ini"), "{refused}");
    // Without its INI file a table has no unit.
    let table = format!("--tool-table={}", place.path("m.tbl"));
    let refused = place.corrected(&machine, &[&linuxcnc[..], &[&table]].concat()).expect_err("which unit?");
    assert!(refused.contains("VP0920") && refused.contains("--linuxcnc-ini FILE"), "{refused}");
}

#[test]
fn a_batch_corrects_anew_where_its_table_changed() {
    let place = Place::new();
    let machine = place.machine("m.toml", TRUE_ONES);
    std::fs::create_dir(place.path("in")).expect("writable");
    place.write("in/a.nc", PROGRAM);
    let table = format!("--tool-table={}", place.path("t.csv"));
    let batch = |lengths: &str| {
        place.write("t.csv", lengths);
        let ran = run(&["batch", &place.path("in"), "-O", &place.path("out"), "-m", &machine, &table]);
        assert!(ran.status.success(), "{}", messages(&ran));
        std::fs::read_to_string(place.path("out/a.nc")).expect("written")
    };
    let first = batch("tool,length_mm\nH1,120\nH2,95.5\n");
    assert_ne!(batch("tool,length_mm\nH1,220\nH2,95.5\n"), first);
    assert_eq!(batch("tool,length_mm\nH1,120\nH2,95.5\n"), first);
}
