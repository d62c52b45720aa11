//! How far the error of [`Kmtpp`] can leave its chord: equation (19) of `docs/equations.md`.
//!
//! With `Q` the command relative to the origin and `H(Q) = ∫₀¹ F(E(tQ)) dt` the error is
//! `e = r01 + (H L - 1) Q + positioning`. Along a stretch `Q(s)`
//!
//! ```text
//! e'' = H'' L Q + 2 H' L Q' + (H L - 1) Q''
//! ```
//!
//! `F` turns with |ω| ≤ |Ė| and |ω̇| ≤ |Ë| + ½|E||Ė|² (Rodrigues vector), and `Ė = Σ ε_i'(tQ_i)·t·Q_i'`.
//! With `D_i ≥ |ε_i'|`, `E ≥ |E|`, `w = Σ D_i |Q_i'|`:
//!
//! * `|H'| ≤ w/2`
//! * `|H''| ≤ ½ Σ D_i |Q_i''| + w²/3·(1 + E/2) + Σ_i K_i |Q_i'|²`
//! * `|H L - 1| ≤ |L - 1| + E·|L|`
//!
//! `K_i` comes from the kinks of the tables: a kink `Δ` at node `n` (relative to the origin) lies at
//! `t = n/Q_i` of the line of integration, and moves along it as `Q_i` changes: it adds `DF[Δ]·n²/Q_i³`.
//! `DF` is the identity up to 1.5·E (for E ≤ ½), so the kinks are summed *with* their signs first and the rest
//! bounded by their magnitudes. So `e` has no kink of its own inside the volume; only positioning has.

use super::Kmtpp;
use super::separable::curve_chord_bound;
use crate::{Move, Range, Table, Vector};

/// Sums over the kinks between the origin and a place on one axis.
#[derive(Clone, Debug)]
pub(super) struct KinkMoments {
    /// Away from the origin upwards, then downwards: (distance, Σ Δ n², Σ |Δ| n²), by distance.
    sides: [Vec<(f64, Vector, f64)>; 2],
}

impl KinkMoments {
    pub(super) fn new(tables: &[Table; 3], origin: f64) -> Self {
        let mut kinks: Vec<(f64, Vector)> = Vec::new();
        for (c, table) in tables.iter().enumerate() {
            for cell in table.nodes().windows(3) {
                let before = (table.value(cell[1]) - table.value(cell[0])) / (cell[1] - cell[0]);
                let after = (table.value(cell[2]) - table.value(cell[1])) / (cell[2] - cell[1]);
                let mut jump = Vector::zeros();
                jump[c] = after - before;
                kinks.push((cell[1] - origin, jump));
            }
        }
        let side = |sign: f64| {
            let mut ahead: Vec<(f64, Vector)> =
                kinks.iter().map(|(n, jump)| (sign * n, *jump)).filter(|(n, _)| *n > 0.0).collect();
            ahead.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut running: Vec<(f64, Vector, f64)> = Vec::new();
            // Kinks of the three components at one node are one vector.
            let mut at = 0;
            while at < ahead.len() {
                let n = ahead[at].0;
                let same = ahead[at..].iter().take_while(|kink| kink.0 == n);
                let (count, jump) = same.fold((0, Vector::zeros()), |(k, sum), kink| (k + 1, sum + kink.1));
                at += count;
                let (_, sum, magnitude) = running.last().copied().unwrap_or((0.0, Vector::zeros(), 0.0));
                running.push((n, sum + jump * (n * n), magnitude + jump.norm() * n * n));
            }
            running
        };
        Self { sides: [side(1.0), side(-1.0)] }
    }

    /// Upper bound of `(|Σ Δ n²| + looseness·Σ |Δ| n²)/|Q|³` for Q (relative to the origin) in `range`.
    fn bound(&self, range: Range, looseness: f64) -> f64 {
        let mut most: f64 = 0.0;
        for (side, (low, high)) in self.sides.iter().zip([(range.low, range.high), (-range.high, -range.low)])
        {
            // Between two kinks the sums are constant and the fraction is largest at the nearer end.
            let first = side.partition_point(|kink| kink.0 <= low).saturating_sub(1);
            for (n, sum, magnitude) in &side[first..] {
                if *n >= high {
                    break;
                }
                let nearest = n.max(low);
                most = most.max((sum.norm() + looseness * magnitude) / (nearest * nearest * nearest));
            }
        }
        most
    }
}

impl Kmtpp {
    /// See [`crate::PathModel::chord_bound_mm`].
    pub(super) fn bound_mm(&self, stretch: &Move) -> f64 {
        let speed = Vector::from(stretch.speed_mm);
        let acceleration = Vector::from(stretch.acceleration_mm);
        let mut slopes = Vector::zeros();
        let mut rotation = Vector::zeros();
        let mut farthest = Vector::zeros();
        let mut positioning = Vector::zeros();
        let mut scale = Vector::zeros();
        let mut overhang = [false; 3];
        let mut inside = stretch.range_mm;
        for i in 0..3 {
            let (given, volume, origin) = (stretch.range_mm[i], self.volume.0[i], self.origin_mm[i]);
            overhang[i] = given.low < volume.low || given.high > volume.high;
            let (low, high) =
                (given.low.clamp(volume.low, volume.high), given.high.clamp(volume.low, volume.high));
            inside[i] = Range { low: low - origin, high: high - origin };
            farthest[i] = inside[i].low.abs().max(inside[i].high.abs());
            let swept = Range { low: low.min(origin), high: high.max(origin) };
            let bounds = [0, 1, 2].map(|c| self.angles[i][c].bounds(swept));
            slopes[i] = Vector::from(bounds.map(|b| b.slope)).norm();
            rotation += Vector::from(bounds.map(|b| b.value));
            let own = self.positioning[i].bounds(given);
            positioning[i] = curve_chord_bound(&own, stretch, i);
            scale[i] = own.slope;
        }
        let most_rotation = rotation.norm();
        if most_rotation > 0.5 {
            return f64::INFINITY; // beyond the validity of the bound: no machine is that bent
        }
        let size = self.directions.norm();
        let skew = (self.directions - nalgebra::Matrix3::identity()).norm() + most_rotation * size;
        let reach = size * farthest.norm();
        let turning = slopes.dot(&speed);
        let mut second =
            0.5 * slopes.dot(&acceleration) + turning * turning / 3.0 * (1.0 + 0.5 * most_rotation);
        for i in 0..3 {
            second += self.kinks[i].bound(inside[i], 1.5 * most_rotation) * speed[i] * speed[i];
        }
        let curved = second * reach + turning * size * speed.norm() + skew * acceleration.norm();
        // Where an axis leaves the volume the error stops to change with it: a kink of at most |∂e/∂q_i|.
        let leaving: f64 = (0..3)
            .filter(|&i| overhang[i])
            .map(|i| (0.5 * slopes[i] * reach + skew + scale[i]) * speed[i] * f64::from(stretch.passes) / 4.0)
            .sum();
        curved / 8.0 + positioning.norm() + leaving
    }
}
