//! Cells to values: the columns of a kind of file, found in a table.

use std::borrow::Cow;
use std::ops::Range;

use diagnostic::{Code, Diagnostic, Text, both};
use machine_model::{Command, Vector};

use crate::columns::{Column, Holds, Said, said};
use crate::foreign;
use crate::header::{Header, lone_unit};
use crate::number::Mark;
use crate::refusal::{Codes, Refusal, error};
use crate::table::{Cell, Record, Table, value};
use crate::text::decoded;
use crate::unit::Unit;

/// A kind of file: what may stand in it.
#[derive(Clone, Debug)]
pub struct Kind<'k> {
    /// Keys of its columns in the registry, with spaces between them: `run x_mm dx_um`.
    pub columns: &'k str,
    /// What to say where there is no header, or one lacks a column.
    pub expected: Text,
    /// Columns whose names begin so are passed over without being asked for.
    pub passes_over: Option<&'k str>,
    /// True where it may have no rows.
    pub may_be_empty: bool,
    /// Numbers of its messages.
    pub codes: Codes,
}

/// A file of a kind, with every cell's place.
#[derive(Clone, Debug)]
pub struct Sheet {
    name: String,
    text: String,
    table: Table,
    columns: Vec<Placed>,
    mark: Mark,
    codes: Codes,
}

/// A column of the kind and where the file has it.
#[derive(Clone, Debug)]
struct Placed {
    column: Column,
    at: usize,
    /// From what is written to what is read.
    factor: f64,
}

/// One row of a sheet.
#[derive(Clone, Copy, Debug)]
pub struct Row<'s> {
    sheet: &'s Sheet,
    record: &'s Record,
}

impl Sheet {
    /// Reads a file; `name` is its own in messages, `ignore` are headers to pass over, where a command can be told them.
    ///
    /// # Errors
    /// What is wrong with it, where, and what to write.
    pub fn read(
        name: &str,
        bytes: &[u8],
        kind: &Kind<'_>,
        ignore: Option<&[String]>,
    ) -> Result<Self, Box<Refusal>> {
        let known: Vec<Column> = kind.columns.split_whitespace().filter_map(Column::of).collect();
        debug_assert_eq!(
            known.len(),
            kind.columns.split_whitespace().count(),
            "a key that the registry lacks"
        );
        let text = decoded(bytes).into_owned();
        match Self::parts(&text, kind, &known, ignore) {
            Ok((table, columns, mark)) => {
                Ok(Self { name: name.to_owned(), text, table, columns, mark, codes: kind.codes })
            }
            Err(diagnostic) => {
                let diagnostic = foreign::instead(bytes, &text, kind.codes).unwrap_or(diagnostic);
                Err(Refusal::of(name, &text, diagnostic))
            }
        }
    }

