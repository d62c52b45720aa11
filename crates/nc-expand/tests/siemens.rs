//! Siemens' variables and flow: what is executed, against values worked out by hand.

use crate::common;

use common::{blocks, expanded};

/// The lines that are no comments.
fn flat(program: &str) -> Vec<String> {
    let text = common::flat("sinumerik", program, &[], &[]);
    blocks(&text).into_iter().filter(|line| !line.starts_with(';')).map(str::to_owned).collect()
}

fn refused(program: &str) -> u16 {
    expanded("sinumerik", program, &[], &[]).expect_err("refused").diagnostics[0].code.0
}

#[test]
fn expressions_are_siemens() {
    for (expression, value) in [
        ("2+3*4", "14."),
        ("(2+3)*4", "20."),
        ("-R1*2", "-20."),
        ("SIN(30)*4", "2."),
        ("ATAN2(5,5)", "45."),
        ("POT(3)+SQRT(16)", "13."),
        ("TRUNC(-2.7)", "-2."),
        ("ROUND(2.5)", "3."),
        ("ABS(R1-15)", "5."),
        ("R1/4", "2.5"),
    ] {
        assert_eq!(flat(&format!("R1=10\nG1 X={expression}\n")), [format!("G1 X={value}")], "{expression}");
    }
    // What stands around the number stays.
    assert_eq!(flat("R1=10\nG2 X=AC(R1) CR=R1*2 F=R1*5\n"), ["G2 X10. CR=20. F=50."]);
}

#[test]
fn conditions_and_loops() {
    let x = |program: &str| -> Vec<String> {
        flat(program).iter().filter_map(|line| line.strip_prefix("X=").map(str::to_owned)).collect()
    };
    assert_eq!(x("DEF INT II\nFOR II=2 TO 4\nX=II\nENDFOR\n"), ["2.", "3.", "4."]);
    assert_eq!(x("DEF INT II\nFOR II=2 TO 1\nX=II\nENDFOR\nX=II\n"), ["2."]);
    let nested = "DEF INT II, JJ\nFOR II=1 TO 2\nFOR JJ=1 TO 2\nX=II*10+JJ\nENDFOR\nENDFOR\n";
    assert_eq!(x(nested), ["11.", "12.", "21.", "22."]);
    assert_eq!(x("R1=0\nWHILE R1<2\nR1=R1+1\nX=R1\nENDWHILE\n"), ["1.", "2."]);
    // UNTIL stands at the end: once at least.
    assert_eq!(x("R1=9\nREPEAT\nX=R1\nR1=R1+1\nUNTIL R1>2\n"), ["9."]);
    let inside = "R1=0\nREPEAT\nR1=R1+1\nWHILE R1==2\nX=R1\nR1=R1+1\nENDWHILE\nUNTIL R1>=4\nX=R1\n";
    assert_eq!(x(inside), ["2.", "4."]);
    assert_eq!(x("R1=0\nLOOP\nR1=R1+1\nX=R1\nIF R1>=3 GOTOF OUT\nENDLOOP\nOUT:\n"), ["1.", "2.", "3."]);
    let branch = |value: u32| {
        x(&format!("R1={value}\nIF R1==1\nX=R1\nELSE\nIF R1==2\nX=R1*10\nELSE\nX=R1*100\nENDIF\nENDIF\n"))
    };
    assert_eq!(
        (branch(1), branch(2), branch(3)),
        (vec!["1.".to_owned()], vec!["20.".to_owned()], vec!["300.".to_owned()])
    );
    assert_eq!(x("R1=1\nIF (R1>0) AND NOT (R1>5)\nX=R1\nENDIF\n"), ["1."]);
}

#[test]
fn jumps_look_where_they_say() {
    assert_eq!(flat("GOTOF N30\nN20 X1\nN30 X2\nM30\n"), ["N30 X2", "M30"]);
    let back = "R1=0\nAGAIN:\nR1=R1+1\nX=R1\nIF R1<2 GOTOB AGAIN\n";
    assert_eq!(flat(back), ["AGAIN:", "X=1.", "AGAIN:", "X=2."]);
    assert_eq!(refused("GOTOB ENDE\nENDE:\n"), 125);
    assert_eq!(refused("ENDE:\nX1\nGOTOF ENDE\n"), 125);
    assert_eq!(refused("GOTOF ENDE\nENDE:\nX1\nENDE:\n"), 125);
    // For ever.
    assert_eq!(refused("ENDE:\nGOTOB ENDE\n"), 130);
}

