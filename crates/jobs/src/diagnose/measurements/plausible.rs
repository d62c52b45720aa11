//! What the numbers themselves show to be wrong: units and frames.
//!
//! Each limit lies far from anything a machine tool or an instrument does, so that what is refused is a slip of
//! the file and never a bad machine.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use diagnostic::{Code, Text, both};
use gap_diagnosis::{Measurements, Reading};
use machine_profile::Profile;
use measurement_files::Sheet;
use measurement_files::codes::UNIT;

use super::columns::READINGS;
use crate::diagnose::books::Books;
use crate::message::Failure;

/// Rows of different frames in one file.
const FRAMES: Code = Code(916);

/// Commands that span less than this in all were given in metres, mm: no one measures so small a box.
const SMALLEST_SPAN_MM: f64 = 2.0;
/// A measuring frame may lie so far from the machine's, µm, …
const FAR_UM: f64 = 1000.0;
/// … and be turned against it by so much, µm per mm: laid along an edge by eye.
const TURNED_UM_PER_MM: f64 = 5.0;
/// Neighbouring readings that scatter by more come from no instrument used on machine tools, µm: trackers, the
/// coarsest of them, repeat to a few hundredths of a millimetre.
const LARGEST_SCATTER_UM: f64 = 100.0;
/// Readings so much smaller than the model predicts are in the wrong unit.
const TOO_SMALL: f64 = 1.0 / 100.0;
/// No machine is as good as that, µm.
const PERFECT_UM: f64 = 0.05;
/// Fewer differences tell no scatter.
const FEW: usize = 8;

/// The column that holds the first reading of a file.
fn reading_column(sheet: &Sheet) -> &'static str {
    READINGS.into_iter().find(|c| sheet.has(c)).unwrap_or("run")
}

fn refuse(sheet: &Sheet, code: Code, row: usize, column: &str, message: Text, help: Text) -> Failure {
    match sheet.row(row) {
        Some(row) => row.refuse(code, column, message, help).into(),
        None => sheet.refuse_column(code, column, message, help).into(),
    }
}

/// Units and frames that the file alone shows; nothing has been predicted yet. Where somebody says that the columns are
/// as they are named, or positions were measured beside the commands in the same unit, nobody asks for that of scatter.
pub(in crate::diagnose) fn commands_and_frames(
    sheet: &Sheet,
    data: &Measurements,
    profile: &Profile,
    books: Books,
) -> Result<(), Failure> {
    let widest = (0..3).map(|a| data.range_mm(a).1 - data.range_mm(a).0).fold(0.0, f64::max);
    if widest > 0.0 && widest < SMALLEST_SPAN_MM && data.rows.len() > 3 {
        let message = both!(
            "the commands span {widest} mm in all: are x_mm, y_mm, z_mm metres?",
            "команды занимают всего {widest} мм: x_mm, y_mm, z_mm — в метрах?"
        );
        return Err(refuse(
            sheet,
            UNIT,
            0,
            "x_mm",
            message,
            both!("give the commanded positions in millimetres", "дайте заданные положения в миллиметрах"),
        ));
    }
    travel(sheet, data, profile)?;
    sizes(sheet, data, widest)?;
    let positions = ["xm_mm", "ym_mm", "zm_mm"].into_iter().any(|column| sheet.has(column));
    if books == Books::Checked && !positions {
        scatter(sheet, data)?;
    }
    frames(sheet, data, FAR_UM + TURNED_UM_PER_MM * widest)
}

fn travel(sheet: &Sheet, data: &Measurements, profile: &Profile) -> Result<(), Failure> {
    for axis in 0..3 {
        let travel = profile.description.linear[axis].travel_mm;
        let slack = 0.02 * (travel.high - travel.low) + 1.0;
        let outside = data.rows.iter().position(|r| {
            let q = r.command.linear_mm[axis];
            q < travel.low - slack || q > travel.high + slack
        });
        if let Some(row) = outside {
            let letter = ['X', 'Y', 'Z'][axis];
            let message = both!(
                "{letter} {} mm lies outside the profile's travel of {} to {} mm",
                "{letter} {} мм лежит вне хода по профилю, от {} до {} мм",
                data.rows[row].command.linear_mm[axis],
                travel.low,
                travel.high
            );
            let help = both!(
                "give machine coordinates in millimetres, or the profile of this machine",
                "дайте координаты станка в миллиметрах или профиль этого станка"
            );
            return Err(refuse(sheet, UNIT, row, ["x_mm", "y_mm", "z_mm"][axis], message, help));
        }
    }
    Ok(())
}

