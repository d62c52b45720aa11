//! The causes on points that no fit has seen.

use diagnostic::Text;
use machine_model::Vector;

use machine_model::effects::EffectKind;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::equations::align::{aligned, magnitude_errors, rms, row_lengths};
use crate::equations::noise::tail_factor;
use crate::equations::observation::{Measurements, Reading, Row, Scalar};
use crate::equations::term::Term;
use crate::judgement::answer::{Holdout, Residual, Shrinkage, Step, Verdict, WorseRun};
use crate::judgement::assembly::Assembly;
use crate::judgement::verdict::Unseen;
use crate::options::Options;
use crate::search::explain::explain;
use crate::search::lengths::explained;

impl Assembly<'_> {
    pub(crate) fn holdout(&self, holdout: &Measurements) -> Holdout {
        if holdout.has_magnitudes() { self.lengths_unseen(holdout) } else { self.vectors_unseen(holdout) }
    }

    /// Vectors, components, ball bars: every step is aligned anew, as a new set-up would be.
    fn vectors_unseen(&self, holdout: &Measurements) -> Holdout {
        let scalars = holdout.scalars(None);
        let gaps: Vec<Vec<f64>> =
            (0..=self.ordered.len()).map(|count| self.gap(holdout, &scalars, count)).collect();
        let sizes: Vec<f64> = gaps.iter().map(|gap| rms(&row_lengths(&scalars, gap))).collect();
        let names = std::iter::once(Text::pair("set-up", "установка")).chain(self.names().map(Text::same));
        let steps = names.zip(&sizes).map(|(added, rms_um)| Step { added, rms_um: *rms_um }).collect();
        let residuals = residuals(&scalars, &gaps[0], &gaps[self.ordered.len()]);
        let rows = row_lengths(&scalars, &gaps[0]).len();
        let last = &gaps[self.ordered.len()];
        let worse = worse_run(holdout, &scalars, &gaps[0], last, self.model.caution.as_one());
        Holdout { worse, steps, residuals, ..Holdout::new(rows, sizes[0], sizes[self.ordered.len()]) }
    }

    /// Lengths alone cannot be aligned: they are taken in the measuring frame that was found, its zero first (the
    /// model's tables have another), then its rotation.
    fn lengths_unseen(&self, holdout: &Measurements) -> Holdout {
        let solution = &self.model.solution;
        let all: Vec<(Term, f64)> =
            solution.terms.iter().copied().zip(solution.coefficients.iter().copied()).collect();
        let mut taken_off: Vec<(Term, f64)> = Vec::new();
        let mut errors = vec![magnitude_errors(holdout, &taken_off)];
        let mut names = vec![Text::pair("model alone", "одна модель")];
        let frame = [
            (Text::pair("zero of the measuring frame", "нуль системы измерения"), 0..3),
            (Text::pair("its rotation", "её поворот"), 3..6),
        ];
        for (name, range) in frame {
            taken_off.extend_from_slice(&all[range]);
            errors.push(magnitude_errors(holdout, &taken_off));
            names.push(name);
        }
        taken_off.extend(self.instrument());
        for (ranked, name) in self.ordered.iter().zip(self.names()) {
            taken_off.extend(self.own(ranked.place));
            errors.push(magnitude_errors(holdout, &taken_off));
            names.push(Text::same(name));
        }
        let sizes: Vec<f64> = errors.iter().map(|e| rms(e)).collect();
        let steps = names.into_iter().zip(&sizes).map(|(added, r)| Step { added, rms_um: *r }).collect();
        let last = errors.len() - 1;
        let with_length = holdout.rows.iter().enumerate();
        let with_length = with_length.filter(|(_, r)| matches!(r.reading, Reading::Magnitude(_)));
        let residuals = with_length
            .zip(errors[0].iter().zip(&errors[last]))
            .map(|((row, _), (before, after))| Residual {
                row,
                class: 3,
                along: Vector::zeros(),
                before_um: *before,
                after_um: *after,
            })
            .collect();
        Holdout { steps, residuals, ..Holdout::new(errors[0].len(), sizes[0], sizes[last]) }
    }

    /// What some unseen rows say, in units of what noise alone would leave there.
    pub(crate) fn unseen(
        &self,
        data: &Measurements,
        before_um: f64,
        after_um: f64,
        promised: Option<Shrinkage>,
    ) -> Unseen {
        let model = self.model;
        let equations = if data.has_magnitudes() { data.rows.len() } else { data.scalars(None).len() } as f64;
        let tail = tail_factor(&model.scalars, &model.solution.residuals_um, &model.dropped_residuals_um);
        let floor = (self.noise_variance() * self.unaligned() * tail * equations
            / data.rows.len().max(1) as f64)
            .sqrt()
            .max(1e-9);
        let promised = promised.map_or((0.0, 0.0), |s| (s.low, s.mid));
        // Both sizes are known to 1/√(2n), their ratio to √2 of that at worst: of the ratio that was promised, for a worse
        // outcome earns no more patience.
        let left = if before_um > 0.0 { (after_um / before_um).min(1.0 - promised.0) } else { 1.0 };
        let error = left / equations.max(1.0).sqrt();
        // Noise was estimated on the rows of the fit, and readings that hang together count as fewer.
        let few = |readings: f64| model.caution.as_one() / (2.0 * readings.max(1.0));
        let chance = (few(equations) + few(self.degrees())).sqrt();
        Unseen {
            before: before_um / floor,
            after: after_um / floor,
            promised,
            error,
            chance,
            alone: false,
            worse: None,
        }
    }

    /// The forecast of this model for runs that it was not fitted to, and what became of it: in the frame that was
    /// fitted, only the zero of every run is its own.
    fn on_runs_kept_back(&self, kept: &Measurements) -> Option<Unseen> {
        let count = self.ordered.len();
        if count == 0 {
            return None;
        }
        let knocks = self.knocks();
        let told = |row: &&Row| knocks.iter().all(|knock| !knock.hides(row));
        let foretold = kept.rows.iter().filter(told).copied().collect();
        let kept = &Measurements { rows: foretold, ..kept.clone() };
        let solution = &self.model.solution;
        let framing = self.model.library.framing;
        let fitted = solution.terms.iter().copied().zip(solution.coefficients.iter().copied()).take(framing);
        let frame: Vec<(Term, f64)> =
            fitted.filter(|(t, _)| !matches!(t, Term::RunRotation { .. })).chain(self.instrument()).collect();
        let turns: Vec<Term> = self.frame(kept).into_iter().skip(6).collect();
        let scalars = kept.scalars(None);
        let left = |causes: &[(Term, f64)]| {
            let off: Vec<(Term, f64)> = frame.iter().chain(causes).copied().collect();
            aligned(kept, &scalars, &turns, self.alignment, &off)
        };
        let (before, after) = (left(&[]), left(&self.taken_off(count)));
        let size = |gap: &[f64]| rms(&row_lengths(&scalars, gap));
        let promised = self.shrink(count, Some(kept));
        let worse = worse_run(kept, &scalars, &before, &after, self.model.caution.as_one());
        Some(Unseen { worse, ..self.unseen(kept, size(&before), size(&after), Some(promised)) })
    }

    /// Between which fitted rows each knock among the causes came.
    fn knocks(&self) -> Vec<Knock> {
        let knock = |(term, _): (Term, f64)| {
            let (moment, came): (Moment, f64) = match term {
                Term::Knock { from, .. } => (|row| Some(row.order[0]), from),
                Term::Effect { kind: EffectKind::Step(_), shape, .. } => {
                    (|row| row.conditions.time_s, shape.time_s)
                }
                _ => return None,
            };
            let fitted = || self.data.rows.iter().filter_map(moment);
            let before = fitted().filter(|at| *at < came).fold(f64::NEG_INFINITY, f64::max);
            let behind = fitted().filter(|at| *at >= came).fold(f64::INFINITY, f64::min);
            Some(Knock { moment, before, behind })
        };
        self.taken_off(self.ordered.len()).into_iter().filter_map(knock).collect()
    }

    /// Ids of the causes in order.
    fn names(&self) -> impl Iterator<Item = String> {
        self.ordered.iter().map(|r| self.model.library.kind(r.part).to_string())
    }
}

