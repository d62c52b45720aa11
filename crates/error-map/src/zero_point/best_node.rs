//! The best node: exhaustive search as published, without looking at what cannot win.

use machine_model::Vector;

use super::clusters::Clusters;
use super::{Cloud, geometric_median};

/// The node whose own error is the best shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestNode {
    /// Its index.
    pub index: usize,
    /// Its error: the shift, mm.
    pub shift_mm: Vector,
    /// `Σ_j |d_j - d_k|`, mm.
    pub sum_mm: f64,
    /// Nodes whose sum had to be computed; all others were proven worse by a bound.
    pub examined: usize,
}

/// Sums this close are equal: they differ by rounding.
const SAME: f64 = 1e-12;

/// The node k with the least `Σ_j |d_j - d_k|` (Teleshevsky 2013): equation (42).
///
/// The same node as the search over all pairs gives. Among equal sums the one with the smaller
/// largest `|d_j - d_k|` wins, then the first. A node is passed over only where a lower bound of its
/// sum (the sum over groups of neighbours, each taken at its centroid) exceeds the best sum found.
///
/// `None` of no nodes.
#[must_use]
pub fn best_node(errors_mm: &[Vector]) -> Option<BestNode> {
    let median = geometric_median(errors_mm)?;
    let cloud = Cloud::new(errors_mm);
    let bounds = Clusters::levels(errors_mm, [4, 9, 13]);
    let mut best: Option<(BestNode, f64)> = None;
    let mut examined = 0;
    let mut try_node = |index: usize, best: &mut Option<(BestNode, f64)>| {
        let shift_mm = errors_mm[index];
        examined += 1;
        let sum_mm = cloud.sum_of_distances(&shift_mm);
        let found = BestNode { index, shift_mm, sum_mm, examined };
        let Some((so_far, farthest)) = best else {
            *best = Some((found, largest(errors_mm, &shift_mm)));
            return;
        };
        let same = (sum_mm - so_far.sum_mm).abs() <= SAME * so_far.sum_mm;
        if sum_mm > so_far.sum_mm && !same {
            return;
        }
        let reach = largest(errors_mm, &shift_mm);
        if !same || (reach, index) < (*farthest, so_far.index) {
            *best = Some((found, reach));
        }
    };
    let near = |index: &usize| (errors_mm[*index] - median.shift_mm).norm_squared();
    let first = (0..errors_mm.len()).min_by(|a, b| near(a).total_cmp(&near(b)))?;
    try_node(first, &mut best);
    for index in (0..errors_mm.len()).filter(|index| *index != first) {
        let limit = best.map_or(f64::INFINITY, |(found, _)| found.sum_mm * (1.0 + SAME));
        let at = &errors_mm[index];
        if bounds.iter().all(|bound| bound.lower_bound(at) <= limit) {
            try_node(index, &mut best);
        }
    }
    best.map(|(found, _)| BestNode { examined, ..found })
}

fn largest(errors_mm: &[Vector], at: &Vector) -> f64 {
    errors_mm.iter().map(|d| (d - at).norm_squared()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zero_point::tests::clouds;
    use proptest::prelude::*;

    /// All pairs, as published.
    fn exhaustive(errors: &[Vector]) -> (usize, f64) {
        let sum = |k: usize| errors.iter().map(|d| (d - errors[k]).norm()).sum::<f64>();
        let sums: Vec<f64> = (0..errors.len()).map(sum).collect();
        let least = sums.iter().copied().fold(f64::INFINITY, f64::min);
        let best = (0..errors.len())
            .filter(|k| sums[*k] <= least * (1.0 + SAME))
            .min_by(|a, b| largest(errors, &errors[*a]).total_cmp(&largest(errors, &errors[*b])))
            .unwrap();
        (best, least)
    }

    proptest! {
        #[test]
        fn passing_nodes_over_changes_nothing(points in clouds()) {
            let found = best_node(&points).unwrap();
            let (index, sum) = exhaustive(&points);
            prop_assert!((found.sum_mm - sum).abs() <= 1e-12 * (1.0 + sum));
            prop_assert_eq!(points[found.index], points[index]);
        }
    }

    #[test]
    fn the_published_grid_needs_few_sums() {
        // A smooth field over 22×22×21 nodes, as a machine makes it.
        let at = |i: usize| {
            let (x, y, z) = ((i % 22) as f64, (i / 22 % 22) as f64, (i / 484) as f64);
            Vector::new(0.002 * x - 1e-4 * x * y, 0.001 * y + 5e-5 * z * x, -8e-4 * z + 3e-5 * y * y)
        };
        let errors: Vec<Vector> = (0..10_164).map(at).collect();
        let found = best_node(&errors).unwrap();
        assert_eq!(found.index, exhaustive(&errors).0);
        assert!(found.examined < 1_000, "{} of 10164", found.examined);
    }
}
