//! What the codes of a block set before anything moves, whatever their order in the block.

use diagnostic::{Text, both, refusal};
use nc_dialect::{Action, PlaneCode};
use nc_syntax::{GCode, Letters, Span};
use toolpath::{CycleKind, Kinematics, Plane};

use crate::codes;
use crate::environment::{BASE_FRAME, Demand, Environment, Owner};
use crate::modal::{
    ArcCentres, Compensation, CycleState, Distance, FeedMode, Modal, MotionMode, ReturnLevel, Shifts, Turn,
    Units, WorkOffset,
};
use crate::refusals::{frames as of_frames, settings as refusal};
use crate::tool_length::{self, Length};
use crate::words::{LINEAR_LETTERS, Outcome, Words};
use crate::{brackets, frame_state, path_control, tilted, tip, transform::Transform, work_offset};

/// Collected while the codes are read, applied afterwards in a fixed order.
#[derive(Default)]
struct Wanted<'d> {
    motion: Option<MotionMode>,
    cycle: Option<(CycleKind, GCode, u8)>,
    cancel_group: Option<u8>,
    probe_group: Option<u8>,
    offset: Option<(GCode, Option<&'d str>, Span)>,
    /// G69, G50.
    transform_off: Option<(&'d Action, Span)>,
    /// G92.1, G92.2, G92.3 where they take no words.
    shift: Option<(&'d Action, Span)>,
    length: Option<(Length, Span)>,
    /// G40.
    compensation_off: Option<Span>,
}

/// Stands for the name of a work offset that H numbers.
const BY_H: &str = "H";

/// Applies the codes of a block to the state.
///
/// `state` comes in equal to `before`.
pub(crate) fn apply<'d>(
    env: &Environment<'d>,
    words: &Words<'_, '_, 'd>,
    before: &Modal,
    state: &mut Modal,
) -> Outcome<Demand<'d>> {
    const ONE_LETTER_SETTINGS: Letters = Letters::of(b"DHT");
    let mut demand = Demand { owner: Owner::Motion, owner_span: None, written_motion: None, frame: None };
    let said = !words.codes.is_empty() || !words.m_codes.is_empty() || !words.commands.is_empty();
    if !said && !words.has(ONE_LETTER_SETTINGS) {
        return Ok(demand);
    }
    let mut wanted = Wanted::default();
    let rows = words.codes.iter().map(|row| (&row.entry.action, row.entry.code, row.entry.group, row.span));
    // What a command does, it does like a code of no group.
    let commands = words.commands.iter().map(|(action, span)| (*action, GCode(0), 0, *span));
    for (action, code, group, span) in rows.chain(commands) {
        let owner = match (action, &env.dialect.frames) {
            (Action::LimitOrPreset, _) => {
                if words.has(LINEAR_LETTERS) {
                    demand.frame = Some(&Action::Preset);
                    demand.owner = Owner::Frame;
                    demand.owner_span = Some(span);
                }
                continue;
            }
            (Action::PresetCancel, rules) if rules.local_is_preset => {
                wanted.shift = Some((action, span));
                Owner::Motion
            }
            // Without arguments it moves nothing.
            (Action::Swivel, _) if !brackets::is_reset(&words.text(span)) => Owner::Frame,
            _ => set(action, code, group, span, state, &mut wanted),
        };
        match owner {
            Owner::Motion => {
                if wanted.motion.is_some() || wanted.cycle.is_some() {
                    demand.written_motion.get_or_insert(span);
                }
            }
            owner => {
                if let Some(other) = demand.owner_span {
                    return Err(words
                        .refuse(refusal::both_take_the_words(&words.text(other), &words.text(span)), span));
                }
                demand.owner = owner;
                demand.owner_span = Some(span);
                if owner == Owner::Frame {
                    demand.frame = Some(action);
                }
            }
        }
        followed(words, before, state, action, span)?;
    }
    if let Some(said) = path_control::said(env.dialect, words, state.units) {
        state.path_control = said;
    }
    // T, H and D are arguments of what is called.
    if words.codes.iter().any(|row| row.entry.action == Action::Call) {
        return Ok(demand);
    }
    tool_length::tool(env, words, state)?;
    if let Some(offset) = wanted.offset {
        if let (code, Some(BY_H), span) = offset {
            work_offset::by_h(env, words, state, (code, span), wanted.length.is_some())?;
        } else {
            let other = takes_p(env, words, state, &demand, &wanted);
            work_offset::by_name(env, words, state, offset, other)?;
        }
    }
    // H has chosen the work offset, and no length.
    if !matches!(wanted.offset, Some((_, Some(BY_H), _))) {
        // A code that says the length says that it holds or not.
        state.edge_unsaid &= wanted.length.is_none() || env.dialect.edge_in_d;
        tool_length::length(env, words, state, wanted.length)?;
    }
    tip::switch(env, words, before, state)?;
    tilted::end(words, before, state);
    // A length that is written beside G40 is in force, or off, whatever G40 does to an earlier one.
    if let (Some(span), None) = (wanted.compensation_off, wanted.length) {
        tool_length::under_compensation_off(env, words, span, state)?;
    }
    switches(words, state, &wanted)?;
    motion(env, state, &wanted);
    if !before.transform.is_none() && before.transform == state.transform {
        transformed(words, before, state)?;
    }
    frame_state::refresh(state);
    if before.cycle.is_some() && state.cycle.is_some() {
        cycle_frame(words, before, state)?;
    }
    Ok(demand)
}

