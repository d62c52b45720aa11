//! Effects on a page, by name: ids are for profiles and programs.

use diagnostic::{Language, Text};
use gap_diagnosis::effect_name;
use machine_model::effects::EffectKind;
use maud::html;
use report::body::Body;
use report::numbers::prose as said;
use report::text::{opening, shown};

/// The name of an effect of mills or of a cause of lathes; of what neither knows, its id.
pub(super) fn named(id: &str) -> Text {
    id.parse::<EffectKind>().map_or_else(|_| calibration::turning::cause_name(id), |kind| effect_name(&kind))
}

/// The heading of a cause: its name, and the id that is typed where that is another.
pub(super) fn cause_heading(out: &mut Body, name: &Text, id: &str) {
    let is_known = name.in_language(out.language()) != id;
    let opened = opening(name);
    let name = if is_known { opened.in_language(out.language()) } else { id };
    out.add(&html! { h3 { (shown(name)) @if is_known { " " code.muted { (shown(id)) } } } });
}

/// [`said`] in which effects stand by their names, as quotations: those are not declined.
pub(super) fn prose(text: &Text) -> Text {
    let said = said(text);
    Text::new(said.english().to_owned(), in_words(said.in_language(Language::Russian)))
}

fn in_words(text: &str) -> String {
    let is_of_id = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '.');
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(start) = rest.find(is_of_id) {
        let length = rest[start..].find(|c| !is_of_id(c)).unwrap_or(rest.len() - start);
        let (before, word) = (&rest[..start], &rest[start..start + length]);
        // The full stop of a sentence is none of an id.
        let id = word.trim_end_matches('.');
        let name = named(id);
        let name = name.in_language(Language::Russian);
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
        assert_eq!(in_words(said), named);
    }
}
