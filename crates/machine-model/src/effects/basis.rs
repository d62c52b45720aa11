//! What each effect displaces, per unit of each of its coefficients.

use units::math;

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

/// Of a curve along an axis; its slope comes last, for that is mostly the business of a scale, a squareness or the frame.
const CURVE: [&str; 7] = ["p2_um", "p3_um", "p4_um", "p5_um", "p6_um", "p7_um", "p1_um"];

/// Order of the polynomial that a coefficient of [`CURVE`] belongs to.
pub(super) const fn curve_order(index: usize) -> usize {
    if index == CURVE.len() - 1 { 1 } else { index + 2 }
}

const ANGULAR: [&str; 8] =
    ["p0_urad", "p1_urad", "p2_urad", "p3_urad", "p4_urad", "p5_urad", "p6_urad", "p7_urad"];
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

impl EffectKind {
    /// Names of the coefficients, with their unit; the displacement is linear in them.
    #[must_use]
    pub fn coefficient_names(&self) -> &'static [&'static str] {
        match *self {
            Self::Scale(_) => &["scale_um_per_m"],
            Self::Thermal(_) => &["expansion_um_per_m_k", "shift_um_per_k", "expansion2_um_per_m_k2"],
            Self::Warmup(_) => &["amplitude_um", "amplitude2_um"],
            Self::Backlash(_) | Self::LostMotion { .. } => &HALF_WIDTH,
            Self::Squareness(..) => &["angle_urad"],
            Self::Positioning(_) | Self::Straightness { .. } => &CURVE,
            Self::Pitch(_) => &PITCH,
            Self::Angular { .. } => ANGULAR.split_at(1).1,
            Self::Sag(_) => &["droop3_um", "droop2_um", "droop4_um", "tilt_urad"],
            Self::Load(_) => &["compliance_um_per_kg", "compliance2_um_per_kg2"],
            Self::ServoLag(_) => &["lag_ms", "path_lag_ms", "lag2_ms_per_m_min"],
            Self::ServoMismatch(..) => &["mismatch_ms", "mismatch2_ms_per_m_min"],
            Self::Rotary { component: 0..=2, .. } => &["offset_um"],
            Self::Rotary { .. } => &["angle_urad"],
            Self::Eccentricity(_) => &[
                "sin_urad",
                "cos_urad",
                "radial_sin1_um",
                "radial_cos1_um",
                "radial_sin2_um",
                "radial_cos2_um",
            ],
            Self::ProbeLobing => &["cos3_um", "sin3_um", "cos2_um", "sin2_um", "pole_um"],
            Self::InstrumentDrift => {
                &["x_um_per_h", "y_um_per_h", "z_um_per_h", "x_um_per_h2", "y_um_per_h2", "z_um_per_h2"]
            }
            Self::Step(_) => &["shift_um"],
            Self::Local(_) | Self::Joint(_) => &["x_um", "y_um", "z_um"],
            Self::Spike(_) => &["spike_um"],
            Self::Contraction => &["path_um_per_m_s2", "x_um_per_m_s2", "y_um_per_m_s2", "z_um_per_m_s2"],
            Self::SpindleTilt(_) => &["tilt_urad"],
            Self::Tracker(0) => &["scale_um_per_m"],
            Self::Tracker(1) => &["offset_um"],
            Self::Tracker(2 | 3) => &["sin_urad", "cos_urad"],
            Self::Tracker(_) => &["angle_urad"],
        }
    }

    /// Names of the [`Shape`] fields the effect uses.
    #[must_use]
    pub const fn shape_names(&self) -> &'static [&'static str] {
        match self {
            Self::Warmup(_) => &["tau_s", "tau2_s"],
            Self::Backlash(_)
            | Self::LostMotion { .. }
            | Self::Positioning(_)
            | Self::Straightness { .. }
            | Self::Angular { .. }
            | Self::Sag(_) => &["from_mm", "to_mm"],
            Self::Pitch(_) => &["pitch_mm", "from_mm", "to_mm"],
            Self::Step(_) => &["time_s"],
            Self::Local(_) | Self::Joint(_) => &["centre_mm", "width_mm"],
            Self::Spike(_) => &["width_mm"],
            _ => &[],
        }
    }

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
        let arising = self.arising_mm(index, shape, command, conditions, geometry)?;
        let turns = self.arises_along_linear_axes() && geometry.has_table();
        Ok(if turns { geometry.table_turn(command) * arising } else { arising })
    }

    /// What a linear axis, its drive or the spindle does, and what turns with the table for the workpiece; a table's
    /// own errors and the drift of an instrument are seen from the workpiece as they are.
    const fn arises_along_linear_axes(&self) -> bool {
        !matches!(
            self,
            Self::Rotary { .. } | Self::Eccentricity(_) | Self::InstrumentDrift | Self::Tracker(_)
        )
    }

    /// The displacement where it arises: along the linear axes, or as the workpiece sees it.
    fn arising_mm(
        &self,
        index: usize,
        shape: &Shape,
        command: &Command,
        conditions: &Conditions,
        geometry: &EffectGeometry,
    ) -> Result<Vector, MissingCondition> {
        let q = &command.linear_mm;
        let along = |axis: usize, value_mm: f64| {
            let mut v = Vector::zeros();
            v[axis] = value_mm;
            v
        };
        let dir = |axis: usize| f64::from(command.direction[axis]);
        let time = || conditions.time_s.ok_or(MissingCondition("time"));
        let feed_mm_ms = || conditions.feed_mm_min.map(|f| f / 60_000.0).ok_or(MissingCondition("feed"));
        Ok(match *self {
            Self::Scale(a) => along(a, 1e-6 * q[a]),
            Self::Thermal(a) => {
                let rise =
                    conditions.temp_c[a].ok_or(MissingCondition("temperature"))? - geometry.reference_temp_c;
                along(a, [1e-6 * rise * q[a], 1e-3 * rise, 1e-6 * rise * rise * q[a]][index.min(2)])
            }
            Self::Warmup(a) => {
                let tau_s = if index == 0 { shape.tau_s } else { shape.tau2_s };
                along(a, 1e-3 * (1.0 - math::exp(-time()?.max(0.0) / tau_s.max(1e-9))))
            }
            Self::Backlash(a) => along(a, -1e-3 * dir(a) * legendre(index, shape.relative(q[a]))),
            Self::LostMotion { direction, axis } => {
                along(direction, -1e-3 * dir(axis) * legendre(index, shape.relative(q[axis])))
            }
            Self::Squareness(0, 2) => along(0, 1e-6 * q[2]),
            Self::Squareness(a, b) => along(a, -1e-6 * q[b]),
            Self::Positioning(a) => along(a, 1e-3 * legendre(curve_order(index), shape.relative(q[a]))),
            Self::Straightness { direction, axis } => {
                along(direction, 1e-3 * legendre(curve_order(index), shape.relative(q[axis])))
            }
            Self::Pitch(a) => {
                let harmonic = (index % 6) / 2 + 1;
                let phase = std::f64::consts::TAU * harmonic as f64 * q[a] / shape.pitch_mm.max(1e-9);
                let (sin, cos) = math::sin_cos(phase);
                let modulation = if index >= 6 { shape.relative(q[a]) } else { 1.0 };
                along(a, 1e-3 * modulation * if index.is_multiple_of(2) { sin } else { cos })
            }
            Self::Angular { about, axis } => {
                let lever = geometry.lever_mm(axis, command);
                along(about, 1e-6 * legendre(index + 1, shape.relative(q[axis]))).cross(&lever)
            }
            Self::Sag(a) => sag(a, index, shape, command, geometry),
            Self::Load(a) => {
                let load = conditions.load_kg.ok_or(MissingCondition("load"))?;
                along(a, -1e-3 * if index == 0 { load } else { load * load })
            }
            Self::ServoLag(a) => {
                let speed = feed_mm_ms()?;
                let own = axis_speed(speed, a, command, conditions);
                along(a, -dir(a) * [speed, own, speed * speed * 60.0][index.min(2)])
            }
            Self::ServoMismatch(a, b) => {
                let (da, db) = (dir(a), dir(b));
                if da == 0.0 || db == 0.0 {
                    return feed_mm_ms().map(|_| Vector::zeros());
                }
                let feed = feed_mm_ms()?;
                let speed = |axis: usize| {
                    let own = axis_speed(feed, axis, command, conditions);
                    if index == 0 { own } else { own * own * 60.0 }
                };
                along(a, -0.5 * da * speed(a)) + along(b, 0.5 * db * speed(b))
            }
            Self::Rotary { component, axis } => {
                let (offset, tilt) = if component < 3 {
                    (along(component, 1e-3), Vector::zeros())
                } else {
                    (Vector::zeros(), along(component - 3, 1e-6))
                };
                geometry.rotary_location_mm(axis, offset, tilt, command)
            }
            Self::Eccentricity(axis) => {
                let (sin, cos) = math::sin_cos(command.rotary_rad[axis]);
                let wave = if index.is_multiple_of(2) { sin } else { cos };
                match index {
                    0 | 1 => geometry.rotary_motion_mm(axis, 1e-6 * wave, Vector::zeros(), command),
                    2 | 3 => {
                        geometry.rotary_motion_mm(axis, 0.0, along((axis + 1) % 3, 1e-3 * wave), command)
                    }
                    _ => geometry.rotary_motion_mm(axis, 0.0, along((axis + 2) % 3, 1e-3 * wave), command),
                }
            }
            Self::ProbeLobing => {
                let direction = Vector::new(dir(0), dir(1), dir(2));
                let norm = direction.norm();
                if norm == 0.0 {
                    return Ok(Vector::zeros());
                }
                if index == 4 {
                    // Pushed along the stylus it triggers otherwise than sideways.
                    let share = direction.z * direction.z / (norm * norm);
                    return Ok(direction * (1e-3 * share / norm));
                }
                let angle = math::atan2(direction.y, direction.x) * if index < 2 { 3.0 } else { 2.0 };
                let (sin, cos) = math::sin_cos(angle);
                direction * (1e-3 / norm * if index.is_multiple_of(2) { cos } else { sin })
            }
            Self::InstrumentDrift => {
                let hours = time()? / 3600.0;
                along(index % 3, 1e-3 * if index < 3 { hours } else { hours * hours })
            }
            Self::Step(a) => along(a, if time()? >= shape.time_s { 1e-3 } else { 0.0 }),
            Self::Local(a) => {
                let place = (q[a] - shape.centre_mm).abs() / (0.5 * shape.width_mm).max(1e-9);
                let wave = math::cos(0.5 * std::f64::consts::PI * place.min(1.0));
                along(index, 1e-3 * wave * wave)
            }
            Self::Joint(a) => {
                let place = (q[a] - shape.centre_mm) / (0.5 * shape.width_mm).max(1e-9);
                let ramp = math::sin(0.5 * std::f64::consts::PI * place.clamp(-1.0, 1.0));
                along(index, 0.5e-3 * (1.0 + ramp))
            }
            Self::Spike(a) => {
                let faded =
                    conditions.since_turn_mm[a].map_or(0.0, |way| math::exp(-way / shape.width_mm.max(1e-9)));
                along(a, -1e-3 * dir(a) * faded)
            }
            Self::Contraction => {
                // µm per m/s² are 1e-6 s².
                let speed_mm_s = 1e3 * feed_mm_ms()?;
                let curvature = Vector::from(conditions.curvature_per_mm.unwrap_or_default());
                let seen = if index == 0 { curvature } else { along(index - 1, curvature[index - 1]) };
                seen * (1e-6 * speed_mm_s * speed_mm_s)
            }
            Self::SpindleTilt(a) => along(a, -1e-6 * command.tool_mm.z),
            Self::Tracker(fault) => {
                let station = conditions.station_mm.ok_or(MissingCondition("place of the station"))?;
                tracker(fault, index, geometry.nominal_tip_mm(command) - Vector::from(station))
            }
        })
    }
}

