//! One solved model as an answer: shares, verdict, causes in order.

use diagnostic::both;
use std::cell::OnceCell;

use machine_model::effects::EffectKind;

use crate::equations::align::{FREE_OFFSETS, aligned, rms, row_lengths};
use crate::equations::f_test::f_tail;
use crate::equations::linear::Products;
use crate::equations::noise::{Noise, NoiseSource, bound, estimate, neighbours_are_far};
use crate::equations::observation::{Measurements, Scalar};
use crate::equations::set_up::frame;
use crate::equations::term::Term;
use crate::judgement::answer::{Cause, Gap, Leftover, Lookalike};
use crate::judgement::rivals::{Rival, rivals};
use crate::judgement::structure::{correlates, lack_of_fit};
use crate::judgement::verdict::{Evidence, LACK_OF_FIT, NOISE_FACTOR, WORTH_NAMING};
use crate::library::candidates::Part;
use crate::search::crossval::Folds;
use crate::search::explanation::Explanation;
use crate::search::moves::without;
use crate::search::space::FREE;

/// Readings that keep more than this of the one before are no noise that a verdict of NO GAP could rest on.
const SLOW_PHI: f64 = 0.5;

/// True for causes of which the first leave more than there was: the others take off what they put on.
fn cancel(causes: &[Cause], gap_um: f64) -> bool {
    /// What two or three causes may leave on their way, by chance, as a factor of the gap.
    const MORE: f64 = 1.1;
    causes.iter().any(|cause| cause.rms_after_um > MORE * gap_um)
}

/// A solved model and what is needed to speak about it.
pub(crate) struct Assembly<'a> {
    pub(crate) data: &'a Measurements,
    pub(crate) model: &'a Explanation,
    pub(crate) noise: Option<Noise>,
    /// Parts in order of share, with their shares.
    pub(crate) ordered: Vec<Ranked>,
    /// Products of left-out runs with the columns in that order, made when a forecast asks for them.
    pub(crate) folds: OnceCell<Folds>,
    /// Variance of the runs' own offsets over the noise's that an alignment takes out: any, or none where a cause shows
    /// between the runs alone.
    pub(crate) alignment: f64,
}

pub(crate) struct Ranked {
    pub(crate) place: usize,
    pub(crate) part: Part,
    pub(crate) unique: f64,
    pub(crate) alone: f64,
    pub(crate) p: f64,
    pub(crate) rivals: Vec<Rival>,
}

impl Ranked {
    /// Rivals that the data cannot tell from it.
    pub(crate) fn told(&self) -> impl Iterator<Item = &Rival> {
        self.rivals.iter().filter(|r| r.cannot_be_told())
    }

    /// The most similar effects, for the confounding matrix.
    pub(crate) fn nearest(&self) -> Vec<Lookalike> {
        let mut all: Vec<&Rival> = self.rivals.iter().collect();
        all.sort_by(|a, b| b.correlation.total_cmp(&a.correlation));
        let told: Vec<&Rival> = self.told().collect();
        let first = told.iter().copied();
        let rest = all.into_iter().filter(|r| !told.contains(r)).take(6);
        first
            .chain(rest)
            .map(|r| Lookalike { effect: r.kind.to_string(), correlation: r.correlation, behind: r.behind })
            .collect()
    }
}

impl<'a> Assembly<'a> {
    pub(crate) fn new(data: &'a Measurements, model: &'a Explanation) -> Self {
        let noise = estimate(&data.rows, &model.scalars, &model.solution.residuals_um, model.serial);
        let (ordered, folds, alignment) = (Vec::new(), OnceCell::new(), FREE_OFFSETS);
        let mut assembly = Self { data, model, noise, ordered, folds, alignment };
        assembly.ordered = assembly.rank();
        if assembly.between_runs() {
            assembly.alignment = 0.0;
        }
        assembly
    }

    pub(crate) fn degrees(&self) -> f64 {
        (self.model.space.degrees - self.model.fit.rank as f64).max(1.0)
    }

    /// Variance of the residual, µm².
    pub(crate) fn variance(&self) -> f64 {
        self.model.solution.residual_square / self.degrees()
    }

    /// Variance of the noise alone: never more than what is left.
    pub(crate) fn noise_variance(&self) -> f64 {
        self.noise.map_or(self.variance(), |n| n.variance.min(self.variance()))
    }

    /// True where a cause shows as the difference of runs (a load, a temperature, a tool that is one number per run): with
    /// free offsets of the runs there would be neither gap nor gain.
    fn between_runs(&self) -> bool {
        /// Share of its information that lies within the runs.
        const WITHIN: f64 = 0.02;
        let (space, library) = (&self.model.space, &self.model.library);
        self.model.parts.iter().any(|part| {
            let columns = space.columns(library, &[*part]);
            let information =
                |level: usize| columns.iter().map(|c| space.products(level).product(*c, *c)).sum::<f64>();
            information(FREE) < WITHIN * information(0)
        })
    }

