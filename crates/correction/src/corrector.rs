//! The state that runs through a program: where the axes stand, and what is known of the model there.

use std::sync::Arc;

use machine_model::{Command, Everywhere, LANES, Models, PathModel, Play, Vector};
use toolpath::Kinematics;

use crate::Piece;
use crate::deviation::Machine;
use crate::direction::heading;
use crate::directions::Directions;
use crate::error::CorrectionError;
use crate::grid::{Block, Goal};
use crate::options::{Options, Outside};
use crate::remembered::Remembered;

/// Corrects motions in the order of the program.
#[derive(Clone)]
pub struct Corrector<'m> {
    pub(crate) model: &'m dyn PathModel,
    pub(crate) models: Models<'m>,
    /// Of which of them [`Self::model`] is one.
    pub(crate) kinematics: Kinematics,
    pub(crate) options: Options,
    /// Where the axes really are commanded to be in the output, mm.
    pub(crate) standing: [Option<f64>; 3],
    /// Direction of each axis' last motion: the side of its play for which the next one is computed.
    pub(crate) direction: [i8; 3],
    /// Where the axes really stand in their play; nothing is known of it where the model has none.
    pub(crate) play: Play,
    /// Where the last approach of the motion led.
    pub(crate) approached: Option<Vector>,
    /// The last end point solved: nominal command, state and answer. The next motion starts there.
    pub(crate) last: Option<(Command, Vector)>,
    /// Places that were solved together, in which state, and their answers.
    pub(crate) known: Option<(Command, [Vector; LANES], [Vector; LANES])>,
    /// Cycles are being written as moves since one could not stay.
    pub(crate) expanding: bool,
    /// Bottom and R as the control remembers them, program mm, and the initial level, mm.
    pub(crate) remembered: Option<Remembered>,
    /// What the model does anywhere, for the tool vector and the rotary axes in force.
    pub(crate) everywhere: Option<(Vector, [f64; 3], Option<Arc<Everywhere>>)>,
    /// How the rotary axes stand against the program's; as they are programmed where directions are not corrected.
    pub(crate) directions: Directions,
    /// A turn that was put before the motion under way.
    pub(crate) lead: Option<Piece>,
}

/// Which axes a block of output may have words for, and how.
pub(crate) struct Freedom {
    /// Those that may have one; the others stay where they stand.
    may: [bool; 3],
    /// Those that stay where they stand all the same.
    hold: [bool; 3],
    /// The block's own words may stay where they serve.
    may_keep: bool,
}

impl Freedom {
    /// New words for axes.
    pub(crate) fn of(may: [bool; 3]) -> Self {
        Self { may, hold: [false; 3], may_keep: false }
    }

    /// The block's own words may stay where they serve.
    pub(crate) fn keeping_words(self) -> Self {
        Self { may_keep: true, ..self }
    }

    /// Axes that stay where they stand (frames that are shifts only).
    pub(crate) fn holding(self, hold: [bool; 3]) -> Self {
        Self { hold, ..self }
    }
}

/// How often a rapid's directions are decided anew: each axis turns once where it has play.
pub(crate) const MOST_TURNS: u32 = 4;

/// A proof leaves this much room for what other judges compute differently (order of small rotations,
/// last bits), mm.
const GUARD_MM: f64 = 2e-5;

impl<'m> Corrector<'m> {
    /// Nothing is known of where the axes stand.
    #[must_use]
    pub fn new(model: &'m dyn PathModel, options: Options) -> Self {
        Self {
            model,
            models: Models { axes: model, tip: None },
            kinematics: Kinematics::Axes,
            options,
            standing: [None; 3],
            direction: [0; 3],
            play: Play::unknown(),
            approached: None,
            last: None,
            known: None,
            expanding: false,
            remembered: None,
            everywhere: None,
            directions: Directions::default(),
            lead: None,
        }
    }

    /// The same with a model for tip commands.
    #[must_use]
    pub fn with_tip_control(mut self, tip: Option<&'m dyn PathModel>) -> Self {
        self.models.tip = tip;
        self
    }

    /// One axis stands here before the first motion, axis command in mm, the others wherever.
    #[must_use]
    pub fn with_axis_at(mut self, axis: usize, start_mm: f64) -> Self {
        self.standing[axis] = Some(start_mm);
        self.play.forget(axis, Some(start_mm));
        self
    }

