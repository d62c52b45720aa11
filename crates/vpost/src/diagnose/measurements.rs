//! Measurements as CSV, and what is plainly wrong with them.

use std::collections::BTreeMap;
use std::ops::Range;

use diagnostic::{Code, Diagnostic};
use gap_diagnosis::{Measurements, Reading, Row};
use machine_model::effects::{Conditions, EffectGeometry};
use machine_model::{Command, Vector};
use machine_profile::Profile;

use crate::message::Failure;

/// A measurement file that cannot be read.
const UNREADABLE: Code = Code(910);
/// A column is missing, unknown, twice, or contradicts another.
const COLUMNS: Code = Code(911);
/// A field is not what its column says.
const FIELD: Code = Code(912);
/// The numbers cannot be in the unit of their column.
const UNITS: Code = Code(913);
/// Rows that repeat each other exactly.
const DUPLICATES: Code = Code(914);
/// A column that says nothing.
const EMPTY: Code = Code(915);
/// Rows of different frames in one file.
const FRAMES: Code = Code(916);

const NAMES: [&str; 34] = [
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
    "note",
];

struct Table<'a> {
    name: &'a str,
    bytes: &'a [u8],
    /// Place of each known column.
    place: BTreeMap<&'static str, usize>,
    records: Vec<csv::ByteRecord>,
    header: csv::ByteRecord,
}

