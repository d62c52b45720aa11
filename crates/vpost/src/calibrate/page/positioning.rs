//! The page of an interferometer's runs: the diagram of ISO 230-2 for each axis, and its figures.

use calibration::iso230_2::{Evaluation, Target};
use diagnostic::{Language, Text, both, say};
use maud::{Markup, html};
use report::chart::{Band, Bands, bands};
use report::page::{Section, figure, table};
use report::text::{MICROMETRES, Numbers, shown};
use serde_json::Value;

use super::super::iso_report;
use super::facts::Facts;
use super::found::Found;
use super::runs::{Positions, Read, limits};
use crate::file;
use crate::number::short;

impl Found for Positions {
    fn title(&self, language: Language) -> String {
        title(&self.0, language)
    }

    fn head(&self, facts: &Facts, language: Language) -> Markup {
        head(&self.0, facts, language)
    }

    fn sections(&self, language: Language) -> Vec<Section> {
        sections(&self.0, language)
    }

    fn json(&self) -> Value {
        Self::json(self)
    }

    fn csv(&self) -> String {
        Self::csv(self)
    }
}

/// Directions of the runs.
const UP: Text = Text::pair("up", "вверх");
const DOWN: Text = Text::pair("down", "вниз");

/// As many digits as the command prints.
fn um(mm: f64, language: Language) -> String {
    language.digits(mm * 1e3, 3)
}

/// An amount in a sentence, µm, with the digits that are read there; tables have [`um`].
fn said_um(mm: f64, language: Language) -> String {
    language.number(mm * 1e3)
}

/// A position with a real minus sign.
fn position(mm: f64, language: Language) -> String {
    language.figures(short(mm, 3).replacen('-', "\u{2212}", 1))
}

fn title(all: &[Read], language: Language) -> String {
    let names: Vec<&str> = positions(all).map(|r| r.name.as_str()).collect();
    if names.is_empty() {
        say!(language, "Error functions", "Функции погрешностей")
    } else {
        say!(language, "Positioning {}", "Позиционирование {}", names.join(", "))
    }
}

fn positions(all: &[Read]) -> impl Iterator<Item = &Read> {
    all.iter().filter(|r| r.is_positioning)
}

/// What most of an axis' deviation is.
enum Lead {
    /// Readings at one target and from one side scatter.
    Scatter { r_mm: f64, at_mm: f64, from: Text },
    /// Both directions differ.
    Reversal { b_mm: f64, at_mm: f64 },
    /// The mean wanders along the axis.
    Curve { m_mm: f64 },
}

impl Lead {
    /// The largest of the three.
    fn of(e: &Evaluation) -> Self {
        let mut scatter = (0.0, 0.0, Text::pair("below", "снизу"));
        for t in &e.targets {
            for (approach, from) in
                [(t.positive, Text::pair("below", "снизу")), (t.negative, Text::pair("above", "сверху"))]
            {
                if let Some(a) = approach.filter(|a| a.repeatability > scatter.0) {
                    scatter = (a.repeatability, t.position, from);
                }
            }
        }
        let m_mm = e.mean_range.value;
        let reversal = e.reversal.map_or((0.0, 0.0), |b| (b.value, b.at[0]));
        if scatter.0 >= m_mm.max(reversal.0) {
            Self::Scatter { r_mm: scatter.0, at_mm: scatter.1, from: scatter.2 }
        } else if reversal.0 >= m_mm {
            Self::Reversal { b_mm: reversal.0, at_mm: reversal.1 }
        } else {
            Self::Curve { m_mm }
        }
    }

    fn word(&self) -> Text {
        match self {
            Self::Scatter { .. } => Text::pair("SCATTER", "РАЗБРОС"),
            Self::Reversal { .. } => Text::pair("REVERSAL", "РЕВЕРС"),
            Self::Curve { .. } => Text::pair("REPEATABLE CURVE", "ПОВТОРЯЮЩАЯСЯ КРИВАЯ"),
        }
    }

