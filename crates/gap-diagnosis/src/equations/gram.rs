//! Inner products of all columns, computed once; every question of the search is answered from them.
//!
//! The noise of a run is white noise of variance σ² plus an offset vector of variance ρσ² per component that
//! all its rows share. With `U` the rows' directions, Woodbury's identity gives the whitened products
//! `XᵀV⁻¹X = XᵀDX - Σ_r C_rᵀ (I/ρ + U_rᵀDU_r)⁻¹ C_r`, `C_r = U_rᵀDX`: the raw products and a 3×p block per
//! run are enough for every ρ.

use machine_model::Vector;
use nalgebra::{DMatrix, Matrix3};

use crate::equations::columns::{Column, Kept, Source};
use crate::equations::term::Term;
use crate::equations::tile::{CHUNK, Tiles};

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

impl Gram {
    /// All products of `terms`.
    pub(crate) fn new(terms: Vec<Term>, source: &Source<'_>) -> Self {
        let mut gram = Self::without_columns(source);
        gram.extend(terms, source);
        gram
    }

    /// All products of columns that are ready.
    pub(crate) fn of(columns: Vec<Column<'_>>, source: &Source<'_>) -> Self {
        let mut gram = Self::without_columns(source);
        gram.extend_keeping(columns.iter().map(Column::term).collect(), source, &mut Kept::of(columns));
        gram
    }

    fn without_columns(source: &Source<'_>) -> Self {
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
        gram
    }

    /// Adds columns with all their products.
    pub(crate) fn extend(&mut self, new: Vec<Term>, source: &Source<'_>) {
        self.extend_keeping(new, source, &mut Kept::default());
    }

    /// The same with what is known of the columns.
    fn extend_keeping<'a>(&mut self, new: Vec<Term>, source: &Source<'a>, kept: &mut Kept<'a>) {
        let first = self.terms.len();
        self.widen(new, 0.0);
        let order: Vec<usize> = (0..self.terms.len()).collect();
        self.add_products(&order, first, source, kept, |shown, tiles| {
            let (new, gap) = (shown.partition_point(|i| *i < first), shown.len());
            tiles.want(new..gap, 0..new);
            tiles.want_with_later(new..gap, gap + 1);
        });
    }

    /// Adds columns with their products with what `core` says of the columns that are there, and with columns of their own
    /// kind; the others are no numbers until [`Self::complete`] asks for them. `kept` holds values of the columns there are and
    /// takes those of the new ones.
    pub(crate) fn extend_beside<'a>(
        &mut self,
        core: &[bool],
        new: Vec<Term>,
        source: &Source<'a>,
        kept: &mut Kept<'a>,
    ) {
        let first = self.terms.len();
        self.widen(new, f64::NAN);
        let kind = |i: usize| self.terms[i].kind();
        let is_core = |i: usize| core.get(i).is_some_and(|c| *c);
        // The core first, then kind by kind the old columns and the new ones.
        let mut order: Vec<usize> = (0..first).filter(|i| is_core(*i)).collect();
        let kernel = order.len();
        let mut kinds = Vec::new();
        (first..self.terms.len()).for_each(|i| {
            if !kinds.contains(&kind(i)) {
                kinds.push(kind(i))
            }
        });
        let mut blocks = Vec::new();
        for one in kinds {
            let from = order.len();
            order.extend((0..first).filter(|i| !is_core(*i) && kind(*i) == one));
            let middle = order.len();
            order.extend((first..self.terms.len()).filter(|i| kind(*i) == one));
            blocks.push((from, middle, order.len()));
        }
        let gap = self.terms.len();
        let mut wanted: Vec<(usize, usize)> = Vec::new();
        for (from, middle, to) in &blocks {
            for new in &order[*middle..*to] {
                wanted.extend(order[..kernel].iter().chain(&order[*from..*to]).map(|other| (*new, *other)));
                wanted.push((*new, gap));
            }
        }
        for (i, j) in wanted {
            (self.products[(i, j)], self.products[(j, i)]) = (0.0, 0.0);
        }
        let place = |position: usize| order.iter().position(|i| *i == position).unwrap_or(usize::MAX);
        let places: Vec<usize> = (0..gap).map(place).collect();
        self.add_products(&order, first, source, kept, |shown, tiles| {
            let up_to = |limit: usize| shown.partition_point(|i| places[*i] < limit);
            let kernel = up_to(kernel);
            for (from, middle, to) in &blocks {
                let (from, middle, to) = (up_to(*from), up_to(*middle), up_to(*to));
                tiles.want(middle..to, 0..kernel);
                tiles.want(middle..to, from..middle);
                tiles.want_with_later(middle..to, to);
                tiles.want(middle..to, shown.len()..shown.len() + 1);
            }
        });
    }

    /// All products of some columns.
    pub(crate) fn complete<'a>(&mut self, columns: &[usize], source: &Source<'a>, kept: &mut Kept<'a>) {
        for i in columns {
            self.products.row_mut(*i).fill(0.0);
            self.products.column_mut(*i).fill(0.0);
        }
        let others = (0..self.terms.len()).filter(|i| !columns.contains(i));
        let order: Vec<usize> = others.chain(columns.iter().copied()).collect();
        let first = order.len() - columns.len();
        self.add_products(&order, self.terms.len(), source, kept, |shown, tiles| {
            let new = shown.iter().position(|i| order[first..].contains(i)).unwrap_or(shown.len());
            tiles.want(new..shown.len(), 0..new);
            tiles.want_with_later(new..shown.len(), shown.len() + 1);
        });
    }

    /// Makes room for columns whose products are not known yet; the gap stays the last.
    fn widen(&mut self, new: Vec<Term>, unknown: f64) {
        let first_new = self.terms.len();
        self.terms.extend(new);
        let size = self.terms.len() + 1;
        // Old block and old run products keep their place; the gap moves to the end.
        let place = |old: usize| if old == first_new { size - 1 } else { old };
        let mut products = DMatrix::from_element(size, size, unknown);
        for j in 0..=first_new {
            for i in 0..=first_new {
                products[(place(i), place(j))] = self.products[(i, j)];
            }
        }
        self.products = products;
        for block in &mut self.run_products {
            let mut wider = DMatrix::zeros(3, size);
            for i in 0..=first_new {
                wider.set_column(place(i), &block.column(i));
            }
            *block = wider;
        }
    }

    /// Adds products of the columns in `order`, class by class: `want` is told which of them show in a class, in that order,
    /// and says which products are wanted; the gap comes behind them. Run products are added for the columns from `first_new`
    /// on.
    fn add_products<'a>(
        &mut self,
        order: &[usize],
        first_new: usize,
        source: &Source<'a>,
        kept: &mut Kept<'a>,
        want: impl Fn(&[usize], &mut Tiles),
    ) {
        for class in 0..4 {
            let equations: Vec<usize> =
                (0..source.scalars.len()).filter(|i| source.scalars[*i].class == class).collect();
            // Columns that can be anything but zero in this class, the gap last.
            let seen = |i: &usize| class == 3 || self.terms[*i].touches(class, source.geometry);
            let shown: Vec<usize> = order.iter().copied().filter(seen).collect();
            let mut tiles = Tiles::new(shown.len() + 1);
            want(&shown, &mut tiles);
            if equations.is_empty() || tiles.is_idle() {
                continue;
            }
            for (nth, chunk) in equations.chunks(CHUNK).enumerate() {
                let start = nth * CHUNK;
                let roots: Vec<f64> = chunk.iter().map(|i| source.scalars[*i].weight.sqrt()).collect();
                for (k, i) in shown.iter().enumerate() {
                    let values = tiles.column(k, chunk.len());
                    if let Some(known) = kept.values(class, *i, start, chunk.len()) {
                        values.copy_from_slice(known);
                    } else {
                        let column = &kept.columns(&self.terms, source)[*i];
                        column.fill(chunk, &roots, values);
                        kept.keep(class, *i, start, values);
                    }
                    if *i >= first_new {
                        add_to_runs(&mut self.run_products, *i, chunk, values, &roots, source);
                    }
                }
                let gap = tiles.column(shown.len(), chunk.len());
                for ((value, i), root) in gap.iter_mut().zip(chunk).zip(&roots) {
                    *value = root * source.scalars[*i].gap_um;
                }
                tiles.multiply(chunk.len());
            }
            let position = |k: usize| shown.get(k).copied().unwrap_or(self.terms.len());
            for (a, b, value) in tiles.products() {
                let (i, j) = (position(a), position(b));
                self.products[(i, j)] += value;
                if i != j {
                    self.products[(j, i)] += value;
                }
            }
        }
    }

    /// The same without some of the equations.
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

