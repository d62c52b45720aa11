//! Codes that move the frame: G10, G52, G92 and their like, G68, G51, G51.1.
//!
//! All of them end in [`toolpath::Frame`]: axis = T(word) + zero + shifts + tool length, T being the
//! rotation, scaling or mirror in force. What a manual leaves open is refused.

use nc_dialect::{Action, FramePart, OffsetL20};
use nc_syntax::{Letters, Span};

use crate::environment::{Demand, Environment};
use crate::frame_state::{absolute, refresh, unsettle};
use crate::modal::{Compensation, Distance, Modal, Units};
use crate::position::{increment_base, require_frame};
use crate::refusals::frames as refusal;
use crate::tool_length;
use crate::transform::Transform;
use crate::words::{
    ARC_LETTERS, AXIS_LETTERS, CENTRE_LETTERS, LINEAR, LINEAR_LETTERS, Outcome, ROTARY_LETTERS,
    SECONDARY_LETTERS, Words,
};
use crate::work_offset::{name_of, numbered, offset};
use crate::{swivel, tilted};

const P: Letters = Letters::of(b"P");
const R: Letters = Letters::of(b"R");
const L: Letters = Letters::of(b"L");

/// Executes a code whose words move the frame; says whether they state where the axes stand.
pub(crate) fn execute(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &mut Modal,
) -> Outcome<bool> {
    let (Some(action), Some(span)) = (demand.frame, demand.owner_span) else { return Ok(false) };
    if let Some(motion) = demand.written_motion {
        return Err(
            words.refuse(refusal::two_codes_in_one_block(&words.text(span), &words.text(motion)), span)
        );
    }
    if words.has(ROTARY_LETTERS.or(SECONDARY_LETTERS)) {
        let letters = ROTARY_LETTERS.or(SECONDARY_LETTERS);
        return Err(words.refuse(refusal::shifts_another_axis(&words.text(span)), words.span(letters)));
    }
    if [before, state].iter().any(|state| state.compensation != Compensation::Off) {
        return Err(words.refuse_code(refusal::UNDER_CUTTER_COMPENSATION, span));
    }
    if state.cycle.is_some() {
        return Err(words.refuse_code(refusal::DURING_DRILLING_CYCLE, span));
    }
    if before.work_offset != state.work_offset || before.tool_length != state.tool_length {
        return Err(words.refuse_code(refusal::BESIDE_ANOTHER_OFFSET, span));
    }
    let turns = matches!(
        action,
        Action::RotationOn
            | Action::ScalingOn
            | Action::MirrorOn
            | Action::MirrorOff
            | Action::ProgramFrame { .. }
    );
    if !turns && !state.transform.is_none() {
        return Err(words.refuse_code(refusal::under_transform(&state.transform.name()), span));
    }
    let mut states_position = false;
    match action {
        Action::LocalShift => local_shift(env, words, span, state)?,
        Action::Preset => {
            states_position = true;
            preset(env, words, span, state)?;
        }
        Action::PresetCancel => cancel_preset(env, words, span, state)?,
        Action::PresetSuspend | Action::PresetRestore => {
            no_words(words, span)?;
            if *action == Action::PresetSuspend {
                state.shifts.kept_mm = Some(state.shifts.preset_mm);
                state.shifts.preset_mm = [0.0; 3];
            } else {
                let Some(kept) = state.shifts.kept_mm else {
                    return Err(words.refuse_code(refusal::WITHOUT_SHIFT_OF_THIS_PROGRAM, span));
                };
                state.shifts.preset_mm = kept;
            }
        }
        Action::WriteOffset => states_position = write_offset(env, words, span, state)?,
        Action::RotationOn | Action::ScalingOn | Action::MirrorOn => {
            let transform = transform(env, words, span, action, state)?;
            unsettle(state, transform);
        }
        Action::MirrorOff => mirror_off(words, span, state)?,
        Action::ProgramFrame { part, adds } => program_frame(words, span, *part, *adds, state)?,
        Action::TiltedPlane => tilted::define(env, words, span, state)?,
        Action::DynamicOffset => tilted::follow(env, words, span, state)?,
        Action::AlignTool => tilted::align(env, words, span, state)?,
        Action::Swivel => swivel::execute(env, words, span, state)?,
        _ => {}
    }
    refresh(state);
    Ok(states_position)
}

