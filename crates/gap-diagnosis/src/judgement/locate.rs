//! Where the gap lies: component, axis segment, direction, voxel, run, time, feed, tool, load.

use std::collections::BTreeMap;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use crate::equations::observation::{Measurements, Row, Scalar};
use crate::judgement::answer::Cell;

/// Random relabellings behind a p value: the smallest is 1 / (this + 1).
const RELABELLINGS: usize = 199;
/// Segments of an axis, and of the time.
const SEGMENTS: usize = 4;
/// Classes of a quantity with few values (feeds, tools, loads).
const MOST_CLASSES: usize = 8;

/// The family of components: neighbouring equations are different ones, so that shifted labels would be the same ones.
const COMPONENT: &str = "component";

/// One way to sort the equations into cells.
struct Family {
    by: String,
    names: Vec<String>,
    /// Cell of every equation.
    label: Vec<usize>,
}

/// Cells that hold more of the gap than their number of equations explains, by family, the worst first;
/// always at least the worst cell of each family.
pub(crate) fn places(
    data: &Measurements,
    scalars: &[Scalar],
    gap_um: &[f64],
    noise_variance: f64,
    seed: u64,
) -> Vec<Cell> {
    let total: f64 = gap_um.iter().map(|g| g * g).sum();
    // What noise alone puts into a cell is no part of the gap.
    let beyond = (total - noise_variance * gap_um.len() as f64).max(0.0);
    if total <= 0.0 {
        return Vec::new();
    }
    let squares: Vec<f64> = gap_um.iter().map(|g| g * g).collect();
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let found: Vec<Scored> = families(data, scalars)
        .into_iter()
        .map(|family| Scored::new(family, data, scalars, &squares, &mut random))
        .collect();
    // The largest of all cells of all families in each relabelling corrects for how many were looked at.
    let largest: Vec<f64> = (0..RELABELLINGS)
        .map(|k| found.iter().map(|f| f.relabelled[k]).fold(f64::NEG_INFINITY, f64::max))
        .collect();
    let share = |sum: f64, count: f64| {
        let own = (sum - noise_variance * count).max(0.0);
        if beyond > 0.0 { (own / beyond).min(1.0) } else { sum / total }
    };
    let mut cells = Vec::new();
    for Scored { family, counts, observed, own, .. } in found {
        let mut found: Vec<Cell> = family
            .names
            .iter()
            .enumerate()
            .filter(|(i, _)| counts[*i] > 0.0)
            .map(|(i, name)| {
                // Labels shifted by a whole period are the same labels, whatever the last digit of their sum.
                let beyond = largest.iter().filter(|l| **l >= own[i] - 1e-9 * own[i].abs()).count();
                let p = (beyond + 1) as f64 / (RELABELLINGS + 1) as f64;
                Cell { by: family.by.clone(), cell: name.clone(), share: share(observed[i], counts[i]), p }
            })
            .collect();
        found.sort_by(|a, b| b.share.total_cmp(&a.share));
        let keep = if family.by == "voxel" { found.len().div_ceil(5) } else { 4 };
        found.truncate(keep.max(1));
        cells.extend(found);
    }
    cells
}

/// A family with what its cells hold and what relabelled ones would, on one scale for all families: standard deviations of
/// the largest cell of a relabelling about its mean.
struct Scored {
    family: Family,
    counts: Vec<f64>,
    observed: Vec<f64>,
    /// Excess of every cell.
    own: Vec<f64>,
    /// Largest excess of every relabelling.
    relabelled: Vec<f64>,
}

