//! What the options of `vpost map` mean.

use error_map::{Grid, Plane};
use jobs::map::{grid, rotary, tool};
use machine_model::{Command, Range, Vector, Volume};
use machine_profile::Profile;

use super::arguments::Map;
use crate::arguments::Shared;
use crate::message::Failure;

/// What is asked for, in the mathematics' words.
pub(super) struct Asked {
    pub grid: Grid,
    pub tool_mm: Vector,
    pub rotary_rad: Vector,
    pub within_mm: f64,
    pub regions: Vec<(String, [Range; 3])>,
    /// A layer at a place of the normal, or all layers.
    pub planes: Vec<(Plane, Option<f64>)>,
    pub part_box_mm: Option<[Range; 3]>,
    pub clamp_mm: Option<Vector>,
    pub second_order: bool,
}

/// The state in which errors are asked for.
pub(super) fn command(asked: &Asked, linear_mm: Vector, direction: [i8; 3]) -> Command {
    Command {
        linear_mm,
        rotary_rad: asked.rotary_rad,
        tool_mm: asked.tool_mm,
        direction,
        ..Default::default()
    }
}

/// Reads the options.
pub(super) fn read(
    arguments: &Map,
    shared: &Shared,
    profile: &Profile,
    volume: Volume,
) -> Result<Asked, Failure> {
    Ok(Asked {
        grid: grid(&arguments.grid, volume)?,
        tool_mm: tool(arguments.tool_vector.as_ref(), &shared.job, profile)?,
        rotary_rad: rotary(arguments.rotary.as_ref(), profile)?,
        within_mm: arguments.within * 1e-3,
        regions: arguments.region.iter().map(|given| (given.name.clone(), given.ranges_mm)).collect(),
        planes: arguments.plane.iter().map(|given| (given.plane, given.at_mm)).collect(),
        part_box_mm: arguments.part_box.as_ref().map(|given| given.0),
        clamp_mm: arguments.clamp.as_ref().map(|given| Vector::from(given.0)),
        second_order: arguments.second_order,
    })
}
