//! From an instrument's files to a machine profile.
//!
//! Files are read by the crate `measurement-files`, the mathematics is in the crate `calibration`.

mod against;
mod axis_change;
mod ballbar;
mod bar_readings;
mod bar_report;
pub mod codes;
mod interferometer;
mod iso_report;
mod options;
mod output;
mod page;
mod plausibility;
mod rtest;
pub mod sources;
mod squareness;
mod tracker;
mod turning;
mod volumetric;
mod work;

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand};

pub use turning::{MOST_UM, base_of, by_effects, part_name, stood_at, vector_mm};
use work::Work;
pub use work::{Calibration, NewProfile, Said, Setting};

/// What is calibrated.
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
    /// Ball deviations at angles of A, B, C, by R-test or by probe and sphere: location errors and error functions of
    /// rotary axes.
    #[command(name = "rtest")]
    RTest(options::RTest),
    /// Measured test pieces of a lathe: taper, bow, squareness, sizes of the tools, growth and wear.
    Turning(turning::Turning),
}

/// Does it.
#[must_use]
pub fn of(command: &CalibrateCommand, setting: &Setting<'_>) -> Calibration {
    let work = Work::new(setting);
    let done = match command {
        CalibrateCommand::Tracker(a) => tracker::run(a, &work),
        CalibrateCommand::Interferometer(a) => interferometer::run(a, &work),
        CalibrateCommand::Volumetric(a) => volumetric::run(a, &work),
        CalibrateCommand::Ballbar(a) => ballbar::run(a, &work),
        CalibrateCommand::RTest(a) => rtest::run(a, &work),
        CalibrateCommand::Turning(a) => turning::run(a, &work),
    };
    Calibration { refused: done.err(), ..work.made.into_inner() }
}

impl CalibrateCommand {
    /// The measurements that it reads.
    #[must_use]
    pub fn files(&self) -> Vec<PathBuf> {
        let both = |files: &[PathBuf], more: &Option<PathBuf>| files.iter().chain(more).cloned().collect();
        match self {
            Self::Tracker(a) => a.traverses.clone(),
            Self::Interferometer(a) => a.paths(),
            Self::Volumetric(a) => a.files.clone(),
            Self::Ballbar(a) => both(&a.files, &a.after),
            Self::RTest(a) => both(&a.files, &a.holdout),
            Self::Turning(a) => both(&a.files, &a.holdout),
        }
    }

    /// The files that it makes, and the options that name them.
    #[must_use]
    pub fn results(&self) -> [(&'static str, Option<&Path>); 4] {
        let (target, [html, json, csv]) = match self {
            Self::Tracker(a) => (&a.target, [None; 3]),
            Self::Interferometer(a) => (&a.target, a.shown.files()),
            Self::Volumetric(a) => (&a.target, [None; 3]),
            Self::Ballbar(a) => (&a.target, a.shown.files()),
            Self::RTest(a) => (&a.target, [None, a.json.as_deref(), None]),
            Self::Turning(a) => (&a.target, [a.html.as_deref(), a.json.as_deref(), None]),
        };
        [("--output", target.output.as_deref()), ("--html", html), ("--json", json), ("--csv", csv)]
    }
}
