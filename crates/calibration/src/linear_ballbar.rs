//! Squareness, scale mismatch and backlash from ball-bar circles of two linear axes: equation (50).
//!
//! The length that is read is the distance of two balls: the moving one stands where the base's whole model puts it, its squareness and
//! its play changed; where the fixed one stands in the plane of the circle, and how much longer the bar is than it
//! says, is the set-up of each run. Nothing is linearised: the fixed ball may be millimetres off.

use diagnostic::{Speaks, Text, both};
use std::cell::RefCell;

use machine_model::{Command, Engine, PathModel, Vector, WithEffects};
use nalgebra::{DMatrix, DVector};

use crate::adjustment::{Estimate, Jacobian, Noise, Problem, adjust};
use crate::ballbar::{RESOLVED_MM, changed, each_changed, field_u95_mm, no_outlier, open_error, too_few};
use crate::circular_test::{self, Cause, CircularTest, Known, Measured};
use crate::error::{CalibrationError, LETTERS};
use crate::field;
use crate::student::quantile;

/// One reading on a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleReading {
    /// Run: readings of one run share the set-up of the fixed ball.
    pub run: usize,
    /// What was commanded, with the direction in which each axis moved; 0 where unknown or standing.
    pub command: Command,
    /// Centre of the fixed ball as set up, machine coordinates, mm.
    pub centre_mm: Vector,
    /// Length read, mm.
    pub length_mm: f64,
}

/// A value with its standard uncertainty.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// mm or rad (or mm/mm).
    pub value: f64,
    /// What the base has of it; 0 where the base cannot hold it.
    pub base: f64,
    /// Standard uncertainty.
    pub uncertainty: f64,
    /// Half width of the 95 % interval.
    pub half_width_95: f64,
}

/// What circles say.
#[derive(Clone, Debug)]
pub struct CircleCalibration {
    /// EC0Y (plane XY), EB0Z (ZX), EA0Z (YZ), ISO 230-1 signs, rad, where that plane was measured: the base's and its change.
    pub squareness_rad: [Option<Term>; 3],
    /// Scale of the first minus scale of the second axis of the plane, beyond what the base has, in the same order of
    /// planes (X-Y, Z-X, Y-Z).
    pub mismatch: [Option<Term>; 3],
    /// Sum of the three mismatches, which is zero on every machine, where all three planes were measured.
    pub closure: Option<Term>,
    /// How much further each axis stands after coming from above than from below, mm, where directions are given: the base's at
    /// the centre of the circles and its change.
    pub backlash_mm: [Option<Term>; 3],
    /// What the deviation keeps at 95 % of the places of the base's volume, by what was fitted, mm.
    pub uncertainty_mm: f64,
    /// The planes as circular tests, with what each cause does in them.
    pub tests: Vec<CircularTest>,
    /// The adjustment behind them.
    pub estimate: Estimate,
}

/// First and second axis of the planes XY, ZX, YZ.
const PLANES: [[usize; 2]; 3] = [[0, 1], [2, 0], [1, 2]];

/// Squareness of the planes.
const SQUARENESS: [&str; 3] = ["EC0Y", "EB0Z", "EA0Z"];

/// A closure or a play this unlikely is no accident.
const CONTRADICTION_CHANCE: f64 = 1e-6;

/// [`RESOLVED_MM`] over an arm of 100 mm.
const RESOLVED_RATIO: f64 = 1e-6;

/// Half the widths of the central differences: rad or mm/mm, and mm.
const STEPS: [f64; 2] = [1e-5, 1e-2];

