//! Rows that hold only the length of a displacement.
//!
//! A length is linear in the displacement only once its direction is known roughly. So every textbook form of every
//! effect, with either sign and the amplitude that fits the lengths best, is tried as a start on a sample of the rows;
//! the best get a set-up and converge (Gauss-Newton). From the best of those the sample is searched, linearised again
//! about what was found, and the one that leaves least wins and is searched once more on all rows.
//!
//! Turning a displacement everywhere by the same angle changes no length. Where the model alone predicts nothing, `scale.Z`
//! therefore shows what `squareness.XZ` shows, and only the set-up, small as it is, tells them apart. Whatever fits the
//! lengths as well is reported with the cause.

use diagnostic::Text;
use machine_model::Vector;
use machine_model::effects::EffectKind;

use crate::equations::columns::Source;
use crate::equations::fit::{Solution, residuals};
use crate::equations::gram::Gram;
use crate::equations::noise;
use crate::equations::observation::{Believed, Measurements, Reading, Scalar};
use crate::equations::serial::Serial;
use crate::equations::set_up::Clamping;
use crate::equations::term::Term;
use crate::library::candidates::Library;
use crate::search::explain::{explain, explain_roughly};
use crate::search::explanation::Explanation;

/// Rows that directions are guessed on.
const SAMPLE: usize = 600;
/// Single effects that converge together with a set-up.
const STARTS: usize = 12;
/// Starts that are searched from.
const FOLLOWED: usize = 3;
/// Linearisations of one model.
const STEPS: usize = 12;
/// Two guesses are equally good within this difference of score.
const CLOSE: f64 = 10.0;

/// Equations of a file and its explanation; the notes say what the lengths leave open.
pub(crate) fn explained(data: &Measurements, without: &[EffectKind]) -> (Explanation, Vec<Text>) {
    if !data.has_magnitudes() {
        return (explain(data, &data.scalars(None), without), Vec::new());
    }
    let noise_um = noise_um(data);
    let (all, sample) = (Lengths { data, noise_um }, data.sample(SAMPLE));
    let sample = Lengths { data: &sample, noise_um };
    let starts = starts(&sample, without);
    let searched = starts.iter().take(FOLLOWED).map(|start| sample.searched(start, without));
    let ends = all.closest(searched.collect(), None);
    let mut displaced = vec![Vector::zeros(); data.rows.len()];
    let mut close: Vec<EffectKind> = Vec::new();
    if let Some(best) = ends.first() {
        // Only the best is searched again, about what was found.
        let again = all.settled(sample.searched(best, without).model);
        displaced = all.displaced(if again.score < best.model.score { &again } else { &best.model });
        close.extend(ends.iter().flat_map(|end| end.kinds.iter().copied()));
        // Lone effects that do as well as the one that the best began with.
        close.extend(all.closest(starts, best.start).iter().filter_map(|double| double.start));
    }
    let mut model = explain(data, &data.scalars(Some(&all.believed(&displaced))), without);
    model.equally_good = close;
    let notes = vec![Text::pair(
        "Only lengths of displacements were measured: where the model alone predicts none, the sign of a cause is open.",
        "Измерены только длины смещений: там, где сама модель смещения не предсказывает, знак причины остаётся открытым.",
    )];
    (model, notes)
}

/// Standard deviation of a length, µm.
fn noise_um(data: &Measurements) -> f64 {
    let scalars = first_equations(data);
    let gaps: Vec<f64> = scalars.iter().map(|s| s.gap_um).collect();
    noise::estimate(&data.rows, &scalars, &gaps, Serial::default()).map_or(0.0, |noise| noise.variance.sqrt())
}

/// A file with lengths and the noise of one component.
struct Lengths<'a> {
    data: &'a Measurements,
    noise_um: f64,
}

/// A model that converged.
struct Model {
    /// Set-up columns first.
    terms: Vec<Term>,
    values: Vec<f64>,
    run_offsets_um: Vec<Vector>,
    /// BIC of the lengths.
    score: f64,
}

impl Model {
    /// Part of the way to another model of the same columns.
    fn towards(mut self, other: &Self, share: f64) -> Self {
        self.values.iter_mut().zip(&other.values).for_each(|(a, b)| *a += share * (b - *a));
        let offsets = self.run_offsets_um.iter_mut().zip(&other.run_offsets_um);
        offsets.for_each(|(a, b)| *a = a.lerp(b, share));
        self
    }
}

impl From<Solution> for Model {
    fn from(solution: Solution) -> Self {
        let Solution { terms, coefficients: values, run_offsets_um, .. } = solution;
        Self { terms, values, run_offsets_um, score: f64::INFINITY }
    }
}

/// A model and where it came from.
struct Guess {
    /// The single effect at its beginning; `None`: a set-up alone.
    start: Option<EffectKind>,
    /// Effects in it.
    kinds: Vec<EffectKind>,
    model: Model,
}

