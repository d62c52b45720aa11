//! A message: its number, how bad it is, where, and what to do.

use std::fmt;
use std::ops::Range;

use crate::{Edit, Entry, Text};

/// The number in `error[VP0203]`.
///
/// Hundreds name the room: 00 command and files, 01 nc-syntax, 02 nc-program, 03 machine-profile,
/// 04 machine-model, 05 correction, 06 nc-emit, 07 check, 08 grammar, 09 point and measurement files,
/// 10 diagnosis, 11 calibration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Code(pub u16);

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "VP{:04}", self.0)
    }
}

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The work goes on.
    Warning,
    /// A warning that the program itself is doubtful: who wants certainty refuses it (`--strict`).
    Doubt,
    /// Nothing is written.
    Error,
}

/// One message about one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Diagnostic {
    /// The number to look up.
    pub code: Code,
    /// How bad it is.
    pub severity: Severity,
    /// What is wrong, in one line, with numbers.
    pub message: Text,
    /// Bytes of the source text the message is about, from its start.
    pub span: Option<Range<u64>>,
    /// What stands under the caret: what was found there, what was expected.
    pub label: Text,
    /// What to type.
    pub help: Option<Text>,
    /// What the help says, where that is more than words.
    pub way_out: Option<Box<WayOut>>,
}

/// What settles a refusal, as who sees it may do it.
#[derive(Clone, Debug, PartialEq)]
pub enum WayOut {
    /// What the profile lacks: entries of one of its tables.
    Entries(Vec<Entry>),
    /// One edit of the program.
    Edit(Edit),
}

impl Diagnostic {
    /// An error.
    #[must_use]
    pub fn error(code: Code, message: Text) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message,
            span: None,
            label: Text::EMPTY,
            help: None,
            way_out: None,
        }
    }
    /// A warning.
    #[must_use]
    pub fn warning(code: Code, message: Text) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message) }
    }
    /// A warning that the program itself is doubtful.
    #[must_use]
    pub fn doubt(code: Code, message: Text) -> Self {
        Self { severity: Severity::Doubt, ..Self::error(code, message) }
    }
    /// Says where.
    #[must_use]
    pub fn at(mut self, span: Range<u64>, label: Text) -> Self {
        self.span = Some(span);
        self.label = label;
        self
    }
    /// Says which entry of the profile settles it.
    #[must_use]
    pub fn settled_by(mut self, entry: Entry) -> Self {
        self.way_out = Some(Box::new(WayOut::Entries(vec![entry])));
        self
    }
    /// Says which edit of the text does what the help says.
    #[must_use]
    pub fn mended_by(mut self, edit: Edit) -> Self {
        self.way_out = Some(Box::new(WayOut::Edit(edit)));
        self
    }
    /// What the profile lacks, where entries of one of its tables settle it.
    #[must_use]
    pub fn entries(&self) -> &[Entry] {
        match self.way_out.as_deref() {
            Some(WayOut::Entries(entries)) => entries,
            Some(WayOut::Edit(_)) | None => &[],
        }
    }
    /// The edit of the program that does what the help says.
    #[must_use]
    pub fn edit(&self) -> Option<&Edit> {
        match self.way_out.as_deref()? {
            WayOut::Edit(edit) => Some(edit),
            WayOut::Entries(_) => None,
        }
    }
    /// Says what to do.
    #[must_use]
    pub fn help(mut self, help: Text) -> Self {
        self.help = Some(help);
        self
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let word = if self.severity == Severity::Error { "error" } else { "warning" };
        write!(f, "{word}[{}]: {}", self.code, self.message)
    }
}

impl std::error::Error for Diagnostic {}

/// An error without a place: its number; what is wrong; what to type.
///
/// Both are a [`Text`], or what [`both!`](crate::both) takes: English, Russian, the values of both.
///
/// ```
/// use diagnostic::{Code, notice};
///
/// let refused = notice!(Code(2);
///     "`--step {}` is none", "`--step {}` — не шаг", 0;
///     "write `--step 50`", "напишите `--step 50`"
/// );
/// assert_eq!(refused.to_string(), "error[VP0002]: `--step 0` is none");
/// ```
#[macro_export]
macro_rules! notice {
    ($code:expr; $($message:expr),+; $($help:expr),+) => {
        $crate::Diagnostic::error($code, $crate::text!($($message),+)).help($crate::text!($($help),+))
    };
}
