//! What the file's own text looks like.

use nc_dialect::{Action, CodeEntry, Dialect, MOTION_GROUP, Numbers, PointFree};
use nc_syntax::{Block, GCode, ItemKind, Number, PlainLine, PlainWord, Sign, Span, Value};
use units::decimal::Spelling;

use crate::words::{g_code, is_motion};

/// True for letters whose number is a length or an angle: without a point it may count least increments.
///
/// F, S, T, M, N, G, O, P, L, D, H follow rules of their own; a number without a point is a unit there.
const fn is_length(letter: u8) -> bool {
    matches!(letter, b'A'..=b'C' | b'I'..=b'K' | b'Q' | b'R' | b'U'..=b'Z')
}

/// True for letters whose spelling says how the file writes coordinates.
const fn is_coordinate(letter: u8) -> bool {
    is_length(letter) && letter != b'Q'
}

/// How the words seen so far are written: what an inserted word should look like.
///
/// Each habit is the one seen last; a word that says nothing about a habit (`X119.191` does not tell
/// whether `X10` would be `X10.000`) leaves it as it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Habits {
    spelling: Spelling,
    /// A coordinate has shown whether zeros at the end are written; else the spelling's is a guess.
    zeros_known: bool,
    /// Coordinates carry a point even where they are whole; `None` before the first that tells.
    point: Option<bool>,
    /// Most decimals of a coordinate so far: fewer in a later one mean that zeros are dropped.
    most_decimals: u8,
    /// What [`Habits::knows`] asks of all this.
    settled: bool,
    /// What stands between two words.
    pub(crate) separator: &'static [u8],
    /// `G01` rather than `G1`.
    pub(crate) two_digit_g: bool,
    /// `x10` rather than `X10`.
    pub(crate) lower_case: bool,
    /// What ends a line.
    pub(crate) line_end: &'static [u8],
}

impl Habits {
    /// What most posts write, until the file says otherwise.
    pub(crate) const fn new() -> Self {
        Self {
            spelling: Spelling::FIXED,
            zeros_known: false,
            point: None,
            most_decimals: 0,
            settled: false,
            separator: b" ",
            two_digit_g: false,
            lower_case: false,
            line_end: b"\n",
        }
    }

