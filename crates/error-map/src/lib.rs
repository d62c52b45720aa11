//! Volumetric error maps: what a machine does wrong over its volume, and where to put the zero point.
//!
//! The *volumetric error* `d(q)` is the real minus the nominal position of the tool tip at the axis
//! command `q`, mm, in the directions of the linear axes. A [`Grid`] says where it is asked for, an
//! [`ErrorMap`] holds the answers, a [`Block`] names a part of it: a plane, a region, all. [`Statistics`]
//! are the figures of ISO 230-1, [`diagonals`] those of ISO 230-6, [`zero_point`] finds the shift of the
//! origin that leaves least, [`placement`] the place for a workpiece.
//!
//! No text, no files, no threads.

pub mod diagonals;
mod grid;
mod map;
pub mod placement;
mod statistics;
pub mod zero_point;

pub use grid::{Block, Grid, GridError, Nodes, Plane};
pub use map::ErrorMap;
pub use statistics::Statistics;
