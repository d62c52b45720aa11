//! The rows themselves: over place, time and conditions, as vectors, as slices, as a distribution.

use diagnostic::{Language, Text, say};
use gap_diagnosis::{Diagnosis, Measurements, Row as Measured};
use maud::{Markup, html};
use report::chart::{Amounts, Arrow, Panel, Points, Slice, View, cumulative, panels, slices, views};
use report::page::{figure, table};
use report::scale::nice;
use report::text::{MICROMETRES, Numbers};

use super::rows::Rows;

/// Rows drawn of a long file: more would only cover each other.
const MOST_DOTS: usize = 240;
const MOST_ARROWS: usize = 220;
/// Cells of a slice along each axis.
const CELLS: usize = 6;
/// A slice that a line only pierces shows nothing.
const LEAST_CELLS: usize = 3;
/// Slices along each axis.
const CUTS: usize = 3;
const NAMES: [&str; 3] = ["X", "Y", "Z"];

/// What the residuals may go with.
type Variable = (Text, fn(&Measured) -> Option<f64>);
const VARIABLES: [Variable; 11] = [
    (Text::pair("X, mm", "X, мм"), |r| Some(r.command.linear_mm.x)),
    (Text::pair("Y, mm", "Y, мм"), |r| Some(r.command.linear_mm.y)),
    (Text::pair("Z, mm", "Z, мм"), |r| Some(r.command.linear_mm.z)),
    (Text::pair("A, degrees", "A, градусы"), |r| Some(r.command.rotary_rad.x.to_degrees())),
    (Text::pair("B, degrees", "B, градусы"), |r| Some(r.command.rotary_rad.y.to_degrees())),
    (Text::pair("C, degrees", "C, градусы"), |r| Some(r.command.rotary_rad.z.to_degrees())),
    (Text::pair("time, min", "время, мин"), |r| r.conditions.time_s.map(|t| t / 60.0)),
    (Text::pair("feed, mm/min", "подача, мм/мин"), |r| r.conditions.feed_mm_min),
    (Text::pair("temperature, \u{b0}C", "температура, \u{b0}C"), |r| {
        r.conditions.temp_c.iter().flatten().next().copied()
    }),
    (Text::pair("load, kg", "нагрузка, кг"), |r| r.conditions.load_kg),
    (Text::pair("tool vector Z, mm", "вектор инструмента Z, мм"), |r| {
        Some(r.command.tool_mm.z)
    }),
];
const COMPONENTS: [(&str, Text); 4] = [
    ("k0", Text::pair("dx", "dx")),
    ("k1", Text::pair("dy", "dy")),
    ("k2", Text::pair("dz", "dz")),
    ("k3", Text::pair("along the reading", "вдоль отсчёта")),
];

/// Residuals over everything that varies.
pub(super) fn strips(
    d: &Diagnosis,
    data: &Measurements,
    rows: &Rows<'_>,
    language: Language,
) -> Option<Markup> {
    let drawn = rows.thinned(MOST_DOTS);
    let equations = || drawn.iter().flat_map(|r| r.equations);
    let reach = equations().map(|r| r.before_um.abs().max(r.after_um.abs())).fold(0.0, f64::max);
    let classes: Vec<usize> = (0..4).filter(|class| equations().any(|r| r.class == *class)).collect();
    if classes.is_empty() {
        return None;
    }
    let both = !d.causes.is_empty();
    let mut all = Vec::new();
    for (label, value) in VARIABLES {
        let known = || rows.all.iter().filter_map(|r| value(&data.rows[r.row]));
        let range = known().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if range.1 <= range.0 || !range.0.is_finite() {
            continue;
        }
        let panel = |after: bool| {
            let points = |class: &usize| {
                let of_class = equations().filter(|r| r.class == *class);
                let at = of_class.filter_map(|r| {
                    value(&data.rows[r.row]).map(|v| (v, if after { r.after_um } else { r.before_um }))
                });
                Points { series: *class, at: at.collect() }
            };
            Panel {
                label: label.in_language(language).to_owned(),
                range,
                points: classes.iter().map(points).collect(),
            }
        };
        all.push(if both { vec![panel(false), panel(true)] } else { vec![panel(false)] });
    }
    let columns: &[Text] = if both {
        &[Text::pair("before", "до"), Text::pair("after", "после")]
    } else {
        &[Text::pair("gap", "расхождение")]
    };
    let columns: Vec<&str> = columns.iter().map(|text| text.in_language(language)).collect();
    let components = COMPONENTS;
    let legend: Vec<(&str, &str)> = classes
        .iter()
        .map(|c| &components[*c])
        .map(|(class, words)| (*class, words.in_language(language)))
        .collect();
    let title =
        say!(language, "Gap over place, time and conditions", "Расхождение по месту, времени и условиям");
    let unit = MICROMETRES.in_language(language);
    let drawing = panels(language, &title, &columns, &all, reach, &legend, unit);
    Some(figure(language, &drawing, &thinning(drawn.len(), rows, language), None))
}

