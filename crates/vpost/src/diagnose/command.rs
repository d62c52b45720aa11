//! `vpost diagnose`: files in, the answer of `gap-diagnosis` out.

use std::path::Path;

use diagnostic::{Text, both};
use jobs::diagnose::plan::{Form, Plan};
use jobs::diagnose::{Books, Diagnosed, Model, of_one_machine, summary};

use super::options::Diagnose;
use super::report::{Facts, Report};
use super::written;
use crate::arguments::Shared;
use crate::file;
use crate::message::{Failure, Messages};
use crate::roles::Roles;
use crate::settings::{self, machine};

/// `vpost diagnose MEASUREMENTS.csv -m PROFILE`
pub(crate) fn run(arguments: &Diagnose, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let whole = crate::profile::load(machine(&shared.job)?)?;
    Roles::default()
        .reads_all(&both!("the measurements", "измерения"), &arguments.measurements)
        .reads_all(&both!("the hold-out", "контрольные измерения"), &arguments.holdout)
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &whole.files)
        .writes("--json", arguments.json.as_deref())
        .writes("--html", arguments.html.as_deref())
        .writes("--viewer", arguments.viewer.as_deref())
        .writes("--write-profile", arguments.write_profile.as_deref())
        .are_apart()?;
    if whole.profile.lathe.is_some() {
        return super::lathe::run(arguments, &whole, shared, messages);
    }
    let model = Model::load(&shared.job)?;
    let Some(measurements) = &arguments.measurements else {
        return print(arguments.plan.unwrap_or(Form::Points), &Plan::whole(&model)?, shared, messages);
    };
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
        let facts = Facts::new(&whole, arguments, shared, &measured.file, held)?;
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
        Some(form) => print(form, &Plan::next(&diagnosis, &model)?, shared, messages),
        None => file::print(summary::text(&diagnosis, &changes).in_language(messages.language()).as_bytes()),
    }
}

/// Prints what to measure, and says what is to be known of it.
fn print(form: Form, plan: &Plan, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let text = match form {
        Form::Points => plan.points(),
        Form::Program => plan.program(&settings::load(shared, messages)?)?,
    };
    file::print(text.as_bytes())?;
    messages.note(&plan.note);
    Ok(())
}
