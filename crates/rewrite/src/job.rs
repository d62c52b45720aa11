//! What decides what becomes of a program.

use correction::Options;
use diagnostic::{Code, Diagnostic};
use machine_model::{Models, PathModel};
use nc_dialect::Dialect;
use nc_program::{Modal, Setup};
use toolpath::Interpolator;

use crate::datum::Datums;
use crate::path_mode::PathMode;

/// Feed motion, or what would correct it, lies outside the calibrated volume.
pub const OUTSIDE: Code = Code(501);
/// The path cannot be held within tolerance.
pub const NOT_WITHIN_TOLERANCE: Code = Code(502);
/// A motion that must stay one block would need to be split.
pub const MUST_NOT_SPLIT: Code = Code(503);
/// The model has no single answer at a point.
pub const NOT_CONVERGED: Code = Code(504);
/// The program was corrected before.
pub const CORRECTED_BEFORE: Code = Code(505);
/// A drilling cycle leans by more than the tolerance.
pub const LEANING_CYCLE: Code = Code(506);
/// Rapids end outside the calibrated volume.
pub const RAPID_OUTSIDE: Code = Code(507);
/// Motion under cutter compensation was corrected.
pub const COMPENSATED: Code = Code(508);
/// The nose of a turning tool does not fit, or touches where another correction would be needed.
pub const NOSE: Code = Code(521);
/// Nobody knows on which side of its play an axis stands.
pub const UNKNOWN_SIDE: Code = Code(509);
/// A hole of more pecks than anybody drills.
pub const TOO_MANY_PECKS: Code = Code(510);
/// Arcs end off their circle, as the control takes them.
pub const SPIRAL: Code = Code(515);
/// An axis would need a word, and the program has not named it in the frame in force.
pub const UNNAMED: Code = Code(514);
/// What the program was corrected for cannot be asked of the control.
pub const UNGUARDED: Code = Code(520);
/// Rotary axes turn at feed rate, and engine or effects have no bounds for that.
pub const NO_BOUNDS_FOR_TURNS: Code = Code(530);
/// Rotary words cannot say the directions of a split motion finely enough.
pub const DIRECTION: Code = Code(531);
/// F would mean another speed in the corrected block.
pub const ROTARY_FEED: Code = Code(532);
/// Near a singularity, or at the end of an axis' travel, directions were not corrected.
pub const DIRECTION_HELD: Code = Code(534);
/// The tool cannot be pointed where it shall.
pub const LEANS: Code = Code(540);
/// Directions cannot be corrected in a tilted plane.
pub const DIRECTION_IN_PLANE: Code = Code(541);
/// Another tool than the one with which a field was measured.
pub const OTHER_TOOL: Code = Code(533);
/// A zero is taken as touched outside the calibrated volume.
pub const TOUCHED_OUTSIDE: Code = Code(522);
/// A zero is taken as touched without a tool length, which another tool would have touched elsewhere.
pub const TOUCHED_BY_GUESS: Code = Code(523);
/// Motions that cannot be held within the tolerance, and are written all the same.
pub const ACCEPTED: Code = Code(528);
/// The control may leave the path by more than the tolerance, or by an unknown amount.
pub const CONTROL_LEAVES: Code = Code(529);
/// The program cannot be made to keep the control to the path.
pub const KEPT_NOWHERE: Code = Code(535);
/// Tools cut without a length in force.
pub const WITHOUT_LENGTH: Code = Code(527);
/// Lost motion moves the tool sideways where an axis turns, by more than can be hidden.
pub const SIDEWAYS: Code = Code(519);

/// Whether the output asks the control for what it was corrected for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Guards {
    /// No.
    #[default]
    None,
    /// Blocks that stop it where a work offset, or the tool's length, is another.
    Put,
}

/// Everything that decides what becomes of a program.
pub struct Job<'a> {
    /// The control's dialect.
    pub dialect: &'a Dialect,
    /// Work offsets and tools.
    pub setup: &'a Setup,
    /// Where the machine really goes.
    pub models: Models<'a>,
    /// How the work offsets came to be.
    pub datums: &'a Datums,
    /// Tolerance and policy.
    pub options: Options,
    /// Decimals of X, Y, Z in mm.
    pub decimals_mm: [u8; 3],
    /// Output step of A, B, C: decimals of a degree, and how many of their steps.
    pub rotary_steps: [(u8, u32); 3],
    /// Correct a program that was corrected before.
    pub force: bool,
    /// What the comment in the output says after its marker.
    pub provenance: &'a str,
    /// Whether the output asks the control for what it was corrected for.
    pub guards: Guards,
    /// What the control adds to the path where a program does not say.
    pub interpolator: Interpolator,
    /// What the output tells the control of keeping to the path.
    pub path_mode: PathMode,
}

impl<'a> Job<'a> {
    /// What a datum is asked of.
    pub(crate) fn machine(&self) -> (&'a dyn PathModel, &'a Dialect) {
        (self.models.axes, self.dialect)
    }

    /// How far the control leaves the path in a state, mm; infinite where nobody knows.
    #[inline]
    pub(crate) fn leaves_mm(&self, modal: &Modal) -> f64 {
        let off_mm = modal.path_control.off_mm;
        if off_mm.is_infinite() { self.interpolator.blending_mm.unwrap_or(off_mm) } else { off_mm }
    }
}

/// What is to be said, and the line it is said of.
pub(crate) type Warning = (Diagnostic, u64);
