//! Texts from files: shown, never acting.

use diagnostic::{Language, Text};
use maud::{Markup, PreEscaped, html};

/// The machine, in every page's last section.
pub const MACHINE: Text = Text::pair("machine", "станок");
/// Files of measurements, there.
pub const MEASUREMENTS: Text = Text::pair("measurements", "измерения");

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

/// JSON for a data block: what could end the block, or begin a comment, is written as JSON's own escape, so that it
/// still reads back as the same values.
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

/// A text that begins a line: what a terminal joins to words before it begins with a small letter.
#[must_use]
pub fn opening(text: &Text) -> Text {
    let begun = |language| {
        let mut rest = text.in_language(language).chars();
        rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
    };
    Text::new(begun(Language::English), begun(Language::Russian))
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
    let (mut kept, mut kind) = (None::<&str>, Kind::Prose);
    while let Some(start) = rest.find('<') {
        let (text, tag) = rest.split_at(start);
        let length = tag.find('>').map_or(tag.len(), |end| end + 1);
        let name = tag[1..].split([' ', '>']).next().unwrap_or_default();
        if kept.is_some() {
            out.push_str(text);
        } else {
            unparted_text(text, kind, &mut out);
        }
        match kept {
            Some(element) if name.strip_prefix('/') == Some(element) => kept = None,
            None => {
                kept = ["script", "style", "title", "svg", "pre"].into_iter().find(|element| *element == name)
            }
            Some(_) => {}
        }
        match name {
            "code" => kind = Kind::Code,
            "/code" => kind = Kind::Prose,
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

/// What a text of a page is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Sentences, with amounts in them.
    Prose,
    /// What is typed.
    Code,
}

/// One text of a page.
fn unparted_text(text: &str, kind: Kind, out: &mut String) {
    let mut before = "";
    for (k, word) in text.split(' ').enumerate() {
        match k {
            0 => {}
            _ if kind == Kind::Prose && stays_with(before, word) => out.push('\u{a0}'),
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

#[cfg(test)]
mod tests {
    use super::*;
    use maud::html;

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
    fn words_for_people() {
        assert_eq!(short("abcdef", 4), "abc\u{2026}");
        assert_eq!(opening(&Text::same("ось")), Text::same("Ось"));
        assert_eq!(typed("add `a<b` to `c`").into_string(), "add <code>a&lt;b</code> to <code>c</code>");
        assert_eq!(typed("5 ` 6").into_string(), "5 ` 6");
    }
}
