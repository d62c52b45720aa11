//! What of the residual is noise: repeats, neighbours, outliers.

use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::equations::observation::{Repeat, Row, Scalar};
use crate::equations::serial::Serial;

/// Where the noise figure comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NoiseSource {
    /// Same command, same approach, same conditions, measured again.
    Repeats,
    /// No repeats: differences of neighbouring rows of a run.
    Neighbours,
    /// No repeats: differences of the same command in other runs, where neighbours differ by far more.
    Returns,
    /// No repeats: what a form of second degree leaves of every run, where neighbouring rows differ by far more.
    Forms,
}

/// Noise of a row of weight one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Noise {
    /// Variance, µm².
    pub variance: f64,
    /// Degrees of freedom of that variance.
    pub degrees: f64,
    /// Where it comes from.
    pub source: NoiseSource,
    /// Scatter of repeats over that of neighbouring readings, at least 1.
    pub slow: f64,
}

impl Noise {
    /// True where one command read again differs by more than neighbouring readings scatter.
    pub(crate) fn is_slow(&self) -> bool {
        self.slow > SLOW
    }
}

/// Repeats must give at least this many degrees of freedom to be believed.
const ENOUGH_REPEATS: f64 = 12.0;

/// Fewer degrees of freedom say nothing of a bound.
const ENOUGH: f64 = 4.0;
/// Two estimates of a standard deviation differ by more than chance beyond so many standard errors of their ratio.
const NO_CHANCE: f64 = 2.0;

/// Repeats that scatter by this factor more than neighbours (standard deviations) differ by more than noise: something
/// changed between the passes.
const SLOW: f64 = 2.0;

/// Noise variance from residuals: from repeats where there are enough, else from neighbours.
///
/// `serial`: how the readings of a run hang together. Neighbours then differ by less than independent readings: `σ²` times
/// `1 - 4ρ₁/3 + ρ₂/3` in second differences.
pub(crate) fn estimate(
    rows: &[Row],
    scalars: &[Scalar],
    residuals_um: &[f64],
    serial: Serial,
) -> Option<Noise> {
    let floor = quantum_um(scalars).powi(2) / 12.0;
    let neighbours = from_neighbours(rows, scalars, residuals_um, serial);
    let found = match from_repeats(rows, scalars, residuals_um) {
        Some(noise) if noise.degrees >= ENOUGH_REPEATS => {
            let slow = neighbours
                .map_or(1.0, |n| (noise.variance / n.variance.max(floor).max(1e-12)).sqrt())
                .max(1.0);
            Some(Noise { slow, ..noise })
        }
        few => {
            // What comes back in every run is no noise, however much neighbouring places differ by it.
            let returns = bound(rows, scalars, residuals_um);
            let below = |found: &Noise, factor: f64| {
                neighbours.is_some_and(|n| found.variance.max(floor) * factor * factor < n.variance)
            };
            let by_chance = |found: &Noise| {
                neighbours.map_or(1.0, |n| 1.0 + NO_CHANCE * (0.5 / found.degrees + 0.5 / n.degrees).sqrt())
            };
            // Rows measured in no order of place have no neighbours: a smooth form of each run shows what is no noise. It
            // takes slow noise off, too, so that it must be far smaller.
            returns
                .filter(|found| below(found, by_chance(found)))
                .or_else(|| from_forms(rows, scalars, residuals_um).filter(|found| below(found, SLOW)))
                .or(neighbours)
                .or(few)
        }
    };
    found.map(|noise| Noise { variance: noise.variance.max(floor), ..noise })
}

/// What no noise exceeds: the scatter of the same commands from run to run, where there are enough of them.
pub(crate) fn bound(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Option<Noise> {
    let floor = quantum_um(scalars).powi(2) / 12.0;
    let found = from_returns(rows, scalars, residuals_um).filter(|found| found.degrees >= ENOUGH)?;
    Some(Noise { variance: found.variance.max(floor), ..found })
}

/// True where rows measured one after the other lie so far apart that a gap of any shape differs between them as noise does.
pub(crate) fn neighbours_are_far(rows: &[Row]) -> bool {
    /// Of the diagonal of what was measured: a line has four steps and more.
    const FAR: f64 = 0.25;
    let place = |row: &Row| row.command.linear_mm + row.command.tool_mm;
    let corner = |pick: fn(f64, f64) -> f64| {
        rows.iter().map(place).reduce(|a, b| a.zip_map(&b, pick)).unwrap_or_default()
    };
    let pairs = rows.windows(2).filter(|pair| pair[0].run == pair[1].run);
    let mut steps: Vec<f64> = pairs.map(|pair| (place(&pair[1]) - place(&pair[0])).norm()).collect();
    median(&mut steps).is_some_and(|step| step > FAR * (corner(f64::max) - corner(f64::min)).norm())
}

/// Step of the readings, µm, 0 where they have none: a display that shows whole micrometres gives few different values.
pub(crate) fn quantum_um(scalars: &[Scalar]) -> f64 {
    /// Distinct values may be at most this share of the readings.
    const FEW: f64 = 0.3;
    let mut values: Vec<f64> = scalars.iter().map(|s| s.reading_um).collect();
    values.sort_by(f64::total_cmp);
    let mut steps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).filter(|d| *d > 1e-9).collect();
    if (steps.len() as f64) < FEW * values.len() as f64 { median(&mut steps).unwrap_or(0.0) } else { 0.0 }
}

