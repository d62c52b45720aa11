//! Shapes that the search asks the library for: proposed by what is left, refined, made to imitate.

use machine_model::effects::{EffectKind, Shape};

use crate::effects::{self, Searched};
use crate::equations::fit::residuals;
use crate::equations::term::Term;
use crate::library::candidates::{Part, Variant};
use crate::library::seen::JOINT_PLACES;
use crate::search::moves::{halves, without};
use crate::search::proposals;
use crate::search::refine::Stage;
use crate::search::space::Asked;
use crate::search::state::State;

impl State<'_, '_> {
    /// Shapes worth asking about, given what is explained already.
    pub(super) fn propose(&mut self) {
        let rho = self.space.rho(self.fit.level);
        let sub = self.space.gram.select(&self.library.model_columns(&self.parts));
        let solution = sub.solve(rho, self.source);
        for axis in 0..3 {
            let kind = EffectKind::Pitch(axis);
            if self.without.contains(&kind) || self.uses(kind) {
                continue;
            }
            let (found, asked, hidden) = self.pitches[axis].best(self.source, &solution.residuals_um, axis);
            for pitch in found {
                let variants = self.library.pitch(axis, pitch);
                self.library.add_variants(kind, variants, asked);
            }
            self.strobe(kind, axis, hidden);
        }
        // Residuals with the runs' offsets put back: a knock between two runs hides in them.
        let marginal = residuals(&sub.terms, &solution.coefficients, self.source);
        for axis in 0..3 {
            let kind = EffectKind::Step(axis);
            if self.without.contains(&kind) || self.uses(kind) {
                continue;
            }
            for residuals in [&solution.residuals_um, &marginal] {
                if let Some((moment, asked)) = proposals::knock(self.source, residuals, axis)
                    && let Some(columns) = self.library.knock(axis, moment)
                {
                    // The grid of the library asked already; a finer one asks at most that often again.
                    self.library.add_variants(kind, vec![Variant::textbook(columns)], asked.min(48));
                }
            }
        }
        for axis in 0..3 {
            let kind = EffectKind::Local(axis);
            if self.without.contains(&kind) || self.uses(kind) {
                continue;
            }
            let narrowest = self.library.sampling[axis].narrowest_mm;
            if let Some((centre, width, asked)) =
                proposals::damage(self.source, &solution.residuals_um, axis, narrowest)
            {
                let variants = self.library.place(kind, centre, width);
                self.library.add_variants(kind, variants, asked);
            }
        }
        for axis in 0..3 {
            let kind = EffectKind::Joint(axis);
            let few = self.library.sampling[axis].effective < JOINT_PLACES;
            if self.without.contains(&kind) || self.uses(kind) || few {
                continue;
            }
            if let Some((centre, asked)) = proposals::joint(self.source, &solution.residuals_um, axis) {
                let width = 0.4 * self.library.sampling[axis].narrowest_mm;
                let variants = self.library.join(kind, centre, width);
                self.library.add_variants(kind, variants, asked.min(48));
            }
        }
        self.refine_shapes(rho);
        self.grow();
    }

    /// Forms of a screw's period that even steps show as a slow curve: never named, rivals of what is.
    fn strobe(&mut self, kind: EffectKind, axis: usize, hidden: Option<f64>) {
        let mut forms = hidden.map(|pitch| self.library.pitch(axis, pitch)).unwrap_or_default();
        forms.iter_mut().for_each(|form| form.only_rival = true);
        if !forms.is_empty() {
            self.library.add_variants(kind, forms, 0);
        }
    }

