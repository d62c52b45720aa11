//! LinuxCNC's tool table: `T1 P1 Z+0.511 D0.125 ;1/8 end mill`.
//!
//! Letters and what LinuxCNC does with lines it cannot read (passes over them): its source, `tooldata_common.cc`.

use measurement_files::{Piece, Refusal};

use crate::Length;
use crate::refusals::{UNREADABLE, refuse, refuse_whole};

/// Of offsets, diameter, angles and place in the magazine.
const NUMBERS: &str = "PXYZABCUVWDIJQ";

/// A table whose first line that is no comment begins with T and a number.
pub(crate) fn is_one(text: &str) -> bool {
    let lines = Piece::lines(text).map(|line| line.before(&[';']).trimmed());
    let first = lines.into_iter().find(|line| !line.text.is_empty());
    first.is_some_and(|line| {
        let word = line.text.split_whitespace().next().unwrap_or_default();
        word.strip_prefix(['T', 't']).is_some_and(|number| number.parse::<u32>().is_ok())
    })
}

pub(crate) fn lengths(name: &str, text: &str, unit_mm: Option<f64>) -> Result<Vec<Length>, Box<Refusal>> {
    let file = (name, text);
    let Some(unit_mm) = unit_mm else {
        return Err(refuse_whole(
            file,
            UNREADABLE,
            "a tool table of LinuxCNC does not say in which unit its lengths are",
            "give the machine's INI file, which says it (LINEAR_UNITS): `--linuxcnc-ini FILE`",
        ));
    };
    let mut lengths: Vec<Length> = Vec::new();
    for line in Piece::lines(text) {
        let line = line.before(&[';']).trimmed();
        if line.text.is_empty() {
            continue;
        }
        let unread = |word: Piece<'_>, label: &str| {
            let message = format!("`{}` in a tool table of LinuxCNC", word.text);
            let help = "LinuxCNC would pass over this line; write it like `T1 P1 Z+120.5 D10 ;end mill`, or remove it";
            refuse(file, word, UNREADABLE, message, label, help)
        };
        let (mut number, mut vector) = (None, [0.0; 3]);
        for word in line.words() {
            let letter = word.text.chars().next().unwrap_or_default().to_ascii_uppercase();
            if !letter.is_ascii() {
                return Err(unread(word, "expected a letter and a number"));
            }
            let rest = word.behind(1);
            if letter == 'T' {
                let tool = rest.text.parse::<u32>().ok();
                number = Some((tool.ok_or_else(|| unread(word, "expected T and a whole number"))?, word));
                continue;
            }
            if !NUMBERS.contains(letter) {
                return Err(unread(word, "not a letter of a tool table"));
            }
            let value = rest.number().ok_or_else(|| unread(word, "expected a number"))?;
            if let Some(axis) = "XYZ".find(letter) {
                vector[axis] = value * unit_mm;
            }
        }
        let Some((number, word)) = number else {
            return Err(unread(line, "expected T and the tool's number"));
        };
        // T0 is no tool.
        if number == 0 {
            continue;
        }
        if lengths.iter().any(|(known, _)| *known == number) {
            let message = format!("T{number} stands twice in the tool table");
            return Err(refuse(file, word, UNREADABLE, message, "again here", "keep the line that is true"));
        }
        lengths.push((number, vector));
    }
    Ok(lengths)
}
