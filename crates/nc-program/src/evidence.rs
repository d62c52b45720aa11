//! What a program as a whole shows of the control and the machine it was written for.
//!
//! No block by itself tells that a program was made for a lathe, that its lengths mix two conventions, or that it was cut
//! off. So each block is seen ([`Evidence::see`]), whatever else is done with it, and the whole is judged at the end
//! ([`Evidence::judge`]). What was seen in parts of a program adds up ([`Evidence::add`]); blocks are only read for it,
//! not executed.

use std::collections::BTreeSet;
use std::ops::Range;

use diagnostic::{Diagnostic, Edit, Text, both};
use nc_dialect::{Action, Dialect, LatheSign, PointFree};
use nc_syntax::{Block, GCode, ItemKind, Letters, Number, PlainLine, Reader, Value, Word};
use smallvec::SmallVec;

use crate::alike::{self, Sure};
use crate::codes;
use crate::setup::Setup;
use crate::words::is_motion;

/// G15
const POLAR_OFF: GCode = GCode(150);
/// As increments no program is smaller, whatever it positions and cuts.
const SMALLEST_PROGRAM: u64 = 1000;
/// Of fewer lengths nothing is concluded.
const FEWEST_BARE: u64 = 4;
/// How Sinumerik begins a program's name.
const PROGRAM_NAME: &[u8] = b"%_N_";
/// No more codes are named in one message.
const MOST_NAMED: usize = 8;

/// Letters whose numbers are lengths or angles wherever the block's words are positions. K counts the holes of a cycle on
/// some controls, and posts write Q in increments whatever they do with the others.
const LENGTHS: Letters = Letters::of(b"ABCIJRUVWXYZ");

/// A word or block of the program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// Bytes of the program.
    pub span: Range<u64>,
    /// Line, from 1.
    pub line: u64,
}

/// What is to be said, and the line it is said of.
pub type Finding = (Diagnostic, u64);

/// What to look for.
#[derive(Clone, Copy, Debug)]
pub struct Questions<'d> {
    dialect: &'d Dialect,
    /// What a length without a point is depends on a parameter of the control, and nobody said.
    lengths_open: bool,
}

impl<'d> Questions<'d> {
    /// As the dialect leaves them open, and the setup does not settle them.
    #[must_use]
    pub fn new(dialect: &'d Dialect, setup: &Setup) -> Self {
        let counts = dialect.numbers.point_free == PointFree::LeastIncrement;
        Self { dialect, lengths_open: counts && !setup.lengths_settled }
    }

    /// True where it matters that a length has no point.
    #[must_use]
    pub const fn lengths_open(&self) -> bool {
        self.lengths_open
    }
}

/// What was seen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Evidence {
    /// Signs of a lathe by their index in the dialect's table, each where it was seen first.
    lathe: SmallVec<[(usize, Place); 1]>,
    /// Letters of the linear axes that were named.
    names: [bool; 3],
    /// M6: programs of lathes have none.
    changes_tool: bool,
    /// Lengths without a point, zeros apart: zero is zero in either unit.
    bare: u64,
    first_bare: Option<Place>,
    first_pointed: Option<Place>,
    first_length: Option<Place>,
    states_unit: bool,
    unknown: u64,
    unknown_codes: BTreeSet<String>,
    first_unknown: Option<Place>,
    /// Something is executed: a `%` behind it closes the program.
    acts: bool,
    opened: Option<Place>,
    ends: bool,
    /// The number with which the text ends, without a line end.
    cut_number: Option<Place>,
    /// The largest of [`Evidence::bare`], increments.
    largest_bare: u64,
    /// What another control alone writes: `G15 H1`, where G15 is another code, is Okuma's work offset; `M97 P1000` is Haas's
    /// call of a block; `%_N_` begins a
    /// program's name on Sinumerik.
    other_control: Option<(Sure, Place)>,
}

impl Evidence {
    /// Sees a whole text.
    #[must_use]
    pub fn of(text: &[u8], questions: &Questions<'_>) -> Self {
        let mut evidence = Self::default();
        evidence.see_all(&mut Reader::new(text, questions.dialect), questions);
        evidence
    }

    /// Sees all that a reader reads.
    pub fn see_all(&mut self, reader: &mut Reader<'_>, questions: &Questions<'_>) {
        let mut block = Block::default();
        while reader.next(&mut block) {
            self.see(&block, questions);
        }
    }

