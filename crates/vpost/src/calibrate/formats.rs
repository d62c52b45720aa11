//! The files interferometers and controls write, as readings of error functions.
//!
//! Known by what stands in them: Renishaw RTL (section keys as documented: TARGET DATA, USER-TEXT, RUNS, DEVIATIONS),
//! tables with one column a run, ISG CSV (mm and rad), LinuxCNC compensation triplets, Heidenhain AXISPOS tables, and the
//! product's own CSV. What such a file does not say (function, unit, sign) is asked.

use std::path::Path;

use calibration::functions::FunctionReading;
use clap::ValueEnum;
use diagnostic::Diagnostic;
use machine_model::Axis;
use units::{Angle, Length};

use crate::file;
use crate::message::Failure;

use super::codes::{UNREADABLE, question};
use super::sheet::Sheet;

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

/// Readings of one error function.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) axis: Axis,
    /// 0 to 5: EX EY EZ EA EB EC.
    pub(super) function: usize,
    pub(super) readings: Vec<FunctionReading>,
    /// Where the numbers came from.
    pub(super) source: String,
    /// The format tables a carriage's errors, maybe (ISG).
    pub(super) reference_asked: bool,
}

/// What a file may need to be told.
pub(super) struct Told<'t> {
    /// `EXX` of `FILE=EXX:um`.
    symbol: Option<(usize, Axis)>,
    unit: Option<&'t str>,
    values: Option<Values>,
}

