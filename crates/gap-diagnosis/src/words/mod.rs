//! The answer in words.

pub(crate) mod cause;
pub(crate) mod name;
pub(crate) mod notes;
pub(crate) mod report;
pub(crate) mod sentence;
