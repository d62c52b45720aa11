//! What a test piece may show.

use diagnostic::Text;

/// One thing that test pieces may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Term {
    /// Tilt of the workpiece's axis: EB0S, rad, or the tailstock's offset, mm.
    Axis,
    /// EB0Z, rad.
    Squareness,
    /// Growth with time on the radius, mm/h.
    Growth,
    /// Wear, mm on the radius from part to part.
    Wear,
    /// Quadratic EXZ, mm: middle above ends.
    Bow,
    /// EXZ of order 4, mm.
    FourthOrder,
    /// From part to part, mm on the radius, by wear or by something else.
    PartToPart,
}

impl Term {
    /// As messages name it.
    #[must_use]
    pub const fn words(self) -> Text {
        match self {
            Self::Axis => Text::pair("taper", "конусность"),
            Self::Squareness => Text::pair("squareness", "перпендикулярность"),
            Self::Growth => Text::pair("growth", "рост"),
            Self::Wear => Text::pair("wear", "износ"),
            Self::Bow => Text::pair("barrel", "бочкообразность"),
            Self::FourthOrder => Text::pair("order 4 of the barrel", "4-й порядок бочкообразности"),
            Self::PartToPart => Text::pair("from part to part", "от образца к образцу"),
        }
    }

    /// True where it is geometry that a profile holds.
    #[must_use]
    pub fn is_geometry(self) -> bool {
        !self.is_drift()
    }

    /// True for what changes the size from part to part.
    #[must_use]
    pub fn is_drift(self) -> bool {
        matches!(self, Self::Growth | Self::Wear | Self::PartToPart)
    }
}
