//! What the one reader of programs knows behind the text written so far.
//!
//! Whoever writes a block anew has to know where the tool stands and what is in force. This room keeps no state of its own
//! for that: what it writes is read by [`Interpreter`], as it will be read once more when it is corrected, and what that
//! does not know for certain nobody here knows.

use nc_program::modal::{Distance, Modal, MotionMode, Naming, Units};
use nc_program::{Interpreter, Owner, Setup};
use nc_syntax::dialect::{Action, Dialect};
use nc_syntax::{Block, EnvelopeFinder, Item, ItemKind, Place, Reader, Value};

use crate::called;
use crate::output::{From, Output, Written};
use crate::shorthand::{self, Fault, Words, from};

/// The motion code in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    Rapid,
    Line,
    Arc,
    Cycle,
    None,
}

/// What shorthand needs of the state between two blocks; lengths as the words have them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct State {
    pub(crate) motion: Motion,
    /// First and second axis of the plane, and its normal.
    pub(crate) plane: [usize; 3],
    pub(crate) absolute: bool,
    pub(crate) inch: bool,
    /// Where the program has itself said that the axes stand.
    pub(crate) at: [Option<f64>; 3],
}

impl State {
    fn of(modal: &Modal) -> Self {
        Self {
            motion: match modal.motion {
                _ if modal.cycle.is_some() => Motion::Cycle,
                MotionMode::Rapid(_) => Motion::Rapid,
                MotionMode::Line(_) | MotionMode::Thread(_) => Motion::Line,
                MotionMode::Arc(..) | MotionMode::Curve(..) => Motion::Arc,
                MotionMode::None | MotionMode::Undecided { .. } => Motion::None,
            },
            plane: modal.plane.axes(),
            absolute: modal.distance == Distance::Absolute,
            inch: modal.units == Units::Inch,
            at: places(modal),
        }
    }

    /// Where the words of a motion lead from here.
    pub(crate) fn target(&self, words: &Words<'_, '_>) -> [Option<f64>; 3] {
        [0, 1, 2].map(|axis| match words.length(shorthand::AXES[axis], self.inch) {
            None => self.at[axis],
            Some(value) if self.absolute => Some(value),
            Some(value) => self.at[axis].map(|at| at + value),
        })
    }
}

/// Where X, Y and Z stand, as words of the state would say it: those that the program has itself named in the frame in force.
pub(crate) fn places(modal: &Modal) -> [Option<f64>; 3] {
    // Behind a block that may be skipped the tool stands in one of two places.
    let (Some(frame), None) = (&modal.frame, &modal.aside) else { return [None; 3] };
    let stands = modal.axes.linear.map(nc_program::modal::Axis::known);
    let program_mm = frame.to_program(stands.map(Option::unwrap_or_default));
    [0, 1, 2].map(|axis| {
        let known = (0..3).all(|other| frame.inverse()[axis][other] == 0.0 || stands[other].is_some());
        let diameters = axis == 0 && modal.x_words.are_diameters(modal.distance);
        let word = program_mm[axis] / modal.units.mm() * if diameters { 2.0 } else { 1.0 };
        (known && modal.named[axis] == Naming::Named).then_some(word)
    })
}

/// Reads what is written, block by block.
#[derive(Clone, Debug)]
pub(crate) struct Known<'d> {
    dialect: &'d Dialect,
    interpreter: Interpreter<'d>,
    /// Why the interpreter refused a block first, placed in the text that is written anew.
    refused: Option<Fault>,
}

impl<'d> Known<'d> {
    pub(crate) fn new(dialect: &'d Dialect, setup: &'d Setup) -> Self {
        Self { dialect, interpreter: Interpreter::new(dialect, setup), refused: None }
    }

    pub(crate) fn state(&self) -> State {
        State::of(self.modal())
    }

    pub(crate) const fn modal(&self) -> &Modal {
        self.interpreter.modal()
    }

    /// Why a block was refused that was read: the program will be refused for it.
    pub(crate) fn refused(&self) -> Option<Fault> {
        self.refused.clone()
    }

    /// The state that the codes of a block make before it moves, and whose its axis words are; `None` where it is refused.
    pub(crate) fn codes(&self, block: &Block<'_>) -> Option<(State, Owner)> {
        let plain = without_shorthand(block, self.dialect);
        let mut settings = None;
        let mut take = |block: &Block<'_>| settings = self.interpreter.settings(block).ok();
        match &plain {
            None => take(block),
            Some(text) => each(text, self.dialect, take),
        }
        settings.map(|(modal, owner)| (State::of(&modal), owner))
    }

