//! Bytes to blocks and words.
//!
//! A program is read block by block. A [`Block`] borrows its bytes and lists what stands in them;
//! nothing is copied, nothing is lost: a block's bytes are the file's bytes, its items are spans of
//! them. Reading never fails as a whole: what is not understood becomes [`ItemKind::Invalid`] in its
//! place, and whoever needs that block decides what it means.
//!
//! How a language is spelled, reading asks of whoever [`Spells`]: a control of `nc-dialect`, or [`Marks`] alone.
//! What its words mean is not known here.

mod block;
mod code;
mod content;
mod envelope;
mod invalid;
mod letters;
mod lexer;
mod number;
mod plain;
mod reader;
mod spelling;
mod value;

pub use block::{Block, Invalid, Item, ItemKind, MAX_BLOCK_BYTES, Number, Sign, Span, Value, Word};
pub use code::GCode;
pub use content::looks_like_program;
pub use envelope::{Envelope, EnvelopeFinder};
pub use letters::Letters;
pub use plain::{PlainLine, PlainWord};
pub use reader::{Place, Reader, line_ending, line_ends};
pub use spelling::{Colon, Macros, Marks, Named, Paren, Semicolon, Spells};
