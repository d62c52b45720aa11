//! How far the real tool leaves the programmed path: computed at places, bounded between them.

use std::array::from_fn;
use std::sync::Arc;

use machine_model::{Command, Everywhere, LANES, Move, PathModel, Turn, Vector};
use smallvec::SmallVec;

use crate::curve::{Curve, between};
use crate::extent::Extent;

/// How often a stretch may be halved before it counts as not provable: 2^-20 of any motion is below
/// every machine's resolution.
const DEEPEST: usize = 20;

/// After this many places a motion counts as not provable and is split: a full circle takes about a
/// hundred, and what runs along its limit for a long way would take millions.
const MOST_PLACES: usize = 1000;
/// Each turn of an arc of many may take this many more, up to so many in all.
const PLACES_PER_TURN: f64 = 16.0;
const MOST_PLACES_OF_TURNS: f64 = 1e5;

/// The model in the state of one motion.
#[derive(Clone)]
pub(crate) struct Machine<'m> {
    /// Where the tool really goes.
    pub(crate) model: &'m dyn PathModel,
    /// Tool vector, rotary axes and directions; its linear position is not used.
    pub(crate) state: Command,
    /// What holds for that state in the whole volume, where the model says so.
    pub(crate) everywhere: Option<Arc<Everywhere>>,
    /// Rotary axes turn on the motion's way; those of the state stand where the next piece begins.
    pub(crate) turns: bool,
    /// By how much further than commanded they stand at the ends of such a piece, where they have play.
    pub(crate) lag_rad: Option<[Vector; 2]>,
}

impl Machine<'_> {
    /// Real tip minus nominal tip for an axis command, mm.
    pub(crate) fn error(&self, linear_mm: Vector) -> Vector {
        self.model.error_mm(&Command { linear_mm, ..self.state })
    }

    /// Upper bound of how far the error leaves its chord on a stretch, mm.
    pub(crate) fn leaves_chord_mm(&self, extent: &Extent, passes: u8) -> f64 {
        self.leaves_chord_turning_mm(extent, passes, None)
    }

    /// The same while rotary axes turn.
    fn leaves_chord_turning_mm(&self, extent: &Extent, passes: u8, turn: Option<Turn>) -> f64 {
        self.model.chord_bound_mm(&Move {
            range_mm: extent.range,
            speed_mm: extent.speed,
            acceleration_mm: extent.acceleration,
            passes,
            state: self.state,
            turn,
        })
    }

    /// The command of an ideal machine for a place of a programmed motion with the rotary axes as they stand, mm: that
    /// of the motion but for what their words were rounded by.
    pub(crate) fn target(&self, part: &Curve, s: f64) -> Vector {
        let at = part.at(s);
        match part.rotary_rad(s) {
            Some(programmed_rad) if programmed_rad != self.state.rotary_rad => {
                self.model.same_tip_mm(&at, &self.state, &programmed_rad)
            }
            _ => at,
        }
    }

    /// Commands that bring the tool to several places at once; `None` where the model has to be asked for each.
    pub(crate) fn solved_together(&self, places: [Vector; LANES]) -> Option<[Vector; LANES]> {
        let targets = places.map(Into::into);
        let directions = [self.state.direction; LANES];
        let [x, y, z] =
            self.model.commands_for(&targets, &directions, &self.state, self.everywhere.as_deref()?)?;
        Some(from_fn(|k| Vector::new(x[k], y[k], z[k])))
    }
}

/// Whether the programmed path's start has been come to before.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Begun {
    /// This motion has to come to it.
    No,
    /// The tool was there; where it now stands further on along the path, it is early and not off.
    Reached,
    /// It lies inside a smooth motion: there the tool may be late too.
    Inside,
}

/// A motion as programmed and a motion that shall stand for it.
#[derive(Clone, Copy)]
pub(crate) struct Pair<'c> {
    /// The programmed path.
    pub(crate) wanted: &'c Curve,
    /// The path commanded instead.
    pub(crate) commanded: &'c Curve,
    /// Rotary axes turn on the way: the tip's path is not this curve but turns with the workpiece, so being
    /// early or late counts in full.
    pub(crate) in_step: bool,
    pub(crate) begun: Begun,
}

