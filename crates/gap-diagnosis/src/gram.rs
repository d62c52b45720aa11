//! Inner products of all columns, computed once; every question of the search is answered from them.
//!
//! The noise of a run is white noise of variance σ² plus an offset vector of variance ρσ² per component that
//! all its rows share. With `U` the rows' directions, Woodbury's identity gives the whitened products
//! `XᵀV⁻¹X = XᵀDX - Σ_r C_rᵀ (I/ρ + U_rᵀDU_r)⁻¹ C_r`, `C_r = U_rᵀDX`: the raw products and a 3×p block per
//! run are enough for every ρ.

use machine_model::effects::EffectGeometry;
use nalgebra::{DMatrix, Matrix3};
use rayon::prelude::*;

use crate::observation::{Row, Scalar};
use crate::term::Term;

/// Rows of a chunk: fixed, so that the sum has one order on any number of threads.
const CHUNK: usize = 1024;

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

struct Partial {
    products: DMatrix<f64>,
    run_products: Vec<(usize, DMatrix<f64>)>,
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
        }
        gram.extend(terms, source);
        gram
    }

    /// Adds columns.
    pub(crate) fn extend(&mut self, new: Vec<Term>, source: &Source<'_>) {
        let first_new = self.terms.len();
        let mut terms = std::mem::take(&mut self.terms);
        terms.extend(new);
        let size = terms.len() + 1;
        // Old block and old run products keep their place; the gap moves to the end.
        let mut products = DMatrix::zeros(size, size);
        let mut run_products = vec![DMatrix::zeros(3, size); source.runs];
        let place = |old: usize| if old == first_new { size - 1 } else { old };
        if first_new > 0 {
            for i in 0..=first_new {
                for j in 0..=first_new {
                    products[(place(i), place(j))] = self.products[(i, j)];
                }
                for (to, from) in run_products.iter_mut().zip(&self.run_products) {
                    for c in 0..3 {
                        to[(c, place(i))] = from[(c, i)];
                    }
                }
            }
        }
        let fresh: Vec<bool> = (0..size).map(|j| j >= first_new && j + 1 < size || first_new == 0).collect();
        for class in 0..4 {
            let scalars: Vec<&Scalar> = source.scalars.iter().filter(|s| s.class == class).collect();
            if scalars.is_empty() {
                continue;
            }
            // Columns that can be anything but zero in this class; the gap (index terms.len()) last.
            let mut active: Vec<usize> =
                (0..terms.len()).filter(|i| class == 3 || terms[*i].touches(class)).collect();
            active.push(size - 1);
            let is_fresh: Vec<bool> = active.iter().map(|i| fresh[*i]).collect();
            if !is_fresh.iter().any(|f| *f) {
                continue;
            }
            let groups: Vec<Vec<&Scalar>> =
                scalars.chunks(CHUNK * (1 + scalars.len() / (CHUNK * 64))).map(<[&Scalar]>::to_vec).collect();
            let partials: Vec<Partial> =
                groups.par_iter().map(|group| partial(group, &terms, &active, &is_fresh, source)).collect();
            for part in partials {
                for (a, i) in active.iter().enumerate() {
                    for (b, j) in active.iter().enumerate().skip(a) {
                        if is_fresh[a] || is_fresh[b] {
                            let v = part.products[(a, b)];
                            products[(*i, *j)] += v;
                            if i != j {
                                products[(*j, *i)] += v;
                            }
                        }
                    }
                }
                for (run, block) in part.run_products {
                    for (a, i) in active.iter().enumerate().filter(|(a, _)| is_fresh[*a]) {
                        for c in 0..3 {
                            run_products[run][(c, *i)] += block[(c, a)];
                        }
                    }
                }
            }
        }
        self.terms = terms;
        self.products = products;
        self.run_products = run_products;
    }

    /// Products under run offsets of variance `rho` σ², and the logarithm of the determinant of V/σ².
    #[must_use]
    pub(crate) fn whitened(&self, rho: f64) -> (DMatrix<f64>, f64) {
        let mut result = self.products.clone();
        if rho <= 0.0 {
            return (result, 0.0);
        }
        let size = result.nrows();
        let mut log_determinant = 0.0;
        let factors: Vec<Vec<f64>> = self
            .run_products
            .iter()
            .zip(&self.run_information)
            .flat_map(|(block, information)| {
                let inner = Matrix3::identity() / rho + information;
                let Some(cholesky) = inner.cholesky() else { return Vec::new() };
                let l = cholesky.l();
                log_determinant += 2.0 * (0..3).map(|i| units::math::ln(l[(i, i)])).sum::<f64>()
                    + 3.0 * units::math::ln(rho);
                let mut rows = vec![vec![0.0; size]; 3];
                for j in 0..size {
                    for i in 0..3 {
                        let mut v = block[(i, j)];
                        for k in 0..i {
                            v -= l[(i, k)] * rows[k][j];
                        }
                        rows[i][j] = v / l[(i, i)];
                    }
                }
                rows
            })
            .collect();
        // One column of the result after another, each the work of one thread.
        result.as_mut_slice().par_chunks_mut(size).enumerate().for_each(|(j, column)| {
            for row in &factors {
                let v = row[j];
                if v != 0.0 {
                    for (to, from) in column.iter_mut().zip(row) {
                        *to -= v * from;
                    }
                }
            }
        });
        (result, log_determinant)
    }
}

