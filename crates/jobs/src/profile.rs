//! A machine profile from disk.

use std::path::{Path, PathBuf};

use diagnostic::{Code, notice, refusal};
use machine_profile::{Profile, ProfileError};

use crate::lines;
use crate::message::{Failure, OPTION, Report, Source};

/// A profile and the bytes it was made from.
pub struct Loaded {
    /// The machine.
    pub profile: Profile,
    /// Hash of the profile and of every table it names, in the order they were read.
    pub hash: blake3::Hash,
    /// The profile and the tables.
    pub files: Vec<PathBuf>,
}

/// Reads the profile of a mill: what a command that knows points of space takes.
///
/// # Errors
/// What is wrong with it; it is a lathe's.
pub fn load_mill(path: &Path) -> Result<Loaded, Failure> {
    let loaded = load(path)?;
    match &loaded.profile.lathe {
        None => Ok(loaded),
        Some(lathe) => Err(Failure::usage(notice!(OPTION;
            "{} is the profile of a lathe, {}",
            "{} — профиль токарного станка, {}", lines::name(path), lathe.chain;
            "of lathes `vpost correct`, `batch`, `check`, `predict --lathe PROGRAM`, `calibrate turning`, `diagnose` and `profile export` know",
            "токарные станки знают `vpost correct`, `batch`, `check`, `predict --lathe PROGRAM`, `calibrate turning`, `diagnose` и `profile export`"
        ))),
    }
}

/// Reads a profile and the tables it names; everything wrong with them is one failure.
///
/// # Errors
/// That.
pub fn load(path: &Path) -> Result<Loaded, Failure> {
    let bytes = std::fs::read(path).map_err(|error| Failure::unread(&lines::name(path), &error))?;
    loaded(path, &bytes)
}

/// The same of a profile whose bytes stand at a path, or will.
///
/// # Errors
/// Everything wrong with it and its tables.
pub fn loaded(path: &Path, bytes: &[u8]) -> Result<Loaded, Failure> {
    let source = |name: &str, bytes: &[u8]| Some(Source::whole(name, bytes));
    let name = lines::name(path);
    let Ok(text) = std::str::from_utf8(bytes) else {
        let at = std::str::from_utf8(bytes).err().map_or(0, |error| error.valid_up_to()) as u64;
        let diagnostic = refusal!(Code(301);
            "a profile is UTF-8 text", "профиль — текст в UTF-8";
            "this byte is not", "а этот байт — нет";
            "save it as UTF-8, or give the profile, not the program, to -m",
            "сохраните его в UTF-8 или дайте в -m профиль, а не программу"
        )
        .at(at..at + 1);
        return Err(Failure::Usage(vec![Report {
            source: source(&name, bytes),
            diagnostics: vec![diagnostic],
        }]));
    };
    let folder = path.parent().map_or_else(PathBuf::new, Path::to_path_buf);
    let hasher = std::cell::RefCell::new(blake3::Hasher::new());
    hasher.borrow_mut().update(bytes);
    let files = std::cell::RefCell::new(vec![path.to_owned()]);
    let read = |table: &str| {
        let table = folder.join(table);
        let bytes = std::fs::read(&table)?;
        files.borrow_mut().push(table);
        hasher.borrow_mut().update(&bytes);
        Ok(bytes)
    };
    match machine_profile::load(text, &read) {
        Ok(profile) => {
            Ok(Loaded { profile, hash: hasher.into_inner().finalize(), files: files.into_inner() })
        }
        Err(errors) => Err(Failure::Usage(
            some_of(errors)
                .into_iter()
                .map(|ProfileError { file, diagnostic }| {
                    let source = match file {
                        None => source(&name, bytes),
                        Some(table) => {
                            let path = folder.join(&table);
                            let bytes = std::fs::read(&path).unwrap_or_default();
                            source(&path.display().to_string(), measurement_files::decoded(&bytes).as_bytes())
                        }
                    };
                    Report { source, diagnostics: vec![diagnostic] }
                })
                .collect(),
        )),
    }
}

/// No more errors of a profile are told: who mends these sees the rest.
const MOST_TOLD: usize = 20;

/// The first errors, and how many more there are.
fn some_of(mut errors: Vec<ProfileError>) -> Vec<ProfileError> {
    if let Some(next) = errors.get(MOST_TOLD) {
        let more = errors.len() - MOST_TOLD;
        let diagnostic = notice!(next.diagnostic.code;
            "and {more} more errors of this profile", "и ещё ошибки этого профиля: {more}";
            "mend those above first", "исправьте сначала те, что выше"
        );
        errors.truncate(MOST_TOLD);
        errors.push(ProfileError { file: None, diagnostic });
    }
    errors
}
