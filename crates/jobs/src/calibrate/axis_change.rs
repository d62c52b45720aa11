//! What an interferometer read, against everything the base says: the change of each axis, and of the angles between
//! them.

use calibration::functions::{self, Function, FunctionReading};
use calibration::measured_line::{
    AxisOnNodes, FunctionSets, Gauge, MeasuredLine, Zero, angles_between, apply_gauge, field_u95_mm,
    settle_directions, squareness_for,
};
use diagnostic::{both, notice};
use machine_model::effects::{Conditions, EffectTerm};
use machine_model::{
    Axis, Chain, Description, Interpolation, LinearAxis, Range, RotaryAxis, Squareness, Vector, WithEffects,
};
use machine_profile::EngineError;
use measurement_files::series::Series;

use crate::conditions;
use crate::message::{Failure, OPTION};

use super::codes::{AXES, QUESTION, body, failure};
use super::options::Interferometer;
use super::output::{Output, SHORTEST_MM};
use super::sources;
use super::squareness::Asked;
use super::work::Work;
use crate::figures::short;

/// The base as it was read, and where.
pub(super) struct Session {
    /// The base (a perfect machine without one), as far as the targets reach.
    description: Description,
    /// Functions of each axis that the base has, where it has tables.
    given: [Option<[bool; 6]>; 3],
    interpolation: Interpolation,
    effects: Vec<EffectTerm>,
    conditions: Conditions,
    pub(super) lines: [MeasuredLine; 3],
    /// Where each axis was read; of the others, where the base knows them.
    pub(super) targets_mm: [Vec<f64>; 3],
    measured: [bool; 3],
    /// As far as the base's own tables go.
    known_mm: [Option<Range>; 3],
    has_base: bool,
}

/// A machine without errors, which as yet goes nowhere.
fn perfect(chain: &Chain) -> Description {
    Description {
        chain: chain.clone(),
        linear: std::array::from_fn(|_| LinearAxis::perfect(Range { low: f64::MAX, high: f64::MIN })),
        rotary: std::array::from_fn(|_| RotaryAxis::perfect(Vector::zeros())),
        squareness: Squareness::default(),
    }
}

impl Session {
    /// The machine before, and the lines.
    ///
    /// # Errors
    /// Targets or lines outside the base's travel, conditions that its effects need.
    pub(super) fn new(
        arguments: &Interferometer,
        work: &Work<'_>,
        output: &Output,
        chain: &Chain,
        all: &[Series],
    ) -> Result<Self, Failure> {
        let base = output.base.as_ref();
        let mut targets_mm: [Vec<f64>; 3] = Default::default();
        for series in all {
            targets_mm[series.axis.direction()].extend(series.readings.iter().map(|r| r.position_mm));
        }
        targets_mm.iter_mut().for_each(rising);
        let measured = targets_mm.each_ref().map(|targets| !targets.is_empty());
        let mut description = base.map_or_else(|| perfect(chain), |base| base.description.clone());
        let lines = lines(arguments, output, &description, &targets_mm)?;
        for axis in Axis::ALL.into_iter().take(3) {
            inside_travel(arguments, output, &description, axis, all)?;
        }
        let given: [Option<[bool; 6]>; 3] =
            std::array::from_fn(|k| base.and_then(|base| base.rows[k].as_ref()).map(|rows| rows.given));
        let interpolation = base.map_or(Interpolation::Linear, |base| base.interpolation);
        let known_mm = description.linear.each_ref().map(|axis| {
            let nodes = tables_nodes(axis);
            nodes.first().zip(nodes.last()).map(|(low, high)| Range { low: *low, high: *high })
        });
        for (k, axis) in description.linear.iter_mut().enumerate() {
            let places: Vec<f64> =
                targets_mm[k].iter().copied().chain(lines.iter().map(|line| line.at_mm[k])).collect();
            for at in &places {
                // A micrometre more than a point: a model needs a volume.
                axis.travel_mm.low = axis.travel_mm.low.min(at - 0.5 * SHORTEST_MM);
                axis.travel_mm.high = axis.travel_mm.high.max(at + 0.5 * SHORTEST_MM);
            }
            if given[k].is_none() && measured[k] {
                axis.measured_at_mm = lines[k].at_mm;
                axis.measured_tool_mm = lines[k].optics_mm;
            }
            // Tables reach as far as is needed, with the values of their ends.
            let mut nodes = tables_nodes(axis);
            let (Some(low), Some(high)) = (nodes.first().copied(), nodes.last().copied()) else { continue };
            if places.iter().any(|at| *at < low || *at > high) {
                nodes.extend(places);
                rising(&mut nodes);
                let longer =
                    AxisOnNodes::new(axis, k, given[k].unwrap_or_default(), nodes, FunctionSets::AsInBase);
                if let Some(longer) = longer.axis(axis, interpolation) {
                    *axis = longer;
                }
            }
        }
        for (k, targets) in targets_mm.iter_mut().enumerate().filter(|(k, _)| !measured[*k]) {
            let Range { low, high } = description.linear[k].calibrated_mm();
            targets
                .extend((0..=LINE_CELLS).map(|i| low + (high - low) * f64::from(i) / f64::from(LINE_CELLS)));
        }
        let effects = match base {
            Some(base) => base.effect_terms().map_err(|error| conditions::failure(&error))?,
            None => Vec::new(),
        };
        let conditions = conditions::conditions(work.options)?;
        let has_base = base.is_some();
        Ok(Self {
            description,
            given,
            interpolation,
            effects,
            conditions,
            lines,
            targets_mm,
            measured,
            known_mm,
            has_base,
        })
    }

