//! What the one reader of programs knows behind the text written so far.
//!
//! Whoever writes a block anew has to know where the tool stands and what is in force. This room keeps no state of its
//! own for that: what it writes is read by [`Interpreter`], as it will be read once more when it is corrected, and what
//! that does not know for certain nobody here knows.

use nc_dialect::Dialect;
use nc_program::modal::{Modal, MotionMode};
use nc_program::{Interpreter, Owner, Setup};
use nc_syntax::{Block, Item};

use crate::came::{Came, Fault, From, Refused};
use crate::output::{Marks, Output, PlainPart};

/// What is written out: the rooms that do it know, and stand above this one.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shorthand {
    /// A block has some.
    pub(crate) of_block: fn(&Block<'_>, &Dialect) -> bool,
    /// An item of a block is some, or is asked for before it is written out.
    pub(crate) of_item: fn(&Block<'_>, &Item, &Dialect) -> bool,
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

impl Shorthand {
    /// Reads a block with blanks in place of its shorthand.
    fn plainly(self, block: &Block<'_>, dialect: &Dialect, mut read: impl FnMut(&Block<'_>)) {
        let mut text: Option<Vec<u8>> = None;
        for item in block.items.iter().filter(|item| (self.of_item)(block, item, dialect)) {
            let bytes = text.get_or_insert_with(|| block.bytes.to_vec());
            bytes[item.span.start as usize..item.span.end as usize].fill(b' ');
        }
        match text {
            None => read(block),
            Some(text) => {
                Came::all(&text, dialect, From::of(block)).for_each(|came| read(&came.block));
            }
        }
    }
}

/// The motion code in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    Rapid,
    Line,
    Arc,
    Cycle,
    None,
}

/// Which it is.
pub(crate) const fn motion(modal: &Modal) -> Motion {
    match modal.motion {
        _ if modal.cycle.is_some() => Motion::Cycle,
        MotionMode::Rapid(_) => Motion::Rapid,
        MotionMode::Line(_) | MotionMode::Thread(_) => Motion::Line,
        MotionMode::Arc(..) | MotionMode::Curve(..) => Motion::Arc,
        MotionMode::None | MotionMode::Undecided { .. } => Motion::None,
    }
}

/// Reads what is written, block by block.
#[derive(Clone, Debug)]
pub(crate) struct Known<'d> {
    dialect: &'d Dialect,
    shorthand: Shorthand,
    interpreter: Interpreter<'d>,
    /// Why the interpreter refused a block first.
    refused: Option<Fault>,
}

impl<'d> Known<'d> {
    fn new(dialect: &'d Dialect, setup: &'d Setup, shorthand: Shorthand) -> Self {
        Self { dialect, shorthand, interpreter: Interpreter::new(dialect, setup), refused: None }
    }

    pub(crate) const fn modal(&self) -> &Modal {
        self.interpreter.modal()
    }

    /// Why a block was refused that was read: the program will be refused for it.
    pub(crate) fn refused(&self) -> Option<Fault> {
        self.refused.clone()
    }

    /// The state that the codes of a block make before it moves, and whose its axis words are; `None` where it is
    /// refused.
    pub(crate) fn codes(&self, block: &Block<'_>) -> Option<(Modal, Owner)> {
        let mut settings = None;
        self.shorthand.plainly(block, self.dialect, |block| settings = self.interpreter.settings(block).ok());
        settings
    }

    /// What codes make of the state; `None` where they are refused.
    pub(crate) fn settings(&self, codes: &[u8], from: From) -> Option<Modal> {
        let mut made = Some(self.modal().clone());
        for came in Came::all(codes, self.dialect, From { exact: false, ..from }) {
            made = self.interpreter.settings(&came.block).ok().map(|(modal, _)| modal);
        }
        made
    }

