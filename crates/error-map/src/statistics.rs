//! The figures of a map.

use machine_model::{Range, Vector};

/// What a set of volumetric errors amounts to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Number of nodes.
    pub nodes: usize,
    /// Smallest and largest error per axis, mm. Their distance is the range of ISO 230-1:2012 for the
    /// volumetric accuracy of three linear axes; it does not change when the zero point is moved.
    pub component_mm: [Range; 3],
    /// Smallest and largest |d|, mm.
    pub magnitude_mm: Range,
    /// Root mean square of |d|, mm.
    pub rms_mm: f64,
    /// Smallest value that at least 95 % of all |d| do not exceed (nearest rank), mm.
    pub p95_mm: f64,
    /// Nodes with |d| not above the tolerance.
    pub within: usize,
}

impl Statistics {
    /// Of errors in mm; `None` of none.
    #[must_use]
    pub fn of(errors_mm: &[Vector], tolerance_mm: f64) -> Option<Self> {
        Self::shifted(errors_mm, &Vector::zeros(), tolerance_mm)
    }

    /// Of the errors that are left after the zero point was moved: `d - shift`, equation (41).
    #[must_use]
    pub fn shifted(errors_mm: &[Vector], shift_mm: &Vector, tolerance_mm: f64) -> Option<Self> {
        if errors_mm.is_empty() {
            return None;
        }
        let mut low = Vector::repeat(f64::INFINITY);
        let mut high = Vector::repeat(f64::NEG_INFINITY);
        let mut sum = 0.0;
        let mut within = 0;
        let mut squares = Vec::with_capacity(errors_mm.len());
        for error in errors_mm {
            let left = error - shift_mm;
            low = low.inf(&left);
            high = high.sup(&left);
            let square = left.norm_squared();
            sum += square;
            within += usize::from(square.sqrt() <= tolerance_mm);
            squares.push(square);
        }
        let nodes = squares.len();
        let rank = (nodes * 95).div_ceil(100).max(1) - 1;
        let (below, p95, above) = squares.select_nth_unstable_by(rank, f64::total_cmp);
        let least = below.iter().copied().fold(*p95, f64::min);
        let most = above.iter().copied().fold(*p95, f64::max);
        Some(Self {
            nodes,
            component_mm: [0, 1, 2].map(|axis| Range { low: low[axis], high: high[axis] }),
            magnitude_mm: Range { low: least.sqrt(), high: most.sqrt() },
            rms_mm: (sum / nodes as f64).sqrt(),
            p95_mm: p95.sqrt(),
            within,
        })
    }

    /// Share of the nodes within tolerance, 0 to 1.
    #[must_use]
    pub fn share_within(&self) -> f64 {
        self.within as f64 / self.nodes as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_twenty_errors_along_x() {
        let errors: Vec<Vector> = (1..=20).map(|i| Vector::new(f64::from(i), 0.0, 0.0)).collect();
        let figures = Statistics::of(&errors, 5.0).unwrap();
        assert_eq!(figures.nodes, 20);
        assert_eq!(figures.component_mm[0], Range { low: 1.0, high: 20.0 });
        assert_eq!(figures.component_mm[2], Range { low: 0.0, high: 0.0 });
        assert_eq!(figures.magnitude_mm, Range { low: 1.0, high: 20.0 });
        // 19 of 20 are 95 %.
        assert_eq!(figures.p95_mm, 19.0);
        assert_eq!(figures.within, 5);
        assert!((figures.rms_mm - 143.5f64.sqrt()).abs() < 1e-12, "sum of squares 2870 over 20");
        assert!(Statistics::of(&[], 1.0).is_none());
    }

    #[test]
    fn a_shift_moves_components_and_keeps_ranges() {
        let errors = [Vector::new(1.0, 2.0, 3.0), Vector::new(4.0, -2.0, 3.0)];
        let before = Statistics::of(&errors, 1.0).unwrap();
        let after = Statistics::shifted(&errors, &Vector::new(1.0, 2.0, 3.0), 1.0).unwrap();
        for axis in 0..3 {
            let range = |s: &Statistics| s.component_mm[axis].high - s.component_mm[axis].low;
            assert_eq!(range(&before), range(&after));
        }
        assert_eq!(after.magnitude_mm.low, 0.0);
        assert_eq!(after.within, 1);
        assert_eq!(after.magnitude_mm.high, 5.0);
    }
}
