//! Entries of a profile that settle refusals.

use crate::{Text, both};

/// An entry of the profile that settles a refusal.
///
/// Refusals that wait for entries of one table are settled together: who sees them all writes the table once.
///
/// ```
/// use diagnostic::Entry;
///
/// let length = |name: &str| Entry::new("tool", Some("lengths_mm"), name, "120.0");
/// let all = [length("H1"), length("H7")];
/// assert!(all[0].is_beside(&all[1]));
/// assert_eq!(
///     Entry::written(&all).english(),
///     "`lengths_mm = { H1 = 120.0, H7 = 120.0 }` under `[tool]` in the profile",
/// );
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entry {
    /// The section of the profile.
    pub section: String,
    /// The table within the section, where the entry is not the section's own.
    pub key: Option<String>,
    /// What is missing: `H7`, `G55`.
    pub name: String,
    /// A value as it is written there.
    pub value: String,
}

impl Entry {
    /// An entry of a section, or of a table in it.
    #[must_use]
    pub fn new(section: &str, key: Option<&str>, name: impl Into<String>, value: &str) -> Self {
        Self {
            section: section.to_owned(),
            key: key.map(str::to_owned),
            name: name.into(),
            value: value.to_owned(),
        }
    }

    /// Both stand in one table.
    #[must_use]
    pub fn is_beside(&self, other: &Self) -> bool {
        (&self.section, &self.key) == (&other.section, &other.key)
    }

    /// Entries of one table as the profile has them.
    #[must_use]
    pub fn written(entries: &[Self]) -> Text {
        let Some(first) = entries.first() else { return Text::EMPTY };
        let section = &first.section;
        let pairs: Vec<String> =
            entries.iter().map(|entry| format!("{} = {}", entry.name, entry.value)).collect();
        let written = match &first.key {
            Some(key) => format!("`{key} = {{ {} }}`", pairs.join(", ")),
            None => format!("`{}`", pairs.join("`, `")),
        };
        both!("{written} under `[{section}]` in the profile", "{written} в разделе `[{section}]` профиля")
    }
}
