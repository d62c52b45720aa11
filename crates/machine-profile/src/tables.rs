//! Error tables of one axis and tracker traverses, from their CSV files.

use diagnostic::both;
use machine_model::{Axis, AxisTables, Interpolation, Six, Table, Traverse, rotation};
use measurement_files::{Codes, Kind, Refusal, Row, Sheet};
use units::Angle;

use crate::error::{CELL, COLUMN, FILE, ProfileError, ROWS};

/// Translations beyond this are a mistake in the unit, mm.
const LARGEST_TRANSLATION_MM: f64 = 20.0;

/// The error functions of one axis as they were measured.
#[derive(Clone, Debug, PartialEq)]
pub struct ErrorRows {
    /// Commands of the axis, mm or rad.
    pub positions: Vec<f64>,
    /// `EX EY EZ` in mm, `EA EB EC` in rad, per row; 0 for functions without a column.
    pub rows: Vec<Six>,
    /// Which of the six have a column.
    pub given: [bool; 6],
}

impl ErrorRows {
    /// As functions.
    pub(crate) fn tables(&self, interpolation: Interpolation) -> Option<AxisTables> {
        let function = |i: usize| -> Option<Table> {
            if !self.given[i] {
                return None;
            }
            let values = self.rows.iter().map(|row| row[i]).collect();
            // Rows were checked when the file was read.
            Table::new(self.positions.clone(), values, interpolation).ok()
        };
        AxisTables::new(&std::array::from_fn(function))
    }
}

const CODES: Codes = Codes { unreadable: FILE, column: COLUMN, cell: CELL, unit: ROWS };

/// The refusal of a table, as an error of the profile that names it.
fn of_profile(file: &str) -> impl Fn(Box<Refusal>) -> Box<ProfileError> + '_ {
    move |refusal| ProfileError::table(file, refusal.diagnostic)
}

/// Checks that a column increases strictly over at least two rows.
fn increasing(sheet: &Sheet, column: &str) -> Result<(), Box<Refusal>> {
    let rows: Vec<Row<'_>> = sheet.rows().collect();
    if let [only] = rows.as_slice() {
        let message = both!(
            "a table needs at least 2 rows, this one has 1",
            "в таблице нужно не меньше 2 строк, а в этой 1"
        );
        let help = both!("measure the ends of the travel at least", "измерьте хотя бы концы хода");
        return Err(only.refuse_row(ROWS, message, both!("the only row", "единственная строка"), help));
    }
    for pair in rows.windows(2) {
        let (before, at) = (pair[0].needed(column)?, pair[1].needed(column)?);
        if at <= before {
            let what = if at == before {
                both!("the same position twice", "одно положение дважды")
            } else {
                both!("out of order", "не по порядку")
            };
            let message = both!(
                "{what}: {column} {at} follows {before}, positions must increase from row to row",
                "{what:#}: {column} {at} после {before}, а положения возрастают от строки к строке"
            );
            let help = both!(
                "sort the rows; two runs, or two directions, are two tables",
                "упорядочьте строки; два прохода или два направления — это две таблицы"
            );
            return Err(pair[1].refuse_row(ROWS, message, both!("this row", "эта строка"), help));
        }
    }
    Ok(())
}

/// Reads `position_mm, EXX_um, …, ECX_urad` (for a rotary axis `position_deg, EXA_um, …`).
pub(crate) fn error_rows(file: &str, bytes: &[u8], axis: Axis) -> Result<ErrorRows, Box<ProfileError>> {
    read_error_rows(file, bytes, axis).map_err(of_profile(file))
}

