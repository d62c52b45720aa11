//! Programs with flow to plain programs.
//!
//! A pre-pass: [`expand`] executes what is known before the program runs (variables, expressions,
//! conditions, loops, jumps, subprograms) and writes every block that is reached, with its numbers, one after the
//! other. What remains is a plain program for `nc-program`. A program without flow is returned as it is,
//! borrowed.
//!
//! # What the flat program holds
//!
//! * Blocks that compute nothing: their bytes. A block reached again loses its N word, so that no number
//!   repeats; so do all blocks of other files.
//! * Blocks with computed words: the source line as a comment, then the block with numbers in place of
//!   expressions. Lengths get a point and 6 decimals at most (Fanuc), 9 (LinuxCNC, which does not round);
//!   codes and counts are whole.
//! * Assignments, conditions, loops and calls: the line as a comment, where it is reached the first time. Each
//!   pass of a called program opens with a comment such as `(O1000 CALL 2 OF 3)`.
//!
//! * Corners (`,R5.`, `,C2.`) and polar words (G16): the line as a comment, then the points, arcs and lines they
//!   stand for.
//! * Cycles of lathes (G90, G71 and their like) and cycles called by name (CYCLE81): the line as a comment, then the
//!   moves.
//!
//! # What is refused
//!
//! What decides a motion and is known only on the machine: system variables, variables nobody set,
//! comparisons that the control's rounding decides, labels and programs that are not there; loops and calls
//! beyond [`Limits`]. See [`codes`].
//!
//! Common variables (`#100` and up) keep what an earlier program left in them: unset, they are unknown, not
//! empty. A value that is unknown may be assigned and passed on; only its use in a word or a condition is
//! refused, naming the variable it came from.

mod call;
mod called;
pub mod codes;
mod evaluate;
mod expression;
mod faults;
mod flow;
mod jump;
mod known;
mod lowering;
mod o_word;
mod okuma;
#[cfg(test)]
mod one_reader;
mod output;
mod parts;
mod program;
mod refusals;
mod returns;
mod run;
mod shorthand;
mod siemens;
mod statement;
mod turning;
mod value;
mod variables;
mod words;

use std::borrow::Cow;
use std::io;
use std::ops::Range;

use diagnostic::Diagnostic;
use nc_program::Setup;
use nc_syntax::dialect::{Dialect, Macros};
use nc_syntax::{Block, ItemKind, Reader};

use lowering::{Came, Driver, Lowered};
pub use output::PlainPart;
use output::{From, Segment};
pub use parts::{AsAWhole, Lowering};
pub use variables::Preset;

/// What was done, for the comment in the output, where shorthand alone was written out.
pub const SHORTHAND_WRITTEN_OUT: &str = "SHORTHAND WRITTEN OUT";

/// Where work ends that would not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Executions of blocks that were executed before, parts of long expressions counted.
    pub steps: u64,
    /// Bytes that the flat program may have beyond three times the source.
    pub output_bytes: u64,
    /// Calls inside one another. LinuxCNC and Fanuc allow 10.
    pub depth: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { steps: 5_000_000, output_bytes: 64 << 20, depth: 10 }
    }
}

/// What the program cannot say of itself.
pub struct Environment<'e> {
    /// Values of variables.
    pub variables: &'e [Preset],
    /// Reads a subprogram's file by its name, which holds no folder.
    pub read_external: &'e dyn Fn(&str) -> io::Result<Vec<u8>>,
    /// Against what the plain program will be read: where its shorthand starts, the one reader of programs says.
    pub setup: &'e Setup,
    /// Where work ends that would not.
    pub limits: Limits,
}

/// A program that could not be expanded.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Why.
    pub diagnostics: Vec<Diagnostic>,
    /// Name and bytes of the file they speak of; `None`: the program itself.
    pub file: Option<(String, Vec<u8>)>,
}

/// A plain program.
#[derive(Clone, Debug, Default)]
pub struct Expanded<'a> {
    text: Cow<'a, [u8]>,
    /// Called files: name and bytes.
    files: Vec<(String, Vec<u8>)>,
    /// Where each stretch of it comes from; none where it is the source.
    segments: Vec<Segment>,
    /// The program had flow.
    flows: bool,
    /// It had shorthand.
    lowers: bool,
    warnings: Vec<Diagnostic>,
}

/// A place in a source file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// 0: the program itself; n: [`Expanded::file`] n.
    pub file: usize,
    /// Bytes of that file.
    pub span: Range<u64>,
}