    /// Learns from the words of one block; returns what stands between two of its own, the last ones that follow each
    /// other.
    pub(crate) fn learn(&mut self, block: &Block<'_>) -> Option<&'static [u8]> {
        let mut before: Option<(Span, bool)> = None;
        let mut own = None;
        for item in &block.items {
            let ItemKind::Word { letter, value } = item.kind else {
                before = None;
                continue;
            };
            let text = block.text(item.span);
            if let Some(first) = text.first() {
                self.lower_case = first.is_ascii_lowercase();
            }
            if let Value::Number(number) = value {
                if letter == b'G' {
                    self.learn_g(number, text);
                } else if is_coordinate(letter) {
                    self.learn_coordinate(number);
                }
            }
            // The gap after N says little: `N10 G1X5Y5` is written without blanks.
            if let Some((span, is_number)) = before {
                let gap = &block.bytes[span.end as usize..item.span.start as usize];
                let known = separator(gap);
                own = Some(known);
                if !is_number || known.is_empty() {
                    self.separator = known;
                }
            }
            before = Some((item.span, letter == b'N'));
        }
        let end = line_end(block.bytes);
        if !end.is_empty() {
            self.line_end = end;
        }
        own
    }

    /// [`Habits::learn`] from a plain line.
    #[inline]
    pub(crate) fn learn_line(&mut self, line: &PlainLine<'_>) -> Option<&'static [u8]> {
        let mut before: Option<&PlainWord> = None;
        let mut own = None;
        for word in line.words() {
            match word.letter() {
                b'X' | b'Y' | b'Z' if self.knows(word) => {}
                b'X' | b'Y' | b'Z' => self.learn_coordinate(word.number()),
                b'G' => self.learn_g(word.number(), line.text(word.span())),
                _ => {}
            }
            if let Some(before) = before {
                let (end, start) = (before.span().end as usize, word.span().start as usize);
                let known = separator(&line.bytes[end..start]);
                own = Some(known);
                if before.letter() != b'N' || known.is_empty() {
                    self.separator = known;
                }
            }
            before = Some(word);
        }
        if let Some(last) = before {
            self.lower_case = line.bytes[last.span().start as usize].is_ascii_lowercase();
        }
        self.line_end = line_end(line.end());
        own
    }

    /// True where [`Habits::learn_coordinate`] would change nothing, as it is with most words of most files: all
    /// decimals there and the spelling as it was.
    #[inline]
    fn knows(&self, word: &PlainWord) -> bool {
        self.settled
            && word.form() == PlainWord::usual_form(self.most_decimals)
            && (self.spelling.trailing_zeros || word.number().decimal.mantissa % 10 != 0)
    }

    fn learn_g(&mut self, number: Number, text: &[u8]) {
        let small = number.decimal.decimals == 0 && number.decimal.mantissa < 10;
        if small && !number.has_point {
            self.two_digit_g = text.iter().filter(|byte| byte.is_ascii_digit()).count() >= 2;
        }
    }

    #[inline(never)]
    fn learn_coordinate(&mut self, number: Number) {
        let decimals = number.decimal.decimals;
        self.zeros_known |= (decimals == 0 && (number.has_point || number.decimal.mantissa != 0))
            || (decimals > 0 && (number.decimal.mantissa % 10 == 0 || decimals < self.most_decimals));
        self.spelling = Self::overlay(self.spelling, number, self.most_decimals);
        if number.has_point {
            self.point = Some(true);
            self.most_decimals = self.most_decimals.max(number.decimal.decimals);
        } else if number.decimal.mantissa != 0 {
            // A zero without a point is the same number in every dialect and tells nothing.
            self.point = Some(false);
        }
        self.settled = self.zeros_known
            && self.point == Some(true)
            && self.most_decimals > 0
            && self.spelling.leading_zero
            && !self.spelling.plus;
    }

    /// `habit` with what one number shows, `decimals` being how many it would have with its zeros.
    #[inline]
    fn overlay(habit: Spelling, number: Number, decimals: u8) -> Spelling {
        let Number { decimal, sign, has_point, leading_digit } = number;
        let mut spelling = habit;
        match sign {
            Sign::Plus => spelling.plus = true,
            Sign::None if decimal.mantissa != 0 => spelling.plus = false,
            Sign::None | Sign::Minus => {}
        }
        if has_point && decimal.decimals > 0 {
            // Where there is a digit before the point other than 0, it says nothing about `.5`.
            if !leading_digit || decimal.mantissa.unsigned_abs() < one(decimal.decimals) {
                spelling.leading_zero = leading_digit;
            }
            if decimal.mantissa % 10 == 0 {
                spelling.trailing_zeros = true;
            } else if decimal.decimals < decimals {
                spelling.trailing_zeros = false;
            }
        } else if has_point {
            spelling.trailing_zeros = false;
            spelling.trailing_point = true;
        } else if decimal.mantissa != 0 {
            spelling.trailing_zeros = false;
            spelling.trailing_point = false;
        }
        spelling
    }

    /// [`Habits::spell`] in place of a word X, Y or Z that tells nothing new, as it is with most words of most files;
    /// `None` for others.
    #[inline]
    pub(crate) fn spell_known(&self, word: &PlainWord, value: Step, numbers: &Increments) -> Option<Written> {
        let Step { counts, decimals } = value;
        if !self.knows(word) || decimals == 0 || decimals > self.most_decimals {
            return None;
        }
        let trailing_point = self.spelling.trailing_point || numbers.length.is_some();
        Some(Written { counts, decimals, spelling: Spelling { trailing_point, ..self.spelling } })
    }

    /// How to write `counts × 10^-decimals` after `letter`: the counts and decimals to print, and the
    /// spelling.
    ///
    /// The word replaced, if there is one, goes before the file's habit. Where a length without a point
    /// counts least increments, the text is a whole number of them only if the word (or the habit) has no
    /// point and the step is not finer; else it has a point: its meaning never flips.
    #[inline]
    pub(crate) fn spell(
        &self,
        letter: u8,
        replaced: Option<Number>,
        value: Step,
        numbers: &Increments,
    ) -> Written {
        let Step { counts, decimals } = value;
        let mut spelling = self.spelling;
        if !self.zeros_known {
            // All that was seen is `X10.5`: where the step is finer, zeros were dropped.
            spelling.trailing_zeros = self.most_decimals == 0 || self.most_decimals >= decimals;
        }
        if let Some(number) = replaced {
            spelling = Self::overlay(spelling, number, decimals);
        }
        if !is_length(letter) {
            // F and its like: a point where the replaced word had one, and for a fraction.
            let point = replaced.is_some_and(|number| number.has_point);
            spelling.trailing_point = point;
            spelling.trailing_zeros = point && spelling.trailing_zeros;
            spelling.plus = replaced.is_some_and(|number| number.sign == Sign::Plus);
            return Written { counts, decimals, spelling };
        }
        let Some(least_decimals) = numbers.of(letter) else {
            return Written { counts, decimals, spelling };
        };
        let point = match replaced {
            Some(number) if number.has_point => true,
            Some(number) if number.decimal.mantissa != 0 => false,
            _ => self.point.unwrap_or(true),
        };
        if !point && decimals <= least_decimals {
            let scale = 10_i64.checked_pow(u32::from(least_decimals - decimals));
            if let Some(increments) = scale.and_then(|scale| counts.checked_mul(scale)) {
                let spelling = Spelling { trailing_zeros: false, trailing_point: false, ..spelling };
                return Written { counts: increments, decimals: 0, spelling };
            }
        }
        spelling.trailing_point = true;
        spelling.trailing_zeros &= decimals > 0 && point;
        Written { counts, decimals, spelling }
    }
}

/// How many steps of `10^-decimals` make one.
fn one(decimals: u8) -> u64 {
    const ONES: [u64; 20] = {
        let mut ones = [1; 20];
        let mut at = 1;
        while at < ones.len() {
            ones[at] = ones[at - 1] * 10;
            at += 1;
        }
        ones
    };
    ONES.get(usize::from(decimals)).copied().unwrap_or(u64::MAX)
}

/// A value as a whole number of steps of `10^-decimals`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Step {
    pub(crate) counts: i64,
    pub(crate) decimals: u8,
}

/// A number and how it is to be printed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Written {
    counts: i64,
    decimals: u8,
    spelling: Spelling,
}

