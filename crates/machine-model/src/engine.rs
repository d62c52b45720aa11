//! What a correction engine must answer.

use nalgebra::Vector3;
use toolpath::{Kinematics, TiltedPlane};

use crate::{Everywhere, LANES};

/// A vector in the machine frame, mm.
pub type Vector = Vector3<f64>;

/// What the axes are told, with everything the error depends on.
///
/// ```
/// use machine_model::{Command, Vector};
///
/// // X100 Y50 Z20 with a tool of 80 mm, X last moved in its negative direction.
/// let command = Command {
///     linear_mm: Vector::new(100.0, 50.0, 20.0),
///     rotary_rad: Vector::zeros(),
///     tool_mm: Vector::new(0.0, 0.0, -80.0),
///     direction: [-1, 0, 0],
/// };
/// // A perfect machine without rotary axes has its tip here.
/// assert_eq!(command.linear_mm + command.tool_mm, Vector::new(100.0, 50.0, -60.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// X, Y, Z, machine coordinates, mm.
    pub linear_mm: Vector,
    /// A, B, C, rad.
    pub rotary_rad: Vector,
    /// From the gauge point to the tool tip, mm.
    pub tool_mm: Vector,
    /// Direction in which each linear axis last moved: -1, +1, or 0 where unknown (mean of both).
    pub direction: [i8; 3],
}

/// Closed interval of an axis command, mm.
///
/// ```
/// use machine_model::Range;
///
/// let travel = Range { low: 0.0, high: 500.0 };
/// assert!(travel.contains(500.0) && !travel.contains(500.001) && !travel.contains(f64::NAN));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Range {
    /// True where `v` lies inside or on an end. False for NaN.
    #[must_use]
    #[inline]
    pub fn contains(&self, v: f64) -> bool {
        self.low <= v && v <= self.high
    }
}

/// Where the model knows the machine: the box of axis commands that every table covers.
///
/// ```
/// use machine_model::{Range, Vector, Volume};
///
/// let volume = Volume([Range { low: 0.0, high: 100.0 }; 3]);
/// let outside = Vector::new(120.0, 50.0, -1.0);
/// assert!(!volume.contains(&outside));
/// assert_eq!(volume.nearest(&outside), Vector::new(100.0, 50.0, 0.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Volume(pub [Range; 3]);

impl Volume {
    /// True where all axes lie inside.
    #[must_use]
    #[inline]
    pub fn contains(&self, linear_mm: &Vector) -> bool {
        (0..3).all(|i| self.0[i].contains(linear_mm[i]))
    }
    /// The nearest point of the volume.
    #[must_use]
    pub fn nearest(&self, linear_mm: &Vector) -> Vector {
        Vector::from_fn(|i, _| linear_mm[i].clamp(self.0[i].low, self.0[i].high))
    }
}

/// A stretch of a path `q(s)`, 0 ≤ s ≤ 1, of axis commands, as far as bounds need it.
///
/// ```
/// use machine_model::{Move, PathModel};
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
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3] }
/// # }
/// // A line from X10 to X40. Here the error grows evenly, so that it does not leave its chord at all.
/// let stretch = Move {
///     range_mm: [Range { low: 10.0, high: 40.0 }, Range { low: 5.0, high: 5.0 }, Range { low: 0.0, high: 0.0 }],
///     speed_mm: [30.0, 0.0, 0.0],
///     acceleration_mm: [0.0; 3],
///     passes: 1,
///     state: at(0.0, 0.0, 0.0),
///     turn: None,
/// };
/// assert!(machine().chord_bound_mm(&stretch) < 1e-9);
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Box that contains every `q(s)`, mm. An axis without acceleration runs from one end of its range
    /// to the other: bounds use where in it a table has its nodes.
    pub range_mm: [Range; 3],
    /// Upper bounds of |dq/ds| per axis, mm.
    pub speed_mm: [f64; 3],
    /// Upper bounds of |d²q/ds²| per axis, mm; zero for a line.
    pub acceleration_mm: [f64; 3],
    /// How often at most each axis passes one place: 1 on a line, 2 on an arc below half a turn.
    pub passes: u8,
    /// Tool vector and directions on this stretch; its `linear_mm` is not used, nor its `rotary_rad` where axes turn.
    pub state: Command,
    /// How the rotary axes turn meanwhile; `None` where they stand as `state` says.
    pub turn: Option<Turn>,
}

