//! The state of a program between two blocks: one enum per modal group.

use crate::under_way::{CurveBegun, Offset, PlaneBegun};
use nc_dialect::{CurveCode, Side};
use nc_syntax::{GCode, Number};
use toolpath::{CycleKind, Frame, Kinematics, Partial, Plane};
use units::decimal::Decimal;

pub use crate::transform::Transform;

/// Sense of an arc, seen against the plane's normal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turn {
    /// G2
    Clockwise,
    /// G3
    CounterClockwise,
}

/// The motion code in force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotionMode {
    /// None yet, or cancelled by G80.
    None,
    /// One of two, depending on the block delete switch at this line.
    Undecided {
        /// Line of the block that may be skipped.
        line: u64,
    },
    /// G0
    Rapid(GCode),
    /// G1
    Line(GCode),
    /// G2, G3
    Arc(Turn, GCode),
    /// G32, G33 of lathes
    Thread(GCode),
    /// G5 to G5.3, G6.2
    Curve(CurveCode, GCode),
}

impl MotionMode {
    /// The code, where there is one.
    #[must_use]
    pub const fn code(self) -> Option<GCode> {
        match self {
            Self::None | Self::Undecided { .. } => None,
            Self::Rapid(code)
            | Self::Line(code)
            | Self::Arc(_, code)
            | Self::Thread(code)
            | Self::Curve(_, code) => Some(code),
        }
    }
}

/// What axis words mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distance {
    /// G90
    Absolute,
    /// G91
    Incremental,
}

/// What length words are written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Units {
    /// G20
    Inch,
    /// G21
    Millimetre,
}

impl Units {
    /// One unit in mm.
    #[must_use]
    pub const fn mm(self) -> f64 {
        match self {
            Self::Inch => 25.4,
            Self::Millimetre => 1.0,
        }
    }
}

/// What X words are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum XWords {
    /// A mill's X; G8, DIAMOF.
    Radius,
    /// G7, DIAMON.
    Diameter,
    /// DIAM90: a diameter where it says a place, a radius where it is an increment.
    DiameterOfAbsolute,
    /// A lathe's, and nobody said.
    Unstated,
}

impl XWords {
    /// True where the X words of a block are diameters.
    #[must_use]
    pub fn are_diameters(self, distance: Distance) -> bool {
        self == Self::Diameter || (self == Self::DiameterOfAbsolute && distance == Distance::Absolute)
    }
}

/// What F means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FeedMode {
    /// G93
    InverseTime,
    /// G94
    PerMinute,
    /// G95
    PerRevolution,
}

/// What the last F said.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum LastFeed {
    /// Nothing that can be said again.
    #[default]
    Unknown,
    /// A speed per minute, in the unit that was in force.
    PerMinute(Decimal, Units),
    /// An inverse time.
    Inverse,
}

impl LastFeed {
    /// Behind a block; `said`: its own F.
    pub(crate) fn after(self, before: FeedMode, state: &Modal, said: Option<Decimal>) -> Self {
        match (state.feed_mode, said) {
            (FeedMode::InverseTime, _) => Self::Inverse,
            (FeedMode::PerMinute, Some(feed)) => Self::PerMinute(feed, state.units),
            (mode, None) if mode == before || self == Self::Inverse => self,
            _ => Self::Unknown,
        }
    }

    /// Where the one or the other holds.
    pub(crate) fn either(self, other: Self) -> Self {
        match (self, other) {
            (Self::Inverse, _) | (_, Self::Inverse) => Self::Inverse,
            _ if self == other => self,
            _ => Self::Unknown,
        }
    }
}

/// What I J K are measured from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcCentres {
    /// G90.1: the program's zero.
    Absolute,
    /// G91.1: the start of the arc.
    Incremental,
}

/// Cutter compensation in the control.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compensation {
    /// G40
    Off,
    /// G41, G42
    On(Side),
}

impl Compensation {
    /// On which side, if it is on.
    #[must_use]
    pub fn side(self) -> Option<Side> {
        match self {
            Self::Off => None,
            Self::On(side) => Some(side),
        }
    }
}

