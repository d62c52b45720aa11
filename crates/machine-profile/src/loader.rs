//! What a profile is read with: its faults, its files, its numbers.

use std::fmt::Display;
use std::ops::Bound::{self, Excluded, Included, Unbounded};
use std::ops::RangeBounds as _;

use diagnostic::{Code, Diagnostic, Text, both, of_system};
use machine_model::{Axis, Range, Vector};

use crate::error::{FILE, ProfileError, VALUE, span};
use crate::number::{Finite, Spanned};
use crate::tables::{ErrorRows, error_rows};

/// Gives the bytes of a file by the path the profile uses.
pub type Read<'r> = &'r dyn Fn(&str) -> std::io::Result<Vec<u8>>;

pub(crate) struct Loader<'r> {
    pub(crate) read: Read<'r>,
    pub(crate) errors: Vec<ProfileError>,
}

pub(crate) fn triple(values: Option<[Finite; 3]>) -> [f64; 3] {
    values.map_or([0.0; 3], |v| v.map(|Finite(v)| v))
}

pub(crate) fn vector(values: Option<[Finite; 3]>) -> Vector {
    triple(values).into()
}

/// Between what a number of the profile must lie.
pub(crate) struct Bounds {
    pub(crate) range: (Bound<f64>, Bound<f64>),
    /// What was expected.
    pub(crate) label: Text,
    pub(crate) help: Text,
}

pub(crate) static ZERO_OR_MORE: Bounds = Bounds {
    range: (Included(0.0), Unbounded),
    label: Text::pair("expected 0 or more", "ожидалось 0 или больше"),
    help: Text::EMPTY,
};

pub(crate) static ABOVE_ZERO: Bounds = Bounds {
    range: (Excluded(0.0), Unbounded),
    label: Text::pair("expected a number above 0", "ожидалось число больше 0"),
    help: Text::EMPTY,
};

impl Loader<'_> {
    /// Refuses what stands at a place: what is wrong, what was expected there, what to type.
    pub(crate) fn refuse<T>(&mut self, at: &Spanned<T>, code: Code, message: Text, label: Text, help: Text) {
        self.refuse_at(&at.span(), code, message, label, help);
    }

    /// The same by the bytes of the place.
    pub(crate) fn refuse_at(
        &mut self,
        at: &std::ops::Range<usize>,
        code: Code,
        message: Text,
        label: Text,
        help: Text,
    ) {
        let mut diagnostic = Diagnostic::error(code, message).at(span(at), label);
        diagnostic.help = Some(help).filter(|help| !help.is_empty());
        self.errors.push(ProfileError::profile(diagnostic));
    }

    /// A number within its bounds; one beyond is refused.
    pub(crate) fn number(
        &mut self,
        written: Option<&Spanned<Finite>>,
        name: impl Display,
        bounds: &Bounds,
    ) -> Option<f64> {
        let written = written?;
        let Finite(value) = *written.get_ref();
        if bounds.range.contains(&value) {
            return Some(value);
        }
        let message = both!("{name} is {value}", "{name:#} — {value}");
        self.refuse(written, VALUE, message, bounds.label.clone(), bounds.help.clone());
        None
    }

    /// The bytes of a table; an error where it cannot be read.
    pub(crate) fn file(&mut self, name: &Spanned<String>) -> Option<Vec<u8>> {
        match (self.read)(name.get_ref()) {
            Ok(bytes) => Some(bytes),
            Err(e) => {
                let message = both!(
                    "cannot read the table {}: {}",
                    "таблица {} не читается: {:#}",
                    name.get_ref(),
                    of_system(&e)
                );
                let help = both!(
                    "paths are relative to the profile's own folder",
                    "пути считаются от папки профиля"
                );
                self.refuse(name, FILE, message, both!("named here", "названа здесь"), help);
                None
            }
        }
    }

    /// The result, or its error put on the list.
    pub(crate) fn keep<T>(&mut self, result: Result<T, Box<ProfileError>>) -> Option<T> {
        result.map_err(|e| self.errors.push(*e)).ok()
    }

    pub(crate) fn table(&mut self, name: Option<&Spanned<String>>, axis: Axis) -> Option<ErrorRows> {
        let name = name?;
        let bytes = self.file(name)?;
        self.keep(error_rows(name.get_ref(), &bytes, axis))
    }

    /// Lower and upper end, in order.
    pub(crate) fn range(&mut self, written: &Spanned<[Finite; 2]>, what: &Text) -> Option<Range> {
        let [Finite(low), Finite(high)] = *written.get_ref();
        if low < high {
            return Some(Range { low, high });
        }
        let message = both!("{what} runs from {low} to {high}", "{what:#}: от {low} до {high}");
        let label =
            both!("the lower end must lie below the upper", "нижний конец должен быть меньше верхнего");
        let help = both!(
            "write the lower end first: [{high}, {low}]",
            "напишите сначала нижний конец: [{high}, {low}]"
        );
        self.refuse(written, VALUE, message, label, help);
        None
    }
}
