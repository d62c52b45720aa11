//! Options of `vpost calibrate interferometer`.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use machine_model::Interpolation;
use measurement_files::series::Values;

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
    /// What the numbers of a control's table are.
    #[arg(long, value_parser = values())]
    pub values: Option<Values>,
    /// Squareness as the instrument gave it, µrad: XY=12,ZX=-3,YZ=5; what is left out stays as it is.
    #[arg(long, value_name = "XY=…,ZX=…,YZ=…", allow_hyphen_values = true)]
    pub squareness: Option<Given<SquarenessReadings>>,
    /// What a positive squareness means to the instrument.
    #[arg(long, value_enum)]
    pub squareness_convention: Option<Convention>,
    /// Slopes of the straightness curves: part of what was read as squareness (they are taken off), or not.
    #[arg(long, value_enum)]
    pub straightness_slopes: Option<Slopes>,
    /// Two directions: a table for each, or the mean and one reversal value.
    #[arg(long, value_enum, default_value_t = Directions::Tables)]
    pub directions: Directions,
    /// Where the tables of axes that carry the workpiece were defined (ISG CSV).
    #[arg(long, value_enum)]
    pub reference: Option<Reference>,
    /// Machine position through which the measured lines ran, mm.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub through: Option<Given<Point3>>,
    /// From the gauge point to the optics that moved, mm.
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub optics: Option<Given<Point3>>,
    /// Write finer tables, with this step.
    #[arg(long, value_name = "MM", value_parser = crate::arguments::size)]
    pub refine: Option<f64>,
    /// How finer tables, and the profile, go between the targets.
    #[arg(long, value_enum, default_value_t = Between::Linear)]
    pub interpolation: Between,
    /// Relative standard uncertainty of the instrument, µm/m.
    #[arg(long, value_name = "UM_PER_M", default_value_t = 0.5, value_parser = crate::arguments::size_or_zero)]
    pub u_um_per_m: f64,
    #[command(flatten)]
    pub shown: Shown,
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

/// `--values`
fn values() -> impl TypedValueParser<Value = Values> {
    const ALL: [(&str, Values, &str); 3] = [
        ("positions", Values::Positions, "Where the axis really was (LinuxCNC COMP_FILE_TYPE = 0)"),
        ("errors", Values::Errors, "Actual minus nominal"),
        (
            "corrections",
            Values::Corrections,
            "What the control adds: nominal minus actual (LinuxCNC COMP_FILE_TYPE = 1)",
        ),
    ];
    let names = ALL.map(|(name, _, help)| PossibleValue::new(name).help(help));
    PossibleValuesParser::new(names).try_map(|given| {
        ALL.into_iter().find(|(name, ..)| *name == given).map(|(_, values, _)| values).ok_or("unknown")
    })
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
