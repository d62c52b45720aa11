//! The main job: bytes in, bytes out.
//!
//! `nc-syntax` reads blocks, `nc-program` says what they make the axes do, `correction` says what they
//! should be told instead, `nc-emit` writes it. Nothing flows back.

mod chunks;
mod notices;
mod pass;
mod plain;
mod program;
mod sink;
mod stream;

use std::path::Path;
use std::sync::Mutex;

use correction::Options;
use diagnostic::{Code, Diagnostic};
use machine_model::PathModel;
use nc_emit::BlockNumbers;
use nc_program::{Evidence, Setup};
use nc_syntax::{Block, Dialect, Reader};

use crate::arguments::{self, Shared};
use crate::file;
use crate::interrupt::Interrupt;
use crate::message::{Failure, Messages};
use crate::roles::Roles;
use crate::settings::Settings;
use crate::summary::Summary;
use pass::{Pass, State, Tally};
pub(crate) use program::{Digest, Growing, Input, Manner, Program, program};

/// Feed motion, or what would correct it, lies outside the calibrated volume.
pub const OUTSIDE: Code = Code(501);
/// The path cannot be held within tolerance.
pub const NOT_WITHIN_TOLERANCE: Code = Code(502);
/// A motion that must stay one block would need to be split.
pub const MUST_NOT_SPLIT: Code = Code(503);
/// The model has no single answer at a point.
pub const NOT_CONVERGED: Code = Code(504);
/// The program was corrected before.
pub const CORRECTED_BEFORE: Code = Code(505);
/// A drilling cycle leans by more than the tolerance.
pub const LEANING_CYCLE: Code = Code(506);
/// Rapids end outside the calibrated volume.
pub const RAPID_OUTSIDE: Code = Code(507);
/// Motion under cutter compensation was corrected.
pub const COMPENSATED: Code = Code(508);
/// Nobody knows on which side of its play an axis stands.
pub const UNKNOWN_SIDE: Code = Code(509);
/// A hole of more pecks than anybody drills.
pub const TOO_MANY_PECKS: Code = Code(510);
/// Arcs end off their circle, as the control takes them.
pub const SPIRAL: Code = Code(515);
/// An axis would need a word, and the program has not named it in the frame in force.
pub const UNNAMED: Code = Code(514);
/// Lost motion moves the tool sideways where an axis turns, by more than can be hidden.
pub const SIDEWAYS: Code = Code(519);

/// The mark of the correction stands behind one of so many blocks at most.
const OPENING_BLOCKS: usize = 64;

/// Progress is told about every so many bytes.
const REPORTED_BYTES: u64 = 1 << 13;

/// Everything that decides what becomes of a program.
pub struct Job<'a> {
    /// The control's dialect.
    pub dialect: &'a Dialect,
    /// Work offsets and tools.
    pub setup: &'a Setup,
    /// Where the machine really goes.
    pub model: &'a dyn PathModel,
    /// Tolerance and policy.
    pub options: Options,
    /// Decimals of X, Y, Z in mm.
    pub decimals_mm: [u8; 3],
    /// Correct a program that was corrected before.
    pub force: bool,
    /// What the comment in the output says after its marker.
    pub provenance: &'a str,
}

/// What happened, in figures.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Figures {
    /// Blocks read.
    pub blocks_in: u64,
    /// Blocks written.
    pub blocks_out: u64,
    /// Motions that became more than one block.
    pub splits: u64,
    /// Largest correction of an end point, mm, and its line.
    pub largest: (f64, u64),
    /// Proven bound of the path deviation before, mm, and its line.
    pub before: (f64, u64),
    /// Proven bound of the path deviation after, mm, and its line.
    pub after: (f64, u64),
    /// Short moves to a corrected start that were put in.
    pub approaches: u64,
    /// What the user should know.
    pub warnings: Vec<Diagnostic>,
}

/// A corrected program.
#[derive(Debug, Clone, PartialEq)]
pub struct Corrected {
    /// Its bytes.
    pub text: Vec<u8>,
    /// What was done.
    pub figures: Figures,
    /// What the program as a whole shows; who corrects it judges that.
    pub evidence: Evidence,
}

/// Corrects a program.
///
/// `interrupted` is asked now and then; what it returns ends the work.
///
/// # Errors
/// The diagnostics of the first block that cannot be corrected with certainty.
pub fn correct<E: From<Vec<Diagnostic>>>(
    text: &[u8],
    job: &Job<'_>,
    progress: impl FnMut(u64) -> Result<(), E>,
) -> Result<Corrected, E> {
    nc_syntax::looks_like_program(text).map_err(|diagnostic| vec![diagnostic])?;
    if let (Some(diagnostic), false) = (corrected_before(text), job.force) {
        return Err(vec![diagnostic].into());
    }
    let corrected = pass(text, job, |_| false, progress)?;
    Ok(marked(corrected.expect("a pass that stops nowhere ends at the end"), text, job))
}

/// Corrects what [`nc_syntax::looks_like_program`], bears no mark of a correction, and has no block that
/// [computes](nc_expand::computes); `None` where one does.
///
/// # Errors
/// As [`correct`].
pub(crate) fn correct_plain<E: From<Vec<Diagnostic>>>(
    text: &[u8],
    job: &Job<'_>,
    progress: impl FnMut(u64) -> Result<(), E>,
) -> Result<Option<Corrected>, E> {
    let corrected = pass(text, job, |block| nc_expand::computes(block, job.dialect), progress)?;
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
fn pass<E: From<Vec<Diagnostic>>>(
    text: &[u8],
    job: &Job<'_>,
    stop: impl Fn(&Block<'_>) -> bool,
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
    let Pass { out, tally: Tally { mut figures, notices, evidence }, .. } = pass;
    figures.warnings = notices.warnings().into_iter().map(|(warning, _)| warning).collect();
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
fn comment_position(mut reader: Reader<'_>) -> u64 {
    let mut block = Block::default();
    let opening = std::iter::from_fn(|| reader.next(&mut block).then(|| block.clone()));
    nc_emit::provenance_position(opening.take(OPENING_BLOCKS))
}

/// The refusal of a program that bears the mark of an earlier correction.
pub(crate) fn corrected_before(text: &[u8]) -> Option<Diagnostic> {
    nc_emit::find_provenance(text).map(|span| {
        Diagnostic::error(CORRECTED_BEFORE, "this program was corrected before")
            .at(span, "its mark")
            .help("correct the program as posted, not its corrected copy; `--force` corrects once more")
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

/// `vpost IN.nc -m PROFILE`
pub(crate) fn run(
    arguments: &arguments::Correct,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    let path = arguments.input.as_deref().unwrap_or(Path::new("-"));
    let settings = Settings::load(shared, messages)?;
    Roles::default()
        .reads("the program", path)
        .reads_all("read by the profile", &settings.files)
        .reads_folders("in a folder of subprograms", &shared.include)
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
    if shared.verbose > 0 {
        messages.note(&Summary::line(&done.figures));
    }
    Ok(())
}
