use units::decimal::Decimal;

/// Bytes of a block, counted from its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

/// The sign as written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// No sign.
    None,
    /// `+`
    Plus,
    /// `-`
    Minus,
}

/// A number as written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Number {
    /// Its exact value, sign included.
    pub decimal: Decimal,
    /// The sign as written.
    pub sign: Sign,
    /// A decimal point was written.
    pub has_point: bool,
    /// A digit stands before the point (`0.5`, not `.5`).
    pub leading_digit: bool,
}

/// What follows a word's letter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Value {
    /// A plain number.
    Number(Number),
    /// A variable or an expression in brackets: `#1`, `-#<x>`, `[#1+2]`. The item's span covers it.
    Expression,
    /// Nothing: a bare letter.
    Missing,
}

/// Why bytes are not a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Invalid {
    /// A number that cannot be read (`X1.2.3`, `Xnan`, `X1E5`).
    Number,
    /// More digits than 15: not exact in any control.
    TooManyDigits,
    /// A comment without its end.
    UnclosedComment,
    /// A bracket without its partner.
    UnclosedBracket,
    /// Bytes that start no word, comment or command.
    Text,
}

/// What a stretch of a block is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ItemKind {
    /// Letter (upper case) and value. `N`, `G`, `X`, `O`… all are words.
    Word {
        /// Upper-case ASCII letter.
        letter: u8,
        /// What follows it.
        value: Value,
    },
    /// A comment with its marks; not executed.
    Comment,
    /// `/` or `/3` at the start of the block or before words: block delete.
    Skip,
    /// `%` alone: start or end of the program.
    Percent,
    /// Program name in a form that is not an `O` or `:` word, or a text line in the leader.
    Name,
    /// A command in brackets (Balt-System style).
    BracketCommand,
    /// Flow and variables: `#1=…`, `IF`, `WHILE`, `GOTO`, `O100 sub`.
    Flow,
    /// What could not be read.
    Invalid(Invalid),
}

/// One thing in a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// What it is.
    pub kind: ItemKind,
    /// Where it stands in the block.
    pub span: Span,
}

/// One block of the program with its line ending.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Block<'a> {
    /// All bytes of the block, its end included.
    pub bytes: &'a [u8],
    /// Bytes of the file before it.
    pub offset: u64,
    /// Line of the file it starts on, from 1.
    pub line: u64,
    /// What stands in it, in order; white space and the end of line lie between the items.
    pub items: Vec<Item>,
}

impl Block<'_> {
    /// The item's bytes.
    #[must_use]
    pub fn text(&self, span: Span) -> &[u8] {
        &self.bytes[span.start as usize..span.end as usize]
    }

    /// The item's bytes counted from the start of the file.
    #[must_use]
    pub fn file_span(&self, span: Span) -> std::ops::Range<u64> {
        self.offset + u64::from(span.start)..self.offset + u64::from(span.end)
    }
}
