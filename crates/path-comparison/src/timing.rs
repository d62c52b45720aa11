//! What motions take under G93, where the time is what is programmed.

use crate::Step;
use crate::alignment::Alignment;
use crate::feeding::Feeding;

/// By so much the time of a motion may differ under G93, whose F is rounded.
const SAME_TIME: f64 = 0.02;
/// So much longer than it should, as a share of a motion's time, one of its pieces may take: no line of an approach is given less.
const NO_TIME: f64 = 1e-3;

/// What a motion takes that was made.
pub(crate) struct Taken {
    /// Minutes.
    pub(crate) minutes: f64,
    /// What of them may not count: all, of a motion about as long as the limit.
    pub(crate) few: f64,
    /// The length that is commanded, mm.
    pub(crate) way_mm: f64,
}

/// Minutes under G93, counted from the start of the first feed ahead.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Time {
    /// At least and at most: a place within the limit is reached over some way, which is a long time for a fast piece that
    /// goes on from a slow one.
    pub(crate) made: [f64; 2],
    /// How far along the way that leads at least, mm.
    pub(crate) made_mm: f64,
}

impl Time {
    /// The first motion was under way.
    pub(crate) const UNKNOWN: Self = Self { made: [f64::NAN; 2], made_mm: f64::NAN };

    /// The program goes on by what a motion takes; how many times as long as it should that is, where it differs.
    pub(crate) fn go_on(&mut self, reach: &Reach, feed: &Feeding, taken: &Taken) -> Option<f64> {
        let Taken { minutes, few, way_mm } = *taken;
        let [from, to] = reach.minutes;
        let whole = feed.minutes.unwrap_or(0.0);
        // Of two motions about as long as the limit only one may count.
        let few = if feed.is_short() { few.max(whole) } else { few };
        if self.made[0].is_nan() {
            *self = Self { made: [to - minutes; 2], made_mm: reach.way_mm[1] };
        }
        let before = self.made[0];
        let since = minutes.max(to - before);
        let early = SAME_TIME * since + few;
        // What leads no farther, as while play is taken up, takes its time at the motion's speed: of one that ends at a corner
        // nobody knows whose. No way takes less time for it.
        let farther_mm = (reach.way_mm[1] - self.made_mm).max(0.0);
        let detour = (way_mm - farther_mm).max(0.0) * reach.minutes_per_mm;
        let late = early + NO_TIME * whole + detour;
        let [least, most] = self.made.map(|made| made + minutes);
        let differs = most < from - early || least > to + late;
        let made = if differs { [from, to] } else { [from.max(least - late), to.min(most + early)] };
        *self = Self { made, made_mm: reach.at_least_mm(made[0]) };
        differs.then(|| (least - before) / (0.5 * (from + to) - before).max(1e-12))
    }
}

/// What is reached of the feeds ahead, from its first place to its last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Minutes at either.
    minutes: [f64; 2],
    /// How far along the way either is, mm.
    way_mm: [f64; 2],
    /// Of the slowest motion.
    minutes_per_mm: f64,
}

impl Reach {
    /// A program that has taken its time so far.
    pub(crate) fn time(&self) -> Time {
        Time { made: self.minutes, made_mm: self.way_mm[1] }
    }

    /// How far along the way it is after so many minutes, mm.
    fn at_least_mm(&self, minutes: f64) -> f64 {
        let ([from, to], [from_mm, to_mm]) = (self.minutes, self.way_mm);
        if to > from { from_mm + (minutes - from) / (to - from) * (to_mm - from_mm) } else { from_mm }
    }
}

impl<I: Iterator<Item = Step>> Alignment<'_, I> {
    /// The minutes and the way at the first and the last place that are reached.
    pub(crate) fn wanted_time(&mut self) -> Option<Reach> {
        let (mut reach, mut so_far, mut so_far_mm, mut k): (Option<Reach>, f64, f64, usize) =
            (None, 0.0, 0.0, 0);
        while let Some(feed) = self.wanted.feed(k).filter(|feed| feed.left.asked) {
            let (minutes, way_mm) = feed.timed();
            for (stretch, span) in feed.left.reached() {
                let at = |s: f64| {
                    let share = (stretch as f64 + s) / feed.stretches.len() as f64;
                    (so_far + minutes * share, so_far_mm + way_mm * share)
                };
                let (low, high) = (at(span.low), at(span.high));
                let reach = reach.get_or_insert(Reach {
                    minutes: [low.0; 2],
                    way_mm: [low.1; 2],
                    minutes_per_mm: 0.0,
                });
                (reach.minutes[1], reach.way_mm[1]) = high;
                if way_mm > 0.0 {
                    reach.minutes_per_mm = reach.minutes_per_mm.max(minutes / way_mm);
                }
            }
            (so_far, so_far_mm, k) = (so_far + minutes, so_far_mm + way_mm, k + 1);
        }
        reach
    }
}
