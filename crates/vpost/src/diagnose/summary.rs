//! The diagnosis for people at a terminal.

use std::fmt::Write;

use gap_diagnosis::{Diagnosis, Verdict};

use jobs::diagnose::change::Change;

/// The text.
pub(super) fn text(d: &Diagnosis, changes: &[Vec<Change>]) -> String {
    let mut out = String::new();
    // Writing into a string cannot fail.
    let _ = write(&mut out, d, changes);
    out
}

/// What nothing else explains, to what it explains alone, in percent.
fn share(unique: f64, alone: f64) -> String {
    let (low, high) = (format!("{:.0}", 100.0 * unique), format!("{:.0}", 100.0 * alone));
    if low == high { format!("{low} %") } else { format!("{low}..{high} %") }
}

fn write(out: &mut String, d: &Diagnosis, changes: &[Vec<Change>]) -> std::fmt::Result {
    writeln!(out, "{}: {}\n", d.verdict.name(), d.sentence)?;
    if d.verdict == Verdict::Underpowered {
        return Ok(());
    }
    let g = &d.gap;
    writeln!(
        out,
        "gap     {:.1} um RMS, 95 % below {:.1} um, largest {:.1} um, noise {:.2} um ({} rows)",
        g.rms_um, g.p95_um, g.max_um, g.noise_um, g.rows
    )?;
    let places: Vec<String> = d
        .places
        .iter()
        .filter(|c| c.p <= 0.05 && c.by != "voxel" && c.by != "run")
        .take(4)
        .map(|c| format!("{:.0} % in {} {}", 100.0 * c.share, c.by, c.cell))
        .collect();
    if !places.is_empty() {
        writeln!(out, "where   {}", places.join(", "))?;
    }
    let doubted = matches!(d.verdict, Verdict::Partial | Verdict::Unknown);
    for (cause, changes) in d.causes.iter().zip(changes) {
        let first = cause.parameters.first().map_or_else(String::new, |p| {
            // What is added to the model, not what the model then holds.
            p.u95.map_or_else(
                || format!("{} = {:.2}", p.name, p.value),
                |u| format!("{} {:+.2} ± {u:.2}", p.name, p.value),
            )
        });
        writeln!(out, "\ncause   {}  {first}", cause.effect)?;
        writeln!(out, "        {}", cause.words)?;
        writeln!(
            out,
            "        {} of the gap; RMS {:.1} -> {:.1} um",
            share(cause.share_unique, cause.share_alone),
            cause.rms_before_um,
            cause.rms_after_um
        )?;
        if !cause.cannot_be_told_from.is_empty() {
            writeln!(out, "        cannot be told from {}", cause.cannot_be_told_from.join(", "))?;
        }
        if !changes.is_empty() && !doubted {
            let changes: Vec<String> = changes.iter().map(Change::text).collect();
            writeln!(out, "        change {}", changes.join(", "))?;
        }
        writeln!(out, "        {}", cause.remedy)?;
    }
    if let Some(last) = d.causes.last() {
        let s = last.shrink_predicted;
        writeln!(
            out,
            "\nshrinks by {:.0} % (between {:.0} and {:.0} %) with the cause(s) in the model",
            100.0 * s.mid,
            100.0 * s.low,
            100.0 * s.high
        )?;
    }
    if let Some(h) = &d.holdout {
        writeln!(
            out,
            "unseen points: {:.1} -> {:.1} um RMS, {:.0} % ({} rows)",
            h.rms_before_um,
            h.rms_after_um,
            100.0 * h.shrink,
            h.rows
        )?;
        for step in &h.steps {
            writeln!(out, "        {:>8.1} um  {}", step.rms_um, step.added)?;
        }
    }
    if !d.leftover.correlates_with.is_empty() {
        writeln!(out, "what is left goes with {}", d.leftover.correlates_with.join(", "))?;
    }
    if let Some(absorber) = &d.leftover.absorber {
        writeln!(out, "not named: {absorber}")?;
    }
    if let Some(next) = &d.next_measurement {
        writeln!(out, "next    {}", next.text)?;
        if next.expected_sigma > 0.0 {
            writeln!(
                out,
                "        (they would then lie {:.0} standard deviations apart)",
                next.expected_sigma
            )?;
        }
    }
    if !d.outlier_lines.is_empty() {
        let lines: Vec<String> = d.outlier_lines.iter().take(12).map(u64::to_string).collect();
        let more = if d.outlier_lines.len() > 12 { ", ..." } else { "" };
        writeln!(
            out,
            "left out as outliers: {} rows (lines {}{more})",
            d.outlier_lines.len(),
            lines.join(", ")
        )?;
    }
    for note in &d.notes {
        writeln!(out, "note    {note}")?;
    }
    Ok(())
}
