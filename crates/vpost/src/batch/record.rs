//! What became of a program: one line of the results and of the journal.

use diagnostic::{Diagnostic, Entry, Language};
use serde::{Deserialize, Serialize};

use crate::expand::Lookup;
use crate::message::Source;
use rewrite::Figures;

/// What became of a program.
///
/// The same for the same input and job, whoever did it and when: no time, no machine.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Record {
    /// Below the output folder.
    pub output: String,
    /// As it was named or found.
    pub input: String,
    pub status: Status,
    /// Hash of the profile with its tables, the dialect, the engine, the options and vpost's version.
    pub job_blake3: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub input_blake3: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub output_blake3: Option<String>,
    pub bytes_in: u64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bytes_out: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none", flatten)]
    pub figures: Option<Numbers>,
    /// Subprograms that were looked for, and what was found.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub subprograms: Vec<Lookup>,
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Fault>,
    /// Why it was not corrected.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<Fault>,
    /// It was not corrected, and an output of an earlier run is still there.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub older_output: bool,
}

/// How it ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Status {
    /// The output is there and differs from the input.
    Corrected,
    /// The output is there and is the input.
    Unchanged,
    /// The program was refused: the same again next time.
    Refused,
    /// A file could not be read or written: perhaps not so next time.
    Failed,
}

impl Status {
    pub(crate) fn is_done(self) -> bool {
        matches!(self, Self::Corrected | Self::Unchanged)
    }
}

/// The summary's figures.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Numbers {
    pub blocks_in: u64,
    pub blocks_out: u64,
    pub splits: u64,
    pub largest_correction_um: f64,
    pub largest_correction_line: u64,
    pub deviation_before_um: f64,
    pub deviation_before_line: u64,
    pub deviation_after_um: f64,
    pub deviation_after_line: u64,
}

impl From<&Figures> for Numbers {
    fn from(figures: &Figures) -> Self {
        use crate::summary::um;
        Self {
            blocks_in: figures.blocks_in,
            blocks_out: figures.blocks_out,
            splits: figures.splits,
            largest_correction_um: um(figures.largest.0),
            largest_correction_line: figures.largest.1,
            deviation_before_um: um(figures.before.0),
            deviation_before_line: figures.before.1,
            deviation_after_um: um(figures.after.0),
            deviation_after_line: figures.after.1,
        }
    }
}

/// A message in few words.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Fault {
    pub code: String,
    pub message: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub line: Option<usize>,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub help: Option<String>,
    /// What the profile lacks, where entries of one of its tables settle it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub settled_by: Vec<Settling>,
    /// The help in Russian: of this run alone, records are English.
    #[serde(skip)]
    pub help_in_russian: Option<String>,
}

/// An entry of the profile.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Settling {
    pub section: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub key: Option<String>,
    pub name: String,
    pub value: String,
}

impl Settling {
    fn of(entry: &Entry) -> Self {
        let Entry { section, key, name, value } = entry.clone();
        Self { section, key, name, value }
    }

    pub(crate) fn entry(&self) -> Entry {
        let Self { section, key, name, value } = self;
        Entry::new(section, key.as_deref(), name.as_str(), value)
    }
}

impl Fault {
    pub(crate) fn new(diagnostic: &Diagnostic, source: Option<&Source>) -> Self {
        let line = diagnostic.span.as_ref().zip(source).map(|(span, source)| source.line(span.start));
        Self {
            code: diagnostic.code.to_string(),
            message: diagnostic.message.english().to_owned(),
            file: source.map(|source| source.name.clone()),
            line,
            note: diagnostic.label.english().to_owned(),
            help: diagnostic.help.as_ref().map(|help| help.english().to_owned()),
            settled_by: diagnostic.entries().iter().map(Settling::of).collect(),
            help_in_russian: diagnostic
                .help
                .as_ref()
                .map(|help| help.in_language(Language::Russian).to_owned()),
        }
    }
}

/// Records as JSON Lines.
pub(crate) fn lines<'r>(records: impl IntoIterator<Item = &'r Record>) -> Vec<u8> {
    let mut text = Vec::new();
    for record in records {
        serde_json::to_writer(&mut text, record).expect("plain values always serialise");
        text.push(b'\n');
    }
    text
}
