//! A formula for what no effect explains: which columns a component depends on, and how, tried on runs kept back.
//!
//! Every column alone and every pair is given a basis (directions as they are, all else Legendre polynomials to order 3, a
//! pair their products), beside what a set-up, a scale and a squareness do. Runs are freed of their means. Four times a
//! quarter of the runs is kept back; what the basis explains there of what the base leaves decides, and a second column must
//! earn its place. A formula is a description, no cause: nothing is named by it and nothing corrected.

use diagnostic::Text;
use machine_model::effects::legendre;
use nalgebra::{DMatrix, DVector};

use crate::equations::observation::{Measurements, Row, Scalar};

/// What one component depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    /// `dx ~ dir_x·(y - 140)`.
    pub text: String,
    /// The same as a sentence.
    pub words: Text,
    /// Share of the component's variance (set-up, scale and squareness taken out) explained on runs that were not fitted.
    pub share: f64,
}

/// Readings of a component that a formula may have at least.
const ENOUGH: usize = 60;
/// More readings are thinned evenly.
const MOST: usize = 1500;
/// A formula must explain this share of a component on runs kept back, and a simpler one may explain so much less of it.
const LEAST: f64 = 0.15;
const SIMPLER: f64 = 0.05;
/// Formulas told.
const TOLD: usize = 3;
/// Parts that the runs are divided into, each kept back once.
const FOLDS: usize = 4;

/// A column of the file, one number per row on -1..=1.
struct Column {
    name: &'static str,
    /// Its middle and half width in its own unit.
    middle: f64,
    half: f64,
    direction: bool,
    /// Highest polynomial that its different values carry.
    order: usize,
    values: Vec<f64>,
}

type Value = fn(&Row) -> Option<f64>;

const COLUMNS: [(&str, Value); 11] = [
    ("x", |r| Some(r.command.linear_mm.x)),
    ("y", |r| Some(r.command.linear_mm.y)),
    ("z", |r| Some(r.command.linear_mm.z)),
    ("dir_x", |r| Some(f64::from(r.command.direction[0]))),
    ("dir_y", |r| Some(f64::from(r.command.direction[1]))),
    ("dir_z", |r| Some(f64::from(r.command.direction[2]))),
    ("load_kg", |r| r.conditions.load_kg),
    ("temp_c", |r| r.conditions.temp_c[0]),
    ("time_s", |r| r.conditions.time_s),
    ("feed_mm_min", |r| r.conditions.feed_mm_min),
    ("tool_z_mm", |r| Some(r.command.tool_mm.z)),
];

fn columns(data: &Measurements) -> Vec<Column> {
    let known = |value: Value| -> Option<Vec<f64>> { data.rows.iter().map(value).collect() };
    COLUMNS
        .into_iter()
        .filter_map(|(name, value)| {
            let mut values = known(value)?;
            let mut sorted = values.clone();
            sorted.sort_by(f64::total_cmp);
            sorted.dedup();
            let (low, high) = (*sorted.first()?, *sorted.last()?);
            if high <= low {
                return None;
            }
            let direction = name.starts_with("dir");
            let (middle, half) =
                if direction { (0.0, 1.0) } else { (0.5 * (low + high), 0.5 * (high - low)) };
            values.iter_mut().for_each(|v| *v = (*v - middle) / half);
            let order = if direction { 1 } else { (sorted.len() - 1).min(3) };
            Some(Column { name, middle, half, direction, order, values })
        })
        .collect()
}

/// Formulas for what is left of a gap, the best first; none where the file holds too little for one.
pub(crate) fn formulas(data: &Measurements, scalars: &[Scalar]) -> Vec<Formula> {
    if data.has_magnitudes() || data.runs.len() < 2 * FOLDS {
        return Vec::new();
    }
    let columns = columns(data);
    let mut found: Vec<Formula> = Vec::new();
    for class in 0..3 {
        let own: Vec<&Scalar> = scalars.iter().filter(|s| s.class == class).collect();
        if own.len() < ENOUGH {
            continue;
        }
        let thin: Vec<&Scalar> = own.iter().step_by(own.len().div_ceil(MOST)).copied().collect();
        found.extend(of_component(data, &columns, class, &thin));
    }
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    found.truncate(TOLD);
    found
}