    /// Refined shapes of the effects in the model.
    fn refine_shapes(&mut self, rho: f64) {
        let columns = self.library.model_columns(&self.parts);
        let terms = columns.iter().map(|c| (*c, self.library.terms[*c])).collect();
        let stage = Stage::new(self.source, terms, rho);
        for place in 0..self.parts.len() {
            let part = self.parts[place];
            let kind = self.library.kind(part);
            let own = self.library.form(part).columns.clone();
            let Some((shape, indices)) = self.shape_of(&own) else { continue };
            let axis = kind.axis().unwrap_or_default();
            let narrowest = self.library.sampling[axis].narrowest_mm;
            let Some(better) = stage.refined(&own, kind, &shape, &indices, narrowest) else { continue };
            if better == shape {
                continue;
            }
            let variants = match effects::of(kind).search.searched {
                Searched::Period => self.library.pitch(axis, better.pitch_mm),
                Searched::CentreAndWidth => self.library.place(kind, better.centre_mm, better.width_mm),
                Searched::Centre => self.library.join(kind, better.centre_mm, better.width_mm),
                Searched::Nothing | Searched::TimeConstants | Searched::Moment | Searched::Way => {
                    let columns = self.library.add_columns(kind, better, &indices);
                    vec![Variant::textbook(columns)]
                }
            };
            self.library.add_variants(kind, variants, 0);
        }
    }

    /// The common shape of an effect's columns and their coefficient indices; two time constants have none.
    fn shape_of(&self, columns: &[usize]) -> Option<(Shape, Vec<usize>)> {
        let mut shape: Option<Shape> = None;
        let mut indices = Vec::new();
        for column in columns {
            let Term::Effect { shape: this, index, .. } = self.library.terms[*column] else { return None };
            if shape.is_some_and(|s| s != this) {
                return None;
            }
            shape = Some(this);
            indices.push(index);
        }
        shape.map(|s| (s, indices))
    }

    /// Forms of other effects whose free numbers imitate the causes: a knock at the time the load came on is a
    /// rival of the load, whatever times a grid happens to hold.
    pub(super) fn imitate(&mut self) {
        let sub = self.space.gram.select(&self.library.model_columns(&self.parts));
        let solution = sub.solve(self.space.rho(self.fit.level), self.source);
        for (place, part) in self.parts.clone().into_iter().enumerate() {
            let own = self.library.kind(part);
            let columns = self.library.positions(&self.parts, place);
            let values: Vec<f64> = solution.coefficients[columns.clone()].iter().map(|v| -v).collect();
            let terms = &solution.terms[columns];
            // The gap is what `residuals` starts from.
            let displaced: Vec<f64> = residuals(terms, &values, self.source)
                .iter()
                .zip(self.source.scalars)
                .map(|(r, s)| r - s.gap_um)
                .collect();
            for axis in 0..3 {
                let hidden = self.pitches[axis].best(self.source, &displaced, axis).2;
                if own != EffectKind::Pitch(axis) && !self.without.contains(&EffectKind::Pitch(axis)) {
                    self.strobe(EffectKind::Pitch(axis), axis, hidden);
                }
                let allowed = |kind: EffectKind| kind != own && !self.without.contains(&kind);
                let kind = EffectKind::Step(axis);
                if let Some((moment, _)) =
                    proposals::knock(self.source, &displaced, axis).filter(|_| allowed(kind))
                    && let Some(columns) = self.library.knock(axis, moment)
                {
                    let form = Variant { only_rival: true, ..Variant::textbook(columns) };
                    self.library.add_variants(kind, vec![form], 0);
                }
                let kind = EffectKind::Local(axis);
                let narrowest = self.library.sampling[axis].narrowest_mm;
                if let Some((centre, width, _)) =
                    proposals::damage(self.source, &displaced, axis, narrowest).filter(|_| allowed(kind))
                {
                    let mut forms = self.library.place(kind, centre, width);
                    forms.iter_mut().for_each(|form| form.only_rival = true);
                    self.library.add_variants(kind, forms, 0);
                }
            }
        }
        self.grow();
        // Whether two stand for one is asked of the model that the search ends with.
        let (parts, library) = (&self.parts, &self.library);
        let halves = (0..parts.len()).flat_map(|place| {
            let scanned = self.space.scan(library, &without(parts, place), Asked::WithRivals);
            halves(library, parts[place], &scanned)
        });
        self.complete(&halves.collect::<Vec<Part>>());
    }
}
