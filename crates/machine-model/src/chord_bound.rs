//! How far the rigid-body error can leave its chord: equations (10) to (12) of `docs/equations.md`.
//!
//! The error is built from the tool towards the workpiece as in [`crate::RigidBody`], but with upper bounds
//! of the absolute value, of the first and second derivative along the stretch, and of the sum of jumps
//! of the first derivative, component by component.

use pulp::{Simd, f64x4};

use crate::axis_tables::SixBounds;
use crate::everywhere::Everywhere;
use crate::lanes::{Components, Together, together};
use crate::length::{Carried, Length};
use crate::link::Link;
use crate::{Command, Move, Range, RigidBody};

/// How far beyond the volume the box of a stretch may reach by rounding, mm.
const ROUNDING_MM: f64 = 1e-9;

/// Bounds of three components along the stretch parameter.
#[derive(Clone, Copy)]
struct Growth<S> {
    /// Upper bounds of the absolute values.
    value: Components<S>,
    /// Upper bounds of |first derivative|.
    first: Components<S>,
    /// Bounds of the second derivative with sign: on an even run contributions of the axes may cancel.
    low: Components<S>,
    high: Components<S>,
    /// Sum of the jumps of the first derivative, each weighted with 4s(1-s) where its place s is known.
    jumps: Components<S>,
}

impl<S: Simd<f64s = f64x4>> Growth<S> {
    /// Of what has this value and does not change.
    #[inline(always)]
    fn constant(value: Components<S>) -> Self {
        let zero = value.all(0.0);
        Self { value, first: zero, low: zero, high: zero, jumps: zero }
    }
    /// Upper bound of |second derivative|.
    #[inline(always)]
    fn second(&self) -> Components<S> {
        self.high.max(self.low.negative())
    }
    /// Upper bound of the distance from the chord, mm.
    #[inline(always)]
    fn leaves_chord_mm(&self) -> f64 {
        (self.jumps.scaled(0.25) + self.second().scaled(0.125)).norm()
    }
    /// A contribution to the second derivative of unknown sign.
    #[inline(always)]
    fn either(&mut self, by: Components<S>) {
        self.low = self.low - by;
        self.high = self.high + by;
    }
    #[inline(always)]
    fn add(&mut self, by: &Self) {
        self.value = self.value + by.value;
        self.first = self.first + by.first;
        self.low = self.low + by.low;
        self.high = self.high + by.high;
        self.jumps = self.jumps + by.jumps;
    }
}

