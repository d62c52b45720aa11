//! Which axes the program has itself named in the frame in force.
//!
//! A correction may bring words for axes that a block does not hold. Such a word says a place in program coordinates,
//! so it moves the axis by whatever is wrong in our idea of the frame: a tool length that G53 has cancelled, an offset
//! that the control does not have. Where the program has said, in the same frame, where the axis is, a word for it
//! moves it by the correction and nothing else. So a word is added only for an axis that is [`Naming::Named`]; each
//! code after which controls may differ in what stands in the frame takes the name from the axes that it concerns.
//!
//! Where controls also differ in whether the axis moves (a tool length that changes without a motion of the axis in the
//! same block), its position is unknown.

use nc_dialect::{Action, FramePart};
use nc_syntax::{GCode, Letters};
use toolpath::Kinematics;

use crate::environment::{Demand, Environment, Owner};
use crate::modal::{Axis, Compensation, Distance, Lost, Modal, Naming, ReturnLevel, Shifts, Why};
use crate::moved::Moved;
use crate::words::{AXIS_LETTERS, LINEAR, LINEAR_LETTERS, Words};

/// Axes by index.
type Set = [bool; 3];

const ALL: Set = [true; 3];
/// Z, along which a control adds a length that no profile gives.
const ALONG_Z: Set = [false, false, true];

fn either(a: Set, b: Set) -> Set {
    [0, 1, 2].map(|i| a[i] || b[i])
}

/// The linear axes that the block has words for.
fn written(words: &Words<'_, '_, '_>) -> Set {
    LINEAR.map(|letter| words.has(Letters::of(&[letter])))
}

/// Those of them that say a place, not an increment.
fn absolutely_written(words: &Words<'_, '_, '_>, state: &Modal) -> Set {
    let own = written(words);
    [0, 1, 2].map(|i| own[i] && !words.by_increment[i] && state.distance == Distance::Absolute)
}

/// Takes the name from the axes that the codes of a block concern, before anything moves.
///
/// * `before` – the state before the block
/// * `state` – the one with its codes applied
pub(crate) fn disturb(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &mut Modal,
) {
    let said = !words.codes.is_empty() || !words.m_codes.is_empty() || !words.commands.is_empty();
    if !said && !words.has(Letters::of(b"DHT")) {
        return;
    }
    let actions = words.codes.iter().map(|code| &code.entry.action);
    for action in actions.chain(words.commands.iter().map(|(action, _)| *action)) {
        if let Some((axes, why)) = disturbed_by(action, words, before, state) {
            forget(words, state, axes, why);
        }
    }
    if before.kinematics != state.kinematics {
        let plane = [before, state].iter().any(|state| matches!(state.kinematics, Kinematics::Plane(_)));
        forget(words, state, ALL, if plane { Why::TiltedPlane } else { Why::Kinematics });
    }
    transformed(words, before, state);
    length(env, words, demand, before, state);
    // Some controls end a tool length with the tool, be it that its axes stay where they are.
    if let Some((code, _)) = env.tool_change(words) {
        let with_length = state.tool_length.applied_mm().map(|mm| mm != 0.0);
        forget(words, state, with_length, Why::Miscellaneous { code, changes_tool: true });
    }
    // Beside cutter compensation D is a radius, which is in no frame.
    let by_radius = [before, state].iter().any(|state| state.compensation != Compensation::Off);
    // Beside G96 of a lathe it limits the spindle's speed.
    let by_speed =
        env.dialect.turning.is_some() && words.codes.iter().any(|code| code.entry.code == GCode(960));
    if words.has(Letters::of(b"D")) && !by_radius && !by_speed && !same_edge(env, before, state) {
        forget(words, state, ALL, Why::ToolOffset);
    }
}

/// The axes that a code concerns. A work offset and a unit that the program says again change nothing.
fn disturbed_by(
    action: &Action,
    words: &Words<'_, '_, '_>,
    before: &Modal,
    state: &mut Modal,
) -> Option<(Set, Why)> {
    let stated = &mut state.stated;
    // Some controls end a tool length with it.
    let own_and_length = either(written(words), state.tool_length.applied_mm().map(|mm| mm != 0.0));
    let axes = match action {
        // What it takes the place of ends with it; a rotation or mirror is seen by its own axes.
        Action::ProgramFrame { part, .. } => {
            let shifted = before.shifts.local_mm.map(|mm| mm != 0.0);
            if *part == FramePart::Shift { either(written(words), shifted) } else { shifted }
        }
        Action::WorkOffset(_) | Action::WorkOffsetNumbered | Action::WorkOffsetByH | Action::BaseFrame => {
            let again = std::mem::replace(&mut stated.work_offset, true)
                && before.work_offset == state.work_offset
                && before.shifts == Shifts::default();
            return (!again).then_some((ALL, Why::Frame));
        }
        Action::Inch | Action::Millimetre => {
            return (!std::mem::replace(&mut stated.units, true)).then_some((ALL, Why::Units));
        }
        Action::MachineCoordinates if words.has(AXIS_LETTERS) => {
            return Some((own_and_length, Why::MachineWords));
        }
        Action::Reference => {
            return Some((if words.has(AXIS_LETTERS) { own_and_length } else { ALL }, Why::Reference));
        }
        Action::LocalShift | Action::Preset | Action::PresetCancel | Action::WriteOffset
            if words.has(LINEAR_LETTERS) =>
        {
            written(words)
        }
        Action::PresetCancel | Action::PresetSuspend | Action::PresetRestore => ALL,
        Action::LengthFromWords => {
            // One control has it, and moves nothing.
            stated.tool_length = true;
            return Some((written(words), Why::ToolLength));
        }
        _ => return None,
    };
    Some((axes, Why::Frame))
}

