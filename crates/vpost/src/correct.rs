//! The main job: bytes in, bytes out.
//!
//! `nc-syntax` reads blocks, `nc-program` says what they make the axes do, `correction` says what they
//! should be told instead, `nc-emit` writes it. Nothing flows back.

use std::path::Path;

use correction::{Correction, CorrectionError, Corrector, Options};
use diagnostic::{Code, Diagnostic};
use machine_model::{PathModel, SolveError};
use nc_emit::{BlockNumbers, Emitter};
use nc_program::{Context, Interpreter, Setup};
use nc_syntax::{Block, Dialect, Reader};
use smallvec::SmallVec;
use toolpath::{Feed, FeedRate, Motion};
use units::decimal::Decimal;

use crate::arguments::{self, Shared};
use crate::expand;
use crate::file::{self, Interrupt};
use crate::message::{Failure, Messages};
use crate::settings::Settings;
use crate::summary::Summary;
use crate::words::{Editing, MotionCodes, Original, letters};

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
    mut progress: impl FnMut(u64) -> Result<(), E>,
) -> Result<Corrected, E> {
    nc_syntax::looks_like_program(text).map_err(|diagnostic| vec![diagnostic])?;
    if let (Some(diagnostic), false) = (corrected_before(text), job.force) {
        return Err(vec![diagnostic].into());
    }
    let mut numbers = BlockNumbers::new();
    if job.dialect.output.number_inserted_blocks {
        each_block(text, job.dialect, |block| numbers.see(block));
    }
    let mut run = Run {
        job,
        interpreter: Interpreter::new(job.dialect, job.setup),
        corrector: Corrector::new(job.model, job.options),
        emitter: Emitter::new(job.dialect).with_numbers(&numbers),
        codes: MotionCodes::of(job.dialect),
        dwell: None,
        out: Vec::with_capacity(text.len() + text.len() / 4 + 64),
        figures: Figures::default(),
        notices: Notices::default(),
    };
    let mut reader = Reader::new(text, job.dialect);
    let mut block = Block::default();
    while reader.next(&mut block) {
        run.block(&block)?;
        if run.figures.blocks_in.is_multiple_of(256) {
            progress(block.offset)?;
        }
    }
    let Run { mut out, mut figures, notices, .. } = run;
    if out != text {
        let mut opening: Vec<Block<'_>> = Vec::new();
        let mut reader = Reader::new(text, job.dialect);
        let mut block = Block::default();
        while opening.len() < 64 && reader.next(&mut block) {
            opening.push(block.clone());
        }
        let comment = nc_emit::provenance_comment(job.dialect, job.provenance);
        // The opening blocks stand unchanged at the start of the output: they move nothing.
        let position = nc_emit::provenance_position(&opening);
        nc_emit::insert_provenance(&mut out, position, &comment);
    }
    figures.warnings = notices.diagnostics();
    Ok(Corrected { text: out, figures })
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

struct Run<'a> {
    job: &'a Job<'a>,
    interpreter: Interpreter<'a>,
    corrector: Corrector<'a>,
    emitter: Emitter<'a>,
    codes: MotionCodes,
    /// The last P of a cycle.
    dwell: Option<Decimal>,
    out: Vec<u8>,
    figures: Figures,
    notices: Notices,
}

