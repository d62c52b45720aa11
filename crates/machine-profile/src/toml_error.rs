//! What the TOML reader found, said in the product's way.

use diagnostic::Diagnostic;

use crate::error::{KEY, SYNTAX, VALUE, span};

/// The reader's error with its place, and the key that was probably meant.
pub(crate) fn diagnostic(text: &str, error: &toml::de::Error) -> Diagnostic {
    let message = error.message();
    let whole = error.span();
    let parsed = toml::de::DeTable::parse(text).is_ok();
    if !parsed {
        let mut diagnostic =
            Diagnostic::error(SYNTAX, format!("the profile is not TOML: {}", one_line(message)));
        if let Some(place) = &whole {
            diagnostic = diagnostic.at(span(place), "here");
        }
        return diagnostic;
    }
    if let Some(rest) = message.strip_prefix("unknown field ") {
        let mut names = rest.split('`').skip(1).step_by(2);
        let typed = names.next().unwrap_or_default().to_owned();
        let known: Vec<&str> = names.collect();
        let mut diagnostic = Diagnostic::error(KEY, format!("unknown key `{typed}`"));
        if let Some(place) = &whole {
            diagnostic = diagnostic.at(span(place), "not a key of this table");
        }
        return diagnostic.help(match diagnostic::closest(&typed, known.iter().copied()) {
            Some(near) => format!("did you mean `{near}`? Known here: {}", known.join(", ")),
            None => format!("known here: {}", known.join(", ")),
        });
    }
    let code =
        if message.starts_with("missing field") || message.starts_with("duplicate") { KEY } else { VALUE };
    let message = match message.strip_prefix("missing field ") {
        Some(name) => format!("the profile lacks the key {name}"),
        // serde speaks of Rust's types.
        None => one_line(message)
            .replace("expected f64", "expected a number")
            .replace("expected i64", "expected a whole number"),
    };
    let mut diagnostic = Diagnostic::error(code, message);
    if let Some(place) = whole.filter(|place| place.len() < text.len() || place.len() < 200) {
        diagnostic = diagnostic.at(span(&place), "here");
    }
    diagnostic
}

fn one_line(message: &str) -> String {
    message.lines().collect::<Vec<_>>().join("; ")
}
