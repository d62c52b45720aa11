//! Cycles of lathes: the moves that they are written out as, worked out by hand.

use crate::common::{self, blocks};
use nc_dialect::Dialect;
use nc_expand::{Environment, Expanded, Limits, Refusal, expand};
use toolpath::{DrillPecks, DrillR, FlankFrom, TurningParameters};

const START: &str = "G0 X60. Z2.\n";

/// Fanuc's lathe in a G-code system, X a diameter, with the parameters that cycles need.
fn dialect(system: &str) -> Dialect {
    let mut dialect =
        nc_dialect::builtin("fanuc-lathe").and_then(|dialect| dialect.in_system(system)).expect("a system");
    let turning = dialect.turning.as_mut().expect("a lathe");
    turning.diameters = Some(true);
    turning.cycles = TurningParameters { thread_chamfer_leads: Some(0.0), ..TurningParameters::default() };
    dialect
}

fn expanded<'a>(dialect: &Dialect, text: &'a str) -> Result<Expanded<'a>, Refusal> {
    let environment = Environment {
        variables: &[],
        read_external: &common::nothing,
        setup: &common::setup(dialect),
        limits: Limits::default(),
    };
    expand(text.as_bytes(), dialect, &environment)
}

/// The lines that are no comments, behind the start.
fn lines(dialect: &Dialect, program: &str) -> Vec<String> {
    let text = format!("{START}{program}");
    let expanded = expanded(dialect, &text).unwrap_or_else(|refusal| panic!("{program}\n{refusal:#?}"));
    let flat = std::str::from_utf8(expanded.text()).expect("text");
    blocks(flat).into_iter().skip(1).map(str::to_owned).collect()
}

fn refused(dialect: &Dialect, program: &str) -> (u16, String) {
    let text = format!("{START}{program}");
    let refusal = expanded(dialect, &text).expect_err(program);
    let diagnostic = &refusal.diagnostics[0];
    (diagnostic.code.0, diagnostic.to_string())
}

#[test]
fn a_pass_is_four_moves_in_every_system() {
    let cut = ["F0.2 G0 X50. Z2.", "G1 Z-30.", "G1 X60.", "G0 X60. Z2."];
    for (system, code) in [("A", "G90"), ("B", "G77"), ("C", "G20")] {
        assert_eq!(lines(&dialect(system), &format!("{code} X50. Z-30. F0.2\n")), cut, "{system}");
    }
    for (system, code) in [("A", "G94"), ("B", "G79"), ("C", "G24")] {
        let face = ["F0.2 G0 X60. Z-1.", "G1 X20.", "G1 Z2.", "G0 X60. Z2."];
        assert_eq!(lines(&dialect(system), &format!("{code} X20. Z-1. F0.2\n")), face, "{system}");
    }
    for (system, code, thread) in [("A", "G92", "G32"), ("B", "G78", "G33"), ("C", "G21", "G33")] {
        let cut = ["F1.5 G0 X50. Z2.", &format!("{thread} Z-30."), "G0 X60. Z-30.", "G0 X60. Z2."];
        assert_eq!(lines(&dialect(system), &format!("{code} X50. Z-30. F1.5\n")), cut, "{system}");
    }
}

#[test]
fn words_of_a_pass_hold_and_tapers_are_radii() {
    let passes = lines(&dialect("A"), "G90 X50. Z-30. F0.2\nX46.\nU-18. W-40. R-1.5\nG0 X62.\n");
    let first = ["F0.2 G0 X50. Z2.", "G1 Z-30.", "G1 X60.", "G0 X60. Z2."];
    let second = ["G0 X46. Z2.", "G1 Z-30.", "G1 X60.", "G0 X60. Z2."];
    // of radius is 3 of the X word: from 39 to 42.
    let third = ["G0 X39. Z2.", "G1 X42. Z-38.", "G1 X60.", "G0 X60. Z2."];
    assert_eq!(passes, [&first[..], &second, &third, &["G0 X62."]].concat());
    // R of a face is Z.
    assert_eq!(
        lines(&dialect("A"), "G94 X20. Z-3. R-1. F0.2\n"),
        ["F0.2 G0 X60. Z-4.", "G1 X20. Z-3.", "G1 Z2.", "G0 X60. Z2."]
    );
    // Increments under G91 of system B: its moves are places, and G91 holds behind them.
    assert_eq!(
        lines(&dialect("B"), "G91 G77 X-10. Z-32. F0.2\n"),
        ["F0.2 G0 X50. Z2.", "G1 Z-30.", "G1 X60.", "G0 X60. Z2.", "G91"]
    );
}

