//! Units, deterministic mathematics, integer decimals.
//!
//! The ground floor: every other crate may stand on it, it stands on `libm` alone.
//!
//! * [`Length`] and [`Angle`] carry their unit in the type; inside algebra plain `f64` with a
//!   unit suffix in the name (`_mm`, `_rad`) is used.
//! * [`math`] holds the transcendental functions: the same bits on every platform.
//! * [`decimal`] reads and writes decimal numbers as integers of a step, so that `-0.000` and `1e-7`
//!   cannot appear and nothing is rounded twice.

pub mod decimal;
pub mod math;
mod quantity;

pub use quantity::{Angle, Length};
