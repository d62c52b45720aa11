//! The command line.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use machine_model::EngineId;
use nc_expand::Preset;
use serde::{Deserialize, Serialize};

use crate::language::Language;
use crate::values::{Conditions, Given, Point3, ToolLength, Unread, WorkOffset};

/// Options of every job.
#[derive(Debug, Clone, Args)]
pub struct Shared {
    /// What decides the output.
    #[command(flatten)]
    pub job: JobOptions,
    /// What is said meanwhile.
    #[command(flatten)]
    pub messages: MessageOptions,
}

/// What decides the output of a job besides the program; a manifest keeps it.
#[derive(Debug, Clone, Default, PartialEq, Args, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct JobOptions {
    /// Machine profile (TOML).
    #[arg(short = 'm', long = "machine", value_name = "PROFILE", global = true, help_heading = "Machine")]
    pub machine: Option<PathBuf>,
    /// Correction engine; default: the profile's.
    #[arg(short, long, value_name = "ENGINE", global = true, help_heading = "Machine")]
    pub engine: Option<Given<EngineId>>,
    /// Dialect of the control; default: the profile's.
    ///
    /// A name of `vpost grammar list`, or a grammar file.
    #[arg(short, long, value_name = "DIALECT", global = true, help_heading = "Program")]
    pub dialect: Option<String>,
    /// Largest path deviation, um.
    ///
    /// Rounding of the output apart.
    #[arg(long, value_name = "UM", global = true, help_heading = "Program", value_parser = finite)]
    pub tolerance: Option<f64>,
    /// Machine coordinates of a zero, mm (repeatable).
    #[arg(
        long = "work-offset",
        value_name = "G54=X,Y,Z",
        global = true,
        help_heading = "Program",
        allow_hyphen_values = true
    )]
    pub work_offset: Vec<Given<WorkOffset>>,
    /// Length of an H number, mm (repeatable).
    ///
    /// H1=120, or the vector H1=0,0,120.
    #[arg(
        long,
        value_name = "H1=LENGTH",
        global = true,
        help_heading = "Program",
        allow_hyphen_values = true
    )]
    pub tool: Vec<Given<ToolLength>>,
    /// Where the axes stand at the start, mm.
    ///
    /// Machine coordinates.
    #[arg(
        long = "start-at",
        value_name = "X,Y,Z",
        global = true,
        help_heading = "Program",
        allow_hyphen_values = true
    )]
    pub start_at: Option<Given<Point3>>,
    /// Variable that the program does not set.
    ///
    /// Repeatable: `#500=12.5`, `#<depth>=2`, `#1=#0` for empty. Quote it for the shell.
    #[arg(
        long,
        value_name = "#N=VALUE",
        global = true,
        help_heading = "Program",
        allow_hyphen_values = true
    )]
    pub set: Vec<Given<Preset>>,
    /// Folder of subprograms (repeatable).
    ///
    /// Those that the program calls by number or name.
    #[arg(long, value_name = "DIR", global = true, help_heading = "Program")]
    pub include: Vec<PathBuf>,
    /// What Z10 is: increments or millimetres.
    ///
    /// Where the dialect reads increments: `increments` (ten steps) or `millimetres` (Z10.; inches under G20); default: the
    /// profile's.
    #[arg(
        long,
        value_enum,
        value_name = "MEANING",
        global = true,
        hide_possible_values = true,
        help_heading = "Program"
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub decimal: Option<Decimal>,
    /// Refuse doubtful programs.
    ///
    /// Those that are warned of: cut off, unknown M codes, no unit, lengths without a point.
    #[arg(long, global = true, help_heading = "Program")]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub strict: bool,
    /// Put in blocks that stop where offsets differ.
    ///
    /// Where the control's work offsets (LinuxCNC: and tool lengths) are others than it was corrected for.
    #[arg(long, global = true, help_heading = "Program")]
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub guard: bool,
    /// Conditions: temp_c=24, time_s=600 … (repeatable).
    ///
    /// Those that effects of the profile depend on: temp_c (temp_x_c …), time_s, load_kg, feed_mm_min.
    #[arg(
        long = "at",
        value_name = "NAME=VALUE,…",
        global = true,
        help_heading = "Machine",
        allow_hyphen_values = true
    )]
    pub at: Vec<Given<Conditions>>,
    /// Beyond the volume: refuse, or clamp to its edge.
    ///
    /// Feed motion outside the calibrated volume: refuse it, or take the nearest point's correction.
    #[arg(long, value_enum, global = true, hide_possible_values = true, help_heading = "Machine")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outside: Option<Outside>,
}

impl JobOptions {
    /// The engine asked for.
    #[must_use]
    pub fn engine(&self) -> Option<EngineId> {
        self.engine.as_deref().copied()
    }
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
    /// Of `vpost explain`; LC_ALL, LC_MESSAGES, LANG say it otherwise.
    #[arg(id = "lang", long = "lang", value_name = "LANG", global = true, help_heading = "Messages")]
    pub language: Option<Given<Language>>,
}

/// Feed motion outside the calibrated volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outside {
    /// An error.
    Refuse,
    /// The nearest point's correction.
    Clamp,
}

/// A length without a decimal point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Decimal {
    /// Least increments.
    Increments,
    /// The unit in force.
    Millimetres,
}

/// Colours in messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Color {
    /// On a terminal.
    Auto,
    /// Always.
    Always,
    /// Never.
    Never,
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
}

/// `vpost solve`
#[derive(Debug, Args)]
pub struct Solve {
    /// Target points (CSV); - for standard input.
    #[arg(value_name = "POINTS.csv")]
    pub points: PathBuf,
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
    /// Write the model in a form that a control takes.
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

/// A number of an option: neither `inf` nor `NaN`, which would pass every check of a range from one side.
///
/// # Errors
/// What was expected.
pub fn finite(text: &str) -> Result<f64, Unread> {
    number(text, |_| true).ok_or_else(|| Unread::number("a finite number is expected"))
}

fn number(text: &str, may_be: impl Fn(f64) -> bool) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|value| value.is_finite() && may_be(*value))
}

/// A size of an option: above zero, and no larger than a metre in micrometres, beyond which it is a slip.
///
/// # Errors
/// What was expected.
pub fn size(text: &str) -> Result<f64, Unread> {
    number(text, |value| value > 0.0 && value <= 1e6)
        .ok_or_else(|| Unread::number("a number above 0, at most 1000000, is expected"))
}

/// A size of an option that may be zero.
///
/// # Errors
/// What was expected.
pub fn size_or_zero(text: &str) -> Result<f64, Unread> {
    number(text, |value| (0.0..=1e6).contains(&value))
        .ok_or_else(|| Unread::number("a number from 0 to 1000000 is expected"))
}
