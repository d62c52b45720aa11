//! A smooth field through scattered vectors with a stated noise: equations (92) to (94) of `docs/equations.md`.
//!
//! An analysis of variance by splines (Wahba 1990; Wood, Scheipl and Faraway 2013): the field is a sum of products of modes
//! of the three axes, [`super::modes`]. What is straight in all axes is fixed; every other class of products, by the axes
//! in which it is not straight, has a variance of its own, which restricted likelihood finds with the noise as stated
//! ([`super::variances`]). A class that the vectors do not show comes out at nothing: of a machine whose axes have
//! functions and angles, products of three rough functions.
//!
//! Two more classes are swells: fields that know no axes, alike in all directions of the box, as warmth and what bends
//! without joints make them. Without these such a field has to be put together of 27 classes, which takes far more vectors.

use super::dense::Square;
use super::error::{Doubt, FieldError};
use super::modes::{Modes, SWELLS};
use super::places::{ErrorVector, same_place};
use super::spline::TensorSpline;
use super::variances::{Found, Model};
use crate::{Range, Vector};

/// Intervals of an axis, at most: finer than 30 no tracker's survey is.
const MOST_INTERVALS: usize = 30;
/// Modes that are not straight in products of two and of three such functions.
const MODES_OF_PAIRS: usize = 8;
const MODES_OF_TRIPLES: usize = 4;
/// Products of swells whose variance is less than this part of the largest are nothing beside any noise.
const LEAST_VARIANCE: f64 = 1e-7;
/// Vectors from which the variances are found: more would tell them little better.
const MOST_FOR_VARIANCES: usize = 300;
/// Residuals may be so many of their own standard deviations from what the noise says.
const DOUBTFUL: f64 = 4.0;
/// Squared residuals over what the noise says: beyond, the fit has taken noise for the machine …
const TOO_LARGE: f64 = 2.0;
/// … or the noise is of another unit.
const TOO_SMALL: f64 = 0.04;
/// Twice the logarithm of the likelihoods' ratio from which runs have offsets: jagged tables of layers, each a run, reach 18.
const OFFSET: f64 = 30.0;
/// So many of its standard uncertainties an offset has to have to be seen …
const SEEN: f64 = 5.5;
/// … and so many times the noise it may be without being seen before that is said.
const BLIND: f64 = 10.0;
/// Rows of a run from which its offset is asked for.
const ROWS_OF_A_RUN: usize = 3;

/// What a smooth field is, and how sure.
pub(super) struct Smooth {
    pub(super) spline: TensorSpline,
    pub(super) doubt: Option<Doubt>,
    /// Squared residuals over what the noise says.
    pub(super) residuals: f64,
    /// The largest offset between runs that would pass for the machine, mm, where that is far above the noise.
    pub(super) blind_mm: Option<f64>,
}

/// Products of modes that share a variance: which modes of X, Y and Z.
struct Class([Vec<usize>; 3]);

/// All classes but the constant and the three lines.
fn classes(modes: &[Modes; 3]) -> Vec<Class> {
    let mut classes = Vec::new();
    // 0: constant, 1: straight, 2: neither.
    for kinds in (0..27).map(|k| [k / 9, k / 3 % 3, k % 3]) {
        let rough = kinds.iter().filter(|kind| **kind == 2).count();
        let straight = kinds.iter().filter(|kind| **kind == 1).count();
        if rough == 0 && straight < 2 {
            continue;
        }
        let most = [0, MOST_INTERVALS + 1, MODES_OF_PAIRS, MODES_OF_TRIPLES][rough];
        classes.push(Class([0, 1, 2].map(|a| match kinds[a] {
            2 => (2..modes[a].modes().end.min(2 + most)).collect(),
            kind => vec![kind],
        })));
    }
    classes.extend((0..SWELLS).map(|kind| Class(modes.each_ref().map(|m| m.swells(kind).collect()))));
    classes
}

/// Modes of X, Y, Z at a place.
type AtPlace = [Vec<f64>; 3];

