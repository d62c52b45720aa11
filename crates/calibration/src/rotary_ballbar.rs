//! Location errors of a table's rotary axes from ball-bar tests in which one axis turns: equations (47) and (48).
//!
//! For any table: A and C, B and C, whichever carries the other, or a single axis. The length that is read is the distance of two
//! balls as the workpiece sees them: the tool ball where the base's whole model puts it, the location errors of the table's axes
//! changed; the other one where the bar put it at angle 0. Locations are those of the base's `centre_mm`, wherever the
//! readings were taken.

use diagnostic::{Speaks, Text, both};
use machine_model::{Axis, Chain, Command, Component, Description, Engine, Range, Vector, WithEffects};
use nalgebra::{DMatrix, DVector};
use units::math;

use crate::adjustment::{Estimate, Jacobian, Noise, Problem, adjust};
use crate::ballbar::{changed, each_changed, field_u95_mm, no_outlier, open_error, too_few};
use crate::error::CalibrationError;
use crate::field;

/// What turns in a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turning {
    /// An axis of the table.
    Axis(Axis),
    /// The spindle, about Z: shows where the tool ball sits against the spindle's axis.
    Spindle,
}

/// One test: one thing turns, everything else stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// What turns.
    pub turning: Turning,
    /// Where everything stands; the angle of what turns is not used.
    pub command: Command,
    /// Workpiece ball minus tool ball at angle 0 of what turns, mm, directions of the linear axes.
    pub bar_mm: Vector,
    /// Angle, rad, and length read, mm.
    pub readings: Vec<(f64, f64)>,
}

/// A location error of a rotary axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Location {
    /// The axis.
    pub axis: Axis,
    /// A shift (mm) or a tilt (rad).
    pub component: Component,
    /// Direction along or around which: 0 X, 1 Y, 2 Z.
    pub direction: usize,
}

impl Location {
    /// The four of an axis: `EY0A EZ0A EB0A EC0A` …
    pub(crate) fn all(axis: Axis) -> impl Iterator<Item = Self> {
        [Component::Linear, Component::Angular].into_iter().flat_map(move |component| {
            (0..3).filter(move |direction| *direction != axis.direction()).map(move |direction| Self {
                axis,
                component,
                direction,
            })
        })
    }

    /// Its symbol: `EX0C`.
    #[must_use]
    pub fn name(&self) -> String {
        let letter = match self.component {
            Component::Linear => Axis::ALL[self.direction],
            Component::Angular => Axis::ALL[3 + self.direction],
        };
        format!("E{letter}0{}", self.axis)
    }

    /// What a machine has of it, mm or rad.
    #[must_use]
    pub fn of(&self, machine: &Description) -> f64 {
        let axis = &machine.rotary[self.axis.direction()];
        match self.component {
            Component::Linear => axis.shift_mm[self.direction],
            Component::Angular => axis.tilt_rad[self.direction],
        }
    }

    /// Adds to what a machine has of it.
    pub(crate) fn add(&self, machine: &mut Description, by: f64) {
        let axis = &mut machine.rotary[self.axis.direction()];
        match self.component {
            Component::Linear => axis.shift_mm[self.direction] += by,
            Component::Angular => axis.tilt_rad[self.direction] += by,
        }
    }
}

/// A location error as found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Which.
    pub location: Location,
    /// The base's and its change, mm or rad.
    pub value: f64,
    /// The base's.
    pub base: f64,
    /// Half width of the 95 % interval.
    pub half_width_95: f64,
}

/// What the tests say.
#[derive(Clone, Debug)]
pub struct RotaryCalibration {
    /// The location errors of the axes that turned.
    pub locations: Vec<Found>,
    /// Tool ball against the spindle axis, mm: eX, eY.
    pub cup_mm: [f64; 2],
    /// Half widths of their 95 % intervals.
    pub cup_half_width_95_mm: [f64; 2],
    /// What the deviation keeps at 95 % of the places of the base's volume, at any angles, by what was fitted, mm.
    pub uncertainty_mm: f64,
    /// The lengths that the machine so found would have given, mm, a list a test.
    pub predicted_mm: Vec<Vec<f64>>,
    /// The adjustment behind them: the location errors' changes, the cup, then a length a test.
    pub estimate: Estimate,
}

/// Half the widths of the central differences: mm and rad.
const STEP_MM: f64 = 1e-2;
const STEP_RAD: f64 = 1e-5;

