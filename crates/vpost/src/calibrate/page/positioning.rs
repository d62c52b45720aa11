//! The page of an interferometer's runs: the diagram of ISO 230-2 for each axis, and its figures.

use calibration::iso230_2::{Evaluation, Target};
use maud::{Markup, html};
use report::chart::{Band, Bands, bands};
use report::page::{Section, figure, table};
use report::text::{number_of_digits, percent, shown};
use serde_json::Value;

use super::super::iso_report;
use super::facts::Facts;
use super::found::Found;
use super::runs::{Positions, Read, limits};
use crate::file;
use crate::number::short;

impl Found for Positions {
    fn title(&self) -> String {
        title(&self.0)
    }

    fn head(&self, facts: &Facts) -> Markup {
        head(&self.0, facts)
    }

    fn sections(&self) -> Vec<Section> {
        sections(&self.0)
    }

    fn json(&self) -> Value {
        Self::json(self)
    }

    fn csv(&self) -> String {
        Self::csv(self)
    }
}

/// As many digits as the command prints.
fn um(mm: f64) -> String {
    number_of_digits(mm * 1e3, 3)
}

/// A position with a real minus sign.
fn position(mm: f64) -> String {
    short(mm, 3).replacen('-', "\u{2212}", 1)
}

fn title(all: &[Read]) -> String {
    let names: Vec<&str> = positions(all).map(|r| r.name.as_str()).collect();
    if names.is_empty() { "Error functions".to_owned() } else { format!("Positioning {}", names.join(", ")) }
}

fn positions(all: &[Read]) -> impl Iterator<Item = &Read> {
    all.iter().filter(|r| r.is_positioning)
}

