//! The command line of `vpost map`.

use std::path::PathBuf;

use clap::Args;

use crate::values::{Given, Lattice, Layer, NamedRegion, Region3, Rotary, Size3, ToolVector};

/// `vpost map`
#[derive(Debug, Args)]
pub struct Map {
    /// Nodes: how many (22x22x21), or from:to:step of each axis, mm.
    ///
    /// Of X, Y and Z, over the calibrated volume, or like 40:880:40,30:450:20,5:505:25.
    #[arg(long, value_name = "NXxNYxNZ|X,Y,Z", default_value = "21x21x21", allow_hyphen_values = true)]
    pub grid: Given<Lattice>,
    /// Tool vector, gauge point to tip, mm: an H number of the profile or X,Y,Z; default: the profile's.
    #[arg(long, value_name = "H1|X,Y,Z", allow_hyphen_values = true)]
    pub tool_vector: Option<Given<ToolVector>>,
    /// Where the rotary axes stand, degrees; 0 if not given.
    #[arg(long, value_name = "A=DEG,…", allow_hyphen_values = true)]
    pub rotary: Option<Given<Rotary>>,
    /// Tolerance for the share of nodes within it, µm.
    #[arg(long, value_name = "UM", default_value_t = 20.0, value_parser = crate::arguments::size)]
    pub within: f64,
    /// A part of the volume to give figures and zero points for, mm (repeatable).
    #[arg(long, value_name = "NAME=X0..X1,Y0..Y1,Z0..Z1", allow_hyphen_values = true)]
    pub region: Vec<Given<NamedRegion>>,
    /// The same for a layer of nodes, at a place of the third axis in mm, or for every layer (repeatable).
    #[arg(long, value_name = "XY=Z|XZ=Y|YZ=X|XY|XZ|YZ", allow_hyphen_values = true)]
    pub plane: Vec<Given<Layer>>,
    /// The same for a workpiece, where its axis commands lie, mm.
    #[arg(long, value_name = "X0..X1,Y0..Y1,Z0..Z1", allow_hyphen_values = true)]
    pub part_box: Option<Given<Region3>>,
    /// Find the place for a workpiece of this size, mm.
    ///
    /// Where shifting and turning it leave least.
    #[arg(long, value_name = "LX,LY,LZ")]
    pub clamp: Option<Given<Size3>>,
    /// At which angles products of errors begin to matter.
    ///
    /// And what the order of rotations changes.
    #[arg(long)]
    pub second_order: bool,
    /// Write the errors of all nodes (CSV).
    #[arg(long, value_name = "FILE")]
    pub csv: Option<PathBuf>,
    /// Write all figures (JSON).
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the map as one page with drawings (HTML).
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write a page in which the error moves.
    ///
    /// A lattice, magnified, cause by cause; HTML with a script of its own.
    #[arg(long, value_name = "FILE")]
    pub viewer: Option<PathBuf>,
    /// Write the map for ParaView (VTK).
    #[arg(long, value_name = "FILE")]
    pub vtk: Option<PathBuf>,
}
