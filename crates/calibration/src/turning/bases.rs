//! Orthonormal bases, and what they leave of a vector.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

/// What an F of so many degrees of freedom exceeds with this chance; infinite ones below: the noise is known.
pub(super) fn fisher_limit(above: f64, below: f64, chance: f64) -> f64 {
    FisherSnedecor::new(above, below.min(KNOWN_FREEDOM))
        .map_or(f64::INFINITY, |f| f.inverse_cdf(1.0 - chance))
}

/// Degrees of freedom of a standard deviation that is stated.
pub(crate) const KNOWN_FREEDOM: f64 = 1e6;

/// Projection on what an orthonormal basis spans, its rows and columns `own`.
pub(crate) fn projection(basis: &[DVector<f64>], own: &[usize]) -> DMatrix<f64> {
    basis.iter().fold(DMatrix::zeros(own.len(), own.len()), |sum, vector| {
        let vector = vector.select_rows(own);
        sum + &vector * vector.transpose()
    })
}

/// An orthonormal basis of what these span beyond the given one.
pub(super) fn orthonormal(vectors: &[DVector<f64>], given: &[DVector<f64>]) -> Vec<DVector<f64>> {
    let mut basis = given.to_vec();
    for vector in vectors {
        let own = without(vector, &basis);
        if own.norm() > 1e-9 * vector.norm() {
            basis.push(own.normalize());
        }
    }
    basis
}

/// A vector less its part in an orthonormal basis; twice, for rounding.
pub(super) fn without(vector: &DVector<f64>, basis: &[DVector<f64>]) -> DVector<f64> {
    let once = basis.iter().fold(vector.clone(), |left, own| &left - own * own.dot(&left));
    basis.iter().fold(once, |left, own| &left - own * own.dot(&left))
}
