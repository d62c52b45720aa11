//! Flow of a program, and its drilling cycles.

use nc_syntax::Macros;
use serde::Deserialize;

/// What R and Z of a cycle mean for the blocks that repeat it without writing them again.
///
/// ```
/// use nc_dialect::CycleLevels;
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
    /// M53: to the level of [`crate::Action::ReturnLevel`]; M54: to where the feed begins. A motion code ends the cycle.
    ByM,
    /// [`crate::Action::ReturnInitial`]: to where the tool stood when the cycle began; [`crate::Action::ReturnR`]: to where the feed
    /// begins. [`crate::Action::CycleCancel`] alone ends the cycle.
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
    /// Some code is [`crate::Action::PolarOn`].
    pub polar_words: bool,
    /// Some command is an [`crate::Action::Called`], and `X=AC(5)`, `X=IC(5)` say a place or an increment.
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
