//! How far the gap shrinks.

use crate::effects::is_straight;
use crate::equations::align::FREE_OFFSETS;
use crate::equations::columns::Source;
use crate::equations::gram::Gram;
use crate::equations::noise::tail_factor;
use crate::equations::observation::{Believed, Measurements, Scalar};
use crate::equations::term::Term;
use crate::judgement::answer::Shrinkage;
use crate::judgement::assembly::Assembly;
use crate::judgement::shrinkage::{Alternative, LEAST_WEIGHT, Strength, transported};
use crate::library::candidates::Part;
use crate::search::crossval::{Folding, Folds};

impl Assembly<'_> {
    /// What the first causes do to some commands, alignment taken out.
    pub(crate) fn strength(&self, data: &Measurements, scalars: &[Scalar], count: usize) -> Strength {
        let own: Vec<(Term, f64)> = self.taken_off(count);
        let positions: Vec<usize> =
            self.ordered.iter().take(count).flat_map(|r| self.positions(r.place)).collect();
        let mut terms = self.frame(data);
        let nuisances = terms.len();
        terms.extend(own.iter().map(|(t, _)| *t));
        let source = Source::new(data, scalars);
        let gram = Gram::new(terms, &source);
        let align = scalars.len() >= 24 && !data.has_magnitudes();
        let (whitened, _) = gram.whitened(if align { self.alignment } else { 0.0 });
        let (products, rank) =
            crate::equations::gram::eliminate(&whitened, if align { nuisances } else { 0 }, &gram.squares());
        let offset = products.nrows() - 1 - own.len();
        let covariance = &self.model.solution.unit_covariance;
        let (mut square, mut bent, mut spread) = (0.0, 0.0, 0.0);
        let is_bent = |term: &Term| !term.kind().is_some_and(is_straight);
        for (i, (first, a)) in own.iter().enumerate() {
            for (j, (second, b)) in own.iter().enumerate() {
                let product = products[(offset + i, offset + j)];
                square += a * b * product;
                if is_bent(first) && is_bent(second) {
                    bent += a * b * product;
                }
                spread += covariance[(positions[i], positions[j])] * product;
            }
        }
        let equations = scalars.len().max(1) as f64;
        let noise = self.noise_variance().max(1e-12);
        let offsets = if self.alignment < FREE_OFFSETS { 0.0 } else { gram.offsets_fitted() };
        let fitted = if align { rank as f64 + offsets } else { 0.0 };
        Strength {
            square: square / equations / noise,
            bent: bent / equations / noise,
            spread: spread * self.variance() / equations / noise,
            noise: self.unaligned() * (1.0 - fitted / equations).max(0.05),
        }
    }

    /// The same for rows that hold only lengths, nothing aligned: what the squares of measured minus modelled length are
    /// expected to be without and with the causes. A length has mean `μ` and mean square `|w|² + 3σ²` ([`Believed`]).
    fn strength_on_lengths(&self, data: &Measurements, count: usize) -> Strength {
        let noise = self.noise_variance().max(1e-12);
        let mut terms: Vec<(Term, f64)> = self
            .model
            .solution
            .terms
            .iter()
            .copied()
            .zip(self.model.solution.coefficients.iter().copied())
            .take(self.model.library.nuisances)
            .collect();
        terms.extend(self.taken_off(count));
        let displaced = crate::equations::align::displacements(data, &terms);
        let believed = Believed { displaced_um: &displaced, noise_um: noise.sqrt() };
        let (mut before, mut after) = (0.0, 0.0);
        for (row, displaced) in data.rows.iter().zip(&displaced) {
            let predicted = 1e3 * row.predicted_mm;
            let whole = predicted + displaced;
            let (square, expected) = (whole.norm_squared() + 3.0 * noise, believed.expected_um(&whole));
            let left = |modelled: f64| square - 2.0 * modelled * expected + modelled * modelled;
            before += left(predicted.norm());
            after += left(whole.norm());
        }
        let rows = data.rows.len().max(1) as f64;
        let strength = self.strength(data, &data.scalars(Some(&believed)), count);
        Strength { square: (before - after) / rows / noise, noise: after / rows / noise, ..strength }
    }

    /// Every rival of the first causes in the place of its cause, on other commands.
    fn alternatives(&self, data: &Measurements, scalars: &[Scalar], count: usize) -> Vec<Alternative> {
        let model = self.model;
        let named = self.taken_off(count);
        let source = Source::new(data, scalars);
        let scale = 1.0 / (scalars.len().max(1) as f64 * self.noise_variance().max(1e-12));
        let mut found = Vec::new();
        for ranked in self.ordered.iter().take(count) {
            for rival in ranked.told() {
                let weight = units::math::exp(-0.5 * rival.behind.max(0.0));
                if weight <= LEAST_WEIGHT {
                    continue;
                }
                let mut parts = model.parts.clone();
                parts[ranked.place] = rival.part;
                let sub = model.space.gram.select(&model.library.model_columns(&parts));
                let values = sub.coefficients(model.solution.rho);
                let first = self.ordered.iter().take(count).map(|r| r.place);
                let instead = first.flat_map(|place| {
                    model.library.positions(&parts, place).map(|i| (sub.terms[i], values[i]))
                });
                let (instead, minus): (Vec<_>, Vec<_>) =
                    (instead.clone().collect(), instead.map(|(t, v)| (t, -v)).collect());
                let difference: Vec<_> = named.iter().copied().chain(minus).collect();
                let frame = self.frame(data);
                let square = |terms: &[(Term, f64)]| scale * self.aligned_square(terms, &frame, &source);
                found.push(Alternative { weight, square: square(&instead), difference: square(&difference) });
            }
        }
        found
    }

    /// Square of what some terms displace, set-up and run offsets taken out, µm².
    fn aligned_square(&self, terms: &[(Term, f64)], frame: &[Term], source: &Source<'_>) -> f64 {
        let displaced: Vec<Scalar> = source
            .scalars
            .iter()
            .map(|s| {
                let row = &source.rows[s.row];
                let sum: f64 = terms.iter().map(|(t, v)| v * t.value(s, row, source.geometry)).sum();
                Scalar { gap_um: sum, ..*s }
            })
            .collect();
        let source = Source { scalars: &displaced, ..*source };
        let (whitened, _) = Gram::new(frame.to_vec(), &source).whitened(self.alignment);
        let columns: Vec<usize> = (0..whitened.nrows() - 1).collect();
        let squares: Vec<f64> = columns.iter().map(|i| whitened[(*i, *i)]).collect();
        let last = columns.len();
        (whitened[(last, last)] - crate::equations::linear::explained(&whitened, &columns, &squares).0)
            .max(0.0)
    }

    /// Mean square of the residual on unseen lines and its standard error, in units of the noise variance.
    ///
    /// With few runs a left-out run or stretch is an extrapolation, not a new line of the same kind: then the
    /// residual itself is taken, per degree of freedom.
    pub(crate) fn misfit(&self, count: usize) -> (f64, f64) {
        let model = self.model;
        let noise = self.noise_variance().max(1e-12);
        let parts: Vec<Part> = self.ordered.iter().take(count).map(|r| r.part).collect();
        if self.data.runs.len() < 8 {
            let (square, rank) = self.square(&parts);
            let degrees = (model.space.degrees - rank as f64).max(1.0);
            let m = square / degrees / noise;
            return (m, m * (2.0 / degrees).sqrt());
        }
        let folds = self.folds.get_or_init(|| {
            let parts: Vec<Part> = self.ordered.iter().map(|r| r.part).collect();
            let columns = model.library.model_columns(&parts);
            let terms: Vec<Term> = columns.iter().map(|c| model.library.terms[*c]).collect();
            let source = Source::new(self.data, &model.scalars);
            Folds::new(&terms, model.library.nuisances, model.solution.rho, &source, Folding::Runs)
        });
        // The columns of the first causes come first.
        let columns = model.space.columns(&model.library, &parts).len();
        let losses = folds.losses(&(0..columns).collect::<Vec<usize>>());
        let share = model.space.degrees / model.scalars.len() as f64;
        let m = losses.iter().sum::<f64>() / model.space.degrees / noise;
        let each: Vec<f64> = losses
            .iter()
            .zip(folds.counts())
            .filter(|(_, n)| **n > 0)
            .map(|(l, n)| l / (*n as f64 * share) / noise)
            .collect();
        let mean = each.iter().sum::<f64>() / each.len().max(1) as f64;
        let spread = each.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (m, (spread / (each.len() as f64 - 1.0).max(1.0) / each.len().max(1) as f64).sqrt())
    }

    pub(crate) fn shrink(&self, count: usize, holdout: Option<&Measurements>) -> Shrinkage {
        let model = self.model;
        let (m, m_error) = self.misfit(count);
        let mut data = self.strength(self.data, &model.scalars, count);
        if self.data.runs.len() < 8 {
            // A residual does not contain the uncertainty of the numbers that were fitted to it.
            data.spread = 0.0;
        }
        let (mut target, rivals) = match holdout {
            Some(h) if h.has_magnitudes() => (self.strength_on_lengths(h, count), Vec::new()),
            Some(h) => {
                let scalars = h.scalars(None);
                (self.strength(h, &scalars, count), self.alternatives(h, &scalars, count))
            }
            // On the rows themselves rivals do the same: that is why they are rivals.
            None => (data, Vec::new()),
        };
        target.noise *=
            tail_factor(&model.scalars, &model.solution.residuals_um, &model.dropped_residuals_um);
        transported(m, m_error, &data, &target, &rivals)
    }
}
