//! Outputs to their places, in groups: their bytes are on the disk before they have names, and their names before the
//! journal says so.
//!
//! A power cut then leaves under a final name the whole output or whatever was there before, and the journal speaks of
//! nothing that it could have taken. Bringing a group to the disk costs about what one file costs; while it lasts, the
//! next group grows.

use std::io;

use super::folder::{Grown, OutputFolder};
use super::journal::Journal;
use super::outcome::Outcome;
use super::record::Record;
use crate::file;
use crate::message::{Deed, Failure};

/// Where finished outputs wait for the disk.
pub(crate) struct Shelf<'a, 'f> {
    folder: &'f OutputFolder,
    journal: &'a mut Journal<'f>,
    /// What was named after the disk was last waited for.
    named: Vec<Record>,
}

impl<'a, 'f> Shelf<'a, 'f> {
    pub(crate) fn new(folder: &'f OutputFolder, journal: &'a mut Journal<'f>) -> Self {
        Self { folder, journal, named: Vec::new() }
    }

    /// Puts a group of outputs into their places; what cannot be put fails.
    pub(crate) fn put<'o>(&mut self, group: impl IntoIterator<Item = &'o mut Outcome>) {
        let group: Vec<&mut Outcome> = group.into_iter().collect();
        let synced = if group.iter().any(|outcome| outcome.grown.is_some()) { self.sync() } else { Ok(()) };
        for outcome in group {
            if let Some(grown) = outcome.grown.take() {
                let put = synced.as_ref().map_err(again).and_then(|()| self.place(grown, outcome));
                if let Err(error) = put {
                    let place = self.folder.place(&outcome.record.output);
                    outcome.fail(Failure::file(&file::name(&place), Deed::Write, &error));
                }
            }
            if !outcome.resumed {
                self.named.push(outcome.record.clone());
            }
        }
    }

    fn place(&self, grown: Grown, outcome: &Outcome) -> io::Result<()> {
        let Record { output, output_blake3, .. } = &outcome.record;
        match self.folder.put(grown, output) {
            // Another run of the same share has put the same there meanwhile.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {
                let present = self.folder.present(output)?.map(|hash| hash.to_hex().to_string());
                if present == *output_blake3 { Ok(()) } else { Err(error) }
            }
            put => put,
        }
    }

    /// The bytes of what has grown and the names of what was put are on the disk; the journal may say so.
    fn sync(&mut self) -> io::Result<()> {
        self.folder.sync()?;
        self.journal.add(&self.named);
        self.named.clear();
        Ok(())
    }

    /// The last group is on the disk, too.
    pub(crate) fn end(mut self) -> io::Result<()> {
        self.sync()
    }
}

/// The same error once more.
fn again(error: &io::Error) -> io::Error {
    error.raw_os_error().map_or_else(|| io::Error::from(error.kind()), io::Error::from_raw_os_error)
}
