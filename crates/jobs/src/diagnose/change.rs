//! What acting on a cause changes in the profile: from and to, so that no increment passes for a value.

use diagnostic::{Text, both};
use gap_diagnosis::Cause;
use machine_model::effects::EffectKind;
use machine_profile::Profile;
use serde::Serialize;

/// One number of the machine that a cause changes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// Its name for people: `EC0Y`, `play of Y`, or a coefficient of the effect.
    #[serde(serialize_with = "in_english")]
    name: Text,
    /// What the profile says now; `null` where its tables hold it, as a curve.
    from: Option<f64>,
    /// By how much it grows.
    by: f64,
    /// Of all three.
    unit: &'static str,
}

impl Change {
    /// `EC0Y 85.0 → 148.0 µrad`, or `play of Y +11.2 µm` where no one number of the profile holds it.
    #[must_use]
    pub fn text(&self) -> Text {
        let Self { name, by, .. } = self;
        let unit = unit_text(self.unit);
        match self.from {
            Some(from) => {
                let to = from + by;
                both!("{name} {from:.1} → {to:.1} {unit}", "{name:#} {from:.1} → {to:.1} {unit:#}")
            }
            None => both!("{name} {by:+.1} {unit}", "{name:#} {by:+.1} {unit:#}"),
        }
    }
}

/// JSON is English in every language.
fn in_english<S: serde::Serializer>(text: &Text, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(text.english())
}

/// A unit of [`UNITS`], for people.
fn unit_text(unit: &str) -> Text {
    // Longer ones before those that are part of them.
    const PARTS: [(&str, &str); 8] = [
        ("µrad", "мкрад"),
        ("µm", "мкм"),
        ("ms", "мс"),
        ("min", "мин"),
        ("kg", "кг"),
        ("m", "м"),
        ("s²", "с²"),
        ("/h", "/ч"),
    ];
    let russian =
        PARTS.iter().fold(unit.to_owned(), |text, (english, russian)| text.replace(english, russian));
    Text::new(unit.to_owned(), russian.replace('K', "К"))
}

/// What a cause changes in a profile: the profile's own key where it has one for it, else the effect's coefficients.
///
/// Nothing for faults of the instrument, which are none of the machine.
#[must_use]
pub fn of(cause: &Cause, profile: &Profile) -> Vec<Change> {
    let Some(term) = cause.term.as_ref().filter(|term| !term.kind().is_instrument()) else {
        return Vec::new();
    };
    let kind = term.kind();
    let [first, ..] = kind.coefficient_names() else { return Vec::new() };
    let change = |(name, by): (&str, f64)| {
        let entered = entered(profile, &cause.effect, name);
        match key(kind, profile).filter(|_| name == *first) {
            Some(key) => {
                let from = key.value.map(|value| value + key.factor * entered.unwrap_or(0.0));
                Change { name: key.name, from, by: key.factor * by, unit: key.unit }
            }
            None => Change {
                name: match kind.coefficient_names() {
                    [_] => Text::same(cause.effect.as_str()),
                    _ => Text::same(format!("{} {}", cause.effect, without_unit(name))),
                },
                from: entered,
                by,
                unit: unit(name),
            },
        }
    };
    term.coefficients().map(change).collect()
}

/// A key of the profile, outside `[[effect]]`, that holds the first coefficient of an effect.
struct Key {
    name: Text,
    /// `None` where tables hold it instead.
    value: Option<f64>,
    /// Key by coefficient.
    factor: f64,
    unit: &'static str,
}

