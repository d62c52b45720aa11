//! One error function of one axis: nodes, values, and what lies between.
//!
//! Equations (1) to (4) of `docs/equations.md`.

use crate::Range;
use crate::real::Real;

/// What lies between the nodes of a table.
///
/// ```
/// use machine_model::{Interpolation, Table};
///
/// let (nodes, values) = (vec![0.0, 10.0, 20.0], vec![0.0, 0.004, 0.004]);
/// let between = |kind| Table::new(nodes.clone(), values.clone(), kind).unwrap().value(15.0);
/// assert_eq!(between(Interpolation::Linear), 0.004);
/// // Where the nodes are level, the curve is: no overshoot.
/// assert_eq!(between(Interpolation::Monotone), 0.004);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Interpolation {
    /// Straight lines: continuous, with a kink at every node.
    #[default]
    Linear,
    /// Piecewise cubic without overshoot (Fritsch and Carlson 1980, slopes of Fritsch and Butland 1984):
    /// continuous slope, monotonic wherever the nodes are.
    Monotone,
}

/// Why numbers are not a table.
///
/// ```
/// use machine_model::{Interpolation, Table, TableError};
///
/// let table = |nodes: &[f64]| Table::new(nodes.to_vec(), vec![0.0; nodes.len()], Interpolation::Linear);
/// assert_eq!(table(&[0.0]).unwrap_err(), TableError::TooShort(1));
/// let back = TableError::NotIncreasing { row: 2, position: 5.0, before: 10.0 };
/// assert_eq!(table(&[0.0, 10.0, 5.0]).unwrap_err(), back);
/// assert_eq!(back.to_string(), "row 2: position 5 does not lie above 10 of the row before");
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// A curve needs two nodes.
    #[error("a table needs at least 2 rows, this one has {0}")]
    TooShort(usize),
    /// Not as many values as nodes.
    #[error("{nodes} nodes, but {values} values")]
    Lengths {
        /// Number of nodes.
        nodes: usize,
        /// Number of values.
        values: usize,
    },
    /// A node or value is infinite or not a number.
    #[error("row {row} holds a number that is not finite")]
    NotFinite {
        /// Row, from 0.
        row: usize,
    },
    /// Nodes must increase from row to row.
    #[error("row {row}: position {position} does not lie above {before} of the row before")]
    NotIncreasing {
        /// Row, from 0.
        row: usize,
        /// The position there.
        position: f64,
        /// The position one row before.
        before: f64,
    },
}

/// How large a function and its derivatives can get on an interval.
///
/// ```
/// use machine_model::{Interpolation, Range, Table};
///
/// // Up and down again by 4 µm: the slope jumps by 0.0008 in the middle.
/// let table = Table::new(vec![0.0, 10.0, 20.0], vec![0.0, 0.004, 0.0], Interpolation::Linear).unwrap();
/// let whole = table.bounds(Range { low: 0.0, high: 20.0 });
/// assert!((whole.value - 0.004).abs() < 1e-12 && (whole.slope - 0.0004).abs() < 1e-12);
/// assert!((whole.kinks - 0.0008).abs() < 1e-12);
/// // On one side of the kink there is none.
/// assert_eq!(table.bounds(Range { low: 1.0, high: 9.0 }).kinks, 0.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Bounds {
    /// Upper bound of |f|.
    pub value: f64,
    /// Upper bound of |f'|.
    pub slope: f64,
    /// Upper bound of |f''| between the kinks.
    pub curvature: f64,
    /// Lower and upper bound of f'' between the kinks, with sign.
    pub curvature_range: [f64; 2],
    /// Sum of |jumps of f'| at the kinks strictly inside the interval.
    pub kinks: f64,
    /// The same sum, each jump weighted with 4s(1-s), s its place in the interval from 0 to 1: what a kink
    /// weighs in the distance to the chord where the interval is run through evenly. Equation (12).
    pub kinks_on_line: f64,
}

/// Ordered nodes with a quick way to the cell of a command.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Grid {
    nodes: Box<[f64]>,
    /// Cells per mm if the nodes were equidistant: a first guess, always checked.
    cells_per_mm: f64,
}