/// A location error beyond is no error of a machine.
const LARGEST_MM: f64 = 5.0;
const LARGEST_RAD: f64 = 0.05;

/// A location error larger than any machine's, as messages say it: in mm or mrad.
pub(crate) fn out_of_place(component: Component, value: f64) -> Option<(f64, Text)> {
    let (largest, scale, unit) = match component {
        Component::Linear => (LARGEST_MM, 1.0, Text::pair("mm", "мм")),
        Component::Angular => (LARGEST_RAD, 1e3, Text::pair("mrad", "мрад")),
    };
    (value.abs() > largest).then_some((value * scale, unit))
}

/// Lengths of one test by the whole model, without the bar's own error: equation (47).
fn lengths_mm(machine: &WithEffects, test: &Test, cup_mm: [f64; 2]) -> Vec<f64> {
    let at = |angle_rad: f64| {
        let mut command = test.command;
        let mut spindle_rad = 0.0;
        match test.turning {
            Turning::Axis(axis) => command.rotary_rad[axis.direction()] = angle_rad,
            Turning::Spindle => spindle_rad = angle_rad,
        }
        let (sine, cosine) = math::sin_cos(spindle_rad);
        let [x, y] = cup_mm;
        command.tool_mm += Vector::new(cosine * x - sine * y, sine * x + cosine * y, 0.0);
        command
    };
    let zero = at(0.0);
    let fixed = machine.predict(&zero).position_mm + machine.base().real_table_turn(&zero) * test.bar_mm;
    test.readings.iter().map(|(angle, _)| (machine.predict(&at(*angle)).position_mm - fixed).norm()).collect()
}

/// What the base would read, the tool ball on the spindle's axis, mm: a list a test.
///
/// # Errors
/// [`CalibrationError::Axes`] for an axis that is none of the table.
///
/// # Panics
/// Where a test has no machine.
pub fn expected_mm(tests: &[Test], machines: &[WithEffects]) -> Result<Vec<Vec<f64>>, CalibrationError> {
    only_of_the_table(tests, &machines[0].base().description().chain)?;
    Ok(tests.iter().zip(machines).map(|(test, machine)| lengths_mm(machine, test, [0.0; 2])).collect())
}

/// Refuses tests of an axis that does not turn the table.
fn only_of_the_table(tests: &[Test], chain: &Chain) -> Result<(), CalibrationError> {
    for test in tests {
        let Turning::Axis(axis) = test.turning else { continue };
        if chain.head().contains(&axis) {
            return Err(CalibrationError::Axes(both!(
                "{axis} turns the tool on {chain}: location errors are found of axes that turn the table, not of a head's",
                "{axis} поворачивает на {chain} инструмент: погрешности положения находят у осей стола, а не головы"
            )));
        }
        if !chain.table().contains(&axis) {
            return Err(CalibrationError::Axes(both!(
                "{axis} turns, which is not in {chain}",
                "поворачивается {axis}, а в {chain} её нет"
            )));
        }
    }
    Ok(())
}

/// The machine with changed location errors.
fn machine(base: &WithEffects, locations: &[Location], x: &DVector<f64>) -> WithEffects {
    changed(base, |description| {
        for (k, location) in locations.iter().enumerate() {
            location.add(description, x[k]);
        }
    })
}

