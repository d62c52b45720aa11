//! How far the tool points away from its direction: looked at at places, bounded between them. Equation (P11).

use machine_model::{Aside, Command, Move, PathModel, Vector};
use smallvec::SmallVec;

use crate::corrected::Directed;
use crate::corrector::Corrector;
use crate::curve::Curve;
use crate::deviation::{Machine, Pair};
use crate::error::CorrectionError;

/// How often a stretch may be halved before its direction counts as not provable.
const DEEPEST: u32 = 16;
/// A proof leaves this much room for last bits, and for words beside the solved commands it was asked at, rad.
pub(crate) const GUARD_RAD: f64 = 1e-8;
/// More than a corrected command lies beside the programmed one, mm, and as a part of the way: of a stretch that is looked
/// at on the programmed path.
const ROOM_MM: f64 = 0.5;
const ROOM: f64 = 1.02;
/// Near a singularity a motion is split into pieces that turn by no more, rad.
pub const HELD_RAD: f64 = 0.02;
/// What is known of the direction along a way.
pub(crate) enum Leans {
    /// It is off by no more, rad.
    Within(f64),
    /// It is off by more than allowed, at this s, rad.
    Beyond { s: f64, rad: f64 },
}

/// Further off than allowed, or by no number.
fn is_beyond(rad: f64, allowed_rad: f64) -> bool {
    rad.is_nan() || rad > allowed_rad
}

/// Halves a way until the direction is proven everywhere: between two places it leaves the chord of its difference by no
/// more than the model's bound.
fn proven(at: impl Fn(f64) -> Option<f64>, bound: impl Fn(f64, f64) -> f64, allowed_rad: f64) -> Leans {
    let place = |s: f64| at(s).unwrap_or(f64::INFINITY);
    let (first, last) = (place(0.0), place(1.0));
    for (s, rad) in [(0.0, first), (1.0, last)] {
        if is_beyond(rad, allowed_rad) {
            return Leans::Beyond { s, rad };
        }
    }
    let mut worst = 0.0_f64;
    let mut stack: SmallVec<[([f64; 4], u32); 18]> = SmallVec::new();
    stack.push(([0.0, first, 1.0, last], 0));
    while let Some(([s0, from, s1, to], depth)) = stack.pop() {
        let whole = from.max(to) + bound(s0, s1);
        if whole <= allowed_rad {
            worst = worst.max(whole);
            continue;
        }
        let s = 0.5 * (s0 + s1);
        let middle = place(s);
        let is_off = is_beyond(middle, allowed_rad);
        if is_off || depth >= DEEPEST {
            return Leans::Beyond { s, rad: if is_off { middle } else { whole } };
        }
        stack.push(([s, middle, s1, to], depth + 1));
        stack.push(([s0, from, s, middle], depth + 1));
    }
    Leans::Within(worst)
}

/// The angle between the tool's real direction for a command and that of an ideal machine with the programmed angles, rad.
fn off_rad(model: &dyn PathModel, command: &Command, programmed_rad: &Vector) -> Option<f64> {
    model.tool_directions(command, programmed_rad).map(|[ideal, real]| (real - ideal).norm())
}

