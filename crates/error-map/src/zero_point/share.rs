//! The shift that brings most errors within a tolerance.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use machine_model::Vector;

use super::{geometric_median, smallest_ball};

/// The best shift found for the number of nodes within tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestShare {
    /// The shift, mm.
    pub shift_mm: Vector,
    /// Errors with `|d - s|` within the tolerance.
    pub within: usize,
    /// No shift at all brings more within it.
    pub at_most: usize,
}

/// Distances that one search may compute: some tenths of a second.
const MOST_DISTANCES: u64 = 60_000_000;

/// A cube of shifts.
struct Cube {
    centre: Vector,
    half: f64,
    /// Errors within tolerance of every shift in it.
    sure: u32,
    /// Errors within tolerance of some shift in it, perhaps.
    open: Vec<u32>,
    /// Sequence number: equal cubes are taken in the order they were made.
    number: u64,
}

impl Cube {
    fn at_most(&self) -> usize {
        self.sure as usize + self.open.len()
    }
}

impl PartialEq for Cube {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Cube {}
impl PartialOrd for Cube {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Cube {
    fn cmp(&self, other: &Self) -> Ordering {
        self.at_most().cmp(&other.at_most()).then(other.number.cmp(&self.number))
    }
}

/// The shift that brings most errors within a tolerance; `None` of none.
///
/// Branch and bound over cubes of shifts: at a centre `c` with half diagonal `h` an error is within
/// tolerance of every shift in the cube where `|d - c| ≤ τ - h`, and of none where `|d - c| > τ + h`.
/// Cubes that cannot beat the best are dropped, the most promising is cut in eight. The number of
/// distances is limited, so what remains open is told: `at_most` is proven, and equal to `within`
/// where the search came to its end.
///
/// * `tolerance_mm` – τ, above zero
#[must_use]
pub fn best_share(errors_mm: &[Vector], tolerance_mm: f64) -> Option<BestShare> {
    best_share_within(errors_mm, tolerance_mm, MOST_DISTANCES)
}

fn best_share_within(errors_mm: &[Vector], tolerance_mm: f64, most_distances: u64) -> Option<BestShare> {
    let count = |s: &Vector| errors_mm.iter().filter(|d| (**d - s).norm() <= tolerance_mm).count();
    let ball = smallest_ball(errors_mm)?;
    let mut best = BestShare { shift_mm: ball.centre_mm, within: count(&ball.centre_mm), at_most: 0 };
    let median = geometric_median(errors_mm)?.shift_mm;
    for start in [median, Vector::zeros()] {
        improve(errors_mm, tolerance_mm, start, &mut best);
    }
    let low = errors_mm.iter().fold(Vector::repeat(f64::INFINITY), |low, d| low.inf(d));
    let high = errors_mm.iter().fold(Vector::repeat(f64::NEG_INFINITY), |high, d| high.sup(d));
    let mut heap = BinaryHeap::new();
    heap.push(Cube {
        centre: 0.5 * (low + high),
        half: (0.5 * (high - low).amax()).max(f64::MIN_POSITIVE),
        sure: 0,
        open: (0..errors_mm.len() as u32).collect(),
        number: 0,
    });
    let (mut number, mut distances) = (0, 0);
    // Cubes this small are where rounding decides; what is open in them stays open.
    let smallest = tolerance_mm * 1e-9;
    while let Some(cube) = heap.pop() {
        if cube.at_most() <= best.within {
            break;
        }
        if distances >= most_distances || cube.half < smallest {
            return Some(BestShare { at_most: cube.at_most(), ..best });
        }
        let half = 0.5 * cube.half;
        let diagonal = half * 3.0f64.sqrt() * (1.0 + 1e-12);
        for corner in 0..8u32 {
            let sign = |axis: usize| if corner >> axis & 1 == 1 { half } else { -half };
            let centre = cube.centre + Vector::from_fn(|axis, _| sign(axis));
            let (mut sure, mut here) = (cube.sure, cube.sure as usize);
            let mut open = Vec::new();
            for index in &cube.open {
                let r = (errors_mm[*index as usize] - centre).norm();
                here += usize::from(r <= tolerance_mm);
                if r <= tolerance_mm - diagonal {
                    sure += 1;
                } else if r <= tolerance_mm + diagonal {
                    open.push(*index);
                }
            }
            distances += cube.open.len() as u64;
            if here > best.within {
                improve(errors_mm, tolerance_mm, centre, &mut best);
            }
            number += 1;
            let part = Cube { centre, half, sure, open, number };
            if part.at_most() > best.within {
                heap.push(part);
            }
        }
    }
    Some(BestShare { at_most: best.within, ..best })
}

/// From a shift to the centre of the smallest ball around what it brings within tolerance, as long as
/// that brings more: never less, since that ball fits into the tolerance.
fn improve(errors_mm: &[Vector], tolerance_mm: f64, from: Vector, best: &mut BestShare) {
    let mut shift = from;
    loop {
        let inside: Vec<Vector> =
            errors_mm.iter().filter(|d| (**d - shift).norm() <= tolerance_mm).copied().collect();
        if inside.len() <= best.within {
            return;
        }
        *best = BestShare { shift_mm: shift, within: inside.len(), ..*best };
        match smallest_ball(&inside) {
            Some(ball) if ball.radius_mm <= tolerance_mm => shift = ball.centre_mm,
            _ => return,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::zero_point::tests::clouds;
    use proptest::prelude::*;

    /// Every best ball can be moved until two or three errors lie on its surface, or one.
    fn exhaustive(points: &[Vector], tolerance: f64) -> usize {
        let n = points.len();
        let slack = 1e-9 * tolerance;
        let count = |s: &Vector| points.iter().filter(|d| (**d - s).norm() <= tolerance + slack).count();
        let mut best = points.iter().map(count).max().unwrap();
        for i in 0..n {
            for j in 0..i {
                let middle = 0.5 * (points[i] + points[j]);
                best = best.max(count(&middle));
                for k in 0..j {
                    let (a, b) = (points[j] - points[i], points[k] - points[i]);
                    let normal = a.cross(&b);
                    let square = normal.norm_squared();
                    if square < 1e-30 {
                        continue;
                    }
                    let centre = points[i]
                        + (a.norm_squared() * b.cross(&normal) + b.norm_squared() * normal.cross(&a))
                            / (2.0 * square);
                    let rest = tolerance * tolerance - (centre - points[i]).norm_squared();
                    if rest >= 0.0 {
                        let up = normal * (rest / square).sqrt();
                        best = best.max(count(&(centre + up))).max(count(&(centre - up)));
                    }
                }
            }
        }
        best
    }

    proptest! {
        #[test]
        fn no_ball_through_errors_holds_more(points in clouds(), tolerance in 1e-3..2e-2f64) {
            let found = best_share(&points, tolerance).unwrap();
            let within = points.iter().filter(|d| (**d - found.shift_mm).norm() <= tolerance).count();
            prop_assert_eq!(found.within, within);
            prop_assert!(found.within <= found.at_most);
            // Where errors stand on the surface to the last bit, the proof stays open by those.
            prop_assert!(exhaustive(&points, tolerance) <= found.at_most, "{found:?}");
            prop_assert!(exhaustive(&points, tolerance * (1.0 - 1e-6)) <= found.within, "{found:?}");
        }
    }

    #[test]
    fn a_search_cut_short_still_proves_its_bound() {
        let points: Vec<Vector> = (0..4000)
            .map(|i| Vector::new(f64::from(i % 20), f64::from(i / 20 % 20), f64::from(i / 400)))
            .collect();
        let short = best_share_within(&points, 3.0, 10_000).unwrap();
        let long = best_share(&points, 3.0).unwrap();
        assert!(short.within <= long.within && long.at_most <= short.at_most);
        // Lattice points in a ball of radius 3: 123 around a lattice point, the known count.
        assert!(long.within >= 123, "{long:?}");
    }
}
