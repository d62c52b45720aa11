//! The line that programs consist of by millions: a few words with plain numbers, and at most a comment behind them.
//!
//! Read once, into few bytes. What it holds is what [`crate::Reader::next`] would have shown as items.

use memchr::{memchr, memchr2};
use units::decimal::Decimal;

use crate::lexer::Lexer;
use crate::number::common_number;
use crate::spelling::{Paren, Semicolon};
use crate::{Number, Sign, Span};

/// Longest plain line without its end, bytes: positions in it fit into one byte.
const LONGEST: usize = 250;
/// A letter comes once, and few letters make a plain line.
const MOST_WORDS: usize = LETTERS.len();
/// The letters of plain lines.
const LETTERS: &[u8] = b"FGNXYZ";

/// A word of a plain line.
///
/// ```
/// use nc_syntax::{PlainLine, PlainWord, Reader};
///
/// let dialect = &nc_syntax::Marks::default();
/// let mut line = PlainLine::default();
/// assert!(Reader::new(b"X10.250 Y.5\n", dialect).plain_line(&mut line));
/// let [x, y] = line.words() else { panic!("two words") };
/// assert_eq!((x.letter(), x.number().to_f64()), (b'X', 10.25));
/// assert_eq!(line.text(y.number_span()), b".5");
/// // `.5` is spelt otherwise than `0.5`.
/// assert_eq!(x.form(), PlainWord::usual_form(3));
/// assert_ne!(y.form(), PlainWord::usual_form(1));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlainWord {
    mantissa: i64,
    /// A byte each from the lowest: letter, decimals, how the number is spelt, where word and number start, where they
    /// end. Written as one, since what is read together soon after has to be.
    facts: u64,
}

/// Bits of the byte that says how a number is spelt.
const HAS_POINT: u8 = 1;
const LEADING_DIGIT: u8 = 2;
const PLUS: u8 = 4;
const MINUS: u8 = 8;

impl PlainWord {
    #[inline(always)]
    fn new(letter: u8, number: Number, places: [usize; 3]) -> Self {
        let Number { decimal: Decimal { mantissa, decimals }, sign, has_point, leading_digit } = number;
        let sign = match sign {
            Sign::None => 0,
            Sign::Plus => PLUS,
            Sign::Minus => MINUS,
        };
        let spelt =
            sign | if has_point { HAS_POINT } else { 0 } | if leading_digit { LEADING_DIGIT } else { 0 };
        let [start, number, end] = places.map(|place| place as u8);
        let facts = u64::from_le_bytes([letter, decimals, spelt, start, number, end, 0, 0]);
        Self { mantissa, facts }
    }

    #[inline(always)]
    const fn fact(&self, byte: u32) -> u8 {
        (self.facts >> (8 * byte)) as u8
    }

    /// Upper-case letter: F, G, N, X, Y or Z.
    #[must_use]
    #[inline]
    pub const fn letter(&self) -> u8 {
        self.fact(0)
    }

    /// Its number.
    #[must_use]
    #[inline]
    pub fn number(&self) -> Number {
        let spelt = self.fact(2);
        let sign = match spelt & (PLUS | MINUS) {
            PLUS => Sign::Plus,
            MINUS => Sign::Minus,
            _ => Sign::None,
        };
        Number {
            decimal: Decimal { mantissa: self.mantissa, decimals: self.fact(1) },
            sign,
            has_point: spelt & HAS_POINT != 0,
            leading_digit: spelt & LEADING_DIGIT != 0,
        }
    }

    /// How its number is spelt, a minus aside: decimals, point, digit before the point, plus. Words of one form differ in
    /// their digits only.
    #[must_use]
    #[inline]
    pub const fn form(&self) -> u16 {
        (self.facts >> 8) as u16 & !((MINUS as u16) << 8)
    }

    /// The [`PlainWord::form`] of `0.5` with so many decimals.
    #[must_use]
    #[inline]
    pub const fn usual_form(decimals: u8) -> u16 {
        decimals as u16 | ((HAS_POINT | LEADING_DIGIT) as u16) << 8
    }

    /// Where letter and number stand in the line.
    #[must_use]
    #[inline]
    pub fn span(&self) -> Span {
        Span { start: self.fact(3).into(), end: self.fact(5).into() }
    }

    /// Where the number stands.
    #[must_use]
    #[inline]
    pub fn number_span(&self) -> Span {
        Span { start: self.fact(4).into(), end: self.fact(5).into() }
    }
}