/// When a row was read: a time, or how far through the file.
type Moment = fn(&Row) -> Option<f64>;

/// The fitted rows between which a knock came.
struct Knock {
    moment: Moment,
    before: f64,
    behind: f64,
}

impl Knock {
    /// True where a row lies between these two: on which side of the knock it is nobody can foretell.
    fn hides(&self, row: &Row) -> bool {
        (self.moment)(row).is_some_and(|at| at > self.before && at < self.behind)
    }
}

/// Every fourth run kept back, of few runs two stretches of each, and the whole search made on the others: what becomes of its
/// forecast. `None` where these rows lie outside what the others cover, are few, or the others name nothing.
pub(crate) fn kept_back(data: &Measurements, without: &[EffectKind]) -> Option<Unseen> {
    /// Fewer runs leave no three quarters that cover the machine.
    const RUNS: usize = 8;
    /// More rows make a second search too slow, fewer leave none for it.
    const ROWS: std::ops::RangeInclusive<usize> = 60..=20_000;
    /// Stretches of a run, of which every fourth is kept back.
    const STRETCHES: usize = 8;
    let all = data.runs.len();
    if !ROWS.contains(&data.rows.len()) || data.has_magnitudes() {
        return None;
    }
    let by_runs = all >= RUNS;
    let mut lengths = vec![0; all];
    data.rows.iter().for_each(|row| lengths[row.run] += 1);
    let part = |wanted: bool| {
        let chosen: Vec<usize> = (0..all).filter(|run| !by_runs || (run % 4 == 2) == wanted).collect();
        let mut passed = vec![0; all];
        let rows = data.rows.iter().filter_map(|row| {
            let stretch = STRETCHES * passed[row.run] / lengths[row.run];
            passed[row.run] += 1;
            let run = chosen.binary_search(&row.run).ok()?;
            (by_runs || (stretch % 4 == 2) == wanted).then_some(Row { run, ..*row })
        });
        let rows = rows.collect();
        Measurements {
            runs: chosen.iter().map(|run| data.runs[*run].clone()).collect(),
            rows,
            ..data.clone()
        }
    };
    let (fitted, kept) = (part(false), part(true));
    let inside = |axis: usize| {
        let ((low, high), (from, to)) = (fitted.range_mm(axis), kept.range_mm(axis));
        let slack = 0.05 * (high - low) + 1e-6;
        from >= low - slack && to <= high + slack
    };
    if !(0..3).all(inside) {
        return None;
    }
    let model = explain(&fitted, &fitted.scalars(None), without);
    let unseen = Assembly::new(&fitted, &model).on_runs_kept_back(&kept)?;
    // Every fourth run, from the third one on.
    let worse = unseen.worse.map(|w| WorseRun { run: if by_runs { 4 * w.run + 2 } else { w.run }, ..w });
    Some(Unseen { worse, ..unseen })
}

