//! The one rule: reading = prediction of the base with its change + set-up + noise; equations (51) to (51c).
//!
//! The change of a linear axis is six functions, straight between nodes, and its play. It is added to the base's own tables and
//! the base's own forward model predicts with it, so whatever the base holds (angles, squareness, effects, measured lines,
//! rotary axes) is in the prediction once. Set-ups are exact: a rotation and a shift per run, or the place and the zero of a
//! station. Nothing but the change is fitted: a machine measured from its own profile changes by nothing.

use diagnostic::{Speaks, Text, both};
use std::ops::Range;

use machine_model::rotation::{of_any_size, turned_by};
use machine_model::{
    AxisTables, Chain, Command, Description, Interpolation, LinearAxis, Range as Travel, RigidBody,
    RotaryAxis, Six, Squareness, Table, Vector,
};
use nalgebra::{DMatrix, DVector, Matrix3};

use crate::adjustment::{Estimate, Jacobian, Noise, Problem, adjust};
use crate::error::{CalibrationError, LETTERS};
use crate::field;
use crate::rigid_motion::RigidMotion;

/// What was read at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointReading {
    /// Measured minus commanded tool position per component, mm; `None` where not measured.
    Deviation([Option<f64>; 3]),
    /// Measured position per component, instrument frame, mm; `None` where not measured.
    Position([Option<f64>; 3]),
    /// Distance from a station, mm, and where the station is thought to be, mm.
    Distance {
        /// Reading.
        length_mm: f64,
        /// Station, machine coordinates.
        station_mm: Vector,
    },
}

/// One measured point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Run: points of one run share the instrument's set-up.
    pub run: usize,
    /// What the axes were told, the tool that was measured, and the sides they came from.
    pub command: Command,
    /// What effects of the base beyond its tables do here, mm, workpiece frame.
    pub by_effects_mm: Vector,
    /// What was read.
    pub reading: PointReading,
    /// Standard uncertainty of the reading, mm, where known.
    pub uncertainty_mm: Option<f64>,
}

impl Point {
    /// A point of a machine with linear axes and no effects, approached from nowhere in particular.
    #[must_use]
    pub fn new(run: usize, commanded_mm: Vector, tool_mm: Vector, reading: PointReading) -> Self {
        let command = Command { linear_mm: commanded_mm, tool_mm, ..Default::default() };
        Self { run, command, by_effects_mm: Vector::zeros(), reading, uncertainty_mm: None }
    }
}

/// The machine as it was known before.
#[derive(Clone, Debug)]
pub struct Base {
    /// Its geometry.
    pub description: Description,
    /// What lies between the nodes of its tables.
    pub interpolation: Interpolation,
    /// False where nothing but the chain is known.
    pub is_known: bool,
}

impl Base {
    /// A machine of which nothing but the chain is known.
    #[must_use]
    pub fn bare(chain: Chain) -> Self {
        let everywhere = Travel { low: f64::NEG_INFINITY, high: f64::INFINITY };
        let linear = [0; 3].map(|_| LinearAxis::perfect(everywhere));
        let rotary = [0; 3].map(|_| RotaryAxis::perfect(Vector::zeros()));
        let description = Description { chain, linear, rotary, squareness: Squareness::default() };
        Self { description, interpolation: Interpolation::Linear, is_known: false }
    }

    pub(crate) fn machine(&self) -> Result<RigidBody, CalibrationError> {
        RigidBody::new(self.description.clone()).map_err(|error| CalibrationError::Axes(error.text()))
    }

    /// Place in the chain, 0 next to the workpiece.
    fn place(&self, axis: usize) -> usize {
        self.description.chain.linear().iter().position(|a| a.direction() == axis).unwrap_or(0)
    }
}

/// What is to be found.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Plan {
    /// Nodes of the change of X, Y, Z, mm.
    pub(crate) nodes_mm: [Vec<f64>; 3],
    /// Functions that may change: none, EX EY EZ, or all six.
    pub(crate) functions: usize,
    /// The instrument may be turned against the machine.
    pub(crate) turned: bool,
}

/// One group of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Group {
    /// Axis and function (0 to 5: EX EY EZ EA EB EC).
    Function(usize, usize),
    /// Play of an axis.
    Play(usize),
    /// Set-up of a run.
    Run(usize),
}

impl Group {
    fn name(self) -> Text {
        match self {
            Self::Function(axis, f) => {
                Text::same(format!("E{}{}", ['X', 'Y', 'Z', 'A', 'B', 'C'][f], LETTERS[axis]))
            }
            Self::Play(axis) => both!("the play of {}", "люфт {}", LETTERS[axis]),
            Self::Run(_) => Text::pair("the set-up", "установка прибора"),
        }
    }
}

