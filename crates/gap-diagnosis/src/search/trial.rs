//! The trial of an effect that scores: what must hold before it is named, and when it goes again.
//!
//! Four tests, each against a mistake that the others let pass. The F test, its level divided among everything that was
//! asked, keeps noise from being named; the least share keeps what no one would repair out of the answer; lines that were
//! left out show whether the effect is one of the machine or of a single run.

use machine_model::effects::{EffectKind, Shape};

use crate::effects::Why;
use crate::effects::curve_axis;
use crate::equations::f_test::f_tail;
use crate::equations::linear::{Products, explained};
use crate::equations::observation::Row;
use crate::equations::term::Term;
use crate::library::candidates::{Library, Part};
use crate::search::crossval::{Folding, Folds};
use crate::search::doubt::inflations;
use crate::search::explanation::{Reason, Refused};
use crate::search::moves::without;
use crate::search::proposals::{LOCAL_PLACES, STEP_ROWS};
use crate::search::space::{FREE, Fit};
use crate::search::state::State;

/// Level of the F test, over all questions asked: shared evenly among the effects, and within an effect among
/// its forms. Blunders that pass for damage come on top: 3 % leave room below one false alarm in twenty.
pub(crate) const LEVEL: f64 = 3e-2;
/// Least share of the reducible square that a cause must explain.
pub(crate) const LEAST_SHARE: f64 = 0.02;
/// Least share of a joint of rails, and of damage at one: where curves are bent otherwise than in textbooks a step fits a
/// little, and a dent at the step.
const LEAST_STEP: f64 = 0.15;
/// The same of a curve beside an angle with which it has more coefficients than half the places: so much is left of a roll
/// that is bent otherwise than in textbooks, and a straightness fits it a little.
const LEAST_BESIDE: f64 = 0.05;

/// Where the noise is not what the tests take for granted, an effect that takes less than this share off the RMS …
const WORTH: f64 = 0.1;
/// … must be known to so many standard deviations: five times its 95 % interval, so that noise three times as large in what
/// counts, as a walk too slow for the lags or a display's step makes it, names nothing.
const BEYOND_DOUBT: f64 = 10.0;

const CROWDED: Why = [
    "the curves along that axis would have more coefficients than half the places measured",
    "у кривых вдоль этой оси было бы коэффициентов больше половины измеренных точек",
];

/// More than this share of what shows an effect lies between the runs: how much these differ by chance decides.
const MOSTLY: f64 = 0.5;

impl State<'_, '_> {
    /// Why an effect that scores must not be named beside `rest`; `None` where it may.
    pub(crate) fn objection(&self, rest: &[Part], part: Part, fit: &Fit) -> Option<Refused> {
        let mut with = rest.to_vec();
        with.push(part);
        let kind = self.library.kind(part);
        let (before, rank_before) = self.space.left(&self.library, rest, fit.level);
        let between = self.between_runs(part, fit.level);
        let (tested, residual) =
            if between > MOSTLY { self.at_best_ratio(&with, fit.level) } else { (before, fit.residual) };
        let columns = (fit.rank - rank_before.min(fit.rank)).max(1) as f64;
        let degrees = (self.space.degrees - fit.rank as f64).max(1.0);
        let inflation = self.inflation(rest, part, fit.level);
        let independent = degrees / self.setting.counted().as_one();
        let effective = self.effective_degrees(between, independent.max(1.0));
        let ratio = (tested - residual).max(0.0) / columns / (residual / degrees).max(self.floor) / inflation;
        // Once with everything, once with the runs' offsets left free: within the runs no drift between
        // them can deceive, and the better of two tests costs a factor of two.
        // A knock that the order of the rows alone shows must be one within a run: what lies between runs is their shift.
        let by_order = self
            .library
            .form(part)
            .columns
            .iter()
            .any(|c| matches!(self.library.terms[*c], Term::Knock { .. }));
        let everywhere = if by_order { 1.0 } else { f_tail(ratio, columns, effective) };
        let p =
            2.0 * self.library.questions(part.candidate) * everywhere.min(self.within_runs(&with, inflation));
        let gain = (before - fit.residual).max(0.0);
        let share = gain / before.max(1e-12);
        let refuse = |reason| Some(Refused { kind, share, p: p.min(1.0), reason });
        if p > LEVEL {
            return refuse(Reason::Unproven);
        }
        // An angle has readings of its own where every place is read through many levers.
        let shares = |axis: usize, part: Part| !(self.library.sampling[axis].crossed && self.bends(part));
        let misfit = unsupported(&self.library, part, self.source.rows)
            .or_else(|| self.crowded(&with, shares).then_some(CROWDED));
        if let Some(words) = misfit.or_else(|| self.out_of_bounds(&with, fit.level)) {
            return refuse(Reason::Form(words));
        }
        let trifling = residual > (1.0 - WORTH) * (1.0 - WORTH) * tested;
        if self.setting.is_doubtful() && trifling && ratio < BEYOND_DOUBT * BEYOND_DOUBT {
            return refuse(Reason::Little([
                "so small a gain rests on the noise being independent and normal, which it is not",
                "столь малый выигрыш значим лишь при независимом нормальном шуме, а шум не такой",
            ]));
        }
        let reducible = (self.space.total(fit.level) - fit.residual).max(1e-12);
        let by_shape = matches!(kind, EffectKind::Joint(_)) || self.on_a_flank(rest, part);
        let beside = gain / reducible < LEAST_BESIDE && self.crowded(&with, |_, _| true);
        if beside || by_shape && gain / reducible < LEAST_STEP {
            return refuse(Reason::Little([
                "so little is what the shape of another curve leaves",
                "столько остаётся и от формы другой кривой",
            ]));
        }
        // A curve without its constant or its slope has wrong numbers, however little either is.
        if self.share(&with, fit.level) < LEAST_SHARE
            && !self.library.completes(part, rest)
            && !is_most_of_rest(kind, gain, before)
        {
            return refuse(Reason::Little([
                "its share is below 2 % of what can be explained",
                "его доля меньше 2 % объяснимого",
            ]));
        }
        if !self.predicts(&with, fit.level) {
            return refuse(Reason::NotElsewhere);
        }
        None
    }

