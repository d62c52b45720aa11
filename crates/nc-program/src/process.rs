//! What is in force while the tool moves, besides where it goes: the process state of a part.
//!
//! F, S, T, the numbers of tool, length and radius, compensation and every other modal code are *settings*: what counts
//! is which of them hold while a motion is made, not where they stand in the text. M codes, a dwell, an exact stop, a
//! switch of the tool's length (controls differ in what H alone does) are *deeds*: each is done at its place between
//! two motions, and in order. [`said`] reads a block, [`Process`] is the state that settings add up to. Motion codes,
//! cycles and return levels are not among them: they are the motions ([`crate::Step`]).

use std::fmt;

use diagnostic::{Text, both};
use nc_dialect::{Action, CodeEntry, Dialect, MOTION_GROUP, PathKey};
use nc_syntax::{Block, GCode, ItemKind, Word};
use smallvec::SmallVec;
use toolpath::{CycleKind, Kinematics, Motion};
use units::decimal::Decimal;

use crate::interpreter::Step;
use crate::modal::{CycleState, FeedMode};

/// Exact stop: holds at the end of its block, wherever in it the code stands.
const EXACT_STOP: GCode = GCode(90);
/// Letters whose last number holds until the next: speed, tool, length, cutter radius, and what some controls add.
const LETTERS: [u8; 5] = *b"STHDE";

/// A word with its number, trailing zeros apart: `P0.50` is `P0.5`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Argument {
    letter: u8,
    mantissa: i64,
    decimals: u8,
}

impl Argument {
    /// A word.
    #[must_use]
    pub fn new(letter: u8, number: Decimal) -> Self {
        let Decimal { mut mantissa, mut decimals } = number;
        while decimals > 0 && mantissa % 10 == 0 {
            (mantissa, decimals) = (mantissa / 10, decimals - 1);
        }
        Self { letter, mantissa, decimals }
    }
}

impl fmt::Display for Argument {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = Decimal { mantissa: self.mantissa, decimals: self.decimals };
        write!(f, "{}{}", self.letter as char, number.to_f64())
    }
}

type Arguments = SmallVec<[Argument; 2]>;

/// A code with the words that are its own.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
struct Mode {
    group: u8,
    code: GCode,
    arguments: Arguments,
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.code)?;
        self.arguments.iter().try_for_each(|argument| write!(f, " {argument}"))
    }
}

/// What is done once, where it stands: `G4 P500`, `M6`, `M0`. Deeds of one text are one deed.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Deed(String);

impl Deed {
    /// The dwell of so long that a cycle makes at the bottom of its hole, as a block of its own.
    #[must_use]
    pub fn dwell(dialect: &Dialect, time: Decimal) -> Self {
        let mut dwells = dialect.codes.iter().filter(|row| is_dwell(row));
        let code = dwells.next().map_or(GCode(40), |row| row.code);
        Self(format!("{code} {}", Argument::new(b'P', time)))
    }
}

impl fmt::Display for Deed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// One thing that a block says.
#[derive(Clone, Debug, PartialEq)]
pub enum Said {
    /// F, in mm or as it stands under G93.
    Feed(f64),
    /// Holds from here on.
    Setting(Setting),
    /// Is done here.
    Deed(Deed),
}

impl Said {
    /// Settings first, then deeds by their text.
    fn rank(&self) -> (bool, &str) {
        match self {
            Self::Deed(deed) => (true, &deed.0),
            Self::Feed(_) | Self::Setting(_) => (false, ""),
        }
    }
}

/// A tilted plane in whole nanometres and thousandths of a microradian: zero, direction of its X, of its Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Tilted([[i64; 3]; 3]);

impl Tilted {
    fn of(kinematics: &Kinematics) -> Option<Self> {
        let Kinematics::Plane(plane) = kinematics else { return None };
        let whole = |parts: [f64; 3], steps: f64| parts.map(|part| (part * steps).round() as i64);
        let column = |k: usize| whole([0, 1, 2].map(|row| plane.turn[row][k]), 1e9);
        Some(Self([whole(plane.zero_mm, 1e6), column(0), column(2)]))
    }
}

