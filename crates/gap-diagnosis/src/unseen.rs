//! The causes on points that no fit has seen.

use machine_model::Vector;

use crate::align::{magnitude_errors, rms, row_lengths};
use crate::assembly::Assembly;
use crate::diagnosis::{Holdout, Residual, Step};
use crate::observation::{Measurements, Reading, Scalar};
use crate::term::Term;

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
        let names = std::iter::once("set-up".to_owned()).chain(self.names());
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
        let mut names = vec!["model alone".to_owned()];
        let frame = [("zero of the measuring frame", 0..3), ("its rotation", 3..6)];
        for (name, range) in frame {
            taken_off.extend_from_slice(&all[range]);
            errors.push(magnitude_errors(holdout, &taken_off));
            names.push(name.to_owned());
        }
        taken_off.extend(self.instrument());
        for (ranked, name) in self.ordered.iter().zip(self.names()) {
            taken_off.extend(self.own(ranked.place));
            errors.push(magnitude_errors(holdout, &taken_off));
            names.push(name);
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

    /// Ids of the causes in order.
    fn names(&self) -> impl Iterator<Item = String> {
        self.ordered.iter().map(|r| self.model.library.candidates[r.part.candidate].kind.to_string())
    }
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
