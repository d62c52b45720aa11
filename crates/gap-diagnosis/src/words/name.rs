//! Effects and their numbers by name, for people who do not type them.

use diagnostic::{Text, both};
use machine_model::effects::EffectKind;

use crate::effects::{self, FAULTS};

/// A name of an effect that fits beside a bar: in English its id.
///
/// ```
/// use diagnostic::Language;
/// use gap_diagnosis::effect_name;
///
/// let name = effect_name(&"squareness.XY".parse().unwrap());
/// assert_eq!(name.in_language(Language::English), "squareness.XY");
/// assert_eq!(name.in_language(Language::Russian), "перпендикулярность XY");
/// ```
#[must_use]
pub fn effect_name(kind: &EffectKind) -> Text {
    let id = kind.to_string();
    let of = id.split_once('.').map_or("", |(_, of)| of);
    let russian = match kind {
        EffectKind::Tracker(fault) => format!("трекер: {}", FAULTS[*fault][0]),
        other => format!("{} {of}", effects::of(*other).name).trim_end().to_owned(),
    };
    Text::new(id, russian)
}

/// The units behind the names of numbers, the longest first.
static UNITS: [(&str, Text); 19] = [
    ("_um_per_part", Text::pair("µm/part", "мкм/деталь")),
    ("_n", Text::pair("N", "Н")),
    ("_um_per_m_s2", Text::pair("µm/(m/s²)", "мкм/(м/с²)")),
    ("_ms_per_m_min", Text::pair("ms/(m/min)", "мс/(м/мин)")),
    ("_um_per_m_k2", Text::pair("µm/(m K²)", "мкм/(м·К²)")),
    ("_um_per_m_k", Text::pair("µm/(m K)", "мкм/(м·К)")),
    ("_um_per_kg2", Text::pair("µm/kg²", "мкм/кг²")),
    ("_um_per_kg", Text::pair("µm/kg", "мкм/кг")),
    ("_um_per_h2", Text::pair("µm/h²", "мкм/ч²")),
    ("_um_per_h", Text::pair("µm/h", "мкм/ч")),
    ("_um_per_k", Text::pair("µm/K", "мкм/К")),
    ("_um_per_m", Text::pair("µm/m", "мкм/м")),
    ("_urad", Text::pair("µrad", "мкрад")),
    ("_um", Text::pair("µm", "мкм")),
    ("_mm", Text::pair("mm", "мм")),
    ("_ms", Text::pair("ms", "мс")),
    ("_deg", Text::pair("°", "°")),
    ("_kg", Text::pair("kg", "кг")),
    ("_s", Text::pair("s", "с")),
];

/// Words of names, in Russian.
const WORDS: [(&str, &str); 33] = [
    ("wave", "волна"),
    ("taper", "конусность"),
    ("force", "сила"),
    ("wear", "износ"),
    ("growth", "рост"),
    ("bow", "прогиб"),
    ("angle", "угол"),
    ("scale", "масштаб"),
    ("expansion", "расширение"),
    ("shift", "сдвиг"),
    ("amplitude", "амплитуда"),
    ("half-width", "полуширина"),
    ("width", "ширина"),
    ("slope", "наклон"),
    ("sin", "синус"),
    ("cos", "косинус"),
    ("radial", "по радиусу"),
    ("droop", "провисание, степень"),
    ("tilt", "наклон"),
    ("compliance", "податливость"),
    ("lag", "отставание"),
    ("path", "вдоль траектории"),
    ("mismatch", "разница"),
    ("offset", "смещение"),
    ("pole", "полюс"),
    ("spike", "выброс"),
    ("tau", "постоянная времени"),
    ("from", "от"),
    ("to", "до"),
    ("pitch", "шаг"),
    ("time", "время"),
    ("centre", "середина"),
    ("p", "член степени"),
];

/// The name of a number of an effect, `half_width_um`, with its unit, in words.
///
/// ```
/// use diagnostic::Language;
/// use gap_diagnosis::number_name;
///
/// let name = number_name("scale_um_per_m");
/// assert_eq!(name.in_language(Language::English), "scale, µm/m");
/// assert_eq!(name.in_language(Language::Russian), "масштаб, мкм/м");
/// ```
#[must_use]
pub fn number_name(key: &str) -> Text {
    let unit = UNITS.iter().find_map(|(end, unit)| Some((key.strip_suffix(end)?, unit)));
    let (name, unit) = unit.map_or((key, None), |(name, unit)| (name, Some(unit)));
    let name = name.replace("half_width", "half-width");
    let words: Vec<[String; 2]> = name.split('_').map(in_words).collect();
    let [english, russian] = [0, 1].map(|which| {
        let all: Vec<&str> = words.iter().map(|word| word[which].as_str()).collect();
        all.join(" ")
    });
    let name = Text::new(english, russian);
    unit.map_or(name.clone(), |unit| both!("{name}, {unit}", "{name:#}, {unit:#}"))
}

/// A word of a name with the number behind it, in both languages: an axis is named in capitals.
fn in_words(word: &str) -> [String; 2] {
    if let "x" | "y" | "z" = word {
        return [word.to_uppercase(), word.to_uppercase()];
    }
    let name = word.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = &word[name.len()..];
    let russian = WORDS.iter().find(|(known, _)| *known == name).map_or(name, |(_, russian)| *russian);
    [name, russian].map(|name| if number.is_empty() { name.to_owned() } else { format!("{name} {number}") })
}

#[cfg(test)]
mod tests {
    use super::*;
    use diagnostic::Language;

    /// What a page in Russian says holds nothing in English.
    #[test]
    fn every_effect_and_every_number_has_a_name_in_russian() {
        let is_latin = |text: &str| text.chars().any(|c| c.is_ascii_lowercase());
        for kind in EffectKind::all() {
            let name = effect_name(&kind);
            let russian = name.in_language(Language::Russian);
            assert!(!is_latin(russian) && russian.chars().count() <= 24, "{kind}: {russian}");
            for key in kind.coefficient_names().iter().copied().chain(kind.shape_names()) {
                let name = number_name(key);
                let russian = name.in_language(Language::Russian);
                assert!(!is_latin(russian) && russian.contains(','), "{kind}: {key}: {russian}");
            }
        }
    }

    #[test]
    fn names_differ_from_one_another() {
        let mut all: Vec<String> = EffectKind::all()
            .iter()
            .map(|kind| effect_name(kind).in_language(Language::Russian).to_owned())
            .collect();
        let count = all.len();
        all.sort();
        all.dedup();
        assert_eq!(all.len(), count);
    }
}
