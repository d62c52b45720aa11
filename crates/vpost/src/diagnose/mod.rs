//! `vpost diagnose`: files in, the answer of `gap-diagnosis` out.

mod json;
mod measurements;
mod summary;
mod written;

use std::path::PathBuf;

use clap::Args;
use gap_diagnosis::{Measurements, Options};
use machine_model::effects::{EffectGeometry, EffectKind, EffectTerm};
use machine_model::engines::build;
use machine_profile::Profile;

use crate::arguments::Shared;
use crate::message::{Failure, Messages};
use crate::settings::{engine_named, machine, setup_tool};
use crate::{file, profile};

/// `vpost diagnose`
#[derive(Debug, Args)]
pub struct Diagnose {
    /// Measurements (CSV); - for standard input.
    #[arg(value_name = "MEASUREMENTS.csv")]
    pub measurements: PathBuf,
    /// Measurements that no fit may see: the predicted shrinkage is checked on them.
    #[arg(long, value_name = "FILE")]
    pub holdout: Option<PathBuf>,
    /// Write the diagnosis as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the profile with the causes added as effects.
    #[arg(long, value_name = "FILE")]
    pub write_profile: Option<PathBuf>,
    /// Column of the measurements to pass over (repeatable).
    #[arg(long, value_name = "NAME")]
    pub ignore_column: Vec<String>,
    /// Seed of the random relabellings behind the p values of places.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Take an effect out of the library (repeatable).
    #[arg(long, value_name = "ID", hide = true)]
    pub without: Vec<String>,
}

/// What predicts the rows: engine or tables, with the profile's effects.
struct Model {
    profile: Profile,
    engine: Option<Box<dyn machine_model::Engine>>,
    effects: Vec<EffectTerm>,
    geometry: EffectGeometry,
}

/// `vpost diagnose MEASUREMENTS.csv -m PROFILE`
pub(crate) fn run(arguments: &Diagnose, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let model = Model::load(shared)?;
    let data = read(&arguments.measurements, &model, &arguments.ignore_column)?;
    let holdout =
        arguments.holdout.as_deref().map(|path| read(path, &model, &arguments.ignore_column)).transpose()?;
    let without = arguments
        .without
        .iter()
        .map(|id| id.parse::<EffectKind>())
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| Failure::option(error.to_string(), "see docs/diagnosis.md for the library"))?;
    let options = Options { without, seed: arguments.seed, volume: Some(model.profile.volume()) };
    let diagnosis = gap_diagnosis::diagnose(&data, holdout.as_ref(), &options);
    if let Some(path) = &arguments.json {
        file::write(path, &json::bytes(&diagnosis))?;
    }
    if let Some(path) = &arguments.write_profile {
        written::write(path, machine(shared)?, &diagnosis)?;
        messages.note(&format!("{} holds the profile with the causes as effects", file::name(path)));
    }
    file::print(summary::text(&diagnosis).as_bytes())
}

impl Model {
    fn load(shared: &Shared) -> Result<Self, Failure> {
        let profile = profile::load(machine(shared)?)?.profile;
        let engine = match &shared.engine {
            None => None,
            Some(name) => {
                let built = build(engine_named(name)?, profile.engine_inputs_without_effects());
                Some(built.map_err(|error| {
                    Failure::option(error.to_string(), "use an engine the profile has the tables for")
                })?)
            }
        };
        let mut geometry = EffectGeometry::from_chain(profile.chain());
        for (to, from) in geometry.rotary_centre_mm.iter_mut().zip(&profile.description.rotary) {
            *to = from.centre_mm;
        }
        if let Some(temperature) = profile.calibrated.as_ref().and_then(|c| c.temperature_c) {
            geometry.reference_temp_c = temperature;
        }
        let effects = profile
            .effects
            .iter()
            .map(|entry| EffectTerm::from_entry(&entry.id, &entry.parameters))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| Failure::option(error.to_string(), "correct the profile's [[effect]]"))?;
        let effects = effects.into_iter().map(|term| term.with_geometry(geometry.clone())).collect();
        Ok(Self { profile, engine, effects, geometry })
    }
}

fn read(path: &std::path::Path, model: &Model, ignore: &[String]) -> Result<Measurements, Failure> {
    let bytes = file::read(path)?;
    let tool_mm = setup_tool(&model.profile);
    let name = file::name(path);
    let (mut data, table) = measurements::read(&name, &bytes, tool_mm, ignore, &model.geometry)?;
    measurements::commands_and_frames(&table, &data, &model.profile)?;
    let rigid = model.profile.rigid_body_without_effects();
    for row in &mut data.rows {
        row.predicted_mm = match model.engine.as_deref().and_then(|e| e.path_model()) {
            Some(engine) => engine.error_mm(&row.command),
            None => rigid.predict(&row.command).error_mm,
        };
        for effect in &model.effects {
            row.predicted_mm += effect.displacement_mm(&row.command, &row.conditions).map_err(|error| {
                Failure::option(
                    format!("{} of the profile: {error}", effect.kind()),
                    "give the measurements that column, or take the effect out of the profile",
                )
            })?;
        }
    }
    measurements::readings_against_model(&table, &data)?;
    Ok(data)
}
