//! `tracker`: positions add, `p(q) = Σ_i P_i(q_i)`: equation (15) of `docs/equations.md`.
//!
//! `P_i` is the measured traverse of axis i relative to the common origin, with its signs, interpolated
//! between the nodes. The order of motion does not matter. What one axis does to the lines of another
//! (its angles) is not in three traverses and not in this engine; the tool vector adds without being
//! turned.

use super::build_error::BuildError;
use super::separable::Separable;
use super::traverses::Traverses;
use crate::{
    Command, Engine, EngineId, Interpolation, Move, PathModel, Solution, SolveError, Traverse, Vector, Volume,
};

/// A separable model made of three axis traverses.
#[derive(Clone, Debug)]
pub struct Tracker(pub(super) Separable);

impl Tracker {
    /// From the traverses of X, Y, Z.
    ///
    /// The interpolation is that of measured minus commanded, so that a shape-preserving curve cannot
    /// overshoot the *error*.
    ///
    /// # Errors
    /// [`BuildError`] where the traverses do not belong together or are no tables.
    pub fn new(traverses: &[Traverse; 3], interpolation: Interpolation) -> Result<Self, BuildError> {
        let traverses = Traverses::new(traverses)?;
        let [x, y, z] = [0, 1, 2].map(|i| traverses.error_tables(i, interpolation));
        Ok(Self(Separable { offset_mm: Vector::zeros(), curves: [x?, y?, z?] }))
    }
}

impl Engine for Tracker {
    fn id(&self) -> EngineId {
        EngineId::Tracker
    }
    fn volume(&self) -> Volume {
        self.0.volume()
    }
    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        self.0.solve(&target.linear_mm)
    }
    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for Tracker {
    fn error_mm(&self, command: &Command) -> Vector {
        self.0.error_mm(&command.linear_mm)
    }
    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        self.0.chord_bound_mm(stretch)
    }
}