/// Scatter about the mean of repeats. The same command in another run, with another artefact or instrument or at another
/// temperature is no repeat: what differs then is set-up, workpiece or machine.
///
/// Single blunders would make the noise large enough to hide themselves: readings of three repeats and more that lie
/// further than [`BLUNDER`] robust standard deviations from their median are left out.
fn from_repeats(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Option<Noise> {
    /// Far beyond the tail of what is left when outliers have gone.
    const BLUNDER: f64 = 8.0;
    let mut groups: BTreeMap<Repeat, Vec<f64>> = BTreeMap::new();
    for (scalar, r) in scalars.iter().zip(residuals_um) {
        groups.entry(scalar.repeats(&rows[scalar.row])).or_default().push(r * scalar.weight.sqrt());
    }
    groups.retain(|_, group| group.len() > 1);
    let differences = groups.values().flat_map(|g| g.windows(2).map(|w| (w[1] - w[0]).abs()));
    let robust = 1.4826 / std::f64::consts::SQRT_2 * median(&mut differences.collect::<Vec<f64>>())?;
    let (mut square, mut degrees) = (0.0, 0.0);
    for group in groups.values_mut() {
        if group.len() > 2 && robust > 0.0 {
            let middle = median(&mut group.clone()).unwrap_or(0.0);
            group.retain(|v| (v - middle).abs() <= BLUNDER * robust);
        }
        let mean = group.iter().sum::<f64>() / group.len() as f64;
        square += group.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        degrees += group.len() as f64 - 1.0;
    }
    let source = NoiseSource::Repeats;
    (degrees > 0.0).then(|| Noise { variance: square / degrees, degrees, source, slow: 1.0 })
}

/// Differences of the same command in other runs, the runs' own offsets taken off, robustly. It holds the runs' differences
/// too, so that no noise is larger; how much smaller, nobody knows.
fn from_returns(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Option<Noise> {
    let mut runs: BTreeMap<(usize, usize), Vec<f64>> = BTreeMap::new();
    let weighted: Vec<f64> = scalars.iter().zip(residuals_um).map(|(s, r)| r * s.weight.sqrt()).collect();
    for (scalar, value) in scalars.iter().zip(&weighted) {
        runs.entry((rows[scalar.row].run, scalar.class)).or_default().push(*value);
    }
    let offsets: BTreeMap<(usize, usize), f64> =
        runs.into_iter().map(|(run, mut values)| (run, median(&mut values).unwrap_or(0.0))).collect();
    let mut groups: BTreeMap<Repeat, Vec<f64>> = BTreeMap::new();
    for (scalar, value) in scalars.iter().zip(&weighted) {
        let mut key = scalar.repeats(&rows[scalar.row]);
        key[0] = 0;
        groups.entry(key).or_default().push(value - offsets[&(rows[scalar.row].run, scalar.class)]);
    }
    let mut differences: Vec<f64> =
        groups.values().flat_map(|group| group.windows(2).map(|w| (w[1] - w[0]).abs())).collect();
    let degrees = differences.len() as f64 / 3.0;
    let sigma = 1.4826 / std::f64::consts::SQRT_2 * median(&mut differences)?;
    // Where most of them read the very same number, the step of the display is what scatters.
    let square = differences.iter().map(|d| d * d).sum::<f64>() / (2.0 * differences.len() as f64);
    let variance = if sigma > 0.0 { sigma * sigma } else { square };
    Some(Noise { variance, degrees, source: NoiseSource::Returns, slow: 1.0 })
}

/// What a polynomial of second degree in the place leaves of every run that has readings enough for it.
fn from_forms(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Option<Noise> {
    /// Coefficients of the form, and readings that a run must have.
    const FORM: usize = 10;
    const READINGS: usize = 24;
    let mut runs: BTreeMap<(usize, usize), Vec<(machine_model::Vector, f64)>> = BTreeMap::new();
    for (scalar, r) in scalars.iter().zip(residuals_um) {
        let row = &rows[scalar.row];
        let place = row.command.linear_mm + row.command.tool_mm;
        runs.entry((row.run, scalar.class)).or_default().push((place, r * scalar.weight.sqrt()));
    }
    let (mut square, mut degrees) = (0.0, 0.0);
    for points in runs.values().filter(|points| points.len() >= READINGS) {
        let count = points.len() as f64;
        let middle = points.iter().map(|p| p.0).sum::<machine_model::Vector>() / count;
        let reach = points.iter().map(|p| (p.0 - middle).amax()).fold(1e-9, f64::max);
        let form = |place: machine_model::Vector| {
            let u = (place - middle) / reach;
            [1.0, u.x, u.y, u.z, u.x * u.x, u.y * u.y, u.z * u.z, u.x * u.y, u.x * u.z, u.y * u.z]
        };
        let columns = DMatrix::from_fn(points.len(), FORM, |i, j| form(points[i].0)[j]);
        let values = DVector::from_iterator(points.len(), points.iter().map(|p| p.1));
        let turned = columns.svd(true, false);
        let largest = turned.singular_values.max();
        let kept: Vec<usize> = (0..FORM).filter(|k| turned.singular_values[*k] > 1e-6 * largest).collect();
        let Some(directions) = turned.u else { continue };
        let taken: f64 = kept.iter().map(|k| directions.column(*k).dot(&values).powi(2)).sum();
        square += (values.norm_squared() - taken).max(0.0);
        degrees += count - kept.len() as f64;
    }
    let source = NoiseSource::Forms;
    (degrees >= 5.0 * ENOUGH_REPEATS).then(|| Noise {
        variance: square / degrees,
        degrees,
        source,
        slow: 1.0,
    })
}

/// A place in steps, a class of readings, and which way the axes came.
type Returning = ([i64; 6], usize, [i8; 3]);

/// Weighed residuals in the order of the rows, by run, class and way.
pub(crate) fn along_runs(
    rows: &[Row],
    scalars: &[Scalar],
    residuals_um: &[f64],
) -> BTreeMap<(usize, usize, [i8; 3]), Vec<f64>> {
    let mut lines: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    for (scalar, r) in scalars.iter().zip(residuals_um) {
        let row = &rows[scalar.row];
        let line = lines.entry((row.run, scalar.class, row.command.direction)).or_default();
        line.push(r * scalar.weight.sqrt());
    }
    lines
}

/// Second differences along a run, robustly: a smooth residual cancels, noise does not.
fn from_neighbours(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64], serial: Serial) -> Option<Noise> {
    let mut differences: Vec<f64> = along_runs(rows, scalars, residuals_um)
        .values()
        .flat_map(|line| line.windows(3).map(|w| (w[1] - 0.5 * (w[0] + w[2])).abs() / 1.5_f64.sqrt()))
        .collect();
    let degrees = differences.len() as f64 / 3.0;
    let sigma = 1.4826 * median(&mut differences)?;
    let variance = sigma * sigma / (1.0 - 4.0 / 3.0 * serial.lag(1) + serial.lag(2) / 3.0).max(0.02);
    let source = NoiseSource::Neighbours;
    (degrees >= ENOUGH).then_some(Noise { variance, degrees, source, slow: 1.0 })
}

/// Median; sorts what it is given.
pub(crate) fn median(values: &mut [f64]) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match values.len() {
        0 => None,
        n if n % 2 == 1 => Some(values[middle]),
        _ => Some(0.5 * (values[middle - 1] + values[middle])),
    }
}

/// A residual is an outlier beyond this many robust standard deviations.
const OUTLIER: f64 = 4.5;
/// A neighbour that is as far out on the same side makes it structure, not an outlier.
const ACCOMPLICE: f64 = 2.5;

/// A reading this many robust standard deviations off its neighbours, which agree, is a blunder whatever the model.
const BLUNDER: f64 = 10.0;
/// Two neighbours agree where they differ by at most this share of what a reading differs from them.
const AGREE: f64 = 0.25;

/// Rows that stand alone far from what the model and their neighbours say, ascending.
pub(crate) fn outliers(rows: &[Row], scalars: &[Scalar], residuals_um: &[f64]) -> Vec<usize> {
    let weighted: Vec<f64> = scalars.iter().zip(residuals_um).map(|(s, r)| r * s.weight.sqrt()).collect();
    let Some(sigma) = robust_sigma(scalars, weighted.iter().copied()) else { return Vec::new() };
    let far: Vec<f64> = weighted.iter().map(|v| v / sigma).collect();
    Surroundings::new(rows, scalars, &far).lone(&lines(rows, scalars), OUTLIER)
}

/// Rows that no model is needed to know as blunders, ascending: far off both neighbours of their run, which agree with each
/// other, while no other reading of that place says the same.
///
/// A search that has them among its rows finds causes for them: a step at a moment, damage at a place.
pub(crate) fn blunders(rows: &[Row], scalars: &[Scalar]) -> Vec<usize> {
    let mut off = vec![0.0; scalars.len()];
    let mut stands_out = vec![false; scalars.len()];
    let mut at_end = vec![false; scalars.len()];
    let lines = lines(rows, scalars);
    for line in lines.values() {
        for (place, index) in line.iter().enumerate() {
            let last = line.len() - 1;
            let beside = match place {
                _ if line.len() < 3 => continue,
                0 => [1, 2],
                _ if place == last => [last - 1, last - 2],
                _ => [place - 1, place + 1],
            };
            let [a, b] = beside.map(|p| scalars[line[p]].gap_um);
            let weight = scalars[*index].weight.sqrt();
            off[*index] = (scalars[*index].gap_um - 0.5 * (a + b)) * weight;
            stands_out[*index] = (a - b).abs() * weight <= AGREE * off[*index].abs();
            at_end[*index] = place == 0 || place == last;
        }
    }
    let Some(sigma) = robust_sigma(scalars, off.iter().copied()) else { return Vec::new() };
    let far: Vec<f64> =
        off.iter().zip(&stands_out).map(|(off, alone)| if *alone { off / sigma } else { 0.0 }).collect();
    if far.iter().all(|far| far.abs() <= BLUNDER) {
        return Vec::new();
    }
    let surroundings = Surroundings::new(rows, scalars, &far);
    let mut found = surroundings.lone(&lines, BLUNDER);
    // Behind a turn at the end of a run everything may be different: only other readings of that place say that it is not.
    let unknown = |row: usize| {
        let own = || (0..scalars.len()).filter(move |i| scalars[*i].row == row);
        own().any(|i| at_end[i]) && !own().any(|i| surroundings.has_returns(i))
    };
    found.retain(|row| !unknown(*row));
    found
}

/// Standard deviation by the median, no less than the step of the display: where most readings show the same number, that
/// step is the scatter.
fn robust_sigma(scalars: &[Scalar], values: impl Iterator<Item = f64>) -> Option<f64> {
    let mad = median(&mut values.map(f64::abs).collect::<Vec<f64>>())?;
    Some((1.4826 * mad).max(quantum_um(scalars)).max(1e-6))
}

/// Equations of a run and a class, in order.
type Lines = BTreeMap<(usize, usize), Vec<usize>>;

fn lines(rows: &[Row], scalars: &[Scalar]) -> Lines {
    let mut lines = Lines::new();
    for (index, scalar) in scalars.iter().enumerate() {
        lines.entry((rows[scalar.row].run, scalar.class)).or_default().push(index);
    }
    lines
}

/// No way at all stands for any: a direction of 2 is none.
const fn reached_any_way((place, class, _): Returning) -> Returning {
    (place, class, [2; 3])
}

/// Equations with how far off each is, in standard deviations, and what others say of its place.
struct Surroundings<'a> {
    rows: &'a [Row],
    scalars: &'a [Scalar],
    far: &'a [f64],
    /// Sum and count at one place of a run, whatever the direction and the repeat.
    places: BTreeMap<(usize, usize, [i64; 6]), (f64, f64)>,
    /// Sum and count at one place reached one way, whatever the run; and reached any way: edges of a cube begin in one corner.
    returns: BTreeMap<Returning, (f64, f64)>,
}

