//! What this room knows of each effect: one constant an effect, every field given, and one line in [`of`].

mod axes;
mod drives;
mod instruments;
mod row;
mod surroundings;

use machine_model::effects::EffectKind;

pub(crate) use instruments::FAULTS;
pub(crate) use row::{Along, Effect, Searched, Size, Why};

/// What is known of an effect.
pub(crate) fn of(kind: EffectKind) -> &'static Effect {
    match kind {
        EffectKind::Scale(_) => &axes::SCALE,
        EffectKind::Squareness(..) => &axes::SQUARENESS,
        EffectKind::Backlash(_) => &drives::BACKLASH,
        EffectKind::LostMotion { .. } => &drives::LOST_MOTION,
        EffectKind::Thermal(_) => &surroundings::THERMAL,
        EffectKind::Warmup(_) => &surroundings::WARMUP,
        EffectKind::Positioning(_) => &axes::POSITIONING,
        EffectKind::Straightness { .. } => &axes::STRAIGHTNESS,
        EffectKind::Pitch(_) => &axes::PITCH,
        EffectKind::Angular { .. } => &axes::ANGULAR,
        EffectKind::Sag(_) => &axes::SAG,
        EffectKind::Load(_) => &surroundings::LOAD,
        EffectKind::ServoLag(_) => &drives::SERVO_LAG,
        EffectKind::ServoMismatch(..) => &drives::SERVO_MISMATCH,
        EffectKind::Rotary { .. } => &surroundings::ROTARY,
        EffectKind::Eccentricity(_) => &surroundings::ECCENTRICITY,
        EffectKind::ProbeLobing => &instruments::PROBE_LOBING,
        EffectKind::InstrumentDrift => &instruments::INSTRUMENT_DRIFT,
        EffectKind::Step(_) => &surroundings::STEP,
        EffectKind::Joint(_) => &axes::JOINT,
        EffectKind::Spike(_) => &drives::SPIKE,
        EffectKind::Contraction => &drives::CONTRACTION,
        EffectKind::SpindleTilt(_) => &surroundings::SPINDLE_TILT,
        EffectKind::Tracker(_) => &instruments::TRACKER,
        EffectKind::Local(_) => &axes::LOCAL,
    }
}

/// What is straight does not swing between places.
pub(crate) fn is_straight(kind: EffectKind) -> bool {
    of(kind).search.along == Along::Line
}

/// The axis along which an effect is a curve.
pub(crate) fn curve_axis(kind: EffectKind) -> Option<usize> {
    kind.axis().filter(|_| matches!(of(kind).search.along, Along::Curve | Along::Angle | Along::Droop))
}

/// True of what an angle of a carriage, or a droop, may stand for together with another such: an axis that leans or
/// stretches, and a curve along the axis of the bent one.
pub(crate) fn gives_way_to(bent: EffectKind, other: EffectKind) -> bool {
    let axis = bent.axis().filter(|_| matches!(of(bent).search.along, Along::Angle | Along::Droop));
    axis.is_some_and(|axis| {
        is_straight(other)
            || matches!(other, EffectKind::Positioning(own) | EffectKind::Straightness { axis: own, .. } if own == axis)
    })
}
