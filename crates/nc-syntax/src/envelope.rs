//! Where the program starts and ends between its `%` marks.

use memchr::{memchr_iter, memchr2};

use crate::lexer::{Lexer, is_blank, skip_blanks};
use crate::{Item, ItemKind};

/// What surrounds the program in its file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Envelope {
    /// Bytes before the `%` that opens the program: a leader, not executed. 0 where no `%` opens it.
    pub(crate) leader: usize,
    /// From here on (just behind the `%` that closes the program) nothing is executed.
    pub(crate) trailer: usize,
}

impl Envelope {
    /// Finds the `%` marks: first on their line, blanks aside.
    ///
    /// The first one opens the program unless blocks stand before it. The last one closes it, unless it is
    /// the one that opened it. Marks between the two are left for the reader to show.
    pub(crate) fn find(text: &[u8], lexer: &Lexer<'_>) -> Self {
        let mut marks = memchr_iter(b'%', text).filter(|at| first_on_line(text, *at));
        let Some(first) = marks.next() else {
            return Self { leader: 0, trailer: text.len() };
        };
        let opens = !holds_blocks(&text[..first], lexer);
        let last = marks.next_back();
        let closing = if opens { last } else { Some(last.unwrap_or(first)) };
        Self { leader: if opens { first } else { 0 }, trailer: closing.map_or(text.len(), |at| at + 1) }
    }
}

fn first_on_line(text: &[u8], at: usize) -> bool {
    let before = text[..at].iter().rposition(|byte| !is_blank(*byte));
    before.is_none_or(|before| {
        matches!(text[before], b'\n' | b'\r') || text[..=before] == *crate::reader::BYTE_ORDER_MARK
    })
}

/// True where some line reads as a block: words a program has and nothing that cannot be read.
fn holds_blocks(text: &[u8], lexer: &Lexer<'_>) -> bool {
    let mut items: Vec<Item> = Vec::new();
    let mut at = skip_blanks(text, 0);
    if text[at..].starts_with(crate::reader::BYTE_ORDER_MARK) {
        at += crate::reader::BYTE_ORDER_MARK.len();
    }
    while at < text.len() {
        let end = memchr2(b'\n', b'\r', &text[at..]).map_or(text.len(), |length| at + length);
        let line = &text[at..end.min(at + crate::MAX_BLOCK_BYTES)];
        items.clear();
        lexer.block(line, 0, false, &mut items);
        let words = items
            .iter()
            .any(|item| matches!(item.kind, ItemKind::Word { letter, .. } if b"GMXYZFSTN".contains(&letter)));
        if words && !items.iter().any(|item| matches!(item.kind, ItemKind::Invalid(_))) {
            return true;
        }
        at = end + 1;
    }
    false
}
