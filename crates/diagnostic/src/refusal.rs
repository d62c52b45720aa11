//! Why something is refused, apart from where.

use std::ops::Range;

use crate::{Code, Diagnostic, Text};

/// One reason of a refusal; a room's reasons stand in its `refusals`, by theme.
///
/// ```
/// use diagnostic::{Code, Refusal, Text};
///
/// const WITHOUT_P: Refusal = Refusal {
///     code: Code(225),
///     message: Text::pair("G10 without P", "G10 без P"),
///     label: Text::pair("which work offset?", "какое смещение нуля?"),
///     help: Text::pair("write P1 for G54", "напишите P1 для G54"),
/// };
/// assert_eq!(WITHOUT_P.at(0..3).to_string(), "error[VP0225]: G10 without P");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// The number to look up.
    pub code: Code,
    /// What is wrong, in one line, with numbers.
    pub message: Text,
    /// What stands under the caret: what was found there, what was expected.
    pub label: Text,
    /// What to type.
    pub help: Text,
}

impl Refusal {
    /// The error at its place: bytes of the source text.
    #[must_use]
    pub fn at(self, span: Range<u64>) -> Diagnostic {
        Diagnostic::error(self.code, self.message).at(span, self.label).help(self.help)
    }
}
