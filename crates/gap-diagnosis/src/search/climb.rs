//! One pass of the search: uphill in score, every new effect on trial.

use machine_model::effects::EffectKind;

use crate::equations::columns::Source;
use crate::equations::observation::{Measurements, Scalar};
use crate::equations::pool::Pool;
use crate::library::candidates::Part;
use crate::search::doubt::Setting;
use crate::search::explanation::{Explanation, Reason, Refused};
use crate::search::moves::{MOST_TRIED, Move, by_effect, next_move, without};
use crate::search::space::{Asked, Fit};
use crate::search::state::State;

/// With fewer runs one that is left out is an extrapolation: that an effect does not foretell it hides nothing.
const ENOUGH_RUNS: usize = 8;
/// Most causes named.
pub(super) const MOST_CAUSES: usize = 8;

/// What a pass over the equations does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Task {
    /// Looks for causes.
    Search,
    /// Looks for causes, two in place of two others as well: once the noise is known, for it costs as much as all
    /// before.
    Exchange,
    /// Looks for shapes of other effects that imitate the causes found.
    Imitate,
}

/// One pass without the rows in `dropped`, beginning with the model of `start`.
pub(crate) fn pass(
    data: &Measurements,
    pool: &mut Pool<'_>,
    dropped: &[usize],
    without: &[EffectKind],
    setting: Setting,
    start: Option<Explanation>,
    task: Task,
) -> Explanation {
    let all = *pool.source();
    let (lost, scalars): (Vec<Scalar>, Vec<Scalar>) =
        all.scalars.iter().partition(|s| dropped.binary_search(&s.row).is_ok());
    let source = Source { scalars: &scalars, ..all };
    // Too few to look anything up.
    let lost = Source { scalars: &lost, places: None, ..all };
    let mut state = State::new(data, &source, pool, lost, without, setting, start);
    match task {
        Task::Search | Task::Exchange => state.search(task),
        Task::Imitate => state.imitate(),
    }
    let State { library, space, parts, fit, refused, .. } = state;
    let sub = space.gram.select(&library.model_columns(&parts));
    let rho = sub.best_rho(space.rho(fit.level));
    let rho = if space.rho(fit.level) == 0.0 && rho < 1e-3 { 0.0 } else { rho };
    let solution = sub.solve(rho, &source);
    Explanation {
        library,
        space,
        parts,
        fit,
        solution,
        outliers: Vec::new(),
        dropped_residuals_um: Vec::new(),
        equally_good: Vec::new(),
        refused,
        serial: setting.serial,
        caution: setting.counted(),
        clamping: setting.clamping,
        scalars,
    }
}

impl State<'_, '_> {
    fn search(&mut self, task: Task) {
        self.refused = None;
        // What an earlier search named must pass the tests on these rows, too: beside all others where readings hang
        // together, for what one cause leaves of the others does so as well.
        if self.setting.is_doubtful() {
            self.weed();
        }
        let earlier = if self.setting.is_doubtful() { Vec::new() } else { std::mem::take(&mut self.parts) };
        for part in earlier {
            let mut with = self.parts.clone();
            with.push(part);
            let fit = self.space.fit(&self.library, &with);
            if self.objection(&self.parts, part, &fit).is_none() {
                self.parts = with;
            }
        }
        self.fit = self.space.fit(&self.library, &self.parts);
        self.propose();
        for _ in 0..60 {
            let may = |rest: &[Part], part: Part, fit: &Fit| {
                self.objection(rest, part, fit).is_none() && self.may_bend(rest, part, fit)
            };
            match next_move(&self.space, &self.library, &self.parts, self.fit.score, may) {
                Move::Change(parts, fit) => {
                    self.complete(&parts);
                    (self.parts, self.fit) = (parts, fit);
                }
                Move::Add(proposed) => {
                    let full = self.parts.len() >= MOST_CAUSES;
                    let admitted = if full { Err(None) } else { self.admitted(&proposed) };
                    match admitted {
                        Ok((new, fit)) => {
                            self.parts.extend(new);
                            self.fit = fit;
                            self.propose();
                        }
                        Err(refused) => {
                            self.refused = refused.or_else(|| self.refused.take());
                            if !self.goes_on(task) {
                                break;
                            }
                        }
                    }
                }
                Move::Stop => {
                    if !self.goes_on(task) {
                        break;
                    }
                }
            }
        }
        self.prune();
        self.restrain();
    }

