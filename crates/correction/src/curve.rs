//! A motion's geometry as a function of s in 0..=1.

use std::f64::consts::TAU;

use machine_model::Vector;
use toolpath::{Feed, Shape};
use units::math::{atan2, sin_cos};

pub(crate) use machine_model::SAME_PLACE_MM;

/// What a spiral turns and bends more than the circle it is near: a tangent that leans by k = r'/r turns by `1 + k²/(1 + k²)` per
/// radian, and the curvature times r is at most `1 + k²/2`.
const SPIRAL: f64 = 1.01;

/// The largest k for which both hold.
const STEEPEST: f64 = 0.1;

/// A turn of a radian counts as a way of so many mm where lengths are compared: as far from the axis as a tip may be.
const LEVER_MM: f64 = 1000.0;

/// A line, or an arc whose radius and normal axis run linearly with the angle; a line on whose way rotary axes turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Curve {
    /// From, to.
    Line(Vector, Vector),
    /// See the fields.
    Arc {
        /// First, second and normal axis.
        axes: [usize; 3],
        /// Centre in the first two, mm.
        centre: [f64; 2],
        /// Angle at s = 0, rad.
        angle: f64,
        /// Angle turned, rad.
        sweep: f64,
        /// Radius at s = 0 and s = 1, mm.
        radius: [f64; 2],
        /// The places at s = 0 and s = 1: in the first two axes what the angles lead to, but for rounding.
        ends: [Vector; 2],
    },
    /// A line of the linear axes while rotary axes turn in step.
    Turn {
        /// The places at s = 0 and s = 1.
        ends: [Vector; 2],
        /// A, B, C there, rad.
        rotary_rad: [Vector; 2],
    },
}

/// The turn from `from` to `to` in the sense of another one, in (0, 2π], as an angle with sign.
///
/// Ends that coincide to the last bit make a full circle; that is how controls read it.
pub(crate) fn turn(from: f64, to: f64, sense_of: f64) -> f64 {
    let clockwise = sense_of < 0.0;
    let mut sweep = if clockwise { from - to } else { to - from } % TAU;
    if sweep <= 0.0 {
        sweep += TAU;
    }
    if clockwise { -sweep } else { sweep }
}

impl Curve {
    /// By how much an arc's radii differ at its ends, mm; nothing of what is no arc.
    pub(crate) fn radii_apart_mm(&self) -> f64 {
        match self {
            Self::Arc { radius, .. } => (radius[1] - radius[0]).abs(),
            Self::Line(..) | Self::Turn { .. } => 0.0,
        }
    }

    /// The geometry of a motion between two axis commands. A curve by control points is written as lines, each a motion of its
    /// own ([`crate::Corrector::correct`]): here it is the line between its ends.
    #[must_use]
    pub fn new(start: Vector, end: Vector, shape: &Shape) -> Self {
        match shape {
            Shape::Line | Shape::Bezier(_) => Self::Line(start, end),
            Shape::Arc(arc) => {
                let axes = arc.plane.axes();
                let [u, v, _] = axes;
                let [cu, cv] = arc.centre_mm;
                let (su, sv) = (start[u] - cu, start[v] - cv);
                let (eu, ev) = (end[u] - cu, end[v] - cv);
                Self::Arc {
                    axes,
                    centre: arc.centre_mm,
                    angle: atan2(sv, su),
                    sweep: arc.sweep_rad,
                    radius: [(su * su + sv * sv).sqrt(), (eu * eu + ev * ev).sqrt()],
                    ends: [start, end],
                }
            }
        }
    }

    /// The geometry of a feed, and of its rotary axes where they turn on the way of a line.
    pub(crate) fn of(feed: &Feed) -> Self {
        let [from, to] = [feed.start, feed.end];
        if from.rotary_deg != to.rotary_deg && matches!(feed.shape, Shape::Line) {
            return Self::Turn {
                ends: [from, to].map(|place| place.linear_mm.into()),
                rotary_rad: [from, to].map(|place| place.rotary_deg.map(f64::to_radians).into()),
            };
        }
        Self::new(from.linear_mm.into(), to.linear_mm.into(), &feed.shape)
    }

