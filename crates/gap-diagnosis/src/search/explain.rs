//! From equations to an explained gap: outliers go, and what was taken for granted of noise and set-up is asked again.

use machine_model::effects::EffectKind;
use units::math;

use crate::equations::columns::{Places, Source};
use crate::equations::fit::{Solution, residuals};
use crate::equations::noise::{blunders, estimate, is_lumpy, outliers, tail_factor};
use crate::equations::observation::{Measurements, Scalar};
use crate::equations::pool::Pool;
use crate::equations::serial::Serial;
use crate::equations::set_up::Clamping;
use crate::search::climb::{Task, pass};
use crate::search::doubt::{self, Setting, could_be_turned};
use crate::search::explanation::Explanation;
use crate::search::space::WITHIN;

/// What grows by less than this factor is as before: readings that are as good as one, variance in the tails.
const MORE: f64 = 1.1;
/// Tails with less than this factor of the variance are none to tests: numbers would scatter by a tenth more.
const TAILS: f64 = 1.2;
/// Passes of dropping outliers and searching again.
const PASSES: usize = 3;

/// Runs the search once, outliers and all.
pub(crate) fn explain_roughly(
    data: &Measurements,
    scalars: &[Scalar],
    without: &[EffectKind],
) -> Explanation {
    let places = Places::new(&data.rows);
    let source = Source { places: Some(&places), ..Source::new(data, scalars) };
    pass(data, &mut Pool::new(&source), &[], without, Setting::plain(Clamping::default()), None, Task::Search)
}

/// Runs the search, and again where what it took for granted of noise and set-up does not hold on what it left.
pub(crate) fn explain(data: &Measurements, scalars: &[Scalar], without: &[EffectKind]) -> Explanation {
    let places = Places::new(&data.rows);
    let shifted = weighed_and_settled(data, scalars, without, &places, Clamping::Shifted);
    if !could_be_turned(data) {
        return shifted;
    }
    let noise = estimate(&data.rows, &shifted.scalars, &shifted.solution.residuals_um, shifted.serial);
    let left = |model: &Explanation| {
        let noise = noise.map_or(0.0, |n| n.variance) * model.space.degrees;
        (model.solution.residual_square - noise).max(0.0)
    };
    if left(&shifted) <= 0.0 && shifted.parts.is_empty() {
        return shifted;
    }
    if !turning_could_pay(data, &shifted) {
        return shifted;
    }
    let turned = weighed_and_settled(data, scalars, without, &places, Clamping::Turned);
    // Angles of runs explain more than they cost, and most of what no cause explains.
    let better = turned.evidence() < shifted.evidence() - WITHIN && left(&turned) <= 0.5 * left(&shifted);
    if better { turned } else { shifted }
}

/// True where angles of runs, beside the causes that a search without them found, come near to being worth their price in
/// evidence. Far below it no other causes make up for it: runs that are turned by angles of their own leave most of it.
fn turning_could_pay(data: &Measurements, shifted: &Explanation) -> bool {
    /// Share of the price that must be gained.
    const NEAR: f64 = 0.25;
    let equations = shifted.scalars.len() as f64;
    let price = 3.0 * data.runs.len() as f64 * math::ln(equations);
    let square = shifted.solution.residual_square.max(1e-12);
    let kept = (square - doubt::taken_by_turns(data, shifted)).max(1e-12);
    equations * math::ln(square / kept) > NEAR * price
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
    let mut setting = Setting::plain(clamping);
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
    setting.serial = Serial::of_noise(&data.rows, &result.scalars, &result.solution.residuals_um);
    let hanging = |model: &Explanation| {
        Serial::at_most(&data.rows, &model.scalars, &model.solution.residuals_um).max(setting.serial)
    };
    let tails = |model: &Explanation| {
        let left_out = left_out(&model.solution, source, &dropped);
        let factor = tail_factor(&model.scalars, &model.solution.residuals_um, &left_out);
        if factor > TAILS { factor } else { 1.0 }
    };
    // Names that noise made take its smoothness and its tails with them: as they go, what is left shows more of both.
    for _ in 0..PASSES {
        let (caution, tails) = (hanging(&result), tails(&result));
        let lumpy = is_lumpy(&result.scalars, &result.solution.residuals_um);
        let more = caution.as_one() > MORE * setting.caution.as_one()
            || tails > MORE * setting.tails
            || (lumpy && !setting.lumpy);
        if !more || result.parts.is_empty() {
            break;
        }
        (setting.caution, setting.tails) = (setting.caution.max(caution), setting.tails.max(tails));
        setting.lumpy |= lumpy;
        result = pass(data, &mut pool, &dropped, without, setting, Some(result), Task::Search);
    }
    if result.parts.len() > 1 {
        result = pass(data, &mut pool, &dropped, without, setting, Some(result), Task::Exchange);
    }
    setting.caution = setting.caution.max(hanging(&result));
    result = pass(data, &mut pool, &dropped, without, setting, Some(result), Task::Imitate);
    result.outliers.clone_from(&dropped);
    result.dropped_residuals_um = left_out(&result.solution, source, &dropped);
    result
}

/// What a model leaves of the rows that it was not fitted to, µm.
fn left_out(solution: &Solution, source: &Source<'_>, dropped: &[usize]) -> Vec<f64> {
    if dropped.is_empty() {
        return Vec::new();
    }
    let all = source.scalars.iter().zip(conditional_residuals(solution, source));
    all.filter(|(s, _)| dropped.binary_search(&s.row).is_ok()).map(|(_, r)| r).collect()
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
