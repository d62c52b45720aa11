//! What lathes have and mills have not.

use nc_syntax::GCode;
use toolpath::TurningParameters;

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
