//! What the user may choose of a correction.

/// What happens to feed motion outside the calibrated volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outside {
    /// It is an error.
    Refuse,
    /// It takes the correction of the volume's nearest point.
    Clamp,
}

/// What the user may choose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Largest distance of the real path from the programmed one, rounding apart, mm.
    pub tolerance_mm: f64,
    /// Feed motion outside the calibrated volume.
    pub outside: Outside,
    /// No piece is made shorter than this, mm; 0 for no limit.
    pub minimum_segment_mm: f64,
    /// Largest angle by which the rotary words of a split motion may turn the tool away from its programmed direction, rad.
    pub orientation_rad: f64,
}
