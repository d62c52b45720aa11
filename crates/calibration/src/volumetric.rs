//! All rigid-body terms from points anywhere in the volume: equation (51).

use machine_model::{Chain, Vector};
use nalgebra::{DMatrix, DVector};

use crate::error::{CalibrationError, LETTERS};
use crate::least_squares::{Estimate, solve};

/// What was read at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointReading {
    /// Measured minus commanded per component, mm; `None` where not measured.
    Deviation([Option<f64>; 3]),
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
    /// Commands of the linear axes, mm.
    pub commanded_mm: Vector,
    /// Gauge point to the point that was measured, mm.
    pub tool_mm: Vector,
    /// What was read.
    pub reading: PointReading,
    /// Standard uncertainty of the reading, mm, where known.
    pub uncertainty_mm: Option<f64>,
}

/// One group of parameters: an error function, an angle between axes, or a run's set-up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Group {
    /// Axis and function (0 to 5: EX EY EZ EA EB EC).
    Function(usize, usize),
    /// EC0Y, EB0Z, EA0Z.
    Squareness(usize),
    /// Set-up of a run.
    Run(usize),
}

impl Group {
    fn name(self) -> String {
        match self {
            Self::Function(axis, f) => format!("E{}{}", ['X', 'Y', 'Z', 'A', 'B', 'C'][f], LETTERS[axis]),
            Self::Squareness(k) => ["EC0Y", "EB0Z", "EA0Z"][k].to_owned(),
            Self::Run(_) => "the set-up".to_owned(),
        }
    }
}

/// A parameter: its group and, for functions, its node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Parameter {
    group: Group,
    part: usize,
}

/// One error function as found.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundFunction {
    /// 0 X, 1 Y, 2 Z.
    pub axis: usize,
    /// 0 to 5: EX EY EZ EA EB EC.
    pub function: usize,
    /// Values at the nodes of the axis, mm or rad.
    pub values: Vec<f64>,
    /// Half widths of their 95 % intervals; 0 where a value is 0 by definition.
    pub half_widths_95: Vec<f64>,
}

/// What the points say.
#[derive(Clone, Debug)]
pub struct VolumetricCalibration {
    /// Nodes of X, Y, Z, mm.
    pub nodes_mm: [Vec<f64>; 3],
    /// The functions that could be determined.
    pub functions: Vec<FoundFunction>,
    /// EC0Y, EB0Z, EA0Z and the half widths of their 95 % intervals, rad; `None` where open.
    pub squareness_rad: [Option<(f64, f64)>; 3],
    /// Terms that the points cannot tell from others and that were left at 0: term, and what it looks like.
    pub open: Vec<(String, String)>,
    /// Root mean square of the readings that were fitted: before (set-ups taken off) and after, mm.
    pub fitted_rms_mm: [f64; 2],
    /// The same of the readings that were held out, and how many those were; `None` where none were.
    pub holdout: Option<([f64; 2], usize)>,
    /// Half width of the 95 % interval of the deviation at the far corner, mm.
    pub far_corner_u95_mm: f64,
    /// The least squares behind it.
    pub estimate: Estimate,
}

/// How to fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Nodes per axis, at least 2.
    pub nodes: usize,
    /// Every so-manieth point is held out; 0 for none.
    pub holdout_every: usize,
}

/// The problem: chain, nodes, points, parameters.
struct Problem<'p> {
    order: [usize; 3],
    nodes: [Vec<f64>; 3],
    points: &'p [Point],
    parameters: Vec<Parameter>,
    stations: Vec<Vector>,
}

