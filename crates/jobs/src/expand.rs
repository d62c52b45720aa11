//! Programs with flow: values and folders from the command line, places back in the user's files.

use std::cell::RefCell;
use std::io;

use diagnostic::Diagnostic;
use nc_expand::{Environment, Expanded};
use nc_program::{Evidence, Finding};
use rewrite::{Corrected, Job, Manner};
use serde::{Deserialize, Serialize};

use crate::flow::Flow;
use crate::message::{Failure, Report, Source};
use crate::settings::Settings;

/// A text's plain program.
///
/// # Errors
/// What cannot be executed.
pub fn expanded<'a>(text: &'a [u8], name: &str, settings: &Settings) -> Result<Expanded<'a>, Failure> {
    expanded_with(text, name, settings, &|file| settings.flow.read(file))
}

fn expanded_with<'a>(
    text: &'a [u8],
    name: &str,
    settings: &Settings,
    read: &dyn Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<Expanded<'a>, Failure> {
    let environment = Environment {
        variables: settings.flow.presets(),
        read_external: read,
        setup: &settings.setup,
        limits: settings.flow.limits,
    };
    nc_expand::expand(text, &settings.dialect, &environment).map_err(|refusal| match refusal.file {
        None => Failure::refused(name, text, refusal.diagnostics),
        Some((name, text)) => Failure::refused(&name, &text, refusal.diagnostics),
    })
}

/// Diagnostics about a plain program as reports about the files it was made from.
#[must_use]
pub fn reports(
    expanded: &Expanded<'_>,
    name: &str,
    text: &[u8],
    diagnostics: Vec<Diagnostic>,
) -> Vec<Report> {
    let report = |(file, diagnostics): (usize, Vec<Diagnostic>)| {
        let (name, bytes) = expanded.file(file).unwrap_or((name, text));
        Report { source: Some(Source::whole(name, bytes)), diagnostics }
    };
    expanded.settle(diagnostics).into_iter().map(report).collect()
}

/// A corrected program and what is to be said about it.
#[derive(Debug)]
pub struct Done {
    /// The program and its figures.
    pub corrected: Corrected,
    /// By the file they are about.
    pub warnings: Vec<Report>,
    /// Subprograms that were looked for.
    pub lookups: Vec<Lookup>,
}

/// A subprogram's file that was looked for: its name, and the hash of what was there.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lookup {
    /// Of the file.
    pub name: String,
    /// Of its bytes, where it was there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub blake3: Option<String>,
}

impl Lookup {
    fn of(name: &str, found: &io::Result<Vec<u8>>) -> Self {
        let blake3 = found.as_ref().ok().map(|bytes| blake3::hash(bytes).to_hex().to_string());
        Self { name: name.to_owned(), blake3 }
    }

    /// True where the same lookup finds the same today.
    #[must_use]
    pub fn holds(&self, flow: &Flow) -> bool {
        *self == Self::of(&self.name, &flow.read(&self.name))
    }
}

/// Expands and corrects a program; what needs no correction comes out byte for byte, flow and all.
///
/// `progress` is told the share that is done, 0 to 1, and may end the work.
///
/// # Errors
/// What is wrong with the program, or what `progress` said.
pub fn correct(
    text: &[u8],
    name: &str,
    settings: &Settings,
    manner: Manner,
    mut progress: impl FnMut(f64) -> Result<(), Failure>,
) -> Result<Done, Failure> {
    nc_syntax::looks_like_program(text)
        .map_err(|diagnostic| Failure::refused(name, text, vec![diagnostic]))?;
    // The mark of an earlier correction may stand where the flat program does not come by.
    if let (Some(diagnostic), false) = (rewrite::corrected_before(text), manner.force) {
        return Err(Failure::refused(name, text, vec![diagnostic]));
    }
    let done = match correct_plain(text, name, settings, manner, &mut progress) {
        Ok(Plain::Done(done)) => Ok(*done),
        Ok(Plain::Not(refused)) => correct_expanded(text, name, settings, refused, progress),
        Err(failure) => Err(failure),
    };
    done.map_err(|failure| with_control(failure, text, name, settings))
}