/// How the instrument stood in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SetUp {
    /// Measured = turn · machine + shift.
    Frame(RigidMotion),
    /// A station's place in the machine frame and the zero of its length, mm.
    Station {
        /// Place.
        place_mm: Vector,
        /// Reading at distance zero.
        zero_mm: f64,
    },
}

/// An axis as changed, ready to be written.
#[derive(Clone, Debug, PartialEq)]
pub struct ChangedAxis {
    /// Nodes, mm.
    pub positions_mm: Vec<f64>,
    /// `EX EY EZ` in mm, `EA EB EC` in rad: as in [`LinearAxis::errors`].
    pub errors: Vec<Six>,
    /// As in [`LinearAxis::errors_negative`].
    pub negative: Option<Vec<Six>>,
    /// Which of the six the base has or the readings gave.
    pub given: [bool; 6],
}

/// One reading as a row of the adjustment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct RowOrigin {
    /// Index of the point.
    pub point: usize,
    /// 0 X, 1 Y, 2 Z; `None` for a distance.
    pub component: Option<usize>,
}

/// A change found.
#[derive(Clone, Debug)]
pub(crate) struct Found {
    pub(crate) layout: Layout,
    pub(crate) estimate: Estimate,
    /// The machine parameters, set-up apart.
    pub(crate) values: DVector<f64>,
    pub(crate) setups: Vec<Option<SetUp>>,
    /// Functions that keep what the base says as far as the readings cannot tell them, and from what.
    pub(crate) open: Vec<(Text, Text)>,
    pub(crate) rows: Vec<RowOrigin>,
}

/// Where which parameter stands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    pub(crate) plan: Plan,
    pub(crate) groups: Vec<(Group, Range<usize>)>,
    pub(crate) count: usize,
    /// Of each axis: positions of its changed tables, mm.
    positions_mm: [Vec<f64>; 3],
}

impl Layout {
    fn new(plan: &Plan, base: &Base, points: &[Point]) -> Self {
        let mut groups = Vec::new();
        let mut count = 0;
        let mut add = |group: Group, size: usize| {
            groups.push((group, count..count + size));
            count += size;
        };
        for axis in 0..3 {
            for f in 0..plan.functions {
                add(Group::Function(axis, f), plan.nodes_mm[axis].len());
            }
        }
        for axis in (0..3).filter(|_| plan.functions > 0) {
            let from = |sign: i8| points.iter().any(|p| p.command.direction[axis].signum() == sign);
            // From one side alone play is nothing but a constant.
            if from(1) && from(-1) {
                add(Group::Play(axis), 1);
            }
        }
        for run in 0..points.iter().map(|p| p.run + 1).max().unwrap_or(0) {
            let own = || points.iter().filter(|p| p.run == run);
            if own().next().is_none() {
                continue;
            }
            let station = own().any(|p| matches!(p.reading, PointReading::Distance { .. }));
            add(
                Group::Run(run),
                if station {
                    4
                } else if plan.turned {
                    6
                } else {
                    3
                },
            );
        }
        let of_axis =
            |axis: usize| positions(&base.description.linear[axis], &plan.nodes_mm[axis], base.interpolation);
        Self { plan: plan.clone(), groups, count, positions_mm: std::array::from_fn(of_axis) }
    }

    pub(crate) fn at(&self, group: Group) -> Option<Range<usize>> {
        self.groups.iter().find(|(own, _)| *own == group).map(|(_, range)| range.clone())
    }

    /// Change of a function at `q`, mm or rad.
    fn change(&self, values: &DVector<f64>, axis: usize, function: usize, q: f64) -> f64 {
        let Some(range) = self.at(Group::Function(axis, function)) else { return 0.0 };
        let weights = hats(&self.plan.nodes_mm[axis], q);
        weights.into_iter().map(|(node, weight)| weight * values[range.start + node]).sum()
    }

    pub(crate) fn play(&self, values: &DVector<f64>, axis: usize) -> f64 {
        self.at(Group::Play(axis)).map_or(0.0, |range| values[range.start])
    }

    /// Rows that say what no reading can: the gauge.
    fn gauge(&self, base: &Base) -> Vec<DVector<f64>> {
        let mut rows = Vec::new();
        for (group, range) in &self.groups {
            let Group::Function(axis, f) = *group else { continue };
            let nodes = &self.plan.nodes_mm[axis];
            let mean = nodes.iter().sum::<f64>() / nodes.len() as f64;
            let mut hold = |weight: &dyn Fn(f64) -> f64| {
                let mut row = DVector::zeros(self.count);
                for (k, q) in nodes.iter().enumerate() {
                    row[range.start + k] = weight(*q);
                }
                rows.push(row);
            };
            // A constant shift of any axis is a shift of the instrument; a constant angle of an axis turns the next axes' lines.
            if f < 3 || base.place(axis) < 2 {
                hold(&|_| 1.0);
            }
            // The lines of X and of Y say how the instrument is turned: X along its line, Y in its plane.
            if self.plan.turned && LINES.contains(&(axis, f)) {
                hold(&|q| q - mean);
            }
        }
        rows
    }
}

