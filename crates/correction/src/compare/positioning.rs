//! Corrected positioning moves to programmed ones, in order.

use std::cmp::Ordering;

use machine_model::Vector;

use super::Mismatch;
use super::matcher::{Matcher, SHORT_LIMITS};
use super::path::Positioning;

/// A cycle goes straight where the machine's axis leans, by no more than that, rad; what is written as moves does not.
const MOST_LEAN: f64 = 5e-3;

impl Matcher<'_> {
    /// Takes a positioning move of the corrected program.
    pub(super) fn position(&mut self, made: &Positioning) {
        let next = (self.at..self.wanted.len()).find(|at| !self.may_be_passed_over(*at));
        let next = next.unwrap_or(self.wanted.len());
        let due = self.positionings.iter().take_while(|w| w.before <= next).count();
        let found =
            |from: usize, to: usize| (from..to).find(|k| self.ends_alike(&self.positionings[*k], made));
        // First the next that moves an axis: what comes later may end at the same place, and so may a rapid in a hole.
        let idle = self.positionings[..due].iter().take_while(|w| w.stays()).count();
        if let Some(next) = found(0, due.min(idle + 1)) {
            self.positioned(next);
            return;
        }
        if made.stays() || self.belongs_to_a_hole(made, next) {
            return;
        }
        // What comes behind the next feed: then that feed is not made, or not to its end.
        let behind = self.positionings[due..].iter().take_while(|w| w.before == next + 1).count();
        if let Some(later) = found(idle, due + behind) {
            self.positioned(later);
            return;
        }
        // Go on as if it had been meant for the next one, so that one bad block is one mismatch.
        self.positionings = &self.positionings[due.min(1)..];
        self.mismatch(Mismatch::PositionedElsewhere { commanded_line: made.line });
    }

    /// The next move is made, those before it are not; the feeds before it are made or left out.
    fn positioned(&mut self, passed_over: usize) {
        self.not_made(passed_over);
        let Some((made, rest)) = self.positionings.split_first() else { return };
        self.positionings = rest;
        if made.before > self.at {
            (self.at..made.before).for_each(|at| self.left_over(at));
            (self.at, self.s) = (made.before, 0.0);
        }
    }

    /// Says what was to be done before a feed and was not.
    pub(super) fn positioned_before(&mut self, feed: usize) {
        let due = self.positionings.iter().take_while(|w| w.before <= feed).count();
        self.not_made(due);
    }

    /// Leaves out the next moves, and says so where they would have moved an axis.
    fn not_made(&mut self, count: usize) {
        let (left_out, rest) = self.positionings.split_at(count);
        self.positionings = rest;
        for w in left_out.iter().filter(|w| !w.stays()) {
            self.mismatch(Mismatch::NotPositioned { wanted_line: w.line });
        }
    }

    /// The end of a corrected move is that of a programmed one.
    fn ends_alike(&self, w: &Positioning, made: &Positioning) -> bool {
        if w.rapid != made.rapid || w.end.rotary_deg != made.end.rotary_deg {
            return false;
        }
        let near_mm = SHORT_LIMITS * self.limit_mm;
        if let (true, Some(end), Some(tip)) = (w.rapid, w.end.complete(), made.tip(self.model, &made.end)) {
            return (tip - Vector::from(end.linear_mm)).norm() <= near_mm;
        }
        // Uncorrected: what the block moves ends as written or goes as far as written, and the other axes stay where the
        // correction brought them.
        (0..3).all(|axis| {
            let [(w_from, w_to), (from, to)] =
                [w, made].map(|p| (p.start.linear_mm[axis], p.end.linear_mm[axis]));
            let (Some(w_to), Some(to)) = (w_to, to) else { return true };
            let by_as_much = w_from
                .zip(from)
                .is_some_and(|(w_from, from)| ((w_to - w_from) - (to - from)).abs() <= near_mm);
            by_as_much || (w_to - to).abs() <= near_mm
        })
    }

    /// A rapid of a cycle that is written as moves: straight out, or on the hole's line no deeper than it is drilled.
    fn belongs_to_a_hole(&self, made: &Positioning, next: usize) -> bool {
        let near_mm = SHORT_LIMITS * self.limit_mm;
        let [start, end] = [&made.start, &made.end].map(|place| made.tip(self.model, place));
        let (Some(start), Some(end)) = (start, end) else { return false };
        let moved = end - start;
        // The last, the one under way, the next; holes of no depth in between need no move.
        (self.at.saturating_sub(1)..=next).any(|at| {
            let drilled = match at.cmp(&self.at) {
                Ordering::Less => 1.0,
                Ordering::Equal => self.s,
                Ordering::Greater => 0.0,
            };
            let Some(w) = self.wanted.get(at).filter(|w| w.hole && made.rapid) else { return false };
            let (top, down) = (w.curve.at(0.0), w.curve.tangent(0.0));
            if w.length_mm == 0.0 {
                // Without a depth it does not say along which axis it would go: to its level, or on its line.
                let far = |v: &Vector, mm: f64| (0..3).filter(|axis| v[*axis].abs() > mm).collect::<Vec<_>>();
                let (aside, ways) =
                    (far(&(end - top), near_mm), far(&moved, near_mm + MOST_LEAN * moved.norm()));
                return aside.len() <= 1 || (ways.len() == 1 && !aside.contains(&ways[0]));
            }
            let depth_mm = (end - top).dot(&down);
            let aside_mm = (end - top - down * depth_mm).norm();
            let straight_out =
                moved.dot(&down) < 0.0 && moved.cross(&down).norm() <= near_mm + MOST_LEAN * moved.norm();
            straight_out || (aside_mm <= near_mm && depth_mm <= drilled * w.length_mm + near_mm)
        })
    }
}
