//! How far the rigid-body error can leave its chord: equations (10) to (12) of `docs/equations.md`.
//!
//! The error is built from the tool towards the workpiece as in [`crate::RigidBody`], but with upper bounds
//! of the absolute value, of the first and second derivative along the stretch, and of the sum of jumps
//! of the first derivative, component by component.

use crate::axis_tables::SixBounds;
use crate::{Move, RigidBody, Vector};

/// How far beyond the volume the box of a stretch may reach by rounding, mm.
const ROUNDING_MM: f64 = 1e-9;

/// Bounds of three components along the stretch parameter.
#[derive(Clone, Copy, Debug, Default)]
struct Growth {
    value: [f64; 3],
    first: [f64; 3],
    second: [f64; 3],
    /// Sum of the jumps of the first derivative, each weighted with 4s(1-s) where its place s is known.
    jumps: [f64; 3],
}

/// How one axis moves over the stretch.
#[derive(Clone, Copy)]
struct Run {
    speed: f64,
    acceleration: f64,
    passes: f64,
    /// Evenly from one end of its range to the other, so that the place of a kink is known.
    even: bool,
}

/// Three of the six functions along the stretch: the chain rule on table bounds, equation (10).
#[inline]
fn along(bounds: &SixBounds, from: usize, run: Run) -> Growth {
    let Run { speed, acceleration, passes, even } = run;
    let kinks = if even { &bounds.kinks_on_line } else { &bounds.kinks };
    let by = |f: &dyn Fn(usize) -> f64| std::array::from_fn(|i| f(from + i));
    Growth {
        value: by(&|i| bounds.value[i]),
        first: by(&|i| bounds.slope[i] * speed),
        second: by(&|i| bounds.curvature[i] * speed * speed + bounds.slope[i] * acceleration),
        jumps: by(&|i| kinks[i] * speed * passes),
    }
}

/// Adds bounds of `ε × x`, component by component: product rule, first order of equation (11).
#[inline]
fn add_cross(sum: &mut Growth, e: &Growth, x: &Growth) {
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        for (a, b) in [(j, k), (k, j)] {
            sum.value[i] += e.value[a] * x.value[b];
            sum.first[i] += e.first[a] * x.value[b] + e.value[a] * x.first[b];
            sum.second[i] +=
                e.second[a] * x.value[b] + 2.0 * e.first[a] * x.first[b] + e.value[a] * x.second[b];
            sum.jumps[i] += e.jumps[a] * x.value[b] + e.value[a] * x.jumps[b];
        }
    }
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
    let (w, w1, w2, wj) = (norm(&e.value), norm(&e.first), norm(&e.second), norm(&e.jumps));
    let over = if w < 0.5 { 1.0 / (1.0 - w) } else { units::math::exp(w) };
    let value = 0.5 * w * w * over;
    let first = w1 * w * over;
    let second = (w1 * w1 + w2 * w) * over;
    let jumps = wj * w * over;
    let (v, v1, v2, vj) = (norm(&x.value), norm(&x.first), norm(&x.second), norm(&x.jumps));
    for i in 0..3 {
        sum.value[i] += value * v;
        sum.first[i] += first * v + value * v1;
        sum.second[i] += second * v + 2.0 * first * v1 + value * v2;
        sum.jumps[i] += jumps * v + value * vj;
    }
}

#[inline]
fn add(sum: &mut Growth, by: &Growth) {
    for i in 0..3 {
        sum.value[i] += by.value[i];
        sum.first[i] += by.first[i];
        sum.second[i] += by.second[i];
        sum.jumps[i] += by.jumps[i];
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
    let (tool, tool_error) = model.tool_for_bounds(&stretch.state);
    let (mut low, mut high): (Vector, Vector) = (tool, tool);
    let mut nominal = Growth::default();
    let mut error = Growth { value: tool_error.abs().into(), ..Growth::default() };
    let passes = f64::from(stretch.passes);
    for link in model.links.iter().rev() {
        let axis = link.axis;
        let (speed, acceleration) = (stretch.speed_mm[axis], stretch.acceleration_mm[axis]);
        let mut range = stretch.range_mm[axis];
        range.low = range.low.max(volume.0[axis].low);
        range.high = range.high.min(volume.0[axis].high);
        if let Some(tables) = link.tables(stretch.state.direction[axis]) {
            let bounds = tables.bounds(range);
            // What lies beyond this axis, from the measuring line on: x = nominal + error - lever.
            let mut beyond = error;
            for i in 0..3 {
                let lever = link.measured_lever_mm[i];
                beyond.value[i] += (low[i] - lever).abs().max((high[i] - lever).abs());
                beyond.first[i] += nominal.first[i];
                beyond.second[i] += nominal.second[i];
            }
            let even = acceleration == 0.0 && (range.high - range.low - speed).abs() <= 1e-9 * speed;
            let run = Run { speed, acceleration, passes, even };
            let angle = along(&bounds, 3, run);
            add(&mut error, &along(&bounds, 0, run));
            add_cross(&mut error, &angle, &beyond);
            add_higher_orders(&mut error, &angle, &beyond);
        }
        let farthest = range.low.abs().max(range.high.abs());
        for i in 0..3 {
            let tilt = link.tilt[i].abs();
            error.value[i] += tilt * farthest;
            error.first[i] += tilt * speed;
            error.second[i] += tilt * acceleration;
        }
        low[axis] += range.low;
        high[axis] += range.high;
        nominal.first[axis] += speed;
        nominal.second[axis] += acceleration;
    }
    let leave: [f64; 3] = std::array::from_fn(|i| error.jumps[i] / 4.0 + error.second[i] / 8.0);
    norm(&leave) + model.table_gain(&stretch.state) * norm(&stretch.acceleration_mm) / 8.0
}
