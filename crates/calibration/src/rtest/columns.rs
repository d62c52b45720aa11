//! Derivatives of what is read by what is unknown: equation (101).

use diagnostic::Speaks;
use machine_model::{Axis, AxisTables, Command, Component, Description, Range, RigidBody, Vector};
use nalgebra::DMatrix;

use super::terms::Term;
use crate::error::CalibrationError;

/// Half the widths of the central differences: mm and rad. Large against rounding; the model is all but linear in errors.
const STEPS: [f64; 2] = [1e-2, 1e-5];

/// Derivatives of the tip, workpiece frame, by what an axis does at the place of one command: the six functions there, the three
/// tilts of the axis.
type Slopes = [Vector; 9];

/// Derivatives at a list of commands.
pub(crate) struct Columns {
    /// Axis, and a set a command.
    of_axis: Vec<(Axis, Vec<Slopes>)>,
    angles_rad: Vec<Vector>,
    directions: Vec<Vector>,
}

pub(crate) fn model(description: Description) -> Result<RigidBody, CalibrationError> {
    RigidBody::new(description).map_err(|error| CalibrationError::Axes(error.text()))
}

impl Columns {
    pub(crate) fn new(
        base: &Description,
        axes: &[Axis],
        commands: &[Command],
    ) -> Result<Self, CalibrationError> {
        let everywhere = Range {
            low: commands.iter().map(|c| c.rotary_rad.min()).fold(0.0, f64::min) - 1.0,
            high: commands.iter().map(|c| c.rotary_rad.max()).fold(0.0, f64::max) + 1.0,
        };
        let mut of_axis = Vec::new();
        for axis in axes {
            let mut slopes = vec![[Vector::zeros(); 9]; commands.len()];
            for component in 0..9 {
                let step = STEPS[usize::from(component >= 3)];
                let at = |by: f64| -> Result<Vec<Vector>, CalibrationError> {
                    let mut description = base.clone();
                    let rotary = &mut description.rotary[axis.direction()];
                    if component < 6 {
                        let before = rotary.errors.take();
                        let before = before.unwrap_or_else(|| AxisTables::constant(everywhere, [0.0; 6]));
                        rotary.errors = Some(before.shifted(component, by));
                    } else {
                        rotary.tilt_rad[component - 6] += by;
                    }
                    let machine = model(description)?;
                    Ok(commands.iter().map(|command| machine.predict(command).error_mm).collect())
                };
                let (up, down) = (at(step)?, at(-step)?);
                for (own, (up, down)) in slopes.iter_mut().zip(up.iter().zip(&down)) {
                    own[component] = (up - down) / (2.0 * step);
                }
            }
            of_axis.push((*axis, slopes));
        }
        let along = |axis: usize| base.rotary[axis].direction.unwrap_or_else(|| Vector::ith(axis, 1.0));
        Ok(Self {
            of_axis,
            angles_rad: commands.iter().map(|command| command.rotary_rad).collect(),
            directions: vec![along(0), along(1), along(2)],
        })
    }

    fn slopes(&self, axis: Axis, command: usize) -> &Slopes {
        let found = self.of_axis.iter().find(|(own, _)| *own == axis);
        &found.expect("terms are of axes that turn").1[command]
    }

    /// Derivative of the tip at a command by a term, mm per mm or rad; `turning` is the direction from which the axis came.
    pub(crate) fn slope(&self, term: &Term, command: usize, turning: i8) -> Vector {
        let own = self.slopes(term.axis(), command);
        match term {
            Term::Location(location) => match location.component {
                Component::Linear => own[location.direction],
                Component::Angular => own[6 + location.direction],
            },
            Term::Coefficient { axis, function, basis, group, which } => {
                own[*function] * basis.values(*group, self.angles_rad[command][axis.direction()])[*which]
            }
            Term::Reversal(axis) => self.about_itself(*axis, command) * (-0.5 * f64::from(turning)),
        }
    }

    /// Derivative by a turn about the axis itself: as long as the tip is far from it.
    pub(crate) fn about_itself(&self, axis: Axis, command: usize) -> Vector {
        let own = self.slopes(axis, command);
        let along = self.directions[axis.direction()];
        own[3] * along.x + own[4] * along.y + own[5] * along.z
    }

    /// Three rows a command, a column a term.
    pub(crate) fn matrix(&self, terms: &[Term]) -> DMatrix<f64> {
        let commands = self.angles_rad.len();
        let mut matrix = DMatrix::zeros(3 * commands, terms.len());
        for (column, term) in terms.iter().enumerate() {
            for command in 0..commands {
                matrix.fixed_view_mut::<3, 1>(3 * command, column).copy_from(&self.slope(term, command, 0));
            }
        }
        matrix
    }
}