impl Expanded<'_> {
    /// The plain program's bytes.
    #[must_use]
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    /// True where the program had flow; else its text is the source's.
    #[must_use]
    pub const fn changed(&self) -> bool {
        matches!(self.text, Cow::Owned(_))
    }

    /// What the user should know; places are in the program itself.
    #[must_use]
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Name and bytes of a called file, from 1.
    #[must_use]
    pub fn file(&self, index: usize) -> Option<(&str, &[u8])> {
        self.files.get(index.checked_sub(1)?).map(|(name, text)| (name.as_str(), text.as_slice()))
    }

    /// What was done, for the comment in the output.
    #[must_use]
    pub const fn what(&self) -> &'static str {
        match (self.flows, self.lowers) {
            (false, false) => "",
            (true, false) => "PROGRAM FLOW EXPANDED",
            (false, true) => SHORTHAND_WRITTEN_OUT,
            (true, true) => "PROGRAM FLOW EXPANDED, SHORTHAND WRITTEN OUT",
        }
    }

    /// Where bytes of the plain program come from: the same bytes where they were copied, else the block
    /// they stand for.
    #[must_use]
    pub fn origin(&self, span: &Range<u64>) -> Origin {
        if self.changed() {
            output::origin(&self.segments, span)
        } else {
            Origin { file: 0, span: span.clone() }
        }
    }

    /// The line of the source that a line of the plain program comes from, with its file.
    #[must_use]
    pub fn source_line(&self, line: u64) -> (usize, u64) {
        output::source_line(&self.segments, line)
    }

    /// Puts the places of diagnostics about the plain program into the source files: by file, in order.
    #[must_use]
    pub fn settle(&self, diagnostics: Vec<Diagnostic>) -> Vec<(usize, Vec<Diagnostic>)> {
        let mut settled: Vec<(usize, Vec<Diagnostic>)> = Vec::new();
        for mut diagnostic in diagnostics {
            let origin = diagnostic.span.as_ref().map(|span| self.origin(span));
            let file = origin.as_ref().map_or(0, |origin| origin.file);
            diagnostic.span = origin.map(|origin| origin.span);
            match settled.last_mut().filter(|(last, _)| *last == file) {
                Some((_, same)) => same.push(diagnostic),
                None => settled.push((file, vec![diagnostic])),
            }
        }
        settled
    }
}

/// Expands a program.
///
/// # Errors
/// What cannot be told before the program runs, with the way out ([`codes`]).
pub fn expand<'a>(
    text: &'a [u8],
    dialect: &Dialect,
    environment: &Environment<'_>,
) -> Result<Expanded<'a>, Refusal> {
    let (mut reader, mut block) = (Reader::new(text, dialect), Block::default());
    let (mut runs, mut has_shorthand) = (false, false);
    while reader.next(&mut block) {
        // What stands behind a `%` that closes the program is not executed, whatever it would be.
        if runs && block.items.iter().any(|item| item.kind == ItemKind::Percent) {
            break;
        }
        runs |= block.acts();
        if flows(&block, dialect) {
            return run::run(text, dialect, environment);
        }
        has_shorthand |= short(&block, dialect);
    }
    if !has_shorthand {
        return Ok(Expanded { text: Cow::Borrowed(text), ..Expanded::default() });
    }
    let mut driver = Driver::new(dialect, environment.setup, text);
    reader = Reader::new(text, dialect);
    while reader.next(&mut block) {
        driver.block(&Came { from: From::of(&block), block: block.clone() });
    }
    let lowered = driver.end(text.len() as u64);
    let Lowered { out, lowers, .. } = lowered.map_err(|fault| fault.in_files(&[]))?;
    Ok(Expanded { text: Cow::Owned(out.text), segments: out.segments, lowers, ..Expanded::default() })
}

/// True where a block computes, jumps, calls, or has shorthand to be written out: a program that has one is not plain.
#[must_use]
pub fn computes(block: &Block<'_>, dialect: &Dialect) -> bool {
    flows(block, dialect) || short(block, dialect)
}

/// True where a block computes, jumps or calls.
fn flows(block: &Block<'_>, dialect: &Dialect) -> bool {
    dialect.flow.macros != Macros::None && statement::needs_work(block, dialect)
}

/// True where a block has shorthand: of drawings, or a cycle of a lathe.
fn short(block: &Block<'_>, dialect: &Dialect) -> bool {
    shorthand::needed(block, dialect)
        || turning::needed(block, dialect)
        || called::needed(block, dialect)
        || returns::needed(block, dialect)
}
