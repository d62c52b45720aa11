//! The lines that programs consist of by millions, several at a time.
//!
//! What is written is what [`Pass::block`] would write. Lines are corrected side by side, since one alone would mostly
//! wait for itself, as many as are proven that way; the next one goes the long way.

use correction::{Run, ShortLines, ShortRun};
use diagnostic::Diagnostic;
use machine_model::LANES;
use nc_program::{LastFeed, PlainEnd};
use nc_syntax::{Block, Letters, PlainLine, Reader};
use toolpath::Motion;

use crate::control::distance_mm;
use crate::lag::Turns;
use crate::pass::{Pass, info};
use crate::words::letters;

impl Pass<'_> {
    /// Corrects the plain lines that come next; `ends` as in [`Pass::run`].
    pub(crate) fn plain_lines<E: From<Vec<Diagnostic>>>(
        &mut self,
        reader: &mut Reader<'_>,
        ends: &mut impl FnMut(&mut Self, u64) -> Result<bool, E>,
    ) -> Result<bool, E> {
        if self.lacks_guard() || self.strays() {
            return Ok(false);
        }
        let Some((feeds, mut start_mm)) = self.state.interpreter.plain_feeds() else { return Ok(false) };
        let datum = self.datum.placement(self.job.datums, self.job.machine(), &feeds.context);
        let letters = Letters::default();
        let (info, rotary_deg) = (info(self.job, &feeds.context, letters, datum), feeds.rotary_deg);
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
            self.state.expects_name = false;
            if lines[count - 1].offset >= self.next_stop {
                if lines[0].offset >= self.next_stop && ends(self, lines[0].offset)? {
                    return Ok(true);
                }
                // The others have their turn once the first is done.
                let before = 1 + lines[1..count].iter().filter(|line| line.offset < self.next_stop).count();
                if before < count {
                    reader.unread(&lines[before]);
                    count = before;
                }
            }
            for (k, end_mm) in ends_mm.iter_mut().enumerate() {
                *end_mm = found[k.min(count - 1)].end_mm;
            }
            let corrector = &mut self.state.corrector;
            short = short.or_else(|| corrector.short_lines(&info, rotary_deg));
            let run = Run { start_mm, ends_mm: &ends_mm, names: found.map(|end| end.names), count };
            let in_force = self.state.emitter.motion() == motion_code;
            let short = short.as_ref().filter(|_| in_force);
            let run = short.and_then(|short| corrector.short_run(short, &info, &run));
            let done = run.as_ref().map_or(0, |run| run.count);
            // Nearly always false from the second turn on.
            let seen = self.tally.evidence.wants_lines(&self.questions)
                || (self.questions.lengths_open() && found[..count].iter().any(|end| end.bare));
            if seen {
                let read = &lines[..count.min(done + 1)];
                read.iter().for_each(|line| self.tally.evidence.see_line(line, &self.questions));
            }
            if let Some(run) = &run {
                let feed = found[..done].iter().rev().find_map(|end| end.feed);
                let before = self.state.interpreter.modal().last_feed;
                self.state.interpreter.go_to(&found[done - 1], feed);
                start_mm = self.stops(start_mm, &ends_mm[..done]);
                self.write_run(&lines, &found, run, (info.decimals, before))?;
            }
            if done < count {
                let end_mm = found[done].end_mm;
                self.state.interpreter.go_to(&found[done], found[done].feed);
                if done + 1 < count {
                    reader.unread(&lines[done + 1]);
                }
                self.rare_line(reader, &lines[done], start_mm, end_mm)?;
                start_mm = end_mm;
            }
        }
    }

    /// Counts the stops of lines that were corrected together; the end of the last.
    #[inline]
    fn stops(&mut self, mut start_mm: [f64; 3], ends_mm: &[[f64; 3]]) -> [f64; 3] {
        for end_mm in ends_mm {
            let (control, modal) = (&mut self.tally.figures.control, self.state.interpreter.modal());
            control.stop(self.job, modal, 1, || distance_mm(&start_mm, end_mm));
            start_mm = *end_mm;
        }
        start_mm
    }

    /// Writes lines that were corrected together; `before`: the F in force in front of them.
    #[inline]
    fn write_run(
        &mut self,
        lines: &[PlainLine<'_>; LANES],
        ends: &[PlainEnd; LANES],
        run: &ShortRun,
        (decimals, before): ([u8; 3], LastFeed),
    ) -> Result<(), Vec<Diagnostic>> {
        let place = || {
            let PlainLine { offset, line, .. } = lines[0];
            (offset..offset + lines[0].content().len() as u64, line)
        };
        if let Some(datum) = self.datum.newly_used() {
            let (span, line) = place();
            self.tally.cut_from(datum, self.job.options.tolerance_mm, (&span, line));
        }
        let (control, modal) = (&mut self.tally.figures.control, self.state.interpreter.modal());
        control.cut(self.job, modal, place);
        let said = |end: &PlainEnd| match (end.feed?, modal.last_feed) {
            (feed, LastFeed::PerMinute(_, units)) => Some(LastFeed::PerMinute(feed, units)),
            (_, unknown) => Some(unknown),
        };
        let first = ends[0].feed.is_none().then_some(before);
        let feeds = ends[..run.count].iter().filter_map(said).chain(first);
        control.lag(self.job, modal, Turns::Not, feeds, place);
        for ((line, end), counts) in lines.iter().zip(ends).zip(run.counts).take(run.count) {
            if counts == [None; 3] {
                self.state.emitter.pass_line(line, &mut self.out);
            } else {
                self.state
                    .emitter
                    .rewrite_line(line, counts, end.names, decimals, &mut self.out)
                    .map_err(|diagnostic| vec![diagnostic])?;
            }
        }
        let figures = &mut self.tally.figures;
        figures.blocks_in += run.count as u64;
        figures.blocks_out += run.count as u64;
        if figures.would_rise(&run.worst) {
            for (k, line) in lines[..run.count].iter().enumerate() {
                figures.raise(&self.state.corrector.correction_of(run, k), line.line);
            }
        }
        Ok(())
    }

    /// A plain line that is not proven the short way.
    #[cold]
    fn rare_line<'t>(
        &mut self,
        reader: &Reader<'t>,
        line: &PlainLine<'t>,
        start_mm: [f64; 3],
        end_mm: [f64; 3],
    ) -> Result<(), Vec<Diagnostic>> {
        let mut block = Block::default();
        reader.block_of(line, &mut block);
        let Some((feeds, _)) = self.state.interpreter.plain_feeds() else { return self.block(&block) };
        let feed = Motion::Feed(feeds.feed(start_mm, end_mm));
        let context = feeds.context.clone();
        self.tally.figures.blocks_in += 1;
        self.moved(&block, &context, letters(&block, &context), &[feed])
    }
}
