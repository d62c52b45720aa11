//! Tool centre point control: the program says where the tip shall be, the control where the axes go. Equation (61).

use std::sync::{Arc, OnceLock};

use nalgebra::Matrix3;
use toolpath::TiltedPlane;

use crate::chord_bound::lies_inside;
use crate::engine::inside;
use crate::length::Length;
use crate::rotary::ideally_turned;
use crate::solve::solve;
use crate::standing::Standing;
use crate::turning_bound::error_in_turn;
use crate::{
    Axis, Command, Description, Engine, EngineId, LinearAxis, Move, PathModel, Range, RigidBody, RotaryAxis,
    RotaryPlay, Solution, SolveError, Squareness, Turn, Vector, Volume,
};

/// A machine under tool centre point control (G43.4, TRAORI, switched kinematics).
///
/// Places of the linear axes are *tip commands* here: what X, Y, Z would be told with all rotary axes at 0, so that the
/// tip stands there in the frame of the workpiece, which turns with the table. The control makes axis commands of them
/// with its own centres, as if the machine were perfect; where its centres are others than the machine's, that is an error
/// like any other. Errors are those of the tip in the workpiece.
///
/// ```
/// use machine_model::{Command, PathModel, TipControl, Vector};
/// # use machine_model::{Chain, Description, LinearAxis, Range, RigidBody, RotaryAxis, Squareness};
/// # let linear = [(); 3].map(|()| LinearAxis::perfect(Range { low: -500.0, high: 500.0 }));
/// # let rotary = [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros()));
/// # let chain = Chain::parse("[w C b X Y Z t]").unwrap();
/// # let machine = RigidBody::new(Description { chain, linear, rotary, squareness: Squareness::default() }).unwrap();
/// // The control has C's centre 10 µm beside where it is: no error at 0, twice that after half a turn.
/// let centres_mm = [Vector::zeros(), Vector::zeros(), Vector::new(0.010, 0.0, 0.0)];
/// let tip = TipControl::new(&machine, centres_mm).unwrap();
/// let at = |c: f64| Command {
///     linear_mm: Vector::new(100.0, 0.0, 0.0),
///     rotary_rad: Vector::new(0.0, 0.0, c),
///     tool_mm: Vector::zeros(),
///     direction: [0; 3],
///     ..Default::default()
/// };
/// assert_eq!(tip.error_mm(&at(0.0)), Vector::zeros());
/// assert!((tip.error_mm(&at(std::f64::consts::PI)).x + 0.020).abs() < 1e-12);
/// ```
#[derive(Clone, Debug)]
pub struct TipControl {
    core: Arc<Core>,
    planes: Planes,
}

/// What does not depend on the plane.
#[derive(Debug)]
struct Core {
    machine: RigidBody,
    /// The machine that the control believes in.
    control: RigidBody,
    /// Distances between the centres that it believes in and those that there are, all together, mm.
    apart_mm: f64,
}

/// What the rotary axes do where they stand, of the machine and of the one that the control believes in.
#[derive(Clone, Copy)]
struct Stands<'a> {
    machine: &'a Standing,
    control: &'a Standing,
}

/// Where a tip may be: whether the axes get there is asked of them.
const ANYWHERE: Volume = Volume([Range { low: f64::NEG_INFINITY, high: f64::INFINITY }; 3]);

/// Bounds hold for stretches that turn by less than this, all rotary axes together, rad: then a coordinate passes a place
/// no more often than [`passes`] says.
const MOST_TURN_RAD: f64 = 3.0;

/// More than nothing, mm: an axis that several tip coordinates move does not run evenly through the box of its places.
const NOT_EVEN_MM: f64 = 1e-12;

/// How often an axis passes a place at most while so many rotary axes turn evenly.
///
/// Its command is a sum of 1, s, and both times sines and cosines of sums and differences of the angles: `2·3ⁿ` functions
/// that solve one linear equation with constant coefficients, whose solutions have fewer zeros than its order on a stretch
/// on which the fastest of them turns by less than π (Pólya).
fn passes(turning: usize) -> f64 {
    [1.0, 5.0, 17.0, 53.0][turning.min(3)]
}

/// Upper bounds of the distance from a centre that turns evenly, and of its derivatives along a stretch, mm.
#[derive(Clone, Copy)]
struct Course([f64; 4]);

