//! The F test.

use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// Probability that an F variate exceeds `ratio`.
pub(crate) fn f_tail(ratio: f64, numerator: f64, denominator: f64) -> f64 {
    if ratio <= 0.0 || ratio.is_nan() {
        return 1.0;
    }
    FisherSnedecor::new(numerator.max(1.0), denominator.max(1.0)).map_or(1.0, |d| d.sf(ratio))
}
