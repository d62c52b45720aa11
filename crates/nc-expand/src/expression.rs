//! Expressions: text to tree.

use diagnostic::{Text, both};
use nc_syntax::Macros;

use crate::value::{NameId, Names, Variable};

/// Brackets, functions and `#` inside one another; controls take 5 (Fanuc) or a line's worth.
const DEEPEST: u32 = 64;
/// Parts of one statement's expressions; a control's block holds some dozens. Bounds the depth of the tree.
const MOST_PARTS: u32 = 1000;

/// An expression.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Expression {
    Number(f64),
    Variable(Variable),
    /// `#[…]`, `##1`
    Indirect(Box<Expression>),
    Negative(Box<Expression>),
    Unary(Function, Box<Expression>),
    Binary(Operator, Box<Expression>, Box<Expression>),
    /// `EXISTS[#<name>]`
    Exists(Variable),
}

/// Functions of one argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Abs,
    Acos,
    Asin,
    Atan,
    Bcd,
    Bin,
    Cos,
    Exp,
    Fix,
    Fup,
    Ln,
    Round,
    Sin,
    Sqrt,
    Tan,
}

/// Operators and functions of two arguments.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Power,
    /// `ATAN[y]/[x]`
    Atan2,
    And,
    Or,
    Xor,
    Equal,
    NotEqual,
    Greater,
    GreaterOrEqual,
    Less,
    LessOrEqual,
}

const FUNCTIONS: [(&[u8], Function); 18] = [
    (b"ABS", Function::Abs),
    (b"ACOS", Function::Acos),
    (b"ASIN", Function::Asin),
    (b"ATAN", Function::Atan),
    (b"ATN", Function::Atan),
    (b"BCD", Function::Bcd),
    (b"BIN", Function::Bin),
    (b"COS", Function::Cos),
    (b"EXP", Function::Exp),
    (b"FIX", Function::Fix),
    (b"FUP", Function::Fup),
    (b"LN", Function::Ln),
    (b"RND", Function::Round),
    (b"ROUND", Function::Round),
    (b"SIN", Function::Sin),
    (b"SQR", Function::Sqrt),
    (b"SQRT", Function::Sqrt),
    (b"TAN", Function::Tan),
];

const OPERATORS: [(&[u8], Operator); 15] = [
    (b"+", Operator::Add),
    (b"-", Operator::Subtract),
    (b"**", Operator::Power),
    (b"*", Operator::Multiply),
    (b"/", Operator::Divide),
    (b"MOD", Operator::Modulo),
    (b"AND", Operator::And),
    (b"OR", Operator::Or),
    (b"XOR", Operator::Xor),
    (b"EQ", Operator::Equal),
    (b"NE", Operator::NotEqual),
    (b"GE", Operator::GreaterOrEqual),
    (b"GT", Operator::Greater),
    (b"LE", Operator::LessOrEqual),
    (b"LT", Operator::Less),
];

impl Operator {
    /// Larger binds tighter.
    ///
    /// LinuxCNC: `**`, then `* / MOD`, then `+ -`, then comparisons, then `AND OR XOR`. Fanuc: `* / AND MOD`, then
    /// `+ - OR XOR`, then comparisons.
    const fn rank(self, macros: Macros) -> u8 {
        let fanuc = matches!(macros, Macros::Fanuc);
        match self {
            Self::Power | Self::Atan2 => 6,
            Self::Multiply | Self::Divide | Self::Modulo => 5,
            Self::And if fanuc => 5,
            Self::Or if matches!(macros, Macros::Siemens) => 1,
            Self::Add | Self::Subtract => 4,
            Self::Or | Self::Xor if fanuc => 4,
            Self::Equal
            | Self::NotEqual
            | Self::Greater
            | Self::GreaterOrEqual
            | Self::Less
            | Self::LessOrEqual => 3,
            Self::And | Self::Or | Self::Xor => 2,
        }
    }
}

/// Why a text is no expression.
pub(crate) type Fault = Text;

/// The operator that stands next, and its length.
pub(crate) type NextOperator = fn(&[u8]) -> Option<(Operator, usize)>;

