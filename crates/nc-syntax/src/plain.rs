//! The line that programs consist of by millions: a few words with plain numbers and nothing else.
//!
//! Read once, into few bytes. What it holds is what [`crate::Reader::next`] would have shown as items.

use units::decimal::Decimal;

use crate::lexer::Lexer;
use crate::number::common_number;
use crate::{Number, Sign, Span};

/// Longest plain line without its end, bytes: positions in it fit into one byte.
const LONGEST: usize = 250;
/// A letter comes once, and few letters make a plain line.
const MOST_WORDS: usize = LETTERS.len();
/// The letters of plain lines.
const LETTERS: &[u8] = b"FGNXYZ";

/// A word of a plain line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PlainWord {
    mantissa: i64,
    decimals: u8,
    sign: Sign,
    /// A decimal point was written.
    pub has_point: bool,
    /// A digit stands before the point.
    pub leading_digit: bool,
    /// Upper-case letter: F, G, N, X, Y or Z.
    pub letter: u8,
    start: u8,
    number: u8,
    end: u8,
}

impl PlainWord {
    /// Its number.
    #[must_use]
    #[inline]
    pub fn number(&self) -> Number {
        let Self { mantissa, decimals, sign, has_point, leading_digit, .. } = *self;
        Number { decimal: Decimal { mantissa, decimals }, sign, has_point, leading_digit }
    }

    /// Where letter and number stand in the line.
    #[must_use]
    #[inline]
    pub fn span(&self) -> Span {
        Span { start: self.start.into(), end: self.end.into() }
    }

    /// Where the number stands.
    #[must_use]
    #[inline]
    pub fn number_span(&self) -> Span {
        Span { start: self.number.into(), end: self.end.into() }
    }
}

/// A line of words with plain numbers, none of the letters F, G, N, X, Y, Z twice, and nothing else: one block.
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

const NO_WORD: PlainWord = PlainWord {
    mantissa: 0,
    decimals: 0,
    sign: Sign::None,
    has_point: false,
    leading_digit: false,
    letter: 0,
    start: 0,
    number: 0,
    end: 0,
};

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
                byte => {
                    let letter = byte.to_ascii_uppercase();
                    let bit = 1_u32.checked_shl(u32::from(letter.wrapping_sub(b'A')))?;
                    if bit & PLAIN & self.letters & !seen == 0 {
                        return None;
                    }
                    seen |= bit;
                    let (number, end) = common_number(window, at + 1, self.spaces_inside)?;
                    let Number { decimal: Decimal { mantissa, decimals }, sign, has_point, leading_digit } =
                        number;
                    // No letter comes twice, so that there is room for each.
                    *found.words.get_mut(count)? = PlainWord {
                        mantissa,
                        decimals,
                        sign,
                        has_point,
                        leading_digit,
                        letter,
                        start: at as u8,
                        number: at as u8 + 1,
                        end: end as u8,
                    };
                    count += 1;
                    at = end;
                }
            }
        };
        (found.count, found.content) = (count as u8, at as u8);
        found.bytes = &text[..at + line_end];
        (count > 0).then_some(())
    }
}