#[test]
fn a_thread_ends_in_the_chamfer_that_the_profile_says() {
    let mut dialect = dialect("A");
    let set = |dialect: &mut Dialect, leads: Option<f64>, deg: Option<f64>| {
        let turning = dialect.turning.as_mut().expect("a lathe");
        (turning.cycles.thread_chamfer_leads, turning.cycles.thread_chamfer_deg) = (leads, deg);
    };
    set(&mut dialect, Some(1.0), None);
    // One lead of 1.5 at 45 degrees: 3 of the diameter.
    assert_eq!(
        lines(&dialect, "G92 X50. Z-30. F1.5\n"),
        ["F1.5 G0 X50. Z2.", "G32 Z-28.5", "G32 X53. Z-30.", "G0 X60. Z-30.", "G0 X60. Z2."]
    );
    set(&mut dialect, None, None);
    let (code, message) = refused(&dialect, "G92 X50. Z-30. F1.5\n");
    assert_eq!(code, 145, "{message}");
    // Longer than there is room up to the start of the cycle: along it to the end, where nothing stands.
    set(&mut dialect, Some(9.0), None);
    assert_eq!(
        lines(&dialect, "G92 X50. Z-30. F1.5\n"),
        ["F1.5 G0 X50. Z2.", "G32 Z-16.5", "G32 X60. Z-21.5", "G0 X60. Z-30.", "G0 X60. Z2."]
    );
    set(&mut dialect, Some(22.0), None);
    let (code, message) = refused(&dialect, "G92 X50. Z-30. F1.5\n");
    assert!(code == 143 && message.contains("shorter than its chamfer"), "{message}");
}

#[test]
fn roughing_goes_down_to_the_contour_and_finishing_makes_it() {
    let contour = "N10 G0 X20.\nG1 Z-10. F0.1\nX40. Z-30.\nN20 X60.\n";
    let program = format!("G71 U8. R1.\nG71 P10 Q20 U0.4 W0.2 F0.3\n{contour}G70 P10 Q20\n");
    let wanted = [
        // C lies off A by the allowances.
        "F0.3 G0 X60.4 Z2.2",
        "G0 X44.4 Z2.2",
        // Off the contour by 0.2 of radius and 0.2 of Z; 44.4 lies on the collar at Z-30.
        "G1 Z-29.8",
        "G0 X46.4 Z-28.8",
        "G0 X46.4 Z2.2",
        "G0 X28.4 Z2.2",
        // The taper from X20.4 Z-9.8 to X40.4 Z-29.8: 8 of 20.
        "G1 Z-17.8",
        "G0 X30.4 Z-16.8",
        "G0 X30.4 Z2.2",
        "G0 X20.4 Z2.2",
        "G1 Z-9.8",
        "G1 X40.4 Z-29.8",
        "G1 X60.4",
        "G0 X60. Z2.",
        // G70: the blocks as they stand.
        "G0 X20.",
        "G1 Z-10. F0.1",
        "X40. Z-30.",
        "X60.",
        "G0 X60. Z2.",
    ];
    assert_eq!(lines(&dialect("A"), &program), wanted);
    // The series 10 and 11 in one block, D without a point in least increments, the escape from the parameter.
    let mut other = dialect("A");
    other.turning.as_mut().unwrap().cycles.roughing_escape_mm = Some(1.0);
    let program = format!("G71 P10 Q20 U0.4 W0.2 D8000 F0.3\n{contour}G70 P10 Q20\n");
    assert_eq!(lines(&other, &program), wanted);
    // System C calls them G73 and G72.
    let program = format!("G73 U8. R1.\nG73 P10 Q20 U0.4 W0.2 F0.3\n{contour}G72 P10 Q20\n");
    assert_eq!(lines(&dialect("C"), &program), wanted);
}