/// The formulas of one component.
fn of_component(data: &Measurements, columns: &[Column], class: usize, scalars: &[&Scalar]) -> Vec<Formula> {
    let runs: Vec<usize> = scalars.iter().map(|s| data.rows[s.row].run).collect();
    let centred = |mut values: Vec<f64>| {
        let mut sums = vec![(0.0, 0.0); data.runs.len()];
        for (run, v) in runs.iter().zip(&values) {
            sums[*run] = (sums[*run].0 + v, sums[*run].1 + 1.0);
        }
        values.iter_mut().zip(&runs).for_each(|(v, run)| *v -= sums[*run].0 / sums[*run].1);
        values
    };
    let gap = centred(scalars.iter().map(|s| s.gap_um).collect());
    let at = |column: &Column| -> Vec<f64> { scalars.iter().map(|s| column.values[s.row]).collect() };
    let straight = |c: &&Column| ["x", "y", "z", "tool_z_mm"].contains(&c.name);
    let base: Vec<Vec<f64>> = columns.iter().filter(straight).map(|c| centred(at(c))).collect();
    let judge = Judge { gap: &gap, runs: &runs, base: &base };
    let nothing = judge.unseen(&[]);
    if nothing <= 0.0 {
        return Vec::new();
    }
    let basis = |set: &[usize]| -> Vec<Vec<f64>> {
        products(columns, set)
            .iter()
            .map(|orders| {
                let value = |s: &&Scalar| -> f64 {
                    set.iter().zip(orders).map(|(c, k)| legendre(*k, columns[*c].values[s.row])).product()
                };
                centred(scalars.iter().map(value).collect())
            })
            .collect()
    };
    let share = |set: &[usize]| 1.0 - judge.unseen(&basis(set)) / nothing;
    let alone: Vec<f64> = (0..columns.len()).map(|c| share(&[c])).collect();
    let mut sets: Vec<(Vec<usize>, f64)> =
        alone.iter().enumerate().map(|(c, share)| (vec![c], *share)).collect();
    for a in 0..columns.len() {
        for b in a + 1..columns.len() {
            let together = share(&[a, b]);
            // A second column must earn its place.
            if together > alone[a].max(alone[b]).max(0.0) + SIMPLER {
                sets.push((vec![a, b], together));
            }
        }
    }
    sets.retain(|(_, share)| *share >= LEAST);
    sets.sort_by(|a, b| b.1.total_cmp(&a.1));
    // A set that holds a better one as a part, or is a worse part of a better one, says nothing more.
    let mut told: Vec<(Vec<usize>, f64)> = Vec::new();
    for (set, share) in sets {
        let within = |a: &[usize], b: &[usize]| a.iter().all(|c| b.contains(c));
        let simpler = alone_best(&set, &alone) > share - SIMPLER && set.len() > 1;
        if !simpler && told.iter().all(|(better, _)| !within(&set, better)) {
            told.push((set, share));
        }
    }
    told.truncate(TOLD);
    told.into_iter()
        .map(|(set, share)| {
            let text = written(columns, &set, class, &judge, &basis);
            let names: Vec<&str> = set.iter().map(|c| columns[*c].name).collect();
            let (component, share_percent) = (["x", "y", "z"][class], 100.0 * share);
            let [names, russian_names] = [" and ", " и "].map(|and| names.join(and));
            let words = Text::new(
                format!(
                    "d{component} depends on {names}: {share_percent:.0} % of it is explained so on runs that were not fitted; no effect of the library does that"
                ),
                format!(
                    "d{component} зависит от {russian_names}: так объясняется {share_percent:.0} % на сериях, которых не было в подгонке; ни один эффект библиотеки этого не делает"
                ),
            );
            Formula { text, words, share }
        })
        .collect()
}

fn alone_best(set: &[usize], alone: &[f64]) -> f64 {
    set.iter().map(|c| alone[*c]).fold(0.0, f64::max)
}

/// Orders of the polynomials of some columns whose product is a basis function; not all zero.
fn products(columns: &[Column], set: &[usize]) -> Vec<Vec<usize>> {
    let mut all: Vec<Vec<usize>> = vec![Vec::new()];
    for c in set {
        all = all
            .iter()
            .flat_map(|orders| {
                (0..=columns[*c].order).map(|k| orders.iter().copied().chain([k]).collect::<Vec<usize>>())
            })
            .collect();
    }
    all.retain(|orders| orders.iter().any(|k| *k > 0));
    all
}

/// One component, freed of the means of its runs, and what is fitted in any case.
struct Judge<'a> {
    gap: &'a [f64],
    runs: &'a [usize],
    base: &'a [Vec<f64>],
}