/// Straightness functions (axis, function) whose slope is the instrument's rotation: EYX, EZX, EZY.
const LINES: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// Straightness functions whose slope is a squareness, and its sign: EC0Y, EB0Z, EA0Z; equation (5).
const ANGLES: [(usize, usize, f64); 3] = [(1, 0, -1.0), (2, 0, 1.0), (2, 1, -1.0)];

/// Nodes with a share in the value at `q`, and the shares: straight lines, the ends kept beyond.
fn hats(nodes: &[f64], q: f64) -> Vec<(usize, f64)> {
    let last = nodes.len() - 1;
    if q <= nodes[0] {
        return vec![(0, 1.0)];
    }
    if q >= nodes[last] {
        return vec![(last, 1.0)];
    }
    let above = nodes.partition_point(|node| *node <= q);
    let part = (q - nodes[above - 1]) / (nodes[above] - nodes[above - 1]);
    vec![(above - 1, 1.0 - part), (above, part)]
}

/// Positions on which the base's tables with a change are the same curves as before where nothing changed.
fn positions(axis: &LinearAxis, nodes: &[f64], interpolation: Interpolation) -> Vec<f64> {
    /// Table nodes nearer than this are one, mm.
    const SAME_MM: f64 = 1e-6;
    /// Below what is written: mm, and rad for angles.
    const SAME_CURVE: [f64; 2] = [5e-6, 5e-9];
    /// A cubic sampled sixteen times finer is the same to all that matters.
    const MOST_HALVINGS: usize = 4;
    let tables: Vec<&AxisTables> = [&axis.errors, &axis.errors_negative].into_iter().flatten().collect();
    let range = axis.calibrated_mm();
    let mut all: Vec<f64> = tables.iter().flat_map(|t| t.nodes()).chain(nodes).copied().collect();
    all.retain(|q| tables.is_empty() || range.contains(*q));
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| *a - *b < SAME_MM);
    for _ in 0..MOST_HALVINGS {
        let same = |table: &&AxisTables| {
            let rows: Vec<Six> = all.iter().map(|q| table.at(*q)).collect();
            let Some(again) = tables_of(&all, &rows, interpolation) else { return true };
            all.windows(2).all(|w| {
                [0.25, 0.5, 0.75].iter().all(|part| {
                    let q = w[0] + (w[1] - w[0]) * part;
                    let (a, b) = (table.at(q), again.at(q));
                    (0..6).all(|i| (a[i] - b[i]).abs() < SAME_CURVE[i / 3])
                })
            })
        };
        if tables.iter().all(same) {
            break;
        }
        let middles: Vec<f64> = all.windows(2).map(|w| 0.5 * (w[0] + w[1])).collect();
        all.extend(middles);
        all.sort_by(f64::total_cmp);
    }
    all
}

pub(crate) fn tables_of(positions: &[f64], rows: &[Six], interpolation: Interpolation) -> Option<AxisTables> {
    let function = |i: usize| {
        Table::new(positions.to_vec(), rows.iter().map(|row| row[i]).collect(), interpolation).ok()
    };
    AxisTables::new(&std::array::from_fn(function))
}

impl Found {
    /// Half width of the 95 % interval of a linear function of the parameters.
    pub(crate) fn half_width_95(&self, row: &DVector<f64>) -> f64 {
        self.estimate.coverage_factor_95() * self.estimate.variance_of(row).sqrt()
    }

    /// Change of the squareness k (EC0Y, EB0Z, EA0Z): the row that makes it of the parameters.
    fn angle_row(&self, k: usize) -> Option<DVector<f64>> {
        let (axis, function, sign) = ANGLES[k];
        let range = self.layout.at(Group::Function(axis, function))?;
        let nodes = &self.layout.plan.nodes_mm[axis];
        let mean = nodes.iter().sum::<f64>() / nodes.len() as f64;
        let spread: f64 = nodes.iter().map(|q| (q - mean) * (q - mean)).sum();
        let mut row = DVector::zeros(self.layout.count);
        for (k, q) in nodes.iter().enumerate() {
            row[range.start + k] = sign * (q - mean) / spread;
        }
        Some(row)
    }

    /// EC0Y, EB0Z, EA0Z of the changed machine and the half widths of their 95 % intervals, rad.
    pub(crate) fn squareness(&self, base: &Base) -> [(f64, f64); 3] {
        let known = base.description.squareness;
        [(0, known.ec0y_rad), (1, known.eb0z_rad), (2, known.ea0z_rad)].map(|(k, before)| {
            self.angle_row(k).map_or((before, 0.0), |row| {
                (before + row.dot(&self.estimate.values), self.half_width_95(&row))
            })
        })
    }

