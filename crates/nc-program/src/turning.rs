//! What is different in a lathe's program: X words are diameters, there is no Y, arcs lie in X and Z.

use diagnostic::{Text, both, refusal};
use nc_dialect::Action;
use nc_syntax::{GCode, Letters};
use toolpath::{Motion, Plane, Shape};

use crate::codes;
use crate::environment::{Demand, Environment, Owner};
use crate::modal::{Distance, Modal, MotionMode, XWords};
use crate::refusals::turning as refusal;
use crate::words::{ARC_LETTERS, AXIS_LETTERS, LINEAR, Outcome, ROTARY_LETTERS, Words};

/// The code that keeps the cutting speed constant, on every control.
const CONSTANT_SPEED: GCode = GCode(960);
/// Program coordinates this little below the axis are on it, mm: sums of increments have last bits.
const ON_THE_AXIS_MM: f64 = 1e-9;

/// G7 and G8, which hold for the words of their own block, and how X words are to be read then; and whether a limit holds the
/// spindle where the speed rises towards the axis.
pub(crate) fn read(words: &mut Words<'_, '_, '_>, state: &mut Modal) -> Outcome<()> {
    no_increments_of_other_axes(words)?;
    let mut distance = state.distance;
    let actions = words.codes.iter().map(|code| &code.entry.action);
    for action in actions.chain(words.commands.iter().map(|(action, _)| *action)) {
        match action {
            Action::DiameterOn => state.x_words = XWords::Diameter,
            Action::DiameterOff => state.x_words = XWords::Radius,
            Action::DiameterOfAbsolute => state.x_words = XWords::DiameterOfAbsolute,
            Action::SpeedLimit => state.speed_limited = true,
            Action::Absolute => distance = Distance::Absolute,
            Action::Incremental => distance = Distance::Incremental,
            Action::LimitOrPreset => state.speed_limited |= words.has(Letters::of(b"S")),
            _ => {}
        }
    }
    words.diameters = state.x_words.are_diameters(distance);
    if let Some(code) = words.codes.iter().find(|code| code.entry.code == CONSTANT_SPEED) {
        state.speed_limited |= words.has(Letters::of(b"D"));
        if !state.speed_limited {
            return Err(words.refuse_code(refusal::WITHOUT_LIMIT_OF_SPEED, code.span));
        }
    }
    Ok(())
}

/// Where U and W add to X and Z, V and H add to Y and C (B-64304EN-1, "Absolute and incremental programming"), and where T
/// says the offset, H is no tool length. Asked for before the codes are executed, which would take it for one.
fn no_increments_of_other_axes(words: &Words<'_, '_, '_>) -> Outcome<()> {
    let takes_words =
        |action: &Action| matches!(action, Action::Pass { takes_words: true } | Action::LimitOrPreset);
    let (others, adds) = words.letters_of_other_axes();
    if !words.has(others) || words.codes.iter().any(|code| takes_words(&code.entry.action)) {
        return Ok(());
    }
    let label = if adds {
        both!(
            "in G-code system A V adds to Y and H adds to C",
            "в системе G-кодов A V прибавляется к Y, а H — к C"
        )
    } else {
        both!(
            "T says the offset of the tool here, H is of another axis",
            "коррекцию инструмента здесь задаёт T, а H относится к другой оси"
        )
    };
    Err(words.refuse(
        refusal!(codes::NO_TURNING;
            "{} on a lathe of two axes", "{} на двухосевом токарном станке", words.names(others);
            label; off_the_axis()
        ),
        words.span(others),
    ))
}

/// What to do with words of axes that a lathe of two axes has not.
fn off_the_axis() -> Text {
    both!(
        "correct the turning apart from what is milled or drilled off the axis",
        "исправляйте точение отдельно от того, что фрезеруется или сверлится вне оси"
    )
}

/// The letter of a thread's lead.
pub(crate) fn thread_lead(env: &Environment<'_>) -> Letters {
    env.dialect.turning.as_ref().map_or(Letters::NONE, |turning| Letters::of(&[turning.thread_lead]))
}

