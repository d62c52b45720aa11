//! A program of any size with shorthand: the plain program that it stands for, made as it is read.

use std::collections::BTreeMap;
use std::io::{self, Read, Seek, Write};

use nc_expand::{AsAWhole, Lowering, PlainPart};

use crate::chunks::{CHUNK_BYTES, Chunks, Unread};
use crate::job::{Job, Warning};
use crate::large::{Ended, Large, LargeEnd, Manner, Source};
use crate::stream::End;
use crate::tally::Tally;

/// The mark of the correction stands among the first blocks, which are in so many bytes.
const HEAD_BYTES: u64 = 1 << 20;

impl<R: Read + Seek + Send, O: Fn() -> R + Sync> Source<'_, O> {
    /// Corrects a program with shorthand in chunks. The plain program is made anew whenever it is read, so that it need not be
    /// kept.
    ///
    /// # Errors
    /// [`LargeEnd`]; whatever is refused is [`LargeEnd::AsAWhole`], which says why.
    pub fn correct_lowered<E: Send>(
        &self,
        out: &mut (impl Write + Send),
        progress: &(dyn Fn(f64) -> Result<(), E> + Sync),
    ) -> Result<Large, LargeEnd<E>> {
        let Job { dialect, setup, provenance, .. } = *self.job;
        let survey = self.survey(progress)?;
        let plain = || Plain {
            chunks: Chunks::new((self.open)(), CHUNK_BYTES),
            lowering: Lowering::new(dialect, setup, self.head, survey.envelope),
            part: PlainPart::default(),
            read: 0,
        };
        if plain().lowering.is_none() {
            return Err(LargeEnd::AsAWhole);
        }
        // Of the text as it was written: what is written out says nothing of how lengths are.
        let questions = self.questions();
        let evidence = self.evidence(survey.envelope, 0, |_| false).ok_or(LargeEnd::AsAWhole)?;
        evidence.refusal(&questions).map_err(|_| LargeEnd::AsAWhole)?;
        let mut head = Vec::new();
        plain().take(HEAD_BYTES).read_to_end(&mut head).map_err(|_| LargeEnd::AsAWhole)?;
        let provenance = format!("{provenance} {}", nc_expand::SHORTHAND_WRITTEN_OUT);
        // Whether it was corrected before is told above, by the text as it was given.
        let (job, manner) = (
            Job { force: true, provenance: &provenance, ..*self.job },
            Manner { force: true, ..self.manner },
        );
        let source = Source { head: &head, open: plain, job: &job, manner };
        let whole = |end| if let LargeEnd::Unread(_) = end { LargeEnd::AsAWhole } else { end };
        let survey_of_plain = source.survey(progress).map_err(whole)?;
        let as_it_was = (&self.open, survey.bytes);
        let (tally, written) =
            source.written(&survey_of_plain, out, as_it_was, progress).map_err(|ended| match ended {
                Ended::Stopped(failure) => LargeEnd::Stopped(failure),
                Ended::Early(End::Unwritten(error)) => LargeEnd::Unwritten(error),
                Ended::Early(_) => LargeEnd::AsAWhole,
            })?;
        let (tally, mut warnings) = settled(plain(), tally, &job).map_err(LargeEnd::Unread)?;
        warnings.extend(evidence.doubts(&questions));
        self.done(&survey, written, tally.figures, warnings)
    }
}

/// The plain program that a program with shorthand stands for, as it is read.
struct Plain<'a, R> {
    chunks: Chunks<R>,
    /// Until it has ended.
    lowering: Option<Lowering<'a>>,
    part: PlainPart,
    /// Bytes of the part that were read.
    read: usize,
}

impl<R: Read> Plain<'_, R> {
    /// The next lines; `None` behind the last.
    fn next(&mut self) -> io::Result<Option<PlainPart>> {
        let Some(lowering) = &mut self.lowering else { return Ok(None) };
        let part = match self.chunks.next() {
            Ok(Some(chunk)) => lowering.part(&chunk.text, chunk.offset, chunk.line),
            Ok(None) => self.lowering.take().map_or(Err(AsAWhole), Lowering::end),
            Err(Unread::Failed(error)) => return Err(error),
            Err(Unread::AsAWhole) => Err(AsAWhole),
        };
        part.map(Some).map_err(|AsAWhole| io::Error::other("to be read as a whole"))
    }
}

impl<R: Read> Read for Plain<'_, R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        while self.read == self.part.text().len() {
            let Some(part) = self.next()? else { return Ok(0) };
            (self.part, self.read) = (part, 0);
        }
        let read = (&self.part.text()[self.read..]).read(buffer)?;
        self.read += read;
        Ok(read)
    }
}

/// Puts the places of all that is to be said into the program that a plain one stands for.
fn settled<R: Read>(
    mut plain: Plain<'_, R>,
    mut tally: Tally,
    job: &Job<'_>,
) -> io::Result<(Tally, Vec<Warning>)> {
    let mut places: Vec<Warning> = tally.warnings(job);
    let mut lines: BTreeMap<u64, Option<u64>> = places.iter().map(|(_, line)| (*line, None)).collect();
    tally.figures.each_line(|line| _ = lines.insert(*line, None));
    // Line 0: no place.
    lines.remove(&0);
    let mut spans = vec![None; places.len()];
    let missing = |lines: &BTreeMap<_, Option<u64>>, spans: &[Option<_>]| {
        lines.values().any(Option::is_none) || spans.iter().any(Option::is_none)
    };
    while missing(&lines, &spans)
        && let Some(part) = plain.next()?
    {
        for (line, found) in &mut lines {
            *found = found.or_else(|| part.source_line(*line));
        }
        for ((warning, _), found) in places.iter().zip(&mut spans) {
            *found = found.take().or_else(|| part.origin(warning.span.as_ref()?));
        }
    }
    let source = |line: u64| lines.get(&line).copied().flatten().unwrap_or(line);
    tally.figures.each_line(|line| *line = source(*line));
    // Said anew: their words name lines.
    for (((warning, _), (told, line)), span) in tally.warnings(job).into_iter().zip(&mut places).zip(spans) {
        *told = warning;
        told.span = span;
        *line = source(*line);
    }
    Ok((tally, places))
}
