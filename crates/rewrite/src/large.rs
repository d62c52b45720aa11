//! A program of any size, chunk by chunk.

use std::io::{self, Read, Seek, SeekFrom, Write};
use std::sync::{Mutex, PoisonError};

use diagnostic::Diagnostic;
use nc_program::{Evidence, Questions};
use nc_syntax::{Block, Envelope, Place, Reader};

use crate::chunks::{CHUNK_BYTES, Chunk, Chunks, Survey, Unread};
use crate::figures::Figures;
use crate::job::{Job, Warning};
use crate::sink::{Sink, Written};
use crate::state::State;
use crate::stream::{self, End, Plan};
use crate::tally::Tally;
use crate::whole::{comment_position, each_block};

/// How a program is worked on.
#[derive(Debug, Clone, Copy)]
pub struct Manner {
    /// Also one that was corrected before.
    pub force: bool,
    /// Threads for a large one; the bytes are the same for any number.
    pub threads: usize,
    /// Hashes of input and output are wanted.
    pub hashes: bool,
}

impl Manner {
    fn hasher(self) -> Option<blake3::Hasher> {
        self.hashes.then(blake3::Hasher::new)
    }
}

/// A text by its length and hash.
#[derive(Debug, Clone, Copy, Default)]
pub struct Digest {
    /// Its length.
    pub bytes: u64,
    /// Where it was wanted.
    pub hash: Option<blake3::Hash>,
}

impl Digest {
    /// Of a text in memory.
    #[must_use]
    pub fn of(bytes: &[u8], hashes: bool) -> Self {
        Self { bytes: bytes.len() as u64, hash: hashes.then(|| blake3::hash(bytes)) }
    }
}

/// Some lines of a program, and what is to be said of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Whole lines.
    pub bytes: Vec<u8>,
    /// Bytes of the program before them.
    pub offset: u64,
    /// Number of the first line, from 1.
    pub first_line: u64,
    /// Spans count from the program's start.
    pub diagnostics: Vec<Diagnostic>,
}

/// A large program that was corrected.
#[derive(Debug)]
pub struct Large {
    /// What was read.
    pub input: Digest,
    /// What was written.
    pub output: Digest,
    /// The output is not the input.
    pub changed: bool,
    /// What was done.
    pub figures: Figures,
    /// What is to be said.
    pub warnings: Vec<Part>,
}

/// Why a large program was not corrected in chunks.
#[derive(Debug)]
pub enum LargeEnd<E> {
    /// It must be read as a whole: flow, and what is rare.
    AsAWhole,
    /// It cannot be corrected with certainty.
    Refused(Part),
    /// It cannot be read.
    Unread(io::Error),
    /// The output cannot be written.
    Unwritten(io::Error),
    /// The caller wants no more.
    Stopped(E),
}

impl<E> From<Unread> for LargeEnd<E> {
    fn from(unread: Unread) -> Self {
        match unread {
            Unread::AsAWhole => Self::AsAWhole,
            Unread::Failed(error) => Self::Unread(error),
        }
    }
}

/// Why nothing more was written.
pub(crate) enum Ended<E> {
    /// The work ended early.
    Early(End),
    /// The caller wants no more.
    Stopped(E),
}

/// A program that can be read more than once, and how it is worked on.
pub struct Source<'a, O> {
    /// Its first megabytes.
    pub head: &'a [u8],
    /// Reads it from its start.
    pub open: O,
    /// What decides what becomes of it.
    pub job: &'a Job<'a>,
    /// How it is worked on.
    pub manner: Manner,
}

