//! The numbers of the causes, with their uncertainty.

use machine_model::Vector;
use machine_model::effects::{EffectKind, EffectTerm, Shape};
use statrs::distribution::{ContinuousCDF, Normal, StudentsT};

use crate::equations::columns::Source;
use crate::equations::linear::Products;
use crate::equations::noise::tail_factor;
use crate::equations::set_up::{Clamping, middles_mm};
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
    pub(crate) fn inflations(&self, place: usize) -> Vec<f64> {
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
            let name = match solution.terms[i] {
                Term::Effect { index, .. } => names[index].to_owned(),
                Term::Knock { .. } => names[0].to_owned(),
                Term::Order { component, .. } => format!("{}_um", ["x", "y", "z"][component]),
                _ => continue,
            };
            let u95 = Some(quantile * deviation(i));
            parameters.push(Parameter { name, value: solution.coefficients[i], u95 });
        }
        let shapes = kind.shape_names();
        let entry = self.term(place).entry();
        parameters.extend(
            entry
                .into_iter()
                .filter(|(n, _)| shapes.clone().any(|name| name == *n))
                .map(|(name, value)| Parameter { name: name.to_owned(), value, u95: None }),
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
        let mut turns = vec![Vector::zeros(); self.data.runs.len()];
        for (term, value) in solution.terms.iter().zip(&solution.coefficients) {
            match term {
                Term::SetupShift(axis) => setup.shift_um[*axis] = *value,
                Term::SetupRotation(axis) => setup.rotation_urad[*axis] = *value,
                Term::RunRotation { run, about, .. } => turns[*run][*about] = *value,
                _ => {}
            }
        }
        let mut offsets = solution.run_offsets_um.clone();
        if self.model.clamping == Clamping::Turned {
            let common = common_turn(&mut turns, &mut offsets, &middles_mm(self.data));
            let rotation = Vector::from(setup.rotation_urad) + common;
            setup.rotation_urad = rotation.into();
            setup.run_rotations_urad =
                self.data.runs.iter().cloned().zip(turns.into_iter().map(Into::into)).collect();
        }
        setup.instruments_um = self.instruments_um();
        let offsets = offsets.into_iter().map(Into::into);
        setup.run_offsets_um = self.data.runs.iter().cloned().zip(offsets).collect();
        setup
    }
}

/// Takes from the angles of the runs, µrad, what they have in common, which is the measuring frame's, and gives it back. A run
/// turns about its own middle, mm, the frame about machine zero: the offsets of the runs, µm, take the difference.
fn common_turn(turns: &mut [Vector], offsets: &mut [Vector], middles_mm: &[Vector]) -> Vector {
    let common = turns.iter().sum::<Vector>() / turns.len().max(1) as f64;
    for ((turn, offset), middle) in turns.iter_mut().zip(offsets).zip(middles_mm) {
        *turn -= common;
        *offset -= common.cross(middle) * 1e-3;
    }
    common
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_runs_turn_in_common_is_the_frames() {
        let middles = [Vector::new(300.0, 40.0, 10.0), Vector::new(-20.0, 500.0, 0.0)];
        let mut turns = vec![Vector::new(0.0, 0.0, 2050.0), Vector::new(7.0, 0.0, 1953.0)];
        let mut offsets = vec![Vector::new(1.0, 2.0, 3.0), Vector::zeros()];
        let tip = Vector::new(120.0, -70.0, 33.0);
        let moved = |turns: &[Vector], offsets: &[Vector], frame: Vector| {
            [0, 1].map(|run| {
                offsets[run] + 1e-3 * (turns[run].cross(&(tip - middles[run])) + frame.cross(&tip))
            })
        };
        let before = moved(&turns, &offsets, Vector::zeros());
        let common = common_turn(&mut turns, &mut offsets, &middles);
        let after = moved(&turns, &offsets, common);
        assert!((0..2).all(|run| (before[run] - after[run]).norm() < 1e-9));
        assert!((turns[0] + turns[1]).norm() < 1e-9 && (turns[0].z - 48.5).abs() < 1e-9);
    }
}
