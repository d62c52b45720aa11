//! Location errors of an A/C table from ball-bar tests with one rotary axis turning: equations (47) to (49), after
//! Zhang 2024.
//!
//! Positions are counted from the point where the two axes should cross. A is carried by the machine, C by A; a positive
//! command turns the table, and what stands on it, right-handed about the axis.

use machine_model::Vector;
use machine_model::rotation::{around, small};
use nalgebra::{DMatrix, DVector, Matrix3};
use units::math;

use crate::error::CalibrationError;
use crate::least_squares::{Estimate, solve};

/// What turns in a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Turning {
    /// The A axis; C stands at 0.
    A,
    /// The C axis; A stands at 0.
    C,
    /// The spindle: shows where the tool ball sits against the spindle's axis.
    Spindle,
}

/// One test: one thing turns, everything else stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Test {
    /// What turns.
    pub turning: Turning,
    /// Tool ball without its offset from the spindle axis, mm from the crossing point.
    pub tool_ball_mm: Vector,
    /// Workpiece ball minus tool ball at angle 0, mm.
    pub bar_mm: Vector,
    /// Angle, rad, and length read, mm.
    pub readings: Vec<(f64, f64)>,
}

/// Names of the location errors, in the order of [`Piges`].
pub const NAMES: [&str; 8] = ["EY0A", "EZ0A", "EB0A", "EC0A", "EX0C", "EY0C", "EA0C", "EB0C"];

/// Location errors of A and C: mm for EY0A EZ0A EX0C EY0C, rad for EB0A EC0A EA0C EB0C; order of [`NAMES`].
pub type Piges = [f64; 8];

/// True for the entries of [`Piges`] that are lengths.
#[must_use]
pub fn is_length(index: usize) -> bool {
    matches!(index, 0 | 1 | 4 | 5)
}

/// Length of the bar by the exact chain: equation (47).
///
/// * `cup_mm` – tool ball against the spindle axis at spindle angle 0: eX, eY
#[must_use]
pub fn length_mm(test: &Test, piges: &Piges, cup_mm: [f64; 2], angle_rad: f64) -> f64 {
    let cup = Vector::new(cup_mm[0], cup_mm[1], 0.0);
    let tool_at_zero = test.tool_ball_mm + cup;
    let work_at_zero = tool_at_zero + test.bar_mm;
    let [y_a, z_a, b_a, c_a, x_c, y_c, a_c, b_c] = *piges;
    let (tilt_a, shift_a) = (small(&Vector::new(0.0, b_a, c_a)), Vector::new(0.0, y_a, z_a));
    let (tilt_c, shift_c) = (small(&Vector::new(a_c, b_c, 0.0)), Vector::new(x_c, y_c, 0.0));
    let turned = |carrier: &Matrix3<f64>, at: &Vector, direction: usize| {
        // carrier·R·carrier⁻¹ about `at`: where the table takes the workpiece ball.
        at + carrier * around(direction, angle_rad) * carrier.transpose() * (work_at_zero - at)
    };
    let (tool, work) = match test.turning {
        Turning::Spindle => (test.tool_ball_mm + around(2, angle_rad) * cup, work_at_zero),
        Turning::A => (tool_at_zero, turned(&tilt_a, &shift_a, 0)),
        Turning::C => (tool_at_zero, turned(&(tilt_a * tilt_c), &(shift_a + tilt_a * shift_c), 2)),
    };
    (work - tool).norm()
}

/// Change of length by the published first-order formulas (19) to (22), mm; `None` for tests that are none of the four.
#[must_use]
pub fn published_change_mm(test: &Test, piges: &Piges, cup_mm: [f64; 2], angle_rad: f64) -> Option<f64> {
    let (cosine, sine) = (math::cos(angle_rad), math::sin(angle_rad));
    let [a, b] = coefficients(test, piges, cup_mm)?;
    Some(a * (cosine - 1.0) + b * sine)
}

/// Coefficients of cos and sin in (19) to (22).
fn coefficients(test: &Test, piges: &Piges, cup_mm: [f64; 2]) -> Option<[f64; 2]> {
    let [y_a, z_a, b_a, c_a, x_c, y_c, a_c, b_c] = *piges;
    let [e_x, e_y] = cup_mm;
    let lever = lever_mm(test)?;
    match test.turning {
        Turning::A => Some([e_y - y_a - lever * c_a, lever * b_a - z_a]),
        Turning::C => Some([x_c - e_x + lever * (b_a + b_c), y_a + y_c - e_y - lever * a_c]),
        Turning::Spindle => None,
    }
}