    /// The base with the change: every axis, the whole, and how the instrument stood against it. Slopes of EXY, EXZ and EYZ stand
    /// in the squareness.
    pub(crate) fn changed(&self, base: &Base) -> ([ChangedAxis; 3], Description, Vec<Option<SetUp>>) {
        let [c, b, a] = self.squareness(base).map(|(value, _)| value);
        let slopes =
            [0, 1, 2].map(|k| self.angle_row(k).map_or(0.0, |row| ANGLES[k].2 * row.dot(&self.values)));
        let axes = [0, 1, 2].map(|axis| axis_with(base, &self.layout, &self.values, axis, slopes));
        let squareness = Squareness { ec0y_rad: c, eb0z_rad: b, ea0z_rad: a };
        let description = described(base, &self.layout, &self.values, &axes, squareness);
        // A slope about the middle is a squareness about zero and this shift.
        let mut by = Vector::zeros();
        for ((axis, function, _), slope) in ANGLES.iter().zip(slopes) {
            let nodes = &self.layout.plan.nodes_mm[*axis];
            by[*function] += slope * nodes.iter().sum::<f64>() / nodes.len() as f64;
        }
        let shifted = |setup: &SetUp| match *setup {
            SetUp::Frame(motion) => {
                SetUp::Frame(RigidMotion { shift_mm: motion.shift_mm - motion.turn * by, ..motion })
            }
            SetUp::Station { place_mm, zero_mm } => SetUp::Station { place_mm: place_mm + by, zero_mm },
        };
        let setups = self.setups.iter().map(|setup| setup.as_ref().map(shifted)).collect();
        (axes, description, setups)
    }
}

/// One axis of the base with the change of these parameters, slopes of EXY, EXZ, EYZ taken off.
fn axis_with(
    base: &Base,
    layout: &Layout,
    values: &DVector<f64>,
    axis: usize,
    slopes: [f64; 3],
) -> ChangedAxis {
    let linear = &base.description.linear[axis];
    let positions_mm = layout.positions_mm[axis].clone();
    let nodes = &layout.plan.nodes_mm[axis];
    let mean = nodes.iter().sum::<f64>() / nodes.len() as f64;
    let rows = |tables: Option<&AxisTables>, play: f64| -> Vec<Six> {
        let row = |q: &f64| {
            let mut six = tables.map_or([0.0; 6], |t| t.at(*q));
            for (f, value) in six.iter_mut().enumerate() {
                *value += layout.change(values, axis, f, *q);
            }
            six[axis] += play;
            for ((moving, function, _), slope) in ANGLES.iter().zip(slopes) {
                if *moving == axis {
                    six[*function] -= slope * (q - mean);
                }
            }
            six
        };
        positions_mm.iter().map(row).collect()
    };
    // Two tables hold the play themselves.
    let half = if linear.errors_negative.is_some() { 0.5 * layout.play(values, axis) } else { 0.0 };
    let errors = rows(linear.errors.as_ref(), -half);
    let negative = linear.errors_negative.as_ref().map(|tables| rows(Some(tables), half));
    let given = std::array::from_fn(|f| {
        f < 3 || errors.iter().chain(negative.iter().flatten()).any(|row| row[f] != 0.0)
    });
    ChangedAxis { positions_mm, errors, negative, given }
}

/// The base with these axes.
fn described(
    base: &Base,
    layout: &Layout,
    values: &DVector<f64>,
    axes: &[ChangedAxis; 3],
    squareness: Squareness,
) -> Description {
    let mut description = Description { squareness, ..base.description.clone() };
    for (axis, (own, linear)) in axes.iter().zip(&mut description.linear).enumerate() {
        linear.errors = tables_of(&own.positions_mm, &own.errors, base.interpolation);
        let negative = own.negative.as_ref();
        linear.errors_negative =
            negative.and_then(|rows| tables_of(&own.positions_mm, rows, base.interpolation));
        if own.negative.is_none() {
            linear.backlash_mm += layout.play(values, axis);
        }
    }
    description
}

/// The base with the change of these parameters.
fn machine_with(base: &Base, layout: &Layout, values: &DVector<f64>) -> Option<RigidBody> {
    if layout.plan.functions == 0 {
        return base.machine().ok();
    }
    let axes = [0, 1, 2].map(|axis| axis_with(base, layout, values, axis, [0.0; 3]));
    RigidBody::new(described(base, layout, values, &axes, base.description.squareness)).ok()
}

/// Everything of the adjustment that does not depend on the parameters.
struct Geometry {
    /// Of each point: displacement by a unit of each of the eighteen functions at the ideal machine.
    by_function: Vec<[[Vector; 6]; 3]>,
    /// Of each point: its ideal position.
    ideal_mm: Vec<Vector>,
}

