//! What codes and commands do.

use diagnostic::Text;
use toolpath::CycleKind;

/// How a code says a curve by control points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurveCode {
    /// LinuxCNC's G5: from the start by I J, from the end by P Q.
    Cubic,
    /// LinuxCNC's G5.1: from the start by I J.
    Quadratic,
    /// LinuxCNC's G5.2: X Y of a control point, its weight P, the order L.
    Points,
    /// LinuxCNC's G5.3: the control points before are a curve.
    End,
    /// Fanuc's G6.2: X Y Z of a control point, its weight R, a knot K, the order P.
    Knots,
    /// LinuxCNC's G6.2: the same in a plane; Q says how the control divides the curve.
    PlaneKnots,
}

/// What a G code does, as far as `nc-program` must know.
///
/// ```
/// use nc_dialect::Action;
/// use nc_syntax::GCode;
///
/// let action = |dialect, code| &nc_dialect::builtin(dialect).unwrap().code(GCode(code)).unwrap().action;
/// assert_eq!(action("linuxcnc", 10), &Action::Line);
/// // Inches are G20 on one control and G70 on another.
/// assert_eq!(action("fanuc", 200), &Action::Inch);
/// assert_eq!(action("sinumerik", 700), &Action::Inch);
/// // What is known and not certain is refused with the way out.
/// assert!(matches!(action("perspektiva", 530), Action::Refuse { help, .. } if !help.is_empty()));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Action {
    /// G0
    Rapid,
    /// G1
    Line,
    /// G2
    ArcClockwise,
    /// G3
    ArcCounterClockwise,
    /// G5 to G5.3, G6.2
    Curve(CurveCode),
    /// G4: X, U or P are a time.
    Dwell,
    /// G4 whose time is set elsewhere: no word of the block is one.
    DwellBySetting,
    /// G17, G18, G19
    Plane(PlaneCode),
    /// G20
    Inch,
    /// G21
    Millimetre,
    /// G28, G30: the axes named go to a reference point by way of the point programmed.
    Reference,
    /// G53: this block's words are machine coordinates.
    MachineCoordinates,
    /// G31, G37, G38.x: moves until something is touched; the axes named end anywhere.
    Probe,
    /// G40
    CompensationOff,
    /// G41, G42
    Compensation(Side),
    /// G43
    LengthOn,
    /// G44
    LengthOnNegative,
    /// G49
    LengthOff,
    /// G43.4: a tool length, and from here on the control moves the tool's tip.
    TipLengthOn,
    /// G43.5: the same, and I, J, K of a line are the tool's direction at its end, a vector in the workpiece.
    TipLengthOnVectors,
    /// G68.2: a tilted working plane by its words; X, Y and Z are its coordinates from here on, until G69.
    TiltedPlane,
    /// G254: the work offset goes with the table to where that is turned; X, Y, Z stay along the machine's axes.
    DynamicOffset,
    /// G255
    DynamicOffsetOff,
    /// G53.1, G53.6: the rotary axes turn until the tool stands upright on the tilted plane.
    AlignTool,
    /// TRAORI, M428 and TRAFOOF, M429: the control moves the tip, or the axes again.
    Tip(TipSwitch),
    /// TRANS, ROT, MIRROR and their additive forms: the frame between the work offset and the words.
    ProgramFrame {
        /// What it does to the frame.
        part: FramePart,
        /// On top of the one in force (ATRANS); else in its place, and without words in place of all of them.
        adds: bool,
    },
    /// CYCLE800: a tilted working plane by its arguments, to which the rotary axes turn; without any it ends the plane.
    /// What else of the frame it ends is not certain.
    Swivel,
    /// CYCLE832: how far the path may be left; its second argument may switch TRAORI too.
    ContourTolerance,
    /// G500: no work offset but the base frame, `G500` in the profile.
    BaseFrame,
    /// Calls of cycles and what else is written out before anything else, or refused.
    Called(Called),
    /// G54–G59: the name in the profile.
    WorkOffset(String),
    /// G54.1, G154: the work offset that P numbers, `G54.1P1` in the profile.
    WorkOffsetNumbered,
    /// G15 of Okuma: the work offset that H numbers, `G15H1` in the profile.
    WorkOffsetByH,
    /// G10: work offsets written by the program (L2, L20); see [`crate::FrameRules::l20`].
    WriteOffset,
    /// G52: shift of every work offset by the words.
    LocalShift,
    /// G92: shift of every work offset so that the axes stand at the words.
    Preset,
    /// G92.1: the shift of G92 is gone.
    PresetCancel,
    /// G92.2: the shift of G92 is off, and kept for G92.3.
    PresetSuspend,
    /// G92.3: the kept shift is on again.
    PresetRestore,
    /// G68: rotation in the plane about the words by R degrees.
    RotationOn,
    /// G69
    RotationOff,
    /// G51: scaling about the words by P, or I J K.
    ScalingOn,
    /// G50
    ScalingOff,
    /// G51.1: mirror of the axes named, about the words.
    MirrorOn,
    /// G50.1: no mirror of the axes named.
    MirrorOff,
    /// G16: the plane's words are radius and angle. Written out before anything else, or refused.
    PolarOn,
    /// G15
    PolarOff,
    /// G43.1: the tool length is in the words.
    LengthFromWords,
    /// G4 of which only P is the time: axis words belong to the motion (LinuxCNC).
    DwellP,
    /// G73, G74, G76, G81–G89
    Cycle(CycleKind),
    /// G80
    CycleCancel,
    /// G98
    ReturnInitial,
    /// G99
    ReturnR,
    /// G71 of Okuma: the level that cycles with M53 return to.
    ReturnLevel,
    /// G90
    Absolute,
    /// G91
    Incremental,
    /// G90.1
    ArcCentresAbsolute,
    /// G91.1
    ArcCentresIncremental,
    /// G93
    FeedInverseTime,
    /// G94
    FeedPerMinute,
    /// G95
    FeedPerRevolution,
    /// No axis moves and no frame changes; with `words` its axis words are arguments, not positions.
    Pass {
        /// Axis words of the block belong to this code.
        takes_words: bool,
    },
    /// G64: no axis moves and no frame changes, and P of its block is its own.
    PassWithP,
    /// G7, DIAMON: X words are diameters.
    DiameterOn,
    /// G8, DIAMOF: X words are radii.
    DiameterOff,
    /// DIAM90: absolute X words are diameters, increments radii.
    DiameterOfAbsolute,
    /// LIMS: limits the spindle of a lathe.
    SpeedLimit,
    /// G50, G92 of lathes: with S a limit of the spindle, with X and Z where the axes stand.
    LimitOrPreset,
    /// G32, G33: a line in step with the spindle.
    Thread,
    /// G90, G71 and their like on lathes. Written out before anything else, or refused.
    Turning(TurningCycle),
    /// `#3000=1`: the program ends with an alarm.
    Alarm,
    /// G65 P9810: a program that the control holds; the other words are its arguments.
    Call,
    /// Known, and refused.
    Refuse {
        /// Why.
        reason: Text,
        /// The way out.
        help: Text,
    },
}