/// Plane of a run: the two axes that move.
fn plane(readings: &[CircleReading], run: usize) -> Result<usize, CalibrationError> {
    let own = || readings.iter().filter(|r| r.run == run);
    let span = |i: usize| {
        let values = || own().map(|r| r.command.linear_mm[i]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let moving: Vec<usize> = (0..3).filter(|&i| span(i) > 1e-3).collect();
    PLANES.iter().position(|p| moving.len() == 2 && p.iter().all(|i| moving.contains(i))).ok_or_else(|| {
        let names: Vec<String> = moving.iter().map(|&i| LETTERS[i].to_string()).collect();
        CalibrationError::Axes(both!(
            "a circle moves two axes; in this run {} move",
            "окружность обходят две оси, а в этом проходе движутся: {:#}",
            if names.is_empty() { Text::pair("none", "ни одна") } else { Text::same(names.join(", ")) }
        ))
    })
}

/// Where each parameter stands.
struct Layout {
    /// By plane.
    squareness: [Option<usize>; 3],
    /// By plane.
    mismatch: [Option<usize>; 3],
    /// By axis.
    play: [Option<usize>; 3],
    /// First of the three of run 0: fixed ball along the two axes of the plane, length of the bar.
    setup: usize,
    names: Vec<Text>,
}

impl Layout {
    fn new(readings: &[CircleReading], planes: &[usize]) -> Self {
        let mut names: Vec<Text> = Vec::new();
        let mut place = |name: Text| {
            names.push(name);
            names.len() - 1
        };
        let (mut squareness, mut mismatch, mut play) = ([None; 3], [None; 3], [None; 3]);
        for plane in (0..3).filter(|plane| planes.contains(plane)) {
            let [u, v] = PLANES[plane].map(|i| LETTERS[i]);
            squareness[plane] = Some(place(Text::same(SQUARENESS[plane])));
            mismatch[plane] = Some(place(both!("scale {u}-{v}", "масштаб {u}-{v}")));
        }
        for axis in 0..3 {
            let both = |sign: i8| readings.iter().any(|r| r.command.direction[axis] == sign);
            if both(1) && both(-1) {
                play[axis] = Some(place(both!("backlash {}", "люфт {}", LETTERS[axis])));
            }
        }
        let setup = names.len();
        for _ in planes {
            let ball = Text::pair("the fixed ball's place", "место неподвижного шарика");
            names.extend([ball.clone(), ball, Text::pair("the bar's length", "длина измерителя")]);
        }
        Self { squareness, mismatch, play, setup, names }
    }

    fn steps(&self) -> Vec<f64> {
        let angles = self.setup - self.play.iter().flatten().count();
        (0..self.names.len()).map(|k| if k < angles { STEPS[0] } else { STEPS[1] }).collect()
    }

    /// The machine with the parameters' squareness and play.
    fn machine(&self, base: &WithEffects, x: &DVector<f64>) -> WithEffects {
        let of = |k: Option<usize>| k.map_or(0.0, |k| x[k]);
        changed(base, |description| {
            description.squareness.ec0y_rad += of(self.squareness[0]);
            description.squareness.eb0z_rad += of(self.squareness[1]);
            description.squareness.ea0z_rad += of(self.squareness[2]);
            for (axis, data) in description.linear.iter_mut().enumerate() {
                data.backlash_mm += of(self.play[axis]);
            }
        })
    }
}

/// Fits all runs together; `machines` are the one base, under the conditions of each run.
///
/// Unknown per run: where the fixed ball really is in the plane, and the bar's length. So scales are known only against one
/// another: what both axes have in common looks like another length of the bar. Across the plane nothing shows where the
/// fixed ball stands: it is taken to stand where the base's errors would have put it.
///
/// # Errors
/// [`CalibrationError`] for runs that are no circles in a plane, for what the readings leave open, and for readings that
/// contradict one another: one far from all others, scales that do not add up, play that is negative everywhere.
///
/// # Panics
/// Where a reading's run has no machine.
pub fn calibrate(
    readings: &[CircleReading],
    machines: &[WithEffects],
) -> Result<CircleCalibration, CalibrationError> {
    let planes: Vec<usize> = (0..machines.len()).map(|run| plane(readings, run)).collect::<Result<_, _>>()?;
    let layout = Layout::new(readings, &planes);
    too_few(readings.len(), layout.names.len())?;
    let carried = carried(readings, machines);
    let nominal = |r: &CircleReading| r.command.linear_mm + machines[r.run].base().nominal_tool(&r.command);
    let arms_mm: Vec<Vector> = readings.iter().map(|r| nominal(r) - r.centre_mm).collect();
    // Two thirds of the parameters are set-up, which the machine does not know: its errors are kept.
    let kept: RefCell<Option<(DVector<f64>, Vec<Vector>)>> = RefCell::new(None);
    let forward = |x: &DVector<f64>| {
        let own = x.rows(0, layout.setup).into_owned();
        let mut kept = kept.borrow_mut();
        let errors = match kept.take() {
            Some((known, errors)) if known == own => errors,
            _ => {
                let machines = each_changed(machines, |base| layout.machine(base, x));
                readings.iter().map(|r| machines[r.run].error_mm(&r.command)).collect()
            }
        };
        let lengths = DVector::from_iterator(
            readings.len(),
            readings.iter().zip(&arms_mm).zip(&errors).map(|((r, arm), error_mm)| {
                layout.length_mm(x, r.run, planes[r.run], *arm, error_mm - carried[r.run])
            }),
        );
        *kept = Some((own, errors));
        lengths
    };
    let lengths = DVector::from_iterator(readings.len(), readings.iter().map(|r| r.length_mm));
    let problem = Problem {
        readings: &lengths,
        noise: Noise::Common,
        forward: &forward,
        jacobian: Jacobian::Numerical { steps: &layout.steps() },
        gauge: &DMatrix::zeros(0, layout.names.len()),
        settled: 1e-9,
    };
    let estimate = adjust(&problem, &DVector::zeros(layout.names.len()))
        .map_err(|error| CalibrationError::Contradicted(error.text()))?;
    open_error(&estimate, &layout.names)?;
    no_outlier(&estimate)?;
    let term = |k: usize, base: f64| Term {
        value: base + estimate.values[k],
        base,
        uncertainty: estimate.standard_uncertainty(k),
        half_width_95: estimate.half_width_95(k),
    };
    let base = &machines[0];
    let s = base.base().description().squareness;
    let squareness = [s.ec0y_rad, s.eb0z_rad, s.ea0z_rad];
    let squareness_rad = [0, 1, 2].map(|plane| layout.squareness[plane].map(|k| term(k, squareness[plane])));
    let mismatch = layout.mismatch.map(|k| k.map(|k| term(k, 0.0)));
    let middle =
        Command { linear_mm: readings[0].centre_mm - readings[0].command.tool_mm, ..readings[0].command };
    let backlash_mm =
        [0, 1, 2].map(|axis| layout.play[axis].map(|k| term(k, base.reversal_mm(axis, &middle))));
    let closure = closure(&estimate, layout.mismatch);
    let causes = layout.causes(&squareness_rad, &mismatch, &backlash_mm);
    let tests = tests(readings, &arms_mm, &planes, &causes, &forward, &layout, &estimate.values);
    let calibration = CircleCalibration {
        squareness_rad,
        mismatch,
        closure,
        backlash_mm,
        uncertainty_mm: uncertainty_mm(&estimate, &layout, base),
        tests,
        estimate,
    };
    calibration.is_possible()?;
    Ok(calibration)
}

/// Where the base's errors move the circle of each run as a whole, its fixed ball has moved with it, mm.
fn carried(readings: &[CircleReading], machines: &[WithEffects]) -> Vec<Vector> {
    let of_run = |(run, machine): (usize, &WithEffects)| {
        let own = || readings.iter().filter(|r| r.run == run);
        own().map(|r| machine.error_mm(&r.command)).sum::<Vector>() / own().count() as f64
    };
    machines.iter().enumerate().map(of_run).collect()
}

/// A cause with its place among the parameters and the value at which it does nothing.
struct OfPlane {
    plane: Option<usize>,
    known: Known,
    parameter: usize,
    nothing: f64,
}

impl Layout {
    /// What the bar of a run reads in its plane, by unknowns: its arm as commanded, and by how much that is off.
    fn length_mm(&self, x: &DVector<f64>, run: usize, plane: usize, mut arm: Vector, off_mm: Vector) -> f64 {
        let [u, v] = PLANES[plane];
        let half = 0.5 * self.mismatch[plane].map_or(0.0, |k| x[k]);
        let stretched = [half * arm[u], -half * arm[v]];
        arm += off_mm;
        let own = self.setup + 3 * run;
        arm[u] += stretched[0] - x[own];
        arm[v] += stretched[1] - x[own + 1];
        arm.norm() + x[own + 2]
    }

    /// Every cause that was fitted; of play, in every plane of its axis.
    fn causes(
        &self,
        squareness: &[Option<Term>; 3],
        mismatch: &[Option<Term>; 3],
        play: &[Option<Term>; 3],
    ) -> Vec<OfPlane> {
        let mut all = Vec::new();
        let mut put = |cause: Cause, plane: Option<usize>, parameter: Option<usize>, term: &Option<Term>| {
            let (Some(parameter), Some(term)) = (parameter, term) else { return };
            let share = if term.value == 0.0 { 0.0 } else { term.half_width_95 / term.value.abs() };
            all.push(OfPlane { plane, known: (cause, share), parameter, nothing: -term.base });
        };
        for k in 0..3 {
            put(Cause::Squareness, Some(k), self.squareness[k], &squareness[k]);
            put(Cause::Mismatch, Some(k), self.mismatch[k], &mismatch[k]);
            put(Cause::Backlash(k), None, self.play[k], &play[k]);
        }
        all
    }
}

impl OfPlane {
    fn is_in(&self, plane: usize) -> bool {
        match self.known.0 {
            Cause::Backlash(axis) => PLANES[plane].contains(&axis),
            _ => self.plane == Some(plane),
        }
    }
}

/// The planes one by one: what a cause does is the fitted length less the one that the machine would have without it.
fn tests(
    readings: &[CircleReading],
    arms_mm: &[Vector],
    planes: &[usize],
    causes: &[OfPlane],
    forward: &dyn Fn(&DVector<f64>) -> DVector<f64>,
    layout: &Layout,
    x: &DVector<f64>,
) -> Vec<CircularTest> {
    let fitted = forward(x);
    let parts: Vec<DVector<f64>> = causes
        .iter()
        .map(|cause| {
            let mut without = x.clone();
            without[cause.parameter] = cause.nothing;
            &fitted - forward(&without)
        })
        .collect();
    let of_plane = |plane: usize| {
        let own: Vec<usize> = (0..causes.len()).filter(|k| causes[*k].is_in(plane)).collect();
        let rows: Vec<usize> = (0..readings.len()).filter(|i| planes[readings[*i].run] == plane).collect();
        let [u, v] = PLANES[plane];
        let measured = |i: &usize| Measured {
            reading: *i,
            run: readings[*i].run,
            arm_mm: [arms_mm[*i][u], arms_mm[*i][v]],
            commanded_mm: arms_mm[*i].norm(),
            direction: [u, v].map(|axis| readings[*i].command.direction[axis]),
            length_mm: readings[*i].length_mm,
            fitted_mm: fitted[*i],
            causes_mm: own.iter().map(|k| parts[*k][*i]).collect(),
        };
        let all: Vec<Measured> = rows.iter().map(measured).collect();
        let known: Vec<Known> = own.iter().map(|k| causes[*k].known).collect();
        let centre = |run: usize| [x[layout.setup + 3 * run], x[layout.setup + 3 * run + 1]];
        circular_test::evaluate(plane, &all, &known, &centre)
    };
    (0..3).filter(|plane| planes.contains(plane)).map(of_plane).collect()
}

/// Sum of the three mismatches.
fn closure(estimate: &Estimate, mismatch: [Option<usize>; 3]) -> Option<Term> {
    let mut row = DVector::zeros(estimate.values.len());
    for k in mismatch {
        row[k?] = 1.0;
    }
    let uncertainty = estimate.variance_of(&row).sqrt();
    Some(Term {
        value: row.dot(&estimate.values),
        base: 0.0,
        uncertainty,
        half_width_95: estimate.coverage_factor_95() * uncertainty,
    })
}

/// All over the base's volume, coming from both sides.
fn uncertainty_mm(estimate: &Estimate, layout: &Layout, base: &WithEffects) -> f64 {
    let changed: Vec<usize> = layout.squareness.into_iter().chain(layout.play).flatten().collect();
    let at = |linear_mm: Vector, side: i8| Command { linear_mm, direction: [side; 3], ..Default::default() };
    let places = field::places_mm(&base.volume().0);
    let commands: Vec<Command> = places.into_iter().flat_map(|place| [at(place, -1), at(place, 1)]).collect();
    let positions = |x: &DVector<f64>| {
        let machine = layout.machine(base, x);
        commands.iter().map(|c| c.linear_mm + machine.error_mm(c)).collect()
    };
    field_u95_mm(estimate, &positions, &changed, &layout.steps())
}

impl CircleCalibration {
    /// That some machine can be like this.
    fn is_possible(&self) -> Result<(), CalibrationError> {
        let limit = quantile(CONTRADICTION_CHANCE, self.estimate.degrees_of_freedom);
        if let Some(sum) = self.closure
            && sum.value.abs() > (limit * sum.uncertainty).max(RESOLVED_RATIO)
        {
            return Err(CalibrationError::Contradicted(both!(
                "the scales do not add up: X-Y, Z-X and Y-Z sum to {:.1} ± {:.1} um/m and not to 0",
                "масштабы не сходятся: сумма X-Y, Z-X и Y-Z равна {:.1} ± {:.1} мкм/м, а не 0",
                sum.value * 1e6,
                sum.half_width_95 * 1e6
            )));
        }
        let seen: Vec<(char, &Term)> =
            LETTERS.into_iter().zip(&self.backlash_mm).filter_map(|(l, t)| Some((l, t.as_ref()?))).collect();
        if !seen.is_empty() && seen.iter().all(|(_, t)| t.value < -(limit * t.uncertainty).max(RESOLVED_MM)) {
            let each: Vec<Text> = seen
                .iter()
                .map(|(letter, t)| both!("{letter} {:.2} um", "{letter} {:.2} мкм", t.value * 1e3))
                .collect();
            return Err(CalibrationError::Contradicted(both!(
                "every axis would have negative play: {}",
                "люфт всех осей вышел бы отрицательным: {:#}",
                Text::join(&each, ", ")
            )));
        }
        Ok(())
    }
}
