//! `vpost calibrate`: from an instrument's files to a machine profile.
//!
//! Files are read by the crate `measurement-files`, the mathematics is in the crate `calibration`.

mod against;
mod axis_change;
mod ballbar;
mod bar_readings;
mod bar_report;
pub(crate) mod codes;
mod interferometer;
mod iso_report;
mod options;
mod output;
mod page;
mod plausibility;
mod rtest;
pub(crate) mod sources;
mod squareness;
mod tracker;
pub(crate) mod turning;
mod volumetric;

use std::path::PathBuf;

use clap::{Args, Subcommand};

use diagnostic::both;

use crate::arguments::Shared;
use crate::message::{Failure, Messages};
use crate::roles::Roles;

use page::Shown;

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
    Interferometer(options::Interferometer),
    /// Points anywhere in the volume, of a tracker or a tracking interferometer: all rigid-body terms.
    Volumetric(volumetric::Volumetric),
    /// Ball bar: location errors of a table's rotary axes, or squareness, scale mismatch and backlash of linear axes.
    Ballbar(ballbar::Ballbar),
    /// Ball deviations at angles of A, B, C, by R-test or by probe and sphere: location errors and error functions of rotary axes.
    #[command(name = "rtest")]
    RTest(options::RTest),
    /// Measured test pieces of a lathe: taper, bow, squareness, sizes of the tools, growth and wear.
    Turning(turning::Turning),
}

/// `vpost calibrate INSTRUMENT FILES… -o PROFILE`
pub(crate) fn run(arguments: &Calibrate, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let both = |files: &[PathBuf], more: &Option<PathBuf>| files.iter().chain(more).cloned().collect();
    let (target, files, shown): (_, Vec<PathBuf>, _) = match &arguments.command {
        CalibrateCommand::Tracker(a) => (&a.target, a.traverses.clone(), Shown::default()),
        CalibrateCommand::Interferometer(a) => (&a.target, a.paths(), a.shown.clone()),
        CalibrateCommand::Volumetric(a) => (&a.target, a.files.clone(), Shown::default()),
        CalibrateCommand::Ballbar(a) => (&a.target, both(&a.files, &a.after), a.shown.clone()),
        CalibrateCommand::RTest(a) => {
            let shown = Shown { json: a.json.clone(), ..Shown::default() };
            (&a.target, both(&a.files, &a.holdout), shown)
        }
        CalibrateCommand::Turning(a) => {
            let shown = Shown { json: a.json.clone(), html: a.html.clone(), csv: None };
            (&a.target, both(&a.files, &a.holdout), shown)
        }
    };
    let roles = Roles::default()
        .reads_all(&both!("a measurement", "измерения"), &files)
        .writes("--output", target.output.as_deref());
    shown.roles(roles).are_apart()?;
    match &arguments.command {
        CalibrateCommand::Tracker(a) => tracker::run(a, shared, messages),
        CalibrateCommand::Interferometer(a) => interferometer::run(a, shared, messages),
        CalibrateCommand::Volumetric(a) => volumetric::run(a, shared, messages),
        CalibrateCommand::Ballbar(a) => ballbar::run(a, shared, messages),
        CalibrateCommand::RTest(a) => rtest::run(a, shared, messages),
        CalibrateCommand::Turning(a) => turning::run(a, shared, messages),
    }
}
