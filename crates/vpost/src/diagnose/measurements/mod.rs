//! Measurements as CSV, and what is plainly wrong with them.

mod columns;
mod plausible;
mod table;

use std::collections::BTreeMap;

use gap_diagnosis::{Measurements, Reading, Row};
use machine_model::effects::{Conditions, EffectGeometry};
use machine_model::{Command, Vector};

use crate::file;
use crate::message::Failure;
pub(super) use plausible::{commands_and_frames, readings_against_model};
pub(super) use table::Table;
use table::{FIELD, table};

/// Reads a measurement file; `tool_mm` is the tool vector of rows that give none.
pub(super) fn read<'a>(
    name: &'a str,
    bytes: &'a [u8],
    tool_mm: [f64; 3],
    ignore: &[String],
    geometry: &EffectGeometry,
) -> Result<(Measurements, Table<'a>), Failure> {
    let table = table(name, bytes, ignore)?;
    columns::agree(&table)?;
    let mut data = Measurements {
        runs: Vec::new(),
        instruments: Vec::new(),
        rows: Vec::new(),
        geometry: geometry.clone(),
    };
    let (mut artefacts, mut stations): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    let mut places = BTreeMap::new();
    for record in &table.records {
        let run_place = table.place["run"];
        let run = file::decoded(record.get(run_place).unwrap_or_default()).into_owned();
        if run.is_empty() {
            return Err(table.refuse(
                FIELD,
                Some((record, run_place)),
                "`run` is empty".to_owned(),
                "this field",
                "give every row the id of its measurement line",
            ));
        }
        let index = *places.entry(run).or_insert_with_key(|run| {
            data.runs.push(run.clone());
            data.runs.len() - 1
        });
        table.number(record, "repeat")?;
        let mut row = row(&table, record, index, tool_mm)?;
        row.instrument = table.text(record, "instrument").map(|name| numbered(&mut data.instruments, name));
        row.artefact = table.text(record, "artefact").map(|name| numbered(&mut artefacts, name));
        row.station = table.text(record, "station").map(|name| numbered(&mut stations, name));
        data.rows.push(row);
    }
    columns::alive(&table)?;
    columns::everywhere(&table)?;
    columns::placed(&table, &stations)?;
    columns::no_copies(&table)?;
    data.follow();
    Ok((data, table))
}

/// The number of a name, in order of appearance.
fn numbered(names: &mut Vec<String>, name: String) -> usize {
    names.iter().position(|known| *known == name).unwrap_or_else(|| {
        names.push(name);
        names.len() - 1
    })
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
    let direction = [
        direction(table, record, "dir_x")?,
        direction(table, record, "dir_y")?,
        direction(table, record, "dir_z")?,
    ];
    let common = table.number(record, "temp_c")?;
    let temp_c = three(["temp_x_c", "temp_y_c", "temp_z_c"])?.map(|own| own.or(common));
    let u_um = uncertainty(table, record)?;
    let measured = three(["xm_mm", "ym_mm", "zm_mm"])?;
    let displacement = three(["dx_um", "dy_um", "dz_um"])?;
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
            station_mm: if table.has("length_mm") { None } else { station(table, record)? },
            ..Conditions::default()
        },
        predicted_mm: Vector::zeros(),
        u_um,
        instrument: None,
        station: None,
        artefact: None,
        reading,
        line: record.position().map_or(0, csv::Position::line),
    })
}

/// Where the station of a tracker stands; nothing where the file does not say.
fn station(table: &Table<'_>, record: &csv::ByteRecord) -> Result<Option<[f64; 3]>, Failure> {
    let place =
        [table.number(record, "bx_mm")?, table.number(record, "by_mm")?, table.number(record, "bz_mm")?];
    Ok(match place {
        [Some(x), Some(y), Some(z)] => Some([x, y, z]),
        _ => None,
    })
}

/// Stated standard uncertainty by component, µm: one number for all, or one each.
fn uncertainty(table: &Table<'_>, record: &csv::ByteRecord) -> Result<[Option<f64>; 3], Failure> {
    let mut found = [table.number(record, "u_um")?; 3];
    for (component, column) in ["u_x_um", "u_y_um", "u_z_um"].into_iter().enumerate() {
        found[component] = table.number(record, column)?.or(found[component]);
    }
    for column in ["u_um", "u_x_um", "u_y_um", "u_z_um"] {
        let Some(u) = table.number(record, column)?.filter(|u| *u <= 0.0) else { continue };
        return Err(table.refuse(
            FIELD,
            Some((record, table.place[column])),
            format!("an uncertainty of {u} um is not possible"),
            column,
            "give the standard uncertainty, above zero, or leave it empty",
        ));
    }
    Ok(found)
}

/// A direction of approach; nothing where it is not known.
fn direction(table: &Table<'_>, record: &csv::ByteRecord, column: &str) -> Result<i8, Failure> {
    match table.number(record, column)? {
        None => Ok(0),
        Some(v) if [-1.0, 0.0, 1.0].contains(&v) => Ok(v as i8),
        Some(v) => Err(table.refuse(
            FIELD,
            Some((record, table.place[column])),
            format!("a direction of {v} is not possible"),
            column,
            "write 1, -1, or 0 for an axis that did not move",
        )),
    }
}
