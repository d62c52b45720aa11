//! What `vpost profile new` may be given.

use std::path::PathBuf;

use clap::Args;

use crate::values::{AxisTable, Centre, Given, Sense, Travel};

/// `vpost profile new`
#[derive(Debug, Args)]
pub struct New {
    /// Name of the machine; at a terminal vpost asks for what is not given.
    #[arg(long)]
    pub name: Option<String>,
    /// Dialect of the control, see `vpost grammar list`.
    #[arg(long, value_name = "DIALECT")]
    pub control: Option<String>,
    /// Travel of a linear axis, mm; one for each.
    #[arg(long, value_name = "X=LOW..HIGH", allow_hyphen_values = true)]
    pub travel: Vec<Given<Travel>>,
    /// What the control says of itself: LinuxCNC's INI, or an MTConnect `probe`.
    #[arg(long, value_name = "FILE")]
    pub from: Option<PathBuf>,
    /// Which device of the `probe`, where it has several.
    #[arg(long, value_name = "NAME", requires = "from")]
    pub device: Option<String>,
    /// Axes from workpiece to tool, b the bed; `[w X Y b Z t]` if not given.
    #[arg(long)]
    pub chain: Option<String>,
    /// Step of the coordinates that the control takes, mm.
    #[arg(long, value_name = "MM", default_value_t = 0.001)]
    pub resolution: f64,
    /// Table of an axis' errors, relative to the profile.
    #[arg(long, value_name = "X=FILE")]
    pub table: Vec<Given<AxisTable>>,
    /// A point of a rotary axis' line, machine coordinates; one for each.
    #[arg(long, value_name = "C=X,Y,Z", allow_hyphen_values = true)]
    pub centre: Vec<Given<Centre>>,
    /// Plus turns a rotary axis right or left about its letter's direction; one for each.
    ///
    /// right: the side of a table towards +Y goes towards +Z (A), +X towards -Z (B), +X towards +Y (C); left: the other way, as
    /// ISO 841 has it of tables.
    #[arg(long, value_name = "C=right")]
    pub sense: Vec<Given<Sense>>,
    /// The profile; a file that is there is left alone.
    #[arg(short = 'o', long, value_name = "PROFILE.toml")]
    pub output: Option<PathBuf>,
}
