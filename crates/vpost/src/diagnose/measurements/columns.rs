//! What the columns of a measurement file show to be wrong, numbers apart.

use std::collections::BTreeMap;

use diagnostic::Code;

use super::table::{COLUMNS, FIELD, Table};
use crate::message::Failure;

/// Rows that repeat each other exactly.
const DUPLICATES: Code = Code(914);
/// A column that says nothing.
const EMPTY: Code = Code(915);

/// Which columns stand together.
pub(super) fn agree(table: &Table<'_>) -> Result<(), Failure> {
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

/// Conditions that stand in some rows only: the rows without would count as none of that condition.
///
/// A feed may be left out: a row that was read at rest has none.
pub(super) fn everywhere(table: &Table<'_>) -> Result<(), Failure> {
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
        (uncertainties.into_iter().find(|c| table.has(c)), uncertainties.into_iter().find(|c| !table.has(c)))
    {
        return Err(table.refuse(
            COLUMNS,
            Some((&table.header, table.place[column])),
            format!("`{column}` stands without `{missing}`: the covariance of a reading is incomplete"),
            "this column",
            "give u_x_um, u_y_um and u_z_um, or u_um for all three",
        ));
    }
    for column in conditions {
        let Some(place) = table.place.get(column).copied() else { continue };
        let empty = |r: &&csv::ByteRecord| r.get(place).unwrap_or_default().is_empty();
        let count = table.records.iter().filter(empty).count();
        let Some(first) = table.records.iter().find(empty).filter(|_| count < table.records.len()) else {
            continue;
        };
        return Err(table.refuse(
            FIELD,
            Some((first, place)),
            format!(
                "`{column}` is empty here and in {} further rows, and filled in in {}",
                count - 1,
                table.records.len() - count
            ),
            column,
            "give the condition in every row, or pass the column over with --ignore-column",
        ));
    }
    Ok(())
}

/// Two stations of a tracker without their places: what one of them reads wrong cannot be told from the machine.
pub(super) fn placed(table: &Table<'_>, stations: &[String]) -> Result<(), Failure> {
    let place = ["bx_mm", "by_mm", "bz_mm"];
    let Some(column) = table.place.get("station").copied().filter(|_| stations.len() > 1) else {
        return Ok(());
    };
    let missing = |record: &csv::ByteRecord| {
        place.into_iter().find(|name| {
            table.place.get(name).is_none_or(|at| record.get(*at).unwrap_or_default().is_empty())
        })
    };
    let Some((record, name)) = table.records.iter().find_map(|r| missing(r).map(|name| (r, name))) else {
        return Ok(());
    };
    Err(table.refuse(
        COLUMNS,
        Some((record, column)),
        format!(
            "{} stations ({}), and no place of this one: `{name}` is missing",
            stations.len(),
            stations.join(", ")
        ),
        "this station",
        "give bx_mm, by_mm and bz_mm, where the tracker stood in machine coordinates, to a few centimetres",
    ))
}

/// Reading columns that are empty, or the same number, in every row.
pub(super) fn alive(table: &Table<'_>) -> Result<(), Failure> {
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
pub(super) fn no_copies(table: &Table<'_>) -> Result<(), Failure> {
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