impl fmt::Display for Tilted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self([zero, x, z]) = self;
        let places = |parts: &[i64; 3], steps: f64| parts.map(|part| part as f64 / steps);
        let ([x0, y0, z0], x, z) = (places(zero, 1e6), places(x, 1e9), places(z, 1e9));
        both!(
            "a tilted plane with its zero at X{x0} Y{y0} Z{z0}, its X along {x:?} and its Z along {z:?}",
            "наклонная плоскость с нулём в X{x0} Y{y0} Z{z0}, X вдоль {x:?} и Z вдоль {z:?}"
        )
        .fmt(f)
    }
}

/// A setting that a block makes.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting(Kind);

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Word(Argument),
    Mode(Mode),
}

/// What a block says before its motion and behind it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BlockSays {
    /// Holds for its motion.
    pub before: SmallVec<[Said; 2]>,
    /// Comes when the motion is made: M5, M9, M30, an exact stop.
    pub behind: SmallVec<[Said; 1]>,
}

/// The settings in force.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Process {
    words: [Option<Argument>; LETTERS.len()],
    /// The last code of each modal group, by group.
    modes: SmallVec<[Mode; 12]>,
    /// What makes a hole, or is bound to the spindle, while it moves: a cycle, a thread.
    cycle: Option<Mode>,
    /// The working plane that X, Y and Z are coordinates of, however many blocks have said it.
    tilted: Option<Tilted>,
}

impl Process {
    /// At the start of a program: the dialect's initial codes.
    #[must_use]
    pub fn at_start(dialect: &Dialect) -> Self {
        let mut process = Self::default();
        for row in dialect.initial.iter().filter_map(|code| dialect.code(*code)) {
            if is_mode(row) {
                process.set_mode(Mode { group: row.group, code: row.code, arguments: Arguments::new() });
            }
        }
        process
    }

    /// A block sets something.
    pub fn set(&mut self, setting: Setting) {
        match setting.0 {
            Kind::Word(word) => {
                if let Some(at) = LETTERS.iter().position(|letter| *letter == word.letter) {
                    self.words[at] = Some(word);
                }
            }
            Kind::Mode(mode) => self.set_mode(mode),
        }
    }

