//! The names of effects.

use crate::AXES;

/// A cause that a profile may lack. The numbers are axes: 0 is X, 1 is Y, 2 is Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effect {
    /// Wrong scale of an axis.
    Scale(usize),
    /// Thermal expansion of an axis' scale.
    Thermal(usize),
    /// Shift of an axis while the machine warms up.
    Warmup(usize),
    /// Lost travel of an axis at reversal.
    Backlash(usize),
    /// Shift in the first direction when the second axis reverses.
    LostMotion(usize, usize),
    /// Squareness between two axes, the lower one first.
    Squareness(usize, usize),
    /// Positioning curve of an axis.
    Positioning(usize),
    /// Straightness: error in the first direction along the second axis.
    Straightness(usize, usize),
    /// Error periodic with an axis' screw.
    Pitch(usize),
    /// Angular error about the first direction along the second axis.
    Angular(usize, usize),
    /// Droop along -Z with the overhang of an axis.
    Sag(usize),
    /// Deflection in a direction by the load.
    Load(usize),
    /// Following error of an axis.
    ServoLag(usize),
    /// Unequal following errors of two axes, the lower one first.
    ServoMismatch(usize, usize),
    /// Sudden shift in a direction at a time.
    Step(usize),
    /// Damage at a place of an axis.
    Local(usize),
    /// Location error of the rotary axis C in X (0) or Y (1).
    RotaryC(usize),
    /// Once-per-turn error of the rotary axis C.
    Eccentricity,
    /// Direction-dependent pre-travel of the probe.
    ProbeLobing,
    /// Slow common drift of the instrument.
    InstrumentDrift,
}

impl Effect {
    /// The contract's id, for example `backlash.X` or `straightness.EYX`.
    #[must_use]
    pub fn id(self) -> String {
        let axis = |a: usize| AXES[a];
        let about = |a: usize| ['A', 'B', 'C'][a];
        match self {
            Self::Scale(a) => format!("scale.{}", axis(a)),
            Self::Thermal(a) => format!("thermal.{}", axis(a)),
            Self::Warmup(a) => format!("warmup.{}", axis(a)),
            Self::Backlash(a) => format!("backlash.{}", axis(a)),
            Self::LostMotion(d, a) => format!("lost-motion.E{}{}", axis(d), axis(a)),
            Self::Squareness(a, b) => format!("squareness.{}{}", axis(a), axis(b)),
            Self::Positioning(a) => format!("positioning.E{0}{0}", axis(a)),
            Self::Straightness(d, a) => format!("straightness.E{}{}", axis(d), axis(a)),
            Self::Pitch(a) => format!("pitch.{}", axis(a)),
            Self::Angular(d, a) => format!("angular.E{}{}", about(d), axis(a)),
            Self::Sag(a) => format!("sag.{}", axis(a)),
            Self::Load(a) => format!("load.{}", axis(a)),
            Self::ServoLag(a) => format!("servo-lag.{}", axis(a)),
            Self::ServoMismatch(a, b) => format!("servo-mismatch.{}{}", axis(a), axis(b)),
            Self::Step(a) => format!("step.{}", axis(a)),
            Self::Local(a) => format!("local.{}", axis(a)),
            Self::RotaryC(d) => format!("rotary.E{}0C", axis(d)),
            Self::Eccentricity => "eccentricity.C".into(),
            Self::ProbeLobing => "probe-lobing".into(),
            Self::InstrumentDrift => "instrument-drift".into(),
        }
    }

    /// The id without the axis: `backlash`, `straightness`.
    #[must_use]
    pub fn family(self) -> String {
        let id = self.id();
        id.split('.').next().unwrap_or(&id).to_owned()
    }

    /// Every effect of linear axes, of conditions and of the instrument.
    #[must_use]
    pub fn linear() -> Vec<Self> {
        let mut all = Vec::new();
        for a in 0..3 {
            all.extend([Self::Scale(a), Self::Thermal(a), Self::Warmup(a), Self::Backlash(a)]);
            all.extend([Self::Positioning(a), Self::Pitch(a), Self::Load(a), Self::ServoLag(a)]);
            all.extend([Self::Step(a), Self::Local(a)]);
            for d in 0..3 {
                all.push(Self::Angular(d, a));
                if d != a {
                    all.extend([Self::LostMotion(d, a), Self::Straightness(d, a)]);
                }
            }
        }
        for (a, b) in [(0, 1), (0, 2), (1, 2)] {
            all.extend([Self::Squareness(a, b), Self::ServoMismatch(a, b)]);
        }
        all.extend([Self::Sag(0), Self::Sag(1), Self::ProbeLobing, Self::InstrumentDrift]);
        all.sort_unstable();
        all
    }

    /// Every effect that needs the rotary axis C.
    #[must_use]
    pub fn rotary() -> Vec<Self> {
        vec![Self::RotaryC(0), Self::RotaryC(1), Self::Eccentricity]
    }

    /// True where nature knows one sign only: play and lag hold back, gravity pulls down.
    pub(crate) fn one_signed(self) -> bool {
        matches!(self, Self::Backlash(_) | Self::ServoLag(_) | Self::Sag(_))
    }

    /// True where the effect changes with time or load and so must be seen within a run, not between runs.
    pub(crate) fn needs_long_runs(self) -> bool {
        matches!(self, Self::Warmup(_) | Self::Step(_) | Self::Load(_) | Self::InstrumentDrift)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_are_those_of_the_contract_and_differ() {
        assert_eq!(Effect::LostMotion(1, 0).id(), "lost-motion.EYX");
        assert_eq!(Effect::Angular(0, 1).id(), "angular.EAY");
        assert_eq!(Effect::Squareness(0, 2).id(), "squareness.XZ");
        assert_eq!(Effect::RotaryC(0).id(), "rotary.EX0C");
        let mut ids: Vec<String> = Effect::linear().into_iter().map(Effect::id).collect();
        assert_eq!(ids.len(), 61);
        ids.dedup();
        assert_eq!(ids.len(), 61);
    }
}
