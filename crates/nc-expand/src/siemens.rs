//! Siemens' statements and expressions: text to what they do.
//!
//! Source: SINUMERIK 840D sl Programming Manual Job Planning, chapter 1 (R parameters, variables, operators, jumps and
//! control structures). Comparisons rank below AND and OR there, which few programs mean: where both stand at one level
//! brackets are asked for.

use std::ops::Range;

use diagnostic::{Text, both};

use crate::control::{Call, Control, Direction, Said};
use crate::expression::{Expression, Function, Operator, Parser, Spelling};
use crate::o_word::{Label, OStatement, OWord};
use crate::value::{NameId, Variable};

const FUNCTIONS: [(&[u8], Function); 10] = [
    (b"ABS", Function::Abs),
    (b"ACOS", Function::Acos),
    (b"ASIN", Function::Asin),
    (b"COS", Function::Cos),
    (b"EXP", Function::Exp),
    (b"LN", Function::Ln),
    (b"ROUND", Function::Round),
    (b"SIN", Function::Sin),
    (b"SQRT", Function::Sqrt),
    (b"TAN", Function::Tan),
];

const OPERATORS: [(&[u8], Operator); 12] = [
    (b"+", Operator::Add),
    (b"-", Operator::Subtract),
    (b"*", Operator::Multiply),
    (b"/", Operator::Divide),
    (b"AND", Operator::And),
    (b"OR", Operator::Or),
    (b"==", Operator::Equal),
    (b"<>", Operator::NotEqual),
    (b">=", Operator::GreaterOrEqual),
    (b"<=", Operator::LessOrEqual),
    (b">", Operator::Greater),
    (b"<", Operator::Less),
];

fn is_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

/// Names, brackets and operators of its own.
pub(crate) const SPELLING: Spelling = Spelling {
    begins: |byte| matches!(byte, b'(' | b'A'..=b'Z' | b'_' | b'$'),
    operand,
    operator: Some(operator),
};

/// The operator that stands next, and its length.
fn operator(rest: &[u8]) -> Option<(Operator, usize)> {
    let (name, operator) = OPERATORS.iter().find(|(name, _)| {
        let word = name[0].is_ascii_alphabetic();
        rest.get(..name.len()).is_some_and(|text| text.eq_ignore_ascii_case(name))
            && !(word && rest.get(name.len()).is_some_and(|next| is_name(*next)))
    })?;
    Some((*operator, name.len()))
}

/// A name: letters, digits, `_`, after `$` or a letter.
fn name<'t>(parser: &mut Parser<'t, '_>) -> Option<&'t [u8]> {
    let first = parser.peek()?;
    if !(first.is_ascii_alphabetic() || matches!(first, b'_' | b'$')) {
        return None;
    }
    let start = parser.at;
    let length = 1 + parser.text[start + 1..].iter().take_while(|byte| is_name(**byte)).count();
    parser.at += length;
    Some(&parser.text[start..start + length])
}

/// A value: number, variable, function, bracket, NOT.
fn operand(parser: &mut Parser<'_, '_>) -> Result<Expression, Text> {
    if parser.take(b'(') {
        let inside = parser.expression()?;
        parser.expect(b')')?;
        return Ok(inside);
    }
    let Some(found) = name(parser) else {
        return Err(both!("a value was expected", "ожидалось значение"));
    };
    let upper = found.to_ascii_uppercase();
    let shown = String::from_utf8_lossy(&upper).into_owned();
    match &upper[..] {
        b"TRUE" => return Ok(Expression::Number(1.0)),
        b"FALSE" => return Ok(Expression::Number(0.0)),
        b"NOT" => {
            let inside = Box::new(parser.operand()?);
            return Ok(Expression::Binary(Operator::Equal, inside, Box::new(Expression::Number(0.0))));
        }
        _ => {}
    }
    if parser.peek() == Some(b'[') {
        return Err(both!(
            "`{shown}[`: no fields of variables are known",
            "`{shown}[`: массивы переменных неизвестны"
        ));
    }
    if parser.peek() != Some(b'(') {
        return Ok(Expression::Variable(Variable::Named(parser.names.id(found))));
    }
    parser.expect(b'(')?;
    let first = parser.expression()?;
    let value = match &upper[..] {
        b"ATAN2" => {
            parser.expect(b',')?;
            let second = parser.expression()?;
            Expression::Binary(Operator::Atan2, Box::new(first), Box::new(second))
        }
        b"POT" => Expression::Binary(Operator::Multiply, Box::new(first.clone()), Box::new(first)),
        b"TRUNC" => Expression::Unary(Function::Fix, Box::new(first)),
        _ => match FUNCTIONS.iter().find(|(known, _)| *known == &upper[..]) {
            Some((_, function)) => Expression::Unary(*function, Box::new(first)),
            None => {
                return Err(both!("`{shown}` is no function that is known", "функция `{shown}` неизвестна"));
            }
        },
    };
    parser.expect(b')')?;
    Ok(value)
}

