//! What each cause does to a radius, as columns.

use nalgebra::DVector;
use turning::{Bending, Clamping, Force, Workpiece, WorkpieceError};
use units::math;

use crate::turning::levels::order_within;

/// A radius that was read.
#[derive(Clone, Debug, PartialEq)]
pub struct CauseRow {
    /// Line in the file, from 1.
    pub line: u64,
    /// Which part: one clamping, one finishing cut.
    pub part: usize,
    /// Which tool and edge, where that is known.
    pub tool: Option<usize>,
    /// Of the cross section, machine frame, mm.
    pub z_mm: f64,
    /// As commanded, mm.
    pub diameter_mm: f64,
    /// Measured less predicted, on the radius, mm.
    pub gap_mm: f64,
    /// Since the spindle was started, s, where that is known.
    pub time_s: Option<f64>,
    /// Of the reading about the spindle's axis, rad; `None`: a diameter.
    pub angle_rad: Option<f64>,
    /// Standard uncertainty on the radius, mm, where all rows state one.
    pub uncertainty_mm: Option<f64>,
}

/// How the parts are held: an even bar of the diameter that is turned.
#[derive(Clone, Debug, PartialEq)]
pub struct Bar {
    /// From the chuck's face, mm.
    pub length_mm: f64,
    /// Machine Z of the chuck's face, mm.
    pub chuck_mm: f64,
    /// Young's modulus, N/mm².
    pub youngs_modulus_n_mm2: f64,
    /// How it is held.
    pub clamping: Clamping,
    /// Steady rests, mm from the chuck.
    pub steady_rests_mm: Vec<f64>,
}

/// What may be found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cause {
    /// `lathe.taper`: the workpiece's axis leans against Z.
    Taper,
    /// `lathe.bending`: the workpiece gives way to the cutting force.
    Bending,
    /// `spindle.runout`: error motion that repeats every turn.
    Runout,
    /// `spindle.growth`: the headstock moves while it warms up.
    Growth,
    /// `tool.wear`: the tip recedes from part to part.
    Wear,
    /// `straightness.EXZ`: the carriage does not run straight along Z.
    Straightness,
    /// `scale.X`: an error of X that goes with the diameter.
    Scale,
    /// `chuck.jaws`: three waves a turn, as the jaws of a chuck press them.
    Jaws,
}

impl Cause {
    /// Every one, in the order in which they are asked.
    pub const ALL: [Self; 8] = [
        Self::Taper,
        Self::Bending,
        Self::Runout,
        Self::Growth,
        Self::Wear,
        Self::Straightness,
        Self::Scale,
        Self::Jaws,
    ];

    /// As profiles and JSON call it.
    #[must_use]
    pub const fn id(self) -> &'static str {
        match self {
            Self::Taper => "lathe.taper",
            Self::Bending => "lathe.bending",
            Self::Runout => "spindle.runout",
            Self::Growth => "spindle.growth",
            Self::Wear => "tool.wear",
            Self::Straightness => "straightness.EXZ",
            Self::Scale => "scale.X",
            Self::Jaws => "chuck.jaws",
        }
    }
}

/// Waves a turn that are looked for.
const WAVES: u32 = 4;
/// Growth that saturates does so in this share of the time that was measured.
const SATURATES: f64 = 0.3;
/// Places, angles and diameters nearer than these are one, mm and rad.
const SAME: f64 = 1e-3;

/// Different values among the rows.
pub(super) fn different(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|b, a| *b - *a < SAME);
    all
}

/// What the rows vary in.
pub(super) struct Columns<'a> {
    pub(super) rows: &'a [CauseRow],
    /// Which part of its tool a row's part is, from the mean.
    order: Vec<f64>,
    pub(super) along: [f64; 2],
    pub(super) times: Option<[f64; 2]>,
    places: usize,
    angles: usize,
    radius_mm: f64,
    diameters: usize,
    /// By row: deflection per newton, mm; nothing where the bar is not known.
    flexibility: Option<Vec<f64>>,
    is_chucked: bool,
}

impl<'a> Columns<'a> {
    /// # Errors
    /// A bar that cannot be.
    pub(super) fn new(rows: &'a [CauseRow], bar: Option<&Bar>) -> Result<Self, WorkpieceError> {
        let places = different(rows.iter().map(|row| row.z_mm));
        let angles = different(rows.iter().filter_map(|row| row.angle_rad));
        let diameters = different(rows.iter().map(|row| row.diameter_mm));
        let times: Option<Vec<f64>> = rows.iter().map(|row| row.time_s).collect();
        let ends = |all: &[f64]| [all.first().copied().unwrap_or(0.0), all.last().copied().unwrap_or(0.0)];
        let times = times.map(|all| ends(&different(all.into_iter()))).filter(|[first, last]| last > first);
        let flexibility = bar.map(|bar| flexibility(rows, &diameters, bar)).transpose()?;
        Ok(Self {
            rows,
            order: order(rows),
            along: ends(&places),
            times,
            places: places.len(),
            angles: angles.len(),
            radius_mm: 0.5 * diameters.iter().sum::<f64>() / diameters.len().max(1) as f64,
            diameters: diameters.len(),
            flexibility,
            is_chucked: bar.is_none_or(|bar| !matches!(bar.clamping, Clamping::Centres { .. })),
        })
    }

    fn of(&self, value: impl Fn(usize, &CauseRow) -> f64) -> DVector<f64> {
        DVector::from_iterator(self.rows.len(), self.rows.iter().enumerate().map(|(k, row)| value(k, row)))
    }