impl Class {
    /// `Σ v m(p) m(q)` over the products of the class: a product of sums over the axes.
    fn kernel(&self, modes: &[Modes; 3], p: &AtPlace, q: &AtPlace) -> f64 {
        (0..3)
            .map(|a| self.0[a].iter().map(|&k| modes[a].variance(k) * p[a][k] * q[a][k]).sum::<f64>())
            .product()
    }

    fn products<'c>(&'c self, modes: &'c [Modes; 3]) -> impl Iterator<Item = [usize; 3]> + 'c {
        let [x, y, z] = &self.0;
        let all = z.iter().flat_map(move |&k| y.iter().flat_map(move |&j| x.iter().map(move |&i| [i, j, k])));
        // The smoothest of each axis come first. Bent modes are kept whatever their variance: few, and vectors of one place
        // of an axis have no others.
        let swells = self.0.iter().zip(modes).all(|(own, modes)| own[0] >= modes.modes().end);
        let least = if swells { LEAST_VARIANCE * prior(modes, [x[0], y[0], z[0]]) } else { 0.0 };
        all.filter(move |indices| prior(modes, *indices) >= least)
    }
}

/// The constant and the lines.
const FIXED: [[usize; 3]; 4] = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];

fn product(at: &AtPlace, modes: [usize; 3]) -> f64 {
    at[0][modes[0]] * at[1][modes[1]] * at[2][modes[2]]
}

/// Fits the vectors; `ranges` is their box, which has three dimensions.
pub(super) fn smooth(vectors: &[ErrorVector], ranges: [Range; 3]) -> Result<Smooth, FieldError> {
    let modes = [0, 1, 2].map(|a| {
        let mut places: Vec<f64> = vectors.iter().map(|v| v.place_mm[a]).collect();
        places.sort_by(f64::total_cmp);
        places.dedup_by(|b, a| same_place(*a, *b));
        Modes::new(ranges[a], (places.len() - 1).clamp(1, MOST_INTERVALS))
    });
    let classes = classes(&modes);
    let all: Vec<AtPlace> = vectors.iter().map(|v| [0, 1, 2].map(|a| modes[a].at(v.place_mm[a]))).collect();
    let chosen = chosen(vectors.len());
    let at: Vec<&AtPlace> = chosen.iter().map(|&i| &all[i]).collect();
    let (kernels, scales) = kernels(&modes, &classes, &at);
    let fixed: Vec<Vec<f64>> = FIXED.map(|modes| at.iter().map(|at| product(at, modes)).collect()).into();
    let mut found = Vec::with_capacity(3);
    for c in 0..3 {
        let y: Vec<f64> = chosen.iter().map(|&i| vectors[i].error_mm[c]).collect();
        let noise: Vec<f64> = chosen.iter().map(|&i| vectors[i].uncertainty_mm[c].powi(2)).collect();
        let model = Model { y: &y, fixed: &fixed, kernels: &kernels, noise: &noise };
        found.push((model.likeliest().ok_or(FieldError::NotDetermined)?, noise));
    }
    let blind_mm = offsets(vectors, &chosen, &fixed, &kernels, &found)?;
    let (doubt, residuals) = doubt(&found)?;
    let mut of_modes = Coefficients::zeros(&modes);
    let survey = (chosen.len() < vectors.len()).then(|| Survey::new(vectors, &all, &modes, &classes));
    // The same for all components, where they are as uncertain.
    let alike = vectors.iter().all(|v| v.uncertainty_mm == Vector::repeat(v.uncertainty_mm.x));
    let shared = survey.as_ref().filter(|_| alike).map(|survey| survey.normal(0));
    for (c, (found, _)) in found.iter().enumerate() {
        let variances: Vec<f64> =
            found.variances.iter().zip(&scales).map(|(theta, scale)| theta / scale).collect();
        match &survey {
            None => of_modes.add_dual(c, &modes, &classes, &variances, found, &at),
            Some(survey) => {
                let normal = shared.clone().unwrap_or_else(|| survey.normal(c));
                of_modes.add_primal(c, survey, normal, &priors(&modes, &classes, &variances))?;
            }
        }
    }
    Ok(Smooth { spline: of_modes.into_spline(&modes), doubt, residuals, blind_mm })
}

