//! Item by item through both programs; where they part, on from where they meet again.

use machine_model::Models;
use toolpath::PeckRetreats;

use crate::alignment::{Alignment, Begins, Entry, LEFT_OUT_LIMITS, MOST_APPROACH_MM, Processes, Reached};
use crate::difference::{self, Found};
use crate::feeding::{Feeding, Off};
use crate::items::{Counted, Item, Items, Role};
use crate::positioning::ends_alike;
use crate::process::Process;
use crate::stretch::{Place, Stretch};
use crate::timing::{Taken, Time};
use crate::way::Way;
use crate::{Comparison, Mismatch, Pointing, Step, Trace, Traces, What};

/// So many differences are kept; a program that is off in one place may be off in thousands.
const MOST_MISMATCHES: usize = 20;
/// So many items ahead are looked at for where programs meet again.
const AHEAD: usize = 24;
/// Behind so many differences that is no longer worth much.
const AHEAD_IS_FAR: usize = 200;
/// A piece that is off by no more, mm, was made for that motion all the same.
const NEARLY_MM: f64 = 1.0;
pub(crate) struct Matcher<'m, W, C> {
    alignment: Alignment<'m, W>,
    commanded: Items<'m, C>,
    traces: Traces,
    /// So many times the limits are taken.
    wider: f64,
    /// How the next run begins.
    begins: Begins,
    time: Time,
    /// So many feeds ahead is the one that was reached last.
    reached: usize,
    /// Where the programs parted first without a name for it.
    unnamed: Option<Mismatch>,
    result: Comparison,
}

/// Tip, direction and rotary axes at a place, each with its limit.
struct Apart {
    off: Off,
    limit_mm: f64,
    pointing: Pointing,
    wanted_line: u64,
}

impl<'m, W: Iterator<Item = Step>, C: Iterator<Item = Step>> Matcher<'m, W, C> {
    pub(crate) fn new(
        models: Models<'m>,
        wanted: W,
        commanded: C,
        retreats: PeckRetreats,
        traces: Traces,
        wider: f64,
    ) -> Self {
        let counted = Counted::default();
        let wanted = Items::new(models, wanted, Role::Wanted, retreats, counted.clone());
        Self {
            alignment: Alignment::new(wanted),
            commanded: Items::new(models, commanded, Role::Commanded, retreats, counted),
            traces,
            wider,
            begins: Begins::AtStart,
            time: Time::default(),
            reached: 0,
            unnamed: None,
            result: Comparison::default(),
        }
    }

    pub(crate) fn compare(mut self) -> Comparison {
        loop {
            let wanted = self.alignment.wanted.peek(0);
            let pair = match (wanted, self.commanded.peek(0)) {
                (None, None) => break,
                (Some(Item::Feed(_)), Some(Item::Feed(_))) => {
                    let begins = std::mem::replace(&mut self.begins, Begins::AtStart);
                    if self.wider > 1.0 && begins != Begins::Anywhere {
                        self.pass_approach();
                    }
                    self.follow(begins);
                    continue;
                }
                (Some(Item::Position(w)), Some(Item::Position(c))) if ends_alike(w, c) => {
                    // Nothing is done to the part by what moves nothing, in whatever process.
                    let moves = !w.is_small() && !c.is_small();
                    moves.then_some([(w.line, w.process), (c.line, c.process)])
                }
                (Some(Item::Deed(w)), Some(Item::Deed(c))) if w.number == c.number => {
                    Some([(w.line, w.process), (c.line, c.process)])
                }
                // What moves nothing may be left out, or put in.
                (Some(Item::Feed(w)), _) if w.reach_mm <= w.limit_mm => {
                    self.drop_wanted();
                    continue;
                }
                (_, Some(Item::Feed(c))) if c.reach_mm <= c.limit_mm => {
                    self.commanded.pop();
                    continue;
                }
                (Some(Item::Position(w)), _) if w.is_small() => {
                    self.drop_wanted();
                    continue;
                }
                (_, Some(Item::Position(c))) if c.is_small() => {
                    self.commanded.pop();
                    continue;
                }
                _ => {
                    self.part(0);
                    continue;
                }
            };
            if let Some(pair) = pair {
                self.compare_processes(pair);
            }
            self.drop_wanted();
            self.begins = match self.commanded.pop() {
                Some(Item::Position(_)) => Begins::Positioned,
                _ => Begins::AtStart,
            };
        }
        if self.result.mismatches.is_empty() {
            self.result.mismatches.extend(self.unnamed.take());
        }
        self.result.wanted = self.alignment.wanted.feeds;
        self.result.commanded = self.commanded.feeds;
        self.result.limit_mm = self.alignment.wanted.limit_mm;
        self.result
    }

