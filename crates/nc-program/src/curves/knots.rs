//! G6.2: a NURBS with its knots.

use diagnostic::{Diagnostic, Text, both};
use nc_syntax::dialect::CurveCode;
use nc_syntax::{Letters, Span};
use toolpath::{MOST_DEGREE, Nurbs, NurbsFault, Position};

use super::faults::{every_knot, of_fault, order_refused, weight_refused};
use super::points::both_axes;
use super::{Begun, CurvePart, POINT_LETTERS, cut, not_skipped, plane_axes, refuse};
use crate::frames::settle;
use crate::modal::{Distance, Modal, MotionMode};
use crate::motion::Moved;
use crate::position::{end, require_frame, require_known};
use crate::settings::Environment;
use crate::words::{LINEAR_LETTERS, Outcome, Words};

/// A block of G6.2.
pub(super) fn knot(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    moved: &mut Moved,
    form: CurveCode,
    written: bool,
) -> Outcome<()> {
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
        None => Box::new(begin(words, form, start, axes, written, span)?),
    };
    if written && !first && !axes.is_empty() {
        let message = both!("a curve begins inside another", "кривая начинается внутри другой");
        let label =
            both!("the one of line {} lacks knots", "той, что в строке {}, не хватает узлов", begun.line);
        return Err(refuse(words, span, message, label).help(every_knot(&begun)));
    }
    order(words, &mut begun, first, in_plane, span)?;
    next_knot(words, &mut begun, in_plane, span)?;
    if !axes.is_empty() {
        let weight = weight_of(words, &begun, axes)?;
        let place = end(words, state, &frame)?;
        let place = require_known(words, &place, &Text::pair("the curve", "кривая"))?.linear_mm;
        if first && (0..3).any(|i| (place[i] - start.linear_mm[i]).abs() > SAME_MM) {
            return Err(starts_elsewhere(words));
        }
        begun.add(words, place, weight)?;
    } else if words.has(R) {
        return Err(refuse(
            words,
            words.span(R),
            both!("a weight without its control point", "вес без контрольной точки"),
            both!("the control points had ended", "контрольные точки уже кончились"),
        )
        .help(both!("write R beside its control point", "пишите R рядом с его контрольной точкой")));
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
    let Begun { degree, points_mm, weights, knots, start, axes, .. } = *begun;
    cut(words, state, moved, &Nurbs { degree, points_mm, weights, knots }, &start, axes, span)
}

const K: Letters = Letters::of(b"K");
const R: Letters = Letters::of(b"R");

fn not_incremental(words: &Words<'_, '_, '_>, state: &Modal, span: Span) -> Outcome<()> {
    if state.distance == Distance::Absolute {
        return Ok(());
    }
    Err(refuse(
        words,
        span,
        both!("a curve's control points under G91", "контрольные точки кривой при G91"),
        both!(
            "from the start, or from the point before? manuals do not say",
            "от начала или от прежней точки? руководства молчат"
        ),
    )
    .help(both!("write them under G90", "напишите их при G90")))
}

/// Nothing but where it starts is known of a curve.
fn begin(
    words: &Words<'_, '_, '_>,
    form: CurveCode,
    start: Position,
    axes: Letters,
    written: bool,
    span: Span,
) -> Outcome<Begun> {
    if !written {
        return Err(refuse(
            words,
            span,
            both!("words behind the end of a curve", "слова за концом кривой"),
            both!("it has all of its knots", "все её узлы уже заданы"),
        )
        .help(both!(
            "write G0, G1, G2 or G3 behind it, or G6.2 for another curve",
            "напишите за ней G0, G1, G2 или G3, а для новой кривой G6.2"
        )));
    }
    if axes.is_empty() {
        return Err(refuse(
            words,
            span,
            both!("a curve without its first control point", "кривая без первой контрольной точки"),
            both!("the control would take where it stands", "стойка взяла бы место, где стоит"),
        )
        .help(both!(
            "write the place where the axes stand as the first control point",
            "напишите место, где стоят оси, первой контрольной точкой"
        )));
    }
    let line = words.block.line;
    let (points_mm, weights, knots) = (vec![], vec![], vec![]);
    let at = words.block.file_range();
    Ok(Begun { line, at, form, start, degree: 3, points_mm, weights, knots, axes, pointed: None })
}

