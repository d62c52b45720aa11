//! What to measure next.

use crate::diagnosis::NextMeasurement;
use crate::engine::Explained;
use crate::observation::Measurements;
use crate::search::Part;

/// The cheapest line that tells a cause from its rival.
#[must_use]
pub(crate) fn next_measurement(_data: &Measurements, _model: &Explained, _pair: &Option<(usize, Part)>) -> Option<NextMeasurement> {
    None
}
