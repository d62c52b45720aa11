//! The flat text, and where each byte of it comes from.

use std::ops::Range;

use nc_dialect::Dialect;
use nc_syntax::{Block, Paren, Reader, Semicolon, line_ending, line_ends};
use units::decimal::{self, Spelling};

use crate::came::{Came, From, Origin, within_line};

/// A stretch of the flat text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    /// Where it starts.
    pub(crate) flat: u64,
    /// Line of the flat text, from 1.
    pub(crate) flat_line: u32,
    pub(crate) from: From,
}

/// How lines are ended and comments written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Marks {
    pub(crate) line_ending: &'static [u8],
    open: &'static [u8],
    close: &'static [u8],
    longest: usize,
}

impl Marks {
    pub(crate) fn of(dialect: &Dialect, source: &[u8]) -> Self {
        let (open, close): (&[u8], &[u8]) = if matches!(dialect.marks.paren, Paren::Comment { .. }) {
            (b"(", b")")
        } else if dialect.marks.semicolon == Semicolon::Comment {
            (b"; ", b"")
        } else {
            (b"", b"")
        };
        let longest = dialect.output.max_block_bytes as usize;
        Self { line_ending: line_ending(source), open, close, longest }
    }

    /// A comment on a line of its own; `None` where the dialect has no comments.
    ///
    /// Marks that would end it, or start something in some control, are replaced.
    pub(crate) fn comment(&self, bytes: &[u8]) -> Option<Vec<u8>> {
        let start = bytes.iter().position(|byte| *byte > b' ').unwrap_or(bytes.len());
        let bytes = bytes[start..].trim_ascii_end();
        if self.open.is_empty() || bytes.is_empty() {
            return None;
        }
        let around = self.open.len() + self.close.len();
        let room = if self.longest == 0 { usize::MAX } else { self.longest - around };
        let shown = bytes.iter().take(room).map(|byte| match byte {
            b'(' | b'{' => b'[',
            b')' | b'}' => b']',
            b'%' | b':' | b';' => b'-',
            byte if *byte < b' ' || *byte == 0x7F => b' ',
            byte => *byte,
        });
        Some([self.open, &shown.collect::<Vec<u8>>(), self.close, self.line_ending].concat())
    }
}

/// Whole lines of the flat text, and where they come from.
#[derive(Debug, Default)]
pub struct PlainPart {
    text: Vec<u8>,
    segments: Vec<Segment>,
    /// Bytes of the flat text before them.
    offset: u64,
    /// Line ends up to their end.
    lines: u32,
}

impl PlainPart {
    /// Their bytes.
    #[must_use]
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    /// Where bytes of the flat text that start in it come from.
    #[must_use]
    pub fn origin(&self, span: &Range<u64>) -> Option<Range<u64>> {
        let within = self.offset..self.offset + self.text.len() as u64;
        within.contains(&span.start).then(|| origin(&self.segments, span).span)
    }

    /// The line that a line of the flat text in it comes from.
    #[must_use]
    pub fn source_line(&self, line: u64) -> Option<u64> {
        let first = u64::from(self.segments.first()?.flat_line);
        let within = first..=u64::from(self.lines);
        within.contains(&line).then(|| source_line(&self.segments, line).1)
    }
}

/// Writes the flat text.
#[derive(Debug)]
pub(crate) struct Output {
    pub(crate) text: Vec<u8>,
    pub(crate) segments: Vec<Segment>,
    marks: Marks,
    /// Bytes that were taken from it.
    taken: u64,
    /// Line ends written.
    lines: u32,
}

impl Output {
    pub(crate) const fn new(marks: Marks) -> Self {
        Self { text: Vec::new(), segments: Vec::new(), marks, taken: 0, lines: 0 }
    }

    fn segment(&mut self, from: From) {
        let flat = self.taken + self.text.len() as u64;
        if let Some(Segment { flat: start, from: last, .. }) = self.segments.last_mut()
            && (from.exact && last.exact && last.file == from.file)
            && last.offset + (flat - *start) == from.offset
            && last.offset + last.length == from.offset
        {
            last.length += from.length;
            return;
        }
        self.segments.push(Segment { flat, flat_line: self.lines + 1, from });
    }

    /// Bytes as they come.
    pub(crate) fn copy(&mut self, bytes: &[u8], from: From) {
        self.segment(from);
        self.push(bytes);
    }

    /// Bytes that stand for a stretch of the source.
    pub(crate) fn write(&mut self, bytes: &[u8], from: From) {
        self.segment(From { exact: false, ..from });
        self.push(bytes);
    }

