//! What the TOML reader found, said in the product's way.

use diagnostic::{Diagnostic, both, of_toml};

use crate::error::{KEY, SYNTAX, VALUE, span};

/// The reader's error with its place, and the key that was probably meant.
pub(crate) fn diagnostic(text: &str, error: &toml::de::Error) -> Diagnostic {
    let message = error.message();
    let whole = error.span();
    let parsed = toml::de::DeTable::parse(text).is_ok();
    if !parsed {
        let mut diagnostic = Diagnostic::error(
            SYNTAX,
            both!("the profile is not TOML: {}", "профиль — не TOML: {:#}", of_toml(message)),
        );
        if let Some(place) = &whole {
            diagnostic = diagnostic.at(span(place), both!("here", "здесь"));
        }
        return diagnostic;
    }
    if let Some(rest) = message.strip_prefix("unknown field ") {
        let mut names = rest.split('`').skip(1).step_by(2);
        let typed = names.next().unwrap_or_default().to_owned();
        let known: Vec<&str> = names.collect();
        let mut diagnostic =
            Diagnostic::error(KEY, both!("unknown key `{typed}`", "незнакомый ключ `{typed}`"));
        if let Some(place) = &whole {
            diagnostic = diagnostic
                .at(span(place), both!("not a key of this table", "такого ключа в этом разделе нет"));
        }
        return diagnostic.help(match diagnostic::closest(&typed, known.iter().copied()) {
            Some(near) => both!(
                "did you mean `{near}`? Known here: {}",
                "имелось в виду `{near}`? Здесь известны: {}",
                known.join(", ")
            ),
            None => both!("known here: {}", "здесь известны: {}", known.join(", ")),
        });
    }
    let code =
        if message.starts_with("missing field") || message.starts_with("duplicate") { KEY } else { VALUE };
    let message = match message.strip_prefix("missing field ") {
        Some(name) => both!("the profile lacks the key {name}", "в профиле нет ключа {name}"),
        None => of_toml(message),
    };
    let mut diagnostic = Diagnostic::error(code, message);
    if let Some(place) = whole.filter(|place| place.len() < text.len() || place.len() < 200) {
        diagnostic = diagnostic.at(span(&place), both!("here", "здесь"));
    }
    diagnostic
}
