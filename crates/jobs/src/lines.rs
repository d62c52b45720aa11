//! Programs as lines: read with a bound on their length, by the name that messages know them by.

use std::io::Read;
use std::path::Path;

use diagnostic::{Code, refusal};

use crate::message::{Deed, Failure};
use crate::shown::shown;

/// A block is longer than any that is read.
const TOO_LONG: Code = Code(106);

/// The name of a path in messages.
#[must_use]
pub fn name(path: &Path) -> String {
    if path.as_os_str() == "-" {
        return "standard input".to_owned();
    }
    // In a message a name is one line.
    shown(&path.to_string_lossy()).replace(['\n', '\r'], "?")
}

/// No block is longer, padding apart: what has no line end for so long is no part program.
pub const LONGEST_LINE: usize = 1 << 20;

/// Reads the lines of a program by the name it has in messages.
///
/// # Errors
/// It cannot be read, or a line is too long.
pub fn read_lines(mut source: impl Read, name: &str) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    loop {
        let start = bytes.len();
        let read = source
            .by_ref()
            .take(LONGEST_LINE as u64)
            .read_to_end(&mut bytes)
            .map_err(|error| Failure::file(name, Deed::Read, &error))?;
        if read < LONGEST_LINE {
            return Ok(bytes);
        }
        check_line(&bytes, start, name)?;
    }
}

/// Refuses a text that holds a megabyte without line end, whatever follows.
///
/// # Errors
/// That line.
pub fn check_lines(text: &[u8], name: &str) -> Result<(), Failure> {
    let mut start = 0;
    while start + LONGEST_LINE <= text.len() {
        check_line(&text[..start + LONGEST_LINE], start, name)?;
        start += LONGEST_LINE;
    }
    Ok(())
}

/// True where a part of a text holds a line end, or nothing but padding.
#[must_use]
pub fn ends_lines(part: &[u8]) -> bool {
    memchr::memchr2(b'\n', b'\r', part).is_some() || part.iter().all(|byte| matches!(byte, 0 | b' ' | 0x7F))
}

fn check_line(bytes: &[u8], start: usize, name: &str) -> Result<(), Failure> {
    if ends_lines(&bytes[start..]) {
        return Ok(());
    }
    // A binary file is told as what it is.
    if let Err(diagnostic) = nc_syntax::looks_like_program(bytes) {
        return Err(Failure::refused(name, bytes, vec![diagnostic]));
    }
    let span = start as u64..start as u64 + 120;
    let diagnostic = refusal!(TOO_LONG;
        "a block of more than {LONGEST_LINE} bytes", "кадр длиннее {LONGEST_LINE} байт";
        "no line end within a megabyte", "на протяжении мегабайта нет конца строки";
        "check that this is a part program and that its line ends arrived with it",
        "проверьте, что это управляющая программа и что при передаче не пропали концы строк"
    )
    .at(span);
    Err(Failure::refused(name, bytes, vec![diagnostic]))
}
