//! The one way of every block into the plain program.
//!
//! Flow says which blocks come. Each is asked of what stands for motions (a [`Lower`] of its control: drawings, cycles,
//! names of Siemens), which writes it as it is or what it stands for, and whatever is written is read by the one reader
//! of programs ([`Rewriting`]). What has to look ahead holds the blocks that it waits for.

use nc_dialect::{Action, Dialect};
use nc_program::Setup;
use nc_syntax::{Block, Item, ItemKind, Value};

use crate::came::{Came, Fault, From};
use crate::known::{Lower, Rewriting, Shorthand};
use crate::output::{Marks, Output};
use crate::{called, returns, shorthand, turning};

/// What the rooms write out.
const SHORTHAND: Shorthand = Shorthand { of_block: short, of_item: is_shorthand };

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
        let out = Rewriting::new(dialect, setup, marks, SHORTHAND);
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

/// True where a block has shorthand: of drawings, or a cycle of a lathe.
pub(crate) fn short(block: &Block<'_>, dialect: &Dialect) -> bool {
    shorthand::needed(block, dialect)
        || turning::needed(block, dialect)
        || called::needed(block, dialect)
        || returns::needed(block, dialect)
}

/// True for what is written out later, and what is asked for before it is: corners, polar words, calls by name, cycles
/// of lathes.
fn is_shorthand(block: &Block<'_>, item: &Item, dialect: &Dialect) -> bool {
    match item.kind {
        ItemKind::CommaWord { .. } => dialect.flow.corner_words,
        ItemKind::BracketCommand => {
            let row = dialect.command(block.text(item.span));
            matches!(row.and_then(|row| row.action.as_ref()), Some(Action::Called(_)))
        }
        ItemKind::Word { letter: b'G', value: Value::Number(number) } => {
            matches!(shorthand::action(number, dialect), Some(Action::PolarOn | Action::Turning(_)))
        }
        ItemKind::Word { letter, value: Value::Expression } => {
            called::is_dimension(letter, block.text(item.span))
        }
        _ => false,
    }
}
