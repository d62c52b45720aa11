//! The language people are spoken to in.
//!
//! Codes, keys of JSON and comments in NC programs are English in every language.

use clap::ValueEnum;

use crate::values::Value;

/// A language of messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Language {
    /// English.
    #[value(name = "en")]
    English,
    /// Russian.
    #[value(name = "ru")]
    Russian,
}

impl Value for Language {
    const WHAT: &'static str = "a language that vpost speaks";
    const EXAMPLES: &'static [&'static str] = &["en", "ru"];

    fn read(text: &str) -> Result<Self, Option<String>> {
        Self::from_str(text, false).map_err(|_| None)
    }
}

impl Language {
    /// What was asked for, else what the environment says.
    pub(crate) fn chosen(asked: Option<Self>) -> Self {
        asked.unwrap_or_else(|| Self::of_environment(|name| std::env::var(name).ok()))
    }

    /// The language of messages by POSIX: the first of `LC_ALL`, `LC_MESSAGES`, `LANG` that is set and not empty.
    ///
    /// A locale that vpost does not know is English: it was set for all programs, and none of them fails by it.
    fn of_environment(variable: impl Fn(&str) -> Option<String>) -> Self {
        let set = |name| variable(name).filter(|value| !value.is_empty());
        ["LC_ALL", "LC_MESSAGES", "LANG"]
            .into_iter()
            .find_map(set)
            .map_or(Self::English, |l| Self::of_locale(&l))
    }

    /// The language of a locale's name, `language[_TERRITORY][.CODESET][@modifier]`.
    fn of_locale(locale: &str) -> Self {
        let language = locale.split(['_', '.', '@', '-']).next().unwrap_or_default();
        if language.eq_ignore_ascii_case("ru") { Self::Russian } else { Self::English }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_locale_is_russian_or_english() {
        for locale in ["ru", "ru_RU", "ru_RU.UTF-8", "ru_UA.KOI8-U", "ru@x", "RU_ru", "ru-RU"] {
            assert_eq!(Language::of_locale(locale), Language::Russian, "{locale}");
        }
        for locale in ["C", "POSIX", "C.UTF-8", "en_US.UTF-8", "run", "de_DE", "rue_SK", "нет", "."] {
            assert_eq!(Language::of_locale(locale), Language::English, "{locale}");
        }
    }

    #[test]
    fn the_first_variable_that_is_set_decides() {
        let of = |set: &[(&str, &str)]| {
            Language::of_environment(|name| {
                set.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned())
            })
        };
        assert_eq!(of(&[]), Language::English);
        assert_eq!(of(&[("LANG", "ru_RU.UTF-8")]), Language::Russian);
        assert_eq!(of(&[("LANG", "ru_RU.UTF-8"), ("LC_MESSAGES", "C")]), Language::English);
        assert_eq!(of(&[("LC_ALL", ""), ("LC_MESSAGES", "ru"), ("LANG", "C")]), Language::Russian);
        assert_eq!(of(&[("LC_ALL", "C"), ("LC_MESSAGES", "ru")]), Language::English);
    }
}
