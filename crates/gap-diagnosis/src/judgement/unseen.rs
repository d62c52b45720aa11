//! The causes on points that no fit has seen.

use diagnostic::Text;
use machine_model::Vector;

use machine_model::effects::EffectKind;

use crate::equations::align::{aligned, magnitude_errors, rms, row_lengths};
use crate::equations::noise::tail_factor;
use crate::equations::observation::{Measurements, Reading, Scalar};
use crate::equations::term::Term;
use crate::judgement::answer::{Holdout, Residual, Shrinkage, Step};
use crate::judgement::assembly::Assembly;
use crate::judgement::verdict::Unseen;
use crate::search::explain::explain;

impl Assembly<'_> {
    pub(crate) fn holdout(&self, holdout: &Measurements) -> Holdout {
        if holdout.has_magnitudes() { self.lengths_unseen(holdout) } else { self.vectors_unseen(holdout) }
    }

    /// Vectors, components, ball bars: every step is aligned anew, as a new set-up would be.
    fn vectors_unseen(&self, holdout: &Measurements) -> Holdout {
        let scalars = holdout.scalars(None);
        let gaps: Vec<Vec<f64>> =
            (0..=self.ordered.len()).map(|count| self.gap(holdout, &scalars, count)).collect();
        let sizes: Vec<f64> = gaps.iter().map(|gap| rms(&row_lengths(&scalars, gap))).collect();
        let names = std::iter::once(Text::pair("set-up", "установка")).chain(self.names().map(Text::same));
        let steps = names.zip(&sizes).map(|(added, rms_um)| Step { added, rms_um: *rms_um }).collect();
        let residuals = residuals(&scalars, &gaps[0], &gaps[self.ordered.len()]);
        let rows = row_lengths(&scalars, &gaps[0]).len();
        finished(rows, sizes[0], sizes[self.ordered.len()], steps, residuals)
    }

    /// Lengths alone cannot be aligned: they are taken in the measuring frame that was found, its zero first (the
    /// model's tables have another), then its rotation.
    fn lengths_unseen(&self, holdout: &Measurements) -> Holdout {
        let solution = &self.model.solution;
        let all: Vec<(Term, f64)> =
            solution.terms.iter().copied().zip(solution.coefficients.iter().copied()).collect();
        let mut taken_off: Vec<(Term, f64)> = Vec::new();
        let mut errors = vec![magnitude_errors(holdout, &taken_off)];
        let mut names = vec![Text::pair("model alone", "одна модель")];
        let frame = [
            (Text::pair("zero of the measuring frame", "нуль системы измерения"), 0..3),
            (Text::pair("its rotation", "её поворот"), 3..6),
        ];
        for (name, range) in frame {
            taken_off.extend_from_slice(&all[range]);
            errors.push(magnitude_errors(holdout, &taken_off));
            names.push(name);
        }
        taken_off.extend(self.instrument());
        for (ranked, name) in self.ordered.iter().zip(self.names()) {
            taken_off.extend(self.own(ranked.place));
            errors.push(magnitude_errors(holdout, &taken_off));
            names.push(Text::same(name));
        }
        let sizes: Vec<f64> = errors.iter().map(|e| rms(e)).collect();
        let steps = names.into_iter().zip(&sizes).map(|(added, r)| Step { added, rms_um: *r }).collect();
        let last = errors.len() - 1;
        let with_length = holdout.rows.iter().enumerate();
        let with_length = with_length.filter(|(_, r)| matches!(r.reading, Reading::Magnitude(_)));
        let residuals = with_length
            .zip(errors[0].iter().zip(&errors[last]))
            .map(|((row, _), (before, after))| Residual {
                row,
                class: 3,
                along: Vector::zeros(),
                before_um: *before,
                after_um: *after,
            })
            .collect();
        finished(errors[0].len(), sizes[0], sizes[last], steps, residuals)
    }

    /// What some unseen rows say, in units of what noise alone would leave there.
    pub(crate) fn unseen(
        &self,
        data: &Measurements,
        before_um: f64,
        after_um: f64,
        promised: Option<Shrinkage>,
    ) -> Unseen {
        let model = self.model;
        let equations = if data.has_magnitudes() { data.rows.len() } else { data.scalars(None).len() } as f64;
        let tail = tail_factor(&model.scalars, &model.solution.residuals_um, &model.dropped_residuals_um);
        let floor = (self.noise_variance() * self.unaligned() * tail * equations
            / data.rows.len().max(1) as f64)
            .sqrt()
            .max(1e-9);
        let promised = promised.map_or((0.0, 0.0), |s| (s.low, s.mid));
        let left = if before_um > 0.0 { after_um / before_um } else { 1.0 };
        // Both sizes are known to 1/√(2n), their ratio to √2 of that at worst.
        let error = left / equations.max(1.0).sqrt();
        // Noise was estimated on the rows of the fit, and readings that hang together count as fewer.
        let few = |readings: f64| model.caution.as_one() / (2.0 * readings.max(1.0));
        let chance = (few(equations) + few(self.degrees())).sqrt();
        Unseen { before: before_um / floor, after: after_um / floor, promised, error, chance }
    }

    /// The forecast of this model for runs that it was not fitted to, and what became of it: in the frame that was
    /// fitted, only the zero of every run is its own.
    fn on_runs_kept_back(&self, kept: &Measurements) -> Option<Unseen> {
        let count = self.ordered.len();
        if count == 0 {
            return None;
        }
        let solution = &self.model.solution;
        let framing = self.model.library.framing;
        let fitted = solution.terms.iter().copied().zip(solution.coefficients.iter().copied()).take(framing);
        let frame: Vec<(Term, f64)> =
            fitted.filter(|(t, _)| !matches!(t, Term::RunRotation { .. })).chain(self.instrument()).collect();
        let turns: Vec<Term> = self.frame(kept).into_iter().skip(6).collect();
        let scalars = kept.scalars(None);
        let size = |causes: &[(Term, f64)]| {
            let off: Vec<(Term, f64)> = frame.iter().chain(causes).copied().collect();
            rms(&row_lengths(&scalars, &aligned(kept, &scalars, &turns, self.alignment, &off)))
        };
        let promised = self.shrink(count, Some(kept));
        Some(self.unseen(kept, size(&[]), size(&self.taken_off(count)), Some(promised)))
    }

    /// Ids of the causes in order.
    fn names(&self) -> impl Iterator<Item = String> {
        self.ordered.iter().map(|r| self.model.library.kind(r.part).to_string())
    }
}

