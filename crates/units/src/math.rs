//! Transcendental functions with the same result on every platform.
//!
//! The standard library calls the platform's C library for these, and its last bit differs between
//! platforms; `libm` is compiled from one source. `clippy.toml` bans the others. The square root and
//! the four operations are exact by IEEE 754 and need no wrapper.

/// Sine of an angle in radians.
#[must_use]
pub fn sin(rad: f64) -> f64 {
    libm::sin(rad)
}
/// Cosine of an angle in radians.
#[must_use]
pub fn cos(rad: f64) -> f64 {
    libm::cos(rad)
}
/// Sine and cosine of an angle in radians.
#[must_use]
pub fn sin_cos(rad: f64) -> (f64, f64) {
    libm::sincos(rad)
}
/// Sine and cosine of an angle in degrees, exact at quarter turns.
#[must_use]
pub fn sin_cos_deg(deg: f64) -> (f64, f64) {
    let turns = deg / 90.0;
    if turns == turns.round() {
        return match turns.rem_euclid(4.0) as u8 {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        };
    }
    sin_cos(deg.to_radians())
}
/// Tangent of an angle in radians.
#[must_use]
pub fn tan(rad: f64) -> f64 {
    libm::tan(rad)
}
/// Arc sine in radians.
#[must_use]
pub fn asin(v: f64) -> f64 {
    libm::asin(v)
}
/// Arc cosine in radians.
#[must_use]
pub fn acos(v: f64) -> f64 {
    libm::acos(v)
}
/// Arc tangent in radians.
#[must_use]
pub fn atan(v: f64) -> f64 {
    libm::atan(v)
}
/// Angle of the vector (x, y), in radians.
#[must_use]
pub fn atan2(y: f64, x: f64) -> f64 {
    libm::atan2(y, x)
}
/// Length of the vector (x, y).
#[must_use]
pub fn hypot(x: f64, y: f64) -> f64 {
    libm::hypot(x, y)
}
/// The exponential function.
#[must_use]
pub fn exp(v: f64) -> f64 {
    libm::exp(v)
}
/// The natural logarithm.
#[must_use]
pub fn ln(v: f64) -> f64 {
    libm::log(v)
}
/// `base` to the power of `exponent`.
#[must_use]
pub fn powf(base: f64, exponent: f64) -> f64 {
    libm::pow(base, exponent)
}
