//! What can be asked of `vpost diagnose`.

use std::path::PathBuf;

use clap::Args;
use jobs::diagnose::plan::Form;

/// `vpost diagnose`
#[derive(Debug, Args)]
pub struct Diagnose {
    /// Measurements (CSV); - for standard input.
    #[arg(value_name = "MEASUREMENTS.csv", required_unless_present = "plan")]
    pub measurements: Option<PathBuf>,
    /// Print what to measure on this machine, and nothing else: rows to fill in, or the NC program that goes there.
    #[arg(long, value_enum, value_name = "FORM", conflicts_with = "measurements")]
    pub plan: Option<Form>,
    /// Print what to measure next instead of the summary: rows to fill in, or the NC program that goes there.
    #[arg(long, value_enum, value_name = "FORM", conflicts_with = "plan")]
    pub next: Option<Form>,
    /// Measurements that no fit may see: the predicted shrinkage is checked on them.
    #[arg(long, value_name = "FILE")]
    pub holdout: Option<PathBuf>,
    /// Write the diagnosis as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the diagnosis as one page for a browser.
    ///
    /// Drawings, no network, no script.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write a page in which the error moves.
    ///
    /// The rows in space, magnified, cause by cause; HTML with a script of its own.
    #[arg(long, value_name = "FILE")]
    pub viewer: Option<PathBuf>,
    /// Write the profile with the causes added as effects.
    #[arg(long, value_name = "FILE")]
    pub write_profile: Option<PathBuf>,
    /// Column to pass over (repeatable).
    #[arg(long, value_name = "NAME")]
    pub ignore_column: Vec<String>,
    /// Take the columns as named: no look for flipped signs, swapped columns.
    #[arg(long)]
    pub as_written: bool,
    /// Seed of the random relabellings behind the p values of places.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Effect that this machine does not have, or the instrument (repeatable).
    #[arg(long, value_name = "ID")]
    pub without: Vec<String>,
}