/// How far the control may leave the path by itself, and which block said so.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathControl {
    /// At most so far, mm; infinite where parameters, speed and acceleration decide.
    pub off_mm: f64,
    /// Line of the block; `None`: as the control starts.
    pub line: Option<u64>,
}

impl PathControl {
    /// The looser of both.
    pub(crate) fn either(self, other: Self) -> Self {
        if other.off_mm > self.off_mm { other } else { self }
    }
}

/// Where a drilling cycle ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReturnLevel {
    /// G98
    Initial,
    /// G99
    R,
    /// The program has not said, and the control starts in what the program before has left, or in G99.
    Unsaid,
    /// One of the two, depending on the block delete switch.
    Undecided {
        /// Line of the first block that may be skipped.
        line: u64,
    },
}

/// The tool length in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolLength {
    /// G49: the tool vector is the setup's default.
    Off,
    /// G43, G44.
    On {
        /// H number.
        number: u32,
        /// G44.
        negative: bool,
        /// What is added to axis commands, mm: the setup's vector, its negative under G44.
        applied_mm: [f64; 3],
    },
    /// G43.1: the length stands in the program.
    Written {
        /// What is added to axis commands, mm.
        applied_mm: [f64; 3],
    },
}

impl ToolLength {
    /// No length: off, or that of H0.
    #[must_use]
    pub const fn is_none(&self) -> bool {
        matches!(self, Self::Off | Self::On { number: 0, .. })
    }

    /// What a length adds that says where the tool ends; none do off, H0 and a written length of zero.
    #[must_use]
    pub(crate) fn ends_mm(&self) -> Option<[f64; 3]> {
        match *self {
            Self::Off | Self::On { number: 0, .. } | Self::Written { applied_mm: [0.0, 0.0, 0.0] } => None,
            Self::On { applied_mm, .. } | Self::Written { applied_mm } => Some(applied_mm),
        }
    }

    /// What is added to axis commands, mm.
    #[must_use]
    pub const fn applied_mm(&self) -> [f64; 3] {
        match self {
            Self::Off => [0.0; 3],
            Self::On { applied_mm, .. } | Self::Written { applied_mm } => *applied_mm,
        }
    }
}

/// The work offset in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorkOffset {
    /// The code that selected it; `None` where neither program nor dialect did.
    pub code: Option<GCode>,
    /// P of a numbered one.
    pub number: Option<u32>,
    /// Machine coordinate of its zero, mm; `None` where neither setup nor program says.
    pub zero_mm: Option<[f64; 3]>,
    /// G10 wrote it while it was in force, and whether the control heeds that before it is chosen again
    /// is not certain.
    pub rewritten: bool,
}

/// What is added to every work offset, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shifts {
    /// G52, where that is a shift of its own.
    pub local_mm: [f64; 3],
    /// G92; where G52 writes the same shift, that too.
    pub preset_mm: [f64; 3],
    /// What G92.3 brings back, once this program has set it.
    pub kept_mm: Option<[f64; 3]>,
}

/// Since when, and why, nobody knows where an axis stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lost {
    /// What happened.
    pub why: Why,
    /// Line of the block in which it happened.
    pub line: u64,
}

/// What makes the position of an axis unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// The program starts wherever the axes stand.
    Start,
    /// G28, G30: the reference point is the machine's affair.
    Reference,
    /// G53 under G91: some controls ignore it.
    MachineCoordinates,
    /// A probe move ends where it touches.
    Probe,
    /// An M code whose row says so: a tool change, a pallet change, a return.
    Miscellaneous {
        /// 6 of M6.
        code: u16,
        /// It changes the tool.
        changes_tool: bool,
    },
    /// A program or function of the control was called.
    Call,
    /// A motion that block delete may skip.
    BlockDelete,
    /// A tool length that changes: some controls move its axis at once.
    ToolLength,
    /// A tool offset that is chosen by D.
    ToolOffset,
    /// G53: what its words say is no place of the frame, and some controls end a tool length with it.
    MachineWords,
    /// A work offset, a shift, a rotation, a scaling or a mirror.
    Frame,
    /// G20, G21.
    Units,
    /// G43.4, TRAORI and their like, rotary axes not at 0.
    Kinematics,
    /// A tilted plane begins or ends, or rotary axes turn to it.
    TiltedPlane,
}

