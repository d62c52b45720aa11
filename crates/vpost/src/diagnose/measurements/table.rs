//! A measurement file as a table of fields: header, records, places of the known columns.

use std::collections::BTreeMap;
use std::ops::Range;

use diagnostic::{Code, Diagnostic};

use crate::diagnose::books::Slip;
use crate::file;
use crate::message::Failure;

/// A measurement file that cannot be read.
const UNREADABLE: Code = Code(910);
/// A column is missing, unknown, twice, or contradicts another.
pub(super) const COLUMNS: Code = Code(911);
/// Columns hold something else than their names say.
const SLIP: Code = Code(919);
/// A field is not what its column says.
pub(super) const FIELD: Code = Code(912);

const NAMES: [&str; 40] = [
    "run",
    "x_mm",
    "y_mm",
    "z_mm",
    "a_deg",
    "b_deg",
    "c_deg",
    "dx_um",
    "dy_um",
    "dz_um",
    "xm_mm",
    "ym_mm",
    "zm_mm",
    "d_um",
    "length_mm",
    "bx_mm",
    "by_mm",
    "bz_mm",
    "dir_x",
    "dir_y",
    "dir_z",
    "feed_mm_min",
    "tool_x_mm",
    "tool_y_mm",
    "tool_z_mm",
    "load_kg",
    "time_s",
    "temp_c",
    "temp_x_c",
    "temp_y_c",
    "temp_z_c",
    "repeat",
    "u_um",
    "u_x_um",
    "u_y_um",
    "u_z_um",
    "instrument",
    "artefact",
    "station",
    "note",
];

/// The fields of a file.
pub(in crate::diagnose) struct Table<'a> {
    name: &'a str,
    bytes: &'a [u8],
    /// Place of each known column.
    pub(super) place: BTreeMap<&'static str, usize>,
    /// The rows in the order of the file.
    pub(super) records: Vec<csv::ByteRecord>,
    /// The first line.
    pub(super) header: csv::ByteRecord,
}

impl Table<'_> {
    /// A refusal that points at a field.
    pub(super) fn refuse(
        &self,
        code: Code,
        at: Option<(&csv::ByteRecord, usize)>,
        message: String,
        label: &str,
        help: &str,
    ) -> Failure {
        let mut diagnostic = Diagnostic::error(code, message).help(help);
        if let Some(span) = at.and_then(|(record, field)| field_span(self.bytes, record.position(), field)) {
            diagnostic = diagnostic.at(span, label);
        }
        Failure::refused(self.name, self.bytes, vec![diagnostic])
    }

    /// The refusal of a file whose columns do not hold what their names say.
    pub(in crate::diagnose) fn slipped(&self, slip: &Slip) -> Failure {
        let message = format!(
            "it seems that {}: the gap would be {:.1} um RMS in the place of {:.1} um, with no other cause",
            slip.words, slip.after_um, slip.before_um
        );
        let column = self.place.get(slip.column).copied().unwrap_or_default();
        let help = "correct the column and diagnose again; with --as-written it is taken as it stands";
        self.refuse(SLIP, Some((&self.header, column)), message, "this column", help)
    }

    /// The number in a column; `None` where the column or the field is empty.
    pub(super) fn number(&self, record: &csv::ByteRecord, column: &str) -> Result<Option<f64>, Failure> {
        let Some(place) = self.place.get(column) else { return Ok(None) };
        let field = String::from_utf8_lossy(record.get(*place).unwrap_or_default());
        if field.is_empty() {
            return Ok(None);
        }
        match field.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(Some(value)),
            _ => Err(self.refuse(
                FIELD,
                Some((record, *place)),
                format!("`{field}` is not a number"),
                column,
                "write a decimal number with a point, or leave the field empty",
            )),
        }
    }

    /// The number in a column that no row may leave empty.
    pub(super) fn needed(&self, record: &csv::ByteRecord, column: &str) -> Result<f64, Failure> {
        self.number(record, column)?.ok_or_else(|| {
            let place = self.place.get(column).copied().unwrap_or_default();
            self.refuse(
                FIELD,
                Some((record, place)),
                format!("`{column}` is empty"),
                "this field",
                "every row needs its command",
            )
        })
    }

    /// The text in a column; `None` where the column or the field is empty.
    pub(super) fn text(&self, record: &csv::ByteRecord, column: &str) -> Option<String> {
        let text = file::decoded(record.get(*self.place.get(column)?).unwrap_or_default()).into_owned();
        (!text.is_empty()).then_some(text)
    }

    /// True where the file has the column.
    pub(super) fn has(&self, column: &str) -> bool {
        self.place.contains_key(column)
    }
}

/// Reads header and records.
pub(super) fn table<'a>(name: &'a str, bytes: &'a [u8], ignore: &[String]) -> Result<Table<'a>, Failure> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(bytes);
    let mut records = reader.byte_records();
    let mut table =
        Table { name, bytes, place: BTreeMap::new(), records: Vec::new(), header: csv::ByteRecord::new() };
    match records.next() {
        Some(Ok(header)) => table.header = header,
        _ => {
            return Err(table.refuse(
                UNREADABLE,
                None,
                "the measurement file is empty".to_owned(),
                "",
                "a header is expected: run,x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,…",
            ));
        }
    }
    let columns: Vec<String> =
        table.header.iter().map(|f| file::decoded(f).trim_start_matches('\u{feff}').to_owned()).collect();
    for (at, column) in columns.iter().enumerate() {
        if ignore.contains(column) {
            continue;
        }
        let here = Some((&table.header, at));
        let Some(known) = NAMES.iter().find(|known| *known == column) else {
            let help = format!(
                "rename it to one of {}, or pass it over with --ignore-column {column}",
                NAMES.join(", ")
            );
            return Err(table.refuse(
                COLUMNS,
                here,
                format!("column `{column}` is unknown"),
                "this column",
                &help,
            ));
        };
        if table.place.contains_key(known) {
            return Err(table.refuse(
                COLUMNS,
                here,
                format!("column `{column}` stands twice"),
                "the second one",
                "remove one of them",
            ));
        }
        table.place.insert(known, at);
    }
    for record in records {
        let record = record.map_err(|error| {
            table.refuse(
                UNREADABLE,
                None,
                format!("the file cannot be read: {error}"),
                "",
                "write plain CSV with commas",
            )
        })?;
        if record.iter().all(<[u8]>::is_empty) {
            continue;
        }
        if record.len() != columns.len() {
            let message = format!("{} fields, the header has {}", record.len(), columns.len());
            return Err(table.refuse(
                FIELD,
                Some((&record, 0)),
                message,
                "this row",
                "give every row as many fields as the header; write 0.5, not 0,5",
            ));
        }
        table.records.push(record);
    }
    if table.records.is_empty() {
        return Err(table.refuse(
            UNREADABLE,
            None,
            "the measurement file has no rows".to_owned(),
            "",
            "one row per measured point is expected",
        ));
    }
    Ok(table)
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
