//! Linear least squares with covariance, and what the data leave open.

use nalgebra::{DMatrix, DVector};

use crate::student::quantile_95;

/// Singular values below this part of the largest, columns scaled to length 1, count as zero: the combination
/// is not in the data. Rounding leaves about 1e-15; real but weak combinations stay far above.
const RANK_TOLERANCE: f64 = 1e-9;

/// A solved least-squares problem: equation (30).
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The parameters, in the units of the design's columns.
    pub values: DVector<f64>,
    /// Their covariance.
    pub covariance: DMatrix<f64>,
    /// Standard deviation of one observation: the given one, or that of the residuals.
    pub sigma: f64,
    /// Degrees of freedom of `sigma`; `None` where it was given.
    pub degrees_of_freedom: Option<usize>,
    /// Observations minus fit.
    pub residuals: DVector<f64>,
}

impl Estimate {
    /// Standard uncertainty of a parameter.
    #[must_use]
    pub fn standard_uncertainty(&self, parameter: usize) -> f64 {
        self.covariance[(parameter, parameter)].max(0.0).sqrt()
    }

    /// Half width of a parameter's 95 % interval.
    #[must_use]
    pub fn half_width_95(&self, parameter: usize) -> f64 {
        quantile_95(self.degrees_of_freedom) * self.standard_uncertainty(parameter)
    }

    /// Root mean square of the residuals.
    #[must_use]
    pub fn rms(&self) -> f64 {
        (self.residuals.norm_squared() / self.residuals.len().max(1) as f64).sqrt()
    }
}

/// Minimises `|design·x - observations|²`: equation (30).
///
/// * `design` – one row per observation; every row of the same weight (divide rows by their uncertainty first)
/// * `sigma` – standard deviation of an observation where it is known; otherwise taken from the residuals
///
/// # Errors
/// Combinations of parameters that the data leave open, as unit vectors of scaled parameters: all parameters with a
/// share in one of them are undetermined. Also where there are fewer rows than columns.
pub fn solve(
    design: &DMatrix<f64>,
    observations: &DVector<f64>,
    sigma: Option<f64>,
) -> Result<Estimate, Vec<DVector<f64>>> {
    let (rows, columns) = design.shape();
    let scales = DVector::from_fn(columns, |k, _| {
        let norm = design.column(k).norm();
        if norm > 0.0 { norm } else { 1.0 }
    });
    let scaled =
        DMatrix::from_fn(
            rows.max(columns),
            columns,
            |i, k| {
                if i < rows { design[(i, k)] / scales[k] } else { 0.0 }
            },
        );
    let qr = scaled.qr();
    let svd = qr.r().svd(true, true);
    let (Some(u), Some(v_t)) = (svd.u, svd.v_t) else { return Err(Vec::new()) };
    let largest = svd.singular_values.max();
    let open: Vec<DVector<f64>> = (0..columns)
        .filter(|&k| {
            svd.singular_values[k].partial_cmp(&(RANK_TOLERANCE * largest))
                != Some(std::cmp::Ordering::Greater)
        })
        .map(|k| v_t.row(k).transpose())
        .collect();
    if !open.is_empty() {
        return Err(open);
    }
    let mut right = DVector::from_fn(rows.max(columns), |i, _| if i < rows { observations[i] } else { 0.0 });
    qr.q_tr_mul(&mut right);
    let inner = u.transpose() * right.rows(0, columns);
    let inverse = DMatrix::from_fn(columns, columns, |i, k| v_t[(k, i)] / svd.singular_values[k] / scales[i]);
    let values = &inverse * inner;
    let residuals = observations - design * &values;
    let free = rows - columns.min(rows);
    let (sigma, degrees_of_freedom) = match sigma {
        Some(sigma) => (sigma, None),
        None => ((residuals.norm_squared() / free.max(1) as f64).sqrt(), Some(free)),
    };
    let covariance = &inverse * inverse.transpose() * (sigma * sigma);
    Ok(Estimate { values, covariance, sigma, degrees_of_freedom, residuals })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_has_the_covariance_of_the_textbook() {
        // y = 1 + 2 x with residuals 0.1, -0.2, 0.1 that are orthogonal to both columns.
        let x = [0.0, 1.0, 2.0];
        let design = DMatrix::from_fn(3, 2, |i, k| if k == 0 { 1.0 } else { x[i] });
        let observations = DVector::from_vec(vec![1.1, 2.8, 5.1]);
        let fit = solve(&design, &observations, None).unwrap();
        assert!((fit.values[0] - 1.0).abs() < 1e-14 && (fit.values[1] - 2.0).abs() < 1e-14);
        let variance = 0.06;
        assert!((fit.covariance[(1, 1)] - variance / 2.0).abs() < 1e-14);
        assert!((fit.covariance[(0, 0)] - variance * 5.0 / 6.0).abs() < 1e-14);
        assert!((fit.covariance[(0, 1)] + variance / 2.0).abs() < 1e-14);
        assert_eq!(fit.degrees_of_freedom, Some(1));
    }

    #[test]
    fn what_is_open_is_named() {
        // Columns 0 and 2 are the same but for scale.
        let design =
            DMatrix::from_fn(4, 3, |i, k| [i as f64 + 1.0, (i * i) as f64, 3.0 * (i as f64 + 1.0)][k]);
        let open = solve(&design, &DVector::from_element(4, 1.0), None).unwrap_err();
        assert_eq!(open.len(), 1);
        assert!(open[0][1].abs() < 1e-12 && (open[0][0] + open[0][2]).abs() < 1e-12, "{}", open[0]);
        let few = solve(&DMatrix::identity(2, 3), &DVector::from_element(2, 1.0), None).unwrap_err();
        assert!((few[0][2].abs() - 1.0).abs() < 1e-12);
    }
}
