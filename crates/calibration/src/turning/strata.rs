//! How well a sum of unknowns is known where the readings of a part share an error.
//!
//! Each reading has noise of its own, and all diameters of a part share an error: its seat, its coolant, who read it. What a
//! part shows within itself (its form) and what parts show against one another (sizes, growth, wear) are therefore
//! known by different noise with different degrees of freedom. `V = s_d² W_d + s_f² W_f + s_p² Z Zᵀ`: noise of diameters,
//! of faces, and what parts share, Z one column per part. s_p² is what the sizes of the parts leave beyond the noise
//! (Henderson's third method: its expectation is exact, so it may be below nought); combined variances have Welch's and
//! Satterthwaite's effective degrees of freedom (GUM G.4.1). Equation (78) of `docs/equations.md`.

use nalgebra::{DMatrix, DVector};

use crate::student::quantile_between;

/// Degrees of freedom below this are rounding.
const LEAST_FREEDOM: f64 = 1e-6;

/// Mean square of one kind of noise.
#[derive(Clone, Copy, Debug)]
pub(super) struct MeanSquare {
    /// In squares of the weights.
    pub value: f64,
    /// Its degrees of freedom: infinite where it was stated.
    pub freedom: f64,
}

/// What the parts' sizes leave.
#[derive(Clone, Copy, Debug)]
pub(super) struct Between {
    /// Weighted sum of squares beyond the noise of readings.
    pub squares: f64,
    /// Its degrees of freedom.
    pub freedom: f64,
    /// How much of s_p² is in the sum.
    pub share: f64,
}

impl Between {
    /// s_p², mm²; 0 where no degree of freedom tells it. Never so far below nought that the mean of a part would have no
    /// variance.
    pub(super) fn variance(&self, noise: f64, shared: &[DVector<f64>]) -> f64 {
        if self.is_seen() {
            let largest = shared.iter().map(DVector::norm_squared).fold(f64::MIN_POSITIVE, f64::max);
            ((self.squares - self.freedom * noise) / self.share).max(-noise / largest)
        } else {
            0.0
        }
    }

    pub(super) fn is_seen(&self) -> bool {
        self.freedom > LEAST_FREEDOM && self.share > 0.0
    }
}

/// A standard uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertainty {
    /// In the unit of what it is of.
    pub standard: f64,
    /// Effective degrees of freedom; infinite where the noise was stated.
    pub freedom: f64,
}

impl Uncertainty {
    /// Half width of the 95 % interval.
    #[must_use]
    pub fn half_width_95(&self) -> f64 {
        if self.standard > 0.0 { self.standard * quantile_between(0.05, self.freedom) } else { 0.0 }
    }
}

/// Covariance of all unknowns, by the noise it comes from, each with its degrees of freedom.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    parts: Vec<(DMatrix<f64>, f64)>,
}

impl Spread {
    /// * `gains` – unknowns × readings: what a weighted reading does to an unknown
    /// * `is_face` – of the readings
    /// * `shared` – columns of Z, weighted
    /// * `variance` – s_p², [`Between::variance`]
    pub(super) fn new(
        gains: &DMatrix<f64>,
        is_face: &[bool],
        shared: &[DVector<f64>],
        [diameters, faces]: [MeanSquare; 2],
        between: &Between,
        variance: f64,
    ) -> Self {
        let by = |faces: bool| {
            let own: Vec<usize> = (0..is_face.len()).filter(|k| is_face[*k] == faces).collect();
            let own = gains.select_columns(&own);
            &own * own.transpose()
        };
        let mut by_parts = DMatrix::zeros(gains.nrows(), gains.nrows());
        for column in shared {
            let gain = gains * column;
            by_parts += &gain * gain.transpose();
        }
        let mut parts = Vec::new();
        if between.is_seen() {
            // The mean square between parts is noise and parts together: s² + s_p² share / freedom.
            let per_square = between.freedom / between.share;
            let mean_square = diameters.value + variance / per_square;
            parts.push((&by_parts * (per_square * mean_square), between.freedom));
            by_parts *= per_square;
        } else {
            by_parts.fill(0.0);
        }
        parts.push(((by(false) - by_parts) * diameters.value, diameters.freedom));
        parts.push((by(true) * faces.value, faces.freedom));
        Self { parts }
    }

