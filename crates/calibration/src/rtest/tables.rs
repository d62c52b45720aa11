//! Error functions as they are written: at nodes so fine that the profile's interpolation adds nothing of note.

use machine_model::{Axis, Command, Description, Interpolation, Range, Six, Vector};
use nalgebra::DMatrix;

use super::basis::Basis;
use super::columns::{Columns, model};
use super::found::{BallReading, FoundTerm, TurnedAxis};
use super::terms::{Term, change_at, tables};
use crate::error::CalibrationError;
use crate::field;
use crate::points::Base;
use crate::student::quantile_95;

/// Between the nodes a written function keeps to what was found within: 0.01 µm, and as much at an arm of half a metre.
const BETWEEN_NODES: [f64; 2] = [1e-5, 2e-8];

/// Steps of the nodes, degrees: the largest that keeps [`BETWEEN_NODES`].
const STEPS_DEG: [f64; 7] = [10.0, 5.0, 2.0, 1.0, 0.5, 0.2, 0.1];

/// An axis without a limit is written for so many turns to either side of 0; one with limits, as far as they go, at most twice so far.
const TURNS: f64 = 1.0;

/// Error functions of one axis as they are written.
#[derive(Clone, Debug, PartialEq)]
pub struct WrittenTable {
    /// The axis.
    pub axis: Axis,
    /// Nodes, rising, degrees: decimal numbers, as they are printed.
    pub angles_deg: Vec<f64>,
    /// Base and change at the nodes, mm and rad.
    pub rows: Vec<Six>,
    /// Which functions the table has: what was found, and what the base has.
    pub given: [bool; 6],
    /// Which of them were changed.
    pub changed: [bool; 6],
    /// Half widths of the 95 % intervals of the change at the nodes, mm and rad.
    pub half_widths_95: Vec<Six>,
    /// How far the interpolation leaves what was found, at most, mm and rad.
    pub between_nodes: [f64; 2],
}

/// The tables of all axes of which a function was found.
pub(super) fn written(
    base: &Base,
    axes: &[TurnedAxis],
    found: &[FoundTerm],
    covariance: &DMatrix<f64>,
    factor: f64,
) -> Vec<WrittenTable> {
    let terms: Vec<Term> = found.iter().map(|f| f.term).collect();
    let changes: Vec<f64> = found.iter().map(|f| if f.is_written { f.change } else { 0.0 }).collect();
    let of = |own: &TurnedAxis| -> Option<WrittenTable> {
        let axis = own.axis;
        let changed: [bool; 6] = std::array::from_fn(|f| {
            found.iter().any(|t| {
                t.is_written && matches!(t.term, Term::Coefficient { axis: a, function, .. } if a == axis && function == f)
            })
        });
        if changed == [false; 6] {
            return None;
        }
        let before = base.description.rotary[axis.direction()].errors.as_ref();
        let value = |deg: f64| -> Six {
            let angle = deg.to_radians();
            let (old, new) =
                (before.map_or([0.0; 6], |t| t.at(angle)), change_at(axis, angle, &terms, &changes));
            std::array::from_fn(|f| old[f] + new[f])
        };
        let range = range_deg(base, own);
        let mut best: Option<(Vec<f64>, [f64; 2])> = None;
        for step in STEPS_DEG {
            let nodes = nodes_deg(base, axis, range, step);
            let between = between_nodes(&nodes, &value, base.interpolation);
            let is_fine = between[0] <= BETWEEN_NODES[0] && between[1] <= BETWEEN_NODES[1];
            best = Some((nodes, between));
            if is_fine {
                break;
            }
        }
        let (angles_deg, between_nodes) = best?;
        let rows: Vec<Six> = angles_deg.iter().map(|deg| value(*deg)).collect();
        let given = std::array::from_fn(|f| changed[f] || rows.iter().any(|row| row[f] != 0.0));
        let half_widths_95 = angles_deg
            .iter()
            .map(|deg| half_widths(own, deg.to_radians(), found, covariance, factor))
            .collect();
        Some(WrittenTable { axis, angles_deg, rows, given, changed, half_widths_95, between_nodes })
    };
    axes.iter().filter_map(of).collect()
}

/// Where the table holds: as far as the axis goes where a turn was measured, else where it was measured.
fn range_deg(base: &Base, own: &TurnedAxis) -> [f64; 2] {
    let rotary = &base.description.rotary[own.axis.direction()];
    // Angles were degrees with few decimals before they were radians.
    let degrees = |rad: f64| (rad.to_degrees() * 1e6).round() * 1e-6;
    let measured = own.range_rad.map(degrees);
    let mut range = measured;
    if own.basis == Basis::Turn {
        let Range { low, high } = rotary.travel_rad;
        let most = 360.0 * TURNS;
        let side = |limit: f64, sign: f64| {
            if limit.is_finite() { degrees(limit).clamp(-2.0 * most, 2.0 * most) } else { sign * most }
        };
        range = [side(low, -1.0).min(measured[0]), side(high, 1.0).max(measured[1])];
    }
    if let Some(tables) = &rotary.errors {
        let known = tables.range();
        range = [range[0].max(degrees(known.low)), range[1].min(degrees(known.high))];
    }
    range
}

/// Multiples of the step, the ends, and the nodes of the base's own table, where it may have kinks.
fn nodes_deg(base: &Base, axis: Axis, [low, high]: [f64; 2], step: f64) -> Vec<f64> {
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    let mut nodes: Vec<f64> = (first..=last).map(|k| k as f64 * step).chain([low, high]).collect();
    if let Some(tables) = &base.description.rotary[axis.direction()].errors {
        let known = tables.nodes().iter().map(|rad| (rad.to_degrees() * 1e6).round() * 1e-6);
        nodes.extend(known.filter(|deg| low < *deg && *deg < high));
    }
    nodes.sort_by(f64::total_cmp);
    // Six decimals are printed.
    nodes.dedup_by(|a, b| (*a - *b).abs() < 2e-6);
    nodes
}

