//! From figures to one word.

use crate::diagnosis::Verdict;

/// More than this share of the reducible gap left: the causes named do not explain it.
pub(crate) const PHI_PARTIAL: f64 = 0.05;
/// Lack of fit counts below this probability.
pub(crate) const LACK_OF_FIT: f64 = 1e-3;
/// The best absorber must explain this share, else it is not worth calling the gap partly explained.
pub(crate) const PHI_UNKNOWN: f64 = 0.5;
/// Stated and observed noise may differ by this factor.
pub(crate) const NOISE_FACTOR: f64 = 1.6;

/// What the verdict depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Evidence {
    /// Equations minus set-up.
    pub degrees: f64,
    /// Runs.
    pub runs: usize,
    /// Effects that the design can show.
    pub visible: usize,
    /// Causes named.
    pub causes: usize,
    /// Causes that are faults of the instrument.
    pub instrument_causes: usize,
    /// Any cause has rivals.
    pub ambiguous: bool,
    /// Share of the reducible gap left.
    pub phi: f64,
    /// Lack of fit.
    pub lack_of_fit_p: f64,
    /// Residual noise over stated noise, where stated.
    pub noise_ratio: Option<f64>,
    /// What the causes displace is known better than the gap is large, everywhere it would be used.
    pub carries: bool,
}

/// The verdict; the thresholds and their reasons are in docs/diagnosis.md.
#[must_use]
pub(crate) fn verdict(e: &Evidence) -> Verdict {
    if e.degrees < 12.0 || e.runs < 2 || e.visible == 0 {
        return Verdict::Underpowered;
    }
    let structured = e.phi > PHI_PARTIAL && e.lack_of_fit_p < LACK_OF_FIT;
    if e.causes == 0 {
        if structured {
            return Verdict::Unknown;
        }
        let suspect = e.noise_ratio.is_some_and(|r| !(1.0 / NOISE_FACTOR..=NOISE_FACTOR).contains(&r));
        return if suspect { Verdict::NoiseModelSuspect } else { Verdict::NoGap };
    }
    if structured {
        // What is left is no noise, so the intervals are too narrow, and even those exceed the gap.
        if !e.carries {
            return Verdict::Underpowered;
        }
        return if e.phi > PHI_UNKNOWN { Verdict::Unknown } else { Verdict::Partial };
    }
    if e.ambiguous {
        return Verdict::Ambiguous;
    }
    if e.instrument_causes == e.causes { Verdict::NoiseModelSuspect } else { Verdict::Named }
}