/// A line of words with plain numbers, none of the letters F, G, N, X, Y, Z twice, and at most one comment behind them: one
/// block.
///
/// ```
/// use nc_syntax::{Block, PlainLine, Reader};
///
/// let dialect = &nc_syntax::Marks::default();
/// let mut reader = Reader::new(b"G1 X10. Y5. (first)\r\nX11. M5\n", dialect);
/// let (mut line, mut block) = (PlainLine::default(), Block::default());
/// assert!(reader.plain_line(&mut line));
/// assert_eq!((line.content(), line.end()), (&b"G1 X10. Y5. (first)"[..], &b"\r\n"[..]));
/// assert_eq!(line.words().len(), 3);
/// // M is none of its letters: nothing was read, and the slower way shows it.
/// assert!(!reader.plain_line(&mut line));
/// assert!(reader.next(&mut block));
/// assert_eq!(block.bytes, b"X11. M5\n");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlainLine<'a> {
    /// All bytes of the line, its end included.
    pub bytes: &'a [u8],
    /// Bytes of the file before it.
    pub offset: u64,
    /// Line of the file, from 1.
    pub line: u64,
    words: [PlainWord; MOST_WORDS],
    count: u8,
    content: u8,
}

impl<'a> PlainLine<'a> {
    /// What stands at a place of it.
    #[must_use]
    #[inline]
    pub fn text(&self, span: Span) -> &'a [u8] {
        &self.bytes[span.start as usize..span.end as usize]
    }

    /// Its words in order; at least one.
    #[must_use]
    #[inline]
    pub fn words(&self) -> &[PlainWord] {
        &self.words[..usize::from(self.count)]
    }

    /// Its bytes without its end.
    #[must_use]
    #[inline]
    pub fn content(&self) -> &'a [u8] {
        &self.bytes[..usize::from(self.content)]
    }

    /// What ends it.
    #[must_use]
    #[inline]
    pub fn end(&self) -> &'a [u8] {
        &self.bytes[usize::from(self.content)..]
    }
}

/// [`LETTERS`], one bit each.
const PLAIN: u32 = {
    let mut bits = 0;
    let mut at = 0;
    while at < LETTERS.len() {
        bits |= 1 << (LETTERS[at] - b'A');
        at += 1;
    }
    bits
};

const NO_WORD: PlainWord = PlainWord { mantissa: 0, facts: 0 };

impl Default for PlainLine<'_> {
    fn default() -> Self {
        Self { bytes: &[], offset: 0, line: 0, words: [NO_WORD; MOST_WORDS], count: 0, content: 0 }
    }
}

impl Lexer<'_> {
    /// Reads the plain line at the start of `text`; false where what stands there is, or might be, something else.
    #[inline]
    pub(crate) fn plain_line<'a>(&self, text: &'a [u8], found: &mut PlainLine<'a>) -> bool {
        self.plain_words(text, found).is_some()
    }

    #[inline(always)]
    fn plain_words<'a>(&self, text: &'a [u8], found: &mut PlainLine<'a>) -> Option<()> {
        // Places in the window fit into a byte.
        let window = &text[..text.len().min(LONGEST)];
        let (mut seen, mut count, mut at) = (0_u32, 0, 0);
        let line_end = loop {
            match *window.get(at)? {
                b' ' | b'\t' => at += 1,
                b'\n' => break 1,
                b'\r' if window.get(at + 1) == Some(&b'\n') => break 2,
                b'(' | b';' => at = self.comment_end(window, at)?,
                byte => {
                    let letter = byte.to_ascii_uppercase();
                    let bit = 1_u32.checked_shl(u32::from(letter.wrapping_sub(b'A')))?;
                    if bit & PLAIN & self.letters & !seen == 0 {
                        return None;
                    }
                    seen |= bit;
                    let (number, end) = common_number(window, at + 1, self.spaces_inside)?;
                    // No letter comes twice, so that there is room for each.
                    *found.words.get_mut(count)? = PlainWord::new(letter, number, [at, at + 1, end]);
                    count += 1;
                    at = end;
                }
            }
        };
        (found.count, found.content) = (count as u8, at as u8);
        found.bytes = &text[..at + line_end];
        (count > 0).then_some(())
    }

    /// The end of the line, where from `at` on a comment stands and blanks behind it.
    #[inline]
    fn comment_end(&self, line: &[u8], at: usize) -> Option<usize> {
        let end = at + memchr2(b'\n', b'\r', &line[at..])?;
        if line[at] == b';' {
            return (self.semicolon == Semicolon::Comment).then_some(end);
        }
        let Paren::Comment { nested } = self.paren else { return None };
        let inside = &line[at + 1..end];
        let close = memchr(b')', inside)?;
        let blank = inside[close + 1..].iter().all(|byte| matches!(byte, b' ' | b'\t'));
        (blank && !(nested && inside.contains(&b'('))).then_some(end)
    }
}
