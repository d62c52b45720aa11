//! What the tests of this crate share.

use std::io;

use nc_dialect::Dialect;
use nc_expand::{Environment, Expanded, Limits, Preset, Refusal, expand};
use nc_program::Setup;

/// No file is there.
pub(crate) fn nothing(_: &str) -> io::Result<Vec<u8>> {
    Err(io::Error::from(io::ErrorKind::NotFound))
}

/// Work offsets at zero, and tools without length.
pub(crate) fn setup(dialect: &Dialect) -> Setup {
    let named = (54..60).map(|code| format!("G{code}")).chain(["G500".to_owned()]);
    let numbered = (1..100).flat_map(|number| [format!("G15H{number}"), format!("G54.1P{number}")]);
    Setup {
        work_offsets: named.chain(numbered).map(|name| (name, [0.0; 3])).collect(),
        tools: (1..100).map(|number| (number, [0.0; 3])).collect(),
        noses_mm: (1..100).map(|number| (number, 0.4)).collect(),
        diameters: dialect.turning.as_ref().and_then(|turning| turning.diameters),
        ..Setup::default()
    }
}

/// Expands a program of a dialect with presets and files.
pub(crate) fn expanded<'a>(
    dialect: &str,
    text: &'a str,
    set: &[&str],
    files: &[(&str, &str)],
) -> Result<Expanded<'a>, Refusal> {
    let variables: Vec<Preset> = set.iter().map(|text| Preset::parse(text).expect("a preset")).collect();
    let read = |name: &str| match files.iter().find(|(known, _)| *known == name) {
        Some((_, text)) => Ok(text.as_bytes().to_vec()),
        None => nothing(name),
    };
    let dialect = nc_dialect::builtin(dialect).expect("a dialect");
    let environment = Environment {
        variables: &variables,
        read_external: &read,
        setup: &setup(dialect),
        limits: Limits::default(),
    };
    expand(text.as_bytes(), dialect, &environment)
}

/// The plain program's text.
pub(crate) fn flat(dialect: &str, text: &str, set: &[&str], files: &[(&str, &str)]) -> String {
    match expanded(dialect, text, set, files) {
        Ok(expanded) => String::from_utf8(expanded.text().to_vec()).expect("text"),
        Err(refusal) => panic!("{text}\n{refusal:#?}"),
    }
}

/// Only the lines that are no comment.
pub(crate) fn blocks(flat: &str) -> Vec<&str> {
    flat.lines().filter(|line| !line.starts_with('(')).collect()
}

pub(crate) fn fanuc(text: &str) -> String {
    flat("fanuc", text, &[], &[])
}

pub(crate) fn linuxcnc(text: &str) -> String {
    flat("linuxcnc", text, &[], &[])
}

/// The message of a refused program: code, text, what it stands at, help.
pub(crate) fn refused(dialect: &str, text: &str) -> String {
    match expanded(dialect, text, &[], &[]) {
        Ok(expanded) => format!("not refused: {}", String::from_utf8_lossy(expanded.text())),
        Err(refusal) => {
            let diagnostic = &refusal.diagnostics[0];
            let span = diagnostic.span.clone().expect("every message has a place");
            let found = &text[span.start as usize..span.end as usize];
            let help =
                diagnostic.help.as_ref().map(|help| help.english()).expect("every message has a way out");
            format!("{diagnostic}\nat `{found}`: {}\nhelp: {help}", diagnostic.label)
        }
    }
}
