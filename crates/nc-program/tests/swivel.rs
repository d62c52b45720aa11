//! CYCLE800: the plane and the angles that its arguments make, and direct angles of modulo axes.

use crate::common;

use common::{Run, dialect, run_with};
use nc_program::{Setup, TipControl};
use toolpath::{Kinematics, RotaryChain, RotaryLink, TiltRule, TiltedPlane, WholeTurns};

/// A rotary table C on a tilting table A, which travels from -100 to 30 degrees.
fn setup() -> Setup {
    let link = |axis: usize, travel_deg: [f64; 2]| {
        let direction = [0, 1, 2].map(|k| f64::from(u8::from(k == axis)));
        RotaryLink { axis, direction, carries_workpiece: true, travel_deg }
    };
    Setup {
        has_rotary: [true, false, true],
        rotary_matters: true,
        tip_control: TipControl::Declared,
        rotary_chain: RotaryChain(vec![link(2, [-1000.0, 1000.0]), link(0, [-100.0, 30.0])]),
        tilt_rule: TiltRule { reference: Some(0), turns: Some(WholeTurns::Principal), branch: None },
        work_offsets: vec![("G54".to_owned(), [100.0, 0.0, 0.0])],
        ..common::setup()
    }
}

fn after(program: &str) -> Run {
    run_with(dialect("sinumerik"), &setup(), &format!("G17 G71 G90 G54\nG0 A=0 C=0\n{program}\n"))
}

/// The plane in force at the end, and A and C.
fn plane(program: &str) -> (TiltedPlane, [f64; 2]) {
    let run = after(program);
    assert!(run.refused.is_none(), "{program}: {:#?}", run.refused);
    let Kinematics::Plane(plane) = run.modal.kinematics else { panic!("{program}: no plane") };
    let [a, _, c] = run.modal.axes.rotary.map(|axis| axis.known().expect("known"));
    (plane, [a, c])
}

fn refused(program: &str) -> (u16, String) {
    let (_, why) = after(program).refused.unwrap_or_else(|| panic!("{program}: accepted"));
    assert!(why[0].help.is_some(), "{program}");
    (why[0].code.0, format!("{:?}", why[0]))
}

fn near(found: &[f64], wanted: &[f64], what: &str) {
    let all = found.iter().zip(wanted).all(|(one, other)| (one - other).abs() < 1e-9);
    assert!(all, "{what}: {found:?}, not {wanted:?}");
}

#[test]
fn the_first_angle_is_that_of_the_first_turn() {
    // A quarter turn about Z, then about X as it lies by then: the plane's Z along the workpiece's X.
    for call in
        ["CYCLE800(0,\"\",0,39,1,2,3,90,90,0,0,0,5,-1)", "CYCLE800(1,\"T,1\",0,39,1,2,3,90,90,,,,5,-1,,1)"]
    {
        let (plane, [a, _]) = plane(call);
        near(&plane.normal(), &[1.0, 0.0, 0.0], call);
        near(&plane.zero_mm, &[106.0, 2.0, 3.0], call);
        near(&[a], &[-90.0], call);
    }
    // In another order: about X, then about the Y that lies along the workpiece's Z by then.
    let (plane, _) = plane("CYCLE800(0,\"\",0,57,0,0,0,90,90,0,0,0,0,-1)");
    near(&plane.normal(), &[1.0, 0.0, 0.0], "57");
    near(&plane.turn.map(|row| row[1]), &[0.0, 0.0, 1.0], "57");
}

#[test]
fn the_direction_asks_for_an_angle_of_the_reference_axis() {
    // Rx(20): the tool along (0, -sin 20, cos 20), which A -20 C 0 and A 20 C 180 stand it along.
    let ask = |angle: f64, direction: i32| {
        plane(&format!("CYCLE800(0,\"\",0,57,0,0,0,{angle},0,0,0,0,0,{direction})")).1
    };
    near(&ask(20.0, -1), &[-20.0, 0.0], "lower");
    near(&ask(20.0, 1), &[20.0, 180.0], "higher");
    // Beyond 30 there is one way only.
    near(&ask(40.0, 1), &[-40.0, 0.0], "the only one");
}

#[test]
fn what_is_missing_is_named() {
    let mut wide = setup();
    wide.rotary_chain.0[1].travel_deg = [f64::NEG_INFINITY, f64::INFINITY];
    let program = "G17 G71 G90 G54\nG0 A=0 C=0\nCYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)\n";
    let (_, why) = run_with(dialect("sinumerik"), &wide, program).refused.expect("refused");
    let said = format!("{:?}", why[0]);
    assert!(why[0].code.0 == 232 && said.contains("travel_deg") && !said.contains("turn = "), "{said}");
}

#[test]
fn one_on_top_of_another_counts_in_the_first() {
    let first = "CYCLE800(0,\"\",0,57,0,0,20,-15,0,0,0,0,0,-1)\n";
    let (both, _) = plane(&format!("{first}CYCLE800(0,\"\",1,57,0,10,0,-10,0,0,0,0,0,-1)"));
    let (sin, cos) = units::math::sin_cos_deg(15.0);
    near(&both.zero_mm, &[100.0, 10.0 * cos, 20.0 - 10.0 * sin], "zero");
    let (sin, cos) = units::math::sin_cos_deg(25.0);
    near(&both.normal(), &[0.0, sin, cos], "normal");
    // A new one does not.
    let (new, _) = plane(&format!("{first}CYCLE800(0,\"\",0,57,0,10,0,-10,0,0,0,0,0,-1)"));
    near(&new.zero_mm, &[100.0, 10.0, 0.0], "new");
}

