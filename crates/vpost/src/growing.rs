//! A file on its way to its place: whole under its final name, or not there at all.

use std::fs::{File, Metadata};
use std::io::{self, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// What an output is written to.
pub(crate) trait Growing: Write + Send {
    /// Starts anew.
    fn clear(&mut self) -> io::Result<()>;
}

/// A folder that files grow in, of the file system of their places.
#[derive(Debug)]
pub(crate) struct Nursery {
    path: PathBuf,
    /// Open, where files need no name in it: its path is not walked for each of them.
    opened: Option<File>,
}

/// A file that grows.
#[derive(Debug)]
pub(crate) enum GrowingFile {
    /// It has no name yet: however the process ends, nothing is left of it. And making one enters no folder, which
    /// takes the kernel less and makes no thread wait for another.
    Nameless(File),
    /// Elsewhere it has one that is nobody's.
    Named(NamedTempFile),
}

/// Names of files that are in no place yet.
const PREFIX: &str = ".vpost-";
/// So many letters and digits by chance stand behind it.
const RANDOM: usize = 6;

impl Nursery {
    /// A folder that is there.
    pub(crate) fn new(path: PathBuf) -> Self {
        // A file without a name may have to get one by way of its descriptor's.
        let opened = Path::new("/proc/self/fd").is_dir().then(|| File::open(&path).ok()).flatten();
        Self { path, opened }
    }

    /// Its path.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// An empty file, with the owner and the permissions of the `old` one where there is one, else the usual ones.
    pub(crate) fn file(&self, old: Option<&Metadata>) -> io::Result<GrowingFile> {
        let grown = match self.opened.as_ref().and_then(nameless) {
            Some(file) => GrowingFile::Nameless(file),
            None => {
                let mut builder = tempfile::Builder::new();
                for_everybody(builder.prefix(PREFIX).rand_bytes(RANDOM));
                let named = builder.tempfile_in(&self.path)?;
                // Where files cannot be locked, nothing is swept either.
                let _ = named.as_file().try_lock();
                GrowingFile::Named(named)
            }
        };
        if let Some(old) = old {
            #[cfg(unix)]
            {
                use std::os::unix::fs::MetadataExt;
                // Who may not give files away keeps them.
                let _ = std::os::unix::fs::fchown(grown.file(), Some(old.uid()), Some(old.gid()));
            }
            // Not when it is made: the mask of new files is none of an old one's.
            grown.file().set_permissions(old.permissions())?;
        }
        Ok(grown)
    }
}

/// Takes away what runs that were cut off left in a folder under names that are in no place: who grows a file holds its
/// lock.
pub(crate) fn sweep(folder: &Path) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let name = entry.file_name();
        let random = name.to_str().and_then(|name| name.strip_prefix(PREFIX));
        let ours = random.is_some_and(|random| {
            random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric())
        });
        if ours
            && entry.file_type().is_ok_and(|kind| kind.is_file())
            && File::open(entry.path()).is_ok_and(|left| left.try_lock().is_ok())
        {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

impl GrowingFile {
    /// What is written to.
    pub(crate) fn file(&self) -> &File {
        match self {
            Self::Nameless(file) => file,
            Self::Named(named) => named.as_file(),
        }
    }

    /// Puts it in its place where nothing is; gives it back where something is, or where that cannot be told.
    pub(crate) fn put_new(self, place: &Path) -> Result<(), (io::Error, Self)> {
        match self {
            Self::Nameless(file) => link(&file, place).map_err(|error| (error, Self::Nameless(file))),
            Self::Named(named) => match named.persist_noclobber(place) {
                Ok(_) => Ok(()),
                Err(missed) => Err((missed.error, Self::Named(missed.file))),
            },
        }
    }

    /// Puts it over what is in its place, which stays whole until then. Where it needs a name for that, it gets one in
    /// `folder`.
    pub(crate) fn replace(self, folder: &Path, place: &Path) -> io::Result<()> {
        match self {
            // A link takes no place that is taken; a name does.
            Self::Nameless(file) => {
                let _ = file.try_lock();
                let named = tempfile::Builder::new()
                    .prefix(PREFIX)
                    .rand_bytes(RANDOM)
                    .make_in(folder, |name| link(&file, name))?;
                named.persist(place).map(drop).map_err(|missed| missed.error)
            }
            Self::Named(named) => named.persist(place).map(drop).map_err(|missed| missed.error),
        }
    }

    /// Makes it empty again.
    pub(crate) fn clear(&mut self) -> io::Result<()> {
        self.file().set_len(0)?;
        self.file().rewind()
    }
}

impl Write for GrowingFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file().write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file().flush()
    }
}

/// The usual permissions; those of temporary files would be their owner's alone.
#[cfg(unix)]
const USUAL: u32 = 0o666;

/// Files with the usual permissions.
pub(crate) fn for_everybody<'b, 'p, 's>(
    builder: &'b mut tempfile::Builder<'p, 's>,
) -> &'b mut tempfile::Builder<'p, 's> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        builder.permissions(std::fs::Permissions::from_mode(USUAL));
    }
    builder
}

