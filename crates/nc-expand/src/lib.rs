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
mod call_stack;
mod called;
mod came;
pub mod codes;
mod control;
mod evaluate;
mod expanded;
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

use nc_dialect::Dialect;
use nc_syntax::{Block, ItemKind, Reader};

pub use came::Origin;
use came::{Came, From};
pub use expanded::{Environment, Expanded, Limits, Refusal, SHORTHAND_WRITTEN_OUT};
use lowering::{Driver, Lowered, short};
pub use output::PlainPart;
pub use parts::{AsAWhole, Lowering};
use statement::flows;
pub use variables::Preset;

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
    let Lowered { out, lowers, .. } = lowered.map_err(|fault| Refusal::of(*fault, &[]))?;
    Ok(Expanded { text: Cow::Owned(out.text), segments: out.segments, lowers, ..Expanded::default() })
}

/// True where a block computes, jumps, calls, or has shorthand to be written out: a program that has one is not plain.
#[must_use]
pub fn computes(block: &Block<'_>, dialect: &Dialect) -> bool {
    flows(block, dialect) || short(block, dialect)
}
