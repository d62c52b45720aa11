//! Corners and angles of a lathe's drawing, worked out by hand.

use crate::common;

use common::blocks;
use nc_dialect::Dialect;
use nc_expand::{Environment, Limits, expand};

fn dialect(diameters: Option<bool>, plain: bool) -> Dialect {
    let mut dialect =
        nc_dialect::builtin("fanuc-lathe").and_then(|dialect| dialect.in_system("A")).expect("a system");
    let turning = dialect.turning.as_mut().expect("a lathe");
    (turning.diameters, turning.cycles.plain_drawing) = (diameters, plain);
    dialect
}

/// The lines that are no comments, behind the start; or the message.
fn written(program: &str, diameters: Option<bool>) -> Result<Vec<String>, String> {
    written_in(program, &dialect(diameters, false))
}

fn written_in(program: &str, dialect: &Dialect) -> Result<Vec<String>, String> {
    let text = format!("G0 X60. Z2.\n{program}");
    let environment = Environment {
        variables: &[],
        read_external: &common::nothing,
        setup: &common::setup(dialect),
        limits: Limits::default(),
    };
    match expand(text.as_bytes(), dialect, &environment) {
        Ok(expanded) => {
            let flat = String::from_utf8(expanded.text().to_vec()).expect("text");
            Ok(blocks(&flat).into_iter().skip(1).map(str::to_owned).collect())
        }
        Err(refusal) => {
            let diagnostic = &refusal.diagnostics[0];
            Err(format!("{} {}", diagnostic.code.0, diagnostic.label.english()))
        }
    }
}

fn lines(program: &str) -> Vec<String> {
    written(program, Some(true)).unwrap_or_else(|why| panic!("{program}\n{why}"))
}

#[test]
fn corners_are_cut_in_radius_and_z() {
    let wanted = [
        "G1 X20. F0.2",
        "X20. Z-8.",
        "G2 X24. Z-10. I2. K0.",
        "G1 X28. Z-10. M8",
        "G1 X30. Z-11.",
        "G1 X30. Z-20.",
        "M30",
    ];
    assert_eq!(lines("G1 X20. F0.2\nZ-10. ,R2.\nX30. ,C1. M8\nZ-20.\nM30\n"), wanted);
    // U and W are increments of what the drawing says, not of where the corner ends.
    assert_eq!(lines("G1 X20. F0.2\nW-12. ,R2.\nU10. ,C1. M8\nW-10.\nM30\n"), wanted);
    let radii = written("G1 X10. F0.2\nZ-10. ,R2.\nX15.\n", Some(false)).expect("radii");
    assert_eq!(radii[1..], ["X10. Z-8.", "G2 X12. Z-10. I2. K0.", "G1 X15. Z-10."]);
}

#[test]
fn angles_count_from_z_towards_x() {
    // 17 of radius at 160 degrees: 17 / tan(160) = -46.707116.
    let slope = lines("G1 X20. Z0. F0.2\nX54. ,A160.\nZ-60.\n");
    assert_eq!(slope, ["G1 X20. Z0. F0.2", "X54. Z-46.707116", "Z-60."]);
    assert_eq!(lines("G1 X20. Z0. F0.2\nX54. ,A-20.\nZ-60.\n"), slope);
    // The cylinder meets the cone of 45 degrees where its radius is 10: Z-20.
    let met = lines("G1 X20. Z0. F0.2\n,A180.\nX40. Z-30. ,A135.\nX50.\n");
    assert_eq!(met[1..], ["X20. Z-20.", "X40. Z-30.", "X50."]);
    // 5 / tan(67.5) = 2.071068 along both.
    let round = lines("G1 X20. Z0. F0.2\n,A180. ,R5.\n(between)\nX40. Z-30. ,A135.\nX50.\n");
    assert_eq!(
        round[1..],
        ["X20. Z-17.928932", "G2 X22.928932 Z-21.464466 I5. K0.", "G1 X40. Z-30.", "X50."]
    );
}

#[test]
fn a_contour_of_a_cycle_has_them_too() {
    let program = |last: &str| {
        format!(
            "G71 U5. R0.5\nG71 P10 Q20 U0. W0. F0.2\nN10 G0 X20.\nG1 Z-10. ,R2.\n{last}\nG1 X50. ,C1.\nZ-5.\n"
        )
    };
    let written_out = lines(&program("N20 X40."));
    let finish = ["G0 X20. Z2.", "G1 Z-8.", "G2 X24. Z-10. I2. K0.", "G1 X40.", "G0 X60. Z2."];
    let at = written_out.iter().position(|line| line.starts_with("G2")).expect("an arc") - 2;
    assert_eq!(written_out[at..at + 5], finish, "{written_out:#?}");
    // Behind it the tool stands where the cycle began: at Z2.
    assert_eq!(written_out[at + 5..], ["G1 X52. Z2.", "G1 X50. Z1.", "G1 X50. Z-5."], "{written_out:#?}");
    let told = written(&program("N20 X40. ,C1."), Some(true)).expect_err("no next line");
    assert_eq!(told, "142 a corner in the last block of a contour");
}

