//! What was measured, row by row, and the scalar equations it gives.

use machine_model::effects::{Conditions, EffectGeometry};
use machine_model::{Command, Vector};

/// What the instrument showed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Measured minus commanded tip, workpiece frame, µm; `None` for a component that was not measured.
    Displacement([Option<f64>; 3]),
    /// Ball bar: distance between the fixed ball and the tip, mm.
    Length {
        /// The reading.
        length_mm: f64,
        /// Centre of the fixed ball, machine coordinates.
        ball_mm: Vector,
    },
    /// Length of the displacement alone, µm.
    Magnitude(f64),
}

/// One row of a measurement file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Index into [`Measurements::runs`].
    pub run: usize,
    /// What the axes were told.
    pub command: Command,
    /// Temperature, time, load, feed, where known.
    pub conditions: Conditions,
    /// Real minus nominal tip that the model predicts here, mm.
    pub predicted_mm: Vector,
    /// Standard uncertainty stated for each component, µm.
    pub u_um: [Option<f64>; 3],
    /// Which instrument read it, numbered in order of appearance; `None` where the file does not say.
    pub instrument: Option<usize>,
    /// Which artefact (workpiece, ball plate, mirror) was read; `None` where the file does not say.
    pub artefact: Option<usize>,
    /// Which station of a tracker it was read from; `None` where the file does not say. Its place is in the conditions.
    pub station: Option<usize>,
    /// What was read.
    pub reading: Reading,
    /// How far through the file and through its run it stands, 0 to 1 ([`Measurements::follow`]).
    pub order: [f64; 2],
    /// Line of the file, for messages.
    pub line: u64,
}

impl Row {
    /// Of a run, in no condition that is known, where the model predicts nothing.
    #[must_use]
    pub fn new(run: usize, command: Command, reading: Reading) -> Self {
        Self {
            run,
            command,
            conditions: Conditions::default(),
            predicted_mm: Vector::zeros(),
            u_um: [None; 3],
            instrument: None,
            artefact: None,
            station: None,
            reading,
            order: [0.0; 2],
            line: 0,
        }
    }

    /// Stated uncertainty of an equation of a class: of its component, or the mean of all for another direction, µm.
    #[must_use]
    pub fn uncertainty_um(&self, class: usize) -> Option<f64> {
        if class < 3 {
            return self.u_um[class];
        }
        let stated = || self.u_um.into_iter().flatten();
        let count = stated().count();
        (count > 0).then(|| (stated().map(|u| u * u).sum::<f64>() / count as f64).sqrt())
    }
}

/// A measurement file.
#[derive(Clone, Debug, PartialEq)]
pub struct Measurements {
    /// Names of the runs, in order of appearance.
    pub runs: Vec<String>,
    /// Names of the instruments, in order of appearance; empty where the file does not say.
    pub instruments: Vec<String>,
    /// The rows in the order of the file.
    pub rows: Vec<Row>,
    /// What the effects must know of the machine.
    pub geometry: EffectGeometry,
}

/// What lengths of displacements are linearised about.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Believed<'a> {
    /// The displacement beyond the prediction that the length is believed to hold, µm, one per row.
    pub displaced_um: &'a [Vector],
    /// Standard deviation of one component, µm.
    pub noise_um: f64,
}

impl Believed<'_> {
    /// The length that a displacement `w` is expected to show: noise across it makes it longer,
    /// `μ = √(|w|² + 2σ²)` (second moment of the Rice distribution less the variance along `w`; at `w = 0` an eighth
    /// short of Maxwell's mean). The slope `w/μ` is smooth where `|w|` has a kink.
    #[must_use]
    pub fn expected_um(&self, displacement_um: &Vector) -> f64 {
        (displacement_um.norm_squared() + 2.0 * self.noise_um * self.noise_um).sqrt()
    }
}

/// One equation: the gap seen along a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scalar {
    /// Index of the row.
    pub row: usize,
    /// Unit vector along which the displacement is seen; shorter for a length that is mostly noise.
    pub along: Vector,
    /// 0, 1, 2 for a component, 3 for any other direction.
    pub class: usize,
    /// Measured minus predicted, µm.
    pub gap_um: f64,
    /// What the instrument showed, µm: what it rounds to is seen here.
    pub reading_um: f64,
    /// Inverse variance relative to the other rows.
    pub weight: f64,
}

/// Everything that must agree for two rows to be repeats, in steps far below what matters; their run first.
pub(crate) type Repeat = [i64; 22];

/// Repeats differ in temperature by less than this: 0.5 m of steel grows by 6 µm in one kelvin.
const SAME_K: f64 = 1.0;

