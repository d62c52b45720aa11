//! How far a bar gives way to the tool.

use crate::beam::Beam;
use crate::workpiece::{Force, Workpiece, WorkpieceError};
use machine_model::{Bounds, Range};
use nalgebra::{SMatrix, SVector};

/// Deflection of the axis under the tool, in the direction away from it, as a function of the tool's Z.
///
/// Between steps and supports of a bar of even diameters it is a polynomial of degree 6 at most (a clamped bar's
/// influence is cubic, a reaction's share a square of one); each piece is found through seven of its values.
///
/// ```
/// use turning::{Bending, Clamping, Force, Workpiece};
///
/// let bar = Workpiece {
///     diameters_mm: vec![[0.0, 40.0], [300.0, 40.0]],
///     youngs_modulus_n_mm2: 210_000.0,
///     clamping: Clamping::Chuck,
///     steady_rests_mm: Vec::new(),
/// };
/// let bending = Bending::new(&bar, Force::Radial { newton: 400.0 }).unwrap();
/// assert!((bending.at_mm(300.0) - 0.136_42).abs() < 5e-6);
/// ```
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Bending {
    pub(crate) pieces: Vec<Piece>,
}

/// `Σ c_k u^k`, u = (z − middle)/half.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Piece {
    pub(crate) range_mm: Range,
    pub(crate) coefficients: [f64; DEGREES],
}

pub(crate) const DEGREES: usize = 7;
/// Pieces of a stretch whose diameter changes.
pub(crate) const TAPER_PIECES: usize = 8;

impl Bending {
    /// Of a bar under a force.
    ///
    /// Slender beam of Euler and Bernoulli, `I = π d⁴/64`; shear is neglected, which is
    /// `0.75·(1+ν)·(d/l)²` of it or 2.2 % for a chucked bar seven times as long as thick. Influence
    /// `h(a, b) = ∫ m_a m_b / EI ds` (Maxwell, Mohr), supports taken away by their reactions:
    /// `δ(a) = F·(h(a,a) − hᵀ H⁻¹ h)`.
    ///
    /// # Errors
    /// [`WorkpieceError`]
    pub fn new(bar: &Workpiece, force: Force) -> Result<Self, WorkpieceError> {
        let beam = Beam::new(bar)?;
        let newton = force.newton();
        let mut breaks: Vec<f64> = bar.diameters_mm.iter().map(|[z, _]| *z).collect();
        breaks.extend(&beam.supports_mm);
        for rows in bar.diameters_mm.windows(2).filter(|rows| rows[0][1] != rows[1][1]) {
            // A taper's deflection is no polynomial: short pieces are near enough to one.
            let share = |k: usize| k as f64 / TAPER_PIECES as f64;
            breaks.extend((1..TAPER_PIECES).map(|k| rows[0][0] + share(k) * (rows[1][0] - rows[0][0])));
        }
        breaks.retain(|at| *at <= beam.reach_mm);
        breaks.extend([0.0, beam.reach_mm]);
        breaks.sort_by(f64::total_cmp);
        breaks.dedup();
        let through = SMatrix::<f64, DEGREES, DEGREES>::from_fn(|row, k| node(row).powi(k as i32));
        let pieces = breaks.windows(2).filter_map(|ends| {
            let (middle, half) = (0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0]));
            let values = SVector::<f64, DEGREES>::from_fn(|row, _| {
                newton * beam.flexibility_mm_n(middle + half * node(row))
            });
            let coefficients = through.lu().solve(&values)?;
            Some(Piece { range_mm: Range { low: ends[0], high: ends[1] }, coefficients: coefficients.into() })
        });
        Ok(Self { pieces: pieces.collect() })
    }

    /// True where nothing bends.
    #[must_use]
    pub fn is_none(&self) -> bool {
        self.pieces.iter().all(|piece| piece.coefficients == [0.0; DEGREES])
    }

    /// Deflection with the tool at `z_mm` from the chuck, mm; beyond the bar's ends that at the end.
    #[must_use]
    pub fn at_mm(&self, z_mm: f64) -> f64 {
        let place = self.pieces.partition_point(|piece| piece.range_mm.high < z_mm);
        let Some(piece) = self.pieces.get(place).or(self.pieces.last()) else { return 0.0 };
        piece.value(z_mm.clamp(piece.range_mm.low, piece.range_mm.high))
    }

    /// Largest deflection of all places, mm, looked for in steps of a hundredth of each piece.
    #[must_use]
    pub fn largest_mm(&self) -> f64 {
        let places = self.pieces.iter().flat_map(|piece| {
            let Range { low, high } = piece.range_mm;
            (0..=100).map(move |k| low + (high - low) * f64::from(k) * 0.01)
        });
        places.map(|z| self.at_mm(z).abs()).fold(0.0, f64::max)
    }

    /// Bounds of it and its derivatives on a range.
    ///
    /// It has no kinks: a beam's slope is continuous, and so is a moving load's deflection. It stops growing at the bar's
    /// ends, where the slope jumps.
    pub(crate) fn bounds(&self, range: Range) -> Bounds {
        let mut all = Bounds::default();
        let (Some(first), Some(last)) = (self.pieces.first(), self.pieces.last()) else { return all };
        for (z, piece) in [(first.range_mm.low, first), (last.range_mm.high, last)] {
            all.value = all.value.max(piece.value(z).abs());
            if range.low < z && z < range.high {
                all.kinks += piece.derivative(z, 1).abs();
            }
        }
        for piece in &self.pieces {
            let own =
                Range { low: range.low.max(piece.range_mm.low), high: range.high.min(piece.range_mm.high) };
            if own.low <= own.high {
                all.value = all.value.max(piece.bound(own, 0));
                all.slope = all.slope.max(piece.bound(own, 1));
                all.curvature = all.curvature.max(piece.bound(own, 2));
            }
        }
        all
    }
}