    /// The arc a control makes of two ends and a centre, in the sense of a sweep.
    pub fn from_centre(
        start: Vector,
        end: Vector,
        axes: [usize; 3],
        centre: [f64; 2],
        sense_of: f64,
    ) -> Self {
        let [u, v, _] = axes;
        let (su, sv) = (start[u] - centre[0], start[v] - centre[1]);
        let (eu, ev) = (end[u] - centre[0], end[v] - centre[1]);
        let angle = atan2(sv, su);
        let sweep = if start[u] == end[u] && start[v] == end[v] {
            turn(0.0, 0.0, sense_of)
        } else {
            turn(angle, atan2(ev, eu), sense_of)
        };
        Self::Arc {
            axes,
            centre,
            angle,
            sweep,
            radius: [(su * su + sv * sv).sqrt(), (eu * eu + ev * ev).sqrt()],
            ends: [start, end],
        }
    }

    /// The place at s.
    #[must_use]
    pub fn at(&self, s: f64) -> Vector {
        match self {
            // The end itself, not what is left of it after a subtraction and an addition.
            Self::Line(_, b) if s >= 1.0 => *b,
            Self::Line(a, b) => a + (b - a) * s,
            Self::Turn { ends, .. } => between(ends, s),
            Self::Arc { ends, .. } if s == 0.0 => ends[0],
            Self::Arc { ends, .. } if s == 1.0 => ends[1],
            Self::Arc { angle, sweep, .. } => self.at_turned(s, sin_cos(angle + sweep * s)),
        }
    }

    /// Unit tangent at s; zero where the curve does not move.
    pub fn tangent(&self, s: f64) -> Vector {
        match self {
            Self::Line(a, b) | Self::Turn { ends: [a, b], .. } => unit(b - a),
            Self::Arc { angle, sweep, .. } => self.tangent_turned(s, sin_cos(angle + sweep * s)),
        }
    }

    /// A, B, C at s, rad, where they turn on the way.
    #[must_use]
    pub fn rotary_rad(&self, s: f64) -> Option<Vector> {
        match self {
            Self::Turn { rotary_rad, .. } => Some(between(rotary_rad, s)),
            Self::Line(..) | Self::Arc { .. } => None,
        }
    }

    /// How far the rotary axes turn, all together, rad.
    pub(crate) fn turned_rad(&self) -> f64 {
        match self {
            Self::Turn { rotary_rad: [from, to], .. } => (to - from).abs().sum(),
            Self::Line(..) | Self::Arc { .. } => 0.0,
        }
    }

    /// Length of the linear axes' way, mm.
    pub(crate) fn linear_mm(&self) -> f64 {
        match self {
            Self::Turn { ends: [a, b], .. } => (b - a).norm(),
            Self::Line(..) | Self::Arc { .. } => self.length_mm(),
        }
    }

    /// [`Curve::at`] and [`Curve::tangent`] of one place.
    pub(crate) fn at_and_tangent(&self, s: f64) -> (Vector, Vector) {
        match self {
            Self::Arc { angle, sweep, .. } if s != 0.0 && s != 1.0 => {
                let turned = sin_cos(angle + sweep * s);
                (self.at_turned(s, turned), self.tangent_turned(s, turned))
            }
            _ => (self.at(s), self.tangent(s)),
        }
    }

    /// [`Curve::at`] at s = 0, ¼, ½, ¾, 1.
    pub(crate) fn at_quarters(&self) -> [Vector; 5] {
        let [_, a, b, c] = self.turned_by_quarters();
        let inside = |s: f64, turned| self.at_turned(s, turned);
        [self.at(0.0), inside(0.25, a), inside(0.5, b), inside(0.75, c), self.at(1.0)]
    }

    /// [`Curve::tangent`] there.
    pub(crate) fn tangents_at_quarters(&self) -> [Vector; 5] {
        let turned: [_; 5] = self.turned_by_quarters();
        std::array::from_fn(|k| self.tangent_turned(0.25 * k as f64, turned[k]))
    }

