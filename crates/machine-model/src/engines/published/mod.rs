//! The engines exactly as published, for `solve` and for tests: they reproduce, they do not correct.
//!
//! Their defects are part of them (`docs/reproduction.md`): cosines without
//! signs, a transposed matrix, a base rounded to a node.

mod kmtpp;
mod tangential;

pub use kmtpp::{KmtppPublished, Trace};
pub use tangential::{Method, TangentialPublished};
