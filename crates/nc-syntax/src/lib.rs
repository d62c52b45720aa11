//! Bytes to blocks and words.
//!
//! A program is read block by block. A [`Block`] borrows its bytes and lists what stands in them;
//! nothing is copied, nothing is lost: a block's bytes are the file's bytes, its items are spans of
//! them. Reading never fails as a whole: what is not understood becomes [`ItemKind::Invalid`] in its
//! place, and whoever needs that block decides what it means.
//!
//! How a dialect writes numbers, comments and codes is a [`Dialect`]: a value, filled from a table in
//! `grammars/` by `nc-dialect`.

mod block;
mod code;
mod content;
pub mod dialect;
mod envelope;
mod invalid;
mod letters;
mod lexer;
mod number;
pub mod path_control;
mod plain;
mod reader;
mod value;

pub use block::{Block, Invalid, Item, ItemKind, MAX_BLOCK_BYTES, Number, Sign, Span, Value, Word};
pub use content::looks_like_program;
pub use dialect::Dialect;
pub use envelope::{Envelope, EnvelopeFinder};
pub use letters::Letters;
pub use plain::{PlainLine, PlainWord};
pub use reader::{Place, Reader, line_ending, line_ends};