impl Action {
    /// True for what changes neither the frame nor where the axes stand, and owns no words: feed modes, compensation,
    /// what cycles return to.
    #[must_use]
    pub fn keeps_places(&self) -> bool {
        matches!(
            self,
            Self::Pass { takes_words: false }
                | Self::PassWithP
                | Self::ContourTolerance
                | Self::DwellP
                | Self::Compensation(_)
                | Self::CompensationOff
                | Self::FeedInverseTime
                | Self::FeedPerMinute
                | Self::FeedPerRevolution
                | Self::ReturnInitial
                | Self::ReturnR
                | Self::ArcCentresAbsolute
                | Self::ArcCentresIncremental
        )
    }
}

/// Tool centre point control.
///
/// ```
/// use nc_dialect::{Action, TipSwitch};
///
/// let sinumerik = nc_dialect::builtin("sinumerik").unwrap();
/// let row = sinumerik.commands.iter().find(|row| row.name == "TRAFOOF").unwrap();
/// assert_eq!(row.action, Some(Action::Tip(TipSwitch::Off)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TipSwitch {
    /// X, Y and Z say where the tip is.
    On,
    /// They say where the axes are.
    Off,
}

/// What of the program's own frame a command says.
///
/// ```
/// use nc_dialect::{Action, FramePart};
///
/// let sinumerik = nc_dialect::builtin("sinumerik").unwrap();
/// let shift = Action::ProgramFrame { part: FramePart::Shift, adds: true };
/// assert_eq!(sinumerik.command(b"ATRANS X1").unwrap().action, Some(shift));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FramePart {
    /// TRANS: X, Y, Z of the new zero.
    Shift,
    /// ROT: the angle in the plane.
    Rotation,
    /// MIRROR: the axes that change their direction.
    Mirror,
}

