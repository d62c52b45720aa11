//! What a program is read against, and what one of its blocks asks for.

use nc_dialect::{Action, Dialect};
use nc_syntax::Span;

use crate::setup::Setup;
use crate::words::Words;

/// The base frame's name in the profile.
pub(crate) const BASE_FRAME: &str = "G500";

/// What a program is read against.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Environment<'d> {
    pub(crate) dialect: &'d Dialect,
    pub(crate) setup: &'d Setup,
    /// Modal group of G1: a G80 of the same group cancels it too.
    pub(crate) motion_group: Option<u8>,
}

impl Environment<'_> {
    /// The M code of a block that changes the tool.
    pub(crate) fn tool_change(&self, words: &Words<'_, '_, '_>) -> Option<(u16, Span)> {
        let changes = |number: u16| self.dialect.m_code(number).is_some_and(|row| row.changes_tool);
        words.m_codes.iter().copied().find(|(number, _)| changes(*number))
    }

    /// False for the Y of a lathe, which stands at 0 whatever moves.
    pub(crate) fn moves_axis(&self, axis: usize) -> bool {
        axis != 1 || self.dialect.turning.is_none()
    }
}

/// Whose the axis words of the block are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Owner {
    /// The motion code or cycle in force.
    Motion,
    /// G4: a time.
    Dwell,
    /// G4 whose time is set elsewhere: nobody's.
    DwellBySetting,
    /// G28, G30.
    Reference,
    /// G53.
    MachineCoordinates,
    /// G52, G92, G10, G68…
    Frame,
    /// G4 whose time is P alone: the axis words are the motion's.
    DwellP,
    /// G43.1
    Length,
    /// G31 and the like.
    Probe,
    /// A code that moves nothing.
    Arguments,
}

/// What the block asks for beyond its settings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Demand<'d> {
    pub(crate) owner: Owner,
    /// The code that owns the words, where it is not the motion.
    pub(crate) owner_span: Option<Span>,
    /// The motion or cycle code written in this block.
    pub(crate) written_motion: Option<Span>,
    /// The code that moves the frame by its words.
    pub(crate) frame: Option<&'d Action>,
}
