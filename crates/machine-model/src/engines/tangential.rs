//! `tangential-static` and `tangential-quasi-differential` (Pimushkin 2023, chapter 2) as models.
//!
//! Both are written in the command and with signed cosines, so that forward and inverse belong together:
//!
//! * static: `p(q) = r01 + G q`, one interval for the whole volume;
//! * quasi-differential: `p(q) = r01 + Σ_i ∫ c_i(u) du`, the unit tangent of the interval that holds the
//!   *command* integrated along each axis. (The publication takes the interval of the target; the two
//!   differ only within the error's distance of a node.)
//!
//! Equation (17) of `docs/equations.md`. Both are sums over the axes, so [`Separable`] carries them. A unit tangent knows nothing of scale: a
//! step that is 0.1 % too long has the same cosines as one that is right.

use super::build_error::BuildError;
use super::separable::Separable;
use super::traverses::Traverses;
use crate::{
    Command, Engine, EngineId, Interpolation, Move, PathModel, Solution, SolveError, Table, Traverse, Vector,
    Volume,
};

/// The interval of the published runs: from node 1 to node 2 (15 to 30 mm in the 315 mm cube).
pub const PUBLISHED_INTERVAL: usize = 1;

/// A tangential method that is continuous over the whole volume.
#[derive(Clone, Debug)]
pub struct Tangential {
    id: EngineId,
    model: Separable,
}

impl Tangential {
    /// The static method with the cosines of one interval.
    ///
    /// # Errors
    /// [`BuildError`] where the traverses do not belong together or do not have that interval.
    pub fn fixed(traverses: &[Traverse; 3], interval: usize) -> Result<Self, BuildError> {
        Self::new(traverses, EngineId::TangentialStatic, interval, |_| interval)
    }

    /// The quasi-differential method; `r01` from `interval` of the X traverse.
    ///
    /// # Errors
    /// As [`Self::fixed`].
    pub fn quasi_differential(traverses: &[Traverse; 3], interval: usize) -> Result<Self, BuildError> {
        Self::new(traverses, EngineId::TangentialQuasiDifferential, interval, |k| k)
    }

    /// `interval_of(k)`: whose cosines hold in interval k.
    fn new(
        traverses: &[Traverse; 3],
        id: EngineId,
        offset_interval: usize,
        interval_of: impl Fn(usize) -> usize,
    ) -> Result<Self, BuildError> {
        let traverses = Traverses::new(traverses)?;
        for (i, axis) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            let found = traverses.nodes_mm(i).len();
            if found < offset_interval + 2 {
                return Err(BuildError::TraverseTooShort { axis, found, needed: offset_interval + 2 });
            }
        }
        let mut curves = Vec::with_capacity(3);
        for axis in 0..3 {
            curves.push(tangent_integrals(&traverses, axis, &interval_of)?);
        }
        let curves = curves.try_into().expect("three axes");
        Ok(Self { id, model: Separable { offset_mm: traverses.offset_mm(offset_interval), curves } })
    }
}

/// `∫ (c_i(u) - e_i) du` from the origin to every node of axis i, as tables.
fn tangent_integrals(
    traverses: &Traverses,
    axis: usize,
    interval_of: impl Fn(usize) -> usize,
) -> Result<[Table; 3], BuildError> {
    let nodes = traverses.nodes_mm(axis);
    let mut unit = Vector::zeros();
    unit[axis] = 1.0;
    let mut sums = vec![Vector::zeros()];
    for k in 0..nodes.len() - 1 {
        let step = (traverses.direction(axis, interval_of(k)) - unit) * (nodes[k + 1] - nodes[k]);
        sums.push(sums[k] + step);
    }
    let mut tables = Vec::with_capacity(3);
    for c in 0..3 {
        let values: Vec<f64> = sums.iter().map(|sum| sum[c]).collect();
        let table =
            |values| Table::new(nodes.to_vec(), values, Interpolation::Linear).map_err(BuildError::Table);
        let at_origin = table(values.clone())?.value(traverses.origin_mm[axis]);
        tables.push(table(values.iter().map(|v| v - at_origin).collect())?);
    }
    Ok(tables.try_into().expect("three components"))
}

impl Engine for Tangential {
    fn id(&self) -> EngineId {
        self.id
    }
    fn volume(&self) -> Volume {
        self.model.volume()
    }
    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        self.model.solve(&target.linear_mm)
    }
    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for Tangential {
    fn error_mm(&self, command: &Command) -> Vector {
        self.model.error_mm(&command.linear_mm)
    }
    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        self.model.chord_bound_mm(stretch)
    }
}
