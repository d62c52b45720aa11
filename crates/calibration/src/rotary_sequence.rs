//! The sequence that Zhang 2024 published for an A that carries C, to compare with the joint fit: equation (49).
//!
//! Positions are counted from the point where the two axes should cross. The formulas are of first order.

use machine_model::{Axis, Vector};
use nalgebra::{DMatrix, DVector};
use units::math;

use crate::adjustment::{Noise, linear};
use crate::rotary_ballbar::{RotaryCalibration, Test, Turning};

/// EY0A EZ0A EB0A EC0A EX0C EY0C EA0C EB0C, mm and rad, and the tool ball against the spindle axis, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sequence {
    /// The location errors.
    pub piges: [f64; 8],
    /// eX, eY.
    pub cup_mm: [f64; 2],
}

/// Tool ball from the crossing point, mm.
fn tool_ball(test: &Test, crossing_mm: &Vector) -> Vector {
    test.command.linear_mm + test.command.tool_mm - crossing_mm
}

/// The lever of one of the four tests: X of the tool ball for A, its Z for C, everything else in place.
fn lever_mm(test: &Test, crossing_mm: &Vector) -> Option<f64> {
    let zero = |v: f64| v.abs() < 1e-6;
    let (t, bar) = (tool_ball(test, crossing_mm), &test.bar_mm);
    match test.turning {
        Turning::Axis(Axis::A) if zero(t.y) && zero(t.z) && zero(bar.x) && zero(bar.z) && bar.y < 0.0 => {
            Some(t.x)
        }
        Turning::Axis(Axis::C) if zero(t.x) && zero(t.y) && zero(bar.y) && zero(bar.z) && bar.x > 0.0 => {
            Some(t.z)
        }
        _ => None,
    }
}

/// Coefficients of cos and sin in (19) to (22).
fn coefficients(test: &Test, crossing_mm: &Vector, by: &Sequence) -> Option<[f64; 2]> {
    let [y_a, z_a, b_a, c_a, x_c, y_c, a_c, b_c] = by.piges;
    let [e_x, e_y] = by.cup_mm;
    let lever = lever_mm(test, crossing_mm)?;
    match test.turning {
        Turning::Axis(Axis::A) => Some([e_y - y_a - lever * c_a, lever * b_a - z_a]),
        _ => Some([x_c - e_x + lever * (b_a + b_c), y_a + y_c - e_y - lever * a_c]),
    }
}

/// Largest difference between the published formulas and the whole model at what was found, mm; `None` where no test is one
/// of the four, or not all eight errors were found.
#[must_use]
pub fn approximation_mm(tests: &[Test], crossing_mm: &Vector, found: &RotaryCalibration) -> Option<f64> {
    let values: Vec<f64> = found.locations.iter().map(|f| f.value).collect();
    let exact = Sequence { piges: values.try_into().ok()?, cup_mm: found.cup_mm };
    let of_test = |(test, lengths): (&Test, &Vec<f64>)| {
        let [a, b] = coefficients(test, crossing_mm, &exact)?;
        let change = |angle: f64| a * (math::cos(angle) - 1.0) + b * math::sin(angle);
        let off = || test.readings.iter().zip(lengths).map(|((angle, _), length)| length - change(*angle));
        // Changes count from angle 0, or from the reading nearest to it.
        let nearest = |(k, (angle, _)): (usize, &(f64, f64))| (angle.abs(), k);
        let (_, zero) = test.readings.iter().enumerate().map(nearest).min_by(|a, b| a.0.total_cmp(&b.0))?;
        let start = off().nth(zero)?;
        off().map(|length| (length - start).abs()).reduce(f64::max)
    };
    tests.iter().zip(&found.predicted_mm).filter_map(of_test).reduce(f64::max)
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
    let fit = linear(&design, &right, Noise::Common, &DMatrix::zeros(0, 3)).ok()?;
    fit.open.is_empty().then(|| [fit.values[0], fit.values[1]])
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

/// The published sequence: A at the crossing, A beside it, C at the crossing, C above it; (19) to (26). `None` where one
/// of the tests or the spindle turn is missing.
#[must_use]
pub fn sequence(tests: &[Test], crossing_mm: &Vector) -> Option<Sequence> {
    let lever = |t: &Test| lever_mm(t, crossing_mm);
    let find = |axis: Axis, beside: bool| {
        let is = |t: &&Test| {
            t.turning == Turning::Axis(axis) && lever(t).is_some_and(|l| (l.abs() > 1.0) == beside)
        };
        tests.iter().find(is)
    };
    let cup_mm = published_cup(tests.iter().find(|t| t.turning == Turning::Spindle && t.bar_mm.x > 0.0)?)?;
    let [e_x, e_y] = cup_mm;
    let [a1, b1] = harmonic(find(Axis::A, false)?)?;
    let second = find(Axis::A, true)?;
    let ([a2, b2], lever_a) = (harmonic(second)?, lever(second)?);
    let [a3, b3] = harmonic(find(Axis::C, false)?)?;
    let fourth = find(Axis::C, true)?;
    let ([a4, b4], lever_c) = (harmonic(fourth)?, lever(fourth)?);
    let (y_a, z_a) = (e_y - a1, -b1);
    let (c_a, b_a) = ((e_y - y_a - a2) / lever_a, (b2 + z_a) / lever_a);
    let (x_c, y_c) = (a3 + e_x, b3 - y_a + e_y);
    let b_c = (a4 - x_c + e_x) / lever_c - b_a;
    let a_c = (y_a + y_c - e_y - b4) / lever_c;
    Some(Sequence { piges: [y_a, z_a, b_a, c_a, x_c, y_c, a_c, b_c], cup_mm })
}
