//! Least-squares adjustment: readings against a forward function of any form, with the gauge as constraints.
//!
//! Every calibration is `reading = f(x) + noise` with f the full prediction of the base plus the change x plus the
//! set-up. [`adjust`] finds x by Gauss–Newton, weighted, under linear constraints `C (x - start) = 0` that say what the readings
//! cannot: where an angle is zero, which line is X. What is still open keeps its start value and is told; covariance,
//! redundancy and standardised residuals come with the result. Equation (30) of `docs/equations.md`.
//!
//! ```
//! use calibration::adjustment::{Jacobian, Noise, Problem, adjust};
//! use nalgebra::{DMatrix, DVector};
//!
//! // Two lengths between three marks on a scale: only differences are seen, the first mark is 0 by definition.
//! let problem = Problem {
//!     readings: &DVector::from_vec(vec![10.001, 20.004, 30.002]),
//!     noise: Noise::Known(&[0.001, 0.001, 0.001]),
//!     forward: &|x: &DVector<f64>| DVector::from_vec(vec![x[1] - x[0], x[2] - x[1], x[2] - x[0]]),
//!     jacobian: Jacobian::Numerical { steps: &[0.01, 0.01, 0.01] },
//!     gauge: &DMatrix::from_row_slice(1, 3, &[1.0, 0.0, 0.0]),
//!     settled: 1e-9,
//! };
//! let found = adjust(&problem, &DVector::from_vec(vec![0.0, 10.0, 30.0])).unwrap();
//! assert!(found.open.is_empty() && found.values[0].abs() < 1e-12);
//! assert!((found.values[2] - 30.003).abs() < 1e-9);
//! assert_eq!(found.redundancy, 1);
//! ```

use diagnostic::Speaks;
use nalgebra::{DMatrix, DVector};

use crate::student::{quantile, quantile_95};

/// Singular values below this part of the largest, columns scaled to length 1, count as zero: noise would be
/// ten million times as large in such a combination, and rounding of a numerical derivative leaves 1e-10.
const RANK_TOLERANCE: f64 = 1e-7;

/// Gauss–Newton steps before a problem counts as not solvable from its start.
const MOST_STEPS: usize = 25;

/// Halvings of one step: after 2⁻²⁰ of it the direction itself is wrong.
const MOST_HALVINGS: usize = 20;

/// A reading that the others determine to all but this part of its own variance cannot be judged by them.
const LEAST_REDUNDANCY: f64 = 1e-6;

/// Columns of `∂f/∂x`.
#[derive(Clone, Copy)]
pub enum Jacobian<'p> {
    /// Central differences with these steps, one per parameter, in its unit: large against rounding, small against
    /// the curvature of f (for angles 1e-4 rad, for places 1e-2 mm).
    Numerical {
        /// Half the width of each difference.
        steps: &'p [f64],
    },
    /// At the current parameters.
    Exact(&'p dyn Fn(&DVector<f64>) -> DMatrix<f64>),
    /// One matrix for all steps: right where products of parameters are small (errors times set-up), and what is the same in the
    /// ideal geometry stays the same, so that nothing but the gauge decides on it.
    Constant(&'p DMatrix<f64>),
}

/// What is known of the readings' noise.
#[derive(Clone, Copy, Debug)]
pub enum Noise<'p> {
    /// Standard uncertainty of each reading, in its unit.
    Known(&'p [f64]),
    /// Only their ratios are known: their common factor comes from the residuals.
    Relative(&'p [f64]),
    /// The same for all readings, from the residuals.
    Common,
}

impl Noise<'_> {
    fn weight(&self, reading: usize) -> f64 {
        match self {
            Self::Known(u) | Self::Relative(u) => 1.0 / u[reading],
            Self::Common => 1.0,
        }
    }
}

/// An adjustment to be done.
#[derive(Clone, Copy)]
pub struct Problem<'p> {
    /// What was read.
    pub readings: &'p DVector<f64>,
    /// How well.
    pub noise: Noise<'p>,
    /// What would be read without noise for these parameters.
    pub forward: &'p dyn Fn(&DVector<f64>) -> DVector<f64>,
    /// Its derivatives.
    pub jacobian: Jacobian<'p>,
    /// Rows C of the constraints `C (x - start) = 0`; no rows for none. Rows may repeat one another.
    pub gauge: &'p DMatrix<f64>,
    /// Settled once a step changes no prediction by more than this, in the unit of the readings.
    pub settled: f64,
}

