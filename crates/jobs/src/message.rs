//! Messages: what went wrong, where, and what to type.

use std::ops::Range;

use annotate_snippets::{AnnotationKind, Group, Level, Renderer, Snippet};
use diagnostic::{Code, Diagnostic, Language, Severity, Text, both, of_system};
use measurement_files::Row;

use crate::shown::{is_obeyed, shown};

/// A text that diagnostics speak of.
#[derive(Debug, Clone)]
pub struct Source {
    /// Its name for people.
    pub name: String,
    /// Its bytes, or those of a part that starts with a line.
    pub bytes: Vec<u8>,
    /// Bytes of the text before them.
    pub offset: u64,
    /// The line they start with, from 1.
    pub first_line: u64,
}

impl Source {
    /// A whole text.
    #[must_use]
    pub fn whole(name: impl Into<String>, bytes: impl Into<Vec<u8>>) -> Self {
        Self { name: name.into(), bytes: bytes.into(), offset: 0, first_line: 1 }
    }

    /// The number of the line that holds this byte of the text, from 1.
    #[must_use]
    pub fn line(&self, at: u64) -> usize {
        self.around(&(at..at)).number
    }

    /// Line and column of a span, from 1, as messages print them.
    #[must_use]
    pub fn place(&self, span: &Range<u64>) -> (usize, usize) {
        let line = self.around(span);
        (line.number, line.text[..line.span.start].chars().count() + 1)
    }

    /// The line a span of the text is in.
    fn around(&self, span: &Range<u64>) -> Line {
        let own = span.start.saturating_sub(self.offset)..span.end.saturating_sub(self.offset);
        let mut line = Line::around(&self.bytes, &own);
        line.number += usize::try_from(self.first_line).map_or(0, |first| first - 1);
        line
    }
}

/// Diagnostics and the text they are about.
#[derive(Debug, Clone)]
pub struct Report {
    /// The text, where there is one.
    pub source: Option<Source>,
    /// The diagnostics.
    pub diagnostics: Vec<Diagnostic>,
}

impl Report {
    /// What is said as a warning about no text.
    #[must_use]
    pub fn warning(said: Diagnostic) -> Self {
        Self { source: None, diagnostics: vec![Diagnostic { severity: Severity::Warning, ..said }] }
    }
}

/// Why the command ends without having done its work.
#[derive(Debug)]
pub enum Failure {
    /// The program was refused: exit status 1.
    Refused(Vec<Report>),
    /// A file could not be read or written: exit status 1.
    File(Report),
    /// A check failed and its result was printed: exit status 1.
    Check,
    /// Usage, profile or grammar: exit status 2.
    Usage(Vec<Report>),
    /// A signal came: exit status 128 + signal.
    Interrupted(u8),
    /// Not now, but perhaps soon: exit status 75.
    Later(Report),
    /// Everything was said already: this exit status.
    Said(u8),
}

/// A file cannot be read or written.
pub const FILE: Code = Code(1);
/// An option cannot be understood.
pub const OPTION: Code = Code(2);

impl Failure {
    /// What it says.
    #[must_use]
    pub fn reports(&self) -> &[Report] {
        match self {
            Self::Refused(reports) | Self::Usage(reports) => reports,
            Self::File(report) | Self::Later(report) => std::slice::from_ref(report),
            Self::Check | Self::Interrupted(_) | Self::Said(_) => &[],
        }
    }

    /// One diagnostic about a text.
    #[must_use]
    pub fn refused(name: &str, bytes: &[u8], diagnostics: Vec<Diagnostic>) -> Self {
        let source = Source::whole(name, bytes);
        Self::Refused(vec![Report { source: Some(source), diagnostics }])
    }

    /// An option is wrong.
    pub fn option(message: Text, help: Text) -> Self {
        Self::asks(OPTION, message, help)
    }

    /// A usage error without a text.
    #[must_use]
    pub fn usage(diagnostic: Diagnostic) -> Self {
        Self::Usage(vec![Report { source: None, diagnostics: vec![diagnostic] }])
    }

    /// What was measured, or a program, is refused, and there is no text to point at.
    #[must_use]
    pub fn unfit(diagnostic: Diagnostic) -> Self {
        Self::Refused(vec![Report { source: None, diagnostics: vec![diagnostic] }])
    }

    /// The same of its parts.
    #[must_use]
    pub fn alone(code: Code, message: Text, help: Text) -> Self {
        Self::unfit(Diagnostic::error(code, message).help(help))
    }

    /// What is refused of a cell in a table of measurements.
    pub fn at_cell(row: &Row<'_>, key: &str) -> impl FnOnce(Diagnostic) -> Self {
        |Diagnostic { code, message, help, .. }| {
            row.refuse(code, key, message, help.unwrap_or(Text::EMPTY)).into()
        }
    }

    /// What is refused of a whole row of such a table.
    pub fn at_row(row: &Row<'_>) -> impl FnOnce(Diagnostic) -> Self {
        |Diagnostic { code, message, help, .. }| {
            row.refuse_row(code, message, both!("this row", "эта строка"), help.unwrap_or(Text::EMPTY)).into()
        }
    }

