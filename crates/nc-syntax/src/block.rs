use units::decimal::Decimal;

use crate::code::GCode;

/// Bytes of a block, counted from its start.
///
/// ```
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str) -> Block<'static> {
/// #     let marks: &nc_syntax::Marks = Box::leak(Box::default());
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), marks), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// let block = read("G1 X-10.5 (in)\r\n");
/// let span = block.word(b'X').unwrap().span;
/// assert_eq!((span.start, span.end), (3, 9));
/// assert_eq!(block.text(span), b"X-10.5");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

/// The sign as written.
///
/// ```
/// use nc_syntax::Sign;
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str) -> Block<'static> {
/// #     let marks: &nc_syntax::Marks = Box::leak(Box::default());
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), marks), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// // Both are ten, and each is written again as it was.
/// let block = read("X+10. Y10.\n");
/// let sign = |letter| block.word(letter).unwrap().number().unwrap().sign;
/// assert_eq!((sign(b'X'), sign(b'Y')), (Sign::Plus, Sign::None));
/// ```
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
///
/// ```
/// use nc_syntax::Number;
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str) -> Block<'static> {
/// #     let marks: &nc_syntax::Marks = Box::leak(Box::default());
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), marks), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// let block = read("G54.1 X-.250 M06\n");
/// let number = |letter| block.word(letter).unwrap().number().unwrap();
/// let x = number(b'X');
/// assert_eq!((x.decimal.mantissa, x.decimal.decimals, x.leading_digit), (-250, 3, false));
/// assert_eq!(x.to_f64(), -0.25);
/// assert_eq!((number(b'M').integer(), x.integer()), (Some(6), None));
/// assert_eq!(number(b'G').tenths(), Some(541));
/// ```
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
///
/// ```
/// use nc_syntax::Value;
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str) -> Block<'static> {
/// #     let marks: &nc_syntax::Marks = Box::leak(Box::default());
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), marks), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// let block = read("X#1 Y[#2+1] Z5.\n");
/// let value = |letter| block.word(letter).unwrap().value;
/// assert_eq!((value(b'X'), value(b'Y')), (Value::Expression, Value::Expression));
/// assert!(matches!(value(b'Z'), Value::Number(five) if five.to_f64() == 5.0));
/// ```
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
///
/// ```
/// use nc_syntax::Invalid;
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str) -> Block<'static> {
/// #     let marks: &nc_syntax::Marks = Box::leak(Box::default());
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), marks), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// // Nothing is lost over it: the bytes stand in their item, and the block's other words are there.
/// let block = read("G1 X1.2.3 Y5.\n");
/// let (why, span) = block.first_invalid().unwrap();
/// assert_eq!((why, block.text(span)), (Invalid::Number, &b"X1.2.3"[..]));
/// assert_eq!(block.word(b'Y').unwrap().number().unwrap().to_f64(), 5.0);
/// ```
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
    /// More bytes in one block than [`MAX_BLOCK_BYTES`]: the item covers it and nothing in it was read.
    TooLong,
}

/// What a stretch of a block is.
///
/// ```
/// use nc_syntax::ItemKind;
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str) -> Block<'static> {
/// #     let marks: &nc_syntax::Marks = Box::leak(Box::default());
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), marks), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// let block = read("/ N5 G1 X10. ,C2. (CHAMFER)\n");
/// let kinds: Vec<&str> = block
///     .items
///     .iter()
///     .map(|item| match item.kind {
///         ItemKind::Skip => "skip",
///         ItemKind::Word { .. } => "word",
///         ItemKind::CommaWord { .. } => "comma word",
///         ItemKind::Comment => "comment",
///         _ => "other",
///     })
///     .collect();
/// assert_eq!(kinds, ["skip", "word", "word", "word", "comma word", "comment"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ItemKind {
    /// Letter (upper case) and value. `N`, `G`, `X`, `O`… all are words.
    Word {
        /// Upper-case ASCII letter. `:1234` is a word of `O`: its program number, or the label of a main block.
        letter: u8,
        /// What follows it.
        value: Value,
    },
    /// A word behind a comma: `,R5.`, `,C2.`, `,A30.`. Never the word of the letter alone.
    CommaWord {
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
    /// A command by name: in round brackets where the dialect has such ([`crate::Paren::Command`]),
    /// or a word of the dialect's command table; a refused one reaches to the end of the block. See
    /// [`crate::Spells::named`].
    BracketCommand,
    /// Flow and variables: `#1=…`, `IF`, `WHILE`, `GOTO`, `O100 sub`; to the next comment or the end of the block.
    Flow,
    /// What could not be read.
    Invalid(Invalid),
}

/// One thing in a block.
///
/// ```
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str) -> Block<'static> {
/// #     let marks: &nc_syntax::Marks = Box::leak(Box::default());
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), marks), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// // What lies between the items is white space.
/// let block = read("G1  X10.\t(in)\n");
/// let texts: Vec<&[u8]> = block.items.iter().map(|item| block.text(item.span)).collect();
/// assert_eq!(texts, [&b"G1"[..], b"X10.", b"(in)"]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Item {
    /// What it is.
    pub kind: ItemKind,
    /// Where it stands in the block.
    pub span: Span,
}

/// One block of the program with its line ending.
///
/// ```
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str) -> Block<'static> {
/// #     let marks: &nc_syntax::Marks = Box::leak(Box::default());
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), marks), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// let block = read("N10 G1 X10. X20. (twice)\r\n");
/// assert_eq!(block.bytes, b"N10 G1 X10. X20. (twice)\r\n");
/// // Where a letter stands twice, `word` is the last and `words` has both.
/// assert_eq!(block.word(b'X').and_then(|x| x.number()).map(|x| x.to_f64()), Some(20.0));
/// assert_eq!(block.words().filter(|word| word.letter == b'X').count(), 2);
/// assert!(block.acts() && !read("N10 (only a comment)\n").acts());
/// ```
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

