//! How alike the effects are on a design, before anything is measured.

use machine_model::effects::EffectKind;
use nalgebra::DMatrix;

use crate::equations::columns::Source;
use crate::equations::gram::{Gram, eliminate};
use crate::equations::linear::Factor;
use crate::equations::observation::Measurements;
use crate::equations::set_up::Clamping;
use crate::library::candidates::{Candidate, Library};

/// Offsets of the runs are taken to be as large as the noise of a reading.
const RHO: f64 = 1.0;

/// Largest canonical correlations of what the effects do to a design, set-up and run offsets taken out.
#[derive(Clone, Debug, PartialEq)]
pub struct Confounding {
    /// The effects the design could show: it varies in what they need.
    pub effects: Vec<EffectKind>,
    /// Of these, the ones of which the set-up leaves nothing.
    pub hidden: Vec<EffectKind>,
    /// Symmetric, in the order of `effects`; 1 on the diagonal, 0 in the rows of hidden ones.
    pub correlation: Vec<Vec<f64>>,
}

impl Confounding {
    /// Correlation from which two effects count as indistinguishable.
    pub const ALIKE: f64 = crate::judgement::rivals::ALIKE;

    /// Pairs that this design cannot tell apart, the most alike first.
    #[must_use]
    pub fn pairs(&self, least: f64) -> Vec<(EffectKind, EffectKind, f64)> {
        let mut found = Vec::new();
        for (i, row) in self.correlation.iter().enumerate() {
            for (j, value) in row.iter().enumerate().skip(i + 1).filter(|(_, v)| **v >= least) {
                found.push((self.effects[i], self.effects[j], *value));
            }
        }
        found.sort_by(|a, b| b.2.total_cmp(&a.2));
        found
    }
}

/// Compares the textbook forms of all effects on the commands and conditions of `design`; its readings do not count,
/// but there must be some.
///
/// Between two effects with several textbook forms (time constants, places) the pair of forms that is most alike counts.
#[must_use]
pub fn confounding(design: &Measurements) -> Confounding {
    let library = Library::new(design, &[], Clamping::Shifted);
    let scalars = design.scalars(None);
    let gram = Gram::new(library.terms.clone(), &Source::new(design, &scalars));
    let (whitened, _) = gram.whitened(RHO);
    let squares: Vec<f64> = (0..gram.products.nrows()).map(|i| gram.products[(i, i)]).collect();
    let (left, _) = eliminate(&whitened, library.nuisances, &squares);
    let bases: Vec<Vec<Basis>> = library
        .candidates
        .iter()
        .map(|c| {
            forms(c, library.nuisances)
                .map(|columns| basis(&left, columns, &squares, library.nuisances))
                .collect()
        })
        .collect();
    let count = bases.len();
    let mut correlation = vec![vec![0.0; count]; count];
    for i in 0..count {
        correlation[i][i] = 1.0;
        for j in 0..i {
            let pairs = bases[i].iter().flat_map(|a| bases[j].iter().map(move |b| (a, b)));
            let value = pairs.map(|(a, b)| canonical(&left, a, b)).fold(0.0, f64::max);
            (correlation[i][j], correlation[j][i]) = (value, value);
        }
    }
    let effects: Vec<EffectKind> = library.candidates.iter().map(|c| c.kind).collect();
    let hidden = effects.iter().zip(&bases).filter(|(_, b)| b.iter().all(|f| f.combinations.ncols() == 0));
    Confounding { hidden: hidden.map(|(kind, _)| *kind).collect(), effects, correlation }
}

/// Columns of the textbook forms, counted behind the set-up.
fn forms(candidate: &Candidate, nuisances: usize) -> impl Iterator<Item = Vec<usize>> {
    let textbook = candidate.variants.iter().filter(|v| !v.enriched);
    textbook.map(move |v| v.columns.iter().map(|c| c - nuisances).collect())
}

/// Combinations of some columns that are orthonormal in the products; none for what is hidden.
struct Basis {
    columns: Vec<usize>,
    combinations: DMatrix<f64>,
}

fn basis(products: &DMatrix<f64>, columns: Vec<usize>, squares: &[f64], nuisances: usize) -> Basis {
    let references: Vec<f64> = columns.iter().map(|c| squares[c + nuisances].max(1e-300)).collect();
    let own = DMatrix::from_fn(columns.len(), columns.len(), |i, j| products[(columns[i], columns[j])]);
    let all: Vec<usize> = (0..columns.len()).collect();
    let factor = Factor::new(&own, &all, &references);
    let rank = factor.rank();
    let mut combinations = DMatrix::zeros(columns.len(), rank);
    for k in 0..rank {
        let unit: Vec<f64> = (0..rank).map(|i| if i == k { 1.0 } else { 0.0 }).collect();
        for (i, value) in factor.forward(&unit).into_iter().enumerate() {
            combinations[(factor.kept[k], i)] = value;
        }
    }
    Basis { columns, combinations }
}

/// Largest singular value of the products of two bases.
fn canonical(products: &DMatrix<f64>, a: &Basis, b: &Basis) -> f64 {
    if a.combinations.ncols() == 0 || b.combinations.ncols() == 0 {
        return 0.0;
    }
    let between =
        DMatrix::from_fn(a.columns.len(), b.columns.len(), |i, j| products[(a.columns[i], b.columns[j])]);
    let cross = a.combinations.transpose() * between * &b.combinations;
    let square = &cross * cross.transpose();
    square.symmetric_eigenvalues().iter().fold(0.0_f64, |m, v| m.max(*v)).sqrt().min(1.0)
}
