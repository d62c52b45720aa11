//! One axis read along a line, against all that the base says: equations (58) and (59).
//!
//! An instrument reads the motion of one point (the optics) along a line, from a zero and against a straightedge of its own. What the
//! whole base would have read there (tables, effects, angles, other axes, direction, temperature) is taken off; the rest is the
//! change of the axis' functions, and zero where nothing has changed, whatever the instrument's zero was.

use machine_model::{
    Axis, AxisTables, Command, Description, Interpolation, LinearAxis, Range, Six, Squareness, Table, Vector,
    WithEffects,
};

use nalgebra::{DMatrix, Matrix3};
use statrs::distribution::{ContinuousCDF, FisherSnedecor};

use crate::field;
use crate::functions::{Function, straight_line};
use crate::student::quantile_95;

/// Where an axis was read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredLine {
    /// 0 X, 1 Y, 2 Z.
    pub axis: usize,
    /// Commands of the axes where the measured lines cross, mm.
    pub at_mm: Vector,
    /// Tool vector to the optics, mm.
    pub optics_mm: Vector,
}

/// Length over which a rotation is read off the model, mm. The model is linear in the tool vector.
const ARM_MM: f64 = 1000.0;

impl MeasuredLine {
    /// What the machine does at a target: displacement of the optics, mm, and its turn, rad; real against commanded.
    #[must_use]
    pub fn motion(&self, machine: &WithEffects, position_mm: f64, direction: i8) -> Six {
        let mut linear_mm = self.at_mm;
        linear_mm[self.axis] = position_mm;
        let mut sides = [0; 3];
        sides[self.axis] = direction.signum();
        let error = |tool_mm: Vector| {
            let command = Command { linear_mm, tool_mm, direction: sides, ..Default::default() };
            machine.predict(&command).error_mm
        };
        let here = error(self.optics_mm);
        let [x, y, z] = [Vector::x(), Vector::y(), Vector::z()]
            .map(|way| (error(self.optics_mm + way * ARM_MM) - here) / ARM_MM);
        [here.x, here.y, here.z, (y.z - z.y) / 2.0, (z.x - x.z) / 2.0, (x.y - y.x) / 2.0]
    }

    /// From the place where the arms of the axis' angles begin, equation (7), to the optics on the line, mm.
    #[must_use]
    pub fn arm_mm(&self, description: &Description) -> Vector {
        let data = &description.linear[self.axis];
        let order = description.chain.linear().map(Axis::direction);
        let mut arm = self.optics_mm - data.measured_tool_mm;
        for later in order.into_iter().skip_while(|axis| *axis != self.axis).skip(1) {
            arm[later] += self.at_mm[later] - data.measured_at_mm[later];
        }
        arm
    }

    /// Least-squares direction of the motion over some targets, a unit vector: equation (32).
    fn direction(&self, machine: &WithEffects, positions_mm: &[f64]) -> Vector {
        let motions: Vec<Six> = positions_mm.iter().map(|q| self.motion(machine, *q, 0)).collect();
        let slope = |k: usize| {
            let values: Vec<f64> = motions.iter().map(|m| m[k]).collect();
            straight_line(positions_mm, &values).0
        };
        let mut way = Vector::new(slope(0), slope(1), slope(2));
        way[self.axis] += 1.0;
        way.normalize()
    }
}

/// What the instrument's set-up cannot be told from, and what is done about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gauge {
    /// Where the numbers have their zero.
    pub zero: Zero,
    /// Slopes across the axis are those of the instrument's straightedge: they are taken off.
    pub without_slopes: bool,
}

/// Where readings have their zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Zero {
    /// Readings on a base. The change is zero by definition: of lengths on average over the targets, of angles where the lines cross.
    Base,
    /// Readings of an axis of which nothing was known: as read.
    New,
    /// Functions of a model: as they are.
    Model,
}

/// The change, made free of what the set-up did: equation (58).
///
/// * `change` – functions of one axis, readings less the prediction of the base
pub fn apply_gauge(change: &mut [Option<Function>; 6], line: &MeasuredLine, gauge: Gauge) {
    for (k, function) in change.iter_mut().enumerate() {
        let Some(function) = function else { continue };
        let positions = function.positions_mm.clone();
        let across = k < 3 && k != line.axis;
        let slope =
            if across && gauge.without_slopes { straight_line(&positions, &function.mean).0 } else { 0.0 };
        let first = positions[0];
        let straightened: Vec<f64> =
            function.mean.iter().zip(&positions).map(|(value, q)| value - slope * (q - first)).collect();
        let zero = match gauge.zero {
            Zero::New | Zero::Model => 0.0,
            Zero::Base if k < 3 => straightened.iter().sum::<f64>() / straightened.len() as f64,
            Zero::Base => between(&positions, &straightened, line.at_mm[line.axis]),
        };
        let take = |values: &mut Vec<f64>| {
            for (value, q) in values.iter_mut().zip(&positions) {
                *value -= zero + slope * (q - first);
            }
        };
        take(&mut function.mean);
        function.directions.iter_mut().flatten().for_each(take);
    }
}

