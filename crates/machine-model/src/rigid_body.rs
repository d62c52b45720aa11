//! The reference model: rigid bodies along the chain. Equations (5) to (9) of `docs/equations.md`.

mod engine;

use std::array::from_fn;
use std::cell::RefCell;
use std::cmp::Ordering;
use std::collections::VecDeque;
use std::sync::{Arc, Mutex, OnceLock};

use nalgebra::Matrix3;
use thread_local::ThreadLocal;

use crate::axis_tables::SixBounds;
use crate::everywhere::CLASSES;
use crate::lanes::OfAxis;
use crate::link::{Link, by_direction};
use crate::real::Triple;
use crate::rotary::{Machine, Swivel};
use crate::rotation::{small, turned};
use crate::standing::{Remembered, Standing};
use crate::{Axis, Command, Description, Everywhere, Range, RotaryAxis, SolveError, Vector, Volume};

/// Why a description is no machine.
///
/// ```
/// use machine_model::{Chain, Description, LinearAxis, Range, RigidBody, RotaryAxis, Squareness, Vector};
///
/// let mut linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: 0.0, high: 400.0 }));
/// linear[1].travel_mm = Range { low: 10.0, high: 10.0 };
/// let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// let chain = Chain::parse("[w X Y b Z t]").unwrap();
/// let machine = Description { chain, linear, rotary, squareness: Squareness::default() };
/// assert_eq!(RigidBody::new(machine).unwrap_err().axis, 'Y');
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("axis {axis}: its tables and its travel have no interval in common")]
pub struct Unusable {
    /// The axis.
    pub axis: char,
}

/// Where the tool is, seen from the workpiece.
///
/// ```
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
/// // Told to go to X50, this machine stands 10 µm farther.
/// let there = machine().predict(&at(50.0, 20.0, 10.0));
/// assert!((there.position_mm - Vector::new(50.010, 20.0, 10.0)).norm() < 1e-12);
/// assert!((there.error_mm - Vector::new(0.010, 0.0, 0.0)).norm() < 1e-12);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Real position of the tool tip, mm, workpiece frame.
    pub position_mm: Vector,
    /// Real minus nominal position, mm, workpiece frame.
    pub error_mm: Vector,
}

/// The machine as a chain of rigid bodies.
///
/// ```
/// use machine_model::Engine;
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
/// // X is too long by 0.02 %. What the inverse commands, the forward model leads to the target.
/// let machine = machine();
/// let told = machine.solve(&at(50.0, 20.0, 10.0)).unwrap();
/// assert!((told.linear_mm.x - 50.0 / 1.0002).abs() < 1e-9);
/// let real = machine.predict(&Command { linear_mm: told.linear_mm, ..at(0.0, 0.0, 0.0) });
/// assert!((real.position_mm - Vector::new(50.0, 20.0, 10.0)).norm() < 1e-9);
/// ```
#[derive(Clone, Debug)]
pub struct RigidBody {
    pub(crate) description: Description,
    /// Workpiece to tool.
    pub(crate) links: [Link; 3],
    /// Of A, B, C.
    pub(crate) swivels: [Swivel; 3],
    /// Of X, Y, Z: its place in `links`.
    place_of: [usize; 3],
    pub(crate) volume: Volume,
    /// A rotary axis at the workpiece has errors.
    table_has_errors: bool,
    depends_on_direction: bool,
    has_rotary_play: bool,
    /// Per axis and class of length, for all directions: made when first asked for.
    worst_bounds: OnceLock<WorstBounds>,
    /// By tool vector, the last ones asked for: every program of a job asks for the same again, with its first tool.
    everywhere: Arc<Mutex<VecDeque<(Vector, Everywhere)>>>,
    /// Where the rotary axes stood last, by thread.
    remembered: Arc<ThreadLocal<RefCell<Remembered>>>,
}

/// Of so many tools the bounds are kept.
const TOOLS_KEPT: usize = 16;

/// Of the axes X, Y, Z: bounds by class of length, `None` where the axis has no errors.
type WorstBounds = [Option<Box<[SixBounds; CLASSES]>>; 3];