    /// Reads a block of the source that is written as it stands.
    pub(crate) fn block(&mut self, block: &Block<'_>) {
        match without_shorthand(block, self.dialect) {
            None => self.step(block, block.offset, None),
            Some(text) => self.text(&text, block.offset, None),
        }
    }

    /// Reads text that stands for bytes of the source.
    pub(crate) fn written(&mut self, text: &[u8], from: From) {
        self.text(text, from.offset, Some(from.length));
    }

    fn text(&mut self, text: &[u8], offset: u64, length: Option<u64>) {
        let dialect = self.dialect;
        each(text, dialect, |block| match without_shorthand(block, dialect) {
            None => self.step(block, offset, length),
            Some(plain) => each(&plain, dialect, |block| self.step(block, offset, length)),
        });
    }

    /// `length`: the block stands for so many bytes at `offset`; else it is the block there.
    fn step(&mut self, block: &Block<'_>, offset: u64, length: Option<u64>) {
        let Err(diagnostics) = self.interpreter.step(block) else { return };
        if self.refused.is_some() {
            return;
        }
        self.refused = diagnostics.into_iter().next().map(|mut diagnostic| {
            let within = |at: u64| offset + at.saturating_sub(block.offset);
            diagnostic.span = diagnostic.span.map(|span| match length {
                Some(length) => offset..offset + length,
                None => within(span.start)..within(span.end),
            });
            Box::new(diagnostic)
        });
    }
}

/// The blocks of text that was written, none of them a program's name.
fn each(text: &[u8], dialect: &Dialect, mut read: impl FnMut(&Block<'_>)) {
    let place = Place { offset: 1, ..Place::START };
    let mut reader = Reader::part(text, dialect, EnvelopeFinder::new(dialect).open(), place);
    let mut block = Block::default();
    while reader.next(&mut block) {
        read(&block);
    }
}

/// The block with blanks in place of what is written out later, and of what is asked for before it is: corners, polar words,
/// calls by name, cycles of lathes. `None` where it has nothing of the kind.
fn without_shorthand(block: &Block<'_>, dialect: &Dialect) -> Option<Vec<u8>> {
    let mut text: Option<Vec<u8>> = None;
    for item in block.items.iter().filter(|item| is_shorthand(block, item, dialect)) {
        let bytes = text.get_or_insert_with(|| block.bytes.to_vec());
        bytes[item.span.start as usize..item.span.end as usize].fill(b' ');
    }
    text
}

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

/// A text on its way out, read as it is written.
pub(crate) struct Rewriting<'d> {
    out: Output,
    pub(crate) known: Known<'d>,
    #[cfg(test)]
    pub(crate) beliefs: Vec<crate::agreement::Belief>,
}

impl<'d> Rewriting<'d> {
    pub(crate) fn new(dialect: &'d Dialect, setup: &'d Setup, source: &[u8]) -> Self {
        Self {
            out: Output::new(dialect, source),
            known: Known::new(dialect, setup),
            #[cfg(test)]
            beliefs: Vec::new(),
        }
    }

    /// Where the text ends so far.
    #[cfg(test)]
    pub(crate) fn length(&self) -> u64 {
        self.out.text.len() as u64
    }

    /// A block as it is.
    pub(crate) fn block(&mut self, block: &Block<'_>) {
        self.out.copy(block.bytes, from(block));
        self.known.block(block);
    }

    /// A block as it is, which stands for what another step writes.
    pub(crate) fn unread(&mut self, block: &Block<'_>) {
        self.out.copy(block.bytes, from(block));
    }

    /// Bytes that stand for a stretch of the source.
    pub(crate) fn write(&mut self, bytes: &[u8], from: From) {
        self.out.write(bytes, from);
        self.known.written(bytes, from);
    }

    /// A line of its own that stands for a stretch of the source.
    pub(crate) fn line(&mut self, bytes: &[u8], from: From) {
        self.out.line(bytes, from);
        self.known.written(bytes, from);
    }

    /// A comment on a line of its own.
    pub(crate) fn comment(&mut self, bytes: &[u8], from: From) {
        self.out.comment(bytes, from);
    }

    /// Starts a new line unless one was just started.
    pub(crate) fn fresh_line(&mut self) {
        self.out.fresh_line();
    }

    /// The text and where each stretch of it comes from. Where the program is refused for a block before the `fault`, it is
    /// for that one: what is not known behind it would be blamed on its followers.
    pub(crate) fn end(self, fault: Option<Fault>) -> Result<Written, Fault> {
        match (fault, self.known.refused) {
            (None, _) => Ok(Written {
                text: self.out.text,
                segments: self.out.segments,
                #[cfg(test)]
                beliefs: self.beliefs,
            }),
            (Some(_), Some(refused)) => Err(refused),
            (Some(fault), None) => Err(fault),
        }
    }
}