    /// [`Curve::at`] at s = ⅛, ⅜, ⅝, ⅞.
    pub(crate) fn at_odd_eighths(&self) -> [Vector; 4] {
        let Self::Arc { sweep, .. } = self else { return [Vector::zeros(); 4] };
        let eighth = sin_cos(0.125 * sweep);
        let turned: [_; 4] =
            turned_on(turned_on_once(self.turned_at_start(), eighth), turned_on_once(eighth, eighth));
        std::array::from_fn(|k| self.at_turned(0.125 + 0.25 * k as f64, turned[k]))
    }

    /// Sine and cosine of an arc's angle at its start and quarter by quarter on from there.
    fn turned_by_quarters<const N: usize>(&self) -> [(f64, f64); N] {
        let Self::Arc { sweep, .. } = self else { return [(0.0, 0.0); N] };
        turned_on(self.turned_at_start(), sin_cos(0.25 * sweep))
    }

    /// Sine and cosine of an arc's angle at its start: the place there tells them.
    fn turned_at_start(&self) -> (f64, f64) {
        let Self::Arc { axes: [u, v, _], centre, angle, radius: [radius, _], ends: [start, _], .. } = self
        else {
            return (0.0, 0.0);
        };
        if *radius > 0.0 {
            ((start[*v] - centre[1]) / radius, (start[*u] - centre[0]) / radius)
        } else {
            sin_cos(*angle)
        }
    }

    /// The place at s of an arc, whose angle there has this sine and cosine.
    #[inline]
    fn at_turned(&self, s: f64, (sin, cos): (f64, f64)) -> Vector {
        let Self::Arc { axes: [u, v, n], centre, radius, ends: [start, end], .. } = self else {
            return self.at(s);
        };
        let r = radius[0] + (radius[1] - radius[0]) * s;
        let mut p = Vector::zeros();
        p[*u] = centre[0] + r * cos;
        p[*v] = centre[1] + r * sin;
        p[*n] = start[*n] + (end[*n] - start[*n]) * s;
        p
    }

    /// The same of the unit tangent.
    #[inline]
    fn tangent_turned(&self, s: f64, (sin, cos): (f64, f64)) -> Vector {
        let Self::Arc { axes: [u, v, n], sweep, radius, ends: [start, end], .. } = self else {
            return self.tangent(s);
        };
        let mut t = Vector::zeros();
        let dr = radius[1] - radius[0];
        if dr.abs() <= 1e-12 * radius[0] && start[*n] == end[*n] && *sweep != 0.0 {
            // A circle but for last bits: its tangent is of length 1 as it is.
            (t[*u], t[*v]) = (-sin * sweep.signum(), cos * sweep.signum());
            return t;
        }
        let r = radius[0] + dr * s;
        t[*u] = dr * cos - r * sweep * sin;
        t[*v] = dr * sin + r * sweep * cos;
        t[*n] = end[*n] - start[*n];
        unit(t)
    }

    /// The part from s0 to s1, as a curve of its own.
    #[must_use]
    pub fn part(&self, s0: f64, s1: f64) -> Self {
        self.part_to(s0, s1, [self.at(s0), self.at(s1)])
    }

    /// The parts before and behind s.
    pub(crate) fn split(&self, s: f64) -> [Self; 2] {
        let (start, at, end) = (self.at(0.0), self.at(s), self.at(1.0));
        [self.part_to(0.0, s, [start, at]), self.part_to(s, 1.0, [at, end])]
    }

    /// The part from s0 to s1, the places there given.
    fn part_to(&self, s0: f64, s1: f64, ends: [Vector; 2]) -> Self {
        match self {
            Self::Line(..) => Self::Line(ends[0], ends[1]),
            Self::Turn { rotary_rad, .. } => {
                Self::Turn { ends, rotary_rad: [between(rotary_rad, s0), between(rotary_rad, s1)] }
            }
            Self::Arc { axes, centre, angle, sweep, radius, .. } => Self::Arc {
                axes: *axes,
                centre: *centre,
                angle: angle + sweep * s0,
                sweep: sweep * (s1 - s0),
                radius: [s0, s1].map(|s| radius[0] + (radius[1] - radius[0]) * s),
                ends,
            },
        }
    }

