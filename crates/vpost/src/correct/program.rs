//! One program from a reader to a file: small ones in memory, large ones in chunks.

use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use diagnostic::{Diagnostic, Severity};
use nc_program::Evidence;
use nc_syntax::{Envelope, Place, Reader};

use super::chunks::{CHUNK_BYTES, Chunk, Chunks, Survey, Unread};
use super::notices::Warning;
use super::pass::State;
use super::sink::{Sink, Written};
use super::stream::{self, End, Plan};
use super::{Figures, Job, comment_position};
use crate::expand::{self, Lookup};
use crate::file;
use crate::message::{Failure, Report, Source};
use crate::settings::Settings;
use crate::source::{Reading, Still};

/// A program up to this size is corrected in memory, all at once.
const SMALL_BYTES: u64 = 4 << 20;

/// Where a program comes from.
pub(crate) enum Input {
    /// A file, which can be read more than once.
    File(PathBuf),
    /// Anything else, by the name it has in messages.
    Stream(String, Box<dyn Read + Send>),
}

impl Input {
    /// A file, or standard input for `-`. Errors come when it is read.
    pub(crate) fn open(path: &Path) -> Self {
        if path.as_os_str() == "-" {
            return Self::Stream(file::name(path), Box::new(io::stdin()));
        }
        let pipe = path.metadata().is_ok_and(|found| !found.is_file() && !found.is_dir());
        match pipe.then(|| File::open(path)) {
            Some(Ok(pipe)) => Self::Stream(file::name(path), Box::new(pipe)),
            _ => Self::File(path.to_owned()),
        }
    }
}

/// What an output is written to.
pub(crate) trait Growing: Write + Send {
    /// Starts anew.
    fn clear(&mut self) -> io::Result<()>;
}

/// How a program is corrected.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Manner {
    /// Also one that was corrected before.
    pub(crate) force: bool,
    /// Threads for a large one; the bytes are the same for any number.
    pub(crate) threads: usize,
    /// Hashes of input and output are wanted.
    pub(crate) hashes: bool,
}

/// A text by its length and hash.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Digest {
    pub(crate) bytes: u64,
    /// Where it was wanted.
    pub(crate) hash: Option<blake3::Hash>,
}

impl Digest {
    fn of(bytes: &[u8], hashes: bool) -> Self {
        Self { bytes: bytes.len() as u64, hash: hashes.then(|| blake3::hash(bytes)) }
    }
}

/// A program that was corrected.
#[derive(Debug)]
pub(crate) struct Program {
    pub(crate) name: String,
    pub(crate) input: Digest,
    pub(crate) output: Digest,
    /// The output is not the input.
    pub(crate) changed: bool,
    pub(crate) figures: Figures,
    /// What is to be said.
    pub(crate) warnings: Vec<Report>,
    /// Subprograms that were looked for.
    pub(crate) lookups: Vec<Lookup>,
}

/// Corrects one program; `out` is empty, and of no use after an error.
///
/// `progress` is told the share that is done, 0 to 1, and may end the work. A large program takes some megabytes
/// for each thread, whatever its size; one with flow is worked on in memory as a whole.
///
/// # Errors
/// What was wrong with the program, or the file system, or what `progress` said.
pub(crate) fn program(
    input: Input,
    settings: &Settings,
    manner: Manner,
    out: &mut impl Growing,
    progress: &(dyn Fn(f64) -> Result<(), Failure> + Sync),
) -> Result<Program, Failure> {
    let program = whatever_is_doubtful(input, settings, manner, out, progress)?;
    if settings.strict {
        refuse_doubts(&program.warnings)?;
    }
    Ok(program)
}

/// Refuses a program for the warnings that it is doubtful.
fn refuse_doubts(warnings: &[Report]) -> Result<(), Failure> {
    let doubts = |report: &Report| {
        let doubtful = report.diagnostics.iter().filter(|warning| warning.severity == Severity::Doubt);
        let diagnostics: Vec<Diagnostic> =
            doubtful.map(|doubt| Diagnostic { severity: Severity::Error, ..doubt.clone() }).collect();
        (!diagnostics.is_empty()).then(|| Report { source: report.source.clone(), diagnostics })
    };
    let doubts: Vec<Report> = warnings.iter().filter_map(doubts).collect();
    if doubts.is_empty() { Ok(()) } else { Err(Failure::Refused(doubts)) }
}

