//! One block becomes several; whole programs as snapshots.

use crate::common;

use common::{dialect, piece, read, rewritten};
use nc_emit::{BlockNumbers, Emitter, Piece};

#[test]
fn later_pieces_are_new_blocks() {
    let cases: &[(&str, &[&str], &str)] = &[
        ("G1 X10.000 F100\r\n", &["G1 X5.000", "G1 X10.000 Y0.001"], "G1 X5.000 F100\r\nX10.000 Y0.001\r\n"),
        ("G1X10.000Y0.000F100\n", &["G1 X5.000", "G1 X10.000 Y0.001"], "G1X5.000Y0.000F100\nX10.000Y0.001\n"),
        ("/ G1 X10. (wall)\n", &["G1 X5.0", "G1 X10.0"], "/ G1 X5. (wall)\n/ X10.\n"),
        ("G1 X10.", &["G1 X5.0", "G1 X10.0"], "G1 X5.\nX10."),
        ("G0 X1.\r\nG1 X10.", &["G1 X5.0", "G1 X10.0"], "G1 X5.\r\nX10."),
        ("G2 X10. R5.\n", &["G2 X5.0 R5.0", "G2 X10.0 R5.0"], "G2 X5. R5.\nX10. R5.\n"),
        ("G2 X10. R5.\n", &["G1 X5.0 R-", "G1 X10.0"], "G1 X5.\nX10.\n"),
        (
            "G81 X1. Z-5. R2. F9\n",
            &["G0 Z- R-", "G0 Z2.0", "G1 Z-5.0", "G0 Z9.0"],
            "G0 X1. F9\nZ2.\nG1 Z-5.\nG0 Z9.\n",
        ),
        ("G1 X10. F120.\n", &["G1 X5.0 F240.0", "G1 X10.0 F240.0"], "G1 X5. F240.\nX10. F240.\n"),
        ("G1 X10. F120.\n", &["G1 X5.0 F=", "G1 X10.0 F="], "G1 X5. F120.\nX10. F120.\n"),
    ];
    for (text, pieces, expected) in cases {
        assert_eq!(&rewritten(&dialect(), text, pieces), expected, "`{text}`");
    }
}

#[test]
fn what_runs_after_the_motion_goes_last() {
    let two: &[&str] = &["G1 X5.000", "G1 X10.000"];
    assert_eq!(
        rewritten(&dialect(), "G9 G1 X10.000 M8 M5 M30 (end)\n", two),
        "G1 X5.000 M8 (end)\nX10.000 G9 M5 M30\n"
    );
    assert_eq!(rewritten(&dialect(), "G9 G1 X10.000 M5\n", &["G1 X9.000"]), "G9 G1 X9.000 M5\n");
}

#[test]
fn inserted_numbers_occur_nowhere_else() {
    let three: &[&str] = &["G1 X1.0", "G1 X2.0", "G1 X3.0"];
    for (text, expected) in [
        ("N30 X0.\nN10 G1 X3.\n", "N10 G1 X1.\nN11 X2.\nN12 X3.\n"),
        ("N12 X0.\nN10 G1 X3.\n", "N10 G1 X1.\nX2.\nX3.\n"),
        ("N13 X0.\nN10 G1 X3.\n", "N10 G1 X1.\nN11 X2.\nN12 X3.\n"),
        ("N10 X0.\nN10 G1 X3.\n", "N10 G1 X1.\nX2.\nX3.\n"),
        ("N5 X0.\nG1 X3.\n", "G1 X1.\nX2.\nX3.\n"),
        ("N0010G1X3.\n", "N0010G1X1.\nN0011X2.\nN0012X3.\n"),
        ("/N10 G1 X3.\n", "/N10 G1 X1.\n/ N11 X2.\n/ N12 X3.\n"),
        ("N99998 G1 X3.\n", "N99998 G1 X1.\nX2.\nX3.\n"),
    ] {
        assert_eq!(rewritten(&dialect(), text, three), expected, "`{text}`");
    }
    let mut plain = dialect();
    plain.output.number_inserted_blocks = false;
    assert_eq!(rewritten(&plain, "N10 G1 X3.\n", three), "N10 G1 X1.\nX2.\nX3.\n");
}

