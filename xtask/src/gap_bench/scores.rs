//! The figures: each a share with its interval.

use gap_lab::{Kind, Plan};

use super::answer::Cause;
use super::outcome::Outcome;

/// Hits among cases.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Rate {
    pub(crate) hits: usize,
    pub(crate) total: usize,
}

impl Rate {
    /// Counts the outcomes that pass.
    pub(crate) fn of<'a>(
        outcomes: impl IntoIterator<Item = &'a Outcome>,
        hit: impl Fn(&Outcome) -> bool,
    ) -> Self {
        let mut rate = Self::default();
        for outcome in outcomes {
            rate.add(hit(outcome));
        }
        rate
    }

    /// Counts one.
    pub(crate) fn add(&mut self, hit: bool) {
        self.total += 1;
        self.hits += usize::from(hit);
    }

    /// The share of hits, 0 … 1.
    pub(crate) fn share(self) -> f64 {
        self.hits as f64 / self.total as f64
    }

    /// Two cells of a table: the share and its interval.
    pub(crate) fn cells(self) -> String {
        let (low, high) = self.wilson();
        format!("{:.1} % | {:.1} – {:.1} %", 100.0 * self.share(), 100.0 * low, 100.0 * high)
    }

    /// Wilson's score interval at 95 %.
    fn wilson(self) -> (f64, f64) {
        let z = 1.959_963_984_540_054;
        let (n, p) = (self.total as f64, self.share());
        let centre = p + z * z / (2.0 * n);
        let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
        let scale = 1.0 + z * z / n;
        (((centre - half) / scale).max(0.0), ((centre + half) / scale).min(1.0))
    }
}

/// Outcomes of one kind.
pub(crate) fn of_kind(all: &[Outcome], kind: Kind) -> impl Iterator<Item = &Outcome> {
    all.iter().filter(move |o| o.case.kind == kind)
}

/// Signal-to-noise ratio of the largest effect.
pub(crate) fn snr(outcome: &Outcome) -> f64 {
    outcome.case.truth.effects.first().map_or(0.0, |e| e.snr)
}

/// Single cases whose design can tell the effect from every other, at a rung of the ladder.
pub(crate) fn identifiable(all: &[Outcome], low: f64, high: f64) -> Vec<&Outcome> {
    of_kind(all, Kind::Single)
        .filter(|o| o.case.truth.identifiable && (low..high).contains(&snr(o)))
        .collect()
}

/// The poor half of a list.
pub(crate) fn poor<'a>(list: &[&'a Outcome]) -> Vec<&'a Outcome> {
    list.iter().copied().filter(|o| o.case.plan != Plan::Good).collect()
}

/// Predicted and achieved shrinkage of a case, in points, where both are known.
pub(crate) struct Shrinkage {
    pub(crate) predicted: f64,
    pub(crate) achieved: f64,
}

/// What the answer predicts and what its hold-out block shows.
pub(crate) fn shrinkage(outcome: &Outcome) -> Option<Shrinkage> {
    let answer = outcome.said()?;
    let achieved = answer.holdout.as_ref()?.shrink?;
    Some(Shrinkage { predicted: 100.0 * predicted(outcome)?, achieved: 100.0 * achieved })
}

/// What the answer predicts and what the lab's own account of the written profile shows.
pub(crate) fn shrinkage_by_lab(outcome: &Outcome) -> Option<Shrinkage> {
    let transport = outcome.transport?;
    Some(Shrinkage { predicted: 100.0 * predicted(outcome)?, achieved: 100.0 * transport.share })
}

/// The prediction for all causes together: the last cause's, which counts those before it. Only where the
/// answer claims its causes: under UNKNOWN and NOISE MODEL SUSPECT it does not.
fn predicted(outcome: &Outcome) -> Option<f64> {
    let answer = outcome.said()?;
    let claims = matches!(answer.verdict.as_str(), "NAMED" | "AMBIGUOUS" | "PARTIAL");
    answer.causes.last().filter(|_| claims)?.shrink_predicted?.mid
}

/// Whether the parameter's 95 % interval holds the truth; only where both mean the same number: the
/// textbook form with its one coefficient.
pub(crate) fn covered(outcome: &Outcome) -> Option<bool> {
    let effect = outcome.case.truth.effects.first()?;
    let (unit, truth) = effect.coefficient?;
    if outcome.case.kind != Kind::Single || !outcome.right_first() {
        return None;
    }
    let causes = &outcome.said()?.causes;
    let mut estimated = causes.first()?.parameters.iter().filter(|p| p.u95.is_some());
    let (parameter, None) = (estimated.next()?, estimated.next()) else { return None };
    // A lag along the path is another number than a lag of the axis.
    if causes.len() > 1 || !parameter.name.ends_with(unit) || parameter.name.starts_with("path") {
        return None;
    }
    Some((parameter.value? - truth).abs() <= parameter.u95?)
}

/// Whether the component with the largest share is the true one; only where the truth has a clear one.
pub(crate) fn component_right(outcome: &Outcome) -> Option<bool> {
    let shares = outcome.case.truth.components;
    let (largest, share) = shares.into_iter().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))?;
    if share < 0.5 {
        return None;
    }
    let places = outcome.said()?.places.iter().filter(|p| p.by == "component");
    let first = places.max_by(|a, b| a.share.total_cmp(&b.share))?;
    Some(first.cell == ["dx", "dy", "dz"][largest])
}

/// Whether an effect that depends on the direction of approach was named first with its axis, and its number has the true
/// sign: which side the tip hangs back to. `None` for effects that do not depend on it.
pub(crate) fn direction_right(outcome: &Outcome) -> Option<bool> {
    let effect = outcome.case.truth.effects.first()?;
    let family = effect.id.split('.').next()?;
    if !matches!(family, "backlash" | "lost-motion" | "servo-lag" | "servo-mismatch") {
        return None;
    }
    let (unit, truth) = effect.coefficient?;
    let first = outcome.said()?.causes.first().filter(|c| c.effect == effect.id);
    let number = |c: &Cause| c.parameters.iter().find(|p| p.u95.is_some() && p.name.ends_with(unit))?.value;
    Some(first.and_then(number).is_some_and(|found| found * truth > 0.0))
}

/// The value below which `share` of the list lies.
pub(crate) fn quantile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let place = (share * (values.len().saturating_sub(1)) as f64).round() as usize;
    values.get(place).copied().unwrap_or(f64::NAN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wilson_agrees_with_the_published_example() {
        // Wilson 1927 as tabled by Newcombe 1998 (method 3): 81 of 263 and 0 of 20.
        let (low, high) = Rate { hits: 81, total: 263 }.wilson();
        assert!((low - 0.2553).abs() < 1e-4 && (high - 0.3662).abs() < 1e-4, "{low} {high}");
        let (low, high) = Rate { hits: 0, total: 20 }.wilson();
        assert!(low.abs() < 1e-12 && (high - 0.1611).abs() < 1e-4, "{low} {high}");
    }

    #[test]
    fn quantiles_of_small_lists() {
        assert!((quantile(vec![3.0, 1.0, 2.0], 0.5) - 2.0).abs() < 1e-12);
        assert!(quantile(Vec::new(), 0.5).is_nan());
    }
}
