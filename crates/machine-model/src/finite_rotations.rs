//! Finite rotations to second order (Pimushkin 2023, chapter 3): equations (20) to (22) of `docs/equations.md`.
//!
//! Every linear axis turns the tool by three small rotations; nine in all. Rotations do not commute, so
//! to second order the result depends on the order in which they are composed, and nobody knows that
//! order: the answer is an interval. The publication evaluates two sign patterns of its formula
//! ([`Truncation::AllPlus`], [`Truncation::AllMinus`]); [`order_interval`] composes the rotations
//! exactly in every admissible order.

mod machine;

pub use machine::{SecondOrder, Threshold, second_order, threshold};

use crate::Vector;
use nalgebra::Quaternion;

/// The six errors of the three linear axes at one point, axes in the order X, Y, Z.
///
/// `linear_mm[i]` is (EXi, EYi, EZi), `angular_rad[i]` is (EAi, EBi, ECi) in ISO 230-1 symbols; the
/// publication writes δ and ε with the axis of motion as the first index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointErrors {
    /// Translations, mm.
    pub linear_mm: [Vector; 3],
    /// Rotations, rad.
    pub angular_rad: [Vector; 3],
}

/// How far, and with which signs, the sum of the nine rotations is carried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Truncation {
    /// Sum of the angles, displacement `E × r`.
    FirstOrder,
    /// All second-order terms with the sign plus (δ₊ of the publication).
    AllPlus,
    /// All second-order terms with the sign minus (δ₋).
    AllMinus,
}

/// How the nine translations are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Translation {
    /// As a sum of vectors: (EXX+EXY+EXZ, EYX+EYY+EYZ, EZX+EZY+EZZ).
    Physical,
    /// As published: the three components *of one axis* added into one direction,
    /// (EXX+EYX+EZX, EXY+EYY+EZY, EXZ+EYZ+EZZ). Not a vector sum; for reproduction only.
    Published,
}

impl PointErrors {
    /// The same point with all angles multiplied by `scale` (the publication's k).
    #[must_use]
    pub fn with_angles_scaled(mut self, scale: f64) -> Self {
        for angles in &mut self.angular_rad {
            *angles *= scale;
        }
        self
    }

    /// Displacement of the tool's origin, mm.
    #[must_use]
    pub fn translation_mm(&self, reading: Translation) -> Vector {
        let [x, y, z] = &self.linear_mm;
        match reading {
            Translation::Physical => x + y + z,
            Translation::Published => Vector::new(x.sum(), y.sum(), z.sum()),
        }
    }

    /// The resulting rotation vector `E = (A, B, C)`, `|E| = 2 tan(φ/2)`, rad, as published (eq. 3.5).
    ///
    /// The last but two product of B is printed as ε_xz·ε_zy; the vector product wants ε_yz·ε_zx. The
    /// printed numbers come from the printed formula, so it stands here; [`order_interval`] does not
    /// use it.
    #[must_use]
    pub fn rotation_as_published(&self, truncation: Truncation) -> Vector {
        let [x, y, z] = &self.angular_rad;
        let sign = match truncation {
            Truncation::FirstOrder => return x + y + z,
            Truncation::AllPlus => 0.5,
            Truncation::AllMinus => -0.5,
        };
        let products = Vector::new(
            x.y * y.z
                + x.z * y.y
                + x.y * z.z
                + y.y * z.z
                + x.z * z.y
                + y.z * z.y
                + x.y * x.z
                + y.y * y.z
                + z.y * z.z,
            x.x * y.z
                + x.z * y.x
                + x.x * z.z
                + y.x * z.z
                + x.z * z.x
                + x.z * z.y
                + x.x * x.z
                + y.x * y.z
                + z.x * z.z,
            x.x * y.y
                + x.y * y.x
                + x.x * z.y
                + y.x * z.y
                + x.y * z.x
                + y.y * z.x
                + x.x * x.y
                + y.x * y.y
                + z.x * z.y,
        );
        x + y + z + products * sign
    }

    /// Volumetric error of a tool vector, mm, as published (eq. 3.9 and 3.10).
    ///
    /// * `tool_mm` – from the point the tables were measured at to the tip, machine frame
    ///
    /// Second order by Rodrigues' formula: `λ (E×r + ½ E×(E×r))`, `λ = 1/(1+|E|²/4)`.
    #[must_use]
    pub fn displacement_mm(&self, tool_mm: &Vector, truncation: Truncation, reading: Translation) -> Vector {
        let rotation = self.rotation_as_published(truncation);
        let turned = match truncation {
            Truncation::FirstOrder => rotation.cross(tool_mm),
            Truncation::AllPlus | Truncation::AllMinus => rodrigues_displacement(&rotation, tool_mm),
        };
        turned + self.translation_mm(reading)
    }
}

/// Displacement of `r` by the finite rotation `θ = 2 tan(φ/2)·e`: exact for any angle below half a turn.
#[must_use]
pub fn rodrigues_displacement(rotation: &Vector, r: &Vector) -> Vector {
    let first = rotation.cross(r);
    (first + rotation.cross(&first) * 0.5) / (1.0 + 0.25 * rotation.norm_squared())
}