impl Run<'_> {
    fn block(&mut self, block: &Block<'_>) -> Result<(), Vec<Diagnostic>> {
        self.figures.blocks_in += 1;
        let step = self.interpreter.step(block)?;
        let letters = letters(block);
        let context = &step.context;
        if step.motions.iter().any(|motion| matches!(motion, Motion::Hole(_)))
            && let Some(number) = block.word(b'P').and_then(|word| word.number())
        {
            self.dwell = Some(number.decimal);
        }
        if step.states_position {
            return self.state_position(block, context);
        }
        let info = self.info(context, letters);
        // A repeated cycle is one block while each of its holes may stay as it is, else one block a hole.
        let before = (step.motions.len() > 1).then(|| self.corrector.clone());
        let mut pieces: SmallVec<[nc_emit::Piece; 2]> = SmallVec::new();
        let mut corrections: SmallVec<[Correction; 1]> = SmallVec::new();
        let mut untouched = true;
        for motion in &step.motions {
            let corrected =
                self.corrector.correct(motion, &info).map_err(|error| refusal(&error, motion, block))?;
            untouched &= corrected.pieces.is_empty();
            corrections.push(corrected.correction);
            if step.motions.len() == 1 && !corrected.pieces.is_empty() {
                let editing = self.editing(context, letters, motion);
                let only = corrected.pieces.len() == 1;
                pieces.extend(
                    corrected.pieces.iter().enumerate().map(|(k, piece)| editing.edit(piece, k == 0, only)),
                );
            }
        }
        if let (false, Some(before)) = (untouched, before) {
            self.corrector = before;
            corrections.clear();
            self.repeated(block, context, letters, &step.motions, &mut pieces, &mut corrections)?;
        }
        let length = self.out.len();
        if untouched {
            self.pass(block, context, &step.motions)?;
        } else {
            self.emitter.rewrite(block, &pieces, &mut self.out).map_err(|diagnostic| vec![diagnostic])?;
        }
        self.note(block, context, &step.motions, &corrections, pieces.len().max(1), self.out.len() > length);
        Ok(())
    }

    /// G92 and its like: the block says where the axes stand. In the output they stand at the corrected
    /// place, so it must say that, or the correction would move into the frame.
    fn state_position(&mut self, block: &Block<'_>, context: &Context) -> Result<(), Vec<Diagnostic>> {
        let nominal = self.interpreter.modal().axes.linear;
        let standing = self.corrector.standing_mm();
        let inch = context.unit_mm != 1.0;
        let decimals = self.info(context, correction::Letters::default()).decimals;
        let mut words = Vec::new();
        for (i, letter) in b"XYZ".iter().enumerate() {
            let (Some(word), Some(nominal), Some(standing)) =
                (block.word(*letter), nominal[i].known(), standing[i])
            else {
                continue;
            };
            let Some(number) = word.number() else { continue };
            let away = (standing - nominal) / context.unit_mm;
            if away.abs() < 1e-7 {
                continue;
            }
            let value = self.job.dialect.numbers.length(number, inch).to_f64() + away;
            // Both are decimal numbers: the sum is one, with as many decimals as the longer.
            let exact = (decimals[i]..=7).find_map(|decimals| {
                let counts = (value * f64::from(10u32.pow(u32::from(decimals)))).round();
                let near = (counts / f64::from(10u32.pow(u32::from(decimals))) - value).abs() < 1e-8;
                near.then_some((counts as i64, decimals))
            });
            let Some((counts, decimals)) = exact else {
                return Err(vec![
                    Diagnostic::error(
                        nc_program::codes::FRAME,
                        format!("{} cannot say where the corrected axis stands", *letter as char),
                    )
                    .at(block.file_span(word.span), "the place is no whole number of output steps")
                    .help("write the shift as a work offset (G54 to G59), or approach it with G0 in millimetres"),
                ]);
            };
            words.push((*letter, nc_emit::WordEdit::Write { counts, decimals }));
        }
        if words.is_empty() {
            self.emitter.pass(block, &mut self.out);
        } else {
            let piece = nc_emit::Piece { motion: None, words };
            self.emitter.rewrite(block, &[piece], &mut self.out).map_err(|diagnostic| vec![diagnostic])?;
        }
        self.figures.blocks_out += 1;
        Ok(())
    }

    /// A block that stays as it is; its motion code must still be in force in the output.
    fn pass(
        &mut self,
        block: &Block<'_>,
        context: &Context,
        motions: &[Motion],
    ) -> Result<(), Vec<Diagnostic>> {
        let relies = motions.iter().any(|motion| !matches!(motion, Motion::Uncorrected { .. }));
        if relies && context.motion_code.is_some() && self.emitter.motion() != context.motion_code {
            let piece = nc_emit::Piece { motion: context.motion_code, words: Vec::new() };
            return self
                .emitter
                .rewrite(block, &[piece], &mut self.out)
                .map_err(|diagnostic| vec![diagnostic]);
        }
        self.emitter.pass(block, &mut self.out);
        Ok(())
    }

    /// The holes of a repeated cycle, a block each.
    fn repeated(
        &mut self,
        block: &Block<'_>,
        context: &Context,
        letters: correction::Letters,
        motions: &[Motion],
        pieces: &mut SmallVec<[nc_emit::Piece; 2]>,
        corrections: &mut SmallVec<[Correction; 1]>,
    ) -> Result<(), Vec<Diagnostic>> {
        let repeats = [b'L', b'K'].into_iter().filter(|letter| letters.contains(*letter));
        let repeats: SmallVec<[(u8, nc_emit::WordEdit); 2]> =
            repeats.map(|letter| (letter, nc_emit::WordEdit::Remove)).collect();
        for (k, motion) in motions.iter().enumerate() {
            // From the second hole on there is no block with words to keep.
            let letters = if k == 0 { letters } else { correction::Letters::default() };
            let info = self.info(context, letters);
            let corrected =
                self.corrector.correct(motion, &info).map_err(|error| refusal(&error, motion, block))?;
            corrections.push(corrected.correction);
            let editing = self.editing(context, letters, motion);
            if corrected.pieces.is_empty() {
                pieces.push(nc_emit::Piece { motion: context.motion_code, words: Vec::new() });
            }
            pieces.extend(
                corrected
                    .pieces
                    .iter()
                    .enumerate()
                    .map(|(i, piece)| editing.edit(piece, k == 0 && i == 0, false)),
            );
            if k == 0
                && let Some(first) = pieces.first_mut()
            {
                for repeat in &repeats {
                    if !first.words.iter().any(|(letter, _)| *letter == repeat.0) {
                        first.words.push(*repeat);
                    }
                }
            }
        }
        Ok(())
    }

    fn info(&self, context: &Context, letters: correction::Letters) -> correction::Block {
        let output = &self.job.dialect.output;
        let inch = context.unit_mm != 1.0;
        correction::Block {
            frame: context.frame,
            unit_mm: context.unit_mm,
            decimals: if inch { [output.decimals_inch; 3] } else { self.job.decimals_mm },
            incremental: context.incremental,
            arc_centres_absolute: context.arc_centres_absolute,
            letters,
            tool_mm: context.tool_mm,
            centre_words: output.centre_words,
            arc_radius_tolerance_mm: output.arc_radius_tolerance_mm,
            peck_clearance_mm: output.peck_clearance_mm,
            chip_retreat_mm: output.chip_retreat_mm,
        }
    }

    fn editing<'e>(
        &'e self,
        context: &'e Context,
        letters: correction::Letters,
        motion: &Motion,
    ) -> Editing<'e> {
        Editing {
            codes: &self.codes,
            context,
            letters,
            original: Original::of(motion),
            decimals: self.info(context, letters).decimals,
            inverse_time: match motion {
                Motion::Feed(Feed { rate: FeedRate::InverseTime(f), .. }) => Some(*f),
                _ => None,
            },
            decimals_feed: self.job.dialect.output.decimals_feed,
            dwell: self.dwell,
        }
    }

    fn note(
        &mut self,
        block: &Block<'_>,
        context: &Context,
        motions: &[Motion],
        corrections: &[Correction],
        blocks_out: usize,
        written: bool,
    ) {
        let figures = &mut self.figures;
        figures.blocks_out += if written { blocks_out as u64 } else { 0 };
        figures.splits += u64::from(blocks_out > 1);
        let raise = |figure: &mut (f64, u64), value: f64| {
            if value > figure.0 {
                *figure = (value, block.line);
            }
        };
        let span = block.offset..block.offset + block.bytes.trim_ascii_end().len() as u64;
        for (motion, correction) in motions.iter().zip(corrections) {
            raise(&mut figures.largest, correction.largest_mm);
            raise(&mut figures.before, correction.before_mm);
            raise(&mut figures.after, correction.after_mm);
            figures.approaches += u64::from(correction.approach);
            if correction.clamped {
                self.notices.clamped.see(span.clone(), 0.0);
            }
            if let Some(lean) = correction.leaning_mm {
                self.notices.leaning.see(span.clone(), lean);
            }
            if context.compensation && matches!(motion, Motion::Feed(_)) {
                self.notices.compensated.see(span.clone(), 0.0);
            }
        }
    }
}

