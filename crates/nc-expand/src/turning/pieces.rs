//! Pieces of a contour, and the moves of a cycle.

use units::math;

use super::place::Point;

/// Largest reversal inside one piece; moves shorter than this are dropped.
pub(super) const SLACK: f64 = 1e-3;
/// An arc that is shorter along both axes is not run.
pub(super) const NO_ARC: f64 = 1e-5;
/// Two places nearer than this are one.
pub(super) const SAME: f64 = 1e-6;
/// Steps of one offset, and moves of one cycle; more are a wrong distance or depth.
pub(super) const MOST: usize = 20_000;

/// Why there are no moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Misfit {
    /// It turns back along the axis of the passes.
    NotMonotone,
    /// It starts below the first place of the contour: there is nothing to go down to.
    WrongSide,
    /// Off by the distance, a piece turns round or two pieces do not meet.
    Distance,
    /// Two lines that go straight on have no crossing when moved off.
    Straight,
    /// The passes come to no end, or there are too many.
    Endless,
    /// A pass lies at the height of a place of the contour but for the last digits of both.
    Level,
    /// A climbing piece does not begin where the one before ends.
    Apart,
}

/// A move, in radius and Z.
#[derive(Clone, Copy, Debug)]
pub(super) enum Stroke {
    Rapid(Point),
    Line(Point),
    /// G3 where counter-clockwise, about a centre.
    Arc {
        counter: bool,
        centre: Point,
        end: Point,
    },
}

impl Stroke {
    pub(super) const fn end(&self) -> Point {
        match *self {
            Self::Rapid(end) | Self::Line(end) | Self::Arc { end, .. } => end,
        }
    }
}

/// A line, or an arc.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) start: Point,
    pub(super) end: Point,
    pub(super) round: Option<Round>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Round {
    pub(super) centre: Point,
    /// From the first axis towards the second.
    pub(super) counter: bool,
}

pub(super) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn along(a: Point, d: Point, share: f64) -> Point {
    [a[0] + share * d[0], a[1] + share * d[1]]
}

pub(super) fn length(a: Point) -> f64 {
    math::hypot(a[0], a[1])
}

pub(super) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn middle(a: Point, b: Point) -> Point {
    [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
}

impl Segment {
    /// The smaller of chord and radius: what an offset may eat of it.
    pub(super) fn size(&self) -> f64 {
        let chord = length(sub(self.start, self.end));
        self.round.map_or(chord, |round| chord.min(length(sub(self.start, round.centre))))
    }

    pub(super) fn falls(&self) -> bool {
        let ahead = self.end[0] - self.start[0];
        let Some(Round { centre, counter }) = self.round else { return ahead <= SLACK };
        let side = if counter { 1.0 } else { -1.0 };
        let beside = |p: Point| side * (p[1] - centre[1]) >= -SLACK;
        beside(self.start) && beside(self.end) && ahead <= -SLACK
    }

    /// Each point by `distance` to the right of the way.
    pub(super) fn push(&mut self, distance: f64) {
        match self.round {
            None => {
                let back = sub(self.start, self.end);
                // In the interpreter's order: the last digit decides whether a cylinder rises or dives.
                let by = [-distance * back[1] / length(back), distance * back[0] / length(back)];
                (self.start, self.end) = (along(self.start, by, 1.0), along(self.end, by, 1.0));
            }
            Some(Round { centre, counter }) => {
                let radius = length(sub(self.start, centre));
                let factor = (radius + if counter { distance } else { -distance }) / radius;
                let scaled = |p: Point| along(centre, sub(p, centre), factor);
                (self.start, self.end) = (scaled(self.start), scaled(self.end));
            }
        }
    }

    /// True where a point of the circle lies on the arc, which is less than half a turn.
    pub(super) fn holds(&self, point: Point) -> bool {
        let Some(Round { centre, counter }) = self.round else { return true };
        let side = if counter { 1.0 } else { -1.0 };
        let turn = |end: Point| side * cross(sub(end, centre), sub(point, centre));
        turn(self.start) >= -SAME && turn(self.end) <= SAME
    }

    /// Where it has a level, the higher place of an arc first.
    pub(super) fn at_level(&self, level: f64) -> Vec<f64> {
        let (a, b) = (self.start, self.end);
        let Some(Round { centre, .. }) = self.round else {
            if a[1].min(b[1]) > level + SAME || a[1].max(b[1]) < level - SAME {
                return Vec::new();
            }
            if (a[1] - b[1]).abs() < SAME {
                return vec![a[0], b[0]];
            }
            return vec![(level - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) + a[0]];
        };
        let radius = length(sub(a, centre));
        let up = level - centre[1];
        let square = (radius - up) * (radius + up);
        if square < -SAME {
            return Vec::new();
        }
        let half = square.max(0.0).sqrt();
        let mut found = vec![centre[0] + half, centre[0] - half];
        found.retain(|place| self.holds([*place, level]));
        found
    }

    pub(super) fn stroke(&self) -> Stroke {
        match self.round {
            None => Stroke::Line(self.end),
            Some(Round { centre, counter }) => Stroke::Arc { counter, centre, end: self.end },
        }
    }
}
