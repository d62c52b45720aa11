//! `vpost diagnose`: files in, the answer of `gap-diagnosis` out.

mod books;
mod change;
mod json;
mod measurements;
mod plan;
mod report;
mod summary;
mod written;

use std::path::PathBuf;

use clap::Args;
use gap_diagnosis::{Measurements, Options, Row};
use machine_model::effects::{EffectGeometry, EffectKind, EffectTerm};
use machine_model::engines::build;
use machine_profile::Profile;

use self::change::Change;
use self::report::{Facts, Report};
use crate::arguments::Shared;
use crate::message::{Failure, Messages};
use crate::roles::Roles;
use crate::settings::{engine_named, machine, setup_tool};
use crate::{file, profile};

/// `vpost diagnose`
#[derive(Debug, Args)]
pub struct Diagnose {
    /// Measurements (CSV); - for standard input.
    #[arg(value_name = "MEASUREMENTS.csv", required_unless_present = "plan")]
    pub measurements: Option<PathBuf>,
    /// Print what to measure on this machine, and nothing else: rows to fill in, or the NC program that goes there.
    #[arg(long, value_enum, value_name = "FORM", conflicts_with = "measurements")]
    pub plan: Option<plan::Form>,
    /// Measurements that no fit may see: the predicted shrinkage is checked on them.
    #[arg(long, value_name = "FILE")]
    pub holdout: Option<PathBuf>,
    /// Write the diagnosis as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the diagnosis as one page for a browser: drawings, no network, no script.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write the profile with the causes added as effects.
    #[arg(long, value_name = "FILE")]
    pub write_profile: Option<PathBuf>,
    /// Column of the measurements to pass over (repeatable).
    #[arg(long, value_name = "NAME")]
    pub ignore_column: Vec<String>,
    /// Take the columns as they are named, even where the rows fit better with a sign flipped or two columns swapped.
    #[arg(long)]
    pub as_written: bool,
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
    /// Of the profile and its tables.
    hash: blake3::Hash,
    /// The profile and its tables.
    files: Vec<PathBuf>,
    engine: Option<Box<dyn machine_model::Engine>>,
    effects: Vec<EffectTerm>,
    geometry: EffectGeometry,
}

/// A measurement file with its predictions, and what a report says of the file.
struct Measured {
    data: Measurements,
    file: report::File,
}

/// `vpost diagnose MEASUREMENTS.csv -m PROFILE`
pub(crate) fn run(arguments: &Diagnose, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let model = Model::load(shared)?;
    let Some(measurements) = &arguments.measurements else {
        return plan::print(arguments.plan.unwrap_or(plan::Form::Points), &model, shared, messages);
    };
    Roles::default()
        .reads("the measurements", measurements)
        .reads_all("the hold-out", &arguments.holdout)
        .reads_all("read by the profile", &model.files)
        .writes("--json", arguments.json.as_deref())
        .writes("--html", arguments.html.as_deref())
        .writes("--write-profile", arguments.write_profile.as_deref())
        .are_apart()?;
    let measured = read(measurements, &model, &arguments.ignore_column, arguments.as_written)?;
    let unseen = arguments.holdout.as_deref();
    let holdout =
        unseen.map(|path| read(path, &model, &arguments.ignore_column, arguments.as_written)).transpose()?;
    if let (Some(path), Some(held)) = (unseen, &holdout) {
        of_one_machine(path, &measured, held)?;
    }
    let without = arguments
        .without
        .iter()
        .map(|id| id.parse::<EffectKind>())
        .collect::<Result<Vec<_>, _>>()
        .map_err(|error| Failure::option(error.to_string(), "see docs/diagnosis.md for the library"))?;
    let steps = model.profile.resolution_mm.iter().map(|step| 1e3 * step);
    let options = Options {
        without,
        seed: arguments.seed,
        volume: Some(model.profile.volume()),
        resolution_um: steps.fold(f64::INFINITY, f64::min),
    };
    let unseen = holdout.as_ref().map(|h| &h.data);
    let diagnosis = gap_diagnosis::diagnose(&measured.data, unseen, &options);
    let changes: Vec<Vec<Change>> =
        diagnosis.causes.iter().map(|cause| change::of(cause, &model.profile)).collect();
    let json = json::text(&diagnosis, &changes);
    if let Some(path) = &arguments.json {
        file::write(path, json.as_bytes())?;
    }
    if let Some(path) = &arguments.html {
        let facts = model.facts(arguments, shared, &measured, holdout.as_ref())?;
        let page = Report {
            diagnosis: &diagnosis,
            changes: &changes,
            data: &measured.data,
            holdout: unseen,
            facts: &facts,
            json: &json,
        };
        file::write(path, page.html().as_bytes())?;
    }
    if let Some(path) = &arguments.write_profile {
        written::write(path, machine(shared)?, &diagnosis)?;
        messages.note(&format!("{} holds the profile with the causes as effects", file::name(path)));
    }
    file::print(summary::text(&diagnosis, &changes).as_bytes())
}

