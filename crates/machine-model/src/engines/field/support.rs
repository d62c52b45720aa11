//! Where scattered vectors support a field: their hull, seen from many sides.

use crate::{Range, Vector, Volume};

/// Steps of the search for the nearest place.
const ROUNDS: usize = 2000;
/// It ends where a round changes nothing by more, in halves of the box.
const SETTLED: f64 = 1e-13;
/// A place counts as inside up to so much of the box, for last bits.
const ROUNDING: f64 = 1e-9;

/// The box of the measured places, cut where no vector lies within half their mean spacing.
///
/// A convex polytope with faces square to every primitive direction of two steps (98 of them) in coordinates in which the
/// box is a cube: it holds the convex hull.
#[derive(Clone, Debug)]
pub(super) struct Support {
    pub(super) volume: Volume,
    middle_mm: Vector,
    half_mm: Vector,
    /// Unit normals and the distance of their faces from the middle, where they cut the box.
    faces: Vec<(Vector, f64)>,
}

impl Support {
    /// All of a box.
    pub(super) fn of_box(ranges: [Range; 3]) -> Self {
        let middle_mm = Vector::from_fn(|a, _| 0.5 * (ranges[a].low + ranges[a].high));
        let half_mm = Vector::from_fn(|a, _| 0.5 * (ranges[a].high - ranges[a].low));
        Self { volume: Volume(ranges), middle_mm, half_mm, faces: Vec::new() }
    }

    /// Around scattered places, which span all three axes.
    pub(super) fn around(places_mm: &[Vector]) -> Self {
        let range = |a: usize| Range {
            low: places_mm.iter().map(|place| place[a]).fold(f64::INFINITY, f64::min),
            high: places_mm.iter().map(|place| place[a]).fold(f64::NEG_INFINITY, f64::max),
        };
        let mut this = Self::of_box([range(0), range(1), range(2)]);
        let places: Vec<Vector> = places_mm.iter().map(|place| this.scaled(place)).collect();
        // The cube has a side of 2: half the mean spacing of n places is n^(-1/3).
        let margin = units::math::powf(places.len() as f64, -1.0 / 3.0);
        for normal in directions() {
            let farthest = places.iter().map(|place| place.dot(&normal)).fold(f64::NEG_INFINITY, f64::max);
            if farthest + margin < normal.abs().sum() {
                this.faces.push((normal, farthest + margin));
            }
        }
        this
    }

    /// True where the box is cut.
    pub(super) fn is_cut(&self) -> bool {
        !self.faces.is_empty()
    }

    fn scaled(&self, q_mm: &Vector) -> Vector {
        (q_mm - self.middle_mm).component_div(&self.half_mm)
    }

    /// True inside.
    pub(super) fn contains(&self, q_mm: &Vector) -> bool {
        self.volume.contains(q_mm) && (self.faces.is_empty() || self.lies_before_faces(&self.scaled(q_mm)))
    }

    fn lies_before_faces(&self, scaled: &Vector) -> bool {
        self.faces.iter().all(|(normal, distance)| scaled.dot(normal) <= distance + ROUNDING)
    }

    /// True where all of a box lies inside, but for rounding.
    pub(super) fn holds(&self, ranges: &[Range; 3], rounding_mm: f64) -> bool {
        let in_box = (0..3).all(|a| {
            let known = self.volume.0[a];
            known.low - rounding_mm <= ranges[a].low && ranges[a].high <= known.high + rounding_mm
        });
        let corner =
            |k: usize| Vector::from_fn(|a, _| if k >> a & 1 == 0 { ranges[a].low } else { ranges[a].high });
        in_box && (self.faces.is_empty() || (0..8).all(|k| self.lies_before_faces(&self.scaled(&corner(k)))))
    }

    /// The nearest place inside, in the coordinates of the cube: Dykstra's projections (Boyle and Dykstra 1986).
    pub(super) fn nearest(&self, q_mm: &Vector) -> Vector {
        let boxed = self.volume.nearest(q_mm);
        if self.faces.is_empty() || self.contains(&boxed) {
            return boxed;
        }
        let mut place = self.scaled(q_mm);
        let mut of_faces = vec![Vector::zeros(); self.faces.len()];
        let mut of_box = Vector::zeros();
        for _ in 0..ROUNDS {
            let mut changed = 0.0;
            for ((normal, distance), increment) in self.faces.iter().zip(&mut of_faces) {
                let from = place + *increment;
                let beyond = (from.dot(normal) - distance).max(0.0);
                place = from - normal * beyond;
                changed += (from - place - *increment).norm();
                *increment = from - place;
            }
            let from = place + of_box;
            place = from.map(|v| v.clamp(-1.0, 1.0));
            changed += (from - place - of_box).norm();
            of_box = from - place;
            if changed < SETTLED {
                break;
            }
        }
        self.volume.nearest(&(self.middle_mm + place.component_mul(&self.half_mm)))
    }
}

/// Unit vectors along all whole steps of at most two along each axis, those of the axes left out: the box has them.
fn directions() -> impl Iterator<Item = Vector> {
    const STEPS: [i32; 5] = [-2, -1, 0, 1, 2];
    let all = STEPS.into_iter().flat_map(|x| STEPS.into_iter().flat_map(move |y| STEPS.map(|z| [x, y, z])));
    all.filter(|steps| {
        let axes = steps.iter().filter(|step| **step != 0).count();
        // (2, 2, 0) is (1, 1, 0).
        axes > 1 && steps.iter().any(|step| step % 2 != 0)
    })
    .map(|steps| Vector::from(steps.map(f64::from)).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ball_of_places_has_no_corners() {
        let mut places = Vec::new();
        for i in -10..=10 {
            for j in -10..=10 {
                for k in -10..=10 {
                    let place = Vector::new(f64::from(i), f64::from(j), f64::from(k)) * 10.0;
                    if place.norm() <= 100.0 {
                        places.push(place);
                    }
                }
            }
        }
        let ball = Support::around(&places);
        assert_eq!(directions().count(), 98 - 6);
        assert!(ball.is_cut());
        assert!(places.iter().all(|place| ball.contains(place)));
        assert!(!ball.contains(&Vector::repeat(90.0)) && !ball.contains(&Vector::new(90.0, 90.0, 0.0)));
        let near = ball.nearest(&Vector::repeat(90.0));
        assert!((near - Vector::repeat(near.x)).norm() < 1e-4, "{near}");
        assert!((near.norm() - 100.0).abs() < 10.0, "{near}");
        // What lies inside stays, and a complete lattice is its box.
        assert_eq!(ball.nearest(&Vector::new(1.0, 2.0, 3.0)), Vector::new(1.0, 2.0, 3.0));
        assert!(ball.holds(&[Range { low: -50.0, high: 50.0 }; 3], 0.0));
        assert!(!ball.holds(&[Range { low: -80.0, high: 80.0 }; 3], 0.0));
        let corners: Vec<Vector> =
            (0..8).map(|k| Vector::from_fn(|a, _| f64::from(k >> a & 1) * 7.0)).collect();
        assert!(!Support::around(&corners).is_cut());
    }
}
