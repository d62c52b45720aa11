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
