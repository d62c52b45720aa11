//! Error functions of one axis from readings of an interferometer: means per target and direction, slopes, finer tables.

use diagnostic::both;
use std::collections::BTreeMap;

use machine_model::{Interpolation, Squareness, Table};

use crate::error::CalibrationError;
use crate::iso230_2::Runs;

/// One reading of one function.
#[derive(Clone, Debug, PartialEq)]
pub struct FunctionReading {
    /// Run, by any name.
    pub run: String,
    /// Target position of the axis, mm.
    pub position_mm: f64,
    /// Deviation, mm or rad.
    pub value: f64,
    /// Direction of approach: -1, +1, 0 where unknown.
    pub direction: i8,
}

/// One error function as measured, per direction.
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Target positions, rising, mm.
    pub positions_mm: Vec<f64>,
    /// Mean of all readings per target; where both directions were read, the mean of the two means.
    pub mean: Vec<f64>,
    /// Means of the readings in the positive and in the negative direction, where every target has both.
    pub directions: Option<[Vec<f64>; 2]>,
    /// Standard deviation of one reading within its direction; `None` without repeats.
    pub scatter: Option<f64>,
    /// Readings behind the smallest mean.
    pub count: usize,
    /// The directions keep one distance at all targets ([`crate::measured_line::settle_directions`]).
    pub one_reversal: bool,
}

/// Targets nearer than this are one, mm.
const SAME_MM: f64 = 1e-4;

fn key(position: f64) -> i64 {
    (position / SAME_MM).round() as i64
}

/// The runs of one function, as ISO 230-2 wants them: equation (38).
///
/// A run that turns round within itself counts as one run in each direction.
///
/// # Errors
/// [`CalibrationError::Runs`] where a run misses a target that another one has, with the run and the target.
pub fn runs(readings: &[FunctionReading]) -> Result<Runs, CalibrationError> {
    let mut by_run: BTreeMap<(String, i8), BTreeMap<i64, (f64, f64)>> = BTreeMap::new();
    let mut targets: BTreeMap<i64, f64> = BTreeMap::new();
    for r in readings {
        targets.entry(key(r.position_mm)).or_insert(r.position_mm);
        let own = by_run.entry((r.run.clone(), r.direction.signum())).or_default();
        if own.insert(key(r.position_mm), (r.position_mm, r.value)).is_some() {
            if r.direction == 0 {
                return Err(CalibrationError::Runs(both!(
                    "run `{}` reads the target {} mm twice and does not say from which side: a column `dir` would, 1 towards plus and -1 towards minus",
                    "проход `{}`: цель {} мм снята дважды, и не сказано, с какой стороны: это скажет столбец `dir`, 1 в плюс и -1 в минус",
                    r.run,
                    r.position_mm
                )));
            }
            return Err(CalibrationError::Runs(both!(
                "run `{}` reads the target {} mm twice in the same direction",
                "проход `{}`: цель {} мм в одном направлении снята дважды",
                r.run,
                r.position_mm
            )));
        }
    }
    let mut out = Runs { targets: targets.values().copied().collect(), ..Runs::default() };
    for ((run, direction), own) in &by_run {
        if let Some((_, missing)) = targets.iter().find(|(k, _)| !own.contains_key(k)) {
            return Err(CalibrationError::Runs(both!(
                "run `{run}` has no reading at the target {missing} mm, which other runs have: {} of {} targets",
                "в проходе `{run}` нет отсчёта в цели {missing} мм, которая есть в других проходах: целей {} из {}",
                own.len(),
                targets.len()
            )));
        }
        let values = own.values().map(|(_, v)| *v).collect();
        if *direction < 0 { out.negative.push(values) } else { out.positive.push(values) }
    }
    Ok(out)
}

