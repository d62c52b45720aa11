//! What comes out of a motion.

use smallvec::SmallVec;

use crate::Piece;
use crate::grid::Goal;

/// One motion, corrected.
#[derive(Clone, Debug, PartialEq)]
pub struct Corrected {
    /// Blocks of output in order; empty where the block stays as it is.
    pub pieces: SmallVec<[Piece; 2]>,
    /// What was done, for the summary.
    pub correction: Correction,
}

impl Corrected {
    /// One block; `None` where it stays as it is.
    pub(crate) fn block(piece: Option<Piece>, correction: Correction) -> Self {
        Self { pieces: piece.into_iter().collect(), correction }
    }
}

/// Figures of one motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correction {
    /// Largest distance between programmed and corrected command at an end of a piece, mm.
    pub largest_mm: f64,
    /// Proven upper bound of the path deviation without correction, mm; 0 for rapids.
    pub before_mm: f64,
    /// Proven upper bound of the path deviation, mm: what the cheapest proof says; 0 for rapids.
    pub after_mm: f64,
    /// A rapid ended outside the volume and took the nearest point's correction.
    pub clamped: bool,
    /// A short move to the corrected start was put before the motion.
    pub approach: bool,
    /// A cycle left to the control leans by this much over its depth, mm, more than the tolerance.
    pub leaning_mm: Option<f64>,
    /// Nobody knows on which side of its play an axis stands: the tool is off by up to this much besides, mm.
    pub unknown_side_mm: f64,
    /// The tolerance cannot be held: [`Correction::after_mm`] is what is proven instead.
    pub accepted: bool,
    /// Rotary axes turned on the way.
    pub turned: Option<Turned>,
    /// Where the tool points, on a machine that turns it.
    pub directed: Option<Directed>,
}

/// The tool's direction along a feed, against that of an ideal machine at the programmed place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Directed {
    /// Largest angle without correction, at both ends and in the middle, rad.
    pub before_rad: f64,
    /// The same with it where the rotary words stay as they are; else a proven upper bound.
    pub after_rad: f64,
    /// Directions were to be corrected, and near a singularity, or at the end of an axis' travel, were not.
    pub held: bool,
}

/// What a feed motion with rotary axes comes to, for those who know what F means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Turned {
    /// Way of the linear axes as programmed, mm.
    pub programmed_mm: f64,
    /// The same as written.
    pub commanded_mm: f64,
    /// What rounding may make of that, mm.
    pub rounding_mm: f64,
    /// Way of the rotary axes, degrees: the root of the sum of their squares.
    pub turned_deg: f64,
}

/// One block, which stays as it is where its words do.
pub(crate) fn one(piece: Piece, correction: Correction) -> Corrected {
    let is_new = piece.axes.iter().any(|word| matches!(word, Goal::Steps(_)));
    Corrected::block(is_new.then_some(piece), correction)
}
