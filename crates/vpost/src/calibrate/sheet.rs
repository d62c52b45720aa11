//! Measurement files of `calibrate`: CSV with named columns, every cell with its place.

use std::ops::Range;
use std::path::Path;

use diagnostic::{Code, Diagnostic};

use crate::file;
use crate::message::Failure;

use super::codes::{COLUMNS, FIELD, UNREADABLE};

/// A CSV file of measurements.
pub(super) struct Sheet {
    /// Its name in messages.
    pub(super) name: String,
    bytes: Vec<u8>,
    header: Vec<String>,
    /// Columns that hold what a control adds instead of what the machine does: the same with the other sign.
    corrections: Vec<usize>,
    records: Vec<csv::ByteRecord>,
    header_position: Option<csv::Position>,
}

/// One row of a sheet.
#[derive(Clone, Copy)]
pub(super) struct Row<'s> {
    sheet: &'s Sheet,
    record: &'s csv::ByteRecord,
}

impl Sheet {
    /// Reads a file; `known` are the columns it may have, `ignore` those to pass over.
    pub(super) fn read(path: &Path, known: &[&str], ignore: &[String]) -> Result<Self, Failure> {
        Self::from_bytes(&file::name(path), file::read(path)?, known, ignore)
    }

    /// The same of bytes.
    pub(super) fn from_bytes(
        name: &str,
        bytes: Vec<u8>,
        known: &[&str],
        ignore: &[String],
    ) -> Result<Self, Failure> {
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(bytes.as_slice());
        let mut all = Vec::new();
        for record in reader.byte_records() {
            let record = record.map_err(|error| {
                let diagnostic = Diagnostic::error(UNREADABLE, format!("the file cannot be read: {error}"))
                    .help("write plain CSV with commas");
                Failure::refused(name, &bytes, vec![diagnostic])
            })?;
            if !record.iter().all(<[u8]>::is_empty) {
                all.push(record);
            }
        }
        if all.len() < 2 {
            let diagnostic = Diagnostic::error(UNREADABLE, "the measurement file has no rows").help(format!(
                "a header and one row per reading are expected; columns: {}",
                known.join(", ")
            ));
            return Err(Failure::refused(name, &bytes, vec![diagnostic]));
        }
        let first = all.remove(0);
        let mut header: Vec<String> = first.iter().map(text).collect();
        // A lattice of corrections (`profile export --lattice corrections`) is one of errors with the other sign.
        let mut corrections = Vec::new();
        for (at, column) in header.iter_mut().enumerate() {
            let error = match column.as_str() {
                "cx_um" => "dx_um",
                "cy_um" => "dy_um",
                "cz_um" => "dz_um",
                _ => continue,
            };
            if known.contains(&error) && !ignore.contains(column) {
                corrections.push(at);
                error.clone_into(column);
            }
        }
        let sheet = Self {
            name: name.to_owned(),
            bytes,
            header_position: first.position().cloned(),
            header,
            corrections,
            records: all,
        };
        for (at, column) in sheet.header.iter().enumerate() {
            if ignore.contains(column) || column.starts_with("published_") {
                continue;
            }
            if !known.contains(&column.as_str()) {
                let help = format!(
                    "known here: {}; or pass it over with `--ignore-column {column}`",
                    known.join(", ")
                );
                return Err(sheet.header_refused(at, format!("column `{column}` is unknown"), &help));
            }
            if sheet.header[..at].contains(column) {
                return Err(sheet.header_refused(
                    at,
                    format!("column `{column}` stands twice"),
                    "remove one of them",
                ));
            }
        }
        if let Some(short) = sheet.records.iter().find(|r| r.len() != sheet.header.len()) {
            let message = format!("{} fields, the header has {}", short.len(), sheet.header.len());
            let help = "give every row as many fields as the header; write 0.5, not 0,5";
            return Err(sheet.refused(FIELD, short, 0, message, "this row", help));
        }
        Ok(sheet)
    }

    /// True where the file has the column.
    pub(super) fn has(&self, column: &str) -> bool {
        self.header.iter().any(|known| known == column)
    }