/// A refusal, and where the program looks written for another control than its dialect's, that.
fn with_control(failure: Failure, text: &[u8], name: &str, settings: &Settings) -> Failure {
    let Failure::Refused(mut reports) = failure else { return failure };
    let said = |report: &Report| {
        report.diagnostics.iter().any(|diagnostic| diagnostic.code == nc_program::codes::LOOKS_LIKE)
    };
    if !reports.iter().any(said)
        && let Some(diagnostic) = nc_program::looks_like(text, &settings.dialect)
    {
        // Its line alone is shown: of a large program no copy is made for it.
        let end = diagnostic.span.as_ref().map_or(0, |span| span.end as usize);
        let source = Some(Source::whole(name, &text[..end.min(text.len())]));
        reports.push(Report { source, diagnostics: vec![diagnostic] });
    }
    Failure::Refused(reports)
}

/// `refused`: what the short way said, which holds of a text that is its own plain program.
fn correct_expanded(
    text: &[u8],
    name: &str,
    settings: &Settings,
    refused: Option<Vec<Diagnostic>>,
    mut progress: impl FnMut(f64) -> Result<(), Failure>,
) -> Result<Done, Failure> {
    // Of the text as it was written: a loop counts once, and what is computed says nothing of how lengths are written.
    let questions = settings.questions();
    let evidence = Evidence::of(text, &questions);
    evidence.refusal(&questions).map_err(|finding| Failure::refused(name, text, vec![finding.0]))?;
    let lookups = RefCell::new(Vec::new());
    let expanded = expanded_with(text, name, settings, &|file| {
        let found = settings.flow.read(file);
        lookups.borrow_mut().push(Lookup::of(file, &found));
        found
    })?;
    let mut provenance = settings.provenance();
    if expanded.changed() {
        provenance.push(' ');
        provenance.push_str(expanded.what());
    }
    // Looked for above, in the text as it was given.
    let job = Job { force: true, ..settings.job(&provenance)? };
    let total = expanded.text().len().max(1) as f64;
    let source_line = |line| expanded.source_line(line).1;
    let result = match refused.filter(|_| !expanded.changed()) {
        Some(refused) => Err(PipelineEnd::Refused(refused)),
        None => rewrite::correct(expanded.text(), &job, source_line, |done| {
            progress(done as f64 / total).map_err(PipelineEnd::Failed)
        }),
    };
    let mut corrected = match result {
        Ok(corrected) => corrected,
        Err(PipelineEnd::Refused(diagnostics)) => {
            let diagnostics = rewrite::all_refusals(expanded.text(), &job, diagnostics);
            return Err(Failure::Refused(reports(&expanded, name, text, diagnostics)));
        }
        Err(PipelineEnd::Failed(failure)) => return Err(failure),
    };
    let mut warnings = reports(&expanded, name, text, corrected.figures.warnings.clone());
    let mut doubt = |name: &str, text: &[u8], findings: Vec<Finding>| {
        let diagnostics: Vec<Diagnostic> = findings.into_iter().map(|(diagnostic, _)| diagnostic).collect();
        if !diagnostics.is_empty() {
            corrected.figures.warnings.extend_from_slice(&diagnostics);
            warnings.push(Report { source: Some(Source::whole(name, text)), diagnostics });
        }
    };
    doubt(name, text, evidence.doubts(&questions));
    for (name, text) in (1..).map_while(|index| expanded.file(index)) {
        let evidence = Evidence::of(text, &questions);
        evidence.refusal(&questions).map_err(|finding| Failure::refused(name, text, vec![finding.0]))?;
        doubt(name, text, evidence.doubts_of_a_part(&questions));
    }
    if corrected.text == expanded.text() {
        corrected.text = text.to_vec();
    } else if !expanded.warnings().is_empty() {
        corrected.figures.warnings.extend_from_slice(expanded.warnings());
        let diagnostics = expanded.warnings().to_vec();
        warnings.push(Report { source: Some(Source::whole(name, text)), diagnostics });
    }
    Ok(Done { corrected, warnings, lookups: lookups.into_inner() })
}

/// What comes of the short way.
enum Plain {
    Done(Box<Done>),
    /// The program has flow; or is refused, and the long way says of all of it why.
    Not(Option<Vec<Diagnostic>>),
}

