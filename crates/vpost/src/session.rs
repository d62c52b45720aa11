//! The command's jobs on bytes: no files but the profile's and the folders of `--include`, no output.
//!
//! For whoever runs thousands of programs through what a user gets: the fuzz targets (`tests/fuzz`).

use diagnostic::Language;
use nc_expand::Limits;
use rewrite::{Corrected, Manner};

use crate::arguments::Color;
use crate::command_line::Arguments;
use crate::config::Held;
use crate::message::{Failure, Messages};
use crate::settings::Settings;
use jobs::{check, diagnose, expand};

/// Options, profile and dialect of a command line, read once.
pub struct Session {
    settings: Settings,
    messages: Messages,
}

/// Why a program was refused: the messages as the command prints them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Refusal(pub String);

impl Session {
    /// Reads what options name, `["-m", "machine-profiles/stan_s500.toml", "-d", "linuxcnc"]`, under the limits on
    /// program flow.
    ///
    /// # Errors
    /// The messages of the command.
    pub fn new(options: &[&str], limits: Limits) -> Result<Self, Refusal> {
        let line = ["vpost"].iter().chain(options).chain(&["-"]).map(std::ffi::OsString::from);
        let arguments = Arguments::read(line, Held::default()).map_err(|error| Refusal(error.to_string()))?;
        let messages = Messages::new(Color::Never, Language::English).quiet();
        match Settings::load(&arguments.shared.job) {
            Ok(mut settings) => {
                settings.flow.limits = limits;
                Ok(Self { settings, messages })
            }
            Err(failure) => Err(Refusal(messages.text(&failure))),
        }
    }

    fn refusal(&self, failure: &Failure) -> Refusal {
        Refusal(self.messages.text(failure))
    }

    /// The main job: the corrected program.
    ///
    /// # Errors
    /// The messages of the first block that cannot be corrected with certainty.
    pub fn correct(&self, text: &[u8]) -> Result<Corrected, Refusal> {
        let manner = Manner { force: false, threads: 1, hashes: false };
        expand::correct(text, "program", &self.settings, manner, |_| Ok(()))
            .map(|done| done.corrected)
            .map_err(|failure| self.refusal(&failure))
    }

    /// `vpost check`: what is wrong with a corrected program; empty where it passes.
    ///
    /// # Errors
    /// The messages of a program that cannot be read.
    pub fn check(&self, posted: &[u8], corrected: &[u8]) -> Result<Vec<String>, Refusal> {
        check::findings_between(("posted", posted), ("corrected", corrected), &self.settings)
            .map_err(|failure| self.refusal(&failure))
    }

    /// Reads measurements as `vpost diagnose` does.
    ///
    /// # Errors
    /// The messages about the table.
    pub fn read_measurements(&self, bytes: &[u8]) -> Result<(), Refusal> {
        diagnose::readable(bytes, &self.settings.profile).map_err(|failure| self.refusal(&failure))
    }
}
