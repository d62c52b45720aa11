//! Tables of controls: LinuxCNC's triplets, Heidenhain's AXISPOS tables, ISG CSV.

use diagnostic::{Diagnostic, both};
use machine_model::Axis;

use crate::codes::{CELL, COLUMN, QUESTION};
use crate::refusal::Refusal;

use super::file::{Content, File, Origin, Series, Values, numbers, symbol};

/// LinuxCNC: nominal, forward, reverse.
pub(super) fn triplets(file: &File<'_>) -> Result<Series, Box<Refusal>> {
    let (function, axis) = file.function()?;
    let name = file.name;
    if function != axis.direction() {
        let message = both!(
            "{name}: a compensation file holds the positioning of its own axis",
            "{name}: в файле компенсации — позиционирование своей оси"
        );
        let help = both!("write `{name}=E{axis}{axis}`", "напишите `{name}=E{axis}{axis}`");
        return Err(Refusal::without_text(Diagnostic::error(QUESTION, message).help(help)));
    }
    let values = file.values(&both!(
        "positions (COMP_FILE_TYPE = 0) or --values corrections (COMP_FILE_TYPE = 1)",
        "positions (COMP_FILE_TYPE = 0) или --values corrections (COMP_FILE_TYPE = 1)"
    ))?;
    let mut series = Series::new(axis, function, name, Origin::Control);
    for line in file.lines() {
        let Some(Ok([nominal, forward, reverse])) = numbers(line.text).map(<[f64; 3]>::try_from) else {
            continue;
        };
        let error = |v: f64| match values {
            Values::Positions => v - nominal,
            Values::Errors => v,
            Values::Corrections => -v,
        };
        series.push("1", nominal, error(forward), 1);
        series.push("1", nominal, error(reverse), -1);
    }
    Ok(series)
}

/// Heidenhain: AXISPOS, optionally BACKLASH (the value towards minus), and a column named by the axis that is compensated.
pub(super) fn heidenhain(file: &File<'_>) -> Result<Vec<Series>, Box<Refusal>> {
    let (_, axis) = file.function()?;
    let values = file.values(&both!("errors or --values corrections", "errors или --values corrections"))?;
    let sign = if values == Values::Corrections { -1.0 } else { 1.0 };
    let mut header: Vec<String> = Vec::new();
    let mut found: Vec<Series> = Vec::new();
    for line in file.lines() {
        let words: Vec<&str> = line.text.split_whitespace().filter(|w| *w != "|").collect();
        if words.iter().any(|w| w.eq_ignore_ascii_case("AXISPOS")) {
            header = words.iter().map(|w| w.to_uppercase()).collect();
            continue;
        }
        let Some(cells) = numbers(line.text).filter(|n| !header.is_empty() && !n.is_empty()) else {
            continue;
        };
        // A line number may lead.
        let skip = cells.len().saturating_sub(header.len());
        let cells = &cells[skip..];
        if cells.len() != header.len() {
            let message =
                both!("{} numbers for {} columns", "чисел {}, а столбцов {}", cells.len(), header.len());
            let help = both!("give every row all columns", "дайте каждой строке все столбцы");
            return Err(file.refuse(CELL, line.span(), message, help));
        }
        let cell = |title: &str| header.iter().position(|h| h == title).map(|k| cells[k]);
        let Some(position) = cell("AXISPOS") else { continue };
        for compensated in Axis::ALL.into_iter().filter(|a| a.is_linear()) {
            let Some(value) = cell(&compensated.to_string()) else { continue };
            let function = compensated.direction();
            if !found.iter().any(|s| s.function == function) {
                found.push(Series::new(axis, function, file.name, Origin::Control));
            }
            let Some(series) = found.iter_mut().find(|s| s.function == function) else { continue };
            let backlash = cell("BACKLASH").filter(|_| function == axis.direction());
            series.push("1", position, sign * value, i8::from(backlash.is_some()));
            if let Some(negative) = backlash {
                series.push("1", position, sign * negative, -1);
            }
        }
    }
    if found.is_empty() {
        let message = both!("no column is named by an axis", "ни один столбец не назван осью");
        let help = both!(
            "a column X, Y or Z holds the values of that axis",
            "значения оси стоят в столбце X, Y или Z"
        );
        return Err(file.refuse(COLUMN, 0..0, message, help));
    }
    Ok(found)
}

/// ISG CSV: a heading `X EXX EYX …`, mm and rad; `#` begins a further block.
pub(super) fn isg(file: &File<'_>) -> Result<Content, Box<Refusal>> {
    let mut found: Vec<Series> = Vec::new();
    let mut angles: Option<[f64; 3]> = None;
    let mut header: Vec<String> = Vec::new();
    for whole in file.lines() {
        let line = whole.text.split("//").next().unwrap_or_default().trim();
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
            let message = both!("expected {} numbers", "ожидалось чисел: {}", header.len());
            let help = both!("mm and rad, separated by spaces", "мм и рад, через пробел");
            return Err(file.refuse(CELL, whole.span(), message, help));
        };
        let angle = |title: &String| ["C0Y", "B0Z", "A0Z"].iter().position(|known| known == title);
        if let Some(places) = header.iter().map(angle).collect::<Option<Vec<usize>>>() {
            let own = angles.get_or_insert([0.0; 3]);
            for (place, value) in places.into_iter().zip(&cells) {
                own[place] = *value;
            }
            continue;
        }
        let Some(axis) = header[0].chars().next().and_then(Axis::from_letter).filter(|a| a.is_linear())
        else {
            let help = both!(
                "a block begins with the axis: `X EXX EYX …`; of constant errors only C0Y, B0Z and A0Z are read",
                "блок начинается с оси: `X EXX EYX …`; из постоянных погрешностей читаются только C0Y, B0Z и A0Z"
            );
            let message = both!("`{}` is no linear axis", "`{}` — не линейная ось", header[0]);
            return Err(file.refuse(COLUMN, whole.span(), message, help));
        };
        for (title, value) in header.iter().zip(&cells).skip(1) {
            let Some((function, own)) = symbol(title).filter(|(_, own)| *own == axis) else {
                let message = both!(
                    "`{title}` is no error function of {axis}",
                    "`{title}` — не функция погрешности оси {axis}"
                );
                let help =
                    both!("write EXX, EYX, … of the block's axis", "напишите EXX, EYX, … оси этого блока");
                return Err(file.refuse(COLUMN, whole.span(), message, help));
            };
            let same = |s: &Series| s.axis == own && s.function == function;
            if !found.iter().any(same) {
                found.push(Series::new(own, function, file.name, Origin::ControlAtCarriage));
            }
            if let Some(series) = found.iter_mut().find(|s| same(s)) {
                series.push("1", cells[0], *value, 0);
            }
        }
    }
    Ok(Content { series: found, angles_rad: angles })
}
