//! Motions as geometry.
//!
//! The one word that the text wing and the mathematics wing share. Everything here is in *axis
//! commands*: what the control tells the axes, machine coordinates, millimetres and degrees, after
//! work offset and tool length. No text, no matrices, no machine.

mod frame;
mod hole;
mod motion;
mod plane;
mod tilted;

pub use frame::{Frame, Similarity};
pub use hole::{Cycle, CycleKind, Hole, HoleMove, MOST_PECKS, PeckRetreats, whole_pecks};
pub use motion::{Arc, Division, Feed, FeedRate, Kinematics, Motion, Partial, Position, Shape};
pub use plane::Plane;
pub use tilted::{NoAngles, RotaryChain, RotaryLink, TiltRule, TiltedPlane, WholeTurns, unit};

/// Names of the linear and rotary axes, in the order of every array here.
pub const AXIS_NAMES: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];
