//! What the words of a grammar's `does` mean.

use crate::control::{
    Action, Called, CornerForm, CurveCode, FramePart, PlaneCode, Pockets, Side, TipSwitch, TurningCycle,
};
use nc_syntax::GCode;
use toolpath::CycleKind;

/// Every word that `does` takes and its action, in the order of the manual.
static ACTIONS: [(&str, Action); 122] = [
    ("rapid", Action::Rapid),
    ("line", Action::Line),
    ("arc-clockwise", Action::ArcClockwise),
    ("arc-counterclockwise", Action::ArcCounterClockwise),
    ("dwell", Action::Dwell),
    ("dwell-by-setting", Action::DwellBySetting),
    ("plane-xy", Action::Plane(PlaneCode::Xy)),
    ("plane-zx", Action::Plane(PlaneCode::Zx)),
    ("plane-yz", Action::Plane(PlaneCode::Yz)),
    ("inch", Action::Inch),
    ("millimetre", Action::Millimetre),
    ("reference", Action::Reference),
    ("machine-coordinates", Action::MachineCoordinates),
    ("probe", Action::Probe),
    ("compensation-off", Action::CompensationOff),
    ("compensation-left", Action::Compensation(Side::Left)),
    ("compensation-right", Action::Compensation(Side::Right)),
    ("length-on", Action::LengthOn),
    ("length-on-negative", Action::LengthOnNegative),
    ("length-off", Action::LengthOff),
    ("tip-length-on", Action::TipLengthOn),
    ("tip-length-on-vectors", Action::TipLengthOnVectors),
    ("tip-on", Action::Tip(TipSwitch::On)),
    ("tip-off", Action::Tip(TipSwitch::Off)),
    ("tilted-plane", Action::TiltedPlane),
    ("align-tool", Action::AlignTool),
    ("work-offset", Action::WorkOffset(String::new())),
    ("drill", Action::Cycle(CycleKind::Drill)),
    ("bore", Action::Cycle(CycleKind::Bore)),
    ("bore-out", Action::Cycle(CycleKind::BoreOut)),
    ("peck-full", Action::Cycle(CycleKind::PeckFull)),
    ("peck-chip", Action::Cycle(CycleKind::PeckChip)),
    ("synchronised-cycle", Action::Cycle(CycleKind::Synchronised)),
    ("cycle-cancel", Action::CycleCancel),
    ("return-initial", Action::ReturnInitial),
    ("return-r", Action::ReturnR),
    ("return-level", Action::ReturnLevel),
    ("absolute", Action::Absolute),
    ("incremental", Action::Incremental),
    ("arc-centres-absolute", Action::ArcCentresAbsolute),
    ("arc-centres-incremental", Action::ArcCentresIncremental),
    ("feed-inverse-time", Action::FeedInverseTime),
    ("feed-per-minute", Action::FeedPerMinute),
    ("feed-per-revolution", Action::FeedPerRevolution),
    ("work-offset-numbered", Action::WorkOffsetNumbered),
    ("work-offset-by-h", Action::WorkOffsetByH),
    ("write-offset", Action::WriteOffset),
    ("local-shift", Action::LocalShift),
    ("preset", Action::Preset),
    ("preset-cancel", Action::PresetCancel),
    ("preset-suspend", Action::PresetSuspend),
    ("preset-restore", Action::PresetRestore),
    ("rotation-on", Action::RotationOn),
    ("rotation-off", Action::RotationOff),
    ("scaling-on", Action::ScalingOn),
    ("scaling-off", Action::ScalingOff),
    ("mirror-on", Action::MirrorOn),
    ("mirror-off", Action::MirrorOff),
    ("polar-on", Action::PolarOn),
    ("polar-off", Action::PolarOff),
    ("length-from-words", Action::LengthFromWords),
    ("dwell-p", Action::DwellP),
    ("diameter-on", Action::DiameterOn),
    ("diameter-off", Action::DiameterOff),
    ("diameter-of-absolute", Action::DiameterOfAbsolute),
    ("speed-limit", Action::SpeedLimit),
    ("limit-or-preset", Action::LimitOrPreset),
    ("thread", Action::Thread),
    ("curve-cubic", Action::Curve(CurveCode::Cubic)),
    ("curve-quadratic", Action::Curve(CurveCode::Quadratic)),
    ("curve-points", Action::Curve(CurveCode::Points)),
    ("curve-end", Action::Curve(CurveCode::End)),
    ("curve-knots", Action::Curve(CurveCode::Knots)),
    ("curve-plane-knots", Action::Curve(CurveCode::PlaneKnots)),
    ("turn-pass", Action::Turning(TurningCycle::TurnPass)),
    ("thread-pass", Action::Turning(TurningCycle::ThreadPass)),
    ("face-pass", Action::Turning(TurningCycle::FacePass)),
    ("finish-contour", Action::Turning(TurningCycle::Finish)),
    ("rough-turn", Action::Turning(TurningCycle::RoughTurn)),
    ("rough-face", Action::Turning(TurningCycle::RoughFace)),
    ("rough-pattern", Action::Turning(TurningCycle::RoughPattern)),
    ("peck-face", Action::Turning(TurningCycle::PeckFace)),
    ("peck-groove", Action::Turning(TurningCycle::PeckGroove)),
    ("thread-passes", Action::Turning(TurningCycle::ThreadPasses)),
    ("drill-face", Action::Turning(TurningCycle::DrillFace)),
    ("bore-face", Action::Turning(TurningCycle::BoreFace)),
    ("finish-routine", Action::Turning(TurningCycle::FinishRoutine)),
    ("rough-turn-routine", Action::Turning(TurningCycle::RoughTurnRoutine(Pockets::All))),
    ("rough-turn-routine-no-pockets", Action::Turning(TurningCycle::RoughTurnRoutine(Pockets::Leave))),
    ("rough-turn-routine-pockets", Action::Turning(TurningCycle::RoughTurnRoutine(Pockets::Only))),
    ("rough-face-routine", Action::Turning(TurningCycle::RoughFaceRoutine(Pockets::All))),
    ("rough-face-routine-no-pockets", Action::Turning(TurningCycle::RoughFaceRoutine(Pockets::Leave))),
    ("rough-face-routine-pockets", Action::Turning(TurningCycle::RoughFaceRoutine(Pockets::Only))),
    ("frame-shift", Action::ProgramFrame { part: FramePart::Shift, adds: false }),
    ("frame-shift-more", Action::ProgramFrame { part: FramePart::Shift, adds: true }),
    ("frame-rotation", Action::ProgramFrame { part: FramePart::Rotation, adds: false }),
    ("frame-rotation-more", Action::ProgramFrame { part: FramePart::Rotation, adds: true }),
    ("frame-mirror", Action::ProgramFrame { part: FramePart::Mirror, adds: false }),
    ("frame-mirror-more", Action::ProgramFrame { part: FramePart::Mirror, adds: true }),
    ("base-frame", Action::BaseFrame),
    ("swivel", Action::Swivel),
    ("call-drill", Action::Called(Called::Drill)),
    ("call-drill-dwell", Action::Called(Called::DrillDwell)),
    ("call-drill-pecks", Action::Called(Called::DrillPecks)),
    ("call-bore-feeds", Action::Called(Called::BoreFeeds)),
    ("call-bore-oriented", Action::Called(Called::BoreOriented)),
    ("call-modal", Action::Called(Called::Modal)),
    ("call-holes-row", Action::Called(Called::HolesRow)),
    ("call-holes-circle", Action::Called(Called::HolesCircle)),
    ("arc-turns", Action::Called(Called::Turns)),
    ("arc-angle", Action::Called(Called::ArcAngle)),
    ("corner-round", Action::Called(Called::Corner(CornerForm::Round))),
    ("corner-chamfer", Action::Called(Called::Corner(CornerForm::Chamfer))),
    ("corner-chamfer-length", Action::Called(Called::Corner(CornerForm::ChamferLength))),
    ("pass", Action::Pass { takes_words: false }),
    ("pass-with-words", Action::Pass { takes_words: true }),
    ("pass-with-p", Action::PassWithP),
    ("contour-tolerance", Action::ContourTolerance),
    ("alarm", Action::Alarm),
    ("call", Action::Call),
    ("dynamic-offset", Action::DynamicOffset),
    ("dynamic-offset-off", Action::DynamicOffsetOff),
];

