//! One axis driven alone through its travel, followed in space by a tracker.

/// A measured traverse of one linear axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Traverse {
    /// The axis that moved: 0 X, 1 Y, 2 Z.
    pub axis: usize,
    /// Commands of that axis, mm, strictly increasing; the other axes stood still.
    pub nodes_mm: Vec<f64>,
    /// Commands of all axes at the first node, mm: where the others stood.
    pub start_mm: [f64; 3],
    /// Measured position at every node, mm.
    pub measured_mm: Vec<[f64; 3]>,
    /// Direction cosines as a publication printed them: row k belongs to the interval from node k-1 to
    /// node k, row 0 to none. They may lack their signs; only the `-published` engines use them.
    pub published_cosines: Option<Vec<[f64; 3]>>,
}
