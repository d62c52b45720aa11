//! The engines: ways to know where the machine goes, behind one trait, one file each.
//!
//! A new engine is a file that implements [`Engine`], a name in `engine_id.rs` and an arm of [`build`].

mod build_error;
mod engine_id;
mod field;
mod kmtpp;
mod kmtpp_bound;
mod parametric;
pub mod published;
mod separable;
mod tangential;
mod tangential_interval;
mod tracker;
mod traverses;

pub use build_error::BuildError;
pub use field::{Doubt, ErrorVector, Field, FieldError, Made};
pub use kmtpp::{Kmtpp, PathDependence};
pub use parametric::ParametricTable;
pub use tangential::{PUBLISHED_INTERVAL, Tangential};
pub use tangential_interval::TangentialInterval;
pub use tracker::Tracker;

use crate::{Engine, EngineId, Interpolation, Traverse};
use published::{KmtppPublished, Method, TangentialPublished};
use traverses::Traverses;

/// What a machine profile offers to the engines.
#[derive(Default)]
pub struct EngineInputs {
    /// The rigid-body model, with everything that is known of the machine.
    pub rigid: Option<Box<dyn Engine>>,
    /// The traverses of `[tracker]`, X, Y, Z.
    pub traverses: Option<[Traverse; 3]>,
    /// How the tracker engine runs between the nodes of its traverses.
    pub traverse_interpolation: Interpolation,
    /// The rows of the interferometer tables of X, Y, Z.
    pub tables: Option<[ParametricTable; 3]>,
    /// The measured error vectors of `[field]`.
    pub field: Option<Field>,
}

/// Builds an engine from what the profile offers.
///
/// # Errors
/// [`BuildError`] names what the profile lacks and what to add.
pub fn build(id: EngineId, inputs: EngineInputs) -> Result<Box<dyn Engine>, BuildError> {
    let lacks = |what, add| BuildError::Missing { engine: id.name(), what, add };
    let traverses = || lacks("three axis traverses of a laser tracker", "[tracker] with x, y and z");
    let tables = || lacks("the error tables of X, Y and Z", "[axis.X], [axis.Y] and [axis.Z] with errors");
    Ok(match id {
        EngineId::RigidBody => {
            return inputs
                .rigid
                .ok_or_else(|| lacks("a kinematic chain", "`chain` and [axis.X], [axis.Y], [axis.Z]"));
        }
        EngineId::Tracker => {
            let interpolation = inputs.traverse_interpolation;
            Box::new(Tracker::new(&inputs.traverses.ok_or_else(traverses)?, interpolation)?)
        }
        EngineId::TangentialStatic => {
            Box::new(Tangential::fixed(&inputs.traverses.ok_or_else(traverses)?, PUBLISHED_INTERVAL)?)
        }
        EngineId::TangentialInterval => {
            Box::new(TangentialInterval::new(&inputs.traverses.ok_or_else(traverses)?)?)
        }
        EngineId::TangentialQuasiDifferential => Box::new(Tangential::quasi_differential(
            &inputs.traverses.ok_or_else(traverses)?,
            PUBLISHED_INTERVAL,
        )?),
        EngineId::Kmtpp => {
            let given = Traverses::new(&inputs.traverses.ok_or_else(traverses)?)?;
            Box::new(kmtpp(&inputs.tables.ok_or_else(tables)?, &given)?)
        }
        EngineId::Field => {
            let vectors = || lacks("error vectors measured in the volume", "[field] with file and noise_um");
            Box::new(inputs.field.ok_or_else(vectors)?)
        }
        EngineId::TangentialStaticPublished => {
            published(&inputs.traverses.ok_or_else(traverses)?, Method::Static)?
        }
        EngineId::TangentialIntervalPublished => {
            published(&inputs.traverses.ok_or_else(traverses)?, Method::Interval)?
        }
        EngineId::TangentialQuasiDifferentialPublished => {
            published(&inputs.traverses.ok_or_else(traverses)?, Method::QuasiDifferential)?
        }
        EngineId::KmtppPublished => Box::new(KmtppPublished::new(
            inputs.tables.ok_or_else(tables)?,
            &inputs.traverses.ok_or_else(traverses)?,
            KmtppPublished::GAIN,
            KmtppPublished::TIME_STEP,
        )?),
    })
}

fn published(traverses: &[Traverse; 3], method: Method) -> Result<Box<dyn Engine>, BuildError> {
    Ok(Box::new(TangentialPublished::new(traverses, method)?))
}

/// The consistent KMTPP from interferometer rows and the directions of the traverses.
fn kmtpp(tables: &[ParametricTable; 3], traverses: &Traverses) -> Result<Kmtpp, BuildError> {
    Kmtpp::new(
        [0, 1, 2].map(|i| [3, 4, 5].map(|which| tables[i].linear_table(which))),
        [0, 1, 2].map(|i| tables[i].linear_table(i)),
        traverses.directions([PUBLISHED_INTERVAL; 3]),
        traverses.offset_mm(PUBLISHED_INTERVAL),
        traverses.origin_mm,
    )
    .ok_or(BuildError::Singular)
}

impl Kmtpp {
    /// From the rows of the interferometer tables and the tracker traverses of X, Y, Z.
    ///
    /// # Errors
    /// [`BuildError`] where the traverses do not belong together.
    pub fn from_measurements(
        tables: &[ParametricTable; 3],
        traverses: &[Traverse; 3],
    ) -> Result<Self, BuildError> {
        kmtpp(tables, &Traverses::new(traverses)?)
    }
}