impl Written {
    /// Appends the number's text.
    #[inline]
    pub(crate) fn write(self, out: &mut Vec<u8>) {
        units::decimal::write(out, self.counts, self.decimals, self.spelling);
    }
}

/// What a length without a point counts, in the units in force.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Increments {
    /// Decimals of a length's least increment; `None` where a number without a point is a unit.
    length: Option<u8>,
    /// The same for an angle, which knows no inches.
    angle: Option<u8>,
}

impl Increments {
    pub(crate) fn new(numbers: &Numbers, modes: &Modes) -> Self {
        match numbers.point_free {
            PointFree::Unit => Self { length: None, angle: None },
            PointFree::LeastIncrement => Self {
                length: Some(if modes.inch {
                    numbers.least_increment_decimals_inch
                } else {
                    numbers.least_increment_decimals_mm
                }),
                angle: Some(numbers.least_increment_decimals_mm),
            },
        }
    }

    /// What a number means after `letter`, as steps of the unit in force.
    #[inline]
    pub(crate) fn value(self, letter: u8, number: Number) -> Step {
        let counts = number.decimal.mantissa;
        match self.of(letter) {
            Some(decimals) if !number.has_point => Step { counts, decimals },
            _ => Step { counts, decimals: number.decimal.decimals },
        }
    }

