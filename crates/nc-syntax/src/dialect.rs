//! A dialect as a value: what `grammars/*.toml` say.

use std::ops::Deref;

use diagnostic::Text;
use serde::Deserialize;
use toolpath::CycleKind;
use units::decimal::Decimal;

pub use crate::code::{GCode, MOTION_GROUP};
use crate::path_control::PathCode;
use crate::{Letters, Number};

/// What `( )` means.
///
/// ```
/// use nc_syntax::ItemKind;
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str, dialect: &str) -> Block<'static> {
/// #     let dialect = nc_dialect::builtin(dialect).unwrap();
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), dialect), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// // A comment on one control, a command on the other.
/// let kind = |dialect| read("(UAO,1)\n", dialect).items[0].kind;
/// assert_eq!((kind("fanuc"), kind("balt-system")), (ItemKind::Comment, ItemKind::BracketCommand));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paren {
    /// Not part of the dialect.
    None,
    /// A comment.
    Comment {
        /// `( ( ) )` is one comment.
        nested: bool,
    },
    /// A command to the control (Balt-System).
    Command,
}

/// What `;` means where it ends no block ([`Dialect::end_of_block`]).
///
/// ```
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str, dialect: &str) -> Block<'static> {
/// #     let dialect = nc_dialect::builtin(dialect).unwrap();
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), dialect), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// // It ends the block, or the rest of the line is a comment.
/// assert_eq!(read("X1.;Y2.\n", "fanuc").bytes, b"X1.;");
/// assert_eq!(read("X1.;Y2.\n", "linuxcnc").bytes, b"X1.;Y2.\n");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Semicolon {
    /// Not part of the dialect.
    None,
    /// The rest of the line is a comment.
    Comment,
}

/// What `:` means.
///
/// ```
/// use nc_syntax::ItemKind;
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str, dialect: &str) -> Block<'static> {
/// #     let dialect = nc_dialect::builtin(dialect).unwrap();
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), dialect), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// let kind = |dialect| read(":1234\n", dialect).items[0].kind;
/// assert!(matches!(kind("fanuc"), ItemKind::Word { letter: b'O', .. }));
/// assert_eq!(kind("centroid"), ItemKind::Comment);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Colon {
    /// Not part of the dialect.
    #[default]
    None,
    /// `:1234` is a program number or main block.
    Number,
    /// First on its line it makes the line a comment (Centroid).
    Comment,
}

/// What a number without a decimal point means for lengths.
///
/// ```
/// use nc_syntax::dialect::PointFree;
///
/// let meaning = |dialect| nc_dialect::builtin(dialect).unwrap().numbers.point_free;
/// assert_eq!((meaning("fanuc"), meaning("linuxcnc")), (PointFree::LeastIncrement, PointFree::Unit));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointFree {
    /// `X100` is 100 mm (calculator type, LinuxCNC).
    Unit,
    /// `X100` is 100 least increments (conventional type, IS-B).
    LeastIncrement,
}

/// How numbers are written and read.
///
/// ```
/// use nc_syntax::{Block, Reader};
///
/// let (text, mut block) = (b"X100 Y100.\n", Block::default());
/// let read = |dialect: &str, block: &mut Block<'static>| {
///     let dialect = nc_dialect::builtin(dialect).unwrap();
///     assert!(Reader::new(text, dialect).next(block));
///     [b'X', b'Y'].map(|axis| dialect.numbers.length(block.word(axis).unwrap().number().unwrap(), false).to_f64())
/// };
/// // A hundred steps of a micrometre on one control, a hundred millimetres on the other.
/// assert_eq!(read("fanuc", &mut block), [0.1, 100.0]);
/// assert_eq!(read("linuxcnc", &mut block), [100.0, 100.0]);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Numbers {
    /// Meaning of a length without a point.
    pub point_free: PointFree,
    /// Decimals of the least input increment in mm (3 for IS-B).
    pub least_increment_decimals_mm: u8,
    /// The same in inches (4 for IS-B).
    pub least_increment_decimals_inch: u8,
    /// `X 1 0 . 5` is 10.5.
    pub spaces_inside: bool,
}

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
/// use nc_syntax::dialect::{Action, GCode};
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
    /// G10: work offsets written by the program (L2, L20); see [`FrameRules::l20`].
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
/// use nc_syntax::dialect::{Action, TipSwitch};
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
/// use nc_syntax::dialect::{Action, FramePart};
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
/// use nc_syntax::dialect::{Action, Called};
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
/// use nc_syntax::dialect::{Action, Called, CornerForm};
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
/// use nc_syntax::dialect::{Action, GCode, Side};
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
/// use nc_syntax::dialect::{Action, GCode, PlaneCode};
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
/// use nc_syntax::dialect::{Action, GCode, TurningCycle};
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
/// use nc_syntax::dialect::{Action, GCode, Pockets, TurningCycle};
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

