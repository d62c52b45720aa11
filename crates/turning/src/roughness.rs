//! Theoretical roughness of a turned surface.

use units::math;

/// What a feed and a tool's nose leave between two turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness {
    /// Height of the ridge, mm: the exact geometry. `None` where the nose does not meet its own cut of the turn before, and
    /// the tool's edges are not given.
    pub exact_mm: Option<f64>,
    /// `f²/8r`, mm.
    pub usual_mm: f64,
}

/// Height of the ridges that a round nose leaves. Equation (74).
///
/// Two arcs a feed apart: `r − √(r² − f²/4)`, as long as they meet, `f ≤ 2r sin κ'`. Behind that the straight minor
/// edge, tangent to the nose and at κ' to the axis, meets the arc: `r(1−c) + f·s·c − s·√(2frs − f²s²)`, s and c of κ',
/// as long as that is not above the nose's centre.
///
/// * `feed_mm` – mm a turn
/// * `nose_mm` – the nose's radius, mm
/// * `minor_edge_rad` – κ', angle of the minor cutting edge to the axis; `None`: only the nose cuts
///
/// ```
/// let fine = turning::roughness(0.2, 0.8, None);
/// assert!((fine.usual_mm - 0.006_25).abs() < 1e-15);
/// assert!((fine.exact_mm.unwrap() - (0.8 - (0.64f64 - 0.01).sqrt())).abs() < 1e-15);
/// ```
#[must_use]
pub fn roughness(feed_mm: f64, nose_mm: f64, minor_edge_rad: Option<f64>) -> Roughness {
    let (f, r) = (feed_mm, nose_mm);
    let arcs = || r - (r * r - 0.25 * f * f).sqrt();
    let exact_mm = match minor_edge_rad {
        None => (f <= 2.0 * r).then(arcs),
        Some(edge) => {
            let (s, c) = math::sin_cos(edge);
            if f <= 2.0 * r * s {
                Some(arcs())
            } else {
                let under = 2.0 * f * r * s - f * f * s * s;
                let height = r * (1.0 - c) + f * s * c - s * under.max(0.0).sqrt();
                // Higher than its centre the nose has no arc: there the major edge cuts.
                (under >= 0.0 && height <= r).then_some(height)
            }
        }
    };
    Roughness { exact_mm, usual_mm: f * f / (8.0 * r) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ridge_is_where_the_cuts_of_two_turns_meet() {
        for (f, r, edge) in
            [(0.2, 0.8, None), (0.3, 0.4, Some(0.5)), (0.5, 0.4, Some(0.1)), (0.6, 0.4, Some(0.3))]
        {
            // Heights of the two cuts above the bottom, found by halving between the two tools.
            let arc = |x: f64| r - (r * r - x * x).sqrt();
            let (s, c) = math::sin_cos(edge.unwrap_or(1.5));
            let next = |x: f64| {
                let back = f - x;
                if back <= r * s { arc(back) } else { r * (1.0 - c) + (back - r * s) * s / c }
            };
            let (mut low, mut high) = (0.0, f);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                if middle >= r || arc(middle) > next(middle) { high = middle } else { low = middle }
            }
            let exact = roughness(f, r, edge).exact_mm.unwrap();
            assert!((exact - next(low)).abs() < 1e-9, "{f} {r}: {exact} {}", next(low));
        }
        for (f, r, edge) in [(1.0, 0.4, None), (1.0, 0.2, Some(0.3))] {
            assert_eq!(roughness(f, r, edge).exact_mm, None);
        }
    }
}
