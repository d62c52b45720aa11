//! How far the real tool leaves the programmed path: computed at places, bounded between them.

use machine_model::{Command, Everywhere, Move, PathModel, Vector};
use smallvec::SmallVec;

use crate::curve::Curve;

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
#[derive(Clone, Copy)]
pub(crate) struct Machine<'m> {
    /// Where the tool really goes.
    pub(crate) model: &'m dyn PathModel,
    /// Tool vector, rotary axes and directions; its linear position is not used.
    pub(crate) state: Command,
    /// What holds for that state in the whole volume, where the model says so.
    pub(crate) everywhere: Option<Everywhere>,
    /// A bound up to this need not be worked out exactly, mm: an earlier motion was told with it.
    pub(crate) told_mm: f64,
}

impl Machine<'_> {
    /// Real tip minus nominal tip for an axis command, mm.
    pub(crate) fn error(&self, linear_mm: Vector) -> Vector {
        self.model.error_mm(&Command { linear_mm, ..self.state })
    }
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
}

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

/// Commands that bring the tool to a programmed motion.
#[derive(Clone, Copy)]
pub(crate) struct Solved {
    /// At s = 0, ¼, ½, ¾, 1.
    pub(crate) commands: [Vector; 5],
    /// For motion in these directions.
    pub(crate) direction: [i8; 3],
}

impl Solved {
    /// At ¼, ½ and ¾.
    pub(crate) fn between(&self) -> [Vector; 3] {
        let [_, a, b, c, _] = self.commands;
        [a, b, c]
    }

    /// At the end.
    pub(crate) fn end(&self) -> Vector {
        let [.., end] = self.commands;
        end
    }
}

/// More than a corrected command is off, and all rounding in comparing with it, mm.
const SOLVED_MM: f64 = 1e-8;

/// What corrected commands tell of a motion.
pub(crate) enum ByCommands {
    /// The real path stays this near the programmed one, everywhere; mm.
    Within(f64),
    /// It is further away than allowed at this s, by at least this many mm.
    Beyond {
        /// Where.
        s: f64,
        /// How far.
        distance_mm: f64,
    },
    /// The model has to be asked.
    Open,
}

/// A place where the deviation is known.
#[derive(Clone, Copy)]
struct Place {
    s: f64,
    /// Real tip minus programmed tip at the same s, mm.
    difference: Vector,
    /// The part of it square to the programmed path, mm.
    square: f64,
    /// Upper bound of the distance from the programmed path, mm.
    distance: f64,
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
    fn place(&self, machine: &Machine<'_>, s: f64) -> Place {
        let (wanted, tangent) = self.wanted.at_and_tangent(s);
        let commanded = self.commanded.at(s);
        self.place_of(s, commanded - wanted + machine.error(commanded), tangent)
    }

    /// The place at s where real and programmed tip differ so, seen along a tangent.
    fn place_of(&self, s: f64, difference: Vector, tangent: Vector) -> Place {
        let tangent = if self.in_step { Vector::zeros() } else { tangent };
        let along = difference.dot(&tangent);
        let square = (difference - tangent * along).norm();
        // An end has to be reached, not only its neighbourhood: there all of the difference counts.
        let distance = if s <= 0.0 || s >= 1.0 {
            difference.norm()
        } else {
            square + 0.5 * along * along * self.wanted.curvature()
        };
        Place { s, difference, square, distance }
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
        {
            let cheap = self.between(a, b, everywhere.chord_bound_of_curve_mm(speed_mm, acceleration_mm));
            if cheap <= machine.told_mm {
                return cheap;
            }
        }
        let extent = self.commanded.extent(a.s, b.s);
        let leaves_chord = machine.model.chord_bound_mm(&Move {
            range_mm: extent.range,
            speed_mm: extent.speed,
            acceleration_mm: extent.acceleration,
            passes: if matches!(self.commanded, Curve::Arc { .. }) { 2 } else { 1 },
            state: machine.state,
        });
        self.between(a, b, leaves_chord)
    }

    /// Equation (P4), the error leaving its chord by at most `error_mm`.
    fn between(&self, a: &Place, b: &Place, error_mm: f64) -> f64 {
        self.between_leaving(a, b, error_mm + self.commanded.difference_bound(self.wanted, a.s, b.s))
    }