/// What R and Z of a cycle mean for the blocks that repeat it without writing them again.
///
/// ```
/// use nc_syntax::dialect::CycleLevels;
///
/// let levels = |dialect| nc_dialect::builtin(dialect).unwrap().cycle_levels;
/// assert_eq!((levels("fanuc"), levels("linuxcnc")), (CycleLevels::Held, CycleLevels::Reread));
/// assert_eq!(levels("perspektiva"), CycleLevels::Unstated);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CycleLevels {
    /// They were turned into levels where they were written, and the levels hold (Fanuc).
    Held,
    /// Their numbers are read anew in each block, absolute or incremental as that block is (LinuxCNC:
    /// under G91 R counts from the initial level and Z from R).
    Reread,
    /// Nobody said: refused where the two readings differ.
    Unstated,
}

/// What becomes of a tool length in force behind a code that ends offsets.
///
/// ```
/// use nc_syntax::dialect::LengthAfter;
///
/// // GOST 20999-83 can be read either way: refused while a length is in force.
/// assert_eq!(nc_dialect::builtin("perspektiva").unwrap().length_under_g40, LengthAfter::Unstated);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthAfter {
    /// It stays.
    Stays,
    /// It ends.
    Ends,
    /// Nobody said: the code is refused while one is in force.
    Unstated,
}

/// What `G10 L20 Pn` writes.
///
/// ```
/// use nc_syntax::dialect::OffsetL20;
///
/// let l20 = |dialect| nc_dialect::builtin(dialect).unwrap().frames.l20;
/// assert_eq!((l20("fanuc"), l20("linuxcnc")), (OffsetL20::Numbered, OffsetL20::Position));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum OffsetL20 {
    /// The numbered work offset G54.1 Pn (Fanuc).
    #[serde(rename = "numbered-offset")]
    Numbered,
    /// Work offset n, so that the axes stand at the words (LinuxCNC).
    Position,
}

/// How the codes that move the frame work together, where controls differ.
///
/// ```
/// let frames = |dialect| nc_dialect::builtin(dialect).unwrap().frames;
/// // G52 and G92 add up on one control and are one shift on the other.
/// assert!(!frames("fanuc").local_is_preset && frames("linuxcnc").local_is_preset);
/// assert!(frames("fanuc").p_selects_numbered);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameRules {
    /// `G54 P1` is `G54.1 P1` (Fanuc); where false a P beside a work offset is refused.
    pub p_selects_numbered: bool,
    /// What `G10 L20` writes.
    pub l20: OffsetL20,
    /// G52 and G92 are one shift (LinuxCNC); where false they add up (Fanuc).
    pub local_is_preset: bool,
    /// The factor of G51 that a P without a point counts.
    pub scaling_step: f64,
    /// G68 without its centre turns about where the tool stands; where false it is refused.
    pub rotation_about_tool: bool,
    /// Machine coordinates are those of the axes whatever rotation, scaling or mirror is in force.
    pub machine_words_stand_alone: bool,
    /// P of an arc counts its turns (LinuxCNC).
    pub arc_turns: bool,
    /// An axis' first increment behind a change of its zero may travel that change too (Sinumerik).
    pub increments_carry_shift: bool,
}

/// One row of the dialect's code table.
///
/// ```
/// use nc_syntax::dialect::GCode;
///
/// // G0 and G1 replace each other, G90 does not touch them.
/// let group = |code| nc_dialect::builtin("fanuc").unwrap().code(GCode(code)).unwrap().group;
/// assert_eq!(group(0), group(10));
/// assert_ne!(group(0), group(900));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CodeEntry {
    /// The code.
    pub code: GCode,
    /// Modal group (numbers of the LinuxCNC and Fanuc manuals); 0 is non-modal.
    pub group: u8,
    /// What it does.
    pub action: Action,
}

