//! One test for each rule of reading, named by the trap it guards against.

use crate::common;
#[path = "rules/controls.rs"]
mod controls;

use common::{dialect, end, feed, motions, refusal, run, run_with, setup, uncorrected};
use nc_program::modal::{MotionMode, Progress};
use nc_program::{AfterChange, Setup};
use nc_syntax::GCode;
use toolpath::{Division, FeedRate, Motion};

const START: &str = "G90 G0 X0 Y0 Z10\n";

fn after(text: &str) -> String {
    format!("{START}{text}")
}

fn at(x: f64, y: f64, z: f64) -> [Option<f64>; 3] {
    [Some(x), Some(y), Some(z)]
}

#[test]
fn modal_words_inherit_the_motion_code() {
    assert_eq!(end("fanuc", &after("X10.\nG1 Y5.\nZ-1.\n")), at(10.0, 5.0, -1.0));
    let run = run("fanuc", &after("G1 X1.\nY2.\n"));
    assert_eq!(run.steps[2].context.motion_code, Some(GCode(10)));
    feed(&run.steps[2].motions[0]);
}

#[test]
fn order_inside_a_block_does_not_matter() {
    for text in ["X10. Y5. G91 G1 G55\n", "G1 G55 G91 Y5. X10.\n", "G55 X10. G1 Y5. G91\n"] {
        assert_eq!(end("fanuc", &after(text)), at(10.0, 5.0, 0.01), "{text}");
    }
}

#[test]
fn numbers_without_a_point() {
    assert_eq!(end("fanuc", "G0 X100 Y100. Z1\n"), at(0.1, 100.0, 0.001));
    assert_eq!(end("linuxcnc", "G0 X100 Y100. Z1\n"), at(100.0, 100.0, 1.0));
    assert_eq!(end("fanuc", "G20 G0 X10000 Y1. Z0\n"), at(25.4, 25.4, 0.0));
    // F follows its own rule: 0.5 in G93, whatever the increment.
    let run = run("fanuc", "G0 X0 Y0 Z0\nG93\nG1 X10. F5\n");
    assert!(run.refused.is_none());
    assert_eq!(feed(&run.steps[2].motions[0]).rate, FeedRate::InverseTime(5.0));
}

#[test]
fn inch_is_exactly_25_4() {
    let run = run("linuxcnc", "G20 G0 X1 Y2 Z-.5\n");
    assert_eq!(run.modal.axes.partial().linear_mm, at(25.4, 50.8, -12.7));
    assert_eq!(run.steps[0].context.unit_mm.to_bits(), 25.4f64.to_bits());
}

/// RS274/NGC counts what the radii of an arc may differ by apart in inches.
#[test]
fn arcs_in_inches_have_a_tolerance_of_their_own() {
    let arc = |radius: f64| format!("G20 G90 G17 G54\nG0 X2. Y0. Z1.\nG3 X{} Y0. I-1. J0.\n", 1.0 - radius);
    for (radius, refused) in [(1.00015, 0), (0.99985, 0), (1.0003, 205)] {
        let run = run_with(dialect("mach"), &common::setup(), &arc(radius));
        assert_eq!(run.refused.map_or(0, |(_, why)| why[0].code.0), refused, "{radius}");
    }
}

#[test]
fn not_every_x_is_a_coordinate() {
    let table = [
        // (block, code of the refusal or 0)
        ("G4 X2.\n", 0),
        ("G4 U2.\n", 0),
        ("G4 P2000\n", 0),
        ("G5.1 Q1 X0 Y0\n", 0),
        ("G10 L10 P1 R5.\n", 0),
        ("G10 L1 P1 R5.\n", 227),
        ("G10 L12 P1 R5.\n", 0),
        ("G10 L10 P1\n", 215),
        ("G10 L10 R5.\n", 215),
        ("G91 G10 L10 P1 R5.\n", 215),
        ("G52 X5.\n", 0),
        ("G92 X5.\n", 0),
        ("G68 X0 Y0 R30.\n", 0),
        ("G51 X0 Y0 Z0 P2.\n", 0),
        ("G54.1 P12\n", 214),
        ("G43.4 H1\n", 230),
        ("G4 X2. Y3.\n", 223),
        ("G4 X2. P3.\n", 223),
        ("G1 X10. G4 X2.\n", 210),
        ("G1 X10. G4 P2.\n", 223),
        ("G5.1 Q1 G1 X5.\n", 223),
        ("G28 G53 X0\n", 223),
        ("U5.\n", 221),
        ("G28 W0\n", 221),
    ];
    for (block, code) in table {
        let text = after(&format!("G1 F100.\n{block}"));
        if code == 0 {
            let steps = run("fanuc", &text);
            assert!(steps.refused.is_none(), "{block}: {:?}", steps.refused);
            assert!(steps.steps[2].motions.is_empty(), "{block}");
            assert_eq!(end("fanuc", &text), at(0.0, 0.0, 0.01), "{block}");
        } else {
            assert_eq!(refusal("fanuc", &text), (code, 3), "{block}");
        }
    }
}

