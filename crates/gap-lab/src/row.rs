//! One measured point: what was commanded, and under which conditions.

/// What the instrument read and how it looked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Sight {
    /// The listed components of the displacement (X, Y, Z).
    Components([bool; 3]),
    /// The distance to the fixed ball, mm.
    Ball([f64; 3]),
}

/// A row of the measurement.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    /// Which run the row belongs to.
    pub(crate) run: usize,
    /// Commands of X, Y, Z, machine coordinates, mm.
    pub(crate) command: [f64; 3],
    /// Command of C, rad.
    pub(crate) turn: f64,
    /// From the gauge point to the tip, mm.
    pub(crate) tool: [f64; 3],
    /// Direction in which each axis approached the point: -1, 0 (it did not move), 1.
    pub(crate) approach: [f64; 3],
    /// Unit tangent of the approach; its sign agrees with `approach`.
    pub(crate) tangent: [f64; 3],
    /// Path travelled since each axis last reversed, mm.
    pub(crate) since_reversal: [f64; 3],
    /// Path feed, mm/min.
    pub(crate) feed: f64,
    /// Load on the table, kg.
    pub(crate) load: f64,
    /// Time since the measurement began, s.
    pub(crate) time: f64,
    /// Temperature of the machine, °C.
    pub(crate) temperature: f64,
    /// Repeat number, from 1.
    pub(crate) repeat: usize,
    /// How the instrument looked.
    pub(crate) sight: Sight,
}

impl Row {
    /// Commanded tip position in the machine frame: axis command plus tool vector, mm.
    pub(crate) fn tip(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| self.command[i] + self.tool[i])
    }

    /// What the instrument sees of a small displacement of the tip: one number per component seen, or
    /// the change of the ball distance.
    pub(crate) fn seen(&self, displacement: [f64; 3]) -> Vec<f64> {
        match self.sight {
            Sight::Components(mask) => (0..3).filter(|i| mask[*i]).map(|i| displacement[i]).collect(),
            Sight::Ball(centre) => {
                let tip = self.tip();
                let arm = [0, 1, 2].map(|i| tip[i] - centre[i]);
                let length = (arm[0] * arm[0] + arm[1] * arm[1] + arm[2] * arm[2]).sqrt();
                vec![(0..3).map(|i| arm[i] / length * displacement[i]).sum()]
            }
        }
    }
}