/// What speeds and ranges of a stretch say together.
#[derive(Clone, Copy, PartialEq)]
enum Course {
    /// One motion: an axis without acceleration that is as fast as its range is long runs evenly from end to end.
    Own,
    /// Every motion that is no faster, anywhere in the ranges: how long they are says nothing of how an axis runs.
    Any,
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
#[inline(always)]
fn along<S: Simd<f64s = f64x4>>(simd: S, bounds: &SixBounds, from: usize, run: Run) -> Growth<S> {
    let Run { speed, acceleration, passes, even } = run;
    let kinks = Components::of(simd, if even { &bounds.kinks_on_line } else { &bounds.kinks }, from);
    let slope = Components::of(simd, &bounds.slope, from);
    let mut low = Components::of(simd, &bounds.curvature_low, from);
    let mut high = Components::of(simd, &bounds.curvature_high, from);
    if !even {
        // Where the speed is only bounded its square may be anything down to zero.
        low = low.min(low.all(0.0));
        high = high.max(high.all(0.0));
    }
    Growth {
        value: Components::of(simd, &bounds.value, from),
        first: slope.scaled(speed),
        low: low.scaled(speed).scaled(speed) - slope.scaled(acceleration),
        high: high.scaled(speed).scaled(speed) + slope.scaled(acceleration),
        jumps: kinks.scaled(speed).scaled(passes),
    }
}

/// What lies beyond an axis, from its measuring line on, as an interval and as it grows.
struct Beyond<S> {
    low: Components<S>,
    high: Components<S>,
    growth: Growth<S>,
}

/// Adds bounds of `ε × x`, component by component: product rule, first order of equation (11).
#[inline(always)]
fn add_cross<S: Simd<f64s = f64x4>>(sum: &mut Growth<S>, e: &Growth<S>, beyond: &Beyond<S>) {
    // The next component of the one with the one after that of the other, and the other way round.
    add_product(sum, &next(e), &next_in(&next_in(beyond)));
    add_product(sum, &next(&next(e)), &negative(&next_in(beyond)));
}

/// The components in the order Y, Z, X.
#[inline(always)]
fn next<S: Simd<f64s = f64x4>>(of: &Growth<S>) -> Growth<S> {
    Growth {
        value: of.value.next(),
        first: of.first.next(),
        low: of.low.next(),
        high: of.high.next(),
        jumps: of.jumps.next(),
    }
}

/// The same of what lies beyond.
#[inline(always)]
fn next_in<S: Simd<f64s = f64x4>>(of: &Beyond<S>) -> Beyond<S> {
    Beyond { low: of.low.next(), high: of.high.next(), growth: next(&of.growth) }
}

/// The other way round.
#[inline(always)]
fn negative<S: Simd<f64s = f64x4>>(of: &Beyond<S>) -> Beyond<S> {
    Beyond { low: of.high.negative(), high: of.low.negative(), growth: of.growth }
}

/// Adds bounds of a product.
#[inline(always)]
fn add_product<S: Simd<f64s = f64x4>>(sum: &mut Growth<S>, e: &Growth<S>, beyond: &Beyond<S>) {
    let x = &beyond.growth;
    sum.value = sum.value + e.value * x.value;
    sum.first = sum.first + (e.first * x.value + e.value * x.first);
    // All products of a number of one interval with one of the other.
    let (a, b) = (e.low * beyond.low, e.low * beyond.high);
    let (c, d) = (e.high * beyond.low, e.high * beyond.high);
    sum.low = sum.low + a.min(b).min(c).min(d);
    sum.high = sum.high + a.max(b).max(c).max(d);
    sum.either(e.first.scaled(2.0) * x.first + e.value * x.second());
    sum.jumps = sum.jumps + (e.jumps * x.value + e.value * x.jumps);
}

/// Adds bounds of `(R - I - [ε]×)·x`, by norms: second and higher orders of equation (11).
///
/// The exponential series of R from its square term on, with `e^w ≤ 1/(1-w)`. The sum of a vector's components stands for
/// its length, which is no more: these orders are a thousandth of the first, and roots would take longer than all of it.
#[inline(always)]
fn add_higher_orders<S: Simd<f64s = f64x4>>(sum: &mut Growth<S>, e: &Growth<S>, x: &Growth<S>) {
    let (w, w1, w2, wj) = (e.value.sum(), e.first.sum(), e.second().sum(), e.jumps.sum());
    let over = if w < 0.5 { 1.0 / (1.0 - w) } else { units::math::exp(w) };
    let value = 0.5 * w * w * over;
    let first = w1 * w * over;
    let second = (w1 * w1 + w2 * w) * over;
    let jumps = wj * w * over;
    let (v, v1, v2, vj) = (x.value.sum(), x.first.sum(), x.second().sum(), x.jumps.sum());
    let all = sum.value;
    sum.value = sum.value + all.all(value * v);
    sum.first = sum.first + all.all(first * v + value * v1);
    sum.either(all.all(second * v + 2.0 * first * v1 + value * v2));
    sum.jumps = sum.jumps + all.all(jumps * v + value * vj);
}

/// Upper bound, mm, of the distance between the error and its chord over the stretch: equation (12).
///
/// For stretches inside the volume along which no rotary axis turns. Real arithmetic: rounding may add some 1e-13 mm.
pub(crate) fn chord_bound_mm(model: &RigidBody, stretch: &Move) -> f64 {
    let own = |link: &Link, range: Range, bounds: &mut SixBounds| own_tables(stretch, link, range, bounds);
    let bounded = together(Along { model, stretch, course: Course::Own, bounds: own, carried: None });
    bounded.leaves_chord_mm + model.table_gain(&stretch.state) * norm(&stretch.acceleration_mm) / 8.0
}

/// The volume holds every place of the stretch.
pub(crate) fn lies_inside(model: &RigidBody, stretch: &Move) -> bool {
    stretch
        .range_mm
        .iter()
        .zip(&model.volume.0)
        .all(|(range, known)| known.low - ROUNDING_MM <= range.low && range.high <= known.high + ROUNDING_MM)
}

/// Bounds of the tables of an axis for the direction in which it moves; false where it has none.
fn own_tables(stretch: &Move, link: &Link, range: Range, bounds: &mut SixBounds) -> bool {
    let tables = link.tables(stretch.state.direction[link.axis]);
    tables.map(|tables| tables.bounds_into(range, bounds)).is_some()
}

/// Bounds of the error of the linear axes, (8), with what a head carries.
pub(crate) fn linear_error(model: &RigidBody, stretch: &Move, carried: &Carried) -> Length {
    let own = |link: &Link, range: Range, bounds: &mut SixBounds| own_tables(stretch, link, range, bounds);
    together(Along { model, stretch, course: Course::Own, bounds: own, carried: Some(carried) }).error
}

#[inline]
fn norm(v: &[f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// What holds for every straight stretch inside the volume; `None` where the model has no such bounds.
///
/// The bounds of [`chord_bound_mm`] grow with everything they are made of, so that those of the whole volume, of
/// all directions, and of the worst place for a kink hold for each stretch: equation (12). That one axis runs evenly is
/// nothing that a volume says, be it as long as a class of speeds.
pub(crate) fn everywhere(model: &RigidBody, state: &Command) -> Everywhere {
    let volume = model.volume;
    let stretch = |speed: f64, passes: u8| Move {
        range_mm: volume.0,
        speed_mm: [speed; 3],
        acceleration_mm: [0.0; 3],
        passes,
        state: *state,
        turn: None,
    };
    let worst = model.worst_bounds();
    let bounded = |class: usize, speed: f64, passes: u8| {
        let worst = |link: &Link, _: Range, bounds: &mut SixBounds| {
            worst[link.axis].as_ref().map(|worst| *bounds = worst[class]).is_some()
        };
        together(Along {
            model,
            stretch: &stretch(speed, passes),
            course: Course::Any,
            bounds: worst,
            carried: None,
        })
    };
    // Along any unit direction no axis is faster than 1.
    let gradient = bounded(0, 1.0, 1).gradient;
    let longest = Everywhere::longest_mm();
    let bow =
        |passes: u8| std::array::from_fn(|class| bounded(class, longest[class], passes).leaves_chord_mm);
    Everywhere {
        gradient,
        volume,
        bow_mm: bow(1),
        bow_of_two_passes_mm: bow(2),
        bow_of_four_passes_mm: bow(4),
    }
}

/// Bounds along a stretch; `bounds` writes those of an axis' tables, or says that there are none.
struct Along<'a, F> {
    model: &'a RigidBody,
    stretch: &'a Move,
    course: Course,
    bounds: F,
    /// What a head that turns carries; `None` where nothing turns.
    carried: Option<&'a Carried>,
}

/// What is known of the error along a stretch.
struct Bounded {
    /// Upper bound of its first derivative.
    gradient: f64,
    /// Upper bound of its distance from its chord, mm.
    leaves_chord_mm: f64,
    /// The error itself; asked for where something is carried only.
    error: Length,
}

impl<F: Fn(&Link, Range, &mut SixBounds) -> bool> Together for Along<'_, F> {
    type Output = Bounded;

    #[inline(always)]
    fn with<S: Simd<f64s = f64x4>>(self, simd: S) -> Bounded {
        let Self { model, stretch, course, bounds, carried } = self;
        let volume = model.volume;
        let vector = Components::vector;
        let (mut low, mut high, mut nominal_speed, mut nominal_acceleration, mut error);
        if let Some(carried) = carried {
            (low, high) = (vector(simd, &carried.low), vector(simd, &carried.high));
            (nominal_speed, nominal_acceleration) = (low.all(carried.first), low.all(carried.second));
            let Length { value, first, second, jumps } = carried.error;
            error = Growth::constant(low.all(value));
            (error.first, error.jumps) = (low.all(first), low.all(jumps));
            error.either(low.all(second));
        } else {
            let (tool, tool_error) = model.tool_for_bounds(&stretch.state);
            (low, high) = (vector(simd, &tool), vector(simd, &tool));
            let zero = low.all(0.0);
            (nominal_speed, nominal_acceleration) = (zero, zero);
            error = Growth::constant(vector(simd, &tool_error).abs());
        }
        let passes = f64::from(stretch.passes);
        let mut tables = SixBounds::default();
        for link in model.links.iter().rev() {
            let axis = link.axis;
            let (speed, acceleration) = (stretch.speed_mm[axis], stretch.acceleration_mm[axis]);
            let mut range = stretch.range_mm[axis];
            range.low = range.low.max(volume.0[axis].low);
            range.high = range.high.min(volume.0[axis].high);
            if bounds(link, range, &mut tables) {
                // What lies beyond this axis, from the measuring line on: x = nominal + error - lever.
                let lever = vector(simd, &link.measured_lever_mm);
                let mut beyond = Beyond {
                    low: low - lever - error.value,
                    high: high - lever + error.value,
                    growth: error,
                };
                beyond.growth.value = beyond.low.abs().max(beyond.high.abs());
                beyond.growth.first = beyond.growth.first + nominal_speed;
                beyond.growth.either(nominal_acceleration);
                let as_fast_as_long = (range.high - range.low - speed).abs() <= 1e-9 * speed;
                let even = course == Course::Own && acceleration == 0.0 && as_fast_as_long;
                let run = Run { speed, acceleration, passes, even };
                let angle = along(simd, &tables, 3, run);
                error.add(&along(simd, &tables, 0, run));
                add_cross(&mut error, &angle, &beyond);
                add_higher_orders(&mut error, &angle, &beyond.growth);
            }
            let farthest = range.low.abs().max(range.high.abs());
            let tilt = vector(simd, &link.tilt).abs();
            error.value = error.value + tilt.scaled(farthest);
            error.first = error.first + tilt.scaled(speed);
            error.either(tilt.scaled(acceleration));
            let way = vector(simd, &link.way);
            low = low + way.scaled(range.low);
            high = high + way.scaled(range.high);
            nominal_speed = nominal_speed + way.scaled(speed);
            nominal_acceleration = nominal_acceleration + way.scaled(acceleration);
        }
        Bounded {
            gradient: error.first.norm(),
            leaves_chord_mm: error.leaves_chord_mm(),
            error: carried.map_or_else(Length::default, |_| Length {
                value: error.value.norm(),
                first: error.first.norm(),
                second: error.second().norm(),
                jumps: error.jumps.norm(),
            }),
        }
    }
}
