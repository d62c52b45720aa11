//! Edits to NC text.
//!
//! `nc-emit` changes words of blocks and inserts blocks; what the numbers mean is not its business. It
//! keeps every byte that no edit names, follows the file's own habits where it must write, and knows
//! which motion code is in force in the *output*, so that a block that relied on a modal code still
//! finds it.

mod ascii;
mod edit;
mod emitter;
mod guard;
mod habits;
mod numbers;
mod provenance;
mod splice;
mod words;

pub use ascii::ascii;
pub use edit::{Piece, WordEdit, WordEdits};
pub use emitter::Emitter;
pub use guard::{Asked, Stated, guard, without_guards};
pub use numbers::BlockNumbers;
pub use provenance::{
    find_provenance, insert_provenance, provenance_comment, provenance_line, provenance_position,
};
