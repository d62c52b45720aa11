//! Do two programs cut alike? One as it was posted, one as it was corrected, on the machine as it is.
//!
//! A program is a row of items: feeds, positioning moves, deeds ([`Act`]). Cycles are written out as the moves a
//! control makes of them, so that it makes no difference whether the corrected program left them as cycles.
//!
//! Between two items that are no feeds lies a run of feeds, two paths in space: the one as programmed, and the one on
//! which the machine really goes, lost motion included ([`machine_model::Play`] along the commanded path). They are alike
//! where both can be run through at once, each forwards only, and never be farther apart than the limit: the Fréchet
//! distance, decided by its free space (Alt and Godau 1995). Only what can be reached is kept, so that memory is a window
//! of the programs. Where two motions differ in their process (spindle, feed, compensation…), neither may go on while
//! the other does.
//!
//! Where nothing can be reached any more, the next items that fit each other again are looked for, and what lies before
//! them on either side has a name: missing, extra, moved ([`Mismatch`]).
//!
//! What is found is a lower bound of the deviation: the path is computed every half millimetre, and wherever an axis
//! turns or has its play taken up; between, slope jumps of a table of 12 µm/m hide 1.5 nm. The room shares the machine
//! model with the correction, and nothing else.

mod alignment;
mod difference;
mod items;
mod matcher;
mod stretch;
mod way;

use machine_model::Models;
use toolpath::{Kinematics, Motion, PeckRetreats};

pub use stretch::LEVER_MM;
pub use way::Way;

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
        /// What X, Y and Z are.
        kinematics: Kinematics,
        /// The number of F in force.
        feed: Option<f64>,
        /// The deed of a cycle at the bottom of its hole.
        dwell: Option<u32>,
    },
    /// Something is done at its place between two motions: deeds of both programs with one number are one deed.
    Deed(u32),
}

/// A distance and where it is largest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// The largest distance from the programmed path, mm.
    pub largest_mm: f64,
    /// Line of the programmed motion.
    pub line: u64,
}

impl Deviation {
    fn note(&mut self, distance_mm: f64, line: u64) {
        if distance_mm > self.largest_mm {
            *self = Self { largest_mm: distance_mm, line };
        }
    }
}

/// Why two programs do not cut alike.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// What.
    pub what: What,
    /// Line of the programmed motion; of one that is extra, of what comes next.
    pub wanted_line: u64,
    /// Line of the corrected motion; of one that is missing, of what comes instead.
    pub commanded_line: u64,
}

/// What differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum What {
    /// The real path leaves the programmed one by so much, mm.
    TooFar(f64),
    /// A programmed feed motion is not made.
    Missing,
    /// It ends so much short of its end, mm.
    Short(f64),
    /// A feed motion is made that is not programmed.
    Extra,
    /// The rotary axes stand elsewhere.
    Turned,
    /// A programmed positioning move (G0, a reference return) is not made.
    NotPositioned,
    /// A positioning move ends where no programmed one ends.
    PositionedElsewhere,
    /// Another process is in force: the numbers of both.
    Process([u32; 2]),
    /// Another F is in force.
    Feed([Option<f64>; 2]),
    /// Under cutter compensation, where the control offsets block by block, they are not the same block.
    Compensated,
    /// Under G93 a motion takes so many times as long.
    Time(f64),
    /// A deed is not done, its number.
    NotDone(u32),
    /// A deed is done that is not programmed, its number.
    DoneToo(u32),
}

/// What the comparison found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Comparison {
    /// Feed motions programmed.
    pub wanted: usize,
    /// Feed motions commanded.
    pub commanded: usize,
    /// The programmed path run uncorrected.
    pub before: Deviation,
    /// The corrected path.
    pub after: Deviation,
    /// The largest of the limits, mm.
    pub limit_mm: f64,
    /// The first differences.
    pub mismatches: Vec<Mismatch>,
    /// How many more there are.
    pub more_mismatches: usize,
    /// Moves to a corrected start that the correction put in.
    pub approaches: usize,
    /// Every programmed feed motion, in order, where they are asked for.
    pub traces: Vec<Trace>,
}

/// A programmed feed motion, and how far the tool is from it.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Line of its file.
    pub line: u64,
    /// Where it leads, axis commands.
    pub way: Way,
    /// Largest distance from it where it is run uncorrected, mm.
    pub before_mm: f64,
    /// Largest distance of the corrected motions made for it, mm.
    pub after_mm: f64,
}

/// Whether a comparison remembers every motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traces {
    /// [`Comparison::traces`] is empty.
    Forgotten,
    /// One for each programmed feed motion.
    Kept,
}

/// Compares what the machine really does by `commanded` with what is programmed by `wanted`.
#[must_use]
pub fn compare(
    models: Models<'_>,
    wanted: impl Iterator<Item = Step>,
    commanded: impl Iterator<Item = Step>,
    retreats: PeckRetreats,
    traces: Traces,
) -> Comparison {
    matcher::Matcher::new(models, wanted, commanded, retreats, traces).compare()
}
