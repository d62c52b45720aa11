//! What the rows of a file vary in, and so which effects they could show.

use machine_model::effects::{EffectKind, Shape};

use crate::effects::curve_axis;
use crate::equations::noise::median;
use crate::equations::observation::{Measurements, Reading, Row};
use crate::library::sampling::Sampling;

/// A joint is proposed by the search where an axis has so many places: with fewer it is any curve.
pub(crate) const JOINT_PLACES: f64 = 8.0;
/// What the rows vary in.
pub(super) struct Seen {
    /// The places per axis.
    pub(super) sampling: [Sampling; 3],
    pub(super) direction: [bool; 3],
    pub(super) unknown_direction: [bool; 3],
    /// A stylus came from between X and Y as well: lobes seen along the axes alone are play of theirs.
    pub(super) probed: bool,
    pub(super) temperature: [bool; 3],
    pub(super) time: Option<(f64, f64)>,
    pub(super) load: bool,
    pub(super) feed: bool,
    /// Different loads.
    pub(super) loads: usize,
    pub(super) rotary: [bool; 3],
    /// Readings are lengths of a bar.
    pub(super) lengths: bool,
    /// Tools of different lengths.
    pub(super) tools: bool,
    /// Every row has its station's place.
    pub(super) station: bool,
    /// Typical step between rows that are read while an axis moves on after it turned, mm; infinite where none is.
    pub(super) turns_mm: [f64; 3],
    /// Rows are read on curves, at a feed.
    pub(super) curved: bool,
    /// Their accelerations differ so that what grows with them is no constant.
    pub(super) accelerations: bool,
    /// Levers, by the axis that carries and the direction turned about, that are one number all over a file: there an angle is
    /// a straightness or a positioning curve with its slope, as ISO 230-4 has it of a circle, and one line of any other.
    pub(super) one_lever: [[bool; 3]; 3],
}

impl Seen {
    /// True where an effect of this kind may have so many coefficients: a curve along an axis at most half of the places
    /// measured there, shift and slope (which are the set-up's) left over for two more.
    pub(super) fn carry(&self, kind: EffectKind, coefficients: usize) -> bool {
        curve_axis(kind).is_none_or(|axis| {
            // Half a place is rounding.
            let places = self.sampling[axis].effective + 0.5;
            2.0 * coefficients as f64 <= places && coefficients as f64 + 2.0 <= places
        })
    }

    /// True where the rows vary in what an effect depends on.
    pub(super) fn shows(&self, kind: EffectKind) -> bool {
        let travels = |a: usize| self.sampling[a].range_mm.1 - self.sampling[a].range_mm.0 > 1e-6;
        match kind {
            EffectKind::Scale(a)
            | EffectKind::Positioning(a)
            | EffectKind::Straightness { axis: a, .. }
            | EffectKind::Angular { axis: a, .. }
            | EffectKind::Sag(a)
            | EffectKind::Local(a)
            | EffectKind::Pitch(a)
            | EffectKind::Joint(a) => travels(a),
            EffectKind::Squareness(a, b) => travels(a) && travels(b),
            EffectKind::Backlash(a) | EffectKind::LostMotion { axis: a, .. } | EffectKind::Spike(a) => {
                self.direction[a]
            }
            EffectKind::Thermal(a) => self.temperature[a] && travels(a),
            EffectKind::Warmup(_) | EffectKind::Step(_) | EffectKind::InstrumentDrift => self.time.is_some(),
            EffectKind::Load(_) => self.load,
            EffectKind::ServoLag(a) => self.feed && self.direction[a],
            EffectKind::ServoMismatch(a, b) => self.feed && self.direction[a] && self.direction[b],
            EffectKind::Rotary { axis, .. } | EffectKind::Eccentricity(axis) => self.rotary[axis],
            EffectKind::ProbeLobing => self.probed,
            EffectKind::Contraction => self.curved,
            EffectKind::SpindleTilt(_) => self.tools,
            EffectKind::Tracker(_) => self.station,
        }
    }

    /// A shape over the whole of an axis.
    pub(super) fn interval(&self, axis: usize) -> Shape {
        let (from_mm, to_mm) = self.sampling[axis].range_mm;
        Shape { from_mm, to_mm, ..Shape::default() }
    }

