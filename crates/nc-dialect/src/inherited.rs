//! A table that says in what it differs from a shipped one.

use std::ops::Range;

use diagnostic::{Code, Diagnostic, Text, both, of_toml};
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, Error};

use crate::checks::wide;
use crate::table::Grammar;
use crate::texts::TEXTS;

/// Where the fields are described.
pub(crate) const EVERY_FIELD: Text = Text::pair(
    "docs/dialects.md lists every field of a grammar",
    "все поля таблицы диалекта описаны в docs/dialects.md",
);
/// The key that names the other table.
const EXTENDS: &str = "extends";

/// Reads a grammar: what it says, and beneath that what the table that it extends says.
///
/// A field of a section, and a row of a list, counts whole as it is written here; all others are the other table's. Their
/// places are that of the other table's name, so that every message has a place in `text`.
///
/// # Errors
/// VP0801 what TOML or the field list refuses, or a table that there is not.
pub(crate) fn read(text: &str) -> Result<Grammar, Diagnostic> {
    let mut own = DeTable::parse(text).map_err(|error| refused(&error))?;
    let extends = own
        .get_ref()
        .get(EXTENDS)
        .and_then(|value| Some((value.get_ref().as_str()?.to_owned(), value.span())));
    let mut names = Vec::new();
    if let Some((name, place)) = extends {
        let mut base = shipped(&name, &place)?;
        // A shipped table that itself extends one: the names of all of them, the nearest first.
        names.push(name);
        while let Some(next) = base.get(EXTENDS).and_then(|value| Some(value.get_ref().as_str()?.to_owned()))
        {
            base.remove(EXTENDS);
            let mut beneath = shipped(&next, &place)?;
            lay_over(&mut beneath, std::mem::take(&mut base), true);
            base = beneath;
            names.push(next);
        }
        let span = own.span();
        lay_over(&mut base, own.into_inner(), true);
        own = Spanned::new(span, base);
    }
    Grammar::deserialize(Deserializer::from(own)).map_err(|error| refused(&error))
}

/// A shipped table, all places in it those of its name.
fn shipped(name: &str, place: &Range<usize>) -> Result<DeTable<'static>, Diagnostic> {
    let Some((_, text)) = TEXTS.iter().find(|(known, _)| *known == name) else {
        let names: Vec<&str> = TEXTS.iter().map(|(known, _)| *known).collect();
        let message = both!(
            "there is no shipped grammar `{name}` to extend",
            "поставляемой таблицы диалекта `{name}`, которую можно дополнить, нет"
        );
        return Err(Diagnostic::error(Code(801), message)
            .at(wide(place.clone()), both!("no such grammar", "такой таблицы нет"))
            .help(both!("write one of {}", "напишите одно из: {}", names.join(", "))));
    };
    let table = DeTable::parse(text).map_err(|error| refused(&error))?;
    Ok(placed(table.into_inner(), place))
}

/// The same table with one place for all of it.
fn placed<'i>(table: DeTable<'i>, place: &Range<usize>) -> DeTable<'i> {
    let at = |key: Spanned<_>| Spanned::new(place.clone(), key.into_inner());
    table.into_iter().map(|(key, value)| (at(key), placed_value(value, place))).collect()
}

fn placed_value<'i>(value: Spanned<DeValue<'i>>, place: &Range<usize>) -> Spanned<DeValue<'i>> {
    let value = match value.into_inner() {
        DeValue::Table(table) => DeValue::Table(placed(table, place)),
        DeValue::Array(array) => {
            DeValue::Array(array.into_iter().map(|value| placed_value(value, place)).collect())
        }
        other => other,
    };
    Spanned::new(place.clone(), value)
}

/// What `over` says in place of what `table` says; section by section where `sections`.
fn lay_over<'i>(table: &mut DeTable<'i>, over: DeTable<'i>, sections: bool) {
    for (key, value) in over {
        let (place, value) = (value.span(), value.into_inner());
        match (table.get_mut(key.get_ref().as_ref()).map(Spanned::get_mut), value) {
            (Some(DeValue::Table(beneath)), DeValue::Table(own)) if sections => lay_over(beneath, own, false),
            (_, value) => {
                table.remove(key.get_ref().as_ref());
                table.insert(key, Spanned::new(place, value));
            }
        }
    }
}

fn refused(error: &Error) -> Diagnostic {
    let diagnostic = Diagnostic::error(
        Code(801),
        both!(
            "the grammar cannot be read: {}",
            "таблица диалекта не читается: {:#}",
            of_toml(error.message().trim())
        ),
    )
    .help(EVERY_FIELD);
    match error.span() {
        Some(span) => diagnostic.at(wide(span), both!("here", "здесь")),
        None => diagnostic,
    }
}
