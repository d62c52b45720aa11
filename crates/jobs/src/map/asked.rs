//! What a map is asked for.

use clap::Args;
use error_map::{Grid, Plane};
use machine_model::{Command, Range, Vector, Volume};
use machine_profile::Profile;

use super::{grid, rotary, tool};
use crate::message::Failure;
use crate::options::{JobOptions, size};
use crate::values::{Given, Lattice, Layer, NamedRegion, Region3, Rotary, Size3, ToolVector};

/// What a map is asked for, as it is typed.
#[derive(Debug, Args)]
pub struct MapOptions {
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
    #[arg(long, value_name = "UM", default_value_t = 20.0, value_parser = size)]
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
}

/// What is asked for, in the mathematics' words.
pub struct Asked {
    /// The nodes.
    pub grid: Grid,
    /// From gauge point to tip, mm.
    pub tool_mm: Vector,
    /// Where the rotary axes stand.
    pub rotary_rad: Vector,
    /// The tolerance.
    pub within_mm: f64,
    /// Parts of the volume by name.
    pub regions: Vec<(String, [Range; 3])>,
    /// A layer at a place of the normal, or all layers.
    pub planes: Vec<(Plane, Option<f64>)>,
    /// Where the axes go for the workpiece.
    pub part_box_mm: Option<[Range; 3]>,
    /// Size of a workpiece that is to be placed.
    pub clamp_mm: Option<Vector>,
    /// What products of errors do is asked, too.
    pub second_order: bool,
}

impl Asked {
    /// Of a machine whose volume is this.
    ///
    /// # Errors
    /// Nodes, a tool or angles that cannot be.
    pub fn of(
        asked: &MapOptions,
        options: &JobOptions,
        profile: &Profile,
        volume: Volume,
    ) -> Result<Self, Failure> {
        Ok(Self {
            grid: grid(&asked.grid, volume)?,
            tool_mm: tool(asked.tool_vector.as_ref(), options, profile)?,
            rotary_rad: rotary(asked.rotary.as_ref(), profile)?,
            within_mm: asked.within * 1e-3,
            regions: asked.region.iter().map(|given| (given.name.clone(), given.ranges_mm)).collect(),
            planes: asked.plane.iter().map(|given| (given.plane, given.at_mm)).collect(),
            part_box_mm: asked.part_box.as_ref().map(|given| given.0),
            clamp_mm: asked.clamp.as_ref().map(|given| Vector::from(given.0)),
            second_order: asked.second_order,
        })
    }

    /// The state in which errors are asked for.
    pub fn command(&self, linear_mm: Vector, direction: [i8; 3]) -> Command {
        let Self { tool_mm, rotary_rad, .. } = *self;
        Command { linear_mm, rotary_rad, tool_mm, direction, ..Command::default() }
    }
}
