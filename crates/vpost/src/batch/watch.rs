//! `vpost watch IN OUT`: a drop folder. What a CAM system saves into IN is corrected to OUT under the same name.
//!
//! Rounds of [`Batch`] over what is whole: programs whose files have stayed as they are for a while. Asked by looking,
//! not by the system's notices, which network shares do not send.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;
use diagnostic::{Code, Text, both, notice};
use jobs::message::Wording;

use super::arguments::Programs;
use super::folder::{Company, OutputFolder};
use super::inputs::{self, Item};
use super::job::{CutOff, Job};
use super::journal::{self, Journal, Records};
use super::outcome::Outcome;
use super::progress::Progress;
use super::record::Status;
use super::report::{interrupted, passed_over};
use super::work::{self, Batch};
use crate::arguments::{Shared, size};
use crate::exit_status::REFUSED;
use crate::file;
use crate::interrupt::Interrupt;
use crate::message::{Deed, Failure, Messages, OPTION, Report};
use crate::source::Stamp;

/// What decides the outputs changed while a folder was watched.
const CHANGED: Code = Code(1013);

/// Beside all outputs lies word of what concerns them all: `vpost.refused.txt`.
const WHOLE: &str = "vpost";

/// Between two looks at the folder, at most; a signal is answered within it.
const LOOK: Duration = Duration::from_millis(200);

/// `vpost watch`
#[derive(Debug, Args)]
pub struct Watch {
    /// Folder that programs are saved into.
    #[arg(value_name = "IN")]
    pub input: PathBuf,
    /// Folder of the corrected programs.
    #[arg(value_name = "OUT")]
    pub output: PathBuf,
    /// Take such files (repeatable).
    ///
    /// Instead of those with the usual endings of programs.
    #[arg(long, value_name = "PATTERN")]
    pub pattern: Vec<String>,
    /// Leave out such (repeatable).
    ///
    /// Files or folders of this pattern.
    #[arg(long, value_name = "PATTERN")]
    pub exclude: Vec<String>,
    /// A file is whole if it stays so long as it is, s.
    #[arg(long, value_name = "S", default_value_t = 2.0, value_parser = size)]
    pub settle: f64,
    /// End when all that is there is corrected.
    #[arg(long)]
    pub once: bool,
}

/// `vpost watch`
pub(crate) fn run(arguments: &Watch, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    if !arguments.input.is_dir() {
        return Err(Failure::usage(notice!(OPTION;
            "{} is no folder", "{} — не папка", file::name(&arguments.input);
            "give the folder that programs are saved into, and the one for their corrections: `vpost watch IN OUT`",
            "дайте папку, в которую сохраняются программы, и папку для исправленных: `vpost watch IN OUT`"
        )));
    }
    let programs = Programs {
        inputs: vec![arguments.input.clone()],
        output: Some(arguments.output.clone()),
        pattern: arguments.pattern.clone(),
        exclude: arguments.exclude.clone(),
    };
    let order = Order {
        programs,
        settle: Duration::from_secs_f64(arguments.settle),
        until: if arguments.once { Until::Done } else { Until::Told },
        shared,
        messages,
        interrupt: Interrupt::listen(),
    };
    passed_over(&inputs::search(&order.programs, &arguments.output)?, messages);
    order.run(&arguments.output).map_err(|failure| interrupted(failure, messages))
}

/// A program as it was last seen.
struct Seen {
    stamp: Option<Stamp>,
    since: Instant,
    /// What became of it.
    status: Option<Status>,
}

/// What decides the outputs: files, and how they lay when they were read.
type Read = Vec<(PathBuf, Option<Stamp>)>;

/// When watching ends.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Until {
    /// By a signal.
    Told,
    /// When nothing is left to do.
    Done,
}

/// Why the watch of one output folder ended.
#[derive(PartialEq, Eq)]
enum Ended {
    /// Nothing is left to do.
    Done,
    /// Somebody took the folder away, or what vpost keeps in it.
    FolderWent,
}

/// What was asked for.
struct Order<'a> {
    programs: Programs,
    settle: Duration,
    until: Until,
    shared: &'a Shared,
    messages: &'a Messages,
    interrupt: Interrupt,
}

