//! What is wrong with a profile, in which of its files, at which bytes.

use std::ops::Range;

use diagnostic::{Code, Diagnostic};

/// The profile is not TOML.
pub(crate) const SYNTAX: Code = Code(301);
/// A key that does not exist, or one that is missing.
pub(crate) const KEY: Code = Code(302);
/// A value of another kind or out of its bounds.
pub(crate) const VALUE: Code = Code(303);
/// The chain.
pub(crate) const CHAIN: Code = Code(304);
/// A table file that cannot be read.
pub(crate) const FILE: Code = Code(305);
/// A column that is unknown, missing or given in an unknown unit.
pub(crate) const COLUMN: Code = Code(306);
/// A cell of a table that is not a finite number.
pub(crate) const CELL: Code = Code(307);
/// Rows that are too few or out of order.
pub(crate) const ROWS: Code = Code(308);
/// Settings that contradict each other.
pub(crate) const CONFLICT: Code = Code(309);
/// A format number this version does not read.
pub(crate) const FORMAT: Code = Code(310);
/// An effect that does not exist or lacks parameters.
pub(crate) const EFFECT: Code = Code(311);
/// Error vectors that make no field.
pub(crate) const FIELD: Code = Code(312);
/// Error vectors that leave something in doubt.
pub(crate) const DOUBTFUL_FIELD: Code = Code(313);
/// What a tilt means is not said.
pub(crate) const TILT: Code = Code(314);
/// Errors of a size that no machine has.
pub(crate) const ODD_SIZES: Code = Code(315);
/// Nothing to correct by.
pub(crate) const NO_ERRORS: Code = Code(316);

/// One thing wrong with a profile or with a table it names.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileError {
    /// The table file, as the profile names it; `None` for the profile itself. The diagnostic's span
    /// counts bytes of that file.
    pub file: Option<String>,
    /// The message.
    pub diagnostic: Diagnostic,
}

impl ProfileError {
    pub(crate) fn profile(diagnostic: Diagnostic) -> Self {
        Self { file: None, diagnostic }
    }
    /// Boxed: it travels through results that are nearly always fine.
    pub(crate) fn table(file: &str, diagnostic: Diagnostic) -> Box<Self> {
        Box::new(Self { file: Some(file.to_owned()), diagnostic })
    }
}

impl std::fmt::Display for ProfileError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match &self.file {
            Some(file) => write!(f, "{file}: {}", self.diagnostic),
            None => write!(f, "{}", self.diagnostic),
        }
    }
}

impl std::error::Error for ProfileError {}

/// Bytes of a file as diagnostics count them.
pub(crate) fn span(range: &Range<usize>) -> Range<u64> {
    range.start as u64..range.end as u64
}
