//! The page of an interferometer's runs: the diagram of ISO 230-2 for each axis, and its figures.

use calibration::iso230_2::Evaluation;
use diagnostic::{Text, both, russian_plural};
use report::body::{Body, Table};
use report::chart::{Band, Bands, bands};
use report::numbers::{digits, figures, measured, number, or_dash, percent, prose};
use report::page::Page;
use report::text::MICROMETRES;
use serde_json::Value;

use super::super::iso_report;
use super::facts::Facts;
use super::found::Found;
use super::runs::{Positions, Read, limits};
use crate::figures::short;

impl Found for Positions {
    fn title(&self) -> Text {
        let names: Vec<&str> = positions(&self.0).map(|r| r.name.as_str()).collect();
        if names.is_empty() {
            both!("Error functions", "Функции погрешностей")
        } else {
            both!("Positioning {}", "Позиционирование {}", names.join(", "))
        }
    }

    fn head(&self, out: &mut Body, facts: &Facts) {
        head(out, &self.0, facts);
    }

    fn sections(&self, page: &mut Page) {
        for read in positions(&self.0) {
            let title = both!("Positioning of {}", "Позиционирование {}", read.axis);
            axis(page.section(OF_AXES[read.axis.direction()], title), read);
        }
        let title = both!("Straightness and angles", "Прямолинейность и углы");
        others(page.section("others", title), &self.0);
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
fn um(mm: f64) -> Text {
    digits(mm * 1e3, 3)
}

/// An amount in a sentence, µm, with the digits that are read there; tables have [`um`].
fn said_um(mm: f64) -> Text {
    number(mm * 1e3)
}

/// A position with a real minus sign.
fn position(mm: f64) -> Text {
    figures(short(mm, 3).replacen('-', "\u{2212}", 1))
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
            Self::Scatter { .. } => both!("SCATTER", "РАЗБРОС"),
            Self::Reversal { .. } => both!("REVERSAL", "РЕВЕРС"),
            Self::Curve { .. } => both!("REPEATABLE CURVE", "ПОВТОРЯЮЩАЯСЯ КРИВАЯ"),
        }
    }

