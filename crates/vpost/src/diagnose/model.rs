//! What predicts the rows of a measurement.

use std::path::PathBuf;

use machine_model::effects::{EffectGeometry, EffectTerm};
use machine_model::engines::build;
use machine_profile::Profile;

use crate::arguments::Shared;
use crate::message::Failure;
use crate::profile;
use crate::settings::machine;

/// What predicts the rows: engine or tables, with the profile's effects.
pub(super) struct Model {
    pub(super) profile: Profile,
    /// Of the profile and its tables.
    pub(super) hash: blake3::Hash,
    /// The profile and its tables.
    pub(super) files: Vec<PathBuf>,
    pub(super) engine: Option<Box<dyn machine_model::Engine>>,
    pub(super) effects: Vec<EffectTerm>,
    pub(super) geometry: EffectGeometry,
}

impl Model {
    pub(super) fn load(shared: &Shared) -> Result<Self, Failure> {
        let profile::Loaded { profile, hash, files } = profile::load_mill(machine(shared)?)?;
        let built = shared.job.engine().map(|id| build(id, profile.engine_inputs_without_effects()));
        let engine = built.transpose().map_err(|error| {
            Failure::option(error.to_string(), "use an engine the profile has the tables for")
        })?;
        let geometry = geometry(&profile);
        let effects = profile
            .effects
            .iter()
            .map(|entry| EffectTerm::from_entry(&entry.id, &entry.parameters))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| Failure::option(error.to_string(), "correct the profile's [[effect]]"))?;
        let effects = effects.into_iter().map(|term| term.with_geometry(geometry.clone())).collect();
        Ok(Self { profile, hash, files, engine, effects, geometry })
    }
}

pub(super) fn geometry(profile: &Profile) -> EffectGeometry {
    let mut geometry = EffectGeometry::from_chain(profile.chain());
    for (to, from) in geometry.rotary_centre_mm.iter_mut().zip(&profile.description.rotary) {
        *to = from.centre_mm;
    }
    if let Some(temperature) = profile.calibrated.as_ref().and_then(|c| c.temperature_c) {
        geometry.reference_temp_c = temperature;
    }
    geometry
}
