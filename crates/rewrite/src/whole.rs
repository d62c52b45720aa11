//! A program in one piece.

use diagnostic::{Diagnostic, both};
use nc_dialect::Dialect;
use nc_emit::BlockNumbers;
use nc_syntax::{Block, Reader};

use crate::chunks;
use crate::figures::Corrected;
use crate::job::{CORRECTED_BEFORE, Job};
use crate::pass::Pass;
use crate::state::State;
use crate::tally::Tally;

/// The mark of the correction stands behind one of so many blocks at most.
const OPENING_BLOCKS: usize = 64;

/// Progress is told about every so many bytes.
const REPORTED_BYTES: u64 = 1 << 13;

/// Corrects a program.
///
/// `source_line` names the line of the user's file that a line of the text stands for; `progress` is told now and then the
/// bytes that are done; what it returns ends the work.
///
/// # Errors
/// The diagnostics of the first block that cannot be corrected with certainty.
pub fn correct<E: From<Vec<Diagnostic>>>(
    text: &[u8],
    job: &Job<'_>,
    source_line: impl Fn(u64) -> u64,
    progress: impl FnMut(u64) -> Result<(), E>,
) -> Result<Corrected, E> {
    nc_syntax::looks_like_program(text).map_err(|diagnostic| vec![diagnostic])?;
    if let (Some(diagnostic), false) = (corrected_before(text), job.force) {
        return Err(vec![diagnostic].into());
    }
    let corrected = pass(text, job, |_| false, source_line, progress)?;
    Ok(marked(corrected.expect("a pass that stops nowhere ends at the end"), text, job))
}

/// Corrects what [`nc_syntax::looks_like_program`], bears no mark of a correction, and has no block that
/// [computes](nc_expand::computes); `None` where one does.
///
/// # Errors
/// As [`correct`].
pub fn correct_plain<E: From<Vec<Diagnostic>>>(
    text: &[u8],
    job: &Job<'_>,
    progress: impl FnMut(u64) -> Result<(), E>,
) -> Result<Option<Corrected>, E> {
    let corrected = pass(text, job, |block| nc_expand::computes(block, job.dialect), |line| line, progress)?;
    Ok(corrected.map(|corrected| marked(corrected, text, job)))
}

/// Why a pass ended before the program did.
enum Ended<E> {
    Stopped,
    Failed(E),
}

impl<E: From<Vec<Diagnostic>>> From<Vec<Diagnostic>> for Ended<E> {
    fn from(diagnostics: Vec<Diagnostic>) -> Self {
        Self::Failed(diagnostics.into())
    }
}

/// One pass over all blocks; the output does not say yet that it was corrected. `None` where `stop` holds for a
/// block that is more than coordinates.
pub(crate) fn pass<E: From<Vec<Diagnostic>>>(
    text: &[u8],
    job: &Job<'_>,
    stop: impl Fn(&Block<'_>) -> bool,
    source_line: impl Fn(u64) -> u64,
    mut progress: impl FnMut(u64) -> Result<(), E>,
) -> Result<Option<Corrected>, E> {
    let mut numbers = BlockNumbers::new();
    if job.dialect.output.number_inserted_blocks && memchr::memchr2(b'N', b'n', text).is_some() {
        chunks::see_numbers(&mut Reader::new(text, job.dialect), &mut numbers, |_| ());
    }
    let mut pass = Pass::new(job, State::new(job, &numbers), text.len());
    let mut reader = Reader::new(text, job.dialect);
    let every_now_and_then = |pass: &mut Pass<'_>, offset: u64| {
        progress(offset).map_err(Ended::Failed)?;
        pass.next_stop = offset + REPORTED_BYTES;
        Ok(false)
    };
    let stops = |block: &Block<'_>| if stop(block) { Err(Ended::Stopped) } else { Ok(()) };
    match pass.run(&mut reader, every_now_and_then, stops) {
        Ok(_) => {}
        Err(Ended::Stopped) => return Ok(None),
        Err(Ended::Failed(error)) => return Err(error),
    }
    if let Some((unfinished, _)) = pass.state.interpreter.unfinished() {
        return Err(vec![unfinished].into());
    }
    let Pass { out, mut tally, .. } = pass;
    tally.figures.each_line(|line| *line = source_line(*line));
    let warnings = tally.warnings(job);
    let Tally { mut figures, evidence, .. } = tally;
    figures.warnings = warnings.into_iter().map(|(warning, _)| warning).collect();
    Ok(Some(Corrected { text: out, figures, evidence }))
}

/// Puts the mark of the correction into what is not the input.
fn marked(mut corrected: Corrected, text: &[u8], job: &Job<'_>) -> Corrected {
    if corrected.text != text {
        let comment = nc_emit::provenance_comment(job.dialect, job.provenance);
        let position = comment_position(Reader::new(text, job.dialect));
        nc_emit::insert_provenance(&mut corrected.text, position, &comment);
    }
    corrected
}

/// Where the mark of the correction goes. The opening blocks stand unchanged at the start of the output: they move
/// nothing.
pub(crate) fn comment_position(mut reader: Reader<'_>) -> u64 {
    let mut block = Block::default();
    let opening = std::iter::from_fn(|| reader.next(&mut block).then(|| block.clone()));
    nc_emit::provenance_position(opening.take(OPENING_BLOCKS))
}

/// The refusal of a program that bears the mark of an earlier correction.
pub fn corrected_before(text: &[u8]) -> Option<Diagnostic> {
    nc_emit::find_provenance(text).map(|span| {
        Diagnostic::error(CORRECTED_BEFORE, both!("this program was corrected before", "эта программа уже исправлена"))
            .at(span, both!("its mark", "её отметка"))
            .help(both!("correct the program as posted, not its corrected copy; `--force` corrects once more", "исправляйте программу в том виде, как её выдал постпроцессор, а не исправленную копию; `--force` исправит ещё раз"))
    })
}

/// Reads every block once.
pub(crate) fn each_block<'a>(text: &'a [u8], dialect: &'a Dialect, mut f: impl FnMut(&Block<'a>)) {
    let mut reader = Reader::new(text, dialect);
    let mut block = Block::default();
    while reader.next(&mut block) {
        f(&block);
    }
}