/// The machine without errors, its measured lines kept: levers count from them.
fn ideal(base: &Base) -> Description {
    let everywhere = Travel { low: -1e7, high: 1e7 };
    let mut ideal = base.description.clone();
    ideal.squareness = Squareness::default();
    for axis in &mut ideal.linear {
        let perfect = LinearAxis::perfect(everywhere);
        *axis = LinearAxis {
            measured_at_mm: axis.measured_at_mm,
            measured_tool_mm: axis.measured_tool_mm,
            ..perfect
        };
    }
    for axis in &mut ideal.rotary {
        *axis = RotaryAxis::perfect(axis.centre_mm);
    }
    ideal
}

impl Geometry {
    fn new(base: &Base, commands: &[Command]) -> Result<Self, CalibrationError> {
        /// Errors are linear in a translation; of an angle the third order is left, 2e-9 of the first.
        const STEPS: [f64; 2] = [1.0, 1e-4];
        let ideal = ideal(base);
        let build = |description: Description| {
            RigidBody::new(description).map_err(|error| CalibrationError::Axes(error.text()))
        };
        let machine = build(ideal.clone())?;
        let ideal_mm: Vec<Vector> = commands.iter().map(|c| machine.predict(c).position_mm).collect();
        let mut by_function = vec![[[Vector::zeros(); 6]; 3]; commands.len()];
        for axis in 0..3 {
            for f in 0..6 {
                let step = STEPS[f / 3];
                let with = |by: f64| {
                    let mut description = ideal.clone();
                    let mut six = [0.0; 6];
                    six[f] = by;
                    let range = description.linear[axis].travel_mm;
                    description.linear[axis].errors = Some(AxisTables::constant(range, six));
                    build(description)
                };
                let (up, down) = (with(step)?, with(-step)?);
                for (own, command) in by_function.iter_mut().zip(commands) {
                    own[axis][f] =
                        (up.predict(command).error_mm - down.predict(command).error_mm) / (2.0 * step);
                }
            }
        }
        Ok(Self { by_function, ideal_mm })
    }
}

impl Layout {
    /// Displacements of the tool at a command by a unit of each machine parameter, ideal geometry.
    fn displacements(&self, command: &Command, by_function: &[[Vector; 6]; 3]) -> Vec<(usize, Vector)> {
        let mut out = Vec::new();
        for (group, range) in &self.groups {
            match *group {
                Group::Function(axis, f) => {
                    for (node, weight) in hats(&self.plan.nodes_mm[axis], command.linear_mm[axis]) {
                        out.push((range.start + node, by_function[axis][f] * weight));
                    }
                }
                Group::Play(axis) => {
                    let side = f64::from(command.direction[axis].signum());
                    out.push((range.start, by_function[axis][axis] * (-0.5 * side)));
                }
                Group::Run(_) => {}
            }
        }
        out
    }

    /// Half width that 95 % of the volume's points keep, mm: equation (51c).
    ///
    /// * `commands` – by group of points that share a frame
    pub(crate) fn field_u95_mm(
        &self,
        base: &Base,
        estimate: &Estimate,
        groups: &[Vec<Command>],
    ) -> Result<f64, CalibrationError> {
        let mut spreads = Vec::new();
        for commands in groups {
            let geometry = Geometry::new(base, commands)?;
            let mut rows = DMatrix::zeros(3 * commands.len(), self.count);
            for (k, command) in commands.iter().enumerate() {
                for (parameter, moved) in self.displacements(command, &geometry.by_function[k]) {
                    for i in 0..3 {
                        rows[(3 * k + i, parameter)] = moved[i];
                    }
                }
            }
            spreads.extend(field::spreads(&geometry.ideal_mm, rows, &estimate.covariance));
        }
        Ok(field::quantile_of_points(&spreads) * estimate.coverage_factor_95() / crate::quantile_95(None))
    }
}