    /// Equation (P4), the deviation leaving its chord by at most `leaves_chord` mm.
    fn between_leaving(&self, a: &Place, b: &Place, leaves_chord: f64) -> f64 {
        if !leaves_chord.is_finite() {
            // The model jumps here. Infinity times a curvature of zero is not a number, and `max` would forget it.
            return f64::INFINITY;
        }
        // The chord itself, seen square to a tangent that turns by θ: P(s)·chord(s) has a second
        // derivative of at most 4θ²·|chord| + 2θ·|b - a|.
        let turning = self.wanted.turning_rad() * (b.s - a.s);
        let largest = a.difference.norm().max(b.difference.norm());
        let turned = turning * (4.0 * turning * largest + 2.0 * (b.difference - a.difference).norm()) / 8.0;
        let along = largest + leaves_chord;
        let between =
            a.square.max(b.square) + leaves_chord + turned + 0.5 * along * along * self.wanted.curvature();
        between.max(a.distance).max(b.distance)
    }

    /// What the commands that bring the tool to the programmed path tell of the one commanded, without the model being asked:
    /// equation (P7).
    pub(crate) fn by_commands(&self, machine: &Machine<'_>, solved: &Solved, limit_mm: f64) -> ByCommands {
        /// Of a motion, from place to place.
        const STRETCH: f64 = 0.25;
        let Some(everywhere) = &machine.everywhere else { return ByCommands::Open };
        let mut places = [Place { s: 0.0, difference: Vector::zeros(), square: 0.0, distance: 0.0 }; 5];
        let mut unsure: f64 = 0.0;
        let (commanded, wanted) = (self.commanded.quarters(), self.wanted.quarters());
        for (k, place) in places.iter_mut().enumerate() {
            let s = STRETCH * k as f64;
            let off = commanded[k].0 - solved.commands[k];
            *place = self.place_of(s, off, wanted[k].1);
            let own = everywhere.gradient * off.norm() + SOLVED_MM;
            if own.is_nan() {
                // An axis whose place is not known: `max` would forget it.
                return ByCommands::Open;
            }
            if place.square - own > limit_mm && 0 < k && k < 4 {
                return ByCommands::Beyond { s, distance_mm: place.square - own };
            }
            unsure = unsure.max(own);
        }
        // An arc passes a place at most twice only while it is below half a turn.
        if self.commanded.turning_rad() * STRETCH > 3.0 || !self.commanded.lies_inside(&everywhere.volume) {
            return ByCommands::Open;
        }
        let bends = self.commanded.difference_bound(self.wanted, 0.0, STRETCH);
        let bound = |error_mm: f64| {
            let stretches = places.windows(2);
            let worst = stretches.map(|ends| self.between_leaving(&ends[0], &ends[1], error_mm + bends));
            worst.fold(0.0, f64::max) + 4.0 * unsure
        };
        // All but the model's share.
        if bound(0.0) > limit_mm {
            return ByCommands::Open;
        }
        // Of a stretch that runs through all of the motion's box: it holds for those that run through a part of it.
        let extent = self.commanded.extent(0.0, 1.0);
        let bound = bound(machine.model.chord_bound_mm(&Move {
            range_mm: extent.range,
            speed_mm: extent.speed.map(|speed| speed * STRETCH),
            acceleration_mm: extent.acceleration.map(|acceleration| acceleration * STRETCH * STRETCH),
            passes: 2,
            state: machine.state,
        }));
        if bound <= limit_mm { ByCommands::Within(bound) } else { ByCommands::Open }
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
            if turning * (b.s - a.s) > 3.0 { f64::INFINITY } else { self.bound(machine, a, b, limit_mm) }
        };
        let whole = bound(&first, &last);
        if whole <= limit_mm {
            return Verdict::Within(whole);
        }
        // What does not hold mostly shows at a few places: cheaper than proving all that comes before them.
        let mut looked_at: SmallVec<[Place; 5]> = SmallVec::new();
        for s in [0.5, 0.25, 0.75, 0.125, 0.875] {
            let place = self.place(machine, s);
            if let Some(refuted) = beyond(&place) {
                return refuted;
            }
            looked_at.push(place);
        }
        let mut worst_proven: f64 = 0.0;
        let mut of_the_whole = Some(whole);
        // Depth first, left to right, on a stack of right halves: no recursion, no allocation.
        let mut stack = [first; DEEPEST + 3];
        stack[0] = last;
        let mut height = 1;
        let mut left = first;
        let mut places = 0;
        while height > 0 {
            let right = stack[height - 1];
            let bound = of_the_whole.take().unwrap_or_else(|| bound(&left, &right));
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
