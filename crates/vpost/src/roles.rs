//! No file in two roles: what is written must not be what is read, nor two things one file.

use std::path::{Path, PathBuf};

use diagnostic::{Code, Text, notice};

use crate::file;
use crate::message::Failure;

/// A file is named in two roles.
const TWO_ROLES: Code = Code(4);

/// The files of one command line.
#[derive(Debug, Default)]
pub(crate) struct Roles<'a> {
    read: Vec<(Text, &'a Path)>,
    /// Read, too.
    found: Vec<(Text, PathBuf)>,
    written: Vec<(&'a str, &'a Path)>,
}

impl<'a> Roles<'a> {
    /// A file that is read, and what for: `the program`.
    pub(crate) fn reads(mut self, role: Text, path: &'a Path) -> Self {
        self.read.push((role, path));
        self
    }

    /// Files that are read for the same.
    pub(crate) fn reads_all(mut self, role: &Text, paths: impl IntoIterator<Item = &'a PathBuf>) -> Self {
        self.read.extend(paths.into_iter().map(|path| (role.clone(), path.as_path())));
        self
    }

    /// The files of folders, where subprograms are looked for.
    pub(crate) fn reads_folders(mut self, role: &Text, folders: &[PathBuf]) -> Self {
        let files = folders.iter().filter_map(|folder| std::fs::read_dir(folder).ok()).flatten();
        self.found.extend(files.filter_map(|entry| Some((role.clone(), entry.ok()?.path()))));
        self
    }

    /// A file that is written, where the option is given: `--summary`.
    pub(crate) fn writes(mut self, option: &'a str, path: Option<&'a Path>) -> Self {
        self.written.extend(path.map(|path| (option, path)));
        self
    }

    /// Refuses a file that is written and read, or written twice, by whatever names.
    ///
    /// # Errors
    /// The refusal of the first.
    pub(crate) fn are_apart(&self) -> Result<(), Failure> {
        let found = self.found.iter().map(|(role, path)| (role, path.as_path()));
        let read = self.read.iter().map(|(role, path)| (role, *path)).chain(found);
        let mut taken: Vec<(Identity, Text)> =
            read.filter_map(|(role, path)| Some((Identity::of(path)?, role.clone()))).collect();
        for (option, path) in &self.written {
            let Some(identity) = Identity::of(path) else { continue };
            if let Some((_, role)) = taken.iter().find(|(other, _)| *other == identity) {
                return Err(Failure::usage(notice!(TWO_ROLES;
                    "{} would be written by `{option}` and is {role}",
                    "{} записал бы ключ `{option}`, но это {role:#}", file::name(path);
                    "give each output a file of its own", "дайте каждому выходному файлу своё имя"
                )));
            }
            taken.push((identity, Text::same(*option)));
        }
        Ok(())
    }
}

/// A file by what it is, not by what it is called.
#[derive(Debug, PartialEq, Eq)]
enum Identity {
    /// A file that is there.
    #[cfg(unix)]
    There((u64, u64)),
    #[cfg(not(unix))]
    There(PathBuf),
    /// Where nothing is yet: folder and name.
    Place(PathBuf),
}

impl Identity {
    /// None for standard streams, pipes and devices: nothing of them is lost.
    fn of(path: &Path) -> Option<Self> {
        if path.as_os_str() == "-" {
            return None;
        }
        if let Ok(found) = path.metadata() {
            if !found.is_file() {
                return None;
            }
            return file::identity(path).map(Self::There);
        }
        let place = file::target(path);
        let folder = std::fs::canonicalize(file::folder_of(&place)).ok()?;
        Some(Self::Place(folder.join(place.file_name()?)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_one_file_are_one_file() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        std::fs::write(place("part.nc"), "G0").unwrap();
        std::fs::hard_link(place("part.nc"), place("hard.nc")).unwrap();
        let part = place("part.nc");
        let mut others = vec![place("part.nc"), place("./part.nc"), place("hard.nc")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("part.nc", place("soft.nc")).unwrap();
            others.push(place("soft.nc"));
        }
        for other in &others {
            let roles =
                Roles::default().reads(Text::same("the program"), &part).writes("--summary", Some(other));
            assert!(roles.are_apart().is_err(), "{}", other.display());
        }
        let (new, again, another) = (place("new.json"), place("./new.json"), place("another.json"));
        fn written<'a>(first: &'a Path, second: &'a Path) -> Roles<'a> {
            Roles::default().writes("-o", Some(first)).writes("--summary", Some(second))
        }
        assert!(written(&new, &again).are_apart().is_err());
        assert!(written(&new, &another).are_apart().is_ok());
        #[cfg(unix)]
        {
            // A link to what is not there yet.
            std::os::unix::fs::symlink("new.json", place("dangling")).unwrap();
            let dangling = place("dangling");
            assert!(written(&new, &dangling).are_apart().is_err());
        }
        let nowhere = Path::new("/dev/null");
        assert!(written(nowhere, nowhere).are_apart().is_ok());
    }
}
