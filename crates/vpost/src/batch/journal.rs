//! The journal: what became of each program, so that the next run need not do it again.
//!
//! A line is appended soon after a program's output stands under its final name. The journal saves work and proves
//! completeness; it is never believed without the hash of the output it speaks of. So nothing is lost with it: a line
//! that is torn, missing or of a file that has changed since means that the program is corrected again.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::folder::OutputFolder;
use super::record::{self, Record};
use crate::file;
use crate::growing::for_everybody;
use crate::message::{Deed, Failure};

/// The journal of whatever was done in the folder and needs no shard's name.
pub(crate) const WHOLE: &str = "batch";

/// Records by output; more than one where an output was made anew.
pub(crate) type Records = BTreeMap<String, Vec<Record>>;

/// A run's own journal, written as it goes.
#[derive(Debug)]
pub(crate) struct Journal<'f> {
    folder: &'f OutputFolder,
    name: String,
    live: PathBuf,
    file: File,
    /// A line could not be written whole: behind it nothing could be read.
    torn: bool,
}

impl<'f> Journal<'f> {
    /// Begins a journal. No two runs write one file: the same shard may be at work twice, where an engine lost sight of
    /// one of them.
    pub(crate) fn begin(folder: &'f OutputFolder, name: &str) -> Result<Self, Failure> {
        let own = folder.journal();
        let prefix = format!("{name}.");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(".live");
        let (file, live) = for_everybody(&mut builder)
            .tempfile_in(&own)
            .and_then(|file| file.keep().map_err(|error| error.error))
            .map_err(file::fails(&own, Deed::WriteTo))?;
        Ok(Self { folder, name: name.to_owned(), live, file, torn: false })
    }

    /// Adds lines. Where that fails, the outputs are there all the same, and [`end`](Self::end) writes the lines or says
    /// that it cannot.
    pub(crate) fn add<'r>(&mut self, records: impl IntoIterator<Item = &'r Record>) {
        self.torn = self.torn || self.file.write_all(&record::lines(records)).is_err();
    }

    /// Puts all records of this journal's name into one file; for [`WHOLE`], those of all names.
    ///
    /// `earlier`: what [`read`] gave for them and is to be kept.
    pub(crate) fn end(self, earlier: &Records, records: &[Record]) -> Result<(), Failure> {
        drop(self.file);
        let own = self.folder.journal();
        let stale = files(&own, (self.name != WHOLE).then_some(self.name.as_str()))?;
        let name = format!("{}.jsonl", self.name);
        let place = own.join(&name);
        let mut all: BTreeMap<&str, &[Record]> =
            earlier.iter().map(|(output, known)| (output.as_str(), known.as_slice())).collect();
        all.extend(records.iter().map(|record| (record.output.as_str(), std::slice::from_ref(record))));
        self.folder
            .put_journal(&name, &record::lines(all.into_values().flatten()))
            .map_err(file::fails(&place, Deed::Write))?;
        for path in stale.iter().chain([&self.live]).filter(|path| **path != place) {
            // What cannot be removed is read again and says nothing new.
            let _ = std::fs::remove_file(path);
        }
        Ok(())
    }
}

/// Reads the journals of these names; all where none is given.
pub(crate) fn read(folder: &Path, names: Option<&[&str]>) -> Result<Records, Failure> {
    let paths = match names {
        None => files(folder, None)?,
        Some(names) => {
            let mut paths = Vec::new();
            for name in names {
                paths.extend(files(folder, Some(name))?);
            }
            paths
        }
    };
    let mut records = Records::new();
    for path in paths {
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            // Another shard has just put its files together.
            Err(error) if error.kind() == io::ErrorKind::NotFound => continue,
            Err(error) => return Err(Failure::file(&file::name(&path), Deed::Read, &error)),
        };
        for line in bytes.split(|byte| *byte == b'\n') {
            // Killed in the middle of a line: that program is corrected again.
            let Ok(record) = serde_json::from_slice::<Record>(line) else { continue };
            let known = records.entry(record.output.clone()).or_default();
            if !known.contains(&record) {
                known.push(record);
            }
        }
    }
    Ok(records)
}

/// The journals' files, in order.
fn files(folder: &Path, name: Option<&str>) -> Result<Vec<PathBuf>, Failure> {
    let fail = |error: io::Error| Failure::file(&file::name(folder), Deed::Read, &error);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        let file = entry.file_name().to_string_lossy().into_owned();
        let ours = name.is_none_or(|name| file.strip_prefix(name).is_some_and(|rest| rest.starts_with('.')));
        if ours && (file.ends_with(".jsonl") || file.ends_with(".live")) {
            found.push(entry.path());
        }
    }
    found.sort();
    Ok(found)
}
