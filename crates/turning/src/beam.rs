//! A bar as a beam on its supports.

use crate::workpiece::{Clamping, Workpiece, WorkpieceError};
use nalgebra::{DMatrix, DVector};

/// A bar without its inner supports, and where those are.
pub(crate) struct Beam<'a> {
    pub(crate) bar: &'a Workpiece,
    /// Supports beyond those of the statically determinate bar.
    pub(crate) supports_mm: Vec<f64>,
    /// Where a load may stand: 0 to here.
    pub(crate) reach_mm: f64,
    pub(crate) supports: DMatrix<f64>,
}

impl<'a> Beam<'a> {
    pub(crate) fn new(bar: &'a Workpiece) -> Result<Self, WorkpieceError> {
        let rows = &bar.diameters_mm;
        let length_mm = rows.last().map_or(0.0, |[z, _]| *z);
        if length_mm <= 0.0 {
            return Err(WorkpieceError::NoLength);
        }
        for (place, [z, d]) in rows.iter().enumerate() {
            let rises = place.checked_sub(1).map_or(*z == 0.0, |before| *z >= rows[before][0]);
            if !(rises && z.is_finite() && *d > 0.0 && d.is_finite()) {
                return Err(WorkpieceError::Diameter(place));
            }
        }
        if !(bar.youngs_modulus_n_mm2 > 0.0 && bar.youngs_modulus_n_mm2.is_finite()) {
            return Err(WorkpieceError::Modulus(bar.youngs_modulus_n_mm2));
        }
        let on_bar = |what: &'static str, at_mm: f64| match at_mm > 0.0 && at_mm <= length_mm {
            true => Ok(()),
            false => Err(WorkpieceError::BeyondTheBar { what, at_mm, length_mm }),
        };
        let mut supports_mm = bar.steady_rests_mm.clone();
        let mut reach_mm = length_mm;
        match bar.clamping {
            Clamping::Chuck => {}
            Clamping::ChuckAndTailstock { at_mm } => {
                on_bar("tailstock", at_mm)?;
                supports_mm.push(at_mm);
            }
            Clamping::Centres { at_mm } => {
                on_bar("tailstock", at_mm)?;
                reach_mm = at_mm;
            }
        }
        for at_mm in &bar.steady_rests_mm {
            on_bar("steady rest", *at_mm)?;
            let twice = supports_mm.iter().filter(|other| *other == at_mm).count() > 1;
            if twice || matches!(bar.clamping, Clamping::Centres { at_mm: end } if *at_mm >= end) {
                return Err(WorkpieceError::Twice { at_mm: *at_mm });
            }
        }
        let mut beam = Self { bar, supports_mm, reach_mm, supports: DMatrix::zeros(0, 0) };
        let n = beam.supports_mm.len();
        beam.supports =
            DMatrix::from_fn(n, n, |i, j| beam.influence_mm_n(beam.supports_mm[i], beam.supports_mm[j]));
        Ok(beam)
    }

    /// Deflection at the load per newton, all supports in place, mm/N.
    pub(crate) fn flexibility_mm_n(&self, at_mm: f64) -> f64 {
        let own = self.influence_mm_n(at_mm, at_mm);
        if self.supports_mm.is_empty() {
            return own;
        }
        let there = DVector::from_iterator(
            self.supports_mm.len(),
            self.supports_mm.iter().map(|support| self.influence_mm_n(at_mm, *support)),
        );
        // Distinct supports of a bar are independent: the matrix is positive definite.
        let reactions = self.supports.clone().lu().solve(&there);
        reactions.map_or(own, |reactions| own - there.dot(&reactions))
    }

    /// Deflection at `b` by a newton at `a` without the inner supports, mm/N.
    pub(crate) fn influence_mm_n(&self, a: f64, b: f64) -> f64 {
        let moment = |load: f64, s: f64| match self.bar.clamping {
            Clamping::Centres { at_mm } if s <= load => s * (at_mm - load) / at_mm,
            Clamping::Centres { at_mm } => load * (at_mm - s) / at_mm,
            _ => (load - s).max(0.0),
        };
        let mut sum = 0.0;
        for rows in self.bar.diameters_mm.windows(2) {
            let ([begin, first], [full, last]) = (rows[0], rows[1]);
            let end = full.min(self.reach_mm).max(begin);
            let mut cuts = [begin, a.clamp(begin, end), b.clamp(begin, end), end];
            cuts.sort_by(f64::total_cmp);
            for stretch in cuts.windows(2).filter(|stretch| stretch[1] > stretch[0]) {
                let (middle, half) = (0.5 * (stretch[0] + stretch[1]), 0.5 * (stretch[1] - stretch[0]));
                let at = |u: f64| {
                    let s = middle + half * u;
                    let d2 = (first + (last - first) * (s - begin) / (full - begin)).powi(2);
                    moment(a, s) * moment(b, s) / (d2 * d2)
                };
                sum += half * GAUSS.iter().map(|[u, weight]| weight * (at(*u) + at(-u))).sum::<f64>();
            }
        }
        sum * 64.0 / (self.bar.youngs_modulus_n_mm2 * std::f64::consts::PI)
    }
}

/// Half the nodes and weights of Gauss and Legendre's rule of eight points: exact for a bar of even diameter, where the
/// integrand is quadratic, and to 1e-9 for one that doubles over a stretch.
pub(crate) const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];