    /// True where the functions of an axis go onto tables of the base, and stay on the line of those.
    pub(super) fn keeps_line(&self, axis: Axis) -> bool {
        self.given[axis.direction()].is_some()
    }

    /// Where the numbers of an axis have their zero, of one whose functions belong to no model.
    pub(super) fn zero(&self, axis: Axis) -> Zero {
        if self.keeps_line(axis) { Zero::Base } else { Zero::New }
    }

    fn machine(&self, description: &Description, temperature_c: Option<f64>) -> Result<WithEffects, Failure> {
        let body = body(description)?;
        let mut conditions = self.conditions;
        if let Some(temperature) = temperature_c {
            conditions.temp_c = [Some(temperature); 3];
        }
        WithEffects::new(body, self.effects.clone(), conditions)
            .map_err(|error| conditions::failure(&EngineError::Condition(error)))
    }

    /// Functions of an axis: readings less the whole prediction of the base, freed of the set-up; equation (58).
    ///
    /// # Errors
    /// Runs that do not belong together.
    pub(super) fn change(
        &self,
        axis: Axis,
        all: &[Series],
        gauge: Gauge,
        temperature_c: Option<f64>,
    ) -> Result<[Option<Function>; 6], Failure> {
        let k = axis.direction();
        let mut description = self.description.clone();
        if gauge.zero == Zero::Model {
            // Functions of a model hold nothing of the other axes, nor of the angles between them.
            description.squareness = Squareness::default();
            for (_, data) in description.linear.iter_mut().enumerate().filter(|(other, _)| *other != k) {
                (data.errors, data.errors_negative, data.backlash_mm) = (None, None, 0.0);
            }
            let read = std::array::from_fn(|f| all.iter().any(|s| s.axis == axis && s.function == f));
            let data = &mut description.linear[k];
            let given = self.given[k].unwrap_or_default();
            let left =
                AxisOnNodes::new(data, k, given, tables_nodes(data), FunctionSets::AsInBase).without(k, read);
            data.backlash_mm = left.backlash_mm;
            if let Some(left) = left.axis(data, self.interpolation) {
                *data = left;
            }
        }
        let mut change: [Option<Function>; 6] = Default::default();
        let mut machines: Vec<(Option<f64>, WithEffects)> = Vec::new();
        for series in all.iter().filter(|series| series.axis == axis) {
            let mut rest: Vec<FunctionReading> = Vec::with_capacity(series.readings.len());
            for (reading, own) in sources::readings(series).into_iter().zip(&series.readings) {
                let temperature = own.temperature_c.or(temperature_c);
                let at = match machines.iter().position(|(known, _)| *known == temperature) {
                    Some(at) => at,
                    None => {
                        machines.push((temperature, self.machine(&description, temperature)?));
                        machines.len() - 1
                    }
                };
                let motion = self.lines[k].motion(&machines[at].1, reading.position_mm, reading.direction);
                rest.push(FunctionReading { value: reading.value - motion[series.function], ..reading });
            }
            let fail = |error: &calibration::CalibrationError| failure(&series.source, &[], error);
            let runs = functions::runs(&rest).map_err(|error| fail(&error))?;
            let mut function = functions::function(&rest).map_err(|error| fail(&error))?;
            settle_directions(&mut function, [runs.positive.len(), runs.negative.len()]);
            change[series.function] = Some(function);
        }
        apply_gauge(&mut change, &self.lines[k], gauge);
        Ok(change)
    }

