//! G6.2: a NURBS with its knots.

use diagnostic::{Diagnostic, Refusal, Text, both};
use nc_dialect::CurveCode;
use nc_syntax::{Letters, Span};
use toolpath::{MOST_DEGREE, Nurbs, NurbsFault, Position};

use super::faults::{every_knot, of_fault, order_refused, weight_refused};
use super::parts::{POINT_LETTERS, cut, is_curve, not_skipped, plane_axes};
use super::points::both_axes;
use crate::codes;
use crate::environment::Environment;
use crate::frame_state::settle;
use crate::modal::{Distance, Modal, MotionMode};
use crate::moved::{CurvePart, Moved};
use crate::position::{end, require_frame, require_known};
use crate::refusals::curves as refusal;
use crate::under_way::CurveBegun;
use crate::words::{LINEAR_LETTERS, Outcome, Words};

/// A block of G6.2.
pub(super) fn knot(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    moved: &mut Moved,
    form: CurveCode,
) -> Outcome<()> {
    let written = words.codes.iter().any(is_curve);
    let span = words.span(POINT_LETTERS);
    not_incremental(words, state, span)?;
    not_skipped(words, span)?;
    settle(words, state)?;
    let frame = require_frame(env, words, state)?.clone();
    let start = require_known(words, &state.axes, &Text::pair("the curve", "кривая"))?;
    let axes = words.letters.and(LINEAR_LETTERS);
    let in_plane = form == CurveCode::PlaneKnots;
    if in_plane {
        both_axes(words, plane_axes(words, state, form, span)?)?;
    }
    let first = before.curve.is_none();
    let mut begun = match state.curve.take() {
        Some(begun) => begun,
        None if !written => return Err(words.refuse(refusal::WORDS_BEHIND_END_OF_CURVE, span)),
        None => Box::new(begin(words, form, start, axes, span)?),
    };
    if written && !first && !axes.is_empty() {
        let message = both!("a curve begins inside another", "кривая начинается внутри другой");
        let label =
            both!("the one of line {} lacks knots", "той, что в строке {}, не хватает узлов", begun.line);
        return Err(
            words.refuse(Refusal { code: codes::CURVE, message, label, help: every_knot(&begun) }, span)
        );
    }
    order(words, &mut begun, form, span)?;
    next_knot(words, &mut begun, form, span)?;
    if !axes.is_empty() {
        let weight = weight_of(words, &begun, axes)?;
        let place = end(words, state, &frame)?;
        let place = require_known(words, &place, &Text::pair("the curve", "кривая"))?.linear_mm;
        if first && (0..3).any(|i| (place[i] - start.linear_mm[i]).abs() > SAME_MM) {
            return Err(starts_elsewhere(words));
        }
        begun.add(words, place, weight)?;
    } else if words.has(R) {
        return Err(words.refuse(refusal::WEIGHT_WITHOUT_CONTROL_POINT, words.span(R)));
    }
    let (points, order) = (begun.points_mm.len(), begun.degree + 1);
    if begun.knots.len() > points && points < order {
        return Err(of_fault(words, span, &NurbsFault::TooFewPoints { points, order }));
    }
    if begun.knots.len() < points + order {
        state.curve = Some(begun);
        moved.curve = Some(CurvePart::Said);
        return Ok(());
    }
    if in_plane {
        state.motion = MotionMode::None;
    }
    let CurveBegun { degree, points_mm, weights, knots, start, axes, .. } = *begun;
    cut(words, state, moved, &Nurbs { degree, points_mm, weights, knots }, &start, axes, span)
}

const K: Letters = Letters::of(b"K");
const R: Letters = Letters::of(b"R");

fn not_incremental(words: &Words<'_, '_, '_>, state: &Modal, span: Span) -> Outcome<()> {
    if state.distance == Distance::Absolute {
        return Ok(());
    }
    Err(words.refuse(refusal::CONTROL_POINTS_UNDER_G91, span))
}

/// Nothing but where it starts is known of a curve.
fn begin(
    words: &Words<'_, '_, '_>,
    form: CurveCode,
    start: Position,
    axes: Letters,
    span: Span,
) -> Outcome<CurveBegun> {
    if axes.is_empty() {
        return Err(words.refuse(refusal::CURVE_WITHOUT_FIRST_CONTROL_POINT, span));
    }
    let line = words.block.line;
    let (points_mm, weights, knots) = (vec![], vec![], vec![]);
    let at = words.block.file_range();
    Ok(CurveBegun { line, at, form, start, degree: 3, points_mm, weights, knots, axes, pointed: None })
}

/// P in the first block.
fn order(words: &Words<'_, '_, '_>, begun: &mut CurveBegun, form: CurveCode, span: Span) -> Outcome<()> {
    let (first, in_plane) = (begun.knots.is_empty(), form == CurveCode::PlaneKnots);
    if let Some(order) = words.whole(b'P')? {
        let most = if in_plane { MOST_DEGREE as u32 + 1 } else { 4 };
        if !first || !(2..=most).contains(&order) {
            return Err(order_refused(words, b'P', first.then_some([2, most])));
        }
        begun.degree = order as usize - 1;
    } else if first && in_plane {
        return Err(words.refuse(refusal::CURVE_WITHOUT_ORDER_P, span));
    }
    Ok(())
}

/// K, not before the one in front of it.
fn next_knot(words: &Words<'_, '_, '_>, begun: &mut CurveBegun, form: CurveCode, span: Span) -> Outcome<()> {
    let Some(knot) = words.coordinate(b'K', false) else {
        return Err(words.refuse(refusal::BLOCK_WITHOUT_KNOT, span));
    };
    if form == CurveCode::Knots {
        begun.as_pointed(words)?;
    }
    if begun.knots.last().is_some_and(|last| knot < *last) {
        let found = words.text(words.span(K));
        return Err(words.refuse(refusal::knots_decrease(found), words.span(K)));
    }
    begun.knots.push(knot);
    Ok(())
}

/// The weight of a control point that names the axes of the first.
fn weight_of(words: &Words<'_, '_, '_>, begun: &CurveBegun, axes: Letters) -> Outcome<f64> {
    let span = words.span(LINEAR_LETTERS);
    if begun.knots.len() > begun.points_mm.len() + 1 {
        return Err(words.refuse(refusal::CONTROL_POINT_BEHIND_KNOTS_ALONE, span));
    }
    if axes != begun.axes {
        return Err(words.refuse(refusal::control_point_names_other_axes(&begun.axes.names()), span));
    }
    match words.coordinate(b'R', false).unwrap_or(1.0) {
        weight if weight > 0.0 => Ok(weight),
        _ => Err(weight_refused(words, R)),
    }
}

fn starts_elsewhere(words: &Words<'_, '_, '_>) -> Box<Diagnostic> {
    words.refuse(refusal::FIRST_CONTROL_POINT_ELSEWHERE, words.span(LINEAR_LETTERS))
}

/// A first control point this near to where the axes stand is that place, mm.
const SAME_MM: f64 = 1e-6;
