//! A calibration at work: what it is given beside its own options, and what it has said and made so far.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use diagnostic::{Code, Diagnostic, Language, Text};

use crate::lines;
use crate::message::{Failure, Report};
use crate::options::{JobOptions, Read};

/// What a calibration is given beside its own options.
pub struct Setting<'a> {
    /// Options of every job.
    pub options: &'a JobOptions,
    /// Reads measurements.
    pub read: Read<'a>,
    /// Of pages.
    pub language: Language,
    /// The command as it was typed; `None` where nobody typed one.
    pub command: Option<String>,
}

/// A part of what a calibration says.
pub enum Said {
    /// A result.
    Result(Text),
    /// A warning.
    Warning(Report),
}

/// What a calibration says and makes.
#[derive(Default)]
pub struct Calibration {
    /// What people read, in order.
    pub said: Vec<Said>,
    /// The profile, where one is asked for and is a good one.
    pub profile: Option<NewProfile>,
    /// JSON, page and CSV that were asked for, and where they go.
    pub results: Vec<(PathBuf, Vec<u8>)>,
    /// Why there is no profile, or no more than this.
    pub refused: Option<Failure>,
}

/// A profile and its tables.
pub struct NewProfile {
    /// Where it goes.
    pub path: PathBuf,
    /// The profile (TOML).
    pub text: String,
    /// Where its tables go.
    pub folder: PathBuf,
    /// Their names and texts.
    pub tables: Vec<(String, Vec<u8>)>,
    /// Hash of all of it, as it is counted where it is read.
    pub(super) hash: blake3::Hash,
}

/// The setting, and what is said and made.
pub(super) struct Work<'a> {
    pub(super) options: &'a JobOptions,
    pub(super) setting: &'a Setting<'a>,
    pub(super) made: RefCell<Calibration>,
}

impl<'a> Work<'a> {
    pub(super) fn new(setting: &'a Setting<'a>) -> Self {
        Self { options: setting.options, setting, made: RefCell::default() }
    }

    /// A file of measurements, by the name that messages know it by.
    pub(super) fn read(&self, path: &Path) -> Result<(String, Vec<u8>), Failure> {
        Ok((lines::name(path), (self.setting.read)(path)?))
    }

    pub(super) fn print(&self, text: &Text) {
        self.made.borrow_mut().said.push(Said::Result(text.clone()));
    }

    pub(super) fn report(&self, report: Report) {
        self.made.borrow_mut().said.push(Said::Warning(report));
    }

    pub(super) fn warning(&self, said: Diagnostic) {
        self.report(Report::warning(said));
    }

    pub(super) fn warn(&self, code: Code, message: Text, help: Text) {
        self.warning(Diagnostic::error(code, message).help(help));
    }

    /// Makes a result that is asked for.
    pub(super) fn show(&self, path: Option<&PathBuf>, bytes: impl FnOnce() -> Vec<u8>) {
        if let Some(path) = path {
            self.made.borrow_mut().results.push((path.clone(), bytes()));
        }
    }
}
