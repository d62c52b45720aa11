//! Rows that hold only the length of a displacement.
//!
//! A length is linear in the displacement only once its direction is known roughly. So every textbook form of
//! every effect, with either sign and the amplitude that fits the lengths best, is tried as a start; the best
//! few are linearised, searched, linearised again about what was found, and the one that leaves least wins.

use machine_model::Vector;
use machine_model::effects::EffectKind;

use crate::engine::{Explained, explain, explain_roughly};
use crate::fit::residuals;
use crate::library::Library;
use crate::observation::{Measurements, Reading, Scalar};
use crate::term::Term;

/// Starts that are followed to the end, each a different effect.
const STARTS: usize = 5;
/// Linearisations per start.
const ROUNDS: usize = 2;
/// Two ends are equally good within this difference of score.
const CLOSE: f64 = 10.0;

/// Equations of a file and its explanation; the notes say what the lengths leave open.
#[must_use]
pub(crate) fn explained(data: &Measurements, without: &[EffectKind]) -> (Explained, Vec<String>) {
    if !data.has_magnitudes() {
        return (explain(data, &data.scalars(None), without), Vec::new());
    }
    let mut best: Option<(f64, Explained)> = None;
    let mut scores = Vec::new();
    for start in starts(data, without) {
        let mut estimate = start;
        let mut found: Option<Explained> = None;
        for round in 1..=ROUNDS {
            let scalars = data.scalars(Some(&estimate));
            // Where the direction is a guess, an outlier cannot be known.
            let model = if round < ROUNDS {
                explain_roughly(data, &scalars, without)
            } else {
                explain(data, &scalars, without)
            };
            estimate = displacement(data, &model);
            found = Some(model);
        }
        let Some(model) = found else { continue };
        let misfit = misfit(data, &estimate, &model.outliers);
        // Every column bought must be worth its price in lengths, too.
        let score = data.rows.len() as f64 * units::math::ln(misfit.max(1e-9))
            + model.fit.rank as f64 * units::math::ln(data.rows.len() as f64);
        let kinds: Vec<EffectKind> =
            model.parts.iter().map(|p| model.library.candidates[p.candidate].kind).collect();
        scores.push((score, kinds));
        if best.as_ref().is_none_or(|(s, _)| score < *s) {
            best = Some((score, model));
        }
    }
    let close: Vec<EffectKind> = best.as_ref().map_or_else(Vec::new, |(score, _)| {
        let near = scores.iter().filter(|(s, _)| *s < score + CLOSE);
        near.flat_map(|(_, kinds)| kinds.iter().copied()).collect()
    });
    let notes =
        vec!["Only lengths of displacements were measured: where the model alone predicts none, the sign of a cause is open.".to_owned()];
    let mut model = best.map_or_else(|| explain(data, &[], without), |(_, model)| model);
    model.equally_good = close;
    (model, notes)
}

/// Displacements to start from, µm per row: nothing, and single effects.
fn starts(data: &Measurements, without: &[EffectKind]) -> Vec<Vec<Vector>> {
    let library = Library::new(data, without);
    let predicted: Vec<Vector> = data.rows.iter().map(|r| 1e3 * r.predicted_mm).collect();
    let measured: Vec<f64> =
        data.rows.iter().map(|r| if let Reading::Magnitude(um) = r.reading { um } else { 0.0 }).collect();
    let mut tried: Vec<(f64, EffectKind, Vec<Vector>)> = Vec::new();
    for candidate in &library.candidates {
        for variant in candidate.variants.iter().filter(|v| v.columns.len() <= 2) {
            for column in &variant.columns {
                let unit: Vec<Vector> = data
                    .rows
                    .iter()
                    .map(|r| library.terms[*column].displacement_um(r, &data.geometry))
                    .collect();
                for sign in [1.0, -1.0] {
                    let found = amplitude(&measured, &predicted, &unit, sign);
                    tried.extend(found.map(|(left, estimate)| (left, candidate.kind, estimate)));
                }
            }
        }
    }
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut kinds: Vec<EffectKind> = Vec::new();
    let mut starts: Vec<Vec<Vector>> = Vec::new();
    for (_, kind, estimate) in tried {
        if starts.len() < STARTS && !kinds.contains(&kind) {
            kinds.push(kind);
            starts.push(estimate);
        }
    }
    if predicted.iter().any(|p| p.norm() > 0.0) {
        starts.push(vec![Vector::zeros(); data.rows.len()]);
    }
    starts
}

/// Best amplitude of one column with one sign, by repeated linearisation, and the misfit it leaves.
fn amplitude(
    measured: &[f64],
    predicted: &[Vector],
    unit: &[Vector],
    sign: f64,
) -> Option<(f64, Vec<Vector>)> {
    let size = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let lengths: Vec<f64> = unit.iter().map(|u| u.norm()).collect();
    if size(&lengths) <= 0.0 {
        return None;
    }
    let mut value = sign * size(measured) / size(&lengths);
    for _ in 0..12 {
        let (mut up, mut down) = (0.0, 0.0);
        for ((m, p), u) in measured.iter().zip(predicted).zip(unit) {
            let whole = p + u * value;
            let norm = whole.norm();
            if norm > 0.0 {
                let slope = whole.dot(u) / norm;
                up += slope * (m - norm);
                down += slope * slope;
            }
        }
        if down <= 0.0 {
            break;
        }
        value += up / down;
    }
    let estimate: Vec<Vector> = unit.iter().map(|u| u * value).collect();
    let left: f64 = measured
        .iter()
        .zip(predicted.iter().zip(&estimate))
        .map(|(m, (p, e))| (m - (p + e).norm()).powi(2))
        .sum();
    Some((left, estimate))
}

/// What set-up, run offsets and effects displace every row, µm.
fn displacement(data: &Measurements, model: &Explained) -> Vec<Vector> {
    let pairs: Vec<(&Term, f64)> =
        model.solution.terms.iter().zip(model.solution.coefficients.iter().copied()).collect();
    data.rows
        .iter()
        .map(|row| {
            pairs
                .iter()
                .map(|(t, v)| t.displacement_um(row, &data.geometry) * *v)
                .fold(model.solution.run_offsets_um[row.run], |a, b| a + b)
        })
        .collect()
}

/// Mean square of measured minus modelled length.
fn misfit(data: &Measurements, estimate: &[Vector], outliers: &[usize]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (index, (row, e)) in data.rows.iter().zip(estimate).enumerate() {
        if let Reading::Magnitude(um) = row.reading
            && outliers.binary_search(&index).is_err()
        {
            let left = um - (1e3 * row.predicted_mm + e).norm();
            sum += left * left;
            count += 1.0;
        }
    }
    sum / f64::max(count, 1.0)
}

/// Equations of the first linearisation: enough to see whether there is anything to explain.
#[must_use]
pub(crate) fn first_equations(data: &Measurements) -> Vec<Scalar> {
    if !data.has_magnitudes() {
        return data.scalars(None);
    }
    // Any direction will do to count readings and to see that they differ.
    let anywhere = vec![Vector::new(1e-6, 0.0, 0.0); data.rows.len()];
    let scalars = data.scalars(Some(&anywhere));
    debug_assert!(residuals_are_finite(data, &scalars), "lengths are finite");
    scalars
}

fn residuals_are_finite(data: &Measurements, scalars: &[Scalar]) -> bool {
    residuals(&[], &[], &crate::engine::source(data, scalars)).iter().all(|r| r.is_finite())
}
