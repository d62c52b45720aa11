//! One model solved in full: coefficients, covariance, run offsets, residuals.

use machine_model::Vector;
use nalgebra::{DMatrix, Matrix3};

use crate::equations::columns::Column;
use crate::equations::columns::Source;
use crate::equations::gram::Gram;
use crate::equations::linear::Factor;
use crate::equations::term::Term;

/// A generalised least-squares solution.
#[derive(Clone, Debug)]
pub(crate) struct Solution {
    /// The columns, set-up first.
    pub terms: Vec<Term>,
    /// One per column; zero where the design cannot tell it.
    pub coefficients: Vec<f64>,
    /// Covariance of the coefficients divided by σ².
    pub unit_covariance: DMatrix<f64>,
    /// Whitened residual sum of squares, µm².
    pub residual_square: f64,
    /// Run-offset variance over σ².
    pub rho: f64,
    /// Offsets of the runs, µm, as far as the data tell (shrunk towards zero).
    pub run_offsets_um: Vec<Vector>,
    /// Residual of every equation after effects, set-up and run offset, µm.
    pub residuals_um: Vec<f64>,
}

impl Gram {
    /// The products of some columns only.
    pub(crate) fn select(&self, columns: &[usize]) -> Self {
        self.towards(columns, self.terms.len())
    }

    /// The products of some columns with another one in the place of the gap.
    pub(crate) fn towards(&self, columns: &[usize], target: usize) -> Self {
        let mut all = columns.to_vec();
        all.push(target);
        Self {
            terms: columns.iter().map(|c| self.terms[*c]).collect(),
            products: DMatrix::from_fn(all.len(), all.len(), |i, j| self.products[(all[i], all[j])]),
            run_products: self
                .run_products
                .iter()
                .map(|b| DMatrix::from_fn(3, all.len(), |c, j| b[(c, all[j])]))
                .collect(),
            run_information: self.run_information.clone(),
            equations: self.equations,
        }
    }

    /// Offsets that free run offsets amount to: directions that each run sees.
    pub(crate) fn offsets_fitted(&self) -> f64 {
        self.run_information.iter().map(|u| (0..3).filter(|c| u[(*c, *c)] > 1e-9).count() as f64).sum()
    }

    /// Squares of the columns, nothing taken out.
    pub(crate) fn squares(&self) -> Vec<f64> {
        (0..self.products.nrows()).map(|i| self.products[(i, i)]).collect()
    }

    /// Coefficients of all columns under a run-offset ratio.
    pub(crate) fn coefficients(&self, rho: f64) -> Vec<f64> {
        self.normal(&self.whitened(rho).0).1
    }

    /// The same with their covariance divided by σ².
    pub(crate) fn estimate(&self, rho: f64) -> (Vec<f64>, DMatrix<f64>) {
        let (factor, coefficients) = self.normal(&self.whitened(rho).0);
        (coefficients, factor.inverse(self.terms.len()))
    }

    /// The factor of whitened products, and the coefficients of all columns.
    fn normal(&self, whitened: &DMatrix<f64>) -> (Factor, Vec<f64>) {
        let count = self.terms.len();
        let columns: Vec<usize> = (0..count).collect();
        let factor = Factor::new(whitened, &columns, &self.squares());
        let b: Vec<f64> = columns.iter().map(|c| whitened[(*c, count)]).collect();
        let coefficients = factor.solve(&b, count).iter().copied().collect();
        (factor, coefficients)
    }

    /// Solves for all columns under a run-offset ratio.
    pub(crate) fn solve(&self, rho: f64, source: &Source<'_>) -> Solution {
        let (whitened, _) = self.whitened(rho);
        let count = self.terms.len();
        let (factor, coefficients) = self.normal(&whitened);
        let explained: f64 = coefficients.iter().enumerate().map(|(i, x)| x * whitened[(i, count)]).sum();
        let marginal = residuals(&self.terms, &coefficients, source);
        let run_offsets_um = self.offsets(rho, &coefficients);
        let residuals_um = marginal
            .iter()
            .zip(source.scalars)
            .map(|(r, s)| r - s.along.dot(&run_offsets_um[source.rows[s.row].run]))
            .collect();
        Solution {
            terms: self.terms.clone(),
            unit_covariance: factor.inverse(count),
            residual_square: (whitened[(count, count)] - explained).max(0.0),
            rho,
            run_offsets_um,
            residuals_um,
            coefficients,
        }
    }

    /// Best linear unbiased prediction of the run offsets, µm.
    pub(crate) fn offsets(&self, rho: f64, coefficients: &[f64]) -> Vec<Vector> {
        let count = self.terms.len();
        self.run_products
            .iter()
            .zip(&self.run_information)
            .map(|(block, information)| {
                if rho <= 0.0 {
                    return Vector::zeros();
                }
                let mut right = Vector::zeros();
                for c in 0..3 {
                    let fitted: f64 = coefficients.iter().enumerate().map(|(j, v)| block[(c, j)] * v).sum();
                    right[c] = block[(c, count)] - fitted;
                }
                let inner = Matrix3::identity() / rho + information;
                inner.cholesky().map_or_else(Vector::zeros, |c| c.solve(&right))
            })
            .collect()
    }

    /// Run-offset ratio of greatest restricted likelihood, by golden section around a first guess.
    pub(crate) fn best_rho(&self, guess: f64) -> f64 {
        let count = self.terms.len();
        let columns: Vec<usize> = (0..count).collect();
        let reference = self.squares();
        let deviance = |log_rho: f64| {
            let (whitened, log_determinant) = self.whitened(units::math::exp(log_rho));
            let factor = Factor::new(&whitened, &columns, &reference);
            let b: Vec<f64> = factor.kept.iter().map(|k| whitened[(*k, count)]).collect();
            let explained: f64 = factor.forward(&b).iter().map(|v| v * v).sum();
            let degrees = (self.equations as f64 - factor.rank() as f64).max(1.0);
            let residual = (whitened[(count, count)] - explained).max(1e-9);
            degrees * units::math::ln(residual / degrees) + log_determinant + factor.log_determinant()
        };
        let middle = units::math::ln(guess.max(1e-4));
        let (mut low, mut high) = (middle - 3.0, middle + 3.0);
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let (mut a, mut b) = (high - GOLDEN * (high - low), low + GOLDEN * (high - low));
        let (mut fa, mut fb) = (deviance(a), deviance(b));
        for _ in 0..18 {
            if fa < fb {
                (high, b, fb) = (b, a, fa);
                a = high - GOLDEN * (high - low);
                fa = deviance(a);
            } else {
                (low, a, fa) = (a, b, fb);
                b = low + GOLDEN * (high - low);
                fb = deviance(b);
            }
        }
        units::math::exp(0.5 * (low + high))
    }
}

/// Gap minus columns, µm, without run offsets.
pub(crate) fn residuals(terms: &[Term], coefficients: &[f64], source: &Source<'_>) -> Vec<f64> {
    let mut fitted = vec![0.0; source.scalars.len()];
    // One column after the other: the table of a column is large, and gone before the next one is made.
    for (term, v) in terms.iter().zip(coefficients).filter(|(_, v)| **v != 0.0) {
        Column::tabulated(term, source).add_to(*v, &mut fitted);
    }
    source.scalars.iter().zip(fitted).map(|(s, fitted)| s.gap_um - fitted).collect()
}
