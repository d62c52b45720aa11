//! Rotary axes from ball deviations at their angles, by R-test or by touch probe and sphere: equations (100) to (104).
//!
//! A ball on one side, a nest or a probe on the other; the rotary axes turn and the linear axes follow. Every row says how far
//! the tip really stands from where it was commanded, as the workpiece sees it, but for a shift that is the same in all rows of a
//! run: nobody knows where a ball was mounted to a micrometre. Unknown are the location errors of each axis that turns and its
//! six error functions of the angle. The forward model is the machine itself ([`machine_model::RigidBody`]); linear axes and
//! what else the base says are taken as known, and so is the tool vector.
//!
//! Some unknowns look the same from every ball, others from these balls only. The sweep of equation (102) gives each part one owner, and what
//! only these rows cannot tell apart is named and not written.

mod basis;
mod columns;
mod found;
mod judgement;
mod measured;
mod ownership;
mod tables;
mod terms;

use diagnostic::{Speaks, Text, both};
use machine_model::{Axis, Command, Description, Vector};
use nalgebra::{DMatrix, DVector};

pub use basis::Basis;
pub use found::{BallReading, FoundTerm, TurnedAxis};
pub use tables::WrittenTable;
pub use terms::Term;

use crate::adjustment::{Estimate, Jacobian, Noise, Problem, adjust};
use crate::ballbar::from_one_another;
use crate::error::CalibrationError;
use crate::points::Base;
use crate::rotary_ballbar::{Location, out_of_place};
use columns::Columns;
use measured::Measured;
use ownership::Normal;

/// What the rows say.
#[derive(Clone, Debug)]
pub struct RotaryTables {
    /// The axes that turned.
    pub axes: Vec<TurnedAxis>,
    /// Axes of the chain that stood still within every run: as in the base.
    pub still: Vec<Axis>,
    /// Everything that was fitted.
    pub terms: Vec<FoundTerm>,
    /// Symbols of what these rows cannot tell apart, set by set: none of them is written.
    pub not_told_apart: Vec<Vec<String>>,
    /// Symbols of which these rows say nothing.
    pub unseen: Vec<String>,
    /// Parts of error functions that count as location errors, since these rows do not tell them from those: part and owners.
    pub counted_as: Vec<(String, Vec<String>)>,
    /// Balls at other places would tell some of what is not told apart, not seen or counted as another.
    pub other_rows_tell: bool,
    /// Error functions of the changed machine at nodes fine enough for the profile's interpolation.
    pub tables: Vec<WrittenTable>,
    /// The changed machine.
    pub description: Description,
    /// What the set-up of each run adds, workpiece frame, mm.
    pub offsets_mm: Vec<Vector>,
    /// Root mean square that the base leaves of the readings, and that the changed machine leaves, run by run about its own
    /// offset, mm.
    pub rms_mm: [f64; 2],
    /// Scatter of readings that repeat one command within a run, mm, and its degrees of freedom; `None` without repeats.
    pub repeats_mm: Option<(f64, usize)>,
    /// What runs leave one by one, mm, where that is much less than together by more than chance: a doubt.
    pub alone_mm: Option<f64>,
    /// Root mean square of the uncertainties that were stated, mm.
    pub stated_mm: Option<f64>,
    /// Half width that 95 % of the places and angles keep, mm: equation (51c).
    pub field_u95_mm: f64,
    /// The adjustment: kept offsets, then `terms`.
    pub estimate: Estimate,
}

/// How readings that no fit has seen agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOut {
    /// So many readings.
    pub readings: usize,
    /// Root mean square by the base, each run about its own offset, mm.
    pub rms_before_mm: f64,
    /// The same by the changed machine.
    pub rms_after_mm: f64,
    /// The largest of those.
    pub max_after_mm: f64,
}

/// An axis turns within a run where its angles differ by more, rad.
const TURNS_RAD: f64 = 1e-6;

/// Balls of a head this far beside a line, mm: 100 µrad of it are 1 µm there, the noise of a reading.
const ASIDE_MM: f64 = 10.0;

/// A ball nearer to an axis than this says nothing of its tilts, mm.
pub const ON_AXIS_MM: f64 = 1.0;

/// What is left below is nothing that a table is worth, mm: tables are written to 0.01 µm.
const FINEST_MM: f64 = 5e-6;

/// The adjustment is settled where a step changes no prediction by more, mm: digits of the readings end there.
const SETTLED_MM: f64 = 1e-7;

