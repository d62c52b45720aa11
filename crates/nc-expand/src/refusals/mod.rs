//! What is refused, and what to type instead: one item for each reason, by theme.

pub(crate) mod called;
pub(crate) mod calls;
pub(crate) mod contours;
pub(crate) mod drawings;
pub(crate) mod routines;
pub(crate) mod threads;
pub(crate) mod turning;
