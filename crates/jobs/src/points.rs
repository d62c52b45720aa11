//! Points as CSV.

use machine_model::Command;
use machine_profile::Profile;
pub use measurement_files::Points;
pub use measurement_files::codes::POINTS;

use crate::figures::fixed;
use crate::message::Failure;

/// Columns of the tool's direction, for machines that turn it or the workpiece.
pub const DIRECTION_COLUMNS: &str = ",tool_i,tool_j,tool_k,tilt_urad";

/// The tool's real direction as the workpiece sees it, from the tip up, and its angle from the ideal one, µrad.
#[must_use]
pub fn direction_fields(machine: &machine_model::RigidBody, command: &Command) -> String {
    let [_, real] = machine.directions(command);
    let tilt_urad = machine_model::PathModel::tilt_rad(machine, command) * 1e6;
    let [i, j, k] = [real.x, real.y, real.z].map(|v| fixed(v, 9));
    format!(",{i},{j},{k},{}", fixed(tilt_urad, 3))
}

/// Reads points for a machine; `tool_mm`: the tool of rows without one.
///
/// # Errors
/// What is wrong with the table.
pub fn read(name: &str, bytes: &[u8], tool_mm: [f64; 3], profile: &Profile) -> Result<Points, Failure> {
    Ok(Points::read(name, bytes, tool_mm, profile.has_rotary(), &profile.chain().to_string())?)
}
