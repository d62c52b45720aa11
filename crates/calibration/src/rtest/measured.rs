//! Rows as readings of an adjustment, with the offsets of their runs.

use diagnostic::Text;
use std::collections::BTreeMap;

use machine_model::{
    Axis, Command, Description, LinearAxis, PathModel, Range, RotaryAxis, Squareness, Vector,
};
use nalgebra::{DMatrix, DVector};

use super::basis::Basis;
use super::columns::{Columns, model};
use super::found::{BallReading, TurnedAxis};
use super::terms::Term;
use crate::error::CalibrationError;
use crate::field;

/// One component of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Reading {
    pub(super) row: usize,
    pub(super) component: usize,
}

/// What readings that repeat a command within a run differ by.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Repeats {
    /// Weighted squares about the mean of each place.
    pub(super) squares: f64,
    pub(super) free: usize,
}

/// Readings, flat.
pub(super) struct Measured<'r> {
    pub(super) rows: &'r [BallReading],
    columns: &'r Columns,
    runs: usize,
    pub(super) readings: Vec<Reading>,
    /// What was read, mm.
    pub(super) values: DVector<f64>,
    /// Standard uncertainty of each reading in parts of the typical one.
    pub(super) relative: Vec<f64>,
    /// The typical one, where stated, mm.
    pub(super) stated_mm: Option<f64>,
    pub(super) repeats: Repeats,
}

impl<'r> Measured<'r> {
    pub(super) fn new(
        rows: &'r [BallReading],
        columns: &'r Columns,
        runs: usize,
    ) -> Result<Self, CalibrationError> {
        let (mut readings, mut values, mut uncertainties) = (Vec::new(), Vec::new(), Vec::new());
        for (row, own) in rows.iter().enumerate() {
            for (component, value) in own.deviation_mm.iter().enumerate() {
                let Some(value) = value else { continue };
                readings.push(Reading { row, component });
                values.push(*value);
                uncertainties.extend(own.uncertainty_mm.map(|u| u[component]));
            }
        }
        if readings.is_empty() {
            return Err(CalibrationError::TooFew(Text::pair(
                "no row holds a reading",
                "ни в одной строке нет отсчёта",
            )));
        }
        let is_stated = uncertainties.len() == readings.len();
        let mean = uncertainties.iter().map(|u| u * u).sum::<f64>() / uncertainties.len().max(1) as f64;
        let stated_mm = is_stated.then(|| mean.sqrt());
        let relative = match stated_mm {
            Some(typical) => uncertainties.iter().map(|u| u / typical).collect(),
            None => vec![1.0; readings.len()],
        };
        let values = DVector::from_vec(values);
        let repeats = repeats(rows, &readings, &values, &relative);
        Ok(Self { rows, columns, runs, readings, values, relative, stated_mm, repeats })
    }

    /// How many columns belong to offsets: three a run.
    pub(super) fn offsets(&self) -> usize {
        3 * self.runs
    }

    /// The offsets of the runs, of which these columns were fitted.
    pub(super) fn offsets_mm(&self, columns: &[usize], values: &DVector<f64>) -> Vec<Vector> {
        let mut all = vec![Vector::zeros(); self.runs];
        for (column, value) in columns.iter().zip(values.iter()) {
            all[column / 3][column % 3] = *value;
        }
        all
    }

    pub(super) fn comes_from_both(&self, axis: Axis) -> bool {
        let sides = || self.rows.iter().map(|row| row.turning[axis.direction()]);
        sides().any(|side| side > 0) && sides().any(|side| side < 0)
    }

    /// Derivatives of the readings: offsets, then terms.
    pub(super) fn design(&self, terms: &[Term]) -> DMatrix<f64> {
        let offsets = self.offsets();
        let mut design = DMatrix::zeros(self.readings.len(), offsets + terms.len());
        for (i, reading) in self.readings.iter().enumerate() {
            design[(i, 3 * self.rows[reading.row].run + reading.component)] = 1.0;
        }
        for (k, term) in terms.iter().enumerate() {
            let axis = term.axis().direction();
            let mut last: Option<(usize, Vector)> = None;
            for (i, reading) in self.readings.iter().enumerate() {
                let slope = match last {
                    Some((row, slope)) if row == reading.row => slope,
                    _ => self.columns.slope(term, reading.row, self.rows[reading.row].turning[axis]),
                };
                last = Some((reading.row, slope));
                design[(i, offsets + k)] = slope[reading.component];
            }
        }
        design
    }

    pub(super) fn weighted(&self, design: &DMatrix<f64>) -> DMatrix<f64> {
        DMatrix::from_fn(design.nrows(), design.ncols(), |i, k| design[(i, k)] / self.relative[i])
    }

    /// What a machine leaves of the readings, offsets included, weighted.
    pub(super) fn weighted_rest(&self, description: &Description) -> DVector<f64> {
        let predicted = self.predicted(description);
        DVector::from_fn(self.values.len(), |i, _| (self.values[i] - predicted[i]) / self.relative[i])
    }