/// What most of an axis' deviation is.
enum Lead {
    /// Readings at one target and from one side scatter.
    Scatter { r_mm: f64, at_mm: f64, from: &'static str },
    /// Both directions differ.
    Reversal { b_mm: f64, at_mm: f64 },
    /// The mean wanders along the axis.
    Curve { m_mm: f64 },
}

impl Lead {
    /// The largest of the three.
    fn of(e: &Evaluation) -> Self {
        let mut scatter = (0.0, 0.0, "below");
        for t in &e.targets {
            for (approach, from) in [(t.positive, "below"), (t.negative, "above")] {
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

    fn word(&self) -> &'static str {
        match self {
            Self::Scatter { .. } => "SCATTER",
            Self::Reversal { .. } => "REVERSAL",
            Self::Curve { .. } => "REPEATABLE CURVE",
        }
    }

    /// What is wrong, and what to do about it.
    fn says(&self) -> String {
        match self {
            Self::Scatter { r_mm, at_mm, from } => format!(
                "Most of it does not repeat: at {} mm, reached from {from}, readings scatter by 4s = {} \u{b5}m. No table corrects that. Run that target again; look at fixture, scale, bearings and drive before correcting.",
                position(*at_mm),
                um(*r_mm)
            ),
            Self::Reversal { b_mm, at_mm } => format!(
                "Most of it is the direction: at {} mm the axis stands {} \u{b5}m apart by where it comes from. Look at nut, bearings and guideway; what repeats of it, tables of both directions correct.",
                position(*at_mm),
                um(*b_mm)
            ),
            Self::Curve { m_mm } => format!(
                "Most of it repeats: the mean of the readings wanders by M = {} \u{b5}m along the axis. A table corrects it.",
                um(*m_mm)
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
fn head(all: &[Read], facts: &Facts) -> Markup {
    let written = facts.written.as_ref().map(|path| file::name(path));
    html! {
        p.muted { "Positioning after ISO 230-2: " (shown(&facts.names())) }
        @match worst(all) {
            Some((read, e)) => {
                @let lead = Lead::of(e);
                p { span.verdict { (lead.word()) } }
                h1 {
                    (read.axis) " positions within A = " (um(e.accuracy.value)) " \u{b5}m (\u{b1} "
                    (um(e.accuracy.expanded)) ", 95\u{a0}%)"
                }
                p { (lead.says()) }
                p { (correction(read)) }
                @for (other, e) in evaluated(all).filter(|(other, _)| other.axis != read.axis) {
                    p { (other.axis) " positions within A = " (um(e.accuracy.value)) " \u{b5}m (\u{b1} " (um(e.accuracy.expanded)) ")." }
                }
            }
            None => {
                p { span.verdict { "NOT EVALUATED" } }
                h1 { "No runs were repeated: what was read is drawn, and nothing is said of repeatability or accuracy" }
                p { "Repeat the runs, five in each direction as ISO 230-2 asks, in one file or several." }
            }
        }
        @for read in positions(all) {
            @for missing in &read.missing { p.muted { "Not as the standard asks, " (read.name) ": " (shown(missing)) "." } }
        }
        @match written {
            Some(name) => p { "Written to " (shown(&name)) "." },
            None => p.muted { "No profile was written: add -o PROFILE.toml to correct by these readings." },
        }
    }
}

/// A spread this much larger is no chance of which run was left out.
const WORSE: f64 = 1.1;
/// A spread not smaller than this part of what it was is little gain.
const WORTH: f64 = 0.8;

/// What a correction will bring, by runs that it was not made of.
fn correction(read: &Read) -> String {
    let Some(h) = read.held_out else {
        return "What a correction will bring, one run in a direction cannot say: run it again.".to_owned();
    };
    let words = format!(
        "Each run of {} corrected by the mean of the others: readings spread over {} \u{b5}m instead of {} (RMS {} \u{b5}m)",
        read.axis,
        um(h.after),
        um(h.before),
        um(h.after_rms)
    );
    if h.after < WORTH * h.before {
        let gain = percent(1.0 - h.after / h.before);
        format!("{words}. That is what a correction will bring: {gain} less.")
    } else if h.after < WORSE * h.before {
        format!("{words}. A correction brings little.")
    } else {
        format!("{words}. A correction by these runs would make it worse.")
    }
}

/// Ids and titles of the axes' sections.
const OF_AXES: [(&str, &str); 3] =
    [("x", "Positioning of X"), ("y", "Positioning of Y"), ("z", "Positioning of Z")];

fn sections(all: &[Read]) -> Vec<Section> {
    let mut out: Vec<Section> = positions(all)
        .map(|read| {
            let (id, title) = OF_AXES[read.axis.direction()];
            Section { id, title, body: axis(read) }
        })
        .collect();
    if all.iter().any(|r| !r.is_positioning) {
        out.push(Section { id: "others", title: "Straightness and angles", body: others(all) });
    }
    out
}

fn axis(read: &Read) -> Markup {
    html! {
        (diagram(read))
        @if read.is_direction_unsaid {
            p.muted { "The file does not say the direction of every reading: those without one are shown as up." }
        }
        @match &read.evaluation {
            Some(e) => {
                @if e.runs.contains(&0) {
                    p {
                        "Runs in one direction only: of the other, and of the reversal value B, nothing is known. "
                        "A, E, M and R are those of the direction that was run."
                    }
                }
                (results(e))
                h3 { "By target" }
                (targets(e))
            }
            None => p {
                "Each direction was run once: no scatter is known, so there are no limits in the drawing and no figures of ISO 230-2."
            },
        }
    }
}

/// Runs, means and the limits two standard deviations from them.
fn diagram(read: &Read) -> Markup {
    let micro = |values: &[f64]| -> Vec<f64> { values.iter().map(|v| v * 1e3).collect() };
    let side = |(side, all, name): (usize, &Vec<Vec<f64>>, &str)| {
        let runs: Vec<Vec<f64>> = all.iter().map(|run| micro(run)).collect();
        let count = all.len();
        let several = read.evaluation.as_ref().filter(|_| count > 1);
        let mean = match &read.evaluation {
            Some(e) => micro(&limits(e, side, 0.0)),
            None => runs.first().cloned().unwrap_or_default(),
        };
        let plural = if count == 1 { "run" } else { "runs" };
        Band {
            name: format!("{name}: {count} {plural}"),
            mean,
            limits: several.map(|e| [micro(&limits(e, side, -2.0)), micro(&limits(e, side, 2.0))]),
            runs,
        }
    };
    let both = [(0, &read.runs.positive, "up"), (1, &read.runs.negative, "down")];
    let drawn = Bands {
        label: format!("target position of {}, mm", read.axis),
        at: read.runs.targets.clone(),
        bands: both.into_iter().filter(|(_, all, _)| !all.is_empty()).map(side).collect(),
        span: read.evaluation.as_ref().map(|e| format!("A {}", um(e.accuracy.value))),
    };
    let caption = if read.evaluation.is_some() {
        "Deviation, actual minus target. Thin: single runs; strong: their means; shaded: mean \u{b1} 2s; dashed: the limits between which A lies."
    } else {
        "Deviation, actual minus target, as it was read once."
    };
    let name = format!("Positioning deviation {}", read.name);
    figure(&bands(&name, &drawn, "\u{b5}m"), caption, Some(readings(read)))
}

/// Every reading.
fn readings(read: &Read) -> Markup {
    let runs = || {
        let of = |all: &'_ [Vec<f64>], name: &'static str| {
            (0..all.len()).map(|k| format!("{name} {}", k + 1)).collect::<Vec<_>>()
        };
        [of(&read.runs.positive, "up"), of(&read.runs.negative, "down")].concat()
    };
    let names = runs();
    let header: Vec<&str> = std::iter::once("target, mm").chain(names.iter().map(String::as_str)).collect();
    let numbers: Vec<usize> = (0..header.len()).collect();
    let row = |(i, target): (usize, &f64)| {
        let values = read.runs.positive.iter().chain(&read.runs.negative).map(|run| um(run[i]));
        std::iter::once(position(*target)).chain(values).collect()
    };
    let rows: Vec<Vec<String>> = read.runs.targets.iter().enumerate().map(row).collect();
    table(&header, &numbers, &rows)
}

fn results(e: &Evaluation) -> Markup {
    let place = |at: [f64; 2]| {
        let [a, b] = at.map(position);
        if a == b { a } else { format!("{a} and {b}") }
    };
    let row = |f: iso_report::Figure| {
        vec![
            f.symbol.to_owned(),
            um(f.found.value),
            um(f.found.expanded),
            place(f.found.at),
            f.name.to_owned(),
        ]
    };
    let mut rows: Vec<Vec<String>> = iso_report::figures(e).into_iter().map(row).collect();
    if let Some(mean) = e.mean_reversal {
        let all = vec!["B\u{304}".to_owned(), um(mean), String::new(), String::new()];
        rows.push([all, vec!["mean reversal value".to_owned()]].concat());
    }
    table(&["", "\u{b5}m", "\u{b1} 95 %, \u{b5}m", "made at, mm", "ISO 230-2"], &[1, 2, 3], &rows)
}

fn targets(e: &Evaluation) -> Markup {
    let cell = |value: Option<f64>| value.map_or_else(|| "\u{2014}".to_owned(), um);
    let row = |t: &Target| {
        vec![
            position(t.position),
            cell(t.positive.map(|a| a.mean)),
            cell(t.negative.map(|a| a.mean)),
            cell(t.reversal),
            cell(t.positive.map(|a| a.deviation)),
            cell(t.negative.map(|a| a.deviation)),
            um(t.repeatability),
        ]
    };
    let rows: Vec<Vec<String>> = e.targets.iter().map(row).collect();
    let header = ["target, mm", "mean up, \u{b5}m", "mean down", "B", "s up", "s down", "R"];
    table(&header, &[0, 1, 2, 3, 4, 5, 6], &rows)
}

/// What was read beside positions: ISO 230-2 does not evaluate it.
fn others(all: &[Read]) -> Markup {
    let row = |read: &Read| {
        let (scale, unit) = read.scale();
        let value = |v: f64| number_of_digits(v * scale, 3);
        vec![
            read.name.clone(),
            read.runs.targets.len().to_string(),
            (read.runs.positive.len() + read.runs.negative.len()).to_string(),
            value(read.mean[0]),
            value(read.mean[1]),
            read.scatter.map_or_else(|| "\u{2014}".to_owned(), value),
            unit.to_owned(),
        ]
    };
    let rows: Vec<Vec<String>> = all.iter().filter(|r| !r.is_positioning).map(row).collect();
    let header = ["function", "targets", "runs", "least mean", "largest mean", "scatter (s)", ""];
    table(&header, &[1, 2, 3, 4, 5], &rows)
}
