//! ISO 230-2 as an instrument prints it.

use std::fmt::Write;

use calibration::iso230_2::{Evaluation, Uncertain};

/// One of the standard's figures.
pub(super) struct Figure {
    /// `A↑`
    pub(super) symbol: &'static str,
    pub(super) name: &'static str,
    pub(super) found: Uncertain,
}

/// The figures that the runs give, in the order in which they are printed.
pub(super) fn figures(e: &Evaluation) -> Vec<Figure> {
    let of = |symbol, name, found: Option<Uncertain>| found.map(|found| Figure { symbol, name, found });
    let (up, down) = (e.positive, e.negative);
    [
        of("A", "accuracy, both directions", Some(e.accuracy)),
        of("A↑", "accuracy, up", up.map(|d| d.accuracy)),
        of("A↓", "accuracy, down", down.map(|d| d.accuracy)),
        of("E", "systematic deviation, both directions", Some(e.systematic)),
        of("E↑", "systematic deviation, up", up.map(|d| d.systematic)),
        of("E↓", "systematic deviation, down", down.map(|d| d.systematic)),
        of("M", "range of the bidirectional means", Some(e.mean_range)),
        of("R", "repeatability, both directions", Some(e.repeatability)),
        of("R↑", "repeatability, up", up.map(|d| d.repeatability)),
        of("R↓", "repeatability, down", down.map(|d| d.repeatability)),
        of("B", "largest reversal value", e.reversal),
    ]
    .into_iter()
    .flatten()
    .collect()
}

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
    for Figure { symbol, name, found } in figures(e) {
        writeln!(out, "  {symbol:<3} {} ± {:<8.3} {name}", v(found.value), found.expanded * scale)?;
    }
    if let Some(b) = e.mean_reversal {
        writeln!(out, "  B̄   {}            mean reversal value", v(b))?;
    }
    Ok(())
}
