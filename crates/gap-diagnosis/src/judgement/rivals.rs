//! Which other effects the data cannot tell from a named one.

use machine_model::effects::EffectKind;
use nalgebra::DMatrix;

use crate::equations::linear::{Factor, Products, explained};
use crate::library::candidates::Part;
use crate::search::explanation::Explanation;
use crate::search::moves::{with, without};
use crate::search::space::{Asked, Sweep, WITHIN};

/// Two effects look alike where the correlation of what they do to this design, set-up and other causes
/// taken out, reaches this.
pub(crate) const ALIKE: f64 = 0.98;

/// An effect that could stand in for a named one.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rival {
    /// Which.
    pub kind: EffectKind,
    /// Its best form in place of the named one.
    pub part: Part,
    /// How far its score lies behind.
    pub behind: f64,
    /// Correlation of the named effect's displacement with the nearest one of the rival.
    pub correlation: f64,
}

impl Rival {
    /// True where the data cannot tell it from the named effect.
    pub(crate) fn cannot_be_told(&self) -> bool {
        self.behind <= WITHIN || self.correlation >= ALIKE
    }
}

/// Other effects in place of the part at `place`, the nearest in score first.
pub(crate) fn rivals(model: &Explanation, place: usize) -> Vec<Rival> {
    let rest = without(&model.parts, place);
    let own = model.parts[place];
    let scanned = model.space.scan(&model.library, &rest, Asked::WithRivals);
    let own_score = scanned
        .iter()
        .filter(|(p, _)| p.candidate == own.candidate)
        .map(|(_, f)| f.score)
        .fold(f64::INFINITY, f64::min);
    let own_prior = model.log_prior(&model.parts);
    let left = left_over(model, &rest);
    let contribution = contribution(model, &left, own);
    let mut found: Vec<Rival> = Vec::new();
    for candidate in 0..model.library.candidates.len() {
        if candidate == own.candidate {
            continue;
        }
        let is_itself = |part: Part| model.library.slopes_as(part, model.library.kind(own));
        let forms = scanned.iter().filter(|(p, _)| p.candidate == candidate && !is_itself(*p));
        let Some((part, fit)) = forms.min_by(|a, b| a.1.score.total_cmp(&b.1.score)) else { continue };
        // What no machine usually has lies further behind than its fit; no rival is likelier by that than one without
        // a price.
        let mut behind = fit.score - own_score;
        if behind <= WITHIN {
            behind += 2.0 * (own_prior - model.log_prior(&with(&rest, *part))).max(0.0);
        }
        // A rival that must be bent to look alike is judged by its score; one that looks alike as it stands
        // in textbooks is a rival whatever the score says: the true shape is neither.
        let correlation = (0..model.library.candidates[candidate].variants.len())
            .filter(|variant| !model.library.candidates[candidate].variants[*variant].enriched)
            .map(|variant| alike(model, &left, &contribution, Part { candidate, variant }))
            .fold(0.0, f64::max);
        let kind = model.library.candidates[candidate].kind;
        let own_kind = model.library.candidates[own.candidate].kind;
        // An instrument warms up as a machine does, in any shape: what creeps alike everywhere is either's.
        let creeps = matches!(own_kind, EffectKind::Warmup(_)) && kind == EffectKind::InstrumentDrift;
        let correlation = if creeps { 1.0 } else { correlation };
        found.push(Rival { kind, part: *part, behind, correlation });
    }
    found.sort_by(|a, b| a.behind.total_cmp(&b.behind));
    found
}

/// Products with the columns of `rest` eliminated, at the model's run-offset ratio.
fn left_over<'a>(model: &'a Explanation, rest: &[Part]) -> Sweep<'a> {
    let products = model.space.products(model.fit.level);
    let columns = model.space.columns(&model.library, rest);
    Sweep::new(products, &columns, model.space.reference(), &vec![true; products.count()])
}

/// Inner products of the fitted displacement of a part with every column, and its square last.
fn contribution(model: &Explanation, left: &Sweep<'_>, part: Part) -> Vec<f64> {
    let columns = model.space.columns(&model.library, &[part]);
    let last = left.count() - 1;
    let factor = Factor::new(left, &columns, model.space.reference());
    let b: Vec<f64> = columns.iter().map(|c| left.product(*c, last)).collect();
    let x = factor.solve(&b, columns.len());
    let mut products: Vec<f64> = (0..last)
        .map(|j| columns.iter().enumerate().map(|(i, c)| x[i] * left.product(*c, j)).sum())
        .collect();
    products.push(columns.iter().enumerate().map(|(i, c)| x[i] * products[*c]).sum());
    products
}

fn alike(model: &Explanation, left: &Sweep<'_>, contribution: &[f64], rival: Part) -> f64 {
    let columns = model.space.columns(&model.library, &[rival]);
    let count = columns.len();
    let last = contribution.len() - 1;
    let at = |i: usize, j: usize| match (columns.get(i), columns.get(j)) {
        (Some(a), Some(b)) => left.product(*a, *b),
        (Some(a), None) | (None, Some(a)) => contribution[*a],
        (None, None) => contribution[last],
    };
    let small = DMatrix::from_fn(count + 1, count + 1, at);
    let reference: Vec<f64> = columns.iter().map(|c| model.space.reference()[*c]).collect();
    let all: Vec<usize> = (0..count).collect();
    let (square, _) = explained(&small, &all, &reference);
    if contribution[last] > 0.0 { (square / contribution[last]).clamp(0.0, 1.0).sqrt() } else { 0.0 }
}
