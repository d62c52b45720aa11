//! What `calibrate rtest` prints, and its JSON.

use std::fmt::{Result, Write};

use calibration::rtest::{
    Basis, FoundTerm, HeldOut, ON_AXIS_MM, RotaryTables, Term, TurnedAxis, WrittenTable,
};
use serde_json::{Value, json};

use crate::number::short;

use super::rows::Rows;

const FUNCTIONS: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];

/// Factor to what is printed, and its unit.
fn unit(is_length: bool) -> (f64, &'static str) {
    if is_length { (1e3, "um") } else { (1e6, "urad") }
}

pub(super) fn text(found: &RotaryTables, held: Option<&HeldOut>, rows: &Rows) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write_text(&mut out, found, held, rows);
    out
}

fn axis_line(out: &mut String, own: &TurnedAxis) -> Result {
    let [low, high] = own.range_rad.map(|rad| short(rad.to_degrees(), 4));
    write!(
        out,
        "axis {}: {} angles from {low} to {high} degrees, balls up to {:.0} mm from it; ",
        own.axis, own.angles, own.arm_mm
    )?;
    if own.arm_mm < ON_AXIS_MM {
        write!(out, "on the axis, which hides how it leans; ")?;
    }
    let degree = |groups: usize| match own.basis {
        _ if groups == 0 => "none".to_owned(),
        _ if groups == 1 => "the mean alone".to_owned(),
        Basis::Turn => format!("{} a turn", groups - 1),
        Basis::Arc(_) if groups <= 2 => format!("{} a turn", groups - 1),
        Basis::Arc(_) => format!("degree {}", groups),
    };
    writeln!(
        out,
        "error functions to {} ({})",
        degree(own.groups),
        if own.groups < own.most_groups {
            format!("{} allowed by the angles", degree(own.most_groups))
        } else {
            "all that the angles allow: more of them might show finer ones".to_owned()
        }
    )
}

fn write_text(out: &mut String, found: &RotaryTables, held: Option<&HeldOut>, rows: &Rows) -> Result {
    write!(
        out,
        "{} rows in {} runs; noise {:.3} um",
        rows.readings.len(),
        rows.runs.len(),
        found.estimate.sigma * 1e3
    )?;
    if let Some(free) = found.estimate.degrees_of_freedom {
        write!(out, " with {free} degrees of freedom")?;
    }
    match found.repeats_mm {
        Some((mm, free)) => writeln!(out, "; repeats within a run {:.3} um with {free}", mm * 1e3)?,
        None => writeln!(out)?,
    }
    for own in &found.axes {
        axis_line(out, own)?;
    }
    for axis in &found.still {
        writeln!(out, "axis {axis}: turns in no run, and stays as in the profile")?;
    }
    writeln!(out, "location errors     found        95 %     profile")?;
    for term in &found.terms {
        let (scale, unit) = unit(term.term.is_length());
        let value = (term.base + term.change) * scale;
        match term.term {
            Term::Location(_) if term.is_written => writeln!(
                out,
                "  {}  {value:>15.3} ± {:>8.3} {:>11.3} {unit}",
                term.term.name(),
                term.half_width_95 * scale,
                term.base * scale
            )?,
            Term::Location(_) => writeln!(
                out,
                "  {}     not determined            {:>11.3} {unit}, stays",
                term.term.name(),
                term.base * scale
            )?,
            Term::Reversal(_) => writeln!(
                out,
                "  {}  {value:>9.3} ± {:>8.3} {unit} about the axis itself, from above less from below: taken off, not written",
                term.term.name(),
                term.half_width_95 * scale
            )?,
            Term::Coefficient { .. } => {}
        }
    }
    for table in &found.tables {
        write_functions(out, table)?;
    }
    for set in &found.not_told_apart {
        writeln!(out, "not told apart by these rows, not written: {}", set.join(", "))?;
    }
    if !found.unseen.is_empty() {
        writeln!(out, "not seen by these rows, not written: {}", found.unseen.join(", "))?;
    }
    for (part, owners) in &found.counted_as {
        writeln!(out, "counted as {}, not told from it by these rows: {part}", owners.join(", "))?;
    }
    if !(found.not_told_apart.is_empty() && found.unseen.is_empty() && found.counted_as.is_empty()) {
        writeln!(out, "  a ball at three places not in one line, at two heights, tells them apart")?;
    }
    writeln!(
        out,
        "gauge  what turns with the workpiece is its mounting; means and once-per-turn parts are location errors where both look alike"
    )?;
    let [before, after] = found.rms_mm.map(|mm| mm * 1e3);
    writeln!(out, "fitted {before:.3} -> {after:.3} um RMS ({} readings)", found.estimate.residuals.len())?;
    if let Some(judged) = held {
        writeln!(
            out,
            "held out {:.3} -> {:.3} um RMS, at most {:.3} um ({} readings, each run about its own offset)",
            judged.rms_before_mm * 1e3,
            judged.rms_after_mm * 1e3,
            judged.max_after_mm * 1e3,
            judged.readings
        )?;
    }
    writeln!(
        out,
        "field known to ±{:.2} um at 95 % of the places and angles, frames taken off{}",
        found.field_u95_mm * 1e3,
        if found.not_told_apart.is_empty() { "" } else { ", what is not written not counted" }
    )
}