/// A stretch that turns by less than half a turn passes a place of an axis twice at most: so much is asked about at once, rad.
const MOST_TURN_RAD: f64 = 3.0;

/// Of the radius of the programmed path, what the tool may be away from it for (P2) to look along the tangent: what that leaves out is of
/// third order, `d·t²/2r²`, a hundredth of the difference at most.
const MOST_OF_RADIUS: f64 = 0.1;

/// Result of comparing two motions on the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Verdict {
    /// The real path stays this near the programmed one, everywhere; mm.
    Within(f64),
    /// It is further away than allowed at this s, by this many mm in all.
    Beyond {
        /// Where.
        s: f64,
        /// How far.
        distance_mm: f64,
    },
}

impl Verdict {
    /// The same of a path that is so many mm further away.
    pub(crate) fn further_by(self, mm: f64, limit_mm: f64) -> Self {
        match self {
            Self::Within(bound_mm) if bound_mm + mm <= limit_mm => Self::Within(bound_mm + mm),
            Self::Within(bound_mm) => Self::Beyond { s: 0.5, distance_mm: bound_mm + mm },
            beyond @ Self::Beyond { .. } => beyond,
        }
    }
}

/// A place where the deviation is known.
#[derive(Clone, Copy, Default)]
pub(crate) struct Place {
    s: f64,
    /// Real tip minus programmed tip at the same s, mm.
    difference: Vector,
    /// Its length, mm.
    pub(crate) size: f64,
    /// The part of it square to the programmed path, mm.
    pub(crate) square: f64,
    /// Upper bound of the distance from the programmed path, mm.
    pub(crate) distance: f64,
}

impl Place {
    /// Further away than allowed, or nowhere: an axis whose place is not known gives no number.
    fn is_beyond(&self, limit_mm: f64) -> bool {
        self.distance.is_nan() || self.distance > limit_mm
    }
}

