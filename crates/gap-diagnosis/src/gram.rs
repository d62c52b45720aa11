//! Inner products of all columns, computed once; every question of the search is answered from them.
//!
//! The noise of a run is white noise of variance σ² plus an offset vector of variance ρσ² per component that
//! all its rows share. With `U` the rows' directions, Woodbury's identity gives the whitened products
//! `XᵀV⁻¹X = XᵀDX - Σ_r C_rᵀ (I/ρ + U_rᵀDU_r)⁻¹ C_r`, `C_r = U_rᵀDX`: the raw products and a 3×p block per
//! run are enough for every ρ.

use machine_model::Vector;
use machine_model::effects::EffectGeometry;
use nalgebra::{DMatrix, Matrix3};

use crate::observation::{Row, Scalar};
use crate::term::Term;

/// Values of columns kept between extensions, at most this many numbers (256 MiB); what does not fit is evaluated
/// again when it is needed.
const KEPT: usize = 32 << 20;

/// Raw inner products; the last column is the gap itself.
#[derive(Clone, Debug)]
pub(crate) struct Gram {
    /// The columns, without the gap.
    pub terms: Vec<Term>,
    /// Products weighted by the rows' relative inverse variances, (terms + 1)².
    pub products: DMatrix<f64>,
    /// Per run: 3 × (terms + 1).
    pub run_products: Vec<DMatrix<f64>>,
    /// Per run: UᵀDU.
    pub run_information: Vec<Matrix3<f64>>,
    /// Number of equations.
    pub equations: usize,
}

/// Where the equations come from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    /// Rows of the measurement.
    pub rows: &'a [Row],
    /// Equations.
    pub scalars: &'a [Scalar],
    /// Number of runs.
    pub runs: usize,
    /// The machine.
    pub geometry: &'a EffectGeometry,
}

impl Source<'_> {
    /// Values of a column at some equations, times the roots of their weights.
    #[must_use]
    pub(crate) fn weighted(&self, term: &Term, equations: &[usize]) -> Vec<f64> {
        let value = |i: &usize| {
            let scalar = &self.scalars[*i];
            scalar.weight.sqrt() * term.value(scalar, &self.rows[scalar.row], self.geometry)
        };
        equations.iter().map(value).collect()
    }
}

/// Values of columns, class by class, for the next extension.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept {
    classes: [Vec<Option<Vec<f64>>>; 4],
    numbers: usize,
}

impl Kept {
    fn keep(&mut self, class: usize, term: usize, values: Vec<f64>) {
        if self.numbers + values.len() <= KEPT {
            self.numbers += values.len();
            let list = &mut self.classes[class];
            list.resize(list.len().max(term + 1), None);
            list[term] = Some(values);
        }
    }

    fn get(&self, class: usize, term: usize) -> Option<&[f64]> {
        self.classes[class].get(term)?.as_deref()
    }
}

impl Gram {
    /// All products of `terms`.
    #[must_use]
    pub(crate) fn new(terms: Vec<Term>, source: &Source<'_>) -> Self {
        let mut gram = Self {
            terms: Vec::new(),
            products: DMatrix::zeros(1, 1),
            run_products: vec![DMatrix::zeros(3, 1); source.runs],
            run_information: vec![Matrix3::zeros(); source.runs],
            equations: source.scalars.len(),
        };
        for scalar in source.scalars {
            let run = source.rows[scalar.row].run;
            gram.run_information[run] += scalar.along * scalar.along.transpose() * scalar.weight;
            gram.products[(0, 0)] += scalar.weight * scalar.gap_um * scalar.gap_um;
            for c in 0..3 {
                gram.run_products[run][(c, 0)] += scalar.weight * scalar.along[c] * scalar.gap_um;
            }
        }
        gram.extend(terms, source, None);
        gram
    }

    /// Adds columns; `kept` holds values of the columns there are and takes those of the new ones.
    pub(crate) fn extend(&mut self, new: Vec<Term>, source: &Source<'_>, mut kept: Option<&mut Kept>) {
        let first_new = self.terms.len();
        self.terms.extend(new);
        let size = self.terms.len() + 1;
        // Old block and old run products keep their place; the gap moves to the end.
        let place = |old: usize| if old == first_new { size - 1 } else { old };
        let mut products = DMatrix::zeros(size, size);
        for j in 0..=first_new {
            for i in 0..=first_new {
                products[(place(i), place(j))] = self.products[(i, j)];
            }
        }
        for block in &mut self.run_products {
            let mut wider = DMatrix::zeros(3, size);
            for i in 0..=first_new {
                wider.set_column(place(i), &block.column(i));
            }
            *block = wider;
        }
        for class in 0..4 {
            let equations: Vec<usize> =
                (0..source.scalars.len()).filter(|i| source.scalars[*i].class == class).collect();
            if equations.is_empty() {
                continue;
            }
            // Columns that can be anything but zero in this class.
            let seen = |i: &usize| class == 3 || self.terms[*i].touches(class);
            let fresh: Vec<(usize, Vec<f64>)> = (first_new..size - 1)
                .filter(seen)
                .map(|i| (i, source.weighted(&self.terms[i], &equations)))
                .collect();
            let mut add = |i: usize, j: usize, value: f64| {
                products[(i, j)] += value;
                if i != j {
                    products[(j, i)] += value;
                }
            };
            let gap: Vec<f64> = equations
                .iter()
                .map(|i| source.scalars[*i].weight.sqrt() * source.scalars[*i].gap_um)
                .collect();
            fresh.iter().for_each(|(j, b)| add(*j, size - 1, dot(&gap, b)));
            for i in (0..first_new).filter(seen).filter(|_| !fresh.is_empty()) {
                let known = kept.as_deref().and_then(|k| k.get(class, i));
                let again = known.is_none().then(|| source.weighted(&self.terms[i], &equations));
                if let Some(a) = known.or(again.as_deref()) {
                    fresh.iter().for_each(|(j, b)| add(i, *j, dot(a, b)));
                }
            }
            for (place, (i, a)) in fresh.iter().enumerate() {
                fresh[place..].iter().for_each(|(j, b)| add(*i, *j, dot(a, b)));
            }
            for (i, values) in fresh {
                for (equation, value) in equations.iter().zip(&values) {
                    let scalar = &source.scalars[*equation];
                    let block = &mut self.run_products[source.rows[scalar.row].run];
                    let value = scalar.weight.sqrt() * value;
                    for c in 0..3 {
                        block[(c, i)] += scalar.along[c] * value;
                    }
                }
                if let Some(kept) = kept.as_deref_mut() {
                    kept.keep(class, i, values);
                }
            }
        }
        self.products = products;
    }

