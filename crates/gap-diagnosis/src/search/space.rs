//! The space of all columns, set-up and run offsets taken out, in which models are judged.

use std::cell::{Cell, OnceCell};

use machine_model::effects::EffectKind;
use nalgebra::{DMatrix, Matrix3};
use units::math;

use crate::equations::gram::{Gram, dot, forward};
use crate::equations::linear::{Factor, Products, RANK_TOLERANCE, explained};
use crate::equations::term::Term;
use crate::library::candidates::{Library, Part};

/// Ratios of run-offset variance to row variance among which the likelihood chooses.
pub(crate) const RHO_GRID: [f64; 11] = [0.0, 0.003, 0.01, 0.04, 0.15, 0.6, 2.5, 10.0, 80.0, 640.0, 1e6];

/// The ratio at which runs are free: nothing between them counts.
pub(crate) const FREE: usize = RHO_GRID.len() - 1;

/// Two models are equally likely within this difference of the extended BIC.
pub(crate) const WITHIN: f64 = 10.0;

/// What a run-offset ratio makes of the products.
///
/// Every column has a vector `b` — first what the run offsets explain of it (three numbers per run, component by
/// component), then what the set-up explains of the rest — such that the whitened product of two columns, set-up
/// eliminated, is their raw product minus `b·b`.
#[derive(Clone, Debug)]
struct Level {
    rho: f64,
    log_determinant: f64,
    /// Independent set-up columns in the order of their elimination, with their vectors as far as they were known
    /// then.
    pivots: Vec<(usize, Absorbed)>,
    /// One per column, the gap last.
    explained: Vec<Absorbed>,
    /// Products that were asked for, not a number where none was: a search asks for few. A triangle by rows, the gap
    /// first, so that new columns come at its end; a row nobody asked about takes no room.
    known: Vec<OnceCell<Box<[Cell<f64>]>>>,
}

/// The vector `b` of a column: what run offsets and set-up absorb of it.
#[derive(Clone, Debug, Default)]
struct Absorbed {
    /// By run offsets, one list per component; empty where the column does not show in it.
    runs: [Vec<f64>; 3],
    /// By the set-up columns.
    set_up: Vec<f64>,
}

impl Absorbed {
    fn by_runs(&self, other: &Self) -> f64 {
        let pair = |c: usize| match (self.runs[c].is_empty(), other.runs[c].is_empty()) {
            (false, false) => dot(&self.runs[c], &other.runs[c]),
            _ => 0.0,
        };
        pair(0) + pair(1) + pair(2)
    }

    fn product(&self, other: &Self) -> f64 {
        self.by_runs(other) + dot(&self.set_up, &other.set_up)
    }
}

impl Level {
    fn new(rho: f64) -> Self {
        let (pivots, explained, known) = (Vec::new(), Vec::new(), Vec::new());
        Self { rho, log_determinant: 0.0, pivots, explained, known }
    }

    /// Takes the columns of `gram` that are not known yet; the first call also eliminates the set-up.
    fn grow(&mut self, gram: &Gram, nuisances: usize) {
        let size = gram.terms.len() + 1;
        let first_new = self.explained.len().saturating_sub(1);
        let gap = self.explained.pop();
        let factors = (self.rho > 0.0).then(|| gram.run_factors(self.rho));
        let mut fresh: Vec<Absorbed> = (first_new..size - usize::from(gap.is_some()))
            .map(|j| Absorbed { runs: by_runs(gram, factors.as_ref().map(|f| &f.0), j), set_up: Vec::new() })
            .collect();
        self.log_determinant = factors.map_or(0.0, |f| f.1);
        if gap.is_none() {
            self.choose_pivots(gram, &mut fresh[..nuisances]);
        }
        for (j, own) in fresh.iter_mut().enumerate() {
            for (k, (pivot, row)) in self.pivots.iter().enumerate().skip(own.set_up.len()) {
                let left = gram.products[(*pivot, first_new + j)]
                    - own.by_runs(row)
                    - dot(&own.set_up, &row.set_up[..k]);
                own.set_up.push(left / row.set_up[k]);
            }
        }
        self.explained.extend(fresh);
        self.explained.extend(gap);
        self.known.resize_with(size - nuisances, OnceCell::new);
    }

