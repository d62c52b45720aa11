//! The files interferometers and controls write, as readings of error functions.
//!
//! Known by what stands in them: Renishaw RTL (section keys as documented: TARGET DATA, USER-TEXT, RUNS, DEVIATIONS),
//! tables with one column a run, ISG CSV (mm and rad), LinuxCNC compensation triplets, Heidenhain AXISPOS tables, and the
//! product's own CSV. What such a file does not say (function, unit, sign) is asked.

mod controls;
mod renishaw;

use std::path::Path;

use calibration::functions::FunctionReading;
use clap::ValueEnum;
use diagnostic::Diagnostic;
use machine_model::Axis;
use units::{Angle, Length};

use crate::file;
use crate::message::Failure;

use crate::calibrate::codes::{UNREADABLE, question};
use crate::calibrate::sheet::Sheet;

/// What numbers of a control's table mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Values {
    /// Where the axis really was (LinuxCNC COMP_FILE_TYPE = 0).
    Positions,
    /// Actual minus nominal.
    Errors,
    /// What the control adds: nominal minus actual (LinuxCNC COMP_FILE_TYPE = 1).
    Corrections,
}

/// Where the tables of an axis that carries the workpiece were defined.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Reference {
    /// Along the measured line, as an interferometer reads.
    Line,
    /// At the carriage: a rotation acts on the axis' own travel.
    Carriage,
}

/// What kind of numbers a file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::calibrate) enum Origin {
    /// What an instrument read, from its own zero and against its own straightedge.
    Instrument,
    /// Functions of a control's model.
    Control,
    /// The same, at the carriage maybe (ISG).
    ControlAtCarriage,
}

/// Readings of one error function.
#[derive(Debug, Clone)]
pub(in crate::calibrate) struct Series {
    pub(in crate::calibrate) axis: Axis,
    /// 0 to 5: EX EY EZ EA EB EC.
    pub(in crate::calibrate) function: usize,
    pub(in crate::calibrate) readings: Vec<FunctionReading>,
    /// Temperature at each reading, °C, where the file says it; empty where it never does.
    pub(in crate::calibrate) temperatures_c: Vec<Option<f64>>,
    /// Where the numbers came from.
    pub(in crate::calibrate) source: String,
    pub(in crate::calibrate) origin: Origin,
}

impl Series {
    pub(in crate::calibrate) fn new(axis: Axis, function: usize, source: &str, origin: Origin) -> Self {
        let source = source.to_owned();
        Self { axis, function, readings: Vec::new(), temperatures_c: Vec::new(), source, origin }
    }

    /// `EXX`.
    pub(in crate::calibrate) fn name(&self) -> String {
        format!("E{}{}", Axis::ALL[self.function], self.axis)
    }

    /// Temperature at a reading, °C.
    pub(in crate::calibrate) fn temperature_c(&self, reading: usize) -> Option<f64> {
        self.temperatures_c.get(reading).copied().flatten()
    }

    /// Further runs of the same function, from a file of their own.
    pub(in crate::calibrate) fn append(&mut self, other: Series) {
        self.temperatures_c.resize(self.readings.len(), None);
        self.temperatures_c.extend((0..other.readings.len()).map(|k| other.temperature_c(k)));
        let file = other.source;
        let renamed = other.readings.into_iter();
        self.readings.extend(renamed.map(|r| FunctionReading { run: format!("{file}:{}", r.run), ..r }));
    }
}

/// What a file holds.
#[derive(Debug, Default)]
pub(in crate::calibrate) struct Content {
    pub(in crate::calibrate) series: Vec<Series>,
    /// XY, ZX, YZ as the file has them, rad.
    pub(in crate::calibrate) angles_rad: Option<[f64; 3]>,
}

impl From<Vec<Series>> for Content {
    fn from(series: Vec<Series>) -> Self {
        Self { series, angles_rad: None }
    }
}

