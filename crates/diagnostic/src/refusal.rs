//! Why something is refused, apart from where.

use std::ops::Range;

use crate::{Code, Diagnostic, Text};

/// One reason of a refusal; a room's reasons stand in its `refusals`, by theme.
///
/// [`refusal!`](crate::refusal) makes one.
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

/// A [`Refusal`]: its code; what is wrong; what stands under the caret; what to type.
///
/// Each of the three is a [`Text`], or what [`both!`](crate::both) takes: English, Russian, the values of both. Behind
/// `const` stands what needs no values, for constants: as [`Text::pair`] takes it.
///
/// ```
/// use diagnostic::{Code, Refusal, Text, refusal};
///
/// const P_MISSING: Text = Text::pair("which work offset?", "какое смещение нуля?");
/// const WITHOUT_P: Refusal = refusal!(const Code(225);
///     "G10 without P", "G10 без P";
///     P_MISSING;
///     "write P1 for G54", "напишите P1 для G54"
/// );
/// assert_eq!(WITHOUT_P.at(0..3).to_string(), "error[VP0225]: G10 without P");
///
/// let (code, letters) = ("G10", ["L", "P"]);
/// let without = refusal!(Code(225);
///     "{code} without {}", "{code} без {}", letters[1];
///     P_MISSING;
///     "write P1 for G54", "напишите P1 для G54"
/// );
/// assert_eq!(without, WITHOUT_P);
/// ```
#[macro_export]
macro_rules! refusal {
    (@const $text:expr) => { $text };
    (@const $english:literal, $russian:literal) => { $crate::Text::pair($english, $russian) };
    (const $code:expr; $($message:expr),+; $($label:expr),+; $($help:expr),+) => {
        $crate::Refusal {
            code: $code,
            message: $crate::refusal!(@const $($message),+),
            label: $crate::refusal!(@const $($label),+),
            help: $crate::refusal!(@const $($help),+),
        }
    };
    ($code:expr; $($message:expr),+; $($label:expr),+; $($help:expr),+) => {
        $crate::Refusal {
            code: $code,
            message: $crate::text!($($message),+),
            label: $crate::text!($($label),+),
            help: $crate::text!($($help),+),
        }
    };
}
