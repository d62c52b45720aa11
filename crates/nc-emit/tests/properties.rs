//! Whatever is asked for is what the text says afterwards, and nothing else has changed.

use crate::common;

use common::{dialect, least_increment, read};
use nc_dialect::{Dialect, PointFree};
use nc_emit::{Emitter, Piece, WordEdit};
use nc_syntax::{Block, GCode, ItemKind, Value};
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::{select, subsequence};

/// A number as text, in many spellings.
fn number() -> impl Strategy<Value = String> {
    (
        select(&["", "-", "+"][..]),
        0u32..2000,
        select(&["", ".", ".5", ".25", ".123", ".000", ".100", ".1234"][..]),
        any::<bool>(),
    )
        .prop_map(|(sign, whole, part, short)| {
            let whole = if short && whole == 0 && part.len() > 1 { String::new() } else { whole.to_string() };
            format!("{sign}{whole}{part}")
        })
}

/// A motion block: `(text, letters of its words)`.
fn block() -> impl Strategy<Value = String> {
    let coordinates = subsequence(b"XYZIJKR".to_vec(), 0..=5);
    (
        select(&["", "N10", "/N10", "/", "n7"][..]),
        select(&["", "G1", "G02", "G90 G0", "G03"][..]),
        coordinates.prop_flat_map(|letters| {
            let count = letters.len();
            (Just(letters), vec(number(), count))
        }),
        select(&["", "F100", "M8", "F200. M9"][..]),
        select(&["", " (c X1)", "; X5"][..]),
        select(&["", " ", "\t"][..]),
        select(&["\n", "\r\n", "", "\r\r\n", " \n"][..]),
    )
        .prop_map(|(head, codes, (letters, numbers), tail, comment, separator, end)| {
            let mut words = vec![head.to_owned(), codes.to_owned()];
            words.extend(
                letters.iter().zip(&numbers).map(|(letter, number)| format!("{}{number}", *letter as char)),
            );
            words.push(tail.to_owned());
            words.retain(|word| !word.is_empty());
            words.join(separator) + comment + end
        })
}

fn edits() -> impl Strategy<Value = Vec<(u8, WordEdit)>> {
    let edit = prop_oneof![
        4 => (-2_000_000_i64..2_000_000, 0u8..=4).prop_map(|(counts, decimals)| WordEdit::Write { counts, decimals }),
        1 => Just(WordEdit::Remove),
    ];
    (subsequence(b"XYZIJKRF".to_vec(), 0..=6), vec(edit, 8))
        .prop_map(|(letters, edits)| letters.into_iter().zip(edits).collect())
}

/// Value of a word in steps of 1e-9, as the dialect reads it (millimetres).
fn value(dialect: &Dialect, letter: u8, value: Value) -> i128 {
    let Value::Number(number) = value else { panic!("no number") };
    let least =
        dialect.numbers.point_free == PointFree::LeastIncrement && !number.has_point && letter != b'F';
    let decimals = if least { 3 } else { number.decimal.decimals };
    i128::from(number.decimal.mantissa) * 10_i128.pow(9 - u32::from(decimals))
}

fn words<'b>(block: &'b Block<'_>) -> impl Iterator<Item = (u8, Value, &'b [u8])> {
    block.items.iter().filter_map(|item| match item.kind {
        ItemKind::Word { letter, value } => Some((letter, value, block.text(item.span))),
        _ => None,
    })
}

fn find(dialect: &Dialect, block: &Block<'_>, letter: u8) -> Option<i128> {
    words(block).find(|(other, ..)| *other == letter).map(|(_, found, _)| value(dialect, letter, found))
}

