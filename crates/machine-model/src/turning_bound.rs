//! How far the error can leave its chord while rotary axes turn: equation (60) of `docs/equations.md`.
//!
//! The recursions (8) and (9), from the tool to the workpiece, with upper bounds of lengths. Nothing depends on the
//! frame in which a length is taken, and what a turn adds is the error times the turn: a constant tilt ε at an arm X
//! bends by `ε X ω²`, where the path itself bends by `X ω²`.

use crate::axis_tables::SixBounds;
use crate::chord_bound::linear_error;
use crate::length::{Carried, Length};
use crate::link::Link;
use crate::rotary::{Swivel, ideally_turned};
use crate::{Axis, Command, Move, Range, RigidBody, RotaryPlay, Tilt, Turn, Vector};

/// What a rotary axis does besides turning ideally by its programmed angle.
struct Wobble {
    /// How far it turns what it carries, `‖L R(ε) Rot(slip) - I‖`.
    turn: Length,
    /// How far it moves it, mm.
    shift: Length,
    /// Its programmed turn over the stretch, rad.
    speed: f64,
}

impl Wobble {
    fn of(swivel: &Swivel, axis: Axis, turn: &Turn, play: &RotaryPlay) -> Self {
        let rotary = &swivel.data;
        let direction = play.direction[axis.direction()];
        let of_axis = |ends: &[Vector; 2]| [ends[0][axis.direction()], ends[1][axis.direction()]];
        let (programmed, commanded) = (of_axis(&turn.programmed_rad), of_axis(&turn.commanded_rad));
        let lag = of_axis(&turn.lag_rad);
        let behind = swivel.behind_rad(direction);
        let slip = [0, 1].map(|end| commanded[end] + lag[end] - programmed[end] + behind);
        let slip = Length {
            value: slip[0].abs().max(slip[1].abs()),
            first: (slip[1] - slip[0]).abs(),
            ..Length::default()
        };
        let (mut shift, mut small) = (Length::default(), Length::default());
        if let Some(tables) = swivel.tables(direction) {
            let range = Range { low: commanded[0].min(commanded[1]), high: commanded[0].max(commanded[1]) };
            let bounds = tables.bounds(range);
            let speed = range.high - range.low;
            (shift, small) = (of_three(&bounds, 0, speed), of_three(&bounds, 3, speed));
        }
        // A product of rotations leaves the identity by no more than their angles together, and with their rates w its
        // second derivative is at most Σ |w'| + (Σ |w|)².
        let speed = (programmed[1] - programmed[0]).abs();
        let lean = Length::constant(rotary.tilt_rad.norm());
        let mut turn = small.plus(slip).plus(lean);
        if rotary.tilt == Tilt::Axis {
            // `L R Rot L⁻¹` is `L R (Rot L⁻¹ Rot⁻¹) Rot`: a tilt that turns with the axis.
            turn = turn.plus(lean.turned(speed));
        }
        turn.second += turn.first * turn.first;
        Self { turn, shift: shift.plus(Length::constant(rotary.shift_mm.norm())), speed }
    }
}

/// Three of the six functions of a rotary axis that turns evenly from one end of a range to the other.
fn of_three(bounds: &SixBounds, from: usize, speed: f64) -> Length {
    let norm = |six: &[f64; 6]| Vector::from_column_slice(&six[from..from + 3]).norm();
    Length {
        value: norm(&bounds.value),
        first: norm(&bounds.slope) * speed,
        second: norm(&bounds.curvature) * speed * speed,
        jumps: norm(&bounds.kinks_on_line) * speed,
    }
}

/// The ideal tool vector, from the centre of the head's outermost axis, and its error, as the head turns them.
fn tool_in_turn(model: &RigidBody, state: &Command, turn: &Turn) -> (Length, Length) {
    let (mut nominal, mut error) = (Length::constant(state.tool_mm.norm()), Length::default());
    let mut centre = Vector::zeros();
    for axis in model.description.chain.head().iter().rev() {
        let swivel = &model.swivels[axis.direction()];
        let (data, wobble) = (&swivel.data, Wobble::of(swivel, *axis, turn, &state.rotary_play));
        nominal.value += (data.centre_mm - centre).norm();
        centre = data.centre_mm;
        let real = nominal.plus(error).turned(wobble.speed);
        error = wobble.shift.plus(wobble.turn.times(real)).plus(error.turned(wobble.speed));
        nominal = nominal.turned(wobble.speed);
    }
    (nominal, error)
}

