//! Cycles and dimensions called by name: what they are written out as, against moves worked out by hand from Siemens'
//! Programming Guide Cycles.

use crate::common;

use common::{blocks, expanded};

const START: &str = "G17 G54 G71 G90\nG0 X10 Y10 Z60\n";

/// The lines that are no comments, behind the start.
fn flat(program: &str) -> Vec<String> {
    let text = common::flat("sinumerik", &format!("{START}{program}"), &[], &[]);
    let lines = blocks(&text).into_iter().skip(2);
    lines.filter(|line| !line.starts_with(';')).map(str::to_owned).collect()
}

fn refused(program: &str) -> u16 {
    let refusal = expanded("sinumerik", &format!("{START}{program}"), &[], &[]).expect_err("refused");
    refusal.diagnostics[0].code.0
}

#[test]
fn a_cycle_drills_where_the_axes_stand_and_leaves_the_motion_code() {
    // Near plane: reference plane and safety distance; retraction plane behind it.
    assert_eq!(flat("CYCLE81(15,0,2,-10)\nX20\n"), ["G0 Z2.", "G1 Z-10.", "G0 Z15.", "X20"]);
    let lines = flat("G1 X12 F200\nCYCLE82(15,1,2,,10,0.5)\nX20\n");
    assert_eq!(lines, ["G1 X12 F200", "G0 Z3.", "G1 Z-9.", "G4 F0.5", "G0 Z15.", "G1", "X20"]);
    // Below zero the dwell counts turns of the spindle.
    assert_eq!(flat("CYCLE82(15,0,2,-10,,-3)\n"), ["G0 Z2.", "G1 Z-10.", "G4 S3.", "G0 Z15."]);
    // From below, and along the axis upright on the plane.
    assert_eq!(flat("G19\nCYCLE81(-60,-40,1,-20)\n"), ["G19", "G0 X-41.", "G1 X-20.", "G0 X-60."]);
    // In inches as in millimetres.
    assert_eq!(flat("G70\nCYCLE81(.5,0,.1,-.25)\n"), ["G70", "G0 Z0.1", "G1 Z-0.25", "G0 Z0.5"]);
}

#[test]
fn deep_holes_are_pecked() {
    // 40 deep, first 12, each 4 shorter: 12, 8, 4 …, the last two sharing the rest. The feed begins 40/50 above.
    let lines = flat("CYCLE83(15,0,2,-30,,-12,,4,0,0,1,1)\n");
    let depths: Vec<&str> = lines.iter().filter_map(|line| line.strip_prefix("G1 Z")).collect();
    assert_eq!(depths, ["-12.", "-20.", "-24.", "-27.", "-30."]);
    // Up to 30 mm the feed begins 0.6 mm above what is drilled.
    assert_eq!(lines[..5], ["G0 Z2.", "G1 Z-12.", "G0 Z2.", "G0 Z-11.4", "G1 Z-20."]);
    let deep = flat("CYCLE83(15,0,2,-100,,,50,,0,0,1,1)\n");
    assert_eq!(deep, ["G0 Z2.", "G1 Z-50.", "G0 Z2.", "G0 Z-48.", "G1 Z-100.", "G0 Z15."]);
    // Chips broken: back by 1 mm at feed, or by what the call says, with both dwells.
    let chips = flat("CYCLE83(15,0,2,-20,,,10,,0.2,,,0)\n");
    assert_eq!(chips, ["G0 Z2.", "G1 Z-10.", "G4 F0.2", "G1 Z-9.", "G1 Z-20.", "G4 F0.2", "G0 Z15."]);
    let own = flat("CYCLE83(15,0,2,-20,,,10,,0.2,,,0,3,,2.5,1.5)\n");
    assert_eq!(own, ["G0 Z2.", "G1 Z-10.", "G4 F0.2", "G1 Z-7.5", "G1 Z-20.", "G4 F1.5", "G0 Z15."]);
}

#[test]
fn mcall_drills_behind_each_motion_until_it_stands_alone() {
    let lines = flat("MCALL CYCLE81(15,0,2,-10)\nX20 Y20\nM8\nX30\nMCALL\nX40\n");
    let hole = ["G0 Z2.", "G1 Z-10.", "G0 Z15."];
    let wanted: Vec<&str> =
        [&["X20 Y20"][..], &hole, &["M8", "X30"], &hole, &["X40"]].into_iter().flatten().copied().collect();
    assert_eq!(lines, wanted);
    assert_eq!(refused("MCALL CYCLE81(15,0,2,-10)\nTRANS X5\nX20\n"), 146);
    assert_eq!(refused("MCALL CYCLE81(15,0,2,-10)\n/X20\n"), 134);
    assert_eq!(refused("MCALL L100\n"), 136);
    // A rotary axis moves too; words that are arguments move nothing.
    let turned = flat("MCALL CYCLE81(15,0,2,-10)\nA90\nG25 X5\nMCALL\n");
    assert_eq!(turned, ["A90", "G0 Z2.", "G1 Z-10.", "G0 Z15.", "G25 X5"]);
    // So does a full circle, behind which the cycle's own moves would be arcs.
    assert_eq!(refused("G1 X20\nMCALL CYCLE81(15,0,2,-10)\nG2 I10\n"), 146);
}