/// A label: a name, or a block number as `N100`.
pub(crate) fn label(parser: &mut Parser<'_, '_>) -> Result<NameId, Text> {
    let found = name(parser).ok_or_else(|| both!("a label was expected", "ожидалась метка"))?;
    Ok(parser.names.id(found))
}

/// Which way a word of jumps looks.
fn direction(word: &[u8]) -> Option<Direction> {
    match word {
        b"GOTOF" => Some(Direction::Forward),
        b"GOTOB" => Some(Direction::Back),
        b"GOTO" => Some(Direction::Either),
        _ => None,
    }
}

/// The name that stands next, upper case; empty where none does.
fn keyword(parser: &mut Parser<'_, '_>) -> Vec<u8> {
    name(parser).map(<[u8]>::to_ascii_uppercase).unwrap_or_default()
}

/// One flow item of a block.
pub(crate) fn statement(parser: &mut Parser<'_, '_>) -> Result<Said, Text> {
    let start = parser.at;
    let word = keyword(parser);
    let said = match &word[..] {
        b"DEF" => definition(parser).map(Said::Assignments)?,
        b"IF" => {
            let condition = parser.expression()?;
            if parser.peek().is_none() {
                o_word(parser, b"if", OWord::If(condition))
            } else {
                let direction = direction(&keyword(parser))
                    .ok_or_else(|| both!("GOTOF or GOTOB was expected", "ожидалось GOTOF или GOTOB"))?;
                Said::Control(Control::Jump { condition: Some(condition), to: label(parser)?, direction })
            }
        }
        b"ELSE" => o_word(parser, b"if", OWord::Else),
        b"ENDIF" => o_word(parser, b"if", OWord::EndIf),
        b"WHILE" => {
            let condition = parser.expression()?;
            o_word(parser, b"while", OWord::While(condition))
        }
        b"LOOP" => o_word(parser, b"loop", OWord::While(Expression::Number(1.0))),
        b"ENDWHILE" => o_word(parser, b"while", OWord::EndWhile),
        b"ENDLOOP" => o_word(parser, b"loop", OWord::EndWhile),
        b"REPEAT" if parser.peek().is_none() => o_word(parser, b"repeat", OWord::Do),
        b"REPEAT" => {
            return Err(both!(
                "REPEAT with a label repeats a part of the program",
                "REPEAT с меткой повторяет часть программы"
            ));
        }
        b"UNTIL" => {
            let condition = Box::new(parser.expression()?);
            let goes_on = Expression::Binary(Operator::Equal, condition, Box::new(Expression::Number(0.0)));
            o_word(parser, b"repeat", OWord::While(goes_on))
        }
        b"FOR" => for_loop(parser)?,
        b"RET" => Said::Control(Control::Return { to: None }),
        b"PROC" => header(parser)?,
        word if is_numbered_call(word) => {
            let program = Some(parser.names.id(word));
            let repeats = if parser.take(b'P') { Some(parser.operand()?) } else { None };
            let number = Expression::Number(0.0);
            let call = Call { number, program, local: false, repeats, arguments: None };
            Said::Control(Control::Call(Box::new(call)))
        }
        b"CALL" if parser.word(b"BLOCK") => {
            let from = label(parser)?;
            if !parser.word(b"TO") {
                return Err(both!("TO was expected", "ожидалось TO"));
            }
            Said::Control(Control::Section { from, to: label(parser)? })
        }
        b"ENDFOR" => Said::Control(Control::EndFor { start: 0 }),
        word => match direction(word) {
            Some(direction) => {
                Said::Control(Control::Jump { condition: None, to: label(parser)?, direction })
            }
            None => {
                parser.at = start;
                assignments(parser).map(Said::Assignments)?
            }
        },
    };
    parser.end()?;
    Ok(said)
}

