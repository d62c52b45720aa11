//! The rows themselves: over place, time and conditions, as vectors, as slices, as a distribution.

use diagnostic::{Text, both};
use gap_diagnosis::{Diagnosis, Measurements, Row as Measured};
use report::body::{Body, Table};
use report::chart::{Amounts, Arrow, Panel, Points, Slice, View, cumulative, panels, slices, views};
use report::numbers::{count, digits, number, percent};
use report::scale::nice;

use super::rows::{Row, Rows};

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
pub(super) fn strips(out: &mut Body, d: &Diagnosis, data: &Measurements, rows: &Rows<'_>) {
    let drawn = rows.thinned(MOST_DOTS);
    let equations = || drawn.iter().flat_map(|r| r.equations);
    let reach = equations().map(|r| r.before_um.abs().max(r.after_um.abs())).fold(0.0, f64::max);
    let classes: Vec<usize> = (0..4).filter(|class| equations().any(|r| r.class == *class)).collect();
    if classes.is_empty() {
        return;
    }
    type Size = fn(&gap_diagnosis::Residual) -> f64;
    let [before, after]: [(Text, Size); 2] =
        [(both!("before", "до"), |r| r.before_um), (both!("after", "после"), |r| r.after_um)];
    let columns = match d.causes.is_empty() {
        true => vec![(both!("gap", "расхождение"), before.1)],
        false => vec![before, after],
    };
    let mut all = Vec::new();
    for (label, value) in VARIABLES {
        let known = || rows.all.iter().filter_map(|r| value(&data.rows[r.row]));
        let range = known().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if range.1 <= range.0 || !range.0.is_finite() {
            continue;
        }
        let panel = |(_, size): &(Text, Size)| {
            let points = |class: &usize| {
                let of_class = equations().filter(|r| r.class == *class);
                let at = of_class.filter_map(|r| Some((value(&data.rows[r.row])?, size(r))));
                Points { series: *class, at: at.collect() }
            };
            Panel { label: label.clone(), range, points: classes.iter().map(points).collect() }
        };
        all.push(columns.iter().map(panel).collect());
    }
    let columns: Vec<Text> = columns.into_iter().map(|(name, _)| name).collect();
    let components = COMPONENTS;
    let legend: Vec<(&str, Text)> = classes.iter().map(|class| components[*class].clone()).collect();
    let title = both!("Gap over place, time and conditions", "Расхождение по месту, времени и условиям");
    let drawing = panels(out.language(), &title, &columns, &all, reach, &legend);
    out.figure(&drawing, &thinning(drawn.len(), rows));
}

fn thinning(drawn: usize, rows: &Rows<'_>) -> Text {
    let (is_whole, drawn, all) = (drawn == rows.all.len(), count(drawn), count(rows.all.len()));
    if is_whole {
        return both!("All {all} rows that were used.", "Все использованные строки: {all:#}.");
    }
    both!(
        "{drawn} of {all} rows are drawn, those with the largest gap among them; all numbers on this page are of all rows.",
        "Нарисовано строк: {drawn:#} из {all:#}, в том числе с наибольшим расхождением; все числа на странице — по всем строкам."
    )
}

