//! The closed loop: does the tool path of a corrected program follow the programmed one?
//!
//! Shares the geometry of [`Curve`] with the correction, but not its proof: paths are sampled densely
//! and matched in order, whatever blocks they come from. What it finds is therefore a lower bound of
//! the deviation; samples at most 0.5 mm apart miss less than a quarter of the slope jump of a table
//! times that length (1.5 nm for a jump of 12 µm/m).
//!
//! Between feeds the ends of positioning moves are matched in order, their way being the control's; they also tell
//! which feeds a corrected feed can be of.

mod matcher;
mod path;
mod positioning;

use machine_model::PathModel;
use toolpath::Motion;

use crate::curve::Curve;
use matcher::Matcher;
use path::{Path, distance, for_samples, project};

/// One motion of a program with what the comparison must know of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The motion, axis commands.
    pub motion: Motion,
    /// From gauge point to tip, mm.
    pub tool_mm: [f64; 3],
    /// Line of its file.
    pub line: u64,
}

/// A program as its motions.
pub type Program = [Step];

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

/// Why two programs are not the same path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mismatch {
    /// The corrected path leaves the programmed one by more than the limit.
    TooFar {
        /// Line of the programmed motion.
        wanted_line: u64,
        /// Line of the corrected motion.
        commanded_line: u64,
        /// Distance, mm.
        distance_mm: f64,
    },
    /// A programmed feed motion that the corrected program does not make.
    Missing {
        /// Its line.
        wanted_line: u64,
    },
    /// A programmed feed motion that the corrected program begins and does not end.
    Short {
        /// Its line.
        wanted_line: u64,
        /// What is left of it, mm.
        left_mm: f64,
    },
    /// A corrected feed motion that belongs to no programmed one.
    Extra {
        /// Its line.
        commanded_line: u64,
    },
    /// A corrected feed motion with rotary axes that stand elsewhere.
    Turned {
        /// Line of the programmed motion.
        wanted_line: u64,
        /// Line of the corrected motion.
        commanded_line: u64,
    },
    /// A programmed positioning move (G0, a reference return) that the corrected program does not make.
    NotPositioned {
        /// Its line.
        wanted_line: u64,
    },
    /// A corrected positioning move that ends at no place where a programmed one ends.
    PositionedElsewhere {
        /// Its line.
        commanded_line: u64,
    },
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
    /// The first differences.
    pub mismatches: Vec<Mismatch>,
    /// How many more there are.
    pub more_mismatches: usize,
    /// Moves to a corrected start that the correction put in.
    pub approaches: usize,
    /// Every programmed feed motion, in order.
    pub traces: Vec<Trace>,
}

/// A programmed feed motion, and how far the tool is from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trace {
    /// Line of its file.
    pub line: u64,
    /// Where it leads, axis commands.
    pub curve: Curve,
    /// Largest distance from it where it is run uncorrected, mm.
    pub before_mm: f64,
    /// Largest distance of the corrected motions made for it, mm.
    pub after_mm: f64,
}

/// Compares the real path of `commanded` with the programmed path of `wanted`.
///
/// `limit_mm`: what counts as too far.
#[must_use]
pub fn compare(model: &dyn PathModel, wanted: &Program, commanded: &Program, limit_mm: f64) -> Comparison {
    let (wanted, commanded) = (Path::of(wanted), Path::of(commanded));
    let mut result =
        Comparison { wanted: wanted.feeds.len(), commanded: commanded.feeds.len(), ..Comparison::default() };
    for w in &wanted.feeds {
        let mut before_mm = 0.0f64;
        for_samples(&w.curve, |s| {
            let real = w.tip(model, s);
            before_mm = before_mm.max(distance(&w.curve, &real, project(&w.curve, &real, s)));
        });
        result.before.note(before_mm, w.line);
        result.traces.push(Trace { line: w.line, curve: w.curve, before_mm, after_mm: 0.0 });
    }
    let mut matcher = Matcher::new(model, &wanted, limit_mm, result);
    let mut positionings = commanded.positionings.iter().peekable();
    for (index, piece) in commanded.feeds.iter().enumerate() {
        while let Some(positioning) = positionings.next_if(|p| p.before <= index) {
            matcher.position(positioning);
        }
        matcher.take(piece);
    }
    positionings.for_each(|positioning| matcher.position(positioning));
    matcher.finish()
}
