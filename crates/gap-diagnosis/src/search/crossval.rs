//! Gain on lines the fit has not seen.

use nalgebra::DMatrix;

use crate::equations::columns::{Column, Source};
use crate::equations::gram::Gram;
use crate::equations::linear::Factor;
use crate::equations::observation::Scalar;
use crate::equations::term::Term;

/// How the rows are left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Folding {
    /// Whole runs.
    Runs,
    /// Thirds of runs: where the runs are too few or one alone shows the effect.
    Stretches,
}

/// Products of every fold, whitened, set-up taken out with all data.
#[derive(Clone, Debug)]
pub(crate) struct Folds {
    each: Vec<DMatrix<f64>>,
    counts: Vec<usize>,
    total: DMatrix<f64>,
    reference: Vec<f64>,
}

/// Largest number of folds.
const MOST: usize = 24;
/// A column that keeps less than this share of its information without a fold is not fitted there.
const ENOUGH: f64 = 0.02;

impl Folds {
    /// Products of `nuisances` (first) and effects, fold by fold, at a run-offset ratio.
    pub(crate) fn new(
        terms: &[Term],
        nuisances: usize,
        rho: f64,
        source: &Source<'_>,
        folding: Folding,
    ) -> Self {
        let names = fold_of(source, folding);
        let folds = names.iter().copied().max().map_or(0, |m| m + 1);
        let mut parts: Vec<Vec<Scalar>> = vec![Vec::new(); folds];
        for (scalar, fold) in source.scalars.iter().zip(&names) {
            parts[*fold].push(*scalar);
        }
        let columns: Vec<Column<'_>> = terms.iter().map(|term| Column::tabulated(term, source)).collect();
        let whitened: Vec<DMatrix<f64>> = parts
            .iter()
            .map(|scalars| {
                let part = Source { scalars, ..*source };
                Gram::of(columns.iter().map(|c| c.among(part)).collect(), &part).whitened(rho).0
            })
            .collect();
        let size = terms.len() + 1;
        let total = whitened.iter().fold(DMatrix::zeros(size, size), |sum, w| sum + w);
        // x - N (NᵀN)⁺ Nᵀx as a linear map of the columns.
        let set_up: Vec<usize> = (0..nuisances).collect();
        let squares: Vec<f64> = (0..size).map(|i| total[(i, i)]).collect();
        let factor = Factor::new(&total, &set_up, &squares);
        let kept = size - nuisances;
        let mut map = DMatrix::zeros(size, kept);
        for j in 0..kept {
            let b: Vec<f64> = set_up.iter().map(|i| total[(*i, nuisances + j)]).collect();
            let solved = factor.solve(&b, nuisances);
            for i in 0..nuisances {
                map[(i, j)] = -solved[i];
            }
            map[(nuisances + j, j)] = 1.0;
        }
        let project = |w: &DMatrix<f64>| map.transpose() * w * &map;
        let total = project(&total);
        let reference = (0..kept)
            .map(|i| (total[(i, i)] * ENOUGH / crate::equations::linear::RANK_TOLERANCE).max(1e-300))
            .collect();
        Self {
            each: whitened.iter().map(project).collect(),
            counts: parts.iter().map(Vec::len).collect(),
            total,
            reference,
        }
    }

    /// Squared error of every fold, predicted from the others with `columns` (positions behind the set-up).
    pub(crate) fn losses(&self, columns: &[usize]) -> Vec<f64> {
        let last = self.total.nrows() - 1;
        self.each
            .iter()
            .map(|fold| {
                let training = &self.total - fold;
                let factor = Factor::new(&training, columns, &self.reference);
                let b: Vec<f64> = columns.iter().map(|c| training[(*c, last)]).collect();
                let x = factor.solve(&b, columns.len());
                let mut loss = fold[(last, last)];
                for (i, a) in columns.iter().enumerate() {
                    loss -= 2.0 * x[i] * fold[(*a, last)];
                    for (j, b) in columns.iter().enumerate() {
                        loss += x[i] * x[j] * fold[(*a, *b)];
                    }
                }
                loss
            })
            .collect()
    }

    /// Gain of `with` over `base` on left-out folds and its standard error, µm².
    pub(crate) fn gain(&self, base: &[usize], with: &[usize]) -> (f64, f64) {
        let gains: Vec<f64> =
            self.losses(base).iter().zip(self.losses(with)).map(|(before, after)| before - after).collect();
        let count = gains.len() as f64;
        let sum: f64 = gains.iter().sum();
        let mean = sum / count.max(1.0);
        let spread: f64 = gains.iter().map(|g| (g - mean) * (g - mean)).sum();
        (sum, (spread * count / (count - 1.0).max(1.0)).sqrt())
    }

    /// Largest share of a column's information that a single fold holds.
    pub(crate) fn concentration(&self, columns: &[usize]) -> f64 {
        let share = |c: usize| {
            let all = self.total[(c, c)];
            let most = self.each.iter().map(|f| f[(c, c)]).fold(0.0, f64::max);
            if all > 0.0 { most / all } else { 1.0 }
        };
        columns.iter().map(|c| share(*c)).fold(0.0, f64::max)
    }

    /// Equations per fold.
    pub(crate) fn counts(&self) -> &[usize] {
        &self.counts
    }
}

/// Which fold every equation belongs to.
fn fold_of(source: &Source<'_>, folding: Folding) -> Vec<usize> {
    let runs = source.runs.max(1);
    match folding {
        Folding::Runs => {
            let per_fold = runs.div_ceil(MOST);
            source.scalars.iter().map(|s| source.rows[s.row].run / per_fold).collect()
        }
        Folding::Stretches => {
            let mut length = vec![0usize; runs];
            let mut place_of_row = vec![0usize; source.rows.len()];
            for (index, row) in source.rows.iter().enumerate() {
                place_of_row[index] = length[row.run];
                length[row.run] += 1;
            }
            let pieces = (MOST / runs).clamp(2, 6);
            let fold = |s: &Scalar| {
                let run = source.rows[s.row].run;
                let piece = pieces * place_of_row[s.row] / length[run].max(1);
                (run * pieces + piece.min(pieces - 1)) % MOST
            };
            source.scalars.iter().map(fold).collect()
        }
    }
}
