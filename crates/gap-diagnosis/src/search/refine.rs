//! Non-linear numbers of a shape, refined on the fit (variable projection).
//!
//! A column with such numbers is `along[d]·f(v)`: one direction, and a function of one number of the row, its position
//! on an axis or its time. Sums over the rows of a run that share that number are all that a fit needs, so that one
//! more guess costs as much as there are different numbers, not rows.

use machine_model::Vector;
use machine_model::effects::{EffectKind, Shape};
use nalgebra::{DMatrix, Matrix3, Matrix3xX};

use crate::effects::{self, Searched};
use crate::equations::columns::Source;
use crate::equations::gram::dot;
use crate::equations::linear::explained;
use crate::equations::observation::{Row, Scalar};
use crate::equations::term::Term;
use crate::library::forms::LOCAL_WIDEST;
use crate::search::proposals::thinned;

/// Steps below this share of the first ones are too fine to matter.
const FINE: f64 = 0.02;

/// The evenly thinned equations of a file with the values of the columns in the model.
pub(crate) struct Stage<'a> {
    source: Source<'a>,
    /// Thinned.
    scalars: Vec<Scalar>,
    rho: f64,
    /// Columns of the model, weighted values.
    columns: Vec<(usize, Vec<f64>)>,
    /// Products of these columns, the gap last.
    products: DMatrix<f64>,
    /// Per run: Σ w·along·alongᵀ, and Σ w·along·(column), the gap last.
    runs: Vec<(Matrix3<f64>, Matrix3xX<f64>)>,
}

/// Rows of one run with the same number.
struct Group {
    run: usize,
    /// Any of them.
    row: usize,
    /// Σ w·along·alongᵀ.
    information: Matrix3<f64>,
    /// Σ w·along·(other column), the gap last: three numbers per column.
    others: Vec<f64>,
}

/// What a part is fitted beside.
struct Rest {
    groups: Vec<Group>,
    /// Whitened products of the other columns, the gap last.
    products: DMatrix<f64>,
    /// Per run: (I/ρ + U)⁻¹, and it times the products of U with the other columns.
    runs: Vec<(Matrix3<f64>, Matrix3xX<f64>)>,
    squares: Vec<f64>,
}

impl<'a> Stage<'a> {
    /// Evaluates the columns of a model: their places in the library, and what they are.
    pub(crate) fn new(source: &Source<'a>, columns: Vec<(usize, Term)>, rho: f64) -> Self {
        let scalars: Vec<Scalar> = thinned(source.scalars).into_iter().map(|i| source.scalars[i]).collect();
        let all: Vec<usize> = (0..scalars.len()).collect();
        let thin = Source { scalars: &scalars, ..*source };
        let columns: Vec<(usize, Vec<f64>)> =
            columns.into_iter().map(|(place, term)| (place, thin.weighted(&term, &all))).collect();
        let gap: Vec<f64> = scalars.iter().map(|s| s.weight.sqrt() * s.gap_um).collect();
        let values: Vec<&[f64]> = columns.iter().map(|(_, v)| v.as_slice()).chain([gap.as_slice()]).collect();
        let count = values.len();
        let mut products = DMatrix::zeros(count, count);
        for j in 0..count {
            for i in 0..=j {
                products[(i, j)] = dot(values[i], values[j]);
                products[(j, i)] = products[(i, j)];
            }
        }
        let mut runs = vec![(Matrix3::zeros(), Matrix3xX::zeros(count)); source.runs];
        for (i, scalar) in scalars.iter().enumerate() {
            let (information, block) = &mut runs[source.rows[scalar.row].run];
            *information += scalar.along * scalar.along.transpose() * scalar.weight;
            let along = scalar.along * scalar.weight.sqrt();
            for (j, values) in values.iter().enumerate() {
                (0..3).for_each(|c| block[(c, j)] += along[c] * values[i]);
            }
        }
        Self { source: *source, scalars, rho, columns, products, runs }
    }

