//! The command line of `vpost budget`.

use std::path::PathBuf;

use clap::Args;

use crate::values::{Ball, Given, Lattice, Rotary, ToolVector};

/// `vpost budget`
#[derive(Debug, Args)]
pub struct Budget {
    /// Control points: nodes of X, Y and Z, how many over the calibrated volume (22x22x21), or from:to:step in mm for each
    /// (40:880:40,30:450:20,5:505:25).
    #[arg(long, value_name = "NXxNYxNZ|X,Y,Z", default_value = "21x21x21", allow_hyphen_values = true)]
    pub grid: Given<Lattice>,
    /// Control points of a file instead (CSV, as for `vpost predict`); - for standard input.
    #[arg(long, value_name = "POINTS.csv", conflicts_with_all = ["grid", "rotary"])]
    pub points: Option<PathBuf>,
    /// Control points: a ball on the rotary table, at a radius and a height from its centre, mm, which the linear axes
    /// follow through the angles of both rotary axes in steps of 30 degrees; the leading axis turns slowest.
    #[arg(long, value_name = "R=MM,H=MM,lead=AXIS", allow_hyphen_values = true, conflicts_with_all = ["grid", "rotary", "points"])]
    pub ball: Option<Given<Ball>>,
    /// Tool vector, gauge point to tip, mm: an H number of the profile or X,Y,Z; default: the profile's.
    #[arg(long, value_name = "H1|X,Y,Z", allow_hyphen_values = true)]
    pub tool_vector: Option<Given<ToolVector>>,
    /// Where the rotary axes stand at the nodes of the grid, degrees; 0 if not given.
    #[arg(long, value_name = "A=DEG,…", allow_hyphen_values = true)]
    pub rotary: Option<Given<Rotary>>,
    /// Count errors from this zero of the profile, as it was touched.
    #[arg(long, value_name = "G54")]
    pub datum: Option<String>,
    /// Wanted M, largest error at the control points, µm: what to mend, and what each deviation may be.
    #[arg(long, value_name = "UM", allow_hyphen_values = true)]
    pub target: Option<f64>,
    /// Deviations that stay as they are while the others are made smaller: EXX,EC0Y (repeatable).
    #[arg(long, value_name = "NAME,…", requires = "target")]
    pub keep: Vec<String>,
    /// Write all figures (JSON).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
}
