//! Okuma's statements and values: text to what they do.
//!
//! Source: Okuma OSP-P200M/P20M Programming Manual, user task: common variables `VC1`, arithmetic and comparisons in
//! square brackets, `IF [ … ] N10` and `GOTO N10`, `CALL O10 Q2`, `CALL OSUB` and `RTS`. Sequence names stand first in
//! their block. What the machine alone knows (system variables), local variables, whose life in called programs is not
//! told, and logic between comparisons are refused.

use diagnostic::{Text, both};

use crate::control::{Call, Control, Direction, Said};
use crate::expression::{Expression, Parser, Spelling};
use crate::value::{NameId, Variable};

/// `VC` and digits.
fn is_common(name: &[u8]) -> bool {
    name.len() > 2 && name[..2].eq_ignore_ascii_case(b"VC") && name[2..].iter().all(u8::is_ascii_digit)
}

/// Letters and digits.
fn name<'t>(parser: &mut Parser<'t, '_>) -> &'t [u8] {
    parser.peek();
    let start = parser.at;
    let length = parser.text[start..].iter().take_while(|byte| byte.is_ascii_alphanumeric()).count();
    parser.at += length;
    &parser.text[start..start + length]
}

/// Variables and functions of its own.
pub(crate) const SPELLING: Spelling =
    Spelling { begins: |byte| byte.is_ascii_uppercase(), operand, operator: None };

/// A common variable, or a function with its brackets.
fn operand(parser: &mut Parser<'_, '_>) -> Result<Expression, Text> {
    let start = parser.at;
    let found = name(parser);
    if is_common(found) {
        return Ok(Expression::Variable(Variable::Named(parser.names.id(found))));
    }
    let shown = String::from_utf8_lossy(found).to_ascii_uppercase();
    match (&shown[..], parser.peek()) {
        // One value or two, and in which quadrant, is not told.
        ("ABS" | "COS" | "FIX" | "FUP" | "ROUND" | "SIN" | "SQRT" | "TAN", Some(b'[')) => {
            parser.at = start;
            parser.function()
        }
        (_, Some(b'[')) => {
            Err(both!("`{shown}[` is no function that is known", "функция `{shown}[` неизвестна"))
        }
        _ => Err(both!("`{shown}` is no common variable (VC1)", "`{shown}` — не общая переменная (VC1)")),
    }
}

/// N and a number or letters.
fn label(parser: &mut Parser<'_, '_>) -> Result<NameId, Text> {
    let found = name(parser);
    if found.len() < 2 || !found[0].eq_ignore_ascii_case(&b'N') {
        return Err(both!("a sequence name (N10) was expected", "ожидалось имя кадра (N10)"));
    }
    Ok(parser.names.id(&sequence(found)))
}

/// `N010` is `N10`.
pub(crate) fn sequence(name: &[u8]) -> Vec<u8> {
    if name[1..].iter().all(u8::is_ascii_digit) {
        let zeros = name[1..].iter().take_while(|digit| **digit == b'0').count().min(name.len() - 2);
        return [&name[..1], &name[1 + zeros..]].concat();
    }
    name.to_vec()
}

/// One flow item of a block.
pub(crate) fn statement(parser: &mut Parser<'_, '_>) -> Result<Said, Text> {
    let start = parser.at;
    let word = name(parser).to_ascii_uppercase();
    let said = match &word[..] {
        b"IF" => {
            let condition = parser.bracketed()?;
            if !compares(&condition) {
                return Err(both!(
                    "one comparison was expected in brackets",
                    "в скобках ожидалось одно сравнение"
                ));
            }
            parser.word(b"GOTO");
            jump(Some(condition), parser)?
        }
        b"GOTO" => jump(None, parser)?,
        b"RTS" => Said::Control(Control::Return { to: None }),
        b"CALL" => {
            let written = name(parser);
            let behind =
                written.strip_prefix(b"O").or_else(|| written.strip_prefix(b"o")).unwrap_or_default();
            let number = std::str::from_utf8(behind).ok().and_then(|digits| digits.parse::<u32>().ok());
            if behind.is_empty() || number.is_none() && behind.iter().all(u8::is_ascii_digit) {
                return Err(both!(
                    "a program was expected, O and its number or name (O10, OSUB)",
                    "ожидалась программа: O и её номер или имя (O10, OSUB)"
                ));
            }
            let program = number.is_none().then(|| parser.names.id(written));
            let repeats = if parser.take(b'Q') { Some(parser.operand()?) } else { None };
            let number = Expression::Number(f64::from(number.unwrap_or_default()));
            let call = Call { number, program, local: false, repeats, arguments: None };
            Said::Control(Control::Call(Box::new(call)))
        }
        _ => {
            parser.at = start;
            let mut found = Vec::new();
            while parser.peek().is_some() {
                let target = name(parser);
                if !is_common(target) {
                    let shown = String::from_utf8_lossy(target).to_ascii_uppercase();
                    return Err(both!(
                        "`{shown}` is no common variable (VC1)",
                        "`{shown}` — не общая переменная (VC1)"
                    ));
                }
                let target = Expression::Variable(Variable::Named(parser.names.id(target)));
                parser.expect(b'=')?;
                if !found.is_empty() {
                    return Err(both!(
                        "a second assignment in one block",
                        "второе присваивание в одном кадре"
                    ));
                }
                found.push((target, parser.expression()?));
            }
            Said::Assignments(found)
        }
    };
    parser.end()?;
    Ok(said)
}

fn jump(condition: Option<Expression>, parser: &mut Parser<'_, '_>) -> Result<Said, Text> {
    let to = label(parser)?;
    Ok(Said::Control(Control::Jump { condition, to, direction: Direction::Only }))
}

/// One comparison of two values.
fn compares(condition: &Expression) -> bool {
    use crate::expression::Operator::{Equal, Greater, GreaterOrEqual, Less, LessOrEqual, NotEqual};
    matches!(
        condition,
        Expression::Binary(Equal | NotEqual | Greater | GreaterOrEqual | Less | LessOrEqual, _, _)
    )
}