/// Refuses a code that cannot be followed here.
fn followed(
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &Modal,
    action: &Action,
    span: Span,
) -> Outcome<()> {
    let unwritten = match action {
        Action::PolarOn => Some((
            both!("its words are radius and angle", "её слова — радиус и угол"),
            both!("write the points in X and Y, G15 in force", "напишите точки в X и Y, при G15"),
        )),
        Action::Turning(_) | Action::Called(_) => Some((
            both!("a cycle of the control", "цикл стойки"),
            both!("let the CAM write the moves", "выводите движения из CAM"),
        )),
        _ => None,
    };
    if let Some((label, help)) = unwritten {
        return Err(words.refuse(
            refusal!(codes::REFUSED_CODE;
                "{} was not written out", "{} не расписана движениями", words.text(span);
                label; help
            ),
            span,
        ));
    }
    if *action == Action::Swivel && (state.shifts.local_mm != [0.0; 3] || !state.transform.is_none()) {
        return Err(words.refuse_code(refusal::WHILE_FRAME_IN_FORCE, span));
    }
    if *action == Action::ContourTolerance && may_switch_tip(&words.text(span), before) {
        let call = words.text(span);
        let name = call.split('(').next().unwrap_or_default();
        return Err(words.refuse(
            refusal!(codes::COMMAND;
                "{name} is refused: may switch TRAORI by its second argument",
                "{name} не принимается: может переключать TRAORI вторым аргументом";
                "its third digit from the right is a transformation, and 0 ends the one in force",
                "третья справа цифра — трансформация, а 0 отменяет действующую";
                "write the tolerance alone, as in CYCLE832(0.01)",
                "напишите только допуск, например CYCLE832(0.01)"
            ),
            span,
        ));
    }
    if let Action::Refuse { reason, help } = action {
        return Err(words.refused_code(span, reason, help));
    }
    Ok(())
}

/// CYCLE832: the digit of hundreds of its second argument chooses a transformation on the 840D (Programming Manual
/// Cycles); later controls do not read it, and write names there (`_ORI_FINISH`).
fn may_switch_tip(call: &str, before: &Modal) -> bool {
    let second = brackets::arguments(call).get(1).map_or("", |argument| argument.trim()).to_owned();
    let named = second.is_empty() || second.starts_with('_');
    let chooses_none = second.parse::<u32>().is_ok_and(|digits| digits / 100 % 10 == 0);
    !(named || chooses_none && before.kinematics == Kinematics::Axes)
}

/// True where P may be another code's than a work offset's: G4, G10, G64, a cycle, an arc of several turns or
/// an M code.
fn takes_p(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    state: &Modal,
    demand: &Demand<'_>,
    wanted: &Wanted<'_>,
) -> bool {
    let motion = wanted.motion.unwrap_or(state.motion);
    let curve = matches!(motion, MotionMode::Curve(..));
    let arc = matches!(motion, MotionMode::Arc(..));
    let cycle = wanted.cycle.is_some() || (state.cycle.is_some() && wanted.motion.is_none());
    let own = words.codes.iter().any(|row| row.entry.action == Action::PassWithP);
    demand.owner != Owner::Motion
        || own
        || cycle
        || curve
        || !words.m_codes.is_empty()
        || (arc && env.dialect.frames.arc_turns)
}

/// G69, G50, and G92.1 to G92.3 where they take no words: done before the motion of their block.
fn switches(words: &Words<'_, '_, '_>, state: &mut Modal, wanted: &Wanted<'_>) -> Outcome<()> {
    let off = match (wanted.transform_off, &state.transform) {
        (Some((Action::RotationOff, span)), Transform::Rotation { .. })
        | (Some((Action::ScalingOff, span)), Transform::Scaling { .. }) => Some(span),
        _ => None,
    };
    let Some(span) = off.or(wanted.shift.map(|(_, span)| span)) else { return Ok(()) };
    if state.compensation != Compensation::Off {
        return Err(words.refuse_code(of_frames::UNDER_CUTTER_COMPENSATION, span));
    }
    if off.is_some() {
        frame_state::unsettle(state, Transform::None);
    }
    let Some((action, span)) = wanted.shift else { return Ok(()) };
    let shifts = &mut state.shifts;
    match (action, shifts.kept_mm) {
        (Action::PresetCancel, _) => (shifts.preset_mm, shifts.kept_mm) = ([0.0; 3], Some([0.0; 3])),
        (Action::PresetSuspend, _) => (shifts.preset_mm, shifts.kept_mm) = ([0.0; 3], Some(shifts.preset_mm)),
        (_, Some(kept)) => shifts.preset_mm = kept,
        (_, None) => {
            return Err(words.refuse_code(of_frames::WITHOUT_SHIFT_OF_THIS_PROGRAM, span));
        }
    }
    Ok(())
}

