//! What several forms of curves are refused for.

use diagnostic::{Diagnostic, Text, both};
use nc_syntax::{Letters, Span};
use toolpath::NurbsFault;

use crate::refusals::curves as refusal;
use crate::under_way::CurveBegun;
use crate::words::Words;

pub(super) fn weight_refused(words: &Words<'_, '_, '_>, letter: Letters) -> Box<Diagnostic> {
    words.refuse(refusal::WEIGHT_NOT_ABOVE_ZERO, words.span(letter))
}

/// `range`: of the orders that a first block may say.
pub(super) fn order_refused(
    words: &Words<'_, '_, '_>,
    letter: u8,
    range: Option<[u32; 2]>,
) -> Box<Diagnostic> {
    let span = words.span(Letters::of(&[letter]));
    let refusal = match range {
        Some([least, most]) => refusal::order_of_curve(least, most),
        None => refusal::order_behind_first_block(letter as char),
    };
    words.refuse(refusal, span)
}

pub(super) fn of_fault(words: &Words<'_, '_, '_>, span: Span, fault: &NurbsFault) -> Box<Diagnostic> {
    match fault {
        NurbsFault::TooFewPoints { points, order } => {
            words.refuse(refusal::too_few_control_points(points, order), span)
        }
        NurbsFault::NotClamped { at_end } => {
            let which =
                if *at_end { both!("last", "последние") } else { both!("first", "первые") };
            words.refuse(refusal::end_knots_differ(&which), span)
        }
        NurbsFault::Jumps { .. } => words.refuse(refusal::EQUAL_KNOTS_INSIDE, span),
        NurbsFault::Weight { .. } | NurbsFault::KnotsDecrease { .. } | NurbsFault::KnotCount { .. } => {
            words.refuse(refusal::KNOTS_AND_WEIGHTS_MAKE_NO_CURVE, span)
        }
    }
}

pub(super) fn every_knot(begun: &CurveBegun) -> Text {
    both!(
        "write as many blocks with K alone behind the control points as the order says, {}",
        "после контрольных точек напишите столько кадров с одним K, каков порядок: {}",
        begun.degree + 1
    )
}
