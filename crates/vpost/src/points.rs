//! Points as CSV.

use diagnostic::{Code, Diagnostic};
use machine_model::{Command, Vector};
use machine_profile::Profile;

use crate::figures::fixed;
use crate::message::Failure;

/// A point file that cannot be used.
pub(crate) const POINTS: Code = Code(901);

/// Points read from a file, with the text they came from.
pub(crate) struct Points {
    /// The header's columns as written.
    pub columns: Vec<String>,
    /// The fields as written and the command they mean.
    pub rows: Vec<(Vec<String>, Command)>,
    /// Which rotary axes have a column.
    pub rotary: [bool; 3],
}

const NAMES: [&str; 12] = [
    "x_mm",
    "y_mm",
    "z_mm",
    "a_deg",
    "b_deg",
    "c_deg",
    "tool_x_mm",
    "tool_y_mm",
    "tool_z_mm",
    "dir_x",
    "dir_y",
    "dir_z",
];

/// Columns of the tool's direction, for machines that turn it or the workpiece.
pub(crate) const DIRECTION_COLUMNS: &str = ",tool_i,tool_j,tool_k,tilt_urad";

/// The tool's real direction as the workpiece sees it, from the tip up, and its angle from the ideal one, µrad.
pub(crate) fn direction_fields(machine: &machine_model::RigidBody, command: &Command) -> String {
    let [_, real] = machine.directions(command);
    let tilt_urad = machine_model::PathModel::tilt_rad(machine, command) * 1e6;
    let [i, j, k] = [real.x, real.y, real.z].map(|v| fixed(v, 9));
    format!(",{i},{j},{k},{}", fixed(tilt_urad, 3))
}

impl Points {
    /// Reads points.
    ///
    /// `tool_mm`: the tool vector of rows that give none.
    pub(crate) fn read(
        name: &str,
        bytes: &[u8],
        tool_mm: [f64; 3],
        profile: &Profile,
    ) -> Result<Self, Failure> {
        let refuse = |span: Option<std::ops::Range<u64>>, message: String, label: &str, help: String| {
            let mut diagnostic = Diagnostic::error(POINTS, message).help(help);
            if let Some(span) = span {
                diagnostic = diagnostic.at(span, label);
            }
            Failure::refused(name, bytes, vec![diagnostic])
        };
        let expected =
            "x_mm,y_mm,z_mm[,a_deg,b_deg,c_deg][,tool_x_mm,tool_y_mm,tool_z_mm][,dir_x,dir_y,dir_z]";
        let mut reader = csv::ReaderBuilder::new()
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(bytes);
        let mut records = reader.byte_records();
        let header = match records.next() {
            Some(Ok(header)) => header,
            _ => {
                return Err(refuse(
                    None,
                    "the point file is empty".to_owned(),
                    "",
                    format!("a header is expected: {expected}"),
                ));
            }
        };
        let text = |field: &[u8]| String::from_utf8_lossy(field).trim_start_matches('\u{feff}').to_owned();
        let columns: Vec<String> = header.iter().map(text).collect();
        let mut place = [None; 12];
        for (at, column) in columns.iter().enumerate() {
            let span = field_span(bytes, header.position(), at);
            let Some(known) = NAMES.iter().position(|known| known == column) else {
                return Err(refuse(
                    span,
                    format!("column `{column}` is unknown"),
                    "this column",
                    format!("expected: {expected}"),
                ));
            };
            if place[known].replace(at).is_some() {
                return Err(refuse(
                    span,
                    format!("column `{column}` stands twice"),
                    "the second one",
                    "remove one of them".to_owned(),
                ));
            }
        }
        for axis in 0..3 {
            if place[axis].is_none() {
                let span = field_span(bytes, header.position(), 0);
                return Err(refuse(
                    span,
                    format!("column `{}` is missing", NAMES[axis]),
                    "the header",
                    format!("expected: {expected}"),
                ));
            }
        }
        let mut rows = Vec::new();
        for record in records {
            let record = record.map_err(|error| {
                refuse(
                    None,
                    format!("the point file cannot be read: {error}"),
                    "",
                    "write plain CSV with commas".to_owned(),
                )
            })?;
            if record.iter().all(<[u8]>::is_empty) {
                continue;
            }
            if record.len() != columns.len() {
                let span = field_span(bytes, record.position(), 0);
                return Err(refuse(
                    span,
                    format!("{} fields, the header has {}", record.len(), columns.len()),
                    "this row",
                    "give every row as many fields as the header; write 0.5, not 0,5".to_owned(),
                ));
            }
            let mut values = [0.0; 12];
            values[6..9].copy_from_slice(&tool_mm);
            for (value, at) in values.iter_mut().zip(place) {
                let Some(at) = at else { continue };
                let field = text(&record[at]);
                match field.parse::<f64>() {
                    Ok(number) if number.is_finite() => *value = number,
                    _ => {
                        let span = field_span(bytes, record.position(), at);
                        return Err(refuse(
                            span,
                            format!("`{field}` is not a number"),
                            columns[at].as_str(),
                            "write a decimal number with a point".to_owned(),
                        ));
                    }
                }
            }
            let lacks = |axis: &usize| values[3 + axis] != 0.0 && !profile.has_rotary()[*axis];
            if let Some((axis, at)) = (0..3).find(lacks).and_then(|axis| Some((axis, place[3 + axis]?))) {
                return Err(refuse(
                    field_span(bytes, record.position(), at),
                    format!("the machine has no axis {}", ['A', 'B', 'C'][axis]),
                    &format!("the profile's chain is {}", profile.chain()),
                    "leave the column out, or give the profile of the machine that turns".to_owned(),
                ));
            }
            let direction = [values[9], values[10], values[11]].map(|d| {
                if d > 0.0 {
                    1
                } else if d < 0.0 {
                    -1
                } else {
                    0
                }
            });
            let vector = |at: usize| Vector::new(values[at], values[at + 1], values[at + 2]);
            let command = Command {
                linear_mm: vector(0),
                rotary_rad: vector(3).map(f64::to_radians),
                tool_mm: vector(6),
                direction,
            };
            rows.push((record.iter().map(text).collect(), command));
        }
        let rotary = [place[3].is_some(), place[4].is_some(), place[5].is_some()];
        Ok(Self { columns, rows, rotary })
    }
}

/// Bytes of a field of a record; the record starts at its position.
fn field_span(bytes: &[u8], position: Option<&csv::Position>, field: usize) -> Option<std::ops::Range<u64>> {
    let start = usize::try_from(position?.byte()).ok()?;
    let mut at = start;
    for _ in 0..field {
        at += bytes[at..].iter().position(|byte| *byte == b',')? + 1;
    }
    let length =
        bytes[at..].iter().position(|byte| matches!(byte, b',' | b'\n' | b'\r')).unwrap_or(bytes.len() - at);
    Some(at as u64..(at + length) as u64)
}
