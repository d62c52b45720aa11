//! The work: programs to outputs on all cores, told in order.

use std::collections::BTreeMap;
use std::num::NonZero;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use blake3::Hash;
use diagnostic::{Code, Diagnostic, Text, both, notice};

use super::folder::{Grown, OutputFolder, hash};
use super::inputs::Item;
use super::job::{self, Job};
use super::journal::{Journal, Records};
use super::outcome::Outcome;
use super::progress::Progress;
use super::record::{Record, Status};
use super::shelf::Shelf;
use crate::file;
use crate::interrupt::Interrupt;
use crate::message::{Deed, Failure, OPTION, Report};

/// An output would be written over a file that vpost did not write.
const FOREIGN: Code = Code(1006);
/// A program is not what the manifest says.
const CHANGED: Code = Code(1007);
/// A defect of vpost.
const DEFECT: Code = Code(1008);

/// Results of so many bytes read and written are told at once: telling each costs as much as a tenth of correcting a
/// small program.
const TOLD_TOGETHER_BYTES: u64 = 1 << 21;

/// Nor does anything wait longer than this for others: so much work is done again after a kill.
const KEPT_BACK: Duration = Duration::from_millis(10);

/// One run of many programs.
pub(crate) struct Batch<'a, 'f> {
    pub job: &'a Job,
    pub folder: &'f OutputFolder,
    /// What earlier runs left.
    pub earlier: &'a Records,
    /// Correct anew what was corrected, overwrite what is not ours.
    pub force: bool,
    pub threads: usize,
    pub interrupt: &'a Interrupt,
}

/// What came of a run.
#[derive(Debug, Default)]
pub(crate) struct Results {
    /// In the order of the items.
    pub records: Vec<Record>,
    /// How many of them an earlier run had done.
    pub resumed: usize,
}

/// Threads for the work: as many as the machine gives this process.
pub(crate) fn threads(jobs: Option<u16>) -> usize {
    jobs.map_or_else(|| std::thread::available_parallelism().map_or(1, NonZero::get), usize::from)
}