/// The short way of a program that has no flow, as most have none: one pass instead of two.
fn correct_plain(
    text: &[u8],
    name: &str,
    settings: &Settings,
    manner: Manner,
    mut progress: impl FnMut(f64) -> Result<(), Failure>,
) -> Result<Plain, Failure> {
    let provenance = settings.provenance();
    let job = Job { force: manner.force, ..settings.job(&provenance)? };
    let total = text.len().max(1) as f64;
    let result =
        rewrite::correct_plain(text, &job, |done| progress(done as f64 / total).map_err(PipelineEnd::Failed));
    let mut corrected = match result {
        Ok(Some(corrected)) => corrected,
        Ok(None) => return Ok(Plain::Not(None)),
        Err(PipelineEnd::Refused(diagnostics)) => return Ok(Plain::Not(Some(diagnostics))),
        Err(PipelineEnd::Failed(failure)) => return Err(failure),
    };
    let questions = settings.questions();
    if corrected.evidence.refusal(&questions).is_err() {
        return Ok(Plain::Not(None));
    }
    let doubts = corrected.evidence.doubts(&questions).into_iter().map(|(diagnostic, _)| diagnostic);
    let told = [corrected.figures.warnings.clone(), doubts.collect()];
    corrected.figures.warnings = told.concat();
    let report = |diagnostics| Report { source: Some(Source::whole(name, text)), diagnostics };
    let warnings = told
        .into_iter()
        .filter(|diagnostics: &Vec<Diagnostic>| !diagnostics.is_empty())
        .map(report)
        .collect();
    Ok(Plain::Done(Box::new(Done { corrected, warnings, lookups: Vec::new() })))
}

/// Why a pipeline ended early.
pub(crate) enum PipelineEnd {
    Refused(Vec<Diagnostic>),
    Failed(Failure),
}

impl From<Vec<Diagnostic>> for PipelineEnd {
    fn from(diagnostics: Vec<Diagnostic>) -> Self {
        Self::Refused(diagnostics)
    }
}

#[cfg(test)]
mod tests {

    use std::path::Path;

    use super::*;
    use crate::options::JobOptions;

    #[test]
    fn the_short_way_is_the_long_way() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let profile = root.join("machine-profiles/stan_s500.toml");
        let (mut short, mut long, mut warned) = (0, 0, 0);
        let manner = Manner { force: true, threads: 1, hashes: false };
        for dialect in ["linuxcnc", "fanuc"] {
            let options = JobOptions {
                machine: Some(profile.clone()),
                dialect: Some(dialect.to_owned()),
                ..JobOptions::default()
            };
            let settings = Settings::load(&options).unwrap();
            let samples = root.join("samples").read_dir().unwrap().map(|entry| entry.unwrap().path());
            let mut programs: Vec<(String, Vec<u8>)> = samples
                .filter(|path| path.is_file() && path.to_string_lossy().contains(dialect))
                .map(|path| (path.display().to_string(), std::fs::read(path).unwrap()))
                .collect();
            let warned_of = "G21 G90 G17 G54\nG43 H1\nG0 X10. Y10. Z30.\nG1 Z15. F600\nG41 D1 X20.\nY30.\nG40 X40.\nM30\n";
            programs.push(("warned of".to_owned(), warned_of.into()));
            for (name, text) in programs {
                let long_way = |refused| correct_expanded(&text, &name, &settings, refused, |_| Ok(()));
                let whole = long_way(None);
                let done = match correct_plain(&text, &name, &settings, manner, |_| Ok(())).unwrap() {
                    Plain::Done(done) => done,
                    Plain::Not(refused) => {
                        assert_eq!(format!("{:?}", long_way(refused)), format!("{whole:?}"), "{name}");
                        long += 1;
                        continue;
                    }
                };
                let whole = whole.unwrap_or_else(|_| panic!("{name} is refused one way only"));
                assert!(done.corrected == whole.corrected, "{name}");
                assert_eq!(format!("{:?}", done.warnings), format!("{:?}", whole.warnings), "{name}");
                assert_eq!(done.lookups, whole.lookups);
                // Seen on the way of the correction, plain lines nearly free, is what reading each block shows.
                assert_eq!(done.corrected.evidence, Evidence::of(&text, &settings.questions()), "{name}");
                short += 1;
                warned += done.warnings.len();
            }
        }
        assert!(short > 5 && long > 0 && warned > 0, "{short} {long} {warned}");
    }
}
