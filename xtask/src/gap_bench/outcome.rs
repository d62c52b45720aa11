//! One case with its answer, and what counts as right.

use gap_lab::{Case, Kind, NoiseKind};

use super::answer::{Answer, Cause};
use super::transport::Transport;

/// A case and what the command said.
pub(crate) struct Outcome {
    pub(crate) case: Case,
    pub(crate) answer: Result<Answer, String>,
    /// On the clock.
    pub(crate) seconds: f64,
    /// Of the processor.
    pub(crate) cpu_seconds: f64,
    /// The lab's own account of the hold-out, where the written profile could be predicted with.
    pub(crate) transport: Option<Transport>,
}

impl Outcome {
    /// The answer, where there was one.
    pub(crate) fn said(&self) -> Option<&Answer> {
        self.answer.as_ref().ok()
    }

    /// Id of the (largest) withheld effect.
    pub(crate) fn truth(&self) -> Option<&str> {
        self.case.truth.effects.first().map(|e| e.id.as_str())
    }

    /// The (largest) withheld effect was named first.
    pub(crate) fn right_first(&self) -> bool {
        self.truth().is_some() && self.said().and_then(Answer::first) == self.truth()
    }

    /// The withheld effect is among the reported names.
    pub(crate) fn inside(&self) -> bool {
        let truth = self.truth();
        self.said().is_some_and(|a| truth.is_some_and(|t| a.set().contains(&t)))
    }

    /// AMBIGUOUS with the truth among the names.
    pub(crate) fn honest(&self) -> bool {
        self.inside() && self.said().is_some_and(|a| a.verdict == "AMBIGUOUS")
    }

    /// A cause was named where there is none. Where the instrument drifts, a cause that is
    /// `instrument-drift` or says it cannot be told from it is no alarm.
    pub(crate) fn false_alarm(&self) -> bool {
        let drifts = self.case.noise == NoiseKind::Drift;
        let owns_up = |c: &Cause| {
            c.effect == "instrument-drift" || c.cannot_be_told_from.iter().any(|r| r == "instrument-drift")
        };
        self.said().is_some_and(|a| a.causes.iter().any(|c| !(drifts && owns_up(c))))
    }

    /// NAMED, and the first name is not a withheld effect.
    pub(crate) fn confidently_wrong(&self) -> bool {
        let Some(answer) = self.said() else { return false };
        if answer.verdict != "NAMED" {
            return false;
        }
        match self.case.kind {
            Kind::Null => self.false_alarm(),
            Kind::Outside | Kind::Removed => true,
            _ => !self.case.truth.effects.iter().any(|e| Some(e.id.as_str()) == answer.first()),
        }
    }

    /// PARTIAL or UNKNOWN.
    pub(crate) fn admits_unknown(&self) -> bool {
        self.said().is_some_and(Answer::admits_unknown)
    }

    /// Whether this kind of case got the answer it should have.
    pub(crate) fn right(&self) -> bool {
        match self.case.kind {
            Kind::Null => self.said().is_some() && !self.false_alarm(),
            Kind::Outside | Kind::Removed => self.admits_unknown(),
            Kind::Aliased => self.honest(),
            Kind::Multiple => {
                let Some(answer) = self.said() else { return false };
                let named = answer.causes.iter().map(|c| c.effect.as_str());
                let (mut named, mut truth): (Vec<_>, Vec<_>) =
                    (named.collect(), self.case.truth.effects.iter().map(|e| e.id.as_str()).collect());
                named.sort_unstable();
                truth.sort_unstable();
                named == truth
            }
            _ if self.case.truth.identifiable => self.right_first(),
            _ => self.inside(),
        }
    }

    /// Why an answer is not right, as a kind of reason.
    pub(crate) fn reason(&self) -> String {
        let answer = match &self.answer {
            Ok(answer) => answer,
            Err(words) => return format!("no answer: {words}"),
        };
        let family = |id: &str| id.split('.').next().unwrap_or(id).to_owned();
        let Some(first) = answer.first() else {
            return match self.case.kind {
                Kind::Multiple => "nothing named".into(),
                _ if self.case.truth.expected_sigma < 6.0 => "below what noise allows (gap under 6 σ)".into(),
                _ => format!("not named ({})", answer.verdict),
            };
        };
        match (self.case.kind, self.truth()) {
            (Kind::Null, _) => "named a cause where there is none".into(),
            (Kind::Outside | Kind::Removed, _) => format!("{} instead of an unknown", answer.verdict),
            (Kind::Aliased, _) if self.inside() => format!("truth inside, but {}", answer.verdict),
            (Kind::Multiple, _) => {
                let missed = self.missed().len();
                let extra = answer.causes.len() + missed - self.case.truth.effects.len();
                format!("{missed} of {} missed, {extra} extra", self.case.truth.effects.len())
            }
            (_, Some(truth)) if self.inside() => {
                let rival = if answer.causes[0].cannot_be_told_from.iter().any(|r| r == truth) {
                    "its rival"
                } else {
                    "another"
                };
                format!("{rival} named first, truth inside ({})", answer.verdict)
            }
            (_, Some(truth)) if family(truth) == family(first) => "right family, wrong axis".into(),
            (_, Some(_)) => format!("another effect named ({})", answer.verdict),
            (_, None) => "nothing to name".into(),
        }
    }