/// Speed of an axis, mm/ms: its share of the feed, or that of all that move where the shares are not known.
fn axis_speed(speed_mm_ms: f64, axis: usize, command: &Command, conditions: &Conditions) -> f64 {
    conditions.share.map_or_else(
        || {
            let moving = command.direction.iter().filter(|d| **d != 0).count().max(1);
            speed_mm_ms / (moving as f64).sqrt()
        },
        |share| speed_mm_ms * share[axis],
    )
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

/// Droop of an overhanging beam (Euler–Bernoulli): end load goes with the cube of the overhang, an end
/// moment with its square, own weight with the fourth power; the end turns with the slope.
fn sag(axis: usize, index: usize, shape: &Shape, command: &Command, geometry: &EffectGeometry) -> Vector {
    let overhang = shape.overhang(command.linear_mm[axis]);
    let power = |n: i32| overhang.powi(n);
    match index {
        0 => Vector::new(0.0, 0.0, -1e-3 * power(3)),
        1 => Vector::new(0.0, 0.0, -1e-3 * power(2)),
        2 => Vector::new(0.0, 0.0, -1e-3 * power(4)),
        _ => {
            // Slope downwards along the axis: Y droops by turning about -X, X by turning about +Y.
            let turn = if axis == 1 {
                Vector::new(-1e-6 * power(2), 0.0, 0.0)
            } else {
                Vector::new(0.0, 1e-6 * power(2), 0.0)
            };
            turn.cross(&geometry.lever_mm(axis, command))
        }
    }
}
