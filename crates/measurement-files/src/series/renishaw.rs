//! Files of laser interferometers: Renishaw's RTL text, and tables with one column a run.

use std::collections::BTreeSet;
use std::ops::Range;

use diagnostic::{Text, both};
use machine_model::Axis;

use crate::codes::{AXES, CELL, RUNS, UNIT};
use crate::refusal::{Codes, Refusal};
use crate::table::{Table, value};
use crate::text::Piece;
use crate::unit::{MM, Unit};

use super::file::{File, Origin, Series, numbers};

/// One deviation: run, target (from 1), value, and where it stands.
struct Deviation<'f> {
    run: usize,
    target: usize,
    value: f64,
    line: Piece<'f>,
}

/// Renishaw's RTL text.
pub(super) fn rtl(file: &File<'_>) -> Result<Series, Box<Refusal>> {
    let (function, axis) = file.function()?;
    let factor = file.factor(function, None)?;
    let read = Rtl::read(file, axis)?;
    read.is_whole(file)?;
    let mut series = Series::new(axis, function, file.name, Origin::Instrument);
    for run in read.rows.iter().map(|row| row.run).collect::<BTreeSet<_>>() {
        let own: Vec<_> = read.rows.iter().filter(|row| row.run == run).collect();
        // A run passes the targets in one direction: the order of its rows says which.
        let at = |row: &&Deviation<'_>| read.targets.get(row.target - 1).copied();
        let direction = match (own.first().and_then(at), own.last().and_then(at)) {
            (Some(a), Some(b)) if b > a => 1,
            (Some(a), Some(b)) if b < a => -1,
            _ => 0,
        };
        for row in own {
            let Some(position) = at(&row) else {
                let message = both!("target {} of {}", "цель {} из {}", row.target, read.targets.len());
                return Err(file.damaged(row.line.span(), message));
            };
            // Runs of the two directions are numbered through; as ISO 230-2 counts them, two make one.
            series.push(&run.div_ceil(2).to_string(), position, row.value * factor, direction);
        }
    }
    Ok(series)
}

/// What an RTL text says.
#[derive(Default)]
struct Rtl<'f> {
    targets: Vec<f64>,
    rows: Vec<Deviation<'f>>,
    /// How many it says there are, and where.
    announced_targets: Option<(usize, Range<usize>)>,
    announced_runs: Option<(usize, Range<usize>)>,
}

impl<'f> Rtl<'f> {
    fn read(file: &File<'f>, axis: Axis) -> Result<Self, Box<Refusal>> {
        let (mut section, mut part) = (String::new(), String::new());
        let mut read = Self::default();
        for line in file.lines() {
            let words = numbers(line.text);
            if let Some(title) = line.text.strip_suffix("::") {
                section = title.trim().to_uppercase();
                part.clear();
                if section == "DEVIATIONS" && !read.rows.is_empty() {
                    let message = both!("a second measurement in one file", "второе измерение в одном файле");
                    let help = both!(
                        "export each measurement to a file of its own",
                        "выведите каждое измерение в отдельный файл"
                    );
                    return Err(file.refuse(RUNS, line.span(), message, help));
                }
            } else if let Some((key, rest)) = line.text.split_once(':') {
                part = key.trim().to_lowercase();
                let count = rest.trim().parse::<usize>().ok().map(|count| (count, line.span()));
                match (section.as_str(), part.as_str()) {
                    ("TARGET DATA", "target-count") => read.announced_targets = count,
                    ("RUNS", "run-count") => read.announced_runs = count,
                    ("USER-TEXT", "axis") => is_of_axis(file, axis, line, rest)?,
                    _ => {}
                }
            } else if let Some(words) = words {
                match (section.as_str(), part.as_str()) {
                    ("TARGET DATA", "targets") => read.targets.extend(words),
                    ("DEVIATIONS", "run target data") => match words[..] {
                        [run, target, value] if run >= 1.0 && target >= 1.0 => {
                            read.rows.push(Deviation {
                                run: run as usize,
                                target: target as usize,
                                value,
                                line,
                            });
                        }
                        _ => {
                            let message = both!(
                                "expected run, target and deviation",
                                "ожидались проход, цель и отклонение"
                            );
                            return Err(file.damaged(line.span(), message));
                        }
                    },
                    _ => {}
                }
            }
        }
        Ok(read)
    }

    /// Refuses a measurement that was broken off.
    fn is_whole(&self, file: &File<'_>) -> Result<(), Box<Refusal>> {
        let (announced, span) = self.announced_targets.clone().unwrap_or((self.targets.len(), 0..0));
        if announced != self.targets.len() || self.targets.is_empty() {
            let message = both!(
                "{announced} targets are announced and {} are there",
                "целей объявлено {announced}, а есть {}",
                self.targets.len()
            );
            return Err(file.damaged(span, message));
        }
        let found = self.rows.iter().map(|row| row.run).max().unwrap_or(0);
        if let Some((announced, place)) = self.announced_runs.clone().filter(|(count, _)| *count != found) {
            let message = both!(
                "{}: {announced} runs are announced and {found} are there",
                "{}: проходов объявлено {announced}, а есть {found}",
                file.name
            );
            let help = both!(
                "the measurement was broken off, or the file is damaged: export complete runs",
                "измерение оборвано, или файл повреждён: выведите полные проходы"
            );
            return Err(file.refuse(RUNS, place, message, help));
        }
        Ok(())
    }
}

