//! The places of error vectors: which are one, what shape they have, and the lattice that they may be.

use nalgebra::Matrix3;

use super::error::FieldError;
use super::spline::{Basis, TensorSpline};
use crate::Vector;

/// Places are one where no coordinate differs by more, mm: below every machine's resolution.
const SAME_PLACE_MM: f64 = 1e-6;
/// Repeated readings differ by so many standard uncertainties once in a million times.
const REPEATED: f64 = 5.0;
/// Places whose spread in one direction is less than this part of that in another lie in a plane.
const FLAT: f64 = 1e-3;

/// A measured error vector.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorVector {
    /// Commands of X, Y, Z, mm.
    pub place_mm: Vector,
    /// Measured minus commanded tip, mm.
    pub error_mm: Vector,
    /// Standard uncertainty of each component, mm; zero: it is met exactly.
    pub uncertainty_mm: Vector,
    /// Number of the run that it belongs to.
    pub run: usize,
}

/// Coordinates of one place.
pub(super) fn same_place(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME_PLACE_MM
}

/// The places of vectors as a lattice.
pub(super) struct Places {
    /// Distinct coordinates of each axis, increasing.
    nodes: [Vec<f64>; 3],
    /// Number in the lattice (X fastest) and number of the vector, by the former.
    pub(super) groups: Vec<(usize, Vec<usize>)>,
}

impl Places {
    pub(super) fn new(vectors: &[ErrorVector]) -> Self {
        let nodes = [0, 1, 2].map(|a| {
            let mut all: Vec<f64> = vectors.iter().map(|vector| vector.place_mm[a]).collect();
            all.sort_by(f64::total_cmp);
            all.dedup_by(|b, a| same_place(*a, *b));
            all
        });
        let index = |a: usize, q: f64| nodes[a].partition_point(|node| *node < q - SAME_PLACE_MM);
        let number = |vector: &ErrorVector| {
            let [i, j, k] = [0, 1, 2].map(|a| index(a, vector.place_mm[a]));
            i + nodes[0].len() * (j + nodes[1].len() * k)
        };
        let mut all: Vec<(usize, usize)> =
            vectors.iter().enumerate().map(|(v, one)| (number(one), v)).collect();
        all.sort_unstable();
        let groups = all
            .chunk_by(|a, b| a.0 == b.0)
            .map(|group| (group[0].0, group.iter().map(|(_, vector)| *vector).collect()));
        Self { groups: groups.collect(), nodes }
    }

    pub(super) fn counts(&self) -> [usize; 3] {
        self.nodes.each_ref().map(Vec::len)
    }

    fn place_mm(&self, number: usize) -> Vector {
        let [x, y, _] = self.counts();
        Vector::new(self.nodes[0][number % x], self.nodes[1][number / x % y], self.nodes[2][number / x / y])
    }

    /// Vectors of one place say the same, as far as their uncertainty goes.
    pub(super) fn agree(&self, vectors: &[ErrorVector]) -> Result<(), FieldError> {
        for (_, group) in &self.groups {
            for (at, &second) in group.iter().enumerate().skip(1) {
                for &first in &group[..at] {
                    let (a, b) = (&vectors[first], &vectors[second]);
                    let apart = (a.error_mm - b.error_mm).abs();
                    let component = apart.imax();
                    for c in [component, 0, 1, 2] {
                        let u = units::math::hypot(a.uncertainty_mm[c], b.uncertainty_mm[c]);
                        let (apart_mm, allowed_mm) = (apart[c], REPEATED * u);
                        if apart_mm > allowed_mm {
                            return Err(FieldError::Repeated {
                                first,
                                second,
                                component: c,
                                apart_mm,
                                allowed_mm,
                            });
                        }
                    }
                }
            }
        }
        Ok(())
    }

    /// They span three dimensions.
    pub(super) fn span(&self, vectors: &[ErrorVector]) -> Result<(), FieldError> {
        let n = vectors.len() as f64;
        let mean = vectors.iter().map(|vector| vector.place_mm).sum::<Vector>() / n;
        let mut spread = Matrix3::zeros();
        for vector in vectors {
            let from = vector.place_mm - mean;
            spread += from * from.transpose();
        }
        let mut sizes: [f64; 3] = spread.symmetric_eigenvalues().map(|v| v.max(0.0).sqrt()).into();
        sizes.sort_by(f64::total_cmp);
        let shape = match sizes {
            [_, _, longest] if longest <= SAME_PLACE_MM => "place",
            [_, middle, longest] if middle <= FLAT * longest => "line",
            [thinnest, _, longest] if thinnest <= FLAT * longest => "plane",
            _ => return Ok(()),
        };
        Err(FieldError::Flat { shape })
    }

    /// How many nodes a lattice lacks and the first of them, where most are there.
    pub(super) fn missing(&self) -> Option<(usize, Vector)> {
        let all = self.counts().iter().try_fold(1_usize, |product, count| product.checked_mul(*count))?;
        let found = self.groups.len();
        if found == all || all > 2 * found {
            return None;
        }
        let first =
            self.groups.iter().enumerate().find(|(at, (number, _))| at != number).map_or(found, |(at, _)| at);
        Some((all - found, self.place_mm(first)))
    }

    /// Linear in each coordinate between the nodes of a complete lattice, equation (90).
    pub(super) fn lattice(&self, vectors: &[ErrorVector]) -> Result<TensorSpline, FieldError> {
        let counts = self.counts();
        if let Some((missing, place_mm)) = self.missing() {
            return Err(FieldError::Hole { counts, missing, place_mm });
        }
        let places = self.groups.len();
        if counts.iter().try_fold(1_usize, |product, count| product.checked_mul(*count)) != Some(places) {
            return Err(FieldError::Scattered { places });
        }
        let values = self.groups.iter().map(|(_, group)| vectors[group[0]].error_mm).collect();
        Ok(TensorSpline::new(self.nodes.each_ref().map(|nodes| Basis::through(nodes)), values))
    }
}