    /// Eliminates the set-up columns that are independent (rank-revealing Cholesky). A column of which next to
    /// nothing is left (a ball bar does not see itself turned) is none: nothing must be fitted to that nothing.
    fn choose_pivots(&mut self, gram: &Gram, set_up: &mut [Absorbed]) {
        let square = |i: usize| gram.products[(i, i)];
        let mut rest: Vec<f64> =
            set_up.iter().enumerate().map(|(i, own)| square(i) - own.by_runs(own)).collect();
        loop {
            let best = (0..rest.len())
                .filter(|i| self.pivots.iter().all(|(p, _)| p != i) && rest[*i] > RANK_TOLERANCE * square(*i))
                .max_by(|i, j| (rest[*i] / square(*i)).total_cmp(&(rest[*j] / square(*j))));
            let Some(pivot) = best else { break };
            let row = set_up[pivot].clone();
            let root = rest[pivot].sqrt();
            for (j, own) in set_up.iter_mut().enumerate() {
                let left = gram.products[(pivot, j)] - own.by_runs(&row) - dot(&own.set_up, &row.set_up);
                own.set_up.push(left / root);
                rest[j] -= (left / root) * (left / root);
            }
            self.pivots.push((pivot, set_up[pivot].clone()));
        }
    }
}

/// What the run offsets explain of a column: `L⁻¹ UᵀDx` of every run, by component.
fn by_runs(gram: &Gram, factors: Option<&Vec<Matrix3<f64>>>, column: usize) -> [Vec<f64>; 3] {
    let mut lists = [Vec::new(), Vec::new(), Vec::new()];
    let Some(factors) = factors else { return lists };
    for (l, block) in factors.iter().zip(&gram.run_products) {
        let v = forward(l, [block[(0, column)], block[(1, column)], block[(2, column)]]);
        (0..3).for_each(|c| lists[c].push(v[c]));
    }
    lists.map(|list| if list.iter().all(|v| *v == 0.0) { Vec::new() } else { list })
}

/// Everything the search needs.
#[derive(Clone, Debug)]
pub(crate) struct Space {
    /// Products before anything is taken out, set-up columns first.
    pub gram: Gram,
    levels: Vec<Level>,
    /// Square of each column before the set-up was taken out.
    reference: Vec<f64>,
    nuisances: usize,
    /// Equations minus set-up columns.
    pub degrees: f64,
}

/// A model judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fit {
    /// Extended BIC, smaller is better.
    pub score: f64,
    /// Whitened residual sum of squares, µm².
    pub residual: f64,
    /// Run-offset ratio.
    pub level: usize,
    /// Independent columns of the effects.
    pub rank: usize,
}

/// Which forms a scan asks about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Asked {
    /// Those that can be named.
    Nameable,
    /// Those of one candidate.
    Of(usize),
    /// Also those that can only be rivals.
    WithRivals,
}

impl Space {
    /// Whitens and eliminates the set-up for every ratio.
    pub(crate) fn new(gram: Gram, nuisances: usize) -> Self {
        let mut space = Self {
            gram: Gram::default(),
            levels: RHO_GRID.map(Level::new).to_vec(),
            reference: Vec::new(),
            nuisances,
            degrees: 1.0,
        };
        space.grow(gram);
        space
    }

    /// Takes the columns that were added to the products of before.
    pub(crate) fn grow(&mut self, gram: Gram) {
        let size = gram.terms.len() + 1;
        self.reference = (self.nuisances..size).map(|i| gram.products[(i, i)]).collect();
        self.levels.iter_mut().for_each(|level| level.grow(&gram, self.nuisances));
        let rank = self.levels.iter().map(|l| l.pivots.len()).max().unwrap_or(0);
        self.degrees = (gram.equations as f64 - rank as f64).max(1.0);
        self.gram = gram;
    }

    /// The ratio of a level.
    pub(crate) fn rho(&self, level: usize) -> f64 {
        self.levels[level].rho
    }