/// Smallest and largest volumetric error over all admissible orders of the nine rotations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderInterval {
    /// Smallest |δ|, mm.
    pub low_mm: f64,
    /// Largest |δ|, mm.
    pub high_mm: f64,
    /// Orders composed.
    pub orders: u32,
    /// Lower corner of the box around all displacements, mm.
    pub corner_low_mm: Vector,
    /// Upper corner of that box, mm.
    pub corner_high_mm: Vector,
}

/// The six orders of three things.
const PERMUTATIONS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

/// Exact interval of the volumetric error over all admissible orders of rotation.
///
/// Admissible is what leaves the three rotations of one axis together: each axis' triad in any of its
/// 6 orders, the triads in any of 6 orders, `6⁴ = 1296` compositions, each by exact multiplication of
/// rotations and not by a truncated series. (The publication's bound 2·6⁴ = 2592 counts the order of the
/// first two triads twice; an order of motion that interleaves the triads would need a body that turns
/// about two axes at once.)
#[must_use]
pub fn order_interval(errors: &PointErrors, tool_mm: &Vector, reading: Translation) -> OrderInterval {
    let translation = errors.translation_mm(reading);
    let triads = errors.angular_rad.map(|angles| PERMUTATIONS.map(|order| composed(&angles, order)));
    let mut found = OrderInterval {
        low_mm: f64::INFINITY,
        high_mm: 0.0,
        orders: 0,
        corner_low_mm: Vector::repeat(f64::INFINITY),
        corner_high_mm: Vector::repeat(f64::NEG_INFINITY),
    };
    for order in PERMUTATIONS {
        for first in &triads[order[0]] {
            for second in &triads[order[1]] {
                for third in &triads[order[2]] {
                    let displacement = displacement_by(&(third * second * first), tool_mm) + translation;
                    let length = displacement.norm();
                    found.low_mm = found.low_mm.min(length);
                    found.high_mm = found.high_mm.max(length);
                    found.corner_low_mm = found.corner_low_mm.inf(&displacement);
                    found.corner_high_mm = found.corner_high_mm.sup(&displacement);
                    found.orders += 1;
                }
            }
        }
    }
    found
}

/// Product of the three elementary rotations of one axis, the first of `order` applied first.
///
/// Each is the quaternion `1 + θ/2` with `θ = 2 tan(φ/2)`, the convention of the publication; not
/// normalised, since [`displacement_by`] divides by the norm.
fn composed(angles: &Vector, order: [usize; 3]) -> Quaternion<f64> {
    order.iter().fold(Quaternion::identity(), |before, &i| {
        let mut imaginary = Vector::zeros();
        imaginary[i] = 0.5 * angles[i];
        Quaternion::from_parts(1.0, imaginary) * before
    })
}

/// Displacement of `r` by the rotation of a quaternion of any length, without cancellation: the
/// rotation vector of `w + v` is `2v/w`.
fn displacement_by(rotation: &Quaternion<f64>, r: &Vector) -> Vector {
    rodrigues_displacement(&(rotation.imag() * (2.0 / rotation.scalar())), r)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn sample(scale: f64) -> PointErrors {
        PointErrors {
            linear_mm: [
                Vector::new(0.03, 0.005, 0.0003),
                Vector::new(-0.007, 0.047, 0.0001),
                Vector::new(0.0003, 0.0146, -0.0056),
            ],
            angular_rad: [
                Vector::new(0.035, 0.032, 0.051),
                Vector::new(-0.0266, 0.0111, 0.0213),
                Vector::new(0.0019, 0.01, -0.0049),
            ],
        }
        .with_angles_scaled(scale)
    }

    #[test]
    fn rodrigues_turns_without_stretching() {
        let r = Vector::new(10.0, -3.0, 7.0);
        let theta = Vector::new(0.3, -0.2, 0.5);
        let turned = r + rodrigues_displacement(&theta, &r);
        assert!((turned.norm() - r.norm()).abs() < 1e-13);
        let angle = 2.0 * units::math::atan(theta.norm() / 2.0);
        let expected = Rotation3::from_scaled_axis(theta.normalize() * angle) * r;
        assert!((turned - expected).norm() < 1e-13);
    }

    #[test]
    fn interval_closes_to_the_first_order_as_the_square_of_the_angles() {
        let tool = Vector::new(10.0, 10.0, 10.0);
        let gap = |scale: f64| {
            let errors = sample(scale);
            let interval = order_interval(&errors, &tool, Translation::Physical);
            assert_eq!(interval.orders, 1296);
            let first = errors.displacement_mm(&tool, Truncation::FirstOrder, Translation::Physical).norm();
            (interval.high_mm - first).abs().max((interval.low_mm - first).abs())
        };
        let ratio = gap(1e-2) / gap(1e-3);
        assert!((90.0..110.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn one_rotation_alone_has_no_interval() {
        let mut errors = sample(1.0);
        for (axis, angles) in errors.angular_rad.iter_mut().enumerate() {
            *angles = if axis == 1 { Vector::new(0.0, 0.02, 0.0) } else { Vector::zeros() };
        }
        let tool = Vector::new(10.0, 20.0, -30.0);
        let interval = order_interval(&errors, &tool, Translation::Physical);
        assert!(interval.high_mm - interval.low_mm < 1e-15);
        for truncation in [Truncation::AllPlus, Truncation::AllMinus] {
            let published = errors.displacement_mm(&tool, truncation, Translation::Physical).norm();
            assert!((published - interval.low_mm).abs() < 1e-12);
        }
    }
}
