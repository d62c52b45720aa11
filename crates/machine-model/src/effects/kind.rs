//! The catalogue of effects by name.

use std::fmt;
use std::str::FromStr;

/// Index of a linear axis in every array of three: X, Y, Z.
pub type AxisIndex = usize;

const LINEAR: [char; 3] = ['X', 'Y', 'Z'];
const ROTARY: [char; 3] = ['A', 'B', 'C'];
/// Right-handed pairs whose squareness is defined: Y to X, Z to X, Z to Y.
const PAIRS: [(AxisIndex, AxisIndex); 3] = [(0, 1), (0, 2), (1, 2)];

/// One effect that can make a machine miss; the ids are fixed by the contract.
///
/// Axes are indices into X, Y, Z (linear) or A, B, C (rotary).
///
/// ```
/// use machine_model::effects::EffectKind;
///
/// let kind: EffectKind = "lost-motion.EYX".parse().unwrap();
/// assert_eq!(kind, EffectKind::LostMotion { direction: 1, axis: 0 });
/// assert_eq!(kind.to_string(), "lost-motion.EYX");
/// assert!(kind.depends_on_direction());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum EffectKind {
    /// `scale.X`: error proportional to the command.
    Scale(AxisIndex),
    /// `thermal.X`: expansion with the temperature.
    Thermal(AxisIndex),
    /// `warmup.X`: drift that saturates with time.
    Warmup(AxisIndex),
    /// `backlash.X`: lost motion along the axis.
    Backlash(AxisIndex),
    /// `lost-motion.EYX`: sideways shift when the axis reverses.
    LostMotion {
        /// Where the shift is seen.
        direction: AxisIndex,
        /// The axis that reverses.
        axis: AxisIndex,
    },
    /// `squareness.XY`, `.XZ`, `.YZ`: first and second axis of the pair.
    Squareness(AxisIndex, AxisIndex),
    /// `positioning.EXX`: curve of the positioning error, without constant and slope.
    Positioning(AxisIndex),
    /// `straightness.EYX`: curve sideways, without constant and slope.
    Straightness {
        /// Where the curve is seen.
        direction: AxisIndex,
        /// The axis that moves.
        axis: AxisIndex,
    },
    /// `pitch.X`: periodic with the screw.
    Pitch(AxisIndex),
    /// `angular.EAX`: the carriage turns as it travels.
    Angular {
        /// Axis of the rotation: 0 for A about X, and so on.
        about: AxisIndex,
        /// The axis that moves.
        axis: AxisIndex,
    },
    /// `sag.Y`: droop with the overhang of an axis.
    Sag(AxisIndex),
    /// `load.Z`: deflection with the load.
    Load(AxisIndex),
    /// `servo-lag.X`: following error.
    ServoLag(AxisIndex),
    /// `servo-mismatch.XY`: difference of two following errors where both axes move.
    ServoMismatch(AxisIndex, AxisIndex),
    /// `rotary.EX0C` and so on: where a rotary axis lies.
    Rotary {
        /// 0..=2 for X, Y, Z (offset), 3..=5 for A, B, C (tilt).
        component: usize,
        /// Index into A, B, C.
        axis: AxisIndex,
    },
    /// `eccentricity.C`: error once per turn.
    Eccentricity(AxisIndex),
    /// `probe-lobing`: the probe's trigger depends on the direction.
    ProbeLobing,
    /// `instrument-drift`: slow drift common to everything the instrument sees.
    InstrumentDrift,
    /// `step.X`: a knock at a time.
    Step(AxisIndex),
    /// `local.X`: damage at a place.
    Local(AxisIndex),
    /// `joint.X`: rails that do not meet where they join.
    Joint(AxisIndex),
    /// `spike.X`: the axis sticks where it turns.
    Spike(AxisIndex),
    /// `contraction`: circles shrink as they are driven faster.
    Contraction,
    /// `spindle-tilt.X`: the tip goes aside with the tool's length.
    SpindleTilt(AxisIndex),
    /// `tracker.range-scale` and so on: a fault of a laser tracker, index into [`TRACKER`].
    Tracker(usize),
}

/// Faults of a laser tracker, seen from its station (ISO 10360-10, Hughes et al. 2011): range in proportion, range zero,
/// eccentric circles of azimuth and elevation, a transit axis that leans, a beam beside the axes' crossing.
pub const TRACKER: [&str; 6] =
    ["range-scale", "range-zero", "azimuth-circle", "elevation-circle", "transit-axis", "collimation"];

impl EffectKind {
    /// Every effect of the catalogue, in a fixed order.
    #[must_use]
    pub fn all() -> Vec<Self> {
        let axes = [0usize, 1, 2];
        let others = |axis: usize| axes.into_iter().filter(move |d| *d != axis);
        let mut kinds = Vec::new();
        kinds.extend(axes.map(Self::Scale));
        kinds.extend(PAIRS.map(|(a, b)| Self::Squareness(a, b)));
        kinds.extend(axes.map(Self::Backlash));
        kinds.extend(axes.map(Self::Thermal));
        kinds.extend(axes.map(Self::Warmup));
        kinds.extend(axes.map(Self::Positioning));
        for axis in axes {
            kinds.extend(others(axis).map(|direction| Self::Straightness { direction, axis }));
        }
        for axis in axes {
            kinds.extend(axes.map(|about| Self::Angular { about, axis }));
        }
        kinds.extend(axes.map(Self::Pitch));
        for axis in axes {
            kinds.extend(others(axis).map(|direction| Self::LostMotion { direction, axis }));
        }
        kinds.extend([0, 1].map(Self::Sag));
        kinds.extend(axes.map(Self::Load));
        kinds.extend(axes.map(Self::ServoLag));
        kinds.extend(PAIRS.map(|(a, b)| Self::ServoMismatch(a, b)));
        for axis in axes {
            kinds.extend(others(axis).map(|component| Self::Rotary { component, axis }));
            kinds.extend(others(axis).map(|tilt| Self::Rotary { component: 3 + tilt, axis }));
        }
        kinds.extend(axes.map(Self::Eccentricity));
        kinds.push(Self::ProbeLobing);
        kinds.push(Self::InstrumentDrift);
        kinds.extend(axes.map(Self::Step));
        kinds.extend(axes.map(Self::Local));
        kinds.extend(axes.map(Self::Joint));
        kinds.extend(axes.map(Self::Spike));
        kinds.push(Self::Contraction);
        kinds.extend([0, 1].map(Self::SpindleTilt));
        kinds.extend((0..TRACKER.len()).map(Self::Tracker));
        kinds
    }

