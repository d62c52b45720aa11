//! What a machine amounts to over its control points.

use machine_model::Vector;

/// Criteria of Serkov 2017, equation (52).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Criteria {
    /// M, largest |d|, mm.
    pub largest_mm: f64,
    /// The first control point where it is reached.
    pub largest_at: usize,
    /// Smallest |d|, mm.
    pub smallest_mm: f64,
    /// Root mean square of |d|, mm.
    pub rms_mm: f64,
}

impl Criteria {
    /// Of the errors at the control points, mm; `None` of none.
    #[must_use]
    pub fn of(errors_mm: &[Vector]) -> Option<Self> {
        let lengths = errors_mm.iter().map(Vector::norm).enumerate();
        let (largest_at, largest_mm) = lengths.clone().reduce(|a, b| if b.1 > a.1 { b } else { a })?;
        let (_, smallest_mm) = lengths.reduce(|a, b| if b.1 < a.1 { b } else { a })?;
        let sum: f64 = errors_mm.iter().map(Vector::norm_squared).sum();
        Some(Self { largest_mm, largest_at, smallest_mm, rms_mm: (sum / errors_mm.len() as f64).sqrt() })
    }

    /// A, largest less smallest |d|, mm.
    #[must_use]
    pub fn spread_mm(&self) -> f64 {
        self.largest_mm - self.smallest_mm
    }
}
