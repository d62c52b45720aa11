//! Curves by control points: G5, G5.1, G5.2 with G5.3, G6.2.
//!
//! LinuxCNC's as its interpreter reads them (`interp_convert.cc`: `convert_spline`, `convert_nurbs`; G5.2 outside the plane of
//! G17 and G6.2 since the versions behind 2.9, which refuse them), Fanuc's as the operator's manual of the series 15i has them
//! (NURBS interpolation). A curve becomes rational Bézier curves
//! ([`toolpath::Nurbs::beziers`]), each a feed motion of the block with which the curve is whole.

use diagnostic::{Diagnostic, Text, both};
use nc_syntax::dialect::CurveCode;
use nc_syntax::{Letters, Span};
use toolpath::{Bezier, Division, Feed, MOST_DEGREE, Motion, Nurbs, NurbsFault, Plane, Position, Shape};

use crate::codes;
use crate::frames::settle;
use crate::modal::{Axis, Distance, FeedMode, Modal, MotionMode, Naming, Units};
use crate::motion::{Moved, compensated, feed_rate};
use crate::position::{end, require_frame, require_known};
use crate::settings::Environment;
use crate::words::{
    AXIS_LETTERS, LINEAR, LINEAR_LETTERS, Outcome, Preparatory, ROTARY_LETTERS, Refusal, Words,
};

/// What a block is of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurvePart {
    /// It says a part of one that a later block cuts: nothing moves yet.
    Said,
    /// The curve is whole: its motions are the block's.
    Cut,
}

/// A curve of several blocks that is not whole yet.
#[derive(Clone, Debug, PartialEq)]
pub struct Begun {
    /// Line of its first block.
    pub line: u64,
    form: CurveCode,
    /// What stays as it is until the curve is whole.
    start: Position,
    degree: usize,
    /// Axis commands, mm.
    points_mm: Vec<[f64; 3]>,
    weights: Vec<f64>,
    knots: Vec<f64>,
    /// Axes that its control points name.
    axes: Letters,
    /// Whether K and R above zero have a decimal point, where one has been read.
    pointed: Option<bool>,
}

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
        CurveCode::Cubic | CurveCode::Quadratic => bezier(env, words, before, state, form, moved),
        CurveCode::Points => point(env, words, before, state, moved),
        CurveCode::End => whole_by_end(words, state, moved, span),
        CurveCode::Knots | CurveCode::PlaneKnots => {
            knot(env, words, before, state, moved, form, written.is_some())
        }
    }
}

/// A code of a curve.
fn is_curve(code: &Preparatory<'_>) -> bool {
    matches!(code.entry.action, nc_syntax::dialect::Action::Curve(_))
}

fn refuse(words: &Words<'_, '_, '_>, span: Span, message: Text, label: Text) -> Refusal {
    words.refuse(codes::CURVE, message, span, label)
}

/// What no curve goes together with, whatever its form.
fn serves(words: &Words<'_, '_, '_>, before: &Modal, state: &Modal, span: Span) -> Outcome<()> {
    let lines = || both!("let the CAM write lines or arcs", "выводите из CAM прямые или дуги");
    if compensated(before, state) {
        return Err(refuse(
            words,
            span,
            both!("a curve under cutter compensation", "кривая при коррекции на радиус"),
            both!("no control offsets it", "ни одна стойка не строит её эквидистанту"),
        )
        .help(both!(
            "cancel the compensation with G40 before it, or let the CAM write the offset path",
            "отмените перед ней коррекцию функцией G40 или выводите эквидистанту из CAM"
        )));
    }
    if words.has(ROTARY_LETTERS) {
        return Err(refuse(
            words,
            words.span(ROTARY_LETTERS),
            both!("a rotary axis in a curve", "поворотная ось в кривой"),
            both!("its path is not resolved", "такой путь не разворачивается"),
        )
        .help(lines()));
    }
    if state.feed_mode == FeedMode::InverseTime {
        return Err(refuse(
            words,
            span,
            both!("a curve under G93", "кривая при G93"),
            both!(
                "the time of the whole curve or of its parts? controls differ",
                "время всей кривой или её частей? у стоек по-разному"
            ),
        )
        .help(both!("program the curve with G94", "запрограммируйте кривую при G94")));
    }
    if !state.transform.is_none() {
        let message = both!("a curve under {}", "кривая, пока действует {:#}", state.transform.name());
        return Err(refuse(
            words,
            span,
            message,
            both!(
                "controls forbid it, or differ in what it does",
                "стойки это запрещают или делают по-разному"
            ),
        )
        .help(lines()));
    }
    Ok(())
}

