//! Which programs there are, and where each correction goes.

use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::fs::DirEntry;
use std::path::{Path, PathBuf};

use diagnostic::{Code, notice};
use glob::{MatchOptions, Pattern};

use super::arguments::Programs;
use super::folder;
use crate::file;
use crate::message::{Deed, Failure, OPTION};

/// No program was found.
const NONE_FOUND: Code = Code(1001);
/// Two programs would be written to one place.
const COLLISION: Code = Code(1002);
/// A correction would be written over a program.
const ONTO_INPUT: Code = Code(1003);
/// A name that JSON cannot hold.
const NAME: Code = Code(1004);

/// What part programs are called, from many shops' folders.
pub(crate) const ENDINGS: [&str; 16] = [
    "nc", "ngc", "cnc", "tap", "mpf", "spf", "ptp", "min", "eia", "iso", "gcode", "gc", "ncc", "fnc", "din",
    "g",
];

/// A program to correct.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Item {
    /// Where it is.
    pub input: PathBuf,
    /// Where its correction goes: below the output folder, with `/` between folders.
    pub output: String,
    /// Its size when it was found.
    pub bytes: u64,
    /// What it must hold, where a manifest says so.
    pub blake3: Option<String>,
}

/// Programs in the order of their outputs, and what was passed over.
#[derive(Debug, Default)]
pub(crate) struct Found {
    pub items: Vec<Item>,
    /// What was passed over: files of other endings, where no `--pattern` chooses, and what is neither file nor folder.
    pub others: Vec<PathBuf>,
    /// Links to folders.
    pub links: Vec<PathBuf>,
    /// Folders that another batch wrote.
    pub outputs: Vec<PathBuf>,
}

/// Finds the programs.
///
/// Folders are searched with all folders in them. Passed over in silence: hidden files and folders (a name that
/// starts with a point), what `--exclude` names, and the output folder itself. Corrected copies are no programs: an
/// output folder of another run is passed over, too, unless it is the one that is named. A file that is named is taken
/// whatever its name.
pub(crate) fn find(programs: &Programs, output: &Path) -> Result<Found, Failure> {
    let found = search(programs, output)?;
    if found.items.is_empty() {
        let others = found.others.len();
        return Err(Failure::usage(notice!(NONE_FOUND;
            "no program was found; {others} other files were",
            "программ не найдено, а прочих файлов: {others}";
            "programs are files that end in .{}; others: `--pattern \"*.txt\"`, or name the files",
            "программы — файлы с расширением .{}; другие: `--pattern \"*.txt\"` или назовите файлы",
            ENDINGS.join(" .")
        )));
    }
    Ok(found)
}

/// The same where there may be none yet.
pub(crate) fn search(programs: &Programs, output: &Path) -> Result<Found, Failure> {
    let search = Search {
        patterns: patterns("--pattern", &programs.pattern)?,
        exclude: patterns("--exclude", &programs.exclude)?,
        output: output.canonicalize().ok(),
    };
    let mut found = Found::default();
    for input in &programs.inputs {
        let data = input.metadata().map_err(|error| Failure::unread(&file::name(input), &error))?;
        if data.is_dir() {
            let entries = entries_of(input).map_err(file::fails(input, Deed::Read))?;
            search.folder(entries, Path::new(""), &mut found)?;
        } else {
            let name = input.file_name().map(Path::new).unwrap_or(input);
            found.items.push(item(input.clone(), name, data.len()));
        }
    }
    found.items.sort_by(|a, b| a.output.cmp(&b.output).then_with(|| a.input.cmp(&b.input)));
    found.items.dedup();
    for passed_over in [&mut found.others, &mut found.links, &mut found.outputs] {
        passed_over.sort();
    }
    check_places(&found.items, output)?;
    Ok(found)
}

struct Search {
    patterns: Vec<Pattern>,
    exclude: Vec<Pattern>,
    output: Option<PathBuf>,
}

impl Search {
    /// `below`: the folder's path from the one that was named.
    fn folder(&self, entries: Vec<DirEntry>, below: &Path, found: &mut Found) -> Result<(), Failure> {
        for entry in entries {
            let name = entry.file_name();
            let path = entry.path();
            let below = below.join(&name);
            if name.as_encoded_bytes().starts_with(b".") || matches(&self.exclude, &below) {
                continue;
            }
            let kind = entry.file_type().map_err(file::fails(&path, Deed::Read))?;
            if kind.is_dir() {
                if self.output.is_some() && path.canonicalize().ok() == self.output {
                    continue;
                }
                match entries_of(&path) {
                    Ok(_) if folder::is_output(&path) => found.outputs.push(path),
                    Ok(entries) => self.folder(entries, &below, found)?,
                    // As a program that is missing: reading it says why, and the others are corrected.
                    Err(_) => found.items.push(item(path, &below, 0)),
                }
                continue;
            }
            // A link may lead to a file. Links to folders may lead in circles.
            let data = if kind.is_symlink() { path.metadata() } else { entry.metadata() };
            match data {
                Ok(data) if data.is_file() && self.is_program(&below) => {
                    found.items.push(item(path, &below, data.len()));
                }
                // A link that leads nowhere is a program that is missing: reading it says so.
                Err(_) if self.is_program(&below) => found.items.push(item(path, &below, 0)),
                Ok(data) if data.is_file() && !self.patterns.is_empty() => {}
                Ok(data) if data.is_dir() => found.links.push(path),
                _ => found.others.push(path),
            }
        }
        Ok(())
    }

