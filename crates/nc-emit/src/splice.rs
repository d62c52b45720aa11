//! Changes to the text of one block.

use diagnostic::Diagnostic;
use nc_dialect::{Action, Dialect};
use nc_syntax::{Block, GCode, ItemKind, Number, PlainWord, Span, Value};
use smallvec::SmallVec;

use crate::edit::{Piece, WordEdit};
use crate::habits::{Habits, Increments, Step};
use crate::words::{find_word, is_after_motion, missing, motion_code, not_a_number};

/// Order in which words are written: G, then coordinates and arc centres, then the rest.
const ORDER: &[u8] = b"GXYZABCUVWIJKRPQLFSTM";

/// Last letter of [`ORDER`] that counts as a coordinate when a place for another is looked for.
const LAST_COORDINATE: u8 = b'R';

/// Place of a letter in the order of words; unknown letters come last.
pub(crate) const fn rank(letter: u8) -> u8 {
    const RANKS: [u8; 256] = {
        let mut ranks = [ORDER.len() as u8; 256];
        let mut at = 0;
        while at < ORDER.len() {
            ranks[ORDER[at] as usize] = at as u8;
            at += 1;
        }
        ranks
    };
    RANKS[letter as usize]
}

/// A letter as a bit, upper or lower case.
pub(crate) const fn bit(letter: u8) -> u32 {
    1 << (letter & 31)
}

/// Letters as bits.
pub(crate) fn letters(letters: impl Iterator<Item = u8>) -> u32 {
    letters.fold(0, |letters, letter| letters | bit(letter))
}

/// How words are written into this block.
#[derive(Clone, Copy)]
pub(crate) struct Style<'h> {
    pub(crate) habits: &'h Habits,
    /// Names of letters that do not stand alone: `CR` of R.
    pub(crate) long_words: &'h [(String, u8)],
    /// What stands between two words: the block's own, where it has any.
    pub(crate) separator: &'static [u8],
    pub(crate) increments: Increments,
}

impl Style<'_> {
    pub(crate) fn write_letter(&self, letter: u8, out: &mut Vec<u8>) {
        match self.long_words.iter().find(|(_, known)| *known == letter) {
            Some((name, _)) => {
                out.extend_from_slice(name.as_bytes());
                out.push(b'=');
            }
            None => out.push(if self.habits.lower_case { letter.to_ascii_lowercase() } else { letter }),
        }
    }

    #[inline]
    pub(crate) fn write_number(
        &self,
        letter: u8,
        replaced: Option<Number>,
        counts: i64,
        decimals: u8,
        out: &mut Vec<u8>,
    ) {
        self.habits.spell(letter, replaced, Step { counts, decimals }, &self.increments).write(out);
    }

    /// [`Style::write_number`] in place of a word of a plain line.
    #[inline]
    pub(crate) fn write_in_place(&self, word: &PlainWord, counts: i64, decimals: u8, out: &mut Vec<u8>) {
        let step = Step { counts, decimals };
        let written = match self.habits.spell_known(word, step, &self.increments) {
            Some(written) => written,
            None => self.habits.spell(word.letter(), Some(word.number()), step, &self.increments),
        };
        written.write(out);
    }

    /// The word already says `counts × 10^-decimals`: its text may stay.
    #[inline]
    pub(crate) fn same_value(&self, letter: u8, number: Number, counts: i64, decimals: u8) -> bool {
        let written = self.increments.value(letter, number);
        if written.decimals == decimals {
            return written.counts == counts;
        }
        // What overflows is no number that the other, which is not shifted, could be.
        let shift =
            |value: i64, by: u8| 10_i64.checked_pow(u32::from(by)).and_then(|by| value.checked_mul(by));
        let most = written.decimals.max(decimals);
        let (one, other) = (shift(written.counts, most - written.decimals), shift(counts, most - decimals));
        one.is_some() && one == other
    }

    /// A new word for X, Y or Z, if it is to have one.
    pub(crate) fn put_axis(
        &self,
        axis: usize,
        counts: Option<i64>,
        decimals: [u8; 3],
        place: Place,
        out: &mut Vec<u8>,
    ) {
        let Some(counts) = counts else { return };
        let letter = b"XYZ"[axis];
        put(place, self.separator, out, |out| {
            self.write_letter(letter, out);
            self.write_number(letter, None, counts, decimals[axis], out);
        });
    }

    pub(crate) fn write_g(&self, code: GCode, out: &mut Vec<u8>) {
        self.write_letter(b'G', out);
        write_code(code, if self.habits.two_digit_g { 2 } else { 1 }, out);
    }

    /// A number with leading zeros up to `width` digits.
    pub(crate) fn write_padded(&self, number: u32, width: usize, out: &mut Vec<u8>) {
        let mut digits = [b'0'; 10];
        let mut at = digits.len();
        let mut left = number;
        while left > 0 {
            at -= 1;
            digits[at] = b'0' + (left % 10) as u8;
            left /= 10;
        }
        out.extend_from_slice(&digits[at.min(digits.len() - width.clamp(1, digits.len()))..]);
    }
}

