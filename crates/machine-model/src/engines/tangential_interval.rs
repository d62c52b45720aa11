//! `tangential-interval` (Pimushkin 2023, chapter 2): in every cell its own affine map, `p = r01 + G q`.
//!
//! `r01` comes from the X interval, `G` from the three intervals of the cell. Neighbouring maps do not
//! agree on the face between them: the model *jumps* there ([`TangentialInterval::jump_mm`]), because the
//! direction of one interval is extrapolated back to the origin. So a path cannot be corrected across a
//! face, and between two cells whose maps move apart there are points that no command reaches.

use nalgebra::Matrix3;

use super::build_error::BuildError;
use super::traverses::Traverses;
use crate::engine::inside;
use crate::{Command, Engine, EngineId, Move, PathModel, Solution, SolveError, Traverse, Vector, Volume};

/// The interval method with signed cosines.
#[derive(Clone, Debug)]
pub struct TangentialInterval {
    traverses: Traverses,
}

impl TangentialInterval {
    /// From the traverses of X, Y, Z.
    ///
    /// # Errors
    /// [`BuildError`] where the traverses do not belong together.
    pub fn new(traverses: &[Traverse; 3]) -> Result<Self, BuildError> {
        Ok(Self { traverses: Traverses::new(traverses)? })
    }

    /// The map of one cell: `p = origin + offset + G (q - origin)`.
    fn map(&self, cell: [usize; 3]) -> (Vector, Matrix3<f64>) {
        (self.traverses.offset_mm(cell[0]), self.traverses.directions(cell))
    }

    fn cell(&self, q: &Vector) -> [usize; 3] {
        [0, 1, 2].map(|i| self.traverses.interval(i, q[i]))
    }

    /// How far the tip jumps, mm, where `axis` passes its inner node `node` (1 to the last but one).
    ///
    /// It does not depend on where the other axes stand.
    #[must_use]
    pub fn jump_mm(&self, axis: usize, node: usize) -> f64 {
        let at = self.traverses.nodes_mm(axis)[node] - self.traverses.origin_mm[axis];
        let side = |k: usize| {
            let line = self.traverses.direction(axis, k) * at;
            if axis == 0 { line + self.traverses.offset_mm(k) } else { line }
        };
        (side(node) - side(node - 1)).norm()
    }

    /// The largest jump between two cells, mm, with its axis (0 X, 1 Y, 2 Z) and the command there, mm.
    #[must_use]
    pub fn largest_jump(&self) -> (f64, usize, f64) {
        let mut largest = (0.0, 0, self.traverses.nodes_mm(0)[0]);
        for axis in 0..3 {
            let nodes = self.traverses.nodes_mm(axis);
            for (node, &q) in nodes.iter().enumerate().take(nodes.len() - 1).skip(1) {
                let jump = self.jump_mm(axis, node);
                if jump > largest.0 {
                    largest = (jump, axis, q);
                }
            }
        }
        largest
    }
}

impl Engine for TangentialInterval {
    fn id(&self) -> EngineId {
        EngineId::TangentialInterval
    }

    fn volume(&self) -> Volume {
        self.traverses.volume()
    }

    /// Solves in the cell of the target, then in its neighbours: the command must lie in the cell whose
    /// map was used, else predicting it would give another point.
    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        let target = &target.linear_mm;
        let volume = self.volume();
        inside(target, &volume)?;
        let home = self.cell(target);
        let origin = &self.traverses.origin_mm;
        let mut outside = None;
        for (tried, step) in neighbours().enumerate() {
            let Some(cell) = shifted(home, step, |i| self.traverses.nodes_mm(i).len() - 1) else { continue };
            let (offset, directions) = self.map(cell);
            let Some(q) = directions.lu().solve(&(target - origin - offset)).map(|q| q + origin) else {
                continue;
            };
            if let Err(reason) = inside(&q, &volume) {
                outside = outside.or(Some(reason));
            } else if self.cell(&q) == cell {
                let residual_mm = (origin + offset + directions * (q - origin) - target).norm();
                return Ok(Solution { linear_mm: q, iterations: tried as u32 + 1, residual_mm });
            }
        }
        Err(outside.unwrap_or(SolveError::Undefined(
            "the target lies where the maps of two cells move apart: no command of tangential-interval reaches it; \
             use `--engine tangential-quasi-differential` or `--engine tracker`, which are continuous",
            "цель лежит там, где отображения двух ячеек расходятся: до неё не доводит ни одна команда tangential-interval; \
             возьмите `--engine tangential-quasi-differential` или `--engine tracker`, они непрерывны",
        )))
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for TangentialInterval {
    fn error_mm(&self, command: &Command) -> Vector {
        let q = self.volume().nearest(&command.linear_mm);
        let (offset, directions) = self.map(self.cell(&q));
        let from_origin = q - self.traverses.origin_mm;
        offset + directions * from_origin - from_origin
    }

    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        let volume = self.volume();
        let mut acceleration = Vector::zeros();
        for i in 0..3 {
            let range = stretch.range_mm[i];
            let cell = self.traverses.interval(i, range.low);
            let inner = cell + 2 < self.traverses.nodes_mm(i).len();
            // The upper node belongs to the next cell, with its map; the last node to the last cell.
            let leaves_cell = inner && range.high >= self.traverses.nodes_mm(i)[cell + 1];
            if leaves_cell || !volume.0[i].contains(range.low) || !volume.0[i].contains(range.high) {
                return f64::INFINITY;
            }
            acceleration[i] = stretch.acceleration_mm[i];
        }
        let cell = [0, 1, 2].map(|i| self.traverses.interval(i, stretch.range_mm[i].low));
        (self.traverses.directions(cell) - Matrix3::identity()).norm() * acceleration.norm() / 8.0
    }
}

/// Steps to a cell and its neighbours, the cell itself first.
fn neighbours() -> impl Iterator<Item = [isize; 3]> {
    const STEPS: [isize; 3] = [0, -1, 1];
    STEPS.into_iter().flat_map(|x| STEPS.into_iter().flat_map(move |y| STEPS.map(|z| [x, y, z])))
}

/// The cell one step further; `None` beyond the edge.
fn shifted(cell: [usize; 3], step: [isize; 3], cells: impl Fn(usize) -> usize) -> Option<[usize; 3]> {
    let mut to = cell;
    for i in 0..3 {
        to[i] = cell[i].checked_add_signed(step[i]).filter(|&k| k < cells(i))?;
    }
    Some(to)
}
