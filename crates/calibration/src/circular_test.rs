//! Circles of two axes as ISO 230-4 looks at them: how round, how far apart both senses, and what makes them so. Equation (80).
//!
//! Every run is taken about its own least-squares circle: where the fixed ball stands and how long the bar is belong to the
//! set-up.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};
use units::math;

/// Which way round.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Sense {
    /// From the first axis of the plane to the second.
    CounterClockwise,
    /// Back.
    Clockwise,
    /// The readings do not say.
    Unknown,
}

/// What makes a circle no circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Cause {
    /// The angle between both axes of the plane.
    Squareness,
    /// The scale of one axis against the other.
    Mismatch,
    /// Play of an axis: 0, 1, 2.
    Backlash(usize),
}

/// One reading.
#[derive(Clone, Debug, PartialEq)]
pub struct CirclePoint {
    /// Its number among all readings.
    pub reading: usize,
    /// Where on the circle as commanded, from the first axis of the plane to the second, 0 to 2π.
    pub angle_rad: f64,
    /// Length read minus length commanded, mm.
    pub read_mm: f64,
    /// What is read beyond the run's least-squares circle, mm.
    pub deviation_mm: f64,
    /// The same of what was fitted.
    pub fitted_mm: f64,
    /// The part of each of the [`CircularTest::patterns`] in it.
    pub causes_mm: Vec<f64>,
}

impl CirclePoint {
    /// What the set-up makes of it: a ball beside its place, a bar of another length, mm.
    #[must_use]
    pub fn set_up_mm(&self) -> f64 {
        self.read_mm - self.deviation_mm
    }
}

/// The readings of one run in one sense, by angle.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Its run.
    pub run: usize,
    /// Which way round.
    pub sense: Sense,
    /// Where the circle finds the fixed ball, against where it was stated, along both axes of the plane, mm.
    pub centre_mm: [f64; 2],
    /// Its radius less the commanded one, mm.
    pub excess_mm: f64,
    /// The widest angle without a reading.
    pub gap_rad: f64,
    /// G: circular deviation, mm.
    pub circularity_mm: f64,
    /// Readings by rising angle.
    pub points: Vec<CirclePoint>,
}

/// One cause on its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pattern {
    /// Which.
    pub cause: Cause,
    /// Largest minus smallest deviation that it makes, mm.
    pub range_mm: f64,
    /// Half width of the 95 % interval of that.
    pub half_width_95_mm: f64,
    /// Largest minus smallest deviation of the plane without it, mm.
    pub without_mm: f64,
}

/// Largest difference of both senses at one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hysteresis {
    /// H, mm.
    pub value_mm: f64,
    /// There.
    pub angle_rad: f64,
}

/// The circles of one plane.
#[derive(Clone, Debug, PartialEq)]
pub struct CircularTest {
    /// 0 XY, 1 ZX, 2 YZ.
    pub plane: usize,
    /// Mean length commanded, mm.
    pub radius_mm: f64,
    /// By run and sense.
    pub traces: Vec<Trace>,
    /// G(b): of the runs that were read in both senses, mm: of one centre and one length of the bar.
    pub bidirectional_mm: Option<f64>,
    /// H, where one run was read in both senses at neighbouring angles.
    pub hysteresis: Option<Hysteresis>,
    /// `F_min` and `F_max`: radial deviation against the length that the bar states, mm.
    pub radial_mm: [f64; 2],
    /// What makes it, the largest first.
    pub patterns: Vec<Pattern>,
    /// Largest minus smallest deviation without what a profile can hold: all that was fitted but the mismatch, mm.
    pub corrected_mm: f64,
    /// The same of what the base has besides the causes: its curves and effects.
    pub curves_mm: f64,
    /// The same of what no cause explains.
    pub left_mm: f64,
    /// Largest minus smallest deviation that the set-up of the runs makes.
    pub set_up_mm: f64,
}

/// What a circular test is evaluated from.
pub(crate) struct Measured {
    /// Number among all readings.
    pub reading: usize,
    /// Its run.
    pub run: usize,
    /// Commanded place against the fixed ball, along both axes, mm.
    pub arm_mm: [f64; 2],
    /// Length commanded, mm.
    pub commanded_mm: f64,
    /// Direction of both axes.
    pub direction: [i8; 2],
    /// Length read, mm.
    pub length_mm: f64,
    /// Length fitted, mm.
    pub fitted_mm: f64,
    /// How much each cause adds to it, mm.
    pub causes_mm: Vec<f64>,
}

/// Readings of the other sense farther away than this are not its neighbours: what lies between is not known.
const NEIGHBOUR_RAD: f64 = 15.0 * TAU / 360.0;

/// A cause with its uncertainty as a share of its value.
pub(crate) type Known = (Cause, f64);