/// What the control calls may have moved every axis; its T, H and Z are arguments.
#[test]
fn a_call_of_the_control_leaves_no_axis_and_no_motion_code_known() {
    for call in ["G65 P9810 Z10. T1 H2", "M98 P9100 L3"] {
        let text = after(&format!("G1 X5. F100.\n{call}\n"));
        let called = run("fanuc", &text);
        uncorrected(&called.steps[2].motions[0]);
        assert_eq!((end("fanuc", &text), called.modal.motion), ([None; 3], MotionMode::None), "{call}");
        assert_eq!(called.modal.tool_selected, None, "{call}");
        assert_eq!(refusal("fanuc", &format!("{text}G1 X9.\n")), (213, 4), "{call}");
        assert_eq!(end("fanuc", &format!("{text}G0 X1. Y2. Z3.\nG1 X9.\n")), at(9.0, 2.0, 3.0), "{call}");
    }
    assert_eq!(refusal("fanuc", &after("G1 X5. F100. M98 P9100\n")).0, 226);
}

#[test]
fn two_codes_of_a_group_and_a_letter_twice() {
    for block in [
        "G0 G1 X1.\n",
        "G90 G91 X1.\n",
        "G0 G91 Z1. G90 X-2.6\n",
        "G54 G55\n",
        "G81 G0 X1. Z1. R1.\n",
        "G1 G1 X1.\n",
    ] {
        assert_eq!(refusal("fanuc", block), (209, 1), "{block}");
    }
    for block in ["G0 X1. X2.\n", "G0 F1. F1.\n", "N1 G0 N2\n"] {
        assert_eq!(refusal("fanuc", block), (210, 1), "{block}");
    }
    // G80 ends a cycle beside the code that follows it; several M codes may stand together.
    assert_eq!(end("fanuc", "G80 G0 X1. Y1. Z1. M3 M8\n"), at(1.0, 1.0, 1.0));
    assert_eq!(end("linuxcnc", "G0 G80 X1 Y1 Z1\n"), at(1.0, 1.0, 1.0));
}

#[test]
fn unknown_position_is_not_guessed() {
    let table = [
        ("G1 X10. Y0. Z0.\n", 1),
        ("G0 X0 Y0\nG1 X10.\n", 2),
        ("G91 G0 X10.\n", 1),
        (&after("G28 Z0\nG1 X10.\n"), 3),
        (&after("G28\nG1 X10.\n"), 3),
        (&after("G91 G30 Z0\nG90 G0 X1. Y1.\nG1 X5.\n"), 4),
        (&after("M6 T1\nG1 X10.\n"), 3),
        (&after("G31 Z-5. F100.\nG1 X10.\n"), 3),
        (&after("G91 G53 Z0\nG90 G1 X10.\n"), 3),
    ];
    for (text, line) in table {
        assert_eq!(refusal("fanuc", text), (213, line), "{text}");
    }
}

#[test]
fn a_rapid_may_have_unknown_axes() {
    let motions = motions("fanuc", "G0 Z26.\nX119.191 Y79.191\nG1 Z15. F120.\n");
    let Motion::Rapid { start, end } = motions[0] else { panic!("{motions:?}") };
    assert_eq!((start.linear_mm, end.linear_mm), ([None; 3], [None, None, Some(26.0)]));
    let Motion::Rapid { start, end } = motions[1] else { panic!("{motions:?}") };
    assert_eq!(start.linear_mm, [None, None, Some(26.0)]);
    assert_eq!(end.linear_mm, at(119.191, 79.191, 26.0));
    assert_eq!(feed(&motions[2]).start.linear_mm, [119.191, 79.191, 26.0]);
}

#[test]
fn start_at_makes_the_first_feed_possible() {
    let setup = Setup { start_mm: [1.0, 2.0, 3.0].map(Some), ..setup() };
    let run = run_with(dialect("fanuc"), &setup, "G91 G1 X10. F100.\n");
    assert_eq!(feed(&run.steps[0].motions[0]).end.linear_mm, [11.0, 2.0, 3.0]);
}

#[test]
fn reference_returns_lose_the_axes_they_name() {
    let motions = motions("fanuc", &after("G91 G28 Z0\nG90 X5. Y5.\nZ1.\nG1 Z0.\nG28\n"));
    assert_eq!(uncorrected(&motions[1]).linear_mm, [Some(0.0), Some(0.0), None]);
    assert_eq!(feed(&motions[4]).start.linear_mm, [5.0, 5.0, 1.0]);
    assert_eq!(uncorrected(&motions[5]).linear_mm, [None; 3]);
}

