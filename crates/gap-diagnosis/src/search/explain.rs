//! From equations to an explained gap: outliers go, and what was taken for granted of noise and set-up is asked again.

use machine_model::effects::EffectKind;

use crate::equations::columns::{Places, Source};
use crate::equations::fit::{Solution, residuals};
use crate::equations::noise::{blunders, estimate, outliers};
use crate::equations::observation::{Measurements, Scalar};
use crate::equations::pool::Pool;
use crate::equations::set_up::Clamping;
use crate::search::climb::{Task, pass};
use crate::search::doubt::{self, Setting, could_be_turned};
use crate::search::explanation::Explanation;
use crate::search::space::WITHIN;

/// A correlation that grows by less is the same.
const MORE: f64 = 0.05;
/// Passes of dropping outliers and searching again.
const PASSES: usize = 3;

/// Runs the search once, outliers and all.
#[must_use]
pub(crate) fn explain_roughly(
    data: &Measurements,
    scalars: &[Scalar],
    without: &[EffectKind],
) -> Explanation {
    let places = Places::new(&data.rows);
    let source = Source { places: Some(&places), ..Source::new(data, scalars) };
    pass(data, &mut Pool::new(&source), &[], without, Setting::default(), None, Task::Search)
}

/// Runs the search, and again where what it took for granted of noise and set-up does not hold on what it left.
#[must_use]
pub(crate) fn explain(data: &Measurements, scalars: &[Scalar], without: &[EffectKind]) -> Explanation {
    let places = Places::new(&data.rows);
    let shifted = weighed_and_settled(data, scalars, without, &places, Clamping::Shifted);
    if !could_be_turned(data) {
        return shifted;
    }
    let noise = estimate(&data.rows, &shifted.scalars, &shifted.solution.residuals_um, shifted.phi);
    let left = |model: &Explanation| {
        let noise = noise.map_or(0.0, |n| n.variance) * model.space.degrees;
        (model.solution.residual_square - noise).max(0.0)
    };
    if left(&shifted) <= 0.0 && shifted.parts.is_empty() {
        return shifted;
    }
    let turned = weighed_and_settled(data, scalars, without, &places, Clamping::Turned);
    // Angles of runs explain more than they cost, and most of what no cause explains.
    let better = turned.evidence() < shifted.evidence() - WITHIN && left(&turned) <= 0.5 * left(&shifted);
    if better { turned } else { shifted }
}

/// The search with weights by component where these scatter differently.
fn weighed_and_settled(
    data: &Measurements,
    scalars: &[Scalar],
    without: &[EffectKind],
    places: &Places,
    clamping: Clamping,
) -> Explanation {
    let source = Source { places: Some(places), ..Source::new(data, scalars) };
    let first = settled(data, &source, without, clamping, None);
    match doubt::weighed(data, &first, scalars) {
        Some(scalars) => {
            settled(data, &Source { scalars: &scalars, ..source }, without, clamping, Some(first))
        }
        None => first,
    }
}

/// Runs the search, drops lone outliers, and searches again until they stay the same; then once more where the readings
/// of a run turn out to hang together.
fn settled(
    data: &Measurements,
    source: &Source<'_>,
    without: &[EffectKind],
    clamping: Clamping,
    start: Option<Explanation>,
) -> Explanation {
    let scalars = source.scalars;
    // Then they are no exceptions.
    let too_many = |rows: &[usize]| rows.len() * 5 > data.rows.len();
    let mut pool = Pool::new(source);
    let mut dropped = blunders(&data.rows, scalars);
    if too_many(&dropped) {
        dropped.clear();
    }
    let mut setting = Setting { phi: 0.0, caution: 0.0, clamping };
    let mut result = pass(data, &mut pool, &dropped, without, setting, start, Task::Search);
    let lone = |solution: &Solution| {
        let residuals = conditional_residuals(solution, source);
        outliers(&data.rows, scalars, &residuals)
    };
    for nth in 0..PASSES {
        let local = result.parts.iter().any(|p| is_local(result.library.kind(*p)));
        let found =
            if nth == 0 && local { lone(&without_damage(&result, source)) } else { lone(&result.solution) };
        if found == dropped || too_many(&found) {
            break;
        }
        dropped = found;
        result = pass(data, &mut pool, &dropped, without, setting, Some(result), Task::Search);
    }
    setting.phi = doubt::phi(&data.rows, &result.scalars, &result.solution.residuals_um);
    let hanging = |model: &Explanation| {
        doubt::caution(&data.rows, &model.scalars, &model.solution.residuals_um).max(setting.phi)
    };
    // Names that noise made take its smoothness with them: as they go, what is left hangs together more.
    for _ in 0..PASSES {
        let now = hanging(&result);
        if now < setting.caution + MORE || result.parts.is_empty() {
            break;
        }
        setting.caution = now;
        result = pass(data, &mut pool, &dropped, without, setting, Some(result), Task::Search);
    }
    setting.caution = setting.caution.max(hanging(&result));
    result = pass(data, &mut pool, &dropped, without, setting, Some(result), Task::Imitate);
    result.outliers.clone_from(&dropped);
    if !dropped.is_empty() {
        let all = conditional_residuals(&result.solution, source);
        let left_out = scalars.iter().zip(all).filter(|(s, _)| dropped.binary_search(&s.row).is_ok());
        result.dropped_residuals_um = left_out.map(|(_, r)| r).collect();
    }
    result
}

const fn is_local(kind: EffectKind) -> bool {
    matches!(kind, EffectKind::Local(_))
}

/// The model without damage at a place.
fn without_damage(model: &Explanation, source: &Source<'_>) -> Solution {
    let mut parts = model.parts.clone();
    parts.retain(|p| !is_local(model.library.kind(*p)));
    let sub = model.space.gram.select(&model.library.model_columns(&parts));
    sub.solve(model.solution.rho, source)
}

fn conditional_residuals(solution: &Solution, source: &Source<'_>) -> Vec<f64> {
    residuals(&solution.terms, &solution.coefficients, source)
        .iter()
        .zip(source.scalars)
        .map(|(r, s)| r - s.along.dot(&solution.run_offsets_um[source.rows[s.row].run]))
        .collect()
}