impl Grid {
    /// `nodes`: at least two, finite, strictly increasing.
    pub(crate) fn new(nodes: Box<[f64]>) -> Self {
        let cells = (nodes.len() - 1) as f64;
        let cells_per_mm = cells / (nodes[nodes.len() - 1] - nodes[0]);
        Self { nodes, cells_per_mm }
    }
    pub(crate) fn nodes(&self) -> &[f64] {
        &self.nodes
    }
    pub(crate) fn low(&self) -> f64 {
        self.nodes[0]
    }
    pub(crate) fn high(&self) -> f64 {
        self.nodes[self.nodes.len() - 1]
    }
    /// Largest `k` with `nodes[k] <= q`, at most the last cell; 0 below the nodes and for NaN.
    #[inline]
    pub(crate) fn cell(&self, q: f64) -> usize {
        let last = self.nodes.len() - 2;
        let guess = self.likely_cell(q);
        let fits = (self.nodes[guess] <= q || guess == 0) && (q < self.nodes[guess + 1] || guess == last);
        if fits { guess } else { self.search(q) }
    }
    /// The cell of `q` where the nodes are even.
    #[inline(always)]
    pub(crate) fn likely_cell(&self, q: f64) -> usize {
        // A float-to-integer cast saturates: negative and NaN give 0. To 32 bits it takes a third of the instructions.
        (((q - self.nodes[0]) * self.cells_per_mm) as u32 as usize).min(self.nodes.len() - 2)
    }
    #[cold]
    fn search(&self, q: f64) -> usize {
        let above = self.nodes.partition_point(|&node| node <= q);
        above.saturating_sub(1).min(self.nodes.len() - 2)
    }
}

/// Checks what every table must satisfy.
pub(crate) fn check(nodes: &[f64], values: &[f64]) -> Result<(), TableError> {
    if nodes.len() != values.len() {
        return Err(TableError::Lengths { nodes: nodes.len(), values: values.len() });
    }
    if nodes.len() < 2 {
        return Err(TableError::TooShort(nodes.len()));
    }
    for (row, (node, value)) in nodes.iter().zip(values).enumerate() {
        if !node.is_finite() || !value.is_finite() {
            return Err(TableError::NotFinite { row });
        }
        if row > 0 && *node <= nodes[row - 1] {
            return Err(TableError::NotIncreasing { row, position: *node, before: nodes[row - 1] });
        }
    }
    Ok(())
}

/// Coefficients of one cell, `c0 + t·(c1 + t·(c2 + t·c3))`, `t` from the cell's lower node.
pub(crate) type Cubic = [f64; 4];

#[inline(always)]
pub(crate) fn value_of<T: Real>(c: &[T; 4], t: T) -> T {
    c[0] + t * (c[1] + t * (c[2] + t * c[3]))
}
#[inline(always)]
pub(crate) fn slope_of<T: Real>(c: &[T; 4], t: T) -> T {
    c[1] + t * (t.all(2.0) * c[2] + t * (t.all(3.0) * c[3]))
}

/// Bounds of one cubic for `t` in `low..=high`: equation (4).
///
/// A function lies within `w²/8·max|f''|` of its chord over a width `w`; the same is said of the slope.
#[inline]
pub(crate) fn bounds_of(c: &Cubic, low: f64, high: f64) -> Bounds {
    let larger = |a: f64, b: f64| a.abs().max(b.abs());
    if c[2] == 0.0 && c[3] == 0.0 {
        let value = larger(c[0] + c[1] * low, c[0] + c[1] * high);
        return Bounds { value, slope: c[1].abs(), ..Bounds::default() };
    }
    let eighth = (high - low) * (high - low) / 8.0;
    let (from, to) = (2.0 * c[2] + 6.0 * c[3] * low, 2.0 * c[2] + 6.0 * c[3] * high);
    let curvature = larger(from, to);
    Bounds {
        value: larger(value_of(c, low), value_of(c, high)) + curvature * eighth,
        slope: larger(slope_of(c, low), slope_of(c, high)) + (6.0 * c[3]).abs() * eighth,
        curvature,
        curvature_range: [from.min(to), from.max(to)],
        ..Bounds::default()
    }
}

