//! The diagnosis as one page, in the order in which people ask: what, how much, where, how sure, what next, from what.

use diagnostic::{Language, Text, both};
use gap_diagnosis::{Diagnosis, Measurements, Verdict};
use report::body::Body;
use report::numbers::{count, number, percent, prose as said};
use report::page::Page;
use report::text::opening;

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
        let (d, data) = (self.diagnosis, self.data);
        let mut page = begun(self.language, d, self.facts);
        page.head.p(&meaning(d.verdict));
        gap(&mut page.head, d, self.facts);
        // Where too little was measured there is nothing to draw.
        let is_drawn = d.verdict != Verdict::Underpowered || !d.residuals.is_empty();
        if is_drawn {
            let rows = Rows::new(d, data);
            let shrinks = both!("How the gap shrinks", "Как уменьшается расхождение");
            causes::waterfall(page.section("waterfall", shrinks), d);
            causes::causes(page.section("causes", both!("Causes", "Причины")), d, self.changes);
            causes::places(page.section("where", both!("Where the gap lies", "Где расхождение")), d);
            let over =
                both!("The gap over place, time and conditions", "Расхождение по месту, времени и условиям");
            pictures::strips(page.section("strips", over), d, data, &rows);
            let vectors = both!("Error vectors", "Векторы погрешности");
            pictures::vectors(page.section("vectors", vectors), d, data, &rows);
            let slices = both!("Slices through the machine", "Сечения рабочего объёма");
            pictures::heat(page.section("slices", slices), d, data, &rows);
            let before_after = page.section("distribution", both!("Before and after", "До и после"));
            pictures::distribution(before_after, d, &rows, self.facts.tolerance_um);
            let alike = both!("What looks alike", "Что похоже друг на друга");
            causes::confounding(page.section("confounding", alike), d);
            let unseen = page.section("unseen", both!("Predicted and achieved", "Прогноз и результат"));
            unseen::unseen(unseen, d, self.holdout, self.facts);
        }
        causes::next(page.section("next", both!("What to measure next", "Что измерить дальше")), d);
        if is_drawn {
            causes::outliers(page.section("outliers", both!("Rows left out", "Отброшенные строки")), d);
        }
        provenance::more(page.provenance(provenance::facts(self.facts)), d);
        page.into_html(self.json)
    }
}

/// A page with what the first screen says: in a word, in a sentence, in words.
pub(in crate::diagnose) fn begun(language: Language, d: &Diagnosis, facts: &Facts) -> Page {
    let (verdict, machine) = (d.verdict.words(), &facts.machine);
    let title = both!("{verdict} \u{2013} {machine}", "{verdict:#} \u{2014} {machine}");
    let mut page = Page::new(language, title, "diagnose", "vpost.diagnosis/1");
    let out = &mut page.head;
    let (machine, file) = (&facts.machine, &facts.measurements.name);
    out.muted(&both!(
        "Simulation against reality: {machine}, {file}",
        "Модель и действительность: {machine}, {file}"
    ));
    out.verdict(&d.verdict.words(), &prose(&d.sentence));
    if let Some(words) = in_words(d) {
        out.p(&opening(&words));
    }
    page
}

/// How large the gap is, and what becomes of it.
pub(in crate::diagnose) fn gap(out: &mut Body, d: &Diagnosis, facts: &Facts) {
    let g = &d.gap;
    if g.rms_um > 0.0 {
        let [rms, p95, largest, noise] = [g.rms_um, g.p95_um, g.max_um, g.noise_um].map(number);
        let rows = count(g.rows);
        out.muted(&both!(
            "{rms} \u{b5}m RMS, 95 % below {p95} \u{b5}m, largest {largest} \u{b5}m, noise of a reading {noise} \u{b5}m, {rows} rows.",
            "СКЗ {rms:#} мкм, 95 % ниже {p95:#} мкм, наибольшее {largest:#} мкм, шум отсчёта {noise:#} мкм, строк {rows:#}."
        ));
    }
    if let Some(gain) = gain(d) {
        out.p(&gain);
    }
    out.muted(&facts.origin.said());
}

/// Causes that are said in words on the first screen.
const IN_WORDS: usize = 3;

/// The largest causes in words.
fn in_words(d: &Diagnosis) -> Option<Text> {
    let words: Vec<Text> = d.causes.iter().take(IN_WORDS).map(|c| said(&c.words)).collect();
    let (words, more) = (Text::join(&words, "; "), d.causes.len().saturating_sub(IN_WORDS));
    match (d.causes.len(), more) {
        (0, _) => None,
        (_, 0) => Some(both!("{words}.", "{words:#}.")),
        _ => Some(both!("{words}; {more} more below.", "{words:#}; ещё причин ниже: {more}.")),
    }
}

/// What a correction by the causes will bring, and what unseen rows say of it.
fn gain(d: &Diagnosis) -> Option<Text> {
    let shrink = d.causes.last()?.shrink_predicted;
    let proof = match &d.holdout {
        Some(held) => {
            let kept = percent(held.shrink);
            both!("On unseen rows it shrank by {kept}.", "На новых строках оно уменьшилось на {kept:#}.")
        }
        None => both!(
            "No unseen rows prove it: add --holdout FILE.",
            "Новыми строками это не проверено: добавьте --holdout FILE."
        ),
    };
    let Some(s) = shrink else { return Some(proof) };
    let [low, mid, high] = [s.low, s.mid, s.high].map(percent);
    Some(both!(
        "With the causes in the profile the gap is forecast to shrink by {mid} ({low} to {high}). {proof}",
        "С причинами в профиле расхождение, по прогнозу, уменьшится на {mid:#} (от {low:#} до {high:#}). {proof:#}"
    ))
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
