//! The six error functions of one axis, looked up together.

use crate::component::Six;
use crate::real::Real;
use crate::table::{self, Cubic, Grid, slope_of, value_of};
use crate::{Bounds, Range, Table};

/// The six error functions of one axis on common nodes, so that the cell is found once.
///
/// Tables on different nodes are written on the union of their nodes over the range that all of them
/// cover. That is exact: a cubic stays itself when its cell is cut.
///
/// ```
/// use machine_model::{AxisTables, Interpolation, Table};
///
/// let table = |nodes: [f64; 2], values: [f64; 2]| {
///     Some(Table::new(nodes.to_vec(), values.to_vec(), Interpolation::Linear).unwrap())
/// };
/// // EXX over 0 to 100 mm and EYX over 50 to 200 mm: known together from 50 to 100.
/// let tables =
///     AxisTables::new(&[table([0.0, 100.0], [0.0, 0.010]), table([50.0, 200.0], [0.003, 0.003]), None, None, None, None])
///         .unwrap();
/// assert_eq!((tables.range().low, tables.range().high), (50.0, 100.0));
/// let [exx, eyx, ezx, ..] = tables.at(80.0);
/// assert!((exx - 0.008).abs() < 1e-12 && (eyx - 0.003).abs() < 1e-12 && ezx == 0.0);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct AxisTables {
    grid: Grid,
    /// Per cell the coefficients of t⁰, t¹ for all six functions.
    straight: Box<[[Six; 2]]>,
    /// Per cell the coefficients of t², t³; empty where all functions are piecewise linear.
    curved: Box<[[Six; 2]]>,
}

/// The six functions between two nodes.
#[derive(Clone, Copy)]
pub(crate) struct Cell<'t> {
    /// The lower node.
    pub(crate) low: f64,
    /// The upper node.
    pub(crate) high: f64,
    pub(crate) straight: &'t [Six; 2],
    pub(crate) curved: Option<&'t [Six; 2]>,
}

impl Cell<'_> {
    /// All six at `t` from the lower node.
    #[inline(always)]
    pub(crate) fn at<T: Real>(&self, t: T) -> [T; 6] {
        let mut six = [t; 6];
        for (i, value) in six.iter_mut().enumerate() {
            *value = self.value(i, t);
        }
        six
    }

    /// All six and their slopes at `t` from the lower node.
    #[inline(always)]
    pub(crate) fn with_slopes<T: Real>(&self, t: T) -> ([T; 6], [T; 6]) {
        let (mut six, mut slopes) = ([t; 6], [t; 6]);
        for i in 0..6 {
            (six[i], slopes[i]) = (self.value(i, t), self.slope(i, t));
        }
        (six, slopes)
    }

    #[inline(always)]
    fn value<T: Real>(&self, i: usize, t: T) -> T {
        let [c0, c1] = self.straight;
        match self.curved {
            None => t.all(c0[i]) + t * t.all(c1[i]),
            Some([c2, c3]) => value_of(&[t.all(c0[i]), t.all(c1[i]), t.all(c2[i]), t.all(c3[i])], t),
        }
    }

    #[inline(always)]
    fn slope<T: Real>(&self, i: usize, t: T) -> T {
        let [c0, c1] = self.straight;
        match self.curved {
            None => t.all(c1[i]),
            Some([c2, c3]) => slope_of(&[t.all(c0[i]), t.all(c1[i]), t.all(c2[i]), t.all(c3[i])], t),
        }
    }
}

/// Bounds of the six functions over one interval.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct SixBounds {
    /// Upper bounds of |f|.
    pub value: Six,
    /// Upper bounds of |f'|.
    pub slope: Six,
    /// Upper bounds of |f''| between kinks.
    pub curvature: Six,
    /// Lower bounds of f'' between kinks, with sign.
    pub curvature_low: Six,
    /// Upper bounds of f'' between kinks, with sign.
    pub curvature_high: Six,
    /// Sums of |jumps of f'| inside the interval.
    pub kinks: Six,
    /// The same, weighted as [`Bounds::kinks_on_line`].
    pub kinks_on_line: Six,
}

