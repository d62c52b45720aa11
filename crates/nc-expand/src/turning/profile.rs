//! Geometry of LinuxCNC's G70, G71 and G72: a contour, what lies off it by a distance, and the moves down to it.
//!
//! G-code reference, "G70 Lathe finishing cycle", "G71 G72 Lathe roughing cycles", and what `rs274` of 2.9 makes of
//! them, with which the moves agree one by one.
//!
//! The contour is laid so that it falls along its first axis and rises along the second ([`Layout`]); for G72 the axes
//! change places first. Its first piece is the way from where the cycle starts to the contour: it may dive, and stays
//! where it is when the rest is moved off.
//!
//! * Off by a distance: in steps of at most half the smallest piece, each time every piece along its normal; where two
//!   pieces part by more than [`GAP`] along the first axis an arc about their corner closes the gap, else they are cut
//!   or lengthened to where they meet. A piece shorter than [`SHORT`] goes.
//!
//! Passes down to it are a room of their own: [`super::levels`].

use nc_dialect::Pockets;

use super::levels::{cut, passes_are_certain};
use super::pieces::{MOST, Misfit, Round, SAME, Segment, Stroke, along, cross, dot, length, middle, sub};
use super::place::Point;

/// Pieces that part by more along the first axis get an arc between them.
const GAP: f64 = 1e-2;
/// A piece shorter than this is none.
const SHORT: f64 = 1e-3;
/// Lines whose directions differ by less have no certain crossing: the interpreter refuses them only where it is zero.
const PARALLEL: f64 = 1e-7;

/// How the contour is laid: rows of a matrix that turns or mirrors.
#[derive(Clone, Copy, Debug)]
struct Layout([Point; 2]);

impl Layout {
    /// From (radius, Z) to (Z, radius).
    const PLAIN: Self = Self([[0.0, 1.0], [1.0, 0.0]]);

    fn then(self, further: [Point; 2]) -> Self {
        let [first, second] = self.0;
        Self(further.map(|row| {
            let part = |k: usize| row[0] * first[k] + row[1] * second[k];
            [part(0), part(1)]
        }))
    }

    fn lay(&self, p: Point) -> Point {
        self.0.map(|row| dot(row, p))
    }

    /// Its transpose undoes it.
    fn back(&self, p: Point) -> Point {
        [0, 1].map(|k| self.0[0][k] * p[0] + self.0[1][k] * p[1])
    }

    /// True where it turns the sense of arcs round, seen as G2 and G3 see them: from Z towards X.
    fn mirrors(&self) -> bool {
        cross(self.0[0], self.0[1]) > 0.0
    }
}

/// The axes change places: Z falls where X did.
const QUARTER: [Point; 2] = [[0.0, 1.0], [-1.0, 0.0]];

/// A contour, its first piece the way to it.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    segments: Vec<Segment>,
    layout: Layout,
}

impl Profile {
    /// Of pieces in (radius, Z), the first a line from where the cycle starts; at least two.
    pub(super) fn new(pieces: &[Segment]) -> Self {
        let layout = Layout::PLAIN;
        let lay = |segment: &Segment| Segment {
            start: layout.lay(segment.start),
            end: layout.lay(segment.end),
            round: segment.round.map(|round| Round { centre: layout.lay(round.centre), ..round }),
        };
        Self { segments: pieces.iter().map(lay).collect(), layout }
    }

    fn relay(&mut self, rows: [Point; 2]) {
        let by = Layout(rows);
        let turns = cross(rows[0], rows[1]) < 0.0;
        for segment in &mut self.segments {
            (segment.start, segment.end) = (by.lay(segment.start), by.lay(segment.end));
            if let Some(round) = &mut segment.round {
                round.centre = by.lay(round.centre);
                round.counter ^= turns;
            }
        }
        self.layout = self.layout.then(rows);
    }

    /// Mirrors it so that the contour falls along the first axis and rises along the second.
    fn settle(&mut self) {
        let way = sub(self.segments[self.segments.len() - 1].end, self.segments[0].end);
        let rows =
            [[if way[0] > 0.0 { -1.0 } else { 1.0 }, 0.0], [0.0, if way[1] < 0.0 { -1.0 } else { 1.0 }]];
        self.relay(rows);
    }

    fn told(&self, strokes: Vec<Stroke>) -> Vec<Stroke> {
        let back = |p: Point| self.layout.back(p);
        let turned = self.layout.mirrors();
        let told = |stroke: Stroke| match stroke {
            Stroke::Rapid(p) => Stroke::Rapid(back(p)),
            Stroke::Line(p) => Stroke::Line(back(p)),
            Stroke::Arc { counter, centre, end } => {
                Stroke::Arc { counter: counter ^ turned, centre: back(centre), end: back(end) }
            }
        };
        strokes.into_iter().map(told).collect()
    }

    /// G70: `passes` times along the contour, first off by nearly `from`, last by `to`.
    pub(super) fn finish(mut self, from: f64, to: f64, passes: u32) -> Result<Vec<Stroke>, Misfit> {
        self.settle();
        let start = self.layout.back(self.segments[0].start);
        self.dive_straight();
        if !self.segments.iter().all(Segment::falls) {
            self.relay(QUARTER);
            self.settle();
            self.dive_straight();
        }
        let mut strokes = vec![Stroke::Rapid(self.layout.lay(start))];
        for pass in (0..passes).rev() {
            let mut path = self.clone();
            path.keep_off(f64::from(pass) * (from - to) / f64::from(passes) + to)?;
            let (first, rest) = (path.segments[0], &path.segments[1..]);
            strokes.extend([Stroke::Rapid(first.start), Stroke::Rapid(first.end)]);
            strokes.extend(rest.iter().map(Segment::stroke));
        }
        Ok(self.told(strokes))
    }