impl Table<'_> {
    fn refuse(
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

    /// The number in a column; `None` where the column or the field is empty.
    fn number(&self, record: &csv::ByteRecord, column: &str) -> Result<Option<f64>, Failure> {
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

    fn needed(&self, record: &csv::ByteRecord, column: &str) -> Result<f64, Failure> {
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

    fn has(&self, column: &str) -> bool {
        self.place.contains_key(column)
    }
}

/// Reads a measurement file; `tool_mm` is the tool vector of rows that give none.
pub(super) fn read(
    name: &str,
    bytes: &[u8],
    tool_mm: [f64; 3],
    ignore: &[String],
    geometry: &EffectGeometry,
) -> Result<Measurements, Failure> {
    let table = table(name, bytes, ignore)?;
    columns_agree(&table)?;
    let mut data = Measurements { runs: Vec::new(), rows: Vec::new(), geometry: geometry.clone() };
    for record in &table.records {
        let run_place = table.place["run"];
        let run = String::from_utf8_lossy(record.get(run_place).unwrap_or_default()).into_owned();
        if run.is_empty() {
            return Err(table.refuse(
                FIELD,
                Some((record, run_place)),
                "`run` is empty".to_owned(),
                "this field",
                "give every row the id of its measurement line",
            ));
        }
        let index = data.runs.iter().position(|r| *r == run).unwrap_or_else(|| {
            data.runs.push(run);
            data.runs.len() - 1
        });
        data.rows.push(row(&table, record, index, tool_mm)?);
    }
    dead_columns(&table)?;
    duplicates(&table)?;
    Ok(data)
}

fn table<'a>(name: &'a str, bytes: &'a [u8], ignore: &[String]) -> Result<Table<'a>, Failure> {
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
    let columns: Vec<String> = table
        .header
        .iter()
        .map(|f| String::from_utf8_lossy(f).trim_start_matches('\u{feff}').to_owned())
        .collect();
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

/// Which columns stand together.
fn columns_agree(table: &Table<'_>) -> Result<(), Failure> {
    let missing = |column: &str, help: &str| {
        Err(table.refuse(
            COLUMNS,
            Some((&table.header, 0)),
            format!("column `{column}` is missing"),
            "the header",
            help,
        ))
    };
    if !table.has("run") {
        return missing("run", "give every measurement line an id: rows of one line share one set-up offset");
    }
    for column in ["x_mm", "y_mm", "z_mm"] {
        if !table.has(column) {
            return missing(
                column,
                "the commanded position of all three axes is needed, machine coordinates",
            );
        }
    }
    let any = |columns: &[&str]| columns.iter().any(|c| table.has(c));
    let kinds = [
        ("dx_um, dy_um, dz_um", any(&["dx_um", "dy_um", "dz_um"])),
        ("xm_mm, ym_mm, zm_mm", any(&["xm_mm", "ym_mm", "zm_mm"])),
        ("d_um", table.has("d_um")),
        ("length_mm", table.has("length_mm")),
    ];
    let given: Vec<&str> = kinds.iter().filter(|(_, has)| *has).map(|(name, _)| *name).collect();
    match given.as_slice() {
        [] => missing(
            "dx_um",
            "one kind of reading is needed: dx_um,dy_um,dz_um or xm_mm,ym_mm,zm_mm or d_um or length_mm",
        ),
        [_] => {
            let ball = ["bx_mm", "by_mm", "bz_mm"];
            match ball.into_iter().find(|c| table.has("length_mm") && !table.has(c)) {
                Some(column) => missing(column, "a ball-bar length needs the centre of the fixed ball"),
                None => Ok(()),
            }
        }
        _ => Err(table.refuse(
            COLUMNS,
            Some((&table.header, 0)),
            format!("two kinds of reading: {}", given.join(" and ")),
            "the header",
            "keep one of them in the file",
        )),
    }
}

fn row(table: &Table<'_>, record: &csv::ByteRecord, run: usize, tool_mm: [f64; 3]) -> Result<Row, Failure> {
    let three = |names: [&str; 3]| -> Result<[Option<f64>; 3], Failure> {
        let [x, y, z] = names;
        Ok([table.number(record, x)?, table.number(record, y)?, table.number(record, z)?])
    };
    let linear_mm = Vector::new(
        table.needed(record, "x_mm")?,
        table.needed(record, "y_mm")?,
        table.needed(record, "z_mm")?,
    );
    let rotary = three(["a_deg", "b_deg", "c_deg"])?.map(|v| v.unwrap_or(0.0).to_radians());
    let tool = three(["tool_x_mm", "tool_y_mm", "tool_z_mm"])?;
    let tool: [f64; 3] = std::array::from_fn(|i| tool[i].unwrap_or(tool_mm[i]));
    let direction = three(["dir_x", "dir_y", "dir_z"])?.map(|v| match v {
        Some(v) if v > 0.0 => 1,
        Some(v) if v < 0.0 => -1,
        _ => 0,
    });
    let common = table.number(record, "temp_c")?;
    let temp_c = three(["temp_x_c", "temp_y_c", "temp_z_c"])?.map(|own| own.or(common));
    let u_um = table.number(record, "u_um")?;
    if let Some(u) = u_um.filter(|u| *u <= 0.0) {
        let place = table.place["u_um"];
        return Err(table.refuse(
            FIELD,
            Some((record, place)),
            format!("an uncertainty of {u} um is not possible"),
            "u_um",
            "give the standard uncertainty, above zero, or leave it empty",
        ));
    }
    let measured = three(["xm_mm", "ym_mm", "zm_mm"])?;
    let displacement = three(["dx_um", "dy_um", "dz_um"])?;
    let nominal = linear_mm + Vector::from(tool);
    let reading = if table.has("length_mm") {
        let length_mm = table.needed(record, "length_mm")?;
        let ball_mm = Vector::new(
            table.needed(record, "bx_mm")?,
            table.needed(record, "by_mm")?,
            table.needed(record, "bz_mm")?,
        );
        Reading::Length { length_mm, ball_mm }
    } else if table.has("d_um") {
        Reading::Magnitude(table.needed(record, "d_um")?)
    } else if ["xm_mm", "ym_mm", "zm_mm"].iter().any(|c| table.has(c)) {
        // A measured position is the tip's, or the gauge point's where the set-up shift holds the tool.
        let _ = nominal;
        Reading::Displacement(std::array::from_fn(|i| measured[i].map(|m| 1e3 * (m - linear_mm[i]))))
    } else {
        Reading::Displacement(displacement)
    };
    Ok(Row {
        run,
        command: Command {
            linear_mm,
            rotary_rad: Vector::from(rotary),
            tool_mm: Vector::from(tool),
            direction,
        },
        conditions: Conditions {
            temp_c,
            time_s: table.number(record, "time_s")?,
            load_kg: table.number(record, "load_kg")?,
            feed_mm_min: table.number(record, "feed_mm_min")?,
        },
        predicted_mm: Vector::zeros(),
        u_um,
        reading,
        line: record.position().map_or(0, csv::Position::line),
    })
}

/// Reading columns that are empty, or the same number, in every row.
fn dead_columns(table: &Table<'_>) -> Result<(), Failure> {
    for column in ["dx_um", "dy_um", "dz_um", "xm_mm", "ym_mm", "zm_mm", "d_um", "length_mm"] {
        let Some(place) = table.place.get(column).copied() else { continue };
        let mut fields = table.records.iter().map(|r| r.get(place).unwrap_or_default());
        let here = Some((&table.header, place));
        if fields.clone().all(<[u8]>::is_empty) {
            return Err(table.refuse(
                EMPTY,
                here,
                format!("column `{column}` is empty in every row"),
                "this column",
                "remove the column if the component was not measured",
            ));
        }
        let first = fields.next().unwrap_or_default();
        if table.records.len() > 6 && fields.all(|f| f == first) {
            let value = String::from_utf8_lossy(first);
            let message = format!("column `{column}` holds {value} in every row");
            return Err(table.refuse(
                EMPTY,
                here,
                message,
                "this column",
                "an instrument that reads always the same was not measuring; remove the column",
            ));
        }
    }
    Ok(())
}

/// Rows that agree in every field, reading included, were copied.
fn duplicates(table: &Table<'_>) -> Result<(), Failure> {
    let mut seen: BTreeMap<Vec<&[u8]>, usize> = BTreeMap::new();
    let mut copies: Vec<(usize, usize)> = Vec::new();
    for (index, record) in table.records.iter().enumerate() {
        let fields: Vec<&[u8]> = record.iter().collect();
        if let Some(first) = seen.get(&fields) {
            copies.push((*first, index));
        } else {
            seen.insert(fields, index);
        }
    }
    if copies.len() < 3.max(table.records.len() / 20) {
        return Ok(());
    }
    let (first, copy) = copies[0];
    let line = |i: usize| table.records[i].position().map_or(0, csv::Position::line);
    let message = format!(
        "{} rows repeat an earlier row in every field; line {} repeats line {}",
        copies.len(),
        line(copy),
        line(first)
    );
    Err(table.refuse(
        DUPLICATES,
        Some((&table.records[copy], 0)),
        message,
        "a copy",
        "real repeats differ in the reading; remove the copies",
    ))
}

/// What the numbers themselves show to be wrong: units, frames.
pub(super) fn check(name: &str, bytes: &[u8], data: &Measurements, profile: &Profile) -> Result<(), Failure> {
    let refuse = |code: Code, message: String, help: &str| {
        Err(Failure::refused(name, bytes, vec![Diagnostic::error(code, message).help(help)]))
    };
    let widest = (0..3).map(|a| data.range_mm(a).1 - data.range_mm(a).0).fold(0.0, f64::max);
    if widest > 0.0 && widest < 2.0 && data.rows.len() > 3 {
        return refuse(
            UNITS,
            format!("the commands span {widest} mm in all: are x_mm, y_mm, z_mm metres?"),
            "give the commanded positions in millimetres",
        );
    }
    for axis in 0..3 {
        let travel = profile.description.linear[axis].travel_mm;
        let slack = 0.02 * (travel.high - travel.low) + 1.0;
        let outside = data.rows.iter().find(|r| {
            let q = r.command.linear_mm[axis];
            q < travel.low - slack || q > travel.high + slack
        });
        if let Some(row) = outside {
            let letter = ['X', 'Y', 'Z'][axis];
            return refuse(
                UNITS,
                format!(
                    "line {}: {letter} {} mm lies outside the profile's travel of {} to {} mm",
                    row.line, row.command.linear_mm[axis], travel.low, travel.high
                ),
                "give machine coordinates in millimetres, or the profile of this machine",
            );
        }
    }
    let mut sizes: Vec<f64> = data.scalars(None).iter().map(|s| s.gap_um.abs()).collect();
    sizes.extend(data.rows.iter().filter_map(|r| match r.reading {
        Reading::Magnitude(um) => Some(um.abs()),
        _ => None,
    }));
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    let large = sizes.get(sizes.len() * 9 / 10).copied().unwrap_or(0.0);
    if median > 3000.0 {
        return refuse(
            UNITS,
            format!("half of the deviations exceed {:.1} mm", median * 1e-3),
            "deviations are micrometres, positions are machine coordinates in millimetres: check units and frame",
        );
    }
    if large < 0.05 && data.rows.len() > 3 {
        return refuse(
            UNITS,
            format!("nine deviations of ten are below {large:.4} um"),
            "no machine is that good: are the deviations in millimetres? The columns are micrometres",
        );
    }
    frames(name, bytes, data)
}

/// A run whose mean lies far from all others was measured in another frame.
fn frames(name: &str, bytes: &[u8], data: &Measurements) -> Result<(), Failure> {
    const FAR_UM: f64 = 1000.0;
    for class in 0..3 {
        let mut sums = vec![(0.0, 0.0); data.runs.len()];
        for scalar in data.scalars(None).iter().filter(|s| s.class == class) {
            let run = data.rows[scalar.row].run;
            sums[run] = (sums[run].0 + scalar.gap_um, sums[run].1 + 1.0);
        }
        let means: Vec<(usize, f64)> =
            sums.iter().enumerate().filter(|(_, s)| s.1 > 0.0).map(|(r, s)| (r, s.0 / s.1)).collect();
        let mut sorted: Vec<f64> = means.iter().map(|(_, m)| *m).collect();
        sorted.sort_by(f64::total_cmp);
        let middle = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
        if let Some((run, mean)) = means.iter().find(|(_, m)| (m - middle).abs() > FAR_UM) {
            let component = ["dx", "dy", "dz"][class];
            let message = format!(
                "run `{}`: {component} lies {:.1} mm from the other runs",
                data.runs[*run],
                (mean - middle) * 1e-3
            );
            let help = "all rows must be in one frame, machine commands and readings alike; convert this run or leave it out";
            return Err(Failure::refused(name, bytes, vec![Diagnostic::error(FRAMES, message).help(help)]));
        }
    }
    Ok(())
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