#[test]
fn what_is_not_certain_is_refused() {
    let cases = [
        (
            "G1 X20. F0.2\nZ-10. ,R2.\nG2 X30. Z-15. R5.\n",
            "142 G1 was expected on both sides, and no other code in the block",
        ),
        (
            "G1 X20. F0.2\nZ-10. ,R2.\nZ-20.\n",
            "142 the lines are too short for it, or go straight on or back",
        ),
        (
            "G1 X20. F0.2\nZ-10. ,R20.\nX30.\n",
            "142 the lines are too short for it, or go straight on or back",
        ),
        (
            "G1 X20. F0.2\nX30. Z-10. ,A135.\nX40.\n",
            "142 an angle beside X and Z: one of the three is too many",
        ),
        (
            "G1 X20. F0.2\n,A180.\nX40. Z-30.\n",
            "142 behind a line with an angle alone, `,A`, X and Z were expected",
        ),
        ("G1 X20. F0.2\n,A180.\nX40. Z-30. ,A180.\n", "142 two lines that do not cross"),
        ("G1 X20. F0.2\nX40. ,A180.\n", "142 at this angle the line never gets to that place"),
        ("G1 X20. F0.2\nZ-10. ,R2.\n", "142 a next line was expected behind it"),
        (
            "G1 X20. F0.2\nZ-10. ,B2.\nX30.\n",
            "142 one angle `,A` and one corner, `,R` or `,C` above zero, can be written out",
        ),
        (
            "G54\nG28 U0.\nG1 Z-10. ,R2.\nX30.\n",
            "142 where the line starts is not known: name X and Z before it",
        ),
    ];
    for (program, why) in cases {
        assert_eq!(written(program, Some(true)), Err(why.to_owned()), "{program}");
    }
    let unsaid = written("G1 X20. F0.2\nZ-10. ,R2.\nX30.\n", None);
    assert_eq!(unsaid, Err("250 half of what is written, or all of it?".to_owned()));
}

/// Parameter 3405.4 takes the comma away; R of arcs and of cycles stays what it is.
#[test]
fn without_a_comma_where_the_profile_says_so() {
    let plain = |program: &str| written_in(program, &dialect(Some(true), true));
    let lines_and_arcs =
        "G1 X20. F0.2\nZ-10. ,R2.\nX30. ,C1. M8\nZ-20.\nX54. ,A160.\nZ-80.\nG2 X60. Z-83. R3.\nM30\n";
    let without = lines_and_arcs.replace(',', "");
    assert_eq!(plain(&without).expect("written"), lines(lines_and_arcs));
    assert_eq!(plain(lines_and_arcs).expect("written"), lines(lines_and_arcs));
    let contour = |comma: &str| {
        format!(
            "G71 U5. R0.5\nG71 P10 Q20 U0. W0. F0.2\nN10 G0 X20.\nG1 Z-10. {comma}R2.\nX40. {comma}C1.\nN20 Z-20.\nG70 P10 Q20 F0.1\n"
        )
    };
    assert_eq!(plain(&contour("")).expect("written"), lines(&contour(",")));
    // Roughing that passed over it would cut into the rounded corner: 144 where nobody says what it is.
    let why = written(&contour(""), Some(true)).expect_err("R of a line");
    assert!(why.starts_with("144 a corner"), "{why}");
    for program in ["G1 Z-10. R-2.\nX70.\n", "G1 Z-10. A90. A80.\n", "G1 X50. Z-10. R2.\nG0 X70.\n"] {
        assert!(plain(program).expect_err(program).starts_with("142 "), "{program}");
    }
}

/// G90 of system A without a place is no pass, and where the tool stands in another frame nobody knows.
#[test]
fn a_pass_without_a_place_keeps_no_place() {
    let why = written("G55 G90\nG1 Z-10. ,R2.\nX70.\n", Some(true)).expect_err("another frame");
    assert!(why.contains("not known"), "{why}");
}

#[test]
fn a_contour_made_again_has_its_corners_from_where_it_is_made() {
    // The first time it comes down to Z-10. from the start, the second time up to it from Z-20.
    let contour = "N10 G0 X20.\nG1 Z-10. ,R1. F0.2\nX40.\nN11 Z-20.\n";
    let (down, up) =
        (["G1 X20. Z-9. F0.2", "G2 X22. Z-10. I1. K0."], ["G1 X20. Z-11. F0.2", "G3 X22. Z-10. I1. K0."]);
    let found = lines(&format!("{contour}G70 P10 Q11\nM30\n"));
    assert_eq!(found[1..3], down, "{found:?}");
    assert_eq!(found[6..8], up, "{found:?}");
}
