//! What correction and emission must know of a block.

use nc_dialect::Side;
use nc_syntax::GCode;
use toolpath::{Frame, Kinematics, Plane};

use crate::direction::DirectionWords;
use crate::environment::Environment;
use crate::modal::{ArcCentres, Distance, FeedMode, Lost, Modal, MotionMode, WorkOffset};
use crate::moved::{CurvePart, Moved};

/// Everything correction and emission must know of a block's state, valid for its motions.
#[derive(Clone, Debug, PartialEq)]
pub struct Context {
    /// Program mm to axis commands mm: work offset plus tool length. A shift by zero where the block
    /// moves nothing and the work offset is not given.
    pub frame: Frame,
    /// One unit of the program in mm: 1.0 or 25.4.
    pub unit_mm: f64,
    /// X words are diameters.
    pub diameters: bool,
    /// G93, G94, G95.
    pub feed_mode: FeedMode,
    /// Axes whose words are increments: all under G91, those that U or W stands for.
    pub incremental: [bool; 3],
    /// X, Y, Z that U, V or W stands for in this block.
    pub by_increment: [bool; 3],
    /// G90.1.
    pub arc_centres_absolute: bool,
    /// Working plane.
    pub plane: Plane,
    /// From the gauge point to the tool tip, mm.
    pub tool_mm: [f64; 3],
    /// The work offset in force, which says what a program's zero is.
    pub work_offset: WorkOffset,
    /// What the tool length in force adds to axis commands, mm.
    pub length_mm: [f64; 3],
    /// Motion code in force, after modal resolution: G1, G83; `None` after G80 or before the first.
    pub motion_code: Option<GCode>,
    /// The motion code in force cuts a thread: lines in step with the spindle.
    pub thread: bool,
    /// What X, Y and Z are.
    pub kinematics: Kinematics,
    /// The block says where the tool points by a vector, and by which words.
    pub direction: Option<DirectionWords>,
    /// The block is an arc with R.
    pub arc_by_radius: bool,
    /// The block belongs to a curve by control points.
    pub curve: Option<CurvePart>,
    /// Cutter compensation is in force before or after the block.
    pub compensation: Option<Side>,
    /// The plane in which the tool is offset, or is still to be led off its offset path.
    pub offset: Option<Plane>,
    /// The block may be skipped, in a cycle that goes on behind it: levels that it wrote would hold for the next
    /// holes only where it is executed.
    pub may_not_set_levels: bool,
    /// K or L of a cycle; 1 otherwise.
    pub repeats: u32,
    /// Axes that a motion names together: a rotation, scaling or mirror was switched since they were last named.
    pub whole: [bool; 3],
    /// X, Y, Z: since when the program has not named the axis in the frame in force, before this block; `None` where it
    /// has. No word may be added for one that is not named.
    pub unnamed: [Option<Lost>; 3],
}

impl Context {
    /// What one in the word of an axis moves it by, mm.
    #[must_use]
    pub fn word_mm(&self, axis: usize) -> f64 {
        if self.diameters && axis == 0 { 0.5 * self.unit_mm } else { self.unit_mm }
    }
}

pub(crate) fn context(env: &Environment<'_>, before: &Modal, state: &Modal, moved: &Moved) -> Context {
    Context {
        frame: state.frame.clone().unwrap_or_default(),
        unit_mm: state.units.mm(),
        feed_mode: state.feed_mode,
        diameters: state.x_words.are_diameters(state.distance),
        incremental: moved.by_increment.map(|by_letter| by_letter || state.distance == Distance::Incremental),
        by_increment: moved.by_increment,
        arc_centres_absolute: state.arc_centres == ArcCentres::Absolute,
        plane: state.plane,
        tool_mm: env.setup.tool_vector(&state.tool_length),
        work_offset: state.work_offset,
        length_mm: state.tool_length.applied_mm(),
        kinematics: state.kinematics,
        motion_code: state.motion_code(),
        thread: matches!(state.motion, MotionMode::Thread(_)),
        direction: moved.direction,
        arc_by_radius: moved.arc_by_radius,
        curve: moved.curve,
        compensation: state.compensation.side().or(before.compensation.side()),
        offset: (!before.offset.is_off() || !state.offset.is_off()).then_some(state.plane),
        may_not_set_levels: state.aside.as_ref().is_some_and(|aside| aside.skipped.cycle.is_some()),
        repeats: moved.repeats,
        unnamed: moved.unnamed,
        whole: if before.transform == state.transform {
            before.unsettled
        } else {
            let (was, is) = (before.transform.touches(), state.transform.touches());
            [0, 1, 2].map(|i| before.unsettled[i] || was[i] || is[i])
        },
    }
}
