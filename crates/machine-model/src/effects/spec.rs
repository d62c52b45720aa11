//! What each effect is, whatever its axes: one row an effect.

use super::EffectKind;

/// What is true of an effect on every axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spec {
    /// The name without the axis: `backlash` of `backlash.X`.
    pub(super) family: &'static str,
    /// Names of the coefficients, with their unit; the displacement is linear in them.
    pub(super) coefficients: &'static [&'static str],
    /// Names of the [`super::Shape`] fields that it uses, each with the first of the coefficients that need it.
    pub(super) shape: &'static [(&'static str, usize)],
    pub(super) origin: Origin,
    pub(super) direction: Direction,
}

/// Where the displacement arises.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Origin {
    /// A linear axis, its drive or the spindle: it turns with the table for the workpiece.
    LinearAxes,
    /// The probe that the spindle holds: a measuring instrument that turns likewise.
    Probe,
    /// A rotary axis: it is seen from the workpiece as it is.
    RotaryAxis,
    /// The measuring instrument, seen from the workpiece as it is.
    Instrument,
}

/// Whether the direction of motion matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Direction {
    Any,
    Matters,
}

const INTERVAL: [(&str, usize); 2] = [("from_mm", 0), ("to_mm", 0)];
/// Of what is even without it.
const VARYING: [(&str, usize); 2] = [("from_mm", 1), ("to_mm", 1)];
const PLACE: [(&str, usize); 2] = [("centre_mm", 0), ("width_mm", 0)];
const XYZ: [&str; 3] = ["x_um", "y_um", "z_um"];

/// Of a curve along an axis; its slope comes last, for that is mostly the business of a scale, a squareness or the
/// frame.
const CURVE: [&str; 7] = ["p2_um", "p3_um", "p4_um", "p5_um", "p6_um", "p7_um", "p1_um"];

/// Order of the polynomial that a coefficient of [`CURVE`] belongs to.
pub(super) const fn curve_order(index: usize) -> usize {
    if index == CURVE.len() - 1 { 1 } else { index + 2 }
}

const ANGULAR: [&str; 7] = ["p1_urad", "p2_urad", "p3_urad", "p4_urad", "p5_urad", "p6_urad", "p7_urad"];
const HALF_WIDTH: [&str; 4] = ["half_width_um", "half_width_p1_um", "half_width_p2_um", "half_width_p3_um"];
const PITCH: [&str; 12] = [
    "sin1_um",
    "cos1_um",
    "sin2_um",
    "cos2_um",
    "sin3_um",
    "cos3_um",
    "sin1_slope_um",
    "cos1_slope_um",
    "sin2_slope_um",
    "cos2_slope_um",
    "sin3_slope_um",
    "cos3_slope_um",
];
const ECCENTRICITY: [&str; 6] =
    ["sin_urad", "cos_urad", "radial_sin1_um", "radial_cos1_um", "radial_sin2_um", "radial_cos2_um"];
const DRIFT: [&str; 6] =
    ["x_um_per_h", "y_um_per_h", "z_um_per_h", "x_um_per_h2", "y_um_per_h2", "z_um_per_h2"];
const SINE: [&str; 2] = ["sin_urad", "cos_urad"];
/// By fault, in the order of [`super::TRACKER`].
const TRACKER: [&[&str]; super::TRACKER.len()] =
    [&["scale_um_per_m"], &["offset_um"], &SINE, &SINE, &["angle_urad"], &["angle_urad"]];

