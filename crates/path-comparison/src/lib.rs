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
mod along;
mod comparison;
mod course;
mod difference;
mod feeding;
mod holes;
mod items;
mod matcher;
mod offset;
mod others;
mod positioning;
mod process;
mod step;
mod stretch;
mod timing;
mod way;

use machine_model::Models;
use toolpath::PeckRetreats;

pub use comparison::{Comparison, Deviation, Lean, Mismatch, Trace, Traces, What};
pub use course::courses;
pub use others::{Course, DatumOf, TURN_RAD};
pub use step::{Act, Pointing, Step};
pub use stretch::LEVER_MM;
pub use way::Way;

/// Compares what the machine really does by `commanded` with what is programmed by `wanted`.
///
/// * `wider` – so many times the limits of the steps are taken, 1 or more: how far a path is off is known where all
///   of it lies within
#[must_use]
pub fn compare(
    models: Models<'_>,
    wanted: impl Iterator<Item = Step>,
    commanded: impl Iterator<Item = Step>,
    retreats: PeckRetreats,
    traces: Traces,
    wider: f64,
) -> Comparison {
    let widened = |step: Step| Step { limit_mm: step.limit_mm * wider, ..step };
    let (wanted, commanded) = (wanted.map(widened), commanded.map(widened));
    matcher::Matcher::new(models, wanted, commanded, retreats, traces, wider).compare()
}
