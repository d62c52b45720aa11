//! What lathes have and mills have not.

use nc_syntax::GCode;

use super::codes::CodeEntry;

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
