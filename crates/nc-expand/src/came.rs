//! A block that comes, and whom it stands for.

use std::ops::Range;

use diagnostic::Diagnostic;
use nc_dialect::Dialect;
use nc_syntax::{Block, EnvelopeFinder, Item, Place, Reader};

/// A place in a source file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// 0: the program itself; n: [`crate::Expanded::file`] n.
    pub file: usize,
    /// Bytes of that file.
    pub span: Range<u64>,
}

/// Where a stretch comes from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct From {
    pub(crate) file: u16,
    pub(crate) offset: u64,
    pub(crate) length: u64,
    pub(crate) line: u32,
    /// Byte for byte the same: else it stands for all of the stretch.
    pub(crate) exact: bool,
    /// It is a block of a cycle's contour.
    pub(crate) contour: bool,
    /// N of the source, where the block is reached again, or called, and has lost it.
    pub(crate) number: Option<u32>,
    /// So many values had been assigned before it was read.
    pub(crate) assigned: u32,
}

impl From {
    /// A block of the program itself.
    pub(crate) fn of(block: &Block<'_>) -> Self {
        Self {
            file: 0,
            offset: block.offset,
            length: block.bytes.len() as u64,
            line: u32::try_from(block.line).unwrap_or(u32::MAX),
            exact: true,
            contour: false,
            number: None,
            assigned: 0,
        }
    }

    /// Where bytes that stand at `within` of what comes from here are of the source.
    pub(crate) fn place(&self, within: Range<u64>) -> Range<u64> {
        let end = self.offset + self.length;
        if !self.exact {
            return self.offset..end;
        }
        let shift = |at: u64| (self.offset + at).min(end);
        shift(within.start)..shift(within.end.max(within.start))
    }
}

/// A block that cannot be written, in a file of the source.
#[derive(Clone, Debug)]
pub(crate) struct Refused {
    pub(crate) diagnostic: Diagnostic,
    pub(crate) file: u16,
}

pub(crate) type Fault = Box<Refused>;

/// A block that comes, and whom it stands for.
#[derive(Clone, Debug)]
pub(crate) struct Came<'a> {
    pub(crate) block: Block<'a>,
    pub(crate) from: From,
}

impl<'a> Came<'a> {
    pub(crate) fn new(bytes: &'a [u8], items: Vec<Item>, from: From) -> Self {
        Self { block: Block { bytes, items, offset: from.offset, line: u64::from(from.line) }, from }
    }

    /// The blocks of text that stands for something, none of them a program's name.
    pub(crate) fn all(text: &'a [u8], dialect: &'a Dialect, from: From) -> impl Iterator<Item = Self> {
        let starts = from.exact && from.offset == 0;
        let place = Place { offset: u64::from(!starts), ..Place::START };
        let mut reader = Reader::part(text, dialect, EnvelopeFinder::new(dialect).open(), place);
        let mut block = Block::default();
        std::iter::from_fn(move || {
            reader.next(&mut block).then(|| Self::new(block.bytes, std::mem::take(&mut block.items), from))
        })
    }
}

/// A block that waits for those behind it.
#[derive(Clone, Debug)]
pub(crate) struct Held {
    bytes: Vec<u8>,
    items: Vec<Item>,
    pub(crate) from: From,
}

impl Held {
    pub(crate) fn of(came: &Came<'_>) -> Self {
        Self { bytes: came.block.bytes.to_vec(), items: came.block.items.clone(), from: came.from }
    }

    pub(crate) fn came(&self) -> Came<'_> {
        Came::new(&self.bytes, self.items.clone(), self.from)
    }

    /// The block, for once.
    pub(crate) fn taken(&mut self) -> Came<'_> {
        Came::new(&self.bytes, std::mem::take(&mut self.items), self.from)
    }

    /// Ends its line, where that has no end.
    pub(crate) fn end_line(&mut self, line_ending: &[u8]) {
        if within_line(&self.bytes) {
            self.bytes.extend_from_slice(line_ending);
        }
    }
}

/// True where text does not stand at the start of a line.
pub(crate) fn within_line(text: &[u8]) -> bool {
    text.last().is_some_and(|byte| !matches!(byte, b'\n' | b'\r'))
}
