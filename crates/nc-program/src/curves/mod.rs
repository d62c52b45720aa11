//! Curves by control points: G5, G5.1, G5.2 with G5.3, G6.2.
//!
//! LinuxCNC's as its interpreter reads them (`interp_convert.cc`: `convert_spline`, `convert_nurbs`; G5.2 outside the
//! plane of G17 and G6.2 since the versions behind 2.9, which refuse them), Fanuc's as the operator's manual of the
//! series 15i has them (NURBS interpolation). A curve becomes rational Bézier curves ([`toolpath::Nurbs::beziers`]),
//! each a feed motion of the block with which the curve is whole.

mod bezier;
mod faults;
mod knots;
mod points;

use diagnostic::{Diagnostic, Refusal, Text, both};
use nc_syntax::dialect::CurveCode;
use nc_syntax::{Letters, Span};
use toolpath::{Division, Feed, Motion, Nurbs, Plane, Position, Shape};

use crate::codes;
use crate::environment::Environment;
use crate::feed::feed_rate;
use crate::modal::{Axis, Distance, FeedMode, Modal, Naming};
use crate::moved::{CurvePart, Moved};
use crate::offset::compensated;
use crate::refusals::curves as refusal;
use crate::under_way::CurveBegun;
use crate::words::{AXIS_LETTERS, LINEAR, LINEAR_LETTERS, Outcome, Preparatory, ROTARY_LETTERS, Words};

/// More control points than any program has: the state of a program is carried from block to block.
const MOST_POINTS: usize = 4096;

/// Letters of a control point.
const POINT_LETTERS: Letters = LINEAR_LETTERS.or(Letters::of(b"PLKQR"));

/// A block in the mode of a curve.
pub(crate) fn execute(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    form: CurveCode,
    moved: &mut Moved,
) -> Outcome<()> {
    let written = words.codes.iter().find(|code| is_curve(code));
    if written.is_none() && !words.has(POINT_LETTERS.or(AXIS_LETTERS).or(Letters::of(b"IJQ"))) {
        return Ok(());
    }
    let span = written.map_or_else(|| words.span(POINT_LETTERS), |code| code.span);
    serves(words, before, state, span)?;
    match form {
        CurveCode::Cubic | CurveCode::Quadratic => bezier::bezier(env, words, before, state, form, moved),
        CurveCode::Points => points::point(env, words, before, state, moved),
        CurveCode::End => points::whole_by_end(words, state, moved, span),
        CurveCode::Knots | CurveCode::PlaneKnots => {
            knots::knot(env, words, before, state, moved, form, written.is_some())
        }
    }
}

/// A code of a curve.
fn is_curve(code: &Preparatory<'_>) -> bool {
    matches!(code.entry.action, nc_syntax::dialect::Action::Curve(_))
}

/// What no curve goes together with, whatever its form.
fn serves(words: &Words<'_, '_, '_>, before: &Modal, state: &Modal, span: Span) -> Outcome<()> {
    let lines = || both!("let the CAM write lines or arcs", "выводите из CAM прямые или дуги");
    if compensated(before, state) {
        return Err(words.refuse(refusal::CURVE_UNDER_CUTTER_COMPENSATION, span));
    }
    if words.has(ROTARY_LETTERS) {
        return Err(words.refuse(
            Refusal {
                code: codes::CURVE,
                message: both!("a rotary axis in a curve", "поворотная ось в кривой"),
                label: both!("its path is not resolved", "такой путь не разворачивается"),
                help: lines(),
            },
            words.span(ROTARY_LETTERS),
        ));
    }
    if state.feed_mode == FeedMode::InverseTime {
        return Err(words.refuse(refusal::CURVE_UNDER_G93, span));
    }
    if !state.transform.is_none() {
        let message = both!("a curve under {}", "кривая, пока действует {:#}", state.transform.name());
        return Err(words.refuse(
            Refusal {
                code: codes::CURVE,
                message,
                label: both!(
                    "controls forbid it, or differ in what it does",
                    "стойки это запрещают или делают по-разному"
                ),
                help: lines(),
            },
            span,
        ));
    }
    Ok(())
}

