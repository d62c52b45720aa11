//! The diagnosis as one page, in the order in which people ask: what, how much, where, how sure, what next, from what.

use diagnostic::{Language, Text, say};
use gap_diagnosis::{Diagnosis, Measurements, Verdict};
use maud::{Markup, html};
use report::page::{Page, Section};
use report::text::{Numbers, shown};

use super::facts::Facts;
use super::names::prose;
use super::rows::Rows;
use super::{causes, pictures, provenance, unseen};
use jobs::diagnose::change::Change;

/// What a page is made of.
pub(in crate::diagnose) struct Report<'a> {
    /// The answer.
    pub diagnosis: &'a Diagnosis,
    /// What acting on each cause changes in the profile.
    pub changes: &'a [Vec<Change>],
    /// The measurements it is about.
    pub data: &'a Measurements,
    /// Measurements no fit has seen.
    pub holdout: Option<&'a Measurements>,
    /// Files, options, versions.
    pub facts: &'a Facts,
    /// The JSON twin.
    pub json: &'a str,
    /// The language of the page.
    pub language: Language,
}

impl Report<'_> {
    /// The page.
    pub(in crate::diagnose) fn html(&self) -> String {
        let (d, language) = (self.diagnosis, self.language);
        let rows = Rows::new(d, self.data);
        let sections = [
            Some(Section {
                id: "waterfall",
                title: Text::pair("How the gap shrinks", "Как уменьшается расхождение"),
                body: causes::waterfall(d, language),
            }),
            Some(Section {
                id: "causes",
                title: Text::pair("Causes", "Причины"),
                body: causes::causes(d, self.changes, language),
            }),
            Some(Section {
                id: "where",
                title: Text::pair("Where the gap lies", "Где расхождение"),
                body: causes::places(d, language),
            }),
            pictures::strips(d, self.data, &rows, language).map(|body| Section {
                id: "strips",
                title: Text::pair(
                    "The gap over place, time and conditions",
                    "Расхождение по месту, времени и условиям",
                ),
                body,
            }),
            pictures::vectors(d, self.data, &rows, language).map(|body| Section {
                id: "vectors",
                title: Text::pair("Error vectors", "Векторы погрешности"),
                body,
            }),
            pictures::heat(d, self.data, &rows, language).map(|body| Section {
                id: "slices",
                title: Text::pair("Slices through the machine", "Сечения рабочего объёма"),
                body,
            }),
            pictures::distribution(d, &rows, self.facts.tolerance_um, language).map(|body| Section {
                id: "distribution",
                title: Text::pair("Before and after", "До и после"),
                body,
            }),
            Some(Section {
                id: "confounding",
                title: Text::pair("What looks alike", "Что похоже друг на друга"),
                body: causes::confounding(d, language),
            }),
            Some(Section {
                id: "unseen",
                title: Text::pair("Predicted and achieved", "Прогноз и результат"),
                body: unseen::unseen(d, self.holdout, self.facts, language),
            }),
            Some(Section {
                id: "next",
                title: Text::pair("What to measure next", "Что измерить дальше"),
                body: causes::next(d, language),
            }),
            Some(Section {
                id: "outliers",
                title: Text::pair("Rows left out", "Отброшенные строки"),
                body: causes::outliers(d, language),
            }),
            Some(Section {
                id: "provenance",
                title: Text::pair("Where this comes from", "Откуда эти данные"),
                body: provenance::body(d, self.facts, language),
            }),
        ];
        // Where too little was measured there is nothing to draw.
        let drawn = d.verdict != Verdict::Underpowered || !d.residuals.is_empty();
        let kept = |s: &Section| drawn || matches!(s.id, "next" | "provenance");
        Page {
            language,
            title: &say!(
                language,
                "{verdict} \u{2013} {}",
                "{verdict:#} \u{2014} {}",
                self.facts.machine,
                verdict = d.verdict.words()
            ),
            head: head(d, self.facts, language),
            sections: sections.into_iter().flatten().filter(kept).collect(),
            json: self.json,
            command: "diagnose",
            schema: "vpost.diagnosis/1",
        }
        .into_html()
    }
}