impl Lengths<'_> {
    const fn believed<'b>(&self, displaced_um: &'b [Vector]) -> Believed<'b> {
        Believed { displaced_um, noise_um: self.noise_um }
    }

    /// What a model displaces every row, µm.
    fn displaced(&self, model: &Model) -> Vec<Vector> {
        let one = |row: &crate::equations::observation::Row| {
            let terms = model.terms.iter().zip(&model.values).filter(|(_, v)| **v != 0.0);
            terms
                .map(|(t, v)| t.displacement_um(row, &self.data.geometry) * *v)
                .fold(model.run_offsets_um[row.run], |a, b| a + b)
        };
        self.data.rows.iter().map(one).collect()
    }

    /// Mean square of measured minus expected length.
    fn misfit(&self, displaced: &[Vector]) -> f64 {
        let believed = self.believed(displaced);
        let (mut sum, mut count) = (0.0, 0.0);
        for (row, d) in self.data.rows.iter().zip(displaced) {
            if let Reading::Magnitude(um) = row.reading {
                let left = um - believed.expected_um(&(1e3 * row.predicted_mm + d));
                sum += left * left;
                count += 1.0;
            }
        }
        sum / f64::max(count, 1.0)
    }

    /// A model's numbers fitted to the lengths, linearised and again until nothing is gained (Gauss-Newton, each step
    /// halved until it gains).
    fn settled(&self, mut model: Model) -> Model {
        let mut here = self.displaced(&model);
        let mut misfit = self.misfit(&here);
        let mut rho = 0.04;
        for _ in 0..STEPS {
            let scalars = self.data.scalars(Some(&self.believed(&here)));
            let source = Source::new(self.data, &scalars);
            let gram = Gram::new(model.terms.clone(), &source);
            rho = gram.best_rho(rho);
            let solution = gram.solve(rho, &source);
            let whole = Model {
                terms: model.terms.clone(),
                values: solution.coefficients,
                run_offsets_um: solution.run_offsets_um,
                score: 0.0,
            };
            let there = self.displaced(&whole);
            let before = misfit;
            for share in [1.0, 0.5, 0.25, 0.1] {
                let between: Vec<Vector> = here.iter().zip(&there).map(|(a, b)| a.lerp(b, share)).collect();
                let found = self.misfit(&between);
                if found < misfit {
                    (misfit, here) = (found, between);
                    model = model.towards(&whole, share);
                    break;
                }
            }
            if before - misfit <= 1e-4 * before {
                break;
            }
        }
        let count = self.data.rows.len() as f64;
        // Every column bought must be worth its price in lengths.
        model.score =
            count * units::math::ln(misfit.max(1e-9)) + model.terms.len() as f64 * units::math::ln(count);
        model
    }

    /// Searched once about a guess.
    fn searched(&self, guess: &Guess, without: &[EffectKind]) -> Guess {
        let displaced = self.displaced(&guess.model);
        let scalars = self.data.scalars(Some(&self.believed(&displaced)));
        // Where the direction is a guess, an outlier cannot be known.
        let found = explain_roughly(self.data, &scalars, without);
        let kinds = found.parts.iter().map(|p| found.library.kind(*p));
        let (start, kinds) = (guess.start, kinds.collect());
        Guess { start, kinds, model: self.settled(Model::from(found.solution)) }
    }

    /// Guesses from a sample, settled on these rows: those that come close to the best, or to the one that began with
    /// `own`; the best first.
    fn closest(&self, guesses: Vec<Guess>, own: Option<EffectKind>) -> Vec<Guess> {
        let close = |mut guesses: Vec<Guess>| {
            guesses.sort_by(|a, b| a.model.score.total_cmp(&b.model.score));
            let own = guesses.iter().find(|g| own.is_none() || g.start == own);
            let limit = own.map_or(f64::NEG_INFINITY, |g| g.model.score + CLOSE);
            guesses.retain(|g| g.model.score < limit);
            guesses
        };
        let settle = |g: Guess| Guess { model: self.settled(g.model), ..g };
        let settled: Vec<Guess> = close(guesses).into_iter().map(settle).collect();
        close(settled)
    }
}

