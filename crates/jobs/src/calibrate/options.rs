//! Options of `vpost calibrate interferometer`.

use std::path::PathBuf;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use machine_model::Interpolation;
use measurement_files::series::{Values, Ways};

use super::output::Target;
use super::page::Shown;
use crate::values::{Given, Point3, SquarenessReadings};

/// `vpost calibrate interferometer FILES… -o PROFILE`
#[derive(Debug, Args)]
pub struct Interferometer {
    /// Files with runs or tables. Where a file does not say what it holds: FILE=EXX:um.
    #[arg(value_name = "FILE[=SYMBOL[:UNIT]]", required_unless_present = "squareness")]
    pub files: Vec<String>,
    #[command(flatten)]
    pub target: Target,
    /// Of a control: positions, errors, corrections.
    ///
    /// What the numbers of its table are.
    #[arg(long, value_name = "WHAT", value_parser = values(), hide_possible_values = true, help_heading = "Tables")]
    pub values: Option<Values>,
    /// Ways of runs: alternating, up or down.
    ///
    /// Which way the axis went in the columns of a table whose titles do not say it.
    #[arg(long, value_name = "HOW", value_parser = ways(), hide_possible_values = true, help_heading = "Tables")]
    pub runs: Option<Ways>,
    /// As the instrument gave it, µrad.
    ///
    /// XY=12,ZX=-3,YZ=5; what is left out stays as it is.
    #[arg(long, value_name = "XY=…,ZX=…,YZ=…", allow_hyphen_values = true, help_heading = "Squareness")]
    pub squareness: Option<Given<SquarenessReadings>>,
    /// Plus is right-handed or larger-than90.
    ///
    /// What a positive squareness means to the instrument.
    #[arg(long, value_name = "HOW", value_enum, hide_possible_values = true, help_heading = "Squareness")]
    pub squareness_convention: Option<Convention>,
    /// Slopes of the curves: remove or keep.
    ///
    /// Whether slopes of the straightness curves are part of what was read as squareness, and are taken off.
    #[arg(long, value_name = "HOW", value_enum, hide_possible_values = true, help_heading = "Squareness")]
    pub straightness_slopes: Option<Slopes>,
    /// Two directions: tables or mean.
    ///
    /// A table for each, or the mean and one reversal value.
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Directions::Tables, hide_possible_values = true, help_heading = "Tables")]
    pub directions: Directions,
    /// ISG, axes under the part: line or carriage.
    ///
    /// Where the tables of axes that carry the workpiece were defined (ISG CSV).
    #[arg(long, value_name = "WHERE", value_enum, hide_possible_values = true, help_heading = "Tables")]
    pub reference: Option<Reference>,
    /// Machine position on the measured lines, mm.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, help_heading = "Tables")]
    pub through: Option<Given<Point3>>,
    /// From the gauge point to the moving optics, mm.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, help_heading = "Tables")]
    pub optics: Option<Given<Point3>>,
    /// Write finer tables, with this step.
    #[arg(long, value_name = "MM", value_parser = crate::options::size, help_heading = "Tables")]
    pub refine: Option<f64>,
    /// Between targets: linear, monotone.
    ///
    /// How finer tables, and the profile, go there.
    #[arg(long, value_name = "HOW", value_enum, default_value_t = Between::Linear, hide_possible_values = true, hide_default_value = true, help_heading = "Tables")]
    pub interpolation: Between,
    /// Standard uncertainty of the instrument, µm/m; 0.5.
    #[arg(long, value_name = "U", default_value_t = 0.5, value_parser = crate::options::size_or_zero, hide_default_value = true, help_heading = "Tables")]
    pub u_um_per_m: f64,
    #[command(flatten)]
    pub shown: Shown,
}

impl Interferometer {
    /// The files without what they hold.
    pub(super) fn paths(&self) -> Vec<PathBuf> {
        self.files.iter().map(|name| PathBuf::from(super::sources::path_of(name))).collect()
    }
}

/// What a positive squareness means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Convention {
    /// A right-handed turn, as in ISO 230-1: ZX positive where the angle is below 90°.
    RightHanded,
    /// An angle above 90° in every plane.
    LargerThan90,
}

/// Slopes of straightness curves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Slopes {
    /// They say the same as the squareness: take them off.
    Remove,
    /// The squareness was measured against the curves as they are: keep them.
    Keep,
}

/// Where the tables of an axis that carries the workpiece were defined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Reference {
    /// Along the measured line, as an interferometer reads.
    Line,
    /// At the carriage: a rotation acts on the axis' own travel.
    Carriage,
}

/// One of these, by name.
fn one_of<T: Copy + Send + Sync + 'static, const N: usize>(
    all: [(&'static str, T, &'static str); N],
) -> impl TypedValueParser<Value = T> {
    let names = all.map(|(name, _, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(names).try_map(move |given| {
        all.into_iter().find(|(name, ..)| *name == given).map(|(_, one, _)| one).ok_or("unknown")
    })
}

/// `--values`
fn values() -> impl TypedValueParser<Value = Values> {
    one_of([
        ("positions", Values::Positions, "Where the axis really was (LinuxCNC COMP_FILE_TYPE = 0)"),
        ("errors", Values::Errors, "Actual minus nominal"),
        (
            "corrections",
            Values::Corrections,
            "What the control adds: nominal minus actual (LinuxCNC COMP_FILE_TYPE = 1)",
        ),
    ])
}

/// `--runs`
fn ways() -> impl TypedValueParser<Value = Ways> {
    one_of([
        ("alternating", Ways::Alternating, "The first towards plus, the next towards minus, and so on"),
        ("up", Ways::Up, "All towards plus"),
        ("down", Ways::Down, "All towards minus"),
    ])
}

/// What becomes of two directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Directions {
    /// `errors` and `errors_negative`.
    Tables,
    /// `errors` is the mean, `backlash_um` the mean reversal value.
    Mean,
}

/// Between the targets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Between {
    /// Straight lines.
    Linear,
    /// A cubic that keeps the shape.
    Monotone,
}

impl Between {
    pub(super) fn interpolation(self) -> Interpolation {
        match self {
            Self::Linear => Interpolation::Linear,
            Self::Monotone => Interpolation::Monotone,
        }
    }
}

/// `vpost calibrate rtest FILES… -m PROFILE -o OUT`
#[derive(Debug, Args)]
pub struct RTest {
    /// Ball deviations (CSV): run, one mounting of the ball; x_mm … z_mm, a_deg … c_deg commanded; dx_um dy_um dz_um,
    /// workpiece frame; tool_x_mm …, dir_a …, u_um or u_x_um …, repeat, temp_c where known.
    #[arg(value_name = "ROWS.csv", required = true)]
    pub files: Vec<PathBuf>,
    #[command(flatten)]
    pub target: Target,
    /// The rows are places at which a touch probe was centred on a sphere fixed to the workpiece: no dx_um dy_um dz_um.
    #[arg(long)]
    sphere: bool,
    /// Rows that no fit sees judge the profile; one that makes them worse is not written.
    #[arg(long, value_name = "HELD.csv")]
    pub holdout: Option<PathBuf>,
    /// Write what was found, with covariance, as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}

/// How the rotary axes were measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RTestMethod {
    /// Deviations of a ball in its nest, by an R-test.
    Deviations,
    /// Places at which a touch probe was centred on a sphere.
    Sphere,
}

impl RTest {
    /// How the rows were measured.
    #[must_use]
    pub fn method(&self) -> RTestMethod {
        if self.sphere { RTestMethod::Sphere } else { RTestMethod::Deviations }
    }
}