    /// Where no single change is for the better: several at once; false where there are none either.
    fn goes_on(&mut self, task: Task) -> bool {
        task == Task::Exchange && self.exchange() || self.straighten()
    }

    /// Two causes for two others that explain more, each of which passes its tests beside the other; false where there
    /// are none.
    ///
    /// One after the other, a curve that is a little of two causes comes first and stays, and more curves mend what it
    /// gets wrong: none of them can be changed for the better alone. So is the curve of high order that has taken a
    /// slope over: as it is, it leaves the scale too little to be named, and a plainer form of it comes only with the
    /// scale.
    fn exchange(&mut self) -> bool {
        let parts = self.parts.clone();
        let mut better: Vec<(Fit, Vec<Part>)> = Vec::new();
        for (first, second) in self.entangled() {
            let rest = without(&without(&parts, second), first);
            let firsts = by_effect(self.space.scan(&self.library, &rest, Asked::Nameable), f64::INFINITY);
            let firsts = firsts.into_iter().take(MOST_TRIED).map(|(new, _)| new);
            let plainer = [first, second].into_iter().flat_map(|place| self.library.plainer(parts[place]));
            for new in firsts.chain(plainer).collect::<Vec<Part>>() {
                // One of the two again: that was a change of the other alone.
                if new == parts[first] || new == parts[second] {
                    continue;
                }
                let with: Vec<Part> = rest.iter().copied().chain([new]).collect();
                self.complete(&with);
                let limit = self.fit.score - self.space.allowance();
                let seconds = by_effect(self.space.scan(&self.library, &with, Asked::Nameable), limit);
                let whole = |other: Part| with.iter().copied().chain([other]).collect();
                better.extend(seconds.into_iter().map(|(other, fit)| (fit, whole(other))));
            }
        }
        better.extend(self.completed());
        better.sort_by(|(a, _), (b, _)| a.score.total_cmp(&b.score));
        let passes = |(fit, with): &(Fit, Vec<Part>)| {
            let mut new = (0..with.len()).filter(|place| !parts.contains(&with[*place]));
            new.all(|place| self.objection(&without(with, place), with[place], fit).is_none())
        };
        let Some((fit, with)) = better.into_iter().take(MOST_TRIED).find(passes) else { return false };
        self.complete(&with);
        (self.parts, self.fit) = (with, fit);
        self.propose();
        true
    }

    /// A curve, in a plainer form or its own, with its constant and its slope at once, for itself and for one more
    /// cause.
    ///
    /// Where neither is in the model a curve of high order, or damage beside it, stands for both, and neither alone is
    /// better than that.
    fn completed(&mut self) -> Vec<(Fit, Vec<Part>)> {
        let parts = self.parts.clone();
        let limit = self.fit.score - self.space.allowance();
        let mut better = Vec::new();
        for (place, curve) in parts.iter().enumerate() {
            let owners = self.library.owners(*curve);
            if owners.is_empty() {
                continue;
            }
            let forms: Vec<Part> = self.library.plainer(*curve).into_iter().chain([*curve]).collect();
            // For another part as well; where that is the curve itself, for the curve alone.
            for other in 0..parts.len() {
                let kept = (0..parts.len()).filter(|k| *k != place && *k != other);
                let rest: Vec<Part> = kept.map(|k| parts[k]).collect();
                let is_new = |owner: &Part| rest.iter().all(|part| part.candidate != owner.candidate);
                let new: Vec<Part> = owners.iter().copied().filter(is_new).collect();
                if new.is_empty() || rest.len() + 1 + new.len() > MOST_CAUSES {
                    continue;
                }
                for form in &forms {
                    let with = rest.iter().chain([form]).chain(&new).copied().collect();
                    let (fit, with) = self.what_is_needed(with, rest.len() + 1);
                    if fit.score < limit {
                        better.push((fit, with));
                    }
                }
            }
        }
        better
    }

    /// A model without those of its parts from `first` on whose absence makes it no worse.
    fn what_is_needed(&mut self, mut with: Vec<Part>, first: usize) -> (Fit, Vec<Part>) {
        self.complete(&with);
        let mut fit = self.space.fit(&self.library, &with);
        for place in (first..with.len()).rev() {
            let fewer = without(&with, place);
            let plainer = self.space.fit_near(&self.library, &fewer, &fit);
            if plainer.score <= fit.score {
                (with, fit) = (fewer, plainer);
            }
        }
        (fit, with)
    }

