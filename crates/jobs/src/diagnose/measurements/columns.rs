//! What the columns of a measurement file show to be wrong, numbers apart.

use std::borrow::Cow;
use std::collections::BTreeMap;

use diagnostic::Code;
use measurement_files::codes::{CELL, COLUMN};
use measurement_files::{Refusal, Row, Sheet};

/// Rows that repeat each other exactly.
const DUPLICATES: Code = Code(914);
/// A column that says nothing.
const EMPTY: Code = Code(915);

/// Columns of readings.
pub(super) const READINGS: [&str; 9] =
    ["dx_um", "dy_um", "dz_um", "xm_mm", "ym_mm", "zm_mm", "d_um", "length_mm", "deviation_um"];

/// Which columns stand together.
pub(super) fn agree(sheet: &Sheet) -> Result<(), Box<Refusal>> {
    sheet.need(&["run"], "give every measurement line an id: rows of one line share one set-up offset")?;
    if !sheet.is_polar() {
        let help = "the commanded position of all three axes is needed, machine coordinates";
        sheet.need(&["x_mm", "y_mm", "z_mm"], help)?;
    }
    let any = |columns: &[&str]| columns.iter().any(|c| sheet.has(c));
    let kinds = [
        ("dx_um, dy_um, dz_um", any(&READINGS[..3])),
        ("xm_mm, ym_mm, zm_mm", any(&READINGS[3..6])),
        ("d_um", sheet.has("d_um")),
        ("length_mm", sheet.has("length_mm")),
        ("angle_deg, deviation_um", sheet.is_polar()),
    ];
    let given: Vec<&str> = kinds.iter().filter(|(_, has)| *has).map(|(name, _)| *name).collect();
    match given.as_slice() {
        [] => sheet.need(
            &["dx_um"],
            "one kind of reading is needed: dx_um,dy_um,dz_um or xm_mm,ym_mm,zm_mm or d_um or length_mm or angle_deg with deviation_um",
        ),
        ["length_mm" | "angle_deg, deviation_um"] => sheet.need_bars(),
        [_] => Ok(()),
        _ => {
            let message = format!("two kinds of reading: {}", given.join(" and "));
            Err(sheet.refuse_header(COLUMN, message, "keep one of them in the file"))
        }
    }
}

/// Conditions that stand in some rows only: the rows without would count as none of that condition.
///
/// A feed may be left out: a row that was read at rest has none.
pub(super) fn everywhere(sheet: &Sheet) -> Result<(), Box<Refusal>> {
    let uncertainties = ["u_x_um", "u_y_um", "u_z_um"];
    let conditions = [
        "load_kg",
        "temp_c",
        "temp_x_c",
        "temp_y_c",
        "temp_z_c",
        "time_s",
        "instrument",
        "artefact",
        "station",
    ];
    if let (Some(column), Some(missing)) =
        (uncertainties.into_iter().find(|c| sheet.has(c)), uncertainties.into_iter().find(|c| !sheet.has(c)))
    {
        let message =
            format!("`{column}` stands without `{missing}`: the covariance of a reading is incomplete");
        let help = "give u_x_um, u_y_um and u_z_um, or u_um for all three";
        return Err(sheet.refuse_column(COLUMN, column, message, help));
    }
    for column in conditions.into_iter().filter(|column| sheet.has(column)) {
        let mut empty = sheet.rows().filter(|row| row.text(column).is_empty());
        let Some(first) = empty.next() else { continue };
        let (further, all) = (empty.count(), sheet.rows().len());
        if further + 1 < all {
            let message = format!(
                "`{column}` is empty here and in {further} further rows, and filled in in {}",
                all - further - 1
            );
            let help = "give the condition in every row, or pass the column over with --ignore-column";
            return Err(first.refuse(CELL, column, message, help));
        }
    }
    Ok(())
}

/// Two stations of a tracker without their places: what one of them reads wrong cannot be told from the machine.
pub(super) fn placed(sheet: &Sheet, stations: &[String]) -> Result<(), Box<Refusal>> {
    if stations.len() < 2 {
        return Ok(());
    }
    let missing =
        |row: &Row<'_>| ["bx_mm", "by_mm", "bz_mm"].into_iter().find(|key| row.text(key).is_empty());
    let Some((row, name)) = sheet.rows().find_map(|row| missing(&row).map(|name| (row, name))) else {
        return Ok(());
    };
    let message = format!(
        "{} stations ({}), and no place of this one: `{name}` is missing",
        stations.len(),
        stations.join(", ")
    );
    let help =
        "give bx_mm, by_mm and bz_mm, where the tracker stood in machine coordinates, to a few centimetres";
    Err(row.refuse(COLUMN, "station", message, help))
}

/// Reading columns that are empty, or the same number, in every row.
pub(super) fn alive(sheet: &Sheet) -> Result<(), Box<Refusal>> {
    for column in READINGS.into_iter().filter(|column| sheet.has(column)) {
        let mut cells = sheet.rows().map(|row| row.text(column));
        if cells.clone().all(|cell| cell.is_empty()) {
            let message = format!("column `{column}` is empty in every row");
            let help = "remove the column if the component was not measured";
            return Err(sheet.refuse_column(EMPTY, column, message, help));
        }
        let first = cells.next().unwrap_or_default();
        if sheet.rows().len() > 6 && cells.all(|cell| cell == first) {
            let message = format!("column `{column}` holds {first} in every row");
            let help = "an instrument that reads always the same was not measuring; remove the column";
            return Err(sheet.refuse_column(EMPTY, column, message, help));
        }
    }
    Ok(())
}

/// Rows that agree in every cell, reading included, were copied.
pub(super) fn no_copies(sheet: &Sheet) -> Result<(), Box<Refusal>> {
    let mut seen: BTreeMap<Vec<Cow<'_, str>>, Row<'_>> = BTreeMap::new();
    let mut copies: Vec<(Row<'_>, Row<'_>)> = Vec::new();
    for row in sheet.rows() {
        let cells: Vec<Cow<'_, str>> = row.cells().collect();
        if let Some(first) = seen.get(&cells) {
            copies.push((*first, row));
        } else {
            seen.insert(cells, row);
        }
    }
    if copies.len() < 3.max(sheet.rows().len() / 20) {
        return Ok(());
    }
    let (first, copy) = copies[0];
    let message = format!(
        "{} rows repeat an earlier row in every field; line {} repeats line {}",
        copies.len(),
        copy.line(),
        first.line()
    );
    Err(copy.refuse_row(
        DUPLICATES,
        message,
        "a copy",
        "real repeats differ in the reading; remove the copies",
    ))
}
