//! The shipped programs in their dialects: nothing asked, nothing changed; and a look at what is written.

use crate::common;

use common::{piece, rewritten};
use nc_dialect::Dialect;
use nc_emit::{Emitter, Piece, WordEdit, insert_provenance, provenance_position};
use nc_syntax::{Block, Reader};

const SAMPLES: &[(&str, &[u8])] = &[
    ("linuxcnc", include_bytes!("../../../samples/plate_linuxcnc.nc")),
    ("centroid", include_bytes!("../../../samples/plate_centroid.nc")),
    ("fanuc", include_bytes!("../../../samples/plate_fanuc.nc")),
    ("fanuc", include_bytes!("../../../samples/dome_fanuc.nc")),
    ("fanuc", include_bytes!("../../../samples/bolt_circle_fanuc.nc")),
    ("fanuc", include_bytes!("../../../samples/contour_incremental_fanuc.nc")),
    ("fanuc", include_bytes!("../../../samples/bracket_inch_fanuc.nc")),
    ("perspektiva", include_bytes!("../../../samples/pocket_perspektiva.nc")),
    ("linuxcnc", include_bytes!("../../../samples/helix_linuxcnc.ngc")),
    ("linuxcnc", include_bytes!("../../../samples/arcs_in_planes_linuxcnc.ngc")),
    ("linuxcnc", include_bytes!("../../../samples/inverse_time_linuxcnc.ngc")),
];

fn shipped(name: &str) -> &'static Dialect {
    nc_dialect::builtin(name).expect("shipped")
}

/// Runs every block through `write`.
fn emitted(
    dialect: &Dialect,
    text: &[u8],
    mut write: impl FnMut(&mut Emitter<'_>, &Block<'_>, &mut Vec<u8>),
) -> Vec<u8> {
    let (mut emitter, mut out) = (Emitter::new(dialect), Vec::new());
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    while reader.next(&mut block) {
        write(&mut emitter, &block, &mut out);
    }
    out
}

#[test]
fn kept_programs_come_out_byte_for_byte() {
    for (name, text) in SAMPLES {
        let dialect = shipped(name);
        assert!(
            emitted(dialect, text, |emitter, block, out| emitter.pass(block, out)) == *text,
            "{name}: passed"
        );
        let kept = emitted(dialect, text, |emitter, block, out| {
            let mut ahead = emitter.clone();
            ahead.pass(block, &mut Vec::new());
            let words = block.words().map(|word| word.letter).filter(|letter| b"XYZIJKRF".contains(letter));
            let words = words.map(|letter| (letter, WordEdit::Keep)).collect();
            emitter.rewrite(block, &[Piece { motion: ahead.motion(), words }], out).expect("kept");
        });
        assert!(kept == *text, "{name}: kept");
    }
}

#[test]
fn the_comment_goes_below_the_name() {
    for (at, expected) in [
        (0, "(C)\n(Exported by FreeCAD)\n"),
        (1, "(C)\n;Exported by FreeCAD\n"),
        (3, "%\n;\ndome_fanuc.nc (FREECAD-FILENAME-GOES-HERE, JOB-NAME-GOES-HERE)\n(C)\n(DOME_FANUC.NC,"),
        (4, "%\nO2107 (FLANGE 6 X M8 ON 80)\n(C)\nN10 G21"),
        (7, "%\r\n(C)\r\nN1 G21 "),
    ] {
        let (name, text) = SAMPLES[at];
        let dialect = shipped(name);
        let (mut reader, mut block, mut blocks) = (Reader::new(text, dialect), Block::default(), Vec::new());
        while reader.next(&mut block) {
            blocks.push(block.clone());
        }
        let mut out = text.to_vec();
        insert_provenance(&mut out, provenance_position(&blocks), b"(C)");
        assert_eq!(String::from_utf8_lossy(&out[..expected.len()]), expected);
        assert_eq!(out.len(), text.len() + if name == "perspektiva" { 5 } else { 4 });
    }
}

#[test]
fn a_fanuc_cycle_hides_the_motion_code_until_it_ends() {
    let fanuc = shipped("fanuc");
    let cycle = "G1 X0.\nG81 X1. Z-2. R2.\n";
    assert_eq!(rewritten(fanuc, &format!("{cycle}X5.\n"), &["G81 X5.01"]), "X5.01\n");
    assert_eq!(rewritten(fanuc, &format!("{cycle}G80\nX5.\n"), &["G1 X5.01"]), "X5.01\n");
    assert_eq!(rewritten(fanuc, &format!("{cycle}G80 X5.\n"), &["G1 X5.01"]), "G80 X5.01\n");
    assert_eq!(rewritten(fanuc, &format!("{cycle}G80 X5.\n"), &["G0 X5.01"]), "G0 G80 X5.01\n");
    assert_eq!(rewritten(fanuc, &format!("{cycle}X5.\n"), &["G1 X5.01"]), "G1 X5.01\n");
    assert_eq!(
        rewritten(fanuc, "G81 X1. Z-2. R2.\n", &["G0 X1.01 Z- R-", "G1 Z-2.0", "G0 Z2.0"]),
        "G0 X1.01\nG1 Z-2.\nG0 Z2.\n"
    );
}

#[test]
fn a_cycle_written_as_moves_may_dwell() {
    let mut dwell = piece("P0.5");
    dwell.words.push((b'G', WordEdit::Write { counts: 4, decimals: 0 }));
    let pieces = [piece("G0 Z- R- P-"), piece("G1 Z-2.0"), dwell, piece("G0 Z2.0")];
    let out = emitted(shipped("linuxcnc"), b"G98 G82 X1. Z-2. R2. P0.5 (c)\n", |emitter, block, out| {
        emitter.rewrite(block, &pieces, out).expect("rewritten");
    });
    assert_eq!(String::from_utf8_lossy(&out), "G98 G0 X1. (c)\nG1 Z-2.\nG4 P0.5\nG0 Z2.\n");
}

#[test]
fn an_earlier_error_leaves_the_output_alone() {
    let fanuc = shipped("fanuc");
    let mut out = b"before".to_vec();
    let block = Block { bytes: b"G1 X1.\n", ..Block::default() };
    assert!(Emitter::new(fanuc).rewrite(&block, &[], &mut out).is_err());
    assert!(Emitter::new(fanuc).rewrite(&block, &[piece("G1 X5.0"), piece("G1 Y=")], &mut out).is_err());
    assert_eq!(out, b"before");
}