impl Scalar {
    /// What its repeats agree in; `row`: its own.
    pub(crate) fn repeats(&self, row: &Row) -> Repeat {
        let step = |v: f64, unit: f64| (v / unit).round() as i64;
        let c = &row.command;
        let optional = |v: Option<f64>, unit: f64| v.map_or(i64::MIN, |v| step(v, unit));
        let id = |v: Option<usize>| v.map_or(-1, |v| v as i64);
        let [tx, ty, tz] = row.conditions.temp_c.map(|t| optional(t, SAME_K));
        [
            row.run as i64,
            step(c.linear_mm.x, 1e-5),
            step(c.linear_mm.y, 1e-5),
            step(c.linear_mm.z, 1e-5),
            step(c.rotary_rad.x, 1e-8),
            step(c.rotary_rad.y, 1e-8),
            step(c.rotary_rad.z, 1e-8),
            step(c.tool_mm.x, 1e-5),
            step(c.tool_mm.y, 1e-5),
            step(c.tool_mm.z, 1e-5),
            i64::from(c.direction[0]) * 9 + i64::from(c.direction[1]) * 3 + i64::from(c.direction[2]),
            optional(row.conditions.feed_mm_min, 1e-3),
            optional(row.conditions.load_kg, 1e-3),
            self.class as i64,
            step(self.along.x, 1e-4),
            step(self.along.y, 1e-4),
            step(self.along.z, 1e-4),
            id(row.instrument),
            id(row.artefact),
            tx,
            ty,
            tz,
        ]
    }
}

impl Measurements {
    /// The scalar equations of all rows, vectors component by component, lengths along the bar.
    ///
    /// Magnitudes are linearised about what is `believed`; without it magnitude rows give nothing.
    #[must_use]
    pub fn scalars(&self, believed: Option<&Believed<'_>>) -> Vec<Scalar> {
        let typical = self.typical_uncertainty_um();
        let mut scalars = Vec::with_capacity(3 * self.rows.len());
        for (index, row) in self.rows.iter().enumerate() {
            let mut push = |along: Vector, class: usize, gap_um: f64, reading_um: f64| {
                let weight = row.uncertainty_um(class).map_or(1.0, |u| (typical / u) * (typical / u));
                scalars.push(Scalar { row: index, along, class, gap_um, reading_um, weight });
            };
            match row.reading {
                Reading::Displacement(components) => {
                    for (class, value) in components.iter().enumerate() {
                        if let Some(um) = value {
                            let mut along = Vector::zeros();
                            along[class] = 1.0;
                            push(along, class, um - 1e3 * row.predicted_mm[class], *um);
                        }
                    }
                }
                Reading::Length { length_mm, ball_mm } => {
                    let bar = self.geometry.nominal_tip_mm(&row.command) + row.predicted_mm - ball_mm;
                    let predicted_mm = bar.norm();
                    if predicted_mm > 0.0 {
                        push(bar / predicted_mm, 3, 1e3 * (length_mm - predicted_mm), 1e3 * length_mm);
                    }
                }
                Reading::Magnitude(um) => {
                    let known = believed.and_then(|b| b.displaced_um.get(index).map(|d| (b, d)));
                    if let Some((believed, displaced)) = known {
                        let whole = 1e3 * row.predicted_mm + displaced;
                        let expected = believed.expected_um(&whole);
                        if expected > 0.0 {
                            let along = whole / expected;
                            push(along, 3, um - expected + along.dot(displaced), um);
                        }
                    }
                }
            }
        }
        scalars
    }

    /// Root mean square of the stated uncertainties, 1 where none is stated.
    #[must_use]
    pub fn typical_uncertainty_um(&self) -> f64 {
        let stated: Vec<f64> = self.rows.iter().flat_map(|r| r.u_um).flatten().collect();
        if stated.is_empty() {
            return 1.0;
        }
        (stated.iter().map(|u| u * u).sum::<f64>() / stated.len() as f64).sqrt()
    }

    /// About so many of the rows, spread evenly however the plan repeats itself: the golden ratio's multiples have no period.
    pub(crate) fn sample(&self, count: usize) -> Self {
        const GOLDEN: f64 = 0.618_033_988_749_894_9;
        let share = count as f64 / self.rows.len().max(1) as f64;
        let taken = |index: usize| (GOLDEN * index as f64).fract() < share;
        let rows = self.rows.iter().enumerate().filter(|(index, _)| taken(*index)).map(|(_, row)| *row);
        Self { rows: rows.collect(), ..self.clone() }
    }

