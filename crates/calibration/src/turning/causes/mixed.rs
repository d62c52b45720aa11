//! A linear model of readings whose parts each share an error: fits, tests, and how much of a column others can be.

use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use super::super::bases::{orthonormal, without};
use super::super::strata::{Between, MeanSquare, Spread, Whitening};

/// Degrees of freedom of noise that is stated.
const KNOWN: f64 = 1e6;
/// Below this share of its length a column is nothing.
const NOTHING: f64 = 1e-9;

/// What is known of the noise of readings.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Noise {
    /// The uncertainty of each is stated: the weights hold it.
    Stated,
    /// The same for all, from the residuals.
    Common,
}

/// Readings, with the levels that are never blamed.
pub(super) struct Mixed {
    /// Weighted by their uncertainties.
    readings: DVector<f64>,
    /// One size per tool and more that the set-up holds.
    levels: Vec<DVector<f64>>,
    /// The same, one size per part and tool: an orthonormal basis.
    cells: Vec<DVector<f64>>,
    /// What a part shares: one column per part.
    shared: Vec<DVector<f64>>,
    noise: Noise,
}

/// A model that was fitted.
pub(super) struct Fitted {
    /// Of its columns.
    pub(super) values: DVector<f64>,
    spread: Spread,
    /// How many columns belong to levels, before those of the values.
    before: usize,
    /// Variance of what parts share beyond noise can be told.
    pub(super) is_scatter_seen: bool,
    /// Standard deviation of a reading, in its unit where no uncertainty is stated, else of the stated one.
    pub(super) noise: f64,
}

impl Mixed {
    /// All columns weighted alike.
    pub(super) fn new(
        readings: DVector<f64>,
        levels: Vec<DVector<f64>>,
        cells: &[DVector<f64>],
        shared: Vec<DVector<f64>>,
        noise: Noise,
    ) -> Self {
        Self { readings, levels, cells: orthonormal(cells, &[]), shared, noise }
    }

    /// Least squares with what parts share, equation (78): columns must be independent of the levels and of each other.
    pub(super) fn fit(&self, columns: &[DVector<f64>]) -> Fitted {
        let rows = self.readings.len();
        let within = orthonormal(columns, &self.cells);
        let left = without(&self.readings, &within).norm_squared();
        let free = rows.saturating_sub(within.len()) as f64;
        let noise = match self.noise {
            Noise::Stated => MeanSquare { value: 1.0, freedom: f64::INFINITY },
            Noise::Common => MeanSquare { value: left / free.max(1.0), freedom: free.max(1.0) },
        };
        let all: Vec<DVector<f64>> = self.levels.iter().chain(columns).cloned().collect();
        let basis = orthonormal(&all, &[]);
        let between = Between {
            squares: (without(&self.readings, &basis).norm_squared() - left).max(0.0),
            freedom: within.len().saturating_sub(basis.len()) as f64,
            share: self.shared.iter().map(|column| without(column, &basis).norm_squared()).sum(),
        };
        let variance = between.variance(noise.value, &self.shared);
        let theta = variance.max(0.0) / noise.value.max(f64::MIN_POSITIVE);
        let whitening = Whitening::new(&self.shared, theta);
        let design = whitening.apply_to(&DMatrix::from_columns(&all));
        let white = whitening.apply(self.readings.clone());
        let inverse = design.pseudo_inverse(1e-10).unwrap_or_else(|_| DMatrix::zeros(all.len(), rows));
        let values = &inverse * &white;
        // What a reading does to an unknown: the whitening of the reading is part of it.
        let gains = whitening.apply_to(&inverse.transpose()).transpose();
        let spread =
            Spread::new(&gains, &vec![false; rows], &self.shared, [noise, noise], &between, variance);
        let before = self.levels.len();
        Fitted {
            values: values.rows(before, columns.len()).into_owned(),
            spread,
            before,
            is_scatter_seen: between.is_seen(),
            noise: noise.value.sqrt(),
        }
    }

    /// Share of a column that no level is: 0 where the set-up takes it.
    pub(super) fn seen(&self, column: &DVector<f64>) -> f64 {
        let left = without(column, &orthonormal(&self.levels, &[]));
        if column.norm() > 0.0 { left.norm_squared() / column.norm_squared() } else { 0.0 }
    }

