//! The output folder: whole files under final names, whatever ends the work, and nothing left lying about.
//!
//! ```text
//! OUTDIR/.vpost/lock      held while vpost works here
//! OUTDIR/.vpost/tmp/      outputs before they are whole, where they need a name
//! OUTDIR/.vpost/journal/  what became of each program
//! OUTDIR/…                the outputs
//! ```
//!
//! Who dies leaves temporaries only in `tmp`, and on Linux mostly none: there a file needs no name before it is whole.
//! Whoever opens the folder next and is alone with it empties that: locks end with their process, so being alone is
//! known, not guessed from ages or process numbers.

use std::collections::BTreeSet;
use std::fs::{File, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use blake3::{Hash, Hasher};
use diagnostic::{Code, both, notice};

use crate::file::{self, Place};
use crate::growing::{GrowingFile, Nursery};
use crate::message::{Deed, Failure, Report};
use crate::to_disk;

/// Someone else works in the output folder.
const BUSY: Code = Code(1005);

/// The folder of vpost's own in an output folder.
pub(crate) const OWN: &str = ".vpost";

/// Something of vpost's own in the output folder is not what vpost made.
const NOT_OURS: Code = Code(1012);

/// Who else may work in the folder at the same time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Company {
    /// Nobody.
    Alone,
    /// Other shards.
    Shards,
}

/// An output that is whole and has no name yet.
#[derive(Debug)]
pub(crate) enum Grown {
    /// For a place where nothing is.
    New(Place),
    /// For one where something is that may go.
    Over(Place),
}

/// The output folder, open for work.
#[derive(Debug)]
pub(crate) struct OutputFolder {
    root: PathBuf,
    temporaries: Nursery,
    /// Held until this value goes. None where the file system knows no locks.
    lock: Option<File>,
}

impl OutputFolder {
    /// Opens the folder, making it where it is not there; sweeps what a killed run left, if nobody else is at work.
    pub(crate) fn open(root: &Path, company: Company) -> Result<Self, Failure> {
        let own = root.join(OWN);
        // Made whole here, it is not made whole for each file.
        let temporaries = std::path::absolute(own.join("tmp")).map_err(file::fails(root, Deed::WriteTo))?;
        std::fs::create_dir_all(root).map_err(file::fails(root, Deed::WriteTo))?;
        for (path, kind) in [
            (&own, Kind::Folder),
            (&own.join("tmp"), Kind::Folder),
            (&own.join("journal"), Kind::Folder),
            (&own.join("lock"), Kind::File),
        ] {
            kind.is_ours(path)?;
        }
        for entry in std::fs::read_dir(own.join("journal")).into_iter().flatten().flatten() {
            Kind::File.is_ours(&entry.path())?;
        }
        let lock = std::fs::create_dir_all(&temporaries)
            .and_then(|()| std::fs::create_dir_all(own.join("journal")))
            .and_then(|()| File::options().create(true).append(true).open(own.join("lock")))
            .map_err(file::fails(root, Deed::WriteTo))?;
        let temporaries = Nursery::new(temporaries);
        let alone = match lock.try_lock() {
            Ok(()) => true,
            Err(TryLockError::WouldBlock) => false,
            // A file system without locks: nobody can be asked for, and nothing is swept.
            Err(TryLockError::Error(_)) => {
                return Ok(Self { root: root.to_owned(), temporaries, lock: None });
            }
        };
        if alone {
            let folder = temporaries.path();
            sweep(folder).map_err(file::fails(folder, Deed::Empty))?;
        }
        let held = match company {
            Company::Alone => alone,
            Company::Shards => (!alone || lock.unlock().is_ok()) && share(&lock),
        };
        if !held {
            return Err(busy(root));
        }
        Ok(Self { root: root.to_owned(), temporaries, lock: Some(lock) })
    }

