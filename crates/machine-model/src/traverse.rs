//! One axis driven alone through its travel, followed in space by a tracker.

/// A measured traverse of one linear axis.
///
/// ```
/// use machine_model::Traverse;
///
/// // X driven to 200 mm and followed by a tracker: too long, and rising.
/// let traverse = Traverse {
///     axis: 0,
///     nodes_mm: vec![0.0, 100.0, 200.0],
///     start_mm: [0.0, 50.0, 20.0],
///     measured_mm: vec![[0.0, 50.0, 20.0], [100.004, 50.0, 20.001], [200.010, 50.0, 20.003]],
///     published_cosines: None,
/// };
/// let last = traverse.measured_mm.last().unwrap();
/// let expected = traverse.start_mm[0] + traverse.nodes_mm[2] - traverse.nodes_mm[0];
/// assert!((last[0] - expected - 0.010).abs() < 1e-9);
/// ```
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
