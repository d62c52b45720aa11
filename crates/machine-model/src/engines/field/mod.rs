//! `field`: error vectors measured anywhere in the volume, whatever makes them; equations (90) to (94) of `docs/equations.md`.
//!
//! A field knows where the tip of *one* tool goes, and nothing of bodies and axes. Its Jacobian is that of the map from
//! commands to tips: stretch, shear and rotation of a small box of *commands*. What turns with the tool is not in it: of
//! axis i, `∂e/∂q_i` holds the rotations of the axes before it in the chain, never its own or those of the axes behind, so
//! that the tip of another tool cannot be told from it.

mod dense;
mod error;
mod modes;
mod places;
mod smooth;
mod spline;
mod support;
mod variances;

use nalgebra::Matrix3;

use crate::engine::inside;
use crate::{Command, Engine, EngineId, Move, PathModel, Solution, SolveError, Vector, Volume};
pub use error::{Doubt, FieldError};
pub use places::ErrorVector;
use places::Places;
use spline::TensorSpline;
use support::Support;

/// Tools are one where no component differs by more, mm: 0.1 µm where the tool leans by 100 µrad over it is 1 nm.
const SAME_TOOL_MM: f64 = 1e-3;
/// What a fit with eight ways to be straight needs at least, so that as many are left to judge the noise by.
const LEAST_VECTORS: usize = 16;
/// How far beyond the volume the box of a stretch may reach by rounding, mm.
const ROUNDING_MM: f64 = 1e-9;

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

#[cfg(test)]
mod tests;