    /// Length, mm (an arc's mean radius stands for its small change of radius).
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        match self {
            Self::Line(a, b) => (b - a).norm(),
            Self::Turn { ends: [a, b], rotary_rad: [from, to] } => {
                ((b - a).norm_squared() + (to - from).norm_squared() * LEVER_MM * LEVER_MM).sqrt()
            }
            Self::Arc { axes: [_, _, n], sweep, radius, ends: [start, end], .. } => {
                let along = 0.5 * (radius[0] + radius[1]) * sweep;
                let rise = end[*n] - start[*n];
                (along * along + rise * rise).sqrt()
            }
        }
    }

    /// How far the tangent turns in all, rad: an upper bound but for a steep spiral.
    pub fn turning_rad(&self) -> f64 {
        match self {
            Self::Line(..) | Self::Turn { .. } => 0.0,
            Self::Arc { sweep, .. } => sweep.abs() * SPIRAL,
        }
    }

    /// Largest radius of curvature's inverse, 1/mm; zero for a line. An upper bound but for a
    /// steep spiral.
    pub fn curvature(&self) -> f64 {
        match self {
            Self::Line(..) | Self::Turn { .. } => 0.0,
            Self::Arc { radius, .. } => SPIRAL / radius[0].min(radius[1]).max(1e-9),
        }
    }

    /// True where an arc's radius grows by more than [`STEEPEST`] of itself per radian: its tangent and its curvature are not
    /// those of a circle.
    pub(crate) fn is_steep_spiral(&self) -> bool {
        match self {
            Self::Line(..) | Self::Turn { .. } => false,
            Self::Arc { sweep, radius, .. } => {
                (radius[1] - radius[0]).abs() > STEEPEST * sweep.abs() * radius[0].min(radius[1])
            }
        }
    }
}

/// Sine and cosine of the sum of two angles, those of each given.
fn turned_on_once((sin, cos): (f64, f64), (sin_step, cos_step): (f64, f64)) -> (f64, f64) {
    (sin * cos_step + cos * sin_step, cos * cos_step - sin * sin_step)
}

/// Sine and cosine of an angle and step by step on from there.
fn turned_on<const N: usize>(mut next: (f64, f64), step: (f64, f64)) -> [(f64, f64); N] {
    std::array::from_fn(|_| {
        let now = next;
        next = turned_on_once(now, step);
        now
    })
}

/// At s on the way between two ends, which are reached to the bit.
pub(crate) fn between([a, b]: &[Vector; 2], s: f64) -> Vector {
    if s >= 1.0 { *b } else { a + (b - a) * s }
}

/// A vector of length 1; zero where there is none.
fn unit(v: Vector) -> Vector {
    let length = v.norm();
    if length > 0.0 { v / length } else { Vector::zeros() }
}

