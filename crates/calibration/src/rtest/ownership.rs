//! Which unknown owns what several of them can explain: equation (102).

use nalgebra::{DMatrix, DVector};

/// A column of which the earlier ones leave less than this part of its length is theirs: noise would stand in it two hundred
/// times as large, and balls do not stand still to better than a hundredth of a millimetre in their nests.
const APART: f64 = 5e-3;

/// Shares below are of no name: a twentieth of a column's length.
const SHARE: f64 = 0.05;

/// Columns gone through in an order of precedence.
pub(crate) struct Sweep {
    /// Columns that say something of their own, in the order.
    pub(crate) kept: Vec<usize>,
    /// Columns that the kept ones before them explain, and which of these.
    pub(crate) owned: Vec<(usize, Vec<usize>)>,
    /// After each column of the order: squares that the readings have left, and columns kept so far.
    pub(crate) after: Vec<(f64, usize)>,
}

/// Normal equations of weighted columns.
pub(crate) struct Normal {
    products: DMatrix<f64>,
    with_readings: DVector<f64>,
    squares: f64,
}

impl Normal {
    pub(crate) fn new(design: &DMatrix<f64>, readings: &DVector<f64>) -> Self {
        Self {
            products: design.tr_mul(design),
            with_readings: design.tr_mul(readings),
            squares: readings.norm_squared(),
        }
    }

    /// Cholesky's decomposition that leaves out what depends on the columns before.
    ///
    /// Squared columns lose half of the digits; what is apart by [`APART`] keeps eleven.
    pub(crate) fn sweep(&self, order: &[usize]) -> Sweep {
        let mut found = Sweep { kept: Vec::new(), owned: Vec::new(), after: Vec::new() };
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let mut explained: Vec<f64> = Vec::new();
        let mut left = self.squares;
        for &column in order {
            let own = self.products[(column, column)];
            let mut row: Vec<f64> = Vec::with_capacity(rows.len() + 1);
            for (k, &earlier) in found.kept.iter().enumerate() {
                let shared: f64 = row.iter().zip(&rows[k]).map(|(a, b)| a * b).sum();
                row.push((self.products[(column, earlier)] - shared) / rows[k][k]);
            }
            let rest = own - row.iter().map(|v| v * v).sum::<f64>();
            if rest <= APART * APART * own {
                found.owned.push((column, self.owners(column, &found.kept, &rows, &row)));
            } else {
                let shared: f64 = row.iter().zip(&explained).map(|(a, b)| a * b).sum();
                let pivot = rest.sqrt();
                let part = (self.with_readings[column] - shared) / pivot;
                row.push(pivot);
                rows.push(row);
                explained.push(part);
                found.kept.push(column);
                left -= part * part;
            }
            found.after.push((left.max(0.0), found.kept.len()));
        }
        found
    }

    /// Kept columns with a share in one that depends on them.
    fn owners(&self, column: usize, kept: &[usize], rows: &[Vec<f64>], row: &[f64]) -> Vec<usize> {
        let length = self.products[(column, column)].sqrt();
        let mut shares = row.to_vec();
        for k in (0..shares.len()).rev() {
            shares[k] /= rows[k][k];
            let share = shares[k];
            for (earlier, entry) in shares.iter_mut().zip(&rows[k]).take(k) {
                *earlier -= share * entry;
            }
        }
        let clear = |(share, owner): &(f64, usize)| {
            (share * self.products[(*owner, *owner)].sqrt()).abs() > SHARE * length
        };
        shares.into_iter().zip(kept.iter().copied()).filter(clear).map(|(_, owner)| owner).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_depends_on_earlier_columns_is_theirs() {
        let design = DMatrix::from_row_slice(
            4,
            5,
            &[
                1.0, 0.0, 2.0, 0.0, 0.0, //
                0.0, 1.0, -1.0, 0.0, 0.0, //
                0.0, 0.0, 0.0, 1.0, 3.0, //
                0.0, 0.0, 1e-4, 1.0, 3.0,
            ],
        );
        let readings = DVector::from_vec(vec![1.0, 2.0, 3.0, 5.0]);
        let found = Normal::new(&design, &readings).sweep(&[0, 1, 2, 3, 4]);
        assert_eq!(found.kept, [0, 1, 3]);
        assert_eq!(found.owned, [(2, vec![0, 1]), (4, vec![3])]);
        // The last two readings keep what differs from their mean.
        let (left, kept) = found.after[4];
        assert!((left - 2.0).abs() < 1e-12 && kept == 3);
        // In another order others own.
        let found = Normal::new(&design, &readings).sweep(&[2, 0, 1]);
        assert_eq!((found.kept, found.owned), (vec![2, 0], vec![(1, vec![2, 0])]));
    }
}