    /// The axis as it is written: the base's functions with the change; those of a model in their place, as far as they
    /// go.
    ///
    /// # Errors
    /// Functions that have no range in common.
    pub(super) fn changed(
        &self,
        axis: Axis,
        change: &[Option<Function>; 6],
        zero: Zero,
    ) -> Result<AxisOnNodes, Failure> {
        let k = axis.direction();
        let data = &self.description.linear[k];
        let mut nodes = tables_nodes(data);
        let targets = &self.targets_mm[k];
        nodes.extend(targets);
        rising(&mut nodes);
        if let (Some(known), Zero::Base) = (self.known_mm[k], zero) {
            let (low, high) = (known.low.min(targets[0]), known.high.max(targets[targets.len() - 1]));
            nodes.retain(|q| low <= *q && *q <= high);
        } else {
            let common = change
                .iter()
                .flatten()
                .map(|f| (f.positions_mm[0], f.positions_mm[f.positions_mm.len() - 1]));
            let (low, high) = common.fold((f64::MIN, f64::MAX), |(l, h), (a, b)| (l.max(a), h.min(b)));
            nodes.retain(|q| low <= *q && *q <= high);
        }
        if nodes.len() < 2 {
            return Err(Failure::usage(notice!(QUESTION;
                "the functions of {axis} were measured over ranges without a common part",
                "функции {axis} измерены на участках без общей части";
                "leave one of them out", "уберите одну из них"
            )));
        }
        let sets = match change.iter().flatten().any(|f| f.directions.is_some()) {
            true => FunctionSets::ByDirection,
            false => FunctionSets::AsInBase,
        };
        let mut made = AxisOnNodes::new(data, k, self.given[k].unwrap_or_default(), nodes, sets);
        if zero == Zero::Model {
            made = made.without(k, change.each_ref().map(Option::is_some));
        }
        made.add(change, self.lines[k].arm_mm(&self.description));
        Ok(made)
    }

    /// The squareness with which the lines stand at the angles that were read, or, where none was read, at those of the
    /// base: (59).
    ///
    /// # Errors
    /// Conditions that the base's effects need.
    pub(super) fn squareness(
        &self,
        axes: &[Option<AxisOnNodes>; 3],
        asked: &Asked,
        temperature_c: Option<f64>,
    ) -> Result<Squareness, Failure> {
        let before = self.machine(&self.description, temperature_c)?;
        let known = angles_between(&self.lines, &self.targets_mm, &before);
        let wanted: [f64; 3] = std::array::from_fn(|k| asked.rad[k].unwrap_or(known[k]));
        let mut after = self.description.clone();
        for (data, made) in after.linear.iter_mut().zip(axes) {
            if let Some(made) = made
                && let Some(axis) = made.axis(data, self.interpolation)
            {
                *data = axis;
            }
        }
        squareness_for(&self.lines, &self.targets_mm, wanted, after.squareness, |squareness| {
            self.machine(&Description { squareness, ..after.clone() }, temperature_c)
        })
    }

    /// The base's own squareness.
    pub(super) fn squareness_before(&self) -> Squareness {
        self.description.squareness
    }

    /// Half width that 95 % of the volume's points keep, mm.
    pub(super) fn field_u95_mm(&self, changes: &[[Option<Function>; 6]; 3], relative: f64) -> Option<f64> {
        let order = self.description.chain.linear().map(Axis::direction);
        field_u95_mm(&self.lines, order, &self.targets_mm, changes, relative)
    }

    /// True where the angles between two axes cannot be known from what was read so far.
    pub(super) fn is_new(&self) -> bool {
        !self.has_base
    }

    /// Where every axis was, mm: the targets, or where it stood.
    pub(super) fn spans(&self) -> [[f64; 2]; 3] {
        std::array::from_fn(|k| match self.measured[k] {
            true => [self.targets_mm[k][0], self.targets_mm[k][self.targets_mm[k].len() - 1]],
            false => {
                let other = self.measured.iter().position(|measured| *measured).unwrap_or(0);
                [self.lines[other].at_mm[k]; 2]
            }
        })
    }
}