#[test]
fn rows_and_circles_of_holes() {
    let places = |program: &str| -> Vec<String> {
        flat(program).into_iter().filter(|line| line.contains('X')).collect()
    };
    let circle = places("MCALL CYCLE81(15,0,2,-10)\nHOLES2(50,40,20,90,0,4)\nMCALL\n");
    assert_eq!(circle, ["G0 X50. Y60.", "G0 X30. Y40.", "G0 X50. Y20.", "G0 X70. Y40."]);
    let part = places("MCALL CYCLE81(15,0,2,-10)\nHOLES2(50,40,20,0,-90,2)\nMCALL\n");
    assert_eq!(part, ["G0 X70. Y40.", "G0 X50. Y20."]);
    // From X10 Y10 the near end is the first hole in one row and the last in the other.
    let row = places("MCALL CYCLE81(15,0,2,-10)\nHOLES1(20,10,0,5,10,3)\nMCALL\n");
    assert_eq!(row, ["G0 X25. Y10.", "G0 X35. Y10.", "G0 X45. Y10."]);
    let back = places("MCALL CYCLE81(15,0,2,-10)\nHOLES1(20,10,0,25,-10,3)\nMCALL\n");
    assert_eq!(back, ["G0 X25. Y10.", "G0 X35. Y10.", "G0 X45. Y10."]);
    // Equally near, and a row of an unknown start.
    assert_eq!(refused("MCALL CYCLE81(15,0,2,-10)\nHOLES1(10,0,90,0,20,2)\n"), 146);
    assert_eq!(refused("MCALL CYCLE81(15,0,2,-10)\nHOLES2(50,40,20,0,0,2.5)\n"), 146);
}

#[test]
fn places_and_increments_by_name() {
    let lines =
        flat("G1 X=IC(5) Y=AC(20) F200\nG2 X=IC(20) Y20 I=AC(25) J=AC(20)\nG91\nX=AC(60) Y5\nX=IC(1)\n");
    assert_eq!(lines, ["G1 X15. Y20. F200", "G2 X35. Y20 I10. J0.", "G91", "X25. Y5", "X1."]);
    assert_eq!(flat("X= IC( 5 )\n"), ["X15."]);
    assert_eq!(refused("TRANS X5\nX=IC(5)\n"), 146);
    assert_eq!(refused("X=IC(R1)\n"), 121);
    assert_eq!(refused("/X=IC(5)\n"), 134);
    // M8 M6: any M code of the block may move the axes.
    assert_eq!(refused("T1\nM8 M6\nX=IC(5)\n"), 146);
}

#[test]
fn turns_are_full_circles_before_the_arc() {
    // Half a turn is left: 2.5 turns for 25 mm.
    let lines = flat("G1 Z50\nG3 X50 Y10 Z25 I20 J0 F200 TURN=2\nX60\n");
    assert_eq!(
        lines,
        [
            "G1 Z50",
            "G3 F200 X10. Y10. Z40. I20. J0.",
            "G3 X10. Y10. Z30. I20. J0.",
            "G3 X50. Y10. Z25. I20. J0.",
            "X60"
        ]
    );
    assert_eq!(refused("G1 Z50\nG3 X10 Y10 Z25 I20 J0 TURN=2\n"), 146);
    assert_eq!(refused("G1 Z50 TURN=2\n"), 146);
}

/// One part as a post writes it with extended cycles and without.
#[test]
fn arguments_of_extended_cycles_that_choose_nothing() {
    for (extended, plain) in [
        ("CYCLE81(5,-1,5,-17.262,,0,0,10)", "CYCLE81(5,-1,5,-17.262,)"),
        ("CYCLE81(5,-1,5,-17.262,,0,0,0,10)", "CYCLE81(5,-1,5,-17.262,)"),
        ("CYCLE82(5,-1,5,-17.262,,0.5,0,0,10)", "CYCLE82(5,-1,5,-17.262,,0.5)"),
        ("CYCLE85(5,-1,5,-16,,0,200,500,0,0,0)", "CYCLE85(5,-1,5,-16,,0,200,500)"),
        ("CYCLE86(5,-1,5,-16,,0,3,-0.01,0,0,0,0,0,10)", "CYCLE86(5,-1,5,-16,,0,3,-0.01,0,0,0)"),
        (
            "CYCLE83(5,-1,5,-17.262,,-2,,0.1,0,0,1,1,,0.5,0,0,0,0,0,1110)",
            "CYCLE83(5,-1,5,-17.262,,-2,,0.1,0,0,1,1,,0.5,0,0,0)",
        ),
    ] {
        assert_eq!(flat(&format!("{extended}\n")), flat(&format!("{plain}\n")), "{extended}");
    }
}