/// The axes of LinuxCNC's curves: those of the plane in force, of G5 and G5.1 X and Y alone.
fn plane_axes(words: &Words<'_, '_, '_>, state: &Modal, form: CurveCode, span: Span) -> Outcome<Letters> {
    let only_xy = matches!(form, CurveCode::Cubic | CurveCode::Quadratic);
    if only_xy && state.plane != Plane::Xy {
        return Err(refuse(
            words,
            span,
            both!("{} outside the plane of G17", "{} не в плоскости G17", words.text(span)),
            both!("this control cuts it in X and Y only", "эта стойка режет её только в X и Y"),
        )
        .help(both!(
            "write G17 before it, or G5.2 for another plane",
            "напишите перед ней G17, а для другой плоскости G5.2"
        )));
    }
    let [first, second, normal] = state.plane.axes();
    let across = Letters::of(&[LINEAR[normal]]);
    if words.has(across) {
        let letter = LINEAR[normal] as char;
        return Err(refuse(
            words,
            words.span(across),
            both!("{letter} in a curve of another plane", "{letter} в кривой другой плоскости"),
            both!("the control does not move it there", "стойка её здесь не перемещает"),
        )
        .help(both!(
            "select the curve's plane with G17, G18 or G19, or move {letter} in a block of its own",
            "выберите плоскость кривой функцией G17, G18 или G19 или переместите {letter} отдельным кадром"
        )));
    }
    Ok(Letters::of(&[LINEAR[first], LINEAR[second]]))
}

/// I, J, P and Q in mm, by letter.
fn lengths(words: &Words<'_, '_, '_>, state: &Modal, letters: [u8; 2]) -> [Option<f64>; 2] {
    let inch = state.units == Units::Inch;
    letters.map(|letter| words.coordinate(letter, inch).map(|value| value * state.units.mm()))
}

