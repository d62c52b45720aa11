//! A program in chunks of whole lines, and what must be known of all of it before the first block is corrected.

use std::io::{self, Read};

use nc_dialect::Dialect;
use nc_emit::BlockNumbers;
use nc_syntax::{Block, Envelope, EnvelopeFinder, Place, PlainLine, Reader};

/// About so long is a chunk: some ten thousand blocks, small enough that all of those in work fit into memory.
pub(crate) const CHUNK_BYTES: usize = 1 << 20;
/// The first one is shorter by so much: it holds what the program sets before it cuts, which the others start from.
const FIRST: usize = 16;
/// A line of more than this is none that a program has.
const LONGEST_LINE: usize = 1 << 20;

/// Whole lines of a program.
pub(crate) struct Chunk {
    /// From 0.
    pub(crate) index: usize,
    /// The bytes.
    pub(crate) text: Vec<u8>,
    /// Bytes of the program before them.
    pub(crate) offset: u64,
    /// Its first line, from 1.
    pub(crate) line: u64,
}

impl Chunk {
    /// Where it starts, for a reader.
    pub(crate) fn place(&self, expects_name: bool) -> Place {
        Place { offset: self.offset, line: self.line, expects_name }
    }
}

/// Reads chunks.
pub(crate) struct Chunks<R> {
    source: R,
    chunk_bytes: usize,
    /// Bytes that were read behind the last line end.
    rest: Vec<u8>,
    index: usize,
    offset: u64,
    line: u64,
}

/// Why there is no further chunk.
pub(crate) enum Unread {
    /// The source cannot be read.
    Failed(io::Error),
    /// What is rare and needs all of the program at once: a line without end, block numbers outside of the `%` marks.
    AsAWhole,
}

impl<R: Read> Chunks<R> {
    /// Chunks of about `chunk_bytes`.
    pub(crate) fn new(source: R, chunk_bytes: usize) -> Self {
        Self { source, chunk_bytes, rest: Vec::new(), index: 0, offset: 0, line: 1 }
    }

    /// The next chunk; `None` at the end.
    pub(crate) fn next(&mut self) -> Result<Option<Chunk>, Unread> {
        let next = self.next_uncounted()?;
        if let Some(chunk) = &next {
            self.line += nc_syntax::line_ends(&chunk.text);
        }
        Ok(next)
    }

    /// The next chunk, for those who ask for no lines: the chunks behind it do not know theirs.
    fn next_uncounted(&mut self) -> Result<Option<Chunk>, Unread> {
        let wanted = if self.index == 0 { self.chunk_bytes / FIRST } else { self.chunk_bytes };
        let mut text = Vec::with_capacity(wanted + 4096);
        text.append(&mut self.rest);
        loop {
            let missing = wanted.saturating_sub(text.len()).max(self.chunk_bytes / FIRST).max(1);
            let read =
                (&mut self.source).take(missing as u64).read_to_end(&mut text).map_err(Unread::Failed)?;
            let ended = read < missing;
            match if ended { Some(text.len()) } else { last_line_end(&text) } {
                Some(0) => return Ok(None),
                Some(end) => {
                    self.rest.extend_from_slice(&text[end..]);
                    text.truncate(end);
                    let chunk = Chunk { index: self.index, offset: self.offset, line: self.line, text };
                    self.index += 1;
                    self.offset += chunk.text.len() as u64;
                    return Ok(Some(chunk));
                }
                None if text.len() > LONGEST_LINE => return Err(Unread::AsAWhole),
                None => {}
            }
        }
    }
}

/// Bytes up to and with the last line end that is certainly a whole one: CR may be the start of CR LF.
fn last_line_end(text: &[u8]) -> Option<usize> {
    if let Some(at) = memchr::memrchr(b'\n', text) {
        return Some(at + 1);
    }
    let whole = |at: &usize| text.get(at + 1).is_some_and(|next| !matches!(next, b'\r' | b'\n'));
    memchr::memrchr_iter(b'\r', text).find(whole).map(|at| at + 1)
}

