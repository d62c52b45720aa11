//! A large output goes to the disk while it grows: in the end there is little to wait for.

use std::fs::File;
use std::io::{self, ErrorKind};
use std::path::Path;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

use diagnostic::both;

/// A disk is asked to take about so much at a time.
const PART_BYTES: u64 = 8 << 20;

/// Brings what was written to the disk, beside those who write.
#[derive(Debug, Default)]
pub(crate) struct ToDisk {
    /// Written, and not asked for.
    waiting_bytes: u64,
    worker: Option<Worker>,
}

#[derive(Debug)]
struct Worker {
    ask: SyncSender<()>,
    /// What the disk says is said once, to who asks first: it must not be lost.
    thread: JoinHandle<io::Result<()>>,
}

impl ToDisk {
    /// So many more bytes of a file were written.
    pub(crate) fn wrote(&mut self, file: &File, bytes: usize) {
        self.waiting_bytes += bytes as u64;
        if self.waiting_bytes < PART_BYTES {
            return;
        }
        if self.worker.is_none() {
            self.worker = Worker::start(file).ok();
        }
        // Who is still at work on the last part takes this one with the next.
        if self.worker.as_ref().is_some_and(|worker| worker.ask.try_send(()).is_ok()) {
            self.waiting_bytes = 0;
        }
    }

    /// All of the file is on the disk.
    ///
    /// # Errors
    /// What the disk said, now or before.
    pub(crate) fn finish(self, file: &File) -> io::Result<()> {
        if let Some(Worker { ask, thread }) = self.worker {
            drop(ask);
            thread.join().map_err(|_| {
                io::Error::other(both!(
                    "the thread that writes to the disk has died",
                    "поток, который пишет на диск, прерван"
                ))
            })??;
        }
        file.sync_all()
    }
}

/// The names in a folder are on the disk.
///
/// # Errors
/// What the disk said. A file system that knows no such request has no such delay.
pub(crate) fn names(folder: &Path) -> io::Result<()> {
    if !cfg!(unix) {
        return Ok(());
    }
    match File::open(folder)?.sync_all() {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        synced => synced,
    }
}

impl Worker {
    fn start(file: &File) -> io::Result<Self> {
        let file = file.try_clone()?;
        let (ask, asked) = sync_channel(1);
        let thread = thread::Builder::new().spawn(move || {
            while asked.recv().is_ok() {
                file.sync_data()?;
            }
            Ok(())
        })?;
        Ok(Self { ask, thread })
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    #[test]
    fn all_of_a_file_is_there_in_the_end() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.nc");
        let mut output = crate::file::Output::new(Some(&path)).unwrap();
        let part: Vec<u8> = (0..1_u32 << 18).flat_map(u32::to_le_bytes).collect();
        let parts = 3 * PART_BYTES as usize / part.len();
        (0..parts).for_each(|_| output.write_all(&part).unwrap());
        output.finish().unwrap();
        assert!(std::fs::read(path).unwrap() == part.repeat(parts));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn what_the_disk_said_meanwhile_is_told_in_the_end() {
        // A device that cannot be brought to a disk.
        let fails = File::options().write(true).open("/dev/null").unwrap();
        let mut to_disk = ToDisk::default();
        to_disk.wrote(&fails, PART_BYTES as usize);
        to_disk.finish(&tempfile::tempfile().unwrap()).unwrap_err();
    }
}
