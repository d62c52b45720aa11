//! G5 and G5.1: curves of one block.

use diagnostic::{Text, both};
use nc_syntax::Letters;
use nc_syntax::dialect::CurveCode;
use toolpath::{Bezier, Division, Feed, MOST_DEGREE, Motion, Position, Shape};

use super::{CurvePart, is_curve, plane_axes, refuse};
use crate::frames::settle;
use crate::modal::{Modal, MotionMode, Units};
use crate::motion::{Moved, feed_rate};
use crate::position::{end, require_frame, require_known};
use crate::settings::Environment;
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
                return Err(refuse(
                    words,
                    words.span(BACK),
                    both!("P or Q in a quadratic curve", "P или Q в квадратичной кривой"),
                    both!("it has one control point, I and J", "контрольная точка у неё одна, I и J"),
                )
                .help(both!("write G5 for a cubic curve", "для кубической кривой напишите G5")));
            }
            (CurveCode::Quadratic, ..) => {
                return Err(refuse(
                    words,
                    words.span(AXIS_LETTERS.or(OFFSETS)),
                    both!("{code} without both I and J", "{code} без I и J"),
                    both!("the control point was expected", "ожидалась контрольная точка"),
                )
                .help(both!(
                    "write I and J: from the start to the control point",
                    "напишите I и J: от начала до контрольной точки"
                )));
            }
            (_, offsets, [Some(p), Some(q)]) => {
                let offset = match (offsets, before.curve_leaves_mm) {
                    ([Some(i), Some(j)], _) => [i, j],
                    ([None, None], Some(leaves)) => leaves,
                    ([None, None], None) => {
                        return Err(refuse(
                            words,
                            words.span(AXIS_LETTERS),
                            both!("the first {code} without I and J", "первый {code} без I и J"),
                            both!(
                                "no curve leads here that it could go on from",
                                "сюда не ведёт кривая, которую он мог бы продолжить"
                            ),
                        )
                        .help(both!(
                            "write I and J: from the start to the first control point",
                            "напишите I и J: от начала до первой контрольной точки"
                        )));
                    }
                    _ => {
                        return Err(refuse(
                            words,
                            words.span(OFFSETS),
                            both!("{code} with only one of I and J", "{code} только с одним из I и J"),
                            both!("both or neither were expected", "ожидались оба или ни одного"),
                        )
                        .help(both!("write both I and J", "напишите и I, и J")));
                    }
                };
                (&[beside(&from, offset), beside(&to, [p, q])], Some([-p, -q]))
            }
            _ => {
                return Err(refuse(
                    words,
                    words.span(AXIS_LETTERS.or(BACK)),
                    both!("{code} without both P and Q", "{code} без P и Q"),
                    both!("the second control point was expected", "ожидалась вторая контрольная точка"),
                )
                .help(both!(
                    "write P and Q: from the end to the second control point",
                    "напишите P и Q: от конца до второй контрольной точки"
                )));
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