/// Joins what holds on two intervals, kinks apart.
#[inline]
fn join(so_far: &mut Bounds, other: &Bounds) {
    so_far.value = so_far.value.max(other.value);
    so_far.slope = so_far.slope.max(other.slope);
    so_far.curvature = so_far.curvature.max(other.curvature);
    let [low, high] = &mut so_far.curvature_range;
    *low = low.min(other.curvature_range[0]);
    *high = high.max(other.curvature_range[1]);
}

/// One error function of one axis command.
///
/// Outside its nodes it keeps the value of the nearest end: nothing is extrapolated.
///
/// ```
/// use machine_model::{Interpolation, Table};
///
/// // Measured every 100 mm, in mm.
/// let table = Table::new(vec![0.0, 100.0, 200.0], vec![0.0, 0.006, 0.004], Interpolation::Linear).unwrap();
/// assert!((table.value(50.0) - 0.003).abs() < 1e-12);
/// // Outside the nodes holds the value of the nearer end.
/// assert_eq!(table.value(250.0), table.value(200.0));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    grid: Grid,
    cells: Box<[Cubic]>,
    interpolation: Interpolation,
}

impl Table {
    /// From nodes (axis command, mm or rad) and values (mm or rad).
    ///
    /// # Errors
    /// [`TableError`] unless there are at least two rows, all finite, positions strictly increasing.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "nodes are kept; values stand beside them in every call"
    )]
    pub fn new(nodes: Vec<f64>, values: Vec<f64>, interpolation: Interpolation) -> Result<Self, TableError> {
        check(&nodes, &values)?;
        let slopes = match interpolation {
            Interpolation::Monotone if nodes.len() > 2 => Some(monotone_slopes(&nodes, &values)),
            _ => None,
        };
        let cells = (0..nodes.len() - 1)
            .map(|k| {
                let width = nodes[k + 1] - nodes[k];
                let secant = (values[k + 1] - values[k]) / width;
                match &slopes {
                    None => [values[k], secant, 0.0, 0.0],
                    Some(d) => [
                        values[k],
                        d[k],
                        (3.0 * secant - 2.0 * d[k] - d[k + 1]) / width,
                        (d[k] + d[k + 1] - 2.0 * secant) / (width * width),
                    ],
                }
            })
            .collect();
        Ok(Self { grid: Grid::new(nodes.into()), cells, interpolation })
    }

    /// The interval its nodes cover.
    #[must_use]
    pub fn range(&self) -> Range {
        Range { low: self.grid.low(), high: self.grid.high() }
    }

    /// Its nodes, in order.
    #[must_use]
    pub fn nodes(&self) -> &[f64] {
        self.grid.nodes()
    }

    /// How it runs between the nodes.
    #[must_use]
    pub fn interpolation(&self) -> Interpolation {
        self.interpolation
    }

    /// The value at `q`; outside the range that of the nearer end.
    #[must_use]
    #[inline]
    pub fn value(&self, q: f64) -> f64 {
        let q = q.clamp(self.grid.low(), self.grid.high());
        let cell = self.grid.cell(q);
        value_of(&self.cells[cell], q - self.grid.nodes()[cell])
    }

    /// Bounds that hold everywhere in `range`, parts outside the nodes included.
    #[must_use]
    pub fn bounds(&self, range: Range) -> Bounds {
        bounds_over(&self.grid, range, |cell| self.cells[cell])
    }

    /// The cubic of the cell that holds `q`, written from `q` on: exact, for tables with other nodes.
    pub(crate) fn cubic_from(&self, q: f64) -> Cubic {
        let cell = self.grid.cell(q);
        let c = &self.cells[cell];
        let t = q - self.grid.nodes()[cell];
        [value_of(c, t), slope_of(c, t), c[2] + 3.0 * c[3] * t, c[3]]
    }
}

