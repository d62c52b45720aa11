//! Accuracy and repeatability of positioning after ISO 230-2: equations (38) and (39).
//!
//! Deviations are actual minus target position. Everything is in the unit of the deviations, mm or rad.

use diagnostic::{Text, both};
use statrs::distribution::{ChiSquared, ContinuousCDF};
use units::math;

use crate::error::CalibrationError;
use crate::student::quantile_95;

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

/// A value and half the width of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Uncertain {
    /// The value.
    pub value: f64,
    /// Expanded uncertainty.
    pub expanded: f64,
    /// Positions of the targets that make it: of the upper limit, of the lower; one and the same where one target does.
    pub at: [f64; 2],
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

/// A variance and the degrees of freedom it is known with.
#[derive(Clone, Copy)]
struct Variance {
    value: f64,
    freedom: f64,
}

impl Variance {
    const ZERO: Self = Self { value: 0.0, freedom: f64::INFINITY };

    fn times(self, factor: f64) -> Self {
        Self { value: self.value * factor, ..self }
    }

    /// Of a sum of independent parts: Welch–Satterthwaite.
    fn sum(parts: &[Self]) -> Self {
        let value: f64 = parts.iter().map(|p| p.value).sum();
        let uncertain: f64 = parts.iter().map(|p| p.value * p.value / p.freedom).sum();
        let freedom = if uncertain > 0.0 { value * value / uncertain } else { f64::INFINITY };
        Self { value, freedom }
    }

    /// Half width of the 95 % interval: t(95 %) instead of k = 2, which five runs do not carry.
    fn half_width_95(self) -> f64 {
        // Whole degrees of freedom, rounded down: the wider interval.
        let freedom =
            (self.freedom.is_finite() && self.freedom < 1e6).then(|| (self.freedom as usize).max(1));
        if self.value > 0.0 { quantile_95(freedom) * self.value.sqrt() } else { 0.0 }
    }
}

/// Chance below which the standard deviations of the targets are not taken for samples of one.
const UNEQUAL: f64 = 0.01;

/// How well the scatter of one reading is known, target by target: equation (39).
///
/// Where the scatter of all targets and directions may be one and the same (Bartlett 1937), it is pooled: a target that happens to
/// scatter little does not make its own figure look certain. Otherwise each has its own.
fn scatters(all: &[Option<(Approach, usize)>]) -> Vec<Variance> {
    // One run says nothing of the scatter.
    let own = |a: &Option<(Approach, usize)>| match a {
        Some((a, n)) if *n > 1 => Variance { value: a.deviation * a.deviation, freedom: (n - 1) as f64 },
        _ => Variance::ZERO,
    };
    let each: Vec<Variance> = all.iter().map(own).collect();
    let known: Vec<Variance> = each.iter().copied().filter(|v| v.freedom.is_finite()).collect();
    let freedom: f64 = known.iter().map(|v| v.freedom).sum();
    if known.len() < 2 || known.iter().any(|v| v.value <= 0.0) {
        return each;
    }
    let pooled = known.iter().map(|v| v.freedom * v.value).sum::<f64>() / freedom;
    let groups = known.len() as f64;
    let correction =
        1.0 + (known.iter().map(|v| 1.0 / v.freedom).sum::<f64>() - 1.0 / freedom) / (3.0 * (groups - 1.0));
    let statistic = (freedom * math::ln(pooled)
        - known.iter().map(|v| v.freedom * math::ln(v.value)).sum::<f64>())
        / correction;
    let chance = ChiSquared::new(groups - 1.0).map_or(0.0, |chi| chi.sf(statistic));
    if chance < UNEQUAL { each } else { vec![Variance { value: pooled, freedom }; all.len()] }
}

/// How far single readings spread, before and after each run was corrected by the mean of the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeldOut {
    /// Largest minus smallest reading, over all targets, runs and directions.
    pub before: f64,
    /// The same of what the correction leaves.
    pub after: f64,
    /// Root mean square of what it leaves.
    pub after_rms: f64,
}

/// What a correction by target and direction leaves of runs that it was not made of: equation (79).
///
/// `None` where a direction was run once: then no run is left to correct it by.
#[must_use]
pub fn held_out(runs: &Runs) -> Option<HeldOut> {
    let read: Vec<&Vec<Vec<f64>>> =
        [&runs.positive, &runs.negative].into_iter().filter(|all| !all.is_empty()).collect();
    if read.is_empty() || read.iter().any(|all| all.len() < 2) {
        return None;
    }
    let range = |values: &[f64]| {
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        high - values.iter().copied().fold(f64::INFINITY, f64::min)
    };
    let before: Vec<f64> = read.iter().flat_map(|all| all.iter().flatten()).copied().collect();
    let mut after = Vec::with_capacity(before.len());
    for all in read {
        let others = (all.len() - 1) as f64;
        for target in 0..runs.targets.len() {
            let sum: f64 = all.iter().map(|run| run[target]).sum();
            after.extend(all.iter().map(|run| run[target] - (sum - run[target]) / others));
        }
    }
    let squares: f64 = after.iter().map(|v| v * v).sum();
    Some(HeldOut {
        before: range(&before),
        after: range(&after),
        after_rms: (squares / after.len() as f64).sqrt(),
    })
}

