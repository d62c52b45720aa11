//! Which axes a program has itself named in the frame in force: only those may get words that nobody wrote.

use crate::common;

use common::{run, run_with, setup};
use nc_program::Setup;

/// The axes that are not named before the last block, by letter.
fn unnamed(dialect: &str, text: &str) -> String {
    let run = run(dialect, text);
    assert!(run.refused.is_none(), "{text}: {:?}", run.refused);
    let last = run.steps.last().expect("a block");
    "XYZ".chars().zip(last.context.unnamed).filter(|(_, lost)| lost.is_some()).map(|(name, _)| name).collect()
}

/// All axes named, then `code`, then a motion of X.
fn after(code: &str) -> String {
    unnamed("fanuc", &format!("G21 G90 G54\nG43 H1 G0 X0 Y0 Z0\n{code}\nG0 X9.\n"))
}

#[test]
fn absolute_words_of_motions_name_axes() {
    assert_eq!(unnamed("fanuc", "G0 X1.\nX2.\n"), "YZ");
    assert_eq!(unnamed("fanuc", "G0 X1. Y1.\nZ1.\nX2.\n"), "");
    assert_eq!(unnamed("fanuc", "G0 X1. Y1. Z1.\nG91 G1 X1. F9.\nX2.\n"), "");
    // An increment says no place, a dwell's X neither.
    assert_eq!(unnamed("fanuc", "G0 Y1. Z1.\nG4 X1.\nX2.\n"), "X");
    let known = Setup { start_mm: [Some(0.0); 3], ..setup() };
    let run = run_with(common::dialect("fanuc"), &known, "G91 G1 X1. Y1. Z1. F9.\nX2.\n");
    assert!(run.steps[1].context.unnamed.iter().all(Option::is_some));
}

#[test]
fn codes_after_which_controls_differ() {
    for (code, lost) in [
        ("", ""),
        ("M3 S100", ""),
        ("G17 G40 G80 G94", ""),
        ("G54", ""),
        ("G55", "XYZ"),
        ("G55 X1. Z1.", "Y"),
        ("G52 Y1.", "Y"),
        ("G49 Z0\nG92 X1. Z1.", "XZ"),
        ("G10 L2 P2 X0 Z0 Y0", "XYZ"),
        ("G43 H1", "Z"),
        ("G49 Z9.", ""),
        ("G49", "Z"),
        ("H2", "XZ"),
        ("G53 X1.", "XZ"),
        ("G53 Z1.", "Z"),
        ("G28 Z1.", "Z"),
        ("G28", "XYZ"),
        ("M6", "XYZ"),
        ("G21", ""),
        ("G68 X0 Y0 R90.\nX1. Y1.", ""),
        ("G51.1 X0\nG0 X1.\nG50.1 X0\nX2.", ""),
        ("D4", "XYZ"),
        ("G41 D4 G1 X1.", ""),
        ("/G0 X1. Y1. Z1.", "XYZ"),
    ] {
        assert_eq!(after(code), lost, "{code}");
    }
}

/// Where the profile says that a tool change leaves the axes, those along the tool length are still not named: some
/// controls end the length.
#[test]
fn a_tool_change_may_end_the_length() {
    use nc_program::AfterChange;
    let kept = Setup { tool_change: [AfterChange::Stays; 3], ..setup() };
    let lost = |text: &str| {
        let run = run_with(common::dialect("fanuc"), &kept, text);
        run.steps.last().expect("a block").context.unnamed.map(|lost| lost.is_some())
    };
    assert_eq!(lost("G49 G0 X0 Y0 Z0\nT2 M6\nX1.\n"), [false; 3]);
    assert_eq!(lost("G49 G0 X0 Y0 Z0\nG43 H1 Z9.\nT2 M6\nX1.\n"), [false, false, true]);
}

#[test]
fn what_the_program_has_not_said_before_is_as_the_last_program_left_it() {
    let stand = "G0 X0 Y0 Z0\n";
    assert_eq!(unnamed("fanuc", &format!("{stand}G54\nG0 X9.\n")), "XYZ");
    assert_eq!(unnamed("fanuc", &format!("{stand}G21\nG0 X9.\n")), "XYZ");
    assert_eq!(unnamed("fanuc", &format!("{stand}G49\nG0 X9.\n")), "XZ");
}

#[test]
fn a_cycle_names_its_r_level() {
    let cycle = |code: &str| {
        unnamed("fanuc", &format!("G54 G0 X0 Y0 Z50.\nG55\n{code} G81 X1. Y1. Z-1. R2. F9.\nX2.\n"))
    };
    assert_eq!(cycle("G99"), "");
    // Back at a level that no word of G55 has said.
    assert_eq!(cycle("G98"), "Z");
}