impl<'f> Batch<'_, 'f> {
    /// Corrects the programs. What fails is told, and the others go on.
    ///
    /// Programs are begun in order, and `tell` hears of their results in order, each in its place by then.
    pub(crate) fn run(
        &self,
        items: &[Item],
        journal: &mut Journal<'f>,
        progress: &Progress,
        tell: &mut dyn FnMut(&Outcome),
    ) -> Result<Results, Failure> {
        self.folder.holds(items.iter().map(|item| item.output.as_str()))?;
        let threads = self.threads;
        let workers = threads.min(items.len()).max(1);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(workers).build().map_err(|error| {
            Failure::usage(notice!(OPTION;
                "{threads} threads cannot be had: {error}", "потоков {threads} получить нельзя: {error}";
                "fewer: `--jobs 2`", "меньше: `--jobs 2`"
            ))
        })?;
        let next = AtomicUsize::new(0);
        // Each worker has so many outputs in hand, as many again on the way, and those of a group wait for the disk.
        let in_hand = (most_open() / (3 * workers)).max(1);
        let (sender, receiver) = mpsc::sync_channel(workers);
        pool.in_place_scope(|scope| {
            for _ in 0..workers {
                let (sender, next) = (sender.clone(), &next);
                scope.spawn(move |_| {
                    let (mut done, mut bytes, mut since) = (Vec::new(), 0_u64, Instant::now());
                    while self.interrupt.check().is_ok()
                        && let Some((index, item)) = {
                            let index = next.fetch_add(1, Ordering::Relaxed);
                            items.get(index).map(|item| (index, item))
                        }
                    {
                        // What is done does not wait for a large one.
                        if item.bytes > TOLD_TOGETHER_BYTES.saturating_sub(bytes) / 2
                            || done.len() >= in_hand
                            || since.elapsed() > KEPT_BACK
                        {
                            // Whoever listens no more has a reason that is told there.
                            if sender.send(std::mem::take(&mut done)).is_err() {
                                break;
                            }
                            (bytes, since) = (0, Instant::now());
                        }
                        // The last programs are shared by the threads that would have none.
                        let threads = (threads / (items.len() - index)).max(1);
                        match self.guarded(item, threads) {
                            Ok(outcome) => {
                                // A few lines with loops may have become megabytes.
                                bytes += item.bytes.min(TOLD_TOGETHER_BYTES);
                                bytes += outcome.record.bytes_out.unwrap_or(0);
                                done.push((index, outcome));
                            }
                            // Interrupted, which ends all.
                            Err(_) => break,
                        }
                    }
                    let _ = sender.send(done);
                });
            }
            drop(sender);
            let mut shelf = Shelf::new(self.folder, journal);
            let mut told = Told::default();
            while let Ok(mut group) = receiver.recv() {
                // Whatever else is there waits for the disk together with it.
                group.extend(receiver.try_iter().flatten());
                shelf.put(group.iter_mut().map(|(_, outcome)| outcome));
                for (index, outcome) in group {
                    match outcome.resumed {
                        true => progress.was_done(&items[index]),
                        false => progress.done(&items[index]),
                    }
                    told.take(index, outcome, tell);
                }
            }
            shelf.end().map_err(|error| {
                Failure::place(&Text::pair("the output folder", "выходную папку"), Deed::WriteTo, &error)
            })?;
            self.interrupt.check()?;
            Ok(told.results)
        })
    }

    /// A defect of ours in one program is that program's failure.
    fn guarded(&self, item: &Item, threads: usize) -> Result<Outcome, Failure> {
        catch_unwind(AssertUnwindSafe(|| self.one(item, threads))).unwrap_or_else(|_| {
            let mut outcome = Outcome::of(self.record(item));
            let diagnostic = notice!(DEFECT;
                "vpost broke down on {}", "сбой vpost на {}", item.input.display();
                "this is a defect of vpost; please report it with the program and the lines above",
                "это ошибка vpost; сообщите о ней, приложив программу и строки выше"
            );
            outcome.fail(refused(diagnostic));
            Ok(outcome)
        })
    }

    fn record(&self, item: &Item) -> Record {
        Record {
            output: item.output.clone(),
            input: item.input.display().to_string(),
            status: Status::Refused,
            job_blake3: self.job.hash.to_hex().to_string(),
            input_blake3: None,
            output_blake3: None,
            bytes_in: item.bytes,
            bytes_out: None,
            figures: None,
            subprograms: Vec::new(),
            warnings: Vec::new(),
            errors: Vec::new(),
            older_output: false,
        }
    }

    /// One program; fails only where the work was interrupted.
    fn one(&self, item: &Item, threads: usize) -> Result<Outcome, Failure> {
        let mut outcome = Outcome::of(self.record(item));
        match self.corrected(item, threads, &mut outcome) {
            Ok(()) => {}
            Err(failure @ Failure::Interrupted(_)) => return Err(failure),
            Err(failure) => {
                outcome.fail(failure);
                // A refusal is of certain bytes; those of a program that changed since the plan decide nothing.
                if item.blake3.is_none()
                    && let Ok((bytes, hash)) = hash(&item.input)
                {
                    outcome.record.bytes_in = bytes;
                    outcome.record.input_blake3 = Some(hash.to_hex().to_string());
                }
                outcome.record.older_output =
                    self.earlier.contains_key(&item.output) && self.folder.place(&item.output).exists();
            }
        }
        Ok(outcome)
    }

    fn corrected(&self, item: &Item, threads: usize, outcome: &mut Outcome) -> Result<(), Failure> {
        item.needs_name()?;
        let record = &mut outcome.record;
        // Read once more than a first run needs: only where the hash may save the work, or decide about it.
        let resumes = !self.force && self.earlier.contains_key(&item.output);
        if resumes || item.blake3.is_some() {
            let (bytes, hash) = hash(&item.input).map_err(|error| gone(item, &error))?;
            record.bytes_in = bytes;
            planned(item, hash)?;
            if item.blake3.is_some() && bytes != item.bytes {
                return Err(changed(&item.input, &both!("is of another length", "другой длины")));
            }
            record.input_blake3 = Some(hash.to_hex().to_string());
        }
        if resumes && let Some(known) = self.known(record)? {
            *record = Record { input: record.input.clone(), ..known };
            outcome.resumed = true;
            return Ok(());
        }
        let place = || self.folder.place(&item.output);
        let fail = |error: std::io::Error| Failure::file(&file::name(&place()), Deed::Write, &error);
        let mut temporary = self.folder.temporary().map_err(fail)?;
        let done = self.job.correct(item, threads, &mut temporary, self.interrupt)?;
        if let Some(hash) = done.input.hash {
            planned(item, hash)?;
        }
        outcome.grown = match self.folder.present(&item.output).map_err(fail)? {
            None => Some(Grown::New(temporary)),
            Some(present) if done.output.hash == Some(present) => None,
            Some(present) if self.force || self.is_ours(&item.output, present).map_err(fail)? => {
                Some(Grown::Over(temporary))
            }
            Some(_) => return Err(foreign(&place())),
        };
        job::corrected(record, &done);
        outcome.told = done.warnings;
        Ok(())
    }

    /// What an earlier run made of the same bytes with the same job, if its output is still there as it was written.
    fn known(&self, record: &Record) -> Result<Option<Record>, Failure> {
        let Some(candidates) = self.earlier.get(&record.output) else { return Ok(None) };
        let same = candidates.iter().find(|known| {
            known.status.is_done()
                && known.input_blake3 == record.input_blake3
                && known.job_blake3 == record.job_blake3
                && known.subprograms.iter().all(|lookup| lookup.holds(&self.job.settings.flow))
        });
        let Some(known) = same else { return Ok(None) };
        let present = self.folder.present(&record.output).map_err(|error| {
            Failure::file(&file::name(&self.folder.place(&record.output)), Deed::Read, &error)
        })?;
        let intact = present.is_some_and(|hash| is(known.output_blake3.as_deref(), hash));
        Ok(intact.then(|| known.clone()))
    }

    /// True for a file that an earlier run wrote, or that says it was corrected, or that holds nothing of anybody's.
    fn is_ours(&self, output: &str, present: Hash) -> std::io::Result<bool> {
        let mut known = self.earlier.get(output).into_iter().flatten();
        if known.any(|record| is(record.output_blake3.as_deref(), present)) {
            return Ok(true);
        }
        Ok(self.folder.bears_mark(output)? || self.folder.is_blank(output)?)
    }
}