fn for_loop(parser: &mut Parser<'_, '_>) -> Result<Said, Text> {
    let variable = target(parser)?;
    let from = parser.expression()?;
    if !parser.word(b"TO") {
        return Err(both!("TO was expected", "ожидалось TO"));
    }
    let to = parser.expression()?;
    Ok(Said::Control(Control::For { variable, from, to, end: 0 }))
}

/// PROC: what is behind it says how the control shows the program, or keeps its caller's state.
fn header(parser: &mut Parser<'_, '_>) -> Result<Said, Text> {
    keyword(parser);
    while parser.peek().is_some() {
        if !matches!(&keyword(parser)[..], b"ACTBLOCNO" | b"DISPLOF" | b"SBLOF") {
            return Err(both!(
                "PROC with arguments, SAVE or what else is not known",
                "PROC с аргументами, SAVE или чем-то неизвестным"
            ));
        }
    }
    Ok(Said::Assignments(Vec::new()))
}

fn o_word(parser: &mut Parser<'_, '_>, kind: &[u8], word: OWord) -> Said {
    let label = Label::Known(parser.names.id(kind));
    Said::Control(Control::O(Box::new(OStatement { label, word, next: 0, end: 0, foot: false })))
}

/// `R1=5 R2=R1*2`
fn assignments(parser: &mut Parser<'_, '_>) -> Result<Vec<(Expression, Expression)>, Text> {
    let mut found = Vec::new();
    while parser.peek().is_some() {
        let target = Expression::Variable(target(parser)?);
        let value = parser.expression()?;
        if found.iter().any(|(set, _)| reads(&value, set)) {
            return Err(both!(
                "it reads a variable that the same block sets: write it in a block of its own",
                "в ней читается переменная, которую задаёт тот же кадр: напишите отдельным кадром"
            ));
        }
        found.push((target, value));
    }
    Ok(found)
}

/// A variable that may be set, and `=`.
fn target(parser: &mut Parser<'_, '_>) -> Result<Variable, Text> {
    let found = name(parser).ok_or_else(|| both!("a variable was expected", "ожидалась переменная"))?;
    let id = parser.names.id(found);
    if !is_parameter(found) && !parser.names.is_declared(id) {
        let shown = String::from_utf8_lossy(found).to_ascii_uppercase();
        return Err(both!(
            "{shown} is not declared: `DEF REAL {shown}` was expected before it",
            "{shown} не объявлена: перед этим ожидалось `DEF REAL {shown}`"
        ));
    }
    parser.expect(b'=')?;
    Ok(Variable::Named(id))
}

/// True where an expression reads a variable.
fn reads(expression: &Expression, variable: &Expression) -> bool {
    match expression {
        Expression::Negative(inside) | Expression::Indirect(inside) | Expression::Unary(_, inside) => {
            reads(inside, variable)
        }
        Expression::Binary(_, left, right) => reads(left, variable) || reads(right, variable),
        Expression::Number(_) | Expression::Variable(_) | Expression::Exists(_) => expression == variable,
    }
}

/// L and digits.
fn is_numbered_call(name: &[u8]) -> bool {
    name.len() > 1 && name[0] == b'L' && name[1..].iter().all(u8::is_ascii_digit)
}

/// R and digits.
pub(crate) fn is_parameter(name: &[u8]) -> bool {
    name.len() > 1 && name[0].eq_ignore_ascii_case(&b'R') && name[1..].iter().all(u8::is_ascii_digit)
}