/// A contour that is reached more than once: each cycle takes the one of its own turn.
#[test]
fn a_contour_in_a_loop_is_that_of_the_turn() {
    let lathe = dialect("A");
    let turn = |x: &str| {
        format!(
            "G0 X60. Z2.\nG71 U8. R1.\nG71 P10 Q20 U0.4 W0.2 F0.3\nN10 G0 X{x}\nG1 Z-10. F0.1\nX40.\nN20 Z-30.\n\
             G70 P10 Q20\n"
        )
    };
    let once = |x: &str| lines(&lathe, &turn(x));
    let looped = format!("#1=0\nWHILE[#1LT2]DO1\n{}#1=#1+1\nEND1\n", turn("[20.+#1*4.]"));
    let moves =
        |lines: Vec<String>| lines.into_iter().filter(|line| line.contains(['X', 'Z'])).collect::<Vec<_>>();
    let turns = [once("20."), once("24.")].concat();
    let bare = |lines: Vec<String>| {
        moves(lines).into_iter().map(|line| line.replace("N10 ", "").replace("N20 ", ""))
    };
    assert_eq!(bare(lines(&lathe, &looped)).collect::<Vec<_>>(), bare(turns).collect::<Vec<_>>());
    let called = format!("M98 P1000\nM30\nO1000\n{}M99\n", turn("20."));
    assert_eq!(bare(lines(&lathe, &called)).collect::<Vec<_>>(), bare(once("20.")).collect::<Vec<_>>());
}

/// Programs of schools and shops: a work offset in the block of the start, the block of P names both axes, the nose is
/// compensated in the contour, which ends with rapids; eight decimals.
#[test]
fn a_contour_as_it_is_posted_is_roughed_and_finished() {
    let mut lathe = dialect("A");
    let contour = "N10 G0 G42 X20. Z2.\nG1 Z-10.00000001 F0.1\nX40. Z-30.\nG0 X60.\nN20 G40 Z2.\n";
    let program =
        format!("G55 G0 X60. Z2.\nG71 U20. R1.\nG71 P10 Q20 U0.4 W0.2 F0.3\n{contour}G70 P10 Q20\n");
    let (code, message) = refused(&lathe, &program);
    assert!(code == 144 && message.contains("G42 within a contour"), "{message}");
    lathe.turning.as_mut().unwrap().cycles.nose_in_finishing = true;
    let wanted = [
        "G55 G0 X60. Z2.",
        "F0.3 G0 X60.4 Z2.2",
        // One pass would go below the contour; that alone is cut, and left as the program leaves it.
        "G0 X20.4 Z2.2",
        "G1 Z-9.8",
        "G1 X40.4 Z-29.8",
        "G0 X60.4 Z-29.8",
        "G0 X60.4 Z2.2",
        "G0 X60. Z2.",
        "G0 G42 X20. Z2.",
        "G1 Z-10.00000001 F0.1",
        "X40. Z-30.",
        "G0 X60.",
        "G40 Z2.",
    ];
    assert_eq!(lines(&lathe, &program), wanted);
    // Finishing would read the contour once more, with the value of then.
    let anew = contour.replace("X20. ", "X#2 ");
    let anew = format!(
        "#2=20.\nG55 G0 X60. Z2.\nG71 U20. R1.\nG71 P10 Q20 U0.4 W0.2 F0.3\n{anew}#2=19.\nG70 P10 Q20\n"
    );
    assert!(refused(&lathe, &anew).1.contains("assigned anew"));
    assert_eq!(lines(&lathe, &anew.replace("#2=19.\n", "")).len(), wanted.len());
    // A finishing that never comes, or one that leaves compensation in force.
    let unfinished = program.replace("G70 P10 Q20\n", "");
    assert_eq!(refused(&lathe, &unfinished).0, 144);
    assert_eq!(refused(&lathe, &program.replace("G40 ", "")).0, 144);
}

#[test]
fn a_face_is_roughed_along_x() {
    let program = "G72 W3. R1.\nG72 P10 Q20 U0. W0. F0.3\nN10 G0 Z-8.\nG1 X40.\nN20 G2 X20. Z2. R10.\n";
    let passes = lines(&dialect("A"), program);
    // Z-1, Z-4, Z-7; the arc about X20 Z-8: at Z-1 the radius is 10 + sqrt(51).
    assert_eq!(
        passes[..5],
        ["F0.3 G0 X60. Z-1.", "G1 X34.282857", "G0 X36.282857 Z0.", "G0 X60. Z0.", "G0 X60. Z-4."]
    );
    assert_eq!(passes[passes.len() - 4..], ["G0 X60. Z-8.", "G1 X40.", "G2 X20. Z2. R10.", "G0 X60. Z2."]);
}

