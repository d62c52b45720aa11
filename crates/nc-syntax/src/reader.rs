//! Bytes to blocks.

use memchr::{memchr_iter, memchr2, memchr3, memrchr2};

use crate::envelope::{BYTE_ORDER_MARK, Envelope, EnvelopeFinder};
use crate::lexer::{Lexer, skip_blanks, trim_end};
use crate::{Block, Invalid, Item, ItemKind, MAX_BLOCK_BYTES, PlainLine, Span, Spells};

/// Reads a program block by block.
///
/// A block is a line with its end (LF, CRLF, CR or `\r\r\n`), or in dialects where `;` ends a block, the part
/// of a line up to and with the `;`; blanks behind the last `;` of a line and the line's end belong to the
/// block before them. Put together, the blocks' bytes are the file's bytes, whatever they are.
///
/// Before the `%` that opens the program and behind the `%` that closes it every line is a
/// [`ItemKind::Name`]: text that nobody executes. A file with one `%` above its blocks, or with none, is
/// a program as a whole. A `%` between the first and the last is shown where it stands, and so is the last one where
/// blocks stand behind it.
///
/// ```
/// use nc_syntax::{Block, Reader};
///
/// let text = b"%\nO1 (PART)\r\nN10 G1 X10. \xc7 F300\n\n%\n(left over)";
/// let dialect = &nc_syntax::Marks::default();
/// let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
/// let (mut again, mut lines) = (Vec::new(), Vec::new());
/// while reader.next(&mut block) {
///     again.extend_from_slice(block.bytes);
///     lines.push(block.line);
/// }
/// // Every byte comes out as it went in, whatever it is.
/// assert_eq!(again, text);
/// assert_eq!(lines, [1, 2, 3, 4, 5, 6]);
/// ```
pub struct Reader<'a> {
    text: &'a [u8],
    lexer: Lexer<'a>,
    envelope: Envelope,
    at: usize,
    /// Bytes of the program before the text.
    before: u64,
    line: u64,
    /// End of the line `at` is on: without and with its line end.
    line_end: (usize, usize),
    /// True between a `%` without a name beside it and the first thing that is executed or is a name.
    name_line: bool,
}

/// Where a part of a program starts.
///
/// ```
/// use nc_syntax::{Block, EnvelopeFinder, Place, Reader};
///
/// // The second half of a program, read alone, has the places of the whole.
/// let (first, second) = (b"G21\nG0 X1.\n", b"G1 X2. F100\n");
/// let dialect = &nc_syntax::Marks::default();
/// let mut finder = EnvelopeFinder::new(dialect);
/// finder.see(first);
/// finder.see(second);
/// let place = Place { offset: first.len() as u64, line: 3, ..Place::START };
/// let mut block = Block::default();
/// assert!(Reader::part(second, dialect, finder.finish(), place).next(&mut block));
/// assert_eq!((block.offset, block.line), (11, 3));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// Bytes of the program before it.
    pub offset: u64,
    /// Its first line, from 1.
    pub line: u64,
    /// The next line may be the program's name: [`Reader::expects_name`] where the part before it ended.
    pub expects_name: bool,
}

impl Place {
    /// The start of a program.
    pub const START: Self = Self { offset: 0, line: 1, expects_name: false };
}

impl<'a> Reader<'a> {
    /// A reader at the start of `text`.
    #[must_use]
    pub fn new(text: &'a [u8], language: &'a dyn Spells) -> Self {
        let mut finder = EnvelopeFinder::new(language);
        finder.see(text);
        Self::part(text, language, finder.finish(), Place::START)
    }

    /// A reader of a part of a program: `text` starts at the start of a line and ends at the end of one.
    ///
    /// Parts read one after the other give the blocks of the whole, `envelope` being that of the whole.
    #[must_use]
    pub fn part(text: &'a [u8], language: &'a dyn Spells, envelope: Envelope, place: Place) -> Self {
        Self {
            text,
            lexer: Lexer::new(language),
            envelope,
            at: 0,
            before: place.offset,
            line: place.line,
            line_end: (0, 0),
            name_line: place.expects_name,
        }
    }

    /// What the part after this one needs to know ([`Place::expects_name`]).
    #[must_use]
    pub const fn expects_name(&self) -> bool {
        self.name_line
    }

    /// Replaces `block` by the next block; false at the end of the text, where `block` is left empty.
    ///
    /// Nothing is allocated once `block.items` has grown to the longest block.
    pub fn next(&mut self, block: &mut Block<'a>) -> bool {
        block.items.clear();
        block.offset = self.before + self.at as u64;
        block.line = self.line;
        if self.at >= self.text.len() {
            block.bytes = &[];
            return false;
        }
        if self.at >= self.line_end.1 {
            self.line_end = line_end(self.text, self.at);
        }
        let start = self.at;
        let (content_end, next_line) = self.line_end;
        let line = &self.text[start..content_end];
        let end = self.items(line, &mut block.items);
        // What follows a `;` on its line is a block of its own unless it is blank.
        let end = start + end;
        self.at = if skip_blanks(&self.text[..content_end], end) == content_end { next_line } else { end };
        if self.at == next_line {
            self.line += 1;
        }
        block.bytes = &self.text[start..self.at];
        true
    }

