//! Error tables of one axis and tracker traverses, from their CSV files.

use machine_model::{Axis, AxisTables, Interpolation, Six, Table, Traverse, rotation};
use units::{Angle, Length};

use crate::columns::Columns;
use crate::error::ProfileError;

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

/// mm or rad per unit of the column.
fn units_of(rotation: bool) -> &'static [(&'static str, f64)] {
    const LENGTHS: [(&str, f64); 2] = [("um", Length::from_um(1.0).mm()), ("mm", 1.0)];
    // µm/mm is a milliradian.
    const ANGLES: [(&str, f64); 3] = [
        ("urad", Angle::from_urad(1.0).rad()),
        ("um_per_mm", 1e-3),
        ("arcsec", Angle::from_arcsec(1.0).rad()),
    ];
    if rotation { &ANGLES } else { &LENGTHS }
}

/// Reads `position_mm, EXX_um, …, ECX_urad` (for a rotary axis `position_deg, EXA_um, …`).
pub(crate) fn error_rows(file: &str, bytes: &[u8], axis: Axis) -> Result<ErrorRows, Box<ProfileError>> {
    let columns = Columns::read(file, bytes)?;
    let position_name = if axis.is_linear() { "position_mm" } else { "position_deg" };
    let position = columns.need(position_name)?;
    let symbol = |i: usize| format!("E{}{axis}", ['X', 'Y', 'Z', 'A', 'B', 'C'][i]);
    let mut known = vec![position_name.to_owned()];
    for i in 0..6 {
        known.extend(units_of(i >= 3).iter().map(|(unit, _)| format!("{}_{unit}", symbol(i))));
    }
    let mut sources: [Option<(usize, f64)>; 6] = [None; 6];
    for (column, (name, _)) in columns.header.iter().enumerate() {
        if column == position {
            continue;
        }
        let (head, unit) = name.split_once('_').unwrap_or((name, ""));
        let Some(function) = (0..6).find(|&i| symbol(i) == head) else {
            let message = format!("unknown column {name} in a table of axis {axis}");
            return Err(columns.unknown_column(column, message, &known));
        };
        let units = units_of(function >= 3);
        let Some((_, factor)) = units.iter().find(|(known, _)| *known == unit) else {
            let wanted: Vec<&str> = units.iter().map(|(unit, _)| *unit).collect();
            let kind = if function < 3 { "a translation" } else { "a rotation" };
            let message = format!(
                "column {name}: {head} is {kind}, its unit must be one of {}, not `{unit}`",
                wanted.join(", ")
            );
            let names: Vec<String> = wanted.iter().map(|unit| format!("{head}_{unit}")).collect();
            return Err(columns.bad_column(column, message, format!("name it {}", names.join(" or "))));
        };
        if sources[function].is_some() {
            return Err(columns.bad_column(
                column,
                format!("{head} stands there twice, in different units"),
                "leave one of the two columns out".to_owned(),
            ));
        }
        sources[function] = Some((column, *factor));
    }
    if sources.iter().all(Option::is_none) {
        let message = format!("the table holds no error function of axis {axis}");
        return Err(columns.unknown_column(position, message, &known));
    }
    columns.increasing(position)?;
    let mut rows = Vec::with_capacity(columns.rows.len());
    for (k, cells) in columns.rows.iter().enumerate() {
        let six: Six =
            std::array::from_fn(|i| sources[i].map_or(0.0, |(column, factor)| cells[column] * factor));
        let (translation, angle) = (Vec3(six[0], six[1], six[2]).norm(), Vec3(six[3], six[4], six[5]).norm());
        if translation > LARGEST_TRANSLATION_MM || angle > rotation::LARGEST_SMALL_ANGLE_RAD {
            let message = format!(
                "an error of {translation:.3} mm and {:.3} mrad is larger than geometric errors get: wrong unit?",
                angle * 1e3
            );
            return Err(columns.bad_row(k, message, "up to 20 mm and 100 mrad are read"));
        }
        rows.push(six);
    }
    let scale = if axis.is_linear() { 1.0 } else { Angle::from_deg(1.0).rad() };
    Ok(ErrorRows {
        positions: columns.rows.iter().map(|cells| cells[position] * scale).collect(),
        rows,
        given: sources.map(|source| source.is_some()),
    })
}

struct Vec3(f64, f64, f64);

impl Vec3 {
    fn norm(&self) -> f64 {
        (self.0 * self.0 + self.1 * self.1 + self.2 * self.2).sqrt()
    }
}

/// Reads `commanded_x_mm …, measured_x_mm …[, published_cos_x …]` of a traverse along `axis`.
pub(crate) fn traverse(file: &str, bytes: &[u8], axis: Axis) -> Result<Traverse, Box<ProfileError>> {
    let columns = Columns::read(file, bytes)?;
    let names =
        |prefix: &str, suffix: &str| ['x', 'y', 'z'].map(|letter| format!("{prefix}_{letter}{suffix}"));
    let (commanded, measured) = (names("commanded", "_mm"), names("measured", "_mm"));
    let cosines = names("published_cos", "");
    let known: Vec<String> = [&commanded, &measured, &cosines].into_iter().flatten().cloned().collect();
    for (column, (name, _)) in columns.header.iter().enumerate() {
        if !known.contains(name) {
            return Err(columns.unknown_column(
                column,
                format!("unknown column {name} in a tracker traverse"),
                &known,
            ));
        }
    }
    let triple = |names: &[String; 3]| -> Result<[usize; 3], Box<ProfileError>> {
        Ok([columns.need(&names[0])?, columns.need(&names[1])?, columns.need(&names[2])?])
    };
    let (commanded, measured) = (triple(&commanded)?, triple(&measured)?);
    let cosines =
        if cosines.iter().any(|name| columns.find(name).is_some()) { Some(triple(&cosines)?) } else { None };
    let moving = axis.direction();
    columns.increasing(commanded[moving])?;
    for (k, row) in columns.rows.iter().enumerate() {
        if let Some(other) =
            (0..3).find(|&i| i != moving && row[commanded[i]] != columns.rows[0][commanded[i]])
        {
            let message = format!(
                "axis {} moves in the traverse of {axis}: {} mm after {} mm",
                Axis::ALL[other],
                row[commanded[other]],
                columns.rows[0][commanded[other]]
            );
            return Err(columns.bad_row(k, message, "a traverse moves one axis alone"));
        }
    }
    let pick = |from: [usize; 3]| -> Vec<[f64; 3]> {
        columns.rows.iter().map(|row| from.map(|column| row[column])).collect()
    };
    Ok(Traverse {
        axis: moving,
        nodes_mm: columns.rows.iter().map(|row| row[commanded[moving]]).collect(),
        start_mm: commanded.map(|column| columns.rows[0][column]),
        measured_mm: pick(measured),
        published_cosines: cosines.map(pick),
    })
}
