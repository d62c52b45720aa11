//! The readings of circles, with what was fitted and what each cause adds, as CSV.

use std::fmt::Write;

use diagnostic::Text;

use crate::figures::fixed;

use super::bars::{Bars, PLANES, cause_name, sense_name};

/// One row for each reading, and one for each part of it that a cause makes.
pub(super) fn csv(bars: &Bars<'_>) -> String {
    let mut out = String::from("plane,run,direction,angle_deg,series,value_um\n");
    let names = bars.circles.map_or(&[][..], |(_, names)| names);
    for test in bars.tests() {
        let causes: Vec<Text> = test.patterns.iter().map(|p| cause_name(p.cause, test.plane)).collect();
        for trace in &test.traces {
            let run = names.get(trace.run).map_or("", String::as_str);
            // A name may hold anything that a cell of the file held.
            let run = format!("\"{}\"", run.replace('"', "\"\""));
            let sense = sense_name(trace.sense);
            for point in &trace.points {
                let own =
                    [("read", point.read_mm), ("deviation", point.deviation_mm), ("fitted", point.fitted_mm)];
                let parts = causes.iter().map(Text::english).zip(point.causes_mm.iter().copied());
                for (series, value_mm) in own.into_iter().chain(parts) {
                    // Writing to a String cannot fail.
                    let _ = writeln!(
                        out,
                        "{},{run},{sense},{},{series},{}",
                        PLANES[test.plane].0,
                        fixed(point.angle_rad.to_degrees(), 4),
                        fixed(value_mm * 1e3, 4)
                    );
                }
            }
        }
    }
    out
}