/// The lever of one of the four tests: X of the tool ball for A, its Z for C, everything else in place.
fn lever_mm(test: &Test) -> Option<f64> {
    let zero = |v: f64| v.abs() < 1e-6;
    let (t, bar) = (&test.tool_ball_mm, &test.bar_mm);
    match test.turning {
        Turning::A if zero(t.y) && zero(t.z) && zero(bar.x) && zero(bar.z) && bar.y < 0.0 => Some(t.x),
        Turning::C if zero(t.x) && zero(t.y) && zero(bar.y) && zero(bar.z) && bar.x > 0.0 => Some(t.z),
        _ => None,
    }
}

/// What the tests say.
#[derive(Clone, Debug)]
pub struct RotaryCalibration {
    /// The location errors.
    pub piges: Piges,
    /// Tool ball against the spindle axis, mm.
    pub cup_mm: [f64; 2],
    /// The least squares behind them: parameters 0 to 7 the location errors, 8 and 9 the cup, then a length a test.
    pub estimate: Estimate,
    /// The same by the published sequence, where the four tests and the spindle turn are there.
    pub sequential: Option<(Piges, [f64; 2])>,
    /// Largest difference between the published formulas and the exact chain at the estimate, mm.
    pub approximation_mm: Option<f64>,
}

/// All location errors and the cup offset together: equation (48).
///
/// # Errors
/// [`CalibrationError::Unobservable`] with the names of what the tests leave open; [`CalibrationError::TooFew`].
pub fn calibrate(tests: &[Test]) -> Result<RotaryCalibration, CalibrationError> {
    let rows: usize = tests.iter().map(|t| t.readings.len()).sum();
    let columns = 10 + tests.len();
    if rows <= columns {
        return Err(CalibrationError::TooFew(format!("{rows} readings for {columns} unknowns")));
    }
    let mut parameters = DVector::<f64>::zeros(columns);
    let model = |p: &DVector<f64>| {
        let piges: Piges = std::array::from_fn(|k| p[k]);
        let all = tests.iter().enumerate().flat_map(|(k, test)| {
            test.readings
                .iter()
                .map(move |(angle, _)| length_mm(test, &piges, [p[8], p[9]], *angle) + p[10 + k])
        });
        DVector::from_iterator(rows, all)
    };
    let read = DVector::from_iterator(rows, tests.iter().flat_map(|t| t.readings.iter().map(|r| r.1)));
    let mut last = None;
    // The model is linear but for products of errors: the third step changes nothing that is printed.
    for _ in 0..4 {
        let base = model(&parameters);
        let mut design = DMatrix::zeros(rows, columns);
        for k in 0..columns {
            // Steps of 0.1 µm per 100 mm: far above rounding, far below curvature.
            let step = if k < 8 && !is_length(k) { 1e-6 } else { 1e-4 };
            let mut moved = parameters.clone();
            moved[k] += step;
            let up = model(&moved);
            moved[k] -= 2.0 * step;
            design.set_column(k, &((up - model(&moved)) / (2.0 * step)));
        }
        let estimate = solve(&design, &(&read - &base), None).map_err(|open| unobservable(&open))?;
        parameters += &estimate.values;
        last = Some(estimate);
    }
    let Some(mut estimate) = last else { return Err(CalibrationError::TooFew("no readings".to_owned())) };
    estimate.residuals = &read - model(&parameters);
    let free = rows - columns;
    estimate.sigma = (estimate.residuals.norm_squared() / free as f64).sqrt();
    estimate.values = parameters.clone();
    let piges: Piges = std::array::from_fn(|k| parameters[k]);
    let cup_mm = [parameters[8], parameters[9]];
    let approximation = |test: &Test| -> Option<f64> {
        let at_zero = length_mm(test, &piges, cup_mm, 0.0);
        let mut worst = 0.0_f64;
        for (angle, _) in &test.readings {
            let exact = length_mm(test, &piges, cup_mm, *angle) - at_zero;
            worst = worst.max((exact - published_change_mm(test, &piges, cup_mm, *angle)?).abs());
        }
        Some(worst)
    };
    Ok(RotaryCalibration {
        piges,
        cup_mm,
        sequential: sequential(tests),
        approximation_mm: tests.iter().filter_map(approximation).reduce(f64::max),
        estimate,
    })
}

