//! Synthetic machines with withheld effects.
//!
//! A machine of this crate is a rigid-body chain of its own kinematics plus effects that the profile it
//! hands out does not mention. It is measured by a simulated instrument and leaves as files only: a
//! profile, a measurement, a hold-out measurement, and the truth in a file of its own. The crate shares
//! no code with `gap-diagnosis` or `machine-model`, and its effects are not of the library's textbook
//! forms (a play operator for backlash, a cantilever for sag, sine series for straightness and so on):
//! a diagnosis that only recognises its own formulas must fail here.
//!
//! [`catalogue()`] lists the cases of a benchmark, [`CaseSpec::build`] makes one of them. Everything is a
//! function of the seed.
//!
//! Units inside: mm, rad, kg, s, °C, mm/min. Files: as the column names say.

mod alias;
mod blind;
pub mod calibration;
mod case;
mod catalogue;
pub mod circles;
mod collinearity;
mod design;
mod dice;
mod effect;
mod files;
mod fresh;
mod linear;
mod machine;
mod matrix;
mod noise;
mod outside;
mod plans;
mod row;
mod shape;
mod textbook;
mod truth;

pub use alias::Alias;
pub use case::{Case, CaseSpec, Kind};
pub use catalogue::{catalogue, doubtful, sample_cases};
pub use design::Plan;
pub use effect::Effect;
pub use files::Observation;
pub use fresh::{Fresh, Shrink};
pub use noise::NoiseKind;
pub use truth::{TrueEffect, Truth};

/// Names of the three linear axes, in the order in which positions are stored.
pub const AXES: [char; 3] = ['X', 'Y', 'Z'];
