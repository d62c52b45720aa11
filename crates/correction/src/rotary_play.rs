//! Play of rotary axes: what they carry stands until the play is taken up, and is led at its arm by the linear axes.
//!
//! Rotary words are not corrected. A turn that goes back is cut where the play is taken up: until there the model has the
//! table standing while its command runs, behind it the table runs with its command, and along either the error is as
//! smooth as without play. Where no word of the axis lies between, a piece is proven before and behind the corner, each by
//! itself. What the tables of both directions differ by moves the tool at once: by half of that it is led aside before.
//! Equation (25), with the angle for the place.

use machine_model::{Command, Play, RotaryPlay, SAME_PLACE_RAD, Vector};
use smallvec::SmallVec;
use toolpath::Partial;

use crate::corrector::Corrector;
use crate::curve::Curve;
use crate::deviation::{Begun, Machine, Pair, Verdict};
use crate::direction::heading;
use crate::error::CorrectionError;
use crate::follow::Follow;
use crate::turning::RotaryWords;

/// Of a piece, what lies nearer to its end is that end.
const AT_AN_END: f64 = 1e-9;

/// How the rotary axes stand in their play along a piece.
pub(crate) struct Swing {
    /// Behind it.
    pub(crate) play: Play,
    /// At its start and at its end, said of the same sides; between, the lag runs evenly.
    pub(crate) ends: [RotaryPlay; 2],
    /// Where on its way the play of an axis is taken up.
    corners: [Option<f64>; 3],
}

impl Swing {
    /// The play of some axis is taken up on the way.
    pub(crate) fn has_corners(&self) -> bool {
        self.corners != [None; 3]
    }
}

/// Where a piece is to be cut.
pub(crate) struct Corner {
    pub(crate) s: f64,
    pub(crate) distance_mm: f64,
}

impl<'m> Corrector<'m> {
    /// The rotary axes have turned to a place, each one way only; of some it may not be known.
    pub(crate) fn swung_to(&mut self, place: &Partial) {
        if self.model.has_rotary_play() {
            let to = standing(place.rotary_deg.map(f64::to_radians).into());
            self.play.turn(self.model, &to, place.rotary_known);
        }
    }

    /// Where rotary axes stand in their play that are commanded to A, B and C, rad.
    pub(crate) fn rotary_play(&self, rotary_rad: Vector) -> RotaryPlay {
        if !self.model.has_rotary_play() {
            return RotaryPlay::default();
        }
        self.play.rotary(self.model, &standing(rotary_rad))
    }

    /// What the play does while the rotary axes turn from where a state has them; `None` where there is none.
    pub(crate) fn swing(&self, from: &Command, to_rad: Vector) -> Option<Swing> {
        if !self.model.has_rotary_play() {
            return None;
        }
        let (model, to) = (self.model, Command { rotary_rad: to_rad, ..*from });
        let mut play = self.play;
        play.turn(model, &to, [true; 3]);
        let way = to_rad - from.rotary_rad;
        // A rounding turns nothing: an axis whose word says its place again may differ from it by a last bit.
        let turns = |axis: usize| way[axis].abs() > SAME_PLACE_RAD;
        let heading = [0, 1, 2].map(|axis| if turns(axis) { heading(0.0, way[axis], 0) } else { 0 });
        let to_go = self.play.rotary_lag_rad(model, from, heading);
        let (mut direction, mut corners) = (self.play.rotary_side(), [None; 3]);
        for axis in (0..3).filter(|axis| heading[*axis] != 0) {
            let corner = to_go[axis] / way[axis].abs();
            if corner < 1.0 - AT_AN_END {
                direction[axis] = heading[axis];
                corners[axis] = Some(corner).filter(|s| (AT_AN_END..1.0).contains(s));
            }
        }
        let ends = [self.play.rotary_on(model, from, direction), play.rotary_on(model, &to, direction)];
        Some(Swing { play, ends, corners })
    }

    /// The first place between its ends where a piece has to be cut, for the play of a rotary axis is taken up there, and
    /// words of that axis can say so.
    pub(crate) fn corner(
        &self,
        follow: &Follow<'_, 'm>,
        part: &Curve,
        swing: &Swing,
        end: &RotaryWords,
    ) -> Option<Corner> {
        if !follow.may_split || self.is_too_short(follow.block, part) {
            return None;
        }
        let between = |axis: usize| {
            let s = swing.corners[axis]?;
            let stands = follow.machine.state.rotary_rad[axis];
            let word = |s: f64| Some(follow.rotary_words(&part.part(0.0, s))?.end_rad[axis]);
            let apart = |there: f64| there != stands && there != end.end_rad[axis];
            if apart(word(s)?) {
                return Some(s);
            }
            // Less than half a step from here: alone in a piece of one step it is least off.
            let one_step = follow.block.rotary_step_rad(axis) / (end.end_rad[axis] - stands).abs();
            (s < one_step && one_step < 1.0 && apart(word(one_step)?)).then_some(one_step)
        };
        let s = (0..3).filter_map(between).min_by(f64::total_cmp)?;
        Some(Corner { s, distance_mm: self.beside_corners_mm(follow, part, swing, end.end_rad) })
    }