/// A code's number with leading zeros up to so many digits, one or two.
fn write_code(code: GCode, digits: usize, out: &mut Vec<u8>) {
    let (whole, part) = (code.0 / 10, code.0 % 10);
    if digits == 2 && whole < 10 {
        out.push(b'0');
    }
    let plain = units::decimal::Spelling { trailing_point: false, ..units::decimal::Spelling::FIXED };
    units::decimal::write(out, i64::from(whole), 0, plain);
    if part > 0 {
        out.extend_from_slice(&[b'.', b'0' + part as u8]);
    }
}

/// What stands in place of a stretch of the block.
#[derive(Clone, Copy, Debug)]
enum Text {
    Nothing,
    /// The number alone: letter and blanks of the word stay.
    Number {
        letter: u8,
        replaced: Number,
        counts: i64,
        decimals: u8,
    },
    /// The code's digits alone.
    Code {
        code: GCode,
        digits: usize,
    },
    /// A new word.
    Word {
        letter: u8,
        counts: i64,
        decimals: u8,
        place: Place,
    },
    /// A new G word.
    Motion {
        code: GCode,
        place: Place,
    },
}

/// On which side of its place an inserted word has a neighbour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    Before,
    After,
}

#[derive(Clone, Copy, Debug)]
struct Splice {
    span: Span,
    /// Order among insertions at one place.
    rank: u8,
    text: Text,
}

/// All changes to one block, in the order of its bytes.
#[derive(Default)]
pub(crate) struct Splices {
    list: SmallVec<[Splice; 12]>,
}

impl Splices {
    /// Adds what turns `block` into the first of its pieces.
    pub(crate) fn make_first_piece(
        &mut self,
        dialect: &Dialect,
        block: &Block<'_>,
        (piece, later): (&Piece, &[Piece]),
        in_force: Option<GCode>,
    ) -> Result<(), Diagnostic> {
        let several = !later.is_empty();
        let removed =
            letters(piece.words.iter().filter(|word| word.1 == WordEdit::Remove).map(|word| word.0));
        let survives = |kind: ItemKind| {
            let ItemKind::Word { letter, .. } = kind else { return false };
            !(removed & bit(letter) != 0 || several && is_after_motion(dialect, kind))
        };
        self.motion(dialect, block, piece, in_force, &survives);
        for &(letter, edit) in &piece.words {
            let word = find_word(block, letter)?;
            match (edit, word) {
                (WordEdit::Keep, None) => return Err(missing(block, letter)),
                (WordEdit::Keep, Some(_)) | (WordEdit::Remove, None) => {}
                (WordEdit::Remove, Some((span, _))) => self.remove(block, span),
                (WordEdit::Write { counts, decimals }, Some((span, value))) => {
                    let Value::Number(replaced) = value else {
                        return Err(not_a_number(block, letter, span));
                    };
                    let text = Text::Number { letter, replaced, counts, decimals };
                    self.add(number_span(block, span), 0, text);
                }
                (WordEdit::Write { counts, decimals }, None) => {
                    let (at, place) = place_of(block, letter, &survives);
                    let text = Text::Word { letter, counts, decimals, place };
                    self.add(Span { start: at, end: at }, 1 + rank(letter), text);
                }
            }
        }
        if several {
            for item in &block.items {
                if is_after_motion(dialect, item.kind) {
                    self.remove(block, item.span);
                }
            }
        }
        // Insertions go before a removal that starts at the same byte.
        self.list.sort_by_key(|splice| (splice.span.start, splice.span.end > splice.span.start, splice.rank));
        Ok(())
    }

    /// The block's own motion code if it has one, else an inserted one where the output needs it.
    fn motion(
        &mut self,
        dialect: &Dialect,
        block: &Block<'_>,
        piece: &Piece,
        in_force: Option<GCode>,
        survives: &dyn Fn(ItemKind) -> bool,
    ) {
        let Some(wanted) = piece.motion else { return };
        let mut own: Option<(Span, GCode)> = None;
        for item in &block.items {
            let Some(code) = motion_code(dialect, item.kind) else { continue };
            // `G80 G0 X10`: the motion is G0.
            if own.is_none() || !is_cancel(dialect, code) {
                own = Some((item.span, code));
            }
        }
        match own {
            Some((_, code)) if code == wanted => {}
            Some((span, _)) => {
                let span = number_span(block, span);
                let own = block.text(span);
                let is_padded =
                    own.first() == Some(&b'0') && own.iter().filter(|b| b.is_ascii_digit()).count() >= 2;
                self.add(span, 0, Text::Code { code: wanted, digits: if is_padded { 2 } else { 1 } });
            }
            None if in_force == Some(wanted) => {}
            None => {
                let (at, place) = place_of(block, b'G', survives);
                self.add(Span { start: at, end: at }, 0, Text::Motion { code: wanted, place });
            }
        }
    }