impl RigidBody {
    /// Prepares the model.
    ///
    /// # Errors
    /// [`Unusable`] where the tables of an axis and its travel have no interval in common.
    pub fn new(description: Description) -> Result<Self, Unusable> {
        let order = description.chain.linear();
        let tilts = description.squareness.tilts();
        let links = std::array::from_fn(|place| {
            let axis = order[place].direction();
            let data = &description.linear[axis];
            let mut lever = data.measured_tool_mm;
            for later in &order[place + 1..] {
                lever[later.direction()] += data.measured_at_mm[later.direction()];
            }
            let mut way = Vector::zeros();
            way[axis] = 1.0;
            Link {
                axis,
                way,
                tilt: tilts[axis],
                by_direction: by_direction(data, axis),
                measured_lever_mm: lever,
            }
        });
        let volume = Volume(std::array::from_fn(|axis| description.linear[axis].calibrated_mm()));
        if let Some(axis) =
            (0..3).find(|&axis| volume.0[axis].low.partial_cmp(&volume.0[axis].high) != Some(Ordering::Less))
        {
            return Err(Unusable { axis: Axis::ALL[axis].letter() });
        }
        let table_has_errors =
            description.chain.table().iter().any(|axis| !description.rotary[axis.direction()].is_perfect());
        let depends_on_direction =
            description.linear.iter().any(|axis| axis.errors_negative.is_some() || axis.backlash_mm != 0.0);
        let has_rotary_play = description
            .chain
            .axes()
            .any(|axis| !axis.is_linear() && description.rotary[axis.direction()].has_play());
        let swivels =
            [Axis::A, Axis::B, Axis::C].map(|axis| Swivel::new(&description.rotary[axis.direction()], axis));
        let place_of = from_fn(|axis| links.iter().position(|link: &Link| link.axis == axis).unwrap_or(axis));
        Ok(Self {
            swivels,
            description,
            links,
            place_of,
            volume,
            table_has_errors,
            depends_on_direction,
            has_rotary_play,
            worst_bounds: OnceLock::new(),
            everywhere: Arc::default(),
            remembered: Arc::default(),
        })
    }

    /// What it was made from.
    #[must_use]
    pub fn description(&self) -> &Description {
        &self.description
    }

    /// Bounds of the tables that hold on every short stretch of an axis, in all directions.
    pub(crate) fn worst_bounds(&self) -> &WorstBounds {
        self.worst_bounds.get_or_init(|| {
            let mut by_axis: WorstBounds = [const { None }; 3];
            for link in &self.links {
                let each = link.by_direction.iter().map(|t| t.bounds_anywhere(Everywhere::longest_mm()));
                by_axis[link.axis] = each
                    .reduce(|one, other| std::array::from_fn(|class| one[class].union(&other[class])))
                    .map(Box::new);
            }
            by_axis
        })
    }

    /// Where the tool tip really goes: equation (9).
    ///
    /// The command of the linear axes is taken to the nearest point of the volume for the error, not for
    /// the nominal position.
    #[must_use]
    pub fn predict(&self, command: &Command) -> Prediction {
        self.standing(command, |standing| {
            let error_mm = self.error_as_seen(standing, &command.linear_mm, &command.direction);
            Prediction { position_mm: standing.nominal_position(&command.linear_mm) + error_mm, error_mm }
        })
    }

    /// Uses what the rotary axes do as they stand in this command.
    pub(crate) fn standing<R>(&self, command: &Command, use_it: impl FnOnce(&Standing) -> R) -> R {
        let work_out = || self.worked_out(command);
        // Without rotary axes it is less than looking for it.
        if !self.description.chain.has_rotary() {
            return use_it(&work_out());
        }
        Remembered::with(self.remembered.get_or_default(), command, work_out, use_it)
    }

    fn worked_out(&self, command: &Command) -> Standing {
        let (turn, shift_mm) = self.table_transform(command, Machine::Ideal);
        let (real_turn, error) = if self.table_has_errors {
            let (real, real_shift) = self.table_transform(command, Machine::Real);
            let back = turn.transpose();
            (real, Some((back * real, back * (real_shift - shift_mm))))
        } else {
            (turn, None)
        };
        let (mut ideal_mm, mut real_mm) = (command.tool_mm, command.tool_mm);
        let mut spindle = [Vector::z(); 2];
        for axis in self.description.chain.head().iter().rev() {
            let [ideal, real] = [Machine::Ideal, Machine::Real]
                .map(|machine| self.swivels[axis.direction()].moved(command, machine));
            (ideal_mm, real_mm) = (ideal.0 * ideal_mm + ideal.1, real.0 * real_mm + real.1);
            spindle = [ideal.0 * spindle[0], real.0 * spindle[1]];
        }
        let tool_error_mm = real_mm - ideal_mm;
        Standing { turn, shift_mm, real_turn, error, tool_mm: ideal_mm, tool_error_mm, spindle }
    }