/// Things that happen more than once and are told once.
#[derive(Debug, Default)]
struct Notices {
    clamped: Notice,
    leaning: Notice,
    compensated: Notice,
}

#[derive(Debug, Default)]
struct Notice {
    count: u64,
    first: Option<std::ops::Range<u64>>,
    largest_mm: f64,
}

impl Notice {
    fn see(&mut self, span: std::ops::Range<u64>, size_mm: f64) {
        self.count += 1;
        self.first.get_or_insert(span);
        self.largest_mm = self.largest_mm.max(size_mm);
    }
}

impl Notices {
    fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut all = Vec::new();
        if let Notice { count, first: Some(first), .. } = &self.clamped {
            all.push(
                Diagnostic::warning(
                    RAPID_OUTSIDE,
                    format!("{count} rapid motion(s) end outside the calibrated volume"),
                )
                .at(first.clone(), "the first; it takes the correction of the volume's nearest point")
                .help("nothing is cut there; calibrate a larger volume if the place matters"),
            );
        }
        if let Notice { count, first: Some(first), largest_mm } = &self.leaning {
            all.push(
                Diagnostic::warning(
                    LEANING_CYCLE,
                    format!("{count} hole(s) are off by up to {:.1} um along their depth", largest_mm * 1e3),
                )
                .at(first.clone(), "this cycle is bound to the spindle and cannot be written as moves; its middle was put in place")
                .help("the machine's drilling axis leans; thread by milling where that matters"),
            );
        }
        if let Notice { count, first: Some(first), .. } = &self.compensated {
            all.push(
                Diagnostic::warning(COMPENSATED, format!("{count} motion(s) under cutter compensation"))
                    .at(first.clone(), "the programmed contour was corrected, not the path of the tool's centre")
                    .help("between the two lies the tool radius times the error's change per mm (1 um per mm of radius at 1 mrad); post with compensation computed in CAM where that matters"),
            );
        }
        all
    }
}

