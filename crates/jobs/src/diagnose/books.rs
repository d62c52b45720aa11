//! Columns that do not say what their names say: signs turned, columns exchanged, directions the other way round, feeds per
//! second, a work offset left in.
//!
//! A slip of the file is tried out: the rows are written as they would be without it, predicted again and laid against the
//! readings. A slip has no number to be fitted, so that it explains more, and more simply, than any effect where it is one.

use diagnostic::{Text, both};
use gap_diagnosis::{Measurements, Options, Reading, Row, diagnose, gap_rms_um};
use machine_model::Vector;

/// Whether rows that fit better with a sign flipped or two columns swapped are refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Books {
    /// They are.
    Checked,
    /// The columns are taken as they are named.
    AsWritten,
}

/// The gap must fall to less than this share of what it is: two effects of one machine do not cancel so by chance.
const SHARE: f64 = 0.6;
/// The same for a slip with numbers that are fitted.
const SHARE_FITTED: f64 = 0.35;
/// Fewer rows prove nothing.
const ROWS: usize = 12;

/// A slip and what the gap is without it.
pub(super) struct Slip {
    /// What was done, and how the file would have to be written.
    pub(super) words: Text,
    /// The column to look at.
    pub(super) column: &'static str,
    pub(super) before_um: f64,
    pub(super) after_um: f64,
}

/// One way to have written a row wrong, undone.
struct Trial {
    words: Text,
    column: &'static str,
    /// The linear axes were elsewhere than the file says.
    moves: bool,
    undo: Box<dyn Fn(&mut Row)>,
}

