//! Accuracy and repeatability of positioning after ISO 230-2: equations (38) and (39).
//!
//! Deviations are actual minus target position. Everything is in the unit of the deviations, mm or rad.

use crate::error::CalibrationError;

/// Repeated runs over the same targets.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Runs {
    /// Target positions P_i, rising.
    pub targets: Vec<f64>,
    /// Deviations x_ij of the runs in the positive direction, one list per run, in the order of the targets.
    pub positive: Vec<Vec<f64>>,
    /// The same for the negative direction, in the order of the targets too.
    pub negative: Vec<Vec<f64>>,
}

/// One direction at one target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Approach {
    /// Mean deviation x̄_i.
    pub mean: f64,
    /// Estimator s_i of the standard deviation.
    pub deviation: f64,
    /// Repeatability R_i = 4 s_i.
    pub repeatability: f64,
}

/// A value and half the width of its 95 % interval, k = 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertain {
    /// The value.
    pub value: f64,
    /// Expanded uncertainty.
    pub expanded: f64,
}

/// Results at one target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Its position.
    pub position: f64,
    /// Approached in the positive direction.
    pub positive: Option<Approach>,
    /// Approached in the negative direction.
    pub negative: Option<Approach>,
    /// Reversal value B_i = x̄_i↑ - x̄_i↓.
    pub reversal: Option<f64>,
    /// Bidirectional mean x̄_i.
    pub mean: f64,
    /// Bidirectional repeatability R_i.
    pub repeatability: f64,
}

/// Results of one direction of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Direction {
    /// R↑: the largest R_i↑.
    pub repeatability: Uncertain,
    /// E↑: largest minus smallest mean deviation.
    pub systematic: Uncertain,
    /// A↑: largest x̄ + 2s minus smallest x̄ - 2s.
    pub accuracy: Uncertain,
}

/// Results of the axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// By target.
    pub targets: Vec<Target>,
    /// Runs per direction: positive, negative.
    pub runs: [usize; 2],
    /// Positive direction.
    pub positive: Option<Direction>,
    /// Negative direction.
    pub negative: Option<Direction>,
    /// B: the largest |B_i|.
    pub reversal: Option<Uncertain>,
    /// B̄: the mean of B_i, with its sign.
    pub mean_reversal: Option<f64>,
    /// R: the largest R_i.
    pub repeatability: Uncertain,
    /// E.
    pub systematic: Uncertain,
    /// M: range of the bidirectional means.
    pub mean_range: Uncertain,
    /// A.
    pub accuracy: Uncertain,
}

/// Mean and standard deviation of one target and direction over the runs.
fn approach(runs: &[Vec<f64>], target: usize) -> Option<Approach> {
    if runs.is_empty() {
        return None;
    }
    let n = runs.len() as f64;
    let mean = runs.iter().map(|run| run[target]).sum::<f64>() / n;
    let squares: f64 = runs.iter().map(|run| (run[target] - mean) * (run[target] - mean)).sum();
    let deviation = if runs.len() > 1 { (squares / (n - 1.0)).sqrt() } else { 0.0 };
    Some(Approach { mean, deviation, repeatability: 4.0 * deviation })
}

/// A limit of a range: its value, the variance of what it is made of, and where it is.
#[derive(Clone, Copy)]
struct Limit {
    value: f64,
    variance: f64,
    position: f64,
}

/// Largest minus smallest, with the uncertainty of the two and of the instrument over the distance between them.
fn range(limits: &[(Limit, Limit)], relative: f64) -> Option<Uncertain> {
    let top = limits.iter().map(|l| l.0).max_by(|a, b| a.value.total_cmp(&b.value))?;
    let bottom = limits.iter().map(|l| l.1).min_by(|a, b| a.value.total_cmp(&b.value))?;
    let instrument = relative * (top.position - bottom.position);
    let variance = top.variance + bottom.variance + instrument * instrument;
    Some(Uncertain { value: top.value - bottom.value, expanded: 2.0 * variance.sqrt() })
}

