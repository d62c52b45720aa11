//! The one way of every block into the plain program.
//!
//! Flow says which blocks come. Each is asked of what stands for motions (a [`Lower`] of its control: drawings, cycles, names
//! of Siemens), which writes it as it is or what it stands for, and whatever is written is read by the one reader of
//! programs ([`Rewriting`]). What has to look ahead holds the blocks that it waits for.

use diagnostic::Diagnostic;
use nc_program::Setup;
use nc_syntax::{Block, Dialect, EnvelopeFinder, Item, ItemKind, Place, Reader};

use crate::known::Rewriting;
use crate::output::{From, Marks, Output, within_line};
use crate::{Refusal, called, returns, short, turning};

/// A block that cannot be written, in a file of the source.
#[derive(Clone, Debug)]
pub(crate) struct Refused {
    pub(crate) diagnostic: Diagnostic,
    pub(crate) file: u16,
}

impl Refused {
    /// The refusal of a program that has called these files.
    pub(crate) fn in_files(self, files: &[(String, Vec<u8>)]) -> Refusal {
        let file = usize::from(self.file).checked_sub(1).and_then(|at| files.get(at)).cloned();
        Refusal { diagnostics: vec![self.diagnostic], file }
    }
}

pub(crate) type Fault = Box<Refused>;

/// A block that comes, and whom it stands for.
#[derive(Clone, Debug)]
pub(crate) struct Came<'a> {
    pub(crate) block: Block<'a>,
    pub(crate) from: From,
}

impl<'a> Came<'a> {
    fn new(bytes: &'a [u8], items: Vec<Item>, from: From) -> Self {
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

/// What writes a control's blocks as plain ones.
pub(crate) trait Lower<'d>: Send {
    /// The next block.
    fn came(&mut self, came: &Came<'_>) -> Result<(), Fault>;

    /// What comes next stands on a line of its own.
    fn fresh_line(&mut self);

    /// What is written so far; `None` where nothing is before the end.
    fn out(&mut self) -> Option<&mut Rewriting<'d>>;

    /// Nothing more comes: what was written.
    fn end(self: Box<Self>) -> (Rewriting<'d>, Result<(), Fault>);
}

/// Takes what comes of a program.
pub(crate) struct Driver<'d> {
    dialect: &'d Dialect,
    room: Box<dyn Lower<'d> + 'd>,
    marks: Marks,
    /// Bytes that came.
    pub(crate) bytes: u64,
    /// So far the program itself came, byte for byte up to here.
    same_to: Option<u64>,
    /// Some block stands for others.
    lowers: bool,
    runs: bool,
    /// Behind the `%` that closes the program nothing is executed, whatever it would be.
    pub(crate) closed: bool,
    /// Q of the block that came last, where a lathe's cycles have it.
    pub(crate) last_q: Option<i64>,
    /// Flow goes on behind it: what is wrong there is told first.
    fault: Option<Fault>,
}

/// What a program has become.
pub(crate) struct Lowered {
    pub(crate) out: Output,
    pub(crate) lowers: bool,
    /// The program itself came, byte for byte.
    pub(crate) same: bool,
}

impl<'d> Driver<'d> {
    pub(crate) fn new(dialect: &'d Dialect, setup: &'d Setup, source: &[u8]) -> Self {
        let marks = Marks::of(dialect, source);
        let out = Rewriting::new(dialect, setup, marks);
        let room: Box<dyn Lower<'d> + 'd> = if let Some(turning) = &dialect.turning {
            Box::new(turning::Lathe::new(out, turning))
        } else if let Some(rule) = dialect.flow.written_cycles {
            Box::new(returns::Writer::new(out, rule))
        } else {
            Box::new(called::Writer::new(out))
        };
        Self {
            dialect,
            room,
            marks,
            bytes: 0,
            same_to: Some(0),
            lowers: false,
            runs: false,
            closed: false,
            last_q: None,
            fault: None,
        }
    }

    /// A block as it was read.
    pub(crate) fn block(&mut self, came: &Came<'_>) {
        let block = &came.block;
        self.closed |= self.runs && block.items.iter().any(|item| item.kind == ItemKind::Percent);
        self.runs |= block.acts();
        self.lowers = self.lowers || (!self.closed && short(block, self.dialect));
        let From { file, offset, length, exact, .. } = came.from;
        self.same_to = self.same_to.filter(|to| exact && (file, offset) == (0, *to)).map(|to| to + length);
        self.bytes += block.bytes.len() as u64;
        if self.dialect.turning.is_some() {
            self.last_q = block.word(b'Q').and_then(|word| word.number()?.integer());
        }
        if self.fault.is_none() {
            let told = if self.closed {
                self.room.came(&Came::new(block.bytes, Vec::new(), came.from))
            } else {
                self.room.came(came)
            };
            self.fault = told.err();
        }
    }

    /// A block that is not executed.
    pub(crate) fn idle(&mut self, bytes: &[u8], from: From) {
        self.block(&Came::new(bytes, Vec::new(), from));
    }

    /// Text of blocks.
    pub(crate) fn text(&mut self, text: &[u8], from: From) {
        for came in Came::all(text, self.dialect, from) {
            self.block(&came);
        }
    }

    /// Text that stands for something else.
    pub(crate) fn write(&mut self, text: &[u8], from: From) {
        self.text(text, From { exact: false, ..from });
    }

    /// A comment on a line of its own.
    pub(crate) fn comment(&mut self, bytes: &[u8], from: From) {
        if let Some(comment) = self.marks.comment(bytes) {
            self.fresh_line();
            self.idle(&comment, From { exact: false, ..from });
        }
    }

    /// What comes next stands on a line of its own.
    pub(crate) fn fresh_line(&mut self) {
        self.room.fresh_line();
    }

    /// What is written so far; `None` where nothing is before the end.
    pub(crate) fn out(&mut self) -> Option<&mut Rewriting<'d>> {
        self.room.out()
    }

    /// Some block cannot be written.
    pub(crate) const fn failed(&self) -> bool {
        self.fault.is_some()
    }

    /// What became of it; `length`: of the program itself.
    pub(crate) fn end(self, length: u64) -> Result<Lowered, Fault> {
        let (out, ended) = self.room.end();
        let out = out.end(self.fault.or(ended.err()))?;
        Ok(Lowered { out, lowers: self.lowers, same: self.same_to == Some(length) })
    }
}
