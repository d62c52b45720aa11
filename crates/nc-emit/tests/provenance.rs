//! The comment that says who corrected a program, and its place.

use crate::common;

use common::{dialect, read};
use nc_emit::{find_provenance, insert_provenance, provenance_comment, provenance_position};
use nc_syntax::{Paren, Semicolon};

#[test]
fn the_comment_is_safe_in_every_control() {
    let mut dialect = dialect();
    let text = "0.1.0, profile: Стан 50% (new), engine rigid-body";
    assert_eq!(
        String::from_utf8(provenance_comment(&dialect, text)).unwrap(),
        "(CORRECTED BY VPOST 0.1.0, PROFILE- STAN 50- [NEW], ENGINE RIGID-BODY)"
    );
    dialect.output.max_block_bytes = 30;
    assert_eq!(provenance_comment(&dialect, text), b"(CORRECTED BY VPOST 0.1.0, PR)");
    dialect.output.max_block_bytes = 5;
    assert_eq!(provenance_comment(&dialect, text), b"(CORRECTED BY VPOST)");
    dialect.marks.paren = Paren::Command;
    assert_eq!(provenance_comment(&dialect, ""), b"; CORRECTED BY VPOST");
    dialect.marks.semicolon = Semicolon::None;
    assert_eq!(provenance_comment(&dialect, text), b"");
}

#[test]
fn an_earlier_correction_is_found() {
    let found = |text: &str| {
        find_provenance(text.as_bytes())
            .map(|range| text[range.start as usize..range.end as usize].to_owned())
    };
    assert_eq!(found("%\n(corrected by Vpost 1)\nG1 X1"), Some("(corrected by Vpost 1)".into()));
    assert_eq!(found("G0 V1\r\n; CORRECTED BY VPOST"), Some("; CORRECTED BY VPOST".into()));
    assert_eq!(found("CORRECTED BY VPOST"), None, "not in a comment");
    assert_eq!(found("(post V2)\n(CORRECTED BY VPOS"), None);
    assert_eq!(found(""), None);
    for semicolon_only in [false, true] {
        let mut dialect = dialect();
        if semicolon_only {
            dialect.marks.paren = Paren::None;
        }
        assert!(find_provenance(&provenance_comment(&dialect, "x")).is_some());
    }
}

#[test]
fn the_comment_goes_after_what_must_stay_first() {
    let dialect = dialect();
    for (text, expected) in [
        ("%\nO1234 (NAME)\nG0 X1\n%\n", "%\nO1234 (NAME)\n(C)\nG0 X1\n%\n"),
        ("%\r\n:1234\r\nG0 X1\r\n", "%\r\n:1234\r\n(C)\r\nG0 X1\r\n"),
        ("%\n;\npart.nc (x)\n(y)\nG0 X1", "%\n;\npart.nc (x)\n(C)\n(y)\nG0 X1"),
        ("leader text\n%\nG0 X1\n%\n", "leader text\n%\n(C)\nG0 X1\n%\n"),
        ("(a)\n(b)\nG0 X1\n", "(C)\n(a)\n(b)\nG0 X1\n"),
        ("%\n(a)\nO1\nG0 X1\n", "%\n(a)\nO1\n(C)\nG0 X1\n"),
        ("G0 X1", "(C)\nG0 X1"),
        ("O1\rG0 X1\r", "O1\r(C)\rG0 X1\r"),
        ("O1\r\r\nG0 X1\r\r\n", "O1\r\r\n(C)\r\r\nG0 X1\r\r\n"),
        ("%\nO1\n%\n", "%\nO1\n(C)\n%\n"),
        ("O1", "O1\n(C)\n"),
        ("G0 X1\nO1\n", "(C)\nG0 X1\nO1\n"),
        ("", "(C)\n"),
    ] {
        let position = provenance_position(read(&dialect, text));
        let mut out = text.as_bytes().to_vec();
        insert_provenance(&mut out, position, b"(C)");
        assert_eq!(String::from_utf8(out).unwrap(), expected, "`{text}`");
    }
}

#[test]
fn no_comment_changes_nothing() {
    let mut out = b"G0".to_vec();
    insert_provenance(&mut out, 0, b"");
    assert_eq!(out, b"G0");
}

/// The control reads the folder from the line behind the name.
#[test]
fn the_path_of_a_sinumerik_program_stays_behind_its_name() {
    let dialect = nc_dialect::builtin("sinumerik").unwrap();
    let text = "%_N_PART_MPF\n;$PATH=/_N_WKS_DIR/_N_PART_WPD\n;(POSTED)\nG0 X1\n";
    let mut out = text.as_bytes().to_vec();
    insert_provenance(&mut out, provenance_position(read(dialect, text)), b";C");
    assert_eq!(
        String::from_utf8(out).unwrap(),
        "%_N_PART_MPF\n;$PATH=/_N_WKS_DIR/_N_PART_WPD\n;C\n;(POSTED)\nG0 X1\n"
    );
    // Without a name above it such a comment is one like any other.
    assert_eq!(provenance_position(read(dialect, ";$PATH=/_N_WKS_DIR\nG0 X1\n")), 0);
}
