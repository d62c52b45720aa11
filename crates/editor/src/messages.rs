//! Messages where they belong: under the words that they speak of.

use diagnostic::{Code, Diagnostic, Edit, Language, Severity, both, notice};
use jobs::correct;
use jobs::message::{Failure, HELP, Report, Source};
use lsp_types::{
    Diagnostic as Squiggle, DiagnosticRelatedInformation, DiagnosticSeverity, Location, NumberOrString,
};
use rewrite::Manner;

use crate::document::Document;
use crate::machine::Machine;
use crate::place::Place;

/// What is not checked while it is typed.
const TOO_LARGE: Code = Code(9);
/// The largest program that is: some tenths of a second each time.
const LARGEST_MB: usize = 16;

/// A message in its place, and the edit that is its way out.
pub(crate) struct Marked {
    pub(crate) squiggle: Squiggle,
    pub(crate) mended: Option<(String, Edit)>,
}

/// What the command would say of a program; `None` where `stop` said that somebody waits.
pub(crate) fn check(
    document: &Document,
    place: &Place,
    machine: Result<&Machine, Failure>,
    stop: &dyn Fn() -> bool,
) -> Option<Vec<Report>> {
    let megabytes = document.text().len() >> 20;
    if megabytes > LARGEST_MB {
        return Some(vec![Report::warning(notice!(TOO_LARGE;
            "a program of {megabytes} MB is not checked while it is edited, up to {LARGEST_MB} MB are",
            "программа в {megabytes} МБ во время правки не проверяется, проверяются до {LARGEST_MB} МБ";
            "`vpost {}` checks it, whatever its size", "`vpost {}` проверит её, какой бы большой она ни была",
            place.name()
        ))]);
    }
    let machine = match machine {
        Ok(machine) => machine,
        Err(failure) => return Some(failure.reports().to_vec()),
    };
    let manner = Manner { force: false, threads: 1, hashes: false };
    let goes_on = |_| if stop() { Err(Failure::Interrupted(0)) } else { Ok(()) };
    let settings = &machine.settings;
    let said = match correct::text(document.text().as_bytes(), place.name(), settings, manner, goes_on) {
        Ok((_, program)) => program.warnings,
        Err(Failure::Interrupted(_)) => return None,
        Err(failure) => failure.reports().to_vec(),
    };
    Some(settings.warnings.iter().cloned().chain(said).collect())
}

/// Reports as an editor shows them: what another file says stands in the first line, and leads there.
pub(crate) fn marked(
    document: &Document,
    place: &Place,
    reports: &[Report],
    language: Language,
) -> Vec<Marked> {
    let all = reports.iter().flat_map(|report| report.diagnostics.iter().map(move |one| (report, one)));
    all.map(|(report, one)| {
        let own = report.source.as_ref().is_none_or(|source| source.name == place.name());
        let span = one.span.as_ref().filter(|_| own && report.source.is_some());
        let range = span.map_or_else(|| document.whole_line(1), |span| document.range(span));
        let elsewhere = report.source.as_ref().filter(|_| !own).and_then(|source| {
            let message = one.label.in_language(language).to_owned();
            Some(DiagnosticRelatedInformation { location: location(source, one, place)?, message })
        });
        let squiggle = Squiggle {
            range,
            severity: Some(match one.severity {
                Severity::Error => DiagnosticSeverity::ERROR,
                Severity::Warning | Severity::Doubt => DiagnosticSeverity::WARNING,
            }),
            code: Some(NumberOrString::String(one.code.to_string())),
            source: Some("vpost".to_owned()),
            message: text(one, language),
            related_information: elsewhere.map(|elsewhere| vec![elsewhere]),
            ..Squiggle::default()
        };
        let help = one.help.as_ref().map(|help| help.in_language(language).to_owned());
        let edit = one.edit().filter(|_| own).cloned();
        Marked { squiggle, mended: help.zip(edit) }
    })
    .collect()
}

/// What a message says: what is wrong, what stands there, the way out.
pub(crate) fn text(one: &Diagnostic, language: Language) -> String {
    let mut text = one.message.in_language(language).to_owned();
    if !one.label.is_empty() {
        text = format!("{text}\n{}", one.label.in_language(language));
    }
    if let Some(help) = &one.help {
        text = format!("{text}\n{}: {}", HELP.in_language(language), help.in_language(language));
    }
    text
}

/// Where a message about another file points.
fn location(source: &Source, one: &Diagnostic, place: &Place) -> Option<Location> {
    let other = Document::new(String::from_utf8_lossy(&source.bytes).into_owned());
    let range = one.span.as_ref().map_or_else(|| other.whole_line(1), |span| other.range(span));
    Some(Location { uri: place.beside(&source.name)?, range })
}

/// What is said of a message of the protocol that was not read.
pub(crate) fn not_read(megabytes: u64) -> Diagnostic {
    notice!(TOO_LARGE;
        "what the editor sent was {megabytes} MB large, and was not read",
        "редактор прислал {megabytes} МБ, это не прочитано";
        both!("`vpost FILE` checks a program of any size", "`vpost ФАЙЛ` проверит программу любого размера")
    )
}
