//! A control as a value: what `grammars/*.toml` say.

mod action;
mod codes;
mod flow;
mod frames;
mod numbers;
mod output;
mod path;
mod turning;

use diagnostic::Text;
use nc_syntax::{GCode, Letters, Macros, Marks, Named, Spells};

pub use action::{
    Action, Called, CornerForm, CurveCode, FramePart, PlaneCode, Pockets, Side, TipSwitch, TurningCycle,
};
pub use codes::{CodeEntry, Codes, Command, ControlCall, LatheSign, MCode, MOTION_GROUP};
pub use flow::{CycleBack, CycleLevels, Flow, WrittenCycles};
pub use frames::{FrameRules, LengthAfter, LengthAtChange, OffsetL20, TWord};
pub use numbers::{Numbers, PointFree};
pub use output::{Output, RotaryFeed};
pub use path::{Keeps, PathCode, PathKey};
pub use turning::{System, Turning};

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

/// Everything that differs between controls.
///
/// ```
/// use nc_dialect::Action;
/// use nc_syntax::GCode;
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
    /// How its text is spelled.
    pub marks: Marks,
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
    /// use nc_dialect::Action;
    /// use nc_syntax::GCode;
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

    /// The table's row for a command: `text` is a [`nc_syntax::ItemKind::BracketCommand`]'s bytes, brackets included.
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

impl Spells for Dialect {
    fn marks(&self) -> &Marks {
        &self.marks
    }

    fn named(&self, text: &[u8]) -> Option<Named> {
        let command = self.commands.iter().find(|command| command.begins(text))?;
        let takes_block = command.refuse.is_some() && command.passes_with.is_none();
        Some(Named { length: command.name.len(), takes_block })
    }

    fn has_slash_arguments(&self, m_code: u16) -> bool {
        self.m_code(m_code).is_some_and(|row| row.slash_arguments)
    }

    fn only_switches(&self, m_code: u16) -> bool {
        self.m_code(m_code).is_some_and(MCode::only_switches)
    }

    fn macros(&self) -> Macros {
        self.flow.macros
    }

    fn copies_blocks(&self) -> bool {
        self.turning.is_none() && !self.flow.called && self.flow.written_cycles.is_none()
    }
}
