//! How a control's language is spelled.

use serde::Deserialize;

/// What `( )` means.
///
/// ```
/// use nc_syntax::{ItemKind, Marks, Paren};
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str, marks: Marks) -> Block<'static> {
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), Box::leak(Box::new(marks))), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// // A comment on one control, a command on the other.
/// let kind = |paren| read("(UAO,1)\n", Marks { paren, ..Marks::default() }).items[0].kind;
/// assert_eq!(kind(Paren::Comment { nested: false }), ItemKind::Comment);
/// assert_eq!(kind(Paren::Command), ItemKind::BracketCommand);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paren {
    /// Not part of the dialect.
    None,
    /// A comment.
    Comment {
        /// `( ( ) )` is one comment.
        nested: bool,
    },
    /// A command to the control (Balt-System).
    Command,
}

/// What `;` means where it ends no block ([`Marks::end_of_block`]).
///
/// ```
/// use nc_syntax::{Marks, Semicolon};
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str, marks: Marks) -> Block<'static> {
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), Box::leak(Box::new(marks))), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// // It ends the block, or the rest of the line is a comment.
/// let ends = Marks { end_of_block: Some(b';'), semicolon: Semicolon::None, ..Marks::default() };
/// assert_eq!(read("X1.;Y2.\n", ends).bytes, b"X1.;");
/// assert_eq!(read("X1.;Y2.\n", Marks::default()).bytes, b"X1.;Y2.\n");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Semicolon {
    /// Not part of the dialect.
    None,
    /// The rest of the line is a comment.
    Comment,
}

/// What `:` means.
///
/// ```
/// use nc_syntax::{Colon, ItemKind, Marks};
/// # use nc_syntax::{Block, Reader};
/// # fn read(text: &'static str, marks: Marks) -> Block<'static> {
/// #     let (mut reader, mut block) = (Reader::new(text.as_bytes(), Box::leak(Box::new(marks))), Block::default());
/// #     assert!(reader.next(&mut block));
/// #     block
/// # }
/// let kind = |colon| read(":1234\n", Marks { colon, ..Marks::default() }).items[0].kind;
/// assert!(matches!(kind(Colon::Number), ItemKind::Word { letter: b'O', .. }));
/// assert_eq!(kind(Colon::Comment), ItemKind::Comment);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Colon {
    /// Not part of the dialect.
    #[default]
    None,
    /// `:1234` is a program number or main block.
    Number,
    /// First on its line it makes the line a comment (Centroid).
    Comment,
}

/// Which language of variables, expressions and program flow the control has.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Macros {
    /// None that is known: a program that uses one is refused.
    #[default]
    None,
    /// Fanuc's custom macro B: `#1`, `IF … GOTO`, `WHILE … DO1`, G65; M98 and M99.
    Fanuc,
    /// LinuxCNC's parameters and O-words; M98 and M99.
    #[serde(rename = "linuxcnc")]
    LinuxCnc,
    /// Siemens' R parameters, variables of DEF, IF and loops, jumps to labels.
    Siemens,
    /// Okuma's VC variables, IF and GOTO to sequence names, CALL O and RTS.
    Okuma,
}

impl Macros {
    /// True where variables stand without a mark before their names, and calls are no M codes.
    #[must_use]
    pub const fn bare_names(self) -> bool {
        matches!(self, Self::Siemens | Self::Okuma)
    }
}

/// Marks and letters of a language; the default is that of ISO 6983, with comments in round brackets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Marks {
    /// What `( )` means.
    pub paren: Paren,
    /// What `;` means.
    pub semicolon: Semicolon,
    /// The mark that ends a block; what follows on its line is a new one.
    pub end_of_block: Option<u8>,
    /// Behind `%` stand a name without blanks and words (`%4100 G71`), and a block's `%` need not be its first.
    pub percent_words: bool,
    /// Character of block delete, if any.
    pub skip: Option<u8>,
    /// What `:` means.
    pub colon: Colon,
    /// Names of several letters that are a word's, as `CR=` is R; upper case, sorted.
    pub long_words: Vec<(String, u8)>,
    /// `OMAIN` and `NEND` are names.
    pub labels: bool,
    /// `X=10.5` and `X=R1+2` are words too; a value other than a number runs to the next white space.
    pub equals_words: bool,
    /// Letters of words, upper case; others are invalid.
    pub letters: Vec<u8>,
    /// `X 1 0 . 5` is 10.5.
    pub spaces_inside: bool,
}

impl Default for Marks {
    fn default() -> Self {
        Self {
            paren: Paren::Comment { nested: false },
            semicolon: Semicolon::Comment,
            end_of_block: None,
            percent_words: false,
            skip: Some(b'/'),
            colon: Colon::Number,
            long_words: Vec::new(),
            labels: false,
            equals_words: false,
            letters: (b'A'..=b'Z').collect(),
            spaces_inside: true,
        }
    }
}

/// A command whose name a text starts with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Named {
    /// Bytes of the name.
    pub length: usize,
    /// The rest of the block is the command's: whose words they are is not known.
    pub takes_block: bool,
}

/// What reading a block asks of a language; marks alone are one without commands.
pub trait Spells: Sync {
    /// Its marks and letters.
    fn marks(&self) -> &Marks;

    /// The command whose name `text` starts with as a whole word, in either case.
    fn named(&self, _text: &[u8]) -> Option<Named> {
        None
    }

    /// `M94/1`: what stands behind a slash is the code's argument, and no mark of block delete.
    fn has_slash_arguments(&self, _m_code: u16) -> bool {
        false
    }

    /// The code moves nothing, ends nothing, and stands on the first piece of a split block as on the block.
    fn only_switches(&self, _m_code: u16) -> bool {
        false
    }

    /// The language of its statements.
    fn macros(&self) -> Macros {
        Macros::None
    }

    /// No block is written out as others, which have no comments.
    fn copies_blocks(&self) -> bool {
        true
    }
}

impl Spells for Marks {
    fn marks(&self) -> &Marks {
        self
    }
}
