//! Why measurements give no profile.

use diagnostic::{Speaks, Text};
use thiserror::Error;

/// Letters of the linear axes.
pub(crate) const LETTERS: [char; 3] = ['X', 'Y', 'Z'];

/// Measurements that cannot be used, and why.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CalibrationError {
    /// A file of another axis, or two axes in one traverse.
    #[error("{0}")]
    Axes(Text),
    /// Numbers that are in another unit than they claim.
    #[error("{0}")]
    Units(Text),
    /// Runs or targets that are missing or do not belong together.
    #[error("{0}")]
    Runs(Text),
    /// Fewer data than unknowns.
    #[error("{0}")]
    TooFew(Text),
    /// One reading that does not belong to the others.
    #[error("{message}")]
    Outlier {
        /// Index of the point.
        point: usize,
        /// Which component, where, and how far off.
        message: Text,
    },
    /// The data contradict one another, or every machine of this kind.
    #[error("{0}")]
    Contradicted(Text),
    /// The data leave some unknowns, or combinations of them, open.
    #[error("the measurements cannot tell {0}")]
    Unobservable(Text),
}

impl CalibrationError {
    /// The same, its point counted among those of which these were kept.
    pub(crate) fn with_points(self, kept: &[usize]) -> Self {
        match self {
            Self::Outlier { point, message } => {
                Self::Outlier { point: kept.get(point).copied().unwrap_or(point), message }
            }
            other => other,
        }
    }
}

impl Speaks for CalibrationError {
    fn russian(&self) -> String {
        match self {
            Self::Axes(text)
            | Self::Units(text)
            | Self::Runs(text)
            | Self::TooFew(text)
            | Self::Contradicted(text)
            | Self::Outlier { message: text, .. } => format!("{text:#}"),
            Self::Unobservable(what) => format!("измерения не различают: {what:#}"),
        }
    }
}