    /// Variance of an aligned reading without gap over that of the noise: offsets that are not taken out stay.
    pub(crate) fn unaligned(&self) -> f64 {
        if self.alignment > 0.0 { 1.0 } else { 1.0 + self.model.solution.rho }
    }

    pub(crate) fn square(&self, parts: &[Part]) -> (f64, usize) {
        self.model.space.left(&self.model.library, parts, self.model.fit.level)
    }

    pub(crate) fn rank(&self) -> Vec<Ranked> {
        let model = self.model;
        let (full, full_rank) = self.square(&model.parts);
        let total = model.space.total(model.fit.level);
        let reducible = (total - self.noise_variance() * model.space.degrees).max(1e-12);
        let mut ranked: Vec<Ranked> = model
            .parts
            .iter()
            .enumerate()
            .map(|(place, part)| {
                let (rest, rest_rank) = self.square(&without(&model.parts, place));
                let (alone, _) = self.square(&[*part]);
                let columns = (full_rank.saturating_sub(rest_rank)).max(1) as f64;
                let ratio = (rest - full) / columns / (full / self.degrees()).max(1e-12);
                let questions = model.library.questions(part.candidate);
                let p = (f_tail(ratio, columns, self.degrees()) * questions).min(1.0);
                let share = |gain: f64| (gain / reducible).clamp(0.0, 1.0);
                let (unique, alone) = (share(rest - full), share(total - alone));
                Ranked {
                    place,
                    part: *part,
                    unique: unique.min(alone),
                    alone: unique.max(alone),
                    p,
                    rivals: rivals(model, place),
                }
            })
            .collect();
        ranked.sort_by(|a, b| (b.unique + b.alone).total_cmp(&(a.unique + a.alone)));
        ranked
    }

    /// Terms and values of the first `count` causes, or of all.
    pub(crate) fn taken_off(&self, count: usize) -> Vec<(Term, f64)> {
        self.ordered.iter().take(count).flat_map(|r| self.own(r.place)).collect()
    }

    /// Terms and values of one part.
    pub(crate) fn own(&self, place: usize) -> Vec<(Term, f64)> {
        self.positions(place)
            .map(|i| (self.model.solution.terms[i], self.model.solution.coefficients[i]))
            .collect()
    }

    /// Positions of a part's columns in the solution.
    pub(crate) fn positions(&self, place: usize) -> std::ops::Range<usize> {
        self.model.library.positions(&self.model.parts, place)
    }

    /// Columns of the measuring frame of some rows: six, and angles of every run where the runs are turned.
    pub(crate) fn frame(&self, data: &Measurements) -> Vec<Term> {
        frame(data, self.model.clamping)
    }

    /// What is neither frame nor cause and is known from the fit: the bar's length, unknown approaches, instruments' zeros.
    pub(crate) fn instrument(&self) -> Vec<(Term, f64)> {
        let solution = &self.model.solution;
        let library = &self.model.library;
        (library.framing..library.nuisances).map(|i| (solution.terms[i], solution.coefficients[i])).collect()
    }

    /// The gap of some rows, aligned, with the first causes taken off.
    pub(crate) fn gap(&self, data: &Measurements, scalars: &[Scalar], count: usize) -> Vec<f64> {
        let mut off = self.instrument();
        off.extend(self.taken_off(count));
        aligned(data, scalars, &self.frame(data), self.alignment, &off)
    }

    pub(crate) fn gap_after(&self, count: usize) -> Vec<f64> {
        self.gap(self.data, &self.model.scalars, count)
    }

    /// Size of the gap that is left of every equation, by rows.
    pub(crate) fn size(&self, gap_um: &[f64]) -> Gap {
        Gap::new(row_lengths(&self.model.scalars, gap_um), self.noise_variance().sqrt())
    }

    /// What the verdict depends on, unseen rows not yet asked.
    pub(crate) fn evidence(&self, gap: &Gap, leftover: &Leftover, causes: &[Cause]) -> Evidence {
        let model = self.model;
        let after_um = causes.last().map_or(gap.rms_um, |c| c.rms_after_um);
        Evidence {
            degrees: model.space.degrees,
            one_run: self.data.is_one_run(),
            visible: model.library.candidates.len(),
            causes: causes.len(),
            instrument_causes: causes.iter().filter(|c| c.is_instrument()).count(),
            ambiguous: self.ordered.iter().any(|r| !self.told(r).is_empty()),
            phi: leftover.phi,
            lack_of_fit_p: leftover.lack_of_fit_p,
            noise_ratio: self.noise_ratio(),
            slow: self.noise.is_some_and(|n| n.is_slow()) || model.caution.lag(1) > SLOW_PHI,
            exceeds: self.exceeds_noise(),
            guessed: self.noise_is_guessed() || self.is_all_clear_of_one_run(),
            trifling: gap.rms_um - after_um < WORTH_NAMING * gap.rms_um,
            cancels: cancel(causes, gap.rms_um),
            risks: causes.iter().any(Cause::is_turned_play),
            unseen: None,
        }
    }

