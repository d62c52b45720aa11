//! Inner products of all columns, computed once; every question of the search is answered from them.
//!
//! The noise of a run is white noise of variance σ² plus an offset vector of variance ρσ² per component that
//! all its rows share. With `U` the rows' directions, Woodbury's identity gives the whitened products
//! `XᵀV⁻¹X = XᵀDX - Σ_r C_rᵀ (I/ρ + U_rᵀDU_r)⁻¹ C_r`, `C_r = U_rᵀDX`: the raw products and a 3×p block per
//! run are enough for every ρ.

use machine_model::Vector;
use machine_model::effects::EffectGeometry;
use nalgebra::{DMatrix, Matrix3};

use crate::columns::{Column, Kept, Places};
use crate::observation::{Row, Scalar};
use crate::term::Term;
use crate::tile::{CHUNK, Tiles};

/// Raw inner products; the last column is the gap itself.
#[derive(Clone, Debug, Default)]
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
    /// The rows by place, where so many columns are asked about that sorting them pays.
    pub places: Option<&'a Places>,
}

impl Source<'_> {
    /// Values of a column at some equations, times the roots of their weights.
    #[must_use]
    pub(crate) fn weighted(&self, term: &Term, equations: &[usize]) -> Vec<f64> {
        let column = Column::new(term, self);
        equations.iter().map(|i| self.scalars[*i].weight.sqrt() * column.value(*i)).collect()
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
        gram.extend(terms, source, &mut Kept::default());
        gram
    }

    /// Adds columns; `kept` holds values of the columns there are and takes those of the new ones.
    pub(crate) fn extend<'a>(&mut self, new: Vec<Term>, source: &Source<'a>, kept: &mut Kept<'a>) {
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
            // Columns that can be anything but zero in this class, the gap last.
            let seen = |i: &usize| class == 3 || self.terms[*i].touches(class, source.geometry);
            let shown: Vec<usize> = (0..size - 1).filter(seen).collect();
            let first = shown.partition_point(|i| *i < first_new);
            if equations.is_empty() || first == shown.len() {
                continue;
            }
            let mut tiles = Tiles::new(shown.len() + 1, first);
            for (nth, chunk) in equations.chunks(CHUNK).enumerate() {
                let roots: Vec<f64> = chunk.iter().map(|i| source.scalars[*i].weight.sqrt()).collect();
                let run = |i: &usize| source.rows[source.scalars[*i].row].run;
                for (k, i) in shown.iter().enumerate() {
                    let values = tiles.column(k, chunk.len());
                    match kept.values(class, *i, nth * CHUNK, chunk.len()).filter(|_| k < first) {
                        Some(known) => values.copy_from_slice(known),
                        None => {
                            let column = &kept.columns(&self.terms, source)[*i];
                            column.fill(chunk, &roots, values);
                            kept.keep(class, *i, values);
                        }
                    }
                }
                let gap = tiles.column(shown.len(), chunk.len());
                for ((value, i), root) in gap.iter_mut().zip(chunk).zip(&roots) {
                    *value = root * source.scalars[*i].gap_um;
                }
                tiles.multiply(chunk.len());
                for (k, i) in shown.iter().enumerate().skip(first) {
                    let mut start = 0;
                    for rows in chunk.chunk_by(|a, b| run(a) == run(b)) {
                        let part = start..start + rows.len();
                        start = part.end;
                        let seen = tiles.column(k, chunk.len())[part.clone()].iter().zip(&roots[part]);
                        let block = &mut self.run_products[run(&rows[0])];
                        if class < 3 {
                            block[(class, *i)] += seen.map(|(value, root)| root * value).sum::<f64>();
                        } else {
                            for ((value, root), equation) in seen.zip(rows) {
                                let along = source.scalars[*equation].along;
                                (0..3).for_each(|c| block[(c, *i)] += along[c] * root * value);
                            }
                        }
                    }
                }
            }
            let position = |k: usize| shown.get(k).copied().unwrap_or(size - 1);
            for (a, b, value) in tiles.products() {
                let (i, j) = (position(a), position(b));
                products[(i, j)] += value;
                if i != j {
                    products[(j, i)] += value;
                }
            }
        }
        self.products = products;
    }

    /// The same without some of the equations.
    #[must_use]
    pub(crate) fn without(mut self, lost: &Self) -> Self {
        if lost.equations == 0 {
            return self;
        }
        // What is left of a column that lost all it showed is rounding.
        const NOTHING: f64 = 1e-9;
        let whole = self.squares();
        self.products -= &lost.products;
        self.equations -= lost.equations;
        for (information, gone) in self.run_information.iter_mut().zip(&lost.run_information) {
            let before = *information;
            *information = (before - gone)
                .zip_map(&before, |left, all| if left.abs() <= NOTHING * all.abs() { 0.0 } else { left });
        }
        for (block, gone) in self.run_products.iter_mut().zip(&lost.run_products) {
            *block -= gone;
        }
        for (i, whole) in whole.iter().enumerate().take(self.terms.len()) {
            if self.products[(i, i)] > NOTHING * whole {
                continue;
            }
            self.products.row_mut(i).fill(0.0);
            self.products.column_mut(i).fill(0.0);
            self.run_products.iter_mut().for_each(|block| block.column_mut(i).fill(0.0));
        }
        self
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
