//! `kmtpp`: the premise of Pimushkin 2023, chapter 4, made consistent: equation (18) of `docs/equations.md`.
//!
//! All axis directions turn with the total rotation `E(q)` of the point:
//!
//! ```text
//! p(Q) = origin + r01 + ∫ F(E(q)) L dq  +  (EXX(x), EYY(y), EZZ(z)),   straight from the origin to Q
//! ```
//!
//! `E` is the sum of the nine angular errors, tables interpolated linearly; `F(E)` the rotation with the
//! vector `E = 2 tan(φ/2)·e`; the columns of `L` are the unit vectors of the tracker traverses (interval
//! 1, signed); `r01` the offset of the X traverse. The straightness of the tables is not added: it is
//! the integral of the rotations already. The rotation field is not integrable, so `p` depends on the
//! path; [`Kmtpp::path_dependence`] says by how much. The premise knows no lever arm: the tool vector
//! adds without being turned. Where that matters, `rigid-body` is the engine.

use nalgebra::Matrix3;
use smallvec::SmallVec;

use super::kmtpp_bound::KinkMoments;
use crate::finite_rotations::rodrigues_displacement;
use crate::{Command, Engine, EngineId, PathModel, Range, Solution, SolveError, Table, Vector, Volume};

/// The consistent form of the KMTPP method.
#[derive(Clone, Debug)]
pub struct Kmtpp {
    /// `angles[i][c]`: rotation about axis c (A, B, C) as axis i moves, rad; piecewise linear.
    pub(super) angles: [[Table; 3]; 3],
    /// EXX, EYY, EZZ, mm.
    pub(super) positioning: [Table; 3],
    /// Columns: unit vectors of the axes at the origin.
    pub(super) directions: Matrix3<f64>,
    /// Offset of the X traverse, mm.
    offset_mm: Vector,
    /// Where the line integral starts, mm.
    pub(super) origin_mm: Vector,
    pub(super) volume: Volume,
    pub(super) kinks: [KinkMoments; 3],
}

/// Where the same command leads along three paths, and how far apart that is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathDependence {
    /// All axes together, on the straight line: the engine's answer.
    pub straight_mm: Vector,
    /// X, then Y, then Z.
    pub xyz_mm: Vector,
    /// Z, then Y, then X.
    pub zyx_mm: Vector,
    /// Largest distance between two of them: the method's own uncertainty here, mm.
    pub largest_mm: f64,
}

impl Kmtpp {
    /// * `angles` – `angles[i][c]`, rad, of axis i about A, B, C; piecewise linear tables
    /// * `positioning` – EXX, EYY, EZZ, mm
    /// * `directions` – unit vectors of the axes, as columns
    /// * `offset_mm` – r01
    /// * `origin_mm` – command from which the traverses started
    ///
    /// `None` where the directions do not span space.
    #[must_use]
    pub fn new(
        angles: [[Table; 3]; 3],
        positioning: [Table; 3],
        directions: Matrix3<f64>,
        offset_mm: Vector,
        origin_mm: Vector,
    ) -> Option<Self> {
        directions.try_inverse()?;
        let volume = Volume([0, 1, 2].map(|i| {
            let all = angles[i].iter().chain([&positioning[i]]).map(Table::range);
            all.fold(Range { low: f64::NEG_INFINITY, high: f64::INFINITY }, |a, b| Range {
                low: a.low.max(b.low),
                high: a.high.min(b.high),
            })
        }));
        let kinks = [0, 1, 2].map(|i| KinkMoments::new(&angles[i], origin_mm[i]));
        Some(Self { angles, positioning, directions, offset_mm, origin_mm, volume, kinks })
    }

    /// Sum of the nine angular errors as three components, rad.
    pub(super) fn rotation(&self, q: &Vector) -> Vector {
        let mut sum = Vector::zeros();
        for (i, tables) in self.angles.iter().enumerate() {
            sum += Vector::from_fn(|c, _| tables[c].value(q[i]));
        }
        sum
    }

