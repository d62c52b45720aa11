//! The machine as it is: where the tool really goes for a command, and what to command instead.
//!
//! Millimetres and radians throughout; `docs/equations.md` numbers the equations and names sources.
//! No text, no files, no clock.

mod engine;
mod table;

pub use engine::{Command, Engine, EngineId, Move, PathModel, Range, Solution, SolveError, Vector, Volume};
pub use table::{Bounds, Interpolation, Table, TableError};
