//! `field`: error vectors measured anywhere in the volume, whatever makes them; equations (90) to (94) of `docs/equations.md`.
//!
//! A field knows where the tip of *one* tool goes, and nothing of bodies and axes. Its Jacobian is that of the map from
//! commands to tips: stretch, shear and rotation of a small box of *commands*. What turns with the tool is not in it: of
//! axis i, `∂e/∂q_i` holds the rotations of the axes before it in the chain, never its own or those of the axes behind, so
//! that the tip of another tool cannot be told from it.

mod dense;
mod modes;
mod smooth;
mod spline;
mod support;
mod variances;

use nalgebra::Matrix3;

use crate::engine::inside;
use crate::{Command, Engine, EngineId, Move, PathModel, Solution, SolveError, Vector, Volume};
use spline::{Basis, TensorSpline};
use support::Support;

/// Places are one where no coordinate differs by more, mm: below every machine's resolution.
const SAME_PLACE_MM: f64 = 1e-6;
/// Tools are one where no component differs by more, mm: 0.1 µm where the tool leans by 100 µrad over it is 1 nm.
const SAME_TOOL_MM: f64 = 1e-3;
/// Repeated readings differ by so many standard uncertainties once in a million times.
const REPEATED: f64 = 5.0;
/// What a fit with eight ways to be straight needs at least, so that as many are left to judge the noise by.
const LEAST_VECTORS: usize = 16;
/// Places whose spread in one direction is less than this part of that in another lie in a plane.
const FLAT: f64 = 1e-3;
/// How far beyond the volume the box of a stretch may reach by rounding, mm.
const ROUNDING_MM: f64 = 1e-9;

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

/// What the residuals say of the stated noise, where that is something else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Doubt {
    /// Standard uncertainty of a component as stated, mm (RMS).
    pub stated_mm: f64,
    /// What the residuals scatter by, as much of it as the fit leaves, mm.
    pub scatter_mm: f64,
}

/// Why vectors make no field. Numbers of vectors count from 0 in the order in which they were given.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// Fewer than the fit can carry.
    #[error("{found} places with error vectors; a field with a stated noise needs at least {needed}")]
    TooFew {
        /// Places found.
        found: usize,
        /// Places needed.
        needed: usize,
    },
    /// They span no volume.
    #[error("all error vectors were measured in one {shape}: they say nothing of the volume around it")]
    Flat {
        /// `place`, `line` or `plane`.
        shape: &'static str,
    },
    /// One place, two vectors, and the noise is too small to make that of one.
    #[error(
        "two vectors of one place differ by {:.2} um in {}, {}",
        apart_mm * 1e3,
        ['X', 'Y', 'Z'][*component],
        if *allowed_mm > 0.0 { format!("more than their uncertainty explains ({:.2} um)", allowed_mm * 1e3) }
        else { "and the noise is stated as 0".to_owned() }
    )]
    Repeated {
        /// The earlier vector.
        first: usize,
        /// The later one.
        second: usize,
        /// 0 X, 1 Y, 2 Z.
        component: usize,
        /// By how much they differ, mm.
        apart_mm: f64,
        /// What would pass, mm.
        allowed_mm: f64,
    },
    /// A lattice that lacks nodes, its vectors to be met exactly.
    #[error(
        "the lattice of {} x {} x {} nodes lacks {missing}, the first at X {} Y {} Z {}",
        counts[0], counts[1], counts[2], place_mm.x, place_mm.y, place_mm.z
    )]
    Hole {
        /// Nodes of X, Y, Z.
        counts: [usize; 3],
        /// How many it lacks.
        missing: usize,
        /// The first of them, mm.
        place_mm: Vector,
    },
    /// Scattered vectors that are to be met exactly.
    #[error("the noise is stated as 0, and the {places} places are no complete lattice")]
    Scattered {
        /// How many.
        places: usize,
    },
    /// Some vectors are exact and some are not.
    #[error("an uncertainty of 0 beside others above 0")]
    Exact {
        /// The exact one.
        vector: usize,
    },
    /// The residuals are not those of the stated noise.
    #[error(
        "the vectors scatter by about {:.3} um around the field that fits them best, and a noise of {:.3} um is stated",
        .0.scatter_mm * 1e3, .0.stated_mm * 1e3
    )]
    Noise(Doubt),
    /// A run lies beside the others.
    #[error(
        "the run of this vector lies {:.2} {:.2} {:.2} um beside the others: it has a set-up, or a direction, of its own",
        offset_mm.x * 1e3, offset_mm.y * 1e3, offset_mm.z * 1e3
    )]
    Offset {
        /// The first vector of the run.
        vector: usize,
        /// By how much, mm.
        offset_mm: Vector,
    },
    /// The equations have no answer.
    #[error("the places of the vectors do not determine a field")]
    NotDetermined,
}