/// Means per target and direction.
///
/// # Errors
/// As [`runs`]; [`CalibrationError::TooFew`] below two targets.
pub fn function(readings: &[FunctionReading]) -> Result<Function, CalibrationError> {
    let runs = runs(readings)?;
    if runs.targets.len() < 2 {
        return Err(CalibrationError::TooFew(both!(
            "{} target: a table needs two",
            "целей {}: для таблицы нужны две",
            runs.targets.len()
        )));
    }
    let mean_of = |all: &[Vec<f64>], i: usize| all.iter().map(|run| run[i]).sum::<f64>() / all.len() as f64;
    let count = runs.targets.len();
    let side = |all: &[Vec<f64>]| -> Option<Vec<f64>> {
        (!all.is_empty()).then(|| (0..count).map(|i| mean_of(all, i)).collect())
    };
    let (up, down) = (side(&runs.positive), side(&runs.negative));
    let (mut squares, mut free) = (0.0, 0);
    for (all, means) in [(&runs.positive, &up), (&runs.negative, &down)] {
        let Some(means) = means else { continue };
        squares +=
            all.iter().flat_map(|run| run.iter().zip(means)).map(|(v, m)| (v - m) * (v - m)).sum::<f64>();
        free += all.len().saturating_sub(1) * count;
    }
    let mean = match (&up, &down) {
        (Some(u), Some(d)) => u.iter().zip(d).map(|(a, b)| 0.5 * (a + b)).collect(),
        (Some(one), None) | (None, Some(one)) => one.clone(),
        (None, None) => Vec::new(),
    };
    Ok(Function {
        positions_mm: runs.targets,
        mean,
        directions: up.zip(down).map(|(u, d)| [u, d]),
        scatter: (free > 0).then(|| (squares / free as f64).sqrt()),
        count: runs.positive.len() + runs.negative.len(),
        one_reversal: false,
    })
}

/// Least-squares slope and value at position 0 of a function.
#[must_use]
pub fn straight_line(positions: &[f64], values: &[f64]) -> (f64, f64) {
    let n = positions.len() as f64;
    let (q, e) = (positions.iter().sum::<f64>() / n, values.iter().sum::<f64>() / n);
    let spread: f64 = positions.iter().map(|p| (p - q) * (p - q)).sum();
    let common: f64 = positions.iter().zip(values).map(|(p, v)| (p - q) * (v - e)).sum();
    let slope = if spread > 0.0 { common / spread } else { 0.0 };
    (slope, e - slope * q)
}

/// A finer table at an equal step from the first position on, the last position included: straight lines as in Tables
/// 4.5 to 4.7 of Pimushkin 2023, or a cubic that keeps the shape.
///
/// `None` where positions do not rise or the step is not above zero.
#[must_use]
pub fn refined(
    positions: &[f64],
    values: &[f64],
    step: f64,
    interpolation: Interpolation,
) -> Option<(Vec<f64>, Vec<f64>)> {
    let table = Table::new(positions.to_vec(), values.to_vec(), interpolation).ok()?;
    let (first, last) = (*positions.first()?, *positions.last()?);
    if !(step > 0.0 && step.is_finite()) {
        return None;
    }
    let count = ((last - first) / step + 1e-9) as usize + 1;
    let mut fine: Vec<f64> = (0..count).map(|k| first + k as f64 * step).collect();
    if fine.last().is_some_and(|end| last - end > SAME_MM) {
        fine.push(last);
    }
    let out = fine.iter().map(|q| table.value(*q)).collect();
    Some((fine, out))
}

/// What a positive squareness means to the instrument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SquarenessConvention {
    /// Right-handed rotation of the second axis about the third, as in ISO 230-1: EC0Y and EA0Z positive for angles
    /// above 90°, EB0Z positive for an angle below.
    RightHanded,
    /// Positive where the angle between the positive axes is above 90°, in all three planes.
    LargerThan90,
}

/// Squareness in the model's signs from an instrument's: XY, ZX, YZ as read, rad.
#[must_use]
pub fn squareness(read_rad: [f64; 3], convention: SquarenessConvention) -> Squareness {
    let [xy, zx, yz] = read_rad;
    let zx = if convention == SquarenessConvention::LargerThan90 { -zx } else { zx };
    Squareness { ec0y_rad: xy, eb0z_rad: zx, ea0z_rad: yz }
}
