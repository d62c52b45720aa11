//! What must hold in a grammar beyond its shape.

use std::ops::Range;

use crate::control::{Action, CodeEntry};
use diagnostic::{Code, Diagnostic, Text, both};
use nc_syntax::{GCode, Letters};
use toml::Spanned;

use crate::table::Grammar;

/// No control takes arcs whose radii differ by more of the radius.
const MOST_SHARE: f64 = 0.01;

/// The start codes as codes of the table, one per modal group.
pub(crate) fn start_codes(
    written: &[Spanned<String>],
    codes: &[CodeEntry],
    wrong: &mut Vec<Diagnostic>,
) -> Vec<GCode> {
    let mut found: Vec<&CodeEntry> = Vec::new();
    for code in written {
        let name = code.get_ref();
        let problem = match codes.iter().find(|entry| entry.code.to_string() == *name) {
            None => both!("`{name}` has no row in [codes]", "для `{name}` нет строки в [codes]"),
            Some(entry) if matches!(entry.action, Action::Refuse { .. }) => {
                both!("`{name}` is a refused code", "`{name}` отвергнута")
            }
            Some(entry) if entry.group == 0 => both!(
                "`{name}` holds for one block only (group 0)",
                "`{name}` действует только один кадр (группа 0)"
            ),
            Some(entry) => match found.iter().find(|other| other.group == entry.group) {
                Some(other) => both!(
                    "`{name}` excludes {}, of the same group",
                    "`{name}` исключает {} из той же группы",
                    other.code
                ),
                None => {
                    found.push(entry);
                    continue;
                }
            },
        };
        wrong.push(
            Diagnostic::error(
                Code(807),
                both!(
                    "{problem}: it cannot hold at the start",
                    "{problem:#}: в начале она действовать не может"
                ),
            )
            .at(
                wide(code.span()),
                both!("expected a modal code of the table", "ожидалась модальная функция из таблицы"),
            )
            .help(both!(
                "write codes as the table writes them: `G17`, not `G017`",
                "пишите функции так, как в таблице: `G17`, а не `G017`"
            )),
        );
    }
    found.into_iter().map(|entry| entry.code).collect()
}

/// Letters are capitals, each once, and the ones nothing works without are there.
pub(crate) fn letters(written: &Spanned<String>, wrong: &mut Vec<Diagnostic>) {
    let text = written.get_ref();
    let problem = if let Some(bad) = no_capital(text) {
        Some(bad)
    } else if let Some((_, twice)) = text.char_indices().find(|(at, c)| text[..*at].contains(*c)) {
        Some(both!("`{twice}` stands twice", "`{twice}` стоит дважды"))
    } else {
        "GMNXYZF"
            .chars()
            .find(|c| !text.contains(*c))
            .map(|missing| both!("`{missing}` is missing", "нет `{missing}`"))
    };
    if let Some(problem) = problem {
        wrong.push(
            Diagnostic::error(
                Code(808),
                both!(
                    "these cannot be the letters of words: {problem}",
                    "это не могут быть буквы слов: {problem:#}"
                ),
            )
            .at(
                wide(written.span()),
                both!("expected each letter of a word once", "ожидалась каждая буква слова один раз"),
            )
            .help(both!(
                "letters = \"ABCDEFGHIJKLMNOPQRSTUVWXYZ\" takes all",
                "letters = \"ABCDEFGHIJKLMNOPQRSTUVWXYZ\" берёт все"
            )),
        );
    }
}

/// What of a text is no capital letter.
fn no_capital(text: &str) -> Option<Text> {
    let bad = text.chars().find(|c| !c.is_ascii_uppercase())?;
    Some(both!("`{bad}` is not a capital letter", "`{bad}` — не прописная буква"))
}

/// The letters of a set; what is none is said.
pub(crate) fn set_of_letters(written: Option<&Spanned<String>>, wrong: &mut Vec<Diagnostic>) -> Letters {
    let Some(written) = written else { return Letters::NONE };
    let letters = written.get_ref().to_ascii_uppercase();
    if let Some(bad) = no_capital(&letters) {
        let expected = both!("expected letters of words: \"XZ\"", "ожидались буквы слов: \"XZ\"");
        wrong.push(Diagnostic::error(Code(808), bad).at(wide(written.span()), expected));
        return Letters::NONE;
    }
    Letters::of(letters.as_bytes())
}