/// The rows of a dialect's code table, in the order of their codes.
///
/// A block's codes are looked up several times, so that a row is found from its code's whole number at once.
///
/// ```
/// use nc_syntax::dialect::{Action, CodeEntry, Codes, GCode};
///
/// let row = |code, action| CodeEntry { code: GCode(code), group: 1, action };
/// let codes = Codes::from(vec![row(10, Action::Line), row(0, Action::Rapid)]);
/// // In the order of their codes, however the table lists them.
/// assert_eq!(codes.iter().map(|row| row.code).collect::<Vec<_>>(), [GCode(0), GCode(10)]);
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Codes {
    rows: Vec<CodeEntry>,
    /// Index of the first row that is not below G`n`, by `n`.
    from: Vec<u32>,
}

impl From<Vec<CodeEntry>> for Codes {
    fn from(mut rows: Vec<CodeEntry>) -> Self {
        rows.sort_by_key(|row| row.code);
        let mut from = Vec::new();
        for (index, row) in (0..).zip(&rows) {
            from.resize(from.len().max(row.code.whole() + 1), index);
        }
        Self { rows, from }
    }
}

impl Deref for Codes {
    type Target = [CodeEntry];

    fn deref(&self) -> &[CodeEntry] {
        &self.rows
    }
}

impl Codes {
    #[inline]
    fn row(&self, code: GCode) -> Option<&CodeEntry> {
        let from = *self.from.get(code.whole())?;
        self.rows[from as usize..].iter().take_while(|row| row.code <= code).find(|row| row.code == code)
    }
}

/// An M code that is more than text.
///
/// ```
/// let fanuc = nc_dialect::builtin("fanuc").unwrap();
/// let change = fanuc.m_code(6).unwrap();
/// assert!(change.changes_tool && change.loses_position == [true; 3]);
/// assert!(fanuc.m_code(30).unwrap().ends_program);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MCode {
    /// Its number.
    pub number: u16,
    /// Executed after the motion of its block (M0, M1, M2, M5, M9, M30).
    pub after_motion: bool,
    /// Axes that may stand anywhere afterwards (M6: the tool change position).
    pub loses_position: [bool; 3],
    /// The program ends here.
    pub ends_program: bool,
    /// `M94/1`: what stands behind a slash is its argument, and no mark of block delete.
    pub slash_arguments: bool,
    /// A tool change: where the axes stand afterwards may be known of the machine.
    pub changes_tool: bool,
    /// What it switches on some machines (kinematics, a mirror, the workpiece's place): refused unless the machine
    /// is said to have it do nothing of the kind.
    pub switches: Option<Text>,
    /// Switches tool centre point control: what a profile says of the machine's own codes.
    pub tip: Option<TipSwitch>,
    /// M98: calls a program that the control holds.
    pub calls: bool,
    /// Refused, with the way out (M98, M99).
    pub refuse: Option<(Text, Text)>,
}

/// A program or function of the control that is left alone, and what stands anywhere behind it; what a profile says.
///
/// ```
/// // A dialect knows none: they are the machine's.
/// assert!(nc_dialect::builtin("fanuc").unwrap().calls.is_empty());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ControlCall {
    /// `G` or `M`.
    pub letter: u8,
    /// Tenths of the code: 650 of G65.
    pub tenths: u16,
    /// P, where the code calls programs by it.
    pub program: Option<u32>,
    /// X, Y, Z, A, B, C that may stand anywhere afterwards; none: it does no more than pass.
    pub unknown: [bool; 6],
}

impl MCode {
    /// A code that moves nothing and switches nothing that this crate's users follow.
    #[must_use]
    pub fn harmless(number: u16) -> Self {
        Self {
            number,
            after_motion: false,
            loses_position: [false; 3],
            ends_program: false,
            slash_arguments: false,
            changes_tool: false,
            switches: None,
            tip: None,
            calls: false,
            refuse: None,
        }
    }
}

/// A block that stands in programs of lathes: any of the codes or commands, all of the letters, none of the others.
///
/// ```
/// // `T0101` in a block of its own is how lathes of Fanuc choose a tool with its offset.
/// let signs = &nc_dialect::builtin("fanuc").unwrap().lathe;
/// assert!(signs.iter().any(|sign| sign.digits.is_some_and(|(letter, count)| (letter, count) == (b'T', 4))));
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LatheSign {
    /// Any of them; empty where every block may be one.
    pub codes: Vec<GCode>,
    /// Any of them by name.
    pub commands: Vec<String>,
    /// No other G code stands in the block.
    pub alone: bool,
    /// All of these letters.
    pub with: Letters,
    /// None of these letters.
    pub without: Letters,
    /// This letter's number has so many digits, and neither half of them is zero (`T0101`).
    pub digits: Option<(u8, u8)>,
    /// No mill's program has it; else it counts together with others.
    pub sure: bool,
    /// What it does on a lathe.
    pub says: Text,
    /// What to write where the program is a mill's.
    pub mill: Text,
}

