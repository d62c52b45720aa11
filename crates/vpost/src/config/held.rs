//! What a settings file says for one call, and what follows from it.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::ArgMatches;
use diagnostic::{Code, Text, both, notice};

use crate::file;
use crate::message::Failure;
use crate::summary::SettingsFile;

/// Programs of one call lie under different settings files.
const TWO_FILES: Code = Code(7);

/// What the file is called.
pub(crate) const NAME: &str = "vpost.toml";

/// An option, as the file says it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Kept {
    /// The command whose table it stands in, by its names from the first on; none for every command.
    pub command: Vec<String>,
    /// Its long name.
    pub option: String,
    /// Its name in clap.
    pub id: String,
    /// As they would be typed; paths from the file's folder on.
    pub values: Vec<String>,
    /// Where it stands in the file, from 1.
    pub line: usize,
}

impl Kept {
    /// The command whose table it stands in.
    pub(super) fn names(&self) -> Vec<&str> {
        self.command.iter().map(String::as_str).collect()
    }
}

/// What settings files say for one call.
#[derive(Debug, Clone, Default)]
pub struct Held {
    /// The file, where there is one.
    pub(crate) file: Option<PathBuf>,
    /// The call names it, or says that none is to hold.
    pub(super) named: bool,
    /// From where it was looked for.
    pub(super) from: PathBuf,
    /// The command of the call, by its names from the first on.
    pub(super) command: Vec<String>,
    /// What it says to that command; to `vpost config`, all.
    pub(crate) kept: Vec<Kept>,
}

impl Held {
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

    /// That a file was found, and what of it holds, on which line: what nobody typed is said before the work finds
    /// fault with it.
    pub(crate) fn note(&self) -> Option<Text> {
        let file = self.file.as_deref().filter(|_| !self.kept.is_empty() && self.command != ["config"])?;
        let options = |line: &str| {
            let options = self.kept.iter().map(|kept| format!("{} ({line} {})", kept.option, kept.line));
            options.collect::<Vec<String>>().join(", ")
        };
        let (english, russian) = (options("line"), options("строка"));
        let file = file::name(file);
        Some(both!("settings from {file}: {english}", "настройки из {file}: {russian}"))
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

/// The folder that settings of a file or folder are looked for in, its links followed: the current one for a stream.
pub(super) fn folder_of(path: &Path) -> PathBuf {
    let folder = match path {
        stream if stream.as_os_str() == "-" => Path::new("."),
        folder if folder.is_dir() => folder,
        file => file::folder_of(file),
    };
    folder.to_owned()
}

/// The nearest settings file in a folder or above it.
pub(super) fn above(folder: &Path) -> Option<PathBuf> {
    let folder = match folder.canonicalize() {
        // In a page every folder is below the one that the command works in.
        Err(error) if error.kind() == std::io::ErrorKind::Unsupported => folder.to_owned(),
        found => found.ok()?,
    };
    // A link to nothing is a file that cannot be read; a folder of that name is none.
    let is_file = |file: &PathBuf| file.symlink_metadata().is_ok() && !file.is_dir();
    let file = folder.ancestors().map(|folder| folder.join(NAME)).find(is_file)?;
    // As it would be named from here, where it is below.
    let here = std::env::current_dir().and_then(|here| here.canonicalize()).ok();
    let short = here.and_then(|here| file.strip_prefix(here).ok().map(Path::to_owned));
    Some(short.unwrap_or(file))
}
