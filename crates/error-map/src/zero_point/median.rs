//! The geometric median: the shift that leaves the smallest sum of distances.

use machine_model::Vector;
use nalgebra::Matrix3;

/// The best shift for the sum of all `|d - s|`, with the proof of how good it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Median {
    /// The shift, mm.
    pub shift_mm: Vector,
    /// `Σ_j |d_j - s|`, mm.
    pub sum_mm: f64,
    /// No shift at all has a smaller sum than this, mm: equation (43).
    pub lower_bound_mm: f64,
    /// Passes over all points.
    pub iterations: u32,
}

/// A sum this close to its lower bound, as a share of it, is the minimum.
const CLOSE: f64 = 1e-13;
/// Passes after which the answer is given as it stands, with its bound.
const MOST_PASSES: u32 = 500;

/// One look at all points from a place.
struct View {
    /// `Σ|p - x|`.
    sum: f64,
    /// `Σ u`, `u` the unit vectors to the points elsewhere: minus the gradient.
    pull: Vector,
    /// `Σ (1 - u uᵀ)/r`: the second derivative.
    curvature: Matrix3<f64>,
    /// `Σ 1/r`.
    weight: f64,
    /// Points at the place itself.
    here: f64,
    /// The nearest point elsewhere, and its distance.
    nearest: Option<(usize, f64)>,
}

impl View {
    fn from(points: &[Vector], x: &Vector, scale: f64) -> Self {
        let mut view = Self {
            sum: 0.0,
            pull: Vector::zeros(),
            curvature: Matrix3::zeros(),
            weight: 0.0,
            here: 0.0,
            nearest: None,
        };
        let mut nearest = f64::INFINITY;
        // Of Σ u uᵀ/r the six entries that differ.
        let [mut xx, mut yy, mut zz, mut xy, mut xz, mut yz] = [0.0; 6];
        // Closer than rounding can tell apart.
        let same = scale * 1e-15;
        for (index, point) in points.iter().enumerate() {
            let to = point - x;
            let r = to.norm();
            if r <= same {
                view.here += 1.0;
                continue;
            }
            if r < nearest {
                nearest = r;
                view.nearest = Some((index, r));
            }
            let inverse = 1.0 / r;
            let u = to * inverse;
            view.sum += r;
            view.pull += u;
            view.weight += inverse;
            xx += inverse * u.x * u.x;
            yy += inverse * u.y * u.y;
            zz += inverse * u.z * u.z;
            xy += inverse * u.x * u.y;
            xz += inverse * u.x * u.z;
            yz += inverse * u.y * u.z;
        }
        let w = view.weight;
        view.curvature = Matrix3::new(w - xx, -xy, -xz, -xy, w - yy, -yz, -xz, -yz, w - zz);
        view
    }

    /// True where this place is better. Near the minimum sums agree to their last digits long before the
    /// pull has gone, and the pull is what the proof depends on.
    fn below(&self, other: &Self) -> bool {
        let same = (self.sum - other.sum).abs() <= 1e-14 * other.sum;
        if same { self.pull.norm() < 0.5 * other.pull.norm() } else { self.sum < other.sum }
    }

    /// Lower bound of the sum for every shift: equation (43).
    ///
    /// `Σ v·p` with any `|v| ≤ 1` that add to zero is such a bound. The unit vectors do not quite add to
    /// zero; the points at the place itself, whose vector is free, take up what they can of the rest,
    /// and what then remains is spread over all and scaled back.
    fn lower_bound(&self, points: f64, mean: &Vector, x: &Vector) -> f64 {
        let length = self.pull.norm();
        let rest =
            if length > self.here { self.pull * ((length - self.here) / length) } else { Vector::zeros() };
        (self.sum - rest.dot(&(mean - x))) / (1.0 + rest.norm() / points)
    }
}

