//! Bounds that hold in the whole volume: cheap to ask, enough for short moves.

use crate::Volume;

/// How many lengths are told apart: 2⁻¹² mm to 2⁵ mm.
pub(crate) const CLASSES: usize = 18;
/// Power of two of the shortest.
const SHORTEST: i32 = -12;

/// What a model's error does anywhere in its volume, in one state of tool and rotary axes.
///
/// Dense programs ask millions of times for a bound that lies far below the tolerance. This one is looked up; the
/// bound of the stretch itself ([`crate::PathModel::chord_bound_mm`]) is only asked for where it matters.
///
/// ```
/// use machine_model::PathModel;
/// # use machine_model::{AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Table, Vector};
/// # fn machine() -> RigidBody {
/// #     let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// #     let long = Table::new(vec![0.0, 100.0], vec![0.0, 0.020], Interpolation::Linear).unwrap();
/// #     linear[0].errors = AxisTables::new(&[Some(long), None, None, None, None, None]);
/// #     let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// #     let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// #     RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
/// # }
/// # fn at(x: f64, y: f64, z: f64) -> Command {
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3], ..Default::default() }
/// # }
/// let machine = machine();
/// let bounds = machine.everywhere(&at(0.0, 0.0, 0.0)).unwrap();
/// // The error grows by 0.2 µm a millimetre, and nowhere faster.
/// let grows = (machine.error_mm(&at(60.0, 0.0, 0.0)) - machine.error_mm(&at(20.0, 0.0, 0.0))).norm();
/// assert!(grows <= bounds.gradient * 40.0);
/// // The longer the move, the more the error may bend on it.
/// assert!(bounds.chord_bound_mm(0.1) <= bounds.chord_bound_mm(10.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Everywhere {
    /// Upper bound of how fast the error changes along any way: `|e(p) - e(q)| ≤ gradient·|p - q|`.
    pub gradient: f64,
    /// Where all of this holds.
    pub volume: Volume,
    pub(crate) bow_mm: [f64; CLASSES],
    pub(crate) bow_of_two_passes_mm: [f64; CLASSES],
    pub(crate) bow_of_four_passes_mm: [f64; CLASSES],
}

impl Everywhere {
    /// Upper bound, mm, of how far the error leaves its chord on a straight stretch inside the volume whose
    /// axes move by at most `longest_mm` each, in the sense of [`crate::PathModel::chord_bound_mm`] with
    /// `passes` at 1. Infinite for long stretches.
    #[must_use]
    #[inline]
    pub fn chord_bound_mm(&self, longest_mm: f64) -> f64 {
        Self::of_class(&self.bow_mm, longest_mm)
    }

    /// The same for any stretch inside the volume that passes a place at most twice: its axes have at most these
    /// first and second derivatives, mm, s running from 0 to 1. Bending adds no more than the error's gradient makes
    /// of it.
    #[must_use]
    #[inline]
    pub fn chord_bound_of_curve_mm(&self, speed_mm: f64, acceleration_mm: f64) -> f64 {
        Self::of_class(&self.bow_of_two_passes_mm, speed_mm) + self.gradient * acceleration_mm / 8.0
    }

    /// The same for one that passes a place up to four times.
    #[must_use]
    #[inline]
    pub fn chord_bound_of_circle_mm(&self, speed_mm: f64, acceleration_mm: f64) -> f64 {
        Self::of_class(&self.bow_of_four_passes_mm, speed_mm) + self.gradient * acceleration_mm / 8.0
    }

    /// The same of a model whose error is larger by one of such bounds: a sum leaves its chord by no more than its parts do.
    ///
    /// * `gradient` – of what is added
    /// * `bow_mm` – for axes that move by so many mm at most, and pass a place so often
    pub(crate) fn with(mut self, gradient: f64, bow_mm: impl Fn(f64, u8) -> f64) -> Self {
        self.gradient += gradient;
        let bows = [
            (&mut self.bow_mm, 1),
            (&mut self.bow_of_two_passes_mm, 2),
            (&mut self.bow_of_four_passes_mm, 4),
        ];
        for (bow, passes) in bows {
            for (bow, longest_mm) in bow.iter_mut().zip(Self::longest_mm()) {
                *bow += bow_mm(longest_mm, passes);
            }
        }
        self
    }

    /// Longest move of an axis by class, mm.
    pub(crate) fn longest_mm() -> [f64; CLASSES] {
        std::array::from_fn(|class| 2f64.powi(SHORTEST + class as i32))
    }

    #[inline]
    fn of_class(bounds: &[f64; CLASSES], longest_mm: f64) -> f64 {
        // The next power of two is one above the exponent; what is not a number has the largest exponent.
        let exponent = (longest_mm.to_bits() >> 52 & 0x7FF) as i32 - 1023;
        let class = (exponent + 1 - SHORTEST).max(0) as usize;
        bounds.get(class).copied().unwrap_or(f64::INFINITY)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_length_finds_the_next_larger_class() {
        let bounds: [f64; CLASSES] = Everywhere::longest_mm();
        for length in [0.0, 1e-9, 0.000_3, 0.4, 0.5, 0.999, 1.0, 31.9] {
            let bound = Everywhere::of_class(&bounds, length);
            assert!(length < bound && bound <= 2.0 * length.max(1.3e-4), "{length}: {bound}");
        }
        for length in [32.0, 1e300, f64::INFINITY, f64::NAN] {
            assert_eq!(Everywhere::of_class(&bounds, length), f64::INFINITY);
        }
    }
}
