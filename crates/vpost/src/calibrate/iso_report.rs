//! ISO 230-2 as an instrument prints it.

use std::fmt::Write;

use calibration::iso230_2::{Evaluation, Uncertain};

/// Lines of one axis. Deviations in mm or rad; shown in µm or µrad.
pub(super) fn lines(title: &str, found: &Evaluation, scale: f64, unit: &str) -> String {
    let mut out = String::new();
    // Writing to a String cannot fail.
    let _ = write(&mut out, title, found, scale, unit);
    out
}

fn write(out: &mut String, title: &str, e: &Evaluation, scale: f64, unit: &str) -> std::fmt::Result {
    let v = |x: f64| format!("{:>9.3}", x * scale);
    let empty = || format!("{:>9}", "-");
    writeln!(
        out,
        "ISO 230-2   {title}: {} targets, {} runs up, {} down; {unit}",
        e.targets.len(),
        e.runs[0],
        e.runs[1]
    )?;
    writeln!(out, "  target     mean up  mean down          B       s up     s down          R")?;
    for t in &e.targets {
        let cell = |a: Option<f64>| a.map_or_else(empty, v);
        writeln!(
            out,
            "{:>8} {} {} {}  {}  {}  {}",
            crate::number::short(t.position, 3),
            cell(t.positive.map(|a| a.mean)),
            cell(t.negative.map(|a| a.mean)),
            cell(t.reversal),
            cell(t.positive.map(|a| a.deviation)),
            cell(t.negative.map(|a| a.deviation)),
            v(t.repeatability)
        )?;
    }
    let line = |out: &mut String, symbol: &str, name: &str, u: Uncertain| {
        writeln!(out, "  {symbol:<3} {} ± {:<8.3} {name}", v(u.value), u.expanded * scale)
    };
    line(out, "A", "accuracy, both directions", e.accuracy)?;
    if let Some(d) = e.positive {
        line(out, "A↑", "accuracy, up", d.accuracy)?;
    }
    if let Some(d) = e.negative {
        line(out, "A↓", "accuracy, down", d.accuracy)?;
    }
    line(out, "E", "systematic deviation, both directions", e.systematic)?;
    if let Some(d) = e.positive {
        line(out, "E↑", "systematic deviation, up", d.systematic)?;
    }
    if let Some(d) = e.negative {
        line(out, "E↓", "systematic deviation, down", d.systematic)?;
    }
    line(out, "M", "range of the bidirectional means", e.mean_range)?;
    line(out, "R", "repeatability, both directions", e.repeatability)?;
    if let Some(d) = e.positive {
        line(out, "R↑", "repeatability, up", d.repeatability)?;
    }
    if let Some(d) = e.negative {
        line(out, "R↓", "repeatability, down", d.repeatability)?;
    }
    if let Some(b) = e.reversal {
        line(out, "B", "largest reversal value", b)?;
    }
    if let Some(b) = e.mean_reversal {
        writeln!(out, "  B̄   {}            mean reversal value", v(b))?;
    }
    Ok(())
}