#[test]
fn arguments_that_choose_how_others_are_read_are_refused() {
    for call in [
        "CYCLE81(5,-1,5,-17.262,,0,0,10,10)",
        "CYCLE82(5,-1,5,-17.262,,-3,0,0,10)",
        "CYCLE82(5,-1,5,-17.262,,0,0,0,20)",
        "CYCLE82(5,-1,5,-17.262,,0,10,0,10)",
        "CYCLE83(5,-1,5,-17.262,,-2,,0.1,0,0,1,1,,0.5,0,0,0,0,0,1001110)",
        "CYCLE81(15,0,2)",
        "CYCLE81()",
        "CYCLE81(15,0,2,-10,,0.5)",
        "CYCLE81(15,0,2,-10,12)",
        "CYCLE81(15,0,2,-10,,0,0,1,11)",
        "CYCLE81(1,0,2,-10)",
        "CYCLE81(15,0,2,0)",
        "CYCLE81(R1,0,2,-10)",
        "CYCLE81(15,0,2,1E1)",
        "CYCLE83(15,0,2,-30,,-12,,-0.5,0,0,1,1)",
        "CYCLE83(15,0,2,-30,,-12,,4,0,0,0.5,1)",
        "CYCLE83(15,0,2,-30,,-12,,4,0,0,1,2)",
        "CYCLE83(15,0,2,-30,,-12,,4,0,0,1,1,1)",
        "CYCLE83(15,0,2,-30,,5,,4,0,0,1,1)",
        "CYCLE83(15,0,2,-30,,,0.001,,0,0,1,1)",
        "G1 CYCLE81(15,0,2,-10)",
        "X20 CYCLE81(15,0,2,-10)",
        "CYCLE81(15,0,2,-10) CYCLE81(15,0,2,-10)",
        "HOLES1(20,10,0,5,10,3)",
    ] {
        assert_eq!(refused(&format!("{call}\n")), 146, "{call}");
    }
    assert_eq!(refused("G91\nCYCLE81(15,0,2,-10)\n"), 146);
    assert_eq!(refused("G2 X30 I10\nCYCLE81(15,0,2,-10)\n"), 146);
}

#[test]
fn cycle85_bores_at_feeds_of_its_own_and_leaves_none() {
    let lines = flat("G1 Z50 F200\nCYCLE85(15,0,2,-10,,0.3,80,300)\nX20 F200\nX30\n");
    let hole = ["G0 Z2.", "G1 Z-10. F80.", "G4 F0.3", "G1 Z2. F300.", "G0 Z15.", "G1"];
    let wanted: Vec<&str> =
        [&["G1 Z50 F200"][..], &hole, &["X20 F200", "X30"]].into_iter().flatten().copied().collect();
    assert_eq!(lines, wanted);
    // Which feed holds behind it no manual says; a rapid needs none, a dwell's F is none.
    assert_eq!(flat("CYCLE85(15,0,2,-10,,,80,300)\nG0 X20\nG1 Z40 F90\n").last().unwrap(), "G1 Z40 F90");
    assert_eq!(refused("F200\nCYCLE85(15,0,2,-10,,,80,300)\nG1 X20\n"), 146);
    assert_eq!(refused("F200\nCYCLE85(15,0,2,-10,,,80,300)\nG4 F1\nG1 X20\n"), 146);
    assert_eq!(refused("F200\nCYCLE85(15,0,2,-10,,,80,300)\nG0 X20\nCYCLE81(15,0,2,-10)\n"), 146);
    assert_eq!(flat("MCALL CYCLE85(15,0,2,-10,,,80,300)\nX20\nX30\nMCALL\n").len(), 10);
    assert_eq!(refused("CYCLE85(15,0,2,-10,,,,300)\n"), 146);
    assert_eq!(refused("CYCLE85(15,0,2,-10,,,80,0)\n"), 146);
    assert_eq!(refused("CYCLE85(15,0,2,-10,,,80,300,1)\n"), 146);
}