    /// Refuses a file that lacks one of the columns.
    pub(super) fn need(&self, columns: &[&str], help: &str) -> Result<(), Failure> {
        match columns.iter().find(|column| !self.has(column)) {
            Some(missing) => Err(self.header_refused(0, format!("column `{missing}` is missing"), help)),
            None => Ok(()),
        }
    }

    /// The rows.
    pub(super) fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        self.records.iter().map(|record| Row { sheet: self, record })
    }

    fn header_refused(&self, at: usize, message: String, help: &str) -> Failure {
        let mut diagnostic = Diagnostic::error(COLUMNS, message).help(help);
        if let Some(span) = field_span(&self.bytes, self.header_position.as_ref(), at) {
            diagnostic = diagnostic.at(span, "in the header");
        }
        Failure::refused(&self.name, &self.bytes, vec![diagnostic])
    }

    fn refused(
        &self,
        code: Code,
        record: &csv::ByteRecord,
        at: usize,
        message: String,
        label: &str,
        help: &str,
    ) -> Failure {
        let mut diagnostic = Diagnostic::error(code, message).help(help);
        if let Some(span) = field_span(&self.bytes, record.position(), at) {
            diagnostic = diagnostic.at(span, label);
        }
        Failure::refused(&self.name, &self.bytes, vec![diagnostic])
    }
}

impl Row<'_> {
    /// The text of a column; empty where there is none.
    pub(super) fn text(&self, column: &str) -> String {
        self.place(column).and_then(|at| self.record.get(at)).map(text).unwrap_or_default()
    }

    /// The number in a column; `None` where the column or the field is empty.
    pub(super) fn number(&self, column: &str) -> Result<Option<f64>, Failure> {
        let field = self.text(column);
        if field.is_empty() {
            return Ok(None);
        }
        match field.parse::<f64>() {
            Ok(value) if value.is_finite() => {
                let negative = self.place(column).is_some_and(|at| self.sheet.corrections.contains(&at));
                Ok(Some(if negative { -value } else { value }))
            }
            _ => Err(self.refuse(
                FIELD,
                column,
                format!("`{field}` is not a number"),
                "write a decimal number with a point, or leave the field empty",
            )),
        }
    }

    /// The number in a column that must be there.
    pub(super) fn needed(&self, column: &str) -> Result<f64, Failure> {
        self.number(column)?.ok_or_else(|| {
            self.refuse(FIELD, column, format!("`{column}` is empty"), "every row needs this number")
        })
    }

    /// Three numbers that must be there.
    pub(super) fn three(&self, columns: [&str; 3]) -> Result<[f64; 3], Failure> {
        Ok([self.needed(columns[0])?, self.needed(columns[1])?, self.needed(columns[2])?])
    }

    /// Sign of a number: -1, 0 or +1; 0 where it is empty.
    pub(super) fn sign(&self, column: &str) -> Result<i8, Failure> {
        let value = self.number(column)?.unwrap_or(0.0);
        Ok(if value > 0.0 { 1 } else { -i8::from(value < 0.0) })
    }

    /// An error about one field.
    pub(super) fn refuse(&self, code: Code, column: &str, message: String, help: &str) -> Failure {
        self.sheet.refused(code, self.record, self.place(column).unwrap_or(0), message, column, help)
    }

    fn place(&self, column: &str) -> Option<usize> {
        self.sheet.header.iter().position(|known| known == column)
    }
}

fn text(field: &[u8]) -> String {
    String::from_utf8_lossy(field).trim_start_matches('\u{feff}').trim_matches('"').to_owned()
}

/// Bytes of a field of a record; the record starts at its position.
fn field_span(bytes: &[u8], position: Option<&csv::Position>, field: usize) -> Option<Range<u64>> {
    let mut at = usize::try_from(position?.byte()).ok()?;
    for _ in 0..field {
        at += bytes.get(at..)?.iter().position(|byte| *byte == b',')? + 1;
    }
    let rest = bytes.get(at..)?;
    let length = rest.iter().position(|byte| matches!(byte, b',' | b'\n' | b'\r')).unwrap_or(rest.len());
    Some(at as u64..(at + length) as u64)
}