    /// A question that only the user can answer, or a slip of theirs.
    #[must_use]
    pub fn asks(code: Code, message: Text, help: Text) -> Self {
        Self::usage(Diagnostic::error(code, message).help(help))
    }

    /// A file that command line or profile names cannot be read: a usage error.
    #[must_use]
    pub fn unread(name: &str, error: &std::io::Error) -> Self {
        Self::usage(file_diagnostic(&Text::same(name), Deed::Read, error))
    }

    /// A file cannot be read or written.
    #[must_use]
    pub fn file(name: &str, deed: Deed, error: &std::io::Error) -> Self {
        Self::place(&Text::same(name), deed, error)
    }

    /// The same of what is called differently in each language: standard output.
    #[must_use]
    pub fn place(name: &Text, deed: Deed, error: &std::io::Error) -> Self {
        Self::File(Report { source: None, diagnostics: vec![file_diagnostic(name, deed, error)] })
    }
}

impl From<Box<measurement_files::Refusal>> for Failure {
    /// A file of measurements that is not read, or a question about it that only the user can answer.
    fn from(refusal: Box<measurement_files::Refusal>) -> Self {
        match refusal.source {
            Some((name, text)) => Self::refused(&name, text.as_bytes(), vec![refusal.diagnostic]),
            None => Self::usage(refusal.diagnostic),
        }
    }
}

/// What to say of an input or output error.
#[must_use]
pub fn file_diagnostic(name: &Text, deed: Deed, error: &std::io::Error) -> Diagnostic {
    use std::io::ErrorKind;
    let help = match error.kind() {
        ErrorKind::NotFound => {
            Text::pair("check the name; nothing of it exists there", "проверьте имя: ничего такого там нет")
        }
        ErrorKind::PermissionDenied => Text::pair(
            "check who may read and write there (`ls -l`)",
            "проверьте права на чтение и запись (`ls -l`)",
        ),
        ErrorKind::IsADirectory => Text::pair("give a file in it", "это папка: укажите файл в ней"),
        ErrorKind::StorageFull | ErrorKind::QuotaExceeded => Text::pair(
            "make room on the disk; an earlier output was left as it was",
            "освободите место на диске; прежний выходной файл не тронут",
        ),
        _ => Text::pair(
            "nothing was changed; try again when the cause is gone",
            "ничего не изменено; повторите, когда причина устранена",
        ),
    };
    let error = of_system(error);
    let message = match deed {
        Deed::Read => both!("cannot read {name}: {error}", "{name:#} не читается: {error:#}"),
        Deed::Write => both!("cannot write {name}: {error}", "{name:#} не записывается: {error:#}"),
        Deed::WriteTo => both!("cannot write to {name}: {error}", "запись в {name:#} не удалась: {error:#}"),
        Deed::Make => both!("cannot make {name}: {error}", "{name:#} не создаётся: {error:#}"),
        Deed::Empty => both!("cannot empty {name}: {error}", "{name:#} не очищается: {error:#}"),
    };
    Diagnostic::error(FILE, message).help(help)
}

/// What was to be done with a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Deed {
    /// To read it.
    Read,
    /// To write it.
    Write,
    /// To write into it: a folder, a stream.
    WriteTo,
    /// To make it: a folder.
    Make,
    /// To empty it: a folder.
    Empty,
}

/// What messages begin with.
static ERROR: Text = Text::pair("error", "ошибка");
static WARNING: Text = Text::pair("warning", "предупреждение");
/// What stands before the way out.
pub static HELP: Text = Text::pair("help", "что делать");
static INTERRUPTED: Text = Text::pair("interrupted: nothing was written", "прервано: ничего не записано");

/// How messages are written.
#[derive(Debug)]
pub struct Wording {
    renderer: Renderer,
    quiet: bool,
    language: Language,
}

impl Wording {
    /// In English, without colours, warnings and all.
    #[must_use]
    pub fn plain() -> Self {
        Self { renderer: Renderer::plain(), quiet: false, language: Language::English }
    }

    /// The same with colours, for a terminal.
    #[must_use]
    pub fn colored() -> Self {
        Self { renderer: Renderer::styled(), ..Self::plain() }
    }

    /// The same in a language.
    #[must_use]
    pub fn speaking(self, language: Language) -> Self {
        Self { language, ..self }
    }

    /// The same without warnings.
    #[must_use]
    pub fn quiet(self) -> Self {
        Self { quiet: true, ..self }
    }

    /// A failure's text; its warnings only where the user wants them.
    #[must_use]
    pub fn text(&self, failure: &Failure) -> String {
        match failure {
            Failure::Interrupted(_) => INTERRUPTED.in_language(self.language).to_owned(),
            failure => failure
                .reports()
                .iter()
                .flat_map(|report| self.rendered(report))
                .collect::<Vec<_>>()
                .join("\n"),
        }
    }

