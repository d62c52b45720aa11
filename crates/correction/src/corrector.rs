//! The state that runs through a program, and one motion at a time.

use std::sync::Arc;

use machine_model::{Command, Everywhere, LANES, Models, PathModel, Play, SolveError, Vector};
use smallvec::SmallVec;
use toolpath::{Division, Feed, Kinematics, Motion, Partial, Shape};

use crate::approach::Whole;
use crate::curve::Curve;
use crate::deviation::{Enclosed, Machine, Solved};
use crate::grid::{Block, Goal};
use crate::play::heading;
use crate::short_line::Run;
use crate::turning::{Turned, Turning};
use crate::{Piece, PieceKind};

/// What happens to feed motion outside the calibrated volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// It is an error.
    Refuse,
    /// It takes the correction of the volume's nearest point.
    Clamp,
}

/// What the user may choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest distance of the real path from the programmed one, rounding apart, mm.
    pub tolerance_mm: f64,
    /// Feed motion outside the calibrated volume.
    pub outside: Outside,
    /// No piece is made shorter than this, mm; 0 for no limit.
    pub minimum_segment_mm: f64,
    /// Largest angle by which the rotary words of a split motion may turn the tool away from its programmed direction, rad.
    pub orientation_rad: f64,
}

/// Why a motion cannot be corrected.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum CorrectionError {
    /// The model has no answer.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The motion would have to be split and must not be.
    #[error("{} and this motion must stay one block", off(*distance_um))]
    MustNotSplit {
        /// What one block would miss by, µm; infinite where there is none, as of an arc whose corrected ends no arc joins.
        distance_um: f64,
    },
    /// A hole that would be written as more moves than anybody drills.
    #[error("a hole of {pecks:.0} pecks, which would have to be written as moves")]
    TooManyPecks {
        /// Its depth by Q.
        pecks: f64,
    },
    /// Lost motion in a turned frame, where every word moves several axes, this way and that by its rounding.
    #[error(
        "in this rotated frame an axis with lost motion would go back and forth: {distance_um:.2} um off, the tolerance is {tolerance_um} um"
    )]
    TurnedFrame {
        /// What is left, µm.
        distance_um: f64,
        /// What was asked for, µm.
        tolerance_um: f64,
    },
    /// What lies across an axis changes when it turns, and that is too much to be hidden.
    #[error(
        "where an axis turns its lost motion moves the tool sideways: {distance_um:.2} um off however it is commanded, the tolerance is {tolerance_um} um"
    )]
    Sideways {
        /// What is left, µm.
        distance_um: f64,
        /// What was asked for, µm.
        tolerance_um: f64,
    },
    /// An axis that must not get a word would have to have one.
    #[error(
        "the tool would be {distance_um:.2} um off without a further word for {}, which the program has not named",
        toolpath::AXIS_NAMES[*axis]
    )]
    Unnamed {
        /// X, Y or Z by index.
        axis: usize,
        /// How far it is from where it should be, µm.
        distance_um: f64,
    },
    /// The model has bounds for rotary axes that stand only.
    #[error("the path cannot be proven while a rotary axis turns at feed rate")]
    NoBoundsForTurns,
    /// The rotary words of a piece cannot say its direction finely enough.
    #[error(
        "a split needs rotary words that turn the tool by {slip_urad:.1} urad away from its direction; {allowed_urad:.1} urad are allowed"
    )]
    Direction {
        /// By how much, µrad.
        slip_urad: f64,
        /// What was asked for, µrad.
        allowed_urad: f64,
    },
    /// Splitting does not help: a jump of the model, or the shortest piece allowed.
    #[error(
        "the path would be {distance_um:.2} um off however short its pieces; the tolerance is {tolerance_um} um"
    )]
    NotWithinTolerance {
        /// What is left, µm.
        distance_um: f64,
        /// What was asked for, µm.
        tolerance_um: f64,
    },
}