    /// A way to the contour that would begin on the side of the workpiece goes along to above its place first, then
    /// down.
    fn dive_straight(&mut self) {
        let first = &mut self.segments[0];
        first.start[0] = first.start[0].max(first.end[0]);
    }

    /// G71, and G72 where `facing`: passes of a depth down to `distance` off the contour.
    pub(super) fn rough(
        mut self,
        facing: bool,
        pockets: Pockets,
        distance: f64,
        depth: f64,
        escape: f64,
    ) -> Result<Vec<Stroke>, Misfit> {
        if facing {
            self.relay(QUARTER);
        }
        self.keep_off(distance)?;
        self.settle();
        self.dive_straight();
        let first = &self.segments[0];
        if first.start[1] <= first.end[1] {
            return Err(Misfit::WrongSide);
        }
        if !self.segments.iter().all(Segment::falls) {
            return Err(Misfit::NotMonotone);
        }
        let (start, last) = (self.segments[0].start, self.segments[self.segments.len() - 1].end);
        if last[1] < start[1] {
            let out = Segment { start: last, end: [last[0], start[1]], round: None };
            self.segments.push(out);
        }
        if distance != 0.0 && !passes_are_certain(&self.segments, pockets, depth, escape) {
            return Err(Misfit::Level);
        }
        let strokes = cut(&self.segments, pockets, depth, escape)?;
        Ok(self.told(strokes))
    }

    /// Moves all but the first piece off by a distance, away from the workpiece.
    fn keep_off(&mut self, distance: f64) -> Result<(), Misfit> {
        self.settle();
        let first = self.segments.remove(0);
        let back = self.segments[self.segments.len() - 1];
        let side = cross(sub(back.start, first.start), sub(first.end, first.start));
        let distance = if side < 0.0 { -distance } else { distance };
        let (mut done, mut steps) = (0.0, 0);
        while done != distance {
            let smallest = self.segments.iter().map(|segment| 0.5 * segment.size()).fold(1e9, f64::min);
            let step = smallest.min((distance - done).abs()) * distance.signum();
            self.step_off(step)?;
            done += step;
            steps += 1;
            if steps > MOST || self.segments.is_empty() {
                return Err(Misfit::Distance);
            }
        }
        for k in 1..self.segments.len() {
            let joint = middle(self.segments[k - 1].end, self.segments[k].start);
            (self.segments[k - 1].end, self.segments[k].start) = (joint, joint);
        }
        self.segments.insert(0, Segment { end: self.segments[0].start, ..first });
        let whole = |p: Point| p[0].is_finite() && p[1].is_finite();
        let sound = self.segments.iter().all(|s| whole(s.start) && whole(s.end));
        if sound { Ok(()) } else { Err(Misfit::Distance) }
    }

    /// One step of an offset.
    fn step_off(&mut self, step: f64) -> Result<(), Misfit> {
        for segment in &mut self.segments {
            segment.push(step);
        }
        self.segments.retain(|segment| segment.size() >= SHORT);
        let mut k = 0;
        while k + 1 < self.segments.len() {
            let (mut before, mut after) = (self.segments[k], self.segments[k + 1]);
            let (start, end) = (before.end, after.start);
            if start[0] - end[0] > GAP {
                before.push(-step);
                after.push(-step);
                let round = Some(Round { centre: middle(before.end, after.start), counter: step > 0.0 });
                self.segments.insert(k + 1, Segment { start, end, round });
                k += 1;
            }
            k += 1;
        }
        let mut k = 0;
        while k + 1 < self.segments.len() {
            if !self.segments[k].falls() {
                return Err(Misfit::Distance);
            }
            if self.segments[k].size() < SHORT {
                self.segments.remove(k);
                k = 1;
            } else {
                let (before, after) = self.segments.split_at_mut(k + 1);
                join(&mut before[k], &mut after[0])?;
                k += 1;
            }
        }
        Ok(())
    }
}

/// Ends one piece and starts the next where they meet.
fn join(before: &mut Segment, after: &mut Segment) -> Result<(), Misfit> {
    let meet = match (before.round, after.round) {
        (None, None) => {
            let (u, v) = (sub(before.end, before.start), sub(after.end, after.start));
            let sine = cross(u, v);
            if sine.abs() < PARALLEL * length(u) * length(v) {
                return Err(Misfit::Straight);
            }
            along(before.start, u, cross(sub(after.start, before.start), v) / sine)
        }
        (Some(p), Some(n)) => {
            let to = sub(p.centre, n.centre);
            let (a, b, c) =
                (length(sub(after.start, n.centre)), length(sub(before.start, p.centre)), length(to));
            let cos = (c * c + a * a - b * b) / 2.0 / a / c;
            let sin = (1.0 - (cos * cos).min(1.0)).sqrt();
            let turned = [cos * to[0] - sin * to[1], sin * to[0] + cos * to[1]];
            along(n.centre, turned, a / c)
        }
        (Some(round), None) | (None, Some(round)) => {
            if length(sub(after.start, before.end)) < SAME {
                return Ok(());
            }
            let (line, rim) = if after.round.is_none() { (*after, before.end) } else { (*before, after.end) };
            let back = sub(line.start, line.end);
            let unit = along([0.0; 2], back, 1.0 / length(back));
            let to = sub(round.centre, line.end);
            let (foot, off) = (dot(to, unit), cross(unit, to));
            let radius = length(sub(round.centre, rim));
            let half = (radius * radius - off * off).max(0.0).sqrt();
            let places = [foot + half, foot - half].map(|place| along(line.end, unit, place));
            let [one, other] = places.map(|place| length(sub(after.start, place)));
            if one < other { places[0] } else { places[1] }
        }
    };
    (before.end, after.start) = (meet, meet);
    Ok(())
}