/// How the rotary axes turn along a stretch: evenly with s, as they are commanded and as they were programmed. The two
/// differ by rounding only.
///
/// ```
/// use machine_model::{Turn, Vector};
///
/// let turn = Turn {
///     programmed_rad: [Vector::new(0.0, 0.0, 0.1), Vector::new(0.0, 0.0, 0.3)],
///     commanded_rad: [Vector::new(0.0, 0.0, 0.1), Vector::new(0.0, 0.0, 0.300_001)],
/// };
/// assert!((turn.slip_rad() - 1e-6).abs() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn {
    /// A, B, C at s = 0 and s = 1 by the program, rad.
    pub programmed_rad: [Vector; 2],
    /// The same as commanded.
    pub commanded_rad: [Vector; 2],
}

impl Turn {
    /// Upper bound of the angle between the tool's directions that an ideal machine makes of both, rad: as far as each axis
    /// is off, all of them together.
    #[must_use]
    pub fn slip_rad(&self) -> f64 {
        let [from, to] = [0, 1].map(|end| (self.commanded_rad[end] - self.programmed_rad[end]).abs());
        from.sup(&to).sum()
    }
}

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
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3] }
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
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3] }
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
    /// The engine is defined on a narrower domain than the volume (published variants).
    #[error("{0}")]
    Undefined(&'static str),
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
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3] }
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
/// #     Command { linear_mm: Vector::new(x, y, z), rotary_rad: Vector::zeros(), tool_mm: Vector::zeros(), direction: [0; 3] }
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
    /// The command must lie in [`Engine::volume`]; outside, the value at the volume's nearest point.
    fn error_mm(&self, command: &Command) -> Vector;

    /// Upper bound, mm, of `|e(s) - ((1-s)·e(0) + s·e(1))|` for all s in 0..=1, `e(s)` the error along
    /// the stretch: how far the error can leave its chord between the ends. Infinite where the
    /// model jumps inside the stretch. Where rotary axes turn, `e` is [`PathModel::error_from_mm`].
    fn chord_bound_mm(&self, stretch: &Move) -> f64;

    /// True where the bounds hold while rotary axes turn.
    fn follows_turns(&self) -> bool {
        false
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
    fn same_tip_mm(&self, linear_mm: &Vector, _state: &Command, _programmed_rad: &Vector) -> Vector {
        *linear_mm
    }

    /// The tip of an ideal machine as the workpiece sees it, mm, but for a shift that is the same everywhere.
    ///
    /// With the error added to `linear_mm` it is that of the machine as it is.
    fn tip_mm(&self, linear_mm: &Vector, _state: &Command) -> Vector {
        *linear_mm
    }

    /// The machine in the coordinates of a tilted working plane, where the control makes axis commands of them.
    fn in_plane(&self, _plane: &TiltedPlane) -> Option<&dyn PathModel> {
        None
    }

    /// Angle between the tool's real and its ideal direction, seen from the workpiece, rad.
    fn tilt_rad(&self, _command: &Command) -> f64 {
        0.0
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
        false
    }

    /// Reversal value of an axis (0..=2: X, Y, Z) at a command, mm, along that axis: its error coming from above less its error
    /// coming from below, ISO 230-2. The width of its play: [`crate::Play`].
    ///
    /// The command's direction is not used. Zero for an axis that is the same from both sides; a negative one is no play.
    fn reversal_mm(&self, _axis: usize, _command: &Command) -> f64 {
        0.0
    }
}
