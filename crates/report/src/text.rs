//! Texts from files: shown, never acting; numbers as people write them.

use diagnostic::{Language, Text};
use maud::{Markup, PreEscaped};

/// A text as it can be shown: control characters become their pictures, and marks that reorder what stands beside them
/// become their numbers, so that a name looks on the page as it stands in the file.
///
/// Escaping for HTML is not done here: [`maud`] does it for everything that is spliced in.
#[must_use]
pub fn shown(text: &str) -> String {
    text.chars().fold(String::with_capacity(text.len()), |mut out, c| {
        match c {
            '\u{0}'..='\u{1f}' => out.extend(char::from_u32(0x2400 + u32::from(c))),
            '\u{7f}' => out.push('\u{2421}'),
            '\u{80}'..='\u{9f}' => out.push(char::REPLACEMENT_CHARACTER),
            '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}' => {
                out.push_str(&format!("\u{2039}U+{:04X}\u{203a}", u32::from(c)));
            }
            _ => out.push(c),
        }
        out
    })
}

/// [`shown`], cut to a number of characters where there is no room for more.
#[must_use]
pub fn short(text: &str, most: usize) -> String {
    let text = shown(text);
    if text.chars().count() <= most {
        return text;
    }
    text.chars().take(most.saturating_sub(1)).chain(['\u{2026}']).collect()
}

/// JSON for a data block: what could end the block, or begin a comment, is written as JSON's own escape, so that it still
/// reads back as the same values.
#[must_use]
pub fn json_block(json: &str) -> Markup {
    let mut out = String::with_capacity(json.len());
    for c in json.chars() {
        match c {
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            _ => out.push(c),
        }
    }
    PreEscaped(out)
}

/// A string of JSON. (Before it enters a page it is a part of a [`json_block`].)
#[must_use]
pub fn json_string(text: &str) -> String {
    let mut out = String::with_capacity(text.len() + 2);
    out.push('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '\u{0}'..='\u{1f}' => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            _ => out.push(c),
        }
    }
    out.push('"');
    out
}

/// A number with three significant digits, as people write it: no exponent for what a machine measures.
#[must_use]
pub fn number(value: f64) -> String {
    let size = value.abs();
    let text = match size {
        _ if !value.is_finite() => return "\u{2014}".to_owned(),
        _ if size >= 99.95 => format!("{value:.0}"),
        _ if size >= 9.995 => format!("{value:.1}"),
        _ if size >= 0.0005 || value == 0.0 => format!("{value:.2}"),
        _ => format!("{value:.1e}"),
    };
    // Minus zero is zero to people.
    let text = if text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.')) {
        text.replace('-', "")
    } else {
        text
    };
    text.replacen('-', "\u{2212}", 1)
}

/// A share as a percentage without decimals.
#[must_use]
pub fn percent(share: f64) -> String {
    format!("{} %", number_of_digits(100.0 * share, 0))
}

/// A number with fixed decimals and a real minus sign.
#[must_use]
pub fn number_of_digits(value: f64, digits: usize) -> String {
    let text = format!("{value:.digits$}");
    let zero = text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.'));
    if zero { text.replace('-', "") } else { text.replacen('-', "\u{2212}", 1) }
}

/// The unit of nearly every number on a page.
pub static MICROMETRES: Text = Text::pair("\u{b5}m", "мкм");

/// Numbers as the readers of a language write them.
///
/// In Russian that is a decimal comma, and digits in groups of three behind a space from ten thousand on; four
/// stay together, as in the trade's tables.
pub trait Numbers: Copy {
    /// A number's English text, as this language writes it.
    fn figures(self, english: String) -> String;

    /// [`number`]
    fn number(self, value: f64) -> String {
        self.figures(number(value))
    }

    /// [`number_of_digits`]
    fn digits(self, value: f64, digits: usize) -> String {
        self.figures(number_of_digits(value, digits))
    }

    /// [`percent`]
    fn percent(self, share: f64) -> String {
        self.figures(percent(share))
    }

    /// A text made for the terminal, where numbers have a point, as a page of this language shows it.
    fn prose(self, text: &Text) -> String;

    /// The same of a text that is in this language already.
    fn of_terminal(self, text: &str) -> String;

    /// A whole number.
    fn count(self, count: impl TryInto<u64>) -> String {
        self.figures(count.try_into().map_or_else(|_| "\u{2014}".to_owned(), |count| count.to_string()))
    }
}

