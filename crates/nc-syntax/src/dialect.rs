//! A dialect as a value: what `grammars/*.toml` say.

use std::ops::Deref;

use units::decimal::Decimal;

use crate::Number;

/// A preparatory code in tenths: `G81` is 810, `G54.1` is 541.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct GCode(pub u16);

impl GCode {
    /// 81 of G81, 54 of G54.1.
    const fn whole(self) -> usize {
        self.0 as usize / 10
    }
}

impl std::fmt::Display for GCode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 % 10 {
            0 => write!(f, "G{}", self.0 / 10),
            part => write!(f, "G{}.{part}", self.0 / 10),
        }
    }
}

/// What `( )` means.
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

/// What `;` means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Semicolon {
    /// Not part of the dialect.
    None,
    /// The rest of the line is a comment.
    Comment,
    /// End of block; what follows on the line is a new block.
    EndOfBlock,
}

/// What `:` means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colon {
    /// Not part of the dialect.
    None,
    /// `:1234` is a program number or main block.
    Number,
    /// First on its line it makes the line a comment (Centroid).
    Comment,
}

/// What a number without a decimal point means for lengths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PointFree {
    /// `X100` is 100 mm (calculator type, LinuxCNC).
    Unit,
    /// `X100` is 100 least increments (conventional type, IS-B).
    LeastIncrement,
}

/// How numbers are written and read.
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

/// What a G code does, as far as `nc-program` must know.
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
    CompensationOn,
    /// G43
    LengthOn,
    /// G44
    LengthOnNegative,
    /// G49
    LengthOff,
    /// G54–G59: the name in the profile.
    WorkOffset(String),
    /// G54.1, G154: the work offset that P numbers, `G54.1P1` in the profile.
    WorkOffsetNumbered,
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
    Cycle(CycleCode),
    /// G80
    CycleCancel,
    /// G98
    ReturnInitial,
    /// G99
    ReturnR,
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
    /// Known, and refused.
    Refuse {
        /// Why.
        reason: String,
        /// The way out.
        help: String,
    },
}

/// G17, G18, G19; not `toolpath::Plane`, so that reading text needs no geometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlaneCode {
    /// G17
    Xy,
    /// G18
    Zx,
    /// G19
    Yz,
}

/// Which drilling cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CycleCode {
    /// G81, G82
    Drill,
    /// G85, G89
    Bore,
    /// G83
    PeckFull,
    /// G73
    PeckChip,
    /// G74, G76, G84, G86, G87, G88
    Synchronised,
}

/// What R and Z of a cycle mean for the blocks that repeat it without writing them again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OffsetL20 {
    /// The numbered work offset G54.1 Pn (Fanuc).
    Numbered,
    /// Work offset n, so that the axes stand at the words (LinuxCNC).
    Position,
}

/// How the codes that move the frame work together, where controls differ.
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
    /// P of an arc counts its turns (LinuxCNC).
    pub arc_turns: bool,
}

/// One row of the dialect's code table.
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
    /// A tool change: where the axes stand afterwards may be known of the machine.
    pub changes_tool: bool,
    /// What it switches on some machines (kinematics, a mirror, the workpiece's place): refused unless the machine
    /// is said to have it do nothing of the kind.
    pub switches: Option<String>,
    /// Refused, with the way out (M98, M99).
    pub refuse: Option<(String, String)>,
}

/// A block that stands in programs of lathes: any of the codes or commands, all of the letters, none of the others.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LatheSign {
    /// Any of them; empty where every block may be one.
    pub codes: Vec<GCode>,
    /// Any of them by name.
    pub commands: Vec<String>,
    /// No other G code stands in the block.
    pub alone: bool,
    /// All of these letters, upper case.
    pub with: Vec<u8>,
    /// None of these letters.
    pub without: Vec<u8>,
    /// This letter's number has so many digits, and neither half of them is zero (`T0101`).
    pub digits: Option<(u8, u8)>,
    /// No mill's program has it; else it counts together with others.
    pub sure: bool,
    /// What it does on a lathe.
    pub says: String,
    /// What to write where the program is a mill's.
    pub mill: String,
}

