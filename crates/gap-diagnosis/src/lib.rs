//! Which effect explains the gap.
//!
//! Measurements against the prediction of a machine model: is there a gap above the noise, where does it
//! lie, which unmodelled effect causes it and which others could, how far it shrinks with that effect in the
//! model, and what to measure next. The method and its thresholds are in `docs/diagnosis.md`.
//!
//! One folder a step, each using only those before it: `effects` (what is known of each), `equations` (what was read, and the columns that could explain
//! it), `library` (the effects a file could show), `search` (which of them explain the gap), `judgement` (what that is
//! worth), `words`; [`diagnose()`] takes them in turn.

mod diagnose;
mod effects;
mod equations;
mod judgement;
mod library;
mod options;
mod search;
#[cfg(test)]
mod tests;
mod words;

pub use diagnose::{diagnose, underpowered};
pub use equations::align::gap_rms_um;
pub use equations::observation::{Believed, Measurements, Reading, Row};
pub use judgement::answer::{
    Cause, Cell, Detectable, Diagnosis, Gap, Holdout, Leftover, Lookalike, NextMeasurement, Parameter,
    Residual, Setup, Shrinkage, Step, Verdict,
};
pub use judgement::confounding::{Confounding, confounding};
pub use options::Options;
pub use search::formula::Formula;
pub use words::name::{effect_name, number_name};
