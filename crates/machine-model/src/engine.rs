//! What a correction engine must answer.

use nalgebra::Matrix3;
use toolpath::{Kinematics, TiltedPlane};

use crate::{Command, Everywhere, Move, Turn, Vector, Volume};

/// How many points are evaluated together.
pub const LANES: usize = 4;

/// What to command so that the tool goes to the target.
///
/// ```
/// use machine_model::{Engine, TOLERANCE_MM};
/// # use machine_model::{AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Table, Vector};
/// # fn machine() -> RigidBody {
/// #     let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// #     let long = Table::new(vec![0.0, 100.0], vec![0.0, 0.020], Interpolation::Linear).unwrap();
/// #     linear[0].errors = AxisTables::new(&[Some(long), None, None, None, None, None]);
/// #     let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// #     let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// #     RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
/// # }
/// # fn at(x: f64, y: f64, z: f64) -> Command {
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3], ..Default::default() }
/// # }
/// let told = machine().solve(&at(50.0, 0.0, 0.0)).unwrap();
/// assert!(told.residual_mm <= TOLERANCE_MM && told.iterations < 10);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solution {
    /// Commands of the linear axes, mm.
    pub linear_mm: Vector,
    /// Evaluations of the model.
    pub iterations: u32,
    /// Distance between the target and where the engine's own model goes for this command, mm.
    pub residual_mm: f64,
}

/// Why there is no solution.
///
/// ```
/// use machine_model::{Engine, SolveError};
/// # use machine_model::{AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Table, Vector};
/// # fn machine() -> RigidBody {
/// #     let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// #     let long = Table::new(vec![0.0, 100.0], vec![0.0, 0.020], Interpolation::Linear).unwrap();
/// #     linear[0].errors = AxisTables::new(&[Some(long), None, None, None, None, None]);
/// #     let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// #     let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// #     RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
/// # }
/// # fn at(x: f64, y: f64, z: f64) -> Command {
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3], ..Default::default() }
/// # }
/// let error = machine().solve(&at(130.0, 0.0, 0.0)).unwrap_err();
/// assert!(matches!(error, SolveError::OutsideVolume { axis: 'X', value_mm: 130.0, .. }));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// The target, or the command that would reach it, lies outside the calibrated volume.
    #[error(
        "axis {axis} at {value_mm:.3} mm lies outside the calibrated range {low_mm:.3} to {high_mm:.3} mm"
    )]
    OutsideVolume {
        /// Name of the axis.
        axis: char,
        /// The command that was needed.
        value_mm: f64,
        /// Lower end of the range.
        low_mm: f64,
        /// Upper end of the range.
        high_mm: f64,
    },
    /// A rotary axis is commanded outside its travel or its tables.
    #[error("axis {axis} at {value_deg:.4}° lies outside its range {low_deg:.4}° to {high_deg:.4}°")]
    OutsideRotaryRange {
        /// Name of the axis.
        axis: char,
        /// Its command, degrees.
        value_deg: f64,
        /// Lower end of the range.
        low_deg: f64,
        /// Upper end of the range.
        high_deg: f64,
    },
    /// The iteration does not settle: the model is not one-to-one here.
    #[error("the inverse does not converge: {residual_mm:.3e} mm are left after {iterations} iterations")]
    NotConverged {
        /// Evaluations made.
        iterations: u32,
        /// Distance left, mm.
        residual_mm: f64,
    },
    /// In the box of the volume, but too far from the measured vectors.
    #[error(
        "X {:.3} Y {:.3} Z {:.3} lies in the box of the measured vectors, but beyond their hull",
        place_mm[0], place_mm[1], place_mm[2]
    )]
    OutsideVectors {
        /// Commands of X, Y, Z, mm.
        place_mm: [f64; 3],
    },
    /// Another tool than the one that the model knows the tip of.
    #[error(
        "the tool vector {:.3} {:.3} {:.3} mm is not that of the measured vectors, {:.3} {:.3} {:.3} mm, and a field knows no angles",
        found_mm[0], found_mm[1], found_mm[2], measured_mm[0], measured_mm[1], measured_mm[2]
    )]
    OtherTool {
        /// The tool vector asked for, mm.
        found_mm: [f64; 3],
        /// That of the vectors, mm.
        measured_mm: [f64; 3],
    },
    /// The engine is defined on a narrower domain than the volume (published variants).
    ///
    /// Why, in English and in Russian.
    #[error("{0}")]
    Undefined(&'static str, &'static str),
}

