//! What the files of a case do not say.

/// One withheld effect.
#[derive(Clone, Debug)]
pub struct TrueEffect {
    /// Id of the contract, or `outside.…`.
    pub id: String,
    /// Root mean square over rows of what the file shows of it, set-up and run offsets removed, over σ.
    pub snr: f64,
    /// Coefficient of the textbook column that fits the noise-free effect best, with its unit; only
    /// where the textbook form has exactly one column.
    pub coefficient: Option<(&'static str, f64)>,
    /// Names that this design cannot tell from it, with the correlation of the true effect with their columns.
    pub rivals: Vec<(String, f64)>,
}

/// The truth of a case.
#[derive(Clone, Debug)]
pub struct Truth {
    /// Withheld effects, the largest first. Empty for a null.
    pub effects: Vec<TrueEffect>,
    /// Standard deviation of one reading, µm.
    pub sigma_um: f64,
    /// Standard deviation of the run offsets, µm.
    pub run_sigma_um: f64,
    /// True where no withheld effect has a rival.
    pub identifiable: bool,
    /// Length of the cleaned gap over σ: how many standard deviations a perfect test would see.
    pub expected_sigma: f64,
    /// Share of the cleaned gap's mean square in X, Y and Z.
    pub components: [f64; 3],
    /// Where the cleaned gap lies: commands of X, Y, Z in mm and square of the gap in µm², row by row.
    pub gap: Vec<([f64; 3], f64)>,
    /// Root mean square per row of the gap on the hold-out, noise included, set-up and run offsets removed, µm.
    pub holdout_before_um: f64,
    /// The same of the noise alone, µm.
    pub holdout_noise_um: f64,
}
