//! One motion at a time.

use machine_model::{Command, LANES, Vector};
use smallvec::SmallVec;
use toolpath::{Division, Feed, Kinematics, Motion, Partial, Shape};

use crate::corrected::{Corrected, Correction, Directed, one};
use crate::corrector::{Corrector, Freedom, MOST_TURNS};
use crate::curve::Curve;
use crate::error::CorrectionError;
use crate::follow::{Follow, Turning, Whole};
use crate::grid::{Block, Goal};
use crate::options::{Options, Orientation};
use crate::short_line::Run;
use crate::{Piece, PieceKind};

/// Where the tolerance cannot be held so many of it are tried.
const WIDER: [f64; 6] = [1.25, 1.6, 2.0, 3.0, 5.0, 8.0];

impl Corrector<'_> {
    /// Corrects one motion of a block; where the tolerance cannot be held, as near as can be proven, up to
    /// [`Options::accept_mm`](crate::Options::accept_mm).
    ///
    /// # Errors
    /// [`CorrectionError`] where the promise cannot be kept; nothing of the motion may be used then.
    pub fn correct(&mut self, motion: &Motion, block: &Block) -> Result<Corrected, CorrectionError> {
        let before = self.clone();
        self.correct_within(motion, block).or_else(|error| self.correct_beyond(error, &before, motion, block))
    }

    /// What the tolerance cannot hold, as near as it can be within what is accepted; else the error, which says all that
    /// would have to be.
    fn correct_beyond(
        &mut self,
        error: CorrectionError,
        before: &Self,
        motion: &Motion,
        block: &Block,
    ) -> Result<Corrected, CorrectionError> {
        let Options { tolerance_mm, accept_mm, .. } = self.options;
        if error.off_mm().is_some_and(|off_mm| off_mm <= accept_mm) {
            let wider_mm = WIDER.map(|times| times * tolerance_mm).into_iter().filter(|mm| *mm < accept_mm);
            if let Some((_, held)) = self.held_within(wider_mm.chain([accept_mm]), before, motion, block) {
                return Ok(held);
            }
        }
        let CorrectionError::Unnamed { axis, distance_um } = error else { return Err(error) };
        // What this axis alone is off is less than what would have to be accepted.
        let least_mm = (1e-3 * distance_um).max(accept_mm);
        let wider_mm = [1.0].into_iter().chain(WIDER).map(|times| times * least_mm);
        let distance_um = match self.held_within(wider_mm, before, motion, block) {
            Some((_, held)) if held.correction.after_mm > accept_mm => 1e3 * held.correction.after_mm,
            Some((mm, _)) => 1e3 * mm,
            None => distance_um,
        };
        Err(CorrectionError::Unnamed { axis, distance_um })
    }

    /// The same by the narrowest of wider tolerances that holds, and that tolerance, mm.
    fn held_within(
        &mut self,
        wider_mm: impl IntoIterator<Item = f64>,
        before: &Self,
        motion: &Motion,
        block: &Block,
    ) -> Option<(f64, Corrected)> {
        let tolerance_mm = self.options.tolerance_mm;
        wider_mm.into_iter().find_map(|mm| {
            self.clone_from(before);
            self.options.tolerance_mm = mm;
            let corrected = self.correct_within(motion, block);
            self.options.tolerance_mm = tolerance_mm;
            let mut corrected = corrected.ok()?;
            corrected.correction.accepted = true;
            Some((mm, corrected))
        })
    }

    fn correct_within(&mut self, motion: &Motion, block: &Block) -> Result<Corrected, CorrectionError> {
        if block.kinematics != self.kinematics {
            self.switch(block.kinematics)?;
        }
        if !matches!(motion, Motion::Hole(_)) {
            self.expanding = false;
            self.remembered = None;
        }
        match motion {
            Motion::Rapid { start, end } => {
                self.swung_to(start);
                self.swung_to(end);
                self.heed(block, end.rotary_deg);
            }
            Motion::Feed(feed) => {
                self.swung_to(&feed.start.into());
                self.heed(block, feed.end.rotary_deg);
            }
            Motion::Hole(hole) => {
                self.swung_to(&hole.at_r.into());
                self.heed(block, hole.at_r.rotary_deg);
            }
            Motion::Uncorrected { end, .. } => self.swung_to(end),
        }
        self.approached = None;
        self.lead = None;
        match self.options.orientation {
            Orientation::Full(limits) => self.correct_directed(motion, block, &limits),
            Orientation::Tip => {
                let mut corrected = self.correct_plain(motion, block)?;
                if let Motion::Feed(feed) = motion
                    && self.turns_the_tool()
                {
                    let leans_rad = self.leans_rad(feed, block);
                    corrected.correction.directed =
                        Some(Directed { before_rad: leans_rad, after_rad: leans_rad, held: false });
                }
                Ok(corrected)
            }
        }
    }

    /// Corrects a motion whose rotary words stay as they are, but for those of [`Corrector::directed_words`].
    pub(crate) fn correct_plain(
        &mut self,
        motion: &Motion,
        block: &Block,
    ) -> Result<Corrected, CorrectionError> {
        self.correct_in_state(motion, block).map_err(|error| self.as_turned(error, block))
    }

    /// True where a direction of the tool is to be reported: of a machine whose rotary axes have errors or carry the tool.
    fn turns_the_tool(&self) -> bool {
        let plain = self.everywhere.as_ref().is_some_and(|known| known.2.is_some());
        !plain && self.model.rotary_axes() != [false; 3]
    }

    /// From here on X, Y and Z are something else. Where they still say the same, the motions tell.
    pub(crate) fn switch(&mut self, kinematics: Kinematics) -> Result<(), CorrectionError> {
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
            Motion::Uncorrected { end, .. } => {
                self.in_travel(end, block)?;
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

    /// That the control can turn the rotary axes where a block's words send them, in a motion that is not corrected.
    fn in_travel(&self, end: &Partial, block: &Block) -> Result<(), CorrectionError> {
        let named = [0, 1, 2].map(|axis| block.stated.rotary[axis] && end.rotary_known[axis]);
        if named != [false; 3] {
            self.model.in_travel(&self.state(block, end.rotary_deg), named)?;
        }
        Ok(())
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
            self.in_travel(end, block)?;
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
                Err(CorrectionError::Solve(error)) if error.is_outside() => {
                    correction.clamped = true;
                    self.nearest(&state, end_mm)
                }
                other => other?,
            };
            // Positioning moves what the block names and nothing else: the other axes take their correction from the
            // next feed.
            let freedom = Freedom::of(block.stated.axes).keeping_words().holding(block.held(&from, &end_mm));
            let axes = self.go(block, &own_end, &wanted, &freedom);
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

    pub(crate) fn feed(&mut self, feed: &Feed, block: &Block) -> Result<Corrected, CorrectionError> {
        if let Shape::Bezier(curve) = &feed.shape {
            return self.curve(feed, curve, block);
        }
        if matches!(feed.shape, Shape::Line)
            && self.lead.is_none()
            && feed.start.rotary_deg == feed.end.rotary_deg
            && block.held(&feed.start.linear_mm.into(), &feed.end.linear_mm.into()) == [false; 3]
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
            Curve::of(feed)
        } else {
            Curve::new(feed.start.linear_mm.into(), feed.end.linear_mm.into(), &feed.shape)
        };
        let lead = self.lead.take();
        let mut corrected =
            Corrected { pieces: lead.into_iter().collect(), correction: Correction::default() };
        corrected.correction.approach = !corrected.pieces.is_empty();
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
        if feed.division.is_offset() && !alone {
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
                if let Some(standing) = self.standing_at(feed) {
                    machine.state.rotary_rad = standing.rotary_rad();
                }
                (machine.everywhere, machine.turns) = (None, true);
            }
            self.approach(&mut machine, &part, block, &motion, &mut corrected)?;
            let mut follow = Follow {
                machine,
                block,
                alone: alone && corrected.pieces.is_empty(),
                may_split: self.may_split(feed.division) && self.guessed_own(block).is_none(),
                whole: motion,
                nominal_step: Vector::from(feed.end.linear_mm) - Vector::from(feed.start.linear_mm),
                solved: None,
                enclosed: None,
                foreseen: false,
                turning: turning.then(|| Turning { directed: self.standing_at(feed), ..Turning::of(feed) }),
                commanded_mm: 0.0,
                leans_rad: None,
                corrected: &mut corrected,
            };
            match feed.shape {
                Shape::Line | Shape::Bezier(_) => self.follow_line(&mut follow, &part)?,
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
            if let Some(standing) = follow.turning.and_then(|turning| turning.directed) {
                self.stand_at(&standing, feed.end.rotary_deg);
            }
            let state = follow.machine.state;
            self.settle(&state, block);
        }
        self.swung_to(&feed.end.into());
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

    /// Whether a motion may become several. On a machine with play a take-up could come between pieces that are offset.
    fn may_split(&self, division: Division) -> bool {
        match division {
            Division::Any => true,
            Division::Long { .. } => !self.model.depends_on_direction(),
            Division::OneBehindLines | Division::One | Division::LongClimbing { .. } => false,
        }
    }

    /// Why a motion on whose way axes with play turn cannot stay one block: by their play the tool would be off.
    fn turns_in_one_block(&self, whole: &Curve, block: &Block, rotary_deg: [f64; 3]) -> CorrectionError {
        let state = self.state(block, rotary_deg);
        let at = whole.turns().into_iter().map(|s| Command { linear_mm: whole.at(s), ..state });
        let play_mm = at.flat_map(|at| [0, 1, 2].map(|axis| self.model.reversal_mm(axis, &at).abs()));
        CorrectionError::MustNotSplit { distance_um: play_mm.fold(0.0, f64::max) * 1e3 }
    }

    /// A line to where the axes stand, with a word for each axis that the block names, or for the first that may have one.
    pub(crate) fn standstill(&self, block: &Block) -> Result<Piece, CorrectionError> {
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
}