/// A command by name: a word of letters (Sinumerik `SCALE`), the first word in brackets (Balt-System `(UAO,1)`), or a
/// variable of the control that acts when it is set (Fanuc `#3006=1`).
///
/// A command that is not in the table is refused: it may move the frame.
///
/// ```
/// let sinumerik = nc_dialect::builtin("sinumerik").unwrap();
/// // SCALE moves the frame; what is not in the table may, and is refused as well.
/// assert!(sinumerik.command(b"SCALE X2").unwrap().refusal(b"SCALE X2").is_some());
/// assert!(sinumerik.command(b"NOBODYKNOWS").is_none());
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Command {
    /// Upper case.
    pub name: String,
    /// What it does, where that is more than nothing.
    pub action: Option<Action>,
    /// `None`: moves no axis and no frame, passes. Else why it is refused, and the way out.
    pub refuse: Option<(Text, Text)>,
    /// It passes with so many arguments in its brackets, and is refused with more.
    pub passes_with: Option<u32>,
}

impl Command {
    /// Why it is refused as it stands, and the way out; `text` is its bytes, brackets included.
    #[must_use]
    pub fn refusal(&self, text: &[u8]) -> Option<&(Text, Text)> {
        let arguments = || {
            let open = text.iter().position(|byte| *byte == b'(').map_or(text.len(), |at| at + 1);
            let commas = text[open..].iter().filter(|byte| **byte == b',').count();
            commas + usize::from(commas > 0 || !matches!(text[open..].trim_ascii(), [] | [b')']))
        };
        let passes = |most: u32| arguments() <= most as usize;
        self.refuse.as_ref().filter(|_| !self.passes_with.is_some_and(passes))
    }
}

/// How text is written.
///
/// ```
/// let output = |dialect| nc_dialect::builtin(dialect).unwrap().output.clone();
/// // LinuxCNC's interpreter reads lines of 254 bytes and their end; Sinumerik's R is another word.
/// assert_eq!(output("linuxcnc").max_block_bytes, 255);
/// assert!(!output("sinumerik").radius_word && output("fanuc").radius_word);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Decimals of an inch word; those of a millimetre word come from the profile's resolution.
    pub decimals_inch: u8,
    /// Decimals of F when it must be computed (G93).
    pub decimals_feed: u8,
    /// Longest block, bytes without its end; 0 for no limit.
    pub max_block_bytes: u32,
    /// Inserted blocks get N numbers when the program has them.
    pub number_inserted_blocks: bool,
    /// Largest N.
    pub max_block_number: u32,
    /// The control takes I J K; where false only R.
    pub centre_words: bool,
    /// The control takes R.
    pub radius_word: bool,
    /// Largest difference between an arc's radius at its start and at its end that the control takes, mm.
    pub arc_radius_tolerance_mm: f64,
    /// The same under inches, inch, where the control counts them apart.
    pub arc_radius_tolerance_inch: Option<f64>,
    /// The same as a share of the radius, where the control takes that too and it is more; 0 for none.
    pub arc_radius_tolerance_share: f64,
    /// What F of G94 counts where rotary axes turn; `None` where the control's manual leaves it open.
    pub rotary_feed: Option<RotaryFeed>,
    /// Largest F of G93 that the control reads, 1/min.
    pub largest_inverse_feed: f64,
    /// Distance above the last depth where a G83 peck resumes feeding when written as moves, mm.
    pub peck_clearance_mm: f64,
    /// Retreat of a G73 peck when written as moves, mm.
    pub chip_retreat_mm: f64,
}

/// What F of G94 counts where rotary axes turn at feed rate.
///
/// ```
/// use nc_syntax::dialect::RotaryFeed;
///
/// let counts = |dialect| nc_dialect::builtin(dialect).unwrap().output.rotary_feed;
/// assert_eq!(counts("linuxcnc"), Some(RotaryFeed::LinearAxes));
/// assert_eq!(counts("perspektiva"), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RotaryFeed {
    /// The way of X, Y, Z alone; degrees where none of them moves.
    LinearAxes,
    /// The way of all axes, a degree as a millimetre or an inch.
    AllAxes,
}