    fn parts(
        text: &str,
        kind: &Kind<'_>,
        known: &[Column],
        ignore: Option<&[String]>,
    ) -> Result<(Table, Vec<Placed>, Mark), Diagnostic> {
        let codes = kind.codes;
        let is_known = |header: &str| !matches!(said(header, known), Said::Unknown);
        let mut table = Table::read(text, codes, &kind.expected, is_known)?;
        let units = unit_row(text, &mut table, known);
        let header = Header { text, known, code: codes.column, ignore, units };
        let mut columns: Vec<Placed> = Vec::new();
        for (at, cell) in table.header.cells.iter().enumerate() {
            let written = value(text, cell);
            let is_ignored = ignore.unwrap_or_default().iter().any(|name| *name == written);
            if is_ignored || kind.passes_over.is_some_and(|start| written.starts_with(start)) {
                continue;
            }
            if written.is_empty() {
                // A spreadsheet leaves columns free.
                match table.records.iter().map(|record| &record.cells[at]).find(|cell| !cell.span.is_empty())
                {
                    None => continue,
                    Some(cell) => {
                        let (message, help) = (
                            both!(
                                "a column without a name holds something",
                                "в столбце без имени что-то стоит"
                            ),
                            both!(
                                "give the column a name, or empty it",
                                "дайте столбцу имя или очистите его"
                            ),
                        );
                        let label = both!("this cell", "эта ячейка");
                        return Err(error(codes.column, message, &cell.span, label, help));
                    }
                }
            }
            let (place, factor) = header.column(at, cell)?;
            let column = known[place].clone();
            if let Some(earlier) = columns.iter().find(|placed| placed.column.key == column.key) {
                let mut message =
                    both!("column `{written}` stands twice", "столбец `{written}` стоит дважды");
                let earlier = value(text, &table.header.cells[earlier.at]);
                if earlier != written {
                    message.push(&both!(": `{earlier}` is the same", ": `{earlier}` — тот же"));
                }
                let label = both!("this column", "этот столбец");
                let help = both!("remove one of them", "уберите один");
                return Err(error(codes.column, message, &cell.span, label, help));
            }
            columns.push(Placed { column, at, factor });
        }
        if table.records.is_empty() && !kind.may_be_empty {
            return Err(Diagnostic::error(
                codes.unreadable,
                both!("the file has no rows", "в файле нет строк"),
            )
            .help(kind.expected.clone()));
        }
        let numbers = columns.iter().filter(|placed| placed.column.holds() == Holds::Number);
        let numbers = numbers.flat_map(|placed| table.records.iter().map(|record| &record.cells[placed.at]));
        let mark = table.mark(text, codes.cell, numbers)?;
        Ok((table, columns, mark))
    }

    /// The file's name in messages.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file as text: what places count bytes of.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Lines that begin with `#`.
    #[must_use]
    pub fn comments(&self) -> &[String] {
        &self.table.comments
    }

    /// Columns of the file in its order: key, and the header as this product writes it.
    pub fn columns(&self) -> impl Iterator<Item = &Column> {
        self.columns.iter().map(|placed| &placed.column)
    }

    /// Numbers of messages about it.
    pub(crate) fn codes(&self) -> Codes {
        self.codes
    }

    /// True where the file has the column.
    #[must_use]
    pub fn has(&self, key: &str) -> bool {
        self.placed(key).is_some()
    }

    /// Refuses a file that lacks one of the columns.
    ///
    /// # Errors
    /// The first column that it lacks.
    pub fn need(&self, keys: &[&str], help: Text) -> Result<(), Box<Refusal>> {
        match keys.iter().find(|key| !self.has(key)) {
            Some(missing) => Err(self.lacks(missing, help)),
            None => Ok(()),
        }
    }

    /// The refusal of a file without this column.
    #[must_use]
    pub fn lacks(&self, key: &str, help: Text) -> Box<Refusal> {
        let header = Column::of(key).map_or_else(|| key.to_owned(), |column| column.header());
        let message = both!("column `{header}` is missing", "нет столбца `{header}`");
        self.refuse_header(self.codes.column, message, help)
    }

    /// A refusal that points at the header.
    #[must_use]
    pub fn refuse_header(&self, code: Code, message: Text, help: Text) -> Box<Refusal> {
        let span = self.table.header.cells.first().map_or(0..0, |cell| cell.span.clone());
        self.refused(code, span, message, both!("the header", "заголовок"), help)
    }

    /// A refusal that points at the header of a column.
    #[must_use]
    pub fn refuse_column(&self, code: Code, key: &str, message: Text, help: Text) -> Box<Refusal> {
        let at = self.placed(key).map_or(0, |placed| placed.at);
        let label = both!("this column", "этот столбец");
        self.refused(code, self.table.header.cells[at].span.clone(), message, label, help)
    }

