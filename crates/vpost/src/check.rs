//! The closed loop: two programs through the machine model, what they make of the part compared.

mod page;

use std::path::Path;

use diagnostic::both;
use jobs::check::{Outcome, closed, limit_mm};
use path_comparison::Traces;
use rewrite::Checked;

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
        .are_apart()?;
    let model = settings.path_model()?;
    let read = |path: &Path| -> Result<_, Failure> { Ok((file::name(path), file::read_program(path)?)) };
    let (wanted_name, wanted) = read(&arguments.input)?;
    let (commanded_name, commanded) = read(&arguments.output)?;
    let traces = if arguments.html.is_some() { Traces::Kept } else { Traces::Forgotten };
    let progress = Progress::new(messages, None);
    let programs = [(wanted_name.as_str(), wanted.as_slice()), (&commanded_name, &commanded)];
    let Checked { comparison, findings } =
        closed(programs, &settings, traces, &|done| progress.report(done))?;
    progress.end();
    let limit_mm = limit_mm(&settings, &comparison);
    let outcome = Outcome::new(&settings, &comparison, findings);
    let passed = outcome.passed;
    let findings: Vec<String> = outcome.findings.iter().map(|finding| finding.english().to_owned()).collect();
    if arguments.json || arguments.html.is_some() {
        let text = outcome.json();
        if let Some(path) = &arguments.html {
            let facts = page::Facts {
                input: &wanted_name,
                output: &commanded_name,
                text: &measurement_files::utf8_or_1251(&wanted),
                machine: &settings.profile.name,
                profile: &settings.profile_name,
                profile_hash: &settings.profile_hash.to_string(),
                engine: model.id().name(),
                limit_mm,
                passed,
                findings: &findings,
            };
            let json = String::from_utf8_lossy(&text);
            file::write(path, page::html(&comparison, &facts, &json).as_bytes())?;
        }
        if arguments.json {
            file::print(&text)?;
        }
    }
    if !arguments.json {
        file::print(outcome.text().in_language(messages.language()).as_bytes())?;
    }
    if passed { Ok(()) } else { Err(Failure::Check) }
}
