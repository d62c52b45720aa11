//! Words of a block: which there are, and what they are for.

use diagnostic::{Code, Diagnostic, both};
use nc_dialect::{Action, CodeEntry, Dialect, MOTION_GROUP};
use nc_syntax::{Block, GCode, ItemKind, Span, Value};

/// A word that cannot be edited: missing, doubled, or not a plain number.
pub(crate) const WORD_NOT_EDITABLE: Code = Code(603);
/// G9: exact stop, at the end of this block's motion only.
const EXACT_STOP: GCode = GCode(90);

/// The only word of that letter, or `None`.
pub(crate) fn find_word(block: &Block<'_>, wanted: u8) -> Result<Option<(Span, Value)>, Diagnostic> {
    let mut found = None;
    for item in &block.items {
        let ItemKind::Word { letter, value } = item.kind else { continue };
        if letter != wanted {
            continue;
        }
        if found.is_some() {
            let letter = char::from(wanted);
            return Err(Diagnostic::error(
                WORD_NOT_EDITABLE,
                both!("the block has two {letter} words", "в кадре два слова {letter}"),
            )
            .at(block.file_span(item.span), both!("second {letter}", "второе {letter}"))
            .help(both!("leave one of them", "оставьте одно")));
        }
        found = Some((item.span, value));
    }
    Ok(found)
}

/// A word that should be there is not.
pub(crate) fn missing(block: &Block<'_>, letter: u8) -> Diagnostic {
    Diagnostic::error(
        WORD_NOT_EDITABLE,
        both!(
            "the block has no {} word to keep",
            "в кадре нет слова {}, которое надо сохранить",
            char::from(letter)
        ),
    )
    .at(block.file_range(), both!("this block", "этот кадр"))
    .help(both!(
        "this is a fault of vpost; please report it with the program",
        "это ошибка vpost; сообщите о ней, приложив программу"
    ))
}

/// A word whose value is no plain number cannot be replaced by one.
pub(crate) fn not_a_number(block: &Block<'_>, letter: u8, span: Span) -> Diagnostic {
    Diagnostic::error(
        WORD_NOT_EDITABLE,
        both!(
            "{} has no plain number, so it cannot be corrected",
            "у {} не простое число, исправить его нельзя",
            char::from(letter)
        ),
    )
    .at(block.file_span(span), both!("expected a number such as 10.5", "ожидалось число, например 10.5"))
    .help(both!("write the value as a number", "напишите значение числом"))
}

/// The code of a G word.
pub(crate) fn g_code(kind: ItemKind) -> Option<GCode> {
    let ItemKind::Word { letter: b'G', value: Value::Number(number) } = kind else { return None };
    number.tenths().map(GCode)
}

/// The code of a G word of the motion group.
pub(crate) fn motion_code(dialect: &Dialect, kind: ItemKind) -> Option<GCode> {
    g_code(kind).filter(|code| dialect.code(*code).is_some_and(is_motion))
}

/// Executed after the block's motion: belongs on the last piece.
pub(crate) fn is_after_motion(dialect: &Dialect, kind: ItemKind) -> bool {
    match kind {
        ItemKind::Word { letter: b'M', value: Value::Number(number) } => number
            .integer()
            .and_then(|number| dialect.m_code(u16::try_from(number).ok()?))
            .is_some_and(|code| code.after_motion),
        _ => g_code(kind) == Some(EXACT_STOP),
    }
}

/// G0 to G3 and the cycles: some dialects keep the cycles in a group of their own, yet they and the other
/// motion codes exclude each other all the same. G80 only where it is one of G0's group.
pub(crate) fn is_motion(entry: &CodeEntry) -> bool {
    entry.group == MOTION_GROUP || matches!(entry.action, Action::Cycle(_))
}
