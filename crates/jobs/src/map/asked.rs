//! What a map is asked for.

use error_map::{Grid, Plane};
use machine_model::{Command, Range, Vector};

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
    /// The state in which errors are asked for.
    pub fn command(&self, linear_mm: Vector, direction: [i8; 3]) -> Command {
        let Self { tool_mm, rotary_rad, .. } = *self;
        Command { linear_mm, rotary_rad, tool_mm, direction, ..Command::default() }
    }
}