    /// Everything but the columns `own` of the part whose numbers are `variable` of a row.
    fn rest(&self, own: &[usize], variable: impl Fn(&Row) -> Option<f64>) -> Rest {
        let rows = self.source.rows;
        // The gap comes last.
        let gap = self.columns.len();
        let is_other = |j: &usize| *j == gap || !own.contains(&self.columns[*j].0);
        let kept: Vec<usize> = (0..=gap).filter(is_other).collect();
        let count = kept.len();
        let others: Vec<&Vec<f64>> = kept[..count - 1].iter().map(|j| &self.columns[*j].1).collect();
        let mut order: Vec<(usize, f64, usize)> = self
            .scalars
            .iter()
            .enumerate()
            .filter_map(|(i, s)| variable(&rows[s.row]).map(|v| (rows[s.row].run, v, i)))
            .collect();
        order.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
        let mut groups: Vec<Group> = Vec::new();
        let mut last = None;
        for (run, v, i) in order {
            let scalar = &self.scalars[i];
            if last != Some((run, v)) {
                last = Some((run, v));
                let others = vec![0.0; 3 * count];
                groups.push(Group { run, row: scalar.row, information: Matrix3::zeros(), others });
            }
            if let Some(group) = groups.last_mut() {
                group.information += scalar.along * scalar.along.transpose() * scalar.weight;
                let along = scalar.along * scalar.weight.sqrt();
                let gap = scalar.weight.sqrt() * scalar.gap_um;
                let values = others.iter().map(|v| v[i]).chain([gap]);
                for (to, value) in group.others.chunks_exact_mut(3).zip(values) {
                    (0..3).for_each(|c| to[c] += along[c] * value);
                }
            }
        }
        let mut products = self.products.select_rows(&kept).select_columns(&kept);
        let squares = (0..count).map(|i| products[(i, i)]).collect();
        let mut runs = Vec::new();
        for (information, block) in &self.runs {
            let block = block.select_columns(&kept);
            let inner =
                if self.rho > 0.0 { Matrix3::identity() / self.rho + information } else { Matrix3::zeros() };
            let inverse =
                if self.rho > 0.0 { inner.try_inverse().unwrap_or_else(Matrix3::zeros) } else { inner };
            let solved: Matrix3xX<f64> = inverse * &block;
            products -= block.transpose() * &solved;
            runs.push((inverse, solved));
        }
        Rest { groups, products, runs, squares }
    }

    /// Square that a part with this shape and the rest explain together.
    fn gain(&self, rest: &Rest, kind: EffectKind, shape: &Shape, indices: &[usize]) -> f64 {
        let terms: Vec<Term> =
            indices.iter().map(|i| Term::Effect { kind, index: *i, shape: *shape }).collect();
        let (own, others) = (terms.len(), rest.products.nrows());
        let mut cross = DMatrix::zeros(own, others);
        let mut square = DMatrix::zeros(own, own);
        let mut by_run: Vec<Option<Vec<Vector>>> = vec![None; self.source.runs];
        for group in &rest.groups {
            let row = &self.source.rows[group.row];
            let values: Vec<Vector> =
                terms.iter().map(|t| t.displacement_um(row, self.source.geometry)).collect();
            if values.iter().all(|v| *v == Vector::zeros()) {
                continue;
            }
            let sums = by_run[group.run].get_or_insert_with(|| vec![Vector::zeros(); own]);
            for (i, a) in values.iter().enumerate() {
                let seen = group.information * a;
                sums[i] += seen;
                values.iter().enumerate().for_each(|(j, b)| square[(i, j)] += seen.dot(b));
                for (j, other) in group.others.chunks_exact(3).enumerate() {
                    cross[(i, j)] += a.x * other[0] + a.y * other[1] + a.z * other[2];
                }
            }
        }
        let raw: Vec<f64> = (0..own).map(|i| square[(i, i)]).collect();
        for (sums, (inverse, solved)) in by_run.iter().zip(&rest.runs) {
            let Some(sums) = sums else { continue };
            for (i, a) in sums.iter().enumerate() {
                let seen = inverse * a;
                sums.iter().enumerate().for_each(|(j, b)| square[(i, j)] -= seen.dot(b));
                for j in 0..others {
                    cross[(i, j)] -= a.dot(&solved.column(j));
                }
            }
        }
        // The other columns, the part's own, the gap.
        let last = others - 1;
        let place = |i: usize| {
            if i < last {
                Some(i)
            } else if i == last + own {
                Some(last)
            } else {
                None
            }
        };
        let all = DMatrix::from_fn(others + own, others + own, |i, j| match (place(i), place(j)) {
            (Some(a), Some(b)) => rest.products[(a, b)],
            (None, Some(b)) => cross[(i - last, b)],
            (Some(a), None) => cross[(j - last, a)],
            (None, None) => square[(i - last, j - last)],
        });
        let squares: Vec<f64> = rest.squares[..last].iter().chain(&raw).copied().collect();
        let columns: Vec<usize> = (0..last + own).collect();
        explained(&all, &columns, &squares).0
    }