/// Error vectors in three views.
pub(super) fn vectors(out: &mut Body, d: &Diagnosis, data: &Measurements, rows: &Rows<'_>) {
    let drawn = rows.thinned(MOST_ARROWS);
    let mut lengths: Vec<f64> = drawn.iter().map(|r| r.vectors_um().0.norm()).collect();
    lengths.sort_by(f64::total_cmp);
    let typical_um = lengths.get(lengths.len() * 19 / 20).copied().filter(|l| *l > 0.0);
    let Some(typical_mm) = typical_um.map(|um| 1e-3 * um) else { return };
    let widest_mm = rows.ranges_mm.iter().map(|(low, high)| high - low).fold(0.0, f64::max);
    let magnification = below(0.14 * widest_mm / typical_mm);
    let scale = 1e-3 * magnification;
    let view = |(right, up): (usize, usize)| {
        let arrow = |r: &&Row<'_>| {
            let q = data.rows[r.row].command.linear_mm;
            let (before, after) = r.vectors_um();
            // Without causes there is no after.
            let after = if d.causes.is_empty() { before } else { after };
            Arrow {
                at: (q[right], q[up]),
                before: (scale * before[right], scale * before[up]),
                after: (scale * after[right], scale * after[up]),
            }
        };
        View {
            axes: [NAMES[right], NAMES[up]],
            ranges: [rows.ranges_mm[right], rows.ranges_mm[up]],
            arrows: drawn.iter().map(arrow).collect(),
        }
    };
    let planes = [(0, 1), (0, 2), (1, 2)].into_iter().filter(|(a, b)| rows.moves(*a) || rows.moves(*b));
    let all: Vec<View> = planes.map(view).collect();
    if all.is_empty() {
        return;
    }
    let (times, thinning) = (number(magnification), thinning(drawn.len(), rows));
    let title = both!("Error vectors", "Векторы погрешности");
    out.figure(
        &views(out.language(), &title, &all, magnification),
        &both!(
            "Errors are drawn {times} times their size. {thinning}",
            "Увеличение погрешностей: {times:#}\u{d7}. {thinning:#}"
        ),
    );
}

/// The largest of 1, 2, 5, 10 … that is not above a value.
fn below(value: f64) -> f64 {
    let above = nice(value);
    if above > 1.001 * value { nice(above / 2.5) } else { above }
}

/// A slice through the machine, and sums of squares of its cells: before, after, and of how many rows.
struct Cut {
    place: Text,
    axes: [usize; 2],
    sums: Vec<(f64, f64, f64)>,
}

impl Cut {
    /// RMS of the gap in each cell.
    fn slice(&self, rows: &Rows<'_>, when: &Text, of: fn(&(f64, f64, f64)) -> f64) -> Slice {
        Slice {
            title: Text::join([&self.place, when], ", "),
            axes: self.axes.map(|axis| NAMES[axis]),
            ranges: self.axes.map(|axis| rows.ranges_mm[axis]),
            cells: [CELLS, CELLS],
            values: self.sums.iter().map(|s| (s.2 > 0.5).then(|| (of(s) / s.2).sqrt())).collect(),
        }
    }
}

/// What was measured, cut into slices; of what a line only pierces there is none.
fn cuts(data: &Measurements, rows: &Rows<'_>) -> Vec<Cut> {
    let cell = |axis: usize, value: f64, count: usize| {
        let (low, high) = rows.ranges_mm[axis];
        if high > low { (((value - low) / (high - low) * count as f64) as usize).min(count - 1) } else { 0 }
    };
    let planes = [(0, 1, 2), (0, 2, 1), (1, 2, 0)];
    let mut all = Vec::new();
    for (right, up, through) in planes.into_iter().filter(|(a, b, _)| rows.moves(*a) && rows.moves(*b)) {
        let count = if rows.moves(through) { CUTS } else { 1 };
        let (low, high) = rows.ranges_mm[through];
        let edge = |k: usize| digits(low + (high - low) * k as f64 / count as f64, 0);
        let axis = NAMES[through];
        for k in 0..count {
            let mut sums = vec![(0.0, 0.0, 0.0); CELLS * CELLS];
            for r in &rows.all {
                let q = data.rows[r.row].command.linear_mm;
                if cell(through, q[through], count) == k {
                    let (before, after) = r.sizes_um();
                    let sum = &mut sums[cell(up, q[up], CELLS) * CELLS + cell(right, q[right], CELLS)];
                    *sum = (sum.0 + before * before, sum.1 + after * after, sum.2 + 1.0);
                }
            }
            let (from, to) = (edge(k), edge(k + 1));
            let place = match count {
                1 => both!("{axis} {from} mm", "{axis} {from:#} мм"),
                _ => both!("{axis} {from} to {to} mm", "{axis} {from:#}\u{2026}{to:#} мм"),
            };
            if sums.iter().filter(|s| s.2 > 0.5).count() >= LEAST_CELLS {
                all.push(Cut { place, axes: [right, up], sums });
            }
        }
    }
    all
}