/// Chebyshev's places on −1..1, where a polynomial through values is well determined.
pub(crate) fn node(row: usize) -> f64 {
    units::math::cos(std::f64::consts::PI * (row as f64 + 0.5) / DEGREES as f64)
}

impl Piece {
    pub(crate) fn middle_and_half(&self) -> (f64, f64) {
        (0.5 * (self.range_mm.low + self.range_mm.high), 0.5 * (self.range_mm.high - self.range_mm.low))
    }

    pub(crate) fn value(&self, z_mm: f64) -> f64 {
        self.derivative(z_mm, 0)
    }

    /// The n-th derivative at a place, mm per mmⁿ.
    pub(crate) fn derivative(&self, z_mm: f64, n: i32) -> f64 {
        let (middle, half) = self.middle_and_half();
        let u = (z_mm - middle) / half;
        let terms = (n as usize..DEGREES).rev();
        let sum = terms.fold(0.0, |sum, k| sum * u + falling(k as i32, n) * self.coefficients[k]);
        sum / half.powi(n)
    }

    /// Upper bound of the n-th derivative's magnitude on a range, by Taylor's series about the middle of that range.
    pub(crate) fn bound(&self, range: Range, n: i32) -> f64 {
        let (at, reach) = (0.5 * (range.low + range.high), 0.5 * (range.high - range.low));
        let (mut sum, mut weight) = (0.0, 1.0);
        for m in 0..(DEGREES as i32 - n) {
            sum += self.derivative(at, n + m).abs() * weight;
            weight *= reach / f64::from(m + 1);
        }
        sum
    }
}

