//! Curves by control points: G5, G5.1, G5.2 with G5.3, G6.2.
//!
//! LinuxCNC's as its interpreter reads them (`interp_convert.cc`: `convert_spline`, `convert_nurbs`; G5.2 outside the
//! plane of G17 and G6.2 since the versions behind 2.9, which refuse them), Fanuc's as the operator's manual of the
//! series 15i has them (NURBS interpolation). A curve becomes rational Bézier curves ([`toolpath::Nurbs::beziers`]),
//! each a feed motion of the block with which the curve is whole.

mod bezier;
mod faults;
mod knots;
mod parts;
mod points;

use diagnostic::{Diagnostic, Refusal, Text, both, refusal};
use nc_dialect::CurveCode;
use nc_syntax::{Letters, Span};

use crate::codes;
use crate::environment::Environment;
use crate::modal::{FeedMode, Modal};
use crate::moved::Moved;
use crate::offset::compensated;
use crate::refusals::curves as refusal;
use crate::under_way::CurveBegun;
use crate::words::{AXIS_LETTERS, Outcome, Preparatory, ROTARY_LETTERS, Words};
use parts::{POINT_LETTERS, is_curve};

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
        CurveCode::Knots | CurveCode::PlaneKnots => knots::knot(env, words, before, state, moved, form),
    }
}

/// What no curve goes together with, whatever its form.
fn serves(words: &Words<'_, '_, '_>, before: &Modal, state: &Modal, span: Span) -> Outcome<()> {
    let lines = || both!("let the CAM write lines or arcs", "выводите из CAM прямые или дуги");
    if compensated(before, state) {
        return Err(words.refuse(refusal::CURVE_UNDER_CUTTER_COMPENSATION, span));
    }
    if words.has(ROTARY_LETTERS) {
        return Err(words.refuse(
            refusal!(codes::CURVE;
                "a rotary axis in a curve", "поворотная ось в кривой";
                "its path is not resolved", "такой путь не разворачивается";
                lines()
            ),
            words.span(ROTARY_LETTERS),
        ));
    }
    if state.feed_mode == FeedMode::InverseTime {
        return Err(words.refuse(refusal::CURVE_UNDER_G93, span));
    }
    if !state.transform.is_none() {
        return Err(words.refuse(
            refusal!(codes::CURVE;
                "a curve under {}", "кривая, пока действует {:#}", state.transform.name();
                "controls forbid it, or differ in what it does", "стойки это запрещают или делают по-разному";
                lines()
            ),
            span,
        ));
    }
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

fn belongs(code: &Preparatory<'_>, form: CurveCode) -> bool {
    use nc_dialect::Action;
    match form {
        CurveCode::Points => matches!(code.entry.action, Action::Curve(CurveCode::Points | CurveCode::End)),
        _ => code.entry.action == Action::Curve(form),
    }
}