impl Model {
    fn load(shared: &Shared) -> Result<Self, Failure> {
        let profile::Loaded { profile, hash, files } = profile::load_mill(machine(shared)?)?;
        let engine = match &shared.engine {
            None => None,
            Some(name) => {
                let built = build(engine_named(name)?, profile.engine_inputs_without_effects());
                Some(built.map_err(|error| {
                    Failure::option(error.to_string(), "use an engine the profile has the tables for")
                })?)
            }
        };
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

    /// What the report says of files, options and machine.
    fn facts(
        &self,
        arguments: &Diagnose,
        shared: &Shared,
        measured: &Measured,
        holdout: Option<&Measured>,
    ) -> Result<Facts, Failure> {
        let calibrated = self.profile.calibrated.as_ref().map_or_else(String::new, |c| {
            let temperature = c.temperature_c.map(|t| format!("{t} \u{b0}C"));
            [c.date.clone(), temperature, c.instrument.clone()]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()
                .join(", ")
        });
        Ok(Facts {
            machine: self.profile.name.clone(),
            chain: self.profile.chain().to_string(),
            calibrated,
            profile: report::File {
                name: file::name(machine(shared)?),
                hash: self.hash.to_string(),
                comments: Vec::new(),
            },
            measurements: measured.file.clone(),
            holdout: holdout.map(|h| h.file.clone()),
            engine: shared.engine.clone().unwrap_or_else(|| "rigid-body".to_owned()),
            seed: arguments.seed,
            ignored_columns: arguments.ignore_column.clone(),
            without: arguments.without.clone(),
            tolerance_um: shared.tolerance.unwrap_or(self.profile.correction.tolerance_um),
        })
    }
}

fn geometry(profile: &Profile) -> EffectGeometry {
    let mut geometry = EffectGeometry::from_chain(profile.chain());
    for (to, from) in geometry.rotary_centre_mm.iter_mut().zip(&profile.description.rotary) {
        *to = from.centre_mm;
    }
    if let Some(temperature) = profile.calibrated.as_ref().and_then(|c| c.temperature_c) {
        geometry.reference_temp_c = temperature;
    }
    geometry
}

/// Refuses a hold-out whose rows move what the measurements hold still: a rotary axis, or nothing that they move.
fn of_one_machine(path: &std::path::Path, measured: &Measured, held: &Measured) -> Result<(), Failure> {
    /// An angle that is the same, rad.
    const SAME_RAD: f64 = 1e-6;
    let turns = |data: &Measurements, axis: usize| {
        let angles = || data.rows.iter().map(|row| row.command.rotary_rad[axis]);
        let (low, high) = angles().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        high - low > SAME_RAD
    };
    let refuse = |message: String| {
        Failure::option(
            format!("the hold-out {}: {message}", file::name(path)),
            "give a hold-out of the same machine that moves the same axes, or diagnose without --holdout",
        )
    };
    for (axis, letter) in ["A", "B", "C"].into_iter().enumerate() {
        if turns(&held.data, axis) && !turns(&measured.data, axis) {
            return Err(refuse(format!("{letter} turns there, and stands still in the measurements")));
        }
    }
    let moves = |data: &Measurements, axis: usize| {
        let (low, high) = data.range_mm(axis);
        high - low > 1e-3
    };
    let letters = |data: &Measurements| -> Vec<&str> {
        ["X", "Y", "Z"].into_iter().enumerate().filter(|(a, _)| moves(data, *a)).map(|(_, l)| l).collect()
    };
    let (fitted, unseen) = (letters(&measured.data), letters(&held.data));
    if !unseen.is_empty() && unseen.iter().all(|letter| !fitted.contains(letter)) {
        return Err(refuse(format!(
            "it moves {}, and the measurements {}",
            unseen.join(", "),
            fitted.join(", ")
        )));
    }
    Ok(())
}

/// Reads measurements, and leaves it at that.
pub(crate) fn readable(bytes: &[u8], profile: &Profile) -> Result<(), Failure> {
    let (data, table) =
        measurements::read("measurements", bytes, setup_tool(profile), &[], &geometry(profile))?;
    measurements::commands_and_frames(&table, &data, profile)
}

fn read(
    path: &std::path::Path,
    model: &Model,
    ignore: &[String],
    as_written: bool,
) -> Result<Measured, Failure> {
    let bytes = file::read(path)?;
    let tool_mm = setup_tool(&model.profile);
    let name = file::name(path);
    let (mut data, table) = measurements::read(&name, &bytes, tool_mm, ignore, &model.geometry)?;
    measurements::commands_and_frames(&table, &data, &model.profile)?;
    let rigid = model.profile.rigid_body_without_effects();
    let predict = |row: &mut Row| {
        row.predicted_mm = match model.engine.as_deref().and_then(|e| e.path_model()) {
            // Said along the linear axes, read by the workpiece.
            Some(engine) => model.geometry.table_turn(&row.command) * engine.error_mm(&row.command),
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
        Ok(())
    };
    data.rows.iter_mut().try_for_each(predict)?;
    measurements::readings_against_model(&table, &data)?;
    let travel_mm =
        [0, 1, 2].map(|axis| model.profile.description.linear[axis].travel_mm).map(|r| (r.low, r.high));
    if !as_written && let Some(slip) = books::slip(&data, &model.profile.work_offsets, travel_mm, predict) {
        return Err(table.slipped(&slip));
    }
    in_order_of_time(&mut data);
    let text = file::decoded(&bytes);
    let comments = text.lines().filter(|line| line.starts_with('#')).map(str::to_owned).collect();
    let file = report::File { name, hash: blake3::hash(&bytes).to_string(), comments };
    Ok(Measured { data, file })
}

/// Neighbours are rows that were measured one after the other: where every row has its time, that is the order, whatever
/// the order of the lines. Else a run was measured as its lines stand, and the runs as they first appear.
fn in_order_of_time(data: &mut Measurements) {
    if data.rows.iter().any(|row| row.conditions.time_s.is_none()) {
        return;
    }
    let names = std::mem::take(&mut data.runs);
    let key = |row: &Row| {
        let command = &row.command;
        let vectors = [command.linear_mm, command.rotary_rad, command.tool_mm];
        let mut numbers = vec![row.conditions.time_s.unwrap_or_default()];
        numbers.extend(vectors.iter().flat_map(|v| v.iter().copied()));
        numbers.extend(command.direction.map(f64::from));
        numbers
    };
    data.rows.sort_by(|a, b| {
        let pairs = key(a).into_iter().zip(key(b));
        let order = pairs.map(|(a, b)| a.total_cmp(&b)).find(|order| order.is_ne());
        // What was measured at one time in one place has no order but that of the lines.
        order.unwrap_or(std::cmp::Ordering::Equal).then_with(|| names[a.run].cmp(&names[b.run]))
    });
    let mut place: Vec<Option<usize>> = vec![None; names.len()];
    for row in &mut data.rows {
        row.run = *place[row.run].get_or_insert_with(|| {
            data.runs.push(names[row.run].clone());
            data.runs.len() - 1
        });
    }
}