fn write_functions(out: &mut String, table: &WrittenTable) -> Result {
    let (first, last) = (table.angles_deg[0], table.angles_deg[table.angles_deg.len() - 1]);
    writeln!(
        out,
        "error functions of {}, written from {} to {} degrees at {} nodes, {:.3} um and {:.3} urad between them",
        table.axis,
        short(first, 6),
        short(last, 6),
        table.angles_deg.len(),
        table.between_nodes[0] * 1e3,
        table.between_nodes[1] * 1e6
    )?;
    for f in (0..6).filter(|f| table.changed[*f]) {
        let (scale, unit) = unit(f < 3);
        let values = || table.rows.iter().map(|row| row[f] * scale);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        let half = table.half_widths_95.iter().map(|row| row[f] * scale).fold(0.0, f64::max);
        writeln!(out, "  E{}{}   {low:>9.3} … {high:>9.3} ± {half:.3} {unit}", FUNCTIONS[f], table.axis)?;
    }
    Ok(())
}

pub(super) fn json(found: &RotaryTables, held: Option<&HeldOut>, rows: &Rows) -> Value {
    let axis = |own: &TurnedAxis| {
        json!({ "axis": own.axis.to_string(), "angles": own.angles, "from_deg": own.range_rad[0].to_degrees(),
                "to_deg": own.range_rad[1].to_degrees(), "arm_mm": own.arm_mm,
                "basis": match own.basis { Basis::Turn => "fourier", Basis::Arc(_) => "legendre" },
                "groups": own.groups, "groups_allowed": own.most_groups })
    };
    let freedom = found.estimate.degrees_of_freedom;
    let term = |own: &FoundTerm| {
        let (scale, unit) = unit(own.term.is_length());
        json!({ "name": own.term.name(), "unit": unit, "value": (own.base + own.change) * scale, "base": own.base * scale,
                "u": own.standard_uncertainty * scale, "degrees_of_freedom": freedom, "u95": own.half_width_95 * scale,
                "written": own.is_written })
    };
    let scales: Vec<f64> = found.terms.iter().map(|own| unit(own.term.is_length()).0).collect();
    let first = found.estimate.values.len() - found.terms.len();
    let covariance: Vec<Vec<f64>> = (0..scales.len())
        .map(|i| {
            let entry = |k: usize| found.estimate.covariance[(first + i, first + k)] * scales[i] * scales[k];
            (0..scales.len()).map(entry).collect()
        })
        .collect();
    let table = |own: &WrittenTable| {
        let function = |f: usize| {
            let (scale, unit) = unit(f < 3);
            let of = |all: &[[f64; 6]]| -> Vec<f64> { all.iter().map(|row| row[f] * scale).collect() };
            json!({ "name": format!("E{}{}", FUNCTIONS[f], own.axis), "unit": unit, "changed": own.changed[f],
                    "values": of(&own.rows), "u95": of(&own.half_widths_95) })
        };
        json!({ "axis": own.axis.to_string(), "angles_deg": own.angles_deg,
                "between_nodes_um": own.between_nodes[0] * 1e3, "between_nodes_urad": own.between_nodes[1] * 1e6,
                "functions": (0..6).filter(|f| own.given[*f]).map(function).collect::<Vec<_>>() })
    };
    let counted = |(part, owners): &(String, Vec<String>)| json!({ "part": part, "owners": owners });
    let offsets: serde_json::Map<String, Value> = rows
        .runs
        .iter()
        .zip(&found.offsets_mm)
        .map(|(run, mm)| (run.clone(), json!([mm.x * 1e3, mm.y * 1e3, mm.z * 1e3])))
        .collect();
    let mut out = json!({
        "schema": "vpost.rtest/1",
        "rows": rows.readings.len(),
        "readings": found.estimate.residuals.len(),
        "noise_um": found.estimate.sigma * 1e3,
        "degrees_of_freedom": freedom,
        "repeats_um": found.repeats_mm.map(|(mm, _)| mm * 1e3),
        "stated_um": found.stated_mm.map(|mm| mm * 1e3),
        "axes": found.axes.iter().map(axis).collect::<Vec<_>>(),
        "still": found.still.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "terms": found.terms.iter().map(term).collect::<Vec<_>>(),
        "covariance": covariance,
        "tables": found.tables.iter().map(table).collect::<Vec<_>>(),
        "not_told_apart": found.not_told_apart,
        "not_seen": found.unseen,
        "counted_as": found.counted_as.iter().map(counted).collect::<Vec<_>>(),
        "run_offsets_um": offsets,
        "rms_before_um": found.rms_mm[0] * 1e3,
        "rms_after_um": found.rms_mm[1] * 1e3,
        "field_u95_um": found.field_u95_mm * 1e3,
    });
    if let Some(judged) = held {
        out["holdout"] = json!({ "readings": judged.readings, "rms_before_um": judged.rms_before_mm * 1e3,
            "rms_after_um": judged.rms_after_mm * 1e3, "max_after_um": judged.max_after_mm * 1e3 });
    }
    out
}
