//! Text that a terminal may be shown: nothing in it moves the cursor, clears the screen or turns the direction of reading.

use std::borrow::Cow;

/// True for what a terminal would obey: the control characters of both sets but line end and tab, and the marks that
/// turn the direction of reading (Unicode, UAX 9).
#[must_use]
pub fn is_obeyed(c: char) -> bool {
    const DIRECTION: [char; 12] = [
        '\u{061c}', '\u{200e}', '\u{200f}', '\u{202a}', '\u{202b}', '\u{202c}', '\u{202d}', '\u{202e}',
        '\u{2066}', '\u{2067}', '\u{2068}', '\u{2069}',
    ];
    (c.is_control() && !matches!(c, '\n' | '\r' | '\t')) || DIRECTION.contains(&c)
}

/// The text with each such character as JSON writes it, `\u001b`: visible to people, and in a string of JSON the same.
#[must_use]
pub fn shown(text: &str) -> Cow<'_, str> {
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
}
