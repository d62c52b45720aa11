//! How readings taken one after the other hang together.
//!
//! A tracker read at a kilohertz, a spindle that warms up, air that moves: what one reading is off, the next ones are off, too,
//! and many of them say hardly more than one. What changes from reading to reading and what stays for a while add up; the
//! share that stays and how long it does are estimated together, for a small share that stays for long is nearly unseen from
//! one reading to the next and moves every mean.

use std::collections::BTreeMap;

use crate::equations::observation::{Repeat, Row, Scalar};

/// Correlation of a reading with the k-th next one of its run: `share φ^k`.
///
/// A first-order autoregression (φ below 1) beside white noise; a random walk is its limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Serial {
    /// Share of the variance that hangs together; 0 where readings are independent.
    share: f64,
    /// What is kept of it from one reading to the next.
    phi: f64,
    /// Readings of a run on average: what hangs together ends with the run.
    length: f64,
}

/// Readings hang together beyond so many standard errors of what the lags say, from one reading to the next or together …
const SURE: f64 = 3.0;
/// … and this loss of independent readings: below it intervals grow by less than a tenth.
const LOSS: f64 = 1.2;
/// Lags that are looked at.
const LAGS: usize = 12;
/// What may be kept from one reading to the next: more cannot be told from a random walk.
const MOST_KEPT: f64 = 0.98;
const KEPT: [f64; 11] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, MOST_KEPT];
/// A run must be so many times as long as its readings hang together.
const LONG: f64 = 5.0;
/// Readings of one place one after the other that show how they hang together, and how many pairs there must be.
const STILL: usize = 8;
const PAIRS: f64 = 30.0;

impl Serial {
    /// Correlation from one reading to the `k`-th next one.
    pub(crate) fn lag(self, k: i32) -> f64 {
        self.share * units::math::powf(self.phi, f64::from(k))
    }

    /// True where readings are independent.
    pub(crate) fn is_none(self) -> bool {
        self.share == 0.0
    }

    /// So many readings of a run are as good as an independent one: n of them scatter about their truth as n/this would,
    /// `1 + 2 Σ_{k<n} share φ^k (1 - k/n)`.
    pub(crate) fn as_one(self) -> f64 {
        1.0 + self.share * of_mean(self.phi, self.length)
    }

    /// The same of a run without end.
    fn as_one_without_end(self) -> f64 {
        1.0 + 2.0 * self.share * self.phi / (1.0 - self.phi)
    }

    /// The one of two in which more readings are as good as one.
    pub(crate) fn max(self, other: Self) -> Self {
        if other.as_one() > self.as_one() { other } else { self }
    }