    /// True where nothing says how much of the scatter is noise: no repeats, no statement, and neighbours too far apart.
    fn noise_is_guessed(&self) -> bool {
        let (rows, model) = (&self.data.rows, self.model);
        let repeated = self.noise.is_some_and(|noise| noise.source == NoiseSource::Repeats)
            || bound(rows, &model.scalars, &model.solution.residuals_um).is_some();
        !repeated && self.noise_ratio().is_none() && neighbours_are_far(rows)
    }

    /// True of one run in which nothing was found and nothing came back: neighbours of a mesh differ by what it shows.
    fn is_all_clear_of_one_run(&self) -> bool {
        let by_neighbours = self.noise.is_none_or(|noise| noise.source == NoiseSource::Neighbours);
        self.ordered.is_empty() && self.data.runs.len() < 2 && by_neighbours
    }

    /// True where the rows scatter by far more than the noise that was found, or than the same commands do in other runs, which
    /// no noise exceeds: three cycles over five places prove no structure, and agree with nothing.
    fn exceeds_noise(&self) -> bool {
        /// Level of the test.
        const LEVEL: f64 = 0.05;
        let (rows, model) = (&self.data.rows, self.model);
        let returns = bound(rows, &model.scalars, &model.solution.residuals_um);
        self.noise.iter().chain(&returns).any(|noise| {
            let ratio = self.variance() / noise.variance.max(1e-12);
            ratio > NOISE_FACTOR * NOISE_FACTOR && f_tail(ratio, self.degrees(), noise.degrees) < LEVEL
        })
    }

    /// The first cause that cannot be told from others, and these, the nearest first.
    pub(crate) fn open(&self) -> Option<(usize, Vec<Part>)> {
        let rivals = |r: &Ranked| r.told().map(|rival| rival.part).collect::<Vec<Part>>();
        self.ordered.iter().map(|r| (r.place, rivals(r))).find(|(_, rivals)| !rivals.is_empty())
    }

    /// Names of what cannot be told from a cause.
    pub(crate) fn told(&self, ranked: &Ranked) -> Vec<String> {
        let named: Vec<EffectKind> = self.ordered.iter().map(|r| self.model.library.kind(r.part)).collect();
        let mut kinds: Vec<EffectKind> = ranked.told().map(|r| r.kind).collect();
        if self.ordered.first().is_some_and(|first| first.place == ranked.place) {
            kinds.extend(&self.model.equally_good);
        }
        let mut seen: Vec<EffectKind> = Vec::new();
        kinds.retain(|k| {
            !named.contains(k) && !seen.contains(k) && {
                seen.push(*k);
                true
            }
        });
        kinds.iter().map(ToString::to_string).collect()
    }

    pub(crate) fn noise_ratio(&self) -> Option<f64> {
        let stated = self.data.rows.iter().any(|r| r.u_um.iter().any(Option::is_some));
        stated.then(|| self.variance().sqrt() / self.data.typical_uncertainty_um())
    }

    pub(crate) fn leftover(&self) -> Leftover {
        let model = self.model;
        let noise = if self.noise_is_guessed() { 0.0 } else { self.noise_variance() };
        let total = model.space.total(model.fit.level) / model.space.degrees;
        let phi = ((self.variance() - noise) / (total - noise).max(1e-12)).clamp(0.0, 1.0);
        let lack_of_fit_p = lack_of_fit(
            &self.data.rows,
            &model.scalars,
            &model.solution.residuals_um,
            self.noise,
            self.degrees(),
        );
        let lengths = row_lengths(&model.scalars, &self.gap_after(self.ordered.len()));
        let correlates_with = if lack_of_fit_p < LACK_OF_FIT {
            correlates(self.data, &model.scalars, &model.solution.residuals_um)
        } else {
            Vec::new()
        };
        let absorber = model.refused.as_ref().map(|r| {
            let (kind, share, reason) = (r.kind, 100.0 * r.share, r.reason.words());
            both!(
                "{kind} would absorb {share:.0} % of what is left ({reason})",
                "{kind} поглотил бы {share:.0} % остатка ({reason:#})"
            )
        });
        Leftover { rms_um: rms(&lengths), phi, lack_of_fit_p, correlates_with, absorber }
    }
}