/// The kernels at the places, with a mean diagonal of 1, and what they were divided by.
fn kernels(modes: &[Modes; 3], classes: &[Class], at: &[&AtPlace]) -> (Vec<Square>, Vec<f64>) {
    let n = at.len();
    classes
        .iter()
        .map(|class| {
            let mut kernel = Square::zeros(n);
            for i in 0..n {
                for j in 0..=i {
                    let value = class.kernel(modes, at[i], at[j]);
                    kernel.values[i * n + j] = value;
                    kernel.values[j * n + i] = value;
                }
            }
            let mean = (0..n).map(|i| kernel.row(i)[i]).sum::<f64>() / n as f64;
            // Nothing where all places are zeros of the class, as of layers between which a spline could bend.
            let scale = if mean > 0.0 { mean } else { 1.0 };
            kernel.values.iter_mut().for_each(|value| *value /= scale);
            (kernel, scale)
        })
        .unzip()
}

/// Vectors from which variances are found: all, or some in an order in which no pattern of a file is left.
fn chosen(count: usize) -> Vec<usize> {
    if count <= MOST_FOR_VARIANCES {
        return (0..count).collect();
    }
    let mut order: Vec<(u64, usize)> = (0..count).map(|i| (scrambled(i as u64), i)).collect();
    order.sort_unstable();
    let mut chosen: Vec<usize> = order[..MOST_FOR_VARIANCES].iter().map(|(_, i)| *i).collect();
    chosen.sort_unstable();
    chosen
}