/// `k·(k−1)·…`, n factors.
pub(crate) fn falling(k: i32, n: i32) -> f64 {
    (0..n).map(|i| f64::from(k - i)).product()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Clamping;

    fn bar(clamping: Clamping, steady_rests_mm: &[f64]) -> Workpiece {
        Workpiece {
            diameters_mm: vec![[0.0, 40.0], [300.0, 40.0]],
            youngs_modulus_n_mm2: 210_000.0,
            clamping,
            steady_rests_mm: steady_rests_mm.to_vec(),
        }
    }

    fn bent(clamping: Clamping, steady_rests_mm: &[f64], z_mm: f64) -> f64 {
        Bending::new(&bar(clamping, steady_rests_mm), Force::Radial { newton: 400.0 })
            .expect("a bar")
            .at_mm(z_mm)
    }

    const EI: f64 = 210_000.0 * std::f64::consts::PI * 40.0 * 40.0 * 40.0 * 40.0 / 64.0;
    /// 1e-6 µm.
    const NEAR_MM: f64 = 1e-9;

    #[test]
    fn textbook_bars_bend_as_in_the_textbook() {
        let l = 300.0;
        for z in [0.0, 1.0, 74.3, 150.0, 175.5, 299.0, 300.0] {
            let (a, b) = (z, l - z);
            let chuck = 400.0 * a * a * a / (3.0 * EI);
            assert!((bent(Clamping::Chuck, &[], z) - chuck).abs() < NEAR_MM, "chuck at {z}");
            let centres = 400.0 * a * a * b * b / (3.0 * EI * l);
            assert!(
                (bent(Clamping::Centres { at_mm: l }, &[], z) - centres).abs() < NEAR_MM,
                "centres at {z}"
            );
            let propped = 400.0 * a * a * a * b * b * (3.0 * l + b) / (12.0 * EI * l * l * l);
            let found = bent(Clamping::ChuckAndTailstock { at_mm: l }, &[], z);
            assert!((found - propped).abs() < NEAR_MM, "tailstock at {z}: {found} {propped}");
        }
        assert!((bent(Clamping::Chuck, &[], 300.0) - 0.136_42).abs() < 5e-6);
        assert!((bent(Clamping::Centres { at_mm: 300.0 }, &[], 150.0) - 0.008_526).abs() < 5e-7);
        assert!((bent(Clamping::ChuckAndTailstock { at_mm: 300.0 }, &[], 150.0) - 0.003_730).abs() < 5e-7);
    }

    #[test]
    fn between_chuck_and_tailstock_it_is_worst_beyond_the_middle() {
        let at = |z: f64| bent(Clamping::ChuckAndTailstock { at_mm: 300.0 }, &[], z);
        let worst = (0..3000).map(|k| f64::from(k) * 0.1).max_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
        assert!((worst - 175.5).abs() < 0.3, "{worst}");
        assert!((at(worst) - 0.004_016).abs() < 5e-7, "{}", at(worst));
    }

    #[test]
    fn a_support_holds_where_it_stands() {
        for clamping in [
            Clamping::Chuck,
            Clamping::ChuckAndTailstock { at_mm: 290.0 },
            Clamping::Centres { at_mm: 300.0 },
        ] {
            let [at, before] = [120.0, 60.0].map(|z| bent(clamping, &[120.0], z));
            assert!(at.abs() < NEAR_MM, "{clamping:?}: {at}");
            assert!(before > 0.0 && before < bent(clamping, &[], 60.0));
        }
        // A chuck and a steady rest are a chuck and a tailstock, up to there.
        let steady = bent(Clamping::Chuck, &[200.0], 130.0);
        assert!((steady - bent(Clamping::ChuckAndTailstock { at_mm: 200.0 }, &[], 130.0)).abs() < NEAR_MM);
    }

    #[test]
    fn a_stepped_bar_bends_as_its_parts_do() {
        let stepped = Workpiece {
            diameters_mm: vec![[0.0, 50.0], [100.0, 50.0], [100.0, 30.0], [250.0, 30.0]],
            ..bar(Clamping::Chuck, &[])
        };
        let found = Bending::new(&stepped, Force::Radial { newton: 100.0 }).unwrap().at_mm(250.0);
        let i = |d: f64| std::f64::consts::PI * d * d * d * d / 64.0;
        // ∫ (250 − s)² ds over each part.
        let cube = |v: f64| v * v * v / 3.0;
        let exact = 100.0 / 210_000.0 * ((cube(250.0) - cube(150.0)) / i(50.0) + cube(150.0) / i(30.0));
        assert!((found - exact).abs() < NEAR_MM, "{found} {exact}");
    }

    #[test]
    fn a_tapered_bar_bends_as_its_integral_says() {
        let tapered =
            Workpiece { diameters_mm: vec![[0.0, 40.0], [300.0, 20.0]], ..bar(Clamping::Chuck, &[]) };
        let found = Bending::new(&tapered, Force::Radial { newton: 400.0 }).unwrap().at_mm(300.0);
        // ∫ s² ds / (20 + s/15)⁴ over 0..300 = 300³ / (3·20·40³), with d the end's diameter: L³ / (3 d D³).
        let exact = 400.0 * 64.0 / (210_000.0 * std::f64::consts::PI) * 2.7e7 / (3.0 * 20.0 * 64_000.0);
        assert!((found - exact).abs() < 1e-7 * exact, "{found} {exact}");
    }

    #[test]
    fn bounds_hold() {
        let bending = Bending::new(
            &bar(Clamping::ChuckAndTailstock { at_mm: 250.0 }, &[100.0]),
            Force::Radial { newton: 400.0 },
        )
        .unwrap();
        for (low, high) in [(0.0, 300.0), (20.0, 40.0), (90.0, 110.0), (240.0, 260.0), (-10.0, 20.0)] {
            let bounds = bending.bounds(Range { low, high });
            let step = (high - low) / 1000.0;
            for k in 1..1000 {
                let z = low + step * f64::from(k);
                let (before, at, behind) =
                    (bending.at_mm(z - step), bending.at_mm(z), bending.at_mm(z + step));
                assert!(at.abs() <= bounds.value + 1e-12);
                assert!((behind - before).abs() / (2.0 * step) <= bounds.slope + 1e-12);
                let bow = (behind - 2.0 * at + before).abs() / (step * step);
                assert!(bow <= bounds.curvature + bounds.kinks / step + 1e-9, "{z}: {bow} {bounds:?}");
            }
        }
    }

    #[test]
    fn what_cannot_be_held_is_refused() {
        let force = Force::Radial { newton: 1.0 };
        let error = |bar: &Workpiece| Bending::new(bar, force).unwrap_err();
        assert_eq!(
            error(&bar(Clamping::Centres { at_mm: 301.0 }, &[])),
            WorkpieceError::BeyondTheBar { what: "tailstock", at_mm: 301.0, length_mm: 300.0 }
        );
        assert_eq!(
            error(&bar(Clamping::Chuck, &[-1.0])),
            WorkpieceError::BeyondTheBar { what: "steady rest", at_mm: -1.0, length_mm: 300.0 }
        );
        assert_eq!(
            error(&bar(Clamping::ChuckAndTailstock { at_mm: 200.0 }, &[200.0])),
            WorkpieceError::Twice { at_mm: 200.0 }
        );
        assert_eq!(
            error(&Workpiece { diameters_mm: Vec::new(), ..bar(Clamping::Chuck, &[]) }),
            WorkpieceError::NoLength
        );
        for (place, rows) in [
            (1, vec![[0.0, 40.0], [10.0, 0.0]]),
            (0, vec![[5.0, 40.0], [10.0, 40.0]]),
            (2, vec![[0.0, 4.0], [9.0, 4.0], [8.0, 4.0], [9.0, 4.0]]),
        ] {
            let thin = Workpiece { diameters_mm: rows, ..bar(Clamping::Chuck, &[]) };
            assert_eq!(error(&thin), WorkpieceError::Diameter(place));
        }
        let soft = Workpiece { youngs_modulus_n_mm2: f64::NAN, ..bar(Clamping::Chuck, &[]) };
        assert!(matches!(error(&soft), WorkpieceError::Modulus(_)));
    }
}