/// Which language of variables, expressions and program flow the control has.
///
/// ```
/// use nc_syntax::dialect::Macros;
///
/// let macros = |dialect| nc_dialect::builtin(dialect).unwrap().flow.macros;
/// assert_eq!((macros("fanuc"), macros("centroid")), (Macros::Fanuc, Macros::None));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Macros {
    /// None that is known: a program that uses one is refused.
    #[default]
    None,
    /// Fanuc's custom macro B: `#1`, `IF … GOTO`, `WHILE … DO1`, G65; M98 and M99.
    Fanuc,
    /// LinuxCNC's parameters and O-words; M98 and M99.
    #[serde(rename = "linuxcnc")]
    LinuxCnc,
    /// Siemens' R parameters, variables of DEF, IF and loops, jumps to labels.
    Siemens,
    /// Okuma's VC variables, IF and GOTO to sequence names, CALL O and RTS.
    Okuma,
}

impl Macros {
    /// True where variables stand without a mark before their names, and calls are no M codes.
    #[must_use]
    pub const fn bare_names(self) -> bool {
        matches!(self, Self::Siemens | Self::Okuma)
    }
}

/// Drilling cycles that are written out as moves.
///
/// ```
/// let written = |dialect| nc_dialect::builtin(dialect).unwrap().flow.written_cycles.unwrap();
/// // R and Z are the levels of a hole on one control, Z and I on the other.
/// assert_eq!(written("okuma").levels, *b"RZ");
/// assert_eq!(written("fagor").levels, *b"ZI");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WrittenCycles {
    /// Letters of the level where the feed begins and of the bottom.
    pub levels: [u8; 2],
    /// What says where the tool returns to.
    pub back: CycleBack,
}

/// What says to which level a written-out cycle returns.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CycleBack {
    /// M53: to the level of [`Action::ReturnLevel`]; M54: to where the feed begins. A motion code ends the cycle.
    ByM,
    /// [`Action::ReturnInitial`]: to where the tool stood when the cycle began; [`Action::ReturnR`]: to where the feed
    /// begins. [`Action::CycleCancel`] alone ends the cycle.
    ByG,
}

/// Variables, program flow and subprograms.
///
/// ```
/// let flow = |dialect| nc_dialect::builtin(dialect).unwrap().flow;
/// // M98 P31000 is three calls of O1000 on one control and a call of O31000 on the other.
/// assert!(flow("fanuc").packed_repeats && !flow("linuxcnc").packed_repeats);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flow {
    /// The language.
    pub macros: Macros,
    /// M98 without L takes the digits of P above the lowest four as the number of repetitions: `P31000`
    /// calls O1000 three times.
    pub packed_repeats: bool,
    /// `ATAN[y]/[x]` lies between 0 and 360 degrees; where false between -180 and 180.
    pub full_circle_atan: bool,
    /// `,R5.` and `,C2.` at the end of a line round or cut its corner with the next one.
    pub corner_words: bool,
    /// M97 P1000 calls the blocks from N1000 on, in the same program; M99 returns.
    pub local_calls: bool,
    /// ATAN takes one value: `ATAN[y]/[x]` divides an angle, and is refused.
    pub one_value_atan: bool,
    /// Drilling cycles are written out as moves.
    pub written_cycles: Option<WrittenCycles>,
    /// First and last number of the programs that builders and makers of probes keep in the control: called where no
    /// file has them, they are left alone.
    pub control_programs: Option<(u32, u32)>,
    /// Some code is [`Action::PolarOn`].
    pub polar_words: bool,
    /// Some command is an [`Action::Called`], and `X=AC(5)`, `X=IC(5)` say a place or an increment.
    pub called: bool,
}

impl Flow {
    /// True for an M code that calls or returns, and is executed before anything is corrected: M98 and M99, M97 where
    /// it calls.
    #[must_use]
    pub fn calls(self, m_code: i64) -> bool {
        match m_code {
            98 | 99 => !matches!(self.macros, Macros::None | Macros::Okuma),
            97 => self.local_calls && self.macros != Macros::None,
            _ => false,
        }
    }
}

/// What a lathe's programs have and a mill's have not.
///
/// ```
/// let turning = |dialect| nc_dialect::builtin(dialect).unwrap().turning.clone();
/// assert_eq!(turning("fanuc"), None);
/// // System A writes increments as U and W, and an offset's number into T.
/// let fanuc = turning("fanuc-lathe").unwrap();
/// assert!(fanuc.increments && fanuc.offset_in_t);
/// ```
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Turning {
    /// U and W are increments of X and Z.
    pub increments: bool,
    /// The last two digits of T choose the tool's offset (`T0101`).
    pub offset_in_t: bool,
    /// T brings in the offset of its number; D1 is that offset, D0 none (Sinumerik).
    pub offset_in_d: bool,
    /// The letter whose number is the lead of a thread: F, or K (LinuxCNC).
    pub thread_lead: u8,
    /// X words are diameters at the start of a program, as the machine's profile says; `None`: not said.
    pub diameters: Option<bool>,
    /// What parameters of the control say of its cycles, as the machine's profile has them.
    pub cycles: TurningParameters,
    /// G-code systems by name, of which the machine has one; empty where there is only one.
    pub systems: Vec<System>,
}