/// What a field was made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Made {
    /// A complete lattice of so many nodes, met exactly: linear in each coordinate between them.
    Lattice([usize; 3]),
    /// A smooth field through so many vectors.
    Smooth {
        /// Vectors.
        vectors: usize,
        /// Nodes that a lattice lacks, where the places look like one.
        missing: usize,
        /// Squared residuals over what the stated noise says.
        residuals: f64,
    },
}

/// Error vectors as a model of the machine.
///
/// ```
/// use machine_model::engines::{ErrorVector, Field};
/// use machine_model::{Command, Engine, PathModel, Vector};
///
/// // Eight corners; X runs 0.1 µm a millimetre too far.
/// let vectors: Vec<ErrorVector> = (0..8)
///     .map(|k| {
///         let place_mm = Vector::from_fn(|a, _| f64::from(k >> a & 1) * 100.0);
///         let error_mm = Vector::new(1e-4 * place_mm.x, 0.0, 0.0);
///         ErrorVector { place_mm, error_mm, uncertainty_mm: Vector::zeros(), run: 0 }
///     })
///     .collect();
/// let field = Field::new(&vectors, Vector::zeros()).unwrap();
/// let at = |x: f64| Command {
///     linear_mm: Vector::new(x, 30.0, 70.0),
///     rotary_rad: Vector::zeros(),
///     tool_mm: Vector::zeros(),
///     direction: [0; 3],
///     ..Default::default()
/// };
/// assert!((field.error_mm(&at(50.0)).x - 0.005).abs() < 1e-12);
/// assert!((field.jacobian(&at(50.0)).unwrap()[(0, 0)] - 1e-4).abs() < 1e-12);
/// assert!(field.solve(&at(120.0)).is_err());
/// ```
#[derive(Clone, Debug)]
pub struct Field {
    spline: TensorSpline,
    support: Support,
    tool_mm: Vector,
    made: Made,
    doubt: Option<Doubt>,
    blind_mm: Option<f64>,
}

impl Field {
    /// Interpolates a complete lattice of exact vectors, and fits all others.
    ///
    /// * `tool_mm` – tool vector with which all of them were measured
    ///
    /// # Errors
    /// [`FieldError`] says which vectors make none, and why.
    pub fn new(vectors: &[ErrorVector], tool_mm: Vector) -> Result<Self, FieldError> {
        let exact = |vector: &ErrorVector| vector.uncertainty_mm.min() <= 0.0;
        let all_exact = vectors.iter().all(exact);
        if let Some(vector) = vectors.iter().position(exact).filter(|_| !all_exact) {
            return Err(FieldError::Exact { vector });
        }
        let places = Places::new(vectors);
        places.agree(vectors)?;
        places.span(vectors)?;
        if all_exact {
            let spline = places.lattice(vectors)?;
            let support = Support::of_box(spline.ranges());
            return Ok(Self {
                spline,
                support,
                tool_mm,
                made: Made::Lattice(places.counts()),
                doubt: None,
                blind_mm: None,
            });
        }
        let found = places.groups.len();
        if found < LEAST_VECTORS {
            return Err(FieldError::TooFew { found, needed: LEAST_VECTORS });
        }
        let support = Support::around(&vectors.iter().map(|vector| vector.place_mm).collect::<Vec<_>>());
        let smooth = smooth::smooth(vectors, support.volume.0)?;
        let missing = places.missing().map_or(0, |(missing, _)| missing);
        let made = Made::Smooth { vectors: vectors.len(), missing, residuals: smooth.residuals };
        Ok(Self {
            spline: smooth.spline,
            support,
            tool_mm,
            made,
            doubt: smooth.doubt,
            blind_mm: smooth.blind_mm,
        })
    }

    /// What it was made of.
    #[must_use]
    pub fn made(&self) -> Made {
        self.made
    }

    /// What the residuals say against the stated noise.
    #[must_use]
    pub fn doubt(&self) -> Option<Doubt> {
        self.doubt
    }

