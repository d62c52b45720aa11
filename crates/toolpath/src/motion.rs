use crate::{Bezier, FeedRate, Hole, Partial, Plane, Position, TiltedPlane};

/// What X, Y and Z are while rotary axes stand somewhere.
///
/// ```
/// use toolpath::Kinematics;
///
/// assert_eq!(Kinematics::default(), Kinematics::Axes);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Kinematics {
    /// Commands of the axes.
    #[default]
    Axes,
    /// Tip commands, of which the control makes those of the axes (G43.4, TRAORI): where the axes would stand with all rotary
    /// axes at 0 so that the tip is there in the frame of the workpiece.
    Tip,
    /// Coordinates of a tilted working plane (G68.2), the tool's length added along its Z, while the rotary axes stand: the
    /// control brings the tip to that place of the workpiece.
    Plane(TiltedPlane),
}

/// A circular arc or helix; the ends belong to the motion.
///
/// The radius runs linearly with the angle from the start's distance to the end's: programs give ends
/// and centre rounded, so the two differ by the rounding, and this is how LinuxCNC closes the gap.
///
/// ```
/// use toolpath::{Arc, Plane};
///
/// // G18 G3, a quarter turn about Z0 X0 from Z20: Z towards X, so it ends at X20.
/// let arc = Arc { plane: Plane::Zx, centre_mm: [0.0, 0.0], sweep_rad: std::f64::consts::FRAC_PI_2 };
/// let [first, second, _] = arc.plane.axes();
/// let start_mm = [0.0, 5.0, 20.0];
/// let radius = [start_mm[first] - arc.centre_mm[0], start_mm[second] - arc.centre_mm[1]];
/// let (sin, cos) = units::math::sin_cos(arc.sweep_rad);
/// let mut end_mm = start_mm;
/// end_mm[first] = arc.centre_mm[0] + cos * radius[0] - sin * radius[1];
/// end_mm[second] = arc.centre_mm[1] + sin * radius[0] + cos * radius[1];
/// assert!((end_mm[0] - 20.0).abs() < 1e-12 && end_mm[2].abs() < 1e-12);
/// assert_eq!(end_mm[1], 5.0);
/// ```
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
///
/// ```
/// use toolpath::{Arc, Plane, Shape};
///
/// // How far the direction of motion turns between two ends.
/// let turn_rad = |shape: Shape| match shape {
///     Shape::Line => 0.0,
///     Shape::Arc(arc) => arc.sweep_rad.abs(),
///     Shape::Bezier(_) => unimplemented!("by its control points"),
/// };
/// let clockwise = Arc { plane: Plane::Xy, centre_mm: [10.0, 0.0], sweep_rad: -1.5 };
/// assert_eq!((turn_rad(Shape::Line), turn_rad(Shape::Arc(clockwise))), (0.0, 1.5));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// Straight, all axes in step.
    Line,
    /// Arc in a plane, the normal axis in step with the angle.
    Arc(Arc),
    /// A curve by control points: what G5, G5.2 and G6.2 cut.
    Bezier(Bezier),
}

/// A motion on a path that was promised.
///
/// ```
/// use toolpath::{Division, Feed, FeedRate, Position, Shape};
///
/// let at = |x: f64| Position { linear_mm: [x, 0.0, 0.0], ..Position::default() };
/// let whole = Feed {
///     start: at(0.0),
///     end: at(30.0),
///     shape: Shape::Line,
///     rate: FeedRate::PerMinute,
///     division: Division::Any,
/// };
/// // Cut at X10, the two pieces meet there and reach as far as the whole.
/// let (first, second) = (Feed { end: at(10.0), ..whole }, Feed { start: at(10.0), ..whole });
/// assert_eq!(first.end, second.start);
/// assert_eq!((first.start, second.end), (whole.start, whole.end));
/// ```
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
///
/// ```
/// use toolpath::Division;
///
/// // Into how many blocks a path of so many pieces may go.
/// let blocks = |division: Division, pieces: usize| match division {
///     Division::Any | Division::Long { .. } => Some(pieces),
///     Division::OneBehindLines | Division::One | Division::LongClimbing { .. } => (pieces == 1).then_some(1),
/// };
/// assert_eq!(blocks(Division::default(), 3), Some(3));
/// assert_eq!(blocks(Division::One, 3), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Division {
    /// As many as its path needs.
    #[default]
    Any,
    /// One, behind lines that bring the axes to its start: of a rotary axis that turns meanwhile each piece would need its share.
    OneBehindLines,
    /// One and none besides: the control offsets block by block (G41, G42), and a line of micrometres would be offset too.
    One,
    /// Offset by the control, by a radius that is known: pieces that go on from one another, none shorter in the plane of the
    /// offset, and none besides.
    Long {
        /// Length of the shortest, µm.
        least_um: u32,
        /// The axis that the offset leaves alone.
        normal: u8,
    },
    /// The same, climbing by less than a thousandth of its way: one block in a program, and in a corrected one what a level
    /// block's piece is.
    LongClimbing {
        /// Length of the shortest, µm.
        least_um: u32,
        /// The axis that the offset leaves alone.
        normal: u8,
    },
}

impl Division {
    /// The control offsets the motion block by block.
    #[must_use]
    pub const fn is_offset(self) -> bool {
        matches!(self, Self::One | Self::Long { .. } | Self::LongClimbing { .. })
    }
}

/// What one block, or one turn of a repeated block, makes the axes do.
///
/// ```
/// use toolpath::{Motion, Mover, Partial, Position};
///
/// // Where the axes are known to end, whatever moves them.
/// let end = |motion: &Motion| match motion {
///     Motion::Rapid { end, .. } | Motion::Uncorrected { end, .. } => end.complete(),
///     Motion::Feed(feed) => Some(feed.end),
///     Motion::Hole(hole) => Some(hole.end()),
/// };
/// let there = Position { linear_mm: [1.0, 2.0, 3.0], ..Position::default() };
/// assert_eq!(end(&Motion::Rapid { start: Partial::default(), end: there.into() }), Some(there));
/// // Behind a probe X stands anywhere.
/// let probed = Partial { linear_mm: [None, Some(2.0), Some(3.0)], ..Partial::default() };
/// assert_eq!(end(&Motion::Uncorrected { end: probed, by: Mover::Other }), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// G0: the end matters, the way there is the control's.
    Rapid {
        /// Where it starts, as far as known.
        start: Partial,
        /// Where it ends, as far as known.
        end: Partial,
    },
    /// G1, G2, G3; a part of a curve by control points.
    Feed(Feed),
    /// G73, G74, G76, G81–G89.
    Hole(Hole),
    /// G28, G30, G53, G31, M6…: never corrected; the axes end here as far as known. Also rotary axes that position alone.
    Uncorrected {
        /// Where the axes end.
        end: Partial,
        /// What moves them.
        by: Mover,
    },
}

impl Motion {
    /// F under G93, 1/min.
    #[must_use]
    pub const fn inverse_time(&self) -> Option<f64> {
        match self {
            Self::Feed(Feed { rate: FeedRate::InverseTime(per_minute), .. }) => Some(*per_minute),
            _ => None,
        }
    }
}

/// What moves axes whose linear places are not corrected.
///
/// ```
/// use toolpath::Mover;
///
/// assert_ne!(Mover::RotaryWords, Mover::Other);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mover {
    /// The motion code in force, by the block's rotary words alone: the linear axes stay where they are.
    RotaryWords,
    /// Anything else: a reference return, machine coordinates, a probe, a tool change, a change of frame.
    Other,
}
