//! `--guard`: the output asks the control for what it was corrected for, and LinuxCNC's interpreter stops where it differs.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

use crate::common::{have_interpreter, messages, run};

const PROGRAM: &str = "G21 G17 G40 G49 G80 G90 G94 G54\nG0 X10. Y10.\nG43 H1 Z80.\nX30. Y20. Z3.\nG1 Z-2. F400.\nX40.\nG0 Z20.\nG55\nG0 X10. Y10.\nG1 Z-1. F100.\nG0 Z20.\nM30\n";

const START: &str = "--start-at=20,20,400";

struct Place(tempfile::TempDir);

impl Place {
    fn new(control: &str) -> Self {
        let place = Self(tempfile::tempdir().expect("a temporary folder"));
        let axis =
            |name: &str| format!("axis.{name} = {{ travel_mm = [-100, 600], resolution_mm = 0.001 }}\n");
        let text = format!(
            "format = 1\nname = \"guarded\"\ncontrol = \"{control}\"\nchain = \"[w X Y b Z t]\"\n{}{}{}\
             squareness = {{ EC0Y_urad = 100 }}\nwork_offsets_mm = {{ G54 = [95, 88, 60], G55 = [195.5, 88.25, 61] }}\n\
             tool = {{ lengths_mm = {{ H1 = 80 }} }}\n",
            axis("X"),
            axis("Y"),
            axis("Z"),
        );
        std::fs::write(place.path("machine.toml"), text).expect("writable");
        std::fs::write(place.path("in.nc"), PROGRAM).expect("writable");
        place
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_str().expect("a plain path").to_owned()
    }

    fn guarded(&self) -> String {
        let [from, to, machine] = ["in.nc", "out.nc", "machine.toml"].map(|name| self.path(name));
        let ran = run(&[&from, "-m", &machine, START, "--guard", "-o", &to]);
        assert!(ran.status.success(), "{}", messages(&ran));
        let check = run(&["check", &from, &to, "-m", &machine, START]);
        assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
        std::fs::read_to_string(&to).expect("written")
    }
}

#[test]
fn a_batch_puts_the_same_guards() {
    let place = Place::new("linuxcnc");
    let one = place.guarded();
    let [programs, outputs, machine] = ["programs", "outputs", "machine.toml"].map(|name| place.path(name));
    std::fs::create_dir(&programs).expect("writable");
    std::fs::write(Path::new(&programs).join("in.nc"), PROGRAM).expect("writable");
    let batch = |more: &[&str]| {
        let ran = run(&[&["batch", &programs, "-O", &outputs, "-m", &machine, START], more].concat());
        assert!(ran.status.success(), "{}", messages(&ran));
        std::fs::read_to_string(Path::new(&outputs).join("in.nc")).expect("written")
    };
    assert_eq!(batch(&["--guard"]), one);
    // Another job: what an earlier run left does not stand for it.
    assert!(!batch(&[]).contains("VPOST GUARD"));
}

#[test]
fn a_fanuc_program_asks_for_each_work_offset_once() {
    let made = Place::new("fanuc").guarded();
    let guards: Vec<&str> = made.lines().filter(|line| line.contains("VPOST GUARD")).collect();
    assert_eq!(guards.len(), 6, "{made}");
    assert_eq!(guards[0], "IF[ABS[#5221+#5201-[95.]]GT0.0005]#3000=1(VPOST GUARD G54 X)");
    assert_eq!(guards[3], "IF[ABS[#5241+#5201-[195.5]]GT0.0005]#3000=1(VPOST GUARD G55 X)");
    // Before anything moves with it.
    let lines: Vec<&str> = made.lines().collect();
    let at = |text: &str| lines.iter().position(|line| line.starts_with(text)).expect("there");
    assert_eq!((at("IF[ABS[#5221"), at("IF[ABS[#5241")), (at("G21") + 1, at("G55") + 1), "{made}");
    // Without the option nothing is asked.
    let place = Place::new("fanuc");
    let plain = run(&[&place.path("in.nc"), "-m", &place.path("machine.toml"), START]);
    assert!(!String::from_utf8_lossy(&plain.stdout).contains("VPOST GUARD"));
}