/// What says where words lead, and is another one now.
fn changed(before: &Modal, after: &Modal) -> Option<Text> {
    [
        (before.plane != after.plane, Text::pair("plane", "плоскость")),
        (before.units != after.units, Text::pair("unit", "единица")),
        (before.work_offset != after.work_offset, Text::pair("work offset", "смещение нуля")),
    ]
    .into_iter()
    .find_map(|(is_another, what)| is_another.then_some(what))
}

/// What may not change while a rotation, scaling or mirror is in force.
fn transformed(words: &Words<'_, '_, '_>, before: &Modal, after: &Modal) -> Outcome<()> {
    let Some(what) = changed(before, after) else { return Ok(()) };
    let span = words.codes.first().map_or_else(|| words.span(Letters::of(b"H")), |code| code.span);
    Err(words.refuse(refusal::changes_under_transform(&what, &before.transform.name()), span))
}

/// Applies the dialect's state at the start of a program. A work offset that the setup lacks is
/// remembered as lacking; codes that the table does not have are left out (`grammar check` refuses them).
pub(crate) fn initial(env: &Environment<'_>, state: &mut Modal) {
    let nowhere = Span { start: 0, end: 0 };
    let mut wanted = Wanted::default();
    for entry in env.dialect.initial.iter().filter_map(|&code| env.dialect.code(code)) {
        set(&entry.action, entry.code, entry.group, nowhere, state, &mut wanted);
    }
    if let Some((code, name, _)) = wanted.offset {
        let zero_mm = name.and_then(|name| env.setup.work_offset(name));
        state.work_offset = WorkOffset { code: Some(code), number: None, zero_mm, rewritten: false };
    }
    motion(env, state, &wanted);
    frame_state::refresh(state);
}