    fn is_program(&self, below: &Path) -> bool {
        if !self.patterns.is_empty() {
            return matches(&self.patterns, below);
        }
        let ending = below.extension().unwrap_or_default();
        ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known))
    }
}

/// What is in a folder, by name.
fn entries_of(folder: &Path) -> std::io::Result<Vec<DirEntry>> {
    let mut entries = std::fs::read_dir(folder)?.collect::<Result<Vec<_>, _>>()?;
    entries.sort_by_key(DirEntry::file_name);
    Ok(entries)
}

/// Capital letters or not: controls and shares do not agree on them.
const MATCHING: MatchOptions = MatchOptions {
    case_sensitive: false,
    require_literal_separator: true,
    require_literal_leading_dot: false,
};

/// A pattern with a `/` is one of the path below the folder, others are of the name.
fn matches(patterns: &[Pattern], below: &Path) -> bool {
    patterns.iter().any(|pattern| {
        let whole = pattern.as_str().contains('/');
        let subject = if whole { Some(below) } else { below.file_name().map(Path::new) };
        subject.is_some_and(|path| pattern.matches_path_with(path, MATCHING))
    })
}

fn patterns(option: &str, given: &[String]) -> Result<Vec<Pattern>, Failure> {
    let parse = |text: &String| {
        Pattern::new(text).map_err(|error| {
            Failure::usage(notice!(OPTION;
                "`{option} {text}` is no pattern: {}", "`{option} {text}` — не шаблон: {}", error.msg;
                "write as for the shell, in quotes: `{option} \"*.nc\"`, `{option} \"fixtures/**/*.nc\"`",
                "пишите как для оболочки, в кавычках: `{option} \"*.nc\"`, `{option} \"fixtures/**/*.nc\"`"
            ))
        })
    };
    given.iter().map(parse).collect()
}

fn item(input: PathBuf, below: &Path, bytes: u64) -> Item {
    let parts: Vec<_> = below.iter().map(OsStr::to_string_lossy).collect();
    Item { output: parts.join("/"), input, bytes, blake3: None }
}

impl Item {
    /// False where the name is no UTF-8: then `output` only resembles it, and nothing can be written there.
    fn has_name(&self) -> bool {
        self.input.to_str().is_some()
    }

    /// Refuses a program whose name no result could carry.
    pub(crate) fn needs_name(&self) -> Result<(), Failure> {
        if self.has_name() {
            return Ok(());
        }
        // Shown as it is, one such name looks like another.
        let read = measurement_files::utf8_or_1251(self.input.as_os_str().as_encoded_bytes());
        Err(Failure::usage(notice!(NAME;
            "a name is not UTF-8; as Windows-1251 it reads {read}",
            "имя не в UTF-8; в Windows-1251 оно читается как {read}";
            "results are listed by name: rename it, for example with `convmv -f cp1251 -t utf8 --notest`",
            "результаты перечисляются по именам: переименуйте, например командой `convmv -f cp1251 -t utf8 --notest`"
        )))
    }
}

/// Every output has a place of its own, and none is a program's.
fn check_places(items: &[Item], output: &Path) -> Result<(), Failure> {
    let named = || items.iter().filter(|item| item.has_name());
    // Letters' case counts for nothing on the shares that most controls read.
    let mut places: BTreeMap<String, &Item> = BTreeMap::new();
    for item in named() {
        if let Some(other) = places.insert(item.output.to_lowercase(), item) {
            return Err(collision(other, item, output));
        }
    }
    for item in named() {
        let place = item.output.to_lowercase();
        let mut folders = place.match_indices('/').map(|(at, _)| &place[..at]);
        if let Some(other) = folders.find_map(|folder| places.get(folder)) {
            return Err(collision(other, item, output));
        }
    }
    if !output.exists() {
        return Ok(());
    }
    let inputs: BTreeMap<_, &Item> =
        items.iter().filter_map(|item| Some((file::identity(&item.input)?, item))).collect();
    for item in named() {
        let place = output.join(&item.output);
        if let Some(input) = file::identity(&place).and_then(|place| inputs.get(&place)) {
            return Err(Failure::usage(notice!(ONTO_INPUT;
                "the correction of {} would be written over {}",
                "исправление {} легло бы поверх {}", item.input.display(), input.input.display();
                "give a folder of its own: `-O corrected`", "дайте отдельную папку: `-O corrected`"
            )));
        }
    }
    Ok(())
}

fn collision(a: &Item, b: &Item, output: &Path) -> Failure {
    Failure::usage(notice!(COLLISION;
        "{} and {} would both be written to {}",
        "{} и {} попали бы в одно место: {}", a.input.display(), b.input.display(),
        output.join(&a.output).display();
        "name the folder above both instead of the files, or run vpost once for each `-O`",
        "вместо файлов назовите папку над обоими или запустите vpost для каждого со своим `-O`"
    ))
}