/// Fits the location errors and error functions of all axes that turn.
///
/// `runs` are the names of the runs.
///
/// # Errors
/// [`CalibrationError::Axes`] where no rotary axis turns within a run, [`CalibrationError::TooFew`],
/// [`CalibrationError::Unobservable`] where no location error is determined, [`CalibrationError::Outlier`], and
/// [`CalibrationError::Contradicted`] for readings that are of no one machine.
pub fn calibrate(
    rows: &[BallReading],
    base: &Base,
    runs: &[String],
) -> Result<RotaryTables, CalibrationError> {
    let description = &base.description;
    let (turning, still) = turning(rows, description)?;
    styli_of_a_head(rows, description, &turning)?;
    let commands: Vec<Command> = rows.iter().map(|row| row.command).collect();
    let columns = Columns::new(description, &turning, &commands)?;
    let measured = Measured::new(rows, &columns, runs.len())?;
    let mut axes = turned_axes(rows, &turning, &columns);
    choose_groups(&mut axes, &measured, description);
    let terms = all_terms(&axes, &measured, &|axis: &TurnedAxis| axis.groups);
    let design = measured.design(&terms);
    let normal = Normal::new(&measured.weighted(&design), &measured.weighted_rest(description));
    let offsets = measured.offsets();
    let order: Vec<usize> = (0..offsets + terms.len()).collect();
    let sweep = normal.sweep(&order);
    let readings = measured.values.len();
    if (readings - sweep.kept.len().min(readings)) * 10 < readings {
        return Err(CalibrationError::TooFew(both!(
            "{readings} readings for {} unknowns",
            "отсчётов {readings} на {} неизвестных",
            sweep.kept.len()
        )));
    }
    let name = |column: usize| -> Option<Term> { column.checked_sub(offsets).map(|k| terms[k]) };
    let hidden = hidden_from_all(&axes, description, &terms)?;
    let open = judgement::Open::new(&sweep, &name, &hidden);
    // Fit what is kept, all of it: what is not written is not to bend the rest.
    let kept: Vec<Term> = sweep.kept.iter().filter_map(|column| name(*column)).collect();
    let kept_offsets = sweep.kept.len() - kept.len();
    let jacobian = DMatrix::from_fn(readings, sweep.kept.len(), |i, k| design[(i, sweep.kept[k])]);
    let nodes = nodes(rows);
    let forward = |x: &DVector<f64>| {
        let own = &x.as_slice()[kept_offsets..];
        let machine = terms::changed(description, &nodes, &kept, own);
        let mut predicted = measured.predicted(&machine);
        // Offsets and reversals are linear, and no part of the machine.
        for (k, column) in jacobian.column_iter().enumerate() {
            let linear = k < kept_offsets || matches!(kept[k - kept_offsets], Term::Reversal(_));
            if linear {
                predicted.axpy(x[k], &column, 1.0);
            }
        }
        predicted
    };
    let gauge = DMatrix::zeros(0, sweep.kept.len());
    let problem = Problem {
        readings: &measured.values,
        noise: Noise::Relative(&measured.relative),
        forward: &forward,
        jacobian: Jacobian::Constant(&jacobian),
        gauge: &gauge,
        settled: SETTLED_MM,
    };
    let mut estimate = adjust(&problem, &DVector::zeros(sweep.kept.len()))
        .map_err(|error| CalibrationError::Contradicted(error.text()))?;
    judgement::no_outlier(&estimate, &measured)?;
    let alone_mm = judgement::runs_alone(&estimate, &measured, &design, &sweep.kept)?;
    let repeats_mm = judgement::repeats(&mut estimate, &measured);
    let found: Vec<FoundTerm> = kept
        .iter()
        .enumerate()
        .map(|(k, term)| found_term(*term, kept_offsets + k, description, &estimate, &open))
        .collect();
    plausible(&found)?;
    if !found.iter().any(|f| f.is_written && matches!(f.term, Term::Location(_))) {
        return Err(nothing_found(&axes, &open));
    }
    let covariance =
        estimate.covariance.view((kept_offsets, kept_offsets), (kept.len(), kept.len())).into_owned();
    let factor = estimate.coverage_factor_95();
    let tables = tables::written(base, &axes, &found, &covariance, factor);
    let written = tables::machine(base, &found, &tables);
    let rms_mm = [measured.rms_mm(description)?, measured.rms_mm(&written)?];
    let field_u95_mm = tables::field_u95_mm(rows, base, &axes, &found, &covariance, factor)?;
    let offsets_mm = measured.offsets_mm(&sweep.kept[..kept_offsets], &estimate.values);
    Ok(RotaryTables {
        axes,
        still,
        terms: found,
        not_told_apart: open.not_told_apart,
        unseen: open.unseen,
        counted_as: open.counted_as,
        other_rows_tell: open.other_rows_tell,
        tables,
        description: written,
        offsets_mm,
        rms_mm,
        repeats_mm,
        alone_mm,
        stated_mm: measured.stated_mm,
        field_u95_mm,
        estimate,
    })
}

