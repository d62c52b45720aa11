//! What a program makes the axes do.

use machine_model::{Command, PathModel, Vector};
use toolpath::{Feed, Motion, Partial};

use super::Program;
use crate::curve::Curve;

/// Largest distance between samples, mm.
const SAMPLE_MM: f64 = 0.5;

/// A feed motion, or what a cycle feeds in a hole.
pub(super) struct Feeding {
    pub(super) curve: Curve,
    pub(super) length_mm: f64,
    /// How far it leads from where it starts at most: less than its length for a circle.
    pub(super) reach_mm: f64,
    pub(super) state: Command,
    pub(super) line: u64,
    /// A hole: its pecks and the way back may feed over the same line again.
    pub(super) hole: bool,
}

impl Feeding {
    /// Where the tool really is, at s.
    pub(super) fn tip(&self, model: &dyn PathModel, s: f64) -> Vector {
        let at = self.curve.at(s);
        at + model.error_mm(&Command { linear_mm: at, ..self.state })
    }
}

/// Where the axes are and which way they came.
#[derive(Default)]
struct Way {
    at: [Option<f64>; 3],
    rotary_deg: [f64; 3],
    direction: [i8; 3],
}

impl Way {
    /// An axis moves; from an unknown place by an unknown way.
    fn axis(&mut self, i: usize, from: Option<f64>, to: Option<f64>) {
        self.direction[i] = match (from, to) {
            (Some(from), Some(to)) if to > from => 1,
            (Some(from), Some(to)) if to < from => -1,
            (Some(_), Some(_)) => self.direction[i],
            _ => 0,
        };
        self.at[i] = to;
    }

    fn line(&mut self, from: &Vector, to: &Vector) -> [i8; 3] {
        (0..3).for_each(|i| self.axis(i, Some(from[i]), Some(to[i])));
        self.direction
    }
}

/// A move whose end counts and whose way is the control's: G0, a reference return, a turn of rotary axes.
pub(super) struct Positioning {
    /// Where the axes were, as far as known.
    pub(super) start: Partial,
    /// Where they end.
    pub(super) end: Partial,
    /// What the error depends on besides the place.
    pub(super) state: Command,
    /// G0, which is corrected, unlike the others.
    pub(super) rapid: bool,
    pub(super) line: u64,
    /// Index of the feed that comes next.
    pub(super) before: usize,
}

impl Positioning {
    /// Where the tool really is with the axes at a place, where that is known.
    pub(super) fn tip(&self, model: &dyn PathModel, place: &Partial) -> Option<Vector> {
        let at = Vector::from(place.complete()?.linear_mm);
        Some(at + model.error_mm(&Command { linear_mm: at, ..self.state }))
    }

    /// No axis is known to move.
    pub(super) fn stays(&self) -> bool {
        self.start == self.end
    }
}

/// A program as its motions: of a feed every place counts, of what lies between only the end.
#[derive(Default)]
pub(super) struct Path {
    pub(super) feeds: Vec<Feeding>,
    pub(super) positionings: Vec<Positioning>,
}