    /// Share of what can be explained that the last of some parts explains beside the others: of all, or within the
    /// runs, which may be shifted by far more than anything else.
    fn share(&self, with: &[Part], level: usize) -> f64 {
        let Some((part, rest)) = with.split_last() else { return 0.0 };
        let of = |level: usize| {
            let left = |parts: &[Part]| self.space.left(&self.library, parts, level).0;
            let full = left(with);
            (left(rest) - full).max(0.0) / (self.space.total(level) - full).max(1e-12)
        };
        of(level).max(of(FREE)) * self.spread(*part)
    }

    /// How many times as many equations there are as a part acts on, where its physics says which those are: at a turn of
    /// an axis, or of the axis that moves. Its share counts there, as a machinist reads the marks at the quadrants; a place that was searched for must
    /// earn its share of all.
    fn spread(&self, part: Part) -> f64 {
        if !matches!(self.library.kind(part), EffectKind::Spike(_) | EffectKind::Backlash(_)) {
            return 1.0;
        }
        let columns = &self.library.form(part).columns;
        let acts = |column: &usize| {
            let term = self.library.terms[*column];
            let squares = self.source.scalars.iter().map(|s| {
                let value = term.value(s, &self.source.rows[s.row], self.source.geometry);
                value * value
            });
            let (sum, of_squares) =
                squares.fold((0.0, 0.0), |(a, b), square| (a + square, b + square * square));
            if of_squares > 0.0 { sum * sum / of_squares } else { f64::INFINITY }
        };
        let most = columns.iter().map(acts).fold(1.0, f64::max);
        (self.source.scalars.len() as f64 / most).max(1.0)
    }

    /// True for damage where a joint of the same rails stands, or along an axis with a curve in the same component:
    /// the shape of either leaves something there.
    fn on_a_flank(&self, rest: &[Part], part: Part) -> bool {
        let Some((EffectKind::Local(axis), own)) = shape(&self.library, part) else { return false };
        let touches = |part: Part, component: usize| {
            let columns = &self.library.form(part).columns;
            columns.iter().any(|column| self.library.terms[*column].touches(component, self.source.geometry))
        };
        rest.iter().any(|other| match shape(&self.library, *other) {
            Some((EffectKind::Joint(along), other)) => {
                along == axis && (other.centre_mm - own.centre_mm).abs() < other.width_mm + own.width_mm
            }
            Some((kind, _)) => {
                curve_axis(kind) == Some(axis)
                    && (0..3).any(|component| touches(*other, component) && touches(part, component))
            }
            None => false,
        })
    }

    /// Curves along one axis seen in one component: together those that count may have no more coefficients than half
    /// the places.
    fn crowded(&self, with: &[Part], counts: impl Fn(usize, Part) -> bool) -> bool {
        let crowd = |axis: usize, component: usize| {
            let own =
                |part: &&Part| curve_axis(self.library.kind(**part)) == Some(axis) && counts(axis, **part);
            let columns = with.iter().filter(own).flat_map(|part| &self.library.form(*part).columns);
            let seen = |c: &&usize| self.library.terms[**c].touches(component, self.source.geometry);
            2.0 * columns.filter(seen).count() as f64 > self.library.sampling[axis].effective + 0.5
        };
        (0..3).any(|axis| (0..3).any(|component| crowd(axis, component)))
    }

