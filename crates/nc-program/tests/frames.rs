//! Codes that move the frame: where the axes then go, and what is refused.

use crate::common;

use common::{centre, end, feed, hole, motions, refusal, run, run_with, setup, sweep};
use nc_program::Setup;
use toolpath::Motion;

const START: &str = "G90 G0 X0 Y0 Z10.\n";

fn numbered() -> Setup {
    let mut setup = setup();
    setup.work_offsets.push(("G54.1P1".to_owned(), [7.0, 8.0, 9.0]));
    setup.work_offsets.push(("G54.1P48".to_owned(), [70.0, 80.0, 90.0]));
    setup
}

/// X, Y, Z at the end of a program with the numbered offsets given.
fn end_numbered(name: &str, text: &str) -> [Option<f64>; 3] {
    let run = run_with(common::dialect(name), &numbered(), text);
    assert!(run.refused.is_none(), "{text:?}: {:?}", run.refused);
    run.modal.axes.partial().linear_mm
}

fn near(found: [Option<f64>; 3], expected: [f64; 3]) {
    for i in 0..3 {
        let found = found[i].expect("known");
        assert!((found - expected[i]).abs() < 1e-9, "{found} is not {}", expected[i]);
    }
}

#[test]
fn g54_p1_is_the_numbered_offset_and_not_g54() {
    near(end_numbered("fanuc", "G54 P1\nG0 X1. Y1. Z1.\n"), [8.0, 9.0, 10.0]);
    near(end_numbered("fanuc", "G54.1 P48 G0 X1. Y1. Z1.\n"), [71.0, 81.0, 91.0]);
    near(end_numbered("fanuc", "G90 G0 G54 P1 X1. Y1. Z1.\n"), [8.0, 9.0, 10.0]);
    near(end_numbered("fanuc", "G154 P1\nG54\nG0 X1. Y1. Z1.\n"), [1.0, 1.0, 1.0]);
    let table = [
        ("fanuc", "G54 P2\n", 214),
        ("fanuc", "G54.1\n", 214),
        ("fanuc", "G54.1 P0\n", 214),
        ("fanuc", "G55 P1\n", 227),
        ("fanuc", "G54 P1 G4\n", 223),
        ("fanuc", "G54 P1 G82 X0 Y0 Z1. R2.\n", 223),
        ("linuxcnc", "G54 P1\n", 227),
        ("perspektiva", "G54 P1\n", 227),
        ("centroid", "G54 P1\n", 227),
    ];
    for (name, text, code) in table {
        assert_eq!(refusal(name, text), (code, 1), "{name}: {text}");
    }
    // A P that is another code's own stays that code's.
    assert!(run("linuxcnc", "G54 G4 P1\n").refused.is_none());
}

#[test]
fn local_shift_moves_every_work_offset() {
    near(end("fanuc", "G52 X5. Z1.\nG0 X1. Y1. Z1.\n"), [6.0, 1.0, 2.0]);
    near(end("fanuc", "G52 X5.\nG55\nG0 X1. Y1. Z1.\n"), [106.0, 11.0, 2.0]);
    near(end("fanuc", "G52 X5. Y5.\nG52 X0\nG0 X1. Y1. Z1.\n"), [1.0, 6.0, 1.0]);
    near(end("linuxcnc", "G52 X5 Y5\nG92.1\nG0 X1 Y1 Z1\n"), [1.0, 1.0, 1.0]);
    // A shift moves no axis.
    near(end("fanuc", &format!("{START}G52 X5. Y5. Z5.\n")), [0.0, 0.0, 10.0]);
}

