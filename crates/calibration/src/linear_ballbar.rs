//! Squareness, scale mismatch and backlash from ball-bar circles of two linear axes: equation (50).

use machine_model::Vector;
use nalgebra::{DMatrix, DVector};

use crate::error::{CalibrationError, LETTERS};
use crate::least_squares::{Estimate, solve};

/// One reading on a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleReading {
    /// Run: readings of one run share the set-up of the fixed ball.
    pub run: usize,
    /// Commanded position of the moving ball, mm.
    pub commanded_mm: Vector,
    /// Centre of the fixed ball as set up, mm.
    pub centre_mm: Vector,
    /// Length read, mm.
    pub length_mm: f64,
    /// Direction in which each axis moves: -1, +1, 0 where unknown or standing.
    pub direction: [i8; 3],
}

/// A value with its standard uncertainty and its parameter in the estimate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// mm or rad (or mm/mm).
    pub value: f64,
    /// Standard uncertainty.
    pub uncertainty: f64,
    /// Half width of the 95 % interval.
    pub half_width_95: f64,
}

/// What circles say.
#[derive(Clone, Debug)]
pub struct CircleCalibration {
    /// EC0Y (plane XY), EB0Z (ZX), EA0Z (YZ), ISO 230-1 signs, rad, where that plane was measured.
    pub squareness_rad: [Option<Term>; 3],
    /// Scale of the first minus scale of the second axis of the plane, in the same order of planes (X-Y, Z-X, Y-Z).
    pub mismatch: [Option<Term>; 3],
    /// How much further each axis stands after coming from above than from below, mm, where directions are given.
    pub backlash_mm: [Option<Term>; 3],
    /// The least squares behind them.
    pub estimate: Estimate,
}

/// First and second axis of the planes XY, ZX, YZ.
const PLANES: [[usize; 2]; 3] = [[0, 1], [2, 0], [1, 2]];

/// Plane of a run: the two axes that move.
fn plane(readings: &[CircleReading], run: usize) -> Result<usize, CalibrationError> {
    let own = || readings.iter().filter(|r| r.run == run);
    let span = |i: usize| {
        let values = || own().map(|r| r.commanded_mm[i]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    };
    let moving: Vec<usize> = (0..3).filter(|&i| span(i) > 1e-3).collect();
    PLANES.iter().position(|p| moving.len() == 2 && p.iter().all(|i| moving.contains(i))).ok_or_else(|| {
        let names: Vec<String> = moving.iter().map(|&i| LETTERS[i].to_string()).collect();
        CalibrationError::Axes(format!(
            "a circle moves two axes; in this run {} move",
            if names.is_empty() { "none".to_owned() } else { names.join(", ") }
        ))
    })
}

/// Fits all runs together.
///
/// Unknown per run: where the fixed ball really is in the plane, and the bar's length. So scales are known only against one
/// another: what both axes have in common looks like another length of the bar.
///
/// # Errors
/// [`CalibrationError`] for runs that are no circles in a plane, and for what the readings leave open.
pub fn calibrate(readings: &[CircleReading]) -> Result<CircleCalibration, CalibrationError> {
    let runs = readings.iter().map(|r| r.run + 1).max().unwrap_or(0);
    let planes: Vec<usize> = (0..runs).map(|run| plane(readings, run)).collect::<Result<_, _>>()?;
    // Parameters: squareness and mismatch of the planes there are, backlash of the axes with directions, then 3 a run.
    let mut names: Vec<String> = Vec::new();
    let mut at = [[None; 3]; 3];
    for plane in 0..3 {
        if planes.contains(&plane) {
            let [u, v] = PLANES[plane].map(|i| LETTERS[i]);
            at[0][plane] = Some(names.len());
            names.push(["EC0Y", "EB0Z", "EA0Z"][plane].to_owned());
            at[1][plane] = Some(names.len());
            names.push(format!("scale {u}-{v}"));
        }
    }
    for axis in 0..3 {
        let both = |sign: i8| readings.iter().any(|r| r.direction[axis] == sign);
        if both(1) && both(-1) {
            at[2][axis] = Some(names.len());
            names.push(format!("backlash {}", LETTERS[axis]));
        }
    }
    let shared = names.len();
    for _ in 0..runs {
        names.extend(["centre", "centre", "length"].map(str::to_owned));
    }
    if readings.len() <= names.len() {
        return Err(CalibrationError::TooFew(format!(
            "{} readings for {} unknowns",
            readings.len(),
            names.len()
        )));
    }
    let mut design = DMatrix::zeros(readings.len(), names.len());
    let mut right = DVector::zeros(readings.len());
    for (row, r) in readings.iter().enumerate() {
        let arm = r.commanded_mm - r.centre_mm;
        let length = arm.norm();
        let unit = arm / length;
        let own = planes[r.run];
        let [u, v] = PLANES[own];
        right[row] = r.length_mm - length;
        // XY: dx = -EC0Y·y; ZX: dx = EB0Z·z; YZ: dy = -EA0Z·z.
        let shear = match own {
            0 => -unit.x * arm.y,
            1 => unit.x * arm.z,
            _ => -unit.y * arm.z,
        };
        if let Some(k) = at[0][own] {
            design[(row, k)] = shear;
        }
        if let Some(k) = at[1][own] {
            design[(row, k)] = 0.5 * (unit[u] * arm[u] - unit[v] * arm[v]);
        }
        for axis in 0..3 {
            if let Some(k) = at[2][axis] {
                design[(row, k)] = -0.5 * f64::from(r.direction[axis]) * unit[axis];
            }
        }
        let base = shared + 3 * r.run;
        design[(row, base)] = -unit[u];
        design[(row, base + 1)] = -unit[v];
        design[(row, base + 2)] = 1.0;
    }
    let estimate = solve(&design, &right, None).map_err(|open| {
        let text: Vec<String> = open
            .iter()
            .map(|c| {
                (0..names.len())
                    .filter(|&k| c[k].abs() > 0.05)
                    .map(|k| names[k].clone())
                    .collect::<Vec<_>>()
                    .join(" from ")
            })
            .collect();
        CalibrationError::Unobservable(text.join("; "))
    })?;
    let term = |k: Option<usize>| {
        k.map(|k| Term {
            value: estimate.values[k],
            uncertainty: estimate.standard_uncertainty(k),
            half_width_95: estimate.half_width_95(k),
        })
    };
    Ok(CircleCalibration {
        squareness_rad: at[0].map(term),
        mismatch: at[1].map(term),
        backlash_mm: at[2].map(term),
        estimate,
    })
}
