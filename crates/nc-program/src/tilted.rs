//! Tilted working planes: G68.2 says where the plane lies in the workpiece, G53.1 turns the tool upright on it, G69
//! ends it. Sinumerik's CYCLE800 does all three ([`crate::swivel`]).
//!
//! X, Y and Z are coordinates of the plane in between, and the control brings the tip to that place of the workpiece.
//! That it does so wherever the rotary axes stand no manual promises; so nothing moves in a plane on which the tool
//! does not stand upright.

use diagnostic::{Diagnostic, Refusal, Text, both, refusal};
use nc_dialect::Action;
use nc_syntax::{Letters, Span};
use smallvec::SmallVec;
use toolpath::{AXIS_NAMES, Kinematics, Motion, NoAngles, TiltedPlane, unit};

use crate::brackets::is_reset;
use crate::codes;
use crate::environment::{Demand, Environment, Owner};
use crate::frame_state::absolute;
use crate::modal::{Axis, Lost, Modal, Units, Why};
use crate::naming;
use crate::position::{require_frame, require_rotary};
use crate::refusals::tilted as refusal;
use crate::under_way::PlaneBegun;
use crate::words::{ARC_LETTERS, AXIS_LETTERS, CENTRE_LETTERS, LINEAR, LINEAR_LETTERS, Outcome, Words};

/// The tool stands upright on a plane where its direction is within this of the plane's normal, rad: whichever of the
/// two a control adds a length of 200 mm along, its end is within a micrometre.
const UPRIGHT_RAD: f64 = 5e-6;

const P: Letters = Letters::of(b"P");
const Q: Letters = Letters::of(b"Q");
const R: Letters = Letters::of(b"R");

type Three = [f64; 3];
/// Rows.
type Turn = [Three; 3];

