//! What must stay one block: feeds under cutter compensation, which the control offsets block by block; and holes that are
//! left at feed, where nothing hides what a turn does.

use crate::common::{Place, messages, run};

impl Place {
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
    let ran = run(&[&program, "-m", &place.machine(10.0, ""), START, "-o", &out, "--accept", "5"]);
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

/// A machine bent along X, the bend in the middle of its travel: a line across X250 of the machine needs two.
fn bent(place: &Place, tool: &str) -> String {
    place.write("bent.csv", "position_mm,EYX_um\n-100,0\n250,50\n600,0\n");
    let axis = |name: &str, more: &str| {
        format!("axis.{name} = {{ travel_mm = [-100, 600], resolution_mm = 0.001{more} }}\n")
    };
    let text = format!(
        "format = 1\nname = \"bent\"\ncontrol = \"fanuc\"\nchain = \"[w X Y b Z t]\"\n{}{}{}\
         work_offsets_mm = {{ G54 = [100, 100, 100] }}\ntool = {{ default_mm = [0, 0, -90]{tool} }}\n",
        axis("X", ", errors = \"bent.csv\""),
        axis("Y", ""),
        axis("Z", ""),
    );
    place.write("machine.toml", &text)
}

const RADIUS: &str = ", radii_mm = { D1 = 6.35 }";

/// Onto the contour, along its two long sides, off it.
const PLATE: &str = "%\nG21 G90 G54 G17\nG0 X10. Y10. Z20.\nG1 Z-1. F100.\nG41 D1 G1 X30. F300.\nY40.\nX300.\nG2 X310. Y30. R10.\nG1 Y10.\nX20.\nG40 Y0.\nG0 Z50.\nM30\n%\n";

#[test]
fn long_blocks_under_compensation_become_pieces_where_the_radius_is_known() {
    let place = Place::new();
    let program = place.write("in.nc", PLATE);
    let out = place.0.path().join("out.nc").display().to_string();
    let ran = run(&[&program, "-m", &bent(&place, ""), START, "-o", &out]);
    assert_eq!(ran.status.code(), Some(1), "{}", messages(&ran));
    assert!(messages(&ran).contains("VP0503") && messages(&ran).contains("radii_mm"), "{}", messages(&ran));
    let machine = bent(&place, RADIUS);
    let ran = run(&[&program, "-m", &machine, START, "-o", &out]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let made = std::fs::read_to_string(&out).expect("written");
    // A block more for each side that crosses the bend; nothing in front of the start-up or the end.
    let blocks = |text: &str| text.lines().filter(|line| !line.starts_with('(')).count();
    assert_eq!(blocks(&made), blocks(PLATE) + 2, "{made}");
    let check = run(&["check", &program, &out, "-m", &machine, START]);
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
    // Another D is another radius.
    let other = place.write("other.nc", &PLATE.replace("D1", "D2"));
    let ran = run(&[&other, "-m", &machine, START, "-o", &out]);
    assert!(messages(&ran).contains("VP0503"), "{}", messages(&ran));
}

/// Where the machine climbs too, the pieces of a level block do.
#[test]
fn pieces_that_climb_by_the_machine_s_error_are_pieces_to_check() {
    let place = Place::new();
    let program = place.write("in.nc", PLATE);
    let out = place.0.path().join("out.nc").display().to_string();
    let machine = bent(&place, RADIUS);
    place.write("bent.csv", "position_mm,EYX_um,EZX_um\n-100,0,-30\n250,50,40\n600,0,10\n");
    let ran = run(&[&program, "-m", &machine, START, "-o", &out]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let made = std::fs::read_to_string(&out).expect("written");
    assert!(made.lines().count() > PLATE.lines().count() + 2 && made.contains("Z-1.0"), "{made}");
    let check = run(&["check", &program, &out, "-m", &machine, START]);
    assert!(check.status.success(), "{}\n{made}", String::from_utf8_lossy(&check.stdout));
}

#[test]
fn what_leads_onto_a_contour_or_off_it_stays_one_block() {
    let place = Place::new();
    let out = place.0.path().join("out.nc").display().to_string();
    let machine = bent(&place, RADIUS);
    let refused = |name: &str, text: &str, line: &str| {
        let program = place.write(name, text);
        let ran = run(&[&program, "-m", &machine, START, "-o", &out]);
        let said = messages(&ran);
        assert!(said.contains("VP0503") && said.contains(&format!("{name}:{line}:")), "{said}");
    };
    let head = "%\nG21 G90 G54 G17\nG0 X10. Y10. Z20.\nG1 Z-1. F100.\n";
    refused("on.nc", &format!("{head}G41 D1 G1 X300. F300.\nY40.\nG40 X310.\nG0 Z50.\nM30\n%\n"), "5");
    // G41 and G40 without a motion: the next one leads onto the contour, or off it.
    refused("on_alone.nc", &format!("{head}G41 D1\nG1 X300. F300.\nY40.\nG40 X310.\nG0 Z50.\nM30\n%\n"), "6");
    refused("off.nc", &format!("{head}G41 D1 G1 X30. F300.\nY40.\nG40 X300.\nG0 Z50.\nM30\n%\n"), "7");
    refused("off_alone.nc", &format!("{head}G41 D1 G1 X30. F300.\nY40.\nG40\nX300.\nG0 Z50.\nM30\n%\n"), "8");
}

#[test]
fn check_finds_a_piece_too_short_for_the_cutter() {
    let place = Place::new();
    let program = place.write("in.nc", PLATE);
    let machine = bent(&place, RADIUS);
    let flat = place.write(
        "flat.toml",
        &std::fs::read_to_string(&machine).expect("written").replace(", errors = \"bent.csv\"", ""),
    );
    for (piece, status) in [("X150.", 0), ("X299.9", 1)] {
        let made = place.write("out.nc", &PLATE.replace("\nX300.\n", &format!("\n{piece}\nX300.\n")));
        let found = run(&["check", &program, &made, "-m", &flat, START]);
        assert_eq!(found.status.code(), Some(status), "{piece}: {}", String::from_utf8_lossy(&found.stdout));
    }
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
    let ran = run(&[&program, "-m", &machine, START, "-o", &out, "--accept", "0"]);
    assert_eq!(ran.status.code(), Some(1), "{}", messages(&ran));
    assert!(messages(&ran).contains("in.nc:4:"), "{}", messages(&ran));
    // Drilled and left by a rapid, it is one hole.
    let program = place.write("drill.nc", &bore.replace("G85", "G81"));
    let ran = run(&[&program, "-m", &machine, START, "-o", &out]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let check = run(&["check", &program, &out, "-m", &machine, START]);
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
}
