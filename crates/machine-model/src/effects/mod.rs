//! Effects beyond the error tables: each a term of the forward model and a candidate cause of a gap.
//!
//! The catalogue is [`EffectKind`]; a form with its non-linear numbers is a [`Shape`]; an entry of a profile
//! is an [`EffectTerm`]. Every effect is linear in its coefficients, whose names carry their unit:
//! displacements are summed from [`EffectKind::unit_displacement_mm`], by the prediction and by the
//! diagnosis alike, so a cause that was named is the cause that is corrected.

mod basis;
mod bound;
mod chain;
mod kind;
mod spec;
mod term;

pub use basis::{Conditions, MissingCondition, Shape, legendre};
pub use chain::{EffectGeometry, Joint};
pub use kind::{AxisIndex, EffectKind, TRACKER, UnknownEffect};
pub use term::{EffectError, EffectTerm};
