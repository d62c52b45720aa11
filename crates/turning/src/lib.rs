//! Lathes as they are: which radius a command turns, and what else the workpiece bears.
//!
//! The chain workpiece – spindle – carriage – tool after Spirin 2012, of proper rotations only. Millimetres and radians;
//! `docs/equations.md` numbers the equations. No text, no files, no clock.

mod beam;
mod bending;
mod lathe;
mod roughness;
mod section;
mod spindle;
mod workpiece;

pub use bending::Bending;
pub use lathe::{Lathe, Station, Tip};
pub use roughness::{Roughness, roughness};
pub use section::{Circle, Cylinder, Section, Wave};
pub use spindle::{ErrorMotion, Harmonic, Spindle, Tailstock};
pub use workpiece::{Clamping, Force, Workpiece, WorkpieceError};
