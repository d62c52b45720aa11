//! Inverse: what to command so that the tool reaches points.

use diagnostic::{Diagnostic, Speaks, both};
use machine_model::{Command, Engine, EngineId, Solution};
use machine_profile::Profile;
use rewrite::OUTSIDE;

use crate::conditions;
use crate::message::Failure;
use crate::options::JobOptions;

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

    /// What to command so that the tool comes to `row` of a list of points, from 0.
    ///
    /// # Errors
    /// No command brings it there.
    pub fn solve(&self, row: usize, target: &Command) -> Result<Solution, Diagnostic> {
        self.engine.solve(target).map_err(|error| {
            let error = error.text();
            Diagnostic::error(
                OUTSIDE,
                both!("point {} cannot be reached: {error}", "точка {} недостижима: {error:#}", row + 1),
            )
            .help(both!(
                "leave the point out, or choose another engine with `--engine`",
                "исключите точку или выберите другой метод ключом `--engine`"
            ))
        })
    }
}