    /// The last code of each modal group with its words, `G54.1 P2`.
    pub fn modes(&self) -> impl Iterator<Item = (GCode, String)> + '_ {
        self.modes.iter().map(|mode| (mode.code, mode.to_string()))
    }

    /// The last number of a letter.
    #[must_use]
    pub fn word(&self, letter: u8) -> Option<Argument> {
        self.words[LETTERS.iter().position(|known| *known == letter)?]
    }

    /// The same without what says how near the control keeps to the path.
    #[must_use]
    pub fn without_path_control(mut self, dialect: &Dialect) -> Self {
        let says = |code: GCode| dialect.path_control.iter().any(|row| row.key == PathKey::Code(code));
        self.modes.retain(|mode| !says(mode.code));
        self
    }

    /// What X, Y and Z are from here on; true where that is something else than before.
    pub fn move_by(&mut self, kinematics: &Kinematics) -> bool {
        let before = std::mem::replace(&mut self.tilted, Tilted::of(kinematics));
        before != self.tilted
    }

    fn set_mode(&mut self, mode: Mode) {
        match self.modes.binary_search_by_key(&mode.group, |known| known.group) {
            Ok(at) => self.modes[at] = mode,
            Err(at) => self.modes.insert(at, mode),
        }
    }

    /// The same while a cycle drills: its code, Q where it pecks or is bound to the spindle, and of the latter the
    /// dwell, which is a deed of any other.
    #[must_use]
    pub fn in_cycle(&self, cycle: Option<&CycleState>) -> Self {
        let cycle = cycle.map(|cycle| {
            let peck = cycle.peck_mm.map(|mm| Decimal { mantissa: (mm * 1e6).round() as i64, decimals: 6 });
            let dwell = cycle.dwell.filter(|_| cycle.kind == CycleKind::Synchronised).map(|(time, _)| time);
            let peck = peck.filter(|_| cycle.kind.takes_q());
            let words = [(b'P', dwell), (b'Q', peck)];
            let arguments = words.iter().filter_map(|(letter, word)| Some(Argument::new(*letter, (*word)?)));
            Mode { group: MOTION_GROUP, code: cycle.code, arguments: arguments.collect() }
        });
        Self { cycle, ..self.clone() }
    }

    /// The same for a motion of which the time is known, by F of G93 or of G94.
    #[must_use]
    pub fn by_time(&self, dialect: &Dialect) -> Self {
        let told = [Action::FeedInverseTime, Action::FeedPerMinute];
        let mut timed = self.clone();
        timed.modes.retain(|mode| dialect.code(mode.code).is_none_or(|row| !told.contains(&row.action)));
        timed
    }

    /// The same while a thread is cut by `block`: its code and its own words are part of the process.
    #[must_use]
    pub fn in_thread(&self, code: GCode, block: &Block<'_>) -> Self {
        const OWN: [u8; 3] = *b"EKQ";
        let word = |letter: u8| Some(Argument::new(letter, block.word(letter)?.number()?.decimal));
        let arguments = OWN.into_iter().filter_map(word).collect();
        Self { cycle: Some(Mode { group: MOTION_GROUP, code, arguments }), ..self.clone() }
    }

    /// What is in force here and what there, where that differs, in words: `S1000` and `S2000`.
    #[must_use]
    pub fn differences(&self, other: &Self) -> Vec<[Text; 2]> {
        fn text<T: fmt::Display>(value: Option<&T>, none: &Text) -> Text {
            value.map_or_else(|| none.clone(), |value| both!("{value}", "{value:#}"))
        }
        let mut pairs = vec![
            [&self.cycle, &other.cycle]
                .map(|cycle| text(cycle.as_ref(), &both!("no cycle of the spindle", "без цикла шпинделя"))),
        ];
        pairs.push(
            [self, other]
                .map(|p| text(p.tilted.as_ref(), &both!("no tilted plane", "без наклонной плоскости"))),
        );
        for (at, letter) in LETTERS.iter().enumerate() {
            let none = both!("no {}", "без {}", *letter as char);
            pairs.push([self, other].map(|p| text(p.words[at].as_ref(), &none)));
        }
        let mut groups: Vec<u8> = self.modes.iter().chain(&other.modes).map(|mode| mode.group).collect();
        groups.sort_unstable();
        groups.dedup();
        for group in groups {
            let find = |p: &Self| p.modes.iter().find(|mode| mode.group == group).cloned();
            pairs.push(
                [find(self), find(other)]
                    .map(|mode| text(mode.as_ref(), &both!("nothing of its kind", "ничего такого"))),
            );
        }
        pairs.retain(|[here, there]| here != there);
        pairs
    }
}

