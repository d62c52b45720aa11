//! What tables say of controls whose T changes the tool, whose length is said or not behind it, whose letters are others.

use crate::common::{self, Run, dialect, run_with};
use nc_program::Setup;
use nc_program::modal::Axis;

const T_CHANGES: &str = "heidenhain-iso";

/// A program read with a datum of Heidenhain's too.
fn run(name: &str, program: &str) -> Run {
    let mut setup = common::setup();
    setup.work_offsets.push(("G247".to_owned(), [0.0; 3]));
    run_with(dialect(name), &setup, program)
}

/// Axis commands at the end of a program, mm, those that are known.
fn ends(name: &str, program: &str) -> [Option<f64>; 3] {
    let run = run(name, program);
    if let Some((line, refused)) = &run.refused {
        panic!("line {line} of {program:?}: {refused:#?}");
    }
    run.modal.axes.linear.map(|axis| match axis {
        Axis::At(mm) => Some((mm * 1e9).round() / 1e9),
        Axis::Unknown(_) => None,
    })
}

fn refused(name: &str, program: &str) -> (u64, u16) {
    let (line, why) = run(name, program).refused.expect("refused");
    (line, why[0].code.0)
}

#[test]
fn t_is_a_tool_change_and_brings_in_its_length() {
    let at = |x: f64, y: f64, z: f64| [Some(x), Some(y), Some(z)];
    assert_eq!(ends(T_CHANGES, "T1 G17 S100 *\nG00 X+1 Y+2 Z+3 *\n"), at(1.0, 2.0, 123.0));
    assert_eq!(ends(T_CHANGES, "T1 *\nG00 X+1 Y+2 Z+3 *\nT0 *\nG00 X+1 Y+2 Z+3 *\n"), at(1.0, 2.0, 3.0));
    // Where the axes stand behind it is not known, be M6 beside it or not.
    assert_eq!(ends(T_CHANGES, "G00 X+1 Y+2 Z+3 *\nT1 *\n"), [None; 3]);
    assert_eq!(ends(T_CHANGES, "G00 X+1 Y+2 Z+3 *\nT1 M06 *\n"), [None; 3]);
    assert_eq!(refused(T_CHANGES, "T99 *\n"), (1, 215));
    assert_eq!(refused(T_CHANGES, "M06 *\n"), (1, 215));
}

#[test]
fn behind_percent_stand_a_name_and_words() {
    // The unit stands there alone; the last block says it again, behind its number.
    let program = "%4100 G70 *\nN10 T0 *\nN20 G00 X+1 Y+0 Z+0 *\nN99999999 %4100 G70 *\n";
    assert_eq!(ends(T_CHANGES, program), [Some(25.4), Some(0.0), Some(0.0)]);
    assert_eq!(refused(T_CHANGES, &format!("{program}N30 G00 X+2 *\n")), (5, 228));
}

#[test]
fn whether_the_length_holds_is_said_before_the_tool_moves_along_it() {
    let begin = "G71 G90 G54\nT1 M6\nG0 X1 Y2\n";
    assert_eq!(refused("fagor", &format!("{begin}Z3\n")), (4, 215));
    assert_eq!(refused("fagor", &format!("{begin}G1 X3\n")), (4, 215));
    assert_eq!(ends("fagor", &format!("{begin}G43 Z3\n"))[2], Some(123.0));
    // The next change asks again.
    assert_eq!(refused("fagor", &format!("{begin}G43 Z3\nT2 M6\nG0 Z3\n")), (6, 215));
}

#[test]
fn letters_that_the_table_refuses_are_refused_by_their_row() {
    for (line, why) in [
        ("G1 X1 Q45", "Q45 is refused: gives an angle from a pole"),
        ("G1 X1 D1", "D1 is refused: names a tool offset (8055) or an edge of the tool (8065)"),
        ("G8 X1 Q45", "G8 is refused: cuts an arc tangent to the block before"),
    ] {
        let refused = run("fagor", &format!("G71 G90 G54\n{line}\n")).refused.expect("refused").1;
        assert_eq!(refused[0].message.english(), why);
    }
    let refused = run(T_CHANGES, "L1,3 *\n").refused.expect("refused").1;
    assert_eq!(refused[0].message.english(), "L1,3 is refused: calls a label");
}

#[test]
fn n_behind_words_repeats_its_block_where_the_table_says_so() {
    assert_eq!(refused("fagor", "G71 G90 G54\nG0 X1 N3\n"), (2, 217));
    assert_eq!(run("fanuc", "G21 G90 G54\nG0 X1. N3\n").refused, None);
    assert_eq!(run("fagor", "N1 G71 G90 G54\n/N2 G0 X1\n").refused, None);
}

#[test]
fn a_dwell_needs_the_time_that_the_table_names() {
    for (block, taken) in
        [("G4 K50", true), ("G4", false), ("G4 K0", false), ("G4 P50", false), ("G4 K5 X1", false)]
    {
        let refused = run_with(dialect("fagor"), &Setup::default(), &format!("{block}\n")).refused;
        assert_eq!(refused.is_none(), taken, "{block}");
    }
}