/// Why there is no result.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AdjustmentError {
    /// A prediction or a reading is no number.
    #[error("reading {0} has no finite prediction")]
    NotFinite(usize),
    /// The steps do not settle.
    #[error("the adjustment does not settle: the last step still changes a prediction by {0:e}")]
    NotSettled(f64),
}

impl Speaks for AdjustmentError {
    fn russian(&self) -> String {
        match self {
            Self::NotFinite(reading) => format!("у отсчёта {reading} нет конечного предсказания"),
            Self::NotSettled(step) => {
                format!("уравнивание не сходится: последний шаг ещё меняет предсказание на {step:e}")
            }
        }
    }
}

/// An adjusted set of parameters: equation (30).
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The parameters.
    pub values: DVector<f64>,
    /// Their covariance under the gauge; zero in the open combinations.
    pub covariance: DMatrix<f64>,
    /// Combinations of parameters that neither readings nor gauge determine, as unit vectors of parameters that are scaled by
    /// their columns; they kept their start value. All parameters with a share in one of them are undetermined.
    pub open: Vec<DVector<f64>>,
    /// Factor from the uncertainties that were given (1 for [`Noise::Common`]) to those that hold: 1 where they are
    /// known, else from the residuals.
    pub sigma: f64,
    /// Degrees of freedom of `sigma`; `None` where it was given.
    pub degrees_of_freedom: Option<usize>,
    /// Readings beyond what the parameters need.
    pub redundancy: usize,
    /// Root of the weighted mean square of the residuals, by redundancy: 1 where known uncertainties are right.
    pub misfit: f64,
    /// Readings minus predictions.
    pub residuals: DVector<f64>,
    /// Part of each reading's own variance that stays in its residual, 0 to 1.
    pub redundancy_numbers: DVector<f64>,
    /// Residuals over their own standard deviation, sigma from the other readings' residuals (externally studentised) or,
    /// where it was given, the larger of the two. Zero where nothing controls the reading.
    pub standardised: DVector<f64>,
}

/// A reading that does not belong to the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// Its row.
    pub reading: usize,
    /// Reading minus prediction.
    pub residual: f64,
    /// The same over its standard deviation.
    pub standardised: f64,
    /// What the largest of as many good readings would exceed with the asked chance only.
    pub limit: f64,
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
        self.coverage_factor_95() * self.standard_uncertainty(parameter)
    }

    /// From a standard uncertainty to the half width of the 95 % interval.
    #[must_use]
    pub fn coverage_factor_95(&self) -> f64 {
        quantile_95(self.degrees_of_freedom)
    }

    /// Variance of a linear function `row · x`.
    #[must_use]
    pub fn variance_of(&self, row: &DVector<f64>) -> f64 {
        row.dot(&(&self.covariance * row)).max(0.0)
    }

    /// Root mean square of the residuals.
    #[must_use]
    pub fn rms(&self) -> f64 {
        (self.residuals.norm_squared() / self.residuals.len().max(1) as f64).sqrt()
    }

    /// The reading farthest from the others, where good readings would have one so far with this chance at most.
    #[must_use]
    pub fn outlier(&self, chance: f64) -> Option<Outlier> {
        let (reading, standardised) =
            self.standardised.iter().copied().enumerate().max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        // Bonferroni: as many readings, so many chances.
        let others = self.degrees_of_freedom.map(|free| free.saturating_sub(1));
        let limit = quantile(chance / self.standardised.len() as f64, others);
        let residual = self.residuals[reading];
        (standardised.abs() > limit).then_some(Outlier { reading, residual, standardised, limit })
    }
}

