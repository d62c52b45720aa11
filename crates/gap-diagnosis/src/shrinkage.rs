//! Shrinkage transported to the commands it is claimed for.

use crate::diagnosis::Shrinkage;

/// Shrinkage of the RMS on target commands.
///
/// With everything in units of the noise variance: `m` the cross-validated mean square of the residual on the
/// data, `f_data` and `f_target` the mean square of the effects' displacement there and there, the error of
/// the effects grows with their size: `m' = 1 + (m - 1) f_target / f_data`, and
/// `S = 1 - sqrt(m' / (m' + f_target))`. `m_error` is the standard error of `m`.
#[must_use]
pub(crate) fn transported(m: f64, m_error: f64, f_data: f64, f_target: f64) -> Shrinkage {
    let at = |m: f64| {
        let ratio = if f_data > 0.0 { f_target / f_data } else { 1.0 };
        let left = (1.0 + (m - 1.0) * ratio).max(0.05);
        1.0 - (left / (left + f_target)).sqrt()
    };
    let mid = at(m);
    let (low, high) = (at(m + 2.0 * m_error), at(m - 2.0 * m_error));
    Shrinkage { low: low.min(mid - 0.02).max(0.0), mid, high: high.max(mid + 0.02).min(1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_perfect_model_leaves_the_noise() {
        // Effect three times the noise: sqrt(1 + 9) shrinks to 1.
        let s = transported(1.0, 0.0, 9.0, 9.0);
        assert!((s.mid - (1.0 - (1.0_f64 / 10.0).sqrt())).abs() < 1e-12);
    }

    #[test]
    fn what_is_left_grows_with_the_effect() {
        let here = transported(1.5, 0.0, 4.0, 4.0);
        let there = transported(1.5, 0.0, 4.0, 16.0);
        assert!((here.mid - (1.0 - (1.5_f64 / 5.5).sqrt())).abs() < 1e-12);
        assert!((there.mid - (1.0 - (3.0_f64 / 19.0).sqrt())).abs() < 1e-12);
        assert!(here.low < here.mid && here.mid < here.high);
    }
}
