//! Okuma's common variables, jumps and calls: executed, against programs worked out by hand.

use crate::common;

use common::{blocks, expanded};

const START: &str = "OPART\nG15 H1\nG0 X10. Y10. Z60.\n";

/// The lines that are no comments, behind the start.
fn flat(program: &str) -> Vec<String> {
    let text = common::flat("okuma", &format!("{START}{program}"), &[], &[]);
    let lines = blocks(&text).into_iter().skip(3);
    lines.filter(|line| !line.starts_with('(')).map(str::to_owned).collect()
}

fn refused(program: &str) -> u16 {
    let refusal = expanded("okuma", &format!("{START}{program}"), &[], &[]).expect_err("refused");
    refusal.diagnostics[0].code.0
}

#[test]
fn variables_are_numbers_in_words() {
    let lines = flat("VC1=5\nVC2=[VC1+1]*2.5\nG1 X=VC1 Y=-VC2 Z=VC1/4+SQRT[16] F=VC2*10\nM2\n");
    assert_eq!(lines, ["G1 X=5. Y=-15. Z=5.25 F=150.", "M2"]);
    assert_eq!(flat("VC1=30\nG1 X=SIN[VC1]*8 F100\n"), ["G1 X=4. F100"]);
}

#[test]
fn the_file_name_in_front_is_none_of_the_programs_names() {
    let program = "$PART.MIN%\nOPART\nG15 H1\nG0 X10. Y10. Z60.\nVC1=5\nG1 X=VC1 F100\nM2\n%\n";
    let text = common::flat("okuma", program, &[], &[]);
    assert!(text.starts_with("$PART.MIN%\nOPART\n") && text.contains("G1 X=5. F100"), "{text}");
}

#[test]
fn jumps_go_to_sequence_names() {
    let lines = flat("VC1=0\nN10 VC1=VC1+1\nG1 X=VC1 F100\nIF [VC1 LT 3] N010\nGOTO NEND\nX99.\nNEND M2\n");
    assert_eq!(lines, ["G1 X=1. F100", "G1 X=2. F100", "G1 X=3. F100", "NEND M2"]);
    let lines = flat("VC1=2\nIF[VC1 NE 2]GOTO N20\nX1.\nN20 X2.\nM2\n");
    assert_eq!(lines, ["X1.", "N20 X2.", "M2"]);
    // A block that comes again loses its name.
    let lines = flat("VC1=0\nNTOP X1.\nVC1=VC1+1\nIF [VC1 LE 1] NTOP\nM2\n");
    assert_eq!(lines, ["NTOP X1.", " X1.", "M2"]);
}

#[test]
fn subprograms_are_called_by_number() {
    let lines = flat("VC1=4\nCALL O100 Q2\nX0.\nM2\nO100\nG91\nX=VC1\nG90\nRTS\n");
    assert_eq!(lines, ["G91", "X=4.", "G90", "G91", "X=4.", "G90", "X0.", "M2"]);
    assert_eq!(flat("CALL O100\nM2\nO100\nCALL O200\nRTS\nO200\nX7.\nRTS\n"), ["X7.", "M2"]);
}

#[test]
fn subprograms_are_called_by_name() {
    let lines = flat("CALL OSUB Q2\nX0.\nM2\nOSUB (a pocket)\nX4.\nCALL Oa1\nRTS\nOA1\nX5.\nRTS\n");
    assert_eq!(lines, ["X4.", "X5.", "X4.", "X5.", "X0.", "M2"]);
    let text =
        common::flat("okuma", &format!("{START}CALL OSUB\nM2\n"), &[], &[("OSUB.SSB", "OSUB\nX6.\nRTS\n")]);
    assert!(text.contains("(OSUB CALL 1 OF 1)\nX6.\n"), "{text}");
}

#[test]
fn what_is_not_certain_is_refused() {
    for (program, code) in [
        ("DIA=5\n", 120),
        ("G1 X=DIA\n", 120),
        ("G1 X=VZOFZ[1]\n", 120),
        ("VC1=ATAN[1]\n", 120),
        ("VC1=5 VC2=6\n", 120),
        ("VC1=5 MOD 2\n", 120),
        ("VC1=1\nIF [VC1] N10\nN10 M2\n", 120),
        ("VC1=1\nIF [VC1 EQ 1 OR VC1 EQ 2] N10\nN10 M2\n", 120),
        ("CALL SUB\n", 120),
        ("CALL OSUB PX=5\n", 120),
        ("CALL OSUB\nM2\n", 127),
        ("CALL OSUB\nM2\nOSUB X1.\nRTS\n", 136),
        ("CALL O7\nM2\nO7 X1.\nRTS\n", 136),
        ("CALL OSUB\nM2\nOSUB\nX1.\nO8\nRTS\n", 135),
        ("X1.\nOSUB\nRTS\n", 135),
        ("CALL O1 VC1=5\n", 120),
        ("G1 X=VC1\n", 121),
        ("VC1=VC2\nIF [VC1 EQ 1] N10\nN10 M2\n", 121),
        ("GOTO N99\n", 125),
        ("GOTO N10\nN10 X1.\nN10 X2.\n", 125),
        ("CALL O77\n", 127),
        ("X1.\nRTS\n", 135),
        ("/VC1=5\n", 134),
        ("VC1=5 X1.\n", 120),
    ] {
        assert_eq!(refused(program), code, "{program}");
    }
}