/// Bounds of a piecewise cubic over `range`; constant beyond the ends of the grid.
pub(crate) fn bounds_over(grid: &Grid, range: Range, cubic: impl Fn(usize) -> Cubic) -> Bounds {
    let nodes = grid.nodes();
    let low = range.low.clamp(grid.low(), grid.high());
    let high = range.high.clamp(grid.low(), grid.high());
    let (first, mut last) = (grid.cell(low), grid.cell(high));
    if last > first && nodes[last] >= high {
        last -= 1; // the interval ends on the node: what follows is not inside
    }
    let end = |k: usize| high.min(nodes[k + 1]) - nodes[k];
    let mut all = bounds_of(&cubic(first), low - nodes[first], end(first));
    let kink = |all: &mut Bounds, node: f64, jump: f64| {
        let at = (node - range.low) / (range.high - range.low);
        all.kinks += jump;
        all.kinks_on_line += jump * (4.0 * at * (1.0 - at)).max(0.0);
    };
    for k in first + 1..=last {
        let jump = slope_of(&cubic(k), 0.0) - slope_of(&cubic(k - 1), nodes[k] - nodes[k - 1]);
        kink(&mut all, nodes[k], real_jump(jump, cubic(k)[1], cubic(k - 1)[1]));
        join(&mut all, &bounds_of(&cubic(k), 0.0, end(k)));
    }
    if range.low < grid.low() || range.high > grid.high() {
        join(&mut all, &Bounds::default());
    }
    // Beyond the ends the function is constant: a kink where the interval reaches over an end.
    if range.low < grid.low() && range.high > grid.low() {
        kink(&mut all, grid.low(), slope_of(&cubic(0), 0.0).abs());
    }
    if range.high > grid.high() && range.low < grid.high() {
        let k = nodes.len() - 2;
        kink(&mut all, grid.high(), slope_of(&cubic(k), nodes[k + 1] - nodes[k]).abs());
    }
    all
}

/// A jump as it is meant: neighbouring cubics with equal slopes differ by rounding only, far below any
/// effect; counting that would cost time and say nothing. `above` and `below` are the slopes that their cells begin with.
#[inline]
pub(crate) fn real_jump(jump: f64, above: f64, below: f64) -> f64 {
    let scale = above.abs().max(below.abs());
    if jump.abs() <= 1e-12 * scale { 0.0 } else { jump.abs() }
}

/// Slopes at the nodes that keep the shape: equation (3).
fn monotone_slopes(nodes: &[f64], values: &[f64]) -> Vec<f64> {
    let n = nodes.len();
    let width: Vec<f64> = nodes.windows(2).map(|w| w[1] - w[0]).collect();
    let secant: Vec<f64> = (0..n - 1).map(|k| (values[k + 1] - values[k]) / width[k]).collect();
    let mut slopes = vec![0.0; n];
    for k in 1..n - 1 {
        let (left, right) = (secant[k - 1], secant[k]);
        if left * right > 0.0 {
            let a = 2.0 * width[k] + width[k - 1];
            let b = width[k] + 2.0 * width[k - 1];
            slopes[k] = (a + b) / (a / left + b / right);
        }
    }
    slopes[0] = end_slope(width[0], width[1], secant[0], secant[1]);
    slopes[n - 1] = end_slope(width[n - 2], width[n - 3], secant[n - 2], secant[n - 3]);
    slopes
}

