//! Errors along the axes, through the middle of the map.

use machine_model::{PathModel, Vector};

use super::asked::Asked;

/// Places along each curve.
const CURVE: u32 = 101;
/// Errors along one axis, the others in the middle of the map.
pub struct Curve {
    /// 0 X, 1 Y, 2 Z.
    pub axis: usize,
    /// Places of that axis, mm.
    pub at_mm: Vec<f64>,
    /// Errors there, mm.
    pub errors_mm: Vec<Vector>,
}

/// Along each axis through the middle of the map.
pub(super) fn curves(map: &error_map::ErrorMap, model: &dyn PathModel, asked: &Asked) -> Vec<Curve> {
    let ranges = map.grid().axes().each_ref().map(|nodes| nodes.range_mm());
    let middle = Vector::from_fn(|axis, _| 0.5 * (ranges[axis].low + ranges[axis].high));
    (0..3)
        .map(|axis| {
            let share = |k: u32| f64::from(k) / f64::from(CURVE - 1);
            let at_mm: Vec<f64> = (0..CURVE)
                .map(|k| ranges[axis].low * (1.0 - share(k)) + ranges[axis].high * share(k))
                .collect();
            let error = |at: &f64| {
                let mut place = middle;
                place[axis] = *at;
                model.error_mm(&asked.command(place, [0; 3]))
            };
            Curve { axis, errors_mm: at_mm.iter().map(error).collect(), at_mm }
        })
        .collect()
}
