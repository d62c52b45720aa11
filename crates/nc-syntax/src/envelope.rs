//! Where the program starts and ends between its `%` marks.

use memchr::{memchr_iter, memchr2};

use crate::lexer::{Lexer, is_blank, skip_blanks};
use crate::{Item, ItemKind, Spells};

/// UTF-8's mark at the start of a file; not text.
pub(crate) const BYTE_ORDER_MARK: &[u8] = b"\xEF\xBB\xBF";

/// What surrounds the program in its file.
///
/// ```
/// use nc_syntax::EnvelopeFinder;
///
/// let marks = nc_syntax::Marks::default();
/// let mut finder = EnvelopeFinder::new(&marks);
/// finder.see(b"PART 7\n%\nG0 X1.\n%\nnotes\n");
/// let envelope = finder.finish();
/// // The leader is not executed, the program is, what stands behind it is not.
/// assert_eq!([0, 9, 18].map(|offset| envelope.holds(offset)), [false, true, false]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Envelope {
    /// Bytes before the `%` that opens the program: a leader, not executed. 0 where no `%` opens it.
    pub(crate) leader: u64,
    /// From here on (just behind the `%` that closes the program) nothing is executed.
    pub(crate) trailer: u64,
}

impl Envelope {
    /// True where a block that starts so many bytes into the file is one of the program.
    #[must_use]
    pub const fn holds(&self, offset: u64) -> bool {
        self.leader <= offset && offset < self.trailer
    }
}

/// Finds the `%` marks of a program that is read part by part: first on their line, blanks aside.
///
/// The first one opens the program unless blocks stand before it. The last one closes it, unless it is
/// the one that opened it, or blocks stand behind it: somebody may execute those. Marks between the two are left for
/// the reader to show.
///
/// ```
/// use nc_syntax::EnvelopeFinder;
///
/// let marks = nc_syntax::Marks::default();
/// let mut finder = EnvelopeFinder::new(&marks);
/// finder.see(b"%\nG0 X1.\n%\n");
/// // While parts are to come the second mark may be one between blocks.
/// assert!(finder.open().holds(12));
/// assert!(!finder.finish().holds(12));
/// ```
pub struct EnvelopeFinder<'d> {
    lexer: Lexer<'d>,
    length: u64,
    first: Option<u64>,
    last: Option<u64>,
    /// Blocks stand before the first mark.
    blocks_before: bool,
    /// Blocks stand behind the mark that would close the program.
    blocks_behind: bool,
}

impl<'d> EnvelopeFinder<'d> {
    /// Nothing read yet.
    #[must_use]
    pub fn new(language: &'d dyn Spells) -> Self {
        Self {
            lexer: Lexer::new(language),
            length: 0,
            first: None,
            last: None,
            blocks_before: false,
            blocks_behind: false,
        }
    }

    /// The next part of the program, which ends at the end of a line or of the program.
    pub fn see(&mut self, mut part: &[u8]) {
        if self.length == 0 && part.starts_with(BYTE_ORDER_MARK) {
            part = &part[BYTE_ORDER_MARK.len()..];
            self.length = BYTE_ORDER_MARK.len() as u64;
        }
        let mut marks = memchr_iter(b'%', part).filter(|at| first_on_line(part, *at));
        if self.first.is_none() {
            let first = marks.next();
            let before = &part[..first.unwrap_or(part.len())];
            self.blocks_before = self.blocks_before || holds_blocks(before, &self.lexer);
            self.first = first.map(|at| self.length + at as u64);
        }
        self.last = marks.next_back().map(|at| self.length + at as u64).or(self.last);
        self.see_behind(part);
        self.length += part.len() as u64;
    }

    /// Looks for blocks behind the mark that would close the program.
    fn see_behind(&mut self, part: &[u8]) {
        let Some(mark) = self.closing() else { return };
        // What stands beside a mark is a name.
        let behind = match mark.checked_sub(self.length) {
            Some(at) => {
                self.blocks_behind = false;
                let at = at as usize;
                memchr2(b'\n', b'\r', &part[at..]).map_or(&part[part.len()..], |length| &part[at + length..])
            }
            None => part,
        };
        self.blocks_behind = self.blocks_behind || holds_blocks(behind, &self.lexer);
    }

    const fn opening(&self) -> Option<u64> {
        if self.blocks_before { None } else { self.first }
    }

    fn closing(&self) -> Option<u64> {
        self.last.or(self.first.filter(|_| self.blocks_before))
    }

    /// What is known while further parts are to come: nothing closes the program yet.
    #[must_use]
    pub fn open(&self) -> Envelope {
        Envelope { trailer: u64::MAX, ..self.finish() }
    }

    /// What was found, once all parts were seen.
    #[must_use]
    pub fn finish(&self) -> Envelope {
        let closing = self.closing().filter(|_| !self.blocks_behind);
        Envelope { leader: self.opening().unwrap_or(0), trailer: closing.map_or(self.length, |at| at + 1) }
    }
}

fn first_on_line(text: &[u8], at: usize) -> bool {
    let before = text[..at].iter().rposition(|byte| !is_blank(*byte));
    before.is_none_or(|before| matches!(text[before], b'\n' | b'\r'))
}

/// True where some line reads as a block: words a program has and nothing that cannot be read.
fn holds_blocks(text: &[u8], lexer: &Lexer<'_>) -> bool {
    let mut items: Vec<Item> = Vec::new();
    let mut at = skip_blanks(text, 0);
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
