//! Measurements to machine profiles: what an instrument read becomes error functions with their uncertainty.
//!
//! Millimetres and radians throughout, as in [`machine_model`]; no files, no text formats, no clock. Every result
//! carries a standard uncertainty, and every method says what it cannot see. Equations (30) to (40), (47) to (51), (71) to (73), (79), (80) and
//! (100) to (104) of `docs/equations.md`.

pub mod adjustment;
mod ballbar;
pub mod change;
mod changed;
pub mod circular_test;
mod error;
mod field;
pub mod functions;
mod geometry;
pub mod iso230_2;
mod known_places;
mod layout;
pub mod linear_ballbar;
mod machine_change;
pub mod measured_line;
mod mistakes;
mod points;
pub mod rigid_motion;
pub mod rotary_ballbar;
pub mod rotary_sequence;
pub mod rtest;
mod student;
pub mod tracker;
mod traverse;
pub mod turning;
pub mod volumetric;

pub use error::CalibrationError;
pub use points::{Base, ChangedAxis, Point, PointReading, SetUp};
pub use student::{quantile, quantile_95};
pub use traverse::{MeanTraverse, Node, Noise, Reading};
