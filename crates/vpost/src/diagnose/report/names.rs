//! Effects on a page, by name: ids are for profiles and programs.

use diagnostic::{Language, Text};
use gap_diagnosis::effect_name;
use machine_model::effects::EffectKind;
use maud::{Markup, html};
use report::text::{Numbers, opening, shown};

/// The name of an effect; of what the library does not know, its id.
pub(super) fn named(id: &str, language: Language) -> String {
    id.parse::<EffectKind>()
        .map_or_else(|_| id.to_owned(), |kind| effect_name(&kind).in_language(language).to_owned())
}

/// The heading of a cause: its name, and the id that is typed where that is another.
pub(in crate::diagnose) fn cause_heading(name: &str, id: &str) -> Markup {
    html! {
        h3 { @if name == id { (shown(id)) } @else { (opening(name)) " " code.muted { (shown(id)) } } }
    }
}

/// [`Numbers::prose`] in which effects stand by their names, as quotations: those are not declined.
pub(super) fn prose(text: &Text, language: Language) -> String {
    in_words(&language.prose(text), language)
}

fn in_words(text: &str, language: Language) -> String {
    if language == Language::English {
        return text.to_owned();
    }
    let is_of_id = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '.');
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(is_of_id) {
        let length = rest[start..].find(|c| !is_of_id(c)).unwrap_or(rest.len() - start);
        let (before, word) = (&rest[..start], &rest[start..start + length]);
        // The full stop of a sentence is none of an id.
        let id = word.trim_end_matches('.');
        let name = named(id, language);
        out.push_str(before);
        if name == id {
            out.push_str(word)
        } else {
            out.push_str(&format!("«{name}»{}", &word[id.len()..]))
        }
        rest = &rest[start + length..];
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_in_a_sentence_become_names() {
        let said = "объясняет squareness.XY, scale.X, остаётся 12.3 мкм; не отличить от angular.ECX. Файл scale.Xs, -1.5";
        let named = "объясняет «перпендикулярность XY», «масштаб X», остаётся 12.3 мкм; не отличить от «угол ECX». Файл scale.Xs, -1.5";
        assert_eq!(in_words(said, Language::Russian), named);
        assert_eq!(in_words(said, Language::English), said);
    }
}