/// The program is what the manifest says, if one says anything.
fn planned(item: &Item, hash: Hash) -> Result<(), Failure> {
    match &item.blake3 {
        Some(planned) if !is(Some(planned), hash) => {
            Err(changed(&item.input, &both!("holds other bytes", "содержит другие байты")))
        }
        _ => Ok(()),
    }
}

/// A program cannot be read: if it was there when the plan was made, that is a change.
fn gone(item: &Item, error: &std::io::Error) -> Failure {
    if item.blake3.is_some() && error.kind() == std::io::ErrorKind::NotFound {
        changed(&item.input, &both!("is not there any more", "исчез"))
    } else {
        Failure::file(&file::name(&item.input), Deed::Read, error)
    }
}

fn is(written: Option<&str>, hash: Hash) -> bool {
    written.is_some_and(|written| written == hash.to_hex().as_str())
}

fn refused(diagnostic: Diagnostic) -> Failure {
    Failure::Refused(vec![Report { source: None, diagnostics: vec![diagnostic] }])
}

fn changed(input: &Path, how: &Text) -> Failure {
    refused(notice!(CHANGED;
        "{} {how}: it changed since the plan was made",
        "{} {how:#}: изменился после составления плана", input.display();
        "make a new plan with `vpost batch plan`; what is the same will not be corrected again",
        "составьте план заново: `vpost batch plan`; то, что не изменилось, второй раз не исправляется"
    ))
}

fn foreign(place: &Path) -> Failure {
    refused(notice!(FOREIGN;
        "{} is there already and was not written by vpost",
        "{} уже лежит там, и писал его не vpost", place.display();
        "move that file away, or give another output folder; `vpost batch --force` writes over it",
        "уберите этот файл или дайте другую выходную папку; `vpost batch --force` запишет поверх"
    ))
}

/// Files that may be open at once, outputs that wait for the disk among them: as many as the system lets this process
/// have, and no more than help.
fn most_open() -> usize {
    /// Beyond this the disk is waited for seldom enough.
    #[cfg(unix)]
    const ENOUGH: u64 = 4096;
    /// What every system allows, and what else is open.
    const USUAL: u64 = 256;
    #[cfg(unix)]
    {
        use rustix::process::{Resource, getrlimit, setrlimit};
        let mut limit = getrlimit(Resource::Nofile);
        let wanted = limit.maximum.map_or(2 * ENOUGH, |most| most.min(2 * ENOUGH));
        if limit.current.is_some_and(|current| current < wanted) {
            limit.current = Some(wanted);
            let _ = setrlimit(Resource::Nofile, limit);
        }
        let open = getrlimit(Resource::Nofile).current.unwrap_or(2 * ENOUGH);
        (open / 2).clamp(USUAL / 2, ENOUGH) as usize
    }
    #[cfg(not(unix))]
    {
        USUAL as usize
    }
}

/// Puts results in order.
#[derive(Default)]
struct Told {
    results: Results,
    waiting: BTreeMap<usize, Outcome>,
}

impl Told {
    /// Tells an outcome, and those that waited for it; before its forerunners were told it waits.
    fn take(&mut self, index: usize, outcome: Outcome, tell: &mut dyn FnMut(&Outcome)) {
        self.waiting.insert(index, outcome);
        while let Some(next) = self.waiting.remove(&self.results.records.len()) {
            tell(&next);
            self.results.resumed += usize::from(next.resumed);
            self.results.records.push(next.record);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn at_least_one_thread_and_as_many_as_asked_for() {
        assert!(threads(None) >= 1);
        assert_eq!(threads(Some(3)), 3);
    }
}