impl SixBounds {
    /// What holds for both.
    #[must_use]
    pub fn union(&self, other: &Self) -> Self {
        let larger = |a: &Six, b: &Six| -> Six { std::array::from_fn(|i| a[i].max(b[i])) };
        Self {
            value: larger(&self.value, &other.value),
            slope: larger(&self.slope, &other.slope),
            curvature: larger(&self.curvature, &other.curvature),
            curvature_low: std::array::from_fn(|i| self.curvature_low[i].min(other.curvature_low[i])),
            curvature_high: larger(&self.curvature_high, &other.curvature_high),
            kinks: larger(&self.kinks, &other.kinks),
            kinks_on_line: larger(&self.kinks_on_line, &other.kinks_on_line),
        }
    }
}

impl AxisTables {
    /// Puts up to six functions together, in the order `EX EY EZ EA EB EC`; absent ones are zero.
    ///
    /// `None` where no function is given, or where the given ones have no interval in common.
    #[must_use]
    pub fn new(functions: &[Option<Table>; 6]) -> Option<Self> {
        let given = || functions.iter().flatten();
        let low = given().map(|t| t.range().low).reduce(f64::max)?;
        let high = given().map(|t| t.range().high).reduce(f64::min)?;
        let mut nodes: Vec<f64> =
            given().flat_map(Table::nodes).copied().filter(|&q| low <= q && q <= high).collect();
        nodes.sort_by(f64::total_cmp);
        nodes.dedup();
        if nodes.len() < 2 {
            return None;
        }
        let mut straight = Vec::with_capacity(nodes.len() - 1);
        let mut curved = Vec::with_capacity(nodes.len() - 1);
        for &node in &nodes[..nodes.len() - 1] {
            let mut rows = [[0.0; 6]; 4];
            for (function, table) in functions.iter().enumerate() {
                let cubic = table.as_ref().map_or([0.0; 4], |t| t.cubic_from(node));
                for (row, coefficient) in rows.iter_mut().zip(cubic) {
                    row[function] = coefficient;
                }
            }
            straight.push([rows[0], rows[1]]);
            curved.push([rows[2], rows[3]]);
        }
        if curved.iter().flatten().flatten().all(|&c| c == 0.0) {
            curved.clear();
        }
        Some(Self { grid: Grid::new(nodes.into()), straight: straight.into(), curved: curved.into() })
    }

    /// Half the sum of two sets: what is expected where the direction of approach is unknown.
    ///
    /// `None` where they have no interval in common.
    #[must_use]
    pub fn mean(a: &Self, b: &Self) -> Option<Self> {
        let (low, high) = (a.grid.low().max(b.grid.low()), a.grid.high().min(b.grid.high()));
        let inside = |q: &f64| low <= *q && *q <= high;
        let mut nodes: Vec<f64> =
            a.grid.nodes().iter().chain(b.grid.nodes()).copied().filter(inside).collect();
        nodes.sort_by(f64::total_cmp);
        nodes.dedup();
        if nodes.len() < 2 {
            return None;
        }
        let rows: Vec<[Six; 4]> = nodes[..nodes.len() - 1]
            .iter()
            .map(|&node| {
                let (from_a, from_b) = (a.rows_from(node), b.rows_from(node));
                std::array::from_fn(|r| std::array::from_fn(|f| 0.5 * (from_a[r][f] + from_b[r][f])))
            })
            .collect();
        let straight = rows.iter().map(|r| [r[0], r[1]]).collect();
        let straight_only = a.curved.is_empty() && b.curved.is_empty();
        let curved = if straight_only { Box::default() } else { rows.iter().map(|r| [r[2], r[3]]).collect() };
        Some(Self { grid: Grid::new(nodes.into()), straight, curved })
    }

    /// The same functions, all values of one of them moved by a constant.
    #[must_use]
    pub fn shifted(mut self, function: usize, by: f64) -> Self {
        for cell in &mut self.straight {
            cell[0][function] += by;
        }
        self
    }

    /// The same functions, each multiplied by a factor of its own.
    #[must_use]
    pub fn scaled(mut self, factors: &Six) -> Self {
        for coefficients in self.straight.iter_mut().chain(&mut self.curved).flatten() {
            for (coefficient, factor) in coefficients.iter_mut().zip(factors) {
                *coefficient *= factor;
            }
        }
        self
    }

