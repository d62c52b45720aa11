//! G5.2 and G5.3: a NURBS whose knots the control chooses.

use diagnostic::Text;
use nc_dialect::CurveCode;
use nc_syntax::{Letters, Span};
use toolpath::{MOST_DEGREE, Nurbs};

use super::faults::{order_refused, weight_refused};
use super::parts::{POINT_LETTERS, cut, not_skipped, plane_axes};
use crate::environment::Environment;
use crate::frame_state::settle;
use crate::modal::{Modal, MotionMode};
use crate::moved::{CurvePart, Moved};
use crate::position::{end, require_frame, require_known};
use crate::refusals::curves as refusal;
use crate::under_way::CurveBegun;
use crate::words::{Outcome, Words};

/// A control point of G5.2.
pub(super) fn point(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    moved: &mut Moved,
) -> Outcome<()> {
    const P: Letters = Letters::of(b"P");
    let span = words.span(POINT_LETTERS);
    not_skipped(words, span)?;
    let place = plane_axes(words, state, CurveCode::Points, span)?;
    settle(words, state)?;
    let frame = require_frame(env, words, state)?.clone();
    let start = require_known(words, &state.axes, &Text::pair("the curve", "кривая"))?;
    let first = before.curve.is_none();
    let mut begun = state.curve.take().unwrap_or_else(|| {
        let line = words.block.line;
        let (points_mm, weights) = (vec![start.linear_mm], vec![1.0]);
        let form = CurveCode::Points;
        Box::new(CurveBegun {
            line,
            at: words.block.file_range(),
            form,
            start,
            degree: 2,
            points_mm,
            weights,
            knots: vec![],
            axes: place,
            pointed: None,
        })
    });
    if let Some(order) = words.whole(b'L')? {
        let degree = usize::try_from(order).unwrap_or(usize::MAX).wrapping_sub(1);
        if !first || !(2..=MOST_DEGREE).contains(&degree) {
            return Err(order_refused(words, b'L', first.then_some([3, MOST_DEGREE as u32 + 1])));
        }
        begun.degree = degree;
    }
    let weight = words.plain(b'P');
    both_axes(words, place)?;
    match weight {
        Some(weight) if weight > 0.0 => {}
        Some(_) => return Err(weight_refused(words, P)),
        None if words.has(place) => {
            return Err(words.refuse(refusal::CONTROL_POINT_WITHOUT_WEIGHT_P, words.span(place)));
        }
        None => {}
    }
    match weight {
        Some(weight) if words.has(place) => {
            // Increments count from where the axes stand, which is the curve's start until it is cut.
            let at = require_known(words, &end(words, state, &frame)?, &Text::pair("the curve", "кривая"))?;
            begun.add(words, at.linear_mm, weight)?;
        }
        Some(weight) if first => begun.weights[0] = weight,
        Some(_) => {
            return Err(words.refuse(refusal::WEIGHT_WITHOUT_POINT, words.span(P)));
        }
        None => {}
    }
    state.curve = Some(begun);
    moved.curve = Some(CurvePart::Said);
    Ok(())
}

/// A control point in a plane has both of its axes.
pub(super) fn both_axes(words: &Words<'_, '_, '_>, axes: Letters) -> Outcome<()> {
    if !words.has(axes) || words.letters.and(axes) == axes {
        return Ok(());
    }
    Err(words.refuse(refusal::half_a_control_point(&axes.names()), words.span(axes)))
}

/// G5.3: the curve is whole.
pub(super) fn whole_by_end(
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    moved: &mut Moved,
    span: Span,
) -> Outcome<()> {
    state.motion = MotionMode::None;
    let Some(begun) = state.curve.take() else {
        return Err(words.refuse_code(refusal::WITHOUT_G5_2_BEFORE, span));
    };
    let others = POINT_LETTERS.or(Letters::of(b"IJQ"));
    if words.has(others) {
        return Err(words.refuse(refusal::words_beside(&words.text(span)), words.span(others)));
    }
    let begun = *begun;
    let nurbs = Nurbs::uniform(begun.degree, begun.points_mm, begun.weights);
    cut(words, state, moved, &nurbs, &begun.start, begun.axes, span)
}