#[test]
fn it_ends_without_arguments_and_without_its_data() {
    for end in ["CYCLE800()", "CYCLE800", "CYCLE800(2,\"0\",200000,57,0,0,0,0,0,0,0,0,0,1,,1)"] {
        let run = after(&format!("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)\nG0 X0 Y0 Z9\n{end}"));
        assert!(run.refused.is_none(), "{end}: {:#?}", run.refused);
        assert_eq!(run.modal.kinematics, Kinematics::Axes, "{end}");
        assert!(run.modal.axes.linear.iter().all(|axis| axis.known().is_none()), "{end}");
    }
}

#[test]
fn what_the_arguments_leave_open_is_refused() {
    for (call, code, says) in [
        ("CYCLE800(0,\"\",0,64,0,0,0,20,0,0,0,0,0,-1)", 231, "a solid angle"),
        ("CYCLE800(0,\"\",0,128,0,0,0,20,0,0,0,0,0,-1)", 231, "projected angles"),
        ("CYCLE800(0,\"\",0,192,0,0,0,20,0,0,0,0,0,-1)", 231, "own angles"),
        ("CYCLE800(0,\"\",0,25,0,0,0,20,0,0,0,0,0,-1)", 231, "once each"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,0)", 231, "do not turn"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0)", 231, "which way is not said"),
        ("CYCLE800(0,\"\",100,57,0,0,0,20,0,0,0,0,0,-1)", 231, "align the tool"),
        ("CYCLE800(0,\"\",10000,57,0,0,0,20,0,0,0,0,0,-1)", 231, "let nothing turn"),
        ("CYCLE800(0,\"\",200000,57,0,0,0,20,0,0,0,0,0,-1)", 231, "another direction than _DIR"),
        ("CYCLE800(3,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)", 231, "_FR"),
        ("CYCLE800(5,\"\",0,57,0,0,0,20,0,0,0,0,0,-1,-10)", 231, "a way back below 0"),
        ("CYCLE800(0,\"\",0,57,0,0,0,R5,0,0,0,0,0,-1)", 231, "not a plain number"),
        ("CYCLE800(0,\"\",0,57,0,0,0,1E1,0,0,0,0,0,-1)", 231, "not a plain number"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1,,2)", 231, "_DMODE"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1,,0,7)", 231, "a seventeenth argument"),
        ("G18\nCYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)", 231, "under G18 or G19"),
        ("G70\nCYCLE800(0,\"\",0,57,1,0,0,20,0,0,0,0,0,-1)", 231, "lengths under inches"),
        ("TRAORI\nCYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)", 231, "tool centre point control"),
        ("TRANS X5\nCYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)", 227, "a frame of the program"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)\nG0 A=5", 232, "turns inside a tilted plane"),
        ("CYCLE800(0,\"\",0,57,0,0,0,20,0,0,0,0,0,-1)\nTRAORI", 231, "inside a tilted plane"),
        ("CYCLE800(0,\"\",0,57,0,0,0,0,170,0,0,0,0,-1)", 232, "no angles within travel"),
        ("G0 C=30\nCYCLE800(0,\"\",0,57,0,0,0,0,0,0,0,0,0,-1)", 232, "may stand anywhere"),
        ("TOROT", 224, "along the tool"),
        ("PAROT", 224, "with the table"),
        ("CUT3DC", 224, "radius in space"),
    ] {
        let (found, said) = refused(call);
        assert!(found == code && said.contains(says), "{call}: {found} {said}");
    }
}

#[test]
fn direct_angles_stay_within_a_turn() {
    let c = |program: &str| {
        let run = after(program);
        assert!(run.refused.is_none(), "{program}: {:#?}", run.refused);
        run.modal.axes.rotary[2].known().expect("known")
    };
    assert_eq!(c("G0 C=DC(90)"), 90.0);
    assert_eq!(c("G91\nG0 C=dc( 179.5 )"), 179.5);
    // Upwards, downwards, and as G90 has it.
    for (said, deg) in [
        ("G0 C=ACP(200)", 200.0),
        ("G0 C=200\nG0 C=acn( 10 )", 10.0),
        ("G0 C=350\nG0 C=AC(10)", 10.0),
        ("G91\nG0 C=AC(-20)", -20.0),
    ] {
        assert_eq!(c(said), deg, "{said}");
    }
    // Across 0; a way that may be none or a whole turn.
    for wrong in ["G0 C=ACN(200)", "G0 C=200\nG0 C=ACP(10)", "G0 C=ACP(1)", "G0 C=ACN(0)", "G0 C=ACP(400)"] {
        assert!(refused(wrong).1.contains("between 0 and 360"), "{wrong}");
    }
    for wrong in ["G0 C=DC(180)", "G0 C=DC(360)", "G0 C=DC(-10)", "G0 C=350\nG0 C=DC(10)"] {
        assert!(refused(wrong).1.contains("between 0 and 360"), "{wrong}");
    }
    // Of other axes, of calculations and of other ways nothing is read.
    for wrong in ["G0 X=DC(10)", "G0 C=DC(R1)", "G0 C=IC(10)", "G0 X=ACP(10)"] {
        assert_eq!(refused(wrong).0, 202, "{wrong}");
    }
}