fn no_words(words: &Words<'_, '_, '_>, span: Span) -> Outcome<()> {
    let letters = AXIS_LETTERS.or(ARC_LETTERS);
    if words.has(letters) {
        return Err(words.refuse(refusal::takes_no_words(&words.text(span)), words.span(letters)));
    }
    Ok(())
}

/// Words of X, Y, Z in mm; at least one.
fn shift_words(words: &Words<'_, '_, '_>, span: Span, state: &Modal) -> Outcome<[Option<f64>; 3]> {
    if words.has(ARC_LETTERS) {
        return Err(words.refuse(
            refusal::takes_no_letters(&words.text(span), &words.names(ARC_LETTERS)),
            words.span(ARC_LETTERS),
        ));
    }
    if !words.has(LINEAR_LETTERS) {
        return Err(words.refuse_code(refusal::WITHOUT_X_Y_OR_Z, span));
    }
    let inch = state.units == Units::Inch;
    Ok(LINEAR.map(|letter| words.coordinate(letter, inch).map(|value| value * state.units.mm())))
}

/// G52: the words are the shift; LinuxCNC keeps it where it keeps G92's.
fn local_shift(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<()> {
    absolute(words, span, state)?;
    let shift = shift_words(words, span, state)?;
    let one = env.dialect.frames.local_is_preset;
    if !one && state.shifts.preset_mm != [0.0; 3] {
        return Err(words.refuse_code(refusal::AFTER_G92, span));
    }
    let target = if one { &mut state.shifts.preset_mm } else { &mut state.shifts.local_mm };
    for i in 0..3 {
        target[i] = shift[i].unwrap_or(target[i]);
    }
    if one {
        state.shifts.kept_mm = Some(state.shifts.preset_mm);
    }
    Ok(())
}

/// Program coordinate of an axis whose position must be known, mm; no transformation is in force.
fn stands_at(env: &Environment<'_>, words: &Words<'_, '_, '_>, state: &Modal, axis: usize) -> Outcome<f64> {
    let frame = require_frame(env, words, state)?;
    Ok(increment_base(words, state.axes.linear[axis], axis)? - frame.offset_mm()[axis])
}

/// G92: the frame moves so that the axes stand at the words.
fn preset(env: &Environment<'_>, words: &Words<'_, '_, '_>, span: Span, state: &mut Modal) -> Outcome<()> {
    let wanted = shift_words(words, span, state)?;
    let rules = &env.dialect.frames;
    if !rules.local_is_preset && state.shifts.local_mm != [0.0; 3] {
        return Err(words.refuse_code(refusal::AFTER_G52, span));
    }
    if !rules.local_is_preset && state.tool_length.applied_mm() != [0.0; 3] {
        return Err(words.refuse_code(refusal::WITH_TOOL_LENGTH_IN_FORCE, span));
    }
    let mut preset = state.shifts.preset_mm;
    for i in 0..3 {
        if let Some(value) = wanted[i] {
            preset[i] += stands_at(env, words, state, i)? - value;
        }
    }
    state.shifts.preset_mm = preset;
    state.shifts.kept_mm = Some(preset);
    Ok(())
}

/// A shift below this is none, mm: where G92 says that the axes stand where they do, the last bits may differ.
const NO_SHIFT_MM: f64 = 1e-9;

/// G92.1: with words on Fanuc, where it also ends G52; without on LinuxCNC.
fn cancel_preset(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<()> {
    if env.dialect.frames.local_is_preset {
        no_words(words, span)?;
        state.shifts.preset_mm = [0.0; 3];
        state.shifts.kept_mm = Some([0.0; 3]);
        return Ok(());
    }
    let shifts = [state.shifts.preset_mm, state.shifts.local_mm];
    let shifted = shifts.iter().flatten().any(|shift| shift.abs() > NO_SHIFT_MM);
    if !words.has(LINEAR_LETTERS) && shifted {
        return Err(words.refuse_code(refusal::WITHOUT_AXES, span));
    }
    for (i, letter) in LINEAR.into_iter().enumerate() {
        if words.has(Letters::of(&[letter])) {
            state.shifts.preset_mm[i] = 0.0;
            state.shifts.local_mm[i] = 0.0;
        }
    }
    Ok(())
}

/// G10 L2 and L20; true where its words state where the axes stand.
fn write_offset(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    state: &mut Modal,
) -> Outcome<bool> {
    let l = words.whole(b'L')?;
    if let (Some(l @ 10..=13), true) = (l, env.dialect.writes_lengths) {
        tool_length::write(words, span, l, state)?;
        return Ok(false);
    }
    if !matches!(l, Some(2 | 20)) {
        let at = if words.has(L) { words.span(L) } else { span };
        return Err(words.refuse(refusal::writes_no_work_offset(&words.text(span)), at));
    }
    if words.has(R) {
        return Err(words.refuse(refusal::WORK_OFFSET_WITH_ROTATION, words.span(R)));
    }
    let Some(p) = words.whole(b'P')? else {
        return Err(words.refuse_code(refusal::WITHOUT_P, span));
    };
    let values = shift_words(words, span, state)?;
    let rules = &env.dialect.frames;
    let by_position = l == Some(20) && rules.l20 == OffsetL20::Position;
    let name = match (l, p) {
        (Some(20), _) if !by_position => numbered(p),
        (_, 0) if rules.l20 == OffsetL20::Position => match name_of(env.dialect, &state.work_offset) {
            Some(name) => name,
            None => {
                return Err(words.refuse_code(refusal::WITHOUT_WORK_OFFSET_IN_FORCE, span));
            }
        },
        (_, 0) => {
            return Err(words.refuse(refusal::WRITES_EXTERNAL_WORK_OFFSET, words.span(P)));
        }
        (_, p) => match offset_of_number(env, p) {
            Some(name) => name,
            None => {
                return Err(words.refuse(refusal::no_such_work_offset(p), words.span(P)));
            }
        },
    };
    let old = offset(env, state, &name);
    let active = name_of(env.dialect, &state.work_offset).as_deref() == Some(name.as_str());
    let mut zero = [0.0; 3];
    for i in 0..3 {
        // Fanuc adds under G91; LinuxCNC never does.
        let adds = state.distance == Distance::Incremental && rules.l20 == OffsetL20::Numbered;
        zero[i] = match (values[i], old) {
            (Some(value), _) if by_position => {
                let tool = state.tool_length.applied_mm()[i];
                increment_base(words, state.axes.linear[i], i)? - tool - state.shifts.preset_mm[i] - value
            }
            (Some(value), Some(old)) if adds => old[i] + value,
            (Some(value), _) if !adds => value,
            (None, Some(old)) => old[i],
            _ => {
                return Err(words.refuse(refusal::work_offset_written_in_part(name), span));
            }
        };
    }
    match state.written.iter_mut().find(|(known, _)| *known == name) {
        Some(entry) => entry.1 = zero,
        None => state.written.push((name, zero)),
    }
    if active {
        // LinuxCNC takes it at once. Where that is not certain, no motion until the offset is chosen again.
        state.work_offset.zero_mm = (rules.l20 == OffsetL20::Position).then_some(zero);
        state.work_offset.rewritten = rules.l20 != OffsetL20::Position;
    }
    Ok(by_position)
}

/// TRANS, ROT, MIRROR and their additive forms (840D Programming Manual Fundamentals, chapter Coordinate
/// transformations): place = work offset + shift + T·words, the shift along the work offset's axes.
///
/// One that does not add takes the place of all that were in force; an additive one works in the frame that they make.
fn program_frame(
    words: &Words<'_, '_, '_>,
    span: Span,
    part: FramePart,
    adds: bool,
    state: &mut Modal,
) -> Outcome<()> {
    let allowed = match part {
        FramePart::Rotation => AXIS_LETTERS.or(L),
        FramePart::Shift | FramePart::Mirror => LINEAR_LETTERS,
    };
    let others = words.letters.without(allowed).without(Letters::of(b"NO"));
    if words.has(others) || !words.codes.is_empty() || !words.m_codes.is_empty() {
        let at = if words.has(others) { words.span(others) } else { span };
        return Err(words.refuse(refusal::beside_something_else(&words.text(span)), at));
    }
    let none = !words.has(allowed);
    if none && adds {
        return Err(words.refuse_code(refusal::WITHOUT_WORDS, span));
    }
    let (mut shift, mut transform) =
        if adds { (state.shifts.local_mm, state.transform) } else { ([0.0; 3], Transform::None) };
    match part {
        _ if none => {}
        FramePart::Shift => {
            let by = shift_words(words, span, state)?.map(|mm| mm.unwrap_or(0.0));
            // Along the axes that the frame in force has.
            let turned =
                transform.frame([0.0; 3]).map(|frame| (frame.to_machine(by), frame.to_machine([0.0; 3])));
            let Some((end, start)) = turned else {
                return Err(words.refuse_code(refusal::IN_FRAME_WITHOUT_INVERSE, span));
            };
            (0..3).for_each(|i| shift[i] += end[i] - start[i]);
        }
        FramePart::Rotation => {
            let angle = rotation_words(words, span, state)?;
            let before = match transform {
                Transform::None => 0.0,
                Transform::Rotation { plane, angle_deg, .. } if plane == state.plane => angle_deg,
                _ => return Err(in_which_order(words, span, &transform)),
            };
            let angle_deg = before + angle;
            transform = Transform::Rotation { plane: state.plane, centre_mm: [0.0; 2], angle_deg };
        }
        FramePart::Mirror => {
            let mut about = match transform {
                Transform::None => [None; 3],
                Transform::Mirror(about) => about,
                _ => return Err(in_which_order(words, span, &transform)),
            };
            for i in 0..3 {
                let Some(value) = words.coordinate(LINEAR[i], false) else { continue };
                if value != 0.0 {
                    let at = words.span(Letters::of(&[LINEAR[i]]));
                    return Err(words.refuse(refusal::MIRROR_ABOUT_ANOTHER_PLACE, at));
                }
                // Twice is none.
                about[i] = if about[i].is_some() { None } else { Some(0.0) };
            }
            transform = if about == [None; 3] { Transform::None } else { Transform::Mirror(about) };
        }
    }
    state.shifts.local_mm = shift;
    if transform != state.transform {
        unsettle(state, transform);
    }
    Ok(())
}

fn in_which_order(
    words: &Words<'_, '_, '_>,
    span: Span,
    transform: &Transform,
) -> Box<diagnostic::Diagnostic> {
    words.refuse_code(refusal::under_another_transform(&transform.name()), span)
}

/// The angle of ROT in the plane, degrees: `RPL=`, or the word of the axis that stands upright on the plane.
fn rotation_words(words: &Words<'_, '_, '_>, span: Span, state: &Modal) -> Outcome<f64> {
    let normal = LINEAR[state.plane.axes()[2]];
    let out = words.letters.and(AXIS_LETTERS).without(Letters::of(&[normal]));
    if !out.is_empty() {
        return Err(words.refuse(refusal::ROTATION_OUT_OF_PLANE, words.span(out)));
    }
    // RPL= is a word of L.
    match (words.coordinate(b'L', false), words.coordinate(normal, false)) {
        (Some(angle), None) | (None, Some(angle)) => Ok(angle),
        _ => Err(words.refuse_code(refusal::BY_TWO_ANGLES, span)),
    }
}

/// G10's P: the work offset codes of the table in order, G54 being the first.
fn offset_of_number(env: &Environment<'_>, p: u32) -> Option<String> {
    let mut names = env.dialect.codes.iter().filter_map(|entry| match &entry.action {
        Action::WorkOffset(name) => Some(name),
        _ => None,
    });
    names.nth(usize::try_from(p).ok()?.checked_sub(1)?).cloned()
}

/// G68, G51, G51.1.
fn transform(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    span: Span,
    action: &Action,
    state: &Modal,
) -> Outcome<Transform> {
    absolute(words, span, state)?;
    let again = matches!((action, state.transform), (Action::MirrorOn, Transform::Mirror(_)));
    if !state.transform.is_none() && !again {
        return Err(words.refuse_code(refusal::in_which_order(&state.transform.name()), span));
    }
    let inch = state.units == Units::Inch;
    let unit_mm = state.units.mm();
    let at = |letter: u8| words.coordinate(letter, inch).map(|value| value * unit_mm);
    match action {
        Action::RotationOn => {
            let [u, v, n] = state.plane.axes();
            let across = CENTRE_LETTERS.or(Letters::of(&[LINEAR[n]]));
            if words.has(across) {
                return Err(words.refuse(refusal::ROTATION_THAT_TILTS, words.span(across)));
            }
            let (Some(first), Some(second)) = (at(LINEAR[u]), at(LINEAR[v])) else {
                let names = Letters::of(&[LINEAR[u], LINEAR[v]]).names();
                return Err(words.refuse(refusal::rotation_without(names), span));
            };
            let Some(angle_deg) = words.coordinate(b'R', false) else {
                return Err(words.refuse(refusal::ROTATION_WITHOUT_R, span));
            };
            Ok(Transform::Rotation { plane: state.plane, centre_mm: [first, second], angle_deg })
        }
        Action::ScalingOn => {
            let (Some(x), Some(y), Some(z)) = (at(b'X'), at(b'Y'), at(b'Z')) else {
                return Err(words.refuse(refusal::SCALING_WITHOUT_CENTRE, span));
            };
            let factor = |letter: u8| {
                let (number, _) = words.number(letter)?;
                let step = if number.has_point { 1.0 } else { env.dialect.frames.scaling_step };
                Some(number.decimal.to_f64() * step)
            };
            let factors = match (factor(b'P'), [b'I', b'J', b'K'].map(factor)) {
                (Some(p), [None, None, None]) if p > 0.0 => [p; 3],
                (None, [Some(i), Some(j), Some(k)]) if i * j * k != 0.0 => [i, j, k],
                _ => {
                    return Err(words.refuse(refusal::SCALING_WITHOUT_FACTOR, span));
                }
            };
            Ok(Transform::Scaling { centre_mm: [x, y, z], factors })
        }
        _ => {
            let about = shift_words(words, span, state)?;
            let mut all = if let Transform::Mirror(all) = state.transform { all } else { [None; 3] };
            for i in 0..3 {
                if about[i].is_some() && all[i].is_some() {
                    return Err(words.refuse(refusal::mirrored_already(LINEAR[i] as char), span));
                }
                all[i] = about[i].or(all[i]);
            }
            Ok(Transform::Mirror(all))
        }
    }
}

/// G50.1: the axes named are no longer mirrored.
fn mirror_off(words: &Words<'_, '_, '_>, span: Span, state: &mut Modal) -> Outcome<()> {
    let Transform::Mirror(mut about) = state.transform else { return Ok(()) };
    if !words.has(LINEAR_LETTERS) {
        return Err(words.refuse_code(refusal::MIRROR_WITHOUT_AXES, span));
    }
    for i in 0..3 {
        if words.has(Letters::of(&[LINEAR[i]])) {
            about[i] = None;
        }
    }
    let rest = if about == [None; 3] { Transform::None } else { Transform::Mirror(about) };
    unsettle(state, rest);
    Ok(())
}
