//! Inverse: what to command so that the tool reaches points.

use diagnostic::{Diagnostic, Speaks, both, notice};
use machine_model::engines::EngineInputs;
use machine_model::engines::published::KmtppPublished;
use machine_model::{Command, Engine, EngineId, Solution, SolveError};
use machine_profile::{EngineError, Profile};
use rewrite::OUTSIDE;

use crate::conditions;
use crate::message::{Failure, OPTION, Report};
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

    /// The same, where the options name the engine that follows an astatic law, with its K and l.
    ///
    /// * `gain`, `step` – K and l; those of the publication where they are not given
    ///
    /// # Errors
    /// As [`Self::new`]; another engine, which has neither.
    pub fn with_law(
        profile: &Profile,
        options: &JobOptions,
        gain: Option<f64>,
        step: Option<f64>,
    ) -> Result<Self, Failure> {
        if gain.is_none() && step.is_none() {
            return Self::new(profile, options);
        }
        if options.engine() != Some(EngineId::KmtppPublished) {
            let option = if gain.is_some() { "--gain" } else { "--step" };
            return Err(Failure::usage(notice!(OPTION;
                "`{option}` is of the astatic law that `kmtpp-published` follows",
                "`{option}` относится к астатическому закону, которому следует `kmtpp-published`";
                "add `--engine kmtpp-published`; the answers of the other engines depend on no such number",
                "добавьте `--engine kmtpp-published`; ответы других методов от этого числа не зависят"
            )));
        }
        // Says what the profile lacks.
        Self::new(profile, options)?;
        let EngineInputs { tables: Some(tables), traverses: Some(traverses), .. } =
            profile.engine_inputs_without_effects()
        else {
            return Self::new(profile, options);
        };
        let (gain, step) = (gain.unwrap_or(KmtppPublished::GAIN), step.unwrap_or(KmtppPublished::TIME_STEP));
        let engine = KmtppPublished::new(tables, &traverses, gain, step)
            .map_err(|error| conditions::failure(&EngineError::Build(error)))?;
        Ok(Self { engine: Box::new(engine), turns: false })
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
            let said = error.text();
            let message = both!("point {} cannot be reached: {said}", "точка {} недостижима: {said:#}", row + 1);
            match error {
                SolveError::OtherTool { .. } => other_tool(message).help(both!(
                    "give tool_x_mm, tool_y_mm and tool_z_mm of the vectors, or measure a field with this tool",
                    "задайте tool_x_mm, tool_y_mm и tool_z_mm измеренных векторов или измерьте поле этим инструментом"
                )),
                _ => notice!(OUTSIDE; message;
                    "leave the point out, or choose another engine with `--engine`",
                    "исключите точку или выберите другой метод ключом `--engine`"
                ),
            }
        })
    }
}