    /// The largest offset between runs that would pass for the machine, mm, where that is far above the noise: runs that
    /// have hardly a place in common.
    #[must_use]
    pub fn blind_to_mm(&self) -> Option<f64> {
        self.blind_mm
    }

    /// The tool vector with which it was measured, mm.
    #[must_use]
    pub fn tool_mm(&self) -> Vector {
        self.tool_mm
    }

    /// True where corners of the box that holds the vectors are too far from any.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.support.is_cut()
    }

    /// True where commands lie among the vectors.
    #[must_use]
    pub fn supports(&self, linear_mm: &Vector) -> bool {
        self.support.contains(linear_mm)
    }

    /// `∂e_c/∂q_a` in row c and column a, mm per mm; outside, that of the nearest place.
    #[must_use]
    pub fn gradient(&self, linear_mm: &Vector) -> Matrix3<f64> {
        self.spline.jacobian(&self.support.nearest(linear_mm))
    }

    fn at(&self, linear_mm: &Vector) -> Vector {
        self.spline.value(&self.support.nearest(linear_mm))
    }

    fn supported(&self, q: &Vector) -> Result<(), SolveError> {
        inside(q, &self.support.volume)?;
        if self.support.contains(q) {
            Ok(())
        } else {
            Err(SolveError::OutsideVectors { place_mm: (*q).into() })
        }
    }
}

impl Engine for Field {
    fn id(&self) -> EngineId {
        EngineId::Field
    }

    fn volume(&self) -> Volume {
        self.support.volume
    }

    fn knows(&self, command: &Command) -> Result<(), SolveError> {
        if (command.tool_mm - self.tool_mm).amax() > SAME_TOOL_MM {
            return Err(SolveError::OtherTool {
                found_mm: command.tool_mm.into(),
                measured_mm: self.tool_mm.into(),
            });
        }
        self.supported(&command.linear_mm)
    }

    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        self.knows(target)?;
        let solution = crate::solve(&target.linear_mm, &self.support.volume, |q| self.at(q))?;
        self.supported(&solution.linear_mm)?;
        Ok(solution)
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for Field {
    fn error_mm(&self, command: &Command) -> Vector {
        self.at(&command.linear_mm)
    }

    /// Inside, that of the splines; where the stretch may leave the volume the error is that of the nearest place, which
    /// moves no faster than the command: `gradient·|q'|/2`, equation (91).
    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        if self.support.holds(&stretch.range_mm, ROUNDING_MM) {
            return self.spline.chord_bound_mm(stretch);
        }
        let speed = Vector::from(stretch.speed_mm);
        // Nearest in the coordinates of a cube: along the longest axis of the box it may move by what the shortest does.
        let lengths = self.support.volume.0.map(|range| range.high - range.low);
        let stretched = if self.support.is_cut() {
            lengths.iter().copied().fold(0.0, f64::max)
                / lengths.iter().copied().fold(f64::INFINITY, f64::min)
        } else {
            1.0
        };
        0.5 * self.spline.gradient() * stretched * speed.norm()
    }

    fn jacobian(&self, command: &Command) -> Option<Matrix3<f64>> {
        Some(self.gradient(&command.linear_mm))
    }
}

fn same_place(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME_PLACE_MM
}

/// The places of vectors as a lattice.
struct Places {
    /// Distinct coordinates of each axis, increasing.
    nodes: [Vec<f64>; 3],
    /// Number in the lattice (X fastest) and number of the vector, by the former.
    groups: Vec<(usize, Vec<usize>)>,
}

impl Places {
    fn new(vectors: &[ErrorVector]) -> Self {
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

    fn counts(&self) -> [usize; 3] {
        self.nodes.each_ref().map(Vec::len)
    }

    fn place_mm(&self, number: usize) -> Vector {
        let [x, y, _] = self.counts();
        Vector::new(self.nodes[0][number % x], self.nodes[1][number / x % y], self.nodes[2][number / x / y])
    }

    /// Vectors of one place say the same, as far as their uncertainty goes.
    fn agree(&self, vectors: &[ErrorVector]) -> Result<(), FieldError> {
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
    fn span(&self, vectors: &[ErrorVector]) -> Result<(), FieldError> {
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
    fn missing(&self) -> Option<(usize, Vector)> {
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
    fn lattice(&self, vectors: &[ErrorVector]) -> Result<TensorSpline, FieldError> {
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

#[cfg(test)]
mod tests;
