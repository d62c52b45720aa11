use units::decimal::Decimal;

use crate::Plane;

/// Where the axes are commanded to be.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Position {
    /// X, Y, Z in mm.
    pub linear_mm: [f64; 3],
    /// A, B, C in degrees; 0 for an axis the machine does not have.
    pub rotary_deg: [f64; 3],
}

/// A position of which some axes may not be known yet (start of program, after G28 or a tool change).
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Partial {
    /// X, Y, Z in mm where known.
    pub linear_mm: [Option<f64>; 3],
    /// A, B, C in degrees. Unknown counts as an error only where a rotary axis matters.
    pub rotary_deg: [f64; 3],
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
        Self { linear_mm: p.linear_mm.map(Some), rotary_deg: p.rotary_deg }
    }
}

/// A circular arc or helix; the ends belong to the motion.
///
/// The radius runs linearly with the angle from the start's distance to the end's: programs give ends
/// and centre rounded, so the two differ by the rounding, and this is how LinuxCNC closes the gap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Plane the circle lies in.
    pub plane: Plane,
    /// Centre in the plane's first and second axis, mm.
    pub centre_mm: [f64; 2],
    /// Angle from start to end; positive turns the plane's first axis towards its second (G3).
    /// A full circle is ±2π; more turns are more.
    pub sweep_rad: f64,
}

/// The geometry between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Straight, all axes in step.
    Line,
    /// Arc in a plane, the normal axis in step with the angle.
    Arc(Arc),
}

/// What F means (ISO 6983: G93, G94, G95).
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum FeedRate {
    /// Millimetres per minute, or whatever the control makes of F: nothing depends on it here.
    #[default]
    PerMinute,
    /// Inverse time: the motion takes 1/F minutes. Must be divided when the motion is.
    InverseTime(f64),
    /// Millimetres per spindle turn.
    PerRevolution,
}

/// A motion on a path that was promised.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feed {
    /// Where it starts.
    pub start: Position,
    /// Where it ends.
    pub end: Position,
    /// What lies between.
    pub shape: Shape,
    /// How F is meant.
    pub rate: FeedRate,
    /// What may become of its block.
    pub division: Division,
}

/// How many blocks a feed motion may become.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Division {
    /// As many as its path needs.
    #[default]
    Any,
    /// One, behind lines that bring the axes to its start: of a rotary axis that turns meanwhile each piece would need its share.
    OneBehindLines,
    /// One and none besides: the control offsets block by block (G41, G42), and a line of micrometres would be offset too.
    One,
}

/// What a drilling cycle does at the bottom and on the way back; what `correction` may rewrite as moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CycleKind {
    /// G81, G82: feed in, dwell of `dwell` (the P word as written) if any, rapid out.
    Drill,
    /// G85, G89: feed in, dwell if any, feed out.
    Bore,
    /// G83: pecks of `peck_mm`, out to R each time.
    PeckFull,
    /// G73: pecks of `peck_mm`, a short retreat each time.
    PeckChip,
    /// G74, G76, G84, G86, G87, G88: bound to the spindle, cannot be written as moves.
    Synchronised,
}

/// A drilling cycle as it stands when a hole is made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cycle {
    /// What it does.
    pub kind: CycleKind,
    /// Peck depth Q, mm, positive.
    pub peck_mm: Option<f64>,
    /// Dwell at the bottom, P as written; none where it is zero.
    pub dwell: Option<Decimal>,
    /// G98: back to the initial level; G99: back to R.
    pub return_to_initial: bool,
}

/// One hole of a drilling cycle, along the plane's normal axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hole {
    /// Working plane; the hole runs along its normal.
    pub plane: Plane,
    /// Where the axes are before the hole.
    pub start: Position,
    /// Position of the hole at R level.
    pub at_r: Position,
    /// Command of the normal axis at the bottom, mm.
    pub bottom_mm: f64,
    /// It begins a series of holes.
    pub first: bool,
    /// Command of the normal axis where the series of holes began, mm: R counts from there under G91.
    pub began_mm: f64,
    /// Command of the normal axis at the level G98 returns to, mm: where the series began, or R where that is higher.
    pub initial_mm: f64,
    /// The cycle's parameters.
    pub cycle: Cycle,
    /// How F is meant.
    pub rate: FeedRate,
}

impl Hole {
    /// Where the axes are after the hole, as programmed.
    #[must_use]
    pub fn end(&self) -> Position {
        let mut end = self.at_r;
        let normal = self.plane.axes()[2];
        if self.cycle.return_to_initial {
            // A cycle never ends below R: controls take the higher of the two.
            end.linear_mm[normal] = self.initial_mm;
        }
        end
    }
}

/// What one block, or one turn of a repeated block, makes the axes do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// G0: the end matters, the way there is the control's.
    Rapid {
        /// Where it starts, as far as known.
        start: Partial,
        /// Where it ends, as far as known.
        end: Partial,
    },
    /// G1, G2, G3.
    Feed(Feed),
    /// G73, G74, G76, G81–G89.
    Hole(Hole),
    /// G28, G30, G53, G31, M6…: never corrected; the axes end here as far as known.
    Uncorrected {
        /// Where the axes end.
        end: Partial,
    },
}
