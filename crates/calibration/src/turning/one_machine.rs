//! Whether parts are of one machine, and in which order they were cut.

use diagnostic::{Speaks, both};
use nalgebra::{DMatrix, DVector};

use super::rows::{Feature, finest_mm};
use super::term::Term;
use crate::CalibrationError;
use crate::adjustment::{Noise, linear};
use crate::turning::bases::fisher_limit;
use crate::turning::readings::{Adjusted, PARTS_CHANCE, Readings};

impl Readings<'_> {
    /// Refuses test pieces whose tapers differ beyond chance.
    pub(super) fn one_machine(
        &self,
        terms: &[Term],
        adjusted: &Adjusted,
        names: &[String],
    ) -> Result<(), CalibrationError> {
        // What grows in time is told by the sizes of the parts: within a part it looks like a taper of its own.
        let (terms, mut values): (Vec<Term>, Vec<f64>) =
            (terms.iter().copied().zip(adjusted.values.iter().copied()))
                .filter(|(term, _)| term.is_geometry())
                .unzip();
        values.resize(terms.len() + self.cells.count(), 0.0);
        let design = self.jacobian(&terms, &self.cells, &values.into());
        let middle = 0.5 * (self.stretch.low_mm + self.stretch.high_mm);
        // The first part's own taper is what the others differ from.
        let own = self.parts[1..].iter().map(|part| {
            DVector::from_fn(self.rows.len(), |k, _| {
                let row = &self.rows[k];
                let is_own = row.part == *part && row.feature == Feature::Diameter;
                if is_own { 2.0 * (row.command.linear_mm.z - middle) } else { 0.0 }
            })
        });
        let columns: Vec<DVector<f64>> =
            design.column_iter().map(|column| column.into_owned()).chain(own).collect();
        let more = self.parts.len() - 1;
        if self.rows.len() < columns.len() + 2 {
            return Ok(());
        }
        let wide = DMatrix::from_columns(&columns);
        let fitted = |design: &DMatrix<f64>| {
            let gauge = DMatrix::zeros(0, design.ncols());
            linear(design, &adjusted.residuals, Noise::Relative(&self.weights), &gauge)
                .map_err(|error| CalibrationError::Contradicted(error.text()))
        };
        let (alike, apart) = (fitted(&design)?, fitted(&wide)?);
        let (all, left) = (self.squares(&alike), self.squares(&apart));
        let free = apart.redundancy.max(1);
        let variance = if self.is_known { 1.0 } else { left / free as f64 };
        let ratio = (all - left) / more as f64 / variance;
        let limit =
            fisher_limit(more as f64, if self.is_known { f64::INFINITY } else { free as f64 }, PARTS_CHANCE);
        let tapers = apart.values.rows(design.ncols(), more);
        let length = self.stretch.high_mm - self.stretch.low_mm;
        let (low, high) = tapers.iter().fold((0.0f64, 0.0f64), |(l, h), t| (l.min(*t), h.max(*t)));
        let apart_mm = 2.0 * (high - low) * length;
        if ratio <= limit || apart_mm <= finest_mm(self.rows) {
            return Ok(());
        }
        let odd = tapers.iter().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let odd = odd.map_or(0, |(k, _)| self.parts[k + 1]);
        Err(CalibrationError::Contradicted(both!(
            "the test pieces differ in their tapers, by {:.2} um on the diameter over {length:.0} mm (F {ratio:.1}, {limit:.1} by \
             chance at 0.1 %), `{}` and `{}` among them: that is their own bending or clamping, not one machine",
            "конусность образцов различается на {:.2} мкм на диаметр на длине {length:.0} мм (F {ratio:.1}, случайно {limit:.1} \
             при 0.1 %), в том числе `{}` и `{}`: это их собственный изгиб или закрепление, а не один станок",
            apart_mm * 1e3,
            names[self.parts[0]],
            names[odd],
        )))
    }
}
