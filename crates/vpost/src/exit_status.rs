//! What the command ends with.

/// Exit status: done; refused or a check failed; usage, profile or grammar error; interrupted.
pub(crate) const DONE: u8 = 0;
pub(crate) const REFUSED: u8 = 1;
pub(crate) const USAGE: u8 = 2;
/// Trying again may help: `EX_TEMPFAIL` of `sysexits.h`.
pub(crate) const TRY_AGAIN: u8 = 75;
