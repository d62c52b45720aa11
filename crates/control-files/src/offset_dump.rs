//! Offsets as a control writes them out: a program of `G10 L10 P1 R120.5` (Fanuc and its like).
//!
//! L10 is the geometry of a length, L11 its wear (L1 and L11 the whole of it where a control keeps no geometry apart);
//! L12 and L13 are those of the radius.

use std::collections::BTreeMap;

use measurement_files::Refusal;

use crate::text::{Piece, refuse_whole};
use crate::{BEYOND, Length, UNREADABLE};

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

/// Geometry and wear of a length, mm.
#[derive(Default)]
struct Parts<'t> {
    geometry_mm: Option<f64>,
    wear_mm: Option<f64>,
    at: Option<Piece<'t>>,
}

pub(crate) fn lengths(name: &str, text: &str) -> Result<Vec<Length>, Box<Refusal>> {
    let file = (name, text);
    let mut unit_mm = None;
    let mut parts: BTreeMap<u32, Parts<'_>> = BTreeMap::new();
    for line in Piece::lines(text) {
        let words = blocks_words(line);
        let mut written = BTreeMap::new();
        let mut writes = false;
        for (letter, number) in words {
            let refuse = |message: String, label: &str, help: &str| {
                Err(line.trimmed().refuse(file, UNREADABLE, message, label, help))
            };
            match (letter, number.number()) {
                ('%', None) | ('O' | 'N' | ':', _) | ('G', Some(90.0)) | ('M', Some(2.0 | 30.0 | 99.0)) => {}
                ('G', Some(20.0)) => unit_mm = Some(25.4),
                ('G', Some(21.0)) => unit_mm = Some(1.0),
                ('G', Some(10.0)) => writes = true,
                ('L' | 'P' | 'R', Some(value)) => {
                    if written.insert(letter, (value, number)).is_some() {
                        return refuse(
                            format!("{letter} stands twice"),
                            "in this block",
                            "write one block for each",
                        );
                    }
                }
                _ => {
                    return refuse(
                        format!("`{letter}{}` in a list of offsets", number.text),
                        "expected blocks of G10 alone",
                        "give the offsets as the control writes them out, like `G10 L10 P1 R120.5`",
                    );
                }
            }
        }
        if !writes {
            continue;
        }
        let refuse = |code, message: String, label: &str, help: &str| {
            Err(line.trimmed().refuse(file, code, message, label, help))
        };
        let whole = |letter: char| {
            let value = written.get(&letter).map(|(value, _)| *value);
            value.filter(|value| value.fract() == 0.0 && (0.0..1e6).contains(value)).map(|value| value as u32)
        };
        let kind = whole('L');
        if let Some(2 | 20) = kind {
            return refuse(
                BEYOND,
                "a work offset in a list of tool lengths".to_owned(),
                "this block",
                "take it out, and give it with `--work-offset G54=X,Y,Z`",
            );
        }
        if let Some(12 | 13) = kind {
            continue;
        }
        let (Some(kind @ (1 | 10 | 11)), Some(number), Some((value, digits))) =
            (kind, whole('P').filter(|number| *number > 0), written.get(&'R'))
        else {
            let help =
                "write it like `G10 L10 P1 R120.5`: L10 geometry, L11 wear, P the H number, R the length";
            return refuse(
                UNREADABLE,
                "this block of G10 gives no tool length".to_owned(),
                "L, P and R were expected",
                help,
            );
        };
        let Some(unit_mm) = unit_mm else {
            let help = "write G21 (or G20) on a line of its own in front, whichever the control was in";
            return refuse(
                UNREADABLE,
                "millimetres or inches? the list does not say".to_owned(),
                "the first length",
                help,
            );
        };
        if *value != 0.0 && !digits.text.contains('.') {
            let help = "write it with a decimal point";
            let message = format!("R{} has no decimal point", digits.text);
            return Err(digits.refuse(file, UNREADABLE, message, "increments or a length?", help));
        }
        let part = parts.entry(number).or_default();
        let place = if kind == 10 { &mut part.geometry_mm } else { &mut part.wear_mm };
        if place.replace(value * unit_mm).is_some() {
            let message = format!("the length H{number} stands twice");
            return refuse(UNREADABLE, message, "again here", "keep the line that is true");
        }
        part.at.get_or_insert(line.trimmed());
    }
    if parts.is_empty() {
        let help = "write them like `G10 L10 P1 R120.5`";
        return Err(refuse_whole(file, UNREADABLE, "the list holds no tool length", help));
    }
    let apart = parts.values().any(|part| part.geometry_mm.is_some());
    let length = |(number, part): (u32, Parts<'_>)| match (part.geometry_mm, part.at) {
        (None, Some(at)) if apart => Err(at.refuse(
            file,
            UNREADABLE,
            format!("H{number} has a wear (L11) and no geometry (L10)"),
            "how long is it?",
            format!("add `G10 L10 P{number} R…`, or take the line out"),
        )),
        (geometry_mm, _) => {
            Ok((number, [0.0, 0.0, geometry_mm.unwrap_or(0.0) + part.wear_mm.unwrap_or(0.0)]))
        }
    };
    parts.into_iter().map(length).collect()
}
