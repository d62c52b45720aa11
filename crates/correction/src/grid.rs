//! Whole output steps: the one place where numbers are rounded.

use machine_model::{Placement, Vector};
use toolpath::{Frame, Kinematics, PeckRetreats, Plane};
use units::decimal::round;

/// What a block itself states: these may stay as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stated {
    /// Where X, Y, Z go.
    pub axes: [bool; 3],
    /// Where A, B, C turn to.
    pub rotary: [bool; 3],
    /// The centre of an arc, along X, Y, Z.
    pub centre: [bool; 3],
    /// The radius of an arc, or the level at which a cycle begins to feed.
    pub radius: bool,
    /// How many turns an arc makes.
    pub turns: bool,
}

/// Where one axis goes; also a centre, a radius, a level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// Nowhere: it stays where it stands.
    Stays,
    /// To where the block itself states.
    AsStated,
    /// To this many output steps.
    Steps(i64),
}

/// What correction must know of the block a motion came from.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Program millimetres to axis commands.
    pub frame: Frame,
    /// What X, Y and Z are.
    pub kinematics: Kinematics,
    /// Millimetres in one program unit: 1 or 25.4.
    pub unit_mm: f64,
    /// X words are diameters: their step moves the axis by half of itself. Centre and radius words are not.
    pub diameters: bool,
    /// Decimals of the output step of X, Y, Z in program units.
    pub decimals: [u8; 3],
    /// Decimals of a degree with which A, B, C words are written: those of the output step, or of the block's own words where
    /// they are finer.
    pub rotary_decimals: [u8; 3],
    /// The output step of A, B, C in units of these.
    pub rotary_step: [i64; 3],
    /// Axes whose words are increments: all under G91, those of U and W on a lathe.
    pub incremental: [bool; 3],
    /// G90.1.
    pub arc_centres_absolute: bool,
    /// What the block itself states.
    pub stated: Stated,
    /// Axes that stand in the words of a block together or not at all: the frame was just turned, scaled or mirrored,
    /// and controls differ in where a left-out axis then stands.
    pub whole: [bool; 3],
    /// Axes that the program has named in the frame in force before this block: a word for one of them moves it by the
    /// correction and nothing else. None is ever added for another axis.
    pub named: [bool; 3],
    /// Axes to which a code of the block itself gives another frame, so that controls may differ in when they move: the
    /// block's own words for them stand in the first line that is written for it.
    pub reframed: [bool; 3],
    /// From the gauge point to the tool tip, mm.
    pub tool_mm: [f64; 3],
    /// Where the workpiece lies: errors count from there.
    pub datum: Placement,
    /// The plane in which the control offsets the tool, or in which it still has to lead it off its offset path.
    pub offset: Option<Plane>,
    /// The dialect writes arcs by centre words; else by R.
    pub centre_words: bool,
    /// An arc whose words would change is written as lines.
    pub arcs_become_lines: bool,
    /// Largest difference of an arc's two radii that the control takes, mm.
    pub arc_radius_tolerance_mm: f64,
    /// How far a peck that is written as moves goes back.
    pub retreats: PeckRetreats,
    /// What of the tolerance something else takes, mm: a tool that touches beside the tip which is corrected.
    pub reserved_mm: f64,
    /// No line on the way to a start takes less than this share of its motion's time under inverse time: a few micrometres
    /// at the motion's own speed would be an F of many digits, and slower is no harm.
    pub least_share: f64,
}

impl Default for Block {
    /// Absolute words in millimetres of three decimals that count from the machine's zero, all axes named, no tool; nothing
    /// stated.
    fn default() -> Self {
        Self {
            frame: Frame::default(),
            kinematics: Kinematics::Axes,
            unit_mm: 1.0,
            diameters: false,
            decimals: [3; 3],
            rotary_decimals: [3; 3],
            rotary_step: [1; 3],
            incremental: [false; 3],
            arc_centres_absolute: false,
            stated: Stated::default(),
            whole: [false; 3],
            named: [true; 3],
            reframed: [false; 3],
            tool_mm: [0.0; 3],
            datum: Placement::default(),
            offset: None,
            centre_words: true,
            arcs_become_lines: false,
            arc_radius_tolerance_mm: 0.02,
            retreats: PeckRetreats { clearance_mm: 0.5, chip_mm: 0.5 },
            reserved_mm: 0.0,
            least_share: 1e-3,
        }
    }
}