    /// Largest |f| of each function over a range.
    ///
    /// Looked for at the ends and at the nodes between: no interpolation of [`Interpolation`](crate::Interpolation)
    /// leaves the values of its nodes.
    #[must_use]
    pub fn largest(&self, range: Range) -> Six {
        let inside = self.grid.nodes().iter().copied().filter(|&q| range.contains(q));
        inside.chain([range.low, range.high]).map(|q| self.at(q)).fold([0.0; 6], |largest, six| {
            std::array::from_fn(|function| f64::max(largest[function], six[function].abs()))
        })
    }

    /// The same constants over the whole of `range`: errors that do not depend on the place.
    #[must_use]
    pub fn constant(range: Range, values: Six) -> Self {
        let nodes = [range.low, range.high.max(range.low.next_up())];
        Self {
            grid: Grid::new(nodes.into()),
            straight: Box::new([[values, [0.0; 6]]]),
            curved: Box::default(),
        }
    }

    /// Where the functions have nodes, rising, mm or rad.
    #[must_use]
    pub fn nodes(&self) -> &[f64] {
        self.grid.nodes()
    }

    /// The interval all functions cover.
    #[must_use]
    pub fn range(&self) -> Range {
        Range { low: self.grid.low(), high: self.grid.high() }
    }

    /// Coefficients of the cubics of the cell that holds `q`, written from `q` on.
    fn rows_from(&self, q: f64) -> [Six; 4] {
        let cell = self.grid.cell(q);
        let t = q - self.grid.nodes()[cell];
        let [c0, c1] = self.straight[cell];
        let [c2, c3] = self.curved.get(cell).copied().unwrap_or_default();
        let by = |f: &dyn Fn(usize) -> f64| std::array::from_fn(f);
        [
            by(&|i| c0[i] + t * (c1[i] + t * (c2[i] + t * c3[i]))),
            by(&|i| c1[i] + t * (2.0 * c2[i] + t * 3.0 * c3[i])),
            by(&|i| c2[i] + 3.0 * c3[i] * t),
            c3,
        ]
    }

    fn cubic(&self, cell: usize, function: usize) -> Cubic {
        let [c0, c1] = &self.straight[cell];
        let [c2, c3] = self.curved.get(cell).copied().unwrap_or_default();
        [c0[function], c1[function], c2[function], c3[function]]
    }

