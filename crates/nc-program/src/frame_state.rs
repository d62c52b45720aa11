//! The frame in force: made of the settings, and settled by the first motion in it.

use nc_syntax::{Letters, Span};
use toolpath::{Frame, Kinematics};

use crate::modal::{Distance, Modal};
use crate::refusals::frames as refusal;
use crate::transform::Transform;
use crate::words::{AXIS_LETTERS, Outcome, Words};

/// Makes the frame of the settings, where they give one.
pub(crate) fn refresh(state: &mut Modal) {
    let applied = state.tool_length.applied_mm();
    state.frame = state.work_offset.zero_mm.and_then(|zero| {
        let shifts = state.shifts;
        let shift = |i: usize| zero[i] + applied[i] + (shifts.local_mm[i] + shifts.preset_mm[i]);
        if let Kinematics::Plane(_) = state.kinematics {
            // Where the plane lies in the workpiece is part of it.
            return Some(Frame::shift(applied));
        }
        state.transform.frame([0, 1, 2].map(shift))
    });
}

/// Puts a transformation in force; the axes it touches, or touched, must be said anew.
pub(crate) fn unsettle(state: &mut Modal, transform: Transform) {
    let (was, is) = (state.transform.touches(), transform.touches());
    (0..3).for_each(|i| state.unsettled[i] |= was[i] || is[i]);
    state.transform = transform;
}

/// The first motion after a change of rotation, scaling or mirror says where it goes in all axes that
/// were touched, in G90: what a left-out axis or an increment starts from differs between controls.
pub(crate) fn settle(words: &Words<'_, '_, '_>, state: &mut Modal) -> Outcome<()> {
    if state.unsettled == [false; 3] {
        return Ok(());
    }
    let open = Letters::of_axes(state.unsettled);
    // An increment beside them is refused too: its start would have to be said.
    if !words.has(open) && (state.distance == Distance::Absolute || !words.has(AXIS_LETTERS)) {
        return Ok(());
    }
    if state.distance == Distance::Absolute && words.letters.and(open) == open {
        state.unsettled = [false; 3];
        return Ok(());
    }
    let names = open.names();
    Err(words.refuse(refusal::first_motion_must_be_whole(names), words.span(AXIS_LETTERS)))
}

/// Refuses what means a place under G91.
pub(crate) fn absolute(words: &Words<'_, '_, '_>, span: Span, state: &Modal) -> Outcome<()> {
    if state.distance == Distance::Incremental {
        return Err(words.refuse_code(refusal::UNDER_G91, span));
    }
    Ok(())
}