#[test]
fn machine_coordinates_are_known_and_not_corrected() {
    let text = "G55 G43 H1 G0 X0 Y0 Z0\nG53 Z300.\nG1 X1.\nG53\nG20 G53 G0 X1.\n";
    let motions = motions("fanuc", text);
    assert_eq!(uncorrected(&motions[1]).linear_mm, at(100.0, 10.0, 300.0));
    assert_eq!(feed(&motions[2]).end.linear_mm, [101.0, 10.0, 300.0]);
    assert_eq!(uncorrected(&motions[3]).linear_mm, at(25.4, 10.0, 300.0));
    assert_eq!(motions.len(), 4);
    assert_eq!(refusal("fanuc", &after("G2 G53 X1. I1.\n")), (226, 2));
}

#[test]
fn a_change_of_frame_moves_nothing() {
    let text = "G49 G54 G0 X0 Y0 Z0\nG55\nG1 X0\nG43 H1 Z1.\nG90 G44 H2 X0 Z0\nG43 H0 X1. Z0\n";
    let run = run("fanuc", text);
    assert!(run.refused.is_none(), "{:?}", run.refused);
    let ends: Vec<[f64; 3]> =
        run.steps.iter().flat_map(|step| &step.motions).skip(1).map(|m| feed(m).end.linear_mm).collect();
    // X0 in G55 is 100; Y stays where the axis is until it is named. H2 has an X part.
    assert_eq!(ends, [[100.0, 0.0, 0.0], [100.0, 0.0, 122.0], [99.5, 0.0, -79.0], [101.0, 0.0, 1.0]]);
    let tool = |at: usize| run.steps[at].context.tool_mm;
    assert_eq!(tool(1), [0.0; 3]);
    assert_eq!(tool(3), [0.0, 0.0, -120.0]);
    assert_eq!(tool(4), [0.5, 0.0, 80.0]);
    assert_eq!(tool(5), [0.0; 3]);
    assert_eq!(run.steps[3].context.frame.offset_mm(), [100.0, 10.0, 121.0]);
    assert_eq!(run.steps[4].context.frame.offset_mm(), [99.5, 10.0, -79.0]);
}

/// Some controls move the axis by the length at once, others with its next word.
#[test]
fn a_tool_length_without_a_word_for_its_axis_loses_it() {
    let stand = "G49 G54 G0 X0 Y0 Z50.\n";
    let nowhere_in_z = [Some(0.0), Some(0.0), None];
    assert_eq!(end("fanuc", &format!("{stand}G43 H1\n")), nowhere_in_z);
    assert_eq!(end("fanuc", &format!("{stand}G43 H1 X0\n")), nowhere_in_z);
    assert_eq!(end("fanuc", &format!("{stand}G43 H1 Z9.\nG49\n")), nowhere_in_z);
    assert_eq!(end("fanuc", &format!("{stand}G43 H1 Z9.\nH0\nG0 X0\n")), nowhere_in_z);
    assert_eq!(refusal("fanuc", &format!("{stand}G43 H1\nG1 X9.\n")), (213, 3));
    assert_eq!(refusal("fanuc", &format!("{stand}G43 H1\nG91 G1 Z9.\n")), (213, 3));
    assert_eq!(refusal("fanuc", &format!("{stand}G43 H1 G81 Z-9. R2.\n")), (213, 2));
    // The same length again moves nothing; in the block of a word all controls end alike.
    assert_eq!(end("fanuc", &format!("{stand}G43 H1 Z9.\nG43 H1 X1.\n")), at(1.0, 0.0, 129.0));
}

/// LinuxCNC says that it causes no motion: the axis stands where it stood, the same place has another word.
#[test]
fn a_tool_length_of_linuxcnc_moves_nothing() {
    let stand = "G49 G54 G0 X0 Y0 Z50.\n";
    let there = at(0.0, 0.0, 50.0);
    assert_eq!(end("linuxcnc", &format!("{stand}G43 H1\n")), there);
    assert_eq!(end("linuxcnc", &format!("{stand}G43 H1 X1.\n")), at(1.0, 0.0, 50.0));
    assert_eq!(end("linuxcnc", &format!("{stand}G43 H1\nG91 Z9.\n")), at(0.0, 0.0, 59.0));
    assert_eq!(end("linuxcnc", &format!("{stand}G43 H1\nG1 Z2. F100\n")), at(0.0, 0.0, 122.0));
    assert_eq!(end("linuxcnc", &format!("{stand}G43 H1 Z9.\nG49\n")), at(0.0, 0.0, 129.0));
}

#[test]
fn the_first_z_after_g43_means_the_tip() {
    assert_eq!(end("fanuc", "G49 G54 G0 X0 Y0 Z50.\nG43 H1 Z2.\n"), at(0.0, 0.0, 122.0));
    assert_eq!(end("fanuc", "G54 G43 H1 G0 X0 Y0 Z50.\nH2 X0 Z50.\n"), at(0.5, 0.0, 130.0));
    let setup = Setup { default_tool_mm: [0.0, 0.0, -7.0], ..setup() };
    let run = run_with(dialect("fanuc"), &setup, "G0 X0 Y0 Z0\nG43 H1 Z0\nG49\n");
    assert_eq!(run.steps[0].context.tool_mm, [0.0, 0.0, -7.0]);
    assert_eq!(run.steps[1].context.tool_mm, [0.0, 0.0, -120.0]);
    assert_eq!(run.steps[2].context.tool_mm, [0.0, 0.0, -7.0]);
}

