//! What each effect displaces, per unit of each of its coefficients.

use units::math;

use super::spec::{Origin, Spec, curve_order};
use super::{EffectGeometry, EffectKind};
use crate::{Command, Vector};

/// What the error may depend on besides the command; `None` where it is not known.
///
/// ```
/// use machine_model::effects::{Conditions, EffectTerm};
/// use machine_model::{Command, Vector};
///
/// let warm = EffectTerm::from_entry("thermal.X", &[("expansion_um_per_m_k".to_owned(), 11.5)]).unwrap();
/// let at = Command {
///     linear_mm: Vector::new(200.0, 0.0, 0.0),
///     rotary_rad: Vector::zeros(),
///     tool_mm: Vector::zeros(),
///     direction: [0; 3],
///     ..Default::default()
/// };
/// // Calibrated at 20 °C: at that temperature the machine is as its tables say, and an unknown one is never guessed.
/// let known = Conditions { temp_c: [Some(20.0); 3], ..Conditions::default() };
/// assert_eq!(warm.displacement_mm(&at, &known).map(|moved| moved.x), Ok(0.0));
/// assert!(warm.displacement_mm(&at, &Conditions::default()).is_err());
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Conditions {
    /// Temperature of each axis (or of the machine, three times), °C.
    pub temp_c: [Option<f64>; 3],
    /// Time since power-on or since the measurement began, s.
    pub time_s: Option<f64>,
    /// Load on the table or at the tool, kg.
    pub load_kg: Option<f64>,
    /// Feed along the path, mm/min.
    pub feed_mm_min: Option<f64>,
    /// Share of that feed that each linear axis runs at, 0 to 1; `None`: all that move run alike.
    pub share: Option<[f64; 3]>,
    /// Way along the path since each axis last turned, mm; not known before it first turns.
    pub since_turn_mm: [Option<f64>; 3],
    /// Curvature of the path towards its centre, 1/mm; `None`: not known, and taken to be straight.
    pub curvature_per_mm: Option<[f64; 3]>,
    /// Where the instrument stands, machine coordinates, mm.
    pub station_mm: Option<[f64; 3]>,
}

/// A condition an effect needs and was not given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the effect depends on the {0}, which is not known here")]
pub struct MissingCondition(pub &'static str);

/// The non-linear part of an effect: where, when, with which period.
///
/// Only the fields an effect uses count; the others stay zero.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    /// Interval over which polynomials are normalised to -1..=1 (and overhang to 0..=1), mm.
    pub from_mm: f64,
    /// Its upper end, mm.
    pub to_mm: f64,
    /// Period of the screw, mm.
    pub pitch_mm: f64,
    /// First time constant, s.
    pub tau_s: f64,
    /// Second time constant, s.
    pub tau2_s: f64,
    /// Time of the knock, s.
    pub time_s: f64,
    /// Middle of the damage, mm.
    pub centre_mm: f64,
    /// Its full width, mm.
    pub width_mm: f64,
}

