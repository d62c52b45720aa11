//! The chain workpiece – spindle – carriage – tool, and the radius that it turns.

use machine_model::rotation::around;
use machine_model::{
    Command, Engine, EngineId, Move, PathModel, Range, Solution, SolveError, Vector, Volume, solve,
};
use nalgebra::Matrix3;
use units::math;

use crate::section::Section;
use crate::{Bending, Spindle};

/// The tool against where it was measured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tip {
    /// Tip above the spindle's centre, mm; that of one tool is the Y of its vector.
    pub height_mm: f64,
    /// γ, about Z, rad: turns the vector from the gauge point to the tip.
    pub gamma_rad: f64,
    /// ω, about Y, rad.
    pub omega_rad: f64,
}

/// A station of the turret: where its tool really stands.
///
/// The index of a turret repeats, and each station stands off by its own error; what of it is across the plane of X and Z is
/// the tip's height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// The vector of the tool in it, by which it is known.
    pub tool_mm: Vector,
    /// Along X (of the radius) and Z, mm.
    pub shift_mm: [f64; 2],
}

/// A lathe: where a command leaves the turned surface.
///
/// As a [`PathModel`] its target is (r, z) of the workpiece in X and Z; Y is never commanded.
///
/// ```
/// use machine_model::{
///     Chain, Command, Description, LinearAxis, PathModel, Range, RigidBody, RotaryAxis, Squareness, Vector,
/// };
/// use turning::{Bending, Lathe, Spindle, Tailstock, Tip};
///
/// let axis = || LinearAxis::perfect(Range { low: -10.0, high: 500.0 });
/// let linear = RigidBody::new(Description {
///     chain: Chain::parse("[w b Z X Y t]").unwrap(),
///     linear: [axis(), axis(), axis()],
///     rotary: [(); 3].map(|()| RotaryAxis::perfect(Vector::zeros())),
///     squareness: Squareness::default(),
/// })
/// .unwrap();
/// let tailstock = Some(Tailstock { at_mm: 300.0, offset_mm: [0.025, 0.0] });
/// let spindle = Spindle { tailstock, ..Spindle::default() };
/// let lathe = Lathe::new(Box::new(linear), spindle, Bending::default(), Tip::default(), &[]);
/// let told = Command {
///     linear_mm: Vector::new(20.0, 0.0, 300.0),
///     rotary_rad: Vector::zeros(),
///     tool_mm: Vector::zeros(),
///     direction: [0; 3],
///     ..Default::default()
/// };
/// // A cone of 50 µm on the diameter.
/// assert!((2000.0 * lathe.error_mm(&told).x - 49.999_86).abs() < 1e-5);
/// ```
pub struct Lathe {
    linear: Box<dyn PathModel>,
    spindle: Spindle,
    chuck_mm: Vector,
    /// Machine to axis.
    to_axis: Matrix3<f64>,
    bending: Bending,
    tip: Tip,
    stations: Vec<Station>,
    /// Nearer to the axis than this the radius is no longer promised, mm: see [`Lathe::near_axis_mm`].
    near_axis_mm: f64,
}

/// So many times the tip's distance from the axis' plane are near the axis.
const NEAR: f64 = 4.0;
/// Places along each axis at which the tip's distance from the axis' plane is looked at.
const LOOKS: usize = 9;

impl Lathe {
    /// Of its parts.
    ///
    /// * `linear` – the model of X, Z and a Y that stands at 0
    /// * `tools_mm` – the tool vectors that it will be asked for, besides none
    #[must_use]
    pub fn new(
        linear: Box<dyn PathModel>,
        spindle: Spindle,
        bending: Bending,
        tip: Tip,
        tools_mm: &[Vector],
    ) -> Self {
        let (chuck_mm, turn) = spindle.frame();
        let to_axis = turn.transpose();
        let stations = Vec::new();
        let mut lathe =
            Self { linear, spindle, chuck_mm, to_axis, bending, tip, stations, near_axis_mm: 0.0 };
        let volume = lathe.linear.volume();
        let along =
            |range: Range, k: usize| range.low + (range.high - range.low) * k as f64 / (LOOKS - 1) as f64;
        let none = [Vector::zeros()];
        let heights = tools_mm.iter().chain(&none).flat_map(|tool_mm| {
            (0..LOOKS * LOOKS).map(|k| {
                let linear_mm =
                    Vector::new(along(volume.0[0], k / LOOKS), 0.0, along(volume.0[2], k % LOOKS));
                Command { linear_mm, tool_mm: *tool_mm, ..Default::default() }
            })
        });
        let highest = heights.map(|command| lathe.height_mm(&command).abs()).fold(0.0, f64::max);
        lathe.near_axis_mm = NEAR * highest;
        lathe
    }

