//! Machines that go the way of another, and what they make of it.

use machine_model::{Command, Models, PathModel, Placement, Play, Vector};
use toolpath::Kinematics;

use crate::way::Way;

/// A feed motion with the errors of several machines along it.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// Line of its file.
    pub line: u64,
    /// The programmed places, ends included, as the workpiece sees them, mm.
    pub places_mm: Vec<[f64; 3]>,
    /// Real place minus programmed place, mm: at each place of each machine, in the order of the machines.
    pub errors_mm: Vec<[f64; 3]>,
}

/// [`Command::datum`] of a machine, by its number, where that of the first is given.
pub type DatumOf<'m> = dyn Fn(usize, Placement) -> Placement + 'm;

/// Largest turn of an arc, and of all rotary axes together, between two places, rad: a chord lies off a circle by 1/800
/// of its radius.
pub const TURN_RAD: f64 = 0.1;

/// Machines that go the way of another.
pub(crate) struct Others<'m> {
    machines: Vec<Other<'m>>,
    step_mm: f64,
    asked: &'m dyn Fn(u64) -> bool,
    datum_of: &'m DatumOf<'m>,
}

struct Other<'m> {
    models: Models<'m>,
    model: &'m dyn PathModel,
    play: Option<Play>,
    /// Of the first machine and of this one.
    datums: [Placement; 2],
}

impl<'m> Others<'m> {
    pub(crate) fn new(
        models: &[Models<'m>],
        step_mm: f64,
        asked: &'m dyn Fn(u64) -> bool,
        datum_of: &'m DatumOf<'m>,
    ) -> Self {
        let mut others = Self {
            machines: models
                .iter()
                .map(|models| Other {
                    models: *models,
                    model: models.axes,
                    play: None,
                    datums: [Placement::default(); 2],
                })
                .collect(),
            step_mm,
            asked,
            datum_of,
        };
        others.switch(Kinematics::Axes);
        others
    }

    /// From here on X, Y and Z are something else.
    pub(crate) fn switch(&mut self, kinematics: Kinematics) {
        for other in &mut self.machines {
            other.model = other.models.of(kinematics).unwrap_or(other.models.axes);
            other.play = behind_a_switch(other.model, other.play);
        }
    }

    /// Those that have play.
    pub(crate) fn playing(&mut self) -> impl Iterator<Item = (&'m dyn PathModel, &mut Play)> {
        self.machines.iter_mut().filter_map(|other| Some((other.model, other.play.as_mut()?)))
    }

    /// Nobody asks for a line, and where the axes go in it has nothing to do with those that follow.
    pub(crate) fn passes_over(&self, line: u64) -> bool {
        !(self.asked)(line) && self.machines.iter().all(|other| other.play.is_none())
    }

    /// Into how many pieces a way is cut.
    pub(crate) fn pieces(&self, way: &Way, length_mm: f64) -> f64 {
        let turned = way.turning_rad().max(way.rotary_turn_rad());
        (turned / TURN_RAD).max(length_mm / self.step_mm)
    }

    /// The error of each, its axes having gone to a command.
    pub(crate) fn errors_mm(&mut self, here: &Command) -> impl Iterator<Item = Vector> {
        self.machines.iter_mut().zip(1..).map(|(other, number)| {
            if other.datums[0] != here.datum {
                other.datums = [here.datum, (self.datum_of)(number, here.datum)];
            }
            let here = &Command { datum: other.datums[1], ..*here };
            match &mut other.play {
                None => other.model.error_mm(here),
                Some(play) => {
                    play.go(other.model, here);
                    play.turn(other.model, here, [true; 3]);
                    play.error_mm(other.model, here)
                }
            }
        })
    }
}

/// True where what a machine makes of a command depends on how it came there.
pub(crate) fn has_play(model: &dyn PathModel) -> bool {
    model.depends_on_direction() || model.has_rotary_play()
}

/// Where the axes stand in their play behind a switch: a rotary axis is what it was, of a linear one nothing is known.
pub(crate) fn behind_a_switch(model: &dyn PathModel, before: Option<Play>) -> Option<Play> {
    has_play(model).then(|| {
        let mut play = before.unwrap_or(Play::unknown());
        (0..3).for_each(|axis| play.forget(axis, None));
        play
    })
}
