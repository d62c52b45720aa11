//! What a person sees who made a mistake in a grammar.

use nc_dialect::load;

/// The linuxcnc grammar with one place changed, and what `load` says about it.
fn changed(from: &str, to: &str) -> String {
    let text = include_str!("../../../grammars/linuxcnc.toml");
    assert_eq!(text.matches(from).count(), 1, "{from}");
    let text = text.replace(from, to);
    let Err(wrong) = load("changed", &text) else { return "no complaint".to_owned() };
    let shown = wrong.iter().map(|diagnostic| {
        let span = diagnostic.span.clone().expect("every message about a grammar has a place");
        let found = &text[span.start as usize..span.end as usize];
        let help = diagnostic.help.as_ref().map(|help| help.english()).unwrap_or("-");
        format!("{diagnostic}\n  at `{found}`: {}\n  help: {help}", diagnostic.label)
    });
    shown.collect::<Vec<_>>().join("\n")
}

#[test]
fn a_misspelt_action() {
    insta::assert_snapshot!(changed(r#"does = "inch""#, r#"does = "inches""#), @r#"
    error[VP0804]: `inches` is not something a code does
      at `"inches"`: G20 cannot do this
      help: did you mean "inch"? known are: rapid, line, arc-clockwise, arc-counterclockwise, dwell, dwell-by-setting, plane-xy, plane-zx, plane-yz, inch, millimetre, reference, machine-coordinates, probe, compensation-off, compensation-left, compensation-right, length-on, length-on-negative, length-off, tip-length-on, tip-length-on-vectors, tip-on, tip-off, tilted-plane, align-tool, work-offset, drill, bore, bore-out, peck-full, peck-chip, synchronised-cycle, cycle-cancel, return-initial, return-r, return-level, absolute, incremental, arc-centres-absolute, arc-centres-incremental, feed-inverse-time, feed-per-minute, feed-per-revolution, work-offset-numbered, work-offset-by-h, write-offset, local-shift, preset, preset-cancel, preset-suspend, preset-restore, rotation-on, rotation-off, scaling-on, scaling-off, mirror-on, mirror-off, polar-on, polar-off, length-from-words, dwell-p, diameter-on, diameter-off, diameter-of-absolute, speed-limit, limit-or-preset, thread, curve-cubic, curve-quadratic, curve-points, curve-end, curve-knots, curve-plane-knots, turn-pass, thread-pass, face-pass, finish-contour, rough-turn, rough-face, rough-pattern, peck-face, peck-groove, thread-passes, drill-face, bore-face, finish-routine, rough-turn-routine, rough-turn-routine-no-pockets, rough-turn-routine-pockets, rough-face-routine, rough-face-routine-no-pockets, rough-face-routine-pockets, frame-shift, frame-shift-more, frame-rotation, frame-rotation-more, frame-mirror, frame-mirror-more, base-frame, swivel, call-drill, call-drill-dwell, call-drill-pecks, call-bore-feeds, call-bore-oriented, call-modal, call-holes-row, call-holes-circle, arc-turns, arc-angle, corner-round, corner-chamfer, corner-chamfer-length, pass, pass-with-words, pass-with-p, contour-tolerance, alarm, call, dynamic-offset, dynamic-offset-off
    "#);
}

#[test]
fn an_action_nothing_is_near_to() {
    insta::assert_snapshot!(changed(r#"does = "dwell-p""#, r#"does = "warten""#), @r#"
    error[VP0804]: `warten` is not something a code does
      at `"warten"`: G4 cannot do this
      help: known are: rapid, line, arc-clockwise, arc-counterclockwise, dwell, dwell-by-setting, plane-xy, plane-zx, plane-yz, inch, millimetre, reference, machine-coordinates, probe, compensation-off, compensation-left, compensation-right, length-on, length-on-negative, length-off, tip-length-on, tip-length-on-vectors, tip-on, tip-off, tilted-plane, align-tool, work-offset, drill, bore, bore-out, peck-full, peck-chip, synchronised-cycle, cycle-cancel, return-initial, return-r, return-level, absolute, incremental, arc-centres-absolute, arc-centres-incremental, feed-inverse-time, feed-per-minute, feed-per-revolution, work-offset-numbered, work-offset-by-h, write-offset, local-shift, preset, preset-cancel, preset-suspend, preset-restore, rotation-on, rotation-off, scaling-on, scaling-off, mirror-on, mirror-off, polar-on, polar-off, length-from-words, dwell-p, diameter-on, diameter-off, diameter-of-absolute, speed-limit, limit-or-preset, thread, curve-cubic, curve-quadratic, curve-points, curve-end, curve-knots, curve-plane-knots, turn-pass, thread-pass, face-pass, finish-contour, rough-turn, rough-face, rough-pattern, peck-face, peck-groove, thread-passes, drill-face, bore-face, finish-routine, rough-turn-routine, rough-turn-routine-no-pockets, rough-turn-routine-pockets, rough-face-routine, rough-face-routine-no-pockets, rough-face-routine-pockets, frame-shift, frame-shift-more, frame-rotation, frame-rotation-more, frame-mirror, frame-mirror-more, base-frame, swivel, call-drill, call-drill-dwell, call-drill-pecks, call-bore-feeds, call-bore-oriented, call-modal, call-holes-row, call-holes-circle, arc-turns, arc-angle, corner-round, corner-chamfer, corner-chamfer-length, pass, pass-with-words, pass-with-p, contour-tolerance, alarm, call, dynamic-offset, dynamic-offset-off
    "#);
}

#[test]
fn a_code_twice() {
    insta::assert_snapshot!(changed("G21     =", "G021 = { group = 6, does = \"inch\" }\nG21 ="), @r#"
    error[VP0803]: a code stands twice in the table
      at `G21`: the same code as in another row
      help: remove one of the rows: `G1` and `G01` are the same code
    "#);
}

#[test]
fn the_same_key_twice() {
    insta::assert_snapshot!(changed("G21     =", "G20 = { group = 6, does = \"inch\" }\nG21 ="), @r#"
    error[VP0801]: the grammar cannot be read: duplicate key
      at `G20`: here
      help: docs/dialects.md lists every field of a grammar
    "#);
}

#[test]
fn no_code() {
    insta::assert_snapshot!(changed("\"G90.1\" =", "\"G90.12\" ="), @r#"
    error[VP0802]: `G90.12` is not a code
      at `"G90.12"`: expected a key like G81 or "G54.1"
      help: write the capital letter and the number; keys with a point stand in quotes
    "#);
}

#[test]
fn a_mode_of_the_path_that_no_row_has() {
    insta::assert_snapshot!(changed("G61     = \"exact\"", "G60     = \"exact\""), @r#"
    error[VP0802]: `G60` has no row of its own
      at `G60`: expected a code or command of this table
      help: say under [codes] or [commands] what it does, or delete this line
    "#);
}

#[test]
fn neither_done_nor_refused() {
    insta::assert_snapshot!(changed(r#"{ group = 0, does = "dwell-p" }"#, "{ group = 0 }"), @r#"
    error[VP0805]: G4 says neither what it does nor why it is refused
      at `G4`: expected `does`, or `refuse` with `help`
      help: write `G4 = { group = 0, does = "pass" }` if it moves nothing
    "#);
}

#[test]
fn refused_without_a_way_out() {
    insta::assert_snapshot!(changed(r#", help = "let the CAM write the moves, or mill the thread (G2/G3 helices)""#, ""), @r#"
    error[VP0805]: G76 is refused without a way out
      at `G76`: add `help`: what the user can do
      help: -
    "#);
}

#[test]
fn an_unknown_field() {
    insta::assert_snapshot!(changed("spaces_inside  ", "space_inside  "), @r#"
    error[VP0801]: the grammar cannot be read: unknown field `space_inside`, expected one of `without_point`, `least_increment_decimals_mm`, `least_increment_decimals_inch`, `spaces_inside`, `dwell_time`
      at `space_inside`: here
      help: docs/dialects.md lists every field of a grammar
    "#);
}

#[test]
fn a_start_that_cannot_be() {
    insta::assert_snapshot!(changed(r#"["G17", "G21", "#, r#"["G17", "G18", "G4", "G33", "G6", "#), @r#"
    error[VP0807]: `G18` excludes G17, of the same group: it cannot hold at the start
      at `"G18"`: expected a modal code of the table
      help: write codes as the table writes them: `G17`, not `G017`
    error[VP0807]: `G4` holds for one block only (group 0): it cannot hold at the start
      at `"G4"`: expected a modal code of the table
      help: write codes as the table writes them: `G17`, not `G017`
    error[VP0807]: `G33` is a refused code: it cannot hold at the start
      at `"G33"`: expected a modal code of the table
      help: write codes as the table writes them: `G17`, not `G017`
    error[VP0807]: `G6` has no row in [codes]: it cannot hold at the start
      at `"G6"`: expected a modal code of the table
      help: write codes as the table writes them: `G17`, not `G017`
    "#);
}

#[test]
fn numbers_out_of_range() {
    insta::assert_snapshot!(changed("radius_tolerance_mm = 0.0279", "radius_tolerance_mm = nan"), @r#"
    error[VP0806]: arc_radius_tolerance_mm = NaN is out of range
      at `nan`: expected above 0, up to 10 mm
      help: -
    "#);
    insta::assert_snapshot!(changed("tolerance_share = 0.001", "tolerance_share = 0.5"), @r#"
    error[VP0806]: arc_radius_tolerance_share = 0.5 is out of range
      at `0.5`: expected 0 to 0.01 of the radius
      help: -
    "#);
    insta::assert_snapshot!(changed("decimals_inch           = 6", "decimals_inch = 12"), @r#"
    error[VP0806]: decimals_inch = 12 is no control's resolution
      at `12`: expected 0 to 9
      help: -
    "#);
    insta::assert_snapshot!(changed("loses_position = \"XYZ\" }\nM7", "loses_position = \"XQ\" }\nM7"), @r#"
    error[VP0806]: `Q` is not a linear axis
      at `"XQ"`: expected some of X, Y, Z
      help: -
    "#);
}

#[test]
fn letters_that_are_none() {
    insta::assert_snapshot!(changed("ABCDEFGHIJKLMNOPQRSTUVWXYZ", "ABCDEFHIJKLMNOPQRSTUVWXYZ"), @r#"
    error[VP0808]: these cannot be the letters of words: `G` is missing
      at `"ABCDEFHIJKLMNOPQRSTUVWXYZ"`: expected each letter of a word once
      help: letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ" takes all
    "#);
    insta::assert_snapshot!(changed("ABCDEFGHIJKLMNOPQRSTUVWXYZ", "abc"), @r#"
    error[VP0808]: these cannot be the letters of words: `a` is not a capital letter
      at `"abc"`: expected each letter of a word once
      help: letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZ" takes all
    "#);
    let lathe = "[[lathe]]\ncodes = [\"G96\"]\nwith = \"X,Z\"\nsays = \"\"\nmill = \"\"\n\n[codes]";
    assert_eq!(changed("[codes]", &lathe.replace("X,Z", "xz")), "no complaint");
    insta::assert_snapshot!(changed("[codes]", lathe), @r#"
    error[VP0808]: `,` is not a capital letter
      at `"X,Z"`: expected letters of words: "XZ"
      help: -
    "#);
}

#[test]
fn no_toml() {
    insta::assert_snapshot!(changed("[codes]", "[codes"), @r#"
    error[VP0801]: the grammar cannot be read: unclosed table, expected `]`
      at ``: here
      help: docs/dialects.md lists every field of a grammar
    "#);
}

/// A table of a few lines on top of Fanuc's.
fn extended(text: &str) -> Result<nc_dialect::Dialect, String> {
    load("own", text).map_err(|wrong| {
        let shown = wrong.iter().map(|diagnostic| {
            let span = diagnostic.span.clone().expect("every message about a grammar has a place");
            format!("{diagnostic} at `{}`", &text[span.start as usize..span.end as usize])
        });
        shown.collect::<Vec<_>>().join("\n")
    })
}

#[test]
fn a_table_says_what_differs() {
    let text = r#"
        title = "Our mill"
        extends = "fanuc"
        [cycles]
        repeats = "L"
        [codes]
        G100 = { group = 0, does = "pass" }
        G12 = { group = 0, does = "pass-with-words" }
    "#;
    let (own, fanuc) = (extended(text).unwrap(), nc_dialect::builtin("fanuc").unwrap());
    assert_eq!((own.title.as_str(), own.extends.as_deref()), ("Our mill", Some("fanuc")));
    assert_eq!(own.cycle_repeats, b"L");
    assert_eq!(own.output, fanuc.output);
    let others = fanuc.codes.iter().filter(|entry| entry.code.to_string() != "G12");
    for entry in others {
        assert_eq!(own.code(entry.code), Some(entry));
    }
    assert_eq!(own.codes.iter().count(), fanuc.codes.iter().count() + 1);
}

#[test]
fn what_is_wrong_on_top_of_a_table_has_a_place_in_its_own_text() {
    let of = |lines: &str| extended(&format!("title = \"x\"\nextends = \"fanuc\"\n{lines}")).unwrap_err();
    // G15 holds at Fanuc's start: the row that refuses it breaks the table beneath.
    let wrong = of("[codes]\nG15 = { group = 17, refuse = \"x\", help = \"y\" }");
    assert!(wrong.contains("VP0807") && wrong.ends_with("at `\"fanuc\"`"), "{wrong}");
    assert!(of("[codes]\nG7 = { group = 0, does = \"fly\" }").contains("at `\"fly\"`"));
    assert!(of("[codes]\nG021 = { group = 6, does = \"inch\" }").contains("VP0803"));
    assert!(of("[cylces]\nrepeats = \"K\"").contains("VP0801"));
    let none = extended("title = \"x\"\nextends = \"fanoc\"").unwrap_err();
    assert!(none.contains("VP0801") && none.contains("`fanoc`"), "{none}");
}
