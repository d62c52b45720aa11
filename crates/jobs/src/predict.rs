//! Forward: where the machine really goes.

use diagnostic::{Code, Diagnostic, Speaks, Text, both, notice};
use machine_model::{
    Command, Engine, EngineId, PathModel, Placement, SolveError, Vector, WithEffects, rotation,
};
use machine_profile::Profile;
use rewrite::OTHER_TOOL;

use crate::conditions::{self, conditions, engine, failure};
use crate::message::{Failure, OPTION, Report};
use crate::options::{JobOptions, Outside};

/// Points outside the calibrated volume.
pub const POINT_OUTSIDE: Code = Code(909);

/// In which frame positions are given.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// The machine's.
    Machine,
    /// The measuring instrument's: turned and shifted by `[setup]`, with the instrument's own faults.
    Measuring,
}

/// Where the tool is for a command.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// Of the tip, mm.
    pub position_mm: Vector,
    /// From where the command says, mm.
    pub error_mm: Vector,
}

impl Prediction {
    /// The same seen from a workpiece.
    #[must_use]
    pub fn from_datum(self, datum: &Placement) -> Self {
        let position_mm = datum.meant(&self.position_mm);
        Self { position_mm, error_mm: self.error_mm + position_mm - self.position_mm }
    }
}

/// A machine of which points are asked.
pub struct Predictor<'p> {
    profile: &'p Profile,
    machine: WithEffects,
    /// Where it is not the tables of the profile.
    engine: Option<Box<dyn Engine>>,
    frame: Frame,
}

impl<'p> Predictor<'p> {
    /// The machine of a profile, or an engine that the options name, under their conditions.
    ///
    /// # Errors
    /// A condition that nobody gave, an engine that the profile lacks tables for or that only solves.
    pub fn new(profile: &'p Profile, options: &JobOptions, frame: Frame) -> Result<Self, Failure> {
        let conditions = conditions(options)?;
        let machine = match frame {
            Frame::Measuring => profile.measured_machine(&conditions),
            Frame::Machine => profile.machine(&conditions),
        }
        .map_err(|error| failure(&error))?;
        let id = profile.forward_engine(options.engine());
        let other = Some(id).filter(|id| *id != EngineId::RigidBody);
        let engine = other.map(|id| engine(profile, id, options)).transpose()?;
        if let Some(engine) = engine.as_ref().filter(|engine| engine.path_model().is_none()) {
            return Err(Failure::usage(notice!(OPTION;
                "engine `{}` has no forward model: it reproduces a publication",
                "у метода `{}` нет прямой модели: он воспроизводит публикацию", engine.id();
                "use it with `vpost solve`", "используйте его с `vpost solve`"
            )));
        }
        Ok(Self { profile, machine, engine, frame })
    }

    fn other(&self) -> Option<&dyn PathModel> {
        self.engine.as_ref().and_then(|engine| engine.path_model())
    }

    /// Whether it also says where the tool points: machines with rotary axes, by the tables of the profile.
    #[must_use]
    pub fn turns(&self) -> bool {
        self.engine.is_none() && self.profile.chain().has_rotary()
    }

    /// The machine without effects: what [`crate::points::direction_fields`] asks.
    #[must_use]
    pub fn base(&self) -> &machine_model::RigidBody {
        self.machine.base()
    }

    /// True inside the calibrated volume; outside, a point has the error of the nearest one inside.
    #[must_use]
    pub fn contains(&self, command: &Command) -> bool {
        let known = match self.other() {
            None => self.machine.volume().contains(&command.linear_mm),
            Some(other) => other.knows(command).is_ok(),
        };
        known && self.machine.base().rotary_inside(command).is_ok()
    }

    /// Refuses a command, of this row of a list from 0, whose tool the model knows nothing of.
    ///
    /// # Errors
    /// Which tool it knows.
    pub fn require_tool(&self, row: usize, command: &Command) -> Result<(), Diagnostic> {
        match self.other().map(|other| other.knows(command)) {
            Some(Err(error @ SolveError::OtherTool { .. })) => {
                let said = error.text();
                Err(other_tool(both!("point {}: {said}", "точка {}: {said:#}", row + 1)).help(both!(
                    "give tool_x_mm, tool_y_mm and tool_z_mm of the vectors, or measure a field with this tool",
                    "задайте tool_x_mm, tool_y_mm и tool_z_mm измеренных векторов или измерьте поле этим инструментом"
                )))
            }
            _ => Ok(()),
        }
    }

    /// What the error vectors of the profile leave in doubt.
    #[must_use]
    pub fn doubts(&self) -> Option<Report> {
        conditions::doubts(self.profile, self.engine.as_ref()?.id())
    }

    /// What is predicted with.
    #[must_use]
    pub fn model(&self) -> &dyn PathModel {
        self.other().unwrap_or(&self.machine)
    }

    /// Where the tool is for a command.
    #[must_use]
    pub fn predict(&self, command: &Command) -> Prediction {
        let (mut position_mm, mut error_mm) = match self.other() {
            None => {
                let prediction = self.machine.predict(command);
                (prediction.position_mm, prediction.error_mm)
            }
            Some(other) => {
                let error = other.error_mm(command);
                (command.linear_mm + command.tool_mm + error, error)
            }
        };
        if self.frame == Frame::Measuring {
            // The measuring frame turns and shifts what it measures: p' = R p + shift, by any angle.
            let setup = &self.profile.setup;
            let turn = rotation::of_any_size(&Vector::from(setup.rotation_rad));
            let moved = turn * position_mm + Vector::from(setup.shift_mm) - position_mm;
            position_mm += moved;
            error_mm += moved;
        }
        Prediction { position_mm, error_mm }
    }
}

/// A tool that a field knows nothing of.
pub(crate) fn other_tool(message: Text) -> Diagnostic {
    Diagnostic::error(OTHER_TOOL, message)
}

/// Points of a list that lie outside the calibrated volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PointsOutside {
    /// The first of them, from 0.
    pub first: usize,
    /// How many there are.
    pub count: usize,
    /// Of how many.
    pub of: usize,
}

impl PointsOutside {
    /// Those of a list; `None` where all are inside.
    pub fn of(inside: impl IntoIterator<Item = bool>) -> Option<Self> {
        let (mut first, mut count, mut of) = (None, 0, 0);
        for (row, inside) in inside.into_iter().enumerate() {
            of += 1;
            if !inside {
                count += 1;
                first = first.or(Some(row));
            }
        }
        first.map(|first| Self { first, count, of })
    }

    /// A warning of them; an error where the options refuse what lies outside.
    #[must_use]
    pub fn diagnostic(&self, options: &JobOptions) -> Diagnostic {
        let first = self.first + 1;
        let message = both!(
            "{} of {} points lie outside the calibrated volume",
            "вне калиброванного объёма лежат точки: {} из {}",
            self.count,
            self.of
        );
        if options.outside == Some(Outside::Refuse) {
            return notice!(POINT_OUTSIDE;
                "{message}, the first is point {first}", "{message:#}, первая — точка {first}";
                "leave them out, or drop `--outside refuse` to take the nearest point's error",
                "исключите их или уберите `--outside refuse`, чтобы взять погрешность ближайшей точки"
            );
        }
        Diagnostic::warning(POINT_OUTSIDE, message).help(both!(
            "point {first} is the first; each has the error of the volume's nearest point",
            "первая — точка {first}; каждой приписана погрешность ближайшей точки объёма"
        ))
    }
}
