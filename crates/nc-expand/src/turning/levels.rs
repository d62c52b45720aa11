//! Passes of LinuxCNC's G71 and G72, in the frame of a laid contour ([`super::profile`]).
//!
//! Levels lie whole depths below the start. Each goes to where the diving piece reaches it, along the first axis
//! to the contour, off by the escape in both axes, back by as much, and down again. Behind the lowest the contour
//! itself is cut, up to where it dives again: there a pocket begins, which is cut likewise. Without pockets only what
//! rises is cut; pockets alone begin at the bottom of the first dive.

use nc_dialect::Pockets;

use super::pieces::{MOST, Misfit, NO_ARC, Round, SAME, SLACK, Segment, Stroke, length, sub};
use super::place::Point;

/// What a few dozen roundings of lengths below a metre come to, mm.
const LAST_DIGITS: f64 = 1e-9;

/// Passes of a depth down to a contour, the first piece of which dives.
pub(super) fn cut(
    segments: &[Segment],
    pockets: Pockets,
    depth: f64,
    escape: f64,
) -> Result<Vec<Stroke>, Misfit> {
    let at = segments[0].start;
    let mut cut = Cut { segments, at, strokes: vec![Stroke::Rapid(at)], depth, escape };
    cut.down(pockets)?;
    Ok(cut.strokes)
}

/// Whether the same moves come of a contour that lies higher or lower by the last digits of its numbers.
///
/// Levels come of differences, a contour that is moved off of sums: where one lies on the other but for their last
/// digits, whether a pass is cut there depends on how the interpreter rounds on its way to either. Numbers that binary
/// fractions hold are the same to everybody.
pub(super) fn passes_are_certain(segments: &[Segment], pockets: Pockets, depth: f64, escape: f64) -> bool {
    let exact = |value: f64| (value * f64::from(1_u32 << 20)).fract() == 0.0;
    if exact(depth) && segments.iter().all(|segment| exact(segment.start[1]) && exact(segment.end[1])) {
        return true;
    }
    let start = segments[0].start;
    let moves = |by: f64| {
        let raised = |p: Point| if p[1] == start[1] { p } else { [p[0], p[1] + by] };
        let raise = |segment: &Segment| Segment {
            start: raised(segment.start),
            end: raised(segment.end),
            round: segment
                .round
                .map(|round| Round { centre: [round.centre[0], round.centre[1] + by], ..round }),
        };
        let raised: Vec<Segment> = segments.iter().map(raise).collect();
        cut(&raised, pockets, depth, escape).unwrap_or_default()
    };
    let (above, below) = (moves(LAST_DIGITS), moves(-LAST_DIGITS));
    let alike = |(a, b): (&Stroke, &Stroke)| length(sub(a.end(), b.end())) < SAME;
    above.len() == below.len() && above.iter().zip(&below).all(alike)
}

/// Passes on their way.
struct Cut<'p> {
    segments: &'p [Segment],
    at: Point,
    strokes: Vec<Stroke>,
    depth: f64,
    escape: f64,
}