/// P in the first block.
fn order(
    words: &Words<'_, '_, '_>,
    begun: &mut Begun,
    first: bool,
    in_plane: bool,
    span: Span,
) -> Outcome<()> {
    if let Some(order) = words.whole(b'P')? {
        let most = if in_plane { MOST_DEGREE as u32 + 1 } else { 4 };
        if !first || !(2..=most).contains(&order) {
            return Err(order_refused(words, b'P', !first, [2, most]));
        }
        begun.degree = order as usize - 1;
    } else if first && in_plane {
        return Err(refuse(
            words,
            span,
            both!("a curve without its order P", "кривая без порядка P"),
            both!(
                "the control would take that of the curve before",
                "стойка взяла бы порядок прежней кривой"
            ),
        )
        .help(both!(
            "write P in the first block of the curve, 4 for a cubic one",
            "напишите P в первом кадре кривой, для кубической 4"
        )));
    }
    Ok(())
}

/// K, not before the one in front of it.
fn next_knot(words: &Words<'_, '_, '_>, begun: &mut Begun, in_plane: bool, span: Span) -> Outcome<()> {
    let Some(knot) = words.coordinate(b'K', false) else {
        return Err(refuse(
            words,
            span,
            both!("a block of a curve without its knot K", "кадр кривой без узла K"),
            both!("K was expected", "ожидалось K"),
        )
        .help(both!("write K in each block of the curve", "пишите K в каждом кадре кривой")));
    };
    if !in_plane {
        begun.as_pointed(words)?;
    }
    if begun.knots.last().is_some_and(|last| knot < *last) {
        let found = words.text(words.span(K));
        return Err(refuse(
            words,
            words.span(K),
            both!("the knots of a curve decrease", "узлы кривой убывают"),
            both!("{found} lies before the one in front of it", "{found} меньше предыдущего"),
        )
        .help(both!("write them in rising order", "пишите их по возрастанию")));
    }
    begun.knots.push(knot);
    Ok(())
}

/// The weight of a control point that names the axes of the first.
fn weight_of(words: &Words<'_, '_, '_>, begun: &Begun, axes: Letters) -> Outcome<f64> {
    let span = words.span(LINEAR_LETTERS);
    if begun.knots.len() > begun.points_mm.len() + 1 {
        return Err(refuse(
            words,
            span,
            both!("a control point behind knots alone", "контрольная точка после одних узлов"),
            both!("the control points had ended", "контрольные точки уже кончились"),
        )
        .help(both!("write the control points one after the other", "пишите контрольные точки подряд")));
    }
    if axes != begun.axes {
        return Err(refuse(
            words,
            span,
            both!("a control point that names other axes", "контрольная точка с другими осями"),
            both!("the first one names {}", "первая называет {}", begun.axes.names()),
        )
        .help(both!(
            "name the same axes in each control point",
            "называйте в каждой контрольной точке одни и те же оси"
        )));
    }
    match words.coordinate(b'R', false).unwrap_or(1.0) {
        weight if weight > 0.0 => Ok(weight),
        _ => Err(weight_refused(words, R)),
    }
}

fn starts_elsewhere(words: &Words<'_, '_, '_>) -> Box<Diagnostic> {
    refuse(
        words,
        words.span(LINEAR_LETTERS),
        both!(
            "the first control point is not where the axes stand",
            "первая контрольная точка не там, где стоят оси"
        ),
        both!("the control stops here with an alarm", "стойка здесь остановится с ошибкой"),
    )
    .help(both!(
        "move to it before, or write the place where the axes stand",
        "подойдите к ней до этого или напишите место, где стоят оси"
    ))
}

/// A first control point this near to where the axes stand is that place, mm.
const SAME_MM: f64 = 1e-6;
