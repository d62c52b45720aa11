//! How near the control keeps to the programmed path: exact stop, blending, and what says it.

use nc_dialect::{Dialect, Keeps, PathCode, PathKey};

use crate::brackets::arguments;
use crate::modal::{PathControl, Units};
use crate::words::Words;

/// As the control starts.
pub(crate) fn at_start(dialect: &Dialect) -> PathControl {
    let starts = |row: &&PathCode| matches!(&row.key, PathKey::Code(code) if dialect.initial.contains(code));
    let exact = dialect.path_control.iter().filter(starts).any(|row| row.keeps == Keeps::Exact);
    PathControl { off_mm: if exact { 0.0 } else { f64::INFINITY }, line: None }
}

/// What a block says of it.
pub(crate) fn said(dialect: &Dialect, words: &Words<'_, '_, '_>, units: Units) -> Option<PathControl> {
    let mut said = None;
    for PathCode { key, keeps } in &dialect.path_control {
        let call = match key {
            PathKey::Code(code) => words.codes.iter().any(|said| said.entry.code == *code).then(String::new),
            PathKey::Command(name) => {
                let mut calls = words.commands.iter().map(|(_, span)| words.text(*span));
                calls.find(|call| {
                    call.split('(').next().is_some_and(|of| of.trim().eq_ignore_ascii_case(name))
                })
            }
        };
        let Some(call) = call else { continue };
        let length = match keeps {
            Keeps::Exact => Some(0.0),
            Keeps::Unstated => None,
            Keeps::Words(letters) => {
                let mut lengths =
                    letters.iter().map(|letter| words.coordinate(*letter, units == Units::Inch));
                let first = lengths.next().flatten();
                first.map(|first| first + lengths.map(|length| length.unwrap_or(first)).sum::<f64>())
            }
            Keeps::Argument => arguments(&call).first().and_then(|first| first.trim().parse::<f64>().ok()),
        };
        // A tolerance of nothing is none (LinuxCNC, G64 P0).
        let length = length.filter(|length| *length > 0.0 || *keeps == Keeps::Exact);
        let off_mm = length.map_or(f64::INFINITY, |length| length * units.mm());
        said = Some(PathControl { off_mm, line: Some(words.block.line) });
    }
    said
}