    /// What a machine would show, without offsets, mm; not finite where it is no machine.
    pub(super) fn predicted(&self, description: &Description) -> DVector<f64> {
        let Ok(machine) = model(description.clone()) else {
            return DVector::from_element(self.values.len(), f64::NAN);
        };
        let each: Vec<Vector> = self.rows.iter().map(|row| machine.predict(&row.command).error_mm).collect();
        DVector::from_fn(self.values.len(), |i, _| each[self.readings[i].row][self.readings[i].component])
    }

    /// Readings minus prediction, each run and component about its mean, mm.
    pub(super) fn about_offsets_mm(
        &self,
        description: &Description,
    ) -> Result<DVector<f64>, CalibrationError> {
        let mut rest = &self.values - self.predicted(description);
        let mut sums = vec![(0.0, 0.0); self.offsets()];
        let place = |reading: &Reading| 3 * self.rows[reading.row].run + reading.component;
        for (i, reading) in self.readings.iter().enumerate() {
            let weight = 1.0 / (self.relative[i] * self.relative[i]);
            let (sum, weights) = &mut sums[place(reading)];
            *sum += weight * rest[i];
            *weights += weight;
        }
        for (i, reading) in self.readings.iter().enumerate() {
            let (sum, weights) = sums[place(reading)];
            rest[i] -= sum / weights;
        }
        Ok(rest)
    }

    pub(super) fn rms_mm(&self, description: &Description) -> Result<f64, CalibrationError> {
        let rest = self.about_offsets_mm(description)?;
        Ok((rest.norm_squared() / rest.len() as f64).sqrt())
    }
}

fn repeats(rows: &[BallReading], readings: &[Reading], values: &DVector<f64>, relative: &[f64]) -> Repeats {
    let key = |reading: &Reading| {
        let row = &rows[reading.row];
        let command = &row.command;
        let numbers = [command.linear_mm, command.rotary_rad, command.tool_mm]
            .map(|v| [v.x, v.y, v.z].map(f64::to_bits));
        (row.run, reading.component, numbers, command.direction, row.turning)
    };
    let mut places: BTreeMap<_, Vec<usize>> = BTreeMap::new();
    for (i, reading) in readings.iter().enumerate() {
        places.entry(key(reading)).or_default().push(i);
    }
    let mut found = Repeats::default();
    for own in places.values().filter(|own| own.len() > 1) {
        let weight = |i: &usize| 1.0 / (relative[*i] * relative[*i]);
        let weights: f64 = own.iter().map(weight).sum();
        let mean = own.iter().map(|i| weight(i) * values[*i]).sum::<f64>() / weights;
        let square = |i: &usize| weight(i) * (values[*i] - mean) * (values[*i] - mean);
        found.squares += own.iter().map(square).sum::<f64>();
        found.free += own.len() - 1;
    }
    found
}

/// The same chain with nothing wrong.
pub(super) fn ideal(description: &Description) -> Description {
    let everywhere = Range { low: f64::NEG_INFINITY, high: f64::INFINITY };
    Description {
        linear: [(); 3].map(|()| LinearAxis::perfect(everywhere)),
        rotary: description.rotary.each_ref().map(|rotary| RotaryAxis {
            tilt: rotary.tilt,
            direction: rotary.direction,
            ..RotaryAxis::perfect(rotary.centre_mm)
        }),
        squareness: Squareness::default(),
        chain: description.chain.clone(),
    }
}

/// Balls at eight places with tools of eight kinds, the axes at angles all over where they were read: as much as any R-test
/// can show.
pub(super) fn everywhere(
    axes: &[TurnedAxis],
    description: &Description,
) -> Result<Vec<BallReading>, CalibrationError> {
    let machine = model(ideal(description))?;
    let ranges: Vec<Range> = axes
        .iter()
        .map(|own| match own.basis {
            Basis::Turn => Range { low: 0.0, high: std::f64::consts::TAU },
            Basis::Arc(range) => range,
        })
        .collect();
    let centre = description.rotary[axes[0].axis.direction()].centre_mm;
    let corner = |k: usize, bit: usize| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
    let mut rows = Vec::new();
    for ball in 0..8 {
        let [x, y, z] = [corner(ball, 0), corner(ball, 1), corner(ball, 2)];
        let tool_mm = Vector::new(30.0 * y, 20.0 * z, -150.0 - 60.0 * x * z);
        let place_mm = centre + Vector::new(140.0 * x + 11.0 * y, 110.0 * y, 90.0 * z + 17.0 * x);
        for angles in field::places(&ranges) {
            let mut rotary_rad = Vector::zeros();
            for (own, angle) in axes.iter().zip(&angles) {
                rotary_rad[own.axis.direction()] = *angle;
            }
            let mut command = Command { rotary_rad, tool_mm, ..Default::default() };
            command.linear_mm = machine.same_tip_mm(&(place_mm - tool_mm), &command, &Vector::zeros());
            rows.push(BallReading {
                run: ball,
                command,
                turning: [0; 3],
                deviation_mm: [Some(0.0); 3],
                uncertainty_mm: None,
            });
        }
    }
    Ok(rows)
}
