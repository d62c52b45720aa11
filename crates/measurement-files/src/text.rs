//! Bytes to text, and its lines and words with their places.

use std::borrow::Cow;
use std::ops::Range;

use encoding_rs::{IBM866, UTF_16BE, UTF_16LE, WINDOWS_1251};

use crate::number::Mark;

/// Text that may be older than UTF-8: then it is Windows-1251, as controls and instruments of the region write.
/// No two texts become the same, so ids stay apart.
#[must_use]
pub fn utf8_or_1251(bytes: &[u8]) -> Cow<'_, str> {
    match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(_) => WINDOWS_1251.decode_without_bom_handling(bytes).0,
    }
}

/// The number of a name, in order of appearance: 0 is the first of `names`, to which a new one is added.
pub fn numbered(names: &mut Vec<String>, name: &str) -> usize {
    names.iter().position(|known| known == name).unwrap_or_else(|| {
        names.push(name.to_owned());
        names.len() - 1
    })
}

/// The text of a file: UTF-8 with or without a byte order mark, UTF-16 (Excel's "Unicode text"), else Windows-1251, or CP866
/// where its letters are of that page (instruments under DOS).
///
/// Places in what is refused count bytes of this text.
#[must_use]
pub fn decoded(bytes: &[u8]) -> Cow<'_, str> {
    match bytes {
        [0xEF, 0xBB, 0xBF, rest @ ..] => utf8_or_1251(rest),
        [0xFF, 0xFE, rest @ ..] => UTF_16LE.decode_without_bom_handling(rest).0,
        [0xFE, 0xFF, rest @ ..] => UTF_16BE.decode_without_bom_handling(rest).0,
        // No table begins with NUL, nor has one behind its first letter.
        [1..=0xFF, 0, ..] => UTF_16LE.decode_without_bom_handling(bytes).0,
        [0, 1..=0xFF, ..] => UTF_16BE.decode_without_bom_handling(bytes).0,
        _ if std::str::from_utf8(bytes).is_err() && is_cp866(bytes) => {
            IBM866.decode_without_bom_handling(bytes).0
        }
        _ => utf8_or_1251(bytes),
    }
}

/// Whether a text that is not UTF-8 has its Cyrillic letters where CP866 has them.
///
/// Letters of both pages are 0xE0 to 0xEF. 0x80 to 0xAF are letters of CP866 alone (signs and letters of other languages in
/// Windows-1251), 0xC0 to 0xDF and 0xF2 to 0xFF of Windows-1251 alone (frames of tables and rare signs in CP866).
fn is_cp866(bytes: &[u8]) -> bool {
    let count = |is: fn(&u8) -> bool| bytes.iter().filter(|byte| is(byte)).count();
    let dos = count(|byte| (0x80..=0xAF).contains(byte));
    let windows = count(|byte| matches!(byte, 0xC0..=0xDF | 0xF2..=0xFF));
    // Dashes and quotation marks of other pages stand there, too.
    dos >= 4 && dos > 2 * windows
}

/// Part of a text.
///
/// ```
/// use measurement_files::Piece;
///
/// let lines: Vec<Piece> = Piece::lines("; tools\n T1  Z+4.5 \n").map(|line| line.before(&[';']).trimmed()).collect();
/// assert!(lines[0].text.is_empty());
/// let [tool, length] = lines[1].words().collect::<Vec<_>>()[..] else { panic!("two words") };
/// assert_eq!((tool.text, tool.span(), length.behind(1).number()), ("T1", 9..11, Some(4.5)));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Piece<'t> {
    /// What it says.
    pub text: &'t str,
    /// Bytes in front of it.
    at: usize,
}

impl<'t> Piece<'t> {
    /// The lines of a text, without their ends.
    pub fn lines(text: &'t str) -> impl Iterator<Item = Self> + Clone {
        let mut at = 0;
        text.split('\n').map(move |line| {
            let piece = Self { text: line.strip_suffix('\r').unwrap_or(line), at };
            at += line.len() + 1;
            piece
        })
    }

    /// What stands before the first of these characters.
    #[must_use]
    pub fn before(self, ends: &[char]) -> Self {
        let end = self.text.find(ends).unwrap_or(self.text.len());
        Self { text: &self.text[..end], at: self.at }
    }

    /// Without spaces around it.
    #[must_use]
    pub fn trimmed(self) -> Self {
        let text = self.text.trim_start();
        Self { at: self.at + (self.text.len() - text.len()), text: text.trim_end() }
    }

    /// What stands between spaces.
    pub fn words(self) -> impl Iterator<Item = Self> {
        let Self { text, at } = self;
        text.split_whitespace().map(move |word| Self {
            text: word,
            // Both are parts of one text.
            at: at + (word.as_ptr() as usize - text.as_ptr() as usize),
        })
    }

    /// What stands behind its first `bytes`.
    #[must_use]
    pub fn behind(self, bytes: usize) -> Self {
        Self { text: &self.text[bytes..], at: self.at + bytes }
    }

    /// Its first `bytes`.
    #[must_use]
    pub fn first(self, bytes: usize) -> Self {
        Self { text: &self.text[..bytes], at: self.at }
    }

    /// A number with a decimal point or none; `None` where it is none, or infinite.
    #[must_use]
    pub fn number(self) -> Option<f64> {
        Mark::Point.number(self.text)
    }

    /// Where it stands, bytes of the text.
    #[must_use]
    pub fn span(self) -> Range<usize> {
        self.at..self.at + self.text.len()
    }
}