/// Chance below which the distance of two directions is taken to change from target to target.
const UNEQUAL: f64 = 0.01;

/// Where the two directions keep their distance from target to target, as far as their scatter lets one say (F test, 1 %), they keep it
/// exactly: one reversal value from all targets is known better than one a target.
///
/// * `runs` – runs up and down
pub fn settle_directions(function: &mut Function, runs: [usize; 2]) {
    let (Some([up, down]), Some(scatter)) = (&mut function.directions, function.scatter) else { return };
    let differences: Vec<f64> = up.iter().zip(down.iter()).map(|(u, d)| u - d).collect();
    let n = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / n;
    let of_one = scatter * scatter * (1.0 / runs[0] as f64 + 1.0 / runs[1] as f64);
    let squares: f64 = differences.iter().map(|d| (d - mean) * (d - mean)).sum();
    let freedom = n * (runs[0] + runs[1]).saturating_sub(2) as f64;
    if !(of_one > 0.0 && n > 1.0 && freedom > 0.0) {
        return;
    }
    let ratio = squares / ((n - 1.0) * of_one);
    let chance = FisherSnedecor::new(n - 1.0, freedom).map_or(0.0, |f| f.sf(ratio));
    if chance >= UNEQUAL {
        for ((u, d), m) in up.iter_mut().zip(down.iter_mut()).zip(&function.mean) {
            (*u, *d) = (m + 0.5 * mean, m - 0.5 * mean);
        }
        function.one_reversal = true;
    }
}

/// Straight between targets, the nearer end's value beyond them.
fn between(positions: &[f64], values: &[f64], q: f64) -> f64 {
    let k = positions.partition_point(|p| *p <= q).clamp(1, positions.len() - 1);
    let part = ((q - positions[k - 1]) / (positions[k] - positions[k - 1])).clamp(0.0, 1.0);
    values[k - 1] + (values[k] - values[k - 1]) * part
}

/// The functions of an axis at nodes, with the change where there is one.
#[derive(Clone, Debug, PartialEq)]
pub struct AxisOnNodes {
    /// Nodes, rising, mm.
    pub nodes_mm: Vec<f64>,
    /// Functions for both directions or the positive one, mm and rad.
    pub positive: Vec<Six>,
    /// For the negative direction, where the two differ.
    pub negative: Option<Vec<Six>>,
    /// Reversal value beside one set of functions, mm.
    pub backlash_mm: f64,
    /// Functions that somebody gave.
    pub given: [bool; 6],
}

/// How an axis' functions are held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FunctionSets {
    /// One set for both directions, with the reversal value beside it; two where the base has two.
    AsInBase,
    /// One for each direction: the reversal value goes into them.
    ByDirection,
}

impl AxisOnNodes {
    /// A base's axis at these nodes; beyond its tables the end values hold.
    #[must_use]
    pub fn new(
        base: &LinearAxis,
        axis: usize,
        given: [bool; 6],
        nodes_mm: Vec<f64>,
        sets: FunctionSets,
    ) -> Self {
        let at = |tables: &Option<AxisTables>, shift: f64| -> Vec<Six> {
            let six = |q: &f64| {
                let mut six = tables.as_ref().map_or([0.0; 6], |t| t.at(*q));
                six[axis] += shift;
                six
            };
            nodes_mm.iter().map(six).collect()
        };
        let half = 0.5 * base.backlash_mm;
        let (positive, negative, backlash_mm) = if base.errors_negative.is_some() {
            (at(&base.errors, -half), Some(at(&base.errors_negative, half)), 0.0)
        } else if sets == FunctionSets::ByDirection {
            (at(&base.errors, -half), Some(at(&base.errors, half)), 0.0)
        } else {
            (at(&base.errors, 0.0), None, base.backlash_mm)
        };
        // A table of the other direction, or the reversal value in two tables, may say more.
        let rows = || positive.iter().chain(negative.iter().flatten());
        let given = std::array::from_fn(|k| given[k] || rows().any(|six| six[k] != 0.0));
        Self { nodes_mm, positive, negative, backlash_mm, given }
    }