    #[inline]
    fn of(self, letter: u8) -> Option<u8> {
        if !is_length(letter) {
            return None;
        }
        if matches!(letter, b'A' | b'B' | b'C') { self.angle } else { self.length }
    }
}

/// The modal facts about the output that writing needs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Modes {
    /// Code in force in the group of G0 to G3.
    straight: Option<GCode>,
    /// Cycle in force, in dialects that keep cycles in a group of their own.
    cycle: Option<GCode>,
    /// G20 in force.
    pub(crate) inch: bool,
}

impl Modes {
    /// As a program starts in this dialect.
    pub(crate) fn initial(dialect: &Dialect) -> Self {
        let mut modes = Self { straight: None, cycle: None, inch: false };
        for &code in &dialect.initial {
            if let Some(entry) = dialect.code(code) {
                modes.step(entry);
            }
        }
        modes
    }

    /// The motion code in force: a cycle hides the code before it until it ends.
    pub(crate) fn motion(&self) -> Option<GCode> {
        self.cycle.or(self.straight)
    }

    /// It is not known which one is.
    pub(crate) fn forget_motion(&mut self) {
        (self.cycle, self.straight) = (None, None);
    }

    /// The motion code that the block's axis words meet if it has none of its own: a `G80` of another group
    /// than G0's ends the cycle before they move.
    pub(crate) fn motion_for(&self, dialect: &Dialect, block: &Block<'_>) -> Option<GCode> {
        if self.cycle.is_some() {
            let codes = block.items.iter().filter_map(|item| g_code(item.kind));
            if codes.filter_map(|code| dialect.code(code)).any(|entry| entry.action == Action::CycleCancel) {
                return self.straight;
            }
        }
        self.motion()
    }

    /// After a block as it stands.
    pub(crate) fn read(&mut self, dialect: &Dialect, block: &Block<'_>) {
        let mut moves = false;
        for item in &block.items {
            let Some(code) = g_code(item.kind) else { continue };
            let Some(entry) = dialect.code(code) else { continue };
            // `G0 G80 Z50`: the cycle ends, and the motion is G0.
            if entry.action != Action::CycleCancel || !moves {
                self.step(entry);
            }
            moves |= is_motion(entry);
        }
    }

    /// After a motion code was written.
    pub(crate) fn write(&mut self, dialect: &Dialect, code: GCode) {
        if let Some(entry) = dialect.code(code) {
            self.step(entry);
        }
    }

    fn step(&mut self, entry: &CodeEntry) {
        match entry.action {
            Action::Inch => self.inch = true,
            Action::Millimetre => self.inch = false,
            Action::CycleCancel => self.cycle = None,
            Action::Cycle(_) if entry.group != MOTION_GROUP => self.cycle = Some(entry.code),
            _ => {}
        }
        if entry.group == MOTION_GROUP {
            self.straight = Some(entry.code);
            self.cycle = None;
        }
    }
}

/// The gap between two words as something that can be repeated: one blank, one tab, or nothing.
pub(crate) fn separator(gap: &[u8]) -> &'static [u8] {
    match gap {
        [] => b"",
        [b'\t', ..] => b"\t",
        _ => b" ",
    }
}

/// The line ending at the end of `bytes`: `\n`, `\r\n`, `\r`, `\r\r\n`, or nothing.
pub(crate) fn line_end(bytes: &[u8]) -> &'static [u8] {
    match bytes {
        [.., b'\r', b'\r', b'\n'] => b"\r\r\n",
        [.., b'\r', b'\n'] => b"\r\n",
        [.., b'\n'] => b"\n",
        [.., b'\r'] => b"\r",
        _ => b"",
    }
}