impl Scored {
    fn new(
        family: Family,
        data: &Measurements,
        scalars: &[Scalar],
        squares: &[f64],
        random: &mut ChaCha8Rng,
    ) -> Self {
        let counts = sums(&family, &vec![1.0; scalars.len()], 0);
        let observed = sums(&family, squares, 0);
        let mean = squares.iter().sum::<f64>() / scalars.len() as f64;
        // Excess over an even spread, on the scale of its own scatter.
        let excess = |sum: f64, count: f64| {
            if count > 0.0 { (sum - mean * count) / count.sqrt() } else { f64::NEG_INFINITY }
        };
        let score =
            |sums: &[f64]| -> Vec<f64> { sums.iter().zip(&counts).map(|(s, c)| excess(*s, *c)).collect() };
        // Either relabelling keeps how rows hang together.
        let by_run = (family.by == COMPONENT).then(|| components_by_run(data, scalars, squares));
        let largest: Vec<f64> = (0..RELABELLINGS)
            .map(|_| {
                let sums = match &by_run {
                    // The components of a whole run change names.
                    Some(runs) => renamed(runs, &counts, random),
                    // The labels are shifted along the file.
                    None => sums(&family, squares, random.random_range(1..scalars.len().max(2))),
                };
                score(&sums).into_iter().fold(f64::NEG_INFINITY, f64::max)
            })
            .collect();
        let middle = largest.iter().sum::<f64>() / RELABELLINGS as f64;
        let spread = largest.iter().map(|l| (l - middle) * (l - middle)).sum::<f64>() / RELABELLINGS as f64;
        let scale = |value: f64| (value - middle) / spread.sqrt().max(1e-12 * mean.max(1e-12));
        let own = score(&observed).into_iter().map(scale).collect();
        let relabelled = largest.into_iter().map(scale).collect();
        Self { family, counts, observed, own, relabelled }
    }
}

/// Squares of every run by component.
fn components_by_run(data: &Measurements, scalars: &[Scalar], squares: &[f64]) -> Vec<[f64; 4]> {
    let mut runs = vec![[0.0; 4]; data.runs.len()];
    for (scalar, square) in scalars.iter().zip(squares) {
        runs[data.rows[scalar.row].run][scalar.class] += square;
    }
    runs
}

/// Sums over all runs, the components that were measured renamed in each.
fn renamed(runs: &[[f64; 4]], counts: &[f64], random: &mut ChaCha8Rng) -> Vec<f64> {
    let measured: Vec<usize> = (0..3).filter(|c| counts[*c] > 0.0).collect();
    let mut sums = vec![0.0; counts.len()];
    for run in runs {
        let mut names = measured.clone();
        for left in (1..names.len()).rev() {
            names.swap(left, random.random_range(0..=left));
        }
        measured.iter().zip(names).for_each(|(from, to)| sums[to] += run[*from]);
        sums[3] += run[3];
    }
    sums
}

fn sums(family: &Family, values: &[f64], shift: usize) -> Vec<f64> {
    let mut sums = vec![0.0; family.names.len()];
    let (late, early) = values.split_at(values.len() - shift.min(values.len()));
    for (value, label) in early.iter().chain(late).zip(&family.label) {
        sums[*label] += value;
    }
    sums
}

fn families(data: &Measurements, scalars: &[Scalar]) -> Vec<Family> {
    let row = |s: &Scalar| &data.rows[s.row];
    let mut all = Vec::new();
    if scalars.iter().any(|s| s.class < 3) {
        let names = ["dx", "dy", "dz", "along the bar"].map(str::to_owned).to_vec();
        all.push(Family {
            by: COMPONENT.to_owned(),
            names,
            label: scalars.iter().map(|s| s.class).collect(),
        });
    }
    for (axis, name) in ["X", "Y", "Z"].into_iter().enumerate() {
        let (low, high) = data.range_mm(axis);
        if high > low {
            let names = segments(low, high, SEGMENTS, "");
            let label = scalars
                .iter()
                .map(|s| segment(row(s).command.linear_mm[axis], low, high, SEGMENTS))
                .collect();
            all.push(Family { by: name.to_owned(), names, label });
        }
    }
    all.extend(voxels(data, scalars));
    let text = |by: &str, name: &dyn Fn(&Row) -> Option<String>| by_name(by, scalars, data, name);
    all.extend(text("direction", &|r| {
        let signs: String = ["X", "Y", "Z"]
            .into_iter()
            .zip(r.command.direction)
            .filter(|(_, d)| *d != 0)
            .map(|(axis, d)| format!("{axis}{}", if d > 0 { '+' } else { '-' }))
            .collect();
        Some(if signs.is_empty() { "unknown".to_owned() } else { signs })
    }));
    all.extend(text("run", &|r| Some(data.runs[r.run].clone())));
    all.extend(text("feed", &|r| r.conditions.feed_mm_min.map(|f| format!("{f} mm/min"))));
    all.extend(text("load", &|r| r.conditions.load_kg.map(|l| format!("{l} kg"))));
    all.extend(text("tool", &|r| {
        let t = r.command.tool_mm;
        Some(format!("{},{},{} mm", t.x, t.y, t.z))
    }));
    let times = || data.rows.iter().filter_map(|r| r.conditions.time_s);
    let (start, end) = times().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), t| (a.min(t), b.max(t)));
    if end > start && data.rows.iter().all(|r| r.conditions.time_s.is_some()) {
        let names = segments(start, end, SEGMENTS, " s");
        let time = |s: &Scalar| row(s).conditions.time_s.unwrap_or(start);
        let label = scalars.iter().map(|s| segment(time(s), start, end, SEGMENTS)).collect();
        all.push(Family { by: "time".to_owned(), names, label });
    }
    all
}