    /// Without some of the functions, in either direction: they are to be replaced.
    #[must_use]
    pub fn without(mut self, axis: usize, functions: [bool; 6]) -> Self {
        for six in self.positive.iter_mut().chain(self.negative.iter_mut().flatten()) {
            for (value, _) in six.iter_mut().zip(functions).filter(|(_, replaced)| *replaced) {
                *value = 0.0;
            }
        }
        if functions[axis] {
            self.backlash_mm = 0.0;
        }
        self
    }

    /// Adds a change that was read along a line `arm_mm` away from where the axis' own arms begin: `e += d - ε × arm`, equation (58).
    /// Between targets straight lines, beyond them the value of the end.
    pub fn add(&mut self, change: &[Option<Function>; 6], arm_mm: Vector) {
        let two = self.negative.is_some();
        let sides = [Some(&mut self.positive), self.negative.as_mut()];
        for (side, values) in sides.into_iter().enumerate() {
            for (q, six) in self.nodes_mm.iter().zip(values.into_iter().flatten()) {
                let d: Six = std::array::from_fn(|k| {
                    let Some(function) = &change[k] else { return 0.0 };
                    let own = match &function.directions {
                        Some(both) if two => &both[side],
                        _ => &function.mean,
                    };
                    between(&function.positions_mm, own, *q)
                });
                let lever = Vector::new(d[3], d[4], d[5]).cross(&arm_mm);
                for k in 0..6 {
                    six[k] += d[k] - if k < 3 { lever[k] } else { 0.0 };
                }
            }
        }
        let turned = change[3..].iter().any(Option::is_some) && arm_mm != Vector::zeros();
        for (k, given) in self.given.iter_mut().enumerate() {
            *given |= change[k].is_some() || (k < 3 && turned);
        }
    }
}

impl AxisOnNodes {
    /// The same as an axis of a description; `None` where the nodes do not rise.
    #[must_use]
    pub fn axis(&self, base: &LinearAxis, interpolation: Interpolation) -> Option<LinearAxis> {
        let tables = |rows: &[Six]| {
            let mut all: [Option<Table>; 6] = Default::default();
            for (k, table) in all.iter_mut().enumerate() {
                let values = rows.iter().map(|six| six[k]).collect();
                *table = Some(Table::new(self.nodes_mm.clone(), values, interpolation).ok()?);
            }
            AxisTables::new(&all)
        };
        let errors_negative = match &self.negative {
            Some(rows) => Some(tables(rows)?),
            None => None,
        };
        Some(LinearAxis {
            errors: Some(tables(&self.positive)?),
            errors_negative,
            backlash_mm: self.backlash_mm,
            ..base.clone()
        })
    }

    /// One set of functions and a reversal value: the mean of both directions, and how much further the axis stands behind a motion
    /// towards minus, on average over the nodes.
    #[must_use]
    pub fn averaged(self, axis: usize) -> Self {
        let Some(negative) = &self.negative else { return self };
        let pairs = || self.positive.iter().zip(negative);
        let reversal = pairs().map(|(up, down)| down[axis] - up[axis]).sum::<f64>();
        let backlash_mm = self.backlash_mm + reversal / self.positive.len() as f64;
        let positive = pairs().map(|(up, down)| std::array::from_fn(|k| 0.5 * (up[k] + down[k]))).collect();
        Self { positive, negative: None, backlash_mm, ..self }
    }
}

/// Angles between the measured lines as `EC0Y`, `EB0Z`, `EA0Z`, rad, signs of ISO 230-1: equation (59).
#[must_use]
pub fn angles_between(
    lines: &[MeasuredLine; 3],
    targets_mm: &[Vec<f64>; 3],
    machine: &WithEffects,
) -> [f64; 3] {
    let [x, y, z] = [0, 1, 2].map(|k: usize| lines[k].direction(machine, &targets_mm[k]));
    [-x.dot(&y), x.dot(&z), -y.dot(&z)]
}