    /// True of one run alone, but for a line along an axis that comes back to its places from the same side, and for an
    /// area: whatever else one run shows may be its own shift and drift, or the shifts of what lies beside each other
    /// in it.
    pub(crate) fn is_one_run(&self) -> bool {
        let moving: Vec<usize> = (0..3).filter(|axis| self.places_mm(*axis).len() > 1).collect();
        let comes_back = moving.len() == 1 && self.comes_back(|row| row.command.direction);
        self.runs.len() < 2 && !comes_back && !self.is_area()
    }

    /// True where the places of every axis that moves are met all along another one, as a mesh has them.
    #[must_use]
    pub fn is_area(&self) -> bool {
        (0..3).filter(|axis| self.places_mm(*axis).len() > 1).all(|axis| self.is_crossed(axis))
    }

    /// True where the places of an axis are met all along another one.
    pub(crate) fn is_crossed(&self, axis: usize) -> bool {
        (0..3).any(|other| other != axis && self.is_filled([axis, other]))
    }

    /// True where the places of two axes fill the rectangle that they span, as a mesh does: what comes back at every
    /// place of the other axis is no drift, and lines that were shifted one by one are no curve.
    fn is_filled(&self, axes: [usize; 2]) -> bool {
        /// Steps along a side, and how many of the places between them may be empty: lines beside each other and edges
        /// leave more.
        const STEPS: f64 = 4.0;
        const EMPTY: usize = 4;
        let ranges = axes.map(|axis| self.range_mm(axis));
        let node = |row: &Row| {
            let share =
                |k: usize| (row.command.linear_mm[axes[k]] - ranges[k].0) / (ranges[k].1 - ranges[k].0);
            [0, 1].map(|k| (STEPS * share(k)).round() as usize)
        };
        let mut nodes: Vec<[usize; 2]> = self.rows.iter().map(node).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.len() + EMPTY >= (STEPS as usize + 1).pow(2)
    }

    /// True where the order of the rows was noted ([`Measurements::follow`]).
    pub(crate) fn is_followed(&self) -> bool {
        self.rows.iter().any(|row| row.order != [0.0; 2])
    }

    /// True where most places are passed more than once within each part of the file: there the order of the rows is
    /// no place.
    pub(crate) fn comes_back<Part: Ord>(&self, part: impl Fn(&Row) -> Part) -> bool {
        let place = |row: &Row| row.command.linear_mm.map(|q| (1e3 * q).round() as i64);
        let mut places: Vec<(Part, [i64; 3])> =
            self.rows.iter().map(|row| (part(row), place(row).into())).collect();
        places.sort_unstable();
        places.dedup();
        2 * places.len() <= self.rows.len()
    }

    /// True where these rows have no place of their own, on any axis, beside some others: what they show of a curve
    /// is what those show. Feeds, loads and tools that are new are new places.
    #[must_use]
    pub fn repeats(&self, others: &Self) -> bool {
        type Value = fn(&Row) -> f64;
        const SAME: f64 = 1e-3;
        let values: [Value; 9] = [
            |r| r.command.linear_mm.x,
            |r| r.command.linear_mm.y,
            |r| r.command.linear_mm.z,
            |r| 1e3 * r.command.rotary_rad[0],
            |r| 1e3 * r.command.rotary_rad[1],
            |r| 1e3 * r.command.rotary_rad[2],
            |r| r.command.tool_mm.z,
            |r| r.conditions.feed_mm_min.unwrap_or_default(),
            |r| r.conditions.load_kg.unwrap_or_default(),
        ];
        values.iter().all(|value| {
            let mut known: Vec<f64> = others.rows.iter().map(value).collect();
            known.sort_by(f64::total_cmp);
            self.rows.iter().map(value).all(|own| {
                let place = known.partition_point(|other| *other < own - SAME);
                known.get(place).is_some_and(|other| *other <= own + SAME)
            })
        })
    }

    /// True where any row holds only the length of its displacement.
    #[must_use]
    pub fn has_magnitudes(&self) -> bool {
        self.rows.iter().any(|r| matches!(r.reading, Reading::Magnitude(_)))
    }

    /// True where any row is a ball-bar length.
    #[must_use]
    pub fn has_lengths(&self) -> bool {
        self.rows.iter().any(|r| matches!(r.reading, Reading::Length { .. }))
    }

    /// The different commands of a linear axis, ascending, mm.
    #[must_use]
    pub fn places_mm(&self, axis: usize) -> Vec<f64> {
        const SAME_MM: f64 = 1e-3;
        let mut places: Vec<f64> = self.rows.iter().map(|r| r.command.linear_mm[axis]).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|b, a| *b - *a < SAME_MM);
        places
    }

    /// Smallest and largest command of a linear axis, mm.
    #[must_use]
    pub fn range_mm(&self, axis: usize) -> (f64, f64) {
        self.rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), row| {
            let q = row.command.linear_mm[axis];
            (low.min(q), high.max(q))
        })
    }
}
