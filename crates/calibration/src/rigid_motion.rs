//! The rigid motion between two sets of points: instrument against machine, exact.

use machine_model::Vector;
use nalgebra::Matrix3;
use units::math::atan2;

/// Points on a line leave the rotation about it open: then it is the smallest. This part of the largest singular value pulls it
/// towards none; it is far above what errors of micrometres do and far below what a second direction does.
const PULL: f64 = 1e-8;

/// Below this sine, angles are as good as none or half a turn.
const HALF_A_TURN: f64 = 1e-9;

/// `to = turn · from + shift`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// Proper rotation.
    pub turn: Matrix3<f64>,
    /// Shift, mm.
    pub shift_mm: Vector,
}

impl RigidMotion {
    /// No motion.
    #[must_use]
    pub fn none() -> Self {
        Self { turn: Matrix3::identity(), shift_mm: Vector::zeros() }
    }

    /// Where it brings a point, mm.
    #[must_use]
    pub fn apply(&self, from_mm: &Vector) -> Vector {
        self.turn * from_mm + self.shift_mm
    }

    /// Its rotation as a vector, rad.
    #[must_use]
    pub fn rotation_rad(&self) -> Vector {
        let r = &self.turn;
        // Twice the sine along the axis: it knows the smallest angles, where a cosine rounds to 1.
        let twice = Vector::new(r.m32 - r.m23, r.m13 - r.m31, r.m21 - r.m12);
        let (sin, cos) = (0.5 * twice.norm(), 0.5 * (r.trace() - 1.0));
        let angle = atan2(sin, cos);
        if sin > HALF_A_TURN {
            return twice * (0.5 * angle / sin);
        }
        if cos > 0.0 {
            return twice * 0.5;
        }
        // Half a turn: R + I has the axis in every column.
        let columns = r + Matrix3::identity();
        let axis = columns.column(columns.diagonal().imax()).normalize();
        axis * angle
    }

    /// The motion that brings `from` nearest to `to`, in the sense of least squares, in closed form by singular values (Kabsch
    /// 1976): for rotations of any size. [`RigidMotion::none`] for no points.
    #[must_use]
    pub fn nearest(from_mm: &[Vector], to_mm: &[Vector]) -> Self {
        let Some((correlation, from, to)) = correlation(from_mm, to_mm) else { return Self::none() };
        let [u, v_t] = orthogonal(&correlation);
        let mut turn = u * v_t;
        if turn.determinant() < 0.0 {
            // The direction that is known least is turned round; nalgebra sorts singular values downwards.
            turn = u * Matrix3::from_diagonal(&Vector::new(1.0, 1.0, -1.0)) * v_t;
        }
        Self { turn, shift_mm: to - turn * from }
    }

    /// Root mean square of what is left between the points, mm.
    #[must_use]
    pub fn rms_mm(&self, from_mm: &[Vector], to_mm: &[Vector]) -> f64 {
        let squares: f64 =
            from_mm.iter().zip(to_mm).map(|(from, to)| (to - self.apply(from)).norm_squared()).sum();
        (squares / from_mm.len().max(1) as f64).sqrt()
    }
}

/// Root mean square of what is left where the points may be mirrored too, mm; `None` where the best is no mirror image.
#[must_use]
pub fn mirrored_rms_mm(from_mm: &[Vector], to_mm: &[Vector]) -> Option<f64> {
    let (correlation, from, to) = correlation(from_mm, to_mm)?;
    let [u, v_t] = orthogonal(&correlation);
    let turn = u * v_t;
    (turn.determinant() < 0.0)
        .then(|| RigidMotion { turn, shift_mm: to - turn * from }.rms_mm(from_mm, to_mm))
}

/// `Σ (to - mean)(from - mean)ᵀ` and the means.
fn correlation(from_mm: &[Vector], to_mm: &[Vector]) -> Option<(Matrix3<f64>, Vector, Vector)> {
    let count = from_mm.len() as f64;
    if from_mm.is_empty() {
        return None;
    }
    let mean = |points: &[Vector]| points.iter().sum::<Vector>() / count;
    let (from, to) = (mean(from_mm), mean(to_mm));
    let sum = from_mm.iter().zip(to_mm).map(|(a, b)| (b - to) * (a - from).transpose()).sum();
    Some((sum, from, to))
}

/// The orthogonal matrix `U Vᵀ` nearest to a correlation, in its two factors.
fn orthogonal(correlation: &Matrix3<f64>) -> [Matrix3<f64>; 2] {
    let pull = Matrix3::identity() * (PULL * correlation.norm());
    let svd = (correlation + pull).svd(true, true);
    svd.u.zip(svd.v_t).map_or([Matrix3::identity(); 2], |(u, v_t)| [u, v_t])
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn cloud() -> Vec<Vector> {
        (0..12)
            .map(|k| {
                Vector::new(f64::from(k % 3) * 40.0, f64::from(k / 3) * -30.0, f64::from(k * k % 7) * 9.0)
            })
            .collect()
    }

    #[test]
    fn motions_of_any_size_come_back() {
        let from = cloud();
        for angle in [0.0, 1e-12, 1e-6, 0.05, 1.6, 3.1, std::f64::consts::PI] {
            let turn = *Rotation3::new(Vector::new(1.0, -2.0, 0.5).normalize() * angle).matrix();
            let shift = Vector::new(900.0, -3.0, 0.2);
            let to: Vec<Vector> = from.iter().map(|p| turn * p + shift).collect();
            let found = RigidMotion::nearest(&from, &to);
            assert!((found.turn - turn).norm() < 1e-7 && found.rms_mm(&from, &to) < 1e-5, "{angle}");
            assert!((found.rotation_rad().norm() - angle).abs() < 1e-7);
            assert_eq!(mirrored_rms_mm(&from, &to), None);
        }
        let to: Vec<Vector> = from.iter().map(|p| Vector::new(p.x, p.y, -p.z)).collect();
        assert!(
            mirrored_rms_mm(&from, &to).unwrap() < 1e-5
                && RigidMotion::nearest(&from, &to).rms_mm(&from, &to) > 5.0
        );
    }

    #[test]
    fn a_line_is_not_turned_about_itself() {
        let from: Vec<Vector> = (0..5).map(|k| Vector::new(f64::from(k) * 100.0, 0.0, 0.0)).collect();
        let wave = |k: usize| 1e-3 * [1.0, -1.0, 0.5, 0.2, -0.7][k];
        let to: Vec<Vector> =
            from.iter().enumerate().map(|(k, p)| p + Vector::new(0.0, wave(k), -wave(k))).collect();
        let found = RigidMotion::nearest(&from, &to);
        assert!(found.rotation_rad().x.abs() < 1e-3, "{}", found.rotation_rad());
    }
}
