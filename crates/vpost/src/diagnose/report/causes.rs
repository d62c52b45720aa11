//! Verdict, causes, places: what the answer says, drawn.

use gap_diagnosis::{Cause, Diagnosis, Verdict};
use maud::{Markup, html};
use report::chart::{Bar, Matrix, Range, matrix, ranges, waterfall as waterfall_chart};
use report::page::{figure, table};
use report::text::{number, percent, shown};

use jobs::diagnose::change::Change;

/// RMS of the gap as the causes are added.
pub(super) fn waterfall(d: &Diagnosis) -> Markup {
    let first = Bar { label: "model as it is".to_owned(), value: d.gap.rms_um };
    let added = d.causes.iter().map(|c| Bar { label: format!("with {}", c.effect), value: c.rms_after_um });
    let bars: Vec<Bar> = std::iter::once(first).chain(added).collect();
    // A row's gap is the length over its components, each of which carries the noise of a reading.
    let rows = d.gap.rows.max(1) as f64;
    let floor = d.gap.noise_um * (d.residuals.len() as f64 / rows).sqrt();
    let drawing =
        waterfall_chart("RMS of the gap as causes are added", &bars, Some((floor, "noise alone")), "\u{b5}m");
    let numbers: Vec<Vec<String>> = bars.iter().map(|b| vec![b.label.clone(), number(b.value)]).collect();
    figure(
        &drawing,
        "RMS over the rows, set-up fitted at every step. The dashed line is what noise alone would leave.",
        Some(table(&["model", "RMS, \u{b5}m"], &[1], &numbers)),
    )
}

/// Shares and numbers of the causes.
pub(super) fn causes(d: &Diagnosis, changes: &[Vec<Change>]) -> Markup {
    if d.causes.is_empty() {
        return html! { p { "No cause is named." } (absorber(d)) };
    }
    let shares: Vec<Range> = d
        .causes
        .iter()
        .map(|c| Range { label: c.effect.clone(), low: c.share_unique, high: c.share_alone, faint: false })
        .collect();
    html! {
        (figure(
            &ranges("Share of the gap that each cause explains", &shares),
            "Bar: what nothing else explains. Whisker: what it explains alone. Shares of the gap's square above the noise.",
            None,
        ))
        @for (cause, changes) in d.causes.iter().zip(changes) { (one(cause, changes)) }
        (absorber(d))
    }
}

fn one(c: &Cause, changes: &[Change]) -> Markup {
    html! {
        h3 { (shown(&c.effect)) }
        p { (shown(&c.words)) "." }
        dl {
            @for p in &c.parameters {
                dt { (shown(&p.name)) }
                dd {
                    (number(p.value))
                    @if let Some(u) = p.u95 { " \u{b1} " (number(u)) " (95 %)" }
                }
            }
            dt { "chance that it is none" } dd { (probability(c.p)) }
            @if !c.cannot_be_told_from.is_empty() {
                dt { "cannot be told from" } dd { (shown(&c.cannot_be_told_from.join(", "))) }
            }
            @if !changes.is_empty() {
                dt { "change" }
                dd { (shown(&changes.iter().map(Change::text).collect::<Vec<_>>().join(", "))) }
            }
            dt { "what to do" } dd { (c.remedy) }
        }
    }
}

fn probability(p: f64) -> String {
    if p < 1e-9 { "below 1 in 1,000,000,000".to_owned() } else { format!("{p:.1e}") }
}

fn absorber(d: &Diagnosis) -> Markup {
    html! {
        @if let Some(absorber) = &d.leftover.absorber { p.muted { "Not named: " (shown(absorber)) "." } }
        @if !d.leftover.correlates_with.is_empty() {
            p { "What is left goes with " (shown(&d.leftover.correlates_with.join(", "))) "." }
        }
    }
}