/// Fits every rigid-body term: equation (51).
///
/// By definition, so that nothing is counted twice: positioning and angles are 0 at the first node, straightness at both
/// ends; the slope of a straightness is squareness. Terms that the points cannot tell from others are left out, last axes
/// and angles first, and named.
///
/// # Errors
/// [`CalibrationError::TooFew`]; [`CalibrationError::Units`] where deviations are no geometric errors.
pub fn calibrate(
    points: &[Point],
    chain: &Chain,
    options: Options,
) -> Result<VolumetricCalibration, CalibrationError> {
    let held = |k: usize| options.holdout_every > 1 && k % options.holdout_every == options.holdout_every - 1;
    let fitted: Vec<Point> = points.iter().enumerate().filter(|(k, _)| !held(*k)).map(|(_, p)| *p).collect();
    let unseen: Vec<Point> = points.iter().enumerate().filter(|(k, _)| held(*k)).map(|(_, p)| *p).collect();
    plausible(points)?;
    let nodes = nodes(&fitted, options.nodes)?;
    let runs = points.iter().map(|p| p.run + 1).max().unwrap_or(0);
    let mut stations = vec![Vector::zeros(); runs];
    for p in points {
        if let PointReading::Distance { station_mm, .. } = p.reading {
            stations[p.run] = station_mm;
        }
    }
    let order = chain.linear().map(machine_model::Axis::direction);
    let mut problem =
        Problem { order, parameters: parameters(&nodes, runs, &fitted), nodes, points: &fitted, stations };
    let mut open = Vec::new();
    let mut estimate;
    // Stations are found with the machine: a few steps, each linear.
    let steps = if fitted.iter().any(|p| matches!(p.reading, PointReading::Distance { .. })) { 4 } else { 1 };
    let mut step = 0;
    loop {
        let (design, right) = problem.system(problem.points);
        if design.nrows() <= problem.parameters.len() {
            return Err(CalibrationError::TooFew(format!(
                "{} readings for {} unknowns",
                design.nrows(),
                problem.parameters.len()
            )));
        }
        let weighted = fitted.iter().all(|p| p.uncertainty_mm.is_some());
        match solve(&design, &right, weighted.then_some(1.0)) {
            Ok(found) => {
                estimate = found;
                step += 1;
                if step >= steps {
                    break;
                }
                for (k, p) in problem.parameters.iter().enumerate() {
                    if let Group::Run(run) = p.group
                        && p.part < 3
                    {
                        problem.stations[run][p.part] += estimate.values[k];
                    }
                }
            }
            Err(combinations) => {
                let (term, rivals) = problem.leave_out(&combinations)?;
                open.push((term, rivals));
            }
        }
    }
    let before = |points: &[Point]| problem.rms(points, &estimate, true);
    let after = |points: &[Point]| problem.rms(points, &estimate, false);
    let holdout = (!unseen.is_empty()).then(|| ([before(&unseen), after(&unseen)], unseen.len()));
    let functions = problem.functions(&estimate);
    let squareness_rad = [0, 1, 2].map(|k| {
        let at = problem.parameters.iter().position(|p| p.group == Group::Squareness(k))?;
        Some((estimate.values[at], estimate.half_width_95(at)))
    });
    Ok(VolumetricCalibration {
        functions,
        squareness_rad,
        open,
        fitted_rms_mm: [before(&fitted), after(&fitted)],
        holdout,
        far_corner_u95_mm: problem.far_corner(&estimate),
        nodes_mm: problem.nodes,
        estimate,
    })
}

/// Deviations of centimetres are no geometric errors, and neither are lengths that are off by a factor.
fn plausible(points: &[Point]) -> Result<(), CalibrationError> {
    let mut sizes: Vec<f64> = points
        .iter()
        .flat_map(|p| match p.reading {
            PointReading::Deviation(d) => d.into_iter().flatten().map(f64::abs).collect::<Vec<_>>(),
            PointReading::Distance { length_mm, station_mm } => {
                vec![(length_mm - (p.commanded_mm + p.tool_mm - station_mm).norm()).abs() / 10.0]
            }
        })
        .collect();
    sizes.sort_by(f64::total_cmp);
    let median = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    let large = sizes.get(sizes.len() * 9 / 10).copied().unwrap_or(0.0);
    if median > 3.0 {
        return Err(CalibrationError::Units(format!(
            "half of the deviations exceed {median:.1} mm: units or frames do not fit"
        )));
    }
    if large < 5e-5 && sizes.len() > 3 {
        return Err(CalibrationError::Units(format!(
            "nine deviations of ten are below {:.4} um: are they in mm where um was said?",
            large * 1e3
        )));
    }
    Ok(())
}

/// Equal steps over what the points cover, or the planes of a lattice.
fn nodes(points: &[Point], count: usize) -> Result<[Vec<f64>; 3], CalibrationError> {
    let mut out: [Vec<f64>; 3] = Default::default();
    for (axis, own) in out.iter_mut().enumerate() {
        let values = || points.iter().map(|p| p.commanded_mm[axis]);
        let (low, high) =
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
        if high.partial_cmp(&(low + 1e-3)) != Some(std::cmp::Ordering::Greater) {
            return Err(CalibrationError::TooFew(format!(
                "{} does not move in the measurements",
                LETTERS[axis]
            )));
        }
        // On a lattice a table can have no more nodes than the lattice has planes.
        let mut places: Vec<f64> = values().collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
        if places.len() <= count.max(2) {
            *own = places;
            continue;
        }
        let cells = count.max(2) - 1;
        *own = (0..=cells).map(|k| low + (high - low) * k as f64 / cells as f64).collect();
    }
    Ok(out)
}