/// A file without a name; none where the system or the file system has none.
#[cfg(target_os = "linux")]
fn nameless(folder: &File) -> Option<File> {
    use rustix::fs::{Mode, OFlags, openat};
    let mode = Mode::from_raw_mode(USUAL);
    openat(folder, ".", OFlags::TMPFILE | OFlags::RDWR | OFlags::CLOEXEC, mode).ok().map(File::from)
}
#[cfg(not(target_os = "linux"))]
fn nameless(_: &File) -> Option<File> {
    None
}

#[cfg(target_os = "linux")]
fn link(file: &File, place: &Path) -> io::Result<()> {
    use std::os::fd::AsRawFd;

    use rustix::fs::{AtFlags, CWD, linkat};
    use rustix::io::Errno;
    match linkat(file, "", CWD, place, AtFlags::EMPTY_PATH) {
        Ok(()) => Ok(()),
        Err(Errno::EXIST) => Err(Errno::EXIST.into()),
        // Before Linux 6.10 only a superuser may link what has no path. Where it is the place that is not there, the
        // longer way says so, too.
        Err(_) => {
            let descriptor = format!("/proc/self/fd/{}", file.as_raw_fd());
            Ok(linkat(CWD, descriptor, CWD, place, AtFlags::SYMLINK_FOLLOW)?)
        }
    }
}
#[cfg(not(target_os = "linux"))]
fn link(_: &File, _: &Path) -> io::Result<()> {
    Err(io::Error::from(io::ErrorKind::Unsupported))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With a name and, where the system has such files, without.
    fn each_way(check: impl Fn(&dyn Fn(&[u8]) -> GrowingFile, &Path)) {
        for named in [true, false] {
            let folder = tempfile::tempdir().unwrap();
            let grown = |text: &[u8]| {
                let mut file = if named {
                    GrowingFile::Named(tempfile::NamedTempFile::new_in(folder.path()).unwrap())
                } else {
                    Nursery::new(folder.path().to_owned()).file(None).unwrap()
                };
                file.write_all(text).unwrap();
                file
            };
            check(&grown, folder.path());
        }
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn what_is_new_takes_no_others_place_and_what_replaces_does() {
        each_way(|grown, folder| {
            let place = folder.join("part.nc");
            assert!(grown(b"first").put_new(&place).is_ok());
            let (error, second) = grown(b"second").put_new(&place).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::AlreadyExists);
            assert_eq!(std::fs::read(&place).unwrap(), b"first");
            second.replace(folder, &place).unwrap();
            assert_eq!(std::fs::read(&place).unwrap(), b"second");
            drop(grown(b"third"));
            assert_eq!(names(folder), ["part.nc"]);
        });
    }

    #[test]
    fn without_its_folder_it_is_given_back() {
        each_way(|grown, folder| {
            let place = folder.join("op10/part.nc");
            let (error, file) = grown(b"first").put_new(&place).unwrap_err();
            assert_eq!(error.kind(), io::ErrorKind::NotFound);
            std::fs::create_dir(folder.join("op10")).unwrap();
            assert!(file.put_new(&place).is_ok());
            assert_eq!(names(folder), ["op10"]);
        });
    }

    #[test]
    fn cleared_it_begins_anew() {
        each_way(|grown, folder| {
            let mut file = grown(b"what was begun");
            file.clear().unwrap();
            file.write_all(b"anew").unwrap();
            assert!(file.put_new(&folder.join("part.nc")).is_ok());
            assert_eq!(std::fs::read(folder.join("part.nc")).unwrap(), b"anew");
        });
    }

    #[cfg(unix)]
    #[test]
    fn its_permissions_are_the_usual_ones_or_those_of_the_old_one() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        let mode = |name: &str| place(name).metadata().unwrap().permissions().mode() & 0o777;
        std::fs::write(place("usual"), "").unwrap();
        let nursery = Nursery::new(folder.path().to_owned());
        assert!(nursery.file(None).unwrap().put_new(&place("new")).is_ok());
        assert_eq!(mode("new"), mode("usual"));
        // More than the mask of new files lets through, and less.
        for bits in [0o666, 0o664, 0o600] {
            std::fs::set_permissions(place("usual"), std::fs::Permissions::from_mode(bits)).unwrap();
            let old = place("usual").metadata().unwrap();
            nursery.file(Some(&old)).unwrap().replace(folder.path(), &place("usual")).unwrap();
            assert_eq!(mode("usual"), bits);
        }
    }

    #[test]
    fn what_a_cut_left_is_swept_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for name in [".vpost-N6uS8t", ".vpost-kjFqfA", ".vpost-notes.txt", "vpost-N6uS8t", ".vpost"] {
            std::fs::write(at(name), "G0\n").unwrap();
        }
        let growing = File::open(at(".vpost-kjFqfA")).unwrap();
        growing.lock().unwrap();
        sweep(folder.path());
        let mut left: Vec<_> =
            folder.path().read_dir().unwrap().map(|entry| entry.unwrap().file_name()).collect();
        left.sort();
        assert_eq!(left, [".vpost", ".vpost-kjFqfA", ".vpost-notes.txt", "vpost-N6uS8t"]);
    }
}