/// A limit of a range: its value, the variance of what it is made of, and where it is.
#[derive(Clone, Copy)]
struct Limit {
    value: f64,
    variance: Variance,
    /// The part of the variance that is the deviation's.
    of_deviation: Variance,
    position: f64,
    /// Target and direction.
    place: usize,
}

/// Largest minus smallest, with the uncertainty of the two and of the instrument over the distance between them.
fn range(limits: &[(Limit, Limit)], relative: f64) -> Option<Uncertain> {
    let top = limits.iter().map(|l| l.0).max_by(|a, b| a.value.total_cmp(&b.value))?;
    let bottom = limits.iter().map(|l| l.1).min_by(|a, b| a.value.total_cmp(&b.value))?;
    let instrument = relative * (top.position - bottom.position);
    let known = Variance { value: instrument * instrument, freedom: f64::INFINITY };
    let variance = if top.place == bottom.place {
        // x̄ + 2s - (x̄ - 2s): one deviation twice, and no mean.
        top.of_deviation.times(4.0)
    } else {
        Variance::sum(&[top.variance, bottom.variance, known])
    };
    Some(Uncertain {
        value: top.value - bottom.value,
        expanded: variance.half_width_95(),
        at: [top.position, bottom.position],
    })
}

/// Evaluates runs: equation (38); the uncertainties are equation (39).
///
/// * `relative` – relative standard uncertainty of the instrument (1e-6 is 1 µm/m): length-proportional, not seen in repeats
///
/// Uncertainties: of a mean s/√n, of s itself s/√(2(n-1)), carried through the formula at the targets that make the
/// extreme, times t(95 %) for the degrees of freedom of s; s is pooled over the targets where they may all scatter alike. That an
/// extreme is sought among many targets, which makes it larger than its expectation, is not in them.
///
/// # Errors
/// [`CalibrationError::Runs`] where runs do not pass all targets; [`CalibrationError::TooFew`] below two targets or without runs.
pub fn evaluate(runs: &Runs, relative: f64) -> Result<Evaluation, CalibrationError> {
    let count = runs.targets.len();
    if count < 2 || (runs.positive.is_empty() && runs.negative.is_empty()) {
        return Err(CalibrationError::TooFew(both!(
            "{count} targets and {} runs: two targets and one run are the least",
            "целей {count}, проходов {}: нужны хотя бы две цели и один проход",
            runs.positive.len() + runs.negative.len()
        )));
    }
    let unequal = |all: &[Vec<f64>]| all.iter().position(|run| run.len() != count);
    for (all, direction) in [
        (&runs.positive, Text::pair("positive", "положительном")),
        (&runs.negative, Text::pair("negative", "отрицательном")),
    ] {
        if let Some(run) = unequal(all) {
            return Err(CalibrationError::Runs(both!(
                "run {} in the {direction} direction has {} readings for {count} targets",
                "в проходе {} в {direction:#} направлении отсчётов {} на {count} целей",
                run + 1,
                all[run].len()
            )));
        }
    }
    let targets: Vec<Target> = (0..count).map(|i| Target::of(runs, i)).collect();
    let few = || {
        CalibrationError::TooFew(Text::pair(
            "no target was read in either direction",
            "ни в одном направлении не снято ни одной цели",
        ))
    };
    let passes = Passes::of(&targets, [runs.positive.len(), runs.negative.len()]);
    let given: Vec<f64> = targets.iter().filter_map(|t| t.reversal).collect();
    Ok(Evaluation {
        runs: passes.counts,
        positive: passes.direction(0, relative),
        negative: passes.direction(1, relative),
        reversal: passes.reversal(),
        mean_reversal: (!given.is_empty()).then(|| given.iter().sum::<f64>() / given.len() as f64),
        repeatability: passes.repeatability().ok_or_else(few)?,
        systematic: range(&passes.limits(&[0, 1], 0.0), relative).ok_or_else(few)?,
        mean_range: range(&passes.means(), relative).ok_or_else(few)?,
        accuracy: range(&passes.limits(&[0, 1], 2.0), relative).ok_or_else(few)?,
        targets,
    })
}

impl Target {
    /// What the runs say of the target of this index.
    fn of(runs: &Runs, i: usize) -> Self {
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
        Self {
            position: runs.targets[i],
            positive: up,
            negative: down,
            reversal,
            mean,
            repeatability: both.max(own(up)).max(own(down)),
        }
    }

    /// How it was approached from one side: 0 positive, 1 negative.
    fn approached_from(&self, side: usize) -> Option<Approach> {
        if side == 0 { self.positive } else { self.negative }
    }
}