/// `EXX`: function and axis.
pub(super) fn symbol(text: &str) -> Option<(usize, Axis)> {
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

/// Reads `FILE[=SYMBOL[:UNIT]]`.
pub(super) fn read(spec: &str, values: Option<Values>, ignore: &[String]) -> Result<Vec<Series>, Failure> {
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
        return Ok(vec![rtl(&name, text, &told)?]);
    }
    if first.to_uppercase().contains("AXISPOS") || lines().any(|l| l.to_uppercase().contains("AXISPOS")) {
        return heidenhain(&name, text, &told);
    }
    if first.split_whitespace().next().is_some_and(|w| matches!(w, "X" | "Y" | "Z")) && !first.contains(',') {
        return isg(&name, text);
    }
    if lines().all(|l| numbers(l).is_some_and(|n| n.len() == 3) && !l.contains(',')) && !first.is_empty() {
        return Ok(vec![triplets(&name, text, &told)?]);
    }
    let start = first.to_lowercase();
    if (start.starts_with("target") || (start.starts_with("position") && !start.starts_with("position_mm")))
        && start.contains("run")
    {
        return Ok(vec![columns_of_runs(&name, text, &told)?]);
    }
    own_csv(&name, bytes, ignore)
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

/// Renishaw's RTL text.
fn rtl(name: &str, text: &str, told: &Told<'_>) -> Result<Series, Failure> {
    let (function, axis) = told.function(name)?;
    let factor = told.factor(name, function, None)?;
    let (mut section, mut part) = (String::new(), String::new());
    let mut targets: Vec<f64> = Vec::new();
    let mut rows: Vec<(i64, usize, f64, usize)> = Vec::new();
    let (mut announced_targets, mut announced_runs) = (None, None);
    for (number, line) in text.lines().enumerate() {
        let line = line.trim();
        let words = numbers(line);
        if let Some(title) = line.strip_suffix("::") {
            section = title.trim().to_uppercase();
            part.clear();
        } else if let Some((key, rest)) = line.split_once(':') {
            part = key.trim().to_lowercase();
            let count = rest.trim().parse::<usize>().ok();
            match (section.as_str(), part.as_str()) {
                ("TARGET DATA", "target-count") => announced_targets = count,
                ("RUNS", "run-count") => announced_runs = count,
                ("USER-TEXT", "axis") => {
                    let letters: Vec<Axis> = rest
                        .chars()
                        .filter_map(|c| Axis::from_letter(c.to_ascii_uppercase()))
                        .filter(|a| a.is_linear())
                        .collect();
                    if let [other] = letters[..]
                        && other != axis
                    {
                        return Err(Failure::usage(
                            Diagnostic::error(
                                super::codes::AXES,
                                format!(
                                    "{name}: the file says axis {}, the command line {axis}",
                                    rest.trim()
                                ),
                            )
                            .help("correct the symbol behind the file's name"),
                        ));
                    }
                }
                _ => {}
            }
        } else if let (Some(words), false) = (words, line.is_empty()) {
            match (section.as_str(), part.as_str()) {
                ("TARGET DATA", "targets") => targets.extend(words),
                ("DEVIATIONS", "run target data") => match words[..] {
                    [run, target, value] if run >= 1.0 && target >= 1.0 => {
                        rows.push((run as i64, target as usize, value, number + 1))
                    }
                    _ => {
                        return Err(unreadable(
                            name,
                            number + 1,
                            "expected run, target and deviation",
                            "the file is damaged; export it again",
                        ));
                    }
                },
                _ => {}
            }
        }
    }
    if announced_targets.is_some_and(|n| n != targets.len()) || targets.is_empty() {
        let message = format!(
            "{} targets are announced and {} are there",
            announced_targets.unwrap_or(0),
            targets.len()
        );
        return Err(unreadable(name, 1, message, "the file is damaged; export it again"));
    }
    let found = rows.iter().map(|r| r.0).max().unwrap_or(0);
    if announced_runs.is_some_and(|n| n as i64 != found) {
        return Err(Failure::usage(
            Diagnostic::error(
                super::codes::RUNS,
                format!("{name}: {} runs are announced and {found} are there", announced_runs.unwrap_or(0)),
            )
            .help("the measurement was broken off, or the file is damaged: export complete runs"),
        ));
    }
    let mut readings = Vec::new();
    for run in 1..=found {
        let own: Vec<_> = rows.iter().filter(|r| r.0 == run).collect();
        // A run passes the targets in one direction: the order of its rows says which.
        let at = |k: &usize| targets.get(k - 1).copied();
        let direction = match (own.first().and_then(|r| at(&r.1)), own.last().and_then(|r| at(&r.1))) {
            (Some(a), Some(b)) if b > a => 1,
            (Some(a), Some(b)) if b < a => -1,
            _ => 0,
        };
        for (_, target, value, line) in own {
            let Some(position) = at(target) else {
                return Err(unreadable(
                    name,
                    *line,
                    format!("target {target} of {}", targets.len()),
                    "the file is damaged; export it again",
                ));
            };
            // Runs of the two directions are numbered through; as ISO 230-2 counts them, two make one.
            readings.push(reading(&((run + 1) / 2).to_string(), position, value * factor, direction));
        }
    }
    Ok(Series { axis, function, readings, source: name.to_owned(), reference_asked: false })
}

/// A target column and one column a run, separated by tabs, semicolons or commas. Directions: from `+`/`-`, `forward`/`reverse`
/// or `up`/`down` in the column's title; otherwise odd runs go up and even ones down, as instruments run them.
fn columns_of_runs(name: &str, text: &str, told: &Told<'_>) -> Result<Series, Failure> {
    let (function, axis) = told.function(name)?;
    let mut rows = text
        .lines()
        .enumerate()
        .map(|(k, l)| (k + 1, l.trim()))
        .filter(|(_, l)| !l.is_empty() && !l.starts_with('#'));
    let Some((_, head)) = rows.next() else {
        return Err(unreadable(name, 1, "the file is empty", "export it again"));
    };
    let separator = ['\t', ';', ','].into_iter().find(|s| head.contains(*s)).unwrap_or('\t');
    let titles: Vec<String> = head.split(separator).map(|t| t.trim().to_lowercase()).collect();
    let bracket =
        titles.iter().skip(1).find_map(|t| Some(t.split_once('(')?.1.trim_end_matches(')').to_owned()));
    let factor = told.factor(name, function, bracket.as_deref())?;
    if titles[0].contains('(') && !titles[0].contains("(mm)") {
        return Err(unreadable(
            name,
            1,
            format!("targets in `{}`", titles[0]),
            "give the target positions in mm",
        ));
    }
    let directions: Vec<i8> = titles
        .iter()
        .enumerate()
        .map(|(k, t)| {
            let says = |words: [&str; 3]| words.iter().any(|w| t.contains(w));
            if says(["+", "forward", "up"]) {
                1
            } else if says(["-", "reverse", "down"]) || k % 2 == 0 {
                -1
            } else {
                1
            }
        })
        .collect();
    let mut readings = Vec::new();
    for (number, line) in rows {
        let cells: Vec<&str> = line.split(separator).map(str::trim).collect();
        let target = cells[0].parse::<f64>().map_err(|_| {
            unreadable(
                name,
                number,
                format!("`{}` is no target", cells[0]),
                "write decimal numbers with a point",
            )
        })?;
        for (k, cell) in cells.iter().enumerate().skip(1).filter(|(_, c)| !c.is_empty()) {
            let value = cell.parse::<f64>().map_err(|_| {
                unreadable(
                    name,
                    number,
                    format!("`{cell}` is no number"),
                    "write decimal numbers with a point",
                )
            })?;
            let direction = directions.get(k).copied().unwrap_or(1);
            readings.push(reading(&k.div_ceil(2).to_string(), target, value * factor, direction));
        }
    }
    Ok(Series { axis, function, readings, source: name.to_owned(), reference_asked: false })
}

/// LinuxCNC: nominal, forward, reverse.
fn triplets(name: &str, text: &str, told: &Told<'_>) -> Result<Series, Failure> {
    let (function, axis) = told.function(name)?;
    if function != axis.direction() {
        return Err(Failure::option(
            format!("{name}: a compensation file holds the positioning of its own axis"),
            format!("write `{name}=E{axis}{axis}`"),
        ));
    }
    let values =
        told.values(name, "positions (COMP_FILE_TYPE = 0) or --values corrections (COMP_FILE_TYPE = 1)")?;
    let mut readings = Vec::new();
    for line in text.lines().map(str::trim).filter(|l| !l.is_empty() && !l.starts_with('#')) {
        let Some(Ok([nominal, forward, reverse])) = numbers(line).map(<[f64; 3]>::try_from) else { continue };
        let error = |v: f64| match values {
            Values::Positions => v - nominal,
            Values::Errors => v,
            Values::Corrections => -v,
        };
        readings.push(reading("1", nominal, error(forward), 1));
        readings.push(reading("1", nominal, error(reverse), -1));
    }
    Ok(Series { axis, function, readings, source: name.to_owned(), reference_asked: false })
}

/// Heidenhain: AXISPOS, optionally BACKLASH (the value towards minus), and a column named by the axis that is compensated.
fn heidenhain(name: &str, text: &str, told: &Told<'_>) -> Result<Vec<Series>, Failure> {
    let (_, axis) = told.function(name)?;
    let values = told.values(name, "errors or --values corrections")?;
    let sign = if values == Values::Corrections { -1.0 } else { 1.0 };
    let mut header: Vec<String> = Vec::new();
    let mut found: Vec<Series> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let words: Vec<&str> = line.split_whitespace().filter(|w| *w != "|").collect();
        if words.iter().any(|w| w.eq_ignore_ascii_case("AXISPOS")) {
            header = words.iter().map(|w| w.to_uppercase()).collect();
            continue;
        }
        let Some(cells) = numbers(line).filter(|n| !header.is_empty() && !n.is_empty()) else { continue };
        // A line number may lead.
        let skip = cells.len().saturating_sub(header.len());
        let cells = &cells[skip..];
        if cells.len() != header.len() {
            return Err(unreadable(
                name,
                number + 1,
                format!("{} numbers for {} columns", cells.len(), header.len()),
                "give every row all columns",
            ));
        }
        let cell = |title: &str| header.iter().position(|h| h == title).map(|k| cells[k]);
        let Some(position) = cell("AXISPOS") else { continue };
        for compensated in Axis::ALL.into_iter().filter(|a| a.is_linear()) {
            let Some(value) = cell(&compensated.to_string()) else { continue };
            let function = compensated.direction();
            if !found.iter().any(|s| s.function == function) {
                found.push(Series {
                    axis,
                    function,
                    readings: Vec::new(),
                    source: name.to_owned(),
                    reference_asked: false,
                });
            }
            let Some(series) = found.iter_mut().find(|s| s.function == function) else { continue };
            let backlash = cell("BACKLASH").filter(|_| function == axis.direction());
            series.readings.push(reading("1", position, sign * value, i8::from(backlash.is_some())));
            if let Some(negative) = backlash {
                series.readings.push(reading("1", position, sign * negative, -1));
            }
        }
    }
    if found.is_empty() {
        return Err(unreadable(
            name,
            1,
            "no column is named by an axis",
            "a column X, Y or Z holds the values of that axis",
        ));
    }
    Ok(found)
}

