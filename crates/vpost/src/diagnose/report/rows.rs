//! The residuals row by row, and which of them are drawn.

use gap_diagnosis::{Diagnosis, Measurements, Residual};
use machine_model::Vector;

/// Residuals of a row, before and after.
pub(super) struct Row<'a> {
    /// Index in the measurements.
    pub row: usize,
    /// One per equation.
    pub equations: &'a [Residual],
}

impl Row<'_> {
    /// Displacement seen, µm.
    pub(super) fn vectors_um(&self) -> (Vector, Vector) {
        let sum = |value: &dyn Fn(&Residual) -> f64| {
            self.equations.iter().fold(Vector::zeros(), |sum, r| sum + r.along * value(r))
        };
        (sum(&|r| r.before_um), sum(&|r| r.after_um))
    }

    /// Size of the gap, µm.
    pub(super) fn sizes_um(&self) -> (f64, f64) {
        let size = |value: &dyn Fn(&Residual) -> f64| {
            self.equations.iter().map(|r| value(r) * value(r)).sum::<f64>().sqrt()
        };
        (size(&|r| r.before_um), size(&|r| r.after_um))
    }
}

/// All rows with residuals.
pub(super) struct Rows<'a> {
    /// In the order of the file.
    pub all: Vec<Row<'a>>,
    /// Ranges of the commands, mm.
    pub ranges_mm: [(f64, f64); 3],
}

impl<'a> Rows<'a> {
    pub(super) fn new(d: &'a Diagnosis, data: &Measurements) -> Self {
        let all = d.residuals.chunk_by(|a, b| a.row == b.row);
        let all = all.map(|equations| Row { row: equations[0].row, equations }).collect();
        Self { all, ranges_mm: [0, 1, 2].map(|a| data.range_mm(a)) }
    }

    /// Every so many rows, and those where the gap is largest: what is drawn of a long file.
    pub(super) fn thinned(&self, most: usize) -> Vec<&Row<'a>> {
        let count = self.all.len();
        if count <= most {
            return self.all.iter().collect();
        }
        let largest = most / 10;
        let mut by_size: Vec<usize> = (0..count).collect();
        by_size.sort_by(|a, b| self.all[*b].sizes_um().0.total_cmp(&self.all[*a].sizes_um().0));
        let even = (0..most - largest).map(|k| k * count / (most - largest));
        let mut chosen: Vec<usize> = by_size.into_iter().take(largest).chain(even).collect();
        chosen.sort_unstable();
        chosen.dedup();
        chosen.into_iter().map(|at| &self.all[at]).collect()
    }

    /// True where the command of an axis varies.
    pub(super) fn moves(&self, axis: usize) -> bool {
        self.ranges_mm[axis].1 > self.ranges_mm[axis].0
    }
}
