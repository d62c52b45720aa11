//! What predicts the rows of a measurement.

use std::path::PathBuf;

use diagnostic::{Speaks, notice};
use machine_model::effects::{EffectGeometry, EffectTerm};
use machine_model::engines::build;
use machine_profile::Profile;

use crate::message::{Failure, OPTION};
use crate::options::JobOptions;
use crate::profile;
use crate::settings::machine;

/// What predicts the rows: engine or tables, with the profile's effects.
pub struct Model {
    /// The machine.
    pub profile: Profile,
    /// Of the profile and its tables.
    pub hash: blake3::Hash,
    /// The profile and its tables.
    pub files: Vec<PathBuf>,
    /// Where it is not the tables of the profile.
    pub engine: Option<Box<dyn machine_model::Engine>>,
    /// The profile's.
    pub effects: Vec<EffectTerm>,
    /// Where they act.
    pub geometry: EffectGeometry,
}

impl Model {
    /// Reads the profile, and what the options say of the engine.
    ///
    /// # Errors
    /// What is wrong with them.
    pub fn load(options: &JobOptions) -> Result<Self, Failure> {
        let profile::Loaded { profile, hash, files } = profile::load_mill(machine(options)?)?;
        let built = options.engine().map(|id| build(id, profile.engine_inputs_without_effects()));
        let engine = built.transpose().map_err(|error| {
            Failure::usage(notice!(OPTION; error.text();
                "use an engine the profile has the tables for",
                "возьмите метод, для которого в профиле есть таблицы"
            ))
        })?;
        let geometry = profile.effect_geometry();
        let effects = profile
            .effects
            .iter()
            .map(|entry| EffectTerm::from_entry(&entry.id, &entry.parameters))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| {
                Failure::usage(notice!(OPTION; error.text();
                    "correct the profile's [[effect]]", "исправьте [[effect]] профиля"
                ))
            })?;
        let effects = effects.into_iter().map(|term| term.with_geometry(geometry.clone())).collect();
        Ok(Self { profile, hash, files, engine, effects, geometry })
    }
}