/// Rows that no fit has seen show a gap of their own: searched alone they have a cause that is the machine's, or structure
/// without a name. A gap as large as the noise is lost in their RMS and not in their pattern.
pub(crate) fn gap_of_its_own(holdout: &Measurements, options: &Options) -> bool {
    let (model, _) = explained(holdout, &options.without);
    let verdict = Assembly::new(holdout, &model).on_its_rows(options);
    matches!(verdict, Verdict::Named | Verdict::Ambiguous | Verdict::Partial | Verdict::Unknown)
}

/// The run that the causes make worse by most: its rows' squares grow on the whole by more than their differences scatter,
/// which needs no figure of the noise. `as_one`: so many readings that hang together count as one.
fn worse_run(
    data: &Measurements,
    scalars: &[Scalar],
    before: &[f64],
    after: &[f64],
    as_one: f64,
) -> Option<WorseRun> {
    /// Rows of a run that say something of it.
    const ROWS: usize = 6;
    /// Less is nothing that anyone acts on, as a share of the RMS of all rows.
    const GROWS: f64 = 0.05;
    /// So seldom any of the runs is the worst one by chance.
    const CHANCE: f64 = 0.01;
    let rows = {
        let mut rows: Vec<usize> = scalars.iter().map(|s| s.row).collect();
        rows.dedup();
        rows
    };
    let mut runs: Vec<Vec<(f64, f64)>> = vec![Vec::new(); data.runs.len()];
    for ((row, before), after) in
        rows.iter().zip(row_lengths(scalars, before)).zip(row_lengths(scalars, after))
    {
        runs[data.rows[*row].run].push((before * before, after * after));
    }
    let least_um = GROWS * rms(&row_lengths(scalars, before));
    let judged = || runs.iter().enumerate().filter(|(_, rows)| rows.len() >= ROWS);
    let level = CHANCE / judged().count().max(1) as f64;
    let worse = judged().filter_map(|(run, rows)| {
        let count = rows.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| rows.iter().map(of).sum::<f64>() / count;
        let (before, after) = (mean(&|r| r.0), mean(&|r| r.1));
        let grown = after - before;
        let scatter = mean(&|r| (r.1 - r.0 - grown).powi(2)) / (count - 1.0) * as_one;
        let worse = WorseRun { run, before_um: before.sqrt(), after_um: after.sqrt() };
        let no_chance = StudentsT::new(0.0, 1.0, count - 1.0).map_or(3.5, |t| t.inverse_cdf(1.0 - level));
        let counts = worse.after_um - worse.before_um > least_um && grown > no_chance * scatter.sqrt();
        counts.then_some(worse)
    });
    worse.max_by(|a, b| (a.after_um / a.before_um).total_cmp(&(b.after_um / b.before_um)))
}

