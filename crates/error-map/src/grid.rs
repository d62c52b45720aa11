//! Where the error is asked for: nodes along each axis, and parts of the grid they span.

use diagnostic::Speaks;
use std::ops::Range as Indices;

use machine_model::{Range, Vector};

/// Why nodes make no grid.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// The end lies before the beginning, or a number is not finite.
    #[error("nodes run from a first to a last place that is not below it")]
    Order,
    /// The step is zero, negative or longer than the range.
    #[error("a step of {step_mm} mm does not divide {length_mm} mm")]
    Step {
        /// Distance of neighbours, mm.
        step_mm: f64,
        /// Distance of the ends, mm.
        length_mm: f64,
    },
    /// Fewer than one node.
    #[error("an axis needs one node at least")]
    Empty,
    /// More nodes than can be held.
    #[error("{0} nodes are more than the {MOST_NODES} that a map may have")]
    TooMany(u64),
}

impl Speaks for GridError {
    fn russian(&self) -> String {
        match self {
            Self::Order => "узлы идут от первого места к последнему, которое не ниже его".to_owned(),
            Self::Step { step_mm, length_mm } => format!("шаг {step_mm} мм не делит {length_mm} мм"),
            Self::Empty => "на оси нужен хотя бы один узел".to_owned(),
            Self::TooMany(nodes) => format!("узлов {nodes}, а в карте их может быть не больше {MOST_NODES}"),
        }
    }
}

/// Most nodes of one grid: a map of them fills a few gigabytes.
const MOST_NODES: u64 = 50_000_000;

/// Places along one axis, mm, increasing.
#[derive(Clone, Debug, PartialEq)]
pub struct Nodes(Vec<f64>);

impl Nodes {
    /// `count` places from end to end of a range, equally far apart; one place: the middle.
    ///
    /// # Errors
    /// [`GridError`] for no places, too many, or a range without length.
    pub fn over(range: Range, count: u64) -> Result<Self, GridError> {
        if !(range.low.is_finite() && range.high.is_finite() && range.low <= range.high) {
            return Err(GridError::Order);
        }
        match count {
            0 => Err(GridError::Empty),
            1 => Ok(Self(vec![0.5 * (range.low + range.high)])),
            2..=MOST_NODES if range.low < range.high => {
                let last = (count - 1) as f64;
                let at = |i: u64| {
                    let share = i as f64 / last;
                    range.low * (1.0 - share) + range.high * share
                };
                Ok(Self((0..count).map(at).collect()))
            }
            2..=MOST_NODES => Err(GridError::Order),
            _ => Err(GridError::TooMany(count)),
        }
    }

    /// From a first to a last place by a step that divides the distance (to a millionth of the step).
    ///
    /// # Errors
    /// [`GridError`] where it does not divide it, or the ends are in the wrong order.
    pub fn stepped(first_mm: f64, last_mm: f64, step_mm: f64) -> Result<Self, GridError> {
        let length_mm = last_mm - first_mm;
        if !(first_mm.is_finite() && last_mm.is_finite() && length_mm >= 0.0) {
            return Err(GridError::Order);
        }
        if length_mm == 0.0 {
            return Ok(Self(vec![first_mm]));
        }
        let wrong = GridError::Step { step_mm, length_mm };
        if !(step_mm > 0.0 && step_mm.is_finite()) {
            return Err(wrong);
        }
        let steps = (length_mm / step_mm).round();
        if steps < 1.0 || (steps * step_mm - length_mm).abs() > 1e-6 * step_mm {
            return Err(wrong);
        }
        if steps >= MOST_NODES as f64 {
            return Err(GridError::TooMany(steps as u64));
        }
        Ok(Self((0..=steps as u64).map(|i| first_mm + i as f64 * step_mm).collect()))
    }

    /// The places, mm.
    #[must_use]
    pub fn places_mm(&self) -> &[f64] {
        &self.0
    }

