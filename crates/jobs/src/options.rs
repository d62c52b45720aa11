//! What decides the output of a job besides the program: options, as the command line and a manifest spell them.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use diagnostic::{Text, both, notice};
use machine_model::EngineId;
use nc_expand::Preset;
use serde::{Deserialize, Serialize};

use crate::message::{Failure, OPTION};
use crate::values::{Conditions, Given, Start, ToolLength, Unread, WorkOffset};

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
    /// Largest deviation where that fails, um.
    ///
    /// Where the tolerance cannot be held, the motion is corrected as near as can be, up to this, and said; 15
    /// tolerances if not given, 0: refused.
    #[arg(long, value_name = "UM", global = true, help_heading = "Program", value_parser = finite)]
    pub accept: Option<f64>,
    /// Machine coordinates of a zero, mm (repeatable).
    #[arg(
        long = "work-offset",
        value_name = "G54=X,Y,Z",
        global = true,
        help_heading = "Program",
        allow_hyphen_values = true
    )]
    pub work_offset: Vec<Given<WorkOffset>>,
    /// What work offsets are: touched or true.
    ///
    /// Those that do not say it themselves: touched on this machine with correction off, so that its error at that
    /// place is in them, or found through a compensation or by an outside instrument; default: the profile's, else
    /// touched.
    #[arg(
        long,
        value_enum,
        value_name = "HOW",
        global = true,
        hide_possible_values = true,
        help_heading = "Program"
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub zero: Option<Zero>,
    /// Where a zero was touched, mm (repeatable).
    ///
    /// Axis commands (machine coordinates, the tool's length added); the program's zero where left out.
    #[arg(
        long = "touched-at",
        value_name = "G54=X,Y,Z",
        global = true,
        help_heading = "Program",
        allow_hyphen_values = true
    )]
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub touched_at: Vec<Given<WorkOffset>>,
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
    /// Tool lengths: CSV, a dump of G10, or .tbl.
    ///
    /// Of the control or a presetter, instead of the profile's: tool,length_mm; G10 L10 P1 R120.5; LinuxCNC's.
    #[arg(long = "tool-table", value_name = "FILE", global = true, help_heading = "Program")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool_table: Option<PathBuf>,
    /// Zeros and lengths of a LinuxCNC machine.
    ///
    /// Its parameters and its tool table, as they were written last, instead of the profile's.
    #[arg(long = "linuxcnc-ini", value_name = "FILE", global = true, help_heading = "Program")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub linuxcnc_ini: Option<PathBuf>,
    /// Where the axes stand at the start, mm.
    ///
    /// Machine coordinates; of some axes, and of rotary ones in degrees: `Z=300,A=0,C=90`.
    #[arg(
        long = "start-at",
        value_name = "X,Y,Z",
        global = true,
        help_heading = "Program",
        allow_hyphen_values = true
    )]
    pub start_at: Option<Given<Start>>,
    /// Variable that the program does not set.
    ///
    /// Repeatable: `#500=12.5`, `#<depth>=2`, `R5=12.5` (Sinumerik), `#1=#0` for empty. Quote it for the shell.
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
    /// Where the dialect reads increments: `increments` (ten steps) or `millimetres` (Z10.; inches under G20); default:
    /// the profile's.
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
    /// The control's corners: keep, tolerance or exact.
    ///
    /// What the program says (keep); or in front of feeds the control's words for a tolerance (tolerance: half of
    /// `--tolerance` is the control's, half the machine's) or for exact stops (exact).
    #[arg(
        long = "path-control",
        value_enum,
        value_name = "HOW",
        global = true,
        hide_possible_values = true,
        help_heading = "Program"
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub path_control: Option<PathControl>,
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
    /// What is corrected on five axes: xyz or full.
    ///
    /// The tip alone, its rotary words as they are (xyz), or the tool's direction too (full); default: the profile's,
    /// else xyz.
    #[arg(
        long,
        value_enum,
        value_name = "AXES",
        global = true,
        hide_possible_values = true,
        help_heading = "Program"
    )]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Orientation>,
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

    /// These options, and where they say nothing those of `below`.
    #[must_use]
    pub fn over(&self, below: &Self) -> Self {
        let said = |options: &Self| match serde_json::to_value(options) {
            Ok(serde_json::Value::Object(said)) => said,
            _ => serde_json::Map::new(),
        };
        let silent = said(&Self::default());
        let mut all = said(below);
        all.extend(said(self).into_iter().filter(|(name, value)| silent.get(name) != Some(value)));
        serde_json::from_value(serde_json::Value::Object(all)).expect("both were options")
    }

    /// Reads options that are written as on a command line, `--work-offset=G54=100,50,0`.
    ///
    /// # Errors
    /// What the command says of them.
    pub fn read(words: impl IntoIterator<Item = OsString>) -> Result<Self, Failure> {
        read(words)
    }
}

/// The options of every job, and those of one.
#[derive(Debug, Args)]
pub struct Whole<T: Args> {
    /// Of every job.
    #[command(flatten)]
    pub job: JobOptions,
    /// Of this one.
    #[command(flatten)]
    pub own: T,
}