/// What ends a plane in this dialect.
fn ending(env: &Environment<'_>) -> &'static str {
    let swivels = env.dialect.commands.iter().any(|row| row.action == Some(Action::Swivel));
    let follows = env.dialect.codes.iter().any(|row| row.action == Action::DynamicOffset);
    match (swivels, follows) {
        (true, _) => "CYCLE800()",
        (_, true) => "G255",
        _ => "G69",
    }
}

/// Whether a code ends the plane that is in force.
fn ends(words: &Words<'_, '_, '_>) -> bool {
    let by_command =
        |(action, span): &(&Action, Span)| **action == Action::Swivel && is_reset(&words.text(*span));
    let off = |action: &Action| matches!(action, Action::RotationOff | Action::DynamicOffsetOff);
    words.codes.iter().any(|code| off(&code.entry.action)) || words.commands.iter().any(by_command)
}

/// Refuses what tilts the plane where the profile does not say what the control computes with.
pub(crate) fn declared(env: &Environment<'_>, words: &Words<'_, '_, '_>, span: Span) -> Outcome<()> {
    let unknown = env
        .setup
        .tip_control
        .unknown(&both!("no path in it", "в ней"), &both!("tilted planes", "наклонных плоскостей"));
    let Some((label, help)) = unknown else { return Ok(()) };
    let code = words.text(span);
    Err(words.refuse(
        refusal!(codes::TILTED_PLANE;
            "{code} is refused: it tilts the working plane",
            "{code} не принимается: она наклоняет рабочую плоскость";
            label; help
        ),
        span,
    ))
}

/// G68.2.
///
/// * P0, or none – Euler angles: I about Z, J about the new X, K about the new Z
/// * P1 – with Q123 one of I, J, K about the workpiece's X, Y or Z (roll, pitch, yaw); of several at once controls differ
/// * P2 – Q1, Q2, Q3: the plane's zero, a point on its +X, one on the side of its +Y
/// * P3 – Q1, Q2: its zero and the direction of its X, the direction of its Z
pub(crate) fn define(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<()> {
    let code = words.text(span);
    may_begin(env, words, span, state)?;
    absolute(words, span, state)?;
    // Some posts write `R0.` with each plane.
    if words.coordinate(b'R', false).is_some_and(|angle| angle != 0.0) {
        return Err(beside(words, span, R, refusal::TURN_ABOUT_THE_ZERO));
    }
    let origin = match words.whole(b'P')?.unwrap_or(0) {
        form @ (0 | 1) => {
            if state.plane_begun.is_some() {
                return Err(unfinished(words, span));
            }
            Some((point(words, span, state)?, by_angles(words, span, form)?))
        }
        form @ (2 | 3) => by_blocks(words, span, form, state)?,
        form => {
            let what = if form == 4 {
                both!("by projected angles", "через углы проекций")
            } else {
                both!("by a form that no manual has", "в виде, которого нет ни в одном руководстве")
            };
            return Err(words.refuse(refusal::defines_plane_otherwise(code, form, &what), words.span(P)));
        }
    };
    let Some((origin, turn)) = origin else { return Ok(()) };
    // Where the words' zero is in the machine with all rotary axes at 0, as no transformation and no length is in
    // force.
    let zero_mm = require_frame(env, words, state)?.to_machine(origin);
    state.plane_begun = None;
    state.kinematics = Kinematics::Plane(TiltedPlane { turn, zero_mm });
    lose(words, state);
    Ok(())
}

/// A plane begins where neither another one nor a tool length is in force.
fn may_begin(env: &Environment<'_>, words: &Words<'_, '_, '_>, span: Span, state: &Modal) -> Outcome<()> {
    declared(env, words, span)?;
    match state.kinematics {
        Kinematics::Axes => {}
        Kinematics::Tip => {
            return Err(words.refuse_code(refusal::UNDER_TOOL_CENTRE_POINT_CONTROL, span));
        }
        Kinematics::Plane(_) => {
            return Err(words.refuse_code(refusal::INSIDE_TILTED_PLANE, span));
        }
    }
    if state.tool_length.applied_mm() != [0.0; 3] {
        return Err(words.refuse_code(refusal::WITH_TOOL_LENGTH_IN_FORCE, span));
    }
    Ok(())
}

/// G254: the work offset's zero is where the table has turned it, X, Y, Z are along the machine's axes: a plane on
/// which the tool stands upright where the table stands.
pub(crate) fn follow(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<()> {
    may_begin(env, words, span, state)?;
    if words.has(AXIS_LETTERS) {
        return Err(beside(words, span, AXIS_LETTERS, refusal::MOTION_BESIDE));
    }
    let chain = &env.setup.rotary_chain;
    if !chain.0.iter().all(|link| link.carries_workpiece) {
        return Err(words.refuse_code(refusal::ON_A_MACHINE_THAT_TURNS_THE_TOOL, span));
    }
    require_rotary(words, &state.axes)?;
    let stand_deg = state.axes.rotary.map(|axis| axis.known().unwrap_or(0.0));
    let columns = [0, 1, 2]
        .map(|axis| chain.in_workpiece([0, 1, 2].map(|i| f64::from(u8::from(i == axis))), stand_deg));
    let turn = [0, 1, 2].map(|row| columns.map(|column| column[row]));
    let zero_mm = require_frame(env, words, state)?.to_machine([0.0; 3]);
    state.kinematics = Kinematics::Plane(TiltedPlane { turn, zero_mm });
    lose(words, state);
    Ok(())
}

/// From here on nobody knows where the axes stand in the coordinates in force.
pub(crate) fn lose(words: &Words<'_, '_, '_>, state: &mut Modal) {
    state.axes.linear = [Axis::Unknown(Lost { why: Why::TiltedPlane, line: words.block.line }); 3];
    naming::forget_all(words, state, Why::TiltedPlane);
}

/// Words that stand beside the code: the message names both.
fn beside(words: &Words<'_, '_, '_>, span: Span, letters: Letters, refusal: Refusal) -> Box<Diagnostic> {
    let message = both!("{} beside {}", "{} рядом с {}", words.names(letters), words.text(span));
    words.refuse(Refusal { message, ..refusal }, words.span(letters))
}

fn unfinished(words: &Words<'_, '_, '_>, span: Span) -> Box<Diagnostic> {
    words.refuse(refusal::DEFINITION_NOT_WHOLE, span)
}

/// X, Y and Z of the block, program coordinates, mm: all of them.
fn point(words: &Words<'_, '_, '_>, span: Span, state: &Modal) -> Outcome<Three> {
    let inch = state.units == Units::Inch;
    let values = LINEAR.map(|letter| words.coordinate(letter, inch));
    let [Some(x), Some(y), Some(z)] = values else {
        return Err(words.refuse_code(refusal::WITHOUT_X_Y_AND_Z, span));
    };
    Ok([x, y, z].map(|value| value * state.units.mm()))
}

/// I, J and K: degrees, or a direction.
fn three(words: &Words<'_, '_, '_>) -> Three {
    [b'I', b'J', b'K'].map(|letter| words.coordinate(letter, false).unwrap_or(0.0))
}

/// P0 and P1.
fn by_angles(words: &Words<'_, '_, '_>, span: Span, form: u32) -> Outcome<Turn> {
    let angles = three(words);
    if !words.has(CENTRE_LETTERS) {
        return Err(words.refuse_code(refusal::WITHOUT_ANGLE, span));
    }
    let order = words.whole(b'Q')?;
    if form == 0 {
        if order.is_some_and(|order| order != 313) {
            return Err(beside(words, span, Q, refusal::OTHER_ORDER_OF_EULER));
        }
        return Ok(TiltedPlane::turn_by_euler(angles));
    }
    if order != Some(123) {
        let at = if words.has(Q) { words.span(Q) } else { span };
        return Err(words.refuse(refusal::p1_without_q123(&words.text(span)), at));
    }
    let mut turns = (0..3).filter(|axis| angles[*axis] != 0.0);
    let axis = turns.next().unwrap_or(0);
    if turns.next().is_some() {
        return Err(
            words.refuse(refusal::p1_with_more_than_one_angle(&words.text(span)), words.span(CENTRE_LETTERS))
        );
    }
    Ok(TiltedPlane::turn_about(axis, angles[axis]))
}

/// P2 and P3: a block of it; the plane where it is the last.
fn by_blocks(
    words: &Words<'_, '_, '_>,
    span: Span,
    form: u32,
    state: &mut Modal,
) -> Outcome<Option<(Three, Turn)>> {
    let code = words.text(span);
    let mut begun =
        state.plane_begun.take().unwrap_or(PlaneBegun { form, points: [None; 4], directions: [None; 4] });
    if begun.form != form {
        return Err(unfinished(words, span));
    }
    let last = if form == 2 { 3 } else { 2 };
    let least = if form == 2 { 0 } else { 1 };
    let Some(q) = words.whole(b'Q')?.filter(|q| (least..=last).contains(q)) else {
        let at = if words.has(Q) { words.span(Q) } else { span };
        return Err(words.refuse(refusal::without_number_of_block(code, form, least, last), at));
    };
    let place = q as usize;
    if begun.points[place].is_some() || begun.directions[place].is_some() {
        return Err(words.refuse(refusal::block_stands_twice(code, form, q), words.span(Q)));
    }
    let has_point = form == 2 || q == 1;
    let without = if has_point { Letters::NONE } else { LINEAR_LETTERS };
    let without = if form == 2 { without.or(CENTRE_LETTERS) } else { without };
    if words.has(without) {
        return Err(beside(words, span, without, refusal::NO_MEANING_IN_THIS_BLOCK));
    }
    if has_point {
        let at = point(words, span, state)?;
        if form == 2 && q == 0 && at != [0.0; 3] {
            return Err(beside(words, span, LINEAR_LETTERS, refusal::SHIFT_IN_PLANE_OR_WORKPIECE));
        }
        begun.points[place] = Some(at);
    }
    if form == 3 {
        let Some(direction) = unit(three(words)) else {
            return Err(words.refuse(refusal::vector_of_no_length(code, q), span));
        };
        begun.directions[place] = Some(direction);
    }
    let plane = match (form, begun.points, begun.directions) {
        (2, [_, Some(zero), Some(on_x), Some(beside)], _) => {
            let Some(turn) = TiltedPlane::turn_by_points([zero, on_x, beside]) else {
                return Err(words.refuse(refusal::POINTS_ON_ONE_LINE, span));
            };
            Some((zero, turn))
        }
        (3, [_, Some(zero), ..], [_, Some(x), Some(z), _]) => {
            let turn = TiltedPlane::turn_by_directions(x, z)
                .map_err(|lean| words.refuse(refusal::vectors_not_square(lean.to_degrees()), span))?;
            Some((zero, turn))
        }
        _ => None,
    };
    if plane.is_none() {
        state.plane_begun = Some(begun);
    }
    Ok(plane)
}

/// G53.1 and G53.6.
pub(crate) fn align(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<()> {
    let others = AXIS_LETTERS.or(ARC_LETTERS).or(Letters::of(b"PQHD"));
    if words.has(others) {
        return Err(beside(words, span, others, refusal::AXES_CHOSEN_BY_THE_CONTROL));
    }
    let Kinematics::Plane(plane) = state.kinematics else {
        return Err(words.refuse_code(refusal::WITHOUT_TILTED_PLANE, span));
    };
    let stand = state.axes.rotary.map(Axis::known);
    let angles = env.setup.rotary_chain.angles_for(plane.normal(), &env.setup.tilt_rule, stand);
    let angles = angles.map_err(|why| not_certain(words, span, why, Aligning::Code))?;
    for axis in (0..3).filter(|axis| env.setup.has_rotary[*axis]) {
        state.axes.rotary[axis] = Axis::At(angles[axis]);
    }
    lose(words, state);
    Ok(())
}

/// What turns the rotary axes to a plane.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Aligning {
    /// A code: the pair of angles that the control prefers.
    Code,
    /// CYCLE800: the higher or lower angle, by `_DIR`.
    Swivel,
}

/// Why the angles are not certain to which the rotary axes turn.
pub(crate) fn not_certain(
    words: &Words<'_, '_, '_>,
    span: Span,
    why: NoAngles,
    by: Aligning,
) -> Box<Diagnostic> {
    let (code, before) = match by {
        Aligning::Swivel => ("CYCLE800".to_owned(), "CYCLE800"),
        Aligning::Code => (words.text(span), "G68.2"),
    };
    let message = both!(
        "where {code} turns the rotary axes is not certain",
        "куда {code} повернёт поворотные оси, неясно"
    );
    let (label, help) = (left_open(why, by), settled_by(why, by, before));
    words.refuse(Refusal { code: codes::PLANE_ANGLES, message, label, help }, span)
}

/// What leaves the angles open.
fn left_open(why: NoAngles, by: Aligning) -> Text {
    let name = |axis: usize| AXIS_NAMES[3 + axis];
    match why {
        NoAngles::NotTwoAxes => both!(
            "this machine has not two rotary axes that tilt the tool",
            "у этого станка нет двух поворотных осей, наклоняющих инструмент"
        ),
        NoAngles::OutOfReach => both!(
            "no angles within travel stand the tool upright on the plane, or none of the profile's branch",
            "в пределах хода нет углов, при которых инструмент перпендикулярен плоскости, или нет таких на ветви, названной в профиле"
        ),
        NoAngles::TwoWays if by == Aligning::Swivel => both!(
            "two pairs of angles stand the tool upright on the plane, and no axis tells them apart",
            "инструмент перпендикулярен плоскости при двух парах углов, и ни одна ось их не различает"
        ),
        NoAngles::TwoWays => both!(
            "two pairs of angles stand the tool upright on the plane",
            "инструмент перпендикулярен плоскости при двух парах углов"
        ),
        NoAngles::Free(axis) | NoAngles::Start(axis, _) => both!(
            "the tool stands along {}, which may stand anywhere then",
            "инструмент стоит вдоль {}, и эта ось может быть где угодно",
            name(axis)
        ),
        NoAngles::Turns(axis) => {
            both!("{} has travel for several turns", "ход {} — несколько оборотов", name(axis))
        }
        NoAngles::HalfTurn(axis) => both!(
            "{} is half a turn away, to either side",
            "до нужного угла {} пол-оборота, в обе стороны",
            name(axis)
        ),
        NoAngles::Travel(axis) => both!(
            "by whole turns {} could have a higher or a lower angle than either",
            "через целые обороты угол {} мог бы быть и больше, и меньше обоих",
            name(axis)
        ),
        NoAngles::Unknown(axis) => {
            both!("where {} stands before is not known", "где до этого стоит {}, неизвестно", name(axis))
        }
    }
}

/// What to write, in the profile or `before` the code, so that they are certain.
fn settled_by(why: NoAngles, by: Aligning, before: &str) -> Text {
    let name = |axis: usize| AXIS_NAMES[3 + axis];
    match why {
        NoAngles::NotTwoAxes if by == Aligning::Swivel => both!(
            "name both under `chain` in the profile, or post without tilted planes",
            "назовите обе в ключе `chain` профиля или выводите программу без наклонных плоскостей"
        ),
        NoAngles::NotTwoAxes => both!(
            "turn the axes by their own words before G68.2, and leave the code out",
            "поверните оси их собственными словами до G68.2 и не пишите эту функцию"
        ),
        NoAngles::OutOfReach => both!(
            "check the plane, `travel_deg` of the rotary axes and `branch` under `[kinematics]`",
            "проверьте плоскость, `travel_deg` поворотных осей и `branch` в разделе `[kinematics]`"
        ),
        NoAngles::TwoWays if by == Aligning::Swivel => both!(
            "say on which axis `_DIR` takes the higher or lower angle, as set up with the swivel data: `direction_reference = \"A\"` under `[kinematics]` in the profile",
            "скажите, на какой оси `_DIR` выбирает больший или меньший угол (опорная ось в данных поворота): `direction_reference = \"A\"` в разделе `[kinematics]` профиля"
        ),
        NoAngles::TwoWays => both!(
            "say which one the control takes: `branch = \"A+\"` under `[kinematics]` in the profile, where A is above 0 then",
            "скажите, какую берёт стойка: `branch = \"A+\"` в разделе `[kinematics]` профиля, если тогда A больше 0"
        ),
        NoAngles::Free(axis) | NoAngles::Start(axis, _) => both!(
            "turn {} by its own word before {before}, with `turn = \"shortest\"` under `[kinematics]` where the control then leaves it there",
            "поверните {} её собственным словом до {before}; если стойка там её и оставит, впишите `turn = \"shortest\"` в раздел `[kinematics]`",
            name(axis)
        ),
        NoAngles::Turns(_) => both!(
            "say which one the control takes: `turn = \"shortest\"` or `turn = \"principal\"` under `[kinematics]` in the profile",
            "скажите, какой берёт стойка: `turn = \"shortest\"` или `turn = \"principal\"` в разделе `[kinematics]` профиля"
        ),
        NoAngles::HalfTurn(axis) => both!(
            "turn {} some way by its own word before {before}",
            "поверните {} хотя бы отчасти её собственным словом до {before}",
            name(axis)
        ),
        NoAngles::Travel(axis) => both!(
            "give its travel: `travel_deg = [lowest, highest]` under `[rotary.{}]` in the profile",
            "задайте её ход: `travel_deg = [наименьший, наибольший]` в разделе `[rotary.{}]` профиля",
            name(axis)
        ),
        NoAngles::Unknown(axis) => both!(
            "write a rapid that names {} before {before}",
            "напишите до {before} быстрый ход, в котором названа {}",
            name(axis)
        ),
    }
}

/// G69 and CYCLE800() end the plane, before the motion of their block.
pub(crate) fn end(words: &Words<'_, '_, '_>, before: &Modal, state: &mut Modal) {
    if ends(words) && matches!(before.kinematics, Kinematics::Plane(_)) {
        state.kinematics = Kinematics::Axes;
        lose(words, state);
    }
}

/// What does not go together with a tilted plane, on controls or in what is certain of them.
pub(crate) fn check(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &Modal,
) -> Outcome<()> {
    let span = || {
        demand.owner_span.unwrap_or_else(|| {
            words.codes.first().map_or_else(|| words.span(words.letters), |code| code.span)
        })
    };
    let defines = matches!(demand.frame, Some(Action::TiltedPlane | Action::Swivel));
    if before.plane_begun.is_some() && !defines {
        return Err(unfinished(words, span()));
    }
    let Kinematics::Plane(_) = before.kinematics else { return Ok(()) };
    let aligns = matches!(demand.frame, Some(Action::AlignTool));
    let (ends, ending) = (ends(words), ending(env));
    let (what, help) = match demand.owner {
        Owner::Frame if !defines && !aligns => (
            both!("moves the frame", "смещает систему координат"),
            both!(
                "cancel the plane with {ending} before it",
                "отмените перед ней плоскость функцией {ending}"
            ),
        ),
        Owner::Reference | Owner::MachineCoordinates | Owner::Probe
            if !ends || demand.owner == Owner::Probe =>
        {
            (
                both!("moves axes of the machine, or of the plane", "двигает оси станка или оси плоскости"),
                both!(
                    "cancel the plane with {ending} in a block before it",
                    "отмените плоскость функцией {ending} в кадре перед ней"
                ),
            )
        }
        _ if before.work_offset != state.work_offset => (
            both!("chooses another work offset", "выбирает другое смещение нуля"),
            both!(
                "cancel the plane with {ending} before it, and write it again afterwards",
                "отмените перед ней плоскость функцией {ending}, а после задайте её снова"
            ),
        ),
        _ if !ends && words.codes.iter().any(|code| is_rival(env, code.entry.group, &code.entry.action)) => (
            both!("may end the plane on some controls", "на некоторых стойках может отменить плоскость"),
            both!("cancel the plane with {ending}", "отмените плоскость функцией {ending}"),
        ),
        _ => return Ok(()),
    };
    let span = span();
    Err(words.refuse(
        refusal!(codes::TILTED_PLANE;
            "{} inside a tilted plane", "{} в наклонной плоскости", words.text(span);
            "{what}: controls differ in what that means here",
            "{what:#}: что это здесь значит, у стоек по-разному";
            help
        ),
        span,
    ))
}

/// A code of the group of G68.2 that is passed elsewhere.
fn is_rival(env: &Environment<'_>, group: u8, action: &Action) -> bool {
    let own = |action: &Action| matches!(action, Action::TiltedPlane | Action::RotationOff);
    group != 0
        && !own(action)
        && env.dialect.codes.iter().any(|row| row.group == group && row.action == Action::TiltedPlane)
}

/// Nothing moves in a plane on which the tool does not stand upright, and no rotary axis turns in it but by G53.1.
pub(crate) fn check_motions(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &Modal,
    motions: &SmallVec<[Motion; 1]>,
) -> Outcome<()> {
    let Kinematics::Plane(plane) = state.kinematics else { return Ok(()) };
    if demand.owner == Owner::Frame || motions.is_empty() {
        return Ok(());
    }
    let span = words.span(AXIS_LETTERS);
    if before.axes.rotary != state.axes.rotary {
        let message = both!(
            "a rotary axis turns inside a tilted plane",
            "в наклонной плоскости вращается поворотная ось"
        );
        return Err(words.refuse(
            Refusal {
                code: codes::PLANE_ANGLES,
                message,
                label: both!(
                    "the plane turns with it on some controls, on others not",
                    "на одних стойках плоскость поворачивается вместе с ней, на других нет"
                ),
                help: match ending(env) {
                    "G69" => both!(
                        "turn the axis before G68.2, or let G53.1 do it",
                        "поверните ось до G68.2 или предоставьте это G53.1"
                    ),
                    "G255" => both!(
                        "end it with G255 before the turn, and write G254 again behind it",
                        "отмените до поворота функцией G255, а после снова напишите G254"
                    ),
                    _ => both!(
                        "end the plane with CYCLE800() before it, or let CYCLE800 turn the axis",
                        "отмените перед этим плоскость: CYCLE800() — или предоставьте поворот CYCLE800"
                    ),
                },
            },
            span,
        ));
    }
    if motions.iter().all(|motion| matches!(motion, Motion::Uncorrected { .. })) {
        return Ok(());
    }
    require_rotary(words, &state.axes)?;
    let stands =
        env.setup.rotary_chain.tool_direction(state.axes.rotary.map(|axis| axis.known().unwrap_or(0.0)));
    let off_rad = plane.off_normal_rad(stands);
    if off_rad > UPRIGHT_RAD {
        return Err(words.refuse(refusal::tool_not_upright(angle(off_rad)), span));
    }
    let tool_mm = env.setup.tool_vector(&state.tool_length);
    if tool_mm[0] != 0.0 || tool_mm[1] != 0.0 {
        return Err(words.refuse(refusal::TOOL_BESIDE_SPINDLE_AXIS, span));
    }
    Ok(())
}

/// Degrees for people.
fn angle(rad: f64) -> String {
    let deg = rad.to_degrees();
    if deg < 0.01 { format!("{deg:.5}") } else { format!("{deg:.3}") }
}