/// Fits the change: equation (51).
///
/// # Errors
/// [`CalibrationError`], also where the readings do not settle a function that moves the tool itself.
pub(crate) fn find(points: &[Point], base: &Base, plan: &Plan) -> Result<Found, CalibrationError> {
    /// Hundredths of a nanometre.
    const SETTLED_MM: f64 = 1e-8;
    const FIRST_STEPS: usize = 4;
    const MOST_ROUNDS: usize = 8;
    let has_stations = points.iter().any(|p| matches!(p.reading, PointReading::Distance { .. }));
    let layout = Layout::new(plan, base, points);
    let commands: Vec<Command> = points.iter().map(|p| p.command).collect();
    let geometry = Geometry::new(base, &commands)?;
    let rows = rows(points);
    if rows.is_empty() || 2 * rows.len() < layout.count {
        return Err(CalibrationError::TooFew(both!(
            "{} readings for {} unknowns",
            "отсчётов {} на {} неизвестных",
            rows.len(),
            layout.count
        )));
    }
    let readings = DVector::from_fn(rows.len(), |i, _| value(&points[rows[i].point], rows[i].component));
    let known: Option<Vec<f64>> = rows.iter().map(|row| points[row.point].uncertainty_mm).collect();
    let noise = known.as_deref().map_or(Noise::Common, Noise::Known);
    let mut setups = first_setups(points, base, &geometry.ideal_mm, plan)?;
    let mut gauge = layout.gauge(base);
    let mut open = Vec::new();
    let mut values = DVector::zeros(layout.count);
    let mut round = 0;
    let estimate = loop {
        let design = design(points, &layout, &geometry, &setups, &rows);
        let forward = |x: &DVector<f64>| match machine_with(base, &layout, x) {
            None => DVector::from_element(rows.len(), f64::NAN),
            Some(machine) => predicted(&machine, points, &rows, &layout, &setups, &geometry, x),
        };
        let held = DMatrix::from_fn(gauge.len(), layout.count, |i, k| gauge[i][k]);
        let problem = Problem {
            readings: &readings,
            noise,
            forward: &forward,
            jacobian: Jacobian::Constant(&design),
            gauge: &held,
            // Directions to a station are known once it stands where it is: until then one step at a time.
            settled: if has_stations && round < FIRST_STEPS { f64::INFINITY } else { SETTLED_MM },
        };
        let found = adjust(&problem, &values).map_err(|error| {
            let error = error.text();
            CalibrationError::Axes(both!(
                "the readings fit no machine of this chain: {error}",
                "показания не подходят никакому станку с такой цепью: {error:#}"
            ))
        })?;
        if !found.open.is_empty() {
            hold_back(&layout, base, &design, &found.open, &mut gauge, &mut open)?;
            continue;
        }
        // Set-ups into their exact place, and once more from there until they stay.
        let moved = take(&layout, &found.values, &mut setups, &geometry, points);
        values = found.values.clone();
        for (group, range) in &layout.groups {
            if matches!(group, Group::Run(_)) {
                values.rows_mut(range.start, range.len()).fill(0.0);
            }
        }
        round += 1;
        let last_steps = !has_stations || round > FIRST_STEPS;
        if last_steps && (moved < 1e-6 || round >= MOST_ROUNDS) {
            break found;
        }
    };
    Ok(Found { layout, estimate, values, setups, open, rows })
}

/// Readings of the points, row by row.
pub(crate) fn rows(points: &[Point]) -> Vec<RowOrigin> {
    let mut rows = Vec::new();
    for (point, p) in points.iter().enumerate() {
        match p.reading {
            PointReading::Distance { .. } => rows.push(RowOrigin { point, component: None }),
            PointReading::Deviation(d) | PointReading::Position(d) => {
                let given = (0..3).filter(|i| d[*i].is_some());
                rows.extend(given.map(|i| RowOrigin { point, component: Some(i) }));
            }
        }
    }
    rows
}

fn value(point: &Point, component: Option<usize>) -> f64 {
    match (point.reading, component) {
        (PointReading::Deviation(d) | PointReading::Position(d), Some(i)) => d[i].unwrap_or(0.0),
        (PointReading::Distance { length_mm, .. }, _) => length_mm,
        _ => 0.0,
    }
}

/// Where the instrument saw the tool, mm; `None` where a component is missing.
pub(crate) fn seen_mm(point: &Point, nominal: &Vector) -> Option<Vector> {
    match point.reading {
        PointReading::Deviation([Some(x), Some(y), Some(z)]) => Some(nominal + Vector::new(x, y, z)),
        PointReading::Position([Some(x), Some(y), Some(z)]) => Some(Vector::new(x, y, z)),
        _ => None,
    }
}

/// The set-ups that the base alone says.
fn first_setups(
    points: &[Point],
    base: &Base,
    nominal: &[Vector],
    plan: &Plan,
) -> Result<Vec<Option<SetUp>>, CalibrationError> {
    let machine = base.machine()?;
    let runs = points.iter().map(|p| p.run + 1).max().unwrap_or(0);
    let one = |run: usize| {
        let own = || points.iter().zip(nominal).filter(|(p, _)| p.run == run);
        if let Some(place_mm) = own().find_map(|(p, _)| match p.reading {
            PointReading::Distance { station_mm, .. } => Some(station_mm),
            _ => None,
        }) {
            return Some(SetUp::Station { place_mm, zero_mm: 0.0 });
        }
        own().next()?;
        let pairs: Option<Vec<(Vector, Vector)>> = own()
            .map(|(p, nominal)| {
                Some((machine.predict(&p.command).position_mm + p.by_effects_mm, seen_mm(p, nominal)?))
            })
            .collect();
        let (from, to): (Vec<Vector>, Vec<Vector>) = pairs.unwrap_or_default().into_iter().unzip();
        let mut motion = RigidMotion::nearest(&from, &to);
        if !plan.turned && !from.is_empty() {
            let shift = |all: &[Vector]| all.iter().sum::<Vector>() / all.len() as f64;
            motion = RigidMotion { turn: Matrix3::identity(), shift_mm: shift(&to) - shift(&from) };
        }
        Some(SetUp::Frame(motion))
    };
    Ok((0..runs).map(one).collect())
}

