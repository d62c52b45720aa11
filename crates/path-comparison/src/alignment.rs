//! The free space of a run: which places of the programmed feeds are reached while the real path stands where it does.
//!
//! Alt and Godau's decision of the Fréchet distance, a stretch of the real path at a time. [`Feeding::left`] is the free
//! space at that place; a stretch leads to the next. What is passed is dropped, what is ahead is not yet asked for.

use smallvec::SmallVec;

use crate::Step;
use crate::feeding::Left;
use crate::items::Items;
use crate::process::Process;
use crate::stretch::{Place, Span, Stretch};

/// A run begins no farther than this from where it should, mm: no machine that was measured is off by more.
pub(crate) const MOST_APPROACH_MM: f64 = 1.0;
/// So many limits of its beginning a run may leave out, where it begins a little on.
pub(crate) const LEFT_OUT_LIMITS: f64 = 4.0;

/// So many feeds that lead anywhere the programmed path may be ahead: motions of micrometres at one place by thousands
/// all lie near it.
const BAND: usize = 128;

/// What of the programmed run may be left out where a run begins.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Begins {
    /// Nothing but a little, or air.
    AtStart,
    /// The same, behind a positioning move: axes with play may come to the start from behind.
    Positioned,
    /// Whatever of the first motion lies before: it was under way.
    Anywhere,
}

/// The way to the start of a run: from where the tool stands, not corrected, to where it shall be.
struct Approach {
    start: Place,
    within_mm: f64,
    limit_mm: f64,
    /// So far from its start the run may be met: an axis that takes up its play brings the tool beside it first.
    first_part_mm: f64,
}

/// What a stretch of the real path reaches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Reached {
    /// The programmed path: the feed so many ahead, whose distance is this, mm.
    At(usize, f64),
    /// Not yet its start.
    OnTheWay,
    /// Nothing.
    Nowhere,
}

/// Whether the processes of two motions that go on together must be alike.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Processes {
    Alike,
    Whichever,
}

/// The programmed side of the comparison.
pub(crate) struct Alignment<'m, I> {
    pub(crate) wanted: Items<'m, I>,
    approach: Option<Approach>,
    excused: Excused,
}

/// Where a feed may be entered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Entry {
    /// At its start.
    AtStart,
    /// At any of its places: what lies before it may be left out.
    OnTheWay,
}

/// Processes that differ and were said to.
#[derive(Default)]
struct Excused {
    pairs: Vec<[Process; 2]>,
    /// Blocks under compensation are out of step.
    blocks: bool,
}

impl Excused {
    /// What of two processes is still compared.
    fn pair(&self, wanted: &Process, commanded: &Process) -> [Process; 2] {
        // A speed is as good as the time that it comes to, which is compared by itself.
        let by_time = wanted.is_timed && commanded.is_timed && commanded.feed.is_none();
        let both_call = wanted.cycle.is_some() && commanded.cycle.is_some();
        [wanted, commanded].map(|process| Process {
            number: process.number,
            feed: process.feed.filter(|_| !by_time),
            is_timed: false,
            compensated: process.compensated.filter(|_| !self.blocks),
            cycle: process.cycle.filter(|_| both_call),
        })
    }
}

impl<'m, I: Iterator<Item = Step>> Alignment<'m, I> {
    pub(crate) fn new(wanted: Items<'m, I>) -> Self {
        Self { wanted, approach: None, excused: Excused::default() }
    }

    pub(crate) fn are_alike(&self, wanted: &Process, commanded: &Process) -> bool {
        alike(&self.excused, wanted, commanded)
    }

    /// Two processes differ, and that is said: from here on they are alike.
    pub(crate) fn excuse(&mut self, wanted: Process, commanded: Process) {
        self.excused.blocks |= wanted.compensated != commanded.compensated;
        let pair = self.excused.pair(&wanted, &commanded);
        if pair[0] != pair[1] {
            self.excused.pairs.push(pair);
        }
    }