/// Single effects beside a set-up, the best first.
fn starts(lengths: &Lengths<'_>, without: &[EffectKind]) -> Vec<Guess> {
    /// One column with an amplitude.
    struct Tried {
        left: f64,
        kind: EffectKind,
        sign: f64,
        /// Columns of its form and what they begin with.
        own: Vec<(usize, f64)>,
    }
    let data = lengths.data;
    let library = Library::new(data, without, Clamping::Shifted);
    let predicted: Vec<Vector> = data.rows.iter().map(|r| 1e3 * r.predicted_mm).collect();
    let measured: Vec<f64> =
        data.rows.iter().map(|r| if let Reading::Magnitude(um) = r.reading { um } else { 0.0 }).collect();
    // Where the model alone predicts nothing, both signs are the same.
    let has_sign = predicted.iter().any(|p| p.norm() > 0.0);
    let signs: &[f64] = if has_sign { &[1.0, -1.0] } else { &[1.0] };
    let mut tried: Vec<Tried> = Vec::new();
    for candidate in &library.candidates {
        for variant in candidate.variants.iter().filter(|v| v.columns.len() <= 2) {
            for column in &variant.columns {
                let term = &library.terms[*column];
                let unit: Vec<Vector> =
                    data.rows.iter().map(|r| term.displacement_um(r, &data.geometry)).collect();
                for sign in signs {
                    let found = amplitude(&measured, &predicted, &unit, *sign);
                    tried.extend(found.map(|(left, value)| {
                        Tried {
                            left,
                            kind: candidate.kind,
                            sign: *sign,
                            own: variant
                                .columns
                                .iter()
                                .map(|c| (*c, if c == column { value } else { 0.0 }))
                                .collect(),
                        }
                    }));
                }
            }
        }
    }
    tried.sort_by(|a, b| a.left.total_cmp(&b.left));
    let mut first: Vec<Tried> = Vec::new();
    for one in tried {
        if first.len() < STARTS && first.iter().all(|f| (f.kind, f.sign) != (one.kind, one.sign)) {
            first.push(one);
        }
    }
    // Nothing is set up exactly, and what points exactly along one direction has no slope across it. Up to the sign of
    // all, there are four ways to be off; the shifts are the first columns.
    let off = [[1.0, 1.0, 1.0], [1.0, 1.0, -1.0], [1.0, -1.0, 1.0], [-1.0, 1.0, 1.0]];
    let settled = |own: &[(usize, f64)]| {
        let columns = (0..library.nuisances).chain(own.iter().map(|(c, _)| *c));
        let terms: Vec<Term> = columns.map(|c| library.terms[c]).collect();
        let from = |signs: &[f64; 3]| {
            let mut values: Vec<f64> = signs.iter().map(|sign| sign * lengths.noise_um).collect();
            values.resize(library.nuisances, 0.0);
            values.extend(own.iter().map(|(_, value)| value));
            let run_offsets_um = vec![Vector::zeros(); data.runs.len()];
            lengths.settled(Model { terms: terms.clone(), values, run_offsets_um, score: f64::INFINITY })
        };
        off.iter().map(from).min_by(|a, b| a.score.total_cmp(&b.score))
    };
    // Perhaps nothing is wrong but the set-up.
    let alone = settled(&[]);
    let mut starts: Vec<Guess> =
        alone.into_iter().map(|model| Guess { start: None, kinds: Vec::new(), model }).collect();
    for one in first {
        let model = settled(&one.own);
        starts.extend(model.map(|model| Guess { start: Some(one.kind), kinds: vec![one.kind], model }));
    }
    starts.sort_by(|a, b| a.model.score.total_cmp(&b.model.score));
    starts
}

/// Best amplitude of one column with one sign, by repeated linearisation, and the misfit it leaves, before it.
fn amplitude(measured: &[f64], predicted: &[Vector], unit: &[Vector], sign: f64) -> Option<(f64, f64)> {
    let size = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let lengths: Vec<f64> = unit.iter().map(|u| u.norm()).collect();
    if size(&lengths) <= 0.0 {
        return None;
    }
    let mut value = sign * size(measured) / size(&lengths);
    for _ in 0..12 {
        let (mut up, mut down) = (0.0, 0.0);
        for ((m, p), u) in measured.iter().zip(predicted).zip(unit) {
            let whole = p + u * value;
            let norm = whole.norm();
            if norm > 0.0 {
                let slope = whole.dot(u) / norm;
                up += slope * (m - norm);
                down += slope * slope;
            }
        }
        if down <= 0.0 {
            break;
        }
        value += up / down;
    }
    let rows = measured.iter().zip(predicted.iter().zip(unit));
    let left: f64 = rows.map(|(m, (p, u))| (m - (p + u * value).norm()).powi(2)).sum();
    Some((left, value))
}

/// Equations of the first linearisation: enough to see whether there is anything to explain.
pub(crate) fn first_equations(data: &Measurements) -> Vec<Scalar> {
    if !data.has_magnitudes() {
        return data.scalars(None);
    }
    // Any direction will do to count readings and to see that they differ.
    let anywhere = vec![Vector::new(1e-6, 0.0, 0.0); data.rows.len()];
    let scalars = data.scalars(Some(&Believed { displaced_um: &anywhere, noise_um: 0.0 }));
    debug_assert!(residuals_are_finite(data, &scalars), "lengths are finite");
    scalars
}

fn residuals_are_finite(data: &Measurements, scalars: &[Scalar]) -> bool {
    residuals(&[], &[], &Source::new(data, scalars)).iter().all(|r| r.is_finite())
}
