//! The errors at the nodes of a grid.

use machine_model::Vector;

use crate::{Block, Grid, Statistics};

/// A grid and the volumetric error at each of its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorMap {
    grid: Grid,
    errors_mm: Vec<Vector>,
}

impl ErrorMap {
    /// From a grid and as many errors, mm, in the grid's order.
    ///
    /// # Panics
    /// Where there is not one error for each node.
    #[must_use]
    pub fn new(grid: Grid, errors_mm: Vec<Vector>) -> Self {
        assert_eq!(grid.len(), errors_mm.len(), "one error for each node");
        Self { grid, errors_mm }
    }

    /// Where the errors are.
    #[must_use]
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The errors, mm, in the grid's order.
    #[must_use]
    pub fn errors_mm(&self) -> &[Vector] {
        &self.errors_mm
    }

    /// The errors of a part of the map, mm.
    #[must_use]
    pub fn errors_of(&self, block: &Block) -> Vec<Vector> {
        block.indices(&self.grid).map(|index| self.errors_mm[index]).collect()
    }

    /// Figures of a part of the map; `None` where it has no nodes.
    #[must_use]
    pub fn statistics(&self, block: &Block, tolerance_mm: f64) -> Option<Statistics> {
        Statistics::of(&self.errors_of(block), tolerance_mm)
    }
}
