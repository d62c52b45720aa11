//! Tilted working planes: G68.2 says where the plane lies in the workpiece, G53.1 turns the tool upright on it, G69 ends it.
//!
//! X, Y and Z are coordinates of the plane in between, and the control brings the tip to that place of the workpiece. That
//! it does so wherever the rotary axes stand no manual promises; so nothing moves in a plane on which the tool does not
//! stand upright.

use diagnostic::Diagnostic;
use nc_syntax::Span;
use nc_syntax::dialect::Action;
use smallvec::SmallVec;
use toolpath::{AXIS_NAMES, Kinematics, Motion, NoAngles, TiltedPlane, unit};

use crate::codes;
use crate::frames::absolute;
use crate::modal::{Axis, Lost, Modal, Units, Why};
use crate::naming;
use crate::position::{require_frame, require_rotary};
use crate::settings::{Demand, Environment, Owner};
use crate::words::{
    ARC_LETTERS, AXIS_LETTERS, CENTRE_LETTERS, LINEAR, LINEAR_LETTERS, Outcome, Refusal, Words,
};
use nc_syntax::Letters;

/// The tool stands upright on a plane where its direction is within this of the plane's normal, rad: whichever of the two
/// a control adds a length of 200 mm along, its end is within a micrometre.
const UPRIGHT_RAD: f64 = 5e-6;

const P: Letters = Letters::of(b"P");
const Q: Letters = Letters::of(b"Q");
const R: Letters = Letters::of(b"R");

type Three = [f64; 3];
/// Rows.
type Turn = [Three; 3];

/// A plane of several blocks (P2, P3), as far as it is written.
#[derive(Clone, Debug, PartialEq)]
pub struct Begun {
    /// P.
    form: u32,
    /// By Q: a point, mm.
    points: [Option<Three>; 4],
    /// By Q: a direction.
    directions: [Option<Three>; 4],
}

fn refuse(words: &Words<'_, '_, '_>, span: Span, message: String, label: &str) -> Refusal {
    words.refuse(codes::TILTED_PLANE, message, span, label)
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
    let unknown = env.setup.tip_control.unknown("no path in it", "tilted planes");
    if let Some((label, help)) = unknown {
        let message = format!("{code} is refused: it tilts the working plane");
        return Err(refuse(words, span, message, &label).help(help));
    }
    match state.kinematics {
        Kinematics::Axes => {}
        Kinematics::Tip => {
            let message = format!("{code} under tool centre point control");
            let label = "are X, Y and Z in the plane's coordinates then, or in the workpiece's?";
            return Err(
                refuse(words, span, message, label).help("switch tool centre point control off before")
            );
        }
        Kinematics::Plane(_) => {
            let message = format!("{code} inside a tilted plane");
            return Err(refuse(words, span, message, "in the coordinates of which plane?")
                .help("cancel the plane before with G69"));
        }
    }
    if state.tool_length.applied_mm() != [0.0; 3] {
        let message = format!("{code} with a tool length in force");
        return Err(refuse(words, span, message, "along which axis is the length then?")
            .help("write G49 before it, and G43 with its H behind G53.1, or in the plane"));
    }
    absolute(words, span, state)?;
    // Some posts write `R0.` with each plane.
    if words.coordinate(b'R', false).is_some_and(|angle| angle != 0.0) {
        return Err(stray(
            words,
            span,
            R,
            "turns the plane about its zero, before or behind its own angles?",
        )
        .help("write the turn into the plane's angles, points or vectors, and remove R"));
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
            let what = if form == 4 { "by projected angles" } else { "by a form that no manual has" };
            let message = format!("{code} P{form} defines a plane {what}");
            return Err(refuse(words, words.span(P), message, "which turn that is, is not certain")
                .help("write the plane by Euler angles: P0 and I, J, K about Z, the new X and the new Z"));
        }
    };
    let Some((origin, turn)) = origin else { return Ok(()) };
    // Where the words' zero is in the machine with all rotary axes at 0, as no transformation and no length is in force.
    let zero_mm = require_frame(env, words, state)?.to_machine(origin);
    state.plane_begun = None;
    state.kinematics = Kinematics::Plane(TiltedPlane { turn, zero_mm });
    lose(words, state);
    Ok(())
}