impl Course {
    /// The same seen from what turns by `speed` rad a stretch, about a centre so far away in the middle of the stretch.
    fn turned(self, arm_mm: f64, speed: f64) -> Self {
        let Self([_, first, second, third]) = self;
        // From the middle it goes half of its way at most.
        let value = arm_mm + 0.5 * first;
        Self([
            value,
            first + speed * value,
            second + speed * (2.0 * first + speed * value),
            third + speed * (3.0 * second + speed * (3.0 * first + speed * value)),
        ])
    }
}

/// How the rotary axes turn on a stretch; `None` where they stand.
fn turning(stretch: &Move) -> Option<Turn> {
    let moves = |ends: &[Vector; 2]| ends[0] != ends[1];
    stretch.turn.filter(|turn| moves(&turn.commanded_rad) || moves(&turn.lag_rad))
}

/// A stretch on which the rotary axes stand, with its state saying where.
fn as_it_stands(stretch: &Move) -> Move {
    let Some(turn) = stretch.turn else { return *stretch };
    let rotary_play = RotaryPlay { lag_rad: turn.lag_rad[0], ..stretch.state.rotary_play };
    let state = Command { rotary_rad: turn.commanded_rad[0], rotary_play, ..stretch.state };
    Move { state, turn: None, ..*stretch }
}

impl TipControl {
    /// Puts a machine under the control.
    ///
    /// * `centres_mm` – of A, B, C as the control has them, machine coordinates; those of axes that the machine does not have
    ///   are not used
    ///
    /// `None` where the machine's error depends on the direction of motion: under such control axes turn back on the way.
    #[must_use]
    pub fn new(machine: &RigidBody, centres_mm: [Vector; 3]) -> Option<Self> {
        if machine.depends_on_direction() {
            return None;
        }
        let real = machine.description();
        let rotary = [0, 1, 2].map(|axis| RotaryAxis {
            direction: real.rotary[axis].direction,
            ..RotaryAxis::perfect(centres_mm[axis])
        });
        let apart_mm = real
            .chain
            .axes()
            .filter(|axis| !axis.is_linear())
            .map(|axis| (real.rotary[axis.direction()].centre_mm - centres_mm[axis.direction()]).norm())
            .sum();
        let linear = real.linear.each_ref().map(|axis| LinearAxis::perfect(axis.travel_mm));
        let control =
            Description { chain: real.chain.clone(), linear, rotary, squareness: Squareness::default() };
        let control = RigidBody::new(control).ok()?;
        let core = Core { machine: machine.clone(), control, apart_mm };
        Some(Self { core: Arc::new(core), planes: Planes::default() })
    }

