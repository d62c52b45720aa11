//! Columns of the linear model: set-up, and effects per unit of a coefficient.

use machine_model::Vector;
use machine_model::effects::{EffectGeometry, EffectKind, Shape};
use units::math;

use crate::effects::{self, Along};
use crate::equations::observation::{Reading, Row, Scalar};

/// One column; its value is the displacement in µm per unit of its coefficient.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Term {
    /// The measuring frame is shifted; coefficient in µm.
    SetupShift(usize),
    /// The measuring frame is turned about the machine's origin; coefficient in µrad.
    SetupRotation(usize),
    /// A run is turned about its middle; coefficient in µrad.
    RunRotation {
        /// Index of the run.
        run: usize,
        /// Direction it is turned about.
        about: usize,
        /// Middle of its tips, mm.
        centre_mm: [f64; 3],
    },
    /// An instrument has another zero than the first one; coefficient in µm.
    InstrumentShift {
        /// Its number.
        instrument: usize,
        /// Component.
        axis: usize,
    },
    /// A station's frame lies otherwise than the first one's; coefficient in µm for 0 to 2 (shift), µrad for 3 to 5 (turn).
    StationFrame {
        /// Its number.
        station: usize,
        /// Component.
        component: usize,
    },
    /// The ball bar is longer than it says; coefficient in µm.
    BarLength,
    /// Rows whose direction of approach on an axis is not known, among others where it is: their mean may
    /// lie anywhere between the two sides. First the axis, then the component it is seen in.
    UnknownApproach(usize),
    /// Readings drift in the order of the rows, where no time is given; coefficient in µm at the end.
    Order {
        /// Component.
        component: usize,
        /// Anew in every run, or through all of them.
        anew: bool,
        /// Time constant as a share of the file or of the longest run; infinite for an even drift.
        tau: f64,
    },
    /// Readings jump from one row on, where no time is given; coefficient in µm.
    Knock {
        /// Component.
        component: usize,
        /// How far through the file that row stands.
        from: f64,
    },
    /// One coefficient of an effect, in the unit of its name.
    Effect {
        /// Which.
        kind: EffectKind,
        /// Index into its coefficient names.
        index: usize,
        /// Its non-linear numbers.
        shape: Shape,
    },
}

impl Term {
    /// Displacement in µm per unit. Conditions that are missing in single rows displace nothing.
    pub(crate) fn displacement_um(&self, row: &Row, geometry: &EffectGeometry) -> Vector {
        match self {
            Self::SetupShift(axis) => unit(*axis),
            Self::SetupRotation(axis) => unit(*axis).cross(&geometry.nominal_tip_mm(&row.command)) * 1e-3,
            Self::RunRotation { run, about, centre_mm } => {
                if row.run != *run {
                    return Vector::zeros();
                }
                let tip = row.command.linear_mm + row.command.tool_mm;
                unit(*about).cross(&(1e-3 * (tip - Vector::from(*centre_mm))))
            }
            Self::InstrumentShift { instrument, axis } if row.instrument == Some(*instrument) => unit(*axis),
            Self::UnknownApproach(axis) if row.command.direction[*axis] == 0 => unit(*axis),
            Self::InstrumentShift { .. } | Self::UnknownApproach(_) | Self::BarLength => Vector::zeros(),
            Self::StationFrame { station, component } => match (row.station == Some(*station), component) {
                (false, _) => Vector::zeros(),
                (true, 0..=2) => unit(*component),
                (true, _) => unit(component - 3).cross(&geometry.nominal_tip_mm(&row.command)) * 1e-3,
            },
            Self::Order { component, anew, tau } => {
                let (passed, grown) = (row.order[usize::from(*anew)], |way: f64| 1.0 - math::exp(-way / tau));
                unit(*component) * if tau.is_finite() { grown(passed) / grown(1.0) } else { passed }
            }
            Self::Knock { component, from } => unit(*component) * f64::from(u8::from(row.order[0] >= *from)),
            Self::Effect { kind, index, shape } => kind
                .unit_displacement_mm(*index, shape, &row.command, &row.conditions, geometry)
                .map_or_else(|_| Vector::zeros(), |v| v * 1e3),
        }
    }