/// Names of the parameters with a share in an open combination.
fn unobservable(open: &[DVector<f64>]) -> CalibrationError {
    let mut texts = Vec::new();
    for combination in open {
        let names: Vec<&str> = (0..combination.len())
            .filter(|&k| combination[k].abs() > 0.05)
            .map(|k| {
                NAMES.get(k).copied().unwrap_or_else(|| ["eX", "eY", "the bar's length"][(k - 8).min(2)])
            })
            .collect();
        let mut unique = names;
        unique.dedup();
        texts.push(unique.join(" from "));
    }
    CalibrationError::Unobservable(texts.join("; "))
}

/// Least-squares coefficients of `[cos sin 1]`, mm.
fn harmonic(test: &Test) -> Option<[f64; 2]> {
    let rows = test.readings.len();
    let design = DMatrix::from_fn(rows, 3, |i, k| match k {
        0 => math::cos(test.readings[i].0),
        1 => math::sin(test.readings[i].0),
        _ => 1.0,
    });
    let right = DVector::from_fn(rows, |i, _| test.readings[i].1);
    solve(&design, &right, None).ok().map(|fit| [fit.values[0], fit.values[1]])
}

/// Cup offset from the spindle turn as published, (23) to (26): from the reading at 0, the largest and the smallest.
fn published_cup(test: &Test) -> Option<[f64; 2]> {
    let by = |better: fn(f64, f64) -> bool| {
        test.readings.iter().copied().reduce(|a, b| if better(b.1, a.1) { b } else { a })
    };
    let (longest, shortest) = (by(|a, b| a > b)?, by(|a, b| a < b)?);
    let start = test.readings.iter().find(|r| r.0.abs() < 1e-9)?.1;
    let radius = 0.5 * (longest.1 - shortest.1);
    if radius <= 0.0 {
        return Some([0.0; 2]);
    }
    let reach = shortest.1 + radius;
    let cosine =
        ((radius * radius + start * start - reach * reach) / (2.0 * radius * start)).clamp(-1.0, 1.0);
    let sine = (1.0 - cosine * cosine).sqrt();
    let turn = shortest.0.rem_euclid(std::f64::consts::TAU);
    // The shortest length stands where the ball points to the bar (+X): the ball was at minus that angle.
    let above = turn > std::f64::consts::PI;
    Some([-radius * cosine, if above { radius * sine } else { -radius * sine }])
}

/// The published sequence: A at the crossing, A beside it, C at the crossing, C above it; (19) to (26).
fn sequential(tests: &[Test]) -> Option<(Piges, [f64; 2])> {
    let find = |turning: Turning, beside: bool| {
        tests.iter().find(|t| t.turning == turning && lever_mm(t).is_some_and(|l| (l.abs() > 1.0) == beside))
    };
    let cup = published_cup(tests.iter().find(|t| t.turning == Turning::Spindle && t.bar_mm.x > 0.0)?)?;
    let [e_x, e_y] = cup;
    let [a1, b1] = harmonic(find(Turning::A, false)?)?;
    let second = find(Turning::A, true)?;
    let ([a2, b2], lever_a) = (harmonic(second)?, lever_mm(second)?);
    let [a3, b3] = harmonic(find(Turning::C, false)?)?;
    let fourth = find(Turning::C, true)?;
    let ([a4, b4], lever_c) = (harmonic(fourth)?, lever_mm(fourth)?);
    let (y_a, z_a) = (e_y - a1, -b1);
    let (c_a, b_a) = ((e_y - y_a - a2) / lever_a, (b2 + z_a) / lever_a);
    let (x_c, y_c) = (a3 + e_x, b3 - y_a + e_y);
    let b_c = (a4 - x_c + e_x) / lever_c - b_a;
    let a_c = (y_a + y_c - e_y - b4) / lever_c;
    Some(([y_a, z_a, b_a, c_a, x_c, y_c, a_c, b_c], cup))
}
