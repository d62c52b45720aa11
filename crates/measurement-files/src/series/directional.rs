//! Tables of mean errors by direction, as the program of API's interferometers saves them (`.pos`).
//!
//! The form is known from a public reader of such files alone (StoneWolfCJQ/LinearCalc, MIT): `Position`, a tab,
//! `Bidirectional Avg Error`, rows of two numbers in mm, then the same with `Forward Directional Avg Error`, and so on. That
//! reader turns the sign of the errors and leaves that of Renishaw's: what they mean is asked.

use diagnostic::both;

use crate::codes::RUNS;
use crate::refusal::Refusal;

use super::file::{File, Origin, Series, Values, numbers};

/// What the heading of such a table ends with.
pub(super) const HEADING: &str = "directional avg error";

/// The table that a heading begins.
#[derive(Clone, Copy, PartialEq)]
enum Part {
    Both,
    Forward,
    Reverse,
    Other,
}

impl Part {
    fn of(heading: &str) -> Self {
        match heading {
            _ if heading.contains("bidirectional avg error") => Self::Both,
            _ if heading.contains("forward directional avg error") => Self::Forward,
            _ if heading.contains("reverse directional") || heading.contains("backward directional") => {
                Self::Reverse
            }
            _ => Self::Other,
        }
    }
}

/// Means by direction; of both where no direction has its own.
pub(super) fn read(file: &File<'_>) -> Result<Series, Box<Refusal>> {
    let (function, axis) = file.function()?;
    let factor = file.factor(function, (function < 3).then_some("mm"))?;
    let sign =
        match file.values(&both!("errors or --values corrections", "errors или --values corrections"))? {
            Values::Corrections => -1.0,
            Values::Errors | Values::Positions => 1.0,
        };
    let mut rows: Vec<(Part, f64, f64)> = Vec::new();
    let mut part = Part::Other;
    for line in file.lines() {
        match numbers(line.text).as_deref() {
            Some([position, error]) => rows.push((part, *position, *error)),
            // A count, a number of the table, and the like.
            Some(_) => part = Part::Other,
            None => part = Part::of(&line.text.to_lowercase()),
        }
    }
    let has = |part: Part| rows.iter().any(|(own, ..)| *own == part);
    let mut series = Series::new(axis, function, file.name, Origin::Instrument);
    let wanted = match (has(Part::Forward), has(Part::Reverse)) {
        (true, true) => [(Part::Forward, 1), (Part::Reverse, -1)].as_slice(),
        _ => [(Part::Both, 0)].as_slice(),
    };
    for (part, direction) in wanted {
        for (_, position, error) in rows.iter().filter(|(own, ..)| own == part) {
            series.push("1", *position, sign * error * factor, *direction);
        }
    }
    if series.readings.is_empty() {
        let message =
            both!("{}: no errors below their heading", "{}: под заголовком нет погрешностей", file.name);
        let help =
            both!("export the measurement again, with its means", "выведите измерение снова, со средними");
        return Err(file.refuse(RUNS, 0..0, message, help));
    }
    Ok(series)
}
