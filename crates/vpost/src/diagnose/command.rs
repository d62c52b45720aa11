//! `vpost diagnose`: files in, the answer of `gap-diagnosis` out.

use std::path::{Path, PathBuf};

use clap::Args;
use diagnostic::{Text, both};
use jobs::diagnose::{Books, Diagnosed, File, Model, of_one_machine};
use machine_model::EngineId;
use machine_profile::Profile;

use super::plan::{self, Form};
use super::report::{Facts, Report};
use super::{summary, written};
use crate::arguments::Shared;
use crate::file;
use crate::message::{Failure, Messages};
use crate::roles::Roles;
use crate::settings::machine;

/// `vpost diagnose`
#[derive(Debug, Args)]
pub struct Diagnose {
    /// Measurements (CSV); - for standard input.
    #[arg(value_name = "MEASUREMENTS.csv", required_unless_present = "plan")]
    pub measurements: Option<PathBuf>,
    /// Print what to measure on this machine, and nothing else: rows to fill in, or the NC program that goes there.
    #[arg(long, value_enum, value_name = "FORM", conflicts_with = "measurements")]
    pub plan: Option<Form>,
    /// Print what to measure next instead of the summary: rows to fill in, or the NC program that goes there.
    #[arg(long, value_enum, value_name = "FORM", conflicts_with = "plan")]
    pub next: Option<Form>,
    /// Measurements that no fit may see: the predicted shrinkage is checked on them.
    #[arg(long, value_name = "FILE")]
    pub holdout: Option<PathBuf>,
    /// Write the diagnosis as JSON.
    #[arg(long, value_name = "FILE")]
    pub json: Option<PathBuf>,
    /// Write the diagnosis as one page for a browser.
    ///
    /// Drawings, no network, no script.
    #[arg(long, value_name = "FILE")]
    pub html: Option<PathBuf>,
    /// Write a page in which the error moves.
    ///
    /// The rows in space, magnified, cause by cause; HTML with a script of its own.
    #[arg(long, value_name = "FILE")]
    pub viewer: Option<PathBuf>,
    /// Write the profile with the causes added as effects.
    #[arg(long, value_name = "FILE")]
    pub write_profile: Option<PathBuf>,
    /// Column to pass over (repeatable).
    #[arg(long, value_name = "NAME")]
    pub ignore_column: Vec<String>,
    /// Take the columns as named: no look for flipped signs, swapped columns.
    #[arg(long)]
    pub as_written: bool,
    /// Seed of the random relabellings behind the p values of places.
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub seed: u64,
    /// Effect that this machine does not have, or the instrument (repeatable).
    #[arg(long, value_name = "ID")]
    pub without: Vec<String>,
}

/// `vpost diagnose MEASUREMENTS.csv -m PROFILE`
pub(crate) fn run(arguments: &Diagnose, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let whole = crate::profile::load(machine(&shared.job)?)?;
    if let Some(parts) = &whole.profile.lathe {
        let roles = Roles::default()
            .reads_all(&both!("the measurements", "измерения"), &arguments.measurements)
            .reads_all(&both!("the hold-out", "контрольные измерения"), &arguments.holdout)
            .reads_all(&both!("read by the profile", "файл, который читает профиль"), &whole.files);
        roles
            .writes("--json", arguments.json.as_deref())
            .writes("--html", arguments.html.as_deref())
            .are_apart()?;
        return super::lathe::run(
            arguments,
            &whole.profile,
            parts,
            &whole.hash.to_string(),
            shared,
            messages,
        );
    }
    let model = Model::load(&shared.job)?;
    let Some(measurements) = &arguments.measurements else {
        return plan::print(arguments.plan.unwrap_or(Form::Points), &model, shared, messages);
    };
    Roles::default()
        .reads(both!("the measurements", "измерения"), measurements)
        .reads_all(&both!("the hold-out", "контрольные измерения"), &arguments.holdout)
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &model.files)
        .writes("--json", arguments.json.as_deref())
        .writes("--html", arguments.html.as_deref())
        .writes("--viewer", arguments.viewer.as_deref())
        .writes("--write-profile", arguments.write_profile.as_deref())
        .are_apart()?;
    let books = if arguments.as_written { Books::AsWritten } else { Books::Checked };
    let read = |path: &Path, bytes: &[u8]| {
        jobs::diagnose::read(&file::name(path), bytes, &model, &arguments.ignore_column, books)
    };
    let bytes = file::read(measurements)?;
    let measured = read(measurements, &bytes)?;
    let unseen = arguments.holdout.as_deref();
    let holdout = unseen.map(|path| read(path, &file::read(path)?)).transpose()?;
    if let (Some(path), Some(held)) = (unseen, &holdout) {
        of_one_machine(&file::name(path), &measured, held)?;
    }
    let unseen = holdout.as_ref().map(|h| &h.data);
    let Diagnosed { diagnosis, changes, json } =
        jobs::diagnose::diagnose(&model, &measured, holdout.as_ref(), arguments.seed, &arguments.without)?;
    if let Some(path) = &arguments.json {
        file::write(path, json.as_bytes())?;
    }
    if arguments.html.is_some() || arguments.viewer.is_some() {
        let held = holdout.as_ref().map(|h| &h.file);
        let hash = model.hash.to_string();
        let facts = facts(&model.profile, &hash, arguments, shared, &measured.file, held)?;
        let facts = Facts { seed: Some(arguments.seed), ..facts };
        let page = Report {
            diagnosis: &diagnosis,
            changes: &changes,
            data: &measured.data,
            holdout: unseen,
            facts: &facts,
            json: &json,
            language: messages.language(),
        };
        if let Some(path) = &arguments.html {
            file::write(path, page.html().as_bytes())?;
        }
        if let Some(path) = &arguments.viewer {
            page.write_viewer(path, &measurement_files::utf8_or_1251(&bytes), messages)?;
        }
    }
    if let Some(path) = &arguments.write_profile {
        written::write(path, machine(&shared.job)?, &diagnosis)?;
        let holds = if diagnosis.corrects() {
            Text::pair("the profile with the causes as effects", "профиль, в котором причины — эффекты")
        } else {
            Text::pair(
                "the profile as it was: there is nothing to correct by",
                "прежний профиль: исправлять нечем",
            )
        };
        messages.note(&both!("{} holds {holds}", "в {} записан {holds:#}", file::name(path)));
    }
    match arguments.next {
        Some(form) => plan::print_next(form, &diagnosis, &model, shared, messages),
        None => file::print(summary::text(&diagnosis, &changes).in_language(messages.language()).as_bytes()),
    }
}

/// What the report says of files, options and machine.
///
/// * `hash` – of the profile and its tables
pub(super) fn facts(
    profile: &Profile,
    hash: &str,
    arguments: &Diagnose,
    shared: &Shared,
    measured: &File,
    holdout: Option<&File>,
) -> Result<Facts, Failure> {
    Ok(Facts {
        machine: profile.name.clone(),
        chain: profile.lathe.is_none().then(|| profile.chain().to_string()),
        origin: crate::origin::Origin::of(profile),
        profile: File {
            name: file::name(machine(&shared.job)?),
            hash: hash.to_owned(),
            comments: Vec::new(),
        },
        measurements: measured.clone(),
        holdout: holdout.cloned(),
        engine: shared.job.engine().unwrap_or(EngineId::RigidBody).to_string(),
        seed: None,
        ignored_columns: arguments.ignore_column.clone(),
        without: arguments.without.clone(),
        tolerance_um: shared.job.tolerance.unwrap_or(profile.correction.tolerance_um),
    })
}
