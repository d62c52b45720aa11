//! What the columns of a measurement file show to be wrong, numbers apart.

use std::borrow::Cow;
use std::collections::BTreeMap;

use diagnostic::{Code, both};
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
    sheet.need(
        &["run"],
        both!(
            "give every measurement line an id: rows of one line share one set-up offset",
            "дайте каждой измерительной линии имя: у строк одной линии общее смещение установки"
        ),
    )?;
    if !sheet.is_polar() {
        let help = both!(
            "the commanded position of all three axes is needed, machine coordinates",
            "нужно заданное положение всех трёх осей, координаты станка"
        );
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
            both!("one kind of reading is needed: dx_um,dy_um,dz_um or xm_mm,ym_mm,zm_mm or d_um or length_mm or angle_deg with deviation_um", "нужны показания одного вида: dx_um,dy_um,dz_um, или xm_mm,ym_mm,zm_mm, или d_um, или length_mm, или angle_deg с deviation_um"),
        ),
        ["length_mm" | "angle_deg, deviation_um"] => sheet.need_bars(),
        [_] => Ok(()),
        _ => {
            let message = both!("two kinds of reading: {}", "показания двух видов: {}", given.join(" and "));
            Err(sheet.refuse_header(COLUMN, message, both!("keep one of them in the file", "оставьте в файле один")))
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
        let message = both!(
            "`{column}` stands without `{missing}`: the covariance of a reading is incomplete",
            "`{column}` стоит без `{missing}`: ковариация показания неполна"
        );
        let help = both!(
            "give u_x_um, u_y_um and u_z_um, or u_um for all three",
            "дайте u_x_um, u_y_um и u_z_um или u_um для всех трёх"
        );
        return Err(sheet.refuse_column(COLUMN, column, message, help));
    }
    for column in conditions.into_iter().filter(|column| sheet.has(column)) {
        let mut empty = sheet.rows().filter(|row| row.text(column).is_empty());
        let Some(first) = empty.next() else { continue };
        let (further, all) = (empty.count(), sheet.rows().len());
        if further + 1 < all {
            let message = both!(
                "`{column}` is empty here and in {further} further rows, and filled in in {}",
                "`{column}` пусто здесь и ещё в строках: {further}, а заполнено в {}",
                all - further - 1
            );
            let help = both!(
                "give the condition in every row, or pass the column over with --ignore-column",
                "дайте условие в каждой строке или пропустите столбец: --ignore-column"
            );
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
    let message = both!(
        "{} stations ({}), and no place of this one: `{name}` is missing",
        "стоянок {} ({}), а места этой нет: не хватает `{name}`",
        stations.len(),
        stations.join(", ")
    );
    let help = both!(
        "give bx_mm, by_mm and bz_mm, where the tracker stood in machine coordinates, to a few centimetres",
        "дайте bx_mm, by_mm и bz_mm — где стоял трекер в координатах станка, с точностью до сантиметров"
    );
    Err(row.refuse(COLUMN, "station", message, help))
}

/// Reading columns that are empty, or the same number, in every row.
pub(super) fn alive(sheet: &Sheet) -> Result<(), Box<Refusal>> {
    for column in READINGS.into_iter().filter(|column| sheet.has(column)) {
        let mut cells = sheet.rows().map(|row| row.text(column));
        if cells.clone().all(|cell| cell.is_empty()) {
            let message =
                both!("column `{column}` is empty in every row", "столбец `{column}` пуст во всех строках");
            let help = both!(
                "remove the column if the component was not measured",
                "уберите столбец, если эту составляющую не измеряли"
            );
            return Err(sheet.refuse_column(EMPTY, column, message, help));
        }
        let first = cells.next().unwrap_or_default();
        if sheet.rows().len() > 6 && cells.all(|cell| cell == first) {
            let message = both!(
                "column `{column}` holds {first} in every row",
                "в столбце `{column}` во всех строках {first}"
            );
            let help = both!(
                "an instrument that reads always the same was not measuring; remove the column",
                "прибор, который всегда показывает одно и то же, не измерял; уберите столбец"
            );
            return Err(sheet.refuse_column(EMPTY, column, message, help));
        }
    }
    Ok(())
}

/// True where the readings are so few different numbers that repeats coincide, as of a dial of 0.01 mm.
fn is_coarse(sheet: &Sheet) -> bool {
    /// Different readings, as a share of all.
    const FEW: f64 = 0.3;
    let rows: Vec<Row<'_>> = sheet.rows().collect();
    read_in(sheet).all(|column| {
        let read = numbers(&rows, column);
        let all = read.len() as f64;
        (different(read).len() as f64) < FEW * all
    })
}

/// The columns of readings that there are.
fn read_in(sheet: &Sheet) -> impl Iterator<Item = &'static str> {
    READINGS.into_iter().filter(|column| sheet.has(column))
}

/// True where repeats of one command lie so few steps of the display apart that some coincide: most do not. Of a part
/// that was pasted twice all do.
fn coincide(sheet: &Sheet, copies: usize) -> bool {
    /// So many steps apart one repeat in twenty coincides.
    const STEPS: f64 = 20.0;
    let rows: Vec<Row<'_>> = sheet.rows().collect();
    let mut commands: BTreeMap<Vec<Cow<'_, str>>, Vec<Row<'_>>> = BTreeMap::new();
    for row in &rows {
        let cells = sheet.columns().zip(row.cells());
        let said = cells.filter(|(column, _)| !READINGS.contains(&column.key.as_str()));
        commands.entry(said.map(|(_, cell)| cell).collect()).or_default().push(*row);
    }
    let are_near = |column: &str| {
        let all = different(numbers(&rows, column));
        let step = all.windows(2).map(|pair| pair[1] - pair[0]).fold(f64::INFINITY, f64::min);
        let repeats =
            commands.values().filter(|rows| rows.len() > 1).map(|rows| different(numbers(rows, column)));
        let mut widths: Vec<f64> = repeats.filter_map(|read| Some(read.last()? - read.first()?)).collect();
        widths.sort_by(f64::total_cmp);
        widths.get(widths.len() / 2).is_none_or(|width| *width < STEPS * step)
    };
    2 * copies <= rows.len() - commands.len() && read_in(sheet).all(are_near)
}

/// Different readings of one column in ascending order.
fn different(mut read: Vec<f64>) -> Vec<f64> {
    /// What is nearer is one reading, in the unit of its column.
    const SAME: f64 = 1e-9;
    read.sort_by(f64::total_cmp);
    read.dedup_by(|next, first| *next - *first < SAME);
    read
}

fn numbers(rows: &[Row<'_>], column: &str) -> Vec<f64> {
    rows.iter().filter_map(|row| row.number(column).ok()?).collect()
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
    let few = copies.len() < 3.max(sheet.rows().len() / 20);
    if few || is_coarse(sheet) || coincide(sheet, copies.len()) {
        return Ok(());
    }
    let (first, copy) = copies[0];
    let message = both!(
        "{} rows repeat an earlier row in every field; line {} repeats line {}",
        "строк, которые в точности повторяют более раннюю: {}; строка {} повторяет строку {}",
        copies.len(),
        copy.line(),
        first.line()
    );
    Err(copy.refuse_row(
        DUPLICATES,
        message,
        both!("a copy", "копия"),
        both!(
            "real repeats differ in the reading; remove the copies",
            "настоящие повторы различаются показаниями; уберите копии"
        ),
    ))
}