/// One code: sets what it sets at once, or notes what must wait; says whose the axis words are.
fn set<'d>(
    action: &'d Action,
    code: GCode,
    group: u8,
    span: Span,
    state: &mut Modal,
    wanted: &mut Wanted<'d>,
) -> Owner {
    match action {
        Action::Rapid => wanted.motion = Some(MotionMode::Rapid(code)),
        Action::Line => wanted.motion = Some(MotionMode::Line(code)),
        Action::ArcClockwise => wanted.motion = Some(MotionMode::Arc(Turn::Clockwise, code)),
        Action::ArcCounterClockwise => wanted.motion = Some(MotionMode::Arc(Turn::CounterClockwise, code)),
        Action::Thread => wanted.motion = Some(MotionMode::Thread(code)),
        Action::Curve(form) => wanted.motion = Some(MotionMode::Curve(*form, code)),
        Action::Plane(PlaneCode::Xy) => state.plane = Plane::Xy,
        Action::Plane(PlaneCode::Zx) => state.plane = Plane::Zx,
        Action::Plane(PlaneCode::Yz) => state.plane = Plane::Yz,
        Action::Inch => state.units = Units::Inch,
        Action::Millimetre => state.units = Units::Millimetre,
        Action::CompensationOff => {
            state.compensation = Compensation::Off;
            wanted.compensation_off = Some(span);
        }
        Action::Compensation(side) => state.compensation = Compensation::On(*side),
        Action::LengthOn | Action::TipLengthOn | Action::TipLengthOnVectors => {
            wanted.length = Some((Length::On { negative: false }, span))
        }
        Action::LengthOnNegative => wanted.length = Some((Length::On { negative: true }, span)),
        Action::LengthOff => wanted.length = Some((Length::Off, span)),
        Action::WorkOffset(name) => wanted.offset = Some((code, Some(name), span)),
        Action::WorkOffsetNumbered => wanted.offset = Some((code, None, span)),
        Action::WorkOffsetByH => wanted.offset = Some((code, Some(BY_H), span)),
        Action::BaseFrame => wanted.offset = Some((code, Some(BASE_FRAME), span)),
        Action::RotationOff | Action::ScalingOff => {
            // Several may stand together; the one that ends what is in force counts.
            let ends = matches!(
                (action, &state.transform),
                (Action::RotationOff, Transform::Rotation { .. })
                    | (Action::ScalingOff, Transform::Scaling { .. })
            );
            if ends {
                wanted.transform_off = Some((action, span));
            }
        }
        Action::MirrorOff if !matches!(state.transform, Transform::Mirror(_)) => return Owner::Arguments,
        Action::PresetCancel if state.shifts == Shifts::default() => return Owner::Arguments,
        Action::PresetSuspend | Action::PresetRestore => wanted.shift = Some((action, span)),
        Action::WriteOffset
        | Action::LocalShift
        | Action::Preset
        | Action::PresetCancel
        | Action::TiltedPlane
        | Action::DynamicOffset
        | Action::AlignTool
        | Action::RotationOn
        | Action::ScalingOn
        | Action::MirrorOn
        | Action::MirrorOff
        | Action::ProgramFrame { .. } => return Owner::Frame,
        Action::LengthFromWords => return Owner::Length,
        Action::DwellP => return Owner::DwellP,
        Action::Cycle(kind) => wanted.cycle = Some((*kind, code, group)),
        Action::CycleCancel => wanted.cancel_group = Some(group),
        Action::ReturnInitial => state.return_level = ReturnLevel::Initial,
        Action::ReturnR => state.return_level = ReturnLevel::R,
        Action::Absolute => state.distance = Distance::Absolute,
        Action::Incremental => state.distance = Distance::Incremental,
        Action::ArcCentresAbsolute => state.arc_centres = ArcCentres::Absolute,
        Action::ArcCentresIncremental => state.arc_centres = ArcCentres::Incremental,
        Action::FeedInverseTime => state.feed_mode = FeedMode::InverseTime,
        Action::FeedPerMinute => state.feed_mode = FeedMode::PerMinute,
        Action::FeedPerRevolution => state.feed_mode = FeedMode::PerRevolution,
        Action::Pass { takes_words: false }
        | Action::PassWithP
        | Action::ContourTolerance
        | Action::PolarOff
        | Action::DynamicOffsetOff
        | Action::Alarm
        | Action::Refuse { .. } => {}
        // Switched behind the tool length.
        Action::Tip(_) => {}
        // Asked below whether there is anything that it may end.
        Action::Swivel => {}
        // Written out before; where they are not, refused below.
        Action::PolarOn | Action::Turning(_) | Action::Called(_) => {}
        // Read before, since X words of the same block are of the new kind.
        Action::DiameterOn | Action::DiameterOff | Action::DiameterOfAbsolute | Action::SpeedLimit => {}
        Action::LimitOrPreset | Action::ReturnLevel | Action::Call | Action::Pass { takes_words: true } => {
            return Owner::Arguments;
        }
        Action::Dwell => return Owner::Dwell,
        Action::DwellBySetting => return Owner::DwellBySetting,
        Action::Reference => return Owner::Reference,
        Action::MachineCoordinates => return Owner::MachineCoordinates,
        Action::Probe => {
            // Where probing is a motion code (LinuxCNC), it replaces the one in force and is not repeated.
            wanted.probe_group = Some(group);
            return Owner::Probe;
        }
    }
    Owner::Motion
}

/// Cancels, then starts: motion codes end a cycle, cycles start a series where none is running.
fn motion(env: &Environment<'_>, state: &mut Modal, wanted: &Wanted<'_>) {
    if let Some(group) = wanted.cancel_group {
        state.cycle = None;
        if Some(group) == env.motion_group {
            state.motion = MotionMode::None;
        }
    }
    if wanted.probe_group.is_some() && wanted.probe_group == env.motion_group {
        state.motion = MotionMode::None;
        state.cycle = None;
    }
    if let Some(mode) = wanted.motion {
        state.motion = mode;
        state.cycle = None;
    }
    if let Some((kind, code, group)) = wanted.cycle {
        if Some(group) == env.motion_group {
            state.motion = MotionMode::None;
        }
        let initial = state.axes.linear[state.plane.axes()[2]];
        let running = state.cycle.unwrap_or(CycleState {
            code,
            kind,
            initial,
            retract: None,
            bottom: None,
            peck_mm: None,
            dwell: None,
            drilled: false,
        });
        state.cycle = Some(CycleState { code, kind, ..running });
    }
}

/// Levels of a running cycle are axis commands of the frame they were written in: what another frame
/// would make of them is told by no manual.
fn cycle_frame(words: &Words<'_, '_, '_>, before: &Modal, after: &Modal) -> Outcome<()> {
    let what = if let Some(what) = changed(before, after) {
        what
    } else if before.tool_length != after.tool_length {
        both!("tool length", "коррекция на длину")
    } else if before.shifts != after.shifts || before.transform != after.transform {
        both!("frame", "система координат")
    } else {
        return Ok(());
    };
    let span = words.codes.first().map_or_else(|| words.span(Letters::of(b"H")), |code| code.span);
    Err(words.refuse(refusal::changes_during_cycle(&what), span))
}