    /// Asks the model what holds everywhere, where tool or rotary axes are others than before.
    pub(crate) fn heed(&mut self, block: &Block, rotary_deg: [f64; 3]) {
        let tool = Vector::from(block.tool_mm);
        if !self.everywhere.as_ref().is_some_and(|known| known.0 == tool && known.1 == rotary_deg) {
            let state = self.state(block, rotary_deg);
            self.everywhere = Some((tool, rotary_deg, self.model.everywhere(&state).map(Arc::new)));
        }
    }

    /// The machine in the state of a motion.
    pub(crate) fn machine(&self, block: &Block, rotary_deg: [f64; 3]) -> Machine<'m> {
        Machine {
            model: self.model,
            state: self.state(block, rotary_deg),
            everywhere: self.everywhere.as_ref().and_then(|known| known.2.clone()),
            turns: false,
            lag_rad: None,
        }
    }

    /// What the error depends on besides the place.
    #[inline]
    pub(crate) fn state(&self, block: &Block, rotary_deg: [f64; 3]) -> Command {
        let rotary_rad = Vector::from(rotary_deg.map(f64::to_radians));
        Command {
            linear_mm: Vector::zeros(),
            rotary_rad,
            tool_mm: block.tool_mm.into(),
            direction: self.direction,
            rotary_play: self.rotary_play(rotary_rad),
            datum: block.datum,
        }
    }

    /// Notes which way the axes go.
    pub(crate) fn turn_towards(&mut self, from: &Vector, to: &Vector) {
        for (i, direction) in self.direction.iter_mut().enumerate() {
            *direction = heading(from[i], to[i], *direction);
        }
    }

    /// An axis with play whose last direction nobody knows.
    pub(crate) fn is_side_unknown(&self) -> bool {
        self.direction.contains(&0) && self.model.depends_on_direction()
    }

    /// What [`Self::solve`] answers, where it was found before.
    pub(crate) fn found(&self, target: &Command, nominal: Vector) -> Option<Vector> {
        // Place apart, where the same is asked for.
        let alike = |state: &Command| {
            (state.tool_mm, state.datum, state.rotary_rad)
                == (target.tool_mm, target.datum, target.rotary_rad)
                && state.rotary_play == target.rotary_play
                && (state.direction == target.direction || !self.model.depends_on_direction())
        };
        if let Some((same, answer)) = &self.last
            && same.linear_mm == nominal
            && alike(same)
        {
            return Some(*answer);
        }
        let (state, places, answers) = self.known.as_ref()?;
        let place = places.iter().position(|place| *place == nominal)?;
        alike(state).then(|| answers[place])
    }

    /// The command that brings the tool to a nominal command's place.
    pub(crate) fn solve(&self, state: &Command, nominal: Vector) -> Result<Vector, CorrectionError> {
        if let Some(answer) = self.found(state, nominal) {
            return Ok(answer);
        }
        let target = Command { linear_mm: nominal, ..*state };
        let answer = match &self.everywhere {
            Some((_, _, Some(everywhere))) => self.model.command_for(&target, everywhere),
            _ => self.model.solve(&target).map(|solution| solution.linear_mm),
        };
        match (answer, self.options.outside) {
            (Ok(command), _) => Ok(command),
            (Err(error), Outside::Clamp) if error.is_outside() => Ok(self.nearest(state, nominal)),
            (Err(error), _) => Err(error.into()),
        }
    }

    /// How far the corrected command for a place is from it, mm, where it was found before.
    pub(crate) fn correction_mm(&self, state: &Command, nominal: Vector) -> Option<f64> {
        self.found(state, nominal).map(|answer| (answer - nominal).norm())
    }

    /// Solves places together that [`Self::solve`] will be asked for, where the model does that.
    pub(crate) fn foresee_places(&mut self, machine: &Machine<'_>, places: [Vector; LANES]) {
        let answers = machine.solved_together(places);
        self.known = answers.map(|answers| (machine.state, places, answers));
    }

    /// The nominal command with the correction of the volume's nearest point.
    pub(crate) fn nearest(&self, state: &Command, nominal: Vector) -> Vector {
        let edge = self.model.volume().nearest(&nominal);
        nominal - self.model.error_mm(&Command { linear_mm: edge, ..*state })
    }

    pub(crate) fn standing_program(&self, block: &Block) -> [Option<f64>; 3] {
        if let [Some(x), Some(y), Some(z)] = self.standing {
            return block.program(&Vector::new(x, y, z)).map(Some);
        }
        // A turned frame mixes axes: nothing is known of any while one is unknown.
        if !block.frame.is_shift() {
            return [None; 3];
        }
        let offset = block.frame.offset_mm();
        [0, 1, 2].map(|i| self.standing[i].map(|v| v - offset[i]))
    }

    /// Limit of a proof: tolerance and rounding.
    pub(crate) fn limit_mm(&self, block: &Block) -> f64 {
        self.options.tolerance_mm - block.reserved_mm + block.rounding_mm() - GUARD_MM
    }

    /// Chooses the words that bring the axes to `wanted` and takes note of where they then stand.
    pub(crate) fn go(
        &mut self,
        block: &Block,
        nominal: &Vector,
        wanted: &Vector,
        freedom: &Freedom,
    ) -> [Goal; 3] {
        let standing = self.standing_program(block);
        let wanted = block.program(wanted);
        let nominal = block.program(nominal);
        let mut words = [Goal::Stays; 3];
        let mut reached = [0.0; 3];
        for i in 0..3 {
            let own = block.stated.axes[i] && freedom.may_keep;
            (words[i], reached[i]) = match standing[i] {
                _ if !freedom.may[i] => (Goal::Stays, standing[i].unwrap_or(nominal[i])),
                Some(stands) if freedom.hold[i] && own => block.write(i, stands, standing[i]),
                Some(stands) if freedom.hold[i] => (Goal::Stays, stands),
                // Under G91 the block's own word adds to where the output stands, not to where the program
                // believes to be: the caller gives the nominal end relative to that.
                _ => block.choose(i, wanted[i], own.then_some(nominal[i]), standing[i]),
            };
        }
        block.complete(&mut words, &mut reached, standing);
        self.standing = Into::<[f64; 3]>::into(block.machine(reached)).map(Some);
        words
    }

    /// True where every further motion would be corrected alike.
    #[must_use]
    pub fn continues_as(&self, other: &Self) -> bool {
        // Taken apart, so that a new field asks whether it belongs here. Left out is what is the same for a whole program,
        // what a motion sets before it asks, and what was worked out and would be worked out again.
        let Self {
            standing,
            direction,
            play,
            last,
            expanding,
            remembered,
            kinematics,
            directions,
            model: _,
            models: _,
            options: _,
            approached: _,
            known: _,
            everywhere: _,
            lead: _,
        } = self;
        *standing == other.standing
            && *kinematics == other.kinematics
            && *directions == other.directions
            && *direction == other.direction
            && *play == other.play
            && *last == other.last
            && *expanding == other.expanding
            && *remembered == other.remembered
    }

    /// Where the output has brought the axes, axis commands in mm.
    #[must_use]
    pub const fn standing_mm(&self) -> [Option<f64>; 3] {
        self.standing
    }

    /// Where the axes stand, or the nominal place for an axis that is not known.
    pub(crate) fn standing_or(&self, nominal: &Vector) -> Vector {
        [0, 1, 2].map(|i| self.standing[i].unwrap_or(nominal[i])).into()
    }

    /// The corrected start, as far as axes lead there that the program has named before.
    pub(crate) fn start_within_reach(
        &self,
        machine: &Machine<'_>,
        start: Vector,
        block: &Block,
    ) -> Result<Vector, CorrectionError> {
        let mut wanted = self.solve(&machine.state, start)?;
        self.leave(&mut wanted, block, block.named);
        Ok(wanted)
    }

    /// Leaves the axes that must not have a word where they stand.
    pub(crate) fn leave(&self, wanted: &mut Vector, block: &Block, may: [bool; 3]) {
        if may == [true; 3] {
            return;
        }
        let standing = self.standing_program(block);
        let mut program = block.program(wanted);
        for i in (0..3).filter(|i| !may[*i]) {
            program[i] = standing[i].unwrap_or(program[i]);
        }
        *wanted = block.machine(program);
    }

    pub(crate) fn note_end(&mut self, state: &Command, nominal: Vector, answer: Vector) {
        self.last = Some((Command { linear_mm: nominal, ..*state }, answer));
    }
}