fn read_error_rows(file: &str, bytes: &[u8], axis: Axis) -> Result<ErrorRows, Box<Refusal>> {
    let position = if axis.is_linear() { "position_mm" } else { "position_deg" };
    let functions: [String; 6] = std::array::from_fn(|i| {
        format!("E{}{axis}_{}", ['X', 'Y', 'Z', 'A', 'B', 'C'][i], if i < 3 { "mm" } else { "rad" })
    });
    let expected = both!(
        "expected: {position} and error functions of {axis} with their units, EX{axis}_um … EC{axis}_urad",
        "ожидалось: {position} и функции погрешности {axis} с единицами, EX{axis}_um … EC{axis}_urad"
    );
    let kind = Kind {
        columns: &format!("{position} {}", functions.join(" ")),
        expected: expected.clone(),
        passes_over: None,
        may_be_empty: false,
        codes: CODES,
    };
    let sheet = Sheet::read(file, bytes, &kind, None)?;
    sheet.need(&[position], expected.clone())?;
    let given = functions.each_ref().map(|key| sheet.has(key));
    if given == [false; 6] {
        let message = both!(
            "the table holds no error function of axis {axis}",
            "в таблице нет ни одной функции погрешности оси {axis}"
        );
        return Err(sheet.refuse_header(COLUMN, message, expected));
    }
    let scale = if axis.is_linear() { 1.0 } else { Angle::from_deg(1.0).rad() };
    let (mut positions, mut rows) = (Vec::new(), Vec::new());
    for row in sheet.rows() {
        positions.push(row.needed(position)? * scale);
        let mut six: Six = [0.0; 6];
        for (value, key) in six.iter_mut().zip(&functions).filter(|(_, key)| sheet.has(key)) {
            *value = row.number(key)?.ok_or_else(|| {
                let help = both!(
                    "a function that was not measured is a column left out, not an empty cell",
                    "если функцию не измеряли, её столбца нет, а не пустая ячейка"
                );
                row.refuse(CELL, key, both!("`{}` is empty", "`{}` пусто", sheet.header(key)), help)
            })?;
        }
        let norm = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
        let (translation, angle) = (norm(&six[..3]), norm(&six[3..]));
        if translation > LARGEST_TRANSLATION_MM || angle > rotation::LARGEST_SMALL_ANGLE_RAD {
            let message = both!(
                "an error of {translation:.3} mm and {:.3} mrad is larger than geometric errors get: wrong unit?",
                "погрешность {translation:.3} мм и {:.3} мрад больше, чем бывают геометрические: не та единица?",
                angle * 1e3
            );
            let label = both!("up to 20 mm and 100 mrad are read", "читается до 20 мм и 100 мрад");
            let help = both!("name each column by its unit", "назовите в каждом столбце его единицу");
            return Err(row.refuse_row(ROWS, message, label, help));
        }
        rows.push(six);
    }
    increasing(&sheet, position)?;
    Ok(ErrorRows { positions, rows, given })
}

/// Reads `commanded_x_mm …, measured_x_mm …[, published_cos_x …]` of a traverse along `axis`.
pub(crate) fn traverse(file: &str, bytes: &[u8], axis: Axis) -> Result<Traverse, Box<ProfileError>> {
    read_traverse(file, bytes, axis).map_err(of_profile(file))
}

fn read_traverse(file: &str, bytes: &[u8], axis: Axis) -> Result<Traverse, Box<Refusal>> {
    const COMMANDED: [&str; 3] = ["commanded_x_mm", "commanded_y_mm", "commanded_z_mm"];
    const MEASURED: [&str; 3] = ["measured_x_mm", "measured_y_mm", "measured_z_mm"];
    const COSINES: [&str; 3] = ["published_cos_x", "published_cos_y", "published_cos_z"];
    let kind = Kind {
        columns: &[COMMANDED, MEASURED, COSINES].concat().join(" "),
        expected: both!(
            "expected: commanded_x_mm … commanded_z_mm and measured_x_mm … measured_z_mm",
            "ожидалось: commanded_x_mm … commanded_z_mm и measured_x_mm … measured_z_mm"
        ),
        passes_over: None,
        may_be_empty: false,
        codes: CODES,
    };
    let sheet = Sheet::read(file, bytes, &kind, None)?;
    sheet.need(&[COMMANDED, MEASURED].concat(), kind.expected)?;
    let has_cosines = COSINES.iter().any(|key| sheet.has(key));
    if has_cosines {
        let help = both!("give all three cosines, or none", "дайте все три косинуса или ни одного");
        sheet.need(&COSINES, help)?;
    }
    let moving = axis.direction();
    increasing(&sheet, COMMANDED[moving])?;
    let all = |keys: [&str; 3]| sheet.rows().map(|row| row.three(keys)).collect::<Result<Vec<_>, _>>();
    let (commanded, measured_mm) = (all(COMMANDED)?, all(MEASURED)?);
    for (row, at) in sheet.rows().zip(&commanded) {
        if let Some(other) = (0..3).find(|&i| i != moving && at[i] != commanded[0][i]) {
            let name = Axis::ALL[other];
            let message = both!(
                "axis {name} moves in the traverse of {axis}: {} mm after {} mm",
                "в проходе {axis} движется ось {name}: {} мм после {} мм",
                at[other],
                commanded[0][other]
            );
            let help = both!("give each axis a file of its own", "дайте каждой оси отдельный файл");
            let label = both!("a traverse moves one axis alone", "в проходе движется одна ось");
            return Err(row.refuse_row(ROWS, message, label, help));
        }
    }
    Ok(Traverse {
        axis: moving,
        nodes_mm: commanded.iter().map(|at| at[moving]).collect(),
        start_mm: commanded[0],
        measured_mm,
        published_cosines: if has_cosines { Some(all(COSINES)?) } else { None },
    })
}
