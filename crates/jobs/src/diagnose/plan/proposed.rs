//! The lines of the measurement that a diagnosis proposes.

use diagnostic::notice;
use gap_diagnosis::{NextMeasurement, Row};
use machine_model::{Vector, Volume};

use super::line::{Line, SLOW_MM_MIN, Stop, rounded};
use crate::message::{Failure, OPTION};

/// Way before the first reading and beyond the last, share of the line: an axis comes to each from the side that is read.
const OVERRUN: f64 = 0.03;

/// A line for each run, with room at its ends; where the volume ends there, the readings move in.
pub(super) fn proposed(next: &NextMeasurement, volume: Volume) -> Result<Vec<Line>, Failure> {
    next.rows.chunk_by(|a, b| a.run == b.run).map(|rows| line(rows, next.run(&rows[0]), volume)).collect()
}

fn line(rows: &[Row], run: String, volume: Volume) -> Result<Line, Failure> {
    let command = &rows[0].command;
    if command.rotary_rad != Vector::zeros() {
        return Err(Failure::usage(notice!(OPTION;
            "the next measurement is a line with a rotary axis turned, and these lines keep rotary axes at zero",
            "следующее измерение — линия с повёрнутой осью, а эти линии держат поворотные оси в нуле";
            "take its rows from `next_measurement` of `--json`",
            "возьмите его строки из `next_measurement` в `--json`"
        )));
    }
    let (from, to) = (command.linear_mm, rows[rows.len() / 2 - 1].command.linear_mm);
    let way = to - from;
    let overrun = way * OVERRUN;
    // Room that the volume does not leave is taken from the line.
    let start = if volume.contains(&(from - overrun)) { from } else { from + overrun };
    let end = if volume.contains(&(to + overrun)) { to } else { to - overrun };
    let stop = |row: &Row| {
        let share = (row.command.linear_mm - from).dot(&way) / way.norm_squared();
        Stop {
            at_mm: rounded(start.lerp(&end, share)),
            rotary_deg: [0.0; 3],
            direction: row.command.direction,
        }
    };
    let feed = rows[0].conditions.feed_mm_min;
    Ok(Line {
        run,
        wait_s: 0.0,
        feed_mm_min: feed.unwrap_or(SLOW_MM_MIN),
        flying: feed.is_some(),
        tool_mm: command.tool_mm,
        conditions: rows[0].conditions,
        repeat: 1,
        before_mm: start - overrun,
        turn_mm: end + overrun,
        stops: rows.iter().map(stop).collect(),
        swing: None,
    })
}