/// Evaluates runs: equation (38); the uncertainties are equation (39).
///
/// * `relative` – relative standard uncertainty of the instrument (1e-6 is 1 µm/m): length-proportional, not seen in repeats
///
/// Uncertainties: of a mean s/√n, of s itself s/√(2(n-1)), carried through the formula at the targets that make the
/// extreme. That an extreme is sought among many targets, which makes it larger than its expectation, is not in them.
///
/// # Errors
/// [`CalibrationError::Runs`] where runs do not pass all targets; [`CalibrationError::TooFew`] below two targets or without runs.
pub fn evaluate(runs: &Runs, relative: f64) -> Result<Evaluation, CalibrationError> {
    let count = runs.targets.len();
    if count < 2 || (runs.positive.is_empty() && runs.negative.is_empty()) {
        return Err(CalibrationError::TooFew(format!(
            "{count} targets and {} runs: two targets and one run are the least",
            runs.positive.len() + runs.negative.len()
        )));
    }
    let unequal = |all: &[Vec<f64>]| all.iter().position(|run| run.len() != count);
    for (all, direction) in [(&runs.positive, "positive"), (&runs.negative, "negative")] {
        if let Some(run) = unequal(all) {
            return Err(CalibrationError::Runs(format!(
                "run {} in the {direction} direction has {} readings for {count} targets",
                run + 1,
                all[run].len()
            )));
        }
    }
    let targets: Vec<Target> = (0..count)
        .map(|i| {
            let (up, down) = (approach(&runs.positive, i), approach(&runs.negative, i));
            let reversal = up.zip(down).map(|(u, d)| u.mean - d.mean);
            let mean = match (up, down) {
                (Some(u), Some(d)) => 0.5 * (u.mean + d.mean),
                (Some(one), None) | (None, Some(one)) => one.mean,
                (None, None) => 0.0,
            };
            let own = |a: Option<Approach>| a.map_or(0.0, |a| a.repeatability);
            let both = up
                .zip(down)
                .zip(reversal)
                .map_or(0.0, |((u, d), b)| 2.0 * u.deviation + 2.0 * d.deviation + b.abs());
            Target {
                position: runs.targets[i],
                positive: up,
                negative: down,
                reversal,
                mean,
                repeatability: both.max(own(up)).max(own(down)),
            }
        })
        .collect();
    let counts = [runs.positive.len(), runs.negative.len()];
    let of_mean = |a: &Approach, n: usize| a.deviation * a.deviation / n as f64;
    let of_deviation = |a: &Approach, n: usize| {
        if n > 1 { a.deviation * a.deviation / (2.0 * (n as f64 - 1.0)) } else { 0.0 }
    };
    let pick = |t: &Target, side: usize| if side == 0 { t.positive } else { t.negative };
    let limits = |sides: &[usize], spread: f64| -> Vec<(Limit, Limit)> {
        let mut all = Vec::new();
        for &side in sides {
            for t in &targets {
                if let Some(a) = pick(t, side) {
                    let n = counts[side];
                    let variance = of_mean(&a, n) + spread * spread * of_deviation(&a, n);
                    let limit = |sign: f64| Limit {
                        value: a.mean + sign * spread * a.deviation,
                        variance,
                        position: t.position,
                    };
                    all.push((limit(1.0), limit(-1.0)));
                }
            }
        }
        all
    };
    let direction = |side: usize| -> Option<Direction> {
        let worst = targets
            .iter()
            .filter_map(|t| pick(t, side))
            .max_by(|a, b| a.deviation.total_cmp(&b.deviation))?;
        let u = of_deviation(&worst, counts[side]).sqrt();
        Some(Direction {
            repeatability: Uncertain { value: worst.repeatability, expanded: 2.0 * 4.0 * u },
            systematic: range(&limits(&[side], 0.0), relative)?,
            accuracy: range(&limits(&[side], 2.0), relative)?,
        })
    };
    let few = || CalibrationError::TooFew("no target was read in either direction".to_owned());
    let worst = targets.iter().max_by(|a, b| a.repeatability.total_cmp(&b.repeatability)).ok_or_else(few)?;
    let means: Vec<(Limit, Limit)> = targets
        .iter()
        .map(|t| {
            let parts =
                [t.positive.map(|a| of_mean(&a, counts[0])), t.negative.map(|a| of_mean(&a, counts[1]))];
            let given = parts.iter().flatten().count().max(1) as f64;
            let variance = parts.iter().flatten().sum::<f64>() / (given * given);
            let limit = Limit { value: t.mean, variance, position: t.position };
            (limit, limit)
        })
        .collect();
    let reversal = targets
        .iter()
        .filter_map(|t| Some((t.reversal?, t.positive?, t.negative?)))
        .max_by(|a, b| a.0.abs().total_cmp(&b.0.abs()))
        .map(|(b, up, down)| Uncertain {
            value: b.abs(),
            expanded: 2.0 * (of_mean(&up, counts[0]) + of_mean(&down, counts[1])).sqrt(),
        });
    let given: Vec<f64> = targets.iter().filter_map(|t| t.reversal).collect();
    Ok(Evaluation {
        runs: counts,
        positive: direction(0),
        negative: direction(1),
        reversal,
        mean_reversal: (!given.is_empty()).then(|| given.iter().sum::<f64>() / given.len() as f64),
        repeatability: Uncertain {
            value: worst.repeatability,
            expanded: repeatability_uncertainty(worst, counts),
        },
        systematic: range(&limits(&[0, 1], 0.0), relative).ok_or_else(few)?,
        mean_range: range(&means, relative).ok_or_else(few)?,
        accuracy: range(&limits(&[0, 1], 2.0), relative).ok_or_else(few)?,
        targets,
    })
}

/// Expanded uncertainty of R where it is R_i of this target.
fn repeatability_uncertainty(target: &Target, counts: [usize; 2]) -> f64 {
    let parts = [(target.positive, counts[0]), (target.negative, counts[1])];
    let of_deviation = |a: &Approach, n: usize| {
        if n > 1 { a.deviation * a.deviation / (2.0 * (n as f64 - 1.0)) } else { 0.0 }
    };
    // Of one direction 4s, of both 2s↑ + 2s↓ + |B|.
    for (approach, n) in &parts {
        if let Some(a) = approach
            && a.repeatability >= target.repeatability
        {
            return 2.0 * 4.0 * of_deviation(a, *n).sqrt();
        }
    }
    let variance: f64 = parts
        .iter()
        .filter_map(|(a, n)| a.map(|a| 4.0 * of_deviation(&a, *n) + a.deviation * a.deviation / *n as f64))
        .sum();
    2.0 * variance.sqrt()
}
