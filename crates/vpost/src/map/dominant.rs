//! Which deviations make the error of a map: what the first screen names.

use diagnostic::{Text, both};
use jobs::map::dominant::Dominant;
use report::body::{Body, Table};
use report::numbers::number;

/// Named on the first screen.
const NAMED: usize = 3;

fn um(mm: f64) -> Text {
    number(mm * 1e3)
}

/// The sentence of the first screen; nothing where nothing is known of single deviations.
pub(super) fn sentence(all: &[Dominant]) -> Option<Text> {
    let largest = all.iter().map(|own| own.alone_mm).fold(0.0, f64::max);
    let named: Vec<Text> = all
        .iter()
        .take(NAMED)
        // A tenth of the largest is none that one would begin with.
        .filter(|own| own.alone_mm > 0.1 * largest)
        .map(|own| {
            let (name, um) = (called(&own.name), um(own.alone_mm));
            both!("{name} (alone {um} \u{b5}m)", "{name:#} (само по себе {um:#} мкм)")
        })
        .collect();
    let said = Text::join(&named, ", ");
    (!named.is_empty()).then(|| both!("What makes most of it: {said}.", "Больше всего вносят: {said:#}."))
}

/// A symbol of ISO 230-1 with its kind in a word, for whoever does not read symbols: `EC0Y squareness`.
fn called(name: &str) -> Text {
    let kind = match name.as_bytes() {
        [b'E', b'A'..=b'C', b'0', b'X'..=b'Z'] => both!("squareness", "перпендикулярность"),
        [b'E', a @ b'X'..=b'Z', b] if a == b => both!("positioning", "позиционирование"),
        [b'E', b'X'..=b'Z', b'X'..=b'Z'] => both!("straightness", "прямолинейность"),
        [b'E', b'A'..=b'C', b'X'..=b'Z'] => both!("angle", "угол"),
        _ => return Text::same(name),
    };
    both!("{name} {kind}", "{name} {kind:#}")
}

/// All of them as a table; nothing where there are none.
pub(super) fn section(out: &mut Body, all: &[Dominant]) {
    if all.is_empty() {
        return;
    }
    out.typed(&both!(
        "Symbols of ISO 230-1, at up to five places along each axis of the map, in order of what is left without it. More, and what each deviation may be, says `vpost budget`.",
        "Обозначения по ISO 230-1, до пяти мест вдоль каждой оси карты; первым стоит то, без которого остаётся меньше всего. Подробнее, с допуском на каждое отклонение, говорит `vpost budget`."
    ));
    let table = Table::of(all)
        .words(both!("deviation", "отклонение"), |own| Text::same(&own.name))
        .numbers(
            both!("largest with it alone, \u{b5}m", "наибольшее с ним одним, мкм"),
            |own| um(own.alone_mm),
        )
        .numbers(both!("largest without it, \u{b5}m", "наибольшее без него, мкм"), |own| um(own.without_mm));
    out.table(&table);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn symbols_are_said_in_a_word() {
        for (symbol, word) in [
            ("EC0Y", "EC0Y squareness"),
            ("EXX", "EXX positioning"),
            ("EYX", "EYX straightness"),
            ("EAX", "EAX angle"),
            ("EX0C", "EX0C"),
            ("backlash X", "backlash X"),
        ] {
            assert_eq!(called(symbol).english(), word);
        }
        assert_eq!(format!("{:#}", called("EYX")), "EYX прямолинейность");
    }
}