impl<'a> Surroundings<'a> {
    fn new(rows: &'a [Row], scalars: &'a [Scalar], far: &'a [f64]) -> Self {
        let (places, returns) = (BTreeMap::new(), BTreeMap::new());
        let mut all = Self { rows, scalars, far, places, returns };
        for (scalar, far) in scalars.iter().zip(far) {
            let (place, returning) = (all.place_of(scalar), all.return_of(scalar));
            let entry = all.places.entry(place).or_default();
            *entry = (entry.0 + far, entry.1 + 1.0);
            for way in [returning, reached_any_way(returning)] {
                let entry = all.returns.entry(way).or_default();
                *entry = (entry.0 + far, entry.1 + 1.0);
            }
        }
        all
    }

    fn place_of(&self, scalar: &Scalar) -> (usize, usize, [i64; 6]) {
        let row = &self.rows[scalar.row];
        let (q, t) = (row.command.linear_mm, row.command.rotary_rad);
        let step = |v: f64| (v * 1e4).round() as i64;
        (row.run, scalar.class, [step(q.x), step(q.y), step(q.z), step(t.x), step(t.y), step(t.z)])
    }

    fn return_of(&self, scalar: &Scalar) -> Returning {
        let (_, class, place) = self.place_of(scalar);
        (place, class, self.rows[scalar.row].command.direction)
    }