/// What a block says besides where to go; `step` is what it means.
#[must_use]
pub fn said(block: &Block<'_>, dialect: &Dialect, step: &Step) -> BlockSays {
    let mut says = BlockSays::default();
    let row = |word: &Word| word.g_code().and_then(|code| dialect.code(code));
    // The words of a dwell that is no motion are all its own, F and S too.
    let dwell = block.words().any(|word| row(&word).is_some_and(|row| row.action == Action::Dwell));
    // So are those of a call.
    let call = block.words().any(|word| row(&word).is_some_and(|row| row.action == Action::Call));
    for item in &block.items {
        match item.kind {
            ItemKind::BracketCommand => {
                let text = String::from_utf8_lossy(block.text(item.span)).to_ascii_uppercase();
                says.before.push(Said::Deed(Deed(text.split_whitespace().collect())));
            }
            ItemKind::Word { letter, value } => {
                let word = Word { letter, value, span: item.span };
                let Some(number) = word.number() else { continue };
                match letter {
                    b'F' if !dwell && !call => {
                        let inverse = step.context.feed_mode == FeedMode::InverseTime;
                        let unit_mm = if inverse { 1.0 } else { step.context.unit_mm };
                        says.before.push(Said::Feed(number.to_f64() * unit_mm));
                    }
                    b'M' => miscellaneous(number.integer(), dialect, &mut says),
                    b'G' => {
                        if let Some(row) = row(&word) {
                            preparatory(row, block, step, &mut says);
                        }
                    }
                    _ if LETTERS.contains(&letter) && !call && !(dwell && letter == b'S') => {
                        let argument = Argument::new(letter, number.decimal);
                        says.before.push(Said::Setting(Setting(Kind::Word(argument))));
                    }
                    _ => {}
                }
            }
            _ => {}
        }
    }
    // The order within a block means nothing, but that what it sets holds for what it does.
    says.before.sort_by(|a, b| a.rank().cmp(&b.rank()));
    says.behind.sort_by(|a, b| a.rank().cmp(&b.rank()));
    says
}

fn miscellaneous(number: Option<i64>, dialect: &Dialect, says: &mut BlockSays) {
    let Some(code) = number.and_then(|number| u16::try_from(number).ok()) else { return };
    let said = Said::Deed(Deed(format!("M{code}")));
    if dialect.m_code(code).is_some_and(|row| row.after_motion) {
        says.behind.push(said);
    } else {
        says.before.push(said);
    }
}

fn preparatory(row: &CodeEntry, block: &Block<'_>, step: &Step, says: &mut BlockSays) {
    if is_length(row) {
        says.before.push(Said::Deed(Deed(row.code.to_string())));
    }
    if is_mode(row) {
        let arguments = arguments(row, block, step);
        let mode = Mode { group: row.group, code: row.code, arguments };
        says.before.push(Said::Setting(Setting(Kind::Mode(mode))));
    } else if row.code == EXACT_STOP {
        says.behind.push(Said::Deed(Deed(row.code.to_string())));
    } else if row.group == 0 && !matches!(row.action, Action::CycleCancel) {
        let mut text = row.code.to_string();
        for argument in arguments(row, block, step) {
            text.push_str(&format!(" {argument}"));
        }
        says.before.push(Said::Deed(Deed(text)));
    }
}

/// A code that holds until another of its group; motions and what a cycle needs are not among them.
#[must_use]
pub fn is_mode(row: &CodeEntry) -> bool {
    row.group != 0
        && row.group != MOTION_GROUP
        && !matches!(
            row.action,
            Action::Cycle(_) | Action::CycleCancel | Action::ReturnInitial | Action::ReturnR
        )
}

fn is_length(row: &CodeEntry) -> bool {
    use Action::{LengthFromWords, LengthOff, LengthOn, LengthOnNegative};
    matches!(row.action, LengthOn | LengthOnNegative | LengthOff | LengthFromWords)
}

fn is_dwell(row: &CodeEntry) -> bool {
    matches!(row.action, Action::Dwell | Action::DwellP)
}

