//! The one rule: reading = prediction of the base with its change + set-up + noise; equations (51) to (51c).
//!
//! The change of a linear axis is six functions, straight between nodes, and its play. It is added to the base's own tables and
//! the base's own forward model predicts with it, so whatever the base holds (angles, squareness, effects, measured lines,
//! rotary axes) is in the prediction once. Set-ups are exact: a rotation and a shift per run, or the place and the zero of a
//! station. Nothing but the change is fitted: a machine measured from its own profile changes by nothing.

use diagnostic::{Speaks, Text, both};
use std::ops::Range;

use machine_model::rotation::of_any_size;
use machine_model::{Command, Vector};
use nalgebra::{DMatrix, DVector, Matrix3};

use crate::adjustment::{Jacobian, Noise, Problem, adjust};
use crate::changed::{Found, machine_with};
use crate::error::CalibrationError;
use crate::geometry::{Geometry, centre, predicted};
use crate::layout::{Group, Layout, Plan};
use crate::points::{Base, Point, PointReading, RowOrigin, SetUp, rows, seen_mm, value};
use crate::rigid_motion::RigidMotion;

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