    /// Sees a block.
    pub fn see(&mut self, block: &Block<'_>, questions: &Questions<'_>) {
        self.cut_number = None;
        let mut seen = Seen::default();
        let mut letters = Letters::NONE;
        for item in &block.items {
            match item.kind {
                ItemKind::Word { letter, value } if letter.is_ascii_uppercase() => {
                    // A3, B3, C3 are read as U, V, W and are no increments.
                    let own = || block.text(item.span).first().map(u8::to_ascii_uppercase);
                    let direction = matches!(letter, b'U' | b'V' | b'W') && own() != Some(letter);
                    letters = if direction { letters } else { letters.or(Letters::of(&[letter])) };
                    let word = Word { letter, value, span: item.span };
                    match (letter, value) {
                        (b'G', _) => seen.code(&word, questions.dialect),
                        (b'M', Value::Number(number)) => {
                            seen.local_call |= calls_a_block(number, questions.dialect);
                            self.miscellaneous(block, &word, number, questions);
                        }
                        _ => {}
                    }
                }
                ItemKind::Percent if self.opened.is_some() || self.acts => self.ends = true,
                // The name of a Siemens program opens no tape that another % would end.
                ItemKind::Percent if block.bytes.starts_with(PROGRAM_NAME) => {}
                ItemKind::Percent => self.opened = Some(place(block, block.file_span(item.span))),
                // What cannot be read says nothing of how numbers are written.
                ItemKind::Invalid(_) => seen.arguments = true,
                _ => {}
            }
        }
        if block.bytes.starts_with(PROGRAM_NAME) && !Sure::Sinumerik.is_read_by(questions.dialect) {
            self.belongs_to(Sure::Sinumerik, block);
        }
        self.states_unit |= seen.unit;
        if seen.polar_off && !seen.length && letters.any(Letters::of(b"H")) {
            self.belongs_to(Sure::Okuma, block);
        }
        if seen.local_call && letters.any(Letters::of(b"P")) {
            self.belongs_to(Sure::Haas, block);
        }
        self.acts |= !letters.without(Letters::of(b"NO")).is_empty();
        if !letters.is_empty() || !questions.dialect.commands.is_empty() {
            self.lathe(block, &seen, letters, questions.dialect);
        }
        if letters.any(LENGTHS) && !seen.arguments {
            self.lengths(block, seen.scales, questions);
        }
        let number = block.words().last().filter(|word| word.span.end as usize == block.bytes.len());
        if let Some(word) = number
            && word.number().is_some()
        {
            self.cut_number = Some(place(block, block.file_span(word.span)));
        }
    }

    /// True while something is yet to be seen that may stand in a plain line too. Where none of them has a length
    /// without a point, no other line needs to be seen.
    #[must_use]
    pub const fn wants_lines(&self, questions: &Questions<'_>) -> bool {
        let [x, y, z] = self.names;
        !(x && y && z)
            || self.first_length.is_none()
            || (questions.lengths_open && self.first_pointed.is_none())
    }

    /// Sees a line of plain coordinates.
    pub fn see_line(&mut self, line: &PlainLine<'_>, questions: &Questions<'_>) {
        self.acts = true;
        for word in line.words() {
            let Some(axis) = b"XYZ".iter().position(|letter| *letter == word.letter()) else { continue };
            self.names[axis] = true;
            let span = word.span();
            let span = line.offset + u64::from(span.start)..line.offset + u64::from(span.end);
            self.length(word.number(), || Place { span: span.clone(), line: line.line }, questions);
        }
    }

