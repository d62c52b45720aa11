//! LinuxCNC's O-words: `o100 sub`, `o<name> call [1] [2]`, `o1 while [#1 LT 3]`.

use diagnostic::{Text, both};

use crate::expression::{Expression, Parser};
use crate::value::NameId;

/// An O-word with its label and where it leads.
#[derive(Clone, Debug)]
pub(crate) struct OStatement {
    pub(crate) label: Label,
    pub(crate) word: OWord,
    /// `if` and `elseif`: the next branch. `sub`, `repeat` and the head of `while`: their end. `endwhile`,
    /// `endrepeat` and the foot of `do`: their head.
    pub(crate) next: u32,
    /// Of a branch: the `endif`. Of `break` and `continue`: the loop's end.
    pub(crate) end: u32,
    /// A `while` that closes a `do`.
    pub(crate) foot: bool,
}

/// What stands behind the O.
#[derive(Clone, Debug)]
pub(crate) enum Label {
    /// A number or a name, as text: both name files.
    Known(NameId),
    /// `o[#1] call`
    Computed(Expression),
}

/// The word with its values.
#[derive(Clone, Debug)]
pub(crate) enum OWord {
    Sub,
    EndSub(Option<Expression>),
    Call(Vec<Expression>),
    Return(Option<Expression>),
    If(Expression),
    ElseIf(Expression),
    Else,
    EndIf,
    While(Expression),
    EndWhile,
    Do,
    Repeat(Expression),
    EndRepeat,
    Break,
    Continue,
}

/// Reads an O-word.
pub(crate) fn parse(parser: &mut Parser<'_, '_>) -> Result<OStatement, Text> {
    parser.expect(b'O')?;
    let label = match parser.peek() {
        Some(b'<') => Label::Known(parser.name()?),
        Some(b'0'..=b'9') => {
            let mut digits = Vec::new();
            while let Some(digit @ b'0'..=b'9') = parser.peek() {
                digits.push(digit);
                parser.at += 1;
            }
            let first = digits.iter().position(|digit| *digit != b'0').unwrap_or(digits.len() - 1);
            Label::Known(parser.names.id(&digits[first..]))
        }
        _ => Label::Computed(parser.operand()?),
    };
    let word = word(parser)?;
    if matches!(label, Label::Computed(_)) && !matches!(word, OWord::Call(_)) {
        return Err(both!("only a call may compute its label", "вычислять метку может только вызов"));
    }
    Ok(OStatement { label, word, next: 0, end: 0, foot: false })
}

fn word(parser: &mut Parser<'_, '_>) -> Result<OWord, Text> {
    // Longer words first: `endwhile` is not `end`.
    if parser.word(b"SUB") {
        return Ok(OWord::Sub);
    }
    if parser.word(b"ENDSUB") {
        return Ok(OWord::EndSub(value(parser)?));
    }
    if parser.word(b"RETURN") {
        return Ok(OWord::Return(value(parser)?));
    }
    if parser.word(b"CALL") {
        let mut arguments = Vec::new();
        while parser.peek() == Some(b'[') {
            arguments.push(parser.bracketed()?);
        }
        if arguments.len() > 30 {
            return Err(both!(
                "{} arguments, and a call takes 30",
                "аргументов {}, а вызов принимает 30",
                arguments.len()
            ));
        }
        return Ok(OWord::Call(arguments));
    }
    if parser.word(b"IF") {
        return Ok(OWord::If(parser.bracketed()?));
    }
    if parser.word(b"ELSEIF") {
        return Ok(OWord::ElseIf(parser.bracketed()?));
    }
    if parser.word(b"ELSE") {
        return Ok(OWord::Else);
    }
    if parser.word(b"ENDIF") {
        return Ok(OWord::EndIf);
    }
    if parser.word(b"WHILE") {
        return Ok(OWord::While(parser.bracketed()?));
    }
    if parser.word(b"ENDWHILE") {
        return Ok(OWord::EndWhile);
    }
    if parser.word(b"DO") {
        return Ok(OWord::Do);
    }
    if parser.word(b"REPEAT") {
        return Ok(OWord::Repeat(parser.bracketed()?));
    }
    if parser.word(b"ENDREPEAT") {
        return Ok(OWord::EndRepeat);
    }
    if parser.word(b"BREAK") {
        return Ok(OWord::Break);
    }
    if parser.word(b"CONTINUE") {
        return Ok(OWord::Continue);
    }
    Err(both!("no word of flow follows the label", "за меткой нет слова управления"))
}

fn value(parser: &mut Parser<'_, '_>) -> Result<Option<Expression>, Text> {
    if parser.peek() == Some(b'[') { Ok(Some(parser.bracketed()?)) } else { Ok(None) }
}
