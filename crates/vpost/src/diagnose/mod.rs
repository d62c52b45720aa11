//! `vpost diagnose`: files in, the answer of `gap-diagnosis` out.

mod command;
mod lathe;
mod options;
mod plan;
mod report;
mod summary;
mod written;

pub(crate) use command::run;
pub use options::Diagnose;
pub use plan::Form;
