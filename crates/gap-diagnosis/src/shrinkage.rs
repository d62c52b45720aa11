//! Shrinkage transported to the commands it is claimed for.

use crate::diagnosis::Shrinkage;

/// What the causes do to a set of commands, set-up and run offsets taken out, per equation and in units of the
/// noise variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strength {
    /// Mean square of their displacement.
    pub square: f64,
    /// Mean square of what the uncertainty of their numbers displaces.
    pub spread: f64,
    /// Noise that the alignment leaves: one minus the share of fitted set-up numbers.
    pub noise: f64,
}

/// Shrinkage of the RMS on target commands.
///
/// `m` is the cross-validated mean square of the residual on the data, in units of the noise variance, and
/// `m_error` its standard error. What of it is neither noise nor uncertainty of the numbers is a wrong shape and
/// grows with the displacement: `m' = noise + spread' + (m - 1 - spread) square' / square` (primes: target), and
/// `S = 1 - sqrt(m' / (m' + square'))`.
#[must_use]
pub(crate) fn transported(m: f64, m_error: f64, data: &Strength, target: &Strength) -> Shrinkage {
    let at = |m: f64| {
        let ratio = if data.square > 0.0 { target.square / data.square } else { 1.0 };
        let shape = ((m - 1.0 - data.spread) * ratio).max(-0.5);
        let left = (target.noise + target.spread + shape * target.noise).max(0.05);
        1.0 - (left / (left + target.square)).sqrt()
    };
    let mid = at(m);
    let (low, high) = (at(m + 2.0 * m_error), at(m - 2.0 * m_error));
    Shrinkage { low: low.min(mid - 0.02).max(0.0), mid, high: high.max(mid + 0.02).min(1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strength(square: f64) -> Strength {
        Strength { square, spread: 0.0, noise: 1.0 }
    }

    #[test]
    fn a_perfect_model_leaves_the_noise() {
        // Effect three times the noise: sqrt(1 + 9) shrinks to 1.
        let s = transported(1.0, 0.0, &strength(9.0), &strength(9.0));
        assert!((s.mid - (1.0 - (1.0_f64 / 10.0).sqrt())).abs() < 1e-12);
    }

    #[test]
    fn what_is_left_grows_with_the_effect() {
        let here = transported(1.5, 0.0, &strength(4.0), &strength(4.0));
        let there = transported(1.5, 0.0, &strength(4.0), &strength(16.0));
        assert!((here.mid - (1.0 - (1.5_f64 / 5.5).sqrt())).abs() < 1e-12);
        assert!((there.mid - (1.0 - (3.0_f64 / 19.0).sqrt())).abs() < 1e-12);
        assert!(here.low < here.mid && here.mid < here.high);
    }
}