impl Cut<'_> {
    fn feed(&mut self, to: Point) {
        self.strokes.push(Stroke::Line(to));
        self.at = to;
    }

    fn arc(&mut self, round: Round, to: Point) {
        if sub(to, self.at).iter().any(|way| way.abs() >= NO_ARC) {
            self.strokes.push(Stroke::Arc { counter: round.counter, centre: round.centre, end: to });
        }
        self.at = to;
    }

    /// Where an arc that rises from its lowest place, or to its highest, ends: at the end, or at the top.
    fn top(segment: &Segment, round: Round) -> Point {
        if segment.end[0] < round.centre[0] {
            [round.centre[0], round.centre[1] + length(sub(segment.start, round.centre))]
        } else {
            segment.end
        }
    }

    /// Down a piece to a level, or its end; false where it does not dive.
    fn dive(&mut self, k: usize, level: f64) -> Result<bool, Misfit> {
        let segment = self.segments[k];
        let Some(round) = segment.round else {
            if segment.start[1] <= segment.end[1] + SAME {
                return Ok(false);
            }
            let to = if level < segment.end[1] {
                segment.end
            } else {
                let place = segment.at_level(level);
                [*place.first().ok_or(Misfit::Apart)?, level]
            };
            if k == 0 {
                self.strokes.push(Stroke::Rapid(to));
                self.at = to;
            } else {
                self.feed(to);
            }
            return Ok(true);
        };
        if self.at[0] - segment.end[0] <= SAME {
            self.at = segment.end;
            return Ok(true);
        }
        let beyond = self.at[0] - round.centre[0];
        if if round.counter { beyond > SAME } else { beyond <= 0.0 } {
            return Ok(false);
        }
        let mut places = segment.at_level(level);
        if places.is_empty() {
            places = segment.at_level(level - SAME);
        }
        let behind = |place: f64| place <= round.centre[0];
        match if round.counter { places.last() } else { places.first() } {
            Some(place) if behind(*place) == round.counter => self.arc(round, [*place, level]),
            // A valley that has the level on its far side alone is left for the next level.
            Some(_) if !round.counter => {}
            _ => self.arc(round, segment.end),
        }
        Ok(true)
    }

    /// Up a piece; false where it does not rise to its end.
    fn climb(&mut self, k: usize) -> Result<bool, Misfit> {
        let segment = self.segments[k];
        let Some(round) = segment.round else {
            if segment.end[1] + SAME < segment.start[1] {
                return Ok(false);
            }
            if length(sub(self.at, segment.start)) > SAME {
                return Err(Misfit::Apart);
            }
            self.feed(segment.end);
            return Ok(true);
        };
        let beyond = self.at[0] - round.centre[0];
        if if round.counter { beyond < 0.0 } else { beyond > 0.0 } {
            return Ok(false);
        }
        let to = if round.counter { Self::top(&segment, round) } else { segment.end };
        if length(sub(self.at, to)) > SLACK {
            self.arc(round, to);
        }
        self.at = to;
        Ok(!round.counter)
    }

    /// Over to a piece at the height where the tool stands, and up it.
    fn climb_over(&mut self, k: usize) {
        let segment = self.segments[k];
        let places = segment.at_level(self.at[1]);
        let Some(round) = segment.round else {
            if segment.end[1] >= segment.start[1]
                && let Some(place) = places.first()
            {
                self.feed([*place, self.at[1]]);
                self.feed(segment.end);
            }
            return;
        };
        let (place, to) = if round.counter {
            (places.first().filter(|place| **place >= round.centre[0]), Self::top(&segment, round))
        } else {
            (places.last().filter(|place| **place <= round.centre[0]), segment.end)
        };
        let Some(place) = place else { return };
        self.feed([*place, self.at[1]]);
        if length(sub(self.at, to)) > SLACK {
            self.arc(round, to);
        }
        self.at = to;
    }

    /// Passes down, pocket by pocket, and the contour behind them.
    fn down(&mut self, pockets: Pockets) -> Result<(), Misfit> {
        let highest = self.segments[0].start[1];
        let lowest = self.segments.iter().map(|segment| segment.end[1]).fold(highest, f64::min);
        if (highest - lowest) / self.depth > MOST as f64 {
            return Err(Misfit::Endless);
        }
        let (mut level, mut k, mut turns) = (highest, 0, 0);
        let mut origin = highest;
        if pockets == Pockets::Only {
            while k < self.segments.len() && self.dive(k, -1e9)? {
                k += 1;
            }
            origin = self.at[1];
        }
        while k < self.segments.len() {
            turns += 1;
            if turns > MOST {
                return Err(Misfit::Endless);
            }
            while level - SAME > self.at[1] {
                level -= self.depth;
            }
            if !self.dive(k, level)? {
                if pockets == Pockets::Leave {
                    (k..self.segments.len()).for_each(|k| self.climb_over(k));
                    return Ok(());
                }
                while k < self.segments.len() && self.climb(k)? {
                    k += 1;
                }
                // Where pockets alone are cut, levels count from the highest place so far.
                if pockets == Pockets::Only {
                    origin = origin.max(self.at[1]);
                }
                level = origin;
                continue;
            }
            if (self.at[1] - level).abs() > SAME {
                k += 1;
                continue;
            }
            match self.pass(k)? {
                Pass::Cut => level -= self.depth,
                Pass::Met(ahead) => k = ahead,
            }
        }
        Ok(())
    }

    /// One pass at the height where the tool stands.
    fn pass(&mut self, k: usize) -> Result<Pass, Misfit> {
        let here = self.at;
        for ahead in k..self.segments.len() {
            let places = self.segments[ahead].at_level(here[1]);
            // An arc that dives may end the pass too.
            let Some(to) = (if ahead == k { places.last() } else { places.first() }).copied() else {
                continue;
            };
            let distance = here[0] - to;
            if distance < -SAME || distance < SAME && ahead == k {
                continue;
            }
            if distance < SAME {
                let meets = length(sub(here, self.segments[ahead].start)) < SAME;
                return Ok(if meets { Pass::Met(ahead) } else { Pass::Cut });
            }
            let off = self.escape * (0.5 * distance / self.escape).min(1.0);
            self.feed([to, here[1]]);
            self.strokes.push(Stroke::Rapid([to + off, here[1] + off]));
            self.strokes.push(Stroke::Rapid([here[0] - off, here[1] + off]));
            self.strokes.push(if k == 0 { Stroke::Rapid(here) } else { Stroke::Line(here) });
            self.at = here;
            return Ok(Pass::Cut);
        }
        Err(Misfit::Endless)
    }
}

/// What became of a pass.
enum Pass {
    /// It is done, or has no length.
    Cut,
    /// A further piece begins where it would start.
    Met(usize),
}