/// How a control writes values that custom macro B and RS274/NGC do not have.
#[derive(Clone, Copy)]
pub(crate) struct Spelling {
    /// Whether a byte, upper case, begins one.
    pub(crate) begins: fn(u8) -> bool,
    pub(crate) operand: fn(&mut Parser<'_, '_>) -> Result<Expression, Fault>,
    /// `None`: those of the others.
    pub(crate) operator: Option<NextOperator>,
}

/// Reads statements and expressions from the bytes of a block.
pub(crate) struct Parser<'t, 'n> {
    pub(crate) text: &'t [u8],
    pub(crate) at: usize,
    pub(crate) macros: Macros,
    spelling: Option<Spelling>,
    pub(crate) names: &'n mut Names,
    depth: u32,
    /// Comparisons, and AND or OR, between the brackets that are open.
    kinds: [bool; 2],
    /// Parts read so far: what it costs to evaluate them.
    pub(crate) cost: u32,
}

impl<'t, 'n> Parser<'t, 'n> {
    pub(crate) fn new(
        text: &'t [u8],
        macros: Macros,
        spelling: Option<Spelling>,
        names: &'n mut Names,
    ) -> Self {
        Self { text, at: 0, macros, spelling, names, depth: 0, kinds: [false; 2], cost: 0 }
    }

    /// The next byte that is not blank, upper case.
    pub(crate) fn peek(&mut self) -> Option<u8> {
        while self.text.get(self.at).is_some_and(|byte| *byte <= b' ' || *byte == 0x7F) {
            self.at += 1;
        }
        self.text.get(self.at).map(u8::to_ascii_uppercase)
    }