    /// The linear axis that moves, warms up or lags; `None` where no single one does.
    #[must_use]
    pub const fn axis(&self) -> Option<AxisIndex> {
        match *self {
            Self::Scale(axis)
            | Self::Thermal(axis)
            | Self::Warmup(axis)
            | Self::Backlash(axis)
            | Self::LostMotion { axis, .. }
            | Self::Squareness(_, axis)
            | Self::Positioning(axis)
            | Self::Straightness { axis, .. }
            | Self::Pitch(axis)
            | Self::Angular { axis, .. }
            | Self::Sag(axis)
            | Self::ServoLag(axis)
            | Self::Local(axis)
            | Self::Joint(axis)
            | Self::Spike(axis) => Some(axis),
            Self::Load(_)
            | Self::ServoMismatch(..)
            | Self::Rotary { .. }
            | Self::Eccentricity(_)
            | Self::ProbeLobing
            | Self::InstrumentDrift
            | Self::Step(_)
            | Self::Contraction
            | Self::SpindleTilt(_)
            | Self::Tracker(_) => None,
        }
    }

    /// True where the coefficients can only be positive: a ram droops, it does not rise.
    #[must_use]
    pub const fn is_one_sided(&self) -> bool {
        matches!(self, Self::Sag(_))
    }
}

impl fmt::Display for EffectKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let family = self.family();
        match *self {
            Self::Scale(a)
            | Self::Thermal(a)
            | Self::Warmup(a)
            | Self::Backlash(a)
            | Self::Pitch(a)
            | Self::Sag(a)
            | Self::Load(a)
            | Self::ServoLag(a)
            | Self::Step(a)
            | Self::Local(a)
            | Self::Joint(a)
            | Self::Spike(a)
            | Self::SpindleTilt(a) => write!(f, "{family}.{}", LINEAR[a]),
            Self::Squareness(a, b) | Self::ServoMismatch(a, b) => {
                write!(f, "{family}.{}{}", LINEAR[a], LINEAR[b])
            }
            Self::Positioning(a) => write!(f, "{family}.E{}{}", LINEAR[a], LINEAR[a]),
            Self::LostMotion { direction, axis } | Self::Straightness { direction, axis } => {
                write!(f, "{family}.E{}{}", LINEAR[direction], LINEAR[axis])
            }
            Self::Angular { about, axis } => write!(f, "{family}.E{}{}", ROTARY[about], LINEAR[axis]),
            Self::Rotary { component, axis } => {
                let symbol = if component < 3 { LINEAR[component] } else { ROTARY[component - 3] };
                write!(f, "{family}.E{symbol}0{}", ROTARY[axis])
            }
            Self::Eccentricity(a) => write!(f, "{family}.{}", ROTARY[a]),
            Self::Tracker(fault) => write!(f, "{family}.{}", TRACKER[fault]),
            Self::ProbeLobing | Self::InstrumentDrift | Self::Contraction => f.write_str(family),
        }
    }
}

/// The id is not in the catalogue.
///
/// ```
/// use machine_model::effects::{EffectKind, UnknownEffect};
///
/// assert_eq!("backlash.Q".parse::<EffectKind>(), Err(UnknownEffect("backlash.Q".to_owned())));
/// ```
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "unknown effect '{0}'; known are for example scale.X, backlash.Y, squareness.XZ, straightness.EYX, angular.EAX"
)]
pub struct UnknownEffect(pub String);

impl FromStr for EffectKind {
    type Err = UnknownEffect;
    fn from_str(id: &str) -> Result<Self, Self::Err> {
        Self::all()
            .into_iter()
            .find(|kind| kind.to_string() == id)
            .ok_or_else(|| UnknownEffect(id.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_reads_back_and_is_unique() {
        let all = EffectKind::all();
        for kind in &all {
            assert_eq!(kind.to_string().parse::<EffectKind>().as_ref(), Ok(kind));
        }
        let written = include_str!("kind.rs").split_once("pub enum EffectKind {").expect("this file").1;
        for variant in written.lines().take_while(|line| *line != "}") {
            let name: String = variant.trim().chars().take_while(char::is_ascii_alphabetic).collect();
            let is_name = variant.starts_with("    ") && name.starts_with(|c: char| c.is_ascii_uppercase());
            assert!(!is_name || all.iter().any(|kind| format!("{kind:?}").starts_with(&name)), "{name}");
        }
        for id in ["lost-motion.EYX", "angular.EAX", "rotary.EX0C", "rotary.EB0A", "servo-mismatch.XY"] {
            assert!(id.parse::<EffectKind>().is_ok(), "{id}");
        }
        assert!("scale.W".parse::<EffectKind>().is_err());
        assert!("sag.Z".parse::<EffectKind>().is_err(), "droop along the droop is a positioning error");
    }
}
