//! One block after the other: what is done with each.

use correction::Correction;
use diagnostic::{Diagnostic, both};
use machine_model::Placement;
use nc_emit::WordEdits;
use nc_program::{Context, CurvePart, Questions};
use nc_syntax::{Block, Letters, Reader};
use path_comparison::Way;
use smallvec::SmallVec;
use toolpath::{Hole, Motion};

use crate::control::{Apart, radii_apart, radii_apart_by_words};
use crate::cutter;
use crate::datum::{LastDatum, going_on};
use crate::feed;
use crate::figures::raise;
use crate::job::Job;
use crate::lag::Turns;
use crate::nose::{nose_mm, reserved_mm};
use crate::notices::{SPIRAL_MM, hole_skipped, refusal};
use crate::state::State;
use crate::tally::Tally;
use crate::words::{
    Editing, MotionCodes, Original, Pieces, Stands, finer_than_words, letters, lost, retreats, stated,
};

/// A pass over blocks.
pub(crate) struct Pass<'a> {
    pub(crate) job: &'a Job<'a>,
    pub(crate) codes: MotionCodes,
    pub(crate) questions: Questions<'a>,
    pub(crate) state: State<'a>,
    pub(crate) out: Vec<u8>,
    pub(crate) tally: Tally,
    pub(crate) datum: LastDatum,
    /// In front of blocks before this offset nobody asks whether the pass ends: set by who does.
    pub(crate) next_stop: u64,
}

impl<'a> Pass<'a> {
    /// Goes on from `state`.
    pub(crate) fn new(job: &'a Job<'a>, state: State<'a>, bytes: usize) -> Self {
        Self {
            job,
            codes: MotionCodes::of(job.dialect),
            questions: Questions::new(job.dialect, job.setup),
            state,
            out: Vec::with_capacity(bytes + bytes / 8 + 64),
            tally: Tally::default(),
            datum: LastDatum::default(),
            next_stop: 0,
        }
    }
}

