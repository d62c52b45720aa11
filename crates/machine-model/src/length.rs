//! Bounds of a length along a stretch.

use crate::Vector;

/// Bounds of a vector's length along the stretch parameter: of itself, of its first and second derivative, and of the
/// jumps of the first, weighted as those of [`crate::chord_bound`].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Length {
    pub(crate) value: f64,
    pub(crate) first: f64,
    pub(crate) second: f64,
    pub(crate) jumps: f64,
}

impl Length {
    /// Of what does not change.
    pub(crate) fn constant(value: f64) -> Self {
        Self { value, ..Self::default() }
    }

    /// Seen from what turns by `speed` rad a stretch, evenly.
    pub(crate) fn turned(self, speed: f64) -> Self {
        let Self { value, first, second, jumps } = self;
        Self {
            value,
            first: first + speed * value,
            second: second + 2.0 * speed * first + speed * speed * value,
            jumps,
        }
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
            jumps: self.jumps + other.jumps,
        }
    }

    /// Product rule: of a matrix times a vector, or of two vectors.
    pub(crate) fn times(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            first: self.first * other.value + self.value * other.first,
            second: self.second * other.value + 2.0 * self.first * other.first + self.value * other.second,
            jumps: self.jumps * other.value + self.value * other.jumps,
        }
    }

    /// Upper bound of the distance from the chord: equation (12).
    pub(crate) fn leaves_chord_mm(self) -> f64 {
        0.25 * self.jumps + 0.125 * self.second
    }
}

/// What a head carries along a stretch: the nominal tool vector as a box, and as it moves, and the head's own error.
pub(crate) struct Carried {
    pub(crate) low: Vector,
    pub(crate) high: Vector,
    pub(crate) first: f64,
    pub(crate) second: f64,
    pub(crate) error: Length,
}