/// What a name of Siemens stands for, written out as plain blocks.
///
/// ```
/// use nc_dialect::{Action, Called};
///
/// let sinumerik = nc_dialect::builtin("sinumerik").unwrap();
/// let row = sinumerik.command(b"CYCLE83(10,0,2,-30)").unwrap();
/// assert_eq!(row.action, Some(Action::Called(Called::DrillPecks)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Called {
    /// CYCLE81
    Drill,
    /// CYCLE82
    DrillDwell,
    /// CYCLE83
    DrillPecks,
    /// CYCLE85: in and out at feeds of its own.
    BoreFeeds,
    /// CYCLE86: out with the spindle stopped at an angle.
    BoreOriented,
    /// MCALL: the cycle behind it at the end of each motion that follows.
    Modal,
    /// HOLES1
    HolesRow,
    /// HOLES2
    HolesCircle,
    /// TURN=: turns of a helix beside the one that its words say.
    Turns,
    /// AR=: the angle of an arc.
    ArcAngle,
    /// RND=, CHR=, CHF=: the corner between this line and the next one.
    Corner(CornerForm),
}

/// How a corner between two lines is cut.
///
/// ```
/// use nc_dialect::{Action, Called, CornerForm};
///
/// let sinumerik = nc_dialect::builtin("sinumerik").unwrap();
/// let action = sinumerik.command(b"CHF=2").unwrap().action.clone();
/// assert_eq!(action, Some(Action::Called(Called::Corner(CornerForm::ChamferLength))));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerForm {
    /// By an arc of the radius given.
    Round,
    /// By a line that begins and ends so far from the corner.
    Chamfer,
    /// By a line of this length.
    ChamferLength,
}

/// On which side of its way a tool is led whose radius the control compensates.
///
/// ```
/// use nc_dialect::{Action, Side};
/// use nc_syntax::GCode;
///
/// let row = nc_dialect::builtin("fanuc").unwrap().code(GCode(420)).unwrap();
/// assert_eq!(row.action, Action::Compensation(Side::Right));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// G41
    Left,
    /// G42
    Right,
}

/// G17, G18, G19; not `toolpath::Plane`, so that reading text needs no geometry.
///
/// ```
/// use nc_dialect::{Action, PlaneCode};
/// use nc_syntax::GCode;
///
/// let fanuc = nc_dialect::builtin("fanuc").unwrap();
/// assert_eq!(fanuc.code(GCode(180)).map(|row| &row.action), Some(&Action::Plane(PlaneCode::Zx)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneCode {
    /// G17
    Xy,
    /// G18
    Zx,
    /// G19
    Yz,
}

/// Which cycle of a lathe.
///
/// ```
/// use nc_dialect::{Action, TurningCycle};
/// use nc_syntax::GCode;
///
/// // System A calls the pass along Z G90, system B G77.
/// let lathe = nc_dialect::builtin("fanuc-lathe").unwrap();
/// let pass = |system, code| lathe.in_system(system).unwrap().code(GCode(code)).unwrap().action.clone();
/// assert_eq!(pass("A", 900), Action::Turning(TurningCycle::TurnPass));
/// assert_eq!(pass("B", 770), pass("A", 900));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurningCycle {
    /// G90 (A), G77 (B), G20 (C): one pass along Z, there and back.
    TurnPass,
    /// G92 (A), G78 (B), G21 (C): the same in step with the spindle.
    ThreadPass,
    /// G94 (A), G79 (B), G24 (C): one pass along X, there and back.
    FacePass,
    /// G70 (A, B), G72 (C): once along the contour.
    Finish,
    /// G71 (A, B), G73 (C): passes along Z down to a contour.
    RoughTurn,
    /// G72 (A, B), G74 (C): passes along X down to a contour.
    RoughFace,
    /// G73 (A, B), G75 (C): the contour several times, nearer each time.
    RoughPattern,
    /// G74 (A, B), G76 (C): pecks along Z.
    PeckFace,
    /// G75 (A, B), G77 (C): pecks along X.
    PeckGroove,
    /// G76 (A, B), G78 (C): a thread in several passes.
    ThreadPasses,
    /// G83: a hole on the axis.
    DrillFace,
    /// G85: the same, out again in a feed.
    BoreFace,
    /// G70 of LinuxCNC: along the contour of a subroutine.
    FinishRoutine,
    /// G71, G71.1, G71.2 of LinuxCNC: passes along Z down to the contour of a subroutine.
    RoughTurnRoutine(Pockets),
    /// G72, G72.1, G72.2 of LinuxCNC: passes along X down to it.
    RoughFaceRoutine(Pockets),
}

/// Which pockets of a contour a cycle of LinuxCNC cuts.
///
/// ```
/// use nc_dialect::{Action, Pockets, TurningCycle};
/// use nc_syntax::GCode;
///
/// let lathe = nc_dialect::builtin("linuxcnc-lathe").unwrap();
/// let action = |code| lathe.code(GCode(code)).unwrap().action.clone();
/// assert_eq!(action(711), Action::Turning(TurningCycle::RoughTurnRoutine(Pockets::Leave)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pockets {
    /// G71, G72
    All,
    /// G71.1, G72.1
    Leave,
    /// G71.2, G72.2: what the one before left.
    Only,
}
