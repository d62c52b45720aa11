//! Small least-squares problems from inner products, aware of rank.

use nalgebra::{DMatrix, DVector};

/// A column counts as explained by the others where less than this share of its square is left.
pub(crate) const RANK_TOLERANCE: f64 = 1e-6;

/// Inner products of columns by their positions, the gap last.
pub(crate) trait Products {
    /// One of them.
    fn product(&self, i: usize, j: usize) -> f64;
    /// Number of columns, the gap among them.
    fn count(&self) -> usize;
}

impl Products for DMatrix<f64> {
    fn product(&self, i: usize, j: usize) -> f64 {
        self[(i, j)]
    }

    fn count(&self) -> usize {
        self.nrows()
    }
}

/// Pivoted Cholesky factor of the products of some columns.
#[derive(Clone, Debug)]
pub(crate) struct Factor {
    /// Columns that are independent, in pivot order, as positions in the list given.
    pub kept: Vec<usize>,
    /// Rows of the lower triangular factor over the kept columns, one behind the other.
    lower: Vec<f64>,
}

/// Where row `i` of a packed triangle begins.
const fn row(i: usize) -> usize {
    i * (i + 1) / 2
}

impl Factor {
    /// Factors `products[columns, columns]`; `reference` is the square of each column before anything was
    /// taken out of it.
    pub(crate) fn new(products: &impl Products, columns: &[usize], reference: &[f64]) -> Self {
        let count = columns.len();
        let mut kept: Vec<usize> = Vec::with_capacity(count);
        let mut rest: Vec<f64> = columns.iter().map(|c| products.product(*c, *c)).collect();
        // rows[k] holds row k of Lᵀ over all columns given.
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(count);
        for _ in 0..count {
            let open = (0..count).filter(|i| !kept.contains(i));
            let best = open
                .filter(|i| rest[*i] > RANK_TOLERANCE * reference[columns[*i]] && rest[*i] > 0.0)
                .max_by(|i, j| {
                    let share = |i: usize| rest[i] / reference[columns[i]];
                    share(*i).total_cmp(&share(*j)).then(j.cmp(i))
                });
            let Some(pivot) = best else { break };
            let root = rest[pivot].sqrt();
            let mut known = vec![0.0; count];
            for earlier in &rows {
                known.iter_mut().zip(earlier).for_each(|(sum, v)| *sum += earlier[pivot] * v);
            }
            let own = columns.iter().map(|column| products.product(columns[pivot], *column));
            let row: Vec<f64> = own.zip(known).map(|(product, sum)| (product - sum) / root).collect();
            for (to, v) in rest.iter_mut().zip(&row) {
                *to -= v * v;
            }
            kept.push(pivot);
            rows.push(row);
        }
        let rank = kept.len();
        let lower =
            (0..rank).flat_map(|i| (0..=i).map(move |j| (i, j))).map(|(i, j)| rows[j][kept[i]]).collect();
        Self { kept, lower }
    }

    /// Number of independent columns.
    pub(crate) fn rank(&self) -> usize {
        self.kept.len()
    }

    /// Logarithm of the determinant of the products of the kept columns.
    pub(crate) fn log_determinant(&self) -> f64 {
        (0..self.rank()).map(|i| 2.0 * units::math::ln(self.lower[row(i) + i])).sum()
    }

    /// `L⁻¹ b`, b over the kept columns.
    pub(crate) fn forward(&self, b: &[f64]) -> Vec<f64> {
        let mut x = b.to_vec();
        self.forward_in_place(&mut x);
        x
    }

    /// The same where `b` lies.
    pub(crate) fn forward_in_place(&self, b: &mut [f64]) {
        for i in 0..self.rank() {
            let (known, rest) = b.split_at_mut(i);
            let own = &self.lower[row(i)..row(i + 1)];
            let sum: f64 = own.iter().zip(known.iter()).map(|(l, v)| l * v).sum();
            rest[0] = (rest[0] - sum) / own[i];
        }
    }

    /// Solution of the normal equations; zero for columns that are not kept.
    pub(crate) fn solve(&self, b: &[f64], count: usize) -> DVector<f64> {
        let picked: Vec<f64> = self.kept.iter().map(|k| b[*k]).collect();
        let mut x = self.forward(&picked);
        for i in (0..self.rank()).rev() {
            let sum: f64 = (i + 1..self.rank()).map(|k| self.lower[row(k) + i] * x[k]).sum();
            x[i] = (x[i] - sum) / self.lower[row(i) + i];
        }
        let mut result = DVector::zeros(count);
        for (k, v) in self.kept.iter().zip(x) {
            result[*k] = v;
        }
        result
    }

    /// Inverse of the products over the kept columns, zeros elsewhere: covariance / σ².
    pub(crate) fn inverse(&self, count: usize) -> DMatrix<f64> {
        let mut result = DMatrix::zeros(count, count);
        for j in 0..count {
            let mut b = vec![0.0; count];
            b[j] = 1.0;
            if self.kept.contains(&j) {
                result.set_column(j, &self.solve(&b, count));
            }
        }
        result
    }
}

/// How much the columns take off the square of the last column (the gap), and their rank.
pub(crate) fn explained(products: &impl Products, columns: &[usize], reference: &[f64]) -> (f64, usize) {
    let factor = Factor::new(products, columns, reference);
    let last = products.count() - 1;
    let b: Vec<f64> = factor.kept.iter().map(|k| products.product(columns[*k], last)).collect();
    (factor.forward(&b).iter().map(|v| v * v).sum(), factor.rank())
}
