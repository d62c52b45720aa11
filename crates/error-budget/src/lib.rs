//! Error budgets: which deviation of a machine costs how much, and what each may be.
//!
//! A *deviation* is one error function of one axis (`EXX` … `ECC`), a reversal value, a squareness, a
//! location error of a rotary axis or an effect of the profile. Each has a coefficient ε (Serkov 2017):
//! 1 as measured, 0 switched off. Coefficients multiply the machine's description, so that what is
//! evaluated is always the whole rigid-body model; where sums of single contributions are used, what they
//! leave out is measured beside it.
//!
//! The criteria of the machine over its control points are `M = max |d|`, `A = max |d| - min |d|` and the
//! root mean square: [`Criteria`]. [`Budget`] has what each deviation brings and how the criteria depend on
//! it, [`worst_case`] and [`root_sum_of_squares`] what deviations can make of which only the sizes are known,
//! [`mending`] and [`tolerances`] the two syntheses. Equations (52) to (57) of `docs/equations.md`.
//!
//! No text, no files, no threads: who asks says how a machine is evaluated at the control points.

mod budget;
mod combined;
mod criteria;
mod machine;
pub mod mending;
pub mod tolerances;
mod zonotope;

pub use budget::{Budget, Item, OneSided};
pub use combined::{Extreme, Field, balanced_signs, root_sum_of_squares, worst_case};
pub use criteria::Criteria;
pub use machine::{Deviation, Family, Machine, Unit};
pub use zonotope::{Farthest, farthest};
