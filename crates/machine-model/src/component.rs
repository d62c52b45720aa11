//! The six components of an error.

/// What one axis does wrong at one command: `EX EY EZ` in mm, `EA EB EC` in rad.
pub type Six = [f64; 6];

/// What a component of an error is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Component {
    /// Along an axis, mm.
    Linear,
    /// About an axis, rad.
    Angular,
}

impl Component {
    /// Of one of [`Six`], by its place there.
    #[must_use]
    pub fn of(function: usize) -> Self {
        if function < 3 { Self::Linear } else { Self::Angular }
    }
}
