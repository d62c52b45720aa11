//! `vpost batch`: many programs, on all cores of one machine or on many machines.
//!
//! Here, a run finds the programs (`inputs`), corrects each on its own (`work`), puts outputs into place whole
//! (`folder`) and keeps a journal of what is done (`journal`).

mod arguments;
mod causes;
mod cluster;
mod folder;
mod inputs;
mod job;
mod journal;
mod manifest;
mod outcome;
mod progress;
mod record;
mod report;
mod shard;
mod shelf;
mod table;
mod watch;
mod work;

use std::path::Path;

pub use arguments::Batch;
use arguments::BatchCommand;
pub(crate) use inputs::ENDINGS;
pub use watch::Watch;
pub(crate) use watch::run as watch;

use diagnostic::both;

use crate::arguments::Shared;
use crate::exit_status::REFUSED;

use crate::interrupt::Interrupt;
use crate::message::{Failure, Messages};
use crate::roles::Roles;
use folder::{Company, OutputFolder};
use job::Job;
use journal::Journal;
use progress::Progress;
use report::{Printing, finish, has_place, interrupted, passed_over};

/// `vpost batch`
pub(crate) fn run(arguments: &Batch, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    match &arguments.command {
        None => here(arguments, shared, messages),
        Some(BatchCommand::Plan(plan)) => cluster::plan(plan, shared, messages),
        Some(BatchCommand::Run(run)) => cluster::run(run, shared, messages),
        Some(BatchCommand::Merge(merge)) => cluster::merge(merge, messages),
    }
}

/// All programs on this machine.
fn here(arguments: &Batch, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let root = arguments.programs.output.as_deref().unwrap_or(Path::new("."));
    let job = Job::load(shared, messages)?;
    has_place(arguments.work.results.as_deref())?;
    let found = inputs::find(&arguments.programs, root)?;
    shared.held.is_of_all(found.items.iter().map(|item| item.input.as_path()))?;
    Roles::default()
        .reads_all(&both!("a program", "программа"), found.items.iter().map(|item| &item.input))
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &job.settings.files)
        .writes("--results", arguments.work.results.as_deref().filter(|path| path.as_os_str() != "-"))
        .are_apart()?;
    passed_over(&found, messages);
    let interrupt = Interrupt::listen();
    let folder = OutputFolder::open(root, Company::Alone)?;
    if !folder.is_locked() && shared.messages.verbose > 0 {
        messages
            .note(&both!("the output folder's file system knows no locks: nothing that a killed run left is swept", "файловая система выходной папки не знает блокировок: то, что осталось от прерванного запуска, не убирается"));
    }
    let earlier = journal::read(&folder.journal(), None)?;
    let mut journal = Journal::begin(&folder, journal::WHOLE)?;
    let progress = Progress::new(&found.items, messages);
    let batch = work::Batch {
        job: &job,
        folder: &folder,
        earlier: &earlier,
        force: arguments.force,
        threads: work::threads(arguments.work.jobs),
        interrupt: &interrupt,
    };
    let mut printing = Printing::new(&progress, messages);
    let results = batch.run(&found.items, &mut journal, &progress, &mut |outcome| printing.tell(outcome));
    progress.end();
    let results = results.map_err(|failure| interrupted(failure, messages))?;
    let kept = journal.end(&earlier, &results.records);
    finish(&results, arguments.work.results.as_deref(), messages.language())?;
    kept?;
    if results.records.iter().all(|record| record.status.is_done()) {
        Ok(())
    } else {
        Err(Failure::Said(REFUSED))
    }
}
