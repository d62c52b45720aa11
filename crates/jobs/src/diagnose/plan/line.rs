//! A line of a plan: where something is read, and how the axes come there.

use machine_model::Vector;
use machine_model::effects::Conditions;

/// Time at rest for a reading, seconds.
pub(super) const DWELL_S: f64 = 3.0;
/// The ends of the volume stay free, for the way to a line and for the overrun at its ends.
pub(super) const MARGIN: f64 = 0.04;
/// Feed to a stop and between lines, mm/min.
pub(super) const SLOW_MM_MIN: f64 = 1000.0;
/// The second tool is so much longer, or half as long where the first is long already, mm.
pub(super) const LONGER_MM: f64 = 100.0;

/// A place where something is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stop {
    /// Axis positions.
    pub at_mm: Vector,
    /// A, B, C.
    pub rotary_deg: [f64; 3],
    /// How each axis came there.
    pub direction: [i8; 3],
}

/// One line, forward and back.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Line {
    /// Its id.
    pub run: String,
    /// Time before it, for the axes to run warm, seconds.
    pub wait_s: f64,
    /// Feed along it.
    pub feed_mm_min: f64,
    /// Read in passing, not at rest.
    pub flying: bool,
    /// From the point the tables were measured at to the target.
    pub tool_mm: Vector,
    /// Load, temperature and time, where the line is about them; else they are filled in.
    pub conditions: Conditions,
    /// How often the line was measured before, and once more.
    pub repeat: usize,
    /// Where the way to its first stop begins, so that the direction is known.
    pub before_mm: Vector,
    /// Where it turns.
    pub turn_mm: Vector,
    /// The stops in order.
    pub stops: Vec<Stop>,
    /// Where rotary axes turn and the others follow: where that begins, and what is passed on the way to each stop.
    pub swing: Option<(Spot, Vec<Vec<Spot>>)>,
}

/// Axes that keep at the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    pub(super) at_mm: Vector,
    pub(super) rotary_deg: [f64; 3],
}

/// To what any control resolves.
pub(super) fn rounded(at_mm: Vector) -> Vector {
    at_mm.map(|v| (v * 100.0).round() / 100.0)
}