    /// The Cholesky factors of `I/ρ + UᵀDU` of every run, and the logarithm of the determinant of V/σ².
    #[must_use]
    pub(crate) fn run_factors(&self, rho: f64) -> (Vec<Matrix3<f64>>, f64) {
        let mut log_determinant = 0.0;
        let factors = self.run_information.iter().map(|information| {
            let inner = Matrix3::identity() / rho + information;
            let l = inner.cholesky().map_or_else(Matrix3::identity, |c| c.l());
            log_determinant +=
                2.0 * (0..3).map(|i| units::math::ln(l[(i, i)])).sum::<f64>() + 3.0 * units::math::ln(rho);
            l
        });
        let factors = factors.collect();
        (factors, log_determinant)
    }

    /// Products under run offsets of variance `rho` σ², and the logarithm of the determinant of V/σ².
    #[must_use]
    pub(crate) fn whitened(&self, rho: f64) -> (DMatrix<f64>, f64) {
        let mut result = self.products.clone();
        if rho <= 0.0 {
            return (result, 0.0);
        }
        let size = result.nrows();
        let (factors, log_determinant) = self.run_factors(rho);
        for (l, block) in factors.iter().zip(&self.run_products) {
            let columns: Vec<Vector> =
                (0..size).map(|j| forward(l, [block[(0, j)], block[(1, j)], block[(2, j)]])).collect();
            for (j, b) in columns.iter().enumerate().filter(|(_, b)| **b != Vector::zeros()) {
                for (i, a) in columns.iter().enumerate() {
                    result[(i, j)] -= a.dot(b);
                }
            }
        }
        (result, log_determinant)
    }
}

/// `L⁻¹ b`.
#[must_use]
pub(crate) fn forward(l: &Matrix3<f64>, b: [f64; 3]) -> Vector {
    let x = b[0] / l[(0, 0)];
    let y = (b[1] - l[(1, 0)] * x) / l[(1, 1)];
    let z = (b[2] - l[(2, 0)] * x - l[(2, 1)] * y) / l[(2, 2)];
    Vector::new(x, y, z)
}

/// Inner product in eight partial sums: the order of the additions is fixed, and they do not wait for one another.
#[must_use]
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut sums = [0.0; 8];
    let (whole, rest) = a.as_chunks::<8>();
    let (other, other_rest) = b.as_chunks::<8>();
    for (a, b) in whole.iter().zip(other) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let tail: f64 = rest.iter().zip(other_rest).map(|(a, b)| a * b).sum();
    ((sums[0] + sums[1]) + (sums[2] + sums[3])) + ((sums[4] + sums[5]) + (sums[6] + sums[7])) + tail
}

/// Eliminates the first `count` columns (rank-revealing Cholesky) from a matrix of products and returns the
/// rest: products of what the eliminated columns cannot explain.
///
/// `reference` holds the squares of the columns before whitening: a set-up column of which next to nothing is
/// left (a ball bar does not see itself turned) must not be fitted to that nothing.
#[must_use]
pub(crate) fn eliminate(products: &DMatrix<f64>, count: usize, reference: &[f64]) -> (DMatrix<f64>, usize) {
    let size = products.nrows();
    let mut work = products.clone();
    let mut done = vec![false; count];
    let mut rank = 0;
    for _ in 0..count {
        let best = (0..count)
            .filter(|i| !done[*i] && work[(*i, *i)] > crate::linear::RANK_TOLERANCE * reference[*i])
            .max_by(|i, j| (work[(*i, *i)] / reference[*i]).total_cmp(&(work[(*j, *j)] / reference[*j])));
        let Some(pivot) = best else { break };
        done[pivot] = true;
        rank += 1;
        let column: Vec<f64> = work.column(pivot).iter().copied().collect();
        let inverse = 1.0 / column[pivot];
        for j in 0..size {
            let factor = column[j] * inverse;
            if factor != 0.0 {
                for i in 0..size {
                    work[(i, j)] -= column[i] * factor;
                }
            }
        }
    }
    (work.view((count, count), (size - count, size - count)).into_owned(), rank)
}