/// Steele, Lea and Flood 2014.
fn scrambled(number: u64) -> u64 {
    let mut z = number.wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// Looks for runs that lie beside one another: a smooth field with an offset of each run is so much likelier than one
/// without that no machine makes the difference. Else: the largest offset that would pass for the machine, mm, where that
/// is far above the noise.
fn offsets(
    vectors: &[ErrorVector],
    chosen: &[usize],
    fixed: &[Vec<f64>],
    kernels: &[Square],
    found: &[(Found, Vec<f64>)],
) -> Result<Option<f64>, FieldError> {
    let mut runs: Vec<usize> = chosen.iter().map(|&i| vectors[i].run).collect();
    runs.sort_unstable();
    runs.dedup();
    // Runs of a row or two are repeats, and an offset of each would be noise.
    if runs.len() < 2 || runs.len() * ROWS_OF_A_RUN > chosen.len() {
        return Ok(None);
    }
    let marked = |run: usize| chosen.iter().map(|&i| vectors[i].run == run).collect::<Vec<bool>>();
    let mut kernels = kernels.to_vec();
    kernels.push(same_run(vectors, chosen));
    let (mut sure, mut offsets) = (0.0_f64, vec![Vector::zeros(); runs.len()]);
    for (c, (without, noise)) in found.iter().enumerate() {
        let y: Vec<f64> = chosen.iter().map(|&i| vectors[i].error_mm[c]).collect();
        let Some(with) = (Model { y: &y, fixed, kernels: &kernels, noise }).likeliest() else { continue };
        sure = sure.max(2.0 * (with.likelihood - without.likelihood));
        let theta = with.variances.last().copied().unwrap_or_default();
        for (run, offset) in runs.iter().zip(&mut offsets) {
            let own = marked(*run).into_iter().zip(&with.weighted).filter(|(own, _)| *own);
            offset[c] = theta * own.map(|(_, weighted)| weighted).sum::<f64>();
        }
    }
    if sure > OFFSET {
        let all = offsets.iter().sum::<Vector>();
        let beside = |run: usize| offsets[run] - (all - offsets[run]) / (runs.len() - 1) as f64;
        let size = |run: &usize| beside(*run).norm();
        let worst = (0..runs.len()).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(0);
        let vector = vectors.iter().position(|v| v.run == runs[worst]).unwrap_or(0);
        return Err(FieldError::Offset { vector, offset_mm: beside(worst) });
    }
    let mut blind: Option<f64> = None;
    for (found, noise) in found {
        let noise_mm = (noise.iter().sum::<f64>() / noise.len() as f64).sqrt();
        for run in &runs {
            let hidden_mm = SEEN * found.uncertainty_of_offset_mm(&marked(*run));
            if hidden_mm > BLIND * noise_mm {
                blind = Some(blind.unwrap_or(0.0).max(hidden_mm));
            }
        }
    }
    Ok(blind)
}

/// 1 between vectors of one run.
fn same_run(vectors: &[ErrorVector], chosen: &[usize]) -> Square {
    let mut kernel = Square::zeros(chosen.len());
    for (i, a) in chosen.iter().enumerate() {
        for (value, b) in kernel.row_mut(i).iter_mut().zip(chosen) {
            *value = f64::from(u8::from(vectors[*a].run == vectors[*b].run));
        }
    }
    kernel
}

/// Whether the residuals say of the noise what was stated.
fn doubt(found: &[(Found, Vec<f64>)]) -> Result<(Option<Doubt>, f64), FieldError> {
    let mut sums = [0.0; 3];
    for (found, noise) in found {
        for (sum, part) in sums.iter_mut().zip(found.residuals(noise)) {
            *sum += part;
        }
    }
    let [squares, expected, variance] = sums;
    let ratio = squares / expected;
    let stated = found.iter().flat_map(|(_, noise)| noise);
    let count = stated.clone().count() as f64;
    let stated_mm = (stated.sum::<f64>() / count).sqrt();
    let doubt = Doubt { stated_mm, scatter_mm: stated_mm * ratio.sqrt() };
    if !(TOO_SMALL..=TOO_LARGE).contains(&ratio) {
        return Err(FieldError::Noise(doubt));
    }
    Ok((((squares - expected).abs() > DOUBTFUL * variance.sqrt()).then_some(doubt), ratio))
}

/// All vectors, and the products of modes whose coefficients they are to tell.
struct Survey<'s> {
    vectors: &'s [ErrorVector],
    at: &'s [AtPlace],
    unknowns: Vec<[usize; 3]>,
}

impl<'s> Survey<'s> {
    fn new(vectors: &'s [ErrorVector], at: &'s [AtPlace], modes: &[Modes; 3], classes: &[Class]) -> Self {
        let unknowns =
            FIXED.into_iter().chain(classes.iter().flat_map(|class| class.products(modes))).collect();
        Self { vectors, at, unknowns }
    }

    /// Products at a place.
    fn row<'r>(&'r self, at: &'r AtPlace) -> impl Iterator<Item = f64> + 'r {
        self.unknowns.iter().map(|indices| product(at, *indices))
    }

    /// Lower triangle of the normal equations of one component, its uncertainties the weights.
    fn normal(&self, component: usize) -> Square {
        let mut normal = Square::zeros(self.unknowns.len());
        for (vector, at) in self.vectors.iter().zip(self.at) {
            let weight = 1.0 / vector.uncertainty_mm[component].powi(2);
            let row: Vec<f64> = self.row(at).collect();
            for (i, value) in row.iter().enumerate() {
                let by = weight * value;
                for (sum, other) in normal.row_mut(i)[..=i].iter_mut().zip(&row) {
                    *sum += by * other;
                }
            }
        }
        normal
    }

    /// Their right side.
    fn right(&self, component: usize) -> Vec<f64> {
        let mut right = vec![0.0; self.unknowns.len()];
        for (vector, at) in self.vectors.iter().zip(self.at) {
            let by = vector.error_mm[component] / vector.uncertainty_mm[component].powi(2);
            right.iter_mut().zip(self.row(at)).for_each(|(sum, value)| *sum += by * value);
        }
        right
    }
}

