//! Motions as geometry.
//!
//! The one word that the text wing and the mathematics wing share. Everything here is in *axis
//! commands*: what the control tells the axes, machine coordinates, millimetres and degrees, after
//! work offset and tool length. No text, no matrices, no machine. What parameters of a control say of its cycles
//! ([`TurningParameters`]) stands here too: a profile says it, a lathe's program is read by it.

mod chords;
mod feed_rate;
mod following;
mod frame;
mod hole;
mod interpolator;
mod motion;
mod nurbs;
mod plane;
mod position;
mod tilted;
mod turning;

pub use chords::Chord;
pub use feed_rate::FeedRate;
pub use following::Following;
pub use frame::{Frame, Similarity};
pub use hole::{
    Cycle, CycleKind, Hole, HoleMove, MOST_PECKS, PeckRetreats, Retreat, Stroke, peck_depths, strokes,
    whole_pecks,
};
pub use interpolator::{ArcChords, Interpolator};
pub use motion::{Arc, Division, Feed, Kinematics, Motion, Mover, Shape};
pub use nurbs::{Bezier, MOST_DEGREE, Nurbs, NurbsFault};
pub use plane::Plane;
pub use position::{Partial, Position};
pub use tilted::{AngleValue, NoAngles, RotaryChain, RotaryLink, TiltRule, TiltedPlane, WholeTurns, unit};
pub use turning::{DrillPecks, DrillR, FlankFrom, TurningParameters};

/// Names of the linear and rotary axes, in the order of every array here.
pub const AXIS_NAMES: [char; 6] = ['X', 'Y', 'Z', 'A', 'B', 'C'];