/// [`SolveError::OutsideVolume`] for the first axis that leaves the volume (or is not a number).
pub(crate) fn inside(q: &Vector, volume: &Volume) -> Result<(), SolveError> {
    for (axis, (range, letter)) in volume.0.iter().zip(['X', 'Y', 'Z']).enumerate() {
        if !range.contains(q[axis]) {
            return Err(SolveError::OutsideVolume {
                axis: letter,
                value_mm: q[axis],
                low_mm: range.low,
                high_mm: range.high,
            });
        }
    }
    Ok(())
}

impl SolveError {
    /// True where a place was asked for that lies outside what is calibrated.
    #[must_use]
    pub fn is_outside(&self) -> bool {
        matches!(self, Self::OutsideVolume { .. } | Self::OutsideVectors { .. })
    }
}

/// The engines by the names of the command line.
///
/// ```
/// use machine_model::EngineId;
///
/// assert_eq!(EngineId::from_name("rigid-body"), Some(EngineId::RigidBody));
/// assert_eq!(EngineId::KmtppPublished.name(), "kmtpp-published");
/// assert!(EngineId::KmtppPublished.is_published() && !EngineId::Kmtpp.is_published());
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum EngineId {
    /// `rigid-body`
    RigidBody,
    /// `tracker`
    Tracker,
    /// `tangential-static`
    TangentialStatic,
    /// `tangential-interval`
    TangentialInterval,
    /// `tangential-quasi-differential`
    TangentialQuasiDifferential,
    /// `kmtpp`
    Kmtpp,
    /// `field`
    Field,
    /// `tangential-static-published`
    TangentialStaticPublished,
    /// `tangential-interval-published`
    TangentialIntervalPublished,
    /// `tangential-quasi-differential-published`
    TangentialQuasiDifferentialPublished,
    /// `kmtpp-published`
    KmtppPublished,
}

/// A correction engine: solves single points; engines that can also correct paths say so.
///
/// ```
/// use machine_model::{Engine, EngineId};
/// # use machine_model::{AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Table, Vector};
/// # fn machine() -> RigidBody {
/// #     let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// #     let long = Table::new(vec![0.0, 100.0], vec![0.0, 0.020], Interpolation::Linear).unwrap();
/// #     linear[0].errors = AxisTables::new(&[Some(long), None, None, None, None, None]);
/// #     let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// #     let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// #     RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
/// # }
/// # fn at(x: f64, y: f64, z: f64) -> Command {
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3], ..Default::default() }
/// # }
/// // Those who correct points need not know which engine they have.
/// let machine = machine();
/// let engine: &dyn Engine = &machine;
/// assert_eq!(engine.id(), EngineId::RigidBody);
/// assert!(engine.volume().contains(&engine.solve(&at(50.0, 0.0, 0.0)).unwrap().linear_mm));
/// assert!(engine.path_model().is_some());
/// ```
pub trait Engine: Send + Sync {
    /// Its name.
    fn id(&self) -> EngineId;

    /// Where it knows the machine.
    fn volume(&self) -> Volume;

    /// Whether it says something of this command: its place and its tool.
    ///
    /// # Errors
    /// What it does not know.
    fn knows(&self, command: &Command) -> Result<(), SolveError> {
        inside(&command.linear_mm, &self.volume())
    }

    /// What to command so that the tool tip comes to `target`.
    ///
    /// `target.linear_mm` is the *nominal* command: where a perfect machine with the same tool would be
    /// told to go. All other fields are the state in which the answer is wanted.
    ///
    /// # Errors
    /// [`SolveError`]; an unconverged point is never returned as a solution.
    fn solve(&self, target: &Command) -> Result<Solution, SolveError>;

    /// The engine as a model of whole paths; `None` for variants that exist to reproduce a publication.
    fn path_model(&self) -> Option<&dyn PathModel> {
        None
    }
}

/// A machine's models by what the control makes of X, Y and Z.
///
/// ```
/// use machine_model::Models;
/// use toolpath::Kinematics;
/// # use machine_model::{Chain, Description, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Vector};
/// # let linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// # let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// # let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// # let machine = RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap();
/// let models = Models { axes: &machine, tip: None };
/// assert!(models.of(Kinematics::Axes).is_some() && models.of(Kinematics::Tip).is_none());
/// ```
#[derive(Clone, Copy)]
pub struct Models<'m> {
    /// Of axis commands.
    pub axes: &'m dyn PathModel,
    /// Of tip commands, where the machine has such a control and bounds for it.
    pub tip: Option<&'m dyn PathModel>,
}