    /// Products at a level, set-up eliminated; positions are library columns minus the set-up's.
    pub(crate) fn products(&self, level: usize) -> Whitened<'_> {
        Whitened { space: self, level: &self.levels[level] }
    }

    /// Square of each column before anything was taken out, same positions.
    pub(crate) fn reference(&self) -> &[f64] {
        &self.reference
    }

    /// Positions in [`Self::products`] of the columns of a model.
    pub(crate) fn columns(&self, library: &Library, parts: &[Part]) -> Vec<usize> {
        parts.iter().flat_map(|p| &library.form(*p).columns).map(|c| c - self.nuisances).collect()
    }

    /// Square of the gap after the set-up, at a level.
    pub(crate) fn total(&self, level: usize) -> f64 {
        let last = self.reference.len() - 1;
        self.products(level).product(last, last).max(0.0)
    }

    /// Square of the gap that a model leaves after the set-up, at a level, and the model's rank.
    pub(crate) fn left(&self, library: &Library, parts: &[Part], level: usize) -> (f64, usize) {
        self.left_by(&self.columns(library, parts), level)
    }

    /// The same of a model's columns.
    fn left_by(&self, columns: &[usize], level: usize) -> (f64, usize) {
        let (explained, rank) = explained(&self.products(level), columns, &self.reference);
        ((self.total(level) - explained).max(0.0), rank)
    }

    /// Columns of some parts with the values that they have together under a run-offset ratio, the set-up's left out.
    pub(crate) fn values(&self, library: &Library, parts: &[Part], rho: f64) -> Vec<(Term, f64)> {
        let sub = self.gram.select(&library.model_columns(parts));
        let values = sub.coefficients(rho);
        sub.terms.into_iter().zip(values).skip(library.nuisances).collect()
    }

    /// What looking at this many forms of this many effects costs, and what its columns cost.
    fn price(&self, library: &Library, part: Part) -> f64 {
        let candidate = &library.candidates[part.candidate];
        let asked = (library.candidates.len() * candidate.asked()) as f64;
        let columns = candidate.variants[part.variant].columns.len() as f64;
        columns * math::ln(self.degrees) + 2.0 * math::ln(asked)
    }

    /// The price of one column. By so much the score may worsen for a new effect that passes its tests: the score ranks
    /// effects and their forms, whether there is one at all is for the F test to say, whose level is known.
    pub(crate) fn allowance(&self) -> f64 {
        math::ln(self.degrees)
    }

    /// Judges a model.
    pub(crate) fn fit(&self, library: &Library, parts: &[Part]) -> Fit {
        let all = (0..self.levels.len()).filter_map(self.judge(library, parts));
        let best = all.reduce(|best, next| if next.score < best.score { next } else { best });
        best.unwrap_or(Fit { score: 0.0, residual: 0.0, level: 0, rank: 0 })
    }

    /// The same for a model that differs little from one that is judged.
    pub(crate) fn fit_near(&self, library: &Library, parts: &[Part], near: &Fit) -> Fit {
        uphill(near.level, self.judge(library, parts)).unwrap_or(*near)
    }

    /// Judges a model level by level; `None` where there is no such.
    pub(super) fn judge(&self, library: &Library, parts: &[Part]) -> impl Fn(usize) -> Option<Fit> {
        let columns = self.columns(library, parts);
        let price = parts.iter().map(|part| self.price(library, *part)).sum();
        move |level| {
            self.levels.get(level)?;
            let (residual, rank) = self.left_by(&columns, level);
            Some(self.judged(level, residual, rank, price))
        }
    }

    /// BIC of a model with its set-up columns counted.
    pub(crate) fn evidence(&self, fit: &Fit) -> f64 {
        let level = &self.levels[fit.level];
        let equations = self.gram.equations as f64;
        let columns = (level.pivots.len() + fit.rank) as f64;
        equations * math::ln((fit.residual / equations).max(1e-6))
            + level.log_determinant
            + columns * math::ln(equations)
    }

    fn judged(&self, level: usize, residual: f64, rank: usize, price: f64) -> Fit {
        // A residual of nothing would make any model infinitely good: a nanometre per row is nothing.
        let mean = (residual / self.degrees).max(1e-6);
        let score = self.degrees * math::ln(mean) + self.levels[level].log_determinant + price;
        Fit { score, residual, level, rank }
    }

    /// Judges `base` plus every form that is asked about, each in turn, of effects that are not in it.
    pub(crate) fn scan(&self, library: &Library, base: &[Part], asked: Asked) -> Vec<(Part, Fit)> {
        let columns = self.columns(library, base);
        let base_price: f64 = base.iter().map(|p| self.price(library, *p)).sum();
        let only = |candidate: usize| !matches!(asked, Asked::Of(one) if one != candidate);
        let forms: Vec<(Part, Vec<usize>)> = (0..library.candidates.len())
            .filter(|c| only(*c) && base.iter().all(|p| p.candidate != *c))
            .flat_map(|candidate| {
                (0..library.candidates[candidate].variants.len())
                    .map(move |variant| Part { candidate, variant })
            })
            .filter(|p| asked == Asked::WithRivals || !library.form(*p).only_rival)
            .map(|part| (part, self.columns(library, &[part])))
            .collect();
        let last = self.reference.len() - 1;
        let mut needed = vec![false; last + 1];
        forms.iter().flat_map(|(_, own)| own).for_each(|c| needed[*c] = true);
        needed[last] = true;
        let mut sweeps: Vec<Option<Sweep<'_>>> = self.levels.iter().map(|_| None).collect();
        let start = self.fit(library, base).level;
        let mut found = Vec::new();
        for (part, own) in forms {
            let kind = library.kind(part);
            let price = base_price + self.price(library, part);
            let judge = |index: usize| {
                self.levels.get(index)?;
                let sweep = sweeps[index].get_or_insert_with(|| {
                    Sweep::new(self.products(index), &columns, &self.reference, &needed)
                });
                let (gain, own_rank) = sweep.gain(&own, &self.reference, kind);
                let residual = (sweep.product(last, last) - gain).max(0.0);
                (own_rank > 0).then(|| self.judged(index, residual, sweep.factor.rank() + own_rank, price))
            };
            found.extend(uphill(start, judge).map(|fit| (part, fit)));
        }
        found
    }
}