/// What a file may need to be told.
pub(in crate::calibrate) struct Told<'t> {
    /// `EXX` of `FILE=EXX:um`.
    symbol: Option<(usize, Axis)>,
    unit: Option<&'t str>,
    values: Option<Values>,
}

/// `EXX`: function and axis.
pub(in crate::calibrate) fn symbol(text: &str) -> Option<(usize, Axis)> {
    let letters: Vec<char> = text.chars().collect();
    let [error, direction, axis] = letters[..] else { return None };
    let direction = Axis::from_letter(direction.to_ascii_uppercase())?;
    let axis = Axis::from_letter(axis.to_ascii_uppercase()).filter(|a| a.is_linear())?;
    error.eq_ignore_ascii_case(&'E').then_some((direction as usize, axis))
}

/// mm or rad per unit.
fn factor(function: usize, unit: &str) -> Option<f64> {
    Some(match (function < 3, unit) {
        (true, "um" | "µm" | "micron") => Length::from_um(1.0).mm(),
        (true, "mm") => 1.0,
        (false, "urad" | "µrad" | "um_per_m" | "um/m") => Angle::from_urad(1.0).rad(),
        (false, "um_per_mm" | "mrad") => 1e-3,
        (false, "arcsec") => Angle::from_arcsec(1.0).rad(),
        (false, "rad") => 1.0,
        _ => return None,
    })
}

impl Told<'_> {
    fn function(&self, name: &str) -> Result<(usize, Axis), Failure> {
        self.symbol.ok_or_else(|| {
            question(
                format!("{name} does not say which error function it holds"),
                format!("write `{name}=EXX:um`: the standard's symbol and the unit of the deviations"),
            )
        })
    }
    fn factor(&self, name: &str, function: usize, known: Option<&str>) -> Result<f64, Failure> {
        let Some(unit) = self.unit.or(known) else {
            return Err(question(
                format!("{name} does not say the unit of its deviations"),
                format!(
                    "write it behind the symbol, as in `{name}=EXX:um`; um or mm for lengths, urad, arcsec, um_per_mm or rad for angles"
                ),
            ));
        };
        factor(function, unit).ok_or_else(|| {
            let wanted = if function < 3 { "um, mm" } else { "urad, arcsec, um_per_mm, rad" };
            Failure::option(format!("`{unit}` is no unit of this function"), format!("one of: {wanted}"))
        })
    }
    fn values(&self, name: &str, options: &str) -> Result<Values, Failure> {
        self.values.ok_or_else(|| {
            question(
                format!("{name} is a control's table: are its numbers what the axis did, or what the control adds?"),
                format!("add `--values {options}`"),
            )
        })
    }
}

/// The file of `FILE[=SYMBOL[:UNIT]]`.
pub(in crate::calibrate) fn path_of(spec: &str) -> &str {
    spec.rsplit_once('=').map_or(spec, |(path, _)| path)
}