    /// Adds what was seen in the blocks that follow.
    pub fn add(&mut self, later: &Self) {
        let Self {
            lathe,
            names,
            changes_tool,
            bare,
            largest_bare,
            first_bare,
            first_pointed,
            first_length,
            states_unit,
            unknown,
            unknown_codes,
            first_unknown,
            acts,
            opened,
            ends,
            cut_number,
            other_control,
        } = later;
        for (sign, place) in lathe {
            self.sign(*sign, || place.clone());
        }
        (0..3).for_each(|i| self.names[i] |= names[i]);
        self.changes_tool |= changes_tool;
        self.bare += bare;
        self.largest_bare = self.largest_bare.max(*largest_bare);
        self.states_unit |= states_unit;
        self.unknown += unknown;
        self.unknown_codes.extend(unknown_codes.iter().cloned());
        // The mark that opened a part closes what was open before.
        self.ends |= *ends || (opened.is_some() && (self.opened.is_some() || self.acts));
        self.acts |= acts;
        for (first, later) in [
            (&mut self.first_bare, first_bare),
            (&mut self.first_pointed, first_pointed),
            (&mut self.first_length, first_length),
            (&mut self.first_unknown, first_unknown),
            (&mut self.opened, opened),
        ] {
            if first.is_none() {
                first.clone_from(later);
            }
        }
        if self.other_control.is_none() {
            self.other_control.clone_from(other_control);
        }
        self.cut_number.clone_from(cut_number);
    }

    fn belongs_to(&mut self, control: Sure, block: &Block<'_>) {
        self.other_control.get_or_insert_with(|| (control, place(block, block.file_range())));
    }

    fn sign(&mut self, sign: usize, place: impl FnOnce() -> Place) {
        if !self.lathe.iter().any(|(known, _)| *known == sign) {
            self.lathe.push((sign, place()));
        }
    }

    fn lathe(&mut self, block: &Block<'_>, seen: &Seen, letters: Letters, dialect: &Dialect) {
        for (index, sign) in dialect.lathe.iter().enumerate() {
            if matches(sign, block, seen, letters) {
                self.sign(index, || place(block, block.file_range()));
            }
        }
    }

    /// An M code: known, or counted.
    fn miscellaneous(&mut self, block: &Block<'_>, word: &Word, number: Number, questions: &Questions<'_>) {
        const SUBPROGRAM_ENDS: u16 = 99;
        let code = number.integer().and_then(|code| u16::try_from(code).ok());
        let row = code.and_then(|code| questions.dialect.m_code(code));
        self.ends |= row.is_some_and(|row| row.ends_program) || code == Some(SUBPROGRAM_ENDS);
        self.changes_tool |= row.is_some_and(|row| row.changes_tool);
        let call = code.is_some_and(|code| questions.dialect.flow.calls(i64::from(code)));
        if row.is_none() && !call {
            self.unknown += 1;
            self.unknown_codes.insert(String::from_utf8_lossy(block.text(word.span)).to_ascii_uppercase());
            self.first_unknown.get_or_insert_with(|| place(block, block.file_span(word.span)));
        }
    }

    fn lengths(&mut self, block: &Block<'_>, scales: bool, questions: &Questions<'_>) {
        for word in block.words() {
            let letter = Letters::of(&[word.letter.to_ascii_uppercase()]);
            // I and J beside G51 are factors.
            if !LENGTHS.any(letter) || (scales && matches!(word.letter, b'I' | b'J')) {
                continue;
            }
            if let Some(axis) = b"XYZ".iter().position(|letter| *letter == word.letter) {
                self.names[axis] = true;
            }
            let Value::Number(number) = word.value else { continue };
            self.length(number, || place(block, block.file_span(word.span)), questions);
        }
    }

    fn length(&mut self, number: Number, place: impl Fn() -> Place, questions: &Questions<'_>) {
        self.first_length.get_or_insert_with(&place);
        if !questions.lengths_open {
            return;
        }
        if number.has_point {
            self.first_pointed.get_or_insert_with(place);
        } else if number.decimal.mantissa != 0 {
            self.bare += 1;
            self.largest_bare = self.largest_bare.max(number.decimal.mantissa.unsigned_abs());
            self.first_bare.get_or_insert_with(place);
        }
    }