    /// A run begins: the real path stands at a place. How far that is beside the programmed one, mm, where it is near.
    pub(crate) fn begin(&mut self, at: &Place, begins: Begins) -> Option<f64> {
        self.approach = None;
        let mut ahead = 0;
        while let Some(feed) = self.wanted.feed(ahead).filter(|feed| feed.left.asked) {
            feed.left = Left::default();
            ahead += 1;
        }
        let first = self.wanted.feed(0)?;
        let (start, limit_mm) = (first.start(), first.limit_mm);
        let away_mm = (at - start).norm();
        let first_part_mm = if first.airy[0] { MOST_APPROACH_MM } else { LEFT_OUT_LIMITS * limit_mm };
        if away_mm <= MOST_APPROACH_MM {
            let within_mm = match begins {
                Begins::Positioned => away_mm + LEFT_OUT_LIMITS * limit_mm,
                _ if away_mm > limit_mm => away_mm + limit_mm,
                _ => limit_mm,
            };
            self.approach = Some(Approach { start, within_mm, limit_mm, first_part_mm });
        }
        let first = match begins == Begins::Anywhere || away_mm <= first_part_mm {
            true => Entry::OnTheWay,
            false => Entry::AtStart,
        };
        self.enter(at, first)
    }

    /// The real path stands at a place: what is reached there, of the first feed where it may be entered, and how far
    /// beside that feed it is, mm.
    fn enter(&mut self, at: &Place, entry: Entry) -> Option<f64> {
        let first = self.wanted.feed(0)?;
        let mut reaches = (at - first.start()).norm() <= first.limit_mm;
        let (mut ahead, mut nearest_mm) = (0, None);
        while let Some(feed) = self.wanted.feed(ahead) {
            feed.left = Left { asked: true, ..Left::default() };
            for (k, stretch) in feed.stretches.iter().enumerate() {
                let free = stretch.free(at, feed.limit_mm);
                let free = free.filter(|free| {
                    (reaches && free.is_at_start()) || (ahead == 0 && entry == Entry::OnTheWay)
                });
                reaches = free.is_some_and(|free| free.is_at_end());
                feed.left.push(k, free);
                if ahead == 0 && free.is_some() {
                    // A little before or behind its start it is on its way.
                    let beside_mm = stretch.beside_mm(at);
                    nearest_mm = Some(nearest_mm.map_or(beside_mm, |nearest: f64| nearest.min(beside_mm)));
                }
            }
            ahead += 1;
            if !reaches {
                break;
            }
        }
        nearest_mm
    }

    /// The first feed ahead that is not done, where the real path stands.
    pub(crate) fn frontier(&mut self) -> usize {
        let mut ahead = 0;
        while self.wanted.feed(ahead).is_some_and(|feed| feed.is_done()) {
            ahead += 1;
        }
        ahead
    }

    /// The run is made to its end.
    pub(crate) fn is_complete(&mut self) -> bool {
        let (mut ahead, mut done) = (0, true);
        while let Some(feed) = self.wanted.feed(ahead) {
            if !feed.left.asked {
                return false;
            }
            done = feed.is_done();
            ahead += 1;
        }
        done
    }

