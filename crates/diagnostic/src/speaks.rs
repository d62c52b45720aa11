//! Errors of rooms that know nothing of diagnostics.

use std::fmt;

use crate::Text;

/// An error whose `Display` is English, and which can say the same in Russian.
///
/// ```
/// use diagnostic::{Language, Speaks};
///
/// #[derive(Debug)]
/// struct TooShort(usize);
///
/// impl std::fmt::Display for TooShort {
///     fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
///         write!(f, "{} rows are too few", self.0)
///     }
/// }
///
/// impl Speaks for TooShort {
///     fn russian(&self) -> String {
///         format!("строк мало: {}", self.0)
///     }
/// }
///
/// assert_eq!(TooShort(1).text().in_language(Language::Russian), "строк мало: 1");
/// ```
pub trait Speaks: fmt::Display {
    /// What `Display` says, in Russian.
    fn russian(&self) -> String;

    /// In every language.
    fn text(&self) -> Text {
        Text::new(self.to_string(), self.russian())
    }
}