/// The error over the stretch as the linear axes see it, and how far the table turns against them, rad: equation (60).
pub(crate) fn error_in_turn(model: &RigidBody, stretch: &Move, turn: &Turn) -> (Length, f64) {
    let chain = &model.description.chain;
    let middle = Command {
        linear_mm: Vector::from_fn(|i, _| 0.5 * (stretch.range_mm[i].low + stretch.range_mm[i].high)),
        rotary_rad: 0.5 * (turn.programmed_rad[0] + turn.programmed_rad[1]),
        ..stretch.state
    };
    let (nominal, error) = tool_in_turn(model, &stretch.state, turn);
    let at_middle = model.nominal_tool(&middle);
    // From its place in the middle it goes half of its way at most.
    let reach = Vector::repeat(0.5 * nominal.first);
    let carried = Carried {
        low: at_middle - reach,
        high: at_middle + reach,
        first: nominal.first,
        second: nominal.second,
        error,
    };

    let mut error = linear_error(model, stretch, &carried);

    // The table, from the linear axes on, seen from the frame that the axes so far make: what each of them adds is seen
    // again from that of the linear axes. `nominal` is the ideal tip there, seen from the centre of the axis at hand.
    let speed = Vector::from(stretch.speed_mm).norm();
    let acceleration = Vector::from(stretch.acceleration_mm).norm();
    let mut tip = middle.linear_mm + at_middle;
    let mut nominal =
        Length { first: speed + carried.first, second: acceleration + carried.second, ..Length::default() };
    let (mut total, mut turned) = (error, 0.0);
    for axis in chain.table().iter().rev() {
        let swivel = &model.swivels[axis.direction()];
        let (data, wobble) = (&swivel.data, Wobble::of(swivel, *axis, turn, &stretch.state.rotary_play));
        // As far as in the middle of the stretch, and half of its way.
        let arm = tip - data.centre_mm;
        nominal.value = arm.norm() + 0.5 * nominal.first;
        let beyond = nominal.plus(error).plus(wobble.shift);
        let own = wobble.turn.times(beyond).plus(wobble.shift);
        total = total.plus(own.turned(turned));
        error = error.plus(own).turned(wobble.speed);
        nominal = nominal.turned(wobble.speed);
        tip = data.centre_mm + ideally_turned(data, *axis, -middle.rotary_rad[axis.direction()]) * arm;
        turned += wobble.speed;
    }
    (total, turned)
}

/// How far the angles of a linear axis turn what it carries along a stretch, `‖R(ε) - I‖`.
fn leans(link: &Link, model: &RigidBody, stretch: &Move) -> Option<Length> {
    let tables = link.tables(stretch.state.direction[link.axis])?;
    let (known, asked) = (model.volume.0[link.axis], stretch.range_mm[link.axis]);
    let range =
        Range { low: asked.low.clamp(known.low, known.high), high: asked.high.clamp(known.low, known.high) };
    let bounds = tables.bounds(range);
    let (speed, acceleration) = (stretch.speed_mm[link.axis], stretch.acceleration_mm[link.axis]);
    let even = acceleration == 0.0 && (asked.high - asked.low - speed).abs() <= 1e-9 * speed;
    let mut leans = of_three(&bounds, 3, speed);
    if !even {
        let norm = |six: &[f64; 6]| Vector::from_column_slice(&six[3..]).norm();
        leans.second += norm(&bounds.slope) * acceleration;
        leans.jumps = norm(&bounds.kinks) * speed * f64::from(stretch.passes);
    }
    leans.second += leans.first * leans.first;
    Some(leans)
}

/// The tool's real direction less that of an ideal machine with the programmed angles, over a stretch, in the directions of
/// that machine's linear axes: equation (120), the recursions of (60) for a vector of length 1 that nothing shifts.
pub(crate) fn direction_in_turn(model: &RigidBody, stretch: &Move, turn: &Turn) -> Length {
    let chain = &model.description.chain;
    let (mut nominal, mut error) = (Length::constant(1.0), Length::default());
    for axis in chain.head().iter().rev() {
        let wobble = Wobble::of(&model.swivels[axis.direction()], *axis, turn, &stretch.state.rotary_play);
        let real = nominal.plus(error).turned(wobble.speed);
        error = wobble.turn.times(real).plus(error.turned(wobble.speed));
        nominal = nominal.turned(wobble.speed);
    }
    for link in model.links.iter().rev() {
        if let Some(leans) = leans(link, model, stretch) {
            error = error.plus(leans.times(nominal.plus(error)));
        }
    }
    let (mut total, mut turned) = (error, 0.0);
    for axis in chain.table().iter().rev() {
        let wobble = Wobble::of(&model.swivels[axis.direction()], *axis, turn, &stretch.state.rotary_play);
        let own = wobble.turn.times(nominal.plus(error));
        total = total.plus(own.turned(turned));
        error = error.plus(own).turned(wobble.speed);
        nominal = nominal.turned(wobble.speed);
        turned += wobble.speed;
    }
    total
}