fn head(d: &Diagnosis, facts: &Facts, language: Language) -> Markup {
    let g = &d.gap;
    let [rms, p95, largest, noise] = [g.rms_um, g.p95_um, g.max_um, g.noise_um].map(|um| language.number(um));
    let rows = language.count(g.rows);
    html! {
        p.muted { (say!(language, "Simulation against reality: ", "Модель и действительность: ")) (shown(&facts.machine)) ", " (shown(&facts.measurements.name)) }
        p { span.verdict { (d.verdict.words().in_language(language)) } }
        h1 { (shown(&prose(&d.sentence, language))) }
        @if let Some(words) = in_words(d, language) { p { (shown(&words)) } }
        p { (meaning(d.verdict).in_language(language)) }
        @if g.rms_um > 0.0 {
            p.muted {
                (say!(
                    language,
                    "{rms} \u{b5}m RMS, 95 % below {p95} \u{b5}m, largest {largest} \u{b5}m, noise of a reading {noise} \u{b5}m, {rows} rows.",
                    "СКЗ {rms} мкм, 95 % ниже {p95} мкм, наибольшее {largest} мкм, шум отсчёта {noise} мкм, строк {rows}."
                ))
            }
        }
        @if let Some(gain) = gain(d, language) { p { (gain) } }
        (facts.origin.line(language))
    }
}

/// Causes that are said in words on the first screen.
const IN_WORDS: usize = 3;

/// The largest causes in words.
fn in_words(d: &Diagnosis, language: Language) -> Option<String> {
    let said: Vec<String> = d.causes.iter().take(IN_WORDS).map(|c| language.prose(&c.words)).collect();
    let (said, more) = (said.join("; "), d.causes.len().saturating_sub(IN_WORDS));
    match (d.causes.len(), more) {
        (0, _) => None,
        (_, 0) => Some(format!("{said}.")),
        _ => Some(say!(language, "{said}; {more} more below.", "{said}; ещё причин ниже: {more}.")),
    }
}

/// What a correction by the causes will bring, and what unseen rows say of it.
fn gain(d: &Diagnosis, language: Language) -> Option<String> {
    let s = d.causes.last()?.shrink_predicted;
    let [low, mid, high] = [s.low, s.mid, s.high].map(|share| language.percent(share));
    let mut said = say!(
        language,
        "With the causes in the profile the gap is forecast to shrink by {mid} ({low} to {high}).",
        "С причинами в профиле расхождение, по прогнозу, уменьшится на {mid} (от {low} до {high})."
    );
    said.push(' ');
    match &d.holdout {
        Some(held) => {
            let kept = language.percent(held.shrink);
            said.push_str(&say!(
                language,
                "On unseen rows it shrank by {kept}.",
                "На новых строках оно уменьшилось на {kept}."
            ));
        }
        None => said.push_str(&say!(
            language,
            "No unseen rows prove it: add --holdout FILE.",
            "Новыми строками это не проверено: добавьте --holdout FILE."
        )),
    }
    Some(said)
}

/// What a verdict asks of its reader.
fn meaning(verdict: Verdict) -> Text {
    match verdict {
        Verdict::NoGap => Text::pair(
            "The model may be used as it is. What this measurement could not have seen is listed below.",
            "Моделью можно пользоваться как есть. Чего это измерение увидеть не могло, перечислено ниже.",
        ),
        Verdict::Named => Text::pair(
            "The causes below explain the gap, and nothing else in the library does. Put them into the profile with --write-profile, or remove them at the machine.",
            "Причины ниже объясняют расхождение, и больше в библиотеке его не объясняет ничто. Внесите их в профиль ключом --write-profile или устраните на станке.",
        ),
        Verdict::Ambiguous => Text::pair(
            "The gap is explained, but a cause has a double that these rows cannot tell from it. A correction may use it where it was measured; before repairing anything, measure what is proposed below.",
            "Расхождение объяснено, но у причины есть двойник, которого эти строки от неё не отличают. Для коррекции там, где измерено, её можно использовать; прежде чем ремонтировать, измерьте предложенное ниже.",
        ),
        Verdict::Partial => Text::pair(
            "The causes below are real, and something else is there that the library has no name for. Correct with care: what is left is no noise.",
            "Причины ниже действительны, но есть и что-то ещё, чему в библиотеке нет названия. Исправляйте осторожно: остаток — не шум.",
        ),
        Verdict::Unknown => Text::pair(
            "Something moves the machine that the library has no name for. Do not correct by this; look at where and when the gap is largest.",
            "Станок смещает что-то, чему в библиотеке нет названия. По этому не исправляйте; посмотрите, где и когда расхождение наибольшее.",
        ),
        Verdict::NoiseModelSuspect => Text::pair(
            "Look at the instrument and its set-up before the machine: the scatter is not what the file says, or the instrument itself moved.",
            "Прежде станка проверьте прибор и его установку: разброс не тот, что назван в файле, или сдвинулся сам прибор.",
        ),
        Verdict::Underpowered => Text::pair(
            "No cause is named, because none could be named safely. What is missing is said below.",
            "Причина не названа, потому что надёжно назвать её нельзя. Чего не хватает, сказано ниже.",
        ),
    }
}