    /// Refuses outputs whose folders are links: they would lie somewhere else.
    pub(crate) fn holds<'o>(&self, outputs: impl Iterator<Item = &'o str>) -> Result<(), Failure> {
        let folders: BTreeSet<&str> =
            outputs.flat_map(|output| output.match_indices('/').map(|(at, _)| &output[..at])).collect();
        folders.into_iter().try_for_each(|folder| Kind::Folder.is_ours(&self.place(folder)))
    }

    /// True where nobody else can be at work here.
    pub(crate) fn is_locked(&self) -> bool {
        self.lock.is_some()
    }

    /// False once somebody took the folder away, or what vpost keeps in it.
    pub(crate) fn is_there(&self) -> bool {
        self.temporaries.path().is_dir() && self.journal().is_dir()
    }

    /// The folder of the journal.
    pub(crate) fn journal(&self) -> PathBuf {
        self.root.join(OWN).join("journal")
    }

    /// The final place of an output.
    pub(crate) fn place(&self, output: &str) -> PathBuf {
        self.root.join(output)
    }

    /// The hash of what is at an output's place; none where nothing is there.
    pub(crate) fn present(&self, output: &str) -> io::Result<Option<Hash>> {
        match hash(&self.place(output)) {
            Ok((_, hash)) => Ok(Some(hash)),
            Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
            Err(error) => Err(error),
        }
    }

    /// True where the file at an output's place says that vpost corrected it.
    pub(crate) fn bears_mark(&self, output: &str) -> io::Result<bool> {
        // The mark stands where a program opens.
        let mut head = Vec::new();
        File::open(self.place(output))?.take(1 << 20).read_to_end(&mut head)?;
        Ok(nc_emit::find_provenance(&head).is_some())
    }

    /// A place for an output to grow in, out of sight; gone again unless it is [put in place](Self::put).
    pub(crate) fn temporary(&self) -> io::Result<Place> {
        self.temporaries.file(None).map(Place::Beside)
    }

    /// Writes a file of the journal: whole, or an earlier one stays as it was.
    pub(crate) fn put_journal(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        // Not beside its place: who is killed here leaves it where it is swept.
        let mut file = self.temporaries.file(None)?;
        file.write_all(bytes)?;
        file.file().sync_all()?;
        file.replace(self.temporaries.path(), &self.journal().join(name))?;
        to_disk::names(&self.journal())
    }

    /// Puts an output in its place: whole under its final name. Its bytes are on the disk by then: see
    /// [`sync`](Self::sync).
    pub(crate) fn put(&self, grown: Grown, output: &str) -> io::Result<()> {
        let (file, over) = match grown {
            Grown::New(file) => (file, false),
            Grown::Over(file) => (file, true),
        };
        let file = beside(file)?;
        if !cfg!(target_os = "linux") {
            file.file().sync_all()?;
        }
        let place = self.place(output);
        if over {
            return file.replace(self.temporaries.path(), &place);
        }
        let put = match (file.put_new(&place), place.parent()) {
            // The first output of a folder makes it.
            (Err((error, file)), Some(folder)) if error.kind() == io::ErrorKind::NotFound => {
                std::fs::create_dir_all(folder)?;
                file.put_new(&place)
            }
            (put, _) => put,
        };
        put.map_err(|(error, _)| error)
    }

    /// Brings everything written so far to the disk: bytes, and the names that were given.
    ///
    /// One call for all files; a call for each costs more than correcting a small program.
    pub(crate) fn sync(&self) -> io::Result<()> {
        #[cfg(target_os = "linux")]
        rustix::fs::syncfs(File::open(&self.root)?)?;
        Ok(())
    }

    /// True where nothing but zeros stands in an output's place: what a power cut left of a file that it took.
    pub(crate) fn is_blank(&self, output: &str) -> io::Result<bool> {
        let mut file = File::open(self.place(output))?;
        let mut part = vec![0; 1 << 16];
        loop {
            match file.read(&mut part)? {
                0 => return Ok(true),
                read if part[..read].iter().any(|byte| *byte != 0) => return Ok(false),
                _ => {}
            }
        }
    }
}

