//! Texts from files: shown, never acting; numbers as people write them.

use diagnostic::{Language, Text};
use maud::{Markup, PreEscaped, html};

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

/// A text that begins a line: what a terminal joins to words before it begins with a small letter.
#[must_use]
pub fn opening(text: &str) -> String {
    let mut rest = text.chars();
    rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
}

/// A text in which what is typed stands between backticks, as on a terminal.
#[must_use]
pub fn typed(text: &str) -> Markup {
    let parts: Vec<&str> = text.split('`').collect();
    html! {
        @if parts.len().is_multiple_of(2) { (shown(text)) } @else {
            @for (k, part) in parts.into_iter().enumerate() { @if k % 2 == 0 { (shown(part)) } @else { code { (shown(part)) } } }
        }
    }
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

    /// A value and half the width of its interval: two digits of that, and as many decimals of the value.
    fn measured(self, value: f64, half_width: f64) -> [String; 2] {
        let size = half_width.abs();
        if !(size.is_finite() && size > 0.0) {
            return [self.number(value), self.number(half_width)];
        }
        let digits = (0..9u8).find(|digits| size * 10f64.powi(i32::from(*digits)) >= 9.95).unwrap_or(9);
        [value, half_width].map(|number| self.digits(number, usize::from(digits)))
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
            Self::Russian => english.replace('.', ",").split(' ').map(grouped).collect::<Vec<_>>().join(" "),
        }
    }

    fn prose(self, text: &Text) -> String {
        self.of_terminal(text.in_language(self))
    }

    fn of_terminal(self, text: &str) -> String {
        // What stands between backticks is typed, not read.
        let is_balanced = text.matches('`').count().is_multiple_of(2);
        let part = |(k, part): (usize, &str)| match self {
            _ if is_balanced && k % 2 == 1 => part.to_owned(),
            Self::English => with_micro(&with_minus(part)),
            Self::Russian => with_commas(&with_minus(part)),
        };
        text.split('`').enumerate().map(part).collect::<Vec<_>>().join("`")
    }
}

/// Signs before numbers as real minus signs; hyphens of words, dates and blocks stay.
fn with_minus(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let is_first = out.chars().next_back().is_none_or(|before| before.is_whitespace() || before == '(');
        let is_sign = c == '-' && is_first && rest.peek().is_some_and(char::is_ascii_digit);
        out.push(if is_sign { '\u{2212}' } else { c });
    }
    out
}

/// Units that a terminal writes in ASCII, as they are.
fn with_micro(text: &str) -> String {
    let is_of_word = |c: char| c.is_alphanumeric() || c == '_';
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(|c: char| c.is_alphanumeric() || c == '_') {
        let end = rest[start..].find(|c: char| !is_of_word(c)).map_or(rest.len(), |length| start + length);
        out.push_str(&rest[..start]);
        match &rest[start..end] {
            unit @ ("um" | "urad") => {
                out.push('\u{b5}');
                out.push_str(&unit[1..]);
            }
            word => out.push_str(word),
        }
        rest = &rest[end..];
    }
    out + rest
}

/// Units that stay with their number where a line ends.
const UNITS: [&str; 14] = [
    "\u{b5}m",
    "\u{b5}rad",
    "mm",
    "m",
    "%",
    "\u{b0}",
    "\u{b0}C",
    "N",
    "\u{43c}\u{43a}\u{43c}",
    "\u{43c}\u{43a}\u{440}\u{430}\u{434}",
    "\u{43c}\u{43c}",
    "\u{43c}",
    "\u{41d}",
    "kg",
];

/// Longer words with hyphens have to be broken somewhere.
const WHOLE: usize = 24;

/// An option (`--holdout`, `-o`) or a word of a block with a minus (`Z-1.000`): neither is read in two parts.
fn is_whole(word: &str) -> bool {
    let bytes = word.trim_start_matches('(').as_bytes();
    let is_option =
        bytes.len() > 1 && bytes[0] == b'-' && (bytes[1] == b'-' || bytes[1].is_ascii_alphabetic());
    let is_of_block = |three: &[u8]| {
        three[0].is_ascii_uppercase() && three[1] == b'-' && (three[2].is_ascii_digit() || three[2] == b'.')
    };
    word.is_ascii() && word.len() <= WHOLE && (is_option || bytes.windows(3).any(is_of_block))
}

/// A page in whose texts no line ends between a number and its unit, nor at a hyphen of an option or of a block.
///
/// Drawings have no lines that could end, and what programs read stays as it is.
pub(crate) fn unparted(html: &str) -> String {
    let mut out = String::with_capacity(html.len() + html.len() / 16);
    let mut rest = html;
    // The element whose texts are left alone, and whether amounts are to be typed.
    let (mut kept, mut is_code) = (None::<&str>, false);
    while let Some(start) = rest.find('<') {
        let (text, tag) = rest.split_at(start);
        let length = tag.find('>').map_or(tag.len(), |end| end + 1);
        let name = tag[1..].split([' ', '>']).next().unwrap_or_default();
        if kept.is_some() {
            out.push_str(text);
        } else {
            unparted_text(text, is_code, &mut out);
        }
        match kept {
            Some(element) if name.strip_prefix('/') == Some(element) => kept = None,
            None => {
                kept = ["script", "style", "title", "svg", "pre"].into_iter().find(|element| *element == name)
            }
            Some(_) => {}
        }
        match name {
            "code" => is_code = true,
            "/code" => is_code = false,
            _ => {}
        }
        out.push_str(&tag[..length]);
        rest = &tag[length..];
    }
    out + rest
}

