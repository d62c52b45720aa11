//! Why an engine cannot be built.

use crate::TableError;

/// Why an engine cannot be built from what the profile offers.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BuildError {
    /// The profile lacks an input.
    #[error(
        "engine `{engine}` needs {what}, which the profile lacks; add {add}, or choose another engine with `--engine`"
    )]
    Missing {
        /// The engine.
        engine: &'static str,
        /// What it needs.
        what: &'static str,
        /// What to write into the profile.
        add: &'static str,
    },
    /// The traverses are not X, Y, Z in this order, or one has not as many positions as commands.
    #[error("the {axis} traverse of [tracker] does not move {axis} alone, or lacks measured positions")]
    TraverseOfOtherAxis {
        /// The axis expected.
        axis: char,
    },
    /// Too few nodes.
    #[error("the {axis} traverse of [tracker] has {found} positions, this engine needs at least {needed}")]
    TraverseTooShort {
        /// The axis.
        axis: char,
        /// Positions found.
        found: usize,
        /// Positions needed.
        needed: usize,
    },
    /// The three lines do not meet.
    #[error(
        "the traverses of [tracker] do not meet in one point: {axis} stood at {first_mm} mm and {second_mm} mm \
         while the other axes moved, and its own traverse must pass there"
    )]
    NoCommonOrigin {
        /// The axis.
        axis: char,
        /// Where it stood in one of the other traverses, mm.
        first_mm: f64,
        /// And in the other, mm.
        second_mm: f64,
    },
    /// The published trace counts table rows.
    #[error("`kmtpp-published` needs the table of {axis} in equal steps from 0 mm")]
    UnequalSteps {
        /// The axis.
        axis: char,
    },
    /// The measured directions of the axes lie in one plane.
    #[error("the axis directions in [tracker] do not span space")]
    Singular,
    /// Not a table.
    #[error(transparent)]
    Table(TableError),
}