/// Finds the parameters: equation (30).
///
/// # Errors
/// [`AdjustmentError`]. Open combinations are no error: [`Estimate::open`] tells them.
///
/// # Panics
/// Where the sizes of readings, noise, predictions, derivatives, gauge and start do not fit one another.
pub fn adjust(problem: &Problem<'_>, start: &DVector<f64>) -> Result<Estimate, AdjustmentError> {
    let weighted = |x: &DVector<f64>| -> Result<DVector<f64>, AdjustmentError> {
        let predicted = (problem.forward)(x);
        let rest = DVector::from_fn(predicted.len(), |i, _| {
            (problem.readings[i] - predicted[i]) * problem.noise.weight(i)
        });
        match rest.iter().position(|r| !r.is_finite()) {
            Some(row) => Err(AdjustmentError::NotFinite(row)),
            None => Ok(rest),
        }
    };
    let mut values = start.clone();
    let mut rest = weighted(&values)?;
    let mut factored = Factored::new(&design(problem, &values), problem);
    let mut steps = 0;
    loop {
        let step = factored.least_norm(&rest);
        let moved = &factored.design * &step;
        let change = (0..moved.len()).map(|i| (moved[i] / problem.noise.weight(i)).abs()).fold(0.0, f64::max);
        let mut part = 1.0;
        let mut next = &values + &step;
        let mut left = weighted(&next)?;
        // A step that makes it worse by more than rounding is too long.
        let worst = rest.norm() * (1.0 + 1e-9) + f64::MIN_POSITIVE;
        for _ in 0..MOST_HALVINGS {
            if left.norm() <= worst || change <= problem.settled {
                break;
            }
            part *= 0.5;
            next = &values + &step * part;
            left = weighted(&next)?;
        }
        (values, rest) = (next, left);
        steps += 1;
        if change <= problem.settled {
            break;
        }
        if steps == MOST_STEPS {
            return Err(AdjustmentError::NotSettled(change));
        }
        if !matches!(problem.jacobian, Jacobian::Constant(_)) {
            factored = Factored::new(&design(problem, &values), problem);
        }
    }
    Ok(factored.estimate(problem, values, &rest))
}

/// Solves a linear problem: readings against `design · x`, from zero.
///
/// # Errors
/// [`AdjustmentError::NotFinite`].
///
/// # Panics
/// As [`adjust`].
pub fn linear(
    design: &DMatrix<f64>,
    readings: &DVector<f64>,
    noise: Noise<'_>,
    gauge: &DMatrix<f64>,
) -> Result<Estimate, AdjustmentError> {
    let forward = |x: &DVector<f64>| design * x;
    // One step is the solution; a second one only repeats it.
    let settled = f64::INFINITY;
    let jacobian = Jacobian::Constant(design);
    adjust(
        &Problem { readings, noise, forward: &forward, jacobian, gauge, settled },
        &DVector::zeros(design.ncols()),
    )
}

/// Derivatives at `x`, one row per reading, not weighted.
fn design(problem: &Problem<'_>, x: &DVector<f64>) -> DMatrix<f64> {
    match problem.jacobian {
        Jacobian::Exact(columns) => columns(x),
        Jacobian::Constant(matrix) => matrix.clone(),
        Jacobian::Numerical { steps } => {
            let at = |k: usize, by: f64| {
                let mut moved = x.clone();
                moved[k] += by;
                (problem.forward)(&moved)
            };
            let column = |k: usize| (at(k, steps[k]) - at(k, -steps[k])) / (2.0 * steps[k]);
            DMatrix::from_columns(&(0..x.len()).map(column).collect::<Vec<_>>())
        }
    }
}

/// The weighted design with the gauge, taken apart.
struct Factored {
    /// Weighted derivatives.
    design: DMatrix<f64>,
    /// `step = inverse · (qᵀ rest)`: what the readings determine, in parameters.
    inverse: DMatrix<f64>,
    /// Columns: directions of the readings that the parameters reach.
    reached: DMatrix<f64>,
    open: Vec<DVector<f64>>,
}

impl Factored {
    fn new(design: &DMatrix<f64>, problem: &Problem<'_>) -> Self {
        let (rows, columns) = design.shape();
        let design = DMatrix::from_fn(rows, columns, |i, k| design[(i, k)] * problem.noise.weight(i));
        let scales = DVector::from_fn(columns, |k, _| {
            let norm = design.column(k).norm();
            if norm > 0.0 { norm } else { 1.0 }
        });
        let mut scaled = DMatrix::from_fn(rows, columns, |i, k| design[(i, k)] / scales[k]);
        // Directions that the gauge holds, as orthonormal rows; what is left of the design moves none of them.
        let gauge =
            DMatrix::from_fn(columns, problem.gauge.nrows(), |k, c| problem.gauge[(c, k)] / scales[k]);
        let held = orthonormal(gauge);
        scaled -= (&scaled * &held) * held.transpose();
        let tall = (rows + held.ncols()).max(columns);
        let mut stacked = DMatrix::zeros(tall, columns);
        stacked.rows_mut(0, rows).copy_from(&scaled);
        stacked.rows_mut(rows, held.ncols()).copy_from(&held.transpose());
        let svd = stacked.qr().r().svd(false, true);
        let Some(v_t) = svd.v_t else { unreachable!("the right singular vectors were asked for") };
        let floor = RANK_TOLERANCE * svd.singular_values.max();
        let (known, open): (Vec<usize>, Vec<usize>) =
            (0..columns).partition(|&k| svd.singular_values[k] > floor);
        // Among the known directions those of the gauge are reached by no reading: their rows of `scaled` are zero.
        let basis =
            DMatrix::from_fn(columns, known.len(), |i, k| v_t[(known[k], i)] / svd.singular_values[known[k]]);
        let reached = &scaled * &basis;
        let inverse = DMatrix::from_fn(columns, known.len(), |i, k| basis[(i, k)] / scales[i]);
        let open = open.into_iter().map(|k| v_t.row(k).transpose()).collect();
        Self { design, inverse, reached, open }
    }

