//! One solved model as an answer: shares, verdict, causes in order.

use std::cell::OnceCell;

use machine_model::effects::EffectKind;

use crate::align::{aligned, rms, row_lengths};
use crate::crossval::Folds;
use crate::diagnose::Options;
use crate::diagnosis::{Cause, Diagnosis, Gap, Leftover, Lookalike, Verdict};
use crate::engine::{Explained, f_tail};
use crate::library::Library;
use crate::locate::places;
use crate::noise::{Noise, NoiseSource, estimate};
use crate::observation::{Measurements, Scalar};
use crate::remedy::remedy;
use crate::rivals::{Rival, rivals};
use crate::search::without;
use crate::space::Part;
use crate::term::Term;
use crate::verdict::{Evidence, verdict};

/// A solved model and what is needed to speak about it.
pub(crate) struct Assembly<'a> {
    pub(crate) data: &'a Measurements,
    pub(crate) model: &'a Explained,
    pub(crate) noise: Option<Noise>,
    /// Parts in order of share, with their shares.
    pub(crate) ordered: Vec<Ranked>,
    /// Products of left-out runs with the columns in that order, made when a forecast asks for them.
    pub(crate) folds: OnceCell<Folds>,
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
    fn nearest(&self) -> Vec<Lookalike> {
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
    pub(crate) fn new(data: &'a Measurements, model: &'a Explained) -> Self {
        let noise = estimate(&data.rows, &model.scalars, &model.solution.residuals_um);
        let mut assembly = Self { data, model, noise, ordered: Vec::new(), folds: OnceCell::new() };
        assembly.ordered = assembly.rank();
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
        positions(&self.model.library, &self.model.parts, place)
    }

    /// Columns of the measuring frame: the first six.
    pub(crate) fn set_up_terms(&self) -> &[Term] {
        self.model.solution.terms.split_at(6).0
    }

    /// What is neither frame nor cause and is known from the fit: the bar's length, unknown approaches.
    pub(crate) fn instrument(&self) -> Vec<(Term, f64)> {
        let solution = &self.model.solution;
        (6..self.model.library.nuisances).map(|i| (solution.terms[i], solution.coefficients[i])).collect()
    }

    /// The gap of some rows, aligned, with the first causes taken off.
    pub(crate) fn gap(&self, data: &Measurements, scalars: &[Scalar], count: usize) -> Vec<f64> {
        let mut off = self.instrument();
        off.extend(self.taken_off(count));
        aligned(data, scalars, self.set_up_terms(), &off)
    }

    pub(crate) fn gap_after(&self, count: usize) -> Vec<f64> {
        self.gap(self.data, &self.model.scalars, count)
    }

    pub(crate) fn diagnosis(&self, holdout: Option<&Measurements>, options: &Options) -> Diagnosis {
        let model = self.model;
        let before = self.gap_after(0);
        let mut lengths = row_lengths(&model.scalars, &before);
        let gap_rms = rms(&lengths);
        lengths.sort_by(f64::total_cmp);
        let quantile =
            |q: f64| lengths.get(((lengths.len() as f64 - 1.0) * q).round() as usize).copied().unwrap_or(0.0);
        let gap = Gap {
            rows: lengths.len(),
            rms_um: gap_rms,
            p95_um: quantile(0.95),
            max_um: quantile(1.0),
            noise_um: self.noise_variance().sqrt(),
        };
        let leftover = self.leftover();
        let causes = self.causes(holdout, gap_rms);
        let corner_um = self.uncertainty_in_corners_um(options.volume);
        let evidence = Evidence {
            degrees: model.space.degrees,
            runs: self.data.runs.len(),
            visible: model.library.candidates.len(),
            causes: causes.len(),
            instrument_causes: causes.iter().filter(|c| c.term.kind().is_instrument()).count(),
            ambiguous: self.ordered.iter().any(|r| !self.told(r).is_empty()),
            phi: leftover.phi,
            lack_of_fit_p: leftover.lack_of_fit_p,
            noise_ratio: self.noise_ratio(),
            carries: corner_um <= gap_rms,
        };
        let verdict = verdict(&evidence);
        let mut notes = self.notes();
        notes.extend(holdout.iter().flat_map(|h| self.forecast_notes(h, &causes)));
        let unsure = verdict == Verdict::Underpowered && !causes.is_empty();
        let sentence = if unsure {
            notes.extend(causes.iter().map(seen_but_unsure));
            format!(
                "These rows cannot carry a correction: what they show is uncertain by {corner_um:.1} um in the far corner, and the gap itself is {gap_rms:.1} um RMS."
            )
        } else {
            crate::sentence::sentence(verdict, &gap, &causes, &leftover)
        };
        let causes = if verdict == Verdict::Underpowered { Vec::new() } else { causes };
        let holdout = holdout.filter(|_| !unsure).map(|h| self.holdout(h));
        Diagnosis {
            verdict,
            sentence,
            gap,
            places: places(self.data, &model.scalars, &before, self.noise_variance(), options.seed),
            next_measurement: crate::next::next_measurement(
                self.data,
                model,
                self.worst_pair(),
                self.noise_variance().sqrt(),
            ),
            causes,
            setup: self.setup(),
            leftover,
            holdout,
            outlier_lines: model.outliers.iter().map(|r| self.data.rows[*r].line).collect(),
            detectable: self.detectable(),
            notes,
            residuals: crate::unseen::residuals(&model.scalars, &before, &self.gap_after(self.ordered.len())),
        }
    }

    /// The cause and its rival that most need to be told apart.
    pub(crate) fn worst_pair(&self) -> Option<(usize, Part)> {
        self.ordered.iter().find_map(|r| r.told().next().map(|rival| (r.place, rival.part)))
    }

    /// Names of what cannot be told from a cause.
    pub(crate) fn told(&self, ranked: &Ranked) -> Vec<String> {
        let named: Vec<EffectKind> =
            self.ordered.iter().map(|r| self.model.library.candidates[r.part.candidate].kind).collect();
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
        let stated = self.data.rows.iter().any(|r| r.u_um.is_some());
        stated.then(|| self.variance().sqrt() / self.data.typical_uncertainty_um())
    }

    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        match self.noise {
            Some(Noise { source: NoiseSource::Neighbours, .. }) => notes.push(
                "No command was measured twice in a run: the noise is estimated from neighbouring rows, and a gap finer than their distance counts as noise.".to_owned(),
            ),
            None => notes.push("There are neither repeats nor neighbours to tell noise from gap.".to_owned()),
            Some(_) => {}
        }
        if let Some(ratio) = self.noise_ratio().filter(|r| !(1.0 / 1.6..=1.6).contains(r)) {
            notes.push(format!(
                "The scatter of the rows is {ratio:.2} times what u_um says; the rows' own scatter was used."
            ));
        }
        if let Some(refused) = &self.model.refused {
            notes.push(format!("{} was considered next and not named: {}.", refused.kind, refused.reason));
        }
        notes
    }

    pub(crate) fn leftover(&self) -> Leftover {
        let model = self.model;
        let noise = self.noise_variance();
        let total = model.space.total(model.fit.level) / model.space.degrees;
        let phi = ((self.variance() - noise) / (total - noise).max(1e-12)).clamp(0.0, 1.0);
        let lack_of_fit_p = crate::structure::lack_of_fit(
            &self.data.rows,
            &model.scalars,
            &model.solution.residuals_um,
            self.noise,
            self.degrees(),
        );
        let lengths = row_lengths(&model.scalars, &self.gap_after(self.ordered.len()));
        let correlates_with = if lack_of_fit_p < crate::verdict::LACK_OF_FIT {
            crate::structure::correlates(self.data, &model.scalars, &model.solution.residuals_um)
        } else {
            Vec::new()
        };
        let absorber = model.refused.as_ref().map(|r| {
            format!("{} would absorb {:.0} % of what is left ({})", r.kind, 100.0 * r.share, r.reason)
        });
        Leftover { rms_um: rms(&lengths), phi, lack_of_fit_p, correlates_with, absorber }
    }

    pub(crate) fn causes(&self, holdout: Option<&Measurements>, gap_rms: f64) -> Vec<Cause> {
        let mut rms_before_um = gap_rms;
        (0..self.ordered.len())
            .map(|index| {
                let ranked = &self.ordered[index];
                let kind = self.model.library.candidates[ranked.part.candidate].kind;
                let after = row_lengths(&self.model.scalars, &self.gap_after(index + 1));
                let rms_after_um = rms(&after);
                let cause = Cause {
                    term: self.term(ranked.place),
                    effect: kind.to_string(),
                    parameters: self.parameters(ranked.place),
                    share_unique: ranked.unique,
                    share_alone: ranked.alone,
                    p: ranked.p,
                    cannot_be_told_from: self.told(ranked),
                    nearest: ranked.nearest(),
                    rms_before_um,
                    rms_after_um,
                    shrink_predicted: self.shrink(index + 1, holdout),
                    remedy: remedy(kind),
                };
                rms_before_um = rms_after_um;
                cause
            })
            .collect()
    }
}

/// Positions of a part's columns among those of a model, the set-up's first.
pub(crate) fn positions(library: &Library, parts: &[Part], place: usize) -> std::ops::Range<usize> {
    let length = |p: &Part| library.candidates[p.candidate].variants[p.variant].columns.len();
    let start = library.nuisances + parts.iter().take(place).map(length).sum::<usize>();
    start..start + length(&parts[place])
}

/// What a file that cannot carry a correction hints at.
fn seen_but_unsure(cause: &Cause) -> String {
    let first = cause.parameters.first().map_or_else(String::new, |p| {
        format!(" ({} = {:.1} ± {:.1})", p.name, p.value, p.u95.unwrap_or_default())
    });
    format!("Hinted at, too uncertain to be used: {}{first}.", cause.effect)
}
