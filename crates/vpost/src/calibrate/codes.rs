//! Numbers of the messages of `calibrate`.

use calibration::CalibrationError;
use diagnostic::{Code, Diagnostic, Text};

use crate::message::Failure;

pub(super) use measurement_files::codes::{AXES, CELL, OPEN, QUESTION, RUNS};

/// Numbers in another unit than they claim.
pub(super) const UNITS: Code = Code(1102);
/// Measurements that cannot carry a correction.
pub(super) const UNFIT: Code = Code(1103);
/// A reading that does not belong to the others.
pub(super) const OUTLIER: Code = Code(1107);
/// Warning: runs or targets are missing.
pub(super) const MISSING: Code = Code(1108);
/// Warning: the uncertainty is more than half of what it corrects.
pub(super) const DOUBTFUL: Code = Code(1109);
/// Warning: something the profile should say is not known.
pub(super) const UNSAID: Code = Code(1110);
/// Readings that contradict one another, the base, or every machine of this kind.
pub(super) const CONTRADICTED: Code = Code(1113);

/// What to say of measurements that give no profile, and what to do.
pub(super) fn failure(file: &str, bytes: &[u8], error: &CalibrationError) -> Failure {
    let (code, help) = match error {
        CalibrationError::Axes(_) => (
            AXES,
            "compare axes, signs and order of the columns with what the message says; frames are right-handed",
        ),
        CalibrationError::Units(_) => {
            (UNITS, "the column's name says its unit: convert the numbers or rename the column")
        }
        CalibrationError::Runs(_) => (RUNS, "every run must pass every target; leave an incomplete run out"),
        CalibrationError::TooFew(_) => (OPEN, "measure more points"),
        CalibrationError::Outlier { .. } => (OUTLIER, "measure it again, or take the row out"),
        CalibrationError::Contradicted(_) => {
            (CONTRADICTED, "measure again what the message names, or leave it out")
        }
        CalibrationError::Unobservable(_) => {
            (OPEN, "measure where they differ: another tool length, other positions of the other axes")
        }
    };
    let diagnostic = Diagnostic::error(code, error.to_string()).help(help);
    if file.is_empty() {
        return Failure::Refused(vec![crate::message::Report {
            source: None,
            diagnostics: vec![diagnostic],
        }]);
    }
    Failure::refused(file, bytes, vec![diagnostic])
}

/// A question that stays open.
pub(super) fn question(message: impl Into<Text>, help: impl Into<Text>) -> Failure {
    Failure::usage(Diagnostic::error(QUESTION, message).help(help))
}