#[test]
fn what_is_not_certain_is_refused() {
    for (program, code) in [
        ("X=R1\n", 121),
        ("X=$AA_IW\n", 121),
        ("R1=$AA_IW\nX=R1\n", 121),
        ("LENGTH=5\n", 120),
        ("DEF STRING[8] NAME\n", 120),
        ("DEF REAL AA[5]\n", 120),
        ("DEF INT NN=1.5\n", 124),
        ("R1=5 R2=R1\n", 120),
        ("R1=5 X1\n", 120),
        ("X1 R1=5\n", 136),
        ("R1=1\nIF R1>0 AND R1<5\nENDIF\n", 120),
        ("R1=4 MOD 3\n", 120),
        ("R1=1/0\n", 122),
        ("R1=1\nSPOS=R1\n", 120),
        ("R1=1\nMSG(\"NOW \"<<R1)\n", 120),
        ("FOR R1=1 TO 2\nX1\n", 126),
        ("ENDFOR\n", 126),
        ("IF R1==1\nX1\n", 126),
        ("REPEAT AGAIN P=2\n", 120),
        ("FOR XY=1 TO 2\nENDFOR\n", 120),
        ("R1=1\n/R1=2\n", 134),
    ] {
        assert_eq!(refused(program), code, "{program}");
    }
    // Text is no variable.
    assert_eq!(flat("R1=1\nMSG(\"R1 NOW\")\nX=R1\n"), ["MSG(\"R1 NOW\")", "X=1."]);
}

#[test]
fn numbered_subprograms_are_files_of_their_name() {
    let called = "%_N_L100_SPF\n;$PATH=/_N_SPF_DIR\nPROC L100 DISPLOF\nG91 G1 X=R1\nY2\nG90\nM17\n";
    let flat = |program: &str, files: &[(&str, &str)]| -> Vec<String> {
        let text = common::flat("sinumerik", program, &[], files);
        text.lines().filter(|line| !line.starts_with(';')).map(str::to_owned).collect()
    };
    let lines = flat("R1=5\nL100 P2\nX0\nM30\n", &[("L100.SPF", called)]);
    assert_eq!(lines, ["G91 G1 X=5.", "Y2", "G90", "G91 G1 X=5.", "Y2", "G90", "X0", "M30"]);
    // M17 beside the last move, RET, a call in a call, leading zeros that are another name.
    let files = [("L1.SPF", "G1 X1 M17\n"), ("L01.SPF", "L1\nX2\nRET\n")];
    assert_eq!(flat("L01\nM30\n", &files), ["G1 X1 ", "X2", "M30"]);
    let refused = |program: &str, files: &[(&str, &str)]| {
        let refusal = common::expanded("sinumerik", program, &[], files).expect_err("refused");
        refusal.diagnostics[0].code.0
    };
    assert_eq!(refused("L100\nM30\n", &[]), 127);
    assert_eq!(refused("G0 X5 L1\nM30\n", &files), 136);
    assert_eq!(refused("L5\nM30\n", &[("L5.SPF", "X1\nM30\n")]), 135);
    assert_eq!(refused("L5\nM30\n", &[("L5.SPF", "X1\n")]), 135);
    assert_eq!(refused("L5\nM30\n", &[("L5.SPF", "PROC L5 SAVE\nX1\nM17\n")]), 120);
    assert_eq!(refused("L5\nM30\n", &[("L5.SPF", "PROC L5(REAL A)\nX1\nM17\n")]), 120);
    assert_eq!(refused("DEF REAL AA\nL5\nM30\n", &[("L5.SPF", "DEF REAL AA\nM17\n")]), 120);
    assert_eq!(refused("L5\nM30\n", &[("L5.SPF", "L5\nM17\n")]), 129);
    assert_eq!(refused("X1\nM17\n", &[]), 135);
    assert_eq!(refused("L5(3)\nM30\n", &[]), 120);
}
