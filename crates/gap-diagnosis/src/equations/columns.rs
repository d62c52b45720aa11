//! Values of columns at the equations.
//!
//! Most columns are functions of where one axis stands and from which side it came there. An axis stands at far fewer
//! places than there are rows, so such a column is evaluated once per place and looked up from then on.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;

use machine_model::effects::EffectGeometry;
use machine_model::{Command, Vector};

use crate::equations::observation::{Measurements, Row, Scalar};
use crate::equations::term::Term;

/// A table of values is worth its memory where an axis has at most one place for so many rows.
const ROWS_PER_PLACE: usize = 4;

/// Values of columns kept between extensions, at most this many numbers (256 MiB); what does not fit is evaluated
/// again when it is needed.
const KEPT: usize = 32 << 20;

/// Vectors kept in tables by row, at most this many (48 MiB); the oldest go first.
const TABULATED: usize = 2 << 20;

/// Where the equations come from.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Source<'a> {
    /// Rows of the measurement.
    pub rows: &'a [Row],
    /// Equations.
    pub scalars: &'a [Scalar],
    /// Number of runs.
    pub runs: usize,
    /// The machine.
    pub geometry: &'a EffectGeometry,
    /// The rows by place, where so many columns are asked about that sorting them pays.
    pub places: Option<&'a Places>,
}

impl<'a> Source<'a> {
    /// Some equations of a file, its rows not sorted.
    pub(crate) fn new(data: &'a Measurements, scalars: &'a [Scalar]) -> Self {
        Self { rows: &data.rows, scalars, runs: data.runs.len(), geometry: &data.geometry, places: None }
    }

    /// Values of a column at some equations, times the roots of their weights.
    pub(crate) fn weighted(&self, term: &Term, equations: &[usize]) -> Vec<f64> {
        let column = Column::new(term, self);
        equations.iter().map(|i| self.scalars[*i].weight.sqrt() * column.value(*i)).collect()
    }
}

/// Columns for the next extension: with their tables, or where they have none with their values, class by class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Kept<'a> {
    columns: Vec<Column<'a>>,
    classes: [Vec<Vec<f64>>; 4],
    numbers: usize,
}

impl<'a> Kept<'a> {
    /// Columns that are ready, the first ones there are.
    pub(crate) fn of(columns: Vec<Column<'a>>) -> Self {
        Self { columns, ..Self::default() }
    }

    /// All columns: those that were kept and those behind them.
    pub(crate) fn columns(&mut self, terms: &[Term], source: &Source<'a>) -> &[Column<'a>] {
        let new = terms.iter().skip(self.columns.len()).map(|term| Column::new(term, source));
        self.columns.extend(new);
        &self.columns
    }

    /// Takes the values of a column from the `start`-th equation of the class on; a column that does not fit as a whole is of no use and stays short.
    pub(crate) fn keep(&mut self, class: usize, column: usize, start: usize, values: &[f64]) {
        // A table is quick to look up, but where a length is seen it must be turned into the bar's direction.
        let has_table = class < 3 && self.columns.get(column).is_none_or(|c| c.table.is_some());
        if !has_table && self.numbers + values.len() <= KEPT {
            let list = &mut self.classes[class];
            list.resize(list.len().max(column + 1), Vec::new());
            if list[column].len() == start {
                self.numbers += values.len();
                list[column].extend_from_slice(values);
            }
        }
    }

    /// Values of a column from the `start`-th equation of the class on.
    pub(crate) fn values(&self, class: usize, column: usize, start: usize, length: usize) -> Option<&[f64]> {
        self.classes[class].get(column)?.get(start..start + length)
    }
}

/// Rows by the place and the direction of approach of each axis, and the angles of the rotary axes; and what the columns
/// asked about last displace at every row: a search puts the few columns of its model to one test after the other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Places {
    axes: [AxisPlaces; 3],
    tables: RefCell<VecDeque<(Term, Rc<[Vector]>)>>,
}

#[derive(Clone, Debug, Default)]
struct AxisPlaces {
    /// One row of every place; empty where there are too many places for a table.
    examples: Vec<usize>,
    /// Place of every row.
    of_row: Vec<u32>,
}

impl Places {
    /// Sorts the rows of a file.
    pub(crate) fn new(rows: &[Row]) -> Self {
        Self { axes: [0, 1, 2].map(|axis| AxisPlaces::new(rows, axis)), tables: RefCell::default() }
    }

    /// What a column displaces at every row of the file that these are the places of, µm.
    fn by_row(&self, term: &Term, source: &Source<'_>) -> Rc<[Vector]> {
        let known =
            self.tables.borrow().iter().find(|(known, _)| known == term).map(|(_, table)| table.clone());
        known.unwrap_or_else(|| {
            let table = by_row(term, source);
            let mut tables = self.tables.borrow_mut();
            tables.push_back((*term, table.clone()));
            while tables.len() * source.rows.len() > TABULATED {
                tables.pop_front();
            }
            table
        })
    }
}

