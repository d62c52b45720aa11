//! How rough a field is, found with the stated noise: restricted maximum likelihood, equation (94) of `docs/equations.md`.

use super::dense::{Square, dot};

/// Steps of the search, at most.
const STEPS: usize = 30;
/// Likelihoods that differ by less say the same.
const SAME: f64 = 0.02;
/// Largest step of the logarithm of a variance.
const LARGEST_STEP: f64 = 3.0;

/// One component of the field at scattered places: `y = X β + Σ f_t + noise`, `f_t` of covariance `θ_t K_t`.
pub(super) struct Model<'m> {
    /// Readings, mm.
    pub(super) y: &'m [f64],
    /// Columns of X.
    pub(super) fixed: &'m [Vec<f64>],
    /// `K_t`, each with a mean diagonal of 1.
    pub(super) kernels: &'m [Square],
    /// Variances of the noise, mm².
    pub(super) noise: &'m [f64],
}

/// What the search ends in.
pub(super) struct Found {
    /// `θ_t`, mm².
    pub(super) variances: Vec<f64>,
    /// `P = V⁻¹ - V⁻¹X(XᵀV⁻¹X)⁻¹XᵀV⁻¹`
    pub(super) projection: Square,
    /// `P y`
    pub(super) weighted: Vec<f64>,
    /// `β`
    pub(super) fixed: Vec<f64>,
    pub(super) likelihood: f64,
}

impl Model<'_> {
    /// All that the likelihood of these variances needs; `None` where they make no covariance.
    fn evaluated(&self, variances: Vec<f64>) -> Option<Found> {
        let n = self.y.len();
        let mut covariance = Square::zeros(n);
        for (i, noise) in self.noise.iter().enumerate() {
            covariance.row_mut(i)[i] = *noise;
        }
        for (theta, kernel) in variances.iter().zip(self.kernels) {
            for (v, k) in covariance.values.iter_mut().zip(&kernel.values) {
                *v += theta * k;
            }
        }
        let factor = covariance.into_cholesky()?;
        let mut projection = factor.inverse();
        // V⁻¹ X by columns, and XᵀV⁻¹X.
        let weighted_columns: Vec<Vec<f64>> = self.fixed.iter().map(|x| projection.times(x)).collect();
        let p = self.fixed.len();
        let mut normal = Square::zeros(p);
        for (i, x) in self.fixed.iter().enumerate() {
            for (j, weighted) in weighted_columns.iter().enumerate() {
                normal.row_mut(i)[j] = dot(x, weighted);
            }
        }
        let normal = normal.into_cholesky()?;
        let right: Vec<f64> = weighted_columns.iter().map(|weighted| dot(weighted, self.y)).collect();
        let fixed = normal.solve(&right);
        let inverse = normal.inverse();
        for i in 0..n {
            let row = projection.row_mut(i);
            for (a, left) in weighted_columns.iter().enumerate() {
                for (b, right) in weighted_columns.iter().enumerate() {
                    let by = left[i] * inverse.row(a)[b];
                    for (value, right) in row.iter_mut().zip(right) {
                        *value -= by * right;
                    }
                }
            }
        }
        let weighted = projection.times(self.y);
        let likelihood =
            -0.5 * (factor.log_determinant() + normal.log_determinant() + dot(self.y, &weighted));
        likelihood.is_finite().then_some(Found { variances, projection, weighted, fixed, likelihood })
    }

    /// The variances that make the readings likeliest: Newton's steps for their logarithms with the average information
    /// (Gilmour, Thompson and Cullis 1995), halved until they help.
    pub(super) fn likeliest(&self) -> Option<Found> {
        let n = self.y.len() as f64;
        let mean = self.y.iter().sum::<f64>() / n;
        let scatter = self.y.iter().map(|y| (y - mean) * (y - mean)).sum::<f64>() / n;
        let least = self.noise.iter().copied().fold(f64::INFINITY, f64::min);
        let count = self.kernels.len();
        let start = scatter.max(1e-3 * least) / count as f64;
        let mut best = self.evaluated(vec![start; count])?;
        for _ in 0..STEPS {
            let step = self.step(&best)?;
            let mut part = 1.0;
            let gained = loop {
                let theta = best.variances.iter().zip(&step);
                let next = theta.map(|(theta, step)| theta * units::math::exp(part * step)).collect();
                match self.evaluated(next).filter(|next| next.likelihood > best.likelihood) {
                    Some(next) => {
                        let gained = next.likelihood - best.likelihood;
                        best = next;
                        break gained;
                    }
                    None if part < 0.02 => break 0.0,
                    None => part *= 0.3,
                }
            };
            if gained < SAME {
                break;
            }
        }
        Some(best)
    }

    fn step(&self, at: &Found) -> Option<Vec<f64>> {
        let count = self.kernels.len();
        let images: Vec<Vec<f64>> = self.kernels.iter().map(|kernel| kernel.times(&at.weighted)).collect();
        let projected: Vec<Vec<f64>> = images.iter().map(|image| at.projection.times(image)).collect();
        let mut information = Square::zeros(count);
        let mut slope = vec![0.0; count];
        for i in 0..count {
            let trace = dot(&at.projection.values, &self.kernels[i].values);
            slope[i] = 0.5 * at.variances[i] * (dot(&images[i], &at.weighted) - trace);
            for (j, projected) in projected.iter().enumerate() {
                let by = 0.5 * at.variances[i] * at.variances[j];
                information.row_mut(i)[j] = by * dot(&images[i], projected);
            }
            // Of the second derivative by the logarithm; keeps what the readings do not tell from running away.
            information.row_mut(i)[i] += slope[i].abs() + 1e-3;
        }
        let step = information.into_cholesky()?.solve(&slope);
        Some(step.into_iter().map(|step| step.clamp(-LARGEST_STEP, LARGEST_STEP)).collect())
    }
}

impl Found {
    /// Squared residuals over the stated variances, what they should sum to, and the variance of that sum.
    pub(super) fn residuals(&self, noise: &[f64]) -> [f64; 3] {
        let mut sums = [0.0; 3];
        for (i, noise_i) in noise.iter().enumerate() {
            sums[0] += noise_i * self.weighted[i] * self.weighted[i];
            sums[1] += noise_i * self.projection.row(i)[i];
            let row = self.projection.row(i).iter().zip(noise);
            sums[2] += 2.0 * noise_i * row.map(|(p, noise)| p * p * noise).sum::<f64>();
        }
        sums
    }

    /// Standard uncertainty of a constant that would be added to the readings marked, mm.
    pub(super) fn uncertainty_of_offset_mm(&self, marked: &[bool]) -> f64 {
        let column: Vec<f64> = marked.iter().map(|marked| f64::from(u8::from(*marked))).collect();
        let information = dot(&column, &self.projection.times(&column));
        // Nothing is told of a constant that the fixed part of the model holds.
        1.0 / information.max(f64::MIN_POSITIVE).sqrt()
    }
}
