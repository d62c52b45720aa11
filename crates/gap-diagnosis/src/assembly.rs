//! One solved model as an answer: shares, verdict, causes in order.

use std::cell::OnceCell;

use machine_model::effects::EffectKind;

use crate::align::{FREE_OFFSETS, aligned, rms, row_lengths};
use crate::crossval::Folds;
use crate::diagnose::Options;
use crate::diagnosis::{Cause, Diagnosis, Gap, Leftover, Lookalike, Verdict};
use crate::engine::{Explained, f_tail};
use crate::library::Library;
use crate::linear::Products;
use crate::locate::places;
use crate::noise::{Noise, NoiseSource, estimate};
use crate::observation::{Measurements, Scalar};
use crate::remedy::remedy;
use crate::rivals::{Rival, rivals};
use crate::search::without;
use crate::space::Part;
use crate::term::Term;
use crate::verdict::{Evidence, Unseen, verdict};

/// Readings that keep more than this of the one before are no noise that a verdict of NO GAP could rest on.
const SLOW_PHI: f64 = 0.5;

/// A solved model and what is needed to speak about it.
pub(crate) struct Assembly<'a> {
    pub(crate) data: &'a Measurements,
    pub(crate) model: &'a Explained,
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
        let noise = estimate(&data.rows, &model.scalars, &model.solution.residuals_um, model.phi);
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
        let free = crate::space::RHO_GRID.len() - 1;
        self.model.parts.iter().any(|part| {
            let columns = space.columns(library, &[*part]);
            let information =
                |level: usize| columns.iter().map(|c| space.products(level).product(*c, *c)).sum::<f64>();
            information(free) < WITHIN * information(0)
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
        positions(&self.model.library, &self.model.parts, place)
    }

    /// Columns of the measuring frame of some rows: six, and angles of every run where the runs are turned.
    pub(crate) fn frame(&self, data: &Measurements) -> Vec<Term> {
        crate::library::frame(data, self.model.turned)
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

    /// The answer. `kept_back` says what runs that a second search did not see make of its forecast; it is asked where
    /// there is a name and no hold-out.
    pub(crate) fn diagnosis(
        &self,
        holdout: Option<&Measurements>,
        options: &Options,
        kept_back: impl FnOnce() -> Option<Unseen>,
    ) -> Diagnosis {
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
        let after = causes.last().map_or(gap_rms, |c| c.rms_after_um);
        let mut evidence = Evidence {
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
            slow: self.noise.is_some_and(|n| n.is_slow()) || model.caution > SLOW_PHI,
            trifling: gap_rms - after < crate::verdict::WORTH_NAMING * gap_rms,
            unseen: None,
        };
        let held = holdout.map(|h| self.holdout(h));
        let believed = matches!(verdict(&evidence), Verdict::Named | Verdict::Ambiguous);
        evidence.unseen = match (holdout, &held) {
            (Some(data), Some(held)) => {
                let promised = causes.last().map(|c| c.shrink_predicted);
                Some(self.unseen(data, held.rms_before_um, held.rms_after_um, promised))
            }
            _ if believed => kept_back(),
            _ => None,
        };
        // Below the step of the control no correction is possible and no cause is worth a name.
        let fine = gap_rms * 12.0_f64.sqrt() < options.resolution_um;
        let causes = if fine { Vec::new() } else { causes };
        let verdict = if fine { Verdict::NoGap } else { verdict(&evidence) };
        let mut notes = self.notes();
        notes.extend(evidence.unseen.filter(|_| holdout.is_none()).and_then(|u| u.kept_back_note()));
        notes.extend(holdout.iter().flat_map(|h| self.forecast_notes(h, &causes)));
        let formulas = match verdict {
            Verdict::Unknown | Verdict::Partial => crate::formula::formulas(self.data, &model.scalars),
            _ => Vec::new(),
        };
        notes.extend(formulas.iter().map(|f| format!("{} ({}).", f.words, f.text)));
        let sigma_um = self.noise_variance().sqrt();
        let next_measurement = crate::next::next_measurement(self.data, model, self.worst_pair(), sigma_um)
            .or_else(|| {
                let nameless = matches!(verdict, Verdict::Unknown | Verdict::Partial);
                nameless.then(|| crate::next::once_more(self.data)).flatten()
            });
        let unsure = verdict == Verdict::Underpowered && !causes.is_empty();
        let sentence = if unsure {
            notes.extend(causes.iter().map(seen_but_unsure));
            format!(
                "These rows cannot carry a correction: what they show is uncertain by {corner_um:.1} um in the far corner, and the gap itself is {gap_rms:.1} um RMS."
            )
        } else {
            let refuted = evidence.unseen.and_then(|u| u.refutation(!causes.is_empty()));
            crate::sentence::sentence(verdict, &gap, &causes, &leftover) + &refuted.unwrap_or_default()
        };
        let mut causes = if verdict == Verdict::Underpowered { Vec::new() } else { causes };
        if matches!(verdict, Verdict::Partial | Verdict::Unknown) {
            causes.iter_mut().for_each(|c| c.remedy = crate::words::DO_NOT_ACT);
        }
        let holdout = held.filter(|_| !unsure);
        Diagnosis {
            verdict,
            sentence,
            gap,
            places: places(self.data, &model.scalars, &before, self.noise_variance(), options.seed),
            next_measurement,
            causes,
            setup: self.setup(),
            leftover,
            holdout,
            outlier_lines: model.outliers.iter().map(|r| self.data.rows[*r].line).collect(),
            detectable: self.detectable(),
            formulas,
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
        let stated = self.data.rows.iter().any(|r| r.u_um.iter().any(Option::is_some));
        stated.then(|| self.variance().sqrt() / self.data.typical_uncertainty_um())
    }

    pub(crate) fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        match self.noise {
            Some(Noise { source: NoiseSource::Neighbours, .. }) => notes.push(
                "No command was measured twice in a run: the noise is estimated from neighbouring rows, and a gap finer than their distance counts as noise.".to_owned(),
            ),
            Some(Noise { source: NoiseSource::Returns, .. }) => notes.push(
                "No command was measured twice in a run: the noise is estimated from what the same commands read in other runs, for neighbouring rows differ by far more.".to_owned(),
            ),
            Some(Noise { source: NoiseSource::Forms, .. }) => notes.push(
                "No command was measured twice in a run: the noise is what a form of second degree leaves of each run, for rows measured one after the other differ by far more.".to_owned(),
            ),
            None => notes.push("There are neither repeats nor neighbours to tell noise from gap.".to_owned()),
            Some(noise) if noise.is_slow() => notes.push(format!(
                "Repeats of one command scatter {:.1} times as much as neighbouring readings: something changes between the passes (temperature, machine or instrument), and the repeats' scatter is not noise alone.",
                noise.slow
            )),
            Some(_) => {}
        }
        if self.model.caution > 0.0 {
            notes.push(format!(
                "Neighbouring readings hang together (correlation {:.2} from one to the next): intervals and tests count them as {:.0} % of as many independent ones.",
                self.model.caution,
                100.0 * (1.0 - self.model.caution) / (1.0 + self.model.caution)
            ));
        }
        notes.extend(self.setup_notes());
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

    /// What the set-up holds that its reader should know.
    fn setup_notes(&self) -> Vec<String> {
        let setup = self.setup();
        let mut notes = Vec::new();
        if self.model.turned {
            let turns = || setup.run_rotations_urad.iter().flat_map(|(_, turn)| turn.iter().copied());
            let (low, high) =
                turns().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            notes.push(format!(
                "The runs are turned against each other by up to {:.0} urad: every run has a set-up of its own (clamping), and that is taken out of the gap.",
                high - low
            ));
        }
        for (instrument, zeros) in &setup.instruments_um {
            let axis = (0..3).max_by(|a, b| zeros[*a].0.abs().total_cmp(&zeros[*b].0.abs())).unwrap_or(0);
            let (value, u95) = zeros[axis];
            if value.abs() > u95 && value.abs() > 2.0 * self.noise_variance().sqrt() {
                let name = |i: usize| self.data.instruments.get(i).map_or("?", String::as_str);
                notes.push(format!(
                    "The instruments {} and {} disagree by {:.1} ± {u95:.1} um in {}: taken out as set-up; which of them is right these rows do not say.",
                    name(0),
                    name(*instrument),
                    value.abs(),
                    ["X", "Y", "Z"][axis]
                ));
            }
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
                    words: self.words(ranked.place),
                    parameters: self.parameters(ranked.place),
                    share_unique: ranked.unique,
                    share_alone: ranked.alone,
                    p: ranked.p,
                    cannot_be_told_from: self.told(ranked),
                    nearest: ranked.nearest(),
                    rms_before_um,
                    rms_after_um,
                    shrink_predicted: self.shrink(index + 1, holdout),
                    remedy: match (kind, self.own(ranked.place).first()) {
                        (EffectKind::Backlash(_), Some((_, half_width))) if *half_width < 0.0 => {
                            crate::words::NO_PLAY
                        }
                        _ => remedy(kind),
                    },
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
