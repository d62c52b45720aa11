//! Forward for a lathe: what a program leaves of the workpiece.

pub mod cuts;
pub mod judged;
pub mod surface;

use crate::expand;
use crate::message::Failure;
use crate::settings::Settings;
use cuts::{Cut, cuts};

/// The feeds of a program, its flow executed.
///
/// # Errors
/// What is wrong with the program.
pub fn read(text: &[u8], name: &str, settings: &Settings) -> Result<Vec<Cut>, Failure> {
    let expanded = expand::expanded(text, name, settings)?;
    cuts(expanded.text(), settings)
        .map_err(|diagnostics| Failure::Refused(expand::reports(&expanded, name, text, diagnostics)))
}