    /// Reads the next block where it is a plain line, quicker than [`Reader::next`]; false, with nothing read, where it
    /// is none or where only a closer look would tell.
    #[inline]
    pub fn plain_line(&mut self, line: &mut PlainLine<'a>) -> bool {
        let offset = self.before + self.at as u64;
        // Whole lines of the program, none that may be its name.
        if self.at < self.line_end.1 || self.name_line || !self.envelope.holds(offset) {
            return false;
        }
        if !self.lexer.plain_line(&self.text[self.at..], line) {
            return false;
        }
        (line.offset, line.line) = (offset, self.line);
        self.at += line.bytes.len();
        self.line += 1;
        true
    }

    /// Goes on to the next line in which `letter` stands, in whatever case and place, or to the end: the lines left out
    /// have no word of it. Goes no further than to a line with a `%`, and nowhere where the next line may be the
    /// program's name or the rest of a line is yet to be read.
    pub fn skip_lines_without(&mut self, letter: u8) {
        if self.at < self.line_end.1 || self.name_line {
            return;
        }
        let rest = &self.text[self.at..];
        let found = memchr3(letter.to_ascii_uppercase(), letter.to_ascii_lowercase(), b'%', rest);
        let start = memrchr2(b'\n', b'\r', &rest[..found.unwrap_or(rest.len())]).map_or(0, |end| end + 1);
        self.line += line_ends(&rest[..start]);
        self.at += start;
    }

    /// Goes back to the start of a plain line, the last one read.
    pub fn unread(&mut self, line: &PlainLine<'a>) {
        self.at = (line.offset - self.before) as usize;
        self.line = line.line;
    }

    /// A plain line as the block that it is.
    pub fn block_of(&self, line: &PlainLine<'a>, block: &mut Block<'a>) {
        block.items.clear();
        (block.bytes, block.offset, block.line) = (line.bytes, line.offset, line.line);
        self.lexer.block(line.content(), 0, false, &mut block.items);
    }

    /// Reads the items of the rest of a line; returns how much of it the block takes.
    fn items(&mut self, line: &[u8], items: &mut Vec<Item>) -> usize {
        let offset = self.before + self.at as u64;
        let in_leader = offset + (line.len() as u64) < self.envelope.leader;
        if in_leader || offset >= self.envelope.trailer {
            let start = skip_blanks(line, if offset == 0 { mark_length(line) } else { 0 });
            let end = trim_end(line);
            if start < end {
                let kind = if line.len() > MAX_BLOCK_BYTES {
                    ItemKind::Invalid(Invalid::TooLong)
                } else {
                    ItemKind::Name
                };
                items.push(Item { kind, span: clamped(start, end) });
            }
            return line.len();
        }
        let start = if offset == 0 { mark_length(line) } else { 0 };
        if (offset == 0 || self.name_line) && self.lexer.file_name(line, start, items) {
            self.name_line = false;
            return line.len();
        }
        let window = &line[..line.len().min(MAX_BLOCK_BYTES)];
        let end = self.lexer.block(window, start, self.name_line, items);
        if end == window.len() && window.len() < line.len() {
            items.clear();
            items.push(Item { kind: ItemKind::Invalid(Invalid::TooLong), span: clamped(0, line.len()) });
            return line.len();
        }
        match items.first().map(|item| item.kind) {
            None | Some(ItemKind::Comment) => {}
            Some(ItemKind::Percent) => self.name_line = !items.iter().any(|item| item.kind == ItemKind::Name),
            Some(_) => self.name_line = false,
        }
        end
    }
}

/// Length of a byte order mark with blanks before it (NUL padding), else 0.
fn mark_length(line: &[u8]) -> usize {
    let at = skip_blanks(line, 0);
    if line[at..].starts_with(BYTE_ORDER_MARK) { at + BYTE_ORDER_MARK.len() } else { 0 }
}

/// End of the line that starts at `at`: without and with its line end.
fn line_end(text: &[u8], at: usize) -> (usize, usize) {
    let Some(length) = memchr2(b'\n', b'\r', &text[at..]) else {
        return (text.len(), text.len());
    };
    let end = at + length;
    let marks = match &text[end..] {
        [b'\r', b'\r', b'\n', ..] => 3,
        [b'\r', b'\n', ..] => 2,
        _ => 1,
    };
    (end, end + marks)
}

/// The line ending a text uses, by its first: `\n`, `\r\n`, `\r`, `\r\r\n`; `\n` where it has none.
#[must_use]
pub fn line_ending(text: &[u8]) -> &'static [u8] {
    let Some(first) = memchr2(b'\n', b'\r', text) else { return b"\n" };
    match text[first..] {
        [b'\r', b'\r', b'\n', ..] => b"\r\r\n",
        [b'\r', b'\n', ..] => b"\r\n",
        [b'\r', ..] => b"\r",
        _ => b"\n",
    }
}

/// How many line ends stand in whole lines: LF, CR LF, CR CR LF, CR.
#[must_use]
pub fn line_ends(text: &[u8]) -> u64 {
    let feeds = memchr_iter(b'\n', text).count() as u64;
    let alone = |at: &usize| !matches!(text[at + 1..], [b'\n', ..] | [b'\r', b'\n', ..]);
    feeds + memchr_iter(b'\r', text).filter(alone).count() as u64
}

/// A span of a line that may be longer than a span can say.
fn clamped(start: usize, end: usize) -> Span {
    Span { start: u32::try_from(start).unwrap_or(u32::MAX), end: u32::try_from(end).unwrap_or(u32::MAX) }
}