    /// A cell by its number.
    #[inline(always)]
    fn cell(&self, cell: usize) -> Cell<'_> {
        Cell {
            low: self.grid.nodes()[cell],
            high: self.grid.nodes()[cell + 1],
            straight: &self.straight[cell],
            curved: self.curved.get(cell),
        }
    }

    /// The cell that `q` lies in, where its [`Cell::low`] and [`Cell::high`] say so.
    #[inline(always)]
    pub(crate) fn likely_cell(&self, q: f64) -> Cell<'_> {
        self.cell(self.grid.likely_cell(q))
    }

    /// The cell of `q`, or of the nearer end, and how far it lies from the lower node.
    #[inline(always)]
    pub(crate) fn cell_of(&self, q: f64) -> (Cell<'_>, f64) {
        let q = q.clamp(self.grid.low(), self.grid.high());
        let cell = self.cell(self.grid.cell(q));
        let t = q - cell.low;
        (cell, t)
    }

    /// All six at `q`; outside the range the values of the nearer end.
    #[must_use]
    #[inline(always)]
    pub fn at(&self, q: f64) -> Six {
        let (cell, t) = self.cell_of(q);
        cell.at(t)
    }

    /// All six and their slopes at `q`, which lies in the range; at a kink the slope of the upper side.
    #[must_use]
    #[inline(always)]
    pub fn with_slopes(&self, q: f64) -> (Six, Six) {
        let (cell, t) = self.cell_of(q);
        cell.with_slopes(t)
    }

    /// Bounds that hold on every interval of at most these lengths, mm, wherever it lies in the range.
    #[must_use]
    pub fn bounds_anywhere<const N: usize>(&self, lengths_mm: [f64; N]) -> [SixBounds; N] {
        let mut all = [self.bounds_across_cells(self.range()); N];
        let nodes = &self.grid.nodes()[1..self.grid.nodes().len() - 1];
        for function in 0..6 {
            let jump = |node: &f64| {
                let beside = Range { low: node.next_down(), high: node.next_up() };
                table::bounds_over(&self.grid, beside, |cell| self.cubic(cell, function)).kinks
            };
            let jumps: Vec<f64> = nodes.iter().map(jump).collect();
            for (bounds, length_mm) in all.iter_mut().zip(lengths_mm) {
                let (mut most, mut sum, mut first) = (0.0_f64, 0.0, 0);
                for last in 0..nodes.len() {
                    sum += jumps[last];
                    while nodes[last] - nodes[first] > length_mm {
                        sum -= jumps[first];
                        first += 1;
                    }
                    most = most.max(sum);
                }
                // What was taken away again leaves its rounding.
                bounds.kinks[function] = most * (1.0 + 1e-9);
                bounds.kinks_on_line[function] = bounds.kinks[function];
            }
        }
        all
    }

    /// Bounds of all six that hold everywhere in `range`.
    #[must_use]
    #[inline]
    pub fn bounds(&self, range: Range) -> SixBounds {
        let mut all = SixBounds::default();
        self.bounds_into(range, &mut all);
        all
    }

    /// [`Self::bounds`] written to where they are wanted.
    #[inline]
    pub(crate) fn bounds_into(&self, range: Range, all: &mut SixBounds) {
        if self.curved.is_empty() && self.grid.low() <= range.low && range.high <= self.grid.high() {
            self.bounds_of_lines(range, all);
        } else {
            *all = self.bounds_across_cells(range);
        }
    }

    /// [`Self::bounds_across_cells`] where all functions are straight lines and the range is theirs: the common case.
    #[inline]
    fn bounds_of_lines(&self, range: Range, all: &mut SixBounds) {
        let Range { low, high } = range;
        let nodes = self.grid.nodes();
        let (first, mut last) = (self.grid.cell(low), self.grid.cell(high));
        if last > first && nodes[last] >= high {
            last -= 1; // the interval ends on the node: what follows is not inside
        }
        let within = |cell: usize, i: usize, from: f64| {
            let ([c0, c1], to) = (&self.straight[cell], high.min(nodes[cell + 1]) - nodes[cell]);
            larger((c0[i] + from * c1[i]).abs(), (c0[i] + to * c1[i]).abs())
        };
        let from = low - nodes[first];
        *all = SixBounds {
            value: std::array::from_fn(|i| within(first, i, from)),
            slope: std::array::from_fn(|i| self.straight[first][1][i].abs()),
            ..SixBounds::default()
        };
        for (cell, node) in nodes.iter().enumerate().take(last + 1).skip(first + 1) {
            let ([_, before], [_, c1]) = (&self.straight[cell - 1], &self.straight[cell]);
            let at = (node - low) / (high - low);
            let weight = (4.0 * at * (1.0 - at)).max(0.0);
            for i in 0..6 {
                all.value[i] = larger(all.value[i], within(cell, i, 0.0));
                all.slope[i] = larger(all.slope[i], c1[i].abs());
                let jump = table::real_jump(c1[i] - before[i], c1[i], before[i]);
                all.kinks[i] += jump;
                all.kinks_on_line[i] += jump * weight;
            }
        }
    }

    fn bounds_across_cells(&self, range: Range) -> SixBounds {
        let mut all = SixBounds::default();
        for function in 0..6 {
            let one: Bounds = table::bounds_over(&self.grid, range, |cell| self.cubic(cell, function));
            all.value[function] = one.value;
            all.slope[function] = one.slope;
            all.curvature[function] = one.curvature;
            [all.curvature_low[function], all.curvature_high[function]] = one.curvature_range;
            all.kinks[function] = one.kinks;
            all.kinks_on_line[function] = one.kinks_on_line;
        }
        all
    }
}