impl Shape {
    /// Position on -1..=1; beyond the interval the nearest end, since polynomials run away there.
    #[must_use]
    pub fn relative(&self, position_mm: f64) -> f64 {
        let half = 0.5 * (self.to_mm - self.from_mm);
        if half > 0.0 {
            ((position_mm - 0.5 * (self.to_mm + self.from_mm)) / half).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    }

    /// Overhang beyond the support, 1 at the far end; none before the support.
    fn overhang(&self, position_mm: f64) -> f64 {
        (0.5 * (self.relative(position_mm) + 1.0)).max(0.0)
    }
}

/// Legendre polynomial of order `order` (0..=15) at `v`, by the three-term recurrence.
#[must_use]
pub fn legendre(order: usize, v: f64) -> f64 {
    let (mut before, mut now) = (1.0, v);
    if order == 0 {
        return before;
    }
    for k in 1..order {
        let k = k as f64;
        let next = ((2.0 * k + 1.0) * v * now - k * before) / (k + 1.0);
        before = now;
        now = next;
    }
    now
}

impl EffectKind {
    /// Displacement of the tip by one unit of coefficient `index`, mm, as the workpiece sees it.
    ///
    /// Forms and signs: docs/diagnosis.md, "The library". First order in the coefficients. What arises along the
    /// linear axes is turned with the ideal table ([`EffectGeometry::table_turn`]), equation (23).
    ///
    /// # Errors
    /// [`MissingCondition`] where a needed condition is not known. A direction of 0 displaces by the mean
    /// of both directions.
    pub fn unit_displacement_mm(
        &self,
        index: usize,
        shape: &Shape,
        command: &Command,
        conditions: &Conditions,
        geometry: &EffectGeometry,
    ) -> Result<Vector, MissingCondition> {
        let arising = self.arising_mm(index, &At { shape, command, conditions, geometry })?;
        let is_turned = matches!(Spec::of(*self).origin, Origin::LinearAxes | Origin::Probe);
        let turns = is_turned && geometry.has_table();
        Ok(if turns { geometry.table_turn(command) * arising } else { arising })
    }

    /// The displacement where it arises: along the linear axes, or as the workpiece sees it.
    fn arising_mm(&self, index: usize, at: &At<'_>) -> Result<Vector, MissingCondition> {
        let q = &at.command.linear_mm;
        Ok(match *self {
            Self::Scale(a) => along(a, 1e-6 * q[a]),
            Self::Thermal(a) => {
                let rise = at.rise(a)?;
                along(a, [1e-6 * rise * q[a], 1e-3 * rise, 1e-6 * rise * rise * q[a]][index.min(2)])
            }
            Self::Warmup(a) => {
                let tau_s = if index == 0 { at.shape.tau_s } else { at.shape.tau2_s };
                along(a, 1e-3 * (1.0 - math::exp(-at.time()?.max(0.0) / tau_s.max(1e-9))))
            }
            Self::Backlash(a) => along(a, -1e-3 * at.dir(a) * legendre(index, at.relative(a))),
            Self::LostMotion { direction, axis } => {
                along(direction, -1e-3 * at.dir(axis) * legendre(index, at.relative(axis)))
            }
            Self::Squareness(0, 2) => along(0, 1e-6 * q[2]),
            Self::Squareness(a, b) => along(a, -1e-6 * q[b]),
            Self::Positioning(a) => along(a, 1e-3 * legendre(curve_order(index), at.relative(a))),
            Self::Straightness { direction, axis } => {
                along(direction, 1e-3 * legendre(curve_order(index), at.relative(axis)))
            }
            Self::Pitch(a) => at.pitch(a, index),
            Self::Angular { about, axis } => {
                let lever = at.geometry.lever_mm(axis, at.command);
                along(about, 1e-6 * legendre(index + 1, at.relative(axis))).cross(&lever)
            }
            Self::Sag(a) => at.sag(a, index),
            Self::Load(a) => {
                let load = at.conditions.load_kg.ok_or(MissingCondition("load"))?;
                along(a, -1e-3 * if index == 0 { load } else { load * load })
            }
            Self::ServoLag(a) => {
                let speed = at.feed_mm_ms()?;
                along(a, -at.dir(a) * [speed, at.axis_speed(speed, a), speed * speed * 60.0][index.min(2)])
            }
            Self::ServoMismatch(a, b) => at.servo_mismatch([a, b], index)?,
            Self::Rotary { component, axis } => {
                let (offset, tilt) = if component < 3 {
                    (along(component, 1e-3), Vector::zeros())
                } else {
                    (Vector::zeros(), along(component - 3, 1e-6))
                };
                at.geometry.rotary_location_mm(axis, offset, tilt, at.command)
            }
            Self::Eccentricity(axis) => at.eccentricity(axis, index),
            Self::ProbeLobing => at.probe_lobing(index),
            Self::InstrumentDrift => {
                let hours = at.time()? / 3600.0;
                along(index % 3, 1e-3 * if index < 3 { hours } else { hours * hours })
            }
            Self::Step(a) => along(a, if at.time()? >= at.shape.time_s { 1e-3 } else { 0.0 }),
            Self::Local(a) => {
                let wave = math::cos(0.5 * std::f64::consts::PI * at.off_centre(a).abs().min(1.0));
                along(index, 1e-3 * wave * wave)
            }
            Self::Joint(a) => {
                let ramp = math::sin(0.5 * std::f64::consts::PI * at.off_centre(a).clamp(-1.0, 1.0));
                along(index, 0.5e-3 * (1.0 + ramp))
            }
            Self::Spike(a) => {
                let fade = |way: f64| math::exp(-way / at.shape.width_mm.max(1e-9));
                along(a, -1e-3 * at.dir(a) * at.conditions.since_turn_mm[a].map_or(0.0, fade))
            }
            Self::Contraction => {
                // µm per m/s² are 1e-6 s².
                let speed_mm_s = 1e3 * at.feed_mm_ms()?;
                let curvature = Vector::from(at.conditions.curvature_per_mm.unwrap_or_default());
                let seen = if index == 0 { curvature } else { along(index - 1, curvature[index - 1]) };
                seen * (1e-6 * speed_mm_s * speed_mm_s)
            }
            Self::SpindleTilt(a) => along(a, -1e-6 * at.command.tool_mm.z),
            Self::Tracker(fault) => {
                let station = at.conditions.station_mm.ok_or(MissingCondition("place of the station"))?;
                tracker(fault, index, at.geometry.nominal_tip_mm(at.command) - Vector::from(station))
            }
        })
    }
}

fn along(axis: usize, value_mm: f64) -> Vector {
    let mut v = Vector::zeros();
    v[axis] = value_mm;
    v
}

/// Where and when an effect is asked for.
struct At<'a> {
    shape: &'a Shape,
    command: &'a Command,
    conditions: &'a Conditions,
    geometry: &'a EffectGeometry,
}