#[test]
fn offsets_and_lengths_that_nobody_gave() {
    assert_eq!(refusal("fanuc", "G56\n"), (214, 1));
    assert_eq!(refusal("fanuc", "G43 H7\n"), (215, 1));
    assert_eq!(refusal("fanuc", "G43\n"), (215, 1));
    assert_eq!(refusal("fanuc", "G43 H1.5\n"), (211, 1));
    assert_eq!(refusal("fanuc", "G43 H-1\n"), (211, 1));
    // The default G54 is missed by the first motion, not by the first block.
    let empty = Setup::default();
    let run = run_with(dialect("fanuc"), &empty, "G90 G17\nM3 S1000\nG28 Z0\nG0 X1.\n");
    let (line, diagnostics) = run.refused.expect("no offset is given");
    assert_eq!((line, diagnostics[0].code.0), (4, 214));
    assert!(
        diagnostics[0]
            .help
            .as_ref()
            .map(|help| help.english())
            .is_some_and(|help| help.contains("--work-offset G54=X,Y,Z"))
    );
}

#[test]
fn g43_without_h_takes_the_loaded_tool_on_linuxcnc() {
    let z = |text: &str| end("linuxcnc", text)[2];
    assert_eq!(z("T1 M6\nG43\nG0 X0 Y0 Z0\n"), Some(120.0));
    assert_eq!(z("T1 M6 G43\nT2\nG0 X0 Y0 Z0\nG43 Z1\n"), Some(121.0));
    assert_eq!(refusal("linuxcnc", "T1\nG43\n"), (215, 2));
    assert_eq!(refusal("linuxcnc", "T3 M6\nG43\n"), (215, 2));
    // A second G43 on another control keeps the H that is in force.
    assert_eq!(end("fanuc", "G43 H1\nG43 G0 X0 Y0 Z0\n")[2], Some(120.0));
}

#[test]
fn incremental_moves_add_up() {
    assert_eq!(end("fanuc", &after("G91 G1 X1. Y2.\nX1.\nG90 X5.\nG91 Z-1.\n")), at(5.0, 2.0, -0.99));
    let text = format!("{START}G91\nG1\n{}", "X0.1\n".repeat(10_000));
    let x = end("linuxcnc", &text)[0].expect("known");
    assert!((x - 1000.0).abs() < 1e-8, "{x}");
}

#[test]
fn inverse_time_needs_f_on_each_feed() {
    assert_eq!(refusal("linuxcnc", "G0 X0 Y0 Z0\nG93 G1 X1 F2\nX2\n"), (218, 3));
    assert_eq!(refusal("linuxcnc", "G0 X0 Y0 Z0\nG93 G1 X1 F0\n"), (218, 2));
    assert_eq!(refusal("linuxcnc", "G0 X0 Y0 Z0\nG93 G2 I1\n"), (218, 2));
    assert_eq!(refusal("linuxcnc", "G0 X0 Y0 Z0\nG93 G81 X1 Z-1 R1 F1\n"), (218, 2));
    let rapid = motions("linuxcnc", "G93 G0 X0 Y0 Z0\nG1 X1 F2.5\nG95 X2 F0.1\nX3\n");
    assert_eq!(feed(&rapid[1]).rate, FeedRate::InverseTime(2.5));
    assert_eq!(feed(&rapid[2]).rate, FeedRate::PerRevolution);
    assert_eq!(feed(&rapid[3]).rate, FeedRate::PerRevolution);
    // What an inverse time is in another unit nobody says.
    assert_eq!(refusal("linuxcnc", "G0 X0 Y0 Z0\nG93 G1 X1 F2\nG94\nG0 X5\nG1 X2\n"), (218, 5));
    assert_eq!(refusal("linuxcnc", "G0 X0 Y0 Z0\nG93 G1 X1 F2\nG94 G81 X1 Z-1 R1\n"), (218, 3));
}

#[test]
fn compensation_keeps_its_blocks_whole() {
    let run = run("fanuc", &after("G1 X1.\nG41 D1 X2.\nX3.\nG40 X4.\nX5.\n"));
    let divisions: Vec<Division> =
        run.steps[1..].iter().map(|step| feed(&step.motions[0]).division).collect();
    let (any, one) = (Division::Any, Division::One);
    assert_eq!(divisions, [any, one, one, one, any]);
    let on: Vec<bool> = run.steps[1..].iter().map(|step| step.context.compensation.is_some()).collect();
    assert_eq!(on, [false, true, true, true, false]);
}

