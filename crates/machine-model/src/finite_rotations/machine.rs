//! When the second order begins to matter on a machine.

use super::PointErrors;
use crate::{Command, Description, RigidBody, Vector, first_order_error_mm};

/// Where products of errors count most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SecondOrder {
    /// Index of the command.
    pub index: usize,
    /// Distance of the exact product (8) from the first-order sum (14), mm.
    pub difference_mm: f64,
}

/// The scale of the angles at which a machine leaves the first order.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// All angular errors multiplied by this (the publication's k).
    pub scale: f64,
    /// Largest angular error of the machine at that scale, at one of the commands, rad.
    pub angle_rad: f64,
}

/// No angle is scaled beyond this: (6) and the profile's own limit end at 0.1 rad.
const LARGEST_ANGLE_RAD: f64 = 0.1;

impl Description {
    /// The errors of the three linear axes at a command, direction of motion unknown.
    #[must_use]
    pub fn point_errors(&self, command: &Command) -> PointErrors {
        let at = |axis: usize| {
            let data = &self.linear[axis];
            let value = |t: &Option<crate::AxisTables>| t.as_ref().map(|t| t.at(command.linear_mm[axis]));
            match (value(&data.errors), value(&data.errors_negative)) {
                (Some(a), Some(b)) => std::array::from_fn(|i| 0.5 * (a[i] + b[i])),
                (a, _) => a.unwrap_or_default(),
            }
        };
        let six = [0, 1, 2].map(at);
        PointErrors {
            linear_mm: six.map(|e| Vector::new(e[0], e[1], e[2])),
            angular_rad: six.map(|e| Vector::new(e[3], e[4], e[5])),
        }
    }

    /// The same machine with all angular error functions of the linear axes multiplied by `scale`;
    /// squareness stays.
    #[must_use]
    pub fn with_angles_scaled(&self, scale: f64) -> Self {
        let mut machine = self.clone();
        for axis in &mut machine.linear {
            for tables in [&mut axis.errors, &mut axis.errors_negative] {
                *tables = tables.take().map(|t| t.scaled(&[1.0, 1.0, 1.0, scale, scale, scale]));
            }
        }
        machine
    }
}

/// The command, among some, where the exact product and the first-order sum of a machine differ most.
///
/// Both take the machine's chain, levers, squareness and tool vector; rotary axes stand as they are
/// commanded and count as perfect in both. `None` without commands, or for a machine that is none.
#[must_use]
pub fn second_order(machine: &Description, commands: &[Command]) -> Option<SecondOrder> {
    let exact = RigidBody::new(linear_only(machine)).ok()?;
    let differences = commands.iter().map(|command| {
        (crate::PathModel::error_mm(&exact, command) - first_order_error_mm(machine, command)).norm()
    });
    differences.enumerate().fold(None, |most: Option<SecondOrder>, (index, difference_mm)| match most {
        Some(so_far) if so_far.difference_mm >= difference_mm => most,
        _ => Some(SecondOrder { index, difference_mm }),
    })
}

/// How much larger the angular errors of a machine would have to be for products of errors to reach
/// `limit_mm` at one of the commands; `None` where they do not by 0.1 rad, or there are no angles.
///
/// Found by halving on the logarithm of the scale to a relative 10⁻⁶. A scale below 1: they reach it already.
#[must_use]
pub fn threshold(machine: &Description, commands: &[Command], limit_mm: f64) -> Option<Threshold> {
    let angle = |command: &Command| {
        machine.point_errors(command).angular_rad.iter().map(Vector::norm).fold(0.0, f64::max)
    };
    let largest = commands.iter().map(angle).fold(0.0, f64::max);
    if largest <= 0.0 {
        return None;
    }
    let reaches = |scale: f64| {
        second_order(&machine.with_angles_scaled(scale), commands)
            .is_some_and(|found| found.difference_mm >= limit_mm)
    };
    let (mut low, mut high) = (0.0, LARGEST_ANGLE_RAD / largest);
    if !reaches(high) {
        return None;
    }
    if !reaches(0.0) {
        low = high * 1e-9;
    }
    if low == 0.0 {
        // Squareness alone is enough.
        return Some(Threshold { scale: 0.0, angle_rad: 0.0 });
    }
    while high / low > 1.0 + 1e-6 {
        let middle = (low * high).sqrt();
        *(if reaches(middle) { &mut high } else { &mut low }) = middle;
    }
    Some(Threshold { scale: high, angle_rad: high * largest })
}

/// The machine without the errors of its rotary axes, which the first-order sum does not have.
fn linear_only(machine: &Description) -> Description {
    let mut machine = machine.clone();
    for rotary in &mut machine.rotary {
        rotary.shift_mm = Vector::zeros();
        rotary.tilt_rad = Vector::zeros();
        (rotary.errors, rotary.errors_negative, rotary.backlash_rad) = (None, None, 0.0);
    }
    machine
}
