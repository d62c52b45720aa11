//! What a statement makes of the program: values, and where it goes on.

use crate::expression::Expression;
use crate::o_word::OStatement;
use crate::value::{NameId, Variable};

/// What a statement makes of the block.
pub(crate) enum Said {
    Assignments(Vec<(Expression, Expression)>),
    Control(Control),
}

/// Where the program goes on.
#[derive(Clone, Debug)]
pub(crate) enum Control {
    Goto(Expression),
    IfGoto(Expression, Expression),
    IfThen(Expression, Vec<(Expression, Expression)>),
    /// `WHILE … DO1`; the end's place.
    While {
        condition: Option<Expression>,
        number: u32,
        end: u32,
    },
    /// `END1`; the loop's place.
    EndWhile {
        number: u32,
        start: u32,
    },
    Call(Box<Call>),
    Return {
        to: Option<Expression>,
    },
    O(Box<OStatement>),
    /// To a label.
    Jump {
        condition: Option<Expression>,
        to: NameId,
        direction: Direction,
    },
    /// `CALL BLOCK A TO B`: the blocks from one label to the other, both among them.
    Section {
        from: NameId,
        to: NameId,
    },
    /// `FOR I=1 TO 5`; the place of ENDFOR.
    For {
        variable: Variable,
        from: Expression,
        to: Expression,
        end: u32,
    },
    /// The place of its FOR.
    EndFor {
        start: u32,
    },
}

/// Where a label is looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Direction {
    Forward,
    Back,
    /// Forward, then from the start.
    Either,
    /// Wherever the one is.
    Only,
}

/// M97, M98 and G65.
#[derive(Clone, Debug)]
pub(crate) struct Call {
    /// Number of a program, or of a block.
    pub(crate) number: Expression,
    /// Siemens and Okuma: its name instead.
    pub(crate) program: Option<NameId>,
    /// M97: the number is that of a block of this program.
    pub(crate) local: bool,
    pub(crate) repeats: Option<Expression>,
    /// G65: letters in the order written, and whether the number has a point.
    pub(crate) arguments: Option<Vec<(u8, Expression, bool)>>,
}