/// Reads `FILE[=SYMBOL[:UNIT]]`.
pub(in crate::calibrate) fn read(
    spec: &str,
    values: Option<Values>,
    ignore: &[String],
) -> Result<Content, Failure> {
    let (path, told) = match spec.rsplit_once('=') {
        Some((path, rest)) => {
            let (name, unit) = rest.split_once(':').map_or((rest, None), |(name, unit)| (name, Some(unit)));
            let known = symbol(name).ok_or_else(|| {
                Failure::option(
                    format!("`{name}` is no error function of a linear axis"),
                    "write a symbol of ISO 230-1 as in `x.rtl=EXX:um`",
                )
            })?;
            (path, Told { symbol: Some(known), unit, values })
        }
        None => (spec, Told { symbol: None, unit: None, values }),
    };
    let name = file::name(Path::new(path));
    let bytes = file::read(Path::new(path))?;
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let text = text.trim_start_matches('\u{feff}');
    let lines = || {
        text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#') && !l.starts_with("//"))
    };
    let first = lines().next().unwrap_or_default();
    if lines().any(|l| l.eq_ignore_ascii_case("DEVIATIONS::")) {
        return Ok(vec![renishaw::rtl(&name, text, &told)?].into());
    }
    if first.to_uppercase().contains("AXISPOS") || lines().any(|l| l.to_uppercase().contains("AXISPOS")) {
        return Ok(controls::heidenhain(&name, text, &told)?.into());
    }
    if first.split_whitespace().next().is_some_and(|w| matches!(w, "X" | "Y" | "Z")) && !first.contains(',') {
        return controls::isg(&name, text);
    }
    if lines().all(|l| numbers(l).is_some_and(|n| n.len() == 3) && !l.contains(',')) && !first.is_empty() {
        return Ok(vec![controls::triplets(&name, text, &told)?].into());
    }
    let start = first.to_lowercase();
    if (start.starts_with("target") || (start.starts_with("position") && !start.starts_with("position_mm")))
        && start.contains("run")
    {
        return Ok(vec![renishaw::columns_of_runs(&name, text, &told)?].into());
    }
    Ok(own_csv(&name, bytes, ignore)?.into())
}

/// All words of a line as numbers.
fn numbers(line: &str) -> Option<Vec<f64>> {
    line.split([' ', '\t', ';', ','])
        .filter(|w| !w.is_empty())
        .map(|w| w.parse::<f64>().ok().filter(|v| v.is_finite()))
        .collect()
}

fn unreadable(name: &str, line: usize, what: impl std::fmt::Display, help: &str) -> Failure {
    Failure::usage(Diagnostic::error(UNREADABLE, format!("{name}:{line}: {what}")).help(help))
}

fn reading(run: &str, position_mm: f64, value: f64, direction: i8) -> FunctionReading {
    FunctionReading { run: run.to_owned(), position_mm, value, direction }
}

/// The product's own CSV: `position_mm`, functions with units, `run`, `dir`.
fn own_csv(name: &str, bytes: Vec<u8>, ignore: &[String]) -> Result<Vec<Series>, Failure> {
    let mut known: Vec<String> = ["position_mm", "run", "dir", "temp_c"].map(str::to_owned).to_vec();
    for axis in &Axis::ALL[..3] {
        for (function, direction) in Axis::ALL.iter().enumerate() {
            let units: &[&str] = if function < 3 { &["um", "mm"] } else { &["urad", "um_per_mm", "arcsec"] };
            known.extend(units.iter().map(|unit| format!("E{direction}{axis}_{unit}")));
        }
    }
    let names: Vec<&str> = known.iter().map(String::as_str).collect();
    let sheet = Sheet::from_bytes(name, bytes, &names, ignore)?;
    sheet.need(
        &["position_mm"],
        "expected: position_mm, any of EXX_um … ECZ_urad, and run, dir where there are repeats",
    )?;
    let mut found = Vec::new();
    for column in known.iter().skip(4).filter(|c| sheet.has(c)) {
        let Some((head, unit)) = column.split_once('_') else { continue };
        let (Some((function, axis)), Some(factor)) =
            (symbol(head), symbol(head).and_then(|(f, _)| factor(f, unit)))
        else {
            continue;
        };
        let mut series = Series::new(axis, function, name, Origin::Instrument);
        for row in sheet.rows() {
            if let Some(value) = row.number(column)? {
                let run = row.text("run");
                series.temperatures_c.push(row.number("temp_c")?);
                series.readings.push(reading(
                    if run.is_empty() { "1" } else { &run },
                    row.needed("position_mm")?,
                    value * factor,
                    row.sign("dir")?,
                ));
            }
        }
        found.push(series);
    }
    if found.is_empty() {
        return Err(question(
            format!("{name} has no column of an error function"),
            "name it by symbol and unit, as in EXX_um or EBX_urad",
        ));
    }
    Ok(found)
}