    fn add(&mut self, span: Span, rank: u8, text: Text) {
        self.list.push(Splice { span, rank, text });
    }

    /// The word with the blanks before it; at the start of a block, with the blanks after it.
    fn remove(&mut self, block: &Block<'_>, word: Span) {
        let before = block.bytes[..word.start as usize].trim_ascii_end().len() as u32;
        let span = if before > 0 {
            Span { start: before, end: word.end }
        } else {
            let rest = &block.bytes[word.end as usize..];
            let blanks = rest.iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count() as u32;
            Span { start: word.start, end: word.end + blanks }
        };
        self.add(span, 0, Text::Nothing);
    }

    /// Appends the changed block, `content` being its bytes without the end of line.
    pub(crate) fn write(&self, block: &Block<'_>, content: &[u8], style: &Style<'_>, out: &mut Vec<u8>) {
        let mut done = 0;
        for splice in &self.list {
            let start = (splice.span.start as usize).min(content.len());
            if start > done {
                out.extend_from_slice(&content[done..start]);
            }
            done = done.max(splice.span.end as usize).max(start);
            let separator = style.separator;
            match splice.text {
                Text::Nothing => {}
                Text::Number { letter, replaced, counts, decimals } => {
                    if style.same_value(letter, replaced, counts, decimals) {
                        out.extend_from_slice(block.text(splice.span));
                    } else {
                        style.write_number(letter, Some(replaced), counts, decimals, out);
                    }
                }
                Text::Code { code, digits } => write_code(code, digits, out),
                Text::Word { letter, counts, decimals, place } => {
                    put(place, separator, out, |out| {
                        style.write_letter(letter, out);
                        style.write_number(letter, None, counts, decimals, out);
                    });
                }
                Text::Motion { code, place } => put(place, separator, out, |out| style.write_g(code, out)),
            }
            // `Z0.003` before `E90` would read as one number to some, in a file that writes no blanks.
            let next = content.get(splice.span.end as usize);
            if next.is_some_and(|byte| byte.eq_ignore_ascii_case(&b'E'))
                && out.last().is_some_and(|byte| byte.is_ascii_digit() || *byte == b'.')
            {
                out.push(b' ');
            }
        }
        out.extend_from_slice(&content[done.min(content.len())..]);
    }
}

fn put(place: Place, separator: &[u8], out: &mut Vec<u8>, word: impl FnOnce(&mut Vec<u8>)) {
    if place == Place::After {
        out.extend_from_slice(separator);
    }
    word(out);
    if place == Place::Before {
        out.extend_from_slice(separator);
    }
}

fn is_cancel(dialect: &Dialect, code: GCode) -> bool {
    dialect.code(code).is_some_and(|entry| entry.action == Action::CycleCancel)
}

/// The number of a word: what follows the letter, blanks, and the `=` of `X=10.5`.
pub(crate) fn number_span(block: &Block<'_>, word: Span) -> Span {
    let text = block.text(word);
    // `CR=5` and `S2=500` have more than a letter before it.
    let name = text.iter().position(|byte| *byte == b'=').map_or(1, |at| at + 1);
    let blanks = text[name..].iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count();
    Span { start: word.start + (name + blanks) as u32, end: word.end }
}

/// Where a new word goes: before the first later coordinate, else after the last earlier one, else after
/// the last G or N word, else before everything that is not block delete.
fn place_of(block: &Block<'_>, letter: u8, survives: &dyn Fn(ItemKind) -> bool) -> (u32, Place) {
    let words = || {
        block.items.iter().filter(|item| survives(item.kind)).filter_map(|item| match item.kind {
            ItemKind::Word { letter, .. } => Some((letter, item.span)),
            _ => None,
        })
    };
    let coordinate = |other: u8| other != b'G' && rank(other) <= rank(LAST_COORDINATE);
    if letter == b'G' {
        if let Some((_, span)) = words().find(|(other, _)| !matches!(other, b'N' | b'O')) {
            return (span.start, Place::Before);
        }
    } else if let Some((_, span)) =
        words().find(|(other, _)| coordinate(*other) && rank(*other) > rank(letter))
    {
        return (span.start, Place::Before);
    } else if let Some((_, span)) =
        words().filter(|(other, _)| coordinate(*other) && rank(*other) < rank(letter)).last()
    {
        return (span.end, Place::After);
    }
    if let Some((_, span)) = words().filter(|(other, _)| matches!(other, b'G' | b'N')).last() {
        return (span.end, Place::After);
    }
    match block.items.iter().find(|item| item.kind != ItemKind::Skip) {
        Some(item) => (item.span.start, Place::Before),
        None => (block.items.last().map_or(0, |item| item.span.end), Place::After),
    }
}
