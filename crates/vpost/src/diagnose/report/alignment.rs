//! What of a displacement is seen once the rows are aligned: the measuring frame lies as it may, and so does each run.

use gap_diagnosis::Measurements;
use machine_model::Vector;

use super::rows::Rows;

/// Rounds of the method of conjugate gradients, at most: as many as there are unknowns would do but for rounding.
const MOST_ROUNDS: usize = 200;
/// A gradient that has become so much smaller is none.
const SMALL: f64 = 1e-10;

/// Equations of rows, and what a shift, a turn and the shifts of the runs do to them.
pub(super) struct Alignment<'a> {
    rows: &'a Rows<'a>,
    data: &'a Measurements,
    middle_mm: Vector,
    size_mm: f64,
}

impl<'a> Alignment<'a> {
    pub(super) fn new(rows: &'a Rows<'a>, data: &'a Measurements) -> Self {
        let middle_mm = Vector::from(rows.ranges_mm.map(|(low, high)| 0.5 * (low + high)));
        let size_mm = rows.ranges_mm.iter().map(|(low, high)| high - low).fold(1.0, f64::max);
        Self { rows, data, middle_mm, size_mm }
    }

    /// A displacement of each row, equation by equation, less the alignment that takes most of it away: the least sum of
    /// squares.
    pub(super) fn seen(&self, of: impl Fn(usize) -> Vector) -> Vec<f64> {
        let equations = self.rows.all.iter().flat_map(|row| {
            let whole = of(row.row);
            row.equations.iter().map(move |seen| seen.along.dot(&whole))
        });
        let mut left: Vec<f64> = equations.collect();
        let mut gradient = self.unknowns(&left);
        let (mut direction, mut square) = (gradient.clone(), dot(&gradient, &gradient));
        let enough = square * SMALL * SMALL;
        for _ in 0..MOST_ROUNDS {
            if square <= enough {
                break;
            }
            let moved = self.equations(&direction);
            let step = square / dot(&moved, &moved).max(f64::MIN_POSITIVE);
            left.iter_mut().zip(&moved).for_each(|(left, moved)| *left -= step * moved);
            gradient = self.unknowns(&left);
            let next = dot(&gradient, &gradient);
            direction.iter_mut().zip(&gradient).for_each(|(d, g)| *d = g + next / square * *d);
            square = next;
        }
        left
    }

    /// What an alignment (shift, turn in units of the size, shifts of the runs) does to each equation.
    fn equations(&self, unknowns: &[f64]) -> Vec<f64> {
        let three = |at: usize| Vector::new(unknowns[at], unknowns[at + 1], unknowns[at + 2]);
        let (shift, turn) = (three(0), three(3));
        let of_row = self.rows.all.iter().flat_map(|row| {
            let whole = shift + turn.cross(&self.arm(row.row)) + three(6 + 3 * self.data.rows[row.row].run);
            row.equations.iter().map(move |seen| seen.along.dot(&whole))
        });
        of_row.collect()
    }

    /// The transpose of that.
    fn unknowns(&self, equations: &[f64]) -> Vec<f64> {
        let mut unknowns = vec![0.0; 6 + 3 * self.data.runs.len()];
        let mut equation = equations.iter();
        for row in &self.rows.all {
            let arm = self.arm(row.row);
            let run = 6 + 3 * self.data.rows[row.row].run;
            for (seen, value) in row.equations.iter().zip(&mut equation) {
                let turn = arm.cross(&seen.along);
                for axis in 0..3 {
                    unknowns[axis] += seen.along[axis] * value;
                    unknowns[3 + axis] += turn[axis] * value;
                    unknowns[run + axis] += seen.along[axis] * value;
                }
            }
        }
        unknowns
    }

    fn arm(&self, row: usize) -> Vector {
        (self.data.rows[row].command.linear_mm - self.middle_mm) / self.size_mm
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
