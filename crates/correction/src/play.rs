//! Lost motion: an axis that is told to turn back stands still until its play is taken up. Equations (25) to (27).
//!
//! Where the axes stand in their play is [`machine_model::Play`], carried along everything that is written. A position is
//! computed for a side of each axis' play, and a correction can tell an axis to creep a few micrometres against that side
//! while another axis feeds: along a bow, or where axes are out of square. With play the axis does not follow. So no block
//! of output moves an axis against its side where that can be helped: the axis either holds its place, or is turned first
//! ([`crate::approach`]), and the way is computed for the new side. What then still creeps, or has some of its play to
//! take up, is added to the bound. Only models whose error depends on the direction need any of this.

use machine_model::{Command, Vector, turned_by_mm};
use smallvec::SmallVec;

use crate::corrector::Corrector;
use crate::curve::{Curve, SAME_PLACE_MM};
use crate::deviation::{Begun, Machine, Pair, Verdict};
use crate::direction::moved;
use crate::error::CorrectionError;
use crate::follow::Follow;
use crate::grid::Block;
use crate::rotary_play::Corner;

/// Axes that are on another side of their play than was computed for.
#[derive(Clone, Copy)]
pub(crate) struct Against {
    /// The sides of all axes, by the direction of the motion that leads there.
    sides: [i8; 3],
    /// Those that are on another side.
    turned: [bool; 3],
    /// How far off the tool is with that, mm.
    distance_mm: f64,
}

/// What a block may do about axes that would creep against their side.
#[derive(Clone, Copy)]
pub(crate) enum Creep {
    /// None may.
    Never,
    /// The marked ones hold their place.
    Hold([bool; 3]),
    /// They may, inside their play: the bound says what it costs.
    Counted,
}

impl Creep {
    pub(crate) fn held(self) -> [bool; 3] {
        if let Self::Hold(axes) = self { axes } else { [false; 3] }
    }
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
    /// The play of a rotary axis is taken up on the way: to be split there, and nowhere near.
    Corner(Corner),
}

