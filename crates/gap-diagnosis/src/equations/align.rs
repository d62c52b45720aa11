//! The gap after the set-up is fitted: what is left to explain, in µm.

use machine_model::Vector;

use crate::equations::columns::Source;
use crate::equations::gram::Gram;
use crate::equations::observation::{Measurements, Scalar};
use crate::equations::set_up::{Clamping, frame};
use crate::equations::term::Term;

/// Below this many equations a set-up is not fitted: six parameters would eat what they should judge.
const ENOUGH_FOR_SETUP: usize = 24;

/// Readings per run and component that its zero is fitted to, at least.
const ROWS_PER_ZERO: f64 = 3.0;

/// Run offsets of any size: the set-up of a new run says nothing about the machine.
pub(crate) const FREE_OFFSETS: f64 = 1e6;

/// The gap less a displacement, set-up and the runs' offsets (of variance `ratio` times the noise's) fitted to what is
/// left. Few rows carry no frame; where they carry the zero of their runs, that alone is taken out: it is the set-up's and
/// neither gap nor gain.
pub(crate) fn aligned(
    data: &Measurements,
    scalars: &[Scalar],
    set_up: &[Term],
    ratio: f64,
    taken_off: &[(Term, f64)],
) -> Vec<f64> {
    let changed = less(data, scalars, taken_off);
    let source = Source::new(data, &changed);
    let set_up = if changed.len() < ENOUGH_FOR_SETUP { &[] } else { set_up };
    let gram = Gram::new(set_up.to_vec(), &source);
    if data.has_magnitudes() || (changed.len() as f64) < ROWS_PER_ZERO * gram.offsets_fitted() {
        return changed.iter().map(|s| s.gap_um).collect();
    }
    gram.solve(ratio, &source).residuals_um
}

/// Root mean square over the rows of the gap, one set-up and the zero of every run taken out, µm.
#[must_use]
pub fn gap_rms_um(data: &Measurements) -> f64 {
    let scalars = data.scalars(None);
    rms(&row_lengths(&scalars, &aligned(data, &scalars, &frame(data, Clamping::Shifted), FREE_OFFSETS, &[])))
}

/// Equations with a displacement taken off.
fn less(data: &Measurements, scalars: &[Scalar], taken_off: &[(Term, f64)]) -> Vec<Scalar> {
    scalars
        .iter()
        .map(|s| {
            let row = &data.rows[s.row];
            let sum: f64 = taken_off.iter().map(|(t, v)| v * t.value(s, row, &data.geometry)).sum();
            Scalar { gap_um: s.gap_um - sum, ..*s }
        })
        .collect()
}

/// Length of the gap of every row that has any equation, µm.
pub(crate) fn row_lengths(scalars: &[Scalar], values: &[f64]) -> Vec<f64> {
    let mut lengths: Vec<f64> = Vec::new();
    let mut last = None;
    for (scalar, value) in scalars.iter().zip(values) {
        if last != Some(scalar.row) {
            lengths.push(0.0);
            last = Some(scalar.row);
        }
        if let Some(square) = lengths.last_mut() {
            *square += value * value;
        }
    }
    for length in &mut lengths {
        *length = length.sqrt();
    }
    lengths
}

/// Root mean square.
pub(crate) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// What some terms displace every row, µm.
pub(crate) fn displacements(data: &Measurements, terms: &[(Term, f64)]) -> Vec<Vector> {
    let one = |row| {
        terms
            .iter()
            .map(|(t, v)| t.displacement_um(row, &data.geometry) * *v)
            .fold(Vector::zeros(), |a, b| a + b)
    };
    data.rows.iter().map(one).collect()
}

/// Rows that hold only the length of their displacement: measured minus modelled length, µm.
pub(crate) fn magnitude_errors(data: &Measurements, taken_off: &[(Term, f64)]) -> Vec<f64> {
    data.rows
        .iter()
        .zip(displacements(data, taken_off))
        .filter_map(|(row, effects)| match row.reading {
            crate::equations::observation::Reading::Magnitude(um) => {
                Some(um - (1e3 * row.predicted_mm + effects).norm())
            }
            _ => None,
        })
        .collect()
}
