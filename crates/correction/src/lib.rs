//! Motions to corrected motions.
//!
//! In: a motion in axis commands and what the block it came from may write. Out: pieces whose end
//! points are whole output steps, such that the *whole path* of the real machine stays within
//! tolerance of the path programmed. Knows no text and no letter: where an axis goes is a place on the grid of output
//! steps ([`Goal`]); which words say so is written elsewhere.
//!
//! The promise is proven, not sampled: between two places where the deviation is computed, the model
//! bounds how far it can leave the chord ([`machine_model::PathModel::chord_bound_mm`]); a stretch that
//! is not proven is halved until it is, or split. See `docs/path-promise.md`.

mod approach;
mod arc;
mod before;
mod by_chords;
mod by_commands;
mod centre;
mod corrected;
mod corrector;
mod curve;
mod deviation;
mod directed_turn;
mod direction;
mod directions;
mod error;
mod extent;
mod follow;
mod grid;
mod hole;
mod hole_by_moves;
mod line;
mod motion;
mod options;
mod orientation;
mod play;
mod pointing;
mod remembered;
mod rotary_play;
mod short_line;
#[cfg(test)]
mod testing;
mod turning;

pub use corrected::{Corrected, Correction, Directed, Turned};
pub use corrector::Corrector;
pub use curve::Curve;
pub use error::CorrectionError;
pub use grid::{Block, Goal, Stated};
pub use options::{Options, Orientation, Outside};
pub use pointing::HELD_RAD;
pub use short_line::{Run, ShortLines, ShortRun};

/// One block of output, in whole output steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// What the block does.
    pub kind: PieceKind,
    /// Where X, Y, Z go. In a [`PieceKind::Cycle`] the normal axis' goal is the bottom of the hole.
    pub axes: [Goal; 3],
    /// Where A, B, C turn to, where they do so on the motion's way, in steps of [`Block::rotary_decimals`]; `None` where those of
    /// the block stay with its first piece.
    pub rotary: Option<[Goal; 3]>,
    /// Share of the motion's length: what inverse-time feed is divided by.
    pub share: f64,
}

impl Piece {
    /// One whose block turns no rotary axis.
    #[must_use]
    pub const fn new(kind: PieceKind, axes: [Goal; 3], share: f64) -> Self {
        Self { kind, axes, rotary: None, share }
    }
}

/// What a block of output does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PieceKind {
    /// G0
    Rapid,
    /// G1
    Line,
    /// G2 or G3
    Arc {
        /// G2.
        clockwise: bool,
        /// How the centre is given.
        centre: Centre,
    },
    /// A drilling cycle left to the control.
    Cycle {
        /// Where it begins to feed.
        r: Goal,
    },
    /// G4 with the cycle's P.
    Dwell,
    /// What the block itself does, but for its rotary words.
    AsStated,
}

/// How an arc's centre is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Centre {
    /// From the start, or as the block states centres, in the order of `Plane::axes`.
    Offsets([Goal; 2]),
    /// By its radius; negative for the long way round.
    Radius(Goal),
}
