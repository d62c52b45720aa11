//! How far the rigid-body error can leave its chord: equations (10) to (12) of `docs/equations.md`.
//!
//! The error is built from the tool towards the workpiece as in [`crate::RigidBody`], but with upper bounds
//! of the absolute value, of the first and second derivative along the stretch, and of the sum of jumps
//! of the first derivative, component by component.

use crate::axis_tables::SixBounds;
use crate::everywhere::Everywhere;
use crate::rigid_body::Link;
use crate::{Command, Move, Range, RigidBody, Vector};

/// How far beyond the volume the box of a stretch may reach by rounding, mm.
const ROUNDING_MM: f64 = 1e-9;

/// Bounds of three components along the stretch parameter.
#[derive(Clone, Copy, Debug, Default)]
struct Growth {
    /// Upper bounds of the absolute values.
    value: [f64; 3],
    /// Upper bounds of |first derivative|.
    first: [f64; 3],
    /// Bounds of the second derivative with sign: on an even run contributions of the axes may cancel.
    low: [f64; 3],
    high: [f64; 3],
    /// Sum of the jumps of the first derivative, each weighted with 4s(1-s) where its place s is known.
    jumps: [f64; 3],
}

impl Growth {
    /// Upper bound of |second derivative|.
    fn second(&self, i: usize) -> f64 {
        self.high[i].max(-self.low[i])
    }
    /// Upper bound of the distance from the chord, mm.
    fn leaves_chord_mm(&self) -> f64 {
        norm(&std::array::from_fn(|i| self.jumps[i] / 4.0 + self.second(i) / 8.0))
    }
    /// A contribution to the second derivative of unknown sign.
    fn either(&mut self, i: usize, by: f64) {
        self.low[i] -= by;
        self.high[i] += by;
    }
    fn add(&mut self, by: &Self) {
        for i in 0..3 {
            self.value[i] += by.value[i];
            self.first[i] += by.first[i];
            self.low[i] += by.low[i];
            self.high[i] += by.high[i];
            self.jumps[i] += by.jumps[i];
        }
    }
}

/// How one axis moves over the stretch.
#[derive(Clone, Copy)]
struct Run {
    speed: f64,
    acceleration: f64,
    passes: f64,
    /// Evenly from one end of its range to the other: the place of a kink and the sign of f'' are known.
    even: bool,
}

/// Three of the six functions along the stretch: the chain rule on table bounds, equation (10).
#[inline]
fn along(bounds: &SixBounds, from: usize, run: Run) -> Growth {
    let Run { speed, acceleration, passes, even } = run;
    let kinks = if even { &bounds.kinks_on_line } else { &bounds.kinks };
    let by = |f: &dyn Fn(usize) -> f64| std::array::from_fn(|i| f(from + i));
    // Where the speed is only bounded its square may be anything down to zero.
    let least = |v: f64| if even { v } else { v.min(0.0) };
    let most = |v: f64| if even { v } else { v.max(0.0) };
    Growth {
        value: by(&|i| bounds.value[i]),
        first: by(&|i| bounds.slope[i] * speed),
        low: by(&|i| least(bounds.curvature_low[i]) * speed * speed - bounds.slope[i] * acceleration),
        high: by(&|i| most(bounds.curvature_high[i]) * speed * speed + bounds.slope[i] * acceleration),
        jumps: by(&|i| kinks[i] * speed * passes),
    }
}

/// What lies beyond an axis, from its measuring line on, as an interval and as it grows.
struct Beyond {
    low: Vector,
    high: Vector,
    growth: Growth,
}

/// Adds bounds of `ε × x`, component by component: product rule, first order of equation (11).
#[inline]
fn add_cross(sum: &mut Growth, e: &Growth, beyond: &Beyond) {
    let x = &beyond.growth;
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for (a, b, minus) in [(j, k, false), (k, j, true)] {
            sum.value[i] += e.value[a] * x.value[b];
            sum.first[i] += e.first[a] * x.value[b] + e.value[a] * x.first[b];
            let (low, high) = product([e.low[a], e.high[a]], [beyond.low[b], beyond.high[b]]);
            let (low, high) = if minus { (-high, -low) } else { (low, high) };
            sum.low[i] += low;
            sum.high[i] += high;
            sum.either(i, 2.0 * e.first[a] * x.first[b] + e.value[a] * x.second(b));
            sum.jumps[i] += e.jumps[a] * x.value[b] + e.value[a] * x.jumps[b];
        }
    }
}

/// All products of a number of one interval with one of another.
#[inline]
fn product([a, b]: [f64; 2], [c, d]: [f64; 2]) -> (f64, f64) {
    let all = [a * c, a * d, b * c, b * d];
    (all.into_iter().fold(f64::INFINITY, f64::min), all.into_iter().fold(f64::NEG_INFINITY, f64::max))
}

