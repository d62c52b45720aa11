//! The whole answer, put together.

use diagnostic::{Text, both};
use machine_model::effects::EffectKind;

use crate::equations::align::{rms, row_lengths};
use crate::equations::observation::Measurements;
use crate::judgement::answer::{Cause, Diagnosis, Gap, Leftover, Verdict};
use crate::judgement::assembly::Assembly;
use crate::judgement::locate::places;
use crate::judgement::next::{next_measurement, once_more};
use crate::judgement::unseen::{gap_of_its_own, residuals};
use crate::judgement::verdict::{Evidence, Unseen, verdict};
use crate::options::Options;
use crate::search::bounds::Harm;
use crate::search::formula::formulas;
use crate::words::cause::{DO_NOT_ACT, NO_PLAY};
use crate::words::remedy::remedy;
use crate::words::sentence::sentence;

/// Causes of which the first leave more than there was: the others take off what they put on.
fn cancelling(causes: &[Cause], gap_um: f64) -> Option<Harm> {
    /// What two or three causes may leave on their way, by chance, as a factor of the gap.
    const MORE: f64 = 1.1;
    let most_um = causes.iter().map(|cause| cause.rms_after_um).fold(0.0, f64::max);
    (most_um > MORE * gap_um).then_some(Harm::Cancels(most_um, gap_um))
}

/// What the rows that were fitted say, before others are asked.
struct OnRows {
    gap: Gap,
    leftover: Leftover,
    causes: Vec<Cause>,
    corner_um: f64,
    harm: Option<Harm>,
    evidence: Evidence,
}

