//! `vpost diagnose`: files in, the answer of `gap-diagnosis` out.

mod command;
mod lathe;
mod plan;
mod report;
mod summary;
mod written;

pub use command::Diagnose;
pub(crate) use command::run;
pub use plan::Form;
