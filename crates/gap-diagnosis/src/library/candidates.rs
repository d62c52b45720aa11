//! The candidates: every effect the data could show, in its textbook form and bent ones.

use std::ops::Range;

use machine_model::effects::{EffectKind, Shape};

use crate::equations::term::Term;
use crate::library::sampling::Sampling;

/// The slope among the coefficients of a curve along an axis.
pub(crate) const SLOPE: usize = 6;

/// One form of an effect: columns of the design.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Variant {
    /// Positions in [`Library::terms`].
    pub columns: Vec<usize>,
    /// True for forms that only bend the textbook form.
    pub enriched: bool,
    /// True for forms that these rows sample too coarsely to be named: a wave seen at less than two places per
    /// period can be any curve. They stay rivals.
    pub only_rival: bool,
}

impl Variant {
    /// A form that may be named: textbook.
    pub(crate) fn textbook(columns: Vec<usize>) -> Self {
        Self { columns, enriched: false, only_rival: false }
    }

    /// Each column a form, and all of them together one that only bends these.
    pub(crate) fn each_and_all(columns: Vec<usize>) -> Vec<Self> {
        let alone = columns.iter().map(|column| Self::textbook(vec![*column]));
        let mut variants: Vec<Self> = alone.collect();
        variants.push(Self { enriched: true, ..Self::textbook(columns) });
        variants
    }
}

/// One effect with all its forms.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Candidate {
    /// Which.
    pub kind: EffectKind,
    /// Its forms.
    pub variants: Vec<Variant>,
    /// Forms that were looked at and not kept, so that looking has its price.
    pub rejected: usize,
}

impl Candidate {
    /// Number of forms the data were asked about; bent ones that are rivals alone are never named and cost nothing.
    pub(crate) fn asked(&self) -> usize {
        let plain = self.variants.iter().filter(|form| !form.enriched || !form.only_rival).count();
        plain.max(1) + self.rejected
    }
}

/// One effect of a model: where it stands in the library.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Part {
    /// Index of the candidate.
    pub candidate: usize,
    /// Index of its form.
    pub variant: usize,
}

/// All columns and all candidates.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Library {
    /// Where each linear axis stood.
    pub sampling: [Sampling; 3],
    /// Set-up columns first, then those of the effects.
    pub terms: Vec<Term>,
    /// How many of the columns are the measuring frame's and the runs' angles.
    pub framing: usize,
    /// How many of the columns are set-up: these, and what the instruments add.
    pub nuisances: usize,
    /// The effects.
    pub candidates: Vec<Candidate>,
}

impl Library {
    /// Adds columns of an effect, unless they are there, and returns their positions.
    pub(crate) fn add_columns(&mut self, kind: EffectKind, shape: Shape, indices: &[usize]) -> Vec<usize> {
        let place = |term: Term, terms: &mut Vec<Term>| {
            terms.iter().position(|t| *t == term).unwrap_or_else(|| {
                terms.push(term);
                terms.len() - 1
            })
        };
        indices.iter().map(|i| place(Term::Effect { kind, index: *i, shape }, &mut self.terms)).collect()
    }

    /// Adds forms to an effect, as the search proposes them; `asked`: how many were looked at to find them.
    pub(crate) fn add_variants(&mut self, kind: EffectKind, variants: Vec<Variant>, asked: usize) {
        if let Some(candidate) = self.candidates.iter_mut().find(|c| c.kind == kind) {
            for variant in variants {
                if candidate.variants.iter().all(|v| v.columns != variant.columns) {
                    candidate.variants.push(variant);
                }
            }
            candidate.rejected = candidate.rejected.max(asked);
        } else {
            self.candidates.push(Candidate { kind, variants, rejected: asked });
        }
    }

    /// Forms made of a list of coefficient indices each; the first list is the textbook form.
    pub(crate) fn selections(&mut self, kind: EffectKind, shape: Shape, lists: &[&[usize]]) -> Vec<Variant> {
        let mut indices: Vec<usize> = lists.iter().flat_map(|l| l.iter().copied()).collect();
        indices.sort_unstable();
        indices.dedup();
        let columns = self.add_columns(kind, shape, &indices);
        let at = |index: &usize| indices.iter().position(|i| i == index).map_or(0, |p| columns[p]);
        let pick = |(place, list): (usize, &&[usize])| Variant {
            columns: list.iter().map(at).collect(),
            enriched: place > 0,
            only_rival: false,
        };
        lists.iter().enumerate().map(pick).collect()
    }