/// What something of vpost's own is.
#[derive(Clone, Copy)]
enum Kind {
    Folder,
    File,
}

impl Kind {
    /// Refuses what somebody put there: through a link vpost would sweep and write in a folder that is not its own.
    fn is_ours(self, path: &Path) -> Result<(), Failure> {
        let Ok(found) = path.symlink_metadata() else { return Ok(()) };
        let ours = match self {
            Self::Folder => found.is_dir(),
            Self::File => found.is_file(),
        };
        if ours {
            return Ok(());
        }
        let what = if found.is_symlink() {
            both!("a link", "ссылка")
        } else {
            both!("not what vpost makes there", "не то, что создаёт там vpost")
        };
        Err(Failure::usage(notice!(NOT_OURS;
            "{} is {what}", "{} — {what:#}", file::name(path);
            "remove it, or give another output folder with `-O`",
            "уберите или дайте другую выходную папку ключом `-O`"
        )))
    }
}

/// Batch writes files, and nothing to devices.
fn beside(temporary: Place) -> io::Result<GrowingFile> {
    match temporary {
        Place::Beside(file) => Ok(file),
        Place::Apart(_) => Err(io::Error::from(io::ErrorKind::InvalidInput)),
    }
}

/// True for a folder that some batch wrote its outputs to.
pub(crate) fn is_output(folder: &Path) -> bool {
    folder.join(".vpost/journal").is_dir()
}

/// Length and hash of a file, however large.
pub(crate) fn hash(path: &Path) -> io::Result<(u64, Hash)> {
    let mut hasher = Hasher::new();
    let mut file = File::open(path)?;
    hasher.update_reader(&mut file)?;
    Ok((hasher.count(), hasher.finalize()))
}

/// Takes the lock together with other shards. One of them may be alone for as long as sweeping takes.
fn share(lock: &File) -> bool {
    (0..100).any(|attempt| {
        if attempt > 0 {
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        lock.try_lock_shared().is_ok()
    })
}

/// Someone else works there.
fn busy(root: &Path) -> Failure {
    let diagnostic = notice!(BUSY;
        "another vpost batch is at work in {}", "в {} работает другой vpost batch", root.display();
        "let it end, or give a folder of its own with `-O`",
        "дождитесь конца или дайте отдельную папку ключом `-O`"
    );
    Failure::Later(Report { source: None, diagnostics: vec![diagnostic] })
}

fn sweep(folder: &Path) -> io::Result<()> {
    for entry in std::fs::read_dir(folder)? {
        std::fs::remove_file(entry?.path())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_power_cut_left_is_nobodys() {
        let root = tempfile::tempdir().unwrap();
        let folder = OutputFolder::open(root.path(), Company::Alone).unwrap();
        for (text, blank) in [(b"".as_slice(), true), (&[0; 70_000], true), (b"\0\0G0", false)] {
            std::fs::write(root.path().join("part.nc"), text).unwrap();
            assert_eq!(folder.is_blank("part.nc").unwrap(), blank);
        }
    }

    #[test]
    fn a_new_output_takes_no_others_place() {
        let root = tempfile::tempdir().unwrap();
        let folder = OutputFolder::open(root.path(), Company::Alone).unwrap();
        let grown = |text: &[u8]| {
            let mut temporary = folder.temporary().unwrap();
            temporary.write_all(text).unwrap();
            temporary
        };
        let read = || std::fs::read(root.path().join("op10/part.nc")).unwrap();
        folder.put(Grown::New(grown(b"first")), "op10/part.nc").unwrap();
        assert!(folder.put(Grown::New(grown(b"second")), "op10/part.nc").is_err());
        assert_eq!(read(), b"first");
        folder.put(Grown::Over(grown(b"second")), "op10/part.nc").unwrap();
        assert_eq!(read(), b"second");
        drop(grown(b"third"));
        assert_eq!(std::fs::read_dir(root.path().join(".vpost/tmp")).unwrap().count(), 0);
    }
}
