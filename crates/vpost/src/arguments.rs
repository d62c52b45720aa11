//! The command line.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use diagnostic::Language;
pub use jobs::options::{Decimal, JobOptions, Outside, finite, size, size_or_zero};

pub use crate::color::Color;
use crate::config::Held;
use crate::values::Given;

/// Options of every job.
#[derive(Debug, Clone, Args)]
pub struct Shared {
    /// What decides the output.
    #[command(flatten)]
    pub job: JobOptions,
    /// Settings from this file; none: from no file.
    ///
    /// Default: the nearest vpost.toml in the program's folder or above it.
    #[arg(long, value_name = "FILE", global = true, help_heading = "Messages")]
    pub config: Option<PathBuf>,
    /// What is said meanwhile.
    #[command(flatten)]
    pub messages: MessageOptions,
    /// What a settings file says.
    #[arg(skip)]
    pub held: Held,
}

/// What is said while a job is done.
#[derive(Debug, Clone, Args)]
pub struct MessageOptions {
    /// No warnings.
    #[arg(short, long, global = true, help_heading = "Messages")]
    pub quiet: bool,
    /// More about what is done.
    ///
    /// On standard error; repeatable.
    #[arg(short, long, action = clap::ArgAction::Count, global = true, help_heading = "Messages")]
    pub verbose: u8,
    /// Colours: auto, always, never.
    #[arg(long, value_enum, default_value_t = Color::Auto, global = true, hide_possible_values = true, help_heading = "Messages")]
    pub color: Color,
    /// Language: en, ru; default: the locale's.
    ///
    /// LC_ALL, LC_MESSAGES, LANG say it otherwise.
    #[arg(id = "lang", long = "lang", value_name = "LANG", global = true, help_heading = "Messages")]
    pub language: Option<Given<Language>>,
}

/// The main job.
#[derive(Debug, Args)]
pub struct Correct {
    /// NC program; - for standard input.
    #[arg(value_name = "IN.nc", required = true)]
    pub input: Option<PathBuf>,
    /// Write to this file, all or nothing.
    ///
    /// Instead of standard output.
    #[arg(short, long, value_name = "OUT.nc")]
    pub output: Option<PathBuf>,
    /// Write a summary (JSON).
    #[arg(long, value_name = "FILE")]
    pub summary: Option<PathBuf>,
    /// Correct a program that says it was corrected before.
    #[arg(long)]
    pub force: bool,
    /// Report progress: linuxcnc.
    ///
    /// In this style, on standard error.
    #[arg(long, value_enum, hide_possible_values = true)]
    pub progress: Option<Progress>,
}

/// Style of progress reports.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Progress {
    /// `FILTER_PROGRESS=nn` lines, as LinuxCNC's program filters give them.
    Linuxcnc,
}

/// `vpost check`
#[derive(Debug, Args)]
pub struct Check {
    /// The program as posted.
    #[arg(value_name = "IN.nc")]
    pub input: PathBuf,
    /// The corrected program.
    #[arg(value_name = "OUT.nc")]
    pub output: PathBuf,
    /// The result as JSON on standard output.
    #[arg(long)]
    pub json: bool,
    /// Write the result as one page: the tool path coloured by its error, the worst blocks (HTML).
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write a page in which the error moves.
    ///
    /// The path in space, magnified, cause by cause; HTML with a script of its own.
    #[arg(long, value_name = "FILE")]
    pub viewer: Option<PathBuf>,
}