    /// Share of a column, beyond the levels, that no other column is.
    pub(super) fn own_share(&self, column: &DVector<f64>, others: &[DVector<f64>]) -> f64 {
        let levels = orthonormal(&self.levels, &[]);
        let seen = without(column, &levels);
        let own = without(&seen, &orthonormal(others, &levels));
        let whole = seen.norm_squared();
        if whole > NOTHING * column.norm_squared() { own.norm_squared() / whole } else { 0.0 }
    }

    /// Degrees of freedom of a reading's noise with these columns.
    pub(super) fn freedom(&self, columns: &[DVector<f64>]) -> usize {
        self.readings.len().saturating_sub(orthonormal(columns, &self.cells).len())
    }

    /// The readings beyond the levels, in the unit of the weights.
    pub(super) fn beyond(&self) -> DVector<f64> {
        without(&self.readings, &orthonormal(&self.levels, &[]))
    }

    /// Root mean square of the same with columns fitted.
    pub(super) fn rms_with(&self, columns: &[DVector<f64>]) -> f64 {
        let all: Vec<DVector<f64>> = self.levels.iter().chain(columns).cloned().collect();
        let left = without(&self.readings, &orthonormal(&all, &[]));
        (left.norm_squared() / self.readings.len() as f64).sqrt()
    }

    /// Studentised residuals of the form: of each reading what its part's others do not explain.
    pub(super) fn largest_residual(&self, columns: &[DVector<f64>]) -> (usize, f64, f64) {
        let basis = orthonormal(columns, &self.cells);
        let left = without(&self.readings, &basis);
        let free = self.freedom(columns) as f64;
        let one = |k: usize| {
            let taken: f64 = basis.iter().map(|own| own[k] * own[k]).sum();
            let redundancy = (1.0 - taken).max(0.0);
            // What is left without it judges it.
            let others = (left.norm_squared() - left[k] * left[k] / redundancy.max(1e-6)).max(0.0);
            let noise = match self.noise {
                Noise::Stated => 1.0,
                Noise::Common => (others / (free - 1.0).max(1.0)).sqrt(),
            };
            if redundancy > 1e-3 && noise > 0.0 { (left[k] / redundancy.sqrt() / noise).abs() } else { 0.0 }
        };
        let sizes = (0..left.len()).map(|k| (k, one(k)));
        let (worst, size) = sizes.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, 0.0));
        let freedom = match self.noise {
            Noise::Stated => f64::INFINITY,
            Noise::Common => (free - 1.0).max(1.0),
        };
        (worst, size, freedom)
    }
}

impl Fitted {
    /// Half width of the 95 % interval of a sum of the columns' values.
    pub(super) fn u95(&self, of: &DVector<f64>) -> f64 {
        let mut row = DVector::zeros(self.before + of.len());
        row.rows_mut(self.before, of.len()).copy_from(of);
        self.spread.of(&row).half_width_95()
    }

    /// Chance that values so far from zero come of noise, by an F test of these columns together.
    pub(super) fn p(&self, columns: &[usize]) -> f64 {
        let count = columns.len();
        let places: Vec<usize> = columns.iter().map(|k| k + self.before).collect();
        let own = DVector::from_iterator(count, columns.iter().map(|k| self.values[*k]));
        let covariance = self.spread.covariance().select_rows(&places).select_columns(&places);
        let freedom = places.iter().map(|k| self.spread.of_unknown(*k).freedom).fold(KNOWN, f64::min);
        if own.amax() == 0.0 {
            return 1.0;
        }
        let Some(solved) = covariance.cholesky().map(|c| c.solve(&own)) else { return 1.0 };
        let ratio = own.dot(&solved) / count as f64;
        FisherSnedecor::new(count as f64, freedom).map_or(1.0, |f| 1.0 - f.cdf(ratio))
    }
}

/// An orthonormal basis of columns.
pub(super) fn basis(columns: &[DVector<f64>]) -> Vec<DVector<f64>> {
    orthonormal(columns, &[])
}

/// A vector less its part in a basis.
pub(super) fn beyond(vector: &DVector<f64>, basis: &[DVector<f64>]) -> DVector<f64> {
    without(vector, basis)
}
