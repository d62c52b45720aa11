//! The language that people are spoken to in.

/// A language of messages.
///
/// Codes, keys of JSON and comments in NC programs are English in every language.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Language {
    /// English.
    #[default]
    English,
    /// Russian.
    Russian,
}

impl Language {
    /// All that are spoken.
    pub const ALL: [Self; 2] = [Self::English, Self::Russian];

    /// As `--lang` names it: the code of ISO 639-1.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Russian => "ru",
        }
    }

    /// The language of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|language| language.name().eq_ignore_ascii_case(name))
    }

    /// The language of a locale's name, `language[_TERRITORY][.CODESET][@modifier]` or `language-TERRITORY`; English
    /// where vpost does not know it.
    #[must_use]
    pub fn of_locale(locale: &str) -> Self {
        Self::from_name(locale.split(['_', '.', '@', '-']).next().unwrap_or_default()).unwrap_or_default()
    }
}

/// The form of a Russian noun that stands behind a number: 1 строка, 2 строки, 5 строк, 11 строк, 21 строка.
///
/// * `forms` – behind 1, behind 2, behind 5
///
/// ```
/// let lines = |count| diagnostic::russian_plural(count, ["строка", "строки", "строк"]);
/// assert_eq!([1, 2, 5, 11, 14, 21, 102, 0].map(lines), [
///     "строка", "строки", "строк", "строк", "строк", "строка", "строки", "строк",
/// ]);
/// ```
#[must_use]
pub const fn russian_plural(count: u64, forms: [&'static str; 3]) -> &'static str {
    let [one, few, many] = forms;
    match (count % 10, count % 100) {
        (_, 11..=14) => many,
        (1, _) => one,
        (2..=4, _) => few,
        _ => many,
    }
}