/// Cells between the places at which the line of an axis is taken from the base.
const LINE_CELLS: i32 = 8;

/// Rising, what is the same place once.
fn rising(places: &mut Vec<f64>) {
    places.sort_by(f64::total_cmp);
    places.dedup_by(|a, b| (*a - *b).abs() < 1e-4);
}

/// Nodes of both directions' tables, where both hold.
fn tables_nodes(axis: &LinearAxis) -> Vec<f64> {
    let tables = || [&axis.errors, &axis.errors_negative].into_iter().flatten();
    let mut nodes: Vec<f64> = tables().flat_map(|t| t.nodes()).copied().collect();
    nodes.retain(|q| tables().all(|t| t.range().low <= *q && *q <= t.range().high));
    rising(&mut nodes);
    nodes
}

/// The lines: through one place where that was said, else where the base was measured.
fn lines(
    arguments: &Interferometer,
    output: &Output,
    description: &Description,
    targets_mm: &[Vec<f64>; 3],
) -> Result<[MeasuredLine; 3], Failure> {
    let through = arguments.through.as_ref().map(|given| given.0);
    let optics = arguments.optics.as_ref().map_or([0.0; 3], |given| given.0);
    let said = arguments.through.is_some() || arguments.optics.is_some();
    let middle = |k: usize| match (targets_mm[k].first(), targets_mm[k].last()) {
        (Some(low), Some(high)) => 0.5 * (low + high),
        _ if output.base.is_some() => {
            let Range { low, high } = description.linear[k].calibrated_mm();
            0.5 * (low + high)
        }
        _ => 0.0,
    };
    Ok(std::array::from_fn(|axis| {
        let data = &description.linear[axis];
        let mut at_mm =
            through.map_or(if said { Vector::zeros() } else { data.measured_at_mm }, Vector::from);
        if through.is_none() {
            at_mm[axis] = middle(axis);
        }
        let optics_mm = if said { Vector::from(optics) } else { data.measured_tool_mm };
        MeasuredLine { axis, at_mm, optics_mm }
    }))
}

/// True where a base says itself how far an axis goes.
fn travel_said(output: &Output, axis: Axis, data: &LinearAxis) -> bool {
    let letter = axis.letter().to_string();
    output.text.says(&["axis", &letter, "travel_mm"])
        && data.travel_mm.high - data.travel_mm.low > 1.5 * SHORTEST_MM
}

/// Refuses targets and lines where the axis cannot go: another axis, another unit, another machine.
fn inside_travel(
    arguments: &Interferometer,
    output: &Output,
    description: &Description,
    axis: Axis,
    all: &[Series],
) -> Result<(), Failure> {
    let k = axis.direction();
    let data = &description.linear[k];
    if !travel_said(output, axis, data) {
        return Ok(());
    }
    let Range { low, high } = data.travel_mm;
    let beyond = |q: f64| q < low - SLACK_MM || q > high + SLACK_MM;
    let travel = both!(
        "the travel of {axis} in the base is {} to {} mm",
        "ход {axis} в исходном профиле — от {} до {} мм",
        short(low, 3),
        short(high, 3)
    );
    if let Some(at) = &arguments.through {
        let place = at.0[k];
        if beyond(place) {
            return Err(Failure::usage(notice!(OPTION;
                "`--through {at}`: {axis} does not go to {} mm: {travel}",
                "`--through {at}`: {axis} не доходит до {} мм: {travel:#}", short(place, 3);
                "give the machine position of the measured lines, in mm, and the base of this machine",
                "дайте положение измеренных линий на станке, в мм, и исходный профиль этого станка"
            )));
        }
    }
    for series in all.iter().filter(|series| series.axis == axis) {
        if let Some(reading) = series.readings.iter().find(|r| beyond(r.position_mm)) {
            return Err(Failure::usage(notice!(AXES;
                "{}: {} has a target at {} mm, but {travel}",
                "{}: у {} цель в {} мм, но {travel:#}", series.source, series.name(),
                short(reading.position_mm, 3);
                "are these the targets of this axis, in mm and machine coordinates, and is the base that of this machine?",
                "это цели этой оси, в мм и координатах станка, и исходный профиль — этого станка?"
            )));
        }
    }
    Ok(())
}

/// Targets may stand on the last step of the travel, mm.
const SLACK_MM: f64 = 0.01;
