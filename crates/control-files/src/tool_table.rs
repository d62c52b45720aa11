//! LinuxCNC's tool table: `T1 P1 Z+0.511 D0.125 ;1/8 end mill`.
//!
//! Letters and what LinuxCNC does with lines it cannot read (passes over them): its source, `tooldata_common.cc`.

use diagnostic::{Text, both};
use measurement_files::{Piece, Refusal};

use crate::refusals::{UNREADABLE, refuse, refuse_whole};
use crate::tool_list::Length;

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
        let message = both!(
            "a tool table of LinuxCNC does not say in which unit its lengths are",
            "таблица инструментов LinuxCNC не говорит, в какой единице длины"
        );
        let help = both!(
            "give the machine's INI file, which says it (LINEAR_UNITS): `--linuxcnc-ini FILE`",
            "дайте INI-файл станка, где это сказано (LINEAR_UNITS): `--linuxcnc-ini FILE`"
        );
        return Err(refuse_whole(file, UNREADABLE, message, help));
    };
    let mut lengths: Vec<Length> = Vec::new();
    for line in Piece::lines(text) {
        let line = line.before(&[';']).trimmed();
        if line.text.is_empty() {
            continue;
        }
        let unread = |word: Piece<'_>, label: Text| {
            let message =
                both!("`{}` in a tool table of LinuxCNC", "`{}` в таблице инструментов LinuxCNC", word.text);
            let help = both!(
                "LinuxCNC would pass over this line; write it like `T1 P1 Z+120.5 D10 ;end mill`, or remove it",
                "LinuxCNC эту строку пропустил бы; напишите её так: `T1 P1 Z+120.5 D10 ;end mill`, или уберите"
            );
            refuse(file, word, UNREADABLE, message, label, help)
        };
        let (mut number, mut vector) = (None, [0.0; 3]);
        for word in line.words() {
            let letter = word.text.chars().next().unwrap_or_default().to_ascii_uppercase();
            if !letter.is_ascii() {
                return Err(unread(word, both!("expected a letter and a number", "ожидались буква и число")));
            }
            let rest = word.behind(1);
            if letter == 'T' {
                let tool = rest.text.parse::<u32>().ok();
                number = Some((
                    tool.ok_or_else(|| {
                        unread(word, both!("expected T and a whole number", "ожидались T и целое число"))
                    })?,
                    word,
                ));
                continue;
            }
            if !NUMBERS.contains(letter) {
                let label = both!("not a letter of a tool table", "такой буквы в таблице инструментов нет");
                return Err(unread(word, label));
            }
            let value =
                rest.number().ok_or_else(|| unread(word, both!("expected a number", "ожидалось число")))?;
            if let Some(axis) = "XYZ".find(letter) {
                vector[axis] = value * unit_mm;
            }
        }
        let Some((number, word)) = number else {
            let label = both!("expected T and the tool's number", "ожидались T и номер инструмента");
            return Err(unread(line, label));
        };
        // T0 is no tool.
        if number == 0 {
            continue;
        }
        if lengths.iter().any(|(known, _)| *known == number) {
            let message = both!(
                "T{number} stands twice in the tool table",
                "T{number} стоит в таблице инструментов дважды"
            );
            let help = both!("keep the line that is true", "оставьте верную строку");
            return Err(refuse(file, word, UNREADABLE, message, both!("again here", "здесь ещё раз"), help));
        }
        lengths.push((number, vector));
    }
    Ok(lengths)
}