#[inline]
fn norm(v: &[f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// Adds bounds of `(R - I - [ε]×)·x`, by norms: second and higher orders of equation (11).
///
/// The exponential series of R from its square term on, with `e^w ≤ 1/(1-w)`.
#[inline]
fn add_higher_orders(sum: &mut Growth, e: &Growth, x: &Growth) {
    let second_of = |g: &Growth| norm(&std::array::from_fn(|i| g.second(i)));
    let (w, w1, w2, wj) = (norm(&e.value), norm(&e.first), second_of(e), norm(&e.jumps));
    let over = if w < 0.5 { 1.0 / (1.0 - w) } else { units::math::exp(w) };
    let value = 0.5 * w * w * over;
    let first = w1 * w * over;
    let second = (w1 * w1 + w2 * w) * over;
    let jumps = wj * w * over;
    let (v, v1, v2, vj) = (norm(&x.value), norm(&x.first), second_of(x), norm(&x.jumps));
    for i in 0..3 {
        sum.value[i] += value * v;
        sum.first[i] += first * v + value * v1;
        sum.either(i, second * v + 2.0 * first * v1 + value * v2);
        sum.jumps[i] += jumps * v + value * vj;
    }
}

/// Upper bound, mm, of the distance between the error and its chord over the stretch: equation (12).
///
/// Real arithmetic: rounding may add some 1e-13 mm. Infinite where the stretch leaves the volume.
pub(crate) fn chord_bound_mm(model: &RigidBody, stretch: &Move) -> f64 {
    let volume = crate::Engine::volume(model);
    let leaves = |axis: usize| {
        let (range, known) = (stretch.range_mm[axis], volume.0[axis]);
        !(known.low - ROUNDING_MM <= range.low && range.high <= known.high + ROUNDING_MM)
    };
    if (0..3).any(leaves) {
        return f64::INFINITY;
    }
    let growth = growth(model, stretch, |link, range| {
        link.tables(stretch.state.direction[link.axis]).map(|tables| tables.bounds(range))
    });
    growth.leaves_chord_mm() + model.table_gain(&stretch.state) * norm(&stretch.acceleration_mm) / 8.0
}

/// What holds for every straight stretch inside the volume; `None` where the model has no such bounds.
///
/// The bounds of [`chord_bound_mm`] grow with everything they are made of, so that those of the whole volume, of
/// all directions, and of the worst place for a kink hold for each stretch: equation (12).
pub(crate) fn everywhere(model: &RigidBody, state: &Command) -> Everywhere {
    let volume = crate::Engine::volume(model);
    let stretch = |speed: f64, passes: u8| Move {
        range_mm: volume.0,
        speed_mm: [speed; 3],
        acceleration_mm: [0.0; 3],
        passes,
        state: *state,
    };
    let worst = model.worst_bounds();
    let bounded = |class: usize, speed: f64, passes: u8| {
        growth(model, &stretch(speed, passes), |link, _| {
            worst[link.axis].as_ref().map(|bounds| bounds[class])
        })
    };
    // Along any unit direction no axis is faster than 1.
    let gradient = norm(&bounded(0, 1.0, 1).first);
    let longest = Everywhere::longest_mm();
    let bow =
        |passes: u8| std::array::from_fn(|class| bounded(class, longest[class], passes).leaves_chord_mm());
    Everywhere {
        gradient,
        volume,
        bow_mm: bow(1),
        bow_of_two_passes_mm: bow(2),
        bow_of_four_passes_mm: bow(4),
    }
}

/// Bounds along a stretch, `bounds` being those of an axis' tables.
fn growth(model: &RigidBody, stretch: &Move, bounds: impl Fn(&Link, Range) -> Option<SixBounds>) -> Growth {
    let volume = crate::Engine::volume(model);
    let (tool, tool_error) = model.tool_for_bounds(&stretch.state);
    let (mut low, mut high): (Vector, Vector) = (tool, tool);
    let (mut nominal_speed, mut nominal_acceleration) = ([0.0; 3], [0.0; 3]);
    let mut error = Growth { value: tool_error.abs().into(), ..Growth::default() };
    let passes = f64::from(stretch.passes);
    for link in model.links.iter().rev() {
        let axis = link.axis;
        let (speed, acceleration) = (stretch.speed_mm[axis], stretch.acceleration_mm[axis]);
        let mut range = stretch.range_mm[axis];
        range.low = range.low.max(volume.0[axis].low);
        range.high = range.high.min(volume.0[axis].high);
        if let Some(bounds) = bounds(link, range) {
            // What lies beyond this axis, from the measuring line on: x = nominal + error - lever.
            let off = Vector::from(error.value);
            let mut beyond = Beyond {
                low: low - link.measured_lever_mm - off,
                high: high - link.measured_lever_mm + off,
                growth: error,
            };
            for i in 0..3 {
                beyond.growth.value[i] = beyond.low[i].abs().max(beyond.high[i].abs());
                beyond.growth.first[i] += nominal_speed[i];
                beyond.growth.either(i, nominal_acceleration[i]);
            }
            let even = acceleration == 0.0 && (range.high - range.low - speed).abs() <= 1e-9 * speed;
            let run = Run { speed, acceleration, passes, even };
            let angle = along(&bounds, 3, run);
            error.add(&along(&bounds, 0, run));
            add_cross(&mut error, &angle, &beyond);
            add_higher_orders(&mut error, &angle, &beyond.growth);
        }
        let farthest = range.low.abs().max(range.high.abs());
        for i in 0..3 {
            let tilt = link.tilt[i].abs();
            error.value[i] += tilt * farthest;
            error.first[i] += tilt * speed;
            error.either(i, tilt * acceleration);
        }
        low[axis] += range.low;
        high[axis] += range.high;
        nominal_speed[axis] += speed;
        nominal_acceleration[axis] += acceleration;
    }
    error
}