    fn least_norm(&self, rest: &DVector<f64>) -> DVector<f64> {
        &self.inverse * self.reached.tr_mul(rest)
    }

    fn estimate(self, problem: &Problem<'_>, values: DVector<f64>, rest: &DVector<f64>) -> Estimate {
        let rows = rest.len();
        let taken = DVector::from_fn(rows, |i, _| self.reached.row(i).norm_squared());
        // The trace of a projection is its rank.
        let rank = taken.sum().round() as usize;
        let redundancy = rows.saturating_sub(rank);
        let squares = rest.norm_squared();
        let misfit = (squares / redundancy.max(1) as f64).sqrt();
        let (sigma, degrees_of_freedom) = match problem.noise {
            Noise::Known(_) => (1.0, None),
            Noise::Relative(_) | Noise::Common => (misfit, Some(redundancy)),
        };
        let redundancy_numbers = taken.map(|h| (1.0 - h).clamp(0.0, 1.0));
        let standardised = DVector::from_fn(rows, |i, _| {
            let r = redundancy_numbers[i];
            if r < LEAST_REDUNDANCY || redundancy < 2 {
                return 0.0;
            }
            // Without this reading: an outlier must not hide behind the scatter that it makes.
            let scatter = ((squares - rest[i] * rest[i] / r).max(0.0) / (redundancy - 1) as f64).sqrt();
            let others = if degrees_of_freedom.is_none() { scatter.max(1.0) } else { scatter };
            if rest[i] == 0.0 { 0.0 } else { rest[i] / (others * r.sqrt()) }
        });
        let residuals = DVector::from_fn(rows, |i, _| rest[i] / problem.noise.weight(i));
        // Through the directions that readings reach alone: the gauge's have no variance.
        let spread = &self.inverse * self.reached.transpose();
        let covariance = &spread * spread.transpose() * (sigma * sigma);
        Estimate {
            values,
            covariance,
            open: self.open,
            sigma,
            degrees_of_freedom,
            redundancy,
            misfit,
            residuals,
            redundancy_numbers,
            standardised,
        }
    }
}

