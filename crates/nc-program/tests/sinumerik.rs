//! What Siemens' mills have of their own: edges of tools, the program's frame, machine coordinates by name.

use crate::common;

use common::{dialect, run, run_with, setup};
use nc_program::process::{Said, said};
use nc_program::{Interpreter, Setup};
use nc_syntax::{Block, Reader};

/// Axis commands at the end of a program, mm.
fn ends(program: &str) -> [f64; 3] {
    ends_with(&setup(), program)
}

fn ends_with(setup: &Setup, program: &str) -> [f64; 3] {
    let run = run_with(dialect("sinumerik"), setup, &format!("G17 G71 G90 G54\n{program}"));
    if let Some((line, refused)) = &run.refused {
        panic!("line {line} of {program:?}: {refused:#?}");
    }
    run.modal.axes.linear.map(|axis| (axis.known().expect("known") * 1e9).round() / 1e9)
}

fn refused(program: &str) -> (u64, u16) {
    let (line, why) = run("sinumerik", &format!("G17 G71 G90 G54\n{program}")).refused.expect("refused");
    (line - 1, why[0].code.0)
}

#[test]
fn d_is_the_edge_of_the_tool_that_is_in() {
    assert_eq!(ends("T1\nM6\nD1\nG0 X1 Y2 Z3\n"), [1.0, 2.0, 123.0]);
    assert_eq!(ends("T1 M6 D1\nG0 X1 Y2 Z3\n"), [1.0, 2.0, 123.0]);
    // T selects the next tool, D0 ends the length of this one.
    assert_eq!(ends("T1\nM6\nD1\nG0 X1 Y2 Z3\nT2\nX5\n"), [5.0, 2.0, 123.0]);
    assert_eq!(ends("T1\nM6\nD1\nT2\nM6\nD1\nG0 X1 Y2 Z3\n"), [1.5, 2.0, 83.0]);
    assert_eq!(ends("T1\nM6\nD1\nG0 X1 Y2 Z3\nD0\nZ3\n"), [1.0, 2.0, 3.0]);
}

#[test]
fn what_a_parameter_chooses_is_said_or_refused() {
    assert_eq!(refused("T1 D1\nM6\nG0 X1 Y2 Z3\n"), (3, 215));
    assert_eq!(refused("T1\nG0 X1 Y2 Z3\n"), (2, 215));
    assert_eq!(refused("D1\nG0 X1 Y2 Z3\n"), (2, 215));
    // A full circle names its centre alone.
    assert_eq!(refused("G0 X1 Y2 Z3\nT1\nG2 I5\n"), (3, 215));
    assert_eq!(refused("M6\n"), (1, 215));
    assert_eq!(refused("T1\nM6\nD2\n"), (3, 215));
    assert_eq!(refused("T3\nM6\nD1\n"), (3, 215));
    let first = Setup { edge_at_change: Some(1), ..setup() };
    assert_eq!(ends_with(&first, "T1 D1\nM6\nG0 X1 Y2 Z3\n"), [1.0, 2.0, 123.0]);
    let none = Setup { edge_at_change: Some(0), ..setup() };
    assert_eq!(ends_with(&none, "T1\nM6\nG0 X1 Y2 Z3\n"), [1.0, 2.0, 3.0]);
}

#[test]
fn tools_have_names() {
    let named = Setup { tool_names: vec![("MILL 12".to_owned(), 2)], ..setup() };
    assert_eq!(ends_with(&named, "T=\"mill 12\"\nM6\nD1\nG0 X1 Y2 Z3\n"), [1.5, 2.0, 83.0]);
    assert_eq!(refused("T=\"MILL 12\"\nM6\nD1\n"), (1, 215));
}

#[test]
fn machine_coordinates_are_of_the_spindle_where_no_length_is_in_force() {
    assert_eq!(ends("T1\nM6\nD1\nG0 X1 Y2 Z3\nG0 SUPA Z-5 D0\n"), [1.0, 2.0, -5.0]);
    // Across the tool its length moves nothing.
    assert_eq!(ends("T1\nM6\nD1\nG0 X1 Y2 Z3\nSUPA X7\n"), [7.0, 2.0, 123.0]);
    assert_eq!(refused("T1\nM6\nD1\nG0 X1 Y2 Z3\nSUPA Z-5\n"), (5, 215));
    assert_eq!(refused("T1\nM6\nG0 SUPA Z0\n"), (3, 215));
}

