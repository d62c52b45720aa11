//! Comments, brackets, variables and the words of flow: the parts of a block that have an inside.
//!
//! Written with nom; nothing recurses, so that no nesting is too deep.

use nom::branch::alt;
use nom::bytes::complete::{is_not, tag, take_until, take_while, take_while1};
use nom::character::complete::{alpha1, char, digit1, one_of};
use nom::combinator::{opt, recognize, verify};
use nom::multi::many0_count;
use nom::sequence::delimited;
use nom::{IResult, Parser};

type Parsed<'a> = IResult<&'a [u8], &'a [u8]>;

/// `( … )` up to the first closing mark.
pub(crate) fn flat_comment(input: &[u8]) -> Parsed<'_> {
    recognize((char('('), take_until(")"), char(')'))).parse(input)
}

/// `( … ( … ) … )`: as many closing marks as opening ones.
pub(crate) fn nested_comment(input: &[u8]) -> Parsed<'_> {
    balanced(input, b'(', b')')
}

/// `[ … ]` with brackets inside.
pub(crate) fn brackets(input: &[u8]) -> Parsed<'_> {
    balanced(input, b'[', b']')
}

/// From an opening mark to the one that closes it; counts instead of recursing.
fn balanced(input: &[u8], open: u8, close: u8) -> Parsed<'_> {
    let marks = [open, close];
    let (mut left, _) = tag(&marks[..1]).parse(input)?;
    let mut depth = 1_usize;
    while depth > 0 {
        let (after, mark) = alt((tag(&marks[..1]), tag(&marks[1..]), is_not(&marks[..]))).parse(left)?;
        left = after;
        if mark == &marks[..1] {
            depth += 1;
        } else if mark == &marks[1..] {
            depth -= 1;
        }
    }
    Ok((left, &input[..input.len() - left.len()]))
}

fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t')
}

/// A variable: `#1`, `##1`, `#<name>`, `#[…]`.
fn variable(input: &[u8]) -> Parsed<'_> {
    let marks = many0_count((take_while(is_blank), char('#')));
    recognize((char('#'), marks, take_while(is_blank), alt((digit1, angle_name, brackets)))).parse(input)
}

/// `<name>`.
pub(crate) fn angle_name(input: &[u8]) -> Parsed<'_> {
    recognize(delimited(char('<'), take_until(">"), char('>'))).parse(input)
}

/// Functions of Fanuc's custom macro B and of LinuxCNC.
const FUNCTIONS: [&str; 18] = [
    "ABS", "ACOS", "ADP", "ASIN", "ATAN", "BCD", "BIN", "COS", "EXISTS", "EXP", "FIX", "FUP", "LN", "POW",
    "ROUND", "SIN", "SQRT", "TAN",
];

/// True where the letters name a function.
pub(crate) fn is_function(name: &[u8]) -> bool {
    FUNCTIONS.iter().any(|function| function.as_bytes().eq_ignore_ascii_case(name))
}

/// A function with its argument: `SIN[30]`, `ATAN[1]/[2]`.
fn function(input: &[u8]) -> Parsed<'_> {
    let second = (take_while(is_blank), char('/'), take_while(is_blank), brackets);
    recognize((verify(alpha1, is_function), take_while(is_blank), brackets, opt(second))).parse(input)
}

/// What may stand for a number: `#1`, `-#<x>`, `[#1+2]`, `-SIN[30]`.
pub(crate) fn expression(input: &[u8]) -> Parsed<'_> {
    let sign = opt((one_of("+-"), take_while(is_blank)));
    recognize((sign, alt((variable, brackets, function)))).parse(input)
}

/// Words that start a flow statement wherever they stand.
const FLOW: [&str; 14] = [
    "IF", "THEN", "ELSE", "ENDIF", "WHILE", "DO", "END", "GOTO", "POPEN", "PCLOS", "DPRNT", "BPRNT", "SETVN",
    "FGEN",
];

/// True where the letters start a flow statement of custom macro B.
pub(crate) fn is_flow_word(name: &[u8]) -> bool {
    FLOW.iter().any(|word| word.as_bytes().eq_ignore_ascii_case(name))
}

