//! Rows of a control's tables: G codes, M codes, commands.

use std::ops::Deref;

use diagnostic::Text;
use nc_syntax::{GCode, Letters};

use super::action::{Action, TipSwitch};

/// Modal group of G0 to G3, and in some dialects of the cycles (numbers of the LinuxCNC and Fanuc manuals).
pub const MOTION_GROUP: u8 = 1;

/// One row of the dialect's code table.
///
/// ```
/// use nc_syntax::GCode;
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
/// use nc_dialect::{Action, CodeEntry, Codes};
/// use nc_syntax::GCode;
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
    pub(super) fn row(&self, code: GCode) -> Option<&CodeEntry> {
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
    /// It moves nothing, ends nothing, and stands on the first piece of a split block as on the block.
    pub(super) fn only_switches(&self) -> bool {
        !(self.after_motion
            || self.ends_program
            || self.changes_tool
            || self.switches.is_some()
            || self.tip.is_some()
            || self.refuse.is_some()
            || self.loses_position != [false; 3])
    }

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
    /// True where a text starts with its name as a whole word.
    pub(super) fn begins(&self, text: &[u8]) -> bool {
        let name = self.name.as_bytes();
        let whole = |next: &u8| !next.is_ascii_alphanumeric() && *next != b'_';
        text.len() >= name.len()
            && text[..name.len()].eq_ignore_ascii_case(name)
            && text.get(name.len()).is_none_or(whole)
    }

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
