//! The trial of an effect that scores: what must hold before it is named, and when it goes again.
//!
//! Four tests, each against a mistake that the others let pass. The F test, its level divided among everything that was
//! asked, keeps noise from being named; the least share keeps what no one would repair out of the answer; lines that were
//! left out show whether the effect is one of the machine or of a single run.

use crate::crossval::{Folding, Folds};
use crate::engine::{LEAST_SHARE, LEVEL, Refused, State, f_tail, model_columns};
use crate::linear::Products;
use crate::search::without;
use crate::space::{Fit, Part};
use crate::term::Term;

/// Why an effect is refused that may be there and is not proven.
pub(crate) const UNPROVEN: &str = "the F test";

impl State<'_, '_> {
    /// Why an effect that scores must not be named beside `rest`; `None` where it may.
    pub(crate) fn objection(&self, rest: &[Part], part: Part, fit: &Fit) -> Option<Refused> {
        let mut with = rest.to_vec();
        with.push(part);
        let kind = self.library.candidates[part.candidate].kind;
        let (before, rank_before) = self.space.left(&self.library, rest, fit.level);
        let gain = (before - fit.residual).max(0.0);
        let columns = (fit.rank - rank_before.min(fit.rank)).max(1) as f64;
        let degrees = (self.space.degrees - fit.rank as f64).max(1.0);
        let effective = self.effective_degrees(part, fit.level, degrees);
        let ratio = gain / columns / (fit.residual / degrees).max(1e-12);
        // Once with everything, once with the runs' offsets left free: within the runs no drift between
        // them can deceive, and the better of two tests costs a factor of two.
        let p = 2.0
            * self.library.questions(part.candidate)
            * f_tail(ratio, columns, effective).min(self.within_runs(&with));
        let share = gain / before.max(1e-12);
        let refuse = |reason| Some(Refused { kind, share, p: p.min(1.0), reason });
        if p > LEVEL {
            return refuse(UNPROVEN);
        }
        let reducible = (self.space.total(fit.level) - fit.residual).max(1e-12);
        if gain / reducible < LEAST_SHARE {
            return refuse("its share is below 2 % of what can be explained");
        }
        if !self.predicts(&with, fit.level) {
            return refuse("it does not predict lines it has not seen");
        }
        None
    }

    /// F test of the last part with the runs' offsets left free.
    fn within_runs(&self, with: &[Part]) -> f64 {
        let level = crate::space::RHO_GRID.len() - 1;
        let (before, rank_before) = self.space.left(&self.library, &with[..with.len() - 1], level);
        let (after, rank_after) = self.space.left(&self.library, with, level);
        let columns = rank_after.saturating_sub(rank_before) as f64;
        let degrees = self.space.degrees - 3.0 * self.source.runs as f64 - rank_after as f64;
        if columns < 1.0 || degrees < 1.0 {
            return 1.0;
        }
        f_tail((before - after) / columns / (after / degrees).max(1e-12), columns, degrees)
    }

    /// Degrees of freedom of the noise that an effect competes with: few where only the differences
    /// between runs show it (Satterthwaite's combination of within and between).
    fn effective_degrees(&self, part: Part, level: usize, within: f64) -> f64 {
        let columns = self.space.columns(&self.library, &[part]);
        let last_level = crate::space::RHO_GRID.len() - 1;
        let information = |l: usize| -> f64 {
            columns
                .iter()
                .map(|c| self.space.products(l).product(*c, *c) / self.space.reference()[*c].max(1e-300))
                .sum()
        };
        let (here, free) = (information(level), information(last_level));
        let share = if here > 0.0 { (free / here).clamp(0.0, 1.0) } else { 1.0 };
        let between = (self.source.runs as f64 - 2.0).max(1.0);
        1.0 / (share * share / within + (1.0 - share) * (1.0 - share) / between)
    }

    /// True where the last of `with` helps to predict lines left out.
    fn predicts(&self, with: &[Part], level: usize) -> bool {
        let columns = model_columns(&self.library, with);
        let terms: Vec<Term> = columns.iter().map(|c| self.library.terms[*c]).collect();
        let nuisances = self.library.nuisances;
        let all: Vec<usize> = (0..terms.len() - nuisances).collect();
        let own =
            with.last().map_or(0, |p| self.library.candidates[p.candidate].variants[p.variant].columns.len());
        let (base, added) = all.split_at(all.len() - own);
        let rho = self.space.rho(level);
        let passes = |folding| {
            let folds = Folds::new(&terms, nuisances, rho, self.source, folding);
            let (gain, error) = folds.gain(base, &all);
            (gain > error, folds.concentration(added))
        };
        let (passed, concentration) = passes(Folding::Runs);
        let few = self.source.runs < 8 || concentration > 0.3;
        passed || (few && passes(Folding::Stretches).0)
    }

    /// Takes out causes that others have made superfluous.
    pub(crate) fn prune(&mut self) {
        loop {
            let level = self.fit.level;
            let (full, _) = self.space.left(&self.library, &self.parts, level);
            let reducible = (self.space.total(level) - full).max(1e-12);
            let weakest = (0..self.parts.len())
                .map(|place| {
                    let rest = without(&self.parts, place);
                    ((self.space.left(&self.library, &rest, level).0 - full) / reducible, rest)
                })
                .min_by(|a, b| a.0.total_cmp(&b.0));
            match weakest {
                Some((share, rest)) if share < LEAST_SHARE && self.parts.len() > 1 => {
                    self.parts = rest;
                    self.fit = self.space.fit(&self.library, &self.parts);
                }
                _ => break,
            }
        }
    }
}
