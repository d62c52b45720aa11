//! The geometry of a feed motion.

use machine_model::Vector;
use toolpath::{Feed, Position, Shape};
use units::math::{atan2, sin_cos};

/// The path of a feed motion in axis commands: a line, or an arc whose radius and normal axis run linearly with the
/// angle; rotary axes turn in step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    start: Position,
    end: Position,
    arc: Option<Turning>,
}

/// An arc as its angle and radius run.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Turning {
    /// First, second and normal axis.
    axes: [usize; 3],
    centre_mm: [f64; 2],
    angle_rad: f64,
    sweep_rad: f64,
    /// At both ends.
    radius_mm: [f64; 2],
}

impl Way {
    /// Of a feed motion.
    #[must_use]
    pub fn of(feed: &Feed) -> Self {
        let arc = match feed.shape {
            // A curve by control points is given as lines.
            Shape::Line | Shape::Bezier(_) => None,
            Shape::Arc(arc) => {
                let axes = arc.plane.axes();
                let from_centre = |p: &Position| {
                    let [u, v] = [0, 1].map(|k| p.linear_mm[axes[k]] - arc.centre_mm[k]);
                    (u, v, (u * u + v * v).sqrt())
                };
                let (u, v, from) = from_centre(&feed.start);
                let (.., to) = from_centre(&feed.end);
                Some(Turning {
                    axes,
                    centre_mm: arc.centre_mm,
                    angle_rad: atan2(v, u),
                    sweep_rad: arc.sweep_rad,
                    radius_mm: [from, to],
                })
            }
        };
        Self { start: feed.start, end: feed.end, arc }
    }

    /// A straight line between two places, the rotary axes standing.
    pub(crate) fn line(start: Position, end: Position) -> Self {
        Self { start, end, arc: None }
    }

    /// The place at s, 0 ≤ s ≤ 1, mm.
    #[must_use]
    pub fn at(&self, s: f64) -> Vector {
        // The ends themselves, not what is left of them after a subtraction and an addition.
        if s <= 0.0 {
            return self.start.linear_mm.into();
        }
        if s >= 1.0 {
            return self.end.linear_mm.into();
        }
        let [from, to] = [&self.start, &self.end].map(|p| Vector::from(p.linear_mm));
        let mut at = from + (to - from) * s;
        if let Some(Turning { axes: [u, v, _], centre_mm, angle_rad, sweep_rad, radius_mm }) = &self.arc {
            let radius = radius_mm[0] + (radius_mm[1] - radius_mm[0]) * s;
            let (sin, cos) = sin_cos(angle_rad + sweep_rad * s);
            (at[*u], at[*v]) = (centre_mm[0] + radius * cos, centre_mm[1] + radius * sin);
        }
        at
    }

    /// A, B, C at s, rad.
    pub(crate) fn rotary_rad(&self, s: f64) -> Vector {
        let [from, to] = [&self.start, &self.end].map(|p| Vector::from(p.rotary_deg.map(f64::to_radians)));
        if from == to { to } else { from + (to - from) * s }
    }

    pub(crate) const fn end_rotary_deg(&self) -> [f64; 3] {
        self.end.rotary_deg
    }

    /// True where neither an arc nor a turn bends it, seen from the workpiece.
    pub(crate) fn is_straight(&self) -> bool {
        self.arc.is_none() && self.start.rotary_deg == self.end.rotary_deg
    }

    /// How far the tangent turns, rad.
    #[must_use]
    pub fn turning_rad(&self) -> f64 {
        self.arc.as_ref().map_or(0.0, |arc| arc.sweep_rad.abs())
    }

    /// The largest radius, mm, and what of an arc's way goes along its normal axis, 0 to 1; 0 for a line.
    pub(crate) fn radius_and_steepness(&self) -> (f64, f64) {
        self.arc.as_ref().map_or((0.0, 0.0), |arc| {
            let rise = (self.end.linear_mm[arc.axes[2]] - self.start.linear_mm[arc.axes[2]]).abs();
            (arc.radius_mm[0].max(arc.radius_mm[1]), rise / self.length_mm().max(1e-9))
        })
    }

    /// How far the rotary axes turn, rad, all together.
    pub(crate) fn rotary_turn_rad(&self) -> f64 {
        (self.rotary_rad(1.0) - self.rotary_rad(0.0)).abs().sum()
    }

    /// Length of the linear axes' way, mm.
    #[must_use]
    pub fn length_mm(&self) -> f64 {
        let chord = self.at(1.0) - self.at(0.0);
        match &self.arc {
            None => chord.norm(),
            Some(Turning { axes: [.., n], sweep_rad, radius_mm, .. }) => {
                let around = 0.5 * (radius_mm[0] + radius_mm[1]) * sweep_rad;
                (around * around + chord[*n] * chord[*n]).sqrt().max(chord.norm())
            }
        }
    }

    /// The places where an axis of an arc turns back, 0 to 1, in order.
    #[must_use]
    pub fn turns(&self) -> Vec<f64> {
        let Some(Turning { axes, angle_rad, sweep_rad, radius_mm, .. }) = &self.arc else {
            return Vec::new();
        };
        const QUARTER: f64 = std::f64::consts::FRAC_PI_2;
        // Of a circle at its quadrants; a spiral or a helix turns a little aside of them.
        let (from, to) = (angle_rad / QUARTER, (angle_rad + sweep_rad) / QUARTER);
        let (low, high) = (from.min(to), from.max(to));
        let mut found = Vec::new();
        let mut quadrant = low.ceil();
        while quadrant <= high {
            let s = (quadrant - from) / (to - from);
            // Along the plane's second axis at odd quadrants, along its first at even ones.
            let axis = axes[usize::from((quadrant % 2.0).abs() > 0.5)];
            // Aside by so little that the axis goes less than 10 nm on.
            let circle = (radius_mm[1] - radius_mm[0]).abs() < 1e-3 * radius_mm[0] * sweep_rad.abs();
            found.push(if circle { s } else { self.turning_place(axis, s) });
            quadrant += 1.0;
        }
        found.retain(|s| *s > 1e-12 && *s < 1.0 - 1e-12);
        found.sort_by(f64::total_cmp);
        found
    }

    /// Where an axis stands farthest near s.
    fn turning_place(&self, axis: usize, s: f64) -> f64 {
        let reach = (0.1 / self.turning_rad().max(0.1)).min(0.5);
        let (mut low, mut high) = ((s - reach).max(0.0), (s + reach).min(1.0));
        let middle = self.at(s.clamp(0.0, 1.0))[axis];
        let sign = if middle * 2.0 >= self.at(low)[axis] + self.at(high)[axis] { 1.0 } else { -1.0 };
        for _ in 0..60 {
            let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if sign * (self.at(a)[axis] - self.at(b)[axis]) < 0.0 { low = a } else { high = b }
        }
        0.5 * (low + high)
    }
}