/// Every word that `does` takes.
pub fn action_names() -> impl Iterator<Item = &'static str> {
    ACTIONS.iter().map(|(name, _)| *name)
}

/// The action of a name, for a code: a work offset is called what its code is called.
#[must_use]
pub fn action_named(name: &str, code: GCode) -> Option<Action> {
    match ACTIONS.iter().find(|(known, _)| *known == name)? {
        (_, Action::WorkOffset(_)) => Some(Action::WorkOffset(code.to_string())),
        (_, action) => Some(action.clone()),
    }
}

/// The word of a grammar for an action; `refuse` for a refused one.
#[must_use]
pub fn action_name(action: &Action) -> &'static str {
    match action {
        Action::Refuse { .. } => "refuse",
        Action::WorkOffset(_) => "work-offset",
        // Every other action has one name whatever the code; `names_and_actions_agree` proves that one is found.
        other => ACTIONS.iter().find(|(_, known)| known == other).map_or("pass", |(name, _)| name),
    }
}

/// The known name nearest to a misspelt one, where one is near.
pub(crate) fn nearest(found: &str) -> Option<&'static str> {
    let found = found.to_ascii_lowercase().replace(['_', ' '], "-");
    let (distance, name) = action_names().map(|name| (edits(&found, name), name)).min()?;
    (distance <= 1 + name.len() / 4).then_some(name)
}

/// Number of letters to add, remove or change (Levenshtein 1966).
fn edits(from: &str, to: &str) -> usize {
    let to: Vec<char> = to.chars().collect();
    let mut row: Vec<usize> = (0..=to.len()).collect();
    for (i, a) in from.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, b) in to.iter().enumerate() {
            let change = diagonal + usize::from(a != *b);
            diagonal = row[j + 1];
            row[j + 1] = change.min(diagonal + 1).min(row[j] + 1);
        }
    }
    row[to.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_actions_agree() {
        for name in action_names() {
            let action = action_named(name, GCode(540)).unwrap();
            assert_eq!(action_name(&action), name);
        }
    }

    #[test]
    fn a_misspelt_name_finds_its_neighbour() {
        assert_eq!(nearest("millimeter"), Some("millimetre"));
        assert_eq!(nearest("Arc_Clockwise"), Some("arc-clockwise"));
        assert_eq!(nearest("peck"), None);
        assert_eq!(edits("kitten", "sitting"), 3);
    }
}
