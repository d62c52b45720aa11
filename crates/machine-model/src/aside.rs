//! A machine whose rotary axes stand a little aside of where the program says.

use crate::{Command, Engine, EngineId, Move, PathModel, Solution, SolveError, Turn, Vector, Volume};

/// A machine of which the rotary axes stand so far from the programmed angles: those of a command are the programmed ones
/// here, and errors are those of the tip against an ideal machine that stands there.
///
/// Correcting the tool's direction puts rotary axes aside; what the linear axes then have to do is asked of this.
///
/// ```
/// use machine_model::{Aside, Command, PathModel, Vector};
/// # use machine_model::{Chain, Description, LinearAxis, Range, RigidBody, RotaryAxis, Squareness};
/// # let linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: -500.0, high: 500.0 }));
/// # let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// # let chain = Chain::parse("[w b X Y Z C t]").unwrap();
/// # let machine = RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap();
/// // A head that turns the tool by 100 µrad too much about Z moves a tip that is 100 mm aside of it by 10 µm.
/// let aside = Aside::new(&machine, Vector::new(0.0, 0.0, 1e-4));
/// let command = Command {
///     linear_mm: Vector::zeros(),
///     rotary_rad: Vector::zeros(),
///     tool_mm: Vector::new(100.0, 0.0, 0.0),
///     direction: [0; 3],
///     ..Default::default()
/// };
/// assert!((aside.error_mm(&command) - Vector::new(0.0, 0.010, 0.0)).norm() < 1e-6);
/// ```
#[derive(Clone, Copy)]
pub struct Aside<'m> {
    model: &'m dyn PathModel,
    /// Commanded less programmed angles, rad.
    by_rad: Vector,
}

impl<'m> Aside<'m> {
    /// * `by_rad` – commanded less programmed A, B, C, rad
    #[must_use]
    pub fn new(model: &'m dyn PathModel, by_rad: Vector) -> Self {
        Self { model, by_rad }
    }

    fn commanded(&self, programmed: &Command) -> Command {
        Command { rotary_rad: programmed.rotary_rad + self.by_rad, ..*programmed }
    }

    fn stretch(&self, stretch: &Move) -> Move {
        let programmed_rad = stretch.turn.map_or([stretch.state.rotary_rad; 2], |turn| turn.programmed_rad);
        let commanded_rad = stretch.turn.map_or(programmed_rad, |turn| turn.commanded_rad);
        let lag_rad = stretch.turn.map_or([Vector::zeros(); 2], |turn| turn.lag_rad);
        let turn =
            Turn { programmed_rad, commanded_rad: commanded_rad.map(|angles| angles + self.by_rad), lag_rad };
        Move { state: self.commanded(&stretch.state), turn: Some(turn), ..*stretch }
    }
}

impl Engine for Aside<'_> {
    fn id(&self) -> EngineId {
        self.model.id()
    }

    fn volume(&self) -> Volume {
        self.model.volume()
    }

    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        let commanded = self.commanded(target);
        let linear_mm = self.model.same_tip_mm(&target.linear_mm, &commanded, &target.rotary_rad);
        self.model.solve(&Command { linear_mm, ..commanded })
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for Aside<'_> {
    fn error_mm(&self, command: &Command) -> Vector {
        self.model.error_from_mm(&self.commanded(command), &command.rotary_rad)
    }

    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        self.model.chord_bound_mm(&self.stretch(stretch))
    }

    fn follows_turns(&self) -> bool {
        self.model.follows_turns()
    }

    fn error_from_mm(&self, command: &Command, programmed_rad: &Vector) -> Vector {
        self.model.error_from_mm(&self.commanded(command), programmed_rad)
    }

    fn same_tip_mm(&self, linear_mm: &Vector, state: &Command, programmed_rad: &Vector) -> Vector {
        self.model.same_tip_mm(linear_mm, state, programmed_rad)
    }

    fn tip_mm(&self, linear_mm: &Vector, state: &Command) -> Vector {
        self.model.tip_mm(linear_mm, state)
    }

    fn tilt_rad(&self, command: &Command) -> f64 {
        self.tool_directions(command, &command.rotary_rad)
            .map_or(0.0, |[ideal, real]| angle_rad(&ideal, &real))
    }

    fn tool_directions(&self, command: &Command, programmed_rad: &Vector) -> Option<[Vector; 2]> {
        self.model.tool_directions(&self.commanded(command), programmed_rad)
    }

    fn direction_bound_rad(&self, stretch: &Move) -> f64 {
        self.model.direction_bound_rad(&self.stretch(stretch))
    }

    fn rotary_axes(&self) -> [bool; 3] {
        self.model.rotary_axes()
    }

    fn in_travel(&self, command: &Command, which: [bool; 3]) -> Result<(), SolveError> {
        self.model.in_travel(&self.commanded(command), which)
    }

    fn may_turn_to(&self, command: &Command) -> bool {
        self.model.may_turn_to(&self.commanded(command))
    }

    fn depends_on_direction(&self) -> bool {
        self.model.depends_on_direction()
    }

    fn has_rotary_play(&self) -> bool {
        self.model.has_rotary_play()
    }
}

/// The angle between two unit vectors, rad: as good for small angles as for large ones.
pub(crate) fn angle_rad(one: &Vector, other: &Vector) -> f64 {
    2.0 * units::math::asin((0.5 * (one - other).norm()).min(1.0))
}
