//! The grammars that come with the program.

use std::sync::LazyLock;

use crate::control::Dialect;

use crate::load;
use crate::texts::TEXTS;

static DIALECTS: LazyLock<Vec<Dialect>> = LazyLock::new(|| {
    // A text that could not be loaded would be missing here; the test below proves that none is.
    TEXTS.iter().filter_map(|(name, text)| load(name, text).ok()).collect()
});

/// A shipped dialect by name.
#[must_use]
pub fn builtin(name: &str) -> Option<&'static Dialect> {
    DIALECTS.iter().find(|dialect| dialect.name == name)
}

/// The names [`builtin`] knows, in alphabetical order.
#[must_use]
pub fn builtin_names() -> Vec<&'static str> {
    TEXTS.iter().map(|(name, _)| *name).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shipped_grammar_loads() {
        for (name, text) in TEXTS {
            let loaded = load(name, text).map_err(|wrong| format!("{name}: {wrong:#?}"));
            assert!(loaded.is_ok(), "{}", loaded.unwrap_err());
            assert!(builtin(name).is_some());
        }
        assert!(builtin("no such").is_none());
    }
}