#[test]
fn a_pattern_comes_nearer_each_time() {
    let program = "G73 U4. W2. R3\nG73 P10 Q20 U1. W0.5 F0.2\nN10 G0 X20. Z0.\nG1 Z-10.\nN20 X40. W-5.\n";
    let passes = lines(&dialect("A"), program);
    let shape = |x: [f64; 2], z: [f64; 3]| {
        [
            format!("G0 X{}. Z{}", x[0], point(z[0])),
            format!("G1 Z{}", point(z[1])),
            format!("G1 X{}. Z{}", x[1], point(z[2])),
        ]
    };
    // Relief 4 of radius and 2, half of it, none; each with the allowance of 1 and 0.5.
    let wanted = [
        vec!["F0.2 G0 X69. Z4.5".to_owned()],
        shape([29.0, 49.0], [2.5, -7.5, -12.5]).to_vec(),
        vec!["G0 X65. Z3.5".to_owned()],
        shape([25.0, 45.0], [1.5, -8.5, -13.5]).to_vec(),
        vec!["G0 X61. Z2.5".to_owned()],
        shape([21.0, 41.0], [0.5, -9.5, -14.5]).to_vec(),
        vec!["G0 X60. Z2.".to_owned()],
    ];
    assert_eq!(passes, wanted.concat());
}

fn point(value: f64) -> String {
    value.to_string()
}

#[test]
fn pecks_go_back_and_on() {
    // A hole on the axis.
    assert_eq!(
        lines(&dialect("A"), "G0 X0.\nG74 R0.5\nG74 Z-10. Q5000 F0.1\n"),
        ["G0 X0.", "F0.1 G1 Z-3.", "G0 X0. Z-2.5", "G1 Z-8.", "G0 X0. Z-7.5", "G1 Z-10.", "G0 X0. Z2."]
    );
    // A groove of two places: 4 of radius in steps of 3, 2 along Z in steps of 2.
    assert_eq!(
        lines(&dialect("A"), "G75 R0.5\nG75 X52. Z0. P3000 Q2000 F0.1\n"),
        [
            "F0.1 G1 X54.",
            "G0 X55. Z2.",
            "G1 X52.",
            "G0 X60. Z2.",
            "G0 X60. Z0.",
            "G1 X54.",
            "G0 X55. Z0.",
            "G1 X52.",
            "G0 X60. Z0.",
            "G0 X60. Z2.",
        ]
    );
    assert_eq!(refused(&dialect("A"), "G75 X52. P3000 F0.1\n").0, 145);
    assert_eq!(refused(&dialect("A"), "G75 R0.5\nG75 X52. Z0. P3000 Q2000 R0.2 F0.1\n").0, 143);
}

/// 27 mm deep from Z-1 in pecks of 10: to R or by the return, the start 3 mm before R.
#[test]
fn a_hole_is_drilled_on_the_axis() {
    let mut lathe = dialect("A");
    let hole = |words: &str| format!("G0 X0 Z2.\nG83 Z-28. R-3. {words}\nG80\n");
    let plain = ["G0 X0 Z2.", "F0.1 G0 X0. Z-1.", "G1 Z-28.", "G0 X0. Z-1.", "G0 X0. Z2.", "G80"];
    assert_eq!(lines(&lathe, &hole("F0.1")), plain);
    let dwelt =
        ["G0 X0 Z2.", "F0.1 G0 X0. Z-1.", "G1 Z-28.", "G4 P500", "G0 X0. Z-1.", "G0 X0. Z2. M9", "G80"];
    assert_eq!(lines(&lathe, &hole("P500 F0.1 M9")), dwelt);
    assert_eq!(refused(&lathe, &hole("Q10000 F0.1")).0, 145);
    let cycles = &mut lathe.turning.as_mut().unwrap().cycles;
    (cycles.drill_pecks, cycles.drill_return_mm) = (Some(DrillPecks::Full), Some(0.5));
    let full = [
        "G0 X0 Z2.",
        "F0.1 G0 X0. Z-1.",
        "G1 Z-11.",
        "G0 X0. Z-1.",
        "G0 X0. Z-10.5",
        "G1 Z-21.",
        "G0 X0. Z-1.",
        "G0 X0. Z-20.5",
        "G1 Z-28.",
        "G0 X0. Z-1.",
        "G0 X0. Z2.",
        "G80",
    ];
    assert_eq!(lines(&lathe, &hole("Q10000 F0.1")), full);
    lathe.turning.as_mut().unwrap().cycles.drill_pecks = Some(DrillPecks::Chip);
    let chip: Vec<&str> =
        full.iter().enumerate().filter(|(k, _)| ![3, 6].contains(k)).map(|(_, line)| *line).collect();
    assert_eq!(lines(&lathe, &hole("Q10000 F0.1")), chip);
    for words in ["X10. F0.1", "K2 F0.1", "C90. F0.1"] {
        assert_eq!(refused(&lathe, &hole(words)).0, 143, "{words}");
    }
    for program in [
        "G0 X0 Z2.\nG83 Z-28. F0.1\n",
        // The manual counts W from R, every other W counts from where the tool stands.
        "G0 X0 Z2.\nG83 W-28. R-3. F0.1\n",
        "G0 X0 Z2.\nG83 Z-2. R-5. F0.1\n",
        "G0 X0 Z2.\nG83 Z-28. R-3. F0.1\nZ-30.\n",
        // 5 in a program without points are 5 increments.
        "G0 X0 Z2.\nG83 Z-28. R-3. Q5 F0.1\n",
    ] {
        assert_eq!(refused(&lathe, program).0, 143, "{program}");
    }
}