impl RotaryTables {
    /// Judges the changed machine by readings that no fit has seen, each run about its own offset.
    ///
    /// # Errors
    /// [`CalibrationError::Axes`] where the base is no machine.
    pub fn held_out(&self, rows: &[BallReading], base: &Base) -> Result<HeldOut, CalibrationError> {
        let runs = rows.iter().map(|row| row.run + 1).max().unwrap_or(0);
        let columns = Columns::new(&base.description, &[], &[])?;
        let measured = Measured::new(rows, &columns, runs)?;
        let after = measured.about_offsets_mm(&self.description)?;
        Ok(HeldOut {
            readings: measured.values.len(),
            rms_before_mm: measured.rms_mm(&base.description)?,
            rms_after_mm: measured.rms_mm(&self.description)?,
            max_after_mm: after.amax(),
        })
    }
}

/// Rotary axes that turn within a run, from the workpiece on, and those that stand.
fn turning(
    rows: &[BallReading],
    description: &Description,
) -> Result<(Vec<Axis>, Vec<Axis>), CalibrationError> {
    let rotary: Vec<Axis> = description.chain.axes().filter(|axis| !axis.is_linear()).collect();
    if rotary.is_empty() {
        return Err(CalibrationError::Axes(both!(
            "the chain {} has no rotary axis",
            "в цепи {} нет поворотной оси",
            description.chain
        )));
    }
    let turns = |axis: &Axis| {
        let angle = |row: &BallReading| row.command.rotary_rad[axis.direction()];
        rows.iter().any(|row| {
            let first = rows.iter().find(|other| other.run == row.run);
            first.is_some_and(|first| (angle(row) - angle(first)).abs() > TURNS_RAD)
        })
    };
    let (moved, still): (Vec<Axis>, Vec<Axis>) = rotary.into_iter().partition(turns);
    if moved.is_empty() {
        let names: Vec<Text> = still.iter().map(|axis| Text::same(axis.to_string())).collect();
        return Err(CalibrationError::Axes(both!(
            "every run stands at one angle of {}: where nothing turns, nothing is seen of a rotary axis",
            "в каждой серии один угол {:#}: где ничего не поворачивается, поворотной оси не видно",
            and(&names)
        )));
    }
    Ok((moved, still))
}

fn turned_axes(rows: &[BallReading], turning: &[Axis], columns: &Columns) -> Vec<TurnedAxis> {
    let of = |axis: &Axis| {
        let angles: Vec<f64> = rows.iter().map(|row| row.command.rotary_rad[axis.direction()]).collect();
        let basis = Basis::of(&angles);
        let arm = |row: usize| columns.about_itself(*axis, row).norm();
        TurnedAxis {
            axis: *axis,
            angles: basis.distinct(&angles),
            range_rad: [
                angles.iter().copied().fold(f64::INFINITY, f64::min),
                angles.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            ],
            basis,
            groups: 0,
            most_groups: basis.most_groups(&angles),
            arm_mm: (0..rows.len()).map(arm).fold(0.0, f64::max),
        }
    };
    turning.iter().map(of).collect()
}

/// Distinct angles of A, B, C, rising, rad.
fn nodes(rows: &[BallReading]) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|axis| {
        let mut angles: Vec<f64> = rows.iter().map(|row| row.command.rotary_rad[axis]).collect();
        angles.sort_by(f64::total_cmp);
        angles.dedup();
        angles
    })
}

/// Terms in the order of precedence: locations, reversals, then group by group what is finer.
fn all_terms(
    axes: &[TurnedAxis],
    measured: &Measured<'_>,
    groups: &dyn Fn(&TurnedAxis) -> usize,
) -> Vec<Term> {
    let mut terms: Vec<Term> =
        axes.iter().flat_map(|own| Location::all(own.axis)).map(Term::Location).collect();
    terms.extend(
        axes.iter().filter(|own| measured.comes_from_both(own.axis)).map(|own| Term::Reversal(own.axis)),
    );
    terms.extend(coefficients(axes, groups));
    terms
}