    /// Shape of one effect that, beside the other columns, explains most; `None` where it has no free number.
    ///
    /// `own`: its columns in the model; `indices`: their coefficients.
    pub(crate) fn refined(
        &self,
        own: &[usize],
        kind: EffectKind,
        shape: &Shape,
        indices: &[usize],
        narrowest_mm: f64,
    ) -> Option<Shape> {
        let searched = effects::of(kind).search.searched;
        if searched == Searched::Nothing {
            return None;
        }
        let axis = kind.axis().unwrap_or_default();
        let variable = |row: &Row| match searched {
            Searched::Nothing => None,
            Searched::TimeConstants | Searched::Moment => row.conditions.time_s,
            // Both ways round, beyond anything it fades over where it is not known.
            Searched::Way => {
                let way = row.conditions.since_turn_mm[axis].unwrap_or(1e9);
                Some((1.0 + way) * f64::from(row.command.direction[axis]))
            }
            Searched::Period | Searched::Centre | Searched::CentreAndWidth => {
                Some(row.command.linear_mm[axis])
            }
        };
        let rest = self.rest(own, variable);
        let gain = |shape: &Shape| self.gain(&rest, kind, shape, indices);
        if searched == Searched::Moment {
            return step_time(&self.source, shape, gain);
        }
        let length_mm = range(&self.source, axis);
        let frees = free_numbers(searched, shape, length_mm, narrowest_mm);
        let mut best = *shape;
        let mut value = gain(&best);
        let mut steps: Vec<f64> = frees.iter().map(|f| f.step).collect();
        for _ in 0..10 {
            if frees.iter().zip(&steps).all(|(free, step)| *step < FINE * free.step) {
                break;
            }
            for (free, step) in frees.iter().zip(&mut steps) {
                let here = (free.get)(&best);
                let tries = [here - *step, here + *step].map(|v| {
                    let mut shape = best;
                    (free.set)(&mut shape, v.clamp(free.low, free.high));
                    (shape, gain(&shape))
                });
                let better = if tries[0].1 > tries[1].1 { tries[0] } else { tries[1] };
                if better.1 > value {
                    (best, value) = better;
                } else {
                    *step *= 0.45;
                }
            }
        }
        Some(best)
    }
}

/// One free number of a shape.
#[derive(Clone, Copy, Debug)]
struct Free {
    get: fn(&Shape) -> f64,
    set: fn(&mut Shape, f64),
    /// Half of the first step.
    step: f64,
    low: f64,
    high: f64,
}

fn free_numbers(searched: Searched, shape: &Shape, length_mm: f64, narrowest_mm: f64) -> Vec<Free> {
    match searched {
        Searched::Period => vec![Free {
            get: |s| s.pitch_mm,
            set: |s, v| s.pitch_mm = v,
            step: 0.15 * shape.pitch_mm * shape.pitch_mm / length_mm.max(shape.pitch_mm),
            low: 0.2,
            high: f64::INFINITY,
        }],
        Searched::TimeConstants => vec![Free {
            get: |s| s.tau_s,
            set: |s, v| (s.tau_s, s.tau2_s) = (v, v * (s.tau2_s / s.tau_s)),
            step: 0.4 * shape.tau_s,
            low: 1.0,
            high: f64::INFINITY,
        }],
        Searched::Centre => vec![Free {
            get: |s| s.centre_mm,
            set: |s, v| s.centre_mm = v,
            step: shape.width_mm,
            low: f64::NEG_INFINITY,
            high: f64::INFINITY,
        }],
        Searched::Way => vec![Free {
            get: |s| s.width_mm,
            set: |s, v| s.width_mm = v,
            step: 0.3 * shape.width_mm,
            low: 0.3,
            high: 30.0,
        }],
        Searched::CentreAndWidth => vec![
            Free {
                get: |s| s.centre_mm,
                set: |s, v| s.centre_mm = v,
                step: 0.25 * shape.width_mm,
                low: f64::NEG_INFINITY,
                high: f64::INFINITY,
            },
            Free {
                get: |s| s.width_mm,
                set: |s, v| s.width_mm = v,
                step: 0.4 * shape.width_mm,
                low: narrowest_mm.min(LOCAL_WIDEST * length_mm),
                // Wider is a bow, not damage at a place.
                high: LOCAL_WIDEST * length_mm,
            },
        ],
        Searched::Nothing | Searched::Moment => Vec::new(),
    }
}

/// A knock happened between two rows: try every gap near the first guess.
fn step_time(source: &Source<'_>, shape: &Shape, gain: impl Fn(&Shape) -> f64) -> Option<Shape> {
    let mut times: Vec<f64> = source.rows.iter().filter_map(|r| r.conditions.time_s).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let place = times.partition_point(|t| *t < shape.time_s);
    let mut best: Option<(f64, f64)> = None;
    let reach = times.len() / 24 + 2;
    let stride = (reach / 24).max(1);
    let mut centre = place;
    for pass_stride in [stride, 1] {
        let span = if pass_stride == stride { reach } else { stride };
        for k in (centre.saturating_sub(span)..=centre + span).step_by(pass_stride) {
            let (Some(before), Some(after)) = (k.checked_sub(1).and_then(|b| times.get(b)), times.get(k))
            else {
                continue;
            };
            let time_s = 0.5 * (before + after);
            let value = gain(&Shape { time_s, ..*shape });
            if best.is_none_or(|(_, v)| value > v) {
                best = Some((time_s, value));
                centre = k;
            }
        }
    }
    best.map(|(time_s, _)| Shape { time_s, ..*shape })
}

fn range(source: &Source<'_>, axis: usize) -> f64 {
    let (low, high) = source.rows.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), r| {
        (l.min(r.command.linear_mm[axis]), h.max(r.command.linear_mm[axis]))
    });
    high - low
}
