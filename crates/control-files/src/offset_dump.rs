//! Offsets as a control writes them out: a program of `G10 L10 P1 R120.5` (Fanuc and its like).
//!
//! L10 is the geometry of a length, L11 its wear (L1 and L11 the whole of it where a control keeps no geometry apart);
//! L12 and L13 are those of the radius.

use std::collections::BTreeMap;

use diagnostic::both;
use measurement_files::{Piece, Refusal};

use crate::refusals::{BEYOND, File, UNREADABLE, refuse, refuse_whole};
use crate::tool_list::Length;

/// A program in which a block writes offsets, and nothing else.
pub(crate) fn is_one(text: &str) -> bool {
    Piece::lines(text).map(blocks_words).any(|words| {
        let writes = words.iter().any(|(letter, number)| *letter == 'G' && number.number() == Some(10.0));
        writes && words.iter().all(|(letter, _)| "NGLPR".contains(*letter))
    })
}

/// Letters and what stands behind them, comments left out.
fn blocks_words(line: Piece<'_>) -> Vec<(char, Piece<'_>)> {
    let mut rest = line.before(&[';']).trimmed();
    let mut words = Vec::new();
    while let Some(letter) = rest.text.chars().next() {
        if letter == '(' {
            let end = rest.text.find(')').map_or(rest.text.len(), |end| end + 1);
            rest = rest.behind(end).trimmed();
            continue;
        }
        let behind = rest.behind(letter.len_utf8());
        let length = behind.text.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c)));
        let length = length.unwrap_or(behind.text.len());
        words.push((letter.to_ascii_uppercase(), behind.first(length)));
        rest = behind.behind(length).trimmed();
    }
    words
}

/// Geometry and wear of a length, mm, and the line that gave the first of them.
struct Parts<'t> {
    geometry_mm: Option<f64>,
    wear_mm: Option<f64>,
    at: Piece<'t>,
}

pub(crate) fn lengths(name: &str, text: &str) -> Result<Vec<Length>, Box<Refusal>> {
    let file = (name, text);
    let mut unit_mm = None;
    let mut parts: BTreeMap<u32, Parts<'_>> = BTreeMap::new();
    for line in Piece::lines(text) {
        let Some(words) = written(file, line, &mut unit_mm)? else { continue };
        let line = line.trimmed();
        let Some(Offset { geometry, number, value, digits }) = offset(file, line, &words)? else { continue };
        let Some(unit_mm) = unit_mm else {
            let message = both!(
                "millimetres or inches? the list does not say",
                "миллиметры или дюймы? в списке не сказано"
            );
            let help = both!(
                "write G21 (or G20) on a line of its own in front, whichever the control was in",
                "напишите перед ним отдельной строкой G21 (или G20) — то, что действовало на стойке"
            );
            let label = both!("the first length", "первая длина");
            return Err(refuse(file, line, UNREADABLE, message, label, help));
        };
        if value != 0.0 && !digits.text.contains('.') {
            let message = both!("R{} has no decimal point", "у R{} нет десятичной точки", digits.text);
            let help = both!("write it with a decimal point", "напишите с десятичной точкой");
            let label = both!("increments or a length?", "дискреты или длина?");
            return Err(refuse(file, digits, UNREADABLE, message, label, help));
        }
        let part = parts.entry(number).or_insert(Parts { geometry_mm: None, wear_mm: None, at: line });
        let place = if geometry { &mut part.geometry_mm } else { &mut part.wear_mm };
        if place.replace(value * unit_mm).is_some() {
            let message = both!("the length H{number} stands twice", "длина H{number} стоит дважды");
            let help = both!("keep the line that is true", "оставьте верную строку");
            return Err(refuse(file, line, UNREADABLE, message, both!("again here", "здесь ещё раз"), help));
        }
    }
    if parts.is_empty() {
        let help = both!("write them like `G10 L10 P1 R120.5`", "пишите их так: `G10 L10 P1 R120.5`");
        let message = both!("the list holds no tool length", "в списке нет ни одной длины инструмента");
        return Err(refuse_whole(file, UNREADABLE, message, help));
    }
    let apart = parts.values().any(|part| part.geometry_mm.is_some());
    let length = |(number, part): (u32, Parts<'_>)| {
        if apart && part.geometry_mm.is_none() {
            let message = both!(
                "H{number} has a wear (L11) and no geometry (L10)",
                "у H{number} есть износ (L11), а геометрии (L10) нет"
            );
            let help = both!(
                "add `G10 L10 P{number} R…`, or take the line out",
                "добавьте `G10 L10 P{number} R…` или уберите строку"
            );
            let label = both!("how long is it?", "какова его длина?");
            return Err(refuse(file, part.at, UNREADABLE, message, label, help));
        }
        Ok((number, [0.0, 0.0, part.geometry_mm.unwrap_or(0.0) + part.wear_mm.unwrap_or(0.0)]))
    };
    parts.into_iter().map(length).collect()
}