fn coefficients(axes: &[TurnedAxis], groups: &dyn Fn(&TurnedAxis) -> usize) -> Vec<Term> {
    let mut terms = Vec::new();
    for group in 0..axes.iter().map(groups).max().unwrap_or(0) {
        for own in axes.iter().filter(|own| group < groups(own)) {
            let (axis, basis) = (own.axis, own.basis);
            for function in 0..6 {
                for which in 0..basis.values(group, 0.0).len() {
                    terms.push(Term::Coefficient { axis, function, basis, group, which });
                }
            }
        }
    }
    terms
}

/// How fine the error functions of each axis are, by Akaike's criterion for small samples: equation (103).
fn choose_groups(axes: &mut [TurnedAxis], measured: &Measured<'_>, description: &Description) {
    let terms = all_terms(axes, measured, &|own| own.most_groups);
    let design = measured.weighted(&measured.design(&terms));
    let normal = Normal::new(&design, &measured.weighted_rest(description));
    // A repeat is no new place: what repeats differ by says nothing of a function of the angle.
    let (offsets, repeats) = (measured.offsets(), measured.repeats);
    let readings = (measured.values.len() - repeats.free) as f64;
    let floor = readings * FINEST_MM * FINEST_MM;
    let mut chosen: Vec<usize> = axes.iter().map(|own| own.most_groups).collect();
    // What one axis needs may hide behind what another one is allowed: twice round settles it.
    for _ in 0..2 {
        for k in 0..axes.len() {
            let group_of = |term: &Term| match term {
                Term::Coefficient { axis, group, .. } => Some((*axis, *group)),
                _ => None,
            };
            let column = |wanted: &dyn Fn(&Term) -> bool| -> Vec<usize> {
                terms.iter().enumerate().filter(|(_, t)| wanted(t)).map(|(t, _)| offsets + t).collect()
            };
            let mut order: Vec<usize> = (0..offsets).collect();
            order.extend(column(&|term| group_of(term).is_none()));
            for (other, groups) in axes.iter().zip(&chosen).filter(|(other, _)| other.axis != axes[k].axis) {
                order.extend(column(&|term| {
                    group_of(term).is_some_and(|(a, g)| a == other.axis && g < *groups)
                }));
            }
            let mut ends = vec![order.len()];
            for group in 0..axes[k].most_groups {
                order.extend(column(&|term| group_of(term) == Some((axes[k].axis, group))));
                ends.push(order.len());
            }
            let sweep = normal.sweep(&order);
            let criterion = |groups: usize| {
                let (left, kept) = sweep.after[ends[groups] - 1];
                let unknowns = kept as f64 + 1.0;
                let free = readings - unknowns - 1.0;
                if free < 0.1 * readings {
                    return f64::INFINITY;
                }
                readings * units::math::ln((left - repeats.squares).max(floor) / readings)
                    + 2.0 * unknowns * (1.0 + (unknowns + 1.0) / free)
            };
            let best = (0..=axes[k].most_groups).min_by(|a, b| criterion(*a).total_cmp(&criterion(*b)));
            chosen[k] = best.unwrap_or(0);
        }
    }
    for (own, groups) in axes.iter_mut().zip(chosen) {
        own.groups = groups;
    }
}

/// Terms that no balls anywhere could tell from others: equation (102).
fn hidden_from_all(
    axes: &[TurnedAxis],
    description: &Description,
    terms: &[Term],
) -> Result<Vec<Term>, CalibrationError> {
    let rows = measured::everywhere(axes, description)?;
    let ideal = measured::ideal(description);
    let commands: Vec<Command> = rows.iter().map(|row| row.command).collect();
    let turning: Vec<Axis> = axes.iter().map(|own| own.axis).collect();
    let columns = Columns::new(&ideal, &turning, &commands)?;
    let runs = rows.iter().map(|row| row.run + 1).max().unwrap_or(0);
    let measured = Measured::new(&rows, &columns, runs)?;
    // What is finer than once per turn looks like no location error and like no mounting.
    let coarse: Vec<Term> = terms
        .iter()
        .filter(|term| !matches!(term, Term::Coefficient { group: 2.., .. } | Term::Reversal(_)))
        .copied()
        .collect();
    let design = measured.design(&coarse);
    let normal = Normal::new(&design, &measured.values);
    let offsets = measured.offsets();
    let order: Vec<usize> = (0..offsets + coarse.len()).collect();
    let owned = normal.sweep(&order).owned;
    Ok(owned.into_iter().filter_map(|(column, _)| column.checked_sub(offsets).map(|k| coarse[k])).collect())
}