/// Follows a curve with one block.
pub(crate) type Try<'m> =
    fn(&mut Corrector<'m>, &mut Follow<'_, 'm>, &Curve, Creep) -> Result<Tried, CorrectionError>;

/// An axis that is not, all along a block, on the side that the block was computed for.
struct Astray {
    /// Up to which s.
    until: f64,
    /// What the tool is off by then, mm, by the most: along the axis, and with what lies across it.
    off: [Vector; 2],
}

/// An axis turns on a block, which moves the tool by up to so many mm.
struct Turns {
    by_mm: f64,
}

impl<'m> Corrector<'m> {
    /// The axes that a block or a positioning move would leave on another side than it was computed for, or move against that
    /// side; one without a place is not asked.
    ///
    /// * `state` – its directions are what was computed for
    pub(crate) fn against(
        &self,
        state: &Command,
        before: [Option<f64>; 3],
        reached: [Option<f64>; 3],
        block: &Block,
    ) -> Option<Against> {
        if !self.model.depends_on_direction() {
            return None;
        }
        let linear_mm = [0, 1, 2].map(|i| reached[i].or(before[i]).unwrap_or(0.0)).into();
        let at = Command { linear_mm, ..*state };
        let mut play = self.play;
        play.go(self.model, &at);
        let lag_mm = play.lag_mm(self.model, &at, state.direction);
        let mut against = Against { sides: self.direction, turned: [false; 3], distance_mm: 0.0 };
        for i in 0..3 {
            let (Some(from), Some(to)) = (before[i], reached[i]) else { continue };
            against.sides[i] = match moved(from, to) {
                0 => play.side()[i],
                // All its play but a rounding is taken up.
                heading if heading == state.direction[i] && lag_mm[i] > block.largest_step_mm() => {
                    play.side()[i]
                }
                heading => heading,
            };
            against.turned[i] = against.sides[i] != state.direction[i];
            if against.turned[i] {
                against.distance_mm += turned_by_mm(self.model, &at, i).norm();
            }
        }
        against.turned.contains(&true).then_some(against)
    }

    /// Turns axes: what is computed from here on is for these directions.
    pub(crate) fn turn(&mut self, against: Against) {
        self.direction = against.sides;
    }

    /// The axes have gone along a curve.
    pub(crate) fn gone_along(&mut self, state: &Command, commanded: &Curve) {
        if self.model.depends_on_direction() {
            for s in commanded.turns().into_iter().chain([1.0]) {
                self.play.go(self.model, &Command { linear_mm: commanded.at(s), ..*state });
            }
        }
    }

    /// The axes have gone to where they stand, each one way only.
    pub(crate) fn gone(&mut self, state: &Command) {
        if self.model.depends_on_direction() {
            let linear_mm = self.standing.map(|mm| mm.unwrap_or(0.0)).into();
            self.play.go(self.model, &Command { linear_mm, ..*state });
            for axis in 0..3 {
                if self.standing[axis].is_none() {
                    self.play.forget(axis, None);
                }
            }
        }
    }

    /// Takes the sides on which the axes really are for those of the next motion.
    pub(crate) fn settle(&mut self, state: &Command, block: &Block) {
        if !self.model.depends_on_direction() {
            return;
        }
        let linear_mm = self.standing.map(|mm| mm.unwrap_or(0.0)).into();
        let at = Command { linear_mm, ..*state };
        let lag_mm = self.play.lag_mm(self.model, &at, self.direction);
        for (axis, side) in self.play.side().into_iter().enumerate() {
            let has_play = self.model.reversal_mm(axis, &at) > SAME_PLACE_MM;
            let nearly = has_play && lag_mm[axis] <= block.largest_step_mm();
            if side != 0 && !nearly {
                self.direction[axis] = side;
            }
        }
    }

    /// By how much the tool may be off at a place of the program, mm, for axes that stand on an unknown side of their play.
    ///
    /// Such an axis takes the middle of its play until it moves, and may then have taken up less than it seems.
    pub(crate) fn unknown_side_mm(&self, block: &Block, place: &toolpath::Position) -> f64 {
        let at = Command { linear_mm: place.linear_mm.into(), ..self.state(block, place.rotary_deg) };
        self.unknown_swing_mm(&at) + self.unknown_sides_mm(&at)
    }

    /// The same for the linear axes.
    fn unknown_sides_mm(&self, at: &Command) -> f64 {
        if !self.model.depends_on_direction() {
            return 0.0;
        }
        let unsure_mm = self.play.unsure_mm(self.model, at);
        let side = self.play.side();
        let off = |axis: usize| {
            let turns_by = turned_by_mm(self.model, at, axis);
            match side[axis] {
                0 => 0.5 * turns_by.norm(),
                _ if unsure_mm[axis] > 0.0 => {
                    let across = turns_by - Vector::ith(axis, turns_by[axis]);
                    (unsure_mm[axis] * unsure_mm[axis] + across.norm_squared()).sqrt()
                }
                _ => 0.0,
            }
        };
        (0..3).map(off).sum()
    }

    /// One block for a curve; where axes would creep against their side they hold their place, or turn first.
    pub(crate) fn with_play(
        &mut self,
        follow: &mut Follow<'_, 'm>,
        part: &Curve,
        attempt: Try<'m>,
    ) -> Result<Tried, CorrectionError> {
        let against = match attempt(self, follow, part, Creep::Never)? {
            Tried::Against(against) => against,
            other => return Ok(other),
        };
        // In a turned frame no axis can be held: each word moves several.
        let held = if follow.block.frame.is_axial() { Creep::Hold(against.turned) } else { Creep::Counted };
        if let Tried::Done = attempt(self, follow, part, held)? {
            return Ok(Tried::Done);
        }
        let before = self.clone();
        let (machine, alone) = (follow.machine.clone(), follow.alone);
        let (written, correction) = (follow.corrected.pieces.len(), follow.corrected.correction);
        self.turn(against);
        follow.machine.state.direction = self.direction;
        let turned = self.approach(&mut follow.machine, part, follow.block, &follow.whole, follow.corrected);
        follow.alone &= follow.corrected.pieces.len() == written;
        let mut nearest = match turned {
            Ok(()) => match attempt(self, follow, part, Creep::Never)? {
                Tried::Against(again) => attempt(self, follow, part, Creep::Hold(again.turned))?,
                other => other,
            },
            Err(CorrectionError::Sideways { distance_um, .. }) => {
                Tried::Beyond { distance_mm: distance_um * 1e-3, s: 0.5 }
            }
            Err(error) => return Err(error),
        };
        if let Tried::Done = nearest {
            return Ok(Tried::Done);
        }
        // Turning did not help either.
        *self = before;
        (follow.machine, follow.alone) = (machine, alone);
        follow.corrected.pieces.truncate(written);
        follow.corrected.correction = correction;
        match attempt(self, follow, part, Creep::Counted)? {
            Tried::Done => return Ok(Tried::Done),
            Tried::Against(_) => {}
            other => nearest = other,
        }
        // The caller splits, and each part decides anew.
        Ok(match nearest {
            Tried::Against(again) => Tried::Beyond { distance_mm: again.distance_mm, s: 0.5 },
            other => other,
        })
    }

    /// Where a block for a part of a motion begins. Where an axis turns, what lies across it may have moved the tool along its path.
    pub(crate) fn begun(&self, follow: &Follow<'_, 'm>, part: &Curve) -> Begun {
        if !self.model.depends_on_direction() {
            Begun::No
        } else if follow.whole.begins_with(part) {
            Begun::Reached
        } else {
            Begun::Inside
        }
    }

    /// What is proven of a block with all axes on the sides it was computed for, with what its play adds.
    pub(crate) fn verdict_with_play(
        &self,
        machine: &Machine<'_>,
        pair: &Pair<'_>,
        verdict: Verdict,
        limit_mm: f64,
    ) -> Verdict {
        let Verdict::Within(bound_mm) = verdict else { return verdict };
        let distance_mm = self.bound_with_play(machine, pair, bound_mm);
        if distance_mm <= limit_mm {
            Verdict::Within(distance_mm)
        } else {
            Verdict::Beyond { s: 0.5, distance_mm }
        }
    }

    /// Upper bound of the distance from the path, mm, of a block that is proven to stay within `bound_mm` of it with all axes on the
    /// sides it was computed for: equation (26).
    fn bound_with_play(&self, machine: &Machine<'_>, pair: &Pair<'_>, bound_mm: f64) -> f64 {
        if !self.model.depends_on_direction() {
            return bound_mm;
        }
        let astray = match self.astray(&machine.state, pair.commanded) {
            Ok(astray) => astray,
            Err(Turns { by_mm }) => return bound_mm + by_mm,
        };
        if astray.is_empty() {
            return bound_mm;
        }
        let [first, last] = pair.differences(machine);
        let mut bound = bound_mm;
        // Every axis on its side, or off by either: all of them together, for each may come to its side by itself.
        for choice in 0..3_usize.pow(astray.len() as u32) {
            let (mut until, mut off, mut rest) = (1.0_f64, Vector::zeros(), choice);
            for one in &astray {
                if let Some(which) = (rest % 3).checked_sub(1) {
                    off += one.off[which];
                    until = until.min(one.until);
                }
                rest /= 3;
            }
            let ends = (first + off).norm().max((first + (last - first) * until + off).norm());
            bound = bound.max((ends + pair.leaves_chord_mm(machine, until)).min(bound_mm + off.norm()));
        }
        bound + self.across_turns_mm(machine, pair)
    }

    /// What lies across the axes is computed for where a block begins: so much it changes by while rotary axes turn, mm.
    fn across_turns_mm(&self, machine: &Machine<'_>, pair: &Pair<'_>) -> f64 {
        let Some(turn) = pair.turn(machine, 0.0, 1.0) else { return 0.0 };
        let at = |axis: usize, end: usize| {
            let (linear_mm, rotary_rad) = (pair.commanded.at(end as f64), turn.commanded_rad[end]);
            turned_by_mm(self.model, &Command { linear_mm, rotary_rad, ..machine.state }, axis)
        };
        (0..3).map(|axis| (at(axis, 1) - at(axis, 0)).norm()).sum()
    }

    /// Some axis is on another side for some of a block than it was computed for.
    pub(crate) fn is_astray(&self, state: &Command, commanded: &Curve) -> bool {
        self.astray(state, commanded).map_or(true, |astray| !astray.is_empty())
    }

    /// Axes that are on another side for some of a block, or that one turns on the way.
    fn astray(&self, state: &Command, commanded: &Curve) -> Result<SmallVec<[Astray; 3]>, Turns> {
        let mut all = SmallVec::new();
        let at = Command { linear_mm: commanded.at(0.0), ..*state };
        let (direction, side) = (state.direction, self.play.side());
        let (lag_mm, back_mm) =
            (self.play.lag_mm(self.model, &at, direction), commanded.goes_back_mm(direction));
        for axis in 0..3 {
            if direction[axis] == 0 || side[axis] == 0 {
                // Nobody knows, which is said apart.
                continue;
            }
            let heading = f64::from(direction[axis]);
            let width_mm = self.model.reversal_mm(axis, &at).max(0.0);
            let turns_back = back_mm[axis] > SAME_PLACE_MM;
            let along = |mm: f64| Vector::ith(axis, heading * mm);
            let across = || {
                let other = Command { direction: flipped(direction, axis), ..at };
                let own = Command { direction, ..at };
                self.model.error_mm(&other) - self.model.error_mm(&own) - along(width_mm)
            };
            if width_mm <= SAME_PLACE_MM {
                // It turns as soon as it moves.
                let on_its_side = side[axis] == direction[axis] || moves(commanded, axis);
                if turns_back || !on_its_side {
                    all.push(Astray { until: 1.0, off: [across(); 2] });
                }
                continue;
            }
            if turns_back && back_mm[axis] + lag_mm[axis] >= width_mm {
                return Err(Turns { by_mm: turned_by_mm(self.model, &at, axis).norm() });
            }
            let most_mm = lag_mm[axis] + back_mm[axis];
            // On its side, what lies across may have begun to change with what it creeps.
            let share = if side[axis] == direction[axis] { (most_mm / width_mm).min(1.0) } else { 1.0 };
            let aside = across() * share;
            if turns_back || lag_mm[axis] > 0.0 || side[axis] != direction[axis] {
                let until = if turns_back { 1.0 } else { gone_by(commanded, axis, lag_mm[axis]) };
                all.push(Astray { until, off: [along(most_mm), along(most_mm) + aside] });
            }
        }
        Ok(all)
    }
}

/// The directions with that of one axis the other way round.
pub(crate) fn flipped(mut direction: [i8; 3], axis: usize) -> [i8; 3] {
    direction[axis] = -direction[axis];
    direction
}

/// An axis moves on a curve.
fn moves(curve: &Curve, axis: usize) -> bool {
    let start = curve.at(0.0)[axis];
    curve.turns().into_iter().chain([1.0]).any(|s| moved(start, curve.at(s)[axis]) != 0)
}

/// Where on a curve an axis that does not turn on it has gone by so much; 1 where it never has.
fn gone_by(curve: &Curve, axis: usize, mm: f64) -> f64 {
    let start = curve.at(0.0)[axis];
    let gone = |s: f64| (curve.at(s)[axis] - start).abs();
    if gone(1.0) <= mm {
        return 1.0;
    }
    let (mut low, mut high) = (0.0, 1.0);
    // To a millionth of the block.
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if gone(middle) < mm { low = middle } else { high = middle }
    }
    high
}