fn check_asked(dialect: &Dialect, block: &Block<'_>, asked: &[(u8, WordEdit)]) -> Result<(), TestCaseError> {
    for &(letter, edit) in asked {
        let expected = match edit {
            WordEdit::Write { counts, decimals } => {
                Some(i128::from(counts) * 10_i128.pow(9 - u32::from(decimals)))
            }
            _ => None,
        };
        prop_assert_eq!(find(dialect, block, letter), expected, "{}", letter as char);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn the_words_asked_for_are_there(before in block(), text in block(), asked in edits(), conventional: bool,
                                     motion in select(&[0u16, 10, 20, 30][..])) {
        let dialect = if conventional { least_increment() } else { dialect() };
        let mut emitter = Emitter::new(&dialect);
        let (original, habit) = (read(&dialect, &text), read(&dialect, &before));
        prop_assume!(!original.is_empty());
        let original = &original[0];
        let mut out = Vec::new();
        habit.iter().for_each(|block| emitter.pass(block, &mut out));
        let in_force = emitter.motion();
        out.clear();
        let piece = Piece { motion: Some(GCode(motion)), words: asked.clone().into() };
        emitter.rewrite(original, &[piece], &mut out).unwrap();

        let text = String::from_utf8(out).unwrap();
        let result = read(&dialect, &text);
        prop_assert_eq!(result.len(), 1, "{:?}", text);
        let result = &result[0];
        check_asked(&dialect, result, &asked)?;
        prop_assert_eq!(emitter.motion(), Some(GCode(motion)));
        let own = words(result).any(|(letter, found, _)| letter == b'G' && value(&dialect, b'F', found) == i128::from(motion) * 100_000_000);
        prop_assert!(own || in_force == Some(GCode(motion)), "{:?}", text);

        // Everything that was not asked for is there in its order, byte for byte.
        let untouched = |block: &Block<'_>| -> Vec<Vec<u8>> {
            block.items.iter().filter(|item| match item.kind {
                ItemKind::Word { letter: b'G', value: found } => value(&dialect, b'F', found) >= 4_000_000_000,
                ItemKind::Word { letter, .. } => !asked.iter().any(|(other, _)| *other == letter),
                _ => true,
            }).map(|item| block.text(item.span).to_vec()).collect()
        };
        prop_assert_eq!(untouched(original), untouched(result), "{:?}", text);
        // Coordinates keep the canonical order where the block had it, and the comment stays behind them.
        let places: Vec<_> = words(result).filter_map(|(letter, ..)| b"XYZIJKR".iter().position(|known| *known == letter)).collect();
        prop_assert!(places.is_sorted(), "{:?}", text);
        if let Some(comment) = result.items.iter().position(|item| item.kind == ItemKind::Comment) {
            prop_assert_eq!(comment, result.items.len() - 1);
        }
    }

    #[test]
    fn nothing_asked_nothing_changed(text in block()) {
        let dialect = dialect();
        for block in &read(&dialect, &text) {
            let mut passed = Vec::new();
            let mut emitter = Emitter::new(&dialect);
            emitter.pass(block, &mut passed);
            let motion = emitter.motion();
            let keep = words(block).filter(|(letter, ..)| b"XYZIJKRF".contains(letter)).map(|(letter, ..)| (letter, WordEdit::Keep));
            let piece = Piece { motion, words: keep.collect() };
            let mut out = Vec::new();
            Emitter::new(&dialect).rewrite(block, &[piece], &mut out).unwrap();
            prop_assert_eq!(&out, block.bytes);
            prop_assert_eq!(&passed, block.bytes);
        }
    }

    #[test]
    fn every_piece_says_what_it_was_asked(text in block(), asked in vec((edits(), select(&[0u16, 10, 20, 30][..])), 1..5),
                                          conventional: bool) {
        let dialect = if conventional { least_increment() } else { dialect() };
        let original = read(&dialect, &text);
        prop_assume!(!original.is_empty());
        let original = &original[0];
        let pieces: Vec<Piece> = asked.iter().map(|(words, motion)| Piece { motion: Some(GCode(*motion)), words: words.clone().into() }).collect();
        let mut out = Vec::new();
        Emitter::new(&dialect).rewrite(original, &pieces, &mut out).unwrap();
        let text = String::from_utf8(out).unwrap();
        let mut motion = GCode(0);
        let mut lines = read(&dialect, &text).into_iter();
        for (words_asked, motion_asked) in &asked {
            // A piece that writes nothing is an empty line, which is no block at the end of the text.
            let Some(block) = lines.next() else {
                let writes = words_asked.iter().any(|(_, edit)| matches!(edit, WordEdit::Write { .. }));
                prop_assert!(!writes);
                break;
            };
            check_asked(&dialect, &block, words_asked)?;
            for item in &block.items {
                if let ItemKind::Word { letter: b'G', value: found } = item.kind
                    && let code = value(&dialect, b'F', found) / 100_000_000
                    && code < 40
                {
                    motion = GCode(code as u16);
                }
            }
            prop_assert_eq!(motion, GCode(*motion_asked), "{:?}", text);
        }
        prop_assert!(lines.next().is_none(), "{:?}", text);
    }
}
