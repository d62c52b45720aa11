//! The main job on a program in memory.

use diagnostic::{Diagnostic, Severity};
use rewrite::{Digest, Figures, Manner};

use crate::expand::{self, Lookup};
use crate::lines::check_lines;
use crate::message::{Failure, Report};
use crate::settings::Settings;

/// A program that was corrected.
#[derive(Debug)]
pub struct Program {
    /// The name that messages know it by.
    pub name: String,
    /// Of what came in.
    pub input: Digest,
    /// Of what went out.
    pub output: Digest,
    /// The output is not the input.
    pub changed: bool,
    /// What was done.
    pub figures: Figures,
    /// What is to be said.
    pub warnings: Vec<Report>,
    /// Subprograms that were looked for.
    pub lookups: Vec<Lookup>,
}

/// Corrects a text as the command corrects a file: all that it refuses is refused, and so are, where the options say it,
/// doubtful programs.
///
/// `progress` is told the share that is done, 0 to 1, and may end the work.
///
/// # Errors
/// What is wrong with the program, or what `progress` said.
pub fn text(
    text: &[u8],
    name: &str,
    settings: &Settings,
    manner: Manner,
    progress: impl FnMut(f64) -> Result<(), Failure>,
) -> Result<(Vec<u8>, Program), Failure> {
    check_lines(text, name)?;
    let done = in_memory(text, name, settings, manner, progress)?;
    if settings.strict {
        refuse_doubts(&done.1.warnings, |_| true)?;
    }
    Ok(done)
}

/// Corrects a program whose lines are known to be short, however doubtful it is.
///
/// # Errors
/// What is wrong with the program, or what `progress` said.
pub fn in_memory(
    text: &[u8],
    name: &str,
    settings: &Settings,
    manner: Manner,
    progress: impl FnMut(f64) -> Result<(), Failure>,
) -> Result<(Vec<u8>, Program), Failure> {
    let expand::Done { corrected, warnings, lookups } =
        expand::correct(text, name, settings, manner, progress)?;
    let program = Program {
        name: name.to_owned(),
        input: Digest::of(text, manner.hashes),
        output: Digest::of(&corrected.text, manner.hashes),
        changed: corrected.text != text,
        figures: corrected.figures,
        warnings,
        lookups,
    };
    Ok((corrected.text, program))
}

/// Refuses a program for the warnings that it is doubtful.
///
/// # Errors
/// The doubts, as errors.
pub fn refuse_doubts(warnings: &[Report], are_refused: impl Fn(&Diagnostic) -> bool) -> Result<(), Failure> {
    let doubts = |report: &Report| {
        let is_doubt = |warning: &&Diagnostic| warning.severity == Severity::Doubt && are_refused(warning);
        let doubtful = report.diagnostics.iter().filter(is_doubt);
        let diagnostics: Vec<Diagnostic> =
            doubtful.map(|doubt| Diagnostic { severity: Severity::Error, ..doubt.clone() }).collect();
        (!diagnostics.is_empty()).then(|| Report { source: report.source.clone(), diagnostics })
    };
    let doubts: Vec<Report> = warnings.iter().filter_map(doubts).collect();
    if doubts.is_empty() { Ok(()) } else { Err(Failure::Refused(doubts)) }
}