    /// What must refuse the program.
    ///
    /// # Errors
    /// VP0246 for a program of another control, VP0240 for one of a lathe, VP0241 for one that mixes lengths with and without a point.
    pub fn refusal(&self, questions: &Questions<'_>) -> Result<(), Box<Finding>> {
        if let Some((control, at)) = &self.other_control {
            return Err(Box::new((alike::sure(*control, questions.dialect, at.span.clone()), at.line)));
        }
        if let Some(finding) = self.of_a_lathe(questions.dialect) {
            return Err(Box::new(finding));
        }
        if let Some(finding) = self.too_small() {
            return Err(Box::new(finding));
        }
        let (Some(bare), Some(pointed)) = (&self.first_bare, &self.first_pointed) else { return Ok(()) };
        let message = both!(
            "{} length(s) without a decimal point beside lengths with one: a parameter of the control decides what they are",
            "рядом с размерами с десятичной точкой есть размеры без неё ({}): что они значат, решает параметр стойки",
            self.bare
        );
        let label = both!(
            "the first without a point; the first with one is in line {}",
            "первый без точки; первый с точкой — в строке {}",
            pointed.line
        );
        let diagnostic = Diagnostic::error(codes::MIXED_LENGTHS, message)
            .at(bare.span.clone(), label)
            .help(both!("`--decimal increments` where Z10 is ten steps (0.010 mm), `--decimal millimetres` where it is Z10.; or `decimal = \"…\"` under `[program]` in the profile", "`--decimal increments`, если Z10 — десять дискрет (0.010 мм), `--decimal millimetres`, если это Z10.; или `decimal = \"…\"` в разделе `[program]` профиля"));
        Err(Box::new((diagnostic, bare.line)))
    }

    /// Read as increments, the whole program would lie within a thousand of them: no cutter works so small, and none
    /// positions so near. Somebody wrote `X40` for forty millimetres.
    fn too_small(&self) -> Option<Finding> {
        let bare = self.first_bare.as_ref().filter(|_| self.first_pointed.is_none())?;
        if self.bare < FEWEST_BARE || self.largest_bare >= SMALLEST_PROGRAM {
            return None;
        }
        let message = both!(
            "no length has a decimal point, and read as increments the largest would be {} of them",
            "ни у одного размера нет десятичной точки, и, если это дискреты, в наибольшем их {}",
            self.largest_bare
        );
        let label =
            both!("the first: so small is no program", "первый; таких малых размеров в программах не бывает");
        let diagnostic = Diagnostic::error(codes::BARE_LENGTHS, message).at(bare.span.clone(), label).help(both!(
            "`--decimal millimetres` where X40 is forty millimetres, or the dialect that the program was posted for (`--dialect`); `--decimal increments` where it is 0.040 mm",
            "`--decimal millimetres`, если X40 — сорок миллиметров, или диалект, для которого выведена программа (`--dialect`); `--decimal increments`, если это 0.040 мм"
        ));
        Some((diagnostic, bare.line))
    }

    /// What is doubtful about the program, all of it read: VP0242 to VP0245.
    #[must_use]
    pub fn doubts(&self, questions: &Questions<'_>) -> Vec<Finding> {
        let mut doubts = self.doubts_of_a_part(questions);
        if let (true, false, Some(at)) =
            (questions.dialect.unit_is_kept, self.states_unit, &self.first_length)
        {
            let [inch, millimetre] = [Action::Inch, Action::Millimetre].map(|action| {
                let row = questions.dialect.row_of(&action);
                row.map_or_else(String::new, |row| row.code.to_string())
            });
            let diagnostic = Diagnostic::doubt(
                codes::UNIT_UNSTATED,
                both!(
                    "the program states neither {inch} nor {millimetre}, and is read in millimetres",
                    "в программе нет ни {inch}, ни {millimetre}; она прочитана в миллиметрах"
                ),
            )
            .at(
                at.span.clone(),
                both!(
                    "the first length; the control reads it in the unit of the program before",
                    "первый размер; стойка прочтёт его в единице прежней программы"
                ),
            )
            .help(both!(
                "write {millimetre} (or {inch}) at the start of the program",
                "напишите {millimetre} (или {inch}) в начале программы"
            ))
            .mended_by(Edit::insert(at.span.start, format!("{millimetre} ")));
            doubts.push((diagnostic, at.line));
        }
        doubts.extend(self.cut());
        doubts
    }

