//! `vpost calibrate`: from an instrument's files to a machine profile.
//!
//! Files and formats are read here, the mathematics is in the crate `calibration`.

mod against;
mod ballbar;
mod codes;
mod formats;
mod interferometer;
mod iso_report;
mod output;
mod sheet;
mod squareness;
mod tracker;
mod volumetric;

pub(crate) use output::short;

use clap::{Args, Subcommand};

use crate::arguments::Shared;
use crate::message::{Failure, Messages};

/// `vpost calibrate`
#[derive(Debug, Args)]
pub struct Calibrate {
    /// The instrument.
    #[command(subcommand)]
    pub command: CalibrateCommand,
}

/// Instruments.
#[derive(Debug, Subcommand)]
pub enum CalibrateCommand {
    /// Three axis traverses of a laser tracker: directions, squareness, positioning and straightness.
    Tracker(tracker::Tracker),
    /// Runs of an interferometer, or tables of a control: eighteen functions, squareness, ISO 230-2.
    Interferometer(interferometer::Interferometer),
    /// Points anywhere in the volume, of a tracker or a tracking interferometer: all rigid-body terms.
    Volumetric(volumetric::Volumetric),
    /// Ball bar: location errors of an A/C table, or squareness, scale mismatch and backlash of linear axes.
    Ballbar(ballbar::Ballbar),
}

/// `vpost calibrate INSTRUMENT FILES… -o PROFILE`
pub(crate) fn run(arguments: &Calibrate, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    match &arguments.command {
        CalibrateCommand::Tracker(a) => tracker::run(a, shared, messages),
        CalibrateCommand::Interferometer(a) => interferometer::run(a, shared, messages),
        CalibrateCommand::Volumetric(a) => volumetric::run(a, shared, messages),
        CalibrateCommand::Ballbar(a) => ballbar::run(a, shared, messages),
    }
}
