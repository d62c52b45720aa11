//! A value of an option, and the text that it was read from.

use std::error::Error;
use std::fmt;
use std::ops::Deref;
use std::str::FromStr;

use diagnostic::{Text, both};
use serde::{Deserialize, Serialize};

/// What an option may be given.
pub trait Value: Sized {
    /// What it is, with its unit: "millimetres".
    const WHAT: Text;
    /// How it is written.
    const EXAMPLES: &'static [&'static str];

    /// Reads it.
    ///
    /// # Errors
    /// What is wrong, where more can be said than that it is not written so.
    fn read(text: &str) -> Result<Self, Option<Text>>;
}

/// A value, and the text that it was read from: messages, pages and manifests say what was typed.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
#[serde(bound(deserialize = "T: Value", serialize = "T: Clone"))]
pub struct Given<T> {
    pub(crate) text: String,
    pub(crate) value: T,
}

impl<T> Given<T> {
    /// As it was typed.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }
}

impl<T> Deref for Given<T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> PartialEq for Given<T> {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

impl<T> fmt::Display for Given<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl<T: Value> FromStr for Given<T> {
    type Err = Unread;

    fn from_str(text: &str) -> Result<Self, Unread> {
        match T::read(text) {
            Ok(value) => Ok(Self { text: text.to_owned(), value }),
            Err(why) => Err(Unread { why, what: T::WHAT, examples: T::EXAMPLES }),
        }
    }
}

impl<T: Value> TryFrom<String> for Given<T> {
    type Error = Unread;

    fn try_from(text: String) -> Result<Self, Unread> {
        text.parse()
    }
}

impl<T> From<Given<T>> for String {
    fn from(given: Given<T>) -> Self {
        given.text
    }
}

/// Why a value cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Unread {
    pub(crate) why: Option<Text>,
    pub(crate) what: Text,
    pub(crate) examples: &'static [&'static str],
}

impl Unread {
    /// Of a bare number.
    #[must_use]
    pub fn number(why: Text) -> Self {
        Self { why: Some(why), what: Text::pair("a number", "число"), examples: &["20"] }
    }

    /// What to say of an option that was given this.
    #[must_use]
    pub fn message(&self, option: &str, given: &str) -> Text {
        match &self.why {
            Some(why) => both!("`{option} {given}`: {why}", "`{option} {given}`: {why:#}"),
            None => both!("`{option} {given}` cannot be read", "`{option} {given}`: значение непонятно"),
        }
    }

    /// What to type.
    #[must_use]
    pub fn help(&self, option: &str) -> Text {
        let examples: Vec<String> =
            self.examples.iter().map(|example| format!("`{option} {example}`")).collect();
        let (english, russian) = (examples.join(" or "), examples.join(" или "));
        Text::new(
            format!("write {} as in {english}", self.what),
            format!("напишите {:#} так: {russian}", self.what),
        )
    }
}

impl fmt::Display for Unread {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.why {
            Some(why) => why.fmt(f),
            None => write!(f, "cannot be read: write {} as in {}", self.what, self.examples.join(" or ")),
        }
    }
}

impl Error for Unread {}