    /// What is proven of a piece on whose way the play of rotary axes is taken up: between two such places each axis has one
    /// side, and its lag runs evenly.
    pub(crate) fn verdict_by_corners(
        &self,
        machine: &Machine<'_>,
        pair: &Pair<'_>,
        swing: &Swing,
        limit_mm: f64,
    ) -> Verdict {
        let mut places: SmallVec<[f64; 5]> = SmallVec::from_slice(&[0.0, 1.0]);
        places.extend(swing.corners.into_iter().flatten());
        places.sort_by(f64::total_cmp);
        let at = |s: f64| {
            let rotary_rad = pair.commanded.rotary_rad(s).unwrap_or(machine.state.rotary_rad);
            Command { linear_mm: pair.commanded.at(s), rotary_rad, ..machine.state }
        };
        let (old, new) = (self.play.rotary_side(), swing.ends[1].direction);
        let mut worst = 0.0_f64;
        for ends in places.windows(2).filter(|ends| ends[0] < ends[1]) {
            let (from, to) = (ends[0], ends[1]);
            let direction = [0, 1, 2].map(|axis| match swing.corners[axis] {
                Some(corner) if corner > from => old[axis],
                _ => new[axis],
            });
            let stands = |s: f64| {
                let mut play = self.play;
                play.turn(self.model, &at(s), [true; 3]);
                play.rotary_on(self.model, &at(s), direction)
            };
            let play = [from, to].map(stands);
            let mut machine = machine.clone();
            machine.state.rotary_play = play[0];
            machine.lag_rad = Some(play.map(|play| play.lag_rad));
            let [wanted, commanded] = [pair.wanted, pair.commanded].map(|curve| curve.part(from, to));
            let begun = if from > 0.0 { Begun::Inside } else { pair.begun };
            let part = Pair { wanted: &wanted, commanded: &commanded, begun, ..*pair };
            match part.line_verdict_by(&machine, None, limit_mm) {
                Verdict::Within(bound_mm) => worst = worst.max(bound_mm),
                Verdict::Beyond { s, distance_mm } => {
                    return Verdict::Beyond { s: from + (to - from) * s, distance_mm };
                }
            }
        }
        Verdict::Within(worst)
    }

    /// Before rotary axes turn back at the start of a part, leads the tool aside by half of what their tables of both directions
    /// differ by there; the part undoes the other half. True where a line for that was written: without it no part holds,
    /// however short.
    ///
    /// # Errors
    /// [`CorrectionError::Sideways`] where half of it is too much.
    pub(crate) fn meet_halfway(
        &mut self,
        follow: &mut Follow<'_, 'm>,
        part: &Curve,
    ) -> Result<bool, CorrectionError> {
        let Some(rotary) = follow.rotary_words(part).filter(|words| words.turning.directed.is_none()) else {
            return Ok(false);
        };
        let from = follow.machine.state;
        let Some(swing) = self.swing(&from, rotary.end_rad) else { return Ok(false) };
        let ([Some(x), Some(y), Some(z)], true) = (self.standing, follow.may_split) else { return Ok(false) };
        if self.model.depends_on_direction() {
            return Ok(false);
        }
        let way = (rotary.end_rad - from.rotary_rad).abs();
        let old = self.rotary_play(from.rotary_rad);
        let turns_here = |axis: usize| {
            let corner_rad = swing.corners[axis].unwrap_or(0.0) * way[axis];
            old.direction[axis] != 0
                && swing.ends[1].direction[axis] != old.direction[axis]
                && corner_rad <= follow.block.rotary_step_rad(axis)
        };
        let (mut direction, mut lag_rad) = (old.direction, old.lag_rad);
        for axis in (0..3).filter(|axis| turns_here(*axis)) {
            (direction[axis], lag_rad[axis]) = (swing.ends[1].direction[axis], 0.0);
        }
        let start = follow.machine.target(part, 0.0);
        let limit_mm = self.limit_mm(follow.block);
        let state = |rotary_play: RotaryPlay| Command { rotary_play, ..from };
        let sides = [old, RotaryPlay { direction, lag_rad }].map(state);
        let off_mm = |here: Vector, state: &Command| {
            (here - start + self.model.error_mm(&Command { linear_mm: here, ..*state })).norm()
        };
        if direction == old.direction || off_mm(Vector::new(x, y, z), &sides[1]) <= limit_mm {
            return Ok(false);
        }
        let halfway = 0.5 * (self.solve(&sides[0], start)? + self.solve(&sides[1], start)?);
        let before = self.clone();
        let (written, correction) = (follow.corrected.pieces.len(), follow.corrected.correction);
        let length_mm = follow.whole.length_mm;
        let led =
            self.approach_to(&follow.machine, halfway, start, follow.block, length_mm, follow.corrected)?;
        let here = self.standing_or(&start);
        let off_mm = sides.map(|state| off_mm(here, &state)).into_iter().fold(0.0, f64::max);
        if off_mm > limit_mm && follow.block.named == [true; 3] {
            let tolerance_um = self.options.tolerance_mm * 1e3;
            return Err(CorrectionError::Sideways { distance_um: off_mm * 1e3, tolerance_um });
        }
        if !led || off_mm > limit_mm {
            // What keeps the tool away may be an axis that must not have a word: the caller says so.
            *self = before;
            follow.corrected.pieces.truncate(written);
            follow.corrected.correction = correction;
            return Ok(false);
        }
        follow.alone = false;
        let after_mm = &mut follow.corrected.correction.after_mm;
        *after_mm = after_mm.max(off_mm);
        Ok(true)
    }