    /// Passes over the moves to the corrected start of a run, which end there within the limits as they are: within
    /// wider ones they would be taken for parts of its first feed.
    fn pass_approach(&mut self) {
        let (Some(first), Some(made)) = (self.alignment.wanted.feed(0), self.commanded.feed(0)) else {
            return;
        };
        let (start, near_mm) = (first.start(), first.limit_mm / self.wider);
        let away_mm = (made.start() - start).norm();
        if away_mm <= near_mm || away_mm > MOST_APPROACH_MM {
            return;
        }
        let left_mm = |ahead| self.commanded.feed(ahead).map(|made| (made.end() - start).norm());
        let mut ways_mm =
            (0..).map_while(left_mm).take_while(|mm| *mm <= away_mm + LEFT_OUT_LIMITS * near_mm);
        let moves = ways_mm.position(|mm| mm <= near_mm).map_or(0, |last| last + 1);
        (0..moves).for_each(|_| drop(self.commanded.pop()));
        self.result.approaches += moves;
    }

    /// A run of feeds, until one of the programs does something else.
    fn follow(&mut self, begins: Begins) {
        if let Some((at, line)) = self.commanded.feed(0).map(|first| (first.start(), first.line))
            && let Some(distance_mm) = self.alignment.begin(&at, begins)
            && self.apart(&at, 0, line).is_none()
        {
            self.note(0, distance_mm, line);
        }
        self.time = if begins == Begins::Anywhere { Time::UNKNOWN } else { Time::default() };
        // The process of a piece of no length that was made last.
        let mut stood: Option<Process> = None;
        loop {
            let frontier = self.alignment.frontier();
            match self.commanded.feed(0).map(|feed| feed.process) {
                // Both may go on over positioning moves of micrometres.
                Some(process) => {
                    let mut ahead = frontier;
                    while self.alignment.wanted.smooth(ahead, process) {
                        ahead += 1;
                    }
                }
                None if self.alignment.is_complete() || self.ends_in_the_air() => break,
                None => {
                    let ahead = self.alignment.wanted.feed(frontier).map(|feed| feed.process);
                    if !ahead.is_some_and(|process| self.commanded.smooth(0, process)) {
                        break;
                    }
                }
            }
            // Where a piece of no length has stood, the next in the same process reaches what it did, and what has come
            // ahead since.
            let piece = self.commanded.feed(0).map(|piece| (piece.reach_mm > 0.0, piece.process));
            let standing = piece.filter(|(moves, _)| !moves).map(|(_, process)| process);
            let all_asked = self.alignment.wanted.feed(frontier).is_none_or(|feed| feed.left.asked);
            if (standing.is_none() || standing != stood || !all_asked) && !self.piece() {
                self.part(frontier);
                return;
            }
            stood = standing;
            self.commanded.pop();
            for _ in 0..self.alignment.passed() {
                self.drop_wanted();
            }
        }
        if self.alignment.is_complete() || self.ends_in_the_air() {
            while self.alignment.wanted.feed(0).is_some() {
                self.drop_wanted();
            }
        } else {
            let frontier = self.alignment.frontier();
            self.part(frontier);
        }
    }

