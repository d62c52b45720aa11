//! The same on many machines: plan once, run shares anywhere, merge.
//!
//! A share is a task without state: what it needs is in the manifest, what it knows of earlier attempts it reads from the
//! output folder. Who starts the tasks, again where they were killed, is somebody else: HyperQueue, Slurm, GNU parallel.

use std::path::Path;

use diagnostic::both;
use rayon::prelude::*;

use super::arguments::{EngineForm, Merge, Plan, Run};
use super::folder::{self, Company, OutputFolder};
use super::inputs::{self, Item};
use super::job::Job;
use super::journal::{self, Journal, Records};
use super::manifest::{self, Manifest};
use super::progress::Progress;
use super::record::{Record, Status};
use super::report::{Printing, finish, has_place, interrupted, passed_over};
use super::shard::{self, Shard};
use super::work::{self, Results};
use crate::arguments::Shared;
use crate::exit_status::{REFUSED, TRY_AGAIN};
use crate::file;
use crate::interrupt::Interrupt;
use crate::message::{Failure, Messages};
use crate::roles::Roles;

/// `vpost batch plan`
pub(crate) fn plan(arguments: &Plan, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let root = arguments.programs.output.as_deref().unwrap_or(Path::new("."));
    let job = Job::load(shared, messages)?;
    let found = inputs::find(&arguments.programs, root)?;
    shared.held.is_of_all(found.items.iter().map(|item| item.input.as_path()))?;
    passed_over(&found, messages);
    // Other machines know the programs by their names alone.
    found.items.iter().try_for_each(Item::needs_name)?;
    let text = manifest::text(&found.items, root, &job, shared)?;
    manifest::write(&arguments.manifest, &text)?;
    let megabytes = found.items.iter().map(|item| item.bytes).sum::<u64>() as f64 / 1e6;
    let said = both!(
        "{} programs, {megabytes:.3} MB, to correct\n",
        "программ к исправлению: {}, {megabytes:.3} МБ\n",
        found.items.len()
    );
    file::print(said.in_language(messages.language()).as_bytes())
}

/// `vpost batch run`
pub(crate) fn run(arguments: &Run, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    share(arguments, shared, messages).map_err(|failure| match failure {
        // Of a disk that is full or a share that is gone the next attempt may know nothing.
        Failure::File(report) => Failure::Later(report),
        failure => failure,
    })
}

fn share(arguments: &Run, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    has_place(arguments.work.results.as_deref())?;
    let shard = Shard::read(arguments.shard.as_deref(), |name| std::env::var(name).ok())?;
    let manifest = Manifest::read(&arguments.manifest)?;
    let job = manifest.job(shared, messages)?;
    let items: Vec<Item> = manifest
        .items
        .iter()
        .enumerate()
        .filter(|(index, _)| shard.has(*index))
        .map(|(_, item)| item.clone())
        .collect();
    let interrupt = Interrupt::listen();
    let folder = OutputFolder::open(manifest.output(), Company::Shards)?;
    let name = format!("{}.{}-of-{}", manifest.name, shard.number, shard.of);
    let earlier = journal::read(&folder.journal(), Some(&[journal::WHOLE, &name]))?;
    let mut journal = Journal::begin(&folder, &name)?;
    let progress = Progress::new(&items, messages);
    let batch = work::Batch {
        job: &job,
        folder: &folder,
        earlier: &earlier,
        force: false,
        threads: work::threads(arguments.work.jobs),
        interrupt: &interrupt,
    };
    Roles::default()
        .reads(both!("the manifest", "задание"), &arguments.manifest)
        .reads_all(&both!("a program", "программа"), manifest.items.iter().map(|item| &item.input))
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &job.settings.files)
        .writes("--results", arguments.work.results.as_deref())
        .are_apart()?;
    let mut printing = Printing::new(&progress, messages);
    let results = batch.run(&items, &mut journal, &progress, &mut |outcome| printing.tell(outcome));
    progress.end();
    let results = results.map_err(|failure| interrupted(failure, messages))?;
    let kept = journal.end(&Records::new(), &results.records);
    finish(&results, arguments.work.results.as_deref(), messages.language())?;
    kept?;
    match results.records.iter().map(|record| record.status).max() {
        Some(Status::Failed) => Err(Failure::Said(TRY_AGAIN)),
        Some(Status::Refused) => Err(Failure::Said(REFUSED)),
        _ => Ok(()),
    }
}