/// From here on nobody knows where the axes stand in the coordinates in force.
fn lose(words: &Words<'_, '_, '_>, state: &mut Modal) {
    state.axes.linear = [Axis::Unknown(Lost { why: Why::TiltedPlane, line: words.block.line }); 3];
    naming::forget_all(words, state, Why::TiltedPlane);
}

fn stray(words: &Words<'_, '_, '_>, span: Span, letters: Letters, label: &str) -> Refusal {
    let message = format!("{} beside {}", words.names(letters), words.text(span));
    refuse(words, words.span(letters), message, label)
}

fn unfinished(words: &Words<'_, '_, '_>, span: Span) -> Box<Diagnostic> {
    let message = "the definition of a tilted plane is not whole".to_owned();
    refuse(words, span, message, "points and vectors of one plane stand in blocks one behind the other")
        .help("write all its blocks, Q1 and Q2, of three points Q3 too, before anything else")
}

/// X, Y and Z of the block, program coordinates, mm: all of them.
fn point(words: &Words<'_, '_, '_>, span: Span, state: &Modal) -> Outcome<Three> {
    let inch = state.units == Units::Inch;
    let values = LINEAR.map(|letter| words.coordinate(letter, inch));
    let [Some(x), Some(y), Some(z)] = values else {
        let message = format!("{} without X, Y and Z", words.text(span));
        return Err(refuse(words, span, message, "where the axes stand, or at zero? controls differ")
            .help("write X, Y and Z of the plane's zero, or of the point"));
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
        let message = format!("{} without an angle", words.text(span));
        return Err(refuse(words, span, message, "a plane that is not tilted, or as the last one?")
            .help("write I, J and K in degrees"));
    }
    let order = words.whole(b'Q')?;
    if form == 0 {
        if order.is_some_and(|order| order != 313) {
            return Err(stray(words, span, Q, "another order of Euler angles on some controls").help(
                "write the plane by I about Z, J about the new X and K about the new Z, and remove Q",
            ));
        }
        return Ok(TiltedPlane::turn_by_euler(angles));
    }
    if order != Some(123) {
        let message = format!("{} P1 without Q123", words.text(span));
        let at = if words.has(Q) { words.span(Q) } else { span };
        return Err(refuse(words, at, message, "whether I, J, K then change places, controls differ").help(
            "write Q123, and one angle: I about X, J about Y or K about Z; or the plane by Euler angles (P0)",
        ));
    }
    let mut turns = (0..3).filter(|axis| angles[*axis] != 0.0);
    let axis = turns.next().unwrap_or(0);
    if turns.next().is_some() {
        let message = format!("{} P1 with more than one angle", words.text(span));
        return Err(refuse(
            words,
            words.span(CENTRE_LETTERS),
            message,
            "about axes that stand, or that turn? controls differ",
        )
        .help("write the plane by Euler angles: P0 and I, J, K about Z, the new X and the new Z"));
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
        state.plane_begun.take().unwrap_or(Begun { form, points: [None; 4], directions: [None; 4] });
    if begun.form != form {
        return Err(unfinished(words, span));
    }
    let last = if form == 2 { 3 } else { 2 };
    let least = if form == 2 { 0 } else { 1 };
    let Some(q) = words.whole(b'Q')?.filter(|q| (least..=last).contains(q)) else {
        let message = format!("{code} P{form} without the number of its block");
        let at = if words.has(Q) { words.span(Q) } else { span };
        return Err(refuse(words, at, message, &format!("Q{least} to Q{last} were expected"))
            .help("write Q1 beside the plane's zero"));
    };
    let place = q as usize;
    if begun.points[place].is_some() || begun.directions[place].is_some() {
        let message = format!("{code} P{form} Q{q} stands twice");
        return Err(refuse(words, words.span(Q), message, "which one?").help("remove one of the two"));
    }
    let has_point = form == 2 || q == 1;
    let without = if has_point { Letters::NONE } else { LINEAR_LETTERS };
    let without = if form == 2 { without.or(CENTRE_LETTERS) } else { without };
    if words.has(without) {
        return Err(stray(words, span, without, "has no meaning in this block of the plane")
            .help("remove the word, or write it in the block that it belongs to"));
    }
    if has_point {
        let at = point(words, span, state)?;
        if form == 2 && q == 0 && at != [0.0; 3] {
            return Err(stray(
                words,
                span,
                LINEAR_LETTERS,
                "a shift in the plane, or in the workpiece? controls differ",
            )
            .help("write the plane's zero as its first point, and zeros or nothing as Q0"));
        }
        begun.points[place] = Some(at);
    }
    if form == 3 {
        let Some(direction) = unit(three(words)) else {
            let message = format!("{code} P3 Q{q} with a vector of no length");
            return Err(
                refuse(words, span, message, "no direction").help("write I, J and K of the direction")
            );
        };
        begun.directions[place] = Some(direction);
    }
    let plane = match (form, begun.points, begun.directions) {
        (2, [_, Some(zero), Some(on_x), Some(beside)], _) => {
            let Some(turn) = TiltedPlane::turn_by_points([zero, on_x, beside]) else {
                let message = "three points of a tilted plane lie on one line".to_owned();
                return Err(refuse(words, span, message, "no plane, or any")
                    .help("write three points that span the plane"));
            };
            Some((zero, turn))
        }
        (3, [_, Some(zero), ..], [_, Some(x), Some(z), _]) => {
            let turn = TiltedPlane::turn_by_directions(x, z).map_err(|lean| {
                let message = "the two vectors of a tilted plane are not at right angles".to_owned();
                let label =
                    format!("by {:.4} degrees: which of the two stays is not certain", lean.to_degrees());
                refuse(words, span, message, &label)
                    .help("write the vectors with more decimals, or the plane by angles or points")
            })?;
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
    let code = words.text(span);
    let others = AXIS_LETTERS.or(ARC_LETTERS).or(Letters::of(b"PQHD"));
    if words.has(others) {
        return Err(stray(words, span, others, "chooses or moves something, as the control has it")
            .help("write the code alone in its block, and say which way the control turns as `branch` and `turn` under `[kinematics]` in the profile"));
    }
    let Kinematics::Plane(plane) = state.kinematics else {
        let message = format!("{code} without a tilted plane");
        return Err(
            refuse(words, span, message, "turns the tool to which plane?").help("write G68.2 before it")
        );
    };
    let stand = state.axes.rotary.map(Axis::known);
    let angles = env.setup.rotary_chain.angles_for(plane.normal(), &env.setup.tilt_rule, stand);
    let name = |axis: usize| AXIS_NAMES[3 + axis];
    let angles = angles.map_err(|why| {
        let (label, help) = match why {
            NoAngles::NotTwoAxes => (
                "this machine has not two rotary axes that tilt the tool".to_owned(),
                "turn the axes by their own words before G68.2, and leave the code out".to_owned(),
            ),
            NoAngles::OutOfReach => (
                "no angles within travel stand the tool upright on the plane, or none of the profile's branch".to_owned(),
                "check the plane, `travel_deg` of the rotary axes and `branch` under `[kinematics]`".to_owned(),
            ),
            NoAngles::TwoWays => (
                "two pairs of angles stand the tool upright on the plane".to_owned(),
                "say which one the control takes: `branch = \"A+\"` under `[kinematics]` in the profile, where A is above 0 then".to_owned(),
            ),
            NoAngles::Free(axis) => (
                format!("the tool stands along {}, which may stand anywhere then", name(axis)),
                format!("turn {} by its own word before G68.2, with `turn = \"shortest\"` under `[kinematics]` where the control then leaves it there", name(axis)),
            ),
            NoAngles::Turns(axis) => (
                format!("{} has travel for several turns", name(axis)),
                "say which one the control takes: `turn = \"shortest\"` or `turn = \"principal\"` under `[kinematics]` in the profile".to_owned(),
            ),
            NoAngles::Unknown(axis) => (
                format!("where {} stands before is not known", name(axis)),
                format!("write a rapid that names {} before G68.2", name(axis)),
            ),
        };
        let message = format!("where {code} turns the rotary axes is not certain");
        words.refuse(codes::PLANE_ANGLES, message, span, label).help(help)
    })?;
    for axis in (0..3).filter(|axis| env.setup.has_rotary[*axis]) {
        state.axes.rotary[axis] = Axis::At(angles[axis]);
    }
    lose(words, state);
    Ok(())
}

/// G69 ends the plane, before the motion of its block.
pub(crate) fn end(words: &Words<'_, '_, '_>, before: &Modal, state: &mut Modal) {
    let ends = words.codes.iter().any(|code| code.entry.action == Action::RotationOff);
    if ends && matches!(before.kinematics, Kinematics::Plane(_)) {
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
    let defines = matches!(demand.frame, Some(Action::TiltedPlane));
    if before.plane_begun.is_some() && !defines {
        return Err(unfinished(words, span()));
    }
    let Kinematics::Plane(_) = before.kinematics else { return Ok(()) };
    let aligns = matches!(demand.frame, Some(Action::AlignTool));
    let ends = words.codes.iter().any(|code| code.entry.action == Action::RotationOff);
    let (what, help) = match demand.owner {
        Owner::Frame if !defines && !aligns => ("moves the frame", "cancel the plane with G69 before it"),
        Owner::Reference | Owner::MachineCoordinates | Owner::Probe
            if !ends || demand.owner == Owner::Probe =>
        {
            ("moves axes of the machine, or of the plane", "cancel the plane with G69 in a block before it")
        }
        _ if before.work_offset != state.work_offset => (
            "chooses another work offset",
            "cancel the plane with G69 before it, and write it again afterwards",
        ),
        _ if !ends && words.codes.iter().any(|code| is_rival(env, code.entry.group, &code.entry.action)) => {
            ("may end the plane on some controls", "cancel the plane with G69")
        }
        _ => return Ok(()),
    };
    let span = span();
    let message = format!("{} inside a tilted plane", words.text(span));
    Err(refuse(words, span, message, &format!("{what}: controls differ in what that means here")).help(help))
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
        let message = "a rotary axis turns inside a tilted plane";
        return Err(words
            .refuse(
                codes::PLANE_ANGLES,
                message,
                span,
                "the plane turns with it on some controls, on others not",
            )
            .help("turn the axis before G68.2, or let G53.1 do it"));
    }
    if motions.iter().all(|motion| matches!(motion, Motion::Uncorrected { .. })) {
        return Ok(());
    }
    require_rotary(words, &state.axes)?;
    let stands =
        env.setup.rotary_chain.tool_direction(state.axes.rotary.map(|axis| axis.known().unwrap_or(0.0)));
    let off_rad = plane.off_normal_rad(stands);
    if off_rad > UPRIGHT_RAD {
        let message = "the rotary axes do not stand the tool upright on the tilted plane";
        let label = format!("it leans by {} degrees", angle(off_rad));
        return Err(words
            .refuse(codes::PLANE_ANGLES, message, span, label)
            .help("write the angles that belong to the plane before G68.2, with as many decimals as the plane has, or G53.1 behind it"));
    }
    let tool_mm = env.setup.tool_vector(&state.tool_length);
    if tool_mm[0] != 0.0 || tool_mm[1] != 0.0 {
        return Err(refuse(
            words,
            span,
            "a tool beside the spindle's axis in a tilted plane".to_owned(),
            "along which axes is it then?",
        )
        .help("give the tool's length along Z alone, or post without tilted planes"));
    }
    Ok(())
}

/// Degrees for people.
fn angle(rad: f64) -> String {
    let deg = rad.to_degrees();
    if deg < 0.01 { format!("{deg:.5}") } else { format!("{deg:.3}") }
}