/// Numbers within what a control or this program can mean.
pub(crate) fn numbers(grammar: &Grammar, wrong: &mut Vec<Diagnostic>) {
    let (numbers, cycles, output) = (&grammar.numbers, &grammar.cycles, &grammar.output);
    let mut report = |span: std::ops::Range<usize>, message: Text, expected: Text| {
        wrong.push(Diagnostic::error(Code(806), message).at(wide(span), expected));
    };
    for (what, decimals) in [
        ("least_increment_decimals_mm", &numbers.least_increment_decimals_mm),
        ("least_increment_decimals_inch", &numbers.least_increment_decimals_inch),
        ("decimals_inch", &output.decimals_inch),
        ("decimals_feed", &output.decimals_feed),
    ] {
        if *decimals.get_ref() > 9 {
            report(
                decimals.span(),
                both!(
                    "{what} = {} is no control's resolution",
                    "{what} = {} — такой дискреты нет ни у одной стойки",
                    decimals.get_ref()
                ),
                both!("expected 0 to 9", "ожидалось от 0 до 9"),
            );
        }
    }
    let share = output.arc_radius_tolerance_share.as_ref();
    let expected =
        || both!("expected 0 to {MOST_SHARE} of the radius", "ожидалось от 0 до {MOST_SHARE} радиуса");
    let share = share.map(|share| ("arc_radius_tolerance_share", share, 0.0..=MOST_SHARE, expected()));
    let length = |what, found, most: f64, unit: Text| {
        let expected =
            both!("expected above 0, up to {most}{unit}", "ожидалось больше 0 и не больше {most}{unit:#}");
        // The smallest number above 0.
        (what, found, f64::from_bits(1)..=most, expected)
    };
    let mm = || Text::pair(" mm", " мм");
    let inch = output.arc_radius_tolerance_inch.as_ref();
    let inch =
        inch.map(|found| length("arc_radius_tolerance_inch", found, 0.5, Text::pair(" inch", " дюйма")));
    let chords = output.arc_chord_tolerance_mm.as_ref();
    let chords = chords.map(|found| length("arc_chord_tolerance_mm", found, 1.0, mm()));
    let ranges = [
        length("peck_clearance_mm", &cycles.peck_clearance_mm, 100.0, mm()),
        length("chip_retreat_mm", &cycles.chip_retreat_mm, 100.0, mm()),
        length("arc_radius_tolerance_mm", &output.arc_radius_tolerance_mm, 10.0, mm()),
        length("scaling_step", &grammar.frames.scaling_step, 1.0, Text::EMPTY),
    ];
    for (what, number, range, expected) in share.into_iter().chain(ranges).chain(inch).chain(chords) {
        let found = *number.get_ref();
        // NaN is in no range.
        if !range.contains(&found) {
            report(
                number.span(),
                both!("{what} = {found} is out of range", "{what} = {found} вне границ"),
                expected,
            );
        }
    }
    if let Some(largest) = output.largest_inverse_feed.as_ref().filter(|largest| *largest.get_ref() < 1.0) {
        let message = both!("largest_inverse_feed is below 1", "largest_inverse_feed меньше 1");
        report(largest.span(), message, both!("expected 999.999 or more", "ожидалось 999.999 или больше"));
    }
    if *output.max_block_number.get_ref() == 0 {
        report(
            output.max_block_number.span(),
            both!(
                "max_block_number = 0 leaves no number",
                "max_block_number = 0 не оставляет ни одного номера"
            ),
            both!("expected 9999 or more", "ожидалось 9999 или больше"),
        );
    }
    for (mark, example) in [(&grammar.text.block_delete, '/'), (&grammar.text.end_of_block, ';')] {
        let Some(mark) = mark.as_ref().filter(|mark| !mark.get_ref().is_ascii_punctuation()) else {
            continue;
        };
        report(
            mark.span(),
            both!("`{}` cannot mark a block", "`{}` не может быть знаком при кадре", mark.get_ref()),
            both!("expected a mark like \"{example}\"", "ожидался знак вроде \"{example}\""),
        );
    }
    let levels = grammar.cycles.written_out.iter().flat_map(|rule| [&rule.level, &rule.bottom]);
    for letter in levels.filter(|letter| !letter.get_ref().is_ascii_uppercase()) {
        report(
            letter.span(),
            both!("`{}` is no letter of a word", "`{}` — не буква слова", letter.get_ref()),
            both!("expected a capital letter like \"R\"", "ожидалась прописная буква вроде \"R\""),
        );
    }
}

/// A place in the file.
pub(crate) fn wide(span: Range<usize>) -> Range<u64> {
    span.start as u64..span.end as u64
}
