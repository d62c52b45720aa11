//! A spreadsheet of tool lengths: `tool,length_mm`, or a column for each of X, Y and Z.

use diagnostic::{Text, both};
use measurement_files::{Codes, Kind, Refusal, Sheet};

use crate::refusals::UNREADABLE;

/// The number of a tool length, H1 is 1, and what it adds to X, Y and Z, mm.
pub type Length = (u32, [f64; 3]);

const KIND: Kind<'static> = Kind {
    columns: "tool length_mm x_mm y_mm z_mm diameter_mm note",
    expected: Text::pair(
        "expected: tool,length_mm (a line for each: H1,120.5), a tool table of LinuxCNC (T1 P1 Z120.5), or a control's offsets (G10 L10 P1 R120.5)",
        "ожидалось: tool,length_mm (строка на каждый: H1,120.5), таблица инструментов LinuxCNC (T1 P1 Z120.5) или коррекции стойки (G10 L10 P1 R120.5)",
    ),
    passes_over: None,
    may_be_empty: false,
    codes: Codes::all(UNREADABLE),
};

pub(crate) fn lengths(name: &str, bytes: &[u8]) -> Result<Vec<Length>, Box<Refusal>> {
    let sheet = Sheet::read(name, bytes, &KIND, None)?;
    let help = both!("each length needs the number of its tool", "каждой длине нужен номер её инструмента");
    sheet.need(&["tool"], help)?;
    let by_axis = ["x_mm", "y_mm", "z_mm"].map(|column| sheet.has(column)).contains(&true);
    if by_axis && sheet.has("length_mm") {
        let message = both!(
            "`length_mm` stands beside lengths along X, Y and Z",
            "`length_mm` стоит рядом с длинами вдоль X, Y и Z"
        );
        let help = both!(
            "keep length_mm, which is along Z, or x_mm, y_mm and z_mm",
            "оставьте length_mm (вдоль Z) или x_mm, y_mm и z_mm"
        );
        return Err(sheet.refuse_column(UNREADABLE, "length_mm", message, help));
    }
    if !by_axis {
        let help = both!("a list of tools needs their lengths", "в списке инструментов нужны длины");
        sheet.need(&["length_mm"], help)?;
    }
    let mut lengths: Vec<Length> = Vec::new();
    for row in sheet.rows() {
        let written = row.text("tool");
        let digits = written.trim_start_matches(['H', 'h', 'T', 't', 'Т']);
        let number = digits.parse::<u32>().ok().filter(|number| *number > 0);
        let Some(number) = number.filter(|_| written.len() - digits.len() <= 2) else {
            let message = both!("`{written}` is no number of a length", "`{written}` — не номер длины");
            let help = both!("write H1, T1 or 1", "напишите H1, T1 или 1");
            return Err(row.refuse(UNREADABLE, "tool", message, help));
        };
        if lengths.iter().any(|(known, _)| *known == number) {
            let message = both!("tool {number} stands twice", "инструмент {number} стоит дважды");
            let help = both!("keep the line that is true", "оставьте верную строку");
            return Err(row.refuse(UNREADABLE, "tool", message, help));
        }
        let vector = if by_axis {
            let mut vector = [0.0; 3];
            for (value, column) in vector.iter_mut().zip(["x_mm", "y_mm", "z_mm"]) {
                *value = row.number(column)?.unwrap_or(0.0);
            }
            vector
        } else {
            [0.0, 0.0, row.needed("length_mm")?]
        };
        lengths.push((number, vector));
    }
    Ok(lengths)
}