/// What a column displaces at every row, µm.
fn by_row(term: &Term, source: &Source<'_>) -> Rc<[Vector]> {
    source.rows.iter().map(|row| term.displacement_um(row, source.geometry)).collect()
}

impl AxisPlaces {
    fn new(rows: &[Row], axis: usize) -> Self {
        // What an axis displaces is seen turned where a table turns the workpiece.
        let key = |row: &Row| {
            let Command { linear_mm, rotary_rad, direction, .. } = &row.command;
            (linear_mm[axis].to_bits(), direction[axis], <[f64; 3]>::from(*rotary_rad).map(f64::to_bits))
        };
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by_key(|i| (key(&rows[*i]), *i));
        let mut found = Self { examples: Vec::new(), of_row: vec![0; rows.len()] };
        for row in order {
            if found.examples.last().is_none_or(|last| key(&rows[*last]) != key(&rows[row])) {
                found.examples.push(row);
            }
            found.of_row[row] = found.examples.len() as u32 - 1;
        }
        if found.examples.len() * ROWS_PER_PLACE > rows.len() { Self::default() } else { found }
    }
}

/// One column, ready to be evaluated.
#[derive(Clone, Debug)]
pub(crate) struct Column<'a> {
    term: Term,
    source: Source<'a>,
    table: Option<Table<'a>>,
}

/// What a column displaces, looked up.
#[derive(Clone, Debug)]
struct Table<'a> {
    /// Places of the axis that the column depends on; without them there is one entry per row.
    places: Option<&'a AxisPlaces>,
    displaced_um: Rc<[Vector]>,
}

impl Table<'_> {
    fn at(&self, row: usize) -> &Vector {
        &self.displaced_um[self.places.map_or(row, |places| places.of_row[row] as usize)]
    }

    /// What an equation sees.
    fn value(&self, scalar: &Scalar) -> f64 {
        let displaced = self.at(scalar.row);
        if scalar.class < 3 { displaced[scalar.class] } else { scalar.along.dot(displaced) }
    }
}

impl<'a> Column<'a> {
    pub(crate) fn new(term: &Term, source: &Source<'a>) -> Self {
        let axis = source.places.zip(term.axis()).map(|(places, axis)| &places.axes[axis]);
        let table = axis.filter(|axis| !axis.examples.is_empty()).map(|axis| {
            let at = |row: &usize| term.displacement_um(&source.rows[*row], source.geometry);
            Table { places: Some(axis), displaced_um: axis.examples.iter().map(at).collect() }
        });
        Self { term: *term, source: *source, table }
    }

    /// The same with a table by row where the places make none: for the few columns of a model, which every component of a
    /// row and several samples of the equations ask for. Not where only few rows are looked at.
    pub(crate) fn tabulated(term: &Term, source: &Source<'a>) -> Self {
        let mut column = Self::new(term, source);
        let few = 2 * source.scalars.len() < source.rows.len();
        // The bar's length is no displacement.
        if column.table.is_none() && !few && *term != Term::BarLength {
            let displaced_um =
                source.places.map_or_else(|| by_row(term, source), |places| places.by_row(term, source));
            column.table = Some(Table { places: None, displaced_um });
        }
        column
    }

    /// The same column at other equations of the same rows.
    pub(crate) fn among<'b>(&self, source: Source<'b>) -> Column<'b>
    where
        'a: 'b,
    {
        Column { term: self.term, source, table: self.table.clone() }
    }

    /// What the column is.
    pub(crate) fn term(&self) -> Term {
        self.term
    }

    /// Adds so many times what every equation sees of the column.
    pub(crate) fn add_to(&self, factor: f64, sums: &mut [f64]) {
        let scalars = self.source.scalars;
        match &self.table {
            Some(table) => {
                sums.iter_mut().zip(scalars).for_each(|(sum, scalar)| *sum += factor * table.value(scalar));
            }
            None => sums.iter_mut().enumerate().for_each(|(i, sum)| *sum += factor * self.value(i)),
        }
    }

    /// What an equation sees of the column.
    pub(crate) fn value(&self, equation: usize) -> f64 {
        let scalar = &self.source.scalars[equation];
        match &self.table {
            None => self.term.value(scalar, &self.source.rows[scalar.row], self.source.geometry),
            Some(table) => table.value(scalar),
        }
    }

    /// What some equations of one class see of the column, times the roots of their weights.
    pub(crate) fn fill(&self, equations: &[usize], roots: &[f64], values: &mut [f64]) {
        let scalars = self.source.scalars;
        let all = values.iter_mut().zip(equations).zip(roots);
        match (&self.table, equations.first().map(|i| scalars[*i].class)) {
            (Some(table), Some(class @ 0..=2)) => all.for_each(|((value, i), root)| {
                *value = root * table.at(scalars[*i].row)[class];
            }),
            _ => all.for_each(|((value, i), root)| *value = root * self.value(*i)),
        }
    }
}