/// Fits all tests together; `machines` are the one base, under the conditions of each test.
///
/// Unknown besides the location errors of the axes that turned: where the tool ball sits in the spindle (the same in all tests), and the
/// length of the bar in each test. How far the tool ball stands along the spindle is taken as the tool's length says; an axis of the
/// table that turned in no test keeps what the base says of it.
///
/// # Errors
/// [`CalibrationError::Axes`] for an axis that is none of the table, [`CalibrationError::Unobservable`] with the names of
/// what the tests leave open, [`CalibrationError::TooFew`]; [`CalibrationError::Outlier`] and [`CalibrationError::Contradicted`] for
/// readings that are none of this table.
///
/// # Panics
/// Where a test has no machine.
pub fn calibrate(tests: &[Test], machines: &[WithEffects]) -> Result<RotaryCalibration, CalibrationError> {
    only_of_the_table(tests, &machines[0].base().description().chain)?;
    let turned = |axis: &Axis| tests.iter().any(|t| t.turning == Turning::Axis(*axis));
    let locations: Vec<Location> =
        Axis::ALL.into_iter().filter(|axis| turned(axis)).flat_map(Location::all).collect();
    let cup = locations.len();
    let setup = cup + 2;
    let mut names: Vec<Text> = locations.iter().map(|l| Text::same(l.name())).collect();
    names.extend(["eX", "eY"].map(Text::same));
    names.extend(tests.iter().map(|_| Text::pair("the bar's length", "длина измерителя")));
    let rows = tests.iter().map(|t| t.readings.len()).sum();
    too_few(rows, names.len())?;
    let predicted = |x: &DVector<f64>| -> Vec<Vec<f64>> {
        let machines = each_changed(machines, |base| machine(base, &locations, x));
        let each = tests.iter().zip(&machines).enumerate().map(|(k, (test, machine))| {
            let lengths = lengths_mm(machine, test, [x[cup], x[cup + 1]]);
            lengths.into_iter().map(|length| length + x[setup + k]).collect()
        });
        each.collect()
    };
    let forward = |x: &DVector<f64>| DVector::from_vec(predicted(x).concat());
    let read = DVector::from_iterator(rows, tests.iter().flat_map(|t| t.readings.iter().map(|r| r.1)));
    let step = |k: usize| match locations.get(k).map(|location| location.component) {
        Some(Component::Angular) => STEP_RAD,
        Some(Component::Linear) | None => STEP_MM,
    };
    let steps: Vec<f64> = (0..names.len()).map(step).collect();
    let problem = Problem {
        readings: &read,
        noise: Noise::Common,
        forward: &forward,
        jacobian: Jacobian::Numerical { steps: &steps },
        gauge: &DMatrix::zeros(0, names.len()),
        settled: 1e-9,
    };
    let estimate = adjust(&problem, &DVector::zeros(names.len()))
        .map_err(|error| CalibrationError::Contradicted(error.text()))?;
    open_error(&estimate, &names)?;
    no_outlier(&estimate)?;
    let x = &estimate.values;
    let found: Vec<Found> = locations
        .iter()
        .enumerate()
        .map(|(k, location)| {
            let base = location.of(machines[0].base().description());
            Found { location: *location, value: base + x[k], base, half_width_95: estimate.half_width_95(k) }
        })
        .collect();
    let wild = |f: &Found| Some((f.location, out_of_place(f.location.component, f.value)?));
    if let Some((location, (size, unit))) = found.iter().find_map(wild) {
        return Err(CalibrationError::Contradicted(both!(
            "{} would be {size:.1} {unit}: no table is so far from its place",
            "{} была бы {size:.1} {unit:#}: так далеко от своего места стол не бывает",
            location.name()
        )));
    }
    Ok(RotaryCalibration {
        locations: found,
        cup_mm: [x[cup], x[cup + 1]],
        cup_half_width_95_mm: [estimate.half_width_95(cup), estimate.half_width_95(cup + 1)],
        uncertainty_mm: uncertainty_mm(&estimate, &locations, &steps, &machines[0]),
        predicted_mm: predicted(x),
        estimate,
    })
}

/// All over the volume, the table's axes at angles all over their travel.
fn uncertainty_mm(estimate: &Estimate, locations: &[Location], steps: &[f64], base: &WithEffects) -> f64 {
    let description = base.base().description();
    let turned = |axis: &Axis| {
        let Range { low, high } = description.rotary[axis.direction()].travel_rad;
        let turn = std::f64::consts::TAU;
        if high - low < turn { Range { low, high } } else { Range { low: 0.0, high: turn } }
    };
    let table = description.chain.table();
    let ranges: Vec<Range> = base.volume().0.into_iter().chain(table.iter().map(turned)).collect();
    let command = |place: &Vec<f64>| {
        let mut command = Command { linear_mm: Vector::from_fn(|i, _| place[i]), ..Default::default() };
        for (axis, angle) in table.iter().zip(&place[3..]) {
            command.rotary_rad[axis.direction()] = *angle;
        }
        command
    };
    let commands: Vec<Command> = field::places(&ranges).iter().map(command).collect();
    let positions = |x: &DVector<f64>| {
        let machine = machine(base, locations, x);
        commands.iter().map(|c| machine.predict(c).position_mm).collect()
    };
    let changed: Vec<usize> = (0..locations.len()).collect();
    field_u95_mm(estimate, &positions, &changed, steps)
}