    /// Starts a new line unless one was just started.
    pub(crate) fn fresh_line(&mut self) {
        if within_line(&self.text) {
            self.push(self.marks.line_ending);
        }
    }

    /// A line of its own that stands for a stretch of the source.
    pub(crate) fn line(&mut self, bytes: &[u8], from: From) {
        self.fresh_line();
        self.segment(From { exact: false, ..from });
        self.push(bytes);
        self.push(self.marks.line_ending);
    }

    /// Takes what is written, if those are whole lines.
    pub(crate) fn take(&mut self) -> PlainPart {
        if within_line(&self.text) { PlainPart::default() } else { self.take_all() }
    }

    /// Takes what is written.
    pub(crate) fn take_all(&mut self) -> PlainPart {
        let (text, segments) = (std::mem::take(&mut self.text), std::mem::take(&mut self.segments));
        let offset = self.taken;
        self.taken += text.len() as u64;
        PlainPart { lines: self.lines + u32::from(within_line(&text)), text, segments, offset }
    }

    fn push(&mut self, bytes: &[u8]) {
        self.lines = self.lines.saturating_add(u32::try_from(line_ends(bytes)).unwrap_or(u32::MAX));
        self.text.extend_from_slice(bytes);
    }

    /// A comment on a line of its own. Nothing where the dialect has no comments.
    pub(crate) fn comment(&mut self, bytes: &[u8], from: From) {
        if let Some(comment) = self.marks.comment(bytes) {
            self.fresh_line();
            self.write(&comment, from);
        }
    }
}

impl Output {
    /// Its blocks, each with whom it stands for.
    pub(crate) fn each_block(&self, dialect: &Dialect, mut take: impl FnMut(&Came<'_>)) {
        let (mut reader, mut block) = (Reader::new(&self.text, dialect), Block::default());
        while reader.next(&mut block) {
            let end = block.offset + block.bytes.len() as u64;
            let Some(segment) = before(&self.segments, |segment| segment.flat <= block.offset) else {
                continue;
            };
            let span = segment.place(&(block.offset..end));
            let from = From {
                offset: span.start,
                length: span.end - span.start,
                line: segment.line_of(block.line),
                ..segment.from
            };
            let came = Came { block, from };
            take(&came);
            block = came.block;
        }
    }
}

impl Segment {
    /// Where bytes of it come from.
    fn place(&self, span: &Range<u64>) -> Range<u64> {
        self.from.place(span.start - self.flat..span.end.saturating_sub(self.flat))
    }

    /// The line that one of its lines comes from.
    fn line_of(&self, line: u64) -> u32 {
        let below = line.saturating_sub(u64::from(self.flat_line));
        let below = if self.from.exact { u32::try_from(below).unwrap_or(u32::MAX) } else { 0 };
        self.from.line.saturating_add(below)
    }
}

fn before(segments: &[Segment], key: impl Fn(&Segment) -> bool) -> Option<&Segment> {
    segments.partition_point(key).checked_sub(1).and_then(|at| segments.get(at))
}

/// Where bytes of the flat text come from.
pub(crate) fn origin(segments: &[Segment], span: &Range<u64>) -> Origin {
    let segment = before(segments, |segment| segment.flat <= span.start);
    segment.map_or(Origin { file: 0, span: 0..0 }, |segment| Origin {
        file: usize::from(segment.from.file),
        span: segment.place(span),
    })
}

/// File and line that a line of the flat text comes from.
pub(crate) fn source_line(segments: &[Segment], line: u64) -> (usize, u64) {
    let segment = before(segments, |segment| u64::from(segment.flat_line) <= line);
    segment.map_or((0, line), |segment| (usize::from(segment.from.file), u64::from(segment.line_of(line))))
}

/// How the number of a word is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Style {
    /// A whole number without a point.
    Whole,
    /// With a point and this many decimals at most.
    Decimals(u8),
}

/// Writes a letter with its number; `None` where the value has no such form.
pub(crate) fn word(out: &mut Vec<u8>, letter: u8, value: f64, style: Style) -> Option<()> {
    out.push(letter);
    match style {
        Style::Whole => {
            let counts = decimal::counts(value, 1.0)?;
            decimal::write(out, counts, 0, Spelling { trailing_point: false, ..Spelling::FIXED });
        }
        Style::Decimals(decimals) => {
            let steps = f64::from(10_u32.pow(u32::from(decimals.min(9))));
            // 15 digits are what a reader of programs takes.
            let counts =
                decimal::counts(value, steps).filter(|counts| counts.abs() < 1_000_000_000_000_000)?;
            decimal::write(out, counts, decimals, Spelling { trailing_zeros: false, ..Spelling::FIXED });
        }
    }
    Some(())
}
