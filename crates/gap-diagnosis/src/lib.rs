//! Which effect explains the gap.
//!
//! Measurements against the prediction of a machine model: is there a gap above the noise, where does it
//! lie, which unmodelled effect causes it and which others could, how far it shrinks with that effect in the
//! model, and what to measure next. The method and its thresholds are in `docs/diagnosis.md`.

mod align;
mod assembly;
mod bounds;
mod columns;
mod confounding;
mod crossval;
mod diagnose;
mod diagnosis;
mod doubt;
mod engine;
mod fit;
mod forecast;
mod formula;
mod gram;
mod library;
mod linear;
mod locate;
mod magnitude;
mod motion;
mod next;
mod noise;
mod observation;
mod parameters;
mod pool;
mod propose;
mod refine;
mod remedy;
mod rivals;
mod search;
mod sentence;
mod shrinkage;
mod space;
mod structure;
mod term;
#[cfg(test)]
mod tests;
mod tile;
mod trial;
mod unseen;
mod verdict;
mod words;

pub use align::gap_rms_um;
pub use confounding::{Confounding, confounding};
pub use diagnose::{Options, diagnose, underpowered};
pub use diagnosis::{
    Cause, Cell, Detectable, Diagnosis, Gap, Holdout, Leftover, Lookalike, NextMeasurement, Parameter,
    Residual, Setup, Shrinkage, Step, Verdict,
};
pub use formula::Formula;
pub use observation::{Believed, Measurements, Reading, Row};
pub use remedy::remedy;