impl Judge<'_> {
    /// Square that some columns beside the base leave on runs kept back.
    fn unseen(&self, columns: &[Vec<f64>]) -> f64 {
        let all: Vec<&Vec<f64>> = self.base.iter().chain(columns).collect();
        let size = all.len();
        let mut parts = vec![(DMatrix::zeros(size, size), DVector::zeros(size)); FOLDS];
        let mut row = vec![0.0; size];
        for (i, (gap, run)) in self.gap.iter().zip(self.runs).enumerate() {
            row.iter_mut().zip(&all).for_each(|(to, column)| *to = column[i]);
            let (products, right) = &mut parts[run % FOLDS];
            for a in 0..size {
                right[a] += row[a] * gap;
                for b in 0..=a {
                    products[(a, b)] += row[a] * row[b];
                }
            }
        }
        let mut left = 0.0;
        for fold in 0..FOLDS {
            let others = || parts.iter().enumerate().filter(|(k, _)| *k != fold).map(|(_, p)| p);
            let products: DMatrix<f64> = others().map(|p| &p.0).sum();
            let right: DVector<f64> = others().map(|p| &p.1).sum();
            let Some(values) = solved(products, &right) else { return f64::INFINITY };
            for (i, gap) in self.gap.iter().enumerate().filter(|(i, _)| self.runs[*i] % FOLDS == fold) {
                let fitted: f64 = all.iter().zip(values.iter()).map(|(column, v)| column[i] * v).sum();
                left += (gap - fitted) * (gap - fitted);
            }
        }
        left
    }

    /// Coefficients of some columns beside the base, all runs.
    fn fitted(&self, columns: &[Vec<f64>]) -> Vec<f64> {
        let all: Vec<&Vec<f64>> = self.base.iter().chain(columns).collect();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let products = DMatrix::from_fn(all.len(), all.len(), |i, j| dot(all[i], all[j]));
        let right = DVector::from_fn(all.len(), |i, _| dot(all[i], self.gap));
        solved(products, &right)
            .map_or_else(|| vec![0.0; columns.len()], |v| v.iter().skip(self.base.len()).copied().collect())
    }
}

/// Solution of normal equations whose lower triangle is given; a trace of a ridge makes columns that repeat others harmless.
fn solved(mut products: DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    const RIDGE: f64 = 1e-6;
    let mean = products.trace() / products.nrows().max(1) as f64;
    for i in 0..products.nrows() {
        products[(i, i)] += RIDGE * mean + f64::MIN_POSITIVE;
    }
    products.cholesky().map(|c| c.solve(right))
}

/// The formula as text: a direction times a line, a product of two distances, or the few products that matter.
fn written(
    columns: &[Column],
    set: &[usize],
    class: usize,
    judge: &Judge<'_>,
    basis: &dyn Fn(&[usize]) -> Vec<Vec<f64>>,
) -> String {
    let orders = products(columns, set);
    let values = judge.fitted(&basis(set));
    let value = |wanted: &[usize]| orders.iter().position(|o| o == wanted).map_or(0.0, |i| values[i]);
    let largest = values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    let component = ["dx", "dy", "dz"][class];
    if let [a, b] = *set {
        let (first, second) = (&columns[a], &columns[b]);
        let cross = value(&[1, 1]);
        let bent = orders.iter().zip(&values).filter(|(o, _)| o[0] > 1 || o[1] > 1);
        let bends = bent.fold(0.0, |m: f64, (_, v)| m.max(v.abs()));
        if cross.abs() > 2.0 * bends && cross.abs() > 0.3 * largest {
            // (first - p)·(second - q), each less its own zero.
            let zero = |column: &Column, slope: f64| column.middle - column.half * slope / cross;
            let factor = |column: &Column, slope: f64| {
                if column.direction {
                    column.name.to_owned()
                } else {
                    let at = zero(column, slope);
                    let sign = if at < 0.0 { '+' } else { '-' };
                    format!("({} {sign} {:.0})", column.name, at.abs())
                }
            };
            let size = cross / (first.half * second.half);
            return format!(
                "{component} ~ {} · {} · {}",
                short(size),
                // What the one does alone is what the other's zero makes of the product.
                factor(first, value(&[0, 1])),
                factor(second, value(&[1, 0]))
            );
        }
    }
    let mut terms: Vec<(f64, &Vec<usize>)> = values.iter().copied().zip(&orders).collect();
    terms.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    terms.retain(|(v, _)| v.abs() > 0.15 * largest);
    terms.truncate(4);
    let named = |orders: &[usize]| -> String {
        let one = |(c, k): (&usize, &usize)| match (columns[*c].direction, *k) {
            (_, 0) => None,
            (true, _) => Some(columns[*c].name.to_owned()),
            (false, k) => Some(format!("P{k}({})", columns[*c].name)),
        };
        set.iter().zip(orders).filter_map(one).collect::<Vec<_>>().join(" · ")
    };
    let sum: Vec<String> = terms.iter().map(|(v, o)| format!("{} · {}", short(*v), named(o))).collect();
    format!("{component} ~ {}", sum.join(" + "))
}

fn short(value: f64) -> String {
    format!("{value:.3e}").parse::<f64>().map_or_else(|_| value.to_string(), |v| v.to_string())
}
