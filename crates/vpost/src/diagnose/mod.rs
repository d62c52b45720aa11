//! `vpost diagnose`: files in, the answer of `gap-diagnosis` out.

mod books;
mod change;
mod command;
mod json;
mod measurements;
mod model;
mod plan;
mod read;
mod report;
mod summary;
mod written;

pub use command::Diagnose;
pub(crate) use command::run;
pub use plan::Form;
pub(crate) use read::readable;
