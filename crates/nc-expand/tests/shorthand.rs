//! Corners and polar words: what they are written out as, against points worked out by hand.

use crate::common;

use common::{blocks, expanded};

const START: &str = "G17 G21 G90\nG0 X10. Y10. Z60.\n";

/// The lines that are no comments, behind the start.
fn flat(program: &str) -> Vec<String> {
    let text = common::flat("fanuc", &format!("{START}{program}"), &[], &[]);
    blocks(&text).into_iter().skip(2).map(str::to_owned).collect()
}

#[test]
fn corners_are_arcs_and_lines() {
    // A right angle: the tangent points lie one radius from the corner.
    let lines = flat("G1 X40. ,R5. F200.\nY40.\n");
    assert_eq!(lines, ["G1 X35. Y10. F200.", "G3 X40. Y15. I0. J5.", "G1 X40. Y40."]);
    let lines = flat("G1 X40. ,R5. F200.\nY-40.\n");
    assert_eq!(lines, ["G1 X35. Y10. F200.", "G2 X40. Y5. I0. J-5.", "G1 X40. Y-40."]);
    // A chamfer's legs are measured along the lines.
    let lines = flat("G1 X40. ,C3. F200.\nX10. Y50.\n");
    assert_eq!(lines, ["G1 X37. Y10. F200.", "G1 X38.2 Y12.4", "G1 X10. Y50."]);
    // 3-4-5: half the angle between the lines has tangent 1/2, so the tangent points lie 2 r from the corner.
    let lines = flat("G1 X40. ,R4. F200.\nX10. Y50.\n");
    assert_eq!(lines, ["G1 X32. Y10. F200.", "G3 X35.2 Y16.4 I0. J4.", "G1 X10. Y50."]);
    // One corner behind another, a remark between, and what stands beside the words stays.
    let lines = flat("N1 G1 X40. ,R5. F200. M8\n(remark)\nN2 Y40. ,C5.\nN3 X10. M9\n");
    assert_eq!(
        lines,
        [
            "N1 G1 X35. Y10. F200. M8",
            "G3 X40. Y15. I0. J5.",
            "N2 G1 X40. Y35.",
            "G1 X35. Y40.",
            "N3 G1 X10. Y40. M9"
        ]
    );
    // G18: Z is the first axis; from Z to X is the sense of G3.
    let lines = flat("G18\nG1 Z90. ,R5. F200.\nX40.\n");
    assert_eq!(lines, ["G18", "G1 X10. Z85. F200.", "G3 X15. Z90. K0. I5.", "G1 X40. Z90."]);
}

#[test]
fn polar_words_are_points() {
    let lines = flat("G16\nG81 X100. Y30. Z-20. R5. F100.\nY90.\nX50. Y180.\nG15 G80\nG0 X10.\n");
    assert_eq!(lines, ["G81 X86.60254 Y50. Z-20. R5. F100.", "X0. Y100.", "X-50. Y0.", "G15 G80", "G0 X10."]);
    // Words that are nobody's coordinates stay.
    let lines = flat("G16\nG0 X10. Y0\nG4 X2.\nZ5.\nG15\n");
    assert_eq!(lines, ["G0 X10. Y0.", "G4 X2.", "Z5.", "G15"]);
}

#[test]
fn places_lead_back_to_the_source() {
    let text = "G0 X10. Y10. Z60.\n#1=5.\nG1 X40. ,R#1 F200.\nY40.\nX99.\n";
    let expanded = expanded("fanuc", text, &[], &[]).unwrap();
    let flat = std::str::from_utf8(expanded.text()).unwrap();
    for (what, line) in [("G3 ", "G1 X40. ,R#1 F200."), ("G1 X40. Y40.", "Y40."), ("X99.", "X99.")] {
        let at = flat.find(what).unwrap() as u64;
        let origin = expanded.origin(&(at..at + 1));
        assert!(text[origin.span.start as usize..].starts_with(line.get(..1).unwrap()), "{what}: {origin:?}");
        let number = 1 + flat[..at as usize].lines().count() as u64;
        let wanted = 1 + text.lines().position(|found| found == line).unwrap() as u64;
        assert_eq!(expanded.source_line(number), (0, wanted), "{what}\n{flat}");
    }
}