/// Evaluates the readings of one plane.
///
/// * `centres_mm` – where the fixed ball of a run is against where it was stated, mm
pub(crate) fn evaluate(
    plane: usize,
    all: &[Measured],
    causes: &[Known],
    centres_mm: &dyn Fn(usize) -> [f64; 2],
) -> CircularTest {
    let mut runs: Vec<usize> = all.iter().map(|m| m.run).collect();
    runs.dedup();
    let mut traces = Vec::new();
    for run in runs {
        let own: Vec<&Measured> = all.iter().filter(|m| m.run == run).collect();
        traces.extend(of_run(run, &own, causes.len(), centres_mm(run)));
    }
    let mut test = CircularTest {
        plane,
        radius_mm: all.iter().map(|m| m.commanded_mm).sum::<f64>() / all.len().max(1) as f64,
        bidirectional_mm: None,
        hysteresis: hysteresis(&traces),
        radial_mm: radial(&traces),
        patterns: Vec::new(),
        corrected_mm: 0.0,
        curves_mm: 0.0,
        left_mm: 0.0,
        set_up_mm: 0.0,
        traces,
    };
    let there_and_back = both_senses(&test.traces).flat_map(|pair| pair.map(|t| &t.points)).flatten();
    let range_mm = range(there_and_back.map(|p| p.deviation_mm));
    test.bidirectional_mm = both_senses(&test.traces).next().map(|_| range_mm);
    test.left_mm = test.range(&|p| p.deviation_mm - p.fitted_mm);
    test.set_up_mm = test.range(&CirclePoint::set_up_mm);
    let of = |p: &CirclePoint, kept: &dyn Fn(Cause) -> bool| {
        let parts = causes.iter().zip(&p.causes_mm).filter(|((cause, _), _)| kept(*cause));
        parts.map(|(_, part)| part).sum::<f64>()
    };
    test.corrected_mm =
        test.range(&|p| p.deviation_mm - p.fitted_mm + of(p, &|cause| cause == Cause::Mismatch));
    test.curves_mm = test.range(&|p| p.fitted_mm - of(p, &|_| true));
    let pattern = |(k, (cause, uncertain)): (usize, &Known)| {
        let range_mm = test.range(&|p| p.causes_mm[k]);
        Pattern {
            cause: *cause,
            range_mm,
            half_width_95_mm: range_mm * uncertain,
            without_mm: test.range(&|p| p.deviation_mm - p.causes_mm[k]),
        }
    };
    let patterns: Vec<Pattern> = causes.iter().enumerate().map(pattern).collect();
    let mut order: Vec<usize> = (0..patterns.len()).collect();
    order.sort_by(|a, b| patterns[*b].range_mm.total_cmp(&patterns[*a].range_mm));
    test.patterns = order.iter().map(|k| patterns[*k]).collect();
    for point in test.traces.iter_mut().flat_map(|t| &mut t.points) {
        point.causes_mm = order.iter().map(|k| point.causes_mm[*k]).collect();
    }
    test
}

impl CircularTest {
    /// True where both senses were read, but none of the runs in both: each run has a set-up of its own, which takes the
    /// difference of centre and radius that G(b) and H are of.
    #[must_use]
    pub fn is_centred_apart(&self) -> bool {
        let read = |sense| self.traces.iter().any(|t| t.sense == sense);
        self.bidirectional_mm.is_none() && read(Sense::CounterClockwise) && read(Sense::Clockwise)
    }

    /// Largest minus smallest of something of the readings.
    fn range(&self, of: &dyn Fn(&CirclePoint) -> f64) -> f64 {
        range(self.traces.iter().flat_map(|t| &t.points).map(of))
    }

    /// The patterns' sizes added, mm: what shares are of.
    #[must_use]
    pub fn sum_of_patterns_mm(&self) -> f64 {
        self.patterns.iter().map(|p| p.range_mm).sum()
    }
}

fn range(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if high >= low { high - low } else { 0.0 }
}

