//! Arcs whose radii differ at start and end: judged as the control does, and written so that it takes them.

use crate::common::{Place, messages, root, run};

const CROOKED: &str = "tests/profiles/corpus.toml";

/// A profile beside the tables of the crooked one, with more in it.
fn profile(place: &Place, change: impl Fn(String) -> String) -> String {
    for table in ["wavy_x.csv", "wavy_y.csv", "wavy_z.csv"] {
        let text = std::fs::read_to_string(root().join("tests/profiles").join(table)).expect("readable");
        place.write(table, &text);
    }
    let text = std::fs::read_to_string(root().join(CROOKED)).expect("readable");
    place.write("machine.toml", &change(text))
}

/// Words of two decimals, as many CAM systems write them; their ends are 0.010, 0.020 and 0.015 mm off their circle.
const TWO_DECIMALS: &str = "G21 G17 G90 G54\nG0 X30 Y20 Z60\nG1 Z50 F200\nG3 X21.35 Y35.01 I-8.66 J5\nG1 X30 Y20\nG3 X21.34 Y35.02 I-8.66 J5\nG1 X30 Y20\nG3 X21.34 Y35.015 I-8.66 J5\nG1 X40\nM2\n";

#[test]
fn one_warning_names_the_largest() {
    let place = Place::new();
    let program = place.write("part.ngc", TWO_DECIMALS);
    let out = place.write("out.ngc", "");
    let ran = run(&[&program, "-m", CROOKED, "-d", "linuxcnc", "-o", &out]);
    let said = messages(&ran);
    assert!(ran.status.success(), "{said}");
    assert_eq!(said.matches("VP0515").count(), 1, "{said}");
    assert!(said.contains("3 arc(s) end off their circle, the largest by 0.020 mm"), "{said}");
    assert!(said.contains("part.ngc:6:"), "{said}");
    let check = run(&["check", &program, &out, "-m", CROOKED, "-d", "linuxcnc"]);
    assert!(check.status.success(), "{}", String::from_utf8_lossy(&check.stdout));
}

#[test]
fn the_profile_may_say_what_its_control_takes() {
    let place = Place::new();
    let program = place.write("part.ngc", TWO_DECIMALS);
    let with = |rules: &str| {
        let profile = profile(&place, |text| text.replace("[program]\n", &format!("[program]\n{rules}\n")));
        run(&[&program, "-m", &profile, "-d", "perspektiva"])
    };
    let ran = run(&[&program, "-m", CROOKED, "-d", "perspektiva"]);
    assert!(messages(&ran).contains("VP0205"), "{}", messages(&ran));
    let ran = with("arc_tolerance_mm = 0.025");
    assert!(ran.status.success(), "{}", messages(&ran));
    let ran = with("arc_tolerance_mm = -1");
    assert!(
        ran.status.code() == Some(2) && messages(&ran).contains("arc_tolerance_mm is -1"),
        "{}",
        messages(&ran)
    );
}

/// An output step of 0.01 mm makes radii differ by more than some controls take: such an arc becomes lines.
#[test]
fn arcs_written_in_hundredths_satisfy_their_dialect() {
    let place = Place::new();
    let profile = profile(&place, |text| {
        text.replace("_mm = [-2000, 2000]", "_mm = [-2000, 2000]\nresolution_mm = 0.01")
    });
    let mut program = "G21 G17 G90 G54\nG0 X30. Y20. Z60.\nG1 Z50. F200.\n".to_owned();
    for k in 1..20 {
        let radius = 5.0 + 1.7 * f64::from(k);
        program += &format!("G1 X{radius:.3} Y0.\nG3 X0. Y{radius:.3} I-{radius:.3} J0.\n");
    }
    let program = place.write("part.nc", &(program + "M30\n"));
    for dialect in ["perspektiva", "fanuc", "sinumerik"] {
        let program = if dialect == "sinumerik" {
            let text = std::fs::read_to_string(&program).expect("readable").replace("G21", "G71");
            place.write("part.mpf", &text)
        } else {
            program.clone()
        };
        let out = place.write("out.nc", "");
        let tolerance = ["--tolerance", "30"];
        let ran = run(&[&[&program, "-m", &profile, "-d", dialect, "-o", &out][..], &tolerance].concat());
        assert!(ran.status.success(), "{dialect}: {}", messages(&ran));
        assert!(std::fs::read_to_string(&out).expect("readable").contains("G3"), "{dialect}: no arc is left");
        // What vpost writes it reads itself, and so does the control.
        let again = run(&[
            &out,
            "-m",
            "machine-profiles/perfect.toml",
            "-d",
            dialect,
            "--force",
            "--work-offset",
            "G54=100,80,40",
        ]);
        assert!(again.status.success(), "{dialect}: {}", messages(&again));
    }
}

/// The ends of half a turn and its centre lie on one grid, and its radii may differ by a step: that is no reason to refuse it
/// where a control offsets it.
#[test]
fn half_a_turn_under_compensation_stays_one_block() {
    let place = Place::new();
    let program = "G21 G17 G40 G90 G54\nG0 X50 Y50 Z30\nG1 Z0 F200\nG41 D1\nG3 X70 Y50 Z-1 I10 J0\nG3 I-20\nG3 X50 Y50 Z1 I-10 J0\nG40\nG0 Z30\nM2\n";
    let program = place.write("part.ngc", program);
    let out = place.write("out.ngc", "");
    let options = ["-q", "-m", "tests/profiles/linuxcnc_samples.toml", "-d", "linuxcnc"];
    let ran = run(&[&[program.as_str(), "-o", &out], &options[..]].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    let made = std::fs::read_to_string(&out).expect("written");
    assert_eq!(made.lines().filter(|line| line.starts_with("G3")).count(), 3, "{made}");
    let checked = run(&[&["check", &program, &out], &options[..]].concat());
    assert!(checked.status.success(), "{}", String::from_utf8_lossy(&checked.stdout));
}

/// A table that says neither form: an arc stays as it is written, or becomes lines.
#[test]
fn arcs_become_lines_where_no_form_may_be_written() {
    let place = Place::new();
    let arcs = "%A G71 *\nN10 T1 *\nN20 G00 X+0 Y+0 Z+60 *\nN30 G01 Z+50 F200 *\nN40 G02 X+40 Y+40 R+40 *\nN50 G03 X+80 Y+80 I+40 J+80 *\nN60 M30 *\nN99999999 %A G71 *\n";
    let program = place.write("part.i", arcs);
    let ran = run(&[&program, "-m", CROOKED, "-d", "heidenhain-iso"]);
    assert!(ran.status.success(), "{}", messages(&ran));
    let out = String::from_utf8_lossy(&ran.stdout).into_owned();
    assert!(!out.contains("G02") && !out.contains("G03") && out.lines().count() > 40, "{out}");
    assert!(out.lines().filter(|line| line.contains('X')).all(|line| line.ends_with('*')), "{out}");
    let perfect = ["-m", "machine-profiles/perfect.toml", "--zero", "true"];
    let given = ["--work-offset", "G247=0,0,0", "--tool", "H1=100"];
    let ran = run(&[&[program.as_str(), "-d", "heidenhain-iso"][..], &perfect, &given].concat());
    assert!(ran.status.success(), "{}", messages(&ran));
    assert_eq!(String::from_utf8_lossy(&ran.stdout), arcs);
}
