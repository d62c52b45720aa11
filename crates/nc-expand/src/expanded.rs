//! What a program is expanded against, and what it becomes.

use std::borrow::Cow;
use std::io;
use std::ops::Range;

use diagnostic::Diagnostic;
use nc_program::Setup;

use crate::came::{Origin, Refused};
use crate::output::{self, Segment};
use crate::variables::Preset;

/// What was done, for the comment in the output, where shorthand alone was written out.
pub const SHORTHAND_WRITTEN_OUT: &str = "SHORTHAND WRITTEN OUT";

/// Where work ends that would not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Executions of blocks that were executed before, parts of long expressions counted.
    pub steps: u64,
    /// Bytes that the flat program may have beyond three times the source.
    pub output_bytes: u64,
    /// Calls inside one another. LinuxCNC and Fanuc allow 10.
    pub depth: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self { steps: 5_000_000, output_bytes: 64 << 20, depth: 10 }
    }
}

/// What the program cannot say of itself.
pub struct Environment<'e> {
    /// Values of variables.
    pub variables: &'e [Preset],
    /// Reads a subprogram's file by its name, which holds no folder.
    pub read_external: &'e dyn Fn(&str) -> io::Result<Vec<u8>>,
    /// Against what the plain program will be read: where its shorthand starts, the one reader of programs says.
    pub setup: &'e Setup,
    /// Where work ends that would not.
    pub limits: Limits,
}

/// A program that could not be expanded.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// Why.
    pub diagnostics: Vec<Diagnostic>,
    /// Name and bytes of the file they speak of; `None`: the program itself.
    pub file: Option<(String, Vec<u8>)>,
}

/// A plain program.
#[derive(Clone, Debug, Default)]
pub struct Expanded<'a> {
    pub(crate) text: Cow<'a, [u8]>,
    /// Called files: name and bytes.
    pub(crate) files: Vec<(String, Vec<u8>)>,
    /// Where each stretch of it comes from; none where it is the source.
    pub(crate) segments: Vec<Segment>,
    /// The program had flow.
    pub(crate) flows: bool,
    /// It had shorthand.
    pub(crate) lowers: bool,
    pub(crate) warnings: Vec<Diagnostic>,
}

impl Expanded<'_> {
    /// The plain program's bytes.
    #[must_use]
    pub fn text(&self) -> &[u8] {
        &self.text
    }

    /// True where the program had flow; else its text is the source's.
    #[must_use]
    pub const fn changed(&self) -> bool {
        matches!(self.text, Cow::Owned(_))
    }

    /// What the user should know; places are in the program itself.
    #[must_use]
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// Name and bytes of a called file, from 1.
    #[must_use]
    pub fn file(&self, index: usize) -> Option<(&str, &[u8])> {
        self.files.get(index.checked_sub(1)?).map(|(name, text)| (name.as_str(), text.as_slice()))
    }

    /// What was done, for the comment in the output.
    #[must_use]
    pub const fn what(&self) -> &'static str {
        match (self.flows, self.lowers) {
            (false, false) => "",
            (true, false) => "PROGRAM FLOW EXPANDED",
            (false, true) => SHORTHAND_WRITTEN_OUT,
            (true, true) => "PROGRAM FLOW EXPANDED, SHORTHAND WRITTEN OUT",
        }
    }

    /// Where bytes of the plain program come from: the same bytes where they were copied, else the block
    /// they stand for.
    #[must_use]
    pub fn origin(&self, span: &Range<u64>) -> Origin {
        if self.changed() {
            output::origin(&self.segments, span)
        } else {
            Origin { file: 0, span: span.clone() }
        }
    }

    /// The line of the source that a line of the plain program comes from, with its file.
    #[must_use]
    pub fn source_line(&self, line: u64) -> (usize, u64) {
        output::source_line(&self.segments, line)
    }

    /// Puts the places of diagnostics about the plain program into the source files: by file, in order.
    #[must_use]
    pub fn settle(&self, diagnostics: Vec<Diagnostic>) -> Vec<(usize, Vec<Diagnostic>)> {
        let mut settled: Vec<(usize, Vec<Diagnostic>)> = Vec::new();
        for mut diagnostic in diagnostics {
            let origin = diagnostic.span.as_ref().map(|span| self.origin(span));
            let file = origin.as_ref().map_or(0, |origin| origin.file);
            diagnostic.span = origin.map(|origin| origin.span);
            // What is written out is no text that anybody edits.
            if self.changed() && diagnostic.edit().is_some() {
                diagnostic.way_out = None;
            }
            match settled.last_mut().filter(|(last, _)| *last == file) {
                Some((_, same)) => same.push(diagnostic),
                None => settled.push((file, vec![diagnostic])),
            }
        }
        settled
    }
}

impl Refusal {
    /// Of a program that has called these files.
    pub(crate) fn of(refused: Refused, files: &[(String, Vec<u8>)]) -> Self {
        let file = usize::from(refused.file).checked_sub(1).and_then(|at| files.get(at)).cloned();
        Self { diagnostics: vec![refused.diagnostic], file }
    }
}
