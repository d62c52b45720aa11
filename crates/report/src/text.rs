//! Texts from files: shown, never acting.

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

#[cfg(test)]
mod tests {
    use super::*;
    use maud::html;

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
