//! The diagnosis as JSON, `vpost.diagnosis/1`.

use diagnostic::Text;
use gap_diagnosis::{Cause, Diagnosis, Row};
use serde::Serialize;
use serde_json::{Map, Value, json};

use super::change::Change;

#[derive(Serialize)]
struct Document<'a> {
    schema: &'static str,
    verdict: &'static str,
    sentence: &'a str,
    gap: Value,
    #[serde(rename = "where")]
    places: Vec<Value>,
    causes: Vec<Value>,
    withheld: Option<&'a str>,
    setup: Value,
    leftover: Value,
    holdout: Value,
    next_measurement: Value,
    outlier_lines: &'a [u64],
    detectable: Vec<Value>,
    formulas: Vec<Value>,
    notes: Vec<&'a str>,
}

/// The file's text.
#[must_use]
pub fn text(d: &Diagnosis, changes: &[Vec<Change>]) -> String {
    let document = Document {
        schema: "vpost.diagnosis/1",
        verdict: d.verdict.name(),
        sentence: d.sentence.english(),
        gap: json!({
            "rows": d.gap.rows, "rms_um": round(d.gap.rms_um), "p95_um": round(d.gap.p95_um),
            "max_um": round(d.gap.max_um), "noise_um": round(d.gap.noise_um),
        }),
        places: d
            .places
            .iter()
            .map(|c| json!({ "by": c.by, "cell": c.cell, "share": round(c.share), "p": round(c.p) }))
            .collect(),
        causes: d.causes.iter().zip(changes).map(|(c, changes)| cause(c, changes)).collect(),
        withheld: d.withheld.as_ref().map(Text::english),
        setup: d.setup.as_ref().map_or(Value::Null, |setup| {
            json!({
                "shift_um": setup.shift_um.map(round),
                "rotation_urad": setup.rotation_urad.map(round),
                "run_offsets_um": by_run(&setup.run_offsets_um),
                "run_rotations_urad": by_run(&setup.run_rotations_urad),
            })
        }),
        leftover: json!({
            "rms_um": round(d.leftover.rms_um), "phi": round(d.leftover.phi),
            "lack_of_fit_p": round(d.leftover.lack_of_fit_p), "correlates_with": english(&d.leftover.correlates_with),
            "absorber": d.leftover.absorber.as_ref().map(Text::english),
        }),
        holdout: d.holdout.as_ref().map_or(Value::Null, |h| {
            json!({ "rows": h.rows, "rms_before_um": round(h.rms_before_um),
                "rms_after_um": round(h.rms_after_um), "shrink": round(h.shrink),
                "steps": h.steps.iter().map(|s| json!({ "added": s.added.english(), "rms_um": round(s.rms_um) }))
                    .collect::<Vec<_>>() })
        }),
        next_measurement: d.next_measurement.as_ref().map_or(Value::Null, |n| {
            json!({ "text": n.text.english(), "separates": english(&n.separates), "expected_sigma": round(n.expected_sigma),
                "rows": n.rows.iter().map(|r| row(r, &n.run(r))).collect::<Vec<_>>() })
        }),
        outlier_lines: &d.outlier_lines,
        detectable: d
            .detectable
            .iter()
            .map(|s| json!({ "effect": s.effect, "parameter": s.parameter, "smallest": s.smallest.map(round) }))
            .collect(),
        formulas: d
            .formulas
            .iter()
            .map(|f| json!({ "formula": f.text, "share_unseen": round(f.share) }))
            .collect(),
        notes: english(&d.notes),
    };
    let mut text = serde_json::to_string_pretty(&document).expect("plain values always serialise");
    text.push('\n');
    text
}

fn by_run(all: &[(String, [f64; 3])]) -> Map<String, Value> {
    all.iter().map(|(run, values)| (run.clone(), json!(values.map(round)))).collect()
}

/// JSON is English in every language.
fn english(texts: &[Text]) -> Vec<&str> {
    texts.iter().map(Text::english).collect()
}

/// A row to be measured, in the columns of a measurement file; the reading is not there yet.
fn row(row: &Row, run: &str) -> Value {
    let (q, t, d) = (row.command.linear_mm, row.command.tool_mm, row.command.direction);
    let c = &row.conditions;
    let mut all = Map::new();
    all.insert("run".to_owned(), json!(run));
    let mut number = |name: &str, value: f64| {
        all.insert(name.to_owned(), json!(round(value)));
    };
    for (axis, letter) in ["x", "y", "z"].into_iter().enumerate() {
        number(&format!("{letter}_mm"), (1e3 * q[axis]).round() / 1e3);
        number(&format!("dir_{letter}"), f64::from(d[axis]));
        number(&format!("tool_{letter}_mm"), t[axis]);
    }
    let conditions = [("feed_mm_min", c.feed_mm_min), ("load_kg", c.load_kg), ("temp_c", c.temp_c[0])];
    for (name, value) in conditions {
        if let Some(value) = value {
            number(name, value);
        }
    }
    Value::Object(all)
}

fn cause(c: &Cause, changes: &[Change]) -> Value {
    let parameters: Vec<Value> = c
        .parameters
        .iter()
        .map(|p| json!({ "name": p.name, "value": round(p.value), "u95": p.u95.map(round) }))
        .collect();
    json!({
        "effect": c.effect,
        "words": c.words.english(),
        "parameters": parameters,
        "share_unique": round(c.share_unique),
        "share_alone": round(c.share_alone),
        "p": round(c.p),
        "cannot_be_told_from": c.cannot_be_told_from,
        "nearest": c.nearest.iter().map(|n| json!({
            "effect": n.effect, "correlation": round(n.correlation), "behind_bic": round(n.behind),
        })).collect::<Vec<_>>(),
        "rms_before_um": round(c.rms_before_um),
        "rms_after_um": round(c.rms_after_um),
        "shrink_predicted": c.shrink_predicted.map(|shrink| json!({
            "low": round(shrink.low), "mid": round(shrink.mid), "high": round(shrink.high),
        })),
        "remedy": c.remedy.english(),
        "changes": changes,
    })
}

/// Six significant digits: more would only be rounding noise, and differ where a library does.
#[must_use]
pub fn round(value: f64) -> f64 {
    if value == 0.0 || !value.is_finite() {
        return if value.is_finite() { 0.0 } else { f64::MAX.copysign(value) };
    }
    format!("{value:.5e}").parse().unwrap_or(value)
}

/// A number as TOML writes it, six significant digits.
#[must_use]
pub fn number(value: f64) -> String {
    let text = format!("{}", round(value));
    if text.contains(['.', 'e']) { text } else { format!("{text}.0") }
}