/// Prior variances of the unknowns of a [`Survey`].
fn priors(modes: &[Modes; 3], classes: &[Class], variances: &[f64]) -> Vec<Option<f64>> {
    // What is nothing beside the others stays finite.
    let least = 1e-12 * variances.iter().copied().fold(1e-24, f64::max);
    let of_classes = classes.iter().zip(variances).flat_map(|(class, theta)| {
        class.products(modes).map(move |indices| Some((theta * prior(modes, indices)).max(least)))
    });
    [None; FIXED.len()].into_iter().chain(of_classes).collect()
}

/// Coefficients of all products of modes, X fastest.
struct Coefficients {
    counts: [usize; 3],
    values: Vec<Vector>,
}

impl Coefficients {
    fn zeros(modes: &[Modes; 3]) -> Self {
        let counts = modes.each_ref().map(Modes::count);
        Self { counts, values: vec![Vector::zeros(); counts.iter().product()] }
    }

    fn of(&mut self, [i, j, k]: [usize; 3]) -> &mut Vector {
        &mut self.values[i + self.counts[0] * (j + self.counts[1] * k)]
    }

    /// `β`, and `θ v Σ m(p_i) (P y)_i`: the means of all coefficients given the vectors.
    fn add_dual(
        &mut self,
        component: usize,
        modes: &[Modes; 3],
        classes: &[Class],
        variances: &[f64],
        found: &Found,
        at: &[&AtPlace],
    ) {
        for (modes, value) in FIXED.into_iter().zip(&found.fixed) {
            self.of(modes)[component] = *value;
        }
        for (class, theta) in classes.iter().zip(variances) {
            for indices in class.products(modes) {
                let sum: f64 = at.iter().zip(&found.weighted).map(|(at, w)| product(at, indices) * w).sum();
                self.of(indices)[component] = theta * prior(modes, indices) * sum;
            }
        }
    }

    /// The same from the normal equations of all unknowns, for more vectors than variances are found from.
    ///
    /// * `variances` – prior variance of each unknown, mm²; `None`: nothing is known
    fn add_primal(
        &mut self,
        component: usize,
        survey: &Survey<'_>,
        mut normal: Square,
        variances: &[Option<f64>],
    ) -> Result<(), FieldError> {
        for (i, variance) in variances.iter().enumerate() {
            normal.row_mut(i)[i] += variance.map_or(0.0, |variance| 1.0 / variance);
        }
        let factor = normal.into_cholesky().ok_or(FieldError::NotDetermined)?;
        for (indices, value) in survey.unknowns.iter().zip(factor.solve(&survey.right(component))) {
            self.of(*indices)[component] = value;
        }
        Ok(())
    }

    /// The sum of the products of modes as one of products of splines.
    fn into_spline(self, modes: &[Modes; 3]) -> TensorSpline {
        let mut values = self.values;
        let mut counts = self.counts;
        for axis in 0..3 {
            // Of functions of this axis splines: there are fewer, since functions of swells are splines as well.
            let functions = counts[axis];
            counts[axis] = modes[axis].modes().end;
            let stride: usize = counts[..axis].iter().product();
            let mut turned = vec![Vector::zeros(); counts.iter().product()];
            for (at, turned) in turned.iter_mut().enumerate() {
                let own = at / stride % counts[axis];
                let line = at % stride + at / (stride * counts[axis]) * stride * functions;
                for k in 0..functions {
                    *turned += values[line + k * stride] * modes[axis].coefficient(own, k);
                }
            }
            values = turned;
        }
        TensorSpline::new(modes.each_ref().map(Modes::basis), values)
    }
}

/// Variance of a product of modes against that of its class.
fn prior(modes: &[Modes; 3], indices: [usize; 3]) -> f64 {
    (0..3).map(|a| modes[a].variance(indices[a])).product()
}
