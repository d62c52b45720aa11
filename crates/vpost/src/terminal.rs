//! Text on its way to a terminal: nothing in it moves the cursor, clears the screen or turns the direction of reading.
//!
//! Names of files and machines, run ids and program text come from others. On a terminal their control characters would
//! be obeyed, and marks of direction would show a line other than the one that a control reads.

use std::borrow::Cow;
use std::io;

use diagnostic::{Code, Diagnostic};

use crate::message::{Failure, Report};

/// A program would give orders to the terminal.
const OBEYED: Code = Code(5);

/// True for what a terminal would obey: the control characters of both sets but line end and tab, and the marks that
/// turn the direction of reading (Unicode, UAX 9).
pub(crate) fn is_obeyed(c: char) -> bool {
    const DIRECTION: [char; 12] = [
        '\u{061c}', '\u{200e}', '\u{200f}', '\u{202a}', '\u{202b}', '\u{202c}', '\u{202d}', '\u{202e}',
        '\u{2066}', '\u{2067}', '\u{2068}', '\u{2069}',
    ];
    (c.is_control() && !matches!(c, '\n' | '\r' | '\t')) || DIRECTION.contains(&c)
}

/// The text with each such character as JSON writes it, `\u001b`: visible to people, and in a string of JSON the same.
pub(crate) fn shown(text: &str) -> Cow<'_, str> {
    if !text.contains(is_obeyed) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_obeyed(c) {
            out.push_str(&format!("\\u{:04x}", u32::from(c)));
        } else {
            out.push(c);
        }
    }
    Cow::Owned(out)
}

/// Refuses to show a program in which a terminal would obey something: its bytes are its user's and are not altered, and
/// what is read off a terminal may become a file.
pub(crate) fn obeys_nothing_of(program: &mut impl io::Read) -> Result<(), Failure> {
    let mut text = Vec::new();
    program.read_to_end(&mut text).map_err(|error| Failure::file("the output", "read", &error))?;
    let mut line = 1;
    for chunk in text.utf8_chunks() {
        for c in chunk.valid().chars() {
            if is_obeyed(c) {
                let message = format!(
                    "line {line} of the corrected program has U+{:04X}, which a terminal obeys",
                    u32::from(c)
                );
                let diagnostic = Diagnostic::error(OBEYED, message).help("write to a file: `-o OUT.nc`");
                return Err(Failure::File(Report { source: None, diagnostics: vec![diagnostic] }));
            }
            line += usize::from(c == '\n');
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_obeys_is_shown_and_all_else_stays() {
        assert!(matches!(shown("деталь №1\tX1\n"), Cow::Borrowed(_)));
        assert_eq!(shown("a\u{1b}[2Jb\u{202e}c\u{9b}d"), "a\\u001b[2Jb\\u202ec\\u009bd");
        let json: String = serde_json::from_str(&shown("\"\u{202e}\u{9b}\"")).unwrap();
        assert_eq!(json, "\u{202e}\u{9b}");
    }

    #[test]
    fn a_program_that_gives_orders_is_not_shown() {
        assert!(obeys_nothing_of(&mut &b"(\xcf\xf0)\r\nG0\tX1\n"[..]).is_ok());
        assert!(obeys_nothing_of(&mut &b"G0\n(\x1b]0;x\x07)\n"[..]).is_err());
    }
}