impl<'m> Models<'m> {
    /// The model for it.
    #[must_use]
    pub fn of(&self, kinematics: Kinematics) -> Option<&'m dyn PathModel> {
        match kinematics {
            Kinematics::Axes => Some(self.axes),
            Kinematics::Tip => self.tip,
            Kinematics::Plane(plane) => self.tip?.in_plane(&plane),
        }
    }
}

/// A model whose error is known along paths, with bounds that hold everywhere.
///
/// ```
/// use machine_model::PathModel;
/// # use machine_model::{AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Table, Vector};
/// # fn machine() -> RigidBody {
/// #     let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 100.0 }));
/// #     let long = Table::new(vec![0.0, 100.0], vec![0.0, 0.020], Interpolation::Linear).unwrap();
/// #     linear[0].errors = AxisTables::new(&[Some(long), None, None, None, None, None]);
/// #     let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// #     let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// #     RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap()
/// # }
/// # fn at(x: f64, y: f64, z: f64) -> Command {
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3], ..Default::default() }
/// # }
/// let machine = machine();
/// assert!((machine.error_mm(&at(25.0, 0.0, 0.0)).x - 0.005).abs() < 1e-12);
/// // Outside the volume the error is that of its nearest point.
/// assert_eq!(machine.error_mm(&at(130.0, 0.0, 0.0)), machine.error_mm(&at(100.0, 0.0, 0.0)));
/// assert!(!machine.depends_on_direction());
/// ```
pub trait PathModel: Engine {
    /// Real tip minus nominal tip, mm, in the directions of the linear axes: the displacement the
    /// linear axes would have to undo.
    ///
    /// That of the measuring frame, whatever [`Command::datum`] says; [`crate::FromDatum`] counts from the datum.
    ///
    /// The command must lie in [`Engine::volume`]; outside, the value at the volume's nearest point.
    fn error_mm(&self, command: &Command) -> Vector;

    /// Upper bound, mm, of `|e(s) - ((1-s)·e(0) + s·e(1))|` for all s in 0..=1, `e(s)` the error along
    /// the stretch: how far the error can leave its chord between the ends. Infinite where the
    /// model jumps inside the stretch. Where rotary axes turn, `e` is [`PathModel::error_from_mm`].
    fn chord_bound_mm(&self, stretch: &Move) -> f64;

    /// The machine within a model that only adds to it: it answers what the model leaves as it is. What the model changes, it says
    /// itself: errors and bounds, planes, gradients and commands are never asked here.
    fn within(&self) -> Option<&dyn PathModel> {
        None
    }

    /// True where the bounds hold while rotary axes turn.
    fn follows_turns(&self) -> bool {
        self.within().is_some_and(|machine| machine.follows_turns())
    }

    /// Real tip for a command less the tip of an ideal machine whose linear axes stand there too, but its rotary axes
    /// elsewhere, mm, in the directions of that machine's linear axes. [`PathModel::error_mm`] where they stand alike.
    ///
    /// * `programmed_rad` – A, B, C of the ideal machine
    fn error_from_mm(&self, command: &Command, _programmed_rad: &Vector) -> Vector {
        self.error_mm(command)
    }

    /// Where the linear axes of an ideal machine have to stand so that its tip is where `linear_mm` brings it with other
    /// rotary axes, mm.
    ///
    /// * `state` – its rotary axes are those with which the tip shall be there
    /// * `programmed_rad` – A, B, C with which it is there
    fn same_tip_mm(&self, linear_mm: &Vector, state: &Command, programmed_rad: &Vector) -> Vector {
        self.within().map_or(*linear_mm, |machine| machine.same_tip_mm(linear_mm, state, programmed_rad))
    }

    /// A vector of the workpiece's frame in the directions of the linear axes, as an ideal table turns it.
    fn along_axes(&self, workpiece_mm: &Vector, state: &Command) -> Vector {
        self.within().map_or(*workpiece_mm, |machine| machine.along_axes(workpiece_mm, state))
    }

    /// Upper bound of how far the workpiece turns along a stretch, all axes of the table together, rad.
    fn table_turns_rad(&self, turn: &Turn) -> f64 {
        self.within().map_or(0.0, |machine| machine.table_turns_rad(turn))
    }

    /// The tip of an ideal machine as the workpiece sees it, mm, but for a shift that is the same everywhere.
    ///
    /// With the error added to `linear_mm` it is that of the machine as it is.
    fn tip_mm(&self, linear_mm: &Vector, state: &Command) -> Vector {
        self.within().map_or(*linear_mm, |machine| machine.tip_mm(linear_mm, state))
    }

    /// The machine in the coordinates of a tilted working plane, where the control makes axis commands of them.
    fn in_plane(&self, _plane: &TiltedPlane) -> Option<&dyn PathModel> {
        None
    }