    /// What is wrong, and what to do about it.
    fn says(&self) -> Text {
        match self {
            Self::Scatter { r_mm, at_mm, from } => {
                let (at, r) = (position(*at_mm), said_um(*r_mm));
                both!(
                    "Most of it does not repeat: at {at} mm, reached from {from}, readings scatter by 4s = {r} \u{b5}m. No table corrects that. Run that target again; look at fixture, scale, bearings and drive before correcting.",
                    "Большая часть не повторяется: на {at:#} мм при подходе {from:#} разброс отсчётов 4s = {r:#} мкм. Таблицей это не исправить. Пройдите эту цель ещё раз; прежде чем исправлять, проверьте закрепление, шкалу, подшипники и привод."
                )
            }
            Self::Reversal { b_mm, at_mm } => {
                let (at, b) = (position(*at_mm), said_um(*b_mm));
                both!(
                    "Most of it is the direction: at {at} mm the axis stands {b} \u{b5}m apart by where it comes from. Look at nut, bearings and guideway; what repeats of it, tables of both directions correct.",
                    "Главное здесь — направление: на {at:#} мм ось в зависимости от стороны подхода стоит с разницей {b:#} мкм. Проверьте гайку, подшипники и направляющую; повторяющееся исправят таблицы для обоих направлений."
                )
            }
            Self::Curve { m_mm } => both!(
                "Most of it repeats: the mean of the readings wanders by M = {} \u{b5}m along the axis. A table corrects it.",
                "Большая часть повторяется: среднее отсчётов меняется вдоль оси на M = {:#} мкм. Это исправит таблица.",
                said_um(*m_mm)
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
fn head(out: &mut Body, all: &[Read], facts: &Facts) {
    let files = facts.names();
    out.muted(&both!("Positioning after ISO 230-2: {files}", "Позиционирование по ISO 230-2: {files}"));
    if let Some((read, e)) = worst(all) {
        let lead = Lead::of(e);
        let (axis, [a, spread]) = (read.axis, accuracy(e));
        out.verdict(
            &lead.word(),
            &both!(
                "{axis} positions within A = {a} \u{b5}m (\u{b1} {spread}, 95\u{a0}%)",
                "Точность позиционирования {axis}: A = {a:#} мкм (\u{b1} {spread:#}, 95\u{a0}%)"
            ),
        );
        out.p(&lead.says());
        out.p(&correction(read));
        for (other, e) in evaluated(all).filter(|(other, _)| other.axis != read.axis) {
            let (axis, [a, spread]) = (other.axis, accuracy(e));
            out.p(&both!(
                "{axis} positions within A = {a} \u{b5}m (\u{b1} {spread}).",
                "Точность позиционирования {axis}: A = {a:#} мкм (\u{b1} {spread:#})."
            ));
        }
    } else {
        out.verdict(
            &both!("NOT EVALUATED", "НЕ ОЦЕНЕНО"),
            &both!(
                "No runs were repeated: what was read is drawn, and nothing is said of repeatability or accuracy",
                "Проходы не повторялись: измеренное нарисовано, о повторяемости и точности ничего не сказано"
            ),
        );
        out.p(&both!(
            "Repeat the runs, five in each direction as ISO 230-2 asks, in one file or several.",
            "Повторите проходы, по пять в каждом направлении, как требует ISO 230-2, в одном файле или в нескольких."
        ));
    }
    for read in positions(all) {
        for missing in &read.missing {
            let (name, missing) = (&read.name, prose(missing));
            out.muted(&both!(
                "Not as the standard asks, {name}: {missing}.",
                "Не так, как требует стандарт, {name}: {missing:#}."
            ));
        }
    }
    facts.say_written(out);
}

/// A of the standard, and half the width of its interval, µm.
fn accuracy(e: &Evaluation) -> [Text; 2] {
    measured(e.accuracy.value * 1e3, e.accuracy.expanded * 1e3)
}

/// A spread this much larger is no chance of which run was left out.
const WORSE: f64 = 1.1;
/// A spread not smaller than this part of what it was is little gain.
const WORTH: f64 = 0.8;

/// What a correction will bring, by runs that it was not made of.
fn correction(read: &Read) -> Text {
    let Some(h) = read.held_out else {
        return both!(
            "What a correction will bring, one run in a direction cannot say: run it again.",
            "Что даст коррекция, один проход в направлении не скажет: пройдите ещё раз."
        );
    };
    let (axis, [after, before, rms]) = (read.axis, [h.after, h.before, h.after_rms].map(said_um));
    let words = both!(
        "Each run of {axis} corrected by the mean of the others: readings spread over {after} \u{b5}m instead of {before} (RMS {rms} \u{b5}m)",
        "Каждый проход {axis} исправлен по среднему остальных: размах отсчётов {after:#} мкм вместо {before:#} (СКЗ {rms:#} мкм)"
    );
    if h.after < WORTH * h.before {
        let gain = percent(1.0 - h.after / h.before);
        both!(
            "{words}. That is what a correction will bring: {gain} less.",
            "{words:#}. Это и даст коррекция: на {gain:#} меньше."
        )
    } else if h.after < WORSE * h.before {
        both!("{words}. A correction brings little.", "{words:#}. Коррекция почти ничего не даст.")
    } else {
        both!(
            "{words}. A correction by these runs would make it worse.",
            "{words:#}. Коррекция по этим проходам сделала бы хуже."
        )
    }
}

/// Ids of the axes' sections.
const OF_AXES: [&str; 3] = ["x", "y", "z"];

fn axis(out: &mut Body, read: &Read) {
    diagram(out, read);
    if read.is_direction_unsaid {
        out.muted(&both!(
            "The file does not say the direction of every reading: those without one are shown as up.",
            "Файл называет направление не каждого отсчёта: отсчёты без направления показаны как «вверх»."
        ));
    }
    let Some(e) = &read.evaluation else {
        out.p(&both!(
            "Each direction was run once: no scatter is known, so there are no limits in the drawing and no figures of ISO 230-2.",
            "В каждом направлении один проход: разброс неизвестен, поэтому на рисунке нет границ, а величин ISO 230-2 нет."
        ));
        return;
    };
    if e.runs.contains(&0) {
        out.p(&both!(
            "Runs in one direction only: of the other, and of the reversal value B, nothing is known. A, E, M and R are those of the direction that was run.",
            "Проходы только в одном направлении: о другом и о зоне нечувствительности (реверсе) B ничего не известно. A, E, M и R относятся к пройденному направлению."
        ));
    }
    results(out, e);
    out.heading(&both!("By target", "По целям"));
    targets(out, e);
}

/// Runs, means and the limits two standard deviations from them.
fn diagram(out: &mut Body, read: &Read) {
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
        let russian = russian_plural(count as u64, ["проход", "прохода", "проходов"]);
        Band {
            name: both!("{name}: {count} {plural}", "{name:#}: {count} {russian}"),
            mean,
            limits: several.map(|e| [micro(&limits(e, side, -2.0)), micro(&limits(e, side, 2.0))]),
            runs,
        }
    };
    let sides = [(0, &read.runs.positive, UP), (1, &read.runs.negative, DOWN)];
    let drawn = Bands {
        label: both!("target position of {}, mm", "положение цели {}, мм", read.axis),
        at: read.runs.targets.clone(),
        bands: sides.iter().filter(|(_, all, _)| !all.is_empty()).cloned().map(side).collect(),
        span: read.evaluation.as_ref().map(|e| Text::join([&Text::same("A"), &accuracy(e)[0]], " ")),
    };
    let caption = if read.evaluation.is_some() {
        both!(
            "Deviation, actual minus target. Thin: single runs; strong: their means; shaded: mean \u{b1} 2s; dashed: the limits between which A lies.",
            "Отклонение: действительное минус заданное. Тонкие линии — отдельные проходы; толстые — их средние; заливка — среднее \u{b1} 2s; штрих — границы, между которыми лежит A."
        )
    } else {
        both!(
            "Deviation, actual minus target, as it was read once.",
            "Отклонение: действительное минус заданное, по одному проходу."
        )
    };
    let title = both!("Positioning deviation {}", "Отклонение позиционирования {}", read.name);
    let target = both!("target, mm", "цель, мм");
    let mut readings =
        Table::of(read.runs.targets.iter().enumerate()).numbers(target, |(_, target)| position(**target));
    for (_, runs, name) in sides {
        for (k, run) in (1..).zip(runs) {
            readings = readings.numbers(both!("{name} {k}", "{name:#} {k}"), |(i, _)| um(run[*i]));
        }
    }
    out.figure_of(&bands(out.language(), &title, &drawn), &caption, &readings);
}

fn results(out: &mut Body, e: &Evaluation) {
    let place = |at: [f64; 2]| {
        let [a, b] = at.map(position);
        if a == b { a } else { both!("{a} and {b}", "{a:#} и {b:#}") }
    };
    let row = |f: iso_report::Figure| (f.symbol, f.found.value, Some(f.found), f.name);
    let name = || both!("mean reversal value", "средняя зона нечувствительности (реверс)");
    let mean = e.mean_reversal.map(|mean| ("B\u{304}", mean, None, name()));
    let table = Table::of(iso_report::figures(e).into_iter().map(row).chain(mean))
        .words(Text::EMPTY, |(symbol, ..)| Text::same(*symbol))
        .numbers(MICROMETRES.clone(), |(_, value, ..)| um(*value))
        .numbers(both!("\u{b1} 95 %, \u{b5}m", "\u{b1} 95 %, мкм"), |(_, _, found, _)| {
            found.map_or(Text::EMPTY, |found| um(found.expanded))
        })
        .numbers(both!("made at, mm", "получено на, мм"), |(_, _, found, _)| {
            found.map_or(Text::EMPTY, |found| place(found.at))
        })
        .words(Text::same("ISO 230-2"), |(.., name)| name.clone());
    out.table(&table);
}

fn targets(out: &mut Body, e: &Evaluation) {
    let cell = |value: Option<f64>| or_dash(value, um);
    let table = Table::of(&e.targets)
        .numbers(both!("target, mm", "цель, мм"), |t| position(t.position))
        .numbers(both!("mean up, \u{b5}m", "среднее вверх, мкм"), |t| {
            cell(t.positive.map(|a| a.mean))
        })
        .numbers(both!("mean down", "среднее вниз"), |t| cell(t.negative.map(|a| a.mean)))
        .numbers(Text::same("B"), |t| cell(t.reversal))
        .numbers(both!("s up", "s вверх"), |t| cell(t.positive.map(|a| a.deviation)))
        .numbers(both!("s down", "s вниз"), |t| cell(t.negative.map(|a| a.deviation)))
        .numbers(Text::same("R"), |t| um(t.repeatability));
    out.table(&table);
}

/// What was read beside positions: ISO 230-2 does not evaluate it.
fn others(out: &mut Body, all: &[Read]) {
    let rows: Vec<&Read> = all.iter().filter(|r| !r.is_positioning).collect();
    if rows.is_empty() {
        return;
    }
    let value = |read: &Read, v: f64| digits(v * read.scale().0, 3);
    let table = Table::of(rows)
        .words(both!("function", "функция"), |r| Text::same(&r.name))
        .numbers(both!("targets", "целей"), |r| Text::same(r.runs.targets.len().to_string()))
        .numbers(both!("runs", "проходов"), |r| {
            Text::same((r.runs.positive.len() + r.runs.negative.len()).to_string())
        })
        .numbers(both!("least mean", "наим. среднее"), |r| value(r, r.mean[0]))
        .numbers(both!("largest mean", "наиб. среднее"), |r| value(r, r.mean[1]))
        .numbers(both!("scatter (s)", "разброс (s)"), |r| or_dash(r.scatter, |s| value(r, s)))
        .words(Text::EMPTY, |r| r.scale().1);
    out.table(&table);
}
