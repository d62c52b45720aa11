//! Which language people are spoken to in.
//!
//! Codes, keys of JSON and comments in NC programs are English in every language.

use std::ffi::OsString;

use diagnostic::Language;

/// What was asked for, else what the environment says.
pub(crate) fn chosen(asked: Option<Language>) -> Language {
    asked.unwrap_or_else(|| of_environment(|name| std::env::var(name).ok()))
}

/// The language in which to say that the arguments are wrong: they may ask for one all the same.
pub(crate) fn of_arguments(arguments: &[OsString]) -> Language {
    let mut texts = arguments.iter().filter_map(|argument| argument.to_str());
    let mut asked = None;
    while let Some(text) = texts.next() {
        match text.strip_prefix("--lang") {
            Some("") => asked = texts.next().and_then(Language::from_name).or(asked),
            Some(rest) => asked = rest.strip_prefix('=').and_then(Language::from_name).or(asked),
            None if text == "--" => break,
            None => {}
        }
    }
    chosen(asked)
}

/// The language of messages by POSIX: the first of `LC_ALL`, `LC_MESSAGES`, `LANG` that is set and not empty.
///
/// A locale that vpost does not know is English: it was set for all programs, and none of them fails by it.
fn of_environment(variable: impl Fn(&str) -> Option<String>) -> Language {
    let set = |name| variable(name).filter(|value| !value.is_empty());
    ["LC_ALL", "LC_MESSAGES", "LANG"]
        .into_iter()
        .find_map(set)
        .map_or(Language::English, |l| Language::of_locale(&l))
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
            of_environment(|name| {
                set.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).to_owned())
            })
        };
        assert_eq!(of(&[]), Language::English);
        assert_eq!(of(&[("LANG", "ru_RU.UTF-8")]), Language::Russian);
        assert_eq!(of(&[("LANG", "ru_RU.UTF-8"), ("LC_MESSAGES", "C")]), Language::English);
        assert_eq!(of(&[("LC_ALL", ""), ("LC_MESSAGES", "ru"), ("LANG", "C")]), Language::Russian);
        assert_eq!(of(&[("LC_ALL", "C"), ("LC_MESSAGES", "ru")]), Language::English);
    }

    #[test]
    fn wrong_arguments_may_ask_for_a_language() {
        let of = |arguments: &[&str]| of_arguments(&arguments.iter().map(OsString::from).collect::<Vec<_>>());
        assert_eq!(of(&["vpost", "--lang", "ru", "--nonsense"]), Language::Russian);
        assert_eq!(of(&["vpost", "--lang=ru", "--lang", "en"]), Language::English);
        assert_eq!(of(&["vpost", "--lang=ru", "--lang", "xx"]), Language::Russian);
    }
}