/// Readings that are far too large.
fn sizes(sheet: &Sheet, data: &Measurements, widest_mm: f64) -> Result<(), Failure> {
    let help = both!(
        "deviations are micrometres, positions are machine coordinates in millimetres: check units and frame",
        "отклонения — в микрометрах, положения — координаты станка в миллиметрах: проверьте единицы и систему координат"
    );
    let sizes = sorted(readings(data).map(|(_, um)| um.abs()));
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    if median > 3.0 * FAR_UM + TURNED_UM_PER_MM * widest_mm {
        let message = both!(
            "half of the deviations exceed {:.1} mm",
            "половина отклонений больше {:.1} мм",
            median * 1e-3
        );
        return Err(refuse(sheet, UNIT, 0, reading_column(sheet), message, help));
    }
    Ok(())
}

/// Readings that scatter by more than those of any instrument for machine tools.
fn scatter(sheet: &Sheet, data: &Measurements) -> Result<(), Failure> {
    let help = both!(
        "deviations are micrometres: check the unit; if it is right, add --as-written",
        "отклонения — в микрометрах: проверьте единицу; если она верна, добавьте --as-written"
    );
    // What lies between the places of a bed's mesh says nothing where they were read again.
    let again = if data.is_area() { repeated_um(data) } else { None };
    let scatter = again.unwrap_or_else(|| scatter_um(data));
    if scatter > LARGEST_SCATTER_UM {
        let message = both!(
            "neighbouring deviations differ by {:.2} mm and more: are they nanometres?",
            "соседние отклонения различаются на {:.2} мм и больше: это нанометры?",
            scatter * 1e-3
        );
        return Err(refuse(sheet, UNIT, 0, reading_column(sheet), message, help));
    }
    Ok(())
}

/// Readings that are far too small, by what the model predicts for the same rows.
pub(in crate::diagnose) fn readings_against_model(sheet: &Sheet, data: &Measurements) -> Result<(), Failure> {
    if data.rows.len() <= 3 {
        return Ok(());
    }
    let help = both!(
        "no machine is that good: are the deviations in millimetres? The columns are micrometres",
        "таких точных станков нет: отклонения в миллиметрах? В столбцах микрометры"
    );
    // Zeros are readings of a coarse dial, whatever the unit.
    let sizes = sorted(readings(data).map(|(_, um)| um.abs()).filter(|um| *um > 0.0));
    let large = sizes.get(sizes.len() * 9 / 10).copied().unwrap_or(0.0);
    if large < PERFECT_UM {
        let message = both!(
            "nine deviations of ten are below {large:.4} um",
            "девять отклонений из десяти меньше {large:.4} мкм"
        );
        return Err(refuse(sheet, UNIT, 0, reading_column(sheet), message, help));
    }
    let predicted = rms(data.rows.iter().map(|r| 1e3 * r.predicted_mm.norm()));
    let measured = rms(readings(data).map(|(_, um)| um));
    let lengths = data.has_lengths();
    if !lengths && predicted > 5.0 && measured < TOO_SMALL * predicted {
        let message = both!(
            "the deviations are {measured:.3} um RMS where the profile predicts {predicted:.1} um: are they millimetres?",
            "среднеквадратичное отклонение {measured:.3} мкм, а профиль предсказывает {predicted:.1} мкм: это миллиметры?"
        );
        return Err(refuse(sheet, UNIT, 0, reading_column(sheet), message, help));
    }
    Ok(())
}

/// Rows and runs that were measured in another frame than the rest.
fn frames(sheet: &Sheet, data: &Measurements, far_um: f64) -> Result<(), Failure> {
    let help = both!(
        "all rows must be in one frame, machine commands and readings alike; convert these rows or leave them out",
        "все строки должны быть в одной системе координат, и команды, и показания; пересчитайте эти строки или исключите их"
    );
    let column = |class: usize| {
        let names = [["dx_um", "xm_mm"], ["dy_um", "ym_mm"], ["dz_um", "zm_mm"]];
        names[class].into_iter().find(|c| sheet.has(c)).unwrap_or("run")
    };
    for class in 0..3 {
        let own: Vec<(usize, f64)> =
            data.scalars(None).iter().filter(|s| s.class == class).map(|s| (s.row, s.gap_um)).collect();
        let all = sorted(own.iter().map(|(_, um)| *um));
        let Some(middle) = all.get(all.len() / 2).copied() else { continue };
        let far: Vec<usize> =
            own.iter().filter(|(_, um)| (um - middle).abs() > far_um).map(|(row, _)| *row).collect();
        // Single blunders are outliers, and the diagnosis leaves them out.
        if far.len() < 3 || 20 * far.len() < own.len() {
            continue;
        }
        let row = far[0];
        let mean = far
            .iter()
            .filter_map(|r| own.iter().find(|(row, _)| row == r))
            .map(|(_, um)| (um - middle).abs())
            .sum::<f64>()
            / far.len() as f64;
        let message = both!(
            "run `{}`, line {}: {} and {} further rows lie {:.1} mm from the rest",
            "проход `{}`, строка {}: {} и ещё строки, всего {}, лежат в {:.1} мм от остальных",
            data.runs[data.rows[row].run],
            data.rows[row].line,
            ["dx", "dy", "dz"][class],
            far.len() - 1,
            mean * 1e-3
        );
        return Err(refuse(sheet, FRAMES, row, column(class), message, help));
    }
    Ok(())
}