    /// The effect of a part.
    pub(crate) fn kind(&self, part: Part) -> EffectKind {
        self.candidates[part.candidate].kind
    }

    /// The form of a part.
    pub(crate) fn form(&self, part: Part) -> &Variant {
        &self.candidates[part.candidate].variants[part.variant]
    }

    /// Nameable forms of a part's effect with some of its columns, not all.
    pub(crate) fn plainer(&self, part: Part) -> Vec<Part> {
        let own = &self.form(part).columns;
        let forms = self.candidates[part.candidate].variants.iter().enumerate();
        let fewer = forms.filter(|(_, form)| {
            !form.only_rival && form.columns.len() < own.len() && form.columns.iter().all(|c| own.contains(c))
        });
        fewer.map(|(variant, _)| Part { variant, ..part }).collect()
    }

    /// The parts that a curve's constant and slope count as on rows where rotary axes turn and show them; on others they are
    /// the measuring frame's.
    pub(crate) fn owners(&self, curve: Part) -> Vec<Part> {
        if !self.candidates.iter().any(|candidate| matches!(candidate.kind, EffectKind::Rotary { .. })) {
            return Vec::new();
        }
        let owns = |kind: EffectKind| match (self.kind(curve), kind) {
            (
                EffectKind::Positioning(direction) | EffectKind::Straightness { direction, .. },
                EffectKind::Rotary { component, .. },
            ) => direction == component,
            (curve, kind) => is_slope_of(curve, kind),
        };
        self.named(owns)
    }

    /// True where a form is a curve with its slope, and that slope is an effect of this kind.
    pub(crate) fn slopes_as(&self, curve: Part, kind: EffectKind) -> bool {
        let is_slope = |column: &usize| matches!(self.terms[*column], Term::Effect { index: SLOPE, .. });
        is_slope_of(self.kind(curve), kind) && self.form(curve).columns.iter().any(is_slope)
    }

    /// The fullest form, not bent, that may be named of every effect of some kinds.
    pub(crate) fn named(&self, is_one: impl Fn(EffectKind) -> bool) -> Vec<Part> {
        let of = |(candidate, own): (usize, &Candidate)| {
            let variant = own.variants.iter().rposition(|form| !form.only_rival && !form.enriched)?;
            is_one(own.kind).then_some(Part { candidate, variant })
        };
        self.candidates.iter().enumerate().filter_map(of).collect()
    }

    /// True where a part completes one of some curves: it is their constant or their slope.
    pub(crate) fn completes(&self, part: Part, curves: &[Part]) -> bool {
        curves.iter().any(|curve| self.owners(*curve).iter().any(|owner| owner.candidate == part.candidate))
    }

    /// Columns of a model: the set-up's, then those of its parts.
    pub(crate) fn model_columns(&self, parts: &[Part]) -> Vec<usize> {
        let own = parts.iter().flat_map(|part| &self.form(*part).columns);
        (0..self.nuisances).chain(own.copied()).collect()
    }

    /// Positions of a part's columns among those of its model.
    pub(crate) fn positions(&self, parts: &[Part], place: usize) -> Range<usize> {
        let length = |part: &Part| self.form(*part).columns.len();
        let start = self.nuisances + parts.iter().take(place).map(length).sum::<usize>();
        start..start + length(&parts[place])
    }

    /// By how much the p value of one form of a candidate must be multiplied (weighted Bonferroni): every
    /// effect has the same share of the level, and its forms divide it.
    pub(crate) fn questions(&self, candidate: usize) -> f64 {
        (self.candidates.len() * self.candidates[candidate].asked()) as f64
    }
}

/// True where the slope of a curve along an axis counts as an effect of another kind.
const fn is_slope_of(curve: EffectKind, kind: EffectKind) -> bool {
    match (curve, kind) {
        (EffectKind::Positioning(along), EffectKind::Scale(axis)) => along == axis,
        (EffectKind::Straightness { direction, axis }, EffectKind::Squareness(first, second)) => {
            (direction == first && axis == second) || (direction == second && axis == first)
        }
        _ => false,
    }
}