#[test]
fn an_offset_that_nobody_chose_is_asked_for_before_the_first_motion() {
    let place = Place::new("fanuc");
    std::fs::write(place.path("in.nc"), PROGRAM.replace(" G54\n", "\n")).expect("writable");
    let made = place.guarded();
    assert!(made.contains("#3000=3(VPOST GUARD G54 Z)\nG0 X10"), "{made}");
}

#[test]
fn what_cannot_be_asked_is_refused() {
    let place = Place::new("perspektiva");
    let ran = run(&[&place.path("in.nc"), "-m", &place.path("machine.toml"), START, "--guard"]);
    assert_eq!(ran.status.code(), Some(2), "{}", messages(&ran));
    assert!(messages(&ran).contains("no way is known to ask dialect perspektiva"), "{}", messages(&ran));
    let place = Place::new("fanuc");
    let choosing =
        PROGRAM.replace("G1 Z-2. F400.\nX40.\n", "G1 Z-2. F400.\nG41 D1 X40.\nG55 X41.\nG40 X30.\n");
    std::fs::write(place.path("in.nc"), choosing).expect("writable");
    let ran = run(&[&place.path("in.nc"), "-m", &place.path("machine.toml"), START, "--guard"]);
    assert_eq!(ran.status.code(), Some(1), "{}", messages(&ran));
    assert!(messages(&ran).contains("VP0520") && messages(&ran).contains("in.nc:7:"), "{}", messages(&ran));
}

/// Feeds that LinuxCNC's interpreter makes of a program, with what its tables hold; `None` where it stops.
///
/// * `offsets_mm` – G54, G55; `turn_deg` of G54
fn feeds(
    program: &str,
    folder: &Path,
    offsets_mm: [[f64; 3]; 2],
    turn_deg: f64,
    length_mm: f64,
) -> Option<usize> {
    // The interpreter alone counts in inches.
    let inch = |mm: f64| mm / 25.4;
    let mut variables = String::new();
    for number in [5161, 5162, 5163, 5181, 5182, 5183, 5210, 5211, 5212, 5213, 5220] {
        writeln!(variables, "{number}\t{}", i32::from(number == 5220)).expect("text");
    }
    for (k, offset) in offsets_mm.iter().enumerate() {
        for (axis, mm) in offset.iter().enumerate() {
            writeln!(variables, "{}\t{:.9}", 5221 + 20 * k + axis, inch(*mm)).expect("text");
        }
        writeln!(variables, "{}\t{}", 5230 + 20 * k, if k == 0 { turn_deg } else { 0.0 }).expect("text");
    }
    std::fs::write(folder.join("machine.var"), variables).expect("writable");
    std::fs::write(folder.join("tool.tbl"), format!("T1 P1 Z{:.9}\n", inch(length_mm))).expect("writable");
    let ran = Command::new("rs274")
        .current_dir(folder)
        // Its tool table is shared through the home folder.
        .env("HOME", folder)
        .args(["-v", "machine.var", "-t", "tool.tbl", "-g", program])
        .output()
        .expect("the interpreter starts");
    let said = String::from_utf8_lossy(&ran.stdout);
    ran.status.success().then(|| said.matches("STRAIGHT_FEED").count())
}

#[test]
fn linuxcnc_stops_where_offset_turn_or_length_is_another() {
    let place = Place::new("linuxcnc");
    let made = place.guarded();
    assert_eq!(made.matches("(abort, VPOST GUARD").count(), 11, "{made}");
    if !have_interpreter() {
        return;
    }
    let (g54, g55) = ([95.0, 88.0, 60.0], [195.5, 88.25, 61.0]);
    let feeds =
        |offsets_mm, turn_deg, length_mm| feeds("out.nc", place.0.path(), offsets_mm, turn_deg, length_mm);
    let right = feeds([g54, g55], 0.0, 80.0);
    assert!(right.is_some_and(|count| count == 3), "{right:?}");
    for axis in 0..3 {
        for by_mm in [0.001, -0.001] {
            let (mut one, mut other) = (g54, g55);
            one[axis] += by_mm;
            other[axis] += by_mm;
            assert_eq!(feeds([one, g55], 0.0, 80.0), None, "G54 {axis} {by_mm}");
            assert_eq!(feeds([g54, other], 0.0, 80.0), None, "G55 {axis} {by_mm}");
        }
    }
    assert_eq!(feeds([g54, g55], 0.01, 80.0), None, "a turned work offset");
    assert_eq!(feeds([g54, g55], 0.0, 80.001), None, "a longer tool");
}
