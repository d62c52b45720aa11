//! Columns that do not say what their names say: signs turned, columns exchanged, directions the other way round, feeds per
//! second, a work offset left in.
//!
//! A slip of the file is tried out: the rows are written as they would be without it, predicted again and laid against the
//! readings. A slip has no number to be fitted, so that it explains more, and more simply, than any effect where it is one.

use gap_diagnosis::{Measurements, Reading, Row, gap_rms_um};
use machine_model::Vector;

/// The gap must fall to less than this share of what it is: two effects of one machine do not cancel so by chance.
const SHARE: f64 = 0.6;
/// Fewer rows prove nothing.
const ROWS: usize = 12;

/// A slip and what the gap is without it.
pub(super) struct Slip {
    /// What was done, and how the file would have to be written.
    pub(super) words: String,
    /// The column to look at.
    pub(super) column: &'static str,
    pub(super) before_um: f64,
    pub(super) after_um: f64,
}

/// One way to have written a row wrong, undone.
struct Trial {
    words: String,
    column: &'static str,
    undo: Box<dyn Fn(&mut Row)>,
}

/// The slip that makes most of the gap, if one makes it; `predict` fills in what the model says of the rows.
pub(super) fn slip<E>(
    data: &Measurements,
    work_offsets: &[(String, [f64; 3])],
    predict: impl Fn(&mut Row) -> Result<(), E>,
) -> Option<Slip> {
    // A model that predicts nothing fits as well whatever a column is taken for.
    let silent = data.rows.iter().all(|row| row.predicted_mm == Vector::zeros());
    if silent || data.rows.len() < ROWS || data.has_magnitudes() {
        return None;
    }
    let before_um = gap_rms_um(data);
    let mut best: Option<Slip> = None;
    for Trial { words, column, undo } in trials(work_offsets) {
        let mut other = data.clone();
        let fits = other.rows.iter_mut().all(|row| {
            undo(row);
            predict(row).is_ok()
        });
        if !fits {
            continue;
        }
        let after_um = gap_rms_um(&other);
        if after_um < best.as_ref().map_or(SHARE * before_um, |b| b.after_um - 1e-9) {
            best = Some(Slip { words, column, before_um, after_um });
        }
    }
    best
}

fn trials(work_offsets: &[(String, [f64; 3])]) -> Vec<Trial> {
    const READINGS: [&str; 3] = ["dx_um", "dy_um", "dz_um"];
    const COMMANDS: [&str; 3] = ["x_mm", "y_mm", "z_mm"];
    const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];
    let mut all: Vec<Trial> = Vec::new();
    let mut trial = |words: String, column: &'static str, undo: Box<dyn Fn(&mut Row)>| {
        all.push(Trial { words, column, undo });
    };
    for (component, column) in READINGS.into_iter().enumerate() {
        let words = format!("the sign of {column} is flipped");
        trial(words, column, Box::new(move |row| read(row, |c| c[component] = c[component].map(|v| -v))));
    }
    trial(
        "the sign of every reading is flipped: commanded minus measured".to_owned(),
        "dx_um",
        Box::new(|row| read(row, |c| *c = c.map(|v| v.map(|v| -v)))),
    );
    for (a, b) in PAIRS {
        let words = format!("the columns {} and {} are swapped", READINGS[a], READINGS[b]);
        trial(words, READINGS[a], Box::new(move |row| read(row, |c| c.swap(a, b))));
        let words = format!("the columns {} and {} are swapped", COMMANDS[a], COMMANDS[b]);
        trial(words, COMMANDS[a], Box::new(move |row| row.command.linear_mm.swap((a, 0), (b, 0))));
    }
    trial(
        "the directions of approach are inverted".to_owned(),
        "dir_x",
        Box::new(|row| row.command.direction = row.command.direction.map(|d| -d)),
    );
    trial(
        "feed_mm_min holds mm/s: the unit is wrong".to_owned(),
        "feed_mm_min",
        Box::new(|row| row.conditions.feed_mm_min = row.conditions.feed_mm_min.map(|f| 60.0 * f)),
    );
    for (name, offset) in work_offsets.iter().filter(|(_, offset)| offset.iter().any(|v| *v != 0.0)) {
        for sign in [1.0, -1.0] {
            let offset = Vector::from(*offset) * sign;
            let what = if sign > 0.0 { "is missing in" } else { "was left in" };
            let words = format!("the work offset {name} {what} the commanded positions");
            trial(words, "x_mm", Box::new(move |row| row.command.linear_mm += offset));
        }
    }
    all
}

fn read(row: &mut Row, change: impl Fn(&mut [Option<f64>; 3])) {
    if let Reading::Displacement(components) = &mut row.reading {
        change(components);
    }
}
