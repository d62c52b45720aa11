//! Where axes stand.

/// Where the axes are commanded to be.
///
/// ```
/// use toolpath::{Partial, Position};
///
/// let at = Position { linear_mm: [10.0, 20.0, -3.0], ..Position::default() };
/// assert_eq!(at.rotary_deg, [0.0; 3]);
/// // What is known of it as a whole is the position again.
/// assert_eq!(Partial::from(at).complete(), Some(at));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Position {
    /// X, Y, Z in mm.
    pub linear_mm: [f64; 3],
    /// A, B, C in degrees; 0 for an axis the machine does not have.
    pub rotary_deg: [f64; 3],
}

/// A position of which some axes may not be known yet (start of program, after G28 or a tool change).
///
/// ```
/// use toolpath::Partial;
///
/// // Behind a tool change only Z is known; once the program has named X and Y, all is.
/// let mut at = Partial { linear_mm: [None, None, Some(100.0)], ..Partial::default() };
/// assert_eq!(at.complete(), None);
/// (at.linear_mm[0], at.linear_mm[1]) = (Some(10.0), Some(20.0));
/// assert_eq!(at.complete().map(|place| place.linear_mm), Some([10.0, 20.0, 100.0]));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Partial {
    /// X, Y, Z in mm where known.
    pub linear_mm: [Option<f64>; 3],
    /// A, B, C in degrees. Unknown counts as an error only where a rotary axis matters.
    pub rotary_deg: [f64; 3],
    /// Of which of them that is known; 0 stands for the others.
    pub rotary_known: [bool; 3],
}

impl Partial {
    /// The position, where all three linear axes are known.
    #[must_use]
    pub fn complete(&self) -> Option<Position> {
        let [x, y, z] = self.linear_mm;
        Some(Position { linear_mm: [x?, y?, z?], rotary_deg: self.rotary_deg })
    }
}

impl From<Position> for Partial {
    fn from(p: Position) -> Self {
        Self { linear_mm: p.linear_mm.map(Some), rotary_deg: p.rotary_deg, rotary_known: [true; 3] }
    }
}