fn between_nodes(nodes_deg: &[f64], value: &dyn Fn(f64) -> Six, interpolation: Interpolation) -> [f64; 2] {
    const PLACES: [f64; 4] = [0.2, 0.4, 0.6, 0.8];
    let nodes: Vec<f64> = nodes_deg.iter().map(|deg| deg.to_radians()).collect();
    let rows: Vec<Six> = nodes_deg.iter().map(|deg| value(*deg)).collect();
    let Some(tables) = tables(&nodes, &rows, interpolation) else { return [f64::INFINITY; 2] };
    let mut largest = [0.0_f64; 2];
    for pair in nodes_deg.windows(2) {
        for place in PLACES {
            let deg = pair[0] + place * (pair[1] - pair[0]);
            let (wanted, is) = (value(deg), tables.at(deg.to_radians()));
            for f in 0..6 {
                let kind = usize::from(f >= 3);
                largest[kind] = largest[kind].max((wanted[f] - is[f]).abs());
            }
        }
    }
    largest
}

/// Half widths of the intervals of the six functions at an angle.
fn half_widths(
    own: &TurnedAxis,
    angle_rad: f64,
    found: &[FoundTerm],
    covariance: &DMatrix<f64>,
    factor: f64,
) -> Six {
    let values: Vec<Vec<f64>> = (0..own.groups).map(|group| own.basis.values(group, angle_rad)).collect();
    std::array::from_fn(|wanted| {
        let part = |f: &FoundTerm| match f.term {
            Term::Coefficient { axis, function, group, which, .. }
                if f.is_written && axis == own.axis && function == wanted =>
            {
                values[group][which]
            }
            _ => 0.0,
        };
        let entries: Vec<(usize, f64)> =
            found.iter().map(part).enumerate().filter(|(_, value)| *value != 0.0).collect();
        let variance: f64 = entries
            .iter()
            .flat_map(|(i, a)| entries.iter().map(move |(k, b)| a * b * covariance[(*i, *k)]))
            .sum();
        factor * variance.max(0.0).sqrt()
    })
}

/// The base with what is written.
pub(super) fn machine(base: &Base, found: &[FoundTerm], tables_of: &[WrittenTable]) -> Description {
    let mut machine = base.description.clone();
    for f in found.iter().filter(|f| f.is_written) {
        if let Term::Location(location) = f.term {
            location.add(&mut machine, f.change);
        }
    }
    for table in tables_of {
        let nodes: Vec<f64> = table.angles_deg.iter().map(|deg| deg.to_radians()).collect();
        machine.rotary[table.axis.direction()].errors = tables(&nodes, &table.rows, base.interpolation);
    }
    machine
}

/// Half width that 95 % of the places keep, mm: equation (51c), for the tools that were measured with.
pub(super) fn field_u95_mm(
    rows: &[BallReading],
    base: &Base,
    axes: &[TurnedAxis],
    found: &[FoundTerm],
    covariance: &DMatrix<f64>,
    factor: f64,
) -> Result<f64, CalibrationError> {
    let machine = model(base.description.clone())?;
    let mut ranges: Vec<Range> = base.description.linear.iter().map(|axis| axis.calibrated_mm()).collect();
    for (axis, range) in ranges.iter_mut().enumerate() {
        // Where no travel is known: as far as the axes went.
        if !(range.low.is_finite() && range.high.is_finite()) {
            let places = || rows.iter().map(|row| row.command.linear_mm[axis]);
            let (low, high) =
                (places().fold(f64::INFINITY, f64::min), places().fold(f64::NEG_INFINITY, f64::max));
            *range = Range { low: range.low.max(low), high: range.high.min(high) };
        }
    }
    ranges.extend(axes.iter().map(|own| match own.basis {
        Basis::Turn => Range { low: 0.0, high: std::f64::consts::TAU },
        Basis::Arc(range) => range,
    }));
    let every = rows.len().div_ceil(7).max(1);
    let tools: Vec<Vector> = rows.iter().step_by(every).map(|row| row.command.tool_mm).collect();
    let commands: Vec<Command> = field::places(&ranges)
        .iter()
        .enumerate()
        .map(|(k, place)| {
            let mut command = rows[0].command;
            command.linear_mm = Vector::from_fn(|i, _| place[i]);
            command.tool_mm = tools[k % tools.len()];
            for (own, angle) in axes.iter().zip(&place[3..]) {
                command.rotary_rad[own.axis.direction()] = *angle;
            }
            command
        })
        .collect();
    let turning: Vec<Axis> = axes.iter().map(|own| own.axis).collect();
    let columns = Columns::new(&base.description, &turning, &commands)?;
    let kept: Vec<usize> = (0..found.len()).filter(|k| found[*k].is_written).collect();
    let terms: Vec<Term> = kept.iter().map(|k| found[*k].term).collect();
    let places_mm: Vec<Vector> = commands.iter().map(|c| machine.predict(c).position_mm).collect();
    let own = DMatrix::from_fn(kept.len(), kept.len(), |i, k| covariance[(kept[i], kept[k])]);
    let spreads = field::spreads(&places_mm, columns.matrix(&terms), &own);
    Ok(field::quantile_of_points(&spreads) * factor / quantile_95(None))
}