/// Mean ideal place of a run: turning about it moves its points least.
fn centre(run: usize, points: &[Point], geometry: &Geometry) -> Vector {
    let own = || points.iter().zip(&geometry.ideal_mm).filter(|(p, _)| p.run == run);
    own().map(|(_, at)| at).sum::<Vector>() / own().count().max(1) as f64
}

/// What is read of a machine with these set-ups, row by row.
fn predicted(
    machine: &RigidBody,
    points: &[Point],
    rows: &[RowOrigin],
    layout: &Layout,
    setups: &[Option<SetUp>],
    geometry: &Geometry,
    x: &DVector<f64>,
) -> DVector<f64> {
    let centres: Vec<Vector> = (0..setups.len()).map(|run| centre(run, points, geometry)).collect();
    let own = |run: usize, k: usize| {
        layout.at(Group::Run(run)).filter(|range| k < range.len()).map_or(0.0, |range| x[range.start + k])
    };
    let three = |run: usize, from: usize| Vector::from_fn(|i, _| own(run, from + i));
    // A position in the instrument's frame, or a distance in all three components.
    let seen: Vec<Vector> = points
        .iter()
        .map(|p| {
            let at = machine.predict(&p.command).position_mm + p.by_effects_mm;
            match setups[p.run] {
                Some(SetUp::Frame(motion)) => {
                    let turned = at + turned_by(&three(p.run, 3), &(at - centres[p.run]));
                    motion.apply(&turned) + three(p.run, 0)
                }
                Some(SetUp::Station { place_mm, zero_mm }) => {
                    let far = (at - place_mm - three(p.run, 0)).norm() + zero_mm + own(p.run, 3);
                    Vector::from_element(far)
                }
                None => Vector::from_element(f64::NAN),
            }
        })
        .collect();
    DVector::from_fn(rows.len(), |i, _| {
        let RowOrigin { point, component } = rows[i];
        let component = component.unwrap_or(0);
        let zero = match points[point].reading {
            PointReading::Deviation(_) => geometry.ideal_mm[point][component],
            PointReading::Position(_) | PointReading::Distance { .. } => 0.0,
        };
        seen[point][component] - zero
    })
}

/// Derivatives of the readings, errors taken as zero: what is the same there has to be decided by the gauge.
fn design(
    points: &[Point],
    layout: &Layout,
    geometry: &Geometry,
    setups: &[Option<SetUp>],
    rows: &[RowOrigin],
) -> DMatrix<f64> {
    let centres: Vec<Vector> = (0..setups.len()).map(|run| centre(run, points, geometry)).collect();
    let mut design = DMatrix::zeros(rows.len(), layout.count);
    for (i, row) in rows.iter().enumerate() {
        let p = &points[row.point];
        let at = geometry.ideal_mm[row.point];
        let Some(run) = layout.at(Group::Run(p.run)) else { continue };
        let direction = match setups[p.run] {
            Some(SetUp::Frame(motion)) => {
                let component = row.component.unwrap_or(0);
                let direction = motion.turn.row(component).transpose();
                design[(i, run.start + component)] = 1.0;
                let turn = (at - centres[p.run]).cross(&direction);
                for k in 3..run.len() {
                    design[(i, run.start + k)] = turn[k - 3];
                }
                direction
            }
            Some(SetUp::Station { place_mm, .. }) => {
                let direction = (at - place_mm).normalize();
                for k in 0..3 {
                    design[(i, run.start + k)] = -direction[k];
                }
                design[(i, run.start + 3)] = 1.0;
                direction
            }
            None => continue,
        };
        for (parameter, moved) in layout.displacements(&p.command, &geometry.by_function[row.point]) {
            design[(i, parameter)] = direction.dot(&moved);
        }
    }
    design
}