/// How far off one block would be, in words.
fn off(distance_um: f64) -> String {
    if distance_um.is_finite() {
        format!("the path would be {distance_um:.2} um off")
    } else {
        "no single arc leads from the corrected start to the corrected end".to_owned()
    }
}

/// One motion, corrected.
#[derive(Clone, Debug, PartialEq)]
pub struct Corrected {
    /// Blocks of output in order; empty where the block stays as it is.
    pub pieces: SmallVec<[Piece; 2]>,
    /// What was done, for the summary.
    pub correction: Correction,
}

impl Corrected {
    /// One block, which stays as it is where it is `untouched`.
    pub(crate) fn block(piece: Piece, untouched: bool, correction: Correction) -> Self {
        let pieces = if untouched { SmallVec::new() } else { SmallVec::from_slice(&[piece]) };
        Self { pieces, correction }
    }
}

/// Figures of one motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Correction {
    /// Largest distance between programmed and corrected command at an end of a piece, mm.
    pub largest_mm: f64,
    /// Proven upper bound of the path deviation without correction, mm; 0 for rapids.
    pub before_mm: f64,
    /// Proven upper bound of the path deviation, mm: what the cheapest proof says; 0 for rapids.
    pub after_mm: f64,
    /// A rapid ended outside the volume and took the nearest point's correction.
    pub clamped: bool,
    /// A short move to the corrected start was put before the motion.
    pub approach: bool,
    /// A cycle left to the control leans by this much over its depth, mm, more than the tolerance.
    pub leaning_mm: Option<f64>,
    /// Nobody knows on which side of its play an axis stands: the tool is off by up to this much besides, mm.
    pub unknown_side_mm: f64,
    /// Rotary axes turned on the way.
    pub turned: Option<Turned>,
}