/// A perfect table: where it stands is nobody's business, and it may turn while linear axes feed, in one piece.
#[test]
fn rotary_axes_that_do_not_matter() {
    let with_a = Setup { has_rotary: [true, false, false], rotary_matters: false, ..setup() };
    let run =
        run_with(dialect("fanuc"), &with_a, "G0 X1. Y2. Z3.\nG1 X5. A10. F10.\nG28 A0.\nG1 X6.\nA60.\n");
    assert!(run.refused.is_none(), "{:?}", run.refused);
    assert_eq!(feed(&run.steps[1].motions[0]).division, Division::OneBehindLines);
    assert_eq!(feed(&run.steps[3].motions[0]).division, Division::Any);
}

#[test]
fn rotary_axes() {
    let with_a = Setup { has_rotary: [true, false, false], rotary_matters: true, ..setup() };
    let go = |text: &str| run_with(dialect("fanuc"), &with_a, text);
    let code = |text: &str| go(text).refused.map(|(line, diagnostics)| (diagnostics[0].code.0, line));
    // The machine must have the axis, and somebody must have said where it stands.
    assert_eq!(refusal("fanuc", "G0 A0.\n"), (219, 1));
    assert_eq!(code("G0 C0.\n"), Some((219, 1)));
    assert_eq!(code("G0 X0 Y0 Z0\n"), Some((213, 1)));
    assert_eq!(code("G91 G0 A10.\n"), Some((213, 1)));
    // Rotary axes alone: tracked, not corrected.
    let run = go("G0 A0.\nX1. Y2. Z3.\nA90.\nG91 A-15.\nG90 A80.\nG1 X5. F10.\nG0 X6. A0.\n");
    assert!(run.refused.is_none(), "{:?}", run.refused);
    let motion = |at: usize| &run.steps[at].motions[0];
    assert_eq!(uncorrected(motion(0)).linear_mm, [None; 3]);
    assert_eq!(uncorrected(motion(2)).linear_mm, at(1.0, 2.0, 3.0));
    assert_eq!(uncorrected(motion(3)).rotary_deg, [75.0, 0.0, 0.0]);
    assert_eq!(uncorrected(motion(4)).rotary_deg, [80.0, 0.0, 0.0]);
    assert_eq!(feed(motion(5)).end.rotary_deg, [80.0, 0.0, 0.0]);
    let Motion::Rapid { end, .. } = motion(6) else { panic!("{:?}", motion(6)) };
    assert_eq!((end.linear_mm[0], end.rotary_deg[0]), (Some(6.0), 0.0));
    // In an arc, in a cycle, under compensation: refused. Named but not turned: fine.
    let begin = "G0 A0.\nX1. Y2. Z3.\n";
    for block in ["G2 I1. A10.\n", "G81 X5. Z-1. R1. A10.\n", "G41 D1 G1 X5. A10. F500.\n"] {
        assert_eq!(code(&format!("{begin}{block}")), Some((220, 3)), "{block}");
    }
    assert_eq!(code(&format!("{begin}G1 X5. A0.\n")), None);
    // At feed rate it cuts, alone too: a feed as any other, by whatever rate.
    for (block, x, a) in [
        ("G1 X5. A10.\n", 5.0, 10.0),
        ("G1 A60. F500.\n", 1.0, 60.0),
        ("G93 G1 A60. F2.\n", 1.0, 60.0),
        ("G1 X1. A60. F500.\n", 1.0, 60.0),
        ("G1 G91 A-1. F500.\n", 1.0, -1.0),
    ] {
        let run = go(&format!("{begin}{block}"));
        assert!(run.refused.is_none(), "{block}: {:?}", run.refused);
        let feed = feed(&run.steps[2].motions[0]);
        assert_eq!((feed.end.linear_mm[0], feed.end.rotary_deg[0]), (x, a), "{block}");
        assert_eq!((feed.start.rotary_deg[0], feed.division), (0.0, Division::Any), "{block}");
    }
    assert_eq!(code("G1 A60. F500.\n"), Some((213, 1)));
    assert_eq!(code(&format!("{begin}G1 A0. F500.\n")), None);
    assert_eq!(code(&format!("{begin}G28 A0.\nG1 X5.\n")), Some((213, 4)));
    assert_eq!(code(&format!("{begin}G28\nG0 X5.\n")), Some((213, 4)));
}

#[test]
fn what_is_not_understood_is_refused() {
    let table = [
        ("fanuc", "G251\n", 207),
        ("fanuc", "G1.23\n", 207),
        ("fanuc", "X10.\nG-1\n", 207),
        ("fanuc", "G1 X#1\n", 202),
        ("fanuc", "G1 X[1+2]\n", 202),
        ("fanuc", "#1=5\n", 202),
        ("fanuc", "IF[#1EQ2]GOTO10\n", 202),
        ("linuxcnc", "O100 sub\n", 202),
        ("fanuc", "G1 X\n", 211),
        ("fanuc", "G1 X1.2.3\n", 101),
        ("fanuc", "G0 X1.,R5.\n", 225),
        ("fanuc", "G0 X1. R5.\n", 225),
        ("fanuc", "G1 I1.\n", 225),
        ("linuxcnc", "X10\n", 212),
        ("linuxcnc", "G0 X1 Y1 Z1\nG80\nX10\n", 212),
        ("linuxcnc", "R10\n", 225),
    ];
    for (name, text, code) in table {
        let line = text.lines().count() as u64;
        // Fanuc starts with G0 in force: a first block of X alone is a rapid there.
        assert_eq!(refusal(name, text), (code, line), "{name}: {text}");
    }
}

