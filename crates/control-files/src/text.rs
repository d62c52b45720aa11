//! Lines and words of a text, with their places.

use diagnostic::{Code, Diagnostic};
use measurement_files::Refusal;

/// Part of a text.
#[derive(Clone, Copy)]
pub(crate) struct Piece<'t> {
    pub(crate) text: &'t str,
    /// Bytes in front of it.
    at: usize,
}

impl<'t> Piece<'t> {
    /// The lines of a text, without their ends.
    pub(crate) fn lines(text: &'t str) -> impl Iterator<Item = Self> {
        let mut at = 0;
        text.split('\n').map(move |line| {
            let piece = Self { text: line.strip_suffix('\r').unwrap_or(line), at };
            at += line.len() + 1;
            piece
        })
    }

    /// What stands before the first of these characters.
    pub(crate) fn before(self, ends: &[char]) -> Self {
        let end = self.text.find(ends).unwrap_or(self.text.len());
        Self { text: &self.text[..end], at: self.at }
    }

    /// Without spaces around it.
    pub(crate) fn trimmed(self) -> Self {
        let text = self.text.trim_start();
        Self { at: self.at + (self.text.len() - text.len()), text: text.trim_end() }
    }

    /// What stands between spaces.
    pub(crate) fn words(self) -> impl Iterator<Item = Self> {
        let Self { text, at } = self;
        text.split_whitespace().map(move |word| Self {
            text: word,
            // Both are parts of one text.
            at: at + (word.as_ptr() as usize - text.as_ptr() as usize),
        })
    }

    /// What stands behind its first `bytes`.
    pub(crate) fn behind(self, bytes: usize) -> Self {
        Self { text: &self.text[bytes..], at: self.at + bytes }
    }

    /// Its first `bytes`.
    pub(crate) fn first(self, bytes: usize) -> Self {
        Self { text: &self.text[..bytes], at: self.at }
    }

    /// A number, `12`, `+0.5`, `.5` or `-3.`.
    pub(crate) fn number(self) -> Option<f64> {
        let plain = self.text.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
        self.text.parse::<f64>().ok().filter(|value| plain && value.is_finite())
    }

    /// What is wrong here, what is found, what to do.
    pub(crate) fn refuse(
        self,
        (name, text): (&str, &str),
        code: Code,
        message: impl Into<String>,
        label: impl Into<String>,
        help: impl Into<String>,
    ) -> Box<Refusal> {
        let span = self.at as u64..(self.at + self.text.len().max(1)) as u64;
        Refusal::of(name, text, Diagnostic::error(code, message).at(span, label).help(help))
    }
}

/// About no line of the file.
pub(crate) fn refuse_whole(
    (name, text): (&str, &str),
    code: Code,
    message: impl Into<String>,
    help: impl Into<String>,
) -> Box<Refusal> {
    Refusal::of(name, text, Diagnostic::error(code, message).help(help))
}