fn found_term(
    term: Term,
    parameter: usize,
    description: &Description,
    estimate: &Estimate,
    open: &judgement::Open,
) -> FoundTerm {
    let base = match term {
        Term::Location(location) => location.of(description),
        _ => 0.0,
    };
    FoundTerm {
        term,
        base,
        change: estimate.values[parameter],
        standard_uncertainty: estimate.standard_uncertainty(parameter),
        half_width_95: estimate.half_width_95(parameter),
        is_written: open.writes(&term),
    }
}

fn plausible(found: &[FoundTerm]) -> Result<(), CalibrationError> {
    let mut written = found.iter().filter(|f| f.is_written);
    let wild = |f: &FoundTerm| Some((f.term, out_of_place(f.term.component(), f.base + f.change)?));
    let Some((term, (size, unit))) = written.find_map(wild) else { return Ok(()) };
    Err(CalibrationError::Contradicted(both!(
        "{} would be {size:.1} {unit}: no axis is so far from its place; are centre_mm and the angles those of this machine?",
        "{} была бы {size:.1} {unit:#}: так далеко от своего места ось не бывает; centre_mm и углы от этого станка?",
        term.name()
    )))
}

/// Refuses balls on one line of a head that turns: what its axes do beside that line no reading shows, and what several of
/// them do along it together passes for one of them.
fn styli_of_a_head(
    rows: &[BallReading],
    description: &Description,
    turning: &[Axis],
) -> Result<(), CalibrationError> {
    let heads: Vec<Axis> =
        description.chain.head().iter().copied().filter(|axis| turning.contains(axis)).collect();
    let Some(first) = rows.first().filter(|_| !heads.is_empty()) else { return Ok(()) };
    let from = |row: &BallReading| row.command.tool_mm - first.command.tool_mm;
    let longest = rows.iter().map(from).fold(Vector::zeros(), |a, b| if b.norm() > a.norm() { b } else { a });
    let aside_mm = match longest.try_normalize(0.0) {
        Some(line) => rows.iter().map(|row| from(row).cross(&line).norm()).fold(0.0, f64::max),
        None => 0.0,
    };
    if aside_mm >= ASIDE_MM {
        return Ok(());
    }
    let names: Vec<Text> = heads.iter().map(|axis| Text::same(axis.to_string())).collect();
    Err(CalibrationError::Unobservable(both!(
        "what {} of the head does beside one line: the balls of all rows lie on it ({aside_mm:.1} mm beside it at most); read with styli that do not, {ASIDE_MM} mm or more beside the others",
        "как влияют {:#} головы в стороне от одной прямой: шары всех строк лежат на ней (не дальше {aside_mm:.1} мм); снимите щупами, которые стоят в стороне на {ASIDE_MM} мм и больше",
        and(&names)
    )))
}

/// `A and C`.
fn and(names: &[Text]) -> Text {
    let between = Text::pair(" and ", " и ");
    let mut all = Text::EMPTY;
    for (index, name) in names.iter().enumerate() {
        if index > 0 {
            all.push(&between);
        }
        all.push(name);
    }
    all
}

/// Why no location error is determined.
fn nothing_found(axes: &[TurnedAxis], open: &judgement::Open) -> CalibrationError {
    if let Some(own) = axes.iter().find(|own| own.arm_mm < ON_AXIS_MM) {
        return CalibrationError::Unobservable(both!(
            "where the axis of {} is from how it leans: the ball lies on the axis in every run, {:.3} mm from it at most",
            "положение оси {} и её наклон: во всех сериях шар лежит на самой оси, не дальше {:.3} мм от неё",
            own.axis,
            own.arm_mm
        ));
    }
    let named = |names: &[String]| names.iter().map(Text::same).collect::<Vec<_>>();
    let mut sets: Vec<Text> = open.not_told_apart.iter().map(|set| from_one_another(&named(set))).collect();
    sets.extend(named(&open.unseen));
    CalibrationError::Unobservable(Text::join(&sets, "; "))
}
