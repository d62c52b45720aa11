//! The diagnosis as one page, in the order in which people ask: what, how much, where, how sure, what next, from what.

mod alignment;
mod causes;
mod facts;
mod names;
mod page;
mod pictures;
mod provenance;
mod rows;
mod unseen;
mod viewer;

pub(super) use causes::{causes, next};
pub(super) use facts::Facts;
pub(super) use page::{Report, begun, gap};
pub(super) use provenance::{facts, more};
