//! The whole diagnosis of one file.

use machine_model::effects::{EffectKind, EffectTerm, Shape};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::align::{FREE_OFFSETS, aligned, magnitude_errors, rms, row_lengths};
use crate::crossval::{Folding, Folds};
use crate::diagnosis::{
    Cause, Detectable, Diagnosis, Gap, Holdout, Leftover, Lookalike, Parameter, Setup, Shrinkage, Verdict,
};
use crate::engine::{Explained, f_tail, model_columns, source};
use crate::gram::Gram;
use crate::linear::explained;
use crate::locate::places;
use crate::noise::{Noise, NoiseSource, estimate, tail_factor};
use crate::observation::{Measurements, Scalar};
use crate::remedy::remedy;
use crate::rivals::{Rival, rivals};
use crate::search::{Part, without};
use crate::shrinkage::{Strength, transported};
use crate::term::Term;
use crate::verdict::{Evidence, verdict};

/// What can be asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Effects taken out of the library.
    pub without: Vec<EffectKind>,
    /// Seed of every random relabelling.
    pub seed: u64,
}

/// Diagnoses the gap between `data` and the model that predicted its rows; `holdout` is never fitted.
#[must_use]
pub fn diagnose(data: &Measurements, holdout: Option<&Measurements>, options: &Options) -> Diagnosis {
    if let Some(answer) = too_little(data, &crate::magnitude::first_equations(data)) {
        return answer;
    }
    let (model, magnitude_notes) = crate::magnitude::explained(data, &options.without);
    let mut answer = Assembly::new(data, &model).diagnosis(holdout, options);
    answer.notes.extend(magnitude_notes);
    answer
}

/// Files that cannot carry any statement.
fn too_little(data: &Measurements, scalars: &[Scalar]) -> Option<Diagnosis> {
    let mut missing = Vec::new();
    let runs = data.runs.len();
    if scalars.len() < 24 {
        missing.push(format!(
            "{} readings, at least 24 are needed beside the six set-up parameters",
            scalars.len()
        ));
    }
    if runs < 2 {
        missing.push(format!("{runs} run: what is set-up and what is machine cannot be told; measure at least two lines with a run id each"));
    }
    if (0..3).all(|a| data.range_mm(a).1 - data.range_mm(a).0 < 1e-6) && !data.geometry.moves_rotary(data) {
        missing.push("no axis moves in this file".to_owned());
    }
    let first = scalars.first().map(|s| s.gap_um);
    if scalars.iter().all(|s| Some(s.gap_um) == first) {
        missing.push("every reading is the same number".to_owned());
    }
    (!missing.is_empty()).then(|| underpowered(data.rows.len(), missing))
}

/// The verdict UNDERPOWERED with what is missing.
#[must_use]
pub fn underpowered(rows: usize, missing: Vec<String>) -> Diagnosis {
    Diagnosis {
        verdict: Verdict::Underpowered,
        sentence: format!("Too little was measured: {}.", missing.join("; ")),
        gap: Gap { rows, ..Gap::default() },
        places: Vec::new(),
        causes: Vec::new(),
        setup: Setup::default(),
        leftover: Leftover::default(),
        holdout: None,
        next_measurement: None,
        outlier_lines: Vec::new(),
        detectable: Vec::new(),
        notes: missing,
    }
}

trait MovesRotary {
    fn moves_rotary(&self, data: &Measurements) -> bool;
}

impl MovesRotary for machine_model::effects::EffectGeometry {
    fn moves_rotary(&self, data: &Measurements) -> bool {
        let first = data.rows.first().map(|r| r.command.rotary_rad);
        data.rows.iter().any(|r| Some(r.command.rotary_rad) != first)
    }
}

struct Assembly<'a> {
    data: &'a Measurements,
    model: &'a Explained,
    noise: Option<Noise>,
    /// Parts in order of share, with their shares.
    ordered: Vec<Ranked>,
}

struct Ranked {
    place: usize,
    part: Part,
    unique: f64,
    alone: f64,
    p: f64,
    rivals: Vec<Rival>,
}