/// `DEF REAL A=5, B`: variables that begin with a value, or with zero.
fn definition(parser: &mut Parser<'_, '_>) -> Result<Vec<(Expression, Expression)>, Text> {
    let whole = match &keyword(parser)[..] {
        b"REAL" => false,
        b"INT" | b"BOOL" => true,
        _ => return Err(both!("DEF takes REAL, INT or BOOL here", "DEF принимает здесь REAL, INT или BOOL")),
    };
    let mut found = Vec::new();
    loop {
        let target = name(parser)
            .ok_or_else(|| both!("the name of a variable was expected", "ожидалось имя переменной"))?
            .to_vec();
        if is_parameter(&target) || target.len() < 2 {
            return Err(both!(
                "R parameters and single letters cannot be declared",
                "R-параметры и отдельные буквы не объявляют"
            ));
        }
        let id = parser.names.id(&target);
        if parser.names.is_declared(id) {
            let shown = String::from_utf8_lossy(&target).to_ascii_uppercase();
            return Err(both!(
                "{shown} is declared twice, here and in a program that calls or is called: whose is it?",
                "{shown} объявлена дважды, здесь и в вызывающей или вызванной программе: чья она?"
            ));
        }
        parser.names.declare(id, whole);
        let value = if parser.take(b'=') { parser.expression()? } else { Expression::Number(0.0) };
        found.push((Expression::Variable(Variable::Named(id)), value));
        if !parser.take(b',') {
            return Ok(found);
        }
    }
}

/// The one function that a word's value is, as in `X=IC(5)`: its name, and where what is in its brackets stands.
pub(crate) fn function_of(text: &[u8]) -> Option<(&[u8], Range<usize>)> {
    let start = value_start(text)?;
    let length = text[start..].iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
    let closes = length > 1 && text.get(start + length) == Some(&b'(') && text.ends_with(b")");
    closes.then(|| (&text[start..start + length], start + length + 1..text.len() - 1))
}

/// Where a word's value starts, behind `=`.
fn value_start(text: &[u8]) -> Option<usize> {
    let equals = text.iter().position(|byte| *byte == b'=')? + 1;
    Some(equals + text[equals..].iter().take_while(|byte| matches!(byte, b' ' | b'\t')).count())
}

/// Where the expression of a word stands in its text: `X=R1`, `X=IC(R1)`, `CR=R5/2`.
pub(crate) fn value_of(text: &[u8]) -> Option<Range<usize>> {
    match function_of(text) {
        Some((name, inside)) if says(&[b"AC", b"IC"], name) => Some(inside),
        _ => Some(value_start(text)?..text.len()),
    }
}

/// True where a word's value is no number that is computed: a text, or a way of saying an axis' place around a plain
/// number.
pub(crate) fn is_plain(text: &[u8]) -> bool {
    let number = |inside: &[u8]| {
        inside.iter().all(|byte| byte.is_ascii_digit() || matches!(byte, b'.' | b'-' | b'+' | b' '))
    };
    let place = |(name, inside): (&[u8], Range<usize>)| {
        says(&[b"AC", b"IC", b"DC", b"ACP", b"ACN"], name) && number(&text[inside])
    };
    text.ends_with(b"\"") || function_of(text).is_some_and(place)
}

fn says(names: &[&[u8]], found: &[u8]) -> bool {
    names.iter().any(|name| name.eq_ignore_ascii_case(found))
}

/// True where the arguments of a command name anything: a variable of the program would be read that the flat one never
/// sets.
pub(crate) fn names_something(text: &[u8]) -> bool {
    let behind = text.iter().take_while(|byte| is_name(**byte)).count();
    let mut quoted = false;
    text[behind..].iter().any(|byte| {
        quoted ^= *byte == b'"';
        !quoted && (byte.is_ascii_alphabetic() || matches!(byte, b'_' | b'$'))
    })
}

/// A plain decimal number; nothing else that a library would take for one.
pub(crate) fn plain_number(text: &str) -> Option<f64> {
    let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
    let plain = digits.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.')
        && digits.bytes().any(|byte| byte.is_ascii_digit());
    plain.then(|| text.parse().ok()).flatten()
}