fn key(kind: EffectKind, profile: &Profile) -> Option<Key> {
    const LINEAR: [char; 3] = ['X', 'Y', 'Z'];
    let machine = &profile.description;
    Some(match kind {
        EffectKind::Squareness(first, second) => {
            let (name, rad) = match (first, second) {
                (0, 1) => ("EC0Y", machine.squareness.ec0y_rad),
                (0, _) => ("EB0Z", machine.squareness.eb0z_rad),
                _ => ("EA0Z", machine.squareness.ea0z_rad),
            };
            Key { name: Text::pair(name, name), value: Some(1e6 * rad), factor: 1.0, unit: "µrad" }
        }
        // The reversal value is twice the half width; equation (9), "Direction".
        EffectKind::Backlash(axis) => {
            let data = &machine.linear[axis];
            let value = data.errors_negative.is_none().then_some(1e3 * data.backlash_mm);
            let name = both!("play of {}", "люфт {}", LINEAR[axis]);
            Key { name, value, factor: 2.0, unit: "µm" }
        }
        EffectKind::Rotary { component, axis } => {
            let rotary = &machine.rotary[axis];
            let (value, unit) = match component {
                0..=2 => (1e3 * rotary.shift_mm[component], "µm"),
                _ => (1e6 * rotary.tilt_rad[component - 3], "µrad"),
            };
            Key { name: Text::same(symbol(kind)), value: Some(value), factor: 1.0, unit }
        }
        _ => return None,
    })
}

/// `EX0C` of `rotary.EX0C`.
fn symbol(kind: EffectKind) -> String {
    let id = kind.to_string();
    id.rsplit_once('.').map_or_else(|| id.clone(), |(_, symbol)| symbol.to_owned())
}

/// What the profile's own entries of an effect say of a coefficient, summed: a second entry adds to the first.
fn entered(profile: &Profile, effect: &str, coefficient: &str) -> Option<f64> {
    let entries = profile.effects.iter().filter(|entry| entry.id == effect);
    let values = entries.flat_map(|entry| &entry.parameters).filter(|(name, _)| name == coefficient);
    values.map(|(_, value)| *value).reduce(|sum, value| sum + value)
}

/// Units as the names of coefficients end, and as people write them.
const UNITS: [(&str, &str); 13] = [
    ("_um_per_m_k", "µm/(m·K)"),
    ("_um_per_m_k2", "µm/(m·K²)"),
    ("_um_per_kg2", "µm/kg²"),
    ("_um_per_kg", "µm/kg"),
    ("_um_per_h2", "µm/h²"),
    ("_um_per_h", "µm/h"),
    ("_um_per_k", "µm/K"),
    ("_um_per_m_s2", "µm/(m/s²)"),
    ("_um_per_m", "µm/m"),
    ("_ms_per_m_min", "ms/(m/min)"),
    ("_ms", "ms"),
    ("_urad", "µrad"),
    ("_um", "µm"),
];

fn unit_of(name: &str) -> Option<&'static (&'static str, &'static str)> {
    UNITS.iter().find(|(end, _)| name.ends_with(end))
}

fn unit(name: &str) -> &'static str {
    unit_of(name).map_or("", |(_, unit)| unit)
}

fn without_unit(name: &str) -> &str {
    unit_of(name).and_then(|(end, _)| name.strip_suffix(end)).unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use diagnostic::Language;

    use super::*;

    #[test]
    fn every_coefficient_of_the_library_has_a_unit() {
        for kind in EffectKind::all() {
            for name in kind.coefficient_names() {
                assert!(unit_of(name).is_some(), "{name}");
            }
        }
    }

    #[test]
    fn a_change_says_from_and_to() {
        let change = Change { name: Text::pair("EC0Y", "EC0Y"), from: Some(85.0), by: 63.0, unit: "µrad" };
        assert_eq!(change.text().english(), "EC0Y 85.0 → 148.0 µrad");
        assert_eq!(change.text().in_language(Language::Russian), "EC0Y 85.0 → 148.0 мкрад");
        let change =
            Change { name: Text::pair("play of Y", "люфт Y"), from: None, by: 11.2, unit: "µm" };
        assert_eq!(change.text(), Text::pair("play of Y +11.2 µm", "люфт Y +11.2 мкм"));
        assert_eq!(unit_text("ms/(m/min)"), Text::pair("ms/(m/min)", "мс/(м/мин)"));
        assert_eq!(unit_text("µm/(m/s²)"), Text::pair("µm/(m/s²)", "мкм/(м/с²)"));
    }
}