/// Refuses a file of which its user said that it is of another axis.
fn is_of_axis(file: &File<'_>, axis: Axis, line: Piece<'_>, said: &str) -> Result<(), Box<Refusal>> {
    let letters: Vec<Axis> = said
        .chars()
        .filter_map(|c| Axis::from_letter(c.to_ascii_uppercase()))
        .filter(|a| a.is_linear())
        .collect();
    if let [other] = letters[..]
        && other != axis
    {
        let message = both!(
            "{}: the file says axis {}, the command line {axis}",
            "{}: в файле ось {}, в команде {axis}",
            file.name,
            said.trim()
        );
        let help =
            both!("correct the symbol behind the file's name", "исправьте обозначение после имени файла");
        return Err(file.refuse(AXES, line.span(), message, help));
    }
    Ok(())
}

/// Which way a run went, by `+`/`-`, `forward`/`reverse` or `up`/`down` in its title; `None` where that does not say it.
fn way(title: &str) -> Option<i8> {
    let words = title.split([' ', '_', ',', '(', ')']);
    let says = |word: &str, sign: char, names: [&str; 3]| word.ends_with(sign) || names.contains(&word);
    let found = words.map(|word| {
        i8::from(says(word, '+', ["forward", "fwd", "up"]))
            - i8::from(says(word, '-', ["reverse", "backward", "down"]))
    });
    Some(found.sum::<i8>().signum()).filter(|way| *way != 0)
}

/// A target column and one column a run. Which way a run went its title says, or the user.
pub(super) fn columns_of_runs(file: &File<'_>) -> Result<Series, Box<Refusal>> {
    let (function, axis) = file.function()?;
    let of = |diagnostic| Refusal::of(file.name, file.text, diagnostic);
    let known =
        |header: &str| ["target", "position", "run"].iter().any(|word| header.to_lowercase().contains(word));
    let codes = Codes::MEASUREMENTS;
    let table = Table::read(
        file.text,
        codes,
        &both!("a target column and one column a run", "ожидались столбец целей и по столбцу на проход"),
        known,
    )
    .map_err(of)?;
    let cells = table.records.iter().flat_map(|record| &record.cells);
    let mark = table.mark(file.text, codes.cell, cells).map_err(of)?;
    let titles: Vec<String> =
        table.header.cells.iter().map(|cell| value(file.text, cell).to_lowercase()).collect();
    let bracket = |title: &String| Some(title.split_once('(')?.1.trim_end_matches(')').to_owned());
    let factor = file.factor(function, titles.iter().skip(1).find_map(bracket).as_deref())?;
    if bracket(&titles[0]).is_some_and(|unit| Unit::named(&unit, None) != Some(MM)) {
        let (span, message) =
            (table.header.cells[0].span.clone(), both!("targets in `{}`", "цели в `{}`", titles[0]));
        let help = both!("give the target positions in mm", "дайте положения целей в мм");
        return Err(file.refuse(UNIT, span, message, help));
    }
    // Of a single run nothing hangs on it.
    let alone = (titles.len() == 2).then_some(0);
    let directions = titles.iter().enumerate().skip(1).map(|(run, title)| {
        let told = || file.told.ways.map(|ways| ways.of(run));
        way(title).or_else(told).or(alone).ok_or_else(|| {
            let message = both!("does not say which way the axis went in `{title}`: lost motion is what two directions differ by", "не говорит, в какую сторону шла ось в `{title}`: мёртвый ход — это разность двух направлений");
            let help = both!("add `--runs alternating` (the first towards plus, the next towards minus, and so on), `--runs up` or `--runs down`; or say it in the titles: `Run 1 +`, `Run 2 -`", "добавьте `--runs alternating` (первый в плюс, следующий в минус и так далее), `--runs up` или `--runs down`; или скажите это в заголовках: `Run 1 +`, `Run 2 -`");
            file.question(&message, help)
        })
    });
    let directions: Vec<i8> = directions.collect::<Result<_, _>>()?;
    let mut series = Series::new(axis, function, file.name, Origin::Instrument);
    for record in &table.records {
        let number = |k: usize| {
            let (cell, text) = (&record.cells[k], value(file.text, &record.cells[k]));
            let refusal = || {
                let what = if k == 0 {
                    Text::pair("target", "цель")
                } else {
                    Text::pair("number", "число")
                };
                let help = both!("write decimal numbers with a point", "пишите десятичные числа с точкой");
                let message = both!("`{text}` is no {what}", "`{text}` — не {what:#}");
                file.refuse(CELL, cell.span.clone(), message, help)
            };
            mark.number(&text).ok_or_else(refusal)
        };
        let target = number(0)?;
        for k in (1..record.cells.len()).filter(|k| !record.cells[*k].span.is_empty()) {
            let direction = directions[k - 1];
            // Runs of a direction are numbered for themselves: as ISO 230-2 counts them, one there and one back make one.
            let run = 1 + directions[..k - 1].iter().filter(|other| **other == direction).count();
            series.push(&run.to_string(), target, number(k)? * factor, direction);
        }
    }
    Ok(series)
}
