//! Messages about bytes that are not words.

use diagnostic::{Code, Diagnostic};

use crate::{Block, Invalid, MAX_BLOCK_BYTES, Span};

impl Block<'_> {
    /// The message for the first item that could not be read, if any (VP0101–VP0106).
    #[must_use]
    pub fn unreadable(&self) -> Option<Diagnostic> {
        self.first_invalid().map(|(why, span)| self.unreadable_at(why, span))
    }

    /// The message for one item that could not be read.
    #[must_use]
    pub fn unreadable_at(&self, why: Invalid, span: Span) -> Diagnostic {
        let length = self.bytes.len();
        let shown = printable(&self.bytes[span.start as usize..(span.end as usize).min(length)]);
        let (code, message, label, help) = match why {
            Invalid::Number => (
                101,
                format!("`{shown}` is not a number a control reads"),
                "expected a sign, digits and one decimal point",
                "write it like `X-12.5`: no exponent, one sign, a point and not a comma".to_owned(),
            ),
            Invalid::TooManyDigits => (
                102,
                format!("`{shown}` has more than 15 digits"),
                "not exact in any control",
                "round it to the decimals of the machine's input step, 3 or 4".to_owned(),
            ),
            Invalid::UnclosedComment => (
                103,
                "the comment is not closed".to_owned(),
                "this bracket has no partner in its line",
                "close the comment with `)` on the same line".to_owned(),
            ),
            Invalid::UnclosedBracket => (
                104,
                format!("`{shown}` has a bracket without its partner"),
                "brackets must close in the block they open in",
                "add the missing bracket or remove this one".to_owned(),
            ),
            Invalid::Text => match cyrillic_twin(&shown) {
                Some((cyrillic, latin)) => (
                    105,
                    format!("`{shown}` starts with a Cyrillic `{cyrillic}`"),
                    "it looks like a Latin letter, and no control reads it",
                    format!("type the Latin `{latin}`"),
                ),
                None => (
                    105,
                    format!("`{shown}` is not a word, a comment or a command of this dialect"),
                    "expected a letter and a number",
                    "if it is a remark, put it in a comment; if another control reads it, choose that one with `--dialect`"
                        .to_owned(),
                ),
            },
            Invalid::TooLong => (
                106,
                format!("the block is {length} bytes long; the longest that is read is {MAX_BLOCK_BYTES}"),
                "no line end within that length",
                "check that this is a part program and that its line ends arrived with it".to_owned(),
            ),
        };
        // A caret under a gigabyte helps nobody.
        let end = span.end.min(span.start.saturating_add(120));
        Diagnostic::error(Code(code), message)
            .at(self.file_span(Span { start: span.start, end }), label)
            .help(help)
    }
}

/// The Latin letter that the text's first letter looks like, where that is Cyrillic (UTF-8).
fn cyrillic_twin(text: &str) -> Option<(char, char)> {
    const TWINS: [(char, char); 12] = [
        ('А', 'A'),
        ('В', 'B'),
        ('Е', 'E'),
        ('К', 'K'),
        ('М', 'M'),
        ('Н', 'H'),
        ('О', 'O'),
        ('Р', 'P'),
        ('С', 'C'),
        ('Т', 'T'),
        ('У', 'Y'),
        ('Х', 'X'),
    ];
    let first = text.chars().next()?;
    let upper = first.to_uppercase().next()?;
    let (_, latin) = TWINS.into_iter().find(|(cyrillic, _)| *cyrillic == upper)?;
    // Prose starts with such letters too: only a letter with a number is a mistyped word.
    let number =
        text.chars().nth(1).is_some_and(|next| next.is_ascii_digit() || matches!(next, '.' | '+' | '-'));
    number.then_some((first, latin))
}

/// The bytes as a person can read them: short, nothing that moves a terminal's cursor.
fn printable(bytes: &[u8]) -> String {
    const SHOWN: usize = 32;
    let cut = &bytes[..bytes.len().min(SHOWN)];
    let mut text: String =
        String::from_utf8_lossy(cut).chars().map(|c| if c.is_control() { '\u{FFFD}' } else { c }).collect();
    if cut.len() < bytes.len() {
        text.push('…');
    }
    text
}
