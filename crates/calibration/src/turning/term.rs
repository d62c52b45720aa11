//! What a test piece may show.

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
    pub fn name(self) -> &'static str {
        match self {
            Self::Axis => "taper",
            Self::Squareness => "squareness",
            Self::Growth => "growth",
            Self::Wear => "wear",
            Self::Bow => "barrel",
            Self::FourthOrder => "order 4 of the barrel",
            Self::PartToPart => "from part to part",
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
