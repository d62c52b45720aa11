//! What every page says of where its numbers come from: how the machine was measured, and the command.

use diagnostic::{Text, both};
use machine_profile::{Calibrated, Profile};
use report::body::Fact;
use report::numbers::figures;

pub(crate) use report::text::{MACHINE, MEASUREMENTS};

use crate::figures::{celsius, short};

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

    /// What is known of it, each with its name.
    fn parts(&self) -> [(Text, Option<Text>); 4] {
        let c = &self.calibrated;
        [
            (both!("date", "дата"), c.date.as_ref().map(Text::same)),
            (both!("instrument", "прибор"), c.instrument.as_ref().map(Text::same)),
            (both!("temperature", "температура"), c.temperature_c.map(celsius)),
            (both!("uncertainty", "неопределённость"), c.uncertainty_um.map(um)),
        ]
    }

    /// In a line.
    pub(crate) fn said(&self) -> Text {
        let parts = self.parts();
        let known = parts.iter().filter_map(|(name, value)| Some(Text::join([name, value.as_ref()?], " ")));
        let known = Text::join(&known.collect::<Vec<_>>(), ", ");
        let missing = parts.iter().filter(|(_, value)| value.is_none()).map(|(name, _)| name);
        let missing = Text::join(missing, ", ");
        let said = [
            (known.is_empty(), both!("Calibration: {known}.", "Калибровка: {known:#}.")),
            (
                missing.is_empty(),
                both!(
                    "The profile does not say of its calibration: {missing}.",
                    "О калибровке в профиле не сказано: {missing:#}."
                ),
            ),
        ];
        Text::join(said.iter().filter(|(is_nothing, _)| !is_nothing).map(|(_, text)| text), " ")
    }

    /// For the section that says where the numbers come from.
    pub(crate) fn facts(&self) -> Vec<Fact> {
        let one = |(name, value): (Text, Option<Text>)| {
            let name = both!("calibration: {name}", "калибровка: {name:#}");
            value.map_or_else(
                || Fact::unknown(name.clone(), both!("not stated in the profile", "в профиле не указано")),
                |value| Fact::new(name.clone(), &value),
            )
        };
        let repeats = both!("calibration: repeatability", "калибровка: повторяемость");
        let mut all: Vec<Fact> = self.parts().map(one).into();
        all.extend(self.calibrated.repeatability_um.map(|value| Fact::new(repeats, &um(value))));
        all.push(command_fact());
        all
    }
}

fn um(value: f64) -> Text {
    let value = figures(short(value, 2));
    both!("{value} \u{b5}m", "{value:#} мкм")
}

/// The command that made a page.
pub(crate) fn command_fact() -> Fact {
    Fact::typed(both!("command", "команда"), command())
}

/// Names that stand in every page's last section.
pub(crate) const PROFILE: Text = Text::pair("profile and its tables", "профиль и его таблицы");
pub(crate) const MODEL: Text = Text::pair("model", "модель");

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
