//! The map of a machine, from options to what is found in it.

use error_map::Nodes;
use machine_model::Engine;
use machine_profile::Profile;

use super::asked::{Asked, MapOptions};
use super::study::Study;
use super::{model, outside, require_tool};
use crate::conditions;
use crate::datums::of_offsets;
use crate::message::{Failure, Report};
use crate::options::JobOptions;

/// The map of a machine.
///
/// * `warnings` – what is to be said of it, also where it fails
///
/// # Errors
/// What is asked for cannot be: nodes outside the volume, a tool or angles that the machine has not.
pub fn of(
    options: &JobOptions,
    profile: &Profile,
    engine: &dyn Engine,
    asked: &MapOptions,
    warnings: &mut Vec<Report>,
) -> Result<Study, Failure> {
    let model = model(engine)?;
    let asked = Asked::of(asked, options, profile, model.volume())?;
    require_tool(model, asked.tool_mm)?;
    warnings.extend(conditions::doubts(profile, engine.id()));
    let grid_mm = asked.grid.axes().each_ref().map(Nodes::range_mm);
    warnings.extend(outside(asked.part_box_mm.into_iter().chain([grid_mm]), model.volume(), options)?);
    let offsets = of_offsets(options, profile, engine)?;
    Study::new(profile, engine.id(), model, offsets, asked)
}