/// Which depth of a thread's passes begins where its cycle starts; deeper ones begin further along the thread, by what
/// they are deeper times the tangent of half the tip's angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FlankFrom {
    /// None: as if it had no depth.
    Start,
    /// That of the first pass.
    FirstPass,
    /// That of the last pass.
    LastPass,
}

/// How far a peck of a lathe's drilling cycle goes back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrillPecks {
    /// To R, out of the hole.
    Full,
    /// By the return alone: the chip breaks.
    Chip,
}

/// What R of a lathe's drilling cycle is in systems B and C.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrillR {
    /// A place under G90, a way under G91.
    Place,
    /// A way from the start, always.
    Way,
}

/// Parameters of a lathe's control that decide how its cycles move; what is not said is not guessed.
///
/// ```
/// // A dialect knows none of them: they are the machine's.
/// let lathe = nc_dialect::builtin("fanuc-lathe").unwrap().turning.clone().unwrap();
/// assert_eq!(lathe.cycles.roughing_escape_mm, None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct TurningParameters {
    /// Length of the chamfer at the end of a thread, in leads (Fanuc's parameter 5130 counts tenths).
    pub thread_chamfer_leads: Option<f64>,
    /// Angle of that chamfer to the axis, degrees (parameter 5131; 45 where not said).
    pub thread_chamfer_deg: Option<f64>,
    /// By how much G71 and G72 leave the contour behind a pass, radius, mm (parameter 5133).
    pub roughing_escape_mm: Option<f64>,
    /// By how much G74 and G75 go back behind a peck, mm (parameter 5139).
    pub groove_return_mm: Option<f64>,
    /// Finishing passes of a thread in one block (parameter 5142), a whole number.
    pub thread_finishing_passes: Option<f64>,
    /// Its least infeed, radius, mm (5140).
    pub thread_least_mm: Option<f64>,
    /// Its finishing allowance, radius, mm (5141).
    pub thread_allowance_mm: Option<f64>,
    /// From where passes move along the flank.
    pub thread_flank_from: Option<FlankFrom>,
    /// How far a peck of G83 goes back (parameter 5101.2).
    pub drill_pecks: Option<DrillPecks>,
    /// By how much it does, or stays off what is drilled, mm (parameter 5114).
    pub drill_return_mm: Option<f64>,
    /// What R of drilling cycles is (parameter 5102.6 of systems B and C; controls that follow Fanuc have theirs in A).
    pub drill_r: Option<DrillR>,
    /// Feed out of a hole that G85 bores, in per cent of F (parameter 5121; 0 there is 200).
    pub bore_return_percent: Option<f64>,
    /// G41 and G42 between P and Q hold in finishing alone: roughing leaves its allowance at the tip as programmed.
    pub nose_in_finishing: bool,
    /// A, C and R of a line are words of a drawing without a comma too (parameter 3405.4).
    pub plain_drawing: bool,
}

/// A G-code system of a lathe's control: what its table has in place of the dialect's own rows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct System {
    /// `A`, `B`, `C`.
    pub name: String,
    /// Rows that replace those of their codes, or come to them.
    pub codes: Vec<CodeEntry>,
    /// Codes that it does not have.
    pub without: Vec<GCode>,
    /// U and W are increments of X and Z.
    pub increments: bool,
    /// State at the start of a program.
    pub initial: Vec<GCode>,
}

/// A letter whose words are refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RefusedWord {
    /// Upper case.
    pub letter: u8,
    /// Why.
    pub reason: Text,
    /// The way out.
    pub help: Text,
}

/// What a T word does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TWord {
    /// It selects what the M code that changes the tool brings in.
    #[default]
    Selects,
    /// It may bring in the tool, and its length, at once.
    MayChange,
    /// It is a tool change itself: what the M code of the table that changes the tool does, it does.
    Changes,
}

/// Which tool length holds behind a tool change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthAtChange {
    /// The one in force before, until a code says another.
    #[default]
    Stays,
    /// That of the tool which came in.
    LoadedTool,
    /// Controls differ: until a code says one, nothing may move along the tool.
    Unsaid,
}