impl Spec {
    const fn new(family: &'static str, coefficients: &'static [&'static str]) -> Self {
        let (origin, direction) = (Origin::LinearAxes, Direction::Any);
        Self { family, coefficients, shape: &[], origin, direction }
    }

    const fn shaped(self, shape: &'static [(&'static str, usize)]) -> Self {
        Self { shape, ..self }
    }

    const fn arising(self, origin: Origin) -> Self {
        Self { origin, ..self }
    }

    const fn directed(self) -> Self {
        Self { direction: Direction::Matters, ..self }
    }

    pub(super) const fn of(kind: EffectKind) -> Self {
        use EffectKind as Kind;
        use Origin::{Instrument, Probe, RotaryAxis};
        match kind {
            Kind::Scale(_) => Self::new("scale", &["scale_um_per_m"]),
            Kind::Thermal(_) => {
                Self::new("thermal", &["expansion_um_per_m_k", "shift_um_per_k", "expansion2_um_per_m_k2"])
            }
            Kind::Warmup(_) => {
                Self::new("warmup", &["amplitude_um", "amplitude2_um"]).shaped(&[("tau_s", 0), ("tau2_s", 1)])
            }
            Kind::Backlash(_) => Self::new("backlash", &HALF_WIDTH).shaped(&VARYING).directed(),
            Kind::LostMotion { .. } => Self::new("lost-motion", &HALF_WIDTH).shaped(&VARYING).directed(),
            Kind::Squareness(..) => Self::new("squareness", &["angle_urad"]),
            Kind::Positioning(_) => Self::new("positioning", &CURVE).shaped(&INTERVAL),
            Kind::Straightness { .. } => Self::new("straightness", &CURVE).shaped(&INTERVAL),
            Kind::Pitch(_) => {
                Self::new("pitch", &PITCH).shaped(&[("pitch_mm", 0), ("from_mm", 6), ("to_mm", 6)])
            }
            Kind::Angular { .. } => Self::new("angular", &ANGULAR).shaped(&INTERVAL),
            Kind::Sag(_) => {
                Self::new("sag", &["droop3_um", "droop2_um", "droop4_um", "tilt_urad"]).shaped(&INTERVAL)
            }
            Kind::Load(_) => Self::new("load", &["compliance_um_per_kg", "compliance2_um_per_kg2"]),
            Kind::ServoLag(_) => {
                Self::new("servo-lag", &["lag_ms", "path_lag_ms", "lag2_ms_per_m_min"]).directed()
            }
            Kind::ServoMismatch(..) => {
                Self::new("servo-mismatch", &["mismatch_ms", "mismatch2_ms_per_m_min"]).directed()
            }
            Kind::Rotary { component: 0..=2, .. } => Self::new("rotary", &["offset_um"]).arising(RotaryAxis),
            Kind::Rotary { .. } => Self::new("rotary", &["angle_urad"]).arising(RotaryAxis),
            Kind::Eccentricity(_) => Self::new("eccentricity", &ECCENTRICITY).arising(RotaryAxis),
            Kind::ProbeLobing => {
                Self::new("probe-lobing", &["cos3_um", "sin3_um", "cos2_um", "sin2_um", "pole_um"])
                    .arising(Probe)
                    .directed()
            }
            Kind::InstrumentDrift => Self::new("instrument-drift", &DRIFT).arising(Instrument),
            Kind::Step(_) => Self::new("step", &["shift_um"]).shaped(&[("time_s", 0)]),
            Kind::Local(_) => Self::new("local", &XYZ).shaped(&PLACE),
            Kind::Joint(_) => Self::new("joint", &XYZ).shaped(&PLACE),
            Kind::Spike(_) => Self::new("spike", &["spike_um"]).shaped(&[("width_mm", 0)]).directed(),
            Kind::Contraction => Self::new(
                "contraction",
                &["path_um_per_m_s2", "x_um_per_m_s2", "y_um_per_m_s2", "z_um_per_m_s2"],
            ),
            Kind::SpindleTilt(_) => Self::new("spindle-tilt", &["tilt_urad"]),
            Kind::Tracker(fault) => Self::new("tracker", TRACKER[fault]).arising(Instrument),
        }
    }
}

impl EffectKind {
    /// The name without the axis: `backlash` of `backlash.X`.
    #[must_use]
    pub const fn family(&self) -> &'static str {
        Spec::of(*self).family
    }

    /// Names of the coefficients, with their unit; the displacement is linear in them.
    #[must_use]
    pub const fn coefficient_names(&self) -> &'static [&'static str] {
        Spec::of(*self).coefficients
    }

    /// Names of the [`super::Shape`] fields the effect uses.
    pub fn shape_names(&self) -> impl Iterator<Item = &'static str> + Clone {
        Spec::of(*self).shape.iter().map(|(name, _)| *name)
    }

    /// True where the effect is a fault of the measuring instrument, not of the machine.
    #[must_use]
    pub const fn is_instrument(&self) -> bool {
        matches!(Spec::of(*self).origin, Origin::Probe | Origin::Instrument)
    }

    /// True where the error depends on the direction of motion.
    #[must_use]
    pub const fn depends_on_direction(&self) -> bool {
        matches!(Spec::of(*self).direction, Direction::Matters)
    }
}