/// The traces of one run, about its least-squares circle.
fn of_run(run: usize, own: &[&Measured], causes: usize, centre_mm: [f64; 2]) -> Vec<Trace> {
    let angle = |m: &Measured| {
        let angle = math::atan2(m.arm_mm[1], m.arm_mm[0]);
        if angle < 0.0 { angle + TAU } else { angle }
    };
    let angles: Vec<f64> = own.iter().map(|m| angle(m)).collect();
    // What a ball beside its place does is taken off exactly; what is left of it is small enough for the first harmonic.
    let beside = |m: &Measured| {
        let arm = [m.arm_mm[0] - centre_mm[0], m.arm_mm[1] - centre_mm[1]];
        let across =
            (m.commanded_mm * m.commanded_mm - m.arm_mm[0] * m.arm_mm[0] - m.arm_mm[1] * m.arm_mm[1])
                .max(0.0);
        (arm[0] * arm[0] + arm[1] * arm[1] + across).sqrt()
    };
    let about = |length: &dyn Fn(&Measured) -> f64| {
        let values: Vec<f64> = own.iter().map(|m| length(m)).collect();
        centred(&angles, &values)
    };
    let (read, [excess_mm, u, v]) = about(&|m| m.length_mm - beside(m));
    let (fitted, _) = about(&|m| m.fitted_mm - beside(m));
    let parts: Vec<Vec<f64>> = (0..causes).map(|k| about(&|m| m.causes_mm[k]).0).collect();
    let mut senses: Vec<Sense> = own.iter().zip(&angles).map(|(m, a)| sense(m, *a)).collect();
    let each = senses.clone();
    senses.sort();
    senses.dedup();
    let trace = |sense: Sense| {
        let mut points: Vec<CirclePoint> = (0..own.len())
            .filter(|i| each[*i] == sense)
            .map(|i| CirclePoint {
                reading: own[i].reading,
                angle_rad: angles[i],
                read_mm: own[i].length_mm - own[i].commanded_mm,
                deviation_mm: read[i],
                fitted_mm: fitted[i],
                causes_mm: parts.iter().map(|part| part[i]).collect(),
            })
            .collect();
        points.sort_by(|a, b| a.angle_rad.total_cmp(&b.angle_rad));
        Trace {
            run,
            sense,
            // The length is shorter on the ball's side.
            centre_mm: [centre_mm[0] - u, centre_mm[1] - v],
            excess_mm,
            gap_rad: gap(&points),
            circularity_mm: range(points.iter().map(|p| p.deviation_mm)),
            points,
        }
    };
    senses.into_iter().map(trace).collect()
}

/// Which way round a reading was taken; unknown where no direction is given, or one that no circle has there.
fn sense(m: &Measured, angle_rad: f64) -> Sense {
    let (sin, cos) = (math::sin(angle_rad), math::cos(angle_rad));
    let along = cos * f64::from(m.direction[1]) - sin * f64::from(m.direction[0]);
    match along {
        a if a > 1e-6 => Sense::CounterClockwise,
        a if a < -1e-6 => Sense::Clockwise,
        _ => Sense::Unknown,
    }
}

/// Values less their mean and first harmonic `[m, c, s]`: what is beyond the least-squares circle. Values as they are
/// where that circle is not determined.
fn centred(angles_rad: &[f64], values: &[f64]) -> (Vec<f64>, [f64; 3]) {
    let design = DMatrix::from_fn(values.len(), 3, |i, k| match k {
        0 => 1.0,
        1 => math::cos(angles_rad[i]),
        _ => math::sin(angles_rad[i]),
    });
    let normal = design.tr_mul(&design);
    let right = design.tr_mul(&DVector::from_column_slice(values));
    let Some(found) = normal.cholesky().map(|c| c.solve(&right)) else {
        return (values.to_vec(), [0.0; 3]);
    };
    let rest = DVector::from_column_slice(values) - design * &found;
    (rest.iter().copied().collect(), [found[0], found[1], found[2]])
}

/// The widest angle without a reading; of points by rising angle.
fn gap(points: &[CirclePoint]) -> f64 {
    let Some(first) = points.first() else { return TAU };
    let next = points.iter().skip(1).map(|p| p.angle_rad).chain([first.angle_rad + TAU]);
    points.iter().zip(next).map(|(p, next)| next - p.angle_rad).fold(0.0, f64::max)
}

/// Both senses of each run that has them.
fn both_senses(traces: &[Trace]) -> impl Iterator<Item = [&Trace; 2]> {
    let of = |sense: Sense| traces.iter().filter(move |t| t.sense == sense);
    of(Sense::CounterClockwise)
        .filter_map(move |there| Some([there, of(Sense::Clockwise).find(|back| back.run == there.run)?]))
}

/// Both senses of a run at the same angles.
fn hysteresis(traces: &[Trace]) -> Option<Hysteresis> {
    let mut worst: Option<Hysteresis> = None;
    for [there, back] in both_senses(traces) {
        for (one, other) in [(there, back), (back, there)] {
            for point in &one.points {
                let Some(value) = at(other, point.angle_rad) else { continue };
                let value_mm = (point.deviation_mm - value).abs();
                if worst.is_none_or(|w| value_mm > w.value_mm) {
                    worst = Some(Hysteresis { value_mm, angle_rad: point.angle_rad });
                }
            }
        }
    }
    worst
}