impl Corrector<'_> {
    /// What is proven of the direction on a way of linear axes while the rotary axes stand aside by so much.
    pub(crate) fn leans_standing(&self, whole: &Curve, state: &Command, allowed_rad: f64) -> Leans {
        let model = Aside::new(self.model, self.directions.aside_rad());
        let programmed_rad = state.rotary_rad;
        let at = |s: f64| {
            let nominal = Command { linear_mm: whole.at(s), ..*state };
            let linear_mm = match machine_model::Engine::solve(&model, &nominal) {
                Ok(solution) => solution.linear_mm,
                Err(_) => self.model.volume().nearest(&nominal.linear_mm),
            };
            off_rad(&model, &Command { linear_mm, ..nominal }, &programmed_rad)
        };
        let known = self.model.volume();
        let bound = |s0: f64, s1: f64| {
            let extent = whole.extent(s0, s1);
            let mut range_mm = extent.range;
            for (range, known) in range_mm.iter_mut().zip(&known.0) {
                range.low = (range.low - ROOM_MM).max(known.low).min(known.high);
                range.high = (range.high + ROOM_MM).min(known.high).max(known.low);
            }
            let largest = extent.speed.iter().fold(0.0_f64, |most, speed| most.max(*speed));
            model.direction_bound_rad(&Move {
                range_mm,
                speed_mm: extent.speed.map(|speed| ROOM * speed + (ROOM - 1.0) * largest),
                acceleration_mm: extent.acceleration.map(|mm| ROOM * mm + (ROOM - 1.0) * largest),
                passes: 4,
                state: *state,
                turn: None,
            })
        };
        match proven(at, bound, allowed_rad) {
            // No table turns an axis by more over half of an output step; a machine without errors is not off at all.
            Leans::Within(rad) if rad > 0.0 => Leans::Within(rad + GUARD_RAD),
            other => other,
        }
    }

    /// What is proven of the direction on a piece.
    ///
    /// # Errors
    /// [`CorrectionError::Leans`] where splitting does not help.
    pub(crate) fn piece_leans(
        &self,
        pair: &Pair<'_>,
        machine: &Machine<'_>,
        demand: Demand,
    ) -> Result<Pointing, CorrectionError> {
        let orientation_rad = self.options.orientation_rad;
        let at = |s: f64| {
            let (rotary_rad, programmed_rad) = (pair.commanded.rotary_rad(s)?, pair.wanted.rotary_rad(s)?);
            let linear_mm = pair.commanded.at(s);
            off_rad(self.model, &Command { linear_mm, rotary_rad, ..machine.state }, &programmed_rad)
        };
        let bound = |s0: f64, s1: f64| {
            let extent = pair.commanded.extent(s0, s1);
            self.model.direction_bound_rad(&Move {
                range_mm: extent.range,
                speed_mm: extent.speed,
                acceleration_mm: extent.acceleration,
                passes: 1,
                state: machine.state,
                turn: pair.turn(machine, s0, s1),
            })
        };
        let directed = |after_rad: f64, held: bool| Directed { before_rad: 0.0, after_rad, held };
        match proven(at, bound, orientation_rad - GUARD_RAD) {
            Leans::Within(rad) => Ok(Pointing::Holds(directed(rad, false))),
            // A short way at a time, so that no more of a motion leans than has to.
            Leans::Beyond { rad, .. }
                if demand == Demand::AsNearAsMayBe && pair.wanted.turned_rad() > HELD_RAD =>
            {
                Ok(Pointing::Leans { s: 0.5, rad })
            }
            Leans::Beyond { .. } if demand == Demand::AsNearAsMayBe => {
                let places = [0.0, 0.25, 0.5, 0.75, 1.0].map(|s| at(s).unwrap_or(f64::INFINITY));
                Ok(Pointing::Holds(directed(places.into_iter().fold(0.0, f64::max), true)))
            }
            Leans::Beyond { s, rad } if 0.0 < s && s < 1.0 => Ok(Pointing::Leans { s, rad }),
            Leans::Beyond { rad, .. } => {
                Err(CorrectionError::Leans { leans_urad: rad * 1e6, allowed_urad: orientation_rad * 1e6 })
            }
        }
    }
}

/// What is asked of the direction on a piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Demand {
    /// It is proven.
    Proven,
    /// Near a singularity the tool points as well as it may: what it is off by is looked at, not proven.
    AsNearAsMayBe,
}

/// What became of the direction on a piece.
pub(crate) enum Pointing {
    /// It may be written.
    Holds(Directed),
    /// It has to be split at this s: the direction is off by so much, rad.
    Leans { s: f64, rad: f64 },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_bends_is_halved_until_it_is_proven_or_found() {
        let at = |s: f64| Some(1e-5 * (0.5 - s).abs());
        let bound = |s0: f64, s1: f64| 8e-5 * (s1 - s0) * (s1 - s0);
        assert!(matches!(proven(at, bound, 2e-5), Leans::Within(rad) if rad <= 2e-5));
        let bends = |s0: f64, s1: f64| 0.25 * (s1 - s0) * (s1 - s0);
        assert!(matches!(proven(|s| Some(s * (1.0 - s)), bends, 0.2), Leans::Beyond { s, .. } if s == 0.5));
        assert!(matches!(proven(|_| Some(f64::NAN), bound, 0.2), Leans::Beyond { .. }));
    }
}
