//! The six error functions of one axis as rows: what an interferometer table holds.

use crate::{Interpolation, Six, Table, TableError, Vector};

/// Rows of an interferometer table: position of the axis, translations, rotations.
///
/// The KMTPP engines work on the rows themselves and not on the interpolated functions: the published
/// one takes the nearest row, the product's one wants straight lines between them.
#[derive(Clone, Debug, PartialEq)]
pub struct ParametricTable {
    positions_mm: Vec<f64>,
    rows: Vec<Six>,
}

impl ParametricTable {
    /// * `positions_mm` – commands of the axis, strictly increasing
    /// * `rows` – `EX EY EZ` in mm, `EA EB EC` in rad
    ///
    /// # Errors
    /// [`TableError`] as for [`Table::new`].
    pub fn new(positions_mm: Vec<f64>, rows: Vec<Six>) -> Result<Self, TableError> {
        crate::table::check(&positions_mm, &vec![0.0; rows.len()])?;
        match rows.iter().position(|row| row.iter().any(|v| !v.is_finite())) {
            Some(row) => Err(TableError::NotFinite { row }),
            None => Ok(Self { positions_mm, rows }),
        }
    }

    /// Commands of the axis, mm.
    #[must_use]
    pub fn positions_mm(&self) -> &[f64] {
        &self.positions_mm
    }

    /// Translations of row `k`, mm.
    #[must_use]
    pub fn linear_mm(&self, k: usize) -> Vector {
        Vector::from_column_slice(&self.rows[k][..3])
    }

    /// Rotations of row `k`, rad.
    #[must_use]
    pub fn angular_rad(&self, k: usize) -> Vector {
        Vector::from_column_slice(&self.rows[k][3..])
    }

    /// The step, mm, where all steps are equal to a millionth of it.
    #[must_use]
    pub fn equal_step_mm(&self) -> Option<f64> {
        let step = self.positions_mm[1] - self.positions_mm[0];
        let equal = |w: &[f64]| ((w[1] - w[0]) - step).abs() <= 1e-6 * step;
        self.positions_mm.windows(2).all(equal).then_some(step)
    }

    /// Function `which` (0..6: `EX EY EZ EA EB EC`), straight between the rows.
    #[must_use]
    pub fn linear_table(&self, which: usize) -> Table {
        let values = self.rows.iter().map(|row| row[which]).collect();
        Table::new(self.positions_mm.clone(), values, Interpolation::Linear)
            .expect("rows were checked when the table was made")
    }

    /// The same functions at an equal step from the first row on, interpolated linearly (Tables 4.5 to
    /// 4.7 of Pimushkin 2023).
    #[must_use]
    pub fn refined(&self, step_mm: f64) -> Self {
        let tables: Vec<Table> = (0..6).map(|which| self.linear_table(which)).collect();
        let (first, last) = (self.positions_mm[0], self.positions_mm[self.positions_mm.len() - 1]);
        let count = ((last - first) / step_mm + 1e-9) as usize + 1;
        let positions_mm: Vec<f64> = (0..count).map(|k| first + k as f64 * step_mm).collect();
        let rows = positions_mm.iter().map(|&q| std::array::from_fn(|f| tables[f].value(q))).collect();
        Self { positions_mm, rows }
    }
}
