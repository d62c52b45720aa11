//! A change that was found, and the machine with it.

use diagnostic::Text;

use machine_model::{AxisTables, Command, Description, RigidBody, Six, Squareness, Vector};
use nalgebra::DVector;

use crate::adjustment::Estimate;
use crate::error::CalibrationError;
use crate::geometry::{Geometry, ideal_places, predicted};
use crate::layout::{ANGLES, Group, Layout, tables_of};
use crate::points::{Base, ChangedAxis, Point, RowOrigin, SetUp, rows, value};
use crate::rigid_motion::RigidMotion;

/// A change found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) layout: Layout,
    pub(crate) estimate: Estimate,
    /// The machine parameters, set-up apart.
    pub(crate) values: DVector<f64>,
    pub(crate) setups: Vec<Option<SetUp>>,
    /// Functions that keep what the base says as far as the readings cannot tell them, and from what.
    pub(crate) open: Vec<(Text, Text)>,
    pub(crate) rows: Vec<RowOrigin>,
}

impl Found {
    /// Half width of the 95 % interval of a linear function of the parameters.
    pub(crate) fn half_width_95(&self, row: &DVector<f64>) -> f64 {
        self.estimate.coverage_factor_95() * self.estimate.variance_of(row).sqrt()
    }

    /// Change of the squareness k (EC0Y, EB0Z, EA0Z): the row that makes it of the parameters.
    pub(crate) fn angle_row(&self, k: usize) -> Option<DVector<f64>> {
        let (axis, function, sign) = ANGLES[k];
        let range = self.layout.at(Group::Function(axis, function))?;
        let nodes = &self.layout.plan.nodes_mm[axis];
        let mean = nodes.iter().sum::<f64>() / nodes.len() as f64;
        let spread: f64 = nodes.iter().map(|q| (q - mean) * (q - mean)).sum();
        let mut row = DVector::zeros(self.layout.count);
        for (k, q) in nodes.iter().enumerate() {
            row[range.start + k] = sign * (q - mean) / spread;
        }
        Some(row)
    }

    /// EC0Y, EB0Z, EA0Z of the changed machine and the half widths of their 95 % intervals, rad.
    pub(crate) fn squareness(&self, base: &Base) -> [(f64, f64); 3] {
        let known = base.description.squareness;
        [(0, known.ec0y_rad), (1, known.eb0z_rad), (2, known.ea0z_rad)].map(|(k, before)| {
            self.angle_row(k).map_or((before, 0.0), |row| {
                (before + row.dot(&self.estimate.values), self.half_width_95(&row))
            })
        })
    }

    /// The base with the change: every axis, the whole, and how the instrument stood against it. Slopes of EXY, EXZ and EYZ stand
    /// in the squareness.
    pub(crate) fn changed(&self, base: &Base) -> ([ChangedAxis; 3], Description, Vec<Option<SetUp>>) {
        let [c, b, a] = self.squareness(base).map(|(value, _)| value);
        let slopes =
            [0, 1, 2].map(|k| self.angle_row(k).map_or(0.0, |row| ANGLES[k].2 * row.dot(&self.values)));
        let axes = [0, 1, 2].map(|axis| axis_with(base, &self.layout, &self.values, axis, slopes));
        let squareness = Squareness { ec0y_rad: c, eb0z_rad: b, ea0z_rad: a };
        let description = described(base, &self.layout, &self.values, &axes, squareness);
        // A slope about the middle is a squareness about zero and this shift.
        let mut by = Vector::zeros();
        for ((axis, function, _), slope) in ANGLES.iter().zip(slopes) {
            let nodes = &self.layout.plan.nodes_mm[*axis];
            by[*function] += slope * nodes.iter().sum::<f64>() / nodes.len() as f64;
        }
        let shifted = |setup: &SetUp| match *setup {
            SetUp::Frame(motion) => {
                SetUp::Frame(RigidMotion { shift_mm: motion.shift_mm - motion.turn * by, ..motion })
            }
            SetUp::Station { place_mm, zero_mm } => SetUp::Station { place_mm: place_mm + by, zero_mm },
        };
        let setups = self.setups.iter().map(|setup| setup.as_ref().map(shifted)).collect();
        (axes, description, setups)
    }
}

