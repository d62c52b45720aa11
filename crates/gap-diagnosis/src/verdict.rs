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

/// The verdict, by the first rule that holds:
///
/// 1. UNDERPOWERED: fewer than 12 equations beside the set-up, one run (set-up and machine are the same then), or a design
///    that shows no effect of the library.
/// 2. Nothing named: UNKNOWN where more than [`PHI_PARTIAL`] of the gap is structure by the lack-of-fit test, NOISE MODEL
///    SUSPECT where the scatter is not what the file states by more than [`NOISE_FACTOR`], else NO GAP.
/// 3. Something named and structure left: UNDERPOWERED where the causes are not known better than the gap is large in the
///    corners of the volume, UNKNOWN where more than [`PHI_UNKNOWN`] is left, else PARTIAL. A share alone is not enough: a small
///    gap leaves a large share of noise; a test alone is not enough: with many rows a nanometre is significant.
/// 4. AMBIGUOUS where any cause has rivals; this stands before the next rule, since a drift of the instrument that a warm-up of
///    the machine explains as well is not known to be the instrument's.
/// 5. NOISE MODEL SUSPECT where every cause is a fault of the instrument, else NAMED.
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

#[cfg(test)]
mod tests {
    use super::*;

    const CLEAR: Evidence = Evidence {
        degrees: 900.0,
        runs: 12,
        visible: 40,
        causes: 1,
        instrument_causes: 0,
        ambiguous: false,
        phi: 0.01,
        lack_of_fit_p: 0.4,
        noise_ratio: None,
        carries: true,
    };

    #[test]
    fn one_rule_after_the_other() {
        let none = Evidence { causes: 0, ..CLEAR };
        let left = Evidence { phi: 0.2, lack_of_fit_p: 1e-6, ..CLEAR };
        let cases = [
            (CLEAR, Verdict::Named),
            (Evidence { degrees: 11.0, ..CLEAR }, Verdict::Underpowered),
            (Evidence { runs: 1, ..CLEAR }, Verdict::Underpowered),
            (Evidence { visible: 0, ..CLEAR }, Verdict::Underpowered),
            (none, Verdict::NoGap),
            (Evidence { phi: 0.2, lack_of_fit_p: 1e-6, ..none }, Verdict::Unknown),
            (Evidence { noise_ratio: Some(2.0), ..none }, Verdict::NoiseModelSuspect),
            (Evidence { noise_ratio: Some(1.5), ..none }, Verdict::NoGap),
            (left, Verdict::Partial),
            (Evidence { phi: 0.6, ..left }, Verdict::Unknown),
            (Evidence { carries: false, ..left }, Verdict::Underpowered),
            // A share left that noise explains, and a lack of fit that is no share, are neither.
            (Evidence { lack_of_fit_p: 0.4, ..left }, Verdict::Named),
            (Evidence { phi: 0.01, ..left }, Verdict::Named),
            (Evidence { ambiguous: true, ..CLEAR }, Verdict::Ambiguous),
            // A fault of the instrument that a machine could have as well is a set, not a verdict on the instrument.
            (Evidence { ambiguous: true, instrument_causes: 1, ..CLEAR }, Verdict::Ambiguous),
            (Evidence { instrument_causes: 1, ..CLEAR }, Verdict::NoiseModelSuspect),
            (Evidence { instrument_causes: 1, causes: 2, ..CLEAR }, Verdict::Named),
        ];
        for (evidence, expected) in cases {
            assert_eq!(verdict(&evidence), expected, "{evidence:?}");
        }
    }
}