/// Letters of a block, their numbers and how these are written.
type Numbers<'t> = BTreeMap<char, (f64, Piece<'t>)>;

/// L, P and R of a line that writes an offset; `None` for one that writes none. G20 and G21 change the unit.
fn written<'t>(
    file: File<'_>,
    line: Piece<'t>,
    unit_mm: &mut Option<f64>,
) -> Result<Option<Numbers<'t>>, Box<Refusal>> {
    let mut written = Numbers::new();
    let mut writes = false;
    let unread = |message, label, help| Err(refuse(file, line.trimmed(), UNREADABLE, message, label, help));
    for (letter, number) in blocks_words(line) {
        match (letter, number.number()) {
            ('%', None) | ('O' | 'N' | ':', _) | ('G', Some(90.0)) | ('M', Some(2.0 | 30.0 | 99.0)) => {}
            ('G', Some(20.0)) => *unit_mm = Some(25.4),
            ('G', Some(21.0)) => *unit_mm = Some(1.0),
            ('G', Some(10.0)) => writes = true,
            ('L' | 'P' | 'R', Some(value)) => {
                if written.insert(letter, (value, number)).is_some() {
                    let message = both!("{letter} stands twice", "{letter} стоит дважды");
                    let help = both!("write one block for each", "напишите на каждую отдельный кадр");
                    return unread(message, both!("in this block", "в этом кадре"), help);
                }
            }
            _ => {
                let message = both!(
                    "`{letter}{}` in a list of offsets",
                    "`{letter}{}` в списке коррекций",
                    number.text
                );
                let label = both!("expected blocks of G10 alone", "ожидались только кадры G10");
                let help = both!(
                    "give the offsets as the control writes them out, like `G10 L10 P1 R120.5`",
                    "дайте коррекции так, как их выводит стойка: `G10 L10 P1 R120.5`"
                );
                return unread(message, label, help);
            }
        }
    }
    Ok(writes.then_some(written))
}

/// One number of a tool's length.
struct Offset<'t> {
    /// Its geometry, not its wear.
    geometry: bool,
    /// H.
    number: u32,
    /// In the unit of the list.
    value: f64,
    /// How it is written.
    digits: Piece<'t>,
}

/// What a block of G10 says of a length; `None` where it gives a radius.
fn offset<'t>(
    file: File<'_>,
    line: Piece<'t>,
    words: &Numbers<'t>,
) -> Result<Option<Offset<'t>>, Box<Refusal>> {
    let whole = |letter: char| {
        let value = words.get(&letter).map(|(value, _)| *value);
        value.filter(|value| value.fract() == 0.0 && (0.0..1e6).contains(value)).map(|value| value as u32)
    };
    match (whole('L'), whole('P'), words.get(&'R')) {
        (Some(2 | 20), ..) => {
            let message =
                both!("a work offset in a list of tool lengths", "смещение нуля в списке длин инструмента");
            let help = both!(
                "take it out, and give it with `--work-offset G54=X,Y,Z`",
                "уберите его и задайте ключом `--work-offset G54=X,Y,Z`"
            );
            Err(refuse(file, line, BEYOND, message, both!("this block", "этот кадр"), help))
        }
        (Some(12 | 13), ..) => Ok(None),
        (Some(kind @ (1 | 10 | 11)), Some(number @ 1..), Some((value, digits))) => {
            Ok(Some(Offset { geometry: kind == 10, number, value: *value, digits: *digits }))
        }
        _ => {
            let message =
                both!("this block of G10 gives no tool length", "этот кадр G10 не задаёт длины инструмента");
            let help = both!(
                "write it like `G10 L10 P1 R120.5`: L10 geometry, L11 wear, P the H number, R the length",
                "пишите так: `G10 L10 P1 R120.5` — L10 геометрия, L11 износ, P номер H, R длина"
            );
            let label = both!("L, P and R were expected", "ожидались L, P и R");
            Err(refuse(file, line, UNREADABLE, message, label, help))
        }
    }
}