    /// The texts of diagnostics; warnings only where the user wants them.
    pub fn rendered(&self, report: &Report) -> impl Iterator<Item = String> {
        let told = report.diagnostics.iter().filter(|d| d.severity == Severity::Error || !self.quiet);
        told.map(|diagnostic| self.render(diagnostic, report.source.as_ref()))
    }

    fn render(&self, diagnostic: &Diagnostic, source: Option<&Source>) -> String {
        let (level, name) = match diagnostic.severity {
            Severity::Error => (Level::ERROR, &ERROR),
            Severity::Warning | Severity::Doubt => (Level::WARNING, &WARNING),
        };
        let level = level.with_name(name.in_language(self.language));
        let help_level = Level::HELP.with_name(HELP.in_language(self.language));
        let code = diagnostic.code.to_string();
        let [message, label] =
            [&diagnostic.message, &diagnostic.label].map(|text| shown(text.in_language(self.language)));
        let help = diagnostic.help.as_ref().map(|help| shown(help.in_language(self.language)));
        let title = level.primary_title(message.as_ref()).id(code.as_str());
        let line = match (&diagnostic.span, source) {
            (Some(span), Some(source)) => Some((source.around(span), shown(&source.name))),
            _ => None,
        };
        let mut groups = Vec::new();
        match &line {
            Some((line, name)) => groups.push(
                title.element(
                    Snippet::source(line.text.as_str())
                        .line_start(line.number)
                        .path(name.as_ref())
                        .annotation(AnnotationKind::Primary.span(line.span.clone()).label(label.as_ref())),
                ),
            ),
            None => match source {
                Some(source) => {
                    groups.push(title.element(annotate_snippets::Origin::path(shown(&source.name))))
                }
                None => groups.push(Group::with_title(title)),
            },
        }
        // Without a line of source there is nothing that a rule would join to the help.
        let separate = source.is_none();
        if let (Some(help), false) = (&help, separate) {
            groups.push(Group::with_title(help_level.clone().secondary_title(help.as_ref())));
        }
        let mut text = self.renderer.render(&groups);
        if let (Some(help), true) = (&help, separate) {
            text.push('\n');
            text.push_str(
                &self.renderer.render(&[Group::with_title(help_level.secondary_title(help.as_ref()))]),
            );
        }
        text
    }
}

/// The line a span is in, made printable; columns stay what they are in the file.
struct Line {
    number: usize,
    text: String,
    span: Range<usize>,
}

/// No line longer than this is printed whole; only a window of it.
const WIDEST: usize = 400;

impl Line {
    fn around(bytes: &[u8], span: &Range<u64>) -> Self {
        let place = |at: u64| usize::try_from(at).unwrap_or(usize::MAX).min(bytes.len());
        let (start, end) = (place(span.start), place(span.end));
        let ends = |byte: &u8| matches!(byte, b'\n' | b'\r');
        let mut first = bytes[..start].iter().rposition(ends).map_or(0, |at| at + 1);
        let last = bytes[start..].iter().position(ends).map_or(bytes.len(), |at| start + at);
        let end = end.clamp(start, last.max(start));
        let number = 1 + lines_before(&bytes[..first]);
        // A window of a line that is no line for people, such as a program without line ends.
        if start - first > WIDEST / 2 {
            first = start - WIDEST / 2;
        }
        let last = last.min(first + WIDEST).max(start);
        let before = printable(&bytes[first..start]);
        let marked = printable(&bytes[start..end.min(last)]);
        let after = printable(&bytes[end.min(last)..last]);
        let span = before.len()..before.len() + marked.len();
        Self { number, text: [before, marked, after].concat(), span }
    }
}

/// Line ends in the bytes: `\n`, `\r\n`, `\r` alone.
fn lines_before(bytes: &[u8]) -> usize {
    let mut count = 0;
    for (at, byte) in bytes.iter().enumerate() {
        if *byte == b'\n' || (*byte == b'\r' && !matches!(bytes.get(at + 1), Some(b'\n' | b'\r'))) {
            count += 1;
        }
    }
    count
}

/// UTF-8 as it is; every other byte and every control character as one sign each.
fn printable(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len());
    for chunk in bytes.utf8_chunks() {
        text.extend(chunk.valid().chars().map(|c| if c.is_control() || is_obeyed(c) { '\u{b7}' } else { c }));
        text.extend(chunk.invalid().iter().map(|_| '\u{b7}'));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_counted_in_every_convention() {
        for end in ["\n", "\r\n", "\r", "\r\r\n"] {
            let text = format!("G0 X1{end}G1 Y2{end}G9 Z3{end}").into_bytes();
            let at = text.iter().position(|b| *b == b'9').unwrap() as u64;
            let line = Line::around(&text, &(at - 1..at + 1));
            assert_eq!((line.number, line.text.as_str(), line.span), (3, "G9 Z3", 0..2), "{end:?}");
        }
    }

    #[test]
    fn bytes_of_other_encodings_keep_their_columns() {
        let line = Line::around(b"(\xcf\xf0) X\0", &(5..6));
        assert_eq!(line.text, "(\u{b7}\u{b7}) X\u{b7}");
        assert_eq!(&line.text[line.span], "X");
    }
}