/// The geometric median of errors: the `s` that minimises `Σ_j |d_j - s|`; `None` of none.
///
/// Weiszfeld's iteration with the step of Vardi and Zhang (2000) where it meets a point, and Newton's step
/// where that goes further down. The sum is convex, so where the pull of all other points on a point
/// is no stronger than the number of points there, it is the minimum. Stops where sum and lower bound
/// agree to 10⁻¹³; where they do not, both are told.
#[must_use]
pub fn geometric_median(errors_mm: &[Vector]) -> Option<Median> {
    if errors_mm.is_empty() {
        return None;
    }
    let count = errors_mm.len() as f64;
    let mean = errors_mm.iter().sum::<Vector>() / count;
    let scale = errors_mm.iter().map(Vector::amax).fold(0.0, f64::max);
    let answer = |x: Vector, view: &View, iterations: u32| Median {
        shift_mm: x,
        sum_mm: view.sum,
        lower_bound_mm: view.lower_bound(count, &mean, &x).min(view.sum),
        iterations,
    };
    let mut x = mean;
    let mut view = View::from(errors_mm, &x, scale);
    let mut iterations = 1;
    let mut tried = None;
    loop {
        let gap = view.sum - view.lower_bound(count, &mean, &x);
        if view.pull.norm() <= view.here || gap <= CLOSE * view.sum || iterations >= MOST_PASSES {
            return Some(answer(x, &view, iterations));
        }
        // A point that carries much of the weight may be where the way leads: there the sum has a corner
        // that no smooth step reaches.
        if let Some((index, r)) = view.nearest
            && tried != Some(index)
            && r * view.weight < 10.0
        {
            tried = Some(index);
            let corner = View::from(errors_mm, &errors_mm[index], scale);
            iterations += 1;
            if corner.pull.norm() <= corner.here {
                return Some(answer(errors_mm[index], &corner, iterations));
            }
        }
        let newton = view.curvature.cholesky().map(|c| x + c.solve(&view.pull));
        let mut next = None;
        if let (Some(to), true) = (newton, view.here == 0.0) {
            let there = View::from(errors_mm, &to, scale);
            iterations += 1;
            if there.below(&view) {
                next = Some((to, there));
            }
        }
        let (to, there) = next.unwrap_or_else(|| {
            // At a point only the part of the pull that exceeds its weight moves: Vardi and Zhang.
            let share = 1.0 - view.here / view.pull.norm();
            let to = x + view.pull * (share.max(0.0) / view.weight);
            iterations += 1;
            (to, View::from(errors_mm, &to, scale))
        });
        if !there.below(&view) {
            return Some(answer(x, &view, iterations));
        }
        (x, view) = (to, there);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zero_point::tests::clouds;
    use proptest::prelude::*;

    #[test]
    fn corners_of_a_triangle_and_its_fermat_point() {
        // Equilateral: the centre sees all three under 120°.
        let h = 3.0f64.sqrt() / 2.0;
        let points = [Vector::zeros(), Vector::new(1.0, 0.0, 0.0), Vector::new(0.5, h, 0.0)];
        let found = geometric_median(&points).unwrap();
        assert!((found.shift_mm - Vector::new(0.5, h / 3.0, 0.0)).norm() < 1e-12);
        assert!((found.sum_mm - 3.0f64.sqrt()).abs() < 1e-14);
        // An angle above 120°: the corner itself.
        let flat = [Vector::zeros(), Vector::new(1.0, 0.1, 0.0), Vector::new(-1.0, 0.1, 0.0)];
        assert_eq!(geometric_median(&flat).unwrap().shift_mm, Vector::zeros());
    }

    #[test]
    fn starting_on_a_point_that_is_not_the_median_leaves_it() {
        // The mean of these is (0, 0, 0), which is one of them; Weiszfeld's plain step would stand still.
        let points = [
            Vector::zeros(),
            Vector::new(3.0, 0.0, 0.0),
            Vector::new(-1.0, 0.5, 0.0),
            Vector::new(-1.0, -0.5, 0.0),
            Vector::new(-1.0, 0.0, 0.0),
        ];
        let found = geometric_median(&points).unwrap();
        assert!(found.shift_mm.x < -0.5, "{found:?}");
        assert!(found.sum_mm - found.lower_bound_mm <= 1e-12);
    }

    proptest! {
        #[test]
        fn the_lower_bound_meets_the_sum(points in clouds()) {
            let found = geometric_median(&points).unwrap();
            prop_assert!(found.lower_bound_mm <= found.sum_mm);
            prop_assert!(found.sum_mm - found.lower_bound_mm <= 1e-9 * found.sum_mm, "{found:?}");
        }

        #[test]
        fn no_other_place_has_a_sum_below_the_bound(points in clouds(), at in prop::array::uniform3(-0.02..0.02f64)) {
            let at = Vector::from(at);
            let scale = 0.02;
            let mean = points.iter().sum::<Vector>() / points.len() as f64;
            // The bound holds wherever it is taken, not only at the end.
            let bound = View::from(&points, &at, scale).lower_bound(points.len() as f64, &mean, &at);
            let least = geometric_median(&points).unwrap().sum_mm;
            prop_assert!(bound <= least * (1.0 + 1e-12) + 1e-15, "{bound} {least}");
        }
    }
}