    /// What is wrong, and what to do about it.
    fn says(&self, language: Language) -> String {
        match self {
            Self::Scatter { r_mm, at_mm, from } => say!(
                language,
                "Most of it does not repeat: at {} mm, reached from {from}, readings scatter by 4s = {} \u{b5}m. No table corrects that. Run that target again; look at fixture, scale, bearings and drive before correcting.",
                "Большая часть не повторяется: на {} мм при подходе {from:#} разброс отсчётов 4s = {} мкм. Таблицей это не исправить. Пройдите эту цель ещё раз; прежде чем исправлять, проверьте закрепление, шкалу, подшипники и привод.",
                position(*at_mm, language),
                said_um(*r_mm, language)
            ),
            Self::Reversal { b_mm, at_mm } => say!(
                language,
                "Most of it is the direction: at {} mm the axis stands {} \u{b5}m apart by where it comes from. Look at nut, bearings and guideway; what repeats of it, tables of both directions correct.",
                "Главное здесь — направление: на {} мм ось в зависимости от стороны подхода стоит с разницей {} мкм. Проверьте гайку, подшипники и направляющую; повторяющееся исправят таблицы для обоих направлений.",
                position(*at_mm, language),
                said_um(*b_mm, language)
            ),
            Self::Curve { m_mm } => say!(
                language,
                "Most of it repeats: the mean of the readings wanders by M = {} \u{b5}m along the axis. A table corrects it.",
                "Большая часть повторяется: среднее отсчётов меняется вдоль оси на M = {} мкм. Это исправит таблица.",
                said_um(*m_mm, language)
            ),
        }
    }
}

/// The axis with the largest accuracy; without figures there is none.
fn worst(all: &[Read]) -> Option<(&Read, &Evaluation)> {
    evaluated(all).max_by(|a, b| a.1.accuracy.value.total_cmp(&b.1.accuracy.value))
}

/// The axes of which runs were repeated.
fn evaluated(all: &[Read]) -> impl Iterator<Item = (&Read, &Evaluation)> {
    positions(all).filter_map(|r| Some((r, r.evaluation.as_ref()?)))
}

/// The first screen.
fn head(all: &[Read], facts: &Facts, language: Language) -> Markup {
    let written = facts.written.as_ref().map(|path| file::name(path));
    html! {
        p.muted { (say!(language, "Positioning after ISO 230-2: ", "Позиционирование по ISO 230-2: ")) (shown(&facts.names())) }
        @match worst(all) {
            Some((read, e)) => {
                @let lead = Lead::of(e);
                @let [a, spread] = language.measured(e.accuracy.value * 1e3, e.accuracy.expanded * 1e3);
                p { span.verdict { (lead.word().in_language(language)) } }
                h1 {
                    (say!(
                        language,
                        "{} positions within A = {a} \u{b5}m (\u{b1} {spread}, 95\u{a0}%)",
                        "Точность позиционирования {}: A = {a} мкм (\u{b1} {spread}, 95\u{a0}%)",
                        read.axis
                    ))
                }
                p { (lead.says(language)) }
                p { (correction(read, language)) }
                @for (other, e) in evaluated(all).filter(|(other, _)| other.axis != read.axis) {
                    @let [a, spread] = language.measured(e.accuracy.value * 1e3, e.accuracy.expanded * 1e3);
                    p {
                        (say!(
                            language,
                            "{} positions within A = {a} \u{b5}m (\u{b1} {spread}).",
                            "Точность позиционирования {}: A = {a} мкм (\u{b1} {spread}).",
                            other.axis
                        ))
                    }
                }
            }
            None => {
                p { span.verdict { (say!(language, "NOT EVALUATED", "НЕ ОЦЕНЕНО")) } }
                h1 {
                    (say!(
                        language,
                        "No runs were repeated: what was read is drawn, and nothing is said of repeatability or accuracy",
                        "Проходы не повторялись: измеренное нарисовано, о повторяемости и точности ничего не сказано"
                    ))
                }
                p {
                    (say!(
                        language,
                        "Repeat the runs, five in each direction as ISO 230-2 asks, in one file or several.",
                        "Повторите проходы, по пять в каждом направлении, как требует ISO 230-2, в одном файле или в нескольких."
                    ))
                }
            }
        }
        @for read in positions(all) {
            @for missing in &read.missing { p.muted {
                    (say!(language, "Not as the standard asks, {}: ", "Не так, как требует стандарт, {}: ", read.name))
                    (shown(&language.prose(missing))) "."
                } }
        }
        @match written {
            Some(name) => p { (super::written_to(&name, language)) },
            None => p.muted { (super::NOT_WRITTEN.in_language(language)) },
        }
    }
}

/// A spread this much larger is no chance of which run was left out.
const WORSE: f64 = 1.1;
/// A spread not smaller than this part of what it was is little gain.
const WORTH: f64 = 0.8;