/// Axes that a rotation, scaling or mirror moves, or moved.
fn transformed(words: &Words<'_, '_, '_>, before: &Modal, state: &mut Modal) {
    if before.transform != state.transform {
        forget(words, state, either(before.transform.touches(), state.transform.touches()), Why::Frame);
    }
}

/// The edge that the program has chosen before is in force behind the block as well: choosing it again changes nothing.
fn same_edge(env: &Environment<'_>, before: &Modal, state: &Modal) -> bool {
    env.dialect.edge_in_d
        && before.stated.tool_length
        && before.tool_length == state.tool_length
        && before.tool_loaded == state.tool_loaded
        && !before.edge_unsaid
        && !state.edge_unsaid
}

/// Codes of the tool length: some controls move its axes at once, others with their next words.
fn length(
    env: &Environment<'_>,
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &mut Modal,
) {
    use Action::{LengthOff, LengthOn, LengthOnNegative, TipLengthOn, TipLengthOnVectors};
    let says = words.codes.iter().any(|code| {
        matches!(
            code.entry.action,
            LengthOn | LengthOnNegative | LengthOff | TipLengthOn | TipLengthOnVectors
        )
    });
    let by_turret = env.dialect.turning.as_ref().is_some_and(|turning| {
        (turning.offset_in_t && words.has(Letters::of(b"T")))
            || (turning.offset_in_d && words.has(Letters::of(b"DT")))
    });
    let by_edge = env.dialect.edge_in_d
        && (words.has(Letters::of(b"D")) || before.edge_unsaid != state.edge_unsaid)
        && !same_edge(env, before, state);
    let by_tool = by_turret || by_edge;
    let says = says || by_tool;
    if !says && !words.has(Letters::of(b"H")) {
        return;
    }
    let (was, is) = (before.tool_length.applied_mm(), state.tool_length.applied_mm());
    let has_length = |mm: [f64; 3]| mm.map(|mm| mm != 0.0);
    let mut changed = [0, 1, 2].map(|i| was[i] != is[i]);
    if says && !std::mem::replace(&mut state.stated.tool_length, true) {
        // What an earlier program left in force ends with it.
        let lengths = env.setup.tools.iter().map(|(_, vector)| has_length(*vector));
        changed = lengths.fold(ALONG_Z, either);
    }
    let concerned = either(either(has_length(was), has_length(is)), either(changed, ALONG_Z));
    forget(words, state, concerned, Why::ToolLength);
    if env.dialect.length_shifts && !by_tool {
        return;
    }
    // An absolute word in the same block leads to one place on all controls; in a cycle it is a depth.
    let along_cycle = state.cycle.map(|_| state.plane.axes()[2]);
    let absolute = demand.owner == Owner::Motion;
    let own = absolutely_written(words, state);
    for i in (0..3).filter(|i| changed[*i] && env.moves_axis(*i)) {
        let led = absolute && own[i] && along_cycle != Some(i);
        if !led && matches!(state.axes.linear[i], Axis::At(_)) {
            state.axes.linear[i] = Axis::Unknown(Lost { why: Why::ToolLength, line: words.block.line });
        }
    }
}

/// No axis is named any more.
pub(crate) fn forget_all(words: &Words<'_, '_, '_>, state: &mut Modal, why: Why) {
    forget(words, state, ALL, why);
}

/// The axes are named no more.
fn forget(words: &Words<'_, '_, '_>, state: &mut Modal, axes: Set, why: Why) {
    for i in (0..3).filter(|i| axes[*i]) {
        state.named[i] = Naming::Since(Lost { why, line: words.block.line });
    }
}

/// Names the axes whose absolute words a motion has taken, and takes the name from those that the block has moved
/// elsewhere or turned, scaled or mirrored.
pub(crate) fn name(
    words: &Words<'_, '_, '_>,
    demand: &Demand<'_>,
    before: &Modal,
    state: &mut Modal,
    moved: &Moved,
) {
    if moved.motions.is_empty() {
        transformed(words, before, state);
    }
    let motion = matches!(demand.owner, Owner::Motion | Owner::DwellP) && !moved.motions.is_empty();
    if motion {
        for (i, own) in absolutely_written(words, state).into_iter().enumerate() {
            // A hole's depth is no place where the axis stands; its R level is, where that is said in the frame in
            // force.
            let named = match state.cycle {
                Some(cycle) if state.plane.axes()[2] == i && state.distance == Distance::Absolute => {
                    state.return_level == ReturnLevel::R
                        && cycle.retract.is_some_and(|level| !level.incremental)
                }
                _ => own,
            };
            if named {
                state.named[i] = Naming::Named;
            }
        }
    }
    for i in 0..3 {
        if let (Axis::Unknown(lost), Naming::Named) = (state.axes.linear[i], state.named[i]) {
            state.named[i] = Naming::Since(lost);
        }
    }
}