/// R above the start: by Fanuc's manual a way up, by controls that follow it a place.
#[test]
fn r_of_a_hole_that_leads_up_is_asked_for() {
    let mut lathe = dialect("A");
    let program = "G0 X0. Z5.\nG83 Z-20. R5. F0.1\n";
    let (code, message) = refused(&lathe, program);
    assert!(code == 145 && message.contains("whether R of a hole"), "{message}");
    let mut drilled = |r, program: &str| {
        lathe.turning.as_mut().unwrap().cycles.drill_r = Some(r);
        lines(&lathe, program)
    };
    let from_five = ["G0 X0. Z5.", "F0.1 G1 Z-20.", "G0 X0. Z5."];
    assert_eq!(drilled(DrillR::Place, program), from_five);
    let from_ten = ["G0 X0. Z5.", "F0.1 G0 X0. Z10.", "G1 Z-20.", "G0 X0. Z10.", "G0 X0. Z5."];
    assert_eq!(drilled(DrillR::Way, program), from_ten);
    assert_eq!(drilled(DrillR::Way, "G0 X0. Z5.\nG83 W-25. R0 F0.1\n"), from_five);
    // Beyond the bottom there is nothing to drill.
    lathe.turning.as_mut().unwrap().cycles.drill_r = Some(DrillR::Place);
    assert_eq!(refused(&lathe, "G0 X0. Z5.\nG83 Z-20. R-25. F0.1\n").0, 143);
}

/// People used to mills write G90 at the head; a lathe of system A has a cycle by that name.
#[test]
fn a_pass_without_a_place_is_left_out() {
    let lathe = dialect("A");
    let program = "N5 G21 G18 G90 G99 G40 (head)\nG54 G90\nG90\nG0 X50. Z2.\n";
    assert_eq!(lines(&lathe, program), ["N5 G21 G18 G99 G40", "G54", "G0 X50. Z2."]);
    for program in [
        // Its words may still be held.
        "G90 X50. Z-30. F0.2\nG0 X60.\nG90\n",
        "G90 R1.\n",
        "G92\n",
        "G94\n",
        // Which motion?
        "G0 X50. Z2.\nG90\nX40.\n",
    ] {
        assert_eq!(refused(&lathe, program).0, 143, "{program}");
    }
}

#[test]
fn a_thread_of_several_passes() {
    let passes = lines(&dialect("A"), "G76 P010000 Q100 R0.1\nG76 X50. Z-30. P1000 Q500 F2.\n");
    // 0.5, 0.5·√2, 0.5·√3 of radius in whole millionths, then 0.9 above the root's 1.0, and once at the root.
    let starts: Vec<&str> = passes.iter().map(String::as_str).filter(|line| line.contains("G0 X5")).collect();
    assert_eq!(
        starts,
        ["F2. G0 X51. Z2.", "G0 X50.585786 Z2.", "G0 X50.26795 Z2.", "G0 X50.2 Z2.", "G0 X50. Z2."]
    );
    assert_eq!(passes[1..4], ["G32 Z-30.", "G0 X60. Z-30.", "G0 X60. Z2."]);
    assert_eq!(refused(&dialect("A"), "G76 X50. Z-30. P1000 Q500 F2.\n").0, 143);
}

