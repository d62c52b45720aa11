//! Okuma's drilling cycles, written out as moves: heights against Okuma's Programming Manual, worked out by hand.

use crate::common;

use common::{blocks, expanded};

const START: &str = "O1 (HOLES)\nG15 H1\nG17 G21 G90\nG0 X10. Y10. Z60.\n";

/// The lines that are no comments, behind the start.
fn flat(program: &str) -> Vec<String> {
    let text = common::flat("okuma", &format!("{START}{program}"), &[], &[]);
    let lines = blocks(&text).into_iter().skip(4);
    lines.filter(|line| !line.starts_with('(')).map(str::to_owned).collect()
}

fn refused(program: &str) -> u16 {
    let refusal = expanded("okuma", &format!("{START}{program}"), &[], &[]).expect_err("refused");
    refusal.diagnostics[0].code.0
}

#[test]
fn m53_returns_to_the_level_of_g71_and_m54_to_r() {
    let lines = flat("G71 Z58.\nG81 X20. Y5. Z-8. R2. F100 M53\nX30.\nG80\nG0 X0.\n");
    let hole =
        |at: &str| vec![at.to_owned(), "G0 Z2.".to_owned(), "G1 Z-8.".to_owned(), "G0 Z58.".to_owned()];
    let mut wanted = vec!["G71 Z58.".to_owned()];
    wanted.extend(hole("G0 X20. Y5."));
    wanted.extend(hole("G0 X30."));
    wanted[3].push_str(" F100");
    wanted.extend(["G80".to_owned(), "G0 X0.".to_owned()]);
    assert_eq!(lines, wanted);
    let lines = flat("G17 G90 G82 X20. Y5. Z-8. R2. P0 F100 M54\nG0 Z60.\n");
    assert_eq!(lines, ["G0 G17 G90 X20. Y5.", "G0 Z2.", "G1 Z-8. F100", "G0 Z2.", "G0 Z60."]);
    // Where it stands, and in increments of no point.
    let lines = flat("G71 Z50000\nG81 Z-8000 R2. F100 M53\nG0 Z60.\n");
    assert_eq!(lines[1..4], ["G0 Z2.", "G1 Z-8. F100", "G0 Z50."]);
}

#[test]
fn pecks_return_to_r() {
    // 8 deep from Z2 by 4: to -2, and back to 0.254 above it, then the bottom.
    let lines = flat("G71 Z58.\nG83 X20. Y5. Z-6. R2. Q4. F100 M53\nG0 Z60.\n");
    assert_eq!(
        lines[1..],
        [
            "G0 X20. Y5.",
            "G0 Z2.",
            "G1 Z-2. F100",
            "G0 Z2.",
            "G0 Z-1.746",
            "G1 Z-6. F100",
            "G0 Z58.",
            "G0 Z60."
        ]
    );
}

#[test]
fn what_is_not_certain_is_refused() {
    for program in [
        // What a held cycle's numbers mean must not change between its holes, nor a level's behind it.
        "G71 Z20.\nG81 X10. Z-5. R2. F100 M53\nG91\nX10.\n",
        "G71 Z20.\nG81 X10. Z-5. R2. F100 M53\nG20\nX1.\n",
        "G71 Z20.\nG81 X10. Z-5. R2. F100 M53\nG15 H2\nX1.\n",
        "G71 Z20.\nG81 X10. Z-5. R2. F100 M53\nG18\nX1.\n",
        "G20\nG71 Z2.\nG21\nG81 X10. Z-5. R2. F100 M53\n",
        "G71 Z20.\nG15 H2\nG81 X10. Z-5. R2. F100 M53\n",
        "G71 Z58.\nG81 X20. Y5. Z-8. R2. F100\n",
        "G71 Z58.\nG81 X20. Y5. Z-8. R2. F100 M53 M54\n",
        "G81 X20. Y5. Z-8. R2. F100 M53\n",
        "G71 Z1.\nG81 X20. Y5. Z-8. R2. F100 M53\n",
        "G71 Z58.\nG81 X20. Y5. Z8. R2. F100 M53\n",
        "G71 Z58.\nG81 X20. Y5. R2. F100 M53\n",
        "G71 Z58.\nG82 X20. Y5. Z-8. R2. P500 F100 M53\n",
        "G71 Z58.\nG83 X20. Y5. Z-8. R2. F100 M53\n",
        "G71 Z58.\nG83 X20. Y5. Z-8. R2. Q0.001 F100 M53\n",
        "G71 Z58.\nG81 X20. Y5. Z-8. R2. Q3. F100 M53\n",
        "G71 Z58.\nG81 X20. Y5. Z-8. R2. F100 M53 M8\n",
        "G71 Z58.\nG0 G81 X20. Y5. Z-8. R2. F100 M53\n",
        "G71 Z58.\nG91 G81 X20. Y5. Z-8. R2. F100 M53\n",
        "G71 Z58.\nG18 G81 X20. Y5. Z-8. R2. F100 M53\n",
        "G71 Z58.\n/G81 X20. Y5. Z-8. R2. F100 M53\n",
        "G71 Z58.\nG81 X20. Y5. Z-8. R2. F100 M53\nX30. Z-9.\n",
        "G71 Z58.\nG81 X20. Y5. Z-8. R2. F100 M53\n/X30.\n",
        "G71 Z58.\nG81 X20. Y5. Z-8. R2. F100 M53\nG80\nX30.\n",
        "G71 Z58. X5.\nG81 X20. Y5. Z-8. R2. F100 M53\n",
        "G91 G71 Z58.\nG90 G81 X20. Y5. Z-8. R2. F100 M53\n",
    ] {
        assert_eq!(refused(program), 146, "{program}");
    }
}