    fn stands<R>(&self, command: &Command, use_them: impl FnOnce(Stands<'_>) -> R) -> R {
        self.core.machine.standing(command, |machine| {
            if self.core.apart_mm == 0.0 {
                use_them(Stands { machine, control: machine })
            } else {
                self.control_stands(command, |control| use_them(Stands { machine, control }))
            }
        })
    }

    /// What the rotary axes do in what the control believes. With its centres where they are that is what the machine's
    /// would do without errors.
    fn control_stands<R>(&self, command: &Command, use_it: impl FnOnce(&Standing) -> R) -> R {
        if self.core.apart_mm == 0.0 {
            return self.core.machine.standing(command, use_it);
        }
        // Nothing of it has play.
        self.core.control.standing(&Command { rotary_play: RotaryPlay::default(), ..*command }, use_it)
    }

    /// Real tip less the tip that was asked for, mm, in the frame of the workpiece.
    fn error_at(&self, stands: Stands<'_>, linear_mm: &Vector, state: &Command) -> Vector {
        let asked = linear_mm + state.tool_mm;
        let axes = stands.control.reach(&asked);
        // Tip commands are places of the workpiece: the datum is the same wherever its axes stand.
        let own =
            self.core.machine.error_as_seen(stands.machine, &axes, &state.direction) - state.datum.shift_mm;
        if self.core.apart_mm == 0.0 {
            // No more than that: what is zero stays zero to the last bit.
            return own;
        }
        own + stands.machine.nominal_position(&axes) - linear_mm - state.tool_mm
    }

    /// What the control tells the axes for a tip command.
    #[must_use]
    pub fn axis_command(&self, tip: &Command) -> Command {
        let reach = |stands: &Standing| stands.reach(&(tip.linear_mm + tip.tool_mm));
        Command { linear_mm: self.control_stands(tip, reach), ..*tip }
    }

    /// The tip command at an axis command.
    #[must_use]
    pub fn tip_command(&self, axes: &Command) -> Command {
        let nominal = |stands: &Standing| stands.nominal_position(&axes.linear_mm);
        Command { linear_mm: self.control_stands(axes, nominal) - axes.tool_mm, ..*axes }
    }

    /// How axes run while tip and rotary axes run evenly; `None` where they turn too far for one bound.
    fn turning(&self, stretch: &Move, turn: &Turn) -> Option<Move> {
        let Description { chain, rotary, .. } = self.core.control.description();
        let rates = turn.commanded_rad[1] - turn.commanded_rad[0];
        let turning =
            || chain.axes().filter(|axis| !axis.is_linear()).map(|axis| rates[axis.direction()].abs());
        if turning().sum::<f64>() >= MOST_TURN_RAD {
            return None;
        }
        let rotary_rad = 0.5 * (turn.commanded_rad[0] + turn.commanded_rad[1]);
        let linear_mm = Vector::from_fn(|i, _| 0.5 * (stretch.range_mm[i].low + stretch.range_mm[i].high));
        let middle = Command { linear_mm, rotary_rad, ..stretch.state };
        // Of each rotary axis: how it stands in the middle, and how what stands so far from its centre moves with it.
        let around = |axis: Axis| {
            let (data, k) = (&rotary[axis.direction()], axis.direction());
            let line = data.direction.unwrap_or_else(|| Vector::ith(k, 1.0));
            (ideally_turned(data, axis, rotary_rad[k]), line * rates[k], data.centre_mm)
        };
        // From the workpiece through the table to the linear axes: where the tip is, how it goes there with the turning
        // alone, and bounds of how it goes altogether.
        let (mut tip, mut carried) = (linear_mm + middle.tool_mm, Vector::zeros());
        let mut seen = Course([0.0, Vector::from(stretch.speed_mm).norm(), 0.0, 0.0]);
        for axis in chain.table() {
            let (stands, rate, centre) = around(*axis);
            seen = seen.turned((tip - centre).norm(), rate.norm());
            let arm = stands * (tip - centre);
            (tip, carried) = (centre + arm, stands * carried + rate.cross(&arm));
        }
        let mut tool = middle.tool_mm;
        let mut swung = Vector::zeros();
        let mut swings = Course([0.0; 4]);
        for axis in chain.head().iter().rev() {
            let (stands, rate, centre) = around(*axis);
            swings = swings.turned((tool - centre).norm(), rate.norm());
            let arm = stands * (tool - centre);
            (tool, swung) = (centre + arm, stands * swung + rate.cross(&arm));
        }
        let [acceleration, jerk] = [2, 3].map(|order| seen.0[order] + swings.0[order]);
        let with_tip = self.control_stands(&middle, |stands| stands.turn.transpose().abs())
            * Vector::from(stretch.speed_mm);
        // In the middle, and as much as that may change.
        let (by_turning, unsure) = ((carried - swung).abs(), with_tip + Vector::repeat(0.5 * acceleration));
        let speed = by_turning + unsure;
        let at = tip - tool;
        // An axis that does not turn back passes each place once. One that does is nowhere faster than it accelerates, and
        // passes a place twice where it always accelerates one way; where it does not, it accelerates by no more than its
        // jerk. Once at so many times the speed is as much.
        let often = passes(turning().filter(|rate| *rate > 0.0).count());
        let back = (2.0 * acceleration).max(often * jerk);
        let once =
            Vector::from_fn(|i, _| if by_turning[i] > unsure[i] { speed[i] } else { speed[i].max(back) });
        Some(Move {
            range_mm: [0, 1, 2].map(|i| Range { low: at[i] - 0.5 * speed[i], high: at[i] + 0.5 * speed[i] }),
            speed_mm: once.into(),
            acceleration_mm: [acceleration.max(NOT_EVEN_MM); 3],
            passes: 1,
            ..*stretch
        })
    }

    /// How axes run while the tip runs and the rotary axes stand.
    fn standing(&self, stretch: &Move) -> Move {
        let turn = self.control_stands(&stretch.state, |stands| stands.turn.transpose());
        Self::led(stretch, &turn, |middle| self.axis_command(middle).linear_mm)
    }

    /// How axes run that are a turn of what runs evenly, `axis_command` saying where.
    fn led(stretch: &Move, turn: &Matrix3<f64>, axis_command: impl Fn(&Command) -> Vector) -> Move {
        let [low, high] = [|range: &Range| range.low, |range: &Range| range.high]
            .map(|end| Vector::from_iterator(stretch.range_mm.iter().map(end)));
        let middle = axis_command(&Command { linear_mm: 0.5 * (low + high), ..stretch.state });
        let size = turn.abs();
        let half = size * (0.5 * (high - low));
        let [speed, acceleration] =
            [stretch.speed_mm, stretch.acceleration_mm].map(|of| size * Vector::from(of));
        let mixed = |axis: usize| size.row(axis).iter().filter(|share| **share != 0.0).count() > 1;
        Move {
            range_mm: [0, 1, 2].map(|i| Range { low: middle[i] - half[i], high: middle[i] + half[i] }),
            speed_mm: speed.into(),
            acceleration_mm: [0, 1, 2]
                .map(|i| if mixed(i) { acceleration[i].max(NOT_EVEN_MM) } else { acceleration[i] }),
            ..*stretch
        }
    }
}

impl Engine for TipControl {
    fn id(&self) -> EngineId {
        self.core.machine.id()
    }

