//! What the user may choose of a correction.

use machine_model::Singularity;

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
    /// Largest distance that is written all the same where the tolerance cannot be held, and said, mm; none beyond the
    /// tolerance where it is not above that.
    pub accept_mm: f64,
    /// Feed motion outside the calibrated volume.
    pub outside: Outside,
    /// No piece is made shorter than this, mm; 0 for no limit.
    pub minimum_segment_mm: f64,
    /// Largest angle between the tool's direction and the programmed one, rad: what the rotary words of a split motion may turn
    /// it by, and under [`Orientation::Full`] what is left of it in all.
    pub orientation_rad: f64,
    /// What of the tool is brought to where the program says.
    pub orientation: Orientation,
}

/// What of the tool is brought to where the program says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Orientation {
    /// Its tip (`--orientation xyz`): rotary words stay as they are.
    #[default]
    Tip,
    /// Its tip and its direction (`--orientation full`), but near a singularity.
    Full(Singularity),
}