    /// Why a part, with the numbers it has beside the others, must not be used.
    fn out_of_bounds(&self, parts: &[Part], level: usize) -> Option<Why> {
        let sub = self.space.gram.select(&self.library.model_columns(parts));
        let values = sub.coefficients(self.space.rho(level));
        (0..parts.len()).find_map(|place| {
            let kind = self.library.kind(parts[place]);
            let own = self.library.positions(parts, place);
            let terms: Vec<(Term, f64)> = own.map(|i| (sub.terms[i], values[i])).collect();
            self.bounds.broken_by(kind, &terms, self.source.geometry)
        })
    }

    /// Takes out causes that break their bounds in the model that the search ended with, the worst scoring first.
    pub(crate) fn restrain(&mut self) {
        while !self.parts.is_empty() {
            let Some(reason) = self.out_of_bounds(&self.parts, self.fit.level) else { break };
            let kept = (0..self.parts.len()).map(|place| without(&self.parts, place));
            let judged = kept.map(|rest| (self.space.fit(&self.library, &rest), rest));
            let (tame, wild): (Vec<_>, Vec<_>) =
                judged.partition(|(fit, rest)| self.out_of_bounds(rest, fit.level).is_none());
            let pool = if tame.is_empty() { wild } else { tame };
            let Some((fit, rest)) = pool.into_iter().min_by(|a, b| a.0.score.total_cmp(&b.0.score)) else {
                break;
            };
            let gone = self.parts.iter().find(|p| !rest.contains(p));
            if let Some(part) = gone {
                let (before, _) = self.space.left(&self.library, &rest, fit.level);
                let share = (before - self.fit.residual).max(0.0) / before.max(1e-12);
                let kind = self.library.kind(*part);
                self.refused = Some(Refused { kind, share, p: 0.0, reason: Reason::Form(reason) });
            }
            (self.parts, self.fit) = (rest, fit);
        }
    }

    /// F test of the last part with the runs' offsets left free.
    fn within_runs(&self, with: &[Part], inflation: f64) -> f64 {
        let (before, rank_before) = self.space.left(&self.library, &with[..with.len() - 1], FREE);
        let (after, rank_after) = self.space.left(&self.library, with, FREE);
        let columns = rank_after.saturating_sub(rank_before) as f64;
        let degrees = self.space.degrees - 3.0 * self.source.runs as f64 - rank_after as f64;
        if columns < 1.0 || degrees < 1.0 {
            return 1.0;
        }
        let independent = (degrees / self.setting.counted().as_one()).max(1.0);
        f_tail(
            (before - after) / columns / (after / degrees).max(self.floor) / inflation,
            columns,
            independent,
        )
    }

    /// By how much the tails of the noise and the readings' hanging together widen what is known of a part beside the rest: its columns with the
    /// rest and the runs' offsets taken out, the widest counts.
    fn inflation(&self, rest: &[Part], part: Part, level: usize) -> f64 {
        let tails = self.setting.tails;
        if self.setting.counted().is_none() {
            return tails;
        }
        let beside: Vec<Term> =
            self.library.model_columns(rest).into_iter().map(|c| self.library.terms[c]).collect();
        let own = &self.library.form(part).columns;
        let own: Vec<Term> = own.iter().map(|c| self.library.terms[*c]).collect();
        inflations(&beside, &own, self.space.rho(level), self.setting.counted(), self.source)
            .into_iter()
            .fold(tails, |most, serial| most.max(tails * serial))
    }

    /// Square that a model leaves without its last part and with it, where the runs differ by chance as much as is most
    /// likely: the ratios of the search lie far apart, and an effect that differs from run to run is judged by that alone.
    fn at_best_ratio(&self, with: &[Part], level: usize) -> (f64, f64) {
        let sub = self.space.gram.select(&self.library.model_columns(with));
        let whitened = sub.whitened(sub.best_rho(self.space.rho(level))).0;
        let squares = sub.squares();
        let own = self.library.positions(with, with.len() - 1);
        let left = |columns: std::ops::Range<usize>| {
            let columns: Vec<usize> = columns.collect();
            (whitened[(sub.terms.len(), sub.terms.len())] - explained(&whitened, &columns, &squares).0)
                .max(0.0)
        };
        (left(0..own.start), left(0..sub.terms.len()))
    }