    /// From the first to the last, mm.
    #[must_use]
    pub fn range_mm(&self) -> Range {
        Range { low: self.0[0], high: self.0[self.0.len() - 1] }
    }

    /// Index of the node nearest to a place; the lower one of two.
    #[must_use]
    pub fn nearest(&self, at_mm: f64) -> usize {
        let above = self.0.partition_point(|&node| node < at_mm).min(self.0.len() - 1);
        let below = above.saturating_sub(1);
        if at_mm - self.0[below] <= self.0[above] - at_mm { below } else { above }
    }

    /// Indices of the nodes inside a range, its ends included with a slack for decimal rounding.
    fn inside(&self, range: Range) -> Indices<usize> {
        let slack = 1e-9 * (1.0 + range.low.abs().max(range.high.abs()));
        let first = self.0.partition_point(|&node| node < range.low - slack);
        let end = self.0.partition_point(|&node| node <= range.high + slack);
        first..end.max(first)
    }
}

/// A plane of two axes, at a place of the third.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// XY, at a Z.
    Xy,
    /// XZ, at a Y.
    Xz,
    /// YZ, at an X.
    Yz,
}

impl Plane {
    /// All planes.
    pub const ALL: [Self; 3] = [Self::Xy, Self::Xz, Self::Yz];

    /// The axis that stands on it: 0 X, 1 Y, 2 Z.
    #[must_use]
    pub fn normal(self) -> usize {
        match self {
            Self::Xy => 2,
            Self::Xz => 1,
            Self::Yz => 0,
        }
    }

    /// `XY`, `XZ`, `YZ`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Xy => "XY",
            Self::Xz => "XZ",
            Self::Yz => "YZ",
        }
    }
}

/// Nodes of the three linear axes; node `(i, j, k)` has the index `i + n_X (j + n_Y k)`.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    axes: [Nodes; 3],
}

impl Grid {
    /// From the nodes of X, Y and Z.
    ///
    /// # Errors
    /// [`GridError::TooMany`] where the three make more nodes than a map may have.
    pub fn new(axes: [Nodes; 3]) -> Result<Self, GridError> {
        let count: u64 = axes.iter().map(|nodes| nodes.0.len() as u64).product();
        if count > MOST_NODES { Err(GridError::TooMany(count)) } else { Ok(Self { axes }) }
    }

    /// Nodes of X, Y and Z.
    #[must_use]
    pub fn axes(&self) -> &[Nodes; 3] {
        &self.axes
    }

    /// How many nodes each axis has.
    #[must_use]
    pub fn counts(&self) -> [usize; 3] {
        [0, 1, 2].map(|axis| self.axes[axis].0.len())
    }

    /// How many nodes there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.counts().iter().product()
    }

    /// False: a grid has one node at least.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The axis command of a node, mm.
    #[must_use]
    pub fn place_mm(&self, index: usize) -> Vector {
        let [nx, ny, _] = self.counts();
        let at = [index % nx, index / nx % ny, index / (nx * ny)];
        Vector::from_fn(|axis, _| self.axes[axis].0[at[axis]])
    }

    /// All of it.
    #[must_use]
    pub fn all(&self) -> Block {
        Block(self.counts().map(|count| 0..count))
    }

    /// The layer of nodes nearest to a place of the plane's normal.
    #[must_use]
    pub fn layer(&self, plane: Plane, at_mm: f64) -> Block {
        let mut block = self.all();
        let index = self.axes[plane.normal()].nearest(at_mm);
        block.0[plane.normal()] = index..index + 1;
        block
    }

    /// The nodes inside a box; may be none.
    #[must_use]
    pub fn region(&self, ranges_mm: &[Range; 3]) -> Block {
        Block([0, 1, 2].map(|axis| self.axes[axis].inside(ranges_mm[axis])))
    }
}

/// A part of a grid: a range of node numbers for each axis.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Block(pub(crate) [Indices<usize>; 3]);

impl Block {
    /// How many nodes it has.
    #[must_use]
    pub fn len(&self) -> usize {
        self.0.iter().map(ExactSizeIterator::len).product()
    }