/// Adds what a column shows of a chunk of equations of one class to its products with the runs' directions.
fn add_to_runs(
    run_products: &mut [DMatrix<f64>],
    column: usize,
    chunk: &[usize],
    values: &[f64],
    roots: &[f64],
    source: &Source<'_>,
) {
    let run = |i: &usize| source.rows[source.scalars[*i].row].run;
    let mut start = 0;
    for rows in chunk.chunk_by(|a, b| run(a) == run(b)) {
        let part = start..start + rows.len();
        start = part.end;
        let seen = values[part.clone()].iter().zip(&roots[part]);
        let block = &mut run_products[run(&rows[0])];
        let class = source.scalars[rows[0]].class;
        if class < 3 {
            block[(class, column)] += seen.map(|(value, root)| root * value).sum::<f64>();
        } else {
            for ((value, root), equation) in seen.zip(rows) {
                let along = source.scalars[*equation].along;
                (0..3).for_each(|c| block[(c, column)] += along[c] * root * value);
            }
        }
    }
}

/// `L⁻¹ b`.
pub(crate) fn forward(l: &Matrix3<f64>, b: [f64; 3]) -> Vector {
    let x = b[0] / l[(0, 0)];
    let y = (b[1] - l[(1, 0)] * x) / l[(1, 1)];
    let z = (b[2] - l[(2, 0)] * x - l[(2, 1)] * y) / l[(2, 2)];
    Vector::new(x, y, z)
}

/// Inner product in eight partial sums: the order of the additions is fixed, and they do not wait for one another.
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
pub(crate) fn eliminate(products: &DMatrix<f64>, count: usize, reference: &[f64]) -> (DMatrix<f64>, usize) {
    let size = products.nrows();
    let mut work = products.clone();
    let mut done = vec![false; count];
    let mut rank = 0;
    for _ in 0..count {
        let best = (0..count)
            .filter(|i| {
                !done[*i] && work[(*i, *i)] > crate::equations::linear::RANK_TOLERANCE * reference[*i]
            })
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