#[test]
fn absolute_frames_take_the_place_of_all_and_additive_ones_add() {
    assert_eq!(ends("TRANS X10 Y20\nG0 X1 Y2 Z3\n"), [11.0, 22.0, 3.0]);
    assert_eq!(ends("TRANS X10 Y20\nTRANS Z5\nG0 X1 Y2 Z3\n"), [1.0, 2.0, 8.0]);
    assert_eq!(ends("TRANS X10 Y20\nATRANS X-3\nG0 X1 Y2 Z3\n"), [8.0, 22.0, 3.0]);
    assert_eq!(ends("TRANS X10 Y20\nTRANS\nG0 X1 Y2 Z3\n"), [1.0, 2.0, 3.0]);
    assert_eq!(ends("ROT RPL=90\nG0 X1 Y2 Z3\n"), [-2.0, 1.0, 3.0]);
    // ROT ends the shift, AROT turns about its zero.
    assert_eq!(ends("TRANS X10 Y20\nROT RPL=90\nG0 X1 Y2 Z3\n"), [-2.0, 1.0, 3.0]);
    assert_eq!(ends("TRANS X10 Y20\nAROT RPL=90\nG0 X1 Y2 Z3\n"), [8.0, 21.0, 3.0]);
    assert_eq!(ends("TRANS X10 Y20\nAROT Z60\nAROT RPL=30\nG0 X1 Y2 Z3\n"), [8.0, 21.0, 3.0]);
    // A shift within a rotation goes along the turned axes.
    assert_eq!(ends("ROT RPL=90\nATRANS X10\nG0 X1 Y2 Z3\n"), [-2.0, 11.0, 3.0]);
    assert_eq!(ends("MIRROR X0\nATRANS X10\nG0 X1 Y2 Z3\n"), [-11.0, 2.0, 3.0]);
    assert_eq!(ends("TRANS X10\nAMIRROR X0 Y0\nG0 X1 Y2 Z3\n"), [9.0, -2.0, 3.0]);
    assert_eq!(ends("MIRROR X0\nAMIRROR X0\nG0 X1 Y2 Z3\n"), [1.0, 2.0, 3.0]);
    assert_eq!(ends("MIRROR X0\nMIRROR\nG0 X1 Y2 Z3\n"), [1.0, 2.0, 3.0]);
    // In inches.
    assert_eq!(ends("G70\nTRANS X1\nG0 X1 Y2 Z3\n"), [50.8, 50.8, 76.2]);
}

#[test]
fn frames_whose_meaning_is_open_are_refused() {
    assert_eq!(refused("ROT RPL=30\nAMIRROR X0\n"), (2, 227));
    assert_eq!(refused("MIRROR X0\nAROT RPL=30\n"), (2, 227));
    assert_eq!(refused("ROT X30\n"), (1, 227));
    assert_eq!(refused("ROT Z30 RPL=30\n"), (1, 227));
    assert_eq!(refused("MIRROR X5\n"), (1, 227));
    assert_eq!(refused("ATRANS\n"), (1, 227));
    assert_eq!(refused("TRANS X5 F100\n"), (1, 227));
    assert_eq!(refused("G0 TRANS X5\n"), (1, 227));
    assert_eq!(refused("G41\nTRANS X5\n"), (2, 227));
}

#[test]
fn the_base_frame_may_be_unknown_while_nothing_moves_in_it() {
    assert_eq!(ends("G500\nG55\nG0 X1 Y2 Z3\n"), [101.0, 12.0, 4.0]);
    assert_eq!(refused("G500\nG0 X1\n"), (2, 214));
    let given =
        Setup { work_offsets: vec![("G500".to_owned(), [7.0; 3]), ("G54".to_owned(), [0.0; 3])], ..setup() };
    assert_eq!(ends_with(&given, "G500\nG0 X1 Y2 Z3\n"), [8.0, 9.0, 10.0]);
}

#[test]
fn the_time_of_a_dwell_is_no_feed() {
    let feeds = |block: &str| {
        let (sinumerik, setup) = (dialect("sinumerik"), setup());
        let mut interpreter = Interpreter::new(sinumerik, &setup);
        let (mut reader, mut read) = (Reader::new(block.as_bytes(), sinumerik), Block::default());
        assert!(reader.next(&mut read));
        let step = interpreter.step(&read).expect("a right block");
        let says = said(&read, sinumerik, &step);
        says.before.iter().filter(|said| matches!(said, Said::Feed(_))).count()
    };
    assert_eq!((feeds("G4 F0.5\n"), feeds("G1 F500\n")), (0, 1));
    // Nor does it end the doubt about an F of G93.
    let program = "G0 X1 Y2 Z3\nG93 G1 X2 F5\nG94\nG4 F0.5\nX3\n";
    assert_eq!(refused(program).0, 5);
    assert_eq!(ends("G0 X1 Y2 Z3\nG93 G1 X2 F5\nG94\nF500\nX3\n"), [3.0, 2.0, 3.0]);
}
