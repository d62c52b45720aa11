use nc_syntax::GCode;
use smallvec::SmallVec;

/// What becomes of a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WordEdit {
    /// As it stands; must exist in the block.
    Keep,
    /// This value, `counts × 10^-decimals`: replaces the word, or is inserted where there is none.
    Write {
        /// Whole number of output steps.
        counts: i64,
        /// Decimals of the output step.
        decimals: u8,
    },
    /// Not written.
    Remove,
}

/// Edits by upper-case letter; an arc has five.
pub type WordEdits = SmallVec<[(u8, WordEdit); 6]>;

/// One block of output that stands for a block of input, or for a part of it.
///
/// Letters that `words` does not name: the first piece keeps them; later pieces have none, except that
/// what is executed after the motion (M0, M5, M9, M30, G9) moves to the last piece.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Piece {
    /// Motion code that must be in force for this block; `None` where the block moves nothing.
    pub motion: Option<GCode>,
    /// What becomes of its words.
    pub words: WordEdits,
}
