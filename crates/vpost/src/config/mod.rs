//! `vpost.toml`: options that hold for the programs in its folder and the folders below.
//!
//! The file is found upwards from what a call works on, and what it says becomes the default of the options of that
//! call's command: the command line goes before it, and an option that is added to a command is a key at once.

mod held;
mod read;
mod show;
mod write;

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::PathBuf;

use clap::ArgMatches;

use crate::command_line::{OF_ALL, command, reads};
use crate::file;
use crate::message::{Failure, Report, Source};
pub use held::Held;
pub(crate) use held::{NAME, called};
use held::{above, folder_of};
pub use show::Config;
pub(crate) use show::run;
pub(crate) use write::written;

/// `--config none`
const NONE: &str = "none";

/// What holds for a command line.
///
/// # Errors
/// A file that cannot be read, or that says what no option is.
pub(crate) fn find(arguments: &[OsString]) -> Result<Held, Failure> {
    // Wrong arguments are told when they are read in earnest.
    let root = command();
    let Ok(call) = root.clone().ignore_errors(true).try_get_matches_from(arguments) else {
        return Ok(Held::default());
    };
    let (names, at) = called(&call);
    let names = if names.is_empty() { vec!["correct"] } else { names };
    let first = first_path(&root, &names, at);
    if !reads(&names, "config") || (names == ["correct"] && first.is_none()) {
        return Ok(Held::default());
    }
    let from = first.map_or_else(|| PathBuf::from("."), |path| folder_of(&path));
    let named = at.try_get_one::<PathBuf>("config").ok().flatten();
    let file = match named {
        Some(none) if none.as_os_str() == NONE => None,
        Some(file) => Some(file.clone()),
        None => above(&from),
    };
    let command = names.iter().map(|name| (*name).to_owned()).collect();
    let mut held = Held { file, named: named.is_some(), from, command, kept: Vec::new() };
    let Some(file) = &held.file else { return Ok(held) };
    let bytes = std::fs::read(file).map_err(|error| Failure::unread(&file::name(file), &error))?;
    let source = Source::whole(file::name(file), bytes);
    let mut kept = read::read(&source, file.parent().unwrap_or(file), &root)
        .map_err(|diagnostics| Failure::Usage(vec![Report { source: Some(source), diagnostics }]))?;
    if names != ["config"] {
        kept.retain(|kept| names.starts_with(&kept.names()) && is_read(&root, &names, kept));
        // What stands in the command's own table goes before what holds for all.
        kept.sort_by_key(|kept| std::cmp::Reverse(kept.command.len()));
        let mut said = BTreeSet::new();
        // A flag that is off decides nothing but that.
        kept.retain(|kept| said.insert(kept.id.clone()) && kept.values != ["false"]);
    }
    held.kept = kept;
    Ok(held)
}

/// The command of these names.
fn command_of<'c>(root: &'c clap::Command, names: &[&str]) -> Option<&'c clap::Command> {
    names.iter().try_fold(root, |command, name| command.find_subcommand(name))
}

/// The first file or folder that a call works on.
fn first_path(root: &clap::Command, names: &[&str], at: &ArgMatches) -> Option<PathBuf> {
    let positional = command_of(root, names)?.get_positionals().next()?.get_id().as_str();
    at.try_get_raw(positional).ok().flatten()?.next().map(PathBuf::from)
}

/// The command reads the option, and its table may say it.
fn is_read(root: &clap::Command, names: &[&str], kept: &held::Kept) -> bool {
    let listed = |argument: &clap::Arg| argument.get_id() == kept.id.as_str() && !argument.is_hide_set();
    OF_ALL.contains(&kept.id.as_str())
        || command_of(root, names).is_some_and(|command| command.get_arguments().any(listed))
}