/// Everything that differs between controls.
///
/// ```
/// use nc_syntax::dialect::{Action, GCode};
///
/// let fanuc = nc_dialect::builtin("fanuc").unwrap();
/// assert_eq!(fanuc.name, "fanuc");
/// // What holds before the first block: G17, G90 and others, as if they stood in one.
/// let stands = |code| fanuc.initial.contains(&GCode(code));
/// assert!(stands(170) && stands(900) && !stands(910));
/// assert_eq!(fanuc.code(GCode(20)).map(|row| &row.action), Some(&Action::ArcClockwise));
/// assert!(fanuc.code(GCode(9999)).is_none());
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Dialect {
    /// File name in `grammars/` without ending.
    pub name: String,
    /// What it is, for people.
    pub title: String,
    /// The shipped dialect that has all that this one's table does not say.
    pub extends: Option<String>,
    /// Assumptions made where no manual is public, shown by `grammar list`.
    pub assumptions: Vec<String>,
    /// What `( )` means.
    pub paren: Paren,
    /// What `;` means.
    pub semicolon: Semicolon,
    /// The mark that ends a block; what follows on its line is a new one.
    pub end_of_block: Option<u8>,
    /// Behind `%` stand a name without blanks and words (`%4100 G71`), and a block's `%` need not be its first.
    pub percent_words: bool,
    /// Character of block delete, if any.
    pub skip: Option<u8>,
    /// What `:` means.
    pub colon: Colon,
    /// Names of several letters that are a word's, as `CR=` is R; upper case, sorted.
    pub long_words: Vec<(String, u8)>,
    /// `OMAIN` and `NEND` are names.
    pub labels: bool,
    /// `X=10.5` and `X=R1+2` are words too; a value other than a number runs to the next white space.
    pub equals_words: bool,
    /// Letters of words, upper case; others are invalid.
    pub letters: Vec<u8>,
    /// Letters whose words are refused.
    pub refused_words: Vec<RefusedWord>,
    /// Letters of a dwell's time; `None`: X, U, P, F and S, which may be left out.
    pub dwell_time: Option<Letters>,
    /// Numbers.
    pub numbers: Numbers,
    /// Known G codes.
    pub codes: Codes,
    /// M codes that matter, sorted by number; all others pass.
    pub m_codes: Vec<MCode>,
    /// Commands by name, sorted by name.
    pub commands: Vec<Command>,
    /// State at the start of a program: codes as if they stood in a first block.
    pub initial: Vec<GCode>,
    /// Modes by which the control keeps near the path, or leaves it.
    pub path_control: Vec<PathCode>,
    /// The unit of the program before may still be in force at the start: one that states none is doubtful.
    pub unit_is_kept: bool,
    /// Blocks by which a program of a lathe is known.
    pub lathe: Vec<LatheSign>,
    /// Programs of lathes; `None`: of mills.
    pub turning: Option<Turning>,
    /// Variables, program flow and subprograms.
    pub flow: Flow,
    /// How cycles carry R and Z on.
    pub cycle_levels: CycleLevels,
    /// Letters that count the holes of a cycle's block.
    pub cycle_repeats: Vec<u8>,
    /// A count of zero stores the words of the cycle and makes no hole; where false it is an error.
    pub zero_repeats_define: bool,
    /// The control stops at a cycle whose bottom lies above R (LinuxCNC).
    pub bottom_lies_below_r: bool,
    /// G43 without H, and with H0, takes the length of the tool in the spindle (LinuxCNC); where false it needs H, and
    /// H0 is no length.
    pub length_of_loaded_tool: bool,
    /// What G40 does to a tool length in force.
    pub length_under_g40: LengthAfter,
    /// What G49 does to it.
    pub length_under_g49: LengthAfter,
    /// A code of the tool length moves no axis: from there on the same place has other words (LinuxCNC). Where false
    /// some controls move the axis at once.
    pub length_shifts: bool,
    /// What a T word does.
    pub t_word: TWord,
    /// Which tool length holds behind a tool change.
    pub length_at_change: LengthAtChange,
    /// G10 L10 and L11 write the two parts of a tool length, L12 and L13 those of a radius (Fanuc).
    pub writes_lengths: bool,
    /// D1 is the offset of the tool that M6 brought in, D0 none (Sinumerik).
    pub edge_in_d: bool,
    /// Calls that are left alone, as the machine's profile has them.
    pub calls: Vec<ControlCall>,
    /// Codes that move the frame.
    pub frames: FrameRules,
    /// Output.
    pub output: Output,
}