fn whatever_is_doubtful(
    input: Input,
    settings: &Settings,
    manner: Manner,
    out: &mut impl Growing,
    progress: &(dyn Fn(f64) -> Result<(), Failure> + Sync),
) -> Result<Program, Failure> {
    match input {
        Input::File(path) => {
            let name = file::name(&path);
            let still = Still::open(&path).map_err(|error| Failure::file(&name, "read", &error))?;
            let text = Text { name: &name, kept: Some(&still), rest: Box::new(still.reading()) };
            let done = text.corrected(still.bytes(), settings, manner, out, progress);
            // What is wrong with half a program is not the user's fault to mend.
            if !matches!(done, Err(Failure::Interrupted(_))) {
                still.unchanged(&path, &name)?;
            }
            done
        }
        Input::Stream(name, stream) => {
            Text { name: &name, kept: None, rest: stream }.corrected(0, settings, manner, out, progress)
        }
    }
}

/// A program that is about to be read.
struct Text<'a> {
    name: &'a str,
    /// Where it can be read again.
    kept: Option<&'a Still>,
    rest: Box<dyn Read + Send>,
}

impl Text<'_> {
    /// `bytes`: its length where that is known; only room is made by it.
    fn corrected(
        mut self,
        bytes: u64,
        settings: &Settings,
        manner: Manner,
        out: &mut impl Growing,
        progress: &(dyn Fn(f64) -> Result<(), Failure> + Sync),
    ) -> Result<Program, Failure> {
        let name = self.name;
        let unread = |error: &io::Error| Failure::file(name, "read", error);
        // A small file is read at once, and room is left to see that it ends there.
        let mut head = Vec::with_capacity(bytes.min(SMALL_BYTES) as usize + 1);
        self.rest.by_ref().take(SMALL_BYTES).read_to_end(&mut head).map_err(|error| unread(&error))?;
        file::check_lines(&head, name)?;
        if (head.len() as u64) < SMALL_BYTES {
            return in_memory(&head, name, settings, manner, out, progress);
        }
        // A stream is kept on disk: it is read more than once.
        let kept = match self.kept {
            Some(still) => Kept::File(still.clone()),
            None => Kept::spool(&head, self.rest).map_err(|error| unread(&error))?,
        };
        let large = Large { name, head: &head, kept: &kept, settings, manner, progress };
        match large.correct(out) {
            Ok(program) => Ok(program),
            Err(LargeEnd::AsAWhole) => {
                drop(head);
                out.clear().map_err(|error| unwritten(&error))?;
                let text = file::read_lines(kept.reading(), name)?;
                in_memory(&text, name, settings, manner, out, progress)
            }
            Err(LargeEnd::Failed(failure)) => Err(failure),
        }
    }
}

fn unwritten(error: &io::Error) -> Failure {
    Failure::file("the output", "write", error)
}

fn in_memory(
    text: &[u8],
    name: &str,
    settings: &Settings,
    manner: Manner,
    out: &mut impl Growing,
    progress: &(dyn Fn(f64) -> Result<(), Failure> + Sync),
) -> Result<Program, Failure> {
    let expand::Done { corrected, warnings, lookups } =
        expand::correct(text, name, settings, manner.force, progress)?;
    out.write_all(&corrected.text).map_err(|error| unwritten(&error))?;
    Ok(Program {
        name: name.to_owned(),
        input: Digest::of(text, manner.hashes),
        output: Digest::of(&corrected.text, manner.hashes),
        changed: corrected.text != text,
        figures: corrected.figures,
        warnings,
        lookups,
    })
}

/// A program on disk.
enum Kept {
    /// Where it was posted.
    File(Still),
    /// A copy of a stream, without a name: however the process ends, nothing is left of it.
    Spool(Arc<File>),
}