/// One axis of the base with the change of these parameters, slopes of EXY, EXZ, EYZ taken off.
pub(crate) fn axis_with(
    base: &Base,
    layout: &Layout,
    values: &DVector<f64>,
    axis: usize,
    slopes: [f64; 3],
) -> ChangedAxis {
    let linear = &base.description.linear[axis];
    let positions_mm = layout.positions_mm[axis].clone();
    let nodes = &layout.plan.nodes_mm[axis];
    let mean = nodes.iter().sum::<f64>() / nodes.len() as f64;
    let rows = |tables: Option<&AxisTables>, play: f64| -> Vec<Six> {
        let row = |q: &f64| {
            let mut six = tables.map_or([0.0; 6], |t| t.at(*q));
            for (f, value) in six.iter_mut().enumerate() {
                *value += layout.change(values, axis, f, *q);
            }
            six[axis] += play;
            for ((moving, function, _), slope) in ANGLES.iter().zip(slopes) {
                if *moving == axis {
                    six[*function] -= slope * (q - mean);
                }
            }
            six
        };
        positions_mm.iter().map(row).collect()
    };
    // Two tables hold the play themselves.
    let half = if linear.errors_negative.is_some() { 0.5 * layout.play(values, axis) } else { 0.0 };
    let errors = rows(linear.errors.as_ref(), -half);
    let negative = linear.errors_negative.as_ref().map(|tables| rows(Some(tables), half));
    let given = std::array::from_fn(|f| {
        f < 3 || errors.iter().chain(negative.iter().flatten()).any(|row| row[f] != 0.0)
    });
    ChangedAxis { positions_mm, errors, negative, given }
}

/// The base with these axes.
pub(crate) fn described(
    base: &Base,
    layout: &Layout,
    values: &DVector<f64>,
    axes: &[ChangedAxis; 3],
    squareness: Squareness,
) -> Description {
    let mut description = Description { squareness, ..base.description.clone() };
    for (axis, (own, linear)) in axes.iter().zip(&mut description.linear).enumerate() {
        linear.errors = tables_of(&own.positions_mm, &own.errors, base.interpolation);
        let negative = own.negative.as_ref();
        linear.errors_negative =
            negative.and_then(|rows| tables_of(&own.positions_mm, rows, base.interpolation));
        if own.negative.is_none() {
            linear.backlash_mm += layout.play(values, axis);
        }
    }
    description
}

/// The base with the change of these parameters.
pub(crate) fn machine_with(base: &Base, layout: &Layout, values: &DVector<f64>) -> Option<RigidBody> {
    if layout.plan.functions == 0 {
        return base.machine().ok();
    }
    let axes = [0, 1, 2].map(|axis| axis_with(base, layout, values, axis, [0.0; 3]));
    RigidBody::new(described(base, layout, values, &axes, base.description.squareness)).ok()
}

impl Found {
    /// Readings minus predictions of other points of the same runs, mm.
    pub(crate) fn rest(&self, points: &[Point], base: &Base) -> Result<DVector<f64>, CalibrationError> {
        let commands: Vec<Command> = points.iter().map(|p| p.command).collect();
        let geometry = Geometry { ideal_mm: ideal_places(base, &commands)?, by_function: Vec::new() };
        let rows = rows(points);
        let Some(machine) = machine_with(base, &self.layout, &self.values) else {
            return Err(CalibrationError::Axes(Text::pair(
                "the tables and the travel of an axis have nothing in common",
                "у таблиц и хода одной из осей нет общей части",
            )));
        };
        let seen = predicted(&machine, points, &rows, &self.layout, &self.setups, &geometry, &self.values);
        Ok(DVector::from_fn(rows.len(), |i, _| value(&points[rows[i].point], rows[i].component) - seen[i]))
    }
}
