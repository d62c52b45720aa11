//! The numbers of the causes, with their uncertainty.

use machine_model::effects::{EffectKind, EffectTerm, Shape};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::equations::columns::Source;
use crate::equations::linear::Products;
use crate::equations::noise::tail_factor;
use crate::equations::set_up::Clamping;
use crate::equations::term::Term;
use crate::judgement::answer::{Detectable, Parameter, Setup};
use crate::judgement::assembly::Assembly;

impl Assembly<'_> {
    /// The part as a profile entry. Two time constants share one entry.
    pub(crate) fn term(&self, place: usize) -> EffectTerm {
        let kind = self.model.library.kind(self.model.parts[place]);
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

    /// By how much the variance of a part's numbers grows because readings hang together.
    fn inflations(&self, place: usize) -> Vec<f64> {
        let (model, own) = (self.model, self.positions(place));
        if model.caution.is_none() {
            return vec![1.0; own.len()];
        }
        let terms = &model.solution.terms;
        let beside: Vec<Term> =
            terms.iter().enumerate().filter(|(i, _)| !own.contains(i)).map(|(_, t)| *t).collect();
        let source = Source::new(self.data, &model.scalars);
        crate::search::doubt::inflations(&beside, &terms[own], model.solution.rho, model.caution, &source)
    }

    pub(crate) fn parameters(&self, place: usize) -> Vec<Parameter> {
        let solution = &self.model.solution;
        let positions = self.positions(place);
        let quantile = StudentsT::new(0.0, 1.0, self.degrees()).map_or(1.96, |d| d.inverse_cdf(0.975));
        // Leaving out the far end of a heavy tail makes the rest look better than it is.
        let tail = tail_factor(&self.model.scalars, &solution.residuals_um, &self.model.dropped_residuals_um);
        let wider = self.inflations(place);
        let deviation = |i: usize| {
            let variance =
                solution.unit_covariance[(i, i)] * self.variance() * tail * wider[i - positions.start];
            variance.max(0.0).sqrt()
        };
        let kind = self.model.library.kind(self.model.parts[place]);
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
        for i in positions.clone() {
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

    /// Smallest first coefficient of every effect that would pass the F test nine times in ten.
    pub(crate) fn detectable(&self) -> Vec<Detectable> {
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
                let tail = 0.5 * crate::search::trial::LEVEL / self.model.library.questions(index);
                let beyond = Normal::standard().inverse_cdf(1.0 - tail) + 1.28;
                let first = candidate.variants.first().and_then(|v| v.columns.first());
                let square = first.map_or(0.0, |c| {
                    let c = c - self.model.library.nuisances;
                    let left = space.products(level).product(c, c);
                    if left > crate::equations::linear::RANK_TOLERANCE * space.reference()[c] {
                        left
                    } else {
                        0.0
                    }
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

    /// Zeros of the instruments against that of the first one.
    fn instruments_um(&self) -> Vec<(usize, [(f64, f64); 3])> {
        let solution = &self.model.solution;
        let mut found: Vec<(usize, [(f64, f64); 3])> = Vec::new();
        for (i, term) in solution.terms.iter().enumerate() {
            let Term::InstrumentShift { instrument, axis } = *term else { continue };
            if found.last().is_none_or(|(last, _)| *last != instrument) {
                found.push((instrument, [(0.0, 0.0); 3]));
            }
            let u95 = 1.96 * (solution.unit_covariance[(i, i)] * self.variance()).max(0.0).sqrt();
            if let Some((_, values)) = found.last_mut() {
                values[axis] = (solution.coefficients[i], u95);
            }
        }
        found
    }

    pub(crate) fn setup(&self) -> Setup {
        let solution = &self.model.solution;
        let mut setup = Setup::default();
        let mut turns = vec![[0.0; 3]; self.data.runs.len()];
        for (term, value) in solution.terms.iter().zip(&solution.coefficients) {
            match term {
                Term::SetupShift(axis) => setup.shift_um[*axis] = *value,
                Term::SetupRotation(axis) => setup.rotation_urad[*axis] = *value,
                Term::RunRotation { run, about, .. } => turns[*run][*about] = *value,
                _ => {}
            }
        }
        let offsets = solution.run_offsets_um.iter().map(|o| [o.x, o.y, o.z]);
        if self.model.clamping == Clamping::Turned {
            setup.run_rotations_urad = self.data.runs.iter().cloned().zip(turns).collect();
        }
        setup.instruments_um = self.instruments_um();
        setup.run_offsets_um = self.data.runs.iter().cloned().zip(offsets).collect();
        setup
    }
}