/// The axes of LinuxCNC's curves: those of the plane in force, of G5 and G5.1 X and Y alone.
fn plane_axes(words: &Words<'_, '_, '_>, state: &Modal, form: CurveCode, span: Span) -> Outcome<Letters> {
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
    fn add(&mut self, words: &Words<'_, '_, '_>, place_mm: [f64; 3], weight: f64) -> Outcome<()> {
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
    fn as_pointed(&mut self, words: &Words<'_, '_, '_>) -> Outcome<()> {
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
fn cut(
    words: &Words<'_, '_, '_>,
    state: &mut Modal,
    moved: &mut Moved,
    nurbs: &Nurbs,
    start: &Position,
    axes: Letters,
    span: Span,
) -> Outcome<()> {
    let rate = feed_rate(words, state)?;
    let pieces = nurbs.beziers().map_err(|fault| faults::of_fault(words, span, &fault))?;
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

/// A curve that has begun and what else stands in the block.
pub(crate) fn check(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
) -> Outcome<()> {
    if words.has(AXIS_LETTERS) || !words.codes.is_empty() || !words.commands.is_empty() {
        // Only a G5 that follows at once goes on from a G5.
        state.curve_leaves_mm = None;
    }
    let Some(begun) = &before.curve else { return Ok(()) };
    let stops = words.m_codes.iter().find(|(number, _)| {
        env.dialect
            .m_code(*number)
            .is_some_and(|row| row.ends_program || row.loses_position.contains(&true) || row.changes_tool)
    });
    let other = words.codes.iter().find(|code| !is_curve(code)).map(|code| code.span);
    let offset = words.has(Letters::of(b"DH")).then(|| words.span(Letters::of(b"DH")));
    let command = words.commands.first().map(|command| command.1);
    let other = other.or(offset).or(command);
    let form =
        words.codes.iter().find(|code| is_curve(code) && !belongs(code, begun.form)).map(|code| code.span);
    match stops.map(|(_, span)| *span).or(other).or(form) {
        Some(span) => Err(open(words, begun, span)),
        None => Ok(()),
    }
}

/// The refusal of what stands inside a curve.
pub(crate) fn open(words: &Words<'_, '_, '_>, begun: &CurveBegun, span: Span) -> Box<Diagnostic> {
    let label = both!("{} stands inside it", "внутри неё стоит {}", words.text(span));
    let help = match begun.form {
        CurveCode::Knots | CurveCode::PlaneKnots => faults::every_knot(begun),
        _ => both!(
            "end the curve with G5.3 before this block",
            "закончите кривую функцией G5.3 до этого кадра"
        ),
    };
    words.refuse(Refusal { code: codes::CURVE_OPEN, message: begun.is_not_whole(), label, help }, span)
}

impl CurveBegun {
    fn is_not_whole(&self) -> Text {
        both!("the curve of line {} is not whole", "кривая из строки {} не окончена", self.line)
    }

    /// The refusal of a program whose text ends inside the curve, and its line.
    pub(crate) fn at_the_end(&self) -> (Diagnostic, u64) {
        let label = both!("the program ends inside it", "внутри неё кончается программа");
        let help = match self.form {
            CurveCode::Knots | CurveCode::PlaneKnots => faults::every_knot(self),
            _ => both!("end the curve with G5.3", "закончите кривую функцией G5.3"),
        };
        let diagnostic = Diagnostic::error(codes::CURVE_OPEN, self.is_not_whole());
        (diagnostic.at(self.at.clone(), label).help(help), self.line)
    }
}

/// A curve of several blocks is whole or not at all.
fn not_skipped(words: &Words<'_, '_, '_>, span: Span) -> Outcome<()> {
    if words.block.switches() == 0 {
        return Ok(());
    }
    Err(words.refuse(refusal::SKIPPED_BLOCK_OF_CURVE, span))
}

fn belongs(code: &Preparatory<'_>, form: CurveCode) -> bool {
    use nc_syntax::dialect::Action;
    match form {
        CurveCode::Points => matches!(code.entry.action, Action::Curve(CurveCode::Points | CurveCode::End)),
        _ => code.entry.action == Action::Curve(form),
    }
}