/// Products of one chunk: four rows at a time, so that a load and a store serve four products.
fn partial(
    group: &[&Scalar],
    terms: &[Term],
    active: &[usize],
    fresh: &[bool],
    source: &Source<'_>,
) -> Partial {
    let width = active.len();
    let mut values = vec![0.0; width * 4];
    let mut products = vec![0.0; width * width];
    let mut runs: Vec<(usize, DMatrix<f64>)> = Vec::new();
    for quad in group.chunks(4) {
        values.fill(0.0);
        for (lane, scalar) in quad.iter().enumerate() {
            let row = &source.rows[scalar.row];
            let root = scalar.weight.sqrt();
            let lane_values = &mut values[lane * width..(lane + 1) * width];
            for (to, index) in lane_values.iter_mut().zip(active) {
                let value =
                    terms.get(*index).map_or(scalar.gap_um, |term| term.value(scalar, row, source.geometry));
                *to = root * value;
            }
            if runs.last().is_none_or(|(run, _)| *run != row.run) {
                runs.push((row.run, DMatrix::zeros(3, width)));
            }
            if let Some((_, block)) = runs.last_mut() {
                for (j, value) in lane_values.iter().enumerate().filter(|(j, _)| fresh[*j]) {
                    for c in 0..3 {
                        block[(c, j)] += root * scalar.along[c] * value;
                    }
                }
            }
        }
        let (v0, rest) = values.split_at(width);
        let (v1, rest) = rest.split_at(width);
        let (v2, v3) = rest.split_at(width);
        let first_fresh = fresh.iter().position(|f| *f).unwrap_or(width);
        for i in 0..width {
            let (a, b, c, d) = (v0[i], v1[i], v2[i], v3[i]);
            if a == 0.0 && b == 0.0 && c == 0.0 && d == 0.0 {
                continue;
            }
            // Pairs of old columns are known already.
            let from = if fresh[i] { i } else { i.max(first_fresh) };
            let target = &mut products[i * width + from..(i + 1) * width];
            let lanes = v0[from..].iter().zip(&v1[from..]).zip(v2[from..].iter().zip(&v3[from..]));
            for (to, ((w0, w1), (w2, w3))) in target.iter_mut().zip(lanes) {
                *to += (a * w0 + b * w1) + (c * w2 + d * w3);
            }
        }
    }
    Partial { products: DMatrix::from_row_slice(width, width, &products), run_products: runs }
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