/// The words of a block that belong to a code, by letter.
fn arguments(row: &CodeEntry, block: &Block<'_>, step: &Step) -> Arguments {
    let moves = |motion: &Motion| !matches!(motion, Motion::Uncorrected { .. });
    let letters: &[u8] = match row.action {
        Action::Dwell => b"XUPFSEKLQR",
        Action::DwellP => b"P",
        // The places are in the motions, the frame or, where the correction states them anew, in both.
        _ if step.states_position || step.motions.iter().any(moves) => match row.action {
            Action::Pass { .. } if !step.motions.iter().any(|m| matches!(m, Motion::Hole(_))) => b"LPQ",
            _ => b"",
        },
        Action::MachineCoordinates => b"",
        // Its words stand in several blocks, and add up to the plane.
        Action::TiltedPlane => b"",
        _ => b"ABCIJKLPQRUVWXYZ",
    };
    let mut found: Arguments = block
        .words()
        .filter(|word| letters.contains(&word.letter))
        .filter_map(|word| Some(Argument::new(word.letter, word.number()?.decimal)))
        .collect();
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use nc_syntax::Reader;

    use super::*;
    use crate::{Interpreter, Setup};

    /// What is in force at each deed and motion of a Fanuc program, against a second program.
    fn states(text: &str) -> Vec<(String, Process)> {
        let dialect = nc_dialect_fanuc();
        let setup = Setup {
            start_mm: [Some(0.0); 3],
            work_offsets: vec![("G54".to_owned(), [0.0; 3])],
            ..Setup::default()
        };
        let mut interpreter = Interpreter::new(dialect, &setup);
        let (mut reader, mut block) = (Reader::new(text.as_bytes(), dialect), Block::default());
        let (mut process, mut states) = (Process::at_start(dialect), Vec::new());
        while reader.next(&mut block) {
            let step = interpreter.step(&block).expect("a right block");
            let BlockSays { before, behind } = said(&block, dialect, &step);
            let mut say = |said: Said, states: &mut Vec<(String, Process)>| match said {
                Said::Feed(_) => {}
                Said::Setting(setting) => process.set(setting),
                Said::Deed(deed) => states.push((deed.to_string(), process.clone())),
            };
            before.into_iter().for_each(|said| say(said, &mut states));
            if !step.motions.is_empty() {
                say(Said::Deed(Deed("moves".to_owned())), &mut states);
            }
            behind.into_iter().for_each(|said| say(said, &mut states));
        }
        states
    }

    fn nc_dialect_fanuc() -> &'static Dialect {
        nc_dialect::builtin("fanuc").expect("shipped")
    }

    #[test]
    fn what_holds_counts_and_not_where_it_stands() {
        let one = states("G21 G90 G54 S1000 M8 M3\nG1 X1. F100.\nX2. M9\nM30\n");
        let other = states("G54\nG21 M03 S1000.\nM08 G90 G1 X1. F100.\nX2.\nM9\nM30\n");
        assert_eq!(one, other);
        let deeds: Vec<&str> = one.iter().map(|(deed, _)| deed.as_str()).collect();
        assert_eq!(deeds, ["M3", "M8", "moves", "moves", "M9", "M30"]);
        let faster = states("G21 G90 G54 S2000 M3\n");
        assert_eq!(one[0].1.differences(&faster[0].1), [["S1000", "S2000"].map(Text::same)]);
    }

    #[test]
    fn deeds_have_their_words() {
        let said = states(
            "G21 G90 G54\nG4 P0500\nG4 X0.50\nT2 M6\nG5.1 Q1\nG0 X0. Y0. Z0.\nG9 G1 X1. F100.\nG28 X0. Z0.\n",
        );
        let texts: Vec<&str> = said.iter().map(|(deed, _)| deed.as_str()).collect();
        assert_eq!(
            texts,
            ["G4 P500", "G4 X0.5", "M6", "moves", "G5.1 Q1", "moves", "moves", "G9", "G28 X0 Z0", "moves"]
        );
    }

    #[test]
    fn cycles_of_the_spindle_are_process() {
        let fanuc = nc_dialect_fanuc();
        let cycle = CycleState {
            code: GCode(840),
            kind: CycleKind::Synchronised,
            initial: crate::modal::Axis::At(0.0),
            retract: None,
            bottom: None,
            peck_mm: Some(2.5),
            dwell: None,
            drilled: true,
        };
        let process = Process::at_start(fanuc);
        let tapping = process.in_cycle(Some(&cycle));
        let words = [Text::same("G84 Q2.5"), Text::pair("no cycle of the spindle", "без цикла шпинделя")];
        assert_eq!(tapping.differences(&process), [words]);
        let (code, kind) = (GCode(810), CycleKind::Drill);
        let drilling = process.in_cycle(Some(&CycleState { code, kind, ..cycle }));
        assert_eq!(tapping.differences(&drilling), [["G84 Q2.5", "G81"].map(Text::same)]);
    }
}
