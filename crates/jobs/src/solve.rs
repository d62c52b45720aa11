//! Inverse: what to command so that the tool reaches points.

use diagnostic::Diagnostic;
use machine_model::{Command, Engine, EngineId, Solution, SolveError};
use machine_profile::Profile;
use rewrite::OUTSIDE;

use crate::conditions;
use crate::message::{Failure, Report};
use crate::options::JobOptions;
use crate::predict::other_tool;

/// A machine of which commands are asked.
pub struct Solver {
    engine: Box<dyn Engine>,
    /// Whether it also says where the tool points: machines with rotary axes, by the tables of the profile.
    pub turns: bool,
}

impl Solver {
    /// The engine that the options name, or the profile, under the options' conditions.
    ///
    /// # Errors
    /// A condition that nobody gave, an engine that the profile lacks tables for.
    pub fn new(profile: &Profile, options: &JobOptions) -> Result<Self, Failure> {
        let id = options.engine().unwrap_or(profile.correction.engine);
        let engine = conditions::engine(profile, id, options)?;
        Ok(Self { engine, turns: id == EngineId::RigidBody && profile.chain().has_rotary() })
    }

    /// What the error vectors of the profile leave in doubt.
    #[must_use]
    pub fn doubts(&self, profile: &Profile) -> Option<Report> {
        conditions::doubts(profile, self.engine.id())
    }

    /// What to command so that the tool comes to `row` of a list of points, from 0.
    ///
    /// # Errors
    /// No command brings it there.
    pub fn solve(&self, row: usize, target: &Command) -> Result<Solution, Diagnostic> {
        self.engine.solve(target).map_err(|error| {
            let message = format!("point {} cannot be reached: {error}", row + 1);
            match error {
                SolveError::OtherTool { .. } => other_tool(&message)
                    .help("give tool_x_mm, tool_y_mm and tool_z_mm of the vectors, or measure a field with this tool"),
                _ => Diagnostic::error(OUTSIDE, message)
                    .help("leave the point out, or choose another engine with `--engine`"),
            }
        })
    }
}