/// Whether the program has itself named an axis in the frame in force (`crate::naming`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Naming {
    /// By an absolute word.
    Named,
    /// Not since this.
    Since(Lost),
}

impl Naming {
    /// Since when not, where that is so.
    #[must_use]
    pub const fn lost(self) -> Option<Lost> {
        match self {
            Self::Named => None,
            Self::Since(lost) => Some(lost),
        }
    }
}

/// Settings that the program has itself written; the others are what the control was left with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stated {
    /// G54 and its like.
    pub work_offset: bool,
    /// G43, G44, G49, G43.1.
    pub tool_length: bool,
    /// G20, G21.
    pub units: bool,
}

/// A tool length that the program wrote with G10: a part that it did not is what nobody said.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WrittenLength {
    /// 1 of H1.
    pub number: u32,
    /// Geometry (L10) and wear (L11), mm.
    pub parts_mm: [Option<f64>; 2],
}

/// One axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Axis {
    /// Its command: mm, or degrees.
    At(f64),
    /// Nobody knows.
    Unknown(Lost),
}

impl Axis {
    /// The command, where known.
    #[must_use]
    pub const fn known(self) -> Option<f64> {
        match self {
            Self::At(value) => Some(value),
            Self::Unknown(_) => None,
        }
    }
}

/// Where the axes are commanded to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// X, Y, Z: axis commands, mm.
    pub linear: [Axis; 3],
    /// A, B, C: degrees; an axis that the machine does not have stands at 0.
    pub rotary: [Axis; 3],
}

impl Axes {
    /// As the toolpath says it; an unknown rotary axis counts as 0 there, and every motion that would
    /// depend on one is refused before.
    #[must_use]
    pub fn partial(&self) -> Partial {
        Partial {
            linear_mm: self.linear.map(Axis::known),
            rotary_deg: self.rotary.map(|axis| axis.known().unwrap_or(0.0)),
            rotary_known: self.rotary.map(|axis| axis.known().is_some()),
        }
    }
}

/// A level of a cycle as it was written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The word's number in mm.
    pub word_mm: f64,
    /// G91 was in force.
    pub incremental: bool,
    /// The level it meant when it was written: axis command, mm.
    pub level_mm: f64,
}

/// A drilling cycle in force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CycleState {
    /// Its code.
    pub code: GCode,
    /// What it does.
    pub kind: CycleKind,
    /// The normal axis where the series of cycles was started.
    pub initial: Axis,
    /// R.
    pub retract: Option<Level>,
    /// Z, or whichever axis is normal to the plane.
    pub bottom: Option<Level>,
    /// Q, mm, without sign.
    pub peck_mm: Option<f64>,
    /// P as written, where it is above zero, and the cycle that said it.
    pub dwell: Option<(Decimal, GCode)>,
    /// It has made a hole.
    pub drilled: bool,
}

/// How far the program is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Nothing but names and comments so far.
    Leader,
    /// The same behind the opening `%`.
    Opened,
    /// The same behind a second `%`: one of the two closes the program before it begins.
    OpenedTwice,
    /// After the first word.
    Running,
    /// After M2, M30 or the closing `%`: nothing that follows is executed.
    Ended,
}

/// Blocks that may be skipped, one behind the other: the switch stands before the first of them as it stands behind
/// the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Aside {
    /// Which switches, as [`nc_syntax::Block::switches`] says them.
    pub switches: u16,
    /// Line of the first.
    pub line: u64,
    /// The state where they are skipped: the one before the first.
    pub skipped: Modal,
    /// One of them moves an axis.
    pub moved: bool,
}