    /// From −1 to 1 along Z.
    fn u(&self, row: &CauseRow) -> f64 {
        let [low, high] = self.along;
        if high > low { (2.0 * row.z_mm - low - high) / (high - low) } else { 0.0 }
    }

    /// Hours since the first reading.
    pub(super) fn hours(&self, row: &CauseRow) -> f64 {
        let first = self.times.map_or(0.0, |[first, _]| first);
        row.time_s.map_or(0.0, |time| (time - first) / 3600.0)
    }

    /// Time constant of growth that saturates, h.
    fn saturates_h(&self) -> f64 {
        self.times.map_or(1.0, |[first, last]| SATURATES * (last - first) / 3600.0)
    }

    /// What growth is after so many hours, by each of its columns.
    pub(super) fn grown(&self, hours: f64) -> [f64; 2] {
        [hours, 1.0 - math::exp(-hours / self.saturates_h())]
    }

    fn wave(&self, order: u32) -> [DVector<f64>; 2] {
        let turned = |row: &CauseRow| row.angle_rad.map(|angle| f64::from(order) * angle);
        [
            self.of(|_, row| turned(row).map_or(0.0, math::cos)),
            self.of(|_, row| turned(row).map_or(0.0, math::sin)),
        ]
    }

    /// Legendre's polynomial along Z.
    pub(super) fn legendre(&self, degree: usize) -> DVector<f64> {
        self.of(|_, row| machine_model::effects::legendre(degree, self.u(row)))
    }

    /// Degrees along Z that so many places tell from one another, one of them left to judge.
    pub(super) fn degrees(&self) -> usize {
        self.places.saturating_sub(2)
    }

    /// What a cause does to the radius, per unit; nothing where these rows cannot show it. Radii in mm.
    ///
    /// * taper: rad; bending: N; growth: mm an hour, and mm; wear: mm a part; straightness and waves: mm; scale: parts
    pub(super) fn cause(&self, cause: Cause) -> Vec<DVector<f64>> {
        let highest = WAVES.min((self.angles.saturating_sub(1) / 2) as u32);
        let waves = |orders: &[u32]| -> Vec<DVector<f64>> {
            orders.iter().filter(|order| **order <= highest).flat_map(|order| self.wave(*order)).collect()
        };
        let middle = 0.5 * (self.along[0] + self.along[1]);
        match cause {
            Cause::Taper if self.places > 1 => vec![self.of(|_, row| row.z_mm - middle)],
            Cause::Bending => self.flexibility.iter().map(|all| DVector::from_vec(all.clone())).collect(),
            Cause::Runout if self.is_chucked => waves(&[2, 4]),
            Cause::Runout => waves(&[2, 3, 4]),
            Cause::Jaws if self.is_chucked => waves(&[3]),
            Cause::Growth if self.times.is_some() => {
                (0..2).map(|k| self.of(|_, row| self.grown(self.hours(row))[k])).collect()
            }
            Cause::Wear => vec![self.of(|k, _| self.order[k])],
            Cause::Straightness => {
                (2..=3).filter(|k| *k <= self.degrees()).map(|k| self.legendre(k)).collect()
            }
            Cause::Scale if self.diameters > 1 => {
                vec![self.of(|_, row| 0.5 * row.diameter_mm - self.radius_mm)]
            }
            _ => Vec::new(),
        }
    }

    /// Curves along Z beyond what any cause is, and leans of single parts: what must be nothing.
    pub(super) fn leftovers(&self, parts: &[usize]) -> Vec<DVector<f64>> {
        let curves = (4..=6).filter(|k| *k <= self.degrees()).map(|k| self.legendre(k));
        curves.chain(self.tilts(parts)).collect()
    }

    /// How each part but the first leans beside it.
    pub(super) fn tilts(&self, parts: &[usize]) -> impl Iterator<Item = DVector<f64>> {
        let own = |part: &usize| self.of(|_, row| if row.part == *part { self.u(row) } else { 0.0 });
        parts.iter().skip(1).map(own)
    }
}

/// An even bar of each diameter that was turned.
fn flexibility(rows: &[CauseRow], diameters: &[f64], bar: &Bar) -> Result<Vec<f64>, WorkpieceError> {
    let bend = |diameter_mm: f64| {
        let diameters_mm = vec![[0.0, diameter_mm], [bar.length_mm, diameter_mm]];
        let workpiece = Workpiece {
            diameters_mm,
            youngs_modulus_n_mm2: bar.youngs_modulus_n_mm2,
            clamping: bar.clamping,
            steady_rests_mm: bar.steady_rests_mm.clone(),
        };
        Bending::new(&workpiece, Force::Radial { newton: 1.0 })
    };
    let bent = diameters.iter().map(|d| bend(*d)).collect::<Result<Vec<_>, _>>()?;
    let of = |row: &CauseRow| {
        let place = diameters.iter().position(|d| (d - row.diameter_mm).abs() < SAME).unwrap_or(0);
        bent[place].at_mm(row.z_mm - bar.chuck_mm)
    };
    Ok(rows.iter().map(of).collect())
}

/// Parts of one tool in the order of their time, else of the rows, from their mean.
fn order(rows: &[CauseRow]) -> Vec<f64> {
    let mut order = vec![0.0; rows.len()];
    let mut done: Vec<Option<usize>> = Vec::new();
    for tool in rows.iter().map(|row| row.tool) {
        if tool.is_none() || done.contains(&tool) {
            continue;
        }
        done.push(tool);
        let own: Vec<usize> = (0..rows.len()).filter(|k| rows[*k].tool == tool).collect();
        order_within(&own, |k| (rows[k].part, rows[k].time_s), &mut order);
    }
    order
}