impl Pass<'_> {
    /// Corrects blocks to the end of what a reader reads, or until `ends` says so in front of one; true where it did.
    ///
    /// * `ends` – is asked with the offset of each block, from [`Pass::next_stop`] on
    /// * `read` – is shown each block that is no plain line before it is corrected
    pub(crate) fn run<E: From<Vec<Diagnostic>>>(
        &mut self,
        reader: &mut Reader<'_>,
        mut ends: impl FnMut(&mut Self, u64) -> Result<bool, E>,
        mut read: impl FnMut(&Block<'_>) -> Result<(), E>,
    ) -> Result<bool, E> {
        let mut block = Block::default();
        loop {
            if self.plain_lines(reader, &mut ends)? {
                return Ok(true);
            }
            let name = reader.expects_name();
            if !reader.next(&mut block) {
                self.state.expects_name = reader.expects_name();
                return Ok(false);
            }
            self.state.expects_name = name;
            if block.offset >= self.next_stop && ends(self, block.offset)? {
                return Ok(true);
            }
            read(&block)?;
            self.block(&block)?;
        }
    }

    /// Corrects a block, whatever it is.
    pub(crate) fn block(&mut self, block: &Block<'_>) -> Result<(), Vec<Diagnostic>> {
        self.tally.figures.blocks_in += 1;
        let before = self.before_guards();
        let compensation = self.state.interpreter.modal().compensation;
        let executed = self.state.interpreter.step(block);
        // Looked at where it lies: hundreds of bytes.
        let Ok(step) = &executed else { return executed.map(|_| ()) };
        self.tally.evidence.see(block, &self.questions);
        self.state.emitter.meet(block);
        let context = &step.context;
        if let Some(before) = before.as_ref().filter(|_| !step.motions.is_empty()) {
            self.guard_before(block, before)?;
        }
        self.keep_to_path(block, &step.motions, compensation)?;
        if step.states_position {
            self.state_position(block, context)?;
        } else {
            self.moved(block, context, letters(block, context), &step.motions)?;
        }
        before.map_or(Ok(()), |before| self.guard_behind(block, &before))
    }

    /// Corrects the motions of a block and writes it.
    pub(crate) fn moved(
        &mut self,
        block: &Block<'_>,
        context: &Context,
        letters: Letters,
        motions: &[Motion],
    ) -> Result<(), Vec<Diagnostic>> {
        match context.curve {
            Some(CurvePart::Said) => return self.curve_said(block, context, letters),
            Some(CurvePart::Cut) => return self.curve_cut(block, context, letters, motions),
            None => {}
        }
        let mut info = self.info(context, letters);
        info.reframed = context.unnamed.map(|lost| lost.is_some_and(|lost| lost.line == block.line));
        if let [Motion::Feed(feed)] = motions {
            finer_than_words(&mut info, feed);
            info.least_share = feed::least_share(self.job.dialect, feed, info.least_share);
        }
        // A repeated cycle is one block while each of its holes may stay as it is, else one block a hole.
        let before = (motions.len() > 1).then(|| self.state.corrector.clone());
        let mut pieces = Pieces::new();
        let mut corrections: SmallVec<[Correction; 1]> = SmallVec::new();
        let (mut untouched, mut by_time) = (true, None);
        let start_mm = self.state.corrector.standing_mm();
        let mut apart = Apart::default();
        for motion in motions {
            let last = &mut self.state.datum;
            let motion = &going_on(&self.job.models, motion, context, info.datum, last);
            let mut at_deg = self.rotary_start_deg(motion);
            let modal = self.state.interpreter.modal();
            info.reserved_mm = reserved_mm(self.job, modal, motion, block, context)?;
            let beside = cutter::beside(self.job, modal, motion, context);
            info.reserved_mm += beside.map_or(0.0, |beside| beside.reserved_mm);
            let mut corrected = self
                .state
                .corrector
                .correct(motion, &info)
                .map_err(|error| refusal(&error, motion, block, context))?;
            corrected.correction.after_mm += info.reserved_mm;
            untouched &= corrected.pieces.is_empty();
            apart = apart.max(radii_apart_by_words(&corrected.pieces, start_mm, &info, motion));
            let modal = self.state.interpreter.modal();
            by_time = feed::require_same(self.job.dialect, modal, &corrected, motion, block, context)?;
            corrections.push(corrected.correction);
            if motions.len() == 1 && !corrected.pieces.is_empty() {
                let mut editing = self.editing(context, letters, motion);
                editing.rotary_decimals = info.rotary_decimals;
                editing.by_time = by_time.map(|by_time| by_time.per_minute);
                let chain = &self.job.setup.rotary_chain;
                pieces = editing.edit_only(&corrected.pieces, motion, &info, chain, &mut at_deg);
            }
        }
        if let (false, Some(before)) = (untouched, before) {
            self.state.corrector = before;
            corrections.clear();
            self.repeated(block, context, letters, motions, &mut pieces, &mut corrections)?;
        }
        if context.may_not_set_levels
            && let Some(Motion::Hole(hole)) = motions.first()
            && holds_levels(&pieces, hole)
        {
            return Err(vec![hole_skipped(block)]);
        }
        let length = self.out.len();
        let beside = by_time.map(|by_time| by_time.lines());
        beside.iter().for_each(|[before, _]| self.insert(before, block));
        if untouched {
            self.pass(block, context, motions)?;
        } else {
            self.state
                .emitter
                .rewrite(block, &pieces, &mut self.out)
                .map_err(|diagnostic| vec![diagnostic])?;
        }
        beside.iter().for_each(|[_, behind]| self.insert(behind, block));
        self.note(block, context, motions, &corrections, pieces.len().max(1), self.out.len() > length);
        self.arc_cut(block, motions, apart);
        Ok(())
    }

    /// An arc that is one in the output too is the control's to follow.
    fn arc_cut(&mut self, block: &Block<'_>, motions: &[Motion], apart: Apart) {
        if let ([Motion::Feed(feed)], Some(code)) = (motions, self.state.emitter.motion())
            && self.codes.is_arc(code)
        {
            let place = (&block.file_range(), block.line);
            let modal = self.state.interpreter.modal();
            self.tally.figures.control.arc(self.job, modal, (feed, apart), place);
        }
    }

    /// G92 and its like: the block says where the axes stand. In the output they stand at the corrected
    /// place, so it must say that, or the correction would move into the frame.
    fn state_position(&mut self, block: &Block<'_>, context: &Context) -> Result<(), Vec<Diagnostic>> {
        let nominal = self.state.interpreter.modal().axes.linear;
        let standing = self.state.corrector.standing_mm();
        let inch = context.unit_mm != 1.0;
        let decimals = decimals(self.job, context);
        let mut words = nc_emit::WordEdits::new();
        for (i, letter) in b"XYZ".iter().enumerate() {
            let (Some(word), Some(nominal), Some(standing)) =
                (block.word(*letter), nominal[i].known(), standing[i])
            else {
                continue;
            };
            let Some(number) = word.number() else { continue };
            let away = (standing - nominal) / context.word_mm(i);
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
                        both!("{} cannot say where the corrected axis stands", "{} не может сказать, где стоит исправленная ось", *letter as char),
                    )
                    .at(block.file_span(word.span), both!("the place is no whole number of output steps", "это место — не целое число дискрет вывода"))
                    .help(both!("write the shift as a work offset (G54 to G59), or approach it with G0 in millimetres", "задайте сдвиг смещением нуля (G54–G59) или подойдите к нему ходом G0 в миллиметрах")),
                ]);
            };
            words.push((*letter, nc_emit::WordEdit::Write { counts, decimals }));
        }
        if words.is_empty() {
            self.state.emitter.pass(block, &mut self.out);
        } else {
            let piece = nc_emit::Piece { motion: None, words };
            self.state
                .emitter
                .rewrite(block, &[piece], &mut self.out)
                .map_err(|diagnostic| vec![diagnostic])?;
        }
        self.tally.figures.blocks_out += 1;
        Ok(())
    }

    /// A block that stays as it is; its motion code must still be in force in the output.
    pub(crate) fn pass(
        &mut self,
        block: &Block<'_>,
        context: &Context,
        motions: &[Motion],
    ) -> Result<(), Vec<Diagnostic>> {
        let relies = motions.iter().any(|motion| !matches!(motion, Motion::Uncorrected { .. }));
        if relies && context.motion_code.is_some() && self.state.emitter.motion() != context.motion_code {
            let letters = letters(block, context);
            let words = motions.iter().take(1).flat_map(|motion| self.lost(context, letters, motion));
            let piece = nc_emit::Piece { motion: context.motion_code, words: words.collect() };
            return self
                .state
                .emitter
                .rewrite(block, &[piece], &mut self.out)
                .map_err(|diagnostic| vec![diagnostic]);
        }
        self.state.emitter.pass(block, &mut self.out);
        Ok(())
    }

    /// The holes of a repeated cycle, a block each.
    fn repeated(
        &mut self,
        block: &Block<'_>,
        context: &Context,
        letters: Letters,
        motions: &[Motion],
        pieces: &mut Pieces,
        corrections: &mut SmallVec<[Correction; 1]>,
    ) -> Result<(), Vec<Diagnostic>> {
        let repeats = [b'L', b'K'].into_iter().filter(|letter| letters.contains(*letter));
        let repeats: SmallVec<[(u8, nc_emit::WordEdit); 2]> =
            repeats.map(|letter| (letter, nc_emit::WordEdit::Remove)).collect();
        let mut named = self.info(context, letters).named;
        for (k, motion) in motions.iter().enumerate() {
            // From the second hole on there is no block with words to keep.
            let letters = if k == 0 { letters } else { Letters::default() };
            let info = correction::Block { named, ..self.info(context, letters) };
            let corrected = self
                .state
                .corrector
                .correct(motion, &info)
                .map_err(|error| refusal(&error, motion, block, context))?;
            // The block has said where the holes that follow are, in the plane.
            for axis in &context.plane.axes()[..2] {
                named[*axis] |= info.stated.axes[*axis];
            }
            corrections.push(corrected.correction);
            let mut editing = self.editing(context, letters, motion);
            editing.rotary_decimals = info.rotary_decimals;
            if corrected.pieces.is_empty() {
                pieces.push(nc_emit::Piece { motion: context.motion_code, words: nc_emit::WordEdits::new() });
            }
            pieces.extend(
                corrected.pieces.iter().enumerate().map(|(i, piece)| editing.edit(piece, Stands::at(k + i))),
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

    /// Where the rotary axes stand in the output before a motion, degrees.
    fn rotary_start_deg(&self, motion: &Motion) -> [f64; 3] {
        let aside_deg = self.state.corrector.aside_deg();
        let program_deg = match motion {
            Motion::Feed(feed) => feed.start.rotary_deg,
            Motion::Rapid { start, .. } => start.rotary_deg,
            Motion::Hole(hole) => hole.start.rotary_deg,
            Motion::Uncorrected { end, .. } => end.rotary_deg,
        };
        [0, 1, 2].map(|axis| program_deg[axis] + aside_deg[axis])
    }

    pub(crate) fn info(&mut self, context: &Context, letters: Letters) -> correction::Block {
        info(self.job, context, letters, self.datum.placement(self.job.datums, self.job.machine(), context))
    }

    pub(crate) fn editing<'e>(
        &'e self,
        context: &'e Context,
        letters: Letters,
        motion: &Motion,
    ) -> Editing<'e> {
        Editing {
            codes: &self.codes,
            context,
            letters,
            original: Original::of(motion),
            decimals: decimals(self.job, context),
            lost: self.lost(context, letters, motion),
            rotary_decimals: [0; 3],
            direction: None,
            inverse_time: motion.inverse_time(),
            by_time: None,
            decimals_feed: self.job.dialect.output.decimals_feed,
            dwell: match motion {
                Motion::Hole(hole) => hole.cycle.dwell,
                _ => None,
            },
        }
    }

    fn lost(&self, context: &Context, letters: Letters, motion: &Motion) -> WordEdits {
        lost(self.job.dialect, self.state.emitter.motion(), motion, (context, letters))
    }

    pub(crate) fn note(
        &mut self,
        block: &Block<'_>,
        context: &Context,
        motions: &[Motion],
        corrections: &[Correction],
        blocks_out: usize,
        written: bool,
    ) {
        let figures = &mut self.tally.figures;
        figures.blocks_out += if written { blocks_out as u64 } else { 0 };
        figures.splits += u64::from(blocks_out > 1);
        let line = block.line;
        let span = block.file_range();
        let cuts = motions.iter().any(|motion| matches!(motion, Motion::Feed(_) | Motion::Hole(_)));
        if let Some(datum) = cuts.then(|| self.datum.newly_used()).flatten() {
            self.tally.cut_from(datum, self.job.options.tolerance_mm, (&span, line));
        }
        if cuts {
            self.tally.lengthless.cut(self.job, self.state.interpreter.modal(), &span, line);
        }
        for motion in motions {
            let Motion::Feed(feed) = motion else { continue };
            let (control, modal) = (&mut self.tally.figures.control, self.state.interpreter.modal());
            control.cut(self.job, modal, || (span.clone(), line));
            control.lag(self.job, modal, Turns::of(feed), [modal.last_feed], || (span.clone(), line));
            control.stop(self.job, modal, blocks_out, || Way::of(feed).length_mm());
        }
        let Tally { figures, notices, .. } = &mut self.tally;
        for (motion, correction) in motions.iter().zip(corrections) {
            figures.raise(correction, line);
            if let Some(directed) = &correction.directed {
                raise(&mut figures.tilt_before, (directed.before_rad, line));
                if directed.held {
                    figures.held.see(line, directed.after_rad);
                    notices.held.see(&span, line, 0.0);
                } else {
                    raise(&mut figures.tilt, (directed.after_rad, line));
                }
            }
            figures.approaches += u64::from(correction.approach);
            if correction.clamped {
                notices.clamped.see(&span, line, 0.0);
            }
            let unsure_mm = correction.unknown_side_mm;
            if correction.accepted {
                notices.accepted.see(&span, line, correction.after_mm);
            }
            if correction.accepted || correction.leaning_mm.is_some() || unsure_mm > 0.0 {
                figures.accepted.push((line, correction.after_mm + unsure_mm));
            }
            if let Some(lean) = correction.leaning_mm {
                notices.leaning.see(&span, line, lean);
            }
            if unsure_mm > 0.0 {
                notices.unknown_side.see(&span, line, correction.after_mm + unsure_mm);
            }
            if let Some(apart_mm) =
                radii_apart(motion).map(Apart::mm).filter(|apart_mm| *apart_mm > SPIRAL_MM)
            {
                notices.spirals.see(&span, line, apart_mm);
            }
            let modal = self.state.interpreter.modal();
            match cutter::beside(self.job, modal, motion, context) {
                Some(beside) if beside.said_mm > 0.0 => notices.beside.see(&span, line, beside.said_mm),
                None if context.compensation.is_some()
                    && matches!(motion, Motion::Feed(_))
                    && nose_mm(self.job, modal).is_none() =>
                {
                    notices.compensated.see(&span, line, 0.0);
                }
                _ => {}
            }
        }
    }
}

