//! One block, one piece: which bytes change.

use crate::common;

use common::{dialect, least_increment, piece, read, rewritten};
use nc_emit::Emitter;

/// `(text before and the block, piece, block afterwards)`
type Case = (&'static str, &'static str, &'static str);

#[track_caller]
fn check(dialect: &nc_dialect::Dialect, cases: &[Case]) {
    for (text, edit, expected) in cases {
        assert_eq!(&rewritten(dialect, text, &[edit]), expected, "`{text}` with `{edit}`");
    }
}

#[test]
fn a_number_is_replaced_and_nothing_else() {
    check(
        &dialect(),
        &[
            ("G1 X10.500 Y5.000 F100\r\n", "G1 X10.512 Y5.001", "G1 X10.512 Y5.001 F100\r\n"),
            ("n10g1x10.500y5.000 (x10)\n", "G1 X10.512", "n10g1x10.512y5.000 (x10)\n"),
            ("G1  X 10.500\tY 5.000 \n", "G1 X-10.512", "G1  X -10.512\tY 5.000 \n"),
            ("N5 G01 Z-1.000 M8 ; deep", "G1 Z-1.002", "N5 G01 Z-1.002 M8 ; deep"),
        ],
    );
}

#[test]
fn equal_values_keep_their_text() {
    check(
        &dialect(),
        &[
            ("G1 X10.5 Y+5 Z0\n", "G1 X10.500 Y5.000 Z0.000", "G1 X10.5 Y+5 Z0\n"),
            ("G1 X=10.5 Y= 5\n", "G1 X10.600 Y5.100", "G1 X=10.6 Y= 5.1\n"),
            ("G1 X10.5 Y5\n", "G1 X= Y=", "G1 X10.5 Y5\n"),
        ],
    );
    check(
        &least_increment(),
        &[
            ("G1 X100 Y100.\n", "G1 X0.100 Y100.000", "G1 X100 Y100.\n"),
            ("G1 X100\n", "G1 X100.000", "G1 X100000\n"),
        ],
    );
}

#[test]
fn spelling_follows_the_word_replaced() {
    check(
        &dialect(),
        &[
            ("G1 X10.000\n", "G1 X12.500", "G1 X12.500\n"),
            ("G1 X10.\n", "G1 X12.500", "G1 X12.5\n"),
            ("G1 X10.\n", "G1 X12.000", "G1 X12.\n"),
            ("G1 X10\n", "G1 X12.012", "G1 X12.012\n"),
            ("G1 X10\n", "G1 X12.000", "G1 X12\n"),
            ("G1 X.5\n", "G1 X0.250", "G1 X.25\n"),
            ("G1 X0.5\n", "G1 X0.250", "G1 X0.25\n"),
            ("G1 X-.500\n", "G1 X0.250", "G1 X.250\n"),
            ("G1 X+10.000\n", "G1 X12.000", "G1 X+12.000\n"),
            ("G1 X+10.000\n", "G1 X-12.000", "G1 X-12.000\n"),
            ("G1 X-0.001\n", "G1 X0.000", "G1 X0.000\n"),
            ("G1 X10.5\n", "G1 X10.000", "G1 X10.\n"),
        ],
    );
}

#[test]
fn inserted_words_are_spelt_as_the_file_does() {
    check(
        &dialect(),
        &[
            ("G1 X10.000\nY5.123\n", "G1 X10.010 Y5.123", "X10.010 Y5.123\n"),
            ("G1 X10.\nM8\nG1 Y5.123\n", "G1 X10.010 Y5.120", "G1 X10.01 Y5.12\n"),
            ("G1 X10\nY5.123\n", "G1 X10.000", "X10 Y5.123\n"),
            ("G1 X+.5\nY-1.\n", "G1 X0.250", "X+.25 Y-1.\n"),
        ],
    );
}

#[test]
fn a_point_free_length_never_changes_its_meaning() {
    check(
        &least_increment(),
        &[
            ("G1 X100\n", "G1 X0.112", "G1 X112\n"),
            ("G1 X100\n", "G1 X0.11", "G1 X110\n"),
            ("G1 X100\n", "G1 X0.1125", "G1 X0.1125\n"),
            ("G1 X100\n", "G1 X2.0000", "G1 X2.\n"),
            ("G1 X10.\n", "G1 X12.000", "G1 X12.\n"),
            ("G1 X10.5\nY0\n", "G1 Y0.200", "Y0.2\n"),
            ("G1 X10.5\nY0\n", "G1 X10.000", "X10. Y0\n"),
            ("G1 X105\nY0\n", "G1 X0.010 Y-0.200", "X10 Y-200\n"),
            ("G20 G1 X105\nY0\n", "G1 X0.0100", "X100 Y0\n"),
            ("G1 X100 F120\n", "G1 X0.112 F60.000", "G1 X112 F60\n"),
            ("G1 X100 F120\n", "G1 X0.112 F60.500", "G1 X112 F60.5\n"),
        ],
    );
}

#[test]
fn missing_words_go_to_their_place() {
    check(
        &dialect(),
        &[
            ("G1 Y5.000\n", "G1 X1.000", "G1 X1.000 Y5.000\n"),
            ("G1 X5.000 F10\n", "G1 Y1.000 Z2.000", "G1 X5.000 Y1.000 Z2.000 F10\n"),
            ("G1 X5.000 Z1.000\n", "G1 Y1.000", "G1 X5.000 Y1.000 Z1.000\n"),
            ("G2 X5.000 R4.000 F10\n", "G2 R- I1.000 J2.000", "G2 X5.000 I1.000 J2.000 F10\n"),
            ("G2 X5.000 R4.000\n", "G2 Y1.000 I0.000 J1.000 R-", "G2 X5.000 Y1.000 I0.000 J1.000\n"),
            ("G2 I5.000\n", "G2 X1.000 Y2.000 J1.000", "G2 X1.000 Y2.000 I5.000 J1.000\n"),
            ("N10 G90 G1 F100 (c)\n", "G1 X1.000", "N10 G90 G1 X1.000 F100 (c)\n"),
            ("G1X5.000Y6.000\nG1Y5.000\n", "G1 X1.000 Z3.000", "G1X1.000Y5.000Z3.000\n"),
            ("G1 X5.000 (X wall) \n", "G1 Y1.000", "G1 X5.000 Y1.000 (X wall) \n"),
            ("G1 Y5.000 (wall)", "G1 X1.000 Z2.000", "G1 X1.000 Y5.000 Z2.000 (wall)"),
            ("G1 (here) Y5.000\n", "G1 X1.000 F10.0", "G1 (here) X1.000 Y5.000 F10\n"),
            ("g1y5.000\n", "G1 X1.000", "g1x1.000y5.000\n"),
            ("/ Y5.000\n", "G0 X1.000", "/ X1.000 Y5.000\n"),
        ],
    );
}

#[test]
fn removed_words_take_their_blanks_along() {
    check(
        &dialect(),
        &[
            ("G1 X1.000 Y2.000 (c)\n", "G1 Y-", "G1 X1.000 (c)\n"),
            ("X1.000  Y2.000\n", "G0 X-", "Y2.000\n"),
            ("G1X1.000Y2.000F5\n", "G1 X-", "G1Y2.000F5\n"),
            ("X1.000 (c)\n", "G0 X- Y2.000", "Y2.000 (c)\n"),
            ("G1 X1.000\n", "G1 Y-", "G1 X1.000\n"),
        ],
    );
}

#[test]
fn the_motion_code_in_force_is_the_one_asked_for() {
    check(
        &dialect(),
        &[
            ("G2 X1.000 R5.000\n", "G1 R-", "G1 X1.000\n"),
            ("G02 X1.000 R5.000\n", "G1 R-", "G01 X1.000\n"),
            ("G1 X1.000\nY2.000\n", "G1 Y2.001", "Y2.001\n"),
            ("G1 X1.000\nY2.000\n", "G2 Y2.001", "G2 Y2.001\n"),
            ("G01 X1.000\nN20 Y2.000\n", "G2 Y2.001", "N20 G02 Y2.001\n"),
            ("G0 X1.000\n/N20 G90 Y2.000\n", "G1 Y2.001", "/N20 G1 G90 Y2.001\n"),
            ("G0X1.000Y1.000\nY2.000\n", "G1 X0.000", "G1X0.000Y2.000\n"),
            ("G0 G80 Z5.000\nX1.000\n", "G0 X1.000", "X1.000\n"),
            ("G80 G0 Z5.000\nX1.000\n", "G0 X1.000", "X1.000\n"),
            ("G80 G0 X1.000\n", "G0 X1.001", "G80 G0 X1.001\n"),
            ("G81 X1.000 Z-5.000 R1.000 F9\n", "G0 Z- R- X1.001", "G0 X1.001 F9\n"),
        ],
    );
}

#[test]
fn what_cannot_be_edited_is_an_error_and_writes_nothing() {
    let dialect = dialect();
    for (text, edit, expected) in [
        ("G1 X#1 Y5.\n", "G1 X1.000", "error[VP0603]: X has no plain number, so it cannot be corrected"),
        ("G1 X1. X5.\n", "G1 X1.000", "error[VP0603]: the block has two X words"),
        ("G1 X1.\n", "G1 Y=", "error[VP0603]: the block has no Y word to keep"),
    ] {
        let blocks = read(&dialect, text);
        let mut out = b"before".to_vec();
        let error = Emitter::new(&dialect).rewrite(&blocks[0], &[piece(edit)], &mut out).unwrap_err();
        assert_eq!(error.to_string(), expected);
        assert_eq!(out, b"before");
    }
}

#[test]
fn a_block_that_becomes_too_long_is_an_error() {
    let mut dialect = dialect();
    dialect.output.max_block_bytes = 20;
    let blocks = read(&dialect, "G1 X1.000 (wall)\n");
    let mut out = Vec::new();
    let mut emitter = Emitter::new(&dialect);
    emitter.rewrite(&blocks[0], &[piece("G1 X111.000")], &mut out).unwrap();
    assert_eq!(out, b"G1 X111.000 (wall)\n");
    let error = emitter.rewrite(&blocks[0], &[piece("G1 Y1.000")], &mut out).unwrap_err();
    assert_eq!(
        error.to_string(),
        "error[VP0601]: the corrected block has 23 characters, the control takes 20"
    );
    // A block that was longer already is the user's text.
    let blocks = read(&dialect, "G1 X1.000 (a long wall)\n");
    emitter.rewrite(&blocks[0], &[piece("G1 X2.000")], &mut out).unwrap();
}
