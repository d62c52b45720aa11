//! What a block made of its words.

use smallvec::SmallVec;
use toolpath::Motion;

use crate::direction::DirectionWords;
use crate::modal::Lost;

/// What a block is of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurvePart {
    /// It says a part of one that a later block cuts: nothing moves yet.
    Said,
    /// The curve is whole: its motions are the block's.
    Cut,
}

/// Nearly always none or one.
pub(crate) type Motions = SmallVec<[Motion; 1]>;

/// What a block made of its words.
#[derive(Debug, Default)]
pub(crate) struct Moved {
    pub(crate) motions: Motions,
    pub(crate) arc_by_radius: bool,
    pub(crate) direction: Option<DirectionWords>,
    pub(crate) curve: Option<CurvePart>,
    pub(crate) repeats: u32,
    pub(crate) states_position: bool,
    /// X, Y, Z that U, V or W stands for.
    pub(crate) by_increment: [bool; 3],
    /// Axes that the program has not named in the frame of the block before it.
    pub(crate) unnamed: [Option<Lost>; 3],
}