    /// Real minus nominal position, mm, workpiece frame.
    pub(crate) fn error_as_seen(
        &self,
        standing: &Standing,
        linear_mm: &Vector,
        directions: &[i8; 3],
    ) -> Vector {
        standing.turn * self.error_at(standing, linear_mm, directions)
    }

    /// The same in the directions of the linear axes: equations (8) and (9).
    pub(crate) fn error_at(&self, standing: &Standing, linear_mm: &Vector, directions: &[i8; 3]) -> Vector {
        let q = self.volume.nearest(linear_mm);
        let all = |v| Triple::all(0.0, v);
        let carried = (all(&standing.tool_mm), all(&standing.tool_error_mm));
        let linear = self.chain_error(&[q.x, q.y, q.z], directions, carried.0, carried.1).into();
        let Some((turn, shift)) = &standing.error else { return linear };
        let nominal = q + standing.tool_mm;
        turn * (nominal + linear) + shift - nominal
    }

    /// Tool vector in the directions of the linear axes, mm, as an ideal head turns it.
    #[must_use]
    pub fn nominal_tool(&self, command: &Command) -> Vector {
        if self.description.chain.head().is_empty() {
            return command.tool_mm;
        }
        self.standing(command, |standing| standing.tool_mm)
    }

    /// From the frame of the linear axes to the workpiece's: the inverse of what the table's axes do.
    fn table_transform(&self, command: &Command, machine: Machine) -> (Matrix3<f64>, Vector) {
        let moved = |axis: &Axis| {
            let (turn, shift) = self.swivels[axis.direction()].moved(command, machine);
            (turn.transpose(), shift)
        };
        let mut axes = self.description.chain.table().iter().rev();
        let Some(nearest) = axes.next() else { return (Matrix3::identity(), Vector::zeros()) };
        let (back, offset) = moved(nearest);
        axes.fold((back, back * -offset), |(turn, shift), axis| {
            let (back, offset) = moved(axis);
            (back * turn, back * (shift - offset))
        })
    }

    /// From the directions of the linear axes to the workpiece's, ideal table: the identity without a table.
    #[inline]
    pub(crate) fn table_turn(&self, command: &Command) -> Matrix3<f64> {
        if self.description.chain.table().is_empty() {
            return Matrix3::identity();
        }
        self.standing(command, |standing| standing.turn)
    }

    /// From the directions of the linear axes to the workpiece's, as the real table turns them: the rotation of
    /// `M_1⁻¹ …` in equation (9). The identity without a table.
    #[must_use]
    pub fn real_table_turn(&self, command: &Command) -> Matrix3<f64> {
        self.standing(command, |standing| standing.real_turn)
    }

    /// Error of the linear axes, on top of that of what they carry: the recursion of equation (8).
    #[inline(always)]
    pub(crate) fn chain_error<T: OfAxis>(
        &self,
        q: &[T; 3],
        directions: &T::Directions,
        mut nominal: Triple<T>,
        mut error: Triple<T>,
    ) -> Triple<T> {
        for link in self.links.iter().rev() {
            let at = q[link.axis];
            if let Some([x, y, z, a, b, c]) = T::six(link, at, directions) {
                let beyond = nominal + error - Triple::all(at, &link.measured_lever_mm);
                error = error + (Triple([x, y, z]) + turned(Triple([a, b, c]), beyond));
            }
            error = error + Triple::all(at, &link.tilt).scaled(at);
            nominal = nominal + Triple::all(at, &link.way).scaled(at);
        }
        error
    }

    /// [`Self::chain_error`] of a machine without head, and its gradient to first order: a column for each axis.
    #[inline(always)]
    pub(crate) fn chain_error_and_gradient<T: OfAxis>(
        &self,
        q: &[T; 3],
        directions: &T::Directions,
        tool_mm: &Vector,
    ) -> (Triple<T>, [Triple<T>; 3]) {
        let zero = Triple([q[0].all(0.0); 3]);
        let mut nominal = Triple::all(q[0], tool_mm);
        let mut error = zero;
        // By place in the chain.
        let mut gradient = [zero; 3];
        for place in [2, 1, 0] {
            let link = &self.links[place];
            let at = q[link.axis];
            if let Some(([x, y, z, a, b, c], [dx, dy, dz, da, db, dc])) =
                T::six_with_slopes(link, at, directions)
            {
                let beyond = nominal + error - Triple::all(at, &link.measured_lever_mm);
                let turn = Triple([a, b, c]);
                error = error + (Triple([x, y, z]) + turned(turn, beyond));
                gradient[place] =
                    gradient[place] + (Triple([dx, dy, dz]) + Triple([da, db, dc]).cross(beyond));
                // The axes that this one carries move on turned ways.
                for (carried, gradient) in self.links.iter().zip(&mut gradient).skip(place + 1) {
                    *gradient = *gradient + turn.cross(Triple::all(at, &carried.way));
                }
            }
            error = error + Triple::all(at, &link.tilt).scaled(at);
            gradient[place] = gradient[place] + Triple::all(at, &link.tilt);
            nominal = nominal + Triple::all(at, &link.way).scaled(at);
        }
        let [x, y, z] = self.place_of;
        (error, [gradient[x], gradient[y], gradient[z]])
    }

