//! The three tangential methods with absolute cosines (Pimushkin 2023, appendices B to D).

use nalgebra::Matrix3;

use crate::engine::inside;
use crate::engines::BuildError;
use crate::engines::tangential::PUBLISHED_INTERVAL;
use crate::engines::traverses::Traverses;
use crate::{Command, Engine, EngineId, Solution, SolveError, Traverse, Vector, Volume};

/// Which of the three methods.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// `G` and `r01` of interval 1 everywhere.
    Static,
    /// `G` and `r01` of the interval the target falls in.
    Interval,
    /// Sum of the intervals before the target, then the map of its interval.
    QuasiDifferential,
}

/// A published tangential method.
#[derive(Clone, Debug)]
pub struct TangentialPublished {
    traverses: Traverses,
    method: Method,
}

impl TangentialPublished {
    /// From the traverses of X, Y, Z; their cosines are recomputed from the measured positions and lose
    /// their signs, as in the printed tables of the 240 and 315 mm cubes.
    ///
    /// # Errors
    /// [`BuildError`] where the traverses do not belong together.
    pub fn new(traverses: &[Traverse; 3], method: Method) -> Result<Self, BuildError> {
        Ok(Self { traverses: Traverses::new(traverses)?, method })
    }

    fn directions(&self, intervals: [usize; 3]) -> Matrix3<f64> {
        self.traverses.directions(intervals).abs()
    }

    /// `R` of the quasi-differential method: where the intervals before the target's lead, mm from the
    /// origin (printed as 120.150625141 135.105955968 105.106431456 for the target 130 140 106).
    #[must_use]
    pub fn path_sum_mm(&self, target_mm: &Vector) -> Vector {
        let mut sum = self.traverses.offset_mm(PUBLISHED_INTERVAL);
        for axis in 0..3 {
            let nodes = self.traverses.nodes_mm(axis);
            let start = self.traverses.interval(axis, self.traverses.origin_mm[axis]);
            for k in start..self.traverses.interval(axis, target_mm[axis]) {
                sum += self.traverses.direction(axis, k).abs() * (nodes[k + 1] - nodes[k]);
            }
        }
        sum
    }
}

impl Engine for TangentialPublished {
    fn id(&self) -> EngineId {
        match self.method {
            Method::Static => EngineId::TangentialStaticPublished,
            Method::Interval => EngineId::TangentialIntervalPublished,
            Method::QuasiDifferential => EngineId::TangentialQuasiDifferentialPublished,
        }
    }

    fn volume(&self) -> Volume {
        self.traverses.volume()
    }

    /// One matrix solution; `residual_mm` is what it leaves in the affine map that was solved.
    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        let target = &target.linear_mm;
        inside(target, &self.volume())?;
        let origin = self.traverses.origin_mm;
        let cell = [0, 1, 2].map(|i| self.traverses.interval(i, target[i]));
        let (intervals, base, offset) = match self.method {
            Method::Static => {
                ([PUBLISHED_INTERVAL; 3], Vector::zeros(), self.traverses.offset_mm(PUBLISHED_INTERVAL))
            }
            Method::Interval => (cell, Vector::zeros(), self.traverses.offset_mm(cell[0])),
            Method::QuasiDifferential => {
                let node = Vector::from_fn(|i, _| self.traverses.nodes_mm(i)[cell[i]]);
                (cell, node - origin, self.path_sum_mm(target))
            }
        };
        let directions = self.directions(intervals);
        let wanted = target - origin - offset;
        let within = directions.lu().solve(&wanted).ok_or(SolveError::Undefined(
            "the direction cosines of this cell do not span space",
            "направляющие косинусы этой ячейки лежат в одной плоскости",
        ))?;
        let residual_mm = (directions * within - wanted).norm();
        Ok(Solution { linear_mm: origin + base + within, iterations: 1, residual_mm })
    }
}
