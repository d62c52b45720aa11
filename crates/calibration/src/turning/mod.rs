//! Measured test pieces of a lathe to its geometry: taper, bow, squareness, and what is the tool's or the heat's.
//!
//! Readings are rows of `d = 2 (r − R)` and of faces `z − Z`; the chain of (71) to (73) predicts them, generalised least
//! squares (30), (78) finds what changed. Diameters alone see how parallel Z is to the axis of the workpiece: `EB0Z − EB0S`,
//! counted as EB0S. Faces see how square X is to that axis: EB0S alone, for X is straight along itself; with both,
//! EB0Z is told as well.

mod bases;
mod causes;
mod equations;
mod estimate;
mod levels;
mod one_machine;
mod readings;
mod rounding;
mod rows;
mod strata;
mod term;

pub use causes::{Bar, Cause, CauseRow, cause_name, lathe_causes};
pub use equations::{Change, Stretch, TurningBase};
pub use estimate::{FoundTerm, HeldOut, LEVEL, Offset, TurningCalibration, calibrate};
pub use rows::{Feature, TurnedReading};
pub use strata::Uncertainty;
pub use term::Term;