impl Assembly<'_> {
    /// The answer. `kept_back` says what runs that a second search did not see make of its forecast; it is asked where
    /// there is a name and no hold-out.
    pub(crate) fn diagnosis(
        &self,
        holdout: Option<&Measurements>,
        options: &Options,
        kept_back: impl FnOnce() -> Option<Unseen>,
    ) -> Diagnosis {
        let before = self.gap_after(0);
        let OnRows { gap, leftover, causes, corner_um, harm, mut evidence } = self.on_rows(holdout, options);
        // Below the step of the control no correction is possible and no cause is worth a name.
        let fine = gap.rms_um * 12.0_f64.sqrt() < options.resolution_um;
        let held = holdout.map(|h| self.holdout(h));
        let believed = matches!(verdict(&evidence), Verdict::Named | Verdict::Ambiguous);
        evidence.unseen = match (holdout, &held) {
            (Some(data), Some(held)) => {
                let promised = causes.last().map(|c| c.shrink_predicted);
                let pooled = self.unseen(data, held.rms_before_um, held.rms_after_um, promised);
                let open = !fine && causes.is_empty() && !pooled.shows_a_gap();
                Some(Unseen { worse: held.worse, alone: open && gap_of_its_own(data, options), ..pooled })
            }
            _ if believed => kept_back(),
            _ => None,
        };
        let mut causes = if fine { Vec::new() } else { causes };
        let verdict = if fine { Verdict::NoGap } else { verdict(&evidence) };
        let nameless = verdict.leaves_open();
        let formulas = if nameless { formulas(self.data, &self.model.scalars) } else { Vec::new() };
        let mut notes = self.notes();
        notes.extend(evidence.unseen.filter(|_| holdout.is_none()).map(|u| u.kept_back_note()));
        notes.extend(holdout.iter().flat_map(|h| self.forecast_notes(h, &causes)));
        notes.extend(formulas.iter().map(|f| both!("{} ({}).", "{:#} ({}).", f.words, f.text)));
        let unsure = verdict == Verdict::Underpowered && !causes.is_empty();
        let sentence = if unsure {
            notes.extend(causes.iter().map(seen_but_unsure));
            both!(
                "These rows cannot carry a correction: what they show is uncertain by {corner_um:.1} um in the far corner, and the gap itself is {:.1} um RMS.",
                "Исправлять по этим строкам нельзя: неопределённость того, что они показывают, в дальнем углу {corner_um:.1} мкм, а само расхождение — {:.1} мкм (СКЗ).",
                gap.rms_um
            )
        } else {
            let unseen = evidence.unseen;
            let refuted = if fine {
                None
            } else if causes.is_empty() {
                unseen.and_then(|u| u.gap_note())
            } else {
                unseen.and_then(|u| u.refutation(&holdout.unwrap_or(self.data).runs))
            };
            let mut said = sentence(verdict, &gap, &causes, &leftover);
            if verdict == Verdict::Partial && evidence.shifts {
                said.push(&Text::pair(
                    " They count from machine zero, too far from what was measured to be written.",
                    " Отсчёт идёт от нуля станка, слишком далеко от измеренного, чтобы это записывать.",
                ));
            }
            said.push(&refuted.unwrap_or_default());
            said
        };
        if verdict == Verdict::Underpowered {
            causes.clear();
        }
        let withheld = harm.filter(|_| !causes.is_empty()).map(|harm| harm.words());
        notes.extend(withheld.clone());
        if nameless || withheld.is_some() {
            causes.iter_mut().for_each(|c| c.remedy = DO_NOT_ACT);
        }
        let (data, scalars) = (self.data, &self.model.scalars);
        Diagnosis {
            verdict,
            sentence,
            gap,
            places: places(data, scalars, &before, self.noise_variance(), options.seed),
            next_measurement: next_measurement(data, self.model, self.open(), self.noise_variance().sqrt())
                .or_else(|| nameless.then(|| once_more(data)).flatten()),
            causes,
            withheld,
            setup: self.setup(),
            leftover,
            holdout: held.filter(|_| !unsure),
            outlier_lines: self.model.outliers.iter().map(|r| data.rows[*r].line).collect(),
            detectable: self.detectable(),
            formulas,
            notes,
            residuals: residuals(scalars, &before, &self.gap_after(self.ordered.len())),
        }
    }

    /// What the rows that were fitted say.
    fn on_rows(&self, holdout: Option<&Measurements>, options: &Options) -> OnRows {
        let gap = self.size(&self.gap_after(0));
        let leftover = self.leftover();
        let causes = self.causes(holdout, gap.rms_um);
        let corner_um = self.uncertainty_in_corners_um(options.volume);
        let harm = cancelling(&causes, gap.rms_um).or_else(|| self.harm());
        let evidence = self.evidence(&gap, &leftover, &causes, corner_um, harm);
        OnRows { gap, leftover, causes, corner_um, harm, evidence }
    }

    /// The verdict of the rows that were fitted alone.
    pub(crate) fn on_its_rows(&self, options: &Options) -> Verdict {
        verdict(&self.on_rows(None, options).evidence)
    }

    /// The causes in order of share, each with what it leaves of the gap.
    fn causes(&self, holdout: Option<&Measurements>, gap_rms: f64) -> Vec<Cause> {
        let mut rms_before_um = gap_rms;
        let mut causes = Vec::new();
        for (index, ranked) in self.ordered.iter().enumerate() {
            let kind = self.model.library.kind(ranked.part);
            let rms_after_um = rms(&row_lengths(&self.model.scalars, &self.gap_after(index + 1)));
            let half_width = self.own(ranked.place).first().map(|(_, value)| *value);
            let no_play = matches!(kind, EffectKind::Backlash(_)) && half_width.is_some_and(|v| v < 0.0);
            causes.push(Cause {
                term: self.term(ranked.place),
                effect: kind.to_string(),
                words: self.words(ranked.place),
                parameters: self.parameters(ranked.place),
                share_unique: ranked.unique,
                share_alone: ranked.alone,
                p: ranked.p,
                cannot_be_told_from: self.told(ranked),
                nearest: ranked.nearest(),
                rms_before_um,
                rms_after_um,
                shrink_predicted: self.shrink(index + 1, holdout),
                remedy: if no_play { NO_PLAY } else { remedy(kind) },
            });
            rms_before_um = rms_after_um;
        }
        causes
    }
}

/// What a file that cannot carry a correction hints at.
fn seen_but_unsure(cause: &Cause) -> Text {
    let first = cause.parameters.first().map_or_else(String::new, |p| {
        format!(" ({} = {:.1} ± {:.1})", p.name, p.value, p.u95.unwrap_or_default())
    });
    both!(
        "Hinted at, too uncertain to be used: {}{first}.",
        "Намечается, но слишком неопределённо для использования: {}{first}.",
        cause.effect
    )
}
