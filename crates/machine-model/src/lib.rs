//! The machine as it is: where the tool really goes for a command, and what to command instead.
//!
//! Millimetres and radians throughout; `docs/equations.md` numbers the equations and names sources.
//! No text, no files, no clock.

mod aside;
mod axis_tables;
mod chain;
mod chord_bound;
mod command;
mod component;
mod description;
pub mod effects;
mod engine;
pub mod engines;
mod everywhere;
pub mod finite_rotations;
mod first_order;
mod from_datum;
mod lanes;
mod length;
mod link;
mod newton;
mod orientation;
mod play;
mod real;
mod rigid_body;
mod rotary;
pub mod rotation;
mod russian;
mod solve;
mod standing;
mod table;
mod tip_control;
mod traverse;
mod turning_bound;
mod with_effects;

pub use aside::Aside;
pub use axis_tables::{AxisTables, SixBounds};
pub use chain::{Axis, Chain, ChainError};
pub use command::{Command, Matrix, Move, Placement, Range, RotaryPlay, Turn, Vector, Volume, Way};
pub use component::{Component, Six};
pub use description::{Description, LinearAxis, RotaryAxis, Squareness, Tilt};
pub use engine::{Engine, EngineId, LANES, Models, PathModel, Solution, SolveError};
pub use everywhere::Everywhere;
pub use first_order::first_order_error_mm;
pub use from_datum::{FromDatum, counted_from_datum};
pub use orientation::{Aim, Held, Singularity, aim, singular_sin};
pub use play::{Play, SAME_PLACE_MM, SAME_PLACE_RAD, turned_by_mm};
pub use rigid_body::{Prediction, RigidBody, Unusable};
pub use solve::{TOLERANCE_MM, solve};
pub use table::{Bounds, Interpolation, Table, TableError};
pub use tip_control::TipControl;
pub use traverse::Traverse;
pub use with_effects::{UnknownCondition, WithEffects};