    /// Share of what shows an effect that lies between the runs.
    fn between_runs(&self, part: Part, level: usize) -> f64 {
        let columns = self.space.columns(&self.library, &[part]);
        let information = |l: usize| -> f64 {
            columns
                .iter()
                .map(|c| self.space.products(l).product(*c, *c) / self.space.reference()[*c].max(1e-300))
                .sum()
        };
        let (here, free) = (information(level), information(FREE));
        if here > 0.0 { (1.0 - free / here).clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Degrees of freedom of the noise that an effect competes with: few where only the differences
    /// between runs show it (Satterthwaite's combination of within and between).
    fn effective_degrees(&self, share: f64, within: f64) -> f64 {
        let between = (self.source.runs as f64 - 2.0).max(1.0);
        1.0 / (share * share / between + (1.0 - share) * (1.0 - share) / within)
    }

    /// True where the last of `with` helps to predict lines left out.
    fn predicts(&self, with: &[Part], level: usize) -> bool {
        let columns = self.library.model_columns(with);
        let terms: Vec<Term> = columns.iter().map(|c| self.library.terms[*c]).collect();
        let nuisances = self.library.nuisances;
        let all: Vec<usize> = (0..terms.len() - nuisances).collect();
        let own = with.last().map_or(0, |p| self.library.form(*p).columns.len());
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
            let left = |parts: &[Part]| self.space.left(&self.library, parts, level).0;
            let weakest = (0..self.parts.len())
                .filter_map(|place| {
                    let rest = without(&self.parts, place);
                    let with: Vec<Part> = rest.iter().copied().chain([self.parts[place]]).collect();
                    let share = self.share(&with, level);
                    let most_of_rest = || {
                        let without = left(&rest);
                        let kind = self.library.kind(self.parts[place]);
                        is_most_of_rest(kind, without - left(&self.parts), without)
                    };
                    let stays = share < LEAST_SHARE
                        && (self.library.completes(self.parts[place], &rest) || most_of_rest());
                    (!stays).then_some((share, rest))
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

/// True where an effect explains most of the square that the others leave: however little that is of all, who has corrected
/// those is left with it. Where a moment or a place was searched for it must earn its share of all.
fn is_most_of_rest(kind: EffectKind, gain: f64, before: f64) -> bool {
    const MOST: f64 = 0.5;
    let searched = [EffectKind::Step, EffectKind::Local, EffectKind::Joint, EffectKind::Spike];
    gain >= MOST * before && !kind.axis().is_some_and(|axis| searched.iter().any(|of| of(axis) == kind))
}

/// An effect and its non-linear numbers.
fn shape(library: &Library, part: Part) -> Option<(EffectKind, Shape)> {
    match library.terms[*library.form(part).columns.first()?] {
        Term::Effect { kind, shape, .. } => Some((kind, shape)),
        _ => None,
    }
}

/// Why a knock or a damage cannot be told: hardly a row lies on the other side of the one, hardly a place in the other.
pub(crate) fn unsupported(library: &Library, part: Part, rows: &[Row]) -> Option<Why> {
    let beside = |moment: &dyn Fn(&Row) -> Option<f64>, knock: f64| {
        let moments = || rows.iter().filter_map(moment);
        let before = moments().filter(|moment| *moment < knock).count();
        (before.min(moments().count() - before) < STEP_ROWS).then_some([
            "so few rows lie on one side of the knock that they could be blunders",
            "по одну сторону скачка так мало строк, что это могут быть промахи",
        ])
    };
    if let Term::Knock { from, .. } = library.terms[*library.form(part).columns.first()?] {
        // What lies between runs is their shift: within its own it must be seen.
        let run = rows.iter().find(|row| row.order[0] >= from).map(|row| row.run);
        return beside(&|row| Some(row.order[0]).filter(|_| Some(row.run) == run), from);
    }
    match shape(library, part)? {
        (EffectKind::Step(_), shape) => beside(&|row| row.conditions.time_s, shape.time_s),
        (EffectKind::Local(axis), shape) => {
            let places = rows.iter().map(|row| row.command.linear_mm[axis]);
            let mut inside: Vec<f64> =
                places.filter(|q| (q - shape.centre_mm).abs() < 0.5 * shape.width_mm).collect();
            inside.sort_by(f64::total_cmp);
            inside.dedup();
            (inside.len() < LOCAL_PLACES).then_some([
                "so few places lie in the damage that they could be anything",
                "в месте износа так мало измеренных точек, что это может быть что угодно",
            ])
        }
        _ => None,
    }
}