    fn volume(&self) -> Volume {
        ANYWHERE
    }

    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        self.core.machine.rotary_inside(target)?;
        self.stands(target, |stands| {
            let solution = solve(&target.linear_mm, &ANYWHERE, |tip| self.error_at(stands, tip, target))?;
            for tip in [target.linear_mm, solution.linear_mm] {
                inside(&stands.control.reach(&(tip + target.tool_mm)), &self.core.machine.volume)?;
            }
            Ok(solution)
        })
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for TipControl {
    /// Real tip less the tip that was asked for, mm, in the frame of the workpiece.
    fn error_mm(&self, command: &Command) -> Vector {
        self.stands(command, |stands| self.error_at(stands, &command.linear_mm, command))
    }

    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        let Some(turn) = turning(stretch) else {
            // What turns nothing changes no length, and with standing axes other centres are a shift.
            return self.core.machine.chord_bound_mm(&self.standing(&as_it_stands(stretch)));
        };
        // The tip asked for is the same wherever the rotary axes stand.
        let turn = Turn { programmed_rad: turn.commanded_rad, ..turn };
        let Some(axes) = self.turning(stretch, &turn) else { return f64::INFINITY };
        if !lies_inside(&self.core.machine, &axes) {
            return f64::INFINITY;
        }
        let (error, turned) = error_in_turn(&self.core.machine, &axes, &turn);
        let all = (turn.commanded_rad[1] - turn.commanded_rad[0]).abs().sum();
        let apart = Length { second: 2.0 * self.core.apart_mm * all * all, ..Length::default() };
        error.turned(turned).plus(apart).leaves_chord_mm()
    }

    fn follows_turns(&self) -> bool {
        true
    }

    fn has_rotary_play(&self) -> bool {
        self.core.machine.has_rotary_play()
    }

    fn rotary_reversal_rad(&self, axis: usize, command: &Command) -> f64 {
        self.core.machine.rotary_reversal_rad(axis, command)
    }

    fn tip_mm(&self, linear_mm: &Vector, state: &Command) -> Vector {
        linear_mm + state.tool_mm
    }

    fn tilt_rad(&self, command: &Command) -> f64 {
        self.core.machine.tilt_rad(&self.axis_command(command))
    }

    fn tool_directions(&self, command: &Command, programmed_rad: &Vector) -> Option<[Vector; 2]> {
        self.core.machine.tool_directions(&self.axis_command(command), programmed_rad)
    }

    fn direction_bound_rad(&self, stretch: &Move) -> f64 {
        let axes = match turning(stretch) {
            Some(turn) => match self.turning(stretch, &turn) {
                Some(axes) => axes,
                None => return f64::INFINITY,
            },
            None => Move { turn: stretch.turn, ..self.standing(&as_it_stands(stretch)) },
        };
        self.core.machine.direction_bound_rad(&axes)
    }

    fn rotary_axes(&self) -> [bool; 3] {
        self.core.machine.rotary_axes()
    }

    fn in_travel(&self, command: &Command, which: [bool; 3]) -> Result<(), SolveError> {
        self.core.machine.in_travel(command, which)
    }

    fn may_turn_to(&self, command: &Command) -> bool {
        self.core.machine.may_turn_to(command)
    }

    fn in_plane(&self, plane: &TiltedPlane) -> Option<&dyn PathModel> {
        Some(self.planes.of(&self.core, plane))
    }
}

/// A machine in a tilted working plane (G68.2). Equation (77).
///
/// Places of the linear axes are coordinates of the plane here, the tool's length added along its Z, and errors those of the
/// tip in the directions of the plane. The rotary axes stand.
#[derive(Debug)]
struct PlaneControl {
    tip: TipControl,
    plane: TiltedPlane,
    /// From the plane's coordinates to the workpiece's.
    turn: Matrix3<f64>,
}

impl PlaneControl {
    fn new(core: &Arc<Core>, plane: &TiltedPlane) -> Self {
        let tip = TipControl { core: Arc::clone(core), planes: Planes::default() };
        Self { tip, plane: *plane, turn: Matrix3::from_fn(|row, column| plane.turn[row][column]) }
    }