impl Order<'_> {
    /// Watches, in one output folder after the other where somebody takes them away.
    fn run(&self, output: &Path) -> Result<(), Failure> {
        let mut known = None;
        while self.watch(output, &mut known)? == Ended::FolderWent {
            self.wait_for(output)?;
        }
        Ok(())
    }

    /// Watches until there is nothing more to do here.
    ///
    /// * `known` – the job of the folder before, of files that may be broken by now
    fn watch(&self, output: &Path, known: &mut Option<(Job, Read)>) -> Result<Ended, Failure> {
        let folder = &OutputFolder::open(output, Company::Alone)?;
        let pages = Pages { folder, messages: self.messages };
        let loaded = || loaded(self.shared, self.messages).inspect_err(|failure| pages.nothing_is(failure));
        let (job, read) = known.take().map_or_else(loaded, Ok)?;
        pages.mend(WHOLE);
        let records = journal::read(&folder.journal(), None)?;
        let mut journal = Journal::begin(folder, journal::WHOLE)?;
        let (changed, seen, said) = (None, BTreeMap::new(), RefCell::default());
        let mut watched = Watched { order: self, pages, job, read, changed, seen, records, said };
        let ended = watched.watch(&mut journal);
        if !matches!(ended, Ok(Ended::FolderWent)) {
            journal.end(&watched.records, &[])?;
        }
        *known = Some((watched.job, watched.read));
        ended
    }

    /// Waits until the output folder can be made again: a share that was cut off comes back.
    fn wait_for(&self, output: &Path) -> Result<(), Failure> {
        self.messages.note(&both!(
            "{0} went: it is made again, and all is corrected anew",
            "папка {0} исчезла: она создаётся снова, и всё исправляется заново",
            output.display()
        ));
        while std::fs::create_dir_all(output).is_err() {
            self.interrupt.check()?;
            std::thread::sleep(LOOK);
        }
        Ok(())
    }
}

struct Watched<'a> {
    order: &'a Order<'a>,
    pages: Pages<'a>,
    job: Job,
    read: Read,
    /// How those files lie since when, where they are others.
    changed: Option<(Read, Instant)>,
    seen: BTreeMap<String, Seen>,
    records: Records,
    /// What failed since something succeeded: said once, however often it fails.
    said: RefCell<BTreeSet<String>>,
}

/// The job, and the files that it depends on.
fn loaded(shared: &Shared, messages: &Messages) -> Result<(Job, Read), Failure> {
    // Stamps first: what changes meanwhile is read again.
    let folders = shared.job.include.iter().filter_map(|folder| folder.read_dir().ok()).flatten().flatten();
    let mut read = stamped(folders.map(|entry| entry.path()));
    let job = Job { cut_off: CutOff::Refused, ..Job::load(shared, messages)? };
    read.extend(stamped(job.settings.files.iter().cloned().chain(shared.job.include.iter().cloned())));
    read.extend(stamped(shared.held.file.clone()));
    Ok((job, read))
}

fn stamped(paths: impl IntoIterator<Item = PathBuf>) -> Read {
    paths.into_iter().map(|path| (path.clone(), Stamp::at(&path))).collect()
}

impl<'a> Watched<'a> {
    fn watch(&mut self, journal: &mut Journal<'a>) -> Result<Ended, Failure> {
        let Order { until, settle, interrupt, .. } = self.order;
        loop {
            interrupt.check()?;
            if *until == Until::Told && !self.pages.folder.is_there() {
                return Ok(Ended::FolderWent);
            }
            match self.round(journal) {
                Ok(0) if *until == Until::Done => break,
                Ok(_) => {}
                Err(failure @ (Failure::Interrupted(_) | Failure::Later(_))) => return Err(failure),
                Err(failure) if *until == Until::Done => return Err(failure),
                Err(failure) => self.say_once(&failure),
            }
            std::thread::sleep(LOOK.min(*settle / 4));
        }
        let done = |seen: &Seen| seen.status.is_none_or(Status::is_done);
        if self.seen.values().all(done) { Ok(Ended::Done) } else { Err(Failure::Said(REFUSED)) }
    }

