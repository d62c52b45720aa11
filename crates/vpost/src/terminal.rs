//! Text on its way to a terminal: nothing in it moves the cursor, clears the screen or turns the direction of reading.
//!
//! Names of files and machines, run ids and program text come from others. On a terminal their control characters would
//! be obeyed, and marks of direction would show a line other than the one that a control reads.

use std::io;

use diagnostic::{Code, Text, notice};

pub(crate) use jobs::shown::{is_obeyed, shown};

use crate::message::{Deed, Failure, Report};

/// A program would give orders to the terminal.
const OBEYED: Code = Code(5);

/// Refuses to show a program in which a terminal would obey something: its bytes are its user's and are not altered, and
/// what is read off a terminal may become a file.
pub(crate) fn obeys_nothing_of(program: &mut impl io::Read) -> Result<(), Failure> {
    let mut text = Vec::new();
    program
        .read_to_end(&mut text)
        .map_err(|error| Failure::place(&Text::pair("the output", "выходной файл"), Deed::Read, &error))?;
    let mut line = 1;
    for chunk in text.utf8_chunks() {
        for c in chunk.valid().chars() {
            if is_obeyed(c) {
                let diagnostic = notice!(OBEYED;
                    "line {line} of the corrected program has U+{:04X}, which a terminal obeys",
                    "в строке {line} исправленной программы стоит U+{:04X}, и терминал его исполнит",
                    u32::from(c);
                    "write to a file: `-o OUT.nc`", "запишите в файл: `-o OUT.nc`"
                );
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
    fn a_program_that_gives_orders_is_not_shown() {
        assert!(obeys_nothing_of(&mut &b"(\xcf\xf0)\r\nG0\tX1\n"[..]).is_ok());
        assert!(obeys_nothing_of(&mut &b"G0\n(\x1b]0;x\x07)\n"[..]).is_err());
    }
}