#[test]
fn words_without_motion_pass() {
    let text = "%\nO1234 (NAME)\nN10 T1 S5000 M3 D2 E5\nM8 M123 M7.5\n\n(comment) ; \nG61 G64.\nM0 M1\n";
    let text = text.replace("G61 G64.\n", "G64\n");
    let run = run("fanuc", &text);
    assert!(run.refused.is_none(), "{:?}", run.refused);
    assert!(run.steps.iter().all(|step| step.motions.is_empty() && !step.ends_program));
}

#[test]
fn g80_gives_back_the_motion_code_where_it_has_a_group_of_its_own() {
    assert_eq!(end("fanuc", &after("G81 Z-1. R.005\nG80\nX5.\n")), at(5.0, 0.0, 0.01));
    assert_eq!(refusal("linuxcnc", &after("G98 G81 Z-1 R1\nG80\nX5\n")), (212, 4));
}

#[test]
fn the_program_ends_once() {
    for end in ["M2\n", "M30\n", "G1 X1. M30\n"] {
        let run = run("fanuc", &after(&format!("{end}G251 M98\nG1 S9.\n%\n(((\n")));
        assert!(run.refused.is_none(), "{:?}", run.refused);
        assert_eq!(run.modal.progress, Progress::Ended);
        let ended: Vec<bool> = run.steps.iter().map(|step| step.ends_program).collect();
        assert_eq!(ended[..2], [false, true]);
        assert!(ended[2..].iter().all(|ended| *ended));
        assert!(run.steps[2..].iter().all(|step| step.motions.is_empty()));
    }
    // A second program in the file is not left uncorrected in silence.
    for behind in ["M30\n%\nO2\nG0 X1.\n%\n", "M30\nO2\nX#1\nM99\n%\n", "%\nO2\nG91 G1 Z-1.\nM30\n%\n"] {
        assert_eq!(refusal("fanuc", &format!("%\nO1\nG0 X1.\n{behind}")).0, 228, "{behind}");
    }
    let run = run("fanuc", "leader text\n%\nO1\nG0 X1.\n%\nG251 X5. after\n");
    assert!(run.refused.is_none(), "{:?}", run.refused);
    assert_eq!(run.steps.iter().filter(|step| !step.motions.is_empty()).count(), 1);
    assert_eq!(run.modal.progress, Progress::Ended);
}

#[test]
fn tool_change_beside_a_motion() {
    assert_eq!(refusal("fanuc", &after("M6 T1 X5.\n")), (226, 2));
    let motions = motions("fanuc", &after("M6 T1\nG28 Z0 M6\n"));
    assert_eq!(uncorrected(&motions[1]).linear_mm, [None; 3]);
    assert_eq!(motions.len(), 3);
}

#[test]
fn probing_is_a_motion_code_on_linuxcnc() {
    assert_eq!(refusal("linuxcnc", &after("G1 X1\nG38.2 Z-5\nX5\n")), (212, 4));
    let motions = motions("linuxcnc", &after("G38.2 Z-5\nG0 Z5\nG1 X1\n"));
    assert_eq!(uncorrected(&motions[1]).linear_mm, [Some(0.0), Some(0.0), None]);
}

#[test]
fn block_delete_that_changes_nothing_passes() {
    let run = run("fanuc", &after("/M8\n/2 (comment)\n/N10 T2 S100\n/G90 G54\nG1 X5.\n"));
    assert!(run.refused.is_none(), "{:?}", run.refused);
    assert_eq!(run.modal.tool_selected, None);
}

#[test]
fn block_delete_that_sets_is_refused() {
    for block in
        ["/G91\n", "/G20\n", "/G18\n", "/G93\n", "/G55\n", "/G43 H1\n", "/G41 D1\n", "/G81 Z-1. R1. K0\n"]
    {
        assert_eq!(refusal("fanuc", &after(&format!("{block}(nothing yet)\nM8\n"))), (222, 4), "{block}");
    }
    assert_eq!(refusal("linuxcnc", &after("/G90.1\nM8\n")), (222, 3));
    assert_eq!(refusal("fanuc", &after("G1 X5. /Y5.\n")), (222, 2));
    let holes = "/G99\n/G80\n/G0 X5.\nG0 X0 Y0 Z5.\nG81 X1. Y1. Z-1. R1.\n";
    assert_eq!(refusal("fanuc", &after(holes)), (222, 6));
    assert_eq!(refusal("fanuc", &after("G99 G81 X1. Y1. Z-1. R1.\n/G80\nX2.\n")), (222, 4));
}

