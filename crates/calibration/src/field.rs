//! How well a field of errors is known: equation (51c).

use machine_model::{Range, Vector};
use nalgebra::{DMatrix, Matrix3};
use statrs::distribution::{ContinuousCDF, Gamma};

/// How many places stand for a volume.
const PLACES: usize = 125;

/// Places that stand for all of a box of so many coordinates: as many in each part as the part is large, and in step with no nodes.
///
/// Between two nodes the noise of both is averaged, at the ends of an axis its functions reach farthest: a grid has too many
/// places of one kind or the other. Coordinate j of place k is the fraction of k/φʲ, φ the root of `φ^(d+1) = φ + 1` (Roberts 2018,
/// "The unreasonable effectiveness of quasirandom sequences").
pub(crate) fn places(ranges: &[Range]) -> Vec<Vec<f64>> {
    let power = |x: f64, n: usize| std::iter::repeat_n(x, n).product::<f64>();
    let d = ranges.len();
    let mut root = 2.0;
    // Newton's steps from above: the function is convex there.
    for _ in 0..30 {
        let slope = (d + 1) as f64 * power(root, d) - 1.0;
        root -= (power(root, d + 1) - root - 1.0) / slope;
    }
    let coordinate = |k: usize, j: usize, range: &Range| {
        let part = (0.5 + (k + 1) as f64 / power(root, j + 1)).fract();
        range.low + (range.high - range.low) * part
    };
    (0..PLACES)
        .map(|k| ranges.iter().enumerate().map(|(j, range)| coordinate(k, j, range)).collect())
        .collect()
}

/// The same of the three linear axes.
pub(crate) fn places_mm(ranges: &[Range; 3]) -> Vec<Vector> {
    places(ranges).into_iter().map(|place| Vector::from_fn(|i, _| place[i])).collect()
}

/// Covariance matrices of the displacements at points, mm², the rigid motion common to them taken off: a frame is no error.
///
/// * `displacements` – three rows a point: derivatives by the parameters
pub(crate) fn spreads(
    places_mm: &[Vector],
    displacements: DMatrix<f64>,
    covariance: &DMatrix<f64>,
) -> Vec<Matrix3<f64>> {
    let own = without_frame(places_mm, displacements);
    let spread = &own * covariance;
    products(&spread, &own)
}

/// The same by parameters that scatter independently, each by one.
pub(crate) fn independent_spreads(places_mm: &[Vector], displacements: DMatrix<f64>) -> Vec<Matrix3<f64>> {
    let own = without_frame(places_mm, displacements);
    products(&own, &own)
}

/// What no shift and no small rotation of all points does.
fn without_frame(places_mm: &[Vector], mut displacements: DMatrix<f64>) -> DMatrix<f64> {
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
    displacements
}

/// `a bᵀ` of the three rows of each point.
fn products(a: &DMatrix<f64>, b: &DMatrix<f64>) -> Vec<Matrix3<f64>> {
    (0..a.nrows() / 3)
        .map(|k| a.rows(3 * k, 3) * b.rows(3 * k, 3).transpose())
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
    fn places_fill_a_box_evenly() {
        for d in 1..=5 {
            let all = places(&vec![Range { low: -1.0, high: 1.0 }; d]);
            for j in 0..d {
                // Mean 0 and mean square 1/3 of a uniform distribution, and no two coordinates go together; random places would be off by
                // 0.05, 0.03 and 0.03 in one standard deviation.
                let mean = |of: &dyn Fn(&Vec<f64>) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
                assert!(mean(&|p| p[j]).abs() < 0.065, "{d} {j}");
                assert!((mean(&|p| p[j] * p[j]) - 1.0 / 3.0).abs() < 0.01, "{d} {j}");
                assert!((0..j).all(|i| mean(&|p| p[i] * p[j]).abs() < 0.065), "{d} {j}");
            }
        }
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