/// Longest block that is read, bytes with its end. A longer one is one [`Invalid::TooLong`] item.
///
/// The longest block a control takes is a few hundred bytes; the limit keeps the memory of a block bounded
/// whatever the file holds.
pub const MAX_BLOCK_BYTES: usize = 1 << 16;

/// A letter with its value, as [`Block::words`] yields them.
///
/// ```
/// use nc_syntax::GCode;
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str) -> Block<'static> {
/// #     let marks: &nc_syntax::Marks = Box::leak(Box::default());
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), marks), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// let block = read("G54.1 P3\n");
/// let codes: Vec<_> = block.words().map(|word| word.g_code()).collect();
/// assert_eq!(codes, [Some(GCode(541)), None]);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Word {
    /// Upper-case ASCII letter.
    pub letter: u8,
    /// What follows it.
    pub value: Value,
    /// Where it stands in the block.
    pub span: Span,
}

impl Word {
    /// The number, where the value is one.
    #[must_use]
    pub fn number(&self) -> Option<Number> {
        if let Value::Number(number) = self.value { Some(number) } else { None }
    }

    /// The code of a G word; `None` where the value is no number or finer than a tenth (`G1.23`).
    #[must_use]
    pub fn g_code(&self) -> Option<GCode> {
        (self.letter == b'G').then(|| self.number()?.tenths().map(GCode))?
    }
}

impl Number {
    /// The nearest `f64`, sign included.
    #[must_use]
    pub fn to_f64(self) -> f64 {
        self.decimal.to_f64()
    }

    /// The value where it is whole (`M06`, `N10`, `P2.0`).
    #[must_use]
    pub fn integer(self) -> Option<i64> {
        let scale = 10_i64.checked_pow(u32::from(self.decimal.decimals))?;
        (self.decimal.mantissa % scale == 0).then(|| self.decimal.mantissa / scale)
    }

    /// The value in tenths where that is whole, not negative and below 6553.6 (`G54.1` is 541).
    #[must_use]
    pub fn tenths(self) -> Option<u16> {
        let Decimal { mantissa, decimals } = self.decimal;
        let tenths = match decimals {
            0 => mantissa.checked_mul(10)?,
            1 => mantissa,
            more => {
                let scale = 10_i64.checked_pow(u32::from(more - 1))?;
                (mantissa % scale == 0).then(|| mantissa / scale)?
            }
        };
        u16::try_from(tenths).ok()
    }
}

impl<'a> Block<'a> {
    /// The item's bytes.
    #[must_use]
    pub fn text(&self, span: Span) -> &'a [u8] {
        &self.bytes[span.start as usize..span.end as usize]
    }

    /// The block's bytes but for its end and blanks before that, counted from the start of the file.
    #[must_use]
    pub fn file_range(&self) -> std::ops::Range<u64> {
        self.offset..self.offset + self.bytes.trim_ascii_end().len() as u64
    }

    /// The item's bytes counted from the start of the file.
    #[must_use]
    pub fn file_span(&self, span: Span) -> std::ops::Range<u64> {
        self.offset + u64::from(span.start)..self.offset + u64::from(span.end)
    }

    /// The block delete switches that skip this block, a bit each: `/` and `/1` are bit 1, `/3` is bit 3; 0 where the block
    /// is always executed.
    #[must_use]
    pub fn switches(&self) -> u16 {
        let marks = self.items.iter().filter(|item| item.kind == ItemKind::Skip);
        marks.fold(0, |switches, mark| {
            // The reader takes one digit behind the mark, if there is any.
            let number = self
                .text(mark.span)
                .iter()
                .find(|byte| byte.is_ascii_digit())
                .map_or(0, |digit| digit - b'0');
            switches | 1 << number.max(1)
        })
    }

    /// True where the block says something that a control executes: a word other than N and O, a command, flow.
    #[must_use]
    pub fn acts(&self) -> bool {
        self.items.iter().any(|item| match item.kind {
            ItemKind::Word { letter, .. } => !matches!(letter, b'N' | b'O'),
            ItemKind::CommaWord { .. } | ItemKind::BracketCommand | ItemKind::Flow | ItemKind::Invalid(_) => {
                true
            }
            ItemKind::Comment | ItemKind::Skip | ItemKind::Percent | ItemKind::Name => false,
        })
    }

    /// The words in order; comma words are not among them.
    pub fn words(&self) -> impl Iterator<Item = Word> + '_ {
        self.items.iter().filter_map(|item| match item.kind {
            ItemKind::Word { letter, value } => Some(Word { letter, value, span: item.span }),
            _ => None,
        })
    }

    /// The last word of a letter: where a control takes a letter twice, the last one counts.
    ///
    /// Whether twice is allowed is for the caller to say ([`Block::words`]).
    #[must_use]
    pub fn word(&self, letter: u8) -> Option<Word> {
        self.items.iter().rev().find_map(|item| match item.kind {
            ItemKind::Word { letter: found, value } if found == letter => {
                Some(Word { letter, value, span: item.span })
            }
            _ => None,
        })
    }

    /// The first item that could not be read.
    #[must_use]
    pub fn first_invalid(&self) -> Option<(Invalid, Span)> {
        self.items.iter().find_map(|item| match item.kind {
            ItemKind::Invalid(why) => Some((why, item.span)),
            _ => None,
        })
    }
}
