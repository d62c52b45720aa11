//! What a comparison says.

use crate::way::Way;

/// A distance and where it is largest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deviation {
    /// The largest distance from the programmed path, mm.
    pub largest_mm: f64,
    /// Line of the programmed motion.
    pub line: u64,
}

impl Deviation {
    pub(crate) fn note(&mut self, distance_mm: f64, line: u64) {
        if distance_mm > self.largest_mm {
            *self = Self { largest_mm: distance_mm, line };
        }
    }
}

/// An angle of the tool and where it is largest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lean {
    /// The largest angle, rad.
    pub largest_rad: f64,
    /// Line of the programmed motion.
    pub line: u64,
}

impl Lean {
    pub(crate) fn note(&mut self, rad: f64, line: u64) {
        if rad > self.largest_rad {
            *self = Self { largest_rad: rad, line };
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
    /// The tool points so far from where it shall, rad.
    Leans(f64),
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
    /// The tool's direction uncorrected, against that of an ideal machine, on a machine that turns it.
    pub leans_before: Lean,
    /// The same of the corrected program.
    pub leans_after: Lean,
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
    /// So far it may be, mm.
    pub limit_mm: f64,
    /// Line of the corrected file whose motion that is, where one was made.
    pub after_line: Option<u64>,
    /// Where these bring the tool, mm, as the workpiece sees it: places in order, with [`Traces::WithPlaces`].
    pub made_mm: Vec<[f64; 3]>,
}

/// Whether a comparison remembers every motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Traces {
    /// [`Comparison::traces`] is empty.
    Forgotten,
    /// One for each programmed feed motion.
    Kept,
    /// The same, each with [`Trace::made_mm`].
    WithPlaces,
}