/// The squareness with which the lines have these angles: equation (59). Angles of an axis that are zero elsewhere than where the
/// lines cross turn what it carries; a squareness read between lines holds that, the model's parameter does not.
///
/// * `machine` – the machine with a squareness
/// * `start` – any squareness near it
///
/// # Errors
/// Those of `machine`.
pub fn squareness_for<E>(
    lines: &[MeasuredLine; 3],
    targets_mm: &[Vec<f64>; 3],
    wanted_rad: [f64; 3],
    start: Squareness,
    machine: impl Fn(Squareness) -> Result<WithEffects, E>,
) -> Result<Squareness, E> {
    let mut found = start;
    // The derivative is the identity but for products of errors (1e-3 at most): three steps leave 1e-12.
    for _ in 0..3 {
        let [c, b, a] = angles_between(lines, targets_mm, &machine(found)?);
        found.ec0y_rad += wanted_rad[0] - c;
        found.eb0z_rad += wanted_rad[1] - b;
        found.ea0z_rad += wanted_rad[2] - a;
    }
    Ok(found)
}

/// Half width that 95 % of the volume's points keep, mm, their common frame taken off: equation (51c) with the noise of (58). `None`
/// where no function was repeated.
///
/// * `order` – chain order of the axes, workpiece first
/// * `targets_mm` – of each axis, as far as its line goes
/// * `relative` – standard uncertainty of the instrument's length, relative
#[must_use]
pub fn field_u95_mm(
    lines: &[MeasuredLine; 3],
    order: [usize; 3],
    targets_mm: &[Vec<f64>; 3],
    changes: &[[Option<Function>; 6]; 3],
    relative: f64,
) -> Option<f64> {
    let span = |targets: &Vec<f64>| Range { low: targets[0], high: targets[targets.len() - 1] };
    let places = field::places_mm(&targets_mm.each_ref().map(span));
    let mut spreads = vec![Matrix3::zeros(); places.len()];
    // Functions, and the scales of the axes, scatter independently: their spreads add.
    let mut add = |displacements: DMatrix<f64>, variance: f64| {
        for (sum, own) in spreads.iter_mut().zip(field::independent_spreads(&places, displacements)) {
            *sum += own * variance;
        }
    };
    let mut freedom = usize::MAX;
    for (axis, functions) in changes.iter().enumerate() {
        let own: Vec<f64> = places.iter().map(|place| place[axis]).collect();
        for (f, function) in functions.iter().enumerate() {
            let Some(function) = function else { continue };
            let Some(scatter) = function.scatter else { continue };
            // Each direction has half of the readings, unless they keep one distance.
            let sides = if function.directions.is_some() && !function.one_reversal { 2 } else { 1 };
            let nodes = function.positions_mm.len();
            let runs = if function.directions.is_some() { 2 } else { 1 };
            freedom = freedom.min(nodes * function.count.saturating_sub(runs));
            let ways = places.iter().map(|place| {
                let mut way = Vector::zeros();
                way[f % 3] = 1.0;
                if f >= 3 {
                    let mut arm = Vector::zeros();
                    for later in order.into_iter().skip_while(|k| *k != axis).skip(1) {
                        arm[later] = place[later] - lines[axis].at_mm[later];
                    }
                    way = way.cross(&arm);
                }
                way
            });
            let seen = noise_at(&own, function, &lines[axis], f);
            let mut displacements = DMatrix::zeros(3 * places.len(), nodes);
            for (k, way) in ways.enumerate() {
                displacements.rows_mut(3 * k, 3).copy_from(&(way * seen.row(k)));
            }
            add(displacements, scatter * scatter * f64::from(sides) / function.count as f64);
        }
        if functions[axis].is_some() {
            let along = |row: usize, _| if row % 3 == axis { own[row / 3] } else { 0.0 };
            add(DMatrix::from_fn(3 * places.len(), 1, along), relative * relative);
        }
    }
    if freedom == usize::MAX {
        return None;
    }
    let factor = quantile_95(Some(freedom.max(1))) / quantile_95(None);
    Some(field::quantile_of_points(&spreads) * factor)
}

/// What the means at the targets contribute to the function at places, the gauge taken off: one row a place.
fn noise_at(places: &[f64], function: &Function, line: &MeasuredLine, f: usize) -> DMatrix<f64> {
    let positions = &function.positions_mm;
    let n = positions.len();
    let mut seen = DMatrix::zeros(places.len(), n);
    for target in 0..n {
        let unit: Vec<f64> = (0..n).map(|k| f64::from(u8::from(k == target))).collect();
        let (slope, zero) = match f {
            _ if f == line.axis => (0.0, 0.0),
            0..3 => straight_line(positions, &unit),
            _ => (0.0, between(positions, &unit, line.at_mm[line.axis])),
        };
        for (row, q) in places.iter().enumerate() {
            seen[(row, target)] = between(positions, &unit, *q) - zero - slope * q;
        }
    }
    seen
}