    /// Withheld effects that no cause names.
    pub(crate) fn missed(&self) -> Vec<&str> {
        let named: Vec<&str> =
            self.said().map(|a| a.causes.iter().map(|c| c.effect.as_str()).collect()).unwrap_or_default();
        let truth = self.case.truth.effects.iter().map(|e| e.id.as_str());
        truth.filter(|id| !named.contains(id)).collect()
    }
}

#[cfg(test)]
mod tests {
    use gap_lab::catalogue;

    use super::*;

    /// A case of a kind; one without a name takes seconds to find.
    fn case(kind: Kind, noise: Option<NoiseKind>) -> Case {
        let list = catalogue(1200, 1);
        let fits = |k: Kind, n: NoiseKind| k == kind && noise.is_none_or(|wanted| n == wanted);
        list.iter().find(|s| fits(s.kind, s.noise)).unwrap().build()
    }

    fn outcome(kind: Kind, noise: Option<NoiseKind>, verdict: &str, causes: &[&str]) -> Outcome {
        answered(case(kind, noise), verdict, causes)
    }

    /// A case with an answer made of a verdict and causes (`first|rival|rival`).
    fn answered(case: Case, verdict: &str, causes: &[&str]) -> Outcome {
        let truth = case.truth.effects.first().map_or("none".to_owned(), |e| e.id.clone());
        let causes: Vec<String> = causes
            .iter()
            .map(|names| {
                let names = names.replace("TRUTH", &truth);
                let mut names = names.split('|');
                let effect = names.next().unwrap();
                let rivals: Vec<String> = names.map(|n| format!("\"{n}\"")).collect();
                format!(r#"{{ "effect": "{effect}", "cannot_be_told_from": [{}] }}"#, rivals.join(","))
            })
            .collect();
        let text = format!(r#"{{ "verdict": "{verdict}", "causes": [{}] }}"#, causes.join(","));
        Outcome {
            case,
            answer: Ok(serde_json::from_str(&text).unwrap()),
            seconds: 0.0,
            cpu_seconds: 0.0,
            transport: None,
        }
    }

    #[test]
    fn a_single_effect_is_right_only_when_it_comes_first() {
        let single = |verdict: &str, causes: &[&str]| outcome(Kind::Single, None, verdict, causes);
        assert!(single("NAMED", &["TRUTH"]).right_first());
        assert!(single("AMBIGUOUS", &["TRUTH|step.Z"]).right_first());
        let second = single("NAMED", &["step.Z", "TRUTH"]);
        assert!(!second.right_first() && second.inside() && second.confidently_wrong());
        let rival = single("AMBIGUOUS", &["step.Z|TRUTH"]);
        assert!(!rival.right_first() && rival.inside() && !rival.confidently_wrong());
        let silent = single("NO GAP", &[]);
        assert!(!silent.right() && !silent.inside() && !silent.confidently_wrong());
    }

    #[test]
    fn a_null_with_a_name_is_an_alarm_unless_the_drift_owns_up() {
        let plain = |causes: &[&str]| outcome(Kind::Null, Some(NoiseKind::Plain), "NAMED", causes);
        assert!(plain(&[]).right() && !plain(&[]).false_alarm());
        assert!(plain(&["instrument-drift"]).false_alarm() && plain(&["step.X"]).confidently_wrong());
        let drift = |causes: &[&str]| outcome(Kind::Null, Some(NoiseKind::Drift), "AMBIGUOUS", causes);
        assert!(!drift(&["instrument-drift"]).false_alarm());
        assert!(!drift(&["warmup.X|instrument-drift"]).false_alarm());
        assert!(drift(&["warmup.X"]).false_alarm());
        assert!(drift(&["instrument-drift", "step.X"]).false_alarm());
    }

    #[test]
    fn what_has_no_name_must_stay_unknown() {
        for kind in [Kind::Outside, Kind::Removed] {
            let case = case(kind, None);
            let said = |verdict, causes: &[&str]| answered(case.clone(), verdict, causes);
            assert!(said("PARTIAL", &["step.X"]).right() && said("UNKNOWN", &[]).right());
            assert!(said("NAMED", &["step.X"]).confidently_wrong() && !said("NO GAP", &[]).right());
        }
    }

    #[test]
    fn an_aliased_effect_wants_both_the_verdict_and_the_truth() {
        let aliased = |verdict: &str, causes: &[&str]| outcome(Kind::Aliased, None, verdict, causes);
        assert!(aliased("AMBIGUOUS", &["step.X|TRUTH"]).honest());
        assert!(!aliased("NAMED", &["TRUTH"]).honest());
        assert!(!aliased("AMBIGUOUS", &["step.X|step.Y"]).honest());
    }

    #[test]
    fn several_effects_must_be_named_exactly() {
        let case = outcome(Kind::Multiple, None, "NAMED", &["TRUTH"]);
        assert_eq!(case.missed().len(), case.case.truth.effects.len() - 1);
        assert!(!case.right() && !case.confidently_wrong());
    }
}
