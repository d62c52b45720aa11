//! Play of rotary axes: what they carry stands until the play is taken up, and is led at its arm by the linear axes.
//!
//! Rotary words are not corrected. A turn that goes back is cut where the play is taken up: until there the model has the
//! table standing while its command runs, behind it the table runs with its command, and along either the error is as
//! smooth as without play. Where no word of the axis lies between, what the corner is off the straight is added to the
//! bound. Equation (25), with the angle for the place.

use machine_model::{Command, Play, RotaryPlay, Vector};
use toolpath::Partial;

use crate::corrector::Corrector;
use crate::curve::Curve;
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
        let heading = [0, 1, 2].map(|axis| i8::from(way[axis] > 0.0) - i8::from(way[axis] < 0.0));
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
        let off = |axis: usize| {
            let mut other = at.rotary_play;
            if other.direction[axis] != 0 {
                other.lag_rad[axis] += unsure_rad[axis];
                return (error(other) - error(at.rotary_play)).norm();
            }
            let [up, down] = [1, -1].map(|side| {
                other.direction[axis] = side;
                error(other)
            });
            0.5 * (up - down).norm()
        };
        (0..3).map(off).sum()
    }
}

/// Rotary axes that are commanded so, whatever else is.
fn standing(rotary_rad: Vector) -> Command {
    Command {
        linear_mm: Vector::zeros(),
        rotary_rad,
        tool_mm: Vector::zeros(),
        direction: [0; 3],
        rotary_play: RotaryPlay::default(),
    }
}
