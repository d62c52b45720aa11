//! Points of a machine: commands to be predicted, solved or judged.

use diagnostic::{Text, both};
use machine_model::Command;

use crate::codes::POINTS;
use crate::columns::Column;
use crate::refusal::{Codes, Refusal};
use crate::sheet::{Kind, Row, Sheet};

/// Points, with the columns that are passed on to the answer.
#[derive(Clone, Debug)]
pub struct Points {
    /// Headers of the file's columns.
    pub columns: Vec<String>,
    /// Cells of each row, and the command they mean.
    pub rows: Vec<(Vec<String>, Command)>,
    /// Which rotary axes have a column.
    pub rotary: [bool; 3],
}

const ROTARY: [&str; 3] = ["a_deg", "b_deg", "c_deg"];
const EXPECTED: Text = Text::pair(
    "expected: x_mm,y_mm,z_mm[,a_deg,b_deg,c_deg][,tool_x_mm,tool_y_mm,tool_z_mm][,dir_x,dir_y,dir_z]",
    "ожидалось: x_mm,y_mm,z_mm[,a_deg,b_deg,c_deg][,tool_x_mm,tool_y_mm,tool_z_mm][,dir_x,dir_y,dir_z]",
);
const KIND: Kind<'_> = Kind {
    columns: "x_mm y_mm z_mm a_deg b_deg c_deg tool_x_mm tool_y_mm tool_z_mm dir_x dir_y dir_z",
    expected: EXPECTED,
    passes_over: None,
    may_be_empty: true,
    codes: Codes::all(POINTS),
};

impl Points {
    /// Reads points.
    ///
    /// * `tool_mm`: the tool vector of rows that give none
    /// * `has_rotary`: which of A, B, C the machine has, by its `chain`
    ///
    /// # Errors
    /// What is wrong with the file, where, and what to write.
    pub fn read(
        name: &str,
        bytes: &[u8],
        tool_mm: [f64; 3],
        has_rotary: [bool; 3],
        chain: &str,
    ) -> Result<Self, Box<Refusal>> {
        let sheet = Sheet::read(name, bytes, &KIND, None)?;
        sheet.need(&["x_mm", "y_mm", "z_mm"], EXPECTED)?;
        let keys: Vec<&str> = sheet.columns().map(|column| column.key.as_str()).collect();
        let row = |row: Row<'_>| {
            let fields = keys.iter().map(|key| row.passed_on(key)).collect::<Result<Vec<_>, _>>()?;
            let command = row.command(tool_mm)?;
            if let Some(axis) = (0..3).find(|&axis| command.rotary_rad[axis] != 0.0 && !has_rotary[axis]) {
                let message = both!(
                    "the machine has no axis {}: its chain is {chain}",
                    "на станке нет оси {}: его цепь — {chain}",
                    ['A', 'B', 'C'][axis]
                );
                let help = both!(
                    "leave the column out, or give the profile of the machine that turns",
                    "уберите столбец или дайте профиль станка с этой осью"
                );
                return Err(row.refuse(POINTS, ROTARY[axis], message, help));
            }
            Ok((fields, command))
        };
        let rows = sheet.rows().map(row).collect::<Result<Vec<_>, _>>()?;
        let columns = sheet.columns().map(Column::header).collect();
        Ok(Self { columns, rows, rotary: ROTARY.map(|key| sheet.has(key)) })
    }
}