/// Exact in an f64.
const POWERS_OF_TEN: [f64; 10] = [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9];
/// One over each, rounded as a division would.
const STEPS: [f64; 10] = [1e0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9];

impl Block {
    /// What one in an axis' word moves the axis by, mm.
    #[inline]
    fn unit_mm_of(&self, axis: usize) -> f64 {
        if self.diameters && axis == 0 { 0.5 * self.unit_mm } else { self.unit_mm }
    }

    /// A length in units of an axis' word.
    #[inline]
    fn in_units(&self, axis: usize, mm: f64) -> f64 {
        // A division takes as long as all the rest.
        let unit_mm = self.unit_mm_of(axis);
        if unit_mm == 1.0 { mm } else { mm / unit_mm }
    }

    /// Steps in one program unit of an axis.
    #[inline]
    fn per_unit(&self, axis: usize) -> f64 {
        POWERS_OF_TEN[usize::from(self.decimals[axis].min(9))]
    }

    /// The output step of an axis, mm.
    #[inline]
    pub fn step_mm(&self, axis: usize) -> f64 {
        let decimals = usize::from(self.decimals[axis].min(9));
        let unit_mm = self.unit_mm_of(axis);
        if unit_mm == 1.0 { STEPS[decimals] } else { unit_mm / POWERS_OF_TEN[decimals] }
    }

    /// What an output step moves a machine axis by, mm: of its own word, or in a turned frame of any.
    pub fn axis_step_mm(&self, axis: usize) -> f64 {
        if self.frame.is_axial() {
            self.frame.matrix()[axis][axis].abs() * self.step_mm(axis)
        } else {
            self.largest_step_mm()
        }
    }

    /// The most that an output step of any word moves an axis by, mm.
    pub(crate) fn largest_step_mm(&self) -> f64 {
        self.frame.largest_scale() * (0..3).map(|axis| self.step_mm(axis)).fold(0.0, f64::max)
    }

    /// Length of the vector of half output steps, mm: the rounding that the path promise allows.
    pub fn rounding_mm(&self) -> f64 {
        let half = [0, 1, 2].map(|i| 0.5 * self.step_mm(i));
        // A scaled frame scales what a word is rounded by.
        self.frame.largest_scale() * (half[0] * half[0] + half[1] * half[1] + half[2] * half[2]).sqrt()
    }

    /// Chooses the word of one axis and says where the axis then stands, in program mm.
    ///
    /// * `wanted_mm` – where it should stand
    /// * `programmed_mm` – where the word that stands in the block would bring it; `None` without a word
    /// * `standing_mm` – where it stands before the block; `None` where unknown
    ///
    /// A word is left alone, or left out, where that is as near as rounding would bring it: within half
    /// a step.
    #[inline]
    pub fn choose(
        &self,
        axis: usize,
        wanted_mm: f64,
        programmed_mm: Option<f64>,
        standing_mm: Option<f64>,
    ) -> (Goal, f64) {
        self.choose_within(axis, self.half_step_mm(axis), wanted_mm, programmed_mm, standing_mm)
    }

    /// As near as rounding brings an axis, mm.
    #[inline]
    pub(crate) fn half_step_mm(&self, axis: usize) -> f64 {
        0.5 * self.step_mm(axis) * (1.0 + 1e-9)
    }

    /// [`Block::choose`] with [`Block::half_step_mm`] at hand.
    #[inline]
    pub(crate) fn choose_within(
        &self,
        axis: usize,
        half: f64,
        wanted_mm: f64,
        programmed_mm: Option<f64>,
        standing_mm: Option<f64>,
    ) -> (Goal, f64) {
        if let Some(programmed) = programmed_mm
            && (wanted_mm - programmed).abs() <= half
        {
            return (Goal::AsStated, programmed);
        }
        // A word that stands in the block is rewritten even where the axis need not move: a motion
        // block without any axis word would be another kind of block.
        if let (Some(standing), None) = (standing_mm, programmed_mm)
            && (wanted_mm - standing).abs() <= half
        {
            return (Goal::Stays, standing);
        }
        self.write(axis, wanted_mm, standing_mm)
    }

