//! What the page draws, as numbers: curves and classes are in the JSON as well.

use machine_model::{PathModel, Vector};

use super::options::{Asked, command};
use super::study::{Kind, Study, ZeroPoint};

/// Places along each curve.
const CURVE: u32 = 101;
/// Classes of the histogram.
const CLASSES: usize = 40;

/// Errors along one axis, the others in the middle of the map.
pub(super) struct Curve {
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
                model.error_mm(&command(asked, place, [0; 3]))
            };
            Curve { axis, errors_mm: at_mm.iter().map(error).collect(), at_mm }
        })
        .collect()
}

/// How many nodes have an error of which size, before and after the shift by the geometric median.
pub(super) struct Classes {
    /// Width of a class, mm.
    pub width_mm: f64,
    pub before: Vec<u64>,
    pub after: Vec<u64>,
}

pub(super) fn classes(study: &Study) -> Classes {
    let shift = median(study).shift_mm;
    let largest = study.parts[0].figures.magnitude_mm.high.max(median(study).figures.magnitude_mm.high);
    let width_mm = report::scale::nice(largest.max(1e-9) / CLASSES as f64);
    let count = ((largest / width_mm).floor() as usize + 1).min(10 * CLASSES);
    let of = |shift: &Vector| {
        let mut counts = vec![0; count];
        for error in study.map.errors_mm() {
            counts[(((error - shift).norm() / width_mm) as usize).min(count - 1)] += 1;
        }
        counts
    };
    Classes { width_mm, before: of(&Vector::zeros()), after: of(&shift) }
}

/// The answer that most work wants.
pub(super) fn median(study: &Study) -> &ZeroPoint {
    let all = &study.parts[0].zero_points;
    all.iter().find(|zero| zero.kind == Kind::Median).expect("every part has all four answers")
}
