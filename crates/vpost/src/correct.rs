//! `vpost IN.nc -m PROFILE`: the main job on a file.

mod program;

use std::path::Path;
use std::sync::Mutex;

use rewrite::Manner;

use crate::arguments::{self, Shared};
use crate::file;
use crate::interrupt::Interrupt;
use crate::message::{Failure, Messages};
use crate::roles::Roles;
use crate::summary::Summary;
pub(crate) use jobs::correct::Program;
pub(crate) use program::{Input, program};

/// `vpost IN.nc -m PROFILE`
pub(crate) fn run(
    arguments: &arguments::Correct,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    let path = arguments.input.as_deref().unwrap_or(Path::new("-"));
    let settings = crate::settings::load(shared, messages)?;
    Roles::default()
        .reads("the program", path)
        .reads_all("read by the profile", &settings.files)
        .reads_folders("in a folder of subprograms", &shared.job.include)
        .writes("--output", arguments.output.as_deref())
        .writes("--summary", arguments.summary.as_deref())
        .are_apart()?;
    let input = Input::open(path);
    let interrupt = Interrupt::listen();
    let linuxcnc = arguments.progress.is_some();
    let reported = Mutex::new(None);
    let report = |percent: u64| {
        let mut reported = reported.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if linuxcnc && *reported != Some(percent) {
            messages.note(&format!("FILTER_PROGRESS={percent}"));
            *reported = Some(percent);
        }
    };
    let progress = |done: f64| {
        interrupt.check()?;
        report((done * 100.0) as u64);
        Ok(())
    };
    let manner = Manner {
        force: arguments.force,
        threads: rayon::current_num_threads(),
        hashes: arguments.summary.is_some(),
    };
    let mut output = file::Output::new(arguments.output.as_deref())?;
    let done = program(input, &settings, manner, &mut output, &progress)?;
    interrupt.check()?;
    report(100);
    // All that can fail before the program gets its name.
    let summary = match arguments.summary.as_deref() {
        Some(path) => Some(file::written(path, &Summary::new(&settings, &done).json())?),
        None => None,
    };
    output.finish()?;
    summary.map_or(Ok(()), file::Output::finish)?;
    for report in &done.warnings {
        messages.report(report);
    }
    if shared.messages.verbose > 0 {
        messages.note(&Summary::line(&done.figures));
    }
    Ok(())
}