/// Row and size of every reading, µm, before anything is predicted.
fn readings(data: &Measurements) -> impl Iterator<Item = (usize, f64)> {
    data.rows.iter().enumerate().flat_map(|(row, r)| {
        let values = match r.reading {
            Reading::Displacement(components) => components,
            Reading::Magnitude(um) => [Some(um), None, None],
            Reading::Length { length_mm, ball_mm } => {
                let bar = (data.geometry.nominal_tip_mm(&r.command) - ball_mm).norm();
                [Some(1e3 * (length_mm - bar)), None, None]
            }
        };
        values.into_iter().flatten().map(move |um| (row, um))
    })
}

/// Scatter of one reading about the straight line between its neighbours, where all three lie on one line, µm: a turned
/// frame cancels.
fn scatter_um(data: &Measurements) -> f64 {
    let mut differences = Vec::new();
    for component in 0..3 {
        let value = |row: &gap_diagnosis::Row| match row.reading {
            Reading::Displacement(all) => all[component],
            _ => None,
        };
        differences.extend(data.rows.windows(3).filter_map(|w| {
            let one_line =
                w.iter().all(|r| r.run == w[0].run && r.command.direction == w[0].command.direction);
            let (a, b, c) = (value(&w[0])?, value(&w[1])?, value(&w[2])?);
            let whole = w[2].command.linear_mm - w[0].command.linear_mm;
            let part = w[1].command.linear_mm - w[0].command.linear_mm;
            let share = if whole.norm() > 0.0 { part.dot(&whole) / whole.norm_squared() } else { 0.5 };
            let beside = (part - whole * share).norm() > 1e-3 * whole.norm() || !(0.0..=1.0).contains(&share);
            let line = (1.0 - share) * a + share * c;
            let spread = (1.0 + share * share + (1.0 - share) * (1.0 - share)).sqrt();
            (one_line && !beside).then(|| (b - line).abs() / spread)
        }));
    }
    robust_um(differences)
}

/// Scatter of the steps between two places that were read more than once, µm: neither offsets of runs nor what lies
/// between the places are in it. `None` where too few were.
fn repeated_um(data: &Measurements) -> Option<f64> {
    let mut steps: BTreeMap<_, [Option<f64>; 3]> = BTreeMap::new();
    let mut differences = Vec::new();
    for pair in data.rows.windows(2).filter(|pair| pair[0].run == pair[1].run) {
        let [Reading::Displacement(from), Reading::Displacement(to)] = [pair[0].reading, pair[1].reading]
        else {
            continue;
        };
        let step = [0, 1, 2].map(|c| Some(to[c]? - from[c]?));
        let command = |row: &gap_diagnosis::Row| {
            let [x, y, z]: [f64; 3] = row.command.linear_mm.into();
            ([x, y, z].map(f64::to_bits), row.command.direction)
        };
        match steps.entry((command(&pair[0]), command(&pair[1]))) {
            Entry::Vacant(first) => drop(first.insert(step)),
            // Four readings scatter twice as much as one.
            Entry::Occupied(first) => {
                differences.extend((0..3).filter_map(|c| Some(0.5 * (step[c]? - first.get()[c]?).abs())))
            }
        }
    }
    (differences.len() >= FEW).then(|| robust_um(differences))
}

/// Standard deviation by the median of absolute values, µm; 0 of few.
fn robust_um(differences: Vec<f64>) -> f64 {
    let differences = sorted(differences.into_iter());
    if differences.len() < FEW { 0.0 } else { 1.4826 * differences[differences.len() / 2] }
}

fn sorted(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v * v, n + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}