fn thinning(drawn: usize, rows: &Rows<'_>, language: Language) -> String {
    let (is_whole, drawn, all) =
        (drawn == rows.all.len(), language.count(drawn), language.count(rows.all.len()));
    if is_whole {
        return say!(language, "All {all} rows that were used.", "Все использованные строки: {all}.");
    }
    say!(
        language,
        "{drawn} of {all} rows are drawn, those with the largest gap among them; all numbers on this page are of all rows.",
        "Нарисовано строк: {drawn} из {all}, в том числе с наибольшим расхождением; все числа на странице — по всем строкам."
    )
}

/// Error vectors in three views.
pub(super) fn vectors(
    d: &Diagnosis,
    data: &Measurements,
    rows: &Rows<'_>,
    language: Language,
) -> Option<Markup> {
    let drawn = rows.thinned(MOST_ARROWS);
    let mut lengths: Vec<f64> = drawn.iter().map(|r| r.vectors_um().0.norm()).collect();
    lengths.sort_by(f64::total_cmp);
    let typical_mm = 1e-3 * lengths.get(lengths.len() * 19 / 20).copied().filter(|l| *l > 0.0)?;
    let widest_mm = rows.ranges_mm.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let magnification = below(0.14 * widest_mm / typical_mm);
    let scale = 1e-3 * magnification;
    let view = |(right, up): (usize, usize)| View {
        axes: [NAMES[right], NAMES[up]],
        ranges: [rows.ranges_mm[right], rows.ranges_mm[up]],
        arrows: drawn
            .iter()
            .map(|r| {
                let q = data.rows[r.row].command.linear_mm;
                let (before, after) = r.vectors_um();
                // Without causes there is no after.
                let after = if d.causes.is_empty() { before } else { after };
                Arrow {
                    at: (q[right], q[up]),
                    before: (scale * before[right], scale * before[up]),
                    after: (scale * after[right], scale * after[up]),
                }
            })
            .collect(),
    };
    let planes = [(0, 1), (0, 2), (1, 2)].into_iter().filter(|(a, b)| rows.moves(*a) || rows.moves(*b));
    let all: Vec<View> = planes.map(view).collect();
    if all.is_empty() {
        return None;
    }
    let (times, thinning) = (language.number(magnification), thinning(drawn.len(), rows, language));
    let caption = say!(
        language,
        "Errors are drawn {times} times their size. {thinning}",
        "Увеличение погрешностей: {times}\u{d7}. {thinning}"
    );
    let title = say!(language, "Error vectors", "Векторы погрешности");
    Some(figure(language, &views(language, &title, &all, magnification), &caption, None))
}

/// The largest of 1, 2, 5, 10 … that is not above a value.
fn below(value: f64) -> f64 {
    let above = nice(value);
    if above > 1.001 * value { nice(above / 2.5) } else { above }
}

