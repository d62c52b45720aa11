//! The files interferometers and controls write, as readings of error functions.
//!
//! Known by what stands in them: Renishaw RTL (section keys as documented: TARGET DATA, USER-TEXT, RUNS, DEVIATIONS),
//! tables with one column a run, API's means by direction (`.pos`), ISG CSV (mm and rad), LinuxCNC compensation triplets, Heidenhain AXISPOS tables, and the
//! product's own CSV. What such a file does not say (function, unit, sign) is asked.

mod controls;
mod directional;
mod file;
mod renishaw;

use diagnostic::{Text, both};
pub use file::{Content, Origin, Series, SeriesReading, Told, Values, Ways, symbol};
use file::{File, numbers};

use machine_model::Axis;

use crate::codes::{AXES, COLUMN, QUESTION};
use crate::refusal::{Codes, Refusal};
use crate::sheet::{Kind, Sheet};
use crate::text::decoded;
use crate::unit::{MM, RAD, UM};

/// Reads a file of an interferometer or a control; `ignore` are columns of the product's own CSV to pass over.
///
/// # Errors
/// What is wrong with the file, where; or what it does not say, and how to say it.
pub fn read(name: &str, bytes: &[u8], told: Told<'_>, ignore: &[String]) -> Result<Content, Box<Refusal>> {
    let text = decoded(bytes);
    let file = File { name, text: &text, told };
    let lines = || file.lines().map(|line| line.text).filter(|l| !l.starts_with('#') && !l.starts_with("//"));
    let first = lines().next().unwrap_or_default();
    if lines().any(|l| l.eq_ignore_ascii_case("DEVIATIONS::")) {
        return Ok(vec![renishaw::rtl(&file)?].into());
    }
    if lines().any(|l| l.to_lowercase().contains(directional::HEADING)) {
        return Ok(vec![directional::read(&file)?].into());
    }
    if lines().any(|l| l.to_uppercase().contains("AXISPOS")) {
        return Ok(controls::heidenhain(&file)?.into());
    }
    if first.split_whitespace().next().is_some_and(|w| matches!(w, "X" | "Y" | "Z"))
        && !first.contains([',', ';'])
    {
        return controls::isg(&file);
    }
    if lines().all(|l| numbers(l).is_some_and(|n| n.len() == 3) && !l.contains(',')) && !first.is_empty() {
        return Ok(vec![controls::triplets(&file)?].into());
    }
    let start = first.to_lowercase();
    if (start.starts_with("target") || (start.starts_with("position") && !start.starts_with("position_mm")))
        && start.contains("run")
    {
        return Ok(vec![renishaw::columns_of_runs(&file)?].into());
    }
    Ok(own_csv(name, bytes, told, ignore)?.into())
}

/// The product's own CSV: `position_mm`, functions with units or deviations of axes, `run`, `dir`.
fn own_csv(name: &str, bytes: &[u8], told: Told<'_>, ignore: &[String]) -> Result<Vec<Series>, Box<Refusal>> {
    let linear = || Axis::ALL.into_iter().take(3);
    let of_axis = |axis| {
        Axis::ALL.iter().enumerate().map(move |(function, direction)| {
            let unit = if function < 3 { MM } else { RAD };
            (axis, function, format!("E{direction}{axis}_{}", unit.name))
        })
    };
    let mut functions: Vec<(Axis, usize, String)> = linear().flat_map(of_axis).collect();
    let keys: Vec<&str> = functions.iter().map(|(.., key)| key.as_str()).collect();
    let kind = Kind {
        columns: &format!("position_mm run dir temp_c {} {}", DEVIATIONS.join(" "), keys.join(" ")),
        expected: Text::pair(
            "expected: position_mm, any of EXX_um … ECZ_urad, and run, dir where there are repeats",
            "ожидалось: position_mm, любые из EXX_um … ECZ_urad, а при повторах run и dir",
        ),
        passes_over: Some("published_"),
        may_be_empty: false,
        codes: Codes::MEASUREMENTS,
    };
    let sheet = Sheet::read(name, bytes, &kind, Some(ignore))?;
    sheet.need(&["position_mm"], kind.expected)?;
    functions.retain(|(.., key)| sheet.has(key));
    functions.extend(deviations(&sheet, told, functions.first().map(|(axis, ..)| *axis))?);
    let mut found: Vec<Series> = Vec::new();
    for (axis, function, key) in &functions {
        let mut series = Series::new(*axis, *function, name, Origin::Instrument);
        if let Some(other) = found.first().filter(|other| other.axis != *axis) {
            let message = both!(
                "two axes in one file: {} and {} at one position_mm",
                "две оси в одном файле: {} и {} при одном position_mm",
                other.name(),
                series.name()
            );
            let help = both!("give each axis a file of its own", "дайте каждой оси отдельный файл");
            return Err(sheet.refuse_column(COLUMN, key, message, help));
        }
        if found.iter().any(|other| other.function == *function) {
            let message = both!("{} stands twice in the file", "{} стоит в файле дважды", series.name());
            let help = both!("remove one of the two columns", "уберите один из двух столбцов");
            return Err(sheet.refuse_column(COLUMN, key, message, help));
        }
        let scale = if DEVIATIONS.contains(&key.as_str()) { UM.factor_to(MM) } else { 1.0 };
        for row in sheet.rows() {
            if let Some(value) = row.number(key)? {
                let run = row.text("run");
                series.readings.push(SeriesReading {
                    run: if run.is_empty() { "1".to_owned() } else { run.into_owned() },
                    position_mm: row.needed("position_mm")?,
                    value: value * scale,
                    direction: row.sign("dir")?,
                    temperature_c: row.number("temp_c")?,
                });
            }
        }
        found.push(series);
    }
    if found.is_empty() {
        let help = both!(
            "name error functions by symbol and unit, as in EXX_um or EBX_urad",
            "называйте функции погрешности обозначением и единицей: EXX_um, EBX_urad"
        );
        return Err(sheet.lacks("EXX_mm", help));
    }
    holds_what_is_told(&sheet, told, &found, &functions[0].2)?;
    Ok(found)
}