/// A thread's lead that is no F must stand in its block.
pub(crate) fn require_lead(env: &Environment<'_>, words: &Words<'_, '_, '_>) -> Outcome<()> {
    let lead = thread_lead(env);
    if lead == Letters::of(b"F") || words.has(lead) || !words.has(AXIS_LETTERS) {
        return Ok(());
    }
    let name = lead.first() as char;
    Err(words.refuse(refusal::thread_without(name), words.span(AXIS_LETTERS)))
}

/// A face that was corrected leaves its plane by less than this share of its way.
const FACE_SLOPE: f64 = 0.01;

/// Faces begin and end so far beyond the axis, of the radius, that a nose leaves no pip.
const FACES_PASS_MM: f64 = 2.0;

/// Feeds beyond the axis: a face may pass the centre, what moves along Z may not.
pub(crate) fn check_motions(words: &Words<'_, '_, '_>, state: &Modal, motions: &[Motion]) -> Outcome<()> {
    let Some(frame) = &state.frame else { return Ok(()) };
    for motion in motions {
        let Motion::Feed(feed) = motion else { continue };
        let [start, end] = [&feed.start, &feed.end].map(|place| frame.to_program(place.linear_mm));
        let along =
            feed.shape != Shape::Line || (end[2] - start[2]).abs() > FACE_SLOPE * (end[0] - start[0]).abs();
        // A face that begins there is approached there.
        let most = if feed.shape == Shape::Line { FACES_PASS_MM } else { ON_THE_AXIS_MM };
        if along && start[0].min(end[0]) < -most {
            return Err(words.refuse(
                refusal::turning_below_axis(start[0].min(end[0])),
                words.span(AXIS_LETTERS.or(ARC_LETTERS)),
            ));
        }
    }
    Ok(())
}

/// What no lathe of two axes does, and what nobody said.
pub(crate) fn check(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    state: &Modal,
) -> Outcome<()> {
    const X: Letters = Letters::of(b"X");
    const Y: Letters = Letters::of(b"Y");
    const ANGLE_AND_CHAMFER: Letters = Letters::of(b"AC");
    let places = !matches!(demand.owner, Owner::Dwell | Owner::DwellBySetting | Owner::Arguments);
    let absent = Y.or(ROTARY_LETTERS);
    if places && words.has(absent) {
        let message =
            both!("{} on a lathe of two axes", "{} на двухосевом токарном станке", words.names(absent));
        let on_a_line = matches!(state.motion, MotionMode::Line(_)) && env.dialect.flow.corner_words;
        let help = if on_a_line && words.has(ANGLE_AND_CHAMFER) && !words.has(Y) {
            both!(
                "write `drawing_words = \"plain\"` under `[program]` in the profile where A and C of lines are angles and chamfers \
                 without a comma (parameter 3405.4); else correct the turning apart from what is milled",
                "впишите `drawing_words = \"plain\"` в раздел `[program]` профиля, если A и C прямых без запятой — углы и фаски \
                 (параметр 3405.4); иначе исправляйте точение отдельно от фрезерования"
            )
        } else {
            off_the_axis()
        };
        return Err(words.refuse(
            refusal!(codes::NO_TURNING; message; "the axes are X and Z", "оси — X и Z"; help),
            words.span(absent),
        ));
    }
    if places && words.has(X) && state.x_words == XWords::Unstated {
        return Err(words.refuse(refusal::DIAMETER_OR_RADIUS, words.span(X)));
    }
    let increments = words.by_increment != [false; 3];
    if increments && matches!(demand.owner, Owner::Frame | Owner::MachineCoordinates | Owner::Length) {
        let named = [0, 2].into_iter().filter(|i| words.by_increment[*i]).map(|i| Letters::of(&[LINEAR[i]]));
        let span = words.span(named.fold(Letters::NONE, Letters::or));
        return Err(words.refuse(refusal::INCREMENT_FOR_PLACE, span));
    }
    let arc = matches!(state.motion, MotionMode::Arc(..)) && demand.owner == Owner::Motion;
    if arc && words.has(AXIS_LETTERS.or(ARC_LETTERS)) && state.plane != Plane::Zx {
        return Err(words.refuse(refusal::ARC_OUT_OF_PLANE, words.span(AXIS_LETTERS.or(ARC_LETTERS))));
    }
    Ok(())
}