#[test]
fn blocks_that_may_be_skipped_together_go_on_from_each_other() {
    let section = "/G1 Z-1. F100.\n\n/X6.\n(in between)\n/G91 X1.\n/G90\n";
    let run = run("fanuc", &after(&format!("{section}G0 X0 Y0 Z5.\nG1 X1.\n")));
    assert!(run.refused.is_none(), "{:?}", run.refused);
    assert_eq!(feed(&run.steps[3].motions[0]).end.linear_mm, [6.0, 0.0, -1.0]);
    assert_eq!(feed(&run.steps[5].motions[0]).end.linear_mm, [7.0, 0.0, -1.0]);
    // The next block is right whether they were executed or not: it may rely on no axis, and on no code.
    assert_eq!(refusal("fanuc", &after(&format!("{section}X8.\n"))), (222, 8));
    assert_eq!(refusal("fanuc", &after(&format!("{section}G1 X8.\n"))), (213, 8));
    // Another switch is another section.
    assert_eq!(refusal("fanuc", &after("/G1 X5.\n/2 Y5.\n")), (222, 3));
    assert_eq!(refusal("fanuc", &after("/2 G1 X5.\n/3 G1 Y5.\n")), (213, 3));
    assert_eq!(end("fanuc", &after("/G1 X5.\n/1 Y5.\n")), at(5.0, 5.0, 0.01));
}

#[test]
fn block_delete_that_moves_loses_the_position_until_all_axes_are_named() {
    assert_eq!(refusal("fanuc", &after("G1 Y1.\n/X5.\nX6.\n")), (213, 4));
    assert_eq!(refusal("fanuc", &after("/G0 X5.\nG0 X6. Y1.\nG1 X5.\n")), (213, 4));
    assert_eq!(end("fanuc", &after("/G0 X5.\nG0 X6. Y1.\nZ5.\nG1 X5.\n")), at(5.0, 1.0, 5.0));
    // The motion code that may have been skipped must be written again.
    assert_eq!(refusal("fanuc", &after("/G1 X5.\nX6. Y1. Z5.\n")), (222, 3));
    let run = run("fanuc", &after("/G1 X5.\nM8\n"));
    assert_eq!(run.modal.motion, MotionMode::Undecided { line: 2 });
    feed(&run.steps[1].motions[0]);
}

#[test]
fn block_delete_at_the_end_of_the_program() {
    let run = run("fanuc", &after("/M30\nG1 X5.\nM30\n"));
    assert!(run.refused.is_none(), "{:?}", run.refused);
    let ended: Vec<bool> = run.steps.iter().map(|step| step.ends_program).collect();
    assert_eq!(ended, [false, false, false, true]);
    feed(&run.steps[2].motions[0]);
}

/// G49 is a tool offset in one standard and the end of the length in others, and G40 may end it too.
#[test]
fn tool_lengths_after_gost() {
    let code = |text: &str| {
        run("perspektiva", text).refused.map(|(line, diagnostics)| (diagnostics[0].code.0, line))
    };
    let begin = "G17 G40 G49 G54 G90\nG0 X1. Y1. Z200.\nG43 H1 Z200.\n";
    assert_eq!(code(begin), None);
    assert_eq!(code(&format!("{begin}G49\n")), Some((215, 4)));
    assert_eq!(code("G49 H1\n"), Some((215, 1)));
    assert_eq!(code(&format!("{begin}G40\nG1 X2. F10.\n")), Some((215, 4)));
    assert_eq!(code(&format!("{begin}G43 H0\nG49\nG40\n")), None);
    assert_eq!(code(&format!("{begin}G40 G43 H1\nG1 X2. F10.\n")), None);
}

/// LinuxCNC's reference: H0 is the tool in the spindle on tool changers that are not random.
#[test]
fn h0_is_the_loaded_tool_of_linuxcnc() {
    assert_eq!(end("linuxcnc", "T1 M6\nG43 H0\nG0 X0 Y0 Z5\n"), at(0.0, 0.0, 125.0));
    assert_eq!(end("linuxcnc", "T0 M6\nG43 H0\nG0 X0 Y0 Z5\n"), at(0.0, 0.0, 5.0));
    assert_eq!(refusal("linuxcnc", "G43 H0\n"), (215, 1));
    assert_eq!(motions("fanuc", "G43 H0\nG0 X0. Y0. Z5.\n").len(), 1);
}