    /// The word that brings an axis nearest to `wanted_mm`.
    #[inline]
    pub fn write(&self, axis: usize, wanted_mm: f64, standing_mm: Option<f64>) -> (Goal, f64) {
        let origin = if self.incremental[axis] { standing_mm.unwrap_or(0.0) } else { 0.0 };
        let counts = round(self.steps(axis, wanted_mm - origin));
        (Goal::Steps(counts), origin + self.from_counts(axis, counts))
    }

    /// A length as a number of output steps.
    #[inline]
    pub(crate) fn steps(&self, axis: usize, mm: f64) -> f64 {
        self.in_units(axis, mm) * self.per_unit(axis)
    }

    /// Millimetres of a whole number of output steps.
    #[inline]
    pub(crate) fn steps_mm(&self, axis: usize, steps: f64) -> f64 {
        steps / self.per_unit(axis) * self.unit_mm_of(axis)
    }

    /// Adds words for the axes that must not be left out beside others; `reached`: where the words bring the axes.
    pub fn complete(&self, words: &mut [Goal; 3], reached: &mut [f64; 3], standing_mm: [Option<f64>; 3]) {
        let open = |i: &usize| self.whole[*i];
        if (0..3).filter(open).any(|i| words[i] != Goal::Stays) {
            for i in (0..3).filter(open).filter(|i| words[*i] == Goal::Stays).collect::<Vec<_>>() {
                (words[i], reached[i]) = self.write(i, reached[i], standing_mm[i]);
            }
        }
    }

    /// Program millimetres of a count of steps.
    #[inline]
    pub fn from_counts(&self, axis: usize, counts: i64) -> f64 {
        self.steps_mm(axis, counts as f64)
    }

    /// Nearest count of steps for a length in mm.
    pub fn to_counts(&self, axis: usize, mm: f64) -> i64 {
        round(self.steps(axis, mm))
    }

    /// Where the block's own words bring the axes, as an axis command: absolute ones to the nominal end, incremental ones by
    /// the nominal step from where the axes stand.
    #[inline]
    pub(crate) fn own_end(&self, standing: &Vector, step: &Vector, end: &Vector) -> Vector {
        Vector::from_fn(|i, _| if self.incremental[i] { standing[i] + step[i] } else { end[i] })
    }

    /// The block as its centre and radius words are written: a radius is none of a diameter.
    #[must_use]
    pub(crate) fn of_centres(&self) -> std::borrow::Cow<'_, Self> {
        use std::borrow::Cow;
        if self.diameters {
            Cow::Owned(Self { diameters: false, ..self.clone() })
        } else {
            Cow::Borrowed(self)
        }
    }

    /// Axes that may have a word in what stands for a feed block: its own, and those that the program has named.
    #[must_use]
    pub fn may_have_words(&self) -> [bool; 3] {
        [0, 1, 2].map(|axis| self.named[axis] || self.stated.axes[axis])
    }

    /// Axes that a motion must leave where they stand, in the program's coordinates: a control that offsets the tool takes
    /// its direction, leads onto the contour and off it, by the first motion in the plane, be it of a micrometre.
    pub(crate) fn held(&self, from_mm: &Vector, to_mm: &Vector) -> [bool; 3] {
        /// A move in the plane shorter than this is none, mm.
        const STANDS_MM: f64 = 1e-9;
        let Some(plane) = self.offset else { return [false; 3] };
        let [u, v, normal] = plane.axes();
        let (from, to) = (self.program(from_mm), self.program(to_mm));
        let stands = [u, v].iter().all(|axis| (to[*axis] - from[*axis]).abs() <= STANDS_MM);
        [0, 1, 2].map(|axis| stands && axis != normal)
    }

    /// Program coordinates of an axis command.
    pub fn program(&self, machine_mm: &Vector) -> [f64; 3] {
        self.frame.to_program((*machine_mm).into())
    }

    /// Axis command of program coordinates.
    #[inline]
    pub fn machine(&self, program_mm: [f64; 3]) -> Vector {
        self.frame.to_machine(program_mm).into()
    }
}
