//! The flat text, and where each byte of it comes from.

use std::ops::Range;

use nc_syntax::dialect::{Paren, Semicolon};
use nc_syntax::{Dialect, line_ending, line_ends};
use units::decimal::{self, Spelling};

use crate::Origin;

/// A stretch of the flat text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Segment {
    /// Where it starts.
    pub(crate) flat: u64,
    /// Where it comes from.
    pub(crate) source: u64,
    /// Bytes of the source.
    pub(crate) length: u64,
    pub(crate) line: u32,
    /// Line of the flat text, from 1.
    pub(crate) flat_line: u32,
    pub(crate) file: u16,
    /// Byte for byte the same.
    pub(crate) exact: bool,
}

/// A text that one step has written.
#[derive(Debug)]
pub(crate) struct Written {
    pub(crate) text: Vec<u8>,
    /// Where each stretch of it comes from.
    pub(crate) segments: Vec<Segment>,
    #[cfg(test)]
    pub(crate) beliefs: Vec<crate::agreement::Belief>,
}

/// Where a stretch comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct From {
    pub(crate) file: u16,
    pub(crate) offset: u64,
    pub(crate) length: u64,
    pub(crate) line: u32,
}

/// Writes the flat text.
#[derive(Debug)]
pub(crate) struct Output {
    pub(crate) text: Vec<u8>,
    pub(crate) segments: Vec<Segment>,
    line_ending: &'static [u8],
    open: &'static [u8],
    close: &'static [u8],
    longest: usize,
    /// Line ends written.
    lines: u32,
}

impl Output {
    pub(crate) fn new(dialect: &Dialect, source: &[u8]) -> Self {
        let (open, close): (&[u8], &[u8]) = if matches!(dialect.paren, Paren::Comment { .. }) {
            (b"(", b")")
        } else if dialect.semicolon == Semicolon::Comment {
            (b"; ", b"")
        } else {
            (b"", b"")
        };
        Self {
            text: Vec::with_capacity(source.len() + 256),
            segments: Vec::new(),
            line_ending: line_ending(source),
            open,
            close,
            longest: dialect.output.max_block_bytes as usize,
            lines: 0,
        }
    }

    fn segment(&mut self, from: From, exact: bool) {
        let flat = self.text.len() as u64;
        if let Some(last) = self.segments.last_mut() {
            let follows = last.source + (flat - last.flat) == from.offset;
            if exact
                && last.exact
                && last.file == from.file
                && follows
                && last.source + last.length == from.offset
            {
                last.length += from.length;
                return;
            }
        }
        let From { file, offset, length, line } = from;
        let flat_line = self.lines + 1;
        self.segments.push(Segment { flat, source: offset, length, line, flat_line, file, exact });
    }

    /// Bytes as they are.
    pub(crate) fn copy(&mut self, bytes: &[u8], from: From) {
        self.segment(from, true);
        self.push(bytes);
    }

    /// Bytes that stand for a stretch of the source.
    pub(crate) fn write(&mut self, bytes: &[u8], from: From) {
        self.segment(from, false);
        self.push(bytes);
    }

    /// Starts a new line unless one was just started.
    pub(crate) fn fresh_line(&mut self) {
        if self.text.last().is_some_and(|byte| !matches!(byte, b'\n' | b'\r')) {
            self.push(self.line_ending);
        }
    }

    /// A line of its own that stands for a stretch of the source.
    pub(crate) fn line(&mut self, bytes: &[u8], from: From) {
        self.fresh_line();
        self.segment(from, false);
        self.push(bytes);
        self.push(self.line_ending);
    }

    fn push(&mut self, bytes: &[u8]) {
        self.lines = self.lines.saturating_add(u32::try_from(line_ends(bytes)).unwrap_or(u32::MAX));
        self.text.extend_from_slice(bytes);
    }

    /// A comment on a line of its own. Nothing where the dialect has no comments.
    ///
    /// Marks that would end it, or start something in some control, are replaced.
    pub(crate) fn comment(&mut self, bytes: &[u8], from: From) {
        if self.open.is_empty() {
            return;
        }
        let start = bytes.iter().position(|byte| *byte > b' ').unwrap_or(bytes.len());
        let bytes = bytes[start..].trim_ascii_end();
        if bytes.is_empty() {
            return;
        }
        self.fresh_line();
        self.segment(from, false);
        self.text.extend_from_slice(self.open);
        let room =
            if self.longest == 0 { usize::MAX } else { self.longest - self.open.len() - self.close.len() };
        self.text.extend(bytes.iter().take(room).map(|byte| match byte {
            b'(' | b'{' => b'[',
            b')' | b'}' => b']',
            b'%' | b':' | b';' => b'-',
            byte if *byte < b' ' || *byte == 0x7F => b' ',
            byte => *byte,
        }));
        self.text.extend_from_slice(self.close);
        self.push(self.line_ending);
    }
}

fn before(segments: &[Segment], key: impl Fn(&Segment) -> bool) -> Option<&Segment> {
    segments.partition_point(key).checked_sub(1).and_then(|at| segments.get(at))
}

/// Where bytes of the flat text come from.
pub(crate) fn origin(segments: &[Segment], span: &Range<u64>) -> Origin {
    let Some(segment) = before(segments, |segment| segment.flat <= span.start) else {
        return Origin { file: 0, span: 0..0 };
    };
    let end = segment.source + segment.length;
    let span = if segment.exact {
        let shift = |at: u64| (segment.source + (at - segment.flat)).min(end);
        shift(span.start)..shift(span.end.max(span.start))
    } else {
        segment.source..end
    };
    Origin { file: usize::from(segment.file), span }
}

/// File and line that a line of the flat text comes from.
pub(crate) fn source_line(segments: &[Segment], line: u64) -> (usize, u64) {
    match before(segments, |segment| u64::from(segment.flat_line) <= line) {
        Some(segment) if segment.exact => {
            let below = line.saturating_sub(u64::from(segment.flat_line));
            (usize::from(segment.file), u64::from(segment.line) + below)
        }
        Some(segment) => (usize::from(segment.file), u64::from(segment.line)),
        None => (0, line),
    }
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
