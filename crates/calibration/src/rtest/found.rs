//! What was read, and what is found of it.

use machine_model::{Axis, Command};

use super::basis::Basis;
use super::terms::Term;

/// What was read with the ball in its nest, at one command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallReading {
    /// Run: one mounting of the ball.
    pub run: usize,
    /// What the axes were told, and the tool.
    pub command: Command,
    /// Sides from which A, B, C came; 0 where unknown.
    pub turning: [i8; 3],
    /// Measured minus commanded tip, workpiece frame, less what effects beyond the base's tables do, mm; `None` where not
    /// measured.
    pub deviation_mm: [Option<f64>; 3],
    /// Standard uncertainty by component, mm: in all rows or in none.
    pub uncertainty_mm: Option<[f64; 3]>,
}

/// An axis that turned.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedAxis {
    /// Which.
    pub axis: Axis,
    /// How many angles it was read at.
    pub angles: usize,
    /// From where to where, rad.
    pub range_rad: [f64; 2],
    /// What its error functions are spread over.
    pub basis: Basis,
    /// So many groups of the basis: what the evidence asks for.
    pub groups: usize,
    /// So many groups would have been allowed by the number of angles.
    pub most_groups: usize,
    /// How far balls were from the axis at most, mm.
    pub arm_mm: f64,
}

/// A term as found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundTerm {
    /// Which.
    pub term: Term,
    /// What the base says of a location error; 0 of all others, mm or rad.
    pub base: f64,
    /// Its change against the base, mm or rad.
    pub change: f64,
    /// Standard uncertainty.
    pub standard_uncertainty: f64,
    /// Half width of the 95 % interval.
    pub half_width_95: f64,
    /// True where it is part of the written machine.
    pub is_written: bool,
}
