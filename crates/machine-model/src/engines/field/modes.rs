//! Functions of one axis, ordered by how rough they are, and of swells: equation (92) of `docs/equations.md`.

use nalgebra::DMatrix;

use super::spline::Basis;
use crate::Range;

/// Places and weights of Gauss' rule for polynomials of degree 7, on (-1, 1).
const GAUSS: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
];

/// How far swells reach, in halves of an axis: the length over which they forget.
const REACHES: [f64; SWELLS] = [0.7, 1.4];
/// How many kinds of swells.
pub(super) const SWELLS: usize = 2;
/// Functions whose variance is less than this part of the largest say nothing beside any noise.
const LEAST_VARIANCE: f64 = 1e-8;

/// The constant, the straight line, and the functions of a space of cubic splines that are the roughest last (Demmler and
/// Reinsch 1975), all with a mean square of 1 and orthogonal over the axis.
#[derive(Clone, Debug)]
pub(super) struct Modes {
    range: Range,
    /// Splines of the axis from -1 to 1.
    basis: Basis,
    /// Column k: coefficients of mode k; behind those of the modes the functions of swells.
    coefficients: DMatrix<f64>,
    /// Prior variance of each against that of the smoothest that is not straight: the reciprocal of `∫ f''²`. Of a swell's
    /// function: its part of the variance 1.
    variances: Vec<f64>,
    /// Where the functions of each kind of swells begin, and where the last end.
    swells: [usize; SWELLS + 1],
}

impl Modes {
    pub(super) fn new(range: Range, intervals: usize) -> Self {
        let basis = Basis::even(Range { low: -1.0, high: 1.0 }, intervals);
        let n = basis.count();
        let (mut gram, mut bending) = (DMatrix::zeros(n, n), DMatrix::zeros(n, n));
        // Places of Gauss' rule, and splines there times the weights of a mean.
        let (mut places, mut weighted) = (Vec::new(), Vec::new());
        for ends in basis.breaks().windows(2) {
            for (place, weight) in GAUSS {
                let half = 0.5 * (ends[1] - ends[0]);
                let u = 0.5 * (ends[0] + ends[1]) + half * place;
                let mut row = vec![0.0; n];
                let (first, values) = basis.values(u, 0);
                for (value, of_spline) in row[first.min(n)..].iter_mut().zip(values) {
                    *value = 0.5 * weight * half * of_spline;
                }
                places.push(u);
                weighted.push(row);
                for (order, matrix) in [(0, &mut gram), (2, &mut bending)] {
                    let (first, values) = basis.values(u, order);
                    for (i, a) in values.iter().enumerate() {
                        for (j, b) in values.iter().enumerate() {
                            // Half: a mean over an axis of length 2.
                            matrix[(first + i, first + j)] += 0.5 * weight * half * a * b;
                        }
                    }
                }
            }
        }
        // B-splines are independent: their products are positive definite.
        let factor = gram.cholesky().expect("independent functions");
        let inverse = inverse_of_lower(&factor.l());
        let eigen = product(&product(&inverse, &bending), &inverse.transpose()).symmetric_eigen();
        let mut order: Vec<usize> = (0..n).collect();
        order.sort_by(|a, b| eigen.eigenvalues[*a].total_cmp(&eigen.eigenvalues[*b]));
        let turned = product(&inverse.transpose(), &eigen.eigenvectors);
        let mut coefficients = DMatrix::from_fn(n, n, |i, k| turned[(i, order[k])]);
        // The two without bending are known exactly.
        for (i, place) in basis.greville().into_iter().enumerate() {
            coefficients[(i, 0)] = 1.0;
            coefficients[(i, 1)] = 3.0_f64.sqrt() * place;
        }
        let smoothest = eigen.eigenvalues[order[2]];
        let variance = |k: usize| if k < 2 { 1.0 } else { smoothest / eigen.eigenvalues[order[k]] };
        let mut variances: Vec<f64> = (0..n).map(variance).collect();
        let mut swells = [n; SWELLS + 1];
        let weighted = DMatrix::from_fn(places.len(), n, |g, i| weighted[g][i]);
        for (kind, reach) in REACHES.into_iter().enumerate() {
            // The covariance in the space of splines, and what it is diagonal in.
            let forgets = |a: f64, b: f64| units::math::exp(-0.5 * ((a - b) / reach) * ((a - b) / reach));
            let covariance =
                DMatrix::from_fn(places.len(), places.len(), |g, h| forgets(places[g], places[h]));
            let own = product(&weighted.transpose(), &product(&covariance, &weighted));
            let eigen = product(&product(&inverse, &own), &inverse.transpose()).symmetric_eigen();
            let largest = eigen.eigenvalues.max();
            let mut kept: Vec<usize> =
                (0..n).filter(|k| eigen.eigenvalues[*k] > LEAST_VARIANCE * largest).collect();
            kept.sort_by(|a, b| eigen.eigenvalues[*b].total_cmp(&eigen.eigenvalues[*a]));
            let turned = product(&inverse.transpose(), &eigen.eigenvectors);
            let before = coefficients.ncols();
            coefficients = DMatrix::from_fn(n, before + kept.len(), |i, k| {
                if k < before { coefficients[(i, k)] } else { turned[(i, kept[k - before])] }
            });
            variances.extend(kept.iter().map(|k| eigen.eigenvalues[*k]));
            swells[kind + 1] = variances.len();
        }
        Self { range, basis, coefficients, variances, swells }
    }