    /// The same, of a subprogram: its caller states the unit, and nothing closes it.
    #[must_use]
    pub fn doubts_of_a_part(&self, questions: &Questions<'_>) -> Vec<Finding> {
        let mut doubts = Vec::new();
        if let Some(at) = &self.first_bare {
            let decimals = questions.dialect.numbers.least_increment_decimals_mm;
            let step = units::decimal::Decimal { mantissa: 1, decimals }.to_f64();
            let diagnostic = Diagnostic::doubt(
                codes::BARE_LENGTHS,
                both!("{} length(s) without a decimal point are read as increments of {step} mm", "размеры без десятичной точки ({}) прочитаны в дискретах по {step} мм", self.bare),
            )
            .at(at.span.clone(), both!("the first; on a control set to calculator-type input it is a thousand times as long", "первый; на стойке с вводом «как на калькуляторе» он в тысячу раз больше"))
            .help(both!("`--decimal increments` says that this is right, `--decimal millimetres` that it is not; or `decimal = \"…\"` under `[program]` in the profile", "`--decimal increments` говорит, что это верно, `--decimal millimetres` — что нет; или `decimal = \"…\"` в разделе `[program]` профиля"));
            doubts.push((diagnostic, at.line));
        }
        if let Some(at) = &self.first_unknown {
            let named: Vec<&str> = self.unknown_codes.iter().take(MOST_NAMED).map(String::as_str).collect();
            let more = if self.unknown_codes.len() > named.len() { ", …" } else { "" };
            let quoted: Vec<String> = named.iter().map(|code| format!("\"{code}\"")).collect();
            let diagnostic = Diagnostic::doubt(
                codes::UNKNOWN_M_CODE,
                both!("{} M code(s) that the table of dialect {} does not have: {}{more}", "функций M, которых нет в таблице диалекта {1}: {0} ({2}{more})",
                    self.unknown,
                    questions.dialect.name,
                    named.join(", ")
                ),
            )
            .at(at.span.clone(), both!("the first; taken for something that moves neither an axis nor the frame", "первая; принята за такую, что не двигает ни оси, ни системы координат"))
            .help(both!("where the machine's manual says so, write `harmless = [{}{more}]` under `[m_codes]` in the profile", "если так сказано в руководстве станка, впишите `harmless = [{}{more}]` в раздел `[m_codes]` профиля",
                quoted.join(", ")
            ));
            doubts.push((diagnostic, at.line));
        }
        doubts
    }

    /// A program that may have been cut off.
    fn cut(&self) -> Option<Finding> {
        if self.ends {
            return None;
        }
        let (message, label, at) = match (&self.cut_number, &self.opened) {
            (Some(at), _) => (
                both!(
                    "the program ends with a number, and neither an end code nor a line end follows",
                    "программа кончается числом, за которым нет ни функции конца, ни конца строки"
                ),
                both!("perhaps not all of its digits are there", "возможно, часть цифр пропала"),
                at,
            ),
            (None, Some(at)) => (
                both!(
                    "a `%` opens the program, and neither a `%` nor an end code closes it",
                    "программа открыта знаком `%`, а не закрыта ни `%`, ни функцией конца"
                ),
                both!("opened here", "открыта здесь"),
                at,
            ),
            (None, None) => return None,
        };
        let diagnostic = Diagnostic::doubt(codes::CUT_OFF, message).at(at.span.clone(), label).help(both!(
            "compare it with the program as posted, and end it with M30",
            "сравните с программой, выведенной постпроцессором, и закончите её функцией M30"
        ));
        Some((diagnostic, at.line))
    }

    /// A sure sign tells, or a hint in a program that never names Y, or two hints.
    fn of_a_lathe(&self, dialect: &Dialect) -> Option<Finding> {
        let rows = self.lathe.iter().filter_map(|(sign, place)| Some((dialect.lathe.get(*sign)?, place)));
        // Mills write T1012 beside M6.
        let rows = rows.filter(|(sign, _)| sign.digits.is_none() || sign.sure || !self.changes_tool);
        let mut rows: Vec<(&LatheSign, &Place)> = rows.collect();
        // What is sure first, and what comes first in the program.
        rows.sort_by_key(|(sign, place)| (!sign.sure, place.span.start));
        let [x, y, z] = self.names;
        let tells = rows.iter().any(|(sign, _)| sign.sure) || rows.len() > 1 || (x && z && !y);
        let (sign, place) = rows.first().filter(|_| tells)?;
        let mut message = both!(
            "this is a program of a lathe, and dialect {} is of mills",
            "это программа токарного станка, а диалект {} — фрезерный",
            dialect.name
        );
        if !sign.sure && x && z && !y {
            message.push(&both!("; it never names Y", "; Y в ней не встречается"));
        }
        let diagnostic =
            Diagnostic::error(codes::LATHE, message).at(place.span.clone(), sign.says.clone()).help(both!(
                "use {} and the profile of a lathe; if it is a mill's: {}",
                "возьмите {:#} и профиль токарного станка; если программа фрезерная: {:#}",
                lathe_dialect(&dialect.name),
                sign.mill
            ));
        Some((diagnostic, place.line))
    }
}