/// Every parameter that a machine has, with the definitions of [`calibrate`].
fn parameters(nodes: &[Vec<f64>; 3], runs: usize, points: &[Point]) -> Vec<Parameter> {
    let mut all = Vec::new();
    for (axis, own) in nodes.iter().enumerate() {
        let last = own.len() - 1;
        for f in 0..6 {
            let straight = f < 3 && f != axis;
            let range = if straight { 1..last } else { 1..last + 1 };
            all.extend(range.map(|part| Parameter { group: Group::Function(axis, f), part }));
        }
    }
    all.extend((0..3).map(|k| Parameter { group: Group::Squareness(k), part: 0 }));
    for run in (0..runs).filter(|run| points.iter().any(|p| p.run == *run)) {
        let distances =
            points.iter().any(|p| p.run == run && matches!(p.reading, PointReading::Distance { .. }));
        // A station has a place and a zero of its length; a frame has a shift.
        all.extend((0..if distances { 4 } else { 3 }).map(|part| Parameter { group: Group::Run(run), part }));
    }
    all
}

/// Value of the hat function of a node at `q`.
fn hat(nodes: &[f64], node: usize, q: f64) -> f64 {
    let q = q.clamp(nodes[0], nodes[nodes.len() - 1]);
    let rise = |from: f64, to: f64| (q - from) / (to - from);
    if q <= nodes[node] {
        if node == 0 { 1.0 } else { rise(nodes[node - 1], nodes[node]).max(0.0) }
    } else if node + 1 == nodes.len() {
        1.0
    } else {
        rise(nodes[node + 1], nodes[node]).max(0.0)
    }
}