    /// How readings hang together; not at all where runs are not long enough to tell it from structure.
    ///
    /// Readings taken one after the other at one place show it free of all structure, and so does what commands read
    /// otherwise when they come again. Elsewhere what is left of the model shows it, structure without a name included:
    /// either way it is no independent evidence for a name.
    pub(crate) fn of_noise(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Self {
        let Series { standing, again, moving } = series(rows, scalars, residuals_um);
        if let Some(found) = estimated(&standing).or_else(|| estimated(&again)) {
            return found;
        }
        // Readings that hang together for as long as a run cannot be told from structure: it stays what it is called.
        let length = moving.iter().map(Vec::len).sum::<usize>() as f64 / moving.len().max(1) as f64;
        estimated(&moving).filter(|found| length >= LONG * found.as_one_without_end()).unwrap_or_default()
    }

    /// The same for runs of any length: what tests and intervals must count with, for noise that hangs together over a run
    /// is as smooth as an effect and no evidence for one.
    pub(crate) fn at_most(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Self {
        let Series { standing, again, moving } = series(rows, scalars, residuals_um);
        let found = estimated(&standing).or_else(|| estimated(&again)).or_else(|| estimated(&moving));
        found.unwrap_or_default()
    }

    /// Variance of a weighted sum of readings that hang together, over that of independent ones: `Σ ρ_|s-t| x_s x_t / Σ x²`
    /// within the runs, component by component. Below one for what changes from reading to reading, and then taken as one:
    /// the correlation itself is estimated.
    ///
    /// The variance that the second is of was estimated about the means of the runs, and these take a part of the first with
    /// them: about the mean of n readings `σ²(1 - Σ ρ_|s-t| / n²)·n/(n-1)` is left.
    pub(crate) fn inflation(self, rows: &[Row], scalars: &[Scalar], column: &[f64]) -> f64 {
        if self.is_none() {
            return 1.0;
        }
        let Self { share, phi, .. } = self;
        // What the readings before one say of it, by component, faded.
        let mut before = [0.0; 4];
        let mut run = usize::MAX;
        let (mut square, mut cross) = (0.0, 0.0);
        // By component of a run: readings, and what the ones before say of them all.
        let (mut own, mut within, mut degrees) = ([(0.0, 0.0, 0.0); 4], 0.0, 0.0);
        let mut close = |own: &mut [(f64, f64, f64); 4]| {
            for (count, together, _) in own.iter().filter(|o| o.0 > 1.0) {
                within += count - (count + 2.0 * together) / count;
                degrees += count - 1.0;
            }
            *own = [(0.0, 0.0, 0.0); 4];
        };
        for (scalar, x) in scalars.iter().zip(column) {
            if rows[scalar.row].run != run {
                (run, before) = (rows[scalar.row].run, [0.0; 4]);
                close(&mut own);
            }
            let (count, together, faded) = &mut own[scalar.class];
            *together += share * *faded;
            *faded = phi * (*faded + 1.0);
            *count += 1.0;
            let value = x * scalar.weight.sqrt();
            square += value * value;
            cross += share * value * before[scalar.class];
            before[scalar.class] = phi * (before[scalar.class] + value);
        }
        close(&mut own);
        let left = if degrees > 0.0 { (within / degrees).clamp(0.02, 1.0) } else { 1.0 };
        if square > 0.0 { ((1.0 + 2.0 * cross / square) / left).max(1.0) } else { 1.0 }
    }
}

/// Residuals of runs and components in order: stretches at one place, how commands read when they come again, and
/// whole runs.
struct Series {
    standing: Vec<Vec<f64>>,
    again: Vec<Vec<f64>>,
    moving: Vec<Vec<f64>>,
}

fn series(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Series {
    let mut runs: BTreeMap<(usize, usize), Vec<(usize, f64)>> = BTreeMap::new();
    for (scalar, r) in scalars.iter().zip(residuals_um) {
        let line = runs.entry((rows[scalar.row].run, scalar.class)).or_default();
        line.push((scalar.row, r * scalar.weight.sqrt()));
    }
    let still = |a: &(usize, f64), b: &(usize, f64)| {
        let (a, b) = (&rows[a.0].command, &rows[b.0].command);
        a.linear_mm == b.linear_mm && a.rotary_rad == b.rotary_rad && a.tool_mm == b.tool_mm
    };
    let standing: Vec<Vec<f64>> = runs
        .values()
        .flat_map(|line| line.chunk_by(|a, b| still(a, b)))
        .filter(|stretch| stretch.len() >= STILL)
        .map(|stretch| stretch.iter().map(|(_, v)| *v).collect())
        .collect();
    let moving: Vec<Vec<f64>> =
        runs.values().filter(|l| l.len() > 3).map(|l| l.iter().map(|(_, v)| *v).collect()).collect();
    Series { standing, again: again(rows, scalars, residuals_um), moving }
}

/// By how much commands read otherwise than the time before, over √2, in the order of each run and component: free of
/// all structure that comes back. None where few commands come again, or at once.
fn again(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Vec<Vec<f64>> {
    /// Share of the readings that must be repeats.
    const ENOUGH: f64 = 0.25;
    let mut last: BTreeMap<Repeat, (usize, f64)> = BTreeMap::new();
    let mut runs: BTreeMap<(usize, usize), Vec<f64>> = BTreeMap::new();
    for (scalar, r) in scalars.iter().zip(residuals_um) {
        let row = &rows[scalar.row];
        let mut command = scalar.repeats(row);
        command[0] = 0;
        let now = r * scalar.weight.sqrt();
        match last.insert(command, (scalar.row, now)) {
            Some((before, read)) if before + 1 < scalar.row => {
                let line = runs.entry((row.run, scalar.class)).or_default();
                line.push((now - read) / std::f64::consts::SQRT_2);
            }
            _ => {}
        }
    }
    let lines: Vec<Vec<f64>> = runs.into_values().filter(|line| line.len() > 3).collect();
    let repeats = lines.iter().map(Vec::len).sum::<usize>() as f64;
    if repeats < ENOUGH * scalars.len() as f64 { Vec::new() } else { lines }
}

/// Correlation of readings with the `k`-th next ones, pooled.
struct Lag {
    k: i32,
    pairs: f64,
    /// About the means of the runs, as it was found.
    found: f64,
    /// What independent readings about a known mean would show as this.
    about_known: f64,
}

/// What the lags of some series say, pooled; `None` of too few pairs.
///
/// The correlation of n readings less their mean is low by the variance of that mean (Marriott and Pope 1954), which itself
/// is the larger the longer they hang together: both are linear in the share, so for every φ there is one that fits the lags
/// best.
fn estimated(series: &[Vec<f64>]) -> Option<Serial> {
    let (mut square, mut count, mut lines) = (0.0, 0.0, 0.0);
    let mut lags = [(0.0, 0.0); LAGS];
    for line in series {
        let mean = line.iter().sum::<f64>() / line.len() as f64;
        for (k, (product, pairs)) in lags.iter_mut().enumerate().take(line.len() / 2) {
            let apart = line.iter().zip(&line[k + 1..]);
            *product += apart.map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
            *pairs += (line.len() - k - 1) as f64;
        }
        square += line.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (count, lines) = (count + line.len() as f64, lines + 1.0);
    }
    if lags[0].1 < PAIRS || square <= 0.0 {
        return None;
    }
    let length = count / lines;
    let seen: Vec<Lag> = (1..)
        .zip(lags)
        .filter(|(_, (_, pairs))| *pairs >= PAIRS)
        .map(|(k, (product, pairs))| {
            let found = (product / pairs) / (square / count);
            Lag { k, pairs, found, about_known: found + (1.0 - found) / length }
        })
        .collect();
    let next = seen[0].about_known * seen[0].pairs.sqrt();
    let variance: f64 = seen.iter().map(|lag| 1.0 / lag.pairs).sum();
    let together = seen.iter().map(|lag| lag.about_known).sum::<f64>() / variance.sqrt();
    if next.max(together) <= SURE {
        return Some(Serial::default());
    }
    // Of each φ: what is shown of a share of one, lag by lag, and how far a share misses the lags, in squares of standard errors.
    let column = |phi: f64| {
        let of_mean = of_mean(phi, length) / length;
        move |lag: &Lag| units::math::powf(phi, f64::from(lag.k)) - (1.0 - lag.found) * of_mean
    };
    let missed = |Serial { share, phi, .. }: Serial| -> f64 {
        let column = column(phi);
        let miss = |lag: &Lag| lag.about_known - share * column(lag);
        seen.iter().map(|lag| lag.pairs * miss(lag) * miss(lag)).sum()
    };
    let fitted = |phi: f64| {
        let column = column(phi);
        let with: f64 = seen.iter().map(|lag| lag.pairs * column(lag) * lag.about_known).sum();
        let own: f64 = seen.iter().map(|lag| lag.pairs * column(lag) * column(lag)).sum();
        Serial { share: (with / own.max(1e-12)).clamp(0.0, 1.0), phi, length }
    };
    let best = KEPT.into_iter().map(fitted).min_by(|a, b| missed(*a).total_cmp(&missed(*b)))?;
    // All of it hangs together, as the first lag says, unless the others deny that. Lags scatter the more, and the more alike,
    // the longer readings hang together (Bartlett).
    let short = lines / count;
    let phi = ((seen[0].found + short) / (1.0 - 4.0 * short).max(0.2)).clamp(0.0, MOST_KEPT);
    let whole = Serial { share: 1.0, phi, length };
    let best = if missed(whole) > missed(best) + SURE * SURE * whole.as_one() { best } else { whole };
    Some(if best.as_one() > LOSS { best } else { Serial::default() })
}

/// `2 Σ_{k<n} φ^k (1 - k/n)`.
fn of_mean(phi: f64, length: f64) -> f64 {
    let (mut kept, mut sum) = (1.0, 0.0);
    for k in 1..length as usize {
        kept *= phi;
        sum += kept * (1.0 - k as f64 / length);
    }
    2.0 * sum
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};
    use rand_chacha::ChaCha8Rng;

    use super::*;

    /// 60 runs of 40 readings of a share that keeps φ beside white noise.
    fn drawn(share: f64, phi: f64, seed: u64) -> Vec<Vec<f64>> {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut normal = || (0..12).map(|_| random.random_range(-0.5..0.5)).sum::<f64>();
        let mut run = || {
            let mut state = normal();
            let mut next = || {
                state = phi * state + (1.0 - phi * phi).sqrt() * normal();
                share.sqrt() * state + (1.0 - share).sqrt() * normal()
            };
            (0..40).map(|_| next()).collect()
        };
        (0..60).map(|_| run()).collect()
    }

    /// Variance of a sum of 20 readings over that of independent ones, on average of ten draws: what is found of readings
    /// of which a share is kept. A small share that is kept for long is the least well known.
    #[test]
    fn share_and_length_are_found_together() {
        let of_sum = |serial: Serial| {
            1.0 + 2.0 * (1..20).map(|k| serial.lag(k) * (1.0 - f64::from(k) / 20.0)).sum::<f64>()
        };
        for (share, phi, spread) in
            [(0.0, 0.5, 0.1), (1.0, 0.5, 0.3), (1.0, 0.8, 1.0), (0.3, 0.6, 0.2), (0.2, 0.95, 1.2)]
        {
            let found = |seed| of_sum(estimated(&drawn(share, phi, seed)).unwrap());
            let found = (0..10).map(found).sum::<f64>() / 10.0;
            let expected = of_sum(Serial { share, phi, length: 40.0 });
            assert!((found - expected).abs() < spread, "{share} {phi}: {found} for {expected}");
        }
    }

    /// Sum of n readings: its variance over n by the formula, and as drawn.
    #[test]
    fn a_sum_scatters_as_the_inflation_says() {
        let serial = Serial { share: 0.5, phi: 0.7, length: 40.0 };
        let drawn: Vec<Vec<f64>> = (0..20).flat_map(|seed| drawn(0.5, 0.7, seed)).collect();
        let square = drawn.iter().map(|run| run.iter().sum::<f64>().powi(2)).sum::<f64>();
        let found = square / drawn.len() as f64 / 40.0;
        assert!((0.9..1.1).contains(&(found / serial.as_one())), "{found} {}", serial.as_one());
    }
}