    /// How many functions, those of swells among them.
    pub(super) fn count(&self) -> usize {
        self.variances.len()
    }

    /// Numbers of the modes.
    pub(super) fn modes(&self) -> std::ops::Range<usize> {
        0..self.swells[0]
    }

    /// Numbers of the functions whose products make swells of a kind.
    pub(super) fn swells(&self, kind: usize) -> std::ops::Range<usize> {
        self.swells[kind]..self.swells[kind + 1]
    }

    pub(super) fn variance(&self, mode: usize) -> f64 {
        self.variances[mode]
    }

    /// All functions at a place of the axis, mm.
    pub(super) fn at(&self, q_mm: f64) -> Vec<f64> {
        let u = 2.0 * (q_mm - self.range.low) / (self.range.high - self.range.low) - 1.0;
        let (first, values) = self.basis.values(u, 0);
        let mode = |k: usize| -> f64 {
            values.iter().enumerate().map(|(i, value)| value * self.coefficients[(first + i, k)]).sum()
        };
        (0..self.count()).map(mode).collect()
    }

    /// Part of function `k` in the coefficient of spline `i`.
    pub(super) fn coefficient(&self, i: usize, k: usize) -> f64 {
        self.coefficients[(i, k)]
    }

    /// The splines over the axis itself.
    pub(super) fn basis(&self) -> Basis {
        Basis::even(self.range, self.basis.breaks().len() - 1)
    }
}

/// By plain loops: products of the library take other last digits on other processors.
fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(a.nrows(), b.ncols(), |i, j| (0..a.ncols()).map(|k| a[(i, k)] * b[(k, j)]).sum())
}

fn inverse_of_lower(l: &DMatrix<f64>) -> DMatrix<f64> {
    let n = l.nrows();
    let mut inverse = DMatrix::zeros(n, n);
    for j in 0..n {
        inverse[(j, j)] = 1.0 / l[(j, j)];
        for i in j + 1..n {
            let sum: f64 = (j..i).map(|k| l[(i, k)] * inverse[(k, j)]).sum();
            inverse[(i, j)] = -sum / l[(i, i)];
        }
    }
    inverse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn modes_are_orthogonal_and_ever_rougher() {
        for intervals in [1, 2, 9, 30] {
            let modes = Modes::new(Range { low: 10.0, high: 70.0 }, intervals);
            assert_eq!(modes.modes(), 0..intervals + 3);
            const PLACES: usize = 6000;
            let at: Vec<Vec<f64>> =
                (0..PLACES).map(|k| modes.at(10.0 + 60.0 * (k as f64 + 0.5) / PLACES as f64)).collect();
            for a in modes.modes() {
                for b in 0..=a {
                    let mean = at.iter().map(|m| m[a] * m[b]).sum::<f64>() / PLACES as f64;
                    let expected = f64::from(u8::from(a == b));
                    assert!((mean - expected).abs() < 2e-4, "{intervals}: {a} {b} {mean}");
                }
            }
            for k in 3..modes.modes().end {
                assert!(modes.variance(k) < modes.variance(k - 1));
            }
            // A line is mode 0 and mode 1 alone.
            let ends = [modes.at(10.0)[1], modes.at(70.0)[1]];
            assert!((ends[0] + 3.0_f64.sqrt()).abs() < 1e-12 && (ends[1] - 3.0_f64.sqrt()).abs() < 1e-12);
        }
    }

    /// Summed they are the covariance that they were made of.
    #[test]
    fn swells_forget_over_their_reach() {
        let modes = Modes::new(Range { low: -1.0, high: 1.0 }, 30);
        for (kind, reach) in REACHES.into_iter().enumerate() {
            for (a, b) in [(0.3, 0.3), (-1.0, -0.9), (-0.2, 0.5), (-1.0, 1.0)] {
                let [at, there] = [a, b].map(|u| modes.at(u));
                let found: f64 = modes.swells(kind).map(|k| modes.variance(k) * at[k] * there[k]).sum();
                let expected = units::math::exp(-0.5 * ((a - b) / reach) * ((a - b) / reach));
                assert!((found - expected).abs() < 1e-3, "{reach}: {a} {b} {found} {expected}");
            }
            assert!(modes.swells(kind).len() < 16, "{}", modes.swells(kind).len());
        }
    }
}
