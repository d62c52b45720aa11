//! The command line.

use std::path::PathBuf;

use clap::{Args, CommandFactory, Parser, Subcommand, ValueEnum};
use serde::{Deserialize, Serialize};

use crate::message::Failure;

/// Rewrites NC programs so that a measured machine goes where the program says.
#[derive(Debug, Parser)]
#[command(name = "vpost", version, args_conflicts_with_subcommands = true, subcommand_negates_reqs = true)]
#[command(
    after_help = "Exit status: 0 done; 1 refused or a check failed (nothing is written); 2 usage, profile or grammar error; 130/143 interrupted.\nExample: vpost in.nc -m machine-profiles/stan_s500.toml > out.nc"
)]
pub struct Arguments {
    /// The work.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// The main job.
    #[command(flatten)]
    pub correct: Correct,
    /// What all jobs share.
    #[command(flatten)]
    pub shared: Shared,
}

/// What is asked for besides the main job.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Correct many programs, on all cores or on many machines.
    Batch(crate::batch::Batch),
    /// Run two programs through the machine model and compare the tool paths.
    Check(Check),
    /// Where the machine really goes for commanded points.
    Predict(Predict),
    /// What to command so that the tool reaches points.
    Solve(Solve),
    /// Make a machine profile from an instrument's files.
    Calibrate(crate::calibrate::Calibrate),
    /// Which unmodelled effect explains the gap between the model and measurements.
    Diagnose(crate::diagnose::Diagnose),
    /// The volumetric error over the volume, and where to put the zero point and the workpiece.
    Map(crate::map::Map),
    /// What each deviation of the machine costs, what they may come to together, and what each may be.
    Budget(crate::budget::Budget),
    /// Check, show or describe machine profiles.
    Profile(Profile),
    /// List or check dialect tables.
    Grammar(Grammar),
    /// Completions for a shell.
    Completions(Completions),
    /// The manual page (roff).
    Man,
}

/// Options of every job.
#[derive(Debug, Clone, Args)]
pub struct Shared {
    /// Machine profile (TOML).
    #[arg(short = 'm', long = "machine", value_name = "PROFILE", global = true)]
    pub machine: Option<PathBuf>,
    /// Correction engine; default: the profile's.
    #[arg(short, long, value_name = "ENGINE", global = true)]
    pub engine: Option<String>,
    /// Dialect: a name of `vpost grammar list`, or a grammar file; default: the profile's control.
    #[arg(short, long, value_name = "DIALECT", global = true)]
    pub dialect: Option<String>,
    /// Largest path deviation, µm, rounding of the output apart.
    #[arg(long, value_name = "UM", global = true, value_parser = finite)]
    pub tolerance: Option<f64>,
    /// Machine coordinates of a work offset's zero, mm: G54=X,Y,Z (repeatable).
    #[arg(long = "work-offset", value_name = "G54=X,Y,Z", global = true, allow_hyphen_values = true)]
    pub work_offset: Vec<String>,
    /// Tool length or length vector of an H number, mm: H1=120 or H1=0,0,120 (repeatable).
    #[arg(long, value_name = "H1=LENGTH|X,Y,Z", global = true, allow_hyphen_values = true)]
    pub tool: Vec<String>,
    /// Where the axes stand at the start of the program, machine coordinates, mm.
    #[arg(long = "start-at", value_name = "X,Y,Z", global = true, allow_hyphen_values = true)]
    pub start_at: Option<String>,
    /// Value of a variable that the program does not set itself: `#500=12.5`, `#<depth>=2`, `#1=#0` for empty (repeatable).
    /// Quote it for the shell.
    #[arg(long, value_name = "#N=VALUE", global = true, allow_hyphen_values = true)]
    pub set: Vec<String>,
    /// Folder of subprograms that the program calls by number or name (repeatable).
    #[arg(long, value_name = "DIR", global = true)]
    pub include: Vec<PathBuf>,
    /// What a length without a decimal point is, where the dialect reads increments: `increments` (Z10 is ten steps) or
    /// `millimetres` (Z10 is Z10.; inches under G20); default: the profile's.
    #[arg(long, value_enum, value_name = "MEANING", global = true)]
    pub decimal: Option<Decimal>,
    /// Refuse programs that are warned of as doubtful: cut off, unknown M codes, no unit, lengths without a point.
    #[arg(long, global = true)]
    pub strict: bool,
    /// Conditions that effects of the profile depend on: temp_c (temp_x_c …), time_s, load_kg, feed_mm_min (repeatable).
    #[arg(long = "at", value_name = "NAME=VALUE,…", global = true, allow_hyphen_values = true)]
    pub at: Vec<String>,
    /// Feed motion outside the calibrated volume: refuse it, or take the nearest point's correction.
    #[arg(long, value_enum, global = true)]
    pub outside: Option<Outside>,
    /// No warnings.
    #[arg(short, long, global = true)]
    pub quiet: bool,
    /// More about what is done, on standard error (repeatable).
    #[arg(short, long, action = clap::ArgAction::Count, global = true)]
    pub verbose: u8,
    /// Colours in messages.
    #[arg(long, value_enum, default_value_t = Color::Auto, global = true)]
    pub color: Color,
}

/// Feed motion outside the calibrated volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
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
    /// Write to this file, all or nothing, instead of standard output.
    #[arg(short, long, value_name = "OUT.nc")]
    pub output: Option<PathBuf>,
    /// Write a summary for pipelines (JSON).
    #[arg(long, value_name = "FILE")]
    pub summary: Option<PathBuf>,
    /// Correct a program that says it was corrected before.
    #[arg(long)]
    pub force: bool,
    /// Put in blocks that stop the program where the control's work offsets (LinuxCNC: and tool lengths) are others
    /// than it was corrected for.
    #[arg(long)]
    pub guard: bool,
    /// Report progress in this style on standard error.
    #[arg(long, value_enum)]
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

/// Prints completions.
pub(crate) fn completions(arguments: &Completions) -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut Arguments::command(), "vpost", &mut text);
    crate::file::print(&text)
}

/// Prints the manual page.
pub(crate) fn man() -> Result<(), Failure> {
    let mut text = Vec::new();
    clap_mangen::Man::new(Arguments::command())
        .render(&mut text)
        .map_err(|error| Failure::file("standard output", "write", &error))?;
    crate::file::print(&text)
}

/// A number of an option: neither `inf` nor `NaN`, which would pass every check of a range from one side.
///
/// # Errors
/// What was expected.
pub fn finite(text: &str) -> Result<f64, String> {
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err("expected a finite number".to_owned()),
    }
}

/// A size of an option: above zero, and no larger than a metre in micrometres, beyond which it is a slip.
///
/// # Errors
/// What was expected.
pub fn size(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|v| *v > 0.0 && *v <= 1e6)
        .ok_or_else(|| "expected a number above 0, at most 1000000".to_owned())
}

/// A size of an option that may be zero.
///
/// # Errors
/// What was expected.
pub fn size_or_zero(text: &str) -> Result<f64, String> {
    finite(text)
        .ok()
        .filter(|v| *v >= 0.0 && *v <= 1e6)
        .ok_or_else(|| "expected a number from 0 to 1000000".to_owned())
}
