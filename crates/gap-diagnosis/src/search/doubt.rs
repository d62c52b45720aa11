//! What the noise and the set-up of a file are like, seen on what a first search leaves.
//!
//! A search believes that readings are independent, equally uncertain in every component, and that a run shifts but does
//! not turn. Each of these is asked here on its residual; where one does not hold, the search is made again without it.

use nalgebra::{DMatrix, Matrix3, SVector};

use crate::equations::columns::{Column, Source};
use crate::equations::f_test::f_tail;
use crate::equations::gram::Gram;
use crate::equations::linear::explained;
use crate::equations::noise::estimate;
use crate::equations::observation::{Measurements, Scalar};
use crate::equations::serial::Serial;
use crate::equations::set_up::{Clamping, middles_mm};
use crate::equations::term::Term;
use crate::search::explanation::Explanation;

/// What a search takes for granted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Setting {
    /// How readings of a run hang together, where runs are long enough to call it noise.
    pub serial: Serial,
    /// The same as tests and intervals count with it, however short the runs.
    pub caution: Serial,
    /// Variance that further rows will have over that of the rows kept (`tail_factor`).
    pub tails: f64,
    /// Most readings are alike and others far off, as on a coarse display: variances say little of such noise.
    pub lumpy: bool,
    /// How the set-ups of the runs may differ.
    pub clamping: Clamping,
}

/// Tails with more than this factor of the variance are no tails but what a coarse display makes of noise.
const HEAVY: f64 = 3.0;

impl Setting {
    /// Readings that are independent, tails that end, runs that may be shifted or turned.
    pub(crate) fn plain(clamping: Clamping) -> Self {
        Self { serial: Serial::default(), caution: Serial::default(), tails: 1.0, lumpy: false, clamping }
    }

    /// How readings of a run hang together, by the more careful of both accounts.
    pub(crate) fn counted(&self) -> Serial {
        self.caution.max(self.serial)
    }

    /// True where the noise is far from what a fit takes for granted: independent readings of one scatter.
    pub(crate) fn is_doubtful(&self) -> bool {
        !self.counted().is_none() || self.tails > HEAVY || self.lumpy
    }
}

/// Components are equally uncertain unless an F test at this level says otherwise …
const UNEVEN_LEVEL: f64 = 1e-3;
/// … and the variances differ by this factor: below it the weights change nothing that a test sees.
const UNEVEN: f64 = 1.3;
/// The equations with weights by component, where the components are not equally uncertain.
pub(crate) fn weighed(data: &Measurements, first: &Explanation, scalars: &[Scalar]) -> Option<Vec<Scalar>> {
    let residuals = &first.solution.residuals_um;
    let of_class = |class: usize| {
        let pairs = first.scalars.iter().zip(residuals).filter(|(s, _)| s.class == class);
        let (own, left): (Vec<Scalar>, Vec<f64>) = pairs.map(|(s, r)| (*s, *r)).unzip();
        let noise = estimate(&data.rows, &own, &left, Serial::default())?;
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

/// [`Serial::inflation`] of some columns, each beside others and the runs' offsets.
pub(crate) fn inflations(
    beside: &[Term],
    columns: &[Term],
    rho: f64,
    serial: Serial,
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
        serial.inflation(source.rows, scalars, &left)
    };
    own.iter().enumerate().map(of).collect()
}

/// Square that turns of the runs about their middles take off what a model leaves, beside shifts of the runs, weighted, µm²;
/// the causes of the model stay as they are.
pub(crate) fn taken_by_turns(data: &Measurements, model: &Explanation) -> f64 {
    let middles_mm = middles_mm(data);
    // By run, of what a shift, a turn (µm and µrad) and the rest show.
    let mut products = vec![DMatrix::zeros(7, 7); data.runs.len()];
    for (scalar, left) in model.scalars.iter().zip(&model.solution.residuals_um) {
        let row = &data.rows[scalar.row];
        let arm_m = 1e-3 * (row.command.linear_mm + row.command.tool_mm - middles_mm[row.run]);
        let (along, turn) = (scalar.along, arm_m.cross(&scalar.along));
        let seen = SVector::from([along.x, along.y, along.z, turn.x, turn.y, turn.z, *left]);
        products[row.run] += scalar.weight * seen * seen.transpose();
    }
    let gain = |products: &DMatrix<f64>| {
        let squares: Vec<f64> = products.diagonal().iter().copied().collect();
        let by = |columns: &[usize]| explained(products, columns, &squares).0;
        by(&[0, 1, 2, 3, 4, 5]) - by(&[0, 1, 2])
    };
    products.iter().map(gain).sum()
}

/// True where most runs see an area or a volume, so that a turned run shows and is not taken for a slope of one line.
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