#[test]
fn preset_makes_the_frame_from_where_the_axes_stand() {
    for name in ["fanuc", "linuxcnc"] {
        near(end(name, &format!("{START}G92 X100. Y20. Z10.\nG0 X101. Y20. Z9.\n")), [1.0, 0.0, 9.0]);
        // It stays when another work offset is chosen.
        near(end(name, &format!("{START}G92 X100.\nG55 G0 X100. Y0. Z0.\n")), [100.0, 10.0, 1.0]);
    }
    near(end("linuxcnc", &format!("{START}G92 X100\nG92.2\nG0 X1\nG92.3\nG0 X101 Y1 Z1\n")), [1.0, 1.0, 1.0]);
    near(end("linuxcnc", &format!("{START}G92 X100\nG92.1\nG0 X1\n")), [1.0, 0.0, 10.0]);
    near(end("fanuc", &format!("{START}G92 X100.\nG92.1 X0\nG0 X1.\n")), [1.0, 0.0, 10.0]);
    // LinuxCNC counts the tool length; on Fanuc a parameter decides.
    near(end("linuxcnc", "G43 H1\nG0 X0 Y0 Z10\nG92 Z0\nG49\nG0 Z1\n"), [0.0, 0.0, 11.0]);
    let table = [
        ("fanuc", "G92 X0\n", 213, 1),
        ("fanuc", "G43 H1\nG0 X0 Y0 Z10.\nG92 Z0\n", 227, 3),
        ("fanuc", "G0 X0 Y0 Z0\nG92 X1.\nG52 X1.\n", 227, 3),
        ("fanuc", "G0 X0 Y0 Z0\nG52 X1.\nG92 X1.\n", 227, 3),
        ("fanuc", "G0 X0 Y0 Z0\nG92 X1.\nG92.1\n", 227, 3),
        ("linuxcnc", "G92.3\n", 227, 1),
        ("linuxcnc", "G0 X0 Y0 Z0\nG92\n", 227, 2),
        ("linuxcnc", "G92 A0\n", 227, 1),
        ("perspektiva", "G92 X0\n", 208, 1),
    ];
    for (name, text, code, line) in table {
        assert_eq!(refusal(name, text), (code, line), "{name}: {text}");
    }
    let steps = run("linuxcnc", &format!("{START}G92 X5\nG52 X5\nG10 L20 P1 X5\nG10 L2 P1 X5\n")).steps;
    let stated: Vec<bool> = steps.iter().map(|step| step.states_position).collect();
    assert_eq!(stated, [false, true, false, true, false]);
}

#[test]
fn offsets_written_by_the_program_replace_the_profile_s() {
    near(end("linuxcnc", "G10 L2 P1 X10 Y20 Z30\nG0 X1 Y1 Z1\n"), [11.0, 21.0, 31.0]);
    near(end("fanuc", "G10 L2 P2 X10.\nG55\nG0 X1. Y1. Z1.\n"), [11.0, 11.0, 2.0]);
    near(end("fanuc", "G91 G10 L2 P2 X10.\nG90 G55\nG0 X1. Y1. Z1.\n"), [111.0, 11.0, 2.0]);
    // LinuxCNC writes absolute values under G91 too.
    near(end("linuxcnc", "G91 G10 L2 P2 X10\nG90 G55\nG0 X1 Y1 Z1\n"), [11.0, 11.0, 2.0]);
    near(end("fanuc", "G10 L20 P3 X1. Y2. Z3.\nG54.1 P3\nG0 X1. Y1. Z1.\n"), [2.0, 3.0, 4.0]);
    near(end("linuxcnc", &format!("{START}G10 L20 P2 X1 Y1 Z1\nG55 G0 X0 Y0 Z0\n")), [-1.0, -1.0, 9.0]);
    near(end("linuxcnc", &format!("{START}G10 L20 P0 X1\nG0 X0\n")), [-1.0, 0.0, 10.0]);
    near(end("linuxcnc", "G20 G10 L2 P1 X1\nG21 G0 X1 Y1 Z1\n"), [26.4, 1.0, 1.0]);
    let table = [
        // Does Fanuc heed it before G54 is chosen again?
        ("fanuc", "G10 L2 P1 X10.\nG0 X1. Y1. Z1.\n", 227, 2),
        ("fanuc", "G10 L2 P0 X10.\n", 227, 1),
        ("fanuc", "G10 L2 P7 X10.\n", 227, 1),
        ("fanuc", "G10 L1 P1 R5.\n", 227, 1),
        ("fanuc", "G10 L2 P3 X10.\n", 214, 1),
        ("fanuc", "G10 P1 X10.\n", 227, 1),
        ("linuxcnc", "G10 L1 P1 Z10\n", 227, 1),
        ("linuxcnc", "G10 L2 P1 R10\n", 227, 1),
        ("linuxcnc", "G10 L20 P1 X0\n", 213, 1),
        ("linuxcnc", "G10 L2 X1\n", 227, 1),
    ];
    for (name, text, code, line) in table {
        assert_eq!(refusal(name, text), (code, line), "{name}: {text}");
    }
    assert!(run("fanuc", "G10 L2 P1 X10. Y0 Z0\nG54\nG0 X1. Y1. Z1.\n").refused.is_none());
}