/// A tip of 60 degrees goes on along the flank by 0.57735 of the depth: of depths 0.5, 0.707107, 0.866025, 0.9 and 1.0
/// by 0.288675, 0.408248, 0.5, 0.519615 and 0.57735, counted from where the profile says.
#[test]
fn a_thread_cut_by_one_edge_goes_along_the_flank() {
    let mut lathe = dialect("A");
    let two = "G76 P010060 Q100 R0.1\nG76 X50. Z-30. P1000 Q500 F2.\n";
    assert_eq!(refused(&lathe, two).0, 145);
    let starts = |lathe: &Dialect, program: &str| -> Vec<String> {
        let passes = lines(lathe, program);
        passes
            .iter()
            .filter(|line| line.contains("G0 X5"))
            .map(|line| line.rsplit('Z').next().unwrap().to_owned())
            .collect()
    };
    for (from, wanted) in [
        (FlankFrom::Start, ["1.711325", "1.591752", "1.5", "1.480385", "1.42265"]),
        (FlankFrom::FirstPass, ["2.", "1.880427", "1.788675", "1.76906", "1.711325"]),
        (FlankFrom::LastPass, ["2.288675", "2.169102", "2.077351", "2.057735", "2."]),
    ] {
        lathe.turning.as_mut().unwrap().cycles.thread_flank_from = Some(from);
        assert_eq!(starts(&lathe, two), wanted, "{from:?}");
    }
    // The same in one block: what the first one says, parameters do.
    let one = "G76 X50. Z-30. K1. D500 A60 F2.\n";
    assert_eq!(refused(&lathe, one).0, 145);
    let cycles = &mut lathe.turning.as_mut().unwrap().cycles;
    (cycles.thread_finishing_passes, cycles.thread_least_mm) = (Some(1.0), Some(0.1));
    cycles.thread_allowance_mm = Some(0.1);
    let comments = |program: &str| lines(&lathe, program);
    assert_eq!(comments(one), comments(two));
    for words in ["P2", "Q100", "A150"] {
        assert_eq!(refused(&lathe, &one.replace("A60", words)).0, 143, "{words}");
    }
}

/// The ninth pass is the thread's height but for the last digit: rs274 of 2.9 cuts there twice.
#[test]
fn a_pass_of_linuxcnc_that_reaches_the_height_by_rounding() {
    let dialect = nc_dialect::builtin("linuxcnc-lathe").unwrap();
    let text = "G21 G18 G90 G7\nG0 X36 Z5\nG76 P1.5 Z-20 I-2 J0.3 K1.2 R1.5 Q29.5 H0\n";
    let flat = String::from_utf8(expanded(dialect, text).unwrap().text().to_vec()).unwrap();
    assert_eq!(blocks(&flat).iter().filter(|line| line.starts_with("G33")).count(), 9);
}

/// What `rs274` of LinuxCNC 2.9 makes of the same block, X as a diameter.
#[test]
fn a_thread_of_linuxcnc() {
    let dialect = nc_dialect::builtin("linuxcnc-lathe").unwrap();
    let program = |block: &str| format!("G21 G18 G90 G7\nG0 X36 Z5\n{block}\n");
    let text = program("G76 P1.5 Z-20 I-4 J0.6 K1.84 R1.5 Q29 H2");
    let flat = String::from_utf8(expanded(dialect, &text).unwrap().text().to_vec()).unwrap();
    let passes: Vec<&str> = blocks(&flat).into_iter().skip(2).collect();
    let number = |line: &str, letter: char| -> f64 {
        line.split_whitespace().find_map(|word| word.strip_prefix(letter)?.parse().ok()).unwrap()
    };
    assert_eq!(passes.len(), 8 * 4);
    let wanted = [
        // Clear of the drive line, X and start of the pass, and its end: rs274 prints four decimals of the radius.
        [18.62, 15.7, 4.8337, -19.6563],
        [18.4438, 15.5238, 4.7360, -19.7540],
        [18.2960, 15.3760, 4.6541, -19.8359],
        [18.1640, 15.2440, 4.5810, -19.9091],
        [18.0428, 15.1228, 4.5138, -19.9763],
        [18.0, 15.08, 4.4900, -20.0],
        [18.0, 15.08, 4.4900, -20.0],
        [18.0, 15.08, 4.4900, -20.0],
    ];
    for (pass, wanted) in passes.chunks(4).zip(wanted) {
        assert!(pass[2].starts_with("G33") && pass[2].ends_with("K1.5"), "{pass:?}");
        let found = [
            0.5 * number(pass[0], 'X'),
            0.5 * number(pass[1], 'X'),
            number(pass[0], 'Z'),
            number(pass[2], 'Z'),
        ];
        for (found, wanted) in found.into_iter().zip(wanted) {
            assert!((found - wanted).abs() < 0.6e-4, "{pass:?} {wanted}");
        }
    }
    for block in
        ["G76 P1.5 Z-20 I-4 J0.6 K1.84 E1 L3", "G76 P1.5 Z-20 J0.6 K1.84", "G76 P1.5 Z20 I-4 J0.6 K1.84"]
    {
        let text = program(block);
        assert_eq!(expanded(dialect, &text).expect_err(block).diagnostics[0].code.0, 143);
    }
}

