//! What the page draws, as numbers: classes are in the JSON as well.

use machine_model::Vector;

use super::study::Study;

/// Classes of the histogram.
const CLASSES: usize = 40;

/// How many nodes have an error of which size, before and after the shift by the geometric median.
pub struct Classes {
    /// Width of a class, mm.
    pub width_mm: f64,
    /// Nodes by class, as they are.
    pub before: Vec<u64>,
    /// The same after the shift.
    pub after: Vec<u64>,
}

/// Of the volume.
pub fn classes(study: &Study) -> Classes {
    let median = study.parts[0].median();
    let largest = study.parts[0].figures.magnitude_mm.high.max(median.figures.magnitude_mm.high);
    let width_mm = report::scale::nice(largest.max(1e-9) / CLASSES as f64);
    let count = ((largest / width_mm).floor() as usize + 1).min(10 * CLASSES);
    let of = |shift: &Vector| {
        let mut counts = vec![0; count];
        for error in study.map.errors_mm() {
            counts[(((error - shift).norm() / width_mm) as usize).min(count - 1)] += 1;
        }
        counts
    };
    Classes { width_mm, before: of(&Vector::zeros()), after: of(&median.shift_mm) }
}