/// What a correction will bring, by runs that it was not made of.
fn correction(read: &Read, language: Language) -> String {
    let Some(h) = read.held_out else {
        return say!(
            language,
            "What a correction will bring, one run in a direction cannot say: run it again.",
            "Что даст коррекция, один проход в направлении не скажет: пройдите ещё раз."
        );
    };
    let words = say!(
        language,
        "Each run of {} corrected by the mean of the others: readings spread over {} \u{b5}m instead of {} (RMS {} \u{b5}m)",
        "Каждый проход {} исправлен по среднему остальных: размах отсчётов {} мкм вместо {} (СКЗ {} мкм)",
        read.axis,
        said_um(h.after, language),
        said_um(h.before, language),
        said_um(h.after_rms, language)
    );
    if h.after < WORTH * h.before {
        let gain = language.percent(1.0 - h.after / h.before);
        say!(
            language,
            "{words}. That is what a correction will bring: {gain} less.",
            "{words}. Это и даст коррекция: на {gain} меньше."
        )
    } else if h.after < WORSE * h.before {
        say!(language, "{words}. A correction brings little.", "{words}. Коррекция почти ничего не даст.")
    } else {
        say!(
            language,
            "{words}. A correction by these runs would make it worse.",
            "{words}. Коррекция по этим проходам сделала бы хуже."
        )
    }
}

/// Ids of the axes' sections.
const OF_AXES: [&str; 3] = ["x", "y", "z"];

fn sections(all: &[Read], language: Language) -> Vec<Section> {
    let mut out: Vec<Section> = positions(all)
        .map(|read| {
            let title = both!("Positioning of {}", "Позиционирование {}", read.axis);
            Section { id: OF_AXES[read.axis.direction()], title, body: axis(read, language) }
        })
        .collect();
    if all.iter().any(|r| !r.is_positioning) {
        out.push(Section {
            id: "others",
            title: Text::pair("Straightness and angles", "Прямолинейность и углы"),
            body: others(all, language),
        });
    }
    out
}

fn axis(read: &Read, language: Language) -> Markup {
    html! {
        (diagram(read, language))
        @if read.is_direction_unsaid {
            p.muted {
                (say!(
                    language,
                    "The file does not say the direction of every reading: those without one are shown as up.",
                    "Файл называет направление не каждого отсчёта: отсчёты без направления показаны как «вверх»."
                ))
            }
        }
        @match &read.evaluation {
            Some(e) => {
                @if e.runs.contains(&0) {
                    p {
                        (say!(
                            language,
                            "Runs in one direction only: of the other, and of the reversal value B, nothing is known. A, E, M and R are those of the direction that was run.",
                            "Проходы только в одном направлении: о другом и о зоне нечувствительности (реверсе) B ничего не известно. A, E, M и R относятся к пройденному направлению."
                        ))
                    }
                }
                (results(e, language))
                h3 { (say!(language, "By target", "По целям")) }
                (targets(e, language))
            }
            None => p {
                (say!(
                    language,
                    "Each direction was run once: no scatter is known, so there are no limits in the drawing and no figures of ISO 230-2.",
                    "В каждом направлении один проход: разброс неизвестен, поэтому на рисунке нет границ, а величин ISO 230-2 нет."
                ))
            },
        }
    }
}

/// Runs, means and the limits two standard deviations from them.
fn diagram(read: &Read, language: Language) -> Markup {
    let micro = |values: &[f64]| -> Vec<f64> { values.iter().map(|v| v * 1e3).collect() };
    let side = |(side, all, name): (usize, &Vec<Vec<f64>>, Text)| {
        let runs: Vec<Vec<f64>> = all.iter().map(|run| micro(run)).collect();
        let count = all.len();
        let several = read.evaluation.as_ref().filter(|_| count > 1);
        let mean = match &read.evaluation {
            Some(e) => micro(&limits(e, side, 0.0)),
            None => runs.first().cloned().unwrap_or_default(),
        };
        let plural = if count == 1 { "run" } else { "runs" };
        let russian = diagnostic::russian_plural(count as u64, ["проход", "прохода", "проходов"]);
        Band {
            name: say!(language, "{name}: {count} {plural}", "{name:#}: {count} {russian}"),
            mean,
            limits: several.map(|e| [micro(&limits(e, side, -2.0)), micro(&limits(e, side, 2.0))]),
            runs,
        }
    };
    let both = [(0, &read.runs.positive, UP), (1, &read.runs.negative, DOWN)];
    let drawn = Bands {
        label: say!(language, "target position of {}, mm", "положение цели {}, мм", read.axis),
        at: read.runs.targets.clone(),
        bands: both.into_iter().filter(|(_, all, _)| !all.is_empty()).map(side).collect(),
        span: read.evaluation.as_ref().map(|e| {
            let [a, _] = language.measured(e.accuracy.value * 1e3, e.accuracy.expanded * 1e3);
            format!("A {a}")
        }),
    };
    let caption = if read.evaluation.is_some() {
        say!(
            language,
            "Deviation, actual minus target. Thin: single runs; strong: their means; shaded: mean \u{b1} 2s; dashed: the limits between which A lies.",
            "Отклонение: действительное минус заданное. Тонкие линии — отдельные проходы; толстые — их средние; заливка — среднее \u{b1} 2s; штрих — границы, между которыми лежит A."
        )
    } else {
        say!(
            language,
            "Deviation, actual minus target, as it was read once.",
            "Отклонение: действительное минус заданное, по одному проходу."
        )
    };
    let name = say!(language, "Positioning deviation {}", "Отклонение позиционирования {}", read.name);
    let unit = MICROMETRES.in_language(language);
    figure(language, &bands(language, &name, &drawn, unit), &caption, Some(readings(read, language)))
}

