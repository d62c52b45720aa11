//! Where a program stands, and the calls that have not returned.

use crate::value::{NameId, Program};
use crate::variables::Saved;

/// Where the program stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) file: usize,
    pub(crate) statement: u32,
}

/// A call that has not returned.
#[derive(Debug)]
pub(crate) struct Frame {
    pub(crate) back: Place,
    pub(crate) start: Place,
    /// Passes still to come.
    pub(crate) left: u64,
    pub(crate) passes: u64,
    pub(crate) kind: CallKind,
    /// The caller's variables, where the called program has its own.
    pub(crate) saved: Option<Saved>,
    /// The caller's loops.
    pub(crate) repeats: Vec<(u32, u64)>,
    pub(crate) counts: Vec<(u32, f64)>,
    /// Section of the caller.
    pub(crate) section: u32,
}

/// How a program was called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum CallKind {
    /// M98, G65, CALL: M99 or RTS returns.
    Number(Program),
    /// `L100`: M17 and RET return.
    Program(NameId),
    /// M97: the same, to a block of the caller's program.
    Block(u64),
    /// `o<name> call`: `endsub` and `return` return.
    Name(NameId),
    /// CALL BLOCK: to its last block.
    Section(NameId, u32),
    /// A contour of a cycle, which is read and not called.
    Routine(NameId),
}