/// Reads a file that an option names: from the disk, or of what was given with the options.
pub type Read<'a> = &'a dyn Fn(&Path) -> Result<Vec<u8>, Failure>;

/// Reads options that are written as on a command line.
///
/// # Errors
/// What the command says of them.
pub fn read<T: Args>(words: impl IntoIterator<Item = OsString>) -> Result<T, Failure> {
    let command = T::augment_args(clap::Command::new("vpost").no_binary_name(true).disable_help_flag(true));
    let read = command.try_get_matches_from(words).and_then(|matches| T::from_arg_matches(&matches));
    read.map_err(|error| misread(&error))
}

/// What the command says of options that cannot be read.
#[must_use]
pub fn misread(error: &clap::Error) -> Failure {
    unread(error).unwrap_or_else(|| {
        let text = error.to_string();
        let first = text.lines().next().unwrap_or_default();
        Failure::usage(notice!(OPTION;
            Text::english_only(first.trim_start_matches("error: "));
            "see docs/reference.md for what it takes", "что он принимает, сказано в docs/reference.md"
        ))
    })
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

/// How work offsets were found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Zero {
    /// On this machine, with correction off.
    Touched,
    /// Through a compensation, or by an outside instrument.
    True,
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

/// How near the control is told to keep to the path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PathControl {
    /// As the program says.
    Keep,
    /// Within half the tolerance.
    Tolerance,
    /// With exact stops.
    Exact,
}

/// What is corrected on five axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Orientation {
    /// The tip alone.
    Xyz,
    /// The tool's direction too.
    Full,
}

/// A number of an option: neither `inf` nor `NaN`, which would pass every check of a range from one side.
///
/// # Errors
/// What was expected.
pub fn finite(text: &str) -> Result<f64, Unread> {
    number(text, |_| true)
        .ok_or_else(|| Unread::number(both!("a finite number is expected", "ожидалось конечное число")))
}

fn number(text: &str, may_be: impl Fn(f64) -> bool) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|value| value.is_finite() && may_be(*value))
}

/// A size of an option: above zero, and no larger than a metre in micrometres, beyond which it is a slip.
///
/// # Errors
/// What was expected.
pub fn size(text: &str) -> Result<f64, Unread> {
    number(text, |value| value > 0.0 && value <= 1e6).ok_or_else(|| {
        Unread::number(both!(
            "a number above 0, at most 1000000, is expected",
            "ожидалось число больше 0 и не больше 1000000"
        ))
    })
}

/// A size of an option that may be zero.
///
/// # Errors
/// What was expected.
pub fn size_or_zero(text: &str) -> Result<f64, Unread> {
    number(text, |value| (0.0..=1e6).contains(&value)).ok_or_else(|| {
        Unread::number(both!("a number from 0 to 1000000 is expected", "ожидалось число от 0 до 1000000"))
    })
}

/// A value that an option cannot take, said as all failures are; `None` where the command line is wrong otherwise.
#[must_use]
pub fn unread(error: &clap::Error) -> Option<Failure> {
    let text = |kind| match error.get(kind)? {
        clap::error::ContextValue::String(text) => Some(text.as_str()),
        _ => None,
    };
    if error.kind() != clap::error::ErrorKind::ValueValidation {
        return None;
    }
    // `--work-offset <G54=X,Y,Z>`
    let option = text(clap::error::ContextKind::InvalidArg)?.split(' ').next()?;
    let given = text(clap::error::ContextKind::InvalidValue)?;
    let why = std::error::Error::source(error)?;
    Some(match why.downcast_ref::<Unread>() {
        Some(unread) => Failure::option(unread.message(option, given), unread.help(option)),
        None => Failure::usage(notice!(OPTION;
            "`{option} {given}`: {why}", "`{option} {given}`: {why}";
            "see `--help` for what the option takes", "что принимает ключ, скажет `--help`"
        )),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::message::Wording;

    fn read(words: &[&str]) -> Result<JobOptions, String> {
        JobOptions::read(words.iter().map(OsString::from)).map_err(|failure| Wording::plain().text(&failure))
    }

    #[test]
    fn options_are_read_as_the_command_reads_them() {
        let options =
            read(&["--work-offset=G54=-1,2,3", "--tool=H2=100", "--outside=clamp", "--strict"]).unwrap();
        assert_eq!(options.work_offset[0].zero_mm, [-1.0, 2.0, 3.0]);
        assert_eq!(options.tool[0].vector_mm, [0.0, 0.0, 100.0]);
        assert_eq!((options.outside, options.strict), (Some(Outside::Clamp), true));
    }

    #[test]
    fn what_cannot_be_read_is_said_in_the_words_of_the_command() {
        let text = read(&["--work-offset=G54=1,2"]).unwrap_err();
        assert!(text.starts_with("error[VP0002]: `--work-offset G54=1,2` cannot be read"), "{text}");
        let text = read(&["--outside=perhaps"]).unwrap_err();
        assert!(text.contains("perhaps") && text.contains("--outside"), "{text}");
    }
}
