//! What the options of `vpost map` mean.

use error_map::{Grid, Nodes, Plane};
use machine_model::{Command, Range, Vector, Volume};
use machine_profile::Profile;

use super::arguments::Map;
use crate::arguments::Shared;
use crate::message::Failure;
use crate::values::{Given, Lattice, Rotary, ToolVector};

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
    Command { linear_mm, rotary_rad: asked.rotary_rad, tool_mm: asked.tool_mm, direction }
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
        tool_mm: tool(arguments.tool_vector.as_ref(), shared, profile)?,
        rotary_rad: rotary(arguments.rotary.as_ref(), profile)?,
        within_mm: arguments.within * 1e-3,
        regions: arguments.region.iter().map(|given| (given.name.clone(), given.ranges_mm)).collect(),
        planes: arguments.plane.iter().map(|given| (given.plane, given.at_mm)).collect(),
        part_box_mm: arguments.part_box.as_ref().map(|given| given.0),
        clamp_mm: arguments.clamp.as_ref().map(|given| Vector::from(given.0)),
        second_order: arguments.second_order,
    })
}

/// Nodes over the volume, or where they were said to be.
pub(crate) fn grid(given: &Given<Lattice>, volume: Volume) -> Result<Grid, Failure> {
    let refuse = |why: String| {
        Failure::option(
            format!("`--grid {given}`: {why}"),
            "write numbers of nodes as in `--grid 22x22x21`, or from:to:step in mm as in `--grid 40:880:40,30:450:20,5:505:25`",
        )
    };
    let axis = |k: usize| match **given {
        Lattice::Counts(counts) => Nodes::over(volume.0[k], counts[k]),
        Lattice::Stepped(axes) => Nodes::stepped(axes[k][0], axes[k][1], axes[k][2]),
    };
    let nodes = [0, 1, 2].map(|k| axis(k).map_err(|error| refuse(error.to_string())));
    let [x, y, z] = nodes;
    Grid::new([x?, y?, z?]).map_err(|error| refuse(error.to_string()))
}

/// An H number stands for minus its length vector, as under G43.
pub(crate) fn tool(
    given: Option<&Given<ToolVector>>,
    shared: &Shared,
    profile: &Profile,
) -> Result<Vector, Failure> {
    match given.map(|given| **given) {
        None => Ok(Vector::from(profile.default_tool_mm)),
        Some(ToolVector::Vector(mm)) => Ok(Vector::from(mm)),
        Some(ToolVector::Length(number)) => crate::settings::tools(shared, profile)
            .iter()
            .find(|(known, _)| *known == number)
            .map(|(_, length)| -Vector::from(*length))
            .ok_or_else(|| {
                Failure::option(
                    format!("`--tool-vector H{number}`: neither the profile nor `--tool` has an H{number}"),
                    format!("add `--tool H{number}=120`"),
                )
            }),
    }
}

/// Axes that are not named stand at 0.
pub(crate) fn rotary(given: Option<&Given<Rotary>>, profile: &Profile) -> Result<Vector, Failure> {
    let Some(given) = given else { return Ok(Vector::zeros()) };
    for (axis, angle) in given.0.iter().enumerate() {
        if angle.is_some() && !profile.has_rotary()[axis] {
            return Err(Failure::option(
                format!("`--rotary {given}`: the profile's chain has no such axis"),
                format!("the chain is {}", profile.chain()),
            ));
        }
    }
    let rotary_rad = Vector::from(given.0.map(|angle| angle.unwrap_or(0.0).to_radians()));
    let turned =
        Command { linear_mm: Vector::zeros(), rotary_rad, tool_mm: Vector::zeros(), direction: [0; 3] };
    profile.rigid_body_without_effects().rotary_inside(&turned).map_err(|error| {
        Failure::option(format!("`--rotary {given}`: {error}"), "give angles inside its travel and its table")
    })?;
    Ok(rotary_rad)
}