    /// Reads a block that is written as it stands.
    pub(crate) fn block(&mut self, came: &Came<'_>) {
        let Came { block, from } = came;
        self.shorthand.plainly(block, self.dialect, |plain| {
            let refused = self.interpreter.step(plain).err().filter(|_| self.refused.is_none());
            let Some(mut diagnostic) = refused.and_then(|refused| refused.into_iter().next()) else { return };
            let within = |at: u64| at.saturating_sub(plain.offset);
            diagnostic.span = diagnostic.span.map(|span| from.place(within(span.start)..within(span.end)));
            self.refused = Some(Box::new(Refused { diagnostic, file: from.file }));
        });
    }

    /// Reads text that stands for bytes of the source.
    pub(crate) fn written(&mut self, text: &[u8], from: From) {
        for came in Came::all(text, self.dialect, From { exact: false, ..from }) {
            self.block(&came);
        }
    }
}

/// A text on its way out, read as it is written once somebody asks.
#[derive(Debug)]
pub(crate) struct Rewriting<'d> {
    pub(crate) dialect: &'d Dialect,
    pub(crate) marks: Marks,
    out: Output,
    pub(crate) known: Known<'d>,
    /// What is known counts: before, nothing was asked.
    awake: bool,
}

impl<'d> Rewriting<'d> {
    pub(crate) fn new(dialect: &'d Dialect, setup: &'d Setup, marks: Marks, shorthand: Shorthand) -> Self {
        let known = Known::new(dialect, setup, shorthand);
        Self { dialect, marks, out: Output::new(marks), known, awake: false }
    }

    /// Another text from here on, of which the same is known.
    pub(crate) fn ahead(&self) -> Self {
        Self { out: Output::new(self.marks), known: self.known.clone(), ..*self }
    }

    /// Reads what is written so far, and from here on whatever is.
    pub(crate) fn wake(&mut self) {
        if std::mem::replace(&mut self.awake, true) {
            return;
        }
        self.out.each_block(self.dialect, |came| self.known.block(came));
    }

    /// True from the first block on that stands for others.
    pub(crate) fn wakes(&mut self, block: &Block<'_>) -> bool {
        if !self.awake && (self.known.shorthand.of_block)(block, self.dialect) {
            self.wake();
        }
        self.awake
    }

    /// A block as it is.
    pub(crate) fn block(&mut self, came: &Came<'_>) {
        self.out.copy(came.block.bytes, came.from);
        if self.awake {
            self.known.block(came);
        }
    }

    /// Bytes that stand for a stretch of the source.
    pub(crate) fn write(&mut self, bytes: &[u8], from: From) {
        self.wake();
        self.out.write(bytes, from);
        self.known.written(bytes, from);
    }

    /// A line of its own that stands for a stretch of the source.
    pub(crate) fn line(&mut self, bytes: &[u8], from: From) {
        self.wake();
        self.out.line(bytes, from);
        self.known.written(bytes, from);
    }

    /// The same for a block that says no more itself, once what is written out is taken from it.
    pub(crate) fn line_of(&mut self, bytes: &[u8], came: &Came<'_>) {
        self.wake();
        self.out.line(bytes, came.from);
        self.known.block(came);
    }

    /// A comment on a line of its own.
    pub(crate) fn comment(&mut self, bytes: &[u8], from: From) {
        self.out.comment(bytes, from);
    }

    /// Starts a new line unless one was just started.
    pub(crate) fn fresh_line(&mut self) {
        self.out.fresh_line();
    }

    /// Takes what is written, if those are whole lines.
    pub(crate) fn take(&mut self) -> PlainPart {
        self.out.take()
    }

    /// The text and where each stretch of it comes from. Where the program is refused for a block before the `fault`,
    /// it is for that one: what is not known behind it would be blamed on its followers.
    pub(crate) fn end(self, fault: Option<Fault>) -> Result<Output, Fault> {
        match fault {
            None => Ok(self.out),
            Some(fault) => Err(self.known.refused.unwrap_or(fault)),
        }
    }
}
