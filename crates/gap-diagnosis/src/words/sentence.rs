//! The verdict in one sentence.

use diagnostic::{Text, both};

use crate::judgement::answer::{Cause, Gap, Leftover, Verdict};
use crate::judgement::verdict::{PHI_PARTIAL, Unseen};

/// One sentence for the shop floor.
pub(crate) fn sentence(verdict: Verdict, gap: &Gap, causes: &[Cause], leftover: &Leftover) -> Text {
    let names: Vec<&str> = causes.iter().map(|c| c.effect.as_str()).collect();
    let list = names.join(", ");
    let size = both!("{:.1} µm RMS", "{:.1} мкм (СКЗ)", gap.rms_um);
    let after = causes.last().map_or(gap.rms_um, |c| c.rms_after_um);
    match verdict {
        Verdict::NoGap => both!(
            "Model and machine agree within the noise of {:.2} µm.",
            "Модель и станок сходятся в пределах шума {:.2} мкм.",
            gap.noise_um
        ),
        Verdict::Named => both!(
            "The gap of {size} comes from {list}; with it in the model {after:.1} µm remain.",
            "Расхождение {size:#} создаёт {list}; с этим в модели остаётся {after:.1} мкм."
        ),
        Verdict::Ambiguous => {
            let open = causes.iter().find(|c| !c.cannot_be_told_from.is_empty());
            let open = open.map_or(Text::EMPTY, |c| {
                let (effect, rivals) = (&c.effect, c.cannot_be_told_from.join(", "));
                both!(
                    "; these rows cannot tell {effect} from {rivals}",
                    "; по этим строкам {effect} не отличить от {rivals}"
                )
            });
            both!(
                "The gap of {size} is explained by {list} down to {after:.1} µm{open}.",
                "Расхождение {size:#} объясняет {list}, остаётся {after:.1} мкм{open:#}."
            )
        }
        // All that these rows show is explained, and others contradict it.
        Verdict::Partial if leftover.phi <= PHI_PARTIAL => both!(
            "On the rows that were fitted {list} take the gap of {size} down to {after:.1} µm.",
            "На строках подгонки {list} уменьшает расхождение {size:#} до {after:.1} мкм."
        ),
        Verdict::Partial => both!(
            "{list} explain part of the gap of {size}; {:.0} % of what could be explained is left and is not noise.",
            "{list} объясняет часть расхождения {size:#}; {:.0} % объяснимого остаётся, и это не шум.",
            100.0 * leftover.phi
        ),
        Verdict::Unknown => {
            let absorber = names.first().map_or(Text::EMPTY, |n| {
                both!(
                    " (the nearest, {n}, only absorbs part of it)",
                    " (ближайший, {n}, лишь поглощает его часть)"
                )
            });
            both!(
                "There is a gap of {size} that no effect of the library explains{absorber}.",
                "Есть расхождение {size:#}, которого не объясняет ни один эффект библиотеки{absorber:#}."
            )
        }
        Verdict::NoiseModelSuspect => {
            if names.is_empty() {
                Text::pair(
                    "No effect is seen above the scatter of the rows, but that scatter is not the independent noise that the file says or repeats show: look at the instrument first.",
                    "Над разбросом строк не видно ни одного эффекта, но этот разброс — не тот независимый шум, который называет файл или показывают повторы: сначала проверьте прибор.",
                )
            } else {
                both!(
                    "What looks like a gap of {size} is made by the instrument: {list}.",
                    "То, что выглядит расхождением {size:#}, создаёт сам прибор: {list}."
                )
            }
        }
        Verdict::Underpowered => Text::pair(
            "Too little was measured to say anything.",
            "Измерено слишком мало, чтобы что-то утверждать.",
        ),
    }
}

impl Unseen {
    /// What the headline says of it where nothing is named.
    pub(crate) fn gap_note(&self) -> Option<Text> {
        if self.alone {
            return Some(Text::pair(
                " Rows that were not fitted show a gap when they are searched alone.",
                " Строки вне подгонки, рассмотренные отдельно, показывают расхождение.",
            ));
        }
        self.shows_a_gap().then(|| {
            both!(
                " Rows that were not fitted show a gap of {:.1} times the noise.",
                " Строки вне подгонки показывают расхождение в {:.1} раза больше шума.",
                self.before
            )
        })
    }

    /// What the headline says of it where causes are named.
    /// `runs`: names of those that were not fitted.
    pub(crate) fn refutation(&self, runs: &[String]) -> Option<Text> {
        let short = self.falls_short().then(|| {
            both!(
                " Rows that were not fitted refute it: {:.0} % were promised there, {:.0} % achieved.",
                " Строки вне подгонки это опровергают: там обещано {:.0} %, достигнуто {:.0} %.",
                100.0 * self.promised.1,
                100.0 * self.achieved()
            )
        });
        let worse = || {
            self.worse.map(|worse| {
                both!(
                    " Run {}, which was not fitted, refutes it: {:.1} µm become {:.1} µm there.",
                    " Серия {} вне подгонки это опровергает: там {:.1} мкм становятся {:.1} мкм.",
                    runs.get(worse.run).map_or("?", String::as_str),
                    worse.before_um,
                    worse.after_um
                )
            })
        };
        short.or_else(worse)
    }

    /// What is said of runs that were kept back because there is no hold-out of other places.
    pub(crate) fn kept_back_note(&self) -> Text {
        both!(
            "No hold-out of other places was given: a search without every fourth run promised {:.0} % on these, and {:.0} % were achieved.",
            "Контрольных измерений в других точках не дано: поиск без каждой четвёртой серии обещал на них {:.0} %, достигнуто {:.0} %.",
            100.0 * self.promised.1,
            100.0 * self.achieved()
        )
    }
}