impl Pair<'_> {
    /// The deviation at s.
    ///
    /// Moving along the path is no deviation from it: only the part of the difference square to the
    /// tangent counts, plus what the path curves away over the part along it, t²/2ρ.
    pub(crate) fn place(&self, machine: &Machine<'_>, s: f64) -> Place {
        let (wanted, tangent) = self.wanted.at_and_tangent(s);
        let commanded = self.commanded.at(s);
        let error = match (self.commanded.rotary_rad(s), self.wanted.rotary_rad(s)) {
            (Some(rotary_rad), Some(programmed_rad)) => {
                let mut command = Command { linear_mm: commanded, rotary_rad, ..machine.state };
                if let Some(ends) = &machine.lag_rad {
                    command.rotary_play.lag_rad = between(ends, s);
                }
                machine.model.error_from_mm(&command, &programmed_rad)
            }
            _ => machine.error(commanded),
        };
        self.place_of(s, commanded - wanted + error, tangent)
    }

    /// How rotary axes turn on the part from s0 to s1.
    pub(crate) fn turn(&self, machine: &Machine<'_>, s0: f64, s1: f64) -> Option<Turn> {
        let ends = |curve: &Curve| Some([curve.rotary_rad(s0)?, curve.rotary_rad(s1)?]);
        Some(Turn {
            programmed_rad: ends(self.wanted)?,
            commanded_rad: ends(self.commanded)?,
            lag_rad: machine.lag_rad.map_or([machine.state.rotary_play.lag_rad; 2], |lag_rad| {
                [between(&lag_rad, s0), between(&lag_rad, s1)]
            }),
        })
    }

    /// Being early or late by so many mm is no deviation: (P2) looks along a tangent, which says nothing of the path where that turns
    /// with the workpiece, is a steep spiral, or bends away over the difference itself.
    fn may_be_late(&self, by_mm: f64) -> bool {
        !self.in_step && !self.wanted.is_steep_spiral() && by_mm * self.wanted.curvature() <= MOST_OF_RADIUS
    }

    /// The place at s where real and programmed tip differ so, seen along a tangent.
    pub(crate) fn place_of(&self, s: f64, difference: Vector, tangent: Vector) -> Place {
        let size = difference.norm();
        let tangent = if self.may_be_late(size) { tangent } else { Vector::zeros() };
        let along = difference.dot(&tangent);
        let square = (difference - tangent * along).norm();
        // An end has to be reached, not only its neighbourhood: there all of the difference counts.
        let to_be_reached = match self.begun {
            Begun::No => s <= 0.0,
            Begun::Reached => s <= 0.0 && along < 0.0,
            Begun::Inside => false,
        };
        let distance = if to_be_reached || s >= 1.0 {
            size
        } else {
            square + 0.5 * along * along * self.wanted.curvature()
        };
        Place { s, difference, size, square, distance }
    }

    /// Upper bound of the distance between two places where it is known, mm; where that exceeds `limit_mm`, any number
    /// that does.
    fn bound(&self, machine: &Machine<'_>, a: &Place, b: &Place, limit_mm: f64) -> f64 {
        // All of (P4) but the model's share: the model is not asked where that is too much already.
        let least = self.between(a, b, 0.0);
        if least > limit_mm {
            return least;
        }
        if let Some(everywhere) = &machine.everywhere
            && let Some((speed_mm, acceleration_mm)) = self.commanded.fastest(a.s, b.s)
            && self.commanded.lies_inside(&everywhere.volume)
            && !self.commanded.is_steep_spiral()
        {
            let cheap = self.between(a, b, everywhere.chord_bound_of_curve_mm(speed_mm, acceleration_mm));
            if cheap <= limit_mm {
                return cheap;
            }
        }
        let extent = self.commanded.extent(a.s, b.s);
        let turn = self.turn(machine, a.s, b.s);
        self.between(a, b, machine.leaves_chord_turning_mm(&extent, self.passes(), turn))
    }

    /// How often the commanded motion passes a place of an axis while it turns by less than half a turn.
    fn passes(&self) -> u8 {
        match self.commanded {
            Curve::Line(..) | Curve::Turn { .. } => 1,
            // A spiral that grows fast may turn twice within less.
            Curve::Arc { .. } if self.commanded.is_steep_spiral() => 3,
            Curve::Arc { .. } => 2,
        }
    }

    /// Real tip less programmed tip at both ends, mm.
    pub(crate) fn differences(&self, machine: &Machine<'_>) -> [Vector; 2] {
        [0.0, 1.0].map(|s| self.place(machine, s).difference)
    }

    /// Upper bound of how far that leaves its chord from the start to s, mm.
    pub(crate) fn leaves_chord_mm(&self, machine: &Machine<'_>, s: f64) -> f64 {
        if self.commanded.turning_rad() * s > MOST_TURN_RAD {
            return f64::INFINITY;
        }
        let extent = self.commanded.extent(0.0, s);
        let of_model = machine.leaves_chord_turning_mm(&extent, self.passes(), self.turn(machine, 0.0, s));
        of_model + self.commanded.difference_bound(self.wanted, 0.0, s)
    }

    /// Equation (P4), the error leaving its chord by at most `error_mm`.
    fn between(&self, a: &Place, b: &Place, error_mm: f64) -> f64 {
        self.between_leaving(a, b, error_mm + self.commanded.difference_bound(self.wanted, a.s, b.s))
    }

    /// Equation (P4), the deviation leaving its chord by at most `leaves_chord` mm.
    pub(crate) fn between_leaving(&self, a: &Place, b: &Place, leaves_chord: f64) -> f64 {
        if !leaves_chord.is_finite() {
            // The model jumps here. Infinity times a curvature of zero is not a number, and `max` would forget it.
            return f64::INFINITY;
        }
        // The chord itself, seen square to a tangent that turns by θ: P(s)·chord(s) has a second
        // derivative of at most 4θ²·|chord| + 2θ·|b - a|.
        let turning = self.wanted.turning_rad() * (b.s - a.s);
        let largest = a.size.max(b.size);
        let turned = turning * (4.0 * turning * largest + 2.0 * (b.difference - a.difference).norm()) / 8.0;
        let along = largest + leaves_chord;
        if !self.may_be_late(along) {
            return along;
        }
        let between =
            a.square.max(b.square) + leaves_chord + turned + 0.5 * along * along * self.wanted.curvature();
        between.max(a.distance).max(b.distance)
    }

    /// Proves that the real path stays within `limit_mm` of the programmed one, or shows where it does not.
    pub(crate) fn verdict(&self, machine: &Machine<'_>, limit_mm: f64) -> Verdict {
        let (first, last) = (self.place(machine, 0.0), self.place(machine, 1.0));
        let beyond = |place: &Place| {
            place.is_beyond(limit_mm).then_some(Verdict::Beyond { s: place.s, distance_mm: place.distance })
        };
        if let Some(refuted) = beyond(&first).or_else(|| beyond(&last)) {
            return refuted;
        }
        // An arc passes a place at most twice only while it is below half a turn.
        let turning = self.commanded.turning_rad();
        let more = (PLACES_PER_TURN * turning / std::f64::consts::TAU).min(MOST_PLACES_OF_TURNS);
        let most_places = MOST_PLACES + more as usize;
        let bound = |a: &Place, b: &Place| {
            if turning * (b.s - a.s) > MOST_TURN_RAD {
                f64::INFINITY
            } else {
                self.bound(machine, a, b, limit_mm)
            }
        };
        let whole = bound(&first, &last);
        if whole <= limit_mm {
            return Verdict::Within(whole);
        }
        let middle = self.place(machine, 0.5);
        if let Some(refuted) = beyond(&middle) {
            return refuted;
        }
        // Bounds that are asked for first below, the last of them first.
        let mut known_bounds: SmallVec<[f64; 2]> = SmallVec::new();
        // A line that is too long for one bound mostly is not for two.
        if turning == 0.0 {
            let first_half = bound(&first, &middle);
            if first_half <= limit_mm {
                let halves = first_half.max(bound(&middle, &last));
                if halves <= limit_mm {
                    return Verdict::Within(halves);
                }
            }
            known_bounds.push(first_half);
        }
        known_bounds.push(whole);
        // What does not hold mostly shows at a few places: cheaper than proving all that comes before them.
        let mut looked_at: SmallVec<[Place; 5]> = SmallVec::from_slice(&[middle]);
        for s in [0.25, 0.75, 0.125, 0.875] {
            let place = self.place(machine, s);
            if let Some(refuted) = beyond(&place) {
                return refuted;
            }
            looked_at.push(place);
        }
        let mut worst_proven: f64 = 0.0;
        // Depth first, left to right, on a stack of right halves: no recursion, no allocation.
        let mut stack = [first; DEEPEST + 3];
        stack[0] = last;
        let (mut left, mut height, mut places) = (first, 1, 0);
        while height > 0 {
            let right = stack[height - 1];
            let bound = known_bounds.pop().unwrap_or_else(|| bound(&left, &right));
            if bound <= limit_mm {
                worst_proven = worst_proven.max(bound);
                left = right;
                height -= 1;
                continue;
            }
            let s = 0.5 * (left.s + right.s);
            let known = looked_at.iter().find(|place| place.s == s);
            let middle = known.copied().unwrap_or_else(|| self.place(machine, s));
            if let Some(refuted) = beyond(&middle) {
                return refuted;
            }
            places += 1;
            if height > DEEPEST || places > most_places {
                return Verdict::Beyond { s: middle.s, distance_mm: bound };
            }
            stack[height] = middle;
            height += 1;
        }
        Verdict::Within(worst_proven)
    }

    /// The place inside, of a few looked at, where the real path is furthest away.
    pub(crate) fn worst_place(&self, machine: &Machine<'_>) -> f64 {
        const LOOKS: u32 = 24;
        let mut worst = (0.5, -1.0);
        for k in 1..LOOKS {
            let s = f64::from(k) / f64::from(LOOKS);
            let distance = self.place(machine, s).distance;
            if distance > worst.1 {
                worst = (s, distance);
            }
        }
        worst.0
    }
}