    /// The next feed of the corrected program, if it lies on the programmed path.
    fn piece(&mut self) -> bool {
        let Some(piece) = self.commanded.feed(0) else { return false };
        let short = piece.is_short();
        let way_mm = piece.way.as_ref().map_or(0.0, Way::length_mm);
        let Feeding { line, process, minutes, leans_rad, .. } = *piece;
        let stretches = std::mem::take(&mut piece.stretches);
        let reached = self.stretches(&stretches, line, process);
        if let Reached::At(ahead, _) = reached {
            self.note_lean(ahead, leans_rad);
        }
        if let Some(piece) = self.commanded.feed(0) {
            piece.stretches = stretches;
        }
        match reached {
            Reached::Nowhere => return false,
            // It has brought the tool to the start of the run.
            Reached::OnTheWay => self.result.approaches += 1,
            Reached::At(ahead, _) => {
                if process.feed.is_some() {
                    // Told by a speed, which is compared: it took the time that it should.
                    if let Some(reach) = self.alignment.wanted_time() {
                        self.time = reach.time();
                    }
                } else if let Some(minutes) = minutes {
                    let few = if short { minutes } else { 0.0 };
                    self.compare_time(&Taken { minutes, few, way_mm }, ahead, line);
                }
            }
        }
        true
    }

    fn stretches(&mut self, stretches: &[Stretch], line: u64, process: Process) -> Reached {
        let mut last = Reached::Nowhere;
        for stretch in stretches {
            last = self.alignment.advance(stretch, &process, Processes::Alike);
            if last == Reached::Nowhere {
                last = self.alignment.advance(stretch, &process, Processes::Whichever);
                while let (true, Some((wanted_line, wanted))) =
                    (last != Reached::Nowhere, self.alignment.differing(&process))
                {
                    self.compare_processes([(wanted_line, wanted), (line, process)]);
                }
            }
            match last {
                Reached::Nowhere => return last,
                Reached::OnTheWay => {}
                Reached::At(ahead, distance_mm) => {
                    if !self.judge(stretch, ahead, line) {
                        self.note(ahead, distance_mm, line);
                    }
                    self.remember(stretch, ahead);
                }
            }
        }
        last
    }

    /// Keeps where a stretch leads, for the feed that is reached and for those on the way there.
    fn remember(&mut self, stretch: &Stretch, ahead: usize) {
        if self.traces != Traces::WithPlaces {
            return;
        }
        for feed in self.reached.min(ahead)..=ahead {
            if let Some(feed) = self.alignment.wanted.feed(feed) {
                let begins = feed.made.last().copied();
                feed.made.extend(stretch.places().skip_while(|place| Some(*place) == begins));
            }
        }
        self.reached = ahead;
    }

    /// A distance from the feed so many ahead, and the line that makes it.
    fn note(&mut self, ahead: usize, distance_mm: f64, line: u64) {
        if let Some(feed) = self.alignment.wanted.feed(ahead) {
            // What is known of the programmed motion until it is dropped.
            feed.note_made(distance_mm, line);
        }
    }

    /// The angle of the tool on what was made of the feed so many ahead, where rotary axes are compared by their angles.
    fn note_lean(&mut self, ahead: usize, leans_rad: f64) {
        if let Some(feed) = self.alignment.wanted.feed(ahead).filter(|feed| feed.pointing.is_none()) {
            feed.made_leans_rad = feed.made_leans_rad.max(leans_rad);
        }
    }

    /// Tip and direction each by its own limit at the end of a stretch, where directions are compared; false where not.
    fn judge(&mut self, stretch: &Stretch, ahead: usize, line: u64) -> bool {
        let Some(Apart { off, limit_mm, pointing, wanted_line }) = self.apart(&stretch.at(1.0), ahead, line)
        else {
            return false;
        };
        let holds = [off.tip_mm <= limit_mm, off.leans_rad <= off.leans_at_most_rad];
        if !holds[0] {
            self.mismatch(What::TooFar(off.tip_mm), wanted_line, line);
        }
        if !holds[1] {
            self.mismatch(What::Leans(off.leans_rad), wanted_line, line);
        }
        // Along a rotary axis the tool points the same way at every angle of it.
        if holds == [true; 2] && off.aside_rad > pointing.aside_deg.to_radians() {
            self.mismatch(What::Turned, wanted_line, line);
        }
        true
    }