impl<R: Read + Send, O: Fn() -> R + Sync> Source<'_, O> {
    /// What stands anywhere in it and bears on all of it, where that is no reason to look at all of it at once.
    pub(crate) fn survey<E>(
        &self,
        progress: &(dyn Fn(f64) -> Result<(), E> + Sync),
    ) -> Result<Survey, LargeEnd<E>> {
        // Told from the first bytes only; what ends within them is rare enough.
        if nc_syntax::looks_like_program(self.head).is_err() {
            return Err(LargeEnd::AsAWhole);
        }
        let survey = Survey::of((self.open)(), self.job.dialect, self.manner.hasher(), |_| {
            progress(0.0).map_err(LargeEnd::Stopped)
        })?;
        if survey.corrected_before && !self.manner.force { Err(LargeEnd::AsAWhole) } else { Ok(survey) }
    }

    /// Writes it corrected; `as_it_was` is what is written of it, and how much, where nothing is.
    pub(crate) fn written<E: Send, A: Read>(
        &self,
        survey: &Survey,
        out: &mut (impl Write + Send),
        (as_it_was, length): (impl Fn() -> A, u64),
        progress: &(dyn Fn(f64) -> Result<(), E> + Sync),
    ) -> Result<(Tally, Written), Ended<E>> {
        let plan = Plan {
            job: self.job,
            envelope: survey.envelope,
            start: State::new(self.job, &survey.numbers),
            threads: self.manner.threads.max(1),
            chunk_bytes: CHUNK_BYTES,
        };
        let mut sink = Sink::new(&mut *out, self.manner.hasher(), self.mark(plan.envelope));
        let total = survey.bytes.max(1) as f64;
        let stopped = Mutex::new(None);
        let goes_on = |done: u64| match progress(done as f64 / total) {
            Ok(()) => true,
            Err(failure) => {
                *stopped.lock().unwrap_or_else(PoisonError::into_inner) = Some(failure);
                false
            }
        };
        let again = || Ok((self.open)());
        match stream::correct(&plan, (self.open)(), &mut sink, &again, &goes_on) {
            Ok(tally) => match sink.finish(|| Ok(as_it_was()), length) {
                Ok(written) => Ok((tally, written)),
                Err(error) => Err(Ended::Early(End::Unwritten(error))),
            },
            Err(End::Stopped) => {
                let stopped = stopped.into_inner().unwrap_or_else(PoisonError::into_inner);
                Err(Ended::Stopped(stopped.expect("who stops says why")))
            }
            Err(end) => Err(Ended::Early(end)),
        }
    }

    /// The mark of the correction, and the bytes of output before it.
    fn mark(&self, envelope: Envelope) -> (u64, Vec<u8>) {
        let comment = nc_emit::provenance_comment(self.job.dialect, self.job.provenance);
        let reader = Reader::part(self.head, self.job.dialect, envelope, Place::START);
        let (at, line) = nc_emit::provenance_line(self.head, comment_position(reader), &comment);
        (at as u64, line)
    }
}

