//! Angles that no carriage has give way to axes that lean, stretch or bend.

use machine_model::effects::EffectKind;

use crate::effects::gives_way_to;
use crate::library::candidates::Part;
use crate::search::bounds::log_prior;
use crate::search::climb::MOST_CAUSES;
use crate::search::moves::{with, without};
use crate::search::space::Fit;
use crate::search::state::State;

impl State<'_, '_> {
    /// Takes squarenesses, scales and curves along the same axes for the angles of carriages, all of them, two or one,
    /// where that is likelier: by what the rows say together with what carriages do ([`log_prior`]).
    ///
    /// Where all lines pass near one corner the levers of angles are small, and one that is large enough stands for a
    /// squareness, or for one and a scale; so does one for a scale and a curve where the levers differ little. One
    /// after the other they cannot be changed for the better.
    ///
    /// False where they are not.
    pub(super) fn straighten(&mut self) -> bool {
        let Some((parts, fit)) = self.straightened() else { return false };
        (self.parts, self.fit) = (parts, fit);
        self.propose();
        true
    }

    /// What was taken from angles does not go back to them for a better fit alone: an angle must be likelier.
    pub(super) fn may_bend(&self, rest: &[Part], part: Part, fit: &Fit) -> bool {
        !self.bends(part) || self.unlikely(&with(rest, part), fit) <= self.unlikely(&self.parts, &self.fit)
    }

    /// True of an angle of a carriage.
    pub(super) fn bends(&self, part: Part) -> bool {
        matches!(self.library.kind(part), EffectKind::Angular { .. })
    }

    /// The likeliest model that has straight axes, or curves, in the place of angles; `None` where the one there is
    /// likelier.
    fn straightened(&mut self) -> Option<(Vec<Part>, Fit)> {
        let angles: Vec<usize> = (0..self.parts.len()).filter(|k| self.bends(self.parts[*k])).collect();
        let pairs =
            angles.iter().flat_map(|b| angles.iter().filter(move |a| *a < b).map(move |a| vec![*a, *b]));
        let all = (angles.len() > 2).then(|| angles.clone());
        let groups = all.into_iter().chain(pairs).chain(angles.iter().map(|place| vec![*place]));
        let bent: Vec<EffectKind> =
            angles.iter().map(|place| self.library.kind(self.parts[*place])).collect();
        let straight = self.library.named(|kind| bent.iter().any(|bent| gives_way_to(*bent, kind)));
        let own = self.unlikely(&self.parts, &self.fit);
        let mut best: Option<(f64, Vec<Part>, Fit)> = None;
        for group in groups {
            let rest = group.iter().rev().fold(self.parts.clone(), |rest, place| without(&rest, *place));
            let mut with = rest.clone();
            with.extend(
                straight.iter().filter(|part| rest.iter().all(|other| other.candidate != part.candidate)),
            );
            let (fit, with) = self.least_of(with, rest.len());
            let unlikely = self.unlikely(&with, &fit);
            let limit = best.as_ref().map_or(own - self.space.allowance(), |(known, ..)| *known);
            let passes = |place: usize| self.objection(&without(&with, place), with[place], &fit).is_none();
            if with.len() <= MOST_CAUSES && unlikely < limit && (rest.len()..with.len()).all(passes) {
                best = Some((unlikely, with, fit));
            }
        }
        best.map(|(_, parts, fit)| (parts, fit))
    }

    /// A model without those of its parts from `first` on whose absence makes it no worse, the idlest first: a scale of
    /// one axis may count as that of another with a squareness or a radius.
    fn least_of(&mut self, mut with: Vec<Part>, first: usize) -> (Fit, Vec<Part>) {
        self.complete(&with);
        let mut fit = self.space.fit(&self.library, &with);
        loop {
            let fewer = (first..with.len()).map(|place| without(&with, place));
            let judged = fewer.filter_map(|fewer| {
                let fit = self.space.judge(&self.library, &fewer)(fit.level)?;
                Some((fit, fewer))
            });
            let Some((_, fewer)) = judged.min_by(|a, b| a.0.score.total_cmp(&b.0.score)) else {
                return (fit, with);
            };
            let plainer = self.space.fit_near(&self.library, &fewer, &fit);
            if plainer.score > fit.score {
                return (fit, with);
            }
            (fit, with) = (plainer, fewer);
        }
    }

    /// The score of a model with what machines usually have counted in.
    fn unlikely(&self, parts: &[Part], fit: &Fit) -> f64 {
        let values = self.space.values(&self.library, parts, self.space.rho(fit.level));
        fit.score - 2.0 * log_prior(&values)
    }
}
