//! One text in every language.
//!
//! A text is made where its facts are known, in all languages at once, and one of them is chosen where it is printed.
//! So there are no keys and no files of translations: [`both!`](crate::both) does not compile without the Russian, and each
//! language is checked against the values that it names.

use std::borrow::Cow;
use std::fmt;

use crate::Language;

/// A text for people, in every language.
///
/// Printed it is English, and Russian with `{:#}`: so one text stands inside another. A width holds for both: `{:<#9}`.
///
/// ```
/// use diagnostic::{Language, both};
///
/// let (line, what) = (7, both!("the arc", "дуга"));
/// let text = both!("{what} in line {line}", "{what:#} в строке {line}");
/// assert_eq!(text.in_language(Language::English), "the arc in line 7");
/// assert_eq!(text.in_language(Language::Russian), "дуга в строке 7");
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Text {
    english: Cow<'static, str>,
    russian: Cow<'static, str>,
}

/// A [`Text`] of two format strings, English and Russian, and the arguments of both.
///
/// An argument that is a [`Text`] itself is written `{name:#}` in the Russian one.
#[macro_export]
macro_rules! both {
    ($english:literal, $russian:literal $(,)?) => {
        $crate::Text::new(::std::format!($english), ::std::format!($russian))
    };
    ($english:literal, $russian:literal, $($argument:tt)+) => {
        $crate::Text::new(
            ::std::format!($english, $($argument)+),
            ::std::format!($russian, $($argument)+),
        )
    };
}

/// A [`Text`] as [`notice!`](crate::notice) and [`refusal!`](crate::refusal) take it: one that is made, or what
/// [`both!`](crate::both) makes one of.
#[doc(hidden)]
#[macro_export]
macro_rules! text {
    ($text:expr) => { $text };
    ($english:literal, $russian:literal $(, $value:expr)*) => { $crate::both!($english, $russian, $($value),*) };
}

/// What [`both!`](crate::both) says, in one language: for running text that is made where it is printed.
///
/// ```
/// use diagnostic::{Language, say};
///
/// let rows = 7;
/// assert_eq!(say!(Language::Russian, "{rows} rows", "строк: {rows}"), "строк: 7");
/// ```
#[macro_export]
macro_rules! say {
    ($language:expr, $english:literal, $russian:literal $(, $($argument:tt)*)?) => {
        match $language {
            $crate::Language::English => ::std::format!($english $(, $($argument)*)?),
            $crate::Language::Russian => ::std::format!($russian $(, $($argument)*)?),
        }
    };
}

impl Text {
    /// Nothing, in any language.
    pub const EMPTY: Self = Self::pair("", "");

    /// Of both languages.
    #[must_use]
    pub const fn new(english: String, russian: String) -> Self {
        Self { english: Cow::Owned(english), russian: Cow::Owned(russian) }
    }

    /// Of two constant texts.
    #[must_use]
    pub const fn pair(english: &'static str, russian: &'static str) -> Self {
        Self { english: Cow::Borrowed(english), russian: Cow::Borrowed(russian) }
    }

    /// What reads alike in every language: names, codes, options, what somebody else wrote.
    #[must_use]
    pub fn same(text: impl Into<String>) -> Self {
        let text = text.into();
        Self::new(text.clone(), text)
    }

    /// What is not translated yet.
    #[must_use]
    pub fn english_only(text: impl Into<String>) -> Self {
        Self::same(text)
    }

    /// The text in a language.
    #[must_use]
    pub fn in_language(&self, language: Language) -> &str {
        match language {
            Language::English => &self.english,
            Language::Russian => &self.russian,
        }
    }

    /// The text in English, as JSON and tests have it.
    #[must_use]
    pub fn english(&self) -> &str {
        &self.english
    }

    /// True where nothing is said.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.english.is_empty()
    }

    /// Adds a text behind this one.
    pub fn push(&mut self, text: &Self) {
        self.english.to_mut().push_str(&text.english);
        self.russian.to_mut().push_str(&text.russian);
    }

    /// Texts one behind the other, with a separator that is the same in every language.
    pub fn join<'t>(texts: impl IntoIterator<Item = &'t Self>, separator: &str) -> Self {
        let separator = Self::same(separator);
        let mut all = Self::EMPTY;
        for (index, text) in texts.into_iter().enumerate() {
            if index > 0 {
                all.push(&separator);
            }
            all.push(text);
        }
        all
    }
}

/// What went wrong where nothing but an error can be handed on, as through [`std::io::Error`].
impl std::error::Error for Text {}

impl fmt::Display for Text {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(if f.alternate() { &self.russian } else { &self.english })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_joined_in_each_language() {
        let parts = [both!("one", "раз"), both!("{}", "{}", 2)];
        let all = Text::join(&parts, "; ");
        assert_eq!(Language::ALL.map(|language| all.in_language(language)), ["one; 2", "раз; 2"]);
        assert!(Text::join([], "; ").is_empty());
    }

    #[test]
    fn braces_and_arguments_of_either_kind_stand_in_both() {
        let (name, number) = ("H", 1);
        let text = both!("`{name}{number} = {{ {} }}` here", "здесь `{name}{number} = {{ {} }}`", 0.5);
        let word = Text::pair("play", "люфт");
        assert_eq!(format!("{word:<6}|{word:>#6}|"), "play  |  люфт|");
        assert_eq!(format!("{text} / {text:#}"), "`H1 = { 0.5 }` here / здесь `H1 = { 0.5 }`");
    }
}