/// Every fourth run kept back and the whole search made on the others: what becomes of its forecast. `None` where these runs
/// lie outside what the others cover, are few, or the others name nothing.
#[must_use]
pub(crate) fn kept_back(data: &Measurements, without: &[EffectKind]) -> Option<Unseen> {
    /// Fewer runs leave no three quarters that cover the machine.
    const RUNS: usize = 8;
    /// More rows make a second search too slow.
    const ROWS: usize = 20_000;
    let all = data.runs.len();
    if all < RUNS || data.rows.len() > ROWS || data.has_magnitudes() {
        return None;
    }
    let part = |wanted: bool| {
        let chosen: Vec<usize> = (0..all).filter(|run| (run % 4 == 2) == wanted).collect();
        let rows = data.rows.iter().filter_map(|row| {
            chosen.binary_search(&row.run).ok().map(|run| crate::equations::observation::Row { run, ..*row })
        });
        let runs = chosen.iter().map(|run| data.runs[*run].clone()).collect();
        Measurements { runs, rows: rows.collect(), ..data.clone() }
    };
    let (fitted, kept) = (part(false), part(true));
    let inside = |axis: usize| {
        let ((low, high), (from, to)) = (fitted.range_mm(axis), kept.range_mm(axis));
        let slack = 0.05 * (high - low) + 1e-6;
        from >= low - slack && to <= high + slack
    };
    if !(0..3).all(inside) {
        return None;
    }
    let model = explain(&fitted, &fitted.scalars(None), without);
    Assembly::new(&fitted, &model).on_runs_kept_back(&kept)
}

fn finished(
    rows: usize,
    rms_before_um: f64,
    rms_after_um: f64,
    steps: Vec<Step>,
    residuals: Vec<Residual>,
) -> Holdout {
    let shrink = if rms_before_um > 0.0 { 1.0 - rms_after_um / rms_before_um } else { 0.0 };
    Holdout { rows, rms_before_um, rms_after_um, shrink, steps, residuals }
}

/// Two states of the same equations.
#[must_use]
pub(crate) fn residuals(scalars: &[Scalar], before: &[f64], after: &[f64]) -> Vec<Residual> {
    scalars
        .iter()
        .zip(before.iter().zip(after))
        .map(|(s, (b, a))| Residual {
            row: s.row,
            class: s.class,
            along: s.along,
            before_um: *b,
            after_um: *a,
        })
        .collect()
}
