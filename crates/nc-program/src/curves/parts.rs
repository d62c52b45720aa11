//! Points, axes and motions of a curve, whatever its form.

use nc_dialect::{Action, CurveCode};
use nc_syntax::{Letters, Span};
use toolpath::{Division, Feed, Motion, Nurbs, Plane, Position, Shape};

use super::faults::of_fault;
use crate::feed::feed_rate;
use crate::modal::{Axis, Distance, Modal, Naming};
use crate::moved::{CurvePart, Moved};
use crate::refusals::curves as refusal;
use crate::under_way::CurveBegun;
use crate::words::{LINEAR, LINEAR_LETTERS, Outcome, Preparatory, Words};

/// More control points than any program has: the state of a program is carried from block to block.
const MOST_POINTS: usize = 4096;

/// Letters of a control point.
pub(super) const POINT_LETTERS: Letters = LINEAR_LETTERS.or(Letters::of(b"PLKQR"));

/// A code of a curve.
pub(super) fn is_curve(code: &Preparatory<'_>) -> bool {
    matches!(code.entry.action, Action::Curve(_))
}

/// The axes of LinuxCNC's curves: those of the plane in force, of G5 and G5.1 X and Y alone.
pub(super) fn plane_axes(
    words: &Words<'_, '_, '_>,
    state: &Modal,
    form: CurveCode,
    span: Span,
) -> Outcome<Letters> {
    let only_xy = matches!(form, CurveCode::Cubic | CurveCode::Quadratic);
    if only_xy && state.plane != Plane::Xy {
        return Err(words.refuse_code(refusal::OUTSIDE_G17, span));
    }
    let [first, second, normal] = state.plane.axes();
    let across = Letters::of(&[LINEAR[normal]]);
    if words.has(across) {
        let letter = LINEAR[normal] as char;
        return Err(words.refuse(refusal::in_curve_another_plane(letter), words.span(across)));
    }
    Ok(Letters::of(&[LINEAR[first], LINEAR[second]]))
}

impl CurveBegun {
    pub(super) fn add(&mut self, words: &Words<'_, '_, '_>, place_mm: [f64; 3], weight: f64) -> Outcome<()> {
        if self.points_mm.len() == MOST_POINTS {
            return Err(
                words.refuse(refusal::too_many_control_points(MOST_POINTS), words.span(LINEAR_LETTERS))
            );
        }
        self.points_mm.push(place_mm);
        self.weights.push(weight);
        Ok(())
    }

    /// Knots and weights above zero all have a point, or none has: without it they count something else.
    pub(super) fn as_pointed(&mut self, words: &Words<'_, '_, '_>) -> Outcome<()> {
        for letter in [b'K', b'R'] {
            let Some((number, span)) = words.number(letter) else { continue };
            if number.decimal.mantissa == 0 {
                continue;
            }
            if *self.pointed.get_or_insert(number.has_point) != number.has_point {
                return Err(words.refuse(refusal::DECIMAL_POINTS_MIXED, span));
            }
        }
        Ok(())
    }
}

/// The motions of a whole curve.
pub(super) fn cut(
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    moved: &mut Moved,
    nurbs: &Nurbs,
    start: &Position,
    axes: Letters,
    span: Span,
) -> Outcome<()> {
    let rate = feed_rate(words, state)?;
    let pieces = nurbs.beziers().map_err(|fault| of_fault(words, span, &fault))?;
    let at = |linear_mm| Position { linear_mm, ..*start };
    let mut from = start.linear_mm;
    for (end_mm, curve) in pieces {
        let (start, end) = (at(from), at(end_mm));
        let shape = if curve.degree() == 1 { Shape::Line } else { Shape::Bezier(curve) };
        moved.motions.push(Motion::Feed(Feed { start, end, shape, rate, division: Division::Any }));
        from = end_mm;
    }
    state.axes.linear = from.map(Axis::At);
    if state.distance == Distance::Absolute {
        // Its control points have said where they are.
        for (axis, letter) in LINEAR.iter().enumerate() {
            if axes.contains(*letter) {
                (state.named[axis], moved.unnamed[axis]) = (Naming::Named, None);
            }
        }
    }
    moved.curve = Some(CurvePart::Cut);
    Ok(())
}

/// A curve of several blocks is whole or not at all.
pub(super) fn not_skipped(words: &Words<'_, '_, '_>, span: Span) -> Outcome<()> {
    if words.block.switches() == 0 {
        return Ok(());
    }
    Err(words.refuse(refusal::SKIPPED_BLOCK_OF_CURVE, span))
}