/// Slope at an end from three nodes, limited so that the curve does not overshoot.
fn end_slope(near: f64, far: f64, secant_near: f64, secant_far: f64) -> f64 {
    let slope = ((2.0 * near + far) * secant_near - near * secant_far) / (near + far);
    if slope * secant_near <= 0.0 {
        0.0
    } else if secant_near * secant_far <= 0.0 && slope.abs() > 3.0 * secant_near.abs() {
        3.0 * secant_near
    } else {
        slope
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn refuses_what_is_not_a_table() {
        let new =
            |n: &[f64], v: &[f64]| Table::new(n.to_vec(), v.to_vec(), Interpolation::Linear).unwrap_err();
        assert_eq!(new(&[0.0], &[1.0]), TableError::TooShort(1));
        assert_eq!(new(&[0.0, 1.0], &[1.0]), TableError::Lengths { nodes: 2, values: 1 });
        assert_eq!(new(&[0.0, 1.0], &[1.0, f64::NAN]), TableError::NotFinite { row: 1 });
        assert_eq!(
            new(&[0.0, 1.0, 1.0], &[0.0; 3]),
            TableError::NotIncreasing { row: 2, position: 1.0, before: 1.0 }
        );
    }

    #[test]
    fn keeps_the_end_values_and_never_extrapolates() {
        for interpolation in [Interpolation::Linear, Interpolation::Monotone] {
            let table = Table::new(vec![0.0, 10.0, 30.0], vec![1.0, 2.0, -1.0], interpolation).unwrap();
            assert_eq!(table.value(-5.0), 1.0);
            assert!((table.value(35.0) - -1.0).abs() < 1e-15);
            assert_eq!(table.value(10.0), 2.0);
        }
    }

    #[test]
    fn linear_between_nodes_of_any_spacing() {
        let table = Table::new(
            vec![0.0, 1.0, 2.0, 50.0, 100.0],
            vec![0.0, 1.0, 4.0, 0.0, 10.0],
            Interpolation::Linear,
        )
        .unwrap();
        assert_eq!(table.value(0.5), 0.5);
        assert_eq!(table.value(26.0), 2.0);
        assert_eq!(table.value(99.0), 9.8);
        let bounds = table.bounds(Range { low: 0.5, high: 26.0 });
        assert_eq!(bounds.value, 4.0);
        assert_eq!(bounds.slope, 3.0);
        assert_eq!(bounds.curvature, 0.0);
        assert!((bounds.kinks - (2.0 + 3.0 + 4.0 / 48.0)).abs() < 1e-15);
        // Knots on the ends of the interval are not inside it.
        assert_eq!(table.bounds(Range { low: 1.0, high: 2.0 }).kinks, 0.0);
    }

    #[test]
    fn leaving_the_nodes_is_a_kink() {
        let table = Table::new(vec![0.0, 10.0], vec![0.0, 5.0], Interpolation::Linear).unwrap();
        assert_eq!(table.bounds(Range { low: -1.0, high: 11.0 }).kinks, 1.0);
        assert_eq!(table.bounds(Range { low: 0.0, high: 10.0 }).kinks, 0.0);
    }

    /// Value and slope at `q`. At a kink the slope of the upper side; outside the range 0.
    fn value_and_slope(table: &Table, q: f64) -> (f64, f64) {
        let inside = q.clamp(table.grid.low(), table.grid.high());
        let [value, slope, ..] = table.cubic_from(inside);
        (value, if inside == q { slope } else { 0.0 })
    }

    fn nodes_and_values() -> impl Strategy<Value = (Vec<f64>, Vec<f64>)> {
        prop::collection::vec((0.01f64..20.0, -1.0f64..1.0), 2..12).prop_map(|rows| {
            let mut at = -15.0;
            rows.into_iter()
                .map(|(step, value)| {
                    at += step;
                    (at, value)
                })
                .unzip()
        })
    }

    proptest! {
        #[test]
        fn bounds_hold_everywhere((nodes, values) in nodes_and_values(), a in -30.0f64..100.0, b in -30.0f64..100.0,
                                  monotone: bool) {
            let interpolation = if monotone { Interpolation::Monotone } else { Interpolation::Linear };
            let table = Table::new(nodes, values, interpolation).unwrap();
            let range = Range { low: a.min(b), high: a.max(b) };
            let bounds = table.bounds(range);
            let n = 500;
            let mut before: Option<(f64, f64)> = None;
            let mut variation = 0.0;
            for i in 0..=n {
                let q = range.low + (range.high - range.low) * f64::from(i) / f64::from(n);
                let (value, slope) = value_and_slope(&table, q);
                prop_assert!(value.abs() <= bounds.value * (1.0 + 1e-9) + 1e-12);
                prop_assert!(slope.abs() <= bounds.slope * (1.0 + 1e-9) + 1e-12);
                if let Some((q0, slope0)) = before {
                    variation += ((slope - slope0).abs() - bounds.curvature * (q - q0)).max(0.0);
                }
                before = Some((q, slope));
            }
            prop_assert!(variation <= bounds.kinks * (1.0 + 1e-9) + 1e-9);
        }

        #[test]
        fn the_monotone_curve_does_not_overshoot((nodes, values) in nodes_and_values(), at in 0.0f64..1.0) {
            let table = Table::new(nodes.clone(), values.clone(), Interpolation::Monotone).unwrap();
            for k in 0..nodes.len() - 1 {
                let value = table.value(nodes[k] + at * (nodes[k + 1] - nodes[k]));
                let (low, high) = (values[k].min(values[k + 1]), values[k].max(values[k + 1]));
                prop_assert!(low - 1e-12 <= value && value <= high + 1e-12);
            }
        }
    }
}