    /// Tip of an ideal machine, mm, workpiece frame.
    pub(crate) fn nominal_position(&self, linear_mm: &Vector, state: &Command) -> Vector {
        self.standing(state, |standing| standing.nominal_position(linear_mm))
    }

    /// Where the linear axes of an ideal machine have to stand so that its tip is there, both mm: the inverse of
    /// [`Self::nominal_position`].
    pub(crate) fn reach(&self, tip_mm: &Vector, state: &Command) -> Vector {
        self.standing(state, |standing| standing.reach(tip_mm))
    }

    /// The tool's direction as the workpiece sees it, unit vectors: of an ideal machine, and of this one. It is that of the
    /// spindle, Z with all rotary axes at 0, from the tip up.
    ///
    /// Linear axes turn what they carry by their angles, in the order of the chain; squareness does not turn it.
    #[must_use]
    pub fn directions(&self, command: &Command) -> [Vector; 2] {
        let q = self.volume.nearest(&command.linear_mm);
        let through = |tool: Vector, link: &Link| match link.tables(command.direction[link.axis]) {
            Some(tables) => {
                let [.., a, b, c] = tables.at(q[link.axis]);
                small(&Vector::new(a, b, c)) * tool
            }
            None => tool,
        };
        self.standing(command, |standing| {
            let linear = self.links.iter().rev().fold(standing.spindle[1], through);
            [standing.turn * standing.spindle[0], standing.real_turn * linear]
        })
    }

    /// The first of [`RigidBody::directions`].
    pub(crate) fn ideal_direction(&self, command: &Command) -> Vector {
        self.standing(command, |standing| standing.turn * standing.spindle[0])
    }

    /// That every rotary axis stands inside its travel and its tables.
    ///
    /// # Errors
    /// [`SolveError::OutsideRotaryRange`] for the first that does not.
    pub fn rotary_inside(&self, command: &Command) -> Result<(), SolveError> {
        self.rotary_within(command, [true; 3], RotaryAxis::calibrated_rad)
    }

    /// That rotary axes stand inside a range of each.
    pub(crate) fn rotary_within(
        &self,
        command: &Command,
        which: [bool; 3],
        range: impl Fn(&RotaryAxis) -> Range,
    ) -> Result<(), SolveError> {
        let axes = self.description.chain.axes().filter(|axis| !axis.is_linear());
        for axis in axes.filter(|axis| which[axis.direction()]) {
            let range = range(&self.description.rotary[axis.direction()]);
            let value = command.rotary_rad[axis.direction()];
            // Angles come from degrees and cannot be exact.
            let slack = 1e-9;
            if !(range.low - slack <= value && value <= range.high + slack) {
                let degrees = |rad: f64| rad * (180.0 / std::f64::consts::PI);
                return Err(SolveError::OutsideRotaryRange {
                    axis: axis.letter(),
                    value_deg: degrees(value),
                    low_deg: degrees(range.low),
                    high_deg: degrees(range.high),
                });
            }
        }
        Ok(())
    }

    /// Largest stretching of `D - I`, `D` the table's rotation error: how far it bends straight motion's speed.
    pub(crate) fn table_gain(&self, command: &Command) -> f64 {
        let gain = |(turn, _): (Matrix3<f64>, Vector)| (turn - Matrix3::identity()).norm();
        self.standing(command, |standing| standing.error.map_or(0.0, gain))
    }

    /// Tool vector as the bounds need it, ideal and its error by the head.
    pub(crate) fn tool_for_bounds(&self, command: &Command) -> (Vector, Vector) {
        if self.description.chain.head().is_empty() {
            return (command.tool_mm, Vector::zeros());
        }
        self.standing(command, |standing| (standing.tool_mm, standing.tool_error_mm))
    }
}