    /// True where it has no nodes.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Node numbers per axis.
    #[must_use]
    pub fn ranges(&self) -> &[Indices<usize>; 3] {
        &self.0
    }

    /// Indices of its nodes in a grid, in the grid's order.
    pub fn indices<'g>(&'g self, grid: &Grid) -> impl Iterator<Item = usize> + use<'g> {
        let [nx, ny, _] = grid.counts();
        let [x, y, z] = self.0.clone();
        z.flat_map(move |k| {
            let x = x.clone();
            y.clone().flat_map(move |j| x.clone().map(move |i| i + nx * (j + ny * k)))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Teleshevsky 2013: X 40–880/40, Y 30–450/20, Z 5–505/25.
    fn published() -> Grid {
        let nodes = |first, last, step| Nodes::stepped(first, last, step).unwrap();
        Grid::new([nodes(40.0, 880.0, 40.0), nodes(30.0, 450.0, 20.0), nodes(5.0, 505.0, 25.0)]).unwrap()
    }

    #[test]
    fn the_published_grid_has_10164_nodes() {
        let grid = published();
        assert_eq!(grid.counts(), [22, 22, 21]);
        assert_eq!(grid.len(), 10_164);
        assert_eq!(grid.place_mm(0), Vector::new(40.0, 30.0, 5.0));
        assert_eq!(grid.place_mm(1), Vector::new(80.0, 30.0, 5.0));
        assert_eq!(grid.place_mm(22), Vector::new(40.0, 50.0, 5.0));
        assert_eq!(grid.place_mm(10_163), Vector::new(880.0, 450.0, 505.0));
    }

    #[test]
    fn planes_and_regions_hold_the_nodes_they_name() {
        let grid = published();
        let layer = grid.layer(Plane::Xy, 118.0);
        assert_eq!(layer.len(), 22 * 22);
        assert!(layer.indices(&grid).all(|index| grid.place_mm(index).z == 130.0));
        assert_eq!(grid.layer(Plane::Yz, 1e9).indices(&grid).count(), 22 * 21);
        let range = |low, high| Range { low, high };
        let region = grid.region(&[range(40.0, 120.0), range(31.0, 69.0), range(505.0, 505.0)]);
        let places: Vec<Vector> = region.indices(&grid).map(|index| grid.place_mm(index)).collect();
        assert_eq!(places.len(), 3);
        assert_eq!(places[2], Vector::new(120.0, 50.0, 505.0));
        assert!(grid.region(&[range(41.0, 79.0), range(0.0, 1e3), range(0.0, 1e3)]).is_empty());
    }

    #[test]
    fn what_is_no_grid_is_refused() {
        assert!(matches!(Nodes::stepped(0.0, 10.0, 3.0), Err(GridError::Step { .. })));
        assert!(matches!(Nodes::stepped(0.0, 10.0, 0.0), Err(GridError::Step { .. })));
        assert!(matches!(Nodes::stepped(0.0, 10.0, f64::NAN), Err(GridError::Step { .. })));
        assert!(matches!(Nodes::stepped(10.0, 0.0, 1.0), Err(GridError::Order)));
        assert!(matches!(Nodes::stepped(0.0, 1e12, 1.0), Err(GridError::TooMany(_))));
        assert!(matches!(Nodes::over(Range { low: 0.0, high: 1.0 }, 0), Err(GridError::Empty)));
        assert!(matches!(Nodes::over(Range { low: 1.0, high: 1.0 }, 2), Err(GridError::Order)));
        let many = Nodes::over(Range { low: 0.0, high: 1.0 }, 1000).unwrap();
        assert!(matches!(
            Grid::new([many.clone(), many.clone(), many]),
            Err(GridError::TooMany(1_000_000_000))
        ));
        assert_eq!(Nodes::stepped(0.0, 0.3, 0.1).unwrap().places_mm().len(), 4);
    }
}
