//! What a rotary axis does with what it carries.

use nalgebra::Matrix3;

use crate::axis_tables::AxisTables;
use crate::rotation::{around, of_any_size, small};
use crate::{Axis, Command, RotaryAxis, Tilt, Vector};

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

/// A rotary axis of the chain, with the tables of its errors by direction.
#[derive(Clone, Debug)]
pub(crate) struct Swivel {
    pub(crate) data: RotaryAxis,
    axis: Axis,
    /// Of motion in the negative direction, of neither, in the positive; or one for all.
    by_direction: Vec<AxisTables>,
    /// How its line leans.
    lean: Matrix3<f64>,
}

impl Swivel {
    pub(crate) fn new(data: &RotaryAxis, axis: Axis) -> Self {
        let by_direction = match (&data.errors, &data.errors_negative) {
            (Some(positive), Some(negative)) => match AxisTables::mean(positive, negative) {
                Some(mean) => vec![negative.clone(), mean, positive.clone()],
                None => vec![positive.clone()],
            },
            (Some(all), None) => vec![all.clone()],
            (None, _) => Vec::new(),
        };
        Self { data: data.clone(), axis, by_direction, lean: small(&data.tilt_rad) }
    }

    /// The tables for what moved in a direction last.
    pub(crate) fn tables(&self, direction: i8) -> Option<&AxisTables> {
        match self.by_direction.as_slice() {
            [negative, mean, positive] => Some([negative, mean, positive][(direction.signum() + 1) as usize]),
            all => all.first(),
        }
    }

    /// How much further than commanded it stands that came in a direction, by its play alone, rad.
    pub(crate) fn behind_rad(&self, direction: i8) -> f64 {
        -0.5 * self.data.backlash_rad * f64::from(direction.signum())
    }

    /// Unit vector of its line.
    fn line(&self) -> Vector {
        self.data.direction.unwrap_or_else(|| Vector::ith(self.axis.direction(), 1.0))
    }

    /// Reversal value at an angle, rad about its line: the error coming from above less that coming from below.
    pub(crate) fn reversal_rad(&self, angle_rad: f64) -> f64 {
        let of_tables = match self.by_direction.as_slice() {
            [negative, _, positive] => {
                let range = self.data.calibrated_rad();
                let at = angle_rad.clamp(range.low, range.high);
                let (down, up) = (negative.at(at), positive.at(at));
                (3..6).map(|k| (down[k] - up[k]) * self.line()[k - 3]).sum()
            }
            _ => 0.0,
        };
        of_tables + self.data.backlash_rad
    }

    /// Motion of what it carries, seen from what carries it: turn and shift, equation (9), with its play (25).
    pub(crate) fn moved(&self, command: &Command, machine: Machine) -> (Matrix3<f64>, Vector) {
        let (data, k) = (&self.data, self.axis.direction());
        let angle = command.rotary_rad[k];
        if machine == Machine::Ideal {
            let turn = ideally_turned(data, self.axis, angle);
            return (turn, data.centre_mm - turn * data.centre_mm);
        }
        let (direction, lag) = (command.rotary_play.direction[k], command.rotary_play.lag_rad[k]);
        let mut turn = ideally_turned(data, self.axis, angle + self.behind_rad(direction) + lag);
        let mut centre = data.centre_mm;
        if let Some(tables) = self.tables(direction) {
            let [x, y, z, a, b, c] = tables.at(angle);
            turn = small(&Vector::new(a, b, c)) * turn;
            centre += Vector::new(x, y, z);
        }
        turn = match data.tilt {
            Tilt::Body => self.lean * turn,
            Tilt::Axis => self.lean * turn * self.lean.transpose(),
        };
        centre += data.shift_mm;
        (turn, centre - turn * data.centre_mm)
    }
}
