//! What is said before the work and after it.

use std::collections::BTreeSet;
use std::path::Path;

use super::outcome::Outcome;
use super::progress::Progress;
use super::work::Results;
use super::{inputs, record, table};
use crate::file;
use crate::message::{Failure, Messages, OPTION, Report};
use diagnostic::{Language, Text, both, notice};

/// What a folder held besides programs: a program of an unusual name must not be missed.
pub(super) fn passed_over(found: &inputs::Found, messages: &Messages) {
    for (paths, what, way) in [
        (
            &found.others,
            Text::pair(
                "file(s) are no programs by name or kind and were passed over",
                "файлы, которые по имени или виду не программы, пропущены",
            ),
            Text::pair("see `--pattern`", "см. `--pattern`"),
        ),
        (
            &found.links,
            Text::pair("link(s) to folders were not followed", "ссылки на папки не просмотрены"),
            Text::pair("name such a folder itself", "назовите саму папку"),
        ),
        (
            &found.outputs,
            Text::pair(
                "folder(s) of another `vpost batch`'s outputs were passed over",
                "папки с выходными файлами другого `vpost batch` пропущены",
            ),
            Text::pair(
                "correct programs as posted",
                "исправляйте программы в том виде, как их выдал постпроцессор",
            ),
        ),
    ] {
        if let Some(first) = paths.first() {
            messages.note(&both!(
                "{} {}, {} the first ({})",
                "{1:#}: {0}, первый — {2} ({3:#})",
                paths.len(),
                what,
                first.display(),
                way
            ));
        }
    }
}

/// No more refusals are printed with their lines.
const MOST_PRINTED: usize = 20;

/// Refusals as they happen.
pub(super) struct Printing<'a> {
    progress: &'a Progress,
    messages: &'a Messages,
    printed: usize,
    /// Messages about no line of a program: said once, for a full disk says the same of each.
    said: BTreeSet<String>,
}

impl<'a> Printing<'a> {
    pub(super) fn new(progress: &'a Progress, messages: &'a Messages) -> Self {
        Self { progress, messages, printed: 0, said: BTreeSet::new() }
    }

    pub(super) fn tell(&mut self, outcome: &Outcome) {
        if outcome.record.status.is_done() || self.printed >= MOST_PRINTED {
            return;
        }
        let Self { said, printed, messages, .. } = self;
        let new = |report: &&Report| match (&report.source, report.diagnostics.as_slice()) {
            (None, [only]) => said.insert(only.message.english().to_owned()),
            _ => true,
        };
        let told: Vec<&Report> = outcome.told.iter().filter(new).collect();
        *printed += usize::from(!told.is_empty());
        self.progress.aside(|| told.into_iter().for_each(|report| messages.report(report)));
    }
}

/// What is done stays, and the next run begins there.
pub(super) fn interrupted(failure: Failure, messages: &Messages) -> Failure {
    let Failure::Interrupted(signal) = failure else { return failure };
    messages.note(&both!(
        "interrupted: what is done is done; the same command goes on from there",
        "прервано: сделанное сделано; та же команда продолжит с этого места"
    ));
    Failure::Said(128 + signal)
}

/// The results' folder is there: hours later is late to say that it is not.
pub(super) fn has_place(lines: Option<&Path>) -> Result<(), Failure> {
    let folder = lines.and_then(Path::parent).filter(|folder| !folder.as_os_str().is_empty());
    match folder {
        Some(folder) if !folder.is_dir() => Err(Failure::usage(notice!(OPTION;
            "`--results`: there is no folder {}", "`--results`: папки {} нет", folder.display();
            "make it first, or name a file in a folder that is there",
            "создайте её или назовите файл в существующей папке"
        ))),
        _ => Ok(()),
    }
}

/// Results to disk and to the user, who gets the table whatever cannot be written.
pub(super) fn finish(results: &Results, lines: Option<&Path>, language: Language) -> Result<(), Failure> {
    let (written, printed) = match lines {
        Some(path) if path.as_os_str() == "-" => (Ok(()), file::print(&record::lines(&results.records))),
        path => (
            path.map_or(Ok(()), |path| file::write(path, &record::lines(&results.records))),
            file::print(table::table(results, language).as_bytes()),
        ),
    };
    written.and(printed)
}
