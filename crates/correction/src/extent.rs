//! Between what bounds a curve stays, and how fast it goes there.

use std::f64::consts::TAU;

use machine_model::{Range, Vector, Volume};
use smallvec::SmallVec;
use units::math::{atan2, sin_cos};

use crate::curve::{Curve, wrapped};
use machine_model::SAME_PLACE_MM;

/// So often the angle by which a spiral's tangent leans is worked out anew: each time what is left is its square, of 0.1 at most.
const LEANS: u32 = 5;

/// What bounds need to know of a part of a curve.
#[derive(Clone, Copy, Debug)]
pub struct Extent {
    /// Box of all places.
    pub range: [Range; 3],
    /// Upper bounds of the first derivative per axis.
    pub speed: [f64; 3],
    /// Upper bounds of the second derivative per axis.
    pub acceleration: [f64; 3],
}

impl Curve {
    /// Where, of the motion, an axis turns, in order. Of a [steep spiral](Self::is_steep_spiral) not all such places.
    pub(crate) fn turns(&self) -> SmallVec<[f64; 4]> {
        let Self::Arc { angle, sweep, radius, .. } = self else { return SmallVec::new() };
        if *sweep == 0.0 {
            return SmallVec::new();
        }
        let quarter = TAU / 4.0;
        // A circle's axes turn at its quadrants, a spiral's where the tangent leans to: by atan(r'/r) further.
        let growth = (radius[1] - radius[0]) / sweep;
        let ahead = |at: f64| {
            let mut lean = 0.0;
            for _ in 0..LEANS {
                let radius = radius[0] + (at + lean - angle) * growth;
                lean = atan2(growth, radius.max(SAME_PLACE_MM));
            }
            lean
        };
        let (low, high) = (angle.min(angle + sweep), angle.max(angle + sweep));
        let mut turns: SmallVec<[f64; 4]> = SmallVec::new();
        let mut k = (low / quarter).floor() - 1.0;
        while k <= high / quarter + 1.0 {
            let s = (k * quarter + ahead(k * quarter) - angle) / sweep;
            if s > 0.0 && s < 1.0 {
                turns.push(s);
            }
            k += 1.0;
        }
        if *sweep < 0.0 {
            turns.reverse();
        }
        turns
    }

    /// The most that an axis goes back against a direction, wherever on the way, mm; 0 for no direction.
    pub(crate) fn goes_back_mm(&self, direction: [i8; 3]) -> [f64; 3] {
        let mut places: SmallVec<[Vector; 6]> = SmallVec::from_slice(&[self.at(0.0)]);
        places.extend(self.turns().into_iter().map(|s| self.at(s)));
        places.push(self.at(1.0));
        let steep = self.is_steep_spiral().then(|| self.extent(0.0, 1.0));
        std::array::from_fn(|axis| {
            let heading = f64::from(direction[axis]);
            let (mut furthest, mut back) = (f64::NEG_INFINITY, 0.0_f64);
            for place in &places {
                let along = place[axis] * heading;
                furthest = furthest.max(along);
                back = back.max(furthest - along);
            }
            match &steep {
                // Nothing is known but the box.
                Some(extent) if heading != 0.0 && extent.acceleration[axis] > 0.0 => {
                    extent.range[axis].high - extent.range[axis].low
                }
                _ => back,
            }
        })
    }

    /// Box of the part from s0 to s1, and upper bounds of first and second derivative per axis on it,
    /// with s running 0..=1 over that part.
    pub fn extent(&self, s0: f64, s1: f64) -> Extent {
        let h = s1 - s0;
        match self {
            Self::Line(a, b) | Self::Turn { ends: [a, b], .. } => {
                let (p, q) = (self.at(s0), self.at(s1));
                let speed = (b - a) * h;
                Extent {
                    range: [0, 1, 2].map(|i| Range { low: p[i].min(q[i]), high: p[i].max(q[i]) }),
                    speed: [0, 1, 2].map(|i| speed[i].abs()),
                    acceleration: [0.0; 3],
                }
            }
            Self::Arc { axes: [u, v, n], centre, angle, sweep, radius, ends: [start, end] } => {
                let r = radius[0].max(radius[1]);
                let dr = (radius[1] - radius[0]).abs() * h;
                let turn = sweep.abs() * h;
                let (from, to) = (angle + sweep * s0, angle + sweep * s1);
                let ((sin_from, cos_from), (sin_to, cos_to)) = (sin_cos(from), sin_cos(to));
                let first = range_between(from, to, cos_from, cos_to);
                let second = range_between(from - TAU / 4.0, to - TAU / 4.0, sin_from, sin_to);
                let spread = (radius[1] - radius[0]).abs();
                let in_plane = |c: f64, (low, high): (f64, f64)| Range {
                    low: c + r * low - spread,
                    high: c + r * high + spread,
                };
                let [a, b] = [s0, s1].map(|s| start[*n] + (end[*n] - start[*n]) * s);
                let mut extent = Extent {
                    range: [Range { low: 0.0, high: 0.0 }; 3],
                    speed: [0.0; 3],
                    acceleration: [0.0; 3],
                };
                extent.range[*u] = in_plane(centre[0], first);
                extent.range[*v] = in_plane(centre[1], second);
                extent.range[*n] = Range { low: a.min(b), high: a.max(b) };
                // d/ds (r cos θ) = r' cos θ - r θ' sin θ: the largest |cos| and |sin| on the part bound it.
                let largest = |(low, high): (f64, f64)| low.abs().max(high.abs());
                let (cos, sin) = (largest(first), largest(second));
                extent.speed[*u] = dr * cos + r * turn * sin;
                extent.speed[*v] = dr * sin + r * turn * cos;
                extent.speed[*n] = (b - a).abs();
                extent.acceleration[*u] = r * turn * turn * cos + 2.0 * dr * turn * sin;
                extent.acceleration[*v] = r * turn * turn * sin + 2.0 * dr * turn * cos;
                extent
            }
        }
    }