    /// The same with a turret whose stations err.
    #[must_use]
    pub fn with_stations(self, stations: Vec<Station>) -> Self {
        Self { stations, ..self }
    }

    /// Its spindle.
    #[must_use]
    pub fn spindle(&self) -> &Spindle {
        &self.spindle
    }

    /// How far the tip stands off the plane through the axis and X at a command, mm: radii below it cannot be turned, and a
    /// face keeps a pip of that radius.
    #[must_use]
    pub fn height_mm(&self, command: &Command) -> f64 {
        self.seen_along_axis(command).y
    }

    /// The tip in the frame of the workpiece's axis, mean of a turn, mm: equation (71), bending included.
    #[must_use]
    pub fn seen_along_axis(&self, command: &Command) -> Vector {
        let Tip { height_mm, gamma_rad, omega_rad } = self.tip;
        let turned = around(2, gamma_rad) * (around(1, omega_rad) * command.tool_mm);
        let mut command = *command;
        command.linear_mm.y = 0.0;
        let tip =
            command.linear_mm + turned + self.linear.error_mm(&command) + Vector::new(0.0, height_mm, 0.0);
        let station = self.stations.iter().find(|station| station.tool_mm == command.tool_mm);
        let [x, z] = station.map_or([0.0; 2], |station| station.shift_mm);
        let mut seen = self.to_axis * (tip + Vector::new(x, 0.0, z) - self.chuck_mm);
        seen.x += self.bending.at_mm(seen.z);
        seen
    }

    /// Where a perfect lathe would cut: X as a radius and Z from the chuck, mm.
    #[must_use]
    pub fn nominal_mm(&self, command: &Command) -> [f64; 2] {
        let place = command.linear_mm + command.tool_mm - self.spindle.centre_mm;
        [place.x, place.z]
    }

    /// Mean radius and Z of the surface that a command leaves, mm. Equation (73).
    ///
    /// `r = √(x² + y²)` of [`Self::seen_along_axis`], with the sign of x: a tool beyond the axis cuts at −r. Error motions
    /// have mean zero over a turn and change the mean radius in second order, `a²/4r` for an amplitude `a`; what they do is in
    /// [`Self::section`].
    #[must_use]
    pub fn turned_mm(&self, command: &Command) -> [f64; 2] {
        let seen = self.seen_along_axis(command);
        [math::hypot(seen.x, seen.y).copysign(seen.x), seen.z]
    }

    /// The surface that the tool leaves over a turn at one command, as points in the workpiece's frame. Equation (72).
    ///
    /// * `angles` – number of spindle angles, evenly over a turn
    #[must_use]
    pub fn section(&self, command: &Command, angles: usize) -> Section {
        let seen = self.seen_along_axis(command);
        let at = |k: usize| std::f64::consts::TAU * k as f64 / angles as f64;
        Section::new((0..angles).map(|k| self.spindle.seen_from_workpiece(&seen, at(k))).collect())
    }

    /// Within this distance from the axis, four times the largest height of the tip in the volume, the radius is not
    /// promised, mm: there the tip's height bends the path more than X can undo, and X 0 stays X 0.
    #[must_use]
    pub fn near_axis_mm(&self) -> f64 {
        self.near_axis_mm
    }

    /// What the tip's distance from the axis' plane adds to the radius, mm; near the axis what is left of it evenly.
    fn by_height_mm(&self, x: f64, y: f64) -> f64 {
        let near = self.near_axis_mm;
        if near == 0.0 {
            0.0
        } else if x.abs() >= near {
            (math::hypot(x, y) - x.abs()).copysign(x)
        } else {
            x / near * (math::hypot(near, y) - near)
        }
    }

    fn inside(&self, command: &Command) -> Command {
        Command { linear_mm: self.volume().nearest(&command.linear_mm), ..*command }
    }

