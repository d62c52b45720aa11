//! Errors counted from where the program's zero was touched. Equation (121).

use crate::{
    Command, Engine, EngineId, Everywhere, LANES, Matrix, Move, PathModel, Placement, Solution, SolveError,
    Vector, Volume,
};

/// A machine whose errors count from the datum of a program ([`Command::datum`]).
///
/// An operator who touches a zero on a crooked machine writes down the command at which the tool stood on it. The
/// machine's error there is in that number: the corrected tool goes where a machine would take it that is right at the
/// datum and straight from there on. So the error that has to be undone is `e(q) - Rᵀ(θ) e_d`, `e_d` fixed in the
/// workpiece and turning with its table; where the workpiece was dialled parallel to an axis' real way, and so lies turned,
/// the target turns with it.
///
/// ```
/// use machine_model::{Command, FromDatum, PathModel, Placement, Vector};
/// # use machine_model::{AxisTables, Chain, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Table};
/// # let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// # let long = Table::new(vec![0.0, 100.0], vec![0.0, 0.020], Interpolation::Linear).unwrap();
/// # linear[0].errors = AxisTables::new(&[Some(long), None, None, None, None, None]);
/// # let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// # let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// # let machine = RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap();
/// // X is too long by 0.02 %. Touched at X50, where it stands 10 µm farther, X50 is right and X100 10 µm off.
/// let at = |x: f64| Command { linear_mm: Vector::new(x, 0.0, 0.0), ..Command::default() };
/// let datum = Placement::default().shifted(machine.error_mm(&at(50.0)));
/// let machine = FromDatum::new(Box::new(machine)).ok().expect("a model of paths");
/// assert_eq!(machine.error_mm(&Command { datum, ..at(50.0) }), Vector::zeros());
/// assert!((machine.error_mm(&Command { datum, ..at(100.0) }).x - 0.010).abs() < 1e-12);
/// ```
pub struct FromDatum(Box<dyn Engine>);

/// How far what belongs at the place of a command lies from it, mm, in the directions of the linear axes; none where the
/// datum is the measuring frame, so that no bit changes.
fn datum(machine: &dyn PathModel, state: &Command) -> Option<Vector> {
    let Placement { shift_mm, turn } = state.datum;
    if state.datum.is_turned() {
        return Some(shift_mm + turn * (state.linear_mm + state.tool_mm));
    }
    (shift_mm != Vector::zeros()).then(|| machine.along_axes(&shift_mm, state))
}

/// An error of a machine at a command as it counts from [`Command::datum`], mm, by that of the measuring frame.
#[must_use]
pub fn counted_from_datum(machine: &dyn PathModel, error_mm: Vector, state: &Command) -> Vector {
    if state.datum.is_turned() {
        let asked = state.linear_mm + state.tool_mm;
        return state.datum.meant(&(asked + error_mm)) - asked;
    }
    datum(machine, state).map_or(error_mm, |datum_mm| error_mm - datum_mm)
}

impl FromDatum {
    /// The engine back, where it is no model of paths.
    ///
    /// # Errors
    /// The engine.
    pub fn new(engine: Box<dyn Engine>) -> Result<Self, Box<dyn Engine>> {
        if engine.path_model().is_some() { Ok(Self(engine)) } else { Err(engine) }
    }

    fn machine(&self) -> &dyn PathModel {
        self.0.path_model().expect("it was one when this was made")
    }

    fn datum(&self, state: &Command) -> Option<Vector> {
        datum(self.machine(), state)
    }

    /// The target as the machine without a datum has to be asked for it.
    fn target(&self, target: &Command) -> Command {
        match self.datum(target) {
            Some(datum_mm) => Command { linear_mm: target.linear_mm + datum_mm, ..*target },
            None => *target,
        }
    }
}

impl Engine for FromDatum {
    fn id(&self) -> EngineId {
        self.0.id()
    }

    fn volume(&self) -> Volume {
        self.0.volume()
    }

    fn knows(&self, command: &Command) -> Result<(), SolveError> {
        self.0.knows(command)
    }

    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        self.0.solve(&self.target(target))
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for FromDatum {
    fn within(&self) -> Option<&dyn PathModel> {
        Some(self.machine())
    }

    fn error_mm(&self, command: &Command) -> Vector {
        counted_from_datum(self.machine(), self.machine().error_mm(command), command)
    }

    /// A vector that turns by α in all, evenly, leaves its chord by an eighth of `|v| α²` at most, and what a turned workpiece
    /// adds to the path by an eighth of `|R - 1| |q''|`.
    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        let Placement { shift_mm, turn } = stretch.state.datum;
        let turned = stretch.turn.map_or(0.0, |turn| self.machine().table_turns_rad(&turn));
        let bent_mm = turn.norm() * Vector::from(stretch.acceleration_mm).norm();
        self.machine().chord_bound_mm(stretch) + (shift_mm.norm() * turned * turned + bent_mm) / 8.0
    }

    fn error_from_mm(&self, command: &Command, programmed_rad: &Vector) -> Vector {
        let error = self.machine().error_from_mm(command, programmed_rad);
        counted_from_datum(self.machine(), error, &Command { rotary_rad: *programmed_rad, ..*command })
    }

    fn jacobian(&self, command: &Command) -> Option<Matrix> {
        self.machine().jacobian(command)
    }

    /// None for a turned workpiece, whose targets are asked for one by one.
    fn everywhere(&self, state: &Command) -> Option<Everywhere> {
        if state.datum.is_turned() { None } else { self.machine().everywhere(state) }
    }

    fn command_for(&self, target: &Command, everywhere: &Everywhere) -> Result<Vector, SolveError> {
        self.machine().command_for(&self.target(target), everywhere)
    }

    fn commands_for(
        &self,
        targets_mm: &[[f64; 3]; LANES],
        directions: &[[i8; 3]; LANES],
        state: &Command,
        everywhere: &Everywhere,
    ) -> Option<[[f64; LANES]; 3]> {
        let Some(datum) = self.datum(state) else {
            return self.machine().commands_for(targets_mm, directions, state, everywhere);
        };
        let targets = targets_mm.map(|target| [0, 1, 2].map(|axis| target[axis] + datum[axis]));
        self.machine().commands_for(&targets, directions, state, everywhere)
    }
}
