//! Work offsets that codes choose: by name, by P, by H.

use diagnostic::{Entry, both, refusal};
use nc_dialect::{Action, Dialect};
use nc_syntax::{GCode, Letters, Span};

use crate::codes;
use crate::environment::{BASE_FRAME, Environment};
use crate::modal::{Modal, WorkOffset};
use crate::refusals::settings as refusal;
use crate::words::{Outcome, Words};

/// G15 of Okuma; `length`: a tool length is chosen by H too.
pub(crate) fn by_h(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    (code, span): (GCode, Span),
    length: bool,
) -> Outcome<()> {
    const H: Letters = Letters::of(b"H");
    if length {
        return Err(words.refuse(
            refusal!(codes::WORDS_OF_TWO;
                "{} beside a tool length", "{} рядом с коррекцией на длину", words.text(span);
                "whose is H?", "чьё это H?";
                "write them in two blocks", "напишите их двумя кадрами"
            ),
            words.span(H),
        ));
    }
    let number = match words.whole(b'H')? {
        Some(number) if number > 0 => number,
        given => {
            let message = match given {
                None => both!("{} without H", "{} без H", words.text(span)),
                Some(_) => both!("{} with H0", "{} с H0", words.text(span)),
            };
            return Err(words.refuse(
                refusal!(codes::WORK_OFFSET; message;
                    "a number from 1 was expected", "ожидался номер от 1";
                    "write the number of the work offset as H", "напишите номер смещения нуля словом H"
                ),
                span,
            ));
        }
    };
    let name = name_by_h(code, number);
    let zero_mm = offset(env, state, &name);
    if zero_mm.is_none() {
        return Err(missing_offset(words, &name, span));
    }
    state.work_offset = WorkOffset { code: Some(code), number: Some(number), zero_mm, rewritten: false };
    Ok(())
}

/// G54 and its like; `other`: a P may be another code's.
pub(crate) fn by_name(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    (code, name, span): (GCode, Option<&str>, Span),
    other: bool,
) -> Outcome<()> {
    const P: Letters = Letters::of(b"P");
    const FIRST: GCode = GCode(540);
    let may_be_numbered = name.is_none() || (env.dialect.frames.p_selects_numbered && code == FIRST);
    let number = match words.number(b'P') {
        None if name.is_none() => {
            return Err(words.refuse_code(refusal::WITHOUT_P, span));
        }
        None => None,
        Some(_) if other && !may_be_numbered => None,
        Some(_) if other => {
            return Err(words.refuse(refusal::p_of_two_codes(&words.text(span)), words.span(P)));
        }
        Some(_) if may_be_numbered => words.whole(b'P')?,
        Some(_) => {
            return Err(words.refuse(refusal::p_without_meaning(&words.text(span)), words.span(P)));
        }
    };
    if number == Some(0) {
        return Err(words.refuse(refusal::NO_WORK_OFFSET_P0, words.span(P)));
    }
    let name = match (number, name) {
        (Some(number), _) => numbered(number),
        (None, name) => name.unwrap_or_default().to_owned(),
    };
    let zero_mm = offset(env, state, &name);
    // The base frame may be unknown as long as nothing moves in it.
    if zero_mm.is_none() && name != BASE_FRAME {
        return Err(missing_offset(words, &name, span));
    }
    state.work_offset = WorkOffset { code: Some(code), number, zero_mm, rewritten: false };
    Ok(())
}

/// The refusal of an offset nobody gave.
pub(crate) fn missing_offset(
    words: &Words<'_, '_, '_>,
    name: &str,
    span: Span,
) -> Box<diagnostic::Diagnostic> {
    let entry = Entry::new("work_offsets_mm", None, toml_key(name), "[X, Y, Z]");
    Box::new(words.refuse(refusal::work_offset_not_given(name), span).settled_by(entry))
}

/// A name as a key of the profile: with a point in it it is quoted.
fn toml_key(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if name.chars().all(bare) { name.to_owned() } else { format!("\"{name}\"") }
}

/// The name of a numbered work offset.
pub(crate) fn numbered(number: u32) -> String {
    format!("G54.1P{number}")
}

/// The name of a work offset that H numbers.
pub(crate) fn name_by_h(code: GCode, number: u32) -> String {
    format!("{code}H{number}")
}

/// The zero of a work offset: what the program wrote, else what was given.
pub(crate) fn offset(env: &Environment<'_>, state: &Modal, name: &str) -> Option<[f64; 3]> {
    let written = state.written.iter().find(|(known, _)| known == name).map(|(_, zero)| *zero);
    written.or_else(|| env.setup.work_offset(name))
}

/// The name of a work offset as profiles have it: `G54`, `G54.1 P3`.
#[must_use]
pub fn name_of(dialect: &Dialect, offset: &WorkOffset) -> Option<String> {
    let WorkOffset { code, number, .. } = *offset;
    match (number, dialect.code(code?).map(|entry| &entry.action)) {
        (Some(number), Some(Action::WorkOffsetByH)) => Some(name_by_h(code?, number)),
        (Some(number), _) => Some(numbered(number)),
        (None, Some(Action::WorkOffset(name))) => Some(name.clone()),
        (None, Some(Action::BaseFrame)) => Some(BASE_FRAME.to_owned()),
        _ => None,
    }
}
