//! Measurements as CSV, and what is plainly wrong with them.

mod columns;
mod plausible;

use std::collections::BTreeMap;

use diagnostic::{Code, Text, both};
use gap_diagnosis::{Measurements, Reading};
use machine_model::effects::{Conditions, EffectGeometry};
use machine_model::{Command, Vector};
use measurement_files::codes::CELL;
use measurement_files::{Bar, Codes, Kind, Refusal, Row, Sheet, numbered};

use super::books::Slip;
use crate::message::Failure;
pub(super) use plausible::{commands_and_frames, readings_against_model};

/// Columns hold something else than their names say.
const SLIP: Code = Code(919);

const KIND: Kind<'_> = Kind {
    columns: "run x_mm y_mm z_mm a_deg b_deg c_deg dx_um dy_um dz_um xm_mm ym_mm zm_mm d_um length_mm bx_mm by_mm bz_mm \
              dir_x dir_y dir_z feed_mm_min tool_x_mm tool_y_mm tool_z_mm load_kg time_s temp_c temp_x_c temp_y_c \
              temp_z_c repeat u_um u_x_um u_y_um u_z_um instrument artefact station note \
              plane radius_mm angle_deg deviation_um dir",
    expected: Text::pair(
        "expected: run,x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,… and one row per measured point",
        "ожидалось: run,x_mm,y_mm,z_mm,dx_um,dy_um,dz_um,… и по строке на измеренную точку",
    ),
    passes_over: None,
    may_be_empty: false,
    codes: Codes::MEASUREMENTS,
};

/// Reads a measurement file; `tool_mm` is the tool vector of rows that give none.
pub(super) fn read(
    name: &str,
    bytes: &[u8],
    tool_mm: [f64; 3],
    ignore: &[String],
    geometry: &EffectGeometry,
) -> Result<(Measurements, Sheet), Box<Refusal>> {
    let sheet = Sheet::read(name, bytes, &KIND, Some(ignore))?;
    columns::agree(&sheet)?;
    let mut data = Measurements {
        runs: Vec::new(),
        instruments: Vec::new(),
        rows: Vec::new(),
        geometry: geometry.clone(),
    };
    let (mut artefacts, mut stations): (Vec<String>, Vec<String>) = (Vec::new(), Vec::new());
    let mut places = BTreeMap::new();
    for row in sheet.rows() {
        let run = row.text("run").into_owned();
        if run.is_empty() {
            let help = both!(
                "give every row the id of its measurement line",
                "дайте каждой строке имя её измерительной линии"
            );
            return Err(row.refuse(CELL, "run", both!("`run` is empty", "`run` пусто"), help));
        }
        let index = *places.entry(run).or_insert_with_key(|run| {
            data.runs.push(run.clone());
            data.runs.len() - 1
        });
        row.number("repeat")?;
        let text = |key: &str| Some(row.text(key).into_owned()).filter(|text| !text.is_empty());
        data.rows.push(gap_diagnosis::Row {
            instrument: text("instrument").map(|name| numbered(&mut data.instruments, &name)),
            artefact: text("artefact").map(|name| numbered(&mut artefacts, &name)),
            station: text("station").map(|name| numbered(&mut stations, &name)),
            ..measured(&sheet, row, index, tool_mm)?
        });
    }
    columns::alive(&sheet)?;
    columns::everywhere(&sheet)?;
    columns::placed(&sheet, &stations)?;
    columns::no_copies(&sheet)?;
    data.follow();
    Ok((data, sheet))
}

/// The refusal of a file whose columns do not hold what their names say.
pub(super) fn slipped(sheet: &Sheet, slip: &Slip) -> Failure {
    let message = both!(
        "it seems that {}: the gap would be {:.1} um RMS in the place of {:.1} um, with no other cause",
        "похоже, {:#}: расхождение было бы {:.1} мкм вместо {:.1} мкм (среднеквадратичное), без других причин",
        slip.words,
        slip.after_um,
        slip.before_um
    );
    let help = both!(
        "correct the column and diagnose again; with --as-written it is taken as it stands",
        "исправьте столбец и повторите диагностику; с --as-written он берётся как есть"
    );
    sheet.refuse_column(SLIP, slip.column, message, help).into()
}

