//! What a coarse step of the instrument does to readings.
//!
//! An instrument whose step is coarser than what scatters writes what it sees to the nearest step. Its error is then no
//! noise: readings whose true values differ by whole steps, or by nearly nothing, have the same one, and no scatter shows it,
//! neither within a part nor between parts that were measured at the same places. What is unknown is where the true values
//! lie in a step, for the size of the tool may be any. Over that the errors of two readings with a lag d between their true
//! values, and a noise σ of each, have the covariance (in squares of a step, d and σ in steps)
//!
//! `R(d) = Σ_j exp(-4π²j²σ²) cos(2πjd) / (2π²j²)`,
//!
//! a twelfth where nothing scatters and d is whole. The rest of the rounding, `1/12 - R(0)`, is noise of each reading. The
//! lags are those of the fit, which knows them to `u(d)`: `exp(-2π²j²u²)` beside each term. σ is what then leaves the sum of
//! squares found. Equation (78) of `docs/equations.md`.

use std::f64::consts::PI;

use nalgebra::{DMatrix, DVector};
use units::math::{cos, exp};

/// Terms of the sum: those above have a thirtieth of the whole.
const TERMS: usize = 16;
/// A variance of one reading with rounding, in squares of a step, from which on less than a hundred-thousandth is shared.
const SMOOTH: f64 = 0.4;
/// Halvings that find σ to a thousandth of a step.
const HALVINGS: usize = 12;

/// Readings of one kind that share a size, or do not.
pub(super) struct Stepped<'r> {
    /// What was read, less the noise, by the fit: in steps.
    pub predicted: DVector<f64>,
    /// Readings of one level have one size.
    pub level: Vec<usize>,
    /// What the fit projects on, rows of these readings.
    pub fitted: &'r DMatrix<f64>,
    /// The same with each part at its own size.
    pub within: &'r DMatrix<f64>,
    /// Sum of squares that each part at its own size leaves, in squares of a step, and its degrees of freedom.
    pub squares: f64,
    pub freedom: f64,
}

/// True where the noise is so large, in squares of a step, that the steps do not matter.
pub(super) fn is_smooth(mean_square: f64) -> bool {
    mean_square.is_nan() || mean_square > SMOOTH
}

impl Stepped<'_> {
    /// Covariance of the errors that readings share, in squares of a step; `None` where the noise smooths the steps.
    pub(super) fn shared(&self) -> Option<DMatrix<f64>> {
        let mean_square = self.squares / self.freedom;
        if is_smooth(mean_square) {
            return None;
        }
        // Noise and rounding of a reading: what the fit's own uncertainty comes of.
        let whole = mean_square.max(1.0 / 12.0);
        let rest = DMatrix::identity(self.level.len(), self.level.len()) - self.within;
        let seen = &rest * &rest;
        let mut traces = [0.0; TERMS];
        self.each_pair(whole, |k, l, lag, u_squared| {
            let both = if k == l { 1.0 } else { 2.0 };
            for (term, trace) in traces.iter_mut().enumerate() {
                *trace += both * seen[(k, l)] * of_term(term, 0.0, lag, u_squared);
            }
        });
        // What would be left of these errors, and of the noise of each reading.
        let left = |variance: f64| {
            let shared: f64 = (0..TERMS).map(|term| traces[term] * fade(term, variance)).sum();
            (variance + 1.0 / 12.0 - covariance(variance, 0.0, 0.0)) * self.freedom + shared
        };
        let (mut low, mut high) = (0.0, mean_square.sqrt());
        if left(0.0) >= self.squares {
            high = 0.0;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if left(middle * middle) < self.squares {
                low = middle;
            } else {
                high = middle;
            }
        }
        let mut shared = DMatrix::zeros(self.level.len(), self.level.len());
        self.each_pair(whole, |k, l, lag, u_squared| {
            let value = covariance(high * high, lag, u_squared);
            (shared[(k, l)], shared[(l, k)]) = (value, value);
        });
        Some(shared)
    }

    /// All pairs of one level, each once: their lag, and the square of how well it is known.
    fn each_pair(&self, whole: f64, mut act: impl FnMut(usize, usize, f64, f64)) {
        for k in 0..self.level.len() {
            for l in (k..self.level.len()).filter(|l| self.level[k] == self.level[*l]) {
                let open = self.fitted[(k, k)] + self.fitted[(l, l)] - 2.0 * self.fitted[(k, l)];
                act(k, l, self.predicted[k] - self.predicted[l], whole * open.max(0.0));
            }
        }
    }
}

/// `2π²j²` of a term, counted from nought.
fn twice_squared(term: usize) -> f64 {
    let angle = PI * (term + 1) as f64;
    2.0 * angle * angle
}

/// What noise leaves of a term.
fn fade(term: usize, variance: f64) -> f64 {
    exp(-2.0 * twice_squared(term) * variance)
}

/// A term of R.
fn of_term(term: usize, variance: f64, lag: f64, u_squared: f64) -> f64 {
    let twice = twice_squared(term);
    let faded = twice * (2.0 * variance + u_squared);
    // Smaller than rounding of the sum.
    if faded > 40.0 { 0.0 } else { exp(-faded) * cos(2.0 * PI * (term + 1) as f64 * lag) / twice }
}

/// R of a lag that is known to `u`, squares of a step.
fn covariance(variance: f64, lag: f64, u_squared: f64) -> f64 {
    (0..TERMS).map(|term| of_term(term, variance, lag, u_squared)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_steps_share_is_that_of_a_sawtooth() {
        // Nothing scatters: a twelfth of a step at whole lags, and -1/24 half a step off.
        assert!((covariance(0.0, 0.0, 0.0) - 1.0 / 12.0).abs() < 4e-3);
        assert!((covariance(0.0, 3.0, 0.0) - 1.0 / 12.0).abs() < 4e-3);
        assert!((covariance(0.0, 0.5, 0.0) + 1.0 / 24.0).abs() < 2e-3);
        // By sums over all places in a step, for a noise of 0.2 steps: E[round(x + n)] - x, smoothed.
        let bias = |x: f64| {
            let mut mean = 0.0;
            for k in -400..=400 {
                let n = f64::from(k) / 400.0;
                mean += (x + n).round() * exp(-0.5 * n * n / 0.04);
            }
            let whole: f64 = (-400..=400).map(|k| exp(-0.5 * (f64::from(k) / 400.0).powi(2) / 0.04)).sum();
            mean / whole - x
        };
        for lag in [0.0, 0.2, 0.5] {
            let mean =
                (0..500).map(|k| f64::from(k) / 500.0 + 1e-4).map(|x| bias(x) * bias(x + lag)).sum::<f64>()
                    / 500.0;
            assert!((covariance(0.04, lag, 0.0) - mean).abs() < 1e-4, "{lag}: {mean}");
        }
    }

    /// Twelve readings of one size, all alike: each is known to half a step, and so is their mean.
    #[test]
    fn readings_that_are_all_alike_share_their_rounding() {
        let fitted = DMatrix::from_element(12, 12, 1.0 / 12.0);
        let flat = Stepped {
            predicted: DVector::zeros(12),
            level: vec![0; 12],
            fitted: &fitted,
            within: &fitted,
            squares: 0.0,
            freedom: 11.0,
        };
        let shared = flat.shared().unwrap();
        let mean = shared.sum() / 144.0;
        assert!((mean - 1.0 / 12.0).abs() < 4e-3, "{mean}");
        // Scattered by more than half a step, they share nothing.
        assert!(Stepped { squares: 11.0 * 0.5, ..flat }.shared().is_none());
    }
}