/// Mean gap over slices, before and after, on one scale.
pub(super) fn heat(
    d: &Diagnosis,
    data: &Measurements,
    rows: &Rows<'_>,
    language: Language,
) -> Option<Markup> {
    let planes: Vec<(usize, usize, usize)> = [(0, 1, 2), (0, 2, 1), (1, 2, 0)]
        .into_iter()
        .filter(|(a, b, _)| rows.moves(*a) && rows.moves(*b))
        .collect();
    if planes.is_empty() {
        return None;
    }
    let cut = |axis: usize, value: f64, count: usize| {
        let (low, high) = rows.ranges_mm[axis];
        if high > low { (((value - low) / (high - low) * count as f64) as usize).min(count - 1) } else { 0 }
    };
    let before_title = say!(language, ", before", ", до");
    let after_title = say!(language, ", after", ", после");
    let mut pairs: Vec<[Slice; 2]> = Vec::new();
    for (right, up, through) in planes {
        let cuts = if rows.moves(through) { CUTS } else { 1 };
        for k in 0..cuts {
            let mut sums = vec![(0.0, 0.0, 0.0); CELLS * CELLS];
            for r in &rows.all {
                let q = data.rows[r.row].command.linear_mm;
                if cut(through, q[through], cuts) == k {
                    let (before, after) = r.sizes_um();
                    let cell = &mut sums[cut(up, q[up], CELLS) * CELLS + cut(right, q[right], CELLS)];
                    *cell = (cell.0 + before * before, cell.1 + after * after, cell.2 + 1.0);
                }
            }
            if sums.iter().filter(|s| s.2 > 0.5).count() < LEAST_CELLS {
                continue;
            }
            let (low, high) = rows.ranges_mm[through];
            let edge = |j: usize| language.digits(low + (high - low) * j as f64 / cuts as f64, 0);
            let place = if cuts > 1 {
                let (axis, from, to) = (NAMES[through], edge(k), edge(k + 1));
                say!(language, "{axis} {from} to {to} mm", "{axis} {from}\u{2026}{to} мм")
            } else {
                say!(language, "{} {} mm", "{} {} мм", NAMES[through], language.digits(low, 0))
            };
            let slice = |when: &str, value: &dyn Fn(&(f64, f64, f64)) -> f64| Slice {
                title: format!("{place}{when}"),
                axes: [NAMES[right], NAMES[up]],
                ranges: [rows.ranges_mm[right], rows.ranges_mm[up]],
                cells: [CELLS, CELLS],
                values: sums.iter().map(|s| (s.2 > 0.5).then(|| (value(s) / s.2).sqrt())).collect(),
            };
            pairs.push([slice(&before_title, &|s| s.0), slice(&after_title, &|s| s.1)]);
        }
    }
    if pairs.is_empty() {
        return None;
    }
    let largest = pairs.iter().flat_map(|p| &p[0].values).flatten().copied().fold(0.0, f64::max);
    let (before, after): (Vec<Slice>, Vec<Slice>) = pairs.into_iter().map(|[a, b]| (a, b)).unzip();
    let numbers: Vec<Vec<String>> = before
        .iter()
        .zip(&after)
        .map(|(b, a)| {
            let worst = |s: &Slice| language.number(s.values.iter().flatten().copied().fold(0.0, f64::max));
            vec![b.title.trim_end_matches(&before_title).to_owned(), worst(b), worst(a)]
        })
        .collect();
    let shown = if d.causes.is_empty() { before } else { before.into_iter().chain(after).collect() };
    let title = say!(
        language,
        "RMS of the gap over slices through the machine",
        "СКЗ расхождения в сечениях рабочего объёма"
    );
    let amounts = Amounts { largest, within: None, unit: MICROMETRES.in_language(language) };
    let header = match language {
        Language::English => ["slice", "worst cell before, \u{b5}m", "worst cell after, \u{b5}m"],
        Language::Russian => ["сечение", "худшая клетка до, мкм", "худшая клетка после, мкм"],
    };
    Some(figure(
        language,
        &slices(language, &title, &shown, &amounts),
        &say!(
            language,
            "RMS of the gap in each cell, one scale for all slices. Cells without rows were not measured; nothing is filled in between.",
            "СКЗ расхождения в каждой клетке, шкала для всех сечений одна. Клетки без строк не измерялись; между ними ничего не достроено."
        ),
        Some(table(language, &header, &[1, 2], &numbers)),
    ))
}

/// How many rows lie below an amount.
pub(super) fn distribution(
    d: &Diagnosis,
    rows: &Rows<'_>,
    tolerance_um: f64,
    language: Language,
) -> Option<Markup> {
    let sorted = |which: &dyn Fn((f64, f64)) -> f64| {
        let mut all: Vec<f64> = rows.all.iter().map(|r| which(r.sizes_um())).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let before = sorted(&|s| s.0);
    let after = if d.causes.is_empty() { before.clone() } else { sorted(&|s| s.1) };
    if before.is_empty() {
        return None;
    }
    let within = |all: &[f64]| all.iter().filter(|v| **v <= tolerance_um).count() as f64 / all.len() as f64;
    let quantile =
        |all: &[f64], share: f64| language.number(all[((all.len() - 1) as f64 * share).round() as usize]);
    let names =
        [say!(language, "median", "медиана"), "95 %".to_owned(), say!(language, "largest", "наибольшее")];
    let numbers: Vec<Vec<String>> = names
        .into_iter()
        .zip([0.5, 0.95, 1.0])
        .map(|(name, share)| vec![name, quantile(&before, share), quantile(&after, share)])
        .collect();
    let drawing = cumulative(
        language,
        &say!(language, "Share of rows below an amount", "Доля строк ниже величины"),
        &before,
        &after,
        Some((tolerance_um, &say!(language, "tolerance", "допуск"))),
        MICROMETRES.in_language(language),
    );
    let header = match language {
        Language::English => ["", "before, \u{b5}m", "after, \u{b5}m"],
        Language::Russian => ["", "до, мкм", "после, мкм"],
    };
    let caption = say!(
        language,
        "Share of the rows whose gap is smaller than the amount below.",
        "Доля строк, расхождение в которых меньше величины внизу."
    );
    let [share, share_after] = [&before, &after].map(|all| language.percent(within(all)));
    let tolerance = language.number(tolerance_um);
    Some(html! {
        p {
            (say!(
                language,
                "{share} of the rows lie within the tolerance of {tolerance} \u{b5}m before, {share_after} after. Noise is in both.",
                "В допуске {tolerance} мкм до {share} строк, после {share_after}. Шум входит в то и другое."
            ))
        }
        (figure(language, &drawing, &caption, Some(table(language, &header, &[1, 2], &numbers))))
    })
}