impl Kept {
    fn spool(head: &[u8], mut rest: impl Read) -> io::Result<Self> {
        let mut spool = tempfile::tempfile()?;
        spool.write_all(head)?;
        let mut part = Vec::new();
        // What has no line end will be refused when it is read, however much of it there is.
        while file::ends_lines(&part) {
            part.clear();
            let read = (&mut rest).take(file::LONGEST_LINE as u64).read_to_end(&mut part)?;
            spool.write_all(&part)?;
            if read < file::LONGEST_LINE {
                break;
            }
        }
        Ok(Self::Spool(Arc::new(spool)))
    }

    fn reading(&self) -> Reading {
        match self {
            Self::File(still) => still.reading(),
            Self::Spool(spool) => Reading::of(spool),
        }
    }
}

/// Why a large program was not corrected in chunks.
enum LargeEnd {
    /// It must be read as a whole: flow, and what is rare.
    AsAWhole,
    Failed(Failure),
}

impl From<Failure> for LargeEnd {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

struct Large<'a> {
    name: &'a str,
    /// The first megabytes.
    head: &'a [u8],
    kept: &'a Kept,
    settings: &'a Settings,
    manner: Manner,
    progress: &'a (dyn Fn(f64) -> Result<(), Failure> + Sync),
}

impl Large<'_> {
    fn correct(&self, out: &mut impl Growing) -> Result<Program, LargeEnd> {
        // Told from the first bytes only; what ends within them is rare enough.
        if nc_syntax::looks_like_program(self.head).is_err() {
            return Err(LargeEnd::AsAWhole);
        }
        let unread = |error: &io::Error| LargeEnd::Failed(Failure::file(self.name, "read", error));
        let open = || Ok(self.kept.reading());
        let settings = self.settings;
        let survey = Survey::of(
            self.kept.reading(),
            &settings.dialect,
            self.manner.hashes,
            |_| -> Result<(), SurveyEnd> { (self.progress)(0.0).map_err(SurveyEnd::Failed) },
        )
        .map_err(|end| match end {
            SurveyEnd::Unread(Unread::AsAWhole) => LargeEnd::AsAWhole,
            SurveyEnd::Unread(Unread::Failed(error)) => unread(&error),
            SurveyEnd::Failed(failure) => LargeEnd::Failed(failure),
        })?;
        if survey.corrected_before && !self.manner.force {
            return Err(LargeEnd::AsAWhole);
        }
        let provenance = settings.provenance();
        let job = settings.job(true, &provenance)?;
        let plan = Plan {
            job: &job,
            envelope: survey.envelope,
            start: State::new(&job, &survey.numbers),
            threads: self.manner.threads.max(1),
            chunk_bytes: CHUNK_BYTES,
        };
        let mut sink = Sink::new(&mut *out, self.manner.hashes, self.mark(&job, &plan));
        let total = survey.bytes.max(1) as f64;
        let stopped = std::sync::Mutex::new(None);
        let progress = |done: u64| match (self.progress)(done as f64 / total) {
            Ok(()) => true,
            Err(failure) => {
                *stopped.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(failure);
                false
            }
        };
        let tally = match stream::correct(&plan, self.kept.reading(), &mut sink, &open, &progress) {
            Ok(tally) => tally,
            Err(End::Refused(chunk, diagnostics)) => {
                return Err(self.refused(chunk, diagnostics, survey.envelope));
            }
            Err(End::Flows | End::Unread(Unread::AsAWhole)) => return Err(LargeEnd::AsAWhole),
            Err(End::Unread(Unread::Failed(error))) => return Err(unread(&error)),
            Err(End::Unwritten(error)) => return Err(LargeEnd::Failed(unwritten(&error))),
            Err(End::Stopped) => {
                let stopped = stopped.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
                return Err(LargeEnd::Failed(stopped.unwrap_or(Failure::Interrupted(2))));
            }
        };
        let Written { bytes, hash, changed } =
            sink.finish(open).map_err(|error| LargeEnd::Failed(unwritten(&error)))?;
        let mut figures = tally.figures;
        let questions = settings.questions();
        tally.evidence.refusal(&questions).map_err(|finding| self.refused_as_a_whole(*finding))?;
        let mut warnings = tally.notices.warnings();
        warnings.extend(tally.evidence.doubts(&questions));
        figures.warnings = warnings.iter().map(|(warning, _)| warning.clone()).collect();
        let reports: Result<Vec<Report>, LargeEnd> = warnings
            .into_iter()
            .map(|warning| self.report(warning).map_err(|error| unread(&error)))
            .collect();
        Ok(Program {
            name: self.name.to_owned(),
            input: Digest { bytes: survey.bytes, hash: survey.hash },
            output: Digest { bytes, hash },
            changed,
            figures,
            warnings: reports?,
            // What calls subprograms is worked on as a whole.
            lookups: Vec::new(),
        })
    }

    /// The mark of the correction, and the bytes of output before it.
    fn mark(&self, job: &Job<'_>, plan: &Plan<'_>) -> (u64, Vec<u8>) {
        let comment = nc_emit::provenance_comment(job.dialect, job.provenance);
        let reader = Reader::part(self.head, job.dialect, plan.envelope, Place::START);
        let (at, line) = nc_emit::provenance_line(self.head, comment_position(reader), &comment);
        (at as u64, line)
    }

    /// A program that computes somewhere behind the block that was refused is told about as a whole.
    fn refused(&self, chunk: Chunk, diagnostics: Vec<Diagnostic>, envelope: Envelope) -> LargeEnd {
        let computes = |text: &[u8]| {
            let mut found = false;
            super::each_block(text, &self.settings.dialect, |block| {
                found |= nc_expand::computes(block, &self.settings.dialect);
            });
            found
        };
        let mut chunks = Chunks::new(self.kept.reading(), CHUNK_BYTES);
        // What the program as a whole shows tells more than one of its blocks.
        let questions = self.settings.questions();
        let (mut evidence, mut expects_name) = (Evidence::default(), false);
        loop {
            match chunks.next() {
                Ok(Some(other)) => {
                    if other.index >= chunk.index && computes(&other.text) {
                        return LargeEnd::AsAWhole;
                    }
                    let place = other.place(expects_name);
                    let mut reader = Reader::part(&other.text, &self.settings.dialect, envelope, place);
                    evidence.see_all(&mut reader, &questions);
                    expects_name = reader.expects_name();
                }
                Ok(None) => break,
                Err(_) => return LargeEnd::AsAWhole,
            }
        }
        if let Err(finding) = evidence.refusal(&questions) {
            return self.refused_as_a_whole(*finding);
        }
        let source = Source {
            name: self.name.to_owned(),
            bytes: chunk.text,
            offset: chunk.offset,
            first_line: chunk.line,
        };
        LargeEnd::Failed(Failure::Refused(vec![Report { source: Some(source), diagnostics }]))
    }

    /// A refusal for what the program as a whole shows.
    fn refused_as_a_whole(&self, finding: Warning) -> LargeEnd {
        match self.report(finding) {
            Ok(report) => LargeEnd::Failed(Failure::Refused(vec![report])),
            Err(error) => LargeEnd::Failed(Failure::file(self.name, "read", &error)),
        }
    }

    /// A warning with the line it is about.
    fn report(&self, (diagnostic, line): Warning) -> io::Result<Report> {
        /// Longer lines are shown in part.
        const BEFORE: u64 = 1 << 16;
        let span = diagnostic.span.clone().unwrap_or(0..0);
        let from = span.start.saturating_sub(BEFORE);
        let mut file = self.kept.reading();
        file.seek(SeekFrom::Start(from))?;
        let mut bytes = Vec::new();
        file.take(span.end - from + 4096).read_to_end(&mut bytes)?;
        let at = usize::try_from(span.start - from).unwrap_or(0).min(bytes.len());
        let start = memchr::memrchr2(b'\n', b'\r', &bytes[..at]).map_or(0, |end| end + 1);
        bytes.drain(..start);
        let source =
            Source { name: self.name.to_owned(), bytes, offset: from + start as u64, first_line: line };
        Ok(Report { source: Some(source), diagnostics: vec![diagnostic] })
    }
}

enum SurveyEnd {
    Unread(Unread),
    Failed(Failure),
}

impl From<Unread> for SurveyEnd {
    fn from(unread: Unread) -> Self {
        Self::Unread(unread)
    }
}
