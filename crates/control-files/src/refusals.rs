//! Why a file is not read.

use std::ops::Range;

use diagnostic::{Code, Diagnostic, Text};
use measurement_files::{Piece, Refusal};

/// A file of the control that cannot be read.
pub(crate) const UNREADABLE: Code = Code(920);
/// A file of the control that holds what cannot be followed.
pub(crate) const BEYOND: Code = Code(921);

/// A file's name in messages, and its text.
pub(crate) type File<'f> = (&'f str, &'f str);

/// What is wrong at a place, what is found there, what to do.
pub(crate) fn refuse(
    file: File<'_>,
    at: Piece<'_>,
    code: Code,
    message: Text,
    label: Text,
    help: Text,
) -> Box<Refusal> {
    refuse_at(file, at.span(), code, message, label, help)
}

/// The same where the place is known by its bytes.
pub(crate) fn refuse_at(
    (name, text): File<'_>,
    at: Range<usize>,
    code: Code,
    message: Text,
    label: Text,
    help: Text,
) -> Box<Refusal> {
    let start = at.start as u64;
    let end = at.end.max(at.start + 1) as u64;
    Refusal::of(name, text, Diagnostic::error(code, message).at(start..end, label).help(help))
}

/// About no line of the file.
pub(crate) fn refuse_whole((name, text): File<'_>, code: Code, message: Text, help: Text) -> Box<Refusal> {
    Refusal::of(name, text, Diagnostic::error(code, message).help(help))
}