    /// How far the tip is off at a place, and how far the direction, noted for the feed so many ahead; `None` where directions
    /// are not compared.
    fn apart(&mut self, place: &Place, ahead: usize, line: u64) -> Option<Apart> {
        let feed = self.alignment.wanted.feed(ahead)?;
        let (limit_mm, pointing) = feed.pointing?;
        let off = feed.off(place, limit_mm);
        feed.note_made(off.tip_mm, line);
        feed.made_leans_rad = feed.made_leans_rad.max(off.leans_rad);
        Some(Apart { off, limit_mm, pointing, wanted_line: feed.line })
    }

    /// Under G93 a motion is known by what it takes.
    fn compare_time(&mut self, taken: &Taken, ahead: usize, line: u64) {
        let Some(reach) = self.alignment.wanted_time() else { return };
        let Some(feed) = self.alignment.wanted.feed(ahead) else { return };
        let wanted_line = feed.line;
        if let Some(times) = self.time.go_on(&reach, feed, taken) {
            self.mismatch(What::Time(times), wanted_line, line);
        }
    }

    /// What is left of the run lies in the air above a hole.
    fn ends_in_the_air(&mut self) -> bool {
        let frontier = self.alignment.frontier();
        let Some(last) = self.alignment.wanted.feed(frontier).filter(|feed| feed.airy[1]) else {
            return false;
        };
        last.left_mm().is_some_and(|left_mm| left_mm <= NEARLY_MM)
            && self.alignment.wanted.feed(frontier + 1).is_none()
    }

    /// The next programmed item is done with.
    fn drop_wanted(&mut self) {
        self.reached = self.reached.saturating_sub(1);
        if let Some(item) = self.alignment.wanted.pop() {
            self.record(item);
        }
    }

    /// What is to be remembered of a programmed item.
    fn record(&mut self, item: Item) {
        let Item::Feed(feed) = item else { return };
        let (minutes, way_mm) = feed.timed();
        let Feeding { line, way, off_mm: before_mm, made_off_mm: after_mm, made: made_mm, limit_mm, .. } =
            *feed;
        let after_line = feed.made_line;
        self.result.leans_before.note(feed.leans_rad, line);
        self.result.leans_after.note(feed.made_leans_rad, line);
        self.result.before.note(before_mm, line);
        self.result.after.note(after_mm, line);
        if let (Traces::Kept | Traces::WithPlaces, Some(way)) = (self.traces, way) {
            self.result.traces.push(Trace { line, way, before_mm, after_mm, limit_mm, after_line, made_mm });
        }
        self.time.made = self.time.made.map(|made| made - minutes);
        self.time.made_mm -= way_mm;
    }

    fn compare_processes(&mut self, [(wanted_line, wanted), (line, made)]: [(u64, Process); 2]) {
        if self.alignment.are_alike(&wanted, &made) {
            return;
        }
        if wanted.number != made.number {
            self.mismatch(What::Process([wanted.number, made.number]), wanted_line, line);
        }
        if let (Some(here), Some(there)) = (wanted.cycle, made.cycle)
            && here != there
        {
            self.mismatch(What::Process([here, there]), wanted_line, line);
        }
        if wanted.feed != made.feed {
            self.mismatch(What::Feed([wanted.feed, made.feed]), wanted_line, line);
        }
        if wanted.compensated != made.compensated {
            self.mismatch(What::Compensated, wanted_line, line);
        }
        self.alignment.excuse(wanted, made);
    }

