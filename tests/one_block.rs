//! What must stay one block: feeds under cutter compensation, which the control offsets block by block; and holes that are
//! left at feed, where nothing hides what a turn does.

use crate::common::{messages, run};

struct Place(tempfile::TempDir);

impl Place {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn write(&self, name: &str, text: &str) -> String {
        let path = self.0.path().join(name);
        std::fs::write(&path, text).expect("writable");
        path.to_str().expect("a plain path").to_owned()
    }

    /// A straight machine, with more said of its axes.
    fn machine(&self, play_um: f64, of_z: &str) -> String {
        let axis = |name: &str, more: &str| {
            format!("axis.{name} = {{ travel_mm = [-100, 600], resolution_mm = 0.001{more} }}\n")
        };
        let play = format!(", backlash_um = {play_um}");
        let text = format!(
            "format = 1\nname = \"one block\"\ncontrol = \"fanuc\"\nchain = \"[w X Y b Z t]\"\n{}{}{}\
             work_offsets_mm = {{ G54 = [100, 100, 100] }}\ntool = {{ default_mm = [0, 0, -90] }}\n",
            axis("X", &play),
            axis("Y", &play),
            axis("Z", of_z),
        );
        self.write("machine.toml", &text)
    }
}

const START: &str = "--start-at=20,20,400";

const POCKET: &str = "%\nG21 G90 G54 G17\nG0 X10. Y10. Z20.\nG1 Z-1. F100.\nG41 D1 G1 X30. F300.\nY40.\nX10.\nY20.\nG40 X5. Y10.\nG0 Z50.\nM30\n%\n";

#[test]
fn no_block_is_put_in_under_cutter_compensation() {
    let place = Place::new();
    let program = place.write("in.nc", POCKET);
    let out = place.0.path().join("out.nc").display().to_string();
    let ran = run(&[&program, "-m", &place.machine(10.0, ""), START, "-o", &out]);
    assert_eq!(ran.status.code(), Some(1), "{}", messages(&ran));
    // Where Y turns first.
    assert!(messages(&ran).contains("VP0503") && messages(&ran).contains("in.nc:7:"), "{}", messages(&ran));
    // Play of a micrometre needs none.
    let ran = run(&[&program, "-m", &place.machine(1.0, ""), START, "-o", &out]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let made = std::fs::read_to_string(&out).expect("written");
    assert_eq!(made.lines().count(), POCKET.lines().count(), "{made}");
}

#[test]
fn check_finds_a_block_put_in_under_cutter_compensation() {
    let place = Place::new();
    let program = place.write("in.nc", POCKET);
    let machine = place.machine(0.0, "");
    let same = run(&["check", &program, &program, "-m", &machine, START]);
    assert!(same.status.success(), "{}", String::from_utf8_lossy(&same.stdout));
    // Along the path, and no micrometre off.
    let made = place.write("out.nc", &POCKET.replace("\nX10.\n", "\nX29.99\nX10.\n"));
    let found = run(&["check", &program, &made, "-m", &machine, START]);
    let said = String::from_utf8_lossy(&found.stdout);
    assert_eq!(found.status.code(), Some(1), "{said}");
    assert!(said.contains("under cutter compensation line 8 of the corrected program"), "{said}");
}

#[test]
fn a_bore_left_at_feed_where_z_stands_elsewhere_on_its_way_up() {
    let place = Place::new();
    place.write("down.csv", "position_mm,EYZ_um\n-100,0\n600,0\n");
    place.write("up.csv", "position_mm,EYZ_um\n-100,6\n600,6\n");
    let machine = place.machine(0.0, ", errors = \"down.csv\", errors_negative = \"up.csv\"");
    let bore = "%\nG21 G90 G54 G17\nG0 X20. Y20. Z20.\nG99 G85 X20. Y20. Z-10. R2. F100.\nX40.\nG80\nG0 Z50.\nM30\n%\n";
    let program = place.write("in.nc", bore);
    let out = place.0.path().join("out.nc").display().to_string();
    let ran = run(&[&program, "-m", &machine, START, "-o", &out]);
    assert_eq!(ran.status.code(), Some(1), "{}", messages(&ran));
    assert!(messages(&ran).contains("in.nc:4:"), "{}", messages(&ran));
    // Drilled and left by a rapid, it is one hole.
    let program = place.write("drill.nc", &bore.replace("G85", "G81"));
    let ran = run(&[&program, "-m", &machine, START, "-o", &out]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let check = run(&["check", &program, &out, "-m", &machine, START]);
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
}
