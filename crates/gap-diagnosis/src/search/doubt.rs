//! What the noise and the set-up of a file are like, seen on what a first search leaves.
//!
//! A search believes that readings are independent, equally uncertain in every component, and that a run shifts but does
//! not turn. Each of these is asked here on its residual; where one does not hold, the search is made again without it.

use std::collections::BTreeMap;

use nalgebra::Matrix3;

use crate::equations::columns::{Column, Source};
use crate::equations::f_test::f_tail;
use crate::equations::gram::Gram;
use crate::equations::noise::estimate;
use crate::equations::observation::{Measurements, Row, Scalar};
use crate::equations::set_up::Clamping;
use crate::equations::term::Term;
use crate::search::explanation::Explanation;

/// What a search takes for granted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Setting {
    /// Correlation of a reading with the next one of its run, where runs are long enough to call it noise.
    pub phi: f64,
    /// The correlation that tests and intervals count with, however short the runs.
    pub caution: f64,
    /// How the set-ups of the runs may differ.
    pub clamping: Clamping,
}

/// Components are equally uncertain unless an F test at this level says otherwise …
const UNEVEN_LEVEL: f64 = 1e-3;
/// … and the variances differ by this factor: below it the weights change nothing that a test sees.
const UNEVEN: f64 = 1.3;
/// Readings hang together beyond so many standard errors of the correlation …
const SERIAL_SIGMA: f64 = 3.0;
/// … and this correlation: below it intervals grow by less than a tenth.
const SERIAL: f64 = 0.1;
/// More cannot be told from a random walk.
const MOST_SERIAL: f64 = 0.98;
/// A run must be so many times as long as its readings hang together.
const LONG: f64 = 5.0;
/// Readings of one place one after the other that show how they hang together, and how many pairs there must be.
const STILL: usize = 8;
const PAIRS: f64 = 30.0;

/// The equations with weights by component, where the components are not equally uncertain.
#[must_use]
pub(crate) fn weighed(data: &Measurements, first: &Explanation, scalars: &[Scalar]) -> Option<Vec<Scalar>> {
    let residuals = &first.solution.residuals_um;
    let of_class = |class: usize| {
        let pairs = first.scalars.iter().zip(residuals).filter(|(s, _)| s.class == class);
        let (own, left): (Vec<Scalar>, Vec<f64>) = pairs.map(|(s, r)| (*s, *r)).unzip();
        let noise = estimate(&data.rows, &own, &left, 0.0)?;
        let square: f64 = own.iter().zip(&left).map(|(s, r)| s.weight * r * r).sum();
        // Never more than what is left: structure that the neighbours of few rows show is no noise.
        Some((noise.variance.min(square / own.len() as f64), noise.degrees, own.len() as f64))
    };
    let found = [of_class(0), of_class(1), of_class(2)];
    let known: Vec<(f64, f64, f64)> = found.iter().flatten().copied().collect();
    let smallest = known.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let largest = known.iter().copied().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let ratio = largest.0 / smallest.0.max(1e-12);
    if ratio < UNEVEN || f_tail(ratio, largest.1, smallest.1) > UNEVEN_LEVEL {
        return None;
    }
    let count: f64 = known.iter().map(|k| k.2).sum();
    let mean = known.iter().map(|k| k.0 * k.2).sum::<f64>() / count;
    let factor = |class: usize| {
        found.get(class).copied().flatten().map_or(1.0, |(variance, ..)| mean / variance.max(1e-3 * mean))
    };
    Some(scalars.iter().map(|s| Scalar { weight: s.weight * factor(s.class), ..*s }).collect())
}

