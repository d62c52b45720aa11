//! Forecast against what came of it on points that no fit has seen.

use diagnostic::{Text, both};
use gap_diagnosis::{Diagnosis, Holdout, Measurements};
use report::body::{Body, Table};
use report::chart::{Bar, Interval, cumulative, interval, waterfall};
use report::numbers::{number, percent};

use super::facts::Facts;

/// Most points in the table.
const MOST: usize = 100;

pub(super) fn unseen(out: &mut Body, d: &Diagnosis, holdout: Option<&Measurements>, facts: &Facts) {
    let Some(s) = d.causes.last().and_then(|last| last.shrink_predicted) else {
        return out.p(&both!("Without causes nothing is predicted.", "Без причин и прогноза нет."));
    };
    let forecast =
        Interval { low: s.low, mid: s.mid, high: s.high, achieved: d.holdout.as_ref().map(|h| h.shrink) };
    let title = both!("Shrinkage of the gap's RMS", "Уменьшение СКЗ расхождения");
    out.figure(
        &interval(out.language(), &title, &forecast),
        &both!(
            "How far the RMS of the gap shrinks with all causes in the model: 0 % nothing, 100 % all. The band is the 95 % interval of the forecast.",
            "На сколько уменьшается СКЗ расхождения со всеми причинами в модели: 0 % — нисколько, 100 % — полностью. Полоса — 95-процентный интервал прогноза."
        ),
    );
    let (Some(h), Some(points)) = (&d.holdout, holdout) else {
        return out.muted(&both!(
            "No unseen points were given. Measure some other lines and add --holdout FILE: only they prove the forecast.",
            "Новых точек не дано. Измерьте другие линии и добавьте --holdout FILE: только они докажут прогноз."
        ));
    };
    let (rows, name) = (h.rows, facts.holdout.as_ref().map_or("", |f| f.name.as_str()));
    let [before, after] = [h.rms_before_um, h.rms_after_um].map(number);
    let [shrink, mid, low, high] = [h.shrink, s.mid, s.low, s.high].map(percent);
    out.p(&both!(
        "On {rows} points of {name}, which no fit has seen: {before} to {after} \u{b5}m RMS, {shrink}; predicted were {mid} ({low} to {high}).",
        "На точках файла {name} (их {rows}), которых не было в подгонке: СКЗ с {before:#} до {after:#} мкм, {shrink:#}; прогноз был {mid:#} (от {low:#} до {high:#})."
    ));
    steps(out, h);
    points_of(out, h, points);
}

fn steps(out: &mut Body, h: &Holdout) {
    let bars: Vec<Bar> =
        h.steps.iter().map(|step| Bar { label: step.added.clone(), value: step.rms_um }).collect();
    let title =
        both!("RMS of the unseen points as the model grows", "СКЗ новых точек по мере пополнения модели");
    out.figure_of(
        &waterfall(out.language(), &title, &bars, None),
        &both!(
            "Each line adds one part to the model. A cause may make single steps worse that the next one makes good: only together they are the machine.",
            "Каждая строка добавляет в модель одну часть. Отдельный шаг может ухудшить то, что исправит следующий: станок — это только все они вместе."
        ),
        &Table::of(&bars)
            .words(both!("added", "добавлено"), |bar| bar.label.clone())
            .numbers(both!("RMS, \u{b5}m", "СКЗ, мкм"), |bar| number(bar.value)),
    );
}

fn points_of(out: &mut Body, h: &Holdout, points: &Measurements) {
    let size = |rows: &[gap_diagnosis::Residual], of: fn(&gap_diagnosis::Residual) -> f64| {
        rows.iter().map(|r| of(r) * of(r)).sum::<f64>().sqrt()
    };
    let sizes: Vec<(usize, f64, f64)> = h
        .residuals
        .chunk_by(|a, b| a.row == b.row)
        .map(|rows| (rows[0].row, size(rows, |r| r.before_um), size(rows, |r| r.after_um)))
        .collect();
    let sorted = |which: fn(&(usize, f64, f64)) -> f64| {
        let mut all: Vec<f64> = sizes.iter().map(which).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let mut table = Table::of(sizes.iter().take(MOST))
        .numbers(both!("line", "строка"), |(row, ..)| Text::same(points.rows[*row].line.to_string()));
    for (k, axis) in ["X", "Y", "Z"].into_iter().enumerate() {
        let title = both!("{axis}, mm", "{axis}, мм");
        table = table.numbers(title, |(row, ..)| number(points.rows[*row].command.linear_mm[k]));
    }
    let table = table
        .numbers(both!("before, \u{b5}m", "до, мкм"), |(_, before, _)| number(*before))
        .numbers(both!("after, \u{b5}m", "после, мкм"), |(.., after)| number(*after));
    let title = both!("Unseen points before and after", "Новые точки до и после");
    out.figure_of(
        &cumulative(out.language(), &title, &sorted(|s| s.1), &sorted(|s| s.2), None),
        &both!(
            "Share of the unseen points whose gap is smaller than the amount below.",
            "Доля новых точек, расхождение в которых меньше величины внизу."
        ),
        &table,
    );
}