/// Mean gap over slices, before and after, on one scale.
pub(super) fn heat(out: &mut Body, d: &Diagnosis, data: &Measurements, rows: &Rows<'_>) {
    let cuts = cuts(data, rows);
    if cuts.is_empty() {
        return;
    }
    let slices_of = |when: Text, of: fn(&(f64, f64, f64)) -> f64| -> Vec<Slice> {
        cuts.iter().map(|cut| cut.slice(rows, &when, of)).collect()
    };
    let before = slices_of(both!("before", "до"), |s| s.0);
    let after = slices_of(both!("after", "после"), |s| s.1);
    let worst = |slice: &Slice| slice.values.iter().flatten().copied().fold(0.0, f64::max);
    let largest = before.iter().map(worst).fold(0.0, f64::max);
    let table = Table::of(cuts.iter().zip(before.iter().zip(&after)))
        .words(both!("slice", "сечение"), |(cut, _)| cut.place.clone())
        .numbers(both!("worst cell before, \u{b5}m", "худшая клетка до, мкм"), |(_, (b, _))| number(worst(b)))
        .numbers(
            both!("worst cell after, \u{b5}m", "худшая клетка после, мкм"),
            |(_, (_, a))| number(worst(a)),
        );
    let mut shown = before.clone();
    if !d.causes.is_empty() {
        shown.extend(after.iter().cloned());
    }
    let title =
        both!("RMS of the gap over slices through the machine", "СКЗ расхождения в сечениях рабочего объёма");
    out.figure_of(
        &slices(out.language(), &title, &shown, &Amounts { largest, within: None }),
        &both!(
            "RMS of the gap in each cell, one scale for all slices. Cells without rows were not measured; nothing is filled in between.",
            "СКЗ расхождения в каждой клетке, шкала для всех сечений одна. Клетки без строк не измерялись; между ними ничего не достроено."
        ),
        &table,
    );
}

/// How many rows lie below an amount.
pub(super) fn distribution(out: &mut Body, d: &Diagnosis, rows: &Rows<'_>, tolerance_um: f64) {
    let sorted = |which: fn((f64, f64)) -> f64| {
        let mut all: Vec<f64> = rows.all.iter().map(|r| which(r.sizes_um())).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let before = sorted(|s| s.0);
    let after = if d.causes.is_empty() { before.clone() } else { sorted(|s| s.1) };
    if before.is_empty() {
        return;
    }
    let within = |all: &[f64]| all.iter().filter(|v| **v <= tolerance_um).count() as f64 / all.len() as f64;
    let [share, share_after] = [&before, &after].map(|all| percent(within(all)));
    let allowed = number(tolerance_um);
    out.p(&both!(
        "{share} of the rows lie within the tolerance of {allowed} \u{b5}m before, {share_after} after. Noise is in both.",
        "В допуске {allowed:#} мкм до {share:#} строк, после {share_after:#}. Шум входит в то и другое."
    ));
    let quantile = |all: &[f64], share: f64| number(all[((all.len() - 1) as f64 * share).round() as usize]);
    let quantiles = [
        (both!("median", "медиана"), 0.5),
        (Text::same("95 %"), 0.95),
        (both!("largest", "наибольшее"), 1.0),
    ];
    let table = Table::of(quantiles)
        .words(Text::EMPTY, |(name, _)| name.clone())
        .numbers(both!("before, \u{b5}m", "до, мкм"), |(_, share)| quantile(&before, *share))
        .numbers(both!("after, \u{b5}m", "после, мкм"), |(_, share)| quantile(&after, *share));
    let title = both!("Share of rows below an amount", "Доля строк ниже величины");
    let tolerance = both!("tolerance", "допуск");
    out.figure_of(
        &cumulative(out.language(), &title, &before, &after, Some((tolerance_um, &tolerance))),
        &both!(
            "Share of the rows whose gap is smaller than the amount below.",
            "Доля строк, расхождение в которых меньше величины внизу."
        ),
        &table,
    );
}