/// Deviation of a trace at an angle, straight between its neighbouring readings; `None` in a gap.
fn at(trace: &Trace, angle_rad: f64) -> Option<f64> {
    let points = &trace.points;
    let last = points.len().checked_sub(1)?;
    let after = points.iter().position(|p| p.angle_rad >= angle_rad).unwrap_or(0);
    let before = if after == 0 { last } else { after - 1 };
    let (a, b) = (&points[before], &points[after]);
    let ahead = |from: f64, to: f64| {
        let way = to - from;
        if way < 0.0 { way + TAU } else { way }
    };
    let (way, done) = (ahead(a.angle_rad, b.angle_rad), ahead(a.angle_rad, angle_rad));
    if way > NEIGHBOUR_RAD || way <= 0.0 || done > way {
        return None;
    }
    Some(a.deviation_mm + (b.deviation_mm - a.deviation_mm) * done / way)
}

/// Against the length stated: the circle's own excess counts, its place does not.
fn radial(traces: &[Trace]) -> [f64; 2] {
    let all = || traces.iter().flat_map(|t| t.points.iter().map(|p| p.deviation_mm + t.excess_mm));
    [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle of 100 mm: readings by `deviation(angle, sense)`, the fixed ball a millimetre off.
    fn circles(count: usize, deviation: impl Fn(f64, f64) -> f64) -> CircularTest {
        in_runs([0, 0], count, deviation)
    }

    /// The same, both senses in these runs.
    fn in_runs(runs: [usize; 2], count: usize, deviation: impl Fn(f64, f64) -> f64) -> CircularTest {
        let mut all = Vec::new();
        for (run, sense) in runs.into_iter().zip([1.0, -1.0]) {
            for k in 0..count {
                let a = TAU * k as f64 / count as f64;
                let (sin, cos) = (math::sin(a), math::cos(a));
                let arm: [f64; 2] = [100.0 * cos, 100.0 * sin];
                let real = ((arm[0] - 1.0).powi(2) + (arm[1] + 0.5).powi(2)).sqrt();
                let turn = |v: f64| if v * sense > 0.0 { 1 } else { -1 };
                all.push(Measured {
                    reading: all.len(),
                    run,
                    arm_mm: arm,
                    commanded_mm: 100.0,
                    direction: [turn(-sin), turn(cos)],
                    length_mm: real + 0.003 + deviation(a, sense),
                    fitted_mm: real,
                    causes_mm: Vec::new(),
                });
            }
        }
        evaluate(0, &all, &[], &|_| [1.0, -0.5])
    }

    #[test]
    fn an_ellipse_is_as_uncircular_as_its_axes_differ() {
        // Squareness of 40 µrad on 100 mm: ±2 µm at 45 degrees, whatever the set-up.
        let test = circles(72, |a, _| 0.002 * math::sin(2.0 * a));
        for trace in &test.traces {
            assert!((trace.circularity_mm - 0.004).abs() < 2e-6, "{}", trace.circularity_mm);
            assert!((trace.excess_mm - 0.003).abs() < 1e-9);
            assert!((trace.centre_mm[0] - 1.0).abs() < 1e-6 && (trace.centre_mm[1] + 0.5).abs() < 1e-6);
        }
        assert!((test.radial_mm[1] - 0.005).abs() < 2e-6 && (test.radial_mm[0] - 0.001).abs() < 2e-6);
        assert!(test.hysteresis.is_some_and(|h| h.value_mm < 1e-9));
        // The ball 1.118 mm off: twice that from its side to the other.
        assert!((test.set_up_mm - 2.0 * 1.25_f64.sqrt()).abs() < 0.002, "{}", test.set_up_mm);
    }

    #[test]
    fn both_senses_apart_by_their_difference() {
        let test = circles(72, |a, sense| sense * 0.001 * math::sin(3.0 * a));
        assert!((test.bidirectional_mm.unwrap() - 0.002).abs() < 2e-6);
        let found = test.hysteresis.unwrap();
        assert!((found.value_mm - 0.002).abs() < 5e-6, "{found:?}");
        let senses: Vec<Sense> = test.traces.iter().map(|t| t.sense).collect();
        assert_eq!(senses, [Sense::CounterClockwise, Sense::Clockwise]);
    }

    #[test]
    fn runs_centred_apart_have_no_figures_of_both_senses() {
        let larger_back = |_: f64, sense: f64| -0.0045 * sense;
        let test = circles(72, larger_back);
        assert!((test.hysteresis.unwrap().value_mm - 0.009).abs() < 1e-6 && !test.is_centred_apart());
        let test = in_runs([0, 1], 72, larger_back);
        assert_eq!((test.hysteresis, test.bidirectional_mm), (None, None));
        assert!(test.is_centred_apart(), "how far apart the circles are is in their set-ups");
    }

    #[test]
    fn readings_far_apart_have_no_neighbours() {
        let test = circles(12, |_, _| 0.0);
        assert_eq!(test.hysteresis, None, "30 degrees between readings");
        assert!((test.traces[0].gap_rad - TAU / 12.0).abs() < 1e-9);
    }
}