/// What to say of a motion that cannot be corrected.
fn refusal(error: &CorrectionError, motion: &Motion, block: &Block<'_>) -> Vec<Diagnostic> {
    let whole = block.offset..block.offset + block.bytes.trim_ascii_end().len() as u64;
    let word = |letter: u8| block.word(letter).map(|word| block.file_span(word.span));
    let diagnostic = match error {
        CorrectionError::Solve(SolveError::OutsideVolume { axis, value_mm, low_mm, high_mm }) => {
            let span = word(*axis as u8).unwrap_or(whole);
            let what = if matches!(motion, Motion::Hole(_)) { "this hole" } else { "this feed motion" };
            Diagnostic::error(OUTSIDE, format!("{what} leaves the calibrated volume"))
                .at(span, format!("axis {axis} would be commanded to {value_mm:.3} mm, calibrated is {low_mm} to {high_mm} mm"))
                .help(format!(
                    "place the workpiece inside the volume: `--work-offset` with {axis} moved by {:+.3} mm or further, or accept the nearest point's correction with `--outside clamp`",
                    if value_mm < low_mm { low_mm - value_mm } else { high_mm - value_mm }
                ))
        }
        CorrectionError::Solve(error @ SolveError::NotConverged { .. }) => {
            Diagnostic::error(NOT_CONVERGED, error.to_string())
                .at(whole, "here")
                .help("an error table with steps this steep is no machine: run `vpost profile check`")
        }
        CorrectionError::Solve(error) => Diagnostic::error(NOT_CONVERGED, error.to_string())
            .at(whole, "here")
            .help("choose another engine with `--engine`"),
        CorrectionError::MustNotSplit { .. } => Diagnostic::error(MUST_NOT_SPLIT, error.to_string())
            .at(whole, "this block cannot be split: cutter compensation or a thread is active")
            .help("post with compensation computed in CAM, or accept more with `--tolerance`"),
        CorrectionError::NotWithinTolerance { .. } => Diagnostic::error(NOT_WITHIN_TOLERANCE, error.to_string())
            .at(whole, "this motion")
            .help("the engine's model jumps here (interval methods do at their nodes) or the profile's minimum_segment_mm is too long: use `--engine rigid-body` or `tracker`, or raise `--tolerance`"),
    };
    vec![diagnostic]
}

/// `vpost IN.nc -m PROFILE`
pub(crate) fn run(
    arguments: &arguments::Correct,
    shared: &Shared,
    messages: &Messages,
) -> Result<(), Failure> {
    let input = arguments.input.as_deref().unwrap_or(Path::new("-"));
    let settings = Settings::load(shared, messages)?;
    let text = file::read_program(input)?;
    let interrupt = Interrupt::listen();
    let name = file::name(input);
    let mut reported = None;
    let expand::Done { corrected, warnings, .. } =
        expand::correct(&text, &name, &settings, arguments.force, |done| {
            interrupt.check()?;
            let percent = (done * 100.0) as u64;
            if arguments.progress.is_some() && reported != Some(percent) {
                messages.note(&format!("FILTER_PROGRESS={percent}"));
                reported = Some(percent);
            }
            Ok(())
        })?;
    interrupt.check()?;
    if arguments.progress.is_some() && reported != Some(100) {
        messages.note("FILTER_PROGRESS=100");
    }
    match &arguments.output {
        Some(path) => file::write(path, &corrected.text)?,
        None => file::print(&corrected.text)?,
    }
    if let Some(path) = &arguments.summary {
        let summary = Summary::new(&name, &text, &settings, &corrected);
        file::write(path, &summary.json())?;
    }
    for report in &warnings {
        messages.report(report);
    }
    if shared.verbose > 0 {
        messages.note(&Summary::line(&corrected.figures));
    }
    Ok(())
}