    /// Bound of [`PathModel::chord_bound_mm`] for the part of [`Self::by_height_mm`].
    ///
    /// `w(X, Y)` with |w_X| ≤ Y²/2m², |w_Y| ≤ Y/m, |w_XX| ≤ Y²/m³, |w_XY| ≤ Y/m², |w_YY| ≤ 1/m for |X| ≥ m, and for the even
    /// part near the axis with m its reach. X and Y leave their chords by `bow` at most, which w passes on by its slopes; along
    /// the chords w bends by an eighth of its second derivative. Where the even part begins the slope jumps by Y²/m² at most.
    fn height_chord_bound_mm(&self, stretch: &Move, bow_mm: f64) -> f64 {
        let near = self.near_axis_mm;
        if near == 0.0 {
            return 0.0;
        }
        let across = |axis: usize| {
            let mut speed_mm = [0.0; 3];
            speed_mm[axis] = stretch.range_mm[axis].high - stretch.range_mm[axis].low;
            self.linear.chord_bound_mm(&Move { speed_mm, acceleration_mm: [0.0; 3], passes: 1, ..*stretch })
        };
        // Anywhere in the box the error lies this near to what its corners span.
        let within = across(0) + across(2) + 2.0 * self.bending_bow_mm(stretch);
        let corner = |k: usize| {
            let end = |range: Range, high: bool| if high { range.high } else { range.low };
            let [x, y, z] = stretch.range_mm;
            let linear_mm = Vector::new(end(x, k & 1 == 1), y.low, end(z, k & 2 == 2));
            self.seen_along_axis(&Command { linear_mm, ..stretch.state })
        };
        let corners = [0, 1, 2, 3].map(corner);
        let span = |axis: usize| {
            let values = corners.map(|c| c[axis]);
            let low = values.into_iter().fold(f64::INFINITY, f64::min) - within;
            (low, values.into_iter().fold(f64::NEG_INFINITY, f64::max) + within)
        };
        let ((x_low, x_high), (y_low, y_high)) = (span(0), span(1));
        let nearest = if x_low > 0.0 { x_low } else { (-x_high).max(0.0) };
        let (m, y) = (nearest.max(near), y_low.abs().max(y_high.abs()));
        let [ax, _, az] = stretch.acceleration_mm;
        let bow = bow_mm + (ax + az) / 8.0;
        let (dx, dy) = (x_high - x_low, y_high - y_low);
        let bent = (y * y / (2.0 * m * m) + y / m) * bow
            + (dx * dx * y * y / (m * m * m) + 2.0 * dx * dy * y / (m * m) + dy * dy / m) / 8.0;
        let kinks =
            if nearest <= near { y * y / (m * m) * dx * f64::from(stretch.passes) / 2.0 } else { 0.0 };
        (bent + kinks).min(y * y / m)
    }

    /// How far the bending can leave its chord.
    fn bending_bow_mm(&self, stretch: &Move) -> f64 {
        if self.bending.is_none() {
            return 0.0;
        }
        let tool = stretch.state.tool_mm;
        let ends = [stretch.range_mm[2].low, stretch.range_mm[2].high].map(|z| z + tool.z - self.chuck_mm.z);
        // Errors and the tilt of the axis shift where the tool stands along the bar.
        let slack =
            SLACK_MM + (self.to_axis - Matrix3::identity()).norm() * (ends[0].abs().max(ends[1].abs()) + 1e3);
        let bounds = self.bending.bounds(Range { low: ends[0] - slack, high: ends[1] + slack });
        let speed = stretch.speed_mm[2] * (1.0 + GRADIENT) + stretch.speed_mm[0] * GRADIENT;
        let bent = (bounds.curvature * speed * speed + bounds.slope * stretch.acceleration_mm[2]) / 8.0
            + bounds.kinks * speed * f64::from(stretch.passes) / 4.0;
        bent.min(2.0 * bounds.value)
    }
}

/// No lathe that is worth correcting errs by more than this, mm, nor changes its error faster per mm.
const SLACK_MM: f64 = 1.0;
const GRADIENT: f64 = 0.02;

impl Engine for Lathe {
    fn id(&self) -> EngineId {
        EngineId::RigidBody
    }

    fn volume(&self) -> Volume {
        self.linear.volume()
    }

    fn solve(&self, target: &Command) -> Result<Solution, SolveError> {
        solve(&target.linear_mm, &self.volume(), |q| self.error_mm(&Command { linear_mm: *q, ..*target }))
    }

    fn path_model(&self) -> Option<&dyn PathModel> {
        Some(self)
    }
}

impl PathModel for Lathe {
    /// Radius and Z of the turned surface less the programmed ones, in X and Z. Equation (73).
    fn error_mm(&self, command: &Command) -> Vector {
        let inside = self.inside(command);
        let seen = self.seen_along_axis(&inside);
        let [x, z] = self.nominal_mm(&inside);
        Vector::new(seen.x - x + self.by_height_mm(seen.x, seen.y), 0.0, seen.z - z)
    }

    fn chord_bound_mm(&self, stretch: &Move) -> f64 {
        let bow = self.linear.chord_bound_mm(stretch) + self.bending_bow_mm(stretch);
        bow + self.height_chord_bound_mm(stretch, bow)
    }

    fn depends_on_direction(&self) -> bool {
        self.linear.depends_on_direction()
    }

    fn reversal_mm(&self, axis: usize, command: &Command) -> f64 {
        self.linear.reversal_mm(axis, command)
    }
}