    /// By how much the corners of a piece that is not cut there leave what is straight, mm; with what changes there besides
    /// the angle.
    pub(crate) fn beside_corners_mm(
        &self,
        follow: &Follow<'_, 'm>,
        part: &Curve,
        swing: &Swing,
        to_rad: Vector,
    ) -> f64 {
        let (from, sides) = (&follow.machine.state, self.play.rotary_side());
        let off = |axis: usize| {
            let Some(s) = swing.corners[axis] else { return 0.0 };
            let rotary_rad = from.rotary_rad + (to_rad - from.rotary_rad) * s;
            let error = |rotary_play: RotaryPlay| {
                let at = Command { linear_mm: part.at(s), rotary_rad, rotary_play, ..*from };
                self.model.error_mm(&at)
            };
            let taken_up = RotaryPlay { direction: swing.ends[1].direction, lag_rad: Vector::zeros() };
            let mut even = taken_up;
            even.lag_rad[axis] = swing.ends[0].lag_rad[axis] * (1.0 - s) + swing.ends[1].lag_rad[axis] * s;
            let mut before = taken_up;
            let side = sides[axis];
            before.direction[axis] = side;
            let at = Command { linear_mm: part.at(s), rotary_rad, ..*from };
            let width = self.model.rotary_reversal_rad(axis, &at).max(0.0);
            // The same place of what it carries, on the other side.
            before.lag_rad[axis] = 0.5 * width * f64::from(side - taken_up.direction[axis]);
            (error(even) - error(taken_up)).norm() + (error(before) - error(taken_up)).norm()
        };
        (0..3).map(off).sum()
    }

    /// By how much the tool may be off, mm, for rotary axes on an unknown side of their play; as
    /// [`Corrector::unknown_side_mm`].
    pub(crate) fn unknown_swing_mm(&self, at: &Command) -> f64 {
        if !self.model.has_rotary_play() {
            return 0.0;
        }
        let unsure_rad = self.play.rotary_unsure_rad(self.model, at);
        let error = |rotary_play: RotaryPlay| self.model.error_mm(&Command { rotary_play, ..*at });
        let turns = self.model.rotary_axes();
        let off = |axis: usize| {
            let mut other = at.rotary_play;
            match other.direction[axis] {
                _ if !turns[axis] => 0.0,
                0 => {
                    let [up, down] = [1, -1].map(|side| {
                        other.direction[axis] = side;
                        error(other)
                    });
                    0.5 * (up - down).norm()
                }
                _ if unsure_rad[axis] == 0.0 => 0.0,
                _ => {
                    other.lag_rad[axis] += unsure_rad[axis];
                    (error(other) - error(at.rotary_play)).norm()
                }
            }
        };
        (0..3).map(off).sum()
    }
}

/// Rotary axes that are commanded so, whatever else is.
fn standing(rotary_rad: Vector) -> Command {
    Command { rotary_rad, ..Default::default() }
}