#[test]
fn what_is_not_certain_is_refused() {
    let lathe = dialect("A");
    let rough = |contour: &str| format!("G71 U2. R1.\nG71 P10 Q20 U0.4 W0.2\n{contour}");
    for (program, code) in [
        // No place, or only one of two.
        ("G94\n".to_owned(), 143),
        ("G92 S2000\n".to_owned(), 143),
        ("G90 X50.\n".to_owned(), 143),
        ("/G90 X50. Z-30.\n".to_owned(), 143),
        ("T0202\nG90 X50. Z-30.\n".to_owned(), 143),
        ("G90 X50. Z-30. R-1.\nG92 X48. Z-30. F1.5\n".to_owned(), 143),
        ("G90 X50. Z-30.\nS800\n".to_owned(), 143),
        ("G90 X50. Z-30.\nG28 U0\nX40.\n".to_owned(), 143),
        ("G90 X50. Z-30. T0202\n".to_owned(), 143),
        // Contours.
        ("G71 P10 Q20 U0.4 W0.2\nN10 G0 X20.\nN20 G1 Z-10.\n".to_owned(), 143),
        (rough(""), 144),
        (rough("N10 G0 X20.\nG1 Z-10.\n"), 144),
        (rough("N20 G0 X20.\nG1 Z-10.\nN10 X60.\n"), 144),
        (rough("N10 G0 X20.\nN20 G1 Z-10.\nN10 G0 X20.\n"), 144),
        (rough("G0 X80.\nN10 G0 X20.\nN20 G1 Z-10.\n"), 144),
        (rough("N10 G0 X20.\nG1 Z-10.\nX15. Z-20.\nN20 X60.\n"), 144),
        (rough("N10 G0 X20.\nG1 Z-10.\nX30. Z-5.\nN20 X60.\n"), 144),
        (rough("N10 G0 X20.\nG1 Z-10.\nG3 X30. Z-25. R10.\nN20 G1 X60.\n"), 144),
        (rough("N10 X20.\nN20 G1 Z-10.\n"), 144),
        (rough("N10 G2 X20. Z-10. R50.\nN20 G1 Z-10.\n"), 144),
        (rough("N10 G0 X20.\nM8\nN20 G1 Z-10.\n"), 144),
        (rough("N10 G0 X20.\nG0 Z-10.\nN20 G1 X60.\n"), 144),
        (rough("N10 G0 X20.\nG1 Z-10.\nG4 X1.\nN20 G1 X60.\n"), 144),
        // Aside of the start, and the block of P does not say so.
        (rough("N10 G0 W-1.\nX20.\nG1 Z-10.\nN20 X60.\n"), 144),
        (rough("N10 G0 X20.\nG1 Z-10.\nN20 X60.\nX70.\n"), 143),
        ("G70 P10 Q20\nN10 G0 X20.\nN20 G1 Z-10.\n".to_owned(), 144),
        // Nowhere.
        ("G90 X9000000000. Z-30.\n".to_owned(), 143),
        ("G73 U4. W2. R1\nG73 P10 Q20 U1. W0.5\nN10 G0 X20.\nN20 G1 Z-10.\n".to_owned(), 143),
    ] {
        let (found, message) = refused(&lathe, &program);
        assert_eq!(found, code, "{program}: {message}");
    }
    // The F of roughing, which does not hold for finishing.
    let contour = "N10 G0 X20.\nG1 Z-10.\nN20 X60.\n";
    let unsure = format!("F0.2\nG71 U2. R1.\nG71 P10 Q20 U0.4 W0.2 F0.3\n{contour}G70 P10 Q20\n");
    assert_eq!(refused(&lathe, &unsure).0, 143);
    // Whether X is a diameter must be said.
    let mut unsaid = dialect("A");
    unsaid.turning.as_mut().unwrap().diameters = None;
    assert_eq!(refused(&unsaid, "G90 X50. Z-30.\n").0, 250);
}

#[test]
fn places_lead_back_to_the_source() {
    let text =
        "G0 X60. Z2.\nG71 U8. R1.\nG71 P10 Q20 U0.4 W0.2 F0.3\nN10 G0 X20.\nG1 Z-10.\nN20 X60.\nG0 X99.\n";
    let expanded = expanded(&dialect("A"), text).unwrap();
    let flat = std::str::from_utf8(expanded.text()).expect("text");
    for (what, line) in [("G0 X44.4", "G71 P10"), ("G1 Z-9.8\nG1 X60.4", "G1 Z-10."), ("G0 X99.", "G0 X99.")]
    {
        let at = flat.find(what).unwrap_or_else(|| panic!("{what}\n{flat}")) as u64;
        let origin = expanded.origin(&(at..at + 1));
        assert!(text[origin.span.start as usize..].starts_with(line.get(..2).unwrap()), "{what}: {origin:?}");
        let number = 1 + flat[..at as usize].lines().count() as u64;
        let wanted = 1 + text.lines().position(|found| found.starts_with(line)).unwrap() as u64;
        assert_eq!(expanded.source_line(number), (0, wanted), "{what}\n{flat}");
    }
}