/// All targets, from both sides: 0 positive, 1 negative.
struct Passes<'t> {
    targets: &'t [Target],
    /// Runs from each side.
    counts: [usize; 2],
    /// Of one reading, at each target.
    scatter: [Vec<Variance>; 2],
}

impl<'t> Passes<'t> {
    fn of(targets: &'t [Target], counts: [usize; 2]) -> Self {
        let side =
            |side: usize| targets.iter().map(move |t| t.approached_from(side).map(|a| (a, counts[side])));
        let mut positive = scatters(&side(0).chain(side(1)).collect::<Vec<_>>());
        let negative = positive.split_off(targets.len());
        Self { targets, counts, scatter: [positive, negative] }
    }

    /// A result of one target.
    fn target(&self, i: usize) -> [f64; 2] {
        [self.targets[i].position; 2]
    }

    /// s²/n
    fn of_mean(&self, side: usize, i: usize) -> Variance {
        self.scatter[side][i].times(1.0 / self.counts[side].max(1) as f64)
    }

    /// s²/(2(n-1)); nothing of one run.
    fn of_deviation(&self, side: usize, i: usize) -> Variance {
        let n = self.counts[side] as f64;
        self.scatter[side][i].times(if n > 1.0 { 0.5 / (n - 1.0) } else { 0.0 })
    }

    /// Mean and so many deviations above and below it, at each target from these sides.
    fn limits(&self, sides: &[usize], spread: f64) -> Vec<(Limit, Limit)> {
        let mut all = Vec::new();
        for &side in sides {
            for (i, t) in self.targets.iter().enumerate() {
                let Some(a) = t.approached_from(side) else { continue };
                // Mean and deviation come from the same scatter.
                let n = self.counts[side] as f64;
                let of_deviation = if n > 1.0 { 0.5 * spread * spread / (n - 1.0) } else { 0.0 };
                let limit = |sign: f64| Limit {
                    value: a.mean + sign * spread * a.deviation,
                    variance: self.scatter[side][i].times(1.0 / n + of_deviation),
                    of_deviation: self.scatter[side][i].times(of_deviation),
                    position: t.position,
                    place: side * self.targets.len() + i,
                };
                all.push((limit(1.0), limit(-1.0)));
            }
        }
        all
    }

    /// What one side says alone.
    fn direction(&self, side: usize, relative: f64) -> Option<Direction> {
        let read = self.targets.iter().enumerate().filter_map(|(i, t)| Some((i, t.approached_from(side)?)));
        let (i, worst) = read.max_by(|a, b| a.1.deviation.total_cmp(&b.1.deviation))?;
        let expanded = self.of_deviation(side, i).times(16.0).half_width_95();
        Some(Direction {
            repeatability: Uncertain { value: worst.repeatability, expanded, at: self.target(i) },
            systematic: range(&self.limits(&[side], 0.0), relative)?,
            accuracy: range(&self.limits(&[side], 2.0), relative)?,
        })
    }

    /// The largest reversal value.
    fn reversal(&self) -> Option<Uncertain> {
        let read = self.targets.iter().enumerate().filter_map(|(i, t)| Some((i, t.reversal?)));
        let (i, reversal) = read.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let variance = Variance::sum(&[self.of_mean(0, i), self.of_mean(1, i)]);
        Some(Uncertain { value: reversal.abs(), expanded: variance.half_width_95(), at: self.target(i) })
    }

    /// The worst bi-directional repeatability: of one direction 4s, of both 2s↑ + 2s↓ + |B|.
    fn repeatability(&self) -> Option<Uncertain> {
        let all = self.targets.iter().enumerate();
        let (i, worst) = all.max_by(|a, b| a.1.repeatability.total_cmp(&b.1.repeatability))?;
        let alone = |side: &usize| {
            worst.approached_from(*side).is_some_and(|a| a.repeatability >= worst.repeatability)
        };
        let variance = match (0..2).find(alone) {
            Some(side) => self.of_deviation(side, i).times(16.0),
            None => Variance::sum(&[
                self.of_deviation(0, i).times(4.0),
                self.of_deviation(1, i).times(4.0),
                self.of_mean(0, i),
                self.of_mean(1, i),
            ]),
        };
        Some(Uncertain { value: worst.repeatability, expanded: variance.half_width_95(), at: self.target(i) })
    }

    /// The mean bi-directional deviations.
    fn means(&self) -> Vec<(Limit, Limit)> {
        let mean = |(i, t): (usize, &Target)| {
            let read = (0..2).filter(|side| t.approached_from(*side).is_some());
            let parts: Vec<Variance> = read.map(|side| self.of_mean(side, i)).collect();
            let given = parts.len().max(1) as f64;
            let variance = Variance::sum(&parts).times(1.0 / (given * given));
            let of_deviation = Variance::ZERO;
            let limit = Limit { value: t.mean, variance, of_deviation, position: t.position, place: i };
            (limit, limit)
        };
        self.targets.iter().enumerate().map(mean).collect()
    }
}