#[test]
fn rotation_turns_about_its_centre() {
    near(end("fanuc", &format!("{START}G68 X10. Y0 R90.\nG0 X20. Y0\n")), [10.0, 10.0, 10.0]);
    near(end("fanuc", &format!("{START}G68 X10. Y0 R90.\nG0 X20. Y0\nG91 X5.\n")), [10.0, 15.0, 10.0]);
    near(end("fanuc", &format!("{START}G68 X0 Y0 R90.\nX5. Y0\nG69 X5. Y0\n")), [5.0, 0.0, 10.0]);
    // R without a point counts thousandths of a degree.
    near(end("fanuc", &format!("{START}G68 X0 Y0 R90000\nX5. Y0\n")), [0.0, 5.0, 10.0]);
    // In a plane of its own, with the work offset and the tool length outside of it.
    near(end("fanuc", "G55 G43 H1\nG0 X0 Y0 Z0\nG18 G68 X0 Z0 R90.\nX0 Z10.\n"), [110.0, 10.0, 121.0]);
    // A word on one axis moves two.
    near(end("fanuc", &format!("{START}G68 X0 Y0 R90.\nX5. Y1.\nX6.\n")), [-1.0, 6.0, 10.0]);
    let arc = motions("fanuc", &format!("{START}G68 X0 Y0 R90.\nG1 X10. Y0 F100.\nG3 X0 Y10. I-10. J0\n"));
    assert!((sweep(&arc[2]) - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert!(centre(&arc[2]).iter().all(|c| c.abs() < 1e-12));
    let holes = motions(
        "fanuc",
        &format!("{START}G68 X0 Y0 R90.\nG91.\nG90 G99 G81 X10. Y0 Z-5. R2. F100.\nG91 X5. K2\n")
            .replace("G91.\n", ""),
    );
    assert_eq!(holes.len(), 4);
    for (motion, y) in holes[1..].iter().zip([10.0, 15.0, 20.0]) {
        let at = hole(motion).at_r.linear_mm;
        assert!(at[0].abs() < 1e-12 && (at[1] - y).abs() < 1e-12 && at[2] == 2.0, "{at:?}");
    }
}

#[test]
fn mirror_changes_the_sense_of_arcs() {
    near(
        end("fanuc", &format!("{START}G51.1 X50.\nG0 X10. Y5.\n").replace("X50.", "X50.")),
        [90.0, 5.0, 10.0],
    );
    let arcs = motions("fanuc", &format!("{START}G51.1 X0\nG1 X10. Y0 F100.\nG3 X0 Y10. I-10. J0\n"));
    assert!((sweep(&arcs[2]) + std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    assert_eq!(feed(&arcs[2]).start.linear_mm, [-10.0, 0.0, 10.0]);
    // Both axes: a turn by 180 degrees, the sense stays.
    let arcs = motions("fanuc", &format!("{START}G51.1 X0 Y0\nG1 X10. Y0 F100.\nG3 X0 Y10. I-10. J0\n"));
    assert!((sweep(&arcs[2]) - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    near(end("fanuc", &format!("{START}G51.1 X0 Y0\nX1. Y1.\nG50.1 X0\nX1. Y1.\n")), [1.0, -1.0, 10.0]);
}

#[test]
fn scaling_takes_lines_unevenly_and_arcs_evenly() {
    near(end("fanuc", &format!("{START}G51 X10. Y0 Z0 P2.\nX20. Y5. Z5.\n")), [30.0, 10.0, 10.0]);
    near(end("fanuc", &format!("{START}G51 X10. Y0 Z0 P2000\nX20. Y5. Z5.\nG50 X1. Y1. Z1.\n")), [1.0; 3]);
    near(end("fanuc", &format!("{START}G51 X0 Y0 Z0 I2. J3. K1.\nX1. Y1. Z1.\n")), [2.0, 3.0, 1.0]);
    let arc = motions("fanuc", &format!("{START}G51 X0 Y0 Z0 P2.\nG1 X5. Y0 Z5. F100.\nG2 X0 Y5. R-5.\n"));
    assert_eq!(feed(&arc[2]).end.linear_mm, [0.0, 10.0, 10.0]);
    assert!((sweep(&arc[2]) + 1.5 * std::f64::consts::PI).abs() < 1e-9);
    let uneven = format!("{START}G51 X0 Y0 Z0 I2. J3. K1.\nG1 X5. Y0 Z5. F100.\nG2 X0 Y5. R-5.\n");
    assert_eq!(refusal("fanuc", &uneven), (227, 4));
}

#[test]
fn what_no_manual_tells_is_refused() {
    let table = [
        // The first motion must be absolute and name what was touched; an axis beside it may move alone.
        ("G68 X0 Y0 R30.\nG91 X5. Y5.\n", 3),
        ("G68 X0 Y0 R30.\nX5. Y5.\nG69\nG1 X5. F9\n", 5),
        ("G51.1 X0\nY5.\nX5.\nG50.1 X0\nG91 X1.\n", 6),
        // Two at once: in which order?
        ("G68 X0 Y0 R30.\nG51.1 X0\n", 3),
        ("G51 X0 Y0 Z0 P2.\nG68 X0 Y0 R30.\n", 3),
        ("G68 X0 Y0 R30.\nG68 X0 Y0 R30.\n", 3),
        ("G51.1 X0\nG51.1 X1.\n", 3),
        // Parts left out.
        ("G68 X0 R30.\n", 2),
        ("G68 X0 Y0\n", 2),
        ("G68 X0 Y0 Z0 I0 J0 K1. R30.\n", 2),
        ("G51 X0 Y0 P2.\n", 2),
        ("G51 X0 Y0 Z0\n", 2),
        ("G51 X0 Y0 Z0 P-2.\n", 2),
        ("G51.1 X0\nG50.1\n", 3),
        ("G51.1\n", 2),
        ("G52\n", 2),
        ("G91 G52 X5.\n", 2),
        ("G91 G68 X0 Y0 R30.\n", 2),
        // The frame changes under it.
        ("G68 X0 Y0 R30.\nG55\n", 3),
        ("G68 X0 Y0 R30.\nG52 X5.\n", 3),
        ("G68 X0 Y0 R30.\nG92 X5.\n", 3),
        ("G68 X0 Y0 R30.\nG10 L2 P2 X5.\n", 3),
        ("G68 X0 Y0 R30.\nG18\n", 3),
        ("G68 X0 Y0 R30.\nG20\n", 3),
        ("G68 X0 Y0 R30.\nG53 X0\n", 3),
        ("G68 X0 Y0 R30.\nG31 Z0\n", 3),
        ("G68 X0 Y0 R30.\nG28 X0\n", 3),
        ("G41 D1\nG68 X0 Y0 R30.\n", 3),
        ("G68 X0 Y0 R30.\nG41 D1\nG69\n", 4),
        // Cycles along a scaled or mirrored axis, pecks and shifts.
        ("G51 X0 Y0 Z0 P2.\nG81 X1. Y1. Z-1. R1. F9\n", 3),
        ("G51.1 X0 Z0\nG81 X1. Y1. Z-1. R1. F9\n", 3),
        ("G51.1 X0\nG76 X1. Y1. Z-1. R1. Q.1 F9\n", 3),
        // Beside a motion, beside another offset.
        ("G52 X5. G0\n", 2),
        ("G55 G52 X5.\n", 2),
        ("G52 X5. A1.\n", 2),
    ];
    for (text, line) in table {
        assert_eq!(refusal("fanuc", &format!("{START}{text}")), (227, line), "{text}");
    }
    // A return of the axis beside the plane is plain, and cancels stand in every preamble.
    assert!(run("fanuc", &format!("{START}G68 X0 Y0 R30.\nG91 G28 Z0\nG90 G69\n")).refused.is_none());
    assert!(run("fanuc", "G17 G21 G40 G49 G50 G50.1 G54 G69 G80 G90\nG0 X1. Y1. Z1.\n").refused.is_none());
    assert_eq!(refusal("fanuc", &format!("{START}G81 X1. Y1. Z-1. R1. F9\nG52 X5.\n")).1, 3);
    assert_eq!(refusal("fanuc", &format!("{START}/G52 X5.\nM8\n")), (222, 3));
}

#[test]
fn a_length_written_in_the_program() {
    near(end("linuxcnc", "G43.1 Z120\nG0 X0 Y0 Z1\n"), [0.0, 0.0, 121.0]);
    near(end("linuxcnc", "G43.1 Z120\nG43.1 X2\nG0 X0 Y0 Z1\nG49\nG0 X2 Z1\n"), [2.0, 0.0, 1.0]);
    let steps = run("linuxcnc", "G43.1 Z120\nG0 X0 Y0 Z1\n").steps;
    assert_eq!(steps[1].context.tool_mm, [0.0, 0.0, -120.0]);
    assert_eq!(refusal("linuxcnc", "G43.1 H1\n"), (215, 1));
    assert_eq!(refusal("linuxcnc", "G0 G43.1 Z1\n"), (215, 1));
}

#[test]
fn arcs_of_several_turns() {
    use std::f64::consts::{PI, TAU};
    let of = |text: &str| sweep(&motions("linuxcnc", &format!("G0 X10 Y0 Z0\n{text}"))[1]);
    assert!((of("G2 X10 Y0 I-5 P3 F100\n") + 3.0 * TAU).abs() < 1e-9);
    assert!((of("G3 X0 Y0 I-5 P2 Z4 F100\n") - TAU - PI).abs() < 1e-9);
    assert!((of("G3 X0 Y0 I-5 P1 F100\n") - PI).abs() < 1e-9);
    assert_eq!(refusal("linuxcnc", "G0 X10 Y0 Z0\nG2 I-5 P0\n"), (206, 2));
    assert_eq!(refusal("linuxcnc", "G0 X10 Y0 Z0\nG2 I-5 P1.5\n"), (211, 2));
    assert_eq!(refusal("fanuc", "G0 X10. Y0 Z0\nG2 I-5. P2\n"), (206, 2));
}

#[test]
fn a_dwell_beside_a_motion_where_only_p_is_its_time() {
    near(end("linuxcnc", "G0 X0 Y0 Z0\nG4 P1 G0 X5\n"), [5.0, 0.0, 0.0]);
    near(end("linuxcnc", "G0 X0 Y0 Z0\nG1 F9 G4 P1 X5\n"), [5.0, 0.0, 0.0]);
    assert!(matches!(motions("linuxcnc", "G0 X0 Y0 Z0\nG4 P1 X5\n")[1], Motion::Rapid { .. }));
    assert_eq!(refusal("linuxcnc", "G0 X0 Y0 Z0\nG4 P1 G2 X5 I2.5\n"), (223, 2));
    assert_eq!(refusal("linuxcnc", "G0 X0 Y0 Z0\nG4 P1 G81 X5 Z-1 R1\n"), (223, 2));
}

#[test]
fn g15_of_okuma_chooses_by_h_and_takes_no_length() {
    let mut setup = setup();
    setup.work_offsets.push(("G15H1".to_owned(), [7.0, 8.0, 9.0]));
    setup.work_offsets.push(("G15H2".to_owned(), [70.0, 80.0, 90.0]));
    let dialect = common::dialect("okuma");
    let end = |text: &str| {
        let run = run_with(dialect, &setup, text);
        assert!(run.refused.is_none(), "{text:?}: {:?}", run.refused);
        run.modal.axes.partial().linear_mm
    };
    near(end("G15 H1\nG0 X1. Y1. Z1.\n"), [8.0, 9.0, 10.0]);
    near(end("G15 H2 G0 X1. Y1. Z1.\n"), [71.0, 81.0, 91.0]);
    // H of G56 is a length, H of a later G15 is none.
    near(end("G15 H1\nG56 H1 G0 X1. Y1. Z1.\nG15 H2\nG0 X0 Y0 Z0\n"), [70.0, 80.0, 210.0]);
    near(end("G15 H1\nG56 H1 G0 X1. Y1. Z1.\nG53\nG0 X0 Y0 Z0\n"), [7.0, 8.0, 9.0]);
    let refusal =
        |text: &str| run_with(dialect, &setup, text).refused.map(|(line, why)| (why[0].code.0, line));
    for (text, code) in [
        ("G15\n", 214),
        ("G15 H0\n", 214),
        ("G15 H3\n", 214),
        ("G15 H1 G56\n", 223),
        ("G16 H1\n", 208),
        ("G54 H1\n", 208),
    ] {
        assert_eq!(refusal(text), Some((code, 1)), "{text}");
    }
}

#[test]
fn g10_writes_lengths_in_two_parts() {
    let both = "G10 L10 P7 R120.\nG10 L11 P7 R-0.5\n";
    for name in ["fanuc", "haas", "mitsubishi"] {
        near(end(name, &format!("{both}G43 H7\n{START}")), [0.0, 0.0, 129.5]);
        near(
            end(name, &format!("G20\nG10 L10 P7 R1.\nG10 L11 P7 R0\nG21\nG43 H7\n{START}")),
            [0.0, 0.0, 35.4],
        );
        // The profile's own where the program writes another one's.
        near(end(name, &format!("{both}G43 H1\n{START}")), [0.0, 0.0, 130.0]);
        assert_eq!(refusal(name, &format!("G10 L10 P1 R120.\nG43 H1\n{START}")), (215, 2));
        assert_eq!(refusal(name, &format!("G10 L11 P1 R120.\nG43 H1\n{START}")), (215, 2));
        assert_eq!(refusal(name, &format!("G43 H1\n{START}{both}G10 L10 P1 R5.\n")), (215, 5));
    }
    // There L10 measures from where the tool stands.
    assert_eq!(refusal("linuxcnc", "G10 L10 P1 R5.\n"), (227, 1));
}
