//! Tables as CSV files: named columns of finite numbers, every cell with its place.

use std::collections::BTreeSet;

use diagnostic::Diagnostic;

use crate::error::{CELL, COLUMN, FILE, ProfileError, ROWS, closest, span};

/// A CSV file of numbers.
#[derive(Debug)]
pub(crate) struct Columns<'f> {
    pub(crate) file: &'f str,
    /// Names and where they stand.
    pub(crate) header: Vec<(String, std::ops::Range<usize>)>,
    /// Rows of finite numbers, as many as names.
    pub(crate) rows: Vec<Vec<f64>>,
    /// Where each row stands.
    places: Vec<std::ops::Range<usize>>,
}

impl<'f> Columns<'f> {
    /// Reads the file. A byte order mark and blank lines are skipped; `#` starts no comment.
    pub(crate) fn read(file: &'f str, bytes: &[u8]) -> Result<Self, Box<ProfileError>> {
        let fail = |diagnostic| ProfileError::table(file, diagnostic);
        let text = std::str::from_utf8(bytes).map_err(|e| {
            fail(
                Diagnostic::error(FILE, "the table is not UTF-8 text")
                    .at(span(&(e.valid_up_to()..e.valid_up_to() + 1)), "first such byte")
                    .help("save the table as CSV, UTF-8, comma separated"),
            )
        })?;
        let body = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut at = text.len() - body.len();
        let mut header: Vec<(String, std::ops::Range<usize>)> = Vec::new();
        let (mut rows, mut places) = (Vec::new(), Vec::new());
        for line in body.split_inclusive('\n') {
            let place = at..at + line.trim_end().len();
            at += line.len();
            if line.trim().is_empty() {
                continue;
            }
            let cells = cells(line.trim_end_matches(['\r', '\n']), place.start);
            if header.is_empty() {
                header = cells.into_iter().map(|(name, at)| (name.to_owned(), at)).collect();
                continue;
            }
            if cells.len() != header.len() {
                let message = format!("the row has {} cells, the header {}", cells.len(), header.len());
                return Err(fail(Diagnostic::error(CELL, message).at(span(&place), "this row")));
            }
            let mut row = Vec::with_capacity(cells.len());
            for ((cell, at), (name, _)) in cells.into_iter().zip(&header) {
                match cell.parse::<f64>() {
                    Ok(value) if value.is_finite() => row.push(value),
                    _ => {
                        let message = format!("`{cell}` in column {name} is not a finite number");
                        return Err(fail(
                            Diagnostic::error(CELL, message)
                                .at(span(&at), "expected a number like -12.5")
                                .help("a function that was not measured is a column left out, not an empty cell"),
                        ));
                    }
                }
            }
            rows.push(row);
            places.push(place);
        }
        if header.is_empty() {
            return Err(fail(Diagnostic::error(ROWS, "the table is empty: expected a header line and rows")));
        }
        let mut earlier = BTreeSet::new();
        for (name, place) in &header {
            if !earlier.insert(name) {
                return Err(fail(
                    Diagnostic::error(COLUMN, format!("column {name} stands there twice"))
                        .at(span(place), "again here"),
                ));
            }
        }
        Ok(Self { file, header, rows, places })
    }

    /// The place of a column.
    pub(crate) fn find(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|(known, _)| known == name)
    }

    /// The place of a column that must be there.
    pub(crate) fn need(&self, name: &str) -> Result<usize, Box<ProfileError>> {
        self.find(name).ok_or_else(|| {
            let found: Vec<&str> = self.header.iter().map(|(name, _)| name.as_str()).collect();
            let mut diagnostic = Diagnostic::error(
                COLUMN,
                format!("the table lacks the column {name}; it has {}", found.join(", ")),
            );
            if let Some((_, place)) = self.header.first() {
                diagnostic = diagnostic.at(span(place), format!("expected {name} in this line"));
            }
            ProfileError::table(self.file, diagnostic)
        })
    }

    /// An error about a column whose name is none of the known ones.
    pub(crate) fn unknown_column(
        &self,
        column: usize,
        message: String,
        known: &[String],
    ) -> Box<ProfileError> {
        let near = closest(&self.header[column].0, known.iter().map(String::as_str));
        self.bad_column(
            column,
            message,
            near.map_or_else(
                || format!("known columns: {}", known.join(", ")),
                |n| format!("did you mean {n}?"),
            ),
        )
    }

    /// An error about a column.
    pub(crate) fn bad_column(&self, column: usize, message: String, help: String) -> Box<ProfileError> {
        let place = span(&self.header[column].1);
        ProfileError::table(self.file, Diagnostic::error(COLUMN, message).at(place, "this column").help(help))
    }

    /// An error about a row, or about the file where the row does not exist.
    pub(crate) fn bad_row(&self, row: usize, message: impl Into<String>, label: &str) -> Box<ProfileError> {
        let mut diagnostic = Diagnostic::error(ROWS, message);
        if let Some(place) = self.places.get(row) {
            diagnostic = diagnostic.at(span(place), label);
        }
        ProfileError::table(self.file, diagnostic)
    }

    /// Checks that a column increases strictly over at least two rows.
    pub(crate) fn increasing(&self, column: usize) -> Result<(), Box<ProfileError>> {
        let name = &self.header[column].0;
        if self.rows.len() < 2 {
            let message = format!("a table needs at least 2 rows, this one has {}", self.rows.len());
            return Err(self.bad_row(0, message, "the only row"));
        }
        for row in 1..self.rows.len() {
            let (before, at) = (self.rows[row - 1][column], self.rows[row][column]);
            if at <= before {
                let what = if at == before { "the same position twice" } else { "out of order" };
                let message =
                    format!("{what}: {name} {at} follows {before}, positions must increase from row to row");
                return Err(self.bad_row(row, message, "this row"));
            }
        }
        Ok(())
    }
}

/// Cells of one line and their places; surrounding spaces and double quotes do not belong to them.
fn cells(line: &str, start: usize) -> Vec<(&str, std::ops::Range<usize>)> {
    let mut at = start;
    line.split(',')
        .map(|raw| {
            let cell = raw.trim().trim_matches('"').trim();
            let from = at + (raw.len() - raw.trim_start().len());
            let range = from..from + raw.trim().len();
            at += raw.len() + 1;
            (cell, range)
        })
        .collect()
}