/// Every reading.
fn readings(read: &Read, language: Language) -> Markup {
    let runs = || {
        let of = |all: &'_ [Vec<f64>], name: Text| {
            let name = name.in_language(language).to_owned();
            (0..all.len()).map(|k| format!("{name} {}", k + 1)).collect::<Vec<_>>()
        };
        [of(&read.runs.positive, UP), of(&read.runs.negative, DOWN)].concat()
    };
    let names = runs();
    let target = say!(language, "target, mm", "цель, мм");
    let header: Vec<&str> =
        std::iter::once(target.as_str()).chain(names.iter().map(String::as_str)).collect();
    let numbers: Vec<usize> = (0..header.len()).collect();
    let row = |(i, target): (usize, &f64)| {
        let values = read.runs.positive.iter().chain(&read.runs.negative).map(|run| um(run[i], language));
        std::iter::once(position(*target, language)).chain(values).collect()
    };
    let rows: Vec<Vec<String>> = read.runs.targets.iter().enumerate().map(row).collect();
    table(language, &header, &numbers, &rows)
}

fn results(e: &Evaluation, language: Language) -> Markup {
    let place = |at: [f64; 2]| {
        let [a, b] = at.map(|mm| position(mm, language));
        if a == b { a } else { say!(language, "{a} and {b}", "{a} и {b}") }
    };
    let row = |f: iso_report::Figure| {
        vec![
            f.symbol.to_owned(),
            um(f.found.value, language),
            um(f.found.expanded, language),
            place(f.found.at),
            f.name.in_language(language).to_owned(),
        ]
    };
    let mut rows: Vec<Vec<String>> = iso_report::figures(e).into_iter().map(row).collect();
    if let Some(mean) = e.mean_reversal {
        let name = say!(language, "mean reversal value", "средняя зона нечувствительности (реверс)");
        rows.push(vec!["B\u{304}".to_owned(), um(mean, language), String::new(), String::new(), name]);
    }
    let header = match language {
        Language::English => ["", "\u{b5}m", "\u{b1} 95 %, \u{b5}m", "made at, mm", "ISO 230-2"],
        Language::Russian => ["", "мкм", "\u{b1} 95 %, мкм", "получено на, мм", "ISO 230-2"],
    };
    table(language, &header, &[1, 2, 3], &rows)
}

fn targets(e: &Evaluation, language: Language) -> Markup {
    let cell = |value: Option<f64>| value.map_or_else(|| "\u{2014}".to_owned(), |mm| um(mm, language));
    let row = |t: &Target| {
        vec![
            position(t.position, language),
            cell(t.positive.map(|a| a.mean)),
            cell(t.negative.map(|a| a.mean)),
            cell(t.reversal),
            cell(t.positive.map(|a| a.deviation)),
            cell(t.negative.map(|a| a.deviation)),
            um(t.repeatability, language),
        ]
    };
    let rows: Vec<Vec<String>> = e.targets.iter().map(row).collect();
    let header = match language {
        Language::English => ["target, mm", "mean up, \u{b5}m", "mean down", "B", "s up", "s down", "R"],
        Language::Russian => {
            ["цель, мм", "среднее вверх, мкм", "среднее вниз", "B", "s вверх", "s вниз", "R"]
        }
    };
    table(language, &header, &[0, 1, 2, 3, 4, 5, 6], &rows)
}

/// What was read beside positions: ISO 230-2 does not evaluate it.
fn others(all: &[Read], language: Language) -> Markup {
    let row = |read: &Read| {
        let (scale, unit) = read.scale(language);
        let value = |v: f64| language.digits(v * scale, 3);
        vec![
            read.name.clone(),
            read.runs.targets.len().to_string(),
            (read.runs.positive.len() + read.runs.negative.len()).to_string(),
            value(read.mean[0]),
            value(read.mean[1]),
            read.scatter.map_or_else(|| "\u{2014}".to_owned(), value),
            unit,
        ]
    };
    let rows: Vec<Vec<String>> = all.iter().filter(|r| !r.is_positioning).map(row).collect();
    let header = match language {
        Language::English => ["function", "targets", "runs", "least mean", "largest mean", "scatter (s)", ""],
        Language::Russian => {
            ["функция", "целей", "проходов", "наим. среднее", "наиб. среднее", "разброс (s)", ""]
        }
    };
    table(language, &header, &[1, 2, 3, 4, 5], &rows)
}
