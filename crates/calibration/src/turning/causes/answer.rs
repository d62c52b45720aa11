//! What a diagnosis of turned parts says.

use super::columns::Cause;

/// What a diagnosis says of all rows together (`vpost.diagnosis/1`).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing but noise.
    NoGap,
    /// Every cause that was found can be nothing else.
    Named,
    /// A cause may be another.
    Ambiguous,
    /// Something is left beside the causes.
    Partial,
    /// Something is there that is no cause of the list, or unseen rows refute what was found.
    Unknown,
    /// A reading is none.
    NoiseModelSuspect,
    /// Too few rows or parts.
    Underpowered,
}

impl Verdict {
    /// As JSON has it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::NoGap => "NO GAP",
            Self::Named => "NAMED",
            Self::Ambiguous => "AMBIGUOUS",
            Self::Partial => "PARTIAL",
            Self::Unknown => "UNKNOWN",
            Self::NoiseModelSuspect => "NOISE MODEL SUSPECT",
            Self::Underpowered => "UNDERPOWERED",
        }
    }
}

/// A number of a cause.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// With its unit.
    pub name: &'static str,
    /// Found.
    pub value: f64,
    /// Half width of its 95 % interval.
    pub u95: f64,
}

/// A cause that was found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundCause {
    /// Which.
    pub cause: Cause,
    /// Chance that noise looks so, beside all other causes where it is the only one that can be it, else beside those found.
    pub p: f64,
    /// Its numbers.
    pub numbers: Vec<Number>,
    /// What else may be it, each a cause or several together; none: nothing of the list.
    pub rivals: Vec<String>,
    /// Root mean square of the gap before it and after it, mm on the radius; the causes above it are taken off.
    pub rms_mm: [f64; 2],
}

/// Rows that no fit has seen, mm on the radius, each part at its own size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Unseen {
    /// How many.
    pub rows: usize,
    /// Root mean square without the causes, and with them.
    pub rms_mm: [f64; 2],
}

/// The answer.
#[derive(Clone, Debug, PartialEq)]
pub struct LatheDiagnosis {
    /// In a word.
    pub verdict: Verdict,
    /// Root mean square of the gap beyond sizes and clampings, mm on the radius.
    pub rms_mm: f64,
    /// Standard deviation of one radius, mm, where it comes of the rows.
    pub noise_mm: f64,
    /// The surest first.
    pub causes: Vec<FoundCause>,
    /// Causes that the rows could show.
    pub asked: Vec<Cause>,
    /// Chance that what is left beside all causes is noise.
    pub leftover_p: f64,
    /// The row that is none.
    pub outlier: Option<usize>,
    /// Of the hold-out.
    pub unseen: Option<Unseen>,
    /// By row, what the causes do to it, mm on the radius; sizes and clampings are not among them.
    pub explained_mm: Vec<f64>,
}