/// `vpost batch merge`
pub(crate) fn merge(arguments: &Merge, messages: &Messages) -> Result<(), Failure> {
    has_place(arguments.results.as_deref())?;
    let manifest = Manifest::read(&arguments.manifest)?;
    let root = manifest.output();
    let open = match OutputFolder::open(root, Company::Alone) {
        Ok(folder) => Some(folder),
        Err(Failure::Later(_)) => {
            messages.note(&both!("shards are still at work", "части ещё работают"));
            None
        }
        Err(failure) => return Err(failure),
    };
    let records = journal::read(&root.join(".vpost/journal"), None)?;
    let proofs: Vec<Option<Record>> =
        manifest.items.par_iter().map(|item| proof(item, &manifest, &records)).collect();
    let missing: Vec<usize> = (0..proofs.len()).filter(|index| proofs[*index].is_none()).collect();
    let results = Results { records: proofs.into_iter().flatten().collect(), resumed: 0 };
    // Where the file system cannot say that nobody else is at work, the journals stay apart.
    if let Some(open) = open.as_ref().filter(|open| open.is_locked()) {
        Journal::begin(open, journal::WHOLE)?.end(&records, &results.records)?;
    }
    match (arguments.missing, arguments.shards) {
        (Some(form), Some(of)) => {
            let mut text = shard::array(&shards_of(&missing, of), form);
            if !text.is_empty() && !text.ends_with('\n') {
                text.push('\n');
            }
            file::print(text.as_bytes())?;
            if let Some(path) = &arguments.results {
                file::write(path, &super::record::lines(&results.records))?;
            }
        }
        (_, of) => {
            finish(&results, arguments.results.as_deref(), messages.language())?;
            say_missing(&missing, &manifest, of, messages);
        }
    }
    let refused = results.records.iter().any(|record| !record.status.is_done());
    match (missing.is_empty(), refused) {
        (false, _) => Err(Failure::Said(TRY_AGAIN)),
        (true, true) => Err(Failure::Said(REFUSED)),
        (true, false) => Ok(()),
    }
}

/// What became of a program, if that is certain: a correction of the planned bytes by the planned job whose output is in
/// its place as it was written, or a refusal, which would be the same again.
fn proof(item: &Item, manifest: &Manifest, records: &Records) -> Option<Record> {
    let candidates: Vec<&Record> = records
        .get(&item.output)?
        .iter()
        .filter(|record| record.job_blake3 == manifest.job_blake3())
        .filter(|record| record.input_blake3.is_none() || record.input_blake3 == item.blake3)
        .collect();
    let done = candidates.iter().find(|record| record.status.is_done());
    if let Some(done) = done {
        let (_, hash) = folder::hash(&manifest.output().join(&item.output)).ok()?;
        let intact = done.output_blake3.as_deref() == Some(hash.to_hex().as_str());
        return intact.then(|| (*done).clone());
    }
    candidates.into_iter().find(|record| record.status == Status::Refused).cloned()
}

/// The shares that hold these programs, in order.
fn shards_of(missing: &[usize], of: u32) -> Vec<u32> {
    let mut numbers: Vec<u32> = missing.iter().map(|index| Shard::number_of(*index, of)).collect();
    numbers.sort_unstable();
    numbers.dedup();
    numbers
}

fn say_missing(missing: &[usize], manifest: &Manifest, of: Option<u32>, messages: &Messages) {
    let Some(first) = missing.first() else { return };
    let first = &manifest.items[*first].output;
    let mut text = both!(
        "{} of {} outputs are missing, {first} the first\n",
        "не хватает выходных файлов: {} из {}, первый — {first}\n",
        missing.len(),
        manifest.items.len()
    );
    match of {
        None => text.push(&both!(
            "which shards to run again: add `--shards N`",
            "какие части запустить снова, скажет `--shards N`"
        )),
        Some(of) => {
            let shards = shards_of(missing, of);
            text.push(&both!(
                "run again: HyperQueue `--array {}`, Slurm `--array={}`, GNU parallel `::: {}`",
                "запустите снова: HyperQueue `--array {}`, Slurm `--array={}`, GNU parallel `::: {}`",
                shard::array(&shards, EngineForm::Hq),
                shard::array(&shards, EngineForm::Slurm),
                shard::array(&shards, EngineForm::Parallel).trim_end().replace('\n', " "),
            ));
        }
    }
    messages.note(&text);
}
