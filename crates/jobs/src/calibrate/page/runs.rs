//! What an interferometer's runs say: figures of every axis as JSON and CSV.

use std::fmt::Write;

use calibration::functions::Function;
use calibration::iso230_2::{Evaluation, HeldOut, Runs};
use diagnostic::{Text, both};
use machine_model::{Axis, Component};
use measurement_files::micro;
use measurement_files::series::Series;
use report::text::MICROMETRES;
use serde_json::{Value, json};

use crate::figures::{fixed, round};

use super::super::iso_report;
use super::super::sources::span;

/// One error function that was read.
pub(in super::super) struct Read {
    /// The axis that moved.
    pub(super) axis: Axis,
    /// `EXX`
    pub(super) name: String,
    /// True along the axis itself: what ISO 230-2 is about.
    pub(super) is_positioning: bool,
    /// In µm or µrad.
    pub(super) component: Component,
    /// Deviations by run, mm or rad.
    pub(super) runs: Runs,
    /// True where a reading does not say its direction.
    pub(super) is_direction_unsaid: bool,
    /// Range of the means, and how far readings scatter.
    pub(super) mean: [f64; 2],
    pub(super) scatter: Option<f64>,
    /// ISO 230-2, where runs were repeated.
    pub(super) evaluation: Option<Evaluation>,
    /// What the standard asks and was not done.
    pub(super) missing: Vec<Text>,
    /// What a correction leaves of runs that it was not made of.
    pub(super) held_out: Option<HeldOut>,
}

impl Read {
    /// Of one series; figures where it was evaluated.
    pub(in super::super) fn new(
        series: &Series,
        function: &Function,
        runs: Runs,
        evaluation: Option<Evaluation>,
    ) -> Self {
        let (low, high) = span(function.mean.iter().copied());
        Self {
            axis: series.axis,
            name: series.name(),
            is_positioning: series.function == series.axis.direction(),
            component: Component::of(series.function),
            is_direction_unsaid: series.readings.iter().any(|r| r.direction == 0),
            mean: [low, high],
            scatter: function.scatter,
            missing: evaluation
                .as_ref()
                .map(super::super::plausibility::missing_of_the_standard)
                .unwrap_or_default(),
            held_out: calibration::iso230_2::held_out(&runs),
            evaluation,
            runs,
        }
    }

    /// To µm or µrad.
    pub(super) fn scale(&self) -> (f64, Text) {
        match self.component {
            Component::Linear => (1e3, MICROMETRES.clone()),
            Component::Angular => (1e6, both!("\u{b5}rad", "мкрад")),
        }
    }

    fn json(&self) -> Value {
        let (scale, unit) = micro(self.component);
        let shown = |v: f64| round(v * scale, 6);
        let key = |name: &str| format!("{name}_{unit}");
        let lists = |all: &[Vec<f64>]| {
            all.iter().map(|run| run.iter().map(|v| shown(*v)).collect::<Vec<_>>()).collect::<Vec<_>>()
        };
        let mut out = json!({
            "function": self.name,
            "axis": self.axis.letter().to_string(),
            "unit": unit.english(),
            "targets_mm": self.runs.targets,
            "up": lists(&self.runs.positive),
            "down": lists(&self.runs.negative),
            "direction_said": !self.is_direction_unsaid,
            "iso230_2": self.evaluation.as_ref().map(|e| evaluation(e, &shown)),
            "missing_of_the_standard": self.missing.iter().map(Text::english).collect::<Vec<_>>(),
        });
        out[key("mean")] = json!(self.mean.map(shown));
        out[key("scatter")] = json!(self.scatter.map(shown));
        out["held_out"] = json!(self.held_out.map(|h| json!({
            "range_before": shown(h.before),
            "range_after": shown(h.after),
            "rms_after": shown(h.after_rms),
        })));
        out
    }
}

fn evaluation(e: &Evaluation, shown: &dyn Fn(f64) -> f64) -> Value {
    let mut out = json!({ "runs": { "up": e.runs[0], "down": e.runs[1] } });
    for figure in iso_report::figures(e) {
        let key = figure.symbol.replace('\u{2191}', "_up").replace('\u{2193}', "_down");
        let found = figure.found;
        out[key] = json!({ "value": shown(found.value), "u95": shown(found.expanded), "at_mm": found.at });
    }
    out["mean_B"] = json!(e.mean_reversal.map(shown));
    let approach = |a: calibration::iso230_2::Approach| json!({ "mean": shown(a.mean), "s": shown(a.deviation), "R": shown(a.repeatability) });
    let target = |t: &calibration::iso230_2::Target| {
        json!({
            "position_mm": t.position,
            "up": t.positive.map(approach),
            "down": t.negative.map(approach),
            "B": t.reversal.map(shown),
            "mean": shown(t.mean),
            "R": shown(t.repeatability),
        })
    };
    out["targets"] = e.targets.iter().map(target).collect();
    out
}

/// Every function that was read.
pub(in super::super) struct Positions(pub(in super::super) Vec<Read>);

impl Positions {
    /// All figures.
    pub(super) fn json(&self) -> Value {
        json!({ "kind": "interferometer", "functions": self.0.iter().map(Read::json).collect::<Vec<_>>() })
    }

    /// Single readings, then means and the limits two standard deviations from them.
    pub(super) fn csv(&self) -> String {
        let mut out = String::from("function,series,dir,position_mm,deviation,unit\n");
        for read in &self.0 {
            let (scale, unit) = micro(read.component);
            let mut put = |series: &str, direction: i8, values: &[f64]| {
                for (position, value) in read.runs.targets.iter().zip(values) {
                    // Writing to a String cannot fail.
                    let _ = writeln!(
                        out,
                        "{},{series},{direction},{},{},{unit}",
                        read.name,
                        fixed(*position, 6),
                        fixed(value * scale, 6)
                    );
                }
            };
            for (direction, all) in [(1, &read.runs.positive), (-1, &read.runs.negative)] {
                for (run, values) in all.iter().enumerate() {
                    put(&format!("run {}", run + 1), direction, values);
                }
            }
            let Some(e) = &read.evaluation else { continue };
            for (direction, side) in [(1, 0), (-1, 1)] {
                for (series, spread) in [("mean", 0.0), ("mean-2s", -2.0), ("mean+2s", 2.0)] {
                    put(series, direction, &limits(e, side, spread));
                }
            }
        }
        out
    }
}

/// Mean and so many standard deviations, target by target; nothing of a direction that was not run.
pub(super) fn limits(e: &Evaluation, side: usize, spread: f64) -> Vec<f64> {
    let approach = |t: &calibration::iso230_2::Target| if side == 0 { t.positive } else { t.negative };
    e.targets.iter().filter_map(approach).map(|a| a.mean + spread * a.deviation).collect()
}