/// Notes the N words of all that a reader reads; `seen` is told the offset of each block that has one.
pub(crate) fn see_numbers(reader: &mut Reader<'_>, numbers: &mut BlockNumbers, mut seen: impl FnMut(u64)) {
    let (mut line, mut block) = (PlainLine::default(), Block::default());
    let mut numbered = false;
    loop {
        // Behind a numbered block mostly stands another one.
        if !numbered {
            reader.skip_lines_without(b'N');
        }
        let offset;
        (numbered, offset) = if reader.plain_line(&mut line) {
            (numbers.see_line(&line), line.offset)
        } else if reader.next(&mut block) {
            (numbers.see(&block), block.offset)
        } else {
            return;
        };
        if numbered {
            seen(offset);
        }
    }
}

/// What stands anywhere in a program and bears on all of it.
pub(crate) struct Survey {
    /// Where it starts and ends between its `%` marks.
    pub(crate) envelope: Envelope,
    /// Its N numbers, where inserted blocks get some.
    pub(crate) numbers: BlockNumbers,
    /// It says that it was corrected before.
    pub(crate) corrected_before: bool,
    /// Its length.
    pub(crate) bytes: u64,
    /// Its hash, where that is wanted.
    pub(crate) hash: Option<blake3::Hash>,
}

impl Survey {
    /// Reads a program once; `seen` is given each chunk, and may end the work.
    pub(crate) fn of<R: Read, E: From<Unread>>(
        source: R,
        dialect: &Dialect,
        mut hasher: Option<blake3::Hasher>,
        mut seen: impl FnMut(&Chunk) -> Result<(), E>,
    ) -> Result<Self, E> {
        let mut chunks = Chunks::new(source, CHUNK_BYTES);
        let mut finder = EnvelopeFinder::new(dialect);
        let mut survey = Self {
            envelope: finder.finish(),
            numbers: BlockNumbers::new(),
            corrected_before: false,
            bytes: 0,
            hash: None,
        };
        let mut expects_name = false;
        let (mut first_numbered, mut last_numbered) = (None, 0);
        while let Some(chunk) = chunks.next_uncounted()? {
            let text = &chunk.text;
            finder.see(text);
            survey.corrected_before |= nc_emit::find_provenance(text).is_some();
            if dialect.output.number_inserted_blocks && memchr::memchr2(b'N', b'n', text).is_some() {
                let place = chunk.place(expects_name);
                let mut reader = Reader::part(text, dialect, finder.open(), place);
                see_numbers(&mut reader, &mut survey.numbers, |offset| {
                    first_numbered.get_or_insert(offset);
                    last_numbered = offset;
                });
                expects_name = reader.expects_name();
            }
            if let Some(hasher) = &mut hasher {
                hasher.update(text);
            }
            survey.bytes += text.len() as u64;
            seen(&chunk)?;
        }
        survey.envelope = finder.finish();
        // Numbers outside of the marks are text: that was not known when they were read.
        if first_numbered
            .is_some_and(|first| !survey.envelope.holds(first) || !survey.envelope.holds(last_numbered))
        {
            return Err(Unread::AsAWhole.into());
        }
        survey.hash = hasher.map(|hasher| hasher.finalize());
        Ok(survey)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chunks_are_whole_lines_and_know_their_place() {
        for end in ["\n", "\r\n", "\r\r\n", "\r"] {
            let text: Vec<u8> =
                (0..60_000).flat_map(|n| format!("N{n} G1 X{n}.5 (LINE){end}").into_bytes()).collect();
            let mut chunks = Chunks::new(&text[..], 1 << 18);
            let (mut copy, mut count) = (Vec::new(), 0);
            while let Ok(Some(chunk)) = chunks.next() {
                assert_eq!((chunk.index, chunk.offset), (count, copy.len() as u64));
                assert!(chunk.text.starts_with(format!("N{} ", chunk.line - 1).as_bytes()), "{end:?}");
                copy.extend_from_slice(&chunk.text);
                count += 1;
            }
            assert!(copy == text && count > 2, "{end:?}: {count}");
        }
    }

    #[test]
    fn a_line_without_end_is_no_chunk() {
        let text = vec![b'X'; 3 << 20];
        assert!(matches!(Chunks::new(&text[..], CHUNK_BYTES).next(), Err(Unread::AsAWhole)));
    }
}