    /// The tip command of a place in the plane.
    fn tip_command(&self, place: &Command) -> Command {
        let tip = Vector::from(self.plane.zero_mm) + self.turn * (place.linear_mm + place.tool_mm);
        Command { linear_mm: tip - place.tool_mm, ..*place }
    }

    fn axis_command(&self, place: &Command) -> Command {
        self.tip.axis_command(&self.tip_command(place))
    }

    /// Real tip less the tip that was asked for, mm, in the directions of the plane.
    fn error_at(&self, stands: Stands<'_>, place: &Command) -> Vector {
        let tip = self.tip_command(place);
        let error = self.tip.error_at(stands, &tip.linear_mm, &tip);
        // What is zero stays zero to the last bit.
        if error == Vector::zeros() { error } else { self.turn.tr_mul(&error) }
    }
}

impl Engine for PlaneControl {
    fn id(&self) -> EngineId {
        self.tip.id()
    }

    fn volume(&self) -> Volume {
        ANYWHERE
    }

    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        let machine = &self.tip.core.machine;
        machine.rotary_inside(target)?;
        let at = |place: &Vector| Command { linear_mm: *place, ..*target };
        self.tip.stands(target, |stands| {
            let solution = solve(&target.linear_mm, &ANYWHERE, |place| self.error_at(stands, &at(place)))?;
            for place in [target.linear_mm, solution.linear_mm] {
                let tip = self.tip_command(&at(&place));
                inside(&stands.control.reach(&(tip.linear_mm + tip.tool_mm)), &machine.volume)?;
            }
            Ok(solution)
        })
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for PlaneControl {
    fn error_mm(&self, command: &Command) -> Vector {
        self.tip.stands(command, |stands| self.error_at(stands, command))
    }

    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        /// Sines of whole quarter turns are that near to nothing.
        const NOTHING: f64 = 1e-15;
        if stretch.turn.is_some() {
            return f64::INFINITY;
        }
        let core = &self.tip.core;
        let turn = self.tip.control_stands(&stretch.state, |stands| stands.turn.tr_mul(&self.turn));
        let turn = turn.map(|share| if share.abs() < NOTHING { 0.0 } else { share });
        core.machine.chord_bound_mm(&TipControl::led(stretch, &turn, |at| self.axis_command(at).linear_mm))
    }

    fn along_axes(&self, workpiece_mm: &Vector, _state: &Command) -> Vector {
        self.turn.tr_mul(workpiece_mm)
    }

    fn has_rotary_play(&self) -> bool {
        self.tip.core.machine.has_rotary_play()
    }

    fn rotary_reversal_rad(&self, axis: usize, command: &Command) -> f64 {
        self.tip.core.machine.rotary_reversal_rad(axis, command)
    }

    fn in_travel(&self, command: &Command, which: [bool; 3]) -> Result<(), SolveError> {
        self.tip.in_travel(command, which)
    }

    fn tip_mm(&self, linear_mm: &Vector, state: &Command) -> Vector {
        linear_mm + state.tool_mm
    }

    fn tilt_rad(&self, command: &Command) -> f64 {
        self.tip.tilt_rad(&self.tip_command(command))
    }
}

/// The planes that were asked for so far: a list that only grows, so that what it gives away stays.
#[derive(Debug, Default)]
struct Planes(OnceLock<Box<Listed>>);

#[derive(Debug)]
struct Listed {
    plane: PlaneControl,
    next: OnceLock<Box<Listed>>,
}

impl Clone for Planes {
    /// They are worked out again.
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl Drop for Planes {
    /// One after the other: a long list would be too deep to drop from within.
    fn drop(&mut self) {
        let mut next = self.0.take();
        while let Some(mut listed) = next {
            next = listed.next.take();
        }
    }
}

impl Planes {
    fn of(&self, core: &Arc<Core>, plane: &TiltedPlane) -> &PlaneControl {
        let mut place = &self.0;
        loop {
            let listed = place.get_or_init(|| {
                Box::new(Listed { plane: PlaneControl::new(core, plane), next: OnceLock::new() })
            });
            if listed.plane.plane == *plane {
                return &listed.plane;
            }
            place = &listed.next;
        }
    }
}
