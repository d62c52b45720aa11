//! Designs on purpose blind: which two names they make the same.

use crate::effect::Effect;

/// Designs that make two names the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Alias {
    /// One feed and no diagonals: servo lag and backlash of an axis.
    LagOrBacklash,
    /// One tool: squareness to Z and an angle of Z that grows evenly.
    SquarenessOrAngle,
    /// One temperature, not 20 °C: scale and thermal expansion.
    ScaleOrThermal,
    /// X lines at Y = 0 and one height: straightness EYX and roll EAX.
    StraightnessOrRoll,
    /// Load that comes on once: load and step.
    LoadOrStep,
    /// One component, short series: warm-up and drift of the instrument.
    WarmupOrDrift,
}

impl Alias {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::LagOrBacklash,
        Self::SquarenessOrAngle,
        Self::ScaleOrThermal,
        Self::StraightnessOrRoll,
        Self::LoadOrStep,
        Self::WarmupOrDrift,
    ];

    /// The true effect of the `turn`-th case of this alias.
    pub(crate) fn truth(self, turn: usize) -> Effect {
        let axis = turn / 2 % 3;
        let first = turn.is_multiple_of(2);
        match self {
            Self::LagOrBacklash if first => Effect::ServoLag(axis),
            Self::LagOrBacklash => Effect::Backlash(axis),
            Self::SquarenessOrAngle => match turn % 4 {
                0 => Effect::Squareness(0, 2),
                1 => Effect::Angular(1, 2),
                2 => Effect::Squareness(1, 2),
                _ => Effect::Angular(0, 2),
            },
            Self::ScaleOrThermal if first => Effect::Scale(axis),
            Self::ScaleOrThermal => Effect::Thermal(axis),
            Self::StraightnessOrRoll => Effect::Straightness(1, 0),
            Self::LoadOrStep => Effect::Load(turn % 3),
            Self::WarmupOrDrift if first => Effect::Warmup(axis),
            Self::WarmupOrDrift => Effect::InstrumentDrift,
        }
    }

    /// The axis a blind plan must look along, where it looks along one only.
    pub(crate) fn axis(self, turn: usize) -> usize {
        turn / 2 % 3
    }
}
