//! Files of laser interferometers: Renishaw's RTL text, and tables with one column a run.

use diagnostic::Diagnostic;
use machine_model::Axis;

use crate::calibrate::codes::{AXES, RUNS};
use crate::message::Failure;

use super::{Origin, Series, Told, numbers, reading, unreadable};

/// Renishaw's RTL text.
pub(super) fn rtl(name: &str, text: &str, told: &Told<'_>) -> Result<Series, Failure> {
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
                                AXES,
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
                RUNS,
                format!("{name}: {} runs are announced and {found} are there", announced_runs.unwrap_or(0)),
            )
            .help("the measurement was broken off, or the file is damaged: export complete runs"),
        ));
    }
    let mut series = Series::new(axis, function, name, Origin::Instrument);
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
            series.readings.push(reading(&((run + 1) / 2).to_string(), position, value * factor, direction));
        }
    }
    Ok(series)
}

/// A target column and one column a run, separated by tabs, semicolons or commas. Directions: from `+`/`-`, `forward`/`reverse`
/// or `up`/`down` in the column's title; otherwise odd runs go up and even ones down, as instruments run them.
pub(super) fn columns_of_runs(name: &str, text: &str, told: &Told<'_>) -> Result<Series, Failure> {
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
    let mut series = Series::new(axis, function, name, Origin::Instrument);
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
            series.readings.push(reading(&k.div_ceil(2).to_string(), target, value * factor, direction));
        }
    }
    Ok(series)
}
