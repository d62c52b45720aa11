//! The closed loop: two programs through the machine model, what they make of the part compared.

mod page;
mod viewer;

use std::path::Path;

use diagnostic::both;
use jobs::check::{Outcome, closed, limit_mm};
use path_comparison::Traces;

use crate::arguments::{Check, Shared};
use crate::file;
use crate::message::{Failure, Messages};
use crate::progress::Progress;
use crate::roles::Roles;
use crate::settings;

/// `vpost check IN.nc OUT.nc -m PROFILE`
pub(crate) fn run(arguments: &Check, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let settings = settings::load(shared, messages)?;
    Roles::default()
        .reads(both!("the program", "программа"), &arguments.input)
        .reads(both!("the corrected program", "исправленная программа"), &arguments.output)
        .reads_all(&both!("read by the profile", "файл, который читает профиль"), &settings.files)
        .writes("--html", arguments.html.as_deref())
        .writes("--viewer", arguments.viewer.as_deref())
        .are_apart()?;
    let model = settings.path_model()?;
    let read = |path: &Path| -> Result<_, Failure> { Ok((file::name(path), file::read_program(path)?)) };
    let (wanted_name, wanted) = read(&arguments.input)?;
    let (commanded_name, commanded) = read(&arguments.output)?;
    let traces = match (&arguments.html, &arguments.viewer) {
        (_, Some(_)) => Traces::WithPlaces,
        (Some(_), None) => Traces::Kept,
        (None, None) => Traces::Forgotten,
    };
    let progress = Progress::new(messages, None);
    let programs = [(wanted_name.as_str(), wanted.as_slice()), (&commanded_name, &commanded)];
    let checked = closed(programs, &settings, traces, &|done| progress.report(done))?;
    progress.end();
    let outcome = Outcome::new(&settings, &checked);
    let comparison = checked.comparison;
    let limit_mm = limit_mm(&settings, &comparison);
    let passed = outcome.passed;
    let json = outcome.json();
    if arguments.html.is_some() || arguments.viewer.is_some() {
        let facts = page::Facts {
            input: &wanted_name,
            output: &commanded_name,
            text: &measurement_files::utf8_or_1251(&wanted),
            output_text: &measurement_files::utf8_or_1251(&commanded),
            machine: &settings.profile.name,
            profile: &settings.profile_name,
            profile_hash: &settings.profile_hash.to_string(),
            engine: model.id().name(),
            limit_mm,
            passed,
            findings: &outcome.findings,
            origin: crate::origin::Origin::of(&settings.profile),
            setup: setup(&settings),
        };
        if let Some(path) = &arguments.html {
            let json = String::from_utf8_lossy(&json);
            file::write(path, page::html(&comparison, &facts, &json, messages.language()).as_bytes())?;
        }
        if let Some(path) = &arguments.viewer {
            let program = (wanted_name.as_str(), wanted.as_slice());
            viewer::write(path, program, &comparison, &settings, &facts, (shared, messages))?;
        }
    }
    if arguments.json {
        file::print(&json)?;
    }
    if !arguments.json {
        file::print(outcome.text().in_language(messages.language()).as_bytes())?;
    }
    if passed { Ok(()) } else { Err(Failure::Check) }
}

/// Zeros, tools and where the axes stand: what decides over a program besides its text.
fn setup(settings: &settings::Settings) -> Vec<(String, [f64; 3])> {
    let setup = &settings.setup;
    let mut all: Vec<(String, [f64; 3])> = setup.work_offsets.clone();
    all.extend(setup.tools.iter().map(|(number, length_mm)| (format!("H{number}"), *length_mm)));
    if let [Some(x), Some(y), Some(z)] = setup.start_mm {
        all.push(("--start-at".to_owned(), [x, y, z]));
    }
    all
}
