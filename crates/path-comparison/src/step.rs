//! What a program does, one thing after the other.

use machine_model::Placement;
use toolpath::{Kinematics, Motion};

/// One thing that a program does, with what the comparison must know of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// What is done.
    pub act: Act,
    /// Line of its file.
    pub line: u64,
    /// Which process is in force: steps of both programs with one number have one process.
    pub process: u32,
    /// What counts as too far, mm; of the programmed step.
    pub limit_mm: f64,
    /// G41 or G42 is in force before or after it: the control offsets block by block.
    pub compensated: bool,
    /// How far its direction may be off where directions are compared; `None` where rotary axes are by their angles.
    pub pointing: Option<Pointing>,
}

/// How far a direction may be off.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pointing {
    /// The tool's real direction from the programmed one, rad.
    pub leans_rad: f64,
    /// The same near a singularity, rad.
    pub leans_near_rad: f64,
    /// How near that is, `|n · (a × b)|` of equation (118).
    pub near_sin: f64,
    /// A rotary axis from its programmed angle, degrees.
    pub aside_deg: f64,
}

/// What a step does.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "nearly all are motions, and they come by millions")]
pub enum Act {
    /// The axes move.
    Motion {
        /// The motion: axis commands or tip commands.
        motion: Motion,
        /// From gauge point to tip, mm.
        tool_mm: [f64; 3],
        /// Where the workpiece lies.
        datum: Placement,
        /// What X, Y and Z are.
        kinematics: Kinematics,
        /// The number of F in force.
        feed: Option<f64>,
        /// The deed of a cycle at the bottom of its hole.
        dwell: Option<u32>,
        /// The process with the cycle that makes it: told apart where both programs call one, else moves are moves.
        cycle: Option<u32>,
    },
    /// Something is done at its place between two motions: deeds of both programs with one number are one deed.
    Deed(u32),
}
