//! The places that a base profile knows.

use diagnostic::{Speaks, both};
use machine_model::Engine;

use crate::error::{CalibrationError, LETTERS};
use crate::points::{Base, Point};

/// Indices of the points that lie where the base knows the machine: the others have nothing to be compared with.
///
/// # Errors
/// [`CalibrationError::Axes`] where more than a third lie outside: a base of another machine.
pub(crate) fn known_places(points: &[Point], base: &Base) -> Result<Vec<usize>, CalibrationError> {
    /// Rounding of commands in a file.
    const ROUNDING_MM: f64 = 1e-3;
    let machine = base.machine()?;
    let beyond = |p: &Point| {
        (0..3).find(|&axis| {
            let (q, range) = (p.command.linear_mm[axis], machine.volume().0[axis]);
            q < range.low - ROUNDING_MM || q > range.high + ROUNDING_MM
        })
    };
    if let Some(error) = points.iter().find_map(|p| machine.rotary_inside(&p.command).err()) {
        return Err(CalibrationError::Axes(error.text()));
    }
    let kept: Vec<usize> = (0..points.len()).filter(|&k| beyond(&points[k]).is_none()).collect();
    let outside = points.len() - kept.len();
    match points.iter().find_map(|p| beyond(p).map(|axis| (p, axis))) {
        Some((first, axis)) if 3 * outside > points.len() => Err(CalibrationError::Axes(both!(
            "{outside} of {} places lie outside the base's volume, as {} at {} mm, which it knows from {} to {} mm: is it the profile of another machine?",
            "вне объёма исходного профиля лежит мест: {outside} из {}, например {} в {} мм, а он знает её от {} до {} мм: это профиль другого станка?",
            points.len(),
            LETTERS[axis],
            first.command.linear_mm[axis],
            machine.volume().0[axis].low,
            machine.volume().0[axis].high
        ))),
        _ => Ok(kept),
    }
}