    fn mismatch(&mut self, what: What, wanted_line: u64, commanded_line: u64) {
        if self.result.mismatches.len() < MOST_MISMATCHES {
            self.result.mismatches.push(Mismatch { what, wanted_line, commanded_line });
        } else {
            self.result.more_mismatches += 1;
        }
    }

    /// The programs part: names what lies before the next items that fit each other, and goes on from there.
    ///
    /// * `done` – so many programmed items ahead are made
    fn part(&mut self, done: usize) {
        self.reached = 0;
        let so_far = self.result.mismatches.len() + self.result.more_mismatches;
        let most = if so_far > AHEAD_IS_FAR { 2 } else { AHEAD };
        let [skipped, added] = self.meeting(done, most);
        for _ in 0..done {
            self.drop_wanted();
        }
        let wanted: Vec<Item> = (0..skipped).filter_map(|_| self.alignment.wanted.pop()).collect();
        let made: Vec<Item> = (0..added).filter_map(|_| self.commanded.pop()).collect();
        let line = |next: Option<&mut Item>, items: &[Item]| {
            next.map(|item| item.line()).or_else(|| items.last().map(Item::line)).unwrap_or_default()
        };
        let lines = [line(self.alignment.wanted.peek(0), &wanted), line(self.commanded.peek(0), &made)];
        let next = self.alignment.wanted.feed(0);
        let found = difference::names(&wanted, &made, next.as_deref(), NEARLY_MM);
        let nothing = found.is_empty();
        for Found { what, wanted: w, made: m } in found {
            let wanted_line = w.map_or(lines[0], |k| wanted[k].line());
            let commanded_line = m.map_or(lines[1], |k| made[k].line());
            if let What::TooFar(mm) = what {
                self.result.after.note(mm, wanted_line);
            }
            self.mismatch(what, wanted_line, commanded_line);
        }
        if nothing && self.unnamed.is_none() {
            // Whatever it is called, the programs part here; mostly what comes next has a name.
            let what = if made.is_empty() { What::Missing } else { What::Extra };
            let line = |items: &[Item], next| items.first().map_or(next, Item::line);
            let (wanted_line, commanded_line) = (line(&wanted, lines[0]), line(&made, lines[1]));
            self.unnamed = Some(Mismatch { what, wanted_line, commanded_line });
        }
        wanted.into_iter().for_each(|item| self.record(item));
        self.begins = Begins::Anywhere;
    }

    /// How many programmed items behind those done, and how many corrected ones, lie before two that fit each other.
    fn meeting(&mut self, done: usize, most: usize) -> [usize; 2] {
        for sum in 1..=2 * most {
            // Of as many, feeds before anything else, then as many on either side.
            let meets = |skipped: usize| {
                let pair = (self.alignment.wanted.peek(done + skipped), self.commanded.peek(sum - skipped));
                // The one that is under way goes on.
                let entry = if skipped == 0 { Entry::OnTheWay } else { Entry::AtStart };
                let rank = match pair {
                    (None, None) => 2,
                    (Some(wanted), Some(made)) if difference::fits(wanted, made, entry, 0.0) => {
                        u8::from(!matches!(made, Item::Feed(_)))
                    }
                    _ => return None,
                };
                Some((rank, (2 * skipped).abs_diff(sum), skipped))
            };
            let best = (sum.saturating_sub(most)..=sum.min(most)).filter_map(meets).min();
            if let Some((_, _, skipped)) = best {
                return [skipped, sum - skipped];
            }
        }
        // A program that was not corrected is off everywhere: there the next that is much the same.
        let same = (1..=most).find(|n| {
            let pair = self.alignment.wanted.peek(done + n).zip(self.commanded.peek(*n));
            pair.is_some_and(|(wanted, made)| difference::fits(wanted, made, Entry::AtStart, NEARLY_MM))
        });
        if let Some(count) = same {
            return [count; 2];
        }
        let left = [self.alignment.wanted.peek(done).is_some(), self.commanded.peek(0).is_some()];
        left.map(usize::from)
    }
}
