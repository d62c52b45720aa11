//! A dialect, a way to write edits as text, and a program run through the emitter.

use nc_dialect::{Dialect, PointFree};
use nc_emit::{Emitter, Piece, WordEdit};
use nc_syntax::{Block, GCode, Reader};

/// LinuxCNC's table (calculator-type numbers) with what these tests are about switched on.
pub(crate) fn dialect() -> Dialect {
    let mut dialect = nc_dialect::builtin("linuxcnc").expect("shipped").clone();
    dialect.marks.colon = nc_syntax::Colon::Number;
    dialect.marks.equals_words = true;
    dialect.initial = vec![GCode(0), GCode(210)];
    dialect.output.max_block_bytes = 0;
    dialect.output.number_inserted_blocks = true;
    dialect.output.max_block_number = 99_999;
    dialect
}

/// The same control with conventional numbers: `X100` is 0.1 mm.
pub(crate) fn least_increment() -> Dialect {
    let mut dialect = dialect();
    dialect.numbers.point_free = PointFree::LeastIncrement;
    dialect
}

/// Blocks of a text.
pub(crate) fn read<'t>(dialect: &'t Dialect, text: &'t str) -> Vec<Block<'t>> {
    let mut reader = Reader::new(text.as_bytes(), dialect);
    let mut blocks = Vec::new();
    let mut block = Block::default();
    while reader.next(&mut block) {
        blocks.push(block.clone());
    }
    blocks
}

/// `"G1 X10.012 Y- F="`: motion, words with three decimals or as many as given, removed (`-`), kept (`=`).
pub(crate) fn piece(text: &str) -> Piece {
    let mut motion = None;
    let mut words = Vec::new();
    for word in text.split_whitespace() {
        let (letter, value) = (word.as_bytes()[0], &word[1..]);
        match (letter, value) {
            (b'G', _) => motion = Some(GCode(value.parse::<u16>().expect("a code") * 10)),
            (_, "-") => words.push((letter, WordEdit::Remove)),
            (_, "=") => words.push((letter, WordEdit::Keep)),
            _ => {
                let decimals = value.split_once('.').map_or(0, |(_, part)| part.len() as u8);
                let counts = value.replace('.', "").parse().expect("a number");
                words.push((letter, WordEdit::Write { counts, decimals }));
            }
        }
    }
    Piece { motion, words: words.into() }
}

/// The text after passing every block but the last and rewriting that one.
pub(crate) fn rewritten(dialect: &Dialect, text: &str, pieces: &[&str]) -> String {
    let blocks = read(dialect, text);
    let mut numbers = nc_emit::BlockNumbers::new();
    blocks.iter().for_each(|block| _ = numbers.see(block));
    let mut emitter = Emitter::new(dialect).with_numbers(&numbers);
    let mut out = Vec::new();
    let (last, before) = blocks.split_last().expect("a block");
    before.iter().for_each(|block| emitter.pass(block, &mut out));
    assert_eq!(out, text.as_bytes()[..last.offset as usize], "passed blocks are copied");
    out.clear();
    let pieces: Vec<Piece> = pieces.iter().map(|text| piece(text)).collect();
    emitter.rewrite(last, &pieces, &mut out).expect("rewritten");
    String::from_utf8(out).expect("text")
}