    /// Angle between the tool's real and its ideal direction, seen from the workpiece, rad.
    fn tilt_rad(&self, command: &Command) -> f64 {
        self.within().map_or(0.0, |machine| machine.tilt_rad(command))
    }

    /// The tool's direction as the workpiece sees it, unit vectors: that of an ideal machine with the programmed angles, and the
    /// real one for the command. `None` where the model knows of none.
    ///
    /// * `programmed_rad` – A, B, C of the ideal machine
    fn tool_directions(&self, command: &Command, programmed_rad: &Vector) -> Option<[Vector; 2]> {
        self.within()?.tool_directions(command, programmed_rad)
    }

    /// Upper bound, rad, of how far the difference of the two [`PathModel::tool_directions`] leaves the chord of its ends on a
    /// stretch, seen from the directions of the ideal machine's linear axes. Equation (120).
    fn direction_bound_rad(&self, stretch: &Move) -> f64 {
        self.within().map_or(f64::INFINITY, |machine| machine.direction_bound_rad(stretch))
    }

    /// Which of A, B, C the machine has.
    fn rotary_axes(&self) -> [bool; 3] {
        self.within().map_or([false; 3], |machine| machine.rotary_axes())
    }

    /// That rotary axes stand inside their travel, whatever their tables cover: where none of them is to be corrected.
    ///
    /// * `which` – the axes that are asked about, of A, B and C
    ///
    /// # Errors
    /// [`SolveError::OutsideRotaryRange`] for the first that does not.
    fn in_travel(&self, command: &Command, which: [bool; 3]) -> Result<(), SolveError> {
        self.within().map_or(Ok(()), |machine| machine.in_travel(command, which))
    }

    /// True where every rotary axis stands inside its travel and its tables.
    fn may_turn_to(&self, command: &Command) -> bool {
        self.within().is_none_or(|machine| machine.may_turn_to(command))
    }

    /// `∂e_c/∂q_a` of [`PathModel::error_mm`] in row c and column a, mm per mm, where the model is one of places and not of
    /// axes.
    fn jacobian(&self, _command: &Command) -> Option<Matrix3<f64>> {
        None
    }

    /// Bounds that hold in the whole volume for this tool and these rotary axes, whatever `linear_mm` and
    /// `direction` are; `None` where the model has none.
    fn everywhere(&self, _state: &Command) -> Option<Everywhere> {
        None
    }

    /// What to command so that the tool tip comes to `target`: [`Engine::solve`] for those who come by millions.
    ///
    /// The tip comes within [`crate::TOLERANCE_MM`] of the target; that is proven by `everywhere`, not evaluated
    /// once more. The answer depends on the target alone.
    ///
    /// # Errors
    /// Those of [`Engine::solve`].
    fn command_for(&self, target: &Command, _everywhere: &Everywhere) -> Result<Vector, SolveError> {
        self.solve(target).map(|solution| solution.linear_mm)
    }

    /// [`PathModel::command_for`] for several targets that differ in place and direction only: X, Y and Z of each; `None`
    /// where they have to be asked for one by one.
    fn commands_for(
        &self,
        _targets_mm: &[[f64; 3]; LANES],
        _directions: &[[i8; 3]; LANES],
        _state: &Command,
        _everywhere: &Everywhere,
    ) -> Option<[[f64; LANES]; 3]> {
        None
    }

    /// True where the error depends on the direction of motion.
    fn depends_on_direction(&self) -> bool {
        self.within().is_some_and(|machine| machine.depends_on_direction())
    }

    /// Reversal value of an axis (0..=2: X, Y, Z) at a command, mm, along that axis: its error coming from above less its error
    /// coming from below, ISO 230-2. The width of its play: [`crate::Play`].
    ///
    /// The command's direction is not used. Zero for an axis that is the same from both sides; a negative one is no play.
    fn reversal_mm(&self, axis: usize, command: &Command) -> f64 {
        self.within().map_or(0.0, |machine| machine.reversal_mm(axis, command))
    }

    /// True where the error depends on the side from which rotary axes came.
    fn has_rotary_play(&self) -> bool {
        self.within().is_some_and(|machine| machine.has_rotary_play())
    }

    /// Reversal value of a rotary axis (0..=2: A, B, C) at a command, rad about its line, as [`PathModel::reversal_mm`].
    fn rotary_reversal_rad(&self, axis: usize, command: &Command) -> f64 {
        self.within().map_or(0.0, |machine| machine.rotary_reversal_rad(axis, command))
    }
}