impl Ranked {
    /// Rivals that the data cannot tell from it.
    fn told(&self) -> impl Iterator<Item = &Rival> {
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
    fn new(data: &'a Measurements, model: &'a Explained) -> Self {
        let noise = estimate(&data.rows, &model.scalars, &model.solution.residuals_um);
        let mut assembly = Self { data, model, noise, ordered: Vec::new() };
        assembly.ordered = assembly.rank();
        assembly
    }

    fn degrees(&self) -> f64 {
        (self.model.space.degrees - self.model.fit.rank as f64).max(1.0)
    }

    /// Variance of the residual, µm².
    fn variance(&self) -> f64 {
        self.model.solution.residual_square / self.degrees()
    }

    /// Variance of the noise alone: never more than what is left.
    fn noise_variance(&self) -> f64 {
        self.noise.map_or(self.variance(), |n| n.variance.min(self.variance()))
    }

    fn square(&self, parts: &[Part]) -> (f64, usize) {
        let space = &self.model.space;
        let columns = space.columns(&self.model.library, parts);
        let (square, rank) = explained(space.products(self.model.fit.level), &columns, space.reference());
        ((space.total(self.model.fit.level) - square).max(0.0), rank)
    }

    fn rank(&self) -> Vec<Ranked> {
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
    fn taken_off(&self, count: usize) -> Vec<(Term, f64)> {
        self.ordered.iter().take(count).flat_map(|r| self.own(r.place)).collect()
    }

    /// Terms and values of one part.
    fn own(&self, place: usize) -> Vec<(Term, f64)> {
        self.positions(place)
            .map(|i| (self.model.solution.terms[i], self.model.solution.coefficients[i]))
            .collect()
    }

    /// Positions of a part's columns in the solution.
    fn positions(&self, place: usize) -> std::ops::Range<usize> {
        let length = |p: &Part| self.model.library.candidates[p.candidate].variants[p.variant].columns.len();
        let before: usize = self.model.parts.iter().take(place).map(length).sum();
        let start = self.model.library.nuisances + before;
        start..start + length(&self.model.parts[place])
    }

    /// Columns of the measuring frame: the first six.
    fn set_up_terms(&self) -> &[Term] {
        self.model.solution.terms.split_at(6).0
    }

    /// What is neither frame nor cause and is known from the fit: the bar's length, unknown approaches.
    fn instrument(&self) -> Vec<(Term, f64)> {
        let solution = &self.model.solution;
        (6..self.model.library.nuisances).map(|i| (solution.terms[i], solution.coefficients[i])).collect()
    }

    /// The gap of some rows, aligned, with the first causes taken off.
    fn gap(&self, data: &Measurements, scalars: &[Scalar], count: usize) -> Vec<f64> {
        let mut off = self.instrument();
        off.extend(self.taken_off(count));
        aligned(data, scalars, self.set_up_terms(), &off)
    }

    fn gap_after(&self, count: usize) -> Vec<f64> {
        self.gap(self.data, &self.model.scalars, count)
    }

    fn diagnosis(&self, holdout: Option<&Measurements>, options: &Options) -> Diagnosis {
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
        };
        let verdict = verdict(&evidence);
        let causes = if verdict == Verdict::Underpowered { Vec::new() } else { causes };
        let holdout = holdout.map(|h| self.holdout(h));
        Diagnosis {
            verdict,
            sentence: crate::sentence::sentence(verdict, &gap, &causes, &leftover),
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
            notes: self.notes(),
        }
    }

    /// The cause and its rival that most need to be told apart.
    fn worst_pair(&self) -> Option<(usize, Part)> {
        self.ordered.iter().find_map(|r| r.told().next().map(|rival| (r.place, rival.part)))
    }

    /// Names of what cannot be told from a cause.
    fn told(&self, ranked: &Ranked) -> Vec<String> {
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

    fn noise_ratio(&self) -> Option<f64> {
        let stated = self.data.rows.iter().any(|r| r.u_um.is_some());
        stated.then(|| self.variance().sqrt() / self.data.typical_uncertainty_um())
    }

    fn notes(&self) -> Vec<String> {
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

    fn leftover(&self) -> Leftover {
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

    fn causes(&self, holdout: Option<&Measurements>, gap_rms: f64) -> Vec<Cause> {
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

    /// The part as a profile entry. Two time constants share one entry.
    fn term(&self, place: usize) -> EffectTerm {
        let kind = self.model.library.candidates[self.model.parts[place].candidate].kind;
        let mut coefficients = vec![0.0; kind.coefficient_names().len()];
        let mut common = Shape::default();
        for (nth, (term, value)) in self.own(place).into_iter().enumerate() {
            if let Term::Effect { index, shape, .. } = term {
                if matches!(kind, EffectKind::Warmup(_)) && nth == 1 {
                    common.tau2_s = shape.tau_s;
                    coefficients[1] = value;
                } else {
                    common = shape;
                    coefficients[index] = value;
                }
            }
        }
        EffectTerm::new(kind, common, &coefficients, self.data.geometry.clone())
    }

    fn parameters(&self, place: usize) -> Vec<Parameter> {
        let solution = &self.model.solution;
        let positions = self.positions(place);
        let quantile = StudentsT::new(0.0, 1.0, self.degrees()).map_or(1.96, |d| d.inverse_cdf(0.975));
        // Leaving out the far end of a heavy tail makes the rest look better than it is.
        let tail = tail_factor(&self.model.scalars, &solution.residuals_um, &self.model.dropped_residuals_um);
        let deviation =
            |i: usize| (solution.unit_covariance[(i, i)] * self.variance() * tail).max(0.0).sqrt();
        let kind = self.model.library.candidates[self.model.parts[place].candidate].kind;
        let names = kind.coefficient_names();
        let mut parameters = Vec::new();
        let waves =
            matches!(kind, EffectKind::Pitch(_) | EffectKind::Eccentricity(_) | EffectKind::ProbeLobing);
        if waves && positions.len() >= 2 {
            let (s, c) = (solution.coefficients[positions.start], solution.coefficients[positions.start + 1]);
            let amplitude = units::math::hypot(s, c);
            let (us, uc) = (deviation(positions.start), deviation(positions.start + 1));
            let u = units::math::hypot(s * us, c * uc) / amplitude.max(1e-12);
            let unit = if matches!(kind, EffectKind::Eccentricity(_)) { "urad" } else { "um" };
            parameters.push(Parameter {
                name: format!("amplitude_{unit}"),
                value: amplitude,
                u95: Some(quantile * u),
            });
        }
        for i in positions {
            if let Term::Effect { index, .. } = solution.terms[i] {
                let u95 = Some(quantile * deviation(i));
                parameters.push(Parameter {
                    name: names[index].to_owned(),
                    value: solution.coefficients[i],
                    u95,
                });
            }
        }
        let shapes = kind.shape_names();
        let entry = self.term(place).entry();
        parameters.extend(
            entry.into_iter().filter(|(n, _)| shapes.contains(n)).map(|(name, value)| Parameter {
                name: name.to_owned(),
                value,
                u95: None,
            }),
        );
        parameters
    }

    /// What the first causes do to some commands, alignment taken out.
    fn strength(&self, data: &Measurements, scalars: &[Scalar], count: usize) -> Strength {
        let own: Vec<(Term, f64)> = self.taken_off(count);
        let positions: Vec<usize> =
            self.ordered.iter().take(count).flat_map(|r| self.positions(r.place)).collect();
        let mut terms = self.set_up_terms().to_vec();
        let nuisances = terms.len();
        terms.extend(own.iter().map(|(t, _)| *t));
        let source = source(data, scalars);
        let gram = Gram::new(terms, &source);
        let align = scalars.len() >= 24 && !data.has_magnitudes();
        let (whitened, _) = gram.whitened(if align { FREE_OFFSETS } else { 0.0 });
        let (products, rank) =
            crate::gram::eliminate(&whitened, if align { nuisances } else { 0 }, &gram.squares());
        let offset = products.nrows() - 1 - own.len();
        let covariance = &self.model.solution.unit_covariance;
        let (mut square, mut spread) = (0.0, 0.0);
        for (i, (_, a)) in own.iter().enumerate() {
            for (j, (_, b)) in own.iter().enumerate() {
                let product = products[(offset + i, offset + j)];
                square += a * b * product;
                spread += covariance[(positions[i], positions[j])] * product;
            }
        }
        let equations = scalars.len().max(1) as f64;
        let noise = self.noise_variance().max(1e-12);
        let fitted = if align { rank as f64 + gram.offsets_fitted() } else { 0.0 };
        Strength {
            square: square / equations / noise,
            spread: spread * self.variance() / equations / noise,
            noise: (1.0 - fitted / equations).max(0.05),
        }
    }

    /// Mean square of the residual on unseen lines and its standard error, in units of the noise variance.
    ///
    /// With few runs a left-out run or stretch is an extrapolation, not a new line of the same kind: then the
    /// residual itself is taken, per degree of freedom.
    fn misfit(&self, count: usize) -> (f64, f64) {
        let model = self.model;
        let noise = self.noise_variance().max(1e-12);
        let parts: Vec<Part> = self.ordered.iter().take(count).map(|r| r.part).collect();
        if self.data.runs.len() < 8 {
            let (square, rank) = self.square(&parts);
            let degrees = (model.space.degrees - rank as f64).max(1.0);
            let m = square / degrees / noise;
            return (m, m * (2.0 / degrees).sqrt());
        }
        let columns = model_columns(&model.library, &parts);
        let terms: Vec<Term> = columns.iter().map(|c| model.library.terms[*c]).collect();
        let source = source(self.data, &model.scalars);
        let nuisances = model.library.nuisances;
        let folds = Folds::new(&terms, nuisances, model.solution.rho, &source, Folding::Runs);
        let all: Vec<usize> = (0..terms.len() - nuisances).collect();
        let losses = folds.losses(&all);
        let share = model.space.degrees / model.scalars.len() as f64;
        let m = losses.iter().sum::<f64>() / model.space.degrees / noise;
        let each: Vec<f64> = losses
            .iter()
            .zip(folds.counts())
            .filter(|(_, n)| **n > 0)
            .map(|(l, n)| l / (*n as f64 * share) / noise)
            .collect();
        let mean = each.iter().sum::<f64>() / each.len().max(1) as f64;
        let spread = each.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
        (m, (spread / (each.len() as f64 - 1.0).max(1.0) / each.len().max(1) as f64).sqrt())
    }

    fn shrink(&self, count: usize, holdout: Option<&Measurements>) -> Shrinkage {
        let model = self.model;
        let (m, m_error) = self.misfit(count);
        let mut data = self.strength(self.data, &model.scalars, count);
        if self.data.runs.len() < 8 {
            // A residual does not contain the uncertainty of the numbers that were fitted to it.
            data.spread = 0.0;
        }
        let target = match holdout {
            Some(h) if h.has_magnitudes() => {
                let estimate = crate::align::displacements(h, &self.taken_off(count));
                Some(self.strength(h, &h.scalars(Some(&estimate)), count))
            }
            Some(h) => Some(self.strength(h, &h.scalars(None), count)),
            None => None,
        };
        let mut target = target.unwrap_or(data);
        target.noise *=
            tail_factor(&model.scalars, &model.solution.residuals_um, &model.dropped_residuals_um);
        transported(m, m_error, &data, &target)
    }

    fn holdout(&self, holdout: &Measurements) -> Holdout {
        let (before, after) = if holdout.has_magnitudes() {
            // Lengths cannot be aligned: they are taken in the measuring frame that was found.
            let terms = self.model.solution.terms.iter().copied();
            let all: Vec<(Term, f64)> = terms.zip(self.model.solution.coefficients.iter().copied()).collect();
            (magnitude_errors(holdout, &[]), magnitude_errors(holdout, &all))
        } else {
            let scalars = holdout.scalars(None);
            let length = |count: usize| row_lengths(&scalars, &self.gap(holdout, &scalars, count));
            (length(0), length(self.ordered.len()))
        };
        let (rms_before_um, rms_after_um) = (rms(&before), rms(&after));
        let shrink = if rms_before_um > 0.0 { 1.0 - rms_after_um / rms_before_um } else { 0.0 };
        Holdout { rows: before.len(), rms_before_um, rms_after_um, shrink }
    }

    fn setup(&self) -> Setup {
        let solution = &self.model.solution;
        let mut setup = Setup::default();
        for (term, value) in solution.terms.iter().zip(&solution.coefficients) {
            match term {
                Term::SetupShift(axis) => setup.shift_um[*axis] = *value,
                Term::SetupRotation(axis) => setup.rotation_urad[*axis] = *value,
                _ => {}
            }
        }
        let offsets = solution.run_offsets_um.iter().map(|o| [o.x, o.y, o.z]);
        setup.run_offsets_um = self.data.runs.iter().cloned().zip(offsets).collect();
        setup
    }

    /// Smallest first coefficient of every effect that would pass the F test nine times in ten.
    fn detectable(&self) -> Vec<Detectable> {
        let space = &self.model.space;
        let level = self.model.fit.level;
        let sigma = self.variance().sqrt();
        self.model
            .library
            .candidates
            .iter()
            .enumerate()
            .map(|(index, candidate)| {
                // Passes the F test nine times in ten.
                let tail = 0.5 * crate::engine::LEVEL / self.model.library.questions(index);
                let beyond = Normal::standard().inverse_cdf(1.0 - tail) + 1.28;
                let first = candidate.variants.first().and_then(|v| v.columns.first());
                let square = first.map_or(0.0, |c| {
                    let c = c - self.model.library.nuisances;
                    let left = space.products(level)[(c, c)];
                    if left > crate::linear::RANK_TOLERANCE * space.reference()[c] { left } else { 0.0 }
                });
                let smallest = (square > 0.0).then(|| beyond * sigma / square.sqrt());
                Detectable {
                    effect: candidate.kind.to_string(),
                    parameter: candidate.kind.coefficient_names()[0].to_owned(),
                    smallest,
                }
            })
            .collect()
    }
}
