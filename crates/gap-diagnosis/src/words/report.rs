//! The whole answer, put together.

use diagnostic::{Text, both};

use crate::effects;
use crate::equations::align::{rms, row_lengths};
use crate::equations::observation::Measurements;
use crate::judgement::answer::{Cause, Diagnosis, Gap, Leftover, Verdict};
use crate::judgement::assembly::Assembly;
use crate::judgement::locate::places;
use crate::judgement::next::{next_measurement, once_more};
use crate::judgement::risk::Use;
use crate::judgement::unseen::{gap_of_its_own, residuals};
use crate::judgement::verdict::{Evidence, Unseen, verdict};
use crate::options::Options;
use crate::search::formula::formulas;
use crate::words::cause::{DO_NOT_ACT, NO_NAME_YET, NO_PLAY, TURNED};
use crate::words::sentence::sentence;

/// What the rows that were fitted say, before others are asked.
struct OnRows {
    gap: Gap,
    leftover: Leftover,
    causes: Vec<Cause>,
    used: Use,
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
        let OnRows { gap, leftover, causes, used, mut evidence } = self.on_rows(holdout, options);
        // Below the step of the control no correction is possible and no cause is worth a name.
        let fine = gap.rms_um * 12.0_f64.sqrt() < options.resolution_um;
        let held = holdout.map(|h| self.holdout(h));
        let named = matches!(verdict(&evidence), Verdict::Named | Verdict::Ambiguous | Verdict::Partial);
        let told = holdout.zip(held.as_ref()).map(|(data, held)| {
            let promised = causes.last().and_then(|c| c.shrink_predicted);
            let pooled = self.unseen(data, held.rms_before_um, held.rms_after_um, promised);
            let open = !fine && causes.is_empty() && !pooled.shows_a_gap();
            Unseen { worse: held.worse, alone: open && gap_of_its_own(data, options), ..pooled }
        });
        // The same places say whether the causes come back, and nothing of what lies between them.
        let elsewhere = holdout.is_some_and(|data| !data.repeats(self.data));
        let told = told.filter(|told| elsewhere || !named || told.refutes());
        evidence.unseen = told.or_else(|| if named { kept_back() } else { None });
        let mut causes = if fine { Vec::new() } else { causes };
        let verdict = if fine { Verdict::NoGap } else { verdict(&evidence) };
        let nameless = verdict.leaves_open();
        let formulas = if nameless { formulas(self.data, &self.model.scalars) } else { Vec::new() };
        let mut notes = self.notes();
        notes.extend(evidence.unseen.filter(|_| told.is_none()).map(|u| u.kept_back_note()));
        notes.extend(holdout.iter().flat_map(|h| self.forecast_notes(h, &causes)));
        notes.extend(formulas.iter().map(|f| both!("{} ({}).", "{:#} ({}).", f.words, f.text)));
        let runs = &holdout.unwrap_or(self.data).runs;
        let headline = Headline { verdict, gap, leftover: &leftover, causes: &causes, evidence: &evidence };
        let sentence = if fine { headline.sentence() } else { headline.doubted(runs) };
        if verdict == Verdict::Underpowered {
            causes.clear();
        }
        let limits = used.words(&self.model.library).filter(|_| verdict != Verdict::Unknown);
        let (within, limits) = match used {
            Use::Within(volume, _) => {
                notes.extend(limits);
                (Some(volume), None)
            }
            _ => (None, limits),
        };
        let turned = || causes.iter().any(Cause::is_turned_play).then_some(TURNED);
        let withheld = turned()
            .or(limits)
            .or_else(|| (verdict.leaves_open() && !evidence.confirmed()).then_some(NO_NAME_YET));
        let withheld = withheld.filter(|_| !causes.is_empty());
        notes.extend(withheld.clone());
        if withheld.is_some() {
            let others = causes.iter_mut().filter(|cause| !cause.is_turned_play());
            others.for_each(|cause| cause.remedy = DO_NOT_ACT);
        }
        let open = self.open().or_else(|| used.stand().map(|(place, rival)| (place, vec![rival])));
        let (data, scalars) = (self.data, &self.model.scalars);
        Diagnosis {
            verdict,
            sentence,
            gap,
            places: places(data, scalars, &before, self.noise_variance(), options.seed),
            next_measurement: next_measurement(data, self.model, open, self.noise_variance().sqrt())
                .or_else(|| nameless.then(|| once_more(data)).flatten()),
            causes,
            withheld,
            within,
            setup: Some(self.setup()),
            leftover,
            holdout: held,
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
        let used = self.may_be_used(options.volume);
        let mut evidence = self.evidence(&gap, &leftover, &causes);
        evidence.risks |= matches!(used, Use::Nowhere(_));
        OnRows { gap, leftover, causes, used, evidence }
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
            let mut cause = Cause {
                term: Some(self.term(ranked.place)),
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
                shrink_predicted: Some(self.shrink(index + 1, holdout)),
                remedy: effects::of(kind).remedy.clone(),
            };
            if cause.is_turned_play() {
                cause.remedy = NO_PLAY;
            }
            causes.push(cause);
            rms_before_um = rms_after_um;
        }
        causes
    }
}

/// What the headline is made of.
struct Headline<'a> {
    verdict: Verdict,
    gap: Gap,
    leftover: &'a Leftover,
    causes: &'a [Cause],
    evidence: &'a Evidence,
}

impl Headline<'_> {
    fn sentence(&self) -> Text {
        sentence(self.verdict, &self.gap, self.causes, self.leftover)
    }

    /// The sentence with what unseen rows say against it; `runs`: theirs.
    fn doubted(&self, runs: &[String]) -> Text {
        let rms_um = self.gap.rms_um;
        match self.verdict {
            Verdict::Underpowered if self.evidence.guessed => both!(
                "Rows and model differ by {rms_um:.1} µm RMS, and nothing says how much of it is noise: no command was read twice, and neighbouring rows lie far apart. Read twelve of the commands once more in the same run, or state u_um.",
                "Строки и модель расходятся на {rms_um:.1} мкм (СКЗ), и ничто не говорит, сколько из этого шума: ни одна точка не измерена дважды, а соседние строки далеко друг от друга. Измерьте двенадцать точек ещё раз в той же серии или укажите u_um."
            ),
            _ => {
                let unseen = self.evidence.unseen;
                let refuted = if self.causes.is_empty() {
                    unseen.and_then(|u| u.gap_note())
                } else {
                    unseen.and_then(|u| u.refutation(runs))
                };
                let mut said = self.sentence();
                said.push(&refuted.unwrap_or_default());
                said
            }
        }
    }
}