impl Numbers for Language {
    fn figures(self, english: String) -> String {
        match self {
            Self::English => english,
            Self::Russian => grouped(&english.replace('.', ",")),
        }
    }

    fn prose(self, text: &Text) -> String {
        self.of_terminal(text.in_language(self))
    }

    fn of_terminal(self, text: &str) -> String {
        match self {
            Self::English => text.to_owned(),
            Self::Russian => with_commas(text),
        }
    }
}

/// The points of decimal numbers as commas; points of names, versions and codes (`G54.1`, `x.csv`, `0.1.0`) stay.
fn with_commas(text: &str) -> String {
    let of_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '/' | '`');
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let length = rest[start..].find(|c: char| !(c.is_ascii_digit() || c == '.'));
        let end = length.map_or(rest.len(), |length| start + length);
        let (before, number) = (&rest[..start], rest[start..end].trim_end_matches('.'));
        out.push_str(before);
        let stands_alone = !out.ends_with(of_name)
            && !rest[start + number.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
        if stands_alone && number.matches('.').count() == 1 {
            out.push_str(&number.replace('.', ","));
        } else {
            out.push_str(number);
        }
        rest = &rest[start + number.len()..];
    }
    out + rest
}

/// Digits before the comma in groups of three, where there are more than four.
fn grouped(text: &str) -> String {
    let start = text.find(|c: char| c.is_ascii_digit()).unwrap_or(text.len());
    let count = text[start..].bytes().take_while(u8::is_ascii_digit).count();
    if count <= 4 {
        return text.to_owned();
    }
    let (whole, rest) = text[start..].split_at(count);
    let mut out = text[..start].to_owned();
    for (at, digit) in whole.chars().enumerate() {
        if at > 0 && (count - at) % 3 == 0 {
            out.push('\u{a0}');
        }
        out.push(digit);
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use maud::html;

    #[test]
    fn numbers_are_written_as_in_the_language() {
        let both = |value: f64| Language::ALL.map(|language| language.digits(value, 1));
        assert_eq!(both(-1234.5), ["\u{2212}1234.5", "\u{2212}1234,5"]);
        assert_eq!(both(1_234_567.8), ["1234567.8", "1\u{a0}234\u{a0}567,8"]);
        assert_eq!(Language::Russian.count(20_001_usize), "20\u{a0}001");
        assert_eq!(Language::Russian.number(-0.0001), "\u{2212}1,0e-4");
        assert_eq!(Language::Russian.percent(0.5), "50 %");
        assert_eq!(Language::Russian.number(f64::NAN), "\u{2014}");
        let text = Text::pair("", "на 14.1 мкм, ±0.5; G54.1, 0.1.0, a1.5, в 2. строке 3.");
        let said = "на 14,1 мкм, ±0,5; G54.1, 0.1.0, a1.5, в 2. строке 3.";
        assert_eq!(Language::Russian.prose(&text), said);
    }

    #[test]
    fn what_stands_in_a_file_is_text_on_the_page() {
        let hostile = "<script>alert(1)</script>\" onload='x' &amp;\0\u{202e}gpj.exe";
        let page = html! { p title=(shown(hostile)) { (shown(hostile)) } }.into_string();
        assert!(!page.contains("<script") && !page.contains("\" onload"), "{page}");
        assert!(page.contains("&lt;script&gt;") && page.contains("&amp;amp;"), "{page}");
        assert!(page.contains('\u{2400}') && page.contains("U+202E"), "{page}");
    }

    #[test]
    fn json_cannot_end_its_block_and_stays_the_same() {
        let json = "{\"a\":\"</script><!--&\u{2028}\"}";
        let block = json_block(json).into_string();
        assert!(!block.contains('<') && !block.contains('&'), "{block}");
        assert_eq!(block, "{\"a\":\"\\u003c/script\\u003e\\u003c!--\\u0026\\u2028\"}");
    }

    #[test]
    fn numbers_for_people() {
        for (value, text) in [
            (0.0, "0.00"),
            (-0.0001, "\u{2212}1.0e-4"),
            (-0.004, "0.00"),
            (1.234, "1.23"),
            (-12.34, "\u{2212}12.3"),
            (9.996, "10.0"),
            (1234.5, "1234"),
            (f64::NAN, "\u{2014}"),
        ] {
            assert_eq!(number(value), text);
        }
        assert_eq!(percent(-0.001), "0 %");
        assert_eq!(short("abcdef", 4), "abc\u{2026}");
    }
}
