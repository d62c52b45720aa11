//! G5 and G5.1: curves of one block.

use diagnostic::Text;
use nc_dialect::CurveCode;
use nc_syntax::Letters;
use toolpath::{Bezier, Division, Feed, MOST_DEGREE, Motion, Position, Shape};

use super::parts::{is_curve, plane_axes};
use crate::environment::Environment;
use crate::feed::feed_rate;
use crate::frame_state::settle;
use crate::modal::{Modal, MotionMode, Units};
use crate::moved::{CurvePart, Moved};
use crate::position::{end, require_frame, require_known};
use crate::refusals::curves as refusal;
use crate::words::{AXIS_LETTERS, Outcome, Words};

/// I, J, P and Q in mm, by letter.
fn lengths(words: &Words<'_, '_, '_>, state: &Modal, letters: [u8; 2]) -> [Option<f64>; 2] {
    let inch = state.units == Units::Inch;
    letters.map(|letter| words.coordinate(letter, inch).map(|value| value * state.units.mm()))
}

/// G5 and G5.1.
pub(super) fn bezier(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    form: CurveCode,
    moved: &mut Moved,
) -> Outcome<()> {
    const OFFSETS: Letters = Letters::of(b"IJ");
    const BACK: Letters = Letters::of(b"PQ");
    let span =
        words.codes.iter().find(|code| is_curve(code)).map_or(words.span(AXIS_LETTERS), |code| code.span);
    let code = words.text(span);
    plane_axes(words, state, form, span)?;
    settle(words, state)?;
    let frame = require_frame(env, words, state)?.clone();
    let ends = end(words, state, &frame)?;
    let what = &Text::pair("the curve", "кривая");
    let from = require_known(words, &state.axes, what)?;
    let to = require_known(words, &ends, what)?;
    let beside = |place: &Position, [u, v]: [f64; 2]| {
        let [x, y, z] = place.linear_mm;
        [x + u, y + v, z]
    };
    let (inner, leaves): (&[[f64; 3]], _) =
        match (form, lengths(words, state, *b"IJ"), lengths(words, state, *b"PQ")) {
            (CurveCode::Quadratic, [Some(i), Some(j)], [None, None]) => (&[beside(&from, [i, j])], None),
            (CurveCode::Quadratic, [Some(_), Some(_)], _) => {
                return Err(words.refuse(refusal::P_OR_Q_IN_QUADRATIC_CURVE, words.span(BACK)));
            }
            (CurveCode::Quadratic, ..) => {
                return Err(
                    words.refuse(refusal::without_i_and_j(code), words.span(AXIS_LETTERS.or(OFFSETS)))
                );
            }
            (_, offsets, [Some(p), Some(q)]) => {
                let offset = match (offsets, before.curve_leaves_mm) {
                    ([Some(i), Some(j)], _) => [i, j],
                    ([None, None], Some(leaves)) => leaves,
                    ([None, None], None) => {
                        return Err(
                            words.refuse(refusal::first_without_i_and_j(code), words.span(AXIS_LETTERS))
                        );
                    }
                    _ => {
                        return Err(words.refuse(refusal::only_one_of_i_and_j(code), words.span(OFFSETS)));
                    }
                };
                (&[beside(&from, offset), beside(&to, [p, q])], Some([-p, -q]))
            }
            _ => {
                return Err(words.refuse(refusal::without_p_and_q(code), words.span(AXIS_LETTERS.or(BACK))));
            }
        };
    let rate = feed_rate(words, state)?;
    let curve = Bezier::new(inner, &[1.0; MOST_DEGREE + 1][..inner.len() + 2]);
    let shape = Shape::Bezier(curve);
    moved.motions.push(Motion::Feed(Feed { start: from, end: to, shape, rate, division: Division::Any }));
    moved.curve = Some(CurvePart::Cut);
    state.axes = ends;
    // Whether it stays in force, LinuxCNC's manual and its interpreter tell differently: axis words alone are refused.
    state.motion = MotionMode::None;
    state.curve_leaves_mm = leaves;
    Ok(())
}
