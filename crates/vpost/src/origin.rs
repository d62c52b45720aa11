//! What every page says of where its numbers come from: how the machine was measured, and the command.

use diagnostic::{Language, say};
use machine_profile::{Calibrated, Profile};
use maud::{Markup, html};
use report::text::{Numbers, shown};

/// When, how warm and with what a machine was measured, and how sure its model is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Origin {
    calibrated: Calibrated,
}

/// Options that say where a result goes: a page is the same wherever it is written.
const WRITES: [&str; 10] = [
    "-o",
    "--output",
    "--html",
    "--viewer",
    "--json",
    "--csv",
    "--vtk",
    "--write-profile",
    "--summary",
    "--against",
];

impl Origin {
    pub(crate) fn of(profile: &Profile) -> Self {
        Self { calibrated: profile.calibrated.clone().unwrap_or_default() }
    }

    /// What is known of it, each with its name, and the names of what is not.
    fn parts(&self, language: Language) -> ([(String, Option<String>); 4], Option<String>) {
        let c = &self.calibrated;
        let short = |value: f64| language.figures(crate::number::short(value, 2));
        let um = |value: f64| say!(language, "{} \u{b5}m", "{} мкм", short(value));
        let rows = [
            (say!(language, "date", "дата"), c.date.clone()),
            (say!(language, "instrument", "прибор"), c.instrument.clone()),
            (
                say!(language, "temperature", "температура"),
                c.temperature_c.map(|t| format!("{} \u{b0}C", short(t))),
            ),
            (say!(language, "uncertainty", "неопределённость"), c.uncertainty_um.map(um)),
        ];
        (rows, c.repeatability_um.map(um))
    }

    /// One line for the first screen.
    pub(crate) fn line(&self, language: Language) -> Markup {
        html! { p.muted { (shown(&self.said(language))) } }
    }

    /// The same as text.
    pub(crate) fn said(&self, language: Language) -> String {
        let (rows, _) = self.parts(language);
        let known: Vec<String> =
            rows.iter().filter_map(|(name, value)| Some(format!("{name} {}", value.as_ref()?))).collect();
        let missing: Vec<&str> =
            rows.iter().filter(|(_, value)| value.is_none()).map(|(name, _)| name.as_str()).collect();
        let mut said = String::new();
        if !known.is_empty() {
            said = say!(language, "Calibration: {}.", "Калибровка: {}.", known.join(", "));
        }
        if !missing.is_empty() {
            let missing = missing.join(", ");
            said.push_str(if said.is_empty() { "" } else { " " });
            said.push_str(&say!(
                language,
                "The profile does not say of its calibration: {missing}.",
                "О калибровке в профиле не сказано: {missing}."
            ));
        }
        said
    }

    /// Rows for the section that says where the numbers come from.
    pub(crate) fn rows(&self, language: Language) -> Markup {
        let (rows, repeats) = self.parts(language);
        html! {
            @for (name, value) in rows {
                dt { (say!(language, "calibration: {name}", "калибровка: {name}")) }
                dd {
                    @match value {
                        Some(value) => (shown(&value)),
                        None => span.muted { (say!(language, "not stated in the profile", "в профиле не указано")) },
                    }
                }
            }
            @if let Some(repeats) = repeats {
                dt { (say!(language, "calibration: repeatability", "калибровка: повторяемость")) } dd { (repeats) }
            }
            (command_row(language))
        }
    }
}

/// The command that made a page.
pub(crate) fn command_row(language: Language) -> Markup {
    html! { dt { (say!(language, "command", "команда")) } dd { code { (shown(&command())) } } }
}

/// The command as it was typed, quoted for a shell; of results the names alone.
pub(crate) fn command() -> String {
    let typed: Vec<String> = std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect();
    quoted(&named(typed))
}

/// Results without the folders that they go to.
fn named(typed: Vec<String>) -> Vec<String> {
    let name = |path: &str| path.rsplit(['/', '\\']).next().unwrap_or(path).to_owned();
    let mut is_result = false;
    typed
        .into_iter()
        .map(|word| {
            let own = std::mem::replace(&mut is_result, WRITES.contains(&word.as_str()));
            match word.split_once('=').filter(|(option, _)| WRITES.contains(option)) {
                Some((option, path)) => format!("{option}={}", name(path)),
                None if own => name(&word),
                None => word,
            }
        })
        .collect()
}

fn quoted(typed: &[String]) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-./,:=+@%".contains(c);
    let word = |word: &String| {
        if !word.is_empty() && word.chars().all(plain) {
            word.clone()
        } else {
            format!("'{}'", word.replace('\'', "'\\''"))
        }
    };
    std::iter::once("vpost".to_owned()).chain(typed.iter().map(word)).collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_command_can_be_typed_again() {
        let typed = ["a b.csv", "--chain", "[w X b Z t]", "it's", "", "-m=x.toml"].map(str::to_owned);
        assert_eq!(super::quoted(&typed), "vpost 'a b.csv' --chain '[w X b Z t]' 'it'\\''s' '' -m=x.toml");
    }

    #[test]
    fn a_page_is_the_same_wherever_it_is_written() {
        let typed =
            ["map", "-m", "in/m.toml", "--html", "/tmp/a/m.html", "--csv=/tmp/b/m.csv"].map(str::to_owned);
        assert_eq!(
            super::named(typed.to_vec()),
            ["map", "-m", "in/m.toml", "--html", "m.html", "--csv=m.csv"]
        );
    }
}
