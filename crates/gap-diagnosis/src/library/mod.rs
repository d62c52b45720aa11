//! The effects that a file could show, each in its forms.

pub(crate) mod candidates;
pub(crate) mod forms;
pub(crate) mod sampling;
pub(crate) mod seen;
