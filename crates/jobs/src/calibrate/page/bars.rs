//! What ball bars say: circles and location errors, as JSON.

use calibration::circular_test::{Cause, CircularTest, Pattern, Sense, Trace};
use calibration::linear_ballbar::{CircleCalibration, Term};
use calibration::rotary_ballbar::RotaryCalibration;
use diagnostic::{Text, both};
use machine_model::Axis;
use measurement_files::micro;
use report::numbers::digits;
use serde_json::{Value, json};

use crate::figures::{round, rounded_um};

/// Axes and name of the planes.
pub(super) const PLANES: [(&str, [&str; 2]); 3] =
    [("XY", ["X", "Y"]), ("ZX", ["Z", "X"]), ("YZ", ["Y", "Z"])];

/// Squareness and scale by plane.
pub(super) const SQUARENESS: [&str; 3] = ["EC0Y", "EB0Z", "EA0Z"];

/// What was found, with the names of the circles' runs.
pub(in super::super) struct Bars<'b> {
    pub(in super::super) circles: Option<(&'b CircleCalibration, &'b [String])>,
    pub(in super::super) rotary: Option<&'b RotaryCalibration>,
}

/// A cause in words: `squareness EC0Y`.
pub(super) fn cause_name(cause: Cause, plane: usize) -> Text {
    match cause {
        Cause::Squareness => {
            both!("squareness {}", "отклонение от перпендикулярности {}", SQUARENESS[plane])
        }
        Cause::Mismatch => both!("scale {}", "масштаб {}", super::super::bar_report::SCALES[plane]),
        Cause::Backlash(axis) => both!("backlash {}", "люфт {}", Axis::ALL[axis]),
    }
}

/// Which way round, in words.
pub(super) fn sense_name(sense: Sense) -> Text {
    match sense {
        Sense::CounterClockwise => Text::pair("counter-clockwise", "против часовой стрелки"),
        Sense::Clockwise => Text::pair("clockwise", "по часовой стрелке"),
        Sense::Unknown => Text::pair("direction not said", "направление не указано"),
    }
}

impl Bars<'_> {
    /// All figures.
    pub(super) fn json(&self) -> Value {
        json!({
            "kind": "ballbar",
            "circles": self.circles.map(|(found, names)| of_circles(found, names)),
            "locations": self.rotary.map(locations),
        })
    }

    /// The circles by plane.
    pub(super) fn tests(&self) -> &[CircularTest] {
        self.circles.map_or(&[], |(found, _)| &found.tests)
    }
}

fn of_circles(found: &CircleCalibration, names: &[String]) -> Value {
    let term = |t: &Option<Term>, scale: f64| {
        t.map(|t| {
            json!({
                "value": round(t.value * scale, 6),
                "base": round(t.base * scale, 6),
                "u95": round(t.half_width_95 * scale, 6),
            })
        })
    };
    let by = |names: [&str; 3], terms: &[Option<Term>; 3], scale: f64| {
        let mut all = json!({});
        for (name, t) in names.iter().zip(terms) {
            all[*name] = json!(term(t, scale));
        }
        all
    };
    json!({
        "readings": found.estimate.residuals.len(),
        "left_um": rounded_um(found.estimate.sigma),
        "squareness_urad": by(SQUARENESS, &found.squareness_rad, 1e6),
        "mismatch_um_per_m": by(super::super::bar_report::SCALES, &found.mismatch, 1e6),
        "closure_um_per_m": term(&found.closure, 1e6),
        "backlash_um": by(["X", "Y", "Z"], &found.backlash_mm, 1e3),
        "planes": found.tests.iter().map(|t| plane(t, names)).collect::<Vec<_>>(),
    })
}

fn plane(test: &CircularTest, names: &[String]) -> Value {
    let um = rounded_um;
    let sum_mm = test.sum_of_patterns_mm();
    let pattern = |p: &Pattern| {
        json!({
            "cause": cause_name(p.cause, test.plane).english(),
            "range_um": um(p.range_mm),
            "u95_um": um(p.half_width_95_mm),
            "share": round(if sum_mm > 0.0 { p.range_mm / sum_mm } else { 0.0 }, 6),
            "without_um": um(p.without_mm),
        })
    };
    let trace = |t: &Trace| {
        json!({
            "run": names.get(t.run),
            "direction": sense_name(t.sense).english(),
            "readings": t.points.len(),
            "gap_deg": round(t.gap_rad.to_degrees(), 3),
            "G_um": um(t.circularity_mm),
            "centre_um": t.centre_mm.map(um),
            "excess_um": um(t.excess_mm),
        })
    };
    json!({
        "plane": PLANES[test.plane].0,
        "radius_mm": round(test.radius_mm, 6),
        "G_both_um": test.bidirectional_mm.map(um),
        "H_um": test.hysteresis.map(|h| um(h.value_mm)),
        "H_at_deg": test.hysteresis.map(|h| round(h.angle_rad.to_degrees(), 3)),
        "F_min_um": um(test.radial_mm[0]),
        "F_max_um": um(test.radial_mm[1]),
        "causes": test.patterns.iter().map(pattern).collect::<Vec<_>>(),
        "corrected_um": um(test.corrected_mm),
        "curves_of_base_um": um(test.curves_mm),
        "left_um": um(test.left_mm),
        "set_up_um": um(test.set_up_mm),
        "runs": test.traces.iter().map(trace).collect::<Vec<_>>(),
    })
}

fn locations(found: &RotaryCalibration) -> Value {
    let each = found.locations.iter().map(|f| {
        let (scale, unit) = micro(f.location.component);
        json!({
            "name": f.location.name(),
            "unit": unit.english(),
            "value": round(f.value * scale, 6),
            "base": round(f.base * scale, 6),
            "u95": round(f.half_width_95 * scale, 6),
        })
    });
    json!({
        "readings": found.estimate.residuals.len(),
        "left_um": rounded_um(found.estimate.sigma),
        "errors": each.collect::<Vec<_>>(),
        "tool_ball_um": found.cup_mm.map(rounded_um),
        "tool_ball_u95_um": found.cup_half_width_95_mm.map(rounded_um),
    })
}

/// Micrometres with two decimals.
pub(super) fn um(mm: f64) -> Text {
    digits(mm * 1e3, 2)
}
