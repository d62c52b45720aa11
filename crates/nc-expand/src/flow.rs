//! Statements of flow and calls: text to what they do.

use diagnostic::{Text, both};
use nc_dialect::{Dialect, Flow};
use nc_syntax::{Block, ItemKind, Macros};

use crate::control::Control;
use crate::expression::{Expression, Parser};
use crate::value::Variable;

/// `#1=…`
pub(crate) fn assignment(parser: &mut Parser<'_, '_>) -> Result<(Expression, Expression), Text> {
    let target = parser.variable()?;
    parser.expect(b'=')?;
    let value = if parser.macros == Macros::Fanuc { parser.expression()? } else { parser.operand()? };
    Ok((target, value))
}

/// Passes over a letter with its value.
pub(crate) fn skip_word(parser: &mut Parser<'_, '_>) -> Result<(), Text> {
    match parser.peek() {
        Some(b'A'..=b'Z') => {
            parser.at += 1;
            parser.operand().map(|_| ())
        }
        Some(b'/') => {
            parser.at += 1;
            Ok(())
        }
        other => Err(both!(
            "`{}` starts no word",
            "с `{}` слово не начинается",
            other.map_or(' ', |byte| byte as char)
        )),
    }
}

/// Statements of custom macro B.
pub(crate) fn fanuc_flow(parser: &mut Parser<'_, '_>) -> Result<Control, Text> {
    if parser.word(b"IF") {
        let condition = parser.bracketed()?;
        if parser.short_word(b"GOTO") {
            return Ok(Control::IfGoto(condition, parser.operand()?));
        }
        if parser.short_word(b"THEN") {
            return Ok(Control::IfThen(condition, vec![assignment(parser)?]));
        }
        return Err(both!("GOTO or THEN was expected", "ожидалось GOTO или THEN"));
    }
    if parser.short_word(b"GOTO") {
        return Ok(Control::Goto(parser.operand()?));
    }
    if parser.short_word(b"WHILE") {
        let condition = Some(parser.bracketed()?);
        if !parser.word(b"DO") {
            return Err(both!("DO was expected", "ожидалось DO"));
        }
        return Ok(Control::While { condition, number: loop_number(parser)?, end: 0 });
    }
    if parser.word(b"DO") {
        return Ok(Control::While { condition: None, number: loop_number(parser)?, end: 0 });
    }
    if parser.short_word(b"END") {
        return Ok(Control::EndWhile { number: loop_number(parser)?, start: 0 });
    }
    Err(both!("this is no statement of this dialect", "такого оператора в этом диалекте нет"))
}

/// The variables that a command of the control reads when it runs, as `DPRNT[X#1[3]]` does.
pub(crate) fn printed(block: &Block<'_>, dialect: &Dialect) -> Vec<Option<Variable>> {
    let commands = block.items.iter().filter(|item| item.kind == ItemKind::BracketCommand);
    let texts = commands.filter(|_| dialect.flow.macros == Macros::Fanuc).map(|item| block.text(item.span));
    // What is set by its number, as `#3006` is, acts whatever it is set to.
    texts.filter(|text| !text.starts_with(b"#")).flat_map(variables).collect()
}

/// The variables that a text names; `None`: one by an expression.
pub(crate) fn variables(text: &[u8]) -> Vec<Option<Variable>> {
    let variable = |text: &[u8]| {
        let digits = text.iter().take_while(|byte| byte.is_ascii_digit()).count();
        std::str::from_utf8(&text[..digits]).ok()?.parse().ok().map(Variable::Numbered)
    };
    text.split(|byte| *byte == b'#').skip(1).map(variable).collect()
}

/// `#3006=1(TEXT)` at the end of a block: a command of the control that acts and moves nothing.
pub(crate) fn commanded<'a>(block: &'a [u8], dialect: &Dialect) -> Option<&'a [u8]> {
    let command = &block[block.iter().rposition(|byte| *byte == b'#')?..];
    dialect.command(command).filter(|row| row.action.is_none() && row.refuse.is_none()).map(|_| command)
}

fn loop_number(parser: &mut Parser<'_, '_>) -> Result<u32, Text> {
    match parser.operand()? {
        Expression::Number(number @ (1.0 | 2.0 | 3.0)) => Ok(number as u32),
        _ => Err(both!("DO and END take 1, 2 or 3", "DO и END принимают 1, 2 или 3")),
    }
}

/// Which words of a block belong to its call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Taken {
    /// M98: itself, P, L.
    Sub,
    /// M97: itself, P, L.
    Local,
    /// M99: itself, P.
    Return,
    /// G65: everything.
    Macro,
    /// M17: itself.
    End,
}

impl Taken {
    pub(crate) fn contains(self, letter: u8, text: &[u8]) -> bool {
        let code = |number: &[u8]| {
            let digits: Vec<u8> = text[1..].iter().copied().filter(u8::is_ascii_digit).collect();
            let at = digits.iter().position(|digit| *digit != b'0').unwrap_or(0);
            digits[at..].starts_with(number)
        };
        match (self, letter) {
            (_, b'N') => false,
            (Self::Macro, _) => true,
            (Self::End, b'M') => code(b"17"),
            (Self::End, _) => false,
            (_, b'P' | b'L') => true,
            (Self::Sub, b'M') => code(b"98"),
            (Self::Local, b'M') => code(b"97"),
            (Self::Return, b'M') => code(b"99"),
            _ => false,
        }
    }
}

pub(crate) fn call_of(block: &Block<'_>, flow: Flow) -> Option<Taken> {
    block.words().find_map(|word| {
        let number = word.number()?;
        match (word.letter, number.tenths()?) {
            (b'M', 970) if flow.local_calls => Some(Taken::Local),
            (b'M', 980) => Some(Taken::Sub),
            (b'M', 990) => Some(Taken::Return),
            (b'G', 650) => Some(Taken::Macro),
            _ => None,
        }
    })
}
