//! Messages on standard error.

use std::io::{IsTerminal, Write};

use diagnostic::{Diagnostic, Language, Text};
pub(crate) use jobs::message::*;
use jobs::shown::shown;

use crate::color::Color;

/// Where messages go.
#[derive(Debug)]
pub(crate) struct Messages {
    wording: Wording,
    quiet: bool,
    language: Language,
}

impl Messages {
    pub(crate) fn new(color: Color, language: Language) -> Self {
        let colored = match color {
            Color::Always => true,
            Color::Never => false,
            Color::Auto => std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none(),
        };
        let wording = if colored { Wording::colored() } else { Wording::plain() }.speaking(language);
        Self { wording, quiet: false, language }
    }

    /// The same with errors alone.
    pub(crate) fn quiet(self) -> Self {
        Self { wording: self.wording.quiet(), quiet: true, ..self }
    }

    /// Prints a failure.
    pub(crate) fn failure(&self, failure: &Failure) {
        let text = self.text(failure);
        if !text.is_empty() {
            self.line(&text);
        }
    }

    /// A failure's text; its warnings only where the user wants them.
    pub(crate) fn text(&self, failure: &Failure) -> String {
        self.wording.text(failure)
    }

    /// Prints diagnostics; warnings only where the user wants them.
    pub(crate) fn report(&self, report: &Report) {
        for text in self.wording.rendered(report) {
            self.line(&text);
        }
    }

    /// Prints what is said as a warning about no text, where the user wants warnings.
    pub(crate) fn warning(&self, said: Diagnostic) {
        self.report(&Report::warning(said));
    }

    /// Prints a line about progress or result, unless quiet.
    pub(crate) fn note(&self, text: &Text) {
        if !self.quiet {
            self.line(&shown(text.in_language(self.language)));
        }
    }

    /// The language people are spoken to in.
    pub(crate) fn language(&self) -> Language {
        self.language
    }

    /// The user wants errors alone.
    pub(crate) fn are_quiet(&self) -> bool {
        self.quiet
    }

    fn line(&self, text: &str) {
        // A closed standard error leaves nobody to tell.
        let _ = writeln!(std::io::stderr().lock(), "{text}");
    }
}