    /// One look at the folder; how many programs are not whole yet.
    fn round(&mut self, journal: &mut Journal<'a>) -> Result<usize, Failure> {
        if !self.is_job_settled()? {
            return Ok(1);
        }
        let found = inputs::search(&self.order.programs, &self.pages.folder.place(""))?;
        self.order.shared.held.is_of_all(found.items.iter().map(|item| item.input.as_path()))?;
        self.forget(&found.items);
        let (ready, mut left) = self.ready(found.items);
        if ready.is_empty() {
            return Ok(left);
        }
        let Self { order: Order { interrupt, .. }, pages: Pages { folder, .. }, job, records, .. } = &*self;
        let threads = work::threads(None);
        let batch = Batch { job, folder, earlier: records, force: false, threads, interrupt };
        let results = batch.run(&ready, journal, &Progress::hidden(), &mut |outcome| self.tell(outcome))?;
        for (record, item) in results.records.into_iter().zip(&ready) {
            let Some(seen) = self.seen.get_mut(&record.output) else { continue };
            let changed = seen.stamp != Stamp::at(&item.input);
            if record.status == Status::Failed && (changed || self.order.until == Until::Told) {
                // Perhaps not so in a while.
                seen.since = Instant::now();
                left += 1;
                continue;
            }
            seen.status = Some(record.status);
            self.records.insert(record.output.clone(), vec![record]);
        }
        Ok(left)
    }

    /// Profile, tables and subprograms are those that the job was made of; else makes it anew once they stay.
    fn is_job_settled(&mut self) -> Result<bool, Failure> {
        let now = stamped(self.read.iter().map(|(path, _)| path.clone()));
        if now == self.read {
            self.changed = None;
            return Ok(true);
        }
        match &self.changed {
            Some((last, since)) if *last == now => {
                if since.elapsed() < self.order.settle {
                    return Ok(false);
                }
            }
            _ => {
                self.changed = Some((now, Instant::now()));
                return Ok(false);
            }
        }
        let settings =
            |(path, _): &&(PathBuf, Option<Stamp>)| self.order.shared.held.file.as_ref() == Some(path);
        if now.iter().find(settings) != self.read.iter().find(settings) {
            let diagnostic = notice!(CHANGED;
                "the settings file changed", "файл настроек изменился";
                "start `vpost watch` again; what is done is not done again",
                "запустите `vpost watch` снова; сделанное второй раз не делается"
            );
            return Err(Failure::Later(Report { source: None, diagnostics: vec![diagnostic] }));
        }
        match loaded(self.order.shared, self.order.messages) {
            Ok((job, read)) => {
                (self.job, self.read, self.changed) = (job, read, None);
                self.seen.values_mut().for_each(|seen| seen.status = None);
                self.pages.mend(WHOLE);
                self.note(&both!(
                    "the profile changed: all is corrected anew",
                    "профиль изменился: всё исправляется заново"
                ));
                Ok(true)
            }
            Err(failure) => {
                self.pages.nothing_is(&failure);
                Err(failure)
            }
        }
    }

    /// Programs that are gone need no second look. Their corrections stay: what is in OUT nobody loses.
    fn forget(&mut self, items: &[Item]) {
        let there: BTreeSet<&str> = items.iter().map(|item| item.output.as_str()).collect();
        let gone: Vec<String> =
            self.seen.keys().filter(|output| !there.contains(output.as_str())).cloned().collect();
        for output in gone {
            self.seen.remove(&output);
            if !self.pages.folder.place(&output).exists() {
                self.pages.mend(&output);
                continue;
            }
            self.note(&both!(
                "{output} was taken out; its correction stays",
                "{output} убрана; её исправление остаётся"
            ));
        }
    }

