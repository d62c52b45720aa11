//! `vpost.toml`: options that hold for the programs in its folder and the folders below.
//!
//! The file is found upwards from what a call works on, and what it says becomes the default of the options of that
//! call's command: the command line goes before it, and an option that is added to a command is a key at once.

mod read;
mod show;

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};

use clap::ArgMatches;
use diagnostic::{Code, Text, both};

use crate::command_line::{OF_ALL, command, reads};
use crate::file;
use crate::message::{Deed, Failure, Report, Source, notice};
use crate::summary::SettingsFile;
pub(crate) use read::Kept;
pub use show::Config;
pub(crate) use show::run;

/// Programs of one call lie under different settings files.
const TWO_FILES: Code = Code(7);

/// What the file is called.
const NAME: &str = "vpost.toml";

/// `--config none`
const NONE: &str = "none";

/// What settings files say for one call.
#[derive(Debug, Clone, Default)]
pub struct Held {
    /// The file, where there is one.
    pub(crate) file: Option<PathBuf>,
    /// The call names it, or says that none is to hold.
    named: bool,
    /// From where it was looked for.
    from: PathBuf,
    /// The command of the call, by its names from the first on.
    command: Vec<String>,
    /// What it says to that command; to `vpost config`, all.
    pub(crate) kept: Vec<Kept>,
}

impl Held {
    /// What holds for a command line.
    ///
    /// # Errors
    /// A file that cannot be read, or that says what no option is.
    pub fn find(arguments: &[OsString]) -> Result<Self, Failure> {
        // Wrong arguments are told when they are read in earnest.
        let Ok(call) = command().ignore_errors(true).try_get_matches_from(arguments) else {
            return Ok(Self::default());
        };
        let (names, at) = called(&call);
        let names = if names.is_empty() { vec!["correct"] } else { names };
        let root = command();
        let first = first_path(&root, &names, at);
        if !reads(&names, "config") || (names == ["correct"] && first.is_none()) {
            return Ok(Self::default());
        }
        let from = first.map_or_else(|| PathBuf::from("."), |path| folder_of(&path));
        let named = at.try_get_one::<PathBuf>("config").ok().flatten();
        let file = match named {
            Some(none) if none.as_os_str() == NONE => None,
            Some(file) => Some(std::path::absolute(file).map_err(file::fails(file, Deed::Read))?),
            None => above(&from),
        };
        let command = names.iter().map(|name| (*name).to_owned()).collect();
        let mut held = Self { file, named: named.is_some(), from, command, kept: Vec::new() };
        let Some(file) = &held.file else { return Ok(held) };
        let bytes = std::fs::read(file).map_err(|error| Failure::unread(&file::name(file), &error))?;
        let source = Source::whole(file::name(file), bytes);
        let mut kept = read::read(&source, file::folder_of(file), &root)
            .map_err(|diagnostics| Failure::Usage(vec![Report { source: Some(source), diagnostics }]))?;
        if names != ["config"] {
            kept.retain(|kept| names.starts_with(&kept.names()) && is_read(&root, &names, kept));
            // What stands in the command's own table goes before what holds for all.
            kept.sort_by_key(|kept| std::cmp::Reverse(kept.command.len()));
            let mut said = BTreeSet::new();
            kept.retain(|kept| said.insert(kept.id.clone()));
        }
        held.kept = kept;
        Ok(held)
    }

    /// The command line with what the file says as defaults of its options.
    pub(crate) fn applied(&self, root: clap::Command) -> clap::Command {
        fn put(command: clap::Command, below: &[String], kept: &Kept) -> clap::Command {
            let reads = command.get_arguments().any(|argument| argument.get_id() == kept.id.as_str());
            let said = |argument: clap::Arg| argument.default_values(&kept.values).required(false);
            let command = if reads { command.mut_arg(&kept.id, said) } else { command };
            match below {
                [first, rest @ ..] => command.mut_subcommand(first, |inner| put(inner, rest, kept)),
                [] => command,
            }
        }
        if self.command == ["config"] {
            return root;
        }
        self.kept.iter().fold(root, |root, kept| put(root, &self.command, kept))
    }

    /// The file says this option to this call.
    pub(crate) fn says(&self, id: &str) -> bool {
        self.kept.iter().any(|kept| kept.id == id)
    }

    /// The file and what of it holds, for a summary.
    pub(crate) fn of_summary(&self) -> Option<SettingsFile<'_>> {
        let file = self.file.as_deref().filter(|_| !self.kept.is_empty())?;
        let options = self.kept.iter().map(|kept| (kept.option.as_str(), kept.values.as_slice())).collect();
        Some(SettingsFile { file: file::name(file), options })
    }

    /// That a file was found, and what of it holds: what nobody typed is said.
    pub(crate) fn note(&self) -> Option<Text> {
        let file = self.file.as_deref().filter(|_| !self.kept.is_empty() && self.command != ["config"])?;
        let options: Vec<&str> = self.kept.iter().map(|kept| kept.option.as_str()).collect();
        Some(both!("settings from {}: {}", "настройки из {}: {}", file::name(file), options.join(", ")))
    }

    /// Refuses programs that lie under another settings file than the one that holds.
    ///
    /// # Errors
    /// The first such.
    pub(crate) fn is_of_all<'p>(&self, programs: impl IntoIterator<Item = &'p Path>) -> Result<(), Failure> {
        if self.named {
            return Ok(());
        }
        let folders: BTreeSet<PathBuf> = programs.into_iter().map(folder_of).collect();
        let Some(other) = folders.iter().find(|folder| above(folder) != self.file) else { return Ok(()) };
        let shown = |file: Option<PathBuf>| {
            file.map_or(both!("no settings file", "без файла настроек"), |file| {
                Text::same(file::name(&file))
            })
        };
        Err(Failure::usage(notice!(TWO_FILES;
            "settings differ: {} for this call, {} for programs in {}",
            "настройки разные: {0:#} для этого вызова, {1:#} для программ в {2}",
            shown(self.file.clone()), shown(above(other)), other.display();
            "run vpost for each folder, or say which file holds: `--config FILE`, `--config none`",
            "запустите vpost для каждой папки или скажите, какой файл действует: `--config FILE`, `--config none`"
        )))
    }
}

/// The command of a call, by its names, and its own matches.
pub(crate) fn called(call: &ArgMatches) -> (Vec<&str>, &ArgMatches) {
    let (mut names, mut at) = (Vec::new(), call);
    while let Some((name, inner)) = at.subcommand() {
        names.push(name);
        at = inner;
    }
    (names, at)
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
fn is_read(root: &clap::Command, names: &[&str], kept: &Kept) -> bool {
    let listed = |argument: &clap::Arg| argument.get_id() == kept.id.as_str() && !argument.is_hide_set();
    OF_ALL.contains(&kept.id.as_str())
        || command_of(root, names).is_some_and(|command| command.get_arguments().any(listed))
}

/// The folder that settings of a file or folder are looked for in, its links followed: the current one for a stream.
fn folder_of(path: &Path) -> PathBuf {
    let folder = match path {
        stream if stream.as_os_str() == "-" => Path::new("."),
        folder if folder.is_dir() => folder,
        file => file::folder_of(file),
    };
    folder.to_owned()
}

/// The nearest settings file in a folder or above it.
fn above(folder: &Path) -> Option<PathBuf> {
    let folder = folder.canonicalize().ok()?;
    folder.ancestors().map(|folder| folder.join(NAME)).find(|file| file.symlink_metadata().is_ok())
}
