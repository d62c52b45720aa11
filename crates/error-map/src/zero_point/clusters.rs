//! Groups of points that lie close together, for bounds that cost little.

use machine_model::Vector;

use super::distance;

/// Points halved again and again along their widest axis: neighbours in the list are neighbours in space.
///
/// The ranges of a level are halves of the level above it, so a level of few groups and one of many
/// come from one list.
pub(super) struct Clusters {
    /// Coordinates of the centroids, and how many points each stands for.
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
    weight: Vec<f64>,
}

impl Clusters {
    /// Levels of `2^level` groups each, from one arrangement of the points; fewer where points run out.
    pub(super) fn levels<const N: usize>(points: &[Vector], levels: [u32; N]) -> [Self; N] {
        let mut ordered = points.to_vec();
        let deepest = levels.iter().copied().max().unwrap_or(0);
        halve(&mut ordered, deepest);
        levels.map(|level| {
            let mut groups = Vec::new();
            split(&ordered, level, &mut groups);
            let mean: Vec<Vector> =
                groups.iter().map(|group| group.iter().sum::<Vector>() / group.len() as f64).collect();
            Self {
                x: mean.iter().map(|c| c.x).collect(),
                y: mean.iter().map(|c| c.y).collect(),
                z: mean.iter().map(|c| c.z).collect(),
                weight: groups.iter().map(|group| group.len() as f64).collect(),
            }
        })
    }

    /// Never above `Σ|p - at|`: the mean distance of a group is at least the distance of its centroid,
    /// since the norm is convex. Equation (42).
    pub(super) fn lower_bound(&self, at: &Vector) -> f64 {
        let places = self.x.iter().zip(&self.y).zip(&self.z);
        places.zip(&self.weight).map(|(((x, y), z), w)| w * distance(x - at.x, y - at.y, z - at.z)).sum()
    }
}

/// Where a list is cut in two: the same for arranging and for reading.
fn middle(length: usize) -> usize {
    length / 2
}

fn halve(points: &mut [Vector], depth: u32) {
    if depth == 0 || points.len() < 2 {
        return;
    }
    let mut low = Vector::repeat(f64::INFINITY);
    let mut high = Vector::repeat(f64::NEG_INFINITY);
    for point in points.iter() {
        low = low.inf(point);
        high = high.sup(point);
    }
    let axis = (high - low).imax();
    let cut = middle(points.len());
    points.select_nth_unstable_by(cut, |a, b| a[axis].total_cmp(&b[axis]));
    let (left, right) = points.split_at_mut(cut);
    halve(left, depth - 1);
    halve(right, depth - 1);
}

fn split<'p>(points: &'p [Vector], depth: u32, groups: &mut Vec<&'p [Vector]>) {
    if depth == 0 || points.len() < 2 {
        if !points.is_empty() {
            groups.push(points);
        }
        return;
    }
    let (left, right) = points.split_at(middle(points.len()));
    split(left, depth - 1, groups);
    split(right, depth - 1, groups);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zero_point::tests::clouds;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn bounds_stay_below_and_grow_with_the_level(points in clouds(), at in prop::array::uniform3(-0.03..0.03f64)) {
            let at = Vector::from(at);
            let sum: f64 = points.iter().map(|p| (p - at).norm()).sum();
            let [one, four, all] = Clusters::levels(&points, [0, 2, 12]).map(|c| c.lower_bound(&at));
            prop_assert!(one <= four + 1e-15 && four <= all + 1e-15, "{one} {four} {all}");
            // A group for each point is the sum itself.
            prop_assert!((all - sum).abs() <= 1e-13 * (1.0 + sum));
        }
    }
}
