//! What `calibrate` reads: `FILE[=SYMBOL[:UNIT]]`, and tables with named columns.

use std::path::Path;

use calibration::CalibrationError;
use calibration::functions::FunctionReading;
use diagnostic::{Speaks, Text, both, notice};
use machine_model::Vector;
use machine_model::effects::Conditions;
use measurement_files::series::{Content, Series, Told, symbol};
use measurement_files::{Codes, Kind, Row, Sheet};

use super::codes::{CELL, OUTLIER, QUESTION, failure};
use super::work::Work;
use crate::message::{Failure, OPTION};

/// Reads a table of one of the instruments.
///
/// # Errors
/// What is wrong with it.
pub fn sheet(
    (name, bytes): (String, Vec<u8>),
    columns: &str,
    expected: Text,
    ignore: &[String],
) -> Result<Sheet, Failure> {
    let kind = Kind {
        columns,
        expected,
        passes_over: Some("published_"),
        may_be_empty: false,
        codes: Codes::MEASUREMENTS,
    };
    Ok(Sheet::read(&name, &bytes, &kind, Some(ignore))?)
}

/// The conditions under which a row was read: its own, else those said for all.
///
/// * `temperature_c` – `--temperature`, of a row that says none
pub(super) fn conditions_of(
    row: &Row<'_>,
    said: Conditions,
    temperature_c: Option<f64>,
) -> Result<Conditions, Failure> {
    let warm = row.number("temp_c")?.or(temperature_c);
    Ok(Conditions {
        temp_c: said.temp_c.map(|known| warm.or(known)),
        time_s: row.number("time_s")?.or(said.time_s),
        load_kg: row.number("load_kg")?.or(said.load_kg),
        feed_mm_min: row.number("feed_mm_min")?.or(said.feed_mm_min),
        ..said
    })
}

/// What several tables hold, and where each reading stands.
pub struct Read<T> {
    /// What each row says.
    pub rows: Vec<T>,
    sheets: Vec<Sheet>,
    /// Sheet and line of each.
    places: Vec<(usize, usize)>,
    temperatures_c: Vec<f64>,
}

impl<T> Default for Read<T> {
    fn default() -> Self {
        Self { rows: Vec::new(), sheets: Vec::new(), places: Vec::new(), temperatures_c: Vec::new() }
    }
}

impl<T> Read<T> {
    /// Takes a reading from each row.
    ///
    /// # Errors
    /// The first that is refused.
    pub fn add(
        &mut self,
        sheet: Sheet,
        mut reading: impl FnMut(&Row<'_>) -> Result<T, Failure>,
    ) -> Result<(), Failure> {
        for (line, row) in sheet.rows().enumerate() {
            self.rows.push(reading(&row)?);
            self.temperatures_c.extend(row.number("temp_c")?);
            self.places.push((self.sheets.len(), line));
        }
        self.sheets.push(sheet);
        Ok(())
    }

    /// Mean temperature of the rows that have one, °C.
    pub(crate) fn temperature_c(&self) -> Option<f64> {
        mean(&self.temperatures_c)
    }

    /// The row of a reading.
    #[must_use]
    pub fn row(&self, reading: usize) -> Option<Row<'_>> {
        let (sheet, line) = *self.places.get(reading)?;
        self.sheets.get(sheet)?.row(line)
    }

    /// What contradicts the readings; an outlier at its row.
    ///
    /// * `column` – what is looked at there
    pub(crate) fn refused(&self, column: &str, error: &CalibrationError) -> Failure {
        let row = match error {
            CalibrationError::Outlier { point, .. } => self.row(*point),
            _ => None,
        };
        row.map_or_else(
            || failure("", &[], error),
            |row| {
                Failure::at_cell(&row, column)(notice!(OUTLIER; error.text();
                    "measure it again, or take the row out", "измерьте снова или уберите строку"
                ))
            },
        )
    }
}

/// Readings state their uncertainty all together, or none of them.
pub(crate) fn all_state_or_none(stated: usize, all: usize) -> Result<(), Failure> {
    if stated == 0 || stated == all {
        return Ok(());
    }
    Err(Failure::usage(notice!(QUESTION;
        "{stated} of {all} readings state their uncertainty, the others do not",
        "неопределённость указана у {stated} показаний из {all}, у остальных нет";
        "fill the column u_um in every row, or pass it over with `--ignore-column u_um`",
        "заполните столбец u_um во всех строках или пропустите его: `--ignore-column u_um`"
    )))
}

/// The standard uncertainty that a row states in a column, mm.
pub(crate) fn uncertainty_mm(row: &Row<'_>, column: &str) -> Result<Option<f64>, Failure> {
    let stated_um = row.number(column)?;
    if stated_um.is_some_and(|um| um <= 0.0) {
        return Err(Failure::at_cell(row, column)(notice!(CELL;
            "an uncertainty is above zero", "неопределённость больше нуля";
            "give the standard uncertainty in um", "дайте стандартную неопределённость в мкм"
        )));
    }
    Ok(stated_um.map(|um| um * 1e-3))
}

/// The mean; nothing of nothing.
pub(crate) fn mean(all: &[f64]) -> Option<f64> {
    (!all.is_empty()).then(|| all.iter().sum::<f64>() / all.len() as f64)
}

/// The least and the largest.
pub(crate) fn span(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// A line of a report: what is said, and its unit.
pub(super) fn line(row: impl std::fmt::Display, unit: &Text) -> Text {
    both!("{row} {unit}\n", "{row} {unit:#}\n")
}

/// Three numbers, apart by blanks.
pub(crate) fn three(v: &Vector, decimals: usize) -> String {
    [v.x, v.y, v.z].map(|value| format!("{value:.decimals$}")).join(" ")
}

/// The file of `FILE[=SYMBOL[:UNIT]]`.
pub(super) fn path_of(spec: &str) -> &str {
    spec.rsplit_once('=').map_or(spec, |(path, _)| path)
}

/// Reads `FILE[=SYMBOL[:UNIT]]`.
pub(super) fn series<'s>(
    spec: &'s str,
    mut told: Told<'s>,
    ignore: &[String],
    work: &Work<'_>,
) -> Result<Content, Failure> {
    if let Some((_, rest)) = spec.rsplit_once('=') {
        let (name, unit) = rest.split_once(':').map_or((rest, None), |(name, unit)| (name, Some(unit)));
        let known = symbol(name).ok_or_else(|| {
            Failure::usage(notice!(OPTION;
                "`{name}` is no error function of a linear axis",
                "`{name}` — не функция погрешности линейной оси";
                "write a symbol of ISO 230-1 as in `x.rtl=EXX:um`",
                "напишите обозначение по ISO 230-1, например `x.rtl=EXX:um`"
            ))
        })?;
        (told.symbol, told.unit) = (Some(known), unit);
    }
    let (name, bytes) = work.read(Path::new(path_of(spec)))?;
    Ok(measurement_files::series::read(&name, &bytes, told, ignore)?)
}

/// The readings of a series as the evaluation takes them.
pub(super) fn readings(series: &Series) -> Vec<FunctionReading> {
    let reading = |r: &measurement_files::series::SeriesReading| FunctionReading {
        run: r.run.clone(),
        position_mm: r.position_mm,
        value: r.value,
        direction: r.direction,
    };
    series.readings.iter().map(reading).collect()
}
