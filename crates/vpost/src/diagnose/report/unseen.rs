//! Forecast against what came of it on points that no fit has seen.

use gap_diagnosis::{Diagnosis, Measurements};
use maud::{Markup, html};
use report::chart::{Bar, Interval, cumulative, interval, waterfall};
use report::page::{figure, table};
use report::text::{number, percent, shown};

use super::facts::Facts;

/// Most points in the table.
const MOST: usize = 100;

pub(super) fn unseen(d: &Diagnosis, holdout: Option<&Measurements>, facts: &Facts) -> Markup {
    let Some(last) = d.causes.last() else {
        return html! { p { "Without causes nothing is predicted." } };
    };
    let s = last.shrink_predicted;
    let forecast =
        Interval { low: s.low, mid: s.mid, high: s.high, achieved: d.holdout.as_ref().map(|h| h.shrink) };
    html! {
        (figure(
            &interval("Shrinkage of the gap's RMS", &forecast),
            "How far the RMS of the gap shrinks with all causes in the model: 0 % nothing, 100 % all. The band is the 95 % interval of the forecast.",
            None,
        ))
        @match (&d.holdout, holdout) {
            (Some(h), Some(points)) => {
                p {
                    "On " (h.rows) " points of " (shown(facts.holdout.as_ref().map_or("", |f| f.name.as_str())))
                    ", which no fit has seen: " (number(h.rms_before_um)) " to " (number(h.rms_after_um)) " \u{b5}m RMS, "
                    (percent(h.shrink)) "; predicted were " (percent(s.mid)) " (" (percent(s.low)) " to " (percent(s.high)) ")."
                }
                (steps(h))
                (points_of(h, points))
            }
            _ => p.muted { "No unseen points were given. Measure some other lines and add --holdout FILE: only they prove the forecast." }
        }
    }
}

fn steps(h: &gap_diagnosis::Holdout) -> Markup {
    let bars: Vec<Bar> = h.steps.iter().map(|s| Bar { label: s.added.clone(), value: s.rms_um }).collect();
    let numbers: Vec<Vec<String>> = h.steps.iter().map(|s| vec![s.added.clone(), number(s.rms_um)]).collect();
    figure(
        &waterfall("RMS of the unseen points as the model grows", &bars, None, "\u{b5}m"),
        "Each line adds one part to the model. A cause may make single steps worse that the next one makes good: only together they are the machine.",
        Some(table(&["added", "RMS, \u{b5}m"], &[1], &numbers)),
    )
}

fn points_of(h: &gap_diagnosis::Holdout, points: &Measurements) -> Markup {
    let mut sizes: Vec<(usize, f64, f64)> = Vec::new();
    for r in &h.residuals {
        match sizes.last_mut() {
            Some((row, before, after)) if *row == r.row => {
                *before += r.before_um * r.before_um;
                *after += r.after_um * r.after_um;
            }
            _ => sizes.push((r.row, r.before_um * r.before_um, r.after_um * r.after_um)),
        }
    }
    for (_, before, after) in &mut sizes {
        (*before, *after) = (before.sqrt(), after.sqrt());
    }
    let sorted = |which: &dyn Fn(&(usize, f64, f64)) -> f64| {
        let mut all: Vec<f64> = sizes.iter().map(which).collect();
        all.sort_by(f64::total_cmp);
        all
    };
    let numbers: Vec<Vec<String>> = sizes
        .iter()
        .take(MOST)
        .map(|(row, before, after)| {
            let q = points.rows[*row].command.linear_mm;
            let mut cells = vec![points.rows[*row].line.to_string()];
            cells.extend([q.x, q.y, q.z, *before, *after].map(number));
            cells
        })
        .collect();
    figure(
        &cumulative("Unseen points before and after", &sorted(&|s| s.1), &sorted(&|s| s.2), None, "\u{b5}m"),
        "Share of the unseen points whose gap is smaller than the amount below.",
        Some(table(
            &["line", "X, mm", "Y, mm", "Z, mm", "before, \u{b5}m", "after, \u{b5}m"],
            &[0, 1, 2, 3, 4, 5],
            &numbers,
        )),
    )
}