/// Two states of the same equations.
pub(crate) fn residuals(scalars: &[Scalar], before: &[f64], after: &[f64]) -> Vec<Residual> {
    scalars
        .iter()
        .zip(before.iter().zip(after))
        .map(|(s, (b, a))| Residual {
            row: s.row,
            class: s.class,
            along: s.along,
            before_um: *b,
            after_um: *a,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use machine_model::Command;
    use machine_model::effects::EffectGeometry;

    use super::*;

    /// Fifty rows a run, of which every second one grows by 3 µm² more than the other shrinks.
    fn grown(runs: usize, growth: f64) -> Option<WorseRun> {
        let reading = Reading::Displacement([Some(0.0), None, None]);
        let row = |run: usize| Row::new(run, Command::default(), reading);
        let rows: Vec<Row> = (0..50 * runs).map(|k| row(k / 50)).collect();
        let names = (0..runs).map(|run| run.to_string()).collect();
        let data =
            Measurements { runs: names, instruments: Vec::new(), rows, geometry: EffectGeometry::default() };
        let scalars = data.scalars(None);
        let before: Vec<f64> = scalars.iter().map(|_| 4.0).collect();
        let after = |k: usize| {
            let change = if k / 50 == 1 { growth } else { -4.0 };
            let swing = if k.is_multiple_of(2) { 7.0 } else { -7.0 };
            (16.0 + change + swing).sqrt()
        };
        let after: Vec<f64> = (0..scalars.len()).map(after).collect();
        worse_run(&data, &scalars, &before, &after, 1.0)
    }

    /// A growth of 2.9 standard errors of a run's squares: among two runs it is no chance, among sixty it may be.
    #[test]
    fn the_worst_of_many_runs_may_be_worse_by_chance() {
        assert_eq!(grown(2, 2.9).map(|worse| worse.run), Some(1));
        assert_eq!(grown(60, 2.9), None);
        assert_eq!(grown(60, 4.5).map(|worse| worse.run), Some(1));
        assert_eq!(grown(2, 1.5), None);
    }
}
