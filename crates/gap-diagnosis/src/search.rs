//! The search: add, refine, swap, drop, on inner products alone.

use nalgebra::DMatrix;
use units::math;

use crate::gram::{Gram, eliminate};
use crate::library::Library;
use crate::linear::{Factor, RANK_TOLERANCE};

/// Ratios of run-offset variance to row variance among which the likelihood chooses.
pub(crate) const RHO_GRID: [f64; 9] = [0.0, 0.003, 0.01, 0.04, 0.15, 0.6, 2.5, 10.0, 100.0];

/// One effect of a model: positions in the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    /// Index of the candidate.
    pub candidate: usize,
    /// Index of its form.
    pub variant: usize,
}

/// What a run-offset ratio makes of the products.
#[derive(Clone, Debug)]
struct Level {
    rho: f64,
    /// Set-up eliminated; the gap last.
    products: DMatrix<f64>,
    log_determinant: f64,
}

/// Everything the search needs.
#[derive(Clone, Debug)]
pub(crate) struct Space {
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

impl Space {
    /// Whitens and eliminates the set-up for every ratio.
    #[must_use]
    pub(crate) fn new(gram: &Gram, nuisances: usize) -> Self {
        let size = gram.terms.len() + 1;
        let reference = (nuisances..size).map(|i| gram.products[(i, i)]).collect();
        let mut rank = 0;
        let levels = RHO_GRID
            .iter()
            .map(|rho| {
                let (whitened, log_determinant) = gram.whitened(*rho);
                let (products, this) = eliminate(&whitened, nuisances, &gram.squares());
                rank = this.max(rank);
                Level { rho: *rho, products, log_determinant }
            })
            .collect();
        Self { levels, reference, nuisances, degrees: (gram.equations as f64 - rank as f64).max(1.0) }
    }

    /// The ratio of a level.
    #[must_use]
    pub(crate) fn rho(&self, level: usize) -> f64 {
        self.levels[level].rho
    }

    /// Products at a level, set-up eliminated; positions are library columns minus the set-up's.
    #[must_use]
    pub(crate) fn products(&self, level: usize) -> &DMatrix<f64> {
        &self.levels[level].products
    }

    /// Square of each column before anything was taken out, same positions.
    #[must_use]
    pub(crate) fn reference(&self) -> &[f64] {
        &self.reference
    }

    /// Positions in [`Self::products`] of the columns of a model.
    #[must_use]
    pub(crate) fn columns(&self, library: &Library, parts: &[Part]) -> Vec<usize> {
        parts
            .iter()
            .flat_map(|p| &library.candidates[p.candidate].variants[p.variant].columns)
            .map(|c| c - self.nuisances)
            .collect()
    }

    /// Square of the gap after the set-up, at a level.
    #[must_use]
    pub(crate) fn total(&self, level: usize) -> f64 {
        let products = &self.levels[level].products;
        products[(products.nrows() - 1, products.nrows() - 1)].max(0.0)
    }

    /// What looking at this many forms of this many effects costs, and what its columns cost.
    fn price(&self, library: &Library, part: Part) -> f64 {
        let candidate = &library.candidates[part.candidate];
        let asked = (library.candidates.len() * candidate.asked()) as f64;
        let columns = candidate.variants[part.variant].columns.len() as f64;
        columns * math::ln(self.degrees) + 2.0 * math::ln(asked)
    }

    /// Judges a model.
    #[must_use]
    pub(crate) fn fit(&self, library: &Library, parts: &[Part]) -> Fit {
        let mut best: Option<Fit> = None;
        let columns = self.columns(library, parts);
        for (index, level) in self.levels.iter().enumerate() {
            let (explained, rank) = crate::linear::explained(&level.products, &columns, &self.reference);
            let fit = self.judged(index, (self.total(index) - explained).max(0.0), rank, 0.0);
            if best.is_none_or(|b| fit.score < b.score) {
                best = Some(fit);
            }
        }
        let mut fit = best.unwrap_or(Fit { score: 0.0, residual: 0.0, level: 0, rank: 0 });
        // The price does not depend on the level.
        fit.score += parts.iter().map(|part| self.price(library, *part)).sum::<f64>();
        fit
    }

    fn judged(&self, level: usize, residual: f64, rank: usize, price: f64) -> Fit {
        // A residual of nothing would make any model infinitely good: a nanometre per row is nothing.
        let mean = (residual / self.degrees).max(1e-6);
        let score = self.degrees * math::ln(mean) + self.levels[level].log_determinant + price;
        Fit { score, residual, level, rank }
    }

