//! What stands in the wrong place: a table where a program is asked for, a pattern that no shell expanded, a command
//! that is misspelt. By name alone: what is in a file its reader says.

use std::ffi::OsString;
use std::io::ErrorKind as FileError;
use std::path::Path;

use clap::error::{ContextKind, ContextValue, ErrorKind};
use diagnostic::{Code, Diagnostic, Text, both, closest, notice};

use crate::batch::ENDINGS;
use crate::file;
use crate::message::{Deed, Failure, Report, file_diagnostic};

/// What is given is something else than what is asked for there.
const MISTAKEN: Code = Code(8);

/// The command that was meant, where none has the name that was typed.
pub(crate) fn command(root: &clap::Command, arguments: &[OsString]) -> Option<clap::Error> {
    let typed = main_program(root, arguments)?;
    if Path::new(&typed).exists() || typed.contains(['.', '/', '\\']) {
        return None;
    }
    let near = closest(&typed, root.get_subcommands().map(clap::Command::get_name))?;
    let mut error = clap::Error::new(ErrorKind::InvalidSubcommand).with_cmd(root);
    error.insert(ContextKind::InvalidSubcommand, ContextValue::String(typed.clone()));
    error.insert(ContextKind::SuggestedSubcommand, ContextValue::Strings(vec![near.to_owned()]));
    Some(error)
}

/// The program of a call of the main job, however wrong the rest is.
fn main_program(root: &clap::Command, arguments: &[OsString]) -> Option<String> {
    let loose = root.clone().ignore_errors(true).try_get_matches_from(arguments).ok()?;
    let at = match loose.subcommand() {
        None => &loose,
        Some(("correct", at)) => at,
        Some(_) => return None,
    };
    at.try_get_raw("input").ok().flatten()?.next().map(|typed| typed.to_string_lossy().into_owned())
}

/// More programs than one where one is corrected: a shell expands `*.nc` to that.
pub(crate) fn programs(error: &clap::Error, root: &clap::Command, arguments: &[OsString]) -> Option<Failure> {
    let Some(ContextValue::String(second)) = error.get(ContextKind::InvalidArg) else { return None };
    if error.kind() != ErrorKind::UnknownArgument || second.starts_with('-') {
        return None;
    }
    let first = main_program(root, arguments)?;
    Some(Failure::usage(notice!(MISTAKEN;
        "one program is corrected at a time, and `{second}` stands behind `{first}`",
        "за раз исправляется одна программа, а за `{first}` стоит `{second}`";
        "many: `vpost batch {first} {second} … -m PROFILE -O corrected`",
        "несколько: `vpost batch {first} {second} … -m PROFILE -O corrected`"
    )))
}

/// How many programs a path may name.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Asked {
    Program,
    Many,
}

/// Refuses what by its name is no program.
pub(crate) fn program(path: &Path, asked: Asked) -> Result<(), Failure> {
    let name = file::name(path);
    let (message, help) = match kind(path) {
        _ if path.as_os_str() == "-" => return Ok(()),
        Kind::Pattern => {
            let (folder, pattern) = name.rsplit_once(['/', '\\']).unwrap_or((".", name.as_str()));
            (
                both!(
                    "{name} is a pattern, and no shell has expanded it",
                    "{name} — шаблон, и оболочка его не раскрыла"
                ),
                Text::same(format!("`vpost batch {folder} --pattern \"{pattern}\" -m PROFILE -O corrected`")),
            )
        }
        Kind::Missing => {
            let told = |diagnostic| Failure::File(Report { source: None, diagnostics: vec![diagnostic] });
            return near(path).map_or(Ok(()), |diagnostic| Err(told(diagnostic)));
        }
        Kind::Folder if asked == Asked::Program => (
            both!("{name} is a folder", "{name} — папка"),
            both!(
                "all programs in it: `vpost batch {name} -m PROFILE -O corrected`",
                "все программы в ней: `vpost batch {name} -m PROFILE -O corrected`"
            ),
        ),
        Kind::Toml => (
            both!(
                "{name} is no program but a profile or a table",
                "{name} — не программа, а профиль или таблица"
            ),
            both!(
                "the profile goes behind -m: `vpost part.nc -m {name}`",
                "профиль пишется за -m: `vpost part.nc -m {name}`"
            ),
        ),
        Kind::Table => (
            both!("{name} is no program but a table", "{name} — не программа, а таблица"),
            both!(
                "points: `vpost predict {name} -m PROFILE`; measurements: `vpost diagnose {name} -m PROFILE`",
                "точки: `vpost predict {name} -m PROFILE`; измерения: `vpost diagnose {name} -m PROFILE`"
            ),
        ),
        Kind::Folder | Kind::Program | Kind::Other => return Ok(()),
    };
    Err(Failure::asks(MISTAKEN, message, help))
}

/// Refuses what by its name is no profile.
pub(crate) fn profile(path: &Path) -> Result<(), Failure> {
    let name = file::name(path);
    let (what, way) = match kind(path) {
        Kind::Missing => return near(path).map_or(Ok(()), |diagnostic| Err(Failure::usage(diagnostic))),
        Kind::Program => (
            both!("a program", "программа"),
            both!(
                "the program goes in front: `vpost {name} -m PROFILE.toml`",
                "программа пишется впереди: `vpost {name} -m PROFILE.toml`"
            ),
        ),
        Kind::Table => (
            both!("a table", "таблица"),
            both!(
                "give the profile that names it, or make one: `vpost profile new`, `vpost calibrate`",
                "дайте профиль, который её называет, или создайте его: `vpost profile new`, `vpost calibrate`"
            ),
        ),
        Kind::Folder if path.with_extension("toml").is_file() => {
            (both!("a folder", "папка"), both!("did you mean {name}.toml?", "имелось в виду {name}.toml?"))
        }
        _ => return Ok(()),
    };
    Err(Failure::usage(notice!(MISTAKEN;
        "{name} is no profile but {what}", "{name} — не профиль, а {what:#}";
        way
    )))
}

/// What a path is by its name.
enum Kind {
    Missing,
    Pattern,
    Folder,
    Program,
    Toml,
    Table,
    Other,
}

fn kind(path: &Path) -> Kind {
    let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
    let of = |known: &[&str]| known.iter().any(|known| ending == *known);
    match path.metadata() {
        Err(error) if error.kind() == FileError::NotFound && path.to_string_lossy().contains(['*', '?']) => {
            Kind::Pattern
        }
        Err(error) if error.kind() == FileError::NotFound => Kind::Missing,
        Ok(found) if found.is_dir() => Kind::Folder,
        _ if of(&["toml"]) => Kind::Toml,
        _ if of(&["csv", "tsv", "xlsx", "ods"]) => Kind::Table,
        _ if of(&ENDINGS) => Kind::Program,
        _ => Kind::Other,
    }
}

/// There is no such file, and one whose name is nearly so.
fn near(path: &Path) -> Option<Diagnostic> {
    let entries = std::fs::read_dir(file::folder_of(path)).ok()?.flatten();
    let names: Vec<String> = entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    let near = closest(&path.file_name()?.to_string_lossy(), names.iter().map(String::as_str))?;
    let near = file::name(&path.with_file_name(near));
    let absent = std::fs::File::open(path).err()?;
    let diagnostic = file_diagnostic(&Text::same(file::name(path)), Deed::Read, &absent);
    Some(diagnostic.help(both!("did you mean {near}?", "имелось в виду {near}?")))
}