/// Correlation of a reading with the next one of its run; 0 where they do not hang together.
///
/// Readings taken one after the other at one place show it free of all structure. Elsewhere what is left of the model
/// shows it, structure without a name included: either way it is no independent evidence for a name.
/// The lag-one correlation of n readings less their mean is low by (1 + 4φ)/n (Marriott and Pope 1954).
#[must_use]
pub(crate) fn phi(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> f64 {
    let Series { standing, moving } = series(rows, scalars, residuals_um);
    if let Some(phi) = lag_one(&standing) {
        return phi;
    }
    // Readings that hang together for as long as a run cannot be told from structure: it stays what it is called.
    let length = moving.iter().map(Vec::len).sum::<usize>() as f64 / moving.len().max(1) as f64;
    lag_one(&moving).filter(|phi| length >= LONG * (1.0 + phi) / (1.0 - phi)).unwrap_or(0.0)
}

/// The same for runs of any length: what tests and intervals must count with, for noise that hangs together over a run is
/// as smooth as an effect and no evidence for one.
#[must_use]
pub(crate) fn caution(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> f64 {
    let Series { standing, moving } = series(rows, scalars, residuals_um);
    lag_one(&standing).or_else(|| lag_one(&moving)).unwrap_or(0.0)
}

/// Residuals of runs and components in order: stretches at one place, and whole runs.
struct Series {
    standing: Vec<Vec<f64>>,
    moving: Vec<Vec<f64>>,
}

fn series(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Series {
    let mut runs: BTreeMap<(usize, usize), Vec<(usize, f64)>> = BTreeMap::new();
    for (scalar, r) in scalars.iter().zip(residuals_um) {
        let line = runs.entry((rows[scalar.row].run, scalar.class)).or_default();
        line.push((scalar.row, r * scalar.weight.sqrt()));
    }
    let still = |a: &(usize, f64), b: &(usize, f64)| {
        let (a, b) = (&rows[a.0].command, &rows[b.0].command);
        a.linear_mm == b.linear_mm && a.rotary_rad == b.rotary_rad && a.tool_mm == b.tool_mm
    };
    let standing: Vec<Vec<f64>> = runs
        .values()
        .flat_map(|line| line.chunk_by(|a, b| still(a, b)))
        .filter(|stretch| stretch.len() >= STILL)
        .map(|stretch| stretch.iter().map(|(_, v)| *v).collect())
        .collect();
    let moving: Vec<Vec<f64>> =
        runs.values().filter(|l| l.len() > 3).map(|l| l.iter().map(|(_, v)| *v).collect()).collect();
    Series { standing, moving }
}

/// Pooled lag-one correlation of some series; `None` of too few pairs, 0 where it is none.
fn lag_one(series: &[Vec<f64>]) -> Option<f64> {
    let (mut product, mut square, mut pairs, mut count, mut lines) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for line in series {
        let length = line.len() as f64;
        let mean = line.iter().sum::<f64>() / length;
        product += line.windows(2).map(|w| (w[0] - mean) * (w[1] - mean)).sum::<f64>();
        square += line.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (pairs, count, lines) = (pairs + length - 1.0, count + length, lines + 1.0);
    }
    if pairs < PAIRS || square <= 0.0 {
        return None;
    }
    let (raw, short) = ((product / pairs) / (square / count), lines / count);
    let phi = ((raw + short) / (1.0 - 4.0 * short).max(0.2)).min(MOST_SERIAL);
    let sure = (raw + short) * pairs.sqrt() > SERIAL_SIGMA;
    Some(if sure && phi > SERIAL { phi } else { 0.0 })
}

/// Variance of a weighted sum of readings that hang together, over that of independent ones: `Σ φ^|s-t| x_s x_t / Σ x²`
/// within the runs, component by component. Below one for what changes from reading to reading, and then taken as one:
/// the correlation itself is estimated.
///
/// The variance that the second is of was estimated about the means of the runs, and these take a part of the first with
/// them: about the mean of n readings `σ²(1 - Σ φ^|s-t| / n²)·n/(n-1)` is left.
#[must_use]
pub(crate) fn inflation(rows: &[Row], scalars: &[Scalar], column: &[f64], phi: f64) -> f64 {
    if phi == 0.0 {
        return 1.0;
    }
    // What the readings before one say of it, by component, faded.
    let mut before = [0.0; 4];
    let mut run = usize::MAX;
    let (mut square, mut cross) = (0.0, 0.0);
    // By component of a run: readings, and what the ones before say of them all.
    let (mut own, mut within, mut degrees) = ([(0.0, 0.0, 0.0); 4], 0.0, 0.0);
    let mut close = |own: &mut [(f64, f64, f64); 4]| {
        for (count, together, _) in own.iter().filter(|o| o.0 > 1.0) {
            within += count - (count + 2.0 * together) / count;
            degrees += count - 1.0;
        }
        *own = [(0.0, 0.0, 0.0); 4];
    };
    for (scalar, x) in scalars.iter().zip(column) {
        if rows[scalar.row].run != run {
            (run, before) = (rows[scalar.row].run, [0.0; 4]);
            close(&mut own);
        }
        let (count, together, faded) = &mut own[scalar.class];
        *together += *faded;
        *faded = phi * (*faded + 1.0);
        *count += 1.0;
        let value = x * scalar.weight.sqrt();
        square += value * value;
        cross += value * before[scalar.class];
        before[scalar.class] = phi * (before[scalar.class] + value);
    }
    close(&mut own);
    let left = if degrees > 0.0 { (within / degrees).clamp(0.02, 1.0) } else { 1.0 };
    if square > 0.0 { ((1.0 + 2.0 * cross / square) / left).max(1.0) } else { 1.0 }
}

/// [`inflation`] of some columns, each beside others and the runs' offsets.
#[must_use]
pub(crate) fn inflations(
    beside: &[Term],
    columns: &[Term],
    rho: f64,
    phi: f64,
    source: &Source<'_>,
) -> Vec<f64> {
    let scalars = source.scalars;
    let all: Vec<Column<'_>> =
        beside.iter().chain(columns).map(|term| Column::tabulated(term, source)).collect();
    let (others, own) = all.split_at(beside.len());
    let gram = Gram::of(all.clone(), source);
    let places: Vec<usize> = (0..others.len()).collect();
    let of = |(nth, column): (usize, &Column<'_>)| {
        let fit = gram.towards(&places, others.len() + nth);
        let coefficients = fit.coefficients(rho);
        let offsets = fit.offsets(rho, &coefficients);
        let mut fitted = vec![0.0; scalars.len()];
        let used = others.iter().zip(&coefficients).filter(|(_, v)| **v != 0.0);
        used.for_each(|(other, v)| other.add_to(*v, &mut fitted));
        let left: Vec<f64> = (0..scalars.len())
            .map(|i| {
                let offset = scalars[i].along.dot(&offsets[source.rows[scalars[i].row].run]);
                column.value(i) - fitted[i] - offset
            })
            .collect();
        inflation(source.rows, scalars, &left, phi)
    };
    own.iter().enumerate().map(of).collect()
}

/// True where most runs see an area or a volume, so that a turned run shows and is not taken for a slope of one line.
#[must_use]
pub(crate) fn could_be_turned(data: &Measurements) -> bool {
    /// The second extent of a run that is no line, as a share of the first.
    const AREA: f64 = 0.1;
    let mut sums = vec![(0.0, machine_model::Vector::zeros(), Matrix3::zeros()); data.runs.len()];
    for row in &data.rows {
        let tip = row.command.linear_mm + row.command.tool_mm;
        let (count, sum, square) = &mut sums[row.run];
        *count += 1.0;
        *sum += tip;
        *square += tip * tip.transpose();
    }
    let wide = |(count, sum, square): &(f64, machine_model::Vector, Matrix3<f64>)| {
        if *count < 6.0 {
            return false;
        }
        let mean = sum / *count;
        let spread = square / *count - mean * mean.transpose();
        let mut extents: Vec<f64> = spread.symmetric_eigenvalues().iter().copied().collect();
        extents.sort_by(f64::total_cmp);
        extents[1] > AREA * AREA * extents[2]
    };
    !data.has_magnitudes() && data.runs.len() > 1 && sums.iter().all(wide)
}
