//! Three axis traverses as the tangential methods read them: equation (16) of `docs/equations.md`.

use nalgebra::Matrix3;

use super::build_error::BuildError;
use crate::{Interpolation, Range, Table, Traverse, Vector, Volume};

/// Traverses of X, Y and Z, counted from their common origin.
#[derive(Clone, Debug)]
pub(crate) struct Traverses {
    axes: [Traverse; 3],
    /// Command at which the three lines meet, mm.
    pub(crate) origin_mm: Vector,
}

impl Traverses {
    /// Checks that the three belong together: one per axis, one common origin inside all of them.
    pub(crate) fn new(axes: &[Traverse; 3]) -> Result<Self, BuildError> {
        for (i, (traverse, name)) in axes.iter().zip(['X', 'Y', 'Z']).enumerate() {
            if traverse.axis != i || traverse.measured_mm.len() != traverse.nodes_mm.len() {
                return Err(BuildError::TraverseOfOtherAxis { axis: name });
            }
            let needed = 3;
            if traverse.nodes_mm.len() < needed {
                return Err(BuildError::TraverseTooShort {
                    axis: name,
                    found: traverse.nodes_mm.len(),
                    needed,
                });
            }
        }
        let mut origin_mm = Vector::zeros();
        for (i, name) in ['X', 'Y', 'Z'].into_iter().enumerate() {
            let [a, b] = [(i + 1) % 3, (i + 2) % 3].map(|other| axes[other].start_mm[i]);
            let nodes = &axes[i].nodes_mm;
            if a != b || !(nodes[0]..=nodes[nodes.len() - 1]).contains(&a) {
                return Err(BuildError::NoCommonOrigin { axis: name, first_mm: a, second_mm: b });
            }
            origin_mm[i] = a;
        }
        let mut this = Self { axes: axes.clone(), origin_mm };
        // Each traverse counts from where it passes the common origin, whatever the tracker's zero was.
        for axis in 0..3 {
            let k = this.interval(axis, origin_mm[axis]);
            let nodes = this.nodes_mm(axis);
            let part = (origin_mm[axis] - nodes[k]) / (nodes[k + 1] - nodes[k]);
            let (low, high) = (this.measured_mm(axis, k), this.measured_mm(axis, k + 1));
            let zero = low + (high - low) * part;
            for measured in &mut this.axes[axis].measured_mm {
                *measured = (Vector::from(*measured) - zero).into();
            }
        }
        Ok(this)
    }

    /// Commands at the nodes of one axis, mm.
    pub(crate) fn nodes_mm(&self, axis: usize) -> &[f64] {
        &self.axes[axis].nodes_mm
    }

    /// The box of commands the traverses cover.
    pub(crate) fn volume(&self) -> Volume {
        Volume([0, 1, 2].map(|i| {
            let nodes = self.nodes_mm(i);
            Range { low: nodes[0], high: nodes[nodes.len() - 1] }
        }))
    }

    /// Measured position at a node, relative to the common origin, mm.
    fn measured_mm(&self, axis: usize, node: usize) -> Vector {
        Vector::from(self.axes[axis].measured_mm[node])
    }

    /// Measured minus commanded position along one axis, relative to the common origin, as tables of the
    /// command.
    pub(crate) fn error_tables(
        &self,
        axis: usize,
        interpolation: Interpolation,
    ) -> Result<[Table; 3], BuildError> {
        let nodes = self.nodes_mm(axis);
        let mut tables = Vec::with_capacity(3);
        for c in 0..3 {
            let values = |shift: f64| {
                let value = |(k, &q): (usize, &f64)| {
                    let along = if c == axis { q - self.origin_mm[axis] } else { 0.0 };
                    self.axes[axis].measured_mm[k][c] - along - shift
                };
                nodes.iter().enumerate().map(value).collect::<Vec<f64>>()
            };
            let table = |shift| Table::new(nodes.to_vec(), values(shift), interpolation);
            let at_origin = table(0.0).map_err(BuildError::Table)?.value(self.origin_mm[axis]);
            tables.push(table(at_origin).map_err(BuildError::Table)?);
        }
        Ok(tables.try_into().expect("three components"))
    }

    /// Unit vector of interval `k` of one axis, from node k to node k+1, with its signs.
    pub(crate) fn direction(&self, axis: usize, k: usize) -> Vector {
        (self.measured_mm(axis, k + 1) - self.measured_mm(axis, k)).normalize()
    }

    /// `G`: the directions of one interval per axis as columns.
    pub(crate) fn directions(&self, intervals: [usize; 3]) -> Matrix3<f64> {
        Matrix3::from_columns(&[0, 1, 2].map(|i| self.direction(i, intervals[i])))
    }

    /// `r01`: where the line through nodes k and k+1 of the X traverse, followed back by the command of
    /// node k, meets the origin; mm, relative to the origin (eq. 2.5 ff).
    pub(crate) fn offset_mm(&self, k: usize) -> Vector {
        let along = self.nodes_mm(0)[k] - self.origin_mm.x;
        self.measured_mm(0, k) - self.direction(0, k) * along
    }

    /// The interval of one axis that holds a command; the last one at the upper end.
    pub(crate) fn interval(&self, axis: usize, q: f64) -> usize {
        let nodes = self.nodes_mm(axis);
        nodes.partition_point(|&node| node <= q).saturating_sub(1).min(nodes.len() - 2)
    }
}
