//! The rows themselves: over place, time and conditions, as vectors, as slices, as a distribution.

use gap_diagnosis::{Diagnosis, Measurements, Row as Measured};
use maud::{Markup, html};
use report::chart::{Arrow, Panel, Points, Slice, View, cumulative, panels, slices, views};
use report::page::{figure, table};
use report::scale::nice;
use report::text::{number, number_of_digits, percent};

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
type Variable = (&'static str, fn(&Measured) -> Option<f64>);
const VARIABLES: [Variable; 11] = [
    ("X, mm", |r| Some(r.command.linear_mm.x)),
    ("Y, mm", |r| Some(r.command.linear_mm.y)),
    ("Z, mm", |r| Some(r.command.linear_mm.z)),
    ("A, degrees", |r| Some(r.command.rotary_rad.x.to_degrees())),
    ("B, degrees", |r| Some(r.command.rotary_rad.y.to_degrees())),
    ("C, degrees", |r| Some(r.command.rotary_rad.z.to_degrees())),
    ("time, min", |r| r.conditions.time_s.map(|t| t / 60.0)),
    ("feed, mm/min", |r| r.conditions.feed_mm_min),
    ("temperature, \u{b0}C", |r| r.conditions.temp_c.iter().flatten().next().copied()),
    ("load, kg", |r| r.conditions.load_kg),
    ("tool vector Z, mm", |r| Some(r.command.tool_mm.z)),
];
const COMPONENTS: [(&str, &str); 4] = [("k0", "dx"), ("k1", "dy"), ("k2", "dz"), ("k3", "along the reading")];

/// Residuals over everything that varies.
pub(super) fn strips(d: &Diagnosis, data: &Measurements, rows: &Rows<'_>) -> Option<Markup> {
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
            Panel { label: label.to_owned(), range, points: classes.iter().map(points).collect() }
        };
        all.push(if both { vec![panel(false), panel(true)] } else { vec![panel(false)] });
    }
    let columns: &[&str] = if both { &["before", "after"] } else { &["gap"] };
    let legend: Vec<(&str, &str)> = classes.iter().map(|c| COMPONENTS[*c]).collect();
    let drawing = panels("Gap over place, time and conditions", columns, &all, reach, &legend, "\u{b5}m");
    Some(figure(&drawing, &thinning(drawn.len(), rows), None))
}

fn thinning(drawn: usize, rows: &Rows<'_>) -> String {
    let all = rows.all.len();
    if drawn == all {
        return format!("All {all} rows that were used.");
    }
    format!(
        "{drawn} of {all} rows are drawn, those with the largest gap among them; all numbers on this page are of all rows."
    )
}

/// Error vectors in three views.
pub(super) fn vectors(d: &Diagnosis, data: &Measurements, rows: &Rows<'_>) -> Option<Markup> {
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
    let caption = format!(
        "Errors are drawn {} times their size. {}",
        number(magnification),
        thinning(drawn.len(), rows)
    );
    Some(figure(&views("Error vectors", &all, magnification), &caption, None))
}

/// The largest of 1, 2, 5, 10 … that is not above a value.
fn below(value: f64) -> f64 {
    let above = nice(value);
    if above > 1.001 * value { nice(above / 2.5) } else { above }
}

/// Mean gap over slices, before and after, on one scale.
pub(super) fn heat(d: &Diagnosis, data: &Measurements, rows: &Rows<'_>) -> Option<Markup> {
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
            let edge = |j: usize| number_of_digits(low + (high - low) * j as f64 / cuts as f64, 0);
            let place = if cuts > 1 {
                format!("{} {} to {}", NAMES[through], edge(k), edge(k + 1))
            } else {
                format!("{} {}", NAMES[through], number_of_digits(low, 0))
            };
            let slice = |when: &str, value: &dyn Fn(&(f64, f64, f64)) -> f64| Slice {
                title: format!("{place}{when}"),
                axes: [NAMES[right], NAMES[up]],
                ranges: [rows.ranges_mm[right], rows.ranges_mm[up]],
                cells: [CELLS, CELLS],
                values: sums.iter().map(|s| (s.2 > 0.5).then(|| (value(s) / s.2).sqrt())).collect(),
            };
            pairs.push([slice(", before", &|s| s.0), slice(", after", &|s| s.1)]);
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
            let worst = |s: &Slice| number(s.values.iter().flatten().copied().fold(0.0, f64::max));
            vec![b.title.trim_end_matches(", before").to_owned(), worst(b), worst(a)]
        })
        .collect();
    let shown = if d.causes.is_empty() { before } else { before.into_iter().chain(after).collect() };
    Some(figure(
        &slices("RMS of the gap over slices through the machine", &shown, largest, "\u{b5}m"),
        "RMS of the gap in each cell, one scale for all slices. Cells without rows were not measured; nothing is filled in between.",
        Some(table(&["slice", "worst cell before, \u{b5}m", "worst cell after, \u{b5}m"], &[1, 2], &numbers)),
    ))
}

/// How many rows lie below an amount.
pub(super) fn distribution(d: &Diagnosis, rows: &Rows<'_>, tolerance_um: f64) -> Option<Markup> {
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
    let quantile = |all: &[f64], share: f64| number(all[((all.len() - 1) as f64 * share).round() as usize]);
    let numbers: Vec<Vec<String>> = [("median", 0.5), ("95 %", 0.95), ("largest", 1.0)]
        .into_iter()
        .map(|(name, share)| vec![name.to_owned(), quantile(&before, share), quantile(&after, share)])
        .collect();
    let drawing = cumulative(
        "Share of rows below an amount",
        &before,
        &after,
        Some((tolerance_um, "tolerance")),
        "\u{b5}m",
    );
    Some(html! {
        p {
            (percent(within(&before))) " of the rows lie within the tolerance of " (number(tolerance_um)) " \u{b5}m before, "
            (percent(within(&after))) " after. Noise is in both."
        }
        (figure(&drawing, "Share of the rows whose gap is smaller than the amount below.", Some(table(&["", "before, \u{b5}m", "after, \u{b5}m"], &[1, 2], &numbers))))
    })
}