    /// With errors of a covariance that is known, of weighted readings: rounding to steps.
    pub(super) fn with(mut self, gains: &DMatrix<f64>, covariance: &DMatrix<f64>) -> Self {
        self.parts.push((gains * covariance * gains.transpose(), f64::INFINITY));
        self
    }

    pub(super) fn covariance(&self) -> DMatrix<f64> {
        let size = self.parts[0].0.nrows();
        self.parts.iter().fold(DMatrix::zeros(size, size), |sum, (own, _)| sum + own)
    }

    /// Of `row · unknowns`.
    pub(super) fn of(&self, row: &DVector<f64>) -> Uncertainty {
        let variances: Vec<(f64, f64)> =
            self.parts.iter().map(|(own, freedom)| (row.dot(&(own * row)), *freedom)).collect();
        let variance = variances.iter().map(|(own, _)| own).sum::<f64>().max(0.0);
        let fourth: f64 = variances.iter().map(|(own, freedom)| own.max(0.0).powi(2) / freedom).sum();
        // Where the parts are uneven a share may be below nought by a little: nothing has less than one degree.
        let freedom = if fourth > 0.0 { (variance * variance / fourth).max(1.0) } else { f64::INFINITY };
        Uncertainty { standard: variance.sqrt(), freedom }
    }

    pub(super) fn of_unknown(&self, k: usize) -> Uncertainty {
        let mut row = DVector::zeros(self.parts[0].0.nrows());
        row[k] = 1.0;
        self.of(&row)
    }
}

/// `(I + θ Z Zᵀ)^(-1/2)` for columns of Z that have no reading in common: readings of a part are made independent.
pub(super) struct Whitening<'z> {
    shared: &'z [DVector<f64>],
    theta: f64,
}

impl<'z> Whitening<'z> {
    pub(super) fn new(shared: &'z [DVector<f64>], theta: f64) -> Self {
        Self { shared, theta }
    }

    pub(super) fn apply(&self, mut weighted: DVector<f64>) -> DVector<f64> {
        for column in self.shared {
            let square = column.norm_squared();
            if square > 0.0 {
                let taken = (1.0 - 1.0 / (1.0 + self.theta * square).sqrt()) / square;
                weighted.axpy(-taken * column.dot(&weighted), column, 1.0);
            }
        }
        weighted
    }

    pub(super) fn apply_to(&self, weighted: &DMatrix<f64>) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> =
            weighted.column_iter().map(|column| self.apply(column.into_owned())).collect();
        DMatrix::from_columns(&columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Four parts of three readings, one mean: the textbook's one-way classification. u² of the mean is the mean square
    /// between parts over all readings, with three degrees of freedom.
    #[test]
    fn the_mean_of_parts_is_known_by_their_scatter() {
        let shared: Vec<DVector<f64>> =
            (0..4).map(|part| DVector::from_fn(12, |k, _| f64::from(u8::from(k / 3 == part)))).collect();
        let gains = DMatrix::from_element(1, 12, 1.0 / 12.0);
        let noise = MeanSquare { value: 1.0, freedom: 8.0 };
        // Of sums of squares between parts: 3 s² + (12 − 3) s_p².
        let between = Between { squares: 30.0, freedom: 3.0, share: 9.0 };
        let variance = between.variance(noise.value, &shared);
        let spread = Spread::new(&gains, &[false; 12], &shared, [noise; 2], &between, variance);
        let mean = spread.of_unknown(0);
        assert!((mean.standard.powi(2) - 10.0 / 12.0).abs() < 1e-12, "{mean:?}");
        assert!((mean.freedom - 3.0).abs() < 1e-9, "{mean:?}");
        assert!((mean.half_width_95() / mean.standard - 3.1824).abs() < 1e-3);
        let whitening = Whitening::new(&shared, 3.0);
        let white =
            whitening.apply_to(&(DMatrix::identity(12, 12) + &shared[0] * shared[0].transpose() * 3.0));
        let again = whitening.apply_to(&white.transpose());
        assert!((again.view((0, 0), (3, 3)) - DMatrix::<f64>::identity(3, 3)).amax() < 1e-12);
    }
}