#[test]
fn what_is_not_certain_is_refused() {
    for program in [
        "G1 X40. ,R5.\n",
        "G1 X40. ,R5.\nG0 Y40.\n",
        "G1 X40. ,R5.\nG3 Y40. R20.\n",
        "G1 X40. ,R5.\nZ40.\n",
        "G1 X40. ,R5.\nX80.\n",
        "G1 X40. ,R5.\nX20.\n",
        "G1 X40. ,R5.\nY12.\n",
        "G1 X40. ,R0\nY40.\n",
        "G1 X40. ,R5.\n/Y40.\n",
        "G1 X40. Z50. ,R5.\nY40.\n",
        "G91 G1 X40. ,R5.\nY40.\n",
        "G54\nG1 X40. ,R5.\nY40.\n",
        "G92 X0\nG1 X4. ,R.5\nY4.\n",
        "G91 G28 Z0 Y0\nG90 G1 X40. ,R5.\nY40.\n",
        "G53 G0 Y0\nG1 X40. ,R5.\nY40.\n",
        "G16\nG0 X10. Y30.\nG52 X5.\n",
        "G16\nG0 X10. Y30.\nG53 G0 X5.\n",
        "G16\nG0 X10. Y30.\n/G15\n",
        "G1 X40. ,A30.\nY40.\n",
        // The second corner starts where the first one ends.
        "G1 X40. ,R5.\nY20. ,R6.\nX10.\n",
        "G16\nG0 X10.\n",
        "G16\nG0 X-10. Y30.\n",
        "G16 X10. Y30.\n",
        "G16\nG91 Y30.\n",
        "G16\nG0 X10. Y30.\nG18\n",
        "G16\nG0 X10. Y30.\nG28 Z0\n",
        "G16\nG0 X10. Y30.\nG2 Y60. I5.\n",
        "G16\nG0 X10. Y30.\nG15 X5.\n",
    ] {
        let text = format!("{START}{program}");
        let refusal = expanded("fanuc", &text, &[], &[]).expect_err(program);
        assert_eq!(refusal.diagnostics[0].code.0, 142, "{program}");
    }
}

/// What the one reader knows for certain starts a corner, whatever was before it.
#[test]
fn a_corner_starts_where_the_tool_stands() {
    let corner = "G80 G90\nG1 Y40. Z30. F300.\nG1 X90. ,R5.\nY80.\n";
    let cycle = "G91 G99 G81 X10. Y0. Z-12. R-38.";
    let counted = flat(&format!("{cycle} K5 F100.\n{corner}"));
    let one_by_one = flat(&format!("{cycle} F100.\nX10.\nX10.\nX10.\nX10.\n{corner}"));
    let none = flat(&format!("{cycle} K0 F100.\n{corner}"));
    assert!(counted.contains(&"G1 X85. Y40.".to_owned()), "{counted:?}");
    assert_eq!(counted[1..], one_by_one[5..]);
    assert!(none.contains(&"G1 X85. Y40.".to_owned()), "{none:?}");
    // From X60 and from X10 the corner is another where the line does not run along an axis.
    let oblique = "G80 G90\nG0 Z60.\nG1 Z30. F300.\nG1 Y40. ,R5.\nX100.\nG0 Z60.\n";
    let [five, no] = ["K5", "K0"].map(|count| flat(&format!("{cycle} {count} F100.\n{oblique}")));
    assert!(five.contains(&"G1 X60. Y35.".to_owned()), "{five:?}");
    assert!(no.contains(&"G1 X10. Y35.".to_owned()), "{no:?}");
    assert!(
        flat(&format!("{cycle} K5 F100.\nG80 G90\nG68 R30.\n")).contains(&"G68 X60. Y10. R30.".to_owned())
    );
    assert_eq!(flat("G20\nG1 X4. ,R.5\nY4.\n")[1], "G1 X3.5 Y0.393701");
    // Polar words stay polar beside codes that set something.
    assert_eq!(flat("G16\nG55 G0 X10. Y90.\n")[0], "G55 G0 X0. Y10.");
    assert_eq!(flat("G16\nG43 H1 G0 X10. Y90. Z50.\n")[0], "G43 H1 G0 X0. Y10. Z50.");
    assert_eq!(flat("G16\nG0 X10. Y90.\nG4 X1.\n")[1], "G4 X1.");
}

/// A program that is refused anyway says why, and not what follows from that.
#[test]
fn a_block_that_is_refused_is_named_before_what_hangs_on_it() {
    let text = format!("{START}G999 X20.\nG1 X40. ,R5.\nX80.\n");
    let refusal = common::expanded("fanuc", &text, &[], &[]).expect_err("refused");
    let first = &refusal.diagnostics[0];
    let span = first.span.clone().expect("a place");
    assert_eq!((first.code.0, &text[span.start as usize..span.end as usize]), (207, "G999"));
}

#[test]
fn a_rotation_without_its_centre_is_given_the_tools_place() {
    // The control would take the corrected place for it.
    assert_eq!(flat("G68 R30.\nX20. Y5.\nG69\n")[0], "G68 X10. Y10. R30.");
    assert_eq!(flat("G18\nG68 R30.\n")[1], "G68 X10. Z60. R30.");
    assert_eq!(flat("G91 X5.\nG90 G68R30.\n")[1], "G90 G68 X15. Y10.R30.");
    // With a centre it stays as it is, and so it does where the control's own setting decides.
    assert_eq!(flat("G68 X1. Y2. R30.\n"), ["G68 X1. Y2. R30."]);
    let haas = common::flat("haas", &format!("{START}G68 R30.\n"), &[], &[]);
    assert!(haas.ends_with("G68 R30.\n"), "{haas}");
    for program in ["G55\nG68 R30.\n", "M6 T2\nG68 R30.\n", "G92 X5.\nG68 R30.\n"] {
        let text = format!("{START}{program}");
        let refusal = common::expanded("fanuc", &text, &[], &[]).expect_err("refused");
        assert_eq!(refusal.diagnostics[0].code.0, 142, "{program}");
    }
}
