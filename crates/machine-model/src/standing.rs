//! What the rotary axes do where they stand, and the last places where they stood.

use std::cell::RefCell;

use nalgebra::Matrix3;

use crate::{Command, Vector};

/// What the rotary axes do where they stand: the same for every place of the linear axes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Standing {
    /// From the frame of the linear axes to the workpiece's, ideal table.
    pub(crate) turn: Matrix3<f64>,
    pub(crate) shift_mm: Vector,
    /// As the real table turns them.
    pub(crate) real_turn: Matrix3<f64>,
    /// `A` of equation (9), where the table has errors.
    pub(crate) error: Option<(Matrix3<f64>, Vector)>,
    /// Tool vector in the directions of the linear axes as an ideal head turns it, and by what the real one is off, mm.
    pub(crate) tool_mm: Vector,
    pub(crate) tool_error_mm: Vector,
    /// Z of the spindle in the directions of the linear axes, turned by an ideal head and by the real one.
    pub(crate) spindle: [Vector; 2],
}

impl Standing {
    /// Where the linear axes of an ideal machine have to stand so that its tip is there, both mm.
    pub(crate) fn reach(&self, tip_mm: &Vector) -> Vector {
        self.turn.tr_mul(&(tip_mm - self.shift_mm)) - self.tool_mm
    }

    /// Tip of an ideal machine, mm, workpiece frame: the inverse of [`Self::reach`].
    pub(crate) fn nominal_position(&self, linear_mm: &Vector) -> Vector {
        self.turn * (linear_mm + self.tool_mm) + self.shift_mm
    }
}

/// All of a command that a [`Standing`] depends on, to the bit.
#[derive(Clone, Copy, Debug)]
struct Key {
    numbers: [u64; 9],
    directions: [i8; 3],
}

impl Key {
    fn of(command: &Command) -> Self {
        let Command { rotary_rad, tool_mm, rotary_play, .. } = command;
        let [a, b, c] =
            [rotary_rad, tool_mm, &rotary_play.lag_rad].map(|v| [v.x, v.y, v.z].map(f64::to_bits));
        Self {
            numbers: [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2]],
            directions: rotary_play.direction,
        }
    }

    /// All at once: so few numbers are compared faster than by a call.
    fn is(&self, other: &Self) -> bool {
        let pairs = self.numbers.iter().zip(&other.numbers);
        pairs.fold(0, |differ, (a, b)| differ | (a ^ b)) == 0 && self.directions == other.directions
    }
}

/// A block asks for its start, its middle and its end, each on either side of their play.
const KEPT: usize = 6;

/// The last states that a thread has asked for: a block asks dozens of times for the same few. What is kept is what would be
/// worked out, so that nothing depends on who asked before.
#[derive(Debug, Default)]
pub(crate) struct Remembered {
    kept: [Option<(Key, Standing)>; KEPT],
    /// The one that has to go next.
    next: usize,
}

impl Remembered {
    /// Uses what a state is, worked out where it is none of the last.
    pub(crate) fn with<R>(
        of: &RefCell<Self>,
        command: &Command,
        work_out: impl FnOnce() -> Standing,
        use_it: impl FnOnce(&Standing) -> R,
    ) -> R {
        let key = Key::of(command);
        if let Some((_, known)) = of.borrow().kept.iter().flatten().find(|(own, _)| own.is(&key)) {
            return use_it(known);
        }
        let standing = work_out();
        // Not while another is used: then it is worked out again when it is asked for again.
        if let Ok(mut remembered) = of.try_borrow_mut() {
            let next = remembered.next;
            remembered.kept[next] = Some((key, standing));
            remembered.next = (next + 1) % KEPT;
        }
        use_it(&standing)
    }
}
