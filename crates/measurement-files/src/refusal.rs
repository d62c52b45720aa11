//! Why a file is not read.

use std::ops::Range;

use diagnostic::{Code, Diagnostic, Text};

use crate::codes;

/// A file that is not read: the message, and the text its place counts bytes of.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Name and text of the file; `None` where the message is about no place in it.
    pub source: Option<(String, String)>,
    /// What is wrong.
    pub diagnostic: Diagnostic,
}

impl Refusal {
    /// About no place of a file.
    #[must_use]
    pub fn without_text(diagnostic: Diagnostic) -> Box<Self> {
        Box::new(Self { source: None, diagnostic })
    }

    /// About a place of a file.
    #[must_use]
    pub fn of(name: &str, text: &str, diagnostic: Diagnostic) -> Box<Self> {
        Box::new(Self { source: Some((name.to_owned(), text.to_owned())), diagnostic })
    }
}

/// An error at bytes of the text: what is wrong, what stands there, what to write.
pub(crate) fn error(code: Code, message: Text, span: &Range<usize>, label: Text, help: Text) -> Diagnostic {
    Diagnostic::error(code, message).at(span.start as u64..span.end as u64, label).help(help)
}

/// The numbers that messages about one kind of file have.
#[derive(Clone, Copy, Debug)]
pub struct Codes {
    /// No text, no rows.
    pub unreadable: Code,
    /// A column is missing, unknown, twice, or contradicts another.
    pub column: Code,
    /// A cell is not what its column says.
    pub cell: Code,
    /// A number cannot be in its unit.
    pub unit: Code,
}

impl Codes {
    /// Of measurements.
    pub const MEASUREMENTS: Self =
        Self { unreadable: codes::UNREADABLE, column: codes::COLUMN, cell: codes::CELL, unit: codes::UNIT };

    /// One number for everything.
    #[must_use]
    pub const fn all(code: Code) -> Self {
        Self { unreadable: code, column: code, cell: code, unit: code }
    }
}
