//! The one comment that says a program was corrected.

use std::borrow::Borrow;
use std::ops::Range;

use nc_dialect::Dialect;
use nc_syntax::{Block, ItemKind, Paren, Semicolon, line_ending};

use crate::ascii;

/// What the comment begins with, and what is looked for, in any case.
const MARKER: &[u8] = b"CORRECTED BY VPOST";

/// The comment that marks a program as corrected: `(CORRECTED BY VPOST text)` or `; CORRECTED …`.
///
/// Upper case without brackets, `%`, `:` or anything beyond ASCII, which some controls take for the end
/// of the comment, the start of a program or an alarm: letters of other alphabets as [`ascii()`] spells them; cut at the dialect's longest block. Empty where
/// the dialect has no comments. No line end.
#[must_use]
pub fn provenance_comment(dialect: &Dialect, text: &str) -> Vec<u8> {
    let (open, close): (&[u8], &[u8]) = if matches!(dialect.marks.paren, Paren::Comment { .. }) {
        (b"(", b")")
    } else if dialect.marks.semicolon == Semicolon::Comment {
        (b"; ", b"")
    } else {
        return Vec::new();
    };
    let mut comment = [open, MARKER].concat();
    if !text.is_empty() {
        comment.push(b' ');
    }
    comment.extend(ascii(text).chars().map(|character| match character {
        '(' | '[' | '{' => b'[',
        ')' | ']' | '}' => b']',
        '%' | ':' | ';' => b'-',
        ' '..='~' => character.to_ascii_uppercase() as u8,
        // A tab, the end of a line.
        _ => b'_',
    }));
    let limit = dialect.output.max_block_bytes as usize;
    if limit > 0 {
        comment.truncate(limit.max(open.len() + MARKER.len() + close.len()) - close.len());
    }
    comment.extend_from_slice(close);
    comment
}

/// The comment of an earlier correction: its bytes from the mark that opens it to the end of its line.
#[must_use]
pub fn find_provenance(text: &[u8]) -> Option<Range<u64>> {
    let name = MARKER.len() - b"VPOST".len();
    memchr::memchr2_iter(b'V', b'v', text).find_map(|at| {
        let from = at.checked_sub(name)?;
        let marker = text.get(from..from + MARKER.len())?;
        if !marker.eq_ignore_ascii_case(MARKER) {
            return None;
        }
        let line =
            text[..from].iter().rposition(|byte| matches!(byte, b'\n' | b'\r')).map_or(0, |end| end + 1);
        let open = line + text[line..from].iter().rposition(|byte| matches!(byte, b'(' | b';'))?;
        let end = text[from..]
            .iter()
            .position(|byte| matches!(byte, b'\n' | b'\r'))
            .map_or(text.len(), |end| from + end);
        Some(open as u64..end as u64)
    })
}

/// Where the comment goes: bytes of the file before it.
///
/// After the first `%`, a leader before it, the program's name and its `O` or `:` word, where these
/// open the program, and after what a control reads in comments behind its `%` (`;$PATH=/_N_WKS_DIR`); before
/// everything else.
#[must_use]
pub fn provenance_position<'t>(blocks: impl IntoIterator<Item = impl Borrow<Block<'t>>>) -> u64 {
    let mut position = 0;
    let mut percent_seen = false;
    for block in blocks {
        let block: &Block<'_> = block.borrow();
        let mut opens = false;
        // A block that moves may be rewritten, whatever it opens with.
        let moves = |item: &nc_syntax::Item| matches!(item.kind, ItemKind::Word { letter, .. } if b"XYZABCUVWIJKR".contains(&letter));
        if block.items.iter().any(moves) {
            return position;
        }
        for item in &block.items {
            match item.kind {
                ItemKind::Percent if percent_seen => return position,
                ItemKind::Percent => {
                    percent_seen = true;
                    opens = true;
                }
                ItemKind::Name => opens = true,
                ItemKind::Word { letter: b'O' | b':', .. } => opens = true,
                ItemKind::Comment => {
                    opens |= percent_seen && block.text(item.span).starts_with(b";$");
                }
                _ => {
                    if !opens {
                        return position;
                    }
                }
            }
        }
        if opens {
            position = block.offset + block.bytes.len() as u64;
        }
    }
    position
}

/// Puts the comment on a line of its own at `position` (of [`provenance_position`]), with the text's line
/// ending; nothing where `comment` is empty.
pub fn insert_provenance(text: &mut Vec<u8>, position: u64, comment: &[u8]) {
    let (at, line) = provenance_line(text, position, comment);
    text.splice(at..at, line);
}

/// Where [`insert_provenance`] puts which bytes; `opening` is the text, or its beginning as far as the first line end
/// behind the position.
#[must_use]
pub fn provenance_line(opening: &[u8], position: u64, comment: &[u8]) -> (usize, Vec<u8>) {
    let end = line_ending(opening);
    let at = usize::try_from(position).unwrap_or(opening.len()).min(opening.len());
    // Padding and a byte order mark stay the first thing in the file.
    let padding = opening[at..]
        .iter()
        .take_while(|byte| at == 0 && matches!(byte, 0 | 0x7F | 0xEF | 0xBB | 0xBF))
        .count();
    let at = at + padding;
    let mut line = Vec::with_capacity(comment.len() + 2 * end.len());
    if !comment.is_empty() {
        if at > padding && !matches!(opening[at - 1], b'\n' | b'\r') {
            line.extend_from_slice(end);
        }
        line.extend_from_slice(comment);
        line.extend_from_slice(end);
    }
    (at, line)
}