    /// Pairs of causes that share what they explain, or that explain only together.
    fn entangled(&self) -> Vec<(usize, usize)> {
        /// Share of what the lesser of the two explains beside all others.
        const SHARED: f64 = 0.1;
        let left = |parts: &[Part]| self.space.left(&self.library, parts, self.fit.level).0;
        let full = left(&self.parts);
        let rests: Vec<Vec<Part>> = (0..self.parts.len()).map(|place| without(&self.parts, place)).collect();
        let alone: Vec<f64> = rests.iter().map(|rest| left(rest) - full).collect();
        let is_entangled = |(first, second): &(usize, usize)| {
            let both = left(&without(&rests[*second], *first)) - full;
            let apart = alone[*first] + alone[*second];
            (both - apart).abs() > SHARED * alone[*first].min(alone[*second])
        };
        let pairs = (1..self.parts.len()).flat_map(|second| (0..second).map(move |first| (first, second)));
        pairs.filter(is_entangled).collect()
    }

    /// Takes out causes that fail their tests beside all others, the weakest first.
    fn weed(&mut self) {
        loop {
            let full = self.space.fit(&self.library, &self.parts);
            let failed = (0..self.parts.len()).filter_map(|place| {
                let rest = without(&self.parts, place);
                let refused = self.objection(&rest, self.parts[place], &full)?;
                Some((refused.p, rest, refused))
            });
            let Some((_, rest, refused)) = failed.max_by(|a, b| a.0.total_cmp(&b.0)) else { break };
            (self.parts, self.refused) = (rest, Some(refused));
        }
    }

    /// The first of some effects that passes its tests, or two that pass beside each other; else why the best did not.
    ///
    /// What few runs cannot prove (a knock between two of them explains their offsets) does not keep the next ones from
    /// their tests, and neither does a form that breaks its bounds: two waves of a probe that cancel by tenths of a
    /// millimetre say nothing of the play behind them. What does not hold on other lines ends the search: the structure
    /// is there, and has no name. But two faults may hide each other: on circles of either sense a lag adds to a
    /// squareness or takes off it, and neither alone foretells a circle that was left out.
    fn admitted(&mut self, proposed: &[(Part, Fit)]) -> Result<(Vec<Part>, Fit), Option<Refused>> {
        let mut first = None;
        for (part, fit) in proposed.iter().take(MOST_TRIED) {
            let Some(refused) = self.objection(&self.parts, *part, fit) else {
                return Ok((vec![*part], *fit));
            };
            let reason = refused.reason;
            first.get_or_insert(refused);
            let many = self.source.runs >= ENOUGH_RUNS;
            if many && reason == Reason::NotElsewhere && self.parts.len() + 2 <= MOST_CAUSES {
                let others = proposed.iter().take(MOST_TRIED).map(|(other, _)| *other);
                if let Some(pair) = self.hidden_by(*part, others.filter(|other| other != part)) {
                    return Ok(pair);
                }
            }
            if !matches!(reason, Reason::Unproven | Reason::Form(_)) {
                break;
            }
        }
        Err(first)
    }

    /// A part and the best of some others, where each passes its tests beside the other.
    fn hidden_by(&mut self, part: Part, others: impl Iterator<Item = Part>) -> Option<(Vec<Part>, Fit)> {
        let beside = |new: Part| -> Vec<Part> { self.parts.iter().copied().chain([new]).collect() };
        let with = beside(part);
        let pairs: Vec<(Part, Vec<Part>)> = others.map(|other| (other, beside(other))).collect();
        self.complete(&with);
        let judged = |(other, rest): (Part, Vec<Part>)| {
            let both: Vec<Part> = with.iter().copied().chain([other]).collect();
            (self.space.fit(&self.library, &both), other, rest)
        };
        let mut pairs: Vec<(Fit, Part, Vec<Part>)> = pairs.into_iter().map(judged).collect();
        pairs.sort_by(|a, b| a.0.score.total_cmp(&b.0.score));
        pairs.into_iter().find_map(|(fit, other, rest)| {
            let passes = |rest: &[Part], new: Part| self.objection(rest, new, &fit).is_none();
            (passes(&with, other) && passes(&rest, part)).then(|| (vec![part, other], fit))
        })
    }
}