/// True for what custom macro B takes for the start of a flow word: its first letters, two at least.
pub(crate) fn is_short_flow_word(name: &[u8]) -> bool {
    let starts =
        |word: &str| word.len() > name.len() && word.as_bytes()[..name.len()].eq_ignore_ascii_case(name);
    name.len() > 1 && ["WHILE", "GOTO", "THEN", "END"].into_iter().any(starts)
}

/// Words that start a statement of Siemens' language.
const SIEMENS: [&str; 17] = [
    "DEF", "ELSE", "ENDFOR", "ENDIF", "ENDLOOP", "ENDWHILE", "FOR", "GOTO", "GOTOB", "GOTOF", "IF", "LOOP",
    "PROC", "REPEAT", "RET", "UNTIL", "WHILE",
];

/// True where a name starts a statement of Siemens' language.
pub(crate) fn is_siemens_word(name: &[u8]) -> bool {
    SIEMENS.iter().any(|word| word.as_bytes().eq_ignore_ascii_case(name))
}

/// Words behind the `O` of LinuxCNC's O-codes.
const O_WORDS: [&str; 15] = [
    "SUB",
    "ENDSUB",
    "CALL",
    "DO",
    "WHILE",
    "ENDWHILE",
    "IF",
    "ELSEIF",
    "ELSE",
    "ENDIF",
    "BREAK",
    "CONTINUE",
    "RETURN",
    "REPEAT",
    "ENDREPEAT",
];

/// The start of an O-code statement: `O100 sub`, `o<name> call`, `o[#1] if`.
pub(crate) fn o_statement(input: &[u8]) -> Parsed<'_> {
    let label = alt((digit1, angle_name, variable, brackets));
    let word =
        verify(alpha1, |name: &[u8]| O_WORDS.iter().any(|word| word.as_bytes().eq_ignore_ascii_case(name)));
    recognize((one_of("oO"), take_while(is_blank), label, take_while(is_blank), word)).parse(input)
}

/// The value behind `=`: up to the next blank outside brackets and quotes.
pub(crate) fn assigned(input: &[u8]) -> Parsed<'_> {
    let round = |input| balanced(input, b'(', b')');
    let quoted = recognize((char('"'), take_until("\""), char('"')));
    let plain = take_while1(|byte| !matches!(byte, b' ' | b'\t' | b'[' | b'(' | b'"'));
    recognize(many0_count(alt((brackets, round, quoted, plain)))).parse(input)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken<'a>(parser: impl Fn(&'a [u8]) -> Parsed<'a>, text: &'a str) -> Option<&'a str> {
        parser(text.as_bytes()).ok().map(|(_, found)| std::str::from_utf8(found).unwrap())
    }

    #[test]
    fn comments() {
        assert_eq!(taken(flat_comment, "(a (b) c) X1"), Some("(a (b)"));
        assert_eq!(taken(nested_comment, "(a (b) c) X1"), Some("(a (b) c)"));
        assert_eq!(taken(flat_comment, "(never closed"), None);
        assert_eq!(taken(nested_comment, "(a (b)"), None);
    }

    #[test]
    fn expressions() {
        for text in [
            "#1",
            "##1",
            "# 1",
            "#<_x y>",
            "-#102",
            "#[100+#1]",
            "[#1+[2*3]]",
            "-[1]",
            "SIN[30]",
            "atan[1] / [2]",
        ] {
            assert_eq!(taken(expression, text), Some(text));
        }
        for text in ["1", "#", "#x", "[1", "FOO[1]", "#<never", "--#1"] {
            assert_eq!(taken(expression, text), None, "{text}");
        }
    }

    #[test]
    fn o_codes() {
        for text in ["o100 sub", "O<my part> call", "o[#1+1]if", "O#2 while"] {
            assert_eq!(taken(o_statement, text), Some(text));
        }
        assert_eq!(taken(o_statement, "O1234 (NAME)"), None);
        assert_eq!(taken(o_statement, "O1234 SUBTRACT"), None);
    }

    #[test]
    fn a_million_brackets_overflow_no_stack() {
        let mut text = "[".repeat(1_000_000);
        assert_eq!(taken(brackets, &text), None);
        text.push_str(&"]".repeat(1_000_000));
        assert_eq!(taken(brackets, &text).map(str::len), Some(2_000_000));
        let marks = format!("{}1", "#".repeat(1_000_000));
        assert_eq!(taken(expression, &marks).map(str::len), Some(1_000_001));
    }
}