impl At<'_> {
    fn dir(&self, axis: usize) -> f64 {
        f64::from(self.command.direction[axis])
    }

    fn relative(&self, axis: usize) -> f64 {
        self.shape.relative(self.command.linear_mm[axis])
    }

    /// From the middle of a damage, in halves of its width.
    fn off_centre(&self, axis: usize) -> f64 {
        (self.command.linear_mm[axis] - self.shape.centre_mm) / (0.5 * self.shape.width_mm).max(1e-9)
    }

    fn rise(&self, axis: usize) -> Result<f64, MissingCondition> {
        let temp_c = self.conditions.temp_c[axis].ok_or(MissingCondition("temperature"))?;
        Ok(temp_c - self.geometry.reference_temp_c)
    }

    fn time(&self) -> Result<f64, MissingCondition> {
        self.conditions.time_s.ok_or(MissingCondition("time"))
    }

    fn feed_mm_ms(&self) -> Result<f64, MissingCondition> {
        self.conditions.feed_mm_min.map(|f| f / 60_000.0).ok_or(MissingCondition("feed"))
    }

    /// Speed of an axis, mm/ms: its share of the feed, or that of all that move where the shares are not known.
    fn axis_speed(&self, speed_mm_ms: f64, axis: usize) -> f64 {
        self.conditions.share.map_or_else(
            || {
                let moving = self.command.direction.iter().filter(|d| **d != 0).count().max(1);
                speed_mm_ms / (moving as f64).sqrt()
            },
            |share| speed_mm_ms * share[axis],
        )
    }

    fn pitch(&self, a: usize, index: usize) -> Vector {
        let harmonic = (index % 6) / 2 + 1;
        let q = self.command.linear_mm[a];
        let phase = std::f64::consts::TAU * harmonic as f64 * q / self.shape.pitch_mm.max(1e-9);
        let (sin, cos) = math::sin_cos(phase);
        let modulation = if index >= 6 { self.relative(a) } else { 1.0 };
        along(a, 1e-3 * modulation * if index.is_multiple_of(2) { sin } else { cos })
    }

    fn servo_mismatch(&self, [a, b]: [usize; 2], index: usize) -> Result<Vector, MissingCondition> {
        let (da, db) = (self.dir(a), self.dir(b));
        let feed = self.feed_mm_ms()?;
        if da == 0.0 || db == 0.0 {
            return Ok(Vector::zeros());
        }
        let speed = |axis: usize| {
            let own = self.axis_speed(feed, axis);
            if index == 0 { own } else { own * own * 60.0 }
        };
        Ok(along(a, -0.5 * da * speed(a)) + along(b, 0.5 * db * speed(b)))
    }

    fn eccentricity(&self, axis: usize, index: usize) -> Vector {
        let (sin, cos) = math::sin_cos(self.command.rotary_rad[axis]);
        let wave = if index.is_multiple_of(2) { sin } else { cos };
        let moved = |error_rad: f64, radial_mm: Vector| {
            self.geometry.rotary_motion_mm(axis, error_rad, radial_mm, self.command)
        };
        match index {
            0 | 1 => moved(1e-6 * wave, Vector::zeros()),
            2 | 3 => moved(0.0, along((axis + 1) % 3, 1e-3 * wave)),
            _ => moved(0.0, along((axis + 2) % 3, 1e-3 * wave)),
        }
    }

    fn probe_lobing(&self, index: usize) -> Vector {
        let direction = Vector::new(self.dir(0), self.dir(1), self.dir(2));
        let norm = direction.norm();
        if norm == 0.0 {
            return Vector::zeros();
        }
        if index == 4 {
            // Pushed along the stylus it triggers otherwise than sideways.
            let share = direction.z * direction.z / (norm * norm);
            return direction * (1e-3 * share / norm);
        }
        let angle = math::atan2(direction.y, direction.x) * if index < 2 { 3.0 } else { 2.0 };
        let (sin, cos) = math::sin_cos(angle);
        direction * (1e-3 / norm * if index.is_multiple_of(2) { cos } else { sin })
    }

    /// Droop of an overhanging beam (Euler–Bernoulli): end load goes with the cube of the overhang, an end
    /// moment with its square, own weight with the fourth power; the end turns with the slope.
    fn sag(&self, axis: usize, index: usize) -> Vector {
        let overhang = self.shape.overhang(self.command.linear_mm[axis]);
        let power = |n: i32| overhang.powi(n);
        match index {
            0 => along(2, -1e-3 * power(3)),
            1 => along(2, -1e-3 * power(2)),
            2 => along(2, -1e-3 * power(4)),
            _ => {
                // Slope downwards along the axis: Y droops by turning about -X, X by turning about +Y.
                let turn = if axis == 1 { along(0, -1e-6 * power(2)) } else { along(1, 1e-6 * power(2)) };
                turn.cross(&self.geometry.lever_mm(axis, self.command))
            }
        }
    }
}

/// What a tracker reads wrong of a tip at `v` mm from its station, mm per unit; azimuth about Z from +X, elevation from the
/// horizontal. Equation (76).
fn tracker(fault: usize, index: usize, v: Vector) -> Vector {
    let (range, level) = (v.norm(), (v.x * v.x + v.y * v.y).sqrt());
    if range <= 0.0 || level <= 0.0 {
        return Vector::zeros();
    }
    let out = v / range;
    let aside = Vector::new(-v.y, v.x, 0.0) / level;
    let up = out.cross(&aside);
    let pick = |sin: f64, cos: f64| if index == 0 { sin } else { cos };
    match fault {
        0 => 1e-6 * v,
        1 => 1e-3 * out,
        2 => 1e-6 * level * pick(v.y / level, v.x / level) * aside,
        3 => 1e-6 * range * pick(v.z / range, level / range) * up,
        4 => 1e-6 * v.z * aside,
        _ => 1e-6 * range * aside,
    }
}
