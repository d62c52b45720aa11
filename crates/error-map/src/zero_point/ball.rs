//! The smallest ball around all errors: the shift with the smallest largest error.

use machine_model::Vector;
use nalgebra::Matrix3;

/// A ball that holds all errors.
#[derive(Clone, Debug, PartialEq)]
pub struct Ball {
    /// Its centre: the shift, mm.
    pub centre_mm: Vector,
    /// Its radius: the largest `|d - s|`, mm.
    pub radius_mm: f64,
    /// Indices of the two to four errors on its surface that leave no smaller ball.
    pub support: Vec<usize>,
}

/// Distances this much above the radius, as a share of it, lie on the surface.
const ON: f64 = 1e-12;

/// The smallest ball around the errors; `None` of none.
///
/// Exact up to rounding: the smallest ball around a few errors is widened by the error farthest outside until
/// none is outside. Each widened ball is larger, so no few come twice, and it ends; three or four
/// rounds are usual (Gärtner 1999 calls the choice of the farthest a pivot rule). Every ball is that
/// of two to four errors whose hull holds its centre, which is the proof that none is smaller:
/// equation (44).
#[must_use]
pub fn smallest_ball(errors_mm: &[Vector]) -> Option<Ball> {
    let mut ball = Ball { centre_mm: *errors_mm.first()?, radius_mm: 0.0, support: vec![0] };
    let scale = errors_mm.iter().map(Vector::amax).fold(0.0, f64::max);
    loop {
        let outside = |d: &Vector| (d - ball.centre_mm).norm();
        let (index, far) = errors_mm
            .iter()
            .map(outside)
            .enumerate()
            .fold((0, 0.0), |found, next| if next.1 > found.1 { next } else { found });
        if far <= ball.radius_mm + ON * scale || ball.support.contains(&index) {
            ball.radius_mm = far;
            return Some(ball);
        }
        let mut few = ball.support.clone();
        few.push(index);
        let wider = around_few(errors_mm, &few, scale);
        if wider.radius_mm <= ball.radius_mm {
            // Rounding: the errors on the surface cannot be told apart any more.
            ball.radius_mm = far;
            return Some(ball);
        }
        ball = wider;
    }
}

/// The smallest ball around up to five errors: the smallest of the balls through some of them that holds all.
fn around_few(errors_mm: &[Vector], few: &[usize], scale: f64) -> Ball {
    let mut best: Option<Ball> = None;
    for set in 1u32..1 << few.len() {
        if set.count_ones() > 4 {
            continue;
        }
        let support: Vec<usize> = (0..few.len()).filter(|i| set & 1 << i != 0).map(|i| few[i]).collect();
        let Some(centre_mm) = equidistant(errors_mm, &support) else { continue };
        let radius_mm = (errors_mm[support[0]] - centre_mm).norm();
        let holds = few.iter().all(|i| (errors_mm[*i] - centre_mm).norm() <= radius_mm + ON * scale);
        if holds && best.as_ref().is_none_or(|b| radius_mm < b.radius_mm) {
            best = Some(Ball { centre_mm, radius_mm, support });
        }
    }
    // Some ball through two to four of them holds all five: the smallest enclosing one.
    best.unwrap_or_else(|| Ball { centre_mm: errors_mm[few[0]], radius_mm: 0.0, support: few[..1].to_vec() })
}

/// The place in the hull's plane that is equally far from all of up to four points.
fn equidistant(points: &[Vector], support: &[usize]) -> Option<Vector> {
    let origin = points[support[0]];
    let edges: Vec<Vector> = support[1..].iter().map(|i| points[*i] - origin).collect();
    // The centre is origin + Σ λ e with 2 Σ λ_j e_i·e_j = e_i·e_i; rows without an edge say λ = 0.
    let scale = edges.iter().map(Vector::norm_squared).fold(0.0, f64::max);
    let edge = |i: usize| edges.get(i).copied().unwrap_or_default();
    let gram =
        Matrix3::from_fn(|i, j| if i == j && i >= edges.len() { scale } else { 2.0 * edge(i).dot(&edge(j)) });
    let right = Vector::from_fn(|i, _| edge(i).norm_squared());
    if edges.is_empty() {
        return Some(origin);
    }
    let share = gram.lu().solve(&right)?;
    let centre = edges.iter().zip(share.iter()).fold(origin, |at, (edge, by)| at + edge * *by);
    centre.iter().all(|v| v.is_finite()).then_some(centre)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zero_point::tests::clouds;
    use proptest::prelude::*;

    #[test]
    fn corners_of_a_cube() {
        let corner = |bits: u32| Vector::from_fn(|axis, _| f64::from(bits >> axis & 1));
        let points: Vec<Vector> = (0..8).map(corner).collect();
        let ball = smallest_ball(&points).unwrap();
        assert!((ball.centre_mm - Vector::repeat(0.5)).norm() < 1e-14);
        assert!((ball.radius_mm - 0.75f64.sqrt()).abs() < 1e-14);
    }

    #[test]
    fn an_obtuse_triangle_is_held_by_two_of_its_corners() {
        let points = [Vector::zeros(), Vector::new(10.0, 0.0, 0.0), Vector::new(5.0, 1.0, 0.0)];
        let ball = smallest_ball(&points).unwrap();
        assert!((ball.centre_mm - Vector::new(5.0, 0.0, 0.0)).norm() < 1e-14);
        let mut support = ball.support;
        support.sort_unstable();
        assert_eq!(support, [0, 1]);
    }

    proptest! {
        /// Equation (44): all inside, and the centre a mean of errors on the surface.
        #[test]
        fn the_ball_is_proven(points in clouds()) {
            let ball = smallest_ball(&points).unwrap();
            for point in &points {
                prop_assert!((point - ball.centre_mm).norm() <= ball.radius_mm * (1.0 + 1e-12));
            }
            // Any step away from the centre moves away from some error of the support.
            for direction in [Vector::x(), Vector::y(), Vector::z(), Vector::repeat(1.0), Vector::new(1.0, -2.0, 0.5)] {
                for step in [1e-5, -1e-5] {
                    let moved = ball.centre_mm + direction * step;
                    let reach = ball.support.iter().map(|i| (points[*i] - moved).norm()).fold(0.0, f64::max);
                    prop_assert!(reach >= ball.radius_mm * (1.0 - 1e-9) - 1e-15, "{reach} {ball:?}");
                }
            }
        }
    }
}