/// Corrects motions in the order of the program.
#[derive(Clone)]
pub struct Corrector<'m> {
    pub(crate) model: &'m dyn PathModel,
    models: Models<'m>,
    /// Of which of them [`Self::model`] is one.
    kinematics: Kinematics,
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
    known: Option<(Command, [Vector; LANES], [Vector; LANES])>,
    /// Cycles are being written as moves since one could not stay.
    pub(crate) expanding: bool,
    /// Bottom and R as the control remembers them, program mm, and the initial level, mm.
    pub(crate) remembered: Option<crate::hole::Remembered>,
    /// What the model does anywhere, for the tool vector and the rotary axes in force.
    pub(crate) everywhere: Option<(Vector, [f64; 3], Option<Arc<Everywhere>>)>,
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
    pub(crate) fn keeping(self, may_keep: bool) -> Self {
        Self { may_keep, ..self }
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
        }
    }

    /// The same with a model for tip commands.
    #[must_use]
    pub fn with_tip_control(mut self, tip: Option<&'m dyn PathModel>) -> Self {
        self.models.tip = tip;
        self
    }

    /// The same with the axes standing at a known place before the first motion, axis commands in mm.
    #[must_use]
    pub fn standing_at(mut self, start_mm: [f64; 3]) -> Self {
        self.standing = start_mm.map(Some);
        (0..3).for_each(|axis| self.play.forget(axis, Some(start_mm[axis])));
        self
    }

    /// One axis stands here at the start, mm, the others wherever.
    #[must_use]
    pub fn with_axis_at(mut self, axis: usize, start_mm: f64) -> Self {
        self.standing[axis] = Some(start_mm);
        self.play.forget(axis, Some(start_mm));
        self
    }

    /// Corrects one motion of a block.
    ///
    /// # Errors
    /// [`CorrectionError`] where the promise cannot be kept; nothing of the motion may be used then.
    pub fn correct(&mut self, motion: &Motion, block: &Block) -> Result<Corrected, CorrectionError> {
        if block.kinematics != self.kinematics {
            self.switch(block.kinematics)?;
        }
        if !matches!(motion, Motion::Hole(_)) {
            self.expanding = false;
            self.remembered = None;
        }
        match motion {
            Motion::Rapid { end, .. } => self.heed(block, end.rotary_deg),
            Motion::Feed(feed) => self.heed(block, feed.end.rotary_deg),
            Motion::Hole(hole) => self.heed(block, hole.at_r.rotary_deg),
            Motion::Uncorrected { .. } => {}
        }
        self.approached = None;
        self.correct_in_state(motion, block).map_err(|error| self.as_turned(error, block))
    }

    /// From here on X, Y and Z are something else. Where they still say the same, the motions tell.
    fn switch(&mut self, kinematics: Kinematics) -> Result<(), CorrectionError> {
        self.model = self.models.of(kinematics).ok_or(CorrectionError::NoBoundsForTurns)?;
        self.kinematics = kinematics;
        (self.last, self.known, self.everywhere) = (None, None, None);
        Ok(())
    }

    /// What is not to be had in a turned frame on a machine with lost motion is so for that.
    fn as_turned(&self, error: CorrectionError, block: &Block) -> CorrectionError {
        match error {
            CorrectionError::NotWithinTolerance { distance_um, tolerance_um }
                if !block.frame.is_axial() && self.model.depends_on_direction() =>
            {
                CorrectionError::TurnedFrame { distance_um, tolerance_um }
            }
            other => other,
        }
    }

    /// Asks the model what holds everywhere, where tool or rotary axes are others than before.
    pub(crate) fn heed(&mut self, block: &Block, rotary_deg: [f64; 3]) {
        let tool = Vector::from(block.tool_mm);
        if !self.everywhere.as_ref().is_some_and(|known| known.0 == tool && known.1 == rotary_deg) {
            let state = self.state(block, rotary_deg);
            self.everywhere = Some((tool, rotary_deg, self.model.everywhere(&state).map(Arc::new)));
        }
    }

    fn correct_in_state(&mut self, motion: &Motion, block: &Block) -> Result<Corrected, CorrectionError> {
        match motion {
            Motion::Rapid { start, end } => self.rapid(start, end, block),
            Motion::Feed(feed) => {
                let before_mm = self.unknown_side_mm(block, &feed.start);
                let mut corrected = self.feed(feed, block)?;
                corrected.correction.unknown_side_mm = before_mm.max(self.unknown_side_mm(block, &feed.end));
                Ok(corrected)
            }
            Motion::Hole(hole) => {
                let mut corrected = self.hole(hole, block)?;
                corrected.correction.unknown_side_mm = self.unknown_side_mm(block, &hole.at_r);
                Ok(corrected)
            }
            Motion::Uncorrected { end } => {
                for axis in 0..3 {
                    // An axis that the block does not name stays where the output has brought it.
                    if end.linear_mm[axis].is_none()
                        || block.stated.axes[axis]
                        || self.standing[axis].is_none()
                    {
                        self.standing[axis] = end.linear_mm[axis];
                        self.direction[axis] = 0;
                        self.play.forget(axis, end.linear_mm[axis]);
                    }
                }
                self.last = None;
                Ok(Corrected { pieces: SmallVec::new(), correction: Correction::default() })
            }
        }
    }

    /// The machine in the state of a motion.
    pub(crate) fn machine(&self, block: &Block, rotary_deg: [f64; 3]) -> Machine<'m> {
        Machine {
            model: self.model,
            state: self.state(block, rotary_deg),
            everywhere: self.everywhere.as_ref().and_then(|known| known.2.clone()),
            turns: false,
        }
    }

    /// What the error depends on besides the place.
    #[inline]
    pub(crate) fn state(&self, block: &Block, rotary_deg: [f64; 3]) -> Command {
        Command {
            linear_mm: Vector::zeros(),
            rotary_rad: Vector::from(rotary_deg.map(f64::to_radians)),
            tool_mm: block.tool_mm.into(),
            direction: self.direction,
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
            (state.tool_mm, state.rotary_rad) == (target.tool_mm, target.rotary_rad)
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
            (Err(SolveError::OutsideVolume { .. }), Outside::Clamp) => Ok(self.nearest(state, nominal)),
            (Err(error), _) => Err(error.into()),
        }
    }

    /// How far the corrected command for a place is from it, mm, where it was found before.
    fn correction_mm(&self, state: &Command, nominal: Vector) -> Option<f64> {
        self.found(state, nominal).map(|answer| (answer - nominal).norm())
    }

    /// Solves places together that [`Self::solve`] will be asked for, where the model does that.
    pub(crate) fn foresee_places(&mut self, machine: &Machine<'_>, places: [Vector; LANES]) {
        let answers = machine.solved_together(places);
        self.known = answers.map(|answers| (machine.state, places, answers));
    }

    /// The nominal command with the correction of the volume's nearest point.
    fn nearest(&self, state: &Command, nominal: Vector) -> Vector {
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

    fn rapid(&mut self, start: &Partial, end: &Partial, block: &Block) -> Result<Corrected, CorrectionError> {
        let mut correction = Correction::default();
        for i in 0..3 {
            if start.linear_mm[i].is_none() && end.linear_mm[i].is_some() {
                // From wherever, as after a block that may have been skipped: nothing of the axis holds any more.
                (self.standing[i], self.direction[i]) = (None, 0);
                self.play.forget(i, None);
            }
        }
        let Some(nominal) = end.complete() else {
            // Some axis is not known yet, so the error is not: the words stay, and the first motion
            // whose end is known in all axes brings the correction.
            let stood = self.standing;
            for i in 0..3 {
                // An axis that the block does not name stays where the output has brought it; in a turned frame every word
                // moves several axes.
                let moves = block.stated.axes[i] || !block.frame.is_shift();
                if moves || end.linear_mm[i].is_none() || stood[i].is_none() {
                    let step = end.linear_mm[i].zip(start.linear_mm[i]).map(|(end, start)| end - start);
                    self.standing[i] = match (block.incremental[i], stood[i], step) {
                        (true, Some(stood), Some(step)) => Some(stood + step),
                        _ => end.linear_mm[i],
                    };
                }
            }
            let known = |i: usize| stood[i].zip(self.standing[i]).unwrap_or((0.0, 0.0));
            let [x, y, z] = [known(0), known(1), known(2)];
            self.turn_towards(&Vector::new(x.0, y.0, z.0), &Vector::new(x.1, y.1, z.1));
            self.gone(&self.state(block, end.rotary_deg));
            self.last = None;
            return Ok(Corrected { pieces: SmallVec::new(), correction });
        };
        let end_mm = Vector::from(nominal.linear_mm);
        let from: Vector = [0, 1, 2].map(|i| start.linear_mm[i].unwrap_or(end_mm[i])).into();
        self.turn_towards(&from, &end_mm);
        let own_end = block.own_end(&self.standing_or(&from), &(end_mm - from), &end_mm);
        let before = self.standing;
        let mut turns = 0;
        let (state, wanted, axes) = loop {
            let state = self.state(block, nominal.rotary_deg);
            let wanted = match self.solve(&state, end_mm) {
                Err(CorrectionError::Solve(SolveError::OutsideVolume { .. })) => {
                    correction.clamped = true;
                    self.nearest(&state, end_mm)
                }
                other => other?,
            };
            // Positioning moves what the block names and nothing else: the other axes take their correction from the
            // next feed.
            let axes = self.go(block, &own_end, &wanted, &Freedom::of(block.stated.axes).keeping(true));
            // An axis comes from where the output sends it, and where it does not from where it came before.
            let Some(against) = self.against(&state, before, self.standing, block) else {
                break (state, wanted, axes);
            };
            self.turn(against);
            turns += 1;
            if turns == MOST_TURNS {
                break (state, wanted, axes);
            }
            self.standing = before;
        };
        self.gone(&state);
        self.settle(&state, block);
        correction.largest_mm = (wanted - end_mm).norm();
        // The nearest point's correction is no answer for a feed motion that starts here.
        self.last = (!correction.clamped).then_some((Command { linear_mm: end_mm, ..state }, wanted));
        Ok(one(Piece::new(PieceKind::Rapid, axes, 1.0), correction))
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
            model: _,
            models: _,
            options: _,
            approached: _,
            known: _,
            everywhere: _,
        } = self;
        *standing == other.standing
            && *kinematics == other.kinematics
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

    fn feed(&mut self, feed: &Feed, block: &Block) -> Result<Corrected, CorrectionError> {
        if matches!(feed.shape, Shape::Line)
            && feed.start.rotary_deg == feed.end.rotary_deg
            && let Some(lines) = self.short_lines(block, feed.end.rotary_deg)
            && let names = block.stated.axes
            && let ends_mm = [feed.end.linear_mm; LANES]
            && let run =
                (Run { start_mm: feed.start.linear_mm, ends_mm: &ends_mm, names: [names; LANES], count: 1 })
            && let Some(run) = self.short_run(&lines, block, &run)
        {
            let piece = Piece::new(PieceKind::Line, run.words(0, names), 1.0);
            return Ok(one(piece, self.correction_of(&run, 0)));
        }
        let turns = feed.start.rotary_deg != feed.end.rotary_deg;
        if turns && feed.division == Division::Any {
            self.require_turns()?;
        }
        let turning = matches!(feed.shape, Shape::Line) && turns && self.model.follows_turns();
        let whole = if turning {
            Curve::Turn {
                ends: [feed.start, feed.end].map(|place| place.linear_mm.into()),
                rotary_rad: [feed.start, feed.end].map(|place| place.rotary_deg.map(f64::to_radians).into()),
            }
        } else {
            Curve::new(feed.start.linear_mm.into(), feed.end.linear_mm.into(), &feed.shape)
        };
        let mut corrected = Corrected { pieces: SmallVec::new(), correction: Correction::default() };
        let motion = Whole {
            start: whole.at(0.0),
            rotary_rad: whole.rotary_rad(0.0),
            length_mm: whole.length_mm(),
            in_step: turns,
            division: feed.division,
        };
        let start_mm = self.correction_mm(&self.state(block, feed.start.rotary_deg), whole.at(0.0));
        let parts = self.monotone_parts(&whole);
        let alone = parts.len() == 1;
        if feed.division == Division::One && !alone {
            return Err(self.turns_in_one_block(&whole, block, feed.end.rotary_deg));
        }
        let (mut own_words, mut at_quarters_mm, mut commanded_mm) = (true, None, 0.0);
        for &(s0, s1) in &parts {
            let part = if alone { whole } else { whole.part(s0, s1) };
            self.turn_towards(&part.at(0.0), &part.at(1.0));
            let mut machine = self.machine(block, feed.end.rotary_deg);
            if turning {
                // Until the first piece is written it stands where the motion begins.
                machine.state = self.state(block, feed.start.rotary_deg);
                (machine.everywhere, machine.turns) = (None, true);
            }
            self.approach(&mut machine, &part, block, &motion, &mut corrected)?;
            let mut follow = Follow {
                machine,
                block,
                alone: alone && corrected.pieces.is_empty(),
                may_split: feed.division == Division::Any && self.guessed_own(block).is_none(),
                whole: motion,
                nominal_step: Vector::from(feed.end.linear_mm) - Vector::from(feed.start.linear_mm),
                solved: None,
                enclosed: None,
                foreseen: false,
                turning: turning.then(|| Turning::of(feed)),
                commanded_mm: 0.0,
                corrected: &mut corrected,
            };
            match feed.shape {
                Shape::Line => self.follow_line(&mut follow, &part)?,
                Shape::Arc(arc) if block.frame.similarity(arc.plane).is_some() => {
                    if let Some((solved, largest_mm)) = self.solved_arc(&follow.machine, &part) {
                        follow.solved = Some(solved);
                        at_quarters_mm = Some(largest_mm).filter(|_| parts.len() == 1);
                    }
                    self.follow_arc(&mut follow, &part)?;
                }
                Shape::Arc(_) => self.follow_line(&mut follow, &part)?,
            }
            own_words &= follow.alone;
            commanded_mm += follow.commanded_mm;
            let state = follow.machine.state;
            self.settle(&state, block);
        }
        if corrected.pieces.is_empty() && !own_words {
            // Too little to move an axis a step: the block's own words would lead elsewhere, or be another arc.
            corrected.pieces.push(self.standstill(block)?);
        }
        if turning {
            let pieces = corrected.pieces.len();
            corrected.correction.turned = Some(self.turned(&whole, block, feed, commanded_mm, pieces));
            corrected.correction.before_mm =
                self.before_turning_mm(&whole, &self.state(block, feed.end.rotary_deg));
            return Ok(corrected);
        }
        let at_ends_mm = start_mm.map(|mm| mm.max(corrected.correction.largest_mm));
        let by_quarters = at_quarters_mm.and_then(|mm| self.before_by_quarters_mm(&whole, mm));
        corrected.correction.before_mm = by_quarters
            .unwrap_or_else(|| self.before_mm(&whole, &self.state(block, feed.end.rotary_deg), at_ends_mm));
        Ok(corrected)
    }

    /// Why a motion on whose way axes with play turn cannot stay one block: by their play the tool would be off.
    fn turns_in_one_block(&self, whole: &Curve, block: &Block, rotary_deg: [f64; 3]) -> CorrectionError {
        let state = self.state(block, rotary_deg);
        let at = whole.turns().into_iter().map(|s| Command { linear_mm: whole.at(s), ..state });
        let play_mm = at.flat_map(|at| [0, 1, 2].map(|axis| self.model.reversal_mm(axis, &at).abs()));
        CorrectionError::MustNotSplit { distance_um: play_mm.fold(0.0, f64::max) * 1e3 }
    }

    /// A line to where the axes stand, with a word for each axis that the block names, or for the first that may have one.
    fn standstill(&self, block: &Block) -> Result<Piece, CorrectionError> {
        let standing = self.standing_program(block);
        let mut named = block.stated.axes;
        if named == [false; 3] {
            let Some(first) = block.named.iter().position(|named| *named) else {
                return Err(CorrectionError::Unnamed { axis: 0, distance_um: 0.0 });
            };
            named[first] = true;
        }
        let axes = [0, 1, 2].map(|i| match standing[i] {
            Some(mm) if named[i] => block.write(i, mm, standing[i]).0,
            _ => Goal::Stays,
        });
        Ok(Piece::new(PieceKind::Line, axes, 1.0))
    }

    /// Where the model depends on direction, an arc is cut at its quadrants: each part then moves every
    /// axis one way only.
    fn monotone_parts(&self, whole: &Curve) -> SmallVec<[(f64, f64); 2]> {
        let mut parts = SmallVec::new();
        let mut s0 = 0.0;
        if self.model.depends_on_direction() {
            // A quadrant nearer to an end than 1e-9 of the sweep is that end.
            for s1 in whole.turns().into_iter().filter(|s| (1e-9..=1.0 - 1e-9).contains(s)) {
                parts.push((s0, s1));
                s0 = s1;
            }
        }
        parts.push((s0, 1.0));
        parts
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

    /// The axis that is furthest from where it should be at the end of a part, of those that must not have a word, or at its
    /// start, of those that must not have had one before it; mm.
    fn furthest_unnamed(&self, follow: &Follow<'_, '_>, part: &Curve) -> Option<(usize, f64)> {
        let block = follow.block;
        if block.named == [true; 3] {
            return None;
        }
        let standing = self.standing_program(block);
        let ends = [(0.0, block.named), (1.0, block.may_have_words())];
        let off = ends.into_iter().filter_map(|(s, may)| {
            let mut state = follow.machine.state;
            state.rotary_rad = part.rotary_rad(s).unwrap_or(state.rotary_rad);
            let wanted = block.program(&self.solve(&state, part.at(s)).ok()?);
            let off = |i: usize| (wanted[i] - standing[i].unwrap_or(wanted[i])).abs();
            (0..3).filter(|i| !may[*i]).map(|i| (i, off(i))).max_by(|a, b| a.1.total_cmp(&b.1))
        });
        off.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// An axis that the block names first: where on its way it is at a place in between, no block has said.
    fn guessed_own(&self, block: &Block) -> Option<usize> {
        (0..3).find(|axis| !block.incremental[*axis] && block.stated.axes[*axis] && !block.named[*axis])
    }

    /// Why a part that is off its path must not be split.
    pub(crate) fn not_to_be_split(&self, follow: &Follow<'_, '_>, distance_mm: f64) -> CorrectionError {
        let distance_um = distance_mm * 1e3;
        match self.guessed_own(follow.block) {
            Some(axis) => CorrectionError::Unnamed { axis, distance_um },
            None => CorrectionError::MustNotSplit { distance_um },
        }
    }

    /// Refuses a part where what keeps it off its path by more than `least_mm` is an axis that must not have a word.
    pub(crate) fn require_named(
        &self,
        follow: &Follow<'_, '_>,
        part: &Curve,
        least_mm: f64,
    ) -> Result<(), CorrectionError> {
        match self.furthest_unnamed(follow, part) {
            Some((axis, mm)) if mm > least_mm => {
                Err(CorrectionError::Unnamed { axis, distance_um: mm * 1e3 })
            }
            _ => Ok(()),
        }
    }

    pub(crate) fn note_end(&mut self, state: &Command, nominal: Vector, answer: Vector) {
        self.last = Some((Command { linear_mm: nominal, ..*state }, answer));
    }
}

/// What following a curve needs besides the corrector.
pub(crate) struct Follow<'a, 'm> {
    pub(crate) machine: Machine<'m>,
    pub(crate) block: &'a Block,
    /// The part is the whole motion, and nothing was put before it: the block's own words may stay.
    pub(crate) alone: bool,
    pub(crate) may_split: bool,
    /// The whole motion: shares are parts of its length.
    pub(crate) whole: Whole,
    /// Nominal end minus nominal start of the whole motion, mm.
    pub(crate) nominal_step: Vector,
    /// What is known of the part that an arc is tried for next.
    pub(crate) solved: Option<Solved>,
    /// What the model says of the arc whose halves are tried next.
    pub(crate) enclosed: Option<Enclosed>,
    /// Places of a line were solved together ([`Corrector::foresee_places`]).
    pub(crate) foreseen: bool,
    /// Where the rotary axes stand in the output, where they turn on the way.
    pub(crate) turning: Option<Turning>,
    /// Way of the linear axes that was written so far, mm: of turns only.
    pub(crate) commanded_mm: f64,
    pub(crate) corrected: &'a mut Corrected,
}

impl Follow<'_, '_> {
    /// Where the block's own words would bring the axes, as an axis command.
    ///
    /// Absolute words bring them to the nominal end; incremental ones add the nominal step to where they stand.
    pub(crate) fn own_end(&self, part: &Curve, standing: &Vector) -> Vector {
        self.block.own_end(standing, &self.nominal_step, &part.at(1.0))
    }

    /// The words of a piece: the block's own may stay where it stands for the block.
    pub(crate) fn freedom(&self, hold: [bool; 3]) -> Freedom {
        Freedom::of(self.block.may_have_words()).keeping(self.alone).holding(hold)
    }

    pub(crate) fn share(&self, part: &Curve) -> f64 {
        if self.whole.length_mm > 0.0 { part.length_mm() / self.whole.length_mm } else { 1.0 }
    }
}

fn one(piece: Piece, correction: Correction) -> Corrected {
    let untouched = piece.axes.iter().all(|word| matches!(word, Goal::AsStated | Goal::Stays));
    Corrected::block(piece, untouched, correction)
}
