//! The grammars that come with the program.

use std::sync::LazyLock;

use nc_syntax::Dialect;

use crate::load;

/// Names and texts, in alphabetical order.
pub(crate) const TEXTS: [(&str, &str); 16] = [
    ("balt-system", include_str!(concat!(env!("GRAMMARS"), "/balt-system.toml"))),
    ("centroid", include_str!(concat!(env!("GRAMMARS"), "/centroid.toml"))),
    ("fagor", include_str!(concat!(env!("GRAMMARS"), "/fagor.toml"))),
    ("fanuc", include_str!(concat!(env!("GRAMMARS"), "/fanuc.toml"))),
    ("fanuc-lathe", include_str!(concat!(env!("GRAMMARS"), "/fanuc-lathe.toml"))),
    ("grbl", include_str!(concat!(env!("GRAMMARS"), "/grbl.toml"))),
    ("haas", include_str!(concat!(env!("GRAMMARS"), "/haas.toml"))),
    ("heidenhain-iso", include_str!(concat!(env!("GRAMMARS"), "/heidenhain-iso.toml"))),
    ("linuxcnc", include_str!(concat!(env!("GRAMMARS"), "/linuxcnc.toml"))),
    ("linuxcnc-lathe", include_str!(concat!(env!("GRAMMARS"), "/linuxcnc-lathe.toml"))),
    ("mach", include_str!(concat!(env!("GRAMMARS"), "/mach.toml"))),
    ("mitsubishi", include_str!(concat!(env!("GRAMMARS"), "/mitsubishi.toml"))),
    ("okuma", include_str!(concat!(env!("GRAMMARS"), "/okuma.toml"))),
    ("perspektiva", include_str!(concat!(env!("GRAMMARS"), "/perspektiva.toml"))),
    ("sinumerik", include_str!(concat!(env!("GRAMMARS"), "/sinumerik.toml"))),
    ("sinumerik-turn", include_str!(concat!(env!("GRAMMARS"), "/sinumerik-turn.toml"))),
];

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