#[test]
fn the_mark_that_ends_a_block_ends_every_piece() {
    for (mark, block, pieces) in
        [(b';', "G1 X10.;\n", "G1 X5.;\nX10.;\n"), (b'*', "G1 X10. *\n", "G1 X5. *\nX10.*\n")]
    {
        let mut dialect = dialect();
        dialect.marks.end_of_block = Some(mark);
        let blocks = read(&dialect, block);
        let mut out = Vec::new();
        Emitter::new(&dialect).rewrite(&blocks[0], &[piece("G1 X5.0"), piece("G1 X10.0")], &mut out).unwrap();
        assert_eq!(String::from_utf8(out).unwrap(), pieces);
    }
}

/// Rewrites the lines named, passes the others.
fn program(text: &str, edits: &[(u64, &[&str])]) -> String {
    let dialect = dialect();
    let blocks = read(&dialect, text);
    let mut numbers = BlockNumbers::new();
    blocks.iter().for_each(|block| _ = numbers.see(block));
    let mut emitter = Emitter::new(&dialect).with_numbers(&numbers);
    let mut out = Vec::new();
    for block in &blocks {
        match edits.iter().find(|(line, _)| *line == block.line) {
            Some((_, pieces)) => {
                let pieces: Vec<Piece> = pieces.iter().map(|text| piece(text)).collect();
                emitter.rewrite(block, &pieces, &mut out).expect("rewritten");
            }
            None => emitter.pass(block, &mut out),
        }
    }
    String::from_utf8(out).expect("text")
}

#[test]
fn a_contour_with_numbers() {
    let text = "\
%
O1234 (POCKET)
N10 G21 G90
N20 G0 X0.000 Y0.000 (over the pocket)
N30 Z2.000 M8
N40 G1 Z-1.000 F100.
N50 X60.000 F600.
N60 G2 X70.000 Y10.000 I0.000 J10.000
N70 G1 Y40.000
N80 X0.000 M9
N90 M30
%
";
    insta::assert_snapshot!(program(text, &[
        (4, &["G0 X0.012 Y-0.003"]),
        (5, &["G0 Z2.001"]),
        (6, &["G1 X0.013 Y-0.003 Z-1.002"]),
        (7, &["G1 X30.010 Y-0.004", "G1 X60.021 Y-0.006"]),
        (8, &["G2 X67.080 Y2.931 I0.001 J10.002", "G1 X70.022 Y10.004"]),
        (9, &["G1 X70.020 Y40.011"]),
        (10, &["G1 X35.010 Y40.009", "G1 X0.011 Y40.008"]),
    ]), @r"
    %
    O1234 (POCKET)
    N10 G21 G90
    N20 G0 X0.012 Y-0.003 (over the pocket)
    N30 Z2.001 M8
    N40 G1 X0.013 Y-0.003 Z-1.002 F100.
    N50 X30.010 Y-0.004 F600.
    N51 X60.021 Y-0.006
    N60 G2 X67.080 Y2.931 I0.001 J10.002
    N61 G1 X70.022 Y10.004
    N70 G1 X70.020 Y40.011
    N80 X35.010 Y40.009
    N81 X0.011 Y40.008 M9
    N90 M30
    %
    ");
}

#[test]
fn a_bolt_circle_expanded() {
    let text = "G81X10.Y0.Z-5.R2.F90 (BOLT CIRCLE)\nX0.Y10.\nG80\nG0X0.Y0.\n";
    insta::assert_snapshot!(program(text, &[
        (1, &["G81 X10.01 Z-5.002 R1.998"]),
        (2, &["G81 X0.008 Y10.004 Z-5.001 R1.999"]),
        (4, &["G0 Y0.003"]),
    ]), @r"
    G81X10.01Y0.Z-5.002R1.998F90 (BOLT CIRCLE)
    X0.008Y10.004Z-5.001R1.999
    G80
    G0X0.Y0.003
    ");
}