/// Where the gap lies.
pub(super) fn places(d: &Diagnosis) -> Markup {
    let drawn: Vec<Range> = d
        .places
        .iter()
        .filter(|c| c.by != "voxel" && c.by != "run")
        .map(|c| Range {
            label: format!("{} {}", c.by, c.cell),
            low: c.share,
            high: c.share,
            faint: c.p > 0.05,
        })
        .collect();
    let sure: Vec<String> = d
        .places
        .iter()
        .filter(|c| c.p <= 0.05 && c.by != "voxel" && c.by != "run")
        .take(3)
        .map(|c| format!("{} of the gap is {} {}", percent(c.share), c.by, c.cell))
        .collect();
    let numbers: Vec<Vec<String>> = d
        .places
        .iter()
        .map(|c| vec![c.by.clone(), c.cell.clone(), percent(c.share), format!("{:.3}", c.p)])
        .collect();
    html! {
        p {
            @if sure.is_empty() { "No place, direction or condition holds more of the gap than its number of readings explains." }
            @else { (shown(&sure.join("; "))) "." }
        }
        @if !drawn.is_empty() {
            (figure(
                &ranges("Share of the gap by place and condition", &drawn),
                "Faint bars: no more than an even spread would show by chance (p above 0.05, corrected for the number of cells).",
                Some(table(&["by", "cell", "share", "p"], &[2, 3], &numbers)),
            ))
        }
    }
}

/// Most columns of the matrix.
const MOST_COLUMNS: usize = 14;

/// How alike the causes are to other effects on this design.
pub(super) fn confounding(d: &Diagnosis) -> Markup {
    if d.causes.is_empty() {
        return html! { p { "No cause is named, so there is nothing to be confused with." } };
    }
    let mut columns: Vec<(String, f64)> = Vec::new();
    for near in d.causes.iter().flat_map(|c| &c.nearest) {
        match columns.iter_mut().find(|(name, _)| *name == near.effect) {
            Some((_, best)) => *best = best.max(near.correlation),
            None => columns.push((near.effect.clone(), near.correlation)),
        }
    }
    columns.sort_by(|a, b| b.1.total_cmp(&a.1));
    columns.truncate(MOST_COLUMNS);
    let values = d
        .causes
        .iter()
        .flat_map(|c| {
            columns
                .iter()
                .map(|(name, _)| c.nearest.iter().find(|n| n.effect == *name).map(|n| n.correlation))
        })
        .collect();
    let m = Matrix {
        rows: d.causes.iter().map(|c| c.effect.clone()).collect(),
        columns: columns.into_iter().map(|(name, _)| name).collect(),
        values,
        limit: 0.98,
    };
    let numbers: Vec<Vec<String>> = d
        .causes
        .iter()
        .flat_map(|c| {
            c.nearest.iter().map(|n| {
                let behind = if n.behind < 1e6 { number(n.behind) } else { "far".to_owned() };
                vec![c.effect.clone(), n.effect.clone(), format!("{:.3}", n.correlation), behind]
            })
        })
        .collect();
    figure(
        &matrix("Likeness of causes and other effects on these rows", &m),
        "Correlation of what a cause does to these rows with the nearest that another effect can do, set-up taken out. From 0.98 on (framed) no reading of these rows tells them apart; empty cells are less alike than those shown.",
        Some(table(&["cause", "other effect", "correlation", "behind by BIC"], &[2, 3], &numbers)),
    )
}

/// What to measure next.
pub(super) fn next(d: &Diagnosis) -> Markup {
    html! {
        @if let Some(next) = &d.next_measurement {
            p { (shown(&next.text)) }
            @if next.expected_sigma > 0.0 { p.muted {
                (shown(&next.separates[0])) " and " (shown(&next.separates[1])) " would then lie " (number(next.expected_sigma))
                " standard deviations apart."
            } }
        } @else if d.verdict == Verdict::Underpowered {
            ul { @for note in &d.notes { li { (shown(note)) } } }
            p { "A plan that makes the causes of this machine separable: vpost diagnose --plan FILE -m PROFILE." }
        } @else {
            p { "Nothing is needed to tell the causes from others." }
        }
    }
}

/// Rows that stand alone.
pub(super) fn outliers(d: &Diagnosis) -> Markup {
    const MOST: usize = 200;
    let lines: Vec<String> = d.outlier_lines.iter().take(MOST).map(u64::to_string).collect();
    html! {
        @if lines.is_empty() { p { "None." } }
        @else {
            p {
                (d.outlier_lines.len()) " rows lie more than 4.5 robust standard deviations from the model and from their neighbours, and were not used. Lines of the file: "
                (lines.join(", "))
                @if d.outlier_lines.len() > MOST { ", and " (d.outlier_lines.len() - MOST) " more" }
                "."
            }
        }
    }
}
