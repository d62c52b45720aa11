//! Motions to corrected motions.
//!
//! In: a motion in axis commands and what the block it came from may write. Out: pieces whose end
//! points are whole output steps, such that the *whole path* of the real machine stays within
//! tolerance of the path programmed. Knows no text: a word is a letter and a count of steps.
//!
//! The promise is proven, not sampled: between two places where the deviation is computed, the model
//! bounds how far it can leave the chord ([`machine_model::PathModel::chord_bound_mm`]); a stretch that
//! is not proven is halved until it is, or split. See `docs/path-promise.md`.

mod approach;
mod arc;
mod before;
mod centre;
mod corrector;
mod curve;
mod deviation;
mod grid;
mod hole;
mod line;
mod play;
mod short_line;
#[cfg(test)]
mod testing;
mod turning;

pub use corrector::{Corrected, Correction, CorrectionError, Corrector, Options, Outside};
pub use curve::Curve;
pub use grid::{AxisWord, Block, Letters};
pub use short_line::{Run, ShortLines, ShortRun};
pub use turning::Turned;

/// One block of output, in whole output steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// What the block does.
    pub kind: PieceKind,
    /// X, Y, Z words. In a [`PieceKind::Cycle`] the normal axis' word is the bottom of the hole.
    pub axes: [AxisWord; 3],
    /// A, B, C words where rotary axes turn on the motion's way, in steps of [`Block::rotary_decimals`]; `None` where those of
    /// the block stay with its first piece.
    pub rotary: Option<[AxisWord; 3]>,
    /// Share of the motion's length: what inverse-time feed is divided by.
    pub share: f64,
}

impl Piece {
    /// One whose block turns no rotary axis.
    #[must_use]
    pub const fn new(kind: PieceKind, axes: [AxisWord; 3], share: f64) -> Self {
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
        /// The R word.
        r: AxisWord,
    },
    /// G4 with the cycle's P.
    Dwell,
}

/// How an arc's centre is given.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Centre {
    /// The two centre words of the plane, in the order of `Plane::axes`.
    Offsets([AxisWord; 2]),
    /// The R word.
    Radius(AxisWord),
}
