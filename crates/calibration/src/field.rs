//! How well a field of errors is known: equation (51c).

use machine_model::Vector;
use nalgebra::{DMatrix, Matrix3};
use statrs::distribution::{ContinuousCDF, Gamma};

/// Covariance matrices of the displacements at points, mm², the rigid motion common to them taken off: a frame is no error.
///
/// * `displacements` – three rows a point: derivatives by the parameters
pub(crate) fn spreads(
    places_mm: &[Vector],
    mut displacements: DMatrix<f64>,
    covariance: &DMatrix<f64>,
) -> Vec<Matrix3<f64>> {
    let count = places_mm.len();
    let centre = places_mm.iter().sum::<Vector>() / count.max(1) as f64;
    let reach = places_mm.iter().map(|p| (p - centre).norm()).fold(1.0, f64::max);
    let frame = DMatrix::from_fn(3 * count, 6, |row, k| {
        let (point, i) = (row / 3, row % 3);
        if k < 3 {
            return f64::from(u8::from(i == k));
        }
        let mut unit = Vector::zeros();
        unit[k - 3] = 1.0 / reach;
        unit.cross(&(places_mm[point] - centre))[i]
    });
    let frame = frame.qr().q();
    displacements -= &frame * frame.tr_mul(&displacements);
    let spread = &displacements * covariance;
    (0..count)
        .map(|k| spread.rows(3 * k, 3) * displacements.rows(3 * k, 3).transpose())
        .map(|m| Matrix3::from_fn(|i, j| m[(i, j)]))
        .collect()
}

/// The length that 95 % of the points' normal displacements keep on average, mm: of each point `|d|²` as a gamma distribution of
/// the same mean and variance.
pub(crate) fn quantile_of_points(spreads: &[Matrix3<f64>]) -> f64 {
    let points: Vec<(Gamma, f64)> = spreads
        .iter()
        .filter_map(|spread| {
            let (mean, variance) = (spread.trace(), 2.0 * (spread * spread).trace());
            let shape = mean * mean / variance;
            (variance > 0.0).then(|| Gamma::new(shape, 1.0).ok().map(|g| (g, shape / mean)))?
        })
        .collect();
    if points.is_empty() {
        return 0.0;
    }
    let still = (spreads.len() - points.len()) as f64;
    let share = |length: f64| {
        (still + points.iter().map(|(g, rate)| g.cdf(length * length * rate)).sum::<f64>())
            / spreads.len() as f64
    };
    let mut high = spreads.iter().map(Matrix3::trace).fold(0.0, f64::max).sqrt() * 4.0;
    let mut low = 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if share(middle) < 0.95 { low = middle } else { high = middle }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_chi_squared() {
        // One direction: 1.96; three equal ones: √7.815.
        let line = Matrix3::from_diagonal(&Vector::new(4.0, 0.0, 0.0));
        assert!((quantile_of_points(&[line]) - 2.0 * 1.959_96).abs() < 1e-3);
        let ball = Matrix3::identity();
        assert!((quantile_of_points(&[ball, ball]) - 7.814_73_f64.sqrt()).abs() < 1e-3);
        assert!(quantile_of_points(&[Matrix3::zeros()]) == 0.0);
    }

    #[test]
    fn a_rigid_motion_has_no_spread() {
        let places: Vec<Vector> = (0..8)
            .map(|k| Vector::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2)) * 300.0)
            .collect();
        let turn = Vector::new(1.0, -2.0, 0.3);
        let rows = DMatrix::from_fn(24, 1, |row, _| (turn.cross(&places[row / 3]) + turn)[row % 3]);
        let spread = spreads(&places, rows, &DMatrix::from_element(1, 1, 1.0));
        assert!(spread.iter().all(|s| s.norm() < 1e-18 * 300.0 * 300.0));
    }
}