/// Distance of an angle from the nearest whole turn.
pub(crate) fn wrapped(angle: f64) -> f64 {
    let rest = angle % TAU;
    rest.min(TAU - rest).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use toolpath::{Arc, Plane};

    fn arc(angle: f64, sweep: f64, r0: f64, r1: f64, rise: f64) -> Curve {
        let place = |angle: f64, r: f64, z: f64| {
            let (sin, cos) = sin_cos(angle);
            Vector::new(10.0 + r * cos, -5.0 + r * sin, z)
        };
        Curve::Arc {
            axes: Plane::Xy.axes(),
            centre: [10.0, -5.0],
            angle,
            sweep,
            radius: [r0, r1],
            ends: [place(angle, r0, 1.0), place(angle + sweep, r1, 1.0 + rise)],
        }
    }

    #[test]
    fn a_quarter_turn() {
        let shape = Shape::Arc(Arc { plane: Plane::Xy, centre_mm: [0.0, 0.0], sweep_rad: TAU / 4.0 });
        let curve = Curve::new(Vector::new(10.0, 0.0, 0.0), Vector::new(0.0, 10.0, 4.0), &shape);
        let mid = curve.at(0.5);
        assert!((mid - Vector::new(50f64.sqrt(), 50f64.sqrt(), 2.0)).norm() < 1e-12);
        assert!((curve.tangent(0.0).y - 0.968_9).abs() < 1e-3);
    }

    #[test]
    fn coinciding_ends_are_a_full_circle() {
        let p = Vector::new(5.0, 0.0, 0.0);
        for sense in [-1.0, 1.0] {
            let Curve::Arc { sweep, .. } = Curve::from_centre(p, p, Plane::Xy.axes(), [0.0, 0.0], sense)
            else {
                panic!()
            };
            assert_eq!(sweep, sense * TAU);
        }
    }

    proptest! {
        #[test]
        fn extents_and_difference_bounds_hold(
            angle in -4.0f64..4.0, sweep in -6.3f64..6.3, r in 0.5f64..200.0, dr in -0.01f64..0.01,
            turned in -0.01f64..0.01, grown in -0.05f64..0.05, s0 in 0.0f64..0.9, h in 0.01f64..1.0, rise in -3.0f64..3.0,
        ) {
            let s1 = (s0 + h).min(1.0);
            let curve = arc(angle, sweep, r, r + dr, rise);
            let near = arc(angle + turned, sweep + turned, r + grown, r + grown, rise);
            let extent = curve.extent(s0, s1);
            let f = |s: f64| curve.at(s) - near.at(s);
            let (f0, f1) = (f(s0), f(s1));
            let bound = curve.difference_bound(&near, s0, s1);
            let part = curve.part(s0, s1);
            let (quarters, eighths) = (curve.at_quarters(), curve.at_odd_eighths());
            for k in 0..4 {
                prop_assert!((quarters[k] - curve.at(0.25 * k as f64)).norm() < 1e-12 * (1.0 + r));
                prop_assert!((eighths[k] - curve.at(0.125 + 0.25 * k as f64)).norm() < 1e-12 * (1.0 + r));
            }
            let [before, behind] = curve.split(s0);
            prop_assert_eq!(before, curve.part(0.0, s0));
            prop_assert_eq!(behind, curve.part(s0, 1.0));
            let (rough, exact) = (curve.extent_by(&curve.at_quarters()).unwrap(), curve.extent(0.0, 1.0));
            for k in 0..=64 {
                let x = f64::from(k) / 64.0;
                let s = s0 + (s1 - s0) * x;
                let p = curve.at(s);
                let whole = curve.at(x);
                prop_assert!((part.at(x) - p).norm() < 1e-9);
                for i in 0..3 {
                    prop_assert!(extent.range[i].low - 1e-9 <= p[i] && p[i] <= extent.range[i].high + 1e-9);
                }
                for i in 0..3 {
                    prop_assert!(rough.range[i].low - 1e-9 <= whole[i] && whole[i] <= rough.range[i].high + 1e-9);
                    prop_assert!(exact.speed[i] <= rough.speed[i] + 1e-12 && exact.acceleration[i] <= rough.acceleration[i] + 1e-12);
                }
                let e = 1e-5;
                let slope = (part.at(x + e) - part.at(x - e)) / (2.0 * e);
                let bend = (part.at(x + e) - 2.0 * p + part.at(x - e)) / (e * e);
                for i in 0..3 {
                    prop_assert!(slope[i].abs() <= extent.speed[i] + 1e-4 * (1.0 + extent.speed[i]));
                    prop_assert!(bend[i].abs() <= extent.acceleration[i] + 1e-2 * (1.0 + r));
                }
                let off = (f(s) - (f0 * (1.0 - x) + f1 * x)).norm();
                prop_assert!(off <= bound + 1e-9, "{} > {}", off, bound);
            }
        }
    }
}