/// The slip that makes most of the gap, if one makes it; `predict` fills in what the model says of the rows.
pub(super) fn slip<E>(
    data: &Measurements,
    work_offsets: &[(String, [f64; 3])],
    travel_mm: [(f64, f64); 3],
    predict: impl Fn(&mut Row) -> Result<(), E>,
) -> Option<Slip> {
    // A model that predicts nothing fits as well whatever a column is taken for.
    let silent = data.rows.iter().all(|row| row.predicted_mm == Vector::zeros());
    if silent || data.rows.len() < ROWS || data.has_magnitudes() {
        return None;
    }
    let before_um = gap_rms_um(data);
    let mut best: Option<Slip> = None;
    // Where a rotary axis turns, one that is beside its place looks like an offset, and so do two linear axes exchanged
    // that stand at few places.
    let turns = data.rows.windows(2).any(|pair| pair[0].command.rotary_rad != pair[1].command.rotary_rad);
    for Trial { words, column, undo, .. } in trials(work_offsets).into_iter().filter(|t| !(turns && t.moves))
    {
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
    best.or_else(|| if turns { None } else { offset_left_in(data, travel_mm, before_um, &predict) })
}

/// True where causes explain what a slip does, and better: two columns exchanged take a part of many a scale off.
pub(super) fn is_caused(data: &Measurements, slip: &Slip) -> bool {
    /// A slip has no number to be fitted: it stands where causes leave as much or hardly less.
    const BETTER: f64 = 0.7;
    let causes = diagnose(data, None, &Options::default()).causes;
    causes.last().is_some_and(|last| last.rms_after_um < BETTER * slip.after_um)
}

/// A work offset that the profile does not know: the rows, moved by one vector, fit the model's curves.
///
/// Three numbers are fitted, so that more must be explained than by a slip without any; and the curves must be seen: what
/// is a straight line in the model fits wherever it is laid.
fn offset_left_in<E>(
    data: &Measurements,
    travel_mm: [(f64, f64); 3],
    before_um: f64,
    predict: &impl Fn(&mut Row) -> Result<(), E>,
) -> Option<Slip> {
    /// Rows that the search looks at.
    const SOME: usize = 160;
    /// Steps per axis that it begins with.
    const STEPS: i32 = 12;
    /// Rounds over the axes.
    const ROUNDS: usize = 7;
    let stride = data.rows.len().div_ceil(SOME).max(1);
    let few = Measurements { rows: data.rows.iter().step_by(stride).copied().collect(), ..data.clone() };
    let left = |rows: &Measurements, offset: Vector| {
        let mut moved = rows.clone();
        let fits = moved.rows.iter_mut().all(|row| {
            row.command.linear_mm += offset;
            predict(row).is_ok()
        });
        fits.then(|| gap_rms_um(&moved))
    };
    let start_um = left(&few, Vector::zeros())?;
    let free = [0, 1, 2].map(|axis| {
        let (low, high) = data.range_mm(axis);
        (travel_mm[axis].0 - low, travel_mm[axis].1 - high)
    });
    let (mut offset, mut least) = (Vector::zeros(), start_um);
    let mut steps = free.map(|(low, high)| (high - low).max(0.0) / f64::from(STEPS));
    for round in 0..ROUNDS {
        for axis in 0..3 {
            if steps[axis] < 1e-3 {
                continue;
            }
            let here = offset[axis];
            let tries: Vec<f64> = if round == 0 {
                (0..=STEPS).map(|k| free[axis].0 + steps[axis] * f64::from(k)).collect()
            } else {
                (-3..=3).map(|k| here + 0.35 * steps[axis] * f64::from(k)).collect()
            };
            for place in tries {
                let mut other = offset;
                other[axis] = place.clamp(free[axis].0, free[axis].1.max(free[axis].0));
                if let Some(um) = left(&few, other).filter(|um| *um < least) {
                    (offset, least) = (other, um);
                }
            }
        }
        // The first look at one axis was made with the others where they do not belong.
        if round > 0 {
            steps = steps.map(|step| 0.4 * step);
        }
    }
    if least > SHARE_FITTED * start_um {
        return None;
    }
    let after_um = left(data, offset).filter(|after| *after < SHARE_FITTED * before_um)?;
    let words = both!(
        "a work offset of about X {:.1} Y {:.1} Z {:.1} mm was left in: the commanded positions are not machine coordinates",
        "осталось смещение нуля около X {:.1} Y {:.1} Z {:.1} мм: заданные положения — не координаты станка",
        offset.x,
        offset.y,
        offset.z
    );
    Some(Slip { words, column: "x_mm", before_um, after_um })
}

fn trials(work_offsets: &[(String, [f64; 3])]) -> Vec<Trial> {
    const READINGS: [&str; 3] = ["dx_um", "dy_um", "dz_um"];
    const COMMANDS: [&str; 3] = ["x_mm", "y_mm", "z_mm"];
    const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];
    let mut all: Vec<Trial> = Vec::new();
    let mut trial = |words: Text, column: &'static str, undo: Box<dyn Fn(&mut Row)>| {
        let moves = COMMANDS.contains(&column);
        all.push(Trial { words, column, moves, undo });
    };
    for (component, column) in READINGS.into_iter().enumerate() {
        let words = both!("the sign of {column} is flipped", "у столбца {column} обратный знак");
        trial(words, column, Box::new(move |row| read(row, |c| c[component] = c[component].map(|v| -v))));
    }
    trial(
        both!(
            "the sign of every reading is flipped: commanded minus measured",
            "у всех показаний обратный знак: команда минус измеренное"
        ),
        "dx_um",
        Box::new(|row| read(row, |c| *c = c.map(|v| v.map(|v| -v)))),
    );
    for (a, b) in PAIRS {
        let words = both!(
            "the columns {} and {} are swapped",
            "столбцы {} и {} переставлены",
            READINGS[a],
            READINGS[b]
        );
        trial(words, READINGS[a], Box::new(move |row| read(row, |c| c.swap(a, b))));
        let words = both!(
            "the columns {} and {} are swapped",
            "столбцы {} и {} переставлены",
            COMMANDS[a],
            COMMANDS[b]
        );
        trial(words, COMMANDS[a], Box::new(move |row| row.command.linear_mm.swap((a, 0), (b, 0))));
    }
    trial(
        both!("the directions of approach are inverted", "направления подхода обратные"),
        "dir_x",
        Box::new(|row| row.command.direction = row.command.direction.map(|d| -d)),
    );
    for (axis, column) in ["dir_x", "dir_y", "dir_z"].into_iter().enumerate() {
        let words =
            both!("the direction of approach {column} is inverted", "направление подхода {column} обратное");
        trial(words, column, Box::new(move |row| row.command.direction[axis] *= -1));
    }
    trial(
        both!("feed_mm_min holds mm/s: the unit is wrong", "в feed_mm_min стоят мм/с: единица не та"),
        "feed_mm_min",
        Box::new(|row| row.conditions.feed_mm_min = row.conditions.feed_mm_min.map(|f| 60.0 * f)),
    );
    for (name, offset) in work_offsets.iter().filter(|(_, offset)| offset.iter().any(|v| *v != 0.0)) {
        for sign in [1.0, -1.0] {
            let offset = Vector::from(*offset) * sign;
            let what = if sign > 0.0 {
                both!("is missing in", "вычтено из заданных положений")
            } else {
                both!("was left in", "осталось в заданных положениях")
            };
            let words = both!(
                "the work offset {name} {what} the commanded positions",
                "смещение нуля {name} {what:#}"
            );
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_slips_of_the_linear_commands_move_the_axes() {
        let moved: Vec<String> = trials(&[("G54".to_owned(), [10.0, 0.0, 0.0])])
            .into_iter()
            .filter(|t| t.moves)
            .map(|t| t.words.english().to_owned())
            .collect();
        assert_eq!(moved.len(), 5, "{moved:?}");
        assert!(moved.iter().all(|words| words.contains("_mm") || words.contains("G54")), "{moved:?}");
    }
}