/// Decimals of X, Y, Z in the units in force.
fn decimals(job: &Job<'_>, context: &Context) -> [u8; 3] {
    let inch = context.unit_mm != 1.0;
    if inch { [job.dialect.output.decimals_inch; 3] } else { job.decimals_mm }
}

/// Decimals of a degree to which a direction is corrected that is written as a vector.
const OF_A_VECTOR: u8 = 6;

/// What correction must know of a block.
pub(crate) fn info(
    job: &Job<'_>,
    context: &Context,
    letters: Letters,
    datum: Placement,
) -> correction::Block {
    let output = &job.dialect.output;
    let by_vector = context.direction.is_some();
    let mut stated = stated(letters);
    if by_vector {
        stated.rotary = job.setup.has_rotary;
    }
    correction::Block {
        frame: context.frame.clone(),
        kinematics: context.kinematics,
        unit_mm: context.unit_mm,
        diameters: context.diameters,
        decimals: decimals(job, context),
        rotary_decimals: job.rotary_steps.map(|(decimals, _)| if by_vector { OF_A_VECTOR } else { decimals }),
        rotary_step: job.rotary_steps.map(|(_, steps)| if by_vector { 1 } else { i64::from(steps) }),
        incremental: context.incremental,
        arc_centres_absolute: context.arc_centres_absolute,
        stated,
        whole: context.whole,
        named: context.unnamed.map(|lost| lost.is_none()),
        reframed: [false; 3],
        tool_mm: context.tool_mm,
        datum,
        offset: context.offset,
        centre_words: output.centre_words,
        arcs_become_lines: !output.centre_words && !output.radius_word,
        arc_radius_tolerance_mm: output.arc_tolerance_mm(context.unit_mm),
        retreats: retreats(job.dialect),
        ..correction::Block::default()
    }
}

/// The pieces of a hole say more than its place: levels that the next holes inherit, or moves instead of the cycle.
fn holds_levels(pieces: &[nc_emit::Piece], hole: &Hole) -> bool {
    let normal = b"XYZ"[hole.plane.axes()[2]];
    let level = |(letter, edit): &(u8, nc_emit::WordEdit)| {
        (*letter == normal || *letter == b'R') && matches!(edit, nc_emit::WordEdit::Write { .. })
    };
    pieces.len() > 1 || pieces.iter().any(|piece| piece.words.iter().any(level))
}