/// What a tool change leaves is the machine's affair, and may be said.
#[test]
fn axes_behind_a_tool_change() {
    let text = "G0 X1. Y2. Z50.\nT1 M6\nG1 X5. F10.\n";
    let told =
        |tool_change: [AfterChange; 3]| run_with(dialect("fanuc"), &Setup { tool_change, ..setup() }, text);
    let refused = told([AfterChange::Unknown; 3]).refused.unwrap();
    assert_eq!((refused.0, refused.1[0].code.0), (3, 213));
    assert!(refused.1[0].label.english().contains("the tool change M6 in line 2"), "{}", refused.1[0].label);
    let help = refused.1[0].help.as_ref().map(|help| help.english()).unwrap_or_default();
    assert!(help.contains("tool_change") && !help.contains("--start-at"), "{help}");
    let stays = told([AfterChange::Stays; 3]);
    assert!(stays.steps[1].motions.is_empty());
    assert_eq!(feed(&stays.steps[2].motions[0]).start.linear_mm, [1.0, 2.0, 50.0]);
    let place = told([AfterChange::Stays, AfterChange::Stays, AfterChange::At(350.0)]);
    let last = place.steps[1].motions.last().unwrap();
    assert_eq!(uncorrected(last).linear_mm, at(1.0, 2.0, 350.0));
    assert_eq!(feed(&place.steps[2].motions[0]).start.linear_mm, [1.0, 2.0, 350.0]);
    let partly = told([AfterChange::Unknown, AfterChange::Stays, AfterChange::At(350.0)]).refused.unwrap();
    assert!(partly.1[0].label.english().starts_with("X not known"), "{}", partly.1[0].label);
    // M codes that move by themselves are named, and are no tool changes.
    let pallet = run("fanuc", "G0 X1. Y2. Z50.\nM60\nG1 X5. F10.\n").refused.unwrap();
    assert!(pallet.1[0].label.english().contains("M60 in line 2"), "{}", pallet.1[0].label);
}

#[test]
fn counts_of_holes() {
    let begin = "G0 X0. Y0. Z5.\nG91 G99\n";
    let holes = |name: &str, block: &str| {
        run(name, &format!("{begin}{block}")).steps[2..].iter().map(|s| s.motions.len()).sum::<usize>()
    };
    assert_eq!(holes("fanuc", "G81 X1. Z-2. R-1. K3 F10.\n"), 3);
    assert_eq!(holes("linuxcnc", "G81 X1. Z-2. R-1. L3 F10.\n"), 3);
    for (name, block) in [
        ("fanuc", "G81 X1. Z-2. R-1. L3 F10.\n"),
        ("fanuc", "G81 X1. Z-2. R-1. L0 F10.\n"),
        ("fanuc", "G83 X1. Z-2. R-1. I1. J.5 K1 F10.\n"),
        ("linuxcnc", "G81 X1. Z-2. R-1. K3 F10.\n"),
        ("linuxcnc", "G81 X1. Z-2. R-1. L0 F10.\n"),
        ("perspektiva", "G81 X1. Z-2. R-1. L3 F10.\n"),
    ] {
        assert_eq!(refusal(name, &format!("{begin}{block}")), (217, 3), "{name} {block}");
    }
}

#[test]
fn a_tool_that_would_point_into_its_spindle_was_touched_off() {
    let touched = Setup { tools: vec![(1, [0.0, 0.0, -350.0]), (2, [0.0; 3])], ..setup() };
    let matters = Setup { lever_matters: true, ..touched.clone() };
    let said = Setup { gauge_point_mm: Some(-470.0), ..matters.clone() };
    let tool_z = |setup: &Setup, text: &str| {
        let run = run_with(dialect("fanuc"), setup, text);
        match &run.refused {
            None => Ok(run.steps.last().expect("a step").context.tool_mm[2]),
            Some((line, diagnostics)) => {
                Err((*line, diagnostics[0].code, diagnostics[0].message.english().to_owned()))
            }
        }
    };
    let text = "G90 G21 G54\nG43 H1 Z100.\n";
    assert_eq!(tool_z(&touched, text), Ok(350.0), "nothing acts along the tool");
    let message = "H1 shifts Z by -350 mm: a tool -350 mm long".to_owned();
    assert_eq!(tool_z(&matters, text), Err((2, diagnostic::Code(215), message)));
    assert_eq!(tool_z(&said, text), Ok(-120.0));
    assert_eq!(tool_z(&said, "G90 G21 G54\nG43 H2 Z100.\n"), Ok(-470.0));
    // A table's 0 is no length; H0 is none by its meaning.
    let message = "H2 shifts Z by 0 mm: a tool 0 mm long".to_owned();
    assert_eq!(tool_z(&matters, "G90 G21 G54\nG43 H2 Z100.\n"), Err((2, diagnostic::Code(215), message)));
    assert_eq!(tool_z(&said, "G90 G21 G54\nG43 H0 Z100.\n"), Ok(0.0));
    assert_eq!(tool_z(&matters, "G90 G21 G54\nG44 H1 Z100.\n"), Ok(-350.0), "G44 subtracts it");
    // Who says that lengths count from the point that was measured may have tools that end above it.
    let measured_at_a_tip = Setup { gauge_point_mm: Some(0.0), ..matters };
    assert_eq!(tool_z(&measured_at_a_tip, text), Ok(350.0));
}