impl Dialect {
    /// The dialect with one of its G-code systems chosen; `None` where it does not have it.
    ///
    /// ```
    /// use nc_syntax::dialect::{Action, GCode};
    ///
    /// let lathe = nc_dialect::builtin("fanuc-lathe").unwrap();
    /// let code = |system| lathe.in_system(system).unwrap().code(GCode(980)).unwrap().action.clone();
    /// assert_eq!((code("A"), code("B")), (Action::FeedPerMinute, Action::ReturnInitial));
    /// assert!(lathe.in_system("D").is_none());
    /// ```
    #[must_use]
    pub fn in_system(&self, name: &str) -> Option<Self> {
        let turning = self.turning.as_ref()?;
        let System { codes, without, increments, initial, .. } =
            turning.systems.iter().find(|system| system.name == name)?;
        let other = |entry: &&CodeEntry| {
            !without.contains(&entry.code) && codes.iter().all(|own| own.code != entry.code)
        };
        let rows: Vec<CodeEntry> = self.codes.iter().filter(other).chain(codes).cloned().collect();
        let turning = Turning { increments: *increments, systems: Vec::new(), ..turning.clone() };
        Some(Self { codes: rows.into(), initial: initial.clone(), turning: Some(turning), ..self.clone() })
    }

    /// The table's row for a code.
    #[must_use]
    #[inline]
    pub fn code(&self, code: GCode) -> Option<&CodeEntry> {
        self.codes.row(code)
    }

    /// The first row of the table that does this.
    #[must_use]
    pub fn row_of(&self, action: &Action) -> Option<&CodeEntry> {
        self.codes.iter().find(|row| row.action == *action)
    }

    /// The table's row for an M number.
    #[must_use]
    pub fn m_code(&self, number: u16) -> Option<&MCode> {
        self.m_codes.binary_search_by_key(&number, |entry| entry.number).ok().map(|at| &self.m_codes[at])
    }

    /// The table's row for a command: `text` is a [`crate::ItemKind::BracketCommand`]'s bytes, brackets included.
    #[must_use]
    pub fn command(&self, text: &[u8]) -> Option<&Command> {
        let start = text.iter().position(|byte| byte.is_ascii_alphabetic() || matches!(byte, b'#' | b'$'))?;
        let inside = |byte: &&u8| byte.is_ascii_alphanumeric() || **byte == b'_';
        let length = 1 + text[start + 1..].iter().take_while(inside).count();
        let name = text[start..start + length].to_ascii_uppercase();
        self.commands
            .binary_search_by(|entry| entry.name.as_bytes().cmp(&name))
            .ok()
            .map(|at| &self.commands[at])
    }
}

impl Dialect {
    /// What the profile says of a call that is left alone; an entry without a program is for all of its code's.
    ///
    /// * `letter`, `tenths` – of the code, as [`ControlCall`] has them
    #[must_use]
    pub fn control_call(&self, letter: u8, tenths: u16, program: Option<u32>) -> Option<&ControlCall> {
        let of_code = self.calls.iter().filter(|call| (call.letter, call.tenths) == (letter, tenths));
        let of_program = |call: &&ControlCall| call.program.is_none() || call.program == program;
        of_code.filter(of_program).max_by_key(|call| call.program.is_some())
    }
}

impl Output {
    /// Largest difference of an arc's radii, mm, where one unit of the program is so long.
    #[must_use]
    pub fn arc_tolerance_mm(&self, unit_mm: f64) -> f64 {
        let inches = self.arc_radius_tolerance_inch.filter(|_| unit_mm != 1.0);
        inches.map_or(self.arc_radius_tolerance_mm, |inches| inches * unit_mm)
    }
}

impl Numbers {
    /// A length word's value in the unit in force, exact.
    ///
    /// A number without a point counts least increments where [`PointFree::LeastIncrement`] says so. For
    /// lengths only (X Y Z I J K R Q…): F, S, P, H, A, B, C follow their own rules.
    #[must_use]
    pub fn length(&self, number: Number, inch: bool) -> Decimal {
        let Decimal { mantissa, decimals } = number.decimal;
        if number.has_point || self.point_free == PointFree::Unit {
            return number.decimal;
        }
        let step = if inch { self.least_increment_decimals_inch } else { self.least_increment_decimals_mm };
        Decimal { mantissa, decimals: decimals + step }
    }
}
