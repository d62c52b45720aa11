//! Shrinkage transported to the commands it is claimed for.

use crate::judgement::answer::Shrinkage;

/// What the causes do to a set of commands, set-up and run offsets taken out, per equation and in units of the
/// noise variance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strength {
    /// Mean square of their displacement.
    pub square: f64,
    /// The same of those that are no straight lines.
    pub bent: f64,
    /// Mean square of what the uncertainty of their numbers displaces.
    pub spread: f64,
    /// Noise that the alignment leaves: one minus the share of fitted set-up numbers.
    pub noise: f64,
}

/// A rival less likely than this beside the named cause has no say in the forecast: exp(-ΔBIC/2), six units.
pub(crate) const LEAST_WEIGHT: f64 = 0.05;

/// A rival that the data cannot tell from a cause, as the truth on the target commands while the named causes are
/// corrected; in the same units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Alternative {
    /// How likely it is, the named cause having 1: exp(-ΔBIC/2).
    pub weight: f64,
    /// Mean square of what it displaces there.
    pub square: f64,
    /// Mean square of the difference to what the named causes displace there.
    pub difference: f64,
}

/// Shrinkage of the RMS on target commands.
///
/// `m` is the cross-validated mean square of the residual on the data, in units of the noise variance, and
/// `m_error` its standard error. What of it is neither noise nor uncertainty of the numbers is a wrong shape and
/// grows with the displacement of what has one: `m' = noise + spread' + (m - 1 - spread) grown / square`, primes: target, and
/// `grown = bent' + (straight + straight') / 2`: a scale or a squareness has no other shape, and whether what is left beside
/// it grows as it does nobody knows. Then `S = 1 - sqrt(m' / (m' + square'))`. Where rivals explain the data as well, each predicts its own
/// `S_r = 1 - sqrt((m' + difference) / (m' + square_r))`: `mid` is the mean weighted by their likelihoods, and the
/// interval holds them all. It goes below zero where the correction of a wrong cause would do harm.
pub(crate) fn transported(
    m: f64,
    m_error: f64,
    data: &Strength,
    target: &Strength,
    rivals: &[Alternative],
) -> Shrinkage {
    let left = |m: f64| {
        let straight = |of: &Strength| (of.square - of.bent).max(0.0);
        let grown = target.bent + 0.5 * (straight(data) + straight(target));
        let ratio = if data.square > 0.0 { grown / data.square } else { 1.0 };
        let shape = ((m - 1.0 - data.spread) * ratio).max(-0.5);
        (target.noise + target.spread + shape * target.noise).max(0.05)
    };
    let at = |left: f64| 1.0 - (left / (left + target.square)).sqrt();
    let mid = at(left(m));
    let (low, high) = (at(left(m + 2.0 * m_error)), at(left(m - 2.0 * m_error)));
    let mut all = Shrinkage { low: low.min(mid - 0.02).max(0.0), mid, high: high.max(mid + 0.02) };
    let (mut sum, mut weights) = (mid, 1.0);
    for rival in rivals.iter().filter(|r| r.weight > LEAST_WEIGHT) {
        // Twice as bad as before is bad enough: one wild rival must not speak for all.
        let own = (1.0 - ((left(m) + rival.difference) / (left(m) + rival.square)).sqrt()).max(-1.0);
        sum += rival.weight * own;
        weights += rival.weight;
        all.low = all.low.min(own);
        all.high = all.high.max(own);
    }
    Shrinkage { mid: sum / weights, high: all.high.min(1.0), ..all }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strength(square: f64) -> Strength {
        Strength { square, bent: square, spread: 0.0, noise: 1.0 }
    }

    #[test]
    fn a_perfect_model_leaves_the_noise() {
        // Effect three times the noise: sqrt(1 + 9) shrinks to 1.
        let s = transported(1.0, 0.0, &strength(9.0), &strength(9.0), &[]);
        assert!((s.mid - (1.0 - (1.0_f64 / 10.0).sqrt())).abs() < 1e-12);
    }

    #[test]
    fn what_is_left_grows_with_the_effect() {
        let here = transported(1.5, 0.0, &strength(4.0), &strength(4.0), &[]);
        let there = transported(1.5, 0.0, &strength(4.0), &strength(16.0), &[]);
        assert!((here.mid - (1.0 - (1.5_f64 / 5.5).sqrt())).abs() < 1e-12);
        assert!((there.mid - (1.0 - (3.0_f64 / 19.0).sqrt())).abs() < 1e-12);
        assert!(here.low < here.mid && here.mid < here.high);
    }

    /// A rival that is the same on the target changes nothing; one that is as likely and displaces nothing there
    /// halves the promise, and the correction that it would not need shows in the interval.
    #[test]
    fn rivals_share_the_promise() {
        let alone = transported(1.0, 0.0, &strength(9.0), &strength(9.0), &[]);
        let same = Alternative { weight: 1.0, square: 9.0, difference: 0.0 };
        let with = transported(1.0, 0.0, &strength(9.0), &strength(9.0), &[same]);
        assert!((with.mid - alone.mid).abs() < 1e-12);
        let nothing = Alternative { weight: 1.0, square: 0.0, difference: 9.0 };
        let with = transported(1.0, 0.0, &strength(9.0), &strength(9.0), &[nothing]);
        // 1 - sqrt(10) where it is the truth, held at -1.
        assert!((with.mid - 0.5 * (alone.mid - 1.0)).abs() < 1e-12);
        assert!((with.low + 1.0).abs() < 1e-12 && with.high >= alone.mid);
        let unlikely = Alternative { weight: 1e-9, ..nothing };
        let with = transported(1.0, 0.0, &strength(9.0), &strength(9.0), &[unlikely]);
        assert!((with.mid - alone.mid).abs() < 1e-6 && with.low > 0.5);
    }
}