    /// What the equation sees of the column.
    pub(crate) fn value(&self, scalar: &Scalar, row: &Row, geometry: &EffectGeometry) -> f64 {
        if let Self::BarLength = self {
            return if matches!(row.reading, Reading::Length { .. }) { 1.0 } else { 0.0 };
        }
        if scalar.class < 3 && !self.touches(scalar.class, geometry) {
            return 0.0;
        }
        scalar.along.dot(&self.displacement_um(row, geometry))
    }

    /// The effect that it is a column of.
    pub(crate) fn kind(&self) -> Option<EffectKind> {
        match self {
            Self::Effect { kind, .. } => Some(*kind),
            Self::Order { .. } => Some(EffectKind::InstrumentDrift),
            Self::Knock { component, .. } => Some(EffectKind::Step(*component)),
            _ => None,
        }
    }

    /// The non-linear numbers of an effect.
    pub(crate) fn shape(&self) -> Option<Shape> {
        if let Self::Effect { shape, .. } = self { Some(*shape) } else { None }
    }

    /// The axis on whose position and direction of approach, and the rotary axes, alone the displacement depends; `None`
    /// where it depends on more.
    pub(crate) fn axis(&self) -> Option<usize> {
        let Self::Effect { kind, index, .. } = *self else { return None };
        let alone = match effects::of(kind).search.along {
            Along::Line | Along::Curve | Along::Reversal | Along::Place => true,
            Along::Droop => index < 3,
            Along::Angle | Along::Elsewhere => false,
        };
        kind.axis().filter(|_| alone)
    }

    /// False where the component is zero for every row, known without looking.
    pub(crate) fn touches(&self, component: usize, geometry: &EffectGeometry) -> bool {
        match *self {
            // Turned with the table it is seen in any.
            Self::Effect { .. } if geometry.has_table() => true,
            Self::SetupShift(axis) | Self::UnknownApproach(axis) => axis == component,
            Self::SetupRotation(axis) | Self::RunRotation { about: axis, .. } => axis != component,
            Self::InstrumentShift { axis, .. } => axis == component,
            Self::StationFrame { component: shift @ 0..=2, .. } => shift == component,
            Self::StationFrame { component: turn, .. } => turn - 3 != component,
            Self::Order { component: own, .. } | Self::Knock { component: own, .. } => own == component,
            Self::BarLength => false,
            Self::Effect { kind, index, .. } => match kind {
                EffectKind::Scale(a)
                | EffectKind::Thermal(a)
                | EffectKind::Warmup(a)
                | EffectKind::Backlash(a)
                | EffectKind::Positioning(a)
                | EffectKind::Pitch(a)
                | EffectKind::Load(a)
                | EffectKind::ServoLag(a)
                | EffectKind::Step(a)
                | EffectKind::Spike(a)
                | EffectKind::SpindleTilt(a)
                | EffectKind::Squareness(a, _) => a == component,
                EffectKind::LostMotion { direction, .. } | EffectKind::Straightness { direction, .. } => {
                    direction == component
                }
                EffectKind::ServoMismatch(a, b) => a == component || b == component,
                EffectKind::Contraction => index == 0 || index == component + 1,
                EffectKind::Angular { about, .. } => about != component,
                EffectKind::Local(_) | EffectKind::Joint(_) => index == component,
                EffectKind::InstrumentDrift => index % 3 == component,
                EffectKind::Sag(a) => {
                    if index < 3 {
                        component == 2
                    } else {
                        component != 1 - a
                    }
                }
                EffectKind::ProbeLobing
                | EffectKind::Rotary { .. }
                | EffectKind::Eccentricity(_)
                | EffectKind::Tracker(_) => true,
            },
        }
    }
}

pub(crate) fn unit(axis: usize) -> Vector {
    let mut v = Vector::zeros();
    v[axis] = 1.0;
    v
}
