//! Rotations: small ones as vectors, without any transcendental function; large ones as matrices.

use nalgebra::Matrix3;
use units::math;

use crate::Vector;
use crate::real::{Real, Triple};

/// Largest angle for which the series of [`turned_by`] is meant, rad. Larger geometric errors are a mistake in units.
pub const LARGEST_SMALL_ANGLE_RAD: f64 = 0.1;

/// `(R - I)·x` with `R = exp([ε]×)`: equation (6).
///
/// Rodrigues' formula with `sin θ / θ` and `(1 - cos θ) / θ²` as series to θ⁶: the first neglected terms
/// are θ⁸/362880 and θ⁸/3628800, below 3e-14 for θ ≤ 0.1 rad and below 1e-29 at a milliradian.
/// Zero, exactly, for ε = 0.
///
/// * `rotation_rad` – rotation vector ε, rad
#[must_use]
#[inline]
pub fn turned_by(rotation_rad: &Vector, x: &Vector) -> Vector {
    turned(Triple::all(0.0, rotation_rad), Triple::all(0.0, x)).into()
}

/// [`turned_by`], also of several points.
#[inline(always)]
pub(crate) fn turned<T: Real>(rotation_rad: Triple<T>, x: Triple<T>) -> Triple<T> {
    let t = rotation_rad.norm_squared();
    let (one, half) = (t.all(1.0), t.all(0.5));
    let a = one - t * t.all(1.0 / 6.0) * (one - t * t.all(1.0 / 20.0) * (one - t * t.all(1.0 / 42.0)));
    let b =
        half * (one - t * t.all(1.0 / 12.0) * (one - t * t.all(1.0 / 30.0) * (one - t * t.all(1.0 / 56.0))));
    let first = rotation_rad.cross(x);
    first.scaled(a) + rotation_rad.cross(first).scaled(b)
}

/// `exp([ε]×)` as a matrix, from the same series.
#[must_use]
pub fn small(rotation_rad: &Vector) -> Matrix3<f64> {
    let column = |e: Vector| e + turned_by(rotation_rad, &e);
    Matrix3::from_columns(&[column(Vector::x()), column(Vector::y()), column(Vector::z())])
}

/// `exp([ε]×)` for any ε: Rodrigues' formula.
///
/// * `rotation_rad` – rotation vector ε, rad
#[must_use]
pub fn of_any_size(rotation_rad: &Vector) -> Matrix3<f64> {
    let angle = rotation_rad.norm();
    if angle < LARGEST_SMALL_ANGLE_RAD {
        return small(rotation_rad);
    }
    let axis = rotation_rad / angle;
    let (sin, cos) = math::sin_cos(angle);
    let cross = axis.cross_matrix();
    Matrix3::identity() + cross * sin + cross * cross * (1.0 - cos)
}

/// Rotation by any angle around the axis of `direction` (0 X, 1 Y, 2 Z), right-handed.
#[must_use]
pub fn around(direction: usize, angle_rad: f64) -> Matrix3<f64> {
    let (sin, cos) = math::sin_cos(angle_rad);
    match direction {
        0 => Matrix3::new(1.0, 0.0, 0.0, 0.0, cos, -sin, 0.0, sin, cos),
        1 => Matrix3::new(cos, 0.0, sin, 0.0, 1.0, 0.0, -sin, 0.0, cos),
        _ => Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn one_axis_agrees_with_the_exact_rotation() {
        for direction in 0..3 {
            for angle in [0.0, 1e-9, -1e-3, 0.03, 0.1] {
                let mut vector = Vector::zeros();
                vector[direction] = angle;
                assert!((small(&vector) - around(direction, angle)).norm() < 5e-14);
            }
        }
    }

    #[test]
    fn large_and_small_angles_agree() {
        for angle in [0.05, 0.099_999, 0.100_001, 1.0, 3.0] {
            let vector = Vector::new(2.0, -1.0, 0.5).normalize() * angle;
            let exact = nalgebra::Rotation3::new(vector);
            assert!((of_any_size(&vector) - exact.matrix()).norm() < 1e-13, "{angle}");
        }
    }

    proptest! {
        #[test]
        fn series_is_a_rotation(v in prop::array::uniform3(-0.057f64..0.057), x in prop::array::uniform3(-1e3f64..1e3)) {
            let (v, x) = (Vector::from(v), Vector::from(x));
            let r = small(&v);
            prop_assert!((r.transpose() * r - Matrix3::identity()).norm() < 1e-13);
            prop_assert!((r * v - v).norm() < 1e-14);
            prop_assert!((r * x - x - turned_by(&v, &x)).norm() < 1e-12);
            let exact = nalgebra::Rotation3::new(v) * x;
            prop_assert!((r * x - exact).norm() < 1e-10);
        }
    }
}
