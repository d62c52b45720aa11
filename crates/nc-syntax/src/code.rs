//! Numbers of codes.

/// A preparatory code in tenths: `G81` is 810, `G54.1` is 541.
///
/// ```
/// use nc_syntax::GCode;
///
/// assert_eq!(format!("{} {}", GCode(810), GCode(541)), "G81 G54.1");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GCode(pub u16);

impl GCode {
    /// 81 of G81, 54 of G54.1.
    #[must_use]
    pub const fn whole(self) -> usize {
        self.0 as usize / 10
    }
}

impl std::fmt::Display for GCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 % 10 {
            0 => write!(f, "G{}", self.0 / 10),
            part => write!(f, "G{}.{part}", self.0 / 10),
        }
    }
}
