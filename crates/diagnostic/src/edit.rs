//! The way out of a refusal, where it is an edit of the program.

use std::ops::Range;

/// Bytes of the text that diagnostics speak of, and what to write in their place.
///
/// ```
/// use diagnostic::Edit;
///
/// let bracket = Edit::insert(8, ")");
/// assert_eq!(bracket.applied(b"(ROUGHIN\nG0\n"), b"(ROUGHIN)\nG0\n");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Edit {
    /// What is taken out, from the start of the text.
    pub span: Range<u64>,
    /// What comes there.
    pub text: String,
}

impl Edit {
    /// Something in the place of bytes.
    #[must_use]
    pub fn replace(span: Range<u64>, text: impl Into<String>) -> Self {
        Self { span, text: text.into() }
    }

    /// Something in front of a byte.
    #[must_use]
    pub fn insert(at: u64, text: impl Into<String>) -> Self {
        Self::replace(at..at, text)
    }

    /// The text with it; bytes beyond its end are none.
    #[must_use]
    pub fn applied(&self, text: &[u8]) -> Vec<u8> {
        let [start, end] = [self.span.start, self.span.end].map(|at| (at as usize).min(text.len()));
        [&text[..start], self.text.as_bytes(), &text[end.max(start)..]].concat()
    }
}