impl<R: Read + Seek + Send, O: Fn() -> R + Sync> Source<'_, O> {
    /// Corrects it in chunks, some megabytes for each thread.
    ///
    /// `progress` is told the share that is done, 0 to 1, and may end the work. `out` is of no use after an error.
    ///
    /// # Errors
    /// [`LargeEnd`].
    pub fn correct<E: Send>(
        &self,
        out: &mut (impl Write + Send),
        progress: &(dyn Fn(f64) -> Result<(), E> + Sync),
    ) -> Result<Large, LargeEnd<E>> {
        let survey = self.survey(progress)?;
        let (tally, written) = match self.written(&survey, out, (&self.open, survey.bytes), progress) {
            Ok(written) => written,
            Err(Ended::Stopped(failure)) => return Err(LargeEnd::Stopped(failure)),
            Err(Ended::Early(End::Refused(chunk, diagnostics))) => {
                return Err(self.refused(chunk, diagnostics, survey.envelope));
            }
            Err(Ended::Early(End::Unfinished(finding))) => return Err(self.refused_as_a_whole(*finding)),
            Err(Ended::Early(End::Unread(unread))) => return Err(unread.into()),
            Err(Ended::Early(End::Unwritten(error))) => return Err(LargeEnd::Unwritten(error)),
            Err(Ended::Early(End::Flows | End::Stopped)) => return Err(LargeEnd::AsAWhole),
        };
        let questions = self.questions();
        tally.evidence.refusal(&questions).map_err(|finding| self.refused_as_a_whole(*finding))?;
        let mut warnings = tally.warnings(self.job);
        warnings.extend(tally.evidence.doubts(&questions));
        self.done(&survey, written, tally.figures, warnings)
    }

    pub(crate) fn questions(&self) -> Questions<'_> {
        Questions::new(self.job.dialect, self.job.setup)
    }

    /// What was done, in figures.
    pub(crate) fn done<E>(
        &self,
        survey: &Survey,
        Written { bytes, hash, changed }: Written,
        figures: Figures,
        warnings: Vec<Warning>,
    ) -> Result<Large, LargeEnd<E>> {
        let said = warnings.iter().map(|(warning, _)| warning.clone()).collect();
        let warnings: io::Result<Vec<Part>> =
            warnings.into_iter().map(|warning| self.part(warning)).collect();
        Ok(Large {
            input: Digest { bytes: survey.bytes, hash: survey.hash },
            output: Digest { bytes, hash },
            changed,
            figures: Figures { warnings: said, ..figures },
            warnings: warnings.map_err(LargeEnd::Unread)?,
        })
    }

    /// What the program as a whole shows; `None` where it cannot be read, or a block from a chunk on is of the kind `ends`.
    pub(crate) fn evidence(
        &self,
        envelope: Envelope,
        from: usize,
        ends: impl Fn(&Block<'_>) -> bool,
    ) -> Option<Evidence> {
        let dialect = self.job.dialect;
        let mut chunks = Chunks::new((self.open)(), CHUNK_BYTES);
        let questions = self.questions();
        let (mut evidence, mut expects_name) = (Evidence::default(), false);
        while let Some(chunk) = chunks.next().ok()? {
            let mut found = false;
            if chunk.index >= from {
                each_block(&chunk.text, dialect, |block| found |= ends(block));
            }
            if found {
                return None;
            }
            let mut reader = Reader::part(&chunk.text, dialect, envelope, chunk.place(expects_name));
            evidence.see_all(&mut reader, &questions);
            expects_name = reader.expects_name();
        }
        Some(evidence)
    }

    /// A program that computes somewhere behind the block that was refused is told about as a whole.
    fn refused<E>(&self, chunk: Chunk, diagnostics: Vec<Diagnostic>, envelope: Envelope) -> LargeEnd<E> {
        let computes = |block: &Block<'_>| nc_expand::computes(block, self.job.dialect);
        let Some(evidence) = self.evidence(envelope, chunk.index, computes) else {
            return LargeEnd::AsAWhole;
        };
        // What the program as a whole shows tells more than one of its blocks.
        if let Err(finding) = evidence.refusal(&self.questions()) {
            return self.refused_as_a_whole(*finding);
        }
        let Chunk { text: bytes, offset, line: first_line, .. } = chunk;
        LargeEnd::Refused(Part { bytes, offset, first_line, diagnostics })
    }

    /// A refusal for what the program as a whole shows.
    fn refused_as_a_whole<E>(&self, finding: Warning) -> LargeEnd<E> {
        self.part(finding).map_or_else(LargeEnd::Unread, LargeEnd::Refused)
    }

    /// A warning with the line it is about.
    fn part(&self, (diagnostic, first_line): Warning) -> io::Result<Part> {
        /// Longer lines are shown in part.
        const BEFORE: u64 = 1 << 16;
        let span = diagnostic.span.clone().unwrap_or(0..0);
        let from = span.start.saturating_sub(BEFORE);
        let mut file = (self.open)();
        file.seek(SeekFrom::Start(from))?;
        let mut bytes = Vec::new();
        file.take(span.end - from + 4096).read_to_end(&mut bytes)?;
        let at = usize::try_from(span.start - from).unwrap_or(0).min(bytes.len());
        let start = memchr::memrchr2(b'\n', b'\r', &bytes[..at]).map_or(0, |end| end + 1);
        bytes.drain(..start);
        Ok(Part { bytes, offset: from + start as u64, first_line, diagnostics: vec![diagnostic] })
    }
}
