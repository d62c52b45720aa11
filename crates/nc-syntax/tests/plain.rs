//! The plain line, read the quick way.

use crate::common;

use proptest::prelude::*;

use common::conventional;
use nc_syntax::{Block, ItemKind, Marks, PlainLine, PlainWord, Reader, Sign, Value};

/// What is read as a plain line is what the reader shows as a block.
fn agrees(text: &str, marks: &Marks) -> usize {
    let mut quick = Reader::new(text.as_bytes(), marks);
    let mut slow = Reader::new(text.as_bytes(), marks);
    let (mut line, mut block, mut again, mut plain) =
        (PlainLine::default(), Block::default(), Block::default(), 0);
    while slow.next(&mut block) {
        if quick.plain_line(&mut line) {
            plain += 1;
            assert_eq!(
                (line.bytes, line.offset, line.line),
                (block.bytes, block.offset, block.line),
                "{text:?}"
            );
            let words: Vec<_> = line
                .words()
                .iter()
                .map(|word| {
                    (
                        ItemKind::Word { letter: word.letter(), value: Value::Number(word.number()) },
                        word.span(),
                    )
                })
                .collect();
            let mut items: Vec<_> = block.items.iter().map(|item| (item.kind, item.span)).collect();
            items.pop_if(|(kind, _)| *kind == ItemKind::Comment);
            assert_eq!(words, items, "{text:?}");
            assert!(line.words().iter().all(|word| word.number_span().start == word.span().start + 1));
            assert!(line.words().iter().all(|word| {
                let number = word.number();
                let usual = number.has_point && number.leading_digit && number.sign != Sign::Plus;
                usual == (word.form() == PlainWord::usual_form(number.decimal.decimals))
            }));
            assert_eq!([line.content(), line.end()].concat(), line.bytes);
            quick.block_of(&line, &mut again);
            assert_eq!(again, block);
            // Back and again.
            quick.unread(&line);
            assert!(quick.next(&mut again));
        } else {
            assert!(quick.next(&mut again));
        }
        assert_eq!(again, block, "{text:?}");
        assert_eq!(quick.expects_name(), slow.expects_name());
    }
    plain
}

/// The blocks with an N word, `skip`ping what has none.
fn numbered<'t>(text: &'t str, marks: &'t Marks, skip: bool) -> Vec<Block<'t>> {
    let mut reader = Reader::new(text.as_bytes(), marks);
    let (mut block, mut found) = (Block::default(), Vec::new());
    loop {
        if skip {
            reader.skip_lines_without(b'N');
        }
        if !reader.next(&mut block) {
            return found;
        }
        if block.word(b'N').is_some() {
            found.push(block.clone());
        }
    }
}

#[test]
fn lines_without_a_letter_are_skipped_and_counted() {
    let (text, marks) = ("%\nNAME\nX1\r\nX2\rX3\r\r\nn5 X4\nX5\n(ON)\nX6;N7\n%\nEND N8\n", conventional());
    let found = numbered(text, &marks, true);
    assert_eq!(found.iter().map(|block| block.line).collect::<Vec<_>>(), [6, 9]);
    let mut reader = Reader::new(b"X1\nX2\nX3 (N)\n", &marks);
    let mut block = Block::default();
    reader.skip_lines_without(b'N');
    assert!(reader.next(&mut block));
    assert_eq!((block.offset, block.line), (6, 3));
}

#[test]
fn plain_lines_are_found_and_others_are_not() {
    let count = |text: &str| agrees(text, &conventional());
    assert_eq!(count("X1. Y-2.5 Z.3\nN10 G1 x+1 y2 F100\r\nY5\n"), 3);
    assert_eq!(count("X1. (A)\nX1(B) \r\nX1 (B;\nX1 (B) Y1\nX1 (B)(C)\nX1 (B\n"), 2);
    assert_eq!(count("X1. X2.\n(A)\n(B) X1\nM3\nX1 M3\nX[1]\nX=1\nG1 Y1 A5.\n/X1\nX1;\n\n  \nX1.2.3\n"), 0);
    assert_eq!(count("X1"), 0, "no line end: somebody else sees to it");
    assert_eq!(
        count("%\nX1\nX2\n%\nX3\n"),
        1,
        "behind a mark a name may stand, behind the last nothing is executed"
    );
}

proptest! {
    #[test]
    fn plain_lines_are_what_the_reader_shows(
        text in "((%|X-?[0-9]{0,3}[.]?[0-9]{0,3}|[YZxNFGM][+-]?[0-9.]{1,4}|[ \t(;/,E=]|[(][ab;(]{0,2}[)]|O1|NAME){0,5}[ ]?(\n|\r\n|\r)){0,6}",
        spaces: bool,
    ) {
        let marks = if spaces { Marks::default() } else { conventional() };
        agrees(&text, &marks);
        prop_assert_eq!(numbered(&text, &marks, true), numbered(&text, &marks, false));
    }
}
