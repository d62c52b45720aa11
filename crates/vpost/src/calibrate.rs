//! `vpost calibrate`: from an instrument's files to a machine profile.

use diagnostic::both;
pub use jobs::calibrate::Calibrate;
use jobs::calibrate::{NewProfile, Said, Setting, of};

use crate::arguments::Shared;
use crate::file;
use crate::message::{Deed, Failure, Messages};
use crate::origin::command;
use crate::roles::Roles;

/// `vpost calibrate INSTRUMENT FILES… -o PROFILE`
pub(crate) fn run(arguments: &Calibrate, shared: &Shared, messages: &Messages) -> Result<(), Failure> {
    let files = arguments.command.files();
    let roles = Roles::default().reads_all(&both!("a measurement", "измерения"), &files);
    let results = arguments.command.results().into_iter();
    results.fold(roles, |roles, (option, path)| roles.writes(option, path)).are_apart()?;
    let setting = Setting {
        options: &shared.job,
        read: &file::read,
        language: messages.language(),
        command: Some(command()),
    };
    let made = of(&arguments.command, &setting);
    for said in &made.said {
        match said {
            Said::Result(text) => file::print(text.in_language(messages.language()).as_bytes())?,
            Said::Warning(report) => messages.report(report),
        }
    }
    if let Some(profile) = &made.profile {
        write(profile, messages)?;
    }
    for (path, bytes) in &made.results {
        file::write(path, bytes)?;
    }
    made.refused.map_or(Ok(()), Err)
}

/// Writes the tables, then the profile.
fn write(profile: &NewProfile, messages: &Messages) -> Result<(), Failure> {
    let NewProfile { path, folder, .. } = profile;
    std::fs::create_dir_all(folder).map_err(file::fails(folder, Deed::Make))?;
    for (name, bytes) in &profile.tables {
        file::write(&folder.join(name), bytes)?;
    }
    file::write(path, profile.text.as_bytes())?;
    messages.note(&both!(
        "{}: written, tables in {}",
        "{}: записан, таблицы в {}",
        file::name(path),
        file::name(folder)
    ));
    Ok(())
}