    /// The rows.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = Row<'_>> + Clone {
        self.table.records.iter().map(|record| Row { sheet: self, record })
    }

    /// One row, counted from 0.
    #[must_use]
    pub fn row(&self, index: usize) -> Option<Row<'_>> {
        self.table.records.get(index).map(|record| Row { sheet: self, record })
    }

    /// The header of a column as the file writes it; the key where it has none.
    #[must_use]
    pub fn header(&self, key: &str) -> Cow<'_, str> {
        let found = self.placed(key).map(|placed| value(&self.text, &self.table.header.cells[placed.at]));
        found.unwrap_or_else(|| Cow::Owned(key.to_owned()))
    }

    fn placed(&self, key: &str) -> Option<&Placed> {
        self.columns.iter().find(|placed| placed.column.key == key)
    }

    fn refused(
        &self,
        code: Code,
        span: Range<usize>,
        message: Text,
        label: Text,
        help: Text,
    ) -> Box<Refusal> {
        Refusal::of(&self.name, &self.text, error(code, message, &span, label, help))
    }
}

/// A row of units below the header: taken off.
fn unit_row(text: &str, table: &mut Table, known: &[Column]) -> Option<Record> {
    let first = table.records.first()?;
    let mut of_numbers = 0;
    for (cell, header) in first.cells.iter().zip(&table.header.cells) {
        let unit = lone_unit(text, cell, None);
        if unit.is_none() && !matches!(&*value(text, cell), "" | "-" | "—") {
            return None;
        }
        let has_unit = match said(&value(text, header), known) {
            Said::Column { place, .. } | Said::NoUnit { place } => known[place].unit().is_some(),
            _ => false,
        };
        of_numbers += usize::from(unit.is_some() && has_unit);
    }
    (of_numbers > 0).then(|| table.records.remove(0))
}