/// Orthonormal columns that span those of `columns`.
fn orthonormal(columns: DMatrix<f64>) -> DMatrix<f64> {
    let rows = columns.nrows();
    if columns.ncols() == 0 {
        return DMatrix::zeros(rows, 0);
    }
    let svd = columns.svd(true, false);
    let Some(u) = svd.u else { unreachable!("the left singular vectors were asked for") };
    let floor = RANK_TOLERANCE * svd.singular_values.max();
    let kept: Vec<usize> =
        (0..svd.singular_values.len()).filter(|&k| svd.singular_values[k] > floor).collect();
    DMatrix::from_fn(rows, kept.len(), |i, k| u[(i, kept[k])])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn none(columns: usize) -> DMatrix<f64> {
        DMatrix::zeros(0, columns)
    }

    #[test]
    fn a_line_has_the_covariance_of_the_textbook() {
        // y = 1 + 2 x with residuals 0.1, -0.2, 0.1 that are orthogonal to both columns.
        let x = [0.0, 1.0, 2.0];
        let design = DMatrix::from_fn(3, 2, |i, k| if k == 0 { 1.0 } else { x[i] });
        let readings = DVector::from_vec(vec![1.1, 2.8, 5.1]);
        let fit = linear(&design, &readings, Noise::Common, &none(2)).unwrap();
        assert!((fit.values[0] - 1.0).abs() < 1e-13 && (fit.values[1] - 2.0).abs() < 1e-13);
        let variance = 0.06;
        assert!((fit.covariance[(1, 1)] - variance / 2.0).abs() < 1e-13);
        assert!((fit.covariance[(0, 0)] - variance * 5.0 / 6.0).abs() < 1e-13);
        assert!((fit.covariance[(0, 1)] + variance / 2.0).abs() < 1e-13);
        assert_eq!((fit.degrees_of_freedom, fit.redundancy), (Some(1), 1));
        let expected = [1.0 / 6.0, 2.0 / 3.0, 1.0 / 6.0];
        assert!(fit.redundancy_numbers.iter().zip(expected).all(|(r, e)| (r - e).abs() < 1e-13));
    }

    #[test]
    fn what_is_open_is_named_and_stays_where_it_was() {
        // Columns 0 and 2 are the same but for scale.
        let design =
            DMatrix::from_fn(4, 3, |i, k| [i as f64 + 1.0, (i * i) as f64, 3.0 * (i as f64 + 1.0)][k]);
        let readings = DVector::from_fn(4, |i, _| 2.0 * (i as f64 + 1.0) + 0.5 * (i * i) as f64);
        let fit = linear(&design, &readings, Noise::Common, &none(3)).unwrap();
        assert_eq!(fit.open.len(), 1);
        assert!(fit.open[0][1].abs() < 1e-12 && (fit.open[0][0] + fit.open[0][2]).abs() < 1e-12);
        assert!(
            (fit.values[0] + 3.0 * fit.values[2] - 2.0).abs() < 1e-12 && (fit.values[1] - 0.5).abs() < 1e-12
        );
        assert_eq!(fit.redundancy, 2);
        // A gauge closes it: the third is held.
        let held = DMatrix::from_row_slice(2, 3, &[0.0, 0.0, 1.0, 0.0, 0.0, 2.0]);
        let fit = linear(&design, &readings, Noise::Common, &held).unwrap();
        assert!(fit.open.is_empty() && fit.values[2].abs() < 1e-13 && (fit.values[0] - 2.0).abs() < 1e-12);
        assert!(fit.standard_uncertainty(2) < 1e-15);
        assert_eq!(fit.redundancy, 2);
    }

    #[test]
    fn fewer_readings_than_parameters_are_open() {
        let fit = linear(
            &DMatrix::identity(2, 3),
            &DVector::from_element(2, 1.0),
            Noise::Known(&[1.0, 1.0]),
            &none(3),
        )
        .unwrap();
        assert_eq!((fit.open.len(), fit.redundancy), (1, 0));
        assert!((fit.open[0][2].abs() - 1.0).abs() < 1e-12 && fit.values[2] == 0.0);
    }

    /// A circle through points far from its start: nonlinear, with numerical columns.
    #[test]
    fn a_circle_is_found_from_afar_and_its_outlier_named() {
        let angles: Vec<f64> = (0..12).map(|k| f64::from(k) * 0.5).collect();
        let place = |a: f64| (100.0 + 30.0 * units::math::cos(a), -50.0 + 30.0 * units::math::sin(a));
        let forward = |x: &DVector<f64>| {
            DVector::from_fn(12, |i, _| {
                let (px, py) = place(angles[i]);
                ((px - x[0]) * (px - x[0]) + (py - x[1]) * (py - x[1])).sqrt() - x[2]
            })
        };
        let mut readings = DVector::from_fn(12, |i, _| 1e-4 * f64::from(u8::from(i % 2 == 0)));
        let steps = [0.01; 3];
        let gauge = none(3);
        let run = |readings: &DVector<f64>| {
            adjust(
                &Problem {
                    readings,
                    noise: Noise::Common,
                    forward: &forward,
                    jacobian: Jacobian::Numerical { steps: &steps },
                    gauge: &gauge,
                    settled: 1e-9,
                },
                &DVector::from_vec(vec![80.0, -40.0, 20.0]),
            )
            .unwrap()
        };
        let found = run(&readings);
        assert!((found.values[0] - 100.0).abs() < 1e-4 && (found.values[2] - 30.0).abs() < 2e-4);
        assert_eq!(found.outlier(0.01), None);
        readings[7] += 0.05;
        let outlier = run(&readings).outlier(0.01).unwrap();
        assert_eq!(outlier.reading, 7);
        assert!(outlier.residual > 0.02 && outlier.standardised > outlier.limit);
    }
}