/// Three cells per axis that is travelled.
fn voxels(data: &Measurements, scalars: &[Scalar]) -> Option<Family> {
    const PER_AXIS: usize = 3;
    let travelled: Vec<usize> = (0..3).filter(|a| data.range_mm(*a).1 > data.range_mm(*a).0).collect();
    if travelled.len() < 2 {
        return None;
    }
    let mut names = vec![String::new()];
    for axis in &travelled {
        let (low, high) = data.range_mm(*axis);
        let own = segments(low, high, PER_AXIS, "");
        names = names
            .iter()
            .flat_map(|before| {
                own.iter().map(move |s| {
                    let join = if before.is_empty() { "" } else { ", " };
                    format!("{before}{join}{} {s}", ["X", "Y", "Z"][*axis])
                })
            })
            .collect();
    }
    let ranges = [0, 1, 2].map(|a| data.range_mm(a));
    let label = scalars
        .iter()
        .map(|s| {
            travelled.iter().fold(0, |index, axis| {
                let (low, high) = ranges[*axis];
                index * PER_AXIS + segment(data.rows[s.row].command.linear_mm[*axis], low, high, PER_AXIS)
            })
        })
        .collect();
    Some(Family { by: "voxel".to_owned(), names, label })
}

fn segment(value: f64, low: f64, high: f64, count: usize) -> usize {
    (((value - low) / (high - low) * count as f64).floor().max(0.0) as usize).min(count - 1)
}

fn segments(low: f64, high: f64, count: usize, unit: &str) -> Vec<String> {
    let at = |k: usize| (10.0 * (low + (high - low) * k as f64 / count as f64)).round() / 10.0;
    (0..count).map(|k| format!("{}..{}{unit}", at(k), at(k + 1))).collect()
}

/// Families of named classes; `None` where there is one class or too many.
fn by_name(
    by: &str,
    scalars: &[Scalar],
    data: &Measurements,
    name: &dyn Fn(&Row) -> Option<String>,
) -> Option<Family> {
    let of_row: Vec<Option<String>> = data.rows.iter().map(name).collect();
    let mut index: BTreeMap<&str, usize> = BTreeMap::new();
    for class in of_row.iter().flatten() {
        index.entry(class).or_default();
    }
    let most = if by == "run" { 400 } else { MOST_CLASSES.max(27) };
    if index.len() < 2 || index.len() > most || of_row.iter().any(Option::is_none) {
        return None;
    }
    for (place, slot) in index.values_mut().enumerate() {
        *slot = place;
    }
    let names = index.keys().map(|k| (*k).to_owned()).collect();
    let label =
        scalars.iter().filter_map(|s| of_row[s.row].as_deref().and_then(|n| index.get(n).copied())).collect();
    Some(Family { by: by.to_owned(), names, label })
}