/// What a row says, names apart.
fn measured(
    sheet: &Sheet,
    row: Row<'_>,
    run: usize,
    tool_mm: [f64; 3],
) -> Result<gap_diagnosis::Row, Box<Refusal>> {
    let has_lengths = sheet.has("length_mm") || sheet.is_polar();
    let bar = if has_lengths { Some(row.bar()?) } else { None };
    let command = match bar {
        // The tool ball is the tip; of a circle only its place is said.
        Some(Bar { ball_mm, direction, .. }) if sheet.is_polar() => {
            let tool_mm = Vector::from(tool_mm);
            Command {
                linear_mm: ball_mm - tool_mm,
                rotary_rad: Vector::zeros(),
                tool_mm,
                direction,
                ..Default::default()
            }
        }
        _ => row.command(tool_mm)?,
    };
    for key in ["dir_x", "dir_y", "dir_z"] {
        if let Some(v) = row.number(key)?.filter(|v| ![-1.0, 0.0, 1.0].contains(v)) {
            let message = both!("a direction of {v} is not possible", "направления {v} не бывает");
            return Err(row.refuse(
                CELL,
                key,
                message,
                both!(
                    "write 1, -1, or 0 for an axis that did not move",
                    "напишите 1, -1 или 0 для неподвижной оси"
                ),
            ));
        }
    }
    let common = row.number("temp_c")?;
    let temp_c = row.any_of(["temp_x_c", "temp_y_c", "temp_z_c"])?.map(|own| own.or(common));
    let u_um = uncertainty(row)?;
    let measured_mm = row.any_of(["xm_mm", "ym_mm", "zm_mm"])?;
    let displacement_um = row.any_of(["dx_um", "dy_um", "dz_um"])?;
    let reading = if let Some(Bar { length_mm, centre_mm, .. }) = bar {
        Reading::Length { length_mm, ball_mm: centre_mm }
    } else if sheet.has("d_um") {
        Reading::Magnitude(row.needed("d_um")?)
    } else if ["xm_mm", "ym_mm", "zm_mm"].iter().any(|c| sheet.has(c)) {
        // A measured position is the tip's, or the gauge point's where the set-up shift holds the tool.
        Reading::Displacement(std::array::from_fn(|i| {
            measured_mm[i].map(|m| 1e3 * (m - command.linear_mm[i]))
        }))
    } else {
        Reading::Displacement(displacement_um)
    };
    // Where the station of a tracker stands; nothing where the file does not say.
    let station_mm = match row.any_of(["bx_mm", "by_mm", "bz_mm"])? {
        [Some(x), Some(y), Some(z)] if !has_lengths => Some([x, y, z]),
        _ => None,
    };
    Ok(gap_diagnosis::Row {
        conditions: Conditions {
            temp_c,
            time_s: row.number("time_s")?,
            load_kg: row.number("load_kg")?,
            feed_mm_min: row.number("feed_mm_min")?,
            station_mm,
            ..Conditions::default()
        },
        u_um,
        line: row.line(),
        ..gap_diagnosis::Row::new(run, command, reading)
    })
}

/// Stated standard uncertainty by component, µm: one number for all, or one each.
fn uncertainty(row: Row<'_>) -> Result<[Option<f64>; 3], Box<Refusal>> {
    let common = row.number("u_um")?;
    let found = row.any_of(["u_x_um", "u_y_um", "u_z_um"])?.map(|own| own.or(common));
    for column in ["u_um", "u_x_um", "u_y_um", "u_z_um"] {
        let Some(u) = row.number(column)?.filter(|u| *u <= 0.0) else { continue };
        let message = both!("an uncertainty of {u} um is not possible", "неопределённости {u} мкм не бывает");
        let help = both!(
            "give the standard uncertainty, above zero, or leave it empty",
            "дайте стандартную неопределённость больше нуля или оставьте пустой"
        );
        return Err(row.refuse(CELL, column, message, help));
    }
    Ok(found)
}