    /// `∫ (F(E(q)) L - 1) dq` on the straight line between two commands, mm.
    ///
    /// Between the nodes of all tables `E` is linear in the path parameter, so that the integrand is
    /// analytic there: Gauss's three points per piece leave `O(|E|⁶)`, far below 1e-12 mm for any
    /// machine (tested against halved pieces).
    fn leg_mm(&self, from: &Vector, to: &Vector) -> Vector {
        const POINTS: [(f64, f64); 3] =
            [(0.112_701_665_379_258_3, 5.0 / 18.0), (0.5, 8.0 / 18.0), (0.887_298_334_620_741_7, 5.0 / 18.0)];
        let along = to - from;
        let turned = self.directions * along;
        let mut sum = turned - along;
        let places = self.break_points(from, &along);
        for piece in places.windows(2) {
            let width = piece[1] - piece[0];
            for (at, weight) in POINTS {
                let rotation = self.rotation(&(from + along * (piece[0] + at * width)));
                sum += rodrigues_displacement(&rotation, &turned) * (weight * width);
            }
        }
        sum
    }

    /// Where on the line some table has a node, from 0 to 1, in order.
    fn break_points(&self, from: &Vector, along: &Vector) -> SmallVec<[f64; 96]> {
        let mut places = SmallVec::new();
        places.push(0.0);
        for (i, tables) in self.angles.iter().enumerate() {
            if along[i] == 0.0 {
                continue;
            }
            for (c, table) in tables.iter().enumerate() {
                if tables[..c].iter().any(|other| other.nodes() == table.nodes()) {
                    continue;
                }
                let t = table.nodes().iter().map(|node| (node - from[i]) / along[i]);
                places.extend(t.filter(|t| 0.0 < *t && *t < 1.0));
            }
        }
        places.push(1.0);
        places.sort_unstable_by(f64::total_cmp);
        places
    }

    fn positioning_mm(&self, q: &Vector) -> Vector {
        Vector::from_fn(|i, _| self.positioning[i].value(q[i]))
    }

    /// Error at a command inside the volume, mm.
    fn error_inside_mm(&self, q: &Vector) -> Vector {
        self.offset_mm + self.leg_mm(&self.origin_mm, q) + self.positioning_mm(q)
    }

    /// How much the answer depends on the order of motion, at a command (taken to the nearest point of
    /// the volume).
    #[must_use]
    pub fn path_dependence(&self, command_mm: &Vector) -> PathDependence {
        let q = self.volume.nearest(command_mm);
        let fixed = q + self.offset_mm + self.positioning_mm(&q);
        let by = |order: [usize; 3]| {
            let mut at = self.origin_mm;
            order.iter().fold(fixed, |sum, &axis| {
                let mut next = at;
                next[axis] = q[axis];
                let leg = self.leg_mm(&at, &next);
                at = next;
                sum + leg
            })
        };
        let straight_mm = fixed + self.leg_mm(&self.origin_mm, &q);
        let (xyz_mm, zyx_mm) = (by([0, 1, 2]), by([2, 1, 0]));
        let largest_mm =
            (straight_mm - xyz_mm).norm().max((straight_mm - zyx_mm).norm()).max((xyz_mm - zyx_mm).norm());
        PathDependence { straight_mm, xyz_mm, zyx_mm, largest_mm }
    }
}

impl Engine for Kmtpp {
    fn id(&self) -> EngineId {
        EngineId::Kmtpp
    }

    fn volume(&self) -> Volume {
        self.volume
    }

    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        crate::solve(&target.linear_mm, &self.volume, |q| self.error_inside_mm(q))
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for Kmtpp {
    fn error_mm(&self, command: &Command) -> Vector {
        self.error_inside_mm(&self.volume.nearest(&command.linear_mm))
    }

    fn chord_bound_mm(&self, stretch: &crate::Move) -> f64 {
        self.bound_mm(stretch)
    }
}
