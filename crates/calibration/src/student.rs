//! Coverage factors.

use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

/// Two-sided 95 % quantile of Student's t: the factor from a standard uncertainty with so many degrees of
/// freedom to the half width of the interval. 1.96 where the standard deviation is known (`None`).
///
/// Infinite for zero degrees of freedom: nothing is known of the scatter then.
#[must_use]
pub fn quantile_95(degrees_of_freedom: Option<usize>) -> f64 {
    match degrees_of_freedom {
        None => 1.959_963_984_540_054,
        Some(0) => f64::INFINITY,
        Some(n) => StudentsT::new(0.0, 1.0, n as f64).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975)),
    }
}

/// What the magnitude of a standardised deviation exceeds with this chance: Student's t, or the normal distribution where
/// the standard deviation is known (`None`). Infinite for zero degrees of freedom.
#[must_use]
pub fn quantile(chance: f64, degrees_of_freedom: Option<usize>) -> f64 {
    quantile_between(chance, degrees_of_freedom.map_or(f64::INFINITY, |n| n as f64))
}

/// More degrees of freedom change no quantile of use by a millionth.
const AS_NORMAL: f64 = 1e7;

/// [`quantile`] for effective degrees of freedom, which lie between whole numbers; infinite ones: the normal distribution.
#[must_use]
pub(crate) fn quantile_between(chance: f64, degrees_of_freedom: f64) -> f64 {
    let below = 1.0 - 0.5 * chance;
    if degrees_of_freedom > AS_NORMAL {
        Normal::standard().inverse_cdf(below)
    } else {
        StudentsT::new(0.0, 1.0, degrees_of_freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(below))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (n, t) in [(1, 12.7062), (4, 2.7764), (9, 2.2622), (30, 2.0423)] {
            assert!((quantile_95(Some(n)) - t).abs() < 5e-5, "{n}");
        }
        assert!(quantile_95(Some(0)).is_infinite());
        assert!((quantile(0.05, Some(9)) - quantile_95(Some(9))).abs() < 1e-12);
        assert!((quantile_between(0.05, 2.5) - 3.5601).abs() < 2e-2, "{}", quantile_between(0.05, 2.5));
        assert!(
            (quantile(1e-5, None) - 4.4172).abs() < 1e-3 && (quantile(1e-3, Some(9)) - 4.781).abs() < 1e-3
        );
    }
}
