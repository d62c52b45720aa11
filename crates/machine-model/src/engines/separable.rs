//! Models in which every axis moves the tip on its own: `p(q) = offset + Σ_i P_i(q_i)`.

use crate::{Bounds, Move, Range, Solution, SolveError, Table, Vector, Volume};

/// Error of a machine whose axes do not influence one another, mm.
///
/// `e(q) = offset + Σ_i e_i(q_i)`; `curves[i][c]` is component `c` of the error that axis `i` makes. The
/// order of motion does not matter, and the bounds of the curves bound the whole.
#[derive(Clone, Debug)]
pub(crate) struct Separable {
    pub(crate) offset_mm: Vector,
    pub(crate) curves: [[Table; 3]; 3],
}

impl Separable {
    /// The box that the curves cover.
    pub(crate) fn volume(&self) -> Volume {
        Volume([0, 1, 2].map(|i| {
            let ranges = [0, 1, 2].map(|c| self.curves[i][c].range());
            Range {
                low: ranges.iter().fold(f64::NEG_INFINITY, |low, r| low.max(r.low)),
                high: ranges.iter().fold(f64::INFINITY, |high, r| high.min(r.high)),
            }
        }))
    }

    /// Real tip minus nominal tip, mm; outside the volume that of its nearest point.
    pub(crate) fn error_mm(&self, q: &Vector) -> Vector {
        let mut error = self.offset_mm;
        for (i, curves) in self.curves.iter().enumerate() {
            error += Vector::from_fn(|c, _| curves[c].value(q[i]));
        }
        error
    }

    /// Solves `q + e(q) = target`.
    pub(crate) fn solve(&self, target: &Vector) -> Result<Solution, SolveError> {
        crate::solve(target, &self.volume(), |q| self.error_mm(q))
    }

    /// See [`crate::PathModel::chord_bound_mm`].
    pub(crate) fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        let mut sum = Vector::zeros();
        for (i, curves) in self.curves.iter().enumerate() {
            for (c, curve) in curves.iter().enumerate() {
                sum[c] += curve_chord_bound(&curve.bounds(stretch.range_mm[i]), stretch, i);
            }
        }
        sum.norm()
    }
}

/// How far `f(q_i(s))` can leave its chord on a stretch, given the bounds of `f` over the stretch's range.
///
/// With `g(s) = f(q(s))`: `|g''| ≤ |f''| |q'|² + |f'| |q''|` between the kinks, worth an eighth; every
/// kink bends g by its jump times |q'|, worth at most `s(1-s) ≤ ¼` of that, as often as it is passed.
/// On long stretches over many kinks it says more that curve and chord both lie within the values of `f`.
pub(crate) fn curve_chord_bound(bounds: &Bounds, stretch: &Move, axis: usize) -> f64 {
    let (speed, acceleration) = (stretch.speed_mm[axis], stretch.acceleration_mm[axis]);
    let bent = (bounds.curvature * speed * speed + bounds.slope * acceleration) / 8.0
        + bounds.kinks * speed * f64::from(stretch.passes) / 4.0;
    bent.min(2.0 * bounds.value)
}