/// True where no line may end between two words: a number and its unit, a sign or an axis and its number, a symbol and
/// its equals sign.
fn stays_with(before: &str, word: &str) -> bool {
    let unit = word.trim_end_matches(|c: char| !(c.is_alphanumeric() || matches!(c, '%' | '\u{b0}')));
    let unit = unit.split('/').next().unwrap_or_default();
    let is_range = |word: &str| matches!(word, "\u{2026}" | "\u{2192}");
    let is_sign = |word: &str| matches!(word, "=" | "<" | ">" | "\u{2264}" | "\u{2265}" | "\u{d8}");
    let is_axis = |word: &str| matches!(word.trim_start_matches('('), "X" | "Y" | "Z");
    let is_amount = || word.contains(|c: char| c.is_ascii_digit());
    before.ends_with(|c: char| c.is_ascii_digit()) && (UNITS.contains(&unit) || is_range(word))
        || (before.ends_with('\u{b1}') || is_range(before) || is_sign(before) || is_axis(before))
            && is_amount()
        || word == "=" && !before.is_empty()
}

/// Characters of the longest part of a text in which no line may end.
pub(crate) fn longest(text: &str) -> usize {
    let (mut most, mut own, mut before) = (0, 0, "");
    for word in text.split(' ') {
        let size = word.chars().count();
        own = if stays_with(before, word) { own + 1 + size } else { size };
        (most, before) = (most.max(own), word);
    }
    most
}

/// One text of a page.
fn unparted_text(text: &str, is_code: bool, out: &mut String) {
    let mut before = "";
    for (k, word) in text.split(' ').enumerate() {
        match k {
            0 => {}
            _ if !is_code && stays_with(before, word) => out.push('\u{a0}'),
            _ => out.push(' '),
        }
        if is_whole(word) {
            out.push_str("<span class=\"w\">");
            out.push_str(word);
            out.push_str("</span>");
        } else {
            out.push_str(word);
        }
        before = word;
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
        let pair = Language::Russian.figures("60008 \u{2192} 59999.5".to_owned());
        assert_eq!(pair, "60\u{a0}008 \u{2192} 59\u{a0}999,5");
        let measured = |value: f64, u: f64| Language::English.measured(value, u).join(" \u{b1} ");
        assert_eq!(measured(243.37, 90.577), "243 \u{b1} 91");
        assert_eq!(measured(11.312, 0.1234), "11.31 \u{b1} 0.12");
        assert_eq!(measured(-1175.4, 46.1), "\u{2212}1175 \u{b1} 46");
        assert_eq!(measured(3.0, 9.96), "3 \u{b1} 10");
        assert_eq!(measured(1.0, 0.0), "1.00 \u{b1} 0.00");
        let text = Text::pair("", "на 14.1 мкм, ±0.5; G54.1, 0.1.0, a1.5, в 2. строке 3.");
        let said = "на 14,1 мкм, ±0,5; G54.1, 0.1.0, a1.5, в 2. строке 3.";
        assert_eq!(Language::Russian.prose(&text), said);
        let typed = "-1.5 um of -2 urad (-3) by `-4.5 um`, 2022-10-20, angle_urad, X-5";
        let [english, russian] = Language::ALL.map(|language| language.of_terminal(typed));
        let read = "\u{2212}1.5 \u{b5}m of \u{2212}2 \u{b5}rad (\u{2212}3) by `-4.5 um`, 2022-10-20, angle_urad, X-5";
        assert_eq!(english, read);
        assert!(russian.starts_with("\u{2212}1,5 um") && russian.contains("`-4.5 um`"), "{russian}");
    }

    #[test]
    fn a_number_keeps_its_unit_and_an_option_its_hyphens() {
        let page = "<title>5 mm</title><p>up to 332 \u{b5}m, 95 % (\u{b1} 0.12 mm/min); 5 men</p><svg><text>5 mm</text></svg>\
            <code>a 5 mm --viewer x</code><p>ISO 230-2, add --holdout FILE. до 1,83 мкм</p><script>\"5 mm -o\"</script>";
        let whole = "<title>5 mm</title><p>up to 332\u{a0}\u{b5}m, 95\u{a0}% (\u{b1}\u{a0}0.12\u{a0}mm/min); 5 men</p><svg><text>5 mm</text></svg>\
            <code>a 5 mm <span class=\"w\">--viewer</span> x</code><p>ISO 230-2, add <span class=\"w\">--holdout</span> FILE. до 1,83\u{a0}мкм</p><script>\"5 mm -o\"</script>";
        assert_eq!(unparted(page), whole);
        assert_eq!(unparted("<td>155 \u{2026} 301 of 7</td>"), "<td>155\u{a0}\u{2026}\u{a0}301 of 7</td>");
        assert_eq!(
            unparted("<td>X1 Z-1.5 2022-10-20</td>"),
            "<td>X1 <span class=\"w\">Z-1.5</span> 2022-10-20</td>"
        );
        assert_eq!(
            unparted("<p>A = 243 \u{b5}m, Z 299 mm (X 1.5), 220, Y 120; \u{2264} 20, for X and 5; A 5</p>"),
            "<p>A\u{a0}=\u{a0}243\u{a0}\u{b5}m, Z\u{a0}299\u{a0}mm (X\u{a0}1.5), 220, Y\u{a0}120; \u{2264}\u{a0}20, for X and 5; A 5</p>"
        );
        assert_eq!([longest("155 \u{2026} 301 of 7 mm"), longest("of 77 \u{b5}m"), longest("")], [9, 5, 0]);
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
        assert_eq!(opening("ось"), "Ось");
        assert_eq!(typed("add `a<b` to `c`").into_string(), "add <code>a&lt;b</code> to <code>c</code>");
        assert_eq!(typed("5 ` 6").into_string(), "5 ` 6");
    }
}