    /// Takes a byte, if it is the next one.
    pub(crate) fn take(&mut self, byte: u8) -> bool {
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    pub(crate) fn expect(&mut self, byte: u8) -> Result<(), Fault> {
        if self.take(byte) {
            Ok(())
        } else {
            Err(both!("`{}` was expected", "ожидалось `{}`", byte as char))
        }
    }

    /// Takes a flow word of custom macro B, of which two letters suffice.
    pub(crate) fn short_word(&mut self, word: &[u8]) -> bool {
        self.peek();
        let rest = self.text.get(self.at..).unwrap_or_default();
        let run = rest.iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
        (2..word.len()).contains(&run) && self.word(&word[..run]) || self.word(word)
    }

    /// Takes a word of letters, if it is next.
    pub(crate) fn word(&mut self, word: &[u8]) -> bool {
        self.peek();
        let found =
            self.text.get(self.at..self.at + word.len()).is_some_and(|text| text.eq_ignore_ascii_case(word));
        self.at += if found { word.len() } else { 0 };
        found
    }

    /// `[ … ]`
    pub(crate) fn bracketed(&mut self) -> Result<Expression, Fault> {
        self.expect(b'[')?;
        let inside = self.expression()?;
        self.expect(b']')?;
        Ok(inside)
    }

    /// Operands with operators between them.
    pub(crate) fn expression(&mut self) -> Result<Expression, Fault> {
        let outside = std::mem::take(&mut self.kinds);
        let first = self.operand()?;
        let found = self.operators(first, 0)?;
        let inside = std::mem::replace(&mut self.kinds, outside);
        if self.macros == Macros::Siemens && inside == [true; 2] {
            return Err(both!(
                "comparisons beside AND or OR need brackets around each",
                "сравнения рядом с AND и OR берут каждое в скобки"
            ));
        }
        Ok(found)
    }

    /// Precedence climbing; every operator takes its left neighbours first.
    fn operators(&mut self, mut left: Expression, least: u8) -> Result<Expression, Fault> {
        while let Some((operator, length)) = self.operator() {
            let rank = operator.rank(self.macros);
            if rank < least.max(1) {
                break;
            }
            self.at += length;
            self.kinds[usize::from(rank < 3)] |= rank <= 3;
            let mut right = self.operand()?;
            while let Some((next, _)) = self.operator() {
                if next.rank(self.macros) <= rank {
                    break;
                }
                right = self.operators(right, next.rank(self.macros))?;
            }
            self.cost += 1;
            left = Expression::Binary(operator, Box::new(left), Box::new(right));
        }
        Ok(left)
    }

    fn operator(&mut self) -> Option<(Operator, usize)> {
        self.peek()?;
        let rest = &self.text[self.at..];
        if let Some(operator) = self.spelling.and_then(|spelling| spelling.operator) {
            return operator(rest);
        }
        let (name, operator) = OPERATORS
            .iter()
            .find(|(name, _)| rest.get(..name.len()).is_some_and(|text| text.eq_ignore_ascii_case(name)))?;
        // Of Okuma's logic between comparisons the rank is not told.
        let okuma = self.macros == Macros::Okuma
            && matches!(operator, Operator::And | Operator::Or | Operator::Xor | Operator::Modulo);
        let power = *operator == Operator::Power && self.macros != Macros::LinuxCnc;
        (!okuma && !power).then_some((*operator, name.len()))
    }

    /// A number, a variable, a function, a bracket; with a sign.
    pub(crate) fn operand(&mut self) -> Result<Expression, Fault> {
        self.cost += 1;
        if self.cost > MOST_PARTS {
            return Err(both!(
                "more than {MOST_PARTS} values in one statement",
                "в одном операторе больше {MOST_PARTS} значений"
            ));
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(both!(
                "more than {DEEPEST} brackets and functions inside one another",
                "вложенных скобок и функций больше {DEEPEST}"
            ));
        }
        let found = self.operand_inside();
        self.depth -= 1;
        found
    }

    fn operand_inside(&mut self) -> Result<Expression, Fault> {
        let next = self.peek();
        let own = self.spelling.filter(|spelling| next.is_some_and(spelling.begins));
        if let Some(spelling) = own {
            return (spelling.operand)(self);
        }
        match next {
            Some(b'[') => self.bracketed(),
            Some(b'#') => self.variable(),
            Some(b'0'..=b'9' | b'.') => self.number().map(Expression::Number),
            Some(b'+') => {
                self.at += 1;
                self.operand()
            }
            Some(b'-') => {
                self.at += 1;
                Ok(Expression::Negative(Box::new(self.operand()?)))
            }
            Some(b'A'..=b'Z') => self.function(),
            Some(other) => Err(both!("`{}` starts no value", "с `{}` значение не начинается", other as char)),
            None => Err(both!("a value was expected at the end", "в конце ожидалось значение")),
        }
    }

    /// `#1`, `#[…]`, `##1`, `#<name>`, as a value.
    pub(crate) fn variable(&mut self) -> Result<Expression, Fault> {
        self.expect(b'#')?;
        match self.peek() {
            Some(b'<') if self.macros == Macros::LinuxCnc => {
                Ok(Expression::Variable(Variable::Named(self.name()?)))
            }
            Some(b'0'..=b'9') => {
                let start = self.at;
                while self.peek().is_some_and(|byte| byte.is_ascii_digit()) {
                    self.at += 1;
                }
                let digits: String = self.text[start..self.at]
                    .iter()
                    .filter(|b| b.is_ascii_digit())
                    .map(|b| *b as char)
                    .collect();
                let number = digits.parse().map_err(|_| {
                    both!(
                        "#{digits} is no variable of any control",
                        "#{digits} — такой переменной нет ни у одной стойки"
                    )
                })?;
                Ok(Expression::Variable(Variable::Numbered(number)))
            }
            Some(b'#' | b'[') => Ok(Expression::Indirect(Box::new(self.operand()?))),
            _ => Err(both!("a number was expected after `#`", "после `#` ожидалось число")),
        }
    }

    /// `<name>`
    pub(crate) fn name(&mut self) -> Result<NameId, Fault> {
        self.expect(b'<')?;
        let rest = &self.text[self.at..];
        let length = rest
            .iter()
            .position(|byte| *byte == b'>')
            .ok_or_else(|| both!("a name without its `>`", "у имени нет своей `>`"))?;
        self.at += length + 1;
        Ok(self.names.id(&rest[..length]))
    }

    /// Digits with at most one point; the sign is the operand's.
    fn number(&mut self) -> Result<f64, Fault> {
        let mut digits = String::new();
        while let Some(byte @ (b'0'..=b'9' | b'.')) = self.peek() {
            digits.push(byte as char);
            self.at += 1;
        }
        let sound = digits.len() <= 40 && digits.matches('.').count() <= 1 && digits != ".";
        // Digits and a point only: the standard reader is correctly rounded and sees nothing else.
        digits
            .parse()
            .ok()
            .filter(|_| sound)
            .ok_or_else(|| both!("`{digits}` is not a number", "`{digits}` — не число"))
    }

    pub(crate) fn function(&mut self) -> Result<Expression, Fault> {
        let length = self.text[self.at..].iter().take_while(|byte| byte.is_ascii_alphabetic()).count();
        let name = self.text[self.at..self.at + length].to_ascii_uppercase();
        let shown = String::from_utf8_lossy(&name).into_owned();
        self.at += length;
        if name == b"EXISTS" && self.macros == Macros::LinuxCnc {
            self.expect(b'[')?;
            let Expression::Variable(variable @ Variable::Named(_)) = self.variable()? else {
                return Err(both!(
                    "EXISTS asks for a name: EXISTS[#<name>]",
                    "EXISTS требует имени: EXISTS[#<name>]"
                ));
            };
            self.expect(b']')?;
            return Ok(Expression::Exists(variable));
        }
        if name == b"POW" && self.macros == Macros::Fanuc {
            return self.two(Operator::Power);
        }
        let Some((_, function)) = FUNCTIONS.iter().find(|(known, _)| *known == name) else {
            return Err(both!("`{shown}` is no function", "`{shown}` — не функция"));
        };
        let fanuc_only = matches!(function, Function::Bcd | Function::Bin)
            || matches!(&name[..], b"ATN" | b"SQR" | b"RND");
        if fanuc_only && self.macros != Macros::Fanuc {
            return Err(both!(
                "`{shown}` is no function of this dialect",
                "функции `{shown}` в этом диалекте нет"
            ));
        }
        if *function != Function::Atan {
            return Ok(Expression::Unary(*function, Box::new(self.bracketed()?)));
        }
        // ATAN[y]/[x]; Fanuc also ATAN[y,x] and ATAN[y].
        self.expect(b'[')?;
        let y = self.expression()?;
        if self.macros == Macros::Fanuc && self.take(b',') {
            let x = self.expression()?;
            self.expect(b']')?;
            return Ok(Expression::Binary(Operator::Atan2, Box::new(y), Box::new(x)));
        }
        self.expect(b']')?;
        let before = self.at;
        if self.take(b'/') && self.peek() == Some(b'[') {
            let x = self.bracketed()?;
            return Ok(Expression::Binary(Operator::Atan2, Box::new(y), Box::new(x)));
        }
        if self.macros == Macros::LinuxCnc {
            return Err(both!(
                "ATAN needs two values: ATAN[y]/[x]",
                "ATAN требует двух значений: ATAN[y]/[x]"
            ));
        }
        self.at = before;
        Ok(Expression::Unary(Function::Atan, Box::new(y)))
    }

    fn two(&mut self, operator: Operator) -> Result<Expression, Fault> {
        self.expect(b'[')?;
        let first = self.expression()?;
        self.expect(b',')?;
        let second = self.expression()?;
        self.expect(b']')?;
        Ok(Expression::Binary(operator, Box::new(first), Box::new(second)))
    }

    /// Fails unless everything was read.
    pub(crate) fn end(&mut self) -> Result<(), Fault> {
        match self.peek() {
            None => Ok(()),
            Some(_) => {
                let rest = String::from_utf8_lossy(&self.text[self.at..]).into_owned();
                let short: String = rest.chars().take(20).collect();
                Err(both!("`{short}` cannot follow", "`{short}` здесь следовать не может"))
            }
        }
    }
}