/// What a lathe's dialect of the same control is called.
fn lathe_dialect(mill: &str) -> Text {
    match mill {
        "fanuc" => both!("the dialect fanuc-lathe", "диалект fanuc-lathe"),
        "linuxcnc" => both!("the dialect linuxcnc-lathe", "диалект linuxcnc-lathe"),
        "sinumerik" => both!("the dialect sinumerik-turn", "диалект sinumerik-turn"),
        _ => both!("a dialect of lathes (`vpost grammar list`)", "токарный диалект (`vpost grammar list`)"),
    }
}

/// What the codes of a block say of its words.
#[derive(Default)]
struct Seen {
    codes: SmallVec<[GCode; 8]>,
    unit: bool,
    /// The words are no positions.
    arguments: bool,
    scales: bool,
    /// G15, or nothing where the dialect has no polar words.
    polar_off: bool,
    /// A code that takes H.
    length: bool,
    /// G0 to G3.
    moves: bool,
    /// M97, where the dialect has none.
    local_call: bool,
}

impl Seen {
    fn code(&mut self, word: &Word, dialect: &Dialect) {
        let Some(code) = word.g_code() else { return };
        self.codes.push(code);
        let Some(row) = dialect.code(code) else { return };
        self.unit |= matches!(row.action, Action::Inch | Action::Millimetre);
        self.polar_off |= code == POLAR_OFF && matches!(row.action, Action::PolarOff | Action::Pass { .. });
        self.length |= matches!(
            row.action,
            Action::LengthOn | Action::LengthOnNegative | Action::TipLengthOn | Action::TipLengthOnVectors
        );
        self.scales |= row.action == Action::ScalingOn;
        self.moves |= is_motion(&row.action);
        self.arguments |= matches!(
            row.action,
            Action::Dwell | Action::Pass { takes_words: true } | Action::Turning(_) | Action::Refuse { .. }
        );
    }
}

/// M97 of Haas, under a dialect that has no such code, or another one that it refuses.
fn calls_a_block(number: Number, dialect: &Dialect) -> bool {
    const LOCAL_CALL: u16 = 97;
    number.integer() == Some(i64::from(LOCAL_CALL))
        && dialect.m_code(LOCAL_CALL).is_none_or(|row| row.refuse.is_some())
        && !dialect.flow.local_calls
        && !dialect.flow.calls(i64::from(LOCAL_CALL))
}

fn place(block: &Block<'_>, span: Range<u64>) -> Place {
    Place { span, line: block.line }
}

fn matches(sign: &LatheSign, block: &Block<'_>, seen: &Seen, letters: Letters) -> bool {
    if !sign.with.without(letters).is_empty() || letters.any(sign.without) {
        return false;
    }
    let coded = if !sign.commands.is_empty() {
        block.items.iter().any(|item| {
            item.kind == ItemKind::BracketCommand
                && sign.commands.iter().any(|name| is_named(block.text(item.span), name))
        })
    } else if sign.codes.is_empty() {
        !seen.arguments
    } else {
        seen.codes.iter().any(|code| sign.codes.contains(code)) && (!sign.alone || seen.codes.len() == 1)
    };
    coded
        && sign.digits.is_none_or(|(letter, count)| {
            block.word(letter).is_some_and(|word| has_digits(block.text(word.span), count))
        })
}

/// A command's bytes begin with its name as a whole word.
fn is_named(text: &[u8], name: &str) -> bool {
    text.len() >= name.len()
        && text[..name.len()].eq_ignore_ascii_case(name.as_bytes())
        && !text.get(name.len()).is_some_and(|next| next.is_ascii_alphanumeric() || *next == b'_')
}

/// So many digits behind the letter, neither half all zeros: `T0101`, not `T0001` or `T1000`.
fn has_digits(word: &[u8], count: u8) -> bool {
    let digits = word[1..].trim_ascii();
    let half = usize::from(count) / 2;
    let some = |digits: &[u8]| digits.iter().any(|digit| *digit != b'0');
    digits.len() == usize::from(count)
        && digits.iter().all(u8::is_ascii_digit)
        && some(&digits[..half])
        && some(&digits[half..])
}