/// G5 and G5.1.
fn bezier(
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

/// A control point of G5.2.
fn point(
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
        Box::new(Begun {
            line,
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
            return Err(order_refused(words, b'L', !first, [3, MOST_DEGREE as u32 + 1]));
        }
        begun.degree = degree;
    }
    let weight = words.plain(b'P');
    both_axes(words, place)?;
    match weight {
        Some(weight) if weight > 0.0 => {}
        Some(_) => return Err(weight_refused(words, P)),
        None if words.has(place) => {
            return Err(refuse(
                words,
                words.span(place),
                both!("a control point without its weight P", "контрольная точка без веса P"),
                both!("the control would take -1, or the last one", "стойка взяла бы -1 или прежний"),
            )
            .help(both!("write P1 for an even curve", "для обычной кривой напишите P1")));
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
            return Err(refuse(
                words,
                words.span(P),
                both!("a weight without its control point", "вес без контрольной точки"),
                both!(
                    "only in a curve's first block it is that of the start",
                    "только в первом кадре кривой он относится к её началу"
                ),
            )
            .help(both!(
                "write X, Y and P of each control point",
                "пишите X, Y и P каждой контрольной точки"
            )));
        }
        None => {}
    }
    state.curve = Some(begun);
    moved.curve = Some(CurvePart::Said);
    Ok(())
}

/// A control point in a plane has both of its axes.
fn both_axes(words: &Words<'_, '_, '_>, axes: Letters) -> Outcome<()> {
    if !words.has(axes) || words.letters.and(axes) == axes {
        return Ok(());
    }
    let message = both!(
        "a control point with only one of {}",
        "контрольная точка только с одним словом из {}",
        axes.names()
    );
    Err(refuse(words, words.span(axes), message, both!("both were expected", "ожидались оба"))
        .help(both!("write both of each control point", "пишите оба слова каждой контрольной точки")))
}

/// G5.3: the curve is whole.
fn whole_by_end(words: &Words<'_, '_, '_>, state: &mut Modal, moved: &mut Moved, span: Span) -> Outcome<()> {
    state.motion = MotionMode::None;
    let Some(begun) = state.curve.take() else {
        return Err(refuse(
            words,
            span,
            both!("{} without G5.2 before it", "{} без G5.2 перед ней", words.text(span)),
            both!("no curve has begun", "кривая не начата"),
        )
        .help(both!(
            "begin the curve with G5.2 and its control points",
            "начните кривую функцией G5.2 и контрольными точками"
        )));
    };
    let others = POINT_LETTERS.or(Letters::of(b"IJQ"));
    if words.has(others) {
        return Err(refuse(
            words,
            words.span(others),
            both!("words beside {}", "слова рядом с {}", words.text(span)),
            both!("the control would leave them out", "стойка бы их пропустила"),
        )
        .help(both!(
            "write the last control point in a block before it",
            "напишите последнюю контрольную точку кадром раньше"
        )));
    }
    let begun = *begun;
    let nurbs = Nurbs::uniform(begun.degree, begun.points_mm, begun.weights);
    cut(words, state, moved, &nurbs, &begun.start, begun.axes, span)
}

/// A block of G6.2.
fn knot(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
    moved: &mut Moved,
    form: CurveCode,
    written: bool,
) -> Outcome<()> {
    const K: Letters = Letters::of(b"K");
    const R: Letters = Letters::of(b"R");
    let span = words.span(POINT_LETTERS);
    if state.distance == Distance::Incremental {
        return Err(refuse(
            words,
            span,
            both!("a curve's control points under G91", "контрольные точки кривой при G91"),
            both!(
                "from the start, or from the point before? manuals do not say",
                "от начала или от прежней точки? руководства молчат"
            ),
        )
        .help(both!("write them under G90", "напишите их при G90")));
    }
    not_skipped(words, span)?;
    settle(words, state)?;
    let frame = require_frame(env, words, state)?.clone();
    let start = require_known(words, &state.axes, &Text::pair("the curve", "кривая"))?;
    let axes = words.letters.and(LINEAR_LETTERS);
    let in_plane = form == CurveCode::PlaneKnots;
    if in_plane {
        both_axes(words, plane_axes(words, state, form, span)?)?;
    }
    let mut begun = match state.curve.take() {
        Some(begun) => begun,
        None if written && !axes.is_empty() => {
            let line = words.block.line;
            let (points_mm, weights) = (vec![], vec![]);
            Box::new(Begun {
                line,
                form,
                start,
                degree: 3,
                points_mm,
                weights,
                knots: vec![],
                axes,
                pointed: None,
            })
        }
        None if written => {
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
        None => {
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
    };
    let first = before.curve.is_none();
    if written && !first && !axes.is_empty() {
        let message = both!("a curve begins inside another", "кривая начинается внутри другой");
        let label =
            both!("the one of line {} lacks knots", "той, что в строке {}, не хватает узлов", begun.line);
        return Err(refuse(words, span, message, label).help(every_knot(&begun)));
    }
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
        return Err(refuse(
            words,
            words.span(K),
            both!("the knots of a curve decrease", "узлы кривой убывают"),
            both!(
                "{} lies before the one in front of it",
                "{} меньше предыдущего",
                words.text(words.span(K))
            ),
        )
        .help(both!("write them in rising order", "пишите их по возрастанию")));
    }
    begun.knots.push(knot);
    let knots_only = begun.knots.len() > begun.points_mm.len() + 1;
    if !axes.is_empty() {
        if knots_only {
            return Err(refuse(
                words,
                words.span(LINEAR_LETTERS),
                both!("a control point behind knots alone", "контрольная точка после одних узлов"),
                both!("the control points had ended", "контрольные точки уже кончились"),
            )
            .help(both!("write the control points one after the other", "пишите контрольные точки подряд")));
        }
        if axes != begun.axes {
            return Err(refuse(
                words,
                words.span(LINEAR_LETTERS),
                both!("a control point that names other axes", "контрольная точка с другими осями"),
                both!("the first one names {}", "первая называет {}", begun.axes.names()),
            )
            .help(both!(
                "name the same axes in each control point",
                "называйте в каждой контрольной точке одни и те же оси"
            )));
        }
        let weight = words.coordinate(b'R', false).unwrap_or(1.0);
        if weight.is_nan() || weight <= 0.0 {
            return Err(weight_refused(words, R));
        }
        let place =
            require_known(words, &end(words, state, &frame)?, &Text::pair("the curve", "кривая"))?.linear_mm;
        if first && (0..3).any(|i| (place[i] - start.linear_mm[i]).abs() > SAME_MM) {
            return Err(refuse(
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
            )));
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
    if begun.knots.len() > begun.points_mm.len() && begun.points_mm.len() <= begun.degree {
        return Err(of_fault(
            words,
            span,
            &NurbsFault::TooFewPoints { points: begun.points_mm.len(), order: begun.degree + 1 },
        ));
    }
    if begun.knots.len() < begun.points_mm.len() + begun.degree + 1 {
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

/// A first control point this near to where the axes stand is that place, mm.
const SAME_MM: f64 = 1e-6;

impl Begun {
    fn add(&mut self, words: &Words<'_, '_, '_>, place_mm: [f64; 3], weight: f64) -> Outcome<()> {
        if self.points_mm.len() == MOST_POINTS {
            return Err(refuse(
                words,
                words.span(LINEAR_LETTERS),
                both!(
                    "a curve of more than {MOST_POINTS} control points",
                    "в кривой больше {MOST_POINTS} контрольных точек"
                ),
                both!("no control takes so many", "столько не принимает ни одна стойка"),
            )
            .help(both!("let the CAM write several curves", "выводите из CAM несколько кривых")));
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
                return Err(refuse(
                    words,
                    span,
                    both!(
                        "knots and weights with and without a decimal point",
                        "узлы и веса с десятичной точкой и без неё"
                    ),
                    both!(
                        "without it some controls count thousandths",
                        "без неё некоторые стойки считают тысячные"
                    ),
                )
                .help(both!("write all of them with a decimal point", "пишите их все с десятичной точкой")));
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
    let pieces = nurbs.beziers().map_err(|fault| of_fault(words, span, &fault))?;
    let at = |linear_mm| Position { linear_mm, ..*start };
    let mut from = start.linear_mm;
    for (_, end_mm, curve) in pieces {
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

fn weight_refused(words: &Words<'_, '_, '_>, letter: Letters) -> Box<Diagnostic> {
    refuse(
        words,
        words.span(letter),
        both!("a weight that is not above zero", "вес не больше нуля"),
        both!("the curve would run away from its control points", "кривая ушла бы от контрольных точек"),
    )
    .help(both!(
        "write a weight above zero; 1 for an even curve",
        "напишите вес больше нуля; для обычной кривой 1"
    ))
}

fn order_refused(
    words: &Words<'_, '_, '_>,
    letter: u8,
    late: bool,
    [least, most]: [u32; 2],
) -> Box<Diagnostic> {
    let span = words.span(Letters::of(&[letter]));
    let letter = letter as char;
    if late {
        return refuse(
            words,
            span,
            both!("the order of a curve behind its first block", "порядок кривой не в её первом кадре"),
            both!("controls differ in what it changes", "что он меняет, у стоек по-разному"),
        )
        .help(both!(
            "write {letter} in the first block of the curve",
            "напишите {letter} в первом кадре кривой"
        ));
    }
    refuse(
        words,
        span,
        both!("a curve of this order", "кривая такого порядка"),
        both!("{least} to {most} were expected", "ожидалось от {least} до {most}"),
    )
    .help(both!("let the CAM write a curve of order 3 or 4", "выводите из CAM кривую порядка 3 или 4"))
}

fn of_fault(words: &Words<'_, '_, '_>, span: Span, fault: &NurbsFault) -> Box<Diagnostic> {
    match fault {
        NurbsFault::TooFewPoints { points, order } => refuse(
            words,
            span,
            both!("too few control points", "слишком мало контрольных точек"),
            both!(
                "{points} with the start; order {order} takes {order}",
                "{points} вместе с началом; порядку {order} нужно {order}"
            ),
        )
        .help(both!(
            "write more control points, or a lower order",
            "напишите больше контрольных точек или меньший порядок"
        )),
        NurbsFault::NotClamped { at_end } => {
            let which =
                if *at_end { both!("last", "последние") } else { both!("first", "первые") };
            refuse(
                words,
                span,
                both!("the {which} knots of the curve differ", "{which:#} узлы кривой различны"),
                both!("the curve would not reach its end point", "кривая не дошла бы до своей крайней точки"),
            )
            .help(both!(
                "write the first and the last knot as often as the order says",
                "повторите первый и последний узел столько раз, каков порядок"
            ))
        }
        NurbsFault::Jumps { .. } => refuse(
            words,
            span,
            both!("too many equal knots inside a curve", "слишком много равных узлов внутри кривой"),
            both!("the curve jumps there", "там кривая имеет разрыв"),
        )
        .help(both!("write it as two curves", "напишите её двумя кривыми")),
        NurbsFault::Weight { .. } | NurbsFault::KnotsDecrease { .. } | NurbsFault::KnotCount { .. } => {
            refuse(
                words,
                span,
                both!("knots and weights that make no curve", "узлы и веса, не задающие кривой"),
                both!("looked at block by block before", "проверены раньше, кадр за кадром"),
            )
            .help(both!(
                "this is a fault of vpost; please report it with the program",
                "это ошибка vpost; сообщите о ней, приложив программу"
            ))
        }
    }
}

fn every_knot(begun: &Begun) -> Text {
    both!(
        "write as many blocks with K alone behind the control points as the order says, {}",
        "после контрольных точек напишите столько кадров с одним K, каков порядок: {}",
        begun.degree + 1
    )
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
pub(crate) fn open(words: &Words<'_, '_, '_>, begun: &Begun, span: Span) -> Box<Diagnostic> {
    let message = both!("the curve of line {} is not whole", "кривая из строки {} не окончена", begun.line);
    let label = both!("{} stands inside it", "внутри неё стоит {}", words.text(span));
    let help = match begun.form {
        CurveCode::Knots | CurveCode::PlaneKnots => every_knot(begun),
        _ => both!(
            "end the curve with G5.3 before this block",
            "закончите кривую функцией G5.3 до этого кадра"
        ),
    };
    words.refuse(codes::CURVE_OPEN, message, span, label).help(help)
}

/// A curve of several blocks is whole or not at all.
fn not_skipped(words: &Words<'_, '_, '_>, span: Span) -> Outcome<()> {
    if words.block.switches() == 0 {
        return Ok(());
    }
    Err(refuse(
        words,
        span,
        both!("a block of a curve that may be skipped", "кадр кривой, который можно пропустить"),
        both!("without it the curve is another", "без него кривая другая"),
    )
    .help(both!("write the curve in blocks without `/`", "напишите кривую кадрами без `/`")))
}

fn belongs(code: &Preparatory<'_>, form: CurveCode) -> bool {
    use nc_syntax::dialect::Action;
    match form {
        CurveCode::Points => matches!(code.entry.action, Action::Curve(CurveCode::Points | CurveCode::End)),
        _ => code.entry.action == Action::Curve(form),
    }
}