impl Path {
    pub(super) fn of(program: &Program) -> Self {
        let mut way = Way::default();
        let mut path = Self::default();
        for step in program {
            let state = |rotary_deg: [f64; 3], direction: [i8; 3]| Command {
                linear_mm: Vector::zeros(),
                rotary_rad: Vector::from(rotary_deg.map(f64::to_radians)),
                tool_mm: step.tool_mm.into(),
                direction,
            };
            let feed = |curve: Curve, state: Command, hole: bool| {
                let (length_mm, reach_mm) = (length_mm(&curve), reach_mm(&curve));
                Feeding { curve, length_mm, reach_mm, state, line: step.line, hole }
            };
            let before = path.feeds.len();
            let position = |start: Partial, end: Partial, direction: [i8; 3], rapid: bool| {
                let state = state(end.rotary_deg, direction);
                Positioning { start, end, state, rapid, line: step.line, before }
            };
            match &step.motion {
                Motion::Feed(Feed { start, end, shape, .. }) => {
                    let (from, to) = (start.linear_mm.into(), end.linear_mm.into());
                    let state = state(end.rotary_deg, way.line(&from, &to));
                    path.feeds.push(feed(Curve::new(from, to, shape), state, false));
                    way.rotary_deg = end.rotary_deg;
                }
                Motion::Hole(hole) => {
                    let normal = hole.plane.axes()[2];
                    let top = Vector::from(hole.at_r.linear_mm);
                    let mut bottom = top;
                    bottom[normal] = hole.bottom_mm;
                    way.line(&hole.start.linear_mm.into(), &top);
                    let state = state(hole.at_r.rotary_deg, way.line(&top, &bottom));
                    way.line(&bottom, &hole.end().linear_mm.into());
                    path.feeds.push(feed(Curve::Line(top, bottom), state, true));
                }
                Motion::Rapid { start, end } => {
                    for i in 0..3 {
                        way.axis(i, start.linear_mm[i], end.linear_mm[i]);
                    }
                    path.positionings.push(position(*start, *end, way.direction, true));
                    way.rotary_deg = end.rotary_deg;
                }
                // By whatever way the control takes.
                Motion::Uncorrected { end } => {
                    let start = Partial { linear_mm: way.at, rotary_deg: way.rotary_deg };
                    for i in 0..3 {
                        if end.linear_mm[i].is_none() || end.linear_mm[i] != way.at[i] {
                            way.axis(i, None, end.linear_mm[i]);
                        }
                    }
                    path.positionings.push(position(start, *end, way.direction, false));
                    way.rotary_deg = end.rotary_deg;
                }
            }
        }
        path
    }
}

/// The length; of an arc whose radius changes by more than it turns, that of its chord.
fn length_mm(curve: &Curve) -> f64 {
    curve.length_mm().max((curve.at(1.0) - curve.at(0.0)).norm())
}

/// The largest distance from the start: sampled where it may matter, else the length, which bounds it.
fn reach_mm(curve: &Curve) -> f64 {
    const SHORT_MM: f64 = 0.2;
    let length_mm = length_mm(curve);
    if length_mm > SHORT_MM {
        return length_mm;
    }
    let start = curve.at(0.0);
    let mut reach_mm = 0.0f64;
    for_samples(curve, |s| reach_mm = reach_mm.max((curve.at(s) - start).norm()));
    reach_mm
}

pub(super) fn for_samples(curve: &Curve, mut f: impl FnMut(f64)) {
    let pieces = (curve.length_mm() / SAMPLE_MM).ceil().clamp(4.0, 20_000.0);
    let mut k = 0.0;
    while k <= pieces {
        f(k / pieces);
        k += 1.0;
    }
}

/// Nearest s of a curve to a place, continuing from a known s; not limited to 0..=1.
pub(super) fn project(curve: &Curve, place: &Vector, near: f64) -> f64 {
    let along = |a: &Vector, b: &Vector| {
        let step = b - a;
        let square = step.norm_squared();
        if square > 0.0 { (place - a).dot(&step) / square } else { 1.0 }
    };
    match curve {
        Curve::Line(a, b) => along(a, b),
        // Rounding of the program has made its radius change by more than it turns: its angle says nothing.
        Curve::Arc { ends: [a, b], .. } if (b - a).norm() > curve.length_mm() => along(a, b),
        Curve::Arc { axes: [u, v, n], centre, angle, sweep, radius, ends: [start, end] } => {
            let here = units::math::atan2(place[*v] - centre[1], place[*u] - centre[0]);
            let expected = angle + sweep * near;
            let turns = ((expected - here) / std::f64::consts::TAU).round();
            let by_angle = (here + turns * std::f64::consts::TAU - angle) / sweep;
            // A steep helix is known by its height rather than by its angle: each weighs by the way it makes.
            let rise = end[*n] - start[*n];
            if rise == 0.0 {
                return by_angle;
            }
            let by_height = (place[*n] - start[*n]) / rise;
            let around = 0.5 * (radius[0] + radius[1]) * sweep;
            (by_angle * around * around + by_height * rise * rise) / (around * around + rise * rise)
        }
    }
}

pub(super) fn distance(curve: &Curve, place: &Vector, s: f64) -> f64 {
    (curve.at(s.clamp(0.0, 1.0)) - place).norm()
}