    /// [`Curve::extent`] of all of an arc that turns once at most, from its places at s = 0, ¼, ½, ¾, 1: quicker, and rougher. `None`
    /// for a line.
    pub(crate) fn extent_by(&self, places: &[Vector; 5]) -> Option<Extent> {
        let Self::Arc { axes: [_, _, n], ends: [start, end], .. } = self else { return None };
        let (speed, acceleration) = self.fastest(0.0, 1.0)?;
        // A quarter of the motion leaves its chord by at most an eighth of its second derivative.
        let bow = acceleration / (8.0 * 16.0);
        let [first, rest @ ..] = places;
        let (mut low, mut high) = (*first, *first);
        for place in rest {
            (low, high) = (low.inf(place), high.sup(place));
        }
        let range = std::array::from_fn(|axis| {
            let bow = if axis == *n { 0.0 } else { bow };
            Range { low: low[axis] - bow, high: high[axis] + bow }
        });
        let (mut speeds, mut accelerations) = ([speed; 3], [acceleration; 3]);
        (speeds[*n], accelerations[*n]) = ((end[*n] - start[*n]).abs(), 0.0);
        Some(Extent { range, speed: speeds, acceleration: accelerations })
    }

    /// Upper bounds of the first and second derivative of any axis on the part from s0 to s1, with s running 0..=1
    /// over that part: quicker than [`Curve::extent`], and rougher. `None` for a line, where they would be no rougher.
    pub(crate) fn fastest(&self, s0: f64, s1: f64) -> Option<(f64, f64)> {
        let Self::Arc { axes: [_, _, n], sweep, radius, ends: [start, end], .. } = self else { return None };
        let h = s1 - s0;
        let (r, turn) = (radius[0].max(radius[1]), sweep.abs() * h);
        let (growth, rise) = ((radius[1] - radius[0]).abs() * h, (end[*n] - start[*n]).abs() * h);
        Some(((r * turn + growth).max(rise), r * turn * turn + 2.0 * growth * turn))
    }

    /// True where all of the circle that an arc is a part of lies in the volume.
    pub(crate) fn lies_inside(&self, volume: &Volume) -> bool {
        match self {
            Self::Line(a, b) | Self::Turn { ends: [a, b], .. } => volume.contains(a) && volume.contains(b),
            Self::Arc { axes: [u, v, n], centre, radius, ends: [start, end], .. } => {
                let r = radius[0].max(radius[1]);
                let holds = |axis: usize, low: f64, high: f64| {
                    volume.0[axis].low <= low && high <= volume.0[axis].high
                };
                holds(*u, centre[0] - r, centre[0] + r)
                    && holds(*v, centre[1] - r, centre[1] + r)
                    && holds(*n, start[*n].min(end[*n]), start[*n].max(end[*n]))
            }
        }
    }

    /// Upper bound of how far the difference of two curves leaves its chord on the part s0..s1, mm.
    ///
    /// |f − chord| ≤ sup|f''|/8 on a unit interval, with f the difference.
    pub fn difference_bound(&self, other: &Self, s0: f64, s1: f64) -> f64 {
        let h2 = (s1 - s0) * (s1 - s0);
        match (self, other) {
            (Self::Line(..), Self::Line(..)) | (Self::Turn { .. }, Self::Turn { .. }) => 0.0,
            (Self::Line(..), Self::Arc { sweep, radius, .. })
            | (Self::Arc { sweep, radius, .. }, Self::Line(..)) => {
                let (r, dr) = (radius[0].max(radius[1]), (radius[1] - radius[0]).abs());
                h2 / 8.0 * (r * sweep * sweep + 2.0 * dr * sweep.abs())
            }
            (
                Self::Arc { angle: a0, sweep: w, radius: r, axes, .. },
                Self::Arc { angle: b0, sweep: v, radius: q, axes: other_axes, .. },
            ) if axes == other_axes => {
                // r e(θ)·w² against q e(φ)·v², plus the radial growth terms. Each radius is up to its spread below its largest.
                let apart = if (w - v).abs() < TAU / 2.0 {
                    wrapped((a0 - b0).abs()).max(wrapped((a0 + w - b0 - v).abs()))
                } else {
                    // Once around each other they are as far apart as unit vectors can be.
                    2.0
                };
                let (rm, qm) = (r[0].max(r[1]), q[0].max(q[1]));
                let spread = (r[1] - r[0]).abs().max((q[1] - q[0]).abs());
                let size = (rm * w * w - qm * v * v).abs() + spread * (w * w).max(v * v);
                h2 / 8.0
                    * (size
                        + rm * w * w * apart
                        + 2.0 * (r[1] - r[0]).abs() * w.abs()
                        + 2.0 * (q[1] - q[0]).abs() * v.abs())
            }
            _ => f64::INFINITY,
        }
    }
}

/// Smallest and largest cosine between two angles, whose cosines these are.
pub(crate) fn range_between(from: f64, to: f64, cos_from: f64, cos_to: f64) -> (f64, f64) {
    let (low, high) = (from.min(to), from.max(to));
    let holds = |phase: f64| ((high - phase) / TAU).floor() >= ((low - phase) / TAU).ceil();
    (
        if holds(TAU / 2.0) { -1.0 } else { cos_from.min(cos_to) },
        if holds(0.0) { 1.0 } else { cos_from.max(cos_to) },
    )
}
