//! Numbers as texts: a decimal point in English, a comma in Russian.

use diagnostic::{Language, Text, both};

/// A number's English text, as every language writes it.
///
/// In Russian that is a decimal comma, and digits in groups of three behind a space from ten thousand on; four
/// stay together, as in the trade's tables.
#[must_use]
pub fn figures(english: String) -> Text {
    let russian = english.replace('.', ",").split(' ').map(grouped).collect::<Vec<_>>().join(" ");
    Text::new(english, russian)
}

/// With three significant digits, as people write it: no exponent for what a machine measures.
#[must_use]
pub fn number(value: f64) -> Text {
    let text = match value.abs() {
        _ if !value.is_finite() => return DASH,
        size if size >= 99.95 => format!("{value:.0}"),
        size if size >= 9.995 => format!("{value:.1}"),
        size if size >= 0.0005 || value == 0.0 => format!("{value:.2}"),
        _ => format!("{value:.1e}"),
    };
    signed(&text)
}

/// With fixed decimals.
#[must_use]
pub fn digits(value: f64, digits: usize) -> Text {
    signed(&format!("{value:.digits$}"))
}

/// With a real minus sign; minus zero is zero to people.
fn signed(text: &str) -> Text {
    let is_zero = text.trim_start_matches('-').chars().all(|c| matches!(c, '0' | '.'));
    figures(text.replacen('-', if is_zero { "" } else { "\u{2212}" }, 1))
}

/// A share as a percentage without decimals.
#[must_use]
pub fn percent(share: f64) -> Text {
    let share = digits(100.0 * share, 0);
    both!("{share} %", "{share:#} %")
}

/// A whole number.
#[must_use]
pub fn count(count: impl TryInto<u64>) -> Text {
    count.try_into().map_or(DASH, |count| figures(count.to_string()))
}

/// A value and half the width of its interval: two digits of that, and as many decimals of the value.
#[must_use]
pub fn measured(value: f64, half_width: f64) -> [Text; 2] {
    let size = half_width.abs();
    if !(size.is_finite() && size > 0.0) {
        return [number(value), number(half_width)];
    }
    let decimals = (0..9u8).find(|decimals| size * 10f64.powi(i32::from(*decimals)) >= 9.95).unwrap_or(9);
    [value, half_width].map(|number| digits(number, usize::from(decimals)))
}

/// Where nothing is known.
pub const DASH: Text = Text::pair("\u{2014}", "\u{2014}");

/// What a number says, or a dash.
#[must_use]
pub fn or_dash(value: Option<f64>, said: impl FnOnce(f64) -> Text) -> Text {
    value.map_or(DASH, said)
}

/// A text made for the terminal, where numbers have a point, as pages show it.
#[must_use]
pub fn prose(text: &Text) -> Text {
    let in_language = |text: &str, sign: fn(&str) -> String| {
        // What stands between backticks is typed, not read.
        let is_balanced = text.matches('`').count().is_multiple_of(2);
        let part = |(k, part): (usize, &str)| match is_balanced && k % 2 == 1 {
            true => part.to_owned(),
            false => sign(&with_minus(part)),
        };
        text.split('`').enumerate().map(part).collect::<Vec<_>>().join("`")
    };
    Text::new(
        in_language(text.english(), with_micro),
        in_language(text.in_language(Language::Russian), with_commas),
    )
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

    fn russian(text: &Text) -> String {
        format!("{text:#}")
    }

    #[test]
    fn numbers_are_written_as_in_the_language() {
        let both =
            |value: f64| Language::ALL.map(|language| digits(value, 1).in_language(language).to_owned());
        assert_eq!(both(-1234.5), ["\u{2212}1234.5", "\u{2212}1234,5"]);
        assert_eq!(both(1_234_567.8), ["1234567.8", "1\u{a0}234\u{a0}567,8"]);
        assert_eq!(russian(&count(20_001_usize)), "20\u{a0}001");
        assert_eq!(russian(&number(-0.0001)), "\u{2212}1,0e-4");
        assert_eq!(russian(&percent(0.5)), "50 %");
        assert_eq!(russian(&number(f64::NAN)), "\u{2014}");
        let pair = russian(&figures("60008 \u{2192} 59999.5".to_owned()));
        assert_eq!(pair, "60\u{a0}008 \u{2192} 59\u{a0}999,5");
        let measured = |value: f64, u: f64| Text::join(&measured(value, u), " \u{b1} ").english().to_owned();
        assert_eq!(measured(243.37, 90.577), "243 \u{b1} 91");
        assert_eq!(measured(11.312, 0.1234), "11.31 \u{b1} 0.12");
        assert_eq!(measured(-1175.4, 46.1), "\u{2212}1175 \u{b1} 46");
        assert_eq!(measured(3.0, 9.96), "3 \u{b1} 10");
        assert_eq!(measured(1.0, 0.0), "1.00 \u{b1} 0.00");
        let text = Text::pair("", "на 14.1 мкм, ±0.5; G54.1, 0.1.0, a1.5, в 2. строке 3.");
        let said = "на 14,1 мкм, ±0,5; G54.1, 0.1.0, a1.5, в 2. строке 3.";
        assert_eq!(russian(&prose(&text)), said);
        let typed = "-1.5 um of -2 urad (-3) by `-4.5 um`, 2022-10-20, angle_urad, X-5";
        let typed = prose(&Text::same(typed));
        let russian = russian(&typed);
        let read = "\u{2212}1.5 \u{b5}m of \u{2212}2 \u{b5}rad (\u{2212}3) by `-4.5 um`, 2022-10-20, angle_urad, X-5";
        assert_eq!(typed.english(), read);
        assert!(russian.starts_with("\u{2212}1,5 um") && russian.contains("`-4.5 um`"), "{russian}");
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
            assert_eq!(number(value).english(), text);
        }
        assert_eq!(percent(-0.001).english(), "0 %");
    }
}
