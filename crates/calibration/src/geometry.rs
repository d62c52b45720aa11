//! What of an adjustment does not depend on its parameters.

use diagnostic::Speaks;

use machine_model::rotation::turned_by;
use machine_model::{
    AxisTables, Command, Description, LinearAxis, Range as Travel, RigidBody, RotaryAxis, Squareness, Vector,
};
use nalgebra::{DMatrix, DVector};

use crate::adjustment::Estimate;
use crate::error::CalibrationError;
use crate::field;
use crate::layout::{Group, Layout, hats};
use crate::points::{Base, Point, PointReading, RowOrigin, SetUp};

/// Everything of the adjustment that does not depend on the parameters.
pub(crate) struct Geometry {
    /// Of each point: displacement by a unit of each of the eighteen functions at the ideal machine.
    pub(crate) by_function: Vec<[[Vector; 6]; 3]>,
    /// Of each point: its ideal position.
    pub(crate) ideal_mm: Vec<Vector>,
}

/// The machine without errors, its measured lines kept: levers count from them.
pub(crate) fn ideal(base: &Base) -> Description {
    let everywhere = Travel { low: -1e7, high: 1e7 };
    let mut ideal = base.description.clone();
    ideal.squareness = Squareness::default();
    for axis in &mut ideal.linear {
        let perfect = LinearAxis::perfect(everywhere);
        *axis = LinearAxis {
            measured_at_mm: axis.measured_at_mm,
            measured_tool_mm: axis.measured_tool_mm,
            ..perfect
        };
    }
    for axis in &mut ideal.rotary {
        *axis = RotaryAxis::perfect(axis.centre_mm);
    }
    ideal
}

impl Geometry {
    pub(crate) fn new(base: &Base, commands: &[Command]) -> Result<Self, CalibrationError> {
        /// Errors are linear in a translation; of an angle the third order is left, 2e-9 of the first.
        const STEPS: [f64; 2] = [1.0, 1e-4];
        let ideal = ideal(base);
        let build = |description: Description| {
            RigidBody::new(description).map_err(|error| CalibrationError::Axes(error.text()))
        };
        let machine = build(ideal.clone())?;
        let ideal_mm: Vec<Vector> = commands.iter().map(|c| machine.predict(c).position_mm).collect();
        let mut by_function = vec![[[Vector::zeros(); 6]; 3]; commands.len()];
        for axis in 0..3 {
            for f in 0..6 {
                let step = STEPS[f / 3];
                let with = |by: f64| {
                    let mut description = ideal.clone();
                    let mut six = [0.0; 6];
                    six[f] = by;
                    let range = description.linear[axis].travel_mm;
                    description.linear[axis].errors = Some(AxisTables::constant(range, six));
                    build(description)
                };
                let (up, down) = (with(step)?, with(-step)?);
                for (own, command) in by_function.iter_mut().zip(commands) {
                    own[axis][f] =
                        (up.predict(command).error_mm - down.predict(command).error_mm) / (2.0 * step);
                }
            }
        }
        Ok(Self { by_function, ideal_mm })
    }
}

impl Layout {
    /// Displacements of the tool at a command by a unit of each machine parameter, ideal geometry.
    pub(crate) fn displacements(
        &self,
        command: &Command,
        by_function: &[[Vector; 6]; 3],
    ) -> Vec<(usize, Vector)> {
        let mut out = Vec::new();
        for (group, range) in &self.groups {
            match *group {
                Group::Function(axis, f) => {
                    for (node, weight) in hats(&self.plan.nodes_mm[axis], command.linear_mm[axis]) {
                        out.push((range.start + node, by_function[axis][f] * weight));
                    }
                }
                Group::Play(axis) => {
                    let side = f64::from(command.direction[axis].signum());
                    out.push((range.start, by_function[axis][axis] * (-0.5 * side)));
                }
                Group::Run(_) => {}
            }
        }
        out
    }

    /// Half width that 95 % of the volume's points keep, mm: equation (51c).
    ///
    /// * `commands` – by group of points that share a frame
    pub(crate) fn field_u95_mm(
        &self,
        base: &Base,
        estimate: &Estimate,
        groups: &[Vec<Command>],
    ) -> Result<f64, CalibrationError> {
        let mut spreads = Vec::new();
        for commands in groups {
            let geometry = Geometry::new(base, commands)?;
            let mut rows = DMatrix::zeros(3 * commands.len(), self.count);
            for (k, command) in commands.iter().enumerate() {
                for (parameter, moved) in self.displacements(command, &geometry.by_function[k]) {
                    for i in 0..3 {
                        rows[(3 * k + i, parameter)] = moved[i];
                    }
                }
            }
            spreads.extend(field::spreads(&geometry.ideal_mm, rows, &estimate.covariance));
        }
        Ok(field::quantile_of_points(&spreads) * estimate.coverage_factor_95() / crate::quantile_95(None))
    }
}

/// Where an ideal machine of this kind would be, mm.
pub(crate) fn ideal_places(base: &Base, commands: &[Command]) -> Result<Vec<Vector>, CalibrationError> {
    let machine = RigidBody::new(ideal(base)).map_err(|error| CalibrationError::Axes(error.text()))?;
    Ok(commands.iter().map(|c| machine.predict(c).position_mm).collect())
}

/// What is read of a machine with these set-ups, row by row.
pub(crate) fn predicted(
    machine: &RigidBody,
    points: &[Point],
    rows: &[RowOrigin],
    layout: &Layout,
    setups: &[Option<SetUp>],
    geometry: &Geometry,
    x: &DVector<f64>,
) -> DVector<f64> {
    let centres: Vec<Vector> = (0..setups.len()).map(|run| centre(run, points, geometry)).collect();
    let own = |run: usize, k: usize| {
        layout.at(Group::Run(run)).filter(|range| k < range.len()).map_or(0.0, |range| x[range.start + k])
    };
    let three = |run: usize, from: usize| Vector::from_fn(|i, _| own(run, from + i));
    // A position in the instrument's frame, or a distance in all three components.
    let seen: Vec<Vector> = points
        .iter()
        .map(|p| {
            let at = machine.predict(&p.command).position_mm + p.by_effects_mm;
            match setups[p.run] {
                Some(SetUp::Frame(motion)) => {
                    let turned = at + turned_by(&three(p.run, 3), &(at - centres[p.run]));
                    motion.apply(&turned) + three(p.run, 0)
                }
                Some(SetUp::Station { place_mm, zero_mm }) => {
                    let far = (at - place_mm - three(p.run, 0)).norm() + zero_mm + own(p.run, 3);
                    Vector::from_element(far)
                }
                None => Vector::from_element(f64::NAN),
            }
        })
        .collect();
    DVector::from_fn(rows.len(), |i, _| {
        let RowOrigin { point, component } = rows[i];
        let component = component.unwrap_or(0);
        let zero = match points[point].reading {
            PointReading::Deviation(_) => geometry.ideal_mm[point][component],
            PointReading::Position(_) | PointReading::Distance { .. } => 0.0,
        };
        seen[point][component] - zero
    })
}

/// Mean ideal place of a run: turning about it moves its points least.
pub(crate) fn centre(run: usize, points: &[Point], geometry: &Geometry) -> Vector {
    let own = || points.iter().zip(&geometry.ideal_mm).filter(|(p, _)| p.run == run);
    own().map(|(_, at)| at).sum::<Vector>() / own().count().max(1) as f64
}