    /// Another reading of the same place, reached the same way or in the same run.
    fn has_returns(&self, index: usize) -> bool {
        let scalar = &self.scalars[index];
        self.places[&self.place_of(scalar)].1 > 1.0 || self.returns[&self.return_of(scalar)].1 > 1.0
    }

    /// Rows beyond a limit that neither a neighbour nor a repeat confirms, ascending.
    fn lone(&self, lines: &Lines, limit: f64) -> Vec<usize> {
        let mut found: Vec<usize> = Vec::new();
        for line in lines.values() {
            for (place, index) in line.iter().enumerate() {
                let value = self.far[*index];
                if value.abs() <= limit {
                    continue;
                }
                let beside = [place.checked_sub(1), Some(place + 1)];
                let alone = beside
                    .iter()
                    .flatten()
                    .filter_map(|p| line.get(*p))
                    .all(|other| self.far[*other] * value.signum() < ACCOMPLICE);
                // Repeats that say the same make it structure, too.
                let says = |(sum, count): (f64, f64)| {
                    count > 1.0 && (sum - value) / (count - 1.0) * value.signum() >= ACCOMPLICE
                };
                let scalar = &self.scalars[*index];
                let returning = self.return_of(scalar);
                let confirmed = says(self.places[&self.place_of(scalar)])
                    || [returning, reached_any_way(returning)].iter().any(|way| says(self.returns[way]));
                if alone && !confirmed {
                    found.push(scalar.row);
                }
            }
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// True where the variance of residuals is no measure of their scatter: most are alike, others far off.
pub(crate) fn is_lumpy(scalars: &[Scalar], residuals_um: &[f64]) -> bool {
    /// Standard deviation over that by the median: 1 for normal noise, 1.5 for tails as heavy as Student's with three degrees.
    const LUMPY: f64 = 2.5;
    let mut sizes: Vec<f64> =
        scalars.iter().zip(residuals_um).map(|(s, r)| (r * s.weight.sqrt()).abs()).collect();
    let square: f64 = sizes.iter().map(|v| v * v).sum();
    let deviation = (square / sizes.len().max(1) as f64).sqrt();
    median(&mut sizes).is_some_and(|mad| deviation > LUMPY * 1.4826 * mad)
}

/// Ratio of the variance that further rows will have to the variance of the rows kept.
///
/// Rows beyond the outlier limit were left out. Where they are the far end of a heavy tail they will come
/// again; where they are single blunders they will not. A tail shows itself inside the limit: between 3 and 4.5
/// robust standard deviations normal noise has one reading in four hundred.
pub(crate) fn tail_factor(scalars: &[Scalar], kept: &[f64], dropped: &[f64]) -> f64 {
    const TAIL: f64 = 0.008;
    let weighted: Vec<f64> = scalars.iter().zip(kept).map(|(s, r)| r * s.weight.sqrt()).collect();
    let mut sizes: Vec<f64> = weighted.iter().map(|v| v.abs()).collect();
    let Some(mad) = median(&mut sizes) else { return 1.0 };
    let far = sizes.iter().filter(|v| **v > 3.0 * 1.4826 * mad).count() as f64;
    let square: f64 = sizes.iter().map(|v| v * v).sum();
    if far < TAIL * sizes.len() as f64 || square <= 0.0 {
        return 1.0;
    }
    let all: f64 = square + dropped.iter().map(|v| v * v).sum::<f64>();
    (all / (sizes.len() + dropped.len()) as f64) / (square / sizes.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians() {
        assert_eq!(median(&mut []), None);
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), Some(2.5));
    }
}
