//! What `calibrate` reads: `FILE[=SYMBOL[:UNIT]]`, and tables with named columns.

use std::path::Path;

use calibration::functions::FunctionReading;
use diagnostic::{Text, both};
use machine_model::effects::Conditions;
use measurement_files::series::{Content, Series, Told, symbol};
use measurement_files::{Codes, Kind, Row, Sheet};

use crate::file;
use crate::message::Failure;

/// Reads a table of one of the instruments.
pub(crate) fn sheet(path: &Path, columns: &str, expected: Text, ignore: &[String]) -> Result<Sheet, Failure> {
    let kind = Kind {
        columns,
        expected,
        passes_over: Some("published_"),
        may_be_empty: false,
        codes: Codes::MEASUREMENTS,
    };
    Ok(Sheet::read(&file::name(path), &file::read(path)?, &kind, Some(ignore))?)
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

/// The file of `FILE[=SYMBOL[:UNIT]]`.
pub(super) fn path_of(spec: &str) -> &str {
    spec.rsplit_once('=').map_or(spec, |(path, _)| path)
}

/// Reads `FILE[=SYMBOL[:UNIT]]`.
pub(super) fn series<'s>(spec: &'s str, mut told: Told<'s>, ignore: &[String]) -> Result<Content, Failure> {
    if let Some((_, rest)) = spec.rsplit_once('=') {
        let (name, unit) = rest.split_once(':').map_or((rest, None), |(name, unit)| (name, Some(unit)));
        let known = symbol(name).ok_or_else(|| {
            Failure::option(
                both!(
                    "`{name}` is no error function of a linear axis",
                    "`{name}` — не функция погрешности линейной оси"
                ),
                both!(
                    "write a symbol of ISO 230-1 as in `x.rtl=EXX:um`",
                    "напишите обозначение по ISO 230-1, например `x.rtl=EXX:um`"
                ),
            )
        })?;
        (told.symbol, told.unit) = (Some(known), unit);
    }
    let path = Path::new(path_of(spec));
    Ok(measurement_files::series::read(&file::name(path), &file::read(path)?, told, ignore)?)
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