/// The larger of two numbers that are numbers.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Interpolation;

    fn table(nodes: &[f64], values: &[f64], interpolation: Interpolation) -> Option<Table> {
        Some(Table::new(nodes.to_vec(), values.to_vec(), interpolation).unwrap())
    }

    #[test]
    fn tables_on_different_nodes_keep_their_values() {
        let a = table(&[0.0, 10.0, 20.0, 30.0], &[0.0, 1.0, -1.0, 5.0], Interpolation::Linear);
        let b = table(&[-5.0, 3.0, 21.0, 28.0], &[1.0, 4.0, 2.0, 2.5], Interpolation::Monotone);
        let six = AxisTables::new(&[a.clone(), None, None, b.clone(), None, None]).unwrap();
        assert_eq!(six.range(), Range { low: 0.0, high: 28.0 });
        for i in 0..=280 {
            let q = f64::from(i) * 0.1;
            let at = six.at(q);
            assert!((at[0] - a.as_ref().unwrap().value(q)).abs() < 1e-14);
            assert!((at[3] - b.as_ref().unwrap().value(q)).abs() < 1e-14);
            assert_eq!(at[1], 0.0);
        }
        let range = Range { low: 2.0, high: 25.0 };
        let bounds = six.bounds(range);
        assert!((bounds.kinks[0] - a.unwrap().bounds(range).kinks).abs() < 1e-12);
        assert!(bounds.kinks[3] < 1e-9, "{}", bounds.kinks[3]);
    }

    #[test]
    fn the_mean_lies_in_the_middle() {
        let a = AxisTables::new(&[
            table(&[0.0, 10.0], &[0.0, 1.0], Interpolation::Linear),
            None,
            None,
            None,
            None,
            None,
        ])
        .unwrap();
        let b = AxisTables::new(&[
            table(&[0.0, 5.0, 10.0], &[2.0, 2.0, 3.0], Interpolation::Linear),
            None,
            None,
            None,
            None,
            None,
        ])
        .unwrap();
        let mean = AxisTables::mean(&a, &b).unwrap();
        assert_eq!(mean.at(5.0)[0], 1.25);
        assert_eq!(mean.at(10.0)[0], 2.0);
        assert_eq!(mean.shifted(0, 0.5).at(0.0)[0], 1.5);
    }

    #[test]
    fn each_function_has_a_factor_and_a_largest_value_of_its_own() {
        let line = table(&[0.0, 10.0, 20.0], &[3.0, -4.0, 1.0], Interpolation::Monotone);
        let six = AxisTables::new(&[line.clone(), None, None, None, line, None]).unwrap();
        let largest = |low, high| six.largest(Range { low, high });
        assert_eq!(largest(0.0, 20.0), [4.0, 0.0, 0.0, 0.0, 4.0, 0.0]);
        assert_eq!(largest(0.0, 0.0)[0], 3.0);
        let scaled = six.clone().scaled(&[2.0, 1.0, 1.0, 1.0, 0.0, 1.0]);
        for q in [0.0, 3.3, 10.0, 17.0] {
            assert_eq!(scaled.at(q), [2.0 * six.at(q)[0], 0.0, 0.0, 0.0, 0.0, 0.0]);
        }
    }

    #[test]
    fn the_short_way_to_bounds_agrees_with_the_long_one() {
        let a = table(&[0.0, 10.0, 20.0], &[0.3, 1.0, -1.0], Interpolation::Linear);
        let six = AxisTables::new(&[None, a, None, None, None, None]).unwrap();
        for (low, high) in
            [(11.0, 20.0), (10.0, 20.0), (0.0, 10.0), (3.0, 17.5), (0.0, 20.0), (10.0, 10.0), (4.0, 4.0)]
        {
            let range = Range { low, high };
            assert_eq!(six.bounds(range), six.bounds_across_cells(range), "{low} to {high}");
        }
    }

    #[test]
    fn tables_without_common_ground_are_no_set() {
        let a = table(&[0.0, 1.0], &[0.0, 0.0], Interpolation::Linear);
        let b = table(&[2.0, 3.0], &[0.0, 0.0], Interpolation::Linear);
        assert!(AxisTables::new(&[a, b, None, None, None, None]).is_none());
        assert!(AxisTables::new(&[None, None, None, None, None, None]).is_none());
    }
}
