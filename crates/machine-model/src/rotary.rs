//! What a rotary axis does with what it carries.

use nalgebra::Matrix3;

use crate::rotation::{around, of_any_size, small};
use crate::{Axis, RotaryAxis, Tilt, Vector};

/// Of which machine something is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Machine {
    /// The one of the drawing.
    Ideal,
    /// The one that was measured.
    Real,
}

/// What an ideal rotary axis does.
pub(crate) fn ideally_turned(rotary: &RotaryAxis, axis: Axis, angle_rad: f64) -> Matrix3<f64> {
    match rotary.direction {
        None => around(axis.direction(), angle_rad),
        Some(direction) => of_any_size(&(direction * angle_rad)),
    }
}

/// Motion of what a rotary axis carries, seen from what carries the axis: turn and shift, equation (9).
pub(crate) fn moved(
    rotary: &RotaryAxis,
    axis: Axis,
    rotary_rad: &Vector,
    machine: Machine,
) -> (Matrix3<f64>, Vector) {
    let angle = rotary_rad[axis.direction()];
    let mut turn = ideally_turned(rotary, axis, angle);
    let mut centre = rotary.centre_mm;
    if machine == Machine::Real {
        if let Some(tables) = &rotary.errors {
            let [x, y, z, a, b, c] = tables.at(angle);
            turn = small(&Vector::new(a, b, c)) * turn;
            centre += Vector::new(x, y, z);
        }
        let lean = small(&rotary.tilt_rad);
        turn = match rotary.tilt {
            Tilt::Body => lean * turn,
            Tilt::Axis => lean * turn * lean.transpose(),
        };
        centre += rotary.shift_mm;
    }
    (turn, centre - turn * rotary.centre_mm)
}
