//! Measurements with their predictions; what a diagnosis says, as values and as JSON.

mod books;
pub mod change;
pub mod json;
mod measurements;
mod model;
pub mod plan;
mod read;
pub mod summary;

use diagnostic::{Speaks, notice};
use gap_diagnosis::{Diagnosis, Options};
use machine_model::effects::EffectKind;

use crate::message::{Failure, OPTION};
pub use books::Books;
use change::Change;
pub use model::Model;
pub use read::{File, Measured, of_one_machine, read, readable};

/// A diagnosis, and what each of its causes changes in the profile.
pub struct Diagnosed {
    /// The answer.
    pub diagnosis: Diagnosis,
    /// By cause.
    pub changes: Vec<Vec<Change>>,
    /// `vpost.diagnosis/1`
    pub json: String,
}

/// Which effect explains what the rows say against the model.
///
/// `seed`: of the random relabellings behind the p values of places; `without`: effects that are not in the library.
///
/// # Errors
/// An effect that there is not.
pub fn diagnose(
    model: &Model,
    measured: &Measured,
    holdout: Option<&Measured>,
    seed: u64,
    without: &[String],
) -> Result<Diagnosed, Failure> {
    let without = without.iter().map(|id| id.parse::<EffectKind>()).collect::<Result<Vec<_>, _>>().map_err(
        |error| {
            Failure::usage(notice!(OPTION; error.text();
                "see docs/diagnosis.md for the library", "список эффектов — в docs/diagnosis.md"
            ))
        },
    )?;
    let steps = model.profile.resolution_mm.iter().map(|step| 1e3 * step);
    let options = Options {
        without,
        seed,
        volume: Some(model.profile.volume()),
        resolution_um: steps.fold(f64::INFINITY, f64::min),
    };
    let diagnosis = gap_diagnosis::diagnose(&measured.data, holdout.map(|held| &held.data), &options);
    let change = |cause| match diagnosis.withheld {
        None => change::of(cause, &model.profile),
        Some(_) => Vec::new(),
    };
    let changes: Vec<Vec<Change>> = diagnosis.causes.iter().map(change).collect();
    let json = json::text(&diagnosis, &changes);
    Ok(Diagnosed { diagnosis, changes, json })
}