    pub(super) fn new(data: &Measurements) -> Self {
        let accelerations = accelerations(&data.rows);
        let rows = &data.rows;
        let varies = |value: &dyn Fn(&Row) -> Option<f64>| range(rows, value).is_some_and(|(a, b)| b > a);
        Self {
            sampling: [0, 1, 2].map(|a| Sampling::new(data, a)),
            direction: [0, 1, 2].map(|a| {
                let has = |d: i8| rows.iter().any(|r| r.command.direction[a] == d);
                has(1) && has(-1)
            }),
            probed: rows.iter().any(|r| r.command.direction[0] != 0 && r.command.direction[1] != 0),
            unknown_direction: [0, 1, 2].map(|a| rows.iter().any(|r| r.command.direction[a] == 0)),
            temperature: [0, 1, 2].map(|a| {
                range(rows, &|r| r.conditions.temp_c[a])
                    .is_some_and(|(low, high)| high > low || high != data.geometry.reference_temp_c)
            }),
            time: range(rows, &|r| r.conditions.time_s).filter(|(a, b)| b > a),
            load: varies(&|r| r.conditions.load_kg),
            feed: rows.iter().any(|r| r.conditions.feed_mm_min.is_some_and(|f| f > 0.0)),
            loads: distinct(rows, &|r| r.conditions.load_kg),
            rotary: [0, 1, 2]
                .map(|a| data.geometry.has_rotary(a) && varies(&|r| Some(r.command.rotary_rad[a]))),
            lengths: data.has_lengths(),
            tools: varies(&|r| Some(r.command.tool_mm.z)),
            station: rows.iter().all(|r| r.conditions.station_mm.is_some()),
            turns_mm: [0, 1, 2].map(|a| step_after_turning(rows, a)),
            curved: accelerations.1 > 0.0,
            accelerations: accelerations.1 > TWICE * accelerations.0,
            one_lever: [0, 1, 2].map(|axis| [0, 1, 2].map(|about| one_lever(data, about, axis))),
        }
    }
}

/// Median difference of the ways since an axis turned, of rows in a row that are nearer to the turn than thirty steps.
fn step_after_turning(rows: &[Row], axis: usize) -> f64 {
    let pairs = rows.windows(2).filter(|w| w[0].run == w[1].run);
    let ways = pairs
        .filter_map(|w| Some((w[0].conditions.since_turn_mm[axis]?, w[1].conditions.since_turn_mm[axis]?)));
    let mut steps: Vec<f64> =
        ways.filter(|(a, b)| b > a && *a < 30.0 * (b - a)).map(|(a, b)| b - a).collect();
    if steps.len() < 12 { f64::INFINITY } else { median(&mut steps).unwrap_or(f64::INFINITY) }
}

/// The largest acceleration must be so many times the smallest for what grows with it to be told from a radius.
const TWICE: f64 = 2.0;

/// Smallest and largest acceleration of the rows that are read on a curve at a feed, mm/min² per mm; none where these are
/// fewer than a quarter.
fn accelerations(rows: &[Row]) -> (f64, f64) {
    let of = |row: &Row| {
        let curvature = machine_model::Vector::from(row.conditions.curvature_per_mm?).norm();
        (curvature > 0.0).then_some(row.conditions.feed_mm_min?.powi(2) * curvature)
    };
    let all: Vec<f64> = rows.iter().filter_map(of).filter(|a| *a > 0.0).collect();
    if all.len() * 4 < rows.len() {
        return (f64::INFINITY, 0.0);
    }
    all.into_iter().fold((f64::INFINITY, 0.0), |(low, high), a| (low.min(a), f64::max(high, a)))
}

/// True where a rotation about a direction along an axis acts, in what the rows see, through levers that never change.
fn one_lever(data: &Measurements, about: usize, axis: usize) -> bool {
    /// Share of the lever that it may change by, and a change that is none, mm.
    const SAME: f64 = 0.01;
    let mut range = [(f64::INFINITY, f64::NEG_INFINITY); 3];
    for row in &data.rows {
        let lever = data.geometry.lever_mm(axis, &row.command);
        let moved = crate::equations::term::unit(about).cross(&lever);
        let seen = match row.reading {
            Reading::Displacement(components) => components.map(|c| c.is_some()),
            Reading::Magnitude(_) => [true; 3],
            Reading::Length { ball_mm, .. } => {
                let bar = data.geometry.nominal_tip_mm(&row.command) - ball_mm;
                [0, 1, 2].map(|c| bar[c].abs() > SAME * bar.norm())
            }
        };
        for c in (0..3).filter(|c| seen[*c]) {
            range[c] = (range[c].0.min(moved[c]), range[c].1.max(moved[c]));
        }
    }
    range.iter().all(|(low, high)| high - low <= SAME * low.abs().max(high.abs()).max(1.0) || high < low)
}

fn distinct(rows: &[Row], value: &dyn Fn(&Row) -> Option<f64>) -> usize {
    let mut values: Vec<f64> = rows.iter().filter_map(value).collect();
    values.sort_by(f64::total_cmp);
    values.dedup();
    values.len()
}

fn range(rows: &[Row], value: &dyn Fn(&Row) -> Option<f64>) -> Option<(f64, f64)> {
    let mut known = rows.iter().filter_map(value);
    let first = known.next()?;
    Some(known.fold((first, first), |(low, high), v| (low.min(v), high.max(v))))
}
