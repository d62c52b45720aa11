//! Readings at points, the machine that they are told of, and how an instrument stood.

use diagnostic::Speaks;

use machine_model::{
    Chain, Command, Description, Interpolation, LinearAxis, Range as Travel, RigidBody, RotaryAxis, Six,
    Squareness, Vector,
};

use crate::error::CalibrationError;
use crate::rigid_motion::RigidMotion;

/// What was read at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointReading {
    /// Measured minus commanded tool position per component, mm; `None` where not measured.
    Deviation([Option<f64>; 3]),
    /// Measured position per component, instrument frame, mm; `None` where not measured.
    Position([Option<f64>; 3]),
    /// Distance from a station, mm, and where the station is thought to be, mm.
    Distance {
        /// Reading.
        length_mm: f64,
        /// Station, machine coordinates.
        station_mm: Vector,
    },
}

/// One measured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Run: points of one run share the instrument's set-up.
    pub run: usize,
    /// What the axes were told, the tool that was measured, and the sides they came from.
    pub command: Command,
    /// What effects of the base beyond its tables do here, mm, workpiece frame.
    pub by_effects_mm: Vector,
    /// What was read.
    pub reading: PointReading,
    /// Standard uncertainty of the reading, mm, where known.
    pub uncertainty_mm: Option<f64>,
}

impl Point {
    /// A point of a machine with linear axes and no effects, approached from nowhere in particular.
    #[must_use]
    pub fn new(run: usize, commanded_mm: Vector, tool_mm: Vector, reading: PointReading) -> Self {
        let command = Command { linear_mm: commanded_mm, tool_mm, ..Default::default() };
        Self { run, command, by_effects_mm: Vector::zeros(), reading, uncertainty_mm: None }
    }
}

/// The machine as it was known before.
#[derive(Clone, Debug)]
pub struct Base {
    /// Its geometry.
    pub description: Description,
    /// What lies between the nodes of its tables.
    pub interpolation: Interpolation,
    /// False where nothing but the chain is known.
    pub is_known: bool,
}

impl Base {
    /// A machine of which nothing but the chain is known.
    #[must_use]
    pub fn bare(chain: Chain) -> Self {
        let everywhere = Travel { low: f64::NEG_INFINITY, high: f64::INFINITY };
        let linear = [0; 3].map(|_| LinearAxis::perfect(everywhere));
        let rotary = [0; 3].map(|_| RotaryAxis::perfect(Vector::zeros()));
        let description = Description { chain, linear, rotary, squareness: Squareness::default() };
        Self { description, interpolation: Interpolation::Linear, is_known: false }
    }

    pub(crate) fn machine(&self) -> Result<RigidBody, CalibrationError> {
        RigidBody::new(self.description.clone()).map_err(|error| CalibrationError::Axes(error.text()))
    }

    /// Place in the chain, 0 next to the workpiece.
    pub(crate) fn place(&self, axis: usize) -> usize {
        self.description.chain.linear().iter().position(|a| a.direction() == axis).unwrap_or(0)
    }
}

/// How the instrument stood in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetUp {
    /// Measured = turn · machine + shift.
    Frame(RigidMotion),
    /// A station's place in the machine frame and the zero of its length, mm.
    Station {
        /// Place.
        place_mm: Vector,
        /// Reading at distance zero.
        zero_mm: f64,
    },
}

/// An axis as changed, ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangedAxis {
    /// Nodes, mm.
    pub positions_mm: Vec<f64>,
    /// `EX EY EZ` in mm, `EA EB EC` in rad: as in [`LinearAxis::errors`].
    pub errors: Vec<Six>,
    /// As in [`LinearAxis::errors_negative`].
    pub negative: Option<Vec<Six>>,
    /// Which of the six the base has or the readings gave.
    pub given: [bool; 6],
}

/// One reading as a row of the adjustment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RowOrigin {
    /// Index of the point.
    pub point: usize,
    /// 0 X, 1 Y, 2 Z; `None` for a distance.
    pub component: Option<usize>,
}

/// Readings of the points, row by row.
pub(crate) fn rows(points: &[Point]) -> Vec<RowOrigin> {
    let mut rows = Vec::new();
    for (point, p) in points.iter().enumerate() {
        match p.reading {
            PointReading::Distance { .. } => rows.push(RowOrigin { point, component: None }),
            PointReading::Deviation(d) | PointReading::Position(d) => {
                let given = (0..3).filter(|i| d[*i].is_some());
                rows.extend(given.map(|i| RowOrigin { point, component: Some(i) }));
            }
        }
    }
    rows
}

pub(crate) fn value(point: &Point, component: Option<usize>) -> f64 {
    match (point.reading, component) {
        (PointReading::Deviation(d) | PointReading::Position(d), Some(i)) => d[i].unwrap_or(0.0),
        (PointReading::Distance { length_mm, .. }, _) => length_mm,
        _ => 0.0,
    }
}

/// Where the instrument saw the tool, mm; `None` where a component is missing.
pub(crate) fn seen_mm(point: &Point, nominal: &Vector) -> Option<Vector> {
    match point.reading {
        PointReading::Deviation([Some(x), Some(y), Some(z)]) => Some(nominal + Vector::new(x, y, z)),
        PointReading::Position([Some(x), Some(y), Some(z)]) => Some(Vector::new(x, y, z)),
        _ => None,
    }
}
