//! A program as it lies on a disk: opened once, read as often as is needed, and the same from first to last.

use std::fs::{File, Metadata};
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;
use std::time::SystemTime;

use diagnostic::{Code, notice};

use crate::message::{Failure, Report};

/// A file changed while it was read.
const CHANGED: Code = Code(3);

/// What changes with a file's bytes: which file it is, its length, when it was last written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Stamp {
    /// Its length.
    pub(crate) bytes: u64,
    modified: Option<SystemTime>,
    /// Device, number, and time of the last change of anything: an editor that sets the time of writing back does not
    /// set this one.
    #[cfg(unix)]
    inode: (u64, u64, i64, i64),
}

impl Stamp {
    /// Of what lies at a path; none where nothing does.
    pub(crate) fn at(path: &Path) -> Option<Self> {
        path.metadata().ok().map(|found| Self::of(&found))
    }

    fn of(found: &Metadata) -> Self {
        #[cfg(unix)]
        use std::os::unix::fs::MetadataExt;
        Self {
            bytes: found.len(),
            modified: found.modified().ok(),
            #[cfg(unix)]
            inode: (found.dev(), found.ino(), found.ctime(), found.ctime_nsec()),
        }
    }
}

/// A file that must not change while it is read.
#[derive(Debug, Clone)]
pub(crate) struct Still {
    file: Arc<File>,
    stamp: Stamp,
}

impl Still {
    /// Opens a file.
    pub(crate) fn open(path: &Path) -> io::Result<Self> {
        let file = File::open(path)?;
        let stamp = Stamp::of(&file.metadata()?);
        Ok(Self { file: Arc::new(file), stamp })
    }

    /// Its length when it was opened.
    pub(crate) fn bytes(&self) -> u64 {
        self.stamp.bytes
    }

    /// Reads it from its start, whoever else does.
    pub(crate) fn reading(&self) -> Reading {
        Reading { file: Arc::clone(&self.file), at: 0 }
    }

    /// That path still leads to the file as it was opened.
    ///
    /// A writer that changes bytes, and not their number, within the tick of the file system's clock in which the file
    /// was opened (some milliseconds) is not seen.
    ///
    /// # Errors
    /// The refusal, by the `name` that the file has in messages.
    pub(crate) fn unchanged(&self, path: &Path, name: &str) -> Result<(), Failure> {
        match std::fs::metadata(path).map(|found| Stamp::of(&found)) {
            Ok(stamp) if stamp == self.stamp => Ok(()),
            _ => Err(changed(name)),
        }
    }
}

fn changed(name: &str) -> Failure {
    let diagnostic = notice!(CHANGED;
        "{name} changed while it was read", "{name} изменился во время чтения";
        "let whoever writes it finish (a post processor, a copy over the network), then run vpost again",
        "дайте закончить тому, кто его пишет (постпроцессору, копированию по сети), и запустите vpost снова"
    );
    Failure::File(Report { source: None, diagnostics: vec![diagnostic] })
}

/// One reading of a file, with a place of its own in it.
#[derive(Debug)]
pub(crate) struct Reading {
    file: Arc<File>,
    at: u64,
}

impl Reading {
    /// A file without a name from its start: it goes with its last reading.
    pub(crate) fn of(file: &Arc<File>) -> Self {
        Self { file: Arc::clone(file), at: 0 }
    }
}

impl Read for Reading {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = read_at(&self.file, bytes, self.at)?;
        self.at += read as u64;
        Ok(read)
    }
}

impl Seek for Reading {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        let outside = || io::Error::from(io::ErrorKind::InvalidInput);
        self.at = match to {
            SeekFrom::Start(at) => at,
            SeekFrom::Current(by) => self.at.checked_add_signed(by).ok_or_else(outside)?,
            SeekFrom::End(by) => self.file.metadata()?.len().checked_add_signed(by).ok_or_else(outside)?,
        };
        Ok(self.at)
    }
}

#[cfg(unix)]
fn read_at(file: &File, bytes: &mut [u8], at: u64) -> io::Result<usize> {
    std::os::unix::fs::FileExt::read_at(file, bytes, at)
}
#[cfg(windows)]
fn read_at(file: &File, bytes: &mut [u8], at: u64) -> io::Result<usize> {
    std::os::windows::fs::FileExt::seek_read(file, bytes, at)
}
/// One thread is all that there is: nobody moves the file's place in between.
#[cfg(target_family = "wasm")]
fn read_at(mut file: &File, bytes: &mut [u8], at: u64) -> io::Result<usize> {
    file.seek(SeekFrom::Start(at))?;
    file.read(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn readings_do_not_disturb_each_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.nc");
        std::fs::write(&path, b"G0 X1\n").unwrap();
        let still = Still::open(&path).unwrap();
        let (mut one, mut other) = (still.reading(), still.reading());
        let mut text = String::new();
        one.seek(SeekFrom::Start(3)).unwrap();
        one.read_to_string(&mut text).unwrap();
        other.read_to_string(&mut text).unwrap();
        assert_eq!(text, "X1\nG0 X1\n");
        assert!(still.unchanged(&path, "part.nc").is_ok());
    }

    #[test]
    fn a_file_that_grew_shrank_or_was_replaced_is_another() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("part.nc");
        for change in [b"G0 X1\nG0 X2\n".as_slice(), b"", b"G0 X9\n"] {
            std::fs::write(&path, b"G0 X1\n").unwrap();
            let still = Still::open(&path).unwrap();
            let other = folder.path().join("other.nc");
            std::fs::write(&other, change).unwrap();
            std::fs::rename(&other, &path).unwrap();
            assert!(still.unchanged(&path, "part.nc").is_err());
        }
        let still = Still::open(&path).unwrap();
        std::fs::remove_file(&path).unwrap();
        assert!(still.unchanged(&path, "part.nc").is_err());
    }
}
