//! The lines that programs consist of by millions, several at a time.
//!
//! What is written is what [`Pass::block`] would write. The model is asked for several ends together, since one alone
//! would mostly wait for itself; all else is done line by line.

use correction::{AxisWord, Foreseen, Letters, PieceKind, Run, ShortLines, ShortRun};
use diagnostic::Diagnostic;
use machine_model::LANES;
use nc_program::PlainEnd;
use nc_syntax::{Block, PlainLine, Reader};
use toolpath::Motion;

use crate::pass::{Pass, info};
use crate::words::letters;

/// A plain line, with what is known of it before its turn.
struct Ahead<'l, 't> {
    line: &'l PlainLine<'t>,
    start_mm: [f64; 3],
    end: PlainEnd,
    /// The model's answers, and which of them is for this line.
    foreseen: Option<(&'l Foreseen, usize)>,
}

impl Pass<'_> {
    /// Corrects the plain lines that come next; `ends` as in [`Pass::run`].
    pub(crate) fn plain_lines<E: From<Vec<Diagnostic>>>(
        &mut self,
        reader: &mut Reader<'_>,
        ends: &mut impl FnMut(&mut Self, u64) -> Result<bool, E>,
    ) -> Result<bool, E> {
        if self.lacks_guard() {
            return Ok(false);
        }
        let Some((feeds, mut start_mm)) = self.state.interpreter.plain_feeds() else { return Ok(false) };
        let (mut info, rotary_deg) = (info(self.job, &feeds.context, Letters::default()), feeds.rotary_deg);
        // The lines rely on the code before them, which must be in force in the output too.
        let motion_code = feeds.context.motion_code;
        let mut short: Option<ShortLines> = None;
        let mut lines: [PlainLine<'_>; LANES] = Default::default();
        let mut found = [PlainEnd::default(); LANES];
        let mut ends_mm = [[0.0; 3]; LANES];
        loop {
            let Some((feeds, _)) = self.state.interpreter.plain_feeds() else { return Ok(false) };
            let (mut count, mut last_mm) = (0, start_mm);
            while count < LANES && reader.plain_line(&mut lines[count]) {
                let Some(end) = feeds.end_of(&lines[count], last_mm) else {
                    reader.unread(&lines[count]);
                    break;
                };
                last_mm = end.end_mm;
                found[count] = end;
                count += 1;
            }
            if count == 0 {
                return Ok(false);
            }
            for (k, end_mm) in ends_mm.iter_mut().enumerate() {
                *end_mm = found[k.min(count - 1)].end_mm;
            }
            self.state.expects_name = false;
            let corrector = &mut self.state.corrector;
            short = short.or_else(|| corrector.short_lines(&info, rotary_deg));
            let foreseen = short.as_ref().and_then(|short| corrector.foresee(short, start_mm, &ends_mm));
            // Nearly always false from the second turn on.
            let seen = self.tally.evidence.wants_lines(&self.questions)
                || (self.questions.lengths_open() && found[..count].iter().any(|end| end.bare));
            if count == LANES
                && lines[LANES - 1].offset < self.next_stop
                && self.state.emitter.motion() == motion_code
                && let (Some(short), Some(foreseen)) = (&short, &foreseen)
                && let run = (Run { start_mm, ends_mm: &ends_mm, names: found.map(|end| end.names) })
                && let Some(run) = self.state.corrector.short_run(short, &info, &run, foreseen)
            {
                start_mm = last_mm;
                self.state.interpreter.go_to(start_mm);
                if seen {
                    lines.iter().for_each(|line| self.tally.evidence.see_line(line, &self.questions));
                }
                self.write_run(&lines, &run, info.decimals)?;
                continue;
            }
            for (k, line) in lines[..count].iter().enumerate() {
                if line.offset >= self.next_stop && ends(self, line.offset)? {
                    return Ok(true);
                }
                if seen {
                    self.tally.evidence.see_line(line, &self.questions);
                }
                info.letters = Letters::axes(found[k].names);
                let in_force = self.state.emitter.motion() == motion_code;
                let short = short.as_ref().filter(|_| in_force);
                let ahead = Ahead {
                    line,
                    start_mm,
                    end: found[k],
                    foreseen: foreseen.as_ref().map(|foreseen| (foreseen, k)),
                };
                self.plain_line(reader, &info, short, &ahead)?;
                start_mm = found[k].end_mm;
            }
        }
    }

    /// Writes lines that were corrected together.
    #[inline]
    fn write_run(
        &mut self,
        lines: &[PlainLine<'_>; LANES],
        run: &ShortRun,
        decimals: [u8; 3],
    ) -> Result<(), Vec<Diagnostic>> {
        for (line, counts) in lines.iter().zip(run.counts) {
            if counts == [None; 3] {
                self.state.emitter.pass_line(line, &mut self.out);
            } else {
                self.state
                    .emitter
                    .rewrite_line(line, counts, decimals, &mut self.out)
                    .map_err(|diagnostic| vec![diagnostic])?;
            }
        }
        let figures = &mut self.tally.figures;
        figures.blocks_in += LANES as u64;
        figures.blocks_out += LANES as u64;
        if figures.would_rise(&run.worst) {
            for (k, line) in lines.iter().enumerate() {
                figures.raise(&self.state.corrector.correction_of(run, k), line.line);
            }
        }
        Ok(())
    }

    /// Corrects a plain line, the short way where that is proven.
    #[inline]
    fn plain_line<'t>(
        &mut self,
        reader: &Reader<'t>,
        info: &correction::Block,
        short: Option<&ShortLines>,
        ahead: &Ahead<'_, 't>,
    ) -> Result<(), Vec<Diagnostic>> {
        let Ahead { line, start_mm, end: PlainEnd { end_mm, names, .. }, foreseen } = *ahead;
        self.state.interpreter.go_to(end_mm);
        let corrector = &mut self.state.corrector;
        let corrected = short.and_then(|short| corrector.short_line(short, info, start_mm, end_mm, foreseen));
        let inserts = |axes: &[AxisWord; 3]| {
            axes.iter().zip(names).any(|(word, named)| !named && *word != AxisWord::Omit)
        };
        let Some(corrected) = corrected.filter(|corrected| !inserts(&corrected.axes)) else {
            return self.rare_line(reader, ahead, corrected.as_ref());
        };
        if corrected.is_untouched() {
            self.state.emitter.pass_line(line, &mut self.out);
        } else {
            let mut counts = [None; 3];
            for (counts, word) in counts.iter_mut().zip(corrected.axes) {
                if let AxisWord::Write(steps) = word {
                    *counts = Some(steps);
                }
            }
            self.state
                .emitter
                .rewrite_line(line, counts, info.decimals, &mut self.out)
                .map_err(|diagnostic| vec![diagnostic])?;
        }
        self.count(line, &corrected.correction);
        Ok(())
    }

    /// A plain line that takes more than new numbers: it is not proven the short way, or gets a word for an axis that it
    /// does not name.
    #[cold]
    fn rare_line<'t>(
        &mut self,
        reader: &Reader<'t>,
        ahead: &Ahead<'_, 't>,
        corrected: Option<&correction::ShortLine>,
    ) -> Result<(), Vec<Diagnostic>> {
        let mut block = Block::default();
        reader.block_of(ahead.line, &mut block);
        let Some((feeds, _)) = self.state.interpreter.plain_feeds() else { return self.block(&block) };
        let feed = Motion::Feed(feeds.feed(ahead.start_mm, ahead.end.end_mm));
        let context = feeds.context.clone();
        let Some(corrected) = corrected else {
            self.tally.figures.blocks_in += 1;
            return self.moved(&block, &context, letters(&block, &context), &[feed]);
        };
        let piece = correction::Piece::new(PieceKind::Line, corrected.axes, 1.0);
        let edited = self.editing(&context, letters(&block, &context), &feed).edit(&piece, true, true);
        self.state
            .emitter
            .rewrite(&block, &[edited], &mut self.out)
            .map_err(|diagnostic| vec![diagnostic])?;
        self.count(ahead.line, &corrected.correction);
        Ok(())
    }

    /// Counts a line that was corrected the short way.
    #[inline]
    fn count(&mut self, line: &PlainLine<'_>, correction: &correction::Correction) {
        let figures = &mut self.tally.figures;
        figures.blocks_in += 1;
        figures.blocks_out += 1;
        figures.raise(correction, line.line);
    }
}