/// A command by name: a word of letters (Sinumerik `TRANS`) or the first word in brackets (Balt-System `(UAO,1)`).
///
/// A command that is not in the table is refused: it may move the frame.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Command {
    /// Upper case.
    pub name: String,
    /// `None`: moves no axis and no frame, passes. Else why it is refused, and the way out.
    pub refuse: Option<(String, String)>,
    /// It passes with so many arguments in its brackets, and is refused with more.
    pub passes_with: Option<u32>,
}

impl Command {
    /// Why it is refused as it stands, and the way out; `text` is its bytes, brackets included.
    #[must_use]
    pub fn refusal(&self, text: &[u8]) -> Option<&(String, String)> {
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
    /// The same as a share of the radius, where the control takes that too and it is more; 0 for none.
    pub arc_radius_tolerance_share: f64,
    /// Distance above the last depth where a G83 peck resumes feeding when written as moves, mm.
    pub peck_clearance_mm: f64,
    /// Retreat of a G73 peck when written as moves, mm.
    pub chip_retreat_mm: f64,
}

/// Which language of variables, expressions and program flow the control has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Macros {
    /// None that is known: a program that uses one is refused.
    #[default]
    None,
    /// Fanuc's custom macro B: `#1`, `IF … GOTO`, `WHILE … DO1`, G65; M98 and M99.
    Fanuc,
    /// LinuxCNC's parameters and O-words; M98 and M99.
    LinuxCnc,
}

/// Variables, program flow and subprograms.
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
    /// Some code is [`Action::PolarOn`].
    pub polar_words: bool,
}

/// Everything that differs between controls.
#[derive(Clone, Debug, PartialEq)]
pub struct Dialect {
    /// File name in `grammars/` without ending.
    pub name: String,
    /// What it is, for people.
    pub title: String,
    /// Assumptions made where no manual is public, shown by `grammar list`.
    pub assumptions: Vec<String>,
    /// What `( )` means.
    pub paren: Paren,
    /// What `;` means.
    pub semicolon: Semicolon,
    /// Character of block delete, if any.
    pub skip: Option<u8>,
    /// What `:` means.
    pub colon: Colon,
    /// `X=10.5` and `X=R1+2` are words too; a value other than a number runs to the next white space.
    pub equals_words: bool,
    /// Letters of words, upper case; others are invalid.
    pub letters: Vec<u8>,
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
    /// The unit of the program before may still be in force at the start: one that states none is doubtful.
    pub unit_is_kept: bool,
    /// Blocks by which a program of a lathe is known.
    pub lathe: Vec<LatheSign>,
    /// Variables, program flow and subprograms.
    pub flow: Flow,
    /// How cycles carry R and Z on.
    pub cycle_levels: CycleLevels,
    /// Letters that count the holes of a cycle's block.
    pub cycle_repeats: Vec<u8>,
    /// A count of zero stores the words of the cycle and makes no hole; where false it is an error.
    pub zero_repeats_define: bool,
    /// G43 without H, and with H0, takes the length of the tool in the spindle (LinuxCNC); where false it needs H, and
    /// H0 is no length.
    pub length_of_loaded_tool: bool,
    /// What G40 does to a tool length in force.
    pub length_under_g40: LengthAfter,
    /// What G49 does to it.
    pub length_under_g49: LengthAfter,
    /// A T word may bring in the tool, and its length, at once.
    pub t_may_change_tool: bool,
    /// Codes that move the frame.
    pub frames: FrameRules,
    /// Output.
    pub output: Output,
}

impl Dialect {
    /// The table's row for a code.
    #[must_use]
    #[inline]
    pub fn code(&self, code: GCode) -> Option<&CodeEntry> {
        self.codes.row(code)
    }

    /// The table's row for an M number.
    #[must_use]
    pub fn m_code(&self, number: u16) -> Option<&MCode> {
        self.m_codes.binary_search_by_key(&number, |entry| entry.number).ok().map(|at| &self.m_codes[at])
    }

    /// The table's row for a command: `text` is a [`crate::ItemKind::BracketCommand`]'s bytes, brackets included.
    #[must_use]
    pub fn command(&self, text: &[u8]) -> Option<&Command> {
        let start = text.iter().position(u8::is_ascii_alphabetic)?;
        let length =
            text[start..].iter().take_while(|byte| byte.is_ascii_alphanumeric() || **byte == b'_').count();
        let name = text[start..start + length].to_ascii_uppercase();
        self.commands
            .binary_search_by(|entry| entry.name.as_bytes().cmp(&name))
            .ok()
            .map(|at| &self.commands[at])
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