    /// Judges `base` plus every form of every effect not in it (or only of `only`), each in turn; with `rivals`
    /// also the forms that cannot be named.
    #[must_use]
    pub(crate) fn scan(
        &self,
        library: &Library,
        base: &[Part],
        only: Option<usize>,
        rivals: bool,
    ) -> Vec<(Part, Fit)> {
        let columns = self.columns(library, base);
        let base_price: f64 = base.iter().map(|p| self.price(library, *p)).sum();
        let sweeps: Vec<(f64, usize, Vec<Vec<f64>>)> = self
            .levels
            .iter()
            .enumerate()
            .map(|(index, level)| {
                let factor = Factor::new(&level.products, &columns, &self.reference);
                let size = level.products.nrows();
                let over: Vec<Vec<f64>> = (0..size)
                    .map(|j| {
                        let b: Vec<f64> =
                            factor.kept.iter().map(|k| level.products[(columns[*k], j)]).collect();
                        factor.forward(&b)
                    })
                    .collect();
                let explained: f64 = over[size - 1].iter().map(|v| v * v).sum();
                ((self.total(index) - explained).max(0.0), factor.rank(), over)
            })
            .collect();
        let mut found = Vec::new();
        for (candidate, entry) in library.candidates.iter().enumerate() {
            if base.iter().any(|p| p.candidate == candidate) || only.is_some_and(|o| o != candidate) {
                continue;
            }
            for variant in (0..entry.variants.len()).filter(|v| rivals || !entry.variants[*v].only_rival) {
                let part = Part { candidate, variant };
                let own: Vec<usize> =
                    entry.variants[variant].columns.iter().map(|c| c - self.nuisances).collect();
                let mut best: Option<Fit> = None;
                for (index, (residual, rank, over)) in sweeps.iter().enumerate() {
                    let (gain, own_rank) = self.gain(index, &own, over, entry.kind.is_one_sided());
                    if own_rank == 0 {
                        continue;
                    }
                    let price = base_price + self.price(library, part);
                    let fit = self.judged(index, (residual - gain).max(0.0), rank + own_rank, price);
                    if best.is_none_or(|b| fit.score < b.score) {
                        best = Some(fit);
                    }
                }
                if let Some(fit) = best {
                    found.push((part, fit));
                }
            }
        }
        found
    }

    /// What `own` columns add to a base whose sweep is `over`.
    fn gain(&self, level: usize, own: &[usize], over: &[Vec<f64>], one_sided: bool) -> (f64, usize) {
        let products = &self.levels[level].products;
        let last = products.nrows() - 1;
        let dot = |i: usize, j: usize| -> f64 { over[i].iter().zip(&over[j]).map(|(a, b)| a * b).sum() };
        if let [single] = own {
            let square = products[(*single, *single)] - dot(*single, *single);
            if square <= RANK_TOLERANCE * self.reference[*single] || square <= 0.0 {
                return (0.0, 0);
            }
            let cross = products[(*single, last)] - dot(*single, last);
            if one_sided && cross < 0.0 {
                return (0.0, 0);
            }
            return (cross * cross / square, 1);
        }
        let count = own.len();
        let at = |k: usize| if k < count { own[k] } else { last };
        let small =
            DMatrix::from_fn(count + 1, count + 1, |i, j| products[(at(i), at(j))] - dot(at(i), at(j)));
        let reference: Vec<f64> = own.iter().map(|c| self.reference[*c]).collect();
        let all: Vec<usize> = (0..count).collect();
        crate::linear::explained(&small, &all, &reference)
    }
}

/// A change of the model.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Move {
    /// The changed model and its judgement; no new effect in it.
    Change(Vec<Part>, Fit),
    /// A new effect is proposed.
    Add(Part, Fit),
    /// Nothing is better.
    Stop,
}

/// The best next move: the known causes get their true shape first, then their rivals a hearing, then one
/// may go, and only then a new one is blamed.
#[must_use]
pub(crate) fn next_move(space: &Space, library: &Library, parts: &[Part], score: f64) -> Move {
    const WORTH: f64 = 1e-6;
    for (place, part) in parts.iter().enumerate() {
        let rest = without(parts, place);
        let fit = space.fit(library, &rest);
        if fit.score < score - WORTH {
            return Move::Change(rest, fit);
        }
        let refined = best(&space.scan(library, &rest, Some(part.candidate), false));
        if let Some((new, fit)) = refined.filter(|(_, fit)| fit.score < score - WORTH) {
            return Move::Change(replaced(parts, place, new), fit);
        }
    }
    let mut swap: Option<(Vec<Part>, Fit)> = None;
    for place in 0..parts.len() {
        let rest = without(parts, place);
        if let Some((new, fit)) = best(&space.scan(library, &rest, None, false)) {
            let better = swap.as_ref().map_or(score - WORTH, |(_, f)| f.score);
            if fit.score < better {
                swap = Some((replaced(parts, place, new), fit));
            }
        }
    }
    if let Some((changed, fit)) = swap {
        return Move::Change(changed, fit);
    }
    match best(&space.scan(library, parts, None, false)) {
        Some((part, fit)) if fit.score < score - WORTH => Move::Add(part, fit),
        _ => Move::Stop,
    }
}

fn best(found: &[(Part, Fit)]) -> Option<(Part, Fit)> {
    found.iter().copied().min_by(|(_, a), (_, b)| a.score.total_cmp(&b.score))
}

/// The model without one of its parts.
#[must_use]
pub(crate) fn without(parts: &[Part], place: usize) -> Vec<Part> {
    parts.iter().enumerate().filter(|(i, _)| *i != place).map(|(_, p)| *p).collect()
}

fn replaced(parts: &[Part], place: usize, new: Part) -> Vec<Part> {
    parts.iter().enumerate().map(|(i, p)| if i == place { new } else { *p }).collect()
}