/// ISG CSV: a heading `X EXX EYX …`, mm and rad; `#` begins a further block.
fn isg(name: &str, text: &str) -> Result<Vec<Series>, Failure> {
    let mut found: Vec<Series> = Vec::new();
    let mut header: Vec<String> = Vec::new();
    for (number, line) in text.lines().enumerate() {
        let line = line.split("//").next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        if line.starts_with('#') {
            header.clear();
            continue;
        }
        if header.is_empty() {
            header = line.split_whitespace().map(str::to_uppercase).collect();
            continue;
        }
        let Some(cells) = numbers(line).filter(|n| n.len() == header.len()) else {
            return Err(unreadable(
                name,
                number + 1,
                format!("expected {} numbers", header.len()),
                "mm and rad, separated by spaces",
            ));
        };
        let Some(axis) = header[0].chars().next().and_then(Axis::from_letter).filter(|a| a.is_linear())
        else {
            let help = "a block begins with the axis: `X EXX EYX …`; constant errors (Y0A …) go into the profile by hand";
            return Err(unreadable(name, number + 1, format!("`{}` is no linear axis", header[0]), help));
        };
        for (title, value) in header.iter().zip(&cells).skip(1) {
            let Some((function, own)) = symbol(title).filter(|(_, own)| *own == axis) else {
                return Err(unreadable(
                    name,
                    number + 1,
                    format!("`{title}` is no error function of {axis}"),
                    "write EXX, EYX, … of the block's axis",
                ));
            };
            let same = |s: &Series| s.axis == own && s.function == function;
            if !found.iter().any(same) {
                found.push(Series {
                    axis: own,
                    function,
                    readings: Vec::new(),
                    source: name.to_owned(),
                    reference_asked: true,
                });
            }
            if let Some(series) = found.iter_mut().find(|s| same(s)) {
                series.readings.push(reading("1", cells[0], *value, 0));
            }
        }
    }
    Ok(found)
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
        let mut readings = Vec::new();
        for row in sheet.rows() {
            if let Some(value) = row.number(column)? {
                let run = row.text("run");
                readings.push(reading(
                    if run.is_empty() { "1" } else { &run },
                    row.needed("position_mm")?,
                    value * factor,
                    row.sign("dir")?,
                ));
            }
        }
        found.push(Series { axis, function, readings, source: name.to_owned(), reference_asked: false });
    }
    if found.is_empty() {
        return Err(question(
            format!("{name} has no column of an error function"),
            "name it by symbol and unit, as in EXX_um or EBX_urad",
        ));
    }
    Ok(found)
}