impl<'s> Row<'s> {
    /// The file it is a row of.
    pub(crate) fn sheet(&self) -> &'s Sheet {
        self.sheet
    }

    /// Its line in the file, from 1.
    #[must_use]
    pub fn line(&self) -> u64 {
        self.record.line
    }

    /// All cells as written.
    pub fn cells(&self) -> impl Iterator<Item = Cow<'s, str>> + use<'s> {
        let text = &self.sheet.text;
        self.record.cells.iter().map(move |cell| value(text, cell))
    }

    /// The text of a column; empty where there is none.
    #[must_use]
    pub fn text(&self, key: &str) -> Cow<'s, str> {
        self.cell(key).map_or(Cow::Borrowed(""), |(_, cell)| value(&self.sheet.text, cell))
    }

    /// The number in a column, in the unit of the key; `None` where the column or the cell is empty.
    ///
    /// # Errors
    /// No number, or one that the column cannot have.
    pub fn number(&self, key: &str) -> Result<Option<f64>, Box<Refusal>> {
        let Some((placed, cell)) = self.cell(key) else { return Ok(None) };
        let text = value(&self.sheet.text, cell);
        if text.is_empty() {
            return Ok(None);
        }
        let codes = self.sheet.codes;
        let Some(written) = self.sheet.mark.number(&text) else {
            let unit = text
                .find(|c: char| c.is_alphabetic() || c == '°')
                .and_then(|at| self.sheet.mark.number(text[..at].trim()).and(Unit::named(&text[at..], None)));
            let help = match unit {
                Some(unit) => {
                    both!(
                        "its unit belongs into the header: `{}, {}`",
                        "единице место в заголовке: `{}, {}`",
                        placed.column.name(),
                        unit.name
                    )
                }
                None => {
                    both!("write a decimal number like -12.5", "напишите десятичное число, например -12.5")
                }
            };
            let message = both!("`{text}` is not a number", "`{text}` — не число");
            return Err(self.refuse(codes.cell, key, message, help));
        };
        let value = written * placed.factor;
        match placed.column.beyond(value) {
            Some(why) => Err(self.refuse(
                codes.unit,
                key,
                both!("`{text}` cannot be {}", "`{text}` не может быть {}", placed.column.key),
                why,
            )),
            None => Ok(Some(value)),
        }
    }

    /// The number in a column that no row may leave empty.
    ///
    /// # Errors
    /// None, or as [`Self::number`].
    pub fn needed(&self, key: &str) -> Result<f64, Box<Refusal>> {
        self.number(key)?.ok_or_else(|| {
            let help = both!("every row needs this number", "это число нужно в каждой строке");
            self.refuse(self.sheet.codes.cell, key, both!("`{key}` is empty", "`{key}` пусто"), help)
        })
    }

    /// Three numbers that no row may leave empty.
    ///
    /// # Errors
    /// As [`Self::needed`].
    pub fn three(&self, keys: [&str; 3]) -> Result<[f64; 3], Box<Refusal>> {
        Ok([self.needed(keys[0])?, self.needed(keys[1])?, self.needed(keys[2])?])
    }

    /// Three numbers, each where the file has it.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn any_of(&self, keys: [&str; 3]) -> Result<[Option<f64>; 3], Box<Refusal>> {
        Ok([self.number(keys[0])?, self.number(keys[1])?, self.number(keys[2])?])
    }

    /// Sign of a number: -1, 0 or 1; 0 where it is empty.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn sign(&self, key: &str) -> Result<i8, Box<Refusal>> {
        let value = self.number(key)?.unwrap_or(0.0);
        Ok(if value > 0.0 { 1 } else { -i8::from(value < 0.0) })
    }

    /// The command of a row: `x_mm` to `z_mm`, which it needs, `a_deg` to `c_deg`, `tool_x_mm` to `tool_z_mm` (else
    /// `tool_mm`), `dir_x` to `dir_z`.
    ///
    /// # Errors
    /// As [`Self::needed`].
    pub fn command(&self, tool_mm: [f64; 3]) -> Result<Command, Box<Refusal>> {
        let tool = self.any_of(["tool_x_mm", "tool_y_mm", "tool_z_mm"])?;
        Ok(Command {
            linear_mm: self.three(["x_mm", "y_mm", "z_mm"])?.into(),
            rotary_rad: self
                .any_of(["a_deg", "b_deg", "c_deg"])?
                .map(|deg| deg.unwrap_or(0.0).to_radians())
                .into(),
            tool_mm: Vector::from_fn(|i, _| tool[i].unwrap_or(tool_mm[i])),
            direction: self.directions()?,
            ..Default::default()
        })
    }

    /// Signs of `dir_x`, `dir_y`, `dir_z`.
    ///
    /// # Errors
    /// As [`Self::number`].
    pub fn directions(&self) -> Result<[i8; 3], Box<Refusal>> {
        Ok([self.sign("dir_x")?, self.sign("dir_y")?, self.sign("dir_z")?])
    }

    /// The number of a column that is passed on: as it was written, where that can be read everywhere.
    ///
    /// # Errors
    /// As [`Self::needed`].
    pub fn passed_on(&self, key: &str) -> Result<String, Box<Refusal>> {
        let value = self.needed(key)?;
        let as_written =
            self.sheet.mark == Mark::Point && self.sheet.placed(key).is_some_and(|p| p.factor == 1.0);
        Ok(if as_written { self.text(key).into_owned() } else { value.to_string() })
    }

    /// A refusal that points at the cell of a column, or at the row where it has none.
    #[must_use]
    pub fn refuse(&self, code: Code, key: &str, message: Text, help: Text) -> Box<Refusal> {
        let span =
            self.cell(key).map_or_else(|| self.record.cells[0].span.clone(), |(_, cell)| cell.span.clone());
        self.sheet.refused(code, span, message, Text::same(self.sheet.header(key)), help)
    }

    /// A refusal that points at the whole row.
    #[must_use]
    pub fn refuse_row(&self, code: Code, message: Text, label: Text, help: Text) -> Box<Refusal> {
        self.sheet.refused(code, self.record.span(), message, label, help)
    }

    fn cell(&self, key: &str) -> Option<(&'s Placed, &'s Cell)> {
        let placed = self.sheet.placed(key)?;
        Some((placed, &self.record.cells[placed.at]))
    }
}