/// Set-ups by the steps found; the largest move of a point by them, mm.
fn take(
    layout: &Layout,
    x: &DVector<f64>,
    setups: &mut [Option<SetUp>],
    geometry: &Geometry,
    points: &[Point],
) -> f64 {
    let mut largest: f64 = 0.0;
    for (run, setup) in setups.iter_mut().enumerate() {
        let (Some(setup), Some(range)) = (setup.as_mut(), layout.at(Group::Run(run))) else { continue };
        let step = Vector::from_fn(|i, _| x[range.start + i]);
        match setup {
            SetUp::Frame(motion) => {
                let by = if range.len() == 6 {
                    Vector::from_fn(|i, _| x[range.start + 3 + i])
                } else {
                    Vector::zeros()
                };
                let (turn, about) = (of_any_size(&by), centre(run, points, geometry));
                motion.shift_mm += step + motion.turn * (about - turn * about);
                motion.turn *= turn;
                largest = largest.max(by.norm());
            }
            SetUp::Station { place_mm, zero_mm } => {
                *place_mm += step;
                *zero_mm += x[range.start + 3];
                // A place that moves turns the directions of its distances.
                largest = largest.max(step.norm() * 1e-3);
            }
        }
    }
    largest
}

/// Holds at the base what the readings leave open, last axes and angles first; refuses where that would be a function that moves
/// the tool itself.
fn hold_back(
    layout: &Layout,
    base: &Base,
    design: &DMatrix<f64>,
    combinations: &[DVector<f64>],
    gauge: &mut Vec<DVector<f64>>,
    open: &mut Vec<(Text, Text)>,
) -> Result<(), CalibrationError> {
    /// Shares of unit vectors below this are rounding.
    const SHARE: f64 = 1e-3;
    let share = |range: &Range<usize>| {
        combinations.iter().map(|c| c.rows(range.start, range.len()).norm_squared()).fold(0.0, f64::max)
    };
    let unseen = |range: &Range<usize>| range.clone().all(|k| design.column(k).norm() == 0.0);
    // What a correction can do without soonest: what no reading shows, then angles of the axis nearest the tool.
    let rank = |group: Group, range: &Range<usize>| match group {
        _ if unseen(range) => 100,
        Group::Function(axis, f) if f >= 3 => 10 + base.place(axis),
        Group::Run(_) => 5,
        Group::Play(_) => 4,
        Group::Function(axis, _) => base.place(axis),
    };
    let concerned: Vec<&(Group, Range<usize>)> =
        layout.groups.iter().filter(|(_, range)| share(range) > SHARE).collect();
    let Some((victim, range)) = concerned.iter().copied().max_by_key(|(group, range)| rank(*group, range))
    else {
        return Err(CalibrationError::Unobservable(Text::pair(
            "any error from the set-up",
            "погрешности станка и установка прибора",
        )));
    };
    let mut rivals: Vec<Text> =
        concerned.iter().filter(|(group, _)| group != victim).map(|(group, _)| group.name()).collect();
    rivals.dedup();
    if matches!(victim, Group::Function(_, 0..3)) && !unseen(range) {
        let names: Vec<Text> = concerned.iter().map(|(group, _)| group.name()).collect();
        return Err(CalibrationError::TooFew(both!(
            "too few places for the functions asked: {} stay open at some of their {} nodes",
            "для этих функций мало мест: {:#} остаются открыты в некоторых из своих узлов ({})",
            Text::join(&names, ", "),
            range.len()
        )));
    }
    for combination in combinations {
        let mut row = DVector::zeros(layout.count);
        row.rows_mut(range.start, range.len()).copy_from(&combination.rows(range.start, range.len()));
        if row.norm_squared() > SHARE * SHARE {
            gauge.push(row);
        }
    }
    if !matches!(victim, Group::Run(_)) && open.iter().all(|(name, _)| *name != victim.name()) {
        open.push((victim.name(), Text::join(&rivals, ", ")));
    }
    Ok(())
}

impl Found {
    /// Readings minus predictions of other points of the same runs, mm.
    pub(crate) fn rest(&self, points: &[Point], base: &Base) -> Result<DVector<f64>, CalibrationError> {
        let commands: Vec<Command> = points.iter().map(|p| p.command).collect();
        let geometry = Geometry { ideal_mm: ideal_places(base, &commands)?, by_function: Vec::new() };
        let rows = rows(points);
        let Some(machine) = machine_with(base, &self.layout, &self.values) else {
            return Err(CalibrationError::Axes(Text::pair(
                "the tables and the travel of an axis have nothing in common",
                "у таблиц и хода одной из осей нет общей части",
            )));
        };
        let seen = predicted(&machine, points, &rows, &self.layout, &self.setups, &geometry, &self.values);
        Ok(DVector::from_fn(rows.len(), |i, _| value(&points[rows[i].point], rows[i].component) - seen[i]))
    }
}

/// Where an ideal machine of this kind would be, mm.
pub(crate) fn ideal_places(base: &Base, commands: &[Command]) -> Result<Vec<Vector>, CalibrationError> {
    let machine = RigidBody::new(ideal(base)).map_err(|error| CalibrationError::Axes(error.text()))?;
    Ok(commands.iter().map(|c| machine.predict(c).position_mm).collect())
}
