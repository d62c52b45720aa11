//! A dialect, a way to write edits as text, and a program run through the emitter.
#![allow(dead_code, reason = "each test file uses a part")]

use nc_emit::{Emitter, Piece, WordEdit};
use nc_syntax::dialect::{
    Action, CodeEntry, CycleCode, CycleLevels, GCode, MCode, Numbers, Output, Paren, PointFree, Semicolon,
};
use nc_syntax::{Block, Dialect, Reader};

/// Codes enough for the tests; calculator-type numbers.
pub(crate) fn dialect() -> Dialect {
    let entry = |tenths, group, action| CodeEntry { code: GCode(tenths), group, action };
    let m_code = |number, after_motion| MCode {
        number,
        after_motion,
        loses_position: [false; 3],
        ends_program: false,
        refuse: None,
    };
    Dialect {
        name: "test".into(),
        title: String::new(),
        assumptions: Vec::new(),
        paren: Paren::Comment { nested: false },
        semicolon: Semicolon::Comment,
        skip: Some(b'/'),
        colon_number: true,
        equals_words: true,
        commands: Vec::new(),
        letters: (b'A'..=b'Z').collect(),
        numbers: Numbers {
            point_free: PointFree::Unit,
            least_increment_decimals_mm: 3,
            least_increment_decimals_inch: 4,
            spaces_inside: false,
        },
        codes: vec![
            entry(0, 1, Action::Rapid),
            entry(10, 1, Action::Line),
            entry(20, 1, Action::ArcClockwise),
            entry(30, 1, Action::ArcCounterClockwise),
            entry(90, 0, Action::Pass { takes_words: false }),
            entry(200, 6, Action::Inch),
            entry(210, 6, Action::Millimetre),
            entry(800, 1, Action::CycleCancel),
            entry(810, 1, Action::Cycle(CycleCode::Drill)),
            entry(900, 3, Action::Absolute),
        ],
        m_codes: vec![m_code(0, true), m_code(5, true), m_code(9, true), m_code(30, true)],
        initial: vec![GCode(0), GCode(210)],
        cycle_levels: CycleLevels::Unstated,
        length_of_loaded_tool: false,
        output: Output {
            decimals_inch: 4,
            decimals_feed: 3,
            max_block_bytes: 0,
            number_inserted_blocks: true,
            max_block_number: 99_999,
            centre_words: true,
            radius_word: true,
            arc_radius_tolerance_mm: 0.002,
            peck_clearance_mm: 0.5,
            chip_retreat_mm: 0.5,
        },
    }
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
    Piece { motion, words }
}

/// The text after passing every block but the last and rewriting that one.
pub(crate) fn rewritten(dialect: &Dialect, text: &str, pieces: &[&str]) -> String {
    let blocks = read(dialect, text);
    let mut numbers = nc_emit::BlockNumbers::new();
    blocks.iter().for_each(|block| numbers.see(block));
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