/// Refuses a file that does not hold the function which the command line names.
fn holds_what_is_told(
    sheet: &Sheet,
    told: Told<'_>,
    found: &[Series],
    key: &str,
) -> Result<(), Box<Refusal>> {
    if let Some((function, axis)) = told.symbol
        && !found.iter().any(|series| (series.function, series.axis) == (function, axis))
    {
        let symbol = Series::new(axis, function, sheet.name(), Origin::Instrument).name();
        let held: Vec<String> = found.iter().map(Series::name).collect();
        let message = both!(
            "{symbol} was asked for, the file holds {}",
            "запрошена {symbol}, а в файле {}",
            held.join(", ")
        );
        let help =
            both!("correct the symbol behind the file's name", "исправьте обозначение после имени файла");
        return Err(sheet.refuse_column(AXES, key, message, help));
    }
    Ok(())
}

/// Deviations along X, Y, Z.
const DEVIATIONS: [&str; 3] = ["dx_um", "dy_um", "dz_um"];

/// Functions of which a file has deviations by direction: of the axis that it names elsewhere, that is told, or that
/// alone deviates.
fn deviations(
    sheet: &Sheet,
    told: Told<'_>,
    named: Option<Axis>,
) -> Result<Vec<(Axis, usize, String)>, Box<Refusal>> {
    let own: Vec<usize> = (0..3).filter(|direction| sheet.has(DEVIATIONS[*direction])).collect();
    let alone = if let [one] = own[..] { Some(Axis::ALL[one]) } else { None };
    let Some(axis) = named.or(told.symbol.map(|(_, axis)| axis)).or(alone) else {
        let Some(first) = own.first() else { return Ok(Vec::new()) };
        let message = both!(
            "which axis moved? the file has deviations of several",
            "какая ось двигалась? в файле отклонения нескольких"
        );
        let help = both!(
            "say it behind the file's name: `{}=EXX` for X",
            "скажите это после имени файла: `{}=EXX` для X",
            sheet.name()
        );
        return Err(sheet.refuse_column(QUESTION, DEVIATIONS[*first], message, help));
    };
    Ok(own.into_iter().map(|direction| (axis, direction, DEVIATIONS[direction].to_owned())).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn positioning(text: &str, values: Option<Values>) -> Result<Content, Box<Refusal>> {
        read("a.pos", text.as_bytes(), Told { symbol: symbol("EXX"), values, ..Told::default() }, &[])
    }

    /// Written by hand after the headings that a public reader looks for.
    const MEANS: &str = "Axis X\r\nPosition   \tBidirectional Avg Error\r\n0.000\t0.0010\r\n100.000\t0.0030\r\n\
        Position   \tForward Directional Avg Error\r\n0.000\t0.0005\r\n100.000\t0.0025\r\n\
        Position   \tReverse Directional Avg Error\r\n0.000\t0.0015\r\n100.000\t0.0035\r\n";

    #[test]
    fn means_by_direction_are_read_in_mm_with_the_sign_that_is_told() {
        let content = positioning(MEANS, Some(Values::Corrections)).expect("a table");
        let found: Vec<(f64, f64, i8)> =
            content.series[0].readings.iter().map(|r| (r.position_mm, r.value, r.direction)).collect();
        assert_eq!(found, [(0.0, -0.0005, 1), (100.0, -0.0025, 1), (0.0, -0.0015, -1), (100.0, -0.0035, -1)]);
        let one = MEANS.split("Position   \tForward").next().expect("a part");
        let content = positioning(one, Some(Values::Errors)).expect("a table");
        let found: Vec<(f64, i8)> =
            content.series[0].readings.iter().map(|r| (r.value, r.direction)).collect();
        assert_eq!(found, [(0.001, 0), (0.003, 0)]);
    }

    #[test]
    fn what_sign_the_means_have_is_asked() {
        let refusal = positioning(MEANS, None).expect_err("a question");
        assert!(refusal.diagnostic.message.english().contains("what the axis did, or what the control adds"));
    }
}