impl Problem<'_> {
    /// Displacement by a unit of each machine parameter at a command, first order; run parameters give zero.
    fn displacement(&self, parameter: &Parameter, q: &Vector, tool: &Vector) -> Vector {
        match parameter.group {
            Group::Function(axis, f) => {
                let mut unit = Vector::zeros();
                unit[f % 3] = 1.0;
                let size = hat(&self.nodes[axis], parameter.part, q[axis]);
                if size == 0.0 || f < 3 {
                    return unit * size;
                }
                let mut lever = *tool;
                let place = self.order.iter().position(|a| *a == axis).unwrap_or(2);
                for later in &self.order[place + 1..] {
                    lever[*later] += q[*later];
                }
                unit.cross(&lever) * size
            }
            Group::Squareness(0) => Vector::new(-q.y, 0.0, 0.0),
            Group::Squareness(1) => Vector::new(q.z, 0.0, 0.0),
            Group::Squareness(_) => Vector::new(0.0, -q.z, 0.0),
            Group::Run(_) => Vector::zeros(),
        }
    }

    /// Design and observations of some points.
    fn system(&self, points: &[Point]) -> (DMatrix<f64>, DVector<f64>) {
        let mut rows: Vec<(Vec<f64>, f64)> = Vec::new();
        for p in points {
            let weight = p.uncertainty_mm.map_or(1.0, |u| 1.0 / u);
            let all: Vec<Vector> =
                self.parameters.iter().map(|k| self.displacement(k, &p.commanded_mm, &p.tool_mm)).collect();
            let own = |k: &Parameter| k.group == Group::Run(p.run);
            match p.reading {
                PointReading::Deviation(d) => {
                    for (i, value) in d.iter().enumerate() {
                        let Some(value) = value else { continue };
                        let row = self.parameters.iter().zip(&all).map(|(k, v)| {
                            weight * if own(k) { f64::from(u8::from(k.part == i)) } else { v[i] }
                        });
                        rows.push((row.collect(), weight * value));
                    }
                }
                PointReading::Distance { length_mm, .. } => {
                    let arm = p.commanded_mm + p.tool_mm - self.stations[p.run];
                    let length = arm.norm();
                    let unit = arm / length;
                    let row = self.parameters.iter().zip(&all).map(|(k, v)| {
                        weight
                            * match (own(k), k.part) {
                                (true, 3) => 1.0,
                                (true, part) => -unit[part],
                                _ => unit.dot(v),
                            }
                    });
                    rows.push((row.collect(), weight * (length_mm - length)));
                }
            }
        }
        let design = DMatrix::from_fn(rows.len(), self.parameters.len(), |i, k| rows[i].0[k]);
        (design, DVector::from_fn(rows.len(), |i, _| rows[i].1))
    }

    /// Takes out one group that stands in an open combination, and says what it looked like.
    fn leave_out(&mut self, combinations: &[DVector<f64>]) -> Result<(String, String), CalibrationError> {
        let share = |group: Group| -> f64 {
            let own = |c: &DVector<f64>| -> f64 {
                self.parameters
                    .iter()
                    .enumerate()
                    .filter(|(_, p)| p.group == group)
                    .map(|(k, _)| c[k] * c[k])
                    .sum()
            };
            combinations.iter().map(own).fold(0.0, f64::max)
        };
        let mut groups: Vec<Group> = self.parameters.iter().map(|p| p.group).collect();
        groups.dedup();
        let place = |axis: usize| self.order.iter().position(|a| *a == axis).unwrap_or(0);
        // What a correction can do without soonest: angles of the axis nearest the tool.
        let rank = |g: &Group| match g {
            Group::Function(axis, f) if *f >= 3 => 10 + place(*axis),
            Group::Function(axis, _) => place(*axis),
            Group::Squareness(_) => 5,
            Group::Run(_) => 0,
        };
        let concerned: Vec<Group> = groups.iter().copied().filter(|g| share(*g) > 1e-3).collect();
        let victim = concerned.iter().copied().filter(|g| !matches!(g, Group::Run(_))).max_by_key(rank);
        let Some(victim) = victim else {
            return Err(CalibrationError::Unobservable(
                "the set-ups of the runs from one another".to_owned(),
            ));
        };
        let rivals: Vec<String> = concerned.iter().filter(|g| **g != victim).map(|g| g.name()).collect();
        self.parameters.retain(|p| p.group != victim);
        let mut unique = rivals;
        unique.dedup();
        Ok((victim.name(), unique.join(", ")))
    }

    /// Root mean square over points, mm, unweighted: of what is left, or of everything but the set-ups.
    fn rms(&self, points: &[Point], estimate: &Estimate, before: bool) -> f64 {
        let plain: Vec<Point> = points.iter().map(|p| Point { uncertainty_mm: None, ..*p }).collect();
        let (design, right) = self.system(&plain);
        let mut values = estimate.values.clone();
        for (value, p) in values.iter_mut().zip(&self.parameters) {
            let run = matches!(p.group, Group::Run(_));
            // Stations have been moved to where they are; only the zero of the length is left.
            let moved = run
                && p.part < 3
                && points.iter().any(|q| matches!(q.reading, PointReading::Distance { .. }));
            if (before && !run) || moved {
                *value = 0.0;
            }
        }
        let left = right - design * values;
        (left.norm_squared() / left.len().max(1) as f64).sqrt()
    }

    fn functions(&self, estimate: &Estimate) -> Vec<FoundFunction> {
        let mut out: Vec<FoundFunction> = Vec::new();
        for (k, p) in self.parameters.iter().enumerate() {
            let Group::Function(axis, function) = p.group else { continue };
            if out.last().is_none_or(|f| (f.axis, f.function) != (axis, function)) {
                let zeros = vec![0.0; self.nodes[axis].len()];
                out.push(FoundFunction { axis, function, values: zeros.clone(), half_widths_95: zeros });
            }
            if let Some(last) = out.last_mut() {
                last.values[p.part] = estimate.values[k];
                last.half_widths_95[p.part] = estimate.half_width_95(k);
            }
        }
        out
    }

    /// Half width of the 95 % interval at the corner farthest from the first nodes, without tool.
    fn far_corner(&self, estimate: &Estimate) -> f64 {
        let corner = Vector::from_fn(|i, _| self.nodes[i][self.nodes[i].len() - 1]);
        let columns: Vec<Vector> =
            self.parameters.iter().map(|p| self.displacement(p, &corner, &Vector::zeros())).collect();
        let variance: f64 = (0..3)
            .map(|i| {
                let row = DVector::from_fn(columns.len(), |k, _| columns[k][i]);
                (row.transpose() * &estimate.covariance * &row)[(0, 0)]
            })
            .sum();
        crate::student::quantile_95(estimate.degrees_of_freedom) * variance.max(0.0).sqrt()
    }
}
