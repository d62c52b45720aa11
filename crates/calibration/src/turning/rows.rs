//! What was measured on turned test pieces, and what cannot be used of it.

use diagnostic::{Text, both};
use machine_model::{Command, Vector};

use crate::CalibrationError;

/// What was read at one place of a test piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Feature {
    /// Measured minus commanded diameter, mm.
    Diameter,
    /// Deviation of a face along +Z, mm, from a zero of its own.
    Face,
}

/// One reading of a test piece.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedReading {
    /// Which test piece: one clamping, one finishing cut.
    pub part: usize,
    /// Which tool and edge, where that is known.
    pub tool: Option<usize>,
    /// What was read.
    pub feature: Feature,
    /// The command at which the tool cut there: X a radius, mm, machine frame.
    pub command: Command,
    /// The reading, mm.
    pub deviation_mm: f64,
    /// What effects beyond tables and lathe do of it, mm; 0 for none.
    pub by_effects_mm: f64,
    /// Its standard uncertainty, mm, where that is known.
    pub uncertainty_mm: Option<f64>,
    /// Since the spindle was started, s, where that is known.
    pub time_s: Option<f64>,
}

impl TurnedReading {
    /// Place of the tip, mm.
    pub(super) fn tip_mm(&self) -> Vector {
        self.command.linear_mm + self.command.tool_mm
    }

    /// The same place of the same piece, cut at the same time.
    fn is_repeat_of(&self, other: &Self) -> bool {
        let near = |a: Vector, b: Vector| (a - b).amax() <= SAME_MM;
        (self.part, self.tool, self.feature, self.time_s)
            == (other.part, other.tool, other.feature, other.time_s)
            && near(self.tip_mm(), other.tip_mm())
    }
}

/// Places nearer than this are one, mm.
const SAME_MM: f64 = 1e-3;
/// Repeats that differ by more standard uncertainties contradict one another.
const DISAGREE: f64 = 6.0;
/// Finer than any reading, mm.
const FINEST_MM: f64 = 1e-5;
/// Steps of instruments, mm, from a vernier micrometer's: a coarser one is none, however even the readings.
const STEPS_MM: [f64; 9] = [1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 5e-5, 2e-5];

/// Step in which the readings were written, mm: the coarsest of which all are multiples.
pub(super) fn finest_mm(rows: &[TurnedReading]) -> f64 {
    let is_step = |step: &&f64| {
        rows.iter().all(|row| {
            let steps = row.deviation_mm / **step;
            (steps - steps.round()).abs() < 1e-4
        })
    };
    STEPS_MM.iter().find(is_step).copied().unwrap_or(FINEST_MM)
}

/// Refuses sets of readings of which no machine can be had.
pub(super) fn check(
    rows: &[TurnedReading],
    parts: &[usize],
    part_names: &[String],
) -> Result<(), CalibrationError> {
    let diameters = || rows.iter().filter(|row| row.feature == Feature::Diameter);
    if parts.len() < 2 {
        return Err(CalibrationError::TooFew(both!(
            "diameters of {}: one part cannot tell its own bending from the machine",
            "диаметры {:#}: один образец не отличает собственный изгиб от станка",
            if parts.is_empty() {
                Text::pair("no test pieces", "ни одного образца")
            } else {
                Text::pair("one test piece", "одного образца")
            }
        )));
    }
    for part in parts.iter().copied() {
        let places = || diameters().filter(|row| row.part == part).map(|row| row.tip_mm().z);
        let first = places().next().unwrap_or(0.0);
        if places().all(|z| (z - first).abs() <= SAME_MM) {
            return Err(CalibrationError::TooFew(both!(
                "part `{}` has one cross section: a taper needs two along Z or more",
                "у образца `{}` одно сечение: для конусности нужны хотя бы два вдоль Z",
                part_names[part]
            )));
        }
    }
    Ok(())
}

/// Refuses repeats that disagree; `usual_mm` is the uncertainty of readings that state none, mm.
pub(super) fn check_repeats(rows: &[TurnedReading], usual_mm: f64) -> Result<(), CalibrationError> {
    let finest_mm = finest_mm(rows);
    for (point, row) in rows.iter().enumerate() {
        let u = |row: &TurnedReading| row.uncertainty_mm.unwrap_or(usual_mm);
        let before = rows[..point].iter().find(|earlier| {
            let apart = (earlier.deviation_mm - row.deviation_mm).abs();
            row.is_repeat_of(earlier) && apart > (DISAGREE * u(row).max(u(earlier))).max(finest_mm)
        });
        if let Some(earlier) = before {
            let message = both!(
                "the same place was read as {:.3} and as {:.3} um, more than six standard uncertainties apart",
                "одно и то же место снято как {:.3} и как {:.3} мкм, разница больше шести стандартных неопределённостей",
                earlier.deviation_mm * 1e3,
                row.deviation_mm * 1e3
            );
            return Err(CalibrationError::Outlier { point, message });
        }
    }
    Ok(())
}