/// The best of all levels: the likelihood has one summit over the ratio, so uphill from that of a model alike.
fn uphill(start: usize, mut judge: impl FnMut(usize) -> Option<Fit>) -> Option<Fit> {
    let mut best = judge(start);
    for (step, mut level) in [(1, start), (usize::MAX, start)] {
        loop {
            level = level.wrapping_add(step);
            match judge(level) {
                Some(fit) if best.is_none_or(|b| fit.score < b.score) => best = Some(fit),
                _ => break,
            }
        }
    }
    best
}

/// Products at a level, each computed when it is asked for the first time.
#[derive(Clone, Copy)]
pub(crate) struct Whitened<'a> {
    space: &'a Space,
    level: &'a Level,
}

impl Products for Whitened<'_> {
    fn product(&self, i: usize, j: usize) -> f64 {
        // The gap comes first in the triangle.
        let last = self.space.reference.len() - 1;
        let place = |k: usize| if k == last { 0 } else { k + 1 };
        let (low, high) = (place(i).min(place(j)), place(i).max(place(j)));
        let row = self.level.known[high].get_or_init(|| vec![Cell::new(f64::NAN); high + 1].into());
        let known = &row[low];
        if known.get().is_nan() {
            let (a, b) = (self.space.nuisances + i, self.space.nuisances + j);
            let taken_out = self.level.explained[a].product(&self.level.explained[b]);
            // No number would pass for a model that leaves nothing.
            assert!(!self.space.gram.products[(a, b)].is_nan(), "columns that were never completed");
            known.set(self.space.gram.products[(a, b)] - taken_out);
        }
        known.get()
    }

    fn count(&self) -> usize {
        self.space.reference.len()
    }
}

/// Products with the columns of a base eliminated, entry by entry as they are asked for.
pub(crate) struct Sweep<'a> {
    products: Whitened<'a>,
    factor: Factor,
    /// `L⁻¹` times the base's products with every column needed, one behind the other.
    over: Vec<f64>,
}

impl<'a> Sweep<'a> {
    /// Eliminates `base`; only products of the columns that are `needed` may be asked for.
    pub(crate) fn new(products: Whitened<'a>, base: &[usize], reference: &[f64], needed: &[bool]) -> Self {
        let factor = Factor::new(&products, base, reference);
        let rank = factor.rank();
        let kept: Vec<usize> = factor.kept.iter().map(|k| base[*k]).collect();
        let mut over = vec![0.0; rank * needed.len()];
        if rank > 0 {
            for (j, b) in over.chunks_exact_mut(rank).enumerate().filter(|(j, _)| needed[*j]) {
                b.iter_mut().zip(&kept).for_each(|(to, k)| *to = products.product(*k, j));
                factor.forward_in_place(b);
            }
        }
        Self { products, factor, over }
    }

    /// What `own` columns take off the square of the last column (the gap), and their rank.
    fn gain(&self, own: &[usize], reference: &[f64], kind: EffectKind) -> (f64, usize) {
        let last = self.count() - 1;
        if let [single] = own {
            let square = self.product(*single, *single);
            if square <= RANK_TOLERANCE * reference[*single] || square <= 0.0 {
                return (0.0, 0);
            }
            let cross = self.product(*single, last);
            if kind.is_one_sided() && cross < 0.0 {
                return (0.0, 0);
            }
            return (cross * cross / square, 1);
        }
        let count = own.len();
        let at = |k: usize| if k < count { own[k] } else { last };
        let small = DMatrix::from_fn(count + 1, count + 1, |i, j| self.product(at(i), at(j)));
        let reference: Vec<f64> = own.iter().map(|c| reference[*c]).collect();
        let all: Vec<usize> = (0..count).collect();
        explained(&small, &all, &reference)
    }
}

impl Products for Sweep<'_> {
    fn product(&self, i: usize, j: usize) -> f64 {
        let rank = self.factor.rank();
        let own = |k: usize| &self.over[k * rank..(k + 1) * rank];
        self.products.product(i, j) - own(i).iter().zip(own(j)).map(|(a, b)| a * b).sum::<f64>()
    }

    fn count(&self) -> usize {
        self.products.count()
    }
}
