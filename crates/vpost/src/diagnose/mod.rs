//! `vpost diagnose`: files in, the answer of `gap-diagnosis` out.

mod command;
mod lathe;
mod options;
mod report;
mod written;

pub(crate) use command::run;
pub use options::Diagnose;