    /// The real path goes on by a stretch; the state is what it was where it reaches nothing.
    pub(crate) fn advance(&mut self, on: &Stretch, process: &Process, processes: Processes) -> Reached {
        let (begin, end) = (on.at(0.0), on.at(1.0));
        if let Some(approach) = &self.approach
            && (begin - approach.start).norm() <= approach.first_part_mm
            && self.wanted.feed(0).is_some_and(|feed| !feed.left.is_reached())
        {
            self.enter(&begin, Entry::OnTheWay);
        }
        // Of the stretch: where the programmed path may stand at the start of the next piece of it.
        let mut bottom = self.approach.as_ref().and_then(|a| on.free(&a.start, a.limit_mm));
        let on_the_way = self.approach.as_ref().is_some_and(|a| (end - a.start).norm() <= a.within_mm);
        let (mut touched, mut band, mut next) = (0, 0, SmallVec::<[Left; 4]>::new());
        let mut reached: Option<(usize, f64)> = None;
        // What ended in the air a little before its end goes on wherever the next begins.
        let mut leaps = false;
        loop {
            let excused = &self.excused;
            let Some(feed) = self.wanted.feed(touched) else { break };
            leaps &= feed.airy[0];
            if (bottom.is_none() && !leaps && !feed.left.asked) || band == BAND {
                break;
            }
            let goes = processes == Processes::Whichever || alike(excused, &feed.process, process);
            let at_start = || feed.left.at(0).filter(Span::is_at_start).map(|_| 0.0);
            let enters = bottom.map(|b| b.low).or_else(at_start);
            let ends = feed.left.first + feed.left.spans.len();
            let mut reaches = Left { asked: true, ..Left::default() };
            let mut k = if bottom.is_some() || leaps { 0 } else { feed.left.first };
            while k < feed.stretches.len() && (bottom.is_some() || k < ends || (leaps && k == 0)) {
                let (stretch, left) = (&feed.stretches[k], feed.left.at(k));
                let (mut right, top) = match goes {
                    true => cell(stretch, on, &end, [left, bottom], feed.limit_mm),
                    false => corners([left, bottom]),
                };
                if leaps && k == 0 {
                    right = stretch.free(&end, feed.limit_mm);
                }
                if let Some(span) = right {
                    let distance_mm = stretch.distance_within_mm(&end, span);
                    if reached.is_none_or(|(_, nearest)| distance_mm < nearest) {
                        reached = Some((touched, distance_mm));
                    }
                }
                reaches.push(k, right);
                bottom = top;
                k += 1;
            }
            leaps = feed.airy[1] && feed.left_mm_of(&reaches).is_some_and(|mm| mm <= MOST_APPROACH_MM);
            next.push(reaches);
            // A motion that leads no farther than the limit need not be made.
            if let Some(low) = enters.filter(|_| goes && feed.reach_mm <= feed.limit_mm) {
                let past = on.free(&feed.end(), feed.limit_mm).and_then(|free| free.from(low));
                bottom = match (bottom, past) {
                    (Some(a), Some(b)) => Some(Span::new(a.low.min(b.low), a.high.max(b.high))),
                    (a, b) => a.or(b),
                };
            }
            touched += 1;
            band += usize::from(feed.reach_mm > 0.0);
        }
        if reached.is_none() && !on_the_way {
            return Reached::Nowhere;
        }
        for (ahead, left) in next.into_iter().enumerate() {
            if let Some(feed) = self.wanted.feed(ahead) {
                feed.left = left;
            }
        }
        if !on_the_way {
            self.approach = None;
        }
        // Feeds ahead of what is reached are forgotten again, so that the window stays narrow.
        for ahead in (0..touched).rev() {
            match self.wanted.feed(ahead) {
                Some(feed) if !feed.left.is_reached() => feed.left = Left::default(),
                _ => break,
            }
        }
        reached.map_or(Reached::OnTheWay, |(ahead, distance_mm)| Reached::At(ahead, distance_mm))
    }

    /// The first feed that is reached in a process other than that of the real path.
    pub(crate) fn differing(&mut self, process: &Process) -> Option<(u64, Process)> {
        let mut ahead = 0;
        loop {
            let feed = self.wanted.feed(ahead).filter(|feed| feed.left.asked)?;
            let (reached, line, own) = (feed.left.is_reached(), feed.line, feed.process);
            if reached && !alike(&self.excused, &own, process) {
                return Some((line, own));
            }
            ahead += 1;
        }
    }

    /// How many feeds lie in front of the first that is reached: they are done, and nothing more can be of them.
    pub(crate) fn passed(&mut self) -> usize {
        let mut ahead = 0;
        while let Some(feed) = self.wanted.feed(ahead).filter(|feed| feed.left.asked) {
            if feed.left.is_reached() {
                if ahead > 0 {
                    self.approach = None;
                }
                return ahead;
            }
            ahead += 1;
        }
        0
    }
}

fn alike(excused: &Excused, wanted: &Process, commanded: &Process) -> bool {
    let pair = excused.pair(wanted, commanded);
    pair[0] == pair[1] || excused.pairs.contains(&pair)
}

/// What is reached where neither path goes on while the other does: from corner to corner only.
fn corners([left, bottom]: [Option<Span>; 2]) -> (Option<Span>, Option<Span>) {
    let corner = |span: Option<Span>| span.filter(Span::is_at_end).map(|_| Span::START);
    (corner(bottom), corner(left))
}

/// One cell of the free space: `left` is what is reached of `wanted` at the start of `real`, `bottom` of `real` at the
/// start of `wanted`; the answer is the same at their ends.
fn cell(
    wanted: &Stretch,
    real: &Stretch,
    end: &Place,
    [left, bottom]: [Option<Span>; 2],
    limit_mm: f64,
) -> (Option<Span>, Option<Span>) {
    if left.is_none() && bottom.is_none() {
        return (None, None);
    }
    let back = limit_mm / wanted.length_mm().max(limit_mm);
    let right = wanted.free(end, limit_mm);
    let top = real.free(&wanted.at(1.0), limit_mm);
    match (left, bottom) {
        (Some(_), Some(_)) => (right, top),
        (Some(left), None) => (right.and_then(|free| free.behind(&left, back)), top),
        (None, Some(bottom)) => (right, top.and_then(|free| free.from(bottom.low))),
        (None, None) => (None, None),
    }
}