/// All of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Modal {
    /// G0 G1 G2 G3.
    pub motion: MotionMode,
    /// G73 G74 G76 G81–G89, until G80 or a motion code.
    pub cycle: Option<CycleState>,
    /// G17 G18 G19.
    pub plane: Plane,
    /// G90 G91.
    pub distance: Distance,
    /// G20 G21.
    pub units: Units,
    /// G7 G8.
    pub x_words: XWords,
    /// A limit holds the spindle of a lathe under G96.
    pub speed_limited: bool,
    /// G93 G94 G95.
    pub feed_mode: FeedMode,
    /// What the last F said.
    pub last_feed: LastFeed,
    /// A lathe's last F as it was written: its cycles count by it.
    pub feed: Option<Number>,
    /// G90.1 G91.1.
    pub arc_centres: ArcCentres,
    /// G40 G41 G42.
    pub compensation: Compensation,
    /// How far cutter compensation is with its motions.
    pub offset: Offset,
    /// G61 G64.
    pub path_control: PathControl,
    /// G98 G99.
    pub return_level: ReturnLevel,
    /// G43 G44 G49.
    pub tool_length: ToolLength,
    /// G43.4, TRAORI, G68.2.
    pub kinematics: Kinematics,
    /// G43.5: I, J, K of a line are the tool's direction.
    pub vectors: bool,
    /// A tilted plane of several blocks that is not whole yet.
    pub plane_begun: Option<PlaneBegun>,
    /// A curve of several blocks that is not whole yet.
    pub curve: Option<Box<CurveBegun>>,
    /// From the end of the G5 that the block before was to the control point with which another goes on, program axes,
    /// mm.
    pub curve_leaves_mm: Option<[f64; 2]>,
    /// G54–G59, G54.1.
    pub work_offset: WorkOffset,
    /// G52, G92.
    pub shifts: Shifts,
    /// G68, G51, G51.1.
    pub transform: Transform,
    /// Axes that the next motion must name, absolutely: the transformation changed.
    pub unsettled: [bool; 3],
    /// Work offsets that the program itself wrote, by name, mm.
    pub written: Vec<(String, [f64; 3])>,
    /// Tool lengths that the program itself wrote, part by part.
    pub written_lengths: Vec<WrittenLength>,
    /// What all of these make of program coordinates; `None` where the work offset is not known.
    pub frame: Option<Frame>,
    /// Where the axes are.
    pub axes: Axes,
    /// Which of X, Y, Z the program has named in this frame.
    pub named: [Naming; 3],
    /// Which settings it has written.
    pub stated: Stated,
    /// The last T.
    pub tool_selected: Option<u32>,
    /// The T that the last M6 brought into the spindle.
    pub tool_loaded: Option<u32>,
    /// M6 has brought in a tool, and which of its edges counts nobody has said.
    pub edge_unsaid: bool,
    /// How far the program is.
    pub progress: Progress,
    /// Blocks that may be skipped are under way; all else here is as where they are executed.
    pub aside: Option<Box<Aside>>,
}

impl Modal {
    /// Words of a motion say places, not ways.
    #[must_use]
    pub fn says_places(&self) -> bool {
        self.distance == Distance::Absolute
    }

    /// Where X, Y and Z stand, as words of this state would say it: those that the program has itself named in the
    /// frame in force.
    #[must_use]
    pub fn places(&self) -> [Option<f64>; 3] {
        // Behind a block that may be skipped the tool stands in one of two places.
        let (Some(frame), None) = (&self.frame, &self.aside) else { return [None; 3] };
        let stands = self.axes.linear.map(Axis::known);
        let program_mm = frame.to_program(stands.map(Option::unwrap_or_default));
        [0, 1, 2].map(|axis| {
            let known = (0..3).all(|other| frame.inverse()[axis][other] == 0.0 || stands[other].is_some());
            let diameters = axis == 0 && self.x_words.are_diameters(self.distance);
            let word = program_mm[axis] / self.units.mm() * if diameters { 2.0 } else { 1.0 };
            (known && self.named[axis] == Naming::Named).then_some(word)
        })
    }

    /// The code that axis words alone would execute now.
    #[must_use]
    pub const fn motion_code(&self) -> Option<GCode> {
        match self.cycle {
            Some(cycle) => Some(cycle.code),
            None => self.motion.code(),
        }
    }
}