#[test]
fn a_bored_hole_is_left_in_a_feed() {
    let mut lathe = dialect("A");
    let program = "G0 X0. Z5.\nG85 Z-20. R-3. F0.1\nG0 Z8.\n";
    let (code, message) = refused(&lathe, program);
    assert!(code == 145 && message.contains("at which feed G85"), "{message}");
    lathe.turning.as_mut().unwrap().cycles.bore_return_percent = Some(200.0);
    let wanted = ["G0 X0. Z5.", "F0.1 G0 X0. Z2.", "G1 Z-20.", "G1 Z2. F0.2", "F0.1", "G0 X0. Z5.", "G0 Z8."];
    assert_eq!(lines(&lathe, program), wanted);
    // A feed whose point nobody wrote counts increments: half of five is none.
    lathe.turning.as_mut().unwrap().cycles.bore_return_percent = Some(50.0);
    assert_eq!(refused(&lathe, &program.replace("F0.1", "F5")).0, 143);
}

#[test]
fn r_of_a_hole_is_a_place_or_a_way_in_systems_b_and_c() {
    for system in ["B", "C"] {
        let mut lathe = dialect(system);
        let program = "G0 X0. Z5.\nG83 Z-20. R2. F0.1\n";
        let (code, message) = refused(&lathe, program);
        assert!(code == 145 && message.contains("whether R of a hole"), "{message}");
        let set = |lathe: &mut Dialect, r| lathe.turning.as_mut().unwrap().cycles.drill_r = Some(r);
        set(&mut lathe, DrillR::Place);
        let wanted = ["G0 X0. Z5.", "F0.1 G0 X0. Z2.", "G1 Z-20.", "G0 X0. Z2.", "G0 X0. Z5."];
        assert_eq!(lines(&lathe, program), wanted, "{system}");
        // G99 leaves the tool at R.
        let at_r = ["G0 X0. Z5.", "G99 F0.1 G0 X0. Z2.", "G1 Z-20.", "G0 X0. Z2."];
        assert_eq!(lines(&lathe, &program.replace("G83", "G99 G83")), at_r, "{system}");
        set(&mut lathe, DrillR::Way);
        assert_eq!(lines(&lathe, &program.replace("R2.", "R-3.")), wanted, "{system}");
    }
}

/// A level that only touches a cylinder between two rounds, whose centre has three decimals: the pass ran through the
/// collar behind it.
#[test]
fn a_pass_on_the_level_of_a_cylinder_ends_before_the_collar() {
    let mut on_the_level = 0;
    for k in 0..50 {
        let start = 60.0 + 0.1 * f64::from(k);
        // Nine depths of 2.4 below the start, both off by 0.2.
        let x = start - 21.6;
        let program = format!(
            "G0 X{start:.3} Z0.6\nG71 U1.2 R1.\nG71 P10 Q20 U0.2 W0.1 F0.3\nN10 G0 X{:.3}\nG1 Z-14.\nX{:.3} Z-17.897\n\
             G3 X{x:.3} Z-18.33 I-0.25 K-0.433\nG1 Z-29.\nG2 X{:.3} Z-37. I8.\nG1 X{start:.3}\nN20 Z-55.8\nG70 P10 Q20 F0.1\n",
            x - 8.0,
            x - 0.5,
            x + 16.0
        );
        let written = lines(&dialect("A"), &program);
        let level = |line: &&String| {
            let x_word = line.strip_prefix("G0 X").and_then(|rest| rest.strip_suffix(" Z0.7"));
            x_word.is_some_and(|word| (word.parse::<f64>().expect("a number") - x - 0.2).abs() < 1e-6)
        };
        let Some(at) = written.iter().position(|line| level(&line)) else { continue };
        let end: f64 = written[at + 1].trim_start_matches("G1 Z").parse().expect("a pass along Z");
        assert!(end >= -28.9 - 1e-6, "{end}\n{program}");
        on_the_level += 1;
    }
    assert_eq!(on_the_level, 50);
}
