//! The axis that the workpiece turns about, and how it moves while it turns.

use machine_model::Vector;
use machine_model::rotation::{around, of_any_size};
use nalgebra::Matrix3;
use units::math;

/// One term of a Fourier series over the spindle's angle: `amplitude·cos(order·φ + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Harmonic {
    /// Waves a turn; 1 or more.
    pub order: u32,
    /// mm, or rad of a tilt.
    pub amplitude: f64,
    /// At φ = 0, rad.
    pub phase_rad: f64,
}

/// Error motion that repeats every turn (ISO 230-7, synchronous), machine frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ErrorMotion {
    /// Radial, along X.
    pub x: Vec<Harmonic>,
    /// Radial, along Y.
    pub y: Vec<Harmonic>,
    /// Axial.
    pub z: Vec<Harmonic>,
    /// Tilt about X, rad.
    pub a: Vec<Harmonic>,
    /// Tilt about Y, rad.
    pub b: Vec<Harmonic>,
}

impl ErrorMotion {
    /// Displacement, mm, and tilt, rad, at a spindle angle.
    #[must_use]
    pub fn at(&self, angle_rad: f64) -> (Vector, Vector) {
        let sum = |series: &[Harmonic]| {
            let term = |h: &Harmonic| h.amplitude * math::cos(f64::from(h.order) * angle_rad + h.phase_rad);
            series.iter().map(term).sum::<f64>()
        };
        (Vector::new(sum(&self.x), sum(&self.y), sum(&self.z)), Vector::new(sum(&self.a), sum(&self.b), 0.0))
    }

    /// True where the spindle turns as an ideal one.
    #[must_use]
    pub fn is_none(&self) -> bool {
        [&self.x, &self.y, &self.z, &self.a, &self.b].into_iter().flatten().all(|h| h.amplitude == 0.0)
    }
}

/// A tailstock: its centre bears the workpiece.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tailstock {
    /// L, from the chuck's face to its centre, mm.
    pub at_mm: f64,
    /// ΔX3, ΔY3 (Spirin 2012), mm, against the spindle's nominal axis: positive where the turned radius grows, the
    /// workpiece's axis standing away from the tool.
    pub offset_mm: [f64; 2],
}

/// A lathe's spindle, machine frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spindle {
    /// Machine X and Y of its nominal axis, and machine Z of the chuck's face, from which the workpiece's Z counts, mm.
    pub centre_mm: Vector,
    /// EX0S, EY0S at machine Z 0, and what it has grown in Z, mm: real minus nominal.
    pub shift_mm: Vector,
    /// EA0S, EB0S, rad, signs as for the axis Z: EB0S leads the axis to +X, EA0S to −Y, with growing Z.
    pub tilt_rad: [f64; 2],
    /// ΔX, ΔY at the chuck (Spirin 2012), mm, signs as those of the tailstock.
    pub headstock_mm: [f64; 2],
    /// The tailstock, where it bears the workpiece.
    pub tailstock: Option<Tailstock>,
    /// What it does while it turns.
    pub synchronous: ErrorMotion,
    /// Width of what it does besides and does not repeat, mm.
    pub asynchronous_mm: f64,
}

impl Spindle {
    /// The frame of the workpiece's axis, mean of a turn: a point at the chuck, and a proper rotation whose third column is
    /// the axis. Equation (71).
    ///
    /// Alone the spindle's axis runs through `centre + (EX0S, EY0S)` at machine Z 0 along `n = (EB0S, −EA0S, 1)`; its
    /// point at the chuck's face, less (ΔX, ΔY), is `P_0`. With a tailstock the axis runs from `P_0` to
    /// `centre + (−ΔX3, −ΔY3, L)`. The frame is turned onto it the shortest way from Z.
    #[must_use]
    pub fn frame(&self) -> (Vector, Matrix3<f64>) {
        let face = self.centre_mm.z;
        let alone = Vector::new(self.tilt_rad[1], -self.tilt_rad[0], 1.0);
        let [x, y] = self.headstock_mm;
        let leaning = Vector::new(alone.x * face - x, alone.y * face - y, 0.0);
        let chuck = self.centre_mm + self.shift_mm + leaning;
        let along = self.tailstock.map_or(alone, |Tailstock { at_mm, offset_mm: [x, y] }| {
            self.centre_mm + Vector::new(-x, -y, at_mm) - chuck
        });
        // By the sine: the arc cosine of an angle of microradians is off by up to 1e-8 rad.
        let along = along.normalize();
        let sine = Vector::z().cross(&along).cross_matrix();
        (chuck, Matrix3::identity() + sine + sine * sine / (1.0 + along.z))
    }

    /// Where a point of the machine is in the workpiece's frame, the spindle at an angle. Equation (72).
    ///
    /// `w = R_z(−φ)·R_t(φ)ᵀ·(Bᵀ·(p − P_0) − d(φ))`: the workpiece turns about the axis and moves with the error motion.
    #[must_use]
    pub fn seen_from_workpiece(&self, axis_mm: &Vector, angle_rad: f64) -> Vector {
        let (shift, tilt) = self.synchronous.at(angle_rad);
        around(2, -angle_rad) * (of_any_size(&tilt).transpose() * (axis_mm - shift))
    }
}
