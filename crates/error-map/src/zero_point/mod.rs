//! Where to put the zero point: equations (41) to (44) of `docs/equations.md`.
//!
//! Moving the origin by `s` makes every error `d - s` (Teleshevsky 2013). Four answers to "which s":
//!
//! | question | answer |
//! |---|---|
//! | the node whose own error leaves the smallest sum of `abs(d - s)` | [`best_node`], as published |
//! | the same for any `s` | [`geometric_median`] |
//! | the smallest largest `abs(d - s)` | [`smallest_ball`] |
//! | most nodes with `abs(d - s)` within a tolerance | [`best_share`] |
//!
//! Each says how good it is provably, so that nobody needs to trust the search.

mod ball;
mod best_node;
mod clusters;
mod median;
mod share;

pub use ball::{Ball, smallest_ball};
pub use best_node::{BestNode, best_node};
pub use median::{Median, geometric_median};
pub use share::{BestShare, best_share};

use machine_model::Vector;

/// Points by coordinate, so that sums over all of them run four at a time.
struct Cloud {
    x: Vec<f64>,
    y: Vec<f64>,
    z: Vec<f64>,
}

/// Sums run in this many lanes, always: the order of addition, and so the last bit, does not depend
/// on what the processor can do.
const LANES: usize = 4;

impl Cloud {
    fn new(points: &[Vector]) -> Self {
        let of = |axis: usize| points.iter().map(|p| p[axis]).collect();
        Self { x: of(0), y: of(1), z: of(2) }
    }

    /// `Σ w·|p - at|`; `weights` as many as points, or none for 1.
    fn sum_of_distances(&self, at: &Vector) -> f64 {
        let (xs, x_rest) = self.x.as_chunks::<LANES>();
        let (ys, y_rest) = self.y.as_chunks::<LANES>();
        let (zs, z_rest) = self.z.as_chunks::<LANES>();
        let mut lanes = [0.0; LANES];
        for ((x, y), z) in xs.iter().zip(ys).zip(zs) {
            for lane in 0..LANES {
                lanes[lane] += distance(x[lane] - at.x, y[lane] - at.y, z[lane] - at.z);
            }
        }
        let rest: f64 = x_rest
            .iter()
            .zip(y_rest)
            .zip(z_rest)
            .map(|((x, y), z)| distance(x - at.x, y - at.y, z - at.z))
            .sum();
        lanes.iter().sum::<f64>() + rest
    }
}

/// Length of a vector; without `hypot`, whose care for overflow errors in mm do not need.
#[inline]
fn distance(x: f64, y: f64, z: f64) -> f64 {
    (x * x + y * y + z * z).sqrt()
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Pimushkin 2023, §1.4: errors along one line, µm.
    pub(crate) fn line() -> Vec<Vector> {
        [0.0, 3.0, 1.0, 5.0, 6.0, 2.0, 1.0, 4.0, 3.0, 0.0].map(|um| Vector::new(um * 1e-3, 0.0, 0.0)).into()
    }

    /// Clouds as maps make them, and as they should not: doubled points, points in a plane, on a line.
    pub(crate) fn clouds() -> impl Strategy<Value = Vec<Vector>> {
        let coordinate = prop_oneof![(-20i32..20).prop_map(f64::from), -20.0..20.0f64];
        let point = prop::array::uniform3(coordinate);
        (prop::collection::vec(point, 1..60), 1usize..4).prop_map(|(points, dimensions)| {
            points
                .into_iter()
                .map(|p| Vector::from_fn(|axis, _| if axis < dimensions { p[axis] * 1e-3 } else { 0.0 }))
                .collect()
        })
    }

    #[test]
    fn the_published_line() {
        let errors = line();
        let node = best_node(&errors).unwrap();
        assert_eq!(node.shift_mm, Vector::new(0.003, 0.0, 0.0), "shift by 3 um");
        let left: Vec<f64> = errors.iter().map(|d| ((d - node.shift_mm).x * 1e3).round()).collect();
        assert_eq!(left, [-3.0, 0.0, -2.0, 2.0, 3.0, -1.0, -2.0, 1.0, 0.0, -3.0]);
        assert_eq!(left.iter().sum::<f64>(), -5.0, "the signed sum");
        assert!((node.sum_mm - 0.017).abs() < 1e-15);
        // Any place between 2 and 3 um has the same sum; the middle of the band is 3.
        let median = geometric_median(&errors).unwrap();
        assert!((median.sum_mm - 0.017).abs() < 1e-15);
        let ball = smallest_ball(&errors).unwrap();
        assert!((ball.centre_mm - Vector::new(0.003, 0.0, 0.0)).norm() < 1e-15);
        assert!((ball.radius_mm - 0.003).abs() < 1e-15, "band ±3 um");
    }

    proptest! {
        #[test]
        fn sums_do_not_depend_on_lanes(points in clouds(), at in prop::array::uniform3(-0.03..0.03f64)) {
            let at = Vector::from(at);
            let plain: f64 = points.iter().map(|p| (p - at).norm()).sum();
            prop_assert!((Cloud::new(&points).sum_of_distances(&at) - plain).abs() <= 1e-14 * (1.0 + plain));
        }

        #[test]
        fn each_answer_is_the_best_in_its_own_measure(points in clouds()) {
            let node = best_node(&points).unwrap();
            let median = geometric_median(&points).unwrap();
            let ball = smallest_ball(&points).unwrap();
            let sum = |s: &Vector| points.iter().map(|p| (p - s).norm()).sum::<f64>();
            let most = |s: &Vector| points.iter().map(|p| (p - s).norm()).fold(0.0, f64::max);
            let slack = 1e-12;
            prop_assert!(sum(&median.shift_mm) <= sum(&node.shift_mm) + slack);
            prop_assert!(sum(&median.shift_mm) <= sum(&ball.centre_mm) + slack);
            prop_assert!(most(&ball.centre_mm) <= most(&median.shift_mm) + slack);
            prop_assert!(most(&ball.centre_mm) <= most(&node.shift_mm) + slack);
        }
    }
}