/// `vpost predict`
#[derive(Debug, Args)]
pub struct Predict {
    /// Commanded points (CSV), or with --lathe the program; - for standard input.
    #[arg(value_name = "POINTS.csv")]
    pub points: PathBuf,
    /// Give positions in the measuring frame: apply the profile's `[setup]`.
    #[arg(long, conflicts_with = "lathe")]
    pub include_setup: bool,
    /// Count errors from this zero of the profile, as it was touched.
    #[arg(long, value_name = "G54", conflicts_with_all = ["lathe", "include_setup"])]
    pub datum: Option<String>,
    /// Predict what a lathe turns by a program: radius along Z, roundness, cylindricity, roughness.
    #[arg(long)]
    pub lathe: bool,
    /// With --lathe: distance of the places along Z, mm.
    #[arg(long, value_name = "MM", default_value_t = 1.0, requires = "lathe")]
    pub step: f64,
    /// With --lathe: the tool cuts a bore, so that the largest radius counts.
    #[arg(long, requires = "lathe")]
    pub bore: bool,
    /// With --lathe: the result as JSON on standard output.
    #[arg(long, requires = "lathe")]
    pub json: bool,
    /// With --lathe: what to add to the wear offsets of X, by tool and cylinder, for who may change offsets only.
    #[arg(long, requires = "lathe", conflicts_with = "json")]
    pub wear: bool,
    /// With --lathe: write a page with the outline, its roundness, and what a correction will bring.
    #[arg(long, value_name = "FILE", requires = "lathe")]
    pub html: Option<PathBuf>,
    /// With --html: Z from the chuck of a cross section to draw, mm (repeatable).
    #[arg(long, value_name = "Z", requires = "html", allow_negative_numbers = true)]
    pub section: Vec<f64>,
}

/// `vpost solve`
#[derive(Debug, Args)]
pub struct Solve {
    /// Target points (CSV); - for standard input.
    #[arg(value_name = "POINTS.csv")]
    pub points: PathBuf,
    /// K of the astatic law of `kmtpp-published`; 1.5 if not given.
    #[arg(long, value_name = "K", value_parser = size)]
    pub gain: Option<f64>,
    /// Its step l of model time; 0.1 if not given.
    #[arg(long, value_name = "L", value_parser = size)]
    pub step: Option<f64>,
}

/// `vpost profile`
#[derive(Debug, Args)]
pub struct Profile {
    /// The work.
    #[command(subcommand)]
    pub command: ProfileCommand,
}

/// Work on profiles.
#[derive(Debug, Subcommand)]
pub enum ProfileCommand {
    /// Read a profile and everything it names; say what is wrong.
    Check {
        /// Machine profile (TOML).
        profile: PathBuf,
    },
    /// Say what a profile means.
    Show {
        /// Machine profile (TOML).
        profile: PathBuf,
    },
    /// Write a profile to begin with, its sections explained.
    New(crate::profile_new::New),
    /// Write the model in a form that a control takes.
    #[command(override_usage = "vpost profile export [OPTIONS] --format <FORMAT> -O <DIR> <PROFILE.toml>")]
    Export(crate::export::Export),
    /// Print the JSON Schema of profiles.
    Schema,
}

/// `vpost grammar`
#[derive(Debug, Args)]
pub struct Grammar {
    /// The work.
    #[command(subcommand)]
    pub command: GrammarCommand,
}

/// Work on dialect tables.
#[derive(Debug, Subcommand)]
pub enum GrammarCommand {
    /// Read grammar files; say what is wrong.
    Check {
        /// Grammar files (TOML).
        #[arg(required = true)]
        files: Vec<PathBuf>,
    },
    /// The dialects vpost knows, with their assumptions.
    List,
}

/// `vpost completions`
#[derive(Debug, Args)]
pub struct Completions {
    /// The shell.
    #[arg(value_enum)]
    pub shell: clap_complete::Shell,
}

/// `vpost lsp`
#[derive(Debug, Args)]
pub struct Lsp {}

/// `vpost man`
#[derive(Debug, Args)]
pub struct Manual {
    /// Write the pages of all commands into this folder.
    ///
    /// Instead of the first page to standard output.
    #[arg(short = 'O', long = "output-dir", value_name = "DIR")]
    pub folder: Option<PathBuf>,
    /// Print all commands and options as JSON.
    ///
    /// For forms and editors: names, values, defaults and help, in the language of `--lang`.
    #[arg(long, conflicts_with = "folder")]
    pub json: bool,
}