#[test]
fn cycle86_leaves_the_bore_aside_and_the_spindle_standing() {
    let lines = flat("F200\nCYCLE86(15,0,2,-10,,0.3,3,-1,-0.5,0.2,45)\nG0 X20\n");
    assert_eq!(
        lines[1..],
        [
            "M3",
            "G0 Z2.",
            "G1 Z-10.",
            "G4 F0.3",
            "SPOS=45.",
            "G0 X9. Y9.5 Z-9.8",
            "G0 Z2.",
            "G0 X10. Y10. Z15.",
            "G0 X20"
        ]
    );
    // Without a way aside it stays over the hole.
    let lines = flat("CYCLE86(15,0,2,-10,,,4)\n");
    assert_eq!(lines, ["M4", "G0 Z2.", "G1 Z-10.", "SPOS=0.", "G0 Z2.", "G0 Z15."]);
    let after = |more: &str| format!("F200\nCYCLE86(15,0,2,-10,,,3)\n{more}");
    assert_eq!(refused(&after("G1 X20\n")), 146);
    assert_eq!(refused(&after("CYCLE81(15,0,2,-10)\n")), 146);
    assert_eq!(flat(&after("M3\nG1 X20\n")).last().unwrap(), "G1 X20");
    assert_eq!(flat(&after("M5\nG0 X20\n")).last().unwrap(), "G0 X20");
    assert_eq!(refused("CYCLE86(15,0,2,-10,,,5)\n"), 146);
    assert_eq!(refused("CYCLE86(15,0,2,-10)\n"), 146);
    assert_eq!(refused("TRANS X5\nCYCLE86(15,0,2,-10,,,3,1)\n"), 146);
}

#[test]
fn arcs_by_their_angle() {
    // A quarter to the left from (10, 10) to (20, 20): about (10, 20); the same to the right about (20, 10).
    assert_eq!(flat("G3 X20 Y20 AR=90 F200\n"), ["G3 X20 Y20 F200 I0. J10."]);
    assert_eq!(flat("G2 X20 Y20 AR=90 F200\n"), ["G2 X20 Y20 F200 I10. J0."]);
    // Three quarters: about the other point.
    assert_eq!(flat("G3 X20 Y20 AR=270\nX30\n"), ["G3 X20 Y20 I10. J0.", "X30"]);
    assert_eq!(flat("G3 X20 Y10 AR=180\n"), ["G3 X20 Y10 I5. J0."]);
    // By the centre: the end is turned about it.
    assert_eq!(flat("G3 I-5 J0 AR=90\n"), ["G3 I-5 J0 X5. Y15."]);
    assert_eq!(flat("G2 I-5 Z40 AR=90 ;C\n"), ["G2 I-5 Z40 X5. Y5. ;C"]);
    assert_eq!(flat("G91\nG3 I-5 J0 AR=90\n"), ["G91", "G3 I-5 J0 X-5. Y5."]);
    assert_eq!(flat("G18\nG2 Z70 X20 AR=90\n"), ["G18", "G2 Z70 X20 K10. I0."]);
    for program in [
        "G3 X20 Y20 AR=360\n",
        "G3 X20 Y20 AR=0\n",
        "G3 X10 Y10 AR=90\n",
        "G3 X20 Y20 I5 AR=90\n",
        "G1 X20 Y20 AR=90\n",
        "G3 AR=90\n",
        "TRANS X5\nG3 X20 Y20 AR=90\n",
        "G3 X20 Y20 AR=90 TURN=1\n",
    ] {
        assert_eq!(refused(program), 146, "{program}");
    }
}

#[test]
fn corners_by_name() {
    // A square corner: the same as `,R` and `,C` on other controls.
    let lines = flat("G1 X30 F200 RND=4\nY40\nX50\n");
    assert_eq!(lines, ["G1 X26. Y10. F200", "G3 X30. Y14. I0. J4.", "G1 X30. Y40.", "X50"]);
    let lines = flat("G1 X30 F200 CHR=4\nY40\n");
    assert_eq!(lines, ["G1 X26. Y10. F200", "G1 X30. Y14.", "G1 X30. Y40."]);
    // A chamfer 4 long cuts 4/√2 off either side.
    let lines = flat("G1 X30 F200 CHF=4\nX=IC(0) Y40\n");
    assert_eq!(lines, ["G1 X27.171573 Y10. F200", "G1 X30. Y12.828427", "G1 X30. Y40."]);
    for program in [
        "G1 X30 RND=4\nG2 X40 Y20 CR=20\n",
        "G1 X30 RND=4\n",
        "G0 X30 RND=4\nY40\n",
        "G1 X30 RND=30\nY40\n",
        "G1 X30 RND=4 CHR=2\nY40\n",
        "G1 X30 RND=0\nY40\n",
    ] {
        assert_eq!(refused(program), 142, "{program}");
    }
}
