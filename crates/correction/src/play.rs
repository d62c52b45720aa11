//! Lost motion: an axis that is told to turn back stands still until its play is taken up. Equation (25).
//!
//! A correction can tell an axis to creep a few micrometres against the direction it last came from while
//! another axis feeds: along a bow, or where axes are out of square. With play the axis does not follow. So
//! no block of output moves an axis against the direction its position was computed for: the axis either
//! holds its place (where that is within tolerance), or the play is taken up first and the way is computed
//! for the new direction. An axis that the output does not move at all, whatever the program said, is computed for the side
//! of its play on which it stands. Only models whose error depends on the direction need any of this.

use machine_model::Vector;

use crate::corrector::{CorrectionError, Corrector, Follow};
use crate::curve::{Curve, SAME_PLACE_MM};
use crate::grid::Block;

/// Which way an axis goes; one that does not move keeps its direction.
#[inline]
pub(crate) fn heading(from: f64, to: f64, otherwise: i8) -> i8 {
    if to > from {
        1
    } else if to < from {
        -1
    } else {
        otherwise
    }
}

/// The side of its play to which an axis goes; one that does not move stays on the side to which it `came`.
pub(crate) fn side(from: f64, to: f64, came: i8) -> i8 {
    if (to - from).abs() > SAME_PLACE_MM { heading(from, to, came) } else { came }
}

/// Axes that are on another side of their play than was computed for.
#[derive(Clone, Copy)]
pub(crate) struct Against {
    /// The sides of all axes, by the direction of the motion that leads there.
    sides: [i8; 3],
    /// Those that are on another side.
    turned: [bool; 3],
}

/// What became of a try to follow a curve with one block.
pub(crate) enum Tried {
    /// Its block is written.
    Done,
    /// Axes would have moved against the direction they were computed for, or not moved to its side.
    Against(Against),
    /// Too far from the path, mm.
    Beyond {
        /// How far.
        distance_mm: f64,
        /// Where to split.
        s: f64,
    },
}

/// Follows a curve with one block, the marked axes holding their place.
pub(crate) type Try<'m> =
    fn(&mut Corrector<'m>, &mut Follow<'_, 'm>, &Curve, [bool; 3]) -> Result<Tried, CorrectionError>;

impl<'m> Corrector<'m> {
    /// The sides of their play on which the axes are, brought from `before` to `reached`, where these are not all of
    /// `direction`. An axis that does not move stays on the side to which it `came` earlier; one without a place is
    /// not asked.
    ///
    /// In a turned frame every axis moves by the rounding of all: there the question has no answer, and nothing
    /// but rapids is corrected.
    pub(crate) fn against(
        &self,
        before: [Option<f64>; 3],
        reached: [Option<f64>; 3],
        came: [i8; 3],
        direction: [i8; 3],
        block: &Block,
    ) -> Option<Against> {
        if !self.model.depends_on_direction() || !block.frame.is_axial() {
            return None;
        }
        let mut against = Against { sides: self.direction, turned: [false; 3] };
        for i in 0..3 {
            let (Some(from), Some(to)) = (before[i], reached[i]) else { continue };
            against.sides[i] = side(from, to, came[i]);
            against.turned[i] = against.sides[i] != direction[i];
        }
        against.turned.contains(&true).then_some(against)
    }

    /// Turns the axes the way they went from `before`: in a turned frame each moves by the rounding of all.
    pub(crate) fn turn_as_moved(&mut self, before: [Option<f64>; 3]) {
        for (i, from) in before.into_iter().enumerate() {
            if let (Some(from), Some(to)) = (from, self.standing[i]) {
                self.direction[i] = side(from, to, self.direction[i]);
            }
        }
    }

    /// Turns axes: what is computed from here on is for these directions.
    pub(crate) fn turn(&mut self, against: Against) {
        self.direction = against.sides;
    }

    /// One block for a curve; where axes would creep against their direction they hold their place, or turn first.
    pub(crate) fn with_play(
        &mut self,
        follow: &mut Follow<'_, 'm>,
        part: &Curve,
        attempt: Try<'m>,
    ) -> Result<Tried, CorrectionError> {
        let against = match attempt(self, follow, part, [false; 3])? {
            Tried::Against(against) => against,
            other => return Ok(other),
        };
        if let Tried::Done = attempt(self, follow, part, against.turned)? {
            return Ok(Tried::Done);
        }
        let before = self.clone();
        let (machine, alone, came) = (follow.machine.clone(), follow.alone, follow.came);
        let (written, correction) = (follow.corrected.pieces.len(), follow.corrected.correction);
        self.turn(against);
        follow.machine.state.direction = self.direction;
        self.approach(&mut follow.machine, part, follow.block, &mut follow.came, follow.corrected)?;
        follow.alone &= follow.corrected.pieces.len() == written;
        let (distance_mm, s) = match attempt(self, follow, part, [false; 3])? {
            Tried::Done => return Ok(Tried::Done),
            Tried::Beyond { distance_mm, s } => (distance_mm, s),
            Tried::Against(again) => match attempt(self, follow, part, again.turned)? {
                Tried::Done => return Ok(Tried::Done),
                Tried::Beyond { distance_mm, s } => (distance_mm, s),
                Tried::Against(_) => (f64::INFINITY, 0.5),
            },
        };
        // Turning did not help either: the caller splits, and each part decides anew.
        *self = before;
        (follow.machine, follow.alone, follow.came) = (machine, alone, came);
        follow.corrected.pieces.truncate(written);
        follow.corrected.correction = correction;
        Ok(Tried::Beyond { distance_mm, s })
    }

    /// The directions with those of the axes that are not known and that an approach would move.
    pub(crate) fn first_moves(&self, wanted: &Vector, direction: [i8; 3], block: &Block) -> Option<[i8; 3]> {
        if !self.model.depends_on_direction() || !block.frame.is_axial() {
            return None;
        }
        let mut found = direction;
        for i in 0..3 {
            let Some(standing) = self.standing[i] else { continue };
            if direction[i] == 0 && (wanted[i] - standing).abs() > 0.5 * block.axis_step_mm(i) {
                found[i] = heading(standing, wanted[i], 0);
            }
        }
        (found != direction).then_some(found)
    }

    /// Where the approach to a corrected start shall bring the axes, `wanted` being that start.
    ///
    /// An axis that stands a little too far on its way holds its place: going back would put it into its play.
    /// One that stands much too far must come again from behind: it is returned as to be turned first.
    pub(crate) fn approachable(
        &self,
        wanted: &mut Vector,
        direction: [i8; 3],
        block: &Block,
    ) -> Option<[i8; 3]> {
        if !self.model.depends_on_direction() || !block.frame.is_axial() {
            return None;
        }
        let mut turned = [0; 3];
        for i in 0..3 {
            let Some(standing) = self.standing[i] else { continue };
            let way = wanted[i] - standing;
            if way * f64::from(direction[i]) < 0.0 {
                if way.abs() <= 0.5 * self.options.tolerance_mm + block.axis_step_mm(i) {
                    wanted[i] = standing;
                } else {
                    turned[i] = -direction[i];
                }
            }
        }
        (turned != [0; 3]).then_some(turned)
    }
}