    /// Programs that are whole and not done, and how many are not whole yet.
    fn ready(&mut self, items: Vec<Item>) -> (Vec<Item>, usize) {
        let (mut ready, mut left) = (Vec::new(), 0);
        for item in items {
            let stamp = Stamp::at(&item.input);
            let new = || Seen { stamp, since: Instant::now(), status: None };
            let seen = self.seen.entry(item.output.clone()).or_insert_with(new);
            if seen.stamp != stamp {
                *seen = new();
            }
            if seen.status.is_some_and(Status::is_done) && !self.pages.folder.place(&item.output).exists() {
                seen.status = None;
            }
            // What was only just made is empty.
            if seen.status.is_some() || stamp.is_some_and(|stamp| stamp.bytes == 0) {
                continue;
            }
            if seen.since.elapsed() < self.order.settle {
                left += 1;
            } else {
                ready.push(item);
            }
        }
        (ready, left)
    }

    /// Says what became of a program: on standard error, and beside its place where it was not corrected.
    fn tell(&self, outcome: &Outcome) {
        let output = &outcome.record.output;
        let told = || outcome.told.iter().for_each(|report| self.order.messages.report(report));
        let rendered = || -> Vec<String> {
            let rendered = |report| self.wording().rendered(report).collect::<Vec<_>>();
            outcome.told.iter().flat_map(rendered).collect()
        };
        match outcome.record.status {
            Status::Corrected | Status::Unchanged => {
                self.pages.mend(output);
                self.said.borrow_mut().clear();
                if !outcome.resumed {
                    told();
                    self.note(&both!("corrected: {output}", "исправлена: {output}"));
                }
            }
            Status::Failed => self.once(rendered().join("\n"), told),
            Status::Refused => {
                let mut lines = vec![both!(
                    "{output} was refused: it is not corrected.\n",
                    "Программа {output} не принята: она не исправлена.\n"
                )];
                if self.pages.folder.place(output).exists() {
                    lines.push(both!(
                        "The file {output} in this folder is the correction of an EARLIER program.\n",
                        "Файл {output} в этой папке — исправление ПРЕЖНЕЙ программы.\n"
                    ));
                }
                self.pages
                    .leave(output, &lines, &rendered())
                    .unwrap_or_else(|failure| self.say_once(&failure));
                told();
            }
        }
    }

    fn wording(&self) -> Wording {
        self.pages.wording()
    }

    /// What only who looks on wants to know.
    fn note(&self, text: &Text) {
        let Order { shared, messages, .. } = self.order;
        if shared.messages.verbose > 0 || std::io::stderr().is_terminal() {
            messages.note(text);
        }
    }

    fn say_once(&self, failure: &Failure) {
        self.once(self.wording().text(failure), || self.order.messages.failure(failure));
    }

    /// Says what failed, once until something succeeds.
    fn once(&self, text: String, say: impl FnOnce()) {
        if self.said.borrow_mut().insert(text) {
            say();
        }
    }
}

/// Pages beside outputs that are not what they should be: who looks into OUT sees no standard error.
struct Pages<'a> {
    folder: &'a OutputFolder,
    messages: &'a Messages,
}

impl Pages<'_> {
    fn wording(&self) -> Wording {
        Wording::plain().speaking(self.messages.language())
    }

    fn place(&self, output: &str) -> PathBuf {
        self.folder.place(&format!("{output}.refused.txt"))
    }

    /// Leaves word that no program is corrected. Where it cannot be left, the failure itself is said.
    fn nothing_is(&self, failure: &Failure) {
        let lines = [both!(
            "No program is corrected any more; those in this folder were before.\n",
            "Программы больше не исправляются; те, что в этой папке, исправлены раньше.\n"
        )];
        let _ = self.leave(WHOLE, &lines, &[self.wording().text(failure)]);
    }

    /// Leaves word of an output.
    fn leave(&self, output: &str, lines: &[Text], said: &[String]) -> Result<(), Failure> {
        let language = self.messages.language();
        let lines: String = lines.iter().map(|line| line.in_language(language)).collect();
        let page = self.place(output);
        std::fs::create_dir_all(file::folder_of(&page)).map_err(file::fails(&page, Deed::Write))?;
        file::write(&page, format!("{lines}\n{}\n", said.join("\n")).as_bytes())
    }

    /// Takes the word back.
    fn mend(&self, output: &str) {
        // Mostly there is none.
        let _ = std::fs::remove_file(self.place(output));
    }
}
